/* dea drive: signals in the middle of a measurement bring the voltage down along the ramp, however
 * many they are; after SIGKILL the recording is there. */
#define _GNU_SOURCE
#include "command.h"

#include "lab/recording/recording.h"

#include <fcntl.h>
#include <signal.h>
#include <time.h>

static void wait_s(double seconds)
{
  struct timespec wait = {.tv_sec = (time_t)seconds};
  wait.tv_nsec = (long)(1e9 * (seconds - (double)wait.tv_sec));
  nanosleep(&wait, NULL);
}

static pid_t start_with(const char *file, const char *err);

/* 5 kV for a minute on the simulated bench, as slow as a real one. */
static pid_t start(const char *file)
{
  return start_with(file, "drive.err");
}

static pid_t start_with(const char *file, const char *err)
{
  fflush(NULL);
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    if (chdir(command_folder) != 0 || freopen("drive.txt", "w", stdout) == NULL ||
        freopen(err, "w", stderr) == NULL) {
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

/* None of these may end or stop the program: they bring the voltage down too, or change nothing. */
static void test_other_signals(void **state)
{
  (void)state;
  static const struct {
    int number;
    bool ends;
  } signals[] = {{SIGHUP, true},   {SIGQUIT, true},  {SIGUSR1, true},  {SIGALRM, true},
                 {SIGXCPU, true},  {SIGXFSZ, false}, {SIGTTOU, false}, {SIGTTIN, false},
                 {SIGTSTP, false}, {SIGPIPE, false}};
  enum { COUNT = sizeof signals / sizeof signals[0] };
  struct dea_context *ctx;
  pid_t children[COUNT];
  char names[COUNT][32];
  int status;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  for (size_t i = 0; i < COUNT; i++) {
    snprintf(names[i], sizeof names[i], "signal-%zu.h5", i);
    children[i] = start(names[i]);
  }
  for (size_t i = 0; i < COUNT; i++) {
    wait_for_recording(names[i]);
    assert_int_equal(kill(children[i], signals[i].number), 0);
  }
  wait_s(0.1);
  for (size_t i = 0; i < COUNT; i++) {
    if (!signals[i].ends) {
      assert_int_equal(waitpid(children[i], &status, WNOHANG | WUNTRACED), 0);
      assert_int_equal(kill(children[i], SIGTERM), 0);
    }
    assert_int_equal(waitpid(children[i], &status, 0), children[i]);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 130);
    struct dea_recording *recording = read_recording(ctx, names[i]);
    const struct dea_channel *asked = dea_recording_kind(recording, DEA_CHANNEL_COMMAND);
    assert_true(asked->count > 250 && asked->values[asked->count - 1] == 0);
    dea_recording_destroy(ctx, recording);
  }
  dea_context_destroy(ctx);
}

/* A terminal that takes no more (held by Ctrl-S, its connection gone) gets no progress; the voltage
 * comes down nevertheless. */
static void test_held_terminal(void **state)
{
  (void)state;
  struct dea_context *ctx;
  int status, master = posix_openpt(O_RDWR | O_NOCTTY);
  char taken[4096];
  double last = NAN;
  assert_true(master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0);
  int slave = open(ptsname(master), O_RDWR | O_NOCTTY | O_NONBLOCK);
  assert_true(slave >= 0);
  memset(taken, '.', sizeof taken);
  for (int i = 0; i < 8; i++) { // what went in makes room once it has gone on
    for (size_t n = sizeof taken; n > 0; n /= 2) {
      while (write(slave, taken, n) > 0) {
      }
    }
    wait_s(0.05);
  }
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  pid_t child = start_with("held.h5", ptsname(master));
  wait_for_recording("held.h5");
  struct dea_recording *running = read_recording(ctx, "held.h5");
  assert_true(dea_recording_kind(running, DEA_CHANNEL_COMMAND)->count > 200); // it plays on
  dea_recording_destroy(ctx, running);
  assert_int_equal(kill(child, SIGINT), 0);
  for (int i = 0; i < 100 && last != 0; i++) {
    wait_s(0.05);
    struct dea_recording *recording = read_recording(ctx, "held.h5");
    const struct dea_channel *asked = dea_recording_kind(recording, DEA_CHANNEL_COMMAND);
    last = asked->count > 0 ? asked->values[asked->count - 1] : (double)NAN;
    dea_recording_destroy(ctx, recording);
  }
  fcntl(master, F_SETFL, O_NONBLOCK); // now it is read, so that it can say why it ended
  do {
    wait_s(0.02);
    (void)!read(master, taken, sizeof taken);
  } while (waitpid(child, &status, WNOHANG) == 0);
  assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 130);
  assert_true(last == 0);
  close(slave);
  close(master);
  dea_context_destroy(ctx);
}

/* A second drive does not take away the file of the first; and who lost it says so. */
static void test_two_into_one_file(void **state)
{
  (void)state;
  int status;
  pid_t child = start("two.h5");
  wait_for_recording("two.h5");
  assert_int_equal(command_run("drive @/examples/bench/cyclic.yaml --sim -o two.h5 --force"), 5);
  assert_contains(command_err, "'two.h5' is being written by another program");
  assert_int_equal(kill(child, SIGINT), 0);
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 130);
  assert_int_equal(command_run("recording two.h5"), 0);
  assert_contains(command_out, "interrupted");
  assert_int_equal(command_run("drive @/examples/bench/cyclic.yaml --sim -o two.h5 --force --set "
                               "sequence=null --set 'waveform={kind: constant, voltage: 1 kV}'"),
                   0); // nobody writes it now
  child = start("lost.h5");
  wait_for_recording("lost.h5");
  char file[700];
  snprintf(file, sizeof file, "%s/lost.h5", command_folder);
  assert_int_equal(unlink(file), 0);
  assert_int_equal(kill(child, SIGINT), 0);
  assert_int_equal(waitpid(child, &status, 0), child);
  command_read("drive.err", command_err);
  assert_contains(command_err, "was removed or replaced while it was written");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_signals_ramp_down), cmocka_unit_test(test_killed_drive),
      cmocka_unit_test(test_other_signals),     cmocka_unit_test(test_held_terminal),
      cmocka_unit_test(test_two_into_one_file),
  };
  return cmocka_run_group_tests(tests, command_set_up, command_tear_down);
}
