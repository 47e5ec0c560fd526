#include "result/columns.h"

#include <stdio.h>
#include <string.h>

dea_status dea_result_create(struct dea_context *ctx, const struct dea_design *design,
                             const struct dea_device *device, struct dea_result **out)
{
  *out = dea_alloc(ctx, 1, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  (*out)->design = design;
  (*out)->device = device;
  return DEA_OK;
}

void dea_result_destroy(struct dea_context *ctx, struct dea_result *result)
{
  if (result == NULL) {
    return;
  }
  for (size_t i = 0; i < result->curve_count; i++) {
    dea_free(ctx, result->curves[i].points);
    dea_free(ctx, result->curves[i].events);
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
  if (curves == NULL) {
    return DEA_E_MEMORY;
  }
  result->curves = curves;
  *out = &curves[result->curve_count++];
  **out = curve;
  return DEA_OK;
}

/* Room for one more of *items; on failure everything stays as it was. */
static dea_status make_room(struct dea_context *ctx, void **items, size_t count, size_t *room,
                            size_t size)
{
  if (count < *room) {
    return DEA_OK;
  }
  size_t wanted = *room > 0 ? 2 * *room : 16;
  void *moved = dea_resize(ctx, *items, wanted, size);
  if (moved == NULL) {
    return DEA_E_MEMORY;
  }
  *items = moved;
  *room = wanted;
  return DEA_OK;
}

dea_status dea_curve_add_point(struct dea_context *ctx, struct dea_curve *curve,
                               const struct dea_load_point *point)
{
  void *points = curve->points;
  DEA_TRY(ctx, make_room(ctx, &points, curve->count, &curve->room, sizeof *curve->points));
  curve->points = points;
  curve->points[curve->count++] = *point;
  return DEA_OK;
}

dea_status dea_curve_add_event(struct dea_context *ctx, struct dea_curve *curve,
                               const struct dea_event *event)
{
  void *events = curve->events;
  DEA_TRY(ctx,
          make_room(ctx, &events, curve->event_count, &curve->event_room, sizeof *curve->events));
  curve->events = events;
  curve->events[curve->event_count++] = *event;
  return DEA_OK;
}

dea_status dea_result_add_profile(struct dea_context *ctx, struct dea_result *result,
                                  const char *model, double voltage_V,
                                  const struct dea_profile *profile)
{
  struct dea_profile_record record = {.voltage_V = voltage_V, .count = profile->count};
  DEA_TRY(ctx, name_set(ctx, "model", model, record.model));
  void *profiles = result->profiles;
  DEA_TRY(ctx, make_room(ctx, &profiles, result->profile_count, &result->profile_room,
                         sizeof *result->profiles));
  result->profiles = profiles;
  const double *const columns[DEA_PROFILE_COLUMNS] = {
#define PROFILE_SOURCE(member, si, display, factor, header, meaning) profile->member,
      DEA_PROFILE_LIST(PROFILE_SOURCE)
#undef PROFILE_SOURCE
  };
  record.columns = dea_alloc(ctx, DEA_PROFILE_COLUMNS * profile->count, sizeof(double));
  if (record.columns == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t c = 0; c < DEA_PROFILE_COLUMNS && profile->count > 0; c++) {
    memcpy(record.columns + c * profile->count, columns[c], profile->count * sizeof(double));
  }
  result->profiles[result->profile_count++] = record;
  return DEA_OK;
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

dea_status dea_result_add_surface(struct dea_context *ctx, struct dea_result *result,
                                  const char *model, double voltage_V, struct dea_field_mesh *mesh)
{
  struct dea_surface_record record = {.voltage_V = voltage_V, .mesh = mesh};
  void *surfaces = result->surfaces;
  dea_status status = name_set(ctx, "model", model, record.model);
  if (status == DEA_OK) {
    status = make_room(ctx, &surfaces, result->surface_count, &result->surface_room,
                       sizeof *result->surfaces);
  }
  if (status != DEA_OK) {
    dea_field_mesh_destroy(ctx, mesh);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  result->surfaces = surfaces;
  result->surfaces[result->surface_count++] = record;
  return DEA_OK;
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
