/* MATLAB's .mat files. */
#include "base/h5.h"
#include "import/mat.h"
#include "table/titles.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { HEADER_SIZE = 128, TAG_SIZE = 8, MATRIX = 14, COMPRESSED = 15, OLD_HEADER_SIZE = 20 };
enum { VERSION_5 = 0x100, VERSION_73 = 0x200 }; // as they stand in the file

/* Version 5 and 7.3 begin with 116 bytes of text that say so, and a version and the mark "IM" or
 * "MI" at byte 124. Version 4 has no mark: its name decides. */
static bool recognise(const char *file, const unsigned char *head, size_t length)
{
  bool marked =
      length >= 128 && (memcmp(head + 126, "IM", 2) == 0 || memcmp(head + 126, "MI", 2) == 0);
  return (marked && memcmp(head, "MATLAB ", 7) == 0) || dea_name_ends(file, ".mat");
}

static uint32_t integer(const unsigned char *at, bool big)
{
  uint32_t value = 0;
  for (size_t i = 0; i < 4; i++) {
    value = value << 8 | at[big ? i : 3 - i];
  }
  return value;
}

static dea_status damaged(struct dea_context *ctx, const char *file, uint64_t at, bool longer)
{
  return dea_fail(ctx, DEA_E_IO, "'%s' is cut off or damaged: the variable at byte %llu %s", file,
                  (unsigned long long)at, longer ? "is longer than the file" : "is none");
}

/* Version 5 is a row of variables, each with its length: libmatio takes one that is cut off for the
 * end of the file, and what is damaged as it comes. */
static dea_status check_variables(struct dea_context *ctx, const char *file, FILE *stream, bool big)
{
  unsigned char tag[TAG_SIZE];
  uint64_t at = HEADER_SIZE, size = 0;
  if (fseek(stream, 0, SEEK_END) == 0) {
    size = (uint64_t)ftell(stream);
  }
  while (at < size) {
    bool good = size - at >= TAG_SIZE && fseek(stream, (long)at, SEEK_SET) == 0 &&
                fread(tag, 1, TAG_SIZE, stream) == TAG_SIZE;
    uint32_t type = good ? integer(tag, big) : 0, length = good ? integer(tag + 4, big) : 0;
    if (!good || (type != MATRIX && type != COMPRESSED) || length > size - at - TAG_SIZE) {
      return damaged(ctx, file, at, good && length > size - at - TAG_SIZE);
    }
    at += TAG_SIZE + length;
  }
  return DEA_OK;
}

/* Version 4: headers of five integers (type, rows, columns, complex, length of the name), the name,
 * the values. The type is MOPT in decimal: byte order (1: the most significant byte first, as the
 * integers themselves), nothing, form of a number, kind of matrix. */
static dea_status check_old(struct dea_context *ctx, const char *file, FILE *stream)
{
  static const uint64_t sizes[] = {8, 4, 4, 2, 2, 1};
  unsigned char head[OLD_HEADER_SIZE];
  uint64_t at = 0, size = 0;
  if (fseek(stream, 0, SEEK_END) == 0) {
    size = (uint64_t)ftell(stream);
  }
  while (at < size) {
    if (size - at < OLD_HEADER_SIZE || fseek(stream, (long)at, SEEK_SET) != 0 ||
        fread(head, 1, OLD_HEADER_SIZE, stream) != OLD_HEADER_SIZE) {
      return damaged(ctx, file, at, false);
    }
    bool big = integer(head, false) > 4052;
    uint32_t order = integer(head, big) / 1000, type = integer(head, big) % 1000, form = type / 10;
    uint64_t rows = integer(head + 4, big), columns = integer(head + 8, big);
    uint64_t complex = integer(head + 12, big), name = integer(head + 16, big);
    if (order != (big ? 1 : 0) || form > 5 || type % 10 > 2 || complex > 1 || name == 0) {
      return damaged(ctx, file, at, false);
    }
    // both below 2^32
    uint64_t left = size - at - OLD_HEADER_SIZE, count = rows * columns;
    if (name > left || count > (left - name) / sizes[form] / (complex + 1)) {
      return damaged(ctx, file, at, true);
    }
    at += OLD_HEADER_SIZE + name + count * sizes[form] * (complex + 1);
  }
  return DEA_OK;
}

/* Version 7.3 is HDF5, of which libmatio follows what it names in other files. */
static dea_status check_new(struct dea_context *ctx, const char *file)
{
  struct h5 h;
  dea_h5_begin(&h, ctx, file);
  h.not_it = "cut off or damaged:";
  dea_h5_close(dea_h5_file_open(&h, false));
  dea_h5_end(&h);
  return h.status;
}

static dea_status check_file(struct dea_context *ctx, const char *file)
{
  unsigned char head[HEADER_SIZE];
  FILE *stream = fopen(file, "rb");
  if (stream == NULL) {
    return dea_fail(ctx, DEA_E_IO, "cannot open '%s'", file);
  }
  dea_status status = DEA_OK;
  size_t n = fread(head, 1, HEADER_SIZE, stream);
  bool big = n == HEADER_SIZE && memcmp(head + 126, "MI", 2) == 0;
  bool marked = big || (n == HEADER_SIZE && memcmp(head + 126, "IM", 2) == 0);
  unsigned version = marked ? head[big ? 124 : 125] * 256U + head[big ? 125 : 124] : 0;
  if (version == VERSION_5) {
    status = check_variables(ctx, file, stream, big);
  } else if (version == VERSION_73) {
    status = check_new(ctx, file);
  } else { // libmatio takes it for version 4, whatever its mark
    status = check_old(ctx, file, stream);
  }
  fclose(stream);
  return status;
}

/* Variables have no units but by their names: 'data.voltage_kV', 'z_um(3)'. Names stay whole. */
static dea_status find_units(struct dea_context *ctx, struct dea_table *table)
{
  for (size_t i = 0; i < table->column_count; i++) {
    struct dea_table_column *column = &table->columns[i];
    struct dea_slice title = {column->name, strcspn(column->name, "(")}, name, unit = {"", 0};
    dea_title_split(ctx, title, &name, &unit);
    if (unit.length == 0 || column->unit[0] != '\0') {
      continue;
    }
    char *copy = dea_copy_text(ctx, unit.text, unit.length);
    DEA_TRY_MEMORY(copy != NULL);
    dea_free(ctx, column->unit);
    column->unit = copy;
  }
  return DEA_OK;
}

static dea_status read_mat(struct dea_context *ctx, const char *file, struct dea_table *out)
{
  DEA_TRY(ctx, check_file(ctx, file));
  DEA_TRY(ctx, dea_mat_read(ctx, file, out));
  return find_units(ctx, out);
}

const struct dea_importer dea_import_mat = {
    .name = "mat",
    .formats = "MATLAB's .mat files",
    .recognise = recognise,
    .read_file = read_mat,
};
