/* Plane meshes from files of Gmsh (.msh, ASCII, formats 2.2 and 4.1). */
#pragma once

#include "model/solid/mesh/plane_mesh.h"

/* Reads the quadrilaterals of a file, of 4, 8 or 9 nodes (8 are completed by a middle one), all of
 * one order; triangles and volumes are refused. Physical surfaces become groups, physical curves
 * named curves; several of one name are one, and one without a name is called by its number. Every
 * quadrilateral has to be in a group. Nodes of one place are joined, elements turned
 * counter-clockwise and put in an order in which neighbours are near each other. unit_m: length of
 * a unit of the file (1e-3: it is in mm).
 *
 * DEA_E_DESIGN after a finding with file and line: no such file's form, elements that cannot be
 * used (which ones, how many, where), a mesh that is not plane. DEA_E_IO: it cannot be read. out:
 * owned by the caller, NULL on failure. */
dea_status dea_msh_read(struct dea_context *ctx, const char *file, double unit_m,
                        struct dea_plane_mesh **out);

/* The same of a text, which findings call `name`; NULL: faults are in the message of the context
 * only, and how bad an element may be is left to the caller. */
dea_status dea_msh_parse(struct dea_context *ctx, const char *text, const char *name, double unit_m,
                         struct dea_plane_mesh **out);

/* Elements whose smallest Jacobian is below that share of their mean one are refused. */
#define DEA_MSH_JACOBIAN_MIN 0.05

enum { DEA_MSH_FILE_MAX = 1000000000 }; // bytes
