/* Estimated errors of displacements (docs/theory/trust.md, "The estimated error"). */
#include "model/solid/recovery/recover_error.h"

#include "base/quadrature.h"
#include "model/solid/recovery/recover_points.h"
#include "model/solid/recovery/recover_second.h"

#include <math.h>
#include <string.h>

enum { AT_P, AT_F, AT_Z, TENSORS = AT_Z + DEA_ERRORS_MAX }; // P, F, the gradient of each z
enum { SECOND = 2 * DEA_RECOVER_LEVELS };                   // of an element, times the tensors

/* Of an error how many times what recovery sees of it: regular solutions have (3/2)^4 of the error
 * of elements of one order more and so 1 / (1 - (2/3)^4) of what lies between; solid films were
 * calibrated (docs/theory/trust.md). */
static const double unseen_of_membranes = 81.0 / 65.0, unseen_of_solids = 4;

struct work {
  struct dea_context *ctx;
  struct dea_arena memory; // of all arrays
  const struct dea_recover_input *in;
  size_t count, tensors, nodes; // quantities, tensors of a node, nodes of an element at most
  double *moved;                // u + z / scale, [nodes][3]
  size_t group_count;
  int *group; // [elements] of a ply and a region
  int *point; // [groups][node_count], counted from 1; 0: none
  size_t point_count;
  double (*value)[9];                // [elements][nodes][tensors]
  double (*mean)[9];                 // [points][tensors] sums, then means
  double *second;                    // [elements] as dea_recover_second
  double *weight, *volume;           // [points], [elements]
  double along[2][DEA_HEX_LINE_MAX]; // shares of the nodes of a line in its integral, in the plane
                                     // and through the thickness
};

/* First Piola-Kirchhoff stress J sigma F^-T. */
static void nominal_stress(const double F[9], const double s[6], double P[9])
{
  const double sigma[9] = {s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2]};
  double cof[9];
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      cof[3 * i + j] = F[3 * a + c] * F[3 * b + d] - F[3 * a + d] * F[3 * b + c];
    }
  }
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      P[3 * i + j] =
          sigma[3 * i] * cof[j] + sigma[3 * i + 1] * cof[3 + j] + sigma[3 * i + 2] * cof[6 + j];
    }
  }
}

/* Shares of the nodes of a line of elements in the integral over it. */
static void weigh_line(int order, double *share)
{
  size_t count = (size_t)order + 1;
  double node[DEA_HEX_LINE_MAX], x[DEA_HEX_LINE_MAX], w[DEA_HEX_LINE_MAX];
  double value[DEA_HEX_LINE_MAX], slope[DEA_HEX_LINE_MAX];
  dea_lobatto_nodes((size_t)order, node);
  dea_gauss_rule(count, x, w);
  for (size_t q = 0; q < count; q++) {
    dea_lagrange(count, node, x[q], value, slope);
    for (size_t n = 0; n < count; n++) {
      share[n] += 0.5 * w[q] * value[n];
    }
  }
}

static dea_status prepare(struct work *w)
{
  const struct dea_grid *grid = w->in->grid;
  size_t plies = 1, regions = 1, elements = grid->element_count;
  for (size_t e = 0; e < elements; e++) {
    size_t ply = (size_t)grid->ply[e] + 1, region = (size_t)grid->region[e] + 1;
    plies = ply > plies ? ply : plies;
    regions = region > regions ? region : regions;
    size_t nodes = (size_t)dea_grid_nodes_of(grid, e);
    w->nodes = nodes > w->nodes ? nodes : w->nodes;
  }
  size_t most = elements * w->nodes;
  w->group_count = plies * regions;
  w->tensors = AT_Z + w->count;
  w->moved = dea_arena_alloc(&w->memory, 3 * grid->node_count, sizeof *w->moved);
  w->group = dea_arena_alloc(&w->memory, elements, sizeof *w->group);
  w->point = dea_arena_alloc(&w->memory, w->group_count * grid->node_count, sizeof *w->point);
  w->value = dea_arena_alloc(&w->memory, most * w->tensors, sizeof *w->value);
  w->mean = dea_arena_alloc(&w->memory, most * w->tensors, sizeof *w->mean);
  w->second = dea_arena_alloc(&w->memory, elements * SECOND * 9 * w->tensors, sizeof *w->second);
  w->weight = dea_arena_alloc(&w->memory, most, sizeof *w->weight);
  w->volume = dea_arena_alloc(&w->memory, elements, sizeof *w->volume);
  for (size_t e = 0; e < elements && w->group != NULL; e++) {
    w->group[e] = (int)((size_t)grid->region[e] * plies + (size_t)grid->ply[e]);
  }
  weigh_line(grid->order, w->along[0]);
  weigh_line(grid->order_z, w->along[1]);
  return dea_arena_status(&w->memory);
}

