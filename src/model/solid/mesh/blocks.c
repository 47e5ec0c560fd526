/* Plane mesh of mapped blocks. */
#include "base/quadrature.h"
#include "model/solid/element/element.h"
#include "model/solid/mesh/places.h"
#include "model/solid/mesh/plane_mesh.h"

static void add_block(const struct dea_block *block, struct dea_places *places,
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
          quad[n * j + i] = dea_places_node(places, x);
        }
      }
      m->region[m->quad_count++] = block->region;
    }
  }
}

dea_status dea_blocks_mesh(struct dea_context *ctx, int order, const struct dea_block *blocks,
                           size_t block_count, double length_m, struct dea_plane_mesh **out)
{
  struct dea_places places;
  size_t quads = 0, per_quad = (size_t)((order + 1) * (order + 1));
  *out = NULL;
  for (size_t i = 0; i < block_count; i++) {
    quads += blocks[i].count_s * blocks[i].count_t;
  }
  struct dea_plane_mesh *mesh = dea_plane_mesh_create(ctx, order, quads * per_quad, quads);
  if (mesh == NULL ||
      dea_places_create(ctx, mesh->x, quads * per_quad, 1e-9 * length_m, &places) != DEA_OK) {
    dea_plane_mesh_destroy(ctx, mesh);
    return DEA_E_MEMORY;
  }
  mesh->quad_count = 0;
  for (size_t i = 0; i < block_count; i++) {
    add_block(&blocks[i], &places, mesh);
  }
  mesh->node_count = places.count;
  dea_places_release(ctx, &places);
  *out = mesh;
  return DEA_OK;
}
