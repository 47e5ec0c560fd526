#include "fabricate/picture.h"

#include "base/file.h"
#include "figures/device_drawing.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FRAME = 0xc9ced6, FIBRE = 0xe0a04a, WHITE = 0xffffff };

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

static void add_region(struct picture *p, const struct dea_region *region,
                       const struct dea_drawn_shape *look)
{
  for (size_t i = 0; i < region->contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(region, i);
    dea_part_add(&p->parts, DEA_LAYER_MARK, contour.vertex, contour.count, false);
    next(p, look);
  }
}

static void add_box(struct picture *p, const struct dea_fab_plan *plan, const double half[2],
                    const struct dea_drawn_shape *look)
{
  struct dea_vertex v[4] = {{0}};
  if (plan->round) {
    add_circle(p, plan->centre_m[0], plan->centre_m[1], half[0], look);
    return;
  }
  for (int k = 0; k < 4; k++) {
    v[k].x_m = plan->centre_m[0] + (k == 0 || k == 3 ? half[0] : -half[0]);
    v[k].y_m = plan->centre_m[1] + (k < 2 ? half[1] : -half[1]);
  }
  dea_part_add(&p->parts, DEA_LAYER_MARK, v, 4, false);
  next(p, look);
}

static void add_leads(struct picture *p, const struct dea_fab_plan *plan)
{
  for (size_t i = 0; i < plan->pad_count; i++) {
    const struct dea_layout_electrode *e = &plan->layout->electrodes[plan->pad[i].electrode];
    const bool ground = e->channel == 0;
    const struct dea_drawn_shape lead = {.over = true,
                                         .colour = dea_device_drawing_channel(e->channel),
                                         .opacity = ground ? 0.1 : 0.25,
                                         .dash_mm = ground ? 0.8 : 0};
    const struct dea_drawn_shape pad = {
        .over = true, .note = e->top ? "pad above" : "pad below", .stretch = plan->stretch};
    add_region(p, &plan->inked[plan->pad[i].electrode], &lead);
    add_circle(p, plan->centre_m[0] + plan->pad[i].at_m[0],
               plan->centre_m[1] + plan->pad[i].at_m[1], plan->pad_m, &pad);
  }
}

static void add_frame(struct picture *p, const struct dea_fab_plan *plan)
{
  const struct dea_drawn_shape frame = {
      .colour = FRAME, .opacity = 1, .note = "frame, outside", .stretch = 1};
  const struct dea_drawn_shape hole = {.colour = WHITE, .opacity = 1};
  const struct dea_drawn_shape anchor = {.colour = FIBRE, .opacity = 0.85};
  const struct dea_drawn_shape mark = {.over = true, .colour = WHITE, .opacity = 1};
  add_box(p, plan, plan->frame_m, &frame);
  if (plan->held) {
    add_region(p, &plan->hole, &hole);
  } else {
    add_box(p, plan, plan->opening_m, &hole);
  }
  add_region(p, &plan->bonded, &anchor);
  for (int m = 0; m < DEA_FAB_MARKS; m++) {
    add_circle(p, plan->centre_m[0] + plan->mark_at_m[m][0],
               plan->centre_m[1] + plan->mark_at_m[m][1], plan->mark_m, &mark);
  }
}

/* p: zero; to be freed. */
static void build(struct picture *p, const struct dea_workshop *w)
{
  const struct dea_fab_plan *plan = &w->plan;
  const struct dea_layout_ply *film = dea_layout_film(plan->layout);
  const char *title = plan->design->title.text, *file = dea_path_name(plan->design->file);
  char of[128] = "";
  p->parts.ctx = w->memory.ctx;
  if (film != NULL && film->pre_stretch[0] == film->pre_stretch[1]) {
    snprintf(of, sizeof of, "; pre-stretch %.4g; film %.60s", film->pre_stretch[0],
             film->material.name);
  }
  snprintf(p->below, sizeof p->below, "%.80s%s; lengths in the %s film", file, of,
           plan->stretched ? "stretched" : "flat");
  if (dea_workshop_part(w, DEA_PART_FRAME, 0) != NULL) {
    add_frame(p, plan);
    add_leads(p, plan);
  }
  size_t count = p->parts.failed ? 0 : p->parts.contour_count;
  for (size_t i = 0; i < count; i++) {
    p->shapes[i].contour = dea_part_contour_get(&p->parts, i);
  }
  p->drawing = (struct dea_device_drawing){plan->layout, title[0] != '\0' ? title : file, p->below,
                                           p->shapes, count};
}

static void destroy(struct picture *p)
{
  dea_free(p->parts.ctx, p->shapes);
  dea_part_free(&p->parts);
}

void dea_picture_size(const struct dea_workshop *workshop, double out_mm[2])
{
  struct picture p = {0};
  build(&p, workshop);
  dea_device_drawing_size(&p.drawing, out_mm);
  destroy(&p);
}

void dea_picture_draw(const struct dea_paper *paper, const struct dea_workshop *workshop)
{
  struct picture p = {0};
  build(&p, workshop);
  dea_device_drawing_draw(paper, &p.drawing);
  destroy(&p);
}
