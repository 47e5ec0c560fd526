/* The reduction where there is little, or something is wrong with it. */
#include "failing_allocator.h"

#include "lab_reduced.h"
#include "reduce/output.h"

TEST(test_clipped_sensor_is_said)
{
  struct signal_bench b = signal_bench_plain();
  b.displacement = true;
  b.sigma = 1e-6;
  for (int k = 0; k < 2; k++) {
    record(&b, 1);
    for (size_t i = 0; i < r.channels[1].count && k == 1; i++) {
      r.channels[1].values[i] = fmin(r.channels[1].values[i], 250e-6);
    }
    reduce(&plain);
    assert_int_equal(noted("250 um, the end of its range"), k == 1);
    assert_int_equal(isnan(out->levels[0].mean[DEA_REDUCED_DISPLACEMENT]), k == 1);
  }
}

/* Few frames in a part, and an outlier in one of them that no neighbour shows. */
TEST(test_outlier_among_few_frames)
{
  struct signal_bench b = line_laser();
  b.frame_Hz = 20.0; // four are averaged
  b.cycles = 6;
  b.outliers = b.lost = 0.0;
  b.point_sigma = 2e-6;
  b.m_per_V2 = 4e-3 / 36e6; // steep: 0.36 mm/mm, up to an apex that is no outlier
  b.cone = 1.0;
  record(&b, 4);
  size_t frame = (size_t)((b.lead_s + 2.0 * b.cycle_s + 0.5 * b.cycle_s - 0.08) * b.frame_Hz);
  for (size_t i = 0; i < b.points; i++) { // the whole frame
    r.profiles.z_m[frame * b.points + i] +=
        fabs(r.profiles.x_m[i] - b.centre_m) < b.film_m ? 700e-6 : 0.0;
  }
  for (size_t f = 0; f < r.profiles.count; f++) { // and a point on the slope of each
    r.profiles.z_m[f * b.points + 60] -= 300e-6;
  }
  reduce(&plain);
  double apex = 4e-3 * signal_shape(&b, 0.0);
  assert_close(out->cycles[2].values[DEA_REDUCED_CENTRE].amplitude, apex, 0.0, 20e-6);
  assert_true(out->levelling.outliers >= r.profiles.count);
  assert_true(out->levelling.outliers < r.profiles.count + r.profiles.count / 4);
}

// Little or nothing ------------------------------------------------------------------------------

TEST(test_without_voltage)
{
  const struct dea_recording none = {.file = "", .title = ""};
  struct dea_reduction *reduction;
  assert_int_equal(dea_reduce(ctx, &none, NULL, &reduction), DEA_E_IO);
  assert_null(reduction);
  assert_non_null(strstr(dea_context_message(ctx), "no voltage"));
}

TEST(test_little)
{
  const size_t counts[] = {1, 2, 3, 9, 50};
  for (size_t k = 0; k < 5; k++) {
    for (int what = 0; what < 4; what++) {
      record_two(100.0, counts[k]);
      signal_channel(&r, "current", DEA_CHANNEL_CURRENT, 100.0, counts[k]);
      signal_channel(&r, "force", DEA_CHANNEL_FORCE, 100.0, counts[k]);
      for (size_t c = 0; c < r.channel_count; c++) {
        for (size_t i = 0; i < counts[k]; i++) {
          r.channels[c].values[i] = what == 0   ? 0.0
                                    : what == 1 ? 5000.0
                                    : what == 2 ? NAN
                                                : (double)(i % 2) * 4000.0;
        }
      }
      reduce(&plain);
      assert_true(what == 3 || out->cycle_count == 0);
      assert_true(out->cycle_count > 0 || noted("there are no cycles"));
      assert_int_equal(out->discharge_count, 0);
    }
  }
}

/* 4 samples a part: of the last fifth there is none, which is said; of the last 60 % two, which
 * tell no noise, so that the only cycle at 4 kV has no uncertainty of its own. In means.csv it has
 * that of the others, and they keep theirs. */
TEST(test_few_samples_and_a_single_cycle)
{
  enum { CYCLES = 7, COUNT = 8 * CYCLES + 4 };
  static const double expected[][2] = {{2, 200}, {4, 800}};
  record_two(4.0, COUNT);
  uint64_t seed = 1;
  for (size_t i = 0; i < COUNT; i++) {
    double level = i % 8 < 4 ? 0.0 : i / 8 + 1 == CYCLES ? 4.0 : 2.0;
    r.channels[0].values[i] = 1e3 * level;
    r.channels[1].values[i] = 50e-6 * level * level + 0.3e-6 * signal_normal(&seed);
  }
  reduce(&plain);
  assert_true(noted("'displacement' is formed: the last 20 %"));
  struct dea_reduce_options options = plain;
  options.settle = 0.6;
  reduce(&options);
  assert_false(noted("is formed"));
  char folder[] = "dea-little-XXXXXX", name[64], line[200];
  assert_non_null(mkdtemp(folder));
  assert_int_equal(dea_reduction_write_tables(ctx, &r, out, folder), DEA_OK);
  snprintf(name, sizeof name, "%s/means.csv", folder);
  FILE *file = fopen(name, "r");
  assert_non_null(file);
  size_t rows = 0;
  while (fgets(line, sizeof line, file) != NULL) {
    double kV, mean_um, std_um = NAN;
    if (sscanf(line, "%lf,%lf,%lf", &kV, &mean_um, &std_um) >= 2 && rows < 2) {
      assert_close(kV, expected[rows][0], 1e-6, 0.0);
      assert_close(mean_um, expected[rows][1], 0.0, 1.0);
      assert_true(std_um > 0.05 && std_um < 0.5);
      rows++;
    }
  }
  fclose(file);
  assert_int_equal(rows, 2);
  snprintf(line, sizeof line, "rm -r '%s'", folder);
  assert_int_equal(system(line), 0);
}

