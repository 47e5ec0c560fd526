#include "plot/plot_svg.h"

#include "base/html.h"
#include "plot/axis.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Measures of a drawing in its own units: about pixels. */
enum { WIDTH = 640, LEFT = 66, RIGHT = 18, TOP = 12, BOTTOM = 46, HEIGHT = 330 };

struct view {
  struct dea_axis x, y;
  double top, bottom, left, right;
};

/* Ranges of x and y; a band counts by its lower edge. */
static void find_ranges(const struct dea_panel *panel, struct dea_range *x, struct dea_range *y)
{
  const bool log_x = panel->logarithmic || panel->logarithmic_x;
  *x = *y = DEA_RANGE_EMPTY;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    for (size_t i = 0; i < series->count; i++) {
      double at_x = series->values[i], at_y = series->values[series->count + i];
      if (isfinite(at_y) && !(at_x > panel->x_max) && !(at_x < panel->x_min)) {
        dea_range_widen(x, log_x && !(at_x > 0) ? NAN : at_x);
        dea_range_widen(y, panel->logarithmic && !(at_y > 0) ? NAN : at_y);
      }
    }
  }
}

static struct view build_view(const struct dea_panel *panel, double top, double height)
{
  struct dea_range x, y;
  find_ranges(panel, &x, &y);
  double limits_x[2] = {panel->x_min, panel->x_max};
  bool logarithmic_x = panel->logarithmic || panel->logarithmic_x;
  if (!isfinite(panel->x_min) && !logarithmic_x) { // radii and voltages fill the width
    limits_x[0] = x.high >= x.low && x.high > x.low ? x.low : NAN;
    limits_x[1] = isfinite(panel->x_max) ? panel->x_max : x.high > x.low ? x.high : NAN;
  }
  if (!panel->logarithmic) { // without what is secondary
    dea_panel_range(panel, &y.low, &y.high);
  }
  const double floor_only[2] = {panel->y_min, NAN};
  struct view v = {
      .x = dea_axis_create(x.low, x.high, limits_x, logarithmic_x, 9),
      .y = dea_axis_create(y.low, y.high, floor_only, panel->logarithmic, 7),
      .top = top,
      .bottom = top + height,
      .left = LEFT,
      .right = WIDTH - RIGHT,
  };
  v.x.at_low = v.left;
  v.x.at_high = v.right;
  v.y.at_low = v.bottom;
  v.y.at_high = v.top;
  return v;
}

static void add_tic_label(struct dea_text *out, double x, double y, const char *anchor,
                          double value, double step)
{
  char number[32];
  value = fabs(value) < 1e-9 * step ? 0 : value;
  snprintf(number, sizeof number, "%.6g", value);
  dea_text_add(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s%s</text>", x, y, anchor,
               number[0] == '-' ? "\342\210\222" : "", number + (number[0] == '-'));
}

static void add_label(struct dea_text *out, double x, double y, const char *anchor,
                      const char *label)
{
  dea_text_add(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor);
  dea_html_label(out, label, DEA_LABEL_SVG);
  dea_text_add(out, "</text>");
}

static void add_axes(struct dea_text *out, const struct dea_panel *panel, const struct view *v,
                     bool last)
{
  double value;
  dea_text_add(out, "<g class=\"grid\"><path d=\"");
  for (int i = 0; dea_axis_tic(&v->x, i, &value); i++) {
    dea_text_add(out, "M%.1f %.1fV%.1f", dea_axis_place(&v->x, value), v->bottom, v->top);
  }
  for (int i = 0; dea_axis_tic(&v->y, i, &value); i++) {
    dea_text_add(out, "M%.1f %.1fH%.1f", v->left, dea_axis_place(&v->y, value), v->right);
  }
  dea_text_add(out, "\"/></g><g class=\"tics\">");
  for (int i = 0; last && dea_axis_tic(&v->x, i, &value); i++) {
    add_tic_label(out, dea_axis_place(&v->x, value), v->bottom + 18, "middle", value, v->x.step);
  }
  for (int i = 0; dea_axis_tic(&v->y, i, &value); i++) {
    add_tic_label(out, v->left - 8, dea_axis_place(&v->y, value) + 4, "end", value, v->y.step);
  }
  dea_text_add(out, "</g><g class=\"labels\">");
  if (last) {
    add_label(out, 0.5 * (v->left + v->right), v->bottom + 38, "middle", panel->x_label);
  }
  dea_text_add(out, "<text transform=\"translate(%.1f %.1f) rotate(-90)\" text-anchor=\"middle\">",
               16.0, 0.5 * (v->top + v->bottom));
  dea_html_label(out, panel->y_label, DEA_LABEL_SVG);
  dea_text_add(out, "</text>");
  dea_text_add(out, "</g>");
}

