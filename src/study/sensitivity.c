/* Study "sensitivity": what matters. Slopes of a model's answers by the numbers of the design, by
 * one per cent of each and by the workshop's tolerances (docs/theory/gradients.md). */
#include "base/schema.h"
#include "result/columns.h"
#include "study/design_gradient.h"
#include "study/force.h"
#include "study/limit_slopes.h"
#include "study/loading.h"
#include "study/modal.h"
#include "study/number_rows.h"
#include "study/observe.h"
#include "study/study.h"

#include <math.h>
#include <stddef.h>

static const char study_name[] = "sensitivity";

// Keys -------------------------------------------------------------------------------------------

/* Settings of compute.sensitivity. */
struct settings {
  struct dea_quantity voltages_V[DEA_DESIGN_STOPS_MAX]; // none: the highest of the run
  size_t voltage_count;
  struct dea_quantity stretches[DEA_DESIGN_STOPS_MAX];
  size_t stretch_count;
  struct dea_quantity modes;
};

#define AT(member) offsetof(struct settings, member)

static const struct dea_field fields[] = {
    DEA_STUDY_STOPS_FIELD("the highest that the run has reached",
                          "voltages at which it is asked what matters", "[4 kV, 6 kV]"),
    DEA_NUMBER_ROW(
        "stretch", AT(stretches), "1", "[1.2, 1.5]",
        "stretches of the electrode's edge (1 at rest) that the path is followed to, through limit "
        "points: what matters to the voltage and the rest at such a stretch",
        .min = 1, .above_min = true, .max = 20,
        DEA_LIST(1, DEA_DESIGN_STOPS_MAX, struct dea_quantity, AT(stretch_count))),
    DEA_INTEGER_ROW(
        "modes", AT(modes), "3",
        "with study modal: of how many frequencies, from the lowest on, slopes are wanted",
        .min = 1, .max = DEA_DESIGN_MODES_MAX, .default_text = "1"),
};

static const struct dea_design_section section = {
    .record = {study_name,
               "study of sensitivity, made when this section is there ({}) or with --sensitivity: "
               "slopes by the numbers of the design of displacements, field, tension, capacitance "
               "and energy, with studies modal, force and loading of what they add, and of "
               "critical voltages that the run has reached",
               fields, DEA_COUNT(fields)},
    .size = sizeof(struct settings)};

// Tables -----------------------------------------------------------------------------------------

/* Quantities that are asked for, in the order of the columns below; the first that a model knows is
 * what the table is sorted by. */
static const char *const quantities[] = {"force_N",
                                         "fibre_tip_z_m",
                                         "centre_z_m",
                                         "electrode_edge_u_m",
                                         "true_field_V_per_m",
                                         "breakdown_margin",
                                         "min_tension_N_per_m",
                                         "capacitance_F",
                                         "energy_J",
                                         "frequency_Hz",
                                         "voltage_V"};
enum {
  QUANTITIES = DEA_COUNT(quantities),
  FORCE = 0,
  CAPACITANCE = 7,
  FREQUENCY = 9,
  FOLLOWING = 10, // the voltage, where the stretch is held
};

/* Columns that tables share. */
#define VOLTAGE DEA_KV("voltage_V", "V", "voltage")
#define TIP_DEPTH DEA_MM("tip_depth_m", "tip depth", "of a film that a tip is pressed into")
#define HELD_STRETCH                                                                               \
  DEA_NUMBER_COLUMN("held_stretch", "1", "1", 1, "held stretch",                                   \
                    "of the electrode, where that is held and the voltage follows")
#define LOADED                                                                                     \
  DEA_BARE("loaded", "loaded to",                                                                  \
           "last value of compute.loading, SI, where its body or pressures are")
#define ELASTICITY(key, title) DEA_BARE(key, title, "its change in per cent by one per cent")
#define FLAGS DEA_TEXT_COLUMN("flags", "flags", "why the state there is not to be trusted")

