/* The figures of a reduction (dea_reduction_draw). */
#include "reduce/output.h"

#include <stdio.h>

enum { SHOWN_MAX = 8, SERIES_POINTS = 4000 };

static const enum dea_colour colours[SHOWN_MAX] = {DEA_GREY, DEA_BLACK, DEA_PURPLE, DEA_BLUE,
                                                   DEA_SKY,  DEA_GREEN, DEA_ORANGE, DEA_VERMILLION};

struct drawing {
  struct dea_context *ctx;
  const struct dea_recording *recording;
  const struct dea_reduction *reduction;
  struct dea_plot_folder folder;
};

/* Rows (one a voltage) that are shown: the highest, of either sign, and evenly of the others; where
 * there are too many, that of no voltage is the first to go. Their first levels into levels; how
 * many. */
static size_t shown_levels(const struct dea_reduction *r, size_t levels[SHOWN_MAX])
{
  size_t rows = 0, active = 0, n = 0, row = 0;
  const double rest_V = 0.01 * dea_reduced_highest_V(r);
  for (size_t l = 0; l < r->level_count; l += dea_reduced_row_at(r, l).levels, rows++) {
    active += fabs(r->levels[l].voltage_V) < rest_V ? 0U : 1U;
  }
  const bool too_many = rows > SHOWN_MAX;
  rows = too_many ? active : rows;
  const size_t most = rows < SHOWN_MAX ? rows : SHOWN_MAX;
  const bool down = r->level_count > 0 &&
                    fabs(r->levels[0].voltage_V) > fabs(r->levels[r->level_count - 1].voltage_V);
  for (size_t l = 0; l < r->level_count; l += dea_reduced_row_at(r, l).levels) {
    if (too_many && fabs(r->levels[l].voltage_V) < rest_V) {
      continue;
    }
    // the last of each share, or the first where the highest stands first
    if (n < most && row == (down ? n * rows / most : (n + 1) * rows / most - 1)) {
      levels[n++] = l;
    }
    row++;
  }
  return n;
}

/* Colour of the n-th of so many. */
static enum dea_colour colour_of(size_t n, size_t of)
{
  return colours[of > 1 ? SHOWN_MAX - of + n : SHOWN_MAX - 1];
}

/* A few volts are the noise and offset of a monitor of kilovolts: that level is 0. */
static void title_of(double voltage_V, char out[32])
{
  snprintf(out, 32, "%.3g kV", fabs(voltage_V) < 5.0 ? 0.0 : 1e-3 * voltage_V);
}

static dea_status build_profiles(const struct drawing *d, struct dea_plot *plot)
{
  const struct dea_reduction *r = d->reduction;
  struct dea_panel *panel = &plot->panels[0];
  size_t levels[SHOWN_MAX], count = r->points > 0 ? shown_levels(r, levels) : 0;
  for (size_t k = 0; k < count; k++) {
    const struct dea_voltage_level *level = &r->levels[levels[k]];
    struct dea_series *series;
    char title[32];
    title_of(level->voltage_V, title);
    DEA_TRY(d->ctx,
            dea_panel_add(d->ctx, panel, r->points, DEA_LINE, colour_of(k, count), title, &series));
    for (size_t i = 0; i < r->points; i++) {
      series->values[i] = 1e3 * r->radius_m[i];
      series->values[r->points + i] = 1e6 * level->z_m[i];
    }
  }
  dea_panel_begin_at_zero(panel);
  panel->x_min = 1e3 * (r->levelling.edges_m[0] - r->levelling.centre_m);
  panel->x_max = 1e3 * (r->levelling.edges_m[1] - r->levelling.centre_m);
  dea_panel_key_above(panel, 2);
  snprintf(panel->x_label, sizeof panel->x_label, "Distance from the centre {/:Italic x} (mm)");
  snprintf(panel->y_label, sizeof panel->y_label, "Displacement {/:Italic z} (\302\265m)");
  return DEA_OK;
}

// In time ----------------------------------------------------------------------------------------

static dea_status add_time_series(const struct drawing *d, struct dea_panel *panel,
                                  const struct dea_reduced_series *table, const double *values,
                                  double factor, const char *title, enum dea_colour colour)
{
  struct dea_series *series;
  size_t n = 0;
  for (size_t i = 0; i < table->rows; i++) { // without gaps where another channel has its sample
    n += isnan(values[i]) ? 0U : 1U;
  }
  DEA_TRY(d->ctx,
          dea_panel_add(d->ctx, panel, n, n > 800 ? DEA_THIN : DEA_LINE, colour, title, &series));
  for (size_t i = 0, k = 0; i < table->rows; i++) {
    if (!isnan(values[i])) {
      series->values[k] = table->time_s[i];
      series->values[n + k++] = factor * values[i];
    }
  }
  return DEA_OK;
}

