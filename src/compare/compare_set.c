#include "compare/compare_set.h"

#include "figures/run_figures.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const dea_half_names[DEA_HALVES] = {
    [DEA_HALF_FIBRE] = "along a fibre",
    [DEA_HALF_BETWEEN] = "between fibres",
};

static const struct dea_location nowhere = {"", 0, 0};

/* Curve of the reference run: of the model asked for, of the same, or its first. */
static const struct dea_curve *reference_curve(const struct dea_result *result, const char *model,
                                               const char *asked)
{
  const char *models[DEA_DESIGN_MODELS_MAX];
  const struct dea_curve *curve = dea_figure_curve(result, asked[0] != '\0' ? asked : model, false);
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  return curve != NULL || asked[0] != '\0' || count == 0
             ? curve
             : dea_figure_curve(result, models[0], false);
}

dea_status dea_compare_no_model(struct dea_context *ctx, const char *name,
                                const struct dea_result *result, const char *model)
{
  struct dea_text all = {.ctx = ctx};
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    dea_text_add(&all, "%s%s", m > 0 ? ", " : "", models[m]);
  }
  dea_status status =
      count == 0 ? dea_fail(ctx, DEA_E_ARGUMENT, "%s has no points", name)
                 : dea_fail(ctx, DEA_E_ARGUMENT, "%s has no curve of model '%s' (it has: %s)", name,
                            model, dea_text_get(&all));
  dea_text_free(&all);
  return status;
}

dea_status dea_compare_set_add(struct dea_context *ctx, struct dea_compare_set *set,
                               const struct dea_set_curve *what, const char *reference_model)
{
  if (set->curve_count == DEA_SET_CURVES_MAX) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "at most %d curves can be compared at a time; choose some with --model",
                    DEA_SET_CURVES_MAX);
  }
  struct dea_set_curve *curve = &set->curves[set->curve_count];
  *curve = *what;
  if (what->result != NULL) {
    curve->curve = dea_figure_curve(what->result, what->model, false);
  }
  curve->reference = set->measured != NULL
                         ? &set->measured->points->curve
                         : reference_curve(set->reference_result, what->model, reference_model);
  if (curve->reference == NULL) {
    return dea_compare_no_model(ctx, set->reference, set->reference_result,
                                reference_model[0] != '\0' ? reference_model : what->model);
  }
  set->curve_count++;
  return DEA_OK;
}

void dea_compare_set_beside(const struct dea_compare_set *set, size_t curve,
                            char out[DEA_LABEL_SIZE])
{
  bool run = set->measured == NULL;
  snprintf(out, DEA_LABEL_SIZE, "%.60s%s%.60s", set->reference, run ? ", " : "",
           run ? set->curves[curve].reference->model : "");
}

// Quantities against the voltage ------------------------------------------------------------------

const struct dea_misfit *dea_compare_set_find(const struct dea_compare_set *set, size_t curve,
                                              int column)
{
  for (size_t i = 0; i < set->misfit_count; i++) {
    const struct dea_set_misfit *m = &set->misfits[i];
    if (m->kind == DEA_SET_VOLTAGE && m->curve == curve && m->misfit.column == column) {
      return &m->misfit;
    }
  }
  return NULL;
}

/* Says once of which measured quantities a curve has nothing to set beside. */
static dea_status note_missing(struct dea_context *ctx, const struct dea_compare_set *set,
                               size_t curve, const int *columns, size_t count)
{
  struct dea_text list = {.ctx = ctx};
  const struct dea_curve *r = set->curves[curve].reference;
  for (int c = 1; c < dea_column_count(ctx); c++) {
    if (dea_column_is_wanted(c, columns, count) && dea_points_have(r->points, r->count, c) &&
        dea_compare_set_find(set, curve, c) == NULL) {
      dea_text_add(&list, "%s'%s'", list.length > 0 ? ", " : "", dea_column_at(ctx, c)->header);
    }
  }
  dea_status status = DEA_OK;
  if (list.failed) {
    status = DEA_E_MEMORY;
  } else if (list.length > 0) {
    status = dea_finding_add(ctx, DEA_NOTE, nowhere,
                             "%s has no %s at the voltages of %s and is left out there",
                             set->curves[curve].name, dea_text_get(&list), set->reference);
  }
  dea_text_free(&list);
  return status;
}

