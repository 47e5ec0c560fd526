/* Study "operating-map": at which voltages the actuator works, against numbers of the design. Each
 * row is the equilibrium path of one design, so that its limits are those of the path, to the
 * solver's accuracy; of a model without such paths its sweep, with limits between its points. */
#include "base/schema.h"
#include "base/units.h"
#include "result/observation.h"
#include "study/design_gradient.h"
#include "study/observe.h"
#include "study/study.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

enum { IN_ALL = DEA_IN_JSON | DEA_IN_CSV | DEA_IN_TERMINAL };
enum { ROWS = 33, SWEPT_ROWS = 5, LEVELS = DEA_RESULT_TABLE_WIDTH_MAX, PATH_POINTS = 3000 };
enum { AXES_MAX = 4 };

static const char study_name[] = "operating-map";

// Keys -------------------------------------------------------------------------------------------

struct axis_keys {
  struct dea_label name, from, to;
};

/* Settings of compute.operating_map. */
struct settings {
  struct axis_keys parameters[AXES_MAX];
  size_t parameter_count;
  struct dea_label quantity;
  struct dea_quantity rows;
};

#define AT(member) offsetof(struct settings, member)

static const struct dea_field axis_fields[] = {
    DEA_LABEL_ROW("name", offsetof(struct axis_keys, name), "plies.film.thickness",
                  "number of the design by its name in dea run --sensitivity", .required = true),
    DEA_LABEL_ROW("from", offsetof(struct axis_keys, from), "50 um", "its first value",
                  .absent_text = "half the design's"),
    DEA_LABEL_ROW("to", offsetof(struct axis_keys, to), "200 um", "its last value",
                  .absent_text = "one and a half times the design's"),
};
static const struct dea_field fields[] = {
    DEA_FIELD_ROW(RECORD, "parameters", AT(parameters), .record = DEA_ROWS(axis_fields),
                  .absent_text = "pre-stretch and thickness of the film",
                  .doc = "numbers of the design, a map each",
                  .example = "[{name: plies.film.thickness, from: 50 um, to: 200 um}]",
                  DEA_LIST(1, AXES_MAX, struct axis_keys, AT(parameter_count))),
    DEA_LABEL_ROW("quantity", AT(quantity), "hub_z_m",
                  "whose levels are drawn, of load points or monitors",
                  .absent_text = "z of the fibre tips, strain, or what a monitor shows most"),
    DEA_INTEGER_ROW("rows", AT(rows), "9", "values of each number", .min = 2, .max = 101,
                    .absent_text = "33, of model 3d 5"),
};
static const struct dea_design_section section = {
    .record = {"operating_map",
               "study of the voltages at which the actuator works against numbers of the design, "
               "made when this section is there ({}) or with --study: of model 3d by sweeps, where "
               "this section is there",
               fields, DEA_COUNT(fields)},
    .size = sizeof(struct settings)};

// Numbers and quantity ---------------------------------------------------------------------------

/* A number of the map, with its values. */
struct axis {
  struct dea_design_number number;
  double low, high;
  const char *title; // NULL: the key
};

/* Those of a disc, with values between shares of the design's own, within limits. */
static const struct {
  const char *key, *title;
  double least, most, floor, ceiling;
} usual[] = {{"pre_stretch", "pre-stretch", 0.5, 1.7, 1, 6},
             {"film.thickness", "film thickness", 0.25, 3, 0, 1}};

/* What a map is made of, of a design. */
struct plan {
  struct axis axes[AXES_MAX];
  size_t count;
  int column; // of the levels; -1: what a monitor shows most
};

struct numbers {
  struct dea_design_number at[DEA_NUMBERS_MAX];
  size_t count;
};

static const struct dea_design_number *find_number(const struct numbers *numbers, const char *key)
{
  for (size_t i = 0; i < numbers->count; i++) {
    if (strcmp(numbers->at[i].key, key) == 0) {
      return &numbers->at[i];
    }
  }
  return NULL;
}

/* An end of an axis, which stays as it is where there is none. */
static dea_status read_end(struct dea_context *ctx, const struct dea_label *label,
                           const struct dea_design_number *number, double *end)
{
  char why[DEA_WHY_SIZE] = "", example[40];
  const struct dea_measure due = {number->unit, example};
  if (label->text[0] == '\0') {
    return DEA_OK;
  }
  snprintf(example, sizeof example, "2 %.16s", number->unit);
  if (dea_units_read(ctx, label->text, due, end, why)) {
    return DEA_OK;
  }
  return why[0] == '\0' ? dea_context_status(ctx) : dea_refuse(ctx, label->location, why);
}

