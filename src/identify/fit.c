#include "identify/fit.h"

#include "material/branch.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { BLOCKS = 4, AUTO_BRANCHES_MAX = 6 };
#define SCATTER_SHARE 0.01 // of the largest stress

struct work {
  struct dea_context *ctx;
  struct dea_fit *fit;
  struct dea_material materials[DEA_FIT_LAWS_MAX]; // of the candidates, as fitted to all rows
  double from_s, to_s;                             // that the tests in time span
  bool timed;
};

/* ---- the rows ---- */

static struct dea_fit_rows all_rows(const struct dea_fit *fit)
{
  return (struct dea_fit_rows){fit->series, fit->series_count, SIZE_MAX, 0, 0, fit->core.scatter};
}

/* The times that the fitted tests span at the reference temperature, as far as the shift can be
 * guessed. */
static void widen_times(struct work *w)
{
  const struct dea_fit_file *file = w->fit->file;
  double longest = 1, shortest = 1;
  const bool shifts = file->reference_K.origin != DEA_ABSENT;
  for (size_t s = 0; s < w->fit->series_count && shifts; s++) {
    if (!dea_fit_series_used(&w->fit->series[s])) {
      continue;
    }
    const double off_K = dea_fit_temperature_K(file, w->fit->series[s].test) - file->reference_K.si;
    const double shift =
        dea_branch_shift(DEA_FIT_WLF_C1, DEA_FIT_WLF_C2_K, fmax(off_K, -0.5 * DEA_FIT_WLF_C2_K));
    longest = fmax(longest, shift);
    shortest = fmin(shortest, shift);
  }
  w->from_s /= longest;
  w->to_s /= shortest;
}

/* Whether all fitted rows have uncertainties; none have: the scatter is found. */
static dea_status check_uncertainties(struct work *w)
{
  struct dea_fit *fit = w->fit;
  size_t known = 0, rows = 0;
  double most = 0;
  const struct dea_fit_series *lacking = NULL;
  fit->stretch_min = INFINITY;
  for (size_t s = 0; s < fit->series_count; s++) {
    const struct dea_fit_series *series = &fit->series[s];
    for (size_t i = 0; i < series->rows && dea_fit_series_used(series); i++) {
      const bool is_known = !isnan(series->std_Pa[i]);
      known += is_known ? 1U : 0U;
      lacking = is_known ? lacking : series;
      rows++;
      most = fmax(most, fabs(series->stress_Pa[i]));
      fit->stretch_min = fmin(fit->stretch_min, fmin(1, series->stretch[i]));
      fit->stretch_max = fmax(fit->stretch_max, series->stretch[i]);
      fit->I1_max = fmax(fit->I1_max, dea_coupon_I1(series->coupon.mode, series->stretch[i]));
    }
    if (series->time_s != NULL && series->rows > 0 && dea_fit_series_used(series)) {
      const double last = series->time_s[series->rows - 1];
      const bool relaxes = series->test->kind.value == DEA_FIT_RELAXATION && series->rows > 1;
      const double first = relaxes
                               ? fmax(0, series->time_s[1] - series->time_s[0]) // after the peak
                               : last / 30;
      w->from_s = w->timed ? fmin(w->from_s, fmax(first, 1e-6 * last)) : fmax(first, 1e-6 * last);
      w->to_s = w->timed ? fmax(w->to_s, last) : last;
      w->timed = true;
    }
  }
  widen_times(w);
  if (rows == 0) {
    return dea_fail(w->ctx, DEA_E_DESIGN, "no test is there to be fitted (use: fit)");
  }
  fit->core.scale_known = known == rows;
  fit->core.scatter = SCATTER_SHARE * most; // a scale only: what it is follows from the residuals
  if (known > 0 && known < rows) {
    DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_ERROR, lacking->test->name.location,
                                    "'%.60s' gives no uncertainty while others do: give it one, or "
                                    "none to any",
                                    lacking->test->name.text));
    return dea_fail(w->ctx, DEA_E_DESIGN, "tests with and without uncertainty cannot be weighed");
  }
  return DEA_OK;
}

/* ---- a law of the list ---- */

/* Akaike's criterion with its correction for few rows. A misfit below the known noise is no gain.
 */
