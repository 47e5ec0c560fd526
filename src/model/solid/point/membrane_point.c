#include "model/solid/point/membrane_point.h"

#include <math.h>
#include <string.h>

dea_status dea_membrane_check(const struct dea_part_material *part_material)
{
  return dea_part_material_takes_pressure(part_material) && !part_material->law->anisotropic
             ? DEA_OK
             : DEA_E_UNSUPPORTED;
}

/* A load that comes in over the depth of the film in equal parts makes a shear stress that grows
 * linearly to the bonded face: the mean displacement is that of h/3 under all of it, so h/2 is
 * given 3/2 of the film's shear modulus. */
dea_status dea_membrane_bond(const struct dea_part_material *film, struct dea_part_material *bond)
{
  static const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  static const double poisson_ratio = 0.49;
  enum { XZ = 2, YZ = 5 }; // components of F
  struct dea_point point;
  DEA_TRY_STATUS(dea_membrane_check(film));
  DEA_TRY_STATUS(dea_part_material_point(film, one, one, 1, 0, 0, true, &point));
  double across = 0.5 * (point.A[9 * XZ + XZ] + point.A[9 * YZ + YZ]), mu = 1.5 * across;
  *bond = dea_part_material_bonded((const double[]){2 * mu * (1 + poisson_ratio), poisson_ratio});
  return DEA_OK;
}

/* eps = permittivity + slope (sqrt(a) - 1) of the part material by s = sqrt(a G1 G2), as a material
 * has it.
 */
static void set_permittivity(const struct dea_part_material *part_material, double G1_G2,
                             struct dea_permittivity *out)
{
  double slope = part_material->permittivity_slope_F_per_m / sqrt(G1_G2);
  out->slope = slope / DEA_EPSILON_0;
  out->at_rest =
      (part_material->permittivity_F_per_m - part_material->permittivity_slope_F_per_m + slope) /
      DEA_EPSILON_0;
}

/* S = G S(C) G, and so twice for D. */
static void pull_back_tensors(const struct dea_part_material *part_material,
                              struct dea_tension_point *t)
{
  dea_part_material_pull_back(part_material, t->S, t->S);
  for (int a = 0; a < 3; a++) {
    dea_part_material_pull_back(part_material, t->D[a], t->D[a]);
  }
  for (int b = 0; b < 3; b++) {
    double column[3] = {t->D[0][b], t->D[1][b], t->D[2][b]};
    dea_part_material_pull_back(part_material, column, column);
    for (int a = 0; a < 3; a++) {
      t->D[a][b] = column[a];
    }
  }
}

/* B and C* of the flat film count like c; those of the unstretched one are G^-1 B G^-1 and G C* G.
 */
static struct dea_part_material inverse_of(const struct dea_part_material *part_material,
                                           double det)
{
  const double *G = part_material->pre_stretch, s = part_material->pre_shear;
  return (struct dea_part_material){.pre_stretch = {G[1] / det, G[0] / det, det},
                                    .pre_shear = -s / det};
}

/* Larger and smaller eigenvalue of S C*, over the area. */
static void set_tensions(const struct dea_tension_point *t, struct dea_membrane_point *out)
{
  const double *S = t->S, *C = t->own;
  const double first = S[0] * C[0] + S[2] * C[2], second = S[2] * C[2] + S[1] * C[1];
  const double mixed = (S[0] * C[2] + S[2] * C[1]) * (S[2] * C[0] + S[1] * C[2]);
  const double half = 0.5 * (first - second), apart = sqrt(fmax(half * half + mixed, 0));
  out->tension_Pa[0] = (0.5 * (first + second) + apart) / out->area;
  out->tension_Pa[1] = t->state == DEA_TAUT ? (0.5 * (first + second) - apart) / out->area : 0;
}

