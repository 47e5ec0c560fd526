#include "table/csv_text.h"

#include "table/fields.h"
#include "table/text_rows.h"
#include "table/titles.h"
#include "table/words.h"

#include <stdio.h>
#include <string.h>

enum { PREAMBLE_LINES = 400, KEY_SIZE = 64, NOTE_SIZE = 4000 };

/* The titles of one line, parted as the numbers are or, for a comment, in any other way. */
static bool part(const struct dea_csv_dialect *dialect, size_t line, struct dea_slice *out)
{
  static const char separators[] = {'\t', ';', ',', '|', ' '};
  size_t quotes = 0;
  for (size_t i = 0; line < dialect->title_count && i < dialect->titles[line].length; i++) {
    quotes += dialect->titles[line].text[i] == '"';
  }
  if (line >= dialect->title_count || quotes % 2 == 1) { // a title goes on in another line
    return false;
  }
  if (dea_titles_part(dialect->titles[line], dialect->separator, dialect->count, out)) {
    return true;
  }
  for (size_t i = 0; i < sizeof separators && dialect->count > 1; i++) {
    if (dea_titles_part(dialect->titles[line], separators[i], dialect->count, out)) {
      return true;
    }
  }
  return false;
}

/* text: columns of text, which may hold any word beside two units or more; NULL: none is. What is
 * no unit is emptied then. */
static bool is_row_of_units(struct dea_context *ctx, struct dea_slice *fields, size_t count,
                            const bool *text)
{
  size_t units = 0, words = 0;
  for (size_t i = 0; i < count; i++) {
    struct dea_slice f = fields[i];
    if (f.length > 2 && (f.text[0] == '(' || f.text[0] == '[')) {
      f = dea_slice_trim((struct dea_slice){f.text + 1, f.length - 2});
    }
    bool unit = f.length > 0 && dea_title_is_unit(ctx, f);
    bool word = f.length > 0 && !unit && text != NULL && (text[i] || dea_slice_is(f, "no."));
    if (f.length > 0 && !unit && !word) {
      return false;
    }
    units += unit;
    words += word;
    fields[i].length = word ? 0 : fields[i].length;
  }
  return units > (words > 0 ? 1 : 0);
}

/* Whether all fields are words: "Second,Volt" tells units where "t,V" names quantities. */
static bool are_words(const struct dea_slice *fields, size_t count)
{
  bool words = true;
  for (size_t i = 0; i < count; i++) {
    words = words && (fields[i].length == 0 || fields[i].length > 3);
  }
  return words;
}

/* "Vertical Units,V,V" of an oscilloscope, further up: units of all columns but that of the times,
 * those whose title has one, and those whose unit is none that is known ("VV" of a product). */
static bool find_vertical_units(struct dea_context *ctx, struct dea_slice text,
                                const struct dea_csv_dialect *dialect,
                                const struct dea_slice *titles, struct dea_slice *out)
{
  struct dea_lines lines = {text.text, dialect->data, 0};
  struct dea_slice line;
  while (lines.line < PREAMBLE_LINES && dea_lines_next(&lines, &line)) {
    if (dea_slice_starts(line, "Vertical Units") &&
        dea_titles_part(line, dialect->separator, dialect->count, out)) {
      bool any = false;
      for (size_t i = 0; i < dialect->count; i++) {
        struct dea_slice name, unit;
        dea_title_split(ctx, titles[i], &name, &unit);
        bool taken = i > 0 && unit.length == 0 && is_row_of_units(ctx, &out[i], 1, NULL);
        out[i].length = taken ? out[i].length : 0;
        any = any || taken;
      }
      return any;
    }
  }
  return false;
}

/* Fields of a line by the separator that gives most. */
static size_t count_fields(struct dea_slice line)
{
  static const char separators[] = {'\t', ';', ','};
  size_t most = 0;
  for (size_t i = 0; i < sizeof separators; i++) {
    const size_t count = dea_slice_count(line, separators[i]);
    most = count > most ? count : most;
  }
  return most;
}

/* Rows that have more or less fields than there are titles: an error where columns are wanted by
 * name, and where decimal commas would make two of one. */
