#include "study/observe.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct dea_result_column pass_columns[] = {
    DEA_RESULT_COLUMN(COUNT, "pass", "pass", .meaning = "number of the mesh"),
    DEA_RESULT_COLUMN(COUNT, "elements", "elements", .meaning = "of the mesh"),
    DEA_RESULT_COLUMN(COUNT, "unknowns", "unknowns", .meaning = "of the mesh"),
    DEA_NUMBER_COLUMN("value", "1", "1", 1, "monitor",
                      "motion of the monitor: displacement in m, or stretch"),
    DEA_NUMBER_COLUMN("error", "1", "1", 1, "error", "its estimated error"),
    DEA_RESULT_COLUMN(FLAG, "within", "small enough",
                      .meaning = "the error is the tolerance or less"),
};
static const struct dea_result_column source_columns[] = {
    DEA_TEXT_COLUMN("channel", "channel", "name in the design"),
    DEA_KV("lowest_V", "lowest", "voltage of the channel"),
    DEA_KV("highest_V", "highest", "voltage of the channel"),
    DEA_NUMBER_COLUMN("largest_charge_C", "C", "nC", 1e9, "charge", "largest size of its charge"),
    DEA_NUMBER_COLUMN("largest_current_A", "A", "uA", 1e6, "current",
                      "largest size of its source's current, jumps aside"),
};
static const struct dea_result_table_type of_passes = DEA_RESULT_TABLE(
    "sweep", "adaptation", pass_columns, .key = "adaptation", .title = "Adaptive refinement",
    .where = DEA_IN_JSON | DEA_IN_CSV | DEA_IN_SCREEN);

static const struct dea_result_table_type of_sources =
    DEA_RESULT_TABLE("transient", "sources", source_columns, .title = "channels",
                     .where = DEA_IN_JSON | DEA_IN_SCREEN);

// What is observed at a point --------------------------------------------------------------------

struct dea_monitor_values *dea_monitor_column_values(struct dea_arena *memory,
                                                     const struct dea_monitor_column *columns,
                                                     size_t count)
{
  int *numbers = dea_arena_alloc(memory, count, sizeof *numbers);
  for (size_t i = 0; numbers != NULL && i < count; i++) {
    numbers[i] = columns[i].column;
  }
  return dea_monitor_values_create(memory, numbers, count);
}

dea_status dea_monitor_set_init(struct dea_context *ctx, const struct dea_model_type *type,
                                const struct dea_device *device, struct dea_monitor_set *out)
{
  struct dea_monitor_column *columns;
  *out = (struct dea_monitor_set){.memory = {.ctx = ctx}};
  if (type->observe == NULL || device == NULL || !dea_device_is_observed(device)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_layout_columns(&out->memory, device->layout, &columns, &out->count));
  out->columns = columns;
  out->errors = dea_arena_alloc(&out->memory, device->layout->monitor_count, sizeof *out->errors);
  out->values = dea_monitor_column_values(&out->memory, columns, out->count);
  return dea_arena_status(&out->memory);
}

void dea_monitor_set_free(struct dea_monitor_set *set)
{
  dea_arena_free(&set->memory);
}

static double channel_value(const struct dea_channel_values *channel, size_t number)
{
  const double values[DEA_OBSERVED_OF_CHANNEL] = {
      [DEA_OBSERVED_VOLTAGE] = channel->voltage_V,
      [DEA_OBSERVED_CHARGE] = channel->charge_C,
      [DEA_OBSERVED_CAPACITANCE] = channel->capacitance_F,
      [DEA_OBSERVED_CURRENT] = channel->current_A,
  };
  return values[number];
}

