/* K = L L^T by fronts (docs/theory/fronts.md). A front is a dense matrix: the columns of K that are
 * eliminated in it, its pivots, and the rows where L has entries in these; below them is what they
 * leave for the remaining rows, its update, which goes into the front of the first of those rows.
 *
 *   pivots   columns that a front eliminates          1
 *   rows     of it, its pivots first                  1
 *   panel    [pivots][rows], by columns: K, then L    as K
 *   update   [rows - pivots]^2, its lower triangle    as K
 */
#include "model/solid/assembly/fronts.h"

#include "base/arena.h"
#include "base/context.h"

#include <petscblaslapack.h>

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { PER = 3 };                  // unknowns of a node
static const double least = 1e-12; // pivot over K's diagonal that is more than rounding
static const double one = 1, two = 2, minus = -1, zero = 0;
static const PetscBLASInt unit = 1; // stride

// triangular systems with one right side; PETSc's header lacks them
extern void dtrsv_(const char *uplo, const char *trans, const char *diag, const PetscBLASInt *n,
                   const double *A, const PetscBLASInt *lda, double *x, const PetscBLASInt *incx);

struct front {
  PetscBLASInt pivots, rows;
  int first;    // unknown that is its first pivot, in the order of elimination
  int *row;     // [rows - pivots] unknowns below its pivots, rising
  int *into;    // [rows - pivots] rows of the parent that they are
  int parent;   // -1: none
  int side;     // stack of its update: not that of its parent
  size_t panel; // where it begins in L
  size_t block; // first of its blocks of K
};

/* A block of K, PER x PER, by columns. */
struct block {
  size_t from; // number of it in K
  size_t to;   // in L
  bool transposed;
};

struct dea_fronts {
  struct dea_arena memory;
  int nodes;
  double entries_of_K;  // a pattern that changes has more
  int *place;           // [nodes] in the order of elimination
  struct front *fronts; // [count], children before parents
  size_t count;
  struct block *blocks; // [fronts[count].block]
  double *L;
  size_t entries;        // of L
  double *update;        // of the present front, on its stack
  double *stack[2];      // updates that wait for their parents
  int *waiting;          // [count] fronts that these are of
  double *oo;            // [pivots]^2 of a front, as it was before its elimination
  bool *below;           // [PER nodes] rows where D has -1
  double *x, *remaining; // [PER nodes] and the rows of the largest front
};

// Analysis ---------------------------------------------------------------------------------------

/* Memory of the analysis. A list of nodes is ptr[i] <= k < ptr[i + 1]. */
struct analysis {
  struct dea_arena memory;
  int nodes;
  const PetscInt *ptr, *index;       // K's blocks, lent: those of the diagonal and right of it
  const PetscInt *whole_ptr, *whole; // K's blocks of both triangles, lent
  PetscInt *near_ptr, *near;         // neighbours of each node, rising
  int *order;                        // [nodes] node of each place
  int *parent;                       // [nodes] first row below each column, -1: none
  PetscInt **rows;                   // [nodes] places below each column where L has a block
  int *row_count;                    // [nodes] of them
  int *of;                           // [nodes] front of each column
};

/* Neighbours without the node itself: with it PETSc would order nodes of equal pattern as one. */
static void list_neighbours(struct analysis *a)
{
  PetscInt count = 0;
  for (int i = 0; i < a->nodes; i++) {
    for (PetscInt k = a->whole_ptr[i]; k < a->whole_ptr[i + 1]; k++) {
      a->near[count] = a->whole[k];
      count += a->whole[k] != i;
    }
    a->near_ptr[i + 1] = count;
  }
}

/* Nodes by approximate minimum degree. */
static dea_status find_order(struct dea_context *ctx, struct analysis *a, Mat graph)
{
  IS rows = NULL, columns = NULL;
  const PetscInt *order;
  DEA_PETSC(ctx, MatGetOrdering(graph, MATORDERINGAMD, &rows, &columns));
  DEA_PETSC(ctx, ISGetIndices(rows, &order));
  for (int k = 0; k < a->nodes; k++) {
    a->order[k] = (int)order[k];
  }
  DEA_PETSC(ctx, ISRestoreIndices(rows, &order));
  ISDestroy(&rows);
  ISDestroy(&columns);
  return DEA_OK;
}

