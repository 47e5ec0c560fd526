/* lumped in time: closed forms, an independent integration at high order, order, energy. */
#include "devices.h"
#include "model/lumped/motion.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

static const double eps = 1e-11; // F/m, of test_material

/* A film whose passive part is so large that it only holds: coverage 0.001. mu1 < 0: no branch. */
static struct dea_device free_film(const char *law, double mu, double J, double mu1, double tau)
{
  struct dea_material film = test_material(law, mu, J, 0);
  film.density_kg_per_m3 = 1000;
  film.branch_count = mu1 > 0;
  film.branches[0] = (struct dea_branch){mu1, tau};
  return test_disc(film, 1, 5e-3, 1e-3, 0);
}

static struct dea_model *begin(const struct dea_device *device,
                               const struct dea_time_options *options)
{
  const struct dea_model_type *type = dea_model_find("lumped");
  struct dea_model *model;
  struct dea_load_point point;
  assert_int_equal(type->create(ctx, device, NULL, &model), DEA_OK);
  assert_int_equal(type->begin(ctx, model, options, &point), DEA_OK);
  assert_true(point.time_s == 0 && point.stored_energy_J == 0 && point.charge_C == 0);
  return model;
}

static const struct dea_time_options quiet = {{0, INFINITY}, NULL, false, 0.8};

/* One accepted step; the status and, for DEA_OK, the point. */
static dea_status go(struct dea_model *model, double length_s, double V, struct dea_load_point *out)
{
  const struct dea_model_type *type = dea_model_find("lumped");
  const struct dea_time_step step = {.length_s = length_s, .source_voltage_V = V};
  double error;
  dea_status status = type->advance(ctx, model, &step, out, &error);
  if (status == DEA_OK) {
    type->accept(model);
  }
  return status;
}

static void end(struct dea_model *model)
{
  dea_model_find("lumped")->destroy(ctx, model);
}

/* Benchmark: strain(t) = strain(inf) [1 - mu1/(mu + mu1) exp(-t mu/((mu + mu1) tau))]. */
TEST(test_small_step_of_the_voltage)
{
  const double mu = 1e5, mu1 = 1.7e5, tau = 0.8, strain = 4e-4;
  struct dea_device device = free_film("neo-hookean", mu, 0, mu1, tau);
  struct dea_model *model = begin(&device, &quiet);
  // eps E~^2 = s = 6 mu strain for small strain
  double V = 1e-4 * sqrt(6 * mu * strain / eps);
  struct dea_load_point point;
  assert_int_equal(go(model, 0, V, &point), DEA_OK);
  for (int i = 1; i <= 60; i++) {
    double due = strain * (1 - mu1 / (mu + mu1) * exp(-0.1 * (i - 1) * mu / ((mu + mu1) * tau)));
    assert_close(point.electrode_stretch - 1, due, 3e-3, 0);
    assert_int_equal(go(model, 0.1, V, &point), DEA_OK);
  }
  end(model);
}

// A film that is integrated here, at large strain -------------------------------------------------

struct film {
  double mu, J, mu1, tau, H0; // Gent and one branch
};

/* Nominal stress of a free film with A = (p, z) at the stretch l, and its derivative. */
static double stress(const struct film *f, double l, double E, const double A[2], double *slope)
{
  double x = 2 * l * l + pow(l, -4) - 3, stiff = f->mu / (1 - x / f->J);
  double d = l - pow(l, -5), dd = 1 + 5 * pow(l, -6);
  double s = stiff * d + f->mu1 * (A[0] * l - A[1] * pow(l, -5)) - eps * E * E * l * l * l;
  *slope = stiff * dd + 4 * d * d * stiff * stiff / (f->mu * f->J) +
           f->mu1 * (A[0] + 5 * A[1] * pow(l, -6)) - 3 * eps * E * E * l * l;
  return s;
}

/* The stretch at which it vanishes, from below; false when there is none. */
static bool balance(const struct film *f, double E, const double A[2], double *l)
{
  for (int i = 0; i < 200; i++) {
    double slope, s = stress(f, *l, E, A, &slope);
    if (!(slope > 0)) {
      return false;
    }
    *l -= s / slope;
    if (fabs(s / slope) < 1e-14) {
      return true;
    }
  }
  return false;
}

