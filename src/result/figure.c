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

struct dea_series dea_figure_style(const char *name, size_t m)
{
  static const enum dea_colour order[] = {DEA_BLUE,   DEA_VERMILLION, DEA_GREEN, DEA_PURPLE,
                                          DEA_ORANGE, DEA_SKY,        DEA_BLACK};
  struct dea_series look = {
      .style = m == 0 ? DEA_LINE : DEA_LINE_MARKED,
      .colour = order[m % (sizeof order / sizeof order[0])],
      .marker = m > 0 ? (int)m - 1 : 0,
  };
  dea_label_escape(name, look.title, sizeof look.title);
  return look;
}

struct dea_series dea_figure_model_style(const char *model, size_t m)
{
  static const struct {
    const char *model;
    enum dea_series_style style;
    enum dea_colour colour;
    int marker;
  } known[] = {{"lumped", DEA_LINE, DEA_BLUE, 0},
               {"axisymmetric", DEA_LINE_MARKED, DEA_VERMILLION, 0},
               {"3d", DEA_LINE_MARKED, DEA_GREEN, 1}};
  struct dea_series look = dea_figure_style(model, m + 3); // after those that are known
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
    if (strcmp(model, known[i].model) == 0) {
      look.style = known[i].style;
      look.colour = known[i].colour;
      look.marker = known[i].marker;
    }
  }
  return look;
}

dea_status dea_figure_add_entry(struct dea_context *ctx, struct dea_panel *panel,
                                enum dea_series_style style, const char *title, double x, double y)
{
  struct dea_series *entry;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, 1, style, DEA_GREY, title, &entry));
  entry->values[0] = x;
  entry->values[1] = y;
  return DEA_OK;
}

/* Series of the points that are to be trusted, or that are not; where the two meet both have the
 * point of the dashed side's start, so that no gap opens. */
static dea_status add_part(struct dea_context *ctx, struct dea_panel *panel,
                           const struct dea_curve *curve, int column, double factor, double shift,
                           const struct dea_series *look, bool trusted)
{
  struct dea_series *series;
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, curve->count, look, &series));
  if (!trusted) {
    series->secondary = true;
    series->style = DEA_DASHED;
    series->title[0] = '\0';
  }
  const struct dea_load_point *p = curve->points;
  bool before = true;
  for (size_t i = 0; i < curve->count; i++) {
    bool here = dea_load_point_valid(&p[i]);
    bool after = i + 1 == curve->count || dea_load_point_valid(&p[i + 1]);
    series->values[i] = 1e-3 * p[i].voltage_V;
    if (trusted ? here : !(before && here && after)) {
      series->values[curve->count + i] = factor * (dea_point_get(&p[i], column) + shift);
    }
    before = here;
  }
  return DEA_OK;
}

/* About ten markers with the name of a curve that has no point to be trusted: what is dashed has
 * neither. */
static dea_status add_doubtful_markers(struct dea_context *ctx, struct dea_panel *panel,
                                       const struct dea_curve *curve, int column, double factor,
                                       double shift, const struct dea_series *look)
{
  struct dea_series *series;
  size_t every = curve->count / 10 > 1 ? curve->count / 10 : 1;
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, curve->count, look, &series));
  series->secondary = true;
  series->style = DEA_MARKERS;
  for (size_t i = 0; i < curve->count; i += every) {
    series->values[i] = 1e-3 * curve->points[i].voltage_V;
    series->values[curve->count + i] = factor * (dea_point_get(&curve->points[i], column) + shift);
  }
  return DEA_OK;
}

/* Band of the estimated error of a column, where it has one, below the curve. */
static dea_status add_error(struct dea_context *ctx, struct dea_panel *panel,
                            const struct dea_curve *curve, int column, double factor, double shift)
{
  int error = dea_point_error_column(ctx, column);
  size_t n = curve->count;
  struct dea_series *band;
  if (error < 0 || !dea_points_have(curve->points, n, error)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_panel_add(ctx, panel, n, DEA_BAND, DEA_GREY, "", &band));
  band->secondary = true;
  for (size_t i = 0; i < n; i++) {
    const struct dea_load_point *p = &curve->points[i];
    double value = factor * (dea_point_get(p, column) + shift);
    double half = fabs(factor) * dea_point_get(p, error);
    band->values[i] = 1e-3 * p->voltage_V;
    band->values[n + i] = value - half;
    band->values[2 * n + i] = value + half;
  }
  return DEA_OK;
}