/* Whether a point can be drawn, and where. */
static bool place(const struct view *v, const struct dea_series *series, size_t i, size_t column,
                  double at[2])
{
  double x = series->values[i], y = series->values[column * series->count + i];
  if (!isfinite(x) || !isfinite(y) || (v->x.logarithmic && !(x > 0)) ||
      (v->y.logarithmic && !(y > 0))) {
    return false;
  }
  at[0] = dea_axis_place(&v->x, x);
  at[1] = fmax(v->top - 2000, fmin(v->bottom + 2000, dea_axis_place(&v->y, y)));
  return true;
}

static void add_line(struct dea_text *out, const struct view *v, const struct dea_series *series)
{
  bool pen = false;
  double at[2];
  dea_text_add(out, "<path class=\"line c%d%s\" d=\"", (int)series->colour,
               series->style == DEA_DASHED   ? " dashed"
               : series->style == DEA_DOTTED ? " dotted"
                                             : "");
  for (size_t i = 0; i < series->count; i++) {
    bool here = place(v, series, i, 1, at);
    if (here) {
      dea_text_add(out, "%s%.1f %.1f", pen ? "L" : "M", at[0], at[1]);
    }
    pen = here;
  }
  dea_text_add(out, "\"/>");
}

static void add_band(struct dea_text *out, const struct view *v, const struct dea_series *series)
{
  double at[2];
  bool first = true;
  dea_text_add(out, "<path class=\"band b%d\" d=\"", (int)series->colour);
  for (size_t k = 0; k < 2; k++) {
    for (size_t j = 0; j < series->count; j++) {
      if (place(v, series, k == 0 ? j : series->count - 1 - j, 1 + k, at)) {
        at[1] = k == 1 && series->to_top ? v->top : at[1];
        dea_text_add(out, "%s%.1f %.1f", first ? "M" : "L", at[0], at[1]);
        first = false;
      }
    }
  }
  dea_text_add(out, "%s\"/>", first ? "" : "Z");
}

/* Open shapes, so that two curves that lie on each other both show. */
static void add_marker(struct dea_text *out, int marker, double x, double y)
{
  switch (marker % 5) {
  case 0:
    dea_text_add(out, "M%.1f %.1fa3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0-7 0", x - 3.5, y);
    break;
  case 1:
    dea_text_add(out, "M%.1f %.1fh6.4v6.4h-6.4z", x - 3.2, y - 3.2);
    break;
  case 2:
    dea_text_add(out, "M%.1f %.1fl4.2 7.2h-8.4z", x, y - 4.6);
    break;
  case 3:
    dea_text_add(out, "M%.1f %.1fl4.2-7.2h-8.4z", x, y + 4.6);
    break;
  default:
    dea_text_add(out, "M%.1f %.1fl4.6 4.6-4.6 4.6-4.6-4.6z", x, y - 4.6);
  }
}

static void add_markers(struct dea_text *out, const struct view *v, const struct dea_series *series)
{
  bool sparse = series->style == DEA_LINE_MARKED;
  size_t every = sparse && series->count / 10 > 1 ? series->count / 10 : 1;
  double at[2];
  dea_text_add(out, "<path class=\"mark c%d%s\" d=\"", (int)series->colour,
               series->marker >= 5 ? " full" : "");
  for (size_t i = 0; i < series->count; i += every) {
    if (place(v, series, i, 1, at) && at[0] >= v->left - 1 && at[0] <= v->right + 1) {
      add_marker(out, series->marker, at[0], at[1]);
    }
  }
  if (series->style == DEA_ERROR_BARS) {
    for (size_t i = 0; i < series->count; i++) {
      double error = series->values[2 * series->count + i], y = series->values[series->count + i];
      if (place(v, series, i, 1, at) && isfinite(error)) {
        dea_text_add(out, "M%.1f %.1fV%.1f", at[0], dea_axis_place(&v->y, y - error),
                     dea_axis_place(&v->y, y + error));
      }
    }
  }
  dea_text_add(out, "\"/>");
}