static dea_status add_given(struct dea_context *ctx, const struct numbers *numbers,
                            const struct axis_keys *keys, struct plan *plan)
{
  const struct dea_design_number *number = find_number(numbers, keys->name.text);
  struct axis *axis = &plan->axes[plan->count];
  if (number == NULL || number->of == DEA_NUMBER_OF_SUPPLY) {
    const char *known[DEA_NUMBERS_MAX];
    char why[DEA_HINT_SIZE + 200], hint[DEA_HINT_SIZE];
    for (size_t i = 1; i < numbers->count; i++) { // the voltage, the first, is the other axis
      known[i - 1] = numbers->at[i].key;
    }
    dea_name_hint(keys->name.text, known, numbers->count > 0 ? numbers->count - 1 : 0, hint);
    snprintf(why, sizeof why, "'%.60s' is no number of the design that can change%s",
             keys->name.text, hint);
    return dea_refuse(ctx, keys->name.location, why);
  }
  *axis = (struct axis){.number = *number, .low = 0.5 * number->value, .high = 1.5 * number->value};
  DEA_TRY(ctx, read_end(ctx, &keys->from, number, &axis->low));
  DEA_TRY(ctx, read_end(ctx, &keys->to, number, &axis->high));
  plan->count++;
  return DEA_OK;
}

/* Without a list: of a disc pre-stretch and thickness, else thicknesses of the plies between
 * electrodes. */
static void add_usual(const struct dea_device *device, const struct numbers *numbers,
                      struct plan *plan)
{
  for (size_t i = 0; i < DEA_COUNT(usual); i++) {
    const struct dea_design_number *number = find_number(numbers, usual[i].key);
    if (number != NULL) {
      plan->axes[plan->count++] =
          (struct axis){*number, fmax(usual[i].floor, usual[i].least * number->value),
                        fmin(usual[i].ceiling, usual[i].most * number->value), usual[i].title};
    }
  }
  const struct dea_layout *layout = plan->count == 0 ? device->layout : NULL;
  for (size_t i = 0; layout != NULL && i < layout->ply_count && plan->count < AXES_MAX; i++) {
    char key[DEA_NUMBER_KEY_SIZE];
    snprintf(key, sizeof key, "plies.%.80s.thickness", layout->plies[i].name);
    const struct dea_design_number *number = find_number(numbers, key);
    if (number != NULL && dea_layout_is_dielectric(layout, i)) {
      plan->axes[plan->count++] =
          (struct axis){*number, 0.5 * number->value, 1.5 * number->value, NULL};
    }
  }
}

static dea_status find_quantity(struct dea_context *ctx, const struct dea_device *device,
                                const struct dea_label *label, int *column)
{
  DEA_TRY(ctx, dea_device_columns_add(ctx, device));
  *column = label->text[0] != '\0' ? dea_column_find(ctx, label->text) : -1;
  if (*column >= 0 || label->text[0] == '\0') {
    return DEA_OK;
  }
  char why[DEA_HINT_SIZE + 100], hint[DEA_HINT_SIZE];
  DEA_TRY(ctx, dea_column_hint(ctx, label->text, NULL, hint));
  snprintf(why, sizeof why, "'%.60s' is no quantity%s", label->text, hint);
  return dea_refuse(ctx, label->location, why);
}

static dea_status build_plan(struct dea_context *ctx, const struct dea_design *design,
                             const struct dea_device *device, struct plan *out)
{
  const struct settings *settings = dea_design_settings(design, &section)->values;
  struct numbers *numbers = dea_alloc(ctx, 1, sizeof *numbers);
  *out = (struct plan){.column = -1};
  DEA_TRY_MEMORY(numbers != NULL);
  dea_status status = dea_design_numbers(ctx, design, device, dea_design_highest_V(design), false,
                                         numbers->at, &numbers->count);
  for (size_t i = 0; i < settings->parameter_count && status == DEA_OK; i++) {
    status = add_given(ctx, numbers, &settings->parameters[i], out);
  }
  if (settings->parameter_count == 0 && status == DEA_OK) {
    add_usual(device, numbers, out);
  }
  dea_free(ctx, numbers);
  DEA_TRY(ctx, status);
  return DEA_CHAIN(ctx, find_quantity(ctx, device, &settings->quantity, &out->column));
}

