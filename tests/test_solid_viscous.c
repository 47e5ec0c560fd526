/* Branches of a layer at a point: derivatives, rest, weights, dissipation, pre-stretch. */
#include "model/solid/element/hex.h"
#include "model/solid/point/viscous.h"
#include "testing.h"

#include <string.h>

static const struct dea_branch branch = {2.5e5, 0.3};

/* A shear and stretch of given size without change of volume, but for `volume`. */
static double deform(double size, double volume, double F[9])
{
  const double bent[9] = {1 + size,   0.3 * size,  -0.2 * size, 0.1 * size, 1 - 0.4 * size,
                          0.5 * size, -0.3 * size, 0.2 * size,  1};
  double cof[9], J;
  memcpy(F, bent, sizeof bent);
  J = dea_cofactors(F, cof);
  for (int a = 0; a < 9; a++) {
    F[a] *= cbrt((1 + volume) / J);
  }
  return 1 + volume;
}

static void strains_at(double size, double C[6], double inverse[6])
{
  double F[9], cof[9], J = deform(size, 0, F);
  dea_cofactors(F, cof);
  dea_viscous_strain(F, cof, J, C, inverse);
}

static struct dea_point point_at(const struct dea_constituent *layer, const double F[9],
                                 bool tangent)
{
  struct dea_point point = {0};
  double cof[9], J = dea_cofactors(F, cof);
  dea_viscous_add(layer, 1, F, cof, J, tangent, &point);
  return point;
}

/* Stress against differences of the energy, tangent against those of the stress; symmetric. */
static void test_derivatives(void **state)
{
  (void)state;
  const double B[12] = {0, 0, 0, 0, 0, 0, 3e5, 2e5, 1.5e5, 2e4, -4e4, 3e4};
  const struct dea_constituent layer = {.viscous = B, .viscous_Pa = 2.2e5};
  const double d = 1e-6;
  double F[9];
  deform(0.4, 0.03, F);
  const struct dea_point at = point_at(&layer, F, true);
  for (int a = 0; a < 9; a++) {
    double up[9], down[9];
    memcpy(up, F, sizeof up);
    memcpy(down, F, sizeof down);
    up[a] += d;
    down[a] -= d;
    const struct dea_point more = point_at(&layer, up, false), less = point_at(&layer, down, false);
    assert_close(at.P[a], (more.W - less.W) / (2 * d), 0, 1e-4 * 3e5 * 1e-3);
    for (int b = 0; b < 9; b++) {
      assert_close(at.A[9 * b + a], (more.P[b] - less.P[b]) / (2 * d), 0, 1e-8 * 3e5);
      assert_close(at.A[9 * b + a], at.A[9 * a + b], 0, 1e-14 * 3e5);
    }
  }
}

/* A film that was held for long has A = C^-1, and no stress from its branch however short the step,
 * whatever its volume. At rest small motions cost b e : e. */
static void test_held_film_has_no_stress(void **state)
{
  (void)state;
  for (double step = 1e-9; step < 1e4; step *= 31) {
    struct dea_branch_step weights;
    dea_branch_step_set(&branch, step, &weights);
    double share = weights.end.e + weights.end.w0, F[9], cof[9], C[6], inverse[6], B[12];
    assert_close(share + weights.end.w1, 1, 1e-15, 0);
    assert_true(weights.end.w0 >= 0 && weights.end.w1 >= 0);
    double J = deform(0.5, 0.02, F);
    dea_cofactors(F, cof);
    dea_viscous_strain(F, cof, J, C, inverse);
    for (int a = 0; a < 6; a++) {
      B[6 + a] = branch.modulus_Pa * share * inverse[a];
    }
    const struct dea_constituent layer = {.viscous = B, .viscous_Pa = branch.modulus_Pa * share};
    const struct dea_point point = point_at(&layer, F, false);
    for (int a = 0; a < 9; a++) {
      assert_close(point.P[a], 0, 0, 1e-14 * branch.modulus_Pa);
    }
  }
  const double B[12] = {0, 0, 0, 0, 0, 0, 1e5, 1e5, 1e5, 0, 0, 0};
  const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, e[9] = {0.3, 1, -2, 0.4, 1.1, 5, 0.6, 2, -0.7};
  const struct dea_constituent layer = {.viscous = B, .viscous_Pa = 1e5};
  const struct dea_point rest = point_at(&layer, one, true);
  double twice = 0, wanted = 0;
  for (int a = 0; a < 9; a++) {
    double sym = 0.5 * (e[a] + e[3 * (a % 3) + a / 3]);
    wanted += 2 * 1e5 * sym * sym;
    for (int b = 0; b < 9; b++) {
      twice += e[a] * rest.A[9 * a + b] * e[b];
    }
  }
  assert_close(rest.W, 0, 0, 0);
  assert_close(twice, wanted, 1e-13, 0);
}

/* Energy of the step counted from the unstretched film, with F G and the branch's own variable A,
 * is that counted from the stretched one with G A G. */