static dea_status note_few(struct dea_context *ctx, const struct dea_set_curve *curve,
                           const struct dea_misfit *m)
{
  size_t measured = 0;
  for (size_t k = 0; k < curve->reference->count; k++) {
    measured += isnan(dea_point_get(&curve->reference->points[k], m->column)) ? 0U : 1U;
  }
  return m->count == measured
             ? DEA_OK
             : dea_finding_add(ctx, DEA_NOTE, nowhere,
                               "%zu of %zu measured points of '%s' lie outside the voltages of %s "
                               "and are left out of its misfit",
                               measured - m->count, measured, m->quantity->header, curve->name);
}

/* Whether a and b point to different sides where b is largest. */
static bool signs_differ(const struct dea_misfit *m)
{
  size_t most = 0;
  for (size_t i = 0; i < m->count; i++) {
    most = fabs(m->b[i]) > fabs(m->b[most]) ? i : most;
  }
  return m->a[most] * m->b[most] < 0.0;
}

static dea_status note_sign(struct dea_context *ctx, const struct dea_compare_set *set,
                            const struct dea_set_curve *curve, const struct dea_misfit *m)
{
  const char *key = m->quantity->key;
  bool is_z = strcmp(key, "centre_z_m") == 0 || strcmp(key, "fibre_tip_z_m") == 0;
  if (!is_z || !signs_differ(m)) {
    return DEA_OK;
  }
  bool lumped = strcmp(curve->model, "lumped") == 0;
  return dea_finding_add(ctx, DEA_NOTE, nowhere,
                         "%s of %s and of %s have opposite signs; nothing was turned round: z is "
                         "positive towards the fibres%s",
                         m->quantity->header, curve->name, set->reference,
                         lumped ? ", and model lumped, an upper bound, predicts no sign"
                                : "; was the sensor on the other side?");
}

static dea_status compute_curve(struct dea_context *ctx, struct dea_compare_set *set, size_t number,
                                const int *columns, size_t count)
{
  const struct dea_set_curve *curve = &set->curves[number];
  const struct dea_load_point *std = set->measured != NULL ? set->measured->points->std : NULL;
  struct dea_comparison found = {0};
  if (curve->curve == NULL) {
    return DEA_OK; // a history only
  }
  dea_status status =
      dea_compare_curves(&set->memory, curve->curve, curve->reference, std, columns, count, &found);
  if (status == DEA_E_ARGUMENT && !set->pairs) {
    dea_context_clear(ctx); // nothing in common: said below
  } else {
    DEA_TRY(ctx, status);
  }
  if (found.misfit_count > 0 && found.part_only) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, nowhere,
                                 "the voltages of %s go up and down: only its first part was "
                                 "compared",
                                 curve->name));
  }
  for (size_t i = 0; i < found.misfit_count; i++) {
    set->misfits[set->misfit_count++] =
        (struct dea_set_misfit){.curve = number, .misfit = found.misfits[i]};
  }
  if (set->measured == NULL && count == 0) {
    return DEA_OK; // two runs that need not know the same of everything
  }
  DEA_TRY(ctx, note_missing(ctx, set, number, columns, count));
  for (size_t i = 0; i < found.misfit_count; i++) {
    DEA_TRY(ctx, set->measured != NULL ? note_few(ctx, curve, &found.misfits[i]) : DEA_OK);
    DEA_TRY(ctx, note_sign(ctx, set, curve, &found.misfits[i]));
  }
  return DEA_OK;
}

/* Fails for a quantity asked for that no curve has. */
static dea_status check_asked(struct dea_context *ctx, const struct dea_compare_set *set,
                              const int *columns, size_t count)
{
  for (size_t q = 0; q < count; q++) {
    bool found = false;
    for (size_t i = 0; i < set->misfit_count; i++) {
      const struct dea_set_misfit *m = &set->misfits[i];
      found = found || (m->kind != DEA_SET_PROFILE && m->misfit.column == columns[q]);
    }
    if (!found) {
      return dea_fail(ctx, DEA_E_ARGUMENT, "no curve has %s in common with %s",
                      dea_column_at(ctx, columns[q])->key, set->reference);
    }
  }
  return DEA_OK;
}

