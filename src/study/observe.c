#include "study/observe.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define VOLTAGE                                                                                    \
  {                                                                                                \
    .key = "voltage_V", .kind = DEA_CELL_NUMBER, .si_unit = "V", .display_unit = "kV",             \
    .factor = 1e-3, .title = "V", .meaning = "voltage of the sweep"                                \
  }
#define TIME                                                                                       \
  {                                                                                                \
    .key = "time_s", .kind = DEA_CELL_NUMBER, .si_unit = "s", .display_unit = "s", .factor = 1,    \
    .title = "time", .meaning = "time since the start of the waveform"                             \
  }
#define NAME(name, what)                                                                           \
  {                                                                                                \
    .key = name, .kind = DEA_CELL_TEXT, .title = name, .meaning = what                             \
  }

enum {
  BEFORE = 2,
  OF_CHANNEL = 3,
  OF_CHANNEL_IN_TIME = 4
}; // columns before the quantities; quantities of a channel

/* In the order of enum dea_observed; of channels as dea_observe_take has them. */
#define MONITOR_COLUMNS_AT(where) where, NAME("monitor", "name in the design"), DEA_OBSERVED_COLUMNS
#define CHANNEL_COLUMNS_AT(where)                                                                  \
  where, NAME("channel", "name in the design"),                                                    \
      DEA_NUMBER_COLUMN("channel_voltage_V", "V", "kV", 1e-3, "voltage",                           \
                        "voltage of the channel"),                                                 \
      DEA_NUMBER_COLUMN("charge_C", "C", "nC", 1e9, "charge", "charge on the channel"),            \
      DEA_NUMBER_COLUMN("capacitance_F", "F", "pF", 1e12, "capacitance",                           \
                        "change of the channel's charge with its voltage, the film held")

static const struct dea_result_column monitor_columns[] = {
    MONITOR_COLUMNS_AT(VOLTAGE),
    DEA_NUMBER_COLUMN("error_m", "m", "um", 1e6, "error",
                      "estimated error of the largest displacement of a point or a body"),
    DEA_NUMBER_COLUMN("stretch_error", "1", "1", 1, "stretch error",
                      "estimated error of the stretch of a line, of the area stretch of a region"),
};
static const struct dea_result_column monitor_time_columns[] = {MONITOR_COLUMNS_AT(TIME)};
static const struct dea_result_column pass_columns[] = {
    {.key = "pass", .kind = DEA_CELL_COUNT, .title = "pass", .meaning = "number of the mesh"},
    {.key = "elements", .kind = DEA_CELL_COUNT, .title = "elements", .meaning = "of the mesh"},
    {.key = "unknowns", .kind = DEA_CELL_COUNT, .title = "unknowns", .meaning = "of the mesh"},
    DEA_NUMBER_COLUMN("value", "1", "1", 1, "monitor",
                      "motion of the monitor: displacement in m, or stretch"),
    DEA_NUMBER_COLUMN("error", "1", "1", 1, "error", "its estimated error"),
    {.key = "within",
     .kind = DEA_CELL_FLAG,
     .title = "small enough",
     .meaning = "the error is the tolerance or less"},
};
static const struct dea_result_column channel_columns[] = {CHANNEL_COLUMNS_AT(VOLTAGE)};
static const struct dea_result_column channel_time_columns[] = {
    CHANNEL_COLUMNS_AT(TIME),
    DEA_NUMBER_COLUMN("current_A", "A", "uA", 1e6, "current",
                      "of the channel's source into the film, mean of the step to this time"),
};
static const struct dea_result_column source_columns[] = {
    NAME("channel", "name in the design"),
    DEA_NUMBER_COLUMN("lowest_V", "V", "kV", 1e-3, "lowest", "voltage of the channel"),
    DEA_NUMBER_COLUMN("highest_V", "V", "kV", 1e-3, "highest", "voltage of the channel"),
    DEA_NUMBER_COLUMN("largest_charge_C", "C", "nC", 1e9, "charge", "largest size of its charge"),
    DEA_NUMBER_COLUMN("largest_current_A", "A", "uA", 1e6, "current",
                      "largest size of its source's current, jumps aside"),
};
enum {
  SOURCE_COLUMNS = sizeof source_columns / sizeof source_columns[0],
  MONITOR_COLUMNS = sizeof monitor_columns / sizeof monitor_columns[0],
  MONITOR_TIME_COLUMNS = sizeof monitor_time_columns / sizeof monitor_time_columns[0],
  PASS_COLUMNS = sizeof pass_columns / sizeof pass_columns[0],
  CHANNEL_COLUMNS = sizeof channel_columns / sizeof channel_columns[0],
  CHANNEL_TIME_COLUMNS = sizeof channel_time_columns / sizeof channel_time_columns[0]
};
_Static_assert(MONITOR_TIME_COLUMNS == BEFORE + DEA_OBSERVED_COUNT, "a column a quantity");
_Static_assert(MONITOR_COLUMNS == MONITOR_TIME_COLUMNS + 2, "and two errors");
_Static_assert(CHANNEL_COLUMNS == BEFORE + OF_CHANNEL, "a column a quantity");
_Static_assert(CHANNEL_TIME_COLUMNS == BEFORE + OF_CHANNEL_IN_TIME, "a column a quantity");

