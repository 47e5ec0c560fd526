#include "reduce/reduce_parts.h"

#include <stdlib.h>
#include <string.h>

enum { LAGS_MAX = 4000, BASE_BLOCKS = 1024 };
static const double resolution = 1e-5; // of a converter of 16 bit: no step is taken for less

struct search {
  struct dea_context *ctx;
  const struct dea_channel *current, *asked, *measured;
  const struct dea_voltage_scale *scale;
  struct dea_plateau *plateaus; // of the asked voltage, in samples of the current
  size_t plateau_count;
  double *residual; // [current->count]: without leakage; NAN where not looked at
  double *work;     // [current->count]
  double step;      // of the converter
  struct dea_current_limits limits;
  struct dea_discharge *found;
  size_t count, capacity;
};

double dea_discharge_threshold(size_t samples)
{
  double low = 3.0, high = 10.0;
  for (int i = 0; i < 60; i++) {
    double k = 0.5 * (low + high);
    if ((double)samples * erfc(k / sqrt(2.0)) < 0.1) {
      high = k;
    } else {
      low = k;
    }
  }
  return high;
}

static dea_status add(struct search *s, struct dea_discharge discharge)
{
  DEA_TRY(s->ctx, dea_array_grow(s->ctx, &s->found, s->count, &s->capacity, sizeof discharge));
  s->found[s->count++] = discharge;
  return DEA_OK;
}

/* Value of another channel at a sample of the current; NAN outside. */
static double at_sample(const struct search *s, const struct dea_channel *channel, size_t i)
{
  size_t k = dea_channel_index(channel, dea_channel_time(s->current, i));
  return k < channel->count ? channel->values[k] : NAN;
}

/* Mean of `count` samples in a row from `first` on, or back, that are numbers; NAN without. */
static double mean_of(const double *u, size_t first, bool back, size_t count)
{
  double sum = 0.0, n = 0.0;
  for (size_t k = 0; k < count; k++) {
    double value = u[back ? first - k : first + k];
    sum += isnan(value) ? 0.0 : value;
    n += isnan(value) ? 0.0 : 1.0;
  }
  return sum / n;
}

/* How many samples at an end of a plateau are of a ramp, whose foot lies within the tolerance and
 * charges already: the mean of the outer ones, ever more of them, tells it from noise, but for the
 * first 4 sigma, for which as many as between 4 and 12 are given up. */
static size_t foot_of(const struct dea_channel *voltage, const struct dea_plateau *p,
                      double noise_V, bool back)
{
  const double *u = voltage->values;
  size_t n = p->end - p->begin, off = 0, margin = 0;
  size_t outer = back ? p->end - 1 : p->begin, most = back ? voltage->count - p->end : p->begin;
  double level_V = mean_of(u, p->begin + n / 4, false, n - n / 4 - n / 4);
  double rounding_V = 1e-9 * fabs(level_V);
  for (size_t m = 1; m <= n / 8; m *= 4) {
    double limit_V = 4.0 * noise_V / sqrt((double)m) + rounding_V;
    while (off + m < n / 2 &&
           !(fabs(mean_of(u, back ? outer - off : outer + off, back, m) - level_V) <= limit_V)) {
      off += (m + 1) / 2;
    }
  }
  while (margin < n / 4 && margin < most + off) {
    double value = u[back ? outer - off + 1 + margin : outer + off - 1 - margin];
    if (fabs(value - level_V) > 12.0 * noise_V + rounding_V) {
      break;
    }
    margin++;
  }
  return off + margin;
}

