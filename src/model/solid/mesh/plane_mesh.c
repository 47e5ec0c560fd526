#include "model/solid/mesh/plane_mesh.h"

#include "base/quadrature.h"
#include "model/solid/mesh/grid.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

struct dea_plane_mesh *dea_plane_mesh_create(struct dea_context *ctx, int order, size_t node_count,
                                             size_t quad_count)
{
  size_t per_quad = (size_t)((order + 1) * (order + 1));
  struct dea_plane_mesh *mesh = dea_alloc(ctx, 1, sizeof *mesh);
  if (mesh == NULL) {
    return NULL;
  }
  mesh->order = order;
  mesh->node_count = node_count;
  mesh->quad_count = quad_count;
  mesh->x = dea_alloc(ctx, node_count, 2 * sizeof *mesh->x);
  mesh->quads = dea_alloc(ctx, quad_count * per_quad, sizeof *mesh->quads);
  mesh->region = dea_alloc(ctx, quad_count, sizeof *mesh->region);
  if (mesh->x == NULL || mesh->quads == NULL || mesh->region == NULL) {
    dea_plane_mesh_destroy(ctx, mesh);
    return NULL;
  }
  return mesh;
}

dea_status dea_plane_mesh_set_nodes(struct dea_context *ctx, struct dea_plane_mesh *mesh,
                                    struct dea_point_map *nodes)
{
  const dea_status status = nodes->failed ? DEA_E_MEMORY : DEA_OK;
  if (status == DEA_OK) {
    dea_free(ctx, mesh->x);
    mesh->x = &nodes->point[0][0];
    mesh->node_count = nodes->count;
    nodes->point = NULL;
  }
  dea_point_map_free(nodes);
  return status;
}

void dea_plane_mesh_forget_names(struct dea_context *ctx, struct dea_plane_mesh *mesh)
{
  dea_free(ctx, mesh->group);
  dea_free(ctx, mesh->curve);
  dea_free(ctx, mesh->within);
  dea_free(ctx, mesh->edges);
  dea_free(ctx, mesh->edge_curve);
  mesh->group = mesh->curve = NULL;
  mesh->within = NULL;
  mesh->edges = mesh->edge_curve = NULL;
  mesh->group_count = mesh->region_count = mesh->curve_count = mesh->edge_count = 0;
}

void dea_plane_mesh_destroy(struct dea_context *ctx, struct dea_plane_mesh *mesh)
{
  if (mesh != NULL) {
    dea_plane_mesh_forget_names(ctx, mesh);
    dea_free(ctx, mesh->x);
    dea_free(ctx, mesh->quads);
    dea_free(ctx, mesh->region);
    dea_free(ctx, mesh);
  }
}

static dea_status add_name(struct dea_context *ctx, const char ***names, size_t *count,
                           const char *name)
{
  const char **moved = dea_resize(ctx, *names, *count + 1, sizeof *moved);
  DEA_TRY_MEMORY(moved != NULL);
  *names = moved;
  moved[*count] = dea_intern(ctx, name);
  DEA_TRY_MEMORY(moved[*count] != NULL);
  (*count)++;
  return DEA_OK;
}

dea_status dea_plane_mesh_add_group(struct dea_context *ctx, struct dea_plane_mesh *mesh,
                                    const char *name)
{
  return add_name(ctx, &mesh->group, &mesh->group_count, name);
}

dea_status dea_plane_mesh_add_curve(struct dea_context *ctx, struct dea_plane_mesh *mesh,
                                    const char *name)
{
  return add_name(ctx, &mesh->curve, &mesh->curve_count, name);
}

dea_status dea_plane_mesh_region(struct dea_context *ctx, struct dea_plane_mesh *mesh,
                                 const unsigned char *within, int *out)
{
  size_t n = mesh->group_count, k = 0;
  while (k < mesh->region_count && memcmp(mesh->within + k * n, within, n) != 0) {
    k++;
  }
  if (k == mesh->region_count) {
    unsigned char *moved = dea_resize(ctx, mesh->within, k + 1, n);
    DEA_TRY_MEMORY(moved != NULL);
    mesh->within = moved;
    memcpy(moved + k * n, within, n);
    mesh->region_count++;
  }
  *out = (int)k;
  return DEA_OK;
}

static size_t find(const char *const names[], size_t count, const char *name)
{
  for (size_t i = 0; i < count; i++) {
    if (strcmp(names[i], name) == 0) {
      return i;
    }
  }
  return SIZE_MAX;
}

size_t dea_plane_mesh_group(const struct dea_plane_mesh *mesh, const char *name)
{
  return find(mesh->group, mesh->group_count, name);
}

size_t dea_plane_mesh_curve(const struct dea_plane_mesh *mesh, const char *name)
{
  return find(mesh->curve, mesh->curve_count, name);
}

