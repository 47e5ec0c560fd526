#include "result/result.h"

#include "result/columns.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const size_t surface_bytes = (size_t)256 << 20; // hundreds of sectors, tens of fine discs

dea_status dea_result_create(struct dea_context *ctx, const struct dea_design *design,
                             const struct dea_device *device, struct dea_result **out)
{
  *out = dea_alloc(ctx, 1, sizeof **out);
  DEA_TRY_MEMORY(*out != NULL);
  (*out)->design = design;
  (*out)->device = device;
  (*out)->surface_bytes_max = surface_bytes;
  (*out)->convergence_tolerance = NAN;
  return DEA_OK;
}

static void clear_curve(struct dea_context *ctx, struct dea_curve *curve)
{
  dea_free(ctx, curve->points);
  dea_free(ctx, curve->std);
  dea_free(ctx, curve->events);
  dea_arena_free(&curve->memory);
}

void dea_result_destroy(struct dea_context *ctx, struct dea_result *result)
{
  if (result == NULL) {
    return;
  }
  for (size_t i = 0; i < result->curve_count; i++) {
    clear_curve(ctx, &result->curves[i]);
  }
  dea_free(ctx, result->curves);
  for (size_t i = 0; i < result->profile_count; i++) {
    dea_free(ctx, result->profiles[i].columns);
  }
  dea_free(ctx, result->profiles);
  for (size_t i = 0; i < result->surface_count; i++) {
    dea_field_mesh_destroy(ctx, result->surfaces[i].mesh);
  }
  dea_free(ctx, result->surfaces);
  for (size_t i = 0; i < result->variant_count; i++) {
    clear_curve(ctx, &result->variants[i].curve);
    dea_free(ctx, result->variants[i].profile.columns);
  }
  dea_free(ctx, result->variants);
  for (size_t i = 0; i < result->table_count; i++) {
    dea_result_table_free(ctx, &result->tables[i]);
  }
  dea_free(ctx, result->tables);
  dea_free(ctx, result->provenance.input);
  dea_free(ctx, result->provenance.overrides);
  dea_free(ctx, result->provenance.command);
  dea_free(ctx, result);
}

static dea_status name_set(struct dea_context *ctx, const char *what, const char *name, char *out)
{
  if (name[0] == '\0' || strlen(name) >= DEA_NAME_SIZE || strchr(name, '/') != NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "'%s' cannot be the name of a %s", name, what);
  }
  snprintf(out, DEA_NAME_SIZE, "%s", name);
  return DEA_OK;
}

dea_status dea_result_add_curve(struct dea_context *ctx, struct dea_result *result,
                                const char *model, const char *kind, struct dea_curve **out)
{
  *out = NULL;
  struct dea_curve curve = {.complete = true, .status = DEA_OK};
  DEA_TRY(ctx, name_set(ctx, "model", model, curve.model));
  DEA_TRY(ctx, name_set(ctx, "curve's kind", kind, curve.kind));
  if (dea_result_find(result, model, kind) != NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the result has a curve '%s' of model '%s' already", kind,
                    model);
  }
  struct dea_curve *curves =
      dea_resize(ctx, result->curves, result->curve_count + 1, sizeof *curves);
  DEA_TRY_MEMORY(curves != NULL);
  result->curves = curves;
  *out = &curves[result->curve_count++];
  **out = curve;
  return DEA_OK;
}

static struct dea_result_table *find_table(const struct dea_result *result, const char *model,
                                           const char *study, const char *name)
{
  for (size_t i = 0; i < result->table_count; i++) {
    struct dea_result_table *table = &result->tables[i];
    if (strcmp(table->model, model) == 0 && strcmp(table->type.study, study) == 0 &&
        strcmp(table->type.name, name) == 0) {
      return table;
    }
  }
  return NULL;
}

const struct dea_result_table *dea_result_find_table(const struct dea_result *result,
                                                     const char *model, const char *study,
                                                     const char *name)
{
  return find_table(result, model, study, name);
}

