/* Study "operating-map": at which voltages the actuator works, against a parameter of the design.
 * Each row is the equilibrium path of one design, so that its limits are those of the path, to the
 * solver's accuracy. */
#include "device/geometry.h"
#include "study/operating_map_figure.h"
#include "study/study.h"

#include <math.h>
#include <stddef.h>

enum { IN_ALL = DEA_IN_JSON | DEA_IN_CSV | DEA_IN_TERMINAL };
enum { ROWS = 33, LEVELS = DEA_RESULT_TABLE_WIDTH_MAX, PATH_POINTS = 3000 };

// Tables -----------------------------------------------------------------------------------------

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define VOLTAGE(its_key, its_title, its_meaning)                                                   \
  DEA_NUMBER_COLUMN(its_key, "V", "kV", 1e-3, its_title, its_meaning)
#define LIMITS                                                                                     \
  VOLTAGE("slack_V", "slack above", "voltage at which the film loses its tension"),                \
      VOLTAGE("breakdown_V", "breakdown above", "voltage of breakdown"),                           \
      VOLTAGE("pull_in_V", "pull-in", "voltage of pull-in"),                                       \
  {                                                                                                \
    .key = "level_V", .si_unit = "V", .display_unit = "kV", .factor = 1e-3, .list = true,          \
    .hidden = DEA_IN_SCREEN, .title = "level",                                                     \
    .meaning = "voltages at which displacement or strain reaches 1, 2, ... of its steps"           \
  }

static const struct dea_result_column scale_columns[] = {
    VOLTAGE("highest_voltage_V", "highest voltage", "of the design or the run's curves"),
    VOLTAGE("end_voltage_V", "end", "voltage at which the paths of the map end"),
    DEA_NUMBER_COLUMN("displacement_step_m", "m", "um", 1e6, "step of displacement",
                      "of the fibre tips, from one level to the next"),
    DEA_NUMBER_COLUMN("strain_step", NULL, "%", 100, "step of strain",
                      "of the electrode's radius, from one level to the next; without fibres"),
    DEA_TEXT_COLUMN("displacements", "displacements",
                    "\"upper bounds\", or nothing where they are predictions"),
    {.key = "own_pre_stretch", .title = "pre-stretch", .meaning = "of the design itself"},
    DEA_NUMBER_COLUMN("own_film_thickness_m", "m", "um", 1e6, "film thickness",
                      "of the design itself, unstretched"),
};
static const struct dea_result_column pre_stretch_columns[] = {
    {.key = "pre_stretch", .title = "pre-stretch", .meaning = "of the film"}, LIMITS};
static const struct dea_result_column thickness_columns[] = {
    DEA_NUMBER_COLUMN("film_thickness_m", "m", "um", 1e6, "film thickness", "unstretched"), LIMITS};

static const char study_name[] = "operating-map";
static const struct dea_result_table_type scale_table = {.study = study_name,
                                                         .name = "",
                                                         .title = "operating map",
                                                         .where = DEA_IN_JSON | DEA_IN_TERMINAL,
                                                         .one_row = true,
                                                         .columns = scale_columns,
                                                         .column_count = COUNT(scale_columns)};

/* A parameter of the map: a number of the design, values between shares of the design's own. */
struct parameter {
  struct dea_result_table_type table;
  size_t offset;         // of the struct dea_quantity in the design
  double least, most;    // shares of the design's value
  double floor, ceiling; // limits of the values, SI
};

static const struct parameter parameters[] = {
    {{.study = study_name,
      .name = "pre_stretch",
      .title = "limits against the pre-stretch",
      .where = IN_ALL, // the report draws it
      .every = 4,
      .columns = pre_stretch_columns,
      .column_count = COUNT(pre_stretch_columns)},
     offsetof(struct dea_design, pre_stretch),
     0.5,
     1.7,
     1,
     6},
    {{.study = study_name,
      .name = "film_thickness",
      .title = "limits against the thickness of the unstretched film",
      .where = IN_ALL, // the report draws it
      .every = 4,
      .columns = thickness_columns,
      .column_count = COUNT(thickness_columns)},
     offsetof(struct dea_design, film.thickness_m),
     0.25,
     3,
     0,
     1},
};

