/* Arcs that come and go: a current that is never above its limit for long enough to end a
 * measurement, and still burns the film. Two limits beside that of the lasting current: how often
 * it is exceeded within 10 s, and how much charge flows above it within about 1 s. What charging
 * the film explains counts for neither. Definitions: docs/theory/interlocks.md. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { DEA_ARC_COUNT_MAX = 100 };

/* What it is made of; fixed from the start on. */
struct dea_arc_limits {
  double rate_Hz;       // samples a second
  double current_A;     // above which it counts
  double most_A;        // that the amplifier gives, or the channel shows
  double charge_C;      // that ends it
  size_t count;         // of excursions in 10 s that ends it, at most DEA_ARC_COUNT_MAX
  double capacitance_F; // that charging may be explained with
  double settle_s;      // how long charging may last
};

struct dea_arc_watch {
  struct dea_arc_limits limits;
  double sample;      // number of the next one
  double settled;     // number of the first sample after the last charging has settled
  double explained_C; // charge that charging still explains
  double charge_C;    // that nothing explains, of about the last second
  bool above;         // the last sample was
  bool charging;      // the asked voltage changed steeply in the last sample
  double starts[DEA_ARC_COUNT_MAX]; // samples of the last excursions' starts, a ring
  size_t seen;                      // excursions
};

enum dea_arc_verdict { DEA_ARC_NONE, DEA_ARC_TOO_OFTEN, DEA_ARC_TOO_MUCH };

void dea_arc_watch_start(struct dea_arc_watch *watch, const struct dea_arc_limits *limits);
/* One sample: change of the asked voltage since the last one [V], and the current [A]; NAN: none.
 */
enum dea_arc_verdict dea_arc_watch_sample(struct dea_arc_watch *watch, double change_V,
                                          double current_A);
