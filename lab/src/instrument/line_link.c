#include "instrument/line_link.h"

#include "base/clock.h"

#include <string.h>

dea_status dea_line_alone(struct dea_context *ctx, const struct dea_line_link *link,
                          const char *line, const char *bytes, size_t length)
{
  size_t i = 0, end;
  while (i < length && memchr("\r\n", bytes[i], 2) != NULL) {
    i++;
  }
  for (end = i; end < length && (unsigned char)bytes[end] >= ' ';) {
    end++;
  }
  if (i == length) {
    return DEA_OK;
  }
  int shown = (int)(end - i < 40 ? end - i : 40);
  return line != NULL
             ? dea_fail(ctx, DEA_E_INSTRUMENT,
                        "%s answered with more than one line, '%.40s' and '%.*s': neither is "
                        "believed",
                        link->socket.name, line, shown, bytes + i)
             : dea_fail(ctx, DEA_E_INSTRUMENT,
                        "%s said '%.*s' without being asked: which question its next answer "
                        "belongs to is not known",
                        link->socket.name, shown, bytes + i);
}

dea_status dea_line_unasked(struct dea_context *ctx, const struct dea_line_link *link)
{
  char bytes[1024];
  size_t length;
  DEA_TRY(ctx, dea_line_alone(ctx, link, NULL, link->lines.line, link->lines.length));
  DEA_TRY(ctx, dea_socket_read(ctx, &link->socket, 0, bytes, sizeof bytes, &length));
  return dea_line_alone(ctx, link, NULL, bytes, length);
}

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
    *out = dea_line_next(&link->lines, &at, &length);
    DEA_TRY(ctx, *out != NULL ? dea_line_alone(ctx, link, *out, at, length) : DEA_OK);
    left_s = until_s - dea_clock_s();
    if (dea_interrupted(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted");
    }
  }
  return DEA_OK;
}