/* Plateaus of the asked voltage as samples of the current; none when it mostly moves. */
static dea_status find_plateaus(struct search *s)
{
  const struct dea_channel *u = s->asked;
  DEA_TRY(s->ctx, dea_plateaus_find(s->ctx, u, 0, u->count, s->scale->tolerance_V, &s->plateaus,
                                    &s->plateau_count));
  size_t covered = 0;
  for (size_t p = 0; p < s->plateau_count; p++) {
    struct dea_plateau *plateau = &s->plateaus[p];
    covered += plateau->end - plateau->begin;
    size_t begin = foot_of(u, plateau, s->scale->noise_V, false);
    plateau->end -= foot_of(u, plateau, s->scale->noise_V, true);
    plateau->begin += begin;
    plateau->begin = dea_channel_index(s->current, dea_channel_time(u, plateau->begin));
    plateau->end = dea_channel_index(s->current, dea_channel_time(u, plateau->end - 1)) + 1;
    plateau->end = plateau->end < s->current->count ? plateau->end : s->current->count;
    plateau->begin = plateau->begin < plateau->end ? plateau->begin : plateau->end;
  }
  if (2 * covered < u->count) {
    s->plateau_count = 0;
  }
  return DEA_OK;
}

/* Median of the later half of a plateau. */
static double settled_current(struct search *s, const struct dea_plateau *p)
{
  size_t begin = p->begin + (p->end - p->begin) / 2, n = p->end - begin;
  memcpy(s->work, s->current->values + begin, n * sizeof *s->work);
  return dea_median(s->work, n);
}

/* Takes the leakage off samples begin <= i < end: a running median over an eighth of them. */
static void subtract_base(struct search *s, size_t begin, size_t end)
{
  double medians[BASE_BLOCKS + 1], base[BASE_BLOCKS + 1];
  size_t n = end - begin, block = 1 + n / BASE_BLOCKS, m = n / block;
  if (n < 8) {
    return;
  }
  for (size_t k = 0; k < m; k++) {
    memcpy(s->work, s->current->values + begin + k * block, block * sizeof *s->work);
    medians[k] = dea_median(s->work, block);
  }
  dea_running_median(medians, m, m / 16 > 2 ? m / 16 : 2, base);
  for (size_t i = begin; i < end; i++) {
    size_t k = (i - begin) / block;
    s->residual[i] = s->current->values[i] - base[k < m ? k : m - 1];
  }
}

/* Smallest step between neighbours that is none: that of a coarse converter. */
static double smallest_step(const struct dea_channel *current)
{
  double step = INFINITY, largest = 0.0;
  for (size_t i = 0; i < current->count; i++) {
    double off = i > 0 ? fabs(current->values[i] - current->values[i - 1]) : 0.0;
    step = off > 0.0 && off < step ? off : step;
    largest = fmax(largest, fabs(current->values[i])); // not NAN
  }
  return fmax(isinf(step) ? 0.0 : step, resolution * largest);
}

/* Of n residuals in s->work: by their median, and by their ninth tenth, which is not 0 where half
 * of them are. Coarse residuals say both to half a step. */
static double noise_of(struct search *s, size_t n)
{
  double noise = dea_spread(s->work, n, 0.0); // leaves their sizes
  return fmax(noise, (dea_quantile(s->work, n, 0.9) + 0.5 * s->step) / 1.645);
}

static double settled_noise(struct search *s)
{
  size_t n = 0;
  for (size_t p = 0; p < s->plateau_count; p++) {
    const struct dea_plateau *plateau = &s->plateaus[p];
    for (size_t i = plateau->begin + (plateau->end - plateau->begin) / 2; i < plateau->end; i++) {
      if (!isnan(s->residual[i])) {
        s->work[n++] = s->residual[i];
      }
    }
  }
  return noise_of(s, n);
}

/* Samples after a corner until nine of ten charging currents, less the slow leakage, are gone in
 * the noise for three samples. */
static size_t blind_samples(struct search *s)
{
  double noise = settled_noise(s);
  size_t quiet = 0, most = 0;
  for (size_t p = 0; p < s->plateau_count; p++) {
    size_t n = s->plateaus[p].end - s->plateaus[p].begin;
    most = n / 2 > most ? n / 2 : most;
  }
  most = most < LAGS_MAX ? most : LAGS_MAX;
  for (size_t lag = 0; lag < most; lag++) {
    size_t n = 0;
    for (size_t p = 1; p < s->plateau_count; p++) {
      size_t i = s->plateaus[p].begin + lag;
      if (i < s->plateaus[p].end && !isnan(s->residual[i])) {
        s->work[n++] = fabs(s->residual[i]);
      }
    }
    quiet = dea_quantile(s->work, n, 0.9) > 3.0 * noise ? 0 : quiet + 1;
    if (quiet == 3) {
      return lag < 3 ? 1 : (5 * (lag - 2)) / 4 + 1;
    }
  }
  return most;
}

