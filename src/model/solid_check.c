#include "model/solid_check.h"

#include <stdio.h>
#include <string.h>

/* Weight needs densities; said where the design asks for it. */
static dea_status check_weight(struct dea_context *ctx, const struct dea_design *design,
                               const struct dea_device *device)
{
  return design->gravity.value > DEA_GRAVITY_OFF
             ? dea_device_refuse_densities(ctx, design->gravity.location, device)
             : DEA_OK;
}

dea_status dea_solid_check_ply(struct dea_context *ctx, const struct dea_layout *layout, size_t i)
{
  const struct dea_layout_ply *ply = &layout->plies[i];
  const struct dea_material *material = &ply->material;
  char why[400];
  if (material->law != NULL && material->law->anisotropic && layout->polar) {
    snprintf(
        why, sizeof why,
        "model 3d does not support a direction that turns with the radius: the film is of the law "
        "'%s'; a ply of a design with `plies` has one along its `angle`",
        material->law->name);
    return dea_refuse(ctx, ply->location, why);
  }
  if (dea_layout_is_dielectric(layout, i) &&
      (material->law == NULL || !(material->permittivity.at_rest > 0))) {
    snprintf(
        why, sizeof why,
        "ply '%.60s' lies between electrodes: its material '%s' needs a law and a permittivity",
        ply->name, material->name);
    return dea_refuse(ctx, ply->location, why);
  }
  return DEA_OK;
}

/* What of a layout a coupled field does not go with; NULL: nothing. */
static const char *not_coupled(const struct dea_design *design, const struct dea_layout *l)
{
  bool slope = false, own = false, one_V = true, encloses = false;
  for (size_t i = 0; i < l->ply_count; i++) {
    slope =
        slope || (dea_layout_is_dielectric(l, i) && l->plies[i].material.permittivity.slope != 0);
  }
  for (size_t k = 1; k < l->channel_count; k++) {
    own = own || l->channels[k].own_V != 0 || l->channels[k].waveform != NULL;
    one_V = one_V && k == 1;
  }
  for (size_t i = 0; i < l->pressure_count; i++) {
    encloses = encloses || l->pressures[i].encloses != DEA_OPEN;
  }
  return design->compute.solid.film.value == DEA_FILM_MEMBRANE
             ? "needs films with a thickness (compute.solid.film: solid)"
         : slope         ? "needs a constant permittivity, and that of a ply depends on stretch"
         : !one_V || own ? "has one channel, at a share of the sweep's voltage alone"
         : encloses      ? "knows no enclosed volumes"
         : l->body_count > 0
             ? "knows no rigid bodies: a stiff ply that is held has a field of its own"
             : NULL;
}

static dea_status check_coupled(struct dea_context *ctx, const struct dea_design *design,
                                const struct dea_layout *layout)
{
  char message[200];
  const char *why =
      design->compute.solid.field.value == DEA_FIELD_COUPLED ? not_coupled(design, layout) : NULL;
  snprintf(message, sizeof message, "model 3d: a coupled field %s", why != NULL ? why : "");
  return why != NULL ? dea_refuse(ctx, design->compute.solid.field.location, message) : DEA_OK;
}

/* Keys that a design with `plies` may have and that only a disc in a frame has a use for. */
static dea_status refuse_keys_of_disc(struct dea_context *ctx, const struct dea_design *design)
{
  const struct dea_quantity *tips = &design->compute.solid.tip_refinement;
  const struct dea_quantity *end = &design->compute.path_max_stretch;
  const struct {
    const struct dea_quantity *given;
    const char *key, *instead;
  } keys[] = {
      {tips, "solid.tip_refinement",
       "their free mesh is finer where a monitor's error comes from (compute.solid.adapt), and has "
       "rows along all edges"},
      {end, "path.max_stretch",
       "they have no electrode's stretch: their path ends at the highest voltage "
       "(compute.voltage)"},
  };
  dea_status first = DEA_OK;
  for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
    char message[300];
    snprintf(message, sizeof message,
             "model 3d: compute.%s is of a disc in a frame, not of devices made of `plies`: %s",
             keys[i].key, keys[i].instead);
    const bool given = keys[i].given->origin == DEA_GIVEN || keys[i].given->origin == DEA_OVERRIDE;
    dea_status status = given ? dea_refuse(ctx, keys[i].given->location, message) : DEA_OK;
    first = first == DEA_OK ? status : first;
  }
  return first;
}

/* The monitor that a mesh is refined for is there. */
static dea_status check_adapt(struct dea_context *ctx, const struct dea_design *design,
                              const struct dea_layout *l)
{
  const struct dea_label *name = &design->compute.solid.adapt.monitor;
  char message[300];
  for (size_t i = 0; l != NULL && i < l->monitor_count; i++) {
    if (strcmp(l->monitors[i].name, name->text) == 0) {
      return DEA_OK;
    }
  }
  snprintf(message, sizeof message,
           "compute.solid.adapt: there is no monitor '%.60s' (monitors[].name, of devices made of "
           "`plies`; else take compute.solid.refinement and the study convergence)",
           name->text);
  return dea_refuse(ctx, name->location, message);
}

dea_status dea_solid_check_design(struct dea_context *ctx, const struct dea_design *design,
                                  const struct dea_device *device)
{
  const struct dea_layout *l = device->layout;
  DEA_TRY(ctx, device->disc ? DEA_OK : refuse_keys_of_disc(ctx, design));
  DEA_TRY(ctx, l != NULL ? check_coupled(ctx, design, l) : DEA_OK);
  DEA_TRY(ctx, design->compute.solid.adapt.asked ? check_adapt(ctx, design, l) : DEA_OK);
  for (size_t i = 0; l != NULL && i < l->ply_count; i++) {
    DEA_TRY(ctx, dea_solid_check_ply(ctx, l, i));
  }
  return DEA_CHAIN(ctx, check_weight(ctx, design, device));
}