// Profiles ----------------------------------------------------------------------------------------

/* Adds a model's line of one half beside a measured profile, if it has one. */
static dea_status add_profile(struct dea_context *ctx, struct dea_compare_set *set, size_t curve,
                              size_t measured, enum dea_half half)
{
  const struct dea_measured_profile *m = &set->measured->profiles[measured];
  struct dea_set_misfit *p = &set->misfits[set->misfit_count];
  *p = (struct dea_set_misfit){
      .kind = DEA_SET_PROFILE, .curve = curve, .measured = measured, .half = half};
  DEA_TRY(ctx, dea_film_line_build(&set->memory, set->curves[curve].result,
                                   set->curves[curve].model, m->voltage_V, half, &p->line));
  DEA_TRY(ctx, dea_film_line_compare(&set->memory, &p->line, &m->z, &p->misfit));
  set->misfit_count += p->misfit.count > 0 ? 1U : 0U;
  return p->misfit.count == 0 || !p->line.between_records
             ? DEA_OK
             : dea_finding_add(ctx, DEA_NOTE, nowhere,
                               "the profile of %s at %.4g kV is formed of those at the voltages "
                               "before and behind, linear between them",
                               set->curves[curve].name, 1e-3 * m->voltage_V);
}

static dea_status compute_profiles(struct dea_context *ctx, struct dea_compare_set *set)
{
  struct dea_text alone = {.ctx = ctx}; // voltages without a computed profile
  dea_status status = DEA_OK;
  for (size_t m = 0; m < set->measured->profile_count && status == DEA_OK; m++) {
    size_t before = set->misfit_count;
    for (size_t i = 0; i < DEA_HALVES * set->curve_count && status == DEA_OK; i++) {
      status = add_profile(ctx, set, i / DEA_HALVES, m, (enum dea_half)(i % DEA_HALVES));
    }
    if (set->misfit_count == before && set->measured->profiles[m].voltage_V != 0.0) {
      dea_text_add(&alone, "%s%.4g", alone.length > 0 ? ", " : "",
                   1e-3 * set->measured->profiles[m].voltage_V);
    }
  }
  if (status == DEA_OK && alone.failed) {
    status = DEA_E_MEMORY;
  } else if (status == DEA_OK && alone.length > 0) {
    status = dea_finding_add(ctx, DEA_NOTE, nowhere,
                             "no run has a profile out of the plane at %s kV: what was measured "
                             "there is left out",
                             dea_text_get(&alone));
  }
  dea_text_free(&alone);
  return status;
}

// Histories ---------------------------------------------------------------------------------------

struct dea_samples dea_measured_history(const struct dea_measured *measured, size_t column)
{
  const struct dea_csv_columns *h = &measured->history;
  return (struct dea_samples){h->rows, h->values[DEA_MEASURED_TIME], h->values[column], NULL};
}

/* Shift of a curve's clock to the measured one. */
static dea_status find_clock(struct dea_context *ctx, struct dea_compare_set *set,
                             const struct dea_set_curve *curve, const struct dea_curve *transient,
                             struct dea_clock_shift *out)
{
  const struct dea_samples measured = dea_measured_history(set->measured, DEA_MEASURED_VOLTAGE);
  const int source = dea_point_column_find("source_voltage_V");
  const int column = dea_points_have(transient->points, transient->count, source)
                         ? source
                         : dea_point_column_find("voltage_V");
  struct dea_samples computed;
  *out = (struct dea_clock_shift){0};
  DEA_TRY(ctx, dea_samples_of_curve(&set->memory, transient, NULL, column, DEA_BY_TIME, &computed));
  if (measured.value != NULL) {
    dea_clock_shift_find(&computed, &measured, out);
  }
  if (out->edges == 0) {
    return dea_finding_add(
        ctx, DEA_NOTE, nowhere,
        "the clocks of %s and of the history measured are taken as they are: %s", curve->name,
        measured.value == NULL ? "no voltage was recorded"
                               : "no pulse of the one is as high as one of the other");
  }
  return out->shift_s == 0
             ? DEA_OK
             : dea_finding_add(ctx, DEA_NOTE, nowhere,
                               "the times of %s are moved by %.6g s, which lays %zu of its pulses "
                               "on measured ones",
                               curve->name, out->shift_s, out->edges);
}

