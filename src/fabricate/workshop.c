#include "fabricate/workshop.h"

#include "fabricate/layout_parts.h"

#include <math.h>

/* ---- sheets ---- */

/* Half the sides of the largest part of a film state, with its cut around it. */
static void half_size(const struct dea_workshop *w, enum dea_film_state state, bool paper,
                      double half_m[2])
{
  half_m[0] = half_m[1] = 0;
  for (size_t i = 0; i < w->count; i++) {
    const struct dea_part *part = &w->part[i];
    if (part->state == state && part->paper == paper) {
      double box[4];
      dea_part_box(part, box);
      for (int k = 0; k < 2; k++) {
        half_m[k] = fmax(half_m[k], fmax(-box[k], box[2 + k]));
      }
    }
  }
  for (int k = 0; k < 2; k++) {
    half_m[k] += paper ? 0 : 0.5 * w->plan.kerf_m;
  }
}

/* Paper is as large as it has to be. */
static struct dea_sheet_layout paper_layout(const double half_m[2], double margin)
{
  double across = 2 * (half_m[0] + margin), up = 2 * (half_m[1] + margin);
  return (struct dea_sheet_layout){across, up, {0.5 * across, 0.5 * up}, {across, up}, 1, 1, false};
}

static double whole(double number)
{
  return floor(number + 1e-9);
}

static dea_status sheet_layout(struct dea_context *ctx, const struct dea_workshop *w,
                               const struct dea_part *part, struct dea_sheet_layout *out)
{
  const struct dea_fabrication *f = &w->plan.design->fabrication;
  double margin = f->sheet.margin_m.si, gap = f->sheet.gap_m.si;
  double half[2];
  half_size(w, part->state, false, half);
  const double pitch[2] = {2 * half[0] + gap, 2 * half[1] + gap};
  double across = f->sheet.width_m.si, up = f->sheet.height_m.si;
  double columns = fmax(0, whole((across - 2 * margin + gap) / pitch[0]));
  double rows = fmax(0, whole((up - 2 * margin + gap) / pitch[1]));
  *out = (struct dea_sheet_layout){
      .width_m = across,
      .height_m = up,
      .first_m = {part->mirrored ? across - margin - half[0] : margin + half[0],
                  up - margin - half[1]},
      .pitch_m = {pitch[0], pitch[1]},
      .columns = (int)fmin(columns, DEA_DESIGN_COPIES_MAX),
      .count = w->plan.copies,
      .mirrored = part->mirrored};
  if (columns * rows >= w->plan.copies) {
    return DEA_OK;
  }
  if (columns * rows >= 1) {
    return dea_finding_add(ctx, DEA_ERROR, f->copies.location,
                           "copies: a sheet of %.4g mm x %.4g mm takes %.0f of the part '%s', not "
                           "%d",
                           1e3 * across, 1e3 * up, columns * rows, part->name, w->plan.copies);
  }
  return dea_finding_add(
      ctx, DEA_ERROR, columns < 1 ? f->sheet.width_m.location : f->sheet.height_m.location,
      "a sheet of %.4g mm x %.4g mm is too small for the part '%s' of %.4g mm, "
      "with a margin of %.4g mm",
      1e3 * across, 1e3 * up, part->name, 2e3 * half[columns < 1 ? 0 : 1], 1e3 * margin);
}

void dea_sheet_place(const struct dea_sheet_layout *layout, int copy, double out_m[2])
{
  const int row = copy / layout->columns;
  double offset_m = copy % layout->columns * layout->pitch_m[0];
  out_m[0] = layout->first_m[0] + (layout->mirrored ? -offset_m : offset_m);
  out_m[1] = layout->first_m[1] - row * layout->pitch_m[1];
}

/* ---- all of it ---- */

static dea_status check_parts(struct dea_context *ctx, const struct dea_workshop *w)
{
  for (size_t i = 0; i < w->count; i++) {
    DEA_TRY(ctx, dea_part_check(&w->part[i], w->plan.feature_m, w->plan.kerf_m));
  }
  return DEA_OK;
}

