#include "device/geometry.h"

#include <math.h>
#include <string.h>

/* Resolves a name: the design's own materials first, then the catalogue. An unknown name or set, or
 * an error in the material's file, is a finding. */
static dea_status resolve(struct dea_context *ctx, const struct dea_design *design,
                          const struct dea_label *name, const struct dea_material_choice *choice,
                          struct dea_material *out)
{
  for (size_t i = 0; i < design->material_count; i++) {
    if (strcmp(design->materials[i].name.text, name->text) == 0) {
      return dea_material_select(ctx, &design->materials[i], choice, out);
    }
  }
  struct dea_catalogue_entry *entry;
  DEA_TRY(ctx, dea_catalogue_read(ctx, name->text, name->location, &entry));
  dea_status status = dea_material_select(ctx, &entry->data, choice, out);
  dea_catalogue_destroy(ctx, entry);
  return status;
}

static dea_status check_film(struct dea_context *ctx, const struct dea_design *design,
                             const struct dea_material *film)
{
  struct dea_location location = design->film.material.location;
  if (film->law == NULL) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location,
                                 "material '%s' has no hyperelastic law and cannot be the film",
                                 film->name));
  }
  if (film->permittivity.at_rest == 0) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location,
                                 "material '%s' has no permittivity and cannot be the film",
                                 film->name));
  }
  if (!film->breakdown.known) {
    DEA_TRY(ctx,
            dea_finding_add(ctx, DEA_NOTE, location,
                            "the breakdown field of '%s' is unknown: results have no breakdown "
                            "margin",
                            film->name));
  }
  double l_pre = design->pre_stretch.si;
  if (film->breakdown.known && !film->breakdown.exponent_known && l_pre > 1) {
    bool chosen = design->film.breakdown.origin != DEA_ABSENT;
    DEA_TRY(ctx, dea_finding_add(
                     ctx, DEA_NOTE, chosen ? design->film.breakdown.location : location,
                     "the breakdown field of '%s', %g V/um, is that of unstretched film; it "
                     "usually grows with stretch, but by how much is unknown here and taken as "
                     "nothing, so breakdown margins at pre-stretch %g are pessimistic",
                     film->name, 1e-6 * film->breakdown.at_rest_V_per_m, l_pre));
  }
  bool ranged = film->stretch_max > 0;
  if (ranged && (l_pre < film->stretch_min || l_pre > film->stretch_max)) {
    DEA_TRY(ctx,
            dea_finding_add(ctx, DEA_WARNING, design->pre_stretch.location,
                            "the pre-stretch %g is outside the stretches %g to %g that the "
                            "data of '%s' (%s) cover",
                            l_pre, film->stretch_min, film->stretch_max, film->name, film->law_id));
  }
  return DEA_OK;
}

/* What a user should know of the film's data when it is driven. */
static dea_status check_film_in_time(struct dea_context *ctx, const struct dea_design *design,
                                     const struct dea_material *film)
{
  bool chosen = design->film.viscosity.origin != DEA_ABSENT;
  struct dea_location location =
      chosen ? design->film.viscosity.location : design->film.material.location;
  if (design->drive.waveform == NULL) {
    return DEA_OK;
  }
  if (film->branch_count == 0 && !chosen) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, location,
                                 "the viscosity of '%s' is unknown: it follows without delay",
                                 film->name));
  }
  if (film->viscosity_assumed) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, location,
                                 "the viscosity of '%s' (%s) is a plausible assumption, nobody "
                                 "measured it: times and creep show what may be, not what is",
                                 film->name, film->viscosity_id));
  }
  if (film->resistivity_ohm_m == 0) {
    DEA_TRY(ctx,
            dea_finding_add(ctx, DEA_NOTE, design->film.material.location,
                            "the resistivity of '%s' is unknown: no charge leaks", film->name));
  }
  return DEA_OK;
}

static dea_status build_film(struct dea_context *ctx, const struct dea_design *design,
                             struct dea_device *device)
{
  const struct dea_material_choice choice = {
      .law = design->film.law.text,
      .permittivity = design->film.permittivity.text,
      .breakdown = design->film.breakdown.text,
      .law_place = design->film.law.location,
      .permittivity_place = design->film.permittivity.location,
      .breakdown_place = design->film.breakdown.location,
      .viscosity = design->film.viscosity.text,
      .viscosity_place = design->film.viscosity.location,
  };
  DEA_TRY(ctx, resolve(ctx, design, &design->film.material, &choice, &device->film));
  DEA_TRY(ctx, check_film(ctx, design, &device->film));
  return check_film_in_time(ctx, design, &device->film);
}

static dea_status build_electrode(struct dea_context *ctx, const struct dea_design *design,
                                  struct dea_device *device)
{
  const struct dea_material_choice first = {0};
  if (design->electrodes.material.origin != DEA_ABSENT) {
    DEA_TRY(ctx, resolve(ctx, design, &design->electrodes.material, &first, &device->electrode));
  }
  if (device->electrode_thickness_m > 0 && device->electrode.law == NULL &&
      device->electrode.young_modulus_Pa == 0) {
    bool named = design->electrodes.material.origin != DEA_ABSENT;
    return dea_finding_add(ctx, DEA_ERROR, design->electrodes.thickness_m.location,
                           "electrodes with a thickness need a material with a law or a Young's "
                           "modulus; %s%s%s",
                           named ? "'" : "", named ? device->electrode.name : "none is given",
                           named ? "' has neither" : "");
  }
  return DEA_OK;
}

static dea_status build_fibre(struct dea_context *ctx, const struct dea_design *design,
                              struct dea_device *device)
{
  const struct dea_material_choice first = {0};
  if (!design->has_fibres) {
    return DEA_OK;
  }
  DEA_TRY(ctx, resolve(ctx, design, &design->fibres.material, &first, &device->fibre));
  if (device->fibre.young_modulus_Pa == 0) {
    return dea_finding_add(ctx, DEA_ERROR, design->fibres.material.location,
                           "material '%s' has no linear elastic constants and cannot be a fibre",
                           device->fibre.name);
  }
  return DEA_OK;
}

static dea_status fill(struct dea_context *ctx, const struct dea_design *design,
                       struct dea_device *device)
{
  typedef dea_status (*build_fn)(struct dea_context *, const struct dea_design *,
                                 struct dea_device *);
  static const build_fn parts[] = {build_film, build_electrode, build_fibre};
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  dea_geometry_fill(design, device);
  for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
    dea_status status = parts[i](ctx, design, device);
    if (status != DEA_OK && status != DEA_E_DESIGN) { // a finding lets the other parts be checked
      return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
    }
  }
  DEA_TRY(ctx, dea_geometry_check(ctx, design, device));
  size_t found = dea_finding_count(ctx, DEA_ERROR) - errors;
  if (found > 0) {
    return dea_fail(ctx, DEA_E_DESIGN, "'%s' has %zu error%s", design->file, found,
                    found > 1 ? "s" : "");
  }
  return DEA_OK;
}

dea_status dea_device_build(struct dea_context *ctx, const struct dea_design *design,
                            struct dea_device **out)
{
  *out = NULL;
  struct dea_device *device = dea_alloc(ctx, 1, sizeof *device);
  if (device == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = fill(ctx, design, device);
  if (status != DEA_OK) {
    dea_device_destroy(ctx, device);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = device;
  return DEA_OK;
}

void dea_device_destroy(struct dea_context *ctx, struct dea_device *device)
{
  if (device != NULL) {
    dea_layout_destroy(ctx, device->layout);
    dea_free(ctx, device);
  }
}
