/* The figures of several curves beside one reference (see compare_set.h). */
#include "base/write_file.h"
#include "compare/compare_set.h"
#include "result/figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What is drawn so far. */
struct dea_set_figures {
  struct dea_plot_folder folder;
  struct dea_arena memory; // of series that are drawn
  const struct dea_compare_set *set;
};

static const char band_title[] = "\302\261 1 std";
static const struct dea_series grey_band = {
    .style = DEA_BAND, .colour = DEA_GREY, .title = "\302\261 1 std"};
static const struct dea_series measured_line = {
    .style = DEA_LINE, .colour = DEA_BLACK, .title = "measured"};

/* Letters and digits of a name of monitors, which may have others. */
static void name_figure(const char *kind, const struct dea_column *quantity, const char *model,
                        char out[64])
{
  snprintf(out, 64, "compare_%s%s%s%.30s", kind, quantity->key, model[0] != '\0' ? "_" : "", model);
  for (char *at = out; *at != '\0'; at++) {
    bool plain = (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z') ||
                 (*at >= '0' && *at <= '9') || *at == '-';
    *at = plain ? *at : '_';
  }
}

static dea_status begin_figure(struct dea_set_figures *f, const char *name, const char *what,
                               struct dea_plot **plot)
{
  char caption[2 * DEA_LABEL_SIZE];
  snprintf(caption, sizeof caption, "%s, beside %s", what, f->set->reference);
  return dea_plot_create(f->folder.ctx, name, caption, plot);
}

/* Adds a series times the factors as look says; of a band a standard uncertainty to either side. */
static dea_status add(struct dea_set_figures *f, struct dea_panel *panel,
                      const struct dea_samples *samples, double x_factor, double y_factor,
                      const struct dea_series *look)
{
  struct dea_series *out;
  const size_t n = samples->count;
  const bool band = look->style == DEA_BAND;
  DEA_TRY(f->folder.ctx, dea_panel_add_as(f->folder.ctx, panel, n, look, &out));
  for (size_t i = 0; i < n; i++) {
    const double y = y_factor * samples->value[i];
    const double std = samples->std != NULL ? y_factor * samples->std[i] : (double)NAN;
    out->values[i] = x_factor * samples->at[i];
    out->values[n + i] = band ? y - std : y;
    out->values[2 * n + i] = band ? y + std : std;
  }
  return DEA_OK;
}

static void set_range(struct dea_panel *panel, int tics)
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
  dea_panel_even_tics(panel, tics);
}

static void set_key_above(const struct dea_set_figures *f, struct dea_panel *panel)
{
  const double letter_mm = 1.4, sample_mm = 9.0, axis_mm = 20.0;
  size_t entries = 0, longest = 1;
  for (size_t s = 0; s < panel->series_count; s++) {
    size_t length = strlen(panel->series[s].title);
    entries += length > 0;
    longest = length > longest ? length : longest;
  }
  double room_mm = 1e3 * f->folder.format->width_m - axis_mm;
  double columns = fmax(floor(room_mm / (letter_mm * (double)longest + sample_mm)), 1.0);
  dea_panel_key_above(panel, (size_t)ceil((double)entries / columns));
}

// Against the voltage -----------------------------------------------------------------------------

/* What was measured of a column, without gaps, which would part a band; count 0: a run is the
 * reference. */
static dea_status measured_samples(struct dea_set_figures *f, int column, struct dea_samples *out)
{
  const struct dea_measured *m = f->set->measured;
  *out = (struct dea_samples){0};
  return m == NULL ? DEA_OK
                   : dea_samples_of_curve(&f->memory, &m->points->curve, m->points->std, column,
                                          DEA_BY_VOLTAGE, out);
}

/* Whether measured points can carry a band: voltages rise, and each has its uncertainty. */
static bool carries_band(const struct dea_samples *s)
{
  for (size_t i = 0; i < s->count; i++) {
    if ((i > 0 && !(s->at[i] > s->at[i - 1])) || isnan(s->std[i])) {
      return false;
    }
  }
  return s->count > 1;
}

