#include "model/solid/recovery/line_profile.h"

#include "base/arena.h"
#include "base/context.h"
#include "base/quadrature.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PLACE, U, Z, STRETCH_R, STRETCH_T, TENSION_R, TENSION_T, COLUMNS };

struct row {
  double value[COLUMNS];
  double middle; // of the edges that the point is on: inner part first where two meet
};

struct work {
  struct dea_arena memory; // of the arrays below
  const struct dea_field_mesh *surface;
  const double *u, *stretch, *tension; // fields of the surface
  double *slope, *middle, *weight;     // |dx/dr| and middle of the edges on a ray, sums; [points]
  bool *used;                          // by a ray before
  struct row *rows;
  size_t row_count;
  double close, pre_stretch;
};

static bool is_on(const struct work *w, const double *X, double c, double s)
{
  return fabs(c * X[1] - s * X[0]) < w->close && c * X[0] + s * X[1] > -w->close;
}

/* Adds the length of dx/dr at the nodes of one edge of a cell, where it lies on the ray. */
static void add_edge(struct work *w, const int *points, int count, double c, double s)
{
  double places[DEA_MESH_ORDER_MAX + 1], value[DEA_MESH_ORDER_MAX + 1];
  double slope[DEA_MESH_ORDER_MAX + 1];
  for (int i = 0; i < count; i++) {
    if (!is_on(w, w->surface->X + 3 * points[i], c, s)) {
      return;
    }
  }
  // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): a line has points
  const double *first = w->surface->X + 3 * points[0];
  const double *last = w->surface->X + 3 * points[count - 1];
  dea_lobatto_nodes((size_t)count - 1, places);
  for (int i = 0; i < count; i++) {
    double dx[3] = {0, 0, 0}, dr = 0;
    dea_lagrange((size_t)count, places, places[i], value, slope);
    for (int k = 0; k < count; k++) {
      const double *X = w->surface->X + 3 * points[k], *u = w->u + 3 * points[k];
      dr += slope[k] * (c * X[0] + s * X[1]);
      for (int j = 0; j < 3; j++) {
        dx[j] += slope[k] * ((j < 2 ? X[j] : 0) + u[j]);
      }
    }
    w->slope[points[i]] += sqrt(dx[0] * dx[0] + dx[1] * dx[1] + dx[2] * dx[2]) / fabs(dr);
    w->middle[points[i]] += 0.5 * (c * (first[0] + last[0]) + s * (first[1] + last[1]));
    w->weight[points[i]] += 1;
  }
}

static void add_edges(struct work *w, double c, double s)
{
  for (size_t b = 0; b < w->surface->block_count; b++) {
    const struct dea_mesh_block *block = &w->surface->blocks[b];
    int n = block->order + 1, per = dea_mesh_block_nodes(block);
    const int first[4] = {0, n * (n - 1), 0, n - 1}, step[4] = {1, 1, n, n};
    for (size_t e = 0; e < block->count; e++) {
      for (int k = 0; k < 4; k++) {
        int edge[DEA_MESH_ORDER_MAX + 1];
        for (int i = 0; i < n; i++) {
          edge[i] = block->nodes[e * (size_t)per + (size_t)(first[k] + i * step[k])];
        }
        add_edge(w, edge, n, c, s);
      }
    }
  }
}

