#include "material/material_identity.h"

static void add(struct dea_text *out, const char *name, const double *values, size_t count)
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
  add(out, "parameters", m->param, DEA_LAW_PARAM_MAX);
  add(out, "breakdown", breakdown, sizeof breakdown / sizeof breakdown[0]);
  add(out, "others", others, sizeof others / sizeof others[0]);
  for (size_t i = 0; i < DEA_BRANCHES_MAX; i++) {
    add(out, "branch", (const double[]){m->branches[i].modulus_Pa, m->branches[i].time_s}, 2);
  }
}
