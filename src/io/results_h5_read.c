/* Reader of results.h5. */
#include "io/results_h5.h"

#include "base/h5.h"
#include "base/write_file.h"
#include "io/csv.h"
#include "io/results_h5_surface.h"
#include "io/results_h5_tables.h"
#include "result/result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT_MAX = 10000000, KIND_SIZE = 16 };

static size_t get_count(struct h5 *h, hid_t group)
{
  long long count = dea_h5_get_int(h, group, "count");
  if (h->status == DEA_OK && (count < 0 || count > COUNT_MAX)) {
    h->status = dea_fail(h->ctx, DEA_E_IO, "%s is damaged: a curve of %lld points", h->path, count);
  }
  return h->status == DEA_OK ? (size_t)count : 0;
}

/* Adds the columns of monitors and channels to the context. */
static void get_columns(struct h5 *h, hid_t file)
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

/* Room at points for the columns of monitors that a group has. */
static void build_monitors(struct h5 *h, hid_t group, struct dea_arena *memory,
                           struct dea_load_point *points, size_t count)
{
  const int all = dea_column_count(h->ctx);
  int *columns = dea_arena_alloc(memory, (size_t)all, sizeof *columns);
  size_t found = 0;
  for (int c = DEA_LOAD_POINT_COLUMNS; columns != NULL && c < all; c++) {
    if (dea_h5_has(h, group, dea_column_at(h->ctx, c)->key)) {
      columns[found++] = c;
    }
  }
  for (size_t i = 0; i < count && found > 0; i++) {
    points[i].monitors = dea_monitor_values_create(memory, columns, found);
  }
  h->status = h->status == DEA_OK ? dea_arena_status(memory) : h->status;
}

/* Points of a group; *points owned by the caller, NULL for none; memory: of their monitors. */
static void get_points(struct h5 *h, hid_t group, struct dea_arena *memory,
                       struct dea_load_point **points, size_t *count)
{
  memory->ctx = h->ctx;
  *points = NULL;
  *count = get_count(h, group);
  if (*count == 0) {
    return;
  }
  size_t n = *count;
  *points = dea_alloc(h->ctx, n, sizeof **points);
  double *buffer = dea_alloc(h->ctx, n, sizeof *buffer);
  int *whole = dea_alloc(h->ctx, n, sizeof *whole);
  if (*points == NULL || buffer == NULL || whole == NULL) {
    h->status = DEA_E_MEMORY;
  }
  for (size_t i = 0; h->status == DEA_OK && i < n; i++) {
    (*points)[i] = dea_load_point_empty();
  }
  if (h->status == DEA_OK) {
    build_monitors(h, group, memory, *points, n);
  }
  for (int c = 0; c < dea_column_count(h->ctx); c++) {
    const char *key = dea_column_at(h->ctx, c)->key;
    if (dea_h5_has(h, group, key)) {
      dea_h5_get_array(h, group, key, H5T_NATIVE_DOUBLE, n, buffer);
      for (size_t i = 0; h->status == DEA_OK && i < n; i++) {
        // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): else there is an error
        dea_point_set(&(*points)[i], c, buffer[i]);
      }
    }
  }
  dea_h5_get_array(h, group, "stable", H5T_NATIVE_INT, n, whole);
  for (size_t i = 0; h->status == DEA_OK && i < n; i++) {
    (*points)[i].stable = whole[i] != 0;
  }
  dea_h5_get_array(h, group, "unstable_modes", H5T_NATIVE_INT, n, whole);
  for (size_t i = 0; h->status == DEA_OK && i < n; i++) {
    (*points)[i].unstable_modes = whole[i];
  }
  if (dea_h5_has(h, group, "flags")) { // not in files of older versions
    dea_h5_get_array(h, group, "flags", H5T_NATIVE_INT, n, whole);
    for (size_t i = 0; h->status == DEA_OK && i < n; i++) {
      (*points)[i].own_flags = (unsigned)whole[i];
    }
  }
  dea_free(h->ctx, whole);
  dea_free(h->ctx, buffer);
}

