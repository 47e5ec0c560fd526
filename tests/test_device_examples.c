/* The designs of examples/devices, computed, against numbers from elsewhere. */
// ctest: solid
#include "device/device.h"
#include "model/model.h"
#include "study/design_file.h"
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
  assert_int_equal(dea_model_find("3d")->of_layouts->observe(ctx, example->model, &seen), DEA_OK);
  return seen;
}

/* 20 g on the hub: membrane theory integrated by another program, without the film's own weight;
 * the solid film is stiffer by its clamped edges. */
static void test_cone(void **state)
{
  static const struct {
    double kV, h_mm;
  } table[] = {{0, 1.8179}, {3, 2.0871}, {5, 2.7982}};
  (void)state;
  struct example cone = open_example("cone-mass");
  for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
    struct dea_observation seen = solve(&cone, 1e3 * table[i].kV);
    assert_close(-1e3 * seen.monitor[0][DEA_OBSERVED_Z], table[i].h_mm, 0.015, 0);
  }
  close_example(&cone);
}

/* Ten films take up ten times what a plate capacitor of one would, at the area and the thickness
 * that the film has in the middle; where it is not stretched evenly a little more or less. */
static void test_stack(void **state)
{
  (void)state;
  struct example stack = open_example("stack-10");
  struct dea_observation seen = solve(&stack, 200);
  double area_stretch = seen.monitor[1][DEA_OBSERVED_AREA_STRETCH], h_m = 20e-6 / 1.44;
  double area_m2 = acos(-1.0) * 25e-6;
  const struct dea_material *film = &stack.device->layout->plies[0].material;
  double eps_r =
      film->permittivity.at_rest + film->permittivity.slope * (1.2 * sqrt(area_stretch) - 1);
  double charge = 10 * DEA_EPSILON_0 * eps_r * area_m2 * area_stretch * area_stretch / h_m * 200;
  assert_close(seen.channel[1].charge_C, charge, 1e-4, 0);
  close_example(&stack);
}

/* One quadrant driven: the plate tilts about the axis across it, away from the side that gives
 * way, and does not turn in the plane. */
static void test_quadrants(void **state)
{
  (void)state;
  struct example quadrants = open_example("quadrants");
  const double *plate = solve(&quadrants, 3e3).monitor[0];
  assert_true(fabs(plate[DEA_OBSERVED_TURN_Y]) > 3e-4);
  assert_true(fabs(plate[DEA_OBSERVED_TURN_X]) < 0.01 * fabs(plate[DEA_OBSERVED_TURN_Y]));
  assert_true(fabs(plate[DEA_OBSERVED_TURN_Z]) < 0.01 * fabs(plate[DEA_OBSERVED_TURN_Y]));
  // the driven side gives way to the force that lifts the plate: R(w) takes x up for w_y < 0
  assert_true(plate[DEA_OBSERVED_TURN_Y] < 0);
  close_example(&quadrants);
}

/* The film on a flexible frame curls when it is let go, and opens with the voltage. */
static void test_gripper(void **state)
{
  (void)state;
  struct example gripper = open_example("gripper");
  double closed = solve(&gripper, 0).monitor[0][DEA_OBSERVED_Z];
  double open = solve(&gripper, 4e3).monitor[0][DEA_OBSERVED_Z];
  assert_true(closed > 5e-4);
  assert_true(open < 0.95 * closed && open > 0);
  close_example(&gripper);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_cone),
      cmocka_unit_test(test_stack),
      cmocka_unit_test(test_quadrants),
      cmocka_unit_test(test_gripper),
  };
  return cmocka_run_group_tests(tests, context_set_up, context_tear_down);
}
