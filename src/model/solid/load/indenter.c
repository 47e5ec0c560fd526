#include "model/solid/load/indenter.h"

#include <math.h>
#include <string.h>

dea_status dea_indenter_check(struct dea_context *ctx, struct dea_indenter *tip)
{
  double *a = tip->axis, length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  if (!(tip->radius_m > 0) || !isfinite(tip->radius_m)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a tip needs a radius above 0");
  }
  if (tip->shape == DEA_INDENTER_SPHERE) {
    memset(a, 0, 3 * sizeof *a);
    tip->half_length_m = 0;
    return DEA_OK;
  }
  if (!(length > 0) || !isfinite(length)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a tip that is not a sphere needs an axis");
  }
  for (int i = 0; i < 3; i++) {
    a[i] /= length;
  }
  if (tip->shape == DEA_INDENTER_FLAT &&
      !(tip->edge_radius_m > 0 && tip->edge_radius_m <= tip->radius_m)) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "the edge of a flat tip needs a radius above 0 and up to that of the tip: a "
                    "sharp edge has no normal");
  }
  if (tip->shape == DEA_INDENTER_CYLINDER && !(tip->half_length_m >= 0)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a cylinder on its side needs a length of 0 or more");
  }
  return DEA_OK;
}

/* Sets out[3][3] = f (1 - a a^T - b b^T); a, b: orthonormal, or 0. */
static void project(double f, const double a[3], const double b[3], double *out)
{
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      out[3 * i + j] = f * ((i == j ? 1 : 0) - a[i] * a[j] - b[i] * b[j]);
    }
  }
}

/* Spheres and cylinders: the distance to a piece of the axis less the radius. */
static double round_tip(const struct dea_indenter *tip, const double r[3], double normal[3],
                        double *hessian)
{
  static const double none[3] = {0, 0, 0};
  const double *a = tip->axis;
  double along = a[0] * r[0] + a[1] * r[1] + a[2] * r[2];
  bool beside = fabs(along) < tip->half_length_m;
  double foot = beside ? along : copysign(tip->half_length_m, along), distance = 0;
  for (int i = 0; i < 3; i++) {
    normal[i] = r[i] - foot * a[i];
    distance += normal[i] * normal[i];
  }
  distance = sqrt(distance);
  for (int i = 0; i < 3; i++) { // on the axis itself any direction will do
    normal[i] = distance > 0 ? normal[i] / distance : i == 2;
  }
  if (hessian != NULL) {
    project(distance > 0 ? 1 / distance : 0, normal, beside ? a : none, hessian);
  }
  return distance - tip->radius_m;
}

/* Flat end: in the plane of the axis, from the centre of the rounded edge, out[0] outwards and
 * out[1] out of the end. */
static double flat_tip(const struct dea_indenter *tip, const double r[3], double normal[3],
                       double *hessian)
{
  const double *a = tip->axis;
  double e = tip->edge_radius_m, height = a[0] * r[0] + a[1] * r[1] + a[2] * r[2], radial[3];
  double rho = 0;
  for (int i = 0; i < 3; i++) {
    radial[i] = r[i] - height * a[i];
    rho += radial[i] * radial[i];
  }
  rho = sqrt(rho);
  for (int i = 0; i < 3; i++) {
    radial[i] = rho > 0 ? radial[i] / rho : 0;
  }
  double out[2] = {rho - (tip->radius_m - e), e - height};
  double along[2] = {0, 1}, distance = out[1] - e, turn = 0; // on the flat end
  if (out[0] > 0 && out[1] > 0) {                            // round the edge
    double length = hypot(out[0], out[1]);
    along[0] = out[0] / length;
    along[1] = out[1] / length;
    distance = length - e;
    turn = 1 / length;
  } else if (out[0] > out[1] && rho > 0) { // beside the tip
    along[0] = 1;
    along[1] = 0;
    distance = out[0] - e;
  }
  for (int i = 0; i < 3; i++) {
    normal[i] = along[0] * radial[i] - along[1] * a[i];
  }
  if (hessian != NULL) {
    project(along[0] > 0 ? along[0] / rho : 0, radial, a, hessian);
    for (int i = 0; i < 9; i++) { // along the meridian
      double ti = along[1] * radial[i / 3] + along[0] * a[i / 3];
      double tj = along[1] * radial[i % 3] + along[0] * a[i % 3];
      hessian[i] += turn * ti * tj;
    }
  }
  return distance;
}

static double plane_tip(const double *axis, const double r[3], double normal[3], double *hessian)
{
  for (int i = 0; i < 3; i++) {
    normal[i] = -axis[i];
  }
  if (hessian != NULL) {
    memset(hessian, 0, 9 * sizeof *hessian);
  }
  return normal[0] * r[0] + normal[1] * r[1] + normal[2] * r[2];
}

double dea_indenter_distance(const struct dea_indenter *tip, const double place_m[3],
                             const double x_m[3], double normal[3], double *hessian)
{
  const double r[3] = {x_m[0] - place_m[0], x_m[1] - place_m[1], x_m[2] - place_m[2]};
  return tip->shape == DEA_INDENTER_FLAT    ? flat_tip(tip, r, normal, hessian)
         : tip->shape == DEA_INDENTER_PLANE ? plane_tip(tip->axis, r, normal, hessian)
                                            : round_tip(tip, r, normal, hessian);
}
