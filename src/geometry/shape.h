/* Shapes that a region is made of. */
#pragma once

#include "geometry/region.h"
#include "geometry/shape_list.h"

enum dea_shape_unit {
  DEA_SHAPE_POSITION, // [m], of any sign
  DEA_SHAPE_LENGTH,   // [m], > 0, or >= 0 of an optional one
  DEA_SHAPE_ANGLE,    // [rad], counter-clockwise from the x axis
};

struct dea_shape_parameter {
  const char *name; // "inner_radius"
  enum dea_shape_unit unit;
  bool optional; // then it is 0 when it is not given
  const char *doc;
};

enum { DEA_SHAPE_PARAMETERS_MAX = 8 };

struct dea_shape_type {
  const char *name, *doc;
  const struct dea_shape_parameter *parameter; // [count]
  size_t count;
  size_t points_min; // > 0: made of so many points at least
  const char *points_doc;
  /* Adds the shape; values and points are in range. What does not go together is dea_region_fault.
   */
  dea_status (*add)(struct dea_region *region, const double *value, const double (*point_m)[2],
                    size_t point_count, struct dea_location location);
};

#define DEA_SHAPE_DECLARE(name) extern const struct dea_shape_type dea_shape_##name;
DEA_SHAPE_LIST(DEA_SHAPE_DECLARE)
#undef DEA_SHAPE_DECLARE

/* All types, ended by NULL. */
extern const struct dea_shape_type *const dea_shape_types[];

/* Adds a shape to a region. value: [count] in SI in the order of its parameters, NAN for one that
 * is not given; point_m: NULL and 0 where the shape has none. location: of the shape in the input.
 * What is wrong is a finding there, the message of the context and DEA_E_DESIGN. */
dea_status dea_region_add_shape(struct dea_region *region, const struct dea_shape_type *type,
                                const double *value, const double (*point_m)[2], size_t point_count,
                                struct dea_location location);
