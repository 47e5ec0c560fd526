#include "model/solid/equilibrium/modes.h"

#include "model/solid/assembly/curvature.h"
#include "model/solid/assembly/incompressible.h"
#include "model/solid/assembly/mass.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/equilibrium/presolve_check.h"

#include <slepceps.h>

#include <math.h>
#include <string.h>

static const double min_gap = 1e-6;    // of their values: a count tells modes apart
enum { MAX_ROUNDS = 6 };               // searches at one end of the spectrum
enum { MAX_EXTRA = 4 };                // modes that more are asked for
static const double first_extra = 0.5; // of the modes: those that more are asked for at first

/* SLEPc's Krylov-Schur on K^-1 B with the factor of K that the solver of equilibria makes. Its
 * eigenvalues 1/lambda are extreme at both ends for the modes that are wanted: unstable ones at
 * one, the softest stable ones at the other. Each end is searched by itself. */

struct eigen {
  struct dea_arena memory; // of the arrays
  struct dea_solid *solid;
  Mat B;
  Vec *vectors;     // [count] of them, room for `room`
  PetscReal *value; // [count]
  int *order;       // [count] the k-th lowest
  PetscInt count, capacity;
  bool below; // the end that is searched: unstable modes
};

#define CHECK(call)                                                                                \
  do {                                                                                             \
    PetscErrorCode code_ = (call);                                                                 \
    if (code_ != 0) {                                                                              \
      return code_;                                                                                \
    }                                                                                              \
  } while (0)

/* y = K^-1 x with the factor that is there. */
static PetscErrorCode apply_factor(PC pc, Vec x, Vec y)
{
  struct dea_solid *s;
  CHECK(PCShellGetContext(pc, &s));
  return dea_solid_solve_rows(s->memory.ctx, s, x, y) == DEA_OK ? 0 : PETSC_ERR_LIB;
}

/* *which: below 0 where eigenvalue a is wanted before b. */
static PetscErrorCode compare_eigenvalues(PetscScalar a, PetscScalar a_i, PetscScalar b,
                                          PetscScalar b_i, PetscInt *which, void *self)
{
  const struct eigen *f = self;
  double difference = 1 / a - 1 / b;
  (void)a_i;
  (void)b_i;
  *which = difference == 0 ? 0 : (difference < 0) == f->below ? -1 : 1;
  return 0;
}

/* `wanted` modes K v = lambda B v of one end, beside those found. */
static PetscErrorCode configure(EPS eps, struct eigen *f, PetscInt wanted)
{
  ST st;
  KSP ksp;
  PC pc;
  CHECK(EPSSetOperators(eps, f->solid->work.K, f->B));
  CHECK(EPSSetProblemType(eps, EPS_GHEP));
  CHECK(EPSSetType(eps, EPSKRYLOVSCHUR));
  CHECK(EPSSetTarget(eps, 0));
  CHECK(EPSSetEigenvalueComparison(eps, compare_eigenvalues, f));
  CHECK(EPSSetWhichEigenpairs(eps, EPS_WHICH_USER));
  CHECK(EPSSetDimensions(eps, wanted, PETSC_DEFAULT, PETSC_DEFAULT));
  CHECK(EPSSetTolerances(eps, f->solid->settings.eps_tol, f->solid->settings.eps_max_iterations));
  CHECK(EPSSetDeflationSpace(eps, f->count, f->vectors));
  CHECK(EPSGetST(eps, &st));
  CHECK(STSetType(st, STSINVERT));
  CHECK(STSetShift(st, 0));
  CHECK(STGetKSP(st, &ksp));
  CHECK(KSPSetType(ksp, KSPPREONLY));
  CHECK(KSPGetPC(ksp, &pc));
  CHECK(PCSetType(pc, PCSHELL));
  CHECK(PCShellSetContext(pc, f->solid));
  CHECK(PCShellSetApply(pc, apply_factor));
  return 0;
}

/* Takes what has converged at the end that was searched. */
static PetscErrorCode collect(EPS eps, struct eigen *f)
{
  PetscInt converged;
  CHECK(EPSGetConverged(eps, &converged));
  for (PetscInt i = 0; i < converged && f->count < f->capacity; i++) {
    PetscScalar value;
    CHECK(EPSGetEigenpair(eps, i, &value, NULL, f->vectors[f->count], NULL));
    f->value[f->count] = value;
    f->count += (value < 0) == f->below;
  }
  return 0;
}

static PetscErrorCode search_end(struct eigen *f, PetscInt wanted)
{
  EPS eps;
  CHECK(EPSCreate(PETSC_COMM_WORLD, &eps));
  PetscErrorCode code = configure(eps, f, wanted);
  code = code == 0 ? EPSSolve(eps) : code;
  code = code == 0 ? collect(eps, f) : code;
  EPSDestroy(&eps);
  return code;
}

