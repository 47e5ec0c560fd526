#include "model/model.h"

#include "model/film.h"

#include "result/columns.h"

#include <math.h>

static double last_voltage_V(const struct dea_design *design)
{
  size_t count = design->compute.voltage_count;
  return count > 0 ? design->compute.voltages_V[count - 1] : 0;
}

struct dea_model_settings dea_model_settings_of(const struct dea_design *design)
{
  struct dea_model_settings settings = {
      .film = (enum dea_solid_film)design->compute.solid.film.value,
      .domain = design->compute.solid.domain.value == DEA_DOMAIN_SECTOR ? DEA_DOMAIN_SECTOR
                                                                        : DEA_DOMAIN_DISC,
      .field = (enum dea_solid_electrostatics)design->compute.solid.field.value,
      .buckling_branch = (enum dea_buckling_branch)design->compute.solid.buckling_branch.value,
      .refinement = design->compute.solid.refinement.si,
      .tip_refinement = design->compute.solid.tip_refinement.si,
      .order = (int)design->compute.solid.order.si,
      .order_z = (int)design->compute.solid.order_z.si,
      .elements_z = (int)design->compute.solid.elements_z.si,
  };
  if (design->compute.solid.adapt.asked) {
    settings.adapt.monitor = design->compute.solid.adapt.monitor.text;
    settings.adapt.tolerance = design->compute.solid.adapt.tolerance.si;
    settings.adapt.voltage_V = last_voltage_V(design);
    settings.adapt.passes = (int)design->compute.solid.adapt.passes.si;
  }
  const struct dea_label *file = &design->compute.reduced.file,
                         *monitor = &design->compute.reduced.monitor;
  const double voltage_V = design->compute.reduced.voltage_V.si;
  settings.reduced.design = design;
  settings.reduced.file = file->text[0] != '\0' ? file->text : NULL;
  settings.reduced.monitor = monitor->text[0] != '\0' ? monitor->text : NULL;
  settings.reduced.motion = design->compute.reduced.motion.value - 1; // the first: the largest
  settings.reduced.voltage_V = voltage_V > 0 ? voltage_V : dea_design_highest_V(design);
  settings.reduced.force = fmax(design->compute.reduced.force.si, 0);            // 0 of NAN
  settings.reduced.voltages = (int)fmax(design->compute.reduced.voltages.si, 0); // as above
  settings.reduced.forces = (int)fmax(design->compute.reduced.forces.si, 0);
  settings.reduced.air_kg_per_m3 = fmax(design->compute.reduced.air_kg_per_m3.si, 0);
  return settings;
}

dea_status dea_model_check(struct dea_context *ctx, const struct dea_model_type *type,
                           const struct dea_design *design, const struct dea_device *device)
{
  if (device != NULL && (device->disc || !type->any_layout)) {
    struct dea_film film;
    DEA_TRY(ctx, dea_device_require_disc(ctx, device));
    DEA_TRY(ctx, dea_film_create(ctx, device, &film));
  }
  return DEA_CHAIN(ctx, type->check != NULL ? type->check(ctx, design, device) : DEA_OK);
}

static dea_status create(struct dea_context *ctx, const struct dea_model_type *type,
                         const struct dea_design *design, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  DEA_TRY(ctx, dea_model_check(ctx, type, design, device));
  return DEA_CHAIN(ctx, type->create(ctx, device, settings, out));
}

dea_status dea_model_create(struct dea_context *ctx, const struct dea_model_type *type,
                            const struct dea_design *design, const struct dea_device *device,
                            struct dea_model **out)
{
  const struct dea_model_settings settings = dea_model_settings_of(design);
  return create(ctx, type, design, device, &settings, out);
}

dea_status dea_model_create_whole(struct dea_context *ctx, const struct dea_model_type *type,
                                  const struct dea_design *design, const struct dea_device *device,
                                  struct dea_model **out)
{
  struct dea_model_settings settings = dea_model_settings_of(design);
  settings.domain = device->disc ? settings.domain : DEA_DOMAIN_DISC;
  return create(ctx, type, design, device, &settings, out);
}

static dea_status lacks(struct dea_context *ctx, const struct dea_model_type *type,
                        const char *what)
{
  return dea_fail(ctx, DEA_E_UNSUPPORTED, "the model '%s' does not support %s", type->name, what);
}

dea_status dea_model_path(struct dea_context *ctx, const struct dea_model_type *type,
                          struct dea_model *model, const struct dea_path_options *options,
                          dea_point_sink points, dea_event_sink events, void *user)
{
  dea_status (*path)(struct dea_context *, struct dea_model *, const struct dea_path_options *,
                     dea_point_sink, dea_event_sink, void *) =
      type->path != NULL ? type->path : type->long_path;
  return path != NULL ? path(ctx, model, options, points, events, user)
                      : lacks(ctx, type, "equilibrium path");
}

