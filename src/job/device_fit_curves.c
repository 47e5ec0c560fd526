/* Measured curves of a device, and the points of the model that they ask for. */
#include "job/device_evaluation.h"

#include "base/file.h"
#include "base/sort.h"
#include "base/units.h"
#include "base/write_file.h"
#include "compare/measured.h"
#include "io/csv.h"
#include "result/provenance.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct reading {
  struct dea_context *ctx;
  struct dea_device_fit *fit;
  const struct dea_device_curve_text *text;
  const struct dea_measurement *table;
  int columns[DEA_DEVICE_QUANTITIES_MAX]; // of the quantities that are wanted
  char sha256[65];
};

/* Columns of the quantities that are wanted; what is none of the file is a finding. */
static dea_status find_quantities(struct reading *r)
{
  for (size_t k = 0; k < r->text->quantity_count; k++) {
    const struct dea_label *label = &r->text->quantities[k];
    const int column = r->columns[k] = dea_column_find(r->ctx, label->text);
    if (column < 0) {
      char hint[DEA_HINT_SIZE];
      DEA_TRY(r->ctx, dea_column_hint(r->ctx, label->text, NULL, hint));
      DEA_TRY(r->ctx, dea_finding_add(r->ctx, DEA_ERROR, label->location,
                                      "'%.60s' is not a quantity%s", label->text, hint));
    } else if (!dea_points_have(r->table->curve.points, r->table->curve.count, column)) {
      DEA_TRY(r->ctx, dea_finding_add(r->ctx, DEA_ERROR, label->location, "'%.80s' has no %s",
                                      r->table->file, label->text));
    }
  }
  return DEA_OK;
}

static bool says_std(const struct dea_device_curve_text *text)
{
  return text->relative.origin != DEA_ABSENT || text->absolute.text[0] != '\0';
}

/* Standard uncertainty of a value: its column's, or what the fit file says. */
static dea_status read_std(struct reading *r, const struct dea_device_curve *curve, double absolute,
                           double given, size_t line, double value, double *out)
{
  const struct dea_device_curve_text *text = r->text;
  const double share = isnan(text->relative.si) ? 0 : text->relative.si;
  *out = !isnan(given) ? given : says_std(text) ? hypot(share * value, absolute) : NAN;
  if (*out <= 0) {
    const struct dea_location location = {curve->file, line, 1};
    return dea_finding_add(r->ctx, DEA_ERROR, location,
                           "the uncertainty of %s is %g here: it has to be above 0 "
                           "(uncertainty_absolute)",
                           curve->quantity->key, *out);
  }
  return DEA_OK;
}

/* The absolute uncertainty in SI, 0 without. */
static dea_status read_absolute(struct reading *r, int column, double *out)
{
  const struct dea_label *label = &r->text->absolute;
  const struct dea_column *of = dea_column_at(r->ctx, column);
  char why[DEA_WHY_SIZE] = "", example[32];
  snprintf(example, sizeof example, "2%s%s", DEA_UNIT_BEHIND(of->display_unit));
  *out = 0;
  if (label->text[0] == '\0' ||
      dea_units_read(r->ctx, label->text, (struct dea_measure){of->si_unit, example}, out, why)) {
    return DEA_OK;
  }
  return why[0] == '\0'
             ? dea_context_status(r->ctx)
             : dea_finding_add(r->ctx, DEA_ERROR, label->location, "%s: %s", of->key, why);
}

