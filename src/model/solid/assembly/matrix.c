/* The matrix K of a solid: which rank has which rows and elements, room for the entries, local axes
 * of its rows, factor and solutions. */
#include "model/solid/assembly/matrix.h"

#include "model/solid/assembly/bodies.h"
#include "model/solid/assembly/fronts.h"
#include "model/solid/assembly/rank_one.h"

#include <string.h>

/* ---- local axes ---- */

dea_status dea_solid_frames_create(struct dea_context *ctx, struct dea_solid *s,
                                   const struct dea_solid_options *options)
{
  struct dea_solid_problem *p = &s->problem;
  size_t nodes = p->grid->node_count, count = 0;
  double Q[9];
  for (size_t n = 0; options->frame != NULL && n < nodes; n++) {
    count += !dea_solid_is_of_body(s, n) && options->frame(options->self, p->grid->X + 3 * n, Q);
  }
  if (count == 0) {
    return DEA_OK;
  }
  p->frame = dea_arena_alloc(&s->memory, nodes, sizeof *p->frame);
  p->frames = dea_arena_alloc(&s->memory, count, sizeof *p->frames);
  DEA_TRY(ctx, dea_arena_status(&s->memory));
  count = 0;
  for (size_t n = 0; n < nodes; n++) {
    if (!dea_solid_is_of_body(s, n) && options->frame(options->self, p->grid->X + 3 * n, Q)) {
      memcpy(p->frames[count], Q, sizeof Q);
      p->frame[n] = (int)++count;
    }
  }
  return DEA_OK;
}

/* Local axes of a node, NULL: the global ones. */
static const double *frame_of(const struct dea_solid *s, size_t node)
{
  const struct dea_solid_problem *p = &s->problem;
  return p->frame == NULL || p->frame[node] == 0 ? NULL : p->frames[p->frame[node] - 1];
}

/* v = Q v or, back, v = Q^T v; the components of v lie `apart` from each other. */
static void turn(const double Q[9], bool back, double *v, size_t apart)
{
  double old[3] = {v[0], v[apart], v[2 * apart]};
  for (size_t i = 0; i < 3; i++) {
    v[apart * i] =
        back ? Q[i] * old[0] + Q[3 + i] * old[1] + Q[6 + i] * old[2] : dea_dot(Q + 3 * i, old);
  }
}

void dea_solid_frame_matrix(const struct dea_solid *s, int node_count, const int *nodes, double *K)
{
  size_t per = (size_t)s->problem.per_node, dofs = per * (size_t)node_count;
  for (size_t n = 0; n < (size_t)node_count; n++) {
    const double *Q = frame_of(s, (size_t)nodes[n]);
    if (Q != NULL) {
      for (size_t j = 0; j < dofs; j++) {
        turn(Q, false, K + per * n * dofs + j, dofs);
      }
      for (size_t i = 0; i < dofs; i++) {
        turn(Q, false, K + i * dofs + per * n, 1);
      }
    }
  }
}

void dea_solid_frame_vector(const struct dea_solid *s, bool back, double *v)
{
  for (size_t n = 0; s->problem.frame != NULL && n < s->problem.grid->node_count; n++) {
    const double *Q = frame_of(s, n);
    if (Q != NULL) {
      turn(Q, back, v + 3 * n, 1);
    }
  }
}

void dea_solid_release_held(const struct dea_solid *s, double *v)
{
  dea_solid_frame_vector(s, false, v);
  for (size_t i = 0; i < s->problem.dofs; i++) {
    v[i] = s->problem.held[i] && s->problem.held[i] != DEA_FOLLOWS ? 0 : v[i];
  }
  dea_solid_frame_vector(s, true, v);
}

/* ---- rows and room for entries ---- */

/* An element goes to the rank that has the row of a node in its middle, so that most of what it
 * adds to K stays there. */
