/* The figures of several curves beside one reference (see compare_set.h). */
#include "base/write_file.h"
#include "compare/compare_set.h"
#include "plot/gnuplot.h"
#include "result/figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DEA_SET_FIGURE_SIZE = 192 };

/* What is drawn so far. */
struct dea_set_figures {
  struct dea_context *ctx;
  const struct dea_compare_set *set;
  const struct dea_plot_format *format;
  const char *directory;
  char (*names)[DEA_SET_FIGURE_SIZE]; // [room]
  size_t count, capacity;
};

static const char band_title[] = "\302\261 1 std";

static dea_status begin_figure(struct dea_set_figures *f, const char *name, const char *what,
                               struct dea_plot **plot)
{
  char caption[2 * DEA_LABEL_SIZE];
  snprintf(caption, sizeof caption, "%s, beside %s", what, f->set->reference);
  return dea_plot_create(f->ctx, name, caption, plot);
}

/* "compare_hub_z_m_3d": names of monitors are of any letters. model: "" for none. */
static void name_figure(const struct dea_column *quantity, const char *model,
                        char out[DEA_SET_FIGURE_SIZE])
{
  snprintf(out, DEA_SET_FIGURE_SIZE, "compare_%s%s%.30s", quantity->key,
           model[0] != '\0' ? "_" : "", model);
  for (char *at = out; *at != '\0'; at++) {
    bool plain = (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z') ||
                 (*at >= '0' && *at <= '9') || *at == '-';
    *at = plain ? *at : '_';
  }
}

static dea_status finish_figure(struct dea_set_figures *f, struct dea_plot *plot, dea_status status)
{
  if (status == DEA_OK && dea_plot_shows(plot) && f->count < f->capacity) {
    snprintf(f->names[f->count++], DEA_SET_FIGURE_SIZE, "%s", plot->name);
    status = dea_plot_write(f->ctx, plot, f->format, f->directory);
  }
  dea_plot_destroy(f->ctx, plot);
  return status;
}

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

static void set_key_above(const struct dea_set_figures *f, struct dea_panel *panel)
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
  double factor = dea_column_at(ctx, column)->factor;
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
      DEA_TRY(ctx, dea_figure_add(ctx, panel, reference, column, dea_column_at(ctx, column)->factor,
                                  0.0, &look));
    }
  }
  return DEA_OK;
}

