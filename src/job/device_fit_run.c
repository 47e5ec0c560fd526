#include "job/device_fit_run.h"

#include "base/file.h"
#include "base/yaml_write.h"
#include "job/device_evaluation.h"
#include "result/observation.h"
#include "result/provenance.h"
#include "study/design_file.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { ROUNDS_MAX = 4 };

static const double scatter_guess =
    0.01; // of the largest value: a scale, where no scatter is given

struct work {
  struct dea_context *ctx;
  struct dea_device_fit *fit;
  bool profiles; // of all parameters
  struct dea_design *design;
  struct dea_device *device;
  char *path, *bytes; // of the design
  char *fine;         // the same for curves in time; NULL: there are none
  size_t length;
  struct dea_device_model model;
  double start[DEA_DEVICE_PARAMS_MAX];
  bool *slack;                     // [stops]
  bool *wanted;                    // [stops], for dea_device_model_want
  struct dea_load_point *designed; // [stops] of the design itself; NULL: it has none
  bool starts_designed;
  struct dea_lsq_problem problem;
};

static bool is_fitted(const struct dea_device_curve *curve)
{
  return curve->text->use.value == DEA_FIT_USED;
}

static double value_of(const struct dea_load_point *points, const struct dea_device_curve *curve,
                       size_t i)
{
  return dea_point_get(&points[curve->stop[i]], curve->column);
}

// What is asked -----------------------------------------------------------------------------------

static dea_status find_model(struct work *w)
{
  const struct dea_label *name = &w->fit->file->model;
  DEA_TRY(w->ctx, dea_model_seek(w->ctx, name->text, name->location, &w->model.type));
  if (w->model.type == NULL) {
    return dea_fail(w->ctx, DEA_E_DESIGN, "there is no model '%.60s'", name->text);
  }
  w->fit->model = w->model.type->name;
  return DEA_OK;
}

static dea_status read_design(struct work *w)
{
  const struct dea_device_file *file = w->fit->file;
  w->path = dea_path_beside(w->ctx, file->head.file, file->design.text);
  DEA_TRY_MEMORY(w->path != NULL);
  DEA_TRY(w->ctx, dea_file_read(w->ctx, w->path, DEA_YAML_SIZE_MAX, &w->bytes, &w->length));
  w->fit->design_file = dea_intern(w->ctx, w->path);
  DEA_TRY_MEMORY(w->fit->design_file != NULL);
  dea_sha256_hex(w->bytes, w->length, w->fit->design_sha256);
  DEA_TRY(w->ctx,
          dea_design_read_memory(w->ctx, w->path, w->bytes, w->length, NULL, 0, &w->design));
  DEA_TRY(w->ctx, dea_device_build(w->ctx, w->design, &w->device));
  DEA_TRY(w->ctx, dea_device_columns_add(w->ctx, w->device));
  w->model.observed = dea_device_is_observed(w->device);
  w->model.ctx = w->ctx;
  w->model.file = (struct dea_design_bytes){w->design, w->bytes, w->length};
  return DEA_OK;
}

static dea_status build_params(struct work *w)
{
  struct dea_device_fit *fit = w->fit;
  const size_t errors = dea_finding_count(w->ctx, DEA_ERROR);
  const struct dea_device_param_source source = {.design = w->design, .device = w->device};
  fit->param_count = fit->core.param_count = fit->file->parameter_count;
  for (size_t j = 0; j < fit->param_count; j++) {
    DEA_TRY(w->ctx,
            dea_device_param_build(w->ctx, &fit->file->parameters[j], &source, &fit->params[j]));
    fit->core.params[j] = fit->params[j].param;
    w->start[j] = fit->core.params[j].start;
  }
  w->model.params = fit->params;
  w->model.param_count = fit->param_count;
  return dea_finding_count(w->ctx, DEA_ERROR) == errors
             ? DEA_OK
             : dea_fail(w->ctx, DEA_E_DESIGN, "the parameters of '%s' have errors",
                        fit->file->head.file);
}

