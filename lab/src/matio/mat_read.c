/* .mat files by libmatio, reading: variables become columns.
 *
 * What a file claims is compared with its length before anything is allocated for it: compressed
 * numbers are at most about a thousand times smaller than themselves. */
#include "base/module.h"
#include "base/text.h"
#include "matio/mat_check.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum { NAME_SIZE = 512, DEPTH_MAX = 8, VARIABLES_MAX = 100000, RATIO_MAX = 1100 };

struct reader {
  struct dea_context *ctx;
  const char *file;
  struct dea_table *table;
  struct dea_text note;
  uint64_t bytes_max; // of all variables together
  uint64_t bytes;
  size_t unread; // variables that cannot be
};

/* The value at an index of an array of this class; NAN: of no number. */
static double value_at(const matvar_t *variable, size_t i)
{
  const void *data = variable->data;
  switch (variable->class_type) {
  case MAT_C_DOUBLE:
    return ((const double *)data)[i];
  case MAT_C_SINGLE:
    return ((const float *)data)[i];
  case MAT_C_INT8:
    return ((const int8_t *)data)[i];
  case MAT_C_UINT8:
    return ((const uint8_t *)data)[i];
  case MAT_C_INT16:
    return ((const int16_t *)data)[i];
  case MAT_C_UINT16:
    return ((const uint16_t *)data)[i];
  case MAT_C_INT32:
    return ((const int32_t *)data)[i];
  case MAT_C_UINT32:
    return ((const uint32_t *)data)[i];
  case MAT_C_INT64:
    return (double)((const int64_t *)data)[i];
  case MAT_C_UINT64:
    return (double)((const uint64_t *)data)[i];
  default:
    return NAN;
  }
}

static size_t class_size(enum matio_classes class)
{
  switch (class) {
  case MAT_C_INT8:
  case MAT_C_UINT8:
    return 1;
  case MAT_C_INT16:
  case MAT_C_UINT16:
    return 2;
  case MAT_C_SINGLE:
  case MAT_C_INT32:
  case MAT_C_UINT32:
    return 4;
  case MAT_C_DOUBLE:
  case MAT_C_INT64:
  case MAT_C_UINT64:
    return 8;
  default:
    return 0;
  }
}

/* Product of the dimensions; SIZE_MAX when it is none. */
static size_t element_count(const matvar_t *variable)
{
  size_t count = 1;
  if (variable->rank < 1 || variable->dims == NULL) {
    return 0;
  }
  for (int k = 0; k < variable->rank; k++) {
    size_t n = variable->dims[k];
    if (n != 0 && count > SIZE_MAX / 16 / n) {
      return SIZE_MAX;
    }
    count *= n;
  }
  return count;
}

static dea_status warn(struct reader *reader, const char *name, const char *what)
{
  const struct dea_location location = {.file = reader->file};
  return dea_finding_add(reader->ctx, DEA_NOTE, location, "'%.80s' %s", name, what);
}

// Columns ----------------------------------------------------------------------------------------

/* Values `first`, `first + step`, ... as a column. */
static dea_status add_column(struct reader *reader, const matvar_t *variable, const char *name,
                             size_t first, size_t step, size_t count)
{
  struct dea_table_column *column =
      dea_table_add(reader->ctx, reader->table, name, strlen(name), "", 0, count);
  if (column == NULL) {
    return dea_context_status(reader->ctx);
  }
  for (size_t i = 0; i < count; i++) {
    column->values[i] = value_at(variable, first + i * step);
  }
  column->count = count;
  return DEA_OK;
}

/* A matrix is a column each; one that is wider than a table holds, a row each. */
static dea_status add_matrix(struct reader *reader, const matvar_t *variable, const char *name)
{
  size_t rows = variable->dims[0], columns = variable->dims[1];
  char part[NAME_SIZE + 32];
  bool turned = columns > DEA_MAT_COLUMNS_MAX && rows <= DEA_MAT_COLUMNS_MAX;
  if (columns > DEA_MAT_COLUMNS_MAX && !turned) {
    return warn(reader, name, "is too large in both directions and is left out");
  }
  if (turned) {
    DEA_TRY(reader->ctx, warn(reader, name,
                              "has many more columns than rows: its rows are taken as "
                              "columns"));
  }
  for (size_t k = 0; k < (turned ? rows : columns); k++) {
    snprintf(part, sizeof part, "%s(%zu)", name, k + 1);
    DEA_TRY(reader->ctx, turned ? add_column(reader, variable, part, k, rows, columns)
                                : add_column(reader, variable, part, k * rows, 1, rows));
  }
  return DEA_OK;
}

