/* dea reduce: what it writes is what other programs, and dea compare, read. */
// ctest: quick, heavy
#include "failing_allocator.h"

#include "command.h"
#include "io/csv.h"
#include "lab_signals.h"
#include "reduce/output.h"

#include <stdbool.h>

static struct dea_context *own;

/* Three voltages of four cycles with everything that can be measured. */
static struct dea_recording bench(void)
{
  struct signal_bench b = signal_bench_plain();
  b.points = 200;
  b.rate_Hz = 1000.0;
  b.frame_Hz = 50.0;
  b.cycles = 4;
  b.level_count = 3;
  b.levels_V[0] = 2000.0;
  b.levels_V[1] = 4000.0;
  b.voltage = b.displacement = b.force = true;
  b.sigma = 2e-6;
  b.point_sigma = 4e-6;
  b.levels_V[2] = 6000.0;
  b.preload_N = 10e-3;
  struct dea_recording r = signal_record(&b, 5);
  size_t n = r.channels[0].count;
  struct dea_channel *current = signal_channel(&r, "current", DEA_CHANNEL_CURRENT, b.rate_Hz, n);
  uint64_t seed = 3;
  for (size_t i = 0; i < n; i++) {
    current->values[i] = 1e-8 * signal_normal(&seed) + (i == n / 2 + 70 ? 1e-6 : 0.0);
  }
  for (size_t c = 0; c < r.channel_count; c++) {
    snprintf(r.channels[c].unit, sizeof r.channels[c].unit, "%s",
             dea_channel_meanings[r.channels[c].kind].si_unit);
  }
  r.title = "bench";
  return r;
}

static int write_bench(void **state)
{
  char path[600];
  if (command_set_up(state) != 0 || dea_context_create(NULL, &own) != DEA_OK) {
    return -1;
  }
  struct dea_recording r = bench();
  snprintf(path, sizeof path, "%s/bench.h5", command_folder);
  dea_status status = dea_recording_write(own, &r, path);
  signal_free(&r);
  return status == DEA_OK ? 0 : -1;
}

static int remove_bench(void **state)
{
  dea_context_destroy(own);
  return command_tear_down(state);
}

#define RADII "--film-radius '15 mm' --electrode-radius 3.75mm --tip-radius '6 mm' "

static void read_measurement(const char *folder, struct dea_measurement **out)
{
  char path[640];
  snprintf(path, sizeof path, "%s/%s/measurement.csv", command_folder, folder);
  if (dea_measurement_read(own, path, out) != DEA_OK) {
    fail_msg("%s", dea_context_message(own));
  }
}

TEST(test_tables)
{
  command_prints("reduce bench.h5 " RADII "-o tables --format svg", 0, "6.000      4");
  assert_contains(command_out, "1 discharge: spikes above");
  struct dea_measurement *m;
  read_measurement("tables", &m);
  assert_int_equal(m->curve.count, 3);
  for (size_t i = 0; i < 3; i++) {
    double V = 2000.0 * (double)(i + 1), share = V * V / 36e6;
    const struct dea_load_point *p = &m->curve.points[i], *s = &m->std[i];
    assert_close(p->voltage_V, V, 0.0, 5.0);
    assert_close(p->centre_z_m, 300e-6 * share, 0.0, 3.0 * s->centre_z_m);
    assert_close(p->fibre_tip_z_m, 300e-6 * 0.8 * share, 0.0, 3.0 * s->fibre_tip_z_m);
    assert_close(p->force_N, 0.1 * share, 0.0, 3.0 * s->force_N);
    assert_true(s->centre_z_m > 0.3e-6 && s->centre_z_m < 3e-6);
  }
  dea_measurement_destroy(own, m);
  const char *const files[] = {"levels.csv",  "cycles.csv",    "profiles.csv",
                               "history.csv", "amplitude.svg", "profiles.svg",
                               "history.svg", "cycles.svg",    "reduction.json"};
  for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
    char name[64];
    snprintf(name, sizeof name, "tables/%s", files[i]);
    command_read(name, command_out);
    assert_true(strlen(command_out) > 300);
  }
  command_read("tables/history.csv", command_out);
  assert_contains(command_out, "time (s),V (kV),z centre (um),z fibre tip (um),force (mN)\n");
  double before_s = -1.0; // and times rise, also where the samples of two clocks meet
  for (const char *line = strstr(command_out, "(mN)\n") + 5; *line != '\0';
       line = strchr(line, '\n') + 1) {
    double time_s = strtod(line, NULL);
    assert_true(time_s > before_s);
    before_s = time_s;
  }
  assert_close(before_s, 25.0, 0.0, 0.01);
  command_read("tables/profiles.csv", command_out);
  assert_contains(command_out, "V (kV),x (mm),z (um),z std (um)\n");
  command_read("tables/discharges.csv", command_out);
  assert_contains(command_out, "discharge,");
}