static dea_status order_nodes(struct dea_context *ctx, struct analysis *a)
{
  double *values = dea_arena_alloc(&a->memory, (size_t)a->near_ptr[a->nodes], sizeof *values);
  Mat graph = NULL;
  DEA_TRY(ctx, dea_arena_status(&a->memory));
  DEA_PETSC(ctx, MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, a->nodes, a->nodes, a->near_ptr,
                                           a->near, values, &graph));
  dea_status status = find_order(ctx, a, graph);
  MatDestroy(&graph);
  return status;
}

/* place [nodes] of each node, from the order. */
static void find_places(const struct analysis *a, int *place)
{
  for (int k = 0; k < a->nodes; k++) {
    place[a->order[k]] = k;
  }
}

/* Changes the order so that columns come right after all below them in the tree of parents, which
 * leaves what L has. work: [3 nodes]. */
static void order_by_tree(struct analysis *a, int *work)
{
  int n = a->nodes, *child = work, *sister = work + n, *next = work + 2 * n, count = 0;
  for (int k = 0; k < n; k++) {
    child[k] = -1;
  }
  for (int k = n - 1; k >= 0; k--) {
    sister[k] = a->parent[k] >= 0 ? child[a->parent[k]] : -1;
    if (a->parent[k] >= 0) {
      child[a->parent[k]] = k;
    }
  }
  for (int k = 0; k < n; k++) {
    for (int at = a->parent[k] < 0 ? k : -1; at >= 0;) {
      if (child[at] >= 0) { // down first
        int down = child[at];
        child[at] = -1;
        at = down;
      } else {
        next[count++] = a->order[at];
        at = sister[at] >= 0 ? sister[at] : a->parent[at];
      }
    }
  }
  memcpy(a->order, next, (size_t)n * sizeof *next);
}

/* Rows below each column: those of K, and those of all columns whose parent it is; and its parent,
 * the first of them. work: [3 nodes]. */
static dea_status find_rows(struct dea_context *ctx, struct analysis *a, const int *place,
                            int *work)
{
  int n = a->nodes, *seen = work, *child = work + n, *sister = work + 2 * n;
  PetscInt *found = dea_arena_alloc(&a->memory, (size_t)n, sizeof *found);
  DEA_TRY(ctx, dea_arena_status(&a->memory));
  for (int k = 0; k < n; k++) {
    seen[k] = child[k] = -1;
  }
  for (int k = 0; k < n; k++) {
    int count = 0, node = a->order[k];
    for (int e = a->near_ptr[node]; e < a->near_ptr[node + 1]; e++) {
      found[count] = place[a->near[e]];
      count += found[count] > k ? 1 : 0;
    }
    for (int i = 0; i < count; i++) {
      seen[found[i]] = k;
    }
    for (int c = child[k]; c >= 0; c = sister[c]) {
      for (int i = 0; i < a->row_count[c]; i++) {
        int row = a->rows[c][i];
        if (row > k && seen[row] != k) {
          seen[row] = k;
          found[count++] = row;
        }
      }
    }
    PetscSortInt(count, found);
    a->rows[k] = dea_arena_alloc(&a->memory, (size_t)count, sizeof *found);
    DEA_TRY(ctx, dea_arena_status(&a->memory));
    memcpy(a->rows[k], found, (size_t)count * sizeof *found);
    a->row_count[k] = count;
    a->parent[k] = count > 0 ? found[0] : -1;
    if (count > 0) {
      sister[k] = child[found[0]];
      child[found[0]] = k;
    }
  }
  return DEA_OK;
}

/* Columns one after the other whose rows are the same but for themselves share a front. */
static size_t count_fronts(struct analysis *a)
{
  int count = 0;
  for (int k = 0; k < a->nodes; k++) {
    bool same = k > 0 && a->parent[k - 1] == k && a->row_count[k - 1] == a->row_count[k] + 1;
    count += same ? 0 : 1;
    a->of[k] = count - 1;
  }
  return (size_t)count;
}

