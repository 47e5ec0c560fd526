#include "study/operating_map_figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char study[] = "operating-map";

/* Tables with figures and labels of their own. */
static const struct {
  const char *table, *label;
} usual[] = {
    {"pre_stretch", "Pre-stretch"},
    {"film_thickness", "Thickness of the unstretched film (\302\265m)"},
};
enum { USUAL = sizeof usual / sizeof usual[0] };

struct map {
  const struct dea_result_table *table;
  const struct dea_result_column *number; // its first column
  double highest_V, end_V;
  double lift_step_m, strain_step;   // between levels; one is NAN, or both: none
  const struct dea_column *quantity; // then of this, from base on
  double base, step;
  bool bound; // a displacement is an upper bound
};

static double value(const struct map *map, size_t row)
{
  return map->number->factor * dea_result_table_number(map->table, row, map->number->key, 0);
}

/* A band from where a limit is up to the top, over the rows that have it. */
static dea_status add_region(struct dea_context *ctx, struct dea_panel *panel,
                             const struct map *map, const char *key, const char *title,
                             enum dea_colour colour)
{
  struct dea_series *band, *line;
  size_t rows = map->table->row_count;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, rows, DEA_BAND, DEA_BLUE, "", &band));
  DEA_TRY(ctx, dea_panel_add(ctx, panel, rows, DEA_LINE, DEA_BLUE, title, &line));
  band->to_top = true;
  band->colour = line->colour = colour;
  for (size_t i = 0; i < rows; i++) {
    double at_V = dea_result_table_number(map->table, i, key, 0);
    band->values[i] = line->values[i] = value(map, i);
    if (at_V <= map->end_V) {
      band->values[rows + i] = line->values[rows + i] = 1e-3 * at_V;
      band->values[2 * rows + i] = 1e-3 * map->end_V;
    }
  }
  return DEA_OK;
}

/* "hub z = 500 um", "strain 5 %". */
static void name_level(const struct map *map, size_t k, char out[DEA_LABEL_SIZE])
{
  const bool lift = map->lift_step_m > 0, small = map->lift_step_m < 1e-3;
  const double above = (double)(k + 1) * map->step;
  if (lift || map->strain_step > 0) {
    snprintf(out, DEA_LABEL_SIZE,
             !lift        ? "strain %g %s"
             : map->bound ? "{/:Italic z} \342\211\244 %g %s"
                          : "{/:Italic z} = %g %s",
             above * (lift ? (small ? 1e6 : 1e3) : 100), lift ? (small ? "\302\265m" : "mm") : "%");
    return;
  }
  char name[DEA_LABEL_SIZE / 2], unit[DEA_COLUMN_UNIT_SIZE];
  const bool bare = strcmp(map->quantity->display_unit, "1") == 0;
  dea_label_escape(map->quantity->header, name, sizeof name);
  dea_figure_unit(map->quantity->display_unit, unit);
  snprintf(out, DEA_LABEL_SIZE, "%s = %.4g%s%s", name, map->quantity->factor * (map->base + above),
           bare ? "" : " ", bare ? "" : unit);
}

static dea_status add_levels(struct dea_context *ctx, struct dea_panel *panel,
                             const struct map *map)
{
  size_t rows = map->table->row_count;
  static const enum dea_colour order[] = {DEA_GREEN, DEA_BLUE, DEA_ORANGE, DEA_BLACK};
  for (size_t k = 0; k < map->table->width && !isnan(map->step); k++) {
    struct dea_series *series;
    DEA_TRY(ctx, dea_panel_add(ctx, panel, rows, k < 4 ? DEA_LINE : DEA_DASHED, order[k % 4], "",
                               &series));
    name_level(map, k, series->title);
    for (size_t i = 0; i < rows; i++) {
      series->values[i] = value(map, i);
      series->values[rows + i] = 1e-3 * dea_result_table_number(map->table, i, "level_V", k);
    }
  }
  return DEA_OK;
}

static void label_axis(const struct map *map, char out[DEA_LABEL_SIZE])
{
  struct dea_column shown = {.header = map->number->title,
                             .display_unit = map->number->display_unit};
  dea_figure_label(&shown, out, DEA_LABEL_SIZE);
  for (size_t k = 0; k < USUAL; k++) {
    if (strcmp(usual[k].table, map->table->type.name) == 0) {
      snprintf(out, DEA_LABEL_SIZE, "%s", usual[k].label);
    }
  }
}

static dea_status draw(struct dea_context *ctx, const struct map *map, double own,
                       struct dea_panel *panel)
{
  struct dea_series *here;
  DEA_TRY(ctx, add_region(ctx, panel, map, "breakdown_V", "breakdown above", DEA_VERMILLION));
  DEA_TRY(ctx, add_region(ctx, panel, map, "slack_V", "slack above", DEA_SKY));
  DEA_TRY(ctx, add_region(ctx, panel, map, "pull_in_V", "pull-in", DEA_PURPLE));
  DEA_TRY(ctx, add_levels(ctx, panel, map));
  DEA_TRY(ctx, dea_panel_add(ctx, panel, 1, DEA_MARKERS, DEA_BLACK, "this design", &here));
  here->marker = 5;
  here->values[0] = map->number->factor * own;
  here->values[1] = 1e-3 * map->highest_V;
  label_axis(map, panel->x_label);
  snprintf(panel->y_label, sizeof panel->y_label, "Voltage {/:Italic V} (kV)");
  panel->x_min = value(map, 0);
  panel->x_max = value(map, map->table->row_count - 1);
  panel->y_min = 0;
  return DEA_OK;
}

