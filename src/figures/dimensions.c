#include "figures/dimensions.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { INK = 0x202020, GREY = 0x6a6a6a, LEADER = 0x8a8a8a, COLUMN_MAX = 24 };

static const double label_size = 3, note_size = 2.3, spacing = 10;
static const double column_gap = 11; // between drawing and labels
static const double thin = 0.13;

void dea_length_text(char *out, size_t size, double length_m)
{
  int n = snprintf(out, size, "%.3f", 1e3 * length_m);
  while (n > 0 && (size_t)n < size && strchr(out, '.') != NULL &&
         (out[n - 1] == '0' || out[n - 1] == '.')) {
    bool point = out[n - 1] == '.';
    out[--n] = '\0';
    if (point) {
      break;
    }
  }
}

static void arrow(const struct dea_paper *paper, double x, double y, double angle)
{
  static const double length = 1.8, half = 0.3;
  double c = cos(angle), s = sin(angle);
  const struct dea_vertex tip[3] = {
      {.x_m = x, .y_m = y},
      {.x_m = x - length * c - half * s, .y_m = y - length * s + half * c},
      {.x_m = x - length * c + half * s, .y_m = y - length * s - half * c}};
  const struct dea_contour triangle = {tip, 3, true};
  paper->type->contour(paper->canvas, &triangle, 1, 0, 0);
  paper->type->fill(paper->canvas, INK, 1, false);
}

void dea_dimensions_dimension(const struct dea_paper *paper, const double from_mm[2],
                              const double to_mm[2], struct dea_callout *callout)
{
  double dx = to_mm[0] - from_mm[0], dy = to_mm[1] - from_mm[1], length = hypot(dx, dy);
  double angle = atan2(dy, dx), out = length < 6 ? 3.5 : 0, c = cos(angle), s = sin(angle);
  paper->type->line(paper->canvas, from_mm[0] - out * c, from_mm[1] - out * s, to_mm[0] + out * c,
                    to_mm[1] + out * s);
  paper->type->stroke(paper->canvas, thin, INK, 0);
  arrow(paper, from_mm[0], from_mm[1], out > 0 ? angle : angle + DEA_PI);
  arrow(paper, to_mm[0], to_mm[1], out > 0 ? angle + DEA_PI : angle);
  callout->x_mm = out > 0 ? to_mm[0] + out * c : from_mm[0] + 0.7 * dx;
  callout->y_mm = out > 0 ? to_mm[1] + out * s : from_mm[1] + 0.7 * dy;
  callout->bare = true;
}

void dea_dimensions_centre(const struct dea_paper *paper, double x_mm, double y_mm, double half_mm)
{
  paper->type->line(paper->canvas, x_mm - half_mm, y_mm, x_mm + half_mm, y_mm);
  paper->type->line(paper->canvas, x_mm, y_mm - half_mm, x_mm, y_mm + half_mm);
  paper->type->stroke(paper->canvas, thin, LEADER, 1.2);
}

/* ---- labels ---- */

struct label {
  const struct dea_callout *callout;
  double wish; // height that would suit it
};

static void sort(struct label *labels, size_t count)
{
  for (size_t i = 1; i < count; i++) { // few, and equal ones stay in their order
    struct label moved = labels[i];
    size_t k = i;
    for (; k > 0 && labels[k - 1].wish < moved.wish; k--) {
      labels[k] = labels[k - 1];
    }
    labels[k] = moved;
  }
}

static void draw_label(const struct dea_paper *paper, const struct dea_callout *callout, int side,
                       double x, double y)
{
  double elbow = x - side * 4, dx = elbow - callout->x_mm, dy = y - callout->y_mm;
  double far = hypot(dx, dy), r = callout->radius_mm;
  double at[2] = {callout->x_mm + (far > r ? r * dx / far : 0),
                  callout->y_mm + (far > r ? r * dy / far : 0)};
  double letters = y - 0.35 * label_size;
  enum dea_align align = side > 0 ? DEA_ALIGN_LEFT : DEA_ALIGN_RIGHT;
  paper->type->line(paper->canvas, at[0], at[1], elbow, y);
  paper->type->line(paper->canvas, elbow, y, x - side * 1.2, y);
  paper->type->stroke(paper->canvas, thin, LEADER, 0);
  if (!callout->bare) {
    arrow(paper, at[0], at[1], atan2(at[1] - y, at[0] - elbow));
  }
  paper->type->text(paper->canvas, x, letters, label_size, align, false, INK, callout->label);
  paper->type->text(paper->canvas, x, letters - 3.4, note_size, align, false, GREY, callout->note);
  if (callout->below[0] != '\0') {
    paper->type->text(paper->canvas, x, letters - 6.2, note_size, align, false, GREY,
                      callout->below);
  }
}

