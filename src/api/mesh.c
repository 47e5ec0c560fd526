/* Meshes with fields in their public form. */
#include "api/door.h"

#include "output/copies.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

void door_mesh_free(struct dea_context *ctx, struct door_mesh *mesh)
{
  if (mesh != NULL) {
    door_mesh_free(ctx, mesh->whole);
    dea_field_mesh_destroy(ctx, mesh->owned);
    dea_free(ctx, mesh);
  }
}

static void show_fields(struct door_mesh *mesh)
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

dea_status door_mesh_make(struct dea_context *ctx, const char *name, double voltage_V,
                          struct dea_field_mesh *inner, bool own, struct door_mesh **out)
{
  struct door_mesh *mesh = dea_alloc(ctx, 1, sizeof *mesh);
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

/* Nodes of the copies of an element. In a mirrored copy the first axis is turned round, so that the
 * element does not stand inside out. */
static void copy_nodes(const struct dea_mesh_block *block, size_t copies, size_t point_count,
                       int *out)
{
  size_t row = (size_t)block->order + 1, nodes = (size_t)dea_mesh_block_nodes(block);
  for (size_t c = 0; c < copies; c++) {
    for (size_t i = 0; i < block->count * nodes; i++) {
      size_t along = i % row;
      size_t from = c % 2 == 1 ? i - along + (row - 1 - along) : i;
      out[c * block->count * nodes + i] = block->nodes[from] + (int)(c * point_count);
    }
  }
}

/* Rows of a field in a copy. */
static void copy_values(const struct dea_mesh_field *field, const struct dea_copy *copy,
                        const double *in, size_t rows, double *out)
{
  size_t n = (size_t)field->components;
  for (size_t i = 0; i < rows; i++) {
    if (field->kind == DEA_MESH_VALUES) {
      memcpy(out + i * n, in + i * n, n * sizeof *out);
    } else {
      dea_copy_move(copy, in + 3 * i, out + 3 * i);
    }
  }
}

static void copy_field(const struct dea_field_mesh *mesh, const struct dea_mesh_field *field,
                       size_t copies, double *out)
{
  size_t n = (size_t)field->components;
  for (size_t c = 0; c < copies; c++) {
    struct dea_copy copy = dea_copy_at(mesh, c);
    if (!field->of_cells) {
      copy_values(field, &copy, field->values, mesh->point_count, out + c * mesh->point_count * n);
      continue;
    }
    size_t before = 0; // cells of the blocks so far
    for (size_t b = 0; b < mesh->block_count; b++) {
      size_t count = mesh->blocks[b].count;
      copy_values(field, &copy, field->values + before * n, count,
                  out + (before * copies + c * count) * n);
      before += count;
    }
  }
}

static dea_status fill_whole(struct dea_context *ctx, const struct dea_field_mesh *mesh,
                             size_t copies, struct dea_field_mesh *out)
{
  for (size_t c = 0; c < copies; c++) {
    struct dea_copy copy = dea_copy_at(mesh, c);
    for (size_t i = 0; i < mesh->point_count; i++) {
      dea_copy_move(&copy, mesh->X + 3 * i, out->X + 3 * (c * mesh->point_count + i));
    }
  }
  for (size_t b = 0; b < mesh->block_count; b++) {
    const struct dea_mesh_block *block = &mesh->blocks[b];
    int *nodes;
    DEA_TRY(ctx, dea_field_mesh_add_block(ctx, out, block->order, block->order_z,
                                          copies * block->count, &nodes));
    copy_nodes(block, copies, mesh->point_count, nodes);
  }
  for (size_t f = 0; f < mesh->field_count; f++) {
    double *values;
    DEA_TRY(ctx, dea_field_mesh_add(ctx, out, &mesh->fields[f], &values));
    copy_field(mesh, &mesh->fields[f], copies, values);
  }
  out->fibres = mesh->fibres;
  return DEA_OK;
}

/* All mirrored copies of a part as one mesh; *out owned by the caller, NULL on failure. */
static dea_status make_whole(struct dea_context *ctx, const struct dea_field_mesh *mesh,
                             struct dea_field_mesh **out)
{
  size_t copies = dea_copy_count(mesh);
  *out = NULL;
  if (mesh->point_count > (size_t)INT_MAX / copies) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "the whole mesh has too many points");
  }
  DEA_TRY(ctx, dea_field_mesh_create(ctx, copies * mesh->point_count, out));
  return dea_field_mesh_finish(ctx, fill_whole(ctx, mesh, copies, *out), out);
}

const dea_mesh *dea_result_mesh_at(const dea_result *result, size_t index)
{
  return index < result->mesh_count ? &result->meshes[index]->shown : NULL;
}

dea_status dea_result_mesh(dea_context *ctx, dea_result *result, const char *name, int whole,
                           const dea_mesh **out)
{
  struct door_mesh *mesh = NULL;
  *out = NULL;
  DEA_TRY(ctx->inner, door_check_owner(ctx, result->ctx, "result"));
  for (size_t i = 0; i < result->mesh_count; i++) {
    mesh = strcmp(result->meshes[i]->name, name) == 0 ? result->meshes[i] : mesh;
  }
  if (mesh == NULL) {
    return door_unknown(ctx, "mesh", name, NULL, 0);
  }
  if (whole != 0 && mesh->inner->fold > 0) {
    if (mesh->whole == NULL) {
      struct dea_field_mesh *all;
      DEA_TRY(ctx->inner, make_whole(ctx->inner, mesh->inner, &all));
      DEA_TRY(ctx->inner, door_mesh_make(ctx->inner, mesh->name, mesh->shown.voltage_V, all, true,
                                         &mesh->whole));
    }
    mesh = mesh->whole;
  }
  *out = &mesh->shown;
  return DEA_OK;
}
