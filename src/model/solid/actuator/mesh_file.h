/* The meshes of model 3d as files, with names for their parts. */
#pragma once

#include "model/solid/actuator/layout_mesh.h"

/* Plies by their names, with "_active" where they are between electrodes; of a disc also the faces
 * that matter: frame, electrodes, mirror planes; of a membrane lines. See dea_msh_write. */
dea_status dea_layout_mesh_write(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                                 const char *path);
