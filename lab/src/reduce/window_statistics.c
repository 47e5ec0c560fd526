#include "reduce/reduce_parts.h"

#include <stdlib.h>
#include <string.h>

struct values {
  const struct dea_channel *series;
  struct dea_noise rest, active;
  double settle;
  double reach_s; // of the edge behind a part into it, by the series' filter
  double *scratch;
};

/* Settled end of a part, short of where the filter sees the edge behind it; at most half of the
 * part is given up for that. */
static struct dea_span settled_of(struct dea_span part, double reach_s, double settle, bool held)
{
  if (held) {
    part.end_s -= fmin(reach_s, 0.5 * (part.end_s - part.begin_s));
  }
  return dea_span_settled(part, settle, held);
}

static struct dea_window mean_in(const struct values *v, struct dea_span span,
                                 const struct dea_noise *noise)
{
  return dea_window_mean(v->series, span, noise->limit, v->scratch);
}

/* Rest at the time of the active part, by a straight line between the rests before and behind, so
 * that a linear drift does not count; or the one there is. *weight: of the
 * one behind. */
static double rest_at(struct dea_window before, struct dea_window after, double time_s,
                      double *weight)
{
  *weight = isnan(after.mean)    ? 0.0
            : isnan(before.mean) ? 1.0
                                 : (time_s - before.time_s) / (after.time_s - before.time_s);
  if (*weight <= 0.0) {
    return before.mean;
  }
  return *weight >= 1.0 ? after.mean : (1.0 - *weight) * before.mean + *weight * after.mean;
}

/* Change from behind the rise to the settled end. The window behind the rise is as long as the
 * settled one and begins three rise times behind the edge, when 99.9 % of an exponential is there.
 */
static double creep_of(const struct values *v, const struct dea_cycle_parts *parts,
                       struct dea_span settled, double settled_mean, double reached_s)
{
  double edge_s = isnan(parts->rest.end_s) ? parts->active.begin_s : parts->rest.end_s;
  double length_s = settled.end_s - settled.begin_s;
  double begin_s = edge_s + 3.0 * fmax(reached_s - edge_s, 0.0);
  struct dea_span early = {begin_s, begin_s + length_s};
  if (isnan(reached_s) || !(early.end_s <= settled.begin_s)) {
    return NAN;
  }
  return settled_mean - mean_in(v, early, &v->active).mean;
}

/* Middle of a part, from where its end is looked for: the last sample before an edge may lie far
 * before it. The begin of the next part when there is no such part. */
static double later_half(struct dea_span part, struct dea_span next)
{
  return isnan(part.begin_s) ? next.begin_s : 0.5 * (part.begin_s + part.end_s);
}

static struct dea_cycle_value value_of(const struct values *v, const struct dea_cycle_parts *parts)
{
  struct dea_cycle_value value = {.rise_s = NAN, .fall_s = NAN, .creep = NAN};
  struct dea_span settled = settled_of(parts->active, v->reach_s, v->settle, parts->held);
  struct dea_window active = mean_in(v, settled, &v->active);
  struct dea_window rest =
      mean_in(v, settled_of(parts->rest, v->reach_s, v->settle, parts->held), &v->rest);
  struct dea_window after =
      mean_in(v, settled_of(parts->after, v->reach_s, v->settle, parts->held), &v->rest);
  double weight, unused;
  value.rest_before = rest.mean;
  value.rest = rest_at(rest, after, active.time_s, &weight);
  value.active = active.mean;
  value.amplitude = value.active - value.rest;
  double of_active = dea_noise_of_mean(&v->active, active.count);
  double of_rest = dea_noise_of_mean(&v->rest, weight < 1.0 ? rest.count : after.count);
  double of_after = dea_noise_of_mean(&v->rest, after.count);
  weight = fmin(fmax(weight, 0.0), 1.0);
  value.uncertainty = sqrt(of_active + (1.0 - weight) * (1.0 - weight) * of_rest +
                           (weight > 0.0 ? weight * weight * of_after : 0.0));
  if (weight > 0.0 && weight < 1.0) {
    value.shared = isnan(of_after) ? 0.0 : weight * (1.0 - weight) * of_after;
  }
  if (parts->rises && !isnan(value.amplitude)) {
    double reached_s;
    struct dea_span rise = {later_half(parts->rest, parts->active), parts->active.end_s};
    double from = isnan(rest.mean) ? value.rest : rest.mean;
    value.rise_s = dea_rise_time(v->series, rise, from, active.mean, v->rest.sample, &reached_s);
    value.creep = creep_of(v, parts, settled, active.mean, reached_s);
  }
  if (parts->falls && !isnan(after.mean)) {
    struct dea_span fall = {later_half(parts->active, parts->after), parts->after.end_s};
    value.fall_s = dea_rise_time(v->series, fall, active.mean, after.mean, v->rest.sample, &unused);
  }
  return value;
}

