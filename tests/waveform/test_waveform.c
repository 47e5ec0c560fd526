/* waveform: values, corners and cycles of every kind; what a slow supply makes of them; errors. */
#include "testing.h"
#include "waveform/waveform.h"

#include "own_folder.h" // after: its context shadows no name of the headers above

#include <math.h>
#include <string.h>

/* The waveform of the keys in text ("kind: square\nhigh: 7 kV\n..."); NULL after findings. beside:
 * stands for the design file. */
static struct dea_waveform *waveform_of(struct dea_context *context, const char *beside,
                                        const char *text)
{
  struct dea_yaml *yaml;
  struct dea_waveform *waveform = NULL;
  if (dea_yaml_parse(context, "w.yaml", text, strlen(text), &yaml) == DEA_OK) {
    const struct dea_reader reader = {context, yaml, NULL};
    dea_waveform_read(&reader, dea_yaml_root(yaml), "", beside, &waveform);
    dea_yaml_destroy(context, yaml);
  }
  return waveform;
}

#define PI 3.14159265358979323846

static struct dea_waveform *make(const char *text)
{
  dea_finding_clear(ctx);
  struct dea_waveform *w = waveform_of(ctx, in_folder("design.yaml"), text);
  if (w == NULL) {
    size_t count;
    const struct dea_finding *f = dea_finding_get(ctx, &count);
    fail_msg("%s: %s", text, count > 0 ? f[0].text : dea_context_message(ctx));
  }
  return w;
}

/* Corners of 100 000 pulses are where they belong, to the last bit, and the jump is there. */
TEST(test_corners_do_not_drift)
{
  struct dea_waveform *w =
      make("kind: square\nlow: 1 kV\nhigh: 7 kV\nfrequency: 0.3 Hz\nduty: 40 %\ncycles: 100000\n");
  double t = 0, f = 0.3, duty = 0.4;
  size_t corners = 0;
  assert_true(dea_waveform_value(w, 0) == 7000);
  for (double next; isfinite(next = dea_waveform_corner(w, t)); corners++) {
    size_t n = (corners + 1) / 2;
    bool up = corners % 2 == 1;
    double due = up ? (double)n / f : ((double)n + duty) / f;
    if (n == 100000) { // the end
      break;
    }
    assert_true(next == due);
    assert_true(dea_waveform_value(w, next) == (up ? 7000 : 1000));
    assert_true(dea_waveform_before(w, next) == (up ? 1000 : 7000));
    assert_true(dea_waveform_value(w, 0.5 * (t + next)) == (up ? 1000 : 7000));
    t = next;
  }
  assert_int_equal(corners, 199999);
  assert_true(dea_waveform_corner(w, t) == w->end_s);
  assert_true(dea_waveform_value(w, 2 * w->end_s) == 1000);
  struct dea_wave_cycle cycle;
  assert_true(dea_waveform_cycle(w, 99999, &cycle));
  assert_true(cycle.start_s == 99999 / f && cycle.level_V == 7000);
  assert_false(dea_waveform_cycle(w, 100000, &cycle));
  dea_waveform_destroy(w);
}

/* The paper's protocol: 9 voltages, 15 cycles each, 0.5 Hz. */
TEST(test_staircase)
{
  struct dea_waveform *w =
      make("kind: staircase\nfrequency: 0.5 Hz\npause: 1 s\nrise_time: 10 ms\n");
  struct dea_wave_cycle cycle;
  assert_true(w->end_s == 9 * 31.0);
  for (size_t n = 0; n < 9 * 15; n++) {
    double level = 1000.0 * (double)(n / 15),
           start = 31.0 * (double)(n / 15) + 2.0 * (double)(n % 15);
    assert_true(dea_waveform_cycle(w, n, &cycle));
    assert_true(cycle.start_s == start && cycle.level_V == level);
    assert_close(dea_waveform_value(w, start + 0.005), level / 2, 0, 1e-8);
    assert_true(dea_waveform_value(w, start + 0.5) == level);
    assert_close(dea_waveform_value(w, start + 1.0025), 0.75 * level, 0, 1e-7);
    assert_true(dea_waveform_value(w, start + 1.5) == 0);
  }
  assert_true(dea_waveform_value(w, 30.5) == 0 && !dea_waveform_cycle(w, 135, &cycle));
  dea_waveform_destroy(w);
  w = make("kind: staircase\nvalues: [6 kV, 2 kV]\nfrequency: 10 Hz\ncycles: 1\nlow: 1 kV\n");
  assert_true(dea_waveform_value(w, 0.01) == 6000 && dea_waveform_value(w, 0.06) == 1000);
  assert_true(dea_waveform_value(w, 0.11) == 2000 && w->end_s == 0.2);
  dea_waveform_destroy(w);
}

