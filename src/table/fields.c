#include "table/fields.h"

#include "base/csv_line.h"
#include "base/file.h"
#include "table/csv_text.h"
#include "table/text_file.h"
#include "table/titles.h"

#include <math.h>
#include <string.h>

enum { FILE_MAX = 100000000 };

dea_status dea_fields_read(struct dea_context *ctx, const char *file, struct dea_fields *out)
{
  struct dea_table table = {.file = dea_intern(ctx, file), .fields = out};
  size_t length;
  *out = (struct dea_fields){.file = table.file};
  DEA_TRY_MEMORY(table.file != NULL);
  const dea_status read = dea_file_read(ctx, file, FILE_MAX, &out->bytes, &length);
  DEA_TRY(ctx, read == DEA_E_DESIGN ? dea_fail(ctx, DEA_E_IO, "'%s' is too large", file) : read);
  const dea_status status = dea_text_file_read(ctx, (const unsigned char *)out->bytes, length,
                                               dea_table_read_text, &table);
  if (status != DEA_OK) {
    dea_fields_free(ctx, out);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  return DEA_OK;
}

struct dea_location dea_fields_place(const struct dea_fields *fields, struct dea_slice piece)
{
  struct dea_location at = {fields->file, 1, 1};
  const char *end = fields->text.text + fields->text.length;
  for (const char *c = fields->text.text; c < piece.text && c < end; c++) {
    at.column = *c == '\n' ? 1 : at.column + 1;
    at.line += *c == '\n';
  }
  return at;
}

static void copy_slice(struct dea_slice slice, char *out)
{
  const size_t n = slice.length < DEA_CSV_FIELD_MAX ? slice.length : DEA_CSV_FIELD_MAX - 1;
  if (n > 0) {
    memcpy(out, slice.text, n);
  }
  out[n] = '\0';
}

void dea_fields_title(struct dea_context *ctx, const struct dea_fields *fields, size_t column,
                      char *name, char *unit)
{
  char title[DEA_CSV_FIELD_MAX];
  struct dea_slice bare, own = fields->units[column];
  copy_slice(fields->titles[column], title);
  dea_csv_split_title(title, name, unit);
  if (unit[0] == '\0' && own.length > 0) {
    const bool bracket = own.length > 2 && (own.text[0] == '(' || own.text[0] == '[');
    copy_slice(bracket ? (struct dea_slice){own.text + 1, own.length - 2} : own, unit);
  } else if (unit[0] == '\0') {
    dea_title_split(ctx, fields->titles[column], &bare, &own);
    copy_slice(own, unit);
    copy_slice(bare, title);
    dea_csv_fold(title, name);
  }
}

/* "1e999" and "inf", which are no words for a missing value. */
static bool is_too_large(struct dea_slice field, double value)
{
  char text[DEA_CSV_FIELD_MAX];
  const char *end;
  copy_slice(field, text);
  return value != value && isinf(dea_text_to_double(text, &end)) && *end == '\0';
}

bool dea_fields_number(struct dea_context *ctx, const struct dea_fields *fields, size_t row,
                       struct dea_slice field, struct dea_text_marks *marks, double *value)
{
  // "3.5" among decimal commas, where a comma parts no fields
  const char other = fields->separator == ',' || dea_slice_has_groups(field) ? fields->decimal
                     : fields->decimal == ','                                ? '.'
                                                                             : ',';
  const bool number =
      dea_slice_number(field, fields->decimal, value) || dea_slice_number(field, other, value);
  if (number && !is_too_large(field, *value)) {
    dea_text_marks_count(marks, field, fields->decimal, fields->numbers[row]);
    return true;
  }
  const struct dea_location here = {fields->file, fields->numbers[row],
                                    (size_t)(field.text - fields->lines[row].text) + 1};
  (void)dea_finding_add(ctx, DEA_ERROR, here,
                        dea_slice_has_groups(field)
                            ? "'%.*s' has marks between thousands: export numbers without them"
                            : "'%.*s' is not a number",
                        (int)(field.length < 40 ? field.length : 40), field.text);
  return false;
}

void dea_fields_free(struct dea_context *ctx, struct dea_fields *fields)
{
  dea_free(ctx, fields->titles);
  dea_free(ctx, fields->lines);
  dea_free(ctx, fields->numbers);
  dea_free(ctx, fields->bytes);
  dea_free(ctx, fields->copy);
  *fields = (struct dea_fields){0};
}