/* Tables of a study: against the voltage of a sweep, against time. */
struct tables {
  struct dea_result_table_type monitors, channels;
};
static const struct tables of_sweep = {
    .monitors = {.study = "sweep",
                 .name = "monitors",
                 .key = "monitors",
                 .title = "Monitors",
                 .where = DEA_IN_JSON | DEA_IN_CSV | DEA_IN_SCREEN,
                 .columns = monitor_columns,
                 .column_count = MONITOR_COLUMNS},
    .channels = {.study = "sweep",
                 .name = "channels",
                 .key = "channels",
                 .title = "Channels",
                 .where = DEA_IN_JSON | DEA_IN_CSV | DEA_IN_SCREEN,
                 .columns = channel_columns,
                 .column_count = CHANNEL_COLUMNS},
};
static const struct tables of_history = {
    .monitors = {.study = "transient",
                 .name = "monitors",
                 .title = "Monitors in time",
                 .where = DEA_IN_CSV,
                 .columns = monitor_time_columns,
                 .column_count = MONITOR_TIME_COLUMNS},
    .channels = {.study = "transient",
                 .name = "channels",
                 .title = "Channels in time",
                 .where = DEA_IN_CSV,
                 .columns = channel_time_columns,
                 .column_count = CHANNEL_TIME_COLUMNS},
};

static const struct dea_result_table_type of_passes = {.study = "sweep",
                                                       .name = "adaptation",
                                                       .key = "adaptation",
                                                       .title = "Adaptive refinement",
                                                       .where =
                                                           DEA_IN_JSON | DEA_IN_CSV | DEA_IN_SCREEN,
                                                       .columns = pass_columns,
                                                       .column_count = PASS_COLUMNS};

static const struct dea_result_table_type of_sources = {.study = "transient",
                                                        .name = "sources",
                                                        .title = "channels",
                                                        .where = DEA_IN_JSON | DEA_IN_SCREEN,
                                                        .columns = source_columns,
                                                        .column_count = SOURCE_COLUMNS};

// What is observed at a point --------------------------------------------------------------------

size_t dea_observe_width(const struct dea_model_type *type, const struct dea_result *result)
{
  if (type->observe == NULL || result->device == NULL) {
    return 0;
  }
  const struct dea_layout *layout = result->device->layout;
  return layout->monitor_count * DEA_OBSERVED_COUNT +
         (layout->channel_count - 1) * OF_CHANNEL_IN_TIME;
}

/* Monitors, then channels without ground, which has what the others have with the other sign. */
dea_status dea_observe_take(struct dea_context *ctx, const struct dea_model_type *type,
                            struct dea_model *model, double *values)
{
  struct dea_observation seen;
  DEA_TRY(ctx, dea_model_observe(ctx, type, model, &seen));
  for (size_t i = 0; i < seen.monitor_count; i++, values += DEA_OBSERVED_COUNT) {
    memcpy(values, seen.monitor[i], sizeof seen.monitor[i]);
  }
  for (size_t k = 1; k < seen.channel_count; k++) {
    *values++ = seen.channel[k].voltage_V;
    *values++ = seen.channel[k].charge_C;
    *values++ = seen.channel[k].capacitance_F;
    *values++ = seen.channel[k].current_A;
  }
  return DEA_OK;
}

