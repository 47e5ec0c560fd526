/* dea compare and dea plot, as a user runs them. */
// ctest: quick, heavy
#define _GNU_SOURCE // mkdtemp
#include "command.h"
#include "fake_result.h"
#include "output/run_folder.h"

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

static void test_a_run_is_equal_to_itself(void **state)
{
  (void)state;
  assert_int_equal(command_run("compare a a --tolerance 0%"), 0);
  assert_contains(command_out, "lumped");
  assert_contains(command_out, "axisymmetric");
  assert_contains(command_out, "electrode stretch");
}

static void test_the_exit_code_tells_a_difference(void **state)
{
  (void)state;
  assert_int_equal(command_run("compare a b"), 0); // no tolerance, no judgement
  assert_int_equal(command_run("compare a b --tolerance 1%"), 1);
  assert_contains(command_err, "more than 1 %");
  assert_contains(command_out, "out of tolerance");
  assert_int_equal(command_run("compare a b --tolerance 0.9 --quantity electrode_stretch"), 0);
  assert_int_equal(command_run("compare a b --tolerance 1 --quantity electrode_stretch "
                               "--quantity centre_z_m --model lumped"),
                   0);
}

static void test_json_has_the_numbers(void **state)
{
  (void)state;
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

static void test_one_model_against_another(void **state)
{
  (void)state;
  assert_int_equal(command_run("compare a a --model lumped:axisymmetric --tolerance 0.1%"), 1);
  assert_contains(command_out, "a, lumped");
  assert_contains(command_out, "a, axisymmetric");
  assert_int_equal(command_run("compare a a --model 3d"), 2);
  assert_contains(command_err, "no curve of model '3d' (it has: lumped, axisymmetric)");
}

static void test_misfit_figures_are_drawn(void **state)
{
  (void)state;
  command_write("t.csv", "V (kV),z centre (um),z centre std (um),strain\n");
  assert_int_equal(command_run("compare a t.csv -o fig"), 5); // 'strain' is not known
  assert_contains(command_err, "t.csv:1:40: error:");
  command_write("t.csv", "V (kV),z centre (um),z centre std (um)\n0,10,2\n1,1500,\n2,2500,100\n");
  assert_int_equal(command_run("compare a t.csv -o fig --format svg,png"), 0);
  assert_true(exists("fig/compare_centre_z_m.svg"));
  assert_true(exists("fig/compare_centre_z_m.png"));
  assert_true(exists("fig/compare_centre_z_m.dat"));
  assert_string_equal(command_err, "");
}

/* An uncertainty without name and unit has those of the column before it. */
static void test_uncertainty_of_the_column_before(void **state)
{
  (void)state;
  command_write("t.csv", "V (kV),z centre (mm),z centre err (mm)\n0,0,0.01\n1,1.5,0.2\n");
  assert_int_equal(command_run("compare a t.csv --json"), 0);
  char *named = strdup(command_out);
  assert_non_null(named);
  command_write("t.csv", "V (kV),Displacement (mm),err\n0,0,0.01\n1,1.5,0.2\n");
  assert_int_equal(command_run("compare a t.csv --json"), 0);
  assert_string_equal(command_out, named);
  free(named);
}

static void test_errors_of_the_command_line(void **state)
{
  (void)state;
  assert_int_equal(command_run("compare a"), 2);
  assert_int_equal(command_run("compare a b --quantity centre_z"), 2);
  assert_contains(command_err, "did you mean 'centre_z_m'");
  assert_int_equal(command_run("compare a b --tolerance -3"), 2);
  assert_int_equal(command_run("compare a b --tolerance x"), 2);
  assert_int_equal(command_run("compare a b --nonsense"), 2);
  assert_int_equal(command_run("compare a missing"), 5);
  assert_contains(command_err, "missing");
  command_write("far.csv", "V (kV),z centre (um)\n90,1\n");
  assert_int_equal(command_run("compare a far.csv"), 2);
  assert_contains(command_err, "nothing to compare");
  command_write("far.csv", "V (kV),z centre (um)\n1,1000\n90,1\n");
  assert_int_equal(command_run("compare a far.csv"), 0);
  assert_contains(command_err, "1 of 2 measured points of 'z centre' lie outside the voltages");
}

static void test_plot_draws_again(void **state)
{
  (void)state;
  assert_int_equal(command_run("plot a --figure stretch --format svg"), 0);
  assert_true(exists("a/figures/stretch.svg"));
  assert_false(exists("a/figures/force.svg"));
  assert_int_equal(command_run("plot a/results.h5 -o other --format svg,pdf,png --width 170"), 0);
  assert_true(exists("other/profile.pdf"));
  assert_true(exists("other/field.png"));
  assert_int_equal(command_run("plot a --figure strech"), 2);
  assert_contains(command_err, "did you mean 'stretch'");
  assert_int_equal(command_run("plot a --format jpg"), 2);
  assert_int_equal(command_run("plot a --width 12"), 2);
  assert_int_equal(command_run("plot"), 2);
  assert_int_equal(command_run("plot nowhere"), 5);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_a_run_is_equal_to_itself),
      cmocka_unit_test(test_the_exit_code_tells_a_difference),
      cmocka_unit_test(test_json_has_the_numbers),
      cmocka_unit_test(test_one_model_against_another),
      cmocka_unit_test(test_misfit_figures_are_drawn),
      cmocka_unit_test(test_uncertainty_of_the_column_before),
      cmocka_unit_test(test_errors_of_the_command_line),
      cmocka_unit_test(test_plot_draws_again),
  };
  return cmocka_run_group_tests(tests, set_up, command_tear_down);
}
