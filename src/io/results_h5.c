/* results.h5: each function here reads and writes one thing (see "both ways" in base/h5.h). */
#include "io/results_h5.h"

#include "base/h5.h"
#include "base/write_file.h"
#include "io/csv.h"
#include "io/results_h5_tables.h"
#include "result/columns.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT_MAX = 10000000, PLACES_MAX = 100000000, COMPONENTS_MAX = 9, KIND_SIZE = 16 };

/* parent/MODEL/NAME, the index-th of its kind in a result. */
struct entry {
  char model[DEA_NAME_SIZE], name[DEA_NAME_SIZE];
  long long index;
};

// Points ------------------------------------------------------------------------------------------

/* New points with what monitors show where the group has columns of them. */
static struct dea_load_point *create_points(struct h5 *h, hid_t group, struct dea_arena *memory,
                                            size_t count)
{
  const int all = dea_column_count(h->ctx);
  memory->ctx = h->ctx;
  struct dea_load_point *points = dea_alloc(h->ctx, count, sizeof *points);
  int *columns = dea_arena_alloc(memory, (size_t)all, sizeof *columns);
  size_t found = 0;
  for (int c = DEA_LOAD_POINT_COLUMNS; columns != NULL && c < all; c++) {
    if (dea_h5_has(h, group, dea_column_at(h->ctx, c)->key)) {
      columns[found++] = c;
    }
  }
  for (size_t i = 0; points != NULL && i < count; i++) {
    points[i] = dea_load_point_empty();
    points[i].monitors = found > 0 ? dea_monitor_values_create(memory, columns, found) : NULL;
  }
  h->status = points == NULL ? DEA_E_MEMORY : dea_arena_status(memory);
  return points;
}

static void set_state(struct dea_load_point *point, const char *key, int value)
{
  if (strcmp(key, "stable") == 0) {
    point->stable = value != 0;
  } else if (strcmp(key, "unstable_modes") == 0) {
    point->unstable_modes = value;
  } else if (strcmp(key, "flags") == 0) { // "trusted" follows from them
    point->own_flags = (unsigned)value;
  }
}

/* What of points is no quantity; files of older versions have no flags. */
static void exchange_states(struct h5 *h, hid_t group, struct dea_load_point *points, size_t count,
                            int *whole)
{
  for (int k = 0; k < DEA_POINT_STATES && h->status == DEA_OK; k++) {
    const struct dea_point_state *state = &dea_point_states[k];
    if (h->reading && k > 1 && !dea_h5_has(h, group, state->key)) {
      continue;
    }
    for (size_t i = 0; i < count; i++) {
      whole[i] = state->get(&points[i]);
    }
    dea_h5_array(h, group, state->key, H5T_NATIVE_INT, k == 0 ? H5T_STD_U8LE : H5T_STD_I32LE, count,
                 whole, "1", state->meaning);
    for (size_t i = 0; i < count && h->reading; i++) {
      set_state(&points[i], state->key, whole[i]);
    }
  }
}

/* *points: when read owned by the caller, NULL for none; memory: of what their monitors show. */
static void exchange_points(struct h5 *h, hid_t group, struct dea_arena *memory,
                            struct dea_load_point **points, size_t *count)
{
  *count = (size_t)dea_h5_int(h, group, "count", (long long)*count, 0, COUNT_MAX);
  const size_t n = h->status == DEA_OK ? *count : 0;
  if (n > 0 && h->reading) {
    *points = create_points(h, group, memory, n);
  }
  if (n == 0 || h->status != DEA_OK) {
    return;
  }
  double *buffer = dea_alloc(h->ctx, n, sizeof *buffer);
  int *whole = dea_alloc(h->ctx, n, sizeof *whole);
  h->status = buffer != NULL && whole != NULL ? DEA_OK : DEA_E_MEMORY;
  for (int c = 0; c < dea_column_count(h->ctx) && h->status == DEA_OK; c++) {
    const struct dea_column *column = dea_column_at(h->ctx, c);
    if (h->reading ? !dea_h5_has(h, group, column->key) : !dea_points_have(*points, n, c)) {
      continue;
    }
    for (size_t i = 0; i < n; i++) {
      buffer[i] = dea_point_get(&(*points)[i], c);
    }
    dea_h5_array(h, group, column->key, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, n, buffer,
                 column->si_unit, column->meaning);
    for (size_t i = 0; i < n && h->reading; i++) {
      dea_point_set(&(*points)[i], c, buffer[i]);
    }
  }
  exchange_states(h, group, *points, n, whole);
  dea_free(h->ctx, whole);
  dea_free(h->ctx, buffer);
}