/* Band of a standard uncertainty of a column to each side, where it is known, in the colour
 * of the curve and below it. */
static dea_status add_std(struct dea_context *ctx, struct dea_panel *panel,
                          const struct dea_curve *curve, int column, double factor, double shift,
                          const struct dea_series *look)
{
  static const double noise = 1e-12;
  size_t n = curve->count;
  struct dea_series *band;
  if (curve->std == NULL || !dea_points_have(curve->std, n, column)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_panel_add(ctx, panel, n, DEA_BAND, look->colour, "\302\261 1 std of the model",
                             &band));
  for (size_t s = 0; s + 1 < panel->series_count; s++) { // once for all
    if (strcmp(panel->series[s].title, band->title) == 0) {
      band->title[0] = '\0';
    }
  }
  double most = 0;
  for (size_t i = 0; i < n; i++) {
    most = fmax(most, fabs(factor * dea_point_get(&curve->points[i], column)));
  }
  for (size_t i = 0; i < n; i++) {
    double value = factor * (dea_point_get(&curve->points[i], column) + shift);
    double half = fabs(factor) * dea_point_get(&curve->std[i], column);
    half = half < noise * most ? 0 : half; // so that rounding moves no axis
    band->values[i] = 1e-3 * curve->points[i].voltage_V;
    band->values[n + i] = value - half;
    band->values[2 * n + i] = value + half;
  }
  return DEA_OK;
}

/* What a key says of the dashed parts of a panel that had `before`. */
static const char *dashed_words(const struct dea_curve *curve, const char *before)
{
  static const char unstable[] = "unstable", doubtful[] = "not to be trusted";
  const char *words = before;
  for (size_t i = 0; i < curve->count; i++) {
    if (!dea_load_point_valid(&curve->points[i])) {
      words = curve->points[i].stable || words == doubtful ? doubtful : unstable;
    }
  }
  return words;
}

dea_status dea_figure_add(struct dea_context *ctx, struct dea_panel *panel,
                          const struct dea_curve *curve, int column, double factor, double shift,
                          const struct dea_series *look)
{
  if (curve == NULL || !dea_points_have(curve->points, curve->count, column)) {
    return DEA_OK;
  }
  struct dea_series shown = *look;
  if (dea_figure_is_bound(curve, column)) {
    size_t n = strlen(shown.title);
    if (n > 0) {
      snprintf(shown.title + n, sizeof shown.title - n, " (upper bound)");
    }
    shown.style = DEA_DOTTED;
    shown.secondary = true;
  }
  DEA_TRY(ctx, add_std(ctx, panel, curve, column, factor, shift, &shown));
  DEA_TRY(ctx, add_error(ctx, panel, curve, column, factor, shift));
  DEA_TRY(ctx, add_part(ctx, panel, curve, column, factor, shift, &shown, true));
  size_t doubtful = 0;
  for (size_t i = 0; i < curve->count; i++) {
    doubtful += dea_load_point_valid(&curve->points[i]) ? 0 : 1;
  }
  if (doubtful == 0) {
    return DEA_OK;
  }
  panel->dashed = dashed_words(curve, panel->dashed);
  DEA_TRY(ctx, add_part(ctx, panel, curve, column, factor, shift, &shown, false));
  return doubtful < curve->count
             ? DEA_OK
             : add_doubtful_markers(ctx, panel, curve, column, factor, shift, &shown);
}

bool dea_figure_is_bound(const struct dea_curve *curve, int column)
{
  return curve != NULL && curve->count > 0 && dea_point_is_bound(&curve->points[0], column);
}

