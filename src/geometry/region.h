/* Regions of a plane: outlines with holes, several apart from each other, in metres.
 *
 * An outline goes counter-clockwise and the holes in it, which go clockwise, follow it: the inside
 * lies on the left everywhere. What adds contours does not look at them (dea_region_check does);
 * the measures hold for contours that do not cross. */
#pragma once

#include "geometry/contour.h"

/* Zero-initialise with the context set: struct dea_region r = {.ctx = ctx}. As of struct dea_text,
 * what could not be added for want of memory is left out and `failed` stays set. */
struct dea_region {
  struct dea_context *ctx;
  struct dea_vertex *vertex; // [vertex_count] of all contours, one after the other; owned
  size_t *end;               // [contour_count] number of the vertex after a contour's last; owned
  size_t vertex_count, vertex_room, contour_count, contour_room;
  bool failed;
};

/* Adds a closed contour of vertices[count]. */
void dea_region_add(struct dea_region *region, const struct dea_vertex *vertices, size_t count);
/* The same the other way round: what was on its left is on its right. */
void dea_region_add_reversed(struct dea_region *region, const struct dea_vertex *vertices,
                             size_t count);
/* Adds a circle; counter-clockwise unless it is a hole. */
void dea_region_add_circle(struct dea_region *region, double x_m, double y_m, double radius_m,
                           bool hole, struct dea_location location);
/* DEA_E_MEMORY when something could not be added. */
dea_status dea_region_status(const struct dea_region *region);
/* Its memory; it is empty then. */
void dea_region_free(struct dea_region *region);

/* A contour, 0 <= i < contour_count; lent until the region changes. */
struct dea_contour dea_region_contour(const struct dea_region *region, size_t i);

/* Whether two have the very same vertices. */
bool dea_region_same(const struct dea_region *a, const struct dea_region *b);

double dea_region_area_m2(const struct dea_region *region);
/* Centroid of the area; NAN of an empty region. */
void dea_region_centroid_m(const struct dea_region *region, double out[2]);
/* Length of all contours. */
double dea_region_boundary_m(const struct dea_region *region);
/* {x min, y min, x max, y max}; of an empty region {INFINITY, INFINITY, -INFINITY, -INFINITY}. */
void dea_region_box_m(const struct dea_region *region, double out[4]);
/* Grows a box {x min, y min, x max, y max} so that it holds the region. */
void dea_region_grow_box(const struct dea_region *region, double box[4]);
/* Whether a point, not on the boundary, lies in the region. */
bool dea_region_inside(const struct dea_region *region, double x_m, double y_m);
/* Distance of a point from the boundary; INFINITY of an empty region. */
double dea_region_distance_m(const struct dea_region *region, const double x_m[2]);
/* Diagonal of the box: the size that tolerances are counted from. */
double dea_region_size_m(const struct dea_region *region);

/* Two lengths of one drawing that differ by less than this part of its size are equal. */
#define DEA_GEOMETRY_SNAP 1e-9

/* A finding at its place in the input, and the message of the context: what is wrong where [m], as
 * "the contour crosses itself at (1.5, 2) mm". Returns DEA_E_DESIGN. */
dea_status dea_region_fault(struct dea_context *ctx, struct dea_location location, double x_m,
                            double y_m, const char *what);
/* Whether all contours are simple and apart from each other: finite, with an area, crossing neither
 * themselves nor, with `apart`, each other (a common point is allowed, a common edge is not). The
 * first fault, as dea_region_fault; DEA_E_MEMORY. */
dea_status dea_region_check(struct dea_context *ctx, const struct dea_region *region, bool apart);
/* Adds the contours of another region if they pass that check. */
dea_status dea_region_add_checked(struct dea_region *region, const struct dea_region *from);
/* Makes outlines with holes of simple contours that do not cross, by how they lie in each other: a
 * contour in no other one is an outline, one in an outline is a hole, one in a hole is an outline
 * again. On failure the region is as it was. */
dea_status dea_region_arrange(struct dea_context *ctx, struct dea_region *region);

/* A motion of the plane, without or with a reflection: x -> (c -s; s c) F x + move, where F turns
 * over y if `mirrored`. */
struct dea_motion {
  double cosine, sine, move_m[2];
  bool mirrored;
};

struct dea_motion dea_motion_translation(double x_m, double y_m);
/* By an angle [rad], counter-clockwise about a point. */
struct dea_motion dea_motion_rotation(const double centre_m[2], double angle_rad);
/* Reflection in the line through a point in the direction of an angle [rad]. */
struct dea_motion dea_motion_mirror(const double point_m[2], double angle_rad);
void dea_motion_apply(const struct dea_motion *motion, const double x_m[2], double out[2]);

/* Adds a moved copy of a region (another one). */
void dea_region_add_moved(struct dea_region *region, const struct dea_region *from,
                          const struct dea_motion *motion);
/* Adds count[0] x count[1] copies, at multiples of step_m[0] and step_m[1]. */
void dea_region_add_grid(struct dea_region *region, const struct dea_region *from,
                         const size_t count[2], const double step_m[2][2]);
/* Adds `count` copies, rotated about a centre by multiples of an angle [rad]. */
void dea_region_add_polar(struct dea_region *region, const struct dea_region *from, size_t count,
                          const double centre_m[2], double step_rad);