static const struct dea_result_column slope_columns[] = {
    VOLTAGE,
    DEA_NUMBER_IN_ROW,
    DEA_RESULT_COLUMN(QUANTITY, "quantity", "quantity",
                      .meaning = "of load points, or of a monitor"),
    DEA_RESULT_COLUMN(VALUE, "value", "quantity's value", .meaning = "there"),
    DEA_BARE("slope", "slope", "of the quantity by the number, SI units of both"),
    DEA_BARE("elasticity", "per cent by one per cent",
             "d ln(quantity) / d ln(number); of a stretch that of the stretch less 1"),
    DEA_NUMBER_TOLERANCE,
    DEA_RESULT_COLUMN(VALUE, "change", "change by tolerance", .meaning = "of the quantity"),
    DEA_BARE("mode", "mode", "that a frequency is of, from 1, the lowest"),
    TIP_DEPTH,
    HELD_STRETCH,
    LOADED,
    FLAGS,
};
static const struct dea_result_table_type slope_table =
    DEA_RESULT_TABLE(study_name, "slopes", slope_columns, .title = "slopes by the design's numbers",
                     .where = DEA_IN_JSON | DEA_IN_CSV);

static const struct dea_result_column matter_columns[] = {
    VOLTAGE,
    TIP_DEPTH,
    HELD_STRETCH,
    LOADED,
    DEA_TEXT_COLUMN("quantity", "quantity", "that the rows are sorted by: motion of a monitor"),
    DEA_TEXT_COLUMN("number", "1 % of", "of the design"),
    DEA_TEXT_COLUMN("number_text", "value", "of the number"),
    ELASTICITY("change", "changes it by, %"),
    ELASTICITY("force_N", "force, %"),
    ELASTICITY("fibre_tip_z_m", "z tip, %"),
    ELASTICITY("centre_z_m", "z centre, %"),
    ELASTICITY("electrode_edge_u_m", "u edge, %"),
    ELASTICITY("true_field_V_per_m", "field, %"),
    ELASTICITY("breakdown_margin", "margin, %"),
    ELASTICITY("min_tension_N_per_m", "tension, %"),
    ELASTICITY("capacitance_F", "capacitance, %"),
    ELASTICITY("energy_J", "energy, %"),
    ELASTICITY("frequency_Hz", "frequency, %"),
    ELASTICITY("voltage", "voltage, %"),
    DEA_TEXT_COLUMN("tolerance_text", "tolerance", "of the workshop"),
    DEA_TEXT_COLUMN("change_text", "changes",
                    "by the tolerance, of the quantity that the rows are sorted by"),
    FLAGS,
};
static const struct dea_result_table_type matter_table = DEA_RESULT_TABLE(
    study_name, "matters", matter_columns, .title = "what matters", .where = DEA_IN_SCREEN);

// Study ------------------------------------------------------------------------------------------

/* A quantity at a stop. */
struct quantity {
  int column;
  double value, rest; // NAN: not known; what it is at rest
  size_t mode;        // that a frequency is of, from 1; 0: it is none
};

/* One voltage. */
struct stop {
  struct dea_arena memory; // of the arrays
  double voltage_V;
  struct dea_load_point point;
  const struct dea_layout *layout; // with monitors or that is no disc; NULL: none
  struct quantity *of;             // [width]: QUANTITIES, monitors, then higher modes
  size_t width;
  size_t seen;                // of these without the modes
  size_t *monitors;           // [seen - QUANTITIES]
  enum dea_observed *motions; // [seen - QUANTITIES] main ones
  struct dea_design_number numbers[DEA_NUMBERS_MAX];
  size_t number_count;
  bool is_pressed;
  struct dea_pressed pressed;           // by this tip
  double mode_Hz[DEA_DESIGN_MODES_MAX]; // [mode_count]
  size_t mode_count;                    // of frequencies that are asked for; 0: none
  const struct dea_loaded *loaded;      // where study loading has ended; NULL: not there
  double stretch;                       // that is held in place of the voltage; 0: none
  double *slopes;                       // [number_count][width]; NAN of what is not asked for
};