static dea_status build_fronts(struct dea_context *ctx, struct analysis *a, struct dea_fronts *f)
{
  f->count = count_fronts(a);
  f->fronts = dea_arena_alloc(&f->memory, f->count + 1, sizeof *f->fronts);
  DEA_TRY(ctx, dea_arena_status(&f->memory));
  for (int k = 0, end; k < a->nodes; k = end) {
    struct front *front = &f->fronts[a->of[k]];
    for (end = k + 1; end < a->nodes && a->of[end] == a->of[k];) {
      end++;
    }
    int remaining = a->row_count[end - 1];
    front->first = PER * k;
    front->pivots = PER * (end - k);
    front->rows = front->pivots + PER * remaining;
    front->parent = remaining > 0 ? a->of[a->rows[end - 1][0]] : -1;
    front->panel = f->entries;
    front->row = dea_arena_alloc(&f->memory, (size_t)(PER * remaining), sizeof *front->row);
    front->into = dea_arena_alloc(&f->memory, (size_t)(PER * remaining), sizeof *front->into);
    DEA_TRY(ctx, dea_arena_status(&f->memory));
    for (int i = 0; i < PER * remaining; i++) {
      front->row[i] = PER * a->rows[end - 1][i / PER] + i % PER;
    }
    f->entries += (size_t)front->pivots * (size_t)front->rows;
  }
  return DEA_OK;
}

/* Row of each unknown in a front, into at [PER nodes]. */
static void find_front_rows(const struct front *front, int *at)
{
  for (int i = 0; i < front->pivots; i++) {
    at[front->first + i] = i;
  }
  for (int i = 0; i < front->rows - front->pivots; i++) {
    at[front->row[i]] = front->pivots + i;
  }
}

/* Where the updates of the fronts go; at: [PER nodes]. */
static void link_fronts(struct dea_fronts *f, int *at)
{
  for (size_t c = 0; c < f->count; c++) {
    struct front *child = &f->fronts[c];
    if (child->parent >= 0) {
      find_front_rows(&f->fronts[child->parent], at);
    }
    for (int i = 0; i < child->rows - child->pivots; i++) {
      child->into[i] = at[child->row[i]];
    }
  }
}

/* Front of the block of nodes i and j. */
static size_t front_of(const struct analysis *a, const int *place, int i, int j)
{
  return (size_t)a->of[place[i] < place[j] ? place[i] : place[j]];
}

/* Where the blocks of K go. at: [PER nodes]; next: [count]. */
static void place_blocks(const struct analysis *a, struct dea_fronts *f, int *at, size_t *next)
{
  for (int i = 0; i < a->nodes; i++) {
    for (PetscInt k = a->ptr[i]; k < a->ptr[i + 1]; k++) {
      f->fronts[front_of(a, f->place, i, (int)a->index[k]) + 1].block++;
    }
  }
  for (size_t n = 0; n < f->count; n++) {
    f->fronts[n + 1].block += f->fronts[n].block;
    next[n] = f->fronts[n].block;
  }
  for (int i = 0; i < a->nodes; i++) { // first from where and to which row and column
    for (PetscInt k = a->ptr[i]; k < a->ptr[i + 1]; k++) {
      int p = f->place[i], q = f->place[a->index[k]];
      struct block *block = &f->blocks[next[front_of(a, f->place, i, (int)a->index[k])]++];
      *block = (struct block){
          (size_t)k, (size_t)(p < q ? p : q) * (size_t)a->nodes + (size_t)(p < q ? q : p), p <= q};
    }
  }
  for (size_t n = 0; n < f->count; n++) {
    const struct front *front = &f->fronts[n];
    find_front_rows(front, at);
    for (size_t b = front[0].block; b < front[1].block; b++) {
      size_t column = f->blocks[b].to / (size_t)a->nodes, row = f->blocks[b].to % (size_t)a->nodes;
      f->blocks[b].to = front->panel + (PER * column - (size_t)front->first) * (size_t)front->rows +
                        (size_t)at[PER * row];
    }
  }
}

static size_t update_size(const struct front *front)
{
  return (size_t)(front->rows - front->pivots) * (size_t)(front->rows - front->pivots);
}