// Study ------------------------------------------------------------------------------------------

/* What one path says: voltages [V], NAN where there is none. */
struct limits {
  double slack_V, breakdown_V, pull_in_V;
  double level_V[LEVELS];
};

struct map {
  const struct dea_model_type *type;
  double highest_V, end_V;
  bool lift;   // levels of the fibre tip's displacement [m]; else of the strain
  bool bound;  // which is an upper bound
  double step; // between levels; NAN: none
  struct dea_design *varied;
  struct limits now; // being filled
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
    map->now.slack_V = 0; // a film without pre-stretch
  }
  double from = level_value(map, &map->before), to = level_value(map, point);
  for (size_t k = 0; k < LEVELS && point->stable; k++) {
    double level = map->step * (double)(k + 1);
    if (from < level && to >= level) {
      double share = (level - from) / (to - from);
      double at = map->before.voltage_V + share * (point->voltage_V - map->before.voltage_V);
      map->now.level_V[k] = first_of(map->now.level_V[k], at);
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
    map->now.slack_V = first_of(map->now.slack_V, at);
  } else if (event->kind == DEA_EVENT_BREAKDOWN) {
    map->now.breakdown_V = first_of(map->now.breakdown_V, at);
  } else if (event->kind == DEA_EVENT_PULL_IN) {
    map->now.pull_in_V = first_of(map->now.pull_in_V, at);
  }
  return DEA_OK;
}

/* The path of the varied design. */
static dea_status follow(struct dea_context *ctx, const struct dea_device *device, struct map *map)
{
  const struct dea_path_options options = {.max_stretch = 10 * device->pre_stretch,
                                           .max_voltage_V = map->end_V,
                                           .max_points = PATH_POINTS};
  struct dea_model *model;
  DEA_TRY(ctx, dea_model_create(ctx, map->type, map->varied, device, &model));
  map->before = dea_load_point_empty();
  dea_status status = dea_model_path(ctx, map->type, model, &options, take_point, take_event, map);
  map->type->destroy(ctx, model);
  return status;
}

/* The limits of the design with another value of a parameter; one that does not fit together, or
 * that the model cannot follow, has none. Materials stay. */
static dea_status find_limits(struct dea_context *ctx, const struct dea_result *result,
                              const struct parameter *parameter, double value, struct map *map)
{
  struct dea_device device = *result->device;
  map->now = (struct limits){NAN, NAN, NAN, {NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN}};
  *map->varied = *result->design;
  ((struct dea_quantity *)(void *)((char *)map->varied + parameter->offset))->si = value;
  dea_geometry_fill(map->varied, &device);
  size_t errors = dea_finding_trial_begin(ctx);
  dea_status status = dea_geometry_check(ctx, map->varied, &device);
  if (status == DEA_OK && dea_finding_count(ctx, DEA_ERROR) == errors) {
    status = follow(ctx, &device, map);
  }
  dea_finding_trial_end(ctx, errors);
  if (status == DEA_E_MEMORY || status == DEA_E_INTERRUPTED) {
    return status;
  }
  dea_context_clear(ctx);
  return DEA_OK;
}

