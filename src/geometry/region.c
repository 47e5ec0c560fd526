#include "geometry/region.h"

#include <math.h>
#include <string.h>

/* Room for so many elements in an array; false on failure. */
static bool reserve(struct dea_region *region, void *array, size_t count, size_t *capacity,
                    size_t size)
{
  while (*capacity < count && !region->failed) {
    region->failed = dea_array_grow(region->ctx, array, *capacity, capacity, size) != DEA_OK;
  }
  return !region->failed;
}

void dea_region_add(struct dea_region *region, const struct dea_vertex *vertices, size_t count)
{
  if (reserve(region, &region->vertex, region->vertex_count + count, &region->vertex_room,
              sizeof *region->vertex) &&
      reserve(region, &region->end, region->contour_count + 1, &region->contour_room,
              sizeof *region->end)) {
    memcpy(region->vertex + region->vertex_count, vertices, count * sizeof *vertices);
    region->vertex_count += count;
    region->end[region->contour_count++] = region->vertex_count;
  }
}

void dea_region_add_reversed(struct dea_region *region, const struct dea_vertex *vertices,
                             size_t count)
{
  size_t first = region->vertex_count;
  dea_region_add(region, vertices, count);
  for (size_t k = 0; k < count && !region->failed; k++) {
    const struct dea_vertex *v = &vertices[count - 1 - k];
    const struct dea_vertex *piece = &vertices[(2 * count - 2 - k) % count];
    region->vertex[first + k] =
        (struct dea_vertex){v->x_m, v->y_m, 0 - piece->bulge, piece->location};
  }
}

void dea_region_add_circle(struct dea_region *region, double x_m, double y_m, double radius_m,
                           bool hole, struct dea_location location)
{
  double bulge = hole ? -1 : 1;
  const struct dea_vertex halves[2] = {{x_m + radius_m, y_m, bulge, location},
                                       {x_m - radius_m, y_m, bulge, location}};
  dea_region_add(region, halves, 2);
}

dea_status dea_region_status(const struct dea_region *region)
{
  return region->failed ? DEA_E_MEMORY : DEA_OK;
}

void dea_region_free(struct dea_region *region)
{
  dea_free(region->ctx, region->vertex);
  dea_free(region->ctx, region->end);
  *region = (struct dea_region){.ctx = region->ctx};
}

struct dea_contour dea_region_contour(const struct dea_region *region, size_t i)
{
  size_t first = i > 0 ? region->end[i - 1] : 0;
  return (struct dea_contour){region->vertex + first, region->end[i] - first, true};
}

bool dea_region_same(const struct dea_region *a, const struct dea_region *b)
{
  bool same = a->contour_count == b->contour_count && a->vertex_count == b->vertex_count;
  for (size_t i = 0; i < a->contour_count && same; i++) {
    same = a->end[i] == b->end[i];
  }
  for (size_t i = 0; i < a->vertex_count && same; i++) {
    const struct dea_vertex *v = &a->vertex[i], *w = &b->vertex[i];
    same = v->x_m == w->x_m && v->y_m == w->y_m && v->bulge == w->bulge;
  }
  return same;
}

double dea_region_area_m2(const struct dea_region *region)
{
  double area = 0;
  for (size_t i = 0; i < region->contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(region, i);
    area += dea_contour_area_m2(&contour);
  }
  return area;
}

void dea_region_centroid_m(const struct dea_region *region, double out[2])
{
  double area = dea_region_area_m2(region), sum[2] = {0, 0};
  for (size_t i = 0; i < region->contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(region, i);
    double moment[2];
    dea_contour_moment_m3(&contour, moment);
    sum[0] += moment[0];
    sum[1] += moment[1];
  }
  out[0] = sum[0] / area;
  out[1] = sum[1] / area;
}

double dea_region_boundary_m(const struct dea_region *region)
{
  double length = 0;
  for (size_t i = 0; i < region->contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(region, i);
    length += dea_contour_length_m(&contour);
  }
  return length;
}

void dea_region_grow_box(const struct dea_region *region, double box[4])
{
  for (size_t i = 0; i < region->contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(region, i);
    dea_contour_grow_box(&contour, box);
  }
}

