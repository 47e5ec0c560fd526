/* Meshes with fields in their public form. */
#include "api/api.h"

#include "result/field_mesh.h"

#include <stdio.h>
#include <string.h>

void api_mesh_free(struct dea_context *ctx, struct api_mesh *mesh)
{
  if (mesh != NULL) {
    api_mesh_free(ctx, mesh->whole);
    dea_field_mesh_destroy(ctx, mesh->owned);
    dea_free(ctx, mesh);
  }
}

static void show_fields(struct api_mesh *mesh)
{
  const struct dea_field_mesh *inner = mesh->inner;
  for (size_t i = 0; i < inner->field_count; i++) {
    const struct dea_mesh_field *field = &inner->fields[i];
    mesh->arrays[i] =
        (dea_array){.name = field->name,
                    .unit = field->unit,
                    .meaning = field->meaning,
                    .rank = 2,
                    .shape = {dea_mesh_field_count(inner, field), (size_t)field->components, 1},
                    .data = field->values};
    mesh->fields[i] = (dea_field){&mesh->arrays[i], field->kind, field->of_cells};
    mesh->fields_at[i] = &mesh->fields[i];
  }
}

dea_status api_mesh_create(struct dea_context *ctx, const char *name, double voltage_V,
                           struct dea_field_mesh *inner, bool own, struct api_mesh **out)
{
  struct api_mesh *mesh = dea_alloc(ctx, 1, sizeof *mesh);
  *out = mesh;
  if (mesh == NULL) {
    if (own) {
      dea_field_mesh_destroy(ctx, inner);
    }
    return DEA_E_MEMORY;
  }
  mesh->inner = inner;
  mesh->owned = own ? inner : NULL;
  snprintf(mesh->name, sizeof mesh->name, "%s", name);
  for (size_t i = 0; i < inner->block_count; i++) {
    const struct dea_mesh_block *block = &inner->blocks[i];
    mesh->cells[i] = (dea_cells){block->order, block->order_z, block->count,
                                 (size_t)dea_mesh_block_nodes(block), block->nodes};
    mesh->cells_at[i] = &mesh->cells[i];
  }
  show_fields(mesh);
  mesh->shown = (dea_mesh){.name = mesh->name,
                           .voltage_V = voltage_V,
                           .point_count = inner->point_count,
                           .points_m = inner->X,
                           .cells_count = inner->block_count,
                           .cells = mesh->cells_at,
                           .field_count = inner->field_count,
                           .fields = mesh->fields_at,
                           .fold = inner->fold,
                           .symmetry_angle_rad = inner->symmetry_angle};
  return DEA_OK;
}

const dea_mesh *dea_result_mesh_at(const dea_result *result, size_t index)
{
  return index < result->mesh_count ? &result->meshes[index]->shown : NULL;
}

dea_status dea_result_mesh(dea_context *ctx, dea_result *result, const char *name, int whole,
                           const dea_mesh **out)
{
  struct api_mesh *mesh = NULL;
  *out = NULL;
  DEA_TRY(ctx->inner, api_check_owner(ctx, result->ctx, "result"));
  for (size_t i = 0; i < result->mesh_count; i++) {
    mesh = strcmp(result->meshes[i]->name, name) == 0 ? result->meshes[i] : mesh;
  }
  if (mesh == NULL) {
    return dea_unknown_name(ctx->inner, "mesh", name, NULL, 0);
  }
  if (whole != 0 && mesh->inner->fold > 0) {
    if (mesh->whole == NULL) {
      struct dea_field_mesh *all;
      DEA_TRY(ctx->inner, dea_field_mesh_whole(ctx->inner, mesh->inner, &all));
      DEA_TRY(ctx->inner, api_mesh_create(ctx->inner, mesh->name, mesh->shown.voltage_V, all, true,
                                          &mesh->whole));
    }
    mesh = mesh->whole;
  }
  *out = &mesh->shown;
  return DEA_OK;
}