dea_status dea_result_add_table(struct dea_context *ctx, struct dea_result *result,
                                const struct dea_result_table_type *type, const char *model,
                                size_t width, struct dea_result_table **out)
{
  struct dea_result_table table;
  *out = NULL;
  DEA_TRY(ctx, dea_result_table_init(ctx, type, model, width, &table));
  *out = find_table(result, model, type->study, type->name);
  if (*out != NULL) {
    dea_result_table_free(ctx, *out);
    **out = table;
    return DEA_OK;
  }
  struct dea_result_table *tables =
      dea_resize(ctx, result->tables, result->table_count + 1, sizeof *tables);
  if (tables == NULL) {
    dea_result_table_free(ctx, &table);
    return DEA_E_MEMORY;
  }
  result->tables = tables;
  *out = &tables[result->table_count++];
  **out = table;
  return DEA_OK;
}

dea_status dea_result_get_table(struct dea_context *ctx, struct dea_result *result,
                                const struct dea_result_table_type *type, const char *model,
                                struct dea_result_table **out)
{
  *out = find_table(result, model, type->study, type->name);
  return *out != NULL ? DEA_OK : dea_result_add_table(ctx, result, type, model, 0, out);
}

dea_status dea_result_adopt_table(struct dea_context *ctx, struct dea_result *result,
                                  struct dea_result_table *table)
{
  struct dea_result_table *to;
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &table->type, table->model, table->width, &to));
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): dea_result_add_table sets it or fails
  dea_result_table_free(ctx, to);
  *to = *table;
  table->cells = NULL;
  table->own_columns = NULL;
  table->row_count = table->capacity = 0;
  return DEA_OK;
}

dea_status dea_curve_add_point(struct dea_context *ctx, struct dea_curve *curve,
                               const struct dea_load_point *point)
{
  DEA_TRY(ctx, dea_array_grow(ctx, &curve->points, curve->count, &curve->capacity,
                              sizeof *curve->points));
  curve->memory.ctx = ctx;
  struct dea_monitor_values *monitors = dea_monitor_values_copy(&curve->memory, point->monitors);
  DEA_TRY(ctx, dea_arena_status(&curve->memory));
  curve->points[curve->count] = *point;
  curve->points[curve->count++].monitors = monitors;
  return DEA_OK;
}

dea_status dea_curve_add_event(struct dea_context *ctx, struct dea_curve *curve,
                               const struct dea_event *event)
{
  DEA_TRY(ctx, dea_array_grow(ctx, &curve->events, curve->event_count, &curve->event_room,
                              sizeof *curve->events));
  curve->memory.ctx = ctx;
  struct dea_monitor_values *monitors =
      dea_monitor_values_copy(&curve->memory, event->point.monitors);
  DEA_TRY(ctx, dea_arena_status(&curve->memory));
  curve->events[curve->event_count] = *event;
  curve->events[curve->event_count++].point.monitors = monitors;
  return DEA_OK;
}

const struct dea_event *dea_curve_first_event(const struct dea_curve *curve,
                                              enum dea_event_kind kind)
{
  for (size_t i = 0; curve != NULL && i < curve->event_count; i++) {
    if (curve->events[i].kind == kind) {
      return &curve->events[i];
    }
  }
  return NULL;
}

dea_status dea_curve_end(struct dea_context *ctx, struct dea_curve *curve, dea_status status)
{
  curve->complete = status == DEA_OK;
  curve->status = status;
  snprintf(curve->stopped, sizeof curve->stopped, "%s",
           status == DEA_OK ? "" : dea_context_message(ctx));
  return status;
}

bool dea_curve_is_slack(const struct dea_curve *curve)
{
  static const double tension_none = 1e-6; // [N/m] below: rounding of a film free of stress
  const struct dea_event *pull_in = dea_curve_first_event(curve, DEA_EVENT_PULL_IN);
  return pull_in != NULL && (pull_in->point.min_tension_N_per_m <= tension_none ||
                             (dea_load_point_flags(&pull_in->point) >> DEA_FLAG_SLACK & 1u) != 0);
}