static dea_status refuse(struct dea_context *ctx, const struct dea_design *design,
                         const struct dea_device *device)
{
  struct plan plan;
  return DEA_CHAIN(ctx, build_plan(ctx, design, device, &plan));
}

// Tables -----------------------------------------------------------------------------------------

static const struct dea_result_column scale_columns[] = {
    DEA_KV("highest_voltage_V", "highest voltage", "of the design or the run's curves"),
    DEA_KV("end_voltage_V", "end", "voltage at which the paths of the map end"),
    DEA_UM("displacement_step_m", "step of displacement",
           "of the fibre tips, from one level to the next"),
    DEA_NUMBER_COLUMN("strain_step", NULL, "%", 100, "step of strain",
                      "of the electrode's radius, from one level to the next; without fibres"),
    DEA_TEXT_COLUMN("displacements", "displacements",
                    "\"upper bounds\", or nothing where they are predictions"),
    DEA_RESULT_COLUMN(QUANTITY, "quantity", "levels of", .hidden = DEA_IN_TERMINAL,
                      .meaning = "what the levels are of"),
    DEA_RESULT_COLUMN(VALUE, "level_base", "levels from", .hidden = DEA_IN_TERMINAL,
                      .meaning = "what the levels are counted from"),
    DEA_RESULT_COLUMN(VALUE, "level_step", "step of levels", .hidden = DEA_IN_TERMINAL,
                      .meaning = "from one level to the next"),
};
static const struct dea_result_column limit_columns[] = {
    {0}, // of the number
    DEA_KV("slack_V", "slack above", "voltage at which the film loses its tension"),
    DEA_KV("breakdown_V", "breakdown above", "voltage of breakdown"),
    DEA_KV("pull_in_V", "pull-in", "voltage of pull-in"),
    DEA_RESULT_COLUMN(NUMBER, "level_V", "level", .si_unit = "V", .display_unit = "kV",
                      .factor = 1e-3, .list = true, .hidden = DEA_IN_SCREEN,
                      .meaning = "voltages at which the levels are reached")};

/* "film_thickness" of "film.thickness"; interned. NULL on failure. */
static const char *name_axis(struct dea_context *ctx, const struct axis *axis)
{
  char name[DEA_KEY_PART_SIZE];
  dea_key_part(axis->number.key, name);
  return dea_intern(ctx, name);
}

/* Column of a number's values, or of the design's own: "own_film_thickness_m". */
static dea_status fill_column(struct dea_context *ctx, const struct axis *axis, bool own,
                              struct dea_result_column *out)
{
  static const struct {
    const char *si, *shown;
    double factor, below; // of values that are shown so
  } units[] = {{"m", "um", 1e6, 1e-3}, {"m", "mm", 1e3, INFINITY}, {"Pa", "kPa", 1e-3, INFINITY}};
  const struct dea_design_number *number = &axis->number;
  const bool bare = strcmp(number->unit, "1") == 0;
  char key[2 * DEA_KEY_PART_SIZE + 8], name[DEA_KEY_PART_SIZE], unit[DEA_KEY_PART_SIZE];
  dea_key_part(number->key, name);
  dea_key_part(number->unit, unit);
  snprintf(key, sizeof key, "%s%s%s%s", own ? "own_" : "", name, bare ? "" : "_", bare ? "" : unit);
  *out = (struct dea_result_column)DEA_NUMBER_COLUMN(
      dea_intern(ctx, key), number->unit, number->unit, 1,
      axis->title != NULL ? axis->title : dea_intern(ctx, number->key),
      own ? "of the design itself" : "number of the design");
  for (size_t i = DEA_COUNT(units); i > 0; i--) {
    if (strcmp(units[i - 1].si, number->unit) == 0 && fabs(number->value) < units[i - 1].below) {
      out->display_unit = units[i - 1].shown;
      out->factor = units[i - 1].factor;
    }
  }
  return out->key != NULL && out->title != NULL ? DEA_OK : DEA_E_MEMORY;
}

