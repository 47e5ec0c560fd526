/* What drawings are drawn on: pages of a PDF, an SVG or a PNG. Lengths in mm from the lower left
 * corner, y upwards; colours 0xRRGGBB. */
#pragma once

#include "base/text.h"
#include "geometry/contour.h"

enum dea_canvas_format { DEA_CANVAS_PDF, DEA_CANVAS_SVG, DEA_CANVAS_PNG };
enum dea_align { DEA_ALIGN_LEFT, DEA_ALIGN_CENTRE, DEA_ALIGN_RIGHT };

struct dea_canvas;

struct dea_canvas_type {
  /* title: of the document; lent until it is destroyed. This, `page`, `finish` and `destroy` are
   * NULL of dea_canvas_svg. */
  dea_status (*create)(struct dea_context *ctx, enum dea_canvas_format format, double width_mm,
                       double height_mm, const char *title, struct dea_canvas **out);
  /* Ends a page and begins one of another size; PDF only. */
  void (*page)(struct dea_canvas *canvas, double width_mm, double height_mm);
  /* Adds to the path: a contour, its metres times `scale`, moved by x, y. */
  void (*contour)(struct dea_canvas *canvas, const struct dea_contour *contour, double scale,
                  double x_mm, double y_mm);
  void (*line)(struct dea_canvas *canvas, double x0_mm, double y0_mm, double x1_mm, double y1_mm);
  void (*box)(struct dea_canvas *canvas, double x_mm, double y_mm, double width_mm,
              double height_mm);
  /* Draws the path, and forgets it unless `keep`. dash_mm: 0 for none; holes of the path stay
   * unfilled. */
  void (*fill)(struct dea_canvas *canvas, unsigned colour, double opacity, bool keep);
  void (*stroke)(struct dea_canvas *canvas, double width_mm, unsigned colour, double dash_mm);
  /* What is drawn from here to `unclip` shows inside of the path only, which is forgotten. */
  void (*clip)(struct dea_canvas *canvas);
  void (*unclip)(struct dea_canvas *canvas);
  /* UTF-8 text; size: of the letters' em; x, y: its base line. */
  void (*text)(struct dea_canvas *canvas, double x_mm, double y_mm, double size_mm,
               enum dea_align align, bool bold, unsigned colour, const char *text);
  double (*text_width)(struct dea_canvas *canvas, double size_mm, bool bold, const char *text);
  /* The file as a whole; bytes lent until the canvas is destroyed. */
  dea_status (*finish)(struct dea_canvas *canvas, const char **bytes, size_t *length);
  void (*destroy)(struct dea_canvas *canvas);
};

/* One that adds an SVG to a text: no more than this library is needed. Letters have about the width
 * that DejaVu Sans gives them. number: of the drawing on its page, so that ids differ. canvas:
 * freed by dea_canvas_svg_end, which also ends the SVG. DEA_E_MEMORY; later want of memory marks
 * the text. */
extern const struct dea_canvas_type dea_canvas_svg;
dea_status dea_canvas_svg_begin(struct dea_text *out, int number, double width_mm, double height_mm,
                                struct dea_canvas **canvas);
void dea_canvas_svg_end(struct dea_canvas *canvas);

/* A canvas with its type, as drawings are handed it. */
struct dea_paper {
  const struct dea_canvas_type *type;
  struct dea_canvas *canvas;
};
