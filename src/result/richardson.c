#include "result/richardson.h"

#include "result/observation.h"

#include <math.h>
#include <string.h>

static const double order_most = 2, order_least = 0.5; // that an estimate is made with
static const double without = 3;    // factor on differences where no order was observed
static const double none = 1e-6;    // of the value: a change that is none
static const double nothing = 1e-6; // of the largest displacement: one that is none
static const double small_motion =
    1e-3; // of the largest motion: one that a free mesh may make of none

/* Solves (h0^p - h1^p) / (h1^p - h2^p) = ratio for p > 0 by bisection; h0 > h1 > h2. The left side
 * rises with p from its limit at 0, ln(h0/h1) / ln(h1/h2). NAN when ratio is not above that. */
static double observed_order(const double h[3], double ratio)
{
  double low = 0, high = 20;
  if (!(ratio > log(h[0] / h[1]) / log(h[1] / h[2]))) {
    return NAN;
  }
  for (int i = 0; i < 60; i++) {
    double p = 0.5 * (low + high), a = pow(h[0] / h[1], p), b = pow(h[2] / h[1], p);
    if ((a - 1) / (1 - b) < ratio) {
      low = p;
    } else {
      high = p;
    }
  }
  return 0.5 * (low + high);
}

static double relative(double difference, double value)
{
  return difference == 0 ? 0 : fabs(difference / value);
}

/* Largest differences to finer meshes, without a limit to compare with. */
static void spread(const double *values, size_t count, double *errors)
{
  for (size_t i = 0; i < count; i++) {
    errors[i] = count > 1 ? 0 : NAN;
    for (size_t k = i + 1 < count ? i + 1 : i - 1; count > 1 && k < count; k++) {
      errors[i] = fmax(errors[i], without * relative(values[k] - values[i], values[count - 1]));
    }
  }
}

enum dea_order_kind dea_richardson(const double *refinement, const double *values, size_t count,
                                   double *order, double *extrapolated, double *errors)
{
  *order = *extrapolated = NAN;
  spread(values, count, errors);
  if (count < 3) {
    return DEA_ORDER_TOO_FEW;
  }
  const double *f = values + count - 3, *n = refinement + count - 3;
  const double h[3] = {exp2(n[1] - n[0]), 1, exp2(n[1] - n[2])}; // over the middle one
  double first = f[0] - f[1], second = f[1] - f[2];
  if (fabs(first) <= none * fabs(f[2]) && fabs(second) <= none * fabs(f[2])) {
    return DEA_ORDER_NO_CHANGE;
  }
  if (!(first * second > 0)) {
    return DEA_ORDER_NOT_MONOTONE;
  }
  *order = observed_order(h, first / second);
  if (isnan(*order)) {
    return DEA_ORDER_NOT_FALLING;
  }
  double p = fmin(fmax(*order, order_least), order_most), rest = pow(h[2], p);
  *extrapolated = f[2] - second * rest / (1 - rest);
  for (size_t i = 0; i < count; i++) {
    errors[i] = relative(values[i] - *extrapolated, *extrapolated);
  }
  return DEA_ORDER_OBSERVED;
}

// Rows -------------------------------------------------------------------------------------------

/* Quantities that are looked at beside monitors: displacements at the probes first. */
static const char *const keys[] = {
    "centre_z_m",         "fibre_tip_z_m", "electrode_edge_u_m", "min_tension_N_per_m",
    "true_field_V_per_m", "energy_J",      "capacitance_F"};
enum { PROBES = 3, KEYS = sizeof keys / sizeof keys[0], HEADLINES_MAX = 32 };

/* The columns of the rows: probes, monitors, and others that meshes are not judged by. */
struct looked {
  int columns[KEYS + HEADLINES_MAX];
  size_t judged, count;
};

/* What a stretch of a monitor is without motion. */
static double rest_of(const struct dea_column *column)
{
  const bool stretch =
      dea_observed_is(column, "stretch") || dea_observed_is(column, "area_stretch");
  return stretch ? 1 : 0;
}

/* A column of the variant's point at a voltage; NAN without such a point. */
static double value_at(const struct dea_variant *variant, double voltage_V, int column)
{
  for (size_t i = 0; i < variant->curve.count; i++) {
    if (variant->curve.points[i].voltage_V == voltage_V) {
      return dea_point_get(&variant->curve.points[i], column);
    }
  }
  return NAN;
}