/* Everything by C of the pre-stretched film, then S and D by that of the flat one. */
static dea_status evaluate_point(const struct dea_part_material *part_material,
                                 const double *viscous, const double F[6], double field,
                                 struct dea_tension_point *t, struct dea_membrane_point *out)
{
  const double *G = part_material->pre_stretch, s = part_material->pre_shear;
  const double flat_area = G[0] * G[1] - s * s; // over the unstretched one
  const struct dea_part_material inverse = inverse_of(part_material, flat_area);
  double C[3] = {F[0] * F[0] + F[2] * F[2] + F[4] * F[4], F[1] * F[1] + F[3] * F[3] + F[5] * F[5],
                 F[0] * F[1] + F[2] * F[3] + F[4] * F[5]};
  struct dea_material material = {.law = part_material->law};
  struct dea_tension film = {.material = &material, .nominal_field_V_per_m = field / flat_area};
  memcpy(material.param, part_material->param, part_material->law->param_count * sizeof(double));
  set_permittivity(part_material, flat_area, &material.permittivity);
  dea_part_material_pull_back(part_material, C, C);
  if (viscous != NULL) {
    dea_part_material_pull_back(&inverse, (const double[]){viscous[0], viscous[1], viscous[5]},
                                film.B);
    film.B_across = viscous[2] * flat_area * flat_area;
  }
  dea_status status =
      part_material->relaxed ? dea_tension_relaxed(&film, C, t) : dea_tension_taut(&film, C, t);
  DEA_TRY_STATUS(status);
  out->W = t->W; // of branches 1/2 B : (c - 1)
  out->W -= viscous != NULL ? 0.5 * (viscous[0] + viscous[1] + viscous[2]) : 0;
  out->state = t->state;
  out->area = sqrt(t->own[0] * t->own[1] - t->own[2] * t->own[2]) / flat_area;
  set_tensions(t, out);
  dea_part_material_pull_back(&inverse, t->own, out->own);
  pull_back_tensors(part_material, t);
  return DEA_OK;
}

static const int pair_of[2][2] = {{0, 2}, {2, 1}};

dea_status dea_membrane_point(const struct dea_part_material *part_material, const double *viscous,
                              const double F[6], double field_V_per_m,
                              struct dea_membrane_point *out)
{
  struct dea_tension_point t;
  DEA_TRY_STATUS(evaluate_point(part_material, viscous, F, field_V_per_m, &t, out));
  for (int a = 0; a < 6; a++) { // A_iJkL = delta_ik S_JL + F_iM F_kN D_MJNL
    int i = a / 2, J = a % 2;
    out->P[a] = F[2 * i] * t.S[pair_of[0][J]] + F[2 * i + 1] * t.S[pair_of[1][J]];
    for (int b = 0; b < 6; b++) {
      int k = b / 2, L = b % 2;
      double sum = i == k ? t.S[pair_of[J][L]] : 0;
      for (int M = 0; M < 2; M++) {
        for (int N = 0; N < 2; N++) {
          sum += F[2 * i + M] * F[2 * k + N] * t.D[pair_of[M][J]][pair_of[N][L]];
        }
      }
      out->A[6 * a + b] = sum;
    }
  }
  return DEA_OK;
}

void dea_membrane_force(const double P[6], const double F[6], double area, double out[3])
{
  double e[2][3], along = 0, length = 0, rest = 0, T[2][2] = {{0, 0}, {0, 0}};
  for (int i = 0; i < 3; i++) {
    length += F[2 * i] * F[2 * i];
  }
  for (int i = 0; i < 3; i++) {
    e[0][i] = F[2 * i] / sqrt(length);
    along += e[0][i] * F[2 * i + 1];
  }
  for (int i = 0; i < 3; i++) {
    e[1][i] = F[2 * i + 1] - along * e[0][i];
    rest += e[1][i] * e[1][i];
  }
  for (int i = 0; i < 3; i++) {
    e[1][i] /= sqrt(rest);
  }
  for (int a = 0; a < 4; a++) {
    for (int i = 0; i < 3; i++) {
      for (int j = 0; j < 3; j++) {
        double PF = P[2 * i] * F[2 * j] + P[2 * i + 1] * F[2 * j + 1];
        T[a / 2][a % 2] += e[a / 2][i] * PF * e[a % 2][j] / area;
      }
    }
  }
  out[0] = T[0][0];
  out[1] = T[1][1];
  out[2] = 0.5 * (T[0][1] + T[1][0]);
}
