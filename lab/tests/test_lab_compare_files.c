/* dea compare with what dea reduce writes: figures with bands, files that are wrong, failing
 * allocations. */
// ctest: quick, heavy
#include "compare/compare_set.h"
#include "failing_allocator.h"
#include "measured_run.h"

TEST(test_all_curves_are_in_one_figure)
{
  static char text[COMMAND_TEXT_MAX];
  assert_int_equal(command_run("compare run run2 red --model lumped --model 3d -o fig "
                               "--format svg,png"),
                   0);
  command_read("fig/compare_centre_z_m.dat", text);
  static const char *const titles[] = {"\302\261 1 std", "run, lumped", "run, 3d",
                                       "run2, lumped",   "run2, 3d",    "measured"};
  for (int k = 0; k < 6; k++) { // the band first, the points last: above all else
    char head[80];
    snprintf(head, sizeof head, "# index %d: %s\n", k, titles[k]);
    assert_contains(text, head);
  }
  assert_contains(text, "\n2 179 201\n4 409 431\n6 559 581\n"); // +- 11 um
  assert_contains(text, "\n2 190\n4 420\n6 570\n");
  command_read("fig/compare_centre_z_m.gp", text);
  assert_contains(text, "using 1:2:3 axes x1y1 with filledcurves");
  command_read("fig/compare_force_N.dat", text); // no std: no band
  assert_null(strstr(text, "1 std"));
  command_read("fig/compare_profile.dat", text);
  assert_contains(text, "between fibres");
  command_read("fig/compare_history_centre_z_m.png", text);
  command_read("fig/compare_profile.svg", text);
  // Points in no order have bars in place of a band.
  command_folder_make("loop");
  command_write("loop/measurement.csv", "V (kV),z centre (um),z centre std (um)\n1,99,2\n2,190,3\n"
                                        "1,110,2\n");
  assert_int_equal(command_run("compare run loop -o loopfig"), 0);
  command_read("loopfig/compare_centre_z_m.gp", text);
  assert_contains(text, "with yerrorbars");
  assert_null(strstr(text, "filledcurves"));
}

/* Of a pair the model is drawn whole, also where nothing was measured. */
TEST(test_pair_shows_the_whole_model)
{
  static char text[COMMAND_TEXT_MAX];
  double last_kV = 0;
  command_write("few.csv", "V (kV),z centre (um),z centre std (um)\n2,190,3\n4,420,5\n");
  assert_int_equal(command_run("compare run few.csv --model 3d -o pair"), 0);
  command_read("pair/compare_centre_z_m.dat", text);
  assert_contains(text, "\n2 187 193\n4 415 425\n"); // the band
  const char *curve = strstr(text, ": run, 3d\n");
  assert_non_null(curve);
  for (curve = strchr(strchr(curve, '\n') + 1, '\n') + 1; *curve != '\n';
       curve = strchr(curve, '\n') + 1) {
    last_kV = strtod(curve, NULL);
  }
  assert_true(last_kV > 4);
}

/* Writes folder bad with a file of that text, compares, and looks for the message. */
static void is_bad(const char *name, const char *text, const char *message)
{
  char path[80];
  command_write("bad/measurement.csv", points);
  command_write("bad/profiles.csv", "V (kV),x (mm),z (um)\n2,0,1\n");
  command_write("bad/history.csv", "time (s)\n0\n");
  snprintf(path, sizeof path, "bad/%s", name);
  command_write(path, text);
  command_expect("compare run bad", 5, message);
}