// Curves ------------------------------------------------------------------------------------------

static void add_events(struct h5 *h, const struct dea_load_point *points, const char *kinds,
                       size_t count, struct dea_curve *curve)
{
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    struct dea_event event = {.point = points[i]};
    const char *kind = kinds + i * KIND_SIZE;
    h->status =
        dea_event_find(kind, &event.kind)
            ? dea_curve_add_event(h->ctx, curve, &event)
            : dea_fail(h->ctx, DEA_E_IO, "%s has an event of unknown kind '%s'", h->path, kind);
  }
}

static void exchange_events(struct h5 *h, hid_t parent, struct dea_curve *curve)
{
  hid_t group = dea_h5_group(h, parent, "events");
  size_t count = curve->event_count;
  struct dea_load_point *points = NULL;
  if (count > 0) { // of a curve that is written
    points = dea_alloc(h->ctx, count, sizeof *points);
    h->status = points == NULL ? DEA_E_MEMORY : h->status;
  }
  for (size_t i = 0; points != NULL && i < count; i++) {
    points[i] = curve->events[i].point;
  }
  exchange_points(h, group, &curve->memory, &points, &count);
  char *kinds = h->status == DEA_OK ? dea_alloc(h->ctx, count, KIND_SIZE) : NULL;
  h->status = h->status == DEA_OK && kinds == NULL ? DEA_E_MEMORY : h->status;
  for (size_t i = 0; kinds != NULL && i < curve->event_count; i++) {
    snprintf(kinds + i * KIND_SIZE, KIND_SIZE, "%s", dea_event_name(curve->events[i].kind));
  }
  if (count > 0 && h->status == DEA_OK) {
    dea_h5_texts(h, group, "kind", count, KIND_SIZE, kinds,
                 "pull_in, snap_back, slack or breakdown");
  }
  if (h->reading) {
    add_events(h, points, kinds, count, curve);
  }
  dea_free(h->ctx, kinds);
  dea_free(h->ctx, points);
  dea_h5_close(group);
}

/* Standard uncertainties of the points; files of older versions have none. */
static void exchange_std(struct h5 *h, hid_t parent, struct dea_curve *curve)
{
  if (h->reading ? dea_h5_has(h, parent, "std") : curve->std != NULL) {
    size_t count = curve->count;
    hid_t group = dea_h5_group(h, parent, "std");
    exchange_points(h, group, &curve->memory, &curve->std, &count);
    if (h->status == DEA_OK && count != curve->count) {
      h->status = dea_fail(h->ctx, DEA_E_IO, "%s is damaged: %zu points with %zu uncertainties",
                           h->path, curve->count, count);
    }
    dea_h5_close(group);
  }
}

static dea_status status_of_name(const char *name)
{
  for (int s = DEA_OK; s <= (int)DEA_E_INVERTED; s++) {
    if (strcmp(dea_status_name((dea_status)s), name) == 0) {
      return (dea_status)s;
    }
  }
  return DEA_E_NOT_CONVERGED; // of a later version: it did stop
}

/* What stands in a curve's group beside its names. */
static void exchange_content(struct h5 *h, hid_t group, struct dea_curve *curve)
{
  char status[DEA_NAME_SIZE];
  snprintf(status, sizeof status, "%s", dea_status_name(curve->status));
  curve->complete = dea_h5_int(h, group, "complete", curve->complete, LLONG_MIN, LLONG_MAX) != 0;
  dea_h5_text(h, group, "status", status, sizeof status);
  curve->status = status_of_name(status);
  dea_h5_text(h, group, "stopped", curve->stopped, sizeof curve->stopped);
  exchange_points(h, group, &curve->memory, &curve->points, &curve->count);
  curve->capacity = h->reading ? curve->count : curve->capacity;
  exchange_std(h, group, curve);
  exchange_events(h, group, curve);
}

