/* Other programs as processes: what they say, how they end, how long they may take. */
#include "base/clock.h"
#include "base/program.h"
#include "testing.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "context_fixture.h"

static char said[DEA_PROGRAM_SAID];
static int number;

static enum dea_program_end shell(const char *script, bool all, double limit_s)
{
  char command[200], sh[] = "sh", run[] = "-c";
  char *const argv[] = {sh, run, command, NULL};
  struct dea_program program;
  strcpy(command, script);
  assert_int_equal(dea_program_start(argv, "/", all, &program), 0);
  return dea_program_wait(ctx, &program, limit_s, said, &number);
}

TEST(test_ends)
{
  assert_int_equal(shell("echo one; echo two >&2; pwd", true, INFINITY), DEA_PROGRAM_DONE);
  assert_string_equal(said, "one\ntwo\n/");
  assert_string_equal(dea_last_lines(said, 2), "two\n/");
  assert_string_equal(dea_last_lines(said, 9), said);
  assert_int_equal(shell("echo one; echo two >&2; exit 3", false, 10), DEA_PROGRAM_FAILED);
  assert_string_equal(said, "two");
  assert_int_equal(number, 3);
  assert_int_equal(shell("kill -SEGV $$", true, 10), DEA_PROGRAM_CRASHED);
  assert_int_equal(number, SIGSEGV);
}

/* Of much that is said the last is kept. */
TEST(test_last_words)
{
  assert_int_equal(shell("i=0; while [ $i -lt 3000 ]; do echo line $i; i=$((i+1)); done", true, 60),
                   DEA_PROGRAM_DONE);
  assert_true(strlen(said) > DEA_PROGRAM_SAID / 2);
  assert_string_equal(dea_last_lines(said, 2), "line 2998\nline 2999");
}

static bool always(void *user)
{
  return true;
}

TEST(test_ended_by_us)
{
  double start_s = dea_clock_s();
  assert_int_equal(shell("echo here; exec sleep 60", true, 0.1), DEA_PROGRAM_TOO_LONG);
  assert_string_equal(said, "here");
  // the limit is one of processor time: what waits has ten times as long
  assert_int_equal(shell("exec sleep 1", true, 0.5), DEA_PROGRAM_DONE);
  double loop_s = dea_clock_s();
  assert_int_equal(shell("while :; do :; done", true, 0.3), DEA_PROGRAM_TOO_LONG);
  assert_true(dea_clock_s() - loop_s >= 0.3);
  dea_context_set_interrupt_fn(ctx, always, NULL);
  assert_int_equal(shell("exec sleep 60", true, INFINITY), DEA_PROGRAM_INTERRUPTED);
  dea_context_set_interrupt_fn(ctx, NULL, NULL);
  assert_true(dea_clock_s() - start_s < 50); // not those of the programs
}

/* What a program starts ends with it. */
TEST(test_ended_with_its_own)
{
  assert_int_equal(shell("sleep 60 & echo $!; wait", true, 0.1), DEA_PROGRAM_TOO_LONG);
  pid_t child = (pid_t)strtol(said, NULL, 10);
  assert_true(child > 1);
  for (int k = 0; k < 200 && kill(child, 0) == 0; k++) { // until whoever reaps orphans did
    char path[64], state_of = 'Z';
    snprintf(path, sizeof path, "/proc/%d/stat", (int)child);
    FILE *stat = fopen(path, "r");
    if (stat != NULL) {
      int found = fscanf(stat, "%*d %*s %c", &state_of);
      fclose(stat);
      if (found == 1 && state_of == 'Z') {
        return;
      }
    }
    nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL);
    if (k == 199) {
      fail_msg("%d still runs", (int)child);
    }
  }
}

TEST(test_missing)
{
  char name[] = "no-such-program-at-all";
  char *const argv[] = {name, NULL};
  struct dea_program program;
  assert_int_equal(dea_program_start(argv, "/", true, &program), ENOENT);
}

TESTS(context_set_up, context_tear_down)
