/* Tables that studies make of what they computed: named columns with unit and meaning, which CSV,
 * JSON, HDF5, the terminal and the report write without knowing the study. */
#pragma once

#include "base/text.h"
#include "material/material.h"
#include "result/columns.h"

enum { DEA_RESULT_TABLE_COLUMNS_MAX = 24, DEA_RESULT_TABLE_WIDTH_MAX = 8 };

enum dea_cell_kind {
  DEA_CELL_NUMBER,   // in SI; NAN: none
  DEA_CELL_COUNT,    // a whole number
  DEA_CELL_FLAG,     // 1: yes, 0: no
  DEA_CELL_TEXT,     //
  DEA_CELL_QUANTITY, // quantity of load points that the row is of: number of its column
  DEA_CELL_VALUE,    // a number in the SI unit of the row's quantity; NAN: none
  DEA_CELL_POINTS,   // index of a variant of the result: JSON lists its points
};

/* A column of numbers. */
#define DEA_NUMBER_COLUMN(name, si, display, scale, head, what)                                    \
  {                                                                                                \
    .key = name, .kind = DEA_CELL_NUMBER, .si_unit = si, .display_unit = display, .factor = scale, \
    .title = head, .meaning = what                                                                 \
  }

/* A column of texts. */
#define DEA_TEXT_COLUMN(name, head, what)                                                          \
  {                                                                                                \
    .key = name, .kind = DEA_CELL_TEXT, .title = head, .meaning = what                             \
  }

/* Any other column; what else there is to say of it comes last, by its member. */
#define DEA_RESULT_COLUMN(its_kind, name, head, ...)                                               \
  {                                                                                                \
    .key = name, .kind = DEA_CELL_##its_kind, .title = head, __VA_ARGS__                           \
  }

/* Who writes a table; HDF5 has every table and column. SCREEN: the terminal and the report;
 * TERMINAL: that alone, of what the report draws by itself. */
enum { DEA_IN_JSON = 1, DEA_IN_CSV = 2, DEA_IN_SCREEN = 4, DEA_IN_TERMINAL = 8 };

struct dea_result_column {
  const char *key; // as in JSON and HDF5: "rise_time_s"
  enum dea_cell_kind kind;
  const char *si_unit, *display_unit; // NULL: "1"
  double factor;                      // SI -> display; 0: 1
  const char *title;                  // for people, without unit: "rise time"
  const char *meaning;
  bool list;  // `width` values a row: in JSON an array with null for what is none
  bool null;  // JSON writes null for what is none, else leaves the key out
  int hidden; // DEA_IN_*: those that leave the column out
};

/* What a table is. */
struct dea_result_table_type {
  const char *study; // in JSON an object of that key, in file names
  const char *name;  // within it; "": the study's own facts
  const char *key;   // in JSON of the model itself, in place of study and name; NULL: not so
  const char *title; // a heading for people
  int where;         // DEA_IN_*
  bool one_row;      // in JSON an object, not a list
  size_t every;      // the terminal shows the first row and each so-manieth on; 0: all
  const struct dea_result_column *columns; // [column_count]
  size_t column_count;
};

/* One of these columns, an array; what else there is to say of it comes last, by its member. */
#define DEA_RESULT_TABLE(its_study, its_name, its_columns, ...)                                    \
  {                                                                                                \
    .study = its_study, .name = its_name, .columns = its_columns,                                  \
    .column_count = sizeof its_columns / sizeof its_columns[0], __VA_ARGS__                        \
  }

struct dea_cell {
  double number; // NAN: none
  char *text;    // owned; NULL for what is no text
};

struct dea_result_table {
  const struct dea_context *ctx; // whose columns its quantities are
  char model[DEA_NAME_SIZE];
  struct dea_result_table_type type;     // its names are static, or interned in the context
  struct dea_result_column *own_columns; // those of the type, copied; owned
  int quantity;                          // of all rows, where no column says it; -1: none
  size_t width;                          // values in each list
  size_t row_count, capacity, stride;
  struct dea_cell *cells; // [row_count][stride], column after column, lists with all their values
};

/* First cell of a column in a row; lent. */
const struct dea_cell *dea_result_table_cell(const struct dea_result_table *table, size_t row,
                                             size_t column);
/* Number of a column by its key, of a list its value of that index; NAN where the table has none.
 */
double dea_result_table_number(const struct dea_result_table *table, size_t row, const char *key,
                               size_t index);
/* Text of a column by its key, "" where the table has none; lent. */
const char *dea_result_table_text(const struct dea_result_table *table, size_t row,
                                  const char *key);
/* Values of a row that belong to a column: 1, or the width of lists. */
size_t dea_result_table_values(const struct dea_result_table *table, size_t column);
/* The same of one of DEA_IN_*: 0 of a column that is hidden there, and of a list of points. */
size_t dea_result_table_shown(const struct dea_result_table *table, size_t column, int where);

/* An empty table. width: of its lists, 0 to DEA_RESULT_TABLE_WIDTH_MAX. Freed with
 * dea_result_table_free. */
dea_status dea_result_table_init(struct dea_context *ctx, const struct dea_result_table_type *type,
                                 const char *model, size_t width, struct dea_result_table *out);
void dea_result_table_free(struct dea_context *ctx, struct dea_result_table *table);
/* Frees all rows but the first. */
void dea_result_table_cut(struct dea_context *ctx, struct dea_result_table *table, size_t rows);
/* A value of a row: of its column's kind the one that counts. */
struct dea_result_table_value {
  double number;      // of all kinds that are no text
  const char *text;   // copied
  const double *list; // [width] of a list
};
/* Adds a row. values: one for each column, in their order. */
dea_status dea_result_table_add_row(struct dea_context *ctx, struct dea_result_table *table,
                                    const struct dea_result_table_value *values);
/* The same of cells, which have to be as many as the columns:
 * DEA_TABLE_ADD(ctx, table, DEA_CELL(1), DEA_TEXT_CELL("a")). */
dea_status dea_result_table_add_cells(struct dea_context *ctx, struct dea_result_table *table,
                                      const struct dea_result_table_value *cells, size_t count);
#define DEA_TABLE_ADD(ctx, table, ...)                                                             \
  dea_result_table_add_cells(ctx, table, (const struct dea_result_table_value[]){__VA_ARGS__},     \
                             sizeof((const struct dea_result_table_value[]){__VA_ARGS__}) /        \
                                 sizeof(struct dea_result_table_value))
#define DEA_CELL(value) ((struct dea_result_table_value){.number = (value)})
#define DEA_TEXT_CELL(value) ((struct dea_result_table_value){.text = (value)})
#define DEA_LIST_CELL(value) ((struct dea_result_table_value){.list = (value)})

/* Quantity of load points that a row is of; NULL: none. */
const struct dea_column *dea_result_table_quantity(const struct dea_result_table *table,
                                                   size_t row);
/* A value as people read it: in the display unit, "" for none. digits: significant ones. */
void dea_result_table_cell_text(const struct dea_result_table *table, size_t row, size_t column,
                                size_t value, int digits, struct dea_text *out);
/* "rise time (s)": the title of a column, without unit for 1 or the row's own. */
void dea_result_table_column_title(const struct dea_result_column *column, struct dea_text *out);
