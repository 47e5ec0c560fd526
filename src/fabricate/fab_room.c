#include "fabricate/fab_room.h"

#include "device/geometry.h"
#include "geometry/boolean.h"

#include <math.h>
#include <string.h>

// Plies and faces --------------------------------------------------------------------------------

bool dea_ply_is_stretched(const struct dea_layout_ply *ply)
{
  return fabs(ply->pre_stretch[0] - 1) > 1e-12 || fabs(ply->pre_stretch[1] - 1) > 1e-12;
}

bool dea_ply_is_held(const struct dea_layout *layout, size_t ply)
{
  for (size_t i = 0; i < layout->support_count; i++) {
    if (dea_support_is_frame(&layout->supports[i]) &&
        layout->supports[i].region == layout->plies[ply].region) {
      return true;
    }
  }
  return false;
}

static bool same_stretch(const struct dea_layout_ply *a, const struct dea_layout_ply *b)
{
  return a->pre_stretch[0] == b->pre_stretch[0] && a->pre_stretch[1] == b->pre_stretch[1] &&
         a->angle_rad == b->angle_rad;
}

size_t dea_ply_like(const struct dea_layout *layout, size_t ply)
{
  const struct dea_layout_ply *p = layout->plies, *own = &p[ply];
  size_t i = 0;
  while (i < ply && !(p[i].region == own->region && p[i].thickness_m == own->thickness_m &&
                      dea_ply_layers(&p[i]) == dea_ply_layers(own) && same_stretch(&p[i], own) &&
                      strcmp(p[i].material.name, own->material.name) == 0)) {
    i++;
  }
  return i;
}

size_t dea_ply_count_like(const struct dea_layout *layout, size_t ply)
{
  size_t count = 0;
  for (size_t i = 0; i < layout->ply_count; i++) {
    count += dea_ply_like(layout, i) == ply ? dea_ply_layers(&layout->plies[i]) : 0;
  }
  return count;
}

static bool lies_on(const struct dea_layout_electrode *electrode, size_t ply, bool top)
{
  return electrode->ply == ply && electrode->top == top;
}

/* Whether every electrode of face `ply` has one of its region on face `other`. */
static bool covers(const struct dea_layout *layout, size_t other, size_t ply, bool top)
{
  const struct dea_layout_electrode *e = layout->electrodes;
  for (size_t i = 0; i < layout->electrode_count; i++) {
    bool found = !lies_on(&e[i], ply, top);
    for (size_t j = 0; j < layout->electrode_count && !found; j++) {
      found = lies_on(&e[j], other, top) && e[j].region == e[i].region;
    }
    if (!found) {
      return false;
    }
  }
  return true;
}

static bool has_electrodes(const struct dea_layout *layout, size_t ply, bool top)
{
  for (size_t i = 0; i < layout->electrode_count; i++) {
    if (lies_on(&layout->electrodes[i], ply, top)) {
      return true;
    }
  }
  return false;
}

size_t dea_face_like(const struct dea_layout *layout, size_t ply, bool top)
{
  if (!has_electrodes(layout, ply, top)) {
    return DEA_LAYOUT_NONE;
  }
  size_t i = 0;
  while (i < ply &&
         !(has_electrodes(layout, i, top) && same_stretch(&layout->plies[i], &layout->plies[ply]) &&
           covers(layout, i, ply, top) && covers(layout, ply, i, top))) {
    i++;
  }
  return i;
}

void dea_ply_stretch(const struct dea_layout_ply *ply, double out[2][2])
{
  double c = cos(ply->angle_rad), s = sin(ply->angle_rad);
  double a = ply->pre_stretch[0], b = ply->pre_stretch[1];
  out[0][0] = a == b ? a : c * c * a + s * s * b; // without rounding where the angle says nothing
  out[1][1] = a == b ? a : s * s * a + c * c * b;
  out[0][1] = out[1][0] = a == b ? 0 : c * s * (a - b);
}

// The room ---------------------------------------------------------------------------------------

/* The largest of the plies' pre-stretches, of two axes their mean: that of lengths which the design
 * gives unstretched. */
static double largest_stretch(const struct dea_layout *layout)
{
  double largest = 1;
  for (size_t i = 0; i < layout->ply_count; i++) {
    const double *l = layout->plies[i].pre_stretch;
    largest = fmax(largest, sqrt(l[0] * l[1]));
  }
  return largest;
}

