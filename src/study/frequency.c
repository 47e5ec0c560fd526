/* Study "frequency": amplitude and phase of the displacements that a small AC excitation of the
 * voltage makes about a bias. */
#include "base/schema.h"
#include "study/study.h"

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
    {.key = "bias",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(biases_V),
     .unit = "V",
     .above_min = true,
     .max = 1e6,
     .list_min = 1,
     .list_max = DEA_DESIGN_STOPS_MAX,
     .element_size = sizeof(struct dea_quantity),
     .count_offset = AT(bias_count),
     .doc = "voltages that the excitation lies upon, in the order to be computed",
     .example = "[4 kV, 6 kV]"},
    {.key = "excitation",
     .alias = "ripple",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(excitation_V),
     .unit = "V",
     .above_min = true,
     .max = 1e6,
     .default_text = "1 V",
     .doc = "amplitude of the excitation: small against the bias",
     .example = "100 V"},
    {.key = "from",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(from_Hz),
     .unit = "Hz",
     .above_min = true,
     .max = 1e6,
     .default_text = "1 Hz",
     .doc = "lowest frequency",
     .example = "1 Hz"},
    {.key = "to",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(to_Hz),
     .unit = "Hz",
     .above_min = true,
     .max = 1e6,
     .default_text = "2 kHz",
     .doc = "highest frequency",
     .example = "1 kHz"},
    {.key = "points",
     .kind = DEA_FIELD_INTEGER,
     .offset = AT(points),
     .unit = "1",
     .min = 2,
     .max = 10000,
     .default_text = "400",
     .doc = "how many frequencies, evenly by their logarithm",
     .example = "400"},
    {.key = "damping",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(damping),
     .unit = "1",
     .max = 10,
     .default_text = "0.02",
     .doc =
         "viscous damping of each mode over its critical one; an assumption, not a measured value",
     .example = "0.05"},
    {.key = "alpha",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(damping_mass_per_s),
     .unit = "Hz",
     .max = 1e9,
     .default_text = "0 Hz",
     .doc = "alpha of viscous damping alpha M + beta K beside that, by the mass",
     .example = "10 Hz"},
    {.key = "beta",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(damping_stiffness_s),
     .unit = "s",
     .max = 1e3,
     .default_text = "0 s",
     .doc = "beta of viscous damping alpha M + beta K beside that, by the stiffness",
     .example = "10 us"},
};

static const struct dea_record record = {
    study_name, "study of the response to a small AC excitation of the voltage about a bias (3d)",
    fields, sizeof fields / sizeof fields[0]};

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
    .key = study_name, .record = &record, .size = sizeof(struct settings), .check = check};

static const struct settings *settings_of(const struct dea_design *design)
{
  const struct dea_settings *given = dea_design_settings(design, &section);
  return given != NULL ? given->values : NULL;
}

// Tables -----------------------------------------------------------------------------------------

/* Amplitude and phase of a motion of monitors. */
#define MOTION(key, unit_suffix, si, display, scale, head)                                         \
  DEA_NUMBER_COLUMN(key "_amplitude" unit_suffix, si, display, scale, "amplitude " head,           \
                    "of the motion that the excitation makes"),                                    \
      DEA_NUMBER_COLUMN(key "_phase_rad", "rad", "deg", 57.29577951308232, "phase " head,          \
                        "against the excitation")

enum { MONITOR = 2, BEFORE }; // columns before the motions
enum { X = BEFORE + 2 * DEA_OBSERVED_X, Z = BEFORE + 2 * DEA_OBSERVED_Z };

