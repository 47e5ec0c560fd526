#include "model/solid/point/part_material.h"

#include <math.h>
#include <string.h>

double dea_cofactors(const double F[9], double cof[9])
{
  cof[0] = F[4] * F[8] - F[5] * F[7];
  cof[1] = F[5] * F[6] - F[3] * F[8];
  cof[2] = F[3] * F[7] - F[4] * F[6];
  cof[3] = F[2] * F[7] - F[1] * F[8];
  cof[4] = F[0] * F[8] - F[2] * F[6];
  cof[5] = F[1] * F[6] - F[0] * F[7];
  cof[6] = F[1] * F[5] - F[2] * F[4];
  cof[7] = F[2] * F[3] - F[0] * F[5];
  cof[8] = F[0] * F[4] - F[1] * F[3];
  return F[0] * cof[0] + F[1] * cof[1] + F[2] * cof[2];
}

/* A += f d2J/dF2: eps_ikm eps_JLN F_mN. */
static void add_second_of_J(double f, const double F[9], double A[81])
{
  for (int i = 0; i < 3; i++) {
    int k1 = (i + 1) % 3, k2 = (i + 2) % 3;
    for (int J = 0; J < 3; J++) {
      int L1 = (J + 1) % 3, L2 = (J + 2) % 3;
      double *row = A + 9 * (3 * i + J);
      row[3 * k1 + L1] += f * F[3 * k2 + L2];
      row[3 * k1 + L2] -= f * F[3 * k2 + L1];
      row[3 * k2 + L1] -= f * F[3 * k1 + L2];
      row[3 * k2 + L2] += f * F[3 * k1 + L1];
    }
  }
}

double dea_part_material_pointwise(const struct dea_part_material *part_material, double J,
                                   double *slope, double *curvature)
{
  double k = 0.5 * part_material->kappa_s_Pa, excess = J - 1;
  *slope = k * (J - 1 / J);
  *curvature = k * (1 + 1 / (J * J));
  return k * (0.5 * excess * (excess + 2) - log1p(excess));
}

/* -(E^2/2) eps(q) q, q = |F_1 x F_2|^2 = |F_1|^2 |F_2|^2 - (F_1 . F_2)^2 of the in-plane columns.
 * With eps = e0 + e1 q^(1/4) its derivative by q is -k/2, k = E^2 (e0 + (5/4) e1 q^(1/4)). */
static void add_electric(const struct dea_part_material *part_material, double E, const double F[9],
                         bool tangent, struct dea_point *out)
{
  double c[2][3], m[2][2], slope[2][3]; // columns, their products, dq/dc / 2
  for (int J = 0; J < 2; J++) {
    for (int i = 0; i < 3; i++) {
      c[J][i] = F[3 * i + J];
    }
  }
  for (int J = 0; J < 2; J++) {
    for (int L = 0; L < 2; L++) {
      m[J][L] = c[J][0] * c[L][0] + c[J][1] * c[L][1] + c[J][2] * c[L][2];
    }
  }
  double q = m[0][0] * m[1][1] - m[0][1] * m[0][1], e1 = part_material->permittivity_slope_F_per_m;
  double e0 = part_material->permittivity_F_per_m - e1, root = e1 != 0 ? sqrt(sqrt(q)) : 0;
  double k = E * E * (e0 + 1.25 * e1 * root);
  double second = e1 != 0 ? -(5.0 / 32) * E * E * e1 * root / q : 0; // d2W/dq2
  out->W -= 0.5 * E * E * (e0 + e1 * root) * q;
  for (int J = 0; J < 2; J++) {
    for (int i = 0; i < 3; i++) {
      slope[J][i] = m[1 - J][1 - J] * c[J][i] - m[0][1] * c[1 - J][i];
    }
  }
  for (int J = 0; J < 2; J++) {
    int O = 1 - J; // the other column
    for (int i = 0; i < 3; i++) {
      out->P[3 * i + J] -= k * slope[J][i];
      double *row = out->A + 9 * (3 * i + J);
      for (int p = 0; p < 3 && tangent; p++) {
        row[3 * p + J] -= k * ((i == p ? m[O][O] : 0) - c[O][i] * c[O][p]);
        row[3 * p + O] -= k * (2 * c[J][i] * c[O][p] - c[O][i] * c[J][p] - (i == p ? m[0][1] : 0));
        row[3 * p + J] += 4 * second * slope[J][i] * slope[J][p];
        row[3 * p + O] += 4 * second * slope[J][i] * slope[O][p];
      }
    }
  }
}

void dea_part_material_pull_back(const struct dea_part_material *part_material, const double X[3],
                                 double out[3])
{
  double a = part_material->pre_stretch[0], b = part_material->pre_stretch[1];
  double s = part_material->pre_shear;
  const double now[3] = {a * a * X[0] + 2 * a * s * X[2] + s * s * X[1],
                         b * b * X[1] + 2 * b * s * X[2] + s * s * X[0],
                         (a * b + s * s) * X[2] + s * (a * X[0] + b * X[1])};
  memcpy(out, now, sizeof now);
}

/* Rows x of the plane and its normal, `step` numbers from one component to the next, times G. */
static void times_g(const struct dea_part_material *part_material, int step, double *x)
{
  const double *G = part_material->pre_stretch;
  double x0 = x[0], x1 = x[step], s = part_material->pre_shear;
  x[0] = x0 * G[0] + x1 * s;
  x[step] = x0 * s + x1 * G[1];
  x[2 * step] *= G[2];
}