/* Memory of the factor; the largest that waits at a time. A front's update is made on one stack
 * while those of its children, the last on the other, are taken from there. */
static dea_status reserve(struct dea_context *ctx, struct dea_fronts *f)
{
  size_t rows = 0, pivots = 0, depth[2] = {0, 0}, deepest[2] = {0, 0}, waiting = 0;
  f->waiting = dea_arena_alloc(&f->memory, f->count, sizeof *f->waiting);
  DEA_TRY(ctx, dea_arena_status(&f->memory));
  for (size_t n = f->count; n-- > 0;) {
    struct front *front = &f->fronts[n];
    front->side = front->parent >= 0 ? !f->fronts[front->parent].side : 0;
  }
  for (size_t n = 0; n < f->count; n++) {
    const struct front *front = &f->fronts[n];
    size_t *of = &depth[front->side], *peak = &deepest[front->side];
    *of += update_size(front);
    *peak = *of > *peak ? *of : *peak;
    for (; waiting > 0 && f->fronts[f->waiting[waiting - 1]].parent == (int)n; waiting--) {
      depth[!front->side] -= update_size(&f->fronts[f->waiting[waiting - 1]]);
    }
    f->waiting[waiting++] = (int)n;
    rows = (size_t)front->rows > rows ? (size_t)front->rows : rows;
    pivots = (size_t)front->pivots > pivots ? (size_t)front->pivots : pivots;
  }
  f->L = dea_arena_alloc(&f->memory, f->entries, sizeof *f->L);
  f->stack[0] = dea_arena_alloc(&f->memory, deepest[0], sizeof *f->stack[0]);
  f->stack[1] = dea_arena_alloc(&f->memory, deepest[1], sizeof *f->stack[1]);
  f->x = dea_arena_alloc(&f->memory, PER * (size_t)f->nodes, sizeof *f->x);
  f->remaining = dea_arena_alloc(&f->memory, rows, sizeof *f->remaining);
  f->oo = dea_arena_alloc(&f->memory, pivots * pivots, sizeof *f->oo);
  f->below = dea_arena_alloc(&f->memory, PER * (size_t)f->nodes, sizeof *f->below);
  return DEA_CHAIN(ctx, dea_arena_status(&f->memory));
}

static dea_status analyse(struct dea_context *ctx, struct analysis *a, struct dea_fronts *f)
{
  size_t n = (size_t)a->nodes;
  int *work = dea_arena_alloc(&a->memory, PER * n, sizeof *work);
  size_t *next = dea_arena_alloc(&a->memory, n, sizeof *next);
  a->near_ptr = dea_arena_alloc(&a->memory, n + 1, sizeof *a->near_ptr);
  a->near = dea_arena_alloc(&a->memory, (size_t)a->whole_ptr[n], sizeof *a->near);
  a->order = dea_arena_alloc(&a->memory, n, sizeof *a->order);
  a->parent = dea_arena_alloc(&a->memory, n, sizeof *a->parent);
  a->rows = dea_arena_alloc(&a->memory, n, sizeof *a->rows);
  a->row_count = dea_arena_alloc(&a->memory, n, sizeof *a->row_count);
  a->of = dea_arena_alloc(&a->memory, n, sizeof *a->of);
  f->place = dea_arena_alloc(&f->memory, n, sizeof *f->place);
  f->blocks = dea_arena_alloc(&f->memory, (size_t)a->ptr[n], sizeof *f->blocks);
  DEA_TRY(ctx, dea_arena_status(&a->memory));
  DEA_TRY(ctx, dea_arena_status(&f->memory));
  list_neighbours(a);
  DEA_TRY(ctx, order_nodes(ctx, a));
  find_places(a, f->place);
  DEA_TRY(ctx, find_rows(ctx, a, f->place, work)); // for the parents
  order_by_tree(a, work);
  find_places(a, f->place);
  DEA_TRY(ctx, find_rows(ctx, a, f->place, work));
  DEA_TRY(ctx, build_fronts(ctx, a, f));
  link_fronts(f, work);
  place_blocks(a, f, work, next);
  return DEA_CHAIN(ctx, reserve(ctx, f));
}

