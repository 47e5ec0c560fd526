#include "figures/device_drawing.h"

#include "base/sort.h"
#include "base/write_file.h"
#include "figures/dimensions.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
  INK = 0x1c2430,
  GREY = 0x566173,
  FRAME = 0xc9ced6,
  PRESSURE = 0xa03030,
  MONITOR = 0xc0186b,
  PLY_COLOURS = 4,
  CALLOUTS = 24,
  WORDS = 160,
};

// of materials with a hyperelastic law, and of others, in their order: fill and line
static const unsigned ply_fill[2][PLY_COLOURS] = {{0xdbe7f2, 0xcfe3c4, 0xe6d3ea, 0xd3ecea},
                                                  {0xe0a04a, 0xf1dc9a, 0xd8a58a, 0xc9ced6}};
static const unsigned ply_line[2][PLY_COLOURS] = {{0x8ea9c2, 0x8fb07d, 0xb590bd, 0x7fb5b0},
                                                  {0xb07a2c, 0xc4ab52, 0xa8745a, 0x8c93a0}};
// of channels; the first one is ground
static const unsigned channel_line[] = {0x707070, 0x0072b2, 0xd55e00, 0x009e73,
                                        0xb85c94, 0xc98a00, 0x3d9fd6};
enum { CHANNEL_COLOURS = sizeof channel_line / sizeof channel_line[0] };

// the page, in mm
static const double page_width = 196, margin = 10, head = 26;
static const double plan_width = 84, plan_height = 84; // largest sides of the view from above
static const double middle = 98;                       // of the views
static const double section_words = 13, section_room = 34, clamp_width = 7;
static const double line_height = 5.2, key_size = 2.9, band = 4;

enum { PLIES = 256 }; // of a section, from the lowest on

struct view {
  const struct dea_paper *paper; // NULL: only measured
  const struct dea_device_drawing *drawing;
  const struct dea_layout *layout;
  double box[4];         // of what is drawn [m]
  double scale;          // mm on the page per metre
  double height;         // of the page
  double plan_y;         // middle of the view from above
  double section_y;      // lower edge of the lowest ply in the section
  double key_y;          // of the next line of the legend
  double plan_room;      // heights that the views take with their labels
  double section_height; // of all plies in the section
  int column;            // of the legend
  double base[PLIES];    // lower side of each ply in the section, from its lower edge
};

static double x_of(const struct view *v, double x_m)
{
  return middle + v->scale * (x_m - 0.5 * (v->box[0] + v->box[2]));
}

static double y_of(const struct view *v, double y_m)
{
  return v->plan_y + v->scale * (y_m - 0.5 * (v->box[1] + v->box[3]));
}

unsigned dea_device_drawing_channel(size_t channel)
{
  return channel_line[channel == 0 ? 0 : 1 + (channel - 1) % (CHANNEL_COLOURS - 1)];
}

static bool is_stiff(const struct dea_material *material)
{
  return material->law == NULL;
}

/* Number of the material of a ply among those of its sort that differ by name. */
static size_t material_of(const struct dea_layout *l, size_t ply)
{
  const struct dea_material *own = &l->plies[ply].material;
  size_t count = 0;
  for (size_t i = 0; strcmp(l->plies[i].material.name, own->name) != 0; i++) {
    size_t first = 0;
    while (strcmp(l->plies[first].material.name, l->plies[i].material.name) != 0) {
      first++;
    }
    count += first == i && is_stiff(&l->plies[i].material) == is_stiff(own) ? 1 : 0;
  }
  return count;
}

/* ---- how things look ---- */

struct style {
  unsigned fill, line;
  double opacity, width_mm, dash_mm;
};

static struct style ply_style(const struct dea_layout *l, size_t ply)
{
  size_t colour = material_of(l, ply) % PLY_COLOURS;
  int sort = is_stiff(&l->plies[ply].material) ? 1 : 0;
  return (struct style){ply_fill[sort][colour], ply_line[sort][colour], sort == 0 ? 0.6 : 0.85,
                        0.25, 0};
}

static struct style channel_style(size_t channel)
{
  unsigned colour = dea_device_drawing_channel(channel);
  return (struct style){colour, colour, channel == 0 ? 0.06 : 0.25, 0.3, channel == 0 ? 0.8 : 0};
}

static const struct style body_style = {0x3b4452, INK, 0.35, 0.35, 0};
static const struct style pressure_style = {0, PRESSURE, 0, 0.25, 0.6};

/* A support: its line, drawn through when it is clamped. */
static struct style support_style(const struct dea_layout_support *s)
{
  return (struct style){.line = INK,
                        .width_mm = s->edge ? 1.1 : 0.25,
                        .dash_mm = s->components == 7 && !s->hinged ? 0 : 1.6};
}

/* Fills and strokes the path. */
static void paint(const struct view *v, const struct style *style)
{
  const struct dea_canvas_type *type = v->paper->type;
  if (style->opacity > 0) {
    type->fill(v->paper->canvas, style->fill, style->opacity, true);
  }
  type->stroke(v->paper->canvas, style->width_mm, style->line, style->dash_mm);
}

static void add_contour(const struct view *v, const struct dea_contour *contour)
{
  double x = x_of(v, 0), y = y_of(v, 0);
  v->paper->type->contour(v->paper->canvas, contour, v->scale, x, y);
}

static void add_region(const struct view *v, size_t number)
{
  const struct dea_region *region = &v->layout->regions[number].region;
  for (size_t i = 0; i < region->contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(region, i);
    add_contour(v, &contour);
  }
}

