#include "model/solid/mesh/grid.h"

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

/* Levels that a ply has above its bottom: none without thickness. */
static size_t ply_levels(const struct dea_ply *ply)
{
  return ply->thickness_m > 0 ? ply->count * (size_t)ply->order_z : 0;
}

/* Level of nodes at the bottom of a ply, the first level of its own (one above), and its z. A
 * level counts through all plies: 0 is the bottom of the first, then order_z for each element. */
struct ply_place {
  size_t bottom, own;
  double z;
};

static struct ply_place ply_place(const struct dea_ply *plies, const size_t *skips, size_t s,
                                  double bottom_m)
{
  struct ply_place at = {0, 1, bottom_m};
  for (size_t k = 0; k < s; k++) {
    at.own += ply_levels(&plies[k]);
  }
  size_t passed = skips != NULL ? skips[s] : 0;
  if (s > passed) { // on the top of another one
    size_t under = s - 1 - passed;
    size_t levels = ply_levels(&plies[under]);
    struct ply_place below = ply_place(plies, skips, under, bottom_m);
    at.bottom = levels > 0 ? below.own + levels - 1 : below.bottom;
    at.z = below.z + plies[under].thickness_m;
  }
  return at;
}

/* Nodes of a level. */
static void place_level(const struct plane_mesh *m, size_t levels, size_t level, double z,
                        struct dea_grid *grid)
{
  for (size_t n = 0; n < m->node_count; n++) {
    double *X = grid->X + 3 * (n * levels + level);
    X[0] = m->x[2 * n];
    X[1] = m->x[2 * n + 1];
    X[2] = z;
  }
}

/* Elements of one layer of a ply, of a surface with order_z 0; level[]: of their nodes, from bottom
 * to top; levels: of all. */
static void extrude_layer(const struct plane_mesh *m, size_t levels, const size_t *level,
                          int order_z, int ply, bool (*present)(int region, int ply),
                          struct dea_grid *grid)
{
  int per_quad = (grid->order + 1) * (grid->order + 1);
  for (size_t e = 0; e < m->quad_count; e++) {
    if (present != NULL && !present(m->region[e], ply)) {
      continue;
    }
    int *to = grid->nodes + grid->element_count * DEA_HEX_NODES_MAX;
    const int *quad = m->quads + e * (size_t)per_quad;
    for (int l = 0; l <= order_z; l++) {
      for (int n = 0; n < per_quad; n++) {
        *to++ = (int)((size_t)quad[n] * levels + level[l]);
      }
    }
    grid->levels[grid->element_count] = order_z + 1;
    grid->kind[grid->element_count] = order_z == 0 ? DEA_ELEMENT_MEMBRANE : DEA_ELEMENT_HEXAHEDRON;
    grid->region[grid->element_count] = m->region[e];
    grid->ply[grid->element_count++] = ply;
  }
}

/* Nodes of all levels through the plies, and elements between them. The nodes of a column follow
 * each other, so that a range of numbers is a part of the plate. */
static void extrude(const struct plane_mesh *m, const struct dea_ply *plies, size_t ply_count,
                    const size_t *skips, bool (*present)(int region, int ply), double bottom_m,
                    struct dea_grid *grid)
{
  size_t levels = grid->node_count / m->node_count;
  double at[DEA_HEX_ORDER_MAX + 1];
  grid->element_count = 0;
  for (size_t s = 0; s < ply_count; s++) {
    bool surface = ply_levels(&plies[s]) == 0;
    int order_z = surface ? 0 : plies[s].order_z;
    struct ply_place place = ply_place(plies, skips, s, bottom_m);
    at[0] = -1;
    if (!surface) {
      dea_lobatto_nodes((size_t)order_z, at);
    }
    for (size_t k = 0; k < plies[s].count; k++) {
      size_t level[DEA_HEX_ORDER_MAX + 1];
      double step = plies[s].thickness_m / (double)plies[s].count;
      for (int l = 0; l <= order_z; l++) {
        size_t up = k * (size_t)order_z + (size_t)l;
        level[l] = up == 0 ? place.bottom : place.own + up - 1;
        place_level(m, levels, level[l], place.z + ((double)k + 0.5 * (1 + at[l])) * step, grid);
      }
      extrude_layer(m, levels, level, order_z, (int)s, present, grid);
    }
  }
}

