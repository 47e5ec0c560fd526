#include "plot/plot.h"

#include "base/write_file.h"
#include "plot/script.h"

#include <math.h>
#include <string.h>

// Data -------------------------------------------------------------------------------------------

/* A number, or what stands for one that is none. */
static void add_number(struct dea_text *out, double value, const char *otherwise)
{
  if (isfinite(value)) {
    dea_text_add(out, "%.10g", value);
  } else {
    dea_text_add(out, "%s", otherwise);
  }
}

static bool has_error(const struct dea_series *series)
{
  return series->style == DEA_ERROR_BARS || series->style == DEA_BAND;
}

static void add_block(struct dea_text *dat, size_t index, const struct dea_panel *panel,
                      const struct dea_series *series)
{
  dea_text_add(dat, "%s# index %zu: %s\n# %s | %s\n", index > 0 ? "\n\n" : "", index, series->title,
               panel->x_label, panel->y_label);
  for (size_t i = 0; i < series->count; i++) {
    for (size_t k = 0; k < (has_error(series) ? 3U : 2U); k++) {
      dea_text_add(dat, "%s", k > 0 ? " " : "");
      add_number(dat, series->values[k * series->count + i], "NaN");
    }
    dea_text_add(dat, "\n");
  }
}

static void add_data(struct dea_text *dat, const struct dea_plot *plot)
{
  size_t index = 0;
  for (size_t p = 0; p < plot->panel_count; p++) {
    for (size_t s = 0; s < plot->panels[p].series_count; s++) {
      if (dea_series_shows(&plot->panels[p].series[s])) {
        add_block(dat, index++, &plot->panels[p], &plot->panels[p].series[s]);
      }
    }
  }
}

// Script -----------------------------------------------------------------------------------------

static const char *const colours[] = {
    [DEA_BLUE] = "#0072B2",   [DEA_VERMILLION] = "#D55E00", [DEA_GREEN] = "#009E73",
    [DEA_PURPLE] = "#CC79A7", [DEA_ORANGE] = "#E69F00",     [DEA_SKY] = "#56B4E9",
    [DEA_BLACK] = "#000000",  [DEA_GREY] = "#707070",
};

/* Point types of gnuplot that look the same on all of its terminals: circle, square, triangles,
 * diamond; the first ones open, so that two curves that lie on each other both show. */
static const int markers[] = {6, 4, 8, 10, 12, 7, 5, 9, 11, 13};
enum { MARKER_COUNT = sizeof markers / sizeof markers[0] };

/* How gnuplot draws each style. */
static const struct {
  const char *with;
  double width;
  bool scales;      // with the width of the series
  const char *size; // of the markers; NULL: none
  const char *dash;
} looks[] = {
    [DEA_LINE] = {"lines", 1.5, true, NULL, ""},
    [DEA_THIN] = {"lines", 0.5, false, NULL, ""},
    [DEA_LINE_MARKED] = {"linespoints", 1.2, true, "0.6", ""},
    [DEA_DASHED] = {"lines", 1.2, true, NULL, " dt (8,5)"},
    [DEA_DOTTED] = {"lines", 1.4, false, NULL, " dt (2,2)"},
    [DEA_MARKERS] = {"points", 1.2, false, "0.7", ""},
    [DEA_ERROR_BARS] = {"yerrorbars", 1.0, false, "0.6", ""},
};

static void add_style(struct dea_text *gp, const struct dea_series *series)
{
  const char *colour = colours[series->colour];
  if (series->style == DEA_BAND) { // of colours two, and what lies below, show
    bool grey = series->colour == DEA_GREY;
    dea_text_add(gp, "with filledcurves fillstyle %s noborder lc rgb \"%s\"",
                 grey ? "solid" : "transparent solid 0.2", grey ? "#D9D9D9" : colour);
    return;
  }
  bool wide = looks[series->style].scales && series->width > 0;
  dea_text_add(gp, "with %s lw %.3g", looks[series->style].with,
               looks[series->style].width * (wide ? series->width : 1));
  if (looks[series->style].size != NULL) {
    dea_text_add(gp, " pt %d ps %s", markers[series->marker % MARKER_COUNT],
                 looks[series->style].size);
  }
  if (series->style == DEA_LINE_MARKED) {
    dea_text_add(gp, " pi %zu", series->count / 10 > 1 ? series->count / 10 : 1);
  }
  dea_text_add(gp, "%s lc rgb \"%s\"", looks[series->style].dash, colour);
}