/* error: of a monitor in a sweep. */
static dea_status add_row(struct dea_context *ctx, struct dea_result_table *table, double where,
                          const char *name, const double *values, double error)
{
  struct dea_result_table_value row[DEA_RESULT_TABLE_COLUMNS_MAX] = {{.number = where},
                                                                     {.text = name}};
  size_t count = table->type.column_count;
  if (table->type.columns == monitor_columns) {
    count = MONITOR_TIME_COLUMNS;
    enum dea_observed main = dea_observed_main(values);
    bool stretch = main == DEA_OBSERVED_STRETCH || main == DEA_OBSERVED_AREA_STRETCH;
    row[count].number = stretch ? NAN : error;
    row[count + 1].number = stretch ? error : NAN;
  }
  for (size_t k = BEFORE; k < count; k++) {
    row[k].number = values[k - BEFORE];
  }
  return dea_result_table_add_row(ctx, table, row);
}

/* Rows of one point. error: [monitor_count], NULL: not known. */
static dea_status add_point(struct dea_context *ctx, const struct tables *tables, const char *model,
                            double where, const double *values, const double *error,
                            struct dea_result *result)
{
  const struct dea_layout *layout = result->device->layout;
  struct dea_result_table *table = NULL;
  for (size_t i = 0; i < layout->monitor_count; i++, values += DEA_OBSERVED_COUNT) {
    DEA_TRY(ctx, dea_result_get_table(ctx, result, &tables->monitors, model, &table));
    DEA_TRY(ctx, add_row(ctx, table, where, layout->monitors[i].name, values,
                         error != NULL ? error[i] : NAN));
  }
  for (size_t k = 1; k < layout->channel_count; k++, values += OF_CHANNEL_IN_TIME) {
    DEA_TRY(ctx, dea_result_get_table(ctx, result, &tables->channels, model, &table));
    DEA_TRY(ctx, add_row(ctx, table, where, layout->channels[k].name, values, NAN));
  }
  return DEA_OK;
}

dea_status dea_study_observe(struct dea_context *ctx, const struct dea_model_type *type,
                             struct dea_model *model, double voltage_V, struct dea_result *result)
{
  size_t width = dea_observe_width(type, result);
  if (width == 0) {
    return DEA_OK;
  }
  double *values = dea_alloc(ctx, width + result->device->layout->monitor_count, sizeof *values);
  dea_status status = values != NULL ? dea_observe_take(ctx, type, model, values) : DEA_E_MEMORY;
  double *error = type->errors != NULL && values != NULL ? values + width : NULL;
  if (status == DEA_OK && error != NULL) {
    status = type->errors(ctx, model, error);
  }
  if (status == DEA_OK) {
    status = add_point(ctx, &of_sweep, type->name, voltage_V, values, error, result);
  }
  dea_free(ctx, values);
  return status;
}

dea_status dea_study_observe_passes(struct dea_context *ctx, const struct dea_model_type *type,
                                    const struct dea_model *model, struct dea_result *result)
{
  size_t count = 0;
  const struct dea_adapt_pass *pass = type->passes != NULL ? type->passes(model, &count) : NULL;
  if (count == 0 || dea_result_find_table(result, type->name, "sweep", of_passes.name) != NULL) {
    return DEA_OK;
  }
  struct dea_result_table *table;
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &of_passes, type->name, 0, &table));
  for (size_t i = 0; i < count; i++) {
    const struct dea_result_table_value row[PASS_COLUMNS] = {{.number = (double)(i + 1)},
                                                             {.number = (double)pass[i].elements},
                                                             {.number = (double)pass[i].unknowns},
                                                             {.number = pass[i].value},
                                                             {.number = pass[i].error},
                                                             {.number = pass[i].within ? 1 : 0}};
    DEA_TRY(ctx, dea_result_table_add_row(ctx, table, row));
  }
  return DEA_OK;
}

/* What each channel saw of a history. values: [count][width]. */
static dea_status add_sources(struct dea_context *ctx, const char *model, const double *values,
                              size_t count, size_t width, struct dea_result *result)
{
  const struct dea_layout *layout = result->device->layout;
  struct dea_result_table *table = NULL;
  for (size_t k = 1; k < layout->channel_count && count > 0; k++) {
    const double *at = values + layout->monitor_count * DEA_OBSERVED_COUNT;
    double lowest_V = INFINITY, highest_V = -INFINITY, charge_C = 0, current_A = 0;
    at += (k - 1) * OF_CHANNEL_IN_TIME;
    for (size_t i = 0; i < count; i++, at += width) {
      lowest_V = fmin(lowest_V, at[0]);
      highest_V = fmax(highest_V, at[0]);
      charge_C = fmax(charge_C, fabs(at[1]));
      current_A = fmax(current_A, fabs(at[3]));
    }
    const struct dea_result_table_value row[] = {{.text = layout->channels[k].name},
                                                 {.number = lowest_V},
                                                 {.number = highest_V},
                                                 {.number = charge_C},
                                                 {.number = current_A}};
    DEA_TRY(ctx, dea_result_get_table(ctx, result, &of_sources, model, &table));
    DEA_TRY(ctx, dea_result_table_add_row(ctx, table, row));
  }
  return DEA_OK;
}

