/* Response of a solid with branches to an AC excitation of the voltage: its stiffness is complex
 * and depends on the frequency, so that the system is solved at each (docs/theory/vibration.md). */
#include "model/solid/assembly/channels.h"
#include "model/solid/assembly/incompressible.h"
#include "model/solid/assembly/internal_variables.h"
#include "model/solid/assembly/mass.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/motion/response.h"

#include <complex.h>
#include <string.h>

enum { PARTS = 2 }; // K without branches, M; then one per different set of branches

struct system {
  struct dea_arena memory; // of all arrays
  struct dea_solid *solid;
  const struct dea_branches *branches;
  const struct dea_damping *damping;
  size_t part_count;         // PARTS + different branches
  Mat *part;                 // K, M, then what branches add at infinite frequency
  size_t *part_material;     // [part_count] one that has those
  double complex *share;     // [part_count] that each counts at the frequency
  struct dea_branches *only; // [part materials] work
  double complex *row;       // [longest row] work
  double *force;             // [dofs] per volt
  double *real, *imaginary;  // [dofs] the answer
  Mat A, factor;             // two rows a row of K: real and imaginary part
  Vec right, answer;
};

/* A matrix of K's rows with the tangent as it stands now. */
static dea_status copy_tangent(struct dea_context *ctx, struct system *y, Mat *out)
{
  DEA_TRY(ctx, dea_solid_assemble_stiff(ctx, y->solid));
  DEA_PETSC(ctx, MatDuplicate(y->solid->work.K, MAT_COPY_VALUES, out));
  return DEA_OK;
}

static bool are_alike(const struct dea_branches *a, const struct dea_branches *b)
{
  bool alike = a->count == b->count;
  for (size_t i = 0; i < a->count && alike; i++) {
    alike = a->branch[i].modulus_Pa == b->branch[i].modulus_Pa &&
            a->branch[i].time_s == b->branch[i].time_s;
  }
  return alike;
}

/* What these branches add to K when they are rigid dashpots, in all part materials that have them.
 */
static dea_status branch_tangent(struct dea_context *ctx, struct system *y, size_t which, Mat *out)
{
  struct dea_solid *s = y->solid;
  struct dea_arena memory = {.ctx = ctx};
  struct dea_internal_variables *variables;
  // NOLINTNEXTLINE(clang-analyzer-core.NonNullParamChecker): of the caller
  memset(y->only, 0, s->problem.part_material_count * sizeof *y->only);
  for (size_t l = which; l < s->problem.part_material_count; l++) {
    if (are_alike(&y->branches[l], &y->branches[which])) {
      y->only[l] = y->branches[l];
    }
  }
  dea_status status = dea_internal_variables_create(ctx, s, y->only, &memory, &variables);
  if (status == DEA_OK) {
    dea_internal_variables_begin(variables, s, 0);
    s->state.internal_variables = variables;
    status = copy_tangent(ctx, y, out);
    s->state.internal_variables = NULL;
  }
  dea_arena_free(&memory);
  DEA_TRY(ctx, status);
  return DEA_CHAIN(ctx, dea_solid_add_matrix(ctx, *out, -1, y->part[0]));
}

/* Without branches: what they add makes a film that buckles only slow to do so. */
static dea_status check_stable(struct dea_context *ctx, struct dea_solid *s)
{
  int negative;
  DEA_TRY(ctx, dea_solid_factor_stiff(ctx, s, &negative));
  return negative == 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_NOT_CONVERGED,
                        "the equilibrium that the voltage oscillates about is unstable (%d modes)",
                        negative);
}

static dea_status build_parts(struct dea_context *ctx, struct system *y)
{
  y->part_count = PARTS;
  DEA_TRY(ctx, copy_tangent(ctx, y, &y->part[0]));
  DEA_TRY(ctx, dea_solid_create_mass(ctx, y->solid, &y->part[1]));
  for (size_t l = 0; l < y->solid->problem.part_material_count; l++) {
    bool made = y->branches[l].count == 0;
    for (size_t p = PARTS; p < y->part_count && !made; p++) {
      made = are_alike(&y->branches[l], &y->branches[y->part_material[p]]);
    }
    if (!made) {
      y->part_material[y->part_count] = l;
      DEA_TRY(ctx, branch_tangent(ctx, y, l, &y->part[y->part_count++]));
    }
  }
  return DEA_OK;
}

/* The share of a part material's branches that has not followed, 0 slow to 1 fast. */
static double complex share_at(const struct dea_branches *b, double w)
{
  double complex sum = 0;
  double whole = 0;
  for (size_t i = 0; i < b->count; i++) {
    double complex x = _Complex_I * (w * b->branch[i].time_s);
    sum += b->branch[i].modulus_Pa * x / (1 + x);
    whole += b->branch[i].modulus_Pa;
  }
  return whole > 0 ? sum / whole : 0;
}

