/* Parts of a device of any layout, drawn from its regions (docs/fabrication.md, "Devices of any
 * layout"):
 *
 *   blank-PLY           a film that is to be stretched, as it is cut: unstretched
 *   stencil-PLY-SIDE    openings for all electrodes on a face: unstretched
 *   template            what lies where in the flat film, for paper
 *   frame               the plate that holds the films, or the edge that is a support
 *   ply-PLY             outline of a ply, in the flat film; of a film that the frame holds: none
 *   body-BODY           outline of a rigid body
 */
#pragma once

#include "fabricate/workshop.h"

/* Fills the list of parts of a workshop whose plan and room are made, unchecked. Notes say what is
 * to be known before cutting, such as loose pieces of a stencil. */
dea_status dea_layout_parts_make(struct dea_context *ctx, struct dea_workshop *workshop);

/* Whether the device needs the frame, and whether a ply has a part of its outline. */
bool dea_layout_has_frame(const struct dea_workshop *workshop);
bool dea_layout_has_outline(const struct dea_workshop *workshop, size_t ply);
/* Names of parts into out[DEA_PART_NAME]. */
enum { DEA_PART_NAME = 56 };
void dea_blank_name(const struct dea_layout *layout, size_t ply, char *out);
void dea_outline_name(const struct dea_layout *layout, size_t ply, char *out);
void dea_stencil_name(const struct dea_layout *layout, size_t ply, bool top, char *out);
void dea_body_name(const struct dea_layout *layout, size_t body, char *out);
/* Pieces that a part falls into once it is cut. */
size_t dea_part_pieces(const struct dea_part *part);