static void get_events(struct h5 *h, hid_t parent, struct dea_curve *curve)
{
  hid_t group = dea_h5_group_open(h, parent, "events");
  struct dea_load_point *points;
  size_t count;
  get_points(h, group, &curve->memory, &points, &count);
  char *names = count > 0 ? dea_alloc(h->ctx, count + 1, KIND_SIZE) : NULL;
  if (count > 0 && names == NULL) {
    h->status = DEA_E_MEMORY;
  } else if (count > 0) {
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, KIND_SIZE);
    dea_h5_get_array(h, group, "kind", type, count, names);
    dea_h5_close(type);
  }
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    struct dea_event event = {.point = points[i]};
    names[i * KIND_SIZE + KIND_SIZE - 1] = '\0';
    if (!dea_event_find(names + i * KIND_SIZE, &event.kind)) {
      h->status = dea_fail(h->ctx, DEA_E_IO, "%s has an event of unknown kind '%s'", h->path,
                           names + i * KIND_SIZE);
    } else {
      h->status = dea_curve_add_event(h->ctx, curve, &event);
    }
  }
  dea_free(h->ctx, names);
  dea_free(h->ctx, points);
  dea_h5_close(group);
}

static dea_status status_of_name(const char *name)
{
  for (int s = DEA_OK; s <= (int)DEA_E_INTERRUPTED; s++) {
    if (strcmp(dea_status_name((dea_status)s), name) == 0) {
      return (dea_status)s;
    }
  }
  return DEA_E_NOT_CONVERGED; // of a later version: it did stop
}

/* One thing to be read in the order of its index, whatever the order of the names. */
struct entry {
  char model[DEA_NAME_SIZE], name[DEA_NAME_SIZE];
  long long index;
};

static int entry_compare(const void *a, const void *b)
{
  const struct entry *x = a, *y = b;
  return (x->index > y->index) - (x->index < y->index);
}

/* Lists parent/<model>/<name> by index; entries owned by the caller. */
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

/* parent/<model>/<name> of an entry. */
static hid_t open_entry(struct h5 *h, hid_t parent, const struct entry *entry)
{
  hid_t model = dea_h5_group_open(h, parent, entry->model);
  hid_t group = dea_h5_group_open(h, model, entry->name);
  dea_h5_close(model);
  return group;
}

/* Standard uncertainties of the points; files of older versions have none. */
static void get_std(struct h5 *h, hid_t parent, struct dea_curve *curve)
{
  if (h->status == DEA_OK && dea_h5_has(h, parent, "std")) {
    size_t count;
    hid_t group = dea_h5_group_get(h, parent, "std");
    get_points(h, group, &curve->memory, &curve->std, &count);
    if (h->status == DEA_OK && count != curve->count) {
      h->status = dea_fail(h->ctx, DEA_E_IO, "%s is damaged: %zu points with %zu uncertainties",
                           h->path, curve->count, count);
    }
    dea_h5_close(group);
  }
}

/* What stands in a curve's group beside its names. */
static void get_content(struct h5 *h, hid_t group, struct dea_curve *curve)
{
  char name[DEA_NAME_SIZE];
  curve->complete = dea_h5_get_int(h, group, "complete") != 0;
  dea_h5_get_text(h, group, "status", name, sizeof name);
  curve->status = status_of_name(name);
  dea_h5_get_text(h, group, "stopped", curve->stopped, sizeof curve->stopped);
  get_points(h, group, &curve->memory, &curve->points, &curve->count);
  curve->capacity = curve->count;
  get_std(h, group, curve);
  get_events(h, group, curve);
}

static void get_curve(struct h5 *h, hid_t group, const struct entry *entry,
                      struct dea_result *result)
{
  struct dea_curve *curve = NULL;
  if (h->status == DEA_OK) {
    h->status = dea_result_add_curve(h->ctx, result, entry->model, entry->name, &curve);
  }
  if (h->status == DEA_OK) {
    get_content(h, group, curve);
  }
}

