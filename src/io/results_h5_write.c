/* Writer of results.h5. */
#include "io/results_h5.h"

#include "base/h5.h"
#include "io/results_h5_surface.h"
#include "io/results_h5_tables.h"
#include "result/result.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Gathers one member of an array of points (or of the points in events) and writes it.
 * stride: bytes from one point to the next. */
static void write_column(struct h5 *h, hid_t group, const char *points, size_t stride, size_t count,
                         int column, double *buffer)
{
  bool any = false;
  for (size_t i = 0; i < count; i++) {
    buffer[i] =
        dea_point_get((const struct dea_load_point *)(const void *)(points + i * stride), column);
    any = any || !isnan(buffer[i]);
  }
  const struct dea_column *c = dea_column_at(h->ctx, column);
  if (any) {
    dea_h5_write_array(h, group, c->key, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, count, buffer,
                       c->si_unit, c->meaning);
  }
}

/* What of points is no quantity. whole: [count] to work with. */
static void write_states(struct h5 *h, hid_t group, const char *points, size_t stride, size_t count,
                         int *whole)
{
  for (int k = 0; k < DEA_POINT_STATES; k++) {
    const struct dea_point_state *state = &dea_point_states[k];
    for (size_t i = 0; i < count; i++) {
      whole[i] = state->get((const struct dea_load_point *)(const void *)(points + i * stride));
    }
    dea_h5_write_array(h, group, state->key, H5T_NATIVE_INT, k == 0 ? H5T_STD_U8LE : H5T_STD_I32LE,
                       count, whole, "1", state->meaning);
  }
}

static void write_points(struct h5 *h, hid_t group, const char *points, size_t stride, size_t count)
{
  dea_h5_write_int(h, group, "count", (long long)count);
  double *buffer = count > 0 ? dea_alloc(h->ctx, count, sizeof *buffer) : NULL;
  int *whole = count > 0 ? dea_alloc(h->ctx, count, sizeof *whole) : NULL;
  if (count == 0 || buffer == NULL || whole == NULL) {
    h->status = count > 0 && h->status == DEA_OK ? DEA_E_MEMORY : h->status;
    dea_free(h->ctx, whole);
    dea_free(h->ctx, buffer);
    return;
  }
  for (int c = 0; c < dea_column_count(h->ctx); c++) {
    write_column(h, group, points, stride, count, c, buffer);
  }
  write_states(h, group, points, stride, count, whole);
  dea_free(h->ctx, whole);
  dea_free(h->ctx, buffer);
}

enum { KIND_SIZE = 16 };

static void write_events(struct h5 *h, hid_t parent, const struct dea_curve *curve)
{
  hid_t group = dea_h5_group_create(h, parent, "events");
  if (curve->event_count > 0) {
    write_points(h, group, (const char *)&curve->events[0].point, sizeof *curve->events,
                 curve->event_count);
    char *names = dea_alloc(h->ctx, curve->event_count, KIND_SIZE);
    for (size_t i = 0; names != NULL && i < curve->event_count; i++) {
      snprintf(names + i * KIND_SIZE, KIND_SIZE, "%s", dea_event_name(curve->events[i].kind));
    }
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, KIND_SIZE);
    if (names != NULL) {
      dea_h5_write_array(h, group, "kind", type, type, curve->event_count, names, "1",
                         "pull_in, snap_back, slack or breakdown");
    } else if (h->status == DEA_OK) {
      h->status = DEA_E_MEMORY;
    }
    dea_h5_close(type);
    dea_free(h->ctx, names);
  } else {
    dea_h5_write_int(h, group, "count", 0);
  }
  dea_h5_close(group);
}

/* Standard uncertainties of the points, in a group of their own. */
static void write_std(struct h5 *h, hid_t parent, const struct dea_curve *curve)
{
  if (curve->std != NULL) {
    hid_t group = dea_h5_group_create(h, parent, "std");
    write_points(h, group, (const char *)curve->std, sizeof *curve->std, curve->count);
    dea_h5_close(group);
  }
}

static void write_curve(struct h5 *h, hid_t group, size_t index, const struct dea_curve *curve)
{
  dea_h5_write_int(h, group, "index", (long long)index);
  dea_h5_write_int(h, group, "complete", curve->complete);
  dea_h5_write_text(h, group, "status", dea_status_name(curve->status));
  dea_h5_write_text(h, group, "stopped", curve->stopped);
  write_points(h, group, (const char *)curve->points, sizeof *curve->points, curve->count);
  write_std(h, group, curve);
  write_events(h, group, curve);
}

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

