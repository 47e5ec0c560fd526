#include "fabricate/picture.h"

#include "base/file.h"
#include "fabricate/dimensions.h"
#include "fabricate/parts.h"

#include <math.h>
#include <stdio.h>

enum {
  INK = 0x202020,
  GREY = 0x6a6a6a,
  RING = 0xc9ced6,
  FILM = 0xe3eef8,
  ELECTRODE = 0x4a4f57,
  FIBRE = 0xe69f00,
  GLUE = 0x56b4e9
};

static const double page_width = 170, page_height = 176;
static const double ring_radius = 32;        // of the ring in the top view
static const double top_x = 85, top_y = 108; // centre of the top view
static const double section_y = 34;          // middle of the film in the section
static const double film_height = 5;         // of the film in the section

struct picture {
  const struct dea_paper *paper;
  const struct dea_workshop *w;
  struct dea_part parts; // contours that are drawn
  double scale;          // mm on the page per metre
};

void dea_picture_size(const struct dea_workshop *workshop, double out_mm[2])
{
  (void)workshop;
  out_mm[0] = page_width;
  out_mm[1] = page_height;
}

/* ---- top view ---- */

/* Paints contours from `first` on. */
static void paint(struct picture *p, size_t first, unsigned colour, double opacity, double dash)
{
  const struct dea_canvas_type *type = p->paper->type;
  for (size_t i = first; i < p->parts.contour_count; i++) {
    const struct dea_contour contour = dea_part_contour_get(&p->parts, i);
    type->contour(p->paper->canvas, &contour, p->scale, top_x, top_y);
  }
  if (opacity > 0) {
    type->fill(p->paper->canvas, colour, opacity, true);
  }
  type->stroke(p->paper->canvas, 0.2, INK, dash);
}

static void draw_top(struct picture *p)
{
  static const struct dea_location nowhere = {0};
  const struct dea_fab_geometry *plan = &p->w->plan;
  struct dea_part *parts = &p->parts;
  dea_part_circle(parts, DEA_LAYER_MARK, 0, 0, plan->ring_m, nowhere);
  paint(p, 0, RING, 1, 0);
  size_t first = parts->contour_count;
  dea_part_circle(parts, DEA_LAYER_MARK, 0, 0, plan->frame_m, nowhere);
  paint(p, first, FILM, 1, 0);
  first = parts->contour_count;
  dea_draw_electrode(plan, DEA_FAB_BOTTOM, false, 1, DEA_LAYER_MARK, parts);
  paint(p, first, ELECTRODE, 0.25, 0.8);
  first = parts->contour_count;
  dea_draw_electrode(plan, DEA_FAB_TOP, false, 1, DEA_LAYER_MARK, parts);
  paint(p, first, ELECTRODE, 1, 0);
  for (int k = 0; k < plan->device->fibre_count; k++) {
    first = parts->contour_count;
    dea_draw_anchor(plan, k, DEA_LAYER_MARK, parts);
    dea_draw_fibre(plan, k, DEA_LAYER_MARK, parts);
    paint(p, first, FIBRE, 0.9, 0);
  }
  first = parts->contour_count;
  dea_draw_marks(plan, false, 1, DEA_LAYER_MARK, parts);
  paint(p, first, 0xffffff, 1, 0);
  dea_dimensions_centre(p->paper, top_x, top_y, p->scale * plan->ring_m + 4);
}

static void set_note(struct dea_callout *c, const char *what, double length, double stretch)
{
  char text[32];
  dea_length_text(text, sizeof text, length / stretch);
  snprintf(c->note, sizeof c->note, stretch != 1 ? "%s; %s unstretched" : "%s", what, text);
}

static void add_round(struct picture *p, struct dea_callout *c, double x, double y, double radius,
                      const char *what, double stretch)
{
  char text[32];
  *c = (struct dea_callout){
      .x_mm = top_x + p->scale * x, .y_mm = top_y + p->scale * y, .radius_mm = p->scale * radius};
  dea_length_text(text, sizeof text, 2 * radius);
  snprintf(c->label, sizeof c->label, "\xc3\x98 %s mm", text);
  set_note(c, what, 2 * radius, stretch);
}

/* A dimension line of the top view with its label. */
static void add_length(struct picture *p, struct dea_callout *c, const double from[2],
                       const double to[2], const char *what, double stretch)
{
  const double a[2] = {top_x + p->scale * from[0], top_y + p->scale * from[1]};
  const double b[2] = {top_x + p->scale * to[0], top_y + p->scale * to[1]};
  char text[32];
  double length = hypot(to[0] - from[0], to[1] - from[1]);
  *c = (struct dea_callout){0};
  dea_dimensions_dimension(p->paper, a, b, c);
  dea_length_text(text, sizeof text, length);
  snprintf(c->label, sizeof c->label, "%s mm", text);
  set_note(c, what, length, stretch);
}

