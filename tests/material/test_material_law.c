/* material/law: the registry, and the derivatives of every law by complex step. */
#include "complex_material.h"
#include "material/point.h"
#include "material_samples.h"

#include <math.h>

/* Far below rounding of the real part, so that the step has no error of its own. */
static const double step = 1e-30;
static const double tolerance = 1e-12;

TEST(test_registry)
{
  size_t count;
  const struct dea_law *const *laws = dea_law_all(&count);
  assert_true(count >= 7);
  for (size_t i = 0; i < count; i++) {
    assert_ptr_equal(dea_law_find(laws[i]->name), laws[i]);
    assert_int_equal((laws[i]->invariants != NULL) + (laws[i]->principal != NULL) +
                         (laws[i]->compressible != NULL),
                     1);
    assert_true(laws[i]->param_count >= 1 && laws[i]->param_count <= DEA_LAW_PARAM_MAX);
    assert_non_null(laws[i]->long_name);
    assert_non_null(laws[i]->source);
    for (size_t k = 0; k < laws[i]->param_count; k++) {
      const struct dea_law_param *param = &laws[i]->params[k];
      assert_true(param->key != NULL && param->unit != NULL && param->meaning != NULL);
      assert_true(param->min < param->max);
      assert_true(param->required || (param->min <= 0.0 && param->max >= 0.0));
      for (size_t m = 0; m < k; m++) {
        assert_string_not_equal(param->key, laws[i]->params[m].key);
      }
    }
  }
  assert_null(dea_law_find("Yeoh"));
  assert_null(dea_law_find(""));
}

static void check_sample(const struct dea_law *law, const double *param)
{
  for (size_t k = 0; k < law->param_count; k++) {
    assert_true(param[k] >= law->params[k].min && param[k] <= law->params[k].max);
  }
  assert_true(law->shear_modulus(param) > 0.0);
}

TEST(test_samples_are_admissible)
{
  for_each_law(check_sample);
}

/* Where in {W1 W2 W4} and {W11 W12 W22 W14 W24 W44} the derivative by each invariant stands. */
static const size_t second_of[3][3] = {{4, 5, 7}, {5, 6, 8}, {7, 8, 9}};

static void check_invariant_step(const struct dea_law *law, const double *param)
{
  if (law->invariants == NULL) {
    return;
  }
  static const double at[][3] = {
      {3.2, 3.1, 1.0}, {3.4, 3.3, 1.3}, {5.0, 4.5, 1.9}, {3.5, 3.4, 0.7}, {3.01, 3.009, 1.06}};
  for (size_t n = 0; n < sizeof at / sizeof at[0]; n++) {
    struct dea_law_energy e;
    assert_int_equal(law->invariants(param, at[n][0], at[n][1], at[n][2], &e), DEA_OK);
    const double real[10] = {e.W, e.W1, e.W2, e.W4, e.W11, e.W12, e.W22, e.W14, e.W24, e.W44};
    for (size_t k = 0; k < 3; k++) {
      double complex invariant[3] = {at[n][0], at[n][1], at[n][2]}, out[10];
      invariant[k] += step * _Complex_I;
      assert_int_equal(complex_invariants(law->name, param, invariant, out), DEA_OK);
      double derivative[10];
      for (size_t m = 0; m < 10; m++) {
        derivative[m] = cimag(out[m]) / step;
        assert_close(creal(out[m]), real[m], tolerance, tolerance * fabs(e.W1));
      }
      assert_all_close(law->name, &derivative[0], &real[1 + k], 1, tolerance, largest(&real[1], 3));
      for (size_t m = 0; m < 3; m++) {
        assert_all_close(law->name, &derivative[1 + m], &real[second_of[m][k]], 1, tolerance,
                         largest(&real[1], 9));
      }
    }
    if (!law->anisotropic) {
      assert_true(e.W4 == 0.0 && e.W14 == 0.0 && e.W24 == 0.0 && e.W44 == 0.0);
    }
  }
}