/* In time every step is kept, and short enough for derivatives by differences. */
static dea_status build_fine(struct work *w)
{
  static const char *const keys[][2] = {{"compute.transient.interval", "1e-12 s"},
                                        {"compute.transient.tolerance", "1e-6"}};
  struct dea_yaml *document;
  struct dea_text text = {.ctx = w->ctx};
  DEA_TRY(w->ctx, dea_yaml_parse(w->ctx, w->path, w->bytes, w->length, &document));
  dea_status status = DEA_OK;
  for (size_t k = 0; k < 2 && status == DEA_OK; k++) {
    status = dea_yaml_override(w->ctx, document, keys[k][0], keys[k][1]);
  }
  if (status == DEA_OK) {
    dea_yaml_write(dea_yaml_root(document), &text);
    w->fine = text.failed ? NULL : dea_copy_text(w->ctx, dea_text_get(&text), SIZE_MAX);
    status = w->fine != NULL ? DEA_OK : DEA_E_MEMORY;
  }
  dea_text_free(&text);
  dea_yaml_destroy(w->ctx, document);
  if (status == DEA_OK) {
    w->model.file.bytes = w->fine;
    w->model.file.length = strlen(w->fine);
  }
  return status;
}

/* Curves in time want a waveform, and a model that knows time; those with a tip one that can hold
 * it. */
static dea_status check_kinds(struct work *w)
{
  bool in_time = false;
  for (size_t c = 0; c < w->fit->curve_count; c++) {
    const struct dea_choice *kind = &w->fit->curves[c].text->kind;
    const bool timed = kind->value == DEA_DEVICE_TRANSIENT;
    const bool plays_nothing = timed && w->design->drive.waveform == NULL;
    const char *lacks = timed && w->model.type->advance == NULL ? "transients"
                        : kind->value == DEA_DEVICE_FORCE && w->model.type->indent == NULL
                            ? "a tip that is held"
                            : NULL;
    if (plays_nothing || lacks != NULL) {
      DEA_TRY(w->ctx,
              plays_nothing
                  ? dea_finding_add(w->ctx, DEA_ERROR, kind->location,
                                    "the design plays nothing: it needs drive.waveform")
                  : dea_finding_add(w->ctx, DEA_ERROR, kind->location,
                                    "the model %s does not support %s", w->fit->model, lacks));
      return dea_fail(w->ctx, DEA_E_DESIGN, "the model and the curves do not go together");
    }
    in_time = in_time || timed;
  }
  return in_time ? build_fine(w) : DEA_OK;
}

/* Whether all fitted rows have uncertainties, or none and all are of one quantity. */
static dea_status check_uncertainties(struct work *w)
{
  struct dea_device_fit *fit = w->fit;
  const struct dea_device_curve *first = NULL, *lacking = NULL;
  bool known = false, several = false;
  double most = 0;
  for (size_t c = 0; c < fit->curve_count; c++) {
    const struct dea_device_curve *curve = &fit->curves[c];
    for (size_t i = 0; i < curve->rows && is_fitted(curve); i++) {
      lacking = isnan(curve->std[i]) ? curve : lacking;
      known = known || !isnan(curve->std[i]);
      several = several || (first != NULL && first->column != curve->column);
      first = first != NULL ? first : curve;
      most = fmax(most, fabs(curve->value[i]));
    }
  }
  if (first == NULL) {
    return dea_fail(w->ctx, DEA_E_DESIGN, "no curve is there to be fitted (use: fit)");
  }
  fit->core.scale_known = lacking == NULL;
  fit->core.scatter = scatter_guess * (most > 0 ? most : 1);
  if (lacking != NULL && (known || several)) {
    DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_ERROR, lacking->text->name.location,
                                    "%s of '%.60s' has no uncertainty: %s", lacking->quantity->key,
                                    lacking->text->name.text,
                                    known ? "others have one, so give it one too"
                                          : "several quantities can only be weighed by theirs"));
    return dea_fail(w->ctx, DEA_E_DESIGN, "the curves cannot be weighed");
  }
  return DEA_OK;
}

// Residuals ---------------------------------------------------------------------------------------

static dea_status residual(void *user, const double *p, double *r)
{
  struct work *w = user;
  const struct dea_device_fit *fit = w->fit;
  const struct dea_load_point *points;
  size_t n = 0;
  DEA_TRY_STATUS(dea_device_model_points(&w->model, p, &points));
  for (size_t c = 0; c < fit->curve_count; c++) {
    const struct dea_device_curve *curve = &fit->curves[c];
    for (size_t i = 0; i < curve->rows; i++) {
      if (curve->used[i]) {
        const double std = isnan(curve->std[i]) ? fit->core.scatter : curve->std[i];
        r[n] = (value_of(points, curve, i) - curve->value[i]) / std;
        if (isnan(r[n++])) {
          return DEA_E_DOMAIN;
        }
      }
    }
  }
  dea_fit_priors_add(fit->core.params, fit->param_count, p, r + n);
  return DEA_OK;
}

