#include "identify/fit_model.h"

#include "base/units.h"
#include "material/branch.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { THIN_ROWS = 40, GRID_MAX = 4096 };

// of coefficients of either sign, over the modulus that the tests speak of
#define CANCEL 10.0

// Values of parameters without a unit that a search begins from: exponents, extensibilities,
// limits.
static const double grid_values[] = {-6, -2, -0.5, 0.5, 1.3, 2, 3, 5, 8, 14, 25, 50, 100, 250};
enum { GRID_VALUES = sizeof grid_values / sizeof grid_values[0] };

/* Of one at whose lower bound the law locks up: from close to the bound to far away. */
static double grid_value(const struct dea_fit_param *param, size_t k)
{
  return param->locks ? param->low * (1 + 1e-3 * pow(3, (double)k)) : grid_values[k];
}

/* ---- the parameters ---- */

static bool is_modulus(const struct dea_fit_param *param)
{
  return strcmp(param->unit, "Pa") == 0;
}

/* Number at the end of a key: 2 of "alpha2", 0 without. */
static int term_of(const char *key)
{
  size_t n = strlen(key);
  while (n > 0 && isdigit((unsigned char)key[n - 1])) {
    n--;
  }
  return (int)strtol(key + n, NULL, 10);
}

/* Shear modulus that the largest stress of the used series speaks of. */
static double guess_modulus(const struct dea_fit_series *series, size_t count)
{
  double mu = 0;
  for (size_t s = 0; s < count; s++) {
    for (size_t i = 0; i < series[s].rows && dea_fit_series_used(&series[s]); i++) {
      const double l = series[s].stretch[i];
      const double strain = fabs(l - 1 / (l * l));
      mu = strain > 0.02 ? fmax(mu, fabs(series[s].stress_Pa[i]) / strain) : mu;
    }
  }
  return mu > 0 ? mu : 1e5;
}

/* The parameter that says where a law locks up is bounded by how far the tests went: by the value
 * at which the chains would be fully stretched there. */
static void bound_locking(struct dea_fit_model *model, const struct dea_fit_series *series,
                          size_t count)
{
  double p[DEA_LAW_PARAM_MAX], I1 = 3;
  for (size_t s = 0; s < count; s++) {
    for (size_t i = 0; i < series[s].rows && dea_fit_series_used(&series[s]); i++) {
      I1 = fmax(I1, dea_coupon_I1(series[s].coupon.mode, series[s].stretch[i]));
    }
  }
  for (size_t j = 0; j < model->law_count; j++) {
    p[j] = model->params[j].low;
  }
  for (size_t j = 0; j < model->law_count && model->law->locking_share != NULL; j++) {
    struct dea_fit_param *param = &model->params[j];
    double low = param->low, high = param->high;
    if (is_modulus(param) || !(model->law->locking_share(p, I1) > 1)) {
      continue;
    }
    while (high > low * (1 + 1e-12)) {
      p[j] = sqrt(low * high);
      *(model->law->locking_share(p, I1) > 1 ? &low : &high) = p[j];
    }
    param->low = high;
    param->locks = true;
  }
}

static dea_status read_number(struct dea_context *ctx, const struct dea_label *label,
                              const char *unit, double *out)
{
  char why[DEA_WHY_SIZE] = "";
  const struct dea_measure due = {unit, strcmp(unit, "Pa") == 0  ? "100 kPa"
                                        : strcmp(unit, "m") == 0 ? "100 um"
                                                                 : "1.5"};
  if (label->text[0] == '\0' || dea_units_read(ctx, label->text, due, out, why)) {
    return DEA_OK;
  }
  if (why[0] == '\0') {
    return dea_context_status(ctx);
  }
  return dea_finding_add(ctx, DEA_ERROR, label->location, "'%.60s': %s", label->text, why);
}

