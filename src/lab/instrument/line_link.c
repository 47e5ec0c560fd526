#include "lab/instrument/line_link.h"

#include "base/clock.h"

dea_status dea_line_wait(struct dea_context *ctx, struct dea_line_link *link, double timeout_s,
                         const char **out)
{
  char bytes[1024];
  double until_s = dea_clock_s() + timeout_s;
  *out = NULL;
  for (double left_s = timeout_s; left_s > 0 && *out == NULL;) {
    size_t length;
    const char *at = bytes;
    DEA_TRY(ctx, dea_socket_read(ctx, &link->socket, left_s, bytes, sizeof bytes, &length));
    *out = dea_line_next(&link->lines, &at, &length); // nobody speaks unasked
    left_s = until_s - dea_clock_s();
    if (dea_interrupted(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted");
    }
  }
  return DEA_OK;
}