static bool is_bound(const struct dea_result_table *scale)
{
  bool found = false;
  for (size_t c = 0; scale != NULL && c < scale->type.column_count; c++) {
    if (strcmp(scale->type.columns[c].key, "displacements") == 0) {
      found = dea_result_table_cell(scale, 0, c)->text[0] != '\0';
    }
  }
  return found;
}

/* A map of a model by its table, in a panel. */
static dea_status add_map(struct dea_context *ctx, const struct dea_result *result,
                          const struct dea_result_table *table, struct dea_panel *panel)
{
  const struct dea_result_table *scale = dea_result_find_table(result, table->model, study, "");
  struct map map = {.table = table, .number = &table->type.columns[0], .bound = is_bound(scale)};
  char own[2 * DEA_KEY_PART_SIZE];
  if (scale == NULL || table->row_count == 0) {
    return DEA_OK;
  }
  map.highest_V = dea_result_table_number(scale, 0, "highest_voltage_V", 0);
  map.end_V = dea_result_table_number(scale, 0, "end_voltage_V", 0);
  map.lift_step_m = dea_result_table_number(scale, 0, "displacement_step_m", 0);
  map.strain_step = dea_result_table_number(scale, 0, "strain_step", 0);
  map.quantity = dea_result_table_quantity(scale, 0);
  map.base = dea_result_table_number(scale, 0, "level_base", 0);
  map.step = dea_result_table_number(scale, 0, "level_step", 0);
  if (map.quantity == NULL) { // of an older version
    map.step = map.lift_step_m > 0 ? map.lift_step_m : map.strain_step;
  }
  snprintf(own, sizeof own, "own_%.80s", map.number->key);
  DEA_TRY(ctx, draw(ctx, &map, dea_result_table_number(scale, 0, own, 0), panel));
  panel->y_max = 1e-3 * map.end_V;
  return DEA_OK;
}

/* The key of the first panel says what is in both: what only the second one shows gets a point
 * there beside the axes. */
static void fill_key(struct dea_plot *plot)
{
  struct dea_panel *first = &plot->panels[0];
  size_t titles = 0;
  for (size_t i = 0; i < first->series_count; i++) {
    struct dea_series *series = &first->series[i];
    if (plot->panel_count > 1 && i < plot->panels[1].series_count && !dea_series_shows(series) &&
        dea_series_shows(&plot->panels[1].series[i])) {
      series->values[0] = 2 * first->x_max;
      series->values[series->count] = first->y_max;
    }
    titles += series->title[0] != '\0' && dea_series_shows(series);
  }
  dea_panel_key_above(first, (titles + 1) / 2); // in two columns
}

static bool is_usual(const struct dea_result_table *table)
{
  bool found = false;
  for (size_t k = 0; k < USUAL; k++) {
    found = found || strcmp(usual[k].table, table->type.name) == 0;
  }
  return found;
}

/* Of the first models that have it, one above the other. name: NULL: the maps without a name here.
 */
static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot, const char *name)
{
  size_t shown = 0;
  for (size_t t = 0; t < result->table_count && shown < DEA_PLOT_PANELS_MAX; t++) {
    const struct dea_result_table *table = &result->tables[t];
    struct dea_panel *panel = &plot->panels[shown];
    if (strcmp(table->type.study, study) != 0 || table->type.name[0] == '\0' ||
        (name != NULL ? strcmp(table->type.name, name) != 0 : is_usual(table))) {
      continue;
    }
    DEA_TRY(ctx, add_map(ctx, result, table, panel));
    if (panel->series_count > 0) {
      snprintf(panel->y_label, sizeof panel->y_label, "{/:Italic V} (kV), model %.40s",
               table->model);
      panel->key = "off"; // the first one's says all
      plot->panel_count = ++shown;
    }
  }
  fill_key(plot);
  plot->second_height = 1;
  return DEA_OK;
}

static dea_status build_pre_stretch(struct dea_context *ctx, const struct dea_result *result,
                                    struct dea_plot *plot)
{
  return build(ctx, result, plot, usual[0].table);
}

static dea_status build_film_thickness(struct dea_context *ctx, const struct dea_result *result,
                                       struct dea_plot *plot)
{
  return build(ctx, result, plot, usual[1].table);
}

static dea_status build_others(struct dea_context *ctx, const struct dea_result *result,
                               struct dea_plot *plot)
{
  return build(ctx, result, plot, NULL);
}

const struct dea_figure dea_operating_map_figures[DEA_OPERATING_MAP_FIGURES] = {
    DEA_STUDY_FIGURE("map_pre_stretch", study, build_pre_stretch,
                     "where the actuator can be used: voltage and pre-stretch"),
    DEA_STUDY_FIGURE("map_film_thickness", study, build_film_thickness,
                     "where the actuator can be used: voltage and film thickness"),
    DEA_STUDY_FIGURE("map", study, build_others,
                     "where the actuator can be used: voltage and numbers of its design"),
};
