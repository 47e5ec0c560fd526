#include "reduce/reduce_parts.h"

#include <stdlib.h>

/* Samples begin <= i < end that are active, or at rest. */
struct run {
  size_t begin, end;
  bool active;
};

struct runs {
  struct run *list;
  size_t count, capacity;
};

struct finder {
  struct dea_context *ctx;
  const struct dea_channel *voltage;
  const struct dea_voltage_scale *scale;
  struct dea_cycle_list *out;
};

static dea_status add_run(struct dea_context *ctx, struct runs *runs, struct run run)
{
  if (runs->count > 0 && runs->list[runs->count - 1].active == run.active) {
    runs->list[runs->count - 1].end = run.end;
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_array_grow(ctx, &runs->list, runs->count, &runs->capacity, sizeof run));
  runs->list[runs->count++] = run;
  return DEA_OK;
}

/* Parts the samples by the voltage's distance from rest, with hysteresis. One or two samples of
 * the other kind between longer runs are noise, or a discharge. */
static dea_status find_runs(const struct finder *f, struct runs *runs)
{
  const double *u = f->voltage->values;
  size_t n = f->voltage->count;
  double on_V = f->scale->active_V, off_V = 0.5 * on_V;
  for (size_t at = 0; at < n;) {
    bool active = fabs(u[at] - f->scale->rest_V) > on_V; // false for NAN
    size_t end = at + 1;
    while (end < n && !(active ? fabs(u[end] - f->scale->rest_V) < off_V
                               : fabs(u[end] - f->scale->rest_V) > on_V)) {
      end++;
    }
    bool brief = end - at <= 2 && runs->count > 0 && end < n;
    struct run run = {at, end, brief ? runs->list[runs->count - 1].active : active};
    DEA_TRY(f->ctx, add_run(f->ctx, runs, run));
    at = end;
  }
  return DEA_OK;
}

static double time_of(const struct dea_channel *channel, size_t i)
{
  return dea_channel_time(channel, i < channel->count ? i : channel->count - 1);
}

/* Rest before and behind, of at most four times the active part: a long pause says nothing new. */
static void set_rests(const struct finder *f, const struct runs *runs, size_t r,
                      struct dea_cycle_parts *part)
{
  double most_s = 4.0 * (part->active.end_s - part->active.begin_s);
  part->rest = part->after = (struct dea_span){NAN, NAN};
  if (r > 0) {
    const struct run *run = &runs->list[r - 1];
    double end_s = time_of(f->voltage, run->end);
    part->rest = (struct dea_span){fmax(time_of(f->voltage, run->begin), end_s - most_s), end_s};
  }
  if (r + 1 < runs->count) {
    const struct run *run = &runs->list[r + 1];
    double begin_s = time_of(f->voltage, run->begin);
    part->after = (struct dea_span){begin_s, fmin(time_of(f->voltage, run->end), begin_s + most_s)};
  }
}

static dea_status add_part(struct dea_context *ctx, struct dea_cycle_list *out,
                           const struct dea_cycle_parts *part)
{
  DEA_TRY(ctx, dea_array_grow(ctx, &out->parts, out->count, &out->capacity, sizeof *part));
  out->parts[out->count++] = *part;
  return DEA_OK;
}

/* The samples around the peak of a run, where the voltage is within 5 % of it. */
static struct dea_plateau peak_of(const struct finder *f, const struct run *run)
{
  const double *u = f->voltage->values;
  size_t peak = run->begin;
  double rest_V = f->scale->rest_V;
  for (size_t i = run->begin; i < run->end; i++) {
    peak = fabs(u[i] - rest_V) > fabs(u[peak] - rest_V) ? i : peak;
  }
  double least_V = 0.95 * fabs(u[peak] - rest_V);
  struct dea_plateau p = {peak, peak + 1, u[peak]};
  while (p.begin > run->begin && fabs(u[p.begin - 1] - rest_V) >= least_V) {
    p.begin--;
  }
  while (p.end < run->end && fabs(u[p.end] - rest_V) >= least_V) {
    p.end++;
  }
  return p;
}

