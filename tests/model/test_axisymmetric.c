/* Model axisymmetric: benchmark 4, an independent shooting solution, refinement, derivatives. */
#include "context_fixture.h"
#include "devices.h"
#include "model/axisymmetric/disc.h"
#include "model/equilibrium_path.h"
#include "model/model.h"
#include "testing.h"

static struct dea_load_point solve_at(const struct dea_device *device, double voltage_V)
{
  const struct dea_model_type *type = dea_model_find("axisymmetric");
  struct dea_model *model;
  struct dea_load_point p;
  assert_int_equal(type->create(ctx, device, NULL, &model), DEA_OK);
  assert_int_equal(type->solve(ctx, model, voltage_V, &p), DEA_OK);
  type->destroy(ctx, model);
  return p;
}

TEST(test_benchmark_4)
{
  static const double kV[] = {1, 3, 5, 7};
  static const double small[] = {0.365, 3.434, 10.297, 21.607};
  static const double large[] = {0.346, 3.259, 9.819, 20.828};
  struct dea_device a = test_disc(test_yeoh(), 1.5, 3.75e-3, 0.25, 0);
  struct dea_device b = test_disc(test_yeoh(), 1.5, 5e-3, 1.0 / 3, 0);
  for (size_t i = 0; i < 4; i++) {
    assert_close(100 * (solve_at(&a, 1e3 * kV[i]).electrode_stretch - 1), small[i], 0, 6e-4);
    assert_close(100 * (solve_at(&b, 1e3 * kV[i]).electrode_stretch - 1), large[i], 0, 6e-4);
  }
}

static dea_status ignore_point(void *user, const struct dea_load_point *point)
{
  return DEA_OK;
}

static dea_status keep_slack(void *user, const struct dea_event *event)
{
  if (event->kind == DEA_EVENT_SLACK) {
    *(struct dea_event *)user = *event;
  }
  return DEA_OK;
}

TEST(test_loss_of_tension)
{
  const struct dea_model_type *type = dea_model_find("axisymmetric");
  struct dea_device device = test_disc(test_yeoh(), 1.5, 3.75e-3, 0.25, 0);
  const struct dea_path_options options = {
      .max_stretch = 3, .max_voltage_V = INFINITY, .max_points = 1000};
  struct dea_model *model;
  struct dea_event slack = {0};
  assert_int_equal(type->create(ctx, &device, NULL, &model), DEA_OK);
  assert_int_equal(type->path(ctx, model, &options, ignore_point, keep_slack, &slack), DEA_OK);
  assert_close(slack.point.voltage_V, 11689, 0, 0.5);
  assert_close(slack.point.min_tension_N_per_m, 0, 0, 1e-9);
  type->destroy(ctx, model);
}

/* Shooting with the classical Runge-Kutta rule through the annulus: d(R s_r)/dR = s_t for r(R),
 * from the electrode edge, where the homogeneous electrode gives radius and stress, to the frame.
 * Returns r(b) - b. Shares only the material with the model. */
static double shoot(const struct dea_device *device, double voltage_V, double stretch)
{
  enum { STEPS = 400 };
  double l_pre = device->pre_stretch, a = device->electrode_radius_m, b = device->frame_radius_m;
  double field = voltage_V / device->film_thickness_unstretched_m, l = l_pre * stretch;
  struct dea_plane p, electric;
  assert_int_equal(dea_plane_elastic(&device->film, l, l, &p), DEA_OK);
  dea_plane_electric(&device->film, field, l, l, &electric);
  double stress = p.s1 + electric.s1, l_r = l;
  for (int i = 0; i < 50; i++) { // radial stretch just outside, from continuity of s_r
    assert_int_equal(dea_plane_elastic(&device->film, l_r, l, &p), DEA_OK);
    l_r -= (p.s1 - stress) / p.k11;
  }
  double y[2] = {l_r, l}, R = a, h = (b - a) / STEPS; // radial and hoop stretch
  for (int i = 0; i < STEPS; i++) {
    static const double at[] = {0, 0.5, 0.5, 1}, weight[] = {1, 2, 2, 1};
    double k[2] = {0, 0}, sum[2] = {0, 0};
    for (int s = 0; s < 4; s++) {
      double z[2] = {y[0] + at[s] * h * k[0], y[1] + at[s] * h * k[1]}, Rs = R + at[s] * h;
      assert_int_equal(dea_plane_elastic(&device->film, z[0], z[1], &p), DEA_OK);
      k[1] = (z[0] - z[1]) / Rs;
      k[0] = ((p.s2 - p.s1) / Rs - p.k12 * k[1]) / p.k11;
      sum[0] += weight[s] * k[0];
      sum[1] += weight[s] * k[1];
    }
    y[0] += h / 6 * sum[0];
    y[1] += h / 6 * sum[1];
    R += h;
  }
  return y[1] / l_pre - 1;
}