// Study ------------------------------------------------------------------------------------------

/* What one path says: voltages [V], NAN where there is none. */
struct limits {
  double slack_V, breakdown_V, pull_in_V;
  double level_V[LEVELS];
};

struct map {
  const struct dea_study_job *job;
  struct plan plan;
  double highest_V, end_V;
  bool lift, strain; // levels of the fibre tip's displacement [m], or of the strain, as ever
  bool bound;        // which is an upper bound
  double base, step; // of levels; NAN: none
  struct limits now; // being filled
  struct dea_load_point before;
  double value_before;
};

static double first_of(double before, double now)
{
  return isnan(before) ? now : before;
}

/* Where the path passes the levels, linear between its points, as long as it is stable. */
static dea_status store_point(void *user, const struct dea_load_point *point)
{
  struct map *map = user;
  if (isnan(map->before.voltage_V) && point->min_tension_N_per_m < 1e-6) {
    map->now.slack_V = 0; // a film without pre-stretch
  }
  const double from = map->value_before, to = dea_point_get(point, map->plan.column);
  for (size_t k = 0; k < LEVELS && point->stable; k++) {
    const double level = map->base + map->step * (double)(k + 1);
    if (map->step > 0 ? from < level && to >= level : from > level && to <= level) {
      double share = (level - from) / (to - from);
      double at = map->before.voltage_V + share * (point->voltage_V - map->before.voltage_V);
      map->now.level_V[k] = first_of(map->now.level_V[k], at);
    }
  }
  map->before = *point;
  map->before.monitors = NULL; // lent
  map->value_before = to;
  return DEA_OK;
}

static dea_status store_event(void *user, const struct dea_event *event)
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

/* Voltage at which a number that falls from one point to the next passes 0, or `before`. */
static double passes(double found, const struct dea_load_point *from, double a,
                     const struct dea_load_point *to, double b)
{
  const bool here = a >= 0 && b < 0;
  return here ? first_of(found, from->voltage_V + a / (a - b) * (to->voltage_V - from->voltage_V))
              : found;
}

/* The design's voltages one after the other, in place of a path. */
static dea_status sweep(struct dea_context *ctx, const struct dea_device *device,
                        struct dea_model *model, struct map *map)
{
  const struct dea_model_type *type = map->job->type;
  const struct dea_design *design = map->job->result->design;
  struct dea_monitor_set set;
  dea_status status = dea_monitor_set_init(ctx, type, device, &set);
  for (size_t i = 0; i < design->compute.voltage_count && status == DEA_OK; i++) {
    const struct dea_load_point before = map->before;
    struct dea_load_point point;
    status = type->solve(ctx, model, design->compute.voltages_V[i], &point);
    const struct dea_event *limit =
        status != DEA_OK && type->limit != NULL ? type->limit(model) : NULL;
    if (limit != NULL) {
      store_event(map, limit);
    }
    status =
        status == DEA_OK ? dea_monitor_set_read(ctx, &set, type, model, false, &point) : status;
    if (status == DEA_OK) {
      map->now.slack_V = passes(map->now.slack_V, &before, before.min_tension_N_per_m, &point,
                                point.min_tension_N_per_m);
      map->now.breakdown_V = passes(map->now.breakdown_V, &before, before.breakdown_margin, &point,
                                    point.breakdown_margin);
      status = store_point(map, &point);
    }
  }
  dea_monitor_set_free(&set);
  return status;
}

/* The path of a varied device. */
static dea_status follow(struct dea_context *ctx, const struct dea_device *device, struct map *map)
{
  const struct dea_path_options options = {.max_stretch = 10 * dea_device_pre_stretch(device),
                                           .max_voltage_V = map->end_V,
                                           .max_points = PATH_POINTS};
  struct dea_model *model;
  DEA_TRY(ctx, dea_model_create(ctx, map->job->type, map->job->result->design, device, &model));
  map->before = dea_load_point_empty();
  map->value_before = NAN;
  dea_status status =
      map->job->type->path != NULL
          ? dea_model_path(ctx, map->job->type, model, &options, store_point, store_event, map)
          : sweep(ctx, device, model, map);
  map->job->type->destroy(ctx, model);
  return status;
}

/* The limits of the design with another value of a number; one that does not fit together, or that
 * the model cannot follow, has none. Materials stay. */
