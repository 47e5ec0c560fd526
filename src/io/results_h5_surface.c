#include "io/results_h5_surface.h"

#include <stdio.h>
#include <string.h>

enum { COUNT_MAX = 100000000, COMPONENTS_MAX = 9 };

static void write_blocks(struct h5 *h, hid_t group, const struct dea_field_mesh *mesh)
{
  hid_t blocks = dea_h5_group_create(h, group, "blocks");
  for (size_t b = 0; b < mesh->block_count; b++) {
    const struct dea_mesh_block *block = &mesh->blocks[b];
    char name[24];
    snprintf(name, sizeof name, "%02zu", b);
    hid_t at = dea_h5_group_create(h, blocks, name);
    dea_h5_write_int(h, at, "order", block->order);
    dea_h5_write_int(h, at, "order_z", block->order_z);
    dea_h5_write_int(h, at, "count", (long long)block->count);
    dea_h5_write_array(h, at, "nodes", H5T_NATIVE_INT, H5T_STD_I32LE,
                       block->count * (size_t)dea_mesh_block_nodes(block), block->nodes, "1",
                       "points of each element, first local axis fastest");
    dea_h5_close(at);
  }
  dea_h5_close(blocks);
}

static void write_field(struct h5 *h, hid_t fields, const struct dea_field_mesh *mesh,
                        const struct dea_mesh_field *field)
{
  dea_h5_write_array(h, fields, field->name, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE,
                     dea_mesh_field_count(mesh, field) * (size_t)field->components, field->values,
                     field->unit, field->meaning);
  hid_t set = dea_h5_array_open(h, fields, field->name);
  dea_h5_write_int(h, set, "components", field->components);
  dea_h5_write_int(h, set, "kind", field->kind);
  dea_h5_write_int(h, set, "of_cells", field->of_cells);
  dea_h5_close(set);
}

void dea_results_h5_write_surface(struct h5 *h, hid_t group,
                                  const struct dea_surface_record *record, hid_t same)
{
  const struct dea_field_mesh *mesh = record->mesh;
  dea_h5_write_int(h, group, "point", (long long)record->point);
  dea_h5_write_real(h, group, "voltage_V", record->voltage_V);
  dea_h5_write_int(h, group, "points", (long long)mesh->point_count);
  dea_h5_write_int(h, group, "fold", mesh->fold);
  dea_h5_write_real(h, group, "symmetry_angle", mesh->symmetry_angle);
  dea_h5_write_int(h, group, "fibres", mesh->fibres);
  if (same >= 0) {
    dea_h5_link(h, same, "X_m", group);
    dea_h5_link(h, same, "blocks", group);
  } else {
    dea_h5_write_array(h, group, "X_m", H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, 3 * mesh->point_count,
                       mesh->X, "m", "x y z of each point in the stretched flat film");
    write_blocks(h, group, mesh);
  }
  hid_t fields = dea_h5_group_create(h, group, "fields");
  for (size_t i = 0; i < mesh->field_count; i++) {
    write_field(h, fields, mesh, &mesh->fields[i]);
  }
  dea_h5_close(fields);
}

// Reading ----------------------------------------------------------------------------------------

static void get_block(struct h5 *h, hid_t group, struct dea_field_mesh *mesh)
{
  int order = (int)dea_h5_int(h, group, "order", 0, 1, DEA_MESH_ORDER_MAX);
  int order_z = (int)dea_h5_int(h, group, "order_z", 0, 0, DEA_MESH_ORDER_MAX);
  size_t count = (size_t)dea_h5_int(h, group, "count", 0, 0, COUNT_MAX);
  int *nodes;
  if (h->status == DEA_OK) {
    h->status = dea_field_mesh_add_block(h->ctx, mesh, order, order_z, count, &nodes);
  }
  if (h->status != DEA_OK) {
    return;
  }
  count *= (size_t)dea_mesh_block_nodes(&mesh->blocks[mesh->block_count - 1]);
  dea_h5_get_array(h, group, "nodes", H5T_NATIVE_INT, count, nodes);
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    if (nodes[i] < 0 || (size_t)nodes[i] >= mesh->point_count) {
      h->status =
          dea_fail(h->ctx, DEA_E_IO, "%s is damaged: a surface has no point %d", h->path, nodes[i]);
    }
  }
}