/* dA/dt = (C^-1 - A)/tau with the film in balance. */
static bool rate(const struct film *f, double E, const double A[2], double *l, double out[2])
{
  if (!balance(f, E, A, l)) {
    return false;
  }
  out[0] = (pow(*l, -2) - A[0]) / f->tau;
  out[1] = (pow(*l, 4) - A[1]) / f->tau;
  return true;
}

/* Runge and Kutta's fourth order from t to t + h at a constant field. */
static bool runge_kutta(const struct film *f, double E, double h, double A[2], double *l)
{
  double k[4][2], a[2];
  static const double at[4] = {0, 0.5, 0.5, 1};
  for (int s = 0; s < 4; s++) {
    for (int c = 0; c < 2; c++) {
      a[c] = A[c] + (s > 0 ? at[s] * h * k[s - 1][c] : 0);
    }
    if (!rate(f, E, a, l, k[s])) {
      return false;
    }
  }
  for (int c = 0; c < 2; c++) {
    A[c] += h / 6 * (k[0][c] + 2 * k[1][c] + 2 * k[2][c] + k[3][c]);
  }
  return balance(f, E, A, l);
}

/* Time at which the integration above loses its balance; l_at[20]: stretch every 0.25 s. */
static double integrate(const struct film *f, double V, double *l_at)
{
  double A[2] = {1, 1}, l = 1, h = 2.5e-4;
  for (int i = 0; i < 20000; i++) {
    if (i % 1000 == 0) {
      double a[2] = {A[0], A[1]};
      balance(f, V / f->H0, a, &l);
      l_at[i / 1000] = l;
    }
    if (!runge_kutta(f, V / f->H0, h, A, &l)) {
      return h * i;
    }
  }
  return INFINITY;
}

TEST(test_creep_at_large_strain)
{
  const struct film f = {1e5, 90, 1e5, 0.8, 1e-4};
  struct dea_device device = free_film("gent", f.mu, f.J, f.mu1, f.tau);
  struct dea_model *model = begin(&device, &quiet);
  double V = 0.67 * f.H0 * sqrt(f.mu / eps), l_at[20]; // just below pull-in at rest
  struct dea_load_point point;
  assert_true(isinf(integrate(&f, V, l_at)));
  assert_int_equal(go(model, 0, V, &point), DEA_OK);
  for (int i = 0; i < 20; i++) {
    assert_close(point.electrode_stretch, l_at[i], 5e-4, 0);
    for (int k = 0; k < 10; k++) {
      assert_int_equal(go(model, 0.025, V, &point), DEA_OK);
    }
  }
  assert_true(point.electrode_stretch > 1.12); // it was large
  end(model);
}

/* The film holds at first, creeps, and is lost seconds later. */
TEST(test_delayed_pull_in)
{
  const struct film f = {1e5, 90, 1e5, 0.8, 1e-4};
  struct dea_device device = free_film("gent", f.mu, f.J, f.mu1, f.tau);
  struct dea_model *model = begin(&device, &quiet);
  double V = 0.8 * f.H0 * sqrt(f.mu / eps), l_at[20], due = integrate(&f, V, l_at), t = 0;
  struct dea_load_point point;
  assert_true(due > 1 && due < 5);
  assert_int_equal(go(model, 0, V, &point), DEA_OK);
  for (double h = 0.01; h > 1e-7;) {
    dea_status status = go(model, h, V, &point);
    assert_true(status == DEA_OK || status == DEA_E_NO_EQUILIBRIUM);
    t += status == DEA_OK ? h : 0;
    h *= status == DEA_OK ? 1 : 0.5;
  }
  assert_close(t, due, 1e-2, 0);
  end(model);
}