/* The parts of an active run: its plateaus, or its peak. */
static dea_status add_parts(const struct finder *f, const struct runs *runs, size_t r)
{
  const struct run *run = &runs->list[r];
  struct dea_plateau *plateaus, peak;
  size_t count, n = 0;
  DEA_TRY(f->ctx, dea_plateaus_find(f->ctx, f->voltage, run->begin, run->end, f->scale->tolerance_V,
                                    &plateaus, &count));
  for (size_t i = 0; i < count; i++) { // without those on the way at less than a level
    if (fabs(plateaus[i].mean_V - f->scale->rest_V) > f->scale->active_V) {
      plateaus[n++] = plateaus[i];
    }
  }
  peak = n == 0 ? peak_of(f, run) : (struct dea_plateau){0};
  const struct dea_plateau *list = n == 0 ? &peak : plateaus;
  dea_status status = DEA_OK;
  for (size_t i = 0; i < (n == 0 ? 1 : n) && status == DEA_OK; i++) {
    struct dea_cycle_parts part = {
        .cycle = {.number = f->out->count, .level_V = list[i].mean_V},
        .active = {time_of(f->voltage, list[i].begin), time_of(f->voltage, list[i].end)},
        .held = n > 0,
        .rises = n > 0 && i == 0,
        .falls = n > 0 && i + 1 == n,
    };
    set_rests(f, runs, r, &part);
    part.cycle.start_s = part.rises && r > 0 ? part.rest.end_s : part.active.begin_s;
    part.cycle.end_s = r + 1 < runs->count ? part.after.end_s : part.active.end_s;
    status = add_part(f->ctx, f->out, &part);
  }
  dea_free(f->ctx, plateaus);
  return status;
}

// The recording's own cycles ---------------------------------------------------------------------

static bool is_in(const struct dea_recorded_cycle *cycle, double time_s)
{
  return time_s >= cycle->start_s && time_s < cycle->end_s;
}

/* Names the parts after the recording's cycles; those in none go. used: [cycle_count], set. */
static void name_parts(const struct dea_recording *recording, struct dea_cycle_list *out,
                       bool *used)
{
  size_t n = 0, k = 0, cycles = recording->cycle_count;
  for (size_t i = 0; i < out->count; i++) {
    struct dea_cycle_parts *part = &out->parts[i];
    double middle_s = 0.5 * (part->active.begin_s + part->active.end_s);
    size_t tried = 0;
    while (tried < cycles && !is_in(&recording->cycles[k], middle_s)) {
      k = (k + 1) % cycles; // mostly the same cycle, or the next
      tried++;
    }
    if (tried == cycles) {
      out->outside++;
      continue;
    }
    part->cycle = recording->cycles[k];
    used[k] = true;
    out->parts[n++] = *part;
  }
  out->count = n;
}

static struct dea_span shifted(struct dea_span span, double by_s, double first_s, double last_s)
{
  struct dea_span moved = {span.begin_s + by_s, span.end_s + by_s};
  bool there = moved.begin_s >= first_s - 1e-9 * fabs(by_s) && moved.end_s <= last_s;
  return there ? moved : (struct dea_span){NAN, NAN};
}

/* Ends rests where the voltage of another cycle is on: those of the cycle that they were taken from
 * may have been longer. */
static void clip_rests(const struct dea_cycle_parts *parts, size_t count,
                       struct dea_cycle_parts *part)
{
  for (size_t i = 0; i < count; i++) {
    const struct dea_cycle_parts *other = &parts[i];
    double on_s = isnan(other->rest.end_s) ? other->active.begin_s : other->rest.end_s;
    double off_s = isnan(other->after.begin_s) ? other->active.end_s : other->after.begin_s;
    if (off_s <= part->active.begin_s && off_s > part->rest.begin_s) {
      part->rest.begin_s = off_s;
    }
    if (on_s >= part->active.end_s && on_s < part->after.end_s) {
      part->after.end_s = on_s;
    }
  }
}

/* A cycle at the voltage of rest has no edges: its parts are where those of another cycle of the
 * same length are. */
static dea_status add_quiet(const struct finder *f, const struct dea_recorded_cycle *cycle,
                            size_t named)
{
  double length_s = cycle->end_s - cycle->start_s;
  double first_s = time_of(f->voltage, 0), last_s = time_of(f->voltage, f->voltage->count - 1);
  for (size_t i = 0; i < named; i++) {
    struct dea_cycle_parts part = f->out->parts[i];
    double by_s = cycle->start_s - part.cycle.start_s;
    if (!part.held || !(fabs(part.cycle.end_s - part.cycle.start_s - length_s) < 0.01 * length_s)) {
      continue;
    }
    part.rest = shifted(part.rest, by_s, first_s, last_s);
    part.active = shifted(part.active, by_s, first_s, last_s);
    part.after = shifted(part.after, by_s, first_s, last_s);
    part.cycle = *cycle;
    if (isnan(part.active.begin_s)) {
      break;
    }
    clip_rests(f->out->parts, named, &part);
    return add_part(f->ctx, f->out, &part);
  }
  f->out->without++;
  return DEA_OK;
}

