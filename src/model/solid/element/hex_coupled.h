/* Layered hexahedra with a potential: the energy of hex.h with a field that is free to spread
 * (docs/theory/coupled.md).
 *
 * Symbol   meaning                                                        unit
 * psi      potential over c                                               m
 * c        scale of the potential, about sqrt(shear modulus/permittivity) V/m
 * E        -c Grad psi, field in the stretched flat film                  V/m
 * w        cof(F) E                                                       V/m
 *
 * Energy of an element, per volume of the stretched flat film: that of hex.h without voltage, and
 * -(eps/2) |w|^2. It is to be minimal in u and maximal in psi. */
#ifndef DEA_MODEL_SOLID_ELEMENT_HEX_COUPLED_H
#define DEA_MODEL_SOLID_ELEMENT_HEX_COUPLED_H

#include "model/solid/element/hex.h"

/* X, u: [nodes][3]; psi: [nodes]; multiplier: as in dea_hex_evaluate. Of *out, g: [nodes][4] and K,
 * the fourth of each node by psi [N, N/m]. Errors of dea_hex_evaluate. */
dea_status dea_hex_coupled_evaluate(const struct dea_hex_shape *shape,
                                    const struct dea_constituent *layer, const double *X,
                                    const double *u, const double *psi, const double *multiplier,
                                    double scale_V_per_m, enum dea_eval_order level,
                                    struct dea_element_result *out);

/* Electric stiffness at displacements u: L [nodes][nodes] = eps int (cof Grad N_a).(cof Grad N_b)
 * [F], both triangles. The energy at potentials phi [V] is -(1/2) phi L phi. */
dea_status dea_hex_capacity(const struct dea_hex_shape *shape, const struct dea_constituent *layer,
                            const double *X, const double *u, double *L);

/* Forces g3 [nodes][3] and, unless NULL, tangent K3 of a piece without potential, as [nodes][4]
 * with zeros. In place (g4 = g3, K4 = K3) where there is room. */
void dea_hex_spread(int nodes, const double *g3, const double *K3, double *g4, double *K4);

#endif