dea_status dea_compare_set_transient(const struct dea_set_misfit *history, int column,
                                     struct dea_arena *memory, struct dea_samples *out)
{
  DEA_TRY(memory->ctx,
          dea_samples_of_curve(memory, history->transient, NULL, column, DEA_BY_TIME, out));
  for (size_t i = 0; i < out->count; i++) {
    out->at[i] += history->clock.shift_s;
  }
  return DEA_OK;
}

static dea_status add_histories(struct dea_context *ctx, struct dea_compare_set *set, size_t curve,
                                const int *columns, size_t count)
{
  const struct dea_set_curve *c = &set->curves[curve];
  const struct dea_curve *transient =
      set->measured->history.rows > 0 ? dea_result_find(c->result, c->model, "transient") : NULL;
  struct dea_clock_shift clock;
  if (transient == NULL || transient->count < 2) {
    return DEA_OK;
  }
  DEA_TRY(ctx, find_clock(ctx, set, c, transient, &clock));
  for (size_t k = DEA_MEASURED_QUANTITIES; k < set->measured->history_count; k++) {
    const int column = set->measured->history_column[k];
    const struct dea_samples measured = dea_measured_history(set->measured, k);
    if (measured.value == NULL || !dea_column_is_wanted(column, columns, count)) {
      continue;
    }
    struct dea_set_misfit *h = &set->misfits[set->misfit_count];
    struct dea_samples computed;
    *h = (struct dea_set_misfit){.kind = DEA_SET_HISTORY,
                                 .curve = curve,
                                 .measured = k,
                                 .transient = transient,
                                 .clock = clock};
    DEA_TRY(ctx, dea_compare_set_transient(h, column, &set->memory, &computed));
    DEA_TRY(ctx, dea_misfit_compute(&set->memory, column, &computed, &measured,
                                    &(struct dea_reading){.jump = clock.resolution_s}, &h->misfit));
    set->misfit_count += h->misfit.count > 0 ? 1U : 0U;
    DEA_TRY(ctx, h->misfit.count > 0
                     ? DEA_OK
                     : dea_finding_add(ctx, DEA_NOTE, nowhere,
                                       "the history of %s has no '%s' at the times measured",
                                       c->name, dea_column_at(ctx, column)->header));
  }
  return DEA_OK;
}

dea_status dea_compare_set_compute(struct dea_context *ctx, struct dea_compare_set *set,
                                   const int *columns, size_t count)
{
  const struct dea_measured *m = set->measured;
  const size_t others = m != NULL ? DEA_HALVES * m->profile_count + m->history_count : 0;
  set->misfits = dea_arena_alloc(&set->memory, (size_t)dea_column_count(ctx) + others + 1,
                                 set->curve_count * sizeof *set->misfits);
  DEA_TRY(ctx, dea_arena_status(&set->memory));
  for (size_t i = 0; i < set->curve_count; i++) {
    DEA_TRY(ctx, compute_curve(ctx, set, i, columns, count));
  }
  if (m != NULL && dea_column_is_wanted(dea_point_column_find("centre_z_m"), columns, count)) {
    DEA_TRY(ctx, compute_profiles(ctx, set));
  }
  for (size_t i = 0; m != NULL && i < set->curve_count; i++) {
    DEA_TRY(ctx, add_histories(ctx, set, i, columns, count));
  }
  DEA_TRY(ctx, check_asked(ctx, set, columns, count));
  return set->misfit_count > 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_ARGUMENT, "the runs have nothing in common with %s",
                        set->reference);
}

