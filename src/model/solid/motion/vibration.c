#include "model/solid/motion/vibration.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/incompressible.h"
#include "model/solid/assembly/mass.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/equilibrium/check.h"
#include "model/solid/equilibrium/modes.h"

#include <slepceps.h>

#include <math.h>
#include <string.h>

enum { ROUNDS_MAX = 6, EXTRA = 4 };

static const double sharp = 1e-10;    // relative residual of a mode
static const double apart = 1e-6;     // relative distance of two frequencies that a count can tell
static const double room_share = 0.5; // of the modes, that more are asked for at first

struct found {
  struct dea_solid *solid;
  Mat M;
  Vec *vectors; // [count] of them, room for `room`
  PetscReal *square;
  int *order; // the k-th lowest
  PetscInt count, room;
};

/* K at the equilibrium of the solid as good as incompressible, into s->K, and its factor. */
static dea_status prepare_tangent(struct dea_context *ctx, struct dea_solid *s, int *negative)
{
  DEA_TRY(ctx, dea_solid_check(ctx, s));
  DEA_TRY(ctx, dea_solid_factor_stiff(ctx, s, negative));
  return DEA_OK;
}

/* y = K^-1 x with the factor that is there. */
static PetscErrorCode apply_factor(PC pc, Vec x, Vec y)
{
  struct dea_solid *s;
  PetscErrorCode code = PCShellGetContext(pc, &s);
  return code != 0 ? code : MatSolve(s->factor, x, y);
}

#define CHECK(call)                                                                                \
  do {                                                                                             \
    PetscErrorCode code_ = (call);                                                                 \
    if (code_ != 0) {                                                                              \
      return code_;                                                                                \
    }                                                                                              \
  } while (0)

/* The eigenvalues of smallest size of K v = omega^2 M v, `wanted` of them, beside those found. */
static PetscErrorCode configure(EPS eps, struct found *f, PetscInt wanted)
{
  ST st;
  KSP ksp;
  PC pc;
  CHECK(EPSSetOperators(eps, f->solid->K, f->M));
  CHECK(EPSSetProblemType(eps, EPS_GHEP));
  CHECK(EPSSetType(eps, EPSKRYLOVSCHUR));
  CHECK(EPSSetTarget(eps, 0));
  CHECK(EPSSetWhichEigenpairs(eps, EPS_TARGET_MAGNITUDE));
  CHECK(EPSSetDimensions(eps, wanted, PETSC_DEFAULT, PETSC_DEFAULT));
  CHECK(EPSSetTolerances(eps, sharp, 1000));
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

/* Takes what has converged. */
static PetscErrorCode collect(EPS eps, struct found *f)
{
  PetscInt converged;
  CHECK(EPSGetConverged(eps, &converged));
  for (PetscInt i = 0; i < converged && f->count < f->room; i++) {
    PetscScalar value;
    CHECK(EPSGetEigenpair(eps, i, &value, NULL, f->vectors[f->count], NULL));
    f->square[f->count++] = value;
  }
  return 0;
}

static PetscErrorCode search(struct found *f, PetscInt wanted)
{
  EPS eps;
  CHECK(EPSCreate(PETSC_COMM_WORLD, &eps));
  PetscErrorCode code = configure(eps, f, wanted);
  code = code == 0 ? EPSSolve(eps) : code;
  code = code == 0 ? collect(eps, f) : code;
  EPSDestroy(&eps);
  return code;
}

static void sort(struct found *f)
{
  int *order = f->order;
  for (int i = 0; i < f->count; i++) {
    int at = i;
    while (at > 0 && f->square[order[at - 1]] > f->square[i]) {
      order[at] = order[at - 1];
      at--;
    }
    order[at] = i;
  }
}

/* Modes below sigma: negative pivots of K - sigma M. Leaves K as it was and no factor of it. */
static dea_status count_below(struct dea_context *ctx, struct found *f, double sigma, int *count)
{
  struct dea_solid *s = f->solid;
  dea_status status = dea_solid_add_mass(ctx, s, s->K, -sigma);
  if (status == DEA_OK) {
    status = dea_solid_factorise(ctx, s, count);
  }
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, dea_solid_add_mass(ctx, s, s->K, sigma));
  return DEA_OK;
}

/* Whether the `count` lowest found are the lowest there are: there is a gap behind some of those
 * found, at least `count` of them, and as many lie below it. */