static dea_status fill_quantity(struct dea_set_figures *f, int column, struct dea_panel *panel)
{
  const struct dea_compare_set *set = f->set;
  const struct dea_measurement *m = set->measured != NULL ? set->measured->points : NULL;
  if (m != NULL && carries_band(m, column)) {
    DEA_TRY(f->ctx, add_measured(f->ctx, panel, m, column, true));
  }
  for (size_t i = 0; i < set->curve_count; i++) {
    struct dea_series look = dea_figure_style(set->curves[i].name, i);
    DEA_TRY(f->ctx, dea_figure_add(f->ctx, panel, set->curves[i].curve, column,
                                   dea_column_at(f->ctx, column)->factor, 0.0, &look));
  }
  DEA_TRY(f->ctx, m != NULL ? add_measured(f->ctx, panel, m, column, false)
                            : add_reference(f->ctx, panel, set, column));
  dea_figure_label(dea_column_at(f->ctx, column), panel->y_label, sizeof panel->y_label);
  dea_panel_voltage_axis(panel);
  set_range(panel);
  dea_panel_even_tics(panel, 7);
  dea_panel_place_key(panel);
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

static dea_status draw_quantities(struct dea_set_figures *f)
{
  for (int c = 0; c < dea_column_count(f->ctx); c++) {
    const struct dea_column *column = dea_column_at(f->ctx, c);
    struct dea_plot *plot;
    char name[DEA_SET_FIGURE_SIZE];
    if (was_compared(f->set, c)) {
      name_figure(column, "", name);
      DEA_TRY(f->ctx, begin_figure(f, name, column->header, &plot));
      DEA_TRY(f->ctx, finish_figure(f, plot, fill_quantity(f, c, &plot->panels[0])));
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
static dea_status add_line(struct dea_set_figures *f, struct dea_panel *panel,
                           const struct dea_set_profile *p)
{
  const struct dea_film_line *line = &p->line;
  struct dea_series *series, look = dea_figure_style(f->set->curves[p->curve].name, p->curve);
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
static dea_status add_halves(struct dea_set_figures *f, struct dea_panel *panel, double film_m)
{
  for (int half = 0; half < DEA_HALVES; half++) {
    DEA_TRY(f->ctx,
            dea_figure_add_entry(f->ctx, panel, half == DEA_HALF_FIBRE ? DEA_LINE : DEA_DASHED,
                                 dea_half_names[half], 1e3 * film_m, 0.0));
  }
  return DEA_OK;
}

static dea_status fill_profile(struct dea_set_figures *f, const struct dea_measured_profile *m,
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
  set_key_above(f, panel);
  set_range(panel);
  dea_panel_even_tics(panel, 7);
  return DEA_OK;
}

static dea_status draw_profile(struct dea_set_figures *f)
{
  struct dea_plot *plot;
  size_t index = 0;
  const struct dea_measured_profile *m = largest_profile(f->set, &index);
  if (m == NULL) {
    return DEA_OK;
  }
  DEA_TRY(f->ctx, begin_figure(f, "compare_profile", "profile across the film", &plot));
  return finish_figure(f, plot, fill_profile(f, m, index, &plot->panels[0]));
}

// Pairs -------------------------------------------------------------------------------------------

/* Adds values (minus less, if given) against the voltage in kV. */
static dea_status add_values(struct dea_context *ctx, struct dea_panel *panel,
                             const struct dea_misfit *m, const double *values, const double *less,
                             const double *std, struct dea_series **out)
{
  DEA_TRY(ctx, dea_panel_add(ctx, panel, m->count, out));
  double factor = m->quantity->factor;
  for (size_t i = 0; i < m->count; i++) {
    (*out)->values[i] = 1e-3 * m->at[i];
    (*out)->values[m->count + i] = factor * (values[i] - (less != NULL ? less[i] : 0.0));
    (*out)->values[2 * m->count + i] = std != NULL ? factor * std[i] : NAN;
  }
  return DEA_OK;
}

static bool has_std_of(const struct dea_misfit *m, const double *std)
{
  for (size_t i = 0; i < m->count; i++) {
    if (!isnan(std[i])) {
      return true;
    }
  }
  return false;
}

/* Band of the first of a pair, below its line. */
static dea_status add_pair_band(struct dea_context *ctx, struct dea_panel *panel,
                                const struct dea_misfit *m)
{
  struct dea_series *band;
  if (!has_std_of(m, m->a_std)) {
    return DEA_OK;
  }
  const double factor = m->quantity->factor;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, m->count, &band));
  band->style = DEA_BAND;
  band->colour = DEA_BLUE;
  snprintf(band->title, sizeof band->title, "%s of the model", band_title);
  for (size_t i = 0; i < m->count; i++) {
    band->values[i] = 1e-3 * m->at[i];
    band->values[m->count + i] = factor * (m->a[i] - m->a_std[i]);
    band->values[2 * m->count + i] = factor * (m->a[i] + m->a_std[i]);
  }
  return DEA_OK;
}

/* One of a pair, whole: where it was computed, or all that was measured, with what is known of its
 * error. */
static dea_status add_side(struct dea_context *ctx, struct dea_panel *panel,
                           const struct dea_misfit *m, const struct dea_curve *curve,
                           const char *name, bool first)
{
  struct dea_series look = {.style = first               ? DEA_LINE
                                     : curve->count > 25 ? DEA_LINE_MARKED
                                                         : DEA_MARKERS,
                            .colour = first ? DEA_BLUE : DEA_VERMILLION};
  dea_label_escape(name, look.title, sizeof look.title);
  return dea_figure_add(ctx, panel, curve, m->column, m->quantity->factor, 0.0, &look);
}

/* What was measured, with a band of its scatter, or with bars where the model has a band. */
static dea_status add_pair_measured(struct dea_context *ctx, struct dea_panel *panel,
                                    const struct dea_measurement *measured,
                                    const struct dea_misfit *m)
{
  struct dea_series *series;
  if (!has_std_of(m, m->a_std) || !has_std_of(m, m->b_std)) {
    return add_measured(ctx, panel, measured, m->column, false);
  }
  DEA_TRY(ctx, add_values(ctx, panel, m, m->b, NULL, m->b_std, &series));
  series->style = DEA_ERROR_BARS;
  series->colour = DEA_BLACK;
  snprintf(series->title, sizeof series->title, "measured, %s", band_title);
  return DEA_OK;
}

static dea_status fill_pair(struct dea_context *ctx, const struct dea_set_curve *c,
                            const struct dea_measurement *measured, const struct dea_misfit *m,
                            const char *beside, struct dea_plot *plot)
{
  struct dea_panel *top = &plot->panels[0], *low = &plot->panels[1];
  struct dea_series *series;
  bool bars = has_std_of(m, m->b_std);
  plot->panel_count = 2;
  plot->second_height = 0.45;
  if (measured != NULL && carries_band(measured, m->column) && !has_std_of(m, m->a_std)) {
    DEA_TRY(ctx, add_measured(ctx, top, measured, m->column, true));
  }
  DEA_TRY(ctx, add_pair_band(ctx, top, m));
  DEA_TRY(ctx, add_side(ctx, top, m, c->curve, c->name, true));
  DEA_TRY(ctx, measured != NULL ? add_pair_measured(ctx, top, measured, m)
                                : add_side(ctx, top, m, c->reference, beside, false));
  DEA_TRY(ctx, add_values(ctx, low, m, m->a, m->b, m->b_std, &series));
  series->style = bars ? DEA_ERROR_BARS : DEA_LINE_MARKED;
  series->colour = DEA_BLACK;
  dea_panel_mark(low, false, 0.0, "");
  dea_figure_label(m->quantity, top->y_label, sizeof top->y_label);
  snprintf(low->y_label, sizeof low->y_label, "Difference");
  dea_panel_voltage_axis(top);
  dea_panel_voltage_axis(low);
  low->x_min = top->x_min;
  low->x_max = top->x_max;
  set_range(top);
  dea_panel_even_tics(top, 7);
  dea_panel_even_tics(low, 3);
  dea_panel_place_key(top);
  return DEA_OK;
}

/* A misfit of a pair whose curves are those of c. */
static dea_status draw_misfit(struct dea_set_figures *f, const struct dea_set_curve *c,
                              const char *beside, const struct dea_misfit *m)
{
  const struct dea_measurement *measured =
      f->set->measured != NULL ? f->set->measured->points : NULL;
  bool alone = f->set->curve_count == 1;
  char name[DEA_SET_FIGURE_SIZE], caption[4 * DEA_LABEL_SIZE];
  struct dea_plot *plot;
  name_figure(m->quantity, alone ? "" : c->model, name);
  snprintf(caption, sizeof caption, "%s of %s and %s, and the first minus the second",
           m->quantity->header, c->name, beside);
  DEA_TRY(f->ctx, dea_plot_create(f->ctx, name, caption, &plot));
  DEA_TRY(f->ctx, finish_figure(f, plot, fill_pair(f->ctx, c, measured, m, beside, plot)));
  return DEA_OK;
}

static dea_status draw_pair(struct dea_set_figures *f, size_t curve)
{
  const struct dea_set_curve *c = &f->set->curves[curve];
  char beside[DEA_LABEL_SIZE];
  dea_compare_set_beside(f->set, curve, beside);
  for (size_t i = 0; c->comparison != NULL && i < c->comparison->misfit_count; i++) {
    DEA_TRY(f->ctx, draw_misfit(f, c, beside, &c->comparison->misfits[i]));
  }
  return DEA_OK;
}

// Histories --------------------------------------------------------------------------------------

enum { FEW = 20, DRAWN_MAX = 4000 }; // pulses of which lines are thick, points of a line

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
  size_t capacity = stretch == 1 ? last - first : 2 * ((last - first) / stretch + 1), n = 0;
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, capacity, look, &series));
  for (size_t i = first; i < last; i += stretch) {
    size_t end = i + stretch < last ? i + stretch : last, low = i, high = i;
    for (size_t k = i; k < end; k++) {
      low = values[k] < values[low] || isnan(values[low]) ? k : low;
      high = values[k] > values[high] || isnan(values[high]) ? k : high;
    }
    size_t shown[2] = {low < high ? low : high, low < high ? high : low};
    for (size_t k = 0; k < (stretch == 1 ? 1U : 2U); k++) {
      series->values[n] = time[shown[k]];
      series->values[capacity + n++] = values[shown[k]];
    }
  }
  return DEA_OK;
}

