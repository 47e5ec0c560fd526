/* Softest modes: Lanczos on K^-1 M with the factor of K (docs/theory/branches.md). The factor is
 * there anyway and vectors are whole on every rank, so that this takes no more than solves. */
#include "model/solid/equilibrium/modes.h"

#include "model/solid/assembly/incompressible.h"
#include "model/solid/assembly/mass.h"
#include "model/solid/assembly/matrix.h"

#include <petscblaslapack.h>

#include <math.h>
#include <string.h>

enum { ROUNDS_MAX = 12, BASIS_MAX = DEA_MODES_MAX + 40 };

static const double ritz_small = 1e-9; // residual over the eigenvalue

struct lanczos {
  size_t dofs, room, locked, most; // room: of the basis; locked: modes that were found, of most
  double *mass;                    // [dofs], 0 for what is held
  double *basis;                   // [room + 1][dofs], orthonormal in M
  double *mode, *nu;               // [most][dofs], [most] 1/lambda
  double *work;                    // [dofs]
  double alpha[BASIS_MAX], beta[BASIS_MAX], ritz[BASIS_MAX * BASIS_MAX], theta[BASIS_MAX];
};

static double dot(const struct lanczos *l, const double *a, const double *b)
{
  double sum = 0;
  for (size_t i = 0; i < l->dofs; i++) {
    sum += l->mass[i] * a[i] * b[i];
  }
  return sum;
}

static void add(size_t count, double factor, const double *a, double *to)
{
  for (size_t i = 0; i < count; i++) {
    to[i] += factor * a[i];
  }
}

/* Takes the found modes and the first `count` of the basis out of v, twice, for rounding. */
static void purge(const struct lanczos *l, size_t count, double *v)
{
  for (int pass = 0; pass < 2; pass++) {
    for (size_t k = 0; k < l->locked; k++) {
      const double *mode = l->mode + k * l->dofs;
      add(l->dofs, -dot(l, mode, v), mode, v);
    }
    for (size_t k = 0; k < count; k++) {
      const double *base = l->basis + k * l->dofs;
      add(l->dofs, -dot(l, base, v), base, v);
    }
  }
}

/* A start that no symmetry is orthogonal to, the same on every rank. */
static void start(const struct dea_solid *s, struct lanczos *l, int round)
{
  for (size_t i = 0; i < l->dofs; i++) {
    double x = sin(12.9898 * (double)(i + 1) + 78.233 * (round + 1));
    l->basis[i] = l->mass[i] > 0 ? x : 0;
  }
  dea_solid_release_held(s, l->basis);
}

/* Builds the basis; *count: its vectors, fewer than the room when nothing is left. */
static dea_status build(struct dea_context *ctx, struct dea_solid *s, struct lanczos *l, int round,
                        size_t *count)
{
  start(s, l, round);
  purge(l, 0, l->basis);
  double size = sqrt(dot(l, l->basis, l->basis));
  *count = 0;
  for (size_t k = 0; k < l->room && size > 0; k++) {
    double *v = l->basis + k * l->dofs, *next = v + l->dofs;
    for (size_t i = 0; i < l->dofs; i++) {
      v[i] /= size;
      l->work[i] = l->mass[i] * v[i];
    }
    DEA_TRY(ctx, dea_solid_solve_linear(ctx, s, l->work, next));
    dea_solid_release_held(s, next);
    l->alpha[k] = dot(l, v, next);
    double before = sqrt(dot(l, next, next));
    purge(l, k + 1, next);
    size = sqrt(dot(l, next, next));
    size = size > 1e-12 * before ? size : 0;
    l->beta[k] = size;
    *count = k + 1;
  }
  return DEA_OK;
}

/* Ritz values of the tridiagonal into l->theta (ascending), vectors into l->ritz [column][row]. */
static dea_status solve_small(struct dea_context *ctx, struct lanczos *l, size_t count)
{
  double off[BASIS_MAX], work[2 * BASIS_MAX];
  PetscBLASInt n = (PetscBLASInt)count, info = 0;
  memcpy(l->theta, l->alpha, count * sizeof *l->theta);
  memcpy(off, l->beta, count * sizeof *off);
  LAPACKsteqr_("I", &n, l->theta, off, l->ritz, &n, work, &info);
  return info == 0 ? DEA_OK : dea_fail(ctx, DEA_E_NOT_CONVERGED, "LAPACK failed in dsteqr");
}