const char *dea_verdict_of(dea_status status)
{
  switch (status) {
  case DEA_E_NO_EQUILIBRIUM:
    return "pull_in";
  case DEA_E_SLACK:
    return "slack";
  case DEA_E_DOMAIN:
    return "law_end";
  case DEA_E_INVERTED:
    return "inverted_element";
  case DEA_E_NOT_CONVERGED:
    return "not_converged";
  default:
    return "";
  }
}

/* A record of its own memory; nothing to be freed after a failure. */
static dea_status copy_profile(struct dea_context *ctx, const char *model, double voltage_V,
                               const struct dea_profile *profile, struct dea_profile_record *out)
{
  const double *const columns[DEA_PROFILE_COLUMNS] = {
#define PROFILE_SOURCE(member, si, display, factor, header, meaning) profile->member,
      DEA_PROFILE_LIST(PROFILE_SOURCE)
#undef PROFILE_SOURCE
  };
  *out = (struct dea_profile_record){.voltage_V = voltage_V, .count = profile->count};
  DEA_TRY(ctx, name_set(ctx, "model", model, out->model));
  out->columns = dea_alloc(ctx, DEA_PROFILE_COLUMNS * profile->count, sizeof(double));
  DEA_TRY_MEMORY(out->columns != NULL);
  for (size_t c = 0; c < DEA_PROFILE_COLUMNS && profile->count > 0; c++) {
    memcpy(out->columns + c * profile->count, columns[c], profile->count * sizeof(double));
  }
  return DEA_OK;
}

dea_status dea_result_add_profile(struct dea_context *ctx, struct dea_result *result,
                                  const char *model, double voltage_V,
                                  const struct dea_profile *profile)
{
  if (profile->count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_array_grow(ctx, &result->profiles, result->profile_count, &result->profile_room,
                              sizeof *result->profiles));
  DEA_TRY(ctx,
          copy_profile(ctx, model, voltage_V, profile, &result->profiles[result->profile_count]));
  result->profile_count++;
  return DEA_OK;
}

dea_status dea_result_add_variant(struct dea_context *ctx, struct dea_result *result,
                                  const char *model, const char *study, const char *name,
                                  struct dea_variant **out)
{
  *out = NULL;
  struct dea_variant variant = {.refinement = NAN, .curve = {.complete = true}};
  DEA_TRY(ctx, name_set(ctx, "model", model, variant.curve.model));
  DEA_TRY(ctx, name_set(ctx, "study", study, variant.curve.kind));
  DEA_TRY(ctx, name_set(ctx, "variant", name, variant.name));
  struct dea_variant *variants =
      dea_resize(ctx, result->variants, result->variant_count + 1, sizeof *variants);
  DEA_TRY_MEMORY(variants != NULL);
  result->variants = variants;
  *out = &variants[result->variant_count++];
  **out = variant;
  return DEA_OK;
}

dea_status dea_variant_set_profile(struct dea_context *ctx, struct dea_variant *variant,
                                   double voltage_V, const struct dea_profile *profile)
{
  struct dea_profile_record record;
  if (profile->count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, copy_profile(ctx, variant->curve.model, voltage_V, profile, &record));
  dea_free(ctx, variant->profile.columns);
  variant->profile = record;
  return DEA_OK;
}

struct dea_profile dea_profile_of_record(const struct dea_profile_record *record)
{
  const double *c = record->columns;
  size_t n = record->count;
  if (c == NULL) { // of a record that could not be read
    return (struct dea_profile){0};
  }
  return (struct dea_profile){n, c, c + n, c + 2 * n, c + 3 * n, c + 4 * n, c + 5 * n, c + 6 * n};
}

bool dea_variant_is(const struct dea_variant *variant, const char *model, const char *study)
{
  return strcmp(variant->curve.model, model) == 0 && strcmp(variant->curve.kind, study) == 0;
}

size_t dea_result_models(const struct dea_result *result, const char *models[], size_t max)
{
  size_t count = 0, curves = result->curve_count, variants = result->variant_count;
  for (size_t i = 0; i < curves + variants + result->table_count && count < max; i++) {
    const char *model = i < curves              ? result->curves[i].model
                        : i < curves + variants ? result->variants[i - curves].curve.model
                                                : result->tables[i - curves - variants].model;
    bool known = false;
    for (size_t m = 0; m < count; m++) {
      known = known || strcmp(models[m], model) == 0;
    }
    if (!known) {
      models[count++] = model;
    }
  }
  return count;
}

