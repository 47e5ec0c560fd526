#include "fabricate/pages.h"

#include "base/file.h"
#include "figures/dimensions.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double millimetres = 1e3; // per metre of a contour, at 1:1

/* The smallest page of the ISO sizes that takes a width and a height, else one of just that size.
 */
static void page_size(double width, double height, double out[2])
{
  static const double sizes[][2] = {{210, 297}, {297, 210}, {297, 420}, {420, 297},  {420, 594},
                                    {594, 420}, {594, 841}, {841, 594}, {841, 1189}, {1189, 841}};
  for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
    if (width <= sizes[i][0] && height <= sizes[i][1]) {
      memcpy(out, sizes[i], sizeof sizes[i]);
      return;
    }
  }
  out[0] = width;
  out[1] = height;
}

/* A part with its labels beside it. */
static void part_page(const struct dea_part *part, double out[2])
{
  double box[4];
  dea_part_box(part, box);
  page_size(1e3 * (box[2] - box[0]) + 2 * 68, 1e3 * (box[3] - box[1]) + 2 * 30, out);
}

dea_status dea_pages_first_size(const struct dea_workshop *workshop, double out_mm[2])
{
  part_page(&workshop->part[0], out_mm);
  return DEA_OK;
}

static void add_contours(const struct dea_paper *paper, const struct dea_part *part,
                         enum dea_layer layer, double x, double y)
{
  for (size_t i = 0; i < part->contour_count; i++) {
    if (part->contour[i].layer == layer) {
      paper->type->contour(paper->canvas, &part->contour[i].path, millimetres, x, y);
    }
  }
}

/* The finished part: its material grey, edges black, marks thin. */
static void draw_part(const struct dea_paper *paper, const struct dea_part *part, double x,
                      double y)
{
  if (!part->paper) {
    add_contours(paper, part, DEA_LAYER_CUT_OUTER, x, y);
    add_contours(paper, part, DEA_LAYER_CUT_INNER, x, y);
    paper->type->fill(paper->canvas, 0xeef1f4, 1, true);
    paper->type->stroke(paper->canvas, 0.25, 0x202020, 0);
  }
  add_contours(paper, part, DEA_LAYER_MARK, x, y);
  paper->type->stroke(paper->canvas, 0.18, 0x2a6f3a, 0);
  if (part->word != NULL) {
    paper->type->text(paper->canvas, x, y + 1e3 * part->word_y_m, 1.4e3 * part->word_height_m,
                      DEA_ALIGN_CENTRE, false, 0x2a6f3a, part->word);
  }
}

/* By how much a length of the film is larger in the film's other state. */
static double other_state(const struct dea_part *part, const struct dea_part_measure *m)
{
  const double(*F)[2] = part->stretch;
  double det = F[0][0] * F[1][1] - F[0][1] * F[1][0];
  double x = m->to_m[0] - m->from_m[0], y = m->to_m[1] - m->from_m[1], length = hypot(x, y);
  if (part->state == DEA_UNSTRETCHED) {
    return hypot(F[0][0] * x + F[0][1] * y, F[1][0] * x + F[1][1] * y) / length;
  }
  return hypot(F[1][1] * x - F[0][1] * y, F[0][0] * y - F[1][0] * x) / (det * length);
}

/* ", pre-stretch 1.5", along x and y where these differ; nothing of a part without one. */
static void write_stretch(const struct dea_part *part, char *out, size_t size)
{
  const double(*F)[2] = part->stretch;
  if (F[0][0] == 0) {
    out[0] = '\0';
  } else if (F[0][0] == F[1][1]) {
    snprintf(out, size, ", pre-stretch %.4g", F[0][0]);
  } else {
    snprintf(out, size, ", pre-stretch %.4g along x, %.4g along y", F[0][0], F[1][1]);
  }
}

/* The label of a dimension; of a part of the film also in the film's other state. */
static void describe(const struct dea_part *part, const struct dea_part_measure *m, double length_m,
                     struct dea_callout *out)
{
  char here[32], there[32];
  bool film = (part->paper || part->state == DEA_UNSTRETCHED) && part->stretch[0][0] > 0;
  dea_length_text(here, sizeof here, length_m);
  dea_length_text(there, sizeof there, length_m * other_state(part, m));
  snprintf(out->label, sizeof out->label, "%s%s mm",
           m->kind == DEA_MEASURE_DIAMETER ? "\xc3\x98 " : "", here);
  if (film && strcmp(m->what, "stencil") != 0) {
    snprintf(out->note, sizeof out->note, "%s; %s %s", m->what, there,
             part->state == DEA_UNSTRETCHED ? "stretched" : "unstretched");
  } else {
    snprintf(out->note, sizeof out->note, "%s", m->what);
  }
}

