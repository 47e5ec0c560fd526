/* Drawings of the report's page as SVG files of their own: one below the other, with the page's
 * colours and the key of a plot. */
#include "api/api.h"

#include <stdlib.h>
#include <string.h>

enum { KEY_LINE = 22, KEY_COLUMN = 300, MARGIN = 8 };

// web/report.css, without variables: not every program that shows SVG knows them
static const char style[] =
    "svg{font-family:'DejaVu Sans',Helvetica,Arial,sans-serif}text{font-size:13px;fill:#1c2430}"
    ".tics text{font-size:12px;fill:#566173}.it{font-style:italic}.small{font-size:75%}"
    ".grid path{stroke:#d9dee6;fill:none}.frame{stroke:#566173;stroke-width:1.2;fill:none}"
    ".line{fill:none;stroke-width:2.2;stroke-linejoin:round}.dashed{stroke-dasharray:7 5}"
    ".dotted{stroke-dasharray:1.5 4}.mark{fill:#fff;stroke-width:1.6}.band{fill:#f6e3d8}"
    ".limits path{stroke:#707070;stroke-dasharray:4 3}.limits text{font-size:12px}"
    ".c0{stroke:#0072b2}.c1{stroke:#d55e00}.c2{stroke:#009e73}.c3{stroke:#b85c94}.c4{stroke:#"
    "c98a00}"
    ".c5{stroke:#3d9fd6}.c6{stroke:#1c2430}.c7{stroke:#707070}";

/* A drawing within a fragment. */
struct drawing {
  const char *inside; // after "<svg"
  size_t length;      // up to and with "</svg>"
  double width, height;
  const char *after;
};

/* The next drawing, of those with this beginning; false when there is none. */
static bool next_drawing(const char *from, const char *begin, struct drawing *out)
{
  const char *start = strstr(from, begin);
  const char *end = start != NULL ? strstr(start, "</svg>") : NULL;
  const char *box = start != NULL ? strstr(start, "viewBox=\"0 0 ") : NULL;
  if (end == NULL || box == NULL || box > end) {
    return false;
  }
  char *rest;
  out->inside = start + strlen("<svg");
  out->after = end + strlen("</svg>");
  out->length = (size_t)(out->after - out->inside);
  out->width = strtod(box + strlen("viewBox=\"0 0 "), &rest);
  out->height = strtod(rest, NULL);
  return true;
}

static bool is_sample(const struct drawing *drawing)
{
  return strncmp(drawing->inside, " class=\"sample\"", strlen(" class=\"sample\"")) == 0;
}

static void add_drawing(struct dea_text *out, const struct drawing *drawing, double x, double y)
{
  dea_text_add(out, "<svg x=\"%.0f\" y=\"%.0f\" width=\"%.0f\" height=\"%.0f\"%.*s\n", x, y,
               drawing->width, drawing->height, (int)drawing->length, drawing->inside);
}

/* The lines of a plot's key below it; returns where they end. */
static double add_key(struct dea_text *out, const char *fragment, double y)
{
  struct drawing sample;
  int count = 0;
  for (const char *at = fragment; next_drawing(at, "<svg class=\"sample\"", &sample); count++) {
    const char *end = strstr(sample.after, "</li>");
    const int row = count / 2;
    double x = MARGIN + count % 2 * KEY_COLUMN, line = y + row * KEY_LINE;
    int length = end != NULL ? (int)(end - sample.after) : 0;
    add_drawing(out, &sample, x, line);
    dea_text_add(out, "<text x=\"%.0f\" y=\"%.0f\">%.*s</text>\n", x + 36, line + 11, length,
                 sample.after);
    at = sample.after;
  }
  const int rows = (count + 1) / 2;
  return y + rows * KEY_LINE;
}

void api_svg_add(struct dea_text *out, const char *fragment)
{
  struct dea_text inside = {.ctx = out->ctx};
  struct drawing drawing;
  double width = 0, y = MARGIN;
  for (const char *at = fragment; next_drawing(at, "<svg", &drawing); at = drawing.after) {
    if (!is_sample(&drawing)) {
      add_drawing(&inside, &drawing, MARGIN, y);
      width = drawing.width > width ? drawing.width : width;
      y += drawing.height + MARGIN;
    }
  }
  y = add_key(&inside, fragment, y);
  dea_text_add(out,
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
               "viewBox=\"0 0 %.0f %.0f\"><style>%s</style>"
               "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n%s</svg>\n",
               width + 2 * MARGIN, y, width + 2 * MARGIN, y, style, dea_text_get(&inside));
  out->failed = out->failed || inside.failed;
  dea_text_free(&inside);
}
