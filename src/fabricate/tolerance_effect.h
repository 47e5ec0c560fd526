/* What the workshop's tolerances do to a displacement: slope times tolerance, by a model's gradient
 * (docs/fabrication.md, docs/theory/gradients.md). */
#pragma once

#include "device/device.h"
#include "result/observation.h"

enum dea_deviation {
  DEA_DEVIATION_THICKNESS, // of the unstretched film
  DEA_DEVIATION_PRE_STRETCH,
  DEA_DEVIATION_ELECTRODE, // diameter
  DEA_DEVIATION_FRAME,     // inner diameter
  DEA_DEVIATION_FIBRE,     // distance of the fibre tips from the centre
  DEA_DEVIATION_COUNT
};

/* Of one displacement of a disc, by one model. */
struct dea_sensitivity {
  const char *model;                    // name; static storage, like what
  const char *what;                     // "electrode edge, outwards"
  double voltage_V;                     // NAN: the model has no state to be trusted
  double displacement_m;                // there
  double effect_m[DEA_DEVIATION_COUNT]; // of plus the tolerance; NAN: unknown
};

/* With fibres of their tip's height by model 3d, or where that has no state, by lumped; without
 * fibres of the electrode's edge by axisymmetric, which is exact there. At the highest quarter of
 * the design's highest voltage that is reached in states to be trusted, before a quarter at which
 * the film is foreseen to be slack. No finding is told. */
dea_status dea_sensitivity_find(struct dea_context *ctx, const struct dea_design *design,
                                const struct dea_device *device, struct dea_sensitivity *out);

enum dea_ply_deviation {
  DEA_PLY_THICKNESS,   // unstretched
  DEA_PLY_PRE_STRETCH, // along its first axis, or both where they are one number
  DEA_PLY_PRE_STRETCH_ACROSS,
  DEA_PLY_DEVIATIONS
};
enum { DEA_SEEN_MAX = 3 };

/* Of a device of plies, by model 3d. */
struct dea_layout_sensitivity {
  double voltage_V;                                   // NAN: the model has no state to be trusted
  size_t seen;                                        // monitors, the first ones of the layout
  enum dea_observed motion[DEA_SEEN_MAX];             // main ones
  double value[DEA_SEEN_MAX];                         // there
  double (*effect)[DEA_PLY_DEVIATIONS][DEA_SEEN_MAX]; // [ply_count] of plus the tolerance of this
                                                      // ply; NAN: unknown; owned by the caller
};

/* At the voltage of above. out->effect: to be freed also after a failure. */
dea_status dea_layout_sensitivity_find(struct dea_context *ctx, const struct dea_design *design,
                                       const struct dea_device *device,
                                       struct dea_layout_sensitivity *out);
