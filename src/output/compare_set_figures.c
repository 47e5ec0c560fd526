/* The figures of several curves beside one reference (see compare_set.h). */
#include "output/compare_set.h"
#include "output/figure.h"
#include "output/file.h"
#include "output/gnuplot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAMES_MAX = DEA_LOAD_POINT_COLUMNS + DEA_MEASURED_COLUMNS + 1, NAME_SIZE = 64 };

static const char band_title[] = "\302\261 1 std";

/* What is drawn so far. */
struct figures {
  struct dea_context *ctx;
  const struct dea_compare_set *set;
  const struct dea_plot_format *format;
  const char *directory;
  char names[NAMES_MAX][NAME_SIZE];
  size_t count;
};

/* A new plot of that name, to be filled and given to finish. */
static dea_status begin(struct figures *f, const char *name, const char *what,
                        struct dea_plot **plot)
{
  char caption[2 * DEA_LABEL_SIZE];
  snprintf(caption, sizeof caption, "%s, beside %s", what, f->set->reference);
  return dea_plot_create(f->ctx, name, caption, plot);
}

static dea_status finish(struct figures *f, struct dea_plot *plot, dea_status status)
{
  if (status == DEA_OK && dea_plot_shows(plot) && f->count < NAMES_MAX) {
    snprintf(f->names[f->count++], NAME_SIZE, "%s", plot->name);
    status = dea_plot_write(f->ctx, plot, f->format, f->directory);
  }
  dea_plot_destroy(f->ctx, plot);
  return status;
}

/* Look of a curve, the same in all figures. */
static struct dea_series look_of(const struct dea_compare_set *set, size_t curve)
{
  return dea_figure_look(set->curves[curve].name, curve);
}

/* Vertical range: that of the panel's series with their bands, and a little more. */
static void set_range(struct dea_panel *panel)
{
  double low = INFINITY, high = -INFINITY;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    for (size_t i = 0; i < series->count; i++) {
      double y = series->values[series->count + i], error = series->values[2 * series->count + i];
      error = series->style == DEA_BAND ? error : series->style == DEA_ERROR_BARS ? y + error : y;
      low = isfinite(y) ? fmin(low, y) : low;
      high = isfinite(y) ? fmax(high, fmax(y, error)) : high;
    }
  }
  if (high > low) {
    panel->y_min = low < 0.0 || low > 0.2 * high ? low - 0.05 * (high - low) : 0.0;
    panel->y_max = high + 0.05 * (high - low);
  }
}

/* Puts the key above the panel in as many columns as its titles leave room for. */
static void place_key_above(const struct figures *f, struct dea_panel *panel)
{
  static const char *const keys[] = {
#define KEY_ROWS(rows) "above horizontal maxrows " #rows " samplen 1.5 width key_width"
      KEY_ROWS(1), KEY_ROWS(2), KEY_ROWS(3), KEY_ROWS(4), KEY_ROWS(5),
      KEY_ROWS(6), KEY_ROWS(7), KEY_ROWS(8), KEY_ROWS(9),
#undef KEY_ROWS
  };
  enum { ROWS_MAX = sizeof keys / sizeof keys[0] };
  const double letter_mm = 1.4, sample_mm = 9.0, axis_mm = 20.0;
  size_t entries = 0, longest = 1;
  for (size_t s = 0; s < panel->series_count; s++) {
    size_t length = strlen(panel->series[s].title);
    entries += length > 0;
    longest = length > longest ? length : longest;
  }
  double room_mm = 1e3 * f->format->width_m - axis_mm;
  double columns = fmax(floor(room_mm / (letter_mm * (double)longest + sample_mm)), 1.0);
  double rows = fmin(ceil((double)entries / columns), ROWS_MAX);
  panel->key = keys[rows > 1.0 ? (size_t)rows - 1 : 0];
}

// Against the voltage -----------------------------------------------------------------------------

/* Whether the measured points can carry a band: voltages rise, and each has its uncertainty. */
static bool carries_band(const struct dea_measurement *m, int column)
{
  double last = -INFINITY;
  size_t count = 0;
  for (size_t i = 0; i < m->curve.count; i++) {
    if (!isnan(dea_point_get(&m->curve.points[i], column))) {
      double v = m->curve.points[i].voltage_V;
      if (!(v > last) || isnan(dea_point_get(&m->std[i], column))) {
        return false;
      }
      last = v;
      count++;
    }
  }
  return count > 1;
}