dea_status dea_fit_param_read(struct dea_context *ctx, const struct dea_fit_parameter_text *text,
                              struct dea_fit_param *param)
{
  double low = NAN, high = NAN;
  DEA_TRY(ctx, read_number(ctx, &text->start, param->unit, &param->start));
  DEA_TRY(ctx, read_number(ctx, &text->low, param->unit, &low));
  DEA_TRY(ctx, read_number(ctx, &text->high, param->unit, &high));
  DEA_TRY(ctx, read_number(ctx, &text->prior, param->unit, &param->prior));
  DEA_TRY(ctx, read_number(ctx, &text->prior_std, param->unit, &param->prior_std));
  param->low = fmax(param->low, isnan(low) ? -INFINITY : low);
  param->high = fmin(param->high, isnan(high) ? INFINITY : high);
  param->started = text->start.text[0] != '\0';
  param->fixed = text->fixed.value == 1;
  if (!(param->low <= param->high)) {
    return dea_finding_add(ctx, DEA_ERROR, text->name.location,
                           "%s: no value lies between its bounds %g and %g", param->name,
                           param->low, param->high);
  }
  if (isnan(param->prior) != isnan(param->prior_std) || param->prior_std <= 0) {
    return dea_finding_add(ctx, DEA_ERROR, text->name.location,
                           "%s: a prior is a value with a standard uncertainty above 0 (prior_std)",
                           param->name);
  }
  if (param->fixed && !param->started) {
    return dea_finding_add(ctx, DEA_ERROR, text->name.location, "%s: what is fixed needs a start",
                           param->name);
  }
  if (param->fixed && !(param->start >= param->low && param->start <= param->high)) {
    return dea_finding_add(ctx, DEA_ERROR, text->start.location,
                           "%s: what it is fixed at, %g, lies beyond its bounds %g and %g",
                           param->name, param->start, param->low, param->high);
  }
  return DEA_OK;
}

static dea_status read_texts(struct dea_context *ctx, const struct dea_fit_file *file,
                             struct dea_fit_model *model)
{
  for (size_t k = 0; k < file->parameter_count; k++) {
    const struct dea_fit_parameter_text *text = &file->parameters[k];
    const char *names[DEA_LAW_PARAM_MAX];
    size_t j = 0;
    while (j < model->law_count && strcmp(model->params[j].name, text->name.text) != 0) {
      names[j] = model->params[j].name;
      j++;
    }
    if (j < model->law_count) {
      model->params[j].fixed = false;
      model->params[j].limit = INFINITY; // whoever names it bounds it
      DEA_TRY(ctx, dea_fit_param_read(ctx, text, &model->params[j]));
      continue;
    }
    char hint[DEA_HINT_SIZE];
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, text->name.location,
                                 "the law %s has no parameter '%.60s'%s", model->law->name,
                                 text->name.text, dea_name_hint(text->name.text, names, j, hint)));
  }
  return DEA_OK;
}

/* Law of "ogden-2" and the terms wanted, 0: all that are required. */
static const struct dea_law *find_law(const char *name, int *terms)
{
  char stem[DEA_TITLE_SIZE];
  const struct dea_law *law = dea_law_find(name);
  *terms = 0;
  snprintf(stem, sizeof stem, "%s", name);
  char *dash = strrchr(stem, '-');
  if (law == NULL && dash != NULL && isdigit((unsigned char)dash[1])) {
    *terms = (int)strtol(dash + 1, NULL, 10);
    *dash = '\0';
    law = dea_law_find(stem);
    for (size_t j = 0; law != NULL && j < law->param_count; j++) {
      law = term_of(law->params[j].key) == 0 ? NULL : law;
    }
  }
  return law;
}

/* Terms of a law that has numbered ones. */
static int count_terms(const struct dea_law *law)
{
  int most = 0;
  for (size_t j = 0; j < law->param_count; j++) {
    const int term = term_of(law->params[j].key);
    most = term > most ? term : most;
  }
  return most;
}

static dea_status unknown_law(struct dea_context *ctx, const struct dea_label *name,
                              const struct dea_law *law)
{
  size_t count, named = 0;
  const char *names[32];
  const struct dea_law *const *laws = dea_law_all(&count);
  for (size_t i = 0; i < count && named < 32; i++) {
    if (!laws[i]->anisotropic && laws[i]->compressible == NULL) {
      names[named++] = laws[i]->name;
    }
  }
  char hint[DEA_HINT_SIZE];
  return law != NULL ? dea_finding_add(ctx, DEA_ERROR, name->location,
                                       "'%.60s' is no law of a film without a direction, which is "
                                       "what is fitted",
                                       name->text)
                     : dea_finding_add(ctx, DEA_ERROR, name->location,
                                       "'%.60s' is not a law%s; dea schema --material and "
                                       "docs/theory/materials.md list them",
                                       name->text, dea_name_hint(name->text, names, named, hint));
}

