/* Layered hexahedra and their meshes: ways to compute them, pre-stress. */
// ctest: quick, heavy
#include "devices.h"
#include "failing_allocator.h"
#include "model/solid/mesh/grid.h"
#include "quarter_grid.h"
#include "solid_element.h"
#include "testing.h"
#include "yeoh_part.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

static struct dea_hex_shape shape;
static struct dea_element_result at, up;

/* Pre-stretched film with a field (law), or a compressible solid. */
static struct dea_part_material film(double pre_stretch)
{
  double h = 100e-6 / (pre_stretch * pre_stretch);
  return yeoh_part(pre_stretch, 2.8 * DEA_EPSILON_0, h);
}

static struct dea_part_material plastic(void)
{
  static const double param[] = {5.2e5, 0.3};
  return dea_part_material_bonded(param);
}

/* A distorted element of the shape, about 200 um wide and 44 um thick, with displacements of given
 * size relative to it. */
static void sample(double size, double *X, double *u)
{
  for (int n = 0; n < shape.nodes; n++) {
    const double *x = shape.node_at[n];
    X[3 * n] = 100e-6 * x[0] + 1e-5 * x[0] * x[1];
    X[3 * n + 1] = 100e-6 * x[1] + 1e-5 * x[0] - 5e-6 * x[1] * x[1];
    X[3 * n + 2] = 22e-6 * x[2] + 1e-6 * x[0] * x[2];
    for (int i = 0; i < 3; i++) {
      u[3 * n + i] = size * (i == 2 ? 2e-6 : 1e-5) * sin(1.3 * n + i);
    }
  }
}

static const double pressures[DEA_HEX_PRESSURES_MAX] = {1e4, -2e3, 3e3,  5e2, -1e3,
                                                        2e3, 1e3,  -4e2, 7e2, 1e2};

/* Each level gives what the next one gives, to the bits: decisions of the line search hang on it.
 */
TEST(test_levels_agree)
{
  double X[DEA_HEX_DOFS_MAX], u[DEA_HEX_DOFS_MAX];
  const struct dea_part_material layers[] = {film(1.5), plastic()};
  for (int k = 0; k < 2; k++) {
    assert_int_equal(dea_hex_shape_create(2, 2, &shape), DEA_OK);
    sample(1, X, u);
    assert_ok(evaluate_hex(&shape, &layers[k], X, u, pressures, 4e3, DEA_TANGENT, &at));
    for (int level = DEA_ENERGY; level <= DEA_FORCE; level++) {
      assert_ok(
          evaluate_hex(&shape, &layers[k], X, u, pressures, 4e3, (enum dea_eval_order)level, &up));
      assert_true(up.energy_J == at.energy_J && up.volume_m3 == at.volume_m3);
      for (int i = 0; i < 3 * shape.nodes && level >= DEA_FORCE; i++) {
        assert_close(up.g[i], at.g[i], 1e-13, 1e-13 * fabs(at.g[0]));
      }
    }
  }
}

/* Held flat, a pre-stretched film pulls in its plane with the stress of benchmark 1 and not through
 * its thickness; a field of V takes eps E^2 of it. */
TEST(test_flat_film_has_the_true_pre_stress)
{
  static const double rest[DEA_HEX_DOFS_MAX] = {0}, none[DEA_HEX_PRESSURES_MAX] = {0};
  double X[DEA_HEX_DOFS_MAX];
  const struct dea_part_material soft = film(1.5);
  const double a = 100e-6, h = 22e-6, voltages[] = {0, 5e3};
  assert_int_equal(dea_hex_shape_create(2, 2, &shape), DEA_OK);
  for (int n = 0; n < shape.nodes; n++) {
    for (int i = 0; i < 3; i++) {
      X[3 * n + i] = (i == 2 ? h : a) * shape.node_at[n][i];
    }
  }
  for (int k = 0; k < 2; k++) {
    double pull[3] = {0, 0, 0}, field = voltages[k] / soft.thickness_m;
    assert_ok(evaluate_hex(&shape, &soft, X, rest, none, voltages[k], DEA_TANGENT, &at));
    for (int n = 0; n < shape.nodes; n++) {
      for (int i = 0; i < 3; i++) {
        pull[i] += shape.node_at[n][i] > 0.5 ? at.g[3 * n + i] : 0;
      }
    }
    double stress = 797.745e3 - soft.permittivity_F_per_m * field * field;
    assert_close(pull[0] / (2 * a * 2 * h), stress, 2e-6, 0);
    assert_close(pull[1] / (2 * a * 2 * h), stress, 2e-6, 0);
    assert_close(pull[2] / (4 * a * a), 0, 0, 1e-6 * stress);
  }
}

/* ---- meshes ---- */

static void make_grid(struct dea_context *failing)
{
  const struct dea_quarter quarter = {2, 2,    2e-3, 9e-3,      1e-4,
                                      8, 1e-3, 1e-4, .fine = 1, .across = 1};
  struct dea_grid *grid = NULL;
  failing_check(failing, dea_grid_quarter(failing, &quarter, &grid));
  dea_grid_destroy(failing, grid);
}

TEST(test_each_allocation_of_a_mesh)
{
  assert_true(failing_each(make_grid) > 5);
}

TESTS(context_set_up, context_tear_down)
