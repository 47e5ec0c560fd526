/* The fields of a text table by row, for csv_columns.c, which wants some of its columns only. */
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