dea_status dea_fit_model_create(struct dea_context *ctx, const struct dea_fit_file *file,
                                const struct dea_label *name, const struct dea_fit_series *series,
                                size_t series_count, struct dea_fit_model *out)
{
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  int terms;
  *out = (struct dea_fit_model){
      .law = find_law(name->text, &terms),
      .file = file,
      .reference_K = file->reference_K.origin != DEA_ABSENT ? file->reference_K.si : NAN,
      .coldest_K = INFINITY};
  for (size_t s = 0; s < series_count; s++) {
    if (dea_fit_series_used(&series[s])) {
      out->coldest_K = fmin(out->coldest_K, dea_fit_temperature_K(file, series[s].test));
    }
  }
  if (out->law == NULL || out->law->anisotropic || out->law->compressible != NULL) {
    DEA_TRY(ctx, unknown_law(ctx, name, out->law));
    return dea_fail(ctx, DEA_E_DESIGN, "'%.60s' cannot be fitted", name->text);
  }
  const bool is_own = dea_law_find(name->text) != NULL; // a name that ends in a number itself
  if (!is_own && (terms < 1 || terms > count_terms(out->law))) {
    DEA_TRY(ctx,
            dea_finding_add(ctx, DEA_ERROR, name->location, "'%.60s': the law %s has 1 to %d terms",
                            name->text, out->law->name, count_terms(out->law)));
    return dea_fail(ctx, DEA_E_DESIGN, "'%.60s' cannot be fitted", name->text);
  }
  const double mu = guess_modulus(series, series_count);
  out->count = out->law_count = out->law->param_count;
  for (size_t j = 0; j < out->law_count; j++) {
    const struct dea_law_param *param = &out->law->params[j];
    const bool wanted = terms > 0 ? term_of(param->key) <= terms : param->required;
    const bool modulus = strcmp(param->unit, "Pa") == 0;
    const bool cancels = modulus && param->min < 0;
    out->params[j] = (struct dea_fit_param){.unit = param->unit,
                                            .fixed = !wanted,
                                            .start = modulus ? 0.5 * mu : 2,
                                            .low = param->min,
                                            .high = param->max,
                                            .limit = cancels ? CANCEL * mu : INFINITY,
                                            .scale = modulus ? mu : 1,
                                            .prior = NAN,
                                            .prior_std = NAN};
    out->params[j].start = out->params[j].fixed ? 0 : out->params[j].start;
    snprintf(out->params[j].name, sizeof out->params[j].name, "%s", param->key);
  }
  bound_locking(out, series, series_count);
  DEA_TRY(ctx, read_texts(ctx, file, out));
  return dea_finding_count(ctx, DEA_ERROR) == errors
             ? DEA_OK
             : dea_fail(ctx, DEA_E_DESIGN, "the parameters of '%s' have errors", name->text);
}

/* c1 and c2, of which c2 keeps the formula's pole below the coldest test. */
static void add_shift(struct dea_fit_model *model)
{
  struct dea_fit_param *c1 = &model->params[model->count], *c2 = c1 + 1;
  *c1 = (struct dea_fit_param){.name = "wlf c1",
                               .unit = "1",
                               .started = true,
                               .start = DEA_FIT_WLF_C1,
                               .low = 0,
                               .high = 100,
                               .scale = 1,
                               .prior = NAN,
                               .prior_std = NAN};
  *c2 = *c1;
  snprintf(c2->name, sizeof c2->name, "wlf c2");
  c2->unit = "K";
  c2->start = DEA_FIT_WLF_C2_K;
  c2->low = fmax(1, model->reference_K - model->coldest_K + 1);
  c2->high = 1e5;
  c2->scale = 10;
  model->count += 2;
}

