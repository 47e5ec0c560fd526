/* Study "uncertainty": what the standard uncertainties of the design and of its film's material do
 * to the curves of other studies, to first order (docs/theory/fit.md, "What follows"):
 *
 *   std(q)^2 = g' C g,   g_j = dq/dp_j,   C_jk = s_j s_k rho_jk
 *
 * q    any quantity of a load point              its unit
 * p_j  a number of the design or of the law      its unit
 * s_j  its standard uncertainty                  its unit
 * rho  correlations                              1
 *
 * g by central differences over +-s_j (not less than a step that the solution can resolve), or to
 * one side where the other has no answer. */
#include "study/uncertainty.h"

#include "base/correlations.h"
#include "base/schema.h"
#include "base/units.h"
#include "base/yaml_write.h"
#include "identify/fit_head.h"
#include "result/observation.h"
#include "study/device_param.h"
#include "study/numbers.h"
#include "study/study.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static const char study_name[] = "uncertainty";

/* Studies whose curves get a band; their points stand at the same places whatever the device. */
static const char *const kinds[] = {"sweep", "force", "loading"};
enum { KINDS = DEA_COUNT(kinds) };

// Keys -------------------------------------------------------------------------------------------

enum {
  GIVEN_MAX = DEA_DEVICE_PARAMS_MAX,
  PARAMS_MAX = GIVEN_MAX + 4 * DEA_LAW_PARAM_MAX, // laws of several films
  TIES_MAX = 2 * DEA_DEVICE_TIES_MAX,             // of other plies of the same material
  PAIRS_MAX = GIVEN_MAX * (GIVEN_MAX - 1) / 2,
};

struct given {
  struct dea_label name, std; // the name first: dea_fit_names_check
};

/* Settings of compute.uncertainty. */
struct settings {
  struct given parameters[GIVEN_MAX];
  size_t parameter_count;
  struct dea_quantity correlations[PAIRS_MAX]; // (2,1), (3,1), (3,2), ...
  size_t correlation_count;                    // 0: none correlate
};

#define AT(member) offsetof(struct settings, member)

static const struct dea_field given_fields[] = {
    DEA_LABEL_ROW("name", offsetof(struct given, name), "film.thickness", DEA_DEVICE_PARAM_DOC,
                  .required = true),
    DEA_LABEL_ROW("std", offsetof(struct given, std), "2 um", "its standard uncertainty",
                  .required = true),
};

static const struct dea_field fields[] = {
    DEA_FIELD_ROW(
        RECORD, "parameters", AT(parameters), .record = DEA_ROWS(given_fields),
        .absent_text = "those of the films' laws",
        .doc =
            "what is uncertain, beside the parameters of the films' laws whose uncertainty their "
            "material gives",
        .example = "[{name: film.thickness, std: 2 um}]",
        DEA_LIST(1, GIVEN_MAX, struct given, AT(parameter_count))),
    DEA_NUMBER_ROW("correlations", AT(correlations), "1", "[-0.3]",
                   "correlations of these parameters: 2 with 1, 3 with 1, 3 with 2, ...", .min = -1,
                   .max = 1, DEA_LIST(1, PAIRS_MAX, struct dea_quantity, AT(correlation_count)),
                   .absent_text = "none"),
};

static dea_status check(struct dea_context *ctx, const struct dea_design *design,
                        const struct dea_settings *given)
{
  (void)design;
  const struct settings *settings = given->values;
  const size_t n = settings->parameter_count;
  DEA_TRY(ctx, dea_fit_names_check(ctx, settings->parameters, n, sizeof settings->parameters[0],
                                   "parameter"));
  return dea_correlations_check(ctx, settings->correlations, settings->correlation_count, n,
                                "parameter");
}

static const struct dea_design_section section = {
    .record = {study_name,
               "study of what uncertain numbers do to the curves, made of plane models where some "
               "are known, of 3d when this section is there ({})",
               fields, DEA_COUNT(fields)},
    .size = sizeof(struct settings),
    .check = check};

// What is uncertain -------------------------------------------------------------------------------