static double count_entries(Mat K)
{
  MatInfo info;
  return MatGetInfo(K, MAT_LOCAL, &info) == 0 ? info.nz_used : -1;
}

dea_status dea_fronts_create(struct dea_context *ctx, Mat K, struct dea_fronts **out)
{
  struct analysis a = {.memory = {.ctx = ctx}};
  PetscInt nodes;
  PetscBool there, both;
  *out = NULL;
  struct dea_fronts *f = dea_alloc(ctx, 1, sizeof *f);
  DEA_TRY_MEMORY(f != NULL);
  f->memory.ctx = ctx;
  dea_status status = dea_solid_petsc(
      ctx, MatGetRowIJ(K, 0, PETSC_FALSE, PETSC_TRUE, &nodes, &a.ptr, &a.index, &there),
      "MatGetRowIJ");
  if (status == DEA_OK && there) {
    a.nodes = f->nodes = (int)nodes;
    f->entries_of_K = count_entries(K);
    status = dea_solid_petsc(
        ctx, MatGetRowIJ(K, 0, PETSC_TRUE, PETSC_TRUE, &nodes, &a.whole_ptr, &a.whole, &both),
        "MatGetRowIJ");
    status = status == DEA_OK ? analyse(ctx, &a, f) : status;
    MatRestoreRowIJ(K, 0, PETSC_TRUE, PETSC_TRUE, &nodes, &a.whole_ptr, &a.whole, &both);
    MatRestoreRowIJ(K, 0, PETSC_FALSE, PETSC_TRUE, &nodes, &a.ptr, &a.index, &there);
  }
  dea_arena_free(&a.memory);
  if (status != DEA_OK || f->count == 0) {
    dea_fronts_destroy(ctx, f);
    return status;
  }
  *out = f;
  return DEA_OK;
}

bool dea_fronts_fit(const struct dea_fronts *fronts, Mat K)
{
  return count_entries(K) == fronts->entries_of_K;
}

void dea_fronts_destroy(struct dea_context *ctx, struct dea_fronts *fronts)
{
  if (fronts != NULL) {
    dea_arena_free(&fronts->memory);
    dea_free(ctx, fronts);
  }
}

// Factor -----------------------------------------------------------------------------------------

/* The panel as K has it, and K's diagonal into x. */
static void fill_panel(struct dea_fronts *f, const struct front *front, const double *K)
{
  const size_t rows = (size_t)front->rows;
  double *panel = f->L + front->panel;
  memset(panel, 0, rows * (size_t)front->pivots * sizeof *panel);
  for (const struct block *b = f->blocks + front[0].block; b < f->blocks + front[1].block; b++) {
    const double *from = K + PER * PER * b->from;
    for (size_t c = 0; c < PER; c++) {
      double *to = f->L + b->to + c * rows;
      for (size_t r = 0; r < PER; r++) {
        to[r] = b->transposed ? from[c + PER * r] : from[r + PER * c];
      }
    }
  }
  for (size_t i = 0; i < (size_t)front->pivots; i++) {
    f->x[(size_t)front->first + i] = panel[i * (rows + 1)];
  }
}

/* Adds the update of a child, columns of its lower triangle, to panel and update of its parent. */
static void add_update(struct dea_fronts *f, const struct front *front, const struct front *child,
                       const double *update)
{
  const size_t count = (size_t)(child->rows - child->pivots), pivots = (size_t)front->pivots;
  const size_t rows = (size_t)front->rows, remaining = rows - pivots;
  const int *into = child->into;
  for (size_t c = 0; c < count; c++, update += count) {
    const size_t column = (size_t)into[c];
    double *to = column < pivots ? f->L + front->panel + column * rows
                                 : f->update + (column - pivots) * remaining - pivots;
    for (size_t r = c; r < count; r++) {
      to[into[r]] += update[r];
    }
  }
}

