#include "result/figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const struct dea_curve *dea_figure_curve(const struct dea_result *result, const char *model,
                                         bool prefer_path)
{
  const struct dea_curve *first = dea_result_find(result, model, prefer_path ? "path" : "sweep");
  const struct dea_curve *other = dea_result_find(result, model, prefer_path ? "sweep" : "path");
  if (first != NULL && first->count > 0) {
    return first;
  }
  return other != NULL && other->count > 0 ? other : NULL;
}

struct dea_series dea_figure_style(const char *model, size_t m)
{
  static const enum dea_colour order[] = {DEA_BLUE, DEA_VERMILLION, DEA_GREEN, DEA_PURPLE};
  struct dea_series look = {
      .style = m == 0 ? DEA_LINE : DEA_LINE_MARKED,
      .colour = order[m % 4],
      .marker = m > 0 ? (int)m - 1 : 0,
  };
  dea_label_escape(model, look.title, sizeof look.title);
  return look;
}

dea_status dea_figure_add_entry(struct dea_context *ctx, struct dea_panel *panel,
                                enum dea_series_style style, const char *title, double x, double y)
{
  struct dea_series *entry;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, 1, &entry));
  entry->style = style;
  entry->colour = DEA_GREY;
  snprintf(entry->title, sizeof entry->title, "%s", title);
  entry->values[0] = x;
  entry->values[1] = y;
  return DEA_OK;
}

/* Series of the points with that stability; where the two meet both have the point of the dashed
 * side's start, so that no gap opens. */
static dea_status add_part(struct dea_context *ctx, struct dea_panel *panel,
                           const struct dea_curve *curve, int column, double factor, double shift,
                           const struct dea_series *look, bool stable)
{
  struct dea_series *series;
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, curve->count, look, &series));
  if (!stable) {
    series->style = DEA_DASHED;
    series->title[0] = '\0';
  }
  const struct dea_load_point *p = curve->points;
  for (size_t i = 0; i < curve->count; i++) {
    bool shown = stable ? p[i].stable
                        : !p[i].stable || (i > 0 && !p[i - 1].stable) ||
                              (i + 1 < curve->count && !p[i + 1].stable);
    series->values[i] = 1e-3 * p[i].voltage_V;
    if (shown) {
      series->values[curve->count + i] = factor * (dea_point_get(&p[i], column) + shift);
    }
  }
  return DEA_OK;
}

dea_status dea_figure_add(struct dea_context *ctx, struct dea_panel *panel,
                          const struct dea_curve *curve, int column, double factor, double shift,
                          const struct dea_series *look)
{
  if (curve == NULL || !dea_points_have(curve->points, curve->count, column)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, add_part(ctx, panel, curve, column, factor, shift, look, true));
  for (size_t i = 0; i < curve->count; i++) {
    if (!curve->points[i].stable) {
      panel->says_unstable = true;
      return add_part(ctx, panel, curve, column, factor, shift, look, false);
    }
  }
  return DEA_OK;
}

dea_status dea_figure_add_models(struct dea_context *ctx, struct dea_panel *panel,
                                 const struct dea_result *result, int column, bool prefer_path)
{
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    struct dea_series look = dea_figure_style(models[m], m);
    DEA_TRY(ctx, dea_figure_add(ctx, panel, dea_figure_curve(result, models[m], prefer_path),
                                column, dea_point_columns[column].factor, 0.0, &look));
  }
  return DEA_OK;
}

/* What is drawn: factor * (member + shift). */
struct quantity {
  int column;
  double factor, shift;
};

/* Adds the events of one kind as markers; left out are those that fall outside a sweep. */
static dea_status add_events_of(struct dea_context *ctx, struct dea_panel *panel,
                                const struct dea_result *result, enum dea_event_kind kind,
                                const struct quantity *q, bool whole_path)
{
  static const char *const words[] = {
      [DEA_EVENT_PULL_IN] = "pull-in",
      [DEA_EVENT_SNAP_BACK] = "snap-back",
      [DEA_EVENT_SLACK] = "loss of tension",
      [DEA_EVENT_BREAKDOWN] = "breakdown",
  };
  size_t count = 0, n = 0;
  for (size_t i = 0; i < result->curve_count; i++) {
    count += result->curves[i].event_count;
  }
  struct dea_series *series;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, count, &series));
  series->style = DEA_MARKERS;
  series->colour = DEA_BLACK;
  series->marker = 5 + (int)kind;
  snprintf(series->title, sizeof series->title, "%s", words[kind]);
  for (size_t i = 0; i < result->curve_count; i++) {
    for (size_t e = 0; e < result->curves[i].event_count; e++, n++) {
      const struct dea_event *event = &result->curves[i].events[e];
      const struct dea_load_point *p = &event->point;
      bool on_sweep =
          1e-3 * p->voltage_V <= panel->x_max && (p->stable || kind == DEA_EVENT_PULL_IN);
      if (event->kind == kind && (whole_path || on_sweep)) {
        series->values[n] = 1e-3 * p->voltage_V;
        series->values[count + n] = q->factor * (dea_point_get(p, q->column) + q->shift);
      }
    }
  }
  return DEA_OK;
}

dea_status dea_figure_add_events(struct dea_context *ctx, struct dea_panel *panel,
                                 const struct dea_result *result, int column, double factor,
                                 double shift, bool whole_path)
{
  const struct quantity q = {column, factor, shift};
  if (panel->series_count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, add_events_of(ctx, panel, result, DEA_EVENT_PULL_IN, &q, whole_path));
  DEA_TRY(ctx, add_events_of(ctx, panel, result, DEA_EVENT_SNAP_BACK, &q, whole_path));
  DEA_TRY(ctx, add_events_of(ctx, panel, result, DEA_EVENT_SLACK, &q, whole_path));
  return add_events_of(ctx, panel, result, DEA_EVENT_BREAKDOWN, &q, whole_path);
}

/* Display unit with its proper signs: "um" -> "µm". */
static void typeset_unit(const char *unit, char *out, size_t size)
{
  const char *u = strcmp(unit, "V/um") == 0 ? unit + 2 : unit[0] == 'u' ? unit : NULL;
  if (u != NULL) {
    snprintf(out, size, "%.*s\302\265%s", (int)(u - unit), unit, u + 1);
  } else {
    snprintf(out, size, "%s", unit);
  }
}

void dea_figure_label(const struct dea_column *column, char *out, size_t size)
{
  char unit[32], header[64];
  snprintf(header, sizeof header, "%s", column->header);
  if (header[0] >= 'a' && header[0] <= 'z' && header[1] != ' ') {
    header[0] = (char)(header[0] - 'a' + 'A');
  }
  typeset_unit(column->display_unit, unit, sizeof unit);
  if (strcmp(unit, "1") == 0) {
    snprintf(out, size, "%s", header);
  } else {
    snprintf(out, size, "%s (%s)", header, unit);
  }
}
