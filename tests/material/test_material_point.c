/* material/point: stress and tangent of every law in three dimensions. */
#include "complex_material.h"
#include "material/point.h"
#include "material_samples.h"

static const double step = 1e-30;
static const double tolerance = 1e-12;

enum { SAMPLE_COUNT = 40 };

static void multiply(const double A[9], const double B[9], double out[9])
{
  for (size_t i = 0; i < 3; i++) {
    for (size_t j = 0; j < 3; j++) {
      out[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
    }
  }
}

static double determinant(const double F[9])
{
  return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
         F[2] * (F[3] * F[7] - F[4] * F[6]);
}

/* Rotation of a random unit quaternion. */
static void random_rotation(uint64_t *seed, double Q[9])
{
  double q[4], norm = 0.0;
  do {
    norm = 0.0;
    for (size_t i = 0; i < 4; i++) {
      q[i] = uniform(seed, -1.0, 1.0);
      norm += q[i] * q[i];
    }
  } while (norm < 0.1 || norm > 1.0);
  for (size_t i = 0; i < 4; i++) {
    q[i] /= sqrt(norm);
  }
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const double rows[9] = {
      1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
      2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
      2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  memcpy(Q, rows, sizeof rows);
}

/* F near a random stretch and rotation; volume change up to some 30 %: W needs no det F = 1. */
static void random_gradient(uint64_t *seed, double F[9])
{
  double Q[9], G[9];
  do {
    for (size_t i = 0; i < 9; i++) {
      G[i] = uniform(seed, -0.4, 0.4) + (i % 4 == 0);
    }
  } while (determinant(G) < 0.7 || determinant(G) > 1.3);
  random_rotation(seed, Q);
  multiply(Q, G, F);
}

static void random_direction(uint64_t *seed, double a[3])
{
  double Q[9];
  random_rotation(seed, Q);
  memcpy(a, Q, 3 * sizeof *a);
}

/* Stress against steps of the energy, tangent against steps of the stress, at one F. */
static void check_steps_at(const struct dea_law *law, const double *param, const double F[9],
                           const double fibre[3])
{
  struct dea_point point, plain;
  assert_int_equal(dea_point_elastic(law, param, F, fibre, &point), DEA_OK);
  assert_int_equal(dea_point_stress(law, param, F, fibre, &plain), DEA_OK);
  assert_true(plain.W == point.W);
  assert_all_close(law->name, plain.P, point.P, 9, 1e-15, largest(point.P, 9));
  const double scale = largest(point.A, 81); // of the tangent, and of the stress times a strain
  const double stressed = fmax(largest(point.P, 9), law->shear_modulus(param)); // P may be 0
  for (size_t n = 0; n < 9; n++) {
    double complex Z[9], W, P[9], A[81];
    for (size_t m = 0; m < 9; m++) {
      Z[m] = F[m];
    }
    Z[n] += step * _Complex_I;
    assert_int_equal(complex_point(law->name, param, Z, fibre, &W, P, A), DEA_OK);
    const double stress = cimag(W) / step;
    double column[9], wanted[9], real[9];
    for (size_t m = 0; m < 9; m++) {
      column[m] = cimag(P[m]) / step;
      wanted[m] = point.A[9 * m + n];
      real[m] = creal(P[m]);
    }
    assert_all_close(law->name, &stress, &point.P[n], 1, tolerance, stressed);
    assert_all_close(law->name, column, wanted, 9, tolerance, scale);
    assert_all_close(law->name, real, point.P, 9, tolerance, scale);
    assert_close(creal(W), point.W, 0.0, tolerance * scale);
  }
}

static void check_steps(const struct dea_law *law, const double *param)
{
  uint64_t seed = 1;
  for (int n = 0; n < SAMPLE_COUNT; n++) {
    double F[9], fibre[3];
    random_gradient(&seed, F);
    random_direction(&seed, fibre);
    check_steps_at(law, param, F, fibre);
  }
}

TEST(test_complex_step)
{
  for_each_law(check_steps);
}

/* Gaps between stretches, from none across the switch of the divided difference (0.01). */
static const double gaps[] = {0.0,  1e-15, 1e-12,  1e-9,    1e-7, 1e-5,
                              1e-3, 5e-3,  9.9e-3, 10.1e-3, 0.03};
enum { GAP_COUNT = sizeof gaps / sizeof gaps[0] };

/* Principal stretches of which two (kind 0), all about 1.4 (1) or all about 1 (2) differ by a gap.
 */
static void repeated_stretches(int kind, double gap, double l[3])
{
  l[0] = kind == 2 ? 1.0 : 1.4;
  l[1] = l[0] * (1.0 + gap);
  l[2] = kind == 0 ? 0.6 : l[0] * (1.0 - 0.5 * gap);
}

static void compose(const double Q[9], const double l[3], const double R[9], double F[9])
{
  const double U[9] = {l[0], 0, 0, 0, l[1], 0, 0, 0, l[2]};
  double QU[9];
  multiply(Q, U, QU);
  multiply(QU, R, F);
}

/* (w'(a) - w'(b))/(a - b) as the mean of w'' over the interval, five Gauss points: exact to
 * rounding for the gaps used here, and in the stretch, not in its square as in the code. */
static double mean_curvature(const struct dea_law *law, const double *param, double a, double b)
{
  static const double node[5] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                                 0.9061798459386640};
  static const double weight[5] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                   0.4786286704993665, 0.2369268850561891};
  double sum = 0.0, w, w1, w2;
  for (size_t i = 0; i < 5; i++) {
    const double l = 0.5 * (a + b) + 0.5 * node[i] * (b - a);
    assert_int_equal(law->principal(param, l, &w, &w1, &w2), DEA_OK);
    sum += 0.5 * weight[i] * w2;
  }
  return sum;
}

