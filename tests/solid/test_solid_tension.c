/* Tension field: what is left of the energy of a film that wrinkles. */
// ctest: quick, heavy
#include "membrane_samples.h"

/* Stress of a uniaxial test, W1 of Yeoh. */
static double uniaxial(double l)
{
  double I1 = l * l + 2 / l - 3;
  return 2 * (l - 1 / (l * l)) * (yeoh[0] + 2 * yeoh[1] * I1 + 3 * yeoh[2] * I1 * I1);
}

/* Narrower than it wants to be, a film without field is a bundle of strings: the stress of a
 * uniaxial test along them, nothing across, whatever its width. Smaller than its natural size it
 * has no energy and no stress. */
TEST(test_wrinkled_is_uniaxial_and_slack_is_nothing)
{
  static const double widths[] = {0.8, 0.5, 0.1, 0};
  struct dea_part_material layer = yeoh_film(1);
  struct dea_membrane_point point;
  double F[6], direction[3], l = 1.4, I1 = l * l + 2 / l - 3;
  layer.relaxed = true;
  for (int i = 0; i < 4; i++) {
    compose(l, widths[i], 0.6, F);
    assert_int_equal(dea_membrane_point(&layer, NULL, F, 0, &point), DEA_OK);
    assert_int_equal(point.state, DEA_WRINKLED);
    assert_close(point.W, yeoh[0] * I1 + yeoh[1] * I1 * I1 + yeoh[2] * I1 * I1 * I1, 1e-12, 0);
    for (int a = 0; a < 3; a++) { // F N_1/l
      direction[a] = (F[2 * a] * cos(0.6) + F[2 * a + 1] * sin(0.6)) / l;
    }
    for (int a = 0; a < 6; a++) {
      double N = a % 2 == 0 ? cos(0.6) : sin(0.6);
      assert_close(point.P[a], uniaxial(l) * direction[a / 2] * N, 0, 1e-11 * uniaxial(l));
    }
    assert_close(point.tension_Pa[0], uniaxial(l) * sqrt(l), 1e-12, 0);
    assert_close(point.tension_Pa[1], 0, 0, 1e-9);
  }
  compose(0.97, 0.3, 0.6, F);
  assert_int_equal(dea_membrane_point(&layer, NULL, F, 0, &point), DEA_OK);
  assert_int_equal(point.state, DEA_SLACK);
  assert_close(point.W, 0, 0, 1e-9);
  assert_close(largest(point.P, 6), 0, 0, 1e-9);
  assert_close(largest(point.A, 36), 0, 0, 1e-9);
}

/* With a field the energy is the lowest that a larger film folded into the place can have: least of
 * f over all stretches that are not smaller, looked for by brute force. */
TEST(test_relaxed_energy_is_the_lowest)
{
  const double G = 1.2, field = 6e7;
  const struct dea_part_material plain = yeoh_film(G);
  struct dea_part_material layer = plain;
  bool seen[3] = {false, false, false};
  layer.relaxed = true;
  for (double m1 = 0.76; m1 < 1.3; m1 += 0.09) {
    for (double m2 = 0.65; m2 <= m1; m2 += 0.09) {
      double F[6], least = INFINITY, n1 = m1, n2 = m2;
      struct dea_membrane_point point, other;
      compose(m1, m2, 1, F);
      assert_int_equal(dea_membrane_point(&layer, NULL, F, field, &point), DEA_OK);
      for (int i = 0; i <= 300; i++) {
        for (int j = 0; j <= 300; j++) {
          compose(m1 + 2e-3 * i, m2 + 2e-3 * j, 1, F);
          assert_int_equal(dea_membrane_point(&plain, NULL, F, field, &other), DEA_OK);
          if (other.W < least) {
            least = other.W;
            n1 = m1 + 2e-3 * i;
            n2 = m2 + 2e-3 * j;
          }
        }
      }
      seen[point.state] = true;
      assert_true(point.W <= least + 1e-9 * fabs(least)); // the search has steps
      assert_close(point.W, least, 0, 8);                 // 2e6 Pa times their square
      assert_close(point.area, n1 * n2, 0, 6e-3);
    }
  }
  assert_true(seen[DEA_TAUT] && seen[DEA_WRINKLED] && seen[DEA_SLACK]);
}

/* Stress and tangent of the relaxed energy by differences, and both go over smoothly. */
TEST(test_derivatives_of_the_relaxed_energy)
{
  const double d = 1e-6, field = 6e7;
  struct dea_part_material layer = yeoh_film(1.2);
  layer.relaxed = true;
  bool seen[3] = {false, false, false};
  for (double m2 = 0.3; m2 < 1.3; m2 += 0.05) {
    for (double m1 = 0.5; m1 < 1.4; m1 += 0.2) {
      double F[6];
      struct dea_membrane_point point, more, less;
      compose(m1, m2, 0.4, F);
      assert_int_equal(dea_membrane_point(&layer, NULL, F, field, &point), DEA_OK);
      seen[point.state] = true;
      for (int b = 0; b < 6; b++) {
        double keep = F[b];
        F[b] = keep + d;
        assert_int_equal(dea_membrane_point(&layer, NULL, F, field, &more), DEA_OK);
        F[b] = keep - d;
        assert_int_equal(dea_membrane_point(&layer, NULL, F, field, &less), DEA_OK);
        F[b] = keep;
        assert_close(point.P[b], (more.W - less.W) / (2 * d), 0, 1e-2); // of 1e6
        for (int a = 0; a < 6 && more.state == less.state; a++) {
          assert_close(point.A[6 * a + b], (more.P[a] - less.P[a]) / (2 * d), 0, 1e-2);
          assert_close(point.A[6 * a + b], point.A[6 * b + a], 0, 1e-8);
        }
      }
    }
  }
  assert_true(seen[DEA_TAUT] && seen[DEA_WRINKLED] && seen[DEA_SLACK]);
}

/* A field beyond which the film thins without limit leaves it no natural width. Gent's law locks,
 * and always has one. */
TEST(test_no_natural_width)
{
  static const double neo[DEA_LAW_PARAM_MAX] = {80e3}, gent[DEA_LAW_PARAM_MAX] = {80e3, 7};
  struct dea_part_material soft = film(dea_law_find("neo-hookean"), neo, 1, 1);
  struct dea_part_material locking = film(dea_law_find("gent"), gent, 1, 1);
  struct dea_membrane_point point;
  double F[6], peak = 0.687365 * sqrt(80e3 / permittivity); // benchmark 2
  soft.relaxed = locking.relaxed = true;
  compose(0.9, 0.8, 1, F);
  assert_int_equal(dea_membrane_point(&soft, NULL, F, 0.999 * peak, &point), DEA_OK);
  assert_close(sqrt(point.area), 1.259921, 3e-2, 0); // flat there: a root of the distance to it
  assert_int_equal(dea_membrane_point(&soft, NULL, F, 1.001 * peak, &point), DEA_E_DOMAIN);
  assert_int_equal(dea_membrane_point(&locking, NULL, F, 2 * peak, &point), DEA_OK);
  assert_int_equal(point.state, DEA_SLACK);
  double l = sqrt(point.area);
  assert_true(2 * l * l + pow(l, -4) - 3 < 7);
}

TESTS(NULL, NULL)