static void exchange_curve(struct h5 *h, hid_t group, const struct entry *entry,
                           struct dea_result *result)
{
  struct dea_curve *curve = h->reading ? NULL : &result->curves[entry->index];
  if (h->reading && h->status == DEA_OK) {
    h->status = dea_result_add_curve(h->ctx, result, entry->model, entry->name, &curve);
  }
  if (h->status == DEA_OK) {
    exchange_content(h, group, curve);
  }
}

// Profiles and variants ---------------------------------------------------------------------------

/* The record of a group; its columns, when read, are owned by the caller, NULL after a failure. */
static void exchange_record(struct h5 *h, hid_t group, struct dea_profile_record *record)
{
  record->count = (size_t)dea_h5_int(h, group, "count", (long long)record->count, 0, COUNT_MAX);
  record->voltage_V = dea_h5_real(h, group, "voltage_V", record->voltage_V);
  const size_t n = record->count;
  if (h->reading) {
    record->columns = dea_alloc(h->ctx, DEA_PROFILE_COLUMNS * n, sizeof *record->columns);
    h->status = record->columns == NULL ? DEA_E_MEMORY : h->status;
  }
  for (size_t k = 0; k < DEA_PROFILE_COLUMNS && record->columns != NULL; k++) {
    const struct dea_column *column = &dea_profile_columns[k];
    for (size_t i = 0; i < n && h->reading; i++) {
      record->columns[k * n + i] = NAN;
    }
    if (!h->reading || k < 6 || dea_h5_has(h, group, column->key)) { // z is not in older files
      dea_h5_array(h, group, column->key, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, n,
                   record->columns + k * n, column->si_unit, column->meaning);
    }
  }
}

static void exchange_profile(struct h5 *h, hid_t group, const struct entry *entry,
                             struct dea_result *result)
{
  struct dea_profile_record record = {.count = 0};
  if (!h->reading) {
    exchange_record(h, group, &result->profiles[entry->index]);
    return;
  }
  exchange_record(h, group, &record);
  const struct dea_profile profile = dea_profile_of_record(&record);
  if (h->status == DEA_OK) {
    h->status = dea_result_add_profile(h->ctx, result, entry->model, record.voltage_V, &profile);
  }
  dea_free(h->ctx, record.columns);
}

static void exchange_variant(struct h5 *h, hid_t group, const struct entry *entry,
                             struct dea_result *result)
{
  struct dea_variant *variant = h->reading ? NULL : &result->variants[entry->index];
  char study[DEA_NAME_SIZE] = "", name[DEA_NAME_SIZE] = "";
  if (variant != NULL) {
    memcpy(study, variant->curve.kind, sizeof study);
    memcpy(name, variant->name, sizeof name);
  }
  dea_h5_text(h, group, "study", study, sizeof study);
  dea_h5_text(h, group, "name", name, sizeof name);
  if (h->reading && h->status == DEA_OK) {
    h->status = dea_result_add_variant(h->ctx, result, entry->model, study, name, &variant);
  }
  if (h->status != DEA_OK) {
    return;
  }
  size_t *const sizes[] = {&variant->size.elements, &variant->size.nodes, &variant->size.unknowns};
  static const char *const names[] = {"elements", "nodes", "unknowns"};
  variant->refinement = dea_h5_real(h, group, "refinement", variant->refinement);
  for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
    *sizes[i] = (size_t)dea_h5_int(h, group, names[i], (long long)*sizes[i], 0, LLONG_MAX);
  }
  variant->wall_s = dea_h5_real(h, group, "wall_s", variant->wall_s);
  exchange_content(h, group, &variant->curve);
  if (h->reading ? dea_h5_has(h, group, "profile") : variant->profile.count > 0) {
    hid_t inner = dea_h5_group(h, group, "profile");
    exchange_record(h, inner, &variant->profile);
    memcpy(variant->profile.model, entry->model, sizeof entry->model);
    dea_h5_close(inner);
  }
}

// Tables ------------------------------------------------------------------------------------------

static void exchange_table(struct h5 *h, hid_t group, const struct entry *entry,
                           struct dea_result *result)
{
  dea_results_h5_table(h, group, entry->model, h->reading ? NULL : &result->tables[entry->index],
                       result);
}