static dea_status split_elements(struct dea_context *ctx, struct dea_solid *s)
{
  struct dea_solid_problem *p = &s->problem;
  const struct dea_grid *grid = p->grid;
  p->own = dea_arena_alloc(&s->memory, grid->element_count, sizeof *p->own);
  DEA_TRY(ctx, dea_arena_status(&s->memory));
  p->own_count = 0;
  for (size_t e = 0; e < grid->element_count; e++) {
    size_t node =
        (size_t)grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)dea_grid_nodes_of(grid, e) / 2];
    if (node >= p->first_node && node < p->end_node) {
      p->own[p->own_count++] = e;
    }
  }
  return DEA_OK;
}

/* Elements, and the pieces of loads that couple nodes beside them. */
static size_t couplings_of(const struct dea_solid *s)
{
  size_t count = s->problem.grid->element_count;
  for (size_t l = 0; l < s->problem.load_count; l++) {
    count += s->problem.loads[l].couples != NULL ? s->problem.loads[l].piece_count : 0;
  }
  return count;
}

/* Nodes of a coupling, the elements first, and those of the bodies that it touches. */
static int joint_nodes(const struct dea_solid *s, size_t e, int *joint)
{
  const struct dea_solid_problem *p = &s->problem;
  int own[DEA_PIECE_NODES_MAX], count = 0;
  const int *nodes = own;
  if (e < p->grid->element_count) {
    count = dea_solid_nodes(s, e, &nodes);
  } else {
    const struct dea_solid_load *load = p->loads;
    for (e -= p->grid->element_count; load->couples == NULL || e >= load->piece_count; load++) {
      e -= load->couples != NULL ? load->piece_count : 0;
    }
    count = load->couples(load->self, e, own);
  }
  return dea_solid_bodies_nodes(s, count, nodes, joint);
}

/* Couplings of each node: those of node i are elements[first[i]] to elements[first[i + 1] - 1].
 * first: [node_count + 2]. */
static void list_elements(const struct dea_solid *s, size_t *first, int *elements)
{
  const struct dea_grid *grid = s->problem.grid;
  const size_t couplings = couplings_of(s);
  int joint[DEA_JOINT_NODES_MAX];
  for (size_t e = 0; e < couplings; e++) {
    int count = joint_nodes(s, e, joint);
    for (int n = 0; n < count; n++) {
      first[joint[n] + 2]++;
    }
  }
  for (size_t i = 2; i < grid->node_count + 2; i++) {
    first[i] += first[i - 1];
  }
  for (size_t e = 0; e < couplings; e++) {
    int count = joint_nodes(s, e, joint);
    for (int n = 0; n < count; n++) {
      elements[first[joint[n] + 1]++] = (int)e;
    }
  }
}

/* Upper block row lengths of own rows: neighbours of a node that are not before it, those whose
 * rows are own and those of later ranks. */
static dea_status count_blocks(struct dea_context *ctx, const struct dea_solid *s,
                               struct dea_solid_row_lengths *out)
{
  const struct dea_solid_problem *p = &s->problem;
  const struct dea_grid *grid = p->grid;
  int joint[DEA_JOINT_NODES_MAX];
  size_t places = 0;
  for (size_t e = 0; e < couplings_of(s); e++) {
    places += (size_t)joint_nodes(s, e, joint);
  }
  size_t *first = dea_arena_alloc(&out->memory, grid->node_count + 2, sizeof *first);
  int *elements = dea_arena_alloc(&out->memory, places, sizeof *elements);
  int *seen = dea_arena_alloc(&out->memory, grid->node_count, sizeof *seen);
  DEA_TRY(ctx, dea_arena_status(&out->memory));
  list_elements(s, first, elements);
  for (size_t i = p->first_node; i < p->end_node; i++) {
    size_t row = i - p->first_node;
    for (size_t k = first[i]; k < first[i + 1]; k++) {
      int count = joint_nodes(s, (size_t)elements[k], joint);
      for (int n = 0; n < count; n++) {
        size_t column = (size_t)joint[n];
        if (column >= i && seen[column] != (int)i + 1) {
          seen[column] = (int)i + 1;
          *(column < p->end_node ? &out->own[row] : &out->others[row]) += 1;
        }
      }
    }
    out->own[row] += out->own[row] == 0; // a node of a body without elements
  }
  return DEA_OK;
}