/* In the order of enum dea_observed. */
static const struct dea_result_column monitor_columns[] = {
    DEA_NUMBER_COLUMN("voltage_V", "V", "kV", 1e-3, "V", "bias"),
    DEA_NUMBER_COLUMN("frequency_Hz", "Hz", "Hz", 1, "frequency", "of the excitation"),
    {.key = "monitor", .kind = DEA_CELL_TEXT, .title = "monitor", .meaning = "name in the design"},
    MOTION("x", "_m", "m", "nm", 1e9, "x"),
    MOTION("y", "_m", "m", "nm", 1e9, "y"),
    MOTION("z", "_m", "m", "nm", 1e9, "z"),
    MOTION("turn_x", "_rad", "rad", "deg", 57.29577951308232, "turn x"),
    MOTION("turn_y", "_rad", "rad", "deg", 57.29577951308232, "turn y"),
    MOTION("turn_z", "_rad", "rad", "deg", 57.29577951308232, "turn z"),
    MOTION("stretch", "", "1", "1", 1, "stretch"),
    MOTION("stretch_x", "", "1", "1", 1, "stretch x"),
    MOTION("stretch_y", "", "1", "1", 1, "stretch y"),
    MOTION("area_stretch", "", "1", "1", 1, "area stretch"),
};
enum { MONITOR_COLUMNS = sizeof monitor_columns / sizeof monitor_columns[0] };
_Static_assert(MONITOR_COLUMNS == BEFORE + 2 * DEA_OBSERVED_MOTIONS, "two columns a motion");

static const struct dea_result_table_type monitors = {.study = study_name,
                                                      .name = "monitors",
                                                      .title = "Monitors by frequency",
                                                      .where = DEA_IN_CSV,
                                                      .columns = monitor_columns,
                                                      .column_count = MONITOR_COLUMNS};

/* Rows of what monitors did at the frequencies of one bias. */
static dea_status add_monitors(struct dea_context *ctx, const char *model,
                               const struct dea_load_point *points, size_t count,
                               const double *answers, struct dea_result *result)
{
  const struct dea_layout *layout = result->device->layout;
  const struct dea_result_table *there =
      dea_result_find_table(result, model, study_name, monitors.name);
  struct dea_result_table *table = NULL;
  if (there == NULL) {
    DEA_TRY(ctx, dea_result_add_table(ctx, result, &monitors, model, 0, &table));
  } else {
    table = &result->tables[there - result->tables];
  }
  for (size_t i = 0; i < count * layout->monitor_count; i++) {
    const struct dea_load_point *p = &points[i / layout->monitor_count];
    struct dea_result_table_value row[MONITOR_COLUMNS] = {
        {.number = p->voltage_V},
        {.number = p->frequency_Hz},
        {.text = layout->monitors[i % layout->monitor_count].name}};
    for (size_t k = 0; k < DEA_OBSERVED_MOTIONS; k++) {
      const double *part = answers + 2 * (i * DEA_OBSERVED_MOTIONS + k);
      row[BEFORE + 2 * k].number = hypot(part[0], part[1]);
      row[BEFORE + 2 * k + 1].number = atan2(part[1], part[0]);
    }
    DEA_TRY(ctx, dea_result_table_add_row(ctx, table, row));
  }
  return DEA_OK;
}

// Study ------------------------------------------------------------------------------------------

/* All frequencies at one bias. */
static dea_status take(struct dea_context *ctx, const struct dea_model_type *type,
                       struct dea_model *model, const struct dea_load_point *at, size_t stop,
                       struct dea_result *result, struct dea_curve *curve)
{
  (void)stop;
  const struct settings *settings = settings_of(result->design);
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
    status = dea_model_respond(ctx, type, model, at, &excitation, frequency_Hz, count, points);
  }
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    status = dea_curve_add_point(ctx, curve, &points[i]);
  }
  const double *answers = type->answers != NULL ? type->answers(model) : NULL;
  if (status == DEA_OK && answers != NULL) {
    status = add_monitors(ctx, type->name, points, count, answers, result);
  }
  dea_free(ctx, frequency_Hz);
  dea_free(ctx, points);
  return status;
}