TEST(test_invariant_form_by_complex_step)
{
  for_each_law(check_invariant_step);
}

static void check_compressible_step(const struct dea_law *law, const double *param)
{
  if (law->compressible == NULL) {
    return;
  }
  static const double at[][2] = {{0, 0}, {0.2, 0.03}, {0.4, -0.2}, {2, 0.3}, {1e-9, 1e-9}};
  static const size_t second[2][2] = {{3, 4}, {4, 5}}; // of {W, W1 WJ, W11 W1J WJJ}
  for (size_t n = 0; n < sizeof at / sizeof at[0]; n++) {
    struct dea_law_volume e;
    assert_int_equal(law->compressible(param, at[n][0], at[n][1], &e), DEA_OK);
    const double real[6] = {e.W, e.W1, e.WJ, e.W11, e.W1J, e.WJJ};
    const double scale = largest(&real[1], 5);
    for (size_t k = 0; k < 2; k++) {
      double complex argument[2] = {at[n][0], at[n][1]}, out[6];
      argument[k] += step * _Complex_I;
      assert_int_equal(complex_compressible(law->name, param, argument, out), DEA_OK);
      assert_close(creal(out[0]), e.W, tolerance, 1e-20 * scale);
      assert_close(cimag(out[0]) / step, real[1 + k], tolerance, tolerance * scale);
      for (size_t m = 0; m < 2; m++) {
        assert_close(cimag(out[1 + m]) / step, real[second[m][k]], tolerance, tolerance * scale);
      }
    }
  }
}

TEST(test_compressible_form_by_complex_step)
{
  for_each_law(check_compressible_step);
}

/* The source's energy and stress in a form that the code does not use: at F = diag(a, a, b), W and
 * sigma = (mu (B - 1) + lambda ln J 1)/J with mu and lambda of E and nu; and the bulk modulus E/(3
 * (1
 * - 2 nu)) at small strains. */
TEST(test_compressible_neo_hookean)
{
  const struct dea_law *law = dea_law_find("compressible-neo-hookean");
  const double E = 4e9, nu = 0.38, param[DEA_LAW_PARAM_MAX] = {E, nu}, a = 1.1, b = 0.9;
  const double mu = E / 2.76, lambda = 0.38 * E / (1.38 * 0.24), J = a * a * b;
  const double F[9] = {a, 0, 0, 0, a, 0, 0, 0, b};
  struct dea_point point;
  assert_int_equal(dea_point_elastic(law, param, F, NULL, &point), DEA_OK);
  assert_close(point.W,
               0.5 * mu * (2 * a * a + b * b - 3) - mu * log(J) + 0.5 * lambda * log(J) * log(J),
               1e-13, 0);
  assert_close(point.P[0] * a / J, (mu * (a * a - 1) + lambda * log(J)) / J, 1e-13, 0);
  assert_close(point.P[8] * b / J, (mu * (b * b - 1) + lambda * log(J)) / J, 1e-13, 0);
  const double e = 1e-9, swollen[9] = {1 + e, 0, 0, 0, 1 + e, 0, 0, 0, 1 + e};
  assert_int_equal(dea_point_elastic(law, param, swollen, NULL, &point), DEA_OK);
  assert_close(point.P[0], 3 * e * E / (3 * (1 - 2 * nu)), 1e-6, 0); // 1 + e rounds e at 1e-7
  assert_close(point.W, 4.5 * e * e * E / (3 * (1 - 2 * nu)), 1e-6, 0);
}

static void check_principal_step(const struct dea_law *law, const double *param)
{
  if (law->principal == NULL) {
    return;
  }
  static const double at[] = {0.3, 0.8, 1.0, 1.00001, 1.5, 2.7};
  for (size_t n = 0; n < sizeof at / sizeof at[0]; n++) {
    double w, w1, w2;
    double complex out[3];
    assert_int_equal(law->principal(param, at[n], &w, &w1, &w2), DEA_OK);
    assert_int_equal(complex_principal(law->name, param, at[n] + step * _Complex_I, out), DEA_OK);
    assert_close(creal(out[0]), w, tolerance, tolerance * fabs(w1));
    assert_close(cimag(out[0]) / step, w1, tolerance, 0.0);
    assert_close(cimag(out[1]) / step, w2, tolerance, tolerance * fabs(w1));
  }
}

