/* Where a model of a solid stands, whatever device the solid is of: its last equilibrium, and the
 * way to the next one. What model/model.h asks of all such models is done here: their struct
 * dea_model begins with a struct dea_solver_state, which the functions of a type see. */
#pragma once

#include "model/solid/model3d/circuit_step.h"
#include "model/solid/model3d/step_outcome.h"
#include "result/state.h"

/* Zeroed at first but for the owner of the outcome. */
struct dea_solver_state {
  struct dea_step_outcome outcome; // of the last solve
  struct dea_solid_report report;
  double voltage_V, rest_energy_J;
  bool as_made;                    // at rest, where making the model has led, and moved nowhere yet
  bool left_a_state;               // a state was left on the way to here: there are several
  struct dea_circuit_step *driven; // NULL: no history in time
  double stored_J;                 // of the film when that began
  double *soft;                    // [soft_count][3 node_count] softest modes; owned
  size_t soft_count;
};

/* Ends a history in time and forgets soft modes. */
void dea_solver_state_free(struct dea_context *ctx, struct dea_solver_state *solver_state);

// Of a model's type ------------------------------------------------------------------------------

dea_status dea_solver_state_solve(struct dea_context *ctx, struct dea_model *model,
                                  double voltage_V, struct dea_load_point *out);
const struct dea_event *dea_solver_state_limit(const struct dea_model *model);
const struct dea_event *dea_solver_state_passed(const struct dea_model *model);
dea_status dea_solver_state_soften(struct dea_context *ctx, struct dea_model *model, size_t count,
                                   double *stiffness_N_per_m4);
dea_status dea_solver_state_advance(struct dea_context *ctx, struct dea_model *model,
                                    const struct dea_time_step *step, struct dea_load_point *out,
                                    double *error);
void dea_solver_state_accept(struct dea_model *model);
dea_status dea_solver_state_load(struct dea_context *ctx, struct dea_model *model,
                                 const struct dea_state *state);

// For functions of a model's type ----------------------------------------------------------------

/* Where a path ends but for its options: weight [dofs] . u comes to `value` from below; NULL:
 * nowhere else. */
struct dea_solver_state_end {
  const double *weight;
  double value;
};

/* `long_path`, from where the solid is; the stretch of the options is not looked at. */
dea_status dea_solver_state_path(struct dea_context *ctx, struct dea_solver_state *solver_state,
                                 const struct dea_path_options *options,
                                 const struct dea_solver_state_end *end, dea_point_sink points,
                                 dea_event_sink events, void *user);

/* `push`. fold: [node_count][3] what a push of that kind does; NULL: none is known. */
dea_status dea_solver_state_push(struct dea_context *ctx, struct dea_solver_state *solver_state,
                                 const struct dea_push *push, const double *fold,
                                 struct dea_load_point *out, bool *found);

/* `begin`. driven: lent until the history ends; its solid is the owner's. */
dea_status dea_solver_state_begin(struct dea_context *ctx, struct dea_solver_state *solver_state,
                                  const struct dea_driven_solid *driven,
                                  const struct dea_time_options *time, struct dea_load_point *out);
/* Equilibria are looked for from where a history in time has come to, or the model's making: before
 * other ways than dea_solver_state_solve. */
void dea_solver_state_end_history(struct dea_context *ctx, struct dea_solver_state *solver_state);

/* `save`: where the solid stands as a saved state, as dea_solid_save. */
dea_status dea_solver_state_save(struct dea_context *ctx,
                                 const struct dea_solver_state *solver_state,
                                 struct dea_state *out);
