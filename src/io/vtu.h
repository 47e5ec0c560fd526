/* Fields for ParaView, meshio and the like: VTU files (unstructured grid, appended raw binary
 * in the machine's byte order, headers of 64 bits) and a PVD file that lines them up by voltage. */
#pragma once

#include "result/field_mesh.h"

/* Writes a mesh with its fields as a whole or not at all. Places and displacements are in double
 * precision, the other fields in single; an AXIS is a vector there. Elements of order 1 and 2 (in
 * the plane and through the thickness alike, or flat) are cells of that order, others are split
 * into linear ones at their nodes. whole: all mirrored copies, not just the part that was computed;
 * cells then have the number of the copy, 0 for the computed one. */
dea_status dea_vtu_write(struct dea_context *ctx, const struct dea_field_mesh *mesh,
                         double voltage_V, bool whole, const char *path);

/* One line of a PVD file. file: relative to it. */
struct dea_pvd_entry {
  double voltage_V;
  char file[80];
};
/* The voltage is the time of an entry where voltages only rise, else the number of the entry is:
 * readers take entries of one time for parts of one whole. */
dea_status dea_pvd_write(struct dea_context *ctx, const struct dea_pvd_entry *entries, size_t count,
                         const char *path);