/* What waits for this front, off the other stack; *depth: what is left of that. */
static void pop_updates(struct dea_fronts *f, size_t number, size_t *waiting, size_t *depth)
{
  const struct front *front = &f->fronts[number];
  const size_t remaining = (size_t)(front->rows - front->pivots);
  for (size_t c = 0; c < remaining; c++) {
    memset(f->update + c * remaining + c, 0, (remaining - c) * sizeof *f->update);
  }
  for (; *waiting > 0 && f->fronts[f->waiting[*waiting - 1]].parent == (int)number; --*waiting) {
    const struct front *child = &f->fronts[f->waiting[*waiting - 1]];
    *depth -= update_size(child);
    add_update(f, front, child, f->stack[child->side] + *depth);
  }
}

/* F_oo of the panel into f->oo, or back. */
static void copy_own(struct dea_fronts *f, const struct front *front, bool back)
{
  const size_t pivots = (size_t)front->pivots, rows = (size_t)front->rows;
  double *panel = f->L + front->panel;
  for (size_t c = 0; c < pivots; c++) {
    double *here = panel + c * rows + c, *kept = f->oo + c * pivots + c;
    memcpy(back ? here : kept, back ? kept : here, (pivots - c) * sizeof *here);
  }
}

/* F_oo = L D L^T by columns, D of 1 and -1, which goes to `below`. false: a pivot is hardly more
 * than rounding. */
static bool eliminate_own(struct dea_fronts *f, const struct front *front, bool *below)
{
  const size_t pivots = (size_t)front->pivots, rows = (size_t)front->rows;
  double *panel = f->L + front->panel;
  for (size_t j = 0; j < pivots; j++) {
    double *column = panel + j * rows, pivot = column[j];
    below[j] = pivot < 0;
    if (!(fabs(pivot) > least * fabs(f->x[(size_t)front->first + j]))) {
      return false;
    }
    for (size_t i = j; i < pivots; i++) {
      column[i] /= below[j] ? -sqrt(-pivot) : sqrt(pivot);
    }
    for (size_t c = j + 1; c < pivots; c++) {
      double *to = panel + c * rows, share = below[j] ? -column[c] : column[c];
      for (size_t i = c; i < pivots; i++) {
        to[i] -= share * column[i];
      }
    }
  }
  return true;
}

/* Whether the pivots of an L that Cholesky's method has found are more than rounding. */
static bool are_above(const struct dea_fronts *f, const struct front *front)
{
  const double *panel = f->L + front->panel;
  bool above = true;
  for (size_t i = 0; i < (size_t)front->pivots && above; i++) {
    const double pivot = panel[i * ((size_t)front->rows + 1)];
    above = pivot * pivot > least * f->x[(size_t)front->first + i];
  }
  return above;
}

/* Columns of L from what the panel holds, and their part of the update. *negative: pivots below 0
 * of this front; -1: one is hardly more than rounding, and there is nothing. */
static void eliminate(struct dea_fronts *f, const struct front *front, int *negative)
{
  const PetscBLASInt remaining = front->rows - front->pivots;
  double *panel = f->L + front->panel, *L_bo = panel + front->pivots;
  bool *below = f->below + front->first;
  PetscBLASInt failed = 0;
  *negative = 0;
  memset(below, 0, (size_t)front->pivots * sizeof *below);
  copy_own(f, front, false);
  LAPACKpotrf_("L", &front->pivots, panel, &front->rows, &failed);
  if (failed != 0) {
    copy_own(f, front, true);
  }
  if (failed != 0 ? !eliminate_own(f, front, below) : !are_above(f, front)) {
    *negative = -1;
    return;
  }
  for (size_t c = 0; c < (size_t)front->pivots; c++) {
    *negative += below[c] ? 1 : 0;
  }
  if (remaining == 0) {
    return;
  }
  BLAStrsm_("R", "L", "T", "N", &remaining, &front->pivots, &one, panel, &front->rows, L_bo,
            &front->rows);
  BLASsyrk_("L", "N", &remaining, &front->pivots, &minus, L_bo, &front->rows, &one, f->update,
            &remaining);
  for (size_t c = 0; c<(size_t)front->pivots && * negative> 0; c++) {
    if (below[c]) { // where D has -1, what was taken off is added
      BLASsyrk_("L", "N", &remaining, &unit, &two, L_bo + c * (size_t)front->rows, &front->rows,
                &one, f->update, &remaining);
    }
  }
}