TEST(test_every_kind)
{
  static const struct {
    const char *text;
    double time_s, value_V, end_s;
  } due[] = {
      {"kind: constant\nvoltage: 3 kV\nduration: 4 s\n", 2, 3000, 4},
      {"kind: step\nfrom: 1 kV\nto: 3 kV\nat: 1 s\nrise_time: 2 s\nduration: 4 s\n", 2.5, 2500, 4},
      {"kind: step\nto: 3 kV\n", 0, 3000, 10},
      {"kind: ramp\nfrom: 8 kV\nto: 2 kV\nduration: 3 s\nhold: 1 s\n", 1, 6000, 4},
      {"kind: ramp\nto: 2 kV\nduration: 3 s\nhold: 1 s\n", 3.5, 2000, 4},
      {"kind: triangle\nhigh: 4 kV\nfrequency: 2 Hz\nduty: 25 %\ncycles: 3\n", 1.0625, 2000, 1.5},
      {"kind: triangle\nhigh: 4 kV\nfrequency: 2 Hz\nduty: 25 %\ncycles: 3\n", 1.125, 4000, 1.5},
      {"kind: sine\nmean: 3 kV\namplitude: 2 kV\nfrequency: 50 Hz\ncycles: 1000000\n", 19999.995,
       1000, 20000},
      {"kind: sine\namplitude: 2 kV\nfrequency: 1 Hz\nphase: 90 degree\n", 0, 2000, 10},
      // 1 Hz to 3 Hz in 4 s: t + t^2/4 cycles
      {"kind: chirp\namplitude: 1 kV\nfrom: 1 Hz\nto: 3 Hz\nduration: 4 s\nspacing: linear\n", 1,
       1000, 4},
      {"kind: burst\nmean: 2 kV\namplitude: 1 kV\nfrequency: 10 Hz\ncycles: 2\nperiod: 1 s\n"
       "bursts: 3\n",
       2.025, 3000, 3},
      {"kind: burst\nmean: 2 kV\namplitude: 1 kV\nfrequency: 10 Hz\ncycles: 2\nperiod: 1 s\n"
       "bursts: 3\n",
       2.225, 2000, 3},
  };
  for (size_t i = 0; i < sizeof due / sizeof due[0]; i++) {
    struct dea_waveform *w = make(due[i].text);
    assert_close(dea_waveform_value(w, due[i].time_s), due[i].value_V, 0, 1e-6);
    assert_close(w->end_s, due[i].end_s, 0, 1e-12);
    dea_waveform_destroy(w);
  }
}

/* Lowest and highest voltage and the steepest slope of every kind, beside what 400 looks a cycle
 * find of the first cycles; and of so many cycles, or of bursts so far apart, that nobody looks at
 * all. */
