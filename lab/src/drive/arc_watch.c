#include "drive/arc_watch.h"

#include <math.h>

static const double window_s = 10;    // of the count
static const double memory_s = 1;     // of the charge
static const double steep = 0.5;      // share of the limit that charging has to reach
static const double monitor_s = 1e-5; // of an amplifier's current monitor

void dea_arc_watch_start(struct dea_arc_watch *watch, const struct dea_arc_limits *limits)
{
  *watch = (struct dea_arc_watch){.limits = *limits};
}

/* What a change of the asked voltage will draw: its charge, and that a sample may show the largest
 * current although it flows for a part of it only. */
static void explain(struct dea_arc_watch *watch, double change_V)
{
  const struct dea_arc_limits *l = &watch->limits;
  double charge_C = l->capacitance_F * fabs(change_V);
  bool charging = charge_C > steep * l->current_A * fmin(1 / l->rate_Hz, monitor_s);
  watch->explained_C *= exp(-1 / (l->rate_Hz * l->settle_s));
  if (charging) {
    watch->explained_C += charge_C + (watch->charging ? 0 : l->most_A / l->rate_Hz);
    watch->settled = watch->sample + 1 + ceil(l->settle_s * l->rate_Hz);
  }
  watch->charging = charging;
}

/* Whether this start is the last of too many within the window. */
static bool count_start(struct dea_arc_watch *watch)
{
  const struct dea_arc_limits *l = &watch->limits;
  watch->starts[watch->seen++ % l->count] = watch->sample;
  double first = watch->starts[watch->seen % l->count]; // of the last `count`
  return watch->seen >= l->count && watch->sample - first <= window_s * l->rate_Hz;
}

enum dea_arc_verdict dea_arc_watch_sample(struct dea_arc_watch *watch, double change_V,
                                          double current_A)
{
  const struct dea_arc_limits *l = &watch->limits;
  enum dea_arc_verdict verdict = DEA_ARC_NONE;
  explain(watch, change_V);
  watch->charge_C *= exp(-1 / (l->rate_Hz * memory_s));
  if (!isnan(current_A)) {
    double above_A = fabs(current_A) - l->current_A;
    double charge_C = fmax(above_A, 0) / l->rate_Hz;
    double explained_C = fmin(charge_C, watch->explained_C);
    watch->explained_C -= explained_C;
    watch->charge_C += charge_C - explained_C;
    bool starts = above_A > 0 && !watch->above && watch->sample >= watch->settled;
    watch->above = above_A > 0;
    if (starts && count_start(watch)) {
      verdict = DEA_ARC_TOO_OFTEN;
    } else if (watch->charge_C > l->charge_C) {
      verdict = DEA_ARC_TOO_MUCH;
    }
  }
  watch->sample++;
  return verdict;
}
