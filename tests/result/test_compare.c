/* dea compare and dea plot, as a user runs them. */
// ctest: quick, heavy
#include "command.h"
#include "fake_result.h"
#include "job/run_folder.h"

#include <jansson.h>

/* A run folder `name` with voltages scaled; without axisymmetric for one model only. */
static void make_run(const char *name, double scale)
{
  struct dea_context *ctx;
  struct dea_design design = fake_design();
  struct dea_result *result = NULL;
  const struct dea_run_folder_options options = {.no_figures = true};
  char path[600];
  snprintf(path, sizeof path, "%s/%s", command_folder, name);
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  assert_int_equal(fake_result(ctx, &design, scale, &result), DEA_OK);
  assert_int_equal(dea_run_folder_write(ctx, result, path, &options), DEA_OK);
  dea_result_destroy(ctx, result);
  dea_context_destroy(ctx);
}

static int set_up(void **state)
{
  if (command_set_up(state) != 0) {
    return -1;
  }
  make_run("a", 1.0);
  make_run("b", 1.05);
  return 0;
}

static bool exists(const char *name)
{
  char path[600];
  snprintf(path, sizeof path, "%s/%s", command_folder, name);
  return access(path, F_OK) == 0;
}

TEST(test_a_run_is_equal_to_itself)
{
  command_prints("compare a a --tolerance 0%", 0, "lumped");
  assert_contains(command_out, "axisymmetric", "electrode stretch");
}

TEST(test_the_exit_code_tells_a_difference)
{
  assert_int_equal(command_run("compare a b"), 0); // no tolerance, no judgement
  command_expect("compare a b --tolerance 1%", 1, "more than 1 %");
  assert_contains(command_out, "out of tolerance");
  assert_int_equal(command_run("compare a b --tolerance 0.9 --quantity electrode_stretch"), 0);
  assert_int_equal(command_run("compare a b --tolerance 1 --quantity electrode_stretch "
                               "--quantity centre_z_m --model lumped"),
                   0);
}

TEST(test_json_has_the_numbers)
{
  // The table's z is the model's plus 10 um: a - b is -10 um at each voltage.
  command_write("t.csv", "V (kV),z centre (um),z centre std (um)\n0,10,2\n");
  assert_int_equal(command_run("compare a t.csv --json --quantity centre_z_m --tolerance 5%"), 1);
  json_t *root = json_loads(command_out, 0, NULL);
  assert_non_null(root);
  const json_t *one = json_array_get(json_object_get(root, "comparisons"), 0);
  const json_t *q = json_array_get(json_object_get(one, "quantities"), 0);
  assert_string_equal(json_string_value(json_object_get(q, "quantity")), "centre_z_m");
  assert_close(json_number_value(json_object_get(q, "bias")), -10e-6, 1e-9, 0);
  assert_close(json_number_value(json_object_get(q, "relative_largest")), 1.0, 1e-9, 0);
  assert_true(json_is_false(json_object_get(q, "within")));
  json_decref(root);
}

TEST(test_one_model_against_another)
{
  command_prints("compare a a --model lumped:axisymmetric --tolerance 0.1%", 1, "a, lumped");
  assert_contains(command_out, "a, axisymmetric");
  command_expect("compare a a --model 3d", 2,
                 "no curve of model '3d' (it has: lumped, axisymmetric)");
}

TEST(test_misfit_figures_are_drawn)
{
  command_write("t.csv", "V (kV),z centre (um),z centre std (um),strain\n0,10,2,1\n");
  assert_int_equal(command_run("compare a t.csv -o fig"), 5); // 'strain' is not known
  assert_contains(command_err, "t.csv:1:40: error:");
  command_write("t.csv", "V (kV),z centre (um),z centre std (um)\n0,10,2\n1,1500,\n2,2500,100\n");
  assert_int_equal(command_run("compare a t.csv -o fig --format svg,png"), 0);
  assert_true(exists("fig/compare_centre_z_m.svg"));
  assert_true(exists("fig/compare_centre_z_m.png"));
  assert_true(exists("fig/compare_centre_z_m.dat"));
  assert_string_equal(command_err, "");
}

/* A run of a device made of plies, with a hub that rises by scale x 1 um at each kV, does not turn,
 * and stands secondary by less than the solver knows; slack from 2 kV on. */
static void make_device_run(const char *name, double scale)
{
  static const struct dea_column columns[] = {
      {"the_hub_x_m", "m", "um", 1e6, "the hub x", "displacement along x"},
      {"the_hub_z_m", "m", "um", 1e6, "the hub z", "displacement out of the plane"},
      {"the_hub_z_error_m", "m", "um", 1e6, "error of the hub z", "estimated error"},
      {"gauge_stretch", "1", "1", 1, "gauge stretch", "of a line"}};
  struct dea_arena memory = {0};
  int numbers[4];
  const struct dea_run_folder_options options = {.no_figures = true};
  struct dea_design design = fake_design();
  struct dea_context *ctx;
  struct dea_result *result = NULL;
  struct dea_curve *sweep;
  char path[600];
  snprintf(path, sizeof path, "%s/%s", command_folder, name);
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  assert_int_equal(dea_result_create(ctx, &design, NULL, &result), DEA_OK);
  assert_int_equal(dea_provenance_fill(ctx, "x", 1, NULL, 0, "dea run x", &result->provenance), 0);
  assert_int_equal(dea_result_add_curve(ctx, result, "3d", "sweep", &sweep), DEA_OK);
  memory.ctx = ctx;
  for (int i = 0; i < 4; i++) {
    assert_int_equal(dea_column_add(ctx, &columns[i], &numbers[i]), DEA_OK);
  }
  for (int i = 0; i <= 4; i++) {
    const double V = 1e3 * i;
    struct dea_load_point point = dea_load_point_empty();
    point.voltage_V = V;
    point.energy_J = -1e-6 * i;
    point.own_flags = i > 1 ? 1u << DEA_FLAG_STATES : 0;
    point.monitors = dea_monitor_values_create(&memory, numbers, 4);
    dea_point_set(&point, numbers[0], (i - 2) * scale * 1e-15);
    dea_point_set(&point, numbers[1], i * scale * 1e-6);
    dea_point_set(&point, numbers[2], 1e-9);
    dea_point_set(&point, numbers[3], 1.25);
    assert_int_equal(dea_curve_add_point(ctx, sweep, &point), DEA_OK);
  }
  dea_arena_free(&memory);
  assert_int_equal(dea_run_folder_write(ctx, result, path, &options), DEA_OK);
  dea_result_destroy(ctx, result);
  dea_context_destroy(ctx);
}

