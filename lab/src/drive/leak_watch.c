#include "drive/leak_watch.h"

#include "base/sort.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

static const double part_s = 0.1;    // of a cycle, at least, where that is short
static const double parts_least = 8; // of it, so that its two signs are apart
static const double value_s = 0.1;   // that a value is the mean of, at least
static const double visit_s = DEA_LEAK_VISIT_S;
static const double under_voltage = 0.2; // of the step's largest; below it nothing is looked at
static const double sure = 6;            // times the scatter
static const double follow = 1.0 / 64;   // of a visit's distance, by which the base line follows
static const double least_share = 0.01;  // of the fixed limit: what is no rise whatever was before
static const double rounding = 1e-9;

void dea_leak_watch_start(struct dea_leak_watch *watch, const struct dea_protocol *protocol)
{
  *watch = (struct dea_leak_watch){
      .protocol = protocol, .step = SIZE_MAX, .last_s = NAN, .cycle = NAN, .level_V = NAN};
}

/* A step begins: nothing is known of its cycles. */
static void begin_step(struct dea_leak_watch *watch, size_t number)
{
  const struct dea_protocol_step *step = &watch->protocol->steps[number];
  dea_leak_watch_start(watch, watch->protocol);
  watch->step = number;
  watch->period_s = dea_protocol_period_s(step);
  watch->largest_V = fmax(fabs(step->lowest_V), fabs(step->highest_V));
  if (step->lowest_V == step->highest_V) {
    watch->part_count = 1;
  } else if (!isnan(watch->period_s)) {
    double samples = floor(watch->period_s * watch->protocol->rate_Hz.si);
    double parts = fmin(watch->period_s / part_s, samples / DEA_LEAK_GROUP);
    parts = fmin(fmax(floor(parts), parts_least), DEA_LEAK_PARTS_MAX);
    watch->part_count = (size_t)fmax(fmin(parts, samples), 1);
  }
}

/* The step that a time falls into; false: a pause, or the end. *local_s: time in it. */
static bool find_step(struct dea_leak_watch *watch, double time_s, double *local_s)
{
  const struct dea_protocol *p = watch->protocol;
  size_t step = watch->step < p->step_count ? watch->step : 0;
  while (step + 1 < p->step_count && p->steps[step + 1].start_s <= time_s) {
    step++;
  }
  if (step != watch->step) {
    begin_step(watch, step);
  }
  *local_s = time_s - p->steps[step].start_s;
  return *local_s >= 0 && *local_s < p->steps[step].repeat.si * p->steps[step].waveform->end_s;
}

/* Cycles of another level are not equal to those before: all begins anew. */
static void find_level(struct dea_leak_watch *watch, double in_s)
{
  const struct dea_waveform *waveform = watch->protocol->steps[watch->step].waveform;
  double cycle = floor(in_s / watch->period_s);
  struct dea_wave_cycle found;
  if (watch->part_count == 1 || watch->period_s == waveform->end_s || cycle == watch->cycle ||
      !dea_waveform_cycle(waveform, (size_t)cycle, &found)) {
    return;
  }
  if (watch->level_V != found.level_V && !isnan(watch->level_V)) {
    begin_step(watch, watch->step);
  }
  watch->cycle = cycle;
  watch->level_V = found.level_V;
  watch->largest_V = fabs(found.level_V);
}

static double largest_rise(const struct dea_leak_watch *watch, double base_A)
{
  const struct dea_protocol *p = watch->protocol;
  double trip_A = p->safety.trip_current_A.si;
  double least_A = p->safety.leak_least_A.origin != DEA_ABSENT ? p->safety.leak_least_A.si
                                                               : least_share * trip_A;
  return fmax(p->safety.leak_rise.si * fabs(base_A), least_A);
}

static double limit_of(const struct dea_leak_watch *watch, const struct dea_leak_part *part)
{
  return part->base_A + fmax(largest_rise(watch, part->base_A), sure * part->scatter_A);
}

/* Of the first visits: the lower quartile, which those of a film that fails meanwhile do not lift;
 * and their scatter by what follows what, as a trend is none. */
static void learn(struct dea_leak_part *part)
{
  double sorted_A[DEA_LEAK_VISITS], steps_A[DEA_LEAK_VISITS - 1];
  enum { STEPS = DEA_LEAK_VISITS - 1 };
  for (size_t i = 0; i < DEA_LEAK_VISITS; i++) {
    sorted_A[i] = part->visits_A[i];
  }
  qsort(sorted_A, DEA_LEAK_VISITS, sizeof *sorted_A, dea_rising);
  part->base_A = part->least_base_A = 0.5 * (sorted_A[1] + sorted_A[2]);
  for (size_t i = 0; i < STEPS; i++) {
    steps_A[i] = part->visits_A[i + 1] - part->visits_A[i];
  }
  qsort(steps_A, STEPS, sizeof *steps_A, dea_rising);
  double trend_A = steps_A[STEPS / 2];
  for (size_t i = 0; i < STEPS; i++) {
    steps_A[i] = fabs(steps_A[i] - trend_A);
  }
  qsort(steps_A, STEPS, sizeof *steps_A, dea_rising);
  part->scatter_A = 1.4826 * steps_A[STEPS / 2] / sqrt(2); // of normal noise
}

/* What is said of all parts. */
static enum dea_leak_event report(struct dea_leak_watch *watch, enum dea_leak_event event)
{
  watch->value_A = watch->limit_A = 0;
  for (size_t i = 0; i < watch->part_count; i++) {
    const struct dea_leak_part *part = &watch->parts[i];
    if (part->visit_count == DEA_LEAK_VISITS) {
      watch->value_A = fmax(watch->value_A, fabs(part->base_A));
      watch->limit_A = fmax(watch->limit_A, limit_of(watch, part));
    }
  }
  return event;
}

