/* The shapes, each with the table of its parameters. */
#include "geometry/shape.h"

#include <math.h>
#include <stdio.h>

#define SHAPE(id, what, parameters)                                                                \
  const struct dea_shape_type dea_shape_##id = {                                                   \
      .name = #id,                                                                                 \
      .doc = what,                                                                                 \
      .parameter = parameters,                                                                     \
      .count = sizeof parameters / sizeof *parameters,                                             \
      .add = add_##id,                                                                             \
  }
#define CENTRE                                                                                     \
  {"x", DEA_SHAPE_POSITION, true, "of the centre"},                                                \
  {                                                                                                \
    "y", DEA_SHAPE_POSITION, true, "of the centre"                                                 \
  }

#define ADD(id)                                                                                    \
  static dea_status add_##id(struct dea_region *region, const double *value,                       \
                             const double(*point)[2], size_t count, struct dea_location location)
#define NO_POINTS ((void)point, (void)count)

static const struct dea_shape_parameter circle[] = {
    CENTRE, {"radius", DEA_SHAPE_LENGTH, false, "of the disc"}};

ADD(circle)
{
  NO_POINTS;
  dea_region_add_circle(region, value[0], value[1], value[2], false, location);
  return dea_region_status(region);
}

SHAPE(circle, "a disc", circle);

static const struct dea_shape_parameter ring[] = {
    CENTRE,
    {"inner_radius", DEA_SHAPE_LENGTH, false, "of the hole"},
    {"outer_radius", DEA_SHAPE_LENGTH, false, "of the outline"}};

/* What is wrong with the numbers of a shape: no place in the plane is. */
static dea_status fault(const struct dea_region *region, struct dea_location location,
                        const char *what)
{
  return dea_region_fault(region->ctx, location, NAN, NAN, what);
}

ADD(ring)
{
  NO_POINTS;
  if (value[2] >= value[3]) {
    return fault(region, location, "the ring's inner radius is not below the outer one");
  }
  dea_region_add_circle(region, value[0], value[1], value[3], false, location);
  dea_region_add_circle(region, value[0], value[1], value[2], true, location);
  return dea_region_status(region);
}

SHAPE(ring, "a disc with a hole in its middle", ring);

static const struct dea_shape_parameter sector[] = {
    CENTRE,
    {"inner_radius", DEA_SHAPE_LENGTH, true, "of what is missing at the tip"},
    {"outer_radius", DEA_SHAPE_LENGTH, false, "of the arc"},
    {"start", DEA_SHAPE_ANGLE, false, "direction of the first side"},
    {"end", DEA_SHAPE_ANGLE, false, "direction of the other side, counter-clockwise from it"}};

/* An arc about c from an angle over `sweep`, in two halves so that no bulge is large. */
static size_t add_arc(struct dea_vertex *v, const double *c, double radius, double from,
                      double sweep, struct dea_location location)
{
  for (int k = 0; k < 3; k++) {
    double angle = from + 0.5 * k * sweep;
    v[k] = (struct dea_vertex){c[0] + radius * cos(angle), c[1] + radius * sin(angle),
                               k < 2 ? tan(0.125 * sweep) : 0, location};
  }
  return 3;
}

static dea_status add_ring_sector(struct dea_region *region, const double *centre, double inner,
                                  double outer, double start, double end,
                                  struct dea_location location)
{
  double sweep = end - start;
  if (inner >= outer) {
    return fault(region, location, "the sector's inner radius is not below the outer one");
  }
  if (!(sweep > 0 && sweep < 2 * DEA_PI)) {
    return fault(region, location,
                 "the sector does not end within a turn counter-clockwise of its start");
  }
  struct dea_vertex v[6];
  size_t n = add_arc(v, centre, outer, start, sweep, location);
  if (inner > 0) {
    n += add_arc(v + n, centre, inner, end, -sweep, location);
  } else {
    v[n++] = (struct dea_vertex){centre[0], centre[1], 0, location};
  }
  dea_region_add(region, v, n);
  return dea_region_status(region);
}

