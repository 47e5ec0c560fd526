/* Study "frequency": amplitude and phase of the displacements that a small AC excitation of the
 * voltage makes about a bias. */
#include "base/schema.h"
#include "study/observe.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static const char study_name[] = "frequency";

// Keys -------------------------------------------------------------------------------------------

/* Settings of compute.frequency; without a bias nothing is computed. */
struct settings {
  struct dea_quantity biases_V[DEA_DESIGN_STOPS_MAX];
  size_t bias_count;
  struct dea_quantity excitation_V, from_Hz, to_Hz, points;
  struct dea_quantity damping, damping_mass_per_s, damping_stiffness_s;
};

#define AT(member) offsetof(struct settings, member)

static const struct dea_field fields[] = {
    DEA_NUMBER_ROW("bias", AT(biases_V), "V", "[4 kV, 6 kV]",
                   "voltages that the excitation lies upon, in the order to be computed",
                   .above_min = true, .max = 1e6,
                   DEA_LIST(1, DEA_DESIGN_STOPS_MAX, struct dea_quantity, AT(bias_count))),
    DEA_NUMBER_ROW("excitation", AT(excitation_V), "V", "100 V",
                   "amplitude of the excitation: small against the bias", .alias = "ripple",
                   .above_min = true, .max = 1e6, .default_text = "1 V"),
    DEA_NUMBER_ROW("from", AT(from_Hz), "Hz", "1 Hz", "lowest frequency", .above_min = true,
                   .max = 1e6, .default_text = "1 Hz"),
    DEA_NUMBER_ROW("to", AT(to_Hz), "Hz", "1 kHz", "highest frequency", .above_min = true,
                   .max = 1e6, .default_text = "2 kHz"),
    DEA_INTEGER_ROW("points", AT(points), "400", "how many frequencies, evenly by their logarithm",
                    .min = 2, .max = 10000, .default_text = "400"),
    DEA_NUMBER_ROW(
        "damping", AT(damping), "1", "0.05",
        "viscous damping of each mode over its critical one; an assumption, not a measured value",
        .max = 10, .default_text = "0.02"),
    DEA_NUMBER_ROW("alpha", AT(damping_mass_per_s), "Hz", "10 Hz",
                   "alpha of viscous damping alpha M + beta K beside that, by the mass", .max = 1e9,
                   .default_text = "0 Hz"),
    DEA_NUMBER_ROW("beta", AT(damping_stiffness_s), "s", "10 us",
                   "beta of viscous damping alpha M + beta K beside that, by the stiffness",
                   .max = 1e3, .default_text = "0 s"),
};

/* Frequencies rise. */
static dea_status check(struct dea_context *ctx, const struct dea_design *design,
                        const struct dea_settings *given)
{
  (void)design;
  const struct settings *settings = given->values;
  const struct dea_quantity *to = &settings->to_Hz;
  if (given->written && settings->bias_count == 0) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, to->location,
                                 "frequency: without `bias` there is no such study"));
  }
  if (to->si <= settings->from_Hz.si) {
    return dea_finding_add(ctx, DEA_ERROR, to->location, "to: %g Hz is not above `from`, %g Hz",
                           to->si, settings->from_Hz.si);
  }
  return DEA_OK;
}

static const struct dea_design_section section = {
    .record = {study_name,
               "study of the response to a small AC excitation of the voltage about a bias (3d)",
               fields, DEA_COUNT(fields)},
    .size = sizeof(struct settings),
    .check = check};

static const struct settings *settings_of(const struct dea_design *design)
{
  const struct dea_settings *given = dea_design_settings(design, &section);
  return given != NULL ? given->values : NULL;
}

// Study ------------------------------------------------------------------------------------------

/* Adds the points of one bias with what monitors did there. answers: of the model, NULL: none. */
static dea_status add_points(struct dea_context *ctx, const struct dea_layout *layout,
                             struct dea_load_point *points, size_t count, const double *answers,
                             struct dea_curve *curve)
{
  struct dea_arena memory = {.ctx = ctx};
  struct dea_monitor_column *columns = NULL;
  size_t width = 0;
  dea_status status =
      answers != NULL ? dea_layout_answer_columns(&memory, layout, &columns, &width) : DEA_OK;
  struct dea_monitor_values *values = dea_monitor_column_values(&memory, columns, width);
  status = status == DEA_OK ? dea_arena_status(&memory) : status;
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    points[i].monitors = values;
    for (size_t k = 0; k < width; k++) {
      const struct dea_monitor_column *c = &columns[k];
      const double *part =
          answers + 2 * ((i * layout->monitor_count + c->index) * DEA_OBSERVED_MOTIONS + c->number);
      values->at[k].value =
          c->source == DEA_OF_PHASE ? atan2(part[1], part[0]) : hypot(part[0], part[1]);
    }
    status = dea_curve_add_point(ctx, curve, &points[i]);
  }
  dea_arena_free(&memory);
  return status;
}

