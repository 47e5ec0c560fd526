/* What elements tell of themselves after a solve (docs/theory/recovery.md).
 *
 * Inside an element stress and stretch are best at a few inner points; values at its nodes come
 * from a polynomial of one degree less than the displacements, fitted to its Gauss points. Values
 * of a node are means over the elements of the same sheet and region around it, so that film and
 * fibre, electrode and bare film do not mix where they meet. Means are taken of tensors; principal
 * values come last.
 *
 * Stress is the true (Cauchy) total stress P F^T / J: elastic part, pressure and Maxwell stress
 * together, so that a free face has none normal to it. */
#ifndef DEA_MODEL_SOLID_RECOVERY_RECOVER_H
#define DEA_MODEL_SOLID_RECOVERY_RECOVER_H

#include "model/solid/element/membrane.h"
#include "model/solid/mesh/grid.h"
#include "result/field_mesh.h"

enum { DEA_RECOVER_PLANE_MAX = 16 }; // nodes in the plane of an element

/* One element. Nodes as in hex.h; plane nodes are those of one level through the thickness. */
struct dea_recovered {
  int nodes, plane_nodes;
  double volume_m3;                       // in the stretched flat film
  double volume_error;                    // largest |J - 1| at the Gauss points
  double F[DEA_HEX_NODES_MAX][9];         // dx/dX
  double stress[DEA_HEX_NODES_MAX][6];    // xx yy zz xy yz zx [Pa]
  double energy[DEA_HEX_NODES_MAX];       // elastic, per volume of the stretched flat film [J/m^3]
  double field[DEA_HEX_NODES_MAX];        // true field [V/m]
  double force[DEA_RECOVER_PLANE_MAX][6]; // P_iJ through the thickness of the element, i1 then i2
                                          // for each i [N/m of the stretched flat film]
};

/* X, u, multiplier, voltage_V: as in dea_hex_evaluate. potential_V: [nodes] of a coupled field,
 * which voltage_V then has no part in; NULL for a thin film. DEA_E_DOMAIN for an inverted element
 * or beyond the law's domain. */
dea_status dea_hex_recover(const struct dea_hex_shape *shape, const struct dea_constituent *layer,
                           const double *X, const double *u, const double *multiplier,
                           double voltage_V, const double *potential_V, struct dea_recovered *out);
/* The same of a flat element, where J = 1 by construction. Where the film wrinkles stress and force
 * are means over the wrinkles; the field is that of the film itself. */
dea_status dea_flat_recover(const struct dea_flat_shape *shape, const struct dea_constituent *layer,
                            const double *X, const double *u, double voltage_V,
                            struct dea_recovered *out);

/* A solid at an equilibrium. u: [nodes][3]; multiplier: [elements][shape->pressures]; layer,
 * active: [elements]; potential_V: [nodes] of a coupled field, NULL for thin films. flat: for grids
 * with flat elements, else it may be NULL. */
struct dea_recover_input {
  const struct dea_grid *grid;
  const struct dea_hex_shape *shape;
  const struct dea_flat_shape *flat;
  const struct dea_constituent *layers;
  const int *layer;
  const bool *active;
  const double *u, *multiplier, *potential_V;
  double voltage_V;
};

/* All elements with displacement, stretches, stresses, tension, field and energy at points (one a
 * node, sheet and region), error of volume, sheet and region of cells. The symmetry is left to the
 * caller. out: owned by the caller, NULL on failure; DEA_E_DOMAIN as above. */
dea_status dea_recover_volume(struct dea_context *ctx, const struct dea_recover_input *in,
                              struct dea_field_mesh **out);

/* The middle surface of a sheet, between electrodes or not, under another sheet or not: these four
 * parts do not share points. Fields: those of DEA_SURFACE_* below, cells: whether between
 * electrodes and whether under a fibre. */
dea_status dea_recover_surface(struct dea_context *ctx, const struct dea_recover_input *in,
                               int sheet, struct dea_field_mesh **out);

#endif
