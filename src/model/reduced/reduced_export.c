/* A reduced-order model as a file of another program. */
#include "base/write_file.h"
#include "model/reduced/reduced.h"

dea_status dea_reduced_order_export(struct dea_context *ctx, const struct dea_reduced_order *order,
                                    const struct dea_device *device, enum dea_reduced_format format,
                                    double voltage_V, double damping_ratio, const char *path)
{
  static dea_status (*const texts[])(const struct dea_reduced_export *, struct dea_text *) = {
      [DEA_REDUCED_C] = dea_reduced_add_c,
      [DEA_REDUCED_STATE_SPACE] = dea_reduced_add_state_space,
      [DEA_REDUCED_SPICE] = dea_reduced_add_spice,
      [DEA_REDUCED_MUJOCO] = dea_reduced_add_mujoco,
  };
  struct dea_reduced_export e = {.order = order, .damping_ratio = damping_ratio};
  struct dea_text text = {.ctx = ctx};
  const int end = format >= DEA_REDUCED_STATE_SPACE
                      ? dea_reduced_at(&order->core, 0, voltage_V, &e.at)
                      : DEA_REDUCED_OK;
  if (end != DEA_REDUCED_OK) {
    return dea_reduced_fail(ctx, order, end, voltage_V);
  }
  dea_reduced_order_name(order, device, e.name, sizeof e.name);
  if (format == DEA_REDUCED_FMU) {
    return DEA_CHAIN(ctx, dea_reduced_write_fmu(ctx, &e, path));
  }
  void *locale = dea_c_locale_enter();
  dea_status status = texts[format](&e, &text);
  dea_c_locale_leave(locale);
  status = status == DEA_OK ? dea_text_write_path(ctx, &text, path) : status;
  dea_text_free(&text);
  return DEA_CHAIN(ctx, status);
}
