/* The designs of examples/devices, computed, against numbers from elsewhere. */
// ctest: solid, nightly
#include "device/device.h"
#include "model/model.h"
#include "result/result.h"
#include "study/design_file.h"
#include "study/study.h"
#include "testing.h"

#include <math.h>
#include <stdio.h>

#include "context_fixture.h" // after: its context shadows no name of the headers above

struct example {
  struct dea_design *design;
  struct dea_device *device;
  struct dea_model *model;
};

static struct example open_example(const char *name)
{
  struct example out;
  char path[512];
  snprintf(path, sizeof path, DEA_SOURCE_DIR "/examples/devices/%s.yaml", name);
  assert_int_equal(dea_design_read(ctx, path, NULL, 0, &out.design), DEA_OK);
  assert_int_equal(dea_device_build(ctx, out.design, &out.device), DEA_OK);
  assert_int_equal(dea_model_create(ctx, dea_model_find("3d"), out.design, out.device, &out.model),
                   DEA_OK);
  return out;
}

static void close_example(struct example *example)
{
  dea_model_find("3d")->destroy(ctx, example->model);
  dea_device_destroy(ctx, example->device);
  dea_design_destroy(ctx, example->design);
}

static struct dea_observation solve(const struct example *example, double voltage_V)
{
  struct dea_load_point point;
  struct dea_observation seen;
  assert_int_equal(dea_model_find("3d")->solve(ctx, example->model, voltage_V, &point), DEA_OK);
  assert_int_equal(dea_model_find("3d")->observe(ctx, example->model, &seen), DEA_OK);
  return seen;
}

/* Each quadrant has a source of its own: with the voltages the tilt goes a quarter round in a
 * quarter of a cycle, and the tables say what was played. */
TEST(test_quadrants_round)
{
  static const struct dea_override changes[] = {
      {"compute.transient.until", "0.25 s"},
      {"compute.transient.tolerance", "0.01"},
      {"compute.transient.longest_step", "0.125 s"},
  };
  static const char *const names[] = {"transient"};
  struct example round = {NULL, NULL, NULL};
  struct dea_result *result;
  const char *path = DEA_SOURCE_DIR "/examples/devices/quadrants-round.yaml";
  assert_int_equal(dea_design_read(ctx, path, changes, 3, &round.design), DEA_OK);
  assert_int_equal(dea_device_build(ctx, round.design, &round.device), DEA_OK);
  assert_int_equal(dea_result_create(ctx, round.design, round.device, &result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, dea_model_find("3d"), names, 1, result), DEA_OK);
  static const char *const turns[] = {"plate_turn_x_rad", "plate_turn_y_rad"};
  static const char *const channels[] = {"east_voltage_V", "north_voltage_V", "west_voltage_V",
                                         "south_voltage_V"};
  const struct dea_curve *curve = dea_result_find(result, "3d", "transient");
  assert_true(curve != NULL && curve->count >= 4); // rest, the jump, steps
  double turn[2][2];
  for (int k = 0; k < 2; k++) { // after the jump, and at the end
    const struct dea_load_point *p = &curve->points[k == 0 ? 1 : curve->count - 1];
    assert_close(p->time_s, 0.25 * k, 1e-12, 0);
    for (size_t i = 0; i < 2; i++) {
      turn[k][i] = dea_point_get(p, dea_column_find(ctx, turns[i]));
    }
    for (size_t c = 0; c < 4; c++) { // east leads, a quarter each
      double V = 2e3 + 2e3 * cos(0.5 * acos(-1.0) * ((double)k - (double)c));
      assert_close(dea_point_get(p, dea_column_find(ctx, channels[c])), V, 1e-9, 1e-6);
    }
  }
  double size = hypot(turn[0][0], turn[0][1]);
  assert_true(size > 5e-4);
  assert_close(turn[1][0], -turn[0][1], 0, 5e-3 * size);
  assert_close(turn[1][1], turn[0][0], 0, 5e-3 * size);
  dea_result_destroy(ctx, result);
  dea_device_destroy(ctx, round.device);
  dea_design_destroy(ctx, round.design);
}

/* The film on a flexible frame curls when it is let go, and opens with the voltage. */
TEST(test_gripper)
{
  struct example gripper = open_example("gripper");
  double closed = solve(&gripper, 0).monitor[0][DEA_OBSERVED_Z];
  double open = solve(&gripper, 4e3).monitor[0][DEA_OBSERVED_Z];
  assert_true(closed > 5e-4);
  assert_true(open < 0.95 * closed && open > 0);
  close_example(&gripper);
}

TESTS(context_set_up, context_tear_down)