struct work {
  struct dea_context *ctx;
  struct dea_study_job job;
  struct dea_design_bytes file; // the design as it was read, with what --set changed
  struct dea_text text;         // behind it
  struct dea_device_param params[PARAMS_MAX];
  double value[PARAMS_MAX], std[PARAMS_MAX];
  char std_text[PARAMS_MAX][40]; // as written, or in SI
  double correlation[PARAMS_MAX][PARAMS_MAX];
  size_t count;
  struct dea_device_param ties[PARAMS_MAX][TIES_MAX];
  struct dea_result *plus[PARAMS_MAX], *minus[PARAMS_MAX]; // NULL: no answer there
  double step[PARAMS_MAX];
};

static dea_status add_given(struct work *w, const struct given *given, bool *good)
{
  const struct dea_device_param_source source = {.design = w->job.result->design,
                                                 .device = w->job.result->device};
  struct dea_device_param *param = &w->params[w->count];
  double std;
  DEA_TRY(w->ctx, dea_device_param_find(w->ctx, &source, &given->name, param, good));
  if (!*good) {
    return DEA_OK;
  }
  if (isnan(param->designed)) {
    *good = false;
    return dea_finding_add(w->ctx, DEA_ERROR, given->name.location,
                           "the design has no single value of %.60s", given->name.text);
  }
  DEA_TRY(w->ctx, dea_device_param_std(w->ctx, param, &given->std, &std, good));
  if (!*good) {
    return DEA_OK;
  }
  snprintf(w->std_text[w->count], sizeof w->std_text[0], "%.39s", given->std.text);
  w->value[w->count] = param->designed;
  w->std[w->count++] = std;
  return DEA_OK;
}

/* Parameters of laws that the section does not name, while they are gathered. */
struct laws {
  struct work *w;
  size_t first;          // of them in w
  size_t of[PARAMS_MAX]; // number in the law, of each of them
  bool full;
};

static bool is_number(const struct dea_device_param *param, const struct dea_design_number *number)
{
  return param->kind == DEA_DEVICE_MATERIAL && param->material == number->item &&
         param->offset == number->offset;
}

static const struct dea_material *material_of(const struct work *w, size_t j)
{
  return dea_material_of(w->job.result->device, w->params[j].material);
}

/* Plies of the same material deviate alike. Returns whether there is such a one. */
static bool tie(struct laws *laws, size_t i, const struct dea_device_param *param)
{
  struct work *w = laws->w;
  const char *name = dea_material_of(w->job.result->device, param->material)->name;
  for (size_t j = laws->first; j < w->count; j++) {
    struct dea_device_param *other = &w->params[j];
    if (laws->of[j] == i && other->designed == param->designed && name != NULL &&
        strcmp(material_of(w, j)->name, name) == 0 && other->tie_count < TIES_MAX) {
      w->ties[j][other->tie_count++] = *param;
      other->ties = w->ties[j];
      return true;
    }
  }
  return false;
}

/* number: of a material. */
static void add_law(struct laws *laws, const struct dea_design_number *number)
{
  struct work *w = laws->w;
  const struct dea_material *material = dea_material_of(w->job.result->device, number->item);
  const size_t at = offsetof(struct dea_material, param);
  const size_t i = (number->offset - at) / sizeof(double); // of one before it: no parameter
  bool wanted = material->law != NULL && number->offset >= at && i < material->law->param_count &&
                material->param_std[i] > 0;
  for (size_t j = 0; j < laws->first; j++) {
    wanted = wanted && !is_number(&w->params[j], number);
  }
  struct dea_device_param param = {.kind = DEA_DEVICE_MATERIAL,
                                   .state = "",
                                   .material = number->item,
                                   .offset = number->offset,
                                   .designed = number->value};
  param.param.unit = number->unit;
  snprintf(param.param.name, sizeof param.param.name, "%s", number->key);
  if (!wanted || tie(laws, i, &param)) {
    return;
  }
  if (w->count == PARAMS_MAX) {
    laws->full = true;
    return;
  }
  snprintf(w->std_text[w->count], sizeof w->std_text[0], "%.3g%s%.20s", material->param_std[i],
           DEA_UNIT_BEHIND(number->unit));
  laws->of[w->count] = i;
  w->params[w->count] = param;
  w->value[w->count] = number->value;
  w->std[w->count++] = material->param_std[i];
}

