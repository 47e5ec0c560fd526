/* Mass of elements: total, centre and moments of bodies whose integrals are known. */
#include "devices.h"
#include "model/solid/actuator/actuator.h"
#include "solid_element.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <stdlib.h>

enum { MOMENTS = 6 };

static const double pi = 3.14159265358979323846;
static struct dea_hex_shape shape;
static struct dea_flat_shape flat;

/* What v . M v adds up to for v = 1, x, y, z, and for the products 1 x and x y. */
static void add_moments(int nodes, const double *X, const double *mass, double sum[MOMENTS])
{
  for (int a = 0; a < nodes; a++) {
    for (int b = 0; b < nodes; b++) {
      const double *x = X + 3 * a, *y = X + 3 * b;
      const double at[MOMENTS] = {1, x[0] * y[0], x[1] * y[1], x[2] * y[2], x[0], x[0] * y[1]};
      for (int i = 0; i < MOMENTS; i++) {
        sum[i] += mass[a * nodes + b] * at[i];
      }
    }
  }
}

/* Those of all elements of a grid. */
static void grid_moments(const struct dea_grid *grid, const struct dea_constituent *layers,
                         int (*layer_of)(const void *self, int region, int ply), const void *self,
                         double sum[MOMENTS])
{
  for (size_t e = 0; e < grid->element_count; e++) {
    double X[DEA_HEX_DOFS_MAX], mass[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX];
    const struct dea_constituent *layer = &layers[layer_of(self, grid->region[e], grid->ply[e])];
    int nodes = dea_grid_nodes_of(grid, e);
    for (int n = 0; n < nodes; n++) {
      memcpy(X + 3 * n, grid->X + 3 * grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n],
             3 * sizeof *X);
    }
    const struct dea_element element = grid->levels[e] == 1 ? membrane(&flat) : hexahedron(&shape);
    assert_int_equal(element.type->mass(&element, layer, X, mass), DEA_OK);
    add_moments(nodes, X, mass, sum);
  }
}

/* A parallelogram on unequal elements: x = 3 s + 0.5 t, y = 2 t - 0.4 s. */
static void map_block(const void *self, double s, double t, double x[2])
{
  (void)self;
  x[0] = 3 * s + 0.5 * t;
  x[1] = 2 * t - 0.4 * s;
}

static int first(const void *self, int region, int ply)
{
  (void)self;
  (void)region;
  (void)ply;
  return 0;
}

/* Integrals of products of (a s + b t) and (c s + d t) over the unit square. */
static double product(double a, double b, double c, double d)
{
  return (a * c + b * d) / 3 + (a * d + b * c) / 4;
}

