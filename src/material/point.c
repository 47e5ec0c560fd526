/* Stress and tangent from a law's derivatives (docs/theory/materials.md, section "Material point"):
 * first S = 2 dW/dC and D = 4 d2W/dC2 in the reference configuration, then P = F S and
 * A_iJkL = delta_ik S_JL + F_iM F_kN D_MJNL.
 *
 * symbol   meaning                                                unit
 * C        right Cauchy-Green tensor F^T F, as C[3][3]            1
 * S        second Piola-Kirchhoff stress, S[6] in pair order      Pa
 * D        its tangent 2 dS/dC, D[6][6]; no factors of 2          Pa
 * x[a]     eigenvalues of C, squares of the stretches             1
 * N[.][a]  their unit eigenvectors (columns)                      1 */
#include "material/point.h"

#include "base/context.h"

enum { PAIR_COUNT = 6 };

/* Symmetric index pairs 11 22 33 23 13 12, and the pair of two indices. */
static const int pair_first[PAIR_COUNT] = {0, 1, 2, 1, 0, 0};
static const int pair_second[PAIR_COUNT] = {0, 1, 2, 2, 2, 1};
static const int pair_of[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};

struct referential {
  dea_scalar W, S[PAIR_COUNT], D[PAIR_COUNT][PAIR_COUNT];
};

static dea_scalar determinant(const dea_scalar F[9])
{
  return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
         F[2] * (F[3] * F[7] - F[4] * F[6]);
}

static void right_cauchy_green(const dea_scalar F[9], dea_scalar C[3][3])
{
  for (int i = 0; i < 3; i++) {
    for (int j = i; j < 3; j++) {
      C[i][j] = F[i] * F[j] + F[3 + i] * F[3 + j] + F[6 + i] * F[6 + j];
      C[j][i] = C[i][j];
    }
  }
}

/* ---- invariant form ---- */

/* With 1, B = I1 1 - C and M = a0 a0 the derivatives of I1, I2 and I4 by C:
 * S = 2 (W1 1 + W2 B + W4 M), D = 4 (sum of second derivatives + W2 dB/dC),
 * dB/dC = 1 x 1 - (symmetric identity). */
static dea_status from_invariants(const struct dea_law *law, const double *param,
                                  dea_scalar C[3][3], const double fibre[3], bool tangent,
                                  struct referential *out)
{
  static const double one[PAIR_COUNT] = {1.0, 1.0, 1.0, 0.0, 0.0, 0.0};
  dea_scalar B[PAIR_COUNT], I1 = C[0][0] + C[1][1] + C[2][2], CC = 0.0, I4 = 1.0;
  double M[PAIR_COUNT] = {0.0};
  for (int p = 0; p < PAIR_COUNT; p++) {
    const dea_scalar c = C[pair_first[p]][pair_second[p]];
    B[p] = I1 * one[p] - c;
    CC += (p < 3 ? 1.0 : 2.0) * c * c;
  }
  if (law->anisotropic) {
    I4 = 0.0;
    for (int p = 0; p < PAIR_COUNT; p++) {
      M[p] = fibre[pair_first[p]] * fibre[pair_second[p]];
      I4 += (p < 3 ? 1.0 : 2.0) * M[p] * C[pair_first[p]][pair_second[p]];
    }
  }
  struct dea_law_energy e;
  DEA_TRY_STATUS(law->invariants(param, I1, 0.5 * (I1 * I1 - CC), I4, &e));
  out->W = e.W;
  for (int p = 0; p < PAIR_COUNT; p++) {
    out->S[p] = 2.0 * (e.W1 * one[p] + e.W2 * B[p] + e.W4 * M[p]);
  }
  for (int p = 0; p < PAIR_COUNT && tangent; p++) {
    const dea_scalar row1 = (e.W11 + e.W2) * one[p] + e.W12 * B[p] + e.W14 * M[p];
    const dea_scalar row2 = e.W12 * one[p] + e.W22 * B[p] + e.W24 * M[p];
    const dea_scalar row4 = e.W14 * one[p] + e.W24 * B[p] + e.W44 * M[p];
    for (int q = 0; q < PAIR_COUNT; q++) {
      out->D[p][q] = 4.0 * (row1 * one[q] + row2 * B[q] + row4 * M[q]);
    }
    out->D[p][p] -= 4.0 * e.W2 * (p < 3 ? 1.0 : 0.5);
  }
  return DEA_OK;
}