/* The parameters of laws that the section does not name. */
static dea_status add_laws(struct work *w)
{
  struct laws laws = {.w = w, .first = w->count};
  struct dea_design_number *numbers = dea_alloc(w->ctx, DEA_NUMBERS_MAX, sizeof *numbers);
  size_t count;
  DEA_TRY_MEMORY(numbers != NULL);
  const dea_status status = dea_design_numbers(w->ctx, w->job.result->design, w->job.result->device,
                                               NAN, true, numbers, &count);
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    if (numbers[i].of == DEA_NUMBER_OF_MATERIAL) {
      add_law(&laws, &numbers[i]);
    }
  }
  dea_free(w->ctx, numbers);
  DEA_TRY(w->ctx, status);
  for (size_t a = laws.first; a < w->count; a++) {
    for (size_t b = laws.first; b < w->count; b++) {
      const struct dea_material *material = material_of(w, a);
      w->correlation[a][b] = w->params[a].material == w->params[b].material
                                 ? material->correlation[laws.of[a]][laws.of[b]]
                                 : 0;
    }
  }
  return laws.full ? dea_finding_add(w->ctx, DEA_WARNING, (struct dea_location){0},
                                     "more than %d uncertain numbers: of the laws of the last "
                                     "plies none counts",
                                     PARAMS_MAX)
                   : DEA_OK;
}

static dea_status find_params(struct work *w, const struct settings *settings)
{
  const size_t errors = dea_finding_count(w->ctx, DEA_ERROR);
  size_t next = 0;
  for (size_t j = 0; j < settings->parameter_count; j++) {
    bool good;
    DEA_TRY(w->ctx, add_given(w, &settings->parameters[j], &good));
  }
  if (dea_finding_count(w->ctx, DEA_ERROR) > errors) {
    return dea_fail(w->ctx, DEA_E_DESIGN, "compute.uncertainty names what cannot be uncertain");
  }
  for (size_t a = 0; a < w->count; a++) {
    for (size_t b = 0; b < a && settings->correlation_count > 0; b++) {
      w->correlation[a][b] = w->correlation[b][a] = settings->correlations[next++].si;
    }
  }
  DEA_TRY(w->ctx, add_laws(w));
  for (size_t a = 0; a < w->count; a++) {
    w->correlation[a][a] = 1;
  }
  return DEA_OK;
}

// Other values ------------------------------------------------------------------------------------

/* The studies that have a band, of the device with p; *out: NULL where it cannot be built. What
 * there is of curves whose study failed counts. */
static dea_status run_changed(struct work *w, const double *p, struct dea_result **out)
{
  const char *names[KINDS];
  size_t count = 0;
  for (size_t k = 0; k < KINDS; k++) {
    const struct dea_curve *curve = dea_result_find(w->job.result, w->job.type->name, kinds[k]);
    if (curve != NULL && curve->count > 0) {
      names[count++] = kinds[k];
    }
  }
  struct dea_design *design;
  struct dea_device *device;
  *out = NULL;
  dea_status status =
      dea_device_params_build(w->ctx, &w->file, w->params, w->count, p, &design, &device);
  status = status == DEA_OK ? dea_result_create(w->ctx, design, device, out) : status;
  if (status == DEA_OK) {
    (*out)->surface_bytes_max = 0; // nobody looks at them
    status = w->job.services.run(w->ctx, w->job.type, names, count, *out);
  }
  if (*out != NULL) {
    (*out)->design = NULL; // both end here
    (*out)->device = NULL;
  }
  dea_device_destroy(w->ctx, device);
  dea_design_destroy(w->ctx, design);
  return status == DEA_E_TOOL ? status : dea_forgive(w->ctx, status);
}

static dea_status vary(struct work *w)
{
  const double least = w->job.type->load != NULL ? 5e-3 : 1e-3; // of the value
  const size_t errors = dea_finding_trial_begin(w->ctx);
  dea_status status = DEA_OK;
  for (size_t j = 0; j < w->count && status == DEA_OK; j++) {
    double p[PARAMS_MAX];
    memcpy(p, w->value, w->count * sizeof *p);
    w->step[j] = fmax(w->std[j], least * fabs(w->value[j]));
    p[j] = w->value[j] + w->step[j];
    status = run_changed(w, p, &w->plus[j]);
    p[j] = w->value[j] - w->step[j];
    status = status == DEA_OK ? run_changed(w, p, &w->minus[j]) : status;
    dea_study_progress(w->ctx, &w->job, study_name, j + 1, w->count);
  }
  dea_finding_trial_end(w->ctx, errors);
  return status;
}

