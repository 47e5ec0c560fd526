/* Model 3d against the exact disc and against itself: permittivity that depends on stretch,
 * electrode layers, profile, capacitance; and what fibres of all kinds do. */
// ctest: solid
#include "design_text.h"
#include "devices.h"
#include "model/model.h"
#include "model/solid/assembly/solid.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <math.h>

extern const struct dea_model_type dea_solid_module;
static const struct dea_model_type *const solid = &dea_solid_module;

static const struct dea_model_settings solid_film = {.film = DEA_FILM_SOLID},
                                       membrane = {.film = DEA_FILM_MEMBRANE};
static const struct dea_model_settings *const films[] = {&solid_film, &membrane};

static struct dea_device plain(void)
{
  return test_disc(test_yeoh(), 1.5, 3.75e-3, 0.25, 0);
}

static struct dea_load_point solve(const struct dea_model_type *type,
                                   const struct dea_device *device,
                                   const struct dea_model_settings *settings, double voltage_V)
{
  struct dea_model *model;
  struct dea_load_point point;
  assert_ok(type->create(ctx, device, settings, &model));
  assert_ok(type->solve(ctx, model, voltage_V, &point));
  type->destroy(ctx, model);
  assert_int_equal(point.unstable_modes, 0);
  return point;
}

/* ---- against the exact disc ---- */

/* The strain of the electrode, which a solid's thickness and the mesh change by half a per cent;
 * what is tested changes it by much more. */
static void check_exact(const struct dea_device *device, const struct dea_model_settings *settings,
                        double least_change)
{
  double tolerance = settings->film == DEA_FILM_MEMBRANE ? 2e-4 : 6e-3;
  struct dea_device usual = plain();
  const struct dea_model_type *exact = dea_model_find("axisymmetric");
  double was = solve(exact, &usual, NULL, 3e3).electrode_stretch - 1;
  struct dea_load_point wanted = solve(exact, device, NULL, 3e3),
                        point = solve(solid, device, settings, 3e3);
  assert_true(fabs((wanted.electrode_stretch - 1) / was - 1) > least_change);
  assert_close(point.electrode_stretch - 1, wanted.electrode_stretch - 1, tolerance, 0);
  assert_close(point.capacitance_F, wanted.capacitance_F, 0.3 * tolerance, 0);
  assert_close(point.energy_J, wanted.energy_J, tolerance, 0);
}

/* A film free of stress, flat below its buckling voltage: the compression of the exact disc over
 * its area, by 4 pi^2 D. */
TEST(test_compression_ratio)
{
  const double pi = acos(-1), h = 100e-6;
  struct dea_device device = test_disc(test_yeoh(), 1, 3.75e-3, 0.25, 0);
  const struct dea_model_type *exact = dea_model_find("axisymmetric");
  struct dea_model *model;
  struct dea_load_point point;
  struct dea_profile profile;
  double sum = 0, mu = 2 * device.film.param[0];
  assert_int_equal(exact->create(ctx, &device, NULL, &model), DEA_OK);
  assert_int_equal(exact->solve(ctx, model, 400, &point), DEA_OK);
  assert_int_equal(exact->profile(ctx, model, &profile), DEA_OK);
  for (size_t i = 0; i + 1 < profile.count; i++) {
    for (size_t k = i; k < i + 2; k++) {
      double T = fmin(profile.tension_r_N_per_m[k], profile.tension_t_N_per_m[k]);
      sum +=
          pi * (profile.radius_m[i + 1] - profile.radius_m[i]) * profile.radius_m[k] * fmax(-T, 0);
    }
  }
  exact->destroy(ctx, model);
  double wanted = sum / (4 * pi * pi * mu * pow(h, 3) / 3);
  point = solve(solid, &device, &solid_film, 400);
  assert_true(wanted > 0.05 && device.film_thickness_m == h);
  assert_close(point.compression_ratio, wanted, 0.03, 0);
  device = plain();
  assert_true(solve(solid, &device, &solid_film, 3e3).compression_ratio == 0);
  point = solve(solid, &device, &membrane, 1e3);
  assert_int_equal(dea_load_point_flags(&point), 1u << DEA_FLAG_PREVIEW);
}

