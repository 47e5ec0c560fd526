/* What a curve in time says: its cycles, its balance of energy. */
#pragma once

#include "result/result.h"

/* One cycle of the waveform, as a column of the curve shows it. */
struct dea_cycle {
  double start_s, end_s;
  double level_V;         // of the waveform
  double highest, lowest; // [SI] of the column
  double amplitude;       // highest - lowest
  double farthest;        // of the two, the one farther from the value at the start
  double rise_time_s;     // from 10 to 90 % of the way to the farthest; NAN without a way
};

/* Work of the supply against what it became, at the worst point of a curve in time. */
struct dea_energy_balance {
  double supply_work_J, stored_J, kinetic_J, dissipated_J; // from the first to the last point
  double largest_J; // energy that the error is relative to: largest of any of the four
  double error;     // |work - stored - kinetic - dissipated| over it, at the worst point
};

/* Column that shows how the actuator moves: the centre's displacement where it moves, else the
 * electrode's edge; -1 without any. */
int dea_time_series_column(const struct dea_curve *curve);
/* Cycles of the waveform that the curve holds to their end. cycles: owned by the caller (dea_free),
 * NULL when there are none. */
dea_status dea_time_series_cycles(struct dea_context *ctx, const struct dea_curve *curve,
                                  const struct dea_waveform *waveform, int column,
                                  struct dea_cycle **cycles, size_t *count);
/* Last cycle of those that follow `first` at the same voltage. */
size_t dea_time_series_level_end(const struct dea_cycle *cycles, size_t count, size_t first);
/* false when the curve has no energies. */
bool dea_time_series_balance(const struct dea_curve *curve, struct dea_energy_balance *out);