/* Slanted lines over a box, for what is clipped there. */
static void hatch(const struct view *v, double x0, double y0, double x1, double y1)
{
  const struct dea_canvas_type *type = v->paper->type;
  for (double at = x0 - (y1 - y0); at < x1; at += 1.6) {
    type->line(v->paper->canvas, at, y0, at + (y1 - y0), y1);
  }
  type->stroke(v->paper->canvas, 0.35, INK, 0);
}

static void hatch_region(const struct view *v, size_t number)
{
  double box[4];
  dea_region_box_m(&v->layout->regions[number].region, box);
  add_region(v, number);
  v->paper->type->clip(v->paper->canvas);
  hatch(v, x_of(v, box[0]), y_of(v, box[1]), x_of(v, box[2]), y_of(v, box[3]));
  v->paper->type->unclip(v->paper->canvas);
}

static void draw_text(const struct view *v, double x, double y, double size, bool bold,
                      unsigned colour, const char *words)
{
  if (v->paper != NULL) {
    v->paper->type->text(v->paper->canvas, x, y, size, DEA_ALIGN_LEFT, bold, colour, words);
  }
}

/* ---- from above ---- */

static void draw_shapes(const struct view *v, bool over)
{
  for (size_t i = 0; i < v->drawing->shape_count; i++) {
    const struct dea_drawn_shape *s = &v->drawing->shapes[i];
    const struct style style = {s->colour, INK, s->opacity, 0.2, s->dash_mm};
    if (s->over == over) {
      add_contour(v, &s->contour);
      paint(v, &style);
    }
  }
}

/* A band along edges that are held all around, where no frame is drawn; the film covers its half.
 */
static void draw_frame(const struct view *v)
{
  const struct dea_canvas_type *type = v->paper->type;
  for (size_t i = 0; i < v->layout->support_count; i++) {
    if (dea_support_is_frame(&v->layout->supports[i]) && v->drawing->shape_count == 0) {
      add_region(v, v->layout->supports[i].region);
      type->stroke(v->paper->canvas, 2 * band, FRAME, 0);
      add_region(v, v->layout->supports[i].region);
      type->fill(v->paper->canvas, 0xffffff, 1, false);
    }
  }
}

static void draw_supports(const struct view *v)
{
  const struct dea_canvas_type *type = v->paper->type;
  for (size_t i = 0; i < v->layout->support_count; i++) {
    const struct dea_layout_support *s = &v->layout->supports[i];
    const struct style style = support_style(s);
    if (s->within != DEA_LAYOUT_NONE) {
      add_region(v, s->within);
      type->clip(v->paper->canvas);
    }
    if (!s->edge) {
      hatch_region(v, s->region);
    }
    add_region(v, s->region);
    paint(v, &style);
    if (s->within != DEA_LAYOUT_NONE) {
      type->unclip(v->paper->canvas);
    }
  }
}

/* Where on the page the cross of a monitor is. */
static void monitor_place(const struct view *v, size_t i, double out[2])
{
  const struct dea_layout_monitor *m = &v->layout->monitors[i];
  double at[2] = {m->at_m[0][0], m->at_m[0][1]};
  if (m->kind != DEA_MONITOR_POINT && m->kind != DEA_MONITOR_LINE) {
    size_t region = m->kind == DEA_MONITOR_BODY      ? v->layout->bodies[m->body].region
                    : m->kind == DEA_MONITOR_VOLUME  ? v->layout->pressures[m->pressure].region
                    : m->kind == DEA_MONITOR_CONTACT ? v->layout->contacts[m->contact].region
                                                     : m->region;
    dea_region_centroid_m(&v->layout->regions[region].region, at);
  }
  out[0] = x_of(v, at[0]);
  out[1] = y_of(v, at[1]);
}

/* Numbers of all monitors with a cross within the height of a digit of that of monitor i, with
 * commas; none where one before it has named them. */
static void monitor_numbers(const struct view *v, size_t i, char *out, size_t size)
{
  static const double digit_mm = 2.9;
  double own[2], other[2];
  monitor_place(v, i, own);
  out[0] = '\0';
  for (size_t k = 0; k < v->layout->monitor_count; k++) {
    const size_t used = strlen(out);
    monitor_place(v, k, other);
    if (hypot(other[0] - own[0], other[1] - own[1]) < digit_mm) {
      if (k < i) {
        return;
      }
      snprintf(out + used, size - used, "%s%zu", used > 0 ? ", " : "", k + 1);
    }
  }
}

/* A cross at a point of a monitor, with its number. */
static void draw_monitors(const struct view *v)
{
  const struct dea_canvas_type *type = v->paper->type;
  for (size_t i = 0; i < v->layout->monitor_count; i++) {
    const struct dea_layout_monitor *m = &v->layout->monitors[i];
    double at[2];
    char numbers[80];
    monitor_place(v, i, at);
    if (m->kind == DEA_MONITOR_LINE) {
      type->line(v->paper->canvas, at[0], at[1], x_of(v, m->at_m[1][0]), y_of(v, m->at_m[1][1]));
      type->stroke(v->paper->canvas, 0.25, MONITOR, 0);
    }
    type->line(v->paper->canvas, at[0] - 1.2, at[1], at[0] + 1.2, at[1]);
    type->line(v->paper->canvas, at[0], at[1] - 1.2, at[0], at[1] + 1.2);
    type->stroke(v->paper->canvas, 0.4, MONITOR, 0);
    monitor_numbers(v, i, numbers, sizeof numbers);
    draw_text(v, at[0] + 1.2, m->kind == DEA_MONITOR_REGION ? at[1] - 3.4 : at[1] + 1.2, 2.9, false,
              MONITOR, numbers);
  }
}