// Surfaces ----------------------------------------------------------------------------------------

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
    block.count = (size_t)dea_h5_int(h, group, "count", (long long)block.count, 0, PLACES_MAX);
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

/* same: a group that is written with the same places and elements, which then are there only once
 * in the file; negative for none. What is read is added to the result. */
static void exchange_mesh(struct h5 *h, hid_t group, hid_t same, struct dea_result *result,
                          struct dea_surface_record *record)
{
  struct dea_field_mesh none = {0}, *mesh = h->reading ? &none : record->mesh;
  if (!h->reading || dea_h5_has_attribute(h, group, "point")) { // older files: one a point
    record->point = (size_t)dea_h5_int(h, group, "point", (long long)record->point, 0, PLACES_MAX);
  }
  record->voltage_V = dea_h5_real(h, group, "voltage_V", record->voltage_V);
  const size_t count =
      (size_t)dea_h5_int(h, group, "points", (long long)mesh->point_count, 0, PLACES_MAX);
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

static bool same_mesh(const struct dea_field_mesh *a, const struct dea_field_mesh *b)
{
  bool same = a->point_count == b->point_count && a->block_count == b->block_count &&
              memcmp(a->X, b->X, 3 * a->point_count * sizeof *a->X) == 0;
  for (size_t i = 0; i < a->block_count && same; i++) {
    const struct dea_mesh_block *p = &a->blocks[i], *q = &b->blocks[i];
    same = p->order == q->order && p->order_z == q->order_z && p->count == q->count &&
           memcmp(p->nodes, q->nodes,
                  p->count * (size_t)dea_mesh_block_nodes(p) * sizeof *p->nodes) == 0;
  }
  return same;
}

/* The first group of a model with the same mesh as the i-th surface; none: negative. */
static hid_t open_same(struct h5 *h, hid_t file, const struct dea_result *result, size_t i)
{
  const struct dea_surface_record *record = &result->surfaces[i];
  for (size_t k = 0, number = 0; k < i; k++) {
    if (strcmp(result->surfaces[k].model, record->model) == 0) {
      if (same_mesh(result->surfaces[k].mesh, record->mesh)) {
        char name[DEA_NAME_SIZE + 40];
        snprintf(name, sizeof name, "/surfaces/%s/%04zu", record->model, number);
        return dea_h5_group_open(h, file, name);
      }
      number++;
    }
  }
  return H5I_INVALID_HID;
}

static void exchange_surface(struct h5 *h, hid_t group, const struct entry *entry,
                             struct dea_result *result)
{
  struct dea_surface_record read = {.point = result->surface_count};
  memcpy(read.model, entry->model, sizeof read.model);
  hid_t same = h->reading ? H5I_INVALID_HID : open_same(h, group, result, (size_t)entry->index);
  exchange_mesh(h, group, same, result, h->reading ? &read : &result->surfaces[entry->index]);
  dea_h5_close(same);
}

// Lists -------------------------------------------------------------------------------------------

enum list { CURVES, PROFILES, SURFACES, VARIANTS, TABLES, LISTS };

/* needed: each file has such a group; else a run that had none of these has none, nor has one of
 * before there were any. */
static const struct {
  const char *name;
  bool needed;
  void (*exchange)(struct h5 *h, hid_t group, const struct entry *entry, struct dea_result *result);
} lists[LISTS] = {[CURVES] = {"curves", true, exchange_curve},
                  [PROFILES] = {"profiles", true, exchange_profile},
                  [SURFACES] = {"surfaces", false, exchange_surface},
                  [VARIANTS] = {"variants", false, exchange_variant},
                  [TABLES] = {"tables", false, exchange_table}};

/* Model of the i-th; NULL: there are no more. */
static const char *model_of(const struct dea_result *r, enum list list, size_t i)
{
  switch (list) {
  case CURVES:
    return i < r->curve_count ? r->curves[i].model : NULL;
  case PROFILES:
    return i < r->profile_count ? r->profiles[i].model : NULL;
  case SURFACES:
    return i < r->surface_count ? r->surfaces[i].model : NULL;
  case VARIANTS:
    return i < r->variant_count ? r->variants[i].curve.model : NULL;
  case TABLES:
    return i < r->table_count ? r->tables[i].model : NULL;
  case LISTS:
    break;
  }
  return NULL;
}

/* LIST/MODEL/0000, 0001, ..., of curves LIST/MODEL/KIND. */
static void write_list(struct h5 *h, hid_t parent, enum list list, struct dea_result *result)
{
  const char *model;
  for (size_t i = 0; h->status == DEA_OK && (model = model_of(result, list, i)) != NULL; i++) {
    struct entry entry = {.index = (long long)i};
    hid_t of_model = dea_h5_group_get(h, parent, model);
    snprintf(entry.model, sizeof entry.model, "%s", model);
    snprintf(entry.name, sizeof entry.name, "%04zu", dea_h5_link_count(h, of_model));
    hid_t group =
        dea_h5_group_create(h, of_model, list == CURVES ? result->curves[i].kind : entry.name);
    dea_h5_write_int(h, group, "index", entry.index);
    lists[list].exchange(h, group, &entry, result);
    dea_h5_close(group);
    dea_h5_close(of_model);
  }
}

static int entry_compare(const void *a, const void *b)
{
  const struct entry *x = a, *y = b;
  return (x->index > y->index) - (x->index < y->index);
}

/* Lists parent/<model>/<name> by index, whatever the order of the names; entries owned by the
 * caller. */
static struct entry *list_entries(struct h5 *h, hid_t parent, size_t *count)
{
  struct entry *entries = NULL;
  *count = 0;
  size_t models = dea_h5_link_count(h, parent);
  for (size_t m = 0; m < models && h->status == DEA_OK; m++) {
    struct entry entry;
    dea_h5_link_name(h, parent, m, entry.model, sizeof entry.model);
    hid_t model = dea_h5_group_open(h, parent, entry.model);
    size_t names = dea_h5_link_count(h, model);
    struct entry *moved =
        h->status == DEA_OK ? dea_resize(h->ctx, entries, *count + names, sizeof *entries) : NULL;
    if (moved != NULL) {
      entries = moved;
    } else if (h->status == DEA_OK) {
      h->status = DEA_E_MEMORY;
    }
    for (size_t i = 0; i < names && h->status == DEA_OK; i++) {
      dea_h5_link_name(h, model, i, entry.name, sizeof entry.name);
      hid_t group = dea_h5_group_open(h, model, entry.name);
      entry.index = dea_h5_get_int(h, group, "index");
      dea_h5_close(group);
      entries[(*count)++] = entry;
    }
    dea_h5_close(model);
  }
  if (h->status == DEA_OK && *count > 1) {
    qsort(entries, *count, sizeof *entries, entry_compare);
  }
  return entries;
}

static void read_list(struct h5 *h, hid_t parent, enum list list, struct dea_result *result)
{
  size_t count;
  struct entry *entries = list_entries(h, parent, &count);
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    hid_t model = dea_h5_group_open(h, parent, entries[i].model);
    hid_t group = dea_h5_group_open(h, model, entries[i].name);
    lists[list].exchange(h, group, &entries[i], result);
    dea_h5_close(group);
    dea_h5_close(model);
  }
  dea_free(h->ctx, entries);
}

