#include "table/imported_table.h"

#include "base/text.h"

#include <math.h>
#include <string.h>

/* Text of a file as UTF-8: what is none is taken for Latin-1. Control characters become blanks. */
static char *copy_text(struct dea_context *ctx, const char *text, size_t length)
{
  text = length > 0 ? text : "";
  const char *zero = memchr(text, 0, length);
  length = zero != NULL ? (size_t)(zero - text) : length;
  char *whole = dea_copy_text(ctx, text, length);
  char *out = whole != NULL ? dea_alloc(ctx, 2 * length + 1, 1) : NULL;
  size_t n = 0;
  bool good = true;
  unsigned code;
  for (size_t i = 0; out != NULL && i < length && good; i++) {
    size_t bytes = dea_letter_read(whole + i, &code);
    good = bytes > 0;
    i += good ? bytes - 1 : 0;
  }
  for (size_t i = 0; out != NULL && i < length; i++) {
    unsigned char c = (unsigned char)text[i];
    if (c >= 0x80 && !good) {
      out[n++] = (char)(0xc0 | c >> 6);
      c = 0x80 | (c & 0x3f);
    }
    out[n++] = (char)c;
  }
  if (out != NULL) {
    dea_text_flatten(out);
  }
  dea_free(ctx, whole);
  return out;
}

struct dea_table_column *dea_table_add(struct dea_context *ctx, struct dea_table *table,
                                       const char *name, size_t name_length, const char *unit,
                                       size_t unit_length, size_t capacity)
{
  if (table->column_count == DEA_TABLE_COLUMNS_MAX) {
    dea_fail(ctx, DEA_E_IO, "'%s' has more than %d columns", table->file,
             (int)DEA_TABLE_COLUMNS_MAX);
    return NULL;
  }
  if (dea_array_grow(ctx, &table->columns, table->column_count, &table->column_room,
                     sizeof *table->columns) != DEA_OK) {
    return NULL;
  }
  struct dea_table_column *column = &table->columns[table->column_count];
  *column = (struct dea_table_column){.start = 0, .interval = NAN, .origin_s = NAN};
  column->name = copy_text(ctx, name, name_length);
  column->unit = column->name != NULL ? copy_text(ctx, unit, unit_length) : NULL;
  column->values = column->unit != NULL ? dea_alloc(ctx, capacity, sizeof(double)) : NULL;
  if (column->values == NULL) {
    dea_free(ctx, column->name);
    dea_free(ctx, column->unit);
    return NULL;
  }
  table->column_count++;
  return column;
}

dea_status dea_table_leave(struct dea_context *ctx, struct dea_table *table, struct dea_slice name,
                           struct dea_slice field, size_t line)
{
  void *moved = dea_resize(ctx, table->left, table->left_count + 1, sizeof *table->left);
  DEA_TRY_MEMORY(moved != NULL);
  table->left = moved;
  struct dea_table_left *left = &table->left[table->left_count++];
  *left = (struct dea_table_left){copy_text(ctx, name.text, name.length),
                                  copy_text(ctx, field.text, field.length), line};
  return left->name != NULL && left->field != NULL ? DEA_OK : DEA_E_MEMORY;
}

dea_status dea_table_note(struct dea_context *ctx, struct dea_table *table, const char *text,
                          size_t length)
{
  dea_free(ctx, table->note);
  table->note = copy_text(ctx, text, length);
  return table->note != NULL ? DEA_OK : DEA_E_MEMORY;
}

void dea_table_destroy(struct dea_context *ctx, struct dea_table *table)
{
  for (size_t i = 0; table != NULL && i < table->column_count; i++) {
    dea_free(ctx, table->columns[i].name);
    dea_free(ctx, table->columns[i].unit);
    dea_free(ctx, table->columns[i].values);
  }
  for (size_t i = 0; table != NULL && i < table->left_count; i++) {
    dea_free(ctx, table->left[i].name);
    dea_free(ctx, table->left[i].field);
  }
  if (table != NULL) {
    dea_free(ctx, table->left);
    dea_free(ctx, table->columns);
    dea_free(ctx, table->note);
    dea_free(ctx, table);
  }
}
