#include "model/solid/grid.h"

#include "base/quadrature.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Plane mesh under construction, and a hash of its nodes by place. */
struct plane_mesh {
  struct dea_context *ctx;
  size_t node_count, node_room, quad_count, table_size;
  double *x;   // [node_room][2]
  int *quads;  // [quad_count][(order + 1)^2]
  int *region; // [quad_count]
  int *table;  // node of a hash slot, -1: empty
  double close;
};

static size_t slot_of(const struct plane_mesh *m, int64_t i, int64_t j)
{
  uint64_t h = (uint64_t)i * 0x9E3779B97F4A7C15u ^ (uint64_t)j * 0xC2B2AE3D27D4EB4Fu;
  return (size_t)(h ^ (h >> 29)) % m->table_size;
}

/* Node at a place, made when there is none. The place is looked up in its cell and the neighbours',
 * so that rounding cannot part two nodes. */
static int node_at(struct plane_mesh *m, const double x[2])
{
  double cell = 4 * m->close;
  int64_t ci = (int64_t)floor(x[0] / cell), cj = (int64_t)floor(x[1] / cell);
  for (int64_t i = ci - 1; i <= ci + 1; i++) {
    for (int64_t j = cj - 1; j <= cj + 1; j++) {
      for (size_t k = slot_of(m, i, j); m->table[k] >= 0; k = (k + 1) % m->table_size) {
        const double *other = m->x + 2 * m->table[k];
        if (fabs(other[0] - x[0]) < m->close && fabs(other[1] - x[1]) < m->close) {
          return m->table[k];
        }
      }
    }
  }
  size_t k = slot_of(m, ci, cj);
  while (m->table[k] >= 0) {
    k = (k + 1) % m->table_size;
  }
  m->table[k] = (int)m->node_count;
  memcpy(m->x + 2 * m->node_count, x, 2 * sizeof *x);
  return (int)m->node_count++;
}

static void add_block(struct plane_mesh *m, int order, const struct dea_block *block)
{
  double at[DEA_HEX_ORDER_MAX + 1];
  int n = order + 1;
  dea_lobatto_nodes((size_t)order, at);
  for (size_t t = 0; t < block->count_t; t++) {
    for (size_t s = 0; s < block->count_s; s++) {
      int *quad = m->quads + m->quad_count * (size_t)(n * n);
      for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
          double x[2], fs = 0.5 * (1 + at[i]), ft = 0.5 * (1 + at[j]);
          block->map(block->self, block->cuts_s[s] + fs * (block->cuts_s[s + 1] - block->cuts_s[s]),
                     block->cuts_t[t] + ft * (block->cuts_t[t + 1] - block->cuts_t[t]), x);
          quad[n * j + i] = node_at(m, x);
        }
      }
      m->region[m->quad_count++] = block->region;
    }
  }
}

static void plane_release(struct plane_mesh *m)
{
  dea_free(m->ctx, m->x);
  dea_free(m->ctx, m->quads);
  dea_free(m->ctx, m->region);
  dea_free(m->ctx, m->table);
}

static dea_status plane_create(struct dea_context *ctx, int order, const struct dea_block *blocks,
                               size_t block_count, double length_m, struct plane_mesh *m)
{
  size_t quads = 0, per_quad = (size_t)((order + 1) * (order + 1));
  for (size_t i = 0; i < block_count; i++) {
    quads += blocks[i].count_s * blocks[i].count_t;
  }
  m->ctx = ctx;
  m->close = 1e-9 * length_m;
  m->node_room = quads * per_quad;
  m->table_size = 2 * m->node_room + 1;
  m->x = dea_alloc(ctx, m->node_room, 2 * sizeof(double));
  m->quads = dea_alloc(ctx, quads * per_quad, sizeof(int));
  m->region = dea_alloc(ctx, quads, sizeof(int));
  m->table = dea_alloc(ctx, m->table_size, sizeof(int));
  if (m->x == NULL || m->quads == NULL || m->region == NULL || m->table == NULL) {
    return DEA_E_MEMORY;
  }
  memset(m->table, -1, m->table_size * sizeof(int));
  for (size_t i = 0; i < block_count; i++) {
    add_block(m, order, &blocks[i]);
  }
  return DEA_OK;
}