static void sort(struct eigen *f)
{
  int *order = f->order;
  for (int i = 0; i < f->count; i++) {
    int at = i;
    while (at > 0 && f->value[order[at - 1]] > f->value[i]) {
      order[at] = order[at - 1];
      at--;
    }
    order[at] = i;
  }
}

/* Modes below a value: negative pivots of K - value B. Leaves K as it was and no factor of it. */
static dea_status count_below(struct dea_context *ctx, struct eigen *f, double value, int *count)
{
  struct dea_solid *s = f->solid;
  DEA_TRY(ctx, dea_solid_add_matrix(ctx, s->work.K, -value, f->B));
  DEA_TRY(ctx, dea_solid_factorise(ctx, s, DEA_FACTOR_EXACT, count));
  return DEA_CHAIN(ctx, dea_solid_add_matrix(ctx, s->work.K, value, f->B));
}

/* Whether the `count` lowest found are the lowest there are: there is a gap behind some of those
 * found, at least `count` of them, and as many lie below it. */
static dea_status certify(struct dea_context *ctx, struct eigen *f, int count, bool *all)
{
  *all = false;
  for (int k = count; k <= f->count; k++) { // behind the last found there may be none
    double low = f->value[f->order[k - 1]];
    double high = k < f->count ? f->value[f->order[k]] : low + fabs(low);
    if (high - low > min_gap * (fabs(low) + fabs(high))) {
      int below = 0;
      DEA_TRY(ctx, count_below(ctx, f, 0.5 * (low + high), &below));
      *all = below == k;
      return DEA_OK;
    }
  }
  return DEA_OK;
}

/* Rounds at one end until `count` modes are there: of unstable ones those that the inertia has
 * counted, of others until a count says that none is missing. Lanczos finds one of several equal
 * ones in a round. */
static dea_status find_end(struct dea_context *ctx, struct eigen *f, int count, bool below)
{
  // of few modes, one more: with more asked for, Lanczos' first space of vectors does not do
  const PetscInt extra = (count + 1) / 2 < MAX_EXTRA ? (count + 1) / 2 : MAX_EXTRA;
  PetscInt wanted = below ? count : count - f->count + extra + (PetscInt)(first_extra * count);
  f->below = below;
  for (int round = 0; round < MAX_ROUNDS; round++) {
    PetscInt before = f->count;
    wanted = wanted < f->capacity - f->count ? wanted : f->capacity - f->count;
    if (wanted < 1) {
      break;
    }
    DEA_TRY(ctx, dea_solid_petsc(ctx, search_end(f, wanted), "EPSSolve"));
    sort(f);
    bool all = f->count >= count;
    DEA_TRY(ctx, !below ? certify(ctx, f, count, &all) : DEA_OK);
    if (all) {
      return DEA_OK;
    }
    if (f->count == before) {
      break;
    }
    int negative;
    DEA_TRY(ctx, !below ? dea_solid_factorise(ctx, f->solid, DEA_FACTOR_EXACT, &negative) : DEA_OK);
    wanted = below ? count - f->count : MAX_EXTRA + count / 2;
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "only %d modes were found, and not all up to the %d-th",
                  (int)f->count, count);
}

static dea_status create_metric(struct dea_context *ctx, struct dea_solid *s,
                                enum dea_mode_metric metric, Mat *B)
{
  return metric == DEA_MODES_BY_MASS ? dea_solid_create_mass(ctx, s, B)
                                     : dea_solid_create_volume(ctx, s, B);
}

/* The sign of a mode [count] so that its largest component is positive. */
static void orient(size_t count, double *v)
{
  double most = 0;
  for (size_t i = 0; i < count; i++) {
    most = fabs(v[i]) > (1 + 1e-6) * fabs(most) ? v[i] : most; // the first one of equals
  }
  for (size_t i = 0; i < count && most < 0; i++) {
    v[i] = -v[i];
  }
}

/* Values of the `count` lowest once more, by v . K v of elements over v . B v: of SLEPc's, the
 * factor of K leaves them to 1e-9. */
static dea_status refine(struct dea_context *ctx, struct eigen *f, size_t count)
{
  struct dea_solid *s = f->solid;
  const size_t dofs = s->problem.dofs;
  double *v = dea_arena_alloc(&f->memory, count * dofs, sizeof *v);
  double *stiffness = dea_arena_alloc(&f->memory, count, sizeof *stiffness);
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(&f->memory)));
  for (size_t k = 0; k < count; k++) {
    DEA_TRY(ctx, dea_solid_from_vector(ctx, s, f->vectors[f->order[k]], v + k * dofs));
  }
  DEA_TRY(ctx, dea_solid_curvatures(ctx, s, count, v, stiffness));
  for (size_t k = 0; k < count; k++) {
    PetscReal moves;
    DEA_PETSC(ctx, MatMult(f->B, f->vectors[f->order[k]], s->work.right));
    DEA_PETSC(ctx, VecDot(f->vectors[f->order[k]], s->work.right, &moves));
    f->value[f->order[k]] = stiffness[k] / moves;
  }
  sort(f);
  return DEA_OK;
}