/* Rows of a curve that are fitted. */
static size_t count_used(const struct dea_device_curve *curve)
{
  size_t rows = 0;
  for (size_t i = 0; i < curve->rows; i++) {
    rows += curve->used[i] ? 1U : 0U;
  }
  return rows;
}

static void build_problem(struct work *w)
{
  const bool meshed = w->model.type->load != NULL;
  struct dea_fit_core *core = &w->fit->core;
  size_t rows = 0;
  core->group_count = 0;
  for (size_t c = 0; c < w->fit->curve_count; c++) {
    const size_t used = count_used(&w->fit->curves[c]);
    if (used > 0) {
      core->groups[core->group_count++] = (struct dea_lsq_group){rows, used};
    }
    rows += used;
  }
  rows += dea_fit_priors_add(core->params, core->param_count, NULL, NULL);
  w->problem = (struct dea_lsq_problem){.rows = rows,
                                        .params = core->param_count,
                                        .param = core->params,
                                        .step = meshed ? 5e-3 : 1e-3,
                                        .second_order = true,
                                        .tolerance = meshed ? 1e-5 : 1e-10,
                                        .residual = residual,
                                        .user = w};
}

/* Stops at which the film is slack. What was not computed follows slack stops; at the start only
 * where it really does. */
static void find_slack(const struct work *w, const struct dea_load_point *points, bool at_start,
                       bool *slack)
{
  for (size_t g = 0; g < w->model.group_count; g++) {
    const struct dea_device_group *group = &w->model.groups[g];
    for (size_t k = group->first; k < group->first + group->count; k++) {
      const bool missing = isnan(points[k].voltage_V);
      slack[k] = missing ? !at_start || (k > group->first && slack[k - 1])
                         : points[k].min_tension_N_per_m <= 0; // of a membrane 0 itself
    }
  }
}

/* Has the rows count at whose stops the film is not slack, and these stops be computed. */
static void cut_slack(struct work *w)
{
  memset(w->wanted, 0, w->model.stop_count * sizeof *w->wanted);
  for (size_t c = 0; c < w->fit->curve_count; c++) {
    struct dea_device_curve *curve = &w->fit->curves[c];
    curve->slack = 0;
    curve->slack_from_V = INFINITY;
    for (size_t i = 0; i < curve->rows; i++) {
      const bool slack = w->slack[curve->stop[i]];
      curve->used[i] = is_fitted(curve) && !slack;
      curve->slack += slack ? 1U : 0U;
      if (slack && fabs(curve->voltage_V[i]) < fabs(curve->slack_from_V)) {
        curve->slack_from_V = curve->voltage_V[i];
      }
      w->wanted[curve->stop[i]] = w->wanted[curve->stop[i]] || !slack;
    }
  }
  dea_device_model_want(&w->model, w->wanted);
}

/* Whether cut_slack would have other rows count than those that do. */
static bool cuts_others(const struct work *w)
{
  for (size_t c = 0; c < w->fit->curve_count; c++) {
    const struct dea_device_curve *curve = &w->fit->curves[c];
    for (size_t i = 0; i < curve->rows && is_fitted(curve); i++) {
      if (curve->used[i] == w->slack[curve->stop[i]]) {
        return true;
      }
    }
  }
  return false;
}

// The start ---------------------------------------------------------------------------------------