/* Leakage off all plateaus from `blind` samples behind their corner on; all else is not looked at.
 */
static void set_residual(struct search *s, size_t blind)
{
  size_t n = s->current->count;
  for (size_t i = 0; i < n; i++) {
    s->residual[i] = NAN;
  }
  for (size_t p = 0; p < s->plateau_count; p++) {
    size_t begin = s->plateaus[p].begin + (p > 0 ? blind : 0), end = s->plateaus[p].end;
    if (begin + 1 < end) {
      subtract_base(s, begin, end - 1); // the next corner may lie between two samples
    }
  }
  if (s->plateau_count == 0 && n > 0) {
    subtract_base(s, 0, n);
  }
}

static void find_residual(struct search *s)
{
  size_t n = s->current->count, kept = 0, blind = 0;
  set_residual(s, 0);
  if (s->plateau_count > 1) {
    blind = blind_samples(s);
    set_residual(s, blind);
  }
  for (size_t i = 0; i < n; i++) {
    if (!isnan(s->residual[i])) {
      s->work[kept++] = s->residual[i];
    }
  }
  s->limits = (struct dea_current_limits){
      .noise_A = kept > 0 ? noise_of(s, kept) : NAN,
      .factor = dea_discharge_threshold(kept),
      .blind_s = n > 1
                     ? (double)blind *
                           (dea_channel_time(s->current, n - 1) - dea_channel_time(s->current, 0)) /
                           (double)(n - 1)
                     : 0.0,
      .samples = kept,
  };
}

/* Time that a sample stands for. */
static double width_s(const struct dea_channel *channel, size_t i)
{
  size_t a = i > 0 ? i - 1 : 0, b = i + 1 < channel->count ? i + 1 : i;
  return b > a ? (dea_channel_time(channel, b) - dea_channel_time(channel, a)) / (double)(b - a)
               : 0.0;
}

static dea_status find_spikes(struct search *s)
{
  const double *r = s->residual;
  size_t n = s->current->count;
  double high = s->limits.factor * s->limits.noise_A, low = 3.0 * s->limits.noise_A;
  for (size_t i = 0; i < n; i++) {
    if (!(fabs(r[i]) > high) || !(high > 0.0)) {
      continue;
    }
    double sign = r[i] > 0.0 ? 1.0 : -1.0;
    size_t begin = i, end = i + 1, peak = i;
    while (begin > 0 && sign * r[begin - 1] > low) {
      begin--;
    }
    while (end < n && (sign * r[end] > low || (end + 1 < n && sign * r[end + 1] > low))) {
      end++;
    }
    struct dea_discharge d = {.kind = DEA_DISCHARGE};
    for (size_t k = begin; k < end; k++) {
      peak = sign * r[k] > sign * r[peak] ? k : peak;
      d.charge_C += isnan(r[k]) ? 0.0 : r[k] * width_s(s->current, k);
    }
    size_t before = begin > 0 ? begin - 1 : begin;
    d.time_s = dea_channel_time(s->current, begin);
    d.voltage_V = at_sample(s, s->measured != NULL ? s->measured : s->asked, before);
    d.peak_A = r[peak];
    DEA_TRY(s->ctx, add(s, d));
    i = end;
  }
  return DEA_OK;
}

// Breakdown --------------------------------------------------------------------------------------

/* True when the amplifier does not reach the asked voltage. */
static bool falls_short(const struct search *s, size_t i)
{
  double asked = at_sample(s, s->asked, i), measured = at_sample(s, s->measured, i);
  return fabs(asked - s->scale->rest_V) > s->scale->active_V &&
         fabs(asked - measured) > fmax(0.1 * fabs(asked), s->scale->active_V);
}