/* Later halves of the parts, where noise is looked at. */
static size_t noise_spans(const struct dea_cycle_parts *parts, size_t count, bool active,
                          double reach_s, double settle, struct dea_span *out)
{
  size_t n = 0;
  double share = fmax(settle, 0.5);
  for (size_t i = 0; i < count; i++) {
    if (active) {
      out[n++] = settled_of(parts[i].active, reach_s, share, parts[i].held);
      continue;
    }
    struct dea_span before = settled_of(parts[i].rest, reach_s, share, true);
    if (n == 0 || before.end_s != out[n - 1].end_s) { // once each
      out[n++] = before;
    }
    out[n++] = settled_of(parts[i].after, reach_s, share, true);
  }
  return n;
}

/* Estimates the noise of one kind of parts into *out. longest: grows. */
static dea_status estimate(struct dea_context *ctx, const struct dea_channel *series,
                           const struct dea_cycle_parts *parts, size_t count, bool active,
                           double settle, struct dea_span *spans, struct dea_noise *out)
{
  size_t n = noise_spans(parts, count, active, dea_filter_reach(series->filter_Hz), settle, spans);
  return dea_noise_estimate(ctx, series, spans, n, out);
}

/* Room for the samples of any part, twice. */
static double *scratch_for(struct dea_context *ctx, const struct dea_channel *series,
                           const struct dea_cycle_parts *parts, size_t count,
                           struct dea_span *spans)
{
  size_t longest = 0;
  for (size_t i = 0; i < count; i++) {
    const struct dea_span own[3] = {parts[i].rest, parts[i].active, parts[i].after};
    memcpy(spans, own, sizeof own);
    size_t n = dea_window_longest(series, spans, 3);
    longest = n > longest ? n : longest;
  }
  return dea_alloc(ctx, 2 * longest + 1, sizeof(double));
}

dea_status dea_cycle_values(struct dea_context *ctx, const struct dea_channel *series,
                            const struct dea_cycle_parts *parts, size_t count, double settle,
                            struct dea_reduced_cycle *cycles, enum dea_reduced_kind kind,
                            double *noise)
{
  struct values v = {
      .series = series, .settle = settle, .reach_s = dea_filter_reach(series->filter_Hz)};
  struct dea_span *spans = dea_alloc(ctx, 2 * count + 3, sizeof *spans);
  dea_status status = spans != NULL ? DEA_OK : DEA_E_MEMORY;
  *noise = NAN;
  if (status == DEA_OK) {
    status = estimate(ctx, series, parts, count, false, settle, spans, &v.rest);
  }
  if (status == DEA_OK) {
    status = estimate(ctx, series, parts, count, true, settle, spans, &v.active);
  }
  if (status == DEA_OK) {
    v.scratch = scratch_for(ctx, series, parts, count, spans);
    status = v.scratch != NULL ? DEA_OK : DEA_E_MEMORY;
  }
  dea_free(ctx, spans);
  DEA_TRY_ELSE(ctx, status, dea_free(ctx, v.scratch));
  v.rest = isnan(v.rest.sample) ? v.active : v.rest; // of one when the other is too short
  v.active = isnan(v.active.sample) ? v.rest : v.active;
  *noise = v.rest.sample;
  for (size_t i = 0; i < count; i++) {
    cycles[i].values[kind] = value_of(&v, &parts[i]);
  }
  dea_free(ctx, v.scratch);
  return DEA_OK;
}

// Levels -----------------------------------------------------------------------------------------

