/* Inertia of a solid: forces of rigid motions, and weight. */
// ctest: solid
#include "design_text.h"
#include "devices.h"
#include "model/solid/actuator/disc_mesh.h"
#include "model/solid/mesh/grid.h"
#include "model/solid/model3d/plies.h"
#include "solid_block.h"
#include "solid_element.h"

#include "solid_fixture.h"

#include <stdlib.h>
#include <string.h>

/* Mass, centre and moments of what a grid is made of. */

enum { MOMENTS = 6 };

static struct dea_hex_shape shape;
static struct dea_face_shape flat;

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
static void grid_moments(const struct dea_grid *grid, const struct dea_part_material *layers,
                         int (*layer_of)(const void *self, int region, int ply), const void *self,
                         double sum[MOMENTS])
{
  for (size_t e = 0; e < grid->element_count; e++) {
    double X[DEA_HEX_DOFS_MAX], mass[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX];
    const struct dea_part_material *layer = &layers[layer_of(self, grid->region[e], grid->ply[e])];
    int nodes = dea_grid_nodes_of(grid, e);
    for (int n = 0; n < nodes; n++) {
      memcpy(X + 3 * n, grid->X + 3 * grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n],
             3 * sizeof *X);
    }
    const struct dea_element element = grid->levels[e] == 1 ? membrane(&flat) : hexahedron(&shape);
    assert_int_equal(dea_element_mass(&element, layer, X, mass), DEA_OK);
    add_moments(nodes, X, mass, sum);
  }
}

static const struct block slab = {{3, 2, 0.5}, {2, 3, 1}, 2, 2};
static const double rho = 970;

