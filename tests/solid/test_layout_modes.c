/* Vibrations of devices of any layout against closed forms. */
// ctest: solid
#include "material/plane.h"
#include "model/model.h"

#include "layout_device.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

static struct dea_model *model_of(const struct dea_device *device)
{
  const struct dea_model_settings settings = {.film = DEA_FILM_MEMBRANE, .refinement = 1.5};
  struct dea_model *model;
  assert_int_equal(dea_model_find("3d")->create(ctx, device, &settings, &model), DEA_OK);
  return model;
}

/* The lowest modes at a voltage. */
static void find_modes(struct dea_model *model, double voltage_V, size_t count,
                       struct dea_load_point *out)
{
  const struct dea_model_type *type = dea_model_find("3d");
  struct dea_load_point at;
  struct dea_field_mesh *shapes;
  assert_int_equal(type->solve(ctx, model, voltage_V, &at), DEA_OK);
  assert_int_equal(type->modes(ctx, model, &at, count, out, &shapes), DEA_OK);
  assert_non_null(dea_field_mesh_find(shapes, "mode_1"));
  dea_field_mesh_destroy(ctx, shapes);
}

/* True stress of the film at its pre-stretch: what equal stretches take. */
static double pre_stress(double l)
{
  const struct dea_material film = silicone();
  struct dea_plane plane;
  assert_int_equal(dea_plane_elastic(&film, l, l, &plane), DEA_OK);
  return l * plane.s1;
}

/* A film in a rectangular frame, with electrodes all over: it stays flat and as it is, and the
 * field takes its stress from that of the pre-stretch: f = c/2 sqrt(m^2/a^2 + n^2/b^2), c^2 =
 * (sigma - eps E^2)/rho. */
