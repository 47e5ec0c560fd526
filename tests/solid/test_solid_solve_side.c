/* The actuator without pre-stress: it buckles to either side. Model 3d goes to the side that is
 * asked for, and paths by arc-length say which one follows from 0 V: an imperfect pitchfork, whose
 * detached arm ends at a limit point. */
// ctest: solid
#include "devices.h"
#include "model/model.h"
#include "model/solid/actuator/disc_mesh.h"
#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/model3d/buckling_branch.h"
#include "model/solid/model3d/solid_model.h"
#include "testing.h"

#include "solid_fixture.h" // after: its context shadows no name of the headers above

extern const struct dea_model_type dea_solid_module;

static struct dea_device slack(int fibres, enum dea_outer_end end)
{
  struct dea_device star = test_star(fibres);
  star.pre_stretch = 1;
  star.film_thickness_m = star.film_thickness_unstretched_m;
  star.outer_end = end;
  star.fibre_outer_gap_m = end == DEA_END_FREE ? 1e-3 : 0;
  return star;
}

/* ---- the model ---- */

enum { VOLTAGES = 3 };
static const double voltage_kV[VOLTAGES] = {0.5, 2, 0.5};

static void sweep(enum dea_buckling_branch side, struct dea_load_point points[VOLTAGES])
{
  struct dea_device buckling = slack(4, DEA_END_CLAMPED);
  struct dea_model *model;
  const struct dea_model_settings settings = {.buckling_branch = side};
  assert_int_equal(dea_solid_module.create(ctx, &buckling, &settings, &model), DEA_OK);
  for (int i = 0; i < VOLTAGES; i++) {
    assert_ok(dea_solid_module.solve(ctx, model, 1e3 * voltage_kV[i], &points[i]));
    assert_int_equal(points[i].unstable_modes, 0);
  }
  dea_solid_module.destroy(ctx, model);
}

/* Where there is one state only, all find it; above the onset each has its own. Down is the side
 * that follows from 0 V. */
TEST(test_model_goes_to_the_side_asked_for)
{
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

/* Free fibres rise as a whole with the film, in a sweep and at once. The centre, as another
 * program has found it; at 0.7 kV, 0.15 kV above the onset, it has 125 um, where ours converges to
 * 139 um with the mesh (docs/verification/branches.md). */
TEST(test_free_fibres_rise_with_the_film)
{
  static const struct {
    int fibres;
    double voltage_V, centre_m;
  } wanted[] = {{4, 2000, 627e-6}, {8, 3000, 926e-6}, {8, 4000, 1190e-6}, {8, 5000, 1439e-6}};
  const struct dea_model_settings settings = {.buckling_branch = DEA_BRANCH_FIBRES};
  struct dea_model *model = NULL;
  struct dea_load_point point;
  struct dea_device star = slack(4, DEA_END_FREE);
  assert_int_equal(dea_solid_module.create(ctx, &star, &settings, &model), DEA_OK);
  assert_int_equal(dea_solid_module.solve(ctx, model, 600, &point), DEA_OK);
  assert_true(point.centre_z_m > 50e-6 && point.fibre_tip_z_m > 50e-6);
  for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
    if (wanted[i].fibres != star.fibre_count) {
      dea_solid_module.destroy(ctx, model);
      star = slack(wanted[i].fibres, DEA_END_FREE);
      assert_int_equal(dea_solid_module.create(ctx, &star, &settings, &model), DEA_OK);
    }
    assert_int_equal(dea_solid_module.solve(ctx, model, wanted[i].voltage_V, &point), DEA_OK);
    assert_int_equal(point.unstable_modes, 0);
    assert_close(point.centre_z_m, wanted[i].centre_m, 3e-2, 0);
    assert_true(point.lowest_z_m > -1e-6 && point.fibre_tip_z_m > 0.3 * point.centre_z_m);
  }
  dea_solid_module.destroy(ctx, model);
}

/* ---- paths ---- */

static struct dea_device device;
static struct dea_model *made;
static struct dea_layout_mesh mesh;
static const struct dea_grid *grid;
static struct dea_solid *solid;
static size_t centre;

