/* From one equilibrium to the next: prediction, multipliers, smaller steps. */
#include "model/solid/assembly/internal.h"

#include <math.h>
#include <string.h>

enum { OUTER_MAX = 30, WORSE_MAX = 4 };

static const double step_smallest = 1.0 / 64; // of the way asked for

/* Minima at multipliers that follow, until the constraints hold. Where there is no equilibrium any
 * more minima at given multipliers may go on, but violate the constraints more and more. */
dea_status dea_solid_equilibrate(struct dea_context *ctx, struct dea_solid *s,
                                 struct dea_solid_report *report)
{
  double best = INFINITY;
  for (int i = 0, worse = 0; i < OUTER_MAX && worse < WORSE_MAX; i++) {
    DEA_TRY(ctx, dea_solid_minimise(ctx, s, s->voltage_V, report));
    report->load_error = dea_solid_update_loads(s);
    double error = fmax(report->theta_max / DEA_SOLID_THETA_SMALL, report->load_error);
    if (report->theta_max < DEA_SOLID_THETA_SMALL && report->load_error <= 1) {
      return DEA_OK;
    }
    if (report->theta_max >= DEA_SOLID_THETA_SMALL) {
      dea_solid_update_multipliers(s);
    }
    worse = error < best ? 0 : worse + 1;
    best = fmin(best, error);
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED,
                  "the constraints do not settle (J - 1: %.1e; loads: %.2g of what is allowed)",
                  report->theta_max, report->load_error);
}

double dea_solid_update_loads(struct dea_solid *s)
{
  double error = 0;
  for (size_t k = 0; k < s->load_count; k++) {
    if (s->loads[k].update != NULL) {
      error = fmax(error, s->loads[k].update(s->loads[k].self, s->u));
    }
  }
  return error;
}

/* Leaves an unstable equilibrium; where no way down is found it is the answer, and says so by its
 * unstable modes. */
static dea_status leave(struct dea_context *ctx, struct dea_solid *s,
                        struct dea_solid_report *report)
{
  dea_status status = dea_solid_descend_from(ctx, s, 0, report);
  if (status == DEA_E_NOT_CONVERGED || status == DEA_E_DOMAIN) {
    dea_context_clear(ctx);
    return DEA_OK;
  }
  return status;
}

/* The equilibrium a share of the way to the goal; the solid stays as it was when it fails. */
static dea_status solve_at(struct dea_context *ctx, struct dea_solid *s, double way,
                           struct dea_solid_report *report)
{
  struct dea_load_steps *path = &s->path;
  const double *from = path->controls_from;
  double *next = path->at;
  for (size_t i = 0; i < path->control_count; i++) {
    next[i] =
        way >= 1 ? path->controls_goal[i] : from[i] + way * (path->controls_goal[i] - from[i]);
  }
  dea_solid_state_get(s, path->keep);
  dea_solid_controls_set(s, next);
  dea_status status = DEA_OK;
  if (dea_solid_controls_increment(s, next)) {
    status = dea_solid_prescribed_increment(ctx, s, s->voltage_V, report);
  }
  if (status == DEA_OK) {
    status = dea_solid_equilibrate(ctx, s, report);
  }
  if (status == DEA_OK && report->unstable_modes > 0 && !s->stay) {
    status = leave(ctx, s, report);
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
  const struct dea_load_steps *path = &s->path;
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
  struct dea_load_steps *path = &s->path;
  *report = (struct dea_solid_report){0};
  DEA_TRY(ctx, dea_solid_check(ctx, s));
  DEA_TRY(ctx, dea_solid_agree(ctx, s, dea_load_steps_prepare(ctx, s)));
  dea_solid_controls_get(s, path->controls);
  dea_solid_controls_goal(s, voltage_V, path->controls_goal);
  memcpy(path->controls_from, path->controls, path->control_count * sizeof(double));
  return go(ctx, s, report);
}
