/* Estimated errors of displacements (docs/theory/trust.md, "The estimated error"). */
#include "model/solid/recovery/recover_error.h"

#include "base/quadrature.h"
#include "model/solid/element/gauss_to_nodes.h"
#include "model/solid/recovery/recover_points.h"
#include "model/solid/recovery/recover_second.h"

#include <math.h>
#include <string.h>

/* Numbers of a point: P, F, the gradient of each z, the pressure of each z. */
enum { TENSOR = 9, WIDTH_MAX = 2 * TENSOR + (TENSOR + 1) * DEA_ERRORS_MAX };
enum { SECOND = 2 * DEA_RECOVER_LEVELS, CORNERS = 4 };

/* Of an error how many times what recovery sees of it, 1 / (1 - (2/3)^2p): recovery sees elements
 * of one order more. p is the least order that is believed, so that it is the most that can be
 * unseen: 1 of membranes, 1/2 of solids, which have edges and corners of something stiff. */
static const double unseen_of_membranes = 9.0 / 5.0, unseen_of_solids = 3;

struct work {
  struct dea_context *ctx;
  struct dea_arena memory; // of all arrays
  const struct dea_recover_input *in;
  size_t count, width, nodes; // quantities, numbers of a point, points of an element at most
  double *moved;              // u + z / scale, [nodes][3]
  struct dea_recover_points points;
  double *own;            // [elements][nodes][width] at the Gauss points
  double *excess, *share; // [elements][nodes] J - 1, volume of a Gauss point
  double *value;          // [elements][nodes][width] at the nodes
  double *mean;           // [points][width] sums, then means
  double *second;         // [elements] as dea_recover_second
  int *around_point;      // [points] elements
  double *around;         // [count][columns of nodes] what elements add around each
  struct dea_gauss_fit to_nodes[2], back[2];  // of solid elements, of flat ones
  double hat[DEA_ELEMENT_LEVEL_MAX][CORNERS]; // of the corners at the Gauss points of a level
};

/* The bilinear functions of the corners, that add up to 1. */
static void weigh_corners(struct work *w)
{
  int line = w->in->grid->order + 1;
  double x[DEA_HEX_LINE_MAX], weight[DEA_HEX_LINE_MAX];
  dea_gauss_rule((size_t)line, x, weight);
  for (int q = 0; q < line * line; q++) {
    for (int c = 0; c < CORNERS; c++) {
      double along = c % 2 == 0 ? -x[q % line] : x[q % line];
      double across = c / 2 == 0 ? -x[q / line] : x[q / line];
      w->hat[q][c] = 0.25 * (1 + along) * (1 + across);
    }
  }
}

static dea_status prepare(struct work *w)
{
  const struct dea_grid *grid = w->in->grid;
  const size_t elements = grid->element_count;
  DEA_TRY(w->ctx, dea_recover_number(&w->memory, grid, &w->points));
  for (size_t e = 0; e < elements; e++) {
    size_t nodes = (size_t)dea_grid_nodes_of(grid, e);
    w->nodes = nodes > w->nodes ? nodes : w->nodes;
  }
  size_t most = elements * w->nodes;
  w->width = 2 * TENSOR + (TENSOR + 1) * w->count;
  w->moved = dea_arena_alloc(&w->memory, 3 * grid->node_count, sizeof *w->moved);
  w->own = dea_arena_alloc(&w->memory, most * w->width, sizeof *w->own);
  w->excess = dea_arena_alloc(&w->memory, most, sizeof *w->excess);
  w->share = dea_arena_alloc(&w->memory, most, sizeof *w->share);
  w->value = dea_arena_alloc(&w->memory, most * w->width, sizeof *w->value);
  w->mean = dea_arena_alloc(&w->memory, w->points.count * w->width, sizeof *w->mean);
  w->second = dea_arena_alloc(&w->memory, elements * SECOND * w->width, sizeof *w->second);
  w->around_point = dea_arena_alloc(&w->memory, w->points.count, sizeof *w->around_point);
  w->around = dea_arena_alloc(&w->memory, w->count * dea_grid_columns(grid), sizeof *w->around);
  for (int flat = 0; flat < 2; flat++) {
    dea_fit_create(grid->order, flat ? 0 : grid->order_z, false, &w->to_nodes[flat]);
    dea_fit_create(grid->order, flat ? 0 : grid->order_z, true, &w->back[flat]);
  }
  weigh_corners(w);
  return dea_arena_status(&w->memory);
}