TEST(test_bad_files_with_their_places)
{
  command_folder_make("bad");
  is_bad("measurement.csv", "V (kV),z centre (um)\n1,x\n",
         "measurement.csv:2:3: error: 'x' is not");
  is_bad("measurement.csv", "z centre (um)\n1\n",
         "measurement.csv:1:1: error: no column such as 'V (kV)'");
  is_bad("profiles.csv", "V (kV),x (mm),z (um)\n2,0,1\n2,1,abc\n",
         "profiles.csv:3:5: error: 'abc' is not a number");
  is_bad("profiles.csv", "V (kV),x (mm),z (um)\n2,0,1\n2,2,1\n2,1,1\n",
         "profiles.csv:4:1: error: x does not rise");
  is_bad("profiles.csv", "V (kV),z (um)\n2,0\n",
         "profiles.csv:1:1: error: no column such as 'x (mm)'");
  is_bad("profiles.csv", "V (kV),x (kV),z (um)\n2,0,1\n",
         "profiles.csv:1:8: error: the unit in 'x (kV)' does not fit");
  is_bad("profiles.csv", "V (kV),x,z (um)\n2,0,1\n",
         "profiles.csv:1:8: error: 'x' needs a unit in parentheses, for example 'x (mm)'");
  is_bad("profiles.csv", "V (kV),x (mm),x (mm),z (um)\n2,0,1,1\n",
         "profiles.csv:1:15: error: 'x (mm)' is there twice");
  is_bad("profiles.csv", "V (kV),x (mm),z (um)\n2,0,1,7\n",
         "more fields than the header, which has 3");
  is_bad("profiles.csv", "V (kV),x (mm),z (um)\n2,0\n", "fewer fields than the header");
  is_bad("profiles.csv", "V (kV),x (mm),z (um)\n2,,1\n", "profiles.csv:2:3: error: a row without");
  is_bad("profiles.csv", "# nothing\n", "no rows of numbers");
  is_bad("profiles.csv", "", "no rows of numbers");
  is_bad("history.csv", "time (s),V (kV)\n1,1\n0,1\n", "history.csv:3:1: error: the time falls");
  is_bad("history.csv", "V (kV)\n1\n", "history.csv:1:1: error: no column such as 'time (s)'");
  is_bad("history.csv", "time (s)\n0\n1e999\n", "history.csv:3:1: error: '1e999' is not a number");
  command_write("bad/profiles.csv", "V (kV),x (mm),z (um),colour\n2,0,1,7\n");
  command_write("bad/history.csv", "time (s)\n0\n");
  command_expect("compare run bad", 0, "profiles.csv:1:22: note: column 'colour' is not used");
  command_folder_make("empty");
  assert_int_equal(command_run("compare run empty"), 5);
}

TEST(test_many_errors_are_cut)
{
  FILE *file = open_table("bad/history.csv");
  fputs("time (s),V (kV)\n", file);
  for (int i = 0; i < 1000; i++) {
    fprintf(file, "%d,x\n", i);
  }
  fclose(file);
  command_expect("compare run bad", 5, "history.csv:21:4");
  assert_null(strstr(command_err, "history.csv:23:"));
}

/* Adds a model to a set. */
static dea_status add_model(struct dea_context *ctx, struct dea_compare_set *set,
                            const struct dea_result *result, const char *model)
{
  struct dea_set_curve curve = {.result = result, .model = model};
  snprintf(curve.name, sizeof curve.name, "%s", model);
  return dea_compare_set_add(ctx, set, &curve, "");
}

/* Reading, computing and JSON with failing allocations. */
static void compare_once(struct dea_context *ctx)
{
  char path[600];
  struct dea_measured *measured = NULL;
  struct dea_compare_set set = {.reference = "small", .memory = {.ctx = ctx}};
  struct dea_result *result = NULL;
  struct dea_design design = fake_design();
  snprintf(path, sizeof path, "%s/small", command_folder);
  dea_status status = dea_measured_read(ctx, path, &measured);
  status = status == DEA_OK ? known_result(ctx, &design, &result) : status;
  set.measured = measured;
  status = status == DEA_OK ? add_model(ctx, &set, result, "3d") : status;
  status = status == DEA_OK ? add_model(ctx, &set, result, "lumped") : status;
  status = status == DEA_OK ? dea_compare_set_compute(ctx, &set, NULL, 0) : status;
  failing_check(ctx, status);
  dea_arena_free(&set.memory);
  dea_result_destroy(ctx, result);
  dea_measured_destroy(ctx, measured);
}

