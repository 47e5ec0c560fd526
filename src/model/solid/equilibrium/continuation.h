/* What the files of path following share (docs/theory/branches.md). */
#ifndef DEA_MODEL_SOLID_EQUILIBRIUM_CONTINUATION_H
#define DEA_MODEL_SOLID_EQUILIBRIUM_CONTINUATION_H

#include "model/solid/assembly/internal.h"
#include "model/solid/equilibrium/branch.h"

/* An equilibrium on the path. */
struct dea_continuation_path_point {
  double *state; // [state_count]
  double load;   // tau
  double slope;  // d tau/d s
  double arc;    // s from the start
  double energy_J;
  int modes;
};

/* A plane in the space of displacements and load, which a point is looked for in:
 * weight . (u - u0) + load (tau - tau0) = length. */
struct dea_continuation_plane {
  double *weight;   // [dofs] metric times the unit normal's displacements
  double load;      // the unit normal's load
  const double *u0; // [dofs]
  double tau0, length;
};

struct dea_solid_continuation {
  struct dea_solid *s;
  double *metric;            // [dofs] of displacements: sum of metric du^2 + d tau^2 = ds^2
  double *from, *goal, *now; // [control_count] at tau = 0 and 1, and as they are
  double *held_rate;         // [dofs] of what is prescribed, by tau
  double load, energy_J;     // tau and energy of the solid as it is
  struct dea_continuation_path_point before, last, next, critical;
  double *tangent, tangent_load; // of the path at last; [dofs]
  struct dea_continuation_plane plane;
  double *rate, *right, *start, *mode; // [dofs] each: work; mode: critical one, unit size
  double step, step_most, step_least;
  enum dea_continuation_event event;   // between before and last
  enum dea_continuation_event located; // what critical is
};

/* dea_solid_continuation_create to the controls `goal` [control_count]; the path is prepared. */
dea_status dea_continuation_create_to(struct dea_context *ctx, struct dea_solid *s,
                                      const double *goal,
                                      const struct dea_continuation_options *options,
                                      struct dea_solid_continuation **out);
/* Length of a displacement in the metric. */
double dea_continuation_size(const struct dea_solid_continuation *t, const double *du);
/* Sets all controls to those at tau, held components go along. DEA_E_DOMAIN below 0 V. */
dea_status dea_continuation_load(struct dea_context *ctx, struct dea_solid_continuation *t,
                                 double tau);
/* Puts the solid to a place. */
dea_status dea_continuation_return(struct dea_context *ctx, struct dea_solid_continuation *t,
                                   const struct dea_continuation_path_point *place);
/* From an equilibrium by du and dtau, pressures and predicted stresses along. du: [dofs]. */
dea_status dea_continuation_advance(struct dea_context *ctx, struct dea_solid_continuation *t,
                                    const double *du, double dtau);
/* The solid to the equilibrium in t->plane. *iterations: that it took. */
dea_status dea_continuation_correct(struct dea_context *ctx, struct dea_solid_continuation *t,
                                    int *iterations);
/* At an equilibrium: unstable modes, and t->rate = du/d tau along the path. */
dea_status dea_continuation_evaluate(struct dea_context *ctx, struct dea_solid_continuation *t,
                                     int *modes);
/* The place of the solid as it is; along: a displacement and load that the path's sense makes a
 * positive product with. Sets the tangent when it is wanted. */
dea_status dea_continuation_arrive(struct dea_context *ctx, struct dea_solid_continuation *t,
                                   const double *along, double along_load, bool tangent,
                                   struct dea_continuation_path_point *place);
/* The plane's normal, from a direction of any length. */
void dea_continuation_orient_plane(struct dea_solid_continuation *t, const double *direction,
                                   double load);
void dea_continuation_report(const struct dea_solid_continuation *t,
                             const struct dea_continuation_path_point *place,
                             enum dea_continuation_event event, struct dea_continuation_point *out);

#endif