dea_status dea_monitor_set_read(struct dea_context *ctx, struct dea_monitor_set *set,
                                const struct dea_model_type *type, struct dea_model *model,
                                bool errors, struct dea_load_point *point)
{
  struct dea_observation seen;
  if (set->count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, type->observe(ctx, model, &seen));
  DEA_TRY(ctx, errors && type->errors != NULL ? type->errors(ctx, model, set->errors) : DEA_OK);
  point->monitors = set->values;
  for (size_t i = 0; i < set->count; i++) {
    const struct dea_monitor_column *c = &set->columns[i];
    double value = NAN;
    switch (c->source) {
    case DEA_OF_MONITOR:
      value = seen.monitor[c->index][c->number];
      break;
    case DEA_OF_MONITOR_ERROR:
      if (errors && type->errors != NULL &&
          dea_observed_main(seen.monitor[c->index]) == (enum dea_observed)c->number) {
        value = set->errors[c->index];
      }
      break;
    case DEA_OF_CHANNEL:
      value = channel_value(&seen.channel[c->index], c->number);
      break;
    case DEA_OF_AMPLITUDE: // of study frequency
    case DEA_OF_PHASE:
      break;
    }
    if (c->column >= DEA_LOAD_POINT_COLUMNS) {
      set->values->at[i].value = value;
    } else if (isnan(dea_point_get(point, c->column))) { // "centre_z_m" of a monitor 'centre'
      dea_point_set(point, c->column, value);
    }
  }
  return DEA_OK;
}

dea_status dea_study_add_point(struct dea_context *ctx, const struct dea_study_job *job,
                               const struct dea_device *device, const struct dea_load_point *point,
                               struct dea_curve *curve)
{
  struct dea_load_point with = *point;
  struct dea_monitor_set set;
  dea_status status = dea_monitor_set_init(ctx, job->type, device, &set);
  status = status == DEA_OK ? dea_monitor_set_read(ctx, &set, job->type, job->model, true, &with)
                            : status;
  status = status == DEA_OK ? dea_curve_add_point(ctx, curve, &with) : status;
  dea_monitor_set_free(&set);
  return status;
}

dea_status dea_study_observe_passes(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct dea_model_type *type = job->type;
  struct dea_result *result = job->result;
  size_t count = 0;
  const struct dea_adapt_pass *pass =
      type->passes != NULL ? type->passes(job->model, &count) : NULL;
  if (count == 0 || dea_result_find_table(result, type->name, "sweep", of_passes.name) != NULL) {
    return DEA_OK;
  }
  struct dea_result_table *table;
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &of_passes, type->name, 0, &table));
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(ctx,
            DEA_TABLE_ADD(ctx, table, DEA_CELL((double)(i + 1)), DEA_CELL((double)pass[i].elements),
                          DEA_CELL((double)pass[i].unknowns), DEA_CELL(pass[i].value),
                          DEA_CELL(pass[i].error), DEA_CELL(pass[i].within ? 1 : 0)));
  }
  return DEA_OK;
}

/* Largest of a column's values along a curve times a sign, or (sign 0) of their sizes. */
static double largest(const struct dea_curve *curve, int column, double sign)
{
  double most = sign == 0 ? 0 : -INFINITY;
  for (size_t i = 0; i < curve->count; i++) {
    const double value = dea_point_get(&curve->points[i], column);
    most = fmax(most, sign == 0 ? fabs(value) : sign * value); // not of NAN
  }
  return most;
}

dea_status dea_study_sources(struct dea_context *ctx, const struct dea_monitor_set *set,
                             const struct dea_curve *curve, struct dea_result *result)
{
  struct dea_result_table *table = NULL;
  for (size_t i = 0; i < set->count && curve->count > 0; i++) {
    const struct dea_monitor_column *c = &set->columns[i];
    if (c->source != DEA_OF_CHANNEL || c->number != DEA_OBSERVED_VOLTAGE) {
      continue;
    }
    DEA_TRY(ctx, dea_result_get_table(ctx, result, &of_sources, curve->model, &table));
    DEA_TRY(ctx, DEA_TABLE_ADD(ctx, table,
                               DEA_TEXT_CELL(result->device->layout->channels[c->index].name),
                               DEA_CELL(-largest(curve, c->column, -1)),
                               DEA_CELL(largest(curve, c->column, 1)),
                               DEA_CELL(largest(curve, c[DEA_OBSERVED_CHARGE].column, 0)),
                               DEA_CELL(largest(curve, c[DEA_OBSERVED_CURRENT].column, 0))));
  }
  return DEA_OK;
}

// Figures ----------------------------------------------------------------------------------------

static const char sweep[] = "sweep", history[] = "transient";

