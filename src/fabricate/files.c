#define _POSIX_C_SOURCE 200809L // unlink
#include "fabricate/files.h"

#include "base/file.h"
#include "base/write_file.h"
#include "fabricate/cairo_canvas.h"
#include "fabricate/dxf.h"
#include "fabricate/pages.h"
#include "fabricate/picture.h"
#include "fabricate/process.h"
#include "fabricate/svg.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { NAME_SIZE = 64 };

/* Formats of a sheet. */
static const struct {
  const char *outcome;
  dea_status (*write)(const struct dea_workshop *workshop, size_t index, struct dea_text *out);
} formats[] = {{"dxf", dea_dxf_write}, {"svg", dea_svg_write}};
enum { FORMATS = sizeof formats / sizeof formats[0] };

/* Drawings by a canvas. */
struct drawing {
  const char *name;
  enum dea_canvas_format format;
  bool always; // with drawing_only too
  void (*size)(const struct dea_workshop *workshop, double out_mm[2]);
  void (*draw)(const struct dea_paper *paper, const struct dea_workshop *workshop);
};

/* The process sheet. */
#define PROCESS_HTML "process.html"

static const struct drawing drawings[] = {
    {"drawing.svg", DEA_CANVAS_SVG, true, dea_picture_size, dea_picture_draw},
    {"drawing.pdf", DEA_CANVAS_PDF, true, dea_picture_size, dea_picture_draw},
    {"drawing.png", DEA_CANVAS_PNG, true, dea_picture_size, dea_picture_draw},
    {"parts.pdf", DEA_CANVAS_PDF, false, dea_pages_first_size, dea_pages_draw},
};
enum { DRAWINGS = sizeof drawings / sizeof drawings[0] };

// its shapes
#define LAYOUT_DXF "layout.dxf"

dea_status dea_workshop_files(const struct dea_workshop *workshop,
                              const struct dea_workshop_options *options, dea_file_sink sink,
                              void *user)
{
  char name[NAME_SIZE];
  dea_status status = DEA_OK;
  for (size_t i = 0; i < workshop->count && !options->drawing_only; i++) {
    for (size_t f = 0; f < FORMATS && status == DEA_OK; f++) {
      snprintf(name, sizeof name, "%s.%s", workshop->part[i].name, formats[f].outcome);
      status = sink(user, name);
    }
  }
  status = status == DEA_OK && !options->drawing_only ? sink(user, LAYOUT_DXF) : status;
  for (size_t i = 0; i < DRAWINGS && status == DEA_OK; i++) {
    if (drawings[i].always || !options->drawing_only) {
      status = sink(user, drawings[i].name);
    }
  }
  return status == DEA_OK && !options->drawing_only ? sink(user, PROCESS_HTML) : status;
}

struct location {
  struct dea_context *ctx;
  const char *directory;
};

static dea_status refuse_existing(void *user, const char *name)
{
  const struct location *location = user;
  return dea_path_refuse(location->ctx, location->directory, name);
}

/* Whether a file's name is that of a sheet of this workshop, or of any: stem its length without the
 * ending. */
static bool is_sheet(const struct dea_workshop *workshop, const char *name, size_t stem)
{
  bool found = stem == strlen(LAYOUT_DXF) - 4 && strncmp(name, LAYOUT_DXF, stem) == 0;
  for (size_t i = 0; i < workshop->count; i++) {
    const char *own = workshop->part[i].name;
    found = found || (strlen(own) == stem && strncmp(own, name, stem) == 0);
  }
  return found;
}

static bool may_be_sheet(const char *name)
{
  static const char *const starts[] = {"film.",    "frame.", "template.", "fibres.", "layout.",
                                       "stencil-", "blank-", "ply-",      "body-"};
  bool found = false;
  for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++) {
    found = found || strncmp(name, starts[i], strlen(starts[i])) == 0;
  }
  return found;
}

/* Removes a DXF of ours and the SVG beside it. */
static dea_status forget_sheet(struct dea_context *ctx, const char *directory, const char *dxf)
{
  static const char ours[] = "999\nlibdea ";
  char start[sizeof ours] = "";
  char *path = dea_path_join(ctx, directory, dxf);
  DEA_TRY_MEMORY(path != NULL);
  size_t length;
  dea_file_head(path, start, sizeof ours - 1, &length);
  if (strcmp(start, ours) == 0) {
    unlink(path);
    // NOLINTNEXTLINE(bugprone-not-null-terminated-result): its end stays
    memcpy(path + strlen(path) - 3, "svg", 3);
    unlink(path); // one that is not there is fine
  }
  dea_free(ctx, path);
  return DEA_OK;
}

/* Removes the sheets of parts that an older design had and this one has not: they would be taken
 * for its own. */
static dea_status forget_sheets(struct dea_context *ctx, const struct dea_workshop *workshop,
                                const char *directory)
{
  DIR *all = opendir(directory);
  dea_status status = DEA_OK;
  const struct dirent *entry = all != NULL ? readdir(all) : NULL;
  for (; entry != NULL && status == DEA_OK; entry = readdir(all)) {
    size_t length = strlen(entry->d_name), stem = length > 4 ? length - 4 : 0;
    if (strcmp(entry->d_name + stem, ".dxf") == 0 && may_be_sheet(entry->d_name) &&
        !is_sheet(workshop, entry->d_name, stem)) {
      status = forget_sheet(ctx, directory, entry->d_name);
    }
  }
  if (all != NULL) {
    closedir(all);
  }
  return status;
}