/* What each part counts in the matrix at a frequency. */
static void set_shares(const struct system *y, double w)
{
  y->share[0] = 1 + _Complex_I * (w * y->damping->stiffness_s);
  y->share[1] = -w * w + _Complex_I * (w * y->damping->mass_per_s);
  for (size_t p = PARTS; p < y->part_count; p++) {
    y->share[p] = share_at(&y->branches[y->part_material[p]], w);
  }
}

/* Rows of the parts are read one by one: all have the columns of K. */
static PetscErrorCode begin_rows(const struct system *y, PetscErrorCode (*set)(Mat))
{
  PetscErrorCode code = 0;
  for (size_t p = 0; p < y->part_count && code == 0; p++) {
    code = set(y->part[p]);
  }
  return code;
}

/* Adds a row to A: (a_r + i a_i)(q_r + i q_i) = f + 0 i as the symmetric
 * [a_r, -a_i; -a_i, -a_r] [q_r; q_i] = [f; 0]. */
static PetscErrorCode add_row(const struct system *y, PetscInt row)
{
  PetscInt count = 0;
  const PetscInt *columns;
  const PetscScalar *values;
  PetscErrorCode code = 0;
  for (size_t p = 0; p < y->part_count && code == 0; p++) {
    code = MatGetRow(y->part[p], row, &count, &columns, &values);
    for (PetscInt k = 0; k < count && code == 0; k++) {
      y->row[k] = (p == 0 ? 0 : y->row[k]) + y->share[p] * values[k];
    }
    for (PetscInt k = 0; k < count && code == 0 && p + 1 == y->part_count; k++) {
      double re = creal(y->row[k]), im = cimag(y->row[k]);
      const PetscScalar block[4] = {re, -im, -im, -re};
      code = MatSetValuesBlocked(y->A, 1, &row, 1, &columns[k], block, INSERT_VALUES);
    }
    code = code == 0 ? MatRestoreRow(y->part[p], row, &count, &columns, &values) : code;
  }
  return code;
}

/* Lengths of this rank's rows of K, upper triangle; count[2][rows]: columns here and on others. */
static PetscErrorCode count_rows(const struct system *y, PetscInt from, PetscInt end,
                                 PetscInt *here, PetscInt *others, PetscInt *longest)
{
  Mat K = y->part[0];
  PetscErrorCode code = MatGetRowUpperTriangular(K);
  *longest = 0;
  for (PetscInt row = from; row < end && code == 0; row++) {
    PetscInt count;
    const PetscInt *columns;
    code = MatGetRow(K, row, &count, &columns, NULL);
    here[row - from] = others[row - from] = 0;
    for (PetscInt k = 0; k < count && code == 0; k++) {
      (columns[k] < end ? here : others)[row - from]++;
    }
    *longest = count > *longest ? count : *longest;
    code = code == 0 ? MatRestoreRow(K, row, &count, &columns, NULL) : code;
  }
  return code == 0 ? MatRestoreRowUpperTriangular(K) : code;
}

static dea_status prepare_matrix(struct dea_context *ctx, struct system *y)
{
  PetscInt from, end, longest = 0;
  DEA_PETSC(ctx, MatGetOwnershipRange(y->part[0], &from, &end));
  const PetscInt rows = end - from;
  PetscInt *here = dea_arena_alloc(&y->memory, (size_t)rows + 1, sizeof *here);
  PetscInt *others = dea_arena_alloc(&y->memory, (size_t)rows + 1, sizeof *others);
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(&y->memory)));
  DEA_TRY(ctx, dea_solid_petsc(ctx, count_rows(y, from, end, here, others, &longest), "MatGetRow"));
  DEA_PETSC(ctx, MatCreateSBAIJ(PETSC_COMM_WORLD, 2, 2 * rows, 2 * rows, PETSC_DETERMINE,
                                PETSC_DETERMINE, 0, here, 0, others, &y->A));
  DEA_PETSC(ctx, MatCreateVecs(y->A, &y->answer, &y->right));
  y->row = dea_arena_alloc(&y->memory, (size_t)longest + 1, sizeof *y->row);
  return DEA_CHAIN(ctx, dea_solid_allreduce(ctx, dea_arena_status(&y->memory)));
}

static PetscErrorCode fill_matrix(const struct system *y)
{
  PetscInt from, end;
  PetscErrorCode code = MatGetOwnershipRange(y->part[0], &from, &end);
  code = code == 0 ? MatZeroEntries(y->A) : code;
  code = code == 0 ? begin_rows(y, MatGetRowUpperTriangular) : code;
  for (PetscInt row = from; row < end && code == 0; row++) {
    code = add_row(y, row);
  }
  return code == 0 ? begin_rows(y, MatRestoreRowUpperTriangular) : code;
}