TEST(test_json)
{
  assert_int_equal(command_run("reduce bench.h5 " RADII "-o json --json --format png"), 0);
  json_t *root = json_loads(command_out, 0, NULL);
  assert_non_null(root);
  assert_int_equal(json_integer_value(json_object_get(root, "schema")), 1);
  json_t *level = json_array_get(json_object_get(root, "levels"), 2);
  json_t *centre = json_object_get(level, "centre");
  assert_close(json_number_value(json_object_get(centre, "mean_m")), 300e-6, 0.02, 0.0);
  assert_close(json_number_value(json_object_get(root, "preload_N")), 10e-3, 0.01, 0.0);
  assert_int_equal(json_array_size(json_object_get(root, "cycles")), 12);
  assert_true(json_array_size(json_object_get(root, "notes")) > 0);
  assert_true(json_is_true(json_object_get(json_object_get(root, "levelling"), "by_frame")));
  json_decref(root);
}

/* An embedded or named design gives the radii; a reduction is not replaced by chance. */
TEST(test_design_and_folder)
{
  command_prints("reduce bench.h5 --design @/examples/frdea-4.yaml", 0, "fibre tips at");
  assert_contains(command_out, "bench.reduced");
  command_expect("reduce bench.h5", 5, "--force");
  command_expect("reduce bench.h5 --force --settle 10%", 0, "--tip-radius");
}

TEST(test_errors)
{
  const struct {
    const char *arguments, *says;
    int code;
  } all[] = {
      {"reduce", "give one recording", 2},
      {"reduce none.h5", "none.h5", 5},
      {"reduce bench.h5 --tip-radius 3", "3 mm", 2},
      {"reduce bench.h5 --tip-radius '-3 mm'", "more than 0", 2},
      {"reduce bench.h5 --settle 2", "such as 0.2", 2},
      {"reduce bench.h5 --format gif", "svg, pdf, png", 2},
      {"reduce bench.h5 --width 2", "40 to 400", 2},
      {"reduce bench.h5 --bright", "--bright", 2},
      {"reduce bench.h5 --design none.yaml -o none", "none.yaml", 5},
  };
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
    assert_int_equal(command_run(all[i].arguments), all[i].code);
    assert_contains(command_err, all[i].says);
  }
}

// Rows of the history ----------------------------------------------------------------------------

/* Thinned rows keep every edge: each sample between two others that differ from it is near a row.
 */
TEST(test_history_keeps_edges)
{
  struct dea_recording r = bench();
  struct dea_reduction *reduction;
  struct dea_reduced_series all, few;
  assert_int_equal(dea_reduce(own, &r, NULL, &reduction), DEA_OK);
  assert_int_equal(dea_reduced_series_fill(own, &r, reduction, 1000000, &all), DEA_OK);
  assert_int_equal(dea_reduced_series_fill(own, &r, reduction, 600, &few), DEA_OK);
  assert_false(all.thinned);
  assert_true(few.thinned);
  assert_true(few.rows <= 600 && few.rows > 300);
  size_t edges[2] = {0, 0};
  const struct dea_reduced_series *tables[2] = {&all, &few};
  for (int t = 0; t < 2; t++) {
    bool on = false;
    for (size_t i = 0; i < tables[t]->rows; i++) {
      double V = tables[t]->voltage_V[i];
      assert_true(i == 0 || tables[t]->time_s[i] > tables[t]->time_s[i - 1]);
      if (!isnan(V) && (V > 1500.0) != on) {
        on = !on;
        edges[t]++;
      }
    }
  }
  assert_int_equal(edges[0], 24); // of 12 cycles
  assert_int_equal(edges[1], edges[0]);
  dea_reduced_series_free(own, &few);
  dea_reduced_series_free(own, &all);
  dea_reduction_destroy(own, reduction);
  signal_free(&r);
}