/* Nodes of all levels through the sheets, and elements between them. */
static void extrude(const struct plane_mesh *m, const struct dea_sheet *sheets, size_t sheet_count,
                    double bottom_m, struct dea_grid *grid)
{
  int order_z = sheets[0].order_z, per_quad = (grid->order + 1) * (grid->order + 1);
  double at[DEA_HEX_ORDER_MAX + 1], z = bottom_m;
  size_t level = 0, element = 0;
  dea_lobatto_nodes((size_t)order_z, at);
  for (size_t s = 0; s < sheet_count; s++) {
    double step = sheets[s].thickness_m / (double)sheets[s].count;
    for (size_t k = 0; k < sheets[s].count; k++, level += (size_t)order_z, z += step) {
      for (int l = 0; l <= order_z; l++) {
        double *X = grid->X + 3 * (level + (size_t)l) * m->node_count;
        for (size_t n = 0; n < m->node_count; n++) {
          X[3 * n] = m->x[2 * n];
          X[3 * n + 1] = m->x[2 * n + 1];
          X[3 * n + 2] = z + 0.5 * (1 + at[l]) * step;
        }
      }
      for (size_t e = 0; e < m->quad_count; e++, element++) {
        int *to = grid->nodes + element * DEA_HEX_NODES_MAX;
        const int *quad = m->quads + e * (size_t)per_quad;
        for (int l = 0; l <= order_z; l++) {
          for (int n = 0; n < per_quad; n++) {
            *to++ = quad[n] + (int)((level + (size_t)l) * m->node_count);
          }
        }
        grid->region[element] = m->region[e];
        grid->sheet[element] = (int)s;
      }
    }
  }
}

dea_status dea_grid_create(struct dea_context *ctx, int order, const struct dea_block *blocks,
                           size_t block_count, const struct dea_sheet *sheets, size_t sheet_count,
                           double bottom_m, double length_m, struct dea_grid **out)
{
  struct plane_mesh m = {0};
  size_t through = 0;
  *out = NULL;
  for (size_t s = 0; s < sheet_count; s++) {
    through += sheets[s].count;
  }
  dea_status status = plane_create(ctx, order, blocks, block_count, length_m, &m);
  struct dea_grid *grid = status == DEA_OK ? dea_alloc(ctx, 1, sizeof *grid) : NULL;
  if (grid != NULL) {
    grid->order = order;
    grid->node_count = m.node_count * (through * (size_t)sheets[0].order_z + 1);
    grid->element_count = m.quad_count * through;
    grid->X = dea_alloc(ctx, grid->node_count, 3 * sizeof(double));
    grid->nodes = dea_alloc(ctx, grid->element_count, DEA_HEX_NODES_MAX * sizeof(int));
    grid->region = dea_alloc(ctx, grid->element_count, sizeof(int));
    grid->sheet = dea_alloc(ctx, grid->element_count, sizeof(int));
  }
  if (grid == NULL || grid->X == NULL || grid->nodes == NULL || grid->region == NULL ||
      grid->sheet == NULL) {
    dea_grid_destroy(ctx, grid);
    plane_release(&m);
    return DEA_E_MEMORY;
  }
  extrude(&m, sheets, sheet_count, bottom_m, grid);
  plane_release(&m);
  *out = grid;
  return DEA_OK;
}

void dea_grid_destroy(struct dea_context *ctx, struct dea_grid *grid)
{
  if (grid != NULL) {
    dea_free(ctx, grid->X);
    dea_free(ctx, grid->nodes);
    dea_free(ctx, grid->region);
    dea_free(ctx, grid->sheet);
    dea_free(ctx, grid);
  }
}

/* ---- quarter disc ---- */

static const double quarter = 0.78539816339744831; // pi/4

/* A square in the middle, its far corner pushed out, and rings around it. */
struct disc_block {
  int half;            // 0: angles up to pi/4, 1: beyond
  double core, r0, r1; // core > 0: from the square to the circle r1, else from circle r0 to r1
};