static void time_axis(const struct dea_reduced_series *table, struct dea_panel *panel)
{
  panel->x_min = table->rows > 0 ? table->time_s[0] : 0.0;
  panel->x_max = table->rows > 1 ? table->time_s[table->rows - 1] : 1.0;
  snprintf(panel->x_label, sizeof panel->x_label, "Time {/:Italic t} (s)");
  dea_panel_begin_at_zero(panel);
  dea_panel_even_tics(panel, 6);
  dea_panel_place_key(panel);
}

/* Voltage above what is measured: displacements, or force. */
static dea_status fill_time_series(const struct drawing *d, const struct dea_reduced_series *table,
                                   bool force, struct dea_plot *plot)
{
  static const struct {
    enum dea_reduced_kind kind;
    const char *title;
    enum dea_colour colour;
  } shown[] = {{DEA_REDUCED_CENTRE, "centre", DEA_BLUE},
               {DEA_REDUCED_FIBRE_TIP, "fibre tips", DEA_VERMILLION},
               {DEA_REDUCED_DISPLACEMENT, "point laser", DEA_GREEN},
               {DEA_REDUCED_FORCE, "", DEA_BLUE}};
  struct dea_panel *upper = &plot->panels[0], *lower = &plot->panels[1];
  plot->panel_count = 2;
  plot->second_height = 1.4;
  DEA_TRY(d->ctx, add_time_series(d, upper, table, table->voltage_V, 1e-3, "", DEA_BLACK));
  for (size_t k = 0; k < sizeof shown / sizeof shown[0]; k++) {
    const double *values = table->values[shown[k].kind];
    if (values != NULL && force == (shown[k].kind == DEA_REDUCED_FORCE)) {
      DEA_TRY(d->ctx,
              add_time_series(d, lower, table, values, dea_reduced_meanings[shown[k].kind].factor,
                              shown[k].title, shown[k].colour));
    }
  }
  if (lower->series_count == 0) {
    dea_panel_clear(d->ctx, upper);
    return DEA_OK;
  }
  snprintf(upper->y_label, sizeof upper->y_label, "Voltage {/:Italic V} (kV)");
  snprintf(lower->y_label, sizeof lower->y_label,
           force ? "Force {/:Italic F} (mN)" : "Displacement {/:Italic z} (\302\265m)");
  time_axis(table, upper);
  time_axis(table, lower);
  return DEA_OK;
}

static dea_status build_times(const struct drawing *d, bool force, struct dea_plot *plot)
{
  struct dea_reduced_series table;
  DEA_TRY(d->ctx,
          dea_reduced_series_fill(d->ctx, d->recording, d->reduction, SERIES_POINTS, &table));
  dea_status status = fill_time_series(d, &table, force, plot);
  dea_reduced_series_free(d->ctx, &table);
  return status;
}

static dea_status build_time_series(const struct drawing *d, struct dea_plot *plot)
{
  return build_times(d, false, plot);
}

static dea_status build_time_series_force(const struct drawing *d, struct dea_plot *plot)
{
  return build_times(d, true, plot);
}

// Against voltage, and from cycle to cycle -------------------------------------------------------

static dea_status add_amplitudes(const struct drawing *d, struct dea_panel *panel,
                                 enum dea_reduced_kind kind, const char *title,
                                 enum dea_colour colour, int marker)
{
  const struct dea_reduction *r = d->reduction;
  struct dea_series *series;
  if (!dea_reduced_has(r, kind)) {
    return DEA_OK;
  }
  DEA_TRY(d->ctx,
          dea_panel_add(d->ctx, panel, r->level_count, DEA_ERROR_BARS, colour, title, &series));
  series->marker = marker;
  for (size_t l = 0, n = 0; l < r->level_count; n++) {
    struct dea_reduced_row row = dea_reduced_row_at(r, l);
    double f = dea_reduced_meanings[kind].factor;
    series->values[n] = 1e-3 * row.voltage_V;
    series->values[r->level_count + n] = f * row.mean[kind];
    series->values[2 * r->level_count + n] = f * row.std[kind];
    l += row.levels;
  }
  return DEA_OK;
}

static dea_status build_amplitude(const struct drawing *d, struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0], *force = panel;
  DEA_TRY(d->ctx, add_amplitudes(d, panel, DEA_REDUCED_CENTRE, "centre", DEA_BLUE, 0));
  DEA_TRY(d->ctx, add_amplitudes(d, panel, DEA_REDUCED_FIBRE_TIP, "fibre tips", DEA_VERMILLION, 1));
  DEA_TRY(d->ctx, add_amplitudes(d, panel, DEA_REDUCED_DISPLACEMENT, "point laser", DEA_GREEN, 2));
  if (panel->series_count > 0) {
    snprintf(panel->y_label, sizeof panel->y_label, "Displacement {/:Italic z} (\302\265m)");
    force = &plot->panels[1];
  }
  DEA_TRY(d->ctx, add_amplitudes(d, force, DEA_REDUCED_FORCE, "", DEA_BLACK, 3));
  if (force->series_count > 0) {
    snprintf(force->y_label, sizeof force->y_label, "Force {/:Italic F} (mN)");
    plot->panel_count = force == panel ? 1 : 2;
    plot->second_height = 0.7;
  }
  for (size_t p = 0; p < plot->panel_count; p++) {
    dea_panel_voltage_axis(&plot->panels[p]);
    dea_panel_begin_at_zero(&plot->panels[p]);
    plot->panels[p].x_max *= 1.03; // room for the last sign
    plot->panels[p].x_min *= 1.03;
    dea_panel_even_tics(&plot->panels[p], 7);
    dea_panel_place_key(&plot->panels[p]);
  }
  return DEA_OK;
}