static dea_status find_limits(struct dea_context *ctx, const struct dea_design_number *number,
                              double value, struct map *map)
{
  struct dea_changed_device changed;
  map->now = (struct limits){NAN, NAN, NAN, {NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN}};
  size_t errors = dea_finding_trial_begin(ctx);
  dea_status status = dea_device_change(ctx, map->job->result->design, map->job->result->device,
                                        number, value, &changed);
  if (status == DEA_OK && dea_finding_count(ctx, DEA_ERROR) == errors) {
    status = follow(ctx, &changed.device, map);
  }
  dea_changed_device_free(&changed);
  dea_finding_trial_end(ctx, errors);
  return dea_forgive(ctx, status);
}

/* Without a quantity: of a disc fibre tips or strain, else the motion that a monitor shows most. */
static void choose_column(const struct dea_context *ctx, const struct dea_curve *curve,
                          struct map *map)
{
  int column = dea_point_column_find("highest_z_m");
  const int strain = dea_point_column_find("electrode_stretch");
  if (map->plan.column >= 0) {
    return;
  }
  map->lift = map->job->result->device->fibre_count > 0;
  map->strain = !map->lift && dea_points_have(curve->points, curve->count, strain);
  if (map->lift || map->strain) {
    column = map->lift ? dea_point_column_find("fibre_tip_z_m") : strain;
  } else {
    dea_curve_headlines(ctx, curve, &column, 1);
  }
  map->plan.column = column;
}

/* Levels in steps of 1, 2 or 5: about five up to what the design itself reaches. */
static void choose_step(const struct dea_curve *curve, struct map *map)
{
  static const double nice[] = {1, 2, 5, 10};
  const int column = map->plan.column;
  const double rest = map->strain ? 1 : map->lift ? 0 : dea_point_get(&curve->points[0], column);
  const double reached = dea_point_get(&curve->points[curve->count - 1], column) - rest,
               size = fabs(reached);
  map->step = NAN;
  double power = pow(10, floor(log10(size / 5)));
  for (size_t i = 0; i < DEA_COUNT(nice) && size > 0 && isnan(map->step); i++) {
    map->step = nice[i] * power >= 0.999 * size / 5 ? nice[i] * power : NAN;
  }
  map->step = (map->lift || map->strain) && reached < 0 ? NAN : copysign(map->step, reached);
  map->base = map->lift || map->strain ? rest : map->step * floor(rest / map->step);
}

/* The design itself, at rest and at the highest voltage that it reaches. */
static dea_status solve_cells(struct dea_context *ctx, struct map *map)
{
  const struct dea_device *device = map->job->result->device;
  struct dea_study_job own = *map->job;
  struct dea_curve curve = {0};
  DEA_TRY(ctx, dea_model_create(ctx, own.type, own.result->design, device, &own.model));
  const size_t errors = dea_finding_trial_begin(ctx);
  dea_status status = dea_study_add_points(ctx, &own, device, (double[]){0}, 1, &curve);
  for (double share = 1; share > 0.1 && curve.count == 1; share -= 0.1) {
    const double V = share * map->highest_V;
    status = dea_study_add_points(ctx, &own, device, &V, 1, &curve);
  }
  dea_finding_trial_end(ctx, errors);
  own.type->destroy(ctx, own.model);
  if (status != DEA_E_MEMORY && curve.count > 0) {
    choose_column(ctx, &curve, map);
    choose_step(&curve, map);
    map->bound = map->lift && dea_load_point_bounds(&curve.points[curve.count - 1]);
  }
  dea_free(ctx, curve.points);
  dea_arena_free(&curve.memory);
  return dea_forgive(ctx, status);
}