/* Rows of a ray; sign: of their places. */
static void add_ray(struct work *w, double angle, double sign)
{
  double c = cos(angle), s = sin(angle);
  memset(w->slope, 0, w->surface->point_count * sizeof *w->slope);
  memset(w->middle, 0, w->surface->point_count * sizeof *w->middle);
  memset(w->weight, 0, w->surface->point_count * sizeof *w->weight);
  add_edges(w, c, s);
  for (size_t p = 0; p < w->surface->point_count; p++) {
    const double *X = w->surface->X + 3 * p, *u = w->u + 3 * p;
    if (w->weight[p] == 0 || w->used[p]) {
      continue;
    }
    // of the two principal directions in the surface the one that has the ray's stretch
    double along = w->pre_stretch * w->slope[p] / w->weight[p];
    const double *stretch = w->stretch + 3 * p;
    int r = fabs(stretch[0] - along) <= fabs(stretch[1] - along) ? 0 : 1;
    w->used[p] = true;
    w->rows[w->row_count++] = (struct row){{[PLACE] = sign * (c * X[0] + s * X[1]),
                                            [U] = c * u[0] + s * u[1],
                                            [Z] = u[2],
                                            [STRETCH_R] = stretch[r],
                                            [STRETCH_T] = stretch[1 - r],
                                            [TENSION_R] = w->tension[2 * p + (size_t)r],
                                            [TENSION_T] = w->tension[2 * p + 1 - (size_t)r]},
                                           sign * w->middle[p] / w->weight[p]};
  }
}

static int compare_rows(const void *a, const void *b)
{
  const struct row *x = a, *y = b;
  // two parts at one place have it to the bit: it is that of one node
  if (x->value[PLACE] != y->value[PLACE]) {
    return x->value[PLACE] < y->value[PLACE] ? -1 : 1;
  }
  return (x->middle > y->middle) - (x->middle < y->middle);
}

static dea_status fill(struct dea_context *ctx, struct work *w, double plus, double minus,
                       double **columns, struct dea_profile *out)
{
  size_t count = w->surface->point_count;
  w->slope = dea_arena_alloc(&w->memory, count, sizeof *w->slope);
  w->middle = dea_arena_alloc(&w->memory, count, sizeof *w->middle);
  w->weight = dea_arena_alloc(&w->memory, count, sizeof *w->weight);
  w->used = dea_arena_alloc(&w->memory, count, sizeof *w->used);
  w->rows = dea_arena_alloc(&w->memory, count, sizeof *w->rows);
  DEA_TRY(ctx, dea_arena_status(&w->memory));
  add_ray(w, plus, 1);
  add_ray(w, minus, -1);
  qsort(w->rows, w->row_count, sizeof *w->rows, compare_rows);
  double *to = dea_alloc(ctx, w->row_count, COLUMNS * sizeof *to);
  DEA_TRY_MEMORY(to != NULL);
  size_t n = w->row_count;
  for (size_t i = 0; i < n; i++) {
    for (size_t c = 0; c < COLUMNS; c++) {
      to[c * n + i] = w->rows[i].value[c];
    }
  }
  *columns = to;
  *out = (struct dea_profile){.count = n,
                              .radius_m = to + PLACE * n,
                              .displacement_m = to + U * n,
                              .z_m = to + Z * n,
                              .stretch_r = to + STRETCH_R * n,
                              .stretch_t = to + STRETCH_T * n,
                              .tension_r_N_per_m = to + TENSION_R * n,
                              .tension_t_N_per_m = to + TENSION_T * n};
  return DEA_OK;
}

dea_status dea_line_profile(struct dea_context *ctx, const struct dea_field_mesh *surface,
                            double plus, double minus, double pre_stretch, double **columns,
                            struct dea_profile *out)
{
  struct work w = {.memory = {.ctx = ctx},
                   .surface = surface,
                   .u = dea_field_mesh_find(surface, "displacement_m")->values,
                   .stretch = dea_field_mesh_find(surface, "plane_stretch")->values,
                   .tension = dea_field_mesh_find(surface, "tension_N_per_m")->values,
                   .pre_stretch = pre_stretch};
  *columns = NULL;
  for (size_t p = 0; p < surface->point_count; p++) {
    w.close = fmax(w.close, 1e-9 * fmax(fabs(surface->X[3 * p]), fabs(surface->X[3 * p + 1])));
  }
  dea_status status = fill(ctx, &w, plus, minus, columns, out);
  dea_arena_free(&w.memory);
  return DEA_CHAIN(ctx, status);
}
