/* What a part of a material is made of, as the elements take it. */
#pragma once

#include "model/solid/point/part_material.h"

/* Of the material's law, stretched before it came to the flat state, along two axes of which the
 * first is turned by an angle from x. */
struct dea_part_material dea_part_material_stretched(enum dea_part part,
                                                     const struct dea_material *material,
                                                     const double pre_stretch[2], double angle_rad);
/* Bonded free of stress; a Poisson's ratio of 0.49 and more is taken as incompressible. */
struct dea_part_material dea_part_material_free(enum dea_part part, double young_modulus_Pa,
                                                double poisson_ratio);
/* Permittivity of a film between electrodes h apart, as it depends on its area. */
void dea_part_material_set_permittivity(struct dea_part_material *part_material,
                                        const struct dea_permittivity *permittivity,
                                        double thickness_m);
