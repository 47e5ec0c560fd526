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

dea_status dea_compare_set_create(struct dea_context *ctx, const char *reference,
                                  const struct dea_measured *measured,
                                  const struct dea_result *reference_result,
                                  struct dea_compare_set **out)
{
  *out = dea_alloc(ctx, 1, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  snprintf((*out)->reference, sizeof(*out)->reference, "%s", reference);
  (*out)->measured = measured;
  (*out)->reference_result = reference_result;
  return DEA_OK;
}

void dea_compare_set_destroy(struct dea_context *ctx, struct dea_compare_set *set)
{
  if (set == NULL) {
    return;
  }
  for (size_t i = 0; i < set->curve_count; i++) {
    dea_comparison_destroy(ctx, set->curves[i].comparison);
  }
  for (size_t i = 0; i < set->profile_count; i++) {
    dea_film_line_free(ctx, &set->profiles[i].line);
    dea_misfit_free(&set->profiles[i].misfit);
  }
  for (size_t i = 0; i < set->history_count; i++) {
    dea_misfit_free(&set->histories[i].misfit);
  }
  dea_free(ctx, set->profiles);
  dea_free(ctx, set->histories);
  dea_free(ctx, set);
}

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

static dea_status add_curve(struct dea_context *ctx, struct dea_compare_set *set, const char *name,
                            const struct dea_set_curve *what, const char *reference_model)
{
  if (set->curve_count == DEA_SET_CURVES_MAX) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "at most %d curves can be compared at a time; choose some with --model",
                    DEA_SET_CURVES_MAX);
  }
  struct dea_set_curve *curve = &set->curves[set->curve_count];
  *curve = *what;
  curve->reference = set->measured != NULL
                         ? &set->measured->points->curve
                         : reference_curve(set->reference_result, what->model, reference_model);
  if (curve->reference == NULL) {
    return dea_compare_no_model(ctx, set->reference, set->reference_result,
                                reference_model[0] != '\0' ? reference_model : what->model);
  }
  snprintf(curve->name, sizeof curve->name, "%s", name);
  set->curve_count++;
  return DEA_OK;
}

dea_status dea_compare_set_add(struct dea_context *ctx, struct dea_compare_set *set,
                               const char *name, const struct dea_result *result, const char *model,
                               const char *reference_model)
{
  const struct dea_set_curve curve = {
      .result = result, .model = model, .curve = dea_figure_curve(result, model, false)};
  return add_curve(ctx, set, name, &curve, reference_model);
}

dea_status dea_compare_set_add_table(struct dea_context *ctx, struct dea_compare_set *set,
                                     const char *name, const struct dea_curve *table,
                                     const char *reference_model)
{
  const struct dea_set_curve curve = {.model = "", .curve = table};
  return add_curve(ctx, set, name, &curve, reference_model);
}

void dea_compare_set_beside(const struct dea_compare_set *set, size_t curve,
                            char out[DEA_LABEL_SIZE])
{
  bool run = set->measured == NULL;
  snprintf(out, DEA_LABEL_SIZE, "%.60s%s%.60s", set->reference, run ? ", " : "",
           run ? set->curves[curve].reference->model : "");
}

// Quantities against the voltage ------------------------------------------------------------------

static bool is_wanted(int column, const int *columns, size_t count)
{
  for (size_t q = 0; q < count; q++) {
    if (columns[q] == column) {
      return true;
    }
  }
  return count == 0;
}

static const struct dea_misfit *find_misfit(const struct dea_set_curve *curve, int column)
{
  for (size_t i = 0; curve->comparison != NULL && i < curve->comparison->misfit_count; i++) {
    if (curve->comparison->misfits[i].column == column) {
      return &curve->comparison->misfits[i];
    }
  }
  return NULL;
}