/* Adds ` what "text"` for enhanced text that is escaped already. Some readers of SVG drop blanks at
 * the ends of a span, so a blank beside a change of font is kept from the end by one of no width.
 */
static void add_label(struct dea_text *gp, const char *what, const char *text)
{
  static const char guard[] = "\342\200\213"; // U+200B
  dea_text_add(gp, "%s \"", what);
  for (const char *c = text; *c != '\0'; c++) {
    bool after = *c == ' ' && c > text && c[-1] == '}', before = *c == ' ' && c[1] == '{';
    dea_text_add(gp, "%s%c%s", after ? guard : "", *c, before ? guard : "");
  }
  dea_text_add(gp, "\"");
}

static void add_series(struct dea_text *gp, const struct dea_series *series, size_t index,
                       bool first)
{
  // Without a given uncertainty the third column is NaN and only the point is drawn.
  const char *use = series->style == DEA_ERROR_BARS ? "1:2:(valid(3) ? $3 : 0)"
                    : series->style == DEA_BAND     ? "1:2:3"
                                                    : "1:2";
  dea_text_add(gp, "%s data index %zu using %s axes x1y1 ", first ? "  plot" : ", \\\n      ",
               index, use);
  add_style(gp, series);
  if (series->title[0] != '\0') {
    add_label(gp, " title", series->title);
  } else {
    dea_text_add(gp, " notitle");
  }
}

static void add_range(struct dea_text *gp, const char *axis, double from, double to)
{
  dea_text_add(gp, "  set %srange [", axis);
  add_number(gp, from, "*");
  dea_text_add(gp, ":");
  add_number(gp, to, "*");
  dea_text_add(gp, "]\n");
}

static void add_marks(struct dea_text *gp, const struct dea_panel *panel)
{
  for (size_t i = 0; i < panel->mark_count; i++) {
    const struct dea_mark *mark = &panel->marks[i];
    dea_text_add(gp,
                 "  set arrow from graph 0, first %.10g to graph 1, first %.10g nohead back "
                 "lw 0.8 dt (4,3) lc rgb \"%s\"\n"
                 "  set label \"%s\" at graph 0.02, first %.10g left offset char 0,0.5 "
                 "font small front\n",
                 mark->at, mark->at, colours[DEA_GREY], mark->text, mark->at);
  }
}

/* Lower and upper edge of a panel in mm above the figure's lower edge. */
struct layout {
  double width_mm, height_mm, left_mm, right_mm, bottom_mm[DEA_PLOT_PANELS_MAX],
      top_mm[DEA_PLOT_PANELS_MAX];
};

/* Digits before the point of a number of that size, which may be infinite, and behind it of tics
 * over such a span. */
static int digits_before(double size)
{
  static const double most = 9.0; // longer ones are written with an exponent
  double digits = size >= 1.0 ? floor(log10(1.2 * size)) + 1.0 : 1.0; // the last tic lies above
  return (int)fmin(digits, most);
}

static int digits_behind(double span)
{
  double power = span > 0.0 ? floor(log10(1.2 * span)) : 0.0;
  return power >= 0.0 ? 0 : (int)(1.0 - power); // 0.05 in steps of 0.005
}