/* The numbers of a Gauss point of an element, from the one at `at` on. */
static double *own_at(const struct work *w, size_t e, int q, size_t at)
{
  return w->own + (e * w->nodes + (size_t)q) * w->width + at;
}

static size_t gradient_of(size_t k)
{
  return TENSOR * (2 + k);
}

static size_t pressure_of(const struct work *w, size_t k)
{
  return TENSOR * (2 + w->count) + k;
}

/* Values of one element at u, and in `own` those that the moved one is compared with. */
static dea_status get_state(struct work *w, size_t e, struct dea_element_state *at)
{
  dea_status status = dea_recover_state(w->in, e, true, at);
  for (int q = 0; status == DEA_OK && q < dea_grid_nodes_of(w->in->grid, e); q++) {
    memcpy(own_at(w, e, q, 0), at->P[q], sizeof at->P[q]);
    memcpy(own_at(w, e, q, TENSOR), at->F[q], sizeof at->F[q]);
    w->excess[e * w->nodes + (size_t)q] = at->J[q] - 1;
    w->share[e * w->nodes + (size_t)q] = at->volume_m3[q];
    for (size_t k = 0; k < w->count; k++) {
      memcpy(own_at(w, e, q, gradient_of(k)), at->F[q], sizeof at->F[q]);
      *own_at(w, e, q, pressure_of(w, k)) = at->pressure[q];
    }
  }
  return status;
}

/* Gradient and pressure of the k-th z in one element, where `in` is moved by `step` of it. */
static dea_status get_dual(struct work *w, const struct dea_recover_input *in, size_t e, size_t k,
                           double step, struct dea_element_state *at)
{
  dea_status status = dea_recover_state(in, e, false, at);
  for (int q = 0; status == DEA_OK && q < dea_grid_nodes_of(w->in->grid, e); q++) {
    double *gradient = own_at(w, e, q, gradient_of(k)),
           *pressure = own_at(w, e, q, pressure_of(w, k));
    for (int i = 0; i < TENSOR; i++) {
      gradient[i] = (at->F[q][i] - gradient[i]) / step;
    }
    *pressure = (at->pressure[q] - *pressure) / step;
  }
  return status;
}

/* What u is moved by: a nanometre, so that nothing turns inside out. Returns the share of z. */
static double move(struct work *w, const double *z)
{
  const size_t count = 3 * w->in->grid->node_count;
  const double largest = dea_largest(count, z);
  const double step = largest > 0 ? 1e-9 / largest : 1;
  for (size_t i = 0; i < count; i++) {
    w->moved[i] = w->in->u[i] + step * z[i];
  }
  return step;
}

/* All elements, at u and moved by each z. */
static dea_status get_all(struct work *w, const struct dea_recover_quantity *of)
{
  const size_t elements = w->in->grid->element_count;
  struct dea_recover_input in = *w->in;
  dea_status status = DEA_OK;
  size_t e = 0;
  struct dea_element_state *at = dea_arena_alloc(&w->memory, 1, sizeof *at);
  DEA_TRY(w->ctx, dea_arena_status(&w->memory));
  for (; status == DEA_OK && e < elements; e++) {
    status = get_state(w, e, at);
  }
  in.u = w->moved;
  for (size_t k = 0; status == DEA_OK && k < w->count; k++) {
    const double step = move(w, of[k].z);
    for (e = 0; status == DEA_OK && e < elements; e++) {
      status = get_dual(w, &in, e, k, step, at);
    }
  }
  return status == DEA_OK ? DEA_OK
                          : dea_fail(w->ctx, status,
                                     "element %zu is inverted or beyond its law's domain", e - 1);
}

static bool is_flat(const struct work *w, size_t e)
{
  return w->in->grid->levels[e] == 1;
}

