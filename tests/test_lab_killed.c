/* lab/recording: a program that records is killed at random moments; what it had announced is
 * there, and every value is the right one. */
#define _GNU_SOURCE
#include "lab/recording/disk.h"
#include "own_folder.h"
#include "recording_samples.h"

#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>

enum { KILLS = 40, LONGEST_US = 60000, CYCLES = 30 };

static void need(dea_status status)
{
  if (status != DEA_OK) {
    _exit(1);
  }
}

/* Records as fast as it can, for ever; says on `out` how many cycles are done. */
static void record_for_ever(const char *file, int out)
{
  struct dea_context *own;
  struct dea_recorder *recorder;
  need(dea_context_create(NULL, &own));
  need(sample_create(own, file, false, 0.002, &recorder));
  for (uint32_t i = 0;; i++) {
    need(sample_add(recorder, (size_t)i * SAMPLE_CYCLE, 300));
    need(sample_add_reading(recorder, i));
    need(sample_add(recorder, (size_t)i * SAMPLE_CYCLE + 300, SAMPLE_CYCLE - 300));
    need(sample_add_frame(recorder, i));
    struct dea_recorded_cycle cycle = sample_cycle(i);
    need(dea_recorder_add_cycle(recorder, &cycle));
    uint32_t done = i + 1;
    if (write(out, &done, sizeof done) != sizeof done) {
      _exit(1);
    }
  }
}

/* Reads what the child has announced so far, without waiting for more once it is dead. */
static uint32_t last_announced(int in)
{
  uint32_t last = 0, number;
  while (read(in, &number, sizeof number) == sizeof number) {
    last = number;
  }
  return last;
}

static uint32_t kill_once(const char *file, unsigned wait_us)
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
  // from the first cycle on, so that the wait covers recording and not the start of a program
  uint32_t first;
  assert_int_equal(read(ends[0], &first, sizeof first), sizeof first);
  fcntl(ends[0], F_SETPIPE_SZ, 1 << 20);
  nanosleep(&(struct timespec){.tv_nsec = 1000L * wait_us}, NULL);
  assert_int_equal(kill(child, SIGKILL), 0);
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  uint32_t last = last_announced(ends[0]);
  close(ends[0]);
  return last > first ? last : first;
}

static void test_killed_recordings_keep_what_was_announced(void **state)
{
  (void)state;
  unsigned seed = (unsigned)time(NULL) ^ (unsigned)getpid();
  uint32_t most = 0;
  print_message("seed %u\n", seed);
  for (int k = 0; k < KILLS; k++) {
    struct dea_recording *recording;
    char name[32];
    snprintf(name, sizeof name, "killed-%d.h5", k);
    const char *file = in_folder(name);
    uint32_t cycles = kill_once(file, (unsigned)rand_r(&seed) % LONGEST_US);
    if (dea_recording_read(ctx, file, &recording) != DEA_OK) {
      fail_msg("%d: %s", k, dea_context_message(ctx));
    }
    assert_false(recording->complete);
    assert_non_null(strstr(recording->ended, "killed"));
    sample_check(recording, (size_t)cycles * SAMPLE_CYCLE, cycles, cycles, cycles);
    dea_recording_destroy(ctx, recording);
    most = cycles > most ? cycles : most;
    unlink(file);
  }
  print_message("up to %" PRIu32 " cycles\n", most);
  assert_true(most > 20);
}

/* Records some cycles on a disk that takes so many writes only, the last one in part: the file is
 * then what a kill at that moment leaves. The number of cycles that were announced. */
static size_t record_some(const char *file, long writes, bool *all)
{
  struct dea_recorder *recorder;
  size_t announced = 0;
  unlink(file);
  assert_int_equal(sample_create(ctx, file, false, 100, &recorder), DEA_OK);
  dea_recorder_disk(recorder)->writes_left = writes;
  for (size_t i = 0; i < CYCLES; i++) {
    struct dea_recorded_cycle cycle = sample_cycle(i);
    sample_add(recorder, i * SAMPLE_CYCLE, SAMPLE_CYCLE);
    sample_add_reading(recorder, i);
    sample_add_frame(recorder, i);
    if (i % 9 == 5) {
      dea_recorder_flush(recorder);
    }
    if (dea_recorder_add_cycle(recorder, &cycle) != DEA_OK) {
      break;
    }
    announced++;
  }
  *all = dea_recorder_finish(recorder, NULL) == DEA_OK;
  return announced;
}

/* The same without chance: an end after each single write that reaches the disk. */
static void test_every_write_may_be_the_last(void **state)
{
  (void)state;
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

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_every_write_may_be_the_last),
      cmocka_unit_test(test_killed_recordings_keep_what_was_announced)};
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
