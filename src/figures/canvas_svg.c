/* A canvas that writes the text of an SVG, without styles, which the page of a report forbids. */
#include "figures/canvas.h"

#include "base/html.h"
#include "base/text.h"

#include <math.h>

static const double unit = 4; // units of the drawing per mm

struct dea_canvas {
  struct dea_text *out, path;
  double height_mm;
  int number, clips;
};

static double x_of(double x_mm)
{
  return unit * x_mm;
}

static double y_of(const struct dea_canvas *canvas, double y_mm)
{
  return unit * (canvas->height_mm - y_mm);
}

dea_status dea_canvas_svg_begin(struct dea_text *out, int number, double width_mm, double height_mm,
                                struct dea_canvas **canvas)
{
  double width = unit * width_mm, height = unit * height_mm;
  *canvas = dea_alloc(out->ctx, 1, sizeof **canvas);
  DEA_TRY_MEMORY(*canvas != NULL);
  **canvas = (struct dea_canvas){
      .out = out, .path = {.ctx = out->ctx}, .height_mm = height_mm, .number = number};
  dea_text_add(
      out,
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"device\" width=\"%.0f\" height=\"%.0f\" "
      "viewBox=\"0 0 %.0f %.0f\" "
      "font-family=\"'DejaVu Sans',Helvetica,Arial,sans-serif\" stroke-linejoin=\"round\">"
      "<path d=\"M0 0h%.0fv%.0fH0z\" fill=\"#fff\"/>\n",
      width, height, width, height, width, height);
  return DEA_OK;
}

void dea_canvas_svg_end(struct dea_canvas *canvas)
{
  dea_text_add(canvas->out, "</svg>\n");
  dea_text_free(&canvas->path);
  dea_free(canvas->out->ctx, canvas);
}

static void contour(struct dea_canvas *canvas, const struct dea_contour *c, double scale,
                    double x_mm, double y_mm)
{
  struct dea_text *path = &canvas->path;
  for (size_t i = 0; i < dea_contour_pieces(c); i++) {
    const struct dea_piece p = dea_contour_piece(c, i);
    if (i == 0) {
      dea_text_add(path, "M%.2f %.2f", x_of(x_mm + scale * p.from[0]),
                   y_of(canvas, y_mm + scale * p.from[1]));
    }
    double x = x_of(x_mm + scale * p.to[0]), y = y_of(canvas, y_mm + scale * p.to[1]);
    if (p.arc) { // an SVG counts y downwards, so arcs turn the other way
      dea_text_add(path, "A%.2f %.2f 0 %d %d %.2f %.2f", unit * scale * p.radius_m,
                   unit * scale * p.radius_m, fabs(p.sweep) > 3.14159265358979, p.sweep < 0, x, y);
    } else {
      dea_text_add(path, "L%.2f %.2f", x, y);
    }
  }
  dea_text_add(path, c->closed ? "Z" : "");
}

static void line(struct dea_canvas *canvas, double x0, double y0, double x1, double y1)
{
  dea_text_add(&canvas->path, "M%.2f %.2fL%.2f %.2f", x_of(x0), y_of(canvas, y0), x_of(x1),
               y_of(canvas, y1));
}

static void box(struct dea_canvas *canvas, double x, double y, double width, double height)
{
  dea_text_add(&canvas->path, "M%.2f %.2fh%.2fv%.2fh%.2fZ", x_of(x), y_of(canvas, y), unit * width,
               -unit * height, -unit * width);
}

static void forget_path(struct dea_canvas *canvas)
{
  dea_text_free_in(&canvas->path, canvas->out);
  canvas->path = (struct dea_text){.ctx = canvas->out->ctx};
}

static void fill(struct dea_canvas *canvas, unsigned colour, double opacity, bool keep)
{
  dea_text_add(canvas->out,
               "<path d=\"%s\" fill=\"#%06x\" fill-opacity=\"%.3g\" fill-rule=\"evenodd\"/>\n",
               dea_text_get(&canvas->path), colour, opacity);
  if (!keep) {
    forget_path(canvas);
  }
}

static void stroke(struct dea_canvas *canvas, double width_mm, unsigned colour, double dash_mm)
{
  dea_text_add(canvas->out, "<path d=\"%s\" fill=\"none\" stroke=\"#%06x\" stroke-width=\"%.3g\"",
               dea_text_get(&canvas->path), colour, unit * width_mm);
  if (dash_mm > 0) {
    dea_text_add(canvas->out, " stroke-dasharray=\"%.3g\"", unit * dash_mm);
  }
  dea_text_add(canvas->out, "/>\n");
  forget_path(canvas);
}

static void clip(struct dea_canvas *canvas)
{
  int id = canvas->clips++;
  dea_text_add(canvas->out,
               "<clipPath id=\"clip-%d-%d\"><path d=\"%s\" clip-rule=\"evenodd\"/></clipPath>"
               "<g clip-path=\"url(#clip-%d-%d)\">\n",
               canvas->number, id, dea_text_get(&canvas->path), canvas->number, id);
  forget_path(canvas);
}

static void unclip(struct dea_canvas *canvas)
{
  dea_text_add(canvas->out, "</g>\n");
}

static double text_width(struct dea_canvas *canvas, double size_mm, bool bold, const char *text)
{
  (void)canvas;
  size_t letters = 0;
  for (; *text != '\0'; text++) {
    letters += (*text & 0xc0) != 0x80 ? 1 : 0;
  }
  return (bold ? 0.6 : 0.52) * size_mm * (double)letters;
}

static void text(struct dea_canvas *canvas, double x_mm, double y_mm, double size_mm,
                 enum dea_align align, bool bold, unsigned colour, const char *words)
{
  static const char *const anchor[] = {"start", "middle", "end"};
  dea_html_add(canvas->out,
               "<text x=\"%.2f\" y=\"%.2f\" font-size=\"%.3g\" fill=\"#%06x\" text-anchor=\"%s\"",
               x_of(x_mm), y_of(canvas, y_mm), unit * size_mm, colour, anchor[align]);
  dea_html_add(canvas->out, bold ? " font-weight=\"bold\">%s</text>\n" : ">%s</text>\n", words);
}

const struct dea_canvas_type dea_canvas_svg = {
    .contour = contour,
    .line = line,
    .box = box,
    .fill = fill,
    .stroke = stroke,
    .clip = clip,
    .unclip = unclip,
    .text = text,
    .text_width = text_width,
};
