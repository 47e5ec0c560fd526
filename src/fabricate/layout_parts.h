/* Parts of a device, drawn from its layout and the plan (docs/fabrication.md), in the order of the
 * work, and their names:
 *
 *   blank-PLY           a film that a frame holds, as it is cut: unstretched
 *   stencil-PLY-SIDE    openings for all electrodes on a face, leads and pads: unstretched
 *   template            what lies where in the flat film, for paper
 *   frame               the plate that holds the films, or the edge that is a support
 *   ply-PLY             outline of a ply, in the flat film, or its pieces in their holder
 *   body-BODY           outline of a rigid body
 *
 * A ply that brings a name of its own (struct dea_layout_ply) has that for its blank or outline,
 * and its stencils are stencil-SIDE. */
#pragma once

#include "fabricate/workshop.h"

/* Fills the list of parts of a workshop whose plan is made, unchecked. Notes say what is to be
 * known before cutting, such as loose pieces of a stencil. */
dea_status dea_parts_build(struct dea_context *ctx, struct dea_workshop *workshop);

/* Pieces that a part falls into once it is cut. */
size_t dea_part_pieces(const struct dea_part *part);
