#include "result/table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

size_t dea_result_table_values(const struct dea_result_table *table, size_t column)
{
  return table->type.columns[column].list ? table->width : 1;
}

size_t dea_result_table_shown(const struct dea_result_table *table, size_t column, int where)
{
  const struct dea_result_column *c = &table->type.columns[column];
  const bool hidden = (c->hidden & where) != 0 || c->kind == DEA_CELL_POINTS;
  return hidden ? 0 : dea_result_table_values(table, column);
}

/* Place of a column's first value within a row. */
static size_t column_offset(const struct dea_result_table *table, size_t column)
{
  size_t offset = 0;
  for (size_t c = 0; c < column; c++) {
    offset += dea_result_table_values(table, c);
  }
  return offset;
}

const struct dea_cell *dea_result_table_cell(const struct dea_result_table *table, size_t row,
                                             size_t column)
{
  return &table->cells[row * table->stride + column_offset(table, column)];
}

/* Value of that number in a row's cell of a column; NULL: there is none. */
static const struct dea_cell *find_cell(const struct dea_result_table *table, size_t row,
                                        const char *key, size_t index)
{
  for (size_t c = 0; c < table->type.column_count; c++) {
    if (strcmp(table->type.columns[c].key, key) == 0 && row < table->row_count &&
        index < dea_result_table_values(table, c)) {
      return &dea_result_table_cell(table, row, c)[index];
    }
  }
  return NULL;
}

double dea_result_table_number(const struct dea_result_table *table, size_t row, const char *key,
                               size_t index)
{
  const struct dea_cell *cell = find_cell(table, row, key, index);
  return cell != NULL ? cell->number : NAN;
}

const char *dea_result_table_text(const struct dea_result_table *table, size_t row, const char *key)
{
  const struct dea_cell *cell = find_cell(table, row, key, 0);
  return cell != NULL && cell->text != NULL ? cell->text : "";
}

dea_status dea_result_table_init(struct dea_context *ctx, const struct dea_result_table_type *type,
                                 const char *model, size_t width, struct dea_result_table *out)
{
  *out = (struct dea_result_table){.ctx = ctx, .type = *type, .quantity = -1, .width = width};
  if (type->column_count > DEA_RESULT_TABLE_COLUMNS_MAX || width > DEA_RESULT_TABLE_WIDTH_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "a table '%.60s' with more than %d columns or lists of "
                    "more than %d values",
                    type->name, DEA_RESULT_TABLE_COLUMNS_MAX, DEA_RESULT_TABLE_WIDTH_MAX);
  }
  const size_t bytes = type->column_count * sizeof *type->columns;
  out->own_columns = dea_alloc(ctx, 1, bytes);
  DEA_TRY_MEMORY(out->own_columns != NULL);
  out->type.columns = memcpy(out->own_columns, type->columns, bytes);
  snprintf(out->model, sizeof out->model, "%s", model);
  out->stride = column_offset(out, type->column_count);
  return DEA_OK;
}

void dea_result_table_cut(struct dea_context *ctx, struct dea_result_table *table, size_t rows)
{
  for (size_t i = rows * table->stride; i < table->row_count * table->stride; i++) {
    dea_free(ctx, table->cells[i].text);
  }
  table->row_count = rows < table->row_count ? rows : table->row_count;
}

void dea_result_table_free(struct dea_context *ctx, struct dea_result_table *table)
{
  dea_result_table_cut(ctx, table, 0);
  dea_free(ctx, table->cells);
  dea_free(ctx, table->own_columns);
  table->own_columns = NULL;
  table->cells = NULL;
  table->row_count = table->capacity = 0;
}

dea_status dea_result_table_add_row(struct dea_context *ctx, struct dea_result_table *table,
                                    const struct dea_result_table_value *values)
{
  DEA_TRY(ctx, dea_array_grow(ctx, &table->cells, table->row_count, &table->capacity,
                              table->stride * sizeof *table->cells));
  struct dea_cell *row = table->cells + table->row_count * table->stride;
  for (size_t i = 0; i < table->stride; i++) {
    row[i] = (struct dea_cell){.number = NAN};
  }
  table->row_count++; // from here on its texts are the table's
  for (size_t c = 0, at = 0; c < table->type.column_count; c++) {
    const struct dea_result_column *column = &table->type.columns[c];
    for (size_t k = 0; k < dea_result_table_values(table, c); k++, at++) {
      row[at].number = column->list ? values[c].list[k] : values[c].number;
    }
    if (column->kind == DEA_CELL_TEXT) {
      const char *text = values[c].text != NULL ? values[c].text : "";
      row[at - 1].text = dea_copy_text(ctx, text, strlen(text));
      DEA_TRY_MEMORY(row[at - 1].text != NULL);
    }
  }
  return DEA_OK;
}

dea_status dea_result_table_add_cells(struct dea_context *ctx, struct dea_result_table *table,
                                      const struct dea_result_table_value *cells, size_t count)
{
  return count == table->type.column_count
             ? dea_result_table_add_row(ctx, table, cells)
             : dea_fail(ctx, DEA_E_ARGUMENT, "a row of %zu cells for %zu columns", count,
                        table->type.column_count);
}

const struct dea_column *dea_result_table_quantity(const struct dea_result_table *table, size_t row)
{
  for (size_t c = 0; c < table->type.column_count; c++) {
    if (table->type.columns[c].kind == DEA_CELL_QUANTITY) {
      return dea_column_at(table->ctx, (int)dea_result_table_cell(table, row, c)->number);
    }
  }
  return table->quantity >= 0 ? &dea_point_columns[table->quantity] : NULL;
}

void dea_result_table_cell_text(const struct dea_result_table *table, size_t row, size_t column,
                                size_t value, int digits, struct dea_text *out)
{
  const struct dea_result_column *c = &table->type.columns[column];
  const struct dea_cell *cell = dea_result_table_cell(table, row, column) + value;
  const struct dea_column *quantity = dea_result_table_quantity(table, row);
  double factor = c->factor > 0 ? c->factor : 1;
  switch (c->kind) {
  case DEA_CELL_TEXT:
    dea_text_add(out, "%s", cell->text);
    break;
  case DEA_CELL_QUANTITY:
    dea_text_add(out, "%s", quantity->header);
    break;
  case DEA_CELL_FLAG:
    dea_text_add(out, "%s", cell->number > 0 ? "yes" : "no");
    break;
  case DEA_CELL_COUNT:
  case DEA_CELL_POINTS:
    dea_text_add(out, "%.0f", cell->number);
    break;
  case DEA_CELL_VALUE:
    factor = quantity != NULL ? quantity->factor : factor; // fall through
  case DEA_CELL_NUMBER:
    if (!isnan(cell->number)) {
      dea_text_add(out, "%.*g", digits, factor * cell->number);
    }
    break;
  }
}

void dea_result_table_column_title(const struct dea_result_column *column, struct dea_text *out)
{
  bool plain = column->display_unit == NULL || strcmp(column->display_unit, "1") == 0;
  if (plain) {
    dea_text_add(out, "%s", column->title);
  } else {
    dea_text_add(out, "%s (%s)", column->title, column->display_unit);
  }
}