static const double least_drawn = 1e-9; // in display units: less is what rounding left of 0
static const double least_turn = 1e-5;  // [rad] of a figure of turns
static const double turn_share =
    0.05; // of the largest: turns about other axes are drawn from it on

/* Lines of a figure: one quantity of all monitors or channels. */
struct lines {
  const char *kind;     // of the curves: sweep or history
  const char *quantity; // ending of the columns' keys
  const char *suffix;   // behind the names
  enum dea_series_style style;
};

static dea_status add_line(struct dea_context *ctx, struct dea_panel *panel,
                           const struct lines *lines, const struct dea_curve *curve, int column,
                           size_t number, bool several)
{
  static const enum dea_colour colours[] = {DEA_BLUE,   DEA_VERMILLION, DEA_GREEN,
                                            DEA_PURPLE, DEA_ORANGE,     DEA_SKY};
  const struct dea_column *shown = dea_column_at(ctx, column);
  const size_t count = curve->count, name = dea_observed_name_length(shown);
  struct dea_series *series;
  if (panel->series_count >= DEA_PANEL_SERIES_MAX) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_panel_add(ctx, panel, count, DEA_LINE,
                             colours[number % (sizeof colours / sizeof colours[0])], "", &series));
  char title[DEA_LABEL_SIZE];
  snprintf(title, sizeof title, "%.*s%s", (int)(name < 60 ? name : 60), shown->header,
           lines->suffix);
  dea_label_escape(title, series->title, sizeof series->title);
  // told apart in grey by markers
  series->style = lines->style == DEA_LINE && several ? DEA_LINE_MARKED : lines->style;
  series->marker = (int)number;
  for (size_t i = 0; i < count; i++) {
    const struct dea_load_point *p = &curve->points[i];
    const double value = shown->factor * dea_point_get(p, column);
    series->values[i] = lines->kind == sweep ? 1e-3 * p->voltage_V : p->time_s;
    series->values[count + i] = fabs(value) < least_drawn ? 0 : value;
  }
  return DEA_OK;
}

/* Whether a column is one of monitors or channels of that quantity which the curve has. */
static bool is_shown(const struct dea_context *ctx, const struct dea_curve *curve, int column,
                     const char *quantity)
{
  return dea_observed_is(dea_column_at(ctx, column), quantity) &&
         dea_points_have(curve->points, curve->count, column);
}

/* Adds the quantity of all monitors of all models. */
static dea_status add_lines(struct dea_context *ctx, const struct dea_result *result,
                            const struct lines *lines, struct dea_panel *panel)
{
  const int count = dea_column_count(ctx);
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *curve = &result->curves[i];
    size_t number = 0, all = 0;
    for (int c = DEA_LOAD_POINT_COLUMNS; c < count && strcmp(curve->kind, lines->kind) == 0; c++) {
      all += is_shown(ctx, curve, c, lines->quantity) ? 1 : 0;
    }
    for (int c = DEA_LOAD_POINT_COLUMNS; c < count && number < all; c++) {
      if (is_shown(ctx, curve, c, lines->quantity)) {
        DEA_TRY(ctx, add_line(ctx, panel, lines, curve, c, number++, all > 1));
      }
    }
  }
  return DEA_OK;
}

void dea_observe_time_axis(struct dea_panel *panel)
{
  panel->x_min = 0;
  panel->x_max = 0;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    panel->x_max = fmax(panel->x_max, series->values[series->count - 1]);
  }
  snprintf(panel->x_label, sizeof panel->x_label, "Time {/:Italic t} (s)");
  dea_panel_place_key(panel);
  double low, high;
  if (isnan(panel->y_max) && dea_panel_range(panel, &low, &high) && high > low) {
    panel->y_max = high + 0.06 * (high - low); // what is held lies below the border
  }
}

/* How far each of three quantities changes, the most of all monitors. */
static void changes(const struct dea_context *ctx, const struct dea_result *result,
                    const char *kind, const char *const keys[3], double most[3])
{
  memset(most, 0, 3 * sizeof *most);
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *curve = &result->curves[i];
    for (int c = DEA_LOAD_POINT_COLUMNS;
         c < dea_column_count(ctx) && strcmp(curve->kind, kind) == 0; c++) {
      for (size_t k = 0; k < 3; k++) {
        if (keys[k] != NULL && is_shown(ctx, curve, c, keys[k])) {
          most[k] = fmax(most[k], dea_curve_change(curve, c));
        }
      }
    }
  }
}