/* ---- principal form ---- */

/* One Jacobi rotation that brings C[p][q] to 0. t is the tangent of the angle, the smaller root of
 * t^2 + t (C_qq - C_pp)/C_pq = 1; written so that it holds for complex entries too. */
static void jacobi_rotate(int p, int q, dea_scalar C[3][3], dea_scalar N[3][3])
{
  const int r = 3 - p - q;
  const dea_scalar off = C[p][q], d = C[q][q] - C[p][p];
  dea_scalar root = sqrt(d * d + 4.0 * off * off);
  if (root == 0.0) { // off is 0, or so small that its square is
    return;
  }
  if (DEA_RE(d / root) < 0.0) {
    root = -root;
  }
  const dea_scalar t = 2.0 * off / (d + root);
  const dea_scalar c = 1.0 / sqrt(1.0 + t * t), s = t * c;
  C[p][p] -= t * off;
  C[q][q] += t * off;
  C[p][q] = C[q][p] = 0.0;
  const dea_scalar rp = C[r][p], rq = C[r][q];
  C[r][p] = C[p][r] = c * rp - s * rq;
  C[r][q] = C[q][r] = s * rp + c * rq;
  for (int i = 0; i < 3; i++) {
    const dea_scalar np = N[i][p], nq = N[i][q];
    N[i][p] = c * np - s * nq;
    N[i][q] = s * np + c * nq;
  }
}

/* Eigenvectors to the columns of N, eigenvalues to the diagonal of C, by cyclic Jacobi sweeps (they
 * converge quadratically; no sweep is left out for a small entry, so that an imaginary step of any
 * size passes through). Repeated eigenvalues need no special case. */
static void spectral(dea_scalar C[3][3], dea_scalar N[3][3])
{
  enum { SWEEP_MAX = 10 };
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      N[i][j] = i == j;
    }
  }
  for (int sweep = 0; sweep < SWEEP_MAX; sweep++) {
    if (C[0][1] == 0.0 && C[0][2] == 0.0 && C[1][2] == 0.0) {
      return;
    }
    jacobi_rotate(0, 1, C, N);
    jacobi_rotate(0, 2, C, N);
    jacobi_rotate(1, 2, C, N);
  }
}

/* One principal direction: energy w, stress S = w'/l and dS/dx with x = l^2. */
static dea_status principal_stress(const struct dea_law *law, const double *param, dea_scalar x,
                                   dea_scalar *w, dea_scalar *S, dea_scalar *dS)
{
  if (!(DEA_RE(x) > 0.0)) {
    return DEA_E_DOMAIN;
  }
  const dea_scalar l = sqrt(x);
  dea_scalar w1, w2;
  DEA_TRY_STATUS(law->principal(param, l, w, &w1, &w2));
  *S = w1 / l;
  *dS = (w2 - *S) / (2.0 * x);
  return DEA_OK;
}

/* Divided difference (S_b - S_a)/(x_b - x_a), the shear modulus of a pair of directions. Where the
 * difference would lose digits it is the mean of dS/dx over the interval, by three Gauss points
 * (the error, of order six in the relative gap, is then below rounding); it has the right limit for
 * repeated stretches. */
