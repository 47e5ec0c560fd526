/* What a file of lines of numbers is like: where they begin, what parts them. */
#pragma once

#include "table/imported_table.h"
#include "table/slices.h"

enum { DEA_CSV_TITLES_MAX = 4 };

struct dea_csv_dialect {
  char separator, decimal;
  size_t count;     // of fields in a line of numbers
  const char *data; // its first line
  size_t line;      // number of the line before that
  bool *text;       // [count] columns of text; owned
  size_t skipped;   // columns at the start that hold something else, which nothing is said of
  /* Lines before the numbers that may hold titles, the nearest first, comment marks off. */
  struct dea_slice titles[DEA_CSV_TITLES_MAX];
  size_t title_lines[DEA_CSV_TITLES_MAX];
  size_t title_count;
};

/* Whether a line is empty or a comment (#, %, //). */
bool dea_csv_is_blank(struct dea_slice line);
bool dea_csv_is_comment(struct dea_slice line);
/* Looks at the first lines of a text. Errors are findings with DEA_E_IO; out->text is the caller's
 * also then. */
dea_status dea_csv_dialect_find(struct dea_context *ctx, const char *file, struct dea_slice text,
                                struct dea_csv_dialect *out);
