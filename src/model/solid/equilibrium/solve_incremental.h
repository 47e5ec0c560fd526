/* To the next voltage by load steps, and where they end along the path of equilibria to the cause
 * (docs/theory/stops.md). */
#pragma once

#include "model/solid/assembly/controls.h"

enum dea_solid_stop_kind {
  DEA_STOP_UNKNOWN,  // the path cannot be followed either
  DEA_STOP_LIMIT,    // it turns back: a limit point
  DEA_STOP_NEAR,     // only for sinks: one that was closed in on, and is not where the solid is
  DEA_STOP_PASSED,   // only for sinks: that limit point was none of the film
  DEA_STOP_UNSTABLE, // it turns unstable, and no way down from there was found
};

struct dea_solid_stop {
  enum dea_solid_stop_kind kind;
  double voltage_V;   // of the limit point; where the path is first known to be unstable
  double load_factor; // there, of the increment from where the solve began
  int unstable_modes; // there
};

/* Looks at the solid at a point of the path; where: DEA_STOP_UNKNOWN at one in between, otherwise
 * at the limit point or bifurcation that was located, or with DEA_STOP_NEAR near one. */
typedef dea_status (*dea_solid_path_sink)(struct dea_context *ctx, void *user,
                                          enum dea_solid_stop_kind where);

/* What has become of the film from the last point that a sink has looked at to where the solid is:
 * a film may thin in one place without a displacement that tells. */
struct dea_solid_change {
  bool grew; // its area has, at once
  bool taut; // it has tension there
};

/* Who looks at the points of a path. */
struct dea_solid_watch {
  dea_solid_path_sink points;
  dea_status (*change)(struct dea_context *ctx, void *user, struct dea_solid_change *out);
  bool (*taut)(const void *user); // whether the film had tension where `points` has looked last
  void *user;
};

/* As dea_load_steps_solve. Load steps that fail or leave their path of equilibria - for another
 * branch or past a limit point - are taken back, and the path is followed by arc length, around a
 * bifurcation and, where that leads to a stable state, past a limit point too; then by load steps
 * again. watch: sees each point of such a path. taut: the film has tension. A
 * failure leaves the solid at the last equilibrium that was found, at report->load_factor of the
 * increment: DEA_E_NO_EQUILIBRIUM beyond a limit point; otherwise the status of the last load step.
 * *stop says what is known; stop->load_factor is that of the last limit point that was found or
 * passed. */
dea_status dea_solid_solve_incremental(struct dea_context *ctx, struct dea_solid *solid,
                                       double voltage_V, bool taut,
                                       const struct dea_solid_watch *watch,
                                       struct dea_solid_report *report,
                                       struct dea_solid_stop *stop);

/* Width of the increment, over all of it, to which load steps close in on where they end. */
static const double dea_branch_jump_width = 1e-3;