static double slope_of(const struct stop *stop, size_t number, size_t quantity)
{
  return stop->slopes[number * stop->width + quantity];
}

static double elasticity(const struct stop *stop, size_t number, size_t quantity)
{
  const double value = stop->of[quantity].value - stop->of[quantity].rest;
  return value != 0 ? slope_of(stop, number, quantity) * stop->numbers[number].value / value : NAN;
}

/* The voltage where it follows, else the first quantity that the model knows at this point. */
static size_t leading(const struct stop *stop)
{
  size_t i = stop->stretch > 0 ? FOLLOWING : 0;
  while (i + 1 < QUANTITIES && !(fabs(stop->of[i].value) > 0)) {
    i++;
  }
  return i;
}

/* Cells of both tables that say under what the film is: tip depth, held stretch, loaded to. */
static void fill_under(const struct stop *stop, double out[3])
{
  out[0] = stop->is_pressed ? stop->pressed.depth_m : NAN;
  out[1] = stop->stretch > 0 ? stop->stretch : NAN;
  out[2] = stop->loaded != NULL ? stop->loaded->value : NAN;
}

/* Returns out. */
static const char *flags_of(const struct stop *stop, char out[DEA_FLAGS_SIZE])
{
  return dea_flags_text(dea_load_point_flags(&stop->point), out);
}

static dea_status add_matter(struct dea_context *ctx, const struct stop *stop, size_t lead,
                             size_t i, struct dea_result_table *table)
{
  const struct dea_design_number *number = &stop->numbers[i];
  const struct dea_column *column = dea_column_at(ctx, stop->of[lead].column);
  const bool seen = stop->layout != NULL;
  const struct dea_tolerated tolerated =
      dea_number_tolerated(number, slope_of(stop, i, lead), column->si_unit);
  char value[48], flags[DEA_FLAGS_SIZE];
  double under[3];
  fill_under(stop, under);
  dea_number_text(number->value, number->unit, value, sizeof value);
  struct dea_result_table_value row[DEA_COUNT(matter_columns)] = {
      {.number = stop->voltage_V},
      {.number = under[0]},
      {.number = under[1]},
      {.number = under[2]},
      {.number = NAN, .text = seen ? column->key : ""}, // hidden where it is empty
      {.text = number->key},
      {.text = value},
      {.number = seen ? elasticity(stop, i, lead) : NAN}};
  size_t n = 8;
  for (size_t k = 0; k < QUANTITIES; k++) {
    row[n++].number = elasticity(stop, i, k);
  }
  row[n++].text = tolerated.tolerance;
  row[n++].text = tolerated.change;
  row[n++].text = flags_of(stop, flags);
  return dea_result_table_add_row(ctx, table, row);
}

/* Numbers by how much they matter to a quantity, most first, and last those that only the frequency
 * depends on. */
static dea_status add_sorted(struct dea_context *ctx, const struct stop *stop, size_t lead,
                             struct dea_result_table *table)
{
  static const double least = 1e-100;
  double size[DEA_NUMBERS_MAX];
  size_t order[DEA_NUMBERS_MAX];
  for (size_t i = 0; i < stop->number_count; i++) {
    size[i] = fabs(elasticity(stop, i, lead));
    if (size[i] == 0 && stop->mode_count > 0) {
      size[i] = least * fabs(elasticity(stop, i, FREQUENCY));
    }
  }
  const size_t count = dea_numbers_order(size, stop->number_count, order);
  for (size_t n = 0; n < count; n++) {
    DEA_TRY(ctx, add_matter(ctx, stop, lead, order[n], table));
  }
  return DEA_OK;
}