static double unseen(const struct work *w, size_t e)
{
  return is_flat(w, e) ? unseen_of_membranes : unseen_of_solids;
}

static void fit_all(struct work *w)
{
  for (size_t e = 0; e < w->in->grid->element_count; e++) {
    dea_fit_nodes(&w->to_nodes[is_flat(w, e)], (int)w->width, own_at(w, e, 0, 0),
                  w->value + e * w->nodes * w->width);
  }
}

static const double *second_at(const struct work *w, size_t e, size_t axis, size_t level)
{
  return w->second + (e * SECOND + axis * DEA_RECOVER_LEVELS + level) * w->width;
}

/* P_2 at the nodes of a line of order 2. */
static const double bent[3] = {1, -0.5, 1};

/* Adds what neighbours know of the second order to the values of a node. */
static void add_second(const struct work *w, size_t e, int n, double *value)
{
  if (w->in->grid->order != 2) {
    return;
  }
  size_t level = (size_t)n / 9;
  const double share[2] = {bent[n % 3], bent[n / 3 % 3]};
  for (size_t axis = 0; axis < 2; axis++) {
    const double *c = second_at(w, e, axis, level);
    for (size_t i = 0; i < w->width; i++) {
      value[i] += share[axis] * c[i];
    }
  }
}

/* Means at the points: a wide element knows no more of a place than a narrow one. */
static void get_means(struct work *w)
{
  const struct dea_grid *grid = w->in->grid;
  for (size_t e = 0; e < grid->element_count; e++) {
    for (int n = 0; n < dea_grid_nodes_of(grid, e); n++) {
      const size_t p = dea_recover_point(&w->points, grid, e, n);
      double *value = w->value + (e * w->nodes + (size_t)n) * w->width;
      add_second(w, e, n, value);
      w->around_point[p]++;
      for (size_t i = 0; i < w->width; i++) {
        w->mean[p * w->width + i] += value[i];
      }
    }
  }
  for (size_t i = 0; i < w->points.count * w->width; i++) {
    w->mean[i] /= w->around_point[i / w->width];
  }
}

/* What recovery makes of an element, at its Gauss points, [points][width]. */
static void get_recovered(const struct work *w, size_t e, double *out)
{
  double nodes[DEA_HEX_NODES_MAX * WIDTH_MAX];
  for (int n = 0; n < dea_grid_nodes_of(w->in->grid, e); n++) {
    memcpy(nodes + (size_t)n * w->width,
           w->mean + dea_recover_point(&w->points, w->in->grid, e, n) * w->width,
           w->width * sizeof *nodes);
  }
  dea_fit_nodes(&w->back[is_flat(w, e)], (int)w->width, nodes, out);
}

/* (P* - P) : (grad z* - grad z) - (zeta* - zeta) (J - 1) of the k-th z at a Gauss point. */
static double work_at(const struct work *w, size_t e, int q, size_t k, const double *recovered)
{
  const double *own = own_at(w, e, q, 0), *star = recovered + (size_t)q * w->width;
  size_t at = gradient_of(k), zeta = pressure_of(w, k);
  double sum = -(star[zeta] - own[zeta]) * w->excess[e * w->nodes + (size_t)q];
  for (size_t i = 0; i < TENSOR; i++) {
    sum += (star[i] - own[i]) * (star[at + i] - own[at + i]);
  }
  return sum;
}

/* Its integral over an element with what is not seen, each point's part to the corners by its
 * place to `around` them. Returns all of it. */
static double add_element(const struct work *w, size_t e, size_t k, const double *recovered,
                          double *around)
{
  const struct dea_grid *grid = w->in->grid;
  int level = (grid->order + 1) * (grid->order + 1), line = grid->order + 1;
  const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
  const int corner[CORNERS] = {nodes[0], nodes[line - 1], nodes[level - line], nodes[level - 1]};
  double sum = 0;
  for (int q = 0; q < dea_grid_nodes_of(grid, e); q++) {
    double one = unseen(w, e) * w->share[e * w->nodes + (size_t)q] * work_at(w, e, q, k, recovered);
    for (int c = 0; c < CORNERS; c++) {
      around[grid->column[corner[c]]] += w->hat[q % level][c] * one;
    }
    sum += one;
  }
  return sum;
}