static dea_status pair_modulus(const struct dea_law *law, const double *param, dea_scalar xa,
                               dea_scalar xb, dea_scalar Sa, dea_scalar Sb, dea_scalar *modulus)
{
  static const double near = 0.01;
  static const double node[3] = {-0.7745966692414834, 0.0, 0.7745966692414834};
  static const double weight[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const double gap = DEA_RE(xb - xa), limit = near * DEA_RE(xa + xb);
  if (gap > limit || gap < -limit) {
    *modulus = (Sb - Sa) / (xb - xa);
    return DEA_OK;
  }
  *modulus = 0.0;
  for (int i = 0; i < 3; i++) {
    dea_scalar w, S, dS;
    DEA_TRY_STATUS(
        principal_stress(law, param, 0.5 * (xa + xb) + 0.5 * node[i] * (xb - xa), &w, &S, &dS));
    *modulus += weight[i] * dS;
  }
  return DEA_OK;
}

/* S = sum_a S_a N_a N_a; D = sum_a 2 S_a' (N_a N_a) x (N_a N_a)
 *   + sum_{a<b} 4 m_ab G_ab x G_ab, with G_ab the symmetric part of N_a N_b and m_ab the divided
 * difference of S over x. */
static dea_status from_principal(const struct dea_law *law, const double *param, dea_scalar C[3][3],
                                 bool tangent, struct referential *out)
{
  dea_scalar N[3][3], S[3], modulus[PAIR_COUNT], G[PAIR_COUNT][PAIR_COUNT];
  spectral(C, N);
  out->W = 0.0;
  for (int a = 0; a < 3; a++) {
    dea_scalar w, dS;
    DEA_TRY_STATUS(principal_stress(law, param, C[a][a], &w, &S[a], &dS));
    out->W += w;
    modulus[a] = 2.0 * dS;
  }
  for (int p = 3; p < PAIR_COUNT && tangent; p++) {
    const int a = pair_first[p], b = pair_second[p];
    DEA_TRY_STATUS(pair_modulus(law, param, C[a][a], C[b][b], S[a], S[b], &modulus[p]));
    modulus[p] *= 4.0;
  }
  for (int p = 0; p < PAIR_COUNT; p++) {
    const int a = pair_first[p], b = pair_second[p];
    for (int q = 0; q < PAIR_COUNT; q++) {
      const int i = pair_first[q], j = pair_second[q];
      G[p][q] = 0.5 * (N[i][a] * N[j][b] + N[i][b] * N[j][a]);
    }
  }
  for (int q = 0; q < PAIR_COUNT; q++) {
    out->S[q] = S[0] * G[0][q] + S[1] * G[1][q] + S[2] * G[2][q];
    for (int r = 0; r < PAIR_COUNT && tangent; r++) {
      dea_scalar sum = 0.0;
      for (int p = 0; p < PAIR_COUNT; p++) {
        sum += modulus[p] * G[p][q] * G[p][r];
      }
      out->D[q][r] = sum;
    }
  }
  return DEA_OK;
}

/* ---- to the deformation gradient ---- */

static void push_stress(const dea_scalar F[9], const struct referential *ref, dea_scalar P[9])
{
  for (int i = 0; i < 3; i++) {
    for (int J = 0; J < 3; J++) {
      P[3 * i + J] = F[3 * i] * ref->S[pair_of[0][J]] + F[3 * i + 1] * ref->S[pair_of[1][J]] +
                     F[3 * i + 2] * ref->S[pair_of[2][J]];
    }
  }
}

static void push_tangent(const dea_scalar F[9], const struct referential *ref, dea_scalar A[81])
{
  for (int iJ = 0; iJ < 9; iJ++) {
    const int i = iJ / 3, J = iJ % 3;
    dea_scalar T[PAIR_COUNT]; // F_iM D_MJ(NL)
    for (int q = 0; q < PAIR_COUNT; q++) {
      T[q] = F[3 * i] * ref->D[pair_of[0][J]][q] + F[3 * i + 1] * ref->D[pair_of[1][J]][q] +
             F[3 * i + 2] * ref->D[pair_of[2][J]][q];
    }
    for (int k = 0; k < 3; k++) {
      for (int L = 0; L < 3; L++) {
        const dea_scalar geometric = i == k ? ref->S[pair_of[J][L]] : 0.0;
        A[9 * iJ + 3 * k + L] = geometric + F[3 * k] * T[pair_of[0][L]] +
                                F[3 * k + 1] * T[pair_of[1][L]] + F[3 * k + 2] * T[pair_of[2][L]];
      }
    }
  }
}

/* ---- compressible form ---- */

/* cof = dJ/dF; returns J. */
static dea_scalar cofactors(const dea_scalar F[9], dea_scalar cof[9])
{
  for (int i = 0; i < 3; i++) {
    const dea_scalar *a = F + 3 * ((i + 1) % 3), *b = F + 3 * ((i + 2) % 3);
    for (int J = 0; J < 3; J++) {
      const int K = (J + 1) % 3, L = (J + 2) % 3;
      cof[3 * i + J] = a[K] * b[L] - a[L] * b[K];
    }
  }
  return F[0] * cof[0] + F[1] * cof[1] + F[2] * cof[2];
}

/* P = 2 W1 F + WJ cof and its derivative, with d2J/dF2 = (cof_iJ cof_kL - cof_iL cof_kJ)/J. From D
 * = F - 1, so that at small strains no difference of numbers near 3 hides the energy from a line
 * search: I1 - 3 = 2 tr D + D:D, J - 1 = tr D + (tr^2 D - D:D^T)/2 + det D. */
static dea_status from_volume(const struct dea_law *law, const double *param, const dea_scalar F[9],
                              bool tangent, struct dea_point *out)
{
  dea_scalar D[9], cof[9], trace = 0.0, square = 0.0, crossed = 0.0;
  for (int a = 0; a < 9; a++) {
    D[a] = F[a] - (a % 4 == 0 ? 1.0 : 0.0);
  }
  for (int a = 0; a < 9; a++) {
    trace += a % 4 == 0 ? D[a] : 0.0;
    square += D[a] * D[a];
    crossed += D[a] * D[3 * (a % 3) + a / 3];
  }
  const dea_scalar excess = trace + 0.5 * (trace * trace - crossed) + cofactors(D, cof);
  const dea_scalar J = cofactors(F, cof);
  struct dea_law_volume e;
  DEA_TRY_STATUS(law->compressible(param, 2.0 * trace + square, excess, &e));
  out->W = e.W;
  for (int a = 0; a < 9; a++) {
    out->P[a] = 2.0 * e.W1 * F[a] + e.WJ * cof[a];
    const dea_scalar by_I1 = 4.0 * e.W11 * F[a] + 2.0 * e.W1J * cof[a];
    const dea_scalar by_J = 2.0 * e.W1J * F[a] + (e.WJJ + e.WJ / J) * cof[a];
    for (int b = 0; b < 9 && tangent; b++) {
      const int iL = 3 * (a / 3) + b % 3, kJ = 3 * (b / 3) + a % 3;
      out->A[9 * a + b] =
          (a == b ? 2.0 * e.W1 : 0.0) + by_I1 * F[b] + by_J * cof[b] - e.WJ / J * cof[iL] * cof[kJ];
    }
  }
  return DEA_OK;
}

static dea_status from_referential(const struct dea_law *law, const double *param,
                                   const dea_scalar F[9], const double fibre[3], bool tangent,
                                   struct dea_point *out)
{
  dea_scalar C[3][3];
  right_cauchy_green(F, C);
  struct referential ref;
  DEA_TRY_STATUS(law->invariants != NULL ? from_invariants(law, param, C, fibre, tangent, &ref)
                                         : from_principal(law, param, C, tangent, &ref));
  out->W = ref.W;
  push_stress(F, &ref, out->P);
  if (tangent) {
    push_tangent(F, &ref, out->A);
  }
  return DEA_OK;
}

static dea_status evaluate(const struct dea_law *law, const double *param, const dea_scalar F[9],
                           const double fibre[3], bool tangent, struct dea_point *out)
{
  if (law->anisotropic && fibre == NULL) {
    return DEA_E_ARGUMENT;
  }
  if (!(DEA_RE(determinant(F)) > 0.0)) { // also when it is not a number
    return DEA_E_DOMAIN;
  }
  DEA_TRY_STATUS(law->compressible != NULL ? from_volume(law, param, F, tangent, out)
                                           : from_referential(law, param, F, fibre, tangent, out));
  // Entries of F that are infinite, or so large that a power of them overflows.
  dea_scalar sum = out->W;
  for (int i = 0; i < 9; i++) {
    sum += out->P[i];
  }
  for (int i = 0; i < 81 && tangent; i += 10) {
    sum += out->A[i];
  }
  return isfinite(DEA_RE(sum)) ? DEA_OK : DEA_E_DOMAIN;
}

dea_status DEA_NAME(dea_point_elastic)(const struct dea_law *law, const double *param,
                                       const dea_scalar F[9], const double fibre[3],
                                       struct dea_point *out)
{
  return evaluate(law, param, F, fibre, true, out);
}

dea_status DEA_NAME(dea_point_stress)(const struct dea_law *law, const double *param,
                                      const dea_scalar F[9], const double fibre[3],
                                      struct dea_point *out)
{
  return evaluate(law, param, F, fibre, false, out);
}
