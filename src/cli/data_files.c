#define _POSIX_C_SOURCE 200809L // stat
#include "cli/data_files.h"

#include "base/text.h"

#include <glob.h>
#include <string.h>
#include <sys/stat.h>

static bool is_regular(const char *path)
{
  struct stat info;
  return stat(path, &info) == 0 && S_ISREG(info.st_mode);
}

static bool ends_in(const char *text, const char *outcome)
{
  size_t n = strlen(text), m = strlen(outcome);
  return n >= m && strcmp(text + n - m, outcome) == 0;
}

/* Adds what is in `folder` to *found; the folder's own name is taken literally. */
static dea_status glob_folder(struct dea_context *ctx, const char *folder, const char *pattern,
                              int flags, glob_t *found)
{
  struct dea_text text = {.ctx = ctx};
  for (const char *p = folder; *p != '\0'; p++) {
    dea_text_add(&text, "%s%c", strchr("*?[\\", *p) != NULL ? "\\" : "", *p);
  }
  dea_text_add(&text, "%s", pattern);
  int code = text.failed ? GLOB_NOSPACE : glob(dea_text_get(&text), flags, NULL, found);
  dea_text_free(&text);
  return code == GLOB_NOSPACE ? dea_fail(ctx, DEA_E_MEMORY, "out of memory") : DEA_OK;
}

static dea_status read_files(struct dea_context *ctx, const char *folder, const char *outcome,
                             const glob_t *found, struct cli_data_list *list)
{
  list->folder = dea_copy_text(ctx, folder, strlen(folder));
  list->files = dea_alloc(ctx, found->gl_pathc, sizeof *list->files);
  DEA_TRY_MEMORY(list->folder != NULL && list->files != NULL);
  for (size_t i = 0; i < found->gl_pathc; i++) {
    const char *path = found->gl_pathv[i];
    if (!ends_in(path, outcome) || !is_regular(path)) {
      continue;
    }
    struct cli_data_file *file = &list->files[list->count];
    const char *name = path + strlen(folder) + 1;
    file->path = dea_copy_text(ctx, path, strlen(path));
    file->name = dea_copy_text(ctx, name, strlen(name));
    list->count++;
    DEA_TRY_MEMORY(file->path != NULL && file->name != NULL);
  }
  return DEA_OK;
}

static dea_status find_in(struct dea_context *ctx, const char *folder, const char *outcome,
                          struct cli_data_list *list)
{
  glob_t found = {.gl_pathc = 0};
  dea_status status = glob_folder(ctx, folder, "/*", 0, &found);
  static const char *const deeper[] = {"/*/*", "/*/*/*"}; // fit/silicone/uniaxial.csv
  for (size_t i = 0; i < sizeof deeper / sizeof deeper[0] && status == DEA_OK; i++) {
    status = glob_folder(ctx, folder, deeper[i], GLOB_APPEND, &found);
  }
  status = status == DEA_OK ? read_files(ctx, folder, outcome, &found, list) : status;
  globfree(&found);
  return status;
}

dea_status cli_examples_find(struct dea_context *ctx, const char *outcome,
                             struct cli_data_list *list)
{
  static const char *const places[] = {DEA_INSTALL_DATA_DIR "/examples",
                                       DEA_SOURCE_DIR "/examples"};
  *list = (struct cli_data_list){.count = 0};
  for (size_t i = 0; i < 2 && list->count == 0; i++) {
    cli_data_free(ctx, list);
    DEA_TRY(ctx, find_in(ctx, places[i], outcome, list));
  }
  return DEA_OK;
}

void cli_data_free(struct dea_context *ctx, struct cli_data_list *list)
{
  for (size_t i = 0; i < list->count; i++) {
    dea_free(ctx, list->files[i].path);
    dea_free(ctx, list->files[i].name);
  }
  dea_free(ctx, list->files);
  dea_free(ctx, list->folder);
  *list = (struct cli_data_list){.count = 0};
}

size_t cli_data_stem(const char *name)
{
  const char *dot = strrchr(name, '.');
  return dot != NULL ? (size_t)(dot - name) : strlen(name);
}
