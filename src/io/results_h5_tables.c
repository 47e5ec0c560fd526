#include "io/results_h5_tables.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { ROWS_MAX = 1000000, TEXT_MAX = 4096 };

static const char *or_empty(const char *text)
{
  return text != NULL ? text : "";
}

// Values -----------------------------------------------------------------------------------------

/* Longest of a column's texts with its end. */
static size_t text_size(const struct dea_result_table *table, size_t column)
{
  size_t size = 1;
  for (size_t row = 0; row < table->row_count; row++) {
    const size_t length = strlen(dea_result_table_cell(table, row, column)->text) + 1;
    size = length > size ? length : size;
  }
  return size > TEXT_MAX ? TEXT_MAX : size;
}

static void exchange_texts(struct h5 *h, hid_t group, const struct dea_result_table *table,
                           size_t column)
{
  const struct dea_result_column *c = &table->type.columns[column];
  const size_t size = h->reading ? TEXT_MAX : text_size(table, column);
  char *texts = dea_alloc(h->ctx, table->row_count, size);
  if (texts == NULL) {
    h->status = h->status == DEA_OK ? DEA_E_MEMORY : h->status;
    return;
  }
  for (size_t row = 0; row < table->row_count && !h->reading; row++) {
    snprintf(texts + row * size, size, "%s", dea_result_table_cell(table, row, column)->text);
  }
  dea_h5_texts(h, group, c->key, table->row_count, size, texts, or_empty(c->meaning));
  for (size_t row = 0; row < table->row_count && h->reading && h->status == DEA_OK; row++) {
    struct dea_cell *cell = (struct dea_cell *)dea_result_table_cell(table, row, column);
    dea_free(h->ctx, cell->text);
    cell->text = dea_copy_text(h->ctx, texts + row * size, SIZE_MAX);
    h->status = cell->text == NULL ? DEA_E_MEMORY : h->status;
  }
  dea_free(h->ctx, texts);
}

/* Values of one column; when they are read into rows that are there. */
static void exchange_values(struct h5 *h, hid_t group, const struct dea_result_table *table,
                            size_t column)
{
  const struct dea_result_column *c = &table->type.columns[column];
  const size_t width = dea_result_table_values(table, column), count = table->row_count * width;
  if (c->kind == DEA_CELL_TEXT) {
    exchange_texts(h, group, table, column);
    return;
  }
  double *values = dea_alloc(h->ctx, count, sizeof *values);
  if (values == NULL) {
    h->status = h->status == DEA_OK ? DEA_E_MEMORY : h->status;
    return;
  }
  for (size_t k = 0; k < count && !h->reading; k++) {
    values[k] = dea_result_table_cell(table, k / width, column)[k % width].number;
  }
  dea_h5_array(h, group, c->key, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, count, values,
               c->si_unit != NULL ? c->si_unit : "1", or_empty(c->meaning));
  for (size_t k = 0; k < count && h->reading && h->status == DEA_OK; k++) {
    struct dea_cell *cell = (struct dea_cell *)dea_result_table_cell(table, k / width, column);
    cell[k % width].number = values[k];
  }
  dea_free(h->ctx, values);
}

// Columns ----------------------------------------------------------------------------------------

/* A text that, when it is read, lives as long as the context. */
static void exchange_name(struct h5 *h, hid_t object, const char *name, const char **text)
{
  char read[256];
  if (!h->reading) {
    dea_h5_write_text(h, object, name, or_empty(*text));
    return;
  }
  dea_h5_get_text(h, object, name, read, sizeof read);
  *text = h->status == DEA_OK ? dea_intern(h->ctx, read) : "";
  h->status = *text == NULL ? DEA_E_MEMORY : h->status;
}

