/* Steps in time of solids: rest, vibration, order. Creep to pull-in: verify_time. */
// ctest: solid
#include "material/material.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/model3d/solid_state.h"
#include "model/solid/motion/time.h"
#include "solid_block.h"

#include "solid_fixture.h" // after: its context shadows no name of the headers above

/* ---- a film between electrodes ---- */

static const double mu[DEA_LAW_PARAM_MAX] = {1e5}, eps = 4.7 * DEA_EPSILON_0;

struct film {
  struct block block; // stretched flat
  double pre_stretch;
  double density_kg_per_m3, radius; // density 0: without inertia
  int (*held)(const void *self, const double X[3]);
  struct dea_branches branches;
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_time *time;
  size_t corner; // node that is farthest out
};

#define SQUARE .block = {{1e-3, 1e-3, 100e-6}, {1, 1, 1}, 2, 2}, .held = on_planes

/* Dead loads on the sides of one element that hold the stretch: shares of a parabola's nodes. */
static void hang_weights(struct film *film)
{
  const double p = film->pre_stretch, *size = film->block.size;
  double traction = mu[0] * (p * p - pow(p, -4)); // true stress
  for (size_t n = 0; n < film->grid->node_count; n++) {
    const double *X = film->grid->X + 3 * n;
    for (int i = 0; i < 2; i++) {
      double along = X[1 - i] / size[1 - i], up = X[2] / size[2];
      double share = (fabs(along - 0.5) < 0.1 ? 4 : 1) * (fabs(up - 0.5) < 0.1 ? 4 : 1) / 36.;
      if (X[i] > size[i] * (1 - 1e-9)) {
        dea_solid_force(film->solid)[3 * n + (size_t)i] = share * traction * size[1 - i] * size[2];
      }
    }
  }
}

static void film_create(struct film *film)
{
  const double p = film->pre_stretch;
  struct dea_part_material layer = {.law = dea_law_find("neo-hookean"),
                                    .param = {mu[0]},
                                    .pre_stretch = {p, p, 1 / (p * p)},
                                    .kappa_Pa = 100 * mu[0],
                                    .permittivity_F_per_m = eps,
                                    .thickness_m = film->block.size[2],
                                    .density_kg_per_m3 = film->density_kg_per_m3};
  struct dea_solid_report report;
  double most = -1;
  film->grid = block_grid(ctx, &film->block);
  assert_int_equal(dea_part_material_relax(&layer), DEA_OK);
  const struct dea_solid_options options = {.order_z = film->block.order_z,
                                            .part_material_count = 1,
                                            .part_materials = &layer,
                                            .active = everywhere,
                                            .held = film->held,
                                            .self = film};
  const struct dea_solid_time_options steps = {&film->branches, film->density_kg_per_m3 > 0,
                                               film->radius, false};
  assert_int_equal(dea_solid_create(ctx, film->grid, &options, &film->solid), DEA_OK);
  if (film->held == on_planes) {
    hang_weights(film);
  }
  assert_int_equal(dea_load_steps_solve(ctx, film->solid, 0, &report), DEA_OK);
  assert_int_equal(report.unstable_modes, 0);
  assert_int_equal(dea_solid_time_create(ctx, film->solid, &steps, &film->time), DEA_OK);
  for (size_t n = 0; n < film->grid->node_count; n++) {
    double sum = film->grid->X[3 * n] + film->grid->X[3 * n + 1] + film->grid->X[3 * n + 2];
    film->corner = sum > most ? n : film->corner;
    most = fmax(most, sum);
  }
}

static void film_destroy(struct film *film)
{
  dea_solid_time_destroy(ctx, film->time);
  dea_solid_destroy(ctx, film->solid);
  dea_grid_destroy(ctx, film->grid);
}

static double strain_of(const struct film *film)
{
  return dea_solid_displacement(film->solid)[3 * film->corner] / 1e-3;
}

static dea_status step_to(struct film *film, double voltage_V, double step_s)
{
  struct dea_solid_report report;
  dea_status status = dea_solid_time_step(ctx, film->time, voltage_V, step_s, &report);
  if (status == DEA_OK) {
    status = dea_solid_time_close(ctx, film->time, NULL);
  }
  if (status == DEA_OK) {
    dea_solid_time_accept(film->time);
  }
  return status;
}

static void jump_to(struct film *film, double voltage_V)
{
  struct dea_solid_report report;
  assert_int_equal(dea_solid_time_jump(ctx, film->time, voltage_V, &report), DEA_OK);
  assert_int_equal(dea_solid_time_close(ctx, film->time, NULL), DEA_OK);
  dea_solid_time_accept(film->time);
}

/* A film at rest, and one that is held in an actuated state for long, stay where they are, for
 * branches that are soft or much stiffer than the law, in steps short or long. */
TEST(test_held_film_stays)
{
  for (int kind = 0; kind < 4; kind++) {
    struct film film = {SQUARE, .pre_stretch = 1, .radius = 1,
                        .branches = {2, {{kind % 2 ? 1e7 : 5e4, 0.5}, {5e4, 1e-3}}}};
    double voltage_V = kind / 2 * 0.6 * sqrt(mu[0] / eps) * film.block.size[2], before;
    film_create(&film);
    struct dea_solid_report report;
    if (voltage_V > 0) { // held: the branches start anew from there
      const struct dea_solid_time_options steps = {&film.branches, false, 1, false};
      dea_solid_time_destroy(ctx, film.time);
      assert_int_equal(dea_load_steps_solve(ctx, film.solid, voltage_V, &report), DEA_OK);
      assert_int_equal(dea_solid_time_create(ctx, film.solid, &steps, &film.time), DEA_OK);
    }
    before = strain_of(&film);
    for (double step = 1e-5; step < 1e3; step *= 30) {
      assert_int_equal(dea_solid_time_step(ctx, film.time, voltage_V, step, &report), DEA_OK);
      assert_int_equal(report.unstable_modes, 0);
      assert_int_equal(dea_solid_time_close(ctx, film.time, NULL), DEA_OK);
      dea_solid_time_accept(film.time);
      assert_close(strain_of(&film), before, 0, 1e-11);
    }
    assert_true(fabs(dea_solid_time_energies(film.time, false).dissipated) < 1e-18);
    film_destroy(&film);
  }
}

