/* The plane-stress reduction: derivatives along the constraint lambda_3 = 1/(lambda_1 lambda_2)
 * (docs/theory/materials.md, section "Plane film").
 *
 * symbol       meaning                                              unit
 * l1, l2, l3   principal stretches, 1 and 2 in the plane            1
 * W            energy per unstretched volume                        Pa
 * s1, s2       nominal stresses dW/dl1, dW/dl2 along the constraint Pa
 * kij          d2W/(dli dlj) along the constraint                   Pa
 * s            mean in-plane stretch sqrt(l1 l2)                    1 */
#include "material/plane.h"

#include "base/context.h"

static dea_status plane_invariants(const struct dea_material *material, dea_scalar l1,
                                   dea_scalar l2, struct dea_plane *out)
{
  const struct dea_law *law = material->law;
  const dea_scalar i1 = 1.0 / l1, i2 = 1.0 / l2;
  const dea_scalar a = l1 * l1, b = l2 * l2; // squares of the stretches 1, 2, 3
  const dea_scalar ia = i1 * i1, ib = i2 * i2, c = ia * ib;
  const dea_scalar I1 = a + b + c;       // paper eq 11
  const dea_scalar I2 = a * b + ia + ib; // paper eq 8 with eq 2
  const double cosine = law->anisotropic ? cos(material->fibre_angle_rad) : 0.0;
  const double A = cosine * cosine, B = 1.0 - A; // I4 = A l1^2 + B l2^2
  const dea_scalar I4 = law->anisotropic ? A * a + B * b : 1.0;

  struct dea_law_energy e;
  DEA_TRY_STATUS(law->invariants(material->param, I1, I2, I4, &e));

  // Derivatives of the invariants by l1 and l2.
  const dea_scalar u1 = 2.0 * (l1 - c * i1), u2 = 2.0 * (l2 - c * i2);
  const dea_scalar v1 = 2.0 * (l1 * b - ia * i1), v2 = 2.0 * (l2 * a - ib * i2);
  out->W = e.W;
  out->s1 = e.W1 * u1 + e.W2 * v1;
  out->s2 = e.W1 * u2 + e.W2 * v2;
  out->k11 = e.W1 * (2.0 + 6.0 * c * ia) + e.W2 * (2.0 * b + 6.0 * ia * ia) + e.W11 * u1 * u1 +
             2.0 * e.W12 * u1 * v1 + e.W22 * v1 * v1;
  out->k22 = e.W1 * (2.0 + 6.0 * c * ib) + e.W2 * (2.0 * a + 6.0 * ib * ib) + e.W11 * u2 * u2 +
             2.0 * e.W12 * u2 * v2 + e.W22 * v2 * v2;
  out->k12 = e.W1 * 4.0 * c * i1 * i2 + e.W2 * 4.0 * l1 * l2 + e.W11 * u1 * u2 +
             e.W12 * (u1 * v2 + u2 * v1) + e.W22 * v1 * v2;
  if (law->anisotropic) {
    const dea_scalar f1 = 2.0 * A * l1, f2 = 2.0 * B * l2; // dI4/dl1, dI4/dl2
    const dea_scalar g1 = e.W14 * u1 + e.W24 * v1, g2 = e.W14 * u2 + e.W24 * v2;
    out->s1 += e.W4 * f1;
    out->s2 += e.W4 * f2;
    out->k11 += e.W4 * 2.0 * A + 2.0 * g1 * f1 + e.W44 * f1 * f1;
    out->k22 += e.W4 * 2.0 * B + 2.0 * g2 * f2 + e.W44 * f2 * f2;
    out->k12 += g1 * f2 + g2 * f1 + e.W44 * f1 * f2;
  }
  return DEA_OK;
}

static dea_status plane_principal(const struct dea_material *material, dea_scalar l1, dea_scalar l2,
                                  struct dea_plane *out)
{
  const dea_scalar l[3] = {l1, l2, 1.0 / (l1 * l2)};
  dea_scalar w[3], w1[3], w2[3];
  for (int i = 0; i < 3; i++) {
    DEA_TRY_STATUS(material->law->principal(material->param, l[i], &w[i], &w1[i], &w2[i]));
  }
  const dea_scalar t1 = l[2] / l1, t2 = l[2] / l2; // -dl3/dl1, -dl3/dl2
  out->W = w[0] + w[1] + w[2];
  out->s1 = w1[0] - w1[2] * t1;
  out->s2 = w1[1] - w1[2] * t2;
  out->k11 = w2[0] + w2[2] * t1 * t1 + 2.0 * w1[2] * t1 / l1;
  out->k22 = w2[1] + w2[2] * t2 * t2 + 2.0 * w1[2] * t2 / l2;
  out->k12 = w2[2] * t1 * t2 + w1[2] * t1 / l2;
  return DEA_OK;
}

