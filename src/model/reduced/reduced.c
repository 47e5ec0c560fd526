#include "model/reduced/reduced.h"

#include "result/columns.h"

#include <stdio.h>

bool dea_reduced_order_turns(const struct dea_reduced_order *order)
{
  return order->coordinate.column == 0 && order->coordinate.component >= 3;
}

dea_status dea_reduced_fail(struct dea_context *ctx, const struct dea_reduced_order *order, int end,
                            double voltage_V)
{
  const bool turns = dea_reduced_order_turns(order);
  switch (end) {
  case DEA_REDUCED_BEYOND_VOLTAGE:
    return dea_fail(ctx, DEA_E_DOMAIN,
                    "%.6g kV is outside the range of the reduced-order model, %.6g to %.6g kV "
                    "(compute.reduced.voltage)",
                    1e-3 * voltage_V, 1e-3 * order->voltage_V[0], 1e-3 * order->voltage_V[1]);
  case DEA_REDUCED_BEYOND_FORCE:
    return dea_fail(ctx, DEA_E_DOMAIN,
                    "at %.6g kV the device is loaded beyond the range of the reduced-order model, "
                    "%.4g to %.4g %s (compute.reduced.%s)",
                    1e-3 * voltage_V, 1e3 * order->force[0], 1e3 * order->force[1],
                    turns ? "mN m" : "mN", turns ? "moment" : "force");
  default:
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the reduced-order model finds no state at %.6g kV",
                    1e-3 * voltage_V);
  }
}

void dea_reduced_order_name(const struct dea_reduced_order *order, const struct dea_device *device,
                            char *out, size_t size)
{
  const struct dea_control *c = &order->coordinate;
  if (c->column != 0) {
    snprintf(out, size, "%s", dea_point_columns[c->column].header);
  } else {
    snprintf(out, size, "%s %s", device->layout->monitors[c->body].name,
             dea_observed_columns[c->component].header);
  }
}

void dea_reduced_order_destroy(struct dea_context *ctx, struct dea_reduced_order *order)
{
  if (order != NULL) {
    dea_arena_free(&order->memory);
    dea_free(ctx, order);
  }
}
