#include "fabricate/files.h"

#include "base/write_file.h"
#include "fabricate/cairo_canvas.h"
#include "fabricate/dxf_write.h"
#include "fabricate/pages.h"
#include "fabricate/picture.h"
#include "fabricate/process.h"
#include "fabricate/svg.h"

#include <stdio.h>
#include <string.h>

/* A file: its text, or how a canvas draws it. */
struct file {
  const char *name; // of a sheet what follows the name of its part
  dea_status (*text)(const struct dea_workshop *workshop, size_t index, struct dea_text *out);
  enum dea_canvas_format format;
  dea_status (*size)(const struct dea_workshop *workshop, double out_mm[2]);
  dea_status (*draw)(const struct dea_paper *paper, const struct dea_workshop *workshop);
};

/* The shapes of the layout. */
static dea_status layout_text(const struct dea_workshop *workshop, size_t index,
                              struct dea_text *out)
{
  (void)index;
  return dea_dxf_write_layout(workshop->plan.layout, out);
}

static dea_status process_text(const struct dea_workshop *workshop, size_t index,
                               struct dea_text *out);

// those that a part has, and those of all parts
static const struct file sheets[] = {{".dxf", .text = dea_dxf_write},
                                     {".svg", .text = dea_svg_write}};
static const struct file files[] = {
    {"layout.dxf", .text = layout_text},
    {"drawing.svg", NULL, DEA_CANVAS_SVG, dea_picture_size, dea_picture_draw},
    {"drawing.pdf", NULL, DEA_CANVAS_PDF, dea_picture_size, dea_picture_draw},
    {"drawing.png", NULL, DEA_CANVAS_PNG, dea_picture_size, dea_picture_draw},
    {"parts.pdf", NULL, DEA_CANVAS_PDF, dea_pages_first_size, dea_pages_draw},
    {"process.html", .text = process_text},
};
enum {
  SHEETS = sizeof sheets / sizeof sheets[0],
  FILES = sizeof files / sizeof files[0],
  FIRST_DRAWING = 1,
  AFTER_DRAWINGS = 4
};

/* The i-th file of the folder, part number *index of which it is one, and its name; NULL beyond the
 * last. */
static const struct file *find(const struct dea_workshop *workshop,
                               const struct dea_workshop_options *options, size_t i, size_t *index,
                               char name[DEA_WORKSHOP_NAME_SIZE])
{
  const size_t all = options->drawing_only ? 0 : SHEETS * workshop->count;
  const size_t rest = i - all + (options->drawing_only ? FIRST_DRAWING : 0);
  *index = i / SHEETS;
  if (i < all) {
    snprintf(name, DEA_WORKSHOP_NAME_SIZE, "%s%s", workshop->part[*index].name,
             sheets[i % SHEETS].name);
    return &sheets[i % SHEETS];
  }
  if (rest >= (options->drawing_only ? AFTER_DRAWINGS : FILES)) {
    return NULL;
  }
  snprintf(name, DEA_WORKSHOP_NAME_SIZE, "%s", files[rest].name);
  return &files[rest];
}

bool dea_workshop_file(const struct dea_workshop *workshop,
                       const struct dea_workshop_options *options, size_t i,
                       char out[DEA_WORKSHOP_NAME_SIZE])
{
  size_t index;
  return find(workshop, options, i, &index, out) != NULL;
}

dea_status dea_workshop_prepare(struct dea_context *ctx, const struct dea_workshop *workshop,
                                const char *directory, const struct dea_workshop_options *options)
{
  char name[DEA_WORKSHOP_NAME_SIZE];
  for (size_t i = 0; !options->force && dea_workshop_file(workshop, options, i, name); i++) {
    DEA_TRY(ctx, dea_path_refuse(ctx, directory, name));
  }
  return dea_folder_create(ctx, directory);
}

/* Draws a page or pages and gives the file; paper->canvas: to be destroyed where not NULL, also
 * after a failure. */
static dea_status draw(struct dea_context *ctx, const struct dea_workshop *workshop,
                       const struct file *file, struct dea_paper *paper, const char **bytes,
                       size_t *length)
{
  const char *title = workshop->plan.design->title.text;
  double size[2];
  DEA_TRY(ctx, dea_canvas_open(ctx, &paper->type));
  DEA_TRY(ctx, file->size(workshop, size));
  DEA_TRY(ctx, paper->type->create(ctx, file->format, size[0], size[1],
                                   title[0] != '\0' ? title : "Actuator", &paper->canvas));
  DEA_TRY(ctx, file->draw(paper, workshop));
  return paper->type->finish(paper->canvas, bytes, length);
}

static void end_drawing(const struct dea_paper *paper)
{
  if (paper->canvas != NULL) {
    paper->type->destroy(paper->canvas);
  }
}

/* With the drawing of the actuator in it. */
static dea_status process_text(const struct dea_workshop *workshop, size_t index,
                               struct dea_text *out)
{
  struct dea_paper paper = {NULL, NULL};
  struct dea_text svg = {.ctx = out->ctx};
  const char *bytes;
  size_t length;
  (void)index;
  dea_status status = draw(out->ctx, workshop, &files[FIRST_DRAWING], &paper, &bytes, &length);
  if (status == DEA_OK) {
    dea_text_add(&svg, "%.*s", (int)length, bytes);
    const char *drawing = strstr(dea_text_get(&svg), "<svg"); // without the XML declaration
    status = svg.failed ? DEA_E_MEMORY : dea_process_write(out->ctx, workshop, drawing, out);
  }
  end_drawing(&paper);
  dea_text_free(&svg);
  return status;
}

static dea_status write_text(struct dea_context *ctx, const struct dea_workshop *workshop,
                             const char *directory, const struct file *file, size_t index,
                             const char *name)
{
  struct dea_text text = {.ctx = ctx};
  void *locale = dea_c_locale_enter();
  dea_status status = file->text(workshop, index, &text);
  dea_c_locale_leave(locale);
  status = status == DEA_OK ? dea_text_write(ctx, &text, directory, name) : status;
  dea_text_free(&text);
  return status;
}

static dea_status write_drawing(struct dea_context *ctx, const struct dea_workshop *workshop,
                                const char *directory, const struct file *file)
{
  struct dea_paper paper = {NULL, NULL};
  const char *bytes;
  size_t length;
  dea_status status = draw(ctx, workshop, file, &paper, &bytes, &length);
  if (status == DEA_OK) {
    status = dea_file_write_into(ctx, directory, file->name, bytes, length);
  }
  end_drawing(&paper);
  return status;
}

dea_status dea_workshop_write(struct dea_context *ctx, const struct dea_workshop *workshop,
                              const char *directory, const struct dea_workshop_options *options)
{
  char name[DEA_WORKSHOP_NAME_SIZE];
  const struct file *file;
  size_t index;
  for (size_t i = 0; (file = find(workshop, options, i, &index, name)) != NULL; i++) {
    DEA_TRY(ctx, file->text != NULL ? write_text(ctx, workshop, directory, file, index, name)
                                    : write_drawing(ctx, workshop, directory, file));
  }
  return DEA_OK;
}