/* P = P(FG) G, and so twice for A. */
static void pull_back_point(const struct dea_part_material *part_material, bool tangent,
                            struct dea_point *out)
{
  const double *G = part_material->pre_stretch;
  if (part_material->pre_shear != 0) {
    for (int i = 0; i < 3; i++) {
      times_g(part_material, 1, out->P + 3 * i);
    }
    for (int k = 0; k < 27 && tangent; k++) { // iJ and k of A_iJkL
      times_g(part_material, 1, out->A + 3 * k);
    }
    for (int k = 0; k < 27 && tangent; k++) { // i and kL
      times_g(part_material, 9, out->A + k / 9 * 27 + k % 9);
    }
    return;
  }
  for (int a = 0; a < 9; a++) {
    out->P[a] *= G[a % 3];
    for (int b = 0; b < 9 && tangent; b++) {
      out->A[9 * a + b] *= G[a % 3] * G[b % 3];
    }
  }
}

/* Elastic part with the pre-stretch. */
static dea_status elastic(const struct dea_part_material *part_material, const double F[9],
                          bool tangent, struct dea_point *out)
{
  const double fibre[3] = {part_material->direction[0], part_material->direction[1], 0};
  double FG[9];
  memcpy(FG, F, sizeof FG);
  for (int i = 0; i < 3; i++) {
    times_g(part_material, 1, FG + 3 * i);
  }
  DEA_TRY_STATUS(tangent
                     ? dea_point_elastic(part_material->law, part_material->param, FG, fibre, out)
                     : dea_point_stress(part_material->law, part_material->param, FG, fibre, out));
  pull_back_point(part_material, tangent, out);
  return DEA_OK;
}

double dea_part_material_modulus(const struct dea_part_material *part_material)
{
  return part_material->law->shear_modulus(part_material->param);
}

double dea_part_material_plate_modulus(const struct dea_part_material *part_material)
{
  const double nu = dea_part_material_takes_pressure(part_material) ? 0.5 : part_material->param[1];
  return 2 * dea_part_material_modulus(part_material) / (1 - nu);
}

void dea_part_material_set_law(struct dea_part_material *part_material, const struct dea_law *law,
                               const double *param)
{
  part_material->law = law;
  memcpy(part_material->param, param, law->param_count * sizeof *param);
}

struct dea_part_material dea_part_material_bonded(const double param[2])
{
  struct dea_part_material out = {.part = DEA_PART_FIBRE, .pre_stretch = {1, 1, 1}};
  dea_part_material_set_law(&out, dea_law_find("compressible-neo-hookean"), param);
  return out;
}

dea_status dea_part_material_relax(struct dea_part_material *part_material)
{
  static const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  struct dea_point point;
  part_material->p0_Pa = 0;
  if (!dea_part_material_takes_pressure(part_material)) {
    return DEA_OK;
  }
  dea_status status = elastic(part_material, one, false, &point);
  part_material->p0_Pa = -point.P[8];
  part_material->kappa_s_Pa =
      0.5 * fabs(part_material->p0_Pa); // above the third that it takes, docs/theory/solid.md
  return status;
}

dea_status dea_part_material_point(const struct dea_part_material *part_material, const double F[9],
                                   const double cof[9], double J, double pressure,
                                   double field_V_per_m, bool tangent, struct dea_point *point)
{
  DEA_TRY_STATUS(elastic(part_material, F, tangent, point));
  if (dea_part_material_takes_pressure(part_material)) {
    double slope, curvature;
    point->W += part_material->p0_Pa * (J - 1) +
                dea_part_material_pointwise(part_material, J, &slope, &curvature);
    double p = part_material->p0_Pa + slope + pressure;
    for (int a = 0; a < 9; a++) {
      point->P[a] += p * cof[a];
      for (int b = 0; b < 9 && tangent; b++) {
        point->A[9 * a + b] += curvature * cof[a] * cof[b];
      }
    }
    if (tangent) {
      add_second_of_J(p, F, point->A);
    }
  }
  if (field_V_per_m != 0 && part_material->permittivity_F_per_m > 0) {
    add_electric(part_material, field_V_per_m, F, tangent, point);
  }
  return DEA_OK;
}

void dea_part_material_second_stress(const double cof[9], double J, const double P[9], double S[9])
{
  for (int A = 0; A < 3; A++) { // F^-1 = cof^T / J
    for (int B = 0; B < 3; B++) {
      S[3 * A + B] = (cof[A] * P[B] + cof[3 + A] * P[3 + B] + cof[6 + A] * P[6 + B]) / J;
    }
  }
}

void dea_part_material_restress(const double F[9], const double cof[9], double J, double pressure,
                                const double S[6], struct dea_point *point)
{
  static const int place[9] = {0, 5, 4, 5, 1, 3, 4, 3, 2};
  double P[9], now[9];
  for (int a = 0; a < 9; a++) {
    P[a] = point->P[a] + pressure * cof[a];
  }
  add_second_of_J(pressure, F, point->A);
  dea_part_material_second_stress(cof, J, P, now);
  for (int JL = 0; JL < 9; JL++) {
    double change = S[place[JL]] - now[JL];
    for (int i = 0; i < 3; i++) {
      point->A[9 * (3 * i + JL / 3) + 3 * i + JL % 3] += change;
    }
  }
}
