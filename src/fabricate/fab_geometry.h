/* The plan: every length that the parts are made from, in the stretched film (what the unstretched
 * film gets is smaller by the pre-stretch), seen from the fibres, x along the first fibre. */
#pragma once

#include "device/device.h"

enum { DEA_FAB_MARKS = 3 };
enum dea_fab_geometry_side { DEA_FAB_TOP, DEA_FAB_BOTTOM };

/* Of a device that is no disc the next five stand alone (fab_room.h has the rest). */
struct dea_fab_geometry {
  const struct dea_design *design; // lent
  const struct dea_device *device; // lent
  double kerf_m, feature_m;        // where they are cut: not stretched
  int copies;
  double stretch; // the pre-stretch

  double electrode_m;         // radius
  double lead_width_m;        // of both leads
  double lead_angle_rad[2];   // enum dea_fab_geometry_side
  double pad_m, pad_centre_m; // radius; distance from the centre
  double contact_window_m;    // radius of the hole in the ring at the lower pad; 0: none

  double frame_m, ring_m; // inner and outer radius of the ring
  double blank_m;         // radius of the film as it is cut

  double fibre_outer_m; // distance of a fibre's outer end, as simulated, from the centre
  double fibre_end_m;   // distance of a fibre's outer end, with its anchor, from the centre
  double holder_m;      // inner radius of the fibres' holder; its outer one is that of the ring
  double tab_width_m;

  double mark_m, mark_centre_m; // radius; distance from the centre
  double mark_angle_rad[DEA_FAB_MARKS];
  double grid_m, cross_m; // spacing of the grid; half a cross
};

/* Fills the plan and checks what does not go together, each finding at its value. Fails only for
 * memory; look at dea_finding_count. */
dea_status dea_fab_geometry_make(struct dea_context *ctx, const struct dea_design *design,
                                 const struct dea_device *device, struct dea_fab_geometry *out);
/* A finding when the kerf is too wide for the smallest feature. */
dea_status dea_fab_check_cutter(struct dea_context *ctx, const struct dea_fab_geometry *plan);