static void add_series(struct dea_text *out, const struct view *v, const struct dea_series *series)
{
  if (series->style == DEA_BAND) {
    add_band(out, v, series);
    return;
  }
  if (series->style != DEA_MARKERS && series->style != DEA_ERROR_BARS) {
    add_line(out, v, series);
  }
  if (series->style == DEA_LINE_MARKED || series->style == DEA_MARKERS ||
      series->style == DEA_ERROR_BARS) {
    add_markers(out, v, series);
  }
}

static void add_marks(struct dea_text *out, const struct dea_panel *panel, const struct view *v)
{
  dea_text_add(out, "<g class=\"limits\">");
  if (panel->sides[0] != NULL) {
    dea_text_add(out, "<path d=\"M%.1f %.1fV%.1f\"/>", dea_axis_place(&v->x, 0), v->bottom, v->top);
  }
  for (int k = 0; panel->sides[0] != NULL && k < 2; k++) {
    add_label(out, k == 0 ? v->left + 6 : v->right - 6, v->bottom - 8, k == 0 ? "start" : "end",
              panel->sides[k]);
  }
  for (size_t i = 0; i < panel->mark_count; i++) {
    const struct dea_mark *mark = &panel->marks[i];
    double at = dea_axis_place(&v->y, mark->at);
    dea_text_add(out, "<path d=\"M%.1f %.1fH%.1f\"/><text x=\"%.1f\" y=\"%.1f\">", v->left, at,
                 v->right, v->left + 6, at - 4);
    dea_html_label(out, mark->text, DEA_LABEL_SVG);
    dea_text_add(out, "</text>");
  }
  dea_text_add(out, "</g>");
}

/* Whether the key has it already, for a panel above. */
static bool is_known(const struct dea_plot *plot, size_t panel, const struct dea_series *series)
{
  bool known = false;
  for (size_t p = 0; p < panel && !known; p++) {
    for (size_t s = 0; s < plot->panels[p].series_count && !known; s++) {
      const struct dea_series *other = &plot->panels[p].series[s];
      known = dea_series_shows(other) && other->style == series->style &&
              other->colour == series->colour && strcmp(other->title, series->title) == 0;
    }
  }
  return known;
}

static void add_key(struct dea_text *out, const struct dea_plot *plot)
{
  const char *dashed = NULL;
  dea_text_add(out, "<ul class=\"key\">");
  for (size_t p = 0; p < plot->panel_count; p++) {
    dashed = plot->panels[p].dashed != NULL ? plot->panels[p].dashed : dashed;
    for (size_t s = 0; s < plot->panels[p].series_count; s++) {
      const struct dea_series *series = &plot->panels[p].series[s];
      if (series->title[0] == '\0' || !dea_series_shows(series) || is_known(plot, p, series)) {
        continue;
      }
      dea_text_add(out, "<li><svg class=\"sample\" viewBox=\"0 0 28 14\" aria-hidden=\"true\">");
      bool line = series->style != DEA_MARKERS && series->style != DEA_ERROR_BARS;
      if (line && series->style != DEA_BAND) {
        dea_text_add(out, "<path class=\"line c%d%s\" d=\"M1 7H27\"/>", (int)series->colour,
                     series->style == DEA_DASHED   ? " dashed"
                     : series->style == DEA_DOTTED ? " dotted"
                                                   : "");
      }
      if (!line || series->style == DEA_LINE_MARKED) {
        dea_text_add(out, "<path class=\"mark c%d%s\" d=\"", (int)series->colour,
                     series->marker >= 5 ? " full" : "");
        add_marker(out, series->marker, 14, 7);
        dea_text_add(out, "\"/>");
      }
      dea_text_add(out, "</svg>");
      dea_html_label(out, series->title, DEA_LABEL_PLAIN);
      dea_text_add(out, "</li>");
    }
  }
  if (dashed != NULL) {
    dea_text_add(out,
                 "<li><svg class=\"sample\" viewBox=\"0 0 28 14\" aria-hidden=\"true\"><path "
                 "class=\"line c7 dashed\" d=\"M1 7H27\"/></svg>%s</li>",
                 dashed);
  }
  dea_text_add(out, "</ul>");
}

static void add_json_axis(struct dea_text *out, const char *name, const struct dea_axis *axis)
{
  dea_text_add(out, "\"%s\":[%.9g,%.9g,%.1f,%.1f,%d],", name, axis->low, axis->high, axis->at_low,
               axis->at_high, axis->logarithmic);
}