dea_status DEA_NAME(dea_plane_elastic)(const struct dea_material *material, dea_scalar lambda1,
                                       dea_scalar lambda2, struct dea_plane *out)
{
  if (material->law == NULL || material->law->compressible != NULL) {
    return DEA_E_ARGUMENT;
  }
  if (!(DEA_RE(lambda1) > 0.0 && DEA_RE(lambda2) > 0.0)) { // also when one is not a number
    return DEA_E_DOMAIN;
  }
  DEA_TRY_STATUS(material->law->invariants != NULL
                     ? plane_invariants(material, lambda1, lambda2, out)
                     : plane_principal(material, lambda1, lambda2, out));
  // Stretches so extreme that a power of them overflows.
  return isfinite(DEA_RE(out->W + out->k11 + out->k12 + out->k22)) ? DEA_OK : DEA_E_DOMAIN;
}

void DEA_NAME(dea_plane_electric)(const struct dea_material *material, double nominal_field_V_per_m,
                                  dea_scalar lambda1, dea_scalar lambda2, struct dea_plane *out)
{
  const double slope = material->permittivity.slope;
  const double c = 0.5 * DEA_EPSILON_0 * nominal_field_V_per_m * nominal_field_V_per_m;
  const dea_scalar j = lambda1 * lambda2;
  const dea_scalar s = slope != 0.0 ? sqrt(j) : 1.0;
  const dea_scalar eps_r = material->permittivity.at_rest + slope * (s - 1.0);
  // W = -c f(j), f = eps_r j^2 (paper eq 14); deps_r/dj = slope/(2 s) is the electrostriction term.
  const dea_scalar d1 = 2.0 * eps_r * j + 0.5 * slope * s * j; // df/dj
  const dea_scalar d2 = 2.0 * eps_r + 1.75 * slope * s;        // d2f/dj2
  out->W = -c * eps_r * j * j;
  out->s1 = -c * d1 * lambda2;
  out->s2 = -c * d1 * lambda1;
  out->k11 = -c * d2 * lambda2 * lambda2;
  out->k22 = -c * d2 * lambda1 * lambda1;
  out->k12 = -c * (d2 * j + d1);
}

#ifndef DEA_COMPLEX
double dea_breakdown_field(const struct dea_material *material, double mean_stretch)
{
  const struct dea_breakdown *breakdown = &material->breakdown;
  if (!breakdown->known) {
    return NAN;
  }
  return breakdown->at_rest_V_per_m * pow(mean_stretch, breakdown->exponent);
}

struct dea_reach dea_material_reach(const struct dea_material *material, double lambda1,
                                    double lambda2)
{
  struct dea_reach reach = {NAN, NAN};
  double a = lambda1 * lambda1, b = lambda2 * lambda2;
  if (material->law != NULL && material->law->locking_share != NULL) {
    reach.locking_share = material->law->locking_share(material->param, a + b + 1 / (a * b));
  }
  if (material->stretch_max > 0) {
    reach.range_share = fmax(lambda1, lambda2) / material->stretch_max;
  }
  return reach;
}

void dea_reach_merge(struct dea_reach *reach, struct dea_reach other)
{
  reach->locking_share = fmax(reach->locking_share, other.locking_share);
  reach->range_share = fmax(reach->range_share, other.range_share);
}

void dea_breakdown_specialise(double thickness_m, double area_m2, struct dea_breakdown *breakdown)
{
  const struct dea_breakdown_law *law = &breakdown->law;
  if (law->at_rest_V_per_m == 0) {
    return; // two numbers given by hand
  }
  double at_rest = law->electrode_factor * law->at_rest_V_per_m;
  if (law->thickness_m > 0 && thickness_m > 0) { // h = H / s^2
    at_rest *= pow(thickness_m / law->thickness_m, law->thickness_exponent);
  }
  if (law->shape > 0 && area_m2 > 0) {
    at_rest *= pow(law->area_m2 / area_m2, 1 / law->shape);
  }
  breakdown->at_rest_V_per_m = at_rest;
  breakdown->exponent = law->exponent - 2 * law->thickness_exponent;
}

double dea_breakdown_probability(const struct dea_breakdown *breakdown, double margin)
{
  if (!breakdown->known || !(breakdown->law.shape > 0) || isnan(margin)) {
    return NAN;
  }
  return -expm1(-pow(fmax(1 - margin, 0), breakdown->law.shape));
}

void dea_breakdown_probability_band(const struct dea_breakdown *breakdown, double margin,
                                    double out[2])
{
  const struct dea_breakdown_law *law = &breakdown->law;
  const bool known = law->low > 0 && law->high > law->low;
  out[0] = known ? dea_breakdown_probability(breakdown, 1 - (1 - margin) / law->high) : NAN;
  out[1] = known ? dea_breakdown_probability(breakdown, 1 - (1 - margin) / law->low) : NAN;
}
#endif
