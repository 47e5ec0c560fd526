/* Gas that moves with discs in a rigid wall, against closed forms. */
// ctest: solid
#include "model/solid/model3d/air_mass.h"
#include "result/field_mesh.h"

#include "fake_surface.h"
#include "layout_device.h" // after: its context shadows no name of the headers above

enum { SHAPES = 3 };

/* Of a flat disc of radius 1, upwards: 1, (1 - r^2)^2, 1 - r^2; masses over density and
 * radius^3. */
static void find_masses(const struct dea_field_mesh *surface, int fold, size_t cells,
                        double out[SHAPES * SHAPES])
{
  const struct dea_layout_sector sector = {.fold = fold};
  const double cube_m3 = pow(fake_radius_m, 3);
  double *shapes = dea_alloc(ctx, SHAPES * 3 * surface->point_count, sizeof *shapes);
  assert_non_null(shapes);
  for (size_t p = 0; p < surface->point_count; p++) {
    const double *X = surface->X + 3 * p, bump = 1 - pow(hypot(X[0], X[1]) / fake_radius_m, 2);
    double *u = dea_field_mesh_find(surface, "displacement_m")->values + 3 * p;
    u[0] = u[1] = u[2] = 0;
    for (size_t k = 0; k < SHAPES; k++) {
      shapes[3 * (k * surface->point_count + p) + 2] = pow(bump, (double)(k == 0 ? 0 : 3 - k));
    }
  }
  assert_int_equal(dea_air_mass(ctx, surface, &sector, cells, shapes, SHAPES, out), DEA_OK);
  dea_free(ctx, shapes);
  for (size_t i = 0; i < SHAPES * SHAPES; i++) {
    out[i] *= (double)dea_layout_sector_copies(&sector) / cube_m3;
  }
}

/* With H(k), the integral of w J_0(kr) r, the gas on one side is 2 pi int H_i H_j dk: H = 2^n n!
 * J_{n+1}(k)/k^{n+1} of (1 - r^2)^n, and by Weber and Schafheitlin int J_m^2 k^-l dk = G(l) G(m +
 * (1
 * - l)/2)/(2^l G((1 + l)/2)^2 G(m + (1 + l)/2)). Of a piston that is 8/3; of (1 - r^2)^2, the shape
 * that Lamb (1920) gives a clamped plate, 0.6689 of pi/5. */
static double closed_form(int n)
{
  const double l = 2 * n + 2, m = n + 1, factor = pow(2, n) * tgamma(n + 1);
  return 2 * 2 * acos(-1) * factor * factor * tgamma(l) * tgamma(m + (1 - l) / 2) /
         (pow(2, l) * pow(tgamma((1 + l) / 2), 2) * tgamma(m + (1 + l) / 2));
}

TEST(test_disc)
{
  static const int power[SHAPES] = {0, 2, 1};
  static const size_t cells[] = {800, 3200, 12800};
  struct dea_field_mesh *surface = fake_surface(ctx, 0), *whole;
  double mass[SHAPES * SHAPES], of_whole[SHAPES * SHAPES], before = INFINITY;
  assert_close(closed_form(0), 16. / 3, 1e-12, 0);
  assert_close(closed_form(2), 2 * 0.6689 * acos(-1) / 5, 1e-4, 0);
  for (int i = 0; i < 3; i++) {
    double worst = 0;
    find_masses(surface, FAKE_FOLD, cells[i], mass);
    for (int k = 0; k < SHAPES; k++) {
      const double off = mass[k * (SHAPES + 1)] / closed_form(power[k]) - 1;
      print_message("%zu cells, (1 - r^2)^%d: off by %.1e\n", cells[i], power[k], off);
      worst = fmax(worst, fabs(off));
    }
    assert_true(worst < 0.5 * before);
    before = worst;
  }
  assert_true(before < 1e-4);
  assert_int_equal(dea_field_mesh_whole(ctx, surface, &whole), DEA_OK);
  find_masses(whole, 0, cells[2], of_whole);
  for (int i = 0; i < SHAPES * SHAPES; i++) {
    assert_close(of_whole[i], mass[i], 1e-9, 0);
    assert_close(mass[i], mass[i % SHAPES * SHAPES + i / SHAPES], 1e-12, 0);
  }
  dea_field_mesh_destroy(ctx, whole);
  dea_field_mesh_destroy(ctx, surface);
}

/* A membrane in gas of half its mass per area and radius: in the space of J_0(z_n r), the axially
 * symmetric modes in vacuo, with H_n = z_n J_1(z_n) J_0(k)/(z_n^2 - k^2) above, of two of them, as
 * are among the lowest 12 here. Of 16: 0.755805, 0.895756. */
TEST(test_membrane)
{
  static const double wanted[] = {0.755975, 0.896251};
  static const struct dea_control centre = {.kind = DEA_CONTROL_CONJUGATE,
                                            .component = DEA_OBSERVED_Z};
  struct dea_device *device = disc_new(20e-3, 10e-3, 1.2);
  const struct dea_layout_ply *film = &device->layout->plies[0];
  const double gas = 0.5 * film->material.density_kg_per_m3 * film->thickness_m / 20e-3;
  double Hz[2][DEA_COMPLIANCE_MODES];
  device->layout->monitors[0].at_m[0][0] = 0;
  for (int k = 0; k < 2; k++) {
    const struct dea_model_settings settings = {
        .film = DEA_FILM_MEMBRANE, .refinement = 1, .reduced.air_kg_per_m3 = k * gas};
    const struct dea_model_type *type = dea_model_find("3d");
    struct dea_model *model = layout_model(device, &settings);
    struct dea_load_point at;
    struct dea_compliance out;
    int found = 0;
    assert_int_equal(type->solve(ctx, model, 0, &at), DEA_OK);
    assert_int_equal(type->compliance(ctx, model, &centre, DEA_COMPLIANCE_WITH_MODES, &out),
                     DEA_OK);
    for (int i = 0; i < DEA_COMPLIANCE_MODES; i++) {
      if (out.modes[i].share > 1e-3) { // others are in the plane
        Hz[k][found++] = out.modes[i].frequency_Hz;
      }
    }
    assert_int_equal(found, 2);
    type->destroy(ctx, model);
  }
  for (int i = 0; i < 2; i++) {
    print_message("%.6g Hz, with gas %.6g Hz: %.6g\n", Hz[0][i], Hz[1][i], Hz[1][i] / Hz[0][i]);
    assert_close(Hz[1][i] / Hz[0][i], wanted[i], 2e-4, 0);
  }
  dea_device_destroy(ctx, device);
}

TESTS(context_set_up, context_tear_down)
