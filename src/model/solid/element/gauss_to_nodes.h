/* From values at Gauss points to values at nodes, for the elements that recover. */
#pragma once

#include "model/solid/element/element.h"

enum {
  DEA_FIT_LINE_MAX = DEA_HEX_ORDER_MAX + 1,
  DEA_FIT_VALUES = 17, // of a point: F 9, stress 6, elastic energy, field
};

/* The polynomials nearest to the values at the Gauss points, in the mean square: in the plane one
 * degree below the displacements; through the thickness too, but at least linear, since a plate
 * that bends has stresses linear in z. Along each axis the value at node i is the sum over the
 * Gauss points q of fit[i][q] times theirs. */
struct dea_gauss_fit {
  int n, nz; // nodes, and Gauss points, along the axes; nz 1: flat
  double plane[DEA_FIT_LINE_MAX][DEA_FIT_LINE_MAX], z[DEA_FIT_LINE_MAX][DEA_FIT_LINE_MAX];
};

/* order_z: 0 for a flat element. back: the other way: values at the Gauss points of what has these
 * values at the nodes, by the basis of the element. */
void dea_fit_create(int order, int order_z, bool back, struct dea_gauss_fit *out);
/* Values at the nodes from those at the Gauss points, [gauss][width] to [nodes][width], or back.
 * Both are numbered first axis fastest. */
void dea_fit_nodes(const struct dea_gauss_fit *fit, int width, const double *at, double *out);
/* Numbers of nodes, F, stress, energy and field of all of them, and the force through the thickness
 * [m] of the element. P: [gauss][3][columns], of which the first two count; along the plane it is
 * fitted as the stress. */
void dea_recovered_set(const struct dea_gauss_fit *fit, double (*at)[DEA_FIT_VALUES],
                       double thickness_m, const double *P, int columns, struct dea_recovered *out);