ADD(sector)
{
  NO_POINTS;
  return add_ring_sector(region, value, value[2], value[3], value[4], value[5], location);
}

SHAPE(sector, "a part of a disc or ring between two directions", sector);

static const struct dea_shape_parameter rectangle[] = {
    CENTRE,
    {"width", DEA_SHAPE_LENGTH, false, "along x"},
    {"height", DEA_SHAPE_LENGTH, false, "along y"}};

ADD(rectangle)
{
  NO_POINTS;
  double a = 0.5 * value[2], b = 0.5 * value[3];
  const struct dea_vertex v[4] = {{value[0] - a, value[1] - b, 0, location},
                                  {value[0] + a, value[1] - b, 0, location},
                                  {value[0] + a, value[1] + b, 0, location},
                                  {value[0] - a, value[1] + b, 0, location}};
  dea_region_add(region, v, 4);
  return dea_region_status(region);
}

SHAPE(rectangle, "a rectangle with its sides along the axes", rectangle);

static const struct dea_shape_parameter rounded_rectangle[] = {
    CENTRE,
    {"width", DEA_SHAPE_LENGTH, false, "along x"},
    {"height", DEA_SHAPE_LENGTH, false, "along y"},
    {"radius", DEA_SHAPE_LENGTH, false, "of its corners"}};

/* Adds a contour but for vertices that fall on the next one. */
static void add_without_gaps(struct dea_region *region, struct dea_vertex *v, size_t count)
{
  size_t kept = 0;
  for (size_t i = 0; i < count; i++) {
    const struct dea_vertex *next = &v[(i + 1) % count];
    if (v[i].x_m != next->x_m || v[i].y_m != next->y_m) {
      v[kept++] = v[i];
    }
  }
  dea_region_add(region, v, kept);
}

ADD(rounded_rectangle)
{
  NO_POINTS;
  double a = 0.5 * value[2], b = 0.5 * value[3], r = value[4], bulge = tan(DEA_PI / 8);
  if (r > fmin(a, b)) {
    return fault(region, location,
                 "the corners' radius is larger than half of the shorter side of the rectangle");
  }
  double x = value[0], y = value[1], in = a - r, up = b - r; // 0 where two arcs meet
  struct dea_vertex v[8] = {{x - in, y - b, 0, location}, {x + in, y - b, bulge, location},
                            {x + a, y - up, 0, location}, {x + a, y + up, bulge, location},
                            {x + in, y + b, 0, location}, {x - in, y + b, bulge, location},
                            {x - a, y + up, 0, location}, {x - a, y - up, bulge, location}};
  add_without_gaps(region, v, 8);
  return dea_region_status(region);
}

SHAPE(rounded_rectangle, "a rectangle with round corners", rounded_rectangle);