void dea_plane_mesh_middle(const struct dea_plane_mesh *mesh, size_t e, double out[2])
{
  size_t per_quad = (size_t)((mesh->order + 1) * (mesh->order + 1));
  out[0] = out[1] = 0;
  for (size_t n = 0; n < per_quad; n++) {
    const double *x = mesh->x + 2 * mesh->quads[e * per_quad + n];
    out[0] += x[0] / (double)per_quad;
    out[1] += x[1] / (double)per_quad;
  }
}

// Mapped blocks -----------------------------------------------------------------------------------

static void add_block(const struct dea_block *block, struct dea_point_map *nodes,
                      struct dea_plane_mesh *m)
{
  double at[DEA_HEX_ORDER_MAX + 1];
  int n = m->order + 1;
  dea_lobatto_nodes((size_t)m->order, at);
  for (size_t t = 0; t < block->count_t; t++) {
    for (size_t s = 0; s < block->count_s; s++) {
      int *quad = m->quads + m->quad_count * (size_t)(n * n);
      for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
          double x[2], fs = 0.5 * (1 + at[i]), ft = 0.5 * (1 + at[j]);
          block->map(block->self, block->cuts_s[s] + fs * (block->cuts_s[s + 1] - block->cuts_s[s]),
                     block->cuts_t[t] + ft * (block->cuts_t[t + 1] - block->cuts_t[t]), x);
          quad[n * j + i] = (int)dea_point_map_add(nodes, x);
        }
      }
      m->region[m->quad_count++] = block->region;
    }
  }
}

dea_status dea_blocks_mesh(struct dea_context *ctx, int order, const struct dea_block *blocks,
                           size_t block_count, double length_m, struct dea_plane_mesh **out)
{
  struct dea_point_map nodes = {.ctx = ctx, .tolerance_m = 1e-9 * length_m};
  size_t quads = 0;
  *out = NULL;
  for (size_t i = 0; i < block_count; i++) {
    quads += blocks[i].count_s * blocks[i].count_t;
  }
  struct dea_plane_mesh *mesh = dea_plane_mesh_create(ctx, order, 0, quads);
  DEA_TRY_MEMORY(mesh != NULL);
  mesh->quad_count = 0;
  for (size_t i = 0; i < block_count; i++) {
    add_block(&blocks[i], &nodes, mesh);
  }
  DEA_TRY_ELSE(ctx, dea_plane_mesh_set_nodes(ctx, mesh, &nodes), dea_plane_mesh_destroy(ctx, mesh));
  *out = mesh;
  return DEA_OK;
}

// Quality -----------------------------------------------------------------------------------------

/* Slopes of the one-dimensional basis at its own nodes: [at][node]. */
struct slopes {
  double at[DEA_HEX_ORDER_MAX + 1][DEA_HEX_ORDER_MAX + 1];
};

static void slopes_at_nodes(int order, struct slopes *slope)
{
  double nodes[DEA_HEX_ORDER_MAX + 1], value[DEA_HEX_ORDER_MAX + 1];
  dea_lobatto_nodes((size_t)order, nodes);
  for (int i = 0; i <= order; i++) {
    dea_lagrange((size_t)order + 1, nodes, nodes[i], value, slope->at[i]);
  }
}

/* Smallest Jacobian of a quadrilateral over the mean one. The nodes' places are `stride` apart. */
static double quality_of(int order, const struct slopes *slope, const int *nodes, const double *X,
                         int stride)
{
  int per = order + 1;
  double least = INFINITY, sum = 0;
  for (int at = 0; at < per * per; at++) {
    int i = at % per, j = at / per;
    double map[2][2] = {{0, 0}, {0, 0}}; // by the local axes
    for (int k = 0; k < per; k++) {
      const double *along = X + stride * nodes[per * j + k];
      const double *up = X + stride * nodes[per * k + i];
      for (int c = 0; c < 2; c++) {
        map[0][c] += slope->at[i][k] * along[c];
        map[1][c] += slope->at[j][k] * up[c];
      }
    }
    double area = map[0][0] * map[1][1] - map[0][1] * map[1][0];
    least = fmin(least, area);
    sum += area;
  }
  return least / fabs(sum / (per * per));
}

double dea_grid_smallest_jacobian(const struct dea_grid *grid)
{
  struct slopes slope;
  double smallest = INFINITY;
  slopes_at_nodes(grid->order, &slope);
  for (size_t e = 0; e < grid->element_count; e++) { // the lower face comes first
    const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
    smallest = fmin(smallest, quality_of(grid->order, &slope, nodes, grid->X, 3));
  }
  return smallest;
}

double dea_plane_mesh_smallest_jacobian(const struct dea_plane_mesh *mesh, size_t *worst)
{
  struct slopes slope;
  double smallest = INFINITY;
  size_t per_quad = (size_t)((mesh->order + 1) * (mesh->order + 1));
  slopes_at_nodes(mesh->order, &slope);
  for (size_t e = 0; e < mesh->quad_count; e++) {
    double quality = quality_of(mesh->order, &slope, mesh->quads + e * per_quad, mesh->x, 2);
    if (!(quality >= smallest)) {
      smallest = quality;
      if (worst != NULL) {
        *worst = e;
      }
    }
  }
  return smallest;
}