void dea_fit_model_branches(struct dea_fit_model *model, size_t count, double from_s, double to_s,
                            const struct dea_quantity *times)
{
  const double scale = model->params[0].scale > 10 ? model->params[0].scale : 1e5;
  model->branch_count = count;
  model->count = model->law_count + 2 * count;
  for (size_t b = 0; b < count; b++) {
    struct dea_fit_param *modulus = &model->params[model->law_count + 2 * b], *time = modulus + 1;
    const double share = ((double)b + 0.5) / (double)count;
    *modulus = (struct dea_fit_param){.unit = "Pa",
                                      .start = 0.2 * scale,
                                      .low = 0,
                                      .high = 1e12,
                                      .scale = scale,
                                      .prior = NAN,
                                      .prior_std = NAN};
    *time = *modulus;
    time->unit = "s";
    time->fixed = times != NULL;
    time->logarithmic = true;
    time->started = true;
    time->scale = 1;
    time->start = times != NULL ? log(times[b].si) : log(from_s) + share * log(to_s / from_s);
    time->low = log(from_s) - log(10);
    time->high = log(to_s) + log(10);
    snprintf(modulus->name, sizeof modulus->name, "modulus %zu", b + 1);
    snprintf(time->name, sizeof time->name, "time %zu", b + 1);
  }
  if (count > 0 && !isnan(model->reference_K)) {
    add_shift(model);
  }
}

size_t dea_fit_model_free(const struct dea_fit_model *model)
{
  size_t count = 0;
  for (size_t j = 0; j < model->count; j++) {
    count += model->params[j].fixed ? 0U : 1U;
  }
  return count;
}

void dea_fit_model_material(const struct dea_fit_model *model, const double *p,
                            const struct dea_fit_test *test, struct dea_material *out)
{
  const size_t shift = model->law_count + 2 * model->branch_count;
  double factor = 1;
  if (test != NULL && shift < model->count) {
    factor = dea_branch_shift(p[shift], p[shift + 1],
                              dea_fit_temperature_K(model->file, test) - model->reference_K);
  }
  *out = (struct dea_material){.law = model->law, .branch_count = model->branch_count};
  memcpy(out->param, p, model->law_count * sizeof *p);
  for (size_t b = 0; b < model->branch_count; b++) {
    out->branches[b].modulus_Pa = p[model->law_count + 2 * b];
    out->branches[b].time_s = factor * exp(p[model->law_count + 2 * b + 1]);
  }
}

/* ---- the residuals ---- */

bool dea_fit_series_used(const struct dea_fit_series *series)
{
  return series->test->use.value == DEA_FIT_USED;
}

struct residuals {
  const struct dea_fit_model *model;
  const struct dea_fit_rows *rows;
  struct dea_coupon_shares *shares; // [rows->count]
  double *stress;                   // [largest series]
  bool bare;                        // stresses themselves, of any series
};

static bool is_left_out(const struct dea_fit_rows *rows, size_t s, size_t i)
{
  return s == rows->without && i >= rows->from && i < rows->to;
}

static dea_status residual(void *user, const double *p, double *r)
{
  const struct residuals *w = user;
  struct dea_material material;
  size_t n = 0;
  for (size_t s = 0; s < w->rows->count; s++) {
    const struct dea_fit_series *series = &w->rows->series[s];
    if (!w->bare && !dea_fit_series_used(series)) {
      continue;
    }
    dea_fit_model_material(w->model, p, series->test, &material);
    dea_status status =
        dea_coupon_stress(&material, &series->coupon, &w->shares[s], w->bare ? r : w->stress);
    if (status != DEA_OK || w->bare) {
      return status;
    }
    for (size_t i = 0; i < series->rows; i++) {
      const double std = isnan(series->std_Pa[i]) ? w->rows->std_Pa : series->std_Pa[i];
      if (!is_left_out(w->rows, s, i)) {
        r[n++] = (w->stress[i] - series->stress_Pa[i]) / std;
      }
    }
  }
  dea_fit_priors_add(w->model->params, w->model->count, p, r + n);
  return DEA_OK;
}