static bool has_std(const struct dea_measurement *m, int column)
{
  return dea_points_have(m->std, m->curve.count, column);
}

/* Measured points; below them their band, to be added first. */
static dea_status add_measured(struct dea_context *ctx, struct dea_panel *panel,
                               const struct dea_measurement *m, int column, bool band)
{
  struct dea_series *series;
  bool bars = !band && has_std(m, column) && !carries_band(m, column);
  double factor = dea_point_columns[column].factor;
  size_t n = 0;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, m->curve.count, &series));
  series->style = band ? DEA_BAND : bars ? DEA_ERROR_BARS : DEA_MARKERS;
  series->colour = band ? DEA_GREY : DEA_BLACK;
  series->marker = 5;
  snprintf(series->title, sizeof series->title, "%s%s%s", band ? "" : "measured", bars ? ", " : "",
           band || bars ? band_title : "");
  for (size_t i = 0; i < m->curve.count; i++) {
    double value = factor * dea_point_get(&m->curve.points[i], column);
    double std = factor * dea_point_get(&m->std[i], column);
    if (!isnan(value)) { // without gaps, which would part a band
      series->values[n] = 1e-3 * m->curve.points[i].voltage_V;
      series->values[series->count + n] = band ? value - std : value;
      series->values[2 * series->count + n++] = band ? value + std : std;
    }
  }
  return DEA_OK;
}

/* The curves of a reference run, each once. */
static dea_status add_reference(struct dea_context *ctx, struct dea_panel *panel,
                                const struct dea_compare_set *set, int column)
{
  for (size_t i = 0; i < set->curve_count; i++) {
    const struct dea_curve *reference = set->curves[i].reference;
    struct dea_series look = {.style = DEA_LINE_MARKED, .colour = DEA_BLACK, .marker = 5 + (int)i};
    char title[DEA_LABEL_SIZE];
    bool seen = false;
    for (size_t k = 0; k < i; k++) {
      seen = seen || set->curves[k].reference == reference;
    }
    snprintf(title, sizeof title, "%.60s, %.60s", set->reference, reference->model);
    dea_label_escape(title, look.title, sizeof look.title);
    if (!seen) {
      DEA_TRY(ctx, dea_figure_add(ctx, panel, reference, column, dea_point_columns[column].factor,
                                  0.0, &look));
    }
  }
  return DEA_OK;
}

static dea_status fill_quantity(struct figures *f, int column, struct dea_panel *panel)
{
  const struct dea_compare_set *set = f->set;
  const struct dea_measurement *m = set->measured != NULL ? set->measured->points : NULL;
  if (m != NULL && carries_band(m, column)) {
    DEA_TRY(f->ctx, add_measured(f->ctx, panel, m, column, true));
  }
  for (size_t i = 0; i < set->curve_count; i++) {
    struct dea_series look = look_of(set, i);
    DEA_TRY(f->ctx, dea_figure_add(f->ctx, panel, set->curves[i].curve, column,
                                   dea_point_columns[column].factor, 0.0, &look));
  }
  DEA_TRY(f->ctx, m != NULL ? add_measured(f->ctx, panel, m, column, false)
                            : add_reference(f->ctx, panel, set, column));
  dea_figure_label(&dea_point_columns[column], panel->y_label, sizeof panel->y_label);
  dea_figure_voltage_axis(panel);
  dea_figure_even_tics(panel, 7);
  set_range(panel);
  dea_figure_place_key(panel);
  return DEA_OK;
}

/* Whether some curve was compared in that quantity. */
static bool was_compared(const struct dea_compare_set *set, int column)
{
  for (size_t i = 0; i < set->curve_count; i++) {
    const struct dea_comparison *c = set->curves[i].comparison;
    for (size_t k = 0; c != NULL && k < c->misfit_count; k++) {
      if (c->misfits[k].column == column) {
        return true;
      }
    }
  }
  return false;
}