void dea_line_fit(const double *x, const double *y, size_t count, double *slope,
                  double *uncertainty)
{
  double n = (double)count, mx = 0.0, my = 0.0, sxx = 0.0, sxy = 0.0, rest = 0.0;
  *slope = *uncertainty = NAN;
  for (size_t i = 0; i < count; i++) {
    mx += x[i] / n;
    my += y[i] / n;
  }
  for (size_t i = 0; i < count; i++) {
    sxx += (x[i] - mx) * (x[i] - mx);
    sxy += (x[i] - mx) * (y[i] - my);
  }
  if (!(sxx > 0.0)) {
    return;
  }
  *slope = sxy / sxx;
  for (size_t i = 0; i < count; i++) {
    double off = y[i] - my - *slope * (x[i] - mx);
    rest += off * off;
  }
  *uncertainty = count > 2 ? sqrt(rest / (n - 2.0) / sxx) : NAN;
}

/* Cycles of one level as lists of numbers. */
struct gathered {
  const struct dea_reduced_cycle **cycles; // [count]
  size_t count;
  double *x, *y; // room for [count]
};

/* Mean, scatter and their uncertainty. Neighbours share a rest, so that their amplitudes are
 * correlated: each pair adds twice their covariance. Where the noise is not known, a third of the
 * scatter's variance: that of a rest and of an active part are then taken as the same, v, which
 * gives the scatter 1.5 v and two neighbours the covariance v/4. */
static void amplitude_of(const struct gathered *g, int kind, struct dea_voltage_level *level)
{
  double sum = 0.0, squares = 0.0, noise = 0.0, shared = 0.0;
  size_t n = 0, pairs = 0;
  const struct dea_cycle_value *before = NULL;
  for (size_t i = 0; i < g->count; i++) {
    const struct dea_cycle_value *v = &g->cycles[i]->values[kind];
    if (isnan(v->amplitude)) {
      before = NULL;
      continue;
    }
    sum += v->amplitude;
    noise += v->uncertainty * v->uncertainty;
    if (before != NULL && g->cycles[i - 1] + 1 == g->cycles[i]) {
      shared += 2.0 * before->shared;
      pairs++;
    }
    before = v;
    n++;
  }
  if (n == 0) {
    return;
  }
  double mean = sum / (double)n;
  for (size_t i = 0; i < g->count; i++) {
    double a = g->cycles[i]->values[kind].amplitude;
    squares += isnan(a) ? 0.0 : (a - mean) * (a - mean);
  }
  level->mean[kind] = mean;
  level->std[kind] = n > 1 ? sqrt(squares / (double)(n - 1)) : NAN;
  level->noise[kind] = sqrt(noise / (double)n);
  // Of the sum; scatter of less than the noise is chance.
  double variance = n > 1 ? fmax(noise, squares * (double)n / (double)(n - 1)) : noise;
  if (isnan(noise) && n > 1) {
    shared = (double)pairs * squares / (double)(n - 1) / 3.0;
  }
  level->uncertainty[kind] = sqrt(variance + shared) / (double)n;
}

/* Median (or mean) of the numbers that a member has in the cycles of a level. */
static double summary_of(const struct gathered *g, int kind, size_t member, bool median)
{
  size_t n = 0;
  double sum = 0.0;
  for (size_t i = 0; i < g->count; i++) {
    double value;
    memcpy(&value, (const char *)&g->cycles[i]->values[kind] + member, sizeof value);
    if (!isnan(value)) {
      g->y[n++] = value;
      sum += value;
    }
  }
  return n == 0 ? NAN : median ? dea_median(g->y, n) : sum / (double)n;
}

static void drift_of(const struct gathered *g, int kind, struct dea_voltage_level *level)
{
  size_t n = 0;
  for (size_t i = 0; i < g->count; i++) {
    const struct dea_cycle_value *v = &g->cycles[i]->values[kind];
    if (!isnan(v->rest_before)) {
      g->x[n] = (double)i;
      g->y[n++] = v->rest_before;
    }
  }
  dea_line_fit(g->x, g->y, n, &level->drift[kind], &level->drift_uncertainty[kind]);
}

static void level_fill(const struct gathered *g, struct dea_voltage_level *level)
{
  level->cycles = g->count;
  level->step = g->cycles[0]->cycle.step;
  level->voltage_V = 0.0;
  for (size_t i = 0; i < g->count; i++) {
    level->voltage_V += g->cycles[i]->voltage_V / (double)g->count;
  }
  level->shape = level->shape_uncertainty = NAN;
  level->capacitance_F = level->capacitance_std_F = level->sensed_stretch = NAN;
  for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
    level->mean[kind] = level->std[kind] = level->noise[kind] = level->uncertainty[kind] = NAN;
    amplitude_of(g, kind, level);
    level->rise_s[kind] = summary_of(g, kind, offsetof(struct dea_cycle_value, rise_s), true);
    level->fall_s[kind] = summary_of(g, kind, offsetof(struct dea_cycle_value, fall_s), true);
    level->creep[kind] = summary_of(g, kind, offsetof(struct dea_cycle_value, creep), false);
    drift_of(g, kind, level);
  }
}

