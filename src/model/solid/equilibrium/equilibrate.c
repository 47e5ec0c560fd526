#include "model/solid/equilibrium/equilibrate.h"

#include "model/solid/assembly/incompressible.h"
#include "model/solid/equilibrium/follow.h"
#include "model/solid/equilibrium/newton.h"

#include <math.h>

enum { MAX_WORSE = 4 }; // updates in a row that violate the constraints more

/* Minima at multipliers that follow, until the constraints hold. Where there is no equilibrium any
 * more minima at given multipliers may go on, but violate the constraints more and more. */
dea_status dea_solid_equilibrate(struct dea_context *ctx, struct dea_solid *s,
                                 struct dea_solid_report *report)
{
  const struct dea_solid_settings *o = &s->settings;
  double best = INFINITY;
  for (int i = 0, worse = 0; i < o->multiplier_max_iterations && worse < MAX_WORSE; i++) {
    DEA_TRY(ctx, dea_solid_minimise(ctx, s, i == 0 && !o->accept_unstable, report));
    report->load_error = dea_solid_update_loads(s);
    double error = fmax(report->theta_max / o->volume_tol, report->load_error);
    bool there = report->theta_max < o->volume_tol && report->load_error <= 1;
    if (!there && report->theta_max < o->volume_tol) {
      DEA_TRY(ctx, dea_solid_follow(ctx, s, NAN, false, report, NULL, &there));
    }
    if (there) {
      return DEA_OK;
    }
    if (report->theta_max >= o->volume_tol) {
      dea_solid_update_multipliers(s);
    }
    worse = error < best ? 0 : worse + 1;
    best = fmin(best, error);
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED,
                  "the constraints do not settle (J - 1: %.1e; loads: %.2g of what is allowed)",
                  report->theta_max, report->load_error);
}
