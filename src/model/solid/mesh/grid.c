#include "model/solid/mesh/grid.h"

#include "base/quadrature.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

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

static bool is_beside(const struct dea_stack *stack, size_t s)
{
  return stack->beside != NULL && stack->beside[s] != SIZE_MAX;
}

static struct ply_place ply_place(const struct dea_stack *stack, size_t s)
{
  struct ply_place at = {0, 1, stack->bottom_m};
  s = is_beside(stack, s) ? stack->beside[s] : s;
  for (size_t k = 0; k < s; k++) {
    at.own += is_beside(stack, k) ? 0 : ply_levels(&stack->plies[k]);
  }
  size_t passed = stack->skips != NULL ? stack->skips[s] : 0;
  if (s > passed) { // on the top of another one
    size_t under = s - 1 - passed;
    size_t levels = ply_levels(&stack->plies[under]);
    struct ply_place below = ply_place(stack, under);
    at.bottom = levels > 0 ? below.own + levels - 1 : below.bottom;
    at.z = below.z + stack->plies[under].thickness_m;
  }
  return at;
}

/* Share of its thickness at which the k-th element of a ply begins. */
static double ply_cut(const struct dea_stack *stack, size_t s, size_t k)
{
  return stack->cuts != NULL && stack->cuts[s] != NULL ? stack->cuts[s][k]
                                                       : (double)k / (double)stack->plies[s].count;
}

/* Nodes of a level. */
static void place_level(const struct dea_plane_mesh *m, size_t levels, size_t level, double z,
                        struct dea_grid *grid)
{
  for (size_t n = 0; n < m->node_count; n++) {
    double *X = grid->X + 3 * (n * levels + level);
    grid->column[n * levels + level] = (int)n;
    X[0] = m->x[2 * n];
    X[1] = m->x[2 * n + 1];
    X[2] = z;
  }
}

/* Elements of one layer of a ply, of a surface with order_z 0; level[]: of their nodes, from bottom
 * to top; levels: of all. */