/* Cycles in the order of their level: by voltage; those of another step apart. */
static int by_voltage(const void *a, const void *b)
{
  const struct dea_reduced_cycle *x = *(const struct dea_reduced_cycle *const *)a;
  const struct dea_reduced_cycle *y = *(const struct dea_reduced_cycle *const *)b;
  if (x->cycle.step != y->cycle.step) {
    return x->cycle.step < y->cycle.step ? -1 : 1;
  }
  return (x->voltage_V > y->voltage_V) - (x->voltage_V < y->voltage_V);
}

static int by_time(const void *a, const void *b)
{
  const struct dea_reduced_cycle *x = *(const struct dea_reduced_cycle *const *)a;
  const struct dea_reduced_cycle *y = *(const struct dea_reduced_cycle *const *)b;
  return (x > y) - (x < y);
}

static int by_level_voltage(const void *a, const void *b)
{
  const struct dea_voltage_level *x = a, *y = b;
  double d = x->voltage_V - y->voltage_V;
  return d != 0.0 ? (d > 0.0) - (d < 0.0) : (x->step > y->step) - (x->step < y->step);
}

/* Fills the levels from the sorted list of cycles; how many. */
static size_t fill_levels(const struct dea_reduced_cycle **sorted, size_t count, double tolerance_V,
                          double *x, double *y, struct dea_voltage_level *levels)
{
  size_t n = 0;
  for (size_t i = 0, j; i < count; i = j) {
    // from the lowest, not from one to the next: small steps up to a high voltage are no one level
    for (j = i + 1; j < count && sorted[j]->cycle.step == sorted[i]->cycle.step &&
                    sorted[j]->voltage_V - sorted[i]->voltage_V <= tolerance_V;) {
      j++;
    }
    qsort(sorted + i, j - i, sizeof(*sorted), by_time);
    level_fill(&(struct gathered){sorted + i, j - i, x, y}, &levels[n++]);
  }
  return n;
}

/* The level that a cycle belongs to: of its step, and nearest. */
static size_t nearest_level(const struct dea_reduced_cycle *cycle,
                            const struct dea_voltage_level *levels, size_t count)
{
  size_t best = 0;
  double least = INFINITY;
  for (size_t l = 0; l < count; l++) {
    double off = fabs(levels[l].voltage_V - cycle->voltage_V);
    if (levels[l].step == cycle->cycle.step && off < least) {
      best = l;
      least = off;
    }
  }
  return best;
}

dea_status dea_levels_form(struct dea_context *ctx, struct dea_reduced_cycle *cycles, size_t count,
                           double tolerance_V, struct dea_voltage_level **out, size_t *level_count)
{
  const struct dea_reduced_cycle **sorted = dea_alloc(ctx, count, sizeof *sorted);
  double *xy = dea_alloc(ctx, count, 2 * sizeof *xy);
  struct dea_voltage_level *levels = dea_alloc(ctx, count, sizeof *levels);
  dea_status status = sorted != NULL && xy != NULL && levels != NULL ? DEA_OK : DEA_E_MEMORY;
  *out = NULL;
  *level_count = 0;
  if (status == DEA_OK) {
    for (size_t i = 0; i < count; i++) {
      sorted[i] = &cycles[i];
    }
    if (count > 0) {
      qsort(sorted, count, sizeof *sorted, by_voltage);
    }
    *level_count = fill_levels(sorted, count, tolerance_V, xy, xy + count, levels);
    if (*level_count > 0) {
      qsort(levels, *level_count, sizeof *levels, by_level_voltage);
    }
    for (size_t i = 0; i < count; i++) {
      cycles[i].level = nearest_level(&cycles[i], levels, *level_count);
    }
    *out = levels;
    levels = NULL;
  }
  dea_free(ctx, levels);
  dea_free(ctx, xy);
  dea_free(ctx, (void *)sorted);
  return status;
}