/* What an array says of its column beside key, unit and meaning. */
static void exchange_column(struct h5 *h, hid_t set, struct dea_result_column *c)
{
  c->kind = (enum dea_cell_kind)dea_h5_int(h, set, "kind", (long long)c->kind, DEA_CELL_NUMBER,
                                           DEA_CELL_POINTS);
  c->list = dea_h5_int(h, set, "list", c->list, 0, 1) != 0;
  c->null = dea_h5_int(h, set, "null", c->null, 0, 1) != 0;
  c->hidden = (int)dea_h5_int(h, set, "hidden", c->hidden, 0, 255);
  exchange_name(h, set, "title", &c->title);
  exchange_name(h, set, "display_unit", &c->display_unit);
  c->factor = dea_h5_real(h, set, "display_factor", c->factor);
}

/* Of a cell that says a column of monitors, whose number is of this context, an attribute
 * "column_N" of the array has the key. */
static void exchange_key(struct h5 *h, hid_t set, struct dea_cell *cell)
{
  char name[32], key[DEA_ERROR_KEY_SIZE];
  snprintf(name, sizeof name, "column_%.0f", cell->number);
  if (!(cell->number >= DEA_LOAD_POINT_COLUMNS)) {
    return;
  }
  if (h->reading) {
    dea_h5_get_text(h, set, name, key, sizeof key);
    cell->number = h->status == DEA_OK ? dea_column_find(h->ctx, key) : -1;
  } else if (H5Aexists(set, name) <= 0) {
    dea_h5_write_text(h, set, name, dea_column_at(h->ctx, (int)cell->number)->key);
  }
}

static void exchange_keys(struct h5 *h, hid_t set, const struct dea_result_table *table,
                          size_t column)
{
  const bool of_columns = table->type.columns[column].kind == DEA_CELL_QUANTITY;
  for (size_t row = 0; row < table->row_count && of_columns && h->status == DEA_OK; row++) {
    exchange_key(h, set, (struct dea_cell *)dea_result_table_cell(table, row, column));
  }
}

static void write_columns(struct h5 *h, hid_t group, const struct dea_result_table *table)
{
  for (size_t k = 0; k < table->type.column_count && table->row_count > 0; k++) {
    struct dea_result_column c = table->type.columns[k];
    c.display_unit = c.display_unit != NULL ? c.display_unit : "1";
    c.factor = c.factor > 0 ? c.factor : 1;
    exchange_values(h, group, table, k);
    hid_t set = dea_h5_array_open(h, group, c.key);
    dea_h5_write_int(h, set, "column", (long long)k);
    exchange_column(h, set, &c);
    exchange_keys(h, set, table, k);
    dea_h5_close(set);
  }
}

/* By their numbers, in memory of their own. */
static void read_columns(struct h5 *h, hid_t group, struct dea_result_column *columns, size_t count)
{
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    char key[DEA_NAME_SIZE];
    dea_h5_link_name(h, group, i, key, sizeof key);
    hid_t set = dea_h5_array_open(h, group, key);
    struct dea_result_column *c =
        &columns[dea_h5_int(h, set, "column", 0, 0, (long long)count - 1)];
    c->key = h->status == DEA_OK ? dea_intern(h->ctx, key) : "";
    exchange_name(h, set, "unit", &c->si_unit);
    exchange_name(h, set, "meaning", &c->meaning);
    exchange_column(h, set, c);
    dea_h5_close(set);
    h->status = c->key == NULL ? DEA_E_MEMORY : h->status;
  }
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    if (columns[i].key == NULL) {
      h->status = dea_fail(h->ctx, DEA_E_IO, "%s is damaged: a table lacks a column", h->path);
    }
  }
}

// Tables -----------------------------------------------------------------------------------------