/* Amplitudes in the order of time, over the number within their level. */
static dea_status add_cycles(const struct drawing *d, struct dea_panel *panel, size_t first,
                             enum dea_reduced_kind kind, enum dea_colour colour)
{
  const struct dea_reduction *r = d->reduction;
  struct dea_reduced_row row = dea_reduced_row_at(r, first);
  struct dea_series *series;
  char title[32];
  size_t n = 0;
  title_of(row.voltage_V, title);
  DEA_TRY(d->ctx,
          dea_panel_add(d->ctx, panel, row.cycles, DEA_LINE_MARKED, colour, title, &series));
  for (size_t k = 0; k < r->cycle_count && n < row.cycles; k++) {
    if (r->cycles[k].level >= first && r->cycles[k].level < first + row.levels) {
      series->values[n] = (double)(n + 1);
      series->values[row.cycles + n++] =
          dea_reduced_meanings[kind].factor * r->cycles[k].values[kind].amplitude;
    }
  }
  return DEA_OK;
}

static dea_status build_cycles(const struct drawing *d, struct dea_plot *plot)
{
  const struct dea_reduction *r = d->reduction;
  enum dea_reduced_kind kind = dea_reduced_main(r);
  struct dea_panel *panel = &plot->panels[0];
  size_t levels[SHOWN_MAX], count, most = 0;
  if (kind == DEA_REDUCED_KINDS) {
    return DEA_OK;
  }
  count = shown_levels(r, levels);
  for (size_t k = 0; k < count; k++) {
    size_t cycles = dea_reduced_row_at(r, levels[k]).cycles;
    most = cycles > most ? cycles : most;
  }
  for (size_t k = 0; k < count && most > 1; k++) { // one cycle shows nothing
    DEA_TRY(d->ctx, add_cycles(d, panel, levels[k], kind, colour_of(k, count)));
  }
  dea_panel_begin_at_zero(panel);
  panel->x_min = 0.5;
  panel->x_max = (double)most + 0.5;
  dea_panel_key_above(panel, 2);
  snprintf(panel->x_label, sizeof panel->x_label, "Cycle");
  snprintf(panel->y_label, sizeof panel->y_label, "%s",
           kind == DEA_REDUCED_FORCE    ? "Force {/:Italic F} (mN)"
           : kind == DEA_REDUCED_CENTRE ? "Displacement of the centre {/:Italic z} (\302\265m)"
                                        : "Displacement {/:Italic z} (\302\265m)");
  dea_panel_even_tics(panel, 7);
  return DEA_OK;
}

// Files ------------------------------------------------------------------------------------------

static dea_status draw_one(struct drawing *d, const char *name, const char *caption,
                           dea_status (*build)(const struct drawing *, struct dea_plot *))
{
  struct dea_plot *plot;
  DEA_TRY(d->ctx, dea_plot_create(d->ctx, name, caption, &plot));
  return dea_plot_folder_add(&d->folder, plot, build(d, plot));
}

dea_status dea_reduction_draw(struct dea_context *ctx, const struct dea_recording *recording,
                              const struct dea_reduction *reduction,
                              const struct dea_plot_format *format, const char *directory)
{
  struct drawing d = {.ctx = ctx,
                      .recording = recording,
                      .reduction = reduction,
                      .folder = {.ctx = ctx, .format = format, .path = directory}};
  static const struct {
    const char *name, *caption;
    dea_status (*build)(const struct drawing *, struct dea_plot *);
  } figures[] = {
      {"profiles", "mean profiles of the film against rest", build_profiles},
      {"history", "voltage and displacement in time", build_time_series},
      {"history_force", "voltage and force in time", build_time_series_force},
      {"amplitude", "amplitudes against voltage, with the standard deviation of one cycle",
       build_amplitude},
      {"cycles", "amplitude of each cycle", build_cycles},
  };
  dea_status status = DEA_OK;
  for (size_t i = 0; i < sizeof figures / sizeof figures[0] && status == DEA_OK; i++) {
    status = draw_one(&d, figures[i].name, figures[i].caption, figures[i].build);
  }
  return dea_plot_folder_draw(&d.folder, status);
}
