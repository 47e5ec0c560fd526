/* A canvas by cairo: the whole of the loadable module that fabricate/cairo_canvas.c opens. */
#include "base/module.h"
#include "fabricate/cairo_canvas.h"

#include "base/text.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <math.h>
#include <string.h>

static const double point_mm = 25.4 / 72;
static const double dots_per_mm = 300 / 25.4;

struct dea_canvas {
  struct dea_context *ctx;
  enum dea_canvas_format format;
  cairo_surface_t *surface;
  cairo_t *cr;
  struct dea_text bytes;
};

static cairo_status_t append_bytes(void *user, const unsigned char *data, unsigned length)
{
  struct dea_text *bytes = user;
  dea_text_add_bytes(bytes, data, length);
  return bytes->failed ? CAIRO_STATUS_WRITE_ERROR : CAIRO_STATUS_SUCCESS;
}

enum { WORDS_SIZE = 1024 };

/* Words as cairo takes them: it stops at what is not UTF-8, such as a name of a file in another
 * encoding or one that was cut inside of a letter. What is too long ends early. */
static void clean_text(const char *words, char out[WORDS_SIZE])
{
  size_t n = 0;
  while (*words != '\0' && n + 4 < WORDS_SIZE) {
    unsigned code;
    const size_t length = dea_letter_read(words, &code);
    const bool good = length > 0 && code != 0xfffe && code != 0xffff; // which XML forbids
    const char *letter = !good ? "\xef\xbf\xbd" : dea_letter_is_control(code) ? " " : words;
    const size_t size = letter == words ? length : strlen(letter);
    memcpy(out + n, letter, size);
    n += size;
    words += good ? length : 1;
  }
  out[n] = '\0';
}

/* mm from the lower left corner, y upwards. */
static void set_frame(struct dea_canvas *canvas, double height_mm)
{
  double scale = canvas->format == DEA_CANVAS_PNG ? dots_per_mm : 1 / point_mm;
  cairo_identity_matrix(canvas->cr);
  cairo_scale(canvas->cr, scale, -scale);
  cairo_translate(canvas->cr, 0, -height_mm);
  cairo_set_line_cap(canvas->cr, CAIRO_LINE_CAP_ROUND);
  cairo_set_line_join(canvas->cr, CAIRO_LINE_JOIN_ROUND);
  cairo_set_fill_rule(canvas->cr, CAIRO_FILL_RULE_EVEN_ODD);
}

static cairo_surface_t *build_surface(struct dea_canvas *canvas, double width_mm, double height_mm,
                                      const char *title)
{
  cairo_surface_t *surface;
  char good[WORDS_SIZE];
  clean_text(title, good);
  switch (canvas->format) {
  case DEA_CANVAS_PDF:
    surface = cairo_pdf_surface_create_for_stream(append_bytes, &canvas->bytes, width_mm / point_mm,
                                                  height_mm / point_mm);
    if (cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS) {
      cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_TITLE, good);
      cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATOR, "libdea");
      // without the time of day the same design gives the same bytes
      cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, "");
    }
    return surface;
  case DEA_CANVAS_SVG:
    surface = cairo_svg_surface_create_for_stream(append_bytes, &canvas->bytes, width_mm / point_mm,
                                                  height_mm / point_mm);
    return surface;
  case DEA_CANVAS_PNG:
    break;
  }
  return cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)ceil(width_mm * dots_per_mm),
                                    (int)ceil(height_mm * dots_per_mm));
}

static void destroy(struct dea_canvas *canvas)
{
  if (canvas != NULL) {
    cairo_destroy(canvas->cr);
    cairo_surface_destroy(canvas->surface);
    dea_text_free(&canvas->bytes);
    dea_free(canvas->ctx, canvas);
  }
}

static dea_status failure(struct dea_canvas *canvas, cairo_status_t status)
{
  return canvas->bytes.failed || status == CAIRO_STATUS_NO_MEMORY
             ? dea_fail(canvas->ctx, DEA_E_MEMORY, "out of memory while drawing")
             : dea_fail(canvas->ctx, DEA_E_TOOL, "cairo cannot draw: %s",
                        cairo_status_to_string(status));
}

static dea_status create(struct dea_context *ctx, enum dea_canvas_format format, double width_mm,
                         double height_mm, const char *title, struct dea_canvas **out)
{
  struct dea_canvas *canvas = dea_alloc(ctx, 1, sizeof *canvas);
  *out = NULL;
  DEA_TRY_MEMORY(canvas != NULL);
  *canvas = (struct dea_canvas){.ctx = ctx, .format = format, .bytes = {.ctx = ctx}};
  canvas->surface = build_surface(canvas, width_mm, height_mm, title);
  canvas->cr = cairo_create(canvas->surface);
  cairo_status_t status = cairo_status(canvas->cr);
  if (status != CAIRO_STATUS_SUCCESS) {
    dea_status failed = failure(canvas, status);
    destroy(canvas);
    return failed;
  }
  set_frame(canvas, height_mm);
  if (format != DEA_CANVAS_PDF) {
    cairo_set_source_rgb(canvas->cr, 1, 1, 1);
    cairo_paint(canvas->cr);
  }
  *out = canvas;
  return DEA_OK;
}