static double shooting_stretch(const struct dea_device *device, double voltage_V, double guess)
{
  double x0 = guess, x1 = guess + 1e-4, f0 = shoot(device, voltage_V, x0);
  for (int i = 0; i < 30 && fabs(x1 - x0) > 1e-14; i++) {
    double f1 = shoot(device, voltage_V, x1), next = x1 - f1 * (x1 - x0) / (f1 - f0);
    x0 = x1;
    f0 = f1;
    x1 = next;
  }
  return x1;
}

TEST(test_against_shooting)
{
  struct {
    struct dea_material film;
    double pre, radius, V;
  } cases[] = {
      {test_yeoh(), 1.5, 3.75e-3, 6e3},
      {test_yeoh(), 1.5, 12e-3, 7e3},
      {test_yeoh(), 1.05, 1e-3, 4e3},
      {test_material("gent", 1e5, 30, 0), 1.8, 5e-3, 3e3},
      {test_material("mooney-rivlin", 8e4, 2e4, 0), 1.3, 5e-3, 4e3},
      {test_material("ogden", 4e4, 3, 0), 1.4, 5e-3, 3e3},
      {test_material("arruda-boyce", 1e5, 3, 0), 1.4, 5e-3, 4e3},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    struct dea_device device =
        test_disc(cases[i].film, cases[i].pre, cases[i].radius, cases[i].radius / 15e-3, 0);
    double model = solve_at(&device, cases[i].V).electrode_stretch;
    double shot = shooting_stretch(&device, cases[i].V, 1 + 0.98 * (model - 1));
    assert_true(model > 1.01);
    assert_close(model, shot, 1e-8, 0);
  }
}

/* Solution with elements of another order through the same path solver. */
struct refined {
  struct dea_disc disc;
};

static dea_status refined_evaluate(void *self, const double *u, double V, double *g, double *K,
                                   double *gV)
{
  struct refined *r = self;
  return dea_disc_evaluate(&r->disc, u, V, g, K, gV);
}

static dea_status refined_point(void *self, const double *u, double V, struct dea_load_point *out)
{
  struct refined *r = self;
  *out = dea_load_point_empty();
  out->voltage_V = V;
  out->electrode_stretch = 1 + u[dea_disc_edge(&r->disc)];
  return DEA_OK;
}

static double stretch_at_order(const struct dea_device *device, size_t order, double voltage_V)
{
  struct refined r;
  static const double rest[DEA_PATH_UNKNOWNS_MAX] = {0};
  struct dea_path *path;
  struct dea_load_point p;
  assert_int_equal(dea_disc_create(ctx, device, order, &r.disc), DEA_OK);
  const struct dea_path_system system = {dea_disc_unknowns(&r.disc),
                                         &r,
                                         refined_evaluate,
                                         refined_point,
                                         dea_film_voltage_scale(&r.disc.film),
                                         NULL,
                                         1,
                                         10,
                                         "axisymmetric"};
  assert_int_equal(dea_path_create(ctx, &system, rest, &path), DEA_OK);
  assert_int_equal(dea_path_seek(ctx, path, voltage_V, 10), DEA_OK);
  assert_int_equal(dea_path_point(ctx, path, &p), DEA_OK);
  dea_path_destroy(ctx, path);
  return p.electrode_stretch;
}

/* Exponential convergence; the order that the model uses (14) is far below 1e-6. */
TEST(test_refinement)
{
  static const double radii[] = {0.5e-3, 3.75e-3, 13e-3};
  for (size_t i = 0; i < 3; i++) {
    struct dea_device device = test_disc(test_yeoh(), 1.5, radii[i], radii[i] / 15e-3, 0);
    double best = stretch_at_order(&device, 20, 7e3);
    double e6 = fabs(stretch_at_order(&device, 6, 7e3) - best);
    double e10 = fabs(stretch_at_order(&device, 10, 7e3) - best);
    double e14 = fabs(solve_at(&device, 7e3).electrode_stretch - best);
    assert_true(e10 < 0.1 * e6 + 1e-13);
    assert_true(e14 < 1e-9);
  }
}

