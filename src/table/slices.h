/* Pieces of the text of a file that is never changed: lines, fields, numbers. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct dea_slice {
  const char *text; // not ended by NUL
  size_t length;
};

/* Lines of a text; starts as {text, text + length, 0}. */
struct dea_lines {
  const char *next, *end;
  size_t line; // of the last one taken, from 1
};

/* The next line without its end (LF or CR LF), also an empty one; false at the end. */
bool dea_lines_next(struct dea_lines *lines, struct dea_slice *line);

struct dea_slice dea_slice_trim(struct dea_slice slice); // blanks, tabs, CR
bool dea_slice_starts(struct dea_slice slice, const char *with);
/* Whether it is this word, letters of ASCII in either case. */
bool dea_slice_is(struct dea_slice slice, const char *word);
/* Where a piece stands in the text, from 0; length when it does not. */
size_t dea_slice_find(struct dea_slice slice, const char *part);

/* Takes the next field of a line: trimmed, quotes off. separator ' ': any number of blanks and
 * tabs. rest: what follows, text NULL after the last field. false when there is none. */
bool dea_slice_field(struct dea_slice *rest, char separator, struct dea_slice *field);
size_t dea_slice_count(struct dea_slice line, char separator);

/* The nearest double to a decimal number, NAN for what instruments write in place of one: nothing,
 * "NaN", "n/a", "---", infinities, overflows. decimal: '.' or ','. false when it is none of these.
 */
bool dea_slice_number(struct dea_slice slice, char decimal, double *value);

/* Whether it is a number as people write it with marks between thousands: "1.002.000", "1'000",
 * "2 000,5", also where the mark could be a decimal one ("1.000"). */
bool dea_slice_has_groups(struct dea_slice slice);

/* True for the same bytes; of empty ones the text may be NULL. */
bool dea_slice_same(struct dea_slice a, struct dea_slice b);