static void write_curves(struct h5 *h, hid_t file, const struct dea_result *result)
{
  hid_t curves = dea_h5_group_create(h, file, "curves");
  for (size_t i = 0; i < result->curve_count && h->status == DEA_OK; i++) {
    const struct dea_curve *curve = &result->curves[i];
    hid_t model = dea_h5_group_get(h, curves, curve->model);
    hid_t kind = dea_h5_group_create(h, model, curve->kind);
    write_curve(h, kind, i, curve);
    dea_h5_close(kind);
    dea_h5_close(model);
  }
  dea_h5_close(curves);
}

static void write_profile(struct h5 *h, hid_t group, const struct dea_profile_record *record)
{
  dea_h5_write_int(h, group, "count", (long long)record->count);
  dea_h5_write_real(h, group, "voltage_V", record->voltage_V);
  for (int c = 0; c < DEA_PROFILE_COLUMNS; c++) {
    const struct dea_column *column = &dea_profile_columns[c];
    dea_h5_write_array(h, group, column->key, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, record->count,
                       record->columns + (size_t)c * record->count, column->si_unit,
                       column->meaning);
  }
}

static void write_profiles(struct h5 *h, hid_t file, const struct dea_result *result)
{
  hid_t profiles = dea_h5_group_create(h, file, "profiles");
  for (size_t i = 0; i < result->profile_count && h->status == DEA_OK; i++) {
    const struct dea_profile_record *record = &result->profiles[i];
    hid_t model = dea_h5_group_get(h, profiles, record->model);
    char name[24];
    snprintf(name, sizeof name, "%04zu", dea_h5_link_count(h, model));
    hid_t group = dea_h5_group_create(h, model, name);
    dea_h5_write_int(h, group, "index", (long long)i);
    write_profile(h, group, record);
    dea_h5_close(group);
    dea_h5_close(model);
  }
  dea_h5_close(profiles);
}

static void write_variant(struct h5 *h, hid_t group, size_t index,
                          const struct dea_variant *variant)
{
  dea_h5_write_text(h, group, "study", variant->curve.kind);
  dea_h5_write_text(h, group, "name", variant->name);
  dea_h5_write_real(h, group, "refinement", variant->refinement);
  dea_h5_write_int(h, group, "elements", (long long)variant->size.elements);
  dea_h5_write_int(h, group, "nodes", (long long)variant->size.nodes);
  dea_h5_write_int(h, group, "unknowns", (long long)variant->size.unknowns);
  dea_h5_write_real(h, group, "wall_s", variant->wall_s);
  write_curve(h, group, index, &variant->curve);
  if (variant->profile.count > 0) {
    hid_t profile = dea_h5_group_create(h, group, "profile");
    write_profile(h, profile, &variant->profile);
    dea_h5_close(profile);
  }
}

/* variants/MODEL/0000, 0001, ... */
static void write_variants(struct h5 *h, hid_t file, const struct dea_result *result)
{
  if (result->variant_count == 0) {
    return;
  }
  hid_t variants = dea_h5_group_create(h, file, "variants");
  dea_h5_write_real(h, variants, "convergence_tolerance", result->convergence_tolerance);
  for (size_t i = 0; i < result->variant_count && h->status == DEA_OK; i++) {
    const struct dea_variant *variant = &result->variants[i];
    hid_t model = dea_h5_group_get(h, variants, variant->curve.model);
    char name[24];
    snprintf(name, sizeof name, "%04zu", dea_h5_link_count(h, model));
    hid_t group = dea_h5_group_create(h, model, name);
    write_variant(h, group, i, variant);
    dea_h5_close(group);
    dea_h5_close(model);
  }
  dea_h5_close(variants);
}

