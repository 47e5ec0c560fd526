/* Free plane meshes by Gmsh, which is run as a program and never linked (docs/theory/mesh.md). */
#ifndef DEA_MODEL_SOLID_MESH_GMSH_H
#define DEA_MODEL_SOLID_MESH_GMSH_H

#include "model/solid/mesh/plane_mesh.h"

/* Contours as those of a DXF file: a vertex is x [m], y [m] and the bulge towards the next one, the
 * tangent of a quarter of the arc's angle; > 0: counter-clockwise, 0: straight. */
struct dea_gmsh_contours {
  const double (*vertex)[3]; // of all contours, one after the other
  const size_t *end;         // [count] number of the vertex after a contour's last
  size_t count;
  bool open; // the last vertex of a contour does not go on to its first
};

/* What the mesh is made of: its contours are sides of elements. A point is inside when it is in an
 * odd number of contours. */
struct dea_gmsh_shape {
  const char *name; // of the group of its elements, and of the named curve along its contours
  struct dea_gmsh_contours contours; // closed, each without crossing itself
  double edge_size_m;                // of elements at the contours; 0: as elsewhere
};

/* A part of shapes' contours with a name of its own. */
struct dea_gmsh_curve {
  const char *name;
  struct dea_gmsh_contours contours;
  double edge_size_m;
};

struct dea_gmsh_plan {
  const struct dea_gmsh_shape *shapes; // [shape_count], which may overlap
  size_t shape_count;
  const struct dea_gmsh_curve *curves; // [curve_count]
  size_t curve_count;
  int order;           // of the elements, 1 or 2
  double size_m;       // of elements, up to which they grow away from fine edges
  double growth;       // by that share of the distance from them; 0: 0.4
  double time_limit_s; // 0: 120
  const char *program; // NULL: gmsh, from the PATH
};

/* Meshes all that is inside a shape. Groups are the shapes, in their order; curves the shapes'
 * contours, then the plan's curves. Where recombination leaves triangles or bad elements, other
 * ways to quadrilaterals are tried.
 *
 * DEA_E_TOOL, with the last lines that gmsh said: it is not installed, fails, crashes, takes too
 * long, or its mesh cannot be used. DEA_E_ARGUMENT for a plan without shapes or sizes. out: owned
 * by the caller, NULL on failure. */
dea_status dea_gmsh_mesh(struct dea_context *ctx, const struct dea_gmsh_plan *plan,
                         struct dea_plane_mesh **out);

#endif