TEST(test_rectangle)
{
  enum { MODES = 4, ALL = 10 };
  static const int waves[MODES][2] = {{1, 1}, {2, 1}, {3, 1}, {1, 2}}; // of sides as 2 to 1.1
  static const double l = 1.2, a = 20e-3, b = 11e-3;
  struct dea_device *device = device_new();
  size_t film = add_rectangle(device, "film", 0, 0, a, b);
  add_film(device, film, l, l);
  add_electrodes(device, 0, film);
  hold_edge(device, film, DEA_LAYOUT_NONE, 7);
  struct dea_model *model = model_of(device);
  for (double V = 0; V < 6e3; V += 2.5e3) {
    struct dea_load_point points[ALL];
    double E = V / (100e-6 / (l * l)), stress = pre_stress(l) - 2.8 * DEA_EPSILON_0 * E * E;
    size_t k = 0;
    find_modes(model, V, ALL, points);
    for (size_t i = 0; i < ALL && k < MODES; i++) {
      if (points[i].mode_out_of_plane > 0.5) { // others are in the plane
        double wanted = 0.5 * sqrt(stress / 1080) * hypot(waves[k][0] / a, waves[k][1] / b);
        assert_close(points[i].frequency_Hz, wanted, 2e-4, 0);
        assert_close(points[i].mode_out_of_plane, 1, 1e-6, 0);
        assert_true(isnan(points[i].mode_centre));
        k++;
      }
    }
    assert_int_equal(k, MODES);
  }
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

/* A heavy hub on a ring of film: its stiffness is 2 pi T/ln(b/a) with the tension T of the film,
 * which has hardly a mass beside it. */
TEST(test_hub)
{
  static const double mass_kg = 20e-3;
  struct dea_device *device = cone_new();
  device->layout->bodies[0].free = 4;
  device->layout->bodies[0].mass_kg = mass_kg;
  device->layout->plies[0].material.density_kg_per_m3 = 1e-3;
  struct dea_model *model = model_of(device);
  struct dea_load_point mode;
  for (double V = 0; V < 6e3; V += 2.5e3) {
    double h = 100e-6 / 1.44, E = V / h;
    double tension = h * (pre_stress(1.2) - 2.8 * DEA_EPSILON_0 * E * E);
    double wanted = sqrt(2 * pi * tension / log(4) / mass_kg) / (2 * pi);
    find_modes(model, V, 1, &mode);
    assert_close(mode.frequency_Hz, wanted, 2e-5, 0);
    assert_close(mode.mode_out_of_plane, 1, 1e-6, 0);
  }
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

/* Complex amplitudes of the motions of a monitor at frequencies, per volt about 2 kV. */
static void find_answers(struct dea_model *model, const double *frequency_Hz, size_t count,
                         struct dea_load_point *points, const double **answers)
{
  const struct dea_model_type *type = dea_model_find("3d");
  const struct dea_ac_excitation volt = {.amplitude_V = 1};
  struct dea_load_point at;
  assert_int_equal(type->solve(ctx, model, 2e3, &at), DEA_OK);
  assert_int_equal(type->respond(ctx, model, &at, &volt, frequency_Hz, count, points), DEA_OK);
  *answers = type->answers(model);
  assert_non_null(*answers);
}

/* What monitors show at a voltage. */
static void look(struct dea_model *model, double voltage_V, double out[][DEA_OBSERVED_COUNT],
                 size_t count)
{
  const struct dea_model_type *type = dea_model_find("3d");
  struct dea_load_point at;
  struct dea_observation seen;
  assert_int_equal(type->solve(ctx, model, voltage_V, &at), DEA_OK);
  assert_int_equal(type->observe(ctx, model, &seen), DEA_OK);
  memcpy(out, seen.monitor, count * sizeof *out);
}

/* A heavy hub that hangs in a film with hardly a mass: a slow excitation makes what a little more
 * voltage makes, of a body, a point, a line, and a region; a faster one that over 1 - (f/f_1)^2. A
 * branch that follows at once changes nothing. */
TEST(test_answers)
{
  enum { MONITORS = 4 };
  struct dea_device *device = cone_new();
  struct dea_layout *l = device->layout;
  struct dea_material *film = &l->plies[0].material;
  l->bodies[0].free = 4;
  l->bodies[0].mass_kg = 20e-3;
  l->gravity_m_per_s2[2] = -DEA_STANDARD_GRAVITY_M_PER_S2;
  film->density_kg_per_m3 = 1e-3;
  add_point(device, "point", 12e-3, 1e-3);
  l->monitors[l->monitor_count++] = (struct dea_layout_monitor){
      .name = "line", .kind = DEA_MONITOR_LINE, .at_m = {{8e-3, 0}, {14e-3, 1e-3}}};
  add_film_monitor(device);
  for (int viscous = 0; viscous < 2; viscous++) {
    double below[MONITORS][DEA_OBSERVED_COUNT], above[MONITORS][DEA_OBSERVED_COUNT];
    struct dea_load_point mode, points[2];
    const double *answers, step_V = 20;
    film->branches[0] = (struct dea_branch){.modulus_Pa = 1e5, .time_s = 1e-10};
    film->branch_count = (size_t)viscous;
    struct dea_model *model = model_of(device);
    look(model, 2e3 - step_V, below, MONITORS);
    look(model, 2e3 + step_V, above, MONITORS);
    find_modes(model, 2e3, 1, &mode);
    const double frequency_Hz[2] = {1e-4 * mode.frequency_Hz, 0.8 * mode.frequency_Hz};
    find_answers(model, frequency_Hz, 2, points, &answers);
    assert_true(isnan(points[0].centre_amplitude_m));
    for (size_t i = 0; i < MONITORS; i++) {
      for (int k = 0; k < DEA_OBSERVED_MOTIONS; k++) {
        size_t at = i * DEA_OBSERVED_MOTIONS + (size_t)k;
        const double *slow = answers + 2 * at, *fast = slow + 2 * MONITORS * DEA_OBSERVED_MOTIONS;
        double slope = (above[i][k] - below[i][k]) / (2 * step_V);
        assert_true(isnan(slope) == isnan(slow[0]));
        if (k == DEA_OBSERVED_Z || k >= DEA_OBSERVED_STRETCH) {
          double small = k < DEA_OBSERVED_STRETCH ? 1e-12 : 1e-10; // per volt
          assert_true(isnan(slope) || fabs(slope) > 100 * small);
          assert_true(isnan(slope) || fabs(slow[0] - slope) < 5e-4 * fabs(slope) + small);
          assert_true(isnan(slope) || fabs(slow[1]) < small);
        }
        if (i == 0 && k == DEA_OBSERVED_Z) {
          assert_close(fast[0] / slow[0], 1 / (1 - 0.8 * 0.8), 1e-4, 0);
        }
      }
    }
    dea_model_find("3d")->destroy(ctx, model);
  }
  dea_device_destroy(ctx, device);
}

TESTS(context_set_up, context_tear_down)