static const double core_corner = 0.8; // coordinates of the corner over the side: rounder than 1

static void map_core(const void *self, double s, double t, double x[2])
{
  const struct disc_block *b = self;
  double pull = 1 - (1 - core_corner) * s * t;
  x[0] = b->core * s * pull;
  x[1] = b->core * t * pull;
}

static void map_ring(const void *self, double s, double t, double x[2])
{
  const struct disc_block *b = self;
  double angle = quarter * (t + b->half), inner[2];
  if (b->core > 0) {
    double along = b->half == 0 ? t : 1 - t, edge[2];
    map_core(self, b->half == 0 ? 1 : along, b->half == 0 ? along : 1, edge);
    inner[0] = edge[0];
    inner[1] = edge[1];
  } else {
    inner[0] = b->r0 * cos(angle);
    inner[1] = b->r0 * sin(angle);
  }
  x[0] = (1 - s) * inner[0] + s * b->r1 * cos(angle);
  x[1] = (1 - s) * inner[1] + s * b->r1 * sin(angle);
}

enum { CUTS_MAX = 257 };

/* Cuts of [0, 1] for a strip of `length`: elements that start at `first` and double until they are
 * as wide as `widest`, scaled to fit. Returns their number, 0 when there are too many. */
static size_t graded_cuts(double length, double first, double widest, double *cuts)
{
  size_t count = 0;
  double sum = 0, width = first;
  cuts[0] = 0;
  while (sum < length * (1 - 1e-9)) {
    if (count + 2 > CUTS_MAX) {
      return 0;
    }
    sum += width;
    cuts[++count] = sum;
    width = fmin(2 * width, widest);
  }
  for (size_t i = 1; i <= count; i++) {
    cuts[i] /= sum;
  }
  return count;
}

/* The same seen from the other end. */
static void reverse_cuts(double *cuts, size_t count)
{
  double turned[CUTS_MAX];
  for (size_t i = 0; i <= count; i++) {
    turned[i] = 1 - cuts[count - i];
  }
  memcpy(cuts, turned, (count + 1) * sizeof *cuts);
}

dea_status dea_grid_quarter_disc(struct dea_context *ctx, int order, int order_z, double a_m,
                                 double b_m, double thickness_m, size_t fine, double edge_m,
                                 struct dea_grid **out)
{
  double even[CUTS_MAX], ring[CUTS_MAX], rest[CUTS_MAX];
  double square = quarter * a_m / (double)(fine > 0 ? fine : 1); // width along the circle
  double first = edge_m > 0 && edge_m < square ? edge_m : square;
  size_t rings = graded_cuts(0.45 * a_m, first, square, ring);
  size_t rests = graded_cuts(b_m - a_m, first, 2 * square, rest);
  if (fine < 1 || fine >= CUTS_MAX || rings == 0 || rests == 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the mesh would have more than %d elements in a row",
                    CUTS_MAX - 1);
  }
  reverse_cuts(ring, rings);
  for (size_t i = 0; i <= fine; i++) {
    even[i] = (double)i / (double)fine;
  }
  const struct disc_block core = {0, 0.55 * a_m, 0, a_m};
  const struct disc_block inner[2] = {{0, core.core, 0, a_m}, {1, core.core, 0, a_m}};
  const struct disc_block outer[2] = {{0, 0, a_m, b_m}, {1, 0, a_m, b_m}};
  const struct dea_block blocks[] = {
      {map_core, &core, even, even, fine, fine, 0},
      {map_ring, &inner[0], ring, even, rings, fine, 0},
      {map_ring, &inner[1], ring, even, rings, fine, 0},
      {map_ring, &outer[0], rest, even, rests, fine, 1},
      {map_ring, &outer[1], rest, even, rests, fine, 1},
  };
  const struct dea_sheet sheet = {thickness_m, 1, order_z};
  DEA_TRY(ctx, dea_grid_create(ctx, order, blocks, sizeof blocks / sizeof blocks[0], &sheet, 1,
                               -0.5 * thickness_m, b_m, out));
  return DEA_OK;
}