static dea_status add_slopes(struct dea_context *ctx, const struct stop *stop,
                             struct dea_result_table *table)
{
  char flags[DEA_FLAGS_SIZE];
  double under[3];
  flags_of(stop, flags);
  fill_under(stop, under);
  for (size_t i = 0; i < stop->number_count * stop->width; i++) {
    const size_t n = i / stop->width, k = i % stop->width;
    const struct dea_design_number *number = &stop->numbers[n];
    const struct quantity *of = &stop->of[k];
    const double slope = slope_of(stop, n, k);
    if (!isnan(slope)) {
      DEA_TRY(ctx,
              DEA_TABLE_ADD(ctx, table, DEA_CELL(stop->voltage_V), DEA_TEXT_CELL(number->key),
                            DEA_CELL(number->value), DEA_TEXT_CELL(number->unit),
                            DEA_CELL((double)of->column), DEA_CELL(of->value), DEA_CELL(slope),
                            DEA_CELL(elasticity(stop, n, k)), DEA_CELL(number->tolerance),
                            DEA_CELL(slope * number->tolerance),
                            DEA_CELL(of->mode > 0 ? (double)of->mode : NAN), DEA_CELL(under[0]),
                            DEA_CELL(under[1]), DEA_CELL(under[2]), DEA_TEXT_CELL(flags)));
    }
  }
  return DEA_OK;
}

/* The motion that a monitor stands for: its main one, and of a body that study loading holds what
 * that takes. */
static enum dea_observed motion_of(const struct stop *stop, size_t i, const double *seen)
{
  const struct dea_layout_monitor *monitor = &stop->layout->monitors[i];
  const struct dea_control *control = stop->loaded != NULL ? &stop->loaded->control : NULL;
  const bool held = control != NULL && control->kind == DEA_CONTROL_PLACE &&
                    monitor->kind == DEA_MONITOR_BODY && monitor->body == control->body;
  return held ? (enum dea_observed)(DEA_OBSERVED_FORCE_X + control->component)
              : dea_observed_main(seen);
}

/* Monitors of the device, with their motions. */
static dea_status find_monitors(struct dea_context *ctx, const struct dea_study_job *job,
                                struct stop *stop)
{
  const size_t count = stop->layout->monitor_count;
  struct dea_observation seen;
  struct dea_monitor_column *columns;
  size_t column_count;
  stop->monitors = dea_arena_alloc(&stop->memory, count, sizeof *stop->monitors);
  stop->motions = dea_arena_alloc(&stop->memory, count, sizeof *stop->motions);
  DEA_TRY(ctx, dea_layout_columns(&stop->memory, stop->layout, &columns, &column_count));
  DEA_TRY(ctx, dea_arena_status(&stop->memory));
  DEA_TRY(ctx, job->type->observe(ctx, job->model, &seen));
  for (size_t i = 0; i < count; i++) {
    const enum dea_observed motion = motion_of(stop, i, seen.monitor[i]);
    struct quantity *of = &stop->of[QUANTITIES + i];
    stop->monitors[i] = i;
    stop->motions[i] = motion;
    of->value = seen.monitor[i][motion];
    of->rest = motion == DEA_OBSERVED_STRETCH || motion == DEA_OBSERVED_AREA_STRETCH ? 1 : 0;
  }
  for (size_t k = 0; k < column_count; k++) {
    const struct dea_monitor_column *c = &columns[k];
    if (c->source == DEA_OF_MONITOR && c->number == stop->motions[c->index]) {
      stop->of[QUANTITIES + c->index].column = c->column;
    }
  }
  return DEA_OK;
}

/* All that slopes are of. The force is a bound where no tip is, and a model knows one. */
static dea_status find_quantities(struct dea_context *ctx, const struct dea_study_job *job,
                                  struct stop *stop)
{
  const struct dea_device *device = job->result->device;
  const bool observed = job->type->observe != NULL && dea_device_is_observed(device);
  stop->layout = observed ? device->layout : NULL;
  stop->seen = QUANTITIES + (observed ? device->layout->monitor_count : 0);
  stop->width = stop->seen + (stop->mode_count > 1 ? stop->mode_count - 1 : 0);
  stop->of = dea_arena_alloc(&stop->memory, stop->width, sizeof *stop->of);
  DEA_TRY(ctx, dea_arena_status(&stop->memory));
  for (size_t k = 0; k < QUANTITIES; k++) {
    const int column = dea_point_column_find(quantities[k]);
    stop->of[k] = (struct quantity){
        .column = column,
        .value = k == FORCE && !stop->is_pressed ? NAN : dea_point_get(&stop->point, column),
        .mode = k == FREQUENCY ? 1 : 0};
  }
  for (size_t i = 1; i < stop->mode_count; i++) {
    stop->of[stop->seen + i - 1] = (struct quantity){
        .column = stop->of[FREQUENCY].column, .value = stop->mode_Hz[i], .mode = i + 1};
  }
  return observed ? find_monitors(ctx, job, stop) : DEA_OK;
}