/* Mirror lines; of a device that every line mirrors, two of them. */
static size_t mirror_lines(const struct dea_symmetry *s)
{
  return s->order == 0 ? 2 : s->mirrors < 24 ? s->mirrors : 24;
}

static void draw_symmetry(const struct view *v)
{
  const struct dea_canvas_type *type = v->paper->type;
  const struct dea_symmetry *s = &v->layout->symmetry;
  double step = s->order == 0 ? 2 * atan(1) : s->step_rad;
  double length = hypot(v->box[2] - v->box[0], v->box[3] - v->box[1]), reach = 2 / v->scale;
  type->box(v->paper->canvas, x_of(v, v->box[0] - reach), y_of(v, v->box[1] - reach),
            v->scale * (v->box[2] - v->box[0] + 2 * reach),
            v->scale * (v->box[3] - v->box[1] + 2 * reach));
  type->clip(v->paper->canvas);
  for (size_t k = 0; k < mirror_lines(s); k++) {
    double angle = (s->order == 0 ? 0 : s->mirror_rad) + (double)k * step;
    double x = length * cos(angle), y = length * sin(angle);
    type->line(v->paper->canvas, x_of(v, s->centre_m[0] - x), y_of(v, s->centre_m[1] - y),
               x_of(v, s->centre_m[0] + x), y_of(v, s->centre_m[1] + y));
  }
  type->stroke(v->paper->canvas, 0.2, GREY, 1.2);
  type->unclip(v->paper->canvas);
}

static void draw_plan(const struct view *v)
{
  const struct dea_layout *l = v->layout;
  draw_shapes(v, false);
  draw_frame(v);
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct style style = ply_style(l, i);
    add_region(v, l->plies[i].region);
    paint(v, &style);
  }
  for (size_t i = 0; i < l->electrode_count; i++) {
    const struct style style = channel_style(l->electrodes[i].channel);
    add_region(v, l->electrodes[i].region);
    paint(v, &style);
  }
  draw_shapes(v, true);
  for (size_t i = 0; i < l->body_count; i++) {
    add_region(v, l->bodies[i].region);
    paint(v, &body_style);
  }
  draw_supports(v);
  for (size_t i = 0; i < l->pressure_count; i++) {
    add_region(v, l->pressures[i].region);
    paint(v, &pressure_style);
  }
  draw_symmetry(v);
  draw_monitors(v);
}

/* ---- sizes ---- */

/* Direction of an outline's length: that of its longest straight edge, or between two such as of a
 * strip that tapers; of one that is round, x. */
static void find_axis(const struct dea_contour *contour, double axis[2])
{
  double longest = 0, straight = 0, round = 0, sum[2] = {0, 0};
  for (size_t i = 0; i < dea_contour_pieces(contour); i++) {
    const struct dea_piece piece = dea_contour_piece(contour, i);
    *(piece.arc ? &round : &straight) += piece.length_m;
    longest = fmax(longest, piece.arc ? 0 : piece.length_m);
  }
  for (size_t i = 0; i < dea_contour_pieces(contour); i++) {
    const struct dea_piece piece = dea_contour_piece(contour, i);
    double t[2];
    dea_piece_tangent(&piece, false, t);
    double along = sum[0] == 0 && sum[1] == 0 ? 1 : (sum[0] * t[0] + sum[1] * t[1]);
    if (!piece.arc && piece.length_m > longest * (1 - 1e-6) && fabs(along) > 0.8) {
      sum[0] += along < 0 ? -t[0] : t[0];
      sum[1] += along < 0 ? -t[1] : t[1];
    }
  }
  double length = hypot(sum[0], sum[1]);
  bool flat = round > straight || length == 0 || fabs(sum[0]) < 1e-9 * length;
  axis[0] = flat ? 1 : sum[0] / length;
  axis[1] = flat ? 0 : sum[1] / length;
}

/* Sides of an outline: along its axis and across it. */
static void find_sides(const struct dea_contour *contour, double side[2])
{
  double t[2];
  find_axis(contour, t);
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (size_t i = 0; i < dea_contour_pieces(contour); i++) {
    const struct dea_piece piece = dea_contour_piece(contour, i);
    for (int k = 0; k <= 16; k++) {
      double x[2];
      dea_piece_point(&piece, k / 16.0, x);
      const double along[2] = {x[0] * t[0] + x[1] * t[1], x[1] * t[0] - x[0] * t[1]};
      for (int d = 0; d < 2; d++) {
        low[d] = fmin(low[d], along[d]);
        high[d] = fmax(high[d], along[d]);
      }
    }
  }
  side[0] = high[0] - low[0];
  side[1] = high[1] - low[1];
}

/* The label of an outline: "Ø 30 mm", "40 x 20 mm", with how many there are of its area: "3 x Ø 2
 * mm", "4 of 11 x 2 mm". */
static void write_sides(const struct dea_contour *contour, size_t like, char *out, size_t size)
{
  char a[32], b[32], times[32] = "";
  double side[2], centre[2], radius;
  bool circle = dea_contour_is_circle(contour, centre, &radius);
  if (like > 1) {
    snprintf(times, sizeof times, circle ? "%zu \303\227 " : "%zu of ", like);
  }
  if (circle) {
    dea_length_text(a, sizeof a, 2 * radius);
    snprintf(out, size, "%.20s\303\230 %.16s mm", times, a);
    return;
  }
  find_sides(contour, side);
  dea_length_text(a, sizeof a, side[0]);
  dea_length_text(b, sizeof b, side[1]);
  snprintf(out, size, "%.20s%.16s \303\227 %.16s mm", times, a, b);
}