/* The error that a run estimates against a mesh of a quarter of the size, whose own is a twentieth
 * (the exact disc has no thickness: it is as far from that as the default mesh); a finer mesh has
 * less. What raises and what lowers the edge is not set off against each other, so that more is
 * stated than found. Where the film is slack none is estimated. */
TEST(test_estimated_error)
{
  struct dea_device device = plain();
  const struct dea_model_settings finer = {.film = DEA_FILM_SOLID, .refinement = 2},
                                  finest = {.film = DEA_FILM_SOLID, .refinement = 3};
  struct dea_load_point exact = solve(solid, &device, &finest, 5e3);
  struct dea_load_point coarse = solve(solid, &device, &solid_film, 5e3);
  struct dea_load_point fine = solve(solid, &device, &finer, 5e3);
  double found_m = fabs(exact.electrode_edge_u_m - coarse.electrode_edge_u_m);
  assert_true(coarse.electrode_edge_u_error_m > 0.5 * found_m);
  assert_true(coarse.electrode_edge_u_error_m < 4 * found_m);
  assert_true(fine.electrode_edge_u_error_m < 0.9 * coarse.electrode_edge_u_error_m);
  assert_true(coarse.centre_z_error_m < 1e-9); // it stays flat
  assert_true(isnan(coarse.fibre_tip_z_error_m));
  device = test_disc(test_yeoh(), 1, 3.75e-3, 0.25, 0);
  coarse = solve(solid, &device, &solid_film, 2e3);
  assert_true((dea_load_point_flags(&coarse) & 1u << DEA_FLAG_SLACK) != 0);
  assert_true(isnan(coarse.electrode_edge_u_error_m));
}

TEST(test_permittivity_that_depends_on_stretch)
{
  for (size_t i = 0; i < 2; i++) {
    struct dea_device device = plain();
    device.film.permittivity.slope = -0.6;
    check_exact(&device, films[i], 0.1);
    device.film.permittivity.slope = 1;
    check_exact(&device, films[i], 0.1);
  }
}

/* On a membrane as the exact disc has them, their tension too. */
TEST(test_electrodes_of_a_membrane)
{
  struct dea_device device = plain();
  device.electrode = test_material("neo-hookean", 400e3, 0, 0);
  device.electrode_thickness_m = 5e-6;
  check_exact(&device, &membrane, 0.5);
  struct dea_load_point wanted = solve(dea_model_find("axisymmetric"), &device, NULL, 5e3);
  struct dea_load_point point = solve(solid, &device, &membrane, 5e3);
  assert_close(point.min_tension_N_per_m, wanted.min_tension_N_per_m, 5e-3, 0);
}

/* Electrodes pull the disc together at rest (the film takes their force over within a thickness of
 * the rim, which the exact disc knows nothing of: the difference is as the thickness), and it
 * grows from there with the voltage. */
TEST(test_electrode_layers)
{
  const struct dea_model_type *exact = dea_model_find("axisymmetric");
  double difference[2];
  for (int i = 0; i < 2; i++) {
    struct dea_device device = plain();
    double H0 = i == 0 ? 100e-6 : 50e-6, V = 30e6 * H0;
    device.film_thickness_unstretched_m = H0;
    device.film_thickness_m = H0 / 2.25;
    device.electrode = test_material("neo-hookean", 400e3, 0, 0);
    device.electrode_thickness_m = H0 / 20;
    const struct dea_model_settings settings = {.refinement = 1 + i};
    double wanted = solve(exact, &device, NULL, 0).electrode_stretch;
    double rest = solve(solid, &device, &settings, 0).electrode_stretch;
    assert_true(wanted < 0.98);
    difference[i] = rest - wanted;
    assert_close(solve(solid, &device, &settings, V).electrode_stretch - rest,
                 solve(exact, &device, NULL, V).electrode_stretch - wanted, 6e-3, 0);
  }
  assert_close(difference[0], 0, 0, 6e-4);
  assert_close(difference[1], 0.5 * difference[0], 0.1, 0);
}

