/* Stresses at the end of a linear step, and the barrier before inversion. */
#include "devices.h"
#include "solid_element.h"
#include "testing.h"
#include "yeoh_part.h"

static struct dea_hex_shape shape;
static struct dea_element_result plain, other;
static double X[DEA_HEX_DOFS_MAX], u[DEA_HEX_DOFS_MAX], way[DEA_HEX_DOFS_MAX];
static double predicted[DEA_HEX_PRESSURES_MAX + 6 * DEA_HEX_GAUSS_MAX];
static const double pressures[DEA_HEX_PRESSURES_MAX] = {1e4, -2e3, 3e3, 5e2};

static struct dea_part_material film(void)
{
  return yeoh_part(1.5, 2.8 * DEA_EPSILON_0, 44e-6);
}

static struct dea_part_material plastic(void)
{
  static const double param[] = {5.2e5, 0.3};
  return dea_part_material_bonded(param);
}

static void sample(void)
{
  assert_int_equal(dea_hex_shape_create(2, 2, &shape), DEA_OK);
  for (int n = 0; n < shape.nodes; n++) {
    const double *x = shape.node_at[n];
    X[3 * n] = 100e-6 * x[0] + 1e-5 * x[0] * x[1];
    X[3 * n + 1] = 100e-6 * x[1] + 1e-5 * x[0];
    X[3 * n + 2] = 22e-6 * x[2] + 1e-6 * x[0] * x[2];
    for (int i = 0; i < 3; i++) {
      u[3 * n + i] = (i == 2 ? 2e-6 : 1e-5) * sin(1.3 * n + i);
      way[3 * n + i] = (i == 2 ? 1e-6 : 5e-6) * cos(0.7 * n + 2 * i);
    }
  }
}

static double distance(int dofs)
{
  double largest = 0, apart = 0;
  for (int i = 0; i < dofs * dofs; i++) {
    largest = fmax(largest, fabs(plain.K[i]));
    apart = fmax(apart, fabs(plain.K[i] - other.K[i]));
  }
  return apart / largest;
}

/* Apart from the plain tangent at u + share way. */
static double apart_at(const struct dea_part_material *layer, double share)
{
  double end[DEA_HEX_DOFS_MAX];
  const struct dea_element element = hexahedron(&shape);
  struct dea_element_input in = {
      .part_material = layer, .X = X, .u = u, .multiplier = pressures, .voltage_V = 4e3};
  assert_int_equal(element.type->predict(&element, &in, way, share, true, predicted), DEA_OK);
  for (int i = 0; i < 3 * shape.nodes; i++) {
    end[i] = u[i] + share * way[i];
  }
  assert_int_equal(evaluate_hex(&shape, layer, X, end, pressures, 4e3, DEA_TANGENT, &plain),
                   DEA_OK);
  in.u = end;
  in.predicted = predicted;
  assert_int_equal(element.type->evaluate(&element, &in, DEA_TANGENT, &other), DEA_OK);
  for (int i = 0; i < 3 * shape.nodes; i++) {
    assert_true(plain.g[i] == other.g[i]);
    for (int j = 0; j < i; j++) {
      int dofs = 3 * shape.nodes;
      assert_close(other.K[i * dofs + j], other.K[j * dofs + i], 0, 1e-9 * fabs(other.K[0]));
    }
  }
  assert_true(plain.energy_J == other.energy_J);
  return distance(3 * shape.nodes);
}

/* Without a step the tangent is the plain one; with one it differs by the square of the step, for
 * the stresses are linear in it. */
TEST(test_stresses_of_a_step)
{
  const struct dea_part_material layers[] = {film(), plastic()};
  sample();
  for (int k = 0; k < 2; k++) {
    assert_close(apart_at(&layers[k], 0), 0, 0, 1e-12);
    double at = apart_at(&layers[k], 1e-2), half = apart_at(&layers[k], 5e-3);
    assert_true(at > 1e-9);
    assert_close(at / half, 4, 5e-2, 0);
  }
}

/* (kappa_s/2) (J - 1)^2 near 1; without bound before J = 0. */
TEST(test_barrier)
{
  const struct dea_part_material layer = film();
  double slope, curvature, ahead, behind, ignored;
  assert_close(dea_part_material_pointwise(&layer, 1, &slope, &curvature), 0, 0, 1e-12);
  assert_close(slope, 0, 0, 1e-9);
  assert_close(curvature, layer.kappa_s_Pa, 1e-14, 0);
  double far = dea_part_material_pointwise(&layer, 0.3, &slope, &curvature), d = 1e-6;
  double up = dea_part_material_pointwise(&layer, 0.3 + d, &ahead, &ignored);
  double down = dea_part_material_pointwise(&layer, 0.3 - d, &behind, &ignored);
  assert_close(slope, (up - down) / (2 * d), 1e-8, 0);
  assert_close(curvature, (ahead - behind) / (2 * d), 1e-8, 0);
  assert_true(dea_part_material_pointwise(&layer, 1e-12, &slope, &curvature) > 10 * far);
}

TESTS(NULL, NULL)