/* Where the leader of an outline ends: at a circle, or in the middle of its outermost piece. */
static void place_callout(const struct view *v, const struct dea_contour *contour, bool left,
                          struct dea_callout *c)
{
  double centre[2], radius, best = -INFINITY;
  if (dea_contour_is_circle(contour, centre, &radius)) {
    *c = (struct dea_callout){
        .x_mm = x_of(v, centre[0]), .y_mm = y_of(v, centre[1]), .radius_mm = v->scale * radius};
    return;
  }
  for (size_t i = 0; i < dea_contour_pieces(contour); i++) {
    const struct dea_piece piece = dea_contour_piece(contour, i);
    double x[2];
    dea_piece_point(&piece, 0.5, x);
    if ((left ? -x[0] : x[0]) > best + 1e-9) {
      best = left ? -x[0] : x[0];
      *c = (struct dea_callout){.x_mm = x_of(v, x[0]), .y_mm = y_of(v, x[1])};
    }
  }
}

/* Pre-stretch, the same along both axes, of what is printed on a ply or cut of it; else 1. */
static double stretch_of(const struct dea_layout_ply *ply)
{
  return ply->pre_stretch[0] == ply->pre_stretch[1] ? ply->pre_stretch[0] : 1;
}

/* A name with what is said of it, beside the drawing: in two lines where one is too short for both;
 * of a long name the end is cut. */
static void write_note(struct dea_callout *c, const char *name, const char *rest)
{
  enum { LETTERS = 31, DOTS = 3 };
  size_t length = strlen(name);
  if (length + strlen("; ") + strlen(rest) <= LETTERS) {
    snprintf(c->note, sizeof c->note, "%s%s%s", name, rest[0] != '\0' ? "; " : "", rest);
    return;
  }
  snprintf(c->below, sizeof c->below, "%s", rest);
  if (length <= LETTERS) {
    snprintf(c->note, sizeof c->note, "%s", name);
    return;
  }
  length = LETTERS - DOTS;
  while (length > 0 && (name[length] & 0xc0) == 0x80) { // not inside of a letter
    length--;
  }
  snprintf(c->note, sizeof c->note, "%.*s...", (int)length, name);
}

static void set_note(struct dea_callout *c, const char *what, const struct dea_contour *contour,
                     double stretch)
{
  char text[32], rest[25] = "";
  double centre[2], radius;
  if (stretch != 1 && dea_contour_is_circle(contour, centre, &radius)) {
    dea_length_text(text, sizeof text, 2 * radius / stretch);
    snprintf(rest, sizeof rest, "%.10s unstretched", text);
  }
  write_note(c, what, rest);
}

/* Callouts of a region: one for each size of its outlines, the first of them for the holes too. */
static size_t call_out_region(const struct view *v, size_t number, double stretch,
                              struct dea_callout *out, size_t capacity)
{
  const struct dea_layout_region *region = &v->layout->regions[number];
  size_t count = 0;
  for (size_t i = 0; i < region->region.contour_count && count < capacity && count < 2; i++) {
    const struct dea_contour contour = dea_region_contour(&region->region, i);
    double area = dea_contour_area_m2(&contour);
    size_t like = 0, first = region->region.contour_count;
    for (size_t j = 0; j < region->region.contour_count; j++) {
      const struct dea_contour other = dea_region_contour(&region->region, j);
      if (fabs(dea_contour_area_m2(&other) - area) < 1e-6 * fabs(area)) {
        first = j < first ? j : first;
        like++;
      }
    }
    if (first != i) {
      continue;
    }
    struct dea_callout *c = &out[count++];
    place_callout(v, &contour, number % 2 == 1, c);
    write_sides(&contour, like, c->label, sizeof c->label);
    char what[80];
    snprintf(what, sizeof what, "%.50s%s", region->name, area < 0 ? ", inside" : "");
    set_note(c, what, &contour, stretch);
  }
  return count;
}

static size_t call_out_plan(const struct view *v, struct dea_callout *out)
{
  const struct dea_layout *l = v->layout;
  size_t count = 0;
  for (size_t r = 0; r < l->region_count && count < CALLOUTS; r++) {
    double stretch = 0; // 0: no part of this region
    for (size_t i = 0; i < l->body_count; i++) {
      stretch = l->bodies[i].region == r ? 1 : stretch;
    }
    for (size_t i = 0; i < l->ply_count; i++) {
      stretch = l->plies[i].region == r ? stretch_of(&l->plies[i]) : stretch;
    }
    for (size_t i = 0; i < l->electrode_count; i++) {
      const struct dea_layout_electrode *e = &l->electrodes[i];
      stretch = e->region == r ? stretch_of(&l->plies[e->ply]) : stretch;
    }
    count += stretch > 0 ? call_out_region(v, r, stretch, &out[count], CALLOUTS - count) : 0;
  }
  for (size_t i = 0; i < v->drawing->shape_count && count < CALLOUTS; i++) {
    const struct dea_drawn_shape *s = &v->drawing->shapes[i];
    if (s->note != NULL) {
      place_callout(v, &s->contour, false, &out[count]);
      write_sides(&s->contour, 1, out[count].label, sizeof out->label);
      set_note(&out[count++], s->note, &s->contour, s->stretch);
    }
  }
  return count;
}