static size_t add_fibre_lengths(struct picture *p, struct dea_callout *out)
{
  const struct dea_device *d = p->w->plan.device;
  double outer = p->w->plan.fibre_outer_m, tip = d->fibre_tip_radius_m;
  double half = 0.5 * d->fibre_width_m, tip_half = 0.5 * d->fibre_tip_width_m;
  size_t n = 0;
  double below = -(half + 3.5 / p->scale); // the line; its ends go down from the fibre to it
  const double length[2][2] = {{tip, below}, {outer, below}};
  for (int end = 0; end < 2; end++) {
    double x = top_x + p->scale * length[end][0], y = top_y + p->scale * below;
    p->paper->type->line(p->paper->canvas, x, y - 1, x, top_y - p->scale * tip_half - 0.6);
  }
  p->paper->type->stroke(p->paper->canvas, 0.13, INK, 0);
  add_length(p, &out[n++], length[0], length[1], "fibre", 1);
  double at = outer - 0.25 * (outer - tip);
  double w = tip_half + (half - tip_half) * 0.75; // at that place of a taper
  const double width[2][2] = {{at, -w}, {at, w}};
  add_length(p, &out[n], width[0], width[1], "width of a fibre", 1);
  if (tip_half != half) {
    char ends[2][32];
    dea_length_text(ends[0], sizeof ends[0], 2 * half);
    dea_length_text(ends[1], sizeof ends[1], 2 * tip_half);
    snprintf(out[n].label, sizeof out[n].label, "%s to %s mm", ends[0], ends[1]);
  }
  return n + 1;
}

static void label_top(struct picture *p)
{
  const struct dea_fab_geometry *plan = &p->w->plan;
  struct dea_callout c[8];
  size_t n = 0;
  double r = p->scale * plan->ring_m;
  const double box[4] = {top_x - r, top_y - r, top_x + r, top_y + r};
  add_round(p, &c[n++], 0, 0, plan->frame_m, "frame, inside", 1);
  add_round(p, &c[n++], 0, 0, plan->electrode_m, "electrode", plan->stretch);
  double a = plan->lead_angle_rad[DEA_FAB_TOP], b = plan->lead_angle_rad[DEA_FAB_BOTTOM];
  add_round(p, &c[n++], plan->pad_centre_m * cos(a), plan->pad_centre_m * sin(a), plan->pad_m,
            "pad above", plan->stretch);
  add_round(p, &c[n++], plan->pad_centre_m * cos(b), plan->pad_centre_m * sin(b), plan->pad_m,
            "pad below", plan->stretch);
  if (plan->device->fibre_count > 0) {
    n += add_fibre_lengths(p, &c[n]);
  }
  dea_dimensions_callouts(p->paper, box, c, n);
}

/* ---- section along the first fibre ---- */

/* A layer of the section: from x0 to x1 [m], between two heights [mm] over the film's middle. */
static void layer(struct picture *p, double x0, double x1, double low, double high, unsigned colour)
{
  const struct dea_canvas_type *type = p->paper->type;
  type->box(p->paper->canvas, top_x + p->scale * x0, section_y + low, p->scale * (x1 - x0),
            high - low);
  type->fill(p->paper->canvas, colour, 1, true);
  type->stroke(p->paper->canvas, 0.2, INK, 0);
}

/* Heights of what lies on the film: drawn so that all is seen, thicker things higher. */
struct heights {
  double film, electrode, bond, fibre; // half of the film's; the others' own
};

static struct heights choose_heights(const struct dea_device *d)
{
  double unit = film_height / d->film_thickness_m; // mm per metre of thickness
  struct heights h = {.film = 0.5 * film_height, .electrode = 1};
  h.bond = d->bond_thickness_m > 0 ? fmin(fmax(unit * d->bond_thickness_m, 0.8), 4) : 0;
  h.fibre = d->fibre_count > 0 ? fmin(fmax(unit * d->fibre_thickness_m, 1.5), 10) : 0;
  return h;
}

static void draw_section(struct picture *p, const struct heights *h)
{
  const struct dea_fab_geometry *plan = &p->w->plan;
  const struct dea_device *d = plan->device;
  double R = plan->frame_m, o = plan->ring_m, r = plan->electrode_m, top = h->film;
  layer(p, -o, -R, -top - 6, -top, RING);
  layer(p, R, o, -top - 6, -top, RING);
  layer(p, -o, o, -top, top, FILM);
  layer(p, -r, r, top, top + h->electrode, ELECTRODE);
  layer(p, -r, r, -top - h->electrode, -top, ELECTRODE);
  bool both = d->fibre_count % 2 == 0; // a fibre opposite of the first one
  for (int side = -1; side <= 1 && d->fibre_count > 0; side += 2) {
    double tip = d->fibre_tip_radius_m, end = plan->fibre_end_m;
    double from = side > 0 ? tip : -end, to = side > 0 ? end : -tip;
    double base = top + (tip < r ? h->electrode : 0);
    if (side < 0 && !both) {
      continue;
    }
    if (h->bond > 0) {
      layer(p, from, to, base, base + h->bond, GLUE);
    }
    layer(p, from, to, base + h->bond, base + h->bond + h->fibre, FIBRE);
  }
}