static void create(int fibres, enum dea_outer_end end)
{
  device = slack(fibres, end);
  assert_ok(dea_solid_module.create(ctx, &device, &(struct dea_model_settings){0}, &made));
  solid = ((const struct dea_model *)made)->solid;
  assert_ok(dea_device_mesh_create(ctx, &device, &(struct dea_model_settings){0}, &mesh));
  grid = mesh.grid; // as the model has it
  centre = dea_grid_nearest(grid, (const double[3]){0});
}

static void destroy(void)
{
  dea_solid_module.destroy(ctx, made);
  dea_layout_mesh_free(ctx, &mesh);
}

static double centre_z(void)
{
  return dea_solid_displacement(solid)[3 * centre + 2];
}

static struct dea_solid_continuation *trace_to(double voltage_V, double step)
{
  const struct dea_continuation_options options = {step, 0.5, 100e-6, false};
  struct dea_solid_continuation *trace;
  assert_int_equal(dea_solid_continuation_create(ctx, solid, voltage_V, &options, &trace), DEA_OK);
  return trace;
}

/* Stable all the way, without a limit point, and the same as a sweep. The two arms pass close by
 * each other: steps twice as long can jump to the other one. */
TEST(test_path_from_rest_goes_down)
{
  struct dea_continuation_point point = {0};
  struct dea_solid_report report;
  create(4, DEA_END_CLAMPED);
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

static bool take_front(struct dea_solid_report *report)
{
  const struct dea_film_band film = {0, device.film_thickness_m};
  bool moved;
  assert_ok(dea_buckling_branch_select(ctx, solid, grid, &film, DEA_BRANCH_FIBRES, report, &moved));
  return moved;
}

/* Onto the other arm at 1 kV, and down with the voltage: at a limit point between 0.7 and 1 kV it
 * turns to an arm with one unstable mode, on which the voltage rises again. */
TEST(test_other_arm_ends_at_a_limit_point)
{
  struct dea_continuation_point point = {0}, limit = {0};
  struct dea_solid_report report;
  create(4, DEA_END_CLAMPED);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 500, &report), DEA_OK);
  assert_false(take_front(&report)); // one state only, and the solid is still there
  assert_true(centre_z() < 0);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 1000, &report), DEA_OK);
  assert_true(take_front(&report));
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
  destroy();
}

static bool centre_above(const void *self, const double *u)
{
  return u[3 * centre + 2] > 0;
}

/* Eight free fibres that hang, with a dimple at the centre that stands up, are a stable state: not
 * the one towards the fibres, which has less energy. A push inside the electrode finds the one, the
 * mirror image the other. */
TEST(test_dimple_is_not_the_other_arm)
{
  struct dea_solid_report report;
  bool found;
  create(8, DEA_END_FREE);
  double *push = dea_alloc(ctx, 3 * grid->node_count, sizeof *push);
  assert_non_null(push);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 3000, &report), DEA_OK);
  double hanging = centre_z();
  assert_true(hanging < 0);
  for (size_t n = 0; n < grid->node_count; n++) {
    double r = hypot(grid->X[3 * n], grid->X[3 * n + 1]) / 3.75e-3;
    push[3 * n + 2] = r < 1 ? (1e-4 - 2 * hanging) * (1 - r * r) * (1 - r * r) : 0;
  }
  assert_true(take_front(&report));
  assert_close(centre_z(), 926e-6, 3e-2, 0);
  assert_false(take_front(&report)); // there already
  double front = report.energy_J;
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 3000, &report), DEA_OK);
  assert_close(centre_z(), hanging, 1e-4, 0);
  assert_int_equal(dea_solid_perturb(ctx, solid, push, centre_above, NULL, &report, &found),
                   DEA_OK);
  assert_true(found && centre_z() < 1e-4 && report.energy_J > front);
  size_t tip = dea_grid_nearest(grid, (const double[3]){device.fibre_tip_radius_m, 0, 0});
  assert_true(dea_solid_displacement(solid)[3 * tip + 2] < -3e-4);
  dea_free(ctx, push);
  destroy();
}

TESTS(solid_set_up, solid_tear_down)
