/* Rows of numbers of a text file into the columns of a table. */
#pragma once

#include "table/csv_dialect.h"

/* How the numbers of a column are written, to tell marks between thousands from decimal ones. */
struct dea_text_marks {
  size_t thousands;       // "12.345": three digits behind the mark, no 0 first
  size_t others;          // with a mark that can only be the decimal one
  size_t plain;           // without a mark
  size_t line;            // first one of the first kind
  struct dea_slice first; // that
};
void dea_text_marks_count(struct dea_text_marks *marks, struct dea_slice field, char decimal,
                          size_t line);
/* An error for marks that seem to part thousands, and true. */
bool dea_text_marks_refuse(struct dea_context *ctx, const struct dea_text_marks *marks,
                           char separator, char decimal, const char *file, const char *name);

/* Reads the lines of all rows into out->fields, with the same errors as below but of single
 * numbers.
 */
dea_status dea_text_lines_read(struct dea_context *ctx, struct dea_slice text,
                               const struct dea_csv_dialect *dialect, struct dea_table *out);
/* Adds a column for each one that is not of text, with its title (titles: [dialect->count]; units:
 * the same, NULL to find them in the titles), and reads all rows into them. Errors are findings
 * with line and column, DEA_E_IO then. */
dea_status dea_text_rows_read(struct dea_context *ctx, struct dea_slice text,
                              const struct dea_csv_dialect *dialect, const struct dea_slice *titles,
                              const struct dea_slice *units, struct dea_table *out);
