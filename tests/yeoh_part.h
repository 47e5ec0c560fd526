/* The silicone of the paper's Table 1 as the part material of a film. */
#pragma once

#include "model/solid/point/part_material.h"
#include "testing.h"

/* Pre-stretched alike along both axes, free of stress through its thickness. */
static inline struct dea_part_material yeoh_part(double pre_stretch, double permittivity_F_per_m,
                                                 double thickness_m)
{
  const double z = 1 / (pre_stretch * pre_stretch);
  struct dea_part_material film = {.law = dea_law_find("yeoh"),
                                   .param = {178.4e3, -6e3, 4.2e3},
                                   .pre_stretch = {pre_stretch, pre_stretch, z},
                                   .kappa_Pa = 4e7,
                                   .permittivity_F_per_m = permittivity_F_per_m,
                                   .thickness_m = thickness_m};
  assert_int_equal(dea_part_material_relax(&film), DEA_OK);
  return film;
}
