/* Stresses and pressures that a linear step leads to (docs/theory/branches.md). */
#include "model/solid/assembly/internal.h"

#include <string.h>

/* The step's values at the nodes of an element. */
static void gather(const struct dea_solid *s, size_t e, const double *field, double *out)
{
  const int *nodes = s->grid->nodes + e * DEA_HEX_NODES_MAX;
  for (int n = 0; n < s->shape.nodes; n++) {
    memcpy(out + 3 * n, field + 3 * nodes[n], 3 * sizeof *out);
  }
}

/* One element: predicted stresses into their place, pressures into s->theta, which is free here. */
static dea_status predict_element(struct dea_solid *s, size_t k, double voltage_V,
                                  const double *step, double share, bool stresses)
{
  size_t e = s->own[k], pressures = (size_t)s->shape.pressures;
  double X[DEA_HEX_DOFS_MAX] = {0}, u[DEA_HEX_DOFS_MAX] = {0}, way[DEA_HEX_DOFS_MAX] = {0};
  double *out = s->predicted + k * dea_hex_predicted_count(&s->shape);
  gather(s, e, s->grid->X, X);
  gather(s, e, s->u, u);
  gather(s, e, step, way);
  const struct dea_constituent layer = dea_solid_constituent_at(s, e);
  dea_status status = dea_hex_predict(&s->shape, &layer, X, u, s->multiplier + e * pressures,
                                      s->active[e] ? voltage_V : 0, way, share, stresses, out);
  memcpy(s->theta + e * pressures, out, pressures * sizeof *out);
  return status;
}

dea_status dea_solid_predict(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                             const double *step, double share, bool stresses, bool pressures)
{
  size_t count = dea_solid_pressure_count(s);
  dea_status status = DEA_OK;
  stresses = stresses && s->field == NULL;
  memset(s->theta, 0, count * sizeof *s->theta);
  for (size_t k = 0; k < s->own_count && status == DEA_OK; k++) {
    if (s->grid->flat[s->own[k]]) {
      continue; // no pressure, and the tangent that it has
    }
    status = predict_element(s, k, voltage_V, step, share, stresses);
  }
  s->predicted_fits = false;
  status = dea_solid_agree(ctx, s, status);
  if (status != DEA_OK) {
    return dea_fail(ctx, status, "the stresses at the end of a step cannot be had");
  }
  s->predicted_fits = stresses;
  if (pressures) {
    dea_solid_sum(s, s->theta, count);
    memcpy(s->multiplier, s->theta, count * sizeof *s->multiplier);
  }
  return DEA_OK;
}
