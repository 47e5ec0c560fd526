/* material/plane: derivatives, limits and published numbers of the plane-stress film. */
#include "complex_material.h"
#include "material/plane.h"
#include "material/point.h"
#include "material_samples.h"

static const double step = 1e-30;
static const double tolerance = 1e-12;

static const double stretches[][2] = {{1.0, 1.0}, {1.05, 1.05},     {1.5, 1.5},
                                      {1.2, 0.9}, {0.8, 1.6},       {1.7, 1.1},
                                      {0.7, 0.7}, {1.3, 1.3000001}, {1.0, 1.001}};
enum { STRETCH_COUNT = sizeof stretches / sizeof stretches[0] };
static const double fibre_angle = 0.4;

static struct dea_material material_of(const struct dea_law *law, const double *param, double angle)
{
  struct dea_material material = {.law = law, .fibre_angle_rad = angle};
  memcpy(material.param, param, sizeof material.param);
  return material;
}

/* Checks real = {W, s1, s2, k11, k12, k22} against steps in both stretches of a complex build. */
static void check_plane_steps(const char *what, const double real[6], double complex stepped[2][6])
{
  static const size_t second[2][2] = {{3, 4}, {4, 5}};
  const double stress = largest(&real[1], 5); // a stress scale that is not 0 at rest
  for (size_t k = 0; k < 2; k++) {
    double derivative[3];
    for (size_t m = 0; m < 3; m++) {
      derivative[m] = cimag(stepped[k][m]) / step;
    }
    const double wanted[3] = {real[1 + k], real[second[0][k]], real[second[1][k]]};
    assert_all_close(what, derivative, wanted, 3, tolerance, stress);
    for (size_t m = 0; m < 6; m++) {
      assert_close(creal(stepped[k][m]), real[m], 0.0, tolerance * stress);
    }
  }
}

static void check_elastic_steps(const struct dea_law *law, const double *param)
{
  if (law->compressible != NULL) {
    return;
  }
  const struct dea_material material = material_of(law, param, fibre_angle);
  for (size_t n = 0; n < STRETCH_COUNT; n++) {
    if (n == 0 && law->anisotropic) {
      continue; // tension-only fibres have a kink in their tangent at rest
    }
    struct dea_plane plane;
    const double *l = stretches[n];
    assert_int_equal(dea_plane_elastic(&material, l[0], l[1], &plane), DEA_OK);
    double complex stepped[2][6];
    for (size_t k = 0; k < 2; k++) {
      double complex lambda[2] = {l[0], l[1]};
      lambda[k] += step * _Complex_I;
      assert_int_equal(complex_plane_elastic(law->name, param, fibre_angle, lambda, stepped[k]),
                       DEA_OK);
    }
    check_plane_steps(law->name,
                      (double[6]){plane.W, plane.s1, plane.s2, plane.k11, plane.k12, plane.k22},
                      stepped);
  }
}

TEST(test_elastic_by_complex_step)
{
  for_each_law(check_elastic_steps);
}

TEST(test_electric_by_complex_step)
{
  static const double eps[][2] = {{2.8, 0.0}, {2.48, -0.28}, {4.5, 0.3}};
  const double field = 60e6;
  for (size_t e = 0; e < sizeof eps / sizeof eps[0]; e++) {
    const struct dea_material material = {.permittivity = {eps[e][0], eps[e][1]}};
    for (size_t n = 0; n < STRETCH_COUNT; n++) {
      struct dea_plane plane;
      dea_plane_electric(&material, field, stretches[n][0], stretches[n][1], &plane);
      double complex stepped[2][6];
      for (size_t k = 0; k < 2; k++) {
        double complex lambda[2] = {stretches[n][0], stretches[n][1]};
        lambda[k] += step * _Complex_I;
        complex_plane_electric(eps[e][0], eps[e][1], field, lambda, stepped[k]);
      }
      check_plane_steps("electric",
                        (double[6]){plane.W, plane.s1, plane.s2, plane.k11, plane.k12, plane.k22},
                        stepped);
    }
  }
}

/* Paper eq 14 written out, with eps_r = 2.76 - 0.28 s. */
TEST(test_electric_energy)
{
  const struct dea_material material = {.permittivity = {2.48, -0.28}};
  struct dea_plane plane;
  dea_plane_electric(&material, 5e7, 1.8, 1.25, &plane);
  const double eps_r = 2.76 - 0.28 * 1.5; // sqrt(1.8 * 1.25) = 1.5
  assert_close(plane.W, -0.5 * 8.8541878128e-12 * eps_r * 5e7 * 5e7 * 2.25 * 2.25, 1e-14, 0.0);
}

static void check_reference(const struct dea_law *law, const double *param)
{
  if (law->compressible != NULL) {
    return;
  }
  const struct dea_material material = material_of(law, param, 0.0);
  const double G = law->shear_modulus(param);
  struct dea_plane plane;
  assert_int_equal(dea_plane_elastic(&material, 1.0, 1.0, &plane), DEA_OK);
  const double rest[3] = {plane.W, plane.s1, plane.s2};
  assert_all_close(law->name, rest, (double[3]){0.0}, 3, 1e-14, G);
  if (!law->anisotropic) {
    const double tangent[3] = {plane.k11, plane.k12, plane.k22};
    assert_all_close(law->name, tangent, (double[3]){4.0 * G, 2.0 * G, 4.0 * G}, 3, 1e-13, G);
  }
  // Equibiaxial: s = 6 G e + O(e^2). Compression, so that fibres do not act.
  const double e = -1e-7;
  assert_int_equal(dea_plane_elastic(&material, 1.0 + e, 1.0 + e, &plane), DEA_OK);
  assert_close(plane.s1, 6.0 * G * e, 5e-6, 0.0);
  assert_close(plane.s2, 6.0 * G * e, 5e-6, 0.0);
}