/* Characters of the longest tic label of a panel's y axis, as "%h" writes round numbers. */
static int tic_length(const struct dea_panel *panel)
{
  double highest, lowest;
  dea_panel_range(panel, &lowest, &highest);
  highest = fmax(highest, panel->y_max); // NAN where the values decide
  lowest = fmin(lowest, panel->y_min);
  double largest = fmax(fabs(highest), fabs(lowest));
  int behind = digits_behind(highest - lowest);
  return digits_before(largest) + (behind > 0 ? 1 + behind : 0) + (lowest < 0.0);
}

static struct layout lay_out(const struct dea_plot *plot, double width_m)
{
  struct layout l = {.width_mm = 1e3 * width_m, .left_mm = 14.0};
  for (size_t p = 0; p < plot->panel_count; p++) {
    l.left_mm = fmax(l.left_mm, 14.0 + 1.6 * (fmin(tic_length(&plot->panels[p]), 9.0) - 4.0));
  }
  double panel = l.width_mm > 120.0 ? 0.50 * l.width_mm : 0.60 * l.width_mm;
  l.right_mm = l.width_mm - 3.5;
  l.bottom_mm[0] = 10.0;
  if (plot->panel_count == 2) {
    l.bottom_mm[1] = 10.0;
    l.top_mm[1] = l.bottom_mm[1] + panel * plot->second_height;
    l.bottom_mm[0] = l.top_mm[1] + 4.0; // so that the tic labels of the two do not meet
  }
  l.top_mm[0] = l.bottom_mm[0] + panel;
  const char *key = plot->panels[0].key;
  const char *rows = strstr(key, "maxrows ");
  int row_count = rows != NULL ? rows[strlen("maxrows ")] - '0' : 1;
  double key_mm = row_count > 2 ? 4.0 * row_count : row_count == 2 ? 9.5 : 7.0;
  l.height_mm = l.top_mm[0] + (strncmp(key, "above", 5) == 0 ? key_mm : 3.0);
  return l;
}

/* The key of a panel: in it, or in rows that begin below the figure's upper edge. gnuplot's own
 * place "above" lets rows run into the frame, since its terminals do not agree on their height. */
static void add_key(struct dea_text *gp, const struct dea_panel *panel, const struct layout *l)
{
  static const char above[] = "above";
  if (strncmp(panel->key, above, strlen(above)) == 0) {
    dea_text_add(gp, "  set key at screen 0.5, screen %.4f center top%s\n", 1 - 1 / l->height_mm,
                 panel->key + strlen(above));
  } else {
    dea_text_add(gp, "  set key %s%s\n", strncmp(panel->key, "at ", 3) == 0 ? "" : "inside ",
                 panel->key);
  }
}

/* 1, 2 and 5 of each decade, or of many decades 1 only: those in the range are drawn. */
static void add_log_tics(struct dea_text *gp, const char *axis, double low, double high)
{
  bool many = high > 300 * low;
  dea_text_add(gp, "  set %stics (", axis);
  for (int decade = -6; decade < 7; decade++) {
    double power = pow(10.0, decade);
    dea_text_add(gp, "%s%.10g", decade > -6 ? ", " : "", power);
    if (!many) {
      dea_text_add(gp, ", %.10g, %.10g", 2 * power, 5 * power);
    }
  }
  dea_text_add(gp, ")\n");
}

static void add_axes(struct dea_text *gp, const struct dea_panel *panel, bool has_x_label)
{
  add_range(gp, "x", panel->x_min, panel->x_max);
  add_range(gp, "y", panel->y_min, panel->y_max);
  if (has_x_label) {
    add_label(gp, "  set xlabel", panel->x_label);
    dea_text_add(gp, " offset 0,x_shift\n  set format x \"%%g\"\n");
  } else {
    dea_text_add(gp, "  unset xlabel\n  set format x \"\"\n");
  }
  dea_text_add(gp, "  set format y \"%s\"\n", panel->y_format != NULL ? panel->y_format : "%h");
  if (panel->logarithmic) {
    dea_text_add(gp, "  set logscale xy\n");
    add_log_tics(gp, "x", panel->x_min, panel->x_max);
    add_log_tics(gp, "y", panel->y_min, panel->y_max);
  } else if (panel->logarithmic_x) {
    dea_text_add(gp, "  unset logscale\n  set logscale x\n");
    add_log_tics(gp, "x", panel->x_min, panel->x_max);
    dea_text_add(gp, "  set ytics %.10g\n", panel->y_step);
  } else if (panel->y_step > 0.0) {
    dea_text_add(gp, "  set ytics %.10g\n", panel->y_step);
  } else {
    dea_text_add(gp, "  set ytics autofreq\n");
  }
  add_label(gp, "  set ylabel", panel->y_label);
  dea_text_add(gp, " offset y_shift,0\n  unset y2label\n  unset y2tics\n");
}