/* ---- section ---- */

enum { CUTS = 256 };

/* Heights in the section grow with the logarithm of the thickness, so that 10 um and 1 mm both
 * show, and less than that where there are many plies. */
static double section_height(const struct dea_layout *l, size_t ply)
{
  double all = 0, own = 0;
  for (size_t i = 0; i < l->ply_count; i++) {
    double height = 1.2 + 2.4 * fmax(0, log10(l->plies[i].thickness_m / 1e-6));
    own = i == ply ? height : own;
    all += height;
  }
  return own * fmin(1, section_room / all);
}

/* Height of the section: a little above the middle, where no edge runs along it. */
static double cut_y(const struct view *v)
{
  return 0.5 * (v->box[1] + v->box[3]) + 1.234e-4 * (v->box[3] - v->box[1]);
}

/* Places along the section where a region begins or ends are added to x[CUTS]. */
static void add_cuts(const struct view *v, size_t number, double *x, size_t *count)
{
  const struct dea_region *region = &v->layout->regions[number].region;
  double y = cut_y(v);
  const struct dea_piece line = {.from = {v->box[0], y}, .to = {v->box[2], y}};
  for (size_t i = 0; i < region->contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(region, i);
    for (size_t k = 0; k < dea_contour_pieces(&contour); k++) {
      const struct dea_piece piece = dea_contour_piece(&contour, k);
      double at[2][2];
      int found = dea_piece_crossings(&line, &piece, 0, at);
      for (int f = 0; f < found && f < 2 && *count < CUTS; f++) {
        const double place[2] = {at[f][0], at[f][1]};
        if (dea_piece_distance_m(&piece, place) < 1e-9) {
          x[(*count)++] = place[0];
        }
      }
    }
  }
}

/* Where a region is in the section: between x[k] and x[k + 1]. */
static bool is_there(const struct view *v, size_t number, const double *x, size_t k)
{
  return dea_region_inside(&v->layout->regions[number].region, 0.5 * (x[k] + x[k + 1]), cut_y(v));
}

/* Plies are flat: each lies on the highest of what is below it somewhere, and spans the rest. */
static void find_bases(struct view *v, const double *x, size_t count)
{
  const struct dea_layout *l = v->layout;
  for (size_t i = 0; i < l->ply_count && i < PLIES; i++) {
    for (size_t k = 0; k + 1 < count; k++) {
      for (size_t q = is_there(v, l->plies[i].region, x, k) ? i : 0; q-- > 0;) {
        if (is_there(v, l->plies[q].region, x, k)) {
          v->base[i] = fmax(v->base[i], v->base[q] + section_height(l, q));
          break;
        }
      }
    }
  }
}

static double base_of(const struct view *v, size_t ply)
{
  return v->section_y + v->base[ply < PLIES ? ply : PLIES - 1];
}

static void draw_section_ply(const struct view *v, size_t ply, const double *x, size_t count)
{
  const struct dea_canvas_type *type = v->paper->type;
  const struct style style = ply_style(v->layout, ply);
  double height = section_height(v->layout, ply);
  for (size_t k = 0; k + 1 < count;) {
    if (!is_there(v, v->layout->plies[ply].region, x, k)) {
      k++;
      continue;
    }
    double base = base_of(v, ply);
    size_t end = k + 1;
    while (end + 1 < count && is_there(v, v->layout->plies[ply].region, x, end)) {
      end++;
    }
    type->box(v->paper->canvas, x_of(v, x[k]), base, v->scale * (x[end] - x[k]), height);
    type->fill(v->paper->canvas, style.fill, 1, true);
    type->stroke(v->paper->canvas, 0.2, style.line, 0);
    k = end;
  }
}

static void draw_section_electrode(const struct view *v, size_t number, const double *x,
                                   size_t count)
{
  const struct dea_canvas_type *type = v->paper->type;
  const struct dea_layout_electrode *e = &v->layout->electrodes[number];
  for (size_t k = 0; k + 1 < count; k++) {
    if (is_there(v, e->region, x, k) && is_there(v, v->layout->plies[e->ply].region, x, k)) {
      double y = base_of(v, e->ply) + (e->top ? section_height(v->layout, e->ply) : 0);
      type->line(v->paper->canvas, x_of(v, x[k]), y, x_of(v, x[k + 1]), y);
    }
  }
  type->stroke(v->paper->canvas, 0.7, dea_device_drawing_channel(e->channel), 0);
}

/* Clamps at both ends of what is held all around. */
static void draw_clamps(const struct view *v, double top)
{
  const struct dea_canvas_type *type = v->paper->type;
  for (size_t i = 0; i < v->layout->support_count; i++) {
    if (dea_support_is_frame(&v->layout->supports[i])) {
      double box[4];
      dea_region_box_m(&v->layout->regions[v->layout->supports[i].region].region, box);
      type->box(v->paper->canvas, x_of(v, box[0]) - clamp_width, v->section_y - 4, clamp_width,
                top - v->section_y + 8);
      type->box(v->paper->canvas, x_of(v, box[2]), v->section_y - 4, clamp_width,
                top - v->section_y + 8);
      type->fill(v->paper->canvas, FRAME, 1, true);
      type->stroke(v->paper->canvas, 0.2, INK, 0);
    }
  }
}