TEST(test_reference_and_small_strain)
{
  for_each_law(check_reference);
}

/* The same film as a material point in three dimensions, its pressure found from P33 = 0. */
static void check_against_point(const struct dea_law *law, const double *param)
{
  if (law->compressible != NULL) {
    return;
  }
  const struct dea_material material = material_of(law, param, fibre_angle);
  const double fibre[3] = {cos(fibre_angle), sin(fibre_angle), 0.0};
  for (size_t n = 1; n < STRETCH_COUNT; n++) {
    const double l1 = stretches[n][0], l2 = stretches[n][1], l3 = 1.0 / (l1 * l2);
    struct dea_plane plane;
    struct dea_point point;
    assert_int_equal(dea_plane_elastic(&material, l1, l2, &plane), DEA_OK);
    const double F[9] = {l1, 0.0, 0.0, 0.0, l2, 0.0, 0.0, 0.0, l3};
    assert_int_equal(dea_point_elastic(law, param, F, fibre, &point), DEA_OK);
    const double pressure = point.P[8] * l3;
    const double plane_values[3] = {plane.W, plane.s1, plane.s2};
    const double point_values[3] = {point.W, point.P[0] - pressure / l1,
                                    point.P[4] - pressure / l2};
    assert_all_close(law->name, plane_values, point_values, 3, tolerance, fabs(plane.k11));
  }
}

TEST(test_plane_against_point)
{
  for_each_law(check_against_point);
}

static void check_domain(const struct dea_law *law, const double *param)
{
  if (law->compressible != NULL) { // no film of it
    const struct dea_material solid = material_of(law, param, 0.0);
    struct dea_plane none;
    assert_int_equal(dea_plane_elastic(&solid, 1.0, 1.0, &none), DEA_E_ARGUMENT);
    return;
  }
  const struct dea_material material = material_of(law, param, fibre_angle);
  static const double bad[] = {0.0,   -0.0,  -1.0, (double)NAN, (double)INFINITY, -(double)INFINITY,
                               1e200, 1e-200};
  struct dea_plane plane;
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    assert_int_equal(dea_plane_elastic(&material, bad[i], 1.1, &plane), DEA_E_DOMAIN);
    assert_int_equal(dea_plane_elastic(&material, 1.1, bad[i], &plane), DEA_E_DOMAIN);
  }
  assert_int_equal(dea_plane_elastic(&material, -1.1, -1.1, &plane), DEA_E_DOMAIN);
}

TEST(test_plane_domain)
{
  for_each_law(check_domain);
  const struct dea_material gent = {.law = dea_law_find("gent"), .param = {43e3, 7.0}};
  struct dea_plane plane;
  assert_int_equal(dea_plane_elastic(&gent, 2.2, 2.2, &plane), DEA_OK);
  assert_int_equal(dea_plane_elastic(&gent, 2.3, 2.3, &plane), DEA_E_DOMAIN);
  const struct dea_material none = {.young_modulus_Pa = 2950e6};
  assert_int_equal(dea_plane_elastic(&none, 1.0, 1.0, &plane), DEA_E_ARGUMENT);
}

/* Nominal stress of paper Table 1 under equibiaxial stretch, s = 2 (l - l^-5) W'(I1), in kPa to the
 * digits known from a calculation independent of this code. */
TEST(test_yeoh_equibiaxial)
{
  static const double known[][2] = {{1.1, 169.879}, {1.2, 280.470}, {1.3, 363.529},
                                    {1.4, 441.409}, {1.5, 531.830}, {2.0, 1734.761}};
  const struct dea_material yeoh = {.law = dea_law_find("yeoh"), .param = {178.4e3, -6e3, 4.2e3}};
  struct dea_plane plane;
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
    assert_int_equal(dea_plane_elastic(&yeoh, known[i][0], known[i][0], &plane), DEA_OK);
    assert_close(plane.s1 * 1e-3, known[i][1], 0.0, 0.5e-3);
    assert_close(plane.s2 * 1e-3, known[i][1], 0.0, 0.5e-3);
  }
  assert_int_equal(dea_plane_elastic(&yeoh, 1.5, 1.5, &plane), DEA_OK);
  assert_close(plane.s1 * 1.5e-3, 797.745, 0.0, 0.5e-3);
}

TEST(test_breakdown)
{
  struct dea_material material = {
      .breakdown = {
          .known = true, .at_rest_V_per_m = 80e6, .exponent = 0.5, .exponent_known = true}};
  assert_close(dea_breakdown_field(&material, 2.25), 120e6, 1e-15, 0.0);
  material.breakdown.known = false;
  assert_true(isnan(dea_breakdown_field(&material, 1.0)));
}

TESTS(NULL, NULL)
