/* The plan: every length that parts are made from, in the flat film as it is stretched when parts
 * are bonded to it, from above, with the origin at the centre of the box of plies, bodies and
 * frame. What is cut unstretched is smaller by its ply's pre-stretch. */
#pragma once

#include "device/device.h"

enum { DEA_FAB_MARKS = 3 };

/* The pad at the end of an electrode's lead. */
struct dea_fab_pad {
  size_t electrode;
  double at_m[2];
};

struct dea_fab_plan {
  const struct dea_design *design; // lent
  const struct dea_device *device; // lent
  const struct dea_layout *layout; // lent
  struct dea_arena memory;
  double kerf_m, feature_m; // where they are cut: not stretched
  int copies;
  double stretch;      // the largest pre-stretch, of two axes their mean: of lengths that the
                       // design gives unstretched
  double centre_m[2];  // the origin, in the coordinates of the layout
  bool stretched;      // some ply has a pre-stretch
  bool held;           // some edge is held all around, so that the frame stays
  bool round;          // that edge is a circle: the frame is a ring, and films are cut round
  double opening_m[2]; // half sides of the box around the frame's opening, or radius twice
  double frame_m[2];   // of its outer edge
  double blank_m[2];   // of the film as it is cut

  double lead_width_m, pad_m, window_m; // width of a lead; radii of pads, and of holes over those
                                        // below, 0: none
  struct dea_fab_pad *pad;              // [pad_count]
  size_t pad_count;
  struct dea_region *inked; // [electrode_count] electrodes with leads and pads; owned

  size_t on_tabs; // the ply whose pieces hang in a holder on tabs; DEA_LAYOUT_NONE: none
  double piece_outer_m, piece_end_m; // distance of its pieces' outer ends, with their anchors
  double holder_m;                   // inner radius of their holder; without one that of the frame
  double tab_width_m;

  double mark_m; // radius of a mark
  double mark_at_m[DEA_FAB_MARKS][2];
  double grid_m, cross_m; // spacing of the grid; half a cross

  // in the layout's coordinates; owned
  struct dea_region hole;    // the frame's opening
  struct dea_region frame;   // its outer edge
  struct dea_region film;    // the edge of a film as it is cut
  struct dea_region sheet;   // the box around that
  struct dea_region marks;   // circles
  struct dea_region pads;    // circles, in the order of pad
  struct dea_region windows; // holes over the pads below
  struct dea_region bonded;  // pieces on tabs with their anchors
};

/* Fills it and checks what does not go together, each finding at its value: look at
 * dea_finding_count. out: to be freed, also after a failure. */
dea_status dea_fab_plan_build(struct dea_context *ctx, const struct dea_design *design,
                              const struct dea_device *device, struct dea_fab_plan *out);
void dea_fab_plan_free(struct dea_fab_plan *plan);

/* Adds pieces on tabs with their anchors, on the frame, and perhaps their tabs, which overlap. */
void dea_fab_add_pieces(const struct dea_fab_plan *plan, bool tabs, struct dea_region *out);

/* Parts that overlap as one region, into an empty one; the parts are freed. */
dea_status dea_fab_unite(struct dea_context *ctx, struct dea_region *parts, struct dea_region *out);

/* ---- of a layout ---- */

/* Whether a ply is cut, and whether it is cut as a blank that a frame then holds. */
bool dea_ply_is_cut(const struct dea_layout_ply *ply);
bool dea_ply_is_blank(const struct dea_layout *layout, size_t ply);
bool dea_ply_is_stretched(const struct dea_layout_ply *ply);
/* Whether the whole boundary of the ply's region is held, which the frame then does. */
bool dea_ply_is_held(const struct dea_layout *layout, size_t ply);
/* Number of the first ply that is cut as this one: of the same region, material, thickness and
 * pre-stretch. */
size_t dea_ply_like(const struct dea_layout *layout, size_t ply);
/* Number of the first ply of which that face is printed as this one's: with electrodes of the same
 * regions and leads, and the same pre-stretch. DEA_LAYOUT_NONE when no electrode lies on the face.
 */
size_t dea_face_like(const struct dea_layout *layout, size_t ply, bool top);
/* How many plies are like this one, which is the first of them. */
size_t dea_ply_count_like(const struct dea_layout *layout, size_t ply);
/* From the film free of stress to the flat one, as a matrix. */
void dea_ply_stretch(const struct dea_layout_ply *ply, double out[2][2]);
