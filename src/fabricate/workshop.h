/* From a design to what a workshop needs: parts, and sheets with as many copies as are asked for.
 * Theory and defaults: docs/fabrication.md. */
#pragma once

#include "base/arena.h"
#include "fabricate/fab_plan.h"
#include "fabricate/part.h"

/* Copies of a part on its sheet: rows from the upper left corner. All parts of the unstretched film
 * have the same places, and all of the stretched one; on a sheet that is seen from the other side
 * they are mirrored as a whole, from the upper right corner. */
struct dea_sheet_layout {
  double width_m, height_m; // of the sheet; origin at its lower left corner
  double first_m[2];        // centre of the first copy
  double pitch_m[2];        // from one to the next, sideways and downwards
  int columns, count;
  bool mirrored; // rows go to the left
};

struct dea_workshop {
  struct dea_fab_plan plan;
  struct dea_part *part;           // [count] in the order of the work; owned
  struct dea_sheet_layout *layout; // [count] owned
  size_t count;
  struct dea_arena memory; // of these lists, and of names
};

/* Makes and checks everything. What does not fit gives findings with their place in the design and
 * DEA_E_DESIGN. design, device: lent, outlive it. out: owned by the caller. */
dea_status dea_workshop_create(struct dea_context *ctx, const struct dea_design *design,
                               const struct dea_device *device, struct dea_workshop **out);
void dea_workshop_destroy(struct dea_context *ctx, struct dea_workshop *workshop);

/* The part of that kind of a ply or body, or of the first ply that is cut or printed as that one;
 * NULL. */
const struct dea_part *dea_workshop_part(const struct dea_workshop *workshop,
                                         enum dea_part_kind kind, size_t of);
/* Centre of a copy on its sheet. */
void dea_sheet_place(const struct dea_sheet_layout *layout, int copy, double out_m[2]);
/* Tool path of contour i: the kerf's half outside of outer edges and inside of holes; what is only
 * marked stays as it is. out: of vertices *memory, owned by the caller. */
dea_status dea_workshop_path(const struct dea_workshop *workshop, const struct dea_part *part,
                             size_t i, struct dea_vertex **memory, struct dea_contour *out);