/* The amplifier's input in place of what was asked, one of the other sign, and one that was not
 * used: the measured voltage tells the cycles, and no breakdown. */
TEST(test_asked_voltage_of_something_else)
{
  static const double factors[] = {1.0, 1e-3, -1.0, 0.0};
  for (size_t k = 0; k < 4; k++) {
    struct signal_bench b = signal_bench_plain();
    b.voltage = true;
    b.list = false;
    record(&b, 1);
    const struct dea_channel *asked = dea_recording_kind(&r, DEA_CHANNEL_COMMAND);
    struct dea_channel *a =
        signal_channel(&r, "current", DEA_CHANNEL_CURRENT, b.rate_Hz, asked->count);
    uint64_t seed = 3;
    for (size_t i = 0; i < asked->count; i++) {
      a->values[i] = 1e-12 * asked->values[i] + 1e-10 * signal_normal(&seed);
      asked->values[i] *= factors[k];
    }
    reduce(&plain);
    assert_int_equal(noted("the measured one is taken for both"), k > 0);
    assert_int_equal(out->cycle_count, b.cycles);
    assert_int_equal(out->level_count, 1);
    for (size_t d = 0; d < out->discharge_count; d++) {
      assert_int_equal(out->discharges[d].kind, DEA_DISCHARGE);
    }
  }
}

/* Of two lasers the first is reduced, and the other one named. */
TEST(test_two_channels_of_one_kind)
{
  struct signal_bench b = signal_bench_plain();
  b.displacement = true;
  record(&b, 1);
  reduce(&plain);
  assert_false(noted("is left out"));
  signal_channel(&r, "stage", DEA_CHANNEL_DISPLACEMENT, b.rate_Hz, r.channels[0].count);
  reduce(&plain);
  assert_true(noted("channel 'stage' is left out"));
  assert_true(out->levels[0].mean[DEA_REDUCED_DISPLACEMENT] > 200e-6);
}

/* A breakdown whose voltage swings to the other side is one of the asked voltage. */
TEST(test_breakdown_that_swings)
{
  struct signal_bench b = signal_bench_plain();
  b.voltage = true;
  record(&b, 1);
  const struct dea_channel *u = dea_recording_kind(&r, DEA_CHANNEL_VOLTAGE);
  struct dea_channel *a = signal_channel(&r, "current", DEA_CHANNEL_CURRENT, b.rate_Hz, u->count);
  uint64_t seed = 3;
  for (size_t i = 0; i < u->count; i++) {
    bool broken = 2 * i > u->count && u->values[i] > 3000.0;
    u->values[i] = broken ? (i % 2 == 0 ? 900.0 : -900.0) : u->values[i];
    a->values[i] = (broken ? 1e-3 : 0.0) + 1e-9 * signal_normal(&seed);
  }
  reduce(&plain);
  assert_false(noted("the measured one is taken"));
  assert_true(out->discharge_count > 0 && out->discharges[0].kind == DEA_BREAKDOWN);
}

/* Ramps of 1 s to 1, 2, ... 5 kV on 500 pF: of low voltages much of the ramp is within what counts
 * as rest or as held, and the voltage at both ends of a window is that of its charge. */
TEST(test_capacitance_by_slow_ramps)
{
  enum { RATE = 500, LEVELS = 5, COUNT = RATE * (1 + 6 * LEVELS) };
  static const double film_F = 500e-12;
  record_two(RATE, COUNT);
  struct dea_channel *a = signal_channel(&r, "current", DEA_CHANNEL_CURRENT, RATE, COUNT);
  uint64_t seed = 2;
  double before_V = 0.0;
  for (size_t i = 0; i < COUNT; i++) {
    double t = (double)i / RATE - 1.0, level = floor(t / 6.0) + 1.0, own = t - 6.0 * (level - 1.0);
    double share = t < 0.0 ? 0.0 : fmax(0.0, fmin(fmin(own, 1.0), 4.0 - own));
    double volts = 1e3 * level * share;
    r.channels[0].values[i] = volts;
    a->values[i] = film_F * (volts - before_V) * RATE + 1e-12 * volts + 1e-9 * signal_normal(&seed);
    before_V = volts;
  }
  reduce(&plain);
  assert_int_equal(out->level_count, LEVELS);
  for (size_t l = 0; l < LEVELS; l++) {
    assert_close(out->levels[l].capacitance_F, film_F, 3e-3, 0.0);
  }
  assert_int_equal(out->discharge_count, 0);
}

