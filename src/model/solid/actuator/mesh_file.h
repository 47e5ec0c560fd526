/* The meshes of model 3d as files, with names for their parts. */
#ifndef DEA_MODEL_SOLID_ACTUATOR_MESH_FILE_H
#define DEA_MODEL_SOLID_ACTUATOR_MESH_FILE_H

#include "model/solid/actuator/layout_mesh.h"
#include "model/solid/mesh/fibre_disc.h"

/* Of a plate: film, film_active, fibre, glue, ... and the faces that matter: frame, electrodes,
 * mirror planes; of a membrane lines. See dea_msh_write. */
dea_status dea_fibre_disc_write(struct dea_context *ctx, const struct dea_fibre_disc *plate,
                                const struct dea_grid *grid, const char *path);
/* Of a layout: its plies by their names, with "_active" where they are between electrodes. */
dea_status dea_layout_mesh_write(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                                 const char *path);

#endif