/* Plies that follow each other and are alike in material, thickness and region. */
static size_t run_of(const struct dea_layout *l, size_t ply)
{
  const struct dea_layout_ply *a = &l->plies[ply];
  size_t end = ply + 1;
  while (end < l->ply_count && l->plies[end].thickness_m == a->thickness_m &&
         l->plies[end].region == a->region && dea_ply_layers(&l->plies[end]) == dea_ply_layers(a) &&
         strcmp(l->plies[end].material.name, a->material.name) == 0) {
    end++;
  }
  return end - ply;
}

/* One label for each run of plies, at its longest stretch of the section. */
static size_t call_out_section(const struct view *v, const double *x, size_t count,
                               struct dea_callout *out)
{
  const struct dea_layout *l = v->layout;
  size_t used = 0;
  for (size_t i = 0; i < l->ply_count && used < CALLOUTS; i += run_of(l, i)) {
    const struct dea_layout_ply *ply = &l->plies[i];
    size_t run = run_of(l, i), best = count;
    bool left = used % 2 == 0;
    for (size_t k = 0; k + 1 < count; k++) { // to the side of its label
      double at = left ? -x[k] - x[k + 1] : x[k] + x[k + 1];
      if (is_there(v, ply->region, x, k) &&
          (best == count || at > (left ? -x[best] - x[best + 1] : x[best] + x[best + 1]))) {
        best = k;
      }
    }
    if (best == count) {
      continue; // the section does not meet it
    }
    struct dea_callout *c = &out[used++];
    double share = left ? 0.3 : 0.7;
    *c = (struct dea_callout){.x_mm = x_of(v, x[best] + share * (x[best + 1] - x[best])),
                              .y_mm = base_of(v, i) + 0.5 * (double)run * section_height(l, i)};
    const size_t layers = dea_ply_layers(ply);
    char times[32] = "";
    if (run * layers > 1) {
      snprintf(times, sizeof times, "%zu \303\227 ", run * layers);
    }
    snprintf(c->label, sizeof c->label, "%s%.4g \302\265m", times,
             1e6 * ply->thickness_m / (double)layers);
    char what[96], rest[25] = "";
    if (run > 1) {
      snprintf(what, sizeof what, "%.40s to %.40s", ply->name, l->plies[i + run - 1].name);
    } else {
      snprintf(what, sizeof what, "%.80s", ply->name);
    }
    if (ply->thickness_m != ply->thickness_unstretched_m) {
      snprintf(rest, sizeof rest, "%.4g unstretched", 1e6 * dea_ply_layer_m(ply));
    }
    write_note(c, what, rest);
  }
  return used;
}

/* Cuts of all parts along the section, in order. */
static size_t find_cuts(const struct view *v, double x[CUTS])
{
  const struct dea_layout *l = v->layout;
  size_t count = 0;
  for (size_t i = 0; i < l->ply_count; i++) {
    add_cuts(v, l->plies[i].region, x, &count);
  }
  for (size_t i = 0; i < l->electrode_count; i++) {
    add_cuts(v, l->electrodes[i].region, x, &count);
  }
  qsort(x, count, sizeof *x, dea_rising);
  return count;
}

/* The box between two heights on the page, beside which labels stand. */
static void views_box(double low, double high, double box[4])
{
  box[0] = middle - 0.5 * plan_width;
  box[1] = low;
  box[2] = middle + 0.5 * plan_width;
  box[3] = high;
}

static void draw_section(const struct view *v)
{
  double x[CUTS], box[4];
  struct dea_callout callouts[CALLOUTS];
  size_t count = find_cuts(v, x);
  views_box(v->section_y, v->section_y + v->section_height, box);
  draw_clamps(v, box[3]);
  for (size_t i = 0; i < v->layout->ply_count; i++) {
    draw_section_ply(v, i, x, count);
  }
  for (size_t i = 0; i < v->layout->electrode_count; i++) {
    draw_section_electrode(v, i, x, count);
  }
  dea_dimensions_callouts(v->paper, box, callouts, call_out_section(v, x, count, callouts));
}

/* ---- legend ---- */

/* Starts a line with a sample of a style and words, and goes on to the next place. */
static void add_key(struct view *v, const struct style *style, const char *format, ...)
    DEA_PRINTF(3, 4);
static void add_key(struct view *v, const struct style *style, const char *format, ...)
{
  char words[WORDS];
  va_list args;
  va_start(args, format);
  vsnprintf(words, sizeof words, format, args);
  va_end(args);
  double column = 0.5 * (page_width - 2 * margin), x = margin + v->column * column;
  if (v->paper != NULL && style != NULL) {
    v->paper->type->box(v->paper->canvas, x, v->key_y - 0.4, 6, 3);
    paint(v, style);
  }
  if (v->paper != NULL) {
    dea_dimensions_fit(v->paper, x + 8, v->key_y, key_size, false, INK, column - 10, words);
  }
  v->column = 1 - v->column;
  v->key_y -= v->column == 0 ? line_height : 0;
}

/* Starts a new line with a heading where there is something to stand below it. */
static void add_heading(struct view *v, size_t count, const char *words)
{
  if (count == 0) {
    return;
  }
  v->key_y -= (v->column == 1 ? line_height : 0) + 1.5;
  v->column = 0;
  draw_text(v, margin, v->key_y, key_size, true, INK, words);
  v->key_y -= line_height;
}

