/* What is kept of a design: a column of load points, what a monitor of a device made of plies
 * shows, or a voltage at which the film comes to an end. */
#pragma once

#include "base/value.h"
#include "device/device.h"
#include "result/columns.h"
#include "result/observation.h"

/* Says that a name of the file is none of `what` [count], with the nearest of them. */
dea_status dea_explore_unknown(struct dea_context *ctx, const struct dea_label *label,
                               const char *what, const char *const names[], size_t count);

struct dea_explored {
  struct dea_column shown; // its key is the text below
  char key[80];            // as the file has it: "centre_z_m", "plate_turn_y_rad"
  int column;              // of the context; -1: a voltage of an event
  bool is_frequency;       // that of the lowest mode, which solving leaves out
  bool is_critical;        // a voltage of the event below
  enum dea_event_kind event;
  bool is_seen; // of a monitor or channel: that below
  struct dea_monitor_column of;
};

/* Finds a quantity by the key of a column (dea_column_find) or EVENT_voltage_V. *good: false after
 * a finding at its place. The texts that `shown` lends are those of *out, which stays where it is.
 */
dea_status dea_explored_find(struct dea_context *ctx, const struct dea_device *device,
                             const struct dea_label *label, struct dea_explored *out, bool *good);