/* Between a vector of K's rows and every second entry of one of A's. */
static dea_status interleave(struct dea_context *ctx, Vec rows, Vec pairs, int offset, bool back)
{
  PetscInt count;
  PetscScalar *a, *b;
  DEA_PETSC(ctx, VecGetLocalSize(rows, &count));
  DEA_PETSC(ctx, VecGetArray(rows, &a));
  DEA_PETSC(ctx, VecGetArray(pairs, &b));
  for (PetscInt i = 0; i < count; i++) {
    if (back) {
      a[i] = b[2 * i + offset];
    } else {
      b[2 * i + offset] = a[i];
    }
  }
  DEA_PETSC(ctx, VecRestoreArray(pairs, &b));
  DEA_PETSC(ctx, VecRestoreArray(rows, &a));
  return DEA_OK;
}

/* One frequency: q_r and q_i of the whole. */
static dea_status solve_at(struct dea_context *ctx, struct system *y, double w)
{
  struct dea_solid *s = y->solid;
  double *const out[2] = {y->real, y->imaginary};
  set_shares(y, w);
  dea_status status = dea_solid_petsc(ctx, fill_matrix(y), "MatSetValuesBlocked");
  DEA_TRY(ctx, dea_solid_end_matrix(ctx, y->A));
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, dea_solid_factor(ctx, y->A, &y->factor));
  DEA_PETSC(ctx, MatSolve(y->factor, y->right, y->answer));
  for (int c = 0; c < 2; c++) {
    DEA_TRY(ctx, interleave(ctx, s->work.solution, y->answer, c, true));
    DEA_TRY(ctx, dea_solid_from_vector(ctx, s, s->work.solution, out[c]));
  }
  return DEA_OK;
}

/* The force per volt as the right side. */
static dea_status set_right(struct dea_context *ctx, struct system *y)
{
  struct dea_solid *s = y->solid;
  DEA_TRY(ctx, dea_solid_to_vector(ctx, s, y->force, s->work.right));
  DEA_PETSC(ctx, VecSet(y->right, 0));
  return DEA_CHAIN(ctx, interleave(ctx, s->work.right, y->right, 0, false));
}

static dea_status prepare(struct dea_context *ctx, struct system *y)
{
  const size_t materials = y->solid->problem.part_material_count, parts = PARTS + materials;
  y->part = dea_arena_alloc(&y->memory, parts, sizeof *y->part);
  y->part_material = dea_arena_alloc(&y->memory, parts, sizeof *y->part_material);
  y->share = dea_arena_alloc(&y->memory, parts, sizeof *y->share);
  y->only = dea_arena_alloc(&y->memory, materials, sizeof *y->only);
  dea_solid_alloc_doubles(&y->memory, y->solid->problem.dofs,
                          (double **[]){&y->force, &y->real, &y->imaginary, NULL});
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(&y->memory)));
  DEA_TRY(ctx, check_stable(ctx, y->solid));
  DEA_TRY(ctx, dea_solid_voltage_force(ctx, y->solid, 0, y->force));
  DEA_TRY(ctx, build_parts(ctx, y));
  DEA_TRY(ctx, prepare_matrix(ctx, y));
  return DEA_CHAIN(ctx, set_right(ctx, y));
}

static void release(struct system *y)
{
  for (size_t p = 0; p < y->part_count; p++) {
    MatDestroy(&y->part[p]);
  }
  MatDestroy(&y->A);
  MatDestroy(&y->factor);
  VecDestroy(&y->right);
  VecDestroy(&y->answer);
  dea_arena_free(&y->memory);
  y->solid->found.factor_fits = y->solid->found.predicted_fits = false;
}

dea_status
dea_solid_respond_viscous(struct dea_context *ctx, struct dea_solid *s,
                          const struct dea_branches *branches, const struct dea_damping *damping,
                          const double *rad_per_s, size_t count,
                          dea_status (*take)(struct dea_context *ctx, void *user, size_t i,
                                             const double *real, const double *imaginary),
                          void *user)
{
  struct system y = {.memory = {.ctx = ctx}, .solid = s, .branches = branches, .damping = damping};
  DEA_TRY(ctx, dea_solid_response_check(ctx, s));
  if (s->work.rank_one.count > 0) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "the answer of viscous plies to an excitation does not know enclosed volumes: "
                    "take `viscosity: none` for them, or a history in time (compute.transient)");
  }
  dea_status status = prepare(ctx, &y);
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    if (dea_interrupted_anywhere(ctx)) {
      status = dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted at frequency %zu of %zu", i, count);
      break;
    }
    status = solve_at(ctx, &y, rad_per_s[i]);
    status = status == DEA_OK ? take(ctx, user, i, y.real, y.imaginary) : status;
  }
  release(&y);
  return DEA_CHAIN(ctx, status);
}