/* The lowest modes, where study modal is asked for or has run by its name. */
static dea_status find_frequency(struct dea_context *ctx, const struct dea_study_job *job,
                                 struct stop *stop)
{
  const struct dea_model_type *type = job->type;
  const struct dea_result *result = job->result;
  struct dea_load_point modes[DEA_DESIGN_MODES_MAX];
  struct dea_field_mesh *shapes;
  const struct settings *settings = dea_design_settings(result->design, &section)->values;
  const bool asked =
      dea_modal_asked(result->design) || dea_result_find(result, type->name, "modal") != NULL;
  if (type->modes != NULL && asked) {
    stop->mode_count = (size_t)settings->modes.si;
    DEA_TRY(ctx, type->modes(ctx, job->model, &stop->point, stop->mode_count, modes, &shapes));
    dea_field_mesh_destroy(ctx, shapes);
    for (size_t i = 0; i < stop->mode_count; i++) {
      stop->mode_Hz[i] = modes[i].frequency_Hz;
    }
    stop->point.frequency_Hz = stop->mode_Hz[0];
  }
  return DEA_OK;
}

/* Slopes of all quantities that there are. */
static dea_status find_slopes(struct dea_context *ctx, const struct dea_study_job *job,
                              struct stop *stop)
{
  enum { MOST = QUANTITIES + DEA_DESIGN_MODES_MAX };
  int columns[MOST];
  size_t place[MOST], modes[MOST] = {0}, asked = 0;
  const size_t seen = stop->seen - QUANTITIES;
  for (size_t k = 0; k < stop->width - seen; k++) {
    const size_t at = k < QUANTITIES ? k : k + seen;
    if ((k != FREQUENCY || stop->mode_count > 0) && (k != FOLLOWING || stop->stretch > 0)) {
      place[asked] = at;
      modes[asked] = at >= stop->seen ? stop->of[at].mode - 1 : 0;
      columns[asked++] = stop->of[at].column;
    }
  }
  const size_t row = asked + seen;
  double *slopes = dea_arena_alloc(&stop->memory, stop->number_count * row, sizeof *slopes);
  stop->slopes =
      dea_arena_alloc(&stop->memory, stop->number_count * stop->width, sizeof *stop->slopes);
  DEA_TRY(ctx, dea_arena_status(&stop->memory));
  const struct dea_design_gradient ask = {.type = job->type,
                                          .model = job->model,
                                          .design = job->result->design,
                                          .device = job->result->device,
                                          .voltage_V = stop->voltage_V,
                                          .pressed = stop->is_pressed ? &stop->pressed : NULL,
                                          .numbers = stop->numbers,
                                          .number_count = stop->number_count,
                                          .of = {.columns = columns,
                                                 .column_count = asked,
                                                 .modes = modes,
                                                 .monitors = stop->monitors,
                                                 .monitor_count = seen,
                                                 .motions = stop->motions,
                                                 .holds_stretch = stop->stretch > 0,
                                                 .stretch = stop->stretch}};
  DEA_TRY(ctx, dea_design_gradient_find(ctx, &ask, slopes));
  for (size_t i = 0; i < stop->number_count * stop->width; i++) {
    stop->slopes[i] = NAN;
  }
  for (size_t i = 0; i < stop->number_count; i++) {
    for (size_t k = 0; k < row; k++) {
      const size_t at = k < asked ? place[k] : QUANTITIES + k - asked;
      const bool known = at != FORCE || stop->is_pressed;
      stop->slopes[i * stop->width + at] = known ? slopes[i * row + k] : NAN;
    }
  }
  return DEA_OK;
}