TEST(test_extent)
{
  static const struct {
    const char *text;
    double lowest_V, highest_V, slope_V_per_s;
  } due[] = {
      {"kind: ramp\nfrom: 8 kV\nto: -2 kV\nduration: 4 s\n", -2000, 8000, 2500},
      {"kind: square\nlow: 1 kV\nhigh: 4 kV\nfrequency: 2 Hz\n", 1000, 4000, 0},
      {"kind: triangle\nhigh: 4 kV\nfrequency: 2 Hz\nduty: 25 %\ncycles: 3\n", 0, 4000, 32000},
      {"kind: sine\namplitude: 6 kV\nfrequency: 1 Hz\ncycles: 1000000\n", -6000, 6000, 12e3 * PI},
      {"kind: sine\nmean: -3 kV\namplitude: -3 kV\nfrequency: 1 Hz\ncycles: 1000000\n", -6000, 0,
       6e3 * PI},
      {"kind: sine\nmean: 3 kV\namplitude: 3 kV\nfrequency: 1 Hz\nphase: -90 degree\ncycles: 1\n",
       0, 6000, 6e3 * PI},
      {"kind: burst\namplitude: 9 kV\nfrequency: 1 kHz\ncycles: 1\nperiod: 3600 s\nbursts: 100\n",
       -9000, 9000, 18e6 * PI},
      {"kind: burst\nmean: 2 kV\namplitude: 1 kV\nfrequency: 10 Hz\ncycles: 2\nperiod: 1 s\n", 1000,
       3000, 20e3 * PI},
      {"kind: chirp\nmean: 1 kV\namplitude: 2 kV\nfrom: 100 Hz\nto: 1 kHz\nduration: 100000 s\n",
       -1000, 3000, 4e6 * PI},
      // a quarter of a cycle, and a half of one
      {"kind: chirp\namplitude: 2 kV\nfrom: 1 Hz\nto: 1 Hz\nduration: 0.25 s\n", 0, 2000, 4e3 * PI},
      {"kind: chirp\namplitude: 2 kV\nfrom: 1 Hz\nto: 1 Hz\nduration: 0.0625 s\n", 0,
       765.3668647301796, 4e3 * PI},
      {"kind: chirp\namplitude: -2 kV\nfrom: 0.5 Hz\nto: 1.5 Hz\nduration: 0.5 s\nspacing: "
       "linear\n",
       -2000, 0, 6e3 * PI},
  };
  for (size_t i = 0; i < sizeof due / sizeof due[0]; i++) {
    struct dea_waveform *w = make(due[i].text);
    struct dea_wave_extent extent;
    dea_waveform_extent(w, &extent);
    assert_close(extent.lowest_V, due[i].lowest_V, 1e-12, 1e-9);
    assert_close(extent.highest_V, due[i].highest_V, 1e-12, 1e-9);
    assert_close(extent.slope_V_per_s, due[i].slope_V_per_s, 1e-12, 0);
    double each_s = fmin(w->longest_step_s / 20, w->end_s / 4000);
    for (double n = 0; n <= 4000; n++) {
      double value_V = dea_waveform_value(w, fmin(n * each_s, w->end_s));
      assert_true(value_V >= extent.lowest_V && value_V <= extent.highest_V);
    }
    dea_waveform_destroy(w);
  }
}

static void write_text(const char *name, const char *text)
{
  FILE *file = fopen(in_folder(name), "w");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

TEST(test_table)
{
  write_text("t.csv", "# a drive\ntime (ms);note;V (kV)\n0;a;0\n100;b;2,5\n100;;1\n400;c;1\n");
  struct dea_waveform *w = make("kind: table\nfile: t.csv\nrepeat: 3\n");
  assert_close(w->end_s, 1.2, 0, 1e-12);
  assert_close(dea_waveform_value(w, 0.85), 1250, 0, 1e-6);
  assert_close(dea_waveform_before(w, dea_waveform_corner(w, 0.8 + 1e-9)), 2500, 0, 1e-6);
  assert_close(dea_waveform_value(w, dea_waveform_corner(w, 0.8 + 1e-9)), 1000, 0, 1e-6);
  dea_waveform_destroy(w);
}

/* A supply of 10 kV/s makes of 4 kV pulses of 0.5 s ramps of 0.4 s, and of 8 kV pulses triangles.
 */
TEST(test_slow_supply)
{
  struct dea_waveform *fast = make("kind: square\nhigh: 4 kV\nfrequency: 1 Hz\ncycles: 3\n"), *slow;
  assert_int_equal(dea_waveform_limit(ctx, fast, 1e4, 3, &slow), DEA_OK);
  for (int n = 0; n < 3; n++) {
    assert_close(dea_waveform_value(slow, n + 0.2), 2000, 0, 1e-6);
    assert_close(dea_waveform_value(slow, n + 0.45), 4000, 0, 1e-6);
    assert_close(dea_waveform_value(slow, n + 0.6), 3000, 0, 1e-6);
    assert_close(dea_waveform_corner(slow, n + 0.1), n + 0.4, 0, 1e-12);
    assert_close(dea_waveform_corner(slow, n + 0.6), n + 0.9, 0, 1e-12);
  }
  dea_waveform_destroy(slow);
  dea_waveform_destroy(fast);
  fast = make("kind: square\nhigh: 8 kV\nfrequency: 1 Hz\ncycles: 3\n");
  assert_int_equal(dea_waveform_limit(ctx, fast, 1e4, 3, &slow), DEA_OK);
  assert_close(dea_waveform_value(slow, 2.5), 5000, 0, 1e-6);
  assert_close(dea_waveform_value(slow, 2.9), 1000, 0, 1e-6);
  dea_waveform_destroy(slow);
  dea_waveform_destroy(fast);
  fast = make("kind: triangle\nhigh: 4 kV\nfrequency: 1 Hz\n"); // 8 kV/s
  assert_int_equal(dea_waveform_limit(ctx, fast, 1e4, 10, &slow), DEA_OK);
  assert_null(slow);
  dea_waveform_destroy(fast);
}

/* A sine that is too fast in its middle: never faster than the supply, nor away from the sine where
 * that is slow. */
TEST(test_slow_supply_and_sine)
{
  struct dea_waveform *fast = make("kind: sine\namplitude: 1 kV\nfrequency: 1 Hz\n"), *slow;
  assert_int_equal(dea_waveform_limit(ctx, fast, 5000, 10, &slow), DEA_OK); // up to 6283 V/s
  for (int i = 1; i < 10000; i++) {
    double before = dea_waveform_value(slow, 1e-3 * (i - 1)),
           now = dea_waveform_value(slow, 1e-3 * i);
    assert_true(fabs(now - before) <= 5.000001);
  }
  assert_close(dea_waveform_value(slow, 7.25), 1000, 0, 2);
  dea_waveform_destroy(slow);
  dea_waveform_destroy(fast);
}

static void check_error(const char *text, size_t line, size_t column, const char *part)
{
  size_t count;
  dea_finding_clear(ctx);
  if (waveform_of(ctx, in_folder("design.yaml"), text) != NULL) {
    fail_msg("taken: %s", text);
  }
  const struct dea_finding *f = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    if (strstr(f[i].text, part) != NULL && f[i].location.line == line &&
        f[i].location.column == column) {
      return;
    }
  }
  fail_msg("no error at %zu:%zu with '%s', but: %zu:%zu %s", line, column, part,
           count > 0 ? f[0].location.line : 0, count > 0 ? f[0].location.column : 0,
           count > 0 ? f[0].text : "none");
}