static int *point_of(const struct work *w, size_t e, int n)
{
  const struct dea_grid *grid = w->in->grid;
  return &w->point[(size_t)w->group[e] * grid->node_count +
                   (size_t)grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n]];
}

/* The tensors of a node of an element. */
static double (*value_at(const struct work *w, size_t e, int n))[9]
{
  return w->value + (e * w->nodes + (size_t)n) * w->tensors;
}

/* Values of one element at u. */
static dea_status take_state(struct work *w, size_t e, struct dea_recovered *at)
{
  dea_status status = dea_recover_element(w->in, e, at);
  for (int n = 0; status == DEA_OK && n < at->nodes; n++) {
    double(*value)[9] = value_at(w, e, n);
    nominal_stress(at->F[n], at->stress[n], value[AT_P]);
    memcpy(value[AT_F], at->F[n], sizeof at->F[n]);
  }
  w->volume[e] = at->volume_m3;
  return status;
}

/* The gradient of the k-th z in one element, where `in` is moved by `step` of it. */
static dea_status take_gradient(struct work *w, const struct dea_recover_input *in, size_t e,
                                size_t k, double step)
{
  double F[DEA_HEX_NODES_MAX][9];
  dea_status status = dea_recover_deformation(in, e, F);
  for (int n = 0; status == DEA_OK && n < dea_grid_nodes_of(w->in->grid, e); n++) {
    double(*value)[9] = value_at(w, e, n);
    for (int i = 0; i < 9; i++) {
      value[AT_Z + k][i] = (F[n][i] - value[AT_F][i]) / step;
    }
  }
  return status;
}

/* What u is moved by: a nanometre, so that nothing turns inside out. Returns the share of z. */
static double move(struct work *w, const double *z)
{
  const size_t count = 3 * w->in->grid->node_count;
  double largest = 0;
  for (size_t i = 0; i < count; i++) {
    largest = fmax(largest, fabs(z[i]));
  }
  const double step = largest > 0 ? 1e-9 / largest : 1;
  for (size_t i = 0; i < count; i++) {
    w->moved[i] = w->in->u[i] + step * z[i];
  }
  return step;
}

/* All elements, at u and moved by each z. */
static dea_status take_all(struct work *w, const double *const *z, struct dea_recovered *at)
{
  const size_t elements = w->in->grid->element_count;
  struct dea_recover_input in = *w->in;
  dea_status status = DEA_OK;
  size_t e = 0;
  for (; status == DEA_OK && e < elements; e++) {
    status = take_state(w, e, at);
  }
  in.u = w->moved;
  for (size_t k = 0; status == DEA_OK && k < w->count; k++) {
    const double step = move(w, z[k]);
    for (e = 0; status == DEA_OK && e < elements; e++) {
      status = take_gradient(w, &in, e, k, step);
    }
  }
  return status == DEA_OK ? DEA_OK
                          : dea_fail(w->ctx, status,
                                     "element %zu is inverted or beyond its law's domain", e - 1);
}

/* P_2 at the nodes of a line of order 2. */
static const double bent[3] = {1, -0.5, 1};

/* Adds what neighbours know of the second order to the value of a node. */
static void add_second(const struct work *w, size_t e, int n, double (*value)[9])
{
  const struct dea_grid *grid = w->in->grid;
  if (grid->order != 2) {
    return;
  }
  size_t level = (size_t)n / 9;
  const double share[2] = {bent[n % 3], bent[n / 3 % 3]};
  for (size_t axis = 0; axis < 2; axis++) {
    const double *c = w->second + (e * SECOND + axis * DEA_RECOVER_LEVELS + level) * w->tensors * 9;
    for (size_t i = 0; i < 9 * w->tensors; i++) {
      value[i / 9][i % 9] += share[axis] * c[i];
    }
  }
}

/* Means at the points, by volume. */
static void take_means(struct work *w)
{
  const struct dea_grid *grid = w->in->grid;
  for (size_t e = 0; e < grid->element_count; e++) {
    for (int n = 0; n < dea_grid_nodes_of(grid, e); n++) {
      int *point = point_of(w, e, n);
      *point = *point == 0 ? (int)++w->point_count : *point;
      size_t p = (size_t)*point - 1;
      double value[TENSORS][9];
      memcpy(value, value_at(w, e, n), w->tensors * sizeof *value);
      add_second(w, e, n, value);
      w->weight[p] += w->volume[e];
      for (size_t i = 0; i < 9 * w->tensors; i++) {
        w->mean[p * w->tensors + i / 9][i % 9] += w->volume[e] * value[i / 9][i % 9];
      }
    }
  }
  for (size_t i = 0; i < 9 * w->point_count * w->tensors; i++) {
    w->mean[i / 9][i % 9] /= w->weight[i / 9 / w->tensors];
  }
}