/* It is no number where it follows. */
static void drop_voltage(struct stop *stop)
{
  size_t kept = 0;
  for (size_t i = 0; i < stop->number_count; i++) {
    if (stop->numbers[i].of != DEA_NUMBER_OF_SUPPLY) {
      stop->numbers[kept++] = stop->numbers[i];
    }
  }
  stop->number_count = kept;
}

static dea_status find_stop(struct dea_context *ctx, const struct dea_study_job *job,
                            struct stop *stop)
{
  const struct dea_result *result = job->result;
  DEA_TRY(ctx, find_frequency(ctx, job, stop));
  DEA_TRY(ctx, dea_design_numbers(ctx, result->design, result->device, stop->voltage_V, false,
                                  stop->numbers, &stop->number_count));
  if (stop->mode_count == 0) {
    dea_numbers_at_rest(result->device, stop->numbers, &stop->number_count);
  }
  if (stop->stretch > 0) {
    drop_voltage(stop);
  }
  if (stop->is_pressed) {
    dea_tip_numbers(&stop->pressed, stop->numbers, &stop->number_count);
  }
  DEA_TRY(ctx, find_quantities(ctx, job, stop));
  return find_slopes(ctx, job, stop);
}

/* Its rows of both tables. Those of what has monitors, or is no disc, are sorted by what each
 * monitor shows, or without monitors by the capacitance. */
static dea_status add_stop(struct dea_context *ctx, const char *model, const struct stop *stop,
                           struct dea_result *result)
{
  struct dea_result_table *table;
  const bool seen = stop->seen > QUANTITIES;
  const size_t first = seen ? QUANTITIES : stop->layout != NULL ? CAPACITANCE : leading(stop);
  DEA_TRY(ctx, dea_result_get_table(ctx, result, &matter_table, model, &table));
  for (size_t k = first; k < (seen ? stop->seen : first + 1); k++) {
    DEA_TRY(ctx, add_sorted(ctx, stop, k, table));
  }
  DEA_TRY(ctx, dea_result_get_table(ctx, result, &slope_table, model, &table));
  return add_slopes(ctx, stop, table);
}

/* What matters where the model is. tip: that it is pressed by, NULL: none. stretch: that is held in
 * place of the voltage, 0: none. */
static dea_status record_stop(struct dea_context *ctx, const struct dea_study_job *job,
                              const struct dea_load_point *at, const struct dea_probe *tip,
                              const struct dea_loaded *loaded, double stretch)
{
  struct stop *stop = dea_alloc(ctx, 1, sizeof *stop);
  DEA_TRY_MEMORY(stop != NULL);
  stop->memory.ctx = ctx;
  stop->voltage_V = at->voltage_V;
  stop->point = *at;
  stop->stretch = stretch;
  stop->loaded = loaded;
  stop->is_pressed = tip != NULL;
  if (tip != NULL) {
    stop->pressed = (struct dea_pressed){*tip, at->tip_depth_m};
  }
  dea_status status = find_stop(ctx, job, stop);
  status = status == DEA_OK ? add_stop(ctx, job->type->name, stop, job->result) : status;
  dea_arena_free(&stop->memory);
  dea_free(ctx, stop);
  return DEA_CHAIN(ctx, status);
}

static dea_status solve_stop(struct dea_context *ctx, const struct dea_study_job *job,
                             const struct dea_load_point *at, size_t number,
                             struct dea_curve *curve)
{
  (void)number;
  DEA_TRY(ctx, dea_curve_add_point(ctx, curve, at));
  return record_stop(ctx, job, at, NULL, NULL, 0);
}

