#include "fabricate/picture.h"

#include "base/file.h"
#include "fabricate/layout_parts.h"
#include "fabricate/part_list.h"
#include "figures/device_drawing.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FRAME = 0xc9ced6, GROUND = 0x707070, DRIVE = 0x0072b2, FIBRE = 0xe0a04a, WHITE = 0xffffff };

static const struct dea_location nowhere = {0};

/* What the workshop adds to the drawing of the device: contours and their looks. */
struct picture {
  struct dea_part parts;          // contours
  struct dea_drawn_shape *shapes; // [parts.contour_count] owned; NULL when memory is short
  char below[256];
  struct dea_device_drawing drawing;
};

/* Room for the looks of one contour more; NULL when memory is short. */
static struct dea_drawn_shape *next(struct picture *p, const struct dea_drawn_shape *look)
{
  size_t count = p->parts.contour_count;
  void *bigger =
      p->parts.failed ? NULL : dea_resize(p->parts.ctx, p->shapes, count, sizeof *p->shapes);
  if (bigger == NULL) {
    p->parts.failed = true;
    return NULL;
  }
  p->shapes = bigger;
  p->shapes[count - 1] = *look;
  return &p->shapes[count - 1];
}

static void add_circle(struct picture *p, double x, double y, double radius,
                       const struct dea_drawn_shape *look)
{
  dea_part_circle(&p->parts, DEA_LAYER_MARK, x, y, radius, nowhere);
  next(p, look);
}

static void add_electrode(struct picture *p, const struct dea_fab_geometry *plan,
                          enum dea_fab_geometry_side side)
{
  bool top = side == DEA_FAB_TOP;
  double angle = plan->lead_angle_rad[side], r = plan->pad_centre_m;
  const struct dea_drawn_shape lead = {.over = true,
                                       .colour = top ? DRIVE : GROUND,
                                       .opacity = top ? 0.25 : 0.1,
                                       .dash_mm = top ? 0 : 0.8};
  const struct dea_drawn_shape pad = {
      .over = true, .note = top ? "pad above" : "pad below", .stretch = plan->stretch};
  dea_draw_electrode(plan, side, false, 1, DEA_LAYER_MARK, &p->parts);
  next(p, &lead);
  add_circle(p, r * cos(angle), r * sin(angle), plan->pad_m, &pad);
}

static void add_marks(struct picture *p, double x, double y, double at_m[DEA_FAB_MARKS][2],
                      double radius)
{
  const struct dea_drawn_shape mark = {.over = true, .colour = WHITE, .opacity = 1};
  for (int m = 0; m < DEA_FAB_MARKS; m++) {
    add_circle(p, x + at_m[m][0], y + at_m[m][1], radius, &mark);
  }
}

static void add_disc(struct picture *p, const struct dea_fab_geometry *plan)
{
  const struct dea_drawn_shape ring = {
      .colour = FRAME, .opacity = 1, .note = "frame, outside", .stretch = 1};
  const struct dea_drawn_shape hole = {.colour = WHITE, .opacity = 1};
  const struct dea_drawn_shape anchor = {.over = true, .colour = FIBRE, .opacity = 0.85};
  double marks[DEA_FAB_MARKS][2];
  add_circle(p, 0, 0, plan->ring_m, &ring);
  add_circle(p, 0, 0, plan->frame_m, &hole);
  add_electrode(p, plan, DEA_FAB_BOTTOM);
  add_electrode(p, plan, DEA_FAB_TOP);
  for (int k = 0; k < plan->device->fibre_count; k++) {
    size_t before = p->parts.contour_count;
    dea_draw_anchor(plan, k, DEA_LAYER_MARK, &p->parts);
    if (p->parts.contour_count > before) { // a free fibre has none
      next(p, &anchor);
    }
  }
  for (int m = 0; m < DEA_FAB_MARKS; m++) {
    marks[m][0] = plan->mark_centre_m * cos(plan->mark_angle_rad[m]);
    marks[m][1] = plan->mark_centre_m * sin(plan->mark_angle_rad[m]);
  }
  add_marks(p, 0, 0, marks, plan->mark_m);
}

static void add_box(struct picture *p, const double centre[2], const double half[2],
                    const struct dea_drawn_shape *look)
{
  struct dea_vertex v[4] = {{0}};
  for (int k = 0; k < 4; k++) {
    v[k].x_m = centre[0] + (k == 0 || k == 3 ? half[0] : -half[0]);
    v[k].y_m = centre[1] + (k < 2 ? half[1] : -half[1]);
  }
  dea_part_add(&p->parts, DEA_LAYER_MARK, v, 4, false);
  next(p, look);
}

static void add_frame(struct picture *p, const struct dea_workshop *w)
{
  const struct dea_fab_room *capacity = &w->capacity;
  const struct dea_drawn_shape frame = {
      .colour = FRAME, .opacity = 1, .note = "frame, outside", .stretch = 1};
  const struct dea_drawn_shape hole = {.colour = WHITE, .opacity = 1};
  add_box(p, capacity->centre_m, capacity->frame_m, &frame);
  for (size_t i = 0; capacity->held && i < capacity->hole.contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(&capacity->hole, i);
    dea_part_add(&p->parts, DEA_LAYER_MARK, contour.vertex, contour.count, false);
    next(p, &hole);
  }
  if (!capacity->held) {
    add_box(p, capacity->centre_m, capacity->opening_m, &hole);
  }
  double marks[DEA_FAB_MARKS][2];
  memcpy(marks, capacity->mark_at_m, sizeof marks);
  add_marks(p, capacity->centre_m[0], capacity->centre_m[1], marks, capacity->mark_m);
}

/* p: zero; to be freed. */
static void make(struct picture *p, const struct dea_workshop *w)
{
  const struct dea_fab_geometry *plan = &w->plan;
  const char *title = plan->design->title.text, *file = dea_path_name(plan->design->file);
  p->parts.ctx = w->memory.ctx;
  if (plan->design->parts != NULL) {
    snprintf(p->below, sizeof p->below, "%.80s; lengths in the flat film", file);
    if (dea_layout_has_frame(w)) {
      add_frame(p, w);
    }
  } else {
    snprintf(p->below, sizeof p->below,
             "%.80s; pre-stretch %.4g; film %.60s; lengths in the stretched film", file,
             plan->stretch, plan->device->film.name);
    add_disc(p, plan);
  }
  size_t count = p->parts.failed ? 0 : p->parts.contour_count;
  for (size_t i = 0; i < count; i++) {
    p->shapes[i].contour = dea_part_contour_get(&p->parts, i);
  }
  p->drawing = (struct dea_device_drawing){plan->device->layout, title[0] != '\0' ? title : file,
                                           p->below, p->shapes, count};
}

static void destroy(struct picture *p)
{
  dea_free(p->parts.ctx, p->shapes);
  dea_part_free(&p->parts);
}

void dea_picture_size(const struct dea_workshop *workshop, double out_mm[2])
{
  struct picture p = {0};
  make(&p, workshop);
  dea_device_drawing_size(&p.drawing, out_mm);
  destroy(&p);
}

void dea_picture_draw(const struct dea_paper *paper, const struct dea_workshop *workshop)
{
  struct picture p = {0};
  make(&p, workshop);
  dea_device_drawing_draw(paper, &p.drawing);
  destroy(&p);
}