/* The found modes on one side, and how many of them there are. */
static size_t found_below(const struct lanczos *l)
{
  size_t count = 0;
  for (size_t k = 0; k < l->locked; k++) {
    count += l->nu[k] < 0;
  }
  return count;
}

/* What a positive nu has to exceed to be among the `wanted` largest; 0 while there are fewer. */
static double threshold(const struct lanczos *l, size_t wanted)
{
  double at = INFINITY;
  for (size_t k = 0; k < wanted; k++) {
    double next = 0;
    size_t equal = 0;
    for (size_t j = 0; j < l->locked; j++) {
      next = l->nu[j] < at ? fmax(next, l->nu[j]) : next;
    }
    for (size_t j = 0; j < l->locked; j++) {
      equal += l->nu[j] == next;
    }
    if (next <= 0) {
      return 0;
    }
    k += equal - 1;
    at = next;
  }
  return wanted > 0 ? at : INFINITY;
}

/* Locks the converged Ritz pairs that are wanted: `negative` below 0, and those that are among the
 * `positive` largest. Returns how many are new. */
static size_t lock(struct lanczos *l, size_t count, size_t negative, size_t positive)
{
  size_t found = 0;
  for (size_t step = 0; step < 2 * count && l->locked < l->most; step++) {
    bool below = step < count; // first from the most negative on, then from the largest on
    size_t j = below ? step : 2 * count - 1 - step;
    const double *ritz = l->ritz + j * count;
    double nu = l->theta[j];
    bool sharp = fabs(l->beta[count - 1] * ritz[count - 1]) <= ritz_small * fabs(nu);
    bool want = below ? nu < 0 && found_below(l) < negative : nu > 0 && nu > threshold(l, positive);
    if (!sharp || !want) {
      continue;
    }
    double *mode = l->mode + l->locked * l->dofs;
    memset(mode, 0, l->dofs * sizeof *mode);
    for (size_t k = 0; k < count; k++) {
      add(l->dofs, ritz[k], l->basis + k * l->dofs, mode);
    }
    l->nu[l->locked++] = nu;
    found++;
  }
  return found;
}

void dea_mode_orient(size_t count, double *v)
{
  double most = 0;
  for (size_t i = 0; i < count; i++) {
    most = fabs(v[i]) > (1 + 1e-6) * fabs(most) ? v[i] : most; // the first one of equals
  }
  for (size_t i = 0; i < count && most < 0; i++) {
    v[i] = -v[i];
  }
}

/* Unit size in M, largest component positive. */
static void normalise(const struct lanczos *l, double *v)
{
  double size = sqrt(dot(l, v, v));
  dea_mode_orient(l->dofs, v);
  for (size_t i = 0; i < l->dofs; i++) {
    v[i] /= size;
  }
}

/* The lowest modes in ascending order. */
static void hand_over(struct lanczos *l, size_t nodes, size_t count, double *value, double *vector)
{
  for (size_t k = 0; k < count; k++) {
    size_t lowest = 0;
    for (size_t j = 1; j < l->locked; j++) {
      lowest = 1 / l->nu[j] < 1 / l->nu[lowest] ? j : lowest;
    }
    double *mode = l->mode + lowest * l->dofs;
    value[k] = 1 / l->nu[lowest];
    if (vector != NULL) {
      normalise(l, mode);
      memcpy(vector + k * 3 * nodes, mode, 3 * nodes * sizeof *vector);
    }
    l->nu[lowest] = 0; // done: 1/nu is infinite
  }
}

/* Rounds until all are there and one more adds none: an eigenvalue that comes twice shows once in a
 * round. */