/* A stop of study force: pressed at 0 V, then all voltages. */
static dea_status press(struct dea_context *ctx, const struct dea_study_job *job, size_t number,
                        const double *voltages_V, size_t count)
{
  const struct dea_model_type *type = job->type;
  const struct dea_design *design = job->result->design;
  const struct dea_probe tip = dea_force_indenter(design);
  struct dea_study_job own = *job;
  struct dea_load_point at;
  DEA_TRY(ctx, dea_model_create(ctx, type, design, job->result->device, &own.model));
  dea_status status = dea_force_indent(ctx, type, own.model, design, number);
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    status = type->solve(ctx, own.model, voltages_V[i], &at);
    status = status == DEA_OK ? record_stop(ctx, &own, &at, &tip, NULL, 0) : status;
  }
  type->destroy(ctx, own.model);
  return DEA_CHAIN(ctx, status);
}

/* A note on what is not known as a way ends before; DEA_OK. */
static dea_status report_end(struct dea_context *ctx, const struct dea_study_job *job,
                             const char *where, double value, const char *unit)
{
  dea_status status = dea_finding_add(
      ctx, DEA_NOTE, (struct dea_location){0}, "model %s: not known what matters %s %.4g%s: %s",
      job->type->name, where, value, unit, dea_context_message(ctx));
  dea_context_clear(ctx);
  return status;
}

/* The end of a line of study loading. */
static dea_status load(struct dea_context *ctx, const struct dea_study_job *job, double voltage_V)
{
  struct dea_study_job own = *job;
  struct dea_load_point at;
  struct dea_loaded loaded;
  dea_status status = dea_loading_end(ctx, &own, voltage_V, &at, &loaded);
  if (status == DEA_OK) {
    status = record_stop(ctx, &own, &at, NULL, &loaded, 0);
    job->type->destroy(ctx, own.model);
  } else if (!dea_status_ends(status)) {
    status = report_end(ctx, job, "where compute.loading ends at", 1e-3 * voltage_V, " kV");
  }
  return DEA_CHAIN(ctx, status);
}

/* A point of the path. */
static dea_status follow(struct dea_context *ctx, const struct dea_study_job *job, double stretch)
{
  const struct dea_device *device = job->result->device;
  struct dea_study_job own = *job;
  struct dea_load_point at;
  DEA_TRY(ctx, dea_model_create(ctx, job->type, job->result->design, device, &own.model));
  dea_status status = dea_model_stretch(ctx, job->type, own.model, device, stretch, &at);
  if (status == DEA_OK) {
    status = record_stop(ctx, &own, &at, NULL, NULL, stretch);
  } else if (status == DEA_E_NO_EQUILIBRIUM || status == DEA_E_NOT_CONVERGED ||
             status == DEA_E_UNSUPPORTED) {
    status = report_end(ctx, job, "at an electrode stretch of", stretch, "");
  }
  job->type->destroy(ctx, own.model);
  return DEA_CHAIN(ctx, status);
}

static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct dea_design *design = job->result->design;
  const struct settings *settings = dea_design_settings(design, &section)->values;
  double voltages_V[DEA_DESIGN_STOPS_MAX] = {dea_study_highest_V(job->result)};
  size_t count = settings->voltage_count > 0
                     ? dea_study_stops(design, settings->voltages_V, settings->voltage_count, false,
                                       voltages_V)
                     : 1;
  DEA_TRY(ctx, dea_study_stop_by_stop(ctx, job, study_name, false, voltages_V, count, solve_stop));
  for (size_t i = 0; job->type->indent != NULL && i < dea_force_stops(design); i++) {
    DEA_TRY(ctx, press(ctx, job, i, voltages_V, count));
  }
  for (size_t i = 0; job->type->move != NULL && i < count && dea_loading_asked(design); i++) {
    DEA_TRY(ctx, load(ctx, job, voltages_V[i]));
  }
  for (size_t i = 0; i < settings->stretch_count; i++) {
    DEA_TRY(ctx, follow(ctx, job, settings->stretches[i].si));
  }
  return dea_limit_slopes_add(ctx, job);
}

// The study --------------------------------------------------------------------------------------

const struct dea_study dea_study_sensitivity = {
    .name = study_name,
    .keys = &section,
    .own_models = true,
    .run = run,
};
