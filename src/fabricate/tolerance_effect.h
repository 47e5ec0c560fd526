/* What the workshop's tolerances do to displacements: slope times tolerance, by a model's gradient
 * (docs/fabrication.md, docs/theory/gradients.md). */
#pragma once

#include "device/device.h"
#include "result/observation.h"
#include "study/design_gradient.h"

enum { DEA_SEEN_MAX = 3 };

/* A displacement or stretch that the effects are on. */
struct dea_seen {
  const char *name, *motion; // "fibre tip", "out of plane"; lent by the layout, or static
  bool length;               // in m, else a ratio
  double value;              // at the voltage, from the flat film
};

struct dea_tolerance_effects {
  const char *model; // name; static storage
  double voltage_V;  // NAN: the model has no state to be trusted
  size_t seen_count, number_count;
  struct dea_seen seen[DEA_SEEN_MAX];
  struct dea_design_number number[DEA_NUMBERS_MAX]; // with a tolerance
  size_t first[DEA_NUMBERS_MAX]; // the number that this one is shown with: of a ply cut alike
  double effect[DEA_NUMBERS_MAX][DEA_SEEN_MAX]; // of plus the tolerance; of tips: outwards; NAN:
                                                // unknown
};

/* On the first monitors, by model 3d. Of a disc without monitors: with fibres on their tip's height
 * by 3d, or where that has no state by lumped; without fibres on the electrode's edge by
 * axisymmetric, which is exact there. At the highest quarter of the design's highest voltage that
 * is reached in states to be trusted, before a quarter at which the film is foreseen to be slack.
 * No finding is told. solve: else the numbers alone. */
dea_status dea_tolerance_effects_find(struct dea_context *ctx, const struct dea_design *design,
                                      const struct dea_device *device, bool solve,
                                      struct dea_tolerance_effects *out);
/* Effects of the number of a key, or of the first one whose key begins so; NULL. */
const double *dea_tolerance_effect(const struct dea_tolerance_effects *effects, const char *key);