TEST(test_principal_form_by_complex_step)
{
  for_each_law(check_principal_step);
}

/* The published expansion of the ground-state modulus, in a form that the code does not use. */
TEST(test_arruda_boyce_ground_state)
{
  const double param[DEA_LAW_PARAM_MAX] = {1e5, 2.8}, y = 1.0 / (2.8 * 2.8);
  const double wanted = 1e5 * (1.0 + 3.0 / 5.0 * y + 99.0 / 175.0 * y * y +
                               513.0 / 875.0 * pow(y, 3) + 42039.0 / 67375.0 * pow(y, 4));
  assert_close(dea_law_find("arruda-boyce")->shear_modulus(param), wanted, 1e-14, 0.0);
}

/* A small k2 must join k2 = 0 without a jump, and fibres must not push. */
TEST(test_fibre_law)
{
  const struct dea_law *law = dea_law_find("holzapfel-gasser-ogden");
  const double quadratic[DEA_LAW_PARAM_MAX] = {1e5, 4e5, 0.0, 0.0};
  const double nearly[DEA_LAW_PARAM_MAX] = {1e5, 4e5, 1e-14, 0.0};
  struct dea_law_energy e, f;
  assert_int_equal(law->invariants(quadratic, 3.5, 3.4, 1.4, &e), DEA_OK);
  assert_int_equal(law->invariants(nearly, 3.5, 3.4, 1.4, &f), DEA_OK);
  assert_close(e.W, 0.5 * 1e5 * 0.5 + 0.5 * 4e5 * 0.4 * 0.4, 1e-14, 0.0);
  assert_close(f.W, e.W, 1e-13, 0.0);
  assert_close(f.W44, e.W44, 1e-13, 0.0);
  assert_int_equal(law->invariants(quadratic, 3.5, 3.4, 0.9, &e), DEA_OK);
  assert_close(e.W, 0.5 * 1e5 * 0.5, 1e-15, 0.0);
  assert_true(e.W4 == 0.0 && e.W44 == 0.0);
}

TEST(test_law_domain)
{
  struct dea_law_energy e;
  double w, w1, w2;
  const double gent[DEA_LAW_PARAM_MAX] = {43e3, 7.0};
  const struct dea_law *law = dea_law_find("gent");
  assert_int_equal(law->invariants(gent, 9.999, 9.0, 1.0, &e), DEA_OK);
  assert_int_equal(law->invariants(gent, 10.0, 9.0, 1.0, &e), DEA_E_DOMAIN);
  assert_int_equal(law->invariants(gent, 1e9, 9.0, 1.0, &e), DEA_E_DOMAIN);
  assert_int_equal(law->invariants(gent, (double)NAN, 9.0, 1.0, &e), DEA_E_DOMAIN);
  const double fibre[DEA_LAW_PARAM_MAX] = {1e5, 4e5, 1.0, 0.0};
  law = dea_law_find("holzapfel-gasser-ogden");
  assert_int_equal(law->invariants(fibre, 900.0, 9.0, 800.0, &e), DEA_E_DOMAIN);
  assert_int_equal(law->invariants(fibre, 3.0, 3.0, (double)NAN, &e), DEA_E_DOMAIN);
  const double ogden[DEA_LAW_PARAM_MAX] = {40e3, 2.5};
  law = dea_law_find("ogden");
  assert_int_equal(law->principal(ogden, 0.0, &w, &w1, &w2), DEA_E_DOMAIN);
  assert_int_equal(law->principal(ogden, -1.0, &w, &w1, &w2), DEA_E_DOMAIN);
  assert_int_equal(law->principal(ogden, (double)NAN, &w, &w1, &w2), DEA_E_DOMAIN);
}

TESTS(NULL, NULL)