static dea_status draw_quantities(struct figures *f)
{
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    struct dea_plot *plot;
    char name[NAME_SIZE];
    if (was_compared(f->set, c)) {
      snprintf(name, sizeof name, "compare_%s", dea_point_columns[c].key);
      DEA_TRY(f->ctx, begin(f, name, dea_point_columns[c].header, &plot));
      DEA_TRY(f->ctx, finish(f, plot, fill_quantity(f, c, &plot->panels[0])));
    }
  }
  return DEA_OK;
}

// Profile -----------------------------------------------------------------------------------------

/* The measured profile at the largest voltage that has a computed one beside it. */
static const struct dea_measured_profile *largest_profile(const struct dea_compare_set *set,
                                                          size_t *index)
{
  const struct dea_measured_profile *largest = NULL;
  for (size_t i = 0; i < set->profile_count; i++) {
    const struct dea_measured_profile *m = &set->measured->profiles[set->profiles[i].measured];
    if (largest == NULL || fabs(m->voltage_V) > fabs(largest->voltage_V)) {
      largest = m;
      *index = set->profiles[i].measured;
    }
  }
  return largest;
}

/* Measured mean, or the band about it. */
static dea_status add_profile(struct dea_context *ctx, struct dea_panel *panel,
                              const struct dea_measured_profile *m, bool band)
{
  struct dea_series *series;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, m->count, &series));
  series->style = band ? DEA_BAND : DEA_LINE;
  series->colour = band ? DEA_GREY : DEA_BLACK;
  snprintf(series->title, sizeof series->title, "%s", band ? band_title : "measured");
  for (size_t i = 0; i < m->count; i++) {
    double std = band ? m->z_std_m[i] : 0.0;
    series->values[i] = 1e3 * m->x_m[i];
    series->values[m->count + i] = 1e6 * (m->z_m[i] - std);
    series->values[2 * m->count + i] = 1e6 * (m->z_m[i] + std);
  }
  return DEA_OK;
}

/* A model's line on both sides of the centre. */
static dea_status add_line(struct figures *f, struct dea_panel *panel,
                           const struct dea_set_profile *p)
{
  const struct dea_film_line *line = &p->line;
  struct dea_series *series, look = look_of(f->set, p->curve);
  size_t n = line->count;
  look.style = p->half == DEA_HALF_FIBRE ? DEA_LINE : DEA_DASHED;
  if (p->half == DEA_HALF_BETWEEN) {
    look.title[0] = '\0'; // one entry of the key for all
  }
  DEA_TRY(f->ctx, dea_panel_add_as(f->ctx, panel, 2 * n, &look, &series));
  for (size_t i = 0; i < 2 * n; i++) {
    size_t k = i < n ? n - 1 - i : i - n;
    series->values[i] = (i < n ? -1e3 : 1e3) * line->x_m[k];
    series->values[2 * n + i] = 1e6 * line->z_m[k];
  }
  return DEA_OK;
}

/* Entries of the key: which line is which half. Their one point is the film's edge. */
static dea_status add_halves(struct figures *f, struct dea_panel *panel, double film_m)
{
  for (int half = 0; half < DEA_HALVES; half++) {
    struct dea_series *entry;
    DEA_TRY(f->ctx, dea_panel_add(f->ctx, panel, 1, &entry));
    entry->style = half == DEA_HALF_FIBRE ? DEA_LINE : DEA_DASHED;
    entry->colour = DEA_GREY;
    snprintf(entry->title, sizeof entry->title, "%s", dea_half_names[half]);
    entry->values[0] = 1e3 * film_m;
    entry->values[1] = 0.0;
  }
  return DEA_OK;
}

static dea_status fill_profile(struct figures *f, const struct dea_measured_profile *m,
                               size_t index, struct dea_panel *panel)
{
  double film_m = 0.0;
  bool directed = false;
  if (m->z_std_m != NULL) {
    DEA_TRY(f->ctx, add_profile(f->ctx, panel, m, true));
  }
  DEA_TRY(f->ctx, add_profile(f->ctx, panel, m, false));
  for (size_t i = 0; i < f->set->profile_count; i++) {
    const struct dea_set_profile *p = &f->set->profiles[i];
    if (p->measured == index) {
      DEA_TRY(f->ctx, add_line(f, panel, p));
      film_m = fmax(film_m, p->line.x_m[p->line.count - 1]);
      directed = directed || p->line.directed;
    }
  }
  if (directed) {
    DEA_TRY(f->ctx, add_halves(f, panel, film_m));
  }
  panel->x_min = -1.1e3 * film_m; // with the beginning of the frame
  panel->x_max = 1.1e3 * film_m;
  snprintf(panel->x_label, sizeof panel->x_label, "Place across the film {/:Italic x} (mm)");
  snprintf(panel->y_label, sizeof panel->y_label, "{/:Italic z} at %.4g kV (\302\265m)",
           1e-3 * m->voltage_V);
  place_key_above(f, panel);
  dea_figure_even_tics(panel, 7);
  set_range(panel);
  return DEA_OK;
}

