/* Stability of a solid at its last equilibrium: its softest modes, the way from an unstable
 * equilibrium to a stable one, and paths of equilibria, stable or not (docs/theory/branches.md).
 *
 * Modes solve K v = lambda M v, K the tangent and M the volume lumped to the nodes: lambda [N/m per
 * m^3] is the stiffness of the mode per volume that moves, negative for an unstable one. */
#ifndef DEA_MODEL_SOLID_EQUILIBRIUM_BRANCH_H
#define DEA_MODEL_SOLID_EQUILIBRIUM_BRANCH_H

#include "model/solid/assembly/solid.h"

enum { DEA_MODES_MAX = 64 };

/* The `count` lowest modes at the last equilibrium, ascending. value: [count]; vector: [count][3
 * node_count], v . M v = 1, and the component of largest size is positive; NULL: not wanted.
 * DEA_E_ARGUMENT for a count of 0 or above DEA_MODES_MAX, DEA_E_NOT_CONVERGED when they cannot be
 * had, among that when more than DEA_MODES_MAX are unstable. */
dea_status dea_solid_modes(struct dea_context *ctx, struct dea_solid *solid, size_t count,
                           double *value, double *vector);

/* From an unstable equilibrium down along its most unstable mode v to a stable one, at the same
 * voltage and loads. side: 1 along v, -1 against it, 0 where the energy is lower (along v when that
 * is equal). Goes on until there is no unstable mode. The solid stays where it was with
 * DEA_E_NOT_CONVERGED. Nothing to do at a stable one. *report: as of a solve. */
dea_status dea_solid_descend_unstable(struct dea_context *ctx, struct dea_solid *solid, int side,
                                      struct dea_solid_report *report);

/* Looks for another equilibrium at the same voltage and loads: down from displacements + push_m
 * [node_count][3] (what is held stays), to a stable one that is accepted. Where that finds none the
 * solid stays where it was, *found is false and *report as it was. */
dea_status dea_solid_push(struct dea_context *ctx, struct dea_solid *solid, const double *push_m,
                          bool (*accept)(const void *self, const double *displacement_m),
                          const void *self, struct dea_solid_report *report, bool *found);

/* Whether solves stay at an unstable equilibrium that they have found; at first they leave it. */
void dea_solid_accept_unstable(struct dea_solid *solid, bool stay);

/* ---- paths through limit points and bifurcations ---- */

/* A path of equilibria from where a solid is. All controls go together, by a load tau: at 0 as they
 * stand at the start, at 1 as they are asked for - the square of the voltage, dead loads,
 * prescribed displacements and parameters of loads, each in proportion. tau is found with the
 * displacements: it may turn back at a limit point, and go below 0 or above 1.
 *
 * Length along the path: ds^2 = d tau^2 + (root mean square of du over the volume / unit_m)^2. */
struct dea_solid_continuation;

struct dea_continuation_options {
  double step;      // length of the first step; below 0: tau falls at first
  double step_most; // longest step; 0: any
  double unit_m;    // displacement that counts as much as the whole load, above 0
};

enum dea_continuation_event {
  DEA_CONTINUATION_NOTHING,
  DEA_CONTINUATION_LIMIT,
  DEA_CONTINUATION_BIFURCATION
};

struct dea_continuation_point {
  double load; // tau
  double voltage_V;
  double slope; // d tau/d s: 0 at a limit point
  double arc;   // s from the start
  double energy_J;
  int unstable_modes;
  enum dea_continuation_event
      passed;     // since the point before: slope or number of unstable modes changed
  int iterations; // of a step, those of attempts that were too long among them
};

/* Starts at the equilibrium that the solid is at or slides into. The goals (forces, prescribed
 * displacements, parameters of loads) are taken as they are now. solid: lent; while the trace lives
 * it alone moves the solid, which stays at the last point. out: owned by the caller, NULL on
 * failure. DEA_E_ARGUMENT for options that cannot be, DEA_E_UNSUPPORTED for a coupled field. */
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

/* The limit point or bifurcation that the last step has passed: the solid is there until the next
 * call. Of several modes that turn unstable in one step it is that of the first. DEA_E_ARGUMENT
 * where nothing was passed, DEA_E_NOT_CONVERGED when it cannot be closed in on. */
dea_status dea_solid_continuation_locate(struct dea_context *ctx,
                                         struct dea_solid_continuation *trace,
                                         struct dea_continuation_point *point);

/* From the bifurcation that dea_solid_continuation_locate has found to the other branch, along the
 * critical mode (side 1) or against it (-1); steps go on from there. distance: from the
 * bifurcation, in s. The mode's component of largest size is positive. DEA_E_ARGUMENT where none
 * was located. */
dea_status dea_solid_continuation_switch(struct dea_context *ctx,
                                         struct dea_solid_continuation *trace, int side,
                                         double distance, struct dea_continuation_point *point);

#endif
