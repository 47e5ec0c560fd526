/* What a model tells of the monitors, bodies and channels of a device (docs/theory/devices.md). */
#pragma once

#include "base/arena.h"
#include "device/layout.h"
#include "result/columns.h"
#include "result/result.h"

#include <stdbool.h>
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
  DEA_OBSERVED_OUTWARDS, // of a radius, displacement
  DEA_OBSERVED_STRETCH,  // of a line or radius
  DEA_OBSERVED_STRETCH_X,
  DEA_OBSERVED_STRETCH_Y,
  DEA_OBSERVED_AREA_STRETCH,
  DEA_OBSERVED_FORCE_X, // on a body, of what holds or moves it
  DEA_OBSERVED_FORCE_Y,
  DEA_OBSERVED_FORCE_Z,
  DEA_OBSERVED_MOMENT_X, // about its centre as it stands
  DEA_OBSERVED_MOMENT_Y,
  DEA_OBSERVED_MOMENT_Z,
  DEA_OBSERVED_PRESSURE, // on a face, and the volume that it has swept
  DEA_OBSERVED_VOLUME,
  DEA_OBSERVED_CONTACT_FORCE, // of a face on what it touches, and the area that touches
  DEA_OBSERVED_CONTACT_AREA,
  DEA_OBSERVED_COUNT
};

/* The first of them are motions, which answer to an excitation. */
enum { DEA_OBSERVED_MOTIONS = DEA_OBSERVED_FORCE_X };

/* The motion of a monitor that its estimated error is of: stretch of a line, area stretch of a
 * region, swept volume, otherwise the largest displacement. */
enum dea_observed dea_observed_main(const double values[DEA_OBSERVED_COUNT]);

/* Of a channel; ground is [0]. */
struct dea_channel_values {
  double voltage_V;
  double charge_C;
  double capacitance_F; // change of its charge with its voltage, the film held; NAN: unknown
  double current_A;     // of its source in the last step of a history; NAN: there is none
};

/* Key, units, title and meaning of a quantity of monitors: "z_m", "z". */
extern const struct dea_column dea_observed_columns[DEA_OBSERVED_COUNT];
/* Whether a monitor of a kind has such a quantity. */
bool dea_observed_has(enum dea_layout_monitor_kind kind, enum dea_observed observed);
/* The quantity of a monitor that a disc brings which is a column of load points: "centre_z_m". */
int dea_observed_of_disc(const struct dea_layout_monitor *monitor, enum dea_observed *observed);

/* Whether a column is of a monitor's or channel's quantity of that key, NULL: of any: "hub_z_m" of
 * "z_m", not of an error; and the length of the monitor's name in its title. */
bool dea_observed_is(const struct dea_column *column, const char *key);
size_t dea_observed_name_length(const struct dea_column *column);

/* What a column of monitors and channels is of. */
enum dea_monitor_source {
  DEA_OF_MONITOR,
  DEA_OF_MONITOR_ERROR, // the estimated error of that quantity of a monitor
  DEA_OF_CHANNEL,
  DEA_OF_AMPLITUDE,
  DEA_OF_PHASE
};
enum {
  DEA_OBSERVED_VOLTAGE,
  DEA_OBSERVED_CHARGE,
  DEA_OBSERVED_CAPACITANCE,
  DEA_OBSERVED_CURRENT,
  DEA_OBSERVED_OF_CHANNEL
};

struct dea_monitor_column {
  int column; // of the context
  enum dea_monitor_source source;
  size_t index;  // of the monitor or channel
  size_t number; // enum dea_observed; DEA_OBSERVED_VOLTAGE, ...
};

/* Columns of what the monitors and channels but ground of a layout show, in this order, and their
 * number. The key is the name as a part of a key and that of the quantity: "hub_z_m",
 * "left_charge_C"; where two names are the same as parts of keys the second has "_2" behind it. The
 * title is the name and that of the quantity: "hub z". Those that the context does not have are
 * added to it. */
dea_status dea_layout_columns(struct dea_arena *memory, const struct dea_layout *layout,
                              struct dea_monitor_column **out, size_t *count);
/* The same of what the motions of monitors do by an excitation: "hub_z_amplitude_m"
 * (DEA_OF_AMPLITUDE) and, against the excitation, "hub_z_phase_rad" (DEA_OF_PHASE). */
dea_status dea_layout_answer_columns(struct dea_arena *memory, const struct dea_layout *layout,
                                     struct dea_monitor_column **out, size_t *count);
/* Adds the columns of a device to the context. */
dea_status dea_device_columns_add(struct dea_context *ctx, const struct dea_device *device);
/* What a column of a layout is of; false: it is none of the layout's. */
dea_status dea_layout_column_find(struct dea_context *ctx, const struct dea_layout *layout,
                                  int column, struct dea_monitor_column *out, bool *found);

/* How far a column changes along a curve; where it does not (one voltage), its largest size; 0
 * without a number. */
double dea_curve_change(const struct dea_curve *curve, int column);
/* Of each monitor that a curve has: the displacement along the axis that it moves along most, the
 * turn about the axis that it turns about most, its stretch; what changes by rounding only is left
 * out. out: at most max columns; returns their number. */
size_t dea_curve_headlines(const struct dea_context *ctx, const struct dea_curve *curve, int *out,
                           size_t max);

struct dea_observation {
  size_t monitor_count, body_count, channel_count; // those of the layout
  const double (*monitor)[DEA_OBSERVED_COUNT];
  const double (*body)[DEA_OBSERVED_COUNT]; // each body as a monitor of it would tell
  const struct dea_channel_values *channel;
};