/* Displacement along the ray, from the exact disc's table. */
static double exact_at(const struct dea_profile *profile, const double *column, double radius_m)
{
  size_t i = 1;
  while (i + 1 < profile->count && profile->radius_m[i] < radius_m) {
    i++;
  }
  double from = profile->radius_m[i - 1], share = (radius_m - from) / (profile->radius_m[i] - from);
  return column[i - 1] + share * (column[i] - column[i - 1]);
}

/* tolerance: of the stretches; the values of a node are those of its elements, which near the edge
 * are not what is there. */
static void check_profile(const struct dea_device *of, enum dea_solid_film film, double refinement,
                          double tolerance)
{
  const struct dea_model_type *exact = dea_model_find("axisymmetric");
  const struct dea_model_settings settings = {.film = film, .refinement = refinement};
  struct dea_device device = *of;
  struct dea_model *model, *reference;
  struct dea_load_point point;
  struct dea_profile wanted, profile;
  assert_int_equal(exact->create(ctx, &device, NULL, &reference), DEA_OK);
  assert_int_equal(exact->solve(ctx, reference, 5e3, &point), DEA_OK);
  assert_int_equal(exact->profile(ctx, reference, &wanted), DEA_OK);
  assert_int_equal(solid->create(ctx, &device, &settings, &model), DEA_OK);
  assert_int_equal(solid->solve(ctx, model, 5e3, &point), DEA_OK);
  assert_int_equal(solid->profile(ctx, model, &profile), DEA_OK);
  assert_int_equal(solid->profile(ctx, model, &profile), DEA_OK);
  assert_close(profile.radius_m[0], -15e-3, 1e-9, 0);
  assert_close(profile.radius_m[profile.count - 1], 15e-3, 1e-9, 0);
  size_t jumps = 0;
  for (size_t i = 0; i < profile.count; i++) {
    double r = fabs(profile.radius_m[i]);
    bool jump = i > 0 && profile.radius_m[i] == profile.radius_m[i - 1];
    assert_true(i == 0 || profile.radius_m[i] >= profile.radius_m[i - 1]);
    if (jump) { // from the inner part to the outer one: the film is stretched more inside
      jumps++;
      assert_true((profile.stretch_r[i] < profile.stretch_r[i - 1]) == (profile.radius_m[i] > 0));
    }
    assert_close(profile.z_m[i], 0, 0, 1e-9);
    if (fabs(r / device.electrode_radius_m - 1) > 0.15) {
      assert_close(profile.displacement_m[i], exact_at(&wanted, wanted.displacement_m, r),
                   2 * tolerance, 2e-6);
      assert_close(profile.stretch_r[i], exact_at(&wanted, wanted.stretch_r, r), tolerance, 0);
      assert_close(profile.stretch_t[i], exact_at(&wanted, wanted.stretch_t, r), tolerance, 0);
      assert_close(profile.tension_r_N_per_m[i], exact_at(&wanted, wanted.tension_r_N_per_m, r),
                   3 * tolerance, 0);
      assert_close(profile.tension_t_N_per_m[i], exact_at(&wanted, wanted.tension_t_N_per_m, r),
                   3 * tolerance, 0);
    }
  }
  assert_int_equal(jumps, 2);
  solid->destroy(ctx, model);
  exact->destroy(ctx, reference);
}

TEST(test_profile)
{
  struct dea_device device = plain();
  check_profile(&device, DEA_FILM_SOLID, 1, 6e-3);
  check_profile(&device, DEA_FILM_MEMBRANE, 2, 1e-3);
  device.electrode = test_material("neo-hookean", 400e3, 0, 0); // their tension counts
  device.electrode_thickness_m = 2e-6;
  check_profile(&device, DEA_FILM_SOLID, 1, 6e-3);
  check_profile(&device, DEA_FILM_MEMBRANE, 2, 1e-3);
}

/* ---- against itself ---- */

