#include "model/solid/mesh/transfer.h"

#include "base/quadrature.h"

#include <math.h>

enum { ROUNDS = 30 };
static const double close_enough = 1e-12; // of local coordinates
static const double inside = 1e-9;        // beyond an element by that: in it
static const double beyond_most = 0.2;    // of an element's half-width
static const double local_most = 3;       // Newton does not go farther away than that

/* One element at a place: nodes along its axes, local coordinates, their basis. */
struct basis {
  int line, levels; // nodes along an axis of the plane, through the thickness
  double plane[DEA_HEX_LINE_MAX], through[DEA_HEX_LINE_MAX]; // local coordinates of nodes
  double value[3][DEA_HEX_LINE_MAX], slope[3][DEA_HEX_LINE_MAX];
};

static struct basis basis_of(const struct dea_grid *grid, size_t element)
{
  struct basis b = {.line = grid->order + 1, .levels = grid->levels[element]};
  dea_lobatto_nodes((size_t)grid->order, b.plane);
  if (b.levels > 1) {
    dea_lobatto_nodes((size_t)b.levels - 1, b.through);
  }
  return b;
}

static void set_local(struct basis *b, const double local[3])
{
  for (int axis = 0; axis < 2; axis++) {
    dea_lagrange((size_t)b->line, b->plane, local[axis], b->value[axis], b->slope[axis]);
  }
  if (b->levels > 1) {
    dea_lagrange((size_t)b->levels, b->through, local[2], b->value[2], b->slope[2]);
  } else {
    b->value[2][0] = 1;
  }
}

/* Place in the plane of the local coordinates that were put, and its slopes [x, y][local axis]:
 * all levels of an element lie above each other. */
static void place_of(const struct basis *b, const struct dea_grid *grid, const int *nodes,
                     double x[2], double slope[4])
{
  x[0] = x[1] = slope[0] = slope[1] = slope[2] = slope[3] = 0;
  for (int j = 0; j < b->line; j++) {
    for (int i = 0; i < b->line; i++) {
      const double *X = grid->X + 3 * (size_t)nodes[j * b->line + i];
      for (int c = 0; c < 2; c++) {
        x[c] += X[c] * b->value[0][i] * b->value[1][j];
        slope[2 * c] += X[c] * b->slope[0][i] * b->value[1][j];
        slope[2 * c + 1] += X[c] * b->value[0][i] * b->slope[1][j];
      }
    }
  }
}

/* Local coordinates of a place by Newton's method; false where that does not end. */
static bool find_local(struct basis *b, const struct dea_grid *grid, const int *nodes,
                       const double X[3], double local[3])
{
  local[0] = local[1] = local[2] = 0;
  for (int round = 0; round < ROUNDS; round++) {
    double x[2], J[4];
    set_local(b, local);
    place_of(b, grid, nodes, x, J);
    double det = J[0] * J[3] - J[1] * J[2], dx = X[0] - x[0], dy = X[1] - x[1];
    double step[2] = {(J[3] * dx - J[1] * dy) / det, (J[0] * dy - J[2] * dx) / det};
    for (int axis = 0; axis < 2; axis++) {
      local[axis] += step[axis];
    }
    if (!(fmax(fabs(local[0]), fabs(local[1])) <= local_most)) {
      return false;
    }
    if (fmax(fabs(step[0]), fabs(step[1])) < close_enough) {
      return true;
    }
  }
  return false;
}

/* How far a place is beyond an element, in half-widths of it, 0: inside; local: of the nearest
 * place in it. INFINITY: far away. */
static double beyond(const struct dea_grid *grid, size_t element, const double X[3],
                     double local[3])
{
  const int *nodes = grid->nodes + element * DEA_HEX_NODES_MAX;
  struct basis b = basis_of(grid, element);
  int level = b.line * b.line;
  if (!find_local(&b, grid, nodes, X, local)) {
    return INFINITY;
  }
  double low = grid->X[3 * (size_t)nodes[0] + 2], out = 0;
  if (b.levels > 1) {
    double high = grid->X[3 * (size_t)nodes[(b.levels - 1) * level] + 2];
    local[2] = (2 * X[2] - low - high) / (high - low);
  }
  for (int axis = 0; axis < 3; axis++) {
    out = fmax(out, fabs(local[axis]) - 1);
    local[axis] = fmax(-1, fmin(1, local[axis]));
  }
  return out;
}

