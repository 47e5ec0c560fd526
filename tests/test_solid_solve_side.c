/* The actuator without pre-stress: it buckles to either side. Model 3d goes to the side that is
 * asked for, and paths by arc-length say which one follows from 0 V: an imperfect pitchfork, whose
 * detached arm ends at a limit point. */
// ctest: solid
#include "devices.h"
#include "model/model.h"
#include "model/solid/actuator/actuator.h"
#include "model/solid/adapter/solid_of_actuator.h"
#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "testing.h"

#include "solid_fixture.h" // after: its context shadows no name of the headers above

extern const struct dea_model_type dea_solid_module;

static struct dea_device slack(void)
{
  struct dea_device star = test_star(4);
  star.pre_stretch = 1;
  star.film_thickness_m = star.film_thickness_unstretched_m;
  return star;
}

/* ---- the model ---- */

enum { VOLTAGES = 3 };
static const double voltage_kV[VOLTAGES] = {0.5, 2, 0.5};

static void sweep(enum dea_buckling_branch side, struct dea_load_point points[VOLTAGES])
{
  struct dea_device buckling = slack();
  struct dea_model *model;
  const struct dea_model_settings settings = {.buckling_branch = side};
  assert_int_equal(dea_solid_module.create(ctx, &buckling, &settings, &model), DEA_OK);
  for (int i = 0; i < VOLTAGES; i++) {
    if (dea_solid_module.solve(ctx, model, 1e3 * voltage_kV[i], &points[i]) != DEA_OK) {
      fail_msg("%s", dea_context_message(ctx));
    }
    assert_int_equal(points[i].unstable_modes, 0);
  }
  dea_solid_module.destroy(ctx, model);
}

/* Where there is one state only, all find it; above the onset each has its own. Down is the side
 * that follows from 0 V. */
static void test_model_goes_to_the_side_asked_for(void **state)
{
  (void)state;
  struct dea_load_point any[VOLTAGES], up[VOLTAGES];
  sweep(DEA_BRANCH_ANY, any);
  sweep(DEA_BRANCH_FIBRES, up);
  for (int i = 0; i < VOLTAGES; i++) {
    assert_true(any[i].centre_z_m < 0);
    if (voltage_kV[i] < 0.6) {
      assert_close(up[i].centre_z_m, any[i].centre_z_m, 1e-5, 0);
    } else {
      assert_true(up[i].centre_z_m > 1e-4);
    }
  }
  // to about the same height on both sides
  assert_close(up[1].centre_z_m, -any[1].centre_z_m, 5e-2, 0);
}

/* Without fibres the film is flat, up to a voltage between 400 and 500 V; just beyond it the energy
 * of the buckled film is lower by a part in 10^7 only. */
static void test_onset_without_fibres(void **state)
{
  (void)state;
  struct dea_device flat = slack();
  struct dea_load_point below, above;
  struct dea_model *model;
  flat.fibre_count = 0;
  assert_int_equal(dea_solid_module.create(ctx, &flat, NULL, &model), DEA_OK);
  assert_int_equal(dea_solid_module.solve(ctx, model, 400, &below), DEA_OK);
  assert_int_equal(below.unstable_modes, 0);
  assert_close(below.centre_z_m, 0, 0, 1e-9);
  assert_int_equal(dea_solid_module.solve(ctx, model, 500, &above), DEA_OK);
  assert_int_equal(above.unstable_modes, 0);
  assert_true(fabs(above.centre_z_m) > 1e-5);
  dea_solid_module.destroy(ctx, model);
}

/* ---- paths ---- */

static struct dea_device device;
static struct dea_actuator actuator;
static struct dea_grid *grid;
static struct dea_solid *solid;
static size_t centre;

static void create(void)
{
  device = slack();
  assert_int_equal(dea_actuator_create(ctx, &device, &(struct dea_model_settings){0}, &actuator),
                   DEA_OK);
  assert_int_equal(dea_fibre_disc_create(ctx, &actuator.plate, &grid), DEA_OK);
  assert_int_equal(dea_solid_of_actuator(ctx, &actuator, grid, &solid), DEA_OK);
  centre = dea_grid_nearest(grid, (const double[3]){0});
}

