/* Format "trios": JSON as TRIOS writes it (rheometers and DMA by TA Instruments). "Results" has
 * "ColumnHeaders", an object of columns ("DisplayName", "ValueType", "Unit": {"Name"}), and "Rows",
 * an object a row with a value for each column's key; both may stand one level deeper, in
 * "Processed" (what people have edited) beside other sets. Source: the schema that its maker gives
 * away (TRIOSJSONExportSchema). */
#include "base/file.h"
#include "base/json.h"
#include "import/import.h"

#include <math.h>
#include <string.h>

static bool recognise(const char *file, const unsigned char *head, size_t length)
{
  static const char blanks[] = "\xef\xbb\xbf \t\r\n";
  size_t i = 0;
  while (i < length && head[i] != '\0' && strchr(blanks, head[i]) != NULL) {
    i++;
  }
  return dea_path_ends_with(file, ".json") && i < length && head[i] == '{';
}

/* The set of results with headers and rows; NULL: there is none. */
static const json_t *find_set(const json_t *root)
{
  const json_t *results = json_object_get(root, "Results");
  const json_t *sets[] = {results, json_object_get(results, "Processed"),
                          json_object_get(results, "Unprocessed")};
  for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++) {
    if (json_is_object(json_object_get(sets[i], "ColumnHeaders")) &&
        json_is_array(json_object_get(sets[i], "Rows"))) {
      return sets[i];
    }
  }
  return NULL;
}

static const char *text_of(const json_t *object, const char *key)
{
  const char *text = json_string_value(json_object_get(object, key));
  return text != NULL ? text : "";
}

static bool is_taken(const struct dea_table *table, const char *name)
{
  bool taken = false;
  for (size_t i = 0; i < table->column_count; i++) {
    taken = taken || strcmp(table->columns[i].name, name) == 0;
  }
  return taken;
}

/* What a row lacks, or has as null, is missing. */
static dea_status read_column(struct dea_context *ctx, const char *key, const json_t *header,
                              const json_t *rows, struct dea_table *out)
{
  const size_t count = json_array_size(rows);
  const char *name = text_of(header, "DisplayName");
  const char *unit = text_of(json_object_get(header, "Unit"), "Name");
  name = name[0] == '\0' || is_taken(out, name) ? key : name;
  struct dea_table_column *column =
      dea_table_add(ctx, out, name, strlen(name), unit, strlen(unit), count);
  if (column == NULL) {
    return dea_context_status(ctx);
  }
  for (size_t i = 0; i < count; i++) {
    const json_t *row = json_array_get(rows, i), *value = json_object_get(row, key);
    if (!json_is_object(row)) {
      return dea_fail(ctx, DEA_E_IO, "'%s', row %zu: it is no object", out->file, i + 1);
    }
    if (value != NULL && !json_is_null(value) && !json_is_number(value)) {
      return dea_fail(ctx, DEA_E_IO, "'%s', row %zu: '%.60s' is no number, and its column says so",
                      out->file, i + 1, key);
    }
    column->values[i] = json_is_number(value) ? json_number_value(value) : NAN;
  }
  column->count = count;
  return DEA_OK;
}

static dea_status read_set(struct dea_context *ctx, const json_t *root, struct dea_table *out)
{
  const json_t *set = find_set(root);
  if (set == NULL) {
    return dea_fail(ctx, DEA_E_IO,
                    "'%s' is no JSON of TRIOS: it has no 'Results' with 'ColumnHeaders' and 'Rows'",
                    out->file);
  }
  json_t *headers = json_object_get(set, "ColumnHeaders"), *header;
  const json_t *rows = json_object_get(set, "Rows");
  const char *key, *sample = text_of(json_object_get(root, "Sample"), "Name");
  DEA_TRY(ctx, dea_table_note(ctx, out, sample, strlen(sample)));
  json_object_foreach(headers, key, header)
  {
    const char *type = text_of(header, "ValueType");
    if (strcmp(type, "Number") == 0 || strcmp(type, "Integer") == 0) {
      DEA_TRY(ctx, read_column(ctx, key, header, rows, out));
    }
  }
  return DEA_OK;
}

static dea_status read_bytes(struct dea_context *ctx, const char *file, const unsigned char *bytes,
                             size_t length, struct dea_table *out)
{
  static const unsigned char mark[] = {0xef, 0xbb, 0xbf};
  const size_t skip = length >= sizeof mark && memcmp(bytes, mark, sizeof mark) == 0 ? 3 : 0;
  json_error_t error;
  (void)file;
  json_t *root =
      json_loadb((const char *)bytes + skip, length - skip, JSON_DECODE_INT_AS_REAL, &error);
  if (root == NULL) {
    const struct dea_location here = {out->file, error.line > 0 ? (size_t)error.line : 1,
                                      error.column > 0 ? (size_t)error.column : 1};
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, here, "no JSON: %.120s", error.text));
    return dea_fail(ctx, DEA_E_IO, "'%s' has errors", out->file);
  }
  dea_status status = read_set(ctx, root, out);
  json_decref(root);
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

const struct dea_importer dea_import_trios = {
    .name = "trios",
    .formats = "JSON of TRIOS",
    .recognise = recognise,
    .read_bytes = read_bytes,
};