static dea_status check_header(struct dea_context *ctx, struct dea_slice text,
                               const struct dea_table *table, const struct dea_csv_dialect *dialect,
                               size_t named)
{
  const bool comma = dialect->separator == ',' && 2 * named == dialect->count;
  struct dea_slice rest = {dialect->data, (size_t)(text.text + text.length - dialect->data)};
  struct dea_slice field = {dialect->data, 0};
  if (named < 2 || !(comma || table->fields != NULL)) {
    return DEA_OK;
  }
  for (size_t i = 0; i <= named && i < dialect->count; i++) {
    dea_slice_field(&rest, dialect->separator, &field);
  }
  const struct dea_location location = {table->file, dialect->line + 1,
                                        (size_t)(field.text - dialect->data) + 1};
  DEA_TRY(ctx, dea_finding_add(
                   ctx, DEA_ERROR, location, "%s fields than the header, which has %zu%s",
                   dialect->count > named ? "more" : "fewer", named,
                   comma ? "; where the decimal sign is a comma, columns are parted by ;" : ""));
  return dea_fail(ctx, DEA_E_IO, "'%s' cannot be read", table->file);
}

/* Names and units from the lines above the numbers: names alone, names and units, or names, units
 * and comments, in this order. *units says whether there are any. */
static dea_status find_titles(struct dea_context *ctx, struct dea_slice text,
                              const struct dea_table *table, const struct dea_csv_dialect *dialect,
                              struct dea_slice *titles, struct dea_slice *unit_fields, bool *units)
{
  const struct dea_location location = {table->file, dialect->line + 1, 1};
  *units = false;
  for (size_t i = 0; i < 2 && i < dialect->title_count; i++) {
    if (part(dialect, i, unit_fields) &&
        is_row_of_units(ctx, unit_fields, dialect->count, dialect->text) &&
        part(dialect, i + 1, titles)) {
      *units = true;
      return DEA_OK;
    }
  }
  // of a single column what parts fields is not known
  const size_t named = dialect->title_count == 0 ? 0
                       : dialect->count > 1
                           ? dea_slice_count(dialect->titles[0], dialect->separator)
                           : count_fields(dialect->titles[0]);
  const bool alone = table->fields != NULL && dialect->count == 1 && named > 1;
  if (!alone && part(dialect, 0, titles)) {
    *units = dialect->count > 1 && part(dialect, 0, unit_fields) &&
             is_row_of_units(ctx, unit_fields, dialect->count, NULL) &&
             are_words(unit_fields, dialect->count); // names and units in one
    *units = *units || find_vertical_units(ctx, text, dialect, titles, unit_fields);
    return DEA_OK;
  }
  for (size_t i = 0; i < dialect->count; i++) {
    titles[i] = (struct dea_slice){"", 0};
  }
  DEA_TRY(ctx, check_header(ctx, text, table, dialect, named));
  if (named > 0) {
    return dea_finding_add(ctx, DEA_NOTE, location,
                           "the lines above the numbers name no %zu columns: they are called "
                           "'column 1' and so on",
                           dialect->count);
  }
  return DEA_OK;
}

/* "Sample rate;1000 Hz" and the like above the numbers: a column of one value. */
static dea_status read_clock(struct dea_context *ctx, struct dea_slice line, char decimal,
                             struct dea_table *table)
{
  char key[KEY_SIZE];
  size_t n = 0;
  while (n < line.length && strchr(":=;,\t", line.text[n]) == NULL) {
    n++;
  }
  struct dea_slice name = dea_slice_trim((struct dea_slice){line.text, n}), unit = {"", 0}, rest;
  if (n == line.length || name.length >= sizeof key) {
    return DEA_OK;
  }
  dea_title_split(ctx, name, &name, &unit);
  snprintf(key, sizeof key, "%.*s", (int)name.length, name.text);
  if (dea_word_clock(key) == DEA_WORD_NONE) {
    return DEA_OK;
  }
  rest = (struct dea_slice){line.text + n + 1, line.length - n - 1};
  struct dea_slice field, next;
  double value;
  while (rest.text != NULL && dea_slice_field(&rest, ' ', &field)) {
    while (field.length > 0 && strchr(":=;,\"", field.text[field.length - 1]) != NULL) {
      field.length--;
    }
    if (!dea_slice_number(field, decimal, &value) || !(value > 0)) {
      continue;
    }
    if (dea_slice_field(&rest, ' ', &next) && dea_title_is_unit(ctx, next)) {
      unit = next;
    }
    struct dea_table_column *column =
        dea_table_add(ctx, table, name.text, name.length, unit.text, unit.length, 1);
    if (column == NULL) {
      return dea_context_status(ctx);
    }
    column->values[0] = value;
    column->count = 1;
    return DEA_OK;
  }
  return DEA_OK;
}

