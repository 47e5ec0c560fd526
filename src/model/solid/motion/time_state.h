/* What the files of the steps in time share: their state. */
#ifndef DEA_MODEL_SOLID_MOTION_TIME_STATE_H
#define DEA_MODEL_SOLID_MOTION_TIME_STATE_H

#include "model/alpha.h"
#include "model/solid/assembly/inertia.h"
#include "model/solid/motion/time.h"

struct dea_solid_time {
  struct dea_solid *solid;
  struct dea_internal_variables *history;
  struct dea_solid_inertia inertia;
  bool inertial, stay;    // stay: of the solid before
  bool open;              // a step has been tried, the solid is not at the accepted state
  bool start, start_next; // acceleration and pressures belong to other forces: after a jump
  struct dea_alpha alpha;
  size_t count;                     // 3 node_count
  double *v, *a, *F;                // at the accepted state; F: all forces but those of inertia
  double *v_next, *a_next, *F_next; // of the step that is tried
  double *first;                    // [count] displacements at the start
  double *u_before;                 // [count] of the state before the accepted one
  double *work;                     // [count]
  double step_s, step_before_s;     // of the step that is tried; of the accepted one, 0: a corner
  double *keep, *controls;          // the accepted state, as of a path
  size_t keep_count, control_count; // numbers in them
  double stiffened;                 // kappa is so many times that of the layers
  struct dea_solid_energies sums, sums_next;
  double first_J; // stored energy at the start
  double capacitance_F, capacitance_next_F;
};

/* Elastic and electric energy and that of loads, and capacitance, without what steps add. */
dea_status dea_time_find_stored(struct dea_context *ctx, struct dea_solid_time *t, double *stored,
                                double *capacitance_F);
/* sums_next at the end of the step that was tried; needs F_next and v_next. */
dea_status dea_time_find_energies(struct dea_context *ctx, struct dea_solid_time *t);
/* Estimate of the error of the step that was tried [m]. */
double dea_time_step_error(const struct dea_solid_time *t);

#endif