static int by_time(const void *a, const void *b)
{
  const struct dea_cycle_parts *x = a, *y = b;
  return (x->active.begin_s > y->active.begin_s) - (x->active.begin_s < y->active.begin_s);
}

static dea_status read_list(const struct finder *f, const struct dea_recording *recording)
{
  bool *used = dea_alloc(f->ctx, recording->cycle_count, sizeof *used);
  DEA_TRY_MEMORY(used != NULL);
  name_parts(recording, f->out, used);
  size_t named = f->out->count;
  dea_status status = DEA_OK;
  for (size_t k = 0; k < recording->cycle_count && status == DEA_OK; k++) {
    const struct dea_recorded_cycle *cycle = &recording->cycles[k];
    if (!used[k] && fabs(cycle->level_V - f->scale->rest_V) <= f->scale->active_V) {
      status = add_quiet(f, cycle, named);
    } else if (!used[k]) {
      f->out->without++;
    }
  }
  dea_free(f->ctx, used);
  if (f->out->count > 1) {
    qsort(f->out->parts, f->out->count, sizeof *f->out->parts, by_time);
  }
  return status;
}

dea_status dea_cycles_find(struct dea_context *ctx, const struct dea_recording *recording,
                           const struct dea_channel *voltage, const struct dea_voltage_scale *scale,
                           struct dea_cycle_list *out)
{
  *out = (struct dea_cycle_list){0};
  struct finder f = {ctx, voltage, scale, out};
  struct runs runs = {0};
  dea_status status = voltage->count > 0 ? find_runs(&f, &runs) : DEA_OK;
  for (size_t r = 0; r < runs.count && status == DEA_OK; r++) {
    status = runs.list[r].active ? add_parts(&f, &runs, r) : DEA_OK;
  }
  dea_free(ctx, runs.list);
  if (status == DEA_OK && recording->cycle_count > 0 && voltage->count > 0) {
    status = read_list(&f, recording);
  }
  if (status != DEA_OK) {
    dea_free(ctx, out->parts);
    *out = (struct dea_cycle_list){0};
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  return DEA_OK;
}

/* Whether the voltage is on behind sample i: of the last one up to it that is a number. */
static bool is_under(const struct dea_channel *voltage, double least_V, size_t i)
{
  while (i > 0 && isnan(voltage->values[i])) {
    i--;
  }
  return fabs(voltage->values[i]) > least_V; // false for NAN
}

void dea_cycles_dose(const struct dea_channel *voltage, double least_V,
                     struct dea_reduced_cycle *cycles, size_t count)
{
  size_t i = 0; // samples before it are in the sum
  double sum_s = 0;
  bool under = false;
  for (size_t k = 0; k < count; k++) {
    double end_s = cycles[k].cycle.end_s;
    while (i > 0 && time_of(voltage, i - 1) >= end_s) { // of plateaus within one another
      i--;
      sum_s -= i > 0 && is_under(voltage, least_V, i - 1)
                   ? time_of(voltage, i) - time_of(voltage, i - 1)
                   : 0;
      under = i > 0 && is_under(voltage, least_V, i - 1);
    }
    for (; i < voltage->count && time_of(voltage, i) < end_s; i++) {
      // what the sample before had lasted until this one
      sum_s += under && i > 0 ? time_of(voltage, i) - time_of(voltage, i - 1) : 0;
      under = isnan(voltage->values[i]) ? under : fabs(voltage->values[i]) > least_V;
    }
    double last_s = i > 0 ? time_of(voltage, i - 1) : end_s;
    cycles[k].under_voltage_s = sum_s + (under && i < voltage->count ? end_s - last_s : 0);
  }
}

struct dea_span dea_span_settled(struct dea_span part, double settle, bool held)
{
  double share = held ? settle : 1.0;
  return (struct dea_span){part.end_s - share * (part.end_s - part.begin_s), part.end_s};
}
