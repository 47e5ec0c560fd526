#include "reduce/reduce_parts.h"

/* Time at which a straight line between samples i and j is at a share of the way. */
static double crossing(const struct dea_channel *series, size_t i, size_t j, double level)
{
  double a = series->values[i], b = series->values[j];
  double t = dea_channel_time(series, i), u = dea_channel_time(series, j);
  return b != a ? t + (u - t) * (level - a) / (b - a) : u;
}

/* First number among samples begin <= i < end whose share of the way is at least so much; end when
 * there is none. *before: the number before it, or end. */
static size_t first_above(const struct dea_channel *series, size_t begin, size_t end, double from,
                          double way, double share, size_t *before)
{
  *before = end;
  for (size_t i = begin; i < end; i++) {
    if (!isnan(series->values[i])) {
      if ((series->values[i] - from) / way >= share) {
        return i;
      }
      *before = i;
    }
  }
  return end;
}

double dea_rise_time(const struct dea_channel *series, struct dea_span span, double from, double to,
                     double noise, double *end_s)
{
  double way = to - from;
  *end_s = NAN;
  if (!(span.end_s > span.begin_s) || !(fabs(way) > (noise > 0.0 ? 10.0 * noise : 0.0))) {
    return NAN;
  }
  size_t begin = dea_channel_index(series, span.begin_s);
  size_t end = dea_channel_index(series, span.end_s), last, low = 0, within = 0;
  // From the middle back to the last sample below 10 %, and on to the first above 90 %: so that
  // noise at rest does not count.
  size_t middle = first_above(series, begin, end, from, way, 0.5, &last), above = middle;
  for (size_t i = middle; i > begin; i--) {
    if ((series->values[i - 1] - from) / way <= 0.1) { // false for NAN
      low = i;
      break;
    }
    above = isnan(series->values[i - 1]) ? above : i - 1;
  }
  size_t top = first_above(series, above, end, from, way, 0.9, &last);
  if (top == end) {
    return NAN;
  }
  *end_s = dea_channel_time(series, top);
  for (size_t i = above; i < top && low > 0; i++) {
    within += isnan(series->values[i]) ? 0U : 1U;
  }
  if (within < 2) {
    return NAN;
  }
  return crossing(series, last, top, from + 0.9 * way) -
         crossing(series, low - 1, above, from + 0.1 * way);
}
