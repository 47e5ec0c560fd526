/* Slopes of quantities of a solid's equilibrium by numbers of its design, by one linear answer a
 * quantity and differences of the residual at fixed unknowns a number (docs/theory/gradients.md).
 */
#pragma once

#include "model/model.h"
#include "model/solid/assembly/film_state.h"
#include "model/solid/model3d/step_outcome.h"

/* Whose solid it is. */
struct dea_gradient_owner {
  struct dea_solid *solid;
  const struct dea_step_outcome *outcome; // of its last solve, for a question of a limit point
  void *model;
  double voltage_V;
  /* out [dofs], pressures [elements][pressures], 0 before: slope of a column of load points by the
   * unknowns at the equilibrium, behind the pressures by the multipliers of loads; *known false:
   * the model has none. */
  dea_status (*slope)(struct dea_context *ctx, void *model, int column, double *out,
                      double *pressures, bool *known);
  /* The same of the motion of monitor i of the question, out [dofs]; of a force on a body in its
   * place the motion that it does work along, direction [dofs], 0 before. And the motions of all
   * that are asked for at the unknowns as they are, out [monitor_count] of the question. Both NULL
   * without monitors. */
  dea_status (*monitor_slope)(struct dea_context *ctx, void *model, size_t i, double *out,
                              double *direction, bool *known);
  dea_status (*monitors)(struct dea_context *ctx, void *model, double *out);
  /* Puts mesh, part materials and loads of one side of a change under the solid, whose unknowns
   * stay. DEA_E_ARGUMENT and DEA_E_UNSUPPORTED where the mesh cannot follow. */
  dea_status (*enter)(struct dea_context *ctx, void *model, const struct dea_design_change *change,
                      int side);
  /* The own device, with what its loads hold by multipliers alone, without their penalties. NULL
   * where no load holds anything. */
  dea_status (*hold)(struct dea_context *ctx, void *model);
  /* And back from both, also after a failure. */
  void (*leave)(struct dea_context *ctx, void *model);
  /* Quantities of the changed device at these unknowns; energy_J: of the solid there. */
  dea_status (*point)(struct dea_context *ctx, void *model, double voltage_V, double energy_J,
                      struct dea_load_point *out);
};

/* The film of a solid, which every owner asks the same of. All lent. */
struct dea_gradient_film {
  struct dea_solid *solid;
  const struct dea_solid_film_data *films; // [part_material_count]
  double copies;                           // of the solid in the device
};
/* Where the film's extremes are at the equilibrium: those of a changed device are taken there. */
struct dea_gradient_places {
  struct dea_film_place at[DEA_FILM_EXTREMES];
  bool known[DEA_FILM_EXTREMES];
};
void dea_gradient_places_find(const struct dea_gradient_film *film,
                              struct dea_gradient_places *out);

/* `slope` above for what all solids know alike: extremes of the film, capacitance, energy and
 * nominal field, and the voltage, which is no unknown; *known false for every other column. */
dea_status dea_gradient_film_slope(struct dea_context *ctx, const struct dea_gradient_film *film,
                                   const struct dea_gradient_places *places, int column,
                                   double *out, double *pressures, bool *known);
/* Extremes and, where it is asked for, capacitance of the film as it is now. */
dea_status dea_gradient_film_at(struct dea_context *ctx, const struct dea_gradient_film *film,
                                const struct dea_gradient_places *places,
                                const struct dea_gradient_request *ask, double voltage_V,
                                struct dea_load_point *out);
/* Energy without voltage at the unknowns of rest, which are the owner's: u [dofs], followers of
 * bodies are moved, and multipliers. Left as it is where no energy is asked for. */
dea_status dea_gradient_rest_energy(struct dea_solid *solid, const struct dea_gradient_request *ask,
                                    double *u, double *multipliers, double *energy_J);

/* Whether it is asked for the frequency of the lowest mode, which needs a mass. */
bool dea_gradient_asks_mode(const struct dea_gradient_request *ask);

/* `gradient` of struct dea_model_type. The frequency is this file's own. */
dea_status dea_gradient_find(struct dea_context *ctx, const struct dea_gradient_owner *owner,
                             const struct dea_gradient_request *ask, double *out);