void dea_region_box_m(const struct dea_region *region, double out[4])
{
  out[0] = out[1] = INFINITY;
  out[2] = out[3] = -INFINITY;
  dea_region_grow_box(region, out);
}

double dea_region_size_m(const struct dea_region *region)
{
  double box[4];
  dea_region_box_m(region, box);
  return region->contour_count > 0 ? hypot(box[2] - box[0], box[3] - box[1]) : 0;
}

double dea_region_distance_m(const struct dea_region *region, const double x_m[2])
{
  double least = INFINITY;
  for (size_t i = 0; i < region->contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(region, i);
    least = fmin(least, dea_contour_distance_m(&contour, x_m));
  }
  return least;
}

bool dea_region_inside(const struct dea_region *region, double x_m, double y_m)
{
  bool inside = false;
  for (size_t i = 0; i < region->contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(region, i);
    inside ^= dea_contour_inside(&contour, x_m, y_m);
  }
  return inside;
}

/* ---- copies ---- */

struct dea_motion dea_motion_translation(double x_m, double y_m)
{
  return (struct dea_motion){1, 0, {x_m, y_m}, false};
}

/* Moves so that a point stays where it is. */
static struct dea_motion about(const double point[2], struct dea_motion motion)
{
  double moved[2];
  dea_motion_apply(&motion, point, moved);
  motion.move_m[0] = point[0] - moved[0];
  motion.move_m[1] = point[1] - moved[1];
  return motion;
}

struct dea_motion dea_motion_rotation(const double centre_m[2], double angle_rad)
{
  return about(centre_m, (struct dea_motion){cos(angle_rad), sin(angle_rad), {0, 0}, false});
}

struct dea_motion dea_motion_mirror(const double point_m[2], double angle_rad)
{
  return about(point_m, (struct dea_motion){cos(2 * angle_rad), sin(2 * angle_rad), {0, 0}, true});
}

void dea_motion_apply(const struct dea_motion *motion, const double x_m[2], double out[2])
{
  double x = x_m[0], y = motion->mirrored ? -x_m[1] : x_m[1];
  out[0] = motion->cosine * x - motion->sine * y + motion->move_m[0];
  out[1] = motion->sine * x + motion->cosine * y + motion->move_m[1];
}

void dea_region_add_moved(struct dea_region *region, const struct dea_region *from,
                          const struct dea_motion *motion)
{
  for (size_t i = 0; i < from->contour_count; i++) {
    const struct dea_contour contour = dea_region_contour(from, i);
    size_t first = region->vertex_count;
    if (motion->mirrored) { // so that the inside stays on the left
      dea_region_add_reversed(region, contour.vertex, contour.count);
    } else {
      dea_region_add(region, contour.vertex, contour.count);
    }
    for (size_t k = first; k < region->vertex_count; k++) {
      struct dea_vertex *v = &region->vertex[k];
      double x[2];
      dea_motion_apply(motion, (double[2]){v->x_m, v->y_m}, x);
      v->x_m = x[0];
      v->y_m = x[1];
      v->bulge = motion->mirrored ? 0 - v->bulge : v->bulge; // no -0
    }
  }
}

void dea_region_add_grid(struct dea_region *region, const struct dea_region *from,
                         const size_t count[2], const double step_m[2][2])
{
  for (size_t j = 0; j < count[1]; j++) {
    for (size_t i = 0; i < count[0]; i++) {
      double x = (double)i, y = (double)j;
      const struct dea_motion motion = dea_motion_translation(x * step_m[0][0] + y * step_m[1][0],
                                                              x * step_m[0][1] + y * step_m[1][1]);
      dea_region_add_moved(region, from, &motion);
    }
  }
}

void dea_region_add_polar(struct dea_region *region, const struct dea_region *from, size_t count,
                          const double centre_m[2], double step_rad)
{
  for (size_t i = 0; i < count; i++) {
    const struct dea_motion motion = dea_motion_rotation(centre_m, (double)i * step_rad);
    dea_region_add_moved(region, from, &motion);
  }
}
