#include "model/solid/mesh/plane_mesh.h"

#include "base/context.h"

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

static void free_names(struct dea_context *ctx, char **names, size_t count)
{
  for (size_t i = 0; i < count && names != NULL; i++) {
    dea_free(ctx, names[i]);
  }
  dea_free(ctx, names);
}

void dea_plane_mesh_forget_names(struct dea_context *ctx, struct dea_plane_mesh *mesh)
{
  free_names(ctx, mesh->group, mesh->group_count);
  free_names(ctx, mesh->curve, mesh->curve_count);
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

static dea_status add_name(struct dea_context *ctx, char ***names, size_t *count, const char *name)
{
  char **moved = dea_resize(ctx, *names, *count + 1, sizeof *moved);
  DEA_TRY_MEMORY(moved != NULL);
  *names = moved;
  moved[*count] = dea_copy_text(ctx, name, strlen(name));
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

static size_t find(char *const names[], size_t count, const char *name)
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
