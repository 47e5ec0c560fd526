/* A leakage current that rises: it is below every fixed limit, and still says that the film is
 * about to fail. Compared is the current at one place of a cycle with that at the same place of
 * earlier equal cycles, its base line, so that what charges the film, C dV/dt, is on both sides.
 * How the base line is learned and followed, and what ends a measurement:
 * docs/theory/interlocks.md. */
#pragma once

#include "protocol/protocol.h"

enum { DEA_LEAK_PARTS_MAX = 64, DEA_LEAK_GROUP = 5 };

/* One part of the cycle. Currents count in the direction of the voltage. */
struct dea_leak_part {
  // a value under way: medians of groups of samples, and their mean
  double group_A[DEA_LEAK_GROUP], sum_A, spent_s;
  unsigned in_group, groups;
  // a visit under way: the mean of its values
  double visit_sum_A, visit_start_s, visit_pass;
  bool begun; // it is
  unsigned visit_values;
  double visits_A[DEA_LEAK_VISITS]; // first ones
  unsigned visit_count;             // of these; then it has learned
  double base_A, least_base_A;      // base line, and the lowest that it has been at
  double scatter_A;                 // of visits, without their trend
  double above_s;                   // for how long in a row its values were too large
};

enum dea_leak_event {
  DEA_LEAK_NOTHING,
  DEA_LEAK_LEARNED, // every part that is under voltage has its base line
  DEA_LEAK_SCATTER, // equal cycles differ by so much that a base line shows nothing
  DEA_LEAK_DRIFTED, // the base line has come to where it must not go on
  DEA_LEAK_ROSE     // it ends
};

struct dea_leak_watch {
  const struct dea_protocol *protocol; // lent
  size_t step;                         // that is watched; SIZE_MAX: none yet
  double period_s;                     // of its equal cycles; NAN: nothing in it repeats
  double largest_V;                    // of it
  double cycle, level_V;               // number of the cycle of the waveform, and its level
  size_t part_count, learned, active;
  struct dea_leak_part parts[DEA_LEAK_PARTS_MAX];
  double last_s;  // of the last sample
  double above_s; // of all parts
  bool told, drifted, scattered;
  // of the event
  double value_A, limit_A;
};

void dea_leak_watch_start(struct dea_leak_watch *watch, const struct dea_protocol *protocol);
/* One sample: time on the sequence's clock, asked voltage, measured current (NAN: none). After
 * DEA_LEAK_ROSE: value_A and the limit_A that it was above; LEARNED, SCATTER, DRIFTED: the largest
 * base line, and the largest limit. */
enum dea_leak_event dea_leak_watch_sample(struct dea_leak_watch *watch, double time_s,
                                          double asked_V, double current_A);