/* Takes out the nodes that no element has. */
static dea_status compact(struct dea_context *ctx, struct dea_grid *grid)
{
  int *number = dea_alloc(ctx, grid->node_count, sizeof *number);
  if (number == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t e = 0; e < grid->element_count; e++) {
    for (int n = 0; n < dea_grid_nodes_of(grid, e); n++) {
      number[grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n]] = 1;
    }
  }
  size_t count = 0;
  for (size_t n = 0; n < grid->node_count; n++) {
    if (number[n] != 0) {
      memmove(grid->X + 3 * count, grid->X + 3 * n, 3 * sizeof(double));
      number[n] = (int)count++;
    }
  }
  grid->node_count = count;
  for (size_t e = 0; e < grid->element_count; e++) {
    for (int n = 0; n < dea_grid_nodes_of(grid, e); n++) {
      int *node = &grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n];
      *node = number[*node];
    }
  }
  dea_free(ctx, number);
  return DEA_OK;
}

int dea_grid_nodes_of(const struct dea_grid *grid, size_t element)
{
  return (grid->order + 1) * (grid->order + 1) * grid->levels[element];
}

dea_status dea_grid_create(struct dea_context *ctx, int order, const struct dea_block *blocks,
                           size_t block_count, const struct dea_ply *plies, size_t ply_count,
                           bool (*present)(int region, int ply), double bottom_m, double length_m,
                           struct dea_grid **out)
{
  return dea_grid_create_skipping(ctx, order, blocks, block_count, plies, ply_count, NULL, present,
                                  bottom_m, length_m, out);
}

dea_status dea_grid_create_skipping(struct dea_context *ctx, int order,
                                    const struct dea_block *blocks, size_t block_count,
                                    const struct dea_ply *plies, size_t ply_count,
                                    const size_t *skips, bool (*present)(int region, int ply),
                                    double bottom_m, double length_m, struct dea_grid **out)
{
  struct plane_mesh m = {0};
  size_t through = 0, levels = 1;
  *out = NULL;
  for (size_t s = 0; s < ply_count; s++) {
    through += plies[s].count;
    levels += ply_levels(&plies[s]);
  }
  dea_status status = plane_create(ctx, order, blocks, block_count, length_m, &m);
  struct dea_grid *grid = status == DEA_OK ? dea_alloc(ctx, 1, sizeof *grid) : NULL;
  if (grid != NULL) {
    grid->order = order;
    grid->order_z = plies[0].order_z;
    grid->node_count = m.node_count * levels;
    grid->element_count = m.quad_count * through;
    grid->X = dea_alloc(ctx, grid->node_count, 3 * sizeof(double));
    grid->nodes = dea_alloc(ctx, grid->element_count, DEA_HEX_NODES_MAX * sizeof(int));
    grid->region = dea_alloc(ctx, grid->element_count, sizeof(int));
    grid->ply = dea_alloc(ctx, grid->element_count, sizeof(int));
    grid->levels = dea_alloc(ctx, grid->element_count, sizeof *grid->levels);
    grid->kind = dea_alloc(ctx, grid->element_count, sizeof *grid->kind);
  }
  if (grid == NULL || grid->X == NULL || grid->nodes == NULL || grid->region == NULL ||
      grid->ply == NULL || grid->levels == NULL || grid->kind == NULL) {
    dea_grid_destroy(ctx, grid);
    plane_release(&m);
    return DEA_E_MEMORY;
  }
  extrude(&m, plies, ply_count, skips, present, bottom_m, grid);
  status = compact(ctx, grid);
  plane_release(&m);
  if (status != DEA_OK) {
    dea_grid_destroy(ctx, grid);
    return status;
  }
  *out = grid;
  return DEA_OK;
}

void dea_grid_destroy(struct dea_context *ctx, struct dea_grid *grid)
{
  if (grid != NULL) {
    dea_free(ctx, grid->X);
    dea_free(ctx, grid->nodes);
    dea_free(ctx, grid->region);
    dea_free(ctx, grid->ply);
    dea_free(ctx, grid->levels);
    dea_free(ctx, grid->kind);
    dea_free(ctx, grid);
  }
}

size_t dea_grid_nearest(const struct dea_grid *grid, const double X_m[3])
{
  size_t nearest = 0;
  double best = INFINITY;
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *X = grid->X + 3 * n;
    double distance = hypot(hypot(X[0] - X_m[0], X[1] - X_m[1]), X[2] - X_m[2]);
    if (distance < best) {
      best = distance;
      nearest = n;
    }
  }
  return nearest;
}
