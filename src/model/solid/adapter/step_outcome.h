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
  double flat_thickness_m;      // of the flat film where the field is largest
  double refinement;            // of the mesh
  bool membrane;
};

/* Zeroed at first but for the owner. */
struct dea_step_outcome {
  struct dea_step_outcome_owner owner;
  double from_V;           // where the last way began
  struct dea_event limit;  // where the last way came to its end
  bool limited;            // it is known
  struct dea_event passed; // a limit point that the last way has gone past to another state
  bool keeps;              // the state at one of both that was located is wanted
  struct dea_solid_saved_state
      at_limit;    // there, of `passed` where that is known; state NULL: none was
  bool has_passed; // it is known
  bool leapt;      // on the last step the film may have gone past one
  double rate[2]; // motion of the last step over its way, of the voltage and of another control; 0:
                  // none
  double tension[3], tension_V[3]; // smallest of the film [N/m], at the last points looked at
  double area;                     // largest area stretch at the last of them
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

/* Before and after a step of another control than the voltage, of such a way: as a way to a voltage
 * it may leap past a limit point. *share: of the way to it, NAN where there was none. */
dea_status dea_step_outcome_watch(struct dea_context *ctx, struct dea_step_outcome *outcome,
                                  double way, const struct dea_solid_saved_state *from,
                                  double *share);