/* Profile of a group; its columns are owned by the caller, NULL after a failure. */
static struct dea_profile_record get_record(struct h5 *h, hid_t group)
{
  struct dea_profile_record record = {.voltage_V = dea_h5_get_real(h, group, "voltage_V")};
  size_t n = record.count = get_count(h, group);
  record.columns = dea_alloc(h->ctx, DEA_PROFILE_COLUMNS * n, sizeof *record.columns);
  if (record.columns == NULL) {
    h->status = DEA_E_MEMORY;
    return record;
  }
  for (size_t k = 0; k < DEA_PROFILE_COLUMNS; k++) {
    const char *key = dea_profile_columns[k].key;
    for (size_t i = 0; i < n; i++) {
      record.columns[k * n + i] = NAN;
    }
    if (k < 6 || dea_h5_has(h, group, key)) { // z came later: older files have none
      dea_h5_get_array(h, group, key, H5T_NATIVE_DOUBLE, n, record.columns + k * n);
    }
  }
  return record;
}

static void get_profile(struct h5 *h, hid_t group, const struct entry *entry,
                        struct dea_result *result)
{
  const struct dea_profile_record record = get_record(h, group);
  const struct dea_profile profile = dea_profile_of_record(&record);
  if (h->status == DEA_OK) {
    h->status = dea_result_add_profile(h->ctx, result, entry->model, record.voltage_V, &profile);
  }
  dea_free(h->ctx, record.columns);
}

static void get_surface(struct h5 *h, hid_t group, const struct entry *entry,
                        struct dea_result *result)
{
  dea_results_h5_get_surface(h, group, entry->model, result);
}

static void get_table(struct h5 *h, hid_t group, const struct entry *entry,
                      struct dea_result *result)
{
  dea_results_h5_get_table(h, group, entry->model, result);
}

static void get_variant_profile(struct h5 *h, hid_t group, struct dea_variant *variant)
{
  hid_t inner = dea_h5_group_open(h, group, "profile");
  const struct dea_profile_record record = get_record(h, inner);
  const struct dea_profile profile = dea_profile_of_record(&record);
  if (h->status == DEA_OK) {
    h->status = dea_variant_set_profile(h->ctx, variant, record.voltage_V, &profile);
  }
  dea_free(h->ctx, record.columns);
  dea_h5_close(inner);
}

static void get_variant(struct h5 *h, hid_t group, const struct entry *entry,
                        struct dea_result *result)
{
  char study[DEA_NAME_SIZE], name[DEA_NAME_SIZE];
  struct dea_variant *variant = NULL;
  dea_h5_get_text(h, group, "study", study, sizeof study);
  dea_h5_get_text(h, group, "name", name, sizeof name);
  if (h->status == DEA_OK) {
    h->status = dea_result_add_variant(h->ctx, result, entry->model, study, name, &variant);
  }
  if (h->status != DEA_OK) {
    return;
  }
  variant->refinement = dea_h5_get_real(h, group, "refinement");
  variant->size.elements = (size_t)dea_h5_get_int(h, group, "elements");
  variant->size.nodes = (size_t)dea_h5_get_int(h, group, "nodes");
  variant->size.unknowns = (size_t)dea_h5_get_int(h, group, "unknowns");
  variant->wall_s = dea_h5_get_real(h, group, "wall_s");
  get_content(h, group, &variant->curve);
  if (dea_h5_has(h, group, "profile")) {
    get_variant_profile(h, group, variant);
  }
}

/* Reads each of name/<model>/<...> in the order of the indices. needed: else a run that had none of
 * these has no such group, nor has one of before there were any. */
static void get_all(struct h5 *h, hid_t file, const char *name, bool needed,
                    void (*get)(struct h5 *h, hid_t group, const struct entry *entry,
                                struct dea_result *result),
                    struct dea_result *result)
{
  if (!needed && !dea_h5_has(h, file, name)) {
    return;
  }
  hid_t parent = dea_h5_group_open(h, file, name);
  size_t count;
  struct entry *entries = list_entries(h, parent, &count);
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    hid_t group = open_entry(h, parent, &entries[i]);
    get(h, group, &entries[i], result);
    dea_h5_close(group);
  }
  if (dea_h5_has_attribute(h, parent, "convergence_tolerance")) {
    result->convergence_tolerance = dea_h5_get_real(h, parent, "convergence_tolerance");
  }
  dea_free(h->ctx, entries);
  dea_h5_close(parent);
}

