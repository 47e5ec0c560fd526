/* A disc of film in a rigid round frame, with radial fibres: the short form of a design. */
#include "device/disc_layout.h"
#include "device/generator.h"
#include "device/geometry.h"

#include <math.h>

static dea_status build_film(struct dea_context *ctx, const struct dea_design *design,
                             struct dea_device *device)
{
  const struct dea_material_choice choice = {
      .law = &design->film.law,
      .permittivity = &design->film.permittivity,
      .breakdown = &design->film.breakdown,
      .viscosity = &design->film.viscosity,
  };
  const double pre_stretch[2] = {design->pre_stretch.si, design->pre_stretch.si};
  const struct dea_generator_film film = {
      .material = &device->film,
      .what = "the film",
      .name = &design->film.material,
      .choice = &choice,
      .pre_stretch = pre_stretch,
      .pre_stretch_place = design->pre_stretch.location,
  };
  DEA_TRY(ctx, dea_generator_material(ctx, design, &design->film.material, &choice, &device->film));
  dea_device_fit_breakdown(device);
  DEA_TRY(ctx, dea_generator_check_film(ctx, &film));
  DEA_TRY(ctx, dea_generator_check_reach(ctx, film.material, film.what, pre_stretch,
                                         film.pre_stretch_place));
  return dea_generator_check_film_in_time(ctx, design, &film);
}

static dea_status build_electrode(struct dea_context *ctx, const struct dea_design *design,
                                  struct dea_device *device)
{
  const struct dea_material_choice first = {0};
  if (design->electrodes.material.origin != DEA_ABSENT) {
    DEA_TRY(ctx, dea_generator_material(ctx, design, &design->electrodes.material, &first,
                                        &device->electrode));
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
  const double pre_stretch[2] = {device->pre_stretch, device->pre_stretch};
  return device->electrode_thickness_m > 0
             ? dea_generator_check_reach(ctx, &device->electrode, "the electrodes", pre_stretch,
                                         design->pre_stretch.location)
             : DEA_OK;
}

static dea_status build_fibre(struct dea_context *ctx, const struct dea_design *design,
                              struct dea_device *device)
{
  const struct dea_material_choice first = {0};
  if (!design->has_fibres) {
    return DEA_OK;
  }
  DEA_TRY(ctx,
          dea_generator_material(ctx, design, &design->fibres.material, &first, &device->fibre));
  if (device->fibre.young_modulus_Pa == 0) {
    return dea_finding_add(ctx, DEA_ERROR, design->fibres.material.location,
                           "material '%s' has no linear elastic constants and cannot be a fibre",
                           device->fibre.name);
  }
  return DEA_OK;
}

/* Leads run halfway between two fibres, that of the bottom electrode as far from the other one as
 * that allows. One fibre alone has them at right angles. */
static void add_leads(const struct dea_design *design, const struct dea_device *device)
{
  const struct dea_quantity *given = &design->fabrication.leads.angle_rad;
  struct dea_layout_electrode *electrodes = device->layout->electrodes;
  const int N = device->fibre_count, fibres = N == 1 ? 2 : N;
  const double half = fibres > 0 ? DEA_PI / fibres : 0, step = 2 * half;
  for (size_t i = 0; i < device->layout->electrode_count; i++) {
    double angle = given->origin != DEA_ABSENT ? given->si : half;
    if (!electrodes[i].top) {
      const double opposite = angle + DEA_PI;
      angle = fibres > 0 ? half + step * floor((opposite - half) / step + 0.5 - 1e-9) : opposite;
    }
    electrodes[i].lead = true;
    electrodes[i].lead_rad = device->angle_rad + angle;
  }
}

/* Values of the design that regions are made of. */
static void add_locations(const struct dea_design *design, struct dea_layout *layout)
{
  const struct dea_location of[] = {design->frame.radius_m.location,
                                    design->electrodes.radius.length.location};
  for (size_t i = 0; i < layout->region_count; i++) {
    struct dea_region *region = &layout->regions[i].region;
    for (size_t k = 0; k < region->vertex_count; k++) {
      region->vertex[k].location = i < 2 ? of[i] : design->fibres.width_m.location;
    }
  }
}

dea_status dea_generator_disc(struct dea_context *ctx, const struct dea_design *design,
                              struct dea_device *device)
{
  typedef dea_status (*build_fn)(struct dea_context *, const struct dea_design *,
                                 struct dea_device *);
  static const build_fn parts[] = {build_film, build_electrode, build_fibre};
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  device->disc = true;
  dea_geometry_fill(design, device);
  for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
    dea_status status = parts[i](ctx, design, device);
    if (status != DEA_OK && status != DEA_E_DESIGN) { // a finding lets the other parts be checked
      return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
    }
  }
  DEA_TRY(ctx, dea_geometry_check(ctx, design, device));
  if (dea_finding_count(ctx, DEA_ERROR) > errors) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_disc_layout_create(ctx, device, false, &device->layout));
  struct dea_layout_ply *film = &device->layout->plies[device->layout->electrodes[0].ply];
  const struct dea_label *law = &design->film.law;
  const bool given = law->origin != DEA_ABSENT && law->origin != DEA_DEFAULT;
  film->location = given ? law->location : design->film.material.location;
  add_leads(design, device);
  add_locations(design, device->layout);
  return dea_layout_find_symmetry(ctx, device->layout);
}
