/* Branches of a layer at a point: derivatives, rest, weights, dissipation, pre-stretch. */
#include "model/solid/element/hex.h"
#include "model/solid/point/membrane_point.h"
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

static struct dea_point point_at(const struct dea_part_material *layer, const double F[9],
                                 bool tangent)
{
  struct dea_point point = {0};
  double cof[9], J = dea_cofactors(F, cof);
  dea_viscous_add(layer, 1, F, cof, J, tangent, &point);
  return point;
}

/* Stress against differences of the energy, tangent against those of the stress; symmetric. */
TEST(test_derivatives)
{
  const double B[12] = {0, 0, 0, 0, 0, 0, 3e5, 2e5, 1.5e5, 2e4, -4e4, 3e4};
  const struct dea_part_material layer = {.viscous = B, .viscous_Pa = 2.2e5};
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
TEST(test_held_film_has_no_stress)
{
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
    const struct dea_part_material layer = {.viscous = B, .viscous_Pa = branch.modulus_Pa * share};
    const struct dea_point point = point_at(&layer, F, false);
    for (int a = 0; a < 9; a++) {
      assert_close(point.P[a], 0, 0, 1e-14 * branch.modulus_Pa);
    }
  }
  const double B[12] = {0, 0, 0, 0, 0, 0, 1e5, 1e5, 1e5, 0, 0, 0};
  const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, e[9] = {0.3, 1, -2, 0.4, 1.1, 5, 0.6, 2, -0.7};
  const struct dea_part_material layer = {.viscous = B, .viscous_Pa = 1e5};
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
TEST(test_pre_stretch_drops_out)
{
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
  const struct dea_part_material unstretched = {.viscous = there}, stretched = {.viscous = here};
  assert_close(point_at(&unstretched, FG, false).W + trace[0],
               point_at(&stretched, F, false).W + trace[1], 1e-13, 0);
}

/* The weights are exact for C^-1 linear in time: one step is as good as many; so is what it
 * dissipates, but for its quadrature, from short steps to long ones. */
TEST(test_one_step_is_as_good_as_many)
{
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
TEST(test_work_is_stored_or_dissipated)
{
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
    const struct dea_part_material layer = {
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

/* A film of a law so soft that it counts for nothing. */
static struct dea_part_material soft_film(const double B[6])
{
  struct dea_part_material layer = {.pre_stretch = {1, 1, 1}, .viscous = B};
  dea_part_material_set_law(&layer, dea_law_find("neo-hookean"), (const double[]){1e-12});
  return layer;
}

static void membrane_at(const struct dea_part_material *layer, const double F[6], double field,
                        struct dea_membrane_point *out)
{
  assert_int_equal(dea_membrane_point(layer, layer->viscous, F, field, out), DEA_OK);
}

/* Derivatives of a membrane by differences, to a share of the modulus. */
static void check_membrane(const struct dea_part_material *layer, const double F[6], double field,
                           double share)
{
  const double d = 1e-6, small = share * 3e5;
  struct dea_membrane_point at, up, down;
  membrane_at(layer, F, field, &at);
  for (int a = 0; a < 6; a++) {
    double moved[6];
    memcpy(moved, F, sizeof moved);
    moved[a] = F[a] + d;
    membrane_at(layer, moved, field, &up);
    moved[a] = F[a] - d;
    membrane_at(layer, moved, field, &down);
    assert_close(at.P[a], (up.W - down.W) / (2 * d), 0, small);
    for (int b = 0; b < 6; b++) {
      assert_close(at.A[6 * b + a], (up.P[b] - down.P[b]) / (2 * d), 0, small);
      assert_close(at.A[6 * b + a], at.A[6 * a + b], 0, 1e-11 * 3e5);
    }
  }
}

/* A membrane: derivatives, and no stress where it was held for long. */
TEST(test_flat)
{
  const double B[6] = {3e5, 2e5, 1.5e5, 0, 0, 3e4};
  const double F[6] = {1.2, 0.1, -0.2, 0.9, 0.3, 0.4};
  struct dea_part_material layer = soft_film(B);
  struct dea_membrane_point at;
  check_membrane(&layer, F, 0, 1e-9);
  double C[6], inverse[6];
  membrane_at(&layer, F, 0, &at);
  dea_viscous_strain_flat(at.own, C, inverse);
  layer.viscous = inverse;
  membrane_at(&layer, F, 0, &at);
  for (int a = 0; a < 6; a++) {
    assert_close(at.P[a], 0, 0, 1e-11);
  }
}

/* Metric of the flat film by three numbers, as columns F. */
static void compose_metric(double c11, double c22, double c12, double F[6])
{
  const double a = sqrt(c11), b = c12 / a;
  const double columns[6] = {a, b, 0, sqrt(c22 - b * b), 0, 0};
  memcpy(F, columns, sizeof columns);
}

/* A film that wrinkles or is slack while its branches carry stress on axes of their own: its energy
 * is the least of all metrics that are not smaller than its place, looked for by brute force, and
 * wrinkles turn away from the axes of C for it. */
TEST(test_relaxed_with_branches)
{
  enum { CASES = 4, STEPS = 40 };
  const double B[6] = {3e5, 1.2e5, 2.2e5, 0, 0, 9e4}, field = 4e7;
  const double places[CASES][3] = {
      {0.6, 1.2, 0}, {0.5, 0.7, 0.1}, {0.3, 1.6, 0.2}, {1.3, 0.4, -0.1}};
  const double yeoh[] = {178.4e3, -6e3, 4.2e3};
  struct dea_part_material layer = {.pre_stretch = {0.95, 1.15, 1 / (0.95 * 1.15 - 1e-4)},
                                    .pre_shear = 0.01,
                                    .permittivity_F_per_m = 2.5e-11,
                                    .viscous = B};
  bool seen[3] = {false};
  dea_part_material_set_law(&layer, dea_law_find("yeoh"), yeoh);
  for (int i = 0; i < CASES; i++) {
    double F[6], least = INFINITY, width = 0.8;
    const double *c = places[i];
    double from[3] = {0.7, 0, 0.7}, found[3] = {0};
    struct dea_membrane_point at, other;
    compose_metric(c[0], c[1], c[2], F);
    layer.relaxed = true;
    check_membrane(&layer, F, field, 1e-7);
    membrane_at(&layer, F, field, &at);
    seen[at.state] = true;
    layer.relaxed = false;
    for (int round = 0; round < 5; round++, width *= 0.2) { // c + L L^T, finer and finer
      for (int k = 0; k < STEPS * STEPS * STEPS; k++) {
        const double p = fmax(from[0] + width * (2.0 * (k % STEPS) / (STEPS - 1) - 1), 0);
        const double q = from[1] + width * (2.0 * (k / STEPS % STEPS) / (STEPS - 1) - 1);
        const double r = fmax(from[2] + width * (2.0 * (k / STEPS / STEPS) / (STEPS - 1) - 1), 0);
        compose_metric(c[0] + p * p, c[1] + q * q + r * r, c[2] + p * q, F);
        membrane_at(&layer, F, field, &other);
        if (other.W < least) {
          least = other.W;
          memcpy(found, (const double[]){p, q, r}, sizeof found);
        }
      }
      memcpy(from, found, sizeof from);
    }
    assert_true(at.W <= least + 1e-9 * fabs(least));
    assert_close(at.W, least, 0, 1); // 1e6 Pa times the square of the last width
    assert_close(at.own[2], c[2] + found[0] * found[1], 0, 2e-3);
  }
  assert_true(seen[DEA_WRINKLED] && seen[DEA_SLACK]);
}

TESTS(NULL, NULL)
