/* MATLAB's .mat files. */
#include "base/file.h"
#include "base/h5.h"
#include "base/module.h"
#include "import/mat.h"
#include "table/titles.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { HEADER_SIZE = 128, TAG_SIZE = 8, MATRIX = 14, COMPRESSED = 15 };
enum { VERSION_5 = 0x100, VERSION_73 = 0x200 }; // as they stand in the file
static const char module_file[] = "dea_matio_module.so";

bool dea_mat_find(char *out, size_t size)
{
  return dea_module_find(module_file, out, size);
}

/* Version 5 and 7.3 begin with 116 bytes of text that say so, and a version and the mark "IM" or
 * "MI" at byte 124. */
static bool recognise(const char *file, const unsigned char *head, size_t length)
{
  bool marked =
      length >= 128 && (memcmp(head + 126, "IM", 2) == 0 || memcmp(head + 126, "MI", 2) == 0);
  return (marked && memcmp(head, "MATLAB ", 7) == 0) || dea_path_ends_with(file, ".mat");
}

static uint32_t integer(const unsigned char *at, bool big)
{
  uint32_t value = 0;
  for (size_t i = 0; i < 4; i++) {
    value = value << 8 | at[big ? i : 3 - i];
  }
  return value;
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
      bool longer = good && length > size - at - TAG_SIZE;
      return dea_fail(ctx, DEA_E_IO, "'%s' is cut off or damaged: the variable at byte %llu %s",
                      file, (unsigned long long)at, longer ? "is longer than the file" : "is none");
    }
    at += TAG_SIZE + length;
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
  dea_status status;
  size_t n = fread(head, 1, HEADER_SIZE, stream);
  bool big = n == HEADER_SIZE && memcmp(head + 126, "MI", 2) == 0;
  bool marked = big || (n == HEADER_SIZE && memcmp(head + 126, "IM", 2) == 0);
  unsigned version = marked ? head[big ? 124 : 125] * 256U + head[big ? 125 : 124] : 0;
  if (version == VERSION_5) {
    status = check_variables(ctx, file, stream, big);
  } else if (version == VERSION_73) {
    status = check_new(ctx, file);
  } else { // libmatio would take it for version 4, whatever its mark
    status =
        dea_fail(ctx, DEA_E_IO,
                 "'%s' is no .mat file of version 5 or 7.3; save it with '-v7' in MATLAB", file);
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
  const void *type = NULL;
  DEA_TRY(ctx, check_file(ctx, file));
  DEA_TRY(ctx, dea_module_open(ctx, module_file, "dea_matio_module", "what reads .mat files",
                               "it is built when libmatio-dev is installed", &type));
  DEA_TRY(ctx, ((const struct dea_mat_type *)type)->read(ctx, file, out));
  return find_units(ctx, out);
}

const struct dea_importer dea_import_mat = {
    .name = "mat",
    .formats = "MATLAB's .mat files",
    .recognise = recognise,
    .read_file = read_mat,
};