static dea_status add_curve(struct reading *r, int column)
{
  struct dea_device_fit *fit = r->fit;
  const struct dea_curve *from = &r->table->curve;
  double absolute;
  bool std_given = false;
  if (fit->curve_count == DEA_DEVICE_CURVES_MAX) {
    return dea_fail(r->ctx, DEA_E_UNSUPPORTED, "more than %d measured curves",
                    DEA_DEVICE_CURVES_MAX);
  }
  struct dea_device_curve *curve = &fit->curves[fit->curve_count++];
  *curve = (struct dea_device_curve){.text = r->text,
                                     .file = r->table->file,
                                     .column = column,
                                     .quantity = dea_column_at(r->ctx, column),
                                     .lag = NAN,
                                     .effective = NAN};
  memcpy(curve->sha256, r->sha256, sizeof curve->sha256);
  double **arrays[] = {&curve->voltage_V, &curve->time_s, &curve->depth_m,   &curve->value,
                       &curve->std,       &curve->model,  &curve->model_std, &curve->designed};
  for (size_t k = 0; k < sizeof arrays / sizeof arrays[0]; k++) {
    *arrays[k] = dea_arena_alloc(&fit->memory, from->count, sizeof(double));
  }
  curve->line = dea_arena_alloc(&fit->memory, from->count, sizeof *curve->line);
  curve->stop = dea_arena_alloc(&fit->memory, from->count, sizeof *curve->stop);
  curve->used = dea_arena_alloc(&fit->memory, from->count, sizeof *curve->used);
  DEA_TRY(r->ctx, dea_arena_status(&fit->memory));
  DEA_TRY(r->ctx, read_absolute(r, column, &absolute));
  for (size_t i = 0; i < from->count; i++) {
    const double value = dea_point_get(&from->points[i], column);
    const size_t n = curve->rows;
    if (isnan(value)) {
      continue;
    }
    curve->line[n] = r->table->line[i];
    curve->voltage_V[n] = from->points[i].voltage_V;
    curve->time_s[n] = from->points[i].time_s;
    curve->depth_m[n] = from->points[i].tip_depth_m;
    if (dea_device_curve_in_time(curve) && isnan(curve->time_s[n])) {
      const struct dea_location location = {curve->file, r->table->line[i], 1};
      return dea_finding_add(
          r->ctx, DEA_ERROR, location,
          "no time: a transient needs a column 'time (s)', from the start of the "
          "waveform");
    }
    curve->value[n] = value;
    const double given = dea_point_get(&r->table->std[i], column);
    DEA_TRY(r->ctx, read_std(r, curve, absolute, given, curve->line[n], value, &curve->std[n]));
    std_given = std_given || !isnan(given);
    curve->rows++;
  }
  const struct dea_device_curve_text *text = r->text;
  const bool share = text->relative.origin != DEA_ABSENT;
  return !std_given || !says_std(text)
             ? DEA_OK
             : dea_finding_add(r->ctx, DEA_WARNING,
                               share ? text->relative.location : text->absolute.location,
                               "%s of '%.80s' has a column of uncertainties: where it says one, "
                               "that counts",
                               curve->quantity->key, curve->file);
}

static dea_status read_table(struct reading *r, const char *path)
{
  struct dea_measurement *table;
  dea_sha256_file(path, r->sha256);
  DEA_TRY(r->ctx, dea_measurement_read(r->ctx, path, &table));
  r->table = table;
  const bool in_time = r->text->kind.value == DEA_DEVICE_TRANSIENT; // has the waveform's voltage
  dea_status status = in_time ? DEA_OK : dea_measurement_fold(r->ctx, table);
  status = status == DEA_OK ? find_quantities(r) : status;
  size_t taken = 0;
  for (int c = 0; c < dea_column_count(r->ctx) && status == DEA_OK; c++) {
    const bool axis = c == dea_point_column_find("voltage_V") ||
                      c == dea_point_column_find("time_s") ||
                      c == dea_point_column_find("tip_depth_m");
    if (!axis && dea_column_is_wanted(c, r->columns, r->text->quantity_count) &&
        dea_points_have(table->curve.points, table->curve.count, c)) {
      status = add_curve(r, c);
      taken++;
    }
  }
  if (status == DEA_OK && taken == 0 && r->text->quantity_count == 0) {
    status = dea_finding_add(r->ctx, DEA_ERROR, r->text->file.location,
                             "'%.80s' has no quantity beside the voltage", table->file);
  }
  if (status == DEA_OK && taken > 1 && r->text->absolute.text[0] != '\0') {
    status = dea_finding_add(r->ctx, DEA_ERROR, r->text->absolute.location,
                             "'%.60s' has %zu quantities: an absolute uncertainty is that of one "
                             "(quantities)",
                             r->text->name.text, taken);
  }
  dea_measurement_destroy(r->ctx, table);
  r->table = NULL;
  return status;
}

/* Reads a table, or of a folder of dea reduce the one with the uncertainties of means where it has
 * that. */
static dea_status read_path(struct reading *r, const char *path)
{
  if (!dea_path_is_folder(path)) {
    return read_table(r, path);
  }
  char table[DEA_PATH_SIZE];
  const char *name = dea_folder_has(path, "means.csv") ? "means.csv" : "measurement.csv";
  DEA_TRY(r->ctx, dea_path_build(r->ctx, path, name, table));
  return read_table(r, table);
}

