/* Small motions as a model tells of them (model/model.h): points and shapes. */
#pragma once

#include "model/model.h"
#include "model/solid/assembly/internal_variables.h"
#include "model/solid/model3d/solid_observe.h"

/* A solid and what is reported of it. */
struct dea_motions {
  struct dea_solid *solid;
  const struct dea_grid *grid;
  const struct dea_observer *observer; // of what is reported of a disc
  const struct dea_branches *branches; // [part_material_count]
  size_t part_material_count;
  /* Gets the whole answer of each frequency, per volt; NULL: it is not wanted. */
  dea_status (*take)(struct dea_context *ctx, void *user, size_t i, const double *real,
                     const double *imaginary);
  void *user;
};

/* The middle surface of a ply whose displacement is a motion v [3 nodes], and whose other fields
 * are not to be read. out: owned by the caller, NULL on failure. */
dea_status dea_motions_surface(struct dea_context *ctx, const struct dea_motions *motions, int ply,
                               const double *v, struct dea_field_mesh **out);
/* As `modes` and `respond` of struct dea_model_type; ply: of the film. */
dea_status dea_motions_modes(struct dea_context *ctx, const struct dea_motions *motions, int ply,
                             const struct dea_load_point *at, size_t count,
                             struct dea_load_point *points, struct dea_field_mesh **shapes);
dea_status dea_motions_respond(struct dea_context *ctx, const struct dea_motions *motions,
                               const struct dea_load_point *at,
                               const struct dea_ac_excitation *excitation,
                               const double *frequency_Hz, size_t count,
                               struct dea_load_point *points);
