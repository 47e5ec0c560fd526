/* dea compare with several curves and with what dea reduce writes: misfits that were computed by
 * hand, profiles, histories on one clock. */
#include "measured_run.h"
#include "result/compare.h"

#include <jansson.h>

static json_t *root; // of the JSON that was printed last

static void read_printed(void)
{
  json_decref(root);
  root = json_loads(command_out, 0, NULL);
  assert_non_null(root);
}

static int compare_tear_down(void **state)
{
  json_decref(root);
  return command_tear_down(state);
}

static double number(const json_t *object, const char *key)
{
  const json_t *value = json_object_get(object, key);
  assert_true(json_is_number(value));
  return json_number_value(value);
}

/* Element of root[list] whose a is that name; with a half when half is not "". */
static const json_t *find(const char *list, const char *a, const char *half)
{
  size_t i;
  const json_t *one, *array = json_object_get(root, list);
  json_array_foreach(array, i, one)
  {
    const char *own = json_string_value(json_object_get(one, "half"));
    if (strcmp(json_string_value(json_object_get(one, "a")), a) == 0 &&
        (half[0] == '\0' || (own != NULL && strcmp(own, half) == 0))) {
      return one;
    }
  }
  fail_msg("no '%s' in %s", a, list);
  return NULL;
}

// Tests -------------------------------------------------------------------------------------------

TEST(test_misfits_against_the_voltage)
{
  assert_int_equal(command_run("compare run red --json"), 0);
  read_printed();
  const json_t *lumped = find("comparisons", "lumped", "");
  const json_t *z = json_array_get(json_object_get(lumped, "quantities"), 0);
  assert_string_equal(json_string_value(json_object_get(z, "quantity")), "centre_z_m");
  assert_close(number(z, "points"), 3, 0, 0);
  assert_close(number(z, "rms"), 1e-6 * sqrt(1400.0 / 3.0), 1e-9, 0);
  assert_close(number(z, "bias"), 20e-6 / 3.0, 1e-9, 0);
  assert_close(number(z, "largest"), 30e-6, 1e-9, 0);
  assert_close(number(z, "largest_at_V"), 6000.0, 1e-12, 0);
  assert_close(number(z, "relative_largest"), 30.0 / 380.0, 1e-9, 0);
  assert_close(number(z, "chi_square_per_point"), 1400.0 / 121.0 / 3.0, 1e-9, 0);
  assert_close(number(z, "within_1_std"), 1.0 / 3.0, 1e-12, 0);
  assert_close(number(z, "within_2_std"), 2.0 / 3.0, 1e-12, 0);
  const json_t *force = json_array_get(json_object_get(lumped, "quantities"), 1);
  assert_close(number(force, "rms"), 0, 0, 1e-15);
  assert_null(json_object_get(force, "chi_square_per_point")); // its scatter is not known
  const json_t *solid = find("comparisons", "3d", "");
  z = json_array_get(json_object_get(solid, "quantities"), 0);
  assert_close(number(z, "bias"), -620e-6 / 3.0, 1e-9, 0);
  assert_int_equal(json_array_size(json_object_get(root, "comparisons")), 2);
  assert_contains(command_err, "axisymmetric has no 'z centre', 'force' at the voltages of red",
                  "3d has no 'force' at the voltages of red");
}

TEST(test_profiles_within_the_film)
{
  assert_int_equal(command_run("compare run red --json"), 0);
  read_printed();
  const json_t *along = find("profiles", "3d", "along a fibre");
  assert_close(number(along, "voltage_V"), 5000.0, 1e-12, 0);
  assert_close(number(along, "points"), 30, 0, 0); // -15 to 15 mm without 3 mm
  assert_close(number(along, "bias"), 2e-6, 1e-6, 0);
  assert_close(number(along, "rms"), 2e-6, 1e-6, 0);
  assert_close(number(along, "chi_square_per_point"), 0.25, 1e-6, 0);
  // Between fibres it is lower by 50 um s (1 - s), s = x/15 mm: most at 7 and 8 mm.
  const json_t *between = find("profiles", "3d", "between fibres");
  assert_close(number(between, "largest"), 50e-6 * 56.0 / 225.0 - 2e-6, 1e-6, 0);
  assert_close(fabs(fabs(number(between, "largest_at_m")) - 7.5e-3), 0.5e-3, 1e-9, 0);
  assert_int_equal(json_array_size(json_object_get(root, "profiles")), 2);
  assert_contains(command_err, "the profile of 3d at 5 kV is formed of those at the voltages");
}

TEST(test_history_on_one_clock)
{
  assert_int_equal(command_run("compare run red --json"), 0);
  read_printed();
  const json_t *h = find("histories", "lumped", "");
  assert_close(number(h, "shift_s"), 3.25, 0, 1e-6);
  assert_close(number(h, "edges"), 2, 0, 0);
  assert_close(number(h, "bias"), -6e-6, 1e-3, 0);
  assert_close(number(h, "largest"), 6e-6, 1e-3, 0);
  assert_contains(command_err, "moved by 3.25 s, which lays 2 of its pulses on measured ones");
  // Without a voltage the clocks are what they are, and that is said.
  command_folder_make("clockless");
  command_write("clockless/measurement.csv", points);
  write_history("clockless/history.csv", false);
  command_expect("compare run clockless --model lumped --json", 0,
                 "are taken as they are: no voltage was recorded");
  read_printed();
  assert_close(number(find("histories", "lumped", ""), "shift_s"), 0, 0, 0);
  assert_int_equal(json_array_size(json_object_get(root, "profiles")), 0);
}