/* Cycles at 0 V behind others, on for 1.5 of 2 s: their parts are those of the first one, whose
 * rest before it is longer than theirs. */
TEST(test_quiet_cycles_behind_others)
{
  enum { RATE = 100, CYCLES = 8, COUNT = 28 * RATE };
  static struct dea_recorded_cycle list[CYCLES];
  record_two(RATE, COUNT);
  uint64_t seed = 2;
  for (size_t i = 0; i < COUNT; i++) {
    double t = (double)i / RATE - 8.0, phase = t - 2.0 * floor(t / 2.0);
    bool on = t >= 0.0 && phase < 1.5 && (t < 6.0 || (t >= 10.0 && t < 16.0));
    r.channels[0].values[i] = on ? 5000.0 : 0.0;
    r.channels[1].values[i] = (on ? 1e-3 : 0.0) + 1e-7 * signal_normal(&seed);
  }
  for (size_t k = 0; k < CYCLES; k++) {
    double start_s = 8.0 + 2.0 * (double)k;
    list[k] = (struct dea_recorded_cycle){k / 3, k % 3, start_s, start_s + 2.0,
                                          k == 3 || k == 4 ? 0.0 : 5000.0};
  }
  r.cycles = list;
  r.cycle_count = CYCLES;
  reduce(&plain);
  assert_int_equal(out->cycle_count, CYCLES);
  for (size_t k = 0; k < CYCLES; k++) {
    double wanted_m = k == 3 || k == 4 ? 0.0 : 1e-3;
    assert_close(out->cycles[k].values[DEA_REDUCED_DISPLACEMENT].amplitude, wanted_m, 0, 1e-6);
  }
  r.cycles = NULL;
}

/* A clock that counts from a moment days before: history.csv has every sample. */
TEST(test_times_far_from_zero)
{
  struct signal_bench b = signal_bench_plain();
  b.displacement = b.voltage = true;
  record(&b, 1);
  for (size_t c = 0; c < r.channel_count; c++) {
    r.channels[c].start_s = 1e7 - 1e3;
  }
  for (size_t k = 0; k < r.cycle_count; k++) {
    r.cycles[k].start_s += 1e7 - 1e3;
    r.cycles[k].end_s += 1e7 - 1e3;
  }
  reduce(&plain);
  struct dea_reduced_series series;
  assert_int_equal(dea_reduced_series_fill(ctx, &r, out, DEA_REDUCED_SERIES_MAX, &series), DEA_OK);
  assert_int_equal(series.rows, r.channels[0].count);
  dea_reduced_series_free(ctx, &series);
}

TEST(test_empty_profiles)
{
  for (int k = 0; k < 3; k++) {
    struct signal_bench b = line_laser();
    b.points = k == 1 ? 8 : 100;
    record(&b, 1);
    size_t all = r.profiles.points * r.profiles.count;
    for (size_t i = 0; i < all && k == 0; i++) {
      r.profiles.z_m[i] = NAN;
    }
    if (k == 2) {
      r.profiles.x_m[4] = r.profiles.x_m[3];
    }
    reduce(&plain);
    assert_int_equal(out->cycle_count, 3);
    assert_true(isnan(out->levels[0].mean[DEA_REDUCED_CENTRE]));
    assert_true(noted(k == 0 ? "no frame" : "16 points or more"));
  }
}

static struct dea_recording whole;

static dea_status reduce_whole(struct dea_context *own)
{
  struct dea_reduction *reduction;
  const struct dea_reduce_options options = {3e-3, 15e-3, 3.75e-3, 0.0, NAN};
  dea_status status = dea_reduce(own, &whole, &options, &reduction);
  dea_reduction_destroy(own, reduction);
  return status;
}

TEST(test_memory)
{
  struct signal_bench b = line_laser();
  b.points = 100;
  b.frame_Hz = 10.0;
  b.rate_Hz = 50.0;
  b.voltage = b.displacement = b.force = true;
  whole = signal_record(&b, 1);
  size_t n = whole.channels[0].count;
  struct dea_channel *current = signal_channel(&whole, "current", DEA_CHANNEL_CURRENT, 50.0, n);
  for (size_t i = 0; i < n; i++) {
    current->values[i] = i == n / 4 ? 1e-3 : 1e-7 * sin(7.0 * (double)i);
  }
  assert_true(failing_ends(reduce_whole, DEA_OK) > 30);
  signal_free(&whole);
}

TESTS(context_set_up, reduced_tear_down)