/* The design's own answer, where it has values for all parameters. */
static dea_status keep_designed(struct work *w)
{
  double p[DEA_DEVICE_PARAMS_MAX];
  bool whole = true;
  for (size_t j = 0; j < w->fit->param_count; j++) {
    p[j] = w->fit->params[j].designed;
    whole = whole && !isnan(p[j]);
  }
  struct dea_load_point *points =
      dea_arena_alloc(&w->fit->memory, w->model.stop_count, sizeof *points);
  DEA_TRY(w->ctx, dea_arena_status(&w->fit->memory));
  dea_status status = whole ? dea_device_model_sweep(&w->model, NULL, p, points) : DEA_E_DOMAIN;
  DEA_TRY(w->ctx, status == DEA_E_DOMAIN ? DEA_OK : status);
  w->designed = status == DEA_OK ? points : NULL;
  w->starts_designed =
      status == DEA_OK && memcmp(p, w->start, w->fit->param_count * sizeof *p) == 0;
  for (size_t c = 0; c < w->fit->curve_count; c++) {
    struct dea_device_curve *curve = &w->fit->curves[c];
    for (size_t i = 0; i < curve->rows; i++) {
      curve->designed[i] = w->designed != NULL ? value_of(points, curve, i) : NAN;
    }
  }
  return DEA_OK;
}

/* Quantities that the model does not have, and rows that it cannot reach. */
static dea_status check_start(struct work *w, const struct dea_load_point *points)
{
  const size_t errors = dea_finding_count(w->ctx, DEA_ERROR);
  for (size_t c = 0; c < w->fit->curve_count; c++) {
    const struct dea_device_curve *curve = &w->fit->curves[c];
    size_t missing = curve->rows, known = 0, solved = 0;
    for (size_t i = 0; i < curve->rows; i++) {
      solved += isnan(points[curve->stop[i]].voltage_V) ? 0U : 1U;
      known += isnan(value_of(points, curve, i)) ? 0U : 1U;
      missing = missing == curve->rows && curve->used[i] && isnan(value_of(points, curve, i))
                    ? i
                    : missing;
    }
    if (solved > 0 && known == 0) {
      DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_ERROR, curve->text->name.location,
                                      "the model %s does not know %s, a quantity of '%.80s'",
                                      w->fit->model, curve->quantity->key, curve->file));
    } else if (missing < curve->rows) {
      const struct dea_location location = {curve->file, curve->line[missing], 1};
      DEA_TRY(w->ctx,
              dea_finding_add(w->ctx, DEA_ERROR, location,
                              "the model %s has no point at %.4g kV where the search begins (%s); "
                              "begin elsewhere (start), or leave the row out",
                              w->fit->model, 1e-3 * curve->voltage_V[missing], w->model.why));
    }
  }
  return dea_finding_count(w->ctx, DEA_ERROR) == errors
             ? DEA_OK
             : dea_fail(w->ctx, DEA_E_DESIGN, "the model and the curves do not go together");
}

static dea_status check_count(struct work *w)
{
  size_t open = 0;
  for (size_t j = 0; j < w->fit->param_count; j++) {
    open += w->fit->core.params[j].fixed ? 0U : 1U;
  }
  if (w->problem.rows >= open && open > 0) {
    return DEA_OK;
  }
  const struct dea_device_curve *first = &w->fit->curves[0];
  DEA_TRY(w->ctx,
          open == 0 ? dea_finding_add(w->ctx, DEA_ERROR, w->fit->file->parameters[0].name.location,
                                      "all parameters are fixed: nothing is left to be fitted")
                    : dea_finding_add(w->ctx, DEA_ERROR, first->text->file.location,
                                      "%zu measured value%s, priors included, where %zu "
                                      "parameters are sought; slack rows do not count",
                                      w->problem.rows, w->problem.rows == 1 ? "" : "s", open));
  return dea_fail(w->ctx, DEA_E_DESIGN, "the curves cannot determine the parameters");
}

/* A start that the design cannot be built with: its errors are told. */
static dea_status report_start(struct work *w)
{
  const struct dea_design_bytes file = {w->design, w->bytes, w->length};
  struct dea_design *design;
  struct dea_device *device;
  dea_status status = dea_device_params_build(w->ctx, &file, w->fit->params, w->fit->param_count,
                                              w->start, &design, &device);
  dea_device_destroy(w->ctx, device);
  dea_design_destroy(w->ctx, design);
  return status != DEA_OK ? status
                          : dea_fail(w->ctx, DEA_E_DOMAIN,
                                     "the design cannot be built where the "
                                     "search begins: %s",
                                     w->model.why);
}

