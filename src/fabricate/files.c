#include "fabricate/files.h"

#include "fabricate/dxf.h"
#include "fabricate/svg.h"
#include "output/file.h"

#include <stdio.h>

enum { NAME_SIZE = 64 };

/* Formats of a sheet. */
static const struct {
  const char *ending;
  dea_status (*write)(const struct dea_workshop *workshop, size_t index, struct dea_text *out);
} formats[] = {{"dxf", dea_dxf_write}, {"svg", dea_svg_write}};
enum { FORMATS = sizeof formats / sizeof formats[0] };

dea_status dea_workshop_files(const struct dea_workshop *workshop,
                              const struct dea_workshop_options *options, dea_file_sink sink,
                              void *user)
{
  char name[NAME_SIZE];
  for (size_t i = 0; i < workshop->count && !options->drawing_only; i++) {
    for (size_t f = 0; f < FORMATS; f++) {
      snprintf(name, sizeof name, "%s.%s", workshop->part[i].name, formats[f].ending);
      dea_status status = sink(user, name);
      if (status != DEA_OK) {
        return status;
      }
    }
  }
  return DEA_OK;
}

struct place {
  struct dea_context *ctx;
  const char *directory;
};

static dea_status refuse_existing(void *user, const char *name)
{
  const struct place *place = user;
  char *path = dea_path_join(place->ctx, place->directory, name);
  if (path == NULL) {
    return DEA_E_MEMORY;
  }
  bool there = dea_path_exists(path);
  dea_free(place->ctx, path);
  return !there ? DEA_OK
                : dea_fail(place->ctx, DEA_E_IO,
                           "%s/%s is there already; choose another folder with -o, or replace "
                           "what is there with --force",
                           place->directory, name);
}

dea_status dea_workshop_prepare(struct dea_context *ctx, const struct dea_workshop *workshop,
                                const char *directory, const struct dea_workshop_options *options)
{
  struct place place = {ctx, directory};
  if (!options->force) {
    DEA_TRY(ctx, dea_workshop_files(workshop, options, refuse_existing, &place));
  }
  return dea_folder_make(ctx, directory);
}

static dea_status write_sheet(struct dea_context *ctx, const struct dea_workshop *workshop,
                              const char *directory, size_t index, size_t format)
{
  char name[NAME_SIZE];
  struct dea_text text = {.ctx = ctx};
  snprintf(name, sizeof name, "%s.%s", workshop->part[index].name, formats[format].ending);
  void *locale = dea_c_locale_enter();
  dea_status status = formats[format].write(workshop, index, &text);
  dea_c_locale_leave(locale);
  if (status == DEA_OK) {
    status = dea_text_write(ctx, &text, directory, name);
  }
  dea_text_free(&text);
  return status;
}

dea_status dea_workshop_write(struct dea_context *ctx, const struct dea_workshop *workshop,
                              const char *directory, const struct dea_workshop_options *options)
{
  for (size_t i = 0; i < workshop->count && !options->drawing_only; i++) {
    for (size_t f = 0; f < FORMATS; f++) {
      DEA_TRY(ctx, write_sheet(ctx, workshop, directory, i, f));
    }
  }
  return DEA_OK;
}
