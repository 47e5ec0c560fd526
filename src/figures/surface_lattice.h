/* The middle surface of a film as it is drawn: patches and lines of the whole disc, from the
 * elements of the part that was computed and their mirrored copies. */
#pragma once

#include "result/result.h"

/* Whether the i-th surface is of the first model with surfaces, which figures show. */
bool dea_surface_is_first(const struct dea_result *result, size_t i);
/* Up to `max` of them from first to last, evenly; returns their number. */
size_t dea_surface_spread(const struct dea_result *result, size_t max,
                          const struct dea_surface_record *out[]);
/* Those of them that are on the mesh of the first. */
size_t dea_surface_spread_same(const struct dea_result *result, size_t max,
                               const struct dea_surface_record *out[]);
/* Whether it has shapes of modes. */
bool dea_surface_has_shapes(const struct dea_surface_record *record);

/* Columns of a point: place in the stretched flat film, displacement [m]. */
enum {
  DEA_LATTICE_X,
  DEA_LATTICE_Y,
  DEA_LATTICE_UX,
  DEA_LATTICE_UY,
  DEA_LATTICE_UZ,
  DEA_LATTICE_COLUMNS
};

/* An element on a lattice of n x m pieces, by its own polynomials. */
struct dea_patch {
  int n, m;
  double (*at)[DEA_LATTICE_COLUMNS]; // [(n + 1) (m + 1)], first local axis fastest
};

struct dea_surface_lattice {
  size_t patch_count;
  struct dea_patch *patches;         // [patch_count], owned
  double (*at)[DEA_LATTICE_COLUMNS]; // of all patches, owned
  double low_m[2], high_m[2];        // least and largest x and y
  double centre_m[2];                // middle of that box; 0, 0 of what is around the origin
  double radius_m;                   // of the outermost point, from there
  double z_min_m, z_max_m;           // of the displacement
};

/* mesh: flat blocks with a displacement. pieces: about how many of equal size would make up the
 * disc; smaller elements are one piece each. DEA_E_ARGUMENT for a mesh without displacement or with
 * blocks that are not flat. out: dea_surface_lattice_free, also after a failure. */
dea_status dea_surface_lattice_create(struct dea_context *ctx, const struct dea_field_mesh *mesh,
                                      size_t pieces, struct dea_surface_lattice *out);
void dea_surface_lattice_free(struct dea_context *ctx, struct dea_surface_lattice *drawing);

/* Lines along edges of elements. */
enum dea_outline_kind { DEA_OUTLINE_FRAME, DEA_OUTLINE_ELECTRODE, DEA_OUTLINE_FIBRE };
struct dea_outline {
  enum dea_outline_kind kind;
  double at[DEA_MESH_ORDER_MAX * 4 + 1][DEA_LATTICE_COLUMNS];
  int count;
};
/* The disc's edge, and where cells with and without `between_electrodes` or `under_fibre` meet.
 * out: [*count], owned by the caller. */
dea_status dea_surface_lattice_outlines(struct dea_context *ctx, const struct dea_field_mesh *mesh,
                                        struct dea_outline **out, size_t *count);

/* Displacement along the line through the centre at an angle: s from the centre, rising; [count],
 * owned by the caller (one array: s, then uz). Exact at the lines of the patches' lattice that are
 * crossed.
 */
dea_status dea_surface_lattice_section(struct dea_context *ctx,
                                       const struct dea_surface_lattice *drawing, double angle,
                                       double **out, size_t *count);