static void add_plies(struct view *v)
{
  const struct dea_layout *l = v->layout;
  add_heading(v, l->ply_count, "Plies, from top to bottom");
  for (size_t i = l->ply_count; i-- > 0;) {
    const struct dea_layout_ply *ply = &l->plies[i];
    const struct style style = ply_style(l, i);
    if (dea_layout_is_dielectric(l, i) && stretch_of(ply) != 1) {
      add_key(v, &style, "%.40s, %.4g \302\265m, %.40s, pre-stretch %.4g", ply->name,
              1e6 * ply->thickness_m, ply->material.name, stretch_of(ply));
    } else {
      add_key(v, &style, "%.40s, %.4g \302\265m, %.60s", ply->name, 1e6 * ply->thickness_m,
              ply->material.name);
    }
  }
}

static void add_channels(struct view *v)
{
  const struct dea_layout *l = v->layout;
  add_heading(v, l->electrode_count,
              "Electrodes, by channel; they have no stiffness but that of plies");
  for (size_t c = 0; c < l->channel_count; c++) {
    const struct style style = channel_style(c);
    const struct dea_layout_channel *channel = &l->channels[c];
    size_t used = 0;
    for (size_t i = 0; i < l->electrode_count; i++) {
      used += l->electrodes[i].channel == c ? 1 : 0;
    }
    if (used == 0) {
      continue;
    }
    if (channel->waveform != NULL) {
      add_key(v, &style, "%.60s, a waveform of its own (%s)", channel->name, channel->waveform);
    } else if (c > 0 && channel->own_V != 0) {
      add_key(v, &style, "%.60s, %.4g \303\227 voltage %+.4g V", channel->name, channel->ratio,
              channel->own_V);
    } else if (c > 0 && channel->ratio != 1) {
      add_key(v, &style, "%.60s, %.4g \303\227 voltage", channel->name, channel->ratio);
    } else {
      add_key(v, &style, "%.60s", channel->name);
    }
  }
}

/* "clamped", "hinged", "held along x, z", or "pulled". */
static const char *hold_of(const struct dea_layout_support *s)
{
  static const char *const held[] = {"held nowhere",    "held along x", "held along y",
                                     "held along x, y", "held along z", "held along x, z",
                                     "held along y, z", "clamped"};
  return s->components == 0 && dea_support_pulls(s) ? "pulled"
         : s->components == 7 && s->hinged          ? "hinged"
                                                    : held[s->components & 7];
}

static void add_supports(struct view *v)
{
  const struct dea_layout *l = v->layout;
  add_heading(v, l->support_count, "Supports");
  for (size_t i = 0; i < l->support_count; i++) {
    const struct dea_layout_support *s = &l->supports[i];
    const struct style style = support_style(s);
    double x = margin + v->column * 0.5 * (page_width - 2 * margin), y = v->key_y - 0.4;
    if (v->paper != NULL && !s->edge) {
      v->paper->type->box(v->paper->canvas, x, y, 6, 3);
      v->paper->type->clip(v->paper->canvas);
      hatch(v, x, y, x + 6, y + 3);
      v->paper->type->unclip(v->paper->canvas);
    }
    bool within = s->within != DEA_LAYOUT_NONE;
    add_key(v, &style, "%.40s%s%s%.40s, %s", l->regions[s->region].name, s->edge ? ", edge" : "",
            within ? " within " : "", within ? l->regions[s->within].name : "", hold_of(s));
  }
}

static void add_bodies_and_pressures(struct view *v)
{
  const struct dea_layout *l = v->layout;
  add_heading(v, l->body_count, "Rigid bodies");
  for (size_t i = 0; i < l->body_count; i++) {
    const struct dea_layout_body *b = &l->bodies[i];
    if (b->mass_kg > 0) {
      add_key(v, &body_style, "%.60s, %.4g g", b->name, 1e3 * b->mass_kg);
    } else {
      add_key(v, &body_style, "%.60s", b->name);
    }
  }
  add_heading(v, l->pressure_count, "Pressures");
  for (size_t i = 0; i < l->pressure_count; i++) {
    const struct dea_layout_pressure *p = &l->pressures[i];
    char what[60];
    if (p->encloses == DEA_OPEN) {
      snprintf(what, sizeof what, "%.4g Pa", p->pressure_Pa);
    } else {
      snprintf(what, sizeof what, "%.4g ml of %s", 1e6 * p->volume_m3,
               p->encloses == DEA_GAS ? "gas" : "liquid");
    }
    add_key(v, &pressure_style, "%.40s, %s on the %s of %.40s", l->regions[p->region].name, what,
            p->top ? "top" : "bottom", l->plies[p->ply].name);
  }
  add_heading(v, l->contact_count, "Contacts");
  for (size_t i = 0; i < l->contact_count; i++) {
    const struct dea_layout_contact *c = &l->contacts[i];
    char what[60];
    if (c->with == DEA_LAYOUT_NONE) {
      snprintf(what, sizeof what, "a plane %.4g mm away", 1e3 * c->gap_m);
    } else {
      snprintf(what, sizeof what, "%.50s", l->plies[c->with].name);
    }
    add_key(v, NULL, "%.40s: %s of %.40s with %s", l->regions[c->region].name,
            c->top ? "top" : "bottom", l->plies[c->ply].name, what);
  }
}

static void add_monitors(struct view *v)
{
  const struct dea_layout *l = v->layout;
  add_heading(v, l->monitor_count, "Monitors");
  for (size_t i = 0; i < l->monitor_count; i++) {
    char number[24];
    double x = margin + v->column * 0.5 * (page_width - 2 * margin);
    snprintf(number, sizeof number, "%zu", i + 1);
    draw_text(v, x + 2, v->key_y, key_size, false, MONITOR, number);
    add_key(v, NULL, "%.80s", l->monitors[i].name);
  }
}

