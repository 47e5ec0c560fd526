/* Layered hexahedra and their meshes: pre-stress, patch test, areas. */
// ctest: quick, heavy
#include "devices.h"
#include "failing_allocator.h"
#include "model/solid/mesh/grid.h"
#include "quarter_grid.h"
#include "solid_element.h"
#include "testing.h"
#include "yeoh_part.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <stdlib.h>

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

/* Forces of all elements on the nodes under u = (D - 1) X. */
static void forces(const struct dea_grid *grid, const struct dea_part_material *layer,
                   const double *D, double *g, double *volume)
{
  static const double none[DEA_HEX_PRESSURES_MAX] = {0};
  *volume = 0;
  for (size_t e = 0; e < grid->element_count; e++) {
    const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
    double X[DEA_HEX_DOFS_MAX], u[DEA_HEX_DOFS_MAX];
    for (int n = 0; n < shape.nodes; n++) {
      for (int i = 0; i < 3; i++) {
        X[3 * n + i] = grid->X[3 * nodes[n] + i];
        u[3 * n + i] = -X[3 * n + i];
      }
      for (int i = 0; i < 9; i++) {
        u[3 * n + i / 3] += D[i] * X[3 * n + i % 3];
      }
    }
    assert_int_equal(evaluate_hex(&shape, layer, X, u, none, 2e3, DEA_TANGENT, &at), DEA_OK);
    *volume += at.volume_m3;
    for (int i = 0; i < 3 * shape.nodes; i++) {
      g[3 * nodes[i / 3] + i % 3] += at.g[i];
    }
  }
}

/* Patch test: a homogeneous deformation of a distorted mesh leaves no force on the inner nodes. */
TEST(test_patch_and_area)
{
  static const double D[9] = {1.1, 0.05, 0, -0.02, 0.95, 0.03, 0.04, 0, 0.96};
  const double a = 3.75e-3, b = 15e-3, h = 44e-6;
  for (int order = 1; order <= 3; order++) {
    struct dea_grid *grid;
    const struct dea_part_material soft = film(1.5);
    double volume, largest = 0;
    assert_int_equal(dea_hex_shape_create(order, 2, &shape), DEA_OK);
    const struct dea_quarter quarter = {order, 2, a, b, h, .fine = 3, .edge = 5e-4};
    assert_int_equal(dea_grid_quarter(ctx, &quarter, &grid), DEA_OK);
    double *g = calloc(3 * grid->node_count, sizeof *g);
    assert_non_null(g);
    forces(grid, &soft, D, g, &volume);
    for (size_t i = 0; i < 3 * grid->node_count; i++) {
      largest = fmax(largest, fabs(g[i]));
    }
    size_t inner = 0;
    for (size_t n = 0; n < grid->node_count; n++) {
      const double *X = grid->X + 3 * n;
      bool edge = hypot(X[0], X[1]) > 0.98 * b || X[0] < 1e-9 || X[1] < 1e-9;
      for (int i = 0; i < 3 && !edge && fabs(X[2]) < 0.1 * h; i++, inner++) {
        assert_close(g[3 * n + (size_t)i], 0, 0, 1e-9 * largest);
      }
    }
    assert_true(inner > 20);
    double exact = 0.25 * acos(-1) * b * b * h, error = fabs(volume / exact - 1);
    assert_true(error < (order == 1 ? 2e-2 : order == 2 ? 2e-4 : 2e-6));
    free(g);
    dea_grid_destroy(ctx, grid);
  }
}

/* No two nodes in one place: neighbouring blocks share theirs, and fibres theirs with the film.
 * Every node has an element. The fibres' volume is that of their strips. */
static void check_joined(int fibres, double width)
{
  struct dea_grid *grid;
  const struct dea_quarter quarter = {2,      1,     2e-3, 9e-3,      1e-4,
                                      fibres, width, 1e-4, .fine = 3, .across = 2};
  assert_int_equal(dea_grid_quarter(ctx, &quarter, &grid), DEA_OK);
  for (size_t i = 0; i < grid->node_count; i++) {
    for (size_t j = 0; j < i; j++) {
      const double *x = grid->X + 3 * i, *y = grid->X + 3 * j;
      assert_true(fabs(x[0] - y[0]) + fabs(x[1] - y[1]) + fabs(x[2] - y[2]) > 1e-6);
    }
  }
  assert_int_equal(dea_hex_shape_create(2, 1, &shape), DEA_OK);
  static const double rest[DEA_HEX_DOFS_MAX] = {0}, none[DEA_HEX_PRESSURES_MAX] = {0};
  const struct dea_part_material hard = plastic();
  char *used = calloc(grid->node_count, 1);
  double volume = 0;
  assert_non_null(used);
  for (size_t e = 0; e < grid->element_count; e++) {
    double X[DEA_HEX_DOFS_MAX];
    for (int n = 0; n < shape.nodes; n++) {
      int node = grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n];
      used[node] = 1;
      for (int i = 0; i < 3; i++) {
        X[3 * n + i] = grid->X[3 * node + i];
      }
    }
    assert_int_equal(evaluate_hex(&shape, &hard, X, rest, none, 0, DEA_ENERGY, &at), DEA_OK);
    volume += grid->ply[e] == DEA_PLY_FIBRE ? at.volume_m3 : 0;
  }
  for (size_t n = 0; n < grid->node_count; n++) {
    assert_int_equal(used[n], 1);
  }
  free(used);
  // strip between the circles: integral of sqrt(b^2 - y^2) - sqrt(a^2 - y^2) over half the width
  double strip = 0;
  for (int i = 0; i < 1000; i++) {
    double y = 0.5 * width * (i + 0.5) / 1000;
    strip += 0.5 * width / 1000 * (sqrt(81e-6 - y * y) - sqrt(4e-6 - y * y));
  }
  assert_close(volume, fibres / 2 * 1e-4 * strip, 2e-4, 0);
  dea_grid_destroy(ctx, grid);
}

TEST(test_blocks_are_joined)
{
  check_joined(4, 2e-3);
  check_joined(8, 1.2e-3);
}

TEST(test_meshes_that_cannot_be)
{
  const struct dea_quarter good = {2, 1, 2e-3, 9e-3, 1e-4, 8, 1.2e-3, 1e-4, .fine = 3, .across = 2};
  struct dea_quarter bad[] = {good, good, good};
  struct dea_grid *grid = NULL;
  bad[0].fibre_width = 1.6e-3; // meet at the circle a
  bad[1].fibres = 5;
  bad[2].fine = 0;
  for (size_t i = 0; i < 3; i++) {
    assert_int_equal(dea_grid_quarter(ctx, &bad[i], &grid), DEA_E_ARGUMENT);
    assert_null(grid);
  }
}

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