dea_status dea_observe_history(struct dea_context *ctx, const struct dea_model_type *type,
                               const struct dea_curve *curve, const double *values,
                               struct dea_result *result)
{
  size_t width = dea_observe_width(type, result);
  for (size_t i = 0; i < curve->count && width > 0; i++) {
    DEA_TRY(ctx, add_point(ctx, &of_history, type->name, curve->points[i].time_s,
                           values + i * width, NULL, result));
  }
  if (width > 0) {
    DEA_TRY(ctx, add_sources(ctx, type->name, values, curve->count, width, result));
  }
  return DEA_OK;
}

// Figures ----------------------------------------------------------------------------------------

static const double least_drawn = 1e-9; // in display units: less is what rounding left of 0
static const double least_turn = 1e-5;  // [rad] of a figure of turns
static const double turn_share =
    0.05; // of the largest: turns about other axes are drawn from it on

/* A line of a figure: a column of a table, in the rows of one name. */
struct line {
  const struct dea_result_table *table;
  size_t column;
  const char *name, *suffix;
  enum dea_series_style style;
  int number; // of the name: its colour
};

/* The rows of the first point, which have every name once. */
static size_t names_of(const struct dea_result_table *table)
{
  size_t count = 0;
  while (count < table->row_count &&
         (count == 0 || strcmp(dea_result_table_cell(table, count, 1)->text,
                               dea_result_table_cell(table, 0, 1)->text) != 0)) {
    count++;
  }
  return count;
}

static dea_status add_line(struct dea_context *ctx, struct dea_panel *panel,
                           const struct line *line)
{
  const struct dea_result_table *table = line->table;
  static const enum dea_colour colours[] = {DEA_BLUE,   DEA_VERMILLION, DEA_GREEN,
                                            DEA_PURPLE, DEA_ORANGE,     DEA_SKY};
  double factor = table->type.columns[line->column].factor;
  struct dea_series *series;
  size_t count = 0;
  bool any = false;
  for (size_t i = 0; i < table->row_count; i++) {
    bool mine = strcmp(dea_result_table_cell(table, i, 1)->text, line->name) == 0;
    count += mine ? 1 : 0;
    any = any || (mine && !isnan(dea_result_table_cell(table, i, line->column)->number));
  }
  if (!any || panel->series_count >= DEA_PANEL_SERIES_MAX) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_panel_add(ctx, panel, count, &series));
  char title[DEA_LABEL_SIZE];
  snprintf(title, sizeof title, "%.60s%s", line->name, line->suffix);
  dea_label_escape(title, series->title, sizeof series->title);
  bool several = line->style == DEA_LINE && names_of(table) > 1; // told apart in grey by markers
  series->style = several ? DEA_LINE_MARKED : line->style;
  series->marker = line->number;
  series->colour = colours[(size_t)line->number % (sizeof colours / sizeof colours[0])];
  for (size_t i = 0, k = 0; i < table->row_count; i++) {
    if (strcmp(dea_result_table_cell(table, i, 1)->text, line->name) == 0) {
      series->values[k] =
          table->type.columns[0].factor * dea_result_table_cell(table, i, 0)->number;
      double value = factor * dea_result_table_cell(table, i, line->column)->number;
      series->values[count + k++] = fabs(value) < least_drawn ? 0 : value;
    }
  }
  return DEA_OK;
}

/* Adds the column of that key for all names of a table of all models; of: the table's type. */
static dea_status add_lines(struct dea_context *ctx, const struct dea_result *result,
                            const struct dea_result_table_type *of, const char *key,
                            const char *suffix, enum dea_series_style style,
                            struct dea_panel *panel)
{
  for (size_t t = 0; t < result->table_count; t++) {
    struct line line = {.table = &result->tables[t], .suffix = suffix, .style = style};
    if (strcmp(line.table->type.study, of->study) != 0 ||
        strcmp(line.table->type.name, of->name) != 0 || line.table->row_count == 0) {
      continue;
    }
    while (line.column < line.table->type.column_count &&
           strcmp(line.table->type.columns[line.column].key, key) != 0) {
      line.column++;
    }
    for (size_t i = 0; i < names_of(line.table) && line.column < line.table->type.column_count;
         i++) {
      line.name = dea_result_table_cell(line.table, i, 1)->text;
      line.number = (int)i;
      DEA_TRY(ctx, add_line(ctx, panel, &line));
    }
  }
  return DEA_OK;
}

