#include "model/solid/point/membrane_point.h"

#include <math.h>
#include <string.h>

dea_status dea_membrane_check(const struct dea_constituent *constituent)
{
  return dea_constituent_takes_pressure(constituent) && !constituent->law->anisotropic
             ? DEA_OK
             : DEA_E_UNSUPPORTED;
}

/* A load that comes in over the depth of the film in equal parts makes a shear stress that grows
 * linearly to the bonded face: the mean displacement is that of h/3 under all of it, so h/2 is
 * given 3/2 of the film's shear modulus. */
dea_status dea_membrane_bond(const struct dea_constituent *film, struct dea_constituent *bond)
{
  static const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  static const double poisson_ratio = 0.49;
  enum { XZ = 2, YZ = 5 }; // components of F
  struct dea_point point;
  dea_status status = dea_membrane_check(film);
  if (status == DEA_OK) {
    status = dea_constituent_point(film, one, one, 1, 0, 0, true, &point);
  }
  if (status == DEA_OK) {
    double across = 0.5 * (point.A[9 * XZ + XZ] + point.A[9 * YZ + YZ]), mu = 1.5 * across;
    *bond = dea_constituent_bonded((const double[]){2 * mu * (1 + poisson_ratio), poisson_ratio});
  }
  return status;
}

/* Principal stresses S_a = f_a/l_a, their derivatives D_ab = 2 dS_a/dx_b, and shear modulus m;
 * stretches of the film itself. */
struct principal {
  double W, S[2], D[2][2], m, natural[2];
  double S12, D12[2]; // of what has axes of its own: S_12, D_1112 and D_2212
};

static void referential(const struct dea_plane *f, double l1, double l2, struct principal *out)
{
  out->W = f->W;
  out->S[0] = f->s1 / l1;
  out->S[1] = f->s2 / l2;
  out->D[0][0] = (f->k11 - out->S[0]) / (l1 * l1);
  out->D[1][1] = (f->k22 - out->S[1]) / (l2 * l2);
  out->D[0][1] = out->D[1][0] = f->k12 / (l1 * l2);
}

/* m = (S_2 - S_1)/(x_2 - x_1) of the taut film. Where the difference would lose digits it is the
 * mean of (D_11 - 2 D_12 + D_22)/4 between the two, by three Gauss points on [-d, d]; two of them
 * are the same state. */
static dea_status taut_shear(const struct dea_tension *film, double mean, double d,
                             struct principal *out)
{
  static const double near = 0.01, node[2] = {0, 0.7745966692414834}, weight[2] = {4. / 9, 5. / 9};
  if (d > near * mean) {
    out->m = 0.5 * (out->S[0] - out->S[1]) / d;
    return DEA_OK;
  }
  out->m = 0;
  for (int i = 0; i < 2; i++) {
    struct dea_plane f;
    struct principal at;
    double l1 = sqrt(mean + node[i] * d), l2 = sqrt(mean - node[i] * d);
    dea_status status = dea_tension_taut(film, l1, l2, &f);
    if (status != DEA_OK) {
      return status;
    }
    referential(&f, l1, l2, &at);
    out->m += weight[i] * 0.25 * (at.D[0][0] - 2 * at.D[0][1] + at.D[1][1]);
  }
  return DEA_OK;
}

/* What turns against B, whose axes are not those of C: with e = x1 - x2, e* the same of the natural
 * width, which follows, and phi the energy by x1 and the angle of N_1, phi_angle = B_12 e*. B: 11
 * 22 12 on the axes of C. */
static dea_status add_turn(const struct dea_tension *film, const double B[3], double e,
                           struct principal *out)
{
  struct dea_plane f;
  const double *l = out->natural, wide = l[0] * l[0] - l[1] * l[1];
  dea_status status = dea_tension_taut(film, l[0], l[1], &f);
  if (status == DEA_OK && e > 1e-6 * l[0] * l[0]) {
    const double stiffness = f.k22 / (4 * l[1] * l[1]), share = f.k12 * l[1] / (f.k22 * l[0]);
    const double by_angle = B[2] * wide, mixed = B[2] * (1 + share);
    const double twice = (B[1] - B[0]) * wide - B[2] * B[2] / stiffness;
    out->S12 = by_angle / e;
    out->D12[0] = 2 * (mixed - by_angle / e) / e;
    out->D12[1] = 2 * by_angle / (e * e);
    out->m += twice / (e * e);
  }
  return status;
}

