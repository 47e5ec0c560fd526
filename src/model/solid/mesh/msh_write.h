/* Meshes for other programs: Gmsh's format 2.2 in ASCII. */
#ifndef DEA_MODEL_SOLID_MESH_MSH_WRITE_H
#define DEA_MODEL_SOLID_MESH_MSH_WRITE_H

#include "model/solid/mesh/fibre_disc.h"

/* Writes the mesh of a plate as second-order hexahedra (27 nodes), in m, with physical names for
 * its parts (film, film_active, fibre, glue, ...) and the faces that matter (frame, electrodes,
 * mirror planes; quadrilaterals of 9 nodes). A membrane is quadrilaterals itself, and its frame and
 * mirror planes lines of 3 nodes. DEA_E_ARGUMENT when its elements are not of order 2. */
dea_status dea_msh_write(struct dea_context *ctx, const struct dea_fibre_disc *plate,
                         const struct dea_grid *grid, const char *path);

#endif
