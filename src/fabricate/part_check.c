/* Whether a part can be cut. */
#include "fabricate/part.h"

static bool is_cut(enum dea_layer layer)
{
  return layer == DEA_LAYER_CUT_INNER || layer == DEA_LAYER_CUT_OUTER;
}

/* Where something is on a part, for messages. */
#define AT_FORMAT "at (%.4g, %.4g) mm from the centre of the part '%s' (lengths of the %s film)"
#define AT_ARGUMENTS(part, x, y) 1e3 * (x), 1e3 * (y), (part)->name, dea_part_film_name(part)

static dea_status report_gap(const struct dea_part *part, const struct dea_contour *contour,
                             const struct dea_gap *gap, double feature)
{
  struct dea_location location = contour->vertex[gap->piece].location;
  if (gap->width_m <= 1e-9) {
    return dea_finding_add(part->memory->ctx, DEA_ERROR, location, "parts overlap " AT_FORMAT,
                           AT_ARGUMENTS(part, gap->x_m, gap->y_m));
  }
  return dea_finding_add(part->memory->ctx, DEA_ERROR, location,
                         "only %.4g mm lie between two edges " AT_FORMAT
                         "; the minimum feature is %.4g mm",
                         1e3 * gap->width_m, AT_ARGUMENTS(part, gap->x_m, gap->y_m), 1e3 * feature);
}

/* A circle, whose two halves are neighbours. */
static dea_status check_circle(const struct dea_part *part, const struct dea_contour *circle,
                               double feature)
{
  const struct dea_piece piece = dea_contour_piece(circle, 0);
  if (2 * piece.radius_m >= feature * (1 - 1e-9)) {
    return DEA_OK;
  }
  return dea_finding_add(
      part->memory->ctx, DEA_ERROR, circle->vertex[0].location,
      "a circle of %.4g mm diameter " AT_FORMAT " is smaller than the minimum feature of %.4g mm",
      2e3 * piece.radius_m, AT_ARGUMENTS(part, piece.centre[0], piece.centre[1]), 1e3 * feature);
}

/* A hole lies in material: in one outer edge more than in other holes; crossings were found before.
 */
static dea_status check_nesting(const struct dea_part *part, size_t hole,
                                const struct dea_contour *contour)
{
  const struct dea_vertex *at = &contour->vertex[0];
  int outside = 0, holes = 0;
  for (size_t i = 0; i < part->contour_count; i++) {
    const struct dea_part_contour *other = &part->contour[i];
    if (i != hole && is_cut(other->layer) && dea_contour_inside(&other->path, at->x_m, at->y_m)) {
      outside += other->layer == DEA_LAYER_CUT_OUTER ? 1 : 0;
      holes += other->layer == DEA_LAYER_CUT_INNER ? 1 : 0;
    }
  }
  if (outside == holes + 1) {
    return DEA_OK;
  }
  return dea_finding_add(part->memory->ctx, DEA_ERROR, at->location,
                         holes > 0 ? "parts overlap: a hole lies in another one, " AT_FORMAT
                                   : "a hole lies outside of the part, " AT_FORMAT,
                         AT_ARGUMENTS(part, at->x_m, at->y_m));
}

static dea_status check_path(const struct dea_part *part, size_t i,
                             const struct dea_contour *contour, double kerf)
{
  bool hole = part->contour[i].layer == DEA_LAYER_CUT_INNER;
  size_t count, at;
  struct dea_vertex *path = dea_alloc(part->memory->ctx, 2 * contour->count, sizeof *path);
  DEA_TRY_MEMORY(path != NULL);
  bool good = dea_contour_offset(contour, hole ? -0.5 * kerf : 0.5 * kerf, path, &count, &at);
  dea_free(part->memory->ctx, path);
  const struct dea_vertex *v = &contour->vertex[good ? 0 : at];
  return good ? DEA_OK
              : dea_finding_add(part->memory->ctx, DEA_ERROR, v->location,
                                "an edge " AT_FORMAT
                                " is too short for a cutter with a kerf of %.4g mm",
                                AT_ARGUMENTS(part, v->x_m, v->y_m), 1e3 * kerf);
}

static dea_status check_contour(const struct dea_part *part, size_t i, double feature, double kerf)
{
  struct dea_context *ctx = part->memory->ctx;
  const struct dea_part_contour *own = &part->contour[i];
  size_t before = dea_finding_count(ctx, DEA_ERROR);
  double limit = feature * (1 - 1e-9);
  DEA_TRY(ctx, own->circle ? check_circle(part, &own->path, feature) : DEA_OK);
  for (size_t j = i; j < part->contour_count; j++) {
    const struct dea_part_contour *other = &part->contour[j];
    if (is_cut(other->layer)) {
      struct dea_gap gap = dea_contour_gap(&own->path, j > i ? &other->path : NULL, limit);
      DEA_TRY(ctx, gap.width_m < limit ? report_gap(part, &own->path, &gap, feature) : DEA_OK);
    }
  }
  if (dea_finding_count(ctx, DEA_ERROR) > before) {
    return DEA_OK; // what follows would say the same again
  }
  if (own->layer == DEA_LAYER_CUT_INNER) {
    DEA_TRY(ctx, check_nesting(part, i, &own->path));
  }
  return check_path(part, i, &own->path, kerf);
}

dea_status dea_part_check(const struct dea_part *part, double feature_m, double kerf_m)
{
  for (size_t i = 0; i < part->contour_count; i++) {
    if (is_cut(part->contour[i].layer)) {
      DEA_TRY(part->memory->ctx, check_contour(part, i, feature_m, kerf_m));
    }
  }
  return DEA_OK;
}
