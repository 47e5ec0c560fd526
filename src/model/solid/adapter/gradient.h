/* Slopes of quantities of a solid's equilibrium by numbers of its design, by one linear answer a
 * quantity and differences of the residual at fixed unknowns a number (docs/theory/gradients.md).
 */
#ifndef DEA_MODEL_SOLID_ADAPTER_GRADIENT_H
#define DEA_MODEL_SOLID_ADAPTER_GRADIENT_H

#include "model/model.h"
#include "model/solid/assembly/solid.h"

/* Whose solid it is. */
struct dea_gradient_owner {
  struct dea_solid *solid;
  void *model;
  double voltage_V;
  /* out [dofs], pressures [elements][pressures], 0 before: slope of a column of load points by the
   * unknowns at the equilibrium; *known false: the model has none. */
  dea_status (*slope)(struct dea_context *ctx, void *model, int column, double *out,
                      double *pressures, bool *known);
  /* Puts mesh, constituents and loads of a changed device under the solid, whose unknowns stay.
   * DEA_E_ARGUMENT and DEA_E_UNSUPPORTED where the mesh cannot follow. */
  dea_status (*enter)(struct dea_context *ctx, void *model, const struct dea_device *device);
  /* And back, also after a failure of `enter`. */
  void (*leave)(struct dea_context *ctx, void *model);
  /* Quantities of the changed device at these unknowns; energy_J: of the solid there. */
  dea_status (*point)(struct dea_context *ctx, void *model, double voltage_V, double energy_J,
                      struct dea_load_point *out);
};

/* `gradient` of struct dea_model_type. */
dea_status dea_gradient_find(struct dea_context *ctx, const struct dea_gradient_owner *owner,
                             const struct dea_gradient_ask *ask, double *out);

#endif
