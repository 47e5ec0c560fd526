/* Rigid tips: signed distance to a sphere, a flat-ended cylinder, a cylinder on its side, a plane
 * (docs/theory/loads.md). */
#pragma once

#include "base/context.h"

enum dea_indenter_shape {
  DEA_INDENTER_SPHERE,
  DEA_INDENTER_FLAT,
  DEA_INDENTER_CYLINDER,
  DEA_INDENTER_PLANE
};

struct dea_indenter {
  enum dea_indenter_shape shape;
  double radius_m; // plane: a length to compare gaps with
  double axis[3];  // flat, plane: from its end into the tip; cylinder: along it; of any length > 0
  double edge_radius_m; // flat: of the rounded edge, above 0 and up to radius_m
  double half_length_m; // cylinder: of its axis, INFINITY: endless; half spheres at the ends
};

/* DEA_E_ARGUMENT with a message when a number is out of range; makes the axis a unit vector. */
dea_status dea_indenter_check(struct dea_context *ctx, struct dea_indenter *tip);

/* Distance of x from the surface of the tip, negative inside [m]. place: the centre of a sphere, of
 * the flat end, or of the cylinder's axis, any point of the plane. normal: its gradient, a unit
 * vector; hessian [3][3] [1/m], NULL when it is not wanted. */
double dea_indenter_distance(const struct dea_indenter *tip, const double place_m[3],
                             const double x_m[3], double normal[3], double *hessian);