static dea_status certify(struct dea_context *ctx, struct found *f, int count, bool *all)
{
  *all = false;
  for (int k = count; k <= f->count; k++) { // behind the last found there may be none
    double low = f->square[f->order[k - 1]];
    double high = k < f->count ? f->square[f->order[k]] : low + fabs(low);
    if (high - low > apart * (fabs(low) + fabs(high))) {
      int below;
      DEA_TRY(ctx, count_below(ctx, f, 0.5 * (low + high), &below));
      *all = below == k;
      return DEA_OK;
    }
  }
  return DEA_OK;
}

/* Rounds until a count says that none is missing. */
static dea_status find(struct dea_context *ctx, struct found *f, int count)
{
  PetscInt wanted = count + EXTRA + (PetscInt)(room_share * count);
  for (int round = 0; round < ROUNDS_MAX; round++) {
    bool all = false;
    PetscInt before = f->count;
    wanted = wanted < f->room - f->count ? wanted : f->room - f->count;
    if (wanted < 1) {
      break;
    }
    if (round > 0) {
      DEA_TRY(ctx, dea_solid_factor(ctx, f->solid->K, &f->solid->factor));
    }
    DEA_PETSC(ctx, search(f, wanted));
    sort(f);
    DEA_TRY(ctx, certify(ctx, f, count, &all));
    if (all) {
      return DEA_OK;
    }
    if (f->count == before) {
      break;
    }
    wanted = EXTRA + count / 2;
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "only %d modes were found, and not all up to the %d-th",
                  (int)f->count, count);
}

static dea_status hand_over(struct dea_context *ctx, const struct found *f, size_t count,
                            double *square, double *vector)
{
  struct dea_solid *s = f->solid;
  size_t dofs = 3 * s->grid->node_count;
  for (size_t k = 0; k < count; k++) {
    square[k] = f->square[f->order[k]];
    if (vector != NULL) {
      DEA_TRY(ctx, dea_solid_from_vector(ctx, s, f->vectors[f->order[k]], s->trial));
      memcpy(vector + k * dofs, s->trial, dofs * sizeof *vector);
      dea_mode_orient(dofs, vector + k * dofs);
    }
  }
  return DEA_OK;
}

/* Room for modes: those nearest to 0 are found first, so that all unstable ones have to be. */
static dea_status make_room(struct dea_context *ctx, struct found *f, int needed)
{
  f->room = 3 * needed + 8 * EXTRA;
  f->order = dea_alloc(ctx, (size_t)f->room, sizeof *f->order);
  f->square = dea_alloc(ctx, (size_t)f->room, sizeof *f->square);
  if (dea_solid_any(f->order == NULL || f->square == NULL)) {
    return DEA_E_MEMORY;
  }
  DEA_PETSC(ctx, VecDuplicateVecs(f->solid->right, f->room, &f->vectors));
  return DEA_OK;
}

static dea_status vibrations(struct dea_context *ctx, struct found *f, size_t count, double *square,
                             double *vector)
{
  int negative;
  DEA_TRY(ctx, prepare_tangent(ctx, f->solid, &negative));
  if (negative > DEA_VIBRATIONS_MAX) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "%d modes are unstable: too many to find each",
                    negative);
  }
  int needed = negative > (int)count ? negative : (int)count;
  DEA_TRY(ctx, dea_solid_create_mass(ctx, f->solid, &f->M));
  DEA_TRY(ctx, make_room(ctx, f, needed));
  DEA_TRY(ctx, find(ctx, f, needed));
  DEA_TRY(ctx, hand_over(ctx, f, count, square, vector));
  return DEA_OK;
}

dea_status dea_solid_vibrations(struct dea_context *ctx, struct dea_solid *s, size_t count,
                                double *square, double *vector)
{
  if (count == 0 || count > DEA_VIBRATIONS_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "1 to %d modes can be asked for", DEA_VIBRATIONS_MAX);
  }
  struct found f = {.solid = s};
  dea_status status = vibrations(ctx, &f, count, square, vector);
  if (f.vectors != NULL) {
    VecDestroyVecs(f.room, &f.vectors);
  }
  MatDestroy(&f.M);
  dea_free(ctx, f.square);
  dea_free(ctx, f.order);
  s->factor_fits = s->predicted_fits = false;
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

dea_status dea_solid_vibration_count(struct dea_context *ctx, struct dea_solid *s, double square,
                                     size_t *count)
{
  int below = 0;
  struct found f = {.solid = s};
  DEA_TRY(ctx, prepare_tangent(ctx, s, &below));
  DEA_TRY(ctx, count_below(ctx, &f, square, &below));
  *count = (size_t)below;
  return DEA_OK;
}