/* Small strains of lumped and exact disc in the ratio of docs/theory/lumped.md, section 2. */
TEST(test_cost_of_eq_17_at_small_strain)
{
  const struct dea_model_type *type = dea_model_find("lumped");
  static const double radius_mm[] = {3.75, 5, 9};
  struct dea_material film = test_yeoh();
  struct dea_plane k;
  assert_int_equal(dea_plane_elastic(&film, 1.5, 1.5, &k), DEA_OK);
  for (size_t i = 0; i < 9; i++) {
    double ratio = radius_mm[i / 3] / 15;
    double R = i % 3 == 0 ? ratio : i % 3 == 1 ? ratio * ratio : 0.2;
    struct dea_device device = test_disc(film, 1.5, 1e-3 * radius_mm[i / 3], R, 0);
    struct dea_load_point exact = solve_at(&device, 100), lumped;
    struct dea_model *model;
    assert_int_equal(type->create(ctx, &device, NULL, &model), DEA_OK);
    assert_int_equal(type->solve(ctx, model, 100, &lumped), DEA_OK);
    type->destroy(ctx, model);
    double wanted = 2 * (1 - R) / (1 - ratio * ratio) * k.k11 / (k.k11 + k.k12);
    assert_close((lumped.electrode_stretch - 1) / (exact.electrode_stretch - 1), wanted, 1e-4, 0);
  }
}

/* Holzapfel-Gasser-Ogden with fibres at an angle to the radius. */
static struct dea_device fibre_film(double angle_rad, double kappa)
{
  struct dea_material m = test_material("holzapfel-gasser-ogden", 3e5, 1e5, 0);
  m.param[3] = kappa;
  m.fibre_angle_rad = angle_rad;
  return test_disc(m, 1.5, 3.75e-3, 0.25, 0);
}

/* A film with a direction is refused, one whose fibres balance is solved as finely as others. */
TEST(test_films_with_a_direction)
{
  const double quarter = acos(0) / 2;
  const struct dea_device round[] = {fibre_film(quarter, 0), fibre_film(0, 1.0 / 3)};
  struct dea_device directed[] = {fibre_film(0, 0), fibre_film(2 * quarter, 0.2), fibre_film(0, 0)};
  directed[2].pre_stretch = 1; // at rest nothing shows yet
  for (size_t i = 0; i < 2; i++) {
    struct dea_load_point p = solve_at(&round[i], 3e3);
    assert_true(p.electrode_stretch > 1.001);
    assert_close(p.electrode_stretch, stretch_at_order(&round[i], 20, 3e3), 0, 1e-9);
    assert_close(solve_at(&round[i], 0).electrode_stretch, 1, 0, 1e-12);
  }
  for (size_t i = 0; i < 3; i++) {
    struct dea_model *model;
    assert_int_equal(dea_model_find("axisymmetric")->create(ctx, &directed[i], NULL, &model),
                     DEA_E_DESIGN);
    assert_null(model);
    assert_non_null(strstr(dea_context_message(ctx), "direction"));
  }
}

TEST(test_disc_derivatives)
{
  enum { N = DEA_PATH_UNKNOWNS_MAX };
  static double g[N], K[N * N], gV[N], up[N], down[N], Kd[N * N], gVd[N];
  double u[N], e0, e1, C, d = 1e-6, V = 5e3;
  struct dea_material film = test_yeoh();
  film.permittivity.slope = -0.28;
  struct dea_device device = test_disc(film, 1.5, 5e-3, 1.0 / 3, 0);
  struct dea_disc disc;
  assert_int_equal(dea_disc_create(ctx, &device, 5, &disc), DEA_OK);
  size_t n = dea_disc_unknowns(&disc);
  for (size_t i = 0; i < n; i++) {
    u[i] = 0.05 * sin(2.0 * (double)i + 1);
  }
  assert_int_equal(dea_disc_evaluate(&disc, u, V, g, K, gV), DEA_OK);
  for (size_t j = 0; j < n; j++) {
    double keep = u[j];
    u[j] = keep + d;
    assert_int_equal(dea_disc_totals(&disc, u, V, &e1, &C), DEA_OK);
    assert_int_equal(dea_disc_evaluate(&disc, u, V, up, Kd, gVd), DEA_OK);
    u[j] = keep - d;
    assert_int_equal(dea_disc_totals(&disc, u, V, &e0, &C), DEA_OK);
    assert_int_equal(dea_disc_evaluate(&disc, u, V, down, Kd, gVd), DEA_OK);
    u[j] = keep;
    assert_close(g[j], (e1 - e0) / (2 * d), 1e-6, 1e-9);
    for (size_t i = 0; i < n; i++) {
      assert_close(K[j * n + i], (up[i] - down[i]) / (2 * d), 1e-6, 1e-7);
      assert_close(K[j * n + i], K[i * n + j], 1e-14, 0);
    }
  }
  double dV = 1;
  assert_int_equal(dea_disc_evaluate(&disc, u, V + dV, up, Kd, gVd), DEA_OK);
  assert_int_equal(dea_disc_evaluate(&disc, u, V - dV, down, Kd, gVd), DEA_OK);
  for (size_t i = 0; i < n; i++) {
    assert_close(gV[i], (up[i] - down[i]) / (2 * dV), 1e-9, 1e-14);
  }
}

