#include "complex_material.h"

#include "material/plane.h"
#include "material/point.h"

#include <string.h>

#ifndef DEA_COMPLEX
#error "this file belongs to the complex build of the kernels"
#endif

dea_status complex_invariants(const char *law, const double *param,
                              const double complex invariant[3], double complex out[10])
{
  struct dea_law_energy e;
  const dea_status status =
      DEA_NAME(dea_law_find)(law)->invariants(param, invariant[0], invariant[1], invariant[2], &e);
  const double complex members[10] = {e.W,   e.W1,  e.W2,  e.W4,  e.W11,
                                      e.W12, e.W22, e.W14, e.W24, e.W44};
  memcpy(out, members, sizeof members);
  return status;
}

dea_status complex_compressible(const char *law, const double *param,
                                const double complex argument[2], double complex out[6])
{
  struct dea_law_volume e;
  const dea_status status =
      DEA_NAME(dea_law_find)(law)->compressible(param, argument[0], argument[1], &e);
  const double complex members[6] = {e.W, e.W1, e.WJ, e.W11, e.W1J, e.WJJ};
  memcpy(out, members, sizeof members);
  return status;
}

dea_status complex_principal(const char *law, const double *param, double complex lambda,
                             double complex out[3])
{
  return DEA_NAME(dea_law_find)(law)->principal(param, lambda, &out[0], &out[1], &out[2]);
}

static void plane_copy(const struct dea_plane *plane, double complex out[6])
{
  const double complex members[6] = {plane->W,   plane->s1,  plane->s2,
                                     plane->k11, plane->k12, plane->k22};
  memcpy(out, members, sizeof members);
}

dea_status complex_plane_elastic(const char *law, const double *param, double fibre_angle_rad,
                                 const double complex lambda[2], double complex out[6])
{
  struct dea_material material = {.law = DEA_NAME(dea_law_find)(law),
                                  .fibre_angle_rad = fibre_angle_rad};
  memcpy(material.param, param, sizeof material.param);
  struct dea_plane plane = {0};
  const dea_status status = DEA_NAME(dea_plane_elastic)(&material, lambda[0], lambda[1], &plane);
  plane_copy(&plane, out);
  return status;
}

void complex_plane_electric(double eps_at_rest, double eps_slope, double nominal_field_V_per_m,
                            const double complex lambda[2], double complex out[6])
{
  const struct dea_material material = {.permittivity = {eps_at_rest, eps_slope}};
  struct dea_plane plane = {0};
  DEA_NAME(dea_plane_electric)(&material, nominal_field_V_per_m, lambda[0], lambda[1], &plane);
  plane_copy(&plane, out);
}

dea_status complex_point(const char *law, const double *param, const double complex F[9],
                         const double fibre[3], double complex *W, double complex P[9],
                         double complex A[81])
{
  struct dea_point point = {0};
  const dea_status status =
      DEA_NAME(dea_point_elastic)(DEA_NAME(dea_law_find)(law), param, F, fibre, &point);
  *W = point.W;
  memcpy(P, point.P, sizeof point.P);
  memcpy(A, point.A, sizeof point.A);
  return status;
}
