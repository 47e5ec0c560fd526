/* Free plane meshes by Gmsh, which is run as a program and never linked (docs/theory/mesh.md). */
#pragma once

#include "geometry/contour.h"
#include "model/solid/mesh/plane_mesh.h"

/* What the mesh is made of: its contours are sides of elements. A point is inside when it is in an
 * odd number of contours. Or a curve: a part of shapes' contours with a name of its own. */
struct dea_gmsh_shape {
  const char *name; // of the group of its elements, and of the named curve along its contours
  const struct dea_contour *contours; // [count], none crosses itself; closed, but those of curves
  size_t count;
  double edge_size_m; // of elements at the contours; 0: as elsewhere
  double layer_m;     // width of the rows of thin elements on both sides of them; 0: none
  bool rigid;         // inside of it none
};

struct dea_gmsh_plan {
  const struct dea_gmsh_shape *shapes; // [shape_count], which may overlap
  size_t shape_count;
  const struct dea_gmsh_shape *curves; // [curve_count]
  size_t curve_count;
  int order;                // of the elements, 1 or 2
  double size_m;            // of elements, up to which they grow away from fine edges
  double growth;            // by that share of the distance from them; 0: 0.4
  const double (*sizes)[3]; // [size_count] x, y, size there [m], in the place of all that; between
  size_t size_count;        // them sizes grow by that share
  size_t layer_rows;        // in that width
  double time_limit_s;      // of processor time; 0: 120
  const char *program;      // NULL: gmsh, from the PATH
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