/* All frequencies at one bias. */
static dea_status solve_frequencies(struct dea_context *ctx, const struct dea_study_job *job,
                                    const struct dea_load_point *at, size_t stop,
                                    struct dea_curve *curve)
{
  (void)stop;
  const struct dea_model_type *type = job->type;
  const struct settings *settings = settings_of(job->result->design);
  size_t count = (size_t)settings->points.si;
  double from = settings->from_Hz.si, to = settings->to_Hz.si;
  const struct dea_ac_excitation excitation = {
      .amplitude_V = settings->excitation_V.si,
      .damping_ratio = settings->damping.si,
      .damping_mass_per_s = settings->damping_mass_per_s.si,
      .damping_stiffness_s = settings->damping_stiffness_s.si};
  double *frequency_Hz = dea_alloc(ctx, count, sizeof *frequency_Hz);
  struct dea_load_point *points = dea_alloc(ctx, count, sizeof *points);
  dea_status status = frequency_Hz != NULL && points != NULL ? DEA_OK : DEA_E_MEMORY;
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    frequency_Hz[i] = from * pow(to / from, (double)i / (double)(count - 1));
  }
  if (status == DEA_OK) {
    status = type->respond(ctx, job->model, at, &excitation, frequency_Hz, count, points);
  }
  const double *answers =
      status == DEA_OK && type->answers != NULL ? type->answers(job->model) : NULL;
  if (status == DEA_OK) {
    status = add_points(ctx, answers != NULL ? job->result->device->layout : NULL, points, count,
                        answers, curve);
  }
  dea_free(ctx, frequency_Hz);
  dea_free(ctx, points);
  return status;
}

static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct settings *settings = settings_of(job->result->design);
  double biases_V[DEA_DESIGN_STOPS_MAX];
  for (size_t i = 0; i < settings->bias_count; i++) {
    biases_V[i] = settings->biases_V[i].si;
  }
  return dea_study_stop_by_stop(ctx, job, study_name, true, biases_V, settings->bias_count,
                                solve_frequencies);
}

// What moves -------------------------------------------------------------------------------------

static const double least_share = 1e-4; // of the largest amplitude: a monitor's less is not shown
static const char along_x[] = "_x_amplitude_m";

/* Points of a curve from one on that have its bias. */
static size_t count_bias(const struct dea_curve *curve, size_t from)
{
  size_t count = 0;
  while (from + count < curve->count &&
         curve->points[from + count].voltage_V == curve->points[from].voltage_V) {
    count++;
  }
  return count;
}

/* Points at one bias, and the columns of an amplitude and its phase; -1: none. */
struct line {
  const struct dea_load_point *points; // [count]
  size_t count;
  int amplitude, phase;
};

static double value_at(const struct line *line, int column, size_t i)
{
  return column >= 0 ? dea_point_get(&line->points[i], column) : NAN;
}

/* Largest amplitude, at least 0. */
static double largest_of(const struct line *line)
{
  double most = 0;
  for (size_t i = 0; i < line->count; i++) {
    most = fmax(most, value_at(line, line->amplitude, i)); // not of NAN
  }
  return most;
}

/* Column of the same monitor as one of an amplitude along x: of its amplitude or phase along an
 * axis; -1: none. */
static int column_along(const struct dea_context *ctx, int x_column, size_t axis, const char *what)
{
  const char *key = dea_column_at(ctx, x_column)->key;
  char text[128];
  snprintf(text, sizeof text, "%.*s%c_%s", (int)(strlen(key) - strlen(along_x) + 1), key,
           "xyz"[axis], what);
  return dea_column_find(ctx, text);
}

/* Whether a column is the amplitude along x of a monitor that a curve has. */
static bool is_monitor(const struct dea_context *ctx, const struct dea_curve *curve, int column)
{
  const char *key = dea_column_at(ctx, column)->key;
  return column >= DEA_LOAD_POINT_COLUMNS && dea_text_ends_with(key, along_x) &&
         dea_points_have(curve->points, curve->count, column);
}

/* Line of a monitor's motion along an axis at some points. */
static struct line monitor_line(const struct dea_context *ctx, const struct dea_load_point *points,
                                size_t count, int x_column, size_t axis)
{
  return (struct line){points, count, column_along(ctx, x_column, axis, "amplitude_m"),
                       column_along(ctx, x_column, axis, "phase_rad")};
}