static dea_status run(struct dea_context *ctx, const struct dea_model_type *type,
                      struct dea_model *model, struct dea_result *result)
{
  (void)model; // none
  const struct settings *settings = settings_of(result->design);
  double biases_V[DEA_DESIGN_STOPS_MAX];
  for (size_t i = 0; i < settings->bias_count; i++) {
    biases_V[i] = settings->biases_V[i].si;
  }
  DEA_TRY(ctx, dea_study_stop_by_stop(ctx, type, result, study_name, true, biases_V,
                                      settings->bias_count, take));
  return DEA_OK;
}

// Figures ----------------------------------------------------------------------------------------

enum { COLOURS = 6 }; // the first of them
static const double pi = 3.14159265358979323846;

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

/* Frequencies, amplitudes and phases of a line, [count] each. */
struct line {
  size_t count;
  double *frequency_Hz, *amplitude_m, *phase_rad;
};

/* Memory of the first array is that of all. */
static dea_status line_create(struct dea_context *ctx, size_t count, struct line *out)
{
  double *memory = dea_alloc(ctx, 3 * count, sizeof *memory);
  *out = (struct line){.count = count, .frequency_Hz = memory};
  if (memory == NULL) {
    return DEA_E_MEMORY;
  }
  out->amplitude_m = memory + count;
  out->phase_rad = memory + 2 * count;
  return DEA_OK;
}

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
      double phase = line->phase_rad[i]; // the first is drawn from -90 to 270 degrees
      double turns = i == 0 ? (phase < -0.5 * pi ? 1 : 0) : round((before - phase) / (2 * pi));
      before = phase + 2 * pi * turns;
      series->values[i] = line->frequency_Hz[i];
      series->values[line->count + i] = p == 0 ? 1e9 * line->amplitude_m[i] : before * 180 / pi;
    }
  }
  return DEA_OK;
}

/* Of the centre or of the tip. */
static dea_status add_answer(struct dea_context *ctx, struct dea_plot *plot,
                             const struct dea_load_point *points, size_t count, bool tip,
                             const struct dea_series *look)
{
  struct line line;
  DEA_TRY(ctx, line_create(ctx, count, &line));
  for (size_t i = 0; i < count; i++) {
    line.frequency_Hz[i] = points[i].frequency_Hz;
    line.amplitude_m[i] = tip ? points[i].fibre_tip_amplitude_m : points[i].centre_amplitude_m;
    line.phase_rad[i] = tip ? points[i].fibre_tip_phase_rad : points[i].centre_phase_rad;
  }
  dea_status status = add_line(ctx, plot, &line, look);
  dea_free(ctx, line.frequency_Hz);
  return status;
}