/* With inertia it goes through and comes to rest on the other side. */
TEST(test_pull_in_with_inertia)
{
  const struct film f = {1e5, 90, 1e5, 0.8, 1e-4};
  struct dea_device device = free_film("gent", f.mu, f.J, f.mu1, f.tau);
  struct dea_time_options options = quiet;
  options.inertia = true;
  options.rho_inf = 0;
  struct dea_model *model = begin(&device, &options);
  double V = 0.8 * f.H0 * sqrt(f.mu / eps), slope, h = 1e-4, t = 0;
  struct dea_load_point point;
  assert_int_equal(go(model, 0, V, &point), DEA_OK);
  assert_close(point.electrode_stretch, 1, 0, 1e-15); // it has not moved yet
  while (t < 30) {
    dea_status status = go(model, h, V, &point);
    t += status == DEA_OK ? h : 0;
    h = fmin(status == DEA_OK ? 1.2 * h : 0.25 * h, 2e-3);
    assert_true(h > 1e-9);
  }
  const double l = point.electrode_stretch, relaxed[2] = {pow(l, -2), pow(l, 4)};
  assert_true(l > 4);
  assert_close(stress(&f, l, V / f.H0, relaxed, &slope) / slope, 0, 0, 2e-2);
  end(model);
}

// Order and energy --------------------------------------------------------------------------------

/* A device with everything: pre-stretch, two branches, resistivity. */
static struct dea_device whole(void)
{
  struct dea_device device = test_disc(test_yeoh(), 1.5, 3.75e-3, 0.25, 0);
  device.film.branch_count = 2;
  device.film.branches[0] = (struct dea_branch){4e4, 0.05};
  device.film.branches[1] = (struct dea_branch){6e4, 0.7};
  device.film.density_kg_per_m3 = 970;
  device.film.resistivity_ohm_m = 2e10; // rho eps: 0.5 s
  return device;
}

static double drive_V(double t)
{
  return 6e3 * sin(3 * t) * sin(3 * t);
}

/* From 0 to 1 s in n steps. */
static struct dea_load_point play(const struct dea_time_options *options, double end_s, int n)
{
  struct dea_device device = whole();
  struct dea_model *model = begin(&device, options);
  struct dea_load_point point;
  for (int i = 1; i <= n; i++) {
    assert_int_equal(go(model, end_s / n, drive_V(end_s * i / n), &point), DEA_OK);
  }
  end(model);
  return point;
}

/* Halving the step takes the error to a quarter, whatever is switched on. */
TEST(test_second_order)
{
  const struct {
    struct dea_time_options options;
    double end_s;
    int n;
  } cases[] = {
      {{{0, INFINITY}, NULL, false, 0.8}, 1, 40},
      {{{1e9, INFINITY}, NULL, false, 0.8}, 1, 80},  // R C 0.05 s
      {{{0, INFINITY}, NULL, true, 0.5}, 4e-2, 400}, // vibrations of about a kilohertz
      {{{1e7, INFINITY}, NULL, true, 1}, 4e-2, 800},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    const struct dea_time_options *o = &cases[i].options;
    int n = cases[i].n;
    struct dea_load_point fine = play(o, cases[i].end_s, 16 * n);
    double stretch[2], voltage[2], lost[2];
    for (int k = 0; k < 2; k++) {
      struct dea_load_point p = play(o, cases[i].end_s, n << k);
      stretch[k] = fabs(p.electrode_stretch - fine.electrode_stretch);
      voltage[k] = fabs(p.voltage_V - fine.voltage_V);
      lost[k] = fabs(p.dissipated_J - fine.dissipated_J);
    }
    assert_close(log2(stretch[0] / stretch[1]), 2, 0, 0.25);
    assert_close(log2(lost[0] / lost[1]), 2, 0, 0.4);
    if (o->circuit.series_resistance_ohm > 0) {
      assert_close(log2(voltage[0] / voltage[1]), 2, 0, 0.25);
    }
  }
}