static dea_status get_last(void *user, const struct dea_load_point *point)
{
  *(struct dea_load_point *)user = *point;
  return DEA_OK;
}

dea_status dea_model_stretch(struct dea_context *ctx, const struct dea_model_type *type,
                             struct dea_model *model, const struct dea_device *device,
                             double stretch, struct dea_load_point *out)
{
  static const double close = 1e-9;
  const struct dea_path_options options = {
      .max_stretch = dea_device_pre_stretch(device) * stretch,
      .max_voltage_V = INFINITY,
      .max_points = type->path != NULL ? DEA_PATH_POINTS_MAX : DEA_LONG_PATH_POINTS_MAX,
      .stays = true};
  *out = dea_load_point_empty();
  DEA_TRY(ctx, dea_model_path(ctx, type, model, &options, get_last, NULL, out));
  return fabs(out->electrode_stretch - stretch) <= close * stretch
             ? DEA_OK
             : dea_fail(ctx, DEA_E_NO_EQUILIBRIUM,
                        "the path ends at an electrode stretch of %.4g, before %.4g",
                        out->electrode_stretch, stretch);
}

/* Quantities of a device at a voltage, or at the stretch that is held, out [dea_gradient_width];
 * NAN without an equilibrium there, and of monitors, which no model without a gradient of its own
 * has. */
static dea_status answer(struct dea_context *ctx, const struct dea_model_type *type,
                         const struct dea_model_settings *settings, const struct dea_device *device,
                         double voltage_V, const struct dea_gradient_request *ask, double *out)
{
  struct dea_model *model;
  struct dea_load_point point;
  size_t errors = dea_finding_trial_begin(ctx);
  dea_status status = type->create(ctx, device, settings, &model);
  if (status == DEA_OK) {
    status = ask->holds_stretch ? dea_model_stretch(ctx, type, model, device, ask->stretch, &point)
                                : type->solve(ctx, model, voltage_V, &point);
    type->destroy(ctx, model);
  }
  dea_finding_trial_end(ctx, errors);
  for (size_t i = 0; i < ask->column_count; i++) {
    out[i] = status == DEA_OK ? dea_point_get(&point, ask->columns[i]) : NAN;
  }
  for (size_t i = 0; i < ask->monitor_count; i++) {
    out[ask->column_count + i] = NAN;
  }
  return DEA_CHAIN(ctx, dea_forgive(ctx, status));
}

/* Differences of the changed devices, which are solved each by itself. */
static dea_status difference(struct dea_context *ctx, const struct dea_model_type *type,
                             const struct dea_model_settings *settings,
                             const struct dea_gradient_request *ask, double *out)
{
  const size_t width = dea_gradient_width(ask);
  double *sides = dea_alloc(ctx, 2 * width, sizeof *sides);
  dea_status status = sides != NULL ? DEA_OK : DEA_E_MEMORY;
  for (size_t c = 0; c < ask->change_count && status == DEA_OK; c++) {
    const struct dea_design_change *change = &ask->changes[c];
    for (size_t k = 0; k < 2 && status == DEA_OK; k++) {
      status = answer(ctx, type, settings, change->device[k], change->voltage_V[k], ask,
                      sides + k * width);
    }
    for (size_t i = 0; i < width && status == DEA_OK; i++) {
      out[c * width + i] = (sides[width + i] - sides[i]) / change->width;
    }
  }
  dea_free(ctx, sides);
  return status;
}

dea_status dea_model_gradient(struct dea_context *ctx, const struct dea_model_type *type,
                              struct dea_model *model, const struct dea_model_settings *settings,
                              const struct dea_gradient_request *ask, double *out)
{
  return DEA_CHAIN(ctx, type->gradient != NULL ? type->gradient(ctx, model, ask, out)
                                               : difference(ctx, type, settings, ask, out));
}

dea_status dea_model_indent(struct dea_context *ctx, const struct dea_model_type *type,
                            struct dea_model *model, const struct dea_probe *tip, double depth_m,
                            struct dea_load_point *out)
{
  return type->indent != NULL ? type->indent(ctx, model, tip, depth_m, out)
                              : lacks(ctx, type, "indenter");
}

dea_status dea_model_fields(struct dea_context *ctx, const struct dea_model_type *type,
                            struct dea_model *model, enum dea_fields_part part,
                            struct dea_field_mesh **out)
{
  return type->fields != NULL ? type->fields(ctx, model, part, out) : lacks(ctx, type, "fields");
}