static void extrude_layer(const struct dea_plane_mesh *m, size_t levels, const size_t *level,
                          int order_z, const struct dea_stack *stack, int ply,
                          struct dea_grid *grid)
{
  int per_quad = (grid->order + 1) * (grid->order + 1);
  for (size_t e = 0; e < m->quad_count; e++) {
    if (stack->present != NULL && !stack->present(stack->self, m->region[e], ply)) {
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
static void extrude(const struct dea_plane_mesh *m, const struct dea_stack *stack,
                    struct dea_grid *grid)
{
  size_t levels = grid->node_count / m->node_count;
  double at[DEA_HEX_ORDER_MAX + 1];
  grid->element_count = 0;
  for (size_t s = 0; s < stack->count; s++) {
    const struct dea_ply *ply = &stack->plies[s];
    bool surface = ply_levels(ply) == 0;
    int order_z = surface ? 0 : ply->order_z;
    struct ply_place place = ply_place(stack, s);
    at[0] = -1;
    if (!surface) {
      dea_lobatto_nodes((size_t)order_z, at);
    }
    for (size_t k = 0; k < ply->count; k++) {
      size_t level[DEA_HEX_ORDER_MAX + 1];
      double from = ply->thickness_m * ply_cut(stack, s, k);
      double step = ply->thickness_m * ply_cut(stack, s, k + 1) - from;
      for (int l = 0; l <= order_z; l++) {
        size_t up = k * (size_t)order_z + (size_t)l;
        level[l] = up == 0 ? place.bottom : place.own + up - 1;
        place_level(m, levels, level[l], place.z + from + 0.5 * (1 + at[l]) * step, grid);
      }
      extrude_layer(m, levels, level, order_z, stack, (int)s, grid);
    }
  }
}

/* Takes out the nodes that no element has. */
static dea_status compact(struct dea_context *ctx, struct dea_grid *grid)
{
  int *number = dea_alloc(ctx, grid->node_count, sizeof *number);
  DEA_TRY_MEMORY(number != NULL);
  for (size_t e = 0; e < grid->element_count; e++) {
    for (int n = 0; n < dea_grid_nodes_of(grid, e); n++) {
      number[grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n]] = 1;
    }
  }
  size_t count = 0;
  for (size_t n = 0; n < grid->node_count; n++) {
    if (number[n] != 0) {
      memmove(grid->X + 3 * count, grid->X + 3 * n, 3 * sizeof(double));
      grid->column[count] = grid->column[n];
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

size_t dea_grid_columns(const struct dea_grid *grid)
{
  int last = -1;
  for (size_t n = 0; n < grid->node_count; n++) {
    last = grid->column[n] > last ? grid->column[n] : last;
  }
  return (size_t)(last + 1);
}

int dea_grid_nodes_of(const struct dea_grid *grid, size_t element)
{
  return (grid->order + 1) * (grid->order + 1) * grid->levels[element];
}

dea_status dea_grid_allocate(struct dea_context *ctx, int order, int order_z, size_t node_count,
                             size_t element_count, struct dea_grid **out)
{
  struct dea_grid *grid = dea_alloc(ctx, 1, sizeof *grid);
  *out = NULL;
  DEA_TRY_MEMORY(grid != NULL);
  struct dea_arena *memory = &grid->memory;
  memory->ctx = ctx;
  grid->order = order;
  grid->order_z = order_z;
  grid->node_count = node_count;
  grid->element_count = element_count;
  grid->X = dea_arena_alloc(memory, node_count, 3 * sizeof *grid->X);
  grid->column = dea_arena_alloc(memory, node_count, sizeof *grid->column);
  grid->nodes = dea_arena_alloc(memory, element_count, DEA_HEX_NODES_MAX * sizeof *grid->nodes);
  grid->region = dea_arena_alloc(memory, element_count, sizeof *grid->region);
  grid->ply = dea_arena_alloc(memory, element_count, sizeof *grid->ply);
  grid->levels = dea_arena_alloc(memory, element_count, sizeof *grid->levels);
  grid->kind = dea_arena_alloc(memory, element_count, sizeof *grid->kind);
  if (memory->failed) {
    dea_grid_destroy(ctx, grid);
    return DEA_E_MEMORY;
  }
  *out = grid;
  return DEA_OK;
}

dea_status dea_grid_extrude(struct dea_context *ctx, const struct dea_plane_mesh *mesh,
                            const struct dea_stack *stack, struct dea_grid **out)
{
  size_t through = 0, levels = 1;
  *out = NULL;
  for (size_t s = 0; s < stack->count; s++) {
    through += stack->plies[s].count;
    levels += is_beside(stack, s) ? 0 : ply_levels(&stack->plies[s]);
  }
  struct dea_grid *grid; // with room for all plies in all regions
  DEA_TRY(ctx, dea_grid_allocate(ctx, mesh->order, stack->plies[0].order_z,
                                 mesh->node_count * levels, mesh->quad_count * through, &grid));
  extrude(mesh, stack, grid);
  dea_status status = compact(ctx, grid);
  if (status != DEA_OK) {
    dea_grid_destroy(ctx, grid);
    return status;
  }
  *out = grid;
  return DEA_OK;
}

dea_status dea_grid_create(struct dea_context *ctx, int order, const struct dea_block *blocks,
                           size_t block_count, const struct dea_ply *plies, size_t ply_count,
                           bool (*present)(const void *self, int region, int ply), double bottom_m,
                           double length_m, struct dea_grid **out)
{
  const struct dea_stack stack = {
      .plies = plies, .count = ply_count, .present = present, .bottom_m = bottom_m};
  struct dea_plane_mesh *mesh;
  *out = NULL;
  DEA_TRY(ctx, dea_blocks_mesh(ctx, order, blocks, block_count, length_m, &mesh));
  dea_status status = dea_grid_extrude(ctx, mesh, &stack, out);
  dea_plane_mesh_destroy(ctx, mesh);
  return status;
}

dea_status dea_grid_add_nodes(struct dea_context *ctx, struct dea_grid *grid, size_t count,
                              const double *X_m, size_t *first)
{
  double *X = dea_arena_alloc(&grid->memory, grid->node_count + count, 3 * sizeof *X);
  int *column = dea_arena_alloc(&grid->memory, grid->node_count + count, sizeof *column);
  DEA_TRY(ctx, dea_arena_status(&grid->memory));
  memcpy(X, grid->X, 3 * grid->node_count * sizeof *X);
  memcpy(column, grid->column, grid->node_count * sizeof *column);
  for (size_t i = 0; i < count; i++) {
    column[grid->node_count + i] = -1;
  }
  grid->X = X;
  grid->column = column;
  memcpy(X + 3 * grid->node_count, X_m, 3 * count * sizeof *X);
  *first = grid->node_count;
  grid->node_count += count;
  return DEA_OK;
}

void dea_grid_destroy(struct dea_context *ctx, struct dea_grid *grid)
{
  if (grid != NULL) {
    dea_arena_free(&grid->memory);
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
