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

// Writing ----------------------------------------------------------------------------------------

enum { COLUMN_NAME_SIZE = 32 };

/* Name of the attribute with the key of a column of monitors, whose number is of this context. */
static void name_column(double number, char out[COLUMN_NAME_SIZE])
{
  snprintf(out, COLUMN_NAME_SIZE, "column_%.0f", number);
}

/* Keys of the columns of monitors that rows are of. */
static void write_keys(struct h5 *h, hid_t set, const struct dea_result_table *table, size_t column)
{
  char name[COLUMN_NAME_SIZE];
  for (size_t row = 0; row < table->row_count; row++) {
    const double number = dea_result_table_cell(table, row, column)->number;
    name_column(number, name);
    if (number >= DEA_LOAD_POINT_COLUMNS && H5Aexists(set, name) <= 0) {
      dea_h5_write_text(h, set, name, dea_column_at(h->ctx, (int)number)->key);
    }
  }
}

static void write_column(struct h5 *h, hid_t group, const struct dea_result_table *table,
                         size_t column)
{
  const struct dea_result_column *c = &table->type.columns[column];
  exchange_values(h, group, table, column);
  hid_t set = dea_h5_array_open(h, group, c->key);
  dea_h5_write_int(h, set, "column", (long long)column);
  dea_h5_write_int(h, set, "kind", c->kind);
  dea_h5_write_int(h, set, "list", c->list);
  dea_h5_write_int(h, set, "null", c->null);
  dea_h5_write_int(h, set, "hidden", c->hidden);
  dea_h5_write_text(h, set, "title", or_empty(c->title));
  dea_h5_write_text(h, set, "display_unit", c->display_unit != NULL ? c->display_unit : "1");
  dea_h5_write_real(h, set, "display_factor", c->factor > 0 ? c->factor : 1);
  if (c->kind == DEA_CELL_QUANTITY) {
    write_keys(h, set, table, column);
  }
  dea_h5_close(set);
}

void dea_results_h5_write_table(struct h5 *h, hid_t group, const struct dea_result_table *table)
{
  const struct dea_result_table_type *type = &table->type;
  dea_h5_write_text(h, group, "study", type->study);
  dea_h5_write_text(h, group, "name", type->name);
  dea_h5_write_text(h, group, "key", or_empty(type->key));
  dea_h5_write_text(h, group, "title", or_empty(type->title));
  dea_h5_write_int(h, group, "where", type->where);
  dea_h5_write_int(h, group, "one_row", type->one_row);
  dea_h5_write_text(h, group, "quantity",
                    table->quantity >= 0 ? dea_point_columns[table->quantity].key : "");
  dea_h5_write_int(h, group, "width", (long long)table->width);
  dea_h5_write_int(h, group, "count", (long long)table->row_count);
  for (size_t c = 0; c < type->column_count && table->row_count > 0; c++) {
    write_column(h, group, table, c);
  }
}

// Reading ----------------------------------------------------------------------------------------

static const char *get_name(struct h5 *h, hid_t object, const char *name)
{
  char text[256];
  dea_h5_get_text(h, object, name, text, sizeof text);
  const char *kept = h->status == DEA_OK ? dea_intern(h->ctx, text) : "";
  h->status = kept == NULL ? DEA_E_MEMORY : h->status;
  return kept;
}

/* Columns of a group by their numbers, in memory of their own. */
static void get_columns(struct h5 *h, hid_t group, struct dea_result_column *columns, size_t count)
{
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    char key[DEA_NAME_SIZE];
    dea_h5_link_name(h, group, i, key, sizeof key);
    hid_t set = dea_h5_array_open(h, group, key);
    struct dea_result_column *c =
        &columns[dea_h5_int(h, set, "column", 0, 0, (long long)count - 1)];
    c->key = h->status == DEA_OK ? dea_intern(h->ctx, key) : "";
    c->kind = (enum dea_cell_kind)dea_h5_int(h, set, "kind", 0, DEA_CELL_NUMBER, DEA_CELL_POINTS);
    c->list = dea_h5_int(h, set, "list", 0, 0, 1) != 0;
    c->null = dea_h5_int(h, set, "null", 0, 0, 1) != 0;
    c->hidden = (int)dea_h5_int(h, set, "hidden", 0, 0, 255);
    c->title = get_name(h, set, "title");
    c->si_unit = get_name(h, set, "unit");
    c->meaning = get_name(h, set, "meaning");
    c->display_unit = get_name(h, set, "display_unit");
    c->factor = dea_h5_get_real(h, set, "display_factor");
    dea_h5_close(set);
    h->status = c->key == NULL ? DEA_E_MEMORY : h->status;
  }
  for (size_t i = 0; i < count && h->status == DEA_OK; i++) {
    if (columns[i].key == NULL) {
      h->status = dea_fail(h->ctx, DEA_E_IO, "%s is damaged: a table lacks a column", h->path);
    }
  }
}