/* What a figure shows, by its name without "history_" of histories; label NULL: by what there is.
 */
static const struct shown {
  const char *name, *label;
  const char *quantities[3]; // endings of the columns' keys
  const char *suffixes[3];   // behind the names
  enum dea_series_style styles[3];
} figures[] = {
    {"monitors", NULL, {"x_m", "y_m", "z_m"}, {"", "", ""}, {DEA_LINE, DEA_LINE, DEA_LINE}},
    {"monitors_stretch",
     "Stretch from the flat film",
     {"stretch", "stretch_x", "stretch_y"},
     {"", ", along x", ", along y"},
     {DEA_LINE, DEA_LINE, DEA_DASHED}},
    {"monitors_turn",
     "Turn (deg)",
     {"turn_x_rad", "turn_y_rad", "turn_z_rad"},
     {", about x", ", about y", ", about z"},
     {DEA_LINE, DEA_DASHED, DEA_DOTTED}},
    {"channels", "Charge (nC)", {"charge_C"}, {""}, {DEA_LINE}},
    {"voltages", "Voltage {/:Italic V} (kV)", {"voltage_V"}, {""}, {DEA_LINE}},
    {"currents", "Current {/:Italic I} (\302\265A)", {"current_A"}, {""}, {DEA_LINE}},
};

dea_status dea_observe_build(struct dea_context *ctx, const struct dea_result *result,
                             struct dea_plot *plot)
{
  static const char in_time[] = "history_";
  struct dea_panel *panel = &plot->panels[0];
  const bool of_time = strncmp(plot->name, in_time, strlen(in_time)) == 0;
  const char *kind = of_time ? history : sweep,
             *name = plot->name + (of_time ? strlen(in_time) : 0);
  const struct shown *shown = figures;
  while (strcmp(shown->name, name) != 0) {
    shown++;
  }
  const bool moves = shown->label == NULL, turns = strcmp(name, "monitors_turn") == 0;
  double most[3];
  char label[DEA_LABEL_SIZE];
  changes(ctx, result, kind, shown->quantities, most);
  size_t axis = 2; // z where nothing moves
  for (size_t k = 0; k < 2; k++) {
    axis = most[k] > most[axis] ? k : axis;
  }
  const double least = fmax(least_turn, turn_share * fmax(most[0], fmax(most[1], most[2])));
  for (size_t k = 0, drawn = 0; k < 3 && shown->quantities[k] != NULL; k++) {
    if (moves ? k == axis : !turns || most[k] > least) {
      const struct lines lines = {kind, shown->quantities[k], shown->suffixes[k],
                                  shown->styles[turns ? drawn++ : k]};
      DEA_TRY(ctx, add_lines(ctx, result, &lines, panel));
    }
  }
  snprintf(label, sizeof label, "Displacement {/:Italic %c} (\302\265m)", "xyz"[axis]);
  snprintf(panel->y_label, sizeof panel->y_label, "%s", moves ? label : shown->label);
  if (of_time) {
    dea_observe_time_axis(panel);
  } else {
    dea_panel_voltage_axis(panel);
    dea_panel_even_tics(panel, 6);
    dea_panel_place_key(panel);
  }
  return DEA_OK;
}

const struct dea_figure dea_observe_figures[DEA_OBSERVE_FIGURES] = {
    DEA_STUDY_FIGURE("monitors", "sweep", dea_observe_build,
                     "displacement of the monitors, along the axis that they move along most"),
    DEA_STUDY_FIGURE("monitors_stretch", "sweep", dea_observe_build,
                     "stretch between the points of lines, and mean stretch of regions"),
    DEA_STUDY_FIGURE("monitors_turn", "sweep", dea_observe_build, "turns of rigid bodies"),
    DEA_STUDY_FIGURE("channels", "sweep", dea_observe_build, "charge on the channels"),
};