static dea_status add_numbers(struct reader *reader, const matvar_t *variable, const char *name)
{
  size_t count = element_count(variable), size = class_size(variable->class_type);
  if (count == 0) {
    return DEA_OK;
  }
  if (variable->isComplex) {
    return warn(reader, name, "is complex and is left out; save real() and imag() of it");
  }
  // what libmatio could not read of it is not there
  if (variable->data == NULL || count > variable->nbytes / size) {
    return dea_fail(reader->ctx, DEA_E_IO, "'%s': the values of '%.80s' cannot be read",
                    reader->file, name);
  }
  bool matrix = variable->rank == 2 && variable->dims[0] > 1 && variable->dims[1] > 1;
  bool vector = !matrix;
  for (int k = 0, long_ones = 0; k < variable->rank && vector; k++) {
    long_ones += variable->dims[k] > 1;
    vector = long_ones < 2;
  }
  if (matrix) {
    return add_matrix(reader, variable, name);
  }
  return vector ? add_column(reader, variable, name, 0, 1, count)
                : warn(reader, name, "has more than two dimensions and is left out");
}

/* Text goes to the table's note. */
static void add_text(struct reader *reader, const matvar_t *variable, const char *name)
{
  size_t count = element_count(variable);
  if (variable->data == NULL || count == 0 || count > 400 || variable->dims[0] != 1) {
    return;
  }
  dea_text_add(&reader->note, "%s%s: ", reader->note.length > 0 ? "; " : "", name);
  for (size_t i = 0; i < count; i++) {
    unsigned code = '?';
    if (variable->data_type == MAT_T_UINT16 || variable->data_type == MAT_T_UTF16) {
      code = 2 * i + 2 <= variable->nbytes ? ((const uint16_t *)variable->data)[i] : '?';
    } else if (i < variable->nbytes) {
      code = ((const unsigned char *)variable->data)[i];
    }
    dea_text_add(&reader->note, "%c", code >= ' ' && code < 0x7f ? (int)code : '?');
  }
}

static dea_status add_variable(struct reader *reader, matvar_t *variable, const char *name,
                               int depth);

/* Fields of a struct, named with dots; of an array of structs the first one. */
static dea_status add_struct(struct reader *reader, matvar_t *variable, const char *name, int depth)
{
  char part[NAME_SIZE];
  char *const *names = Mat_VarGetStructFieldnames(variable);
  unsigned count = names != NULL ? Mat_VarGetNumberOfFields(variable) : 0;
  size_t elements = element_count(variable);
  if (elements == 0 || variable->data == NULL) {
    return DEA_OK;
  }
  if (elements > 1) {
    DEA_TRY(reader->ctx, warn(reader, name, "is an array of structs, of which the first is read"));
  }
  for (unsigned k = 0; k < count; k++) {
    matvar_t *field = Mat_VarGetStructFieldByIndex(variable, k, 0);
    int n = snprintf(part, sizeof part, "%s.%s", name, names[k] != NULL ? names[k] : "");
    if (field != NULL && n > 0 && (size_t)n < sizeof part) {
      DEA_TRY(reader->ctx, add_variable(reader, field, part, depth + 1));
    }
  }
  return DEA_OK;
}

static dea_status add_variable(struct reader *reader, matvar_t *variable, const char *name,
                               int depth)
{
  if (class_size(variable->class_type) > 0) {
    return add_numbers(reader, variable, name);
  }
  switch (variable->class_type) {
  case MAT_C_CHAR:
    add_text(reader, variable, name);
    return DEA_OK;
  case MAT_C_STRUCT:
    return depth < DEPTH_MAX ? add_struct(reader, variable, name, depth)
                             : warn(reader, name, "lies too deep and is left out");
  case MAT_C_CELL:
    return warn(reader, name, "is a cell array and is left out; save its parts as variables");
  case MAT_C_SPARSE:
    return warn(reader, name, "is sparse and is left out; save full() of it");
  case MAT_C_EMPTY:
    return element_count(variable) == 0
               ? DEA_OK
               : warn(reader, name,
                      "is an object (a table, a timetable, ...) that only MATLAB reads: "
                      "save it with struct(), table2struct(), or as CSV with "
                      "writetable() or writetimetable()");
  default:
    reader->unread++;
    return warn(reader, name,
                "is an object (a table, a timetable, ...) that only MATLAB reads: save it with "
                "table2struct(), or as CSV with writetable() or writetimetable()");
  }
}