/* Tangent of a principal law in its principal frame (Ogden 1984, chapter 6, for F diagonal):
 * A_iiii = w''(l_i); A_ijij +- A_ijji = (P_i -+ P_j)/(l_i -+ l_j), P_i = w'(l_i). */
static void principal_tangent(const struct dea_law *law, const double *param, const double l[3],
                              double A[81])
{
  double w, P[3], w2[3];
  memset(A, 0, 81 * sizeof *A);
  for (size_t i = 0; i < 3; i++) {
    assert_int_equal(law->principal(param, l[i], &w, &P[i], &w2[i]), DEA_OK);
    A[9 * (4 * i) + 4 * i] = w2[i];
  }
  for (size_t i = 0; i < 3; i++) {
    for (size_t j = 0; j < 3; j++) {
      if (i != j) {
        const double difference = fabs(l[i] - l[j]) > 0.1 ? (P[i] - P[j]) / (l[i] - l[j])
                                                          : mean_curvature(law, param, l[i], l[j]);
        const double sum = (P[i] + P[j]) / (l[i] + l[j]);
        A[9 * (3 * i + j) + 3 * i + j] = 0.5 * (difference + sum);
        A[9 * (3 * i + j) + 3 * j + i] = 0.5 * (difference - sum);
      }
    }
  }
}

/* A of Q U R from A of U: every first index turns with Q, every second one with R^T. */
static void turn_tangent(const double Q[9], const double R[9], const double A[81], double out[81])
{
  double T[81]; // the matrix of (m, n) -> (i, J): Q_im R_nJ
  for (size_t iJ = 0; iJ < 9; iJ++) {
    for (size_t mn = 0; mn < 9; mn++) {
      T[9 * iJ + mn] = Q[3 * (iJ / 3) + mn / 3] * R[3 * (mn % 3) + iJ % 3];
    }
  }
  for (size_t a = 0; a < 9; a++) {
    for (size_t b = 0; b < 9; b++) {
      double sum = 0.0;
      for (size_t m = 0; m < 9; m++) {
        for (size_t n = 0; n < 9; n++) {
          sum += T[9 * a + m] * A[9 * m + n] * T[9 * b + n];
        }
      }
      out[9 * a + b] = sum;
    }
  }
}

static void check_repeated_principal(const struct dea_law *law, const double *param)
{
  static const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  uint64_t seed = 2;
  for (size_t g = 0; g < GAP_COUNT; g++) {
    for (int kind = 0; kind < 3; kind++) {
      double l[3], F[9], Q[9], R[9], A[81], turned[81];
      repeated_stretches(kind, gaps[g], l);
      principal_tangent(law, param, l, A);
      struct dea_point point;
      compose(one, l, one, F);
      assert_int_equal(dea_point_elastic(law, param, F, NULL, &point), DEA_OK);
      assert_all_close(law->name, point.A, A, 81, tolerance, largest(A, 81));
      if (gaps[g] == 0.0) { // here the stress has an exact complex step too
        check_steps_at(law, param, F, NULL);
      }
      random_rotation(&seed, Q);
      random_rotation(&seed, R);
      turn_tangent(Q, R, A, turned);
      compose(Q, l, R, F);
      assert_int_equal(dea_point_elastic(law, param, F, NULL, &point), DEA_OK);
      assert_all_close(law->name, point.A, turned, 81, tolerance, largest(A, 81));
    }
  }
}