static dea_status build_problem(struct dea_arena *arena, const struct dea_fit_model *model,
                                const struct dea_fit_rows *rows, bool bare,
                                struct dea_lsq_problem *out)
{
  size_t largest = 0;
  for (size_t s = 0; s < rows->count; s++) {
    largest = rows->series[s].rows > largest ? rows->series[s].rows : largest;
  }
  struct residuals *w = dea_arena_alloc(arena, 1, sizeof *w);
  double *stress = dea_arena_alloc(arena, largest, sizeof *stress);
  struct dea_coupon_shares *shares = dea_arena_alloc(arena, rows->count, sizeof *shares);
  for (size_t s = 0; s < rows->count && shares != NULL; s++) {
    DEA_TRY(arena->ctx, dea_coupon_shares_build(arena, &rows->series[s].coupon, model->branch_count,
                                                &shares[s]));
  }
  DEA_TRY_MEMORY(!arena->failed);
  *w = (struct residuals){model, rows, shares, stress, bare};
  *out = (struct dea_lsq_problem){
      .params = model->count, .param = model->params, .residual = residual, .user = w};
  return DEA_OK;
}

dea_status dea_fit_model_problem(struct dea_arena *arena, const struct dea_fit_model *model,
                                 const struct dea_fit_rows *rows, struct dea_lsq_problem *out)
{
  DEA_TRY(arena->ctx, build_problem(arena, model, rows, false, out));
  for (size_t s = 0; s < rows->count; s++) {
    for (size_t i = 0; i < rows->series[s].rows && dea_fit_series_used(&rows->series[s]); i++) {
      out->rows += is_left_out(rows, s, i) ? 0U : 1U;
    }
  }
  out->rows += dea_fit_priors_add(model->params, model->count, NULL, NULL);
  return DEA_OK;
}

dea_status dea_fit_model_stress(struct dea_arena *arena, const struct dea_fit_model *model,
                                const struct dea_fit_series *series, struct dea_lsq_problem *out)
{
  struct dea_fit_rows *rows = dea_arena_alloc(arena, 1, sizeof *rows);
  DEA_TRY_MEMORY(rows != NULL);
  *rows = (struct dea_fit_rows){.series = series, .count = 1, .without = SIZE_MAX};
  DEA_TRY(arena->ctx, build_problem(arena, model, rows, true, out));
  out->rows = series->rows;
  return DEA_OK;
}

/* ---- where to begin ---- */

/* Every n-th row of each series, so that a search over a grid is quick. */
static dea_status thin(struct dea_arena *arena, const struct dea_fit_rows *rows,
                       struct dea_fit_series *series)
{
  for (size_t s = 0; s < rows->count; s++) {
    const struct dea_fit_series *whole = &rows->series[s];
    struct dea_fit_series *few = &series[s];
    const size_t every = 1 + whole->rows / THIN_ROWS;
    double *values = dea_arena_alloc(arena, 3 * (whole->rows + 1), sizeof *values);
    size_t *node = dea_arena_alloc(arena, whole->rows + 1, sizeof *node);
    DEA_TRY_MEMORY(!arena->failed);
    *few = *whole;
    few->stretch = values;
    few->stress_Pa = values + whole->rows;
    few->std_Pa = values + 2 * whole->rows;
    few->rows = 0;
    for (size_t i = 0; i < whole->rows; i++) {
      if ((i % every == 0 || i + 1 == whole->rows) && !is_left_out(rows, s, i)) {
        few->stretch[few->rows] = whole->stretch[i];
        few->stress_Pa[few->rows] = whole->stress_Pa[i];
        few->std_Pa[few->rows] = whole->std_Pa[i];
        node[few->rows] = whole->coupon.node_count > 0 ? whole->coupon.node_of_row[i] : 0;
        few->rows++;
      }
    }
    few->coupon.rows = few->rows;
    few->coupon.stretch = few->stretch;
    few->coupon.node_of_row = node;
  }
  return DEA_OK;
}

/* Next combination of grid values of the parameters index[count]; false after the last. */
static bool next_combination(size_t *at, size_t count)
{
  for (size_t k = 0; k < count; k++) {
    if (++at[k] < GRID_VALUES) {
      return true;
    }
    at[k] = 0;
  }
  return false;
}