static void exchange_lists(struct h5 *h, hid_t file, struct dea_result *result)
{
  for (int k = 0; k < LISTS; k++) {
    const bool any =
        h->reading ? dea_h5_has(h, file, lists[k].name) : model_of(result, k, 0) != NULL;
    if (!any && !lists[k].needed) {
      continue;
    }
    hid_t parent = dea_h5_group(h, file, lists[k].name);
    if (k == VARIANTS &&
        (!h->reading || dea_h5_has_attribute(h, parent, "convergence_tolerance"))) {
      result->convergence_tolerance =
          dea_h5_real(h, parent, "convergence_tolerance", result->convergence_tolerance);
    }
    if (h->reading) {
      read_list(h, parent, k, result);
    } else {
      write_list(h, parent, k, result);
    }
    dea_h5_close(parent);
  }
}

// Columns of monitors and channels ----------------------------------------------------------------

static bool any_has(const struct dea_result *result, int column)
{
  bool any = false;
  for (size_t i = 0; i < result->curve_count && !any; i++) {
    any = dea_points_have(result->curves[i].points, result->curves[i].count, column);
  }
  for (size_t i = 0; i < result->variant_count && !any; i++) {
    const struct dea_curve *curve = &result->variants[i].curve;
    any = dea_points_have(curve->points, curve->count, column);
  }
  return any;
}