static void draw_column(const struct dea_paper *paper, const double box[4], int side,
                        struct label *labels, size_t count)
{
  double middle = 0.5 * (box[1] + box[3]), height = fmax(box[3] - box[1], spacing * (double)count);
  double x = side > 0 ? box[2] + column_gap : box[0] - column_gap;
  sort(labels, count);
  for (size_t i = 0; i < count; i++) {
    double share = ((double)i + 0.5) / (double)count;
    draw_label(paper, labels[i].callout, side, x, middle + height * (0.5 - share));
  }
}

/* Labels of the left and the right column. */
static void share_out(const double box_mm[4], const struct dea_callout *callouts, size_t count,
                      struct label column[2][COLUMN_MAX], size_t used[2])
{
  double middle = 0.5 * (box_mm[0] + box_mm[2]), width = box_mm[2] - box_mm[0];
  used[0] = used[1] = 0;
  for (int central = 0; central < 2; central++) { // those in the middle fill up the columns
    for (size_t i = 0; i < count; i++) {
      const struct dea_callout *c = &callouts[i];
      bool is_central = fabs(c->x_mm - middle) < 0.02 * width;
      int side = is_central ? (used[1] > used[0] ? 0 : 1) : c->x_mm > middle;
      if (is_central == (central == 1) && used[side] < COLUMN_MAX) {
        // of circles about the middle the larger ones go to the top and the bottom
        double wish =
            c->radius_mm > 0 && is_central ? (used[side] % 2 ? -0.8 : 0.8) * c->radius_mm : 0;
        column[side][used[side]++] = (struct label){c, c->y_mm + wish};
      }
    }
  }
}

void dea_dimensions_callouts(const struct dea_paper *paper, const double box_mm[4],
                             const struct dea_callout *callouts, size_t count)
{
  struct label column[2][COLUMN_MAX];
  size_t used[2];
  share_out(box_mm, callouts, count, column, used);
  draw_column(paper, box_mm, -1, column[0], used[0]);
  draw_column(paper, box_mm, 1, column[1], used[1]);
}

double dea_dimensions_height(const double box_mm[4], const struct dea_callout *callouts,
                             size_t count)
{
  struct label column[2][COLUMN_MAX];
  size_t used[2];
  share_out(box_mm, callouts, count, column, used);
  return fmax(box_mm[3] - box_mm[1], spacing * (double)(used[0] > used[1] ? used[0] : used[1]));
}

/* ---- page ---- */

void dea_dimensions_fit(const struct dea_paper *paper, double x_mm, double y_mm, double size_mm,
                        bool bold, unsigned colour, double width_mm, const char *text)
{
  char words[320];
  size_t n = (size_t)snprintf(words, sizeof words - 4, "%s", text);
  n = n < sizeof words - 5 ? n : sizeof words - 5;
  bool cut = n < strlen(text);
  while (n > 0 &&
         (cut || paper->type->text_width(paper->canvas, size_mm, bold, words) > width_mm)) {
    while (n > 0 && (words[--n] & 0xc0) == 0x80) { // not inside of a letter
    }
    memcpy(words + n, "...", 4);
    cut = paper->type->text_width(paper->canvas, size_mm, bold, words) > width_mm;
    if (!cut) {
      break;
    }
  }
  paper->type->text(paper->canvas, x_mm, y_mm, size_mm, DEA_ALIGN_LEFT, bold, colour, words);
}

void dea_dimensions_head(const struct dea_paper *paper, double width_mm, double height_mm,
                         const char *title, const char *below)
{
  dea_dimensions_fit(paper, 12, height_mm - 15, 4.6, true, INK, width_mm - 24, title);
  dea_dimensions_fit(paper, 12, height_mm - 20.5, 2.8, false, GREY, width_mm - 24, below);
  paper->type->line(paper->canvas, 12, height_mm - 23.5, width_mm - 12, height_mm - 23.5);
  paper->type->stroke(paper->canvas, 0.25, INK, 0);
}

void dea_dimensions_scale(const struct dea_paper *paper, double width_mm, const char *words)
{
  for (int k = 0; k < 5; k++) { // black and white pieces of 10 mm
    paper->type->box(paper->canvas, 12 + 10 * k, 12, 10, 1.2);
    paper->type->fill(paper->canvas, k % 2 ? 0xffffff : INK, 1, true);
    paper->type->stroke(paper->canvas, thin, INK, 0);
  }
  paper->type->text(paper->canvas, 12, 14.2, note_size, DEA_ALIGN_LEFT, false, GREY, "0");
  paper->type->text(paper->canvas, 62, 14.2, note_size, DEA_ALIGN_RIGHT, false, GREY, "50 mm");
  dea_dimensions_fit(paper, 68, 12, note_size, false, GREY, width_mm - 80, words);
}