dea_status dea_workshop_prepare(struct dea_context *ctx, const struct dea_workshop *workshop,
                                const char *directory, const struct dea_workshop_options *options)
{
  struct location location = {ctx, directory};
  if (!options->force) {
    DEA_TRY(ctx, dea_workshop_files(workshop, options, refuse_existing, &location));
  }
  if (options->force && !options->drawing_only) {
    DEA_TRY(ctx, forget_sheets(ctx, workshop, directory));
  }
  return dea_folder_create(ctx, directory);
}

static dea_status write_sheet(struct dea_context *ctx, const struct dea_workshop *workshop,
                              const char *directory, size_t index, size_t format)
{
  char name[NAME_SIZE];
  struct dea_text text = {.ctx = ctx};
  snprintf(name, sizeof name, "%s.%s", workshop->part[index].name, formats[format].outcome);
  void *locale = dea_c_locale_enter();
  dea_status status = formats[format].write(workshop, index, &text);
  dea_c_locale_leave(locale);
  status = status == DEA_OK ? dea_text_write(ctx, &text, directory, name) : status;
  dea_text_free(&text);
  return status;
}

/* Draws a page or pages and gives the file; canvas: to be destroyed, NULL after a failure. */
static dea_status draw(struct dea_context *ctx, const struct dea_canvas_type *type,
                       const struct dea_workshop *workshop, const struct drawing *drawing,
                       struct dea_canvas **canvas, const char **bytes, size_t *length)
{
  const char *title = workshop->plan.design->title.text;
  double size[2];
  drawing->size(workshop, size);
  DEA_TRY(ctx, type->create(ctx, drawing->format, size[0], size[1],
                            title[0] != '\0' ? title : "Actuator", canvas));
  const struct dea_paper paper = {type, *canvas};
  drawing->draw(&paper, workshop);
  return type->finish(*canvas, bytes, length);
}

static dea_status write_drawing(struct dea_context *ctx, const struct dea_canvas_type *type,
                                const struct dea_workshop *workshop, const char *directory,
                                const struct drawing *drawing)
{
  struct dea_canvas *canvas = NULL;
  const char *bytes = NULL;
  size_t length = 0;
  dea_status status = draw(ctx, type, workshop, drawing, &canvas, &bytes, &length);
  if (status == DEA_OK) {
    status = dea_file_write_into(ctx, directory, drawing->name, bytes, length);
  }
  type->destroy(canvas);
  return status;
}

/* With the drawing of the actuator in it. */
static dea_status write_process(struct dea_context *ctx, const struct dea_canvas_type *type,
                                const struct dea_workshop *workshop, const char *directory,
                                bool sensitivity)
{
  struct dea_canvas *canvas = NULL;
  const char *bytes = NULL;
  size_t length = 0;
  struct dea_text svg = {.ctx = ctx};
  struct dea_document document = {.html = {.ctx = ctx}};
  dea_status status = draw(ctx, type, workshop, &drawings[0], &canvas, &bytes, &length);
  if (status == DEA_OK) {
    dea_text_add(&svg, "%.*s", (int)length, bytes);
    document.drawing = strstr(dea_text_get(&svg), "<svg"); // without the XML declaration
    status = svg.failed ? DEA_E_MEMORY : dea_process_write(ctx, workshop, sensitivity, &document);
  }
  if (status == DEA_OK) {
    status = dea_text_write(ctx, &document.html, directory, PROCESS_HTML);
  }
  type->destroy(canvas);
  dea_text_free(&svg);
  dea_text_free(&document.html);
  return status;
}

static dea_status write_drawings(struct dea_context *ctx, const struct dea_workshop *workshop,
                                 const char *directory, const struct dea_workshop_options *options)
{
  const struct dea_canvas_type *type = NULL;
  DEA_TRY(ctx, dea_canvas_open(ctx, &type));
  for (size_t i = 0; i < DRAWINGS; i++) {
    if (drawings[i].always || !options->drawing_only) {
      DEA_TRY(ctx, write_drawing(ctx, type, workshop, directory, &drawings[i]));
    }
  }
  return options->drawing_only
             ? DEA_OK
             : write_process(ctx, type, workshop, directory, options->sensitivity);
}

static dea_status write_layout(struct dea_context *ctx, const struct dea_workshop *workshop,
                               const char *directory)
{
  struct dea_text dxf = {.ctx = ctx};
  void *locale = dea_c_locale_enter();
  dea_status status = dea_dxf_write_layout(workshop->plan.layout, &dxf);
  dea_c_locale_leave(locale);
  status = status == DEA_OK ? dea_text_write(ctx, &dxf, directory, LAYOUT_DXF) : status;
  dea_text_free(&dxf);
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
  DEA_TRY(ctx, !options->drawing_only ? write_layout(ctx, workshop, directory) : DEA_OK);
  return write_drawings(ctx, workshop, directory, options);
}
