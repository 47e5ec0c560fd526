/* Lines of text out of a stream of bytes, however it is cut into pieces. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { DEA_LINE_SIZE = 2048 };

/* Zero-initialise. */
struct dea_line_reader {
  char line[DEA_LINE_SIZE]; // NUL-terminated once it is complete
  size_t length;
  bool too_long;  // the line so far is dropped up to its end
  size_t dropped; // lines that were too long, or had a control character, so far
};

/* Takes bytes up to the end of the next line (CR, LF or both; empty lines are none). The line, or
 * NULL when more bytes are needed; lent until the next call. A line longer than the buffer or with
 * a control character other than a tab is dropped whole and counted: reading goes on at the next.
 */
const char *dea_line_next(struct dea_line_reader *reader, const char **bytes, size_t *length);
