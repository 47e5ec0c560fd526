#include "fabricate/part.h"

#include <math.h>
#include <string.h>

/* Whether a contour is a circle of two halves. */
static bool is_circle(const struct dea_contour *c)
{
  return c->closed && c->count == 2 && fabs(c->vertex[0].bulge - 1) < 1e-12 &&
         fabs(c->vertex[1].bulge - 1) < 1e-12;
}

void dea_part_add(struct dea_part *part, enum dea_layer layer, const struct dea_contour *contour)
{
  if (part->contour_count == part->contour_room) {
    const size_t bigger = 2 * part->contour_room + 8;
    struct dea_part_contour *moved = dea_arena_alloc(part->memory, bigger, sizeof *moved);
    if (moved == NULL) {
      return;
    }
    if (part->contour_count > 0) {
      memcpy(moved, part->contour, part->contour_count * sizeof *moved);
    }
    part->contour = moved;
    part->contour_room = bigger;
  }
  struct dea_vertex *vertex = dea_arena_alloc(part->memory, contour->count, sizeof *vertex);
  if (vertex != NULL) {
    memcpy(vertex, contour->vertex, contour->count * sizeof *vertex);
    part->contour[part->contour_count++] = (struct dea_part_contour){
        layer, is_circle(contour), {vertex, contour->count, contour->closed}};
  }
}

void dea_part_measure(struct dea_part *part, enum dea_measure_kind kind, double x0_m, double y0_m,
                      double x1_m, double y1_m, const char *what)
{
  if (part->measure_count < DEA_PART_MEASURES_MAX) {
    part->measure[part->measure_count++] =
        (struct dea_part_measure){kind, {x0_m, y0_m}, {x1_m, y1_m}, what};
  }
}

const char *dea_part_film_name(const struct dea_part *part)
{
  return part->flat ? "flat" : dea_film_state_name(part->state);
}

const char *dea_part_seen(const struct dea_part *part)
{
  return part->mirrored ? "seen from below" : "seen from above";
}

void dea_part_box(const struct dea_part *part, double box_m[4])
{
  box_m[0] = box_m[1] = INFINITY;
  box_m[2] = box_m[3] = -INFINITY;
  for (size_t i = 0; i < part->contour_count; i++) {
    dea_contour_grow_box(&part->contour[i].path, box_m);
  }
}

double dea_part_area_m2(const struct dea_part *part)
{
  double area = 0;
  for (size_t i = 0; i < part->contour_count; i++) {
    enum dea_layer layer = part->contour[i].layer;
    double sign = layer == DEA_LAYER_CUT_OUTER ? 1 : layer == DEA_LAYER_CUT_INNER ? -1 : 0;
    area += sign * dea_contour_area_m2(&part->contour[i].path);
  }
  return area;
}

double dea_part_length_m(const struct dea_part *part, enum dea_layer layer)
{
  double length = 0;
  for (size_t i = 0; i < part->contour_count; i++) {
    const struct dea_part_contour *contour = &part->contour[i];
    length += contour->layer == layer ? dea_contour_length_m(&contour->path) : 0;
  }
  return length;
}