/* Two runs with monitors: here a run and itself. */
static void compare_monitors_once(struct dea_context *ctx)
{
  static const struct dea_column hub = {"hub_z_m", "m", "um", 1e6, "hub z", "displacement"};
  struct dea_compare_set set = {.reference = "it", .memory = {.ctx = ctx}};
  struct dea_result *result = NULL;
  struct dea_design design = fake_design();
  int column;
  dea_status status = known_result(ctx, &design, &result);
  status = status == DEA_OK ? dea_column_add(ctx, &hub, &column) : status;
  struct dea_curve *sweep = NULL;
  status = status == DEA_OK ? dea_result_get_curve(ctx, result, "3d", "sweep", &sweep) : status;
  struct dea_arena memory = {.ctx = ctx};
  for (size_t i = 0; sweep != NULL && i < sweep->count && status == DEA_OK; i++) {
    sweep->points[i].monitors = dea_monitor_values_create(&memory, &column, 1);
    status = dea_arena_status(&memory);
    dea_point_set(&sweep->points[i], column, 1e-6);
  }
  set.reference_result = result;
  status = status == DEA_OK ? add_model(ctx, &set, result, "3d") : status;
  status = status == DEA_OK ? dea_compare_set_compute(ctx, &set, NULL, 0) : status;
  if (status == DEA_OK) {
    assert_string_equal(set.misfits[set.misfit_count - 1].misfit.quantity->key, "hub_z_m");
  }
  failing_check(ctx, status);
  dea_arena_free(&set.memory);
  dea_result_destroy(ctx, result);
  dea_arena_free(&memory);
}

TEST(test_with_failing_allocations)
{
  command_folder_make("small");
  command_write("small/measurement.csv", points);
  command_write("small/profiles.csv", "V (kV),x (mm),z (um)\n2,0,20\n2,1,19\n4,0,40\n");
  command_write("small/history.csv", "time (s),V (kV),z centre (um)\n0,0,0\n1,6,600\n2,0,0\n");
  assert_true(failing_each(compare_once) > 60);
  assert_true(failing_each(compare_monitors_once) > 20);
}

/* A film driven below 0 is compared as one driven above it; noise about 0 is left as it is. */
TEST(test_negative_voltages)
{
  static char above[COMMAND_TEXT_MAX];
  command_folder_make("above");
  command_folder_make("below");
  command_write("above/measurement.csv", "V (kV),z centre (um)\n2,190\n4,420\n");
  command_write("above/profiles.csv", "V (kV),x (mm),z (um)\n2,0,20\n2,1,19\n4,0,40\n4,1,39\n");
  command_write("below/measurement.csv", "V (kV),z centre (um)\n-2,190\n-4,420\n");
  command_write("below/profiles.csv", "V (kV),x (mm),z (um)\n-2,0,20\n-2,1,19\n-4,0,40\n-4,1,39\n");
  assert_int_equal(command_run("compare run above --model 3d"), 0);
  snprintf(above, sizeof above, "%s", strstr(command_out, "\n\n"));
  assert_contains(above, "RMS");
  assert_null(strstr(command_err, "below 0"));
  assert_int_equal(command_run("compare run below --model 3d"), 0);
  assert_string_equal(strstr(command_out, "\n\n"), above);
  assert_contains(command_err, "below/measurement.csv: note: voltages below 0 stand at their size");
  char path[600];
  struct dea_context *ctx;
  struct dea_measured *measured;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  command_write("charge.csv", "V (kV),charge (nC)\n-1,-24\n1,25\n");
  snprintf(path, sizeof path, "%s/charge.csv", command_folder);
  assert_int_equal(dea_measured_read(ctx, path, &measured), DEA_OK);
  assert_int_equal(dea_measured_fold(ctx, measured), DEA_OK);
  const struct dea_load_point *folded = measured->points->curve.points;
  assert_close(folded[0].voltage_V, 1e3, 1e-12, 0);
  assert_close(folded[0].charge_C, 24e-9, 1e-12, 0);
  assert_close(folded[1].charge_C, 25e-9, 1e-12, 0);
  dea_measured_destroy(ctx, measured);
  dea_context_destroy(ctx);
  command_write("noise.csv", "V (kV),z centre (um)\n-0.001,1\n2,190\n4,420\n");
  assert_int_equal(command_run("compare run noise.csv --model 3d"), 0);
  assert_null(strstr(command_err, "below 0"));
}

TESTS(compare_set_up, command_tear_down)
