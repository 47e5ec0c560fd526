/* From one equilibrium to the next: prediction, multipliers, smaller steps. */
#include "model/solid/solve/internal.h"

#include <math.h>
#include <string.h>

enum { OUTER_MAX = 30 };

static const double step_smallest = 1.0 / 64; // of the way asked for

/* Minima at multipliers that follow, until the constraints hold. */
static dea_status outer_loop(struct dea_context *ctx, struct dea_solid *s,
                             struct dea_solid_report *report)
{
  for (int i = 0; i < OUTER_MAX; i++) {
    DEA_TRY(ctx, dea_solid_minimise(ctx, s, s->voltage_V, report));
    report->load_error = 0;
    for (size_t k = 0; k < s->load_count; k++) {
      if (s->loads[k].update != NULL) {
        report->load_error = fmax(report->load_error, s->loads[k].update(s->loads[k].self, s->u));
      }
    }
    if (report->theta_max < DEA_SOLID_THETA_SMALL && report->load_error <= 1) {
      return DEA_OK;
    }
    if (report->theta_max >= DEA_SOLID_THETA_SMALL) {
      dea_solid_update_multipliers(s);
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
  memcpy(path->controls, next, path->control_count * sizeof(double));
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