// The bands ---------------------------------------------------------------------------------------

/* Places of a point, which do not change with the device, and what is no answer of it. */
static bool is_answer(const struct dea_context *ctx, int column)
{
  static const char *const keys[] = {"voltage_V",
                                     "time_s",
                                     "source_voltage_V",
                                     "tip_depth_m",
                                     "nominal_field_V_per_m",
                                     "breakdown_probability",
                                     "centre_z_error_m",
                                     "fibre_tip_z_error_m",
                                     "electrode_edge_u_error_m",
                                     "compression_ratio",
                                     "pull_in_distance_V"};
  const struct dea_column *c = dea_column_at(ctx, column);
  if (column >= DEA_LOAD_POINT_COLUMNS) { // of monitors, without errors
    return dea_observed_is(c, NULL) && !dea_observed_is(c, "voltage_V");
  }
  for (size_t k = 0; k < DEA_COUNT(keys); k++) {
    if (strcmp(c->key, keys[k]) == 0) {
      return false;
    }
  }
  return true;
}

/* The varied device at that point of a curve; NULL: it has no such point. */
static const struct dea_load_point *varied_point(const struct work *w,
                                                 const struct dea_result *result,
                                                 const struct dea_curve *curve, size_t i)
{
  const struct dea_curve *other =
      result != NULL ? dea_result_find(result, w->job.type->name, curve->kind) : NULL;
  return other == NULL || i >= other->count || dea_load_point_is_one_of_several(&other->points[i])
             ? NULL
             : &other->points[i];
}

static double varied(const struct work *w, const struct dea_result *result,
                     const struct dea_curve *curve, size_t i, int column)
{
  const struct dea_load_point *point = varied_point(w, result, curve, i);
  return point != NULL ? dea_point_get(point, column) : NAN;
}

/* dq/dp_j, NAN where there is none. */
static double slope(const struct work *w, const struct dea_curve *curve, size_t i, int column,
                    size_t j)
{
  const double own = dea_point_get(&curve->points[i], column);
  const double up = varied(w, w->plus[j], curve, i, column);
  const double down = varied(w, w->minus[j], curve, i, column);
  if (!isnan(up) && !isnan(down)) {
    return (up - down) / (2 * w->step[j]);
  }
  return isnan(up) ? (own - down) / w->step[j] : (up - own) / w->step[j];
}

static double std_of(const struct work *w, const struct dea_curve *curve, size_t i, int column)
{
  double change[PARAMS_MAX], variance = 0;
  for (size_t j = 0; j < w->count; j++) {
    change[j] = slope(w, curve, i, column, j) * w->std[j];
  }
  for (size_t a = 0; a < w->count; a++) {
    for (size_t b = 0; b < w->count; b++) {
      variance += change[a] * w->correlation[a][b] * change[b];
    }
  }
  return isnan(variance) ? NAN : sqrt(fmax(0, variance));
}

static dea_status fill_curve(struct work *w, struct dea_curve *curve)
{
  struct dea_load_point *std = dea_alloc(w->ctx, curve->count, sizeof *std);
  DEA_TRY_MEMORY(std != NULL);
  for (size_t i = 0; i < curve->count; i++) {
    std[i] = dea_load_point_empty();
    std[i].monitors = dea_monitor_values_copy(&curve->memory, curve->points[i].monitors);
    for (int c = 0; c < dea_column_count(w->ctx); c++) {
      const bool has = is_answer(w->ctx, c) && !dea_load_point_is_one_of_several(&curve->points[i]);
      dea_point_set(&std[i], c, has ? std_of(w, curve, i, c) : NAN);
    }
  }
  dea_free(w->ctx, curve->std);
  curve->std = std;
  return dea_arena_status(&curve->memory);
}