/* Levels in steps of 1, 2 or 5: about five up to what the design itself reaches. */
static dea_status choose_step(struct dea_context *ctx, const struct dea_result *result,
                              struct map *map)
{
  static const double nice[] = {1, 2, 5, 10};
  struct dea_model *model;
  struct dea_load_point point = dea_load_point_empty();
  DEA_TRY(ctx, dea_model_create(ctx, map->type, result->design, result->device, &model));
  double reached = NAN;
  const size_t errors = dea_finding_trial_begin(ctx);
  for (double share = 1; share > 0.1 && !(reached > 0); share -= 0.1) {
    if (map->type->solve(ctx, model, share * map->highest_V, &point) == DEA_OK) {
      reached = level_value(map, &point);
      map->bound = map->lift && dea_load_point_bounds(&point);
    }
  }
  dea_finding_trial_end(ctx, errors);
  map->type->destroy(ctx, model);
  dea_context_clear(ctx);
  map->step = NAN;
  double power = pow(10, floor(log10(reached / 5)));
  for (size_t i = 0; i < COUNT(nice) && reached > 0 && isnan(map->step); i++) {
    map->step = nice[i] * power >= 0.999 * reached / 5 ? nice[i] * power : NAN;
  }
  return DEA_OK;
}

static dea_status add_parameter(struct dea_context *ctx, const struct parameter *parameter,
                                struct map *map, struct dea_result *result)
{
  const void *member = (const char *)result->design + parameter->offset;
  double own = ((const struct dea_quantity *)member)->si;
  double low = fmax(parameter->floor, parameter->least * own);
  double high = fmin(parameter->ceiling, parameter->most * own);
  struct dea_result_table *table;
  DEA_TRY(ctx,
          dea_result_add_table(ctx, result, &parameter->table, map->type->name, LEVELS, &table));
  for (size_t i = 0; i < ROWS; i++) {
    double value = low + (high - low) * (double)i / (ROWS - 1);
    if (dea_interrupted_anywhere(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted; %zu rows of the operating map are kept",
                      table->row_count);
    }
    DEA_TRY(ctx, find_limits(ctx, result, parameter, value, map));
    const struct dea_result_table_value row[] = {{.number = value},
                                                 {.number = map->now.slack_V},
                                                 {.number = map->now.breakdown_V},
                                                 {.number = map->now.pull_in_V},
                                                 {.list = map->now.level_V}};
    DEA_TRY(ctx, dea_result_table_add_row(ctx, table, row));
  }
  return DEA_OK;
}

static dea_status add_map(struct dea_context *ctx, struct map *map, struct dea_result *result)
{
  struct dea_result_table *scale;
  DEA_TRY(ctx, choose_step(ctx, result, map));
  const struct dea_result_table_value row[] = {{.number = map->highest_V},
                                               {.number = map->end_V},
                                               {.number = map->lift ? map->step : NAN},
                                               {.number = map->lift ? NAN : map->step},
                                               {.text = map->bound ? "upper bounds" : ""},
                                               {.number = result->design->pre_stretch.si},
                                               {.number = result->design->film.thickness_m.si}};
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &scale_table, map->type->name, 0, &scale));
  DEA_TRY(ctx, dea_result_table_add_row(ctx, scale, row));
  for (size_t i = 0; i < COUNT(parameters); i++) {
    DEA_TRY(ctx, add_parameter(ctx, &parameters[i], map, result));
  }
  return DEA_OK;
}

static dea_status run(struct dea_context *ctx, const struct dea_model_type *type,
                      struct dea_model *model, struct dea_result *result)
{
  (void)model; // none: each design has its own
  double highest_V = dea_study_highest_V(result);
  struct map map = {.type = type,
                    .highest_V = highest_V,
                    .end_V = 1.5 * highest_V,
                    .lift = result->device->fibre_count > 0};
  if (!(highest_V > 0)) {
    return DEA_OK;
  }
  map.varied = dea_alloc(ctx, 1, sizeof *map.varied);
  if (map.varied == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = add_map(ctx, &map, result);
  dea_free(ctx, map.varied); // what it points to is the design's
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

static bool able(const struct dea_model_type *type, const struct dea_result *result)
{
  (void)result;
  return type->path != NULL;
}

const struct dea_study dea_study_operating_map = {.name = study_name,
                                                  .by_name_only = true,
                                                  .own_models = true,
                                                  .ability = "equilibrium path",
                                                  .able = able,
                                                  .run = run,
                                                  .figures = dea_operating_map_figures,
                                                  .figure_count = DEA_OPERATING_MAP_FIGURES};