static dea_status find(struct dea_context *ctx, struct dea_solid *s, struct lanczos *l,
                       size_t negative, size_t positive)
{
  bool all = false;
  for (int round = 0; round < ROUNDS_MAX; round++) {
    size_t built, found = 0;
    DEA_TRY(ctx, build(ctx, s, l, round, &built));
    if (built > 0) {
      DEA_TRY(ctx, solve_small(ctx, l, built));
      found = lock(l, built, negative, positive);
    }
    all = found_below(l) >= negative && threshold(l, positive) > 0;
    if (built == 0 || (all && (found == 0 || positive == 0))) {
      break;
    }
  }
  return all ? DEA_OK
             : dea_fail(ctx, DEA_E_NOT_CONVERGED, "only %zu of %zu modes were found", l->locked,
                        negative + positive);
}

static void release(struct dea_context *ctx, struct lanczos *l)
{
  void *const memory[] = {l->mass, l->work, l->basis, l->mode, l->nu, l};
  for (size_t i = 0; i < sizeof memory / sizeof memory[0]; i++) {
    dea_free(ctx, memory[i]);
  }
}

static dea_status make(struct dea_context *ctx, const struct dea_solid *s, size_t wanted,
                       struct lanczos **out)
{
  struct lanczos *l = *out = dea_alloc(ctx, 1, sizeof *l);
  if (dea_solid_any(l == NULL)) {
    dea_free(ctx, l);
    *out = NULL;
    return DEA_E_MEMORY;
  }
  l->dofs = s->dofs;
  l->most = 2 * wanted + 4; // those that later ones push out stay
  l->room = 2 * wanted + 20 < BASIS_MAX ? 2 * wanted + 20 : BASIS_MAX;
  l->mass = dea_alloc(ctx, s->dofs, sizeof(double));
  l->work = dea_alloc(ctx, s->dofs, sizeof(double));
  l->basis = dea_alloc(ctx, (l->room + 1) * s->dofs, sizeof(double));
  l->mode = dea_alloc(ctx, l->most * s->dofs, sizeof(double));
  l->nu = dea_alloc(ctx, l->most, sizeof(double));
  bool all =
      l->mass != NULL && l->work != NULL && l->basis != NULL && l->mode != NULL && l->nu != NULL;
  if (dea_solid_any(!all)) {
    release(ctx, l);
    *out = NULL;
    return DEA_E_MEMORY;
  }
  dea_solid_lump_volume(s, l->mass);
  return DEA_OK;
}

/* The `count` lowest found of `negative` negative modes and as many positive ones as that takes. */
static dea_status modes(struct dea_context *ctx, struct dea_solid *s, size_t negative, size_t count,
                        double *value, double *vector)
{
  struct lanczos *l;
  size_t positive = count > negative ? count - negative : 0;
  DEA_TRY(ctx, make(ctx, s, negative + positive, &l));
  dea_status status = find(ctx, s, l, negative, positive);
  if (status == DEA_OK) {
    hand_over(l, s->grid->node_count, count, value, vector);
  }
  release(ctx, l);
  return status;
}

dea_status dea_solid_modes(struct dea_context *ctx, struct dea_solid *s, size_t count,
                           double *value, double *vector)
{
  int negative = 0;
  if (count == 0 || count > DEA_MODES_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "1 to %d modes can be asked for", DEA_MODES_MAX);
  }
  DEA_TRY(ctx, dea_solid_factor_stiff(ctx, s, &negative));
  if (negative > DEA_MODES_MAX) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "%d modes are unstable: too many to find each",
                    negative);
  }
  DEA_TRY(ctx, modes(ctx, s, (size_t)negative, count, value, vector));
  return DEA_OK;
}

dea_status dea_solid_unstable_mode(struct dea_context *ctx, struct dea_solid *s, double *value,
                                   double *vector)
{
  int negative;
  DEA_TRY(ctx, dea_solid_factor_stiff(ctx, s, &negative));
  size_t wanted = negative < 1 || negative > DEA_MODES_MAX ? 1 : (size_t)negative;
  DEA_TRY(ctx, modes(ctx, s, wanted, 1, value, vector));
  return DEA_OK;
}