TEST(test_inertia_of_rigid_motions)
{
  struct dea_part_material layer = dea_part_material_bonded((const double[]){2, 0});
  layer.density_kg_per_m3 = rho;
  struct dea_grid *grid = block_grid(ctx, &slab);
  struct dea_solid *solid = block_solid(ctx, grid, slab.order_z, &layer, clamped);
  double *v = calloc(3 * grid->node_count, sizeof *v);
  double *inertia = calloc(3 * grid->node_count, sizeof *inertia);
  assert_true(v != NULL && inertia != NULL);
  // free fall: the inertia is the weight
  const double fall[3] = {0.3, -2, DEA_STANDARD_GRAVITY_M_PER_S2};
  for (size_t i = 0; i < 3 * grid->node_count; i++) {
    v[i] = fall[i % 3];
  }
  assert_int_equal(dea_solid_mass_apply(ctx, solid, v, inertia), DEA_OK);
  double mass = rho * 3 * 2 * 0.5, weight[3] = {0};
  for (size_t i = 0; i < 3 * grid->node_count; i++) {
    weight[i % 3] += inertia[i];
  }
  for (int i = 0; i < 3; i++) {
    assert_close(weight[i], mass * fall[i], 1e-12, 0);
  }
  // turning about the z axis with unit rate: twice the kinetic energy is the moment of inertia
  double twice = 0;
  for (size_t n = 0; n < grid->node_count; n++) {
    v[3 * n] = -grid->X[3 * n + 1];
    v[3 * n + 1] = grid->X[3 * n];
    v[3 * n + 2] = 0;
  }
  assert_int_equal(dea_solid_mass_apply(ctx, solid, v, inertia), DEA_OK);
  for (size_t i = 0; i < 3 * grid->node_count; i++) {
    twice += v[i] * inertia[i];
  }
  assert_close(twice, mass * (3 * 3 + 2 * 2) / 3., 1e-12, 0);
  free(v);
  free(inertia);
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

extern const struct dea_model_type dea_solid_module;

/* Centre of a plain disc under its weight, at a voltage. */
static double sag(const struct dea_device *device, const struct dea_model_settings *settings,
                  double voltage_V)
{
  struct dea_model *model;
  struct dea_load_point point;
  assert_ok(dea_solid_module.create(ctx, device, settings, &model));
  assert_ok(dea_solid_module.solve(ctx, model, voltage_V, &point));
  dea_solid_module.destroy(ctx, model);
  return point.centre_z_m;
}

/* A tensioned disc sags by rho g R^2/(4 sigma): small against its thickness, so that it stays as
 * tense as it was. */
TEST(test_sag_of_a_disc)
{
  for (enum dea_solid_film film = DEA_FILM_SOLID; film <= DEA_FILM_MEMBRANE; film++) {
    struct dea_device d = test_disc(test_yeoh(), 1.5, 3.75e-3, 0.25, 0);
    const struct dea_model_settings settings = {.film = film};
    d.film.density_kg_per_m3 = rho;
    d.gravity = DEA_GRAVITY_FIBRES_UP;
    const double stress = 797.745e3; // of Table 1 at 1.5, in closed form
    double exact =
        rho * DEA_STANDARD_GRAVITY_M_PER_S2 * d.frame_radius_m * d.frame_radius_m / (4 * stress);
    // a solid film bends at its frame: over sqrt(D/T), a thickness, of the radius
    double tolerance = film == DEA_FILM_SOLID ? 5e-3 : 1e-4;
    assert_close(sag(&d, &settings, 0), -exact, tolerance, 0);
    d.gravity = DEA_GRAVITY_FIBRES_DOWN;
    assert_close(sag(&d, &settings, 0), exact, tolerance, 0);
    assert_true(sag(&d, &settings, 5e3) > 1.02 * exact); // the field takes tension away
    d.film.density_kg_per_m3 = 0;
    struct dea_model *model;
    assert_int_equal(dea_solid_module.create(ctx, &d, &settings, &model), DEA_E_DESIGN);
  }
}

// Of a device -------------------------------------------------------------------------------------

static const double pi = 3.14159265358979323846;
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
TEST(test_mass_of_an_actuator)
{
  for (int kind = 0; kind < 4; kind++) {
    struct dea_device d = star(kind / 2);
    const struct dea_model_settings settings = {
        .film = kind % 2 == 1 ? DEA_FILM_MEMBRANE : DEA_FILM_SOLID,
        .refinement = 2, // arcs are parabolas: 2e-5 of the area at 1, a sixteenth of it at 2
    };
    struct dea_layout_mesh mesh;
    struct dea_plies plies;
    struct dea_arena memory = {.ctx = ctx};
    double sum[MOMENTS] = {0};
    assert_int_equal(dea_device_mesh_create(ctx, &d, &settings, &mesh), DEA_OK);
    assert_int_equal(dea_plies_create(ctx, &mesh, &memory, &plies), DEA_OK);
    assert_int_equal(dea_hex_shape_create(mesh.grid->order, mesh.plate.order_z, &shape), DEA_OK);
    dea_face_shape_create((int[]){mesh.grid->order, mesh.grid->order}, DEA_FACE_ELEMENT, &flat);
    grid_moments(mesh.grid, plies.part_materials, dea_plies_part_material, &mesh, sum);
    double copies = (double)dea_layout_sector_copies(&mesh.sector), R = d.frame_radius_m;
    double a = d.electrode_radius_m;
    double t = d.electrode_thickness_m / (d.pre_stretch * d.pre_stretch);
    double film = rho_film * d.film_thickness_m * pi, electrodes = 2 * rho_electrode * t * pi;
    double fibres = 4 * rho_pet * d.fibre_thickness_m, w = 0.5 * d.fibre_width_m;
    assert_close(copies * sum[0],
                 film * R * R + electrodes * a * a + fibres * (strip(w, R) - strip(w, a)), 3e-6, 0);
    assert_close(copies * (sum[1] + sum[2]),
                 0.5 * film * R * R * R * R + 0.5 * electrodes * a * a * a * a +
                     fibres * (strip_about_axis(w, R) - strip_about_axis(w, a)),
                 3e-6, 0);
    dea_layout_mesh_free(ctx, &mesh);
    dea_arena_free(&memory);
  }
}

static dea_status make_heavy(struct dea_device *d)
{
  const struct dea_model_settings settings = {.film = DEA_FILM_MEMBRANE};
  struct dea_model *model;
  d->gravity = DEA_GRAVITY_FIBRES_UP;
  dea_status status = dea_solid_module.create(ctx, d, &settings, &model);
  dea_solid_module.destroy(ctx, model);
  return status;
}

TEST(test_unknown_densities_are_said)
{
  static const char note[] = "the density of the electrodes is unknown";
  struct dea_device d = star(true);
  assert_int_equal(make_heavy(&d), DEA_OK);
  assert_null(find_finding(ctx, DEA_NOTE, note));
  d.electrode.density_kg_per_m3 = 0;
  assert_int_equal(make_heavy(&d), DEA_OK);
  assert_non_null(find_finding(ctx, DEA_NOTE, note));
  d.fibre.density_kg_per_m3 = 0;
  assert_int_equal(make_heavy(&d), DEA_E_DESIGN);
}

TESTS(solid_set_up, solid_tear_down)
