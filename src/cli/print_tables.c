#include "cli/print_tables.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS_SHOWN = 40, WIDTH_MAX = 36, DIGITS = 5, ERROR_DIGITS = 2 };

static bool on_screen(const struct dea_result_column *column)
{
  return (column->hidden & DEA_IN_SCREEN) == 0 && column->kind != DEA_CELL_POINTS;
}

/* Whether some row has something in a column; without rows all have. */
static bool has_any(const struct dea_result_table *table, size_t column)
{
  size_t values = dea_result_table_values(table, column);
  for (size_t i = 0; i < table->row_count; i++) {
    const struct dea_cell *cell = dea_result_table_cell(table, i, column);
    for (size_t k = 0; k < values; k++) {
      if (!isnan(cell[k].number) || (cell[k].text != NULL && cell[k].text[0] != '\0')) {
        return true;
      }
    }
  }
  return table->row_count == 0;
}

/* Whether a cell holds what rounding left of 0: display units are chosen so that numbers are
 * near 1. */
static bool is_noise(const struct dea_result_column *column, const char *text)
{
  const double least = 1e-9;
  const char *unit = column->display_unit;
  return column->kind == DEA_CELL_NUMBER && unit != NULL && strcmp(unit, "1") != 0 &&
         fabs(strtod(text, NULL)) < least;
}

/* A cell as text, with the unit of its quantity where the title cannot say it; row SIZE_MAX: the
 * title. */
static void add_cell(const struct dea_result_table *table, size_t row, size_t column, size_t value,
                     struct dea_text *out)
{
  const struct dea_result_column *c = &table->type.columns[column];
  const struct dea_column *quantity =
      row != SIZE_MAX ? dea_result_table_quantity(table, row) : NULL;
  if (row == SIZE_MAX) {
    if (value == 0) {
      dea_result_table_column_title(c, out);
    }
    return;
  }
  bool percent = c->display_unit != NULL && strcmp(c->display_unit, "%") == 0 && c->list;
  dea_result_table_cell_text(table, row, column, value, percent ? ERROR_DIGITS : DIGITS, out);
  if (out->length > 0 && is_noise(c, dea_text_get(out))) {
    struct dea_context *ctx = out->ctx;
    dea_text_free(out);
    *out = (struct dea_text){.ctx = ctx};
    dea_text_add(out, "0");
  }
  if (out->length > 0 && c->kind == DEA_CELL_VALUE && strcmp(quantity->display_unit, "1") != 0) {
    dea_text_add(out, " %s", quantity->display_unit);
  } else if (out->length == 0 && c->kind != DEA_CELL_TEXT) {
    dea_text_add(out, "-");
  }
}

/* Rows that are shown of a table are `every` rows apart. */
static size_t row_step(const struct dea_result_table *table)
{
  return table->type.every > 0 ? table->type.every : 1;
}

/* The row of a line, SIZE_MAX for the titles in the first. */
static size_t row_of_line(const struct dea_result_table *table, size_t line)
{
  return line == 0 ? SIZE_MAX : (line - 1) * row_step(table);
}

static int column_width(struct dea_context *ctx, const struct dea_result_table *table,
                        size_t column, size_t value, size_t rows)
{
  size_t width = 0;
  for (size_t i = 0; i <= rows; i++) {
    struct dea_text text = {.ctx = ctx};
    add_cell(table, row_of_line(table, i), column, value, &text);
    width = text.length > width ? text.length : width;
    dea_text_free(&text);
  }
  return width < WIDTH_MAX ? (int)width : WIDTH_MAX;
}

static dea_status print_rows(struct dea_context *ctx, const struct dea_result_table *table)
{
  const size_t step = row_step(table), all = (table->row_count + step - 1) / step;
  const size_t rows = all < ROWS_SHOWN ? all : ROWS_SHOWN;
  struct dea_text *lines = dea_alloc(ctx, rows + 1, sizeof *lines);
  bool failed = lines == NULL;
  for (size_t i = 0; i <= rows && !failed; i++) {
    lines[i].ctx = ctx;
  }
  for (size_t c = 0; c < table->type.column_count && !failed; c++) {
    bool shown = on_screen(&table->type.columns[c]) && has_any(table, c);
    for (size_t k = 0; shown && k < dea_result_table_values(table, c); k++) {
      int width = column_width(ctx, table, c, k, rows);
      bool text = table->type.columns[c].kind == DEA_CELL_TEXT ||
                  table->type.columns[c].kind == DEA_CELL_QUANTITY;
      for (size_t i = 0; i <= rows; i++) {
        struct dea_text cell = {.ctx = ctx};
        add_cell(table, row_of_line(table, i), c, k, &cell);
        dea_text_add(&lines[i], "  %*s", text ? -width : width, dea_text_get(&cell));
        failed = failed || cell.failed || lines[i].failed;
        dea_text_free(&cell);
      }
    }
  }
  for (size_t i = 0; lines != NULL && i <= rows; i++) {
    if (!failed) {
      puts(dea_text_get(&lines[i]));
    }
    dea_text_free(&lines[i]);
  }
  dea_free(ctx, lines);
  if (table->row_count > rows) {
    printf("  and %zu more (summary.json)\n", table->row_count - rows);
  }
  return failed ? DEA_E_MEMORY : DEA_OK;
}

/* "title 5 um, title 3 %": a table of one row. */
static dea_status print_line(struct dea_context *ctx, const struct dea_result_table *table)
{
  struct dea_text line = {.ctx = ctx};
  for (size_t c = 0; c < table->type.column_count; c++) {
    const struct dea_result_column *column = &table->type.columns[c];
    const char *unit = column->display_unit != NULL ? column->display_unit : "1";
    struct dea_text cell = {.ctx = ctx};
    dea_result_table_cell_text(table, 0, c, 0, DIGITS, &cell);
    if (on_screen(column) && cell.length > 0) {
      bool long_text = column->kind == DEA_CELL_TEXT && strchr(dea_text_get(&cell), '\n') != NULL;
      dea_text_add(&line, "%s%s %s%s%s",
                   line.length == 0 ? "  "
                   : long_text      ? "\n  "
                                    : ", ",
                   column->title, dea_text_get(&cell), strcmp(unit, "1") != 0 ? " " : "",
                   strcmp(unit, "1") != 0 ? unit : "");
    }
    line.failed = line.failed || cell.failed;
    dea_text_free(&cell);
  }
  puts(dea_text_get(&line));
  dea_status status = line.failed ? DEA_E_MEMORY : DEA_OK;
  dea_text_free(&line);
  return status;
}

dea_status cli_print_tables(struct dea_context *ctx, const struct dea_result *result,
                            const char *model)
{
  for (size_t i = 0; i < result->table_count; i++) {
    const struct dea_result_table *table = &result->tables[i];
    bool wanted = strcmp(table->model, model) == 0 && table->row_count > 0 &&
                  (table->type.where & (DEA_IN_SCREEN | DEA_IN_TERMINAL)) != 0;
    if (wanted) {
      printf("\n%s: %s\n", model, table->type.title);
      DEA_TRY(ctx, table->type.one_row ? print_line(ctx, table) : print_rows(ctx, table));
    }
  }
  return DEA_OK;
}