/* The line between two sections that meet at x = 0, and what they are. */
static void add_sides(struct dea_text *gp, const struct dea_panel *panel)
{
  if (panel->sides[0] == NULL) {
    return;
  }
  dea_text_add(gp,
               "  set arrow from first 0, graph 0 to first 0, graph 1 nohead back lw 0.8 "
               "lc rgb \"%s\"\n",
               colours[DEA_GREY]);
  for (int k = 0; k < 2; k++) {
    dea_text_add(gp, "  set label \"%s\" at graph %g, graph 0.06 %s font small front\n",
                 panel->sides[k], k == 0 ? 0.02 : 0.98, k == 0 ? "left" : "right");
  }
}

static void add_panel(struct dea_text *gp, const struct dea_plot *plot, size_t p,
                      const struct layout *l, size_t *index)
{
  const struct dea_panel *panel = &plot->panels[p];
  dea_text_add(gp, "  set bmargin at screen %.4f\n  set tmargin at screen %.4f\n",
               l->bottom_mm[p] / l->height_mm, l->top_mm[p] / l->height_mm);
  add_axes(gp, panel, p + 1 == plot->panel_count);
  add_key(gp, panel, l);
  dea_text_add(gp, "  unset arrow\n  unset label\n");
  add_marks(gp, panel);
  add_sides(gp, panel);
  bool first = true;
  for (size_t s = 0; s < panel->series_count; s++) {
    if (dea_series_shows(&panel->series[s])) {
      add_series(gp, &panel->series[s], (*index)++, first);
      first = false;
    }
  }
  if (first) {
    dea_text_add(gp, "  plot NaN notitle"); // an empty panel keeps its axes
  }
  if (panel->dashed != NULL) {
    dea_text_add(gp,
                 ", \\\n       keyentry with lines lw 1.2 dt (8,5) lc rgb \"%s\" "
                 "title \"%s\"",
                 colours[DEA_GREY], panel->dashed);
  }
  dea_text_add(gp, "\n");
}

static void add_script(struct dea_text *gp, const struct dea_plot *plot,
                       const struct dea_plot_format *format)
{
  struct layout l = lay_out(plot, format->width_m);
  dea_script_head(gp, plot->name, plot->caption, format, l.width_mm, l.height_mm);
  dea_text_add(gp, "set lmargin at screen %.4f\nset rmargin at screen %.4f\n\n",
               l.left_mm / l.width_mm, l.right_mm / l.width_mm);
  dea_script_terminals(gp);
  if (plot->panel_count > 1) {
    dea_text_add(gp, "  set multiplot\n");
  }
  size_t index = 0;
  for (size_t p = 0; p < plot->panel_count; p++) {
    add_panel(gp, plot, p, &l, &index);
  }
  if (plot->panel_count > 1) {
    dea_text_add(gp, "  unset multiplot\n");
  }
  dea_text_add(gp, "  unset output\n}\n");
}

dea_status dea_plot_write(struct dea_context *ctx, const struct dea_plot *plot,
                          const struct dea_plot_format *format, const char *directory)
{
  struct dea_text gp = {.ctx = ctx}, dat = {.ctx = ctx};
  add_script(&gp, plot, format);
  add_data(&dat, plot);
  return dea_script_write(directory, plot->name, &gp, &dat);
}