TEST(test_errors)
{
  check_error("kind: squre\n", 1, 7, "there is no waveform 'squre'; did you mean 'square'?");
  check_error("high: 3 kV\n", 1, 1, "a waveform needs its kind: constant, step");
  check_error("kind: sine\namplitude: 1 kV\nfrequency: 1 Hz\nduty: 30 %\n", 4, 1,
              "known here are: kind, mean, amplitude, frequency, phase, cycles");
  check_error("kind: square\nhigh: 3 kV\nfrequency: 2 s\n", 3, 12, "a frequency is due");
  check_error("kind: square\nhigh: 3 kV\nfrequency: 1 Hz\nrise_time: 0.6 s\n", 4, 12,
              "longer than the 0.5 s");
  check_error("kind: square\nhigh: 3 kV\nfrequency: 1 Hz\nduty: 100 %\n", 4, 7, "duty");
  check_error("kind: table\nfile: none.csv\n", 2, 7, "none.csv");
  check_error("kind: burst\namplitude: 1 kV\nfrequency: 1 Hz\nperiod: 5 s\n", 4, 9,
              "shorter than a burst");
  write_text("bad.csv", "time (s),voltage (s)\n0,0\n");
  check_error("kind: table\nfile: bad.csv\n", 1, 10, "the unit in 'voltage (s)' does not fit");
  write_text("bad.csv", "time (s),strain\n0,0\n");
  check_error("kind: table\nfile: bad.csv\n", 1, 1, "no column such as 'voltage (kV)'");
  write_text("bad.csv", "time,voltage (kV)\n0,0\n");
  check_error("kind: table\nfile: bad.csv\n", 1, 1, "'time' needs a unit in parentheses");
  write_text("bad.csv", "time (s),voltage (kV)\n0,0\n1,x\n");
  check_error("kind: table\nfile: bad.csv\n", 3, 3, "'x' is not a number");
  write_text("bad.csv", "time (s),voltage (kV)\n0,0\n1,2000\n");
  check_error("kind: table\nfile: bad.csv\n", 3, 1, "at most 1 MV");
  write_text("bad.csv", "time (s),voltage (kV)\n0,0\n2,1\n1,1\n");
  check_error("kind: table\nfile: bad.csv\n", 4, 1, "1 s comes too late");
  write_text("bad.csv", "time (s),voltage (kV)\n0,0\n2\n");
  check_error("kind: table\nfile: bad.csv\n", 2, 1, "fewer fields than the header");
  write_text("bad.csv", "time (s),voltage (kV)\n0,0\n");
  check_error("kind: table\nfile: bad.csv\n", 2, 1, "needs two times at least");
}

TESTS(set_up, tear_down)