/* Response to stretches whose squares are mean + d and mean - d. */
static dea_status respond(const struct dea_tension *film, bool relaxed, double mean, double d,
                          const double B[3], struct principal *out, enum dea_tension_state *state)
{
  const struct dea_tension elastic = {film->material, film->nominal_field_V_per_m, NULL};
  struct dea_plane f;
  double l1 = sqrt(mean + d), l2 = mean - d > 0 ? sqrt(mean - d) : 0;
  *out = (struct principal){.natural = {l1, l2}};
  *state = DEA_TAUT;
  dea_status status = relaxed ? dea_tension_relaxed(film, l1, l2, &f, out->natural, state) : DEA_OK;
  if (status == DEA_OK && *state == DEA_TAUT) {
    status = dea_tension_taut(&elastic, l1, l2, &f);
  }
  if (status != DEA_OK) {
    return status;
  }
  if (*state == DEA_TAUT) {
    referential(&f, l1, l2, out);
    return taut_shear(&elastic, mean, d, out);
  }
  out->W = f.W;
  out->S[0] = f.s1 / l1;
  out->D[0][0] = (f.k11 - out->S[0]) / (l1 * l1);
  out->m = d > 0 ? 0.5 * out->S[0] / d : 0;
  return film->viscous_Pa != NULL && *state == DEA_WRINKLED ? add_turn(film, B, 2 * d, out)
                                                            : DEA_OK;
}

/* Tensors of the plane in the order 11 22 12. */
struct plane_tensors {
  double C[3], S[3], D[3][3];
};

/* S and D from principal values: N_1 N_1 = (1 + T)/2 and N_2 N_2 = (1 - T)/2 with T_11 = -T_22 =
 * cos and T_12 = sin of twice the angle of N_1. */
static void assemble_tensors(const struct principal *p, double cosine, double sine,
                             struct plane_tensors *t)
{
  const double N[2][3] = {{0.5 * (1 + cosine), 0.5 * (1 - cosine), 0.5 * sine},
                          {0.5 * (1 - cosine), 0.5 * (1 + cosine), -0.5 * sine}};
  const double G[3] = {-0.5 * sine, 0.5 * sine, 0.5 * cosine};
  for (int a = 0; a < 3; a++) {
    t->S[a] = p->S[0] * N[0][a] + p->S[1] * N[1][a] + 2 * p->S12 * G[a];
    for (int b = 0; b < 3; b++) {
      t->D[a][b] = 4 * p->m * G[a] * G[b] + p->D[0][0] * N[0][a] * N[0][b] +
                   p->D[1][1] * N[1][a] * N[1][b] +
                   p->D[0][1] * (N[0][a] * N[1][b] + N[1][a] * N[0][b]);
      for (int i = 0; i < 2; i++) {
        t->D[a][b] += 2 * p->D12[i] * (N[i][a] * G[b] + G[a] * N[i][b]);
      }
    }
  }
}

/* eps = permittivity + slope (sqrt(a) - 1) of the constituent by s = sqrt(a G1 G2), as a material
 * has it.
 */
static void set_permittivity(const struct dea_constituent *constituent, double G1_G2,
                             struct dea_permittivity *out)
{
  double slope = constituent->permittivity_slope_F_per_m / sqrt(G1_G2);
  out->slope = slope / DEA_EPSILON_0;
  out->at_rest =
      (constituent->permittivity_F_per_m - constituent->permittivity_slope_F_per_m + slope) /
      DEA_EPSILON_0;
}

/* S = G S(C) G, and so twice for D. */
static void pull_back_tensors(const struct dea_constituent *constituent, struct plane_tensors *t)
{
  const double *G = constituent->pre_stretch, scale[3] = {G[0] * G[0], G[1] * G[1], G[0] * G[1]};
  dea_constituent_pull_back(constituent, t->S, t->S);
  for (int a = 0; a < 9 && constituent->pre_shear == 0; a++) {
    t->D[a / 3][a % 3] *= scale[a / 3] * scale[a % 3];
  }
  for (int a = 0; a < 3 && constituent->pre_shear != 0; a++) {
    dea_constituent_pull_back(constituent, t->D[a], t->D[a]);
  }
  for (int b = 0; b < 3 && constituent->pre_shear != 0; b++) {
    double column[3] = {t->D[0][b], t->D[1][b], t->D[2][b]};
    dea_constituent_pull_back(constituent, column, column);
    for (int a = 0; a < 3; a++) {
      t->D[a][b] = column[a];
    }
  }
}