static void destroy(void)
{
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

static double centre_z(void)
{
  return dea_solid_displacement(solid)[3 * centre + 2];
}

static struct dea_solid_continuation *trace_to(double voltage_V, double step)
{
  const struct dea_continuation_options options = {step, 0.5, 100e-6};
  struct dea_solid_continuation *trace;
  assert_int_equal(dea_solid_continuation_create(ctx, solid, voltage_V, &options, &trace), DEA_OK);
  return trace;
}

/* Stable all the way, without a limit point, and the same as a sweep. The two arms pass close by
 * each other: steps twice as long can jump to the other one. */
static void test_path_from_rest_goes_down(void **state)
{
  (void)state;
  struct dea_continuation_point point = {0};
  struct dea_solid_report report;
  create();
  struct dea_solid_continuation *trace = trace_to(1200, 0.05);
  while (point.load < 1) {
    assert_int_equal(dea_solid_continuation_step(ctx, trace, &point), DEA_OK);
    assert_int_equal(point.unstable_modes, 0);
    assert_int_equal(point.passed, DEA_CONTINUATION_NOTHING);
    assert_true(centre_z() < 0);
  }
  dea_solid_continuation_destroy(ctx, trace);
  double z = centre_z();
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
  assert_int_equal(dea_load_steps_solve(ctx, solid, point.voltage_V, &report), DEA_OK);
  assert_close(centre_z(), z, 1e-5, 0);
  destroy();
}

static bool above(const void *self, const double *u)
{
  (void)self;
  return u[3 * centre + 2] > 0;
}

/* Onto the other arm at 1 kV, and down with the voltage: at a limit point between 0.7 and 1 kV it
 * turns to an arm with one unstable mode, on which the voltage rises again. */
static void test_other_arm_ends_at_a_limit_point(void **state)
{
  (void)state;
  struct dea_continuation_point point = {0}, limit = {0};
  struct dea_solid_report report;
  bool found;
  create();
  double *push = dea_alloc(ctx, 3 * grid->node_count, sizeof *push);
  assert_non_null(push);
  for (size_t n = 0; n < grid->node_count; n++) {
    double r = hypot(grid->X[3 * n], grid->X[3 * n + 1]) / 3.75e-3;
    push[3 * n + 2] = r < 1 ? 4.5e-4 * (1 - r * r) * (1 - r * r) : 0;
  }
  assert_int_equal(dea_load_steps_solve(ctx, solid, 500, &report), DEA_OK);
  assert_int_equal(dea_solid_push(ctx, solid, push, above, NULL, &report, &found), DEA_OK);
  assert_false(found); // one state only, and the solid is still there
  assert_true(centre_z() < 0);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 1000, &report), DEA_OK);
  assert_int_equal(dea_solid_push(ctx, solid, push, above, NULL, &report, &found), DEA_OK);
  assert_true(found);
  assert_true(centre_z() > 5e-5);
  struct dea_solid_continuation *trace = trace_to(0, 0.05);
  for (int i = 0; i < 40 && point.passed != DEA_CONTINUATION_LIMIT; i++) {
    assert_int_equal(point.unstable_modes, 0);
    assert_int_equal(dea_solid_continuation_step(ctx, trace, &point), DEA_OK);
  }
  assert_int_equal(point.passed, DEA_CONTINUATION_LIMIT);
  assert_int_equal(point.unstable_modes, 1);
  assert_int_equal(dea_solid_continuation_locate(ctx, trace, &limit), DEA_OK);
  assert_true(limit.voltage_V > 700 && limit.voltage_V < 1000);
  for (int i = 0; i < 2; i++) {
    double before_V = point.voltage_V;
    assert_int_equal(dea_solid_continuation_step(ctx, trace, &point), DEA_OK);
    assert_int_equal(point.unstable_modes, 1);
    assert_true(point.voltage_V > before_V && point.voltage_V > limit.voltage_V);
  }
  dea_solid_continuation_destroy(ctx, trace);
  // from there a solve leaves for one of the two stable arms
  assert_int_equal(dea_load_steps_solve(ctx, solid, point.voltage_V, &report), DEA_OK);
  assert_true(report.snapped);
  assert_int_equal(report.unstable_modes, 0);
  dea_free(ctx, push);
  destroy();
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_model_goes_to_the_side_asked_for),
      cmocka_unit_test(test_onset_without_fibres),
      cmocka_unit_test(test_path_from_rest_goes_down),
      cmocka_unit_test(test_other_arm_ends_at_a_limit_point),
  };
  return cmocka_run_group_tests(tests, solid_set_up, solid_tear_down);
}