/* Takes the spikes within a breakdown out. */
static void drop_spikes(struct search *s, double begin_s, double end_s)
{
  size_t n = 0;
  for (size_t i = 0; i < s->count; i++) {
    const struct dea_discharge *d = &s->found[i];
    if (d->kind == DEA_BREAKDOWN || d->time_s < begin_s || d->time_s > end_s) {
      s->found[n++] = *d;
    }
  }
  s->count = n;
}

/* A voltage that falls short to the end of its plateau, with a current. */
static dea_status find_breakdowns(struct search *s)
{
  double usual = 0.0;
  size_t m = 0, n = s->current->count;
  for (size_t p = 0; p < s->plateau_count; p++) { // leakage of good plateaus, mostly
    s->residual[m++] = fabs(settled_current(s, &s->plateaus[p]));
  }
  usual = m > 0 ? dea_median(s->residual, m) : 0.0;
  double least_A = usual + s->limits.factor * s->limits.noise_A;
  for (size_t p = 0; p < s->plateau_count; p++) {
    const struct dea_plateau *plateau = &s->plateaus[p];
    size_t begin = plateau->end < n ? plateau->end : n, end = begin;
    while (begin > plateau->begin && falls_short(s, begin - 1)) {
      begin--;
    }
    if (end - begin < 4) {
      continue;
    }
    struct dea_discharge d = {.kind = DEA_BREAKDOWN};
    for (size_t i = begin; i < end; i++) {
      double current = s->current->values[i];
      d.peak_A = fabs(current) > fabs(d.peak_A) ? current : d.peak_A;
      d.charge_C += isnan(current) ? 0.0 : current * width_s(s->current, i);
    }
    double begin_s = dea_channel_time(s->current, begin);
    double end_s = dea_channel_time(s->current, end - 1);
    if (fabs(d.charge_C) > least_A * (end_s - begin_s)) {
      d.time_s = begin_s;
      d.voltage_V = at_sample(s, s->measured, begin > plateau->begin ? begin - 1 : begin);
      drop_spikes(s, begin_s - s->limits.blind_s, end_s);
      DEA_TRY(s->ctx, add(s, d));
    }
  }
  return DEA_OK;
}

static int by_time(const void *a, const void *b)
{
  const struct dea_discharge *x = a, *y = b;
  return (x->time_s > y->time_s) - (x->time_s < y->time_s);
}

dea_status dea_discharges_find(struct dea_context *ctx, const struct dea_channel *current,
                               const struct dea_channel *asked, const struct dea_channel *measured,
                               const struct dea_voltage_scale *scale, struct dea_discharge **out,
                               size_t *count, struct dea_current_limits *limits)
{
  struct search s = {.ctx = ctx,
                     .current = current,
                     .asked = asked,
                     .measured = measured,
                     .scale = scale,
                     .step = smallest_step(current),
                     .limits = {.noise_A = NAN, .factor = NAN}};
  size_t capacity = current->count > 0 ? current->count : 1;
  *out = NULL;
  *count = 0;
  dea_status status = find_plateaus(&s);
  if (status == DEA_OK) {
    capacity = capacity > s.plateau_count ? capacity : s.plateau_count;
    s.residual = dea_alloc(ctx, capacity, sizeof *s.residual);
    s.work = dea_alloc(ctx, capacity, sizeof *s.work);
    status = s.residual != NULL && s.work != NULL ? DEA_OK : DEA_E_MEMORY;
  }
  if (status == DEA_OK) {
    find_residual(&s);
    status = find_spikes(&s);
  }
  status = status == DEA_OK && measured != NULL ? find_breakdowns(&s) : status;
  dea_free(ctx, s.work);
  dea_free(ctx, s.residual);
  dea_free(ctx, s.plateaus);
  *limits = s.limits;
  DEA_TRY_ELSE(ctx, status, dea_free(ctx, s.found));
  if (s.count > 1) {
    qsort(s.found, s.count, sizeof *s.found, by_time);
  }
  *out = s.found;
  *count = s.count;
  return DEA_OK;
}