/* G^-1 B G^-1 on the axes of C, 11 22 12, and across the film, from B that counts like c. */
static void turn_viscous(const struct dea_constituent *constituent, const double B[6],
                         const double axes[2], double plane[3], double principal[3])
{
  const double *G = constituent->pre_stretch, s = constituent->pre_shear;
  const double det = G[0] * G[1] - s * s;
  const struct dea_constituent inverse = {.pre_stretch = {G[1] / det, G[0] / det, det},
                                          .pre_shear = -s / det};
  double b[3] = {B[0], B[1], B[5]};
  dea_constituent_pull_back(&inverse, b, b);
  const double mean = 0.5 * (b[0] + b[1]), half = 0.5 * (b[0] - b[1]);
  const double along = half * axes[0] + b[2] * axes[1];
  plane[0] = principal[0] = mean + along;
  plane[1] = principal[1] = mean - along;
  plane[2] = b[2] * axes[0] - half * axes[1];
  principal[2] = B[2] * det * det;
}

/* Everything by C of the pre-stretched film, then S and D by that of the flat one. */
static dea_status evaluate_point(const struct dea_constituent *constituent, const double *viscous,
                                 const double F[6], double field, struct plane_tensors *t,
                                 struct dea_membrane_point *out)
{
  const double *G = constituent->pre_stretch, s = constituent->pre_shear;
  double flat_area = G[0] * G[1] - s * s; // over the unstretched one
  double c[3] = {F[0] * F[0] + F[2] * F[2] + F[4] * F[4], F[1] * F[1] + F[3] * F[3] + F[5] * F[5],
                 F[0] * F[1] + F[2] * F[3] + F[4] * F[5]};
  struct dea_material material = {.law = constituent->law};
  memcpy(material.param, constituent->param, constituent->law->param_count * sizeof(double));
  double B[3] = {0}, principal[3];
  const bool in_time = viscous != NULL && constituent->relaxed;
  const struct dea_tension film = {&material, field / flat_area, in_time ? principal : NULL};
  set_permittivity(constituent, flat_area, &material.permittivity);
  dea_constituent_pull_back(constituent, c, t->C);
  double mean = 0.5 * (t->C[0] + t->C[1]), half = 0.5 * (t->C[0] - t->C[1]);
  double d = hypot(half, t->C[2]);
  const double axes[2] = {d > 0 ? half / d : 1, d > 0 ? t->C[2] / d : 0};
  struct principal p;
  if (in_time) {
    turn_viscous(constituent, viscous, axes, B, principal);
  }
  dea_status status = respond(&film, constituent->relaxed, mean, d, B, &p, &out->state);
  if (status != DEA_OK) {
    return status;
  }
  assemble_tensors(&p, axes[0], axes[1], t);
  pull_back_tensors(constituent, t);
  out->W = p.W;
  if (in_time && out->state != DEA_TAUT) { // as B : (c - 1) counts, not B : (C - 1)
    out->W +=
        0.5 * (principal[0] + principal[1] + principal[2] - viscous[0] - viscous[1] - viscous[2]);
  }
  out->area = p.natural[0] * p.natural[1] / flat_area;
  double first = p.S[0] * (mean + d) / out->area, second = p.S[1] * (mean - d) / out->area;
  out->tension_Pa[0] = fmax(first, second);
  out->tension_Pa[1] = fmin(first, second);
  return DEA_OK;
}

static const int pair_of[2][2] = {{0, 2}, {2, 1}};

dea_status dea_membrane_point(const struct dea_constituent *constituent, const double F[6],
                              double field_V_per_m, struct dea_membrane_point *out)
{
  return dea_membrane_point_in_time(constituent, NULL, F, field_V_per_m, out);
}

dea_status dea_membrane_point_in_time(const struct dea_constituent *constituent,
                                      const double *viscous, const double F[6],
                                      double field_V_per_m, struct dea_membrane_point *out)
{
  struct plane_tensors t;
  dea_status status = evaluate_point(constituent, viscous, F, field_V_per_m, &t, out);
  if (status != DEA_OK) {
    return status;
  }
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
