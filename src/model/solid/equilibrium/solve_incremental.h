/* To the next voltage by load steps, and where they end along the path of equilibria to the cause
 * (docs/theory/stops.md). */
#pragma once

#include "base/arena.h"
#include "model/solid/assembly/solid.h"

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
  double way;         // share of the way to there
  int unstable_modes; // there
};

/* Looks at the solid at a point of the path; where: DEA_STOP_UNKNOWN at one on the way, otherwise
 * at the limit point or bifurcation that was located, or with DEA_STOP_NEAR near one. */
typedef dea_status (*dea_solid_path_sink)(struct dea_context *ctx, void *user,
                                          enum dea_solid_stop_kind where);

/* Whether the film has grown at once from the last point that a sink has looked at to where the
 * solid is: a film may thin in one place without a displacement that tells. */
typedef dea_status (*dea_solid_growth_test)(struct dea_context *ctx, void *user, bool *grew);

/* Who looks at the points of a path. */
struct dea_solid_watch {
  dea_solid_path_sink points;
  dea_solid_growth_test grew;
  bool (*taut)(const void *user); // whether the film had tension where `points` has looked last
  void *user;
};

/* As dea_load_steps_solve; load steps that fail go on along the path by arc length, around a
 * bifurcation too, and then by load steps again. watch: sees each point of such a path; NULL:
 * nobody does. taut: the film has tension. A failure leaves the solid at the last equilibrium that
 * was found: DEA_E_NO_EQUILIBRIUM beyond a limit point; otherwise the status of the last load step,
 * and *stop says what is known. */
dea_status dea_solid_solve_incremental(struct dea_context *ctx, struct dea_solid *solid,
                                       double voltage_V, bool taut,
                                       const struct dea_solid_watch *watch,
                                       struct dea_solid_report *report,
                                       struct dea_solid_stop *stop);

/* As dea_load_steps_solve, and where load steps fail by the path, whose limit points the solid may
 * pass to a stable state. DEA_E_NO_EQUILIBRIUM: one ends it at report->limit of the way; the solid
 * is at report->way of it then. */
dea_status dea_solid_reach(struct dea_context *ctx, struct dea_solid *solid, double voltage_V,
                           struct dea_solid_report *report);

/* Where the solid has been. */
struct dea_solid_saved_state {
  struct dea_arena memory;
  double *state, *controls;
};
/* out: freed by the caller, also on failure. */
dea_status dea_solid_save_state(struct dea_context *ctx, struct dea_solid *solid,
                                struct dea_solid_saved_state *out);
void dea_solid_saved_state_free(struct dea_solid_saved_state *stand);
/* Brings the solid back to there. */
void dea_solid_restore_state(struct dea_solid *solid, const struct dea_solid_saved_state *at);
/* Root of the mean square of how far the nodes are from there. */
double dea_solid_moved_m(const struct dea_solid *solid, const struct dea_solid_saved_state *from);

/* Whether a film that was flat there, and that the voltage does not push across, is no more, to
 * 1e-6 and 1e-3 of a size. It does not push where the film was flat under one, or where the first
 * linear step from 0 V leaves it flat. */
bool dea_solid_left_plane(struct dea_solid *solid, const struct dea_solid_saved_state *from,
                          double size_m);

/* Whether the last approach, which began there, has come farther from where the tangent there saw
 * it go than a path of equilibria leads, up to its limit point; false where that is not known. */
bool dea_solid_left_branch(const struct dea_solid *solid, const struct dea_solid_saved_state *from);

/* Whether load steps from there to where the solid is have gone past a limit point or a
 * bifurcation: follows the path from there towards the controls as they are. Where the path comes
 * to no end, and where it says nothing of what is known to have `leapt`, load steps close in on the
 * controls at which the states on both sides stay apart: a limit point, or a corner that acts as
 * one. The solid is then where it was, unless it has left the plane of a flat film that was taut
 * all along its path to there: it is then at that path's end, *flat, which *report is of. *stop:
 * where, which `watch` has seen last; DEA_STOP_UNKNOWN: there was none, or none was found. */
dea_status dea_solid_detect_missed_limit_point(struct dea_context *ctx, struct dea_solid *solid,
                                               const struct dea_solid_saved_state *from, bool leapt,
                                               const struct dea_solid_watch *watch,
                                               struct dea_solid_report *report,
                                               struct dea_solid_stop *stop, bool *flat);