/* vector: [count][dofs], of which the first ones of each are displacements. */
static dea_status hand_over(struct dea_context *ctx, const struct eigen *f, size_t count,
                            size_t dofs, double *value, double *vector)
{
  struct dea_solid *s = f->solid;
  for (size_t k = 0; k < count; k++) {
    value[k] = f->value[f->order[k]];
    if (vector != NULL) {
      DEA_TRY(ctx, dea_solid_from_vector(ctx, s, f->vectors[f->order[k]], s->work.trial));
      memcpy(vector + k * dofs, s->work.trial, dofs * sizeof *vector);
      orient(dofs, vector + k * dofs);
    }
  }
  return DEA_OK;
}

/* `unstable` modes of those that are, and the lowest of all up to `count`. */
static dea_status find_modes(struct dea_context *ctx, struct eigen *f, enum dea_mode_metric metric,
                             int unstable, int count)
{
  f->capacity = 3 * (unstable > count ? unstable : count) + 8 * MAX_EXTRA;
  f->memory.ctx = ctx;
  f->order = dea_arena_alloc(&f->memory, (size_t)f->capacity, sizeof *f->order);
  f->value = dea_arena_alloc(&f->memory, (size_t)f->capacity, sizeof *f->value);
  DEA_TRY_MEMORY(!dea_solid_allreduce_any(f->memory.failed));
  DEA_TRY(ctx, create_metric(ctx, f->solid, metric, &f->B));
  DEA_PETSC(ctx, VecDuplicateVecs(f->solid->work.right, f->capacity, &f->vectors));
  DEA_TRY(ctx, unstable > 0 ? find_end(ctx, f, unstable, true) : DEA_OK);
  return DEA_CHAIN(ctx, count > unstable ? find_end(ctx, f, count, false) : DEA_OK);
}

static void release(struct eigen *f)
{
  if (f->vectors != NULL) {
    VecDestroyVecs(f->capacity, &f->vectors);
  }
  MatDestroy(&f->B);
  dea_arena_free(&f->memory);
  f->solid->found.factor_fits = f->solid->found.predicted_fits = false;
}

/* one: of more unstable modes than can be found any one does. */
static dea_status find_lowest(struct dea_context *ctx, struct dea_solid *s,
                              enum dea_mode_metric metric, size_t count, bool one, size_t dofs,
                              double *value, double *vector)
{
  struct eigen f = {.solid = s};
  int negative = 0;
  if (count == 0 || count > DEA_MODES_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "1 to %d modes can be asked for", DEA_MODES_MAX);
  }
  DEA_TRY(ctx, dea_solid_check(ctx, s));
  DEA_TRY(ctx, dea_solid_factor_stiff(ctx, s, &negative));
  if (negative > DEA_MODES_MAX && !one) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "%d modes are unstable: too many to find each",
                    negative);
  }
  negative = negative > DEA_MODES_MAX ? 1 : negative;
  dea_status status = find_modes(ctx, &f, metric, negative, (int)count);
  status = status == DEA_OK && metric == DEA_MODES_BY_MASS ? refine(ctx, &f, count) : status;
  status = status == DEA_OK ? hand_over(ctx, &f, count, dofs, value, vector) : status;
  release(&f);
  return DEA_CHAIN(ctx, status);
}

dea_status dea_solid_modes_lowest(struct dea_context *ctx, struct dea_solid *s,
                                  enum dea_mode_metric metric, size_t count, double *value,
                                  double *vector)
{
  const size_t moves = 3 * s->problem.grid->node_count;
  return DEA_CHAIN(ctx, find_lowest(ctx, s, metric, count, false, moves, value, vector));
}

dea_status dea_solid_modes_whole(struct dea_context *ctx, struct dea_solid *s,
                                 enum dea_mode_metric metric, size_t count, double *value,
                                 double *vector)
{
  return DEA_CHAIN(ctx, find_lowest(ctx, s, metric, count, false, s->problem.dofs, value, vector));
}

dea_status dea_solid_unstable_mode(struct dea_context *ctx, struct dea_solid *s, double *value,
                                   double *vector)
{
  const size_t moves = 3 * s->problem.grid->node_count;
  return DEA_CHAIN(ctx, find_lowest(ctx, s, DEA_MODES_BY_VOLUME, 1, true, moves, value, vector));
}

dea_status dea_solid_modes_below(struct dea_context *ctx, struct dea_solid *s,
                                 enum dea_mode_metric metric, double value, size_t *count)
{
  struct eigen f = {.solid = s};
  int below = 0;
  DEA_TRY(ctx, dea_solid_check(ctx, s));
  DEA_TRY(ctx, dea_solid_factor_stiff(ctx, s, &below));
  dea_status status = create_metric(ctx, s, metric, &f.B);
  status = status == DEA_OK && value != 0 ? count_below(ctx, &f, value, &below) : status;
  release(&f);
  *count = (size_t)below;
  return DEA_CHAIN(ctx, status);
}