/* Largest size of a column's value beyond rest on all meshes at a voltage. */
static double largest(const struct dea_convergence *c, double voltage_V, int column, double rest)
{
  double most = 0;
  for (size_t m = 0; m < c->mesh_count; m++) {
    most = fmax(most, fabs(value_at(c->meshes[m], voltage_V, column) - rest)); // not of NAN
  }
  return most;
}

/* What is only noise of a motion: a share of the largest of its unit. */
static double noise(const struct dea_context *ctx, const struct dea_convergence *c,
                    const struct looked *looked, double voltage_V,
                    const struct dea_convergence_row *row)
{
  double most = 0;
  for (size_t k = 0; k < looked->judged; k++) {
    const struct dea_column *other = dea_column_at(ctx, looked->columns[k]);
    if (strcmp(other->si_unit, row->shown->si_unit) == 0) {
      most = fmax(most, largest(c, voltage_V, looked->columns[k], rest_of(other)));
    }
  }
  return (row->column < DEA_LOAD_POINT_COLUMNS ? nothing : small_motion) * most;
}

/* Fills a row; false when no mesh has a value, or none but noise. */
static bool fill_row(const struct dea_context *ctx, const struct dea_convergence *c,
                     const struct looked *looked, double voltage_V, size_t k,
                     struct dea_convergence_row *row)
{
  double refinement[DEA_CONVERGENCE_MESHES_MAX], values[DEA_CONVERGENCE_MESHES_MAX];
  double errors[DEA_CONVERGENCE_MESHES_MAX];
  size_t where[DEA_CONVERGENCE_MESHES_MAX], count = 0;
  *row = (struct dea_convergence_row){.column = looked->columns[k],
                                      .shown = dea_column_at(ctx, looked->columns[k]),
                                      .judged = k < looked->judged,
                                      .voltage_V = voltage_V};
  const double rest = rest_of(row->shown);
  for (size_t m = 0; m < c->mesh_count; m++) {
    row->values[m] = value_at(c->meshes[m], voltage_V, row->column);
    row->errors[m] = NAN;
    if (!isnan(row->values[m])) {
      refinement[count] = c->meshes[m]->refinement;
      values[count] = row->values[m] - rest;
      where[count++] = m;
    }
  }
  if (!(largest(c, voltage_V, row->column, rest) >
        (row->judged ? noise(ctx, c, looked, voltage_V, row) : 0))) {
    return false;
  }
  row->kind = dea_richardson(refinement, values, count, &row->order, &row->extrapolated, errors);
  row->extrapolated += rest;
  for (size_t i = 0; i < count; i++) {
    row->errors[where[i]] = errors[i];
  }
  return true;
}

/* Points of the mesh that came furthest: its voltages are those of the rows. */
static const struct dea_curve *longest(const struct dea_convergence *c)
{
  const struct dea_curve *best = &c->meshes[0]->curve;
  for (size_t m = 1; m < c->mesh_count; m++) {
    best = c->meshes[m]->curve.count > best->count ? &c->meshes[m]->curve : best;
  }
  return best;
}

static struct looked inspect(const struct dea_context *ctx, const struct dea_convergence *c)
{
  struct looked out = {.judged = 0};
  const struct dea_curve *finest = &c->meshes[c->mesh_count - 1]->curve;
  for (int k = 0; k < PROBES; k++) {
    out.columns[k] = dea_point_column_find(keys[k]);
  }
  out.judged = PROBES + dea_curve_headlines(ctx, finest, out.columns + PROBES, HEADLINES_MAX);
  out.count = out.judged;
  for (int k = PROBES; k < KEYS; k++) {
    out.columns[out.count++] = dea_point_column_find(keys[k]);
  }
  return out;
}

dea_status dea_convergence_create(struct dea_context *ctx, const struct dea_result *result,
                                  const char *model, struct dea_convergence **out)
{
  struct dea_convergence found = {.tolerance = result->convergence_tolerance};
  *out = NULL;
  for (size_t i = 0; i < result->variant_count; i++) {
    if (dea_variant_is(&result->variants[i], model, "convergence")) {
      if (found.mesh_count == DEA_CONVERGENCE_MESHES_MAX) {
        return dea_fail(ctx, DEA_E_ARGUMENT, "a study of convergence has at most %d meshes",
                        DEA_CONVERGENCE_MESHES_MAX);
      }
      found.meshes[found.mesh_count++] = &result->variants[i];
    }
  }
  if (found.mesh_count == 0) {
    return DEA_OK;
  }
  const struct dea_curve *curve = longest(&found);
  const struct looked looked = inspect(ctx, &found);
  struct dea_convergence *made = dea_alloc(ctx, 1, sizeof *made);
  found.rows = dea_alloc(ctx, looked.count * curve->count, sizeof *found.rows);
  if (made == NULL || found.rows == NULL) {
    dea_free(ctx, made);
    dea_free(ctx, found.rows);
    return DEA_E_MEMORY;
  }
  for (size_t i = 0; i < curve->count; i++) {
    for (size_t k = 0; k < looked.count; k++) {
      found.row_count += fill_row(ctx, &found, &looked, curve->points[i].voltage_V, k,
                                  &found.rows[found.row_count]);
    }
  }
  *made = found;
  *out = made;
  return DEA_OK;
}

