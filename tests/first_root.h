/* The equilibrium of model lumped by a scan, which knows nothing of its path. */
#pragma once

#include "model/lumped/lumped.h"

#include <math.h>

/* Whether the film still stretches further from there. */
static inline bool is_below_root(const struct dea_lumped *lumped, double field_V_per_m, double l_a)
{
  struct dea_lumped_balance balance;
  return dea_lumped_balance_eval(lumped, l_a, field_V_per_m, &balance) == DEA_OK &&
         balance.imbalance_Pa < 0;
}

/* The smallest stable electrode stretch of a disc without fibres at a nominal field, up to the
 * total stretch `most`: in small steps, then by halves. NAN: there is none. */
static inline double first_root(const struct dea_material *material, double pre_stretch,
                                double coverage, double field_V_per_m, double most)
{
  const struct dea_lumped lumped = {.film = {.material = material, .thickness_m = 1},
                                    .pre_stretch = pre_stretch,
                                    .coverage = coverage,
                                    .electrode_radius_m = 1};
  double low = 1, high = 1, end = fmin(most / pre_stretch, (1 - 1e-9) / coverage);
  while (is_below_root(&lumped, field_V_per_m, high)) {
    if (high >= end) {
      return (double)NAN;
    }
    low = high;
    high = fmin(1.002 * high, end);
  }
  for (double l = 0.5 * (low + high); l > low && l < high; l = 0.5 * (low + high)) {
    *(is_below_root(&lumped, field_V_per_m, l) ? &low : &high) = l;
  }
  struct dea_lumped_balance balance; // not the end of the law's domain
  return dea_lumped_balance_eval(&lumped, high, field_V_per_m, &balance) == DEA_OK ? high
                                                                                   : (double)NAN;
}
