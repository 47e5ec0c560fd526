#include "result/field_mesh.h"

#include <string.h>

dea_status dea_field_mesh_create(struct dea_context *ctx, size_t point_count,
                                 struct dea_field_mesh **out)
{
  *out = NULL;
  struct dea_field_mesh *mesh = dea_alloc(ctx, 1, sizeof *mesh);
  DEA_TRY_MEMORY(mesh != NULL);
  mesh->point_count = point_count;
  mesh->X = dea_alloc(ctx, point_count, 3 * sizeof *mesh->X);
  if (mesh->X == NULL) {
    dea_free(ctx, mesh);
    return DEA_E_MEMORY;
  }
  *out = mesh;
  return DEA_OK;
}

void dea_field_mesh_destroy(struct dea_context *ctx, struct dea_field_mesh *mesh)
{
  if (mesh == NULL) {
    return;
  }
  for (size_t i = 0; i < mesh->block_count; i++) {
    dea_free(ctx, mesh->blocks[i].nodes);
  }
  for (size_t i = 0; i < mesh->field_count; i++) {
    dea_free(ctx, mesh->fields[i].values);
  }
  dea_free(ctx, mesh->X);
  dea_free(ctx, mesh);
}

dea_status dea_field_mesh_finish(struct dea_context *ctx, dea_status made,
                                 struct dea_field_mesh **mesh)
{
  if (made != DEA_OK) {
    dea_field_mesh_destroy(ctx, *mesh);
    *mesh = NULL;
    return dea_fail_chain(ctx, made, __func__, __FILE__, __LINE__);
  }
  return DEA_OK;
}

int dea_mesh_block_nodes(const struct dea_mesh_block *block)
{
  return (block->order + 1) * (block->order + 1) * (block->order_z + 1);
}

dea_status dea_field_mesh_add_block(struct dea_context *ctx, struct dea_field_mesh *mesh, int order,
                                    int order_z, size_t count, int **nodes)
{
  const struct dea_mesh_block block = {.order = order, .order_z = order_z, .count = count};
  *nodes = NULL;
  if (mesh->block_count == DEA_MESH_BLOCKS_MAX || mesh->field_count > 0 || order < 1 ||
      order > DEA_MESH_ORDER_MAX || order_z < 0 || order_z > DEA_MESH_ORDER_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a mesh of fields takes no such block");
  }
  *nodes = dea_alloc(ctx, count * (size_t)dea_mesh_block_nodes(&block), sizeof **nodes);
  DEA_TRY_MEMORY(*nodes != NULL);
  mesh->blocks[mesh->block_count] = block;
  mesh->blocks[mesh->block_count++].nodes = *nodes;
  mesh->cell_count += count;
  return DEA_OK;
}

size_t dea_mesh_field_count(const struct dea_field_mesh *mesh, const struct dea_mesh_field *field)
{
  return field->of_cells ? mesh->cell_count : mesh->point_count;
}

dea_status dea_field_mesh_add(struct dea_context *ctx, struct dea_field_mesh *mesh,
                              const struct dea_mesh_field *field, double **values)
{
  *values = NULL;
  if (mesh->field_count == DEA_MESH_FIELDS_MAX || field->components < 1 ||
      (field->kind != DEA_MESH_VALUES && field->components != 3)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a mesh of fields takes no field '%.60s'", field->name);
  }
  *values = dea_alloc(ctx, dea_mesh_field_count(mesh, field) * (size_t)field->components,
                      sizeof **values);
  DEA_TRY_MEMORY(*values != NULL);
  mesh->fields[mesh->field_count] = *field;
  mesh->fields[mesh->field_count++].values = *values;
  return DEA_OK;
}

const struct dea_mesh_field *dea_field_mesh_find(const struct dea_field_mesh *mesh,
                                                 const char *name)
{
  for (size_t i = 0; i < mesh->field_count; i++) {
    if (strcmp(mesh->fields[i].name, name) == 0) {
      return &mesh->fields[i];
    }
  }
  return NULL;
}
