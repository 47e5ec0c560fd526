#include "fabricate/files.h"

#include "base/file.h"
#include "base/write_file.h"
#include "fabricate/cairo_canvas.h"
#include "fabricate/dxf.h"
#include "fabricate/pages.h"
#include "fabricate/picture.h"
#include "fabricate/process.h"
#include "fabricate/svg.h"

#include <stdio.h>
#include <string.h>

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

dea_status dea_workshop_prepare(struct dea_context *ctx, const struct dea_workshop *workshop,
                                const char *directory, const struct dea_workshop_options *options)
{
  struct location location = {ctx, directory};
  if (!options->force) {
    DEA_TRY(ctx, dea_workshop_files(workshop, options, refuse_existing, &location));
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
                                const struct dea_workshop *workshop, const char *directory)
{
  struct dea_canvas *canvas = NULL;
  const char *bytes = NULL;
  size_t length = 0;
  struct dea_text svg = {.ctx = ctx}, html = {.ctx = ctx};
  dea_status status = draw(ctx, type, workshop, &drawings[0], &canvas, &bytes, &length);
  if (status == DEA_OK) {
    dea_text_add(&svg, "%.*s", (int)length, bytes);
    const char *drawing = strstr(dea_text_get(&svg), "<svg"); // without the XML declaration
    status = svg.failed ? DEA_E_MEMORY : dea_process_write(ctx, workshop, drawing, &html);
  }
  if (status == DEA_OK) {
    status = dea_text_write(ctx, &html, directory, PROCESS_HTML);
  }
  type->destroy(canvas);
  dea_text_free(&svg);
  dea_text_free(&html);
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
  return options->drawing_only ? DEA_OK : write_process(ctx, type, workshop, directory);
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
