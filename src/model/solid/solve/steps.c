/* From one equilibrium to the next: prediction, multipliers, smaller steps. */
#include "model/solid/solve/internal.h"

#include <math.h>
#include <string.h>

enum { OUTER_MAX = 30 };

static const double theta_small = 1e-7;       // of J - 1
static const double step_smallest = 1.0 / 64; // of the way asked for
static const double factor_largest = 2.5;     // of the last way, for an extrapolation

/* A start for the next controls from the last two equilibria: displacements and multipliers go on
 * as they did, with V^2. Nothing changes when that leads too far, or an element would be inverted.
 */
static void extrapolate(struct dea_solid *s, const double *next)
{
  const struct dea_solid_path *path = &s->path;
  double factor, energy;
  if (path->solved < 2 ||
      !dea_solid_controls_extend(s, path->controls_before, path->controls, next, &factor) ||
      !(fabs(factor) <= factor_largest)) {
    return;
  }
  for (size_t i = 0; i < s->dofs; i++) {
    s->trial[i] = s->u[i] + factor * (s->u[i] - path->before[i]);
  }
  if (dea_solid_energy(s, s->trial, s->voltage_V, &energy) != DEA_OK) {
    return;
  }
  memcpy(s->u, s->trial, s->dofs * sizeof(double));
  const double *before = path->before + s->dofs;
  size_t pressures = dea_solid_pressure_count(s);
  for (size_t i = 0; i < pressures; i++) {
    s->multiplier[i] += factor * (s->multiplier[i] - before[i]);
  }
  before += pressures;
  for (size_t i = 0; i < s->load_count; before += s->loads[i].multiplier_count, i++) {
    for (size_t k = 0; k < s->loads[i].multiplier_count; k++) {
      s->loads[i].multiplier[k] += factor * (s->loads[i].multiplier[k] - before[k]);
    }
  }
}

/* Minima at multipliers that follow, until the constraints hold. */
static dea_status outer_loop(struct dea_context *ctx, struct dea_solid *s,
                             struct dea_solid_report *report)
{
  for (int i = 0; i < OUTER_MAX; i++) {
    DEA_TRY(ctx, dea_solid_minimise(ctx, s, s->voltage_V, report));
    report->theta_max = dea_solid_update_multipliers(s);
    report->load_error = 0;
    for (size_t k = 0; k < s->load_count; k++) {
      if (s->loads[k].update != NULL) {
        report->load_error = fmax(report->load_error, s->loads[k].update(s->loads[k].self, s->u));
      }
    }
    if (report->theta_max < theta_small && report->load_error <= 1) {
      return DEA_OK;
    }
  }
  if (report->load_error > 1) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED,
                    "a constraint is violated %.2g times as much as allowed", report->load_error);
  }
  return DEA_OK;
}

/* The equilibrium a share of the way to the goal; the solid stays as it was when it fails. */
static dea_status solve_at(struct dea_context *ctx, struct dea_solid *s, double way,
                           struct dea_solid_report *report)
{
  struct dea_solid_path *path = &s->path;
  const double *from = path->controls_from;
  double *next = path->at;
  for (size_t i = 0; i < path->control_count; i++) {
    next[i] =
        way >= 1 ? path->controls_goal[i] : from[i] + way * (path->controls_goal[i] - from[i]);
  }
  dea_solid_state_get(s, path->keep);
  dea_solid_controls_set(s, next);
  extrapolate(s, next);
  dea_status status = DEA_OK;
  if (dea_solid_controls_drive(s, next)) {
    status = dea_solid_drive(ctx, s, s->voltage_V, report);
  }
  if (status == DEA_OK) {
    status = outer_loop(ctx, s, report);
  }
  if (status != DEA_OK) {
    dea_solid_state_set(s, path->keep);
    dea_solid_controls_set(s, path->controls);
    return status;
  }
  memcpy(path->before, path->keep, path->state_count * sizeof(double));
  memcpy(path->controls_before, path->controls, path->control_count * sizeof(double));
  memcpy(path->controls, next, path->control_count * sizeof(double));
  path->solved += path->solved < 2;
  return DEA_OK;
}

static dea_status go(struct dea_context *ctx, struct dea_solid *s, struct dea_solid_report *report)
{
  const struct dea_solid_path *path = &s->path;
  bool moves = memcmp(path->controls_from, path->controls_goal,
                      path->control_count * sizeof *path->controls_from) != 0;
  double part = 1;
  for (;;) {
    double way = report->way + part >= 1 - 1e-9 ? 1 : report->way + part;
    dea_status status = solve_at(ctx, s, way, report);
    if (status == DEA_OK) {
      report->way = way;
      if (way >= 1) {
        return DEA_OK;
      }
    } else {
      part /= 2;
      if (status == DEA_E_MEMORY || !moves || part < step_smallest) {
        return status;
      }
    }
  }
}

dea_status dea_solid_solve(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                           struct dea_solid_report *report)
{
  struct dea_solid_path *path = &s->path;
  *report = (struct dea_solid_report){0};
  DEA_TRY(ctx, dea_solid_check(ctx, s));
  DEA_TRY(ctx, dea_solid_agree(ctx, s, dea_solid_path_prepare(ctx, s)));
  dea_solid_controls_get(s, path->controls);
  dea_solid_controls_goal(s, voltage_V, path->controls_goal);
  memcpy(path->controls_from, path->controls, path->control_count * sizeof(double));
  return go(ctx, s, report);
}