static dea_status draw_profile(struct figures *f)
{
  struct dea_plot *plot;
  size_t index = 0;
  const struct dea_measured_profile *m = largest_profile(f->set, &index);
  if (m == NULL) {
    return DEA_OK;
  }
  DEA_TRY(f->ctx, begin(f, "compare_profile", "profile across the film", &plot));
  return finish(f, plot, fill_profile(f, m, index, &plot->panels[0]));
}

// Histories ---------------------------------------------------------------------------------------

enum { FEW = 800, DRAWN_MAX = 4000 };

/* Adds values against time within [from, to]; of many the smallest and largest of each stretch, so
 * that no peak is lost and no file becomes large. */
static dea_status add_track(struct dea_context *ctx, struct dea_panel *panel, const double *time,
                            const double *values, size_t count, const double span[2],
                            const struct dea_series *look)
{
  struct dea_series *series;
  size_t first = 0, last = count;
  while (first < count && !(time[first] >= span[0])) {
    first++;
  }
  while (last > first && !(time[last - 1] <= span[1])) {
    last--;
  }
  size_t stretch = (last - first) / (DRAWN_MAX / 2) + 1;
  size_t room = stretch == 1 ? last - first : 2 * ((last - first) / stretch + 1), n = 0;
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, room, look, &series));
  series->style = room > FEW && look->style == DEA_LINE ? DEA_THIN : look->style;
  for (size_t i = first; i < last; i += stretch) {
    size_t end = i + stretch < last ? i + stretch : last, low = i, high = i;
    for (size_t k = i; k < end; k++) {
      low = values[k] < values[low] || isnan(values[low]) ? k : low;
      high = values[k] > values[high] || isnan(values[high]) ? k : high;
    }
    size_t shown[2] = {low < high ? low : high, low < high ? high : low};
    for (size_t k = 0; k < (stretch == 1 ? 1U : 2U); k++) {
      series->values[n] = time[shown[k]];
      series->values[room + n++] = values[shown[k]];
    }
  }
  return DEA_OK;
}

/* A column of a history computed, on the measured clock. */
static dea_status add_computed(struct figures *f, struct dea_panel *panel,
                               const struct dea_set_history *h, int column, const double span[2])
{
  struct dea_context *ctx = f->ctx;
  size_t n = h->transient->count;
  double *time = dea_alloc(ctx, n, sizeof *time), *values = dea_alloc(ctx, n, sizeof *values);
  struct dea_series look = look_of(f->set, h->curve);
  dea_status status = time != NULL && values != NULL ? DEA_OK : DEA_E_MEMORY;
  for (size_t i = 0; status == DEA_OK && i < n; i++) {
    time[i] = h->transient->points[i].time_s + h->clock.shift_s;
    values[i] = dea_point_columns[column].factor * dea_point_get(&h->transient->points[i], column);
  }
  look.style = h->curve % 2 == 0 ? DEA_LINE : DEA_DASHED;
  if (status == DEA_OK) {
    status = add_track(ctx, panel, time, values, n, span, &look);
  }
  dea_free(ctx, time);
  dea_free(ctx, values);
  return status;
}

static dea_status add_recorded(struct figures *f, struct dea_panel *panel,
                               enum dea_measured_column column, const double span[2])
{
  const struct dea_csv_columns *history = &f->set->measured->history;
  struct dea_series look = {.style = DEA_LINE, .colour = DEA_BLACK, .title = "measured"};
  double *values = dea_alloc(f->ctx, history->rows, sizeof *values);
  if (values == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t i = 0; i < history->rows; i++) {
    values[i] =
        dea_point_columns[dea_measured_point_column(column)].factor * history->values[column][i];
  }
  dea_status status = add_track(f->ctx, panel, history->values[DEA_MEASURED_TIME], values,
                                history->rows, span, &look);
  dea_free(f->ctx, values);
  return status;
}