static void add_symmetry(struct view *v)
{
  const struct dea_symmetry *s = &v->layout->symmetry;
  const struct style style = {0, GREY, 0, 0.2, 1.2};
  if (mirror_lines(s) == 0) {
    return;
  }
  add_heading(v, 1, "Symmetry");
  if (s->order == 0) {
    add_key(v, &style, "symmetric to every line there");
  } else {
    add_key(v, &style, "%zu line%s of symmetry", s->mirrors, s->mirrors == 1 ? "" : "s");
  }
}

static void add_legend(struct view *v)
{
  v->column = 0;
  add_plies(v);
  add_channels(v);
  add_supports(v);
  add_bodies_and_pressures(v);
  add_monitors(v);
  add_symmetry(v);
  v->key_y -= v->column == 1 ? line_height : 0;
}

/* ---- the page ---- */

/* A bar of a round length, about a quarter of the plan. */
static void draw_scale_bar(const struct view *v, double y)
{
  const struct dea_canvas_type *type = v->paper->type;
  double wanted = 0.25 * (v->box[2] - v->box[0]), unit = pow(10, floor(log10(wanted)));
  double length = wanted >= 5 * unit ? 5 * unit : wanted >= 2 * unit ? 2 * unit : unit;
  char text[32], words[48];
  dea_length_text(text, sizeof text, length);
  snprintf(words, sizeof words, "%s mm", text);
  type->line(v->paper->canvas, margin, y, margin + v->scale * length, y);
  type->stroke(v->paper->canvas, 0.7, INK, 0);
  draw_text(v, margin, y + 1.5, 2.3, false, GREY, words);
}

/* The box around plies, bodies, and what is drawn beside them. */
static void find_box(struct view *v)
{
  const struct dea_layout *l = v->layout;
  dea_layout_box_m(l, v->box);
  for (size_t i = 0; i < l->body_count; i++) {
    dea_region_grow_box(&l->regions[l->bodies[i].region].region, v->box);
  }
  for (size_t i = 0; i < v->drawing->shape_count; i++) {
    dea_contour_grow_box(&v->drawing->shapes[i].contour, v->box);
  }
  double width = v->box[2] - v->box[0], height = v->box[3] - v->box[1];
  v->scale = fmin(plan_width / width, plan_height / height);
}

/* Heights of all, and from them the page's and where things stand on it. */
static struct view arrange(const struct dea_device_drawing *drawing)
{
  struct view v = {.drawing = drawing, .layout = drawing->layout};
  struct dea_callout callouts[CALLOUTS];
  double box[4], x[CUTS];
  find_box(&v);
  for (size_t i = 0; i < v.layout->ply_count; i++) {
    v.section_height += section_height(v.layout, i);
  }
  views_box(y_of(&v, v.box[1]), y_of(&v, v.box[3]), box);
  v.plan_room = dea_dimensions_height(box, callouts, call_out_plan(&v, callouts)) + 2 * band + 4;
  views_box(v.section_y, v.section_y + v.section_height, box);
  size_t count = find_cuts(&v, x);
  find_bases(&v, x, count);
  size_t used = call_out_section(&v, x, count, callouts);
  double section = fmax(dea_dimensions_height(box, callouts, used), v.section_height + 10) + 6;
  struct view legend = v;
  legend.key_y = 0;
  add_legend(&legend);
  double top = drawing->title != NULL ? head : margin - 6;
  v.height = top + v.plan_room + section_words + section - legend.key_y + margin;
  v.plan_y = v.height - top - 0.5 * v.plan_room;
  v.section_y =
      v.height - top - v.plan_room - section_words - 0.5 * section - 0.5 * v.section_height;
  v.key_y = v.height - top - v.plan_room - section_words - section;
  return v;
}

void dea_device_drawing_size(const struct dea_device_drawing *drawing, double out_mm[2])
{
  const struct view v = arrange(drawing);
  out_mm[0] = page_width;
  out_mm[1] = ceil(v.height);
}

void dea_device_drawing_draw(const struct dea_paper *paper,
                             const struct dea_device_drawing *drawing)
{
  struct view v = arrange(drawing);
  struct dea_callout callouts[CALLOUTS];
  double box[4];
  v.paper = paper;
  if (drawing->title != NULL) {
    dea_dimensions_head(paper, page_width, v.height, drawing->title, drawing->below);
  }
  draw_plan(&v);
  views_box(y_of(&v, v.box[1]), y_of(&v, v.box[3]), box);
  dea_dimensions_callouts(paper, box, callouts, call_out_plan(&v, callouts));
  double words = v.plan_y - 0.5 * v.plan_room;
  draw_scale_bar(&v, words);
  draw_text(&v, margin, words - 7, 2.9, true, INK, "Section along x, through the middle");
  draw_text(&v, margin, words - 11, 2.3, false, GREY, "thickness not to scale");
  draw_section(&v);
  add_legend(&v);
}

dea_status dea_device_drawing_add_svg(const struct dea_device_drawing *drawing, int number,
                                      struct dea_text *out)
{
  struct dea_paper paper = {&dea_canvas_svg, NULL};
  double size[2];
  dea_device_drawing_size(drawing, size);
  void *locale = dea_c_locale_enter();
  if (dea_canvas_svg_begin(out, number, size[0], size[1], &paper.canvas) == DEA_OK) {
    dea_device_drawing_draw(&paper, drawing);
    dea_canvas_svg_end(paper.canvas);
  } else {
    out->failed = true;
  }
  dea_c_locale_leave(locale);
  return out->failed ? DEA_E_MEMORY : DEA_OK;
}