/* Says once of which measured quantities a curve has nothing to set beside. */
static dea_status note_missing(struct dea_context *ctx, const struct dea_compare_set *set,
                               const struct dea_set_curve *curve, const int *columns, size_t count)
{
  struct dea_text list = {.ctx = ctx};
  const struct dea_curve *r = curve->reference;
  for (int c = 1; c < dea_column_count(ctx); c++) {
    if (is_wanted(c, columns, count) && dea_points_have(r->points, r->count, c) &&
        find_misfit(curve, c) == NULL) {
      dea_text_add(&list, "%s'%s'", list.length > 0 ? ", " : "", dea_column_at(ctx, c)->header);
    }
  }
  dea_status status = DEA_OK;
  if (list.failed) {
    status = DEA_E_MEMORY;
  } else if (list.length > 0) {
    status = dea_finding_add(ctx, DEA_NOTE, nowhere,
                             "%s has no %s at the voltages of %s and is left out there",
                             curve->name, dea_text_get(&list), set->reference);
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

static dea_status compute_curve(struct dea_context *ctx, const struct dea_compare_set *set,
                                struct dea_set_curve *curve, const int *columns, size_t count)
{
  const struct dea_load_point *std = set->measured != NULL ? set->measured->points->std : NULL;
  if (curve->curve != NULL) {
    dea_status status = dea_compare_curves(ctx, curve->curve, curve->reference, std,
                                           count == 1 ? columns[0] : -1, &curve->comparison);
    if (status == DEA_E_ARGUMENT && !set->pairs) {
      dea_context_clear(ctx); // nothing in common: said below
    } else {
      DEA_TRY(ctx, status);
      dea_comparison_keep(curve->comparison, columns, count);
      if (curve->comparison->part_only) {
        DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, nowhere,
                                     "the voltages of %s go up and down: only its first part was "
                                     "compared",
                                     curve->name));
      }
    }
  }
  if (curve->curve == NULL || (set->measured == NULL && count == 0)) {
    return DEA_OK; // a history only; two runs that need not know the same of everything
  }
  DEA_TRY(ctx, note_missing(ctx, set, curve, columns, count));
  for (size_t i = 0; curve->comparison != NULL && i < curve->comparison->misfit_count; i++) {
    const struct dea_misfit *m = &curve->comparison->misfits[i];
    if (set->measured != NULL) {
      DEA_TRY(ctx, note_few(ctx, curve, m));
    }
    DEA_TRY(ctx, note_sign(ctx, set, curve, m));
  }
  return DEA_OK;
}