static double criterion(const struct dea_lsq_fit *fit, size_t free_count, bool scale_known)
{
  const double m = (double)fit->rows, k = (double)free_count + 1;
  const double mean = fit->chi2 / m;
  return m - k - 1 < 0.5 ? INFINITY
                         : m * log(fmax(mean, scale_known ? 1 : 1e-300)) + 2 * k +
                               2 * k * (k + 1) / (m - k - 1);
}

/* As many branches as lower the criterion; stops after two that do not. */
static dea_status find_branches(struct work *w, struct dea_fit_model *model)
{
  const struct dea_fit_rows rows = all_rows(w->fit);
  double best = INFINITY;
  size_t best_count = 0;
  for (size_t n = 0; n <= AUTO_BRANCHES_MAX && n <= best_count + 2; n++) {
    struct dea_fit_model trial = *model;
    struct dea_lsq_fit fit;
    dea_fit_model_branches(&trial, n, w->from_s, w->to_s, NULL);
    dea_status status = dea_fit_model_solve(w->ctx, &trial, &rows, &fit);
    if (status == DEA_E_MEMORY) {
      return status;
    }
    if (status != DEA_OK) {
      dea_context_clear(w->ctx);
      continue;
    }
    const double value = criterion(&fit, dea_fit_model_free(&trial), w->fit->core.scale_known);
    if (value < best - 2 || (n == 0 && isfinite(value))) {
      best = value;
      best_count = n;
    }
    dea_lsq_free(&fit);
  }
  dea_fit_model_branches(model, best_count, w->from_s, w->to_s, NULL);
  return DEA_OK;
}

static dea_status choose_branches(struct work *w, struct dea_fit_model *model)
{
  const struct dea_fit_file *file = w->fit->file;
  const char *text = file->branches.text, *end;
  const double count = dea_text_to_double(text, &end);
  const bool is_auto = strcmp(text, "auto") == 0, none = strcmp(text, "none") == 0;
  const bool is_number = *text != '\0' && *end == '\0' && count >= 0 && count <= DEA_BRANCHES_MAX &&
                         count == floor(count);
  if (!is_auto && !none && !is_number) {
    DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_ERROR, file->branches.location,
                                    "branches: '%.40s' is none of none, auto and a number up to %d",
                                    text, DEA_BRANCHES_MAX));
    return dea_fail(w->ctx, DEA_E_DESIGN, "the number of branches is not understood");
  }
  if (!w->timed && (is_auto || count > 0 || file->branch_time_count > 0)) {
    DEA_TRY(w->ctx,
            dea_finding_add(w->ctx, DEA_ERROR, file->branches.location,
                            "branches need a test in time: a relaxation, cycles, or a rate"));
    return dea_fail(w->ctx, DEA_E_DESIGN, "no test tells of viscosity");
  }
  if (file->branch_time_count > 0 &&
      (is_auto || (is_number && count != (double)file->branch_time_count))) {
    DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_ERROR, file->branches.location,
                                    "branches: '%.40s', but branch_times holds the times of %zu",
                                    text, file->branch_time_count));
    return dea_fail(w->ctx, DEA_E_DESIGN, "the number of branches is given twice");
  }
  if (file->branch_time_count > 0) {
    dea_fit_model_branches(model, file->branch_time_count, w->from_s, w->to_s, file->branch_s);
    return DEA_OK;
  }
  if (is_auto) {
    return find_branches(w, model);
  }
  dea_fit_model_branches(model, is_number ? (size_t)count : 0, fmax(w->from_s, 1e-9),
                         fmax(w->to_s, 1e-8), NULL);
  return DEA_OK;
}

/* Adds the squares of what a fit without some rows says of them. */
static dea_status hold_out(struct work *w, const struct dea_fit_model *model, size_t s, size_t from,
                           size_t to, double *squares, double *shares, size_t *count)
{
  const struct dea_fit_series *series = &w->fit->series[s];
  struct dea_fit_rows rows = all_rows(w->fit);
  struct dea_arena memory = {.ctx = w->ctx};
  struct dea_lsq_problem problem;
  struct dea_lsq_fit fit;
  rows.without = s;
  rows.from = from;
  rows.to = to;
  DEA_TRY(w->ctx, dea_fit_model_solve(w->ctx, model, &rows, &fit));
  double *stress = dea_arena_alloc(&memory, series->rows, sizeof *stress);
  dea_status status = dea_fit_model_stress(&memory, model, series, &problem);
  status = status == DEA_OK ? problem.residual(problem.user, fit.p, stress) : status;
  double most = 0;
  for (size_t i = 0; i < series->rows; i++) {
    most = fmax(most, fabs(series->stress_Pa[i]));
  }
  for (size_t i = from; i < to && status == DEA_OK; i++) {
    const double std = isnan(series->std_Pa[i]) ? w->fit->core.scatter : series->std_Pa[i];
    const double off = stress[i] - series->stress_Pa[i];
    *squares += off * off / (std * std);
    *shares += off * off / (most * most);
    ++*count;
  }
  dea_arena_free(&memory);
  dea_lsq_free(&fit);
  return status;
}

