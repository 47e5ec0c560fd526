/* The meshes of model 3d as files, with names for their parts. */
#pragma once

#include "model/solid/actuator/layout_mesh.h"

/* Plies by their names, with "_active" where they are between electrodes; of a disc also the faces
 * that matter: frame, electrodes, mirror planes; of a membrane lines. Gmsh's format 2.2 in ASCII:
 * hexahedra of second order (27 nodes) and flat elements (9), in m, and the faces (9) and edges (3)
 * that are of a group. DEA_E_ARGUMENT for another order. */
dea_status dea_layout_mesh_write(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                                 const char *path);