static dea_status add_curve(struct dea_context *ctx, struct dea_plot *plot,
                            const struct dea_curve *curve)
{
  size_t bias = 0;
  for (size_t from = 0; from < curve->count; bias++) {
    const struct dea_load_point *points = curve->points + from;
    size_t count = count_bias(curve, from);
    bool tip = isfinite(points[0].fibre_tip_amplitude_m);
    for (int k = 0; k < (tip ? 2 : 1) && isfinite(points[0].centre_amplitude_m); k++) {
      struct dea_series look = {.style = k == 0 ? DEA_LINE : DEA_DASHED,
                                .colour = (enum dea_colour)(bias % COLOURS)};
      snprintf(look.title, sizeof look.title, "%.4g kV, %s", 1e-3 * points[0].voltage_V,
               k == 0 ? "centre" : "fibre tip");
      DEA_TRY(ctx, add_answer(ctx, plot, points, count, k == 1, &look));
    }
    from += count;
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

/* Of two panels with lines. axis: of the displacement, 0: it is told elsewhere. */
static void finish(struct dea_plot *plot, double ripple_V, char axis)
{
  plot->panel_count = 2;
  for (int p = 0; p < 2; p++) {
    struct dea_panel *panel = &plot->panels[p];
    snprintf(panel->x_label, sizeof panel->x_label, "Frequency {/:Italic f} (Hz)");
    set_limits(panel, p == 0);
    panel->logarithmic = p == 0;
    panel->logarithmic_x = p == 1;
    panel->y_step = p == 1 ? 90 : 0;
  }
  char along[32] = "";
  if (axis != 0) {
    snprintf(along, sizeof along, " of {/:Italic %c}", axis);
  }
  snprintf(plot->panels[0].y_label, sizeof plot->panels[0].y_label, "Amplitude%s for %.4g V (nm)",
           along, ripple_V);
  snprintf(plot->panels[1].y_label, sizeof plot->panels[1].y_label, "Phase (degrees)");
  plot->panels[0].key = "top left samplen 2";
  plot->second_height = 0.7;
}

/* Amplitude of the excitation; NAN where there is no such curve. */
static double ripple_of(const struct dea_result *result)
{
  double ripple_V = NAN;
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *curve = &result->curves[i];
    if (strcmp(curve->kind, study_name) == 0 && curve->count > 0) {
      ripple_V = curve->points[0].ripple_V;
    }
  }
  return ripple_V;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  for (size_t i = 0; i < result->curve_count; i++) {
    if (strcmp(result->curves[i].kind, study_name) == 0) {
      DEA_TRY(ctx, add_curve(ctx, plot, &result->curves[i]));
    }
  }
  finish(plot, ripple_of(result), 0);
  return DEA_OK;
}

static const double least_share = 1e-4; // of the largest amplitude: less is not drawn

/* Column of the amplitude that is largest anywhere, of x, y and z; *largest: it, at least 0. */
static size_t main_column(const struct dea_result_table *table, double *largest)
{
  size_t column = Z;
  *largest = 0;
  for (size_t c = X; c <= Z; c += 2) {
    for (size_t i = 0; i < table->row_count; i++) {
      double amplitude = dea_result_table_cell(table, i, c)->number;
      if (amplitude > *largest) { // not NAN
        *largest = amplitude;
        column = c;
      }
    }
  }
  return column;
}

/* A motion of the monitor in a row, in all rows of its name and bias; nothing for one that has none
 * of at least that much. */
static dea_status add_monitor(struct dea_context *ctx, struct dea_plot *plot,
                              const struct dea_result_table *table, size_t row, size_t column,
                              double least, enum dea_colour colour, enum dea_series_style style)
{
  double bias_V = dea_result_table_cell(table, row, 0)->number;
  const char *name = dea_result_table_cell(table, row, MONITOR)->text;
  struct dea_series look = {.style = style, .colour = colour};
  char title[DEA_LABEL_SIZE];
  struct line line;
  snprintf(title, sizeof title, "%.4g kV, %.60s", 1e-3 * bias_V, name);
  dea_label_escape(title, look.title, sizeof look.title);
  DEA_TRY(ctx, line_create(ctx, table->row_count, &line));
  line.count = 0;
  double most = 0;
  for (size_t i = row; i < table->row_count; i++) {
    if (dea_result_table_cell(table, i, 0)->number == bias_V &&
        strcmp(dea_result_table_cell(table, i, MONITOR)->text, name) == 0) {
      line.frequency_Hz[line.count] = dea_result_table_cell(table, i, 1)->number;
      most = fmax(most, dea_result_table_cell(table, i, column)->number); // not of NAN
      line.amplitude_m[line.count] = dea_result_table_cell(table, i, column)->number;
      line.phase_rad[line.count++] = dea_result_table_cell(table, i, column + 1)->number;
    }
  }
  dea_status status = most > least ? add_line(ctx, plot, &line, &look) : DEA_OK;
  dea_free(ctx, line.frequency_Hz);
  return status;
}

/* A colour a bias, a style a monitor. */
static dea_status build_monitors(struct dea_context *ctx, const struct dea_result *result,
                                 struct dea_plot *plot)
{
  static const enum dea_series_style styles[] = {DEA_LINE, DEA_DASHED, DEA_THIN};
  size_t column = Z;
  for (size_t t = 0; t < result->table_count; t++) {
    const struct dea_result_table *table = &result->tables[t];
    size_t bias = 0, monitor = 0;
    double largest;
    if (strcmp(table->type.study, study_name) != 0 ||
        strcmp(table->type.name, monitors.name) != 0) {
      continue;
    }
    column = main_column(table, &largest);
    for (size_t i = 0; i < table->row_count; i++) {
      double V = dea_result_table_cell(table, i, 0)->number;
      bool first = i == 0 || dea_result_table_cell(table, i - 1, 0)->number != V;
      bias += first && i > 0 ? 1 : 0;
      monitor = first ? 0 : monitor + 1;
      double lowest_Hz = dea_result_table_cell(table, i - monitor, 1)->number;
      if (dea_result_table_cell(table, i, 1)->number == lowest_Hz) {
        DEA_TRY(ctx, add_monitor(ctx, plot, table, i, column, least_share * largest,
                                 (enum dea_colour)(bias % COLOURS),
                                 styles[monitor % (sizeof styles / sizeof styles[0])]));
      }
    }
  }
  finish(plot, ripple_of(result), "xyz"[(column - X) / 2]);
  return DEA_OK;
}

static const struct dea_figure figures[] = {
    {
        .name = "bode",
        .study = study_name,
        .caption = "displacement that a small AC excitation of the voltage makes, and its phase",
        .build = build,
    },
    {
        .name = "bode_monitors",
        .study = study_name,
        .caption = "displacement of the monitors that a small AC excitation of the voltage makes, "
                   "along the axis that they move along most, and its phase",
        .build = build_monitors,
    },
};

// Peaks, for the terminal ------------------------------------------------------------------------

static const struct dea_result_column peak_columns[] = {
    DEA_NUMBER_COLUMN("voltage_V", "V", "kV", 1e-3, "V", "bias"),
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
static const struct dea_result_table_type peak_table = {
    .study = study_name,
    .name = "peaks",
    .title = "amplitudes and their peaks, among the computed frequencies",
    .where = DEA_IN_SCREEN, // CSV and JSON have its points
    .columns = peak_columns,
    .column_count = sizeof peak_columns / sizeof peak_columns[0]};

static const double least_peak = 1e-3; // of the line's largest amplitude: less is not listed

/* What the line says at index i: NULL for nothing. */
static const char *peak_word(const struct line *line, size_t i, double most)
{
  const double *a = line->amplitude_m;
  const bool rises = i > 0 && a[i] > a[i - 1], last = i + 1 == line->count;
  if (i == 0) {
    return "lowest frequency";
  }
  if (last) {
    return rises && a[i] >= most ? "highest, still rising" : NULL;
  }
  return rises && a[i] >= a[i + 1] && a[i] >= least_peak * most ? "peak" : NULL;
}

/* Rows of a line about the bias of `at`, whose flags they have. */
static dea_status add_peaks(struct dea_context *ctx, const struct line *line, const char *moves,
                            const struct dea_load_point *at, struct dea_result_table *table)
{
  double most = 0;
  for (size_t i = 0; i < line->count; i++) {
    most = fmax(most, line->amplitude_m[i]);
  }
  for (size_t i = 0; i < line->count; i++) {
    const char *word = peak_word(line, i, most);
    char flags[DEA_FLAGS_SIZE];
    const struct dea_result_table_value row[] = {
        {.number = at->voltage_V},
        {.text = moves},
        {.text = word},
        {.number = line->frequency_Hz[i]},
        {.number = line->amplitude_m[i]},
        {.number = line->phase_rad[i]},
        {.number = line->amplitude_m[i] / line->amplitude_m[0]},
        {.text = dea_flags_text(dea_load_point_flags(at), flags)}};
    if (word != NULL) {
      DEA_TRY(ctx, dea_result_table_add_row(ctx, table, row));
    }
  }
  return DEA_OK;
}

/* Of a monitor, which stands `offset` rows after the first of each frequency, along its main axis;
 * nothing of one that moves less than `least`. points: of the bias. */
static dea_status add_monitor_peaks(struct dea_context *ctx, const struct dea_result_table *told,
                                    size_t first, size_t monitors_there, size_t offset,
                                    double least, const struct dea_load_point *points,
                                    struct line *line, struct dea_result_table *table)
{
  size_t column = Z;
  double most = 0;
  char moves[DEA_NAME_SIZE + 8];
  for (size_t c = X; c <= Z; c += 2) {
    for (size_t i = 0; i < line->count; i++) {
      double a = dea_result_table_cell(told, first + i * monitors_there + offset, c)->number;
      column = a > most ? c : column; // not NAN
      most = fmax(most, a);
    }
  }
  if (!(most > least)) {
    return DEA_OK;
  }
  for (size_t i = 0; i < line->count; i++) {
    size_t row = first + i * monitors_there + offset;
    line->frequency_Hz[i] = points[i].frequency_Hz;
    line->amplitude_m[i] = dea_result_table_cell(told, row, column)->number;
    line->phase_rad[i] = dea_result_table_cell(told, row, column + 1)->number;
  }
  snprintf(moves, sizeof moves, "%.60s, %c",
           dea_result_table_cell(told, first + offset, MONITOR)->text, "xyz"[(column - X) / 2]);
  DEA_TRY(ctx, add_peaks(ctx, line, moves, points, table));
  return DEA_OK;
}

/* All that moves about one bias; `from`: its first point in the curve. */
static dea_status add_bias(struct dea_context *ctx, const struct dea_curve *curve, size_t from,
                           const struct dea_result_table *told, struct line *line,
                           struct dea_result_table *table)
{
  const struct dea_load_point *points = curve->points + from;
  for (int tip = 0; tip < 2; tip++) {
    for (size_t i = 0; i < line->count; i++) {
      line->frequency_Hz[i] = points[i].frequency_Hz;
      line->amplitude_m[i] = tip ? points[i].fibre_tip_amplitude_m : points[i].centre_amplitude_m;
      line->phase_rad[i] = tip ? points[i].fibre_tip_phase_rad : points[i].centre_phase_rad;
    }
    if (isfinite(line->amplitude_m[0])) {
      DEA_TRY(ctx, add_peaks(ctx, line, tip ? "fibre tip" : "centre", points, table));
    }
  }
  double largest = 0;
  size_t there = told != NULL ? told->row_count / curve->count : 0;
  if (there > 0) {
    main_column(told, &largest);
  }
  for (size_t k = 0; k < there; k++) {
    DEA_TRY(ctx, add_monitor_peaks(ctx, told, from * there, there, k, least_share * largest, points,
                                   line, table));
  }
  return DEA_OK;
}

static dea_status tables(struct dea_context *ctx, const char *model, struct dea_result *result)
{
  struct dea_result_table *table;
  const struct dea_curve *curve = dea_result_find(result, model, study_name);
  dea_status status = DEA_OK;
  if (curve == NULL || curve->count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &peak_table, model, 0, &table));
  const struct dea_result_table *told =
      dea_result_find_table(result, model, study_name, monitors.name);
  for (size_t from = 0, count; from < curve->count && status == DEA_OK; from += count) {
    struct line line;
    count = count_bias(curve, from);
    DEA_TRY(ctx, line_create(ctx, count, &line));
    status = add_bias(ctx, curve, from, told, &line, table);
    dea_free(ctx, line.frequency_Hz);
  }
  return status;
}

// The study --------------------------------------------------------------------------------------

static bool asked(const struct dea_design *design)
{
  const struct settings *settings = settings_of(design);
  return settings != NULL && settings->bias_count > 0;
}

static bool able(const struct dea_model_type *type, const struct dea_result *result)
{
  (void)result;
  return type->respond != NULL;
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
    .any_layout = true,
    .ability = "vibrations",
    .able = able,
    .refuse = refuse,
    .run = run,
    .tables = tables,
    .figures = figures,
    .figure_count = sizeof figures / sizeof figures[0],
};