static void add_numbers(struct dea_text *out, const double *values, size_t count)
{
  dea_text_add(out, "[");
  for (size_t i = 0; i < count; i++) {
    dea_text_add(out, "%s", i > 0 ? "," : "");
    dea_html_json_number(out, values[i], 6);
  }
  dea_text_add(out, "]");
}

/* What the page's script needs to show values: axes and series of a panel. */
static void add_json(struct dea_text *out, const struct dea_panel *panel, const struct view *v)
{
  bool first = true;
  dea_text_add(out, "{");
  add_json_axis(out, "x", &v->x);
  add_json_axis(out, "y", &v->y);
  dea_text_add(out, "\"xl\":\"");
  dea_html_label(out, panel->x_label, DEA_LABEL_JSON);
  dea_text_add(out, "\",\"series\":[");
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    if (series->style == DEA_BAND || series->title[0] == '\0' || !dea_series_shows(series)) {
      continue;
    }
    dea_text_add(out, "%s{\"t\":\"", first ? "" : ",");
    dea_html_label(out, series->title, DEA_LABEL_JSON);
    dea_text_add(out, "\",\"c\":%d,\"p\":%d,\"v\":[", (int)series->colour,
                 series->style == DEA_MARKERS || series->style == DEA_ERROR_BARS);
    add_numbers(out, series->values, series->count);
    dea_text_add(out, ",");
    add_numbers(out, series->values + series->count, series->count);
    dea_text_add(out, "]}");
    first = false;
  }
  dea_text_add(out, "]}");
}

static void add_panel(struct dea_text *out, const struct dea_panel *panel, const struct view *v,
                      int number, size_t p, bool last)
{
  dea_text_add(out,
               "<clipPath id=\"clip%d-%zu\"><rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" "
               "height=\"%.1f\"/></clipPath>",
               number, p, v->left, v->top, v->right - v->left, v->bottom - v->top);
  add_axes(out, panel, v, last);
  dea_text_add(out, "<g clip-path=\"url(#clip%d-%zu)\">", number, p);
  for (int bands = 1; bands >= 0; bands--) { // what is filled lies below
    for (size_t s = 0; s < panel->series_count; s++) {
      if ((panel->series[s].style == DEA_BAND) == (bands == 1) &&
          dea_series_shows(&panel->series[s])) {
        add_series(out, v, &panel->series[s]);
      }
    }
  }
  add_marks(out, panel, v);
  dea_text_add(out, "</g><path class=\"frame\" d=\"M%.1f %.1fV%.1fH%.1f\"/>", v->left, v->top,
               v->bottom, v->right);
}

void dea_plot_add_svg(struct dea_text *out, const struct dea_plot *plot, int number)
{
  if (!dea_plot_shows(plot)) {
    return;
  }
  struct view views[DEA_PLOT_PANELS_MAX];
  double height = TOP;
  for (size_t p = 0; p < plot->panel_count; p++) {
    double own = p == 0 ? HEIGHT : HEIGHT * plot->second_height;
    views[p] = build_view(&plot->panels[p], height, own);
    if (p > 0) { // one x axis for both
      views[p].x = views[0].x;
    }
    height += own + (p + 1 < plot->panel_count ? 16 : BOTTOM);
  }
  dea_text_add(
      out,
      "<figure class=\"plot\" id=\"figure-%d\"><svg class=\"chart\" viewBox=\"0 0 %d %.0f\" "
      "role=\"img\" aria-labelledby=\"caption-%d\">",
      number, WIDTH, height, number);
  for (size_t p = 0; p < plot->panel_count; p++) {
    add_panel(out, &plot->panels[p], &views[p], number, p, p + 1 == plot->panel_count);
  }
  dea_text_add(out, "</svg>");
  add_key(out, plot);
  dea_text_add(out, "<figcaption id=\"caption-%d\">", number);
  dea_html_text(out, plot->caption);
  dea_text_add(out, "</figcaption><script type=\"application/json\" class=\"numbers\">[");
  for (size_t p = 0; p < plot->panel_count; p++) {
    dea_text_add(out, "%s", p > 0 ? "," : "");
    add_json(out, &plot->panels[p], &views[p]);
  }
  dea_text_add(out, "]</script></figure>");
}