/* Measured points, with bars where the uncertainty is known and not shown by a band. */
static dea_status add_measured(struct dea_set_figures *f, struct dea_panel *panel,
                               const struct dea_samples *s, double factor, bool band)
{
  const bool bars = !band && dea_samples_have_std(s);
  struct dea_series look = {
      .style = bars ? DEA_ERROR_BARS : DEA_MARKERS, .colour = DEA_BLACK, .marker = 5};
  snprintf(look.title, sizeof look.title, "measured%s%s", bars ? ", " : "", bars ? band_title : "");
  return add(f, panel, s, 1e-3, factor, &look);
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
  struct dea_context *ctx = f->folder.ctx;
  const struct dea_compare_set *set = f->set;
  const double factor = dea_column_at(ctx, column)->factor;
  struct dea_samples measured;
  DEA_TRY(ctx, measured_samples(f, column, &measured));
  const bool band = carries_band(&measured);
  DEA_TRY(ctx, band ? add(f, panel, &measured, 1e-3, factor, &grey_band) : DEA_OK);
  for (size_t i = 0; i < set->curve_count; i++) {
    struct dea_series look = dea_figure_style(set->curves[i].name, i);
    DEA_TRY(ctx, dea_figure_add(ctx, panel, set->curves[i].curve, column, factor, 0.0, &look));
  }
  DEA_TRY(ctx, set->measured != NULL ? add_measured(f, panel, &measured, factor, band)
                                     : add_reference(ctx, panel, set, column));
  dea_figure_label(dea_column_at(ctx, column), panel->y_label, sizeof panel->y_label);
  dea_panel_voltage_axis(panel);
  set_range(panel, 7);
  dea_panel_place_key(panel);
  return DEA_OK;
}