/* Box of an element, wider by beyond_most of it: x, y, z of one corner, then of the other. */
static void box_of(const struct dea_grid *grid, size_t element, double box[6])
{
  const int *nodes = grid->nodes + element * DEA_HEX_NODES_MAX;
  for (int c = 0; c < 3; c++) {
    box[c] = INFINITY;
    box[3 + c] = -INFINITY;
    for (int n = 0; n < dea_grid_nodes_of(grid, element); n++) {
      double x = grid->X[3 * (size_t)nodes[n] + (size_t)c];
      box[c] = fmin(box[c], x);
      box[3 + c] = fmax(box[3 + c], x);
    }
  }
  double wide = fmax(box[3] - box[0], box[4] - box[1]);
  for (int c = 0; c < 3; c++) {
    double more = beyond_most * (c < 2 ? wide : fmax(box[5] - box[2], 1e-6 * wide));
    box[c] -= more;
    box[3 + c] += more;
  }
}

static bool in_box(const double box[6], const double X[3])
{
  for (int c = 0; c < 3; c++) {
    if (!(X[c] >= box[c] && X[c] <= box[3 + c])) {
      return false;
    }
  }
  return true;
}

/* The element that a place is in or nearest to; its number is element_count where there is none. */
static size_t find_element(const struct dea_grid *grid, const double (*boxes)[6], const double X[3],
                           double local[3])
{
  size_t best = grid->element_count;
  double least = beyond_most;
  for (size_t e = 0; e < grid->element_count && least > inside; e++) {
    double at[3];
    if (!in_box(boxes[e], X)) {
      continue;
    }
    double away = beyond(grid, e, X, at);
    if (away < least) {
      least = away;
      best = e;
      for (int c = 0; c < 3; c++) {
        local[c] = at[c];
      }
    }
  }
  return best;
}

static void value_in(const struct dea_grid *grid, size_t element, const double local[3],
                     const double *u, double out[3])
{
  const int *node = grid->nodes + element * DEA_HEX_NODES_MAX;
  struct basis b = basis_of(grid, element);
  set_local(&b, local);
  out[0] = out[1] = out[2] = 0;
  for (int k = 0; k < b.levels; k++) {
    for (int j = 0; j < b.line; j++) {
      for (int i = 0; i < b.line; i++, node++) {
        double weight = b.value[0][i] * b.value[1][j] * b.value[2][k];
        for (int c = 0; c < 3; c++) {
          out[c] += weight * u[3 * (size_t)*node + (size_t)c];
        }
      }
    }
  }
}

dea_status dea_grid_transfer(struct dea_context *ctx, const struct dea_grid *from, const double *u,
                             const struct dea_grid *to, double *out)
{
  double(*boxes)[6] = dea_alloc(ctx, from->element_count, sizeof *boxes);
  dea_status status = boxes != NULL ? DEA_OK : DEA_E_MEMORY;
  for (size_t e = 0; boxes != NULL && e < from->element_count; e++) {
    box_of(from, e, boxes[e]);
  }
  for (size_t n = 0; n < to->node_count && status == DEA_OK; n++) {
    const double *X = to->X + 3 * n;
    double local[3] = {0};
    size_t element = find_element(from, (const double(*)[6])boxes, X, local);
    if (element < from->element_count) {
      value_in(from, element, local, u, out + 3 * n);
    } else {
      status = dea_fail(ctx, DEA_E_ARGUMENT,
                        "a node at (%.4g, %.4g, %.4g) mm is outside of the other mesh", 1e3 * X[0],
                        1e3 * X[1], 1e3 * X[2]);
    }
  }
  dea_free(ctx, boxes);
  return status;
}