const struct dea_set_misfit *dea_compare_set_worst(const struct dea_compare_set *set)
{
  const struct dea_set_misfit *worst = NULL;
  for (size_t i = 0; i < set->misfit_count && set->misfits[i].kind == DEA_SET_VOLTAGE; i++) {
    const struct dea_set_misfit *m = &set->misfits[i];
    if (worst == NULL || m->misfit.relative_largest > worst->misfit.relative_largest) {
      worst = m;
    }
  }
  return worst;
}

// JSON --------------------------------------------------------------------------------------------

/* tolerance: NAN for none. */
static json_t *misfit_json(const struct dea_compare_set *set, const struct dea_set_misfit *of,
                           double tolerance)
{
  static const char *const places[] = {"largest_at_V", "largest_at_m", "largest_at_s"};
  const struct dea_misfit *m = &of->misfit;
  json_t *object = json_object();
  dea_json_add_text(object, "quantity", of->kind == DEA_SET_PROFILE ? "z_m" : m->quantity->key);
  dea_json_add_text(object, "unit", m->quantity->si_unit);
  dea_json_add_count(object, "points", m->count);
  dea_json_add(object, "rms", m->rms);
  dea_json_add(object, "largest", m->largest);
  dea_json_add(object, places[of->kind], m->largest_at);
  dea_json_add(object, "bias", m->bias);
  dea_json_add(object, "range", m->range);
  dea_json_add(object, "relative_rms", m->relative_rms);
  dea_json_add(object, "relative_largest", m->relative_largest);
  dea_json_add(object, "a_std_rms", dea_misfit_a_std_rms(m));
  if (m->std_count > 0) {
    dea_json_add_count(object, "std_points", m->std_count);
    dea_json_add(object, "chi_square_per_point", m->chi_square);
    dea_json_add(object, "within_1_std", m->within_1_std);
    dea_json_add(object, "within_2_std", m->within_2_std);
  }
  if (of->kind == DEA_SET_VOLTAGE) {
    if (!isnan(tolerance)) {
      json_object_set_new(object, "within", json_boolean(m->relative_largest <= tolerance));
    }
    return object;
  }
  dea_json_add_text(object, "a", set->curves[of->curve].name);
  if (of->kind == DEA_SET_HISTORY) {
    dea_json_add(object, "shift_s", of->clock.shift_s);
    dea_json_add_count(object, "edges", of->clock.edges);
    return object;
  }
  if (of->line.directed) {
    dea_json_add_text(object, "half", dea_half_names[of->half]);
  }
  dea_json_add(object, "voltage_V", set->measured->profiles[of->measured].voltage_V);
  return object;
}

json_t *dea_compare_set_json(const struct dea_compare_set *set, double tolerance)
{
  json_t *root = json_object(), *curves = json_array(), *quantities = NULL;
  json_t *others[] = {[DEA_SET_PROFILE] = json_array(), [DEA_SET_HISTORY] = json_array()};
  json_object_set_new(root, "schema", json_integer(1));
  if (!isnan(tolerance)) {
    dea_json_add(root, "tolerance", tolerance);
  }
  dea_json_add_text(root, "reference", set->reference);
  for (size_t i = 0; i < set->misfit_count; i++) {
    const struct dea_set_misfit *m = &set->misfits[i];
    if (m->kind == DEA_SET_VOLTAGE && (i == 0 || m->curve != set->misfits[i - 1].curve)) {
      char beside[DEA_LABEL_SIZE];
      json_t *curve = dea_json_append(curves);
      dea_compare_set_beside(set, m->curve, beside);
      dea_json_add_text(curve, "a", set->curves[m->curve].name);
      dea_json_add_text(curve, "b", beside);
      quantities = dea_json_add_list(curve, "quantities");
    }
    json_array_append_new(m->kind == DEA_SET_VOLTAGE ? quantities : others[m->kind],
                          misfit_json(set, m, tolerance));
  }
  json_object_set_new(root, "comparisons", curves);
  json_object_set_new(root, "profiles", others[DEA_SET_PROFILE]);
  json_object_set_new(root, "histories", others[DEA_SET_HISTORY]);
  return root;
}