static void get_rest(struct h5 *h, hid_t file, struct dea_run *run)
{
  struct dea_provenance *p = &run->result->provenance;
  hid_t design = dea_h5_group_open(h, file, "design");
  dea_h5_get_text(h, design, "title", run->title, sizeof run->title);
  dea_h5_get_text(h, design, "file", run->design_file, sizeof run->design_file);
  dea_h5_get_text(h, design, "sha256", p->input_sha256, sizeof p->input_sha256);
  run->width_m = dea_h5_get_real(h, design, "report_width_m");
  run->svg = dea_h5_get_int(h, design, "report_svg") != 0;
  run->pdf = dea_h5_get_int(h, design, "report_pdf") != 0;
  run->png = dea_h5_get_int(h, design, "report_png") != 0;
  p->input = dea_h5_get_long_text(h, design, "text");
  p->overrides = dea_h5_get_long_text(h, design, "overrides");
  dea_h5_close(design);
  hid_t group = dea_h5_group_open(h, file, "provenance");
  dea_h5_get_text(h, group, "program", p->program, sizeof p->program);
  dea_h5_get_text(h, group, "compiler", p->compiler, sizeof p->compiler);
  dea_h5_get_text(h, group, "build", p->build, sizeof p->build);
  dea_h5_get_text(h, group, "libraries", p->libraries, sizeof p->libraries);
  dea_h5_get_text(h, group, "started", p->started, sizeof p->started);
  p->wall_s = dea_h5_get_real(h, group, "wall_s");
#define GET(member, label)                                                                         \
  if (h->status == DEA_OK && H5Aexists(group, #member) > 0) { /* not in files of older versions */ \
    p->solver.member = (unsigned long)dea_h5_get_int(h, group, #member);                           \
  }
  DEA_SOLVER_COUNTERS(GET)
#undef GET
  p->command = dea_h5_get_long_text(h, group, "command");
  dea_h5_close(group);
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
  get_columns(&h, file);
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): made before
  get_all(&h, file, "curves", true, get_curve, run->result);
  get_all(&h, file, "profiles", true, get_profile, run->result);
  get_all(&h, file, "surfaces", false, get_surface, run->result);
  get_all(&h, file, "variants", false, get_variant, run->result);
  get_all(&h, file, "tables", false, get_table, run->result);
  get_rest(&h, file, run);
  dea_h5_close(file);
  dea_h5_end(&h);
  return h.status;
}

static dea_status run_create(struct dea_context *ctx, struct dea_run **out)
{
  *out = dea_alloc(ctx, 1, sizeof **out);
  DEA_TRY_MEMORY(*out != NULL);
  dea_status status = dea_result_create(ctx, NULL, NULL, &(*out)->result);
  if (status != DEA_OK) {
    dea_free(ctx, *out);
    *out = NULL;
  }
  return status;
}

dea_status dea_run_read(struct dea_context *ctx, const char *path, struct dea_run **out)
{
  *out = NULL;
  if (!dea_path_exists(path)) {
    return dea_fail(ctx, DEA_E_IO, "%s does not exist", path);
  }
  bool folder = dea_path_is_folder(path);
  char *file = folder ? dea_path_join(ctx, path, "results.h5") : NULL;
  if (folder && file == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status;
  struct dea_run *run = NULL;
  if (folder && !dea_path_exists(file)) {
    status = dea_fail(ctx, DEA_E_IO, "%s is not a run folder: it has no results.h5", path);
  } else {
    status = run_create(ctx, &run);
  }
  if (status == DEA_OK) {
    status = read_file(ctx, folder ? file : path, run);
  }
  dea_free(ctx, file);
  if (status != DEA_OK) {
    dea_run_destroy(ctx, run);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
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
