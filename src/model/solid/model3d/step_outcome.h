/* A solid on its way to a voltage, and the verdict where it does not get there
 * (docs/theory/stops.md). */
#pragma once

#include "model/solid/assembly/film_state.h"
#include "model/solid/equilibrium/solve_incremental.h"
#include "result/load_point.h"

/* Whose solid it is. */
struct dea_step_outcome_owner {
  struct dea_solid *solid;
  const struct dea_solid_film_data *films; // [part_material_count]
  void *model;
  /* Where the solid is, at that voltage. */
  dea_status (*point)(struct dea_context *ctx, void *model, double voltage_V,
                      struct dea_load_point *out);
  /* After each load step that came to its voltage. */
  dea_status (*arrived)(struct dea_context *ctx, void *model, double voltage_V);
  double step_V;                // a longer way is gone in such load steps
  double tension_scale_N_per_m; // what is small against that is none
  double refinement;            // of the mesh
  bool membrane;
};

/* Zeroed at first but for the owner. */
struct dea_step_outcome {
  struct dea_step_outcome_owner owner;
  double from_V, from_area; // where the last way began, and the film's area there
  struct dea_event limit;   // where the last way came to its end
  bool limited;             // it is known
  struct dea_event passed;  // a limit point that the last way has gone past to another state
  struct dea_solid_saved_state
      at_limit;                    // there, of `passed` where that is known; state NULL: none was
  bool has_passed;                 // it is known
  bool grew;                       // the film has at once, on the last step
  double tension[3], tension_V[3]; // smallest of the film [N/m], at the last points looked at
  double area;                     // largest area stretch at the last of them
  struct dea_solid_extremes film;  // of the films where they were evaluated last
  double *film_at[2]; // there and where the solid is: displacements, voltages; NULL: nowhere yet
  struct dea_arena memory; // of these
};

/* To a voltage from that of the last equilibrium, from_V. Where that fails the message is the
 * verdict: pull-in or snap-back (DEA_E_NO_EQUILIBRIUM), loss of tension (DEA_E_SLACK), an inverted
 * element, the end of a law, or that it is ours; what arrived before stays. */
dea_status dea_step_outcome_go(struct dea_context *ctx, struct dea_step_outcome *outcome,
                               double from_V, double voltage_V, struct dea_solid_report *report);
void dea_step_outcome_free(struct dea_step_outcome *outcome);
/* Where the last way came to its end, NULL where it did not; lent. */
const struct dea_event *dea_step_outcome_limit(const struct dea_step_outcome *outcome);
/* A limit point that the last way has gone past to another state, NULL where none is known; lent.
 */
const struct dea_event *dea_step_outcome_passed(const struct dea_step_outcome *outcome);

/* The same to the other controls that the solid is asked for, at its voltage. *share: of the way to
 * the limit point that it has passed, or at which it ends (DEA_E_NO_EQUILIBRIUM); NAN: none. */
dea_status dea_step_outcome_move(struct dea_context *ctx, struct dea_step_outcome *outcome,
                                 struct dea_solid_report *report, double *fraction);
