#include "reduce/reduce_parts.h"

double dea_force_offset(const struct dea_channel *force, double before_s, double *scratch)
{
  if (force->count == 0) {
    return NAN;
  }
  double begin_s = dea_channel_time(force, 0);
  double end_s = isnan(before_s) ? dea_channel_time(force, force->count - 1) : before_s;
  struct dea_span first = {begin_s, fmin(begin_s + 0.5 * (end_s - begin_s), begin_s + 1.0)};
  return dea_window_mean(force, first, INFINITY, scratch).mean;
}
