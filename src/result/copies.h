/* The mirrored copies of a part that make up the whole (struct dea_field_mesh). */
#pragma once

#include "result/field_mesh.h"

/* x' = m x in the plane; z stays. */
struct dea_copy {
  double m[4];
  bool mirrored;
};

/* Number of copies, the part itself included. */
size_t dea_copy_count(const struct dea_field_mesh *mesh);
/* Copy 2k is turned by k times 2 pi/fold, copy 2k + 1 mirrored at the first plane of symmetry
 * before that. Copy 0 is the part itself. */
struct dea_copy dea_copy_at(const struct dea_field_mesh *mesh, size_t number);
/* A place or a vector in a copy. */
void dea_copy_move(const struct dea_copy *copy, const double in[3], double out[3]);

/* All copies of a part as one mesh; of a whole a copy of it. DEA_E_UNSUPPORTED for one with too
 * many points. out: owned by the caller, NULL on failure. */
dea_status dea_field_mesh_whole(struct dea_context *ctx, const struct dea_field_mesh *mesh,
                                struct dea_field_mesh **out);