/* Axis along which a monitor moves most, z where it does not; *largest: how much. */
static size_t main_axis(const struct dea_context *ctx, const struct dea_load_point *points,
                        size_t count, int x_column, double *largest)
{
  size_t axis = 2;
  *largest = 0;
  for (size_t k = 0; k < 3; k++) {
    const struct line line = monitor_line(ctx, points, count, x_column, k);
    const double most = largest_of(&line);
    axis = most > *largest ? k : axis;
    *largest = fmax(*largest, most);
  }
  return axis;
}

/* The same of all monitors of a curve. */
static size_t common_axis(const struct dea_context *ctx, const struct dea_curve *curve,
                          double *largest)
{
  size_t axis = 2;
  *largest = 0;
  for (int c = 0; c < dea_column_count(ctx); c++) {
    double most;
    const size_t own =
        is_monitor(ctx, curve, c) ? main_axis(ctx, curve->points, curve->count, c, &most) : 3;
    if (own < 3 && most > *largest) {
      *largest = most;
      axis = own;
    }
  }
  return axis;
}

/* One of what moves about a bias: centre and fibre tip of a disc, then the monitors. */
struct mover {
  int next; // where to look for the next one; at first 0
  bool monitor;
  size_t axis; // of a monitor
  char name[DEA_NAME_SIZE];
  struct line line;
};

/* Numbers 0 and 1, which are no columns of monitors, stand for centre and fibre tip. The next about
 * the bias of a curve's point `from`, of monitors the motion along an axis,
 * 3: that along which each moves most. False: there is no more. */
static bool find_mover(const struct dea_context *ctx, const struct dea_curve *curve, size_t from,
                       size_t axis, struct mover *m)
{
  const struct dea_load_point *points = curve->points + from;
  const size_t count = count_bias(curve, from), before = strlen("amplitude ");
  while (m->next < dea_column_count(ctx)) {
    const int c = m->next++;
    double most;
    m->monitor = is_monitor(ctx, curve, c);
    if (m->monitor) { // its title is "amplitude NAME x"
      const char *title = dea_column_at(ctx, c)->header;
      const size_t length = strlen(title);
      snprintf(m->name, sizeof m->name, "%.*s",
               length > before + 2 ? (int)(length - before - 2) : 0, title + before);
      m->axis = axis < 3 ? axis : main_axis(ctx, points, count, c, &most);
      m->line = monitor_line(ctx, points, count, c, m->axis);
      return true;
    }
    const bool tip = c == 1;
    if (c < 2) {
      snprintf(m->name, sizeof m->name, "%s", tip ? "fibre tip" : "centre");
      m->line =
          (struct line){points, count,
                        dea_point_column_find(tip ? "fibre_tip_amplitude_m" : "centre_amplitude_m"),
                        dea_point_column_find(tip ? "fibre_tip_phase_rad" : "centre_phase_rad")};
      if (isfinite(value_at(&m->line, m->line.amplitude, 0))) {
        return true;
      }
    }
  }
  return false;
}

// Figures ----------------------------------------------------------------------------------------

enum { COLOURS = 6 }; // the first of them

/* Amplitude in nm into the upper panel, phase in degrees without jumps into the lower one. */
static dea_status add_line(struct dea_context *ctx, struct dea_plot *plot, const struct line *line,
                           const struct dea_series *look)
{
  for (int p = 0; p < 2; p++) {
    double before = 0;
    struct dea_series *series;
    DEA_TRY(ctx, dea_panel_add_as(ctx, &plot->panels[p], line->count, look, &series));
    series->title[0] = p == 0 ? series->title[0] : '\0';
    for (size_t i = 0; i < line->count; i++) {
      double phase = value_at(line, line->phase, i); // the first is drawn from -90 to 270 degrees
      double turns =
          i == 0 ? (phase < -0.5 * DEA_PI ? 1 : 0) : round((before - phase) / (2 * DEA_PI));
      before = phase + 2 * DEA_PI * turns;
      series->values[i] = line->points[i].frequency_Hz;
      series->values[line->count + i] =
          p == 0 ? 1e9 * value_at(line, line->amplitude, i) : before * 180 / DEA_PI;
    }
  }
  return DEA_OK;
}

/* A colour a bias, a style each that moves: monitors by at least that much along an axis, or else
 * places of the disc. */