/* tables/MODEL/0000, 0001, ... */
static void write_tables(struct h5 *h, hid_t file, const struct dea_result *result)
{
  hid_t tables = result->table_count > 0 ? dea_h5_group_create(h, file, "tables") : H5I_INVALID_HID;
  for (size_t i = 0; i < result->table_count && h->status == DEA_OK; i++) {
    hid_t model = dea_h5_group_get(h, tables, result->tables[i].model);
    char name[24];
    snprintf(name, sizeof name, "%04zu", dea_h5_link_count(h, model));
    hid_t group = dea_h5_group_create(h, model, name);
    dea_h5_write_int(h, group, "index", (long long)i);
    dea_results_h5_write_table(h, group, &result->tables[i]);
    dea_h5_close(group);
    dea_h5_close(model);
  }
  dea_h5_close(tables);
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
static hid_t open_same(struct h5 *h, hid_t model, const struct dea_result *result, size_t i)
{
  const struct dea_surface_record *record = &result->surfaces[i];
  for (size_t k = 0, number = 0; k < i; k++) {
    if (strcmp(result->surfaces[k].model, record->model) == 0) {
      if (same_mesh(result->surfaces[k].mesh, record->mesh)) {
        char name[24];
        snprintf(name, sizeof name, "%04zu", number);
        return dea_h5_group_open(h, model, name);
      }
      number++;
    }
  }
  return H5I_INVALID_HID;
}

static void write_surfaces(struct h5 *h, hid_t file, const struct dea_result *result)
{
  if (result->surface_count == 0) {
    return;
  }
  hid_t surfaces = dea_h5_group_create(h, file, "surfaces");
  for (size_t i = 0; i < result->surface_count && h->status == DEA_OK; i++) {
    const struct dea_surface_record *record = &result->surfaces[i];
    hid_t model = dea_h5_group_get(h, surfaces, record->model);
    hid_t same = open_same(h, model, result, i);
    char name[24];
    snprintf(name, sizeof name, "%04zu", dea_h5_link_count(h, model));
    hid_t group = dea_h5_group_create(h, model, name);
    dea_h5_write_int(h, group, "index", (long long)i);
    dea_results_h5_write_surface(h, group, record, same);
    dea_h5_close(group);
    dea_h5_close(same);
    dea_h5_close(model);
  }
  dea_h5_close(surfaces);
}

static void write_design(struct h5 *h, hid_t file, const struct dea_result *result)
{
  const struct dea_design *design = result->design;
  const struct dea_provenance *p = &result->provenance;
  hid_t group = dea_h5_group_create(h, file, "design");
  dea_h5_write_text(h, group, "title", design != NULL ? design->title.text : "");
  dea_h5_write_text(h, group, "file", design != NULL ? design->file : "");
  dea_h5_write_text(h, group, "sha256", p->input_sha256);
  dea_h5_write_real(h, group, "report_width_m", design != NULL ? design->report.width_m.si : NAN);
  dea_h5_write_int(h, group, "report_svg", design != NULL && design->report.svg);
  dea_h5_write_int(h, group, "report_pdf", design != NULL && design->report.pdf);
  dea_h5_write_int(h, group, "report_png", design != NULL && design->report.png);
  dea_h5_write_long_text(h, group, "text", p->input);
  dea_h5_write_long_text(h, group, "overrides", p->overrides);
  dea_h5_close(group);
}

static void write_provenance(struct h5 *h, hid_t file, const struct dea_provenance *p)
{
  hid_t group = dea_h5_group_create(h, file, "provenance");
  dea_h5_write_text(h, group, "program", p->program);
  dea_h5_write_text(h, group, "compiler", p->compiler);
  dea_h5_write_text(h, group, "build", p->build);
  dea_h5_write_text(h, group, "libraries", p->libraries);
  dea_h5_write_text(h, group, "started", p->started);
  dea_h5_write_real(h, group, "wall_s", p->wall_s);
#define PUT(member, label) dea_h5_write_int(h, group, #member, (long long)p->solver.member);
  DEA_SOLVER_COUNTERS(PUT)
#undef PUT
  dea_h5_write_long_text(h, group, "command", p->command);
  dea_h5_close(group);
}

dea_status dea_results_h5_write(struct dea_context *ctx, const struct dea_result *result,
                                const char *path)
{
  struct h5 h;
  dea_h5_begin(&h, ctx, path);
  hid_t file = dea_h5_file_create(&h);
  dea_h5_write_text(&h, file, "format", "libdea results");
  dea_h5_write_int(&h, file, "schema", DEA_RESULTS_H5_SCHEMA);
  write_columns(&h, file, result);
  write_curves(&h, file, result);
  write_profiles(&h, file, result);
  write_surfaces(&h, file, result);
  write_variants(&h, file, result);
  write_tables(&h, file, result);
  write_design(&h, file, result);
  write_provenance(&h, file, &result->provenance);
  dea_h5_file_write(&h, file);
  dea_h5_end(&h);
  return h.status;
}