/* Inside, an isotropic film is homogeneous; radial tension is continuous at the electrode edge; the
 * frame holds. */
TEST(test_profile)
{
  const struct dea_model_type *type = dea_model_find("axisymmetric");
  struct dea_device device = test_disc(test_yeoh(), 1.5, 5e-3, 1.0 / 3, 0);
  struct dea_model *model;
  struct dea_load_point p;
  struct dea_profile f;
  assert_int_equal(type->create(ctx, &device, NULL, &model), DEA_OK);
  assert_int_equal(type->solve(ctx, model, 6e3, &p), DEA_OK);
  assert_int_equal(type->profile(ctx, model, &f), DEA_OK);
  size_t edge = 0;
  for (size_t i = 0; i < f.count && f.radius_m[i] < 5e-3 - 1e-12; i++) {
    edge = i + 1;
    assert_close(f.stretch_r[i], 1.5 * p.electrode_stretch, 1e-9, 0);
    assert_close(f.stretch_t[i], 1.5 * p.electrode_stretch, 1e-9, 0);
  }
  assert_close(f.radius_m[edge], f.radius_m[edge + 1], 1e-12, 0);
  assert_close(f.tension_r_N_per_m[edge], f.tension_r_N_per_m[edge + 1], 1e-6, 0);
  assert_true(f.stretch_r[edge + 1] < f.stretch_r[edge] - 0.05);
  assert_close(f.displacement_m[f.count - 1], 0, 0, 1e-15);
  assert_close(f.displacement_m[edge], p.electrode_edge_u_m, 1e-12, 0);
  type->destroy(ctx, model);
}

/* Charge is minus the derivative of the energy by the voltage. */
TEST(test_charge_from_energy)
{
  for (int k = 0; k < 2; k++) {
    const struct dea_model_type *type = dea_model_find(k == 0 ? "axisymmetric" : "lumped");
    struct dea_device device = test_disc(test_yeoh(), 1.5, 5e-3, 1.0 / 3, 0);
    struct dea_model *model;
    struct dea_load_point p, up, down;
    assert_int_equal(type->create(ctx, &device, NULL, &model), DEA_OK);
    assert_int_equal(type->solve(ctx, model, 4990, &down), DEA_OK);
    assert_int_equal(type->solve(ctx, model, 5000, &p), DEA_OK);
    assert_int_equal(type->solve(ctx, model, 5010, &up), DEA_OK);
    assert_close(p.capacitance_F * 5000, -(up.energy_J - down.energy_J) / 20, 1e-5, 0);
    type->destroy(ctx, model);
  }
}

/* A film at its pre-stretch goes slack at 7972 V (physics.md); an electrode that fills the frame
 * nearly is held like that. */
TEST(test_held_film_goes_slack_at_the_maxwell_voltage)
{
  const struct dea_model_type *type = dea_model_find("axisymmetric");
  struct dea_device device = test_disc(test_yeoh(), 1.5, 14.9999e-3, 0.99, 0);
  const struct dea_path_options options = {
      .max_stretch = 1.6, .max_voltage_V = 12e3, .max_points = 1000};
  struct dea_model *model;
  struct dea_event slack = {0};
  assert_int_equal(type->create(ctx, &device, NULL, &model), DEA_OK);
  assert_int_equal(type->path(ctx, model, &options, ignore_point, keep_slack, &slack), DEA_OK);
  assert_close(slack.point.voltage_V, 7972, 1e-3, 0);
  type->destroy(ctx, model);
}

TESTS(context_set_up, context_tear_down)