static void test_pre_stretch_drops_out(void **state)
{
  (void)state;
  const double G[3] = {1.5, 1.2, 1 / 1.8};
  const double A[6] = {0.5, 0.7, 2.9, 0.1, -0.2, 0.05};
  static const int row[6] = {0, 1, 2, 1, 0, 0}, column[6] = {0, 1, 2, 2, 2, 1};
  double there[12] = {0}, here[12] = {0}, F[9], FG[9], trace[2] = {0, 0};
  for (int a = 0; a < 6; a++) {
    there[6 + a] = A[a];
    here[6 + a] = G[row[a]] * G[column[a]] * A[a];
    trace[0] += a < 3 ? 0.5 * there[6 + a] : 0;
    trace[1] += a < 3 ? 0.5 * here[6 + a] : 0;
  }
  deform(0.3, 0, F);
  for (int a = 0; a < 9; a++) {
    FG[a] = F[a] * G[a % 3];
  }
  const struct dea_constituent unstretched = {.viscous = there}, stretched = {.viscous = here};
  assert_close(point_at(&unstretched, FG, false).W + trace[0],
               point_at(&stretched, F, false).W + trace[1], 1e-13, 0);
}

/* The weights are exact for C^-1 linear in time: one step is as good as many; so is what it
 * dissipates, but for its quadrature, from short steps to long ones. */
static void test_one_step_is_as_good_as_many(void **state)
{
  (void)state;
  for (double step = 0.01; step < 50; step *= 3) {
    enum { PARTS = 400 };
    struct dea_branch_step whole, part;
    double C[6], from[6], to[6], A[6], fine[6], sum = 0;
    strains_at(0.1, C, A);
    strains_at(0.3, C, from);
    strains_at(0.6, C, to);
    memcpy(fine, A, sizeof fine);
    dea_branch_step_set(&branch, step, &whole);
    dea_branch_step_set(&branch, step / PARTS, &part);
    double dissipated = dea_branch_dissipation(&branch, &whole, A, from, to);
    for (int i = 0; i < PARTS; i++) {
      double a[6], b[6];
      for (int k = 0; k < 6; k++) {
        a[k] = from[k] + (to[k] - from[k]) * i / PARTS;
        b[k] = from[k] + (to[k] - from[k]) * (i + 1) / PARTS;
      }
      sum += dea_branch_dissipation(&branch, &part, fine, a, b);
      for (int k = 0; k < 6; k++) {
        fine[k] = part.end.e * fine[k] + part.end.w0 * a[k] + part.end.w1 * b[k];
      }
    }
    for (int k = 0; k < 6; k++) {
      A[k] = whole.end.e * A[k] + whole.end.w0 * from[k] + whole.end.w1 * to[k];
      assert_close(A[k], fine[k], 1e-12, 1e-13);
    }
    assert_close(dissipated, sum, 3e-4, 0);
  }
}

/* Work of the branch's stress along a motion = what it stores + what it dissipates. */
static void test_work_is_stored_or_dissipated(void **state)
{
  (void)state;
  enum { STEPS = 4000 };
  struct dea_branch_step step;
  double C[6], from[6], to[6], A[6], F[9], next[9], P[9] = {0}, work = 0, dissipated = 0;
  dea_branch_step_set(&branch, 1.0 / STEPS, &step);
  strains_at(0, C, from);
  memcpy(A, from, sizeof A);
  deform(0, 0, F);
  for (int i = 1; i <= STEPS; i++) {
    double size = 0.5 * sin(5.0 * i / STEPS), B[12];
    strains_at(size, C, to);
    deform(size, 0, next);
    dissipated += dea_branch_dissipation(&branch, &step, A, from, to);
    for (int k = 0; k < 6; k++) {
      double known = step.end.e * A[k] + step.end.w0 * from[k];
      B[6 + k] = branch.modulus_Pa * known;
      A[k] = known + step.end.w1 * to[k];
    }
    const struct dea_constituent layer = {
        .viscous = B, .viscous_Pa = branch.modulus_Pa * (step.end.e + step.end.w0)};
    const struct dea_point point = point_at(&layer, next, false);
    for (int a = 0; a < 9; a++) {
      work += 0.5 * (P[a] + point.P[a]) * (next[a] - F[a]);
      P[a] = point.P[a];
      F[a] = next[a];
    }
    memcpy(from, to, sizeof from);
  }
  double stored = dea_branch_energy(branch.modulus_Pa, A, C);
  assert_true(dissipated > 0.2 * stored && stored > 0.05 * dissipated);
  assert_close(work, stored + dissipated, 1e-5, 0);
}