static dea_status add_curve(struct dea_context *ctx, struct dea_plot *plot,
                            const struct dea_curve *curve, bool monitors, size_t axis, double least)
{
  static const enum dea_series_style styles[] = {DEA_LINE, DEA_DASHED, DEA_THIN};
  size_t bias = 0;
  for (size_t from = 0; from < curve->count; from += count_bias(curve, from), bias++) {
    struct mover m = {.next = 0};
    size_t number = 0;
    while (find_mover(ctx, curve, from, axis, &m)) {
      if (m.monitor != monitors) {
        continue;
      }
      struct dea_series look = {.style = styles[number++ % DEA_COUNT(styles)],
                                .colour = (enum dea_colour)(bias % COLOURS)};
      char title[DEA_LABEL_SIZE];
      snprintf(title, sizeof title, "%.4g kV, %.60s", 1e-3 * curve->points[from].voltage_V, m.name);
      dea_label_escape(title, look.title, sizeof look.title);
      if (!monitors || largest_of(&m.line) > least) {
        DEA_TRY(ctx, add_line(ctx, plot, &m.line, &look));
      }
    }
  }
  return DEA_OK;
}

/* Around the points; above an amplitude with room for the key. */
static void set_limits(struct dea_panel *panel, bool amplitude)
{
  double low = INFINITY, high = -INFINITY;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    panel->x_min = series->values[0];
    panel->x_max = series->values[series->count - 1];
    for (size_t i = 0; i < series->count; i++) {
      low = fmin(low, series->values[series->count + i]);
      high = fmax(high, series->values[series->count + i]);
    }
  }
  panel->y_min = amplitude ? low / 1.5 : 90 * floor(low / 90 - 0.05);
  panel->y_max = amplitude ? high * 1.5 : 90 * ceil(high / 90 + 0.05);
}

/* bode, bode_monitors */
static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  const bool monitors = strcmp(plot->name, "bode_monitors") == 0;
  double ripple_V = NAN, largest = 0;
  size_t axis = 2;
  char along[32] = "";
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *curve = &result->curves[i];
    if (strcmp(curve->kind, study_name) == 0 && curve->count > 0) {
      ripple_V = curve->points[0].ripple_V;
      axis = monitors ? common_axis(ctx, curve, &largest) : axis;
      DEA_TRY(ctx, add_curve(ctx, plot, curve, monitors, axis, least_share * largest));
    }
  }
  plot->panel_count = 2;
  for (int p = 0; p < 2; p++) {
    struct dea_panel *panel = &plot->panels[p];
    snprintf(panel->x_label, sizeof panel->x_label, "Frequency {/:Italic f} (Hz)");
    set_limits(panel, p == 0);
    panel->logarithmic = p == 0;
    panel->logarithmic_x = p == 1;
    panel->y_step = p == 1 ? 90 : 0;
  }
  if (monitors) {
    snprintf(along, sizeof along, " of {/:Italic %c}", "xyz"[axis]);
  }
  snprintf(plot->panels[0].y_label, sizeof plot->panels[0].y_label, "Amplitude%s for %.4g V (nm)",
           along, ripple_V);
  snprintf(plot->panels[1].y_label, sizeof plot->panels[1].y_label, "Phase (degrees)");
  plot->panels[0].key = "top left samplen 2";
  plot->second_height = 0.7;
  return DEA_OK;
}

static const struct dea_figure figures[] = {
    DEA_STUDY_FIGURE("bode", study_name, build,
                     "displacement that a small AC excitation of the voltage makes, and its phase"),
    DEA_STUDY_FIGURE(
        "bode_monitors", study_name, build,
        "displacement of the monitors that a small AC excitation of the voltage makes, "
        "along the axis that they move along most, and its phase"),
};

// Peaks, for the terminal ------------------------------------------------------------------------

static const struct dea_result_column peak_columns[] = {
    DEA_KV("voltage_V", "V", "bias"),
    DEA_TEXT_COLUMN("moves", "moves", "centre, fibre tip, or a monitor and its axis"),
    DEA_TEXT_COLUMN("at", "at",
                    "the lowest frequency, a peak, or the highest where it still rises"),
    DEA_NUMBER_COLUMN("frequency_Hz", "Hz", "Hz", 1, "frequency", "the computed one"),
    DEA_NUMBER_COLUMN("amplitude_m", "m", "nm", 1e9, "amplitude", "that the excitation makes"),
    DEA_NUMBER_COLUMN("phase_rad", "rad", "deg", 57.29577951308232, "phase",
                      "against the excitation"),
    DEA_NUMBER_COLUMN("gain", "1", "1", 1, "times the lowest",
                      "amplitude over that at the lowest frequency"),
    DEA_TEXT_COLUMN("flags", "flags", "why the state at the bias is not to be trusted"),
};
static const struct dea_result_table_type peak_table =
    DEA_RESULT_TABLE(study_name, "peaks", peak_columns,
                     .title = "amplitudes and their peaks, among the computed frequencies",
                     .where = DEA_IN_SCREEN); // CSV and JSON have its points