/* Two or three stretches that coincide or nearly do, in the principal frame and in a turned one. A
 * complex step of a stress made from eigenvectors loses digits as rounding over gap, so the tangent
 * of a principal law is compared with its closed form instead. */
static void check_repeated(const struct dea_law *law, const double *param)
{
  if (law->principal != NULL) {
    check_repeated_principal(law, param);
    return;
  }
  uint64_t seed = 2;
  for (size_t g = 0; g < GAP_COUNT; g++) {
    for (int kind = 0; kind < (law->anisotropic ? 2 : 3); kind++) { // fibres have a kink at rest
      double l[3], F[9], Q[9], R[9], fibre[3];
      repeated_stretches(kind, gaps[g], l);
      random_rotation(&seed, Q);
      random_rotation(&seed, R);
      random_direction(&seed, fibre);
      compose(Q, l, R, F);
      check_steps_at(law, param, F, fibre);
    }
  }
}

TEST(test_repeated_stretches)
{
  for_each_law(check_repeated);
}

/* sum l^4 = I1^2 - 2 I2 for any F, so an Ogden term with alpha = 4 has an invariant form too. */
static dea_status fourth_power(const double *p, dea_scalar I1, dea_scalar I2, dea_scalar I4,
                               struct dea_law_energy *e)
{
  *e = (struct dea_law_energy){.W = p[0] / 4.0 * (I1 * I1 - 2.0 * I2 - 3.0),
                               .W1 = p[0] / 2.0 * I1,
                               .W2 = -p[0] / 2.0,
                               .W11 = p[0] / 2.0};
  return DEA_OK;
}

static void check_forms_agree(const double F[9])
{
  const struct dea_law by_invariants = {.name = "fourth power", .invariants = fourth_power};
  const double param[DEA_LAW_PARAM_MAX] = {40e3, 4.0};
  struct dea_point a, b;
  assert_int_equal(dea_point_elastic(dea_law_find("ogden"), param, F, NULL, &a), DEA_OK);
  assert_int_equal(dea_point_elastic(&by_invariants, param, F, NULL, &b), DEA_OK);
  const double scale = largest(b.A, 81);
  assert_close(a.W, b.W, 0.0, tolerance * scale);
  assert_all_close("P", a.P, b.P, 9, tolerance, scale);
  assert_all_close("A", a.A, b.A, 81, tolerance, scale);
}

TEST(test_principal_against_invariant_form)
{
  uint64_t seed = 3;
  double F[9], Q[9], R[9], l[3];
  for (int n = 0; n < SAMPLE_COUNT; n++) {
    random_gradient(&seed, F);
    check_forms_agree(F);
  }
  for (size_t g = 0; g < GAP_COUNT; g++) {
    for (int kind = 0; kind < 3; kind++) {
      repeated_stretches(kind, gaps[g], l);
      random_rotation(&seed, Q);
      random_rotation(&seed, R);
      compose(Q, l, R, F);
      check_forms_agree(F);
    }
  }
}

/* W(Q F) = W(F), P(Q F) = Q P(F). */
static void check_objectivity(const struct dea_law *law, const double *param)
{
  uint64_t seed = 4;
  for (int n = 0; n < SAMPLE_COUNT; n++) {
    double F[9], Q[9], QF[9], QP[9], fibre[3];
    random_gradient(&seed, F);
    random_rotation(&seed, Q);
    random_direction(&seed, fibre);
    multiply(Q, F, QF);
    struct dea_point a, b;
    assert_int_equal(dea_point_elastic(law, param, F, fibre, &a), DEA_OK);
    assert_int_equal(dea_point_elastic(law, param, QF, fibre, &b), DEA_OK);
    multiply(Q, a.P, QP);
    const double scale = largest(a.A, 81);
    assert_close(b.W, a.W, 0.0, tolerance * scale);
    assert_all_close(law->name, b.P, QP, 9, tolerance, scale);
  }
}

TEST(test_objectivity)
{
  for_each_law(check_objectivity);
}

