// dea drive --arm with fake libraries of DAQs: from the protocol to the recording and back to 0 V.
#include "recording/recording.h"
#include "testing.h"

#include "command.h"

static const char protocol[] =
    "dea-protocol: 1\n"
    "sequence:\n"
    "  - waveform: {kind: triangle, low: -2 kV, high: 2 kV, cycles: 3, frequency: 2 Hz}\n"
    "amplifier: {gain: 1000, max_voltage: 10 kV, slew_limit: 100 V/us, current_limit: 10 mA}\n"
    "rate: 1 kHz\n"
    "channels:\n"
    "  - {name: monitor, quantity: voltage, input: ai0, range: 10 V, per_volt: 1 kV}\n"
    "  - {name: second, quantity: current, input: ai1, range: 10 V, per_volt: 1 uA}\n"
    "safety: {guard_time: 20 s, trip_current: %s, trip_time: 10 ms}\n"
    "instruments:\n"
    "  - {kind: %s, library: %s/fake_%s.so}\n";

static int drive(const char *kind, const char *trip)
{
  char text[4096];
  snprintf(text, sizeof text, protocol, trip, kind, DEA_FAKE_FOLDER, kind);
  command_write("p.yaml", text);
  return command_run("drive p.yaml --arm -f -o r.h5");
}

static void check(const char *kind, double step_V)
{
  struct dea_context *ctx;
  struct dea_recording *recording;
  char file[sizeof command_folder + 16];
  if (drive(kind, "9 uA") != 0) {
    fail_msg("%s%s", command_out, command_err);
  }
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  snprintf(file, sizeof file, "%s/r.h5", command_folder);
  assert_int_equal(dea_recording_read(ctx, file, &recording), DEA_OK);
  const struct dea_channel *asked = dea_recording_kind(recording, DEA_CHANNEL_COMMAND);
  const struct dea_channel *monitor = dea_recording_channel(recording, "monitor");
  const struct dea_channel *second = dea_recording_channel(recording, "second");
  assert_true(recording->complete && recording->cycle_count == 3);
  assert_true(asked->count >= 1500 && monitor->count == asked->count);
  double highest_V = 0;
  for (size_t i = 0; i < asked->count; i++) {
    // The fake's inputs see its output at once; the amplifier is a thousandfold.
    assert_close(monitor->values[i], asked->values[i], 0, 1000 * step_V);
    assert_close(second->values[i], 2e-9 * asked->values[i], 0, 1.5e-6 * step_V);
    highest_V = fmax(highest_V, monitor->values[i]);
  }
  assert_close(highest_V, 2000, 0.01, 0);
  dea_recording_destroy(ctx, recording);
  dea_context_destroy(ctx);
  // The second channel taken as a current that must not flow: an early end, and its exit code.
  assert_int_equal(drive(kind, "1 uA"), 6);
  assert_non_null(strstr(command_err, "above safety.trip_current"));
  assert_non_null(strstr(command_out, "at 0 V"));
}

TEST(test_nidaqmx)
{
  check("nidaqmx", 1e-12);
}

TEST(test_comedi)
{
  check("comedi", 1.01 * 20.0 / 65535);
}

/* A protocol from elsewhere that brings its own library: its code does not run, armed or not. */
TEST(test_library_that_nobody_listed)
{
  static const char *const wrong[] = {"libraries: [other.so]\n", "libraries: [./own.so]\n",
                                      "libraries: x\n", ""};
  char text[4096], list[2048];
  snprintf(text, sizeof text, "cp '%s/fake_comedi.so' '%s/own.so'", DEA_FAKE_FOLDER,
           command_folder);
  assert_int_equal(system(text), 0);
  snprintf(text, sizeof text, "mkdir -p '%s/config/dea'", command_folder);
  assert_int_equal(system(text), 0);
  snprintf(text, sizeof text, "%s/config", command_folder);
  assert_int_equal(setenv("XDG_CONFIG_HOME", text, 1), 0);
  snprintf(text, sizeof text, protocol, "9 uA", "comedi", ".", "comedi");
  char *name = strstr(text, "./fake_comedi.so");
  snprintf(name, sizeof text - (size_t)(name - text), "%s/own.so}\n", command_folder);
  command_write("p.yaml", text);
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    command_write("config/dea/instruments.yaml", wrong[i]);
    assert_int_equal(command_run("drive p.yaml --arm -f -o none.h5"), 3);
    assert_non_null(strstr(command_err, "is neither libcomedi.so.0 nor on your own list"));
    assert_non_null(strstr(command_err, "/config/dea/instruments.yaml"));
    assert_int_equal(command_run("recording none.h5"), 5);
  }
  assert_int_equal(command_run("drive p.yaml"), 3); // nobody has to arm to hear of it
  snprintf(list, sizeof list, "libraries: ['%s/own.so']\n", command_folder);
  command_write("config/dea/instruments.yaml", list);
  if (command_run("drive p.yaml --arm -f -o r.h5") != 0) {
    fail_msg("%s%s", command_out, command_err);
  }
  assert_int_equal(setenv("XDG_CONFIG_HOME", DEA_FAKE_FOLDER "/config", 1), 0);
}

int main(void)
{
  return setenv("XDG_CONFIG_HOME", DEA_FAKE_FOLDER "/config", 1) != 0 ||
         run_all(command_set_up, command_tear_down);
}