/* Numbers of monitors' columns in this context, in place of those of who wrote them. */
static void find_quantities(struct h5 *h, hid_t group, const struct dea_result_table *table,
                            size_t column)
{
  hid_t set = dea_h5_array_open(h, group, table->type.columns[column].key);
  for (size_t row = 0; row < table->row_count && h->status == DEA_OK; row++) {
    struct dea_cell *cell = (struct dea_cell *)dea_result_table_cell(table, row, column);
    char name[COLUMN_NAME_SIZE], key[DEA_ERROR_KEY_SIZE];
    name_column(cell->number, name);
    if (cell->number >= DEA_LOAD_POINT_COLUMNS) {
      dea_h5_get_text(h, set, name, key, sizeof key);
      cell->number = h->status == DEA_OK ? dea_column_find(h->ctx, key) : -1;
    }
  }
  dea_h5_close(set);
}

/* A table of `count` rows without values. */
static struct dea_result_table *add_table(struct h5 *h, hid_t group, const char *model,
                                          const struct dea_result_column *columns,
                                          size_t column_count, struct dea_result *result)
{
  char quantity[DEA_NAME_SIZE];
  const struct dea_result_table_type type = {
      .study = get_name(h, group, "study"),
      .name = get_name(h, group, "name"),
      .key = get_name(h, group, "key"),
      .title = get_name(h, group, "title"),
      .where = (int)dea_h5_int(h, group, "where", 0, 0, 255),
      .one_row = dea_h5_int(h, group, "one_row", 0, 0, 1) != 0,
      .columns = columns,
      .column_count = column_count,
  };
  size_t width = (size_t)dea_h5_int(h, group, "width", 0, 0, DEA_RESULT_TABLE_WIDTH_MAX);
  struct dea_result_table *table = NULL;
  dea_h5_get_text(h, group, "quantity", quantity, sizeof quantity);
  if (h->status == DEA_OK) {
    h->status = dea_result_add_table(h->ctx, result, &type, model, width, &table);
  }
  if (h->status == DEA_OK) {
    table->type.key = type.key[0] != '\0' ? type.key : NULL;
    table->quantity = dea_point_column_find(quantity);
  }
  return table;
}

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

void dea_results_h5_get_table(struct h5 *h, hid_t group, const char *model,
                              struct dea_result *result)
{
  static const double none[DEA_RESULT_TABLE_WIDTH_MAX] = {NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
  struct dea_result_table_value empty[DEA_RESULT_TABLE_COLUMNS_MAX];
  size_t column_count = dea_h5_link_count(h, group);
  size_t rows = (size_t)dea_h5_int(h, group, "count", 0, 0, ROWS_MAX);
  if (h->status == DEA_OK && column_count > DEA_RESULT_TABLE_COLUMNS_MAX) {
    h->status =
        dea_fail(h->ctx, DEA_E_IO, "%s is damaged: a table of %zu columns", h->path, column_count);
  }
  struct dea_result_column columns[DEA_RESULT_TABLE_COLUMNS_MAX] = {{0}};
  if (h->status == DEA_OK) {
    get_columns(h, group, columns, column_count);
  }
  struct dea_result_table *table =
      h->status == DEA_OK ? add_table(h, group, model, columns, column_count, result) : NULL;
  if (table == NULL) {
    return;
  }
  for (size_t c = 0; c < column_count; c++) {
    empty[c] = (struct dea_result_table_value){.number = NAN, .list = none};
  }
  for (size_t row = 0; row < rows && h->status == DEA_OK; row++) {
    h->status = dea_result_table_add_row(h->ctx, table, empty);
  }
  for (size_t c = 0; c < column_count && h->status == DEA_OK; c++) {
    exchange_values(h, group, table, c);
    if (columns[c].kind == DEA_CELL_QUANTITY) {
      find_quantities(h, group, table, c);
    }
  }
  check_quantities(h, result, table);
}