/* A visit of a part has ended. */
static enum dea_leak_event end_visit(struct dea_leak_watch *watch, struct dea_leak_part *part)
{
  double visit_A = part->visit_sum_A / part->visit_values;
  part->visit_values = 0;
  part->visit_sum_A = 0;
  if (part->visit_count < DEA_LEAK_VISITS) {
    part->visits_A[part->visit_count++] = visit_A;
    if (part->visit_count < DEA_LEAK_VISITS) {
      return DEA_LEAK_NOTHING;
    }
    learn(part);
    bool useless = limit_of(watch, part) >= watch->protocol->safety.trip_current_A.si;
    if (useless && !watch->scattered) {
      watch->scattered = true;
      return report(watch, DEA_LEAK_SCATTER);
    }
    bool all = ++watch->learned == watch->active && !watch->told;
    watch->told = watch->told || all;
    return all ? report(watch, DEA_LEAK_LEARNED) : DEA_LEAK_NOTHING;
  }
  if (part->above_s > 0) { // a fault is not followed
    return DEA_LEAK_NOTHING;
  }
  double most_A = part->least_base_A + largest_rise(watch, part->least_base_A);
  part->base_A += follow * (visit_A - part->base_A);
  part->least_base_A = fmin(part->least_base_A, part->base_A);
  if (part->base_A < most_A) {
    return DEA_LEAK_NOTHING;
  }
  part->base_A = most_A;
  bool first = !watch->drifted;
  watch->drifted = true;
  return first ? report(watch, DEA_LEAK_DRIFTED) : DEA_LEAK_NOTHING;
}

static enum dea_leak_event add_value(struct dea_leak_watch *watch, struct dea_leak_part *part,
                                     double value_A, double spent_s)
{
  watch->active += part->visit_count == 0 && part->visit_values == 0;
  part->visit_sum_A += value_A;
  part->visit_values++;
  if (part->visit_count < DEA_LEAK_VISITS) {
    return DEA_LEAK_NOTHING;
  }
  if (!(value_A > limit_of(watch, part))) {
    watch->above_s -= part->above_s;
    part->above_s = 0;
    return DEA_LEAK_NOTHING;
  }
  part->above_s += spent_s;
  watch->above_s += spent_s;
  watch->value_A = value_A;
  watch->limit_A = limit_of(watch, part);
  return watch->above_s >= watch->protocol->safety.leak_time_s.si ? DEA_LEAK_ROSE
                                                                  : DEA_LEAK_NOTHING;
}

/* Adds a sample to a part; true: it has a value, *value_A of *spent_s under voltage. */
static bool add_sample(struct dea_leak_part *part, double current_A, double since_s,
                       double *value_A, double *spent_s)
{
  part->group_A[part->in_group++] = current_A;
  part->spent_s += since_s;
  if (part->in_group < DEA_LEAK_GROUP) {
    return false;
  }
  qsort(part->group_A, DEA_LEAK_GROUP, sizeof *part->group_A, dea_rising);
  part->sum_A += part->group_A[DEA_LEAK_GROUP / 2];
  part->in_group = 0;
  part->groups++;
  if (part->spent_s < value_s * (1 - rounding)) {
    return false;
  }
  *value_A = part->sum_A / part->groups;
  *spent_s = part->spent_s;
  part->sum_A = part->spent_s = 0;
  part->groups = 0;
  return true;
}

enum dea_leak_event dea_leak_watch_sample(struct dea_leak_watch *watch, double time_s,
                                          double asked_V, double current_A)
{
  double local_s, value_A, spent_s;
  double since_s = isnan(watch->last_s) ? 0 : fmin(time_s - watch->last_s, visit_s);
  bool plays = find_step(watch, time_s, &local_s);
  // a repetition begins anew, as the times of its cycles are found
  double length_s = watch->protocol->steps[watch->step].waveform->end_s;
  double in_s = watch->part_count > 1 ? fmod(local_s, length_s) : local_s;
  if (plays && !isnan(watch->period_s)) {
    find_level(watch, in_s);
  }
  watch->last_s = time_s;
  if (!plays || isnan(watch->period_s) || isnan(current_A) ||
      fabs(asked_V) < under_voltage * watch->largest_V) {
    return DEA_LEAK_NOTHING;
  }
  double pass = floor(in_s / watch->period_s), phase = in_s / watch->period_s - pass;
  pass += floor(local_s / length_s) * ceil(length_s / watch->period_s);
  size_t at = (size_t)(phase * (double)watch->part_count);
  struct dea_leak_part *part = &watch->parts[at < watch->part_count ? at : watch->part_count - 1];
  enum dea_leak_event event = DEA_LEAK_NOTHING;
  if (part->visit_values > 0 && pass != part->visit_pass &&
      time_s >= part->visit_start_s + visit_s) {
    event = end_visit(watch, part);
    part->begun = false;
  }
  if (!part->begun) {
    part->begun = true;
    part->visit_start_s = time_s;
    part->visit_pass = pass;
  }
  double flow_A = asked_V > 0 ? current_A : -current_A;
  if (!add_sample(part, flow_A, since_s, &value_A, &spent_s)) {
    return event;
  }
  enum dea_leak_event of_value = add_value(watch, part, value_A, spent_s);
  return of_value != DEA_LEAK_NOTHING ? of_value : event;
}