static dea_status read_preamble(struct dea_context *ctx, struct dea_slice text,
                                const struct dea_csv_dialect *dialect, struct dea_table *table)
{
  struct dea_lines lines = {text.text, dialect->data, 0};
  struct dea_slice line;
  size_t length = (size_t)(dialect->data - text.text);
  if (dialect->title_count > 1) {
    DEA_TRY(ctx, dea_table_note(ctx, table, text.text, length < NOTE_SIZE ? length : NOTE_SIZE));
  }
  while (lines.line < PREAMBLE_LINES && dea_lines_next(&lines, &line)) {
    if (dea_csv_is_comment(line)) {
      line = dea_slice_trim(line);
      line = dea_slice_trim((struct dea_slice){line.text + 1, line.length - 1});
    }
    DEA_TRY(ctx, read_clock(ctx, line, dialect->decimal, table));
  }
  return DEA_OK;
}

/* Drops columns at the end without name and values, which separators at the ends of lines make. */
static void drop_empty(struct dea_context *ctx, struct dea_table *table, size_t named)
{
  while (table->column_count > named) {
    struct dea_table_column *column = &table->columns[table->column_count - 1];
    for (size_t i = 0; i < column->count; i++) {
      if (column->values[i] == column->values[i]) {
        return;
      }
    }
    if (strncmp(column->name, "column ", 7) != 0) {
      return;
    }
    dea_free(ctx, column->name);
    dea_free(ctx, column->unit);
    dea_free(ctx, column->values);
    table->column_count--;
  }
}

static dea_status read_with(struct dea_context *ctx, struct dea_slice text,
                            const struct dea_csv_dialect *dialect, struct dea_slice *slices,
                            struct dea_table *out)
{
  bool units;
  struct dea_slice *unit_fields = slices + dialect->count;
  DEA_TRY(ctx, find_titles(ctx, text, out, dialect, slices, unit_fields, &units));
  if (out->fields != NULL) {
    for (size_t i = 0; i < dialect->count && !units; i++) {
      unit_fields[i] = (struct dea_slice){"", 0};
    }
    return dea_text_lines_read(ctx, text, dialect, out);
  }
  DEA_TRY(ctx, dea_text_rows_read(ctx, text, dialect, slices, units ? unit_fields : NULL, out));
  drop_empty(ctx, out, 1);
  return read_preamble(ctx, text, dialect, out);
}

dea_status dea_table_read_text(struct dea_context *ctx, struct dea_slice text,
                               struct dea_table *out)
{
  struct dea_csv_dialect dialect;
  dea_status status = dea_csv_dialect_find(ctx, out->file, text, &dialect);
  struct dea_slice *slices = NULL;
  if (status == DEA_OK) {
    slices = dea_alloc(ctx, 2 * dialect.count, sizeof *slices);
    status = slices != NULL ? read_with(ctx, text, &dialect, slices, out) : DEA_E_MEMORY;
  }
  if (out->fields != NULL && slices != NULL) {
    out->fields->separator = dialect.separator;
    out->fields->decimal = dialect.decimal;
    out->fields->count = dialect.count;
    out->fields->titles = slices;
    out->fields->units = slices + dialect.count;
    out->fields->text = text;
    slices = NULL;
  }
  dea_free(ctx, slices);
  dea_free(ctx, dialect.text);
  return status;
}