static dea_status prepare(struct work *w)
{
  struct dea_load_point *own;
  DEA_TRY(w->ctx, dea_device_curves_read(w->ctx, w->fit));
  DEA_TRY(w->ctx, check_kinds(w));
  DEA_TRY(w->ctx, check_uncertainties(w));
  DEA_TRY(w->ctx, dea_device_stops_build(w->ctx, w->fit, &w->model));
  w->slack = dea_arena_alloc(&w->fit->memory, w->model.stop_count, sizeof *w->slack);
  w->wanted = dea_arena_alloc(&w->fit->memory, w->model.stop_count, sizeof *w->wanted);
  own = dea_arena_alloc(&w->fit->memory, w->model.stop_count, sizeof *own);
  DEA_TRY(w->ctx, dea_arena_status(&w->fit->memory));
  DEA_TRY(w->ctx, keep_designed(w));
  if (!w->starts_designed) {
    dea_status status = dea_device_model_sweep(&w->model, NULL, w->start, own);
    DEA_TRY(w->ctx, status == DEA_E_DOMAIN ? report_start(w) : status);
  }
  const struct dea_load_point *points = w->starts_designed ? w->designed : own;
  find_slack(w, points, true, w->slack);
  cut_slack(w);
  build_problem(w);
  DEA_TRY(w->ctx, check_start(w, points));
  return check_count(w);
}

// The minimum and what it says --------------------------------------------------------------------

/* Fits, from the values of the round before, if there was one; where the film goes slack at other
 * voltages than at the start, again with other rows. */
static dea_status solve(void *user)
{
  struct work *w = user;
  struct dea_lsq_fit *found = &w->fit->core.least_squares;
  struct dea_load_point *points =
      dea_arena_alloc(&w->fit->memory, w->model.stop_count, sizeof *points);
  DEA_TRY(w->ctx, dea_arena_status(&w->fit->memory));
  w->fit->settled = false;
  for (int round = 0; round < ROUNDS_MAX && !w->fit->settled; round++) {
    if (found->r != NULL) {
      memcpy(w->start, found->p, w->problem.params * sizeof *w->start);
      dea_lsq_free(found);
      build_problem(w);
      DEA_TRY(w->ctx, check_count(w));
    }
    DEA_TRY(w->ctx, dea_lsq_solve(w->ctx, &w->problem, w->start, NULL, found));
    DEA_TRY(w->ctx, dea_device_model_sweep(&w->model, NULL, found->p, points));
    find_slack(w, points, false, w->slack);
    w->fit->settled = !cuts_others(w);
    if (w->fit->settled || round + 1 < ROUNDS_MAX) {
      cut_slack(w);
    }
  }
  return DEA_OK;
}

/* Points at the parameters found, and at each moved by one step of the derivatives up and down;
 * [stops] in the arena, NULL where there are none. */
struct slopes {
  struct dea_load_point *at, *plus[DEA_DEVICE_PARAMS_MAX], *minus[DEA_DEVICE_PARAMS_MAX];
  double step[DEA_DEVICE_PARAMS_MAX];
};

/* p_j: moved by `by`. */
static dea_status copy_points(struct work *w, size_t j, double by, struct dea_load_point **out)
{
  double p[DEA_DEVICE_PARAMS_MAX];
  const struct dea_load_point *points;
  *out = NULL;
  memcpy(p, w->fit->core.least_squares.p, w->problem.params * sizeof *p);
  // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): j < params
  p[j] = p[j] + by;
  dea_status status = dea_device_model_points(&w->model, p, &points);
  if (status == DEA_E_DOMAIN) {
    return DEA_OK;
  }
  DEA_TRY(w->ctx, status);
  *out = dea_arena_alloc(&w->fit->memory, w->model.stop_count, sizeof **out);
  DEA_TRY(w->ctx, dea_arena_status(&w->fit->memory));
  memcpy(*out, points, w->model.stop_count * sizeof **out);
  return DEA_OK;
}

static dea_status find_slopes(struct work *w, struct slopes *out)
{
  *out = (struct slopes){.at = NULL};
  DEA_TRY(w->ctx, copy_points(w, 0, 0, &out->at));
  for (size_t j = 0; j < w->fit->param_count; j++) {
    const struct dea_fit_param *param = &w->fit->core.params[j];
    out->step[j] = param->fixed ? 0 : w->problem.step * param->scale;
    if (!param->fixed) {
      DEA_TRY(w->ctx, copy_points(w, j, out->step[j], &out->plus[j]));
      DEA_TRY(w->ctx, copy_points(w, j, -out->step[j], &out->minus[j]));
    }
  }
  return out->at != NULL ? DEA_OK
                         : dea_fail(w->ctx, DEA_E_DOMAIN, "the model has no answer at the end");
}

