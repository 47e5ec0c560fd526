/* Materials by name, and what a dielectric needs of its own. */
#include "device/generator.h"
#include "material/plane.h"

#include <math.h>
#include <string.h>

dea_status dea_generator_material(struct dea_context *ctx, const struct dea_design *design,
                                  const struct dea_label *name,
                                  const struct dea_material_choice *choice,
                                  struct dea_material *out)
{
  struct dea_material_choice here = *choice;
  here.temperature = &design->temperature_K;
  for (size_t i = 0; i < design->material_count; i++) {
    if (strcmp(design->materials[i].name.text, name->text) == 0) {
      return dea_material_select(ctx, &design->materials[i], &here, out);
    }
  }
  struct dea_catalogue_entry *entry;
  DEA_TRY(ctx, dea_catalogue_read(ctx, name->text, name->location, &entry));
  dea_status status = dea_material_select(ctx, &entry->data, &here, out);
  dea_catalogue_destroy(ctx, entry);
  return status;
}

/* What is known of the breakdown of a film under its pre-stretch. */
static dea_status note_breakdown(struct dea_context *ctx, const struct dea_generator_film *film)
{
  const struct dea_material *material = film->material;
  double l_pre = sqrt(film->pre_stretch[0] * film->pre_stretch[1]);
  if (!material->breakdown.known) {
    return dea_finding_add(ctx, DEA_NOTE, film->name->location,
                           "the breakdown field of '%s' is unknown: results have no breakdown "
                           "margin",
                           material->name);
  }
  if (!material->breakdown.exponent_known && l_pre > 1) {
    const struct dea_label *chosen = film->choice->breakdown;
    return dea_finding_add(ctx, DEA_NOTE,
                           (chosen->origin != DEA_ABSENT ? chosen : film->name)->location,
                           "the breakdown field of '%s', %g V/um, is that of unstretched film; it "
                           "usually grows with stretch, but by how much is unknown here and taken "
                           "as nothing, so breakdown margins at pre-stretch %g are pessimistic",
                           material->name, 1e-6 * material->breakdown.at_rest_V_per_m, l_pre);
  }
  return DEA_OK;
}

dea_status dea_generator_check_reach(struct dea_context *ctx, const struct dea_material *material,
                                     const char *what, const double *pre_stretch,
                                     struct dea_location place)
{
  struct dea_plane plane;
  if (dea_plane_elastic(material, pre_stretch[0], pre_stretch[1], &plane) != DEA_E_DOMAIN) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_ERROR, place,
                         "the law '%s' (%s) of '%s' ends before the pre-stretch %g of %s: take a "
                         "smaller pre-stretch, or parameters that reach further",
                         material->law->name, material->law_id, material->name,
                         fmax(pre_stretch[0], pre_stretch[1]), what);
}

dea_status dea_generator_check_film(struct dea_context *ctx, const struct dea_generator_film *film)
{
  const struct dea_material *material = film->material;
  if (material->law == NULL) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, film->name->location,
                                 "material '%s' has no hyperelastic law and cannot be %s",
                                 material->name, film->what));
  }
  if (material->permittivity.at_rest == 0) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, film->name->location,
                                 "material '%s' has no permittivity and cannot be %s",
                                 material->name, film->what));
  }
  DEA_TRY(ctx, note_breakdown(ctx, film));
  const double *l = film->pre_stretch;
  for (int k = 0; k < 2 && material->stretch_max > 0; k++) {
    if (l[k] < material->stretch_min || l[k] > material->stretch_max) {
      return dea_finding_add(ctx, DEA_WARNING, film->pre_stretch_place,
                             "the pre-stretch %g is outside the stretches %g to %g that the data "
                             "of '%s' (%s) cover",
                             l[k], material->stretch_min, material->stretch_max, material->name,
                             material->law_id);
    }
  }
  return DEA_OK;
}

dea_status dea_generator_check_film_in_time(struct dea_context *ctx,
                                            const struct dea_design *design,
                                            const struct dea_generator_film *film)
{
  const struct dea_material *material = film->material;
  bool chosen = film->choice->viscosity->origin != DEA_ABSENT;
  struct dea_location location = (chosen ? film->choice->viscosity : film->name)->location;
  if (design->drive.waveform == NULL && !dea_parts_in_time(design->parts)) {
    return DEA_OK;
  }
  if (material->branch_count == 0 && !chosen) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, location,
                                 "the viscosity of '%s' is unknown: it follows without delay",
                                 material->name));
  }
  if (material->viscosity_assumed) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, location,
                                 "the viscosity of '%s' (%s) is a plausible assumption, nobody "
                                 "measured it: times and creep show what may be, not what is",
                                 material->name, material->viscosity_id));
  }
  if (material->resistivity_ohm_m == 0) {
    DEA_TRY(ctx,
            dea_finding_add(ctx, DEA_NOTE, film->name->location,
                            "the resistivity of '%s' is unknown: no charge leaks", material->name));
  }
  return DEA_OK;
}