TEST(test_energy)
{
  const struct {
    struct dea_time_options options;
    double end_s;
    int n;
  } cases[] = {
      {{{0, INFINITY}, NULL, false, 0.8}, 3, 300},   {{{1e9, INFINITY}, NULL, false, 0.8}, 3, 300},
      {{{0, 2e-7}, NULL, false, 0.8}, 3, 1000},      {{{1e8, 3e-7}, NULL, false, 0.8}, 3, 1000},
      {{{1e7, INFINITY}, NULL, true, 1}, 0.2, 4000},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    struct dea_load_point p = play(&cases[i].options, cases[i].end_s, cases[i].n);
    double kinetic = cases[i].options.inertia ? p.kinetic_energy_J : 0;
    assert_true(p.dissipated_J > 0 && p.supply_work_J > 0);
    assert_close(p.stored_energy_J + kinetic + p.dissipated_J, p.supply_work_J, 1e-3, 0);
  }
}

// Small things ------------------------------------------------------------------------------------

/* Asking for another step instead of accepting leaves no trace. */
TEST(test_rejected_steps)
{
  const struct dea_model_type *type = dea_model_find("lumped");
  struct dea_device device = whole();
  struct dea_load_point p[2];
  for (int k = 0; k < 2; k++) {
    struct dea_model *model = begin(&device, &quiet);
    for (int i = 0; i < 5; i++) {
      const struct dea_time_step other = {.length_s = 3, .source_voltage_V = 7000},
                                 jump = {.length_s = 0, .source_voltage_V = 1e9};
      double error;
      if (k == 1) {
        assert_int_equal(type->advance(ctx, model, &other, &p[k], &error), DEA_OK);
        assert_true(type->advance(ctx, model, &jump, &p[k], &error) != DEA_OK);
      }
      assert_int_equal(go(model, 0.1, 500 * i, &p[k]), DEA_OK);
    }
    end(model);
  }
  assert_memory_equal(&p[0], &p[1], sizeof p[0]);
}

/* Mass of disc and annulus by summing over rings of the velocity field. */
TEST(test_mass)
{
  struct dea_device device = whole();
  double a = device.electrode_radius_m, L = device.frame_radius_m, mass = 0;
  enum { RINGS = 100000 };
  for (int i = 0; i < RINGS; i++) {
    double r = L * (i + 0.5) / RINGS, v = r < a ? r : a * (L - r) / (L - a);
    mass += 970 * device.film_thickness_m * 2 * 3.14159265358979 * r * L / RINGS * v * v;
  }
  assert_close(dea_lumped_mass(&device), mass, 1e-6, 0);
}

/* Small vibrations have the period that mass and stiffness give. */
TEST(test_period)
{
  struct dea_device device = whole();
  device.film.branch_count = 0;
  const struct dea_time_options options = {{0, INFINITY}, NULL, true, 1};
  struct dea_model *model = begin(&device, &options);
  struct dea_lumped lumped = {.pre_stretch = 1.5, .coverage = 0.25};
  struct dea_lumped_balance at_rest;
  struct dea_load_point p;
  assert_int_equal(dea_film_create(ctx, &device, &lumped.film), DEA_OK);
  assert_int_equal(dea_lumped_balance_eval(&lumped, 1, 0, &at_rest), DEA_OK);
  double volume = 3.14159265358979 * pow(3.75e-3, 2) * device.film_thickness_m;
  double omega = sqrt(2 * 1.5 * at_rest.slope_Pa * volume / dea_lumped_mass(&device));
  double h = 0.005 / omega, last = 0, middle = 0;
  int turns = 0, steps = 0;
  assert_int_equal(go(model, 0, 100, &p), DEA_OK);
  for (int i = 0; i < 400; i++) { // the middle of the vibration, by its highest value
    assert_int_equal(go(model, 2 * h, 100, &p), DEA_OK);
    middle = fmax(middle, 0.5 * (p.electrode_stretch - 1));
  }
  for (int i = 0; turns < 21; i++) {
    assert_int_equal(go(model, 2 * h, 100, &p), DEA_OK);
    double now = p.electrode_stretch - 1 - middle;
    if (last < 0 && now >= 0) {
      steps = turns++ == 0 ? i - i : steps;
    }
    steps += turns > 0;
    last = now;
  }
  assert_close(steps * 2 * h / 20, 2 * 3.14159265358979 / omega, 2e-3, 0);
  end(model);
}

TESTS(context_set_up, context_tear_down)
