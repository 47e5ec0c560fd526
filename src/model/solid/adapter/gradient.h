/* Slopes of quantities of a solid's equilibrium by numbers of its design, by one linear answer a
 * quantity and differences of the residual at fixed unknowns a number (docs/theory/gradients.md).
 */
#ifndef DEA_MODEL_SOLID_ADAPTER_GRADIENT_H
#define DEA_MODEL_SOLID_ADAPTER_GRADIENT_H

#include "model/model.h"
#include "model/solid/assembly/film.h"

/* Whose solid it is. */
struct dea_gradient_owner {
  struct dea_solid *solid;
  void *model;
  double voltage_V;
  /* out [dofs], pressures [elements][pressures], 0 before: slope of a column of load points by the
   * unknowns at the equilibrium; *known false: the model has none. */
  dea_status (*slope)(struct dea_context *ctx, void *model, int column, double *out,
                      double *pressures, bool *known);
  /* The same of the main motion of a monitor, out [dofs]; and the main motions of all that are
   * asked for at the unknowns as they are, out [monitor_count] of the question. Both NULL without
   * monitors. */
  dea_status (*monitor_slope)(struct dea_context *ctx, void *model, size_t monitor, double *out);
  dea_status (*monitors)(struct dea_context *ctx, void *model, double *out);
  /* Puts mesh, constituents and loads of a changed device under the solid, whose unknowns stay.
   * DEA_E_ARGUMENT and DEA_E_UNSUPPORTED where the mesh cannot follow. */
  dea_status (*enter)(struct dea_context *ctx, void *model, const struct dea_device *device);
  /* And back, also after a failure of `enter`. */
  void (*leave)(struct dea_context *ctx, void *model);
  /* Quantities of the changed device at these unknowns; energy_J: of the solid there. */
  dea_status (*point)(struct dea_context *ctx, void *model, double voltage_V, double energy_J,
                      struct dea_load_point *out);
};

/* Whether a column of load points is an extreme of the film, and where a point has it; lent. */
bool dea_gradient_extreme_of(int column, enum dea_film_extreme *out);
double *dea_gradient_extreme(enum dea_film_extreme which, struct dea_load_point *point);

/* `gradient` of struct dea_model_type. */
dea_status dea_gradient_find(struct dea_context *ctx, const struct dea_gradient_owner *owner,
                             const struct dea_gradient_ask *ask, double *out);

#endif
