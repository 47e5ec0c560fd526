/* Hexahedra with a potential: the plate capacitor, the thin-film energy. */
#include "solid_element.h"
#include "testing.h"
#include "yeoh_part.h"

static struct dea_hex_shape shape;
static struct dea_element_result at, up;

static const double scale = 2e8; // V/m
static const double pressures[DEA_HEX_PRESSURES_MAX] = {1e4, -2e3, 3e3,  5e2, -1e3,
                                                        2e3, 1e3,  -4e2, 7e2, 1e2};

struct sample {
  double X[DEA_HEX_DOFS_MAX], u[DEA_HEX_DOFS_MAX], psi[DEA_HEX_NODES_MAX];
};

static struct dea_part_material film(double pre_stretch)
{
  return yeoh_part(pre_stretch, 2.5e-11, 44e-6);
}

/* A distorted element, about 200 um wide and 44 um thick, with displacements and potentials
 * (thousands of volts). */
static struct sample distorted(void)
{
  struct sample s;
  for (int n = 0; n < shape.nodes; n++) {
    const double *x = shape.node_at[n];
    s.X[3 * n] = 100e-6 * x[0] + 1e-5 * x[0] * x[1];
    s.X[3 * n + 1] = 100e-6 * x[1] + 1e-5 * x[0] - 5e-6 * x[1] * x[1];
    s.X[3 * n + 2] = 22e-6 * x[2] + 1e-6 * x[0] * x[2];
    for (int i = 0; i < 3; i++) {
      s.u[3 * n + i] = (i == 2 ? 2e-6 : 1e-5) * sin(1.3 * n + i);
    }
    s.psi[n] = 2e3 / scale * (x[2] + 0.3 * sin(1.7 * n));
  }
  return s;
}

static dea_status evaluate(const struct dea_part_material *layer, const struct sample *s,
                           enum dea_eval_order level, struct dea_element_result *out)
{
  const struct dea_element element = potential_hexahedron(&shape);
  const struct dea_element_input in = {.part_material = layer,
                                       .X = s->X,
                                       .u = s->u,
                                       .multiplier = pressures,
                                       .potential = s->psi,
                                       .potential_V_per_m = scale};
  return element.type->evaluate(&element, &in, level, out);
}

static double largest(const double *values, int count)
{
  double most = 0;
  for (int i = 0; i < count; i++) {
    most = fmax(most, fabs(values[i]));
  }
  return most;
}

/* A potential that is linear in the reference thickness is the thin film's field, whatever the
 * displacements: energy, forces and tangent by u are those of dea_hex_evaluate. */
TEST(test_linear_potential_is_the_thin_film)
{
  const struct dea_part_material soft = film(1.5);
  const double V = 4e3;
  assert_int_equal(dea_hex_shape_create(2, 2, &shape), DEA_OK);
  struct sample s = distorted();
  int n = shape.nodes;
  for (int a = 0; a < n; a++) {
    s.psi[a] = V / scale * s.X[3 * a + 2] / soft.thickness_m;
  }
  assert_int_equal(evaluate(&soft, &s, DEA_TANGENT, &at), DEA_OK);
  assert_int_equal(evaluate_hex(&shape, &soft, s.X, s.u, pressures, V, DEA_TANGENT, &up), DEA_OK);
  double most_g = largest(up.g, 3 * n), most_K = largest(up.K, 9 * n * n);
  assert_close(at.energy_J, up.energy_J, 1e-12, 0);
  for (int i = 0; i < 3 * n; i++) {
    int row = 4 * (i / 3) + i % 3;
    assert_close(at.g[row], up.g[i], 0, 1e-12 * most_g);
    for (int j = 0; j < 3 * n; j++) {
      assert_close(at.K[row * 4 * n + 4 * (j / 3) + j % 3], up.K[i * 3 * n + j], 0, 1e-12 * most_K);
    }
  }
}

/* Plate capacitor of a stretched, sheared block: charge eps (V/h) |F_1 x F_2|^2 a face, the
 * opposite on the other and none inside. */
TEST(test_plate_capacitor)
{
  static const double D[9] = {1.2, 0.1, 0.2, -0.1, 0.95, 0.1, 0.3, 0, 0.9};
  const struct dea_part_material soft = film(1.5);
  const double a = 100e-6, h = 44e-6, V = 3e3;
  for (int order = 1; order <= DEA_HEX_ORDER_MAX; order++) {
    struct sample s;
    double top = 0, bottom = 0, inside = 0, cof[9];
    assert_int_equal(dea_hex_shape_create(order, order, &shape), DEA_OK);
    for (int n = 0; n < shape.nodes; n++) {
      for (int i = 0; i < 3; i++) {
        s.X[3 * n + i] = (i == 2 ? 0.5 * h : a) * shape.node_at[n][i];
      }
      for (int i = 0; i < 3; i++) {
        const double *X = s.X + 3 * n;
        s.u[3 * n + i] = D[3 * i] * X[0] + D[3 * i + 1] * X[1] + D[3 * i + 2] * X[2] - X[i];
      }
      s.psi[n] = 0.5 * V / scale * (1 + shape.node_at[n][2]);
    }
    assert_int_equal(evaluate(&soft, &s, DEA_FORCE, &at), DEA_OK);
    for (int n = 0; n < shape.nodes; n++) {
      double charge = -at.g[4 * n + 3] / scale, z = shape.node_at[n][2];
      *(z > 0.99 ? &top : z < -0.99 ? &bottom : &inside) += charge;
    }
    dea_cofactors(D, cof);
    double area = cof[2] * cof[2] + cof[5] * cof[5] + cof[8] * cof[8];
    double charge = soft.permittivity_F_per_m * V / h * 4 * a * a * area;
    assert_close(top, charge, 1e-10, 0);
    assert_close(bottom, -charge, 1e-10, 0);
    assert_close(inside, 0, 0, 1e-10 * charge);
  }
}

TESTS(NULL, NULL)
