/* Mass of elements: total, centre and moments of bodies whose integrals are known. */
#include "grid_moments.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

/* A parallelogram on unequal elements: x = 3 s + 0.5 t, y = 2 t - 0.4 s. */
static void map_block(const void *self, double s, double t, double x[2])
{
  x[0] = 3 * s + 0.5 * t;
  x[1] = 2 * t - 0.4 * s;
}

static int first(const void *self, int region, int ply)
{
  return 0;
}

/* Integrals of products of (a s + b t) and (c s + d t) over the unit square. */
static double product(double a, double b, double c, double d)
{
  return (a * c + b * d) / 3 + (a * d + b * c) / 4;
}

TEST(test_mass_of_a_block)
{
  static const double cuts[] = {0, 0.35, 1};
  const double rho = 970, h = 0.7, z0 = 0.2, area = 3 * 2 + 0.5 * 0.4;
  const struct dea_part_material layer = {.density_kg_per_m3 = rho, .thickness_m = h};
  const struct dea_block block = {map_block, NULL, cuts, cuts, 2, 2, 0};
  for (int order = 1; order <= 3; order++) {
    for (int kind = 0; kind < 4; kind++) { // a surface, then solids of each order
      const struct dea_ply ply = {kind == 0 ? 0 : h, kind == 0 ? 1 : 2, kind == 0 ? 1 : kind};
      struct dea_grid *grid;
      double sum[MOMENTS] = {0};
      assert_int_equal(dea_hex_shape_create(order, ply.order_z, &shape), DEA_OK);
      assert_int_equal(dea_flat_shape_create(order, &flat), DEA_OK);
      assert_int_equal(dea_grid_create(ctx, order, &block, 1, &ply, 1, NULL, z0, 3, &grid), DEA_OK);
      grid_moments(grid, &layer, first, NULL, sum);
      double m = rho * h * area, top = kind == 0 ? z0 : z0 + h;
      double zz = kind == 0 ? z0 * z0 : (top * top * top - z0 * z0 * z0) / (3 * h);
      const double exact[MOMENTS] = {
          m,      m * product(3, 0.5, 3, 0.5), m * product(-0.4, 2, -0.4, 2),
          m * zz, m * 0.5 * (3 + 0.5),         m * product(3, 0.5, -0.4, 2)};
      for (int i = 0; i < MOMENTS; i++) {
        assert_close(sum[i], exact[i], 0, 1e-12 * m);
      }
      dea_grid_destroy(ctx, grid);
    }
  }
}

TEST(test_an_inverted_element_has_no_mass)
{
  double X[DEA_HEX_DOFS_MAX], mass[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX];
  const struct dea_part_material layer = {.density_kg_per_m3 = 1, .thickness_m = 1};
  assert_int_equal(dea_hex_shape_create(1, 1, &shape), DEA_OK);
  assert_int_equal(dea_flat_shape_create(1, &flat), DEA_OK);
  for (int n = 0; n < shape.nodes; n++) {
    for (int i = 0; i < 3; i++) {
      X[3 * n + i] = (i == 0 ? -1 : 1) * shape.node_at[n][i];
    }
  }
  const struct dea_element solid = hexahedron(&shape), surface = membrane(&flat);
  assert_int_equal(solid.type->mass(&solid, &layer, X, mass), DEA_E_DOMAIN);
  assert_int_equal(surface.type->mass(&surface, &layer, X, mass), DEA_E_DOMAIN);
}

TESTS(context_set_up, context_tear_down)