static dea_status split_and_count(struct dea_context *ctx, struct dea_solid *s,
                                  struct dea_solid_row_lengths *lengths)
{
  const struct dea_solid_problem *p = &s->problem;
  size_t rows = p->end_node - p->first_node;
  DEA_TRY(ctx, split_elements(ctx, s));
  s->work.predicted = dea_arena_alloc(&s->memory, p->own_count * p->elements.predicted_count,
                                      sizeof *s->work.predicted);
  DEA_TRY(ctx, dea_arena_status(&s->memory));
  lengths->own = dea_arena_alloc(&lengths->memory, rows, sizeof *lengths->own);
  lengths->others = dea_arena_alloc(&lengths->memory, rows, sizeof *lengths->others);
  return DEA_CHAIN(ctx, count_blocks(ctx, s, lengths));
}

dea_status dea_solid_create_matrix(struct dea_context *ctx, struct dea_solid *s, dea_status before,
                                   struct dea_solid_row_lengths *lengths)
{
  struct dea_solid_problem *p = &s->problem;
  dea_solid_share(p->grid->node_count, &p->first_node, &p->end_node);
  dea_status status = before == DEA_OK ? split_and_count(ctx, s, lengths) : before;
  status = dea_solid_allreduce(ctx, status); // from here on all ranks have to take part
  DEA_TRY(ctx, status);
  PetscInt per = p->per_node, all = (PetscInt)p->dofs;
  PetscInt rows = per * (PetscInt)(p->end_node - p->first_node);
  DEA_PETSC(ctx, MatCreateSBAIJ(PETSC_COMM_WORLD, per, rows, rows, all, all, 0, lengths->own, 0,
                                lengths->others, &s->work.K));
  DEA_PETSC(ctx, MatSetOption(s->work.K, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE));
  DEA_PETSC(ctx, MatCreateVecs(s->work.K, &s->work.solution, &s->work.right));
  return DEA_OK;
}

void dea_solid_destroy_matrix(struct dea_solid *s)
{
  dea_fronts_destroy(s->memory.ctx, s->work.fronts);
  dea_solid_rank_one_destroy(s);
  MatDestroy(&s->work.factor);
  MatDestroy(&s->work.K);
  VecDestroy(&s->work.right);
  VecDestroy(&s->work.solution);
}

