/* Small motions as model 3d tells of them: a plain disc against the membrane's Bessel functions,
 * the slope of the static answer, notes. */
// ctest: solid
#include "devices.h"
#include "model/model.h"
#include "model/solid/assembly/solid.h"
#include "testing.h"

#include "solid_fixture.h" // after: its context shadows no name of the headers above

#include <math.h>

extern const struct dea_model_type dea_solid_module;
static const double pi = 3.14159265358979323846;

static struct dea_model *create(const struct dea_device *device,
                                const struct dea_model_settings *settings)
{
  struct dea_model *model;
  assert_ok(dea_solid_module.create(ctx, device, settings, &model));
  return model;
}

/* Where the first shape departs most from J0(k r/R). */
static double shape_error(const struct dea_field_mesh *mesh, double k_per_m)
{
  const double *v = dea_field_mesh_find(mesh, "mode_1")->values;
  double worst = 0, sign = v[2] < 0 ? -1 : 1;
  for (size_t p = 0; p < mesh->point_count; p++) {
    double r = hypot(mesh->X[3 * p], mesh->X[3 * p + 1]);
    worst = fmax(worst, fabs(sign * v[3 * p + 2] - j0(k_per_m * r)));
  }
  return worst;
}

TEST(test_modes_of_a_disc)
{
  enum { MODES = 5 };
  // zeros of J0, and of J4 and J8: a sector of pi/4 has every fourth number of nodal diameters
  static const double zero[] = {2.404825557695773, 5.520078110286311, 7.588342434503804,
                                8.653727912911013};
  struct dea_device d = test_disc(test_yeoh(), 1.5, 3.75e-3, 0.25, 0);
  struct dea_load_point at, points[MODES];
  struct dea_field_mesh *shapes;
  const struct dea_model_settings settings = {.film = DEA_FILM_MEMBRANE};
  d.film.density_kg_per_m3 = 970;
  double c = sqrt(797.745e3 / 970), R = d.frame_radius_m; // stress of Table 1 at 1.5
  struct dea_model *model = create(&d, &settings);
  assert_int_equal(dea_solid_module.solve(ctx, model, 0, &at), DEA_OK);
  assert_ok(dea_solid_module.modes(ctx, model, &at, MODES, points, &shapes));
  int found = 0;
  for (int k = 0; k < MODES && found < 4; k++) {
    assert_close(points[k].mode, k + 1, 0, 0);
    if (points[k].mode_out_of_plane > 0.5) {
      assert_close(points[k].frequency_Hz, zero[found] * c / (2 * pi * R), 2e-3, 0);
      assert_close(points[k].mode_out_of_plane, 1, 1e-6, 0);
      found++;
    }
  }
  assert_true(found >= 3);
  assert_close(fabs(points[0].mode_centre), 1, 1e-3, 0);
  assert_close(shape_error(shapes, zero[0] / R), 0, 0, 1e-3);
  assert_int_equal(shapes->fold, 4);
  dea_field_mesh_destroy(ctx, shapes);
  dea_solid_module.destroy(ctx, model);
}

/* Four fibres, as built. */
TEST(test_answer_to_a_slow_ripple)
{
  struct dea_device d = test_star(4);
  struct dea_load_point at, less, more, points[2];
  const struct dea_ac_excitation excitation = {.amplitude_V = 50, .damping_ratio = 0.02};
  const double frequency_Hz[] = {0.01, 300};
  d.film.density_kg_per_m3 = 970;
  d.fibre.density_kg_per_m3 = 1375;
  struct dea_model *model = create(&d, NULL);
  assert_int_equal(dea_solid_module.solve(ctx, model, 3980, &less), DEA_OK);
  assert_int_equal(dea_solid_module.solve(ctx, model, 4020, &more), DEA_OK);
  assert_int_equal(dea_solid_module.solve(ctx, model, 4000, &at), DEA_OK);
  assert_ok(dea_solid_module.respond(ctx, model, &at, &excitation, frequency_Hz, 2, points));
  double centre = 50 * (more.centre_z_m - less.centre_z_m) / 40;
  double tip = 50 * (more.fibre_tip_z_m - less.fibre_tip_z_m) / 40;
  assert_true(centre < 0 && tip < 0); // away from the fibres
  assert_close(points[0].centre_amplitude_m * cos(points[0].centre_phase_rad), centre, 1e-3, 0);
  assert_close(points[0].fibre_tip_amplitude_m * cos(points[0].fibre_tip_phase_rad), tip, 1e-3, 0);
  double edge = 50 * (more.electrode_edge_u_m - less.electrode_edge_u_m) / 40;
  assert_close(points[0].electrode_edge_amplitude_m * cos(points[0].electrode_edge_phase_rad), edge,
               1e-3, 0);
  assert_true(points[1].centre_amplitude_m > 1.1 * points[0].centre_amplitude_m);
  dea_solid_module.destroy(ctx, model);
}

TESTS(solid_set_up, solid_tear_down)
