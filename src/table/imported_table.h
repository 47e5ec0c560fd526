/* Columns of numbers of a file of others, as it has them. */
#pragma once

#include "base/context.h"
#include "table/slices.h"

enum { DEA_TABLE_COLUMNS_MAX = 8192 };

/* A column as the file has it. */
struct dea_table_column {
  char *name;             // "Dev1/ai0", UTF-8; owned
  char *unit;             // as written, "": none; owned
  double start, interval; // of its samples when the file says so [s]; interval NAN: it does not
  double *values;         // [count], owned; NAN: missing
  size_t count;
  size_t clock;    // 1 + the column with its times when the file says so; 0: it does not
  double origin_s; // of times of day, which count from their first: that, since some midnight; NAN
};

/* A column that was left out because it holds text, with the first field that is no number. */
struct dea_table_left {
  char *name, *field; // owned
  size_t line;
};

struct dea_table {
  const char *file;   // interned
  const char *format; // name of its importer
  struct dea_table_column *columns;
  size_t column_count, column_room;
  char *note;                  // what the file says of itself; NULL; owned
  struct dea_table_left *left; // [left_count]; owned
  size_t left_count;
  struct dea_fields *fields; // of a text: rows are kept there as they are, and no columns made
};

/* Adds an empty column with room for `room` values; NULL on failure. Name and unit become UTF-8. */
struct dea_table_column *dea_table_add(struct dea_context *ctx, struct dea_table *table,
                                       const char *name, size_t name_length, const char *unit,
                                       size_t unit_length, size_t capacity);
/* Notes a column that is left out. */
dea_status dea_table_leave(struct dea_context *ctx, struct dea_table *table, struct dea_slice name,
                           struct dea_slice field, size_t line);
/* What the file says of itself, instead of what was there. */
dea_status dea_table_note(struct dea_context *ctx, struct dea_table *table, const char *text,
                          size_t length);
/* NULL is fine. */
void dea_table_destroy(struct dea_context *ctx, struct dea_table *table);
