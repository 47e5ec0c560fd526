/* Voltage and series at common times (dea_reduced_series_fill). */
#include "reduce/output.h"

#include "base/sort.h"

#include <stdlib.h>

enum { COLUMNS_MAX = DEA_REDUCED_KINDS + 1 };

struct columns {
  const struct dea_channel *list[COLUMNS_MAX];
  size_t count, samples;
  double begin_s, end_s;
  double finest_s; // usual time between the samples of the fastest of them
};

static double spacing_of(const struct dea_channel *channel)
{
  double length_s = dea_channel_time(channel, channel->count - 1) - dea_channel_time(channel, 0);
  return channel->count > 1 ? length_s / (double)(channel->count - 1) : 0.0;
}

static void add_column(struct columns *columns, const struct dea_channel *channel)
{
  double begin_s = dea_channel_time(channel, 0);
  double end_s = dea_channel_time(channel, channel->count - 1);
  columns->begin_s = columns->count == 0 ? begin_s : fmin(columns->begin_s, begin_s);
  columns->end_s = columns->count == 0 ? end_s : fmax(columns->end_s, end_s);
  columns->finest_s =
      columns->count == 0 ? spacing_of(channel) : fmin(columns->finest_s, spacing_of(channel));
  columns->samples += channel->count;
  columns->list[columns->count++] = channel;
}

/* Times of the smallest and the largest value among samples begin <= i < end. */
static size_t add_extremes(const struct dea_channel *channel, size_t begin, size_t end,
                           double *times, size_t n)
{
  size_t low = end, high = end;
  for (size_t i = begin; i < end; i++) {
    if (!isnan(channel->values[i])) {
      low = low == end || channel->values[i] < channel->values[low] ? i : low;
      high = high == end || channel->values[i] > channel->values[high] ? i : high;
    }
  }
  if (low != end) {
    times[n++] = dea_channel_time(channel, low);
  }
  if (high != low) {
    times[n++] = dea_channel_time(channel, high);
  }
  return n;
}

/* Times that are kept of one column: all, or of even stretches. */
static size_t add_times(const struct columns *columns, size_t c, size_t stretches, double *times,
                        size_t n)
{
  const struct dea_channel *channel = columns->list[c];
  if (stretches == 0) {
    for (size_t i = 0; i < channel->count; i++) {
      times[n++] = dea_channel_time(channel, i);
    }
    return n;
  }
  double length_s = (columns->end_s - columns->begin_s) / (double)stretches;
  size_t begin = 0;
  for (size_t k = 1; k <= stretches; k++) {
    size_t end = k == stretches
                     ? channel->count
                     : dea_channel_index(channel, columns->begin_s + (double)k * length_s);
    n = end > begin ? add_extremes(channel, begin, end, times, n) : n;
    begin = end > begin ? end : begin;
  }
  return n;
}

/* The sample there, but for the rounding of two clocks; of fast channels also a straight line
 * between two neighbours. Else NAN: between the frames of a sensor nothing was measured. */
static double value_at(const struct dea_channel *channel, double time_s, double finest_s)
{
  double same_s = 1e-6 * finest_s;
  size_t i = dea_channel_index(channel, time_s - same_s);
  if (i < channel->count && dea_channel_time(channel, i) <= time_s + same_s) {
    return channel->values[i];
  }
  if (i == 0 || i == channel->count) {
    return NAN;
  }
  double a = dea_channel_time(channel, i - 1), b = dea_channel_time(channel, i);
  double share = (time_s - a) / (b - a);
  return b - a <= 2.5 * finest_s
             ? (1.0 - share) * channel->values[i - 1] + share * channel->values[i]
             : NAN;
}

static dea_status fill_values(struct dea_context *ctx, const struct dea_channel *channel,
                              const struct dea_reduced_series *table, double finest_s,
                              double **values)
{
  *values = dea_alloc(ctx, table->rows, sizeof **values);
  DEA_TRY_MEMORY(*values != NULL);
  for (size_t i = 0; i < table->rows; i++) {
    (*values)[i] = value_at(channel, table->time_s[i], finest_s);
  }
  return DEA_OK;
}

/* The measured voltage, or the asked one. */
static const struct dea_channel *voltage_of(const struct dea_recording *recording)
{
  const struct dea_channel *measured = dea_recording_kind(recording, DEA_CHANNEL_VOLTAGE);
  return measured != NULL && measured->count > 0
             ? measured
             : dea_recording_kind(recording, DEA_CHANNEL_COMMAND);
}

dea_status dea_reduced_series_fill(struct dea_context *ctx, const struct dea_recording *recording,
                                   const struct dea_reduction *reduction, size_t most,
                                   struct dea_reduced_series *out)
{
  struct columns columns = {0};
  const struct dea_channel *voltage = voltage_of(recording);
  *out = (struct dea_reduced_series){0};
  add_column(&columns, voltage); // there is one, or there were no reduction
  for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
    if (reduction->series[kind].count > 0) {
      add_column(&columns, &reduction->series[kind]);
    }
  }
  out->thinned = columns.samples > most;
  size_t stretches = out->thinned ? most / (2 * columns.count) : 0, n = 0;
  out->time_s = dea_alloc(ctx, out->thinned ? most : columns.samples, sizeof *out->time_s);
  DEA_TRY_MEMORY(out->time_s != NULL);
  for (size_t c = 0; c < columns.count; c++) {
    n = add_times(&columns, c, stretches, out->time_s, n);
  }
  qsort(out->time_s, n, sizeof *out->time_s, dea_rising);
  // two clocks' rounding, which is less than their steps also far from 0
  double same_s =
      fmin(1e-9 * fmax(fabs(columns.begin_s), fabs(columns.end_s)), 0.01 * columns.finest_s);
  for (size_t i = 0; i < n; i++) {
    if (out->rows == 0 || out->time_s[i] > out->time_s[out->rows - 1] + same_s) {
      out->time_s[out->rows++] = out->time_s[i];
    }
  }
  dea_status status = fill_values(ctx, voltage, out, columns.finest_s, &out->voltage_V);
  for (int kind = 0; kind < DEA_REDUCED_KINDS && status == DEA_OK; kind++) {
    if (reduction->series[kind].count > 0) {
      status =
          fill_values(ctx, &reduction->series[kind], out, columns.finest_s, &out->values[kind]);
    }
  }
  if (status != DEA_OK) {
    dea_reduced_series_free(ctx, out);
  }
  return status;
}

void dea_reduced_series_free(struct dea_context *ctx, struct dea_reduced_series *table)
{
  dea_free(ctx, table->time_s);
  dea_free(ctx, table->voltage_V);
  for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
    dea_free(ctx, table->values[kind]);
  }
  *table = (struct dea_reduced_series){0};
}