dea_status dea_solid_end_matrix(struct dea_context *ctx, Mat A)
{
  DEA_PETSC(ctx, MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  DEA_PETSC(ctx, MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  return DEA_OK;
}

dea_status dea_solid_stop_matrix(struct dea_context *ctx, Mat A)
{
  DEA_PETSC(ctx, MatAssemblyBegin(A, MAT_FLUSH_ASSEMBLY));
  DEA_PETSC(ctx, MatAssemblyEnd(A, MAT_FLUSH_ASSEMBLY));
  return DEA_OK;
}

dea_status dea_solid_add_matrix(struct dea_context *ctx, Mat A, double factor, Mat B)
{
  // of blocks on several ranks PETSc 3.18 adds only the first entries if told that patterns are one
  DEA_PETSC(ctx, MatAXPY(A, factor, B,
                         dea_solid_ranks() > 1 ? SUBSET_NONZERO_PATTERN : SAME_NONZERO_PATTERN));
  return DEA_OK;
}

/* amount times a matrix of numbers between the first `count` of nodes [all], as a block of K
 * without the rows and columns of held components; the others are those of bodies. */
static void block_of(const struct dea_solid *s, int count, int all, const int *nodes, double amount,
                     const double *scalar, double *block)
{
  int per = s->problem.per_node, dofs = per * count;
  memset(block, 0, (size_t)(dofs * dofs) * sizeof *block);
  for (int a = 0; a < count; a++) {
    for (int b = 0; b < count; b++) {
      for (int i = 0; i < 3; i++) {
        block[(per * a + i) * dofs + per * b + i] = amount * scalar[a * count + b];
      }
    }
  }
  if (all > count) {
    dea_solid_bodies_join(s, count, all, nodes, block, block);
    dofs = per * all;
  }
  dea_solid_frame_matrix(s, all, nodes, block);
  for (int i = 0; i < dofs; i++) {
    for (int j = 0; j < dofs && s->problem.held[dea_solid_at(s, nodes[i / per], i % per)]; j++) {
      block[i * dofs + j] = block[j * dofs + i] = 0;
    }
  }
}

dea_status dea_solid_add_scalar(struct dea_context *ctx, struct dea_solid *s, Mat A, double amount,
                                dea_status (*of)(const struct dea_solid *s, size_t e,
                                                 double *scalar))
{
  const struct dea_solid_problem *p = &s->problem;
  dea_status status = DEA_OK;
  dea_solid_bodies_prepare(s);
  for (size_t k = 0; k < p->own_count && status == DEA_OK; k++) {
    double scalar[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX];
    PetscInt block[DEA_JOINT_NODES_MAX];
    int nodes[DEA_JOINT_NODES_MAX];
    size_t e = p->own[k];
    int count = dea_grid_nodes_of(p->grid, e), all = joint_nodes(s, e, nodes);
    status = of(s, e, scalar);
    if (status == DEA_OK) {
      block_of(s, count, all, nodes, amount, scalar, s->work.element->K);
      for (int n = 0; n < all; n++) {
        block[n] = nodes[n];
      }
      status = dea_solid_petsc(
          ctx, MatSetValuesBlocked(A, all, block, all, block, s->work.element->K, ADD_VALUES),
          "MatSetValuesBlocked");
    }
  }
  status = dea_solid_allreduce(ctx, status);
  DEA_TRY(ctx, dea_solid_end_matrix(ctx, A));
  return DEA_CHAIN(ctx, status);
}

/* ---- factor and solutions ---- */

/* Analysis of A's pattern. room_percent: for pivots that come later than planned. */
static dea_status analyse(struct dea_context *ctx, Mat A, PetscInt room_percent, Mat *factor)
{
  MatFactorInfo info;
  MatFactorInfoInitialize(&info);
  DEA_PETSC(ctx, MatGetFactor(A, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, factor));
  DEA_PETSC(ctx, MatMumpsSetIcntl(*factor, 24, 1)); // null pivots and
  DEA_PETSC(ctx, MatMumpsSetIcntl(*factor, 13, 1)); // no parallel root, so that inertia is counted
  DEA_PETSC(ctx, MatMumpsSetIcntl(*factor, 14, room_percent));
  DEA_PETSC(ctx, MatMumpsSetIcntl(*factor, 8, 1)); // scaled by its diagonal, which takes no passes
  DEA_PETSC(ctx, MatCholeskyFactorSymbolic(*factor, A, NULL, &info));
  return DEA_OK;
}

/* What MUMPS says of a factor that PETSc has made without an error of its own. */
static dea_status factor_failure(struct dea_context *ctx, Mat factor, MatFactorError error)
{
  PetscInt info = 0;
  switch (error) {
  case MAT_FACTOR_NOERROR:
    return DEA_OK;
  case MAT_FACTOR_OUTMEMORY:
    return dea_fail(ctx, DEA_E_MEMORY,
                    "out of memory while factorising the stiffness matrix: take a coarser mesh");
  case MAT_FACTOR_STRUCT_ZEROPIVOT:
  case MAT_FACTOR_NUMERIC_ZEROPIVOT:
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the tangent is singular");
  default:
    MatMumpsGetInfog(factor, 1, &info);
    return dea_fail(ctx, DEA_E_TOOL, "MUMPS failed with INFOG(1) = %d", (int)info);
  }
}

/* One attempt; *error: what became of the factor. */
static dea_status try_factor(struct dea_context *ctx, Mat A, PetscInt room_percent, Mat *factor,
                             MatFactorError *error)
{
  MatFactorInfo info;
  MatFactorInfoInitialize(&info);
  DEA_TRY(ctx, *factor == NULL ? analyse(ctx, A, room_percent, factor) : DEA_OK);
  DEA_PETSC(ctx, MatSetErrorIfFailure(A, PETSC_FALSE)); // as SLEPc's solvers set it
  DEA_PETSC(ctx, MatCholeskyFactorNumeric(*factor, A, &info));
  DEA_PETSC(ctx, MatFactorGetError(*factor, error));
  return DEA_OK;
}

enum { ROOM = 25, ROOM_MAX = 400 };

dea_status dea_solid_factor(struct dea_context *ctx, Mat A, Mat *factor)
{
  MatFactorError error = MAT_FACTOR_OUTMEMORY;
  dea_status status = DEA_OK;
  DEA_TRY(ctx, dea_solid_check_interruption(ctx)); // that of a large mesh takes seconds
  dea_context_counters(ctx)->factorisations++;
  for (PetscInt capacity = ROOM; capacity <= ROOM_MAX && error == MAT_FACTOR_OUTMEMORY;
       capacity *= 2) {
    if (capacity > ROOM) {
      MatDestroy(factor); // PETSc takes no second attempt with it
    }
    status = try_factor(ctx, A, capacity, factor, &error);
    if (status != DEA_OK) {
      break;
    }
  }
  status = status == DEA_OK ? factor_failure(ctx, *factor, error) : status;
  if (status != DEA_OK) { // what is left of it is of no use: the next one is analysed anew
    MatDestroy(factor);
  }
  return status;
}

/* Largest K that is tried by fronts: of larger ones nothing was measured. */
static const size_t fronts_most = 100000;

/* The factor by fronts, as dea_fronts_factor; *negative: -1 also where that is not to be had. */
static dea_status factor_by_fronts(struct dea_context *ctx, struct dea_solid *s, int most,
                                   int *negative)
{
  const struct dea_solid_problem *p = &s->problem;
  s->work.by_fronts = false;
  *negative = -1;
  if (dea_solid_ranks() > 1 || p->per_node != 3 || p->free_potentials > 0 ||
      p->dofs > fronts_most || s->work.takes_small_pivots || s->work.no_fronts) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_solid_check_interruption(ctx));
  if (s->work.fronts != NULL && !dea_fronts_fit(s->work.fronts, s->work.K)) {
    dea_fronts_destroy(ctx, s->work.fronts);
    s->work.fronts = NULL;
  }
  if (s->work.fronts == NULL) {
    DEA_TRY(ctx, dea_fronts_create(ctx, s->work.K, &s->work.fronts));
    s->work.no_fronts = s->work.fronts == NULL;
  }
  if (s->work.fronts != NULL) {
    DEA_TRY(ctx, dea_fronts_factor(ctx, s->work.fronts, s->work.K, most, negative));
  }
  s->work.by_fronts = *negative >= 0 && *negative <= most;
  return DEA_OK;
}

/* The solution by the factor of K alone. */
static dea_status solve_by_factor(struct dea_context *ctx, struct dea_solid *s, Vec right, Vec x)
{
  if (s->work.by_fronts) {
    return dea_fronts_solve(ctx, s->work.fronts, right, x);
  }
  DEA_PETSC(ctx, MatSolve(s->work.factor, right, x));
  return DEA_OK;
}

/* The factor by MUMPS. */
static dea_status factor_by_pivots(struct dea_context *ctx, struct dea_solid *s, int *negative)
{
  PetscInt minus, zero, plus;
  DEA_TRY(ctx, s->work.factor == NULL ? analyse(ctx, s->work.K, ROOM, &s->work.factor) : DEA_OK);
  DEA_PETSC(ctx, MatMumpsSetCntl(s->work.factor, 3, s->work.takes_small_pivots ? -1e-300 : 0));
  DEA_TRY(ctx, dea_solid_factor(ctx, s->work.K, &s->work.factor));
  DEA_PETSC(ctx, MatGetInertia(s->work.factor, &minus, &zero, &plus));
  *negative = (int)(minus + zero) - (int)s->problem.free_potentials;
  return DEA_OK;
}

dea_status dea_solid_factorise(struct dea_context *ctx, struct dea_solid *s, int rough,
                               int *negative)
{
  int fewer;
  // with such terms a mode more or less makes a difference
  const bool exact = rough == DEA_FACTOR_EXACT || s->work.rank_one.count > 0;
  s->found.stiff_factor_fits = false;
  DEA_TRY(ctx, factor_by_fronts(ctx, s, exact ? 0 : rough, negative));
  if (exact ? s->work.by_fronts : *negative >= 0) {
    dea_context_counters(ctx)->factorisations++;
  } else {
    DEA_TRY(ctx, factor_by_pivots(ctx, s, negative));
  }
  DEA_TRY(ctx, dea_solid_rank_one_factor(ctx, s, solve_by_factor, &fewer));
  *negative -= fewer;
  return DEA_OK;
}

/* K has this rank's unknowns node by node, in local axes. */
dea_status dea_solid_from_vector(struct dea_context *ctx, const struct dea_solid *s, Vec vector,
                                 double *out)
{
  const struct dea_solid_problem *p = &s->problem;
  const PetscScalar *values;
  DEA_PETSC(ctx, VecGetArrayRead(vector, &values));
  memset(out, 0, s->problem.dofs * sizeof(double)); // zero where other ranks have it
  for (size_t n = p->first_node, k = 0; n < p->end_node; n++) {
    for (int i = 0; i < p->per_node; i++) {
      out[dea_solid_at(s, (int)n, i)] = values[k++];
    }
  }
  DEA_PETSC(ctx, VecRestoreArrayRead(vector, &values));
  dea_solid_sum(out, s->problem.dofs);
  dea_solid_frame_vector(s, true, out);
  if (s->problem.body_count > 0) {
    dea_solid_bodies_prepare(s);
    dea_solid_bodies_transfer(s, out);
  }
  return DEA_OK;
}

dea_status dea_solid_to_vector(struct dea_context *ctx, const struct dea_solid *s, double *values,
                               Vec vector)
{
  const struct dea_solid_problem *p = &s->problem;
  PetscScalar *rows;
  dea_solid_frame_vector(s, false, values);
  DEA_PETSC(ctx, VecGetArray(vector, &rows));
  for (size_t n = p->first_node, k = 0; n < p->end_node; n++) {
    for (int i = 0; i < p->per_node; i++) {
      rows[k++] = values[dea_solid_at(s, (int)n, i)];
    }
  }
  DEA_PETSC(ctx, VecRestoreArray(vector, &rows));
  return DEA_OK;
}

/* What is on followers of a body goes to the body. */
static void collect(struct dea_solid *s, double *right)
{
  if (s->problem.body_count > 0) {
    dea_solid_bodies_prepare(s);
    dea_solid_bodies_collect(s, right);
    dea_solid_release_held(s, right);
  }
}

dea_status dea_solid_solve_rows(struct dea_context *ctx, struct dea_solid *s, Vec right, Vec x)
{
  DEA_TRY(ctx, solve_by_factor(ctx, s, right, x));
  return DEA_CHAIN(ctx, dea_solid_rank_one_correct(ctx, s, right, x));
}

dea_status dea_solid_solve_linear(struct dea_context *ctx, struct dea_solid *s, const double *right,
                                  double *out)
{
  memmove(out, right, s->problem.dofs * sizeof(double));
  collect(s, out);
  DEA_TRY(ctx, dea_solid_to_vector(ctx, s, out, s->work.right));
  DEA_TRY(ctx, dea_solid_solve_rows(ctx, s, s->work.right, s->work.solution));
  return DEA_CHAIN(ctx, dea_solid_from_vector(ctx, s, s->work.solution, out));
}