/* Foretells every fitted test from the others; a single one in blocks of a quarter. */
static dea_status hold_out_all(struct work *w, const struct dea_fit_model *model,
                               struct dea_fit_candidate *candidate)
{
  size_t used = 0, count = 0;
  double squares = 0, shares = 0;
  for (size_t s = 0; s < w->fit->series_count; s++) {
    used += dea_fit_series_used(&w->fit->series[s]) ? 1U : 0U;
  }
  for (size_t s = 0; s < w->fit->series_count; s++) {
    const size_t rows = w->fit->series[s].rows, blocks = used > 1 ? 1 : BLOCKS;
    for (size_t b = 0; b < blocks && dea_fit_series_used(&w->fit->series[s]); b++) {
      DEA_TRY(w->ctx, hold_out(w, model, s, b * rows / blocks, (b + 1) * rows / blocks, &squares,
                               &shares, &count));
    }
  }
  candidate->held_out =
      sqrt(squares / (double)count) * (w->fit->core.scale_known ? 1 : SCATTER_SHARE);
  candidate->held_out_share = sqrt(shares / (double)count);
  return DEA_OK;
}

/* Where it ends to be stable, in all three modes to the I1 that the tests reach: a film is
 * stretched in all of them. */
static void find_stability(const struct dea_fit *fit, const struct dea_material *material,
                           struct dea_fit_candidate *candidate)
{
  for (int k = 0; k < DEA_COUPON_MODES; k++) {
    const enum dea_coupon_mode mode = (enum dea_coupon_mode)k;
    const double from =
        dea_fit_unstable_from(material, mode, dea_fit_stretch_as_far(mode, fit->I1_max));
    if (!isnan(from) && !(candidate->unstable_from <= from)) {
      candidate->unstable_mode = mode;
      candidate->unstable_from = from;
    }
  }
}

/* Whether a law is to be taken before the best so far: of two that foretell as well (5 %) the one
 * with fewer parameters; a stable one before one that is not, unless that foretells far better. */
static bool is_better(const struct dea_fit_candidate *candidate,
                      const struct dea_fit_candidate *best)
{
  const bool stable = isnan(candidate->unstable_from), best_stable = isnan(best->unstable_from);
  if (stable != best_stable) {
    return stable ? candidate->held_out < DEA_FIT_STABLE_FACTOR * best->held_out
                  : candidate->held_out * DEA_FIT_STABLE_FACTOR <= best->held_out;
  }
  const bool simpler = candidate->free_count < best->free_count;
  return candidate->held_out < (simpler ? 1.05 : 1 / 1.05) * best->held_out;
}

/* Below 0 a film at rest would be unstable, however well the law follows the tests. */
static dea_status check_rest(struct work *w, const struct dea_material *material)
{
  const double modulus_Pa = material->law->shear_modulus(material->param);
  return modulus_Pa > 0 ? DEA_OK
                        : dea_fail(w->ctx, DEA_E_DOMAIN,
                                   "the shear modulus at rest would be %.4g kPa, and no such "
                                   "film is stable",
                                   1e-3 * modulus_Pa);
}