dea_status dea_result_get_curve(struct dea_context *ctx, struct dea_result *result,
                                const char *model, const char *kind, struct dea_curve **out)
{
  const struct dea_curve *there = dea_result_find(result, model, kind);
  if (there != NULL) {
    *out = &result->curves[there - result->curves];
    return DEA_OK;
  }
  return dea_result_add_curve(ctx, result, model, kind, out);
}

static size_t mesh_bytes(const struct dea_field_mesh *mesh)
{
  size_t bytes = sizeof *mesh + 3 * mesh->point_count * sizeof *mesh->X;
  for (size_t b = 0; b < mesh->block_count; b++) {
    const struct dea_mesh_block *block = &mesh->blocks[b];
    bytes += block->count * (size_t)dea_mesh_block_nodes(block) * sizeof *block->nodes;
  }
  for (size_t f = 0; f < mesh->field_count; f++) {
    bytes += dea_mesh_field_count(mesh, &mesh->fields[f]) * (size_t)mesh->fields[f].components *
             sizeof(double);
  }
  return bytes;
}

/* Makes room in memory for one more of a model's surfaces. They are at equal distances from the
 * first on, but for the last, which may be there only because it was the last: it goes, and then
 * every second one until there is room. */
static void thin_surfaces(struct dea_context *ctx, struct dea_result *result, const char *model,
                          size_t bytes)
{
  for (size_t times = 1;; times = 2) {
    size_t count = 0, first = 0, distance = 0, kept = 0, all_bytes = bytes;
    for (size_t i = 0; i < result->surface_count; i++) {
      const struct dea_surface_record *record = &result->surfaces[i];
      if (strcmp(record->model, model) == 0) {
        first = count == 0 ? record->point : first;
        distance = count == 1 ? record->point - first : distance;
        all_bytes += mesh_bytes(record->mesh);
        count++;
      }
    }
    if (distance == 0 || (times == 2 && all_bytes <= result->surface_bytes_max)) {
      return;
    }
    for (size_t i = 0; i < result->surface_count; i++) {
      struct dea_surface_record *record = &result->surfaces[i];
      if (strcmp(record->model, model) == 0 && (record->point - first) % (times * distance) != 0) {
        dea_field_mesh_destroy(ctx, record->mesh);
      } else {
        result->surfaces[kept++] = *record;
      }
    }
    result->surface_count = kept;
  }
}

dea_status dea_result_add_surface(struct dea_context *ctx, struct dea_result *result,
                                  const char *model, size_t point, double voltage_V,
                                  struct dea_field_mesh *mesh)
{
  struct dea_surface_record record = {.point = point, .voltage_V = voltage_V, .mesh = mesh};
  dea_status status = name_set(ctx, "model", model, record.model);
  if (status == DEA_OK) {
    thin_surfaces(ctx, result, model, mesh_bytes(mesh));
    status = dea_array_grow(ctx, &result->surfaces, result->surface_count, &result->surface_room,
                            sizeof *result->surfaces);
  }
  DEA_TRY_ELSE(ctx, status, dea_field_mesh_destroy(ctx, mesh));
  result->surfaces[result->surface_count++] = record;
  return DEA_OK;
}

double dea_result_highest_V(const struct dea_result *result)
{
  double highest = 0;
  for (size_t i = 0; i < result->curve_count; i++) {
    for (size_t k = 0; k < result->curves[i].count; k++) {
      if (strcmp(result->curves[i].kind, "path") != 0) {
        highest = fmax(highest, result->curves[i].points[k].voltage_V);
      }
    }
  }
  return highest;
}

const struct dea_curve *dea_result_find(const struct dea_result *result, const char *model,
                                        const char *kind)
{
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *curve = &result->curves[i];
    if (strcmp(curve->model, model) == 0 && strcmp(curve->kind, kind) == 0) {
      return curve;
    }
  }
  return NULL;
}