/* columns/0000, 0001, ...: those of monitors and channels, in their order. */
static void write_columns(struct h5 *h, hid_t file, const struct dea_result *result)
{
  hid_t columns = H5I_INVALID_HID;
  for (int c = DEA_LOAD_POINT_COLUMNS; c < dea_column_count(h->ctx); c++) {
    if (!any_has(result, c)) {
      continue;
    }
    const struct dea_column *column = dea_column_at(h->ctx, c);
    columns = columns < 0 ? dea_h5_group_create(h, file, "columns") : columns;
    char name[24];
    snprintf(name, sizeof name, "%04zu", dea_h5_link_count(h, columns));
    hid_t group = dea_h5_group_create(h, columns, name);
    dea_h5_write_text(h, group, "key", column->key);
    dea_h5_write_text(h, group, "title", column->header);
    dea_h5_write_text(h, group, "unit", column->si_unit);
    dea_h5_write_text(h, group, "display_unit", column->display_unit);
    dea_h5_write_real(h, group, "display_factor", column->factor);
    dea_h5_write_text(h, group, "meaning", column->meaning);
    dea_h5_close(group);
  }
  dea_h5_close(columns);
}

/* Adds the columns of monitors and channels to the context. */
static void read_columns(struct h5 *h, hid_t file)
{
  hid_t columns = h->status == DEA_OK && dea_h5_has(h, file, "columns")
                      ? dea_h5_group_open(h, file, "columns")
                      : H5I_INVALID_HID;
  const size_t count = columns >= 0 ? dea_h5_link_count(h, columns) : 0;
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    char key[2 * DEA_NAME_SIZE], title[DEA_COLUMN_TITLE_SIZE], unit[32], shown[32], meaning[256];
    int column;
    dea_h5_link_name(h, columns, i, key, sizeof key);
    hid_t group = dea_h5_group_open(h, columns, key);
    dea_h5_get_text(h, group, "key", key, sizeof key);
    dea_h5_get_text(h, group, "title", title, sizeof title);
    dea_h5_get_text(h, group, "unit", unit, sizeof unit);
    dea_h5_get_text(h, group, "display_unit", shown, sizeof shown);
    dea_h5_get_text(h, group, "meaning", meaning, sizeof meaning);
    const double factor = dea_h5_get_real(h, group, "display_factor");
    dea_h5_close(group);
    if (h->status == DEA_OK) {
      h->status = dea_column_add(
          h->ctx, &(struct dea_column){key, unit, shown, factor, title, meaning}, &column);
    }
  }
  dea_h5_close(columns);
}

// The file ----------------------------------------------------------------------------------------

