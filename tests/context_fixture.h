/* One context for all tests of a program: TESTS(context_set_up, context_tear_down). */
#pragma once

#include "base/context.h"

static struct dea_context *ctx;

/* That a call with this context went well; says what it says when it did not. */
#define assert_ok(call)                                                                            \
  do {                                                                                             \
    if ((call) != DEA_OK) {                                                                        \
      fail_msg("%s: %s", #call, dea_context_message(ctx));                                         \
    }                                                                                              \
  } while (0)

static inline int context_set_up(void **state)
{
  (void)state;
  return dea_context_create(NULL, &ctx) == DEA_OK ? 0 : -1;
}

static inline int context_tear_down(void **state)
{
  (void)state;
  dea_context_destroy(ctx);
  return 0;
}
