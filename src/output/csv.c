#include "output/csv.h"

#include "output/file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void dea_column_title(const struct dea_column *column, char *out, size_t size)
{
  if (strcmp(column->display_unit, "1") == 0) {
    snprintf(out, size, "%s", column->header);
  } else {
    snprintf(out, size, "%s (%s)", column->header, column->display_unit);
  }
}

static void add_number(struct dea_text *text, double value)
{
  if (!isnan(value)) {
    dea_text_add(text, "%.12g", value);
  }
}

static void add_header(struct dea_text *text, const bool *used)
{
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    if (used[c]) {
      char title[96];
      dea_column_title(&dea_point_columns[c], title, sizeof title);
      dea_text_add(text, "%s,", title);
    }
  }
  dea_text_add(text, "stable,unstable_modes\n");
}

static void add_point(struct dea_text *text, const bool *used, const struct dea_load_point *point)
{
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    if (used[c]) {
      add_number(text, dea_point_get(point, c) * dea_point_columns[c].factor);
      dea_text_add(text, ",");
    }
  }
  dea_text_add(text, "%d,%d\n", point->stable, point->unstable_modes);
}

dea_status dea_csv_write_curve(struct dea_context *ctx, const struct dea_curve *curve,
                               const char *directory)
{
  bool used[DEA_LOAD_POINT_COLUMNS];
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    used[c] = dea_points_have(curve->points, curve->count, c);
  }
  void *before = dea_c_locale_enter();
  struct dea_text text = {.ctx = ctx};
  add_header(&text, used);
  for (size_t i = 0; i < curve->count; i++) {
    add_point(&text, used, &curve->points[i]);
  }
  dea_c_locale_leave(before);
  char name[2 * DEA_NAME_SIZE + 8];
  snprintf(name, sizeof name, "%s_%s.csv", curve->model, curve->kind);
  dea_status status = dea_text_write(ctx, &text, directory, name);
  dea_text_free(&text);
  return status;
}

dea_status dea_csv_write_events(struct dea_context *ctx, const struct dea_curve *curve,
                                const char *directory)
{
  if (curve->event_count == 0) {
    return DEA_OK;
  }
  bool used[DEA_LOAD_POINT_COLUMNS] = {false};
  for (size_t i = 0; i < curve->event_count; i++) {
    for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
      used[c] = used[c] || !isnan(dea_point_get(&curve->events[i].point, c));
    }
  }
  void *before = dea_c_locale_enter();
  struct dea_text text = {.ctx = ctx};
  dea_text_add(&text, "event,");
  add_header(&text, used);
  for (size_t i = 0; i < curve->event_count; i++) {
    dea_text_add(&text, "%s,", dea_event_name(curve->events[i].kind));
    add_point(&text, used, &curve->events[i].point);
  }
  dea_c_locale_leave(before);
  char name[2 * DEA_NAME_SIZE + 16];
  snprintf(name, sizeof name, "%s_%s_events.csv", curve->model, curve->kind);
  dea_status status = dea_text_write(ctx, &text, directory, name);
  dea_text_free(&text);
  return status;
}

static void add_profile(struct dea_text *text, const struct dea_profile_record *record)
{
  for (size_t i = 0; i < record->count; i++) {
    add_number(text, record->voltage_V * 1e-3);
    for (size_t c = 0; c < DEA_PROFILE_COLUMNS; c++) {
      dea_text_add(text, ",");
      add_number(text, record->columns[c * record->count + i] * dea_profile_columns[c].factor);
    }
    dea_text_add(text, "\n");
  }
}

dea_status dea_csv_write_profiles(struct dea_context *ctx, const struct dea_result *result,
                                  const char *model, const char *directory)
{
  struct dea_text text = {.ctx = ctx};
  bool any = false;
  dea_text_add(&text, "V (kV)");
  for (int c = 0; c < DEA_PROFILE_COLUMNS; c++) {
    char title[96];
    dea_column_title(&dea_profile_columns[c], title, sizeof title);
    dea_text_add(&text, ",%s", title);
  }
  dea_text_add(&text, "\n");
  void *before = dea_c_locale_enter();
  for (size_t i = 0; i < result->profile_count; i++) {
    if (strcmp(result->profiles[i].model, model) == 0) {
      any = true;
      add_profile(&text, &result->profiles[i]);
    }
  }
  dea_c_locale_leave(before);
  char name[DEA_NAME_SIZE + 16];
  snprintf(name, sizeof name, "%s_profiles.csv", model);
  dea_status status = any ? dea_text_write(ctx, &text, directory, name) : DEA_OK;
  dea_text_free(&text);
  return status;
}