static dea_status lay_out(struct dea_context *ctx, struct dea_workshop *w)
{
  w->layout = dea_arena_alloc(&w->memory, w->count, sizeof *w->layout);
  DEA_TRY(ctx, dea_arena_status(&w->memory));
  for (size_t i = 0; i < w->count; i++) {
    if (w->part[i].paper) {
      double half[2];
      half_size(w, w->part[i].state, true, half);
      w->layout[i] = paper_layout(half, w->plan.design->fabrication.sheet.margin_m.si);
    } else {
      DEA_TRY(ctx, sheet_layout(ctx, w, &w->part[i], &w->layout[i]));
    }
  }
  return DEA_OK;
}

static dea_status build(struct dea_context *ctx, const struct dea_design *design,
                        const struct dea_device *device, struct dea_workshop *w)
{
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  w->memory.ctx = ctx;
  DEA_TRY(ctx, dea_fab_plan_build(ctx, design, device, &w->plan));
  if (dea_finding_count(ctx, DEA_ERROR) == errors) { // else parts have no form
    DEA_TRY(ctx, dea_parts_build(ctx, w));
    DEA_TRY(ctx, check_parts(ctx, w));
    DEA_TRY(ctx, lay_out(ctx, w));
  }
  size_t found = dea_finding_count(ctx, DEA_ERROR) - errors;
  return found == 0 ? DEA_OK
                    : dea_fail(ctx, DEA_E_DESIGN, "'%s' cannot be built: %zu error%s", design->file,
                               found, found > 1 ? "s" : "");
}

dea_status dea_workshop_create(struct dea_context *ctx, const struct dea_design *design,
                               const struct dea_device *device, struct dea_workshop **out)
{
  struct dea_workshop *w = dea_alloc(ctx, 1, sizeof *w);
  *out = NULL;
  DEA_TRY_MEMORY(w != NULL);
  DEA_TRY_ELSE(ctx, build(ctx, design, device, w), dea_workshop_destroy(ctx, w));
  *out = w;
  return DEA_OK;
}

void dea_workshop_destroy(struct dea_context *ctx, struct dea_workshop *workshop)
{
  if (workshop != NULL) {
    dea_fab_plan_free(&workshop->plan);
    dea_arena_free(&workshop->memory);
    dea_free(ctx, workshop);
  }
}

const struct dea_part *dea_workshop_part(const struct dea_workshop *workshop,
                                         enum dea_part_kind kind, size_t of)
{
  const struct dea_layout *l = workshop->plan.layout;
  const bool stencil = kind == DEA_PART_TOP || kind == DEA_PART_BOTTOM;
  const size_t like = kind >= DEA_PART_BODY ? of
                      : stencil             ? dea_face_like(l, of, kind == DEA_PART_TOP)
                                            : dea_ply_like(l, of);
  for (size_t i = 0; i < workshop->count; i++) {
    if (workshop->part[i].kind == kind && workshop->part[i].of == like) {
      return &workshop->part[i];
    }
  }
  return NULL;
}

dea_status dea_workshop_path(const struct dea_workshop *workshop, const struct dea_part *part,
                             size_t i, struct dea_vertex **memory, struct dea_contour *out)
{
  struct dea_context *ctx = part->memory->ctx;
  const struct dea_part_contour *own = &part->contour[i];
  double half = 0.5 * workshop->plan.kerf_m;
  double outwards = own->layer == DEA_LAYER_CUT_OUTER   ? half
                    : own->layer == DEA_LAYER_CUT_INNER ? -half
                                                        : 0;
  size_t count, at;
  *memory = dea_alloc(ctx, 2 * own->path.count, sizeof **memory);
  DEA_TRY_MEMORY(*memory != NULL);
  if (!dea_contour_offset(&own->path, outwards, *memory, &count, &at)) { // was checked
    dea_free(ctx, *memory);
    *memory = NULL;
    return dea_fail(ctx, DEA_E_ARGUMENT, "a contour of '%s' has no tool path", part->name);
  }
  *out = (struct dea_contour){*memory, count, own->path.closed};
  return DEA_OK;
}
