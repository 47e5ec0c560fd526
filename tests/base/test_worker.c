/* Work in processes beside this one. */
// ctest: quick
#include "base/worker.h"
#include "testing.h"

#include "context_fixture.h"

#include <signal.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static int seen; // by this process

struct task {
  double number;
  dea_status status;
  bool dies;
};

static dea_status work(struct dea_context *context, void *user, struct dea_bytes *out)
{
  const struct task *task = user;
  seen++;
  dea_bytes_add(out, &task->number, sizeof task->number);
  if (task->dies) {
    raise(SIGKILL);
  }
  dea_finding_add(context, DEA_WARNING, (struct dea_location){"a file", 3, 4}, "seen: %g",
                  task->number);
  dea_finding_add(context, DEA_NOTE, (struct dea_location){0}, "known");
  return task->status == DEA_OK ? DEA_OK : dea_fail(context, task->status, "no %g", task->number);
}

static double taken(const struct dea_worker *secondary, dea_status wanted)
{
  const char *bytes;
  size_t length;
  double number = NAN;
  assert_int_equal(dea_worker_collect(ctx, secondary, &bytes, &length), wanted);
  assert_true(length == sizeof number || (length == 0 && wanted == DEA_E_TOOL));
  if (length > 0) {
    memcpy(&number, bytes, sizeof number);
  }
  return number;
}

/* Bytes, findings, status and message of each come here; what else it does stays there. */
TEST(test_hands_back)
{
  struct task tasks[] = {{1.5, DEA_OK, false}, {2.5, DEA_E_SLACK, false}, {3.5, DEA_OK, true}};
  struct dea_worker at[3] = {{0}};
  size_t count;
  dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0}, "known");
  for (int i = 0; i < 3; i++) {
    assert_int_equal(dea_worker_start(ctx, work, &tasks[i], &at[i]), DEA_OK);
  }
  assert_int_equal(dea_worker_wait(ctx, at, 3, 0), DEA_OK);
  assert_false(dea_worker_failed(&at[0]));
  assert_true(dea_worker_failed(&at[1]) && dea_worker_failed(&at[2]));
  assert_close(taken(&at[0], DEA_OK), 1.5, 0, 0);
  assert_close(taken(&at[1], DEA_E_SLACK), 2.5, 0, 0);
  assert_string_equal(dea_context_message(ctx), "no 2.5");
  taken(&at[2], DEA_E_TOOL);
  assert_int_equal(seen, 0);
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  assert_int_equal(count, 3); // one known, two new
  assert_string_equal(findings[1].text, "seen: 1.5");
  assert_string_equal(findings[1].location.file, "a file");
  assert_true(findings[1].severity == DEA_WARNING && findings[1].location.line == 3 &&
              findings[1].location.column == 4);
  assert_string_equal(findings[2].text, "seen: 2.5");
  for (int i = 0; i < 3; i++) {
    dea_worker_end(&at[i]);
    assert_false(dea_worker_failed(&at[i]));
  }
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
}

static dea_status wait_to_stop(struct dea_context *context, void *user, struct dea_bytes *out)
{
  const double number = *(const double *)user;
  const struct timespec little = {.tv_nsec = 1000000};
  dea_bytes_add(out, &number, sizeof number);
  while (!dea_interrupted(context)) {
    nanosleep(&little, NULL);
  }
  return dea_fail(context, DEA_E_INTERRUPTED, "stopped");
}

/* An interruption here reaches those beside, whose part is kept; one that is not waited for ends at
 * once. */
TEST(test_interrupted)
{
  double number = 7;
  struct task task = {1, DEA_OK, false};
  struct dea_worker at[3] = {{0}};
  volatile sig_atomic_t flag = 0;
  assert_int_equal(dea_worker_start(ctx, wait_to_stop, &number, &at[0]), DEA_OK);
  assert_int_equal(dea_worker_start(ctx, work, &task, &at[1]), DEA_OK);
  assert_int_equal(dea_worker_start(ctx, wait_to_stop, &number, &at[2]), DEA_OK);
  assert_int_equal(dea_worker_wait(ctx, at, 2, 1), DEA_OK); // the second has ended
  assert_false(dea_worker_failed(&at[0]) || dea_worker_failed(&at[1]));
  dea_context_set_interrupt(ctx, &flag);
  flag = 1;
  assert_int_equal(dea_worker_wait(ctx, at, 2, 0), DEA_OK);
  dea_context_set_interrupt(ctx, NULL);
  assert_close(taken(&at[0], DEA_E_INTERRUPTED), 7, 0, 0);
  assert_close(taken(&at[1], DEA_OK), 1, 0, 0);
  const pid_t third = at[2].process;
  assert_true(third > 0);
  for (int i = 0; i < 3; i++) {
    dea_worker_end(&at[i]);
  }
  assert_int_equal(kill(third, 0), -1);
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
}

TESTS(context_set_up, context_tear_down)