/* W(F Q) = W(F), P(F Q) = P(F) Q when the fibre turns along (Q^T a0), and for an isotropic law also
 * when it does not; a law that says it is anisotropic must then notice. */
static void check_isotropy(const struct dea_law *law, const double *param)
{
  uint64_t seed = 5;
  bool noticed = false;
  for (int n = 0; n < SAMPLE_COUNT; n++) {
    double F[9], Q[9], FQ[9], PQ[9], fibre[3], turned[3];
    random_gradient(&seed, F);
    random_rotation(&seed, Q);
    random_direction(&seed, fibre);
    for (size_t i = 0; i < 3; i++) {
      turned[i] = Q[i] * fibre[0] + Q[3 + i] * fibre[1] + Q[6 + i] * fibre[2];
    }
    multiply(F, Q, FQ);
    struct dea_point a, b, c;
    assert_int_equal(dea_point_elastic(law, param, F, fibre, &a), DEA_OK);
    assert_int_equal(dea_point_elastic(law, param, FQ, turned, &b), DEA_OK);
    assert_int_equal(dea_point_elastic(law, param, FQ, fibre, &c), DEA_OK);
    multiply(a.P, Q, PQ);
    const double scale = largest(a.A, 81);
    assert_close(b.W, a.W, 0.0, tolerance * scale);
    assert_all_close(law->name, b.P, PQ, 9, tolerance, scale);
    noticed = noticed || fabs(c.W - a.W) > 1e-6 * scale;
  }
  assert_int_equal(noticed, law->anisotropic);
}

TEST(test_isotropy)
{
  for_each_law(check_isotropy);
}

/* At F = 1: W = 0 and P is a pressure; in small shear across the fibre P12 = G gamma. */
static void check_reference(const struct dea_law *law, const double *param)
{
  static const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, fibre[3] = {0, 0, 1};
  const double G = law->shear_modulus(param), gamma = 1e-6;
  struct dea_point point;
  assert_int_equal(dea_point_elastic(law, param, one, fibre, &point), DEA_OK);
  assert_close(point.W, 0.0, 0.0, 1e-14 * G);
  double pressure[9] = {0.0};
  for (size_t i = 0; i < 9; i += 4) {
    pressure[i] = (point.P[0] + point.P[4] + point.P[8]) / 3.0;
  }
  assert_all_close(law->name, point.P, pressure, 9, 1e-14, G);

  const double shear[9] = {1, gamma, 0, 0, 1, 0, 0, 0, 1};
  assert_int_equal(dea_point_elastic(law, param, shear, fibre, &point), DEA_OK);
  assert_close(point.P[1], G * gamma, 1e-9, 0.0);
}

TEST(test_reference_and_small_shear)
{
  for_each_law(check_reference);
}

static void check_domain(const struct dea_law *law, const double *param)
{
  static const double fibre[3] = {1, 0, 0};
  struct dea_point point;
  double F[9] = {1, 0, 0, 0, 1, 0, 0, 0, -1};
  assert_int_equal(dea_point_elastic(law, param, F, fibre, &point), DEA_E_DOMAIN);
  F[8] = 0.0;
  assert_int_equal(dea_point_elastic(law, param, F, fibre, &point), DEA_E_DOMAIN);
  F[8] = 1e200;
  assert_int_equal(dea_point_elastic(law, param, F, fibre, &point), DEA_E_DOMAIN);
  F[8] = 1.0;
  static const double bad[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
  for (size_t i = 0; i < 9; i++) {
    for (size_t k = 0; k < 3; k++) {
      double G[9];
      memcpy(G, F, sizeof G);
      G[i] = bad[k];
      assert_int_equal(dea_point_elastic(law, param, G, fibre, &point), DEA_E_DOMAIN);
    }
  }
  assert_int_equal(dea_point_elastic(law, param, F, NULL, &point),
                   law->anisotropic ? DEA_E_ARGUMENT : DEA_OK);
}

TEST(test_point_domain)
{
  for_each_law(check_domain);
  const double gent[DEA_LAW_PARAM_MAX] = {43e3, 7.0}, F[9] = {4, 0, 0, 0, 0.5, 0, 0, 0, 0.5};
  struct dea_point point;
  assert_int_equal(dea_point_elastic(dea_law_find("gent"), gent, F, NULL, &point), DEA_E_DOMAIN);
}

TESTS(NULL, NULL)