static dea_status fill_bands(struct work *w)
{
  for (size_t k = 0; k < KINDS; k++) {
    const struct dea_curve *curve = dea_result_find(w->job.result, w->job.type->name, kinds[k]);
    if (curve != NULL && curve->count > 0) {
      DEA_TRY(w->ctx, fill_curve(w, &w->job.result->curves[curve - w->job.result->curves]));
    }
  }
  return DEA_OK;
}

/* Voltage of the first point of the sweep that has a band and where a varied device has no such
 * state; NAN: there is none. */
static double ends_at(const struct work *w, const struct dea_result *varied)
{
  const struct dea_curve *sweep = dea_result_find(w->job.result, w->job.type->name, "sweep");
  for (size_t i = 0; sweep != NULL && i < sweep->count; i++) {
    if (!dea_load_point_is_one_of_several(&sweep->points[i]) &&
        varied_point(w, varied, sweep, i) == NULL) {
      return sweep->points[i].voltage_V;
    }
  }
  return NAN;
}

/* Says where bands are of one side only, as the device on the other side has come to its end. */
static dea_status report_sides(struct work *w)
{
  for (size_t j = 0; j < w->count; j++) {
    for (int side = -1; side <= 1; side += 2) {
      const double at_V = ends_at(w, side < 0 ? w->minus[j] : w->plus[j]);
      char text[80];
      if (isnan(at_V)) {
        continue;
      }
      dea_device_param_show(&w->params[j], w->value[j] + side * w->step[j], text);
      DEA_TRY(w->ctx,
              dea_finding_add(w->ctx, DEA_WARNING, (struct dea_location){0},
                              "model %s: from %.6g kV on a film with %s %s has no such "
                              "state; bands there are those of the other side",
                              w->job.type->name, 1e-3 * at_V, w->params[j].param.name, text));
    }
  }
  return DEA_OK;
}

// Table -------------------------------------------------------------------------------------------

/* What one standard uncertainty of each does, at the last point that has a band. */
static const struct dea_result_column effect_columns[] = {
    DEA_RESULT_COLUMN(QUANTITY, "quantity", "quantity",
                      .meaning =
                          "that is changed: of the sweep; the force at the end of its study"),
    DEA_KV("voltage_V", "V", "voltage of the change"),
    DEA_TEXT_COLUMN("parameter", "uncertain",
                    "number of the design or of a film's law; all: of all together"),
    DEA_TEXT_COLUMN("std", "std", "its standard uncertainty"),
    DEA_RESULT_COLUMN(VALUE, "change", "change", .meaning = "of the quantity by one std"),
};
static const struct dea_result_table_type effect_table = DEA_RESULT_TABLE(
    study_name, "effects", effect_columns, .title = "what one standard uncertainty changes",
    .where = DEA_IN_JSON | DEA_IN_CSV | DEA_IN_SCREEN);

/* Last point of a curve that has a band in that column; SIZE_MAX: none, or no such curve. */
static size_t last_with_band(const struct dea_curve *curve, int column)
{
  size_t last = SIZE_MAX;
  for (size_t i = 0; curve != NULL && curve->std != NULL && i < curve->count; i++) {
    last = isnan(dea_point_get(&curve->std[i], column)) ? last : i;
  }
  return last;
}

/* Change of a column by one std of parameter j, or with j = count the std of all. */
static double effect(const struct work *w, const struct dea_curve *curve, size_t i, int column,
                     size_t j)
{
  return j < w->count ? slope(w, curve, i, column, j) * w->std[j]
                      : dea_point_get(&curve->std[i], column);
}

/* Rows of a quantity where it has a band that is more than none. */
static dea_status add_effects(struct work *w, const struct dea_curve *curve, int column,
                              struct dea_result_table *table)
{
  const size_t i = last_with_band(curve, column);
  const bool shown = i < SIZE_MAX && dea_point_get(&curve->std[i], column) > 0;
  for (size_t j = 0; shown && j <= w->count; j++) {
    const bool all = j == w->count;
    DEA_TRY(w->ctx,
            DEA_TABLE_ADD(w->ctx, table, DEA_CELL(column), DEA_CELL(curve->points[i].voltage_V),
                          DEA_TEXT_CELL(all ? "all" : w->params[j].param.name),
                          DEA_TEXT_CELL(all ? "" : w->std_text[j]),
                          DEA_CELL(effect(w, curve, i, column, j))));
  }
  return DEA_OK;
}

