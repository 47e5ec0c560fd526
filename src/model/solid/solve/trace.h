/* What the files of path following share (docs/theory/branches.md). */
#ifndef DEA_MODEL_SOLID_SOLVE_TRACE_H
#define DEA_MODEL_SOLID_SOLVE_TRACE_H

#include "model/solid/solve/branch.h"
#include "model/solid/solve/internal.h"

/* An equilibrium on the path. */
struct dea_trace_place {
  double *state; // [state_count]
  double load;   // tau
  double slope;  // d tau/d s
  double arc;    // s from the start
  double energy_J;
  int modes;
};

/* A plane in the space of displacements and load, which a point is looked for in:
 * weight . (u - u0) + load (tau - tau0) = length. */
struct dea_trace_plane {
  double *weight;   // [dofs] metric times the unit normal's displacements
  double load;      // the unit normal's load
  const double *u0; // [dofs]
  double tau0, length;
};

struct dea_solid_trace {
  struct dea_solid *s;
  double *metric;            // [dofs] of displacements: sum of metric du^2 + d tau^2 = ds^2
  double *from, *goal, *now; // [control_count] at tau = 0 and 1, and as they are
  double *held_rate;         // [dofs] of what is prescribed, by tau
  double load, energy_J;     // tau and energy of the solid as it is
  struct dea_trace_place before, last, next, critical;
  double *tangent, tangent_load; // of the path at last; [dofs]
  struct dea_trace_plane plane;
  double *rate, *right, *start, *mode; // [dofs] each: work; mode: critical one, unit size
  double step, step_most, step_least;
  enum dea_trace_event event;   // between before and last
  enum dea_trace_event located; // what critical is
};

/* dea_solid_trace_create to the controls `goal` [control_count]; the path is prepared. */
dea_status dea_trace_create_to(struct dea_context *ctx, struct dea_solid *s, const double *goal,
                               const struct dea_trace_options *options,
                               struct dea_solid_trace **out);
/* Length of a displacement in the metric. */
double dea_trace_size(const struct dea_solid_trace *t, const double *du);
/* Sets all controls to those at tau, held components go along. DEA_E_DOMAIN below 0 V. */
dea_status dea_trace_load(struct dea_context *ctx, struct dea_solid_trace *t, double tau);
/* Puts the solid to a place. */
dea_status dea_trace_return(struct dea_context *ctx, struct dea_solid_trace *t,
                            const struct dea_trace_place *place);
/* From an equilibrium by du and dtau, pressures and predicted stresses along. du: [dofs]. */
dea_status dea_trace_advance(struct dea_context *ctx, struct dea_solid_trace *t, const double *du,
                             double dtau);
/* The solid to the equilibrium in t->plane. *iterations: that it took. */
dea_status dea_trace_correct(struct dea_context *ctx, struct dea_solid_trace *t, int *iterations);
/* At an equilibrium: unstable modes, and t->rate = du/d tau along the path. */
dea_status dea_trace_look(struct dea_context *ctx, struct dea_solid_trace *t, int *modes);
/* The place of the solid as it is; along: a displacement and load that the path's sense makes a
 * positive product with. Sets the tangent when it is wanted. */
dea_status dea_trace_arrive(struct dea_context *ctx, struct dea_solid_trace *t, const double *along,
                            double along_load, bool tangent, struct dea_trace_place *place);
/* The plane's normal, from a direction of any length. */
void dea_trace_point_plane(struct dea_solid_trace *t, const double *direction, double load);
void dea_trace_tell(const struct dea_solid_trace *t, const struct dea_trace_place *place,
                    enum dea_trace_event event, struct dea_trace_point *out);

#endif
