/* Consistent mass of elements (docs/theory/vibration.md): for each component of the displacement
 * the same matrix of numbers between nodes,
 *
 *   M_ab = int rho N_a N_b dV       over the stretched flat film
 *
 * A layer's pre-stretch has det G = 1: rho is the density of the unstretched material. */
#ifndef DEA_MODEL_SOLID_ELEMENT_MASS_H
#define DEA_MODEL_SOLID_ELEMENT_MASS_H

#include "model/solid/element/membrane.h"

/* X: [nodes][3]; mass: [nodes][nodes] [kg]. DEA_E_DOMAIN for an inverted element. */
dea_status dea_hex_mass(const struct dea_hex_shape *shape, const struct dea_constituent *layer,
                        const double *X, double *mass);
/* The same of a flat element, with thickness_m of its layer. */
dea_status dea_membrane_mass(const struct dea_flat_shape *shape,
                             const struct dea_constituent *layer, const double *X, double *mass);

#endif
