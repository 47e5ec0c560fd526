#include "io/results_h5_surface.h"

#include <stdio.h>
#include <string.h>

enum { COUNT_MAX = 100000000, COMPONENTS_MAX = 9 };

static void exchange_nodes(struct h5 *h, hid_t group, const struct dea_field_mesh *mesh,
                           const struct dea_mesh_block *block)
{
  const size_t count = block->count * (size_t)dea_mesh_block_nodes(block);
  dea_h5_array(h, group, "nodes", H5T_NATIVE_INT, H5T_STD_I32LE, count, block->nodes, "1",
               "points of each element, first local axis fastest");
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    if (block->nodes[i] < 0 || (size_t)block->nodes[i] >= mesh->point_count) {
      h->status = dea_fail(h->ctx, DEA_E_IO, "%s is damaged: a surface has no point %d", h->path,
                           block->nodes[i]);
    }
  }
}

/* blocks/00, 01, ... */
static void exchange_blocks(struct h5 *h, hid_t parent, struct dea_field_mesh *mesh)
{
  hid_t blocks = dea_h5_group(h, parent, "blocks");
  const size_t count = h->reading ? dea_h5_link_count(h, blocks) : mesh->block_count;
  for (size_t b = 0; b < count && h->status == DEA_OK; b++) {
    struct dea_mesh_block block = {0};
    char name[24];
    int *nodes;
    snprintf(name, sizeof name, "%02zu", b);
    if (!h->reading) {
      block = mesh->blocks[b];
    }
    hid_t group = dea_h5_group(h, blocks, name);
    block.order = (int)dea_h5_int(h, group, "order", block.order, 1, DEA_MESH_ORDER_MAX);
    block.order_z = (int)dea_h5_int(h, group, "order_z", block.order_z, 0, DEA_MESH_ORDER_MAX);
    block.count = (size_t)dea_h5_int(h, group, "count", (long long)block.count, 0, COUNT_MAX);
    if (h->reading && h->status == DEA_OK) {
      h->status =
          dea_field_mesh_add_block(h->ctx, mesh, block.order, block.order_z, block.count, &nodes);
    }
    if (h->status == DEA_OK) {
      exchange_nodes(h, group, mesh, &mesh->blocks[b]);
    }
    dea_h5_close(group);
  }
  dea_h5_close(blocks);
}

static void write_field(struct h5 *h, hid_t fields, const struct dea_field_mesh *mesh,
                        struct dea_mesh_field *field)
{
  dea_h5_write_array(h, fields, field->name, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE,
                     dea_mesh_field_count(mesh, field) * (size_t)field->components, field->values,
                     field->unit, field->meaning);
}

static void read_field(struct h5 *h, hid_t fields, struct dea_field_mesh *mesh,
                       const struct dea_mesh_field *field)
{
  double *values;
  if (h->status == DEA_OK) {
    h->status = dea_field_mesh_add(h->ctx, mesh, field, &values);
  }
  if (h->status == DEA_OK) {
    dea_h5_get_array(h, fields, field->name, H5T_NATIVE_DOUBLE,
                     dea_mesh_field_count(mesh, field) * (size_t)field->components, values);
  }
}

static void exchange_fields(struct h5 *h, hid_t parent, struct dea_field_mesh *mesh)
{
  hid_t fields = dea_h5_group(h, parent, "fields");
  const size_t count = h->reading ? dea_h5_link_count(h, fields) : mesh->field_count;
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    struct dea_mesh_field field = {.components = 1};
    if (h->reading) {
      dea_h5_link_name(h, fields, i, field.name, sizeof field.name);
    } else {
      field = mesh->fields[i];
      write_field(h, fields, mesh, &field);
    }
    hid_t set = dea_h5_array_open(h, fields, field.name);
    if (h->reading) { // else they are those of the array
      dea_h5_get_text(h, set, "unit", field.unit, sizeof field.unit);
      dea_h5_get_text(h, set, "meaning", field.meaning, sizeof field.meaning);
    }
    field.components = (int)dea_h5_int(h, set, "components", field.components, 1, COMPONENTS_MAX);
    field.kind = (enum dea_mesh_kind)dea_h5_int(h, set, "kind", (long long)field.kind,
                                                DEA_MESH_VALUES, DEA_MESH_AXIS);
    field.of_cells = dea_h5_int(h, set, "of_cells", field.of_cells, 0, 1) != 0;
    dea_h5_close(set);
    if (h->reading) {
      read_field(h, fields, mesh, &field);
    }
  }
  dea_h5_close(fields);
}

void dea_results_h5_surface(struct h5 *h, hid_t group, hid_t same, struct dea_result *result,
                            struct dea_surface_record *record)
{
  struct dea_field_mesh none = {0}, *mesh = h->reading ? &none : record->mesh;
  if (!h->reading || dea_h5_has_attribute(h, group, "point")) { // older files: one a point
    record->point = (size_t)dea_h5_int(h, group, "point", (long long)record->point, 0, COUNT_MAX);
  }
  record->voltage_V = dea_h5_real(h, group, "voltage_V", record->voltage_V);
  const size_t count =
      (size_t)dea_h5_int(h, group, "points", (long long)mesh->point_count, 0, COUNT_MAX);
  const int fold = (int)dea_h5_int(h, group, "fold", mesh->fold, 0, 1000);
  const double angle = dea_h5_real(h, group, "symmetry_angle", mesh->symmetry_angle);
  const int fibres = (int)dea_h5_int(h, group, "fibres", mesh->fibres, 0, 1000);
  if (h->reading && h->status == DEA_OK) {
    h->status = dea_field_mesh_create(h->ctx, count, &mesh);
  }
  if (h->status != DEA_OK) {
    return;
  }
  mesh->fold = fold;
  mesh->fibres = fibres;
  mesh->symmetry_angle = angle;
  if (same >= 0) {
    dea_h5_link(h, same, "X_m", group);
    dea_h5_link(h, same, "blocks", group);
  } else {
    dea_h5_array(h, group, "X_m", H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, 3 * count, mesh->X, "m",
                 "x y z of each point in the stretched flat film");
    exchange_blocks(h, group, mesh);
  }
  exchange_fields(h, group, mesh);
  if (h->reading && h->status == DEA_OK) {
    h->status = dea_result_add_surface(h->ctx, result, record->model, record->point,
                                       record->voltage_V, mesh);
  } else if (h->reading) {
    dea_field_mesh_destroy(h->ctx, mesh);
  }
}