ADD(polygon)
{
  (void)value;
  double twice = 0; // its area
  for (size_t i = 0; i < count; i++) {
    const double *p = point[i], *q = point[(i + 1) % count], *o = point[0];
    twice += (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
  }
  struct dea_vertex *v = dea_alloc(region->ctx, count, sizeof *v);
  struct dea_region own = {.ctx = region->ctx};
  for (size_t i = 0; i < count && v != NULL; i++) {
    const double *p = point[twice < 0 ? count - 1 - i : i];
    v[i] = (struct dea_vertex){p[0], p[1], 0, location};
  }
  dea_status status = v != NULL ? DEA_OK : DEA_E_MEMORY;
  if (status == DEA_OK) {
    dea_region_add(&own, v, count);
    status = dea_region_add_checked(region, &own);
  }
  dea_region_free(&own);
  dea_free(region->ctx, v);
  return status;
}

const struct dea_shape_type dea_shape_polygon = {
    .name = "polygon",
    .doc = "straight lines from point to point, and back to the first one",
    .points_min = 3,
    .points_doc = "its corners, in either sense",
    .add = add_polygon,
};

static const struct dea_shape_parameter stadium[] = {
    CENTRE,
    {"length", DEA_SHAPE_LENGTH, false, "from end to end"},
    {"width", DEA_SHAPE_LENGTH, false, "across"},
    {"angle", DEA_SHAPE_ANGLE, true, "of its length to the x axis"}};

ADD(stadium)
{
  NO_POINTS;
  double half = 0.5 * (value[2] - value[3]), r = 0.5 * value[3];
  if (half <= 0) {
    return fault(region, location, "the stadium is not longer than wide");
  }
  double c = cos(value[4]), s = sin(value[4]);
  static const int along[4] = {-1, 1, 1, -1}, across[4] = {-1, -1, 1, 1};
  struct dea_vertex v[4];
  for (int k = 0; k < 4; k++) {
    double x = along[k] * half, y = across[k] * r;
    v[k] = (struct dea_vertex){value[0] + c * x - s * y, value[1] + s * x + c * y, k % 2, location};
  }
  dea_region_add(region, v, 4);
  return dea_region_status(region);
}

SHAPE(stadium, "a rectangle with half a disc at either end", stadium);

static const struct dea_shape_parameter arc_strip[] = {
    CENTRE,
    {"radius", DEA_SHAPE_LENGTH, false, "of its middle line"},
    {"width", DEA_SHAPE_LENGTH, false, "across"},
    {"start", DEA_SHAPE_ANGLE, false, "direction of one end from the centre"},
    {"end", DEA_SHAPE_ANGLE, false, "direction of the other end, counter-clockwise from it"}};

ADD(arc_strip)
{
  NO_POINTS;
  if (0.5 * value[3] >= value[2]) {
    return fault(region, location, "the strip is wider than its arc's diameter");
  }
  return add_ring_sector(region, value, value[2] - 0.5 * value[3], value[2] + 0.5 * value[3],
                         value[4], value[5], location);
}

SHAPE(arc_strip, "a strip along an arc, with straight ends", arc_strip);

/* ---- all of them ---- */

const struct dea_shape_type *const dea_shape_types[] = {
#define SHAPE_ENTRY(name) &dea_shape_##name,
    DEA_SHAPE_LIST(SHAPE_ENTRY)
#undef SHAPE_ENTRY
        NULL,
};

dea_status dea_region_add_shape(struct dea_region *region, const struct dea_shape_type *type,
                                const double *value, const double (*point_m)[2], size_t point_count,
                                struct dea_location location)
{
  double full[DEA_SHAPE_PARAMETERS_MAX] = {0};
  char what[200];
  for (size_t i = 0; i < type->count; i++) {
    const struct dea_shape_parameter *p = &type->parameter[i];
    full[i] = isnan(value[i]) && p->optional ? 0 : value[i];
    bool good = isfinite(full[i]) &&
                (p->unit != DEA_SHAPE_LENGTH || full[i] > 0 || (full[i] == 0 && p->optional));
    if (!good) {
      snprintf(what, sizeof what, "%s of the %s must be %s, not %g", p->name, type->name,
               p->unit == DEA_SHAPE_LENGTH ? "a length above 0" : "a number", full[i]);
      return fault(region, location, what);
    }
  }
  for (size_t i = 0; i < point_count; i++) {
    if (!isfinite(point_m[i][0]) || !isfinite(point_m[i][1])) {
      snprintf(what, sizeof what, "point %zu of the %s is no number", i + 1, type->name);
      return fault(region, location, what);
    }
  }
  if (point_count < type->points_min) {
    snprintf(what, sizeof what, "the %s needs %zu points or more, not %zu", type->name,
             type->points_min, point_count);
    return fault(region, location, what);
  }
  return type->add(region, full, point_m, point_count, location);
}
