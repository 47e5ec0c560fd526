/* Estimated errors of displacements (docs/theory/trust.md, "The estimated error"). */
#include "model/solid/recovery/recover_error.h"

#include "model/solid/recovery/recover_points.h"

#include <math.h>
#include <string.h>

enum { PER = 9 + 9 * DEA_ERRORS_MAX }; // P, then the gradient of each z

struct work {
  struct dea_context *ctx;
  struct dea_arena memory; // of all arrays
  const struct dea_recover_input *in;
  size_t count;
  double *moved;        // u + z / scale, [nodes][3]
  size_t plies, groups; // a group is a ply in a region
  int *point;           // [groups][node_count], counted from 1; 0: none
  size_t point_count;
  double (*value)[PER];    // [elements][DEA_HEX_NODES_MAX]
  double (*mean)[PER];     // [points] sums, then means
  double *weight, *volume; // [points], [elements]
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

static dea_status prepare(struct work *w)
{
  const struct dea_grid *grid = w->in->grid;
  size_t regions = 1, most = grid->element_count * DEA_HEX_NODES_MAX;
  w->plies = 1;
  for (size_t e = 0; e < grid->element_count; e++) {
    size_t ply = (size_t)grid->ply[e] + 1, region = (size_t)grid->region[e] + 1;
    w->plies = ply > w->plies ? ply : w->plies;
    regions = region > regions ? region : regions;
  }
  w->groups = w->plies * regions;
  w->moved = dea_arena_alloc(&w->memory, 3 * grid->node_count, sizeof *w->moved);
  w->point = dea_arena_alloc(&w->memory, w->groups * grid->node_count, sizeof *w->point);
  w->value = dea_arena_alloc(&w->memory, most, sizeof *w->value);
  w->mean = dea_arena_alloc(&w->memory, most, sizeof *w->mean);
  w->weight = dea_arena_alloc(&w->memory, most, sizeof *w->weight);
  w->volume = dea_arena_alloc(&w->memory, grid->element_count, sizeof *w->volume);
  return dea_arena_status(&w->memory);
}

static int *point_of(const struct work *w, size_t e, int n)
{
  const struct dea_grid *grid = w->in->grid;
  size_t group = (size_t)grid->region[e] * w->plies + (size_t)grid->ply[e];
  return &w->point[group * grid->node_count +
                   (size_t)grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n]];
}

/* Values of one element, of u (k = 0) or moved by the k-th z times `step`. */
static dea_status take_element(struct work *w, const struct dea_recover_input *in, size_t e,
                               size_t k, double step, struct dea_recovered *at)
{
  dea_status status = dea_recover_element(in, e, at);
  double(*value)[PER] = w->value + e * DEA_HEX_NODES_MAX;
  for (int n = 0; status == DEA_OK && n < at->nodes; n++) {
    if (k == 0) {
      nominal_stress(at->F[n], at->stress[n], value[n]);
      for (size_t m = 0; m < w->count; m++) {
        memcpy(value[n] + 9 + 9 * m, at->F[n], sizeof at->F[n]); // F until z is there
      }
    } else {
      for (int i = 0; i < 9; i++) {
        value[n][9 * k + (size_t)i] = (at->F[n][i] - value[n][9 * k + (size_t)i]) / step;
      }
    }
  }
  w->volume[e] = at->volume_m3;
  return status;
}

/* All elements, of u or moved. */
static dea_status take_all(struct work *w, size_t k, const double *z, struct dea_recovered *at)
{
  const struct dea_grid *grid = w->in->grid;
  struct dea_recover_input in = *w->in;
  double largest = 0, step = 1;
  for (size_t i = 0; z != NULL && i < 3 * grid->node_count; i++) {
    largest = fmax(largest, fabs(z[i]));
  }
  if (z != NULL) {
    step = largest > 0 ? 1e-9 / largest : 1; // moved by a nanometre: nothing turns inside out
    for (size_t i = 0; i < 3 * grid->node_count; i++) {
      w->moved[i] = w->in->u[i] + step * z[i];
    }
    in.u = w->moved;
  }
  for (size_t e = 0; e < grid->element_count; e++) {
    dea_status status = take_element(w, &in, e, k, step, at);
    if (status != DEA_OK) {
      return dea_fail(w->ctx, status, "element %zu is inverted or beyond its law's domain", e);
    }
  }
  return DEA_OK;
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
      w->weight[p] += w->volume[e];
      for (size_t i = 0; i < 9 + 9 * w->count; i++) {
        w->mean[p][i] += w->volume[e] * w->value[e * DEA_HEX_NODES_MAX + (size_t)n][i];
      }
    }
  }
  for (size_t p = 0; p < w->point_count; p++) {
    for (size_t i = 0; i < 9 + 9 * w->count; i++) {
      w->mean[p][i] /= w->weight[p];
    }
  }
}

/* Integral of (P* - P) : (grad z* - grad z) over an element, by its nodes. */
static double product(const struct work *w, size_t e, size_t k)
{
  int nodes = dea_grid_nodes_of(w->in->grid, e);
  double sum = 0;
  for (int n = 0; n < nodes; n++) {
    const double *mean = w->mean[*point_of(w, e, n) - 1];
    const double *own = w->value[e * DEA_HEX_NODES_MAX + (size_t)n];
    for (size_t i = 0; i < 9; i++) {
      sum += (mean[i] - own[i]) * (mean[9 + 9 * k + i] - own[9 + 9 * k + i]);
    }
  }
  return w->volume[e] / nodes * sum;
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

dea_status dea_recover_errors(struct dea_context *ctx, const struct dea_recover_input *in,
                              const double *const *z, size_t count, double *error, double *part)
{
  struct work w = {.ctx = ctx, .memory = {.ctx = ctx}, .in = in, .count = count};
  struct dea_recovered *at = dea_alloc(ctx, 1, sizeof *at);
  dea_status status = at != NULL ? prepare(&w) : DEA_E_MEMORY;
  for (size_t k = 0; status == DEA_OK && k <= count; k++) {
    status = take_all(&w, k, k > 0 ? z[k - 1] : NULL, at);
  }
  if (status == DEA_OK) {
    take_means(&w);
    for (size_t k = 0; k < count; k++) {
      error[k] = estimate(&w, k, part);
    }
  }
  dea_free(ctx, at);
  dea_arena_free(&w.memory);
  return status;
}