// File -------------------------------------------------------------------------------------------

/* Bytes that a variable with its fields claims; UINT64_MAX when that is nonsense. */
static uint64_t claimed_bytes(matvar_t *variable, int depth)
{
  size_t count = element_count(variable);
  if (count == SIZE_MAX || depth > DEPTH_MAX) {
    return UINT64_MAX;
  }
  if (variable->class_type != MAT_C_STRUCT || variable->data == NULL) {
    size_t size = class_size(variable->class_type);
    return (uint64_t)count * (size > 0 ? size : 1) * (variable->isComplex ? 2 : 1);
  }
  uint64_t sum = 0;
  unsigned fields = Mat_VarGetNumberOfFields(variable);
  for (unsigned k = 0; k < fields && sum != UINT64_MAX; k++) {
    for (size_t i = 0; i < count && sum != UINT64_MAX; i++) {
      matvar_t *field = Mat_VarGetStructFieldByIndex(variable, k, i);
      uint64_t bytes = field != NULL ? claimed_bytes(field, depth + 1) : 0;
      sum = bytes > UINT64_MAX - sum ? UINT64_MAX : sum + bytes;
    }
  }
  return sum;
}

static bool is_read(enum matio_classes class)
{
  return class == MAT_C_STRUCT || class == MAT_C_CHAR || class_size(class) > 0;
}

static dea_status read_variable(struct reader *reader, mat_t *mat, matvar_t *variable)
{
  const char *name = variable->name != NULL ? variable->name : "unnamed";
  if (is_read(variable->class_type)) {
    uint64_t bytes = claimed_bytes(variable, 0);
    if (bytes > reader->bytes_max - reader->bytes) {
      return dea_fail(reader->ctx, DEA_E_IO,
                      "'%s': the variable '%.80s' claims more values than the file can hold",
                      reader->file, name);
    }
    reader->bytes += bytes;
    if (Mat_VarReadDataAll(mat, variable) != 0) {
      return dea_fail(reader->ctx, DEA_E_IO, "'%s': the variable '%.80s' cannot be read",
                      reader->file, name);
    }
  }
  return add_variable(reader, variable, name, 0);
}

static dea_status read_all(struct reader *reader, mat_t *mat)
{
  for (int i = 0; i < VARIABLES_MAX; i++) {
    matvar_t *variable = Mat_VarReadNextInfo(mat);
    if (variable == NULL) {
      break;
    }
    dea_status status = read_variable(reader, mat, variable);
    Mat_VarFree(variable);
    DEA_TRY(reader->ctx, status);
    if (dea_interrupted(reader->ctx)) {
      return dea_fail(reader->ctx, DEA_E_INTERRUPTED, "interrupted");
    }
  }
  DEA_TRY_MEMORY(!reader->note.failed);
  if (reader->note.length > 0) {
    DEA_TRY(reader->ctx, dea_table_note(reader->ctx, reader->table, dea_text_get(&reader->note),
                                        reader->note.length));
  }
  return DEA_OK;
}

/* libmatio's own messages go nowhere: it would print them, and end the program at some. */
static void be_quiet(int level, char *message)
{
  (void)level;
  (void)message;
}

static dea_status read_mat(struct dea_context *ctx, const char *file, struct dea_table *out)
{
  struct reader reader = {.ctx = ctx, .file = out->file, .table = out, .note = {.ctx = ctx}};
  struct stat info;
  if (stat(file, &info) != 0 || info.st_size <= 0) {
    return dea_fail(ctx, DEA_E_IO, "cannot read '%s'", file);
  }
  reader.bytes_max = (uint64_t)info.st_size * RATIO_MAX;
  DEA_TRY(ctx, dea_matio_check(ctx, file));
  Mat_LogInitFunc("dea", be_quiet);
  mat_t *mat = Mat_Open(file, MAT_ACC_RDONLY);
  if (mat == NULL) {
    return dea_fail(ctx, DEA_E_IO, "'%s' is no .mat file of version 5 or 7.3", file);
  }
  dea_status status = read_all(&reader, mat);
  Mat_Close(mat);
  dea_text_free(&reader.note);
  return status;
}

extern DEA_MODULE_SYMBOL const struct dea_mat_type dea_matio_module;

const struct dea_mat_type dea_matio_module = {.read = read_mat};