static dea_status add_table(struct work *w)
{
  static const char *const keys[] = {"electrode_stretch", "fibre_tip_z_m", "centre_z_m",
                                     "true_field_V_per_m"};
  enum { HEADLINES_MAX = 16 };
  const struct dea_curve *sweep = dea_result_find(w->job.result, w->job.type->name, "sweep");
  const struct dea_curve *force = dea_result_find(w->job.result, w->job.type->name, "force");
  struct dea_result_table *table;
  int columns[HEADLINES_MAX];
  DEA_TRY(w->ctx,
          dea_result_add_table(w->ctx, w->job.result, &effect_table, w->job.type->name, 0, &table));
  for (size_t k = 0; k < DEA_COUNT(keys); k++) {
    DEA_TRY(w->ctx, add_effects(w, sweep, dea_point_column_find(keys[k]), table));
  }
  const size_t count =
      sweep != NULL ? dea_curve_headlines(w->ctx, sweep, columns, HEADLINES_MAX) : 0;
  for (size_t k = 0; k < count; k++) {
    DEA_TRY(w->ctx, add_effects(w, sweep, columns[k], table));
  }
  force = force != NULL ? force : dea_result_find(w->job.result, w->job.type->name, "loading");
  return add_effects(w, force, dea_point_column_find("force_N"), table);
}

// The study ---------------------------------------------------------------------------------------

static dea_status find_all(struct work *w, const struct dea_settings *given)
{
  struct dea_context *ctx = w->ctx;
  if (w->job.services.run == NULL) { // the caller lends none for changed designs
    return DEA_OK;
  }
  DEA_TRY(ctx, find_params(w, given->values));
  if (w->count == 0) {
    return given->written ? dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                            "nothing is known to be uncertain: no bands")
                          : DEA_OK;
  }
  if (w->job.type->load != NULL && !given->written) {
    return dea_finding_add(
        ctx, DEA_NOTE, (struct dea_location){0},
        "the films' laws have uncertainties: compute.uncertainty ({}) makes bands "
        "of model %s too, by two runs more for each of %zu",
        w->job.type->name, w->count);
  }
  dea_yaml_write(dea_yaml_root(w->job.result->design->document), &w->text);
  DEA_TRY_MEMORY(!w->text.failed);
  w->file =
      (struct dea_design_bytes){w->job.result->design, dea_text_get(&w->text), w->text.length};
  DEA_TRY(ctx, vary(w));
  DEA_TRY(ctx, fill_bands(w));
  DEA_TRY(ctx, report_sides(w));
  return add_table(w);
}

dea_status dea_uncertainty_check(struct dea_context *ctx, const struct dea_design *design,
                                 const struct dea_device *device)
{
  const struct dea_settings *given = dea_design_settings(design, &section);
  if (given == NULL || !given->written) {
    return DEA_OK;
  }
  struct work *w = dea_alloc(ctx, 1, sizeof *w);
  DEA_TRY_MEMORY(w != NULL);
  struct dea_result nothing = {.design = design, .device = device};
  *w = (struct work){.ctx = ctx, .job = {.result = &nothing}};
  dea_status status = find_params(w, given->values);
  dea_free(ctx, w);
  return status;
}

static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  struct work *w = dea_alloc(ctx, 1, sizeof *w);
  DEA_TRY_MEMORY(w != NULL);
  *w = (struct work){.ctx = ctx, .job = *job, .text = {.ctx = ctx}};
  dea_status status = find_all(w, dea_design_settings(job->result->design, &section));
  for (size_t j = 0; j < w->count; j++) {
    dea_result_destroy(ctx, w->plus[j]);
    dea_result_destroy(ctx, w->minus[j]);
  }
  dea_text_free(&w->text);
  dea_free(ctx, w);
  return status;
}

/* Also without the section: a film's law may have uncertainties. */
static bool asked(const struct dea_design *design)
{
  (void)design;
  return true;
}

const struct dea_study dea_study_uncertainty = {
    .name = study_name, .keys = &section, .asked = asked, .own_models = true, .run = run};