/* One law, its branches and how well it foretells; a failure is kept with its message. */
static dea_status try_law(struct work *w, const struct dea_label *name, struct dea_fit_model *model,
                          struct dea_material *material, struct dea_fit_candidate *candidate)
{
  struct dea_fit *fit = w->fit;
  struct dea_lsq_fit found;
  const struct dea_fit_rows rows = all_rows(fit);
  *candidate =
      (struct dea_fit_candidate){.held_out = NAN, .held_out_share = NAN, .unstable_from = NAN};
  snprintf(candidate->name, sizeof candidate->name, "%.63s", name->text);
  DEA_TRY(w->ctx,
          dea_fit_model_create(w->ctx, fit->file, name, fit->series, fit->series_count, model));
  DEA_TRY(w->ctx, choose_branches(w, model));
  candidate->free_count = dea_fit_model_free(model);
  candidate->branch_count = model->branch_count;
  DEA_TRY(w->ctx, dea_fit_model_solve(w->ctx, model, &rows, &found));
  candidate->chi2 = found.chi2;
  candidate->aicc = criterion(&found, candidate->free_count, fit->core.scale_known);
  dea_fit_model_material(model, found.p, NULL, material);
  dea_lsq_free(&found);
  DEA_TRY(w->ctx, check_rest(w, material));
  find_stability(fit, material, candidate);
  return fit->file->law_count > 1 ? hold_out_all(w, model, candidate) : DEA_OK;
}

static dea_status choose_law(struct work *w)
{
  struct dea_fit *fit = w->fit;
  bool any = false;
  for (size_t i = 0; i < fit->file->law_count; i++) {
    struct dea_fit_candidate *candidate = &fit->candidates[i],
                             *best = &fit->candidates[fit->chosen];
    struct dea_fit_model model;
    dea_progress(w->ctx, "laws", i, fit->file->law_count);
    fit->candidate_count = i + 1;
    dea_status status = try_law(w, &fit->file->laws[i], &model, &w->materials[i], candidate);
    if (status == DEA_E_MEMORY || status == DEA_E_DESIGN || status == DEA_E_TOOL ||
        fit->file->law_count == 1) {
      DEA_TRY(w->ctx, status);
    }
    if (status != DEA_OK) {
      candidate->failed = true;
      snprintf(candidate->why, sizeof candidate->why, "%.150s", dea_context_message(w->ctx));
      dea_context_clear(w->ctx);
      continue;
    }
    if (!any || is_better(candidate, best)) {
      fit->chosen = i;
      fit->model = model;
      any = true;
    }
  }
  return any ? DEA_OK
             : dea_fail(w->ctx, DEA_E_NOT_CONVERGED, "none of the laws could be fitted; %s: %.150s",
                        fit->candidates[0].name, fit->candidates[0].why);
}

/* Largest difference of other laws that foretell about as well, in modes that no test has. */
static void find_spreads(struct work *w)
{
  struct dea_fit *fit = w->fit;
  const struct dea_material *taken = &w->materials[fit->chosen];
  const double limit = DEA_FIT_STABLE_FACTOR * fit->candidates[fit->chosen].held_out;
  for (int mode = 0; mode < DEA_COUPON_MODES; mode++) {
    struct dea_fit_spread spread = {.mode = (enum dea_coupon_mode)mode};
    double l = dea_fit_stretch_as_far(spread.mode, fit->I1_max);
    const struct dea_coupon coupon = {.mode = spread.mode, .rows = 1, .stretch = &l};
    for (size_t i = 0; i < fit->candidate_count && !fit->stability[mode].measured; i++) {
      double own, other;
      if (i == fit->chosen || fit->candidates[i].failed || !(fit->candidates[i].held_out < limit) ||
          dea_coupon_stress(taken, &coupon, NULL, &own) != DEA_OK ||
          dea_coupon_stress(&w->materials[i], &coupon, NULL, &other) != DEA_OK) {
        continue;
      }
      const double share = fabs(other / own - 1);
      if (share > spread.share) {
        spread.share = share;
        spread.stretch = l;
        snprintf(spread.other, sizeof spread.other, "%s", fit->candidates[i].name);
      }
    }
    if (spread.share > 0) {
      fit->spreads[fit->spread_count++] = spread;
    }
  }
}

/* ---- the law that was chosen ---- */

/* The law that was chosen over all rows. */
static dea_status solve_chosen(void *user)
{
  struct work *w = user;
  const struct dea_fit_rows rows = all_rows(w->fit);
  dea_lsq_free(&w->fit->core.least_squares);
  return dea_fit_model_solve(w->ctx, &w->fit->model, &rows, &w->fit->core.least_squares);
}