/* The charge is minus the derivative of the energy by the voltage. */
static void check_charge(const struct dea_model_settings *settings, double voltage_V)
{
  struct dea_device device = test_star(4);
  struct dea_model *model;
  struct dea_load_point at, up;
  device.film.permittivity.slope = -0.28;
  assert_int_equal(solid->create(ctx, &device, settings, &model), DEA_OK);
  assert_int_equal(solid->solve(ctx, model, voltage_V, &at), DEA_OK);
  assert_int_equal(solid->solve(ctx, model, 1.001 * voltage_V, &up), DEA_OK);
  double charge = 0.5 * (at.capacitance_F + 1.001 * up.capacitance_F) * voltage_V;
  assert_close(-(up.energy_J - at.energy_J) / (0.001 * voltage_V), charge, 1e-5, 0);
  solid->destroy(ctx, model);
}

TEST(test_charge)
{
  check_charge(&solid_film, 2e3);
  check_charge(&membrane, 2e3);
  check_charge(&membrane, 7.5e3); // wrinkled
}

/* ---- fibres ---- */

/* The more fibres hold the electrode, the less it grows between them; all bend down. */
TEST(test_number_of_fibres)
{
  static const int fibres[] = {1, 3, 6};
  double before = 1e3;
  for (size_t i = 0; i < sizeof fibres / sizeof fibres[0]; i++) {
    struct dea_device device = test_star(fibres[i]);
    struct dea_load_point point = solve(solid, &device, NULL, 2e3);
    assert_true(point.electrode_edge_u_m < before && point.electrode_edge_u_m > 1e-5);
    assert_true(point.fibre_tip_z_m < -0.3e-6);
    assert_true(fibres[i] == 1 || point.centre_z_m < -0.3e-6);
    before = point.electrode_edge_u_m;
  }
}

/* A fibre over the electrode holds it more, and so do stiff electrodes; one that ends before it
 * less, and so do a narrow tip, a free end and glue. A hinge lies on the side of the film, whose
 * pull then bends the fibre less. */
TEST(test_kinds_of_fibres)
{
  struct dea_device device = test_star(4);
  struct dea_load_point usual = solve(solid, &device, NULL, 2e3);
  double edge = usual.electrode_edge_u_m;

  device.fibre_tip_radius_m -= 0.75e-3;
  assert_true(solve(solid, &device, NULL, 2e3).electrode_edge_u_m < 0.95 * edge);
  device.electrode = test_material("neo-hookean", 400e3, 0, 0); // under the fibre too
  device.electrode_thickness_m = 5e-6;
  assert_true(solve(solid, &device, NULL, 2e3).electrode_edge_u_m < 0.85 * edge);

  device = test_star(4);
  device.fibre_tip_radius_m += 0.75e-3;
  assert_true(solve(solid, &device, NULL, 2e3).electrode_edge_u_m > 1.05 * edge);

  device = test_star(4);
  device.fibre_tip_width_m = 0.5e-3;
  assert_true(solve(solid, &device, NULL, 2e3).electrode_edge_u_m > 1.05 * edge);

  device = test_star(4);
  device.outer_end = DEA_END_HINGED;
  struct dea_load_point hinged = solve(solid, &device, NULL, 2e3);
  assert_true(hinged.fibre_tip_z_m > 0.9 * usual.fibre_tip_z_m && hinged.fibre_tip_z_m < 0);
  assert_close(hinged.electrode_edge_u_m, edge, 0.02, 0);

  device.outer_end = DEA_END_FREE;
  device.fibre_outer_gap_m = 1e-3;
  assert_true(solve(solid, &device, NULL, 2e3).electrode_edge_u_m > 1.05 * edge);

  device = test_star(4);
  device.bond_thickness_m = 50e-6;
  device.bond_modulus_Pa = 1e6;
  assert_true(solve(solid, &device, NULL, 2e3).electrode_edge_u_m > 1.005 * edge);
}

static int tear_down(void **state)
{
  dea_solid_stop();
  return context_tear_down(state);
}

