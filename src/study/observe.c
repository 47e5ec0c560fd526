#include "study/observe.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define VOLTAGE                                                                                    \
  {                                                                                                \
    .key = "voltage_V", .kind = DEA_CELL_NUMBER, .si_unit = "V", .display_unit = "kV",             \
    .factor = 1e-3, .title = "V", .meaning = "voltage of the sweep"                                \
  }
#define NAME(name, what)                                                                           \
  {                                                                                                \
    .key = name, .kind = DEA_CELL_TEXT, .title = name, .meaning = what                             \
  }

enum { BEFORE = 2 }; // columns before the quantities

/* In the order of enum dea_observed. */
static const struct dea_result_column monitor_columns[] = {
    VOLTAGE,
    NAME("monitor", "name in the design"),
    DEA_OBSERVED_COLUMNS,
};
enum { MONITOR_COLUMNS = sizeof monitor_columns / sizeof monitor_columns[0] };
_Static_assert(MONITOR_COLUMNS == BEFORE + DEA_OBSERVED_COUNT, "a column a quantity");

static const struct dea_result_column channel_columns[] = {
    VOLTAGE,
    NAME("channel", "name in the design"),
    DEA_NUMBER_COLUMN("channel_voltage_V", "V", "kV", 1e-3, "voltage", "voltage of the channel"),
    DEA_NUMBER_COLUMN("charge_C", "C", "nC", 1e9, "charge", "charge on the channel"),
    DEA_NUMBER_COLUMN("capacitance_F", "F", "pF", 1e12, "capacitance",
                      "change of the channel's charge with its voltage, the film held"),
};
enum { CHANNEL_COLUMNS = sizeof channel_columns / sizeof channel_columns[0] };

static const struct dea_result_table_type monitors = {
    .study = "sweep",
    .name = "monitors",
    .key = "monitors",
    .title = "Monitors",
    .where = DEA_IN_JSON | DEA_IN_CSV | DEA_IN_SCREEN,
    .columns = monitor_columns,
    .column_count = MONITOR_COLUMNS,
};
static const struct dea_result_table_type channels = {
    .study = "sweep",
    .name = "channels",
    .key = "channels",
    .title = "Channels",
    .where = DEA_IN_JSON | DEA_IN_CSV | DEA_IN_SCREEN,
    .columns = channel_columns,
    .column_count = CHANNEL_COLUMNS,
};

/* The model's table of that type, a new one when there is none; rows: whether any will come. */
static dea_status get_table(struct dea_context *ctx, const struct dea_result_table_type *type,
                            const char *model, struct dea_result *result,
                            struct dea_result_table **out)
{
  for (size_t i = 0; i < result->table_count; i++) {
    if (dea_result_find_table(result, model, type->study, type->name) == &result->tables[i]) {
      *out = &result->tables[i];
      return DEA_OK;
    }
  }
  DEA_TRY(ctx, dea_result_add_table(ctx, result, type, model, 0, out));
  return DEA_OK;
}

static dea_status add_monitors(struct dea_context *ctx, const char *model, double voltage_V,
                               const struct dea_observation *seen, struct dea_result *result)
{
  const struct dea_layout *layout = result->device->layout;
  struct dea_result_table *table;
  if (seen->monitor_count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, get_table(ctx, &monitors, model, result, &table));
  for (size_t i = 0; i < seen->monitor_count; i++) {
    struct dea_result_table_value row[MONITOR_COLUMNS] = {{.number = voltage_V},
                                                          {.text = layout->monitors[i].name}};
    for (int k = 0; k < DEA_OBSERVED_COUNT; k++) {
      row[BEFORE + k].number = seen->monitor[i][k];
    }
    DEA_TRY(ctx, dea_result_table_add_row(ctx, table, row));
  }
  return DEA_OK;
}

/* Ground, which has what the others have with the other sign, is left out. */
static dea_status add_channels(struct dea_context *ctx, const char *model, double voltage_V,
                               const struct dea_observation *seen, struct dea_result *result)
{
  const struct dea_layout *layout = result->device->layout;
  struct dea_result_table *table;
  if (seen->channel_count < 2) {
    return DEA_OK;
  }
  DEA_TRY(ctx, get_table(ctx, &channels, model, result, &table));
  for (size_t k = 1; k < seen->channel_count; k++) {
    const struct dea_channel_values *values = &seen->channel[k];
    const struct dea_result_table_value row[CHANNEL_COLUMNS] = {{.number = voltage_V},
                                                                {.text = layout->channels[k].name},
                                                                {.number = values->voltage_V},
                                                                {.number = values->charge_C},
                                                                {.number = values->capacitance_F}};
    DEA_TRY(ctx, dea_result_table_add_row(ctx, table, row));
  }
  return DEA_OK;
}