static void draw_measures(const struct dea_paper *paper, const struct dea_part *part, double x,
                          double y)
{
  struct dea_callout callouts[DEA_PART_MEASURES_MAX];
  double box[4];
  dea_part_box(part, box);
  const double around[4] = {x + 1e3 * box[0], y + 1e3 * box[1], x + 1e3 * box[2], y + 1e3 * box[3]};
  for (size_t i = 0; i < part->measure_count; i++) {
    const struct dea_part_measure *m = &part->measure[i];
    const double from[2] = {x + 1e3 * m->from_m[0], y + 1e3 * m->from_m[1]};
    const double to[2] = {x + 1e3 * m->to_m[0], y + 1e3 * m->to_m[1]};
    double length = hypot(to[0] - from[0], to[1] - from[1]);
    callouts[i] =
        (struct dea_callout){.x_mm = 0.5 * (from[0] + to[0]), .y_mm = 0.5 * (from[1] + to[1])};
    describe(part, m, 1e-3 * length, &callouts[i]);
    if (m->kind == DEA_MEASURE_DIAMETER) {
      callouts[i].radius_mm = 0.5 * length;
    } else {
      dea_dimensions_dimension(paper, from, to, &callouts[i]);
    }
  }
  dea_dimensions_callouts(paper, around, callouts, part->measure_count);
}

static void draw_part_page(const struct dea_paper *paper, const struct dea_workshop *w,
                           const struct dea_part *part, const double size[2])
{
  char below[320], stretch[64];
  double box[4];
  dea_part_box(part, box);
  double x = 0.5 * size[0] - 0.5e3 * (box[0] + box[2]), half = 0.5e3 * (box[2] - box[0]);
  double y = 0.5 * size[1] - 0.5e3 * (box[1] + box[3]);
  write_stretch(part, stretch, sizeof stretch);
  snprintf(below, sizeof below, "%s; %s; lengths of the %s film%s; %.80s",
           part->paper ? "not to be cut" : "finished part, without kerf", dea_part_seen(part),
           dea_part_film_name(part), stretch, dea_path_name(w->plan.design->file));
  dea_dimensions_head(paper, size[0], size[1], part->title, below);
  dea_dimensions_scale(paper, size[0],
                       "1:1 if the bar is 50 mm long: print at 100 %, without fitting to the page");
  dea_dimensions_centre(paper, x, y, fmax(half, 0.5e3 * (box[3] - box[1])) + 4);
  draw_part(paper, part, x, y);
  draw_measures(paper, part, x, y);
}

/* All copies on their sheet; the page is the sheet. */
static void draw_sheet_page(const struct dea_paper *paper, const struct dea_workshop *w,
                            size_t index)
{
  const struct dea_sheet_layout *layout = &w->layout[index];
  char words[320];
  snprintf(words, sizeof words,
           "%.80s: %s; %d copies on their sheet, finished parts without kerf; 1:1",
           dea_path_name(w->plan.design->file), w->part[index].title, layout->count);
  dea_dimensions_fit(paper, 5, 1.6, 2.3, false, 0x6a6a6a, 1e3 * layout->width_m - 10, words);
  for (int copy = 0; copy < layout->count; copy++) {
    double at[2];
    dea_sheet_place(layout, copy, at);
    draw_part(paper, &w->part[index], 1e3 * at[0], 1e3 * at[1]);
  }
}

dea_status dea_pages_draw(const struct dea_paper *paper, const struct dea_workshop *workshop)
{
  for (size_t i = 0; i < workshop->count; i++) {
    double size[2];
    part_page(&workshop->part[i], size);
    if (i > 0) {
      paper->type->page(paper->canvas, size[0], size[1]);
    }
    draw_part_page(paper, workshop, &workshop->part[i], size);
  }
  for (size_t i = 0; i < workshop->count; i++) {
    const struct dea_sheet_layout *layout = &workshop->layout[i];
    bool readable = fmax(layout->width_m, layout->height_m) <= 5; // 14400 pt, what readers take
    if (layout->count > 1 && readable) {
      paper->type->page(paper->canvas, 1e3 * layout->width_m, 1e3 * layout->height_m);
      draw_sheet_page(paper, workshop, i);
    }
  }
  return DEA_OK;
}