static dea_status add_axis(struct dea_context *ctx, const struct axis *axis, size_t rows,
                           struct map *map)
{
  struct dea_result_column columns[DEA_COUNT(limit_columns)];
  struct dea_result_table *table;
  char title[2 * DEA_NUMBER_KEY_SIZE];
  memcpy(columns, limit_columns, sizeof columns);
  DEA_TRY(ctx, fill_column(ctx, axis, false, &columns[0]));
  snprintf(title, sizeof title, "limits against %s", columns[0].title);
  const struct dea_result_table_type type =
      DEA_RESULT_TABLE(study_name, name_axis(ctx, axis), columns, .title = dea_intern(ctx, title),
                       .where = IN_ALL, .every = rows > 9 ? 4 : 0); // the report draws it
  DEA_TRY_MEMORY(type.name != NULL && type.title != NULL);
  DEA_TRY(ctx,
          dea_result_add_table(ctx, map->job->result, &type, map->job->type->name, LEVELS, &table));
  for (size_t i = 0; i < rows; i++) {
    double value = axis->low + (axis->high - axis->low) * (double)i / (double)(rows - 1);
    if (dea_interrupted_anywhere(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted; %zu rows of the operating map are kept",
                      table->row_count);
    }
    DEA_TRY(ctx, find_limits(ctx, &axis->number, value, map));
    DEA_TRY(ctx, DEA_TABLE_ADD(ctx, table, DEA_CELL(value), DEA_CELL(map->now.slack_V),
                               DEA_CELL(map->now.breakdown_V), DEA_CELL(map->now.pull_in_V),
                               DEA_LIST_CELL(map->now.level_V)));
  }
  return DEA_OK;
}

static dea_status add_scale(struct dea_context *ctx, const struct map *map)
{
  enum { OWN = DEA_COUNT(scale_columns) };
  struct dea_result_column columns[OWN + AXES_MAX];
  struct dea_result_table_value row[OWN + AXES_MAX] = {{.number = map->highest_V},
                                                       {.number = map->end_V},
                                                       {.number = map->lift ? map->step : NAN},
                                                       {.number = map->strain ? map->step : NAN},
                                                       {.text = map->bound ? "upper bounds" : ""},
                                                       {.number = map->plan.column},
                                                       {.number = map->base},
                                                       {.number = map->step}};
  struct dea_result_table *scale;
  memcpy(columns, scale_columns, sizeof scale_columns);
  for (size_t i = 0; i < map->plan.count; i++) {
    DEA_TRY(ctx, fill_column(ctx, &map->plan.axes[i], true, &columns[OWN + i]));
    row[OWN + i].number = map->plan.axes[i].number.value;
  }
  const struct dea_result_table_type type = {.study = study_name,
                                             .name = "",
                                             .title = "operating map",
                                             .where = DEA_IN_JSON | DEA_IN_TERMINAL,
                                             .one_row = true,
                                             .columns = columns,
                                             .column_count = OWN + map->plan.count};
  DEA_TRY(ctx, dea_result_add_table(ctx, map->job->result, &type, map->job->type->name, 0, &scale));
  return DEA_CHAIN(ctx, dea_result_table_add_row(ctx, scale, row));
}

static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct dea_result *result = job->result;
  const struct settings *settings = dea_design_settings(result->design, &section)->values;
  const bool given = settings->rows.origin != DEA_ABSENT && settings->rows.si >= 2;
  const bool has_path = job->type->path != NULL;
  const size_t rows = given ? (size_t)settings->rows.si : has_path ? ROWS : SWEPT_ROWS;
  double highest_V = dea_study_highest_V(result);
  struct map map = {
      .job = job, .highest_V = highest_V, .end_V = has_path ? 1.5 * highest_V : highest_V};
  if (!(highest_V > 0)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, build_plan(ctx, result->design, result->device, &map.plan));
  DEA_TRY(ctx, solve_cells(ctx, &map));
  if (map.plan.column < 0) { // it has no point
    return DEA_OK;
  }
  DEA_TRY(ctx, add_scale(ctx, &map));
  for (size_t i = 0; i < map.plan.count; i++) {
    DEA_TRY(ctx, add_axis(ctx, &map.plan.axes[i], rows, &map));
  }
  return DEA_OK;
}

// Figures ----------------------------------------------------------------------------------------

/* Tables with figures and labels of their own. */
static const struct {
  const char *table, *label;
} labelled[] = {
    {"pre_stretch", "Pre-stretch"},
    {"film_thickness", "Thickness of the unstretched film (\302\265m)"},
};

struct shown {
  const struct dea_result_table *table;
  const struct dea_result_column *number; // its first column
  double highest_V, end_V;
  double lift_step_m, strain_step;   // between levels; one is NAN, or both: none
  const struct dea_column *quantity; // then of this, from base on
  double base, step;
  bool bound; // a displacement is an upper bound
};