static void get_field(struct h5 *h, hid_t fields, const char *name, struct dea_field_mesh *mesh)
{
  struct dea_mesh_field field = {.components = 1};
  hid_t set = dea_h5_array_open(h, fields, name);
  snprintf(field.name, sizeof field.name, "%s", name);
  dea_h5_get_text(h, set, "unit", field.unit, sizeof field.unit);
  dea_h5_get_text(h, set, "meaning", field.meaning, sizeof field.meaning);
  field.components = (int)dea_h5_int(h, set, "components", 0, 1, COMPONENTS_MAX);
  field.kind = (enum dea_mesh_kind)dea_h5_int(h, set, "kind", 0, DEA_MESH_VALUES, DEA_MESH_AXIS);
  field.of_cells = dea_h5_int(h, set, "of_cells", 0, 0, 1) != 0;
  dea_h5_close(set);
  double *values;
  if (h->status == DEA_OK) {
    h->status = dea_field_mesh_add(h->ctx, mesh, &field, &values);
  }
  if (h->status == DEA_OK) {
    dea_h5_get_array(h, fields, name, H5T_NATIVE_DOUBLE,
                     dea_mesh_field_count(mesh, &field) * (size_t)field.components, values);
  }
}

/* Calls a reader for each member of a subgroup. */
static void get_each(struct h5 *h, hid_t group, const char *name, bool blocks,
                     struct dea_field_mesh *mesh)
{
  hid_t parent = dea_h5_group_open(h, group, name);
  size_t count = dea_h5_link_count(h, parent);
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    char member[32];
    dea_h5_link_name(h, parent, i, member, sizeof member);
    if (blocks) {
      hid_t block = dea_h5_group_open(h, parent, member);
      get_block(h, block, mesh);
      dea_h5_close(block);
    } else {
      get_field(h, parent, member, mesh);
    }
  }
  dea_h5_close(parent);
}

void dea_results_h5_get_surface(struct h5 *h, hid_t group, const char *model,
                                struct dea_result *result)
{
  struct dea_field_mesh *mesh = NULL;
  double voltage_V = dea_h5_get_real(h, group, "voltage_V");
  size_t points = (size_t)dea_h5_int(h, group, "points", 0, 0, COUNT_MAX);
  size_t point = result->surface_count; // older files do not say it: one a point
  if (dea_h5_has_attribute(h, group, "point")) {
    point = (size_t)dea_h5_int(h, group, "point", 0, 0, COUNT_MAX);
  }
  int fold = (int)dea_h5_int(h, group, "fold", 0, 0, 1000);
  int fibres = (int)dea_h5_int(h, group, "fibres", 0, 0, 1000);
  if (h->status == DEA_OK) {
    h->status = dea_field_mesh_create(h->ctx, points, &mesh);
  }
  if (h->status != DEA_OK) {
    return;
  }
  mesh->fold = fold;
  mesh->fibres = fibres;
  mesh->symmetry_angle = dea_h5_get_real(h, group, "symmetry_angle");
  dea_h5_get_array(h, group, "X_m", H5T_NATIVE_DOUBLE, 3 * points, mesh->X);
  get_each(h, group, "blocks", true, mesh);
  get_each(h, group, "fields", false, mesh);
  if (h->status == DEA_OK) {
    h->status = dea_result_add_surface(h->ctx, result, model, point, voltage_V, mesh);
  } else {
    dea_field_mesh_destroy(h->ctx, mesh);
  }
}
