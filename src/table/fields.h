/* The fields of a text table by row, for readers that want some of its columns only. */
#pragma once

#include "table/text_rows.h"

struct dea_fields {
  const char *file; // interned
  char separator, decimal;
  size_t count;                     // of columns
  struct dea_slice *titles, *units; // [count] units: from a line of their own, else empty
  size_t rows;
  struct dea_slice *lines; // [rows]
  size_t *numbers;         // [rows] lines that they stand in
  struct dea_slice text;   // of the file
  char *bytes, *copy;      // where that is; owned
};

/* Reads a text file of any encoding and dialect. Errors are findings with line and column, DEA_E_IO
 * then. out: freed by the caller after success, empty on failure. */
dea_status dea_fields_read(struct dea_context *ctx, const char *file, struct dea_fields *out);
/* Where a piece of its text stands. */
struct dea_location dea_fields_place(const struct dea_fields *fields, struct dea_slice piece);
/* Name and unit of a column's title, each DEA_CSV_FIELD_MAX bytes; the name as dea_csv_fold has it,
 * also where its unit is none that is known. */
void dea_fields_title(struct dea_context *ctx, const struct dea_fields *fields, size_t column,
                      char *name, char *unit);
/* The number of a field of a row, NAN for a missing one. What is none is an error, and false.
 * marks: of this column. */
bool dea_fields_number(struct dea_context *ctx, const struct dea_fields *fields, size_t row,
                       struct dea_slice field, struct dea_text_marks *marks, double *value);
/* Leaves it empty. */
void dea_fields_free(struct dea_context *ctx, struct dea_fields *fields);