/* Parameters and rows of the law that was chosen. */
static void fill_core(struct dea_fit *fit)
{
  struct dea_fit_core *core = &fit->core;
  size_t at = 0;
  core->param_count = fit->model.count;
  memcpy(core->params, fit->model.params, core->param_count * sizeof *core->params);
  for (size_t s = 0; s < fit->series_count; s++) {
    if (dea_fit_series_used(&fit->series[s])) {
      core->groups[core->group_count++] = (struct dea_lsq_group){at, fit->series[s].rows};
      at += fit->series[s].rows;
    }
  }
}

/* p moved along the directions that are not determined to where it is nearest to the start, in
 * scales; false where no direction is open or a bound is in the way. */
static bool draw_near(const struct dea_fit *fit, double *p)
{
  enum { SWEEPS = 20 }; // directions may share parameters
  const struct dea_lsq_statistics *s = &fit->core.statistics;
  const struct dea_fit_param *params = fit->model.params;
  bool open = false, within = true;
  for (size_t k = 0; k < SWEEPS * s->active; k++) {
    const double *d = s->direction + k % s->active * s->params;
    double along = 0, length = 0;
    if (!dea_lsq_is_open(s, k % s->active)) {
      continue;
    }
    open = true;
    for (size_t j = 0; j < s->params; j++) {
      const double share = d[j] / (params[j].scale * params[j].scale);
      along += share * (p[j] - params[j].start);
      length += share * d[j];
    }
    for (size_t j = 0; j < s->params && length > 0; j++) {
      p[j] -= along / length * d[j];
    }
  }
  for (size_t j = 0; j < s->params; j++) {
    within = within && (params[j].fixed || (p[j] >= params[j].low && p[j] <= params[j].high));
  }
  return open && within;
}

/* Of what is not determined the search ends anywhere (c10 + c01 may be 2900 kPa - 2850 kPa): takes
 * the values nearest to the start, where the rows do not notice. */
static dea_status settle_open(struct work *w)
{
  struct dea_fit *fit = w->fit;
  struct dea_lsq_fit *found = &fit->core.least_squares;
  const struct dea_fit_rows rows = all_rows(fit);
  struct dea_arena memory = {.ctx = w->ctx};
  struct dea_lsq_problem problem;
  double p[DEA_LSQ_PARAMS_MAX], chi2 = 0;
  memcpy(p, found->p, found->params * sizeof *p);
  if (!draw_near(fit, p)) {
    return DEA_OK;
  }
  double *r = dea_arena_alloc(&memory, found->rows, sizeof *r);
  dea_status status = dea_arena_status(&memory);
  status = status == DEA_OK ? dea_fit_model_problem(&memory, &fit->model, &rows, &problem) : status;
  if (status == DEA_OK && problem.residual(problem.user, p, r) == DEA_OK) {
    for (size_t i = 0; i < found->rows; i++) {
      chi2 += r[i] * r[i];
    }
    if (chi2 <= found->chi2 + 1e-6 * (1 + found->chi2)) {
      memcpy(found->p, p, found->params * sizeof *p);
      memcpy(found->r, r, found->rows * sizeof *r);
      found->chi2 = chi2;
      status = dea_lsq_jacobian(w->ctx, &problem, p, found->J);
      status = status == DEA_OK ? dea_fit_core_statistics(w->ctx, &fit->core) : status;
    }
  }
  dea_arena_free(&memory);
  return status;
}

static dea_status fill_values(struct work *w, bool all_profiles)
{
  struct dea_fit *fit = w->fit;
  const struct dea_fit_rows rows = all_rows(fit);
  struct dea_lsq_problem problem;
  DEA_TRY(w->ctx, dea_fit_model_problem(&fit->memory, &fit->model, &rows, &problem));
  return dea_fit_core_values(w->ctx, &problem, true, all_profiles, &fit->core);
}