/* Terms of one kind ("alpha1", "alpha2") may be exchanged: only rising ones are looked at. */
static bool is_worth_it(const struct dea_fit_model *model, const size_t *index, const size_t *at,
                        size_t count)
{
  for (size_t k = 0; k < count; k++) {
    const struct dea_fit_param *param = &model->params[index[k]];
    const double value = grid_value(param, at[k]);
    if (value < param->low || value > param->high) {
      return false;
    }
    if (k > 0 && term_of(param->name) > 1 && at[k] <= at[k - 1]) {
      return false;
    }
  }
  return true;
}

static bool is_stable_at_rest(const struct dea_fit_model *model, const double *p)
{
  return model->law->shear_modulus(p) > 0;
}

/* In the search over a grid all but the moduli are. */
static bool is_held(const struct dea_fit_param *param)
{
  return param->fixed || !is_modulus(param) || param->started;
}

/* The residuals as functions of the parameters that are no moduli alone: at each of them the moduli
 * are those that fit best. */
struct projection {
  struct dea_context *ctx;
  const struct dea_lsq_problem *problem;
  const bool *held;             // all but the moduli
  double p[DEA_LSQ_PARAMS_MAX]; // with the moduli found last
};

static dea_status project(void *user, const double *p, double *r)
{
  struct projection *w = user;
  struct dea_lsq_fit fit;
  const dea_status status = dea_lsq_solve(w->ctx, w->problem, p, w->held, &fit);
  if (status == DEA_OK) {
    memcpy(r, fit.r, fit.rows * sizeof *r);
    memcpy(w->p, fit.p, fit.params * sizeof *fit.p);
    dea_lsq_free(&fit);
  } else if (status == DEA_E_DOMAIN || status == DEA_E_NOT_CONVERGED) {
    dea_context_clear(w->ctx);
    return DEA_E_DOMAIN;
  }
  return status;
}

/* Moves p to the minimum near by, where there is one with a modulus at rest above 0. */
static dea_status refine_start(struct dea_context *ctx, const struct dea_fit_model *model,
                               const struct dea_lsq_problem *problem, double *p)
{
  bool held[DEA_LSQ_PARAMS_MAX], moduli[DEA_LSQ_PARAMS_MAX];
  struct projection w = {.ctx = ctx, .problem = problem, .held = held};
  struct dea_lsq_problem reduced = *problem;
  struct dea_lsq_fit fit;
  for (size_t j = 0; j < model->count; j++) {
    held[j] = is_held(&model->params[j]);
    moduli[j] = !held[j] || model->params[j].fixed || model->params[j].started;
  }
  reduced.residual = project;
  reduced.user = &w;
  reduced.tolerance = 1e-10;
  dea_status status = dea_lsq_solve(ctx, &reduced, p, moduli, &fit);
  if (status == DEA_OK) {
    status = project(&w, fit.p, fit.r);
    dea_lsq_free(&fit);
  }
  if (status == DEA_OK && is_stable_at_rest(model, w.p)) {
    memcpy(p, w.p, model->count * sizeof *p);
  } else if (status == DEA_E_DOMAIN || status == DEA_E_NOT_CONVERGED) {
    dea_context_clear(ctx);
    status = DEA_OK;
  }
  return status;
}

/* Best start over the grid into p; it stays as it is when no point has an answer. */
static dea_status find_start(struct dea_context *ctx, const struct dea_fit_model *model,
                             const struct dea_lsq_problem *problem, double *p)
{
  size_t index[DEA_LSQ_PARAMS_MAX], at[DEA_LSQ_PARAMS_MAX] = {0}, count = 0, tried = 0;
  bool held[DEA_LSQ_PARAMS_MAX], stable = false;
  double best = INFINITY, q[DEA_LSQ_PARAMS_MAX];
  for (size_t j = 0; j < model->count; j++) {
    const struct dea_fit_param *param = &model->params[j];
    held[j] = is_held(param);
    if (!param->fixed && !param->started && !is_modulus(param)) {
      index[count++] = j;
    }
  }
  memcpy(q, p, model->count * sizeof *q);
  do {
    struct dea_lsq_fit fit;
    if (!is_worth_it(model, index, at, count) || tried++ > GRID_MAX) {
      continue;
    }
    for (size_t k = 0; k < count; k++) {
      q[index[k]] = grid_value(&model->params[index[k]], at[k]);
    }
    dea_status status = dea_lsq_solve(ctx, problem, q, held, &fit);
    if (status == DEA_E_MEMORY) {
      return status;
    }
    if (status != DEA_OK) {
      dea_context_clear(ctx);
      continue;
    }
    const bool is_stable = is_stable_at_rest(model, fit.p);
    if (is_stable == stable ? fit.chi2 < best : is_stable) {
      best = fit.chi2;
      stable = is_stable;
      memcpy(p, fit.p, model->count * sizeof *p);
    }
    dea_lsq_free(&fit);
  } while (next_combination(at, count));
  return count > 0 && stable ? refine_start(ctx, model, problem, p) : DEA_OK;
}