/* The larger of what raises a number and what lowers it: their difference is not more than that. */
static double larger_side(const double *around, size_t columns)
{
  double raised = 0, lowered = 0;
  for (size_t c = 0; c < columns; c++) {
    raised += fmax(around[c], 0);
    lowered += fmax(-around[c], 0);
  }
  return fmax(raised, lowered);
}

/* How far the displacement along a probe is off inside of an element that all nodes have exactly:
 * c P_2 of its slope along an axis, integrated from a node on. */
static double between_at(const struct work *w, const struct dea_recover_probe *probe)
{
  const struct dea_grid *grid = w->in->grid;
  const size_t e = probe->element;
  const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX, levels = grid->levels[e];
  double sum = 0;
  for (size_t axis = 0; axis < 2 && grid->order == 2; axis++) {
    const double *from = grid->X + 3 * (size_t)nodes[axis == 0 ? 3 : 1], x = probe->at[axis],
                 *to = grid->X + 3 * (size_t)nodes[axis == 0 ? 5 : 7];
    for (size_t level = 0; level < (size_t)levels; level++) {
      const double *c = second_at(w, e, axis, level) + TENSOR;
      for (int i = 0; i < TENSOR; i++) {
        sum +=
            probe->along[i / 3] * c[i] * (to[i % 3] - from[i % 3]) * (x * x - 1) * x / (4 * levels);
      }
    }
  }
  return sum;
}

/* Of a quantity that is read inside of elements, with what is not seen. */
static double between_nodes(const struct work *w, const struct dea_recover_quantity *of)
{
  double sum = 0;
  for (size_t p = 0; p < of->probe_count; p++) {
    sum += unseen(w, of->probes[p].element) * between_at(w, &of->probes[p]);
  }
  return fabs(sum);
}

/* What the elements add around the corners of the plane mesh. */
static void estimate(struct work *w, const struct dea_recover_quantity *of, double *error,
                     double *part)
{
  const size_t elements = w->in->grid->element_count, columns = dea_grid_columns(w->in->grid);
  double recovered[DEA_HEX_NODES_MAX * WIDTH_MAX];
  for (size_t e = 0; e < elements; e++) {
    get_recovered(w, e, recovered);
    for (size_t k = 0; k < w->count; k++) {
      double one = add_element(w, e, k, recovered, w->around + k * columns);
      if (part != NULL) {
        part[k * elements + e] = one;
      }
    }
  }
  for (size_t k = 0; k < w->count; k++) {
    error[k] = larger_side(w->around + k * columns, columns) + between_nodes(w, &of[k]);
  }
}

/* Values of all elements at u and moved by each z, and what follows from them. */
static dea_status gather(struct work *w, const struct dea_recover_quantity *of,
                         const double (*mirror)[3])
{
  DEA_TRY(w->ctx, get_all(w, of));
  fit_all(w);
  if (w->in->grid->order == 2) {
    const struct dea_recover_second second = {.grid = w->in->grid,
                                              .group = w->points.group,
                                              .mirror = mirror,
                                              .tensors = 2 + w->count,
                                              .scalars = w->count,
                                              .nodes = w->nodes,
                                              .value = w->value};
    DEA_TRY(w->ctx, dea_recover_second(w->ctx, &second, w->second));
  }
  get_means(w);
  return DEA_OK;
}

dea_status dea_recover_errors(struct dea_context *ctx, const struct dea_recover_input *in,
                              const double (*mirror)[3], const struct dea_recover_quantity *of,
                              size_t count, double *error, double *part)
{
  struct work w = {.ctx = ctx, .memory = {.ctx = ctx}, .in = in, .count = count};
  dea_status status = prepare(&w);
  status = status == DEA_OK ? gather(&w, of, mirror) : status;
  if (status == DEA_OK) {
    estimate(&w, of, error, part);
  }
  dea_arena_free(&w.memory);
  return status;
}
