#include "fabricate/workshop.h"

#include "fabricate/parts.h"

#include <math.h>

static const struct dea_part_type *const types[] = {
#define PART_ROW(name) &name,
    DEA_PART_LIST(PART_ROW)
#undef PART_ROW
};

/* ---- sheets ---- */

/* Half the size of the largest part of a film state, with its cut around it. */
static double half_size(const struct dea_workshop *w, enum dea_film_state state, bool paper)
{
  double half = 0;
  for (size_t i = 0; i < w->count; i++) {
    const struct dea_part *part = &w->part[i];
    if (part->state == state && part->paper == paper) {
      double box[4];
      dea_part_box(part, box);
      half = fmax(half, fmax(fmax(-box[0], -box[1]), fmax(box[2], box[3])));
    }
  }
  return half + (paper ? 0 : 0.5 * w->plan.kerf_m);
}

/* Paper is as large as it has to be. */
static struct dea_sheet_layout paper_layout(double half, double margin)
{
  double side = 2 * (half + margin);
  return (struct dea_sheet_layout){side, side, {0.5 * side, 0.5 * side}, side, 1, 1, false};
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
  double half = half_size(w, part->state, false), pitch = 2 * half + gap;
  double across = f->sheet.width_m.si, up = f->sheet.height_m.si;
  double columns = fmax(0, whole((across - 2 * margin + gap) / pitch));
  double rows = fmax(0, whole((up - 2 * margin + gap) / pitch));
  *out = (struct dea_sheet_layout){
      .width_m = across,
      .height_m = up,
      .first_m = {part->mirrored ? across - margin - half : margin + half, up - margin - half},
      .pitch_m = pitch,
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
  return dea_finding_add(ctx, DEA_ERROR,
                         columns < 1 ? f->sheet.width_m.location : f->sheet.height_m.location,
                         "a sheet of %.4g mm x %.4g mm is too small for the part '%s' of %.4g mm, "
                         "with a margin of %.4g mm",
                         1e3 * across, 1e3 * up, part->name, 2e3 * half, 1e3 * margin);
}

void dea_sheet_place(const struct dea_sheet_layout *layout, int copy, double out_m[2])
{
  double aside = copy % layout->columns * layout->pitch_m;
  out_m[0] = layout->first_m[0] + (layout->mirrored ? -aside : aside);
  out_m[1] = layout->first_m[1] - copy / layout->columns * layout->pitch_m;
}

/* ---- all of it ---- */

static dea_status build_parts(struct dea_context *ctx, struct dea_workshop *w)
{
  for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
    const struct dea_part_type *type = types[i];
    if (type->of_fibres && w->plan.device->fibre_count == 0) {
      continue;
    }
    struct dea_part *part = &w->part[w->count++];
    *part = (struct dea_part){.ctx = ctx,
                              .name = type->name,
                              .title = type->title,
                              .seen = type->seen,
                              .state = type->state,
                              .paper = type->paper,
                              .mirrored = type->mirrored};
    type->build(&w->plan, part);
    if (part->failed) {
      return DEA_E_MEMORY;
    }
    DEA_TRY(ctx, dea_part_check(part, w->plan.feature_m, w->plan.kerf_m));
  }
  return DEA_OK;
}

static dea_status lay_out(struct dea_context *ctx, struct dea_workshop *w)
{
  for (size_t i = 0; i < w->count; i++) {
    if (w->part[i].paper) {
      w->layout[i] = paper_layout(half_size(w, w->part[i].state, true),
                                  w->plan.design->fabrication.sheet.margin_m.si);
    } else {
      DEA_TRY(ctx, sheet_layout(ctx, w, &w->part[i], &w->layout[i]));
    }
  }
  return DEA_OK;
}

static dea_status make(struct dea_context *ctx, const struct dea_design *design,
                       const struct dea_device *device, struct dea_workshop *w)
{
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  DEA_TRY(ctx, dea_fab_geometry_make(ctx, design, device, &w->plan));
  if (dea_finding_count(ctx, DEA_ERROR) == errors) { // else parts have no form
    DEA_TRY(ctx, build_parts(ctx, w));
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
  *out = NULL;
  DEA_TRY(ctx, dea_device_check(ctx, device)); // files of other devices are not made yet
  *out = dea_alloc(ctx, 1, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = make(ctx, design, device, *out);
  if (status != DEA_OK) {
    dea_workshop_destroy(ctx, *out);
    *out = NULL;
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  return DEA_OK;
}

void dea_workshop_destroy(struct dea_context *ctx, struct dea_workshop *workshop)
{
  if (workshop != NULL) {
    for (size_t i = 0; i < workshop->count; i++) {
      dea_part_free(&workshop->part[i]);
    }
    dea_free(ctx, workshop);
  }
}

dea_status dea_workshop_path(const struct dea_workshop *workshop, const struct dea_part *part,
                             size_t i, struct dea_vertex **out, size_t *count)
{
  const struct dea_contour contour = dea_part_contour_get(part, i);
  double half = 0.5 * workshop->plan.kerf_m;
  double outwards = part->contour[i].layer == DEA_LAYER_CUT_OUTER   ? half
                    : part->contour[i].layer == DEA_LAYER_CUT_INNER ? -half
                                                                    : 0;
  size_t at;
  *out = dea_alloc(part->ctx, 2 * contour.count, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  if (!dea_contour_offset(&contour, outwards, *out, count, &at)) { // was checked
    dea_free(part->ctx, *out);
    *out = NULL;
    return dea_fail(part->ctx, DEA_E_ARGUMENT, "a contour of '%s' has no tool path", part->name);
  }
  return DEA_OK;
}