/* The coefficient that is furthest beyond its limit: where two exponents come together, theirs grow
 * without end, cancel, and follow the tests hardly better. -1: none is; any: the largest one. */
static int find_cancelling(const struct dea_fit_model *model, const double *p, bool any)
{
  double most = any ? 0 : 1;
  int found = -1;
  for (size_t j = 0; j < model->law_count; j++) {
    if (!model->params[j].fixed && fabs(p[j]) / model->params[j].limit > most) {
      most = fabs(p[j]) / model->params[j].limit;
      found = (int)j;
    }
  }
  return found;
}

/* The minimum next to p over all rows; coefficients that would grow beyond their limit are held
 * there, one after the other. */
static dea_status search_within(struct dea_context *ctx, const struct dea_fit_model *model,
                                const struct dea_lsq_problem *quick,
                                const struct dea_lsq_problem *problem, double *p,
                                struct dea_lsq_fit *out)
{
  struct dea_fit_model own = *model;
  bool held[DEA_LSQ_PARAMS_MAX];
  dea_status status;
  for (int j = find_cancelling(&own, p, false);; j = find_cancelling(&own, p, false)) {
    if (j >= 0) {
      own.params[j].fixed = true;
      p[j] = copysign(own.params[j].limit, p[j]);
      DEA_TRY(ctx, refine_start(ctx, &own, quick, p));
    }
    for (size_t k = 0; k < own.count; k++) {
      held[k] = own.params[k].fixed;
    }
    status = dea_lsq_solve(ctx, problem, p, held, out);
    const bool endless = status == DEA_E_NOT_CONVERGED && find_cancelling(&own, p, true) >= 0;
    if (status != DEA_OK && !endless) {
      return status;
    }
    if (endless) { // along the way
      j = find_cancelling(&own, p, true);
      p[j] = copysign(2 * own.params[j].limit, p[j]);
      dea_context_clear(ctx);
      continue;
    }
    if (find_cancelling(&own, out->p, false) < 0) {
      break;
    }
    memcpy(p, out->p, own.count * sizeof *p);
    dea_lsq_free(out);
  }
  for (size_t k = 0; k < own.count; k++) {
    out->at_bound[k] = out->at_bound[k] || (own.params[k].fixed && !model->params[k].fixed);
  }
  return DEA_OK;
}

dea_status dea_fit_model_solve(struct dea_context *ctx, const struct dea_fit_model *model,
                               const struct dea_fit_rows *rows, struct dea_lsq_fit *out)
{
  struct dea_arena memory = {.ctx = ctx};
  struct dea_lsq_problem problem, quick;
  double p[DEA_LSQ_PARAMS_MAX];
  struct dea_fit_series *few = dea_arena_alloc(&memory, rows->count, sizeof *few);
  const struct dea_fit_rows few_rows = {few, rows->count, SIZE_MAX, 0, 0, rows->std_Pa};
  dea_status status = dea_arena_status(&memory);
  status = status == DEA_OK ? thin(&memory, rows, few) : status;
  status = status == DEA_OK ? dea_fit_model_problem(&memory, model, &few_rows, &quick) : status;
  status = status == DEA_OK ? dea_fit_model_problem(&memory, model, rows, &problem) : status;
  for (size_t j = 0; j < model->count; j++) {
    p[j] = model->params[j].start;
  }
  status = status == DEA_OK ? find_start(ctx, model, &quick, p) : status;
  status = status == DEA_OK ? search_within(ctx, model, &quick, &problem, p, out) : status;
  dea_arena_free(&memory);
  return status;
}
