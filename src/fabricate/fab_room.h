/* What the parts of a device of any layout have in common: the frame around it, the film as it is
 * cut, and marks that meet in all sheets. Lengths in the flat film, from the centre of the box of
 * plies and bodies. */
#pragma once

#include "fabricate/fab_geometry.h"

struct dea_fab_room {
  double centre_m[2];     // of that box, in the coordinates of the layout
  bool stretched;         // some ply has a pre-stretch
  bool held;              // some edge is held all around, so that the frame stays
  struct dea_region hole; // of the frame where it is held: in the layout's coordinates; owned
  double opening_m[2];    // half sides of the box around the frame's opening
  double frame_m[2];      // of its outer edge
  double blank_m[2];      // of the film as it is cut
  double mark_m;          // radius of a mark
  double mark_at_m[DEA_FAB_MARKS][2];
  double grid_m, cross_m; // spacing of the grid; half a cross
};

/* Fills it and checks what does not go together, each finding at its value. out: to be freed, also
 * after a failure, which is one of memory. */
dea_status dea_fab_room_make(struct dea_context *ctx, const struct dea_fab_geometry *plan,
                             struct dea_fab_room *out);
void dea_fab_room_free(struct dea_fab_room *capacity);

/* ---- of a layout ---- */

bool dea_ply_is_stretched(const struct dea_layout_ply *ply);
/* Whether the whole boundary of the ply's region is held, which the frame then does. */
bool dea_ply_is_held(const struct dea_layout *layout, size_t ply);
/* Number of the first ply that is cut as this one: of the same region, material, thickness and
 * pre-stretch. */
size_t dea_ply_like(const struct dea_layout *layout, size_t ply);
/* Number of the first ply of which that face is printed as this one's: with electrodes of the same
 * regions, and the same pre-stretch. DEA_LAYOUT_NONE when no electrode lies on the face. */
size_t dea_face_like(const struct dea_layout *layout, size_t ply, bool top);
/* How many plies are like this one, which is the first of them. */
size_t dea_ply_count_like(const struct dea_layout *layout, size_t ply);
/* From the film free of stress to the flat one, as a matrix. */
void dea_ply_stretch(const struct dea_layout_ply *ply, double out[2][2]);