/* Stress of a test at the parameters found, and its standard uncertainty. */
static dea_status fill_curve(struct work *w, const struct dea_fit_series *series,
                             struct dea_fit_curve *curve)
{
  struct dea_fit *fit = w->fit;
  const size_t n = fit->model.count, m = series->rows;
  struct dea_lsq_problem problem;
  curve->series = series;
  curve->stress_Pa = dea_arena_alloc(&fit->memory, m, sizeof *curve->stress_Pa);
  curve->std_Pa = dea_arena_alloc(&fit->memory, m, sizeof *curve->std_Pa);
  double *J = dea_arena_alloc(&fit->memory, m * n, sizeof *J);
  DEA_TRY(w->ctx, dea_fit_model_stress(&fit->memory, &fit->model, series, &problem));
  dea_status status = problem.residual(problem.user, fit->core.least_squares.p, curve->stress_Pa);
  status =
      status == DEA_OK ? dea_lsq_jacobian(w->ctx, &problem, fit->core.least_squares.p, J) : status;
  if (status == DEA_E_DOMAIN) {
    return dea_fail(w->ctx, status, "'%.60s' goes beyond the domain of the law that was found",
                    series->test->name.text);
  }
  DEA_TRY(w->ctx, status);
  double squares = 0;
  for (size_t i = 0; i < m; i++) {
    double slope[DEA_LSQ_PARAMS_MAX];
    for (size_t j = 0; j < n; j++) {
      slope[j] = J[j * m + i];
    }
    curve->std_Pa[i] = dea_lsq_std_of(&fit->core.statistics, slope);
    const double off = curve->stress_Pa[i] - series->stress_Pa[i];
    squares += off * off;
    curve->largest = fmax(curve->largest, fabs(off / series->stress_Pa[i]));
  }
  curve->rms_Pa = sqrt(squares / (double)m); // NAN without measurements
  curve->largest = isnan(curve->rms_Pa) ? NAN : curve->largest;
  return DEA_OK;
}

static dea_status fill_curves(struct work *w)
{
  struct dea_fit *fit = w->fit;
  fit->curves = dea_arena_alloc(&fit->memory, fit->series_count, sizeof *fit->curves);
  DEA_TRY(w->ctx, dea_arena_status(&fit->memory));
  for (size_t s = 0, g = 0; s < fit->series_count; s++) {
    DEA_TRY(w->ctx, fill_curve(w, &fit->series[s], &fit->curves[s]));
    fit->curves[s].lag = fit->curves[s].effective = NAN;
    if (dea_fit_series_used(&fit->series[s])) {
      fit->curves[s].lag = fit->core.statistics.lag[g];
      fit->curves[s].effective = fit->core.statistics.effective[g++];
    }
  }
  return DEA_OK;
}

static dea_status run(struct work *w, bool profiles)
{
  struct dea_fit *fit = w->fit;
  DEA_TRY(w->ctx, check_uncertainties(w));
  DEA_TRY(w->ctx, choose_law(w));
  fill_core(fit);
  DEA_TRY(w->ctx, dea_fit_core_solve(w->ctx, &fit->core, solve_chosen, w));
  DEA_TRY(w->ctx, settle_open(w));
  dea_fit_model_material(&fit->model, fit->core.least_squares.p, NULL, &w->materials[fit->chosen]);
  DEA_TRY(w->ctx, check_rest(w, &w->materials[fit->chosen]));
  DEA_TRY(w->ctx, fill_values(w, profiles));
  DEA_TRY(w->ctx, fill_curves(w));
  dea_fit_identify_weak(&fit->core, "tests");
  dea_fit_identify_stability(fit);
  find_spreads(w);
  DEA_TRY(w->ctx, dea_fit_identify_next(w->ctx, fit));
  dea_fit_core_scatter(&fit->core);
  return DEA_OK;
}

dea_status dea_fit_run(struct dea_context *ctx, const struct dea_fit_file *file,
                       const struct dea_fit_series *series, size_t series_count, bool profiles,
                       struct dea_fit *fit)
{
  struct work w = {.ctx = ctx, .fit = fit};
  *fit = (struct dea_fit){
      .file = file, .series = series, .series_count = series_count, .memory = {.ctx = ctx}};
  return dea_refuse_argument(ctx, file->tests[0].file.location, run(&w, profiles));
}

dea_status dea_fit_file_run(struct dea_context *ctx, const struct dea_fit_file *file, bool profiles,
                            struct dea_fit *fit)
{
  struct dea_arena tests = {.ctx = ctx};
  struct dea_fit_series *series;
  dea_status status = dea_fit_series_read(&tests, file, &series);
  status =
      status == DEA_OK ? dea_fit_run(ctx, file, series, file->test_count, profiles, fit) : status;
  fit->tests = tests;
  return DEA_CHAIN(ctx, status);
}

void dea_fit_free(struct dea_fit *fit)
{
  dea_fit_core_free(&fit->core);
  dea_arena_free(&fit->memory);
  dea_arena_free(&fit->tests);
}
