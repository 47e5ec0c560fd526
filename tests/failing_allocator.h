/* Runs a piece of work again and again; in the n-th run the n-th allocation fails. */
#pragma once

#include "base/context.h"
#include "testing.h"

#include <stdbool.h>
#include <stdlib.h>

extern long units_lent; // tables of units that are out (units_once.c)

struct failing_count {
  long left;  // allocations until the one that fails; negative: none fails
  long alive; // allocated and not released
  bool failed;
};

static inline void *failing_resize(void *user, void *pointer, size_t size)
{
  struct failing_count *count = user;
  if (count->left == 0) {
    count->failed = true;
    return NULL;
  }
  count->left -= count->left > 0;
  void *moved = realloc(pointer, size);
  count->alive += moved != NULL && pointer == NULL;
  return moved;
}

static inline void failing_release(void *user, void *pointer)
{
  struct failing_count *count = user;
  count->alive -= pointer != NULL;
  free(pointer);
}

/* To be called by the work with its status: good, or out of memory with a message. */
static inline void failing_check(const struct dea_context *ctx, dea_status status)
{
  if (status != DEA_OK) {
    assert_int_equal(status, DEA_E_MEMORY);
    assert_true(dea_context_message(ctx)[0] != '\0');
  }
}

/* One run with allocation number n failed (from 0); false when there were not so many. */
static inline bool failing_run(void (*work)(struct dea_context *ctx, void *user), void *user,
                               long n, struct failing_count *count)
{
  long lent = units_lent;
  *count = (struct failing_count){.left = -1};
  struct dea_allocator allocator = {failing_resize, failing_release, count};
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(&allocator, &ctx), DEA_OK);
  count->left = n;
  work(ctx, user);
  count->left = -1;
  dea_context_destroy(ctx);
  if (count->alive != 0) {
    fail_msg("%ld allocations left when number %ld failed", count->alive, n);
  }
  assert_int_equal(units_lent, lent);
  return count->failed;
}

typedef void (*failing_work)(struct dea_context *ctx);

static inline void failing_work_run(struct dea_context *ctx, void *user)
{
  (*(failing_work *)user)(ctx);
}

/* Returns the number of allocations of the work; checks in every run that nothing is left over. */
static inline long failing_each(failing_work work)
{
  struct failing_count count;
  long n = 0;
  while (failing_run(failing_work_run, &work, n, &count)) {
    n++;
  }
  return n;
}

struct failing_attempt {
  dea_status (*call)(struct dea_context *ctx);
  dea_status status;
};

static inline void failing_attempt_run(struct dea_context *ctx, void *user)
{
  struct failing_attempt *attempt = user;
  attempt->status = attempt->call(ctx);
}

/* The same for a call that answers out of memory whenever an allocation fails, else `wanted`. */
static inline long failing_ends(dea_status (*call)(struct dea_context *ctx), dea_status wanted)
{
  struct failing_attempt attempt = {.call = call};
  struct failing_count count;
  long n = 0;
  while (failing_run(failing_attempt_run, &attempt, n, &count)) {
    assert_int_equal(attempt.status, DEA_E_MEMORY);
    n++;
  }
  assert_int_equal(attempt.status, wanted);
  return n;
}