/* A column of a history computed, on the measured clock. */
static dea_status add_computed(struct dea_set_figures *f, struct dea_panel *panel,
                               const struct dea_set_history *h, int column, const double span[2])
{
  struct dea_context *ctx = f->ctx;
  size_t n = h->transient->count;
  double *time = dea_alloc(ctx, n, sizeof *time), *values = dea_alloc(ctx, n, sizeof *values);
  struct dea_series look = dea_figure_style(f->set->curves[h->curve].name, h->curve);
  dea_status status = time != NULL && values != NULL ? DEA_OK : DEA_E_MEMORY;
  for (size_t i = 0; status == DEA_OK && i < n; i++) {
    time[i] = h->transient->points[i].time_s + h->clock.shift_s;
    values[i] =
        dea_column_at(ctx, column)->factor * dea_point_get(&h->transient->points[i], column);
  }
  look.style = h->curve % 2 > 0 ? DEA_DASHED : h->clock.edges > FEW ? DEA_THIN : DEA_LINE;
  if (status == DEA_OK) {
    status = add_track(ctx, panel, time, values, n, span, &look);
  }
  dea_free(ctx, time);
  dea_free(ctx, values);
  return status;
}

static dea_status add_recorded(struct dea_set_figures *f, struct dea_panel *panel, size_t column,
                               const double span[2])
{
  const struct dea_csv_columns *history = &f->set->measured->history;
  struct dea_series look = {.style = DEA_LINE, .colour = DEA_BLACK, .title = "measured"};
  for (size_t i = 0; i < f->set->history_count; i++) {
    look.style = f->set->histories[i].clock.edges > FEW ? DEA_THIN : look.style;
  }
  double *values = dea_alloc(f->ctx, history->rows, sizeof *values);
  if (values == NULL) {
    return DEA_E_MEMORY;
  }
  const int of_point = f->set->measured->history_column[column];
  for (size_t i = 0; i < history->rows; i++) {
    values[i] = dea_column_at(f->ctx, of_point)->factor * history->values[column][i];
  }
  dea_status status = add_track(f->ctx, panel, history->values[DEA_MEASURED_TIME], values,
                                history->rows, span, &look);
  dea_free(f->ctx, values);
  return status;
}