bool dea_figure_leaves_out(const struct dea_result *result, const struct dea_curve *curve,
                           int column)
{
  bool predicted = false;
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *other = &result->curves[i];
    predicted = predicted || (!dea_figure_is_bound(other, column) &&
                              dea_points_have(other->points, other->count, column));
  }
  return predicted && dea_figure_is_bound(curve, column);
}

dea_status dea_figure_add_models(struct dea_context *ctx, struct dea_panel *panel,
                                 const struct dea_result *result, int column, bool prefer_path)
{
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    struct dea_series look = dea_figure_model_style(models[m], m);
    const struct dea_curve *curve = dea_figure_curve(result, models[m], prefer_path);
    if (!dea_figure_leaves_out(result, curve, column)) {
      DEA_TRY(ctx, dea_figure_add(ctx, panel, curve, column, dea_point_columns[column].factor, 0.0,
                                  &look));
    }
  }
  return DEA_OK;
}

void dea_figure_sides(struct dea_panel *panel, const struct dea_profile_record *record)
{
  const struct dea_profile profile = dea_profile_of_record(record);
  double left = 0, right = 0;
  for (size_t i = 0; i < profile.count; i++) {
    double size = fabs(profile.displacement_m[i]);
    left = profile.radius_m[i] < 0 ? fmax(left, size) : left;
    right = profile.radius_m[i] > 0 ? fmax(right, size) : right;
  }
  if (profile.count > 0 && profile.radius_m[0] < 0 && fabs(left - right) > 1e-3 * right) {
    panel->sides[0] = "between fibres";
    panel->sides[1] = "along a fibre";
  }
}

/* What is drawn: factor * (member + shift). */
struct quantity {
  int column;
  double factor, shift;
};

/* First point beyond breakdown of a sweep whose model has no path to say it; NULL for none. */
static const struct dea_load_point *broken(const struct dea_result *result, size_t curve)
{
  const struct dea_curve *sweep = &result->curves[curve];
  if (strcmp(sweep->kind, "sweep") != 0 || dea_result_find(result, sweep->model, "path") != NULL) {
    return NULL;
  }
  for (size_t i = 0; i < sweep->count; i++) {
    if (!dea_load_point_safe(&sweep->points[i])) {
      return &sweep->points[i];
    }
  }
  return NULL;
}

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
    count += result->curves[i].event_count + 1;
  }
  struct dea_series *series;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, count, DEA_MARKERS, DEA_BLACK, "", &series));
  series->secondary = true; // they lie on curves
  series->marker = 5 + (int)kind;
  snprintf(series->title, sizeof series->title, "%s", words[kind]);
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_load_point *first = kind == DEA_EVENT_BREAKDOWN ? broken(result, i) : NULL;
    if (first != NULL) {
      series->values[n] = 1e-3 * first->voltage_V;
      series->values[count + n] = q->factor * (dea_point_get(first, q->column) + q->shift);
    }
    n++;
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

void dea_figure_unit(const char *unit, char out[DEA_COLUMN_UNIT_SIZE])
{
  const char *u = strcmp(unit, "V/um") == 0 ? unit + 2 : unit[0] == 'u' ? unit : NULL;
  if (u != NULL) {
    snprintf(out, DEA_COLUMN_UNIT_SIZE, "%.*s\302\265%s", (int)(u - unit), unit, u + 1);
  } else {
    snprintf(out, DEA_COLUMN_UNIT_SIZE, "%s", unit);
  }
}

void dea_figure_label(const struct dea_column *column, char *out, size_t size)
{
  char unit[DEA_COLUMN_UNIT_SIZE], header[DEA_LABEL_SIZE];
  snprintf(header, sizeof header, "%s", column->header);
  if (header[0] >= 'a' && header[0] <= 'z' && header[1] != ' ') {
    header[0] = (char)(header[0] - 'a' + 'A');
  }
  dea_figure_unit(column->display_unit, unit);
  char escaped[DEA_LABEL_SIZE];
  dea_label_escape(header, escaped, sizeof escaped); // names of monitors are any text
  if (strcmp(unit, "1") == 0) {
    snprintf(out, size, "%s", escaped);
  } else {
    snprintf(out, size, "%s (%s)", escaped, unit);
  }
}
