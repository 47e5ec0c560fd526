/* What a deviation of a length does to the displacement, by the quick models. */
#ifndef DEA_FABRICATE_SENSITIVITY_H
#define DEA_FABRICATE_SENSITIVITY_H

#include "device/device.h"

// X(name, what it is)
#define DEA_DEVIATION_LIST(X)                                                                      \
  X(THICKNESS, "thickness of the unstretched film")                                                \
  X(PRE_STRETCH, "pre-stretch")                                                                    \
  X(ELECTRODE, "diameter of the electrodes")                                                       \
  X(FRAME, "inner diameter of the frame")                                                          \
  X(FIBRE, "distance of the fibre tips from the centre")

enum dea_deviation {
#define DEA_DEVIATION_ENUM(name, what) DEA_DEVIATION_##name,
  DEA_DEVIATION_LIST(DEA_DEVIATION_ENUM)
#undef DEA_DEVIATION_ENUM
      DEA_DEVIATION_COUNT
};

/* What is asked of a model: one displacement of its points. */
struct dea_sensitivity {
  const char *model;                    // name
  const char *what;                     // "electrode edge"
  double displacement_m;                // of the design at the voltage; NAN: unknown
  double effect_m[DEA_DEVIATION_COUNT]; // for the tolerance, half of the way from minus to plus
                                        // (central difference); NAN: the model does not know
};

enum { DEA_SENSITIVITIES = 2 };

/* Sensitivities at the highest voltage of the design, or at the highest of 3/4, 1/2 and 1/4 of it
 * at which both models have equilibria. *voltage_V: NAN when there are none: then nothing is known.
 */
dea_status dea_sensitivities_find(struct dea_context *ctx, const struct dea_design *design,
                                  const struct dea_device *device, double *voltage_V,
                                  struct dea_sensitivity out[DEA_SENSITIVITIES]);

#endif
