/* The operating map of model lumped: at which voltages the actuator works, against a parameter of
 * the design, as study operating-map found it. */
#include "output/report/plot_svg.h"
#include "output/report/section.h"

#include <math.h>
#include <stdio.h>

static const char model[] = "lumped", study[] = "operating-map";

/* A parameter of the map: its table and the key of its values there. */
struct parameter {
  const char *table, *key, *label, *words;
  double factor; // display unit
};

static const struct parameter parameters[] = {
    {"pre_stretch", "pre_stretch", "Pre-stretch", "pre-stretch", 1},
    {"film_thickness", "film_thickness_m", "Thickness of the unstretched film (\302\265m)",
     "film thickness", 1e6},
};

struct map {
  const struct parameter *parameter;
  const struct dea_result_table *table;
  double highest_V, end_V;
  double lift_step_m, strain_step; // between levels; one is NAN, or both: none
};

static double value(const struct map *map, size_t row)
{
  return map->parameter->factor * dea_result_table_number(map->table, row, map->parameter->key, 0);
}

/* A band from where a limit is up to the top, over the rows that have it. */
static dea_status add_region(struct dea_context *ctx, struct dea_panel *panel,
                             const struct map *map, const char *key, const char *title,
                             enum dea_colour colour)
{
  struct dea_series *band, *line;
  size_t rows = map->table->row_count;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, rows, &band));
  DEA_TRY(ctx, dea_panel_add(ctx, panel, rows, &line));
  band->style = DEA_BAND;
  band->to_top = true;
  band->colour = line->colour = colour;
  snprintf(line->title, sizeof line->title, "%s", title);
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

static dea_status add_levels(struct dea_context *ctx, struct dea_panel *panel,
                             const struct map *map)
{
  bool lift = map->lift_step_m > 0, small = map->lift_step_m < 1e-3;
  double step = lift ? map->lift_step_m : map->strain_step;
  size_t rows = map->table->row_count;
  static const enum dea_colour order[] = {DEA_GREEN, DEA_BLUE, DEA_ORANGE, DEA_BLACK};
  for (size_t k = 0; k < map->table->width && step > 0; k++) {
    struct dea_series *series;
    DEA_TRY(ctx, dea_panel_add(ctx, panel, rows, &series));
    series->style = k < 4 ? DEA_LINE : DEA_DASHED;
    series->colour = order[k % 4];
    double level = step * (double)(k + 1);
    snprintf(series->title, sizeof series->title, lift ? "{/:Italic z} = %g %s" : "strain %g %s",
             level * (lift ? (small ? 1e6 : 1e3) : 100), lift ? (small ? "\302\265m" : "mm") : "%");
    for (size_t i = 0; i < rows; i++) {
      series->values[i] = value(map, i);
      series->values[rows + i] = 1e-3 * dea_result_table_number(map->table, i, "level_V", k);
    }
  }
  return DEA_OK;
}

static dea_status draw(struct dea_context *ctx, const struct map *map, double own,
                       struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  struct dea_series *here;
  DEA_TRY(ctx, add_region(ctx, panel, map, "breakdown_V", "breakdown above", DEA_VERMILLION));
  DEA_TRY(ctx, add_region(ctx, panel, map, "slack_V", "film slack above", DEA_SKY));
  DEA_TRY(ctx, add_region(ctx, panel, map, "pull_in_V", "pull-in", DEA_PURPLE));
  DEA_TRY(ctx, add_levels(ctx, panel, map));
  DEA_TRY(ctx, dea_panel_add(ctx, panel, 1, &here));
  here->style = DEA_MARKERS;
  here->colour = DEA_BLACK;
  here->marker = 5;
  snprintf(here->title, sizeof here->title, "this design at its highest voltage");
  here->values[0] = map->parameter->factor * own;
  here->values[1] = 1e-3 * map->highest_V;
  snprintf(panel->x_label, sizeof panel->x_label, "%s", map->parameter->label);
  snprintf(panel->y_label, sizeof panel->y_label, "Voltage {/:Italic V} (kV)");
  panel->x_min = value(map, 0);
  panel->x_max = value(map, map->table->row_count - 1);
  panel->y_min = 0;
  return DEA_OK;
}

static dea_status add_map(struct dea_report *report, const struct map *map, double own)
{
  struct dea_plot *plot;
  char caption[128];
  snprintf(caption, sizeof caption, "voltage and %s: where this actuator can be used",
           map->parameter->words);
  DEA_TRY(report->ctx, dea_plot_create(report->ctx, "map", caption, &plot));
  dea_status status = draw(report->ctx, map, own, plot);
  if (status == DEA_OK) {
    dea_plot_add_svg(&report->text, plot, ++report->figures);
  }
  dea_plot_destroy(report->ctx, plot);
  return status;
}

dea_status dea_section_map(struct dea_report *report, const struct dea_report_run *run)
{
  const struct dea_result *result = run->run->result;
  const struct dea_result_table *scale = dea_result_find_table(result, model, study, "");
  if (run->device == NULL || scale == NULL) {
    return DEA_OK;
  }
  struct map map = {.highest_V = dea_result_table_number(scale, 0, "highest_voltage_V", 0),
                    .end_V = dea_result_table_number(scale, 0, "end_voltage_V", 0),
                    .lift_step_m = dea_result_table_number(scale, 0, "displacement_step_m", 0),
                    .strain_step = dea_result_table_number(scale, 0, "strain_step", 0)};
  dea_section_begin(report, "map", run->number, "Operating map");
  dea_text_add(
      &report->text,
      "<p>By model lumped, other values of the design as they are. %s%s</p>"
      "<div class=\"plots\">",
      run->device->fibre_count > 0 ? "Displacements are those of rigid rods, so upper bounds. "
                                   : "",
      run->device->film.breakdown.known ? "" : "The breakdown field of this film is unknown.");
  const double own[] = {run->device->pre_stretch, run->device->film_thickness_unstretched_m};
  for (size_t i = 0; i < sizeof parameters / sizeof parameters[0]; i++) {
    map.parameter = &parameters[i];
    map.table = dea_result_find_table(result, model, study, parameters[i].table);
    if (map.table != NULL && map.table->row_count > 0) {
      DEA_TRY(report->ctx, add_map(report, &map, own[i]));
    }
  }
  dea_text_add(&report->text, "</div>");
  dea_section_end(report);
  return DEA_OK;
}