static void finish(const struct tables *of, struct dea_panel *panel, const char *label)
{
  if (of == &of_sweep) {
    dea_panel_voltage_axis(panel);
    dea_panel_even_tics(panel, 6);
  } else {
    snprintf(panel->x_label, sizeof panel->x_label, "Time {/:Italic t} (s)");
    panel->x_min = 0;
    panel->x_max = 0;
    for (size_t i = 0; i < panel->series_count; i++) {
      const struct dea_series *series = &panel->series[i];
      panel->x_max = fmax(panel->x_max, series->values[series->count - 1]);
    }
  }
  snprintf(panel->y_label, sizeof panel->y_label, "%s", label);
  dea_panel_place_key(panel);
}

/* How far a quantity changes over the rows of one name of a table, the most of all names; where
 * none changes (one voltage), its largest size. */
static double most_change(const struct dea_result_table *table, size_t column)
{
  double change = 0, size = 0;
  for (size_t first = 0; first < names_of(table); first++) {
    const char *name = dea_result_table_cell(table, first, 1)->text;
    double low = INFINITY, high = -INFINITY;
    for (size_t i = first; i < table->row_count; i++) {
      if (strcmp(dea_result_table_cell(table, i, 1)->text, name) == 0) {
        double here = dea_result_table_cell(table, i, column)->number;
        low = fmin(low, here); // not of NAN
        high = fmax(high, here);
        size = fmax(size, fabs(here));
      }
    }
    change = fmax(change, high - low);
  }
  return change > 0 ? change : size;
}

/* Fills how far each of three quantities changes, in any table of that type. */
static void changes(const struct dea_result *result, const struct dea_result_table_type *of,
                    const char *const keys[3], double most[3])
{
  memset(most, 0, 3 * sizeof *most);
  for (size_t t = 0; t < result->table_count; t++) {
    const struct dea_result_table *table = &result->tables[t];
    bool mine =
        strcmp(table->type.study, of->study) == 0 && strcmp(table->type.name, of->name) == 0;
    for (size_t c = 0; c < table->type.column_count && mine; c++) {
      for (size_t k = 0; k < 3; k++) {
        if (strcmp(table->type.columns[c].key, keys[k]) == 0) {
          most[k] = fmax(most[k], most_change(table, c));
        }
      }
    }
  }
}

static dea_status show_displacement(struct dea_context *ctx, const struct dea_result *result,
                                    const struct tables *of, struct dea_panel *panel)
{
  static const char *const keys[] = {"x_m", "y_m", "z_m"};
  double most[3];
  changes(result, &of->monitors, keys, most);
  size_t component = 2; // z where nothing moves
  for (size_t k = 0; k < 2; k++) {
    component = most[k] > most[component] ? k : component;
  }
  char label[DEA_LABEL_SIZE];
  snprintf(label, sizeof label, "Displacement {/:Italic %c} (\302\265m)", "xyz"[component]);
  DEA_TRY(ctx, add_lines(ctx, result, &of->monitors, keys[component], "", DEA_LINE, panel));
  finish(of, panel, label);
  return DEA_OK;
}

static dea_status show_stretches(struct dea_context *ctx, const struct dea_result *result,
                                 const struct tables *of, struct dea_panel *panel)
{
  const struct dea_result_table_type *table = &of->monitors;
  DEA_TRY(ctx, add_lines(ctx, result, table, "stretch", "", DEA_LINE, panel));
  DEA_TRY(ctx, add_lines(ctx, result, table, "stretch_x", ", along x", DEA_LINE, panel));
  DEA_TRY(ctx, add_lines(ctx, result, table, "stretch_y", ", along y", DEA_DASHED, panel));
  finish(of, panel, "Stretch from the flat film");
  return DEA_OK;
}