/* Times that both have, and a little more. */
static void find_span(const struct dea_compare_set *set, enum dea_measured_column column,
                      double span[2])
{
  span[0] = INFINITY;
  span[1] = -INFINITY;
  for (size_t i = 0; i < set->history_count; i++) {
    const struct dea_misfit *m = &set->histories[i].misfit;
    if (set->histories[i].column == column) {
      span[0] = fmin(span[0], m->at[0]);
      span[1] = fmax(span[1], m->at[m->count - 1]);
    }
  }
  double more = 0.02 * (span[1] - span[0]);
  span[0] -= more;
  span[1] += more;
}

static dea_status fill_history(struct figures *f, enum dea_measured_column column,
                               const double span[2], struct dea_plot *plot)
{
  const struct dea_compare_set *set = f->set;
  bool has_voltage = set->measured->history.values[DEA_MEASURED_VOLTAGE] != NULL;
  plot->panel_count = has_voltage ? 2 : 1;
  plot->second_height = 1.0;
  for (size_t p = 0; p < plot->panel_count; p++) {
    struct dea_panel *panel = &plot->panels[p];
    enum dea_measured_column shown = p + 1 < plot->panel_count ? DEA_MEASURED_VOLTAGE : column;
    int of_point = dea_measured_point_column(shown);
    DEA_TRY(f->ctx, add_recorded(f, panel, shown, span));
    for (size_t i = 0; i < set->history_count; i++) {
      if (set->histories[i].column == column) {
        DEA_TRY(f->ctx, add_computed(f, panel, &set->histories[i], of_point, span));
      }
    }
    for (size_t s = 0; s < panel->series_count && p > 0; s++) {
      panel->series[s].title[0] = '\0'; // the key above holds for both
    }
    panel->x_min = span[0];
    panel->x_max = span[1];
    snprintf(panel->x_label, sizeof panel->x_label, "Time {/:Italic t} (s)");
    dea_figure_label(&dea_point_columns[of_point], panel->y_label, sizeof panel->y_label);
    dea_figure_even_tics(panel, 5);
    set_range(panel);
    place_key_above(f, panel);
  }
  return DEA_OK;
}

static dea_status draw_histories(struct figures *f)
{
  for (int k = DEA_MEASURED_CENTRE; k < DEA_MEASURED_COLUMNS; k++) {
    double span[2];
    struct dea_plot *plot;
    char name[NAME_SIZE];
    find_span(f->set, (enum dea_measured_column)k, span);
    if (span[1] > span[0]) {
      const struct dea_column *c =
          &dea_point_columns[dea_measured_point_column((enum dea_measured_column)k)];
      snprintf(name, sizeof name, "compare_history_%s", c->key);
      DEA_TRY(f->ctx, begin(f, name, "history", &plot));
      DEA_TRY(f->ctx, finish(f, plot, fill_history(f, (enum dea_measured_column)k, span, plot)));
    }
  }
  return DEA_OK;
}

dea_status dea_compare_set_draw(struct dea_context *ctx, const struct dea_compare_set *set,
                                const struct dea_plot_format *format, const char *directory)
{
  struct figures *f = dea_alloc(ctx, 1, sizeof *f);
  const char *names[NAMES_MAX];
  if (f == NULL) {
    return DEA_E_MEMORY;
  }
  *f = (struct figures){.ctx = ctx, .set = set, .format = format, .directory = directory};
  dea_status status = dea_folder_make(ctx, directory);
  status = status == DEA_OK ? draw_quantities(f) : status;
  status = status == DEA_OK ? draw_profile(f) : status;
  status = status == DEA_OK ? draw_histories(f) : status;
  for (size_t i = 0; i < f->count; i++) {
    names[i] = f->names[i];
  }
  if (status == DEA_OK && (format->svg || format->pdf || format->png)) {
    status = dea_gnuplot_draw(ctx, directory, names, f->count);
  }
  dea_free(ctx, f);
  return status;
}
