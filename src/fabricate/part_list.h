/* The parts: one file each and one line here, in the order of the work. */
#pragma once

#include "fabricate/fab_geometry.h"
#include "fabricate/part.h"

struct dea_part_type {
  const char *name, *title, *seen; // as in struct dea_part
  enum dea_film_state state;
  bool paper, mirrored;
  bool of_fibres; // only for designs with fibres
  void (*build)(const struct dea_fab_geometry *plan, struct dea_part *part);
};

// X(name of the `const struct dea_part_type`)
#define DEA_PART_LIST(X)                                                                           \
  X(dea_part_film)                                                                                 \
  X(dea_part_stencil_bottom)                                                                       \
  X(dea_part_stencil_top)                                                                          \
  X(dea_part_template)                                                                             \
  X(dea_part_ring)                                                                                 \
  X(dea_part_fibres)

#define DEA_PART_DECLARE(name) extern const struct dea_part_type name;
DEA_PART_LIST(DEA_PART_DECLARE)
#undef DEA_PART_DECLARE

/* ---- what several parts have in common; lengths times `scale`, 1/pre-stretch for the unstretched
 * film ---- */

/* The outline of an electrode with its lead and pad: one contour. mirrored: seen from the other
 * side. */
void dea_draw_electrode(const struct dea_fab_geometry *plan, enum dea_fab_geometry_side side,
                        bool mirrored, double scale, enum dea_layer layer, struct dea_part *part);
/* The alignment marks, on a layer. */
void dea_draw_marks(const struct dea_fab_geometry *plan, bool mirrored, double scale,
                    enum dea_layer layer, struct dea_part *part);
/* Crosses of the grid on film that is neither in the frame's opening nor inked. */
void dea_draw_grid(const struct dea_fab_geometry *plan, double scale, struct dea_part *part);
/* One fibre without its anchor, as simulated: a closed contour. */
void dea_draw_fibre(const struct dea_fab_geometry *plan, int number, enum dea_layer layer,
                    struct dea_part *part);
/* What a fibre that the frame holds has on the ring: a closed contour; nothing of a free one. */
void dea_draw_anchor(const struct dea_fab_geometry *plan, int number, enum dea_layer layer,
                     struct dea_part *part);
