/* .mat files by libmatio, writing. */
#include "matio/matio_module.h"

#include <stdint.h>
#include <string.h>
#include <sys/stat.h>

/* libmatio's own messages go nowhere: it would print them, and end the program at some. */
static void be_quiet(int level, char *message)
{
  (void)level;
  (void)message;
}

void dea_matio_quiet(void)
{
  Mat_LogInitFunc("dea", be_quiet);
}

/* What a code of libmatio means, as the end of a sentence. */
static const char *reason(int error)
{
  switch (error) {
  case MATIO_E_OUT_OF_MEMORY:
    return "out of memory";
  case MATIO_E_GENERIC_WRITE_ERROR:
  case MATIO_E_OUTPUT_BAD_DATA:
  case MATIO_E_FILESYSTEM_ERROR_ON_CLOSE:
    return "is the disk full?";
  case MATIO_E_OPERATION_NOT_SUPPORTED:
    return "libmatio was built without it";
  default:
    return "libmatio failed";
  }
}

/* UTF-16 of a text, which is what MATLAB itself writes; owned by the caller (dea_free). */
static uint16_t *build_utf16(struct dea_context *ctx, const char *text, size_t *count)
{
  uint16_t *units = dea_alloc(ctx, strlen(text) + 1, sizeof *units);
  size_t n = 0;
  while (units != NULL && *text != '\0') {
    unsigned code;
    size_t length = dea_letter_read(text, &code);
    text += length > 0 ? length : 1;
    if (code >= 0x10000) {
      units[n++] = (uint16_t)(0xd800 + ((code - 0x10000) >> 10));
      units[n++] = (uint16_t)(0xdc00 + ((code - 0x10000) & 0x3ff));
    } else {
      units[n++] = (uint16_t)code;
    }
  }
  *count = n;
  return units;
}

static int write_text(struct dea_context *ctx, mat_t *mat, const char *name, const char *text)
{
  size_t dims[2] = {1, 0};
  uint16_t *units = build_utf16(ctx, text, &dims[1]);
  if (units == NULL) {
    return MATIO_E_OUT_OF_MEMORY;
  }
  dims[0] = dims[1] > 0;
  matvar_t *variable =
      Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF16, 2, dims, units, MAT_F_DONT_COPY_DATA);
  int error =
      variable != NULL ? Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE) : MATIO_E_OUT_OF_MEMORY;
  Mat_VarFree(variable);
  dea_free(ctx, units);
  return error;
}

static int write_numbers(mat_t *mat, const struct dea_mat_variable *given)
{
  size_t dims[2] = {given->count, given->count > 0};
  // libmatio takes what it only reads without const
  void *values = (void *)(uintptr_t)given->values;
  matvar_t *variable =
      Mat_VarCreate(given->name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values, MAT_F_DONT_COPY_DATA);
  int error =
      variable != NULL ? Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE) : MATIO_E_OUT_OF_MEMORY;
  Mat_VarFree(variable);
  return error;
}

/* Whether the file has at least the bytes of its numbers: not every failed write is told. */
static bool is_whole(const char *file, const struct dea_mat_variable *variables, size_t count)
{
  struct stat info;
  size_t due = 0;
  for (size_t i = 0; i < count; i++) {
    due += variables[i].text == NULL ? variables[i].count * sizeof(double) : 0;
  }
  return stat(file, &info) == 0 && (uintmax_t)info.st_size >= due;
}

dea_status dea_matio_write(struct dea_context *ctx, const char *file,
                           const struct dea_mat_variable *variables, size_t count,
                           enum dea_mat_version version)
{
  bool new = version == DEA_MAT_73;
  dea_matio_quiet();
  mat_t *mat = Mat_CreateVer(file,
                             new ? "MATLAB 7.3 MAT-file, written by libdea"
                                 : "MATLAB 5.0 MAT-file, written by libdea",
                             new ? MAT_FT_MAT73 : MAT_FT_MAT5);
  if (mat == NULL) {
    return dea_fail(ctx, DEA_E_IO, "cannot make the file %s", file);
  }
  int error = MATIO_E_NO_ERROR;
  for (size_t i = 0; i < count && error == MATIO_E_NO_ERROR; i++) {
    error = variables[i].text != NULL ? write_text(ctx, mat, variables[i].name, variables[i].text)
                                      : write_numbers(mat, &variables[i]);
  }
  int closed = Mat_Close(mat);
  error = error != MATIO_E_NO_ERROR ? error : closed;
  if (error == MATIO_E_NO_ERROR && !is_whole(file, variables, count)) {
    error = MATIO_E_GENERIC_WRITE_ERROR;
  }
  if (error != MATIO_E_NO_ERROR) {
    return dea_fail(ctx, error == MATIO_E_OUT_OF_MEMORY ? DEA_E_MEMORY : DEA_E_IO,
                    "cannot write %s: %s", file, reason(error));
  }
  return DEA_OK;
}
