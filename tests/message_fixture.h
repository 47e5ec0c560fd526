/* What a call that fails must say. */
#pragma once

#include "testing.h"

#include <string.h>

#include "context_fixture.h"

static inline void assert_message(dea_status status, dea_status wanted, const char *part)
{
  if (status != wanted || strstr(dea_context_message(ctx), part) == NULL) {
    fail_msg("%s, not %s: '%s' should hold '%s'", dea_status_name(status), dea_status_name(wanted),
             dea_context_message(ctx), part);
  }
}
