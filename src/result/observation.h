/* What a model tells of the monitors, bodies and channels of a device (docs/theory/devices.md). */
#ifndef DEA_RESULT_OBSERVATION_H
#define DEA_RESULT_OBSERVATION_H

#include <stddef.h>

/* Of a monitor, in SI; NAN where it has no such quantity. Displacements and turns are from the flat
 * film, stretches too: of a line its length over the flat one, of a region means over its area. */
enum dea_observed {
  DEA_OBSERVED_X, // displacement; of a region its mean, of a body that of its centre
  DEA_OBSERVED_Y,
  DEA_OBSERVED_Z,
  DEA_OBSERVED_TURN_X, // of a body, rotation vector
  DEA_OBSERVED_TURN_Y,
  DEA_OBSERVED_TURN_Z,
  DEA_OBSERVED_STRETCH, // of a line
  DEA_OBSERVED_STRETCH_X,
  DEA_OBSERVED_STRETCH_Y,
  DEA_OBSERVED_AREA_STRETCH,
  DEA_OBSERVED_FORCE_X, // on a body, of what holds or moves it
  DEA_OBSERVED_FORCE_Y,
  DEA_OBSERVED_FORCE_Z,
  DEA_OBSERVED_MOMENT_X, // about its centre as it stands
  DEA_OBSERVED_MOMENT_Y,
  DEA_OBSERVED_MOMENT_Z,
  DEA_OBSERVED_COUNT
};

/* The first of them are motions, which answer to an excitation. */
enum { DEA_OBSERVED_MOTIONS = DEA_OBSERVED_FORCE_X };

/* The motion of a monitor that its estimated error is of: stretch of a line, area stretch of a
 * region, otherwise the largest displacement. */
enum dea_observed dea_observed_main(const double values[DEA_OBSERVED_COUNT]);

/* Of a channel; ground is [0]. */
struct dea_channel_values {
  double voltage_V;
  double charge_C;
  double capacitance_F; // change of its charge with its voltage, the film held; NAN: unknown
  double current_A;     // of its source in the last step of a history; NAN: there is none
};

struct dea_observation {
  size_t monitor_count, body_count, channel_count; // those of the layout
  const double (*monitor)[DEA_OBSERVED_COUNT];
  const double (*body)[DEA_OBSERVED_COUNT]; // each body as a monitor of it would tell
  const struct dea_channel_values *channel;
};

#endif