/* d[t] = what recovery changes of the tensors of a node. */
static void changes(const struct work *w, size_t e, int n, double (*d)[9])
{
  double(*own)[9] = value_at(w, e, n);
  double(*mean)[9] = w->mean + ((size_t)*point_of(w, e, n) - 1) * w->tensors;
  for (size_t i = 0; i < 9 * w->tensors; i++) {
    d[i / 9][i % 9] = mean[i / 9][i % 9] - own[i / 9][i % 9];
  }
}

/* Work of what recovery changes of the stress on what it changes of the gradient of the k-th z, of
 * a solid in the plane of the film: (F^-1 dP)_ab (F^T dgrad z)_ab, a, b = 1, 2. */
static double work_at(const double own[9], const double dP[9], const double dZ[9])
{
  const double *f = own;
  double cof[9], J, sum = 0;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      cof[3 * i + j] = f[3 * a + c] * f[3 * b + d] - f[3 * a + d] * f[3 * b + c];
    }
  }
  J = f[0] * cof[0] + f[1] * cof[1] + f[2] * cof[2];
  for (int a = 0; a < 2; a++) {
    for (int b = 0; b < 2; b++) {
      double S = 0, G = 0;
      for (int i = 0; i < 3; i++) {
        S += cof[3 * i + a] / J * dP[3 * i + b];
        G += f[3 * i + a] * dZ[3 * i + b];
      }
      sum += S * G;
    }
  }
  return sum;
}

/* The same of a membrane, all of whose stress is in its surface. */
static double surface_work_at(const double dP[9], const double dZ[9])
{
  double sum = 0;
  for (int i = 0; i < 9; i++) {
    sum += dP[i] * dZ[i];
  }
  return sum;
}

/* Its integral over an element, by its nodes, and what an element of that kind does not see. */
static double product(const struct work *w, size_t e, size_t k)
{
  const struct dea_grid *grid = w->in->grid;
  int line = grid->order + 1, levels = grid->levels[e];
  bool flat = w->in->kind[e] == DEA_ELEMENT_MEMBRANE;
  double sum = 0;
  for (int n = 0; n < dea_grid_nodes_of(grid, e); n++) {
    double d[TENSORS][9];
    changes(w, e, n, d);
    double share = w->along[0][n % line] * w->along[0][n / line % line] *
                   (levels > 1 ? w->along[1][n / (line * line)] : 1);
    sum += share * (flat ? surface_work_at(d[AT_P], d[AT_Z + k])
                         : work_at(value_at(w, e, n)[AT_F], d[AT_P], d[AT_Z + k]));
  }
  return w->volume[e] * sum * (flat ? unseen_of_membranes : unseen_of_solids);
}

/* What the elements add, none of it against another's (docs/verification/trust.md). */
static double estimate(const struct work *w, size_t k, double *part)
{
  double magnitudes = 0;
  for (size_t e = 0; e < w->in->grid->element_count; e++) {
    double one = product(w, e, k);
    if (part != NULL) {
      part[k * w->in->grid->element_count + e] = one;
    }
    magnitudes += fabs(one);
  }
  return magnitudes;
}

/* Values of all elements at u and moved by each z, and what follows from them. */
static dea_status gather(struct work *w, const double *const *z, const double (*mirror)[3],
                         struct dea_recovered *at)
{
  dea_status status = take_all(w, z, at);
  if (status == DEA_OK && w->in->grid->order == 2) {
    const struct dea_recover_second second = {.grid = w->in->grid,
                                              .group = w->group,
                                              .mirror = mirror,
                                              .tensors = w->tensors,
                                              .nodes = w->nodes,
                                              .value = (const double *)w->value};
    status = dea_recover_second(w->ctx, &second, w->second);
  }
  if (status == DEA_OK) {
    take_means(w);
  }
  return status;
}

dea_status dea_recover_errors(struct dea_context *ctx, const struct dea_recover_input *in,
                              const double (*mirror)[3], const double *const *z, size_t count,
                              double *error, double *part)
{
  struct work w = {.ctx = ctx, .memory = {.ctx = ctx}, .in = in, .count = count};
  struct dea_recovered *at = dea_alloc(ctx, 1, sizeof *at);
  dea_status status = at != NULL ? prepare(&w) : DEA_E_MEMORY;
  if (status == DEA_OK) {
    status = gather(&w, z, mirror, at);
  }
  for (size_t k = 0; status == DEA_OK && k < count; k++) {
    error[k] = estimate(&w, k, part);
  }
  dea_free(ctx, at);
  dea_arena_free(&w.memory);
  return status;
}
