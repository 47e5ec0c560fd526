#include "device/identity.h"

#include <math.h>
#include <string.h>

static void add_numbers(struct dea_text *out, const char *name, const double *values, size_t count)
{
  dea_text_add(out, "%s", name);
  for (size_t i = 0; i < count; i++) {
    dea_text_add(out, " %.12g", values[i]);
  }
  dea_text_add(out, "\n");
}

void dea_material_identity(const struct dea_material *m, struct dea_text *out)
{
  const struct dea_breakdown_law *law = &m->breakdown.law;
  const double breakdown[] = {m->breakdown.known,
                              m->breakdown.at_rest_V_per_m,
                              m->breakdown.exponent,
                              m->breakdown.exponent_known,
                              law->at_rest_V_per_m,
                              law->exponent,
                              law->thickness_exponent,
                              law->thickness_m,
                              law->shape,
                              law->area_m2,
                              law->electrode_factor,
                              law->low,
                              law->high};
  const double others[] = {m->fibre_angle_rad,   m->permittivity.at_rest, m->permittivity.slope,
                           m->density_kg_per_m3, m->viscosity_assumed,    m->resistivity_ohm_m,
                           m->young_modulus_Pa,  m->poisson_ratio,        m->stretch_min,
                           m->stretch_max,       (double)m->branch_count};
  dea_text_add(out, "law %s\n", m->law != NULL ? m->law->name : "none");
  add_numbers(out, "parameters", m->param, DEA_LAW_PARAM_MAX);
  add_numbers(out, "breakdown", breakdown, sizeof breakdown / sizeof breakdown[0]);
  add_numbers(out, "others", others, sizeof others / sizeof others[0]);
  for (size_t i = 0; i < DEA_BRANCHES_MAX; i++) {
    add_numbers(out, "branch", (const double[]){m->branches[i].modulus_Pa, m->branches[i].time_s},
                2);
  }
}

static bool begins(const char *path, const char *key)
{
  const size_t length = strlen(key);
  return strncmp(path, key, length) == 0 &&
         (path[length] == '\0' || path[length] == '.' || path[length] == '[');
}

bool dea_identity_has(const char *path)
{
  static const char *const others[] = {"dea", // one version only
                                       "title",
                                       "fabrication",    // of the workshop
                                       "drive",          // of studies in time
                                       "materials",      // as the device has resolved them
                                       "compute.models", // who asks chooses the model
                                       // studies that solve no equilibrium of the sweep:
                                       "compute.compare", "compute.convergence",
                                       "compute.frequency", "compute.loading", "compute.modal",
                                       "compute.sensitivity", "compute.states", "compute.transient",
                                       "compute.operating_map", "compute.uncertainty", //
                                       "report"};
  for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
    if (begins(path, others[i])) {
      return false;
    }
  }
  return true;
}

/* The film state that a length is of: "5 mm stretched" and "5 mm unstretched" are different. */
static const char *state_of(const char *text)
{
  const char *word = strrchr(text, ' ');
  return word != NULL && (strcmp(word + 1, dea_film_state_name(DEA_STRETCHED)) == 0 ||
                          strcmp(word + 1, dea_film_state_name(DEA_UNSTRETCHED)) == 0)
             ? word
             : "";
}

static void add_value(struct dea_text *out, const struct dea_listed *item)
{
  if (isnan(item->si)) {
    dea_text_add(out, "%s=%s\n", item->path, item->text != NULL ? item->text : "");
  } else {
    dea_text_add(out, "%s=%.12g%s\n", item->path, item->si, state_of(item->text));
  }
}

/* Contours, which may come from files. */
static void add_regions(struct dea_text *out, const struct dea_layout *layout)
{
  for (size_t i = 0; i < layout->region_count; i++) {
    const struct dea_region *region = &layout->regions[i].region;
    dea_text_add(out, "region %s\n", layout->regions[i].name);
    for (size_t k = 0; k < region->vertex_count; k++) {
      const struct dea_vertex *vertex = &region->vertex[k];
      dea_text_add(out, "%.12g,%.12g,%.12g\n", vertex->x_m, vertex->y_m, vertex->bulge);
    }
  }
}

void dea_device_identity(const struct dea_design *design, const struct dea_device *device,
                         const char *but, struct dea_text *out)
{
  for (size_t i = 0; i < design->values.count; i++) {
    const struct dea_listed *item = &design->values.items[i];
    if (dea_identity_has(item->path) && (but == NULL || !begins(item->path, but))) {
      add_value(out, item);
    }
  }
  if (device == NULL) {
    return;
  }
  dea_material_identity(&device->film, out);
  dea_material_identity(&device->fibre, out);
  dea_material_identity(&device->electrode, out);
  if (design->parts != NULL) {
    add_regions(out, device->layout);
    for (size_t i = 0; i < device->layout->ply_count; i++) {
      dea_material_identity(&device->layout->plies[i].material, out);
    }
  }
}
