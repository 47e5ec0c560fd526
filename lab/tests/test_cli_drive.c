/* dea drive: what it says before anything is played, and what it refuses. */
#include "command.h"

#include <jansson.h>

#define EXAMPLE "@/lab/examples/cyclic.yaml"

TEST(test_dry_run)
{
  command_prints("drive " EXAMPLE, 0, "0 kV to 8 kV, 135 cycles in 270 s");
  assert_contains(command_out, "270000 of 3 channels at 1000 a second",
                  "by a control voltage of 0 V to 8 V", "311.2 V/um of 320 V/um that are allowed",
                  "Nothing was played. Next:  dea drive ");
  assert_contains(command_err, "the largest jump, 8 kV, takes 58.9 us");
}

/* What plays the voltage is called so, whatever keys its kind has. */
TEST(test_who_plays)
{
  assert_int_equal(
      command_run("drive " EXAMPLE " --set channels=null --set 'amplifier.min_voltage=0 V' --set "
                  "'instruments=[{kind: shvps, device: /dev/ttyACM0}, {kind: scpi, address: a, "
                  "output: VOLT %g}, {kind: scpi, address: b, readings: [{name: leakage, query: "
                  "\"MEAS:CURR?\", quantity: current}]}, {kind: nidaqmx}]'"),
      0);
  assert_contains(command_out, "1  shvps             plays the output, gives readings\n",
                  "2  scpi              plays the output, gives readings\n",
                  "3  scpi              gives readings\n",
                  "4  nidaqmx           plays the output, reads the channels\n");
}

/* The paper's 16 kV for the film of 200 um are more than its amplifier gives. */
TEST(test_too_much)
{
  command_expect("drive " EXAMPLE " --set sequence=null --set "
                 "'waveform={kind: ramp, to: 16 kV, duration: 8 s}'",
                 6,
                 "refused: the sequence asks for 16 kV at step 1, the amplifier Trek "
                 "10/10B-HS gives 10 kV at most");
  assert_contains(command_err, "must not be played");
  command_expect("drive " EXAMPLE " --sim -o no.h5 --set amplifier.max_voltage=7kV", 6,
                 "asks for 8 kV at step 1 (cyclic)");
  assert_int_equal(command_run("recording no.h5"), 5); // nothing was recorded
}

TEST(test_json)
{
  json_error_t error;
  assert_int_equal(command_run("drive " EXAMPLE " --json --set safety.largest_field=300V/um"), 6);
  json_t *json = json_loads(command_out, 0, &error);
  assert_non_null(json);
  json_t *plan = json_object_get(json, "plan");
  assert_int_equal(json_integer_value(json_object_get(plan, "cycles")), 135);
  assert_close(json_number_value(json_object_get(plan, "highest_V")), 8000, 0, 0);
  assert_true(json_is_false(json_object_get(json, "good")));
  json_decref(json);
}

/* On the simulated bench, and not over what is there. */
TEST(test_simulated)
{
  json_error_t error;
  static const char text[] = "drive " EXAMPLE "  --set "
                             "'sequence=[{waveform: {kind: staircase, values: [2 kV, 3 kV], "
                             "cycles: 2, frequency: 5 Hz}}]' --sim -o s.h5";
  char again[600];
  command_prints(text, 0, "played            0.8 s, 4 cycles to the end");
  assert_contains(command_out, "output            at 0 V", "Next:  dea reduce s.h5");
  command_expect(text, 5, "'s.h5' already exists");
  snprintf(again, sizeof again, "%s --force --json", text);
  assert_int_equal(command_run(again), 0);
  json_t *json = json_loads(command_out, 0, &error);
  json_t *recording = json_object_get(json, "recording");
  assert_int_equal(json_integer_value(json_object_get(recording, "cycles")), 4);
  assert_true(json_is_true(json_object_get(recording, "reached_zero")));
  assert_true(json_number_value(json_object_get(recording, "largest_current_A")) > 10e-6);
  json_decref(json);
  assert_int_equal(command_run("recording s.h5"), 0);
  command_write("note.txt", "a text that is no recording");
  snprintf(again, sizeof again, "%s --force -o note.txt", text);
  command_expect(again, 5, "'note.txt' is no recording and is not replaced");
  command_read("note.txt", command_out);
  assert_string_equal(command_out, "a text that is no recording");
  command_prints("recording s.h5", 0, "cycles         4 completed");
  // the protocol inside is the file: what was played differs by what was set
  assert_contains(command_out,
                  "protocol_overrides sequence=[{waveform: {kind: staircase, values: ");
}

/* It pulls the voltage down while the ramp still asks for more, which the current explains. */
TEST(test_breakdown)
{
  assert_int_equal(
      command_run("drive " EXAMPLE " --sim -o b.h5 --set sim.breakdown_voltage=2.5kV "
                  "--set 'sequence=[{waveform: {kind: ramp, to: 4 kV, duration: 1 s}}]'"),
      6);
  assert_contains(command_out, "output            at 0 V", "ended early       the current is ");
}

TEST(test_usage)
{
  static const struct {
    const char *arguments, *part;
    int code;
  } wrong[] = {
      {"drive", "a protocol is needed", 2},
      {"drive a b", "one protocol at a time", 2},
      {"drive a --arm --sim", "exclude each other", 2},
      {"drive a --armed", "there is no option '--armed'", 2},
      {"drive -zv a", "there is no option '-z'", 2},
      {"drive -fv a", "'-v' stands alone", 2},
      {"drive none.yaml", "none.yaml", 5},
      {"drive @/examples/frdea-4.yaml", "this is a design", 3},
      {"drive @/examples/fit/silicone.yaml", "this is a fit, not a protocol", 3},
      {"drive " EXAMPLE " --arm", "names no `instruments` to play it", 6},
      {"drive " EXAMPLE " --set 'instruments=[{kind: gocatr}]'", "did you mean 'gocator'", 3},
  };
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    if (command_run(wrong[i].arguments) != wrong[i].code) {
      fail_msg("dea %s: not %d: %s", wrong[i].arguments, wrong[i].code, command_err);
    }
    assert_contains(command_err, wrong[i].part);
  }
}

TEST(test_schema)
{
  command_prints("schema --protocol", 0, "amplifier.max_voltage");
  assert_contains(command_out, "safety.largest_field");
  assert_int_equal(command_run("schema --protocol --json"), 0);
  json_error_t error;
  json_t *json = json_loads(command_out, 0, &error);
  assert_non_null(json_object_get(json_object_get(json, "properties"), "dea-protocol"));
  json_decref(json);
  assert_int_equal(command_run("schema --protocol --material"), 2);
}

TESTS(command_set_up, command_tear_down)