static const double least_peak = 1e-3; // of the line's largest amplitude: less is not listed

/* What the line says at index i: NULL for nothing. */
static const char *peak_word(const struct line *line, size_t i, double most)
{
  const double a = value_at(line, line->amplitude, i);
  if (i == 0) {
    return "lowest frequency";
  }
  const bool rises = a > value_at(line, line->amplitude, i - 1);
  if (i + 1 == line->count) {
    return rises && a >= most ? "highest, still rising" : NULL;
  }
  const bool peak = a >= value_at(line, line->amplitude, i + 1) && a >= least_peak * most;
  return rises && peak ? "peak" : NULL;
}

/* Rows of a line, with the flags of the state at its bias. */
static dea_status add_peaks(struct dea_context *ctx, const struct line *line, const char *moves,
                            struct dea_result_table *table)
{
  const double most = largest_of(line);
  for (size_t i = 0; i < line->count; i++) {
    const struct dea_load_point *at = line->points;
    const double amplitude_m = value_at(line, line->amplitude, i);
    const char *word = peak_word(line, i, most);
    char flags[DEA_FLAGS_SIZE];
    if (word != NULL) {
      DEA_TRY(ctx, DEA_TABLE_ADD(ctx, table, DEA_CELL(at->voltage_V), DEA_TEXT_CELL(moves),
                                 DEA_TEXT_CELL(word), DEA_CELL(at[i].frequency_Hz),
                                 DEA_CELL(amplitude_m), DEA_CELL(value_at(line, line->phase, i)),
                                 DEA_CELL(amplitude_m / value_at(line, line->amplitude, 0)),
                                 DEA_TEXT_CELL(dea_flags_text(dea_load_point_flags(at), flags))));
    }
  }
  return DEA_OK;
}

/* All that moves about one bias, monitors along the axis of each; `from`: its first point in the
 * curve. */
static dea_status add_bias(struct dea_context *ctx, const struct dea_curve *curve, size_t from,
                           struct dea_result_table *table)
{
  struct mover m = {.next = 0};
  double largest;
  common_axis(ctx, curve, &largest);
  while (find_mover(ctx, curve, from, 3, &m)) {
    char moves[DEA_NAME_SIZE + 8];
    if (m.monitor) {
      snprintf(moves, sizeof moves, "%.60s, %c", m.name, "xyz"[m.axis]);
    } else {
      snprintf(moves, sizeof moves, "%.60s", m.name);
    }
    if (!m.monitor || largest_of(&m.line) > least_share * largest) {
      DEA_TRY(ctx, add_peaks(ctx, &m.line, moves, table));
    }
  }
  return DEA_OK;
}

static dea_status tables(struct dea_context *ctx, const char *model, struct dea_result *result)
{
  struct dea_result_table *table;
  const struct dea_curve *curve = dea_result_find(result, model, study_name);
  if (curve == NULL || curve->count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &peak_table, model, 0, &table));
  for (size_t from = 0; from < curve->count; from += count_bias(curve, from)) {
    DEA_TRY(ctx, add_bias(ctx, curve, from, table));
  }
  return DEA_OK;
}

// The study --------------------------------------------------------------------------------------

static bool asked(const struct dea_design *design)
{
  const struct settings *settings = settings_of(design);
  return settings != NULL && settings->bias_count > 0;
}

static dea_status refuse(struct dea_context *ctx, const struct dea_design *design,
                         const struct dea_device *device)
{
  static const char why[] = "the study 'frequency' needs the field V/h: take compute.solid.field: "
                            "thin, or leave compute.frequency away";
  const struct dea_choice *field = &design->compute.solid.field;
  return field->value == DEA_FIELD_COUPLED
             ? dea_refuse(ctx, field->location, why)
             : dea_device_refuse_densities(ctx, settings_of(design)->biases_V[0].location, device);
}

const struct dea_study dea_study_frequency = {
    .name = study_name,
    .keys = &section,
    .asked = asked,
    .needs = "compute.frequency.bias",
    .own_models = true,
    .ability = "vibrations",
    .able_by = offsetof(struct dea_model_type, respond),
    .refuse = refuse,
    .run = run,
    .tables = tables,
    .figures = figures,
    .figure_count = DEA_COUNT(figures),
};