static double value(const struct shown *map, size_t row)
{
  return map->number->factor * dea_result_table_number(map->table, row, map->number->key, 0);
}

/* A band from where a limit is up to the top, over the rows that have it. */
static dea_status add_region(struct dea_context *ctx, struct dea_panel *panel,
                             const struct shown *map, const char *key, const char *title,
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
static void name_level(const struct shown *map, size_t k, char out[DEA_LABEL_SIZE])
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
                             const struct shown *map)
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

/* Label of the axis of a table with a figure of its own; NULL: of another one. */
static const char *label_of(const struct dea_result_table *table)
{
  for (size_t k = 0; k < DEA_COUNT(labelled); k++) {
    if (strcmp(labelled[k].table, table->type.name) == 0) {
      return labelled[k].label;
    }
  }
  return NULL;
}

static dea_status draw(struct dea_context *ctx, const struct shown *map, double own,
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
  const char *label = label_of(map->table);
  const struct dea_column shown = {.header = map->number->title,
                                   .display_unit = map->number->display_unit};
  dea_figure_label(&shown, panel->x_label, DEA_LABEL_SIZE);
  if (label != NULL) {
    snprintf(panel->x_label, DEA_LABEL_SIZE, "%s", label);
  }
  snprintf(panel->y_label, sizeof panel->y_label, "Voltage {/:Italic V} (kV)");
  panel->x_min = value(map, 0);
  panel->x_max = value(map, map->table->row_count - 1);
  panel->y_min = 0;
  return DEA_OK;
}

/* A map of a model by its table, in a panel. */
static dea_status add_map(struct dea_context *ctx, const struct dea_result *result,
                          const struct dea_result_table *table, struct dea_panel *panel)
{
  const struct dea_result_table *scale =
      dea_result_find_table(result, table->model, study_name, "");
  struct shown map = {.table = table, .number = &table->type.columns[0]};
  char own[2 * DEA_KEY_PART_SIZE];
  if (scale == NULL || table->row_count == 0) {
    return DEA_OK;
  }
  map.bound = dea_result_table_text(scale, 0, "displacements")[0] != '\0';
  map.highest_V = dea_result_table_number(scale, 0, "highest_voltage_V", 0);
  map.end_V = dea_result_table_number(scale, 0, "end_voltage_V", 0);
  map.lift_step_m = dea_result_table_number(scale, 0, "displacement_step_m", 0);
  map.strain_step = dea_result_table_number(scale, 0, "strain_step", 0);
  map.quantity = dea_result_table_quantity(scale, 0);
  map.base = dea_result_table_number(scale, 0, "level_base", 0);
  map.step = dea_result_table_number(scale, 0, "level_step", 0);
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

/* Of the first models that have it, one above the other: "map_NAME" that of a table with a label,
 * "map" those without. */
static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  const char *name = plot->name[3] == '_' ? plot->name + 4 : NULL;
  size_t shown = 0;
  for (size_t t = 0; t < result->table_count && shown < DEA_PLOT_PANELS_MAX; t++) {
    const struct dea_result_table *table = &result->tables[t];
    struct dea_panel *panel = &plot->panels[shown];
    if (strcmp(table->type.study, study_name) != 0 || table->type.name[0] == '\0' ||
        (name != NULL ? strcmp(table->type.name, name) != 0 : label_of(table) != NULL)) {
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

static const struct dea_figure figures[] = {
    DEA_STUDY_FIGURE("map_pre_stretch", study_name, build,
                     "where the actuator can be used: voltage and pre-stretch"),
    DEA_STUDY_FIGURE("map_film_thickness", study_name, build,
                     "where the actuator can be used: voltage and film thickness"),
    DEA_STUDY_FIGURE("map", study_name, build,
                     "where the actuator can be used: voltage and numbers of its design"),
};

// The study --------------------------------------------------------------------------------------

static bool able(const struct dea_model_type *type, const struct dea_result *result)
{
  return type->path != NULL || dea_design_settings(result->design, &section)->written;
}

const struct dea_study dea_study_operating_map = {.name = study_name,
                                                  .keys = &section,
                                                  .own_models = true,
                                                  .ability = "a path without compute.operating_map",
                                                  .able = able,
                                                  .refuse = refuse,
                                                  .run = run,
                                                  .figures = figures,
                                                  .figure_count = DEA_COUNT(figures)};