dea_status dea_study_observe(struct dea_context *ctx, const struct dea_model_type *type,
                             struct dea_model *model, double voltage_V, struct dea_result *result)
{
  struct dea_observation seen;
  if (type->observe == NULL) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_model_observe(ctx, type, model, &seen));
  DEA_TRY(ctx, add_monitors(ctx, type->name, voltage_V, &seen, result));
  DEA_TRY(ctx, add_channels(ctx, type->name, voltage_V, &seen, result));
  return DEA_OK;
}

// Figures ----------------------------------------------------------------------------------------

/* A line of a figure: a column of a table, in the rows of one name. */
struct line {
  const struct dea_result_table *table;
  size_t column;
  const char *name, *suffix;
  enum dea_series_style style;
  int number; // of the name: its colour
};

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
  series->style = line->style;
  series->colour = colours[(size_t)line->number % (sizeof colours / sizeof colours[0])];
  for (size_t i = 0, k = 0; i < table->row_count; i++) {
    if (strcmp(dea_result_table_cell(table, i, 1)->text, line->name) == 0) {
      series->values[k] = 1e-3 * dea_result_table_cell(table, i, 0)->number;
      series->values[count + k++] = factor * dea_result_table_cell(table, i, line->column)->number;
    }
  }
  return DEA_OK;
}

/* Adds the column of that key for all names of a table of all models. */
static dea_status add_lines(struct dea_context *ctx, const struct dea_result *result,
                            const char *table_name, const char *key, const char *suffix,
                            enum dea_series_style style, struct dea_panel *panel)
{
  for (size_t t = 0; t < result->table_count; t++) {
    struct line line = {.table = &result->tables[t], .suffix = suffix, .style = style};
    if (strcmp(line.table->type.study, monitors.study) != 0 ||
        strcmp(line.table->type.name, table_name) != 0) {
      continue;
    }
    while (line.column < line.table->type.column_count &&
           strcmp(line.table->type.columns[line.column].key, key) != 0) {
      line.column++;
    }
    double first_V = dea_result_table_cell(line.table, 0, 0)->number;
    for (size_t i = 0; i < line.table->row_count && line.column < line.table->type.column_count &&
                       dea_result_table_cell(line.table, i, 0)->number == first_V;
         i++) { // the rows of the first voltage have every name
      line.name = dea_result_table_cell(line.table, i, 1)->text;
      line.number = (int)i;
      DEA_TRY(ctx, add_line(ctx, panel, &line));
    }
  }
  return DEA_OK;
}

static void finish(struct dea_panel *panel, const char *label)
{
  dea_panel_voltage_axis(panel);
  dea_panel_even_tics(panel, 6);
  snprintf(panel->y_label, sizeof panel->y_label, "%s", label);
  dea_panel_place_key(panel);
}

static dea_status build_heights(struct dea_context *ctx, const struct dea_result *result,
                                struct dea_plot *plot)
{
  DEA_TRY(ctx, add_lines(ctx, result, monitors.name, "z_m", "", DEA_LINE, &plot->panels[0]));
  finish(&plot->panels[0], "Displacement {/:Italic z} (\302\265m)");
  return DEA_OK;
}

static dea_status build_stretches(struct dea_context *ctx, const struct dea_result *result,
                                  struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  DEA_TRY(ctx, add_lines(ctx, result, monitors.name, "stretch", "", DEA_LINE, panel));
  DEA_TRY(ctx, add_lines(ctx, result, monitors.name, "stretch_x", ", along x", DEA_LINE, panel));
  DEA_TRY(ctx, add_lines(ctx, result, monitors.name, "stretch_y", ", along y", DEA_DASHED, panel));
  finish(panel, "Stretch from the flat film");
  return DEA_OK;
}

static dea_status build_charges(struct dea_context *ctx, const struct dea_result *result,
                                struct dea_plot *plot)
{
  DEA_TRY(ctx, add_lines(ctx, result, channels.name, "charge_C", "", DEA_LINE, &plot->panels[0]));
  finish(&plot->panels[0], "Charge (nC)");
  return DEA_OK;
}

const struct dea_figure dea_observe_figures[DEA_OBSERVE_FIGURES] = {
    {.name = "monitors_z",
     .study = "sweep",
     .caption = "displacement of the monitors out of the plane",
     .build = build_heights},
    {.name = "monitors_stretch",
     .study = "sweep",
     .caption = "stretch between the points of lines, and mean stretch of regions",
     .build = build_stretches},
    {.name = "channels",
     .study = "sweep",
     .caption = "charge on the channels",
     .build = build_charges},
};