/* Monitors are compared as quantities of all devices are: misfits in their units, the tolerance,
 * figures with doubtful points dashed. What is rounding is left out. */
TEST(test_monitors)
{
  make_device_run("once", 1);
  make_device_run("twice", 2);
  assert_int_equal(command_run("compare once twice --json --tolerance 60%"), 0);
  json_t *root = json_loads(command_out, 0, NULL);
  const json_t *one = json_array_get(json_object_get(root, "comparisons"), 0);
  const json_t *all = json_object_get(one, "quantities");
  assert_int_equal(json_array_size(all), 3); // the energy, the hub's z, the gauge
  const json_t *hub = json_array_get(all, 1), *gauge = json_array_get(all, 2);
  assert_string_equal(json_string_value(json_object_get(hub, "quantity")), "the_hub_z_m");
  assert_string_equal(json_string_value(json_object_get(hub, "unit")), "m");
  assert_close(json_number_value(json_object_get(hub, "largest")), 4e-6, 1e-9, 0);
  assert_close(json_number_value(json_object_get(hub, "largest_at_V")), 4e3, 1e-9, 0);
  assert_close(json_number_value(json_object_get(hub, "relative_largest")), 0.5, 1e-9, 0);
  assert_true(json_is_true(json_object_get(hub, "within")));
  assert_string_equal(json_string_value(json_object_get(gauge, "quantity")), "gauge_stretch");
  assert_close(json_number_value(json_object_get(gauge, "largest")), 0, 0, 0);
  json_decref(root);
  command_expect("compare once twice --tolerance 40%", 1,
                 "the_hub_z_m of once, 3d differs by 50 % of its range, more than 40 %");
  assert_contains(command_out, "  the hub z (um)                  5 ", "out of tolerance");
  assert_int_equal(command_run("compare once twice --quantity 'gauge.stretch' --tolerance 0 -o m"),
                   0);
  assert_null(strstr(command_out, "energy"));
  assert_null(strstr(command_out, "hub"));
  assert_true(exists("m/compare_gauge_stretch.svg"));
  assert_false(exists("m/compare_energy_J.svg"));
  command_expect("compare once twice --quantity hub.z_m", 2, "'hub.z_m' is not a quantity");
  assert_int_equal(command_run("compare once twice -o pair"), 0);
  static char text[COMMAND_TEXT_MAX];
  command_read("pair/compare_the_hub_z_m.gp", text);
  assert_contains(text, "The hub z (\302\265m)", "not to be trusted");
  assert_null(
      strstr(text, "set ytics 0.5\n")); // of what is to be trusted, not of all that is drawn
  command_prints("compare once once twice -o three", 0, "\nthe hub z (um) ");
  assert_true(exists("three/compare_the_hub_z_m.svg"));
}

TEST(test_errors_of_the_command_line)
{
  assert_int_equal(command_run("compare a"), 2);
  command_expect("compare a b --quantity centre_z", 2, "did you mean 'centre_z_m'");
  assert_int_equal(command_run("compare a b --tolerance -3"), 2);
  assert_int_equal(command_run("compare a b --tolerance x"), 2);
  assert_int_equal(command_run("compare a b --nonsense"), 2);
  command_expect("compare a missing", 5, "missing");
  command_write("far.csv", "V (kV),z centre (um)\n90,1\n");
  command_expect("compare a far.csv", 2, "nothing to compare");
  command_write("far.csv", "V (kV),z centre (um)\n1,1000\n90,1\n");
  command_expect("compare a far.csv", 0,
                 "1 of 2 measured points of 'z centre' lie outside the voltages");
}

TEST(test_plot_draws_again)
{
  assert_int_equal(command_run("plot a --figure stretch --format svg"), 0);
  assert_true(exists("a/figures/stretch.svg"));
  assert_false(exists("a/figures/force.svg"));
  assert_int_equal(command_run("plot a/results.h5 -o other --format svg,pdf,png --width 170"), 0);
  assert_true(exists("other/profile.pdf"));
  assert_true(exists("other/field.png"));
  command_expect("plot a --figure strech", 2, "did you mean 'stretch'");
  assert_int_equal(command_run("plot a --format jpg"), 2);
  assert_int_equal(command_run("plot a --width 12"), 2);
  assert_int_equal(command_run("plot"), 2);
  assert_int_equal(command_run("plot nowhere"), 5);
}

TESTS(set_up, command_tear_down)
