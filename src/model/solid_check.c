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
  if (material->law != NULL && material->law->anisotropic) {
    snprintf(
        why, sizeof why,
        "model 3d does not know films with a direction of their own yet: ply '%.60s' is of the "
        "law '%s'",
        ply->name, material->law->name);
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

/* Keys that a design with `plies` may have and that only a disc in a frame has a use for. */
static dea_status refuse_keys_of_disc(struct dea_context *ctx, const struct dea_design *design)
{
  const struct dea_choice *side = &design->compute.solid.buckling_branch;
  const struct dea_choice *field = &design->compute.solid.field;
  const struct dea_quantity *tips = &design->compute.solid.tip_refinement;
  const struct dea_quantity *end = &design->compute.path_max_stretch;
  const struct {
    bool asked;
    const struct dea_location *where;
    const char *key;
  } keys[] = {
      {side->value != DEA_BRANCH_ANY, &side->location, "solid.buckling_branch"},
      {field->value == DEA_FIELD_COUPLED, &field->location, "solid.field: coupled"},
      {tips->origin == DEA_GIVEN || tips->origin == DEA_OVERRIDE, &tips->location,
       "solid.tip_refinement"},
      {end->origin == DEA_GIVEN || end->origin == DEA_OVERRIDE, &end->location, "path.max_stretch"},
  };
  dea_status first = DEA_OK;
  for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
    char message[160];
    snprintf(message, sizeof message,
             "model 3d: compute.%s is of a disc in a frame, not of devices made of `plies`",
             keys[i].key);
    dea_status status = keys[i].asked ? dea_refuse(ctx, *keys[i].where, message) : DEA_OK;
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

static dea_status check_field(struct dea_context *ctx, const struct dea_design *design,
                              const struct dea_device *device)
{
  if (design->compute.solid.field.value != DEA_FIELD_COUPLED) {
    return DEA_OK;
  }
  if (device->film.permittivity.slope != 0) {
    DEA_TRY(ctx,
            dea_refuse(ctx, design->compute.solid.field.location,
                       "model 3d: a coupled field needs a constant permittivity, and that of the "
                       "film depends on stretch (film.permittivity)"));
  }
  if (design->compute.solid.film.value == DEA_FILM_MEMBRANE) {
    DEA_TRY(ctx, dea_refuse(ctx, design->compute.solid.field.location,
                            "model 3d: a coupled field needs a film with a thickness "
                            "(compute.solid.film: solid)"));
  }
  return DEA_OK;
}

dea_status dea_solid_check_design(struct dea_context *ctx, const struct dea_design *design,
                                  const struct dea_device *device)
{
  const struct dea_layout *l = device->layout;
  DEA_TRY(ctx, device->disc ? check_field(ctx, design, device) : refuse_keys_of_disc(ctx, design));
  DEA_TRY(ctx, design->compute.solid.adapt.asked ? check_adapt(ctx, design, l) : DEA_OK);
  for (size_t i = 0; l != NULL && i < l->ply_count; i++) {
    DEA_TRY(ctx, dea_solid_check_ply(ctx, l, i));
  }
  DEA_TRY(ctx, check_weight(ctx, design, device));
  return DEA_OK;
}
