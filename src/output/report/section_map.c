/* The operating map of model lumped: at which voltages the actuator works, against a parameter of
 * the design. Each column of the map is the equilibrium path of one design, so that its limits are
 * those of the path, to the solver's accuracy. */
#include "model/model.h"
#include "output/report/plot_svg.h"
#include "output/report/section.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COLUMNS = 33, LEVELS_MAX = 8, PATH_POINTS = 3000 };

/* A parameter of the map: key of the design, values between shares of the design's own. */
struct parameter {
  const char *key, *unit, *label, *words;
  double factor;         // display unit
  double least, most;    // shares of the design's value
  double floor, ceiling; // limits of the values, SI
};

static const struct parameter parameters[] = {
    {"pre_stretch", "", "Pre-stretch", "pre-stretch", 1, 0.5, 1.7, 1, 6},
    {"film.thickness", "um", "Thickness of the unstretched film (\302\265m)", "film thickness", 1e6,
     0.25, 3, 0, 1},
};

/* What one path says: voltages [V], NAN where there is none. */
struct column {
  double value; // of the parameter, SI
  double slack_V, breakdown_V, pull_in_V;
  double level_V[LEVELS_MAX];
};

struct map {
  const struct parameter *parameter;
  double last_V, top_V;
  bool lift;   // levels of the fibre tip's displacement [m]; else of the strain
  double step; // between levels
  size_t level_count;
  struct column columns[COLUMNS];
  struct column *now; // being filled
  struct dea_load_point before;
};

static double level_value(const struct map *map, const struct dea_load_point *point)
{
  return map->lift ? point->fibre_tip_z_m : point->electrode_stretch - 1;
}

static double first_of(double before, double now)
{
  return isnan(before) ? now : before;
}

/* Where the path passes the levels, linear between its points, as long as it is stable. */
static dea_status take_point(void *user, const struct dea_load_point *point)
{
  struct map *map = user;
  if (isnan(map->before.voltage_V) && point->min_tension_N_per_m < 1e-6) {
    map->now->slack_V = 0; // a film without pre-stretch
  }
  double from = level_value(map, &map->before), to = level_value(map, point);
  for (size_t k = 0; k < map->level_count && point->stable; k++) {
    double level = map->step * (double)(k + 1);
    if (from < level && to >= level) {
      double share = (level - from) / (to - from);
      double at = map->before.voltage_V + share * (point->voltage_V - map->before.voltage_V);
      map->now->level_V[k] = first_of(map->now->level_V[k], at);
    }
  }
  map->before = *point;
  return DEA_OK;
}

static dea_status take_event(void *user, const struct dea_event *event)
{
  struct map *map = user;
  double at = event->point.voltage_V;
  if (event->kind == DEA_EVENT_SLACK) {
    map->now->slack_V = first_of(map->now->slack_V, at);
  } else if (event->kind == DEA_EVENT_BREAKDOWN) {
    map->now->breakdown_V = first_of(map->now->breakdown_V, at);
  } else if (event->kind == DEA_EVENT_PULL_IN) {
    map->now->pull_in_V = first_of(map->now->pull_in_V, at);
  }
  return DEA_OK;
}

static dea_status trace(struct dea_context *ctx, const struct dea_device *device, struct map *map)
{
  const struct dea_model_type *type = dea_model_find("lumped");
  const struct dea_path_options options = {10 * device->pre_stretch, map->top_V, PATH_POINTS};
  struct dea_model *model;
  DEA_TRY(ctx, type->create(ctx, device, NULL, &model));
  map->before = dea_load_point_empty();
  dea_status status = dea_model_path(ctx, type, model, &options, take_point, take_event, map);
  type->destroy(ctx, model);
  return status;
}

/* The design with another value of the parameter; one that does not fit together stays empty. */
static dea_status fill_column(struct dea_report *report, const struct dea_report_run *run,
                              struct map *map, struct column *column)
{
  char value[64];
  struct dea_design *design = NULL;
  struct dea_device *device = NULL;
  snprintf(value, sizeof value, "%.9g %s", map->parameter->factor * column->value,
           map->parameter->unit);
  const struct dea_override override = {map->parameter->key, value};
  map->now = column;
  column->slack_V = column->breakdown_V = column->pull_in_V = NAN;
  for (size_t k = 0; k < LEVELS_MAX; k++) {
    column->level_V[k] = NAN;
  }
  dea_status status = dea_report_run_build(report->ctx, run, &override, &design, &device);
  if (status == DEA_OK) {
    status = trace(report->ctx, device, map);
  }
  dea_device_destroy(report->ctx, device);
  dea_design_destroy(report->ctx, design);
  dea_finding_clear(report->ctx);
  if (status != DEA_OK && status != DEA_E_MEMORY && status != DEA_E_INTERRUPTED) {
    dea_context_clear(report->ctx);
    status = DEA_OK;
  }
  return status;
}

/* Levels in steps of 1, 2 or 5: about five up to what the design itself reaches. */
static dea_status choose_levels(struct dea_report *report, const struct dea_report_run *run,
                                struct map *map)
{
  const struct dea_model_type *type = dea_model_find("lumped");
  struct dea_model *model;
  struct dea_load_point point = dea_load_point_empty();
  DEA_TRY(report->ctx, type->create(report->ctx, run->device, NULL, &model));
  double reached = NAN;
  for (double share = 1; share > 0.1 && !(reached > 0); share -= 0.1) {
    if (type->solve(report->ctx, model, share * map->last_V, &point) == DEA_OK) {
      reached = level_value(map, &point);
    }
  }
  type->destroy(report->ctx, model);
  dea_context_clear(report->ctx);
  if (reached > 0) {
    static const double nice[] = {1, 2, 5, 10};
    double power = pow(10, floor(log10(reached / 5)));
    for (size_t i = 0; i < 4 && map->level_count == 0; i++) {
      if (nice[i] * power >= 0.999 * reached / 5) {
        map->step = nice[i] * power;
        map->level_count = LEVELS_MAX;
      }
    }
  }
  return DEA_OK;
}

