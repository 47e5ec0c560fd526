/* Lines of a plate's mesh that go from its core outwards, and the circles that they cross.
 *
 * Symbol   meaning                                                              unit
 * l        place between the first line (0: fibre axis) and the last (count)    1
 * alpha    angle of a sector, pi/N                                              rad */
#ifndef DEA_MODEL_SOLID_MESH_FIBRE_DISC_LINES_H
#define DEA_MODEL_SOLID_MESH_FIBRE_DISC_LINES_H

#include "model/solid/mesh/fibre_disc.h"

enum { DEA_FIBRE_DISC_CIRCLES_MAX = 4 };

struct dea_fibre_disc_lines {
  const struct dea_fibre_disc *plate; // lent
  double alpha;
  size_t across;                             // elements across half a fibre, 0 without fibres
  size_t count;                              // elements between the first line and the last
  double circle[DEA_FIBRE_DISC_CIRCLES_MAX]; // radii, ascending: the last is the frame
  size_t circle_count;
};

/* The lines of a plate. DEA_E_ARGUMENT as in dea_fibre_disc_create. */
dea_status dea_fibre_disc_lines_create(struct dea_context *ctx, const struct dea_fibre_disc *plate,
                                       struct dea_fibre_disc_lines *out);

/* Angle at which the line l crosses the circle of that radius. */
double dea_fibre_disc_line_angle(const struct dea_fibre_disc_lines *lines, double l, double radius);
/* The place itself. */
void dea_fibre_disc_line_point(const struct dea_fibre_disc_lines *lines, double l, double radius,
                               double x[2]);

#endif
