/* A channel at the end of its range says "at least", which no mean can be formed of. */
#include "reduce/reduce_parts.h"

static const double bearable = 0.01; // share of a part's samples: spikes

static bool is_at_end(const struct dea_channel *channel, double value)
{
  double margin = 0.5 * DEA_CHANNEL_END * (channel->highest - channel->lowest);
  return value <= channel->lowest + margin || value >= channel->highest - margin;
}

static bool is_saturated(const struct dea_channel *channel, struct dea_span span)
{
  if (!(span.end_s > span.begin_s)) {
    return false;
  }
  size_t begin = dea_channel_index(channel, span.begin_s), at_end = 0;
  size_t end = dea_channel_index(channel, span.end_s);
  for (size_t i = begin; i < end; i++) {
    at_end += is_at_end(channel, channel->values[i]);
  }
  return (double)at_end > bearable * (double)(end - begin);
}

size_t dea_saturation_drop(const struct dea_channel *channel, const struct dea_cycle_parts *parts,
                           size_t count, enum dea_reduced_kind kind,
                           struct dea_reduced_cycle *cycles)
{
  size_t dropped = 0;
  for (size_t i = 0; i < count && channel->lowest < channel->highest; i++) {
    struct dea_cycle_value *v = &cycles[i].values[kind];
    if (!isnan(v->amplitude) &&
        (is_saturated(channel, parts[i].rest) || is_saturated(channel, parts[i].active) ||
         is_saturated(channel, parts[i].after))) {
      *v = (struct dea_cycle_value){NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, 0};
      dropped++;
    }
  }
  return dropped;
}