/* Quantities of rows exist in this version. */
static void check_quantities(struct h5 *h, const struct dea_result *result,
                             const struct dea_result_table *table)
{
  for (size_t row = 0; row < table->row_count; row++) {
    for (size_t c = 0; c < table->type.column_count && h->status == DEA_OK; c++) {
      enum dea_cell_kind kind = table->type.columns[c].kind;
      double value = dea_result_table_cell(table, row, c)->number;
      double end = kind == DEA_CELL_QUANTITY ? dea_column_count(h->ctx)
                   : kind == DEA_CELL_POINTS ? (double)result->variant_count
                                             : INFINITY;
      bool index = kind == DEA_CELL_QUANTITY || kind == DEA_CELL_POINTS;
      if (index && !(value >= 0 && value < end)) {
        h->status = dea_fail(h->ctx, DEA_E_IO, "%s is damaged: a table points to number %g",
                             h->path, value);
      }
    }
  }
}

/* Rows of a table that is there without any. */
static void read_rows(struct h5 *h, hid_t group, size_t count, const struct dea_result *result,
                      struct dea_result_table *table)
{
  static const double none[DEA_RESULT_TABLE_WIDTH_MAX] = {NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
  struct dea_result_table_value empty[DEA_RESULT_TABLE_COLUMNS_MAX];
  for (size_t c = 0; c < table->type.column_count; c++) {
    empty[c] = (struct dea_result_table_value){.number = NAN, .list = none};
  }
  for (size_t row = 0; row < count && h->status == DEA_OK; row++) {
    h->status = dea_result_table_add_row(h->ctx, table, empty);
  }
  for (size_t c = 0; c < table->type.column_count && h->status == DEA_OK; c++) {
    exchange_values(h, group, table, c);
    hid_t set = dea_h5_array_open(h, group, table->type.columns[c].key);
    exchange_keys(h, set, table, c);
    dea_h5_close(set);
  }
  check_quantities(h, result, table);
}

void dea_results_h5_table(struct h5 *h, hid_t group, const char *model,
                          const struct dea_result_table *from, struct dea_result *result)
{
  struct dea_result_column columns[DEA_RESULT_TABLE_COLUMNS_MAX] = {{0}};
  struct dea_result_table_type type = {.columns = columns};
  struct dea_result_table *table = NULL;
  char quantity[DEA_NAME_SIZE] = "";
  size_t width = 0, rows = 0;
  if (from != NULL) {
    type = from->type;
    width = from->width;
    rows = from->row_count;
    snprintf(quantity, sizeof quantity, "%s",
             from->quantity >= 0 ? dea_point_columns[from->quantity].key : "");
  }
  exchange_name(h, group, "study", &type.study);
  exchange_name(h, group, "name", &type.name);
  exchange_name(h, group, "key", &type.key);
  exchange_name(h, group, "title", &type.title);
  type.where = (int)dea_h5_int(h, group, "where", type.where, 0, 255);
  type.one_row = dea_h5_int(h, group, "one_row", type.one_row, 0, 1) != 0;
  dea_h5_text(h, group, "quantity", quantity, sizeof quantity);
  width = (size_t)dea_h5_int(h, group, "width", (long long)width, 0, DEA_RESULT_TABLE_WIDTH_MAX);
  rows = (size_t)dea_h5_int(h, group, "count", (long long)rows, 0, ROWS_MAX);
  if (from != NULL) {
    write_columns(h, group, from);
    return;
  }
  type.column_count = dea_h5_link_count(h, group);
  if (h->status == DEA_OK && type.column_count > DEA_RESULT_TABLE_COLUMNS_MAX) {
    h->status = dea_fail(h->ctx, DEA_E_IO, "%s is damaged: a table of %zu columns", h->path,
                         type.column_count);
  }
  if (h->status == DEA_OK) {
    read_columns(h, group, columns, type.column_count);
  }
  if (h->status == DEA_OK) {
    h->status = dea_result_add_table(h->ctx, result, &type, model, width, &table);
  }
  if (h->status == DEA_OK) {
    table->type.key = type.key[0] != '\0' ? type.key : NULL;
    table->quantity = dea_point_column_find(quantity);
    read_rows(h, group, rows, result, table);
  }
}