static void test_mass_of_a_block(void **state)
{
  (void)state;
  static const double cuts[] = {0, 0.35, 1};
  const double rho = 970, h = 0.7, z0 = 0.2, area = 3 * 2 + 0.5 * 0.4;
  const struct dea_constituent layer = {.density_kg_per_m3 = rho, .thickness_m = h};
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

static void test_an_inverted_element_has_no_mass(void **state)
{
  (void)state;
  double X[DEA_HEX_DOFS_MAX], mass[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX];
  const struct dea_constituent layer = {.density_kg_per_m3 = 1, .thickness_m = 1};
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

static const double rho_film = 970, rho_pet = 1375, rho_electrode = 1900;

static struct dea_device star(bool electrodes)
{
  struct dea_device d = test_star(4);
  d.film.density_kg_per_m3 = rho_film;
  d.fibre.density_kg_per_m3 = rho_pet;
  if (electrodes) {
    d.electrode = test_yeoh();
    d.electrode.density_kg_per_m3 = rho_electrode;
    d.electrode_thickness_m = 10e-6;
  }
  return d;
}

/* int dA and int r^2 dA of a strip of half width w along a radius, inside the circle r. */
static double strip(double w, double r)
{
  return w * sqrt(r * r - w * w) + r * r * asin(w / r);
}

static double strip_about_axis(double w, double r)
{
  // int (r^2 - y^2)^(3/2)/3 + y^2 (r^2 - y^2)^(1/2) dy from -w to w by Simpson
  enum { STEPS = 1000 };
  double sum = 0;
  for (int i = 0; i <= STEPS; i++) {
    double y = w * (2. * i / STEPS - 1), x = sqrt(r * r - y * y);
    sum += (i == 0 || i == STEPS ? 1 : i % 2 == 1 ? 4 : 2) * (x * x * x / 3 + y * y * x);
  }
  return sum * 2 * w / STEPS / 3;
}

/* A star of film, fibres and electrodes as a solid and with a membrane: mass and moment of inertia
 * about the axis against the sums over its parts. */
static void test_mass_of_an_actuator(void **state)
{
  (void)state;
  for (int kind = 0; kind < 4; kind++) {
    struct dea_device d = star(kind / 2);
    const struct dea_model_settings settings = {
        .film = kind % 2 == 1 ? DEA_FILM_MEMBRANE : DEA_FILM_SOLID,
        .refinement = 2, // arcs are parabolas: 2e-5 of the area at 1, a sixteenth of it at 2
    };
    struct dea_actuator actuator;
    struct dea_grid *grid;
    double sum[MOMENTS] = {0};
    assert_int_equal(dea_actuator_create(ctx, &d, &settings, &actuator), DEA_OK);
    assert_int_equal(dea_actuator_check_mass(ctx, &actuator), DEA_OK);
    assert_int_equal(dea_fibre_disc_create(ctx, &actuator.plate, &grid), DEA_OK);
    assert_int_equal(dea_hex_shape_create(grid->order, actuator.plate.order_z, &shape), DEA_OK);
    assert_int_equal(dea_flat_shape_create(grid->order, &flat), DEA_OK);
    grid_moments(grid, actuator.constituents, dea_actuator_constituent, &actuator, sum);
    double copies = dea_actuator_copies(&actuator), R = d.frame_radius_m, a = d.electrode_radius_m;
    double t = d.electrode_thickness_m / (d.pre_stretch * d.pre_stretch);
    double film = rho_film * d.film_thickness_m * pi, electrodes = 2 * rho_electrode * t * pi;
    double fibres = 4 * rho_pet * d.fibre_thickness_m, w = 0.5 * d.fibre_width_m;
    assert_close(copies * sum[0],
                 film * R * R + electrodes * a * a + fibres * (strip(w, R) - strip(w, a)), 3e-6, 0);
    assert_close(copies * (sum[1] + sum[2]),
                 0.5 * film * R * R * R * R + 0.5 * electrodes * a * a * a * a +
                     fibres * (strip_about_axis(w, R) - strip_about_axis(w, a)),
                 3e-6, 0);
    dea_grid_destroy(ctx, grid);
  }
}

static void test_unknown_densities_are_said(void **state)
{
  (void)state;
  struct dea_actuator actuator;
  struct dea_device d = star(true);
  const struct dea_model_settings settings = {.refinement = 2};
  d.electrode.density_kg_per_m3 = 0;
  assert_int_equal(dea_actuator_create(ctx, &d, &settings, &actuator), DEA_OK);
  assert_close(actuator.constituents[DEA_CONSTITUENT_ELECTRODE].density_kg_per_m3, rho_film, 0, 0);
  size_t before = dea_finding_count(ctx, DEA_NOTE);
  assert_int_equal(dea_actuator_check_mass(ctx, &actuator), DEA_OK);
  assert_int_equal(dea_finding_count(ctx, DEA_NOTE), before + 1);
  d.fibre.density_kg_per_m3 = 0;
  assert_int_equal(dea_actuator_create(ctx, &d, &settings, &actuator), DEA_OK);
  assert_int_equal(dea_actuator_check_mass(ctx, &actuator), DEA_E_DESIGN);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_mass_of_a_block),
      cmocka_unit_test(test_an_inverted_element_has_no_mass),
      cmocka_unit_test(test_mass_of_an_actuator),
      cmocka_unit_test(test_unknown_densities_are_said),
  };
  return cmocka_run_group_tests(tests, context_set_up, context_tear_down);
}