/* The fringe of a coupled field at rest: a disc that is longer by h ln 4/(2 pi) at its edge
 * (docs/theory/coupled.md). Six elements through the film have it, one says that it does not. */
TEST(test_fringe)
{
  const double pi = acos(-1);
  struct dea_device device = plain();
  double a = device.electrode_radius_m, h = device.film_thickness_m;
  double wanted = pow(1 + h * log(4) / (2 * pi) / a, 2);
  for (int through = 1; through <= 6; through += 5) {
    const struct dea_model_settings settings = {
        .film = DEA_FILM_SOLID, .field = DEA_FIELD_COUPLED, .elements_z = through};
    dea_finding_clear(ctx);
    struct dea_load_point point = solve(solid, &device, &settings, 0);
    double excess = point.capacitance_F * h / (2.8 * DEA_EPSILON_0 * pi * a * a) - wanted;
    assert_true(through == 1 ? excess > 5e-3 : fabs(excess) < 2e-4);
    bool warned = find_finding(ctx, DEA_WARNING, "compute.solid.elements_z: 6") != NULL;
    assert_true(warned == (through == 1));
  }
}

/* Where fibres begin at the electrode's edge, a coupled field that is resolved elsewhere is not:
 * that is told, and of fibres that begin elsewhere it is not. */
TEST(test_coupled_tips)
{
  only_nightly();
  static const double overlaps[] = {0, 1e-3};
  for (int i = 0; i < 2; i++) {
    const struct dea_model_settings settings = {
        .film = DEA_FILM_SOLID, .field = DEA_FIELD_COUPLED, .elements_z = 6};
    struct dea_device device = test_star(4);
    device.fibre_tip_radius_m = device.electrode_radius_m - overlaps[i];
    struct dea_model *model;
    dea_finding_clear(ctx);
    assert_int_equal(solid->create(ctx, &device, &settings, &model), DEA_OK);
    bool told = find_finding(ctx, DEA_WARNING, "begin where the electrode ends") != NULL;
    assert_true(told == (overlaps[i] == 0));
    solid->destroy(ctx, model);
  }
}

/* Share of the film's area that maps show under fibres of a device at rest. */
static double covered(double poisson_ratio)
{
  struct dea_device device = test_star(4);
  struct dea_model *model;
  struct dea_field_mesh *mesh;
  device.fibre.poisson_ratio = poisson_ratio;
  assert_int_equal(solid->create(ctx, &device, NULL, &model), DEA_OK);
  assert_int_equal(solid->fields(ctx, model, DEA_FIELDS_SURFACE, &mesh), DEA_OK);
  const double *under = dea_field_mesh_find(mesh, "under_fibre")->values;
  double sum = 0, all = 0;
  const int order = mesh->blocks[0].order, corners = (order + 1) * (order + 1);
  for (size_t c = 0; c < mesh->cell_count; c++) { // by the corners of the cells
    const int *nodes = mesh->blocks[0].nodes + c * (size_t)corners;
    const double *a = mesh->X + 3 * nodes[0], *b = mesh->X + 3 * nodes[order];
    const double *d = mesh->X + 3 * nodes[corners - 1 - order];
    const double *e = mesh->X + 3 * nodes[corners - 1];
    double area =
        0.5 * fabs((e[0] - a[0]) * (d[1] - b[1]) - (d[0] - b[0]) * (e[1] - a[1])); // diagonals
    all += area;
    sum += under[c] * area;
  }
  dea_field_mesh_destroy(ctx, mesh);
  solid->destroy(ctx, model);
  return sum / all;
}

/* Four strips 2 mm wide from 3.75 mm to the frame at 15 mm, over pi 15^2 mm^2; whatever law their
 * Poisson's ratio asks for. */
TEST(test_film_under_fibres)
{
  double exact = 4 * 2 * 11.25 / (acos(-1) * 15 * 15);
  assert_close(covered(0.38), exact, 1e-2, 0); // arcs at both ends
  assert_close(covered(0.495), covered(0.38), 0, 0);
}

TESTS(context_set_up, tear_down)