/* ---- inertia ---- */

/* A pre-stretched strip in plane strain whose ends glide across the film: it swings as a cosine
 * about its middle. */
static int gliding_ends(const void *self, const double X[3])
{
  const struct film *film = self;
  double x = X[0] / film->block.size[0], z = X[2] / film->block.size[2];
  bool middle = fabs(x - 0.5) < 1e-9 && fabs(z - 0.5) < 1e-9;
  return (x < 1e-9 || x > 1 - 1e-9 ? 1 : 0) | 2 | (middle ? 4 : 0);
}

#define STRIP(count)                                                                               \
  .block = {{40e-3, 4e-3, 100e-6 / 2.25}, {count, 1, 1}, 2, 2}, .held = gliding_ends,              \
  .pre_stretch = 1.5, .density_kg_per_m3 = 1000

static const double pi = 3.14159265358979323846;

/* Free vibration of small amplitude: the period is that of a string of the same tension, and the
 * steps' spectral radius says what becomes of its energy. */
TEST(test_vibration_of_a_membrane)
{
  static const double radius[] = {1, 0.5};
  for (int k = 0; k < 2; k++) {
    struct film film = {STRIP(8), .radius = radius[k]};
    double tension = mu[0] * (1.5 * 1.5 - pow(1.5, -4)), speed = 1e-3, crossing = NAN;
    double omega = pi / 40e-3 * sqrt(tension / 1000), step = 2 * pi / omega / 64;
    film_create(&film);
    size_t end = 0;
    for (size_t n = 0; n < film.grid->node_count; n++) {
      double x = film.grid->X[3 * n];
      dea_solid_velocity(film.time)[3 * n + 2] = speed * cos(pi * x / 40e-3);
      end = x < 1e-9 ? n : end;
    }
    jump_to(&film, 0);
    double first = dea_solid_time_energies(film.time, false).kinetic, before = 0;
    for (int i = 1; i <= 72; i++) {
      assert_int_equal(step_to(&film, 0, step), DEA_OK);
      double z = dea_solid_displacement(film.solid)[3 * end + 2];
      if (before < 0 && z >= 0) {
        crossing = (i - z / (z - before)) * step;
      }
      before = z;
    }
    const struct dea_solid_energies e = dea_solid_time_energies(film.time, false);
    double h = omega * step;
    if (radius[k] == 1) { // the step's own share of the period is known
      assert_close(crossing * omega / (2 * pi), 1 + h * h / 12, 5e-5, 0);
      assert_close(e.damped, 0, 0, 1e-7 * first);
    } else {
      assert_true(e.damped > 5e-4 * first && e.damped < 5e-3 * first);
    }
    assert_close(e.kinetic + e.stored + e.damped, first, 1e-5, 0);
    film_destroy(&film);
  }
}

/* A voltage that rises smoothly in `end` and falls again. */
static double smooth(double t, double end, double top)
{
  return top * sin(pi * t / end) * sin(pi * t / end);
}

/* Strain and pressure of the square after a pulse in so many steps. */
static void pulse(struct film film, double end, int steps, double out[2],
                  struct dea_solid_energies *energies)
{
  const double top = 0.5 * film.block.size[2] * sqrt(mu[0] / eps);
  film_create(&film);
  *energies = (struct dea_solid_energies){0};
  for (int i = 1; i <= steps; i++) { // to where the voltage is falling
    assert_ok(step_to(&film, smooth(0.7 * end * i / steps, end, top), 0.7 * end / steps));
  }
  *energies = dea_solid_time_energies(film.time, false);
  struct dea_state state = {0};
  size_t displacements = 3 * film.grid->node_count, pressures = 4; // of its one element
  assert_int_equal(dea_solid_save(ctx, film.solid, &state), DEA_OK);
  out[0] = strain_of(&film);
  out[1] = dea_state_find(&state, "state", displacements + pressures)[displacements];
  film_destroy(&film);
}

/* Halving the steps divides the error by four: displacement and pressure, with branches, with
 * inertia, with both; and the balance of energy closes as fast. */
TEST(test_second_order)
{
  for (int kind = 0; kind < 3; kind++) {
    struct film film = {SQUARE, .pre_stretch = 1, .density_kg_per_m3 = kind > 0 ? 1000 : 0,
                        .radius = 0.8};
    const struct dea_branches branches = {2, {{2e5, 1e-4}, {1e5, 1e-3}}};
    film.branches = kind == 1 ? film.branches : branches;
    double is[4][2], off[4];
    for (int k = 0; k < 4; k++) {
      struct dea_solid_energies e;
      pulse(film, 3e-4, 20 << k, is[k], &e);
      off[k] = (e.stored + e.branches + e.kinetic + e.dissipated + e.damped) / e.supply - 1;
    }
    for (int i = 0; i < 2; i++) {
      assert_close((is[1][i] - is[2][i]) / (is[2][i] - is[3][i]), 4, 0.1, 0);
    }
    assert_close(off[2] / off[3], 4, 0.05, 0);
    assert_true(fabs(off[3]) < 5e-5);
  }
}

TESTS(solid_set_up, solid_tear_down)
