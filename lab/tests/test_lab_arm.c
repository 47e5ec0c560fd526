// dea drive --arm with a fake NI-DAQmx: from the protocol to the recording and back to 0 V.
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
    "  - {kind: nidaqmx}\n";

static int drive(const char *trip)
{
  char text[4096];
  snprintf(text, sizeof text, protocol, trip);
  command_write("p.yaml", text);
  return command_run("drive p.yaml --arm -f -o r.h5");
}

TEST(test_nidaqmx)
{
  struct dea_context *ctx;
  struct dea_recording *recording;
  char file[sizeof command_folder + 16];
  if (drive("9 uA") != 0) {
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
    assert_close(monitor->values[i], asked->values[i], 0, 1e-9);
    assert_close(second->values[i], 2e-9 * asked->values[i], 0, 1.5e-18);
    highest_V = fmax(highest_V, monitor->values[i]);
  }
  assert_close(highest_V, 2000, 0.01, 0);
  dea_recording_destroy(ctx, recording);
  dea_context_destroy(ctx);
  // The second channel taken as a current that must not flow: an early end, and its exit code.
  assert_int_equal(drive("1 uA"), 6);
  assert_non_null(strstr(command_err, "above safety.trip_current"));
  assert_non_null(strstr(command_out, "at 0 V"));
}

/* Without the library, or with another one of its name. */
TEST(test_no_library)
{
  char text[2 * sizeof command_folder + sizeof DEA_FAKE_FOLDER + 64];
  assert_int_equal(setenv("LD_LIBRARY_PATH", command_folder, 1), 0);
  assert_int_equal(drive("9 uA"), 2);
  assert_non_null(strstr(command_err, "NI-DAQmx is not on this computer"));
  assert_non_null(strstr(command_err, "dea drive --export"));
  snprintf(text, sizeof text, "cp '%s/fake_access.so' '%s/libnidaqmx.so.1'", DEA_FAKE_FOLDER,
           command_folder);
  assert_int_equal(system(text), 0);
  assert_int_equal(drive("9 uA"), 2);
  assert_non_null(strstr(command_err, "NI-DAQmx has no function DAQmxCreateTask"));
}

int main(void)
{
  return setenv("LD_LIBRARY_PATH", DEA_FAKE_FOLDER, 1) != 0 ||
         run_all(command_set_up, command_tear_down);
}