dea_status dea_device_curves_read(struct dea_context *ctx, struct dea_device_fit *fit)
{
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  dea_status worst = DEA_OK;
  for (size_t k = 0; k < fit->file->curve_count; k++) { // all of them, for all that is wrong
    struct reading r = {.ctx = ctx, .fit = fit, .text = &fit->file->curves[k]};
    char *path = dea_path_beside(ctx, fit->file->head.file, r.text->file.text);
    dea_status status = path != NULL ? read_path(&r, path) : DEA_E_MEMORY;
    worst = status != DEA_OK ? status : worst;
    dea_free(ctx, path);
  }
  DEA_TRY(ctx, worst);
  return dea_finding_count(ctx, DEA_ERROR) == errors
             ? DEA_OK
             : dea_fail(ctx, DEA_E_DESIGN, "the curves of '%s' have errors", fit->file->head.file);
}

// Points of the model -----------------------------------------------------------------------------

static bool is_held(const struct dea_device_curve *curve)
{
  return curve->text->kind.value == DEA_DEVICE_FORCE;
}

/* The group that a row belongs to, a new one where there is none; NULL: there are too many. */
static struct dea_device_group *find_group(struct dea_device_model *model,
                                           const struct dea_device_curve *curve, size_t i)
{
  const bool deep = is_held(curve) && !isnan(curve->depth_m[i]);
  const struct dea_device_group wanted = {.held = is_held(curve),
                                          .in_time = dea_device_curve_in_time(curve),
                                          .depth_m = deep ? curve->depth_m[i] : 0};
  for (size_t g = 0; g < model->group_count; g++) {
    const struct dea_device_group *group = &model->groups[g];
    if (group->held == wanted.held && group->in_time == wanted.in_time &&
        group->depth_m == wanted.depth_m) {
      return &model->groups[g];
    }
  }
  if (model->group_count == DEA_DEVICE_GROUPS_MAX) {
    return NULL;
  }
  model->groups[model->group_count] = wanted;
  return &model->groups[model->group_count++];
}

/* Where a row stands in its group: a voltage, or a time. */
static double place_of(const struct dea_device_curve *curve, size_t i)
{
  return dea_device_curve_in_time(curve) ? curve->time_s[i] : curve->voltage_V[i];
}

/* Voltages, or times, of one group, sorted, each once, at the end of model->voltage_V. */
static void add_stops(const struct dea_device_fit *fit, struct dea_device_model *model,
                      struct dea_device_group *group)
{
  double *to = model->voltage_V + model->stop_count;
  size_t n = 0, kept = 0;
  for (size_t c = 0; c < fit->curve_count; c++) {
    const struct dea_device_curve *curve = &fit->curves[c];
    for (size_t i = 0; i < curve->rows; i++) {
      if (find_group(model, curve, i) == group) {
        to[n++] = place_of(curve, i);
      }
    }
  }
  qsort(to, n, sizeof *to, dea_rising);
  for (size_t i = 0; i < n; i++) {
    if (kept == 0 || to[i] != to[kept - 1]) {
      to[kept++] = to[i];
    }
  }
  group->first = model->stop_count;
  group->count = kept;
  model->stop_count += kept;
}

static size_t stop_of(const struct dea_device_model *model, const struct dea_device_group *group,
                      double place)
{
  size_t k = group->first;
  while (model->voltage_V[k] != place) {
    k++;
  }
  return k;
}

dea_status dea_device_stops_build(struct dea_context *ctx, struct dea_device_fit *fit,
                                  struct dea_device_model *model)
{
  size_t rows = 0;
  for (size_t c = 0; c < fit->curve_count; c++) {
    rows += fit->curves[c].rows;
    for (size_t i = 0; i < fit->curves[c].rows; i++) {
      const struct dea_device_curve *curve = &fit->curves[c];
      if (find_group(model, curve, i) == NULL) {
        return dea_fail(ctx, DEA_E_UNSUPPORTED, "more than %d depths of a tip",
                        DEA_DEVICE_GROUPS_MAX);
      }
    }
  }
  model->voltage_V = dea_arena_alloc(&fit->memory, rows, sizeof *model->voltage_V);
  model->wanted = dea_arena_alloc(&fit->memory, rows, sizeof *model->wanted);
  DEA_TRY(ctx, dea_arena_status(&fit->memory));
  for (size_t g = 0; g < model->group_count; g++) {
    add_stops(fit, model, &model->groups[g]);
  }
  for (size_t c = 0; c < fit->curve_count; c++) {
    struct dea_device_curve *curve = &fit->curves[c];
    for (size_t i = 0; i < curve->rows; i++) {
      const struct dea_device_group *group = find_group(model, curve, i);
      curve->stop[i] = stop_of(model, group, place_of(curve, i));
    }
  }
  return DEA_OK;
}