static void page(struct dea_canvas *canvas, double width_mm, double height_mm)
{
  cairo_show_page(canvas->cr);
  cairo_pdf_surface_set_size(canvas->surface, width_mm / point_mm, height_mm / point_mm);
  set_frame(canvas, height_mm);
}

static void contour(struct dea_canvas *canvas, const struct dea_contour *c, double scale,
                    double x_mm, double y_mm)
{
  size_t pieces = dea_contour_pieces(c);
  cairo_new_sub_path(canvas->cr);
  for (size_t i = 0; i < pieces; i++) {
    const struct dea_piece p = dea_contour_piece(c, i);
    if (i == 0) {
      cairo_move_to(canvas->cr, x_mm + scale * p.from[0], y_mm + scale * p.from[1]);
    }
    if (p.arc) {
      double x = x_mm + scale * p.centre[0], y = y_mm + scale * p.centre[1];
      (p.sweep > 0 ? cairo_arc : cairo_arc_negative)(canvas->cr, x, y, scale * p.radius_m, p.start,
                                                     p.start + p.sweep);
    } else {
      cairo_line_to(canvas->cr, x_mm + scale * p.to[0], y_mm + scale * p.to[1]);
    }
  }
  if (c->closed) {
    cairo_close_path(canvas->cr);
  }
}

static void line(struct dea_canvas *canvas, double x0, double y0, double x1, double y1)
{
  cairo_move_to(canvas->cr, x0, y0);
  cairo_line_to(canvas->cr, x1, y1);
}

static void box(struct dea_canvas *canvas, double x, double y, double width, double height)
{
  cairo_rectangle(canvas->cr, x, y, width, height);
}

static void set_colour(struct dea_canvas *canvas, unsigned colour, double opacity)
{
  cairo_set_source_rgba(canvas->cr, (colour >> 16 & 255) / 255.0, (colour >> 8 & 255) / 255.0,
                        (colour & 255) / 255.0, opacity);
}

static void fill(struct dea_canvas *canvas, unsigned colour, double opacity, bool keep)
{
  set_colour(canvas, colour, opacity);
  cairo_fill_preserve(canvas->cr);
  if (!keep) {
    cairo_new_path(canvas->cr);
  }
}

static void stroke(struct dea_canvas *canvas, double width_mm, unsigned colour, double dash_mm)
{
  const double dashes[2] = {dash_mm, dash_mm};
  set_colour(canvas, colour, 1);
  cairo_set_line_width(canvas->cr, width_mm);
  cairo_set_dash(canvas->cr, dashes, dash_mm > 0 ? 2 : 0, 0);
  cairo_stroke(canvas->cr);
}

static void clip(struct dea_canvas *canvas)
{
  cairo_save(canvas->cr);
  cairo_clip(canvas->cr);
}

static void unclip(struct dea_canvas *canvas)
{
  cairo_restore(canvas->cr);
}

static void choose_font(struct dea_canvas *canvas, double size_mm, bool bold)
{
  cairo_select_font_face(canvas->cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(canvas->cr, size_mm);
}

static double text_width(struct dea_canvas *canvas, double size_mm, bool bold, const char *text)
{
  cairo_text_extents_t extents;
  char good[WORDS_SIZE];
  clean_text(text, good);
  choose_font(canvas, size_mm, bold);
  cairo_text_extents(canvas->cr, good, &extents);
  return extents.x_advance;
}

static void text(struct dea_canvas *canvas, double x_mm, double y_mm, double size_mm,
                 enum dea_align align, bool bold, unsigned colour, const char *words)
{
  char good[WORDS_SIZE];
  clean_text(words, good);
  double width = align == DEA_ALIGN_LEFT ? 0 : text_width(canvas, size_mm, bold, words);
  cairo_save(canvas->cr);
  cairo_translate(canvas->cr, x_mm, y_mm);
  cairo_scale(canvas->cr, 1, -1);
  choose_font(canvas, size_mm, bold);
  set_colour(canvas, colour, 1);
  cairo_move_to(canvas->cr, align == DEA_ALIGN_RIGHT ? -width : -0.5 * width, 0);
  cairo_show_text(canvas->cr, good);
  cairo_restore(canvas->cr);
  cairo_new_path(canvas->cr);
}

static dea_status finish(struct dea_canvas *canvas, const char **bytes, size_t *length)
{
  cairo_status_t status = cairo_status(canvas->cr);
  if (status == CAIRO_STATUS_SUCCESS && canvas->format == DEA_CANVAS_PNG) {
    status = cairo_surface_write_to_png_stream(canvas->surface, append_bytes, &canvas->bytes);
  }
  if (status == CAIRO_STATUS_SUCCESS) {
    cairo_surface_finish(canvas->surface);
    status = cairo_surface_status(canvas->surface);
  }
  if (status != CAIRO_STATUS_SUCCESS || canvas->bytes.failed) {
    return failure(canvas, status);
  }
  *bytes = canvas->bytes.data;
  *length = canvas->bytes.length;
  return DEA_OK;
}

extern DEA_MODULE_SYMBOL const struct dea_canvas_type dea_cairo_module;
const struct dea_canvas_type dea_cairo_module = {
    .create = create,
    .page = page,
    .contour = contour,
    .line = line,
    .box = box,
    .fill = fill,
    .stroke = stroke,
    .clip = clip,
    .unclip = unclip,
    .text = text,
    .text_width = text_width,
    .finish = finish,
    .destroy = destroy,
};