static dea_status draw_quantities(struct dea_set_figures *f)
{
  for (int c = 0; c < dea_column_count(f->folder.ctx); c++) {
    const struct dea_column *column = dea_column_at(f->folder.ctx, c);
    struct dea_plot *plot;
    char name[64];
    bool compared = false;
    for (size_t i = 0; i < f->set->curve_count; i++) {
      compared = compared || dea_compare_set_find(f->set, i, c) != NULL;
    }
    if (compared) {
      name_figure("", column, "", name);
      DEA_TRY(f->folder.ctx, begin_figure(f, name, column->header, &plot));
      DEA_TRY(f->folder.ctx,
              dea_plot_folder_add(&f->folder, plot, fill_quantity(f, c, &plot->panels[0])));
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
  for (size_t i = 0; i < set->misfit_count; i++) {
    const struct dea_set_misfit *p = &set->misfits[i];
    if (p->kind == DEA_SET_PROFILE &&
        (largest == NULL ||
         fabs(set->measured->profiles[p->measured].voltage_V) > fabs(largest->voltage_V))) {
      largest = &set->measured->profiles[p->measured];
      *index = p->measured;
    }
  }
  return largest;
}

/* A model's line; between fibres without an entry of the key, which all have in common. */
static dea_status add_line(struct dea_set_figures *f, struct dea_panel *panel,
                           const struct dea_set_misfit *p)
{
  struct dea_series look = dea_figure_style(f->set->curves[p->curve].name, p->curve);
  look.style = p->half == DEA_HALF_FIBRE ? DEA_LINE : DEA_DASHED;
  if (p->half == DEA_HALF_BETWEEN) {
    look.title[0] = '\0';
  }
  return add(f, panel, &p->line.samples, 1e3, 1e6, &look);
}

static dea_status fill_profile(struct dea_set_figures *f, const struct dea_measured_profile *m,
                               size_t index, struct dea_panel *panel)
{
  struct dea_context *ctx = f->folder.ctx;
  double film_m = 0.0;
  bool directed = false;
  DEA_TRY(ctx, m->z.std != NULL ? add(f, panel, &m->z, 1e3, 1e6, &grey_band) : DEA_OK);
  DEA_TRY(ctx, add(f, panel, &m->z, 1e3, 1e6, &measured_line));
  for (size_t i = 0; i < f->set->misfit_count; i++) {
    const struct dea_set_misfit *p = &f->set->misfits[i];
    if (p->kind == DEA_SET_PROFILE && p->measured == index) {
      DEA_TRY(ctx, add_line(f, panel, p));
      film_m = fmax(film_m, p->line.samples.at[p->line.samples.count - 1]);
      directed = directed || p->line.directed;
    }
  }
  // Entries of the key: which line is which half. Their one point is the film's edge.
  for (int half = 0; directed && half < DEA_HALVES; half++) {
    DEA_TRY(ctx, dea_figure_add_entry(ctx, panel, half == DEA_HALF_FIBRE ? DEA_LINE : DEA_DASHED,
                                      dea_half_names[half], 1e3 * film_m, 0.0));
  }
  panel->x_min = -1.1e3 * film_m; // with the beginning of the frame
  panel->x_max = 1.1e3 * film_m;
  snprintf(panel->x_label, sizeof panel->x_label, "Place across the film {/:Italic x} (mm)");
  snprintf(panel->y_label, sizeof panel->y_label, "{/:Italic z} at %.4g kV (\302\265m)",
           1e-3 * m->voltage_V);
  set_key_above(f, panel);
  set_range(panel, 7);
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
  DEA_TRY(f->folder.ctx, begin_figure(f, "compare_profile", "profile across the film", &plot));
  return dea_plot_folder_add(&f->folder, plot, fill_profile(f, m, index, &plot->panels[0]));
}

// Pairs -------------------------------------------------------------------------------------------

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

/* Both curves: bands of one standard uncertainty of the model, or else of what was measured, which
 * has bars where the model has the band. */
static dea_status fill_both(struct dea_set_figures *f, const struct dea_set_curve *c,
                            const struct dea_misfit *m, const char *beside, struct dea_panel *panel)
{
  struct dea_context *ctx = f->folder.ctx;
  const double factor = m->quantity->factor;
  const struct dea_samples a = {m->count, m->at, m->a, m->a_std},
                           b = {m->count, m->at, m->b, m->b_std};
  const bool model_band = dea_samples_have_std(&a);
  struct dea_samples measured;
  DEA_TRY(ctx, measured_samples(f, m->column, &measured));
  const bool band = carries_band(&measured);
  DEA_TRY(ctx, band && !model_band ? add(f, panel, &measured, 1e-3, factor, &grey_band) : DEA_OK);
  if (model_band) {
    struct dea_series look = {.style = DEA_BAND, .colour = DEA_BLUE};
    snprintf(look.title, sizeof look.title, "%s of the model", band_title);
    DEA_TRY(ctx, add(f, panel, &a, 1e-3, factor, &look));
  }
  DEA_TRY(ctx, add_side(ctx, panel, m, c->curve, c->name, true));
  if (f->set->measured == NULL) {
    return add_side(ctx, panel, m, c->reference, beside, false);
  }
  const bool both = model_band && dea_samples_have_std(&b);
  return add_measured(f, panel, both ? &b : &measured, factor, band && !both);
}

static dea_status fill_pair(struct dea_set_figures *f, const struct dea_set_curve *c,
                            const struct dea_misfit *m, const char *beside, struct dea_plot *plot)
{
  struct dea_context *ctx = f->folder.ctx;
  struct dea_panel *top = &plot->panels[0], *low = &plot->panels[1];
  double *values = dea_arena_alloc(&f->memory, m->count, sizeof *values);
  const struct dea_samples difference = {m->count, m->at, values, m->b_std};
  DEA_TRY(ctx, dea_arena_status(&f->memory));
  for (size_t i = 0; i < m->count; i++) {
    values[i] = m->a[i] - m->b[i];
  }
  const struct dea_series look = {.style = dea_samples_have_std(&difference) ? DEA_ERROR_BARS
                                                                             : DEA_LINE_MARKED,
                                  .colour = DEA_BLACK};
  plot->panel_count = 2;
  plot->second_height = 0.45;
  DEA_TRY(ctx, fill_both(f, c, m, beside, top));
  DEA_TRY(ctx, add(f, low, &difference, 1e-3, m->quantity->factor, &look));
  dea_panel_mark(low, 0.0, "");
  dea_figure_label(m->quantity, top->y_label, sizeof top->y_label);
  snprintf(low->y_label, sizeof low->y_label, "Difference");
  dea_panel_voltage_axis(top);
  dea_panel_voltage_axis(low);
  low->x_min = top->x_min;
  low->x_max = top->x_max;
  set_range(top, 7);
  dea_panel_even_tics(low, 3);
  dea_panel_place_key(top);
  return DEA_OK;
}

static dea_status draw_pairs(struct dea_set_figures *f)
{
  for (size_t i = 0; i < f->set->misfit_count; i++) {
    const struct dea_set_misfit *m = &f->set->misfits[i];
    const struct dea_set_curve *c = &f->set->curves[m->curve];
    char beside[DEA_LABEL_SIZE], name[64], caption[4 * DEA_LABEL_SIZE];
    struct dea_plot *plot;
    if (m->kind == DEA_SET_VOLTAGE) {
      dea_compare_set_beside(f->set, m->curve, beside);
      name_figure("", m->misfit.quantity, f->set->curve_count == 1 ? "" : c->model, name);
      snprintf(caption, sizeof caption, "%s of %s and %s, and the first minus the second",
               m->misfit.quantity->header, c->name, beside);
      DEA_TRY(f->folder.ctx, dea_plot_create(f->folder.ctx, name, caption, &plot));
      DEA_TRY(f->folder.ctx,
              dea_plot_folder_add(&f->folder, plot, fill_pair(f, c, &m->misfit, beside, plot)));
    }
  }
  return DEA_OK;
}

// Histories --------------------------------------------------------------------------------------

enum { FEW = 20, DRAWN_MAX = 4000 }; // pulses of which lines are thick, points of a line

/* Adds samples in time within [from, to]; of many the smallest and largest of each stretch, so that
 * no peak is lost and no file becomes large. */
static dea_status add_track(struct dea_set_figures *f, struct dea_panel *panel,
                            const struct dea_samples *samples, double factor, const double span[2],
                            const struct dea_series *look)
{
  const double *time = samples->at, *values = samples->value;
  struct dea_series *series;
  size_t first = 0, last = samples->count;
  while (first < last && !(time[first] >= span[0])) {
    first++;
  }
  while (last > first && !(time[last - 1] <= span[1])) {
    last--;
  }
  size_t stretch = (last - first) / (DRAWN_MAX / 2) + 1;
  size_t capacity = stretch == 1 ? last - first : 2 * ((last - first) / stretch + 1), n = 0;
  DEA_TRY(f->folder.ctx, dea_panel_add_as(f->folder.ctx, panel, capacity, look, &series));
  for (size_t i = first; i < last; i += stretch) {
    size_t end = i + stretch < last ? i + stretch : last, low = i, high = i;
    for (size_t k = i; k < end; k++) {
      low = values[k] < values[low] || isnan(values[low]) ? k : low;
      high = values[k] > values[high] || isnan(values[high]) ? k : high;
    }
    size_t shown[2] = {low < high ? low : high, low < high ? high : low};
    for (size_t k = 0; k < (stretch == 1 ? 1U : 2U); k++) {
      series->values[n] = time[shown[k]];
      series->values[capacity + n++] = factor * values[shown[k]];
    }
  }
  return DEA_OK;
}

/* Times that both have, and a little more. */
static void find_span(const struct dea_compare_set *set, size_t column, double span[2])
{
  span[0] = INFINITY;
  span[1] = -INFINITY;
  for (size_t i = 0; i < set->misfit_count; i++) {
    const struct dea_misfit *m = &set->misfits[i].misfit;
    if (set->misfits[i].kind == DEA_SET_HISTORY && set->misfits[i].measured == column) {
      span[0] = fmin(span[0], m->at[0]);
      span[1] = fmax(span[1], m->at[m->count - 1]);
    }
  }
  double more = 0.02 * (span[1] - span[0]);
  span[0] -= more;
  span[1] += more;
}

/* A column as measured, and of the transients that were compared in another. */
static dea_status fill_track(struct dea_set_figures *f, size_t compared, size_t shown,
                             const double span[2], struct dea_panel *panel)
{
  struct dea_context *ctx = f->folder.ctx;
  const int column = f->set->measured->history_column[shown];
  const double factor = dea_column_at(ctx, column)->factor;
  struct dea_samples samples = dea_measured_history(f->set->measured, shown);
  struct dea_series look = measured_line;
  for (size_t i = 0; i < f->set->misfit_count; i++) {
    look.style = f->set->misfits[i].clock.edges > FEW ? DEA_THIN : look.style;
  }
  DEA_TRY(ctx, add_track(f, panel, &samples, factor, span, &look));
  for (size_t i = 0; i < f->set->misfit_count; i++) {
    const struct dea_set_misfit *h = &f->set->misfits[i];
    if (h->kind == DEA_SET_HISTORY && h->measured == compared) {
      look = dea_figure_style(f->set->curves[h->curve].name, h->curve);
      look.style = h->curve % 2 > 0 ? DEA_DASHED : h->clock.edges > FEW ? DEA_THIN : DEA_LINE;
      DEA_TRY(ctx, dea_compare_set_transient(h, column, &f->memory, &samples));
      DEA_TRY(ctx, add_track(f, panel, &samples, factor, span, &look));
    }
  }
  panel->x_min = span[0];
  panel->x_max = span[1];
  snprintf(panel->x_label, sizeof panel->x_label, "Time {/:Italic t} (s)");
  dea_figure_label(dea_column_at(ctx, column), panel->y_label, sizeof panel->y_label);
  set_range(panel, 5);
  return DEA_OK;
}

static dea_status fill_history(struct dea_set_figures *f, size_t column, const double span[2],
                               struct dea_plot *plot)
{
  const bool has_voltage = f->set->measured->history.values[DEA_MEASURED_VOLTAGE] != NULL;
  plot->panel_count = has_voltage ? 2 : 1;
  plot->second_height = 1.0;
  for (size_t p = 0; p < plot->panel_count; p++) {
    struct dea_panel *panel = &plot->panels[p];
    const size_t shown = p + 1 < plot->panel_count ? DEA_MEASURED_VOLTAGE : column;
    DEA_TRY(f->folder.ctx, fill_track(f, column, shown, span, panel));
    for (size_t s = 0; s < panel->series_count && p > 0; s++) {
      panel->series[s].title[0] = '\0'; // the key above holds for both
    }
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
    char name[64];
    find_span(f->set, k, span);
    if (span[1] > span[0]) {
      name_figure("history_", dea_column_at(f->folder.ctx, m->history_column[k]), "", name);
      DEA_TRY(f->folder.ctx, begin_figure(f, name, "history", &plot));
      DEA_TRY(f->folder.ctx, dea_plot_folder_add(&f->folder, plot, fill_history(f, k, span, plot)));
    }
  }
  return DEA_OK;
}

// All --------------------------------------------------------------------------------------------

dea_status dea_compare_set_draw(struct dea_context *ctx, const struct dea_compare_set *set,
                                const struct dea_plot_format *format, const char *directory)
{
  struct dea_set_figures f = {.folder = {.ctx = ctx, .format = format, .path = directory},
                              .memory = {.ctx = ctx},
                              .set = set};
  dea_status status = dea_folder_create(ctx, directory);
  if (status == DEA_OK) {
    status = set->pairs ? draw_pairs(&f) : draw_quantities(&f);
  }
  status = status == DEA_OK ? draw_profile(&f) : status;
  status = status == DEA_OK ? draw_histories(&f) : status;
  dea_arena_free(&f.memory);
  return dea_plot_folder_draw(&f.folder, status);
}
