/* Feeds lines of text to a target, in parts of any size. */
#pragma once

#include "instrument/line_reader.h"

#include <stdint.h>
#include <string.h>

static inline void feed_lines(const uint8_t *data, size_t size, size_t part, size_t *dropped,
                              void (*take)(void *user, const char *line), void *user)
{
  static struct dea_line_reader reader;
  memset(&reader, 0, sizeof reader);
  for (size_t at = 0; at < size; at += part) {
    const char *bytes = (const char *)data + at, *line;
    size_t length = size - at < part ? size - at : part;
    while ((line = dea_line_next(&reader, &bytes, &length)) != NULL) {
      take(user, line);
    }
    if (length > 0) {
      __builtin_trap(); // asked for more with bytes left
    }
  }
  *dropped = reader.dropped;
}