/* What a monitor shows in time, in any unit of a length. */
TEST(test_history_of_a_monitor)
{
  command_folder_make("hub");
  command_write("hub/measurement.csv", points);
  command_write("hub/history.csv", "time (s),hub z (mm),other (V)\n0.5,0.299,1\n0.75,0.299,1\n");
  assert_int_equal(command_run("compare run hub --model lumped --json"), 0);
  read_printed();
  const json_t *h = find("histories", "lumped", "");
  assert_string_equal(json_string_value(json_object_get(h, "quantity")), "hub_z_m");
  assert_close(number(h, "bias"), 1e-6, 1e-9, 0);
}

/* Pulses of the heights given, 1 s long, 2 s apart, from `start` on, 100 samples a second. */
static struct dea_samples staircase(double start_s, const double *high, int count, double *time,
                                    double *voltage)
{
  size_t n = 0;
  for (int i = 0; i < 200 * count + 100; i++, n++) {
    double t = 0.01 * i, own = t - 0.5;
    int k = (int)(own / 2.0);
    time[n] = start_s + t;
    voltage[n] = own >= 0 && k < count ? pulse(own - 2.0 * k, high[k], 0.02) : 0.0;
  }
  return (struct dea_samples){n, time, voltage, NULL};
}

TEST(test_clock_looks_for_pulses_of_its_height)
{
  enum { ROOM = 3000 };
  static double time[2][ROOM], voltage[2][ROOM];
  static const double all[] = {1000, 1000, 2000, 2000, -4000, -4000, 8000, 8000};
  static const double some[] = {4000, 4000};
  struct dea_clock_shift shift;
  // Computed at 4 kV alone, on a clock of its own: measured there from 1000 + 0.5 + 8 s on.
  struct dea_samples a = staircase(0.0, some, 2, time[0], voltage[0]);
  struct dea_samples b = staircase(1000.0, all, 8, time[1], voltage[1]);
  dea_clock_shift_find(&a, &b, &shift);
  assert_int_equal(shift.edges, 2);
  assert_close(shift.shift_s, 1008.0, 0, 1e-9);
  dea_clock_shift_find(&b, &a, &shift); // the other way round
  assert_close(shift.shift_s, -1008.0, 0, 1e-9);
  // Noise of 1 % of the largest moves the edges by less than a sample.
  for (size_t i = 0; i < b.count; i++) {
    voltage[1][i] += 80.0 * sin(1.7 * (double)i * (double)i);
  }
  dea_clock_shift_find(&a, &b, &shift);
  assert_int_equal(shift.edges, 2);
  assert_close(shift.shift_s, 1008.0, 0, 0.01);
  // No pulse of that height, and no pulse at all.
  static const double other[] = {6000, 6000};
  a = staircase(0.0, other, 2, time[0], voltage[0]);
  dea_clock_shift_find(&a, &b, &shift);
  assert_int_equal(shift.edges, 0);
  assert_close(shift.shift_s, 0, 0, 0);
  memset(voltage[0], 0, sizeof voltage[0]);
  dea_clock_shift_find(&a, &b, &shift);
  assert_int_equal(shift.edges, 0);
  a.count = 0;
  dea_clock_shift_find(&a, &b, &shift);
  assert_int_equal(shift.edges, 0);
}

TEST(test_a_run_as_the_reference_of_several)
{
  command_prints("compare run run2 run --tolerance 0%", 0, "run2, axisymmetric");
  assert_int_equal(command_run("compare run run2 --model 3d:lumped --model lumped --json "
                               "--quantity centre_z_m"),
                   0);
  read_printed();
  const json_t *z = json_array_get(json_object_get(find("comparisons", "3d", ""), "quantities"), 0);
  // 10 k^2 - 100 k for k = 0 ... 6: sum 910 - 2100
  assert_close(number(z, "bias"), -1190e-6 / 7.0, 1e-9, 0);
  command_expect("compare run run2 run --model alpha", 2, "run has no model of those asked for");
  command_expect("compare run run2 run --model lumped:alpha", 2,
                 "run has no curve of model 'alpha'");
}

TEST(test_tolerance_and_quantity)
{
  assert_int_equal(command_run("compare run red --model lumped --tolerance 8%"), 0); // 30 of 380
  command_expect("compare run red --model lumped --tolerance 7%", 1,
                 "centre_z_m of lumped differs by 7.89 % of its range");
  assert_contains(command_out, "out of tolerance");
  assert_int_equal(command_run("compare run red --tolerance 7% --quantity force_N"), 0);
  assert_null(strstr(command_out, "z centre"));
  assert_null(strstr(command_out, "over film"));
  command_expect("compare run red --quantity fibre_tip_z_m", 2,
                 "no curve has fibre_tip_z_m in common with red");
  command_expect("compare red run", 2, "red is a measurement: name it last");
  assert_int_equal(command_run("compare run"), 2);
}

TEST(test_opposite_signs_are_said)
{
  command_folder_make("below");
  command_write("below/measurement.csv", "V (kV),z centre (um)\n2,-190\n4,-420\n");
  command_expect("compare run below --json", 0,
                 "z centre of 3d and of below have opposite signs; nothing was "
                 "turned round: z is positive towards the fibres; was the sensor");
  assert_contains(command_err, "and model lumped, an upper bound, predicts no sign");
  read_printed();
  const json_t *z =
      json_array_get(json_object_get(find("comparisons", "lumped", ""), "quantities"), 0);
  assert_close(number(z, "bias"), (390e-6 + 820e-6) / 2.0, 1e-9, 0);
}

TESTS(compare_set_up, compare_tear_down)