/* Fails for a quantity asked for that no curve has. */
static dea_status check_asked(struct dea_context *ctx, const struct dea_compare_set *set,
                              const int *columns, size_t count)
{
  for (size_t q = 0; q < count; q++) {
    bool found = false;
    for (size_t i = 0; i < set->curve_count && !found; i++) {
      found = find_misfit(&set->curves[i], columns[q]) != NULL;
    }
    for (size_t h = 0; h < set->history_count && !found; h++) {
      found = set->histories[h].misfit.column == columns[q];
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
  struct dea_set_profile *p = &set->profiles[set->profile_count];
  *p = (struct dea_set_profile){.curve = curve, .measured = measured, .half = half};
  DEA_TRY(ctx, dea_film_line_make(ctx, set->curves[curve].result, set->curves[curve].model,
                                  m->voltage_V, half, &p->line));
  set->profile_count++; // from here on it is freed with the set
  if (p->line.count > 0) {
    DEA_TRY(ctx,
            dea_film_line_compare(ctx, &p->line, m->x_m, m->z_m, m->z_std_m, m->count, &p->misfit));
  }
  if (p->misfit.count == 0) {
    dea_film_line_free(ctx, &p->line);
    dea_misfit_free(&p->misfit);
    set->profile_count--;
  } else if (p->line.between_records) {
    return dea_finding_add(ctx, DEA_NOTE, nowhere,
                           "the profile of %s at %.4g kV is formed of those at the voltages before "
                           "and behind, linear between them",
                           set->curves[curve].name, 1e-3 * m->voltage_V);
  }
  return DEA_OK;
}

static dea_status compute_profiles(struct dea_context *ctx, struct dea_compare_set *set)
{
  size_t count = set->measured->profile_count;
  if (count == 0) {
    return DEA_OK;
  }
  set->profiles = dea_alloc(ctx, count, DEA_HALVES * set->curve_count * sizeof *set->profiles);
  if (set->profiles == NULL) {
    return DEA_E_MEMORY;
  }
  struct dea_text alone = {.ctx = ctx}; // voltages without a computed profile
  dea_status status = DEA_OK;
  for (size_t m = 0; m < count && status == DEA_OK; m++) {
    size_t before = set->profile_count;
    for (size_t i = 0; i < DEA_HALVES * set->curve_count && status == DEA_OK; i++) {
      status = add_profile(ctx, set, i / DEA_HALVES, m, (enum dea_half)(i % DEA_HALVES));
    }
    if (set->profile_count == before && set->measured->profiles[m].voltage_V != 0.0) {
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

/* Shift of a curve's clock to the measured one. */
static dea_status find_clock(struct dea_context *ctx, const struct dea_measured *measured,
                             const struct dea_set_curve *curve, const struct dea_curve *transient,
                             struct dea_clock_shift *out)
{
  const double *volts = measured->history.values[DEA_MEASURED_VOLTAGE];
  size_t n = transient->count;
  *out = (struct dea_clock_shift){0};
  double *time = dea_alloc(ctx, n, sizeof *time), *voltage = dea_alloc(ctx, n, sizeof *voltage);
  bool good = time != NULL && voltage != NULL;
  for (size_t i = 0; good && i < n; i++) {
    const struct dea_load_point *p = &transient->points[i];
    time[i] = p->time_s;
    voltage[i] = isnan(p->source_voltage_V) ? p->voltage_V : p->source_voltage_V;
  }
  if (good && volts != NULL) {
    dea_clock_shift_find(&(struct dea_voltage_track){time, voltage, n},
                         &(struct dea_voltage_track){measured->history.values[DEA_MEASURED_TIME],
                                                     volts, measured->history.rows},
                         out);
  }
  dea_free(ctx, time);
  dea_free(ctx, voltage);
  if (!good) {
    return DEA_E_MEMORY;
  }
  if (out->edges == 0) {
    return dea_finding_add(ctx, DEA_NOTE, nowhere,
                           "the clocks of %s and of the history measured are taken as they are: %s",
                           curve->name,
                           volts == NULL ? "no voltage was recorded"
                                         : "no pulse of the one is as high as one of the other");
  }
  if (out->shift_s == 0) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_NOTE, nowhere,
                         "the times of %s are moved by %.6g s, which lays %zu of its pulses on "
                         "measured ones",
                         curve->name, out->shift_s, out->edges);
}

static dea_status add_histories(struct dea_context *ctx, struct dea_compare_set *set, size_t curve,
                                const int *columns, size_t count)
{
  const struct dea_csv_columns *history = &set->measured->history;
  const struct dea_set_curve *c = &set->curves[curve];
  const struct dea_curve *transient = dea_result_find(c->result, c->model, "transient");
  struct dea_clock_shift clock;
  if (transient == NULL || transient->count < 2) {
    return DEA_OK;
  }
  DEA_TRY(ctx, find_clock(ctx, set->measured, c, transient, &clock));
  for (size_t k = DEA_MEASURED_QUANTITIES; k < set->measured->history_count; k++) {
    const int column = set->measured->history_column[k];
    if (history->values[k] == NULL || !is_wanted(column, columns, count)) {
      continue;
    }
    struct dea_set_history *h = &set->histories[set->history_count++];
    *h = (struct dea_set_history){.curve = curve, .transient = transient, .clock = clock};
    h->column = k;
    DEA_TRY(ctx,
            dea_compare_history(ctx, transient, column, &clock, history->values[DEA_MEASURED_TIME],
                                history->values[k], history->rows, &h->misfit));
    if (h->misfit.count == 0) {
      dea_misfit_free(&h->misfit);
      set->history_count--;
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, nowhere,
                                   "the history of %s has no '%s' at the times measured", c->name,
                                   dea_column_at(ctx, column)->header));
    }
  }
  return DEA_OK;
}

static dea_status compute_histories(struct dea_context *ctx, struct dea_compare_set *set,
                                    const int *columns, size_t count)
{
  if (set->measured->history.rows == 0) {
    return DEA_OK;
  }
  set->histories =
      dea_alloc(ctx, set->curve_count, set->measured->history_count * sizeof *set->histories);
  if (set->histories == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t i = 0; i < set->curve_count; i++) {
    DEA_TRY(ctx, add_histories(ctx, set, i, columns, count));
  }
  return DEA_OK;
}

dea_status dea_compare_set_compute(struct dea_context *ctx, struct dea_compare_set *set,
                                   const int *columns, size_t count)
{
  size_t found = 0;
  for (size_t i = 0; i < set->curve_count; i++) {
    DEA_TRY(ctx, compute_curve(ctx, set, &set->curves[i], columns, count));
    found += set->curves[i].comparison != NULL ? set->curves[i].comparison->misfit_count : 0;
  }
  if (set->measured != NULL) {
    DEA_TRY(ctx, is_wanted(dea_point_column_find("centre_z_m"), columns, count)
                     ? compute_profiles(ctx, set)
                     : DEA_OK);
    DEA_TRY(ctx, compute_histories(ctx, set, columns, count));
  }
  DEA_TRY(ctx, check_asked(ctx, set, columns, count));
  return found + set->profile_count + set->history_count > 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_ARGUMENT, "the runs have nothing in common with %s",
                        set->reference);
}

const struct dea_misfit *dea_compare_set_worst(const struct dea_compare_set *set, size_t *curve)
{
  const struct dea_misfit *worst = NULL;
  for (size_t i = 0; i < set->curve_count; i++) {
    const struct dea_comparison *c = set->curves[i].comparison;
    for (size_t k = 0; c != NULL && k < c->misfit_count; k++) {
      if (worst == NULL || c->misfits[k].relative_largest > worst->relative_largest) {
        worst = &c->misfits[k];
        *curve = i;
      }
    }
  }
  return worst;
}

// JSON --------------------------------------------------------------------------------------------

static json_t *misfit_json(const struct dea_misfit *m, const char *at_unit, double tolerance)
{
  const struct dea_column *column = m->quantity;
  char at[32];
  json_t *object = json_object();
  snprintf(at, sizeof at, "largest_at_%s", at_unit);
  dea_json_put_text(object, "quantity", column->key);
  dea_json_put_text(object, "unit", column->si_unit);
  dea_json_put_count(object, "points", m->count);
  dea_json_put(object, "rms", m->rms);
  dea_json_put(object, "largest", m->largest);
  dea_json_put(object, at, m->largest_at);
  dea_json_put(object, "bias", m->bias);
  dea_json_put(object, "range", m->range);
  dea_json_put(object, "relative_rms", m->relative_rms);
  dea_json_put(object, "relative_largest", m->relative_largest);
  dea_json_put(object, "a_std_rms", dea_misfit_a_std_rms(m));
  if (m->std_count > 0) {
    dea_json_put_count(object, "std_points", m->std_count);
    dea_json_put(object, "chi_square_per_point", m->chi_square);
    dea_json_put(object, "within_1_std", m->within_1_std);
    dea_json_put(object, "within_2_std", m->within_2_std);
  }
  if (!isnan(tolerance)) {
    json_object_set_new(object, "within", json_boolean(m->relative_largest <= tolerance));
  }
  return object;
}

static json_t *curve_json(const struct dea_compare_set *set, size_t curve, double tolerance)
{
  const struct dea_comparison *comparison = set->curves[curve].comparison;
  json_t *object = json_object(), *quantities = json_array();
  char beside[DEA_LABEL_SIZE];
  dea_compare_set_beside(set, curve, beside);
  dea_json_put_text(object, "a", set->curves[curve].name);
  dea_json_put_text(object, "b", beside);
  for (size_t i = 0; comparison != NULL && i < comparison->misfit_count; i++) {
    json_array_append_new(quantities, misfit_json(&comparison->misfits[i], "V", tolerance));
  }
  json_object_set_new(object, "quantities", quantities);
  return object;
}

json_t *dea_compare_set_json(const struct dea_compare_set *set, double tolerance)
{
  json_t *root = json_object(), *curves = json_array(), *profiles = json_array();
  json_t *histories = json_array();
  json_object_set_new(root, "schema", json_integer(1));
  if (!isnan(tolerance)) {
    dea_json_put(root, "tolerance", tolerance);
  }
  dea_json_put_text(root, "reference", set->reference);
  for (size_t i = 0; i < set->curve_count; i++) {
    json_t *curve = curve_json(set, i, tolerance);
    if (json_array_size(json_object_get(curve, "quantities")) > 0) {
      json_array_append_new(curves, curve);
    } else {
      json_decref(curve); // nothing in common
    }
  }
  for (size_t i = 0; i < set->profile_count; i++) {
    const struct dea_set_profile *p = &set->profiles[i];
    json_t *one = misfit_json(&p->misfit, "m", NAN);
    dea_json_put_text(one, "quantity", "z_m"); // of all of the film
    dea_json_put_text(one, "a", set->curves[p->curve].name);
    if (p->line.directed) {
      dea_json_put_text(one, "half", dea_half_names[p->half]);
    }
    dea_json_put(one, "voltage_V", set->measured->profiles[p->measured].voltage_V);
    json_array_append_new(profiles, one);
  }
  for (size_t i = 0; i < set->history_count; i++) {
    const struct dea_set_history *h = &set->histories[i];
    json_t *one = misfit_json(&h->misfit, "s", NAN);
    dea_json_put_text(one, "a", set->curves[h->curve].name);
    dea_json_put(one, "shift_s", h->clock.shift_s);
    dea_json_put_count(one, "edges", h->clock.edges);
    json_array_append_new(histories, one);
  }
  json_object_set_new(root, "comparisons", curves);
  json_object_set_new(root, "profiles", profiles);
  json_object_set_new(root, "histories", histories);
  return root;
}