/* Times that both have, and a little more. */
static void find_span(const struct dea_compare_set *set, size_t column, double span[2])
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

static dea_status fill_history(struct dea_set_figures *f, size_t column, const double span[2],
                               struct dea_plot *plot)
{
  const struct dea_compare_set *set = f->set;
  bool has_voltage = set->measured->history.values[DEA_MEASURED_VOLTAGE] != NULL;
  plot->panel_count = has_voltage ? 2 : 1;
  plot->second_height = 1.0;
  for (size_t p = 0; p < plot->panel_count; p++) {
    struct dea_panel *panel = &plot->panels[p];
    const size_t shown = p + 1 < plot->panel_count ? DEA_MEASURED_VOLTAGE : column;
    const int of_point = set->measured->history_column[shown];
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
    dea_figure_label(dea_column_at(f->ctx, of_point), panel->y_label, sizeof panel->y_label);
    set_range(panel);
    dea_panel_even_tics(panel, 5);
    set_key_above(f, panel);
  }
  return DEA_OK;
}

static dea_status draw_histories(struct dea_set_figures *f)
{
  const struct dea_measured *m = f->set->measured;
  for (size_t k = DEA_MEASURED_QUANTITIES; m != NULL && k < m->history_count; k++) {
    double span[2];
    struct dea_plot *plot;
    char name[DEA_SET_FIGURE_SIZE];
    find_span(f->set, k, span);
    if (span[1] > span[0]) {
      const struct dea_column *c = dea_column_at(f->ctx, m->history_column[k]);
      snprintf(name, sizeof name, "compare_history_%s", c->key);
      DEA_TRY(f->ctx, begin_figure(f, name, "history", &plot));
      DEA_TRY(f->ctx, finish_figure(f, plot, fill_history(f, k, span, plot)));
    }
  }
  return DEA_OK;
}

// All --------------------------------------------------------------------------------------------

dea_status dea_compare_set_draw(struct dea_context *ctx, const struct dea_compare_set *set,
                                const struct dea_plot_format *format, const char *directory)
{
  struct dea_set_figures *f = dea_alloc(ctx, 1, sizeof *f);
  const size_t capacity =
      (size_t)dea_column_count(ctx) * set->curve_count + DEA_CSV_COLUMNS_MAX + 1;
  const char **names = dea_alloc(ctx, capacity, sizeof *names);
  char(*texts)[DEA_SET_FIGURE_SIZE] = dea_alloc(ctx, capacity, sizeof *texts);
  if (f == NULL || names == NULL || texts == NULL) {
    dea_free(ctx, f);
    dea_free(ctx, names);
    dea_free(ctx, texts);
    return DEA_E_MEMORY;
  }
  *f = (struct dea_set_figures){.ctx = ctx,
                                .set = set,
                                .format = format,
                                .directory = directory,
                                .names = texts,
                                .capacity = capacity};
  dea_status status = dea_folder_make(ctx, directory);
  for (size_t i = 0; status == DEA_OK && set->pairs && i < set->curve_count; i++) {
    status = draw_pair(f, i);
  }
  status = status == DEA_OK && !set->pairs ? draw_quantities(f) : status;
  status = status == DEA_OK ? draw_profile(f) : status;
  status = status == DEA_OK ? draw_histories(f) : status;
  for (size_t i = 0; i < f->count; i++) {
    names[i] = f->names[i];
  }
  if (status == DEA_OK && (format->svg || format->pdf || format->png)) {
    status = dea_gnuplot_draw(ctx, directory, names, f->count);
  }
  dea_free(ctx, f);
  dea_free(ctx, names);
  dea_free(ctx, texts);
  return status;
}