void dea_convergence_destroy(struct dea_context *ctx, struct dea_convergence *convergence)
{
  if (convergence != NULL) {
    dea_free(ctx, convergence->rows);
    dea_free(ctx, convergence);
  }
}

// What follows -----------------------------------------------------------------------------------

size_t dea_convergence_enough(const struct dea_convergence *convergence, double voltage_V)
{
  size_t enough = 0, probes = 0;
  for (size_t i = 0; i < convergence->row_count; i++) {
    const struct dea_convergence_row *row = &convergence->rows[i];
    if (row->voltage_V != voltage_V || !row->judged) {
      continue;
    }
    probes++;
    for (size_t m = 0; m < convergence->mesh_count; m++) {
      bool good = row->errors[m] <= convergence->tolerance;
      enough = !good && m + 1 > enough ? m + 1 : enough;
    }
  }
  return probes > 0 ? enough : convergence->mesh_count;
}

const char *dea_order_text(enum dea_order_kind kind)
{
  static const char *const texts[] = {
      [DEA_ORDER_OBSERVED] = "",
      [DEA_ORDER_NO_CHANGE] = "",
      [DEA_ORDER_NOT_MONOTONE] = "not monotone: no order",
      [DEA_ORDER_NOT_FALLING] = "changes do not fall: no order",
      [DEA_ORDER_TOO_FEW] = "fewer than three meshes: no order",
  };
  return texts[kind];
}

/* Names the displacements at a voltage for which no order was observed. */
static void add_doubts(const struct dea_convergence *c, double voltage_V, struct dea_text *out)
{
  const char *before = "; ";
  for (size_t i = 0; i < c->row_count; i++) {
    const struct dea_convergence_row *row = &c->rows[i];
    if (row->voltage_V == voltage_V && row->judged && dea_order_text(row->kind)[0] != '\0') {
      dea_text_add(out, "%s%s: %s", before, row->shown->header, dea_order_text(row->kind));
      before = ", ";
    }
  }
}

/* Largest error of a mesh in the displacements at a voltage. */
static double worst_error(const struct dea_convergence *c, double voltage_V, size_t mesh)
{
  double worst = 0;
  for (size_t i = 0; i < c->row_count; i++) {
    if (c->rows[i].voltage_V == voltage_V && c->rows[i].judged) {
      worst = fmax(worst, c->rows[i].errors[mesh]);
    }
  }
  return worst;
}

static void add_sentence(const struct dea_convergence *c, double voltage_V, struct dea_text *out)
{
  size_t enough = dea_convergence_enough(c, voltage_V), last = c->mesh_count - 1;
  double percent = 100 * c->tolerance;
  dea_text_add(out, "%.4g kV: ", 1e-3 * voltage_V);
  if (enough <= last) {
    dea_text_add(out, "%s is enough for %.3g %%, at an estimated error of %.2g %%",
                 c->meshes[enough]->name, percent, 100 * worst_error(c, voltage_V, enough));
  } else {
    dea_text_add(out, "no mesh is shown to be within %.3g %%, %s has an estimated error of %.2g %%",
                 percent, c->meshes[last]->name, 100 * worst_error(c, voltage_V, last));
  }
  add_doubts(c, voltage_V, out);
  dea_text_add(out, "\n");
}

void dea_convergence_verdict(const struct dea_convergence *convergence, struct dea_text *out)
{
  double last = NAN;
  for (size_t i = 0; i < convergence->row_count; i++) {
    double voltage_V = convergence->rows[i].voltage_V;
    if (voltage_V != last && convergence->rows[i].judged) {
      add_sentence(convergence, voltage_V, out);
      last = voltage_V;
    }
  }
}