/* What is read is owned by the result, what is written stays. */
static void exchange_origin(struct h5 *h, hid_t file, struct dea_run *run)
{
  struct dea_provenance *p = &run->result->provenance;
  hid_t design = dea_h5_group(h, file, "design");
  dea_h5_text(h, design, "title", run->title, sizeof run->title);
  dea_h5_text(h, design, "file", run->design_file, sizeof run->design_file);
  dea_h5_text(h, design, "sha256", p->input_sha256, sizeof p->input_sha256);
  run->width_m = dea_h5_real(h, design, "report_width_m", run->width_m);
  run->svg = dea_h5_int(h, design, "report_svg", run->svg, 0, 1) != 0;
  run->pdf = dea_h5_int(h, design, "report_pdf", run->pdf, 0, 1) != 0;
  run->png = dea_h5_int(h, design, "report_png", run->png, 0, 1) != 0;
  p->input = dea_h5_long_text(h, design, "text", p->input);
  p->overrides = dea_h5_long_text(h, design, "overrides", p->overrides);
  dea_h5_close(design);
  hid_t group = dea_h5_group(h, file, "provenance");
  dea_h5_text(h, group, "program", p->program, sizeof p->program);
  dea_h5_text(h, group, "compiler", p->compiler, sizeof p->compiler);
  dea_h5_text(h, group, "build", p->build, sizeof p->build);
  dea_h5_text(h, group, "libraries", p->libraries, sizeof p->libraries);
  dea_h5_text(h, group, "started", p->started, sizeof p->started);
  p->wall_s = dea_h5_real(h, group, "wall_s", p->wall_s);
#define EXCHANGE(member, label)                                                                    \
  if (!h->reading || dea_h5_has_attribute(h, group, #member)) { /* not in older files */           \
    p->solver.member =                                                                             \
        (unsigned long)dea_h5_int(h, group, #member, (long long)p->solver.member, 0, LLONG_MAX);   \
  }
  DEA_SOLVER_COUNTERS(EXCHANGE)
#undef EXCHANGE
  p->command = dea_h5_long_text(h, group, "command", p->command);
  dea_h5_close(group);
}

dea_status dea_results_h5_write(struct dea_context *ctx, const struct dea_result *result,
                                const char *path)
{
  struct h5 h;
  struct dea_result copy = *result; // of which nothing is changed
  struct dea_run run = {.result = &copy, .width_m = NAN};
  if (result->design != NULL) {
    const struct dea_design *design = result->design;
    snprintf(run.title, sizeof run.title, "%s", design->title.text);
    snprintf(run.design_file, sizeof run.design_file, "%s", design->file);
    run.width_m = design->report.width_m.si;
    run.svg = design->report.svg;
    run.pdf = design->report.pdf;
    run.png = design->report.png;
  }
  dea_h5_begin(&h, ctx, path);
  hid_t file = dea_h5_file_create(&h);
  dea_h5_write_text(&h, file, "format", "libdea results");
  dea_h5_write_int(&h, file, "schema", DEA_RESULTS_H5_SCHEMA);
  write_columns(&h, file, result);
  exchange_lists(&h, file, &copy);
  exchange_origin(&h, file, &run);
  dea_h5_file_write(&h, file);
  dea_h5_end(&h);
  return h.status;
}

static void check_schema(struct h5 *h, hid_t file)
{
  long long schema = dea_h5_get_int(h, file, "schema");
  if (h->status == DEA_OK && schema != DEA_RESULTS_H5_SCHEMA) {
    h->status = dea_fail(h->ctx, DEA_E_UNSUPPORTED,
                         "%s has schema %lld of results; this version reads schema %d", h->path,
                         schema, DEA_RESULTS_H5_SCHEMA);
  }
}

static dea_status read_file(struct dea_context *ctx, const char *path, struct dea_run *run)
{
  struct h5 h;
  dea_h5_begin(&h, ctx, path);
  hid_t file = dea_h5_file_open(&h, false);
  check_schema(&h, file);
  read_columns(&h, file);
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): made before
  exchange_lists(&h, file, run->result);
  exchange_origin(&h, file, run);
  dea_h5_close(file);
  dea_h5_end(&h);
  return h.status;
}

dea_status dea_run_read(struct dea_context *ctx, const char *path, struct dea_run **out)
{
  *out = NULL;
  if (!dea_path_exists(path)) {
    return dea_fail(ctx, DEA_E_IO, "%s does not exist", path);
  }
  char inside[DEA_PATH_SIZE];
  const bool folder = dea_path_is_folder(path);
  DEA_TRY(ctx, folder ? dea_path_build(ctx, path, "results.h5", inside) : DEA_OK);
  if (folder && !dea_path_exists(inside)) {
    return dea_fail(ctx, DEA_E_IO, "%s is not a run folder: it has no results.h5", path);
  }
  struct dea_run *run = dea_alloc(ctx, 1, sizeof *run);
  DEA_TRY_MEMORY(run != NULL);
  dea_status status = dea_result_create(ctx, NULL, NULL, &run->result);
  status = status == DEA_OK ? read_file(ctx, folder ? inside : path, run) : status;
  DEA_TRY_ELSE(ctx, status, dea_run_destroy(ctx, run));
  *out = run;
  return DEA_OK;
}

void dea_run_destroy(struct dea_context *ctx, struct dea_run *run)
{
  if (run != NULL) {
    dea_result_destroy(ctx, run->result);
    dea_free(ctx, run);
  }
}