/* The opening of a frame that stays: all that it holds the edge of. */
static dea_status make_hole(struct dea_context *ctx, const struct dea_layout *layout,
                            struct dea_fab_room *out)
{
  const struct dea_motion still = dea_motion_translation(0, 0);
  struct dea_region all = {.ctx = ctx};
  size_t last = DEA_LAYOUT_NONE, count = 0;
  for (size_t i = 0; i < layout->support_count; i++) {
    size_t region = layout->supports[i].region;
    if (dea_support_is_frame(&layout->supports[i]) && region != last) {
      dea_region_add_moved(&all, &layout->regions[region].region, &still);
      last = region;
      count++;
    }
  }
  out->held = count > 0;
  dea_status status = dea_region_status(&all);
  if (status == DEA_OK && count > 1) {
    status = dea_region_combine(ctx, DEA_UNION, &all, NULL, &out->hole);
  } else if (status == DEA_OK) {
    dea_region_add_moved(&out->hole, &all, &still);
    status = dea_region_status(&out->hole);
  }
  dea_region_free(&all);
  return status;
}

/* Three marks beside the opening. All distances between them differ, so that a sheet that is turned
 * over or around does not fit; the third one's place is the best of some for that. */
static void place_marks(struct dea_fab_room *capacity, double width_m)
{
  static const double share[] = {0.15, -0.1, 0.3, 0.45};
  double x = capacity->opening_m[0] + 0.5 * width_m, y = capacity->opening_m[1] + 0.5 * width_m;
  double best = -1;
  for (size_t i = 0; i < sizeof share / sizeof share[0]; i++) {
    const double at[DEA_FAB_MARKS][2] = {{-x, -0.35 * y}, {x, 0.2 * y}, {share[i] * x, y}};
    double d[DEA_FAB_MARKS];
    for (int k = 0; k < DEA_FAB_MARKS; k++) {
      const double *to = at[(k + 1) % DEA_FAB_MARKS];
      d[k] = hypot(at[k][0] - to[0], at[k][1] - to[1]);
    }
    double least = fmin(fabs(d[0] - d[1]), fmin(fabs(d[1] - d[2]), fabs(d[2] - d[0])));
    if (least > best) {
      best = least;
      memcpy(capacity->mark_at_m, at, sizeof at);
    }
  }
}

static dea_status check(struct dea_context *ctx, const struct dea_fab_geometry *plan,
                        const struct dea_fab_room *capacity)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  double needed = 2 * (capacity->mark_m + plan->feature_m);
  if (needed > f->ring.width_m.si * (1 + 1e-9)) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, f->mark_diameter.length.location,
                                 "alignment marks of %.4g mm diameter (stretched) do not fit on "
                                 "the frame, %.4g mm wide, with %.4g mm (minimum_feature) around "
                                 "them",
                                 2e3 * capacity->mark_m, 1e3 * f->ring.width_m.si,
                                 1e3 * plan->feature_m));
  }
  return dea_fab_check_cutter(ctx, plan);
}

dea_status dea_fab_room_make(struct dea_context *ctx, const struct dea_fab_geometry *plan,
                             struct dea_fab_room *out)
{
  const struct dea_fabrication *f = &plan->design->fabrication;
  const struct dea_layout *layout = plan->device->layout;
  double box[4], l = largest_stretch(layout), width = f->ring.width_m.si;
  *out = (struct dea_fab_room){.hole = {.ctx = ctx}};
  for (size_t i = 0; i < layout->ply_count; i++) {
    out->stretched |= dea_ply_is_stretched(&layout->plies[i]);
  }
  DEA_TRY(ctx, make_hole(ctx, layout, out));
  dea_layout_box_m(layout, box);
  for (size_t i = 0; i < layout->body_count; i++) {
    dea_region_grow_box(&layout->regions[layout->bodies[i].region].region, box);
  }
  if (out->held) {
    dea_region_grow_box(&out->hole, box);
  }
  for (int k = 0; k < 2; k++) {
    out->centre_m[k] = 0.5 * (box[k] + box[2 + k]);
    out->opening_m[k] = 0.5 * (box[2 + k] - box[k]) + (out->held ? 0 : f->frame_gap_m.si);
    out->frame_m[k] = out->opening_m[k] + width;
    out->blank_m[k] = out->frame_m[k] + dea_length_stretched_m(&f->blank.margin, l);
  }
  out->mark_m = 0.5 * dea_length_stretched_m(&f->mark_diameter, l);
  out->grid_m = dea_length_stretched_m(&f->grid_spacing, l);
  out->cross_m = fmin(0.1 * out->grid_m, 0.5e-3 * l);
  place_marks(out, width);
  return check(ctx, plan, out);
}

void dea_fab_room_free(struct dea_fab_room *capacity)
{
  dea_region_free(&capacity->hole);
}
