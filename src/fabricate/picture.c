#include "fabricate/picture.h"

#include "base/file.h"
#include "figures/device_drawing.h"

#include <stdio.h>

enum { FRAME = 0xc9ced6, FIBRE = 0xe0a04a, WHITE = 0xffffff };

/* What the workshop adds to the drawing of the device: contours and their looks. */
struct picture {
  struct dea_context *ctx;
  struct dea_drawn_shape *shapes; // [count] owned
  size_t count, capacity;
  bool failed; // for want of memory
  char below[256];
  struct dea_device_drawing drawing;
};

static void add(struct picture *p, struct dea_contour contour, const struct dea_drawn_shape *look)
{
  p->failed = p->failed || dea_array_grow(p->ctx, &p->shapes, p->count, &p->capacity,
                                          sizeof *p->shapes) != DEA_OK;
  if (!p->failed) {
    p->shapes[p->count] = *look;
    p->shapes[p->count++].contour = contour;
  }
}

static void add_region(struct picture *p, const struct dea_region *region,
                       const struct dea_drawn_shape *look)
{
  for (size_t i = 0; i < region->contour_count; i++) {
    add(p, dea_region_contour(region, i), look);
  }
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
    add(p, dea_region_contour(&plan->pads, i), &pad);
  }
}

static void add_frame(struct picture *p, const struct dea_fab_plan *plan)
{
  const struct dea_drawn_shape frame = {
      .colour = FRAME, .opacity = 1, .note = "frame, outside", .stretch = 1};
  const struct dea_drawn_shape hole = {.colour = WHITE, .opacity = 1};
  const struct dea_drawn_shape anchor = {.colour = FIBRE, .opacity = 0.85};
  const struct dea_drawn_shape mark = {.over = true, .colour = WHITE, .opacity = 1};
  add_region(p, &plan->frame, &frame);
  add_region(p, &plan->hole, &hole);
  add_region(p, &plan->bonded, &anchor);
  add_region(p, &plan->marks, &mark);
}

/* p: zero; to be freed. */
static void build(struct picture *p, const struct dea_workshop *w)
{
  const struct dea_fab_plan *plan = &w->plan;
  const struct dea_layout_ply *film = dea_layout_film(plan->layout);
  const char *title = plan->design->title.text, *file = dea_path_name(plan->design->file);
  char of[128] = "";
  p->ctx = w->memory.ctx;
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
  p->drawing = (struct dea_device_drawing){plan->layout, title[0] != '\0' ? title : file, p->below,
                                           p->shapes, p->count};
}

dea_status dea_picture_size(const struct dea_workshop *workshop, double out_mm[2])
{
  struct picture p = {0};
  build(&p, workshop);
  dea_device_drawing_size(&p.drawing, out_mm);
  dea_free(p.ctx, p.shapes);
  return p.failed ? DEA_E_MEMORY : DEA_OK;
}

dea_status dea_picture_draw(const struct dea_paper *paper, const struct dea_workshop *workshop)
{
  struct picture p = {0};
  build(&p, workshop);
  dea_device_drawing_draw(paper, &p.drawing);
  dea_free(p.ctx, p.shapes);
  return p.failed ? DEA_E_MEMORY : DEA_OK;
}