static double value_at(const struct dea_load_point *points, size_t stop, int column)
{
  return points != NULL ? dea_point_get(&points[stop], column) : (double)NAN;
}

/* 0 of a parameter that is held; to one side where the model has no answer on the other; NAN. */
static double slope(const struct slopes *s, size_t j, size_t stop, int column)
{
  const double at = value_at(s->at, stop, column), up = value_at(s->plus[j], stop, column),
               down = value_at(s->minus[j], stop, column);
  return s->step[j] == 0 ? 0
         : isnan(up)     ? (at - down) / s->step[j]
         : isnan(down)   ? (up - at) / s->step[j]
                         : (up - down) / (2 * s->step[j]);
}

static double std_of(const struct work *w, const struct slopes *s, size_t stop, int column)
{
  double slopes[DEA_DEVICE_PARAMS_MAX];
  for (size_t j = 0; j < w->fit->param_count; j++) {
    slopes[j] = slope(s, j, stop, column);
  }
  return dea_lsq_std_of(&w->fit->core.statistics, slopes);
}

static void fill_curve(struct work *w, const struct slopes *s, struct dea_device_curve *curve)
{
  double squares = 0, low = INFINITY, high = -INFINITY, largest = 0;
  size_t count = 0;
  for (size_t i = 0; i < curve->rows; i++) {
    curve->model[i] = value_of(s->at, curve, i);
    curve->model_std[i] = std_of(w, s, curve->stop[i], curve->column);
    if (curve->used[i] || (!is_fitted(curve) && !isnan(curve->model[i]))) {
      const double off = curve->model[i] - curve->value[i];
      squares += off * off;
      largest = fmax(largest, fabs(off));
      low = fmin(low, curve->value[i]);
      high = fmax(high, curve->value[i]);
      count++;
    }
  }
  curve->rms = count > 0 ? sqrt(squares / (double)count) : NAN;
  curve->largest = high > low ? largest / (high - low) : NAN;
}

// The next measurement ----------------------------------------------------------------------------

/* Mean share of its curve's largest value that a row's uncertainty is. */
static double usual_share(const struct dea_device_fit *fit)
{
  double sum = 0;
  size_t count = 0;
  for (size_t c = 0; c < fit->curve_count; c++) {
    const struct dea_device_curve *curve = &fit->curves[c];
    double most = 0;
    for (size_t i = 0; i < curve->rows; i++) {
      most = fmax(most, fabs(curve->value[i]));
    }
    for (size_t i = 0; i < curve->rows; i++) {
      if (curve->used[i] && most > 0) {
        sum += log((isnan(curve->std[i]) ? fit->core.scatter : curve->std[i]) / most);
        count++;
      }
    }
  }
  return count > 0 ? exp(sum / (double)count) * sqrt(fit->core.statistics.variance) : scatter_guess;
}

static bool is_measured(const struct dea_device_fit *fit, int column)
{
  for (size_t c = 0; c < fit->curve_count; c++) {
    if (fit->curves[c].column == column && is_fitted(&fit->curves[c])) {
      return true;
    }
  }
  return false;
}

/* A quantity over the voltages of the free film, measured as well as the others. */
static bool propose_quantity(struct work *w, const struct slopes *s, const char *key, double share,
                             struct dea_fit_proposal *out)
{
  const int column = dea_point_column_find(key);
  const size_t n = w->fit->param_count;
  double most = 0;
  size_t rows = 0, stops[64];
  for (size_t g = 0;
       g < w->model.group_count && !w->model.groups[g].held && !w->model.groups[g].in_time; g++) {
    const struct dea_device_group *group = &w->model.groups[g];
    for (size_t k = group->first; k < group->first + group->count && rows < 64; k++) {
      const double value = dea_point_get(&s->at[k], column);
      if (!isnan(value) && w->model.wanted[k]) {
        most = fmax(most, fabs(value));
        stops[rows++] = k;
      }
    }
  }
  double *J = dea_arena_alloc(&w->fit->memory, (rows + 1) * n, sizeof *J);
  if (is_measured(w->fit, column) || rows == 0 || most == 0 || J == NULL) {
    return false;
  }
  for (size_t j = 0; j < n; j++) {
    for (size_t i = 0; i < rows; i++) {
      const double value = slope(s, j, stops[i], column) / (share * most);
      J[j * rows + i] = isfinite(value) ? value : 0;
    }
  }
  *out = (struct dea_fit_proposal){.rows = rows, .J = J};
  snprintf(out->what, sizeof out->what, "%s over the voltage (to %.2g %%)",
           dea_point_columns[column].header, 100 * share);
  return true;
}