/* A membrane: derivatives, and no stress where it was held for long. */
static void test_flat(void **state)
{
  (void)state;
  const double B[6] = {3e5, 2e5, 1.5e5, 0, 0, 3e4}, d = 1e-6;
  const double F[6] = {1.2, 0.1, -0.2, 0.9, 0.3, 0.4};
  const struct dea_constituent layer = {.viscous = B};
  struct dea_membrane_point at = {.area = 1}, up, down;
  dea_viscous_add_flat(&layer, 0, F, &at);
  for (int a = 0; a < 6; a++) {
    double moved[6];
    memcpy(moved, F, sizeof moved);
    up = down = (struct dea_membrane_point){.area = 1};
    moved[a] = F[a] + d;
    dea_viscous_add_flat(&layer, 0, moved, &up);
    moved[a] = F[a] - d;
    dea_viscous_add_flat(&layer, 0, moved, &down);
    assert_close(at.P[a], (up.W - down.W) / (2 * d), 0, 1e-9 * 3e5);
    for (int b = 0; b < 6; b++) {
      assert_close(at.A[6 * b + a], (up.P[b] - down.P[b]) / (2 * d), 0, 1e-9 * 3e5);
      assert_close(at.A[6 * b + a], at.A[6 * a + b], 0, 1e-13 * 3e5);
    }
  }
  double C[6], inverse[6];
  dea_viscous_strain_flat(F, C, inverse);
  const struct dea_constituent held = {.viscous = inverse};
  at = (struct dea_membrane_point){.area = 1};
  dea_viscous_add_flat(&held, 0, F, &at);
  for (int a = 0; a < 6; a++) {
    assert_close(at.P[a], 0, 0, 1e-14);
  }
}

/* A film that wrinkles while its branches carry stress on axes of their own: derivatives, and the
 * same energy and stress as a taut one has at its natural width. */
static void test_wrinkled(void **state)
{
  (void)state;
  const double B[6] = {3e5, 2.4e5, 2.2e5, 0, 0, 4e4}, d = 1e-6, field = 4e7;
  const double F[6] = {0.75, 0.1, -0.1, 1.1, 0.2, 0.3};
  const double yeoh[] = {178.4e3, -6e3, 4.2e3};
  struct dea_constituent layer = {.pre_stretch = {0.95, 1.15, 1 / (0.95 * 1.15 - 1e-4)},
                                  .pre_shear = 0.01,
                                  .permittivity_F_per_m = 2.5e-11,
                                  .viscous = B,
                                  .relaxed = true};
  struct dea_membrane_point at, up, down;
  dea_constituent_set_law(&layer, dea_law_find("yeoh"), yeoh);
  assert_int_equal(dea_viscous_membrane_point(&layer, 0, F, field, &at), DEA_OK);
  assert_int_equal(at.state, DEA_WRINKLED);
  for (int a = 0; a < 6; a++) {
    double moved[6];
    memcpy(moved, F, sizeof moved);
    moved[a] = F[a] + d;
    assert_int_equal(dea_viscous_membrane_point(&layer, 0, moved, field, &up), DEA_OK);
    moved[a] = F[a] - d;
    assert_int_equal(dea_viscous_membrane_point(&layer, 0, moved, field, &down), DEA_OK);
    assert_close(at.P[a], (up.W - down.W) / (2 * d), 0, 1e-8 * 3e5);
    for (int b = 0; b < 6; b++) {
      assert_close(at.A[6 * b + a], (up.P[b] - down.P[b]) / (2 * d), 0, 1e-8 * 3e5);
    }
  }
  double low = 0.75, high = 1.3; // along 1, with axes of branches along those of C
  const double straight[6] = {3e5, 2.4e5, 2.2e5, 0, 0, 0};
  layer.viscous = straight;
  layer.pre_shear = 0;
  layer.pre_stretch[2] = 1 / (0.95 * 1.15);
  for (int i = 0; i < 60; i++) {
    const double middle[6] = {0.5 * (low + high), 0, 0, 1.1};
    assert_int_equal(dea_viscous_membrane_point(&layer, 0, middle, field, &at), DEA_OK);
    *(at.state == DEA_TAUT ? &high : &low) = middle[0];
  }
  const double narrow[6] = {0.75, 0, 0, 1.1}, wide[6] = {high, 0, 0, 1.1};
  assert_int_equal(dea_viscous_membrane_point(&layer, 0, narrow, field, &down), DEA_OK);
  assert_int_equal(dea_viscous_membrane_point(&layer, 0, wide, field, &up), DEA_OK);
  assert_close(down.W, up.W, 0, 1e-6);
  assert_close(down.P[3], up.P[3], 0, 1e-6);
  assert_close(down.area, high * 1.1, 1e-12, 0);
  assert_close(up.P[0], 0, 0, 1e-6);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_derivatives),
      cmocka_unit_test(test_held_film_has_no_stress),
      cmocka_unit_test(test_pre_stretch_drops_out),
      cmocka_unit_test(test_one_step_is_as_good_as_many),
      cmocka_unit_test(test_work_is_stored_or_dissipated),
      cmocka_unit_test(test_flat),
      cmocka_unit_test(test_wrinkled),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
