/* Paths of equilibria, stable or not, through limit points and bifurcations, by arc-length
 * (docs/theory/continuation.md), from where a solid is. All controls go together, by a load tau: at
 * 0 as they stand at the start, at 1 as they are asked for - the square of the voltage, dead loads,
 * prescribed displacements and parameters of loads, each in proportion. tau is found with the
 * displacements: it may turn back at a limit point, and go below 0 or above 1.
 *
 * Length along the path: ds^2 = d tau^2 + (root mean square of du over the volume / unit_m)^2. */
#pragma once

#include "model/solid/assembly/solid.h"

struct dea_solid_continuation;

struct dea_continuation_options {
  double step;      // length of the first step; below 0: tau falls at first
  double step_most; // longest step; 0: any
  double unit_m;    // displacement that counts as much as the whole load, above 0
  bool rough;       // the path is only a way to what happens on it: points end at path_rough
};

enum dea_continuation_event {
  DEA_CONTINUATION_NOTHING,
  DEA_CONTINUATION_LIMIT,
  DEA_CONTINUATION_BIFURCATION
};

struct dea_continuation_point {
  double load;  // tau
  double slope; // d tau/d s: 0 at a limit point
  double arc;   // s from the start
  double voltage_V;
  double energy_J;
  int unstable_modes;
  enum dea_continuation_event
      passed;     // since the point before: slope or number of unstable modes changed
  int iterations; // of a step, those of attempts that were too long among them
};

/* Starts at the equilibrium that the solid is at or slides into. The goals (forces, prescribed
 * displacements, parameters of loads) are taken as they are now. solid: lent; while the trace lives
 * it alone moves the solid, which stays at the last point. out: owned by the caller, NULL on
 * failure. DEA_E_ARGUMENT for options that cannot be. */
dea_status dea_solid_continuation_create(struct dea_context *ctx, struct dea_solid *solid,
                                         double voltage_V,
                                         const struct dea_continuation_options *options,
                                         struct dea_solid_continuation **out);
void dea_solid_continuation_destroy(struct dea_context *ctx, struct dea_solid_continuation *trace);

/* The next point; the step's length adapts. DEA_E_NOT_CONVERGED or DEA_E_DOMAIN where the path
 * cannot be followed: the solid is then at the last point. */
dea_status dea_solid_continuation_step(struct dea_context *ctx,
                                       struct dea_solid_continuation *trace,
                                       struct dea_continuation_point *point);

/* The equilibrium at a load between those of the last two points, stable or not, where the solid is
 * then. DEA_E_NOT_CONVERGED: it is not found. */
dea_status dea_solid_continuation_at(struct dea_context *ctx, struct dea_solid_continuation *trace,
                                     double load, struct dea_continuation_point *point);

/* The same where weight [dofs] . u has a value between those of the last two points; on a path that
 * turns back in this the one that the way between them leads to. */
dea_status dea_solid_continuation_across(struct dea_context *ctx,
                                         struct dea_solid_continuation *trace, const double *weight,
                                         double value, struct dea_continuation_point *point);

/* The limit point or bifurcation that the last step has passed: the solid is there until the next
 * call. Of several modes that turn unstable in one step it is that of the first. DEA_E_ARGUMENT
 * where nothing was passed, DEA_E_NOT_CONVERGED when it cannot be closed in on: the solid is then
 * at the last point. */
dea_status dea_solid_continuation_locate(struct dea_context *ctx,
                                         struct dea_solid_continuation *trace,
                                         struct dea_continuation_point *point);

/* dea_solid_continuation_create to the controls `goal` [control_count]; the path is prepared. */
dea_status dea_continuation_create_to(struct dea_context *ctx, struct dea_solid *s,
                                      const double *goal,
                                      const struct dea_continuation_options *options,
                                      struct dea_solid_continuation **out);