static void add_layer_label(struct picture *p, struct dea_callout *c, double x, double height,
                            const char *what, double thickness, double unstretched)
{
  *c = (struct dea_callout){.x_mm = top_x + p->scale * x, .y_mm = section_y + height};
  if (thickness > 0) {
    snprintf(c->label, sizeof c->label, "%.4g \xc2\xb5m", 1e6 * thickness);
  } else {
    snprintf(c->label, sizeof c->label, "not given");
  }
  if (unstretched > 0) {
    snprintf(c->note, sizeof c->note, "%s; %.4g unstretched", what, 1e6 * unstretched);
  } else {
    snprintf(c->note, sizeof c->note, "%s", what);
  }
}

static void label_section(struct picture *p, const struct heights *h)
{
  const struct dea_fab_geometry *plan = &p->w->plan;
  const struct dea_device *d = plan->device;
  double l = plan->stretch, o = p->scale * plan->ring_m, t = d->electrode_thickness_m;
  const double box[4] = {top_x - o, section_y - 11, top_x + o, section_y + 13};
  double base = h->film + (d->fibre_tip_radius_m < plan->electrode_m ? h->electrode : 0);
  double fibre = d->fibre_tip_radius_m + 0.7 * (plan->frame_m - d->fibre_tip_radius_m);
  struct dea_callout c[5];
  size_t n = 0;
  bool stretched = l > 1;
  add_layer_label(p, &c[n++], -0.5 * (plan->electrode_m + plan->frame_m), -0.5 * h->film, "film",
                  d->film_thickness_m, stretched ? d->film_thickness_unstretched_m : 0);
  add_layer_label(p, &c[n++], -0.5 * plan->electrode_m, h->film + 0.5 * h->electrode,
                  "electrodes, each", t / (l * l), stretched ? t : 0);
  if (d->fibre_count > 0) {
    add_layer_label(p, &c[n++], fibre, base + h->bond + 0.5 * h->fibre, "fibre",
                    d->fibre_thickness_m, 0);
    if (h->bond > 0) {
      add_layer_label(p, &c[n++], fibre, base + 0.5 * h->bond, "glue", d->bond_thickness_m, 0);
    }
  }
  dea_dimensions_callouts(p->paper, box, c, n);
}

static void write_words(struct picture *p)
{
  const struct dea_fab_geometry *plan = &p->w->plan;
  const struct dea_canvas_type *type = p->paper->type;
  const char *title = plan->design->title.text;
  char below[256];
  snprintf(below, sizeof below,
           "%.80s; pre-stretch %.4g; film %.60s; lengths in the stretched film",
           dea_path_name(plan->design->file), plan->stretch, plan->device->film.name);
  dea_dimensions_head(p->paper, page_width, page_height,
                      title[0] != '\0' ? title : dea_path_name(plan->design->file), below);
  type->text(p->paper->canvas, 12, 60.5, 2.6, 0, DEA_ALIGN_LEFT, true, INK,
             plan->device->fibre_count > 0 ? "Section along the first fibre" : "Section");
  type->text(p->paper->canvas, 12, 56.8, 2.3, 0, DEA_ALIGN_LEFT, false, GREY,
             "thickness not to scale");
  double bar = pow(10, floor(log10(20 / p->scale))); // the largest round length below 20 mm
  bar *= 5 * bar * p->scale < 20 ? 5 : 2 * bar * p->scale < 20 ? 2 : 1;
  char text[32], words[40];
  dea_length_text(text, sizeof text, bar);
  snprintf(words, sizeof words, "%s mm", text);
  type->line(p->paper->canvas, 12, 10, 12 + bar * p->scale, 10);
  type->stroke(p->paper->canvas, 0.7, INK, 0);
  type->text(p->paper->canvas, 12, 11.5, 2.3, 0, DEA_ALIGN_LEFT, false, GREY, words);
}

void dea_picture_draw(const struct dea_paper *paper, const struct dea_workshop *workshop)
{
  struct picture p = {.paper = paper,
                      .w = workshop,
                      .parts = {.ctx = workshop->part[0].ctx},
                      .scale = ring_radius / workshop->plan.ring_m};
  struct heights h = choose_heights(workshop->plan.device);
  write_words(&p);
  draw_top(&p);
  label_top(&p);
  draw_section(&p, &h);
  label_section(&p, &h);
  dea_part_free(&p.parts);
}