/* Turns about the axes that bodies turn about. */
static dea_status show_turns(struct dea_context *ctx, const struct dea_result *result,
                             const struct tables *of, struct dea_panel *panel)
{
  static const char *const keys[] = {"turn_x_rad", "turn_y_rad", "turn_z_rad"};
  static const char *const about[] = {", about x", ", about y", ", about z"};
  static const enum dea_series_style styles[] = {DEA_LINE, DEA_DASHED, DEA_DOTTED};
  double most[3];
  changes(result, &of->monitors, keys, most);
  double largest = fmax(most[0], fmax(most[1], most[2]));
  for (size_t k = 0, drawn = 0; k < 3; k++) {
    if (most[k] > fmax(least_turn, turn_share * largest)) {
      enum dea_series_style style = styles[drawn++];
      DEA_TRY(ctx, add_lines(ctx, result, &of->monitors, keys[k], about[k], style, panel));
    }
  }
  finish(of, panel, "Turn (deg)");
  return DEA_OK;
}

/* A column of the channels. */
static dea_status show_channels(struct dea_context *ctx, const struct dea_result *result,
                                const char *key, const char *label, struct dea_panel *panel)
{
  DEA_TRY(ctx, add_lines(ctx, result, &of_history.channels, key, "", DEA_LINE, panel));
  finish(&of_history, panel, label);
  return DEA_OK;
}

static dea_status show_charges(struct dea_context *ctx, const struct dea_result *result,
                               const struct tables *of, struct dea_panel *panel)
{
  DEA_TRY(ctx, add_lines(ctx, result, &of->channels, "charge_C", "", DEA_LINE, panel));
  finish(of, panel, "Charge (nC)");
  return DEA_OK;
}

static dea_status build_displacement(struct dea_context *ctx, const struct dea_result *result,
                                     struct dea_plot *plot)
{
  return show_displacement(ctx, result, &of_sweep, &plot->panels[0]);
}

static dea_status build_stretches(struct dea_context *ctx, const struct dea_result *result,
                                  struct dea_plot *plot)
{
  return show_stretches(ctx, result, &of_sweep, &plot->panels[0]);
}

static dea_status build_turns(struct dea_context *ctx, const struct dea_result *result,
                              struct dea_plot *plot)
{
  return show_turns(ctx, result, &of_sweep, &plot->panels[0]);
}

static dea_status build_charges(struct dea_context *ctx, const struct dea_result *result,
                                struct dea_plot *plot)
{
  return show_charges(ctx, result, &of_sweep, &plot->panels[0]);
}

const struct dea_figure dea_observe_figures[DEA_OBSERVE_FIGURES] = {
    {.name = "monitors",
     .study = "sweep",
     .caption = "displacement of the monitors, along the axis that they move along most",
     .build = build_displacement},
    {.name = "monitors_stretch",
     .study = "sweep",
     .caption = "stretch between the points of lines, and mean stretch of regions",
     .build = build_stretches},
    {.name = "monitors_turn",
     .study = "sweep",
     .caption = "turns of rigid bodies",
     .build = build_turns},
    {.name = "channels",
     .study = "sweep",
     .caption = "charge on the channels",
     .build = build_charges},
};

dea_status dea_observe_displacement_in_time(struct dea_context *ctx,
                                            const struct dea_result *result, struct dea_plot *plot)
{
  return show_displacement(ctx, result, &of_history, &plot->panels[0]);
}

dea_status dea_observe_stretches_in_time(struct dea_context *ctx, const struct dea_result *result,
                                         struct dea_plot *plot)
{
  return show_stretches(ctx, result, &of_history, &plot->panels[0]);
}

dea_status dea_observe_turns_in_time(struct dea_context *ctx, const struct dea_result *result,
                                     struct dea_plot *plot)
{
  return show_turns(ctx, result, &of_history, &plot->panels[0]);
}

dea_status dea_observe_charges_in_time(struct dea_context *ctx, const struct dea_result *result,
                                       struct dea_plot *plot)
{
  return show_charges(ctx, result, &of_history, &plot->panels[0]);
}

dea_status dea_observe_voltages_in_time(struct dea_context *ctx, const struct dea_result *result,
                                        struct dea_plot *plot)
{
  return show_channels(ctx, result, "channel_voltage_V", "Voltage {/:Italic V} (kV)",
                       &plot->panels[0]);
}

dea_status dea_observe_currents_in_time(struct dea_context *ctx, const struct dea_result *result,
                                        struct dea_plot *plot)
{
  return show_channels(ctx, result, "current_A", "Current {/:Italic I} (\302\265A)",
                       &plot->panels[0]);
}
