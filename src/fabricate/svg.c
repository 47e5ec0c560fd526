#include "fabricate/svg.h"

#include "base/html.h"
#include "fabricate/dxf_write.h"

#include <math.h>

/* A number of mm, to the nanometre, without a minus at zero. */
static double mm(double si)
{
  double value = 1e3 * si;
  return fabs(value) < 5e-7 ? 0 : value;
}

/* SVG counts y downwards, so arcs turn the other way. */
static void write_path(struct dea_text *out, bool circle, const struct dea_contour *path,
                       const double at[2], double height)
{
  const struct dea_vertex *v = path->vertex;
  if (circle) {
    dea_text_add(out, "    <circle cx=\"%.6f\" cy=\"%.6f\" r=\"%.6f\"/>\n",
                 mm(at[0] + 0.5 * (v[0].x_m + v[1].x_m)),
                 mm(height - at[1] - 0.5 * (v[0].y_m + v[1].y_m)),
                 mm(0.5 * hypot(v[1].x_m - v[0].x_m, v[1].y_m - v[0].y_m)));
    return;
  }
  dea_text_add(out, "    <path d=\"M%.6f %.6f", mm(at[0] + v[0].x_m),
               mm(height - at[1] - v[0].y_m));
  for (size_t i = 0; i < dea_contour_pieces(path); i++) {
    const struct dea_piece piece = dea_contour_piece(path, i);
    double x = mm(at[0] + piece.to[0]), y = mm(height - at[1] - piece.to[1]);
    if (piece.arc) {
      dea_text_add(out, " A%.6f %.6f 0 %d %d %.6f %.6f", mm(piece.radius_m), mm(piece.radius_m),
                   fabs(piece.sweep) > 3.14159265358979, piece.sweep < 0, x, y);
    } else {
      dea_text_add(out, " L%.6f %.6f", x, y);
    }
  }
  dea_text_add(out, "%s\"/>\n", path->closed ? " Z" : "");
}

static void write_words(struct dea_text *out, double x, double y, double height, const char *text)
{
  dea_html_add(out,
               "    <text x=\"%.6f\" y=\"%.6f\" font-size=\"%.6f\" text-anchor=\"middle\" "
               "stroke=\"none\" fill=\"#000000\" font-family=\"sans-serif\">%s</text>\n",
               mm(x), mm(y), mm(1.4 * height), text);
}

/* What a part has on one layer, for one copy. */
static dea_status write_copy(struct dea_text *out, const struct dea_workshop *workshop,
                             const struct dea_part *part, enum dea_layer layer, const double at[2],
                             double height)
{
  for (size_t i = 0; i < part->contour_count; i++) {
    if (part->contour[i].layer == layer) {
      struct dea_vertex *memory;
      struct dea_contour path;
      DEA_TRY(out->ctx, dea_workshop_path(workshop, part, i, &memory, &path));
      write_path(out, part->contour[i].circle, &path, at, height);
      dea_free(out->ctx, memory);
    }
  }
  if (part->word != NULL && layer == DEA_LAYER_MARK) {
    write_words(out, at[0], height - at[1] - part->word_y_m, part->word_height_m, part->word);
  }
  return DEA_OK;
}

static dea_status write_layer(struct dea_text *out, const struct dea_workshop *workshop,
                              size_t index, enum dea_layer layer)
{
  static const struct {
    const char *name, *meaning;
    unsigned colour;
  } rows[] = {
#define LAYER_ROW(name, meaning, dxf, screen) {#name, meaning, screen},
      DEA_LAYER_LIST(LAYER_ROW)
#undef LAYER_ROW
  };
  const struct dea_sheet_layout *layout = &workshop->layout[index];
  const struct dea_part *part = &workshop->part[index];
  dea_text_add(out,
               "  <g id=\"%s\" inkscape:groupmode=\"layer\" inkscape:label=\"%s\" "
               "stroke=\"#%06x\" fill=\"none\" stroke-width=\"0.05\">\n    <title>%s</title>\n",
               rows[layer].name, rows[layer].name, rows[layer].colour, rows[layer].meaning);
  for (int copy = 0; copy < layout->count; copy++) {
    double at[2];
    dea_sheet_place(layout, copy, at);
    DEA_TRY(out->ctx, write_copy(out, workshop, part, layer, at, layout->height_m));
  }
  dea_text_add(out, "  </g>\n");
  return DEA_OK;
}

dea_status dea_svg_write(const struct dea_workshop *workshop, size_t index, struct dea_text *out)
{
  const struct dea_sheet_layout *layout = &workshop->layout[index];
  struct dea_text words = {.ctx = out->ctx};
  double width = mm(layout->width_m), height = mm(layout->height_m);
  dea_sheet_labels(workshop, index, &words);
  dea_html_add(out,
               "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
               "<svg xmlns=\"http://www.w3.org/2000/svg\" "
               "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\"\n"
               "     width=\"%.6fmm\" height=\"%.6fmm\" viewBox=\"0 0 %.6f %.6f\">\n"
               "  <title>%s</title>\n",
               width, height, width, height, dea_text_get(&words));
  dea_status status = dea_text_free(&words);
  for (int layer = 0; layer < DEA_LAYER_NOTE && status == DEA_OK; layer++) {
    status = write_layer(out, workshop, index, (enum dea_layer)layer);
  }
  dea_text_add(out, "</svg>\n");
  return status == DEA_OK && out->failed ? DEA_E_MEMORY : status;
}
