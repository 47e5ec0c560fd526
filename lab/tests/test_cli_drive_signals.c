/* dea drive: signals in the middle of a measurement bring the voltage down along the ramp, however
 * many they are; after SIGKILL the recording is there. */
// ctest: slow, heavy
#include "command.h"

#include "recording/recording.h"

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
    execl(DEA_COMMAND, "dea", "drive", DEA_SOURCE_DIR "/lab/examples/cyclic.yaml", "--sim", "-o",
          file, "--set", "sequence=null", "--set",
          "waveform={kind: constant, voltage: 5 kV, duration: 60 s}", "--set",
          "sim={kind: sim, pace: real}", "--set", "safety.ramp=20 kV/s", (char *)NULL);
    _exit(98);
  }
  return child;
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

/* Samples of the asked voltage that a running recording has; *last_V: of the last one. */
static size_t look_at(struct dea_context *ctx, const char *name, double *last_V)
{
  char file[700];
  struct dea_recording *recording;
  size_t count = 0;
  *last_V = NAN;
  snprintf(file, sizeof file, "%s/%s", command_folder, name);
  if (dea_recording_read(ctx, file, &recording) == DEA_OK) {
    const struct dea_channel *asked = dea_recording_kind(recording, DEA_CHANNEL_COMMAND);
    count = asked != NULL ? asked->count : 0;
    *last_V = count > 0 ? asked->values[count - 1] : NAN;
    dea_recording_destroy(ctx, recording);
  }
  dea_context_clear(ctx);
  return count;
}

/* Waits until a recording has so many samples, however busy the machine is; the number of them. */
static size_t wait_for_samples(struct dea_context *ctx, const char *name, size_t samples)
{
  for (int i = 0; i < 2400; i++) {
    double last_V;
    size_t count = look_at(ctx, name, &last_V);
    if (count >= samples) {
      return count;
    }
    wait_s(0.05);
  }
  fail_msg("%s has less than %zu samples after two minutes", name, samples);
  return 0;
}

/* Waits until the voltage in a recording has begun to fall, or has come to 0 V. */
static double wait_for_fall(struct dea_context *ctx, const char *name, double below_V)
{
  double last_V = NAN;
  for (int i = 0; i < 2400 && !(last_V <= below_V); i++) {
    wait_s(0.02);
    look_at(ctx, name, &last_V);
  }
  return last_V;
}

TEST(test_signals_ramp_down)
{
  struct dea_context *ctx;
  int status;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  pid_t child = start("signals.h5");
  wait_for_samples(ctx, "signals.h5", 700);
  assert_int_equal(kill(child, SIGINT), 0);
  wait_for_fall(ctx, "signals.h5", 4999); // or it is over
  kill(child, SIGINT);
  kill(child, SIGHUP);
  kill(child, SIGTERM);
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status));
  assert_int_equal(WEXITSTATUS(status), 130);
  command_read("drive.txt", command_out);
  assert_contains(command_out, "at 0 V", "interrupted");
  struct dea_recording *recording = read_recording(ctx, "signals.h5");
  assert_false(recording->complete);
  assert_string_equal(recording->ended, "interrupted");
  const struct dea_channel *asked = dea_recording_kind(recording, DEA_CHANNEL_COMMAND);
  const struct dea_channel *measured = dea_recording_kind(recording, DEA_CHANNEL_VOLTAGE);
  size_t n = asked->count, top = 0;
  assert_true(n > 700 && n < 60000 && measured->count == n);
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

TEST(test_killed_drive)
{
  struct dea_context *ctx;
  int status;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  pid_t child = start("killed.h5");
  wait_for_samples(ctx, "killed.h5", 700);
  assert_int_equal(kill(child, SIGKILL), 0);
  assert_int_equal(waitpid(child, &status, 0), child);
  struct dea_recording *recording = read_recording(ctx, "killed.h5");
  assert_false(recording->complete);
  const struct dea_channel *asked = dea_recording_kind(recording, DEA_CHANNEL_COMMAND);
  assert_true(asked->count >= 700);
  for (size_t i = 0; i < asked->count; i++) {
    assert_true(asked->values[i] == 5000);
  }
  assert_true(recording->profiles.count > 0);
  dea_recording_destroy(ctx, recording);
  dea_context_destroy(ctx);
}

/* None of these may end or stop the program: they bring the voltage down too, or change nothing. */
TEST(test_other_signals)
{
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
  size_t counts[COUNT];
  int status;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  for (size_t i = 0; i < COUNT; i++) {
    snprintf(names[i], sizeof names[i], "signal-%zu.h5", i);
    children[i] = start(names[i]);
  }
  for (size_t i = 0; i < COUNT; i++) {
    counts[i] = wait_for_samples(ctx, names[i], 300);
    assert_int_equal(kill(children[i], signals[i].number), 0);
  }
  for (size_t i = 0; i < COUNT; i++) {
    if (!signals[i].ends) { // it plays on
      wait_for_samples(ctx, names[i], counts[i] + 500);
      assert_int_equal(waitpid(children[i], &status, WNOHANG | WUNTRACED), 0);
      assert_int_equal(kill(children[i], SIGTERM), 0);
    }
    assert_int_equal(waitpid(children[i], &status, 0), children[i]);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 130);
    struct dea_recording *recording = read_recording(ctx, names[i]);
    const struct dea_channel *asked = dea_recording_kind(recording, DEA_CHANNEL_COMMAND);
    assert_true(asked->count > 300 && asked->values[asked->count - 1] == 0);
    dea_recording_destroy(ctx, recording);
  }
  dea_context_destroy(ctx);
}

/* A terminal that takes no more (held by Ctrl-S, its connection gone) gets no progress; the voltage
 * comes down nevertheless. */
TEST(test_held_terminal)
{
  struct dea_context *ctx;
  int status, master = posix_openpt(O_RDWR | O_NOCTTY);
  char taken[4096];
  if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) {
    print_message("skipped: there are no pseudo-terminals here\n");
    skip();
  }
  int slave = open(ptsname(master), O_RDWR | O_NOCTTY | O_NONBLOCK);
  if (slave < 0) {
    print_message("skipped: no pseudo-terminal can be opened here\n");
    skip();
  }
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
  wait_for_samples(ctx, "held.h5", 700); // it plays on
  assert_int_equal(kill(child, SIGINT), 0);
  double last = wait_for_fall(ctx, "held.h5", 0);
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
TEST(test_two_into_one_file)
{
  struct dea_context *ctx;
  int status;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  pid_t child = start("two.h5");
  wait_for_samples(ctx, "two.h5", 100);
  command_expect("drive @/lab/examples/cyclic.yaml --sim -o two.h5 --force", 5,
                 "'two.h5' is being written by another program");
  assert_int_equal(kill(child, SIGINT), 0);
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 130);
  command_prints("recording two.h5", 0, "interrupted");
  assert_int_equal(command_run("drive @/lab/examples/cyclic.yaml --sim -o two.h5 --force --set "
                               "sequence=null --set 'waveform={kind: constant, voltage: 1 kV}'"),
                   0); // nobody writes it now
  child = start("lost.h5");
  wait_for_samples(ctx, "lost.h5", 100);
  char file[700];
  snprintf(file, sizeof file, "%s/lost.h5", command_folder);
  assert_int_equal(unlink(file), 0);
  assert_int_equal(kill(child, SIGINT), 0);
  assert_int_equal(waitpid(child, &status, 0), child);
  command_read("drive.err", command_err);
  assert_contains(command_err, "was removed or replaced while it was written");
  dea_context_destroy(ctx);
}

TESTS(command_set_up, command_tear_down)
