#include "model/solid/point/viscous.h"

#include "base/quadrature.h"

#include <math.h>
#include <string.h>

/* Components of a symmetric tensor as a matrix. */
static const int place[9] = {0, 5, 4, 5, 1, 3, 4, 3, 2};

void dea_viscous_add(const struct dea_part_material *part_material, int q, const double F[9],
                     const double cof[9], double J, bool tangent, struct dea_point *point)
{
  if (part_material->viscous == NULL) {
    return;
  }
  const double *B = part_material->viscous + 6 * q, b = part_material->viscous_Pa;
  double energy = -b * log1p(J - 1), inverse[9]; // F^-T
  for (int a = 0; a < 9; a++) {
    inverse[a] = cof[a] / J;
  }
  for (int a = 0; a < 9; a++) {
    int i = a / 3, L = a % 3;
    double FB =
        F[3 * i] * B[place[L]] + F[3 * i + 1] * B[place[3 + L]] + F[3 * i + 2] * B[place[6 + L]];
    energy += 0.5 * (F[a] * FB - (i == L ? B[i] : 0));
    point->P[a] += FB - b * inverse[a];
    for (int c = 0; c < 9 && tangent; c++) {
      int k = c / 3, M = c % 3;
      point->A[9 * a + c] +=
          (i == k ? B[place[3 * L + M]] : 0) + b * inverse[3 * i + M] * inverse[3 * k + L];
    }
  }
  point->W += energy;
}

void dea_viscous_strain_flat(const double c[3], double C[6], double inverse[6])
{
  const double det = c[0] * c[1] - c[2] * c[2];
  const double strain[6] = {c[0], c[1], 1 / det, 0, 0, c[2]};
  const double opposite[6] = {c[1] / det, c[0] / det, det, 0, 0, -c[2] / det};
  memcpy(C, strain, sizeof strain);
  memcpy(inverse, opposite, sizeof opposite);
}

void dea_viscous_strain(const double F[9], const double cof[9], double J, double C[6],
                        double inverse[6])
{
  for (int A = 0; A < 3; A++) {
    for (int B = A; B < 3; B++) {
      double sum = 0, product = 0;
      for (int i = 0; i < 3; i++) {
        sum += F[3 * i + A] * F[3 * i + B];
        product += cof[3 * i + A] * cof[3 * i + B];
      }
      C[place[3 * A + B]] = sum;
      inverse[place[3 * A + B]] = product / (J * J);
    }
  }
}

/* Inverse of a symmetric tensor; returns its determinant. */
static double invert(const double t[6], double out[6])
{
  double c0 = t[1] * t[2] - t[3] * t[3], c5 = t[3] * t[4] - t[5] * t[2],
         c4 = t[5] * t[3] - t[1] * t[4];
  double det = t[0] * c0 + t[5] * c5 + t[4] * c4;
  out[0] = c0 / det;
  out[5] = c5 / det;
  out[4] = c4 / det;
  out[1] = (t[0] * t[2] - t[4] * t[4]) / det;
  out[2] = (t[0] * t[1] - t[5] * t[5]) / det;
  out[3] = (t[4] * t[5] - t[0] * t[3]) / det;
  return det;
}

static double contract(const double s[6], const double t[6])
{
  return s[0] * t[0] + s[1] * t[1] + s[2] * t[2] + 2 * (s[3] * t[3] + s[4] * t[4] + s[5] * t[5]);
}

double dea_viscous_energy(const double B[6], double b_Pa, const double C[6])
{
  double none[6];
  return 0.5 * (contract(B, C) - B[0] - B[1] - B[2] - b_Pa * log(invert(C, none)));
}

double dea_branch_energy(double modulus_Pa, const double A[6], const double C[6])
{
  double none[6];
  return 0.5 * modulus_Pa * (contract(A, C) - 3 - log(invert(A, none)) - log(invert(C, none)));
}

void dea_branch_step_set(const struct dea_branch *branch, double step_s,
                         struct dea_branch_step *out)
{
  enum { POINTS = 4, PANELS = 4 };
  double x[POINTS], w[POINTS];
  *out = (struct dea_branch_step){.end = {1, 0, 0}};
  if (!(step_s > 0)) {
    return;
  }
  out->end = dea_branch_weights(step_s, branch->time_s);
  // what a branch carries at the begin is gone after a few of its times
  double unit = branch->time_s / step_s;
  const double ends[PANELS + 1] = {0, fmin(1, unit), fmin(1, 3 * unit), fmin(1, 8 * unit), 1};
  dea_gauss_rule(POINTS, x, w);
  for (int p = 0; p < PANELS; p++) {
    double width = ends[p + 1] - ends[p];
    for (int i = 0; i < POINTS && width > 0; i++, out->count++) {
      double share = ends[p] + 0.5 * (1 + x[i]) * width;
      out->place[out->count].share = share;
      out->place[out->count].seconds = 0.5 * w[i] * width * step_s;
      out->place[out->count].weights = dea_branch_weights(share * step_s, branch->time_s);
    }
  }
}

void dea_branch_update(const struct dea_branch_weights *w, const double A[6], const double from[6],
                       const double to[6], double A_next[6])
{
  for (int a = 0; a < 6; a++) {
    A_next[a] = w->e * A[a] + w->w0 * from[a] + w->w1 * to[a];
  }
}

/* tr(X + X^-1 - 2) with X = A C: tr(L C L A^-1) of L = A - C^-1, in which nothing cancels. */
static double imbalance(const double A[6], const double inverse[6])
{
  double C[6], A_inverse[6], L[6], sum = 0;
  invert(inverse, C);
  invert(A, A_inverse);
  for (int a = 0; a < 6; a++) {
    L[a] = A[a] - inverse[a];
  }
  for (int a = 0; a < 9; a++) { // (L C)_ij (L A^-1)_ji
    int i = a / 3, j = a % 3;
    double LC = 0, LA = 0;
    for (int k = 0; k < 3; k++) {
      LC += L[place[3 * i + k]] * C[place[3 * k + j]];
      LA += L[place[3 * j + k]] * A_inverse[place[3 * k + i]];
    }
    sum += LC * LA;
  }
  return sum;
}

double dea_branch_dissipation(const struct dea_branch *branch, const struct dea_branch_step *step,
                              const double A[6], const double from[6], const double to[6])
{
  double sum = 0;
  for (size_t i = 0; i < step->count; i++) {
    double now[6], inverse[6], share = step->place[i].share;
    for (int a = 0; a < 6; a++) {
      inverse[a] = from[a] + share * (to[a] - from[a]);
    }
    dea_branch_update(&step->place[i].weights, A, from, inverse, now);
    sum += step->place[i].seconds * imbalance(now, inverse);
  }
  return 0.5 * branch->modulus_Pa / branch->time_s * sum;
}
