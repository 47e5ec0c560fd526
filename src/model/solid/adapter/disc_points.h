/* The monitors that a disc brings along, which are columns of load points: centre, fibre tip and
 * electrode edge. */
#ifndef DEA_MODEL_SOLID_ADAPTER_DISC_POINTS_H
#define DEA_MODEL_SOLID_ADAPTER_DISC_POINTS_H

#include "model/solid/actuator/layout_mesh.h"
#include "model/solid/assembly/solid.h"
#include "result/load_point.h"

/* Nodes; of the film's middle plane there are two where elements of odd order have none in it, one
 * on each side, or the same one twice. */
struct dea_disc_points {
  size_t centre[2], edge[2]; // of the electrode, in the middle between two fibres
  size_t tip;                // where film and fibre meet
  bool has_fibres;
  double radius_m;    // of the electrode
  double outwards[2]; // direction at the edge
};

/* mesh: of blocks. */
void dea_disc_points_find(const struct dea_layout_mesh *mesh, struct dea_disc_points *out);
/* What they are at displacements u. */
void dea_disc_points_describe(const struct dea_disc_points *points, const double *u,
                              struct dea_load_point *out);
/* Adds the slope of a column by u to weight; false: it is none of these. */
bool dea_disc_points_weigh(const struct dea_disc_points *points, const char *key, double *weight);
/* Estimated errors of all three at the solid's equilibrium, if the point is one of which they say
 * something. */
dea_status dea_disc_points_errors(struct dea_context *ctx, const struct dea_disc_points *points,
                                  struct dea_solid *solid, struct dea_load_point *out);

#endif
