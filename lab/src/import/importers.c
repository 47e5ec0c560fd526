/* The list of formats: what a file is, and reading it. */
#define _POSIX_C_SOURCE 200809L // stat
#include "import/import.h"

#include "base/file.h"
#include "base/text.h"
#include "table/csv_text.h"
#include "table/text_file.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

static bool is_text(const char *file, const unsigned char *head, size_t length)
{
  (void)file;
  return dea_text_file_is(head, length);
}

static const struct dea_importer dea_import_csv = {
    .name = "csv",
    .formats = "CSV and other text with lines of numbers",
    .recognise = is_text,
    .read_text = dea_table_read_text,
};

/* The first that recognises a file reads it. */
extern const struct dea_importer dea_import_tdms, dea_import_lvm, dea_import_mat, dea_import_trios,
    dea_import_comsol, dea_import_tektronix, dea_import_rigol;
static const struct dea_importer *const all[] = {
    &dea_import_tdms,   &dea_import_lvm,       &dea_import_mat,   &dea_import_trios,
    &dea_import_comsol, &dea_import_tektronix, &dea_import_rigol, &dea_import_csv};
enum { IMPORTERS = sizeof all / sizeof all[0] };

enum { HEAD_SIZE = 4096 };
// bytes of a file; it is read whole, and its numbers take about as much again
static const size_t size_max = (size_t)4 << 30;

const struct dea_importer *const *dea_importer_all(size_t *count)
{
  *count = IMPORTERS;
  return all;
}

static dea_status find_format(struct dea_context *ctx, const char *format,
                              const struct dea_importer **out)
{
  const char *names[IMPORTERS];
  for (size_t i = 0; i < IMPORTERS; i++) {
    if (strcmp(all[i]->name, format) == 0) {
      *out = all[i];
      return DEA_OK;
    }
    names[i] = all[i]->name;
  }
  char hint[DEA_HINT_SIZE];
  dea_name_hint_list(format, names, IMPORTERS, NULL, "; known are ", hint);
  return dea_fail(ctx, DEA_E_USAGE, "'%.60s' is not a format%s", format, hint);
}

static const struct dea_importer *recognise(const char *file, const unsigned char *head,
                                            size_t length)
{
  const size_t mark = length >= 3 && memcmp(head, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
  head += mark;
  length -= mark;
  for (size_t i = 0; i < IMPORTERS; i++) {
    if (all[i]->recognise(file, head, length)) {
      return all[i];
    }
  }
  return NULL;
}

/* The first bytes of a file, which its reader opens again. */
static dea_status read_head(struct dea_context *ctx, const char *file,
                            unsigned char head[HEAD_SIZE], size_t *length)
{
  struct stat info; // opening a pipe that nobody writes to would hang
  if (stat(file, &info) == 0 && !S_ISREG(info.st_mode)) {
    return dea_fail(ctx, DEA_E_IO, "'%s' is %s, not a file", file,
                    S_ISDIR(info.st_mode) ? "a folder" : "a pipe or a device");
  }
  if (!dea_file_head(file, head, HEAD_SIZE, length)) {
    return dea_fail(ctx, DEA_E_IO, "cannot open '%s': %s", file, strerror(errno));
  }
  return *length > 0 ? DEA_OK : dea_fail(ctx, DEA_E_IO, "'%s' is empty", file);
}

static dea_status unknown_format(struct dea_context *ctx, const char *file,
                                 const unsigned char *head, size_t length)
{
  const char *advice = "export it as CSV, .mat, .lvm or .tdms";
  if (dea_path_ends_with(file, ".xlsx") || dea_path_ends_with(file, ".xls")) {
    advice = "save the sheet as CSV in Excel";
  } else if (dea_path_ends_with(file, ".tdms_index")) {
    advice = "give the .tdms file beside it";
  } else if (dea_head_is_h5(head, length)) {
    advice =
        "a recording of dea is read by 'dea reduce' as it is, another HDF5 file is exported as "
        "CSV or .mat";
  }
  return dea_fail(ctx, DEA_E_IO, "'%s' is of no format that is known; %s", file, advice);
}

dea_status dea_importer_read(struct dea_context *ctx, const struct dea_importer *importer,
                             const char *file, const unsigned char *bytes, size_t length,
                             struct dea_table *out)
{
  if (importer->read_file != NULL) {
    return importer->read_file(ctx, file, out);
  }
  return importer->read_text != NULL
             ? dea_text_file_read(ctx, bytes, length, importer->read_text, out)
             : importer->read_bytes(ctx, file, bytes, length, out);
}

/* out: filled also after a failure. */
static dea_status read_table(struct dea_context *ctx, const char *file,
                             const struct dea_importer *importer, struct dea_table *out)
{
  char *bytes = NULL;
  size_t length = 0;
  dea_status status =
      importer->read_file == NULL ? dea_file_read(ctx, file, size_max, &bytes, &length) : DEA_OK;
  if (status == DEA_OK) {
    status = dea_importer_read(ctx, importer, file, (const unsigned char *)bytes, length, out);
  } else if (status == DEA_E_DESIGN) {
    status = dea_fail(ctx, DEA_E_IO, "'%s' is larger than 4 GB; split it", file);
  }
  dea_free(ctx, bytes);
  return status;
}

dea_status dea_table_read(struct dea_context *ctx, const char *file, const char *format,
                          struct dea_table **out)
{
  unsigned char head[HEAD_SIZE];
  size_t length = 0;
  const struct dea_importer *importer = NULL;
  *out = NULL;
  DEA_TRY(ctx, format != NULL ? find_format(ctx, format, &importer) : DEA_OK);
  DEA_TRY(ctx, read_head(ctx, file, head, &length));
  if (importer == NULL) {
    importer = recognise(file, head, length);
  }
  if (importer == NULL) {
    return unknown_format(ctx, file, head, length);
  }
  struct dea_table *table = dea_alloc(ctx, 1, sizeof *table);
  DEA_TRY_MEMORY(table != NULL);
  table->file = dea_intern(ctx, file);
  table->format = importer->name;
  dea_status status = table->file != NULL ? read_table(ctx, file, importer, table) : DEA_E_MEMORY;
  if (status == DEA_OK && table->column_count == 0) {
    status = dea_fail(ctx, DEA_E_IO, "'%s' holds no column of numbers", file);
  }
  if (status != DEA_OK) {
    dea_table_destroy(ctx, table);
    const struct dea_importer *own = recognise(file, head, length);
    if (own != NULL && own != importer) {
      (void)dea_finding_add(
          ctx, DEA_NOTE, (struct dea_location){.file = dea_intern(ctx, file)},
          "the file looks like format '%s', and is read as that where none is given", own->name);
    }
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = table;
  return DEA_OK;
}