/* As dea_fronts_factor. */
static int factorise(struct dea_fronts *f, const double *K, int max_negative)
{
  size_t waiting = 0, depth[2] = {0, 0};
  int negative = 0;
  for (size_t n = 0; n < f->count && negative <= max_negative; n++) {
    int of_front;
    const struct front *front = &f->fronts[n];
    f->update = f->stack[front->side] + depth[front->side];
    depth[front->side] += update_size(front);
    fill_panel(f, front, K);
    pop_updates(f, n, &waiting, &depth[!front->side]);
    eliminate(f, front, &of_front);
    if (of_front < 0) {
      return -1;
    }
    negative += of_front;
    f->waiting[waiting++] = (int)n;
  }
  return negative;
}

dea_status dea_fronts_factor(struct dea_context *ctx, struct dea_fronts *fronts, Mat K,
                             int max_negative, int *negative)
{
  PetscScalar *values;
  DEA_PETSC(ctx, MatSeqSBAIJGetArray(K, &values));
  *negative = factorise(fronts, values, max_negative);
  DEA_PETSC(ctx, MatSeqSBAIJRestoreArray(K, &values));
  return DEA_OK;
}

// Solution ---------------------------------------------------------------------------------------

/* D times the pivot rows of x. */
static void turn_signs(struct dea_fronts *f, const struct front *front)
{
  const size_t end = (size_t)front->first + (size_t)front->pivots;
  for (size_t i = (size_t)front->first; i < end; i++) {
    f->x[i] = f->below[i] ? -f->x[i] : f->x[i];
  }
}

/* x = D L^-1 x. Below a front's pivot rows the panel has L D. */
static void solve_down(struct dea_fronts *f)
{
  for (const struct front *front = f->fronts; front < f->fronts + f->count; front++) {
    const PetscBLASInt remaining = front->rows - front->pivots;
    const double *panel = f->L + front->panel;
    dtrsv_("L", "N", "N", &front->pivots, panel, &front->rows, f->x + front->first, &unit);
    turn_signs(f, front);
    if (remaining > 0) {
      BLASgemv_("N", &remaining, &front->pivots, &one, panel + front->pivots, &front->rows,
                f->x + front->first, &unit, &zero, f->remaining, &unit);
    }
    for (PetscBLASInt i = 0; i < remaining; i++) {
      f->x[front->row[i]] -= f->remaining[i];
    }
  }
}

/* x = L^-T x. */
static void solve_up(struct dea_fronts *f)
{
  for (const struct front *front = f->fronts + f->count; front-- > f->fronts;) {
    const PetscBLASInt remaining = front->rows - front->pivots;
    const double *panel = f->L + front->panel;
    for (PetscBLASInt i = 0; i < remaining; i++) {
      f->remaining[i] = f->x[front->row[i]];
    }
    turn_signs(f, front);
    if (remaining > 0) {
      BLASgemv_("T", &remaining, &front->pivots, &minus, panel + front->pivots, &front->rows,
                f->remaining, &unit, &one, f->x + front->first, &unit);
    }
    turn_signs(f, front);
    dtrsv_("L", "T", "N", &front->pivots, panel, &front->rows, f->x + front->first, &unit);
  }
}

dea_status dea_fronts_solve(struct dea_context *ctx, struct dea_fronts *fronts, Vec right, Vec x)
{
  const PetscScalar *from;
  PetscScalar *to;
  DEA_PETSC(ctx, VecGetArrayRead(right, &from));
  for (int i = 0; i < PER * fronts->nodes; i++) {
    fronts->x[PER * fronts->place[i / PER] + i % PER] = from[i];
  }
  DEA_PETSC(ctx, VecRestoreArrayRead(right, &from));
  solve_down(fronts);
  solve_up(fronts);
  DEA_PETSC(ctx, VecGetArray(x, &to));
  for (int i = 0; i < PER * fronts->nodes; i++) {
    to[i] = fronts->x[PER * fronts->place[i / PER] + i % PER];
  }
  DEA_PETSC(ctx, VecRestoreArray(x, &to));
  return DEA_OK;
}