/* A band from where a limit is up to the top, over the columns that have it. */
static dea_status add_region(struct dea_context *ctx, struct dea_panel *panel,
                             const struct map *map, size_t offset, const char *title,
                             enum dea_colour colour)
{
  struct dea_series *band, *line;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, COLUMNS, &band));
  DEA_TRY(ctx, dea_panel_add(ctx, panel, COLUMNS, &line));
  band->style = DEA_BAND;
  band->colour = line->colour = colour;
  snprintf(line->title, sizeof line->title, "%s", title);
  for (size_t i = 0; i < COLUMNS; i++) {
    double at_V = *(const double *)((const char *)&map->columns[i] + offset);
    band->values[i] = line->values[i] = map->parameter->factor * map->columns[i].value;
    if (at_V <= map->top_V) {
      band->values[COLUMNS + i] = line->values[COLUMNS + i] = 1e-3 * at_V;
      band->values[2 * COLUMNS + i] = 1e-3 * map->top_V;
    }
  }
  return DEA_OK;
}

static dea_status add_levels(struct dea_context *ctx, struct dea_panel *panel,
                             const struct map *map)
{
  for (size_t k = 0; k < map->level_count; k++) {
    struct dea_series *series;
    DEA_TRY(ctx, dea_panel_add(ctx, panel, COLUMNS, &series));
    series->style = k % 2 == 0 ? DEA_LINE : DEA_DASHED;
    series->colour = DEA_GREEN;
    double level = map->step * (double)(k + 1);
    bool small = map->lift && map->step < 1e-3;
    snprintf(series->title, sizeof series->title,
             map->lift ? "{/:Italic z} = %g %s" : "strain %g %s",
             level * (map->lift ? (small ? 1e6 : 1e3) : 100),
             map->lift ? (small ? "\302\265m" : "mm") : "%");
    for (size_t i = 0; i < COLUMNS; i++) {
      series->values[i] = map->parameter->factor * map->columns[i].value;
      series->values[COLUMNS + i] = 1e-3 * map->columns[i].level_V[k];
    }
  }
  return DEA_OK;
}

static dea_status draw(struct dea_report *report, const struct map *map, double own,
                       struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  struct dea_series *here;
  DEA_TRY(report->ctx, add_region(report->ctx, panel, map, offsetof(struct column, breakdown_V),
                                  "breakdown above", DEA_VERMILLION));
  DEA_TRY(report->ctx, add_region(report->ctx, panel, map, offsetof(struct column, slack_V),
                                  "film slack above", DEA_SKY));
  DEA_TRY(report->ctx, add_region(report->ctx, panel, map, offsetof(struct column, pull_in_V),
                                  "pull-in", DEA_PURPLE));
  DEA_TRY(report->ctx, add_levels(report->ctx, panel, map));
  DEA_TRY(report->ctx, dea_panel_add(report->ctx, panel, 1, &here));
  here->style = DEA_MARKERS;
  here->colour = DEA_BLACK;
  here->marker = 5;
  snprintf(here->title, sizeof here->title, "this design at its highest voltage");
  here->values[0] = map->parameter->factor * own;
  here->values[1] = 1e-3 * map->last_V;
  snprintf(panel->x_label, sizeof panel->x_label, "%s", map->parameter->label);
  snprintf(panel->y_label, sizeof panel->y_label, "Voltage {/:Italic V} (kV)");
  panel->x_min = map->parameter->factor * map->columns[0].value;
  panel->x_max = map->parameter->factor * map->columns[COLUMNS - 1].value;
  panel->y_min = 0;
  return DEA_OK;
}

static dea_status add_map(struct dea_report *report, const struct dea_report_run *run,
                          const struct parameter *parameter, double own, double last_V)
{
  struct map map = {.parameter = parameter,
                    .last_V = last_V,
                    .top_V = 1.5 * last_V,
                    .lift = run->device->fibre_count > 0};
  double low = fmax(parameter->floor, parameter->least * own);
  double high = fmin(parameter->ceiling, parameter->most * own);
  DEA_TRY(report->ctx, choose_levels(report, run, &map));
  for (size_t i = 0; i < COLUMNS; i++) {
    map.columns[i].value = low + (high - low) * (double)i / (COLUMNS - 1);
    DEA_TRY(report->ctx, fill_column(report, run, &map, &map.columns[i]));
  }
  struct dea_plot *plot;
  char caption[128];
  snprintf(caption, sizeof caption, "voltage and %s: where this actuator can be used",
           parameter->words);
  DEA_TRY(report->ctx, dea_plot_create(report->ctx, "map", caption, &plot));
  dea_status status = draw(report, &map, own, plot);
  if (status == DEA_OK) {
    dea_plot_add_svg(&report->text, plot, ++report->figures);
  }
  dea_plot_destroy(report->ctx, plot);
  return status;
}

dea_status dea_section_map(struct dea_report *report, const struct dea_report_run *run)
{
  double last_V = dea_report_run_voltage(run);
  if (run->device == NULL || !(last_V > 0) || run->device->film.law == NULL ||
      !(run->device->film.permittivity.at_rest > 0)) {
    return DEA_OK;
  }
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
    DEA_TRY(report->ctx, add_map(report, run, &parameters[i], own[i], last_V));
  }
  dea_text_add(&report->text, "</div>");
  dea_section_end(report);
  return DEA_OK;
}