static dea_status report_fit(struct work *w, const struct slopes *s)
{
  static const char *const keys[] = {"electrode_stretch", "capacitance_F", "fibre_tip_z_m",
                                     "centre_z_m",        "highest_z_m",   "lowest_z_m"};
  enum { KEYS = sizeof keys / sizeof keys[0] };
  struct dea_fit_proposal candidates[KEYS + DEA_DEVICE_PARAMS_MAX];
  const double share = usual_share(w->fit);
  const size_t n = w->fit->param_count;
  size_t count = 0;
  for (size_t k = 0; k < KEYS; k++) {
    count += propose_quantity(w, s, keys[k], share, &candidates[count]) ? 1U : 0U;
  }
  for (size_t j = 0; j < n; j++) {
    double *J = dea_arena_alloc(&w->fit->memory, n, sizeof *J);
    const struct dea_fit_param *param = &w->fit->core.params[j];
    if (!param->fixed && J != NULL) {
      const double own = fmax(share, 0.01); // a gauge is no better
      J[j] = 1 / (own * param->scale);
      candidates[count].rows = 1;
      candidates[count].J = J;
      snprintf(candidates[count].what, sizeof candidates[count].what, "%s by itself (to %.2g %%)",
               param->name, 100 * own);
      count++;
    }
  }
  DEA_TRY(w->ctx, dea_arena_status(&w->fit->memory));
  dea_device_identify(w->fit, candidates, count);
  return DEA_OK;
}

// All of it ---------------------------------------------------------------------------------------

static dea_status finish(struct work *w)
{
  struct dea_device_fit *fit = w->fit;
  struct slopes slopes;
  DEA_TRY(w->ctx, find_slopes(w, &slopes)); // those of the last derivatives
  DEA_TRY(w->ctx, dea_fit_core_values(w->ctx, &w->problem, w->model.type->load == NULL, w->profiles,
                                      &fit->core));
  for (size_t c = 0, g = 0; c < fit->curve_count; c++) {
    fill_curve(w, &slopes, &fit->curves[c]);
    if (count_used(&fit->curves[c]) > 0) {
      fit->curves[c].lag = fit->core.statistics.lag[g];
      fit->curves[c].effective = fit->core.statistics.effective[g++];
    }
  }
  DEA_TRY(w->ctx, report_fit(w, &slopes));
  dea_fit_core_scatter(&fit->core);
  fit->evaluations = w->model.evaluations;
  const struct dea_design_bytes file = {w->design, w->bytes, w->length};
  return dea_device_design_build(w->ctx, fit, &file, w->device);
}

static dea_status run(struct work *w)
{
  DEA_TRY(w->ctx, find_model(w));
  DEA_TRY(w->ctx, read_design(w));
  DEA_TRY(w->ctx, build_params(w));
  DEA_TRY(w->ctx, prepare(w));
  DEA_TRY(w->ctx, dea_fit_core_solve(w->ctx, &w->fit->core, solve, w));
  return finish(w);
}

dea_status dea_device_fit_run(struct dea_context *ctx, const struct dea_device_file *file,
                              bool profiles, struct dea_device_fit *fit)
{
  struct work w = {.ctx = ctx, .fit = fit, .profiles = profiles};
  *fit = (struct dea_device_fit){.file = file, .design = {.ctx = ctx}, .memory = {.ctx = ctx}};
  dea_status status = run(&w);
  dea_device_model_end(&w.model);
  dea_device_destroy(ctx, w.device);
  dea_design_destroy(ctx, w.design);
  dea_free(ctx, w.fine);
  dea_free(ctx, w.bytes);
  dea_free(ctx, w.path);
  return DEA_CHAIN(ctx, status);
}

void dea_device_fit_free(struct dea_device_fit *fit)
{
  dea_fit_core_free(&fit->core);
  dea_text_free(&fit->design);
  dea_arena_free(&fit->memory);
}
