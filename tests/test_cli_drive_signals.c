/* dea drive: signals in the middle of a measurement bring the voltage down along the ramp, however
 * many they are; after SIGKILL the recording is there. */
#define _GNU_SOURCE
#include "command.h"

#include "lab/recording/recording.h"

#include <signal.h>
#include <time.h>

static void wait_s(double seconds)
{
  struct timespec wait = {.tv_sec = (time_t)seconds};
  wait.tv_nsec = (long)(1e9 * (seconds - (double)wait.tv_sec));
  nanosleep(&wait, NULL);
}

/* 5 kV for a minute on the simulated bench, as slow as a real one. */
static pid_t start(const char *file)
{
  fflush(NULL);
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    if (chdir(command_folder) != 0 || freopen("drive.txt", "w", stdout) == NULL ||
        freopen("drive.err", "w", stderr) == NULL) {
      _exit(99);
    }
    execl(DEA_COMMAND, "dea", "drive", DEA_SOURCE_DIR "/examples/bench/cyclic.yaml", "--sim", "-o",
          file, "--set", "sequence=null", "--set",
          "waveform={kind: constant, voltage: 5 kV, duration: 60 s}", "--set",
          "sim={kind: sim, pace: real}", "--set", "safety.ramp=20 kV/s", (char *)NULL);
    _exit(98);
  }
  return child;
}

/* Waits until the recording has some of it. */
static void wait_for_recording(const char *name)
{
  char file[700], command[800];
  snprintf(file, sizeof file, "%s/%s", command_folder, name);
  for (int i = 0; i < 200 && access(file, F_OK) != 0; i++) {
    wait_s(0.05);
  }
  wait_s(0.8);
  snprintf(command, sizeof command, "test -s '%s'", file);
  assert_int_equal(system(command), 0);
}

static struct dea_recording *read_recording(struct dea_context *ctx, const char *name)
{
  char file[700];
  struct dea_recording *recording;
  snprintf(file, sizeof file, "%s/%s", command_folder, name);
  if (dea_recording_read(ctx, file, &recording) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  return recording;
}

static void test_signals_ramp_down(void **state)
{
  (void)state;
  struct dea_context *ctx;
  int status;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  pid_t child = start("signals.h5");
  wait_for_recording("signals.h5");
  assert_int_equal(kill(child, SIGINT), 0);
  wait_s(0.03);
  kill(child, SIGINT);
  kill(child, SIGHUP);
  kill(child, SIGTERM);
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status));
  assert_int_equal(WEXITSTATUS(status), 130);
  command_read("drive.txt", command_out);
  assert_contains(command_out, "at 0 V");
  assert_contains(command_out, "interrupted");
  struct dea_recording *recording = read_recording(ctx, "signals.h5");
  assert_false(recording->complete);
  assert_string_equal(recording->ended, "interrupted");
  const struct dea_channel *asked = dea_recording_kind(recording, DEA_CHANNEL_COMMAND);
  const struct dea_channel *measured = dea_recording_kind(recording, DEA_CHANNEL_VOLTAGE);
  size_t n = asked->count, top = 0;
  assert_true(n > 500 && n < 20000 && measured->count == n);
  while (top < n && asked->values[top] == 5000) {
    top++;
  }
  assert_int_equal(n - top, 250); // 5 kV at 20 V a sample
  for (size_t i = top; i < n; i++) {
    assert_close(asked->values[i], 5000 - 20 * (double)(i - top + 1), 0, 1e-6);
    assert_close(measured->values[i], asked->values[i], 0, 200);
  }
  dea_recording_destroy(ctx, recording);
  dea_context_destroy(ctx);
}

static void test_killed_drive(void **state)
{
  (void)state;
  struct dea_context *ctx;
  int status;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  pid_t child = start("killed.h5");
  wait_for_recording("killed.h5");
  assert_int_equal(kill(child, SIGKILL), 0);
  assert_int_equal(waitpid(child, &status, 0), child);
  struct dea_recording *recording = read_recording(ctx, "killed.h5");
  assert_false(recording->complete);
  const struct dea_channel *asked = dea_recording_kind(recording, DEA_CHANNEL_COMMAND);
  assert_true(asked->count > 200);
  for (size_t i = 0; i < asked->count; i++) {
    assert_true(asked->values[i] == 5000);
  }
  assert_true(recording->profiles.count > 0);
  dea_recording_destroy(ctx, recording);
  dea_context_destroy(ctx);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_signals_ramp_down),
      cmocka_unit_test(test_killed_drive),
  };
  return cmocka_run_group_tests(tests, command_set_up, command_tear_down);
}
