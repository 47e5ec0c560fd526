/* lab/recording: a program that records is killed between any two of its calls; what it had
 * announced is there, and every value is the right one. `test_lab_killed COUNT [SEED]` makes that
 * many kills at random moments (verify/recordings.sh). */
// ctest: quick, heavy
#include "own_disk.h"
#include "own_folder.h"
#include "recording_samples.h"

#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>

enum { STAGES = 5, KILLS = 40, CYCLES = 30 };

static void need(dea_status status)
{
  if (status != DEA_OK) {
    _exit(1);
  }
}

/* Says on `out` that one more call has returned. */
static void announce(int out, uint32_t *calls)
{
  ++*calls;
  if (write(out, calls, sizeof *calls) != sizeof *calls) {
    _exit(1);
  }
}

/* Records as fast as it can, for ever: STAGES calls a cycle, each announced. */
static void record_for_ever(const char *file, int out)
{
  struct dea_context *own;
  struct dea_recorder *recorder;
  need(dea_context_create(NULL, &own));
  need(sample_create(own, file, false, 0.002, &recorder));
  for (uint32_t i = 0, calls = 0;; i++) {
    need(sample_add(recorder, (size_t)i * SAMPLE_CYCLE, 300));
    announce(out, &calls);
    need(sample_add_reading(recorder, i));
    announce(out, &calls);
    need(sample_add(recorder, (size_t)i * SAMPLE_CYCLE + 300, SAMPLE_CYCLE - 300));
    announce(out, &calls);
    need(sample_add_frame(recorder, i));
    announce(out, &calls);
    struct dea_recorded_cycle cycle = sample_cycle(i);
    need(dea_recorder_add_cycle(recorder, &cycle));
    announce(out, &calls);
  }
}

/* Kills it some time after so many calls have returned, wherever it is by then; the number of
 * cycles that it had announced. */
static uint32_t kill_after(const char *file, uint32_t calls, double wait_s)
{
  int ends[2], status;
  assert_int_equal(pipe(ends), 0);
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    close(ends[0]);
    record_for_ever(file, ends[1]);
  }
  close(ends[1]);
  uint32_t last = 0, number;
  while (last < calls) {
    assert_int_equal(read(ends[0], &last, sizeof last), sizeof last);
  }
  if (wait_s > 0) {
    dea_clock_wait(wait_s);
  }
  assert_int_equal(kill(child, SIGKILL), 0);
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  while (read(ends[0], &number, sizeof number) == sizeof number) {
    last = number; // until it was dead
  }
  close(ends[0]);
  return last / STAGES;
}

static uint32_t kill_count = KILLS, seed;

TEST(test_killed_recordings_keep_what_was_announced)
{
  size_t kept = 0;
  for (uint32_t k = 0; k < kill_count; k++) {
    struct dea_recording *recording;
    char name[32];
    snprintf(name, sizeof name, "killed-%" PRIu32 ".h5", k);
    const char *file = in_folder(name);
    uint32_t calls = 1 + k + k * k / 8; // each stage of a cycle, early and late
    double wait_s = 0;
    if (seed > 0) {
      unsigned by_chance = 2654435761U * (seed + k);
      calls = 1 + (uint32_t)rand_r(&by_chance) % 600;
      wait_s = 2e-3 * rand_r(&by_chance) / RAND_MAX;
    }
    uint32_t cycles = kill_after(file, calls, wait_s);
    assert_true(cycles >= calls / STAGES);
    if (dea_recording_read(ctx, file, &recording) != DEA_OK) {
      fail_msg("after %" PRIu32 " calls: %s", calls, dea_context_message(ctx));
    }
    assert_false(recording->complete);
    assert_non_null(strstr(recording->ended, "killed"));
    sample_check(recording, (size_t)cycles * SAMPLE_CYCLE, cycles, cycles, cycles);
    dea_recording_destroy(ctx, recording);
    unlink(file);
    kept += cycles;
  }
  print_message("%" PRIu32 " kills, %zu cycles announced, all kept\n", kill_count, kept);
}

/* Records some cycles on a disk that takes so many writes only, the last one in part: the file is
 * then what a kill at that moment leaves. The number of cycles that were announced. */
static size_t record_some(const char *file, long writes, bool *all)
{
  struct dea_recorder *recorder;
  size_t announced = 0;
  unlink(file);
  assert_int_equal(sample_create(ctx, file, false, 100, &recorder), DEA_OK);
  disk_writes_left = writes;
  for (size_t i = 0; i < CYCLES; i++) {
    struct dea_recorded_cycle cycle = sample_cycle(i);
    sample_add(recorder, i * SAMPLE_CYCLE, SAMPLE_CYCLE);
    sample_add_reading(recorder, i);
    sample_add_frame(recorder, i);
    if (dea_recorder_add_cycle(recorder, &cycle) != DEA_OK) {
      break;
    }
    announced++;
  }
  *all = dea_recorder_finish(recorder, NULL) == DEA_OK;
  disk_writes_left = DISK_ENDLESS;
  return announced;
}

/* The same without chance: an end after each single write that reaches the disk. */
TEST(test_every_write_may_be_the_last)
{
  const char *file = in_folder("writes.h5");
  bool all = false;
  long n = 0;
  for (; !all; n++) {
    struct dea_recording *recording;
    size_t announced = record_some(file, n, &all);
    if (dea_recording_read(ctx, file, &recording) != DEA_OK) {
      fail_msg("after %ld writes: %s", n, dea_context_message(ctx));
    }
    // it is complete before HDF5 has closed it
    assert_true(recording->complete ? announced == CYCLES : !all);
    sample_check(recording, announced * SAMPLE_CYCLE, announced, announced, announced);
    dea_recording_destroy(ctx, recording);
  }
  print_message("%ld writes\n", n);
  assert_true(n > 200);
}

int main(int count, char **arguments)
{
  const struct CMUnitTest many[] = {
      cmocka_unit_test(test_killed_recordings_keep_what_was_announced)};
  if (count > 1) {
    kill_count = (uint32_t)strtoul(arguments[1], NULL, 10);
    seed = count > 2 ? (uint32_t)strtoul(arguments[2], NULL, 10) : 1;
    return cmocka_run_group_tests(many, set_up, tear_down);
  }
  return run_all(set_up, tear_down);
}