/* The axis of a recording that did not begin at 0. */
TEST(test_history_from_its_begin)
{
  char path[600];
  const struct dea_plot_format none = {.width_m = 85e-3};
  struct dea_recording r = bench();
  struct dea_reduction *reduction;
  for (size_t c = 0; c < r.channel_count; c++) {
    r.channels[c].start_s += 3.5;
  }
  for (size_t f = 0; f < r.profiles.count; f++) {
    r.profiles.time_s[f] += 3.5;
  }
  snprintf(path, sizeof path, "%s/later", command_folder);
  assert_int_equal(dea_reduce(own, &r, NULL, &reduction), DEA_OK);
  assert_int_equal(dea_reduction_folder(own, path, true), DEA_OK);
  assert_int_equal(dea_reduction_write(own, &r, reduction, "test", &none, path), DEA_OK);
  command_read("later/history.gp", command_out);
  const char *range = strstr(command_out, "set xrange [");
  assert_non_null(range);
  char *end;
  assert_close(strtod(range + strlen("set xrange ["), &end), 3.5, 0, 0.05); // a stretch
  assert_close(strtod(end + 1, NULL), 28.5, 0, 0.05);
  dea_reduction_destroy(own, reduction);
  signal_free(&r);
}

/* Of ten voltages below 0, with rest, eight are shown, the largest among them and without rest. */
TEST(test_figures_of_negative_voltages)
{
  char path[600];
  const struct dea_plot_format none = {.width_m = 85e-3};
  struct signal_bench b = signal_bench_plain();
  b.points = 60;
  b.rate_Hz = 1000.0;
  b.frame_Hz = 50.0;
  b.cycles = 2;
  b.level_count = 10;
  b.voltage = true;
  for (size_t k = 0; k < b.level_count; k++) {
    b.levels_V[k] = -600.0 * (double)k;
  }
  struct dea_recording r = signal_record(&b, 5);
  struct dea_reduction *reduction;
  snprintf(path, sizeof path, "%s/negative", command_folder);
  assert_int_equal(dea_reduce(own, &r, NULL, &reduction), DEA_OK);
  assert_int_equal(dea_reduction_folder(own, path, true), DEA_OK);
  assert_int_equal(dea_reduction_write(own, &r, reduction, "test", &none, path), DEA_OK);
  command_read("negative/cycles.dat", command_out);
  assert_contains(command_out, "index 0: -5.4 kV", "index 7: ");
  assert_null(strstr(command_out, "index 8: "));
  assert_null(strstr(command_out, ": 0 kV"));
  const char *values = strchr(strchr(command_out, '\n') + 1, '\n') + 1;
  char *end;
  for (int k = 1; k <= 2; k++) { // each cycle has its amplitude
    assert_close(strtod(values, &end), k, 0, 0);
    assert_true(strtod(end, &end) > 10);
    values = end;
  }
  dea_reduction_destroy(own, reduction);
  signal_free(&r);
}

static struct dea_recording kept;
static char kept_folder[600];

static dea_status write_kept(struct dea_context *ctx)
{
  struct dea_reduction *reduction;
  const struct dea_plot_format none = {.width_m = 85e-3};
  DEA_TRY(ctx, dea_reduce(ctx, &kept, NULL, &reduction));
  dea_status status = dea_reduction_folder(ctx, kept_folder, true);
  if (status == DEA_OK) {
    status = dea_reduction_write(ctx, &kept, reduction, "test", &none, kept_folder);
  }
  dea_reduction_destroy(ctx, reduction);
  return status;
}

TEST(test_memory)
{
  struct signal_bench b = signal_bench_plain();
  b.rate_Hz = 20.0;
  b.frame_Hz = 5.0;
  b.points = 40;
  b.cycles = 2;
  b.force = true;
  kept = signal_record(&b, 1);
  snprintf(kept_folder, sizeof kept_folder, "%s/memory", command_folder);
  assert_true(failing_ends(write_kept, DEA_OK) > 100);
  signal_free(&kept);
}

TESTS(write_bench, remove_bench)
