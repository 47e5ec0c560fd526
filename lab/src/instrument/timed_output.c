#include "instrument/timed_output.h"

#include <math.h>

enum { TOP_SAMPLES = 4000 };
static const double told_share = 0.5; // of `behind`, that a voltage must stay to be compared
static const double tops_most = 100;  // of that time, that are looked at
static const double zero_least = 4;   // times `behind`: two tries, and a late answer in each
// an output that can be read back is, however seldom that is recorded
static const double measure_at_least_s = 1;
// while a meter has yet to be seen to follow; and the least that it is asked sooner or later than
// its turn would be, so that it does not look at a waveform at the same places only
static const double urgent_s = 0.1, golden = 0.6180339887498949;

/* The shortest time for which a step is beyond half of its largest voltage in one go. */
static double shortest_top_s(const struct dea_protocol_step *step, double longest_s)
{
  double largest_V = fmax(fabs(step->lowest_V), fabs(step->highest_V)), since_s = 0;
  double end_s = fmin(step->waveform->end_s, tops_most * longest_s), shortest_s = longest_s;
  double sample_s = end_s / TOP_SAMPLES;
  for (int i = 0; i < TOP_SAMPLES; i++) {
    double time_s = sample_s * i;
    if (fabs(dea_waveform_value(step->waveform, time_s)) <= 0.5 * largest_V) {
      shortest_s =
          time_s > since_s + 0.5 * sample_s ? fmin(shortest_s, time_s - since_s) : shortest_s;
      since_s = time_s + sample_s;
    }
  }
  return shortest_s;
}

/* Warns of what is too short for a meter that may be late by `behind`. */
static dea_status check_tops(struct dea_context *ctx, const struct dea_quantity *behind,
                             const struct dea_protocol *protocol)
{
  double least_s = told_share * behind->si;
  for (size_t i = 0; i < protocol->step_count; i++) {
    double top_s = shortest_top_s(&protocol->steps[i], least_s);
    if (top_s < least_s * (1 - 1e-9)) {
      return dea_finding_add(ctx, DEA_WARNING, behind->location,
                             "step %zu is beyond half of its voltage for %.2g s at a time: too "
                             "short to tell a wrong height from an answer that is late by up to "
                             "`behind`, %g s; where the supply is faster, write behind: %.2g s",
                             i + 1, top_s, behind->si, top_s / told_share);
    }
  }
  return DEA_OK;
}

dea_status dea_timed_check(struct dea_context *ctx, const struct dea_quantity *behind,
                           const struct dea_protocol *protocol)
{
  const struct dea_quantity *zero_time = &protocol->safety.zero_time_s;
  DEA_TRY(ctx, check_tops(ctx, behind, protocol));
  double least_s = zero_least * behind->si;
  return zero_time->si >= least_s * (1 - 1e-9)
             ? DEA_OK
             : dea_finding_add(
                   ctx, DEA_WARNING, behind->location,
                   "at the end the output must be read back at 0 V for as long as that, "
                   "%g s, within %g s, so that %s; write zero_time: %g s in `safety`",
                   behind->si, zero_time->si,
                   zero_time->si > behind->si ? "a late answer leaves it not known to be at 0 V"
                                              : "it will never be known to be at 0 V",
                   least_s);
}

void dea_timed_limits(struct dea_timed_output *o, const struct dea_protocol *protocol)
{
  double gain = protocol->amplifier.gain.si;
  o->evidence.slew_V_per_s = protocol->amplifier.slew_V_per_s.origin != DEA_ABSENT
                                 ? protocol->amplifier.slew_V_per_s.si / gain
                                 : 0;
  o->evidence.error_V = protocol->safety.voltage_error_V.si / gain;
  o->evidence.share = protocol->safety.readback_error.si;
  o->evidence.zero_V = protocol->safety.at_zero_V.si / gain;
}

dea_status dea_timed_begin(struct dea_context *ctx, struct dea_timed_output *o)
{
  o->clock_s = o->waiting_s = NAN;
  if (isfinite(o->measure_interval_s)) {
    o->measure_interval_s = fmin(o->measure_interval_s, measure_at_least_s);
  }
  o->capacity = (size_t)(o->queue_s * o->rate_Hz) + 1;
  o->queue = dea_alloc(ctx, o->capacity, sizeof *o->queue);
  return o->queue != NULL ? DEA_OK : DEA_E_MEMORY;
}

void dea_timed_end(struct dea_context *ctx, struct dea_timed_output *o)
{
  dea_free(ctx, o->queue);
  o->queue = NULL;
}

void dea_timed_start(struct dea_timed_output *o, double now_s)
{
  o->turned_s = o->clock_s = o->measured_s = now_s;
  o->evidence.lag_s = o->behind_s;
}

bool dea_timed_plays(const struct dea_timed_output *o)
{
  return o->queue != NULL && !isnan(o->clock_s);
}

/* When the next sample of the queue is due. */
static double due(const struct dea_timed_output *o)
{
  return o->clock_s + (double)o->played / o->rate_Hz;
}

dea_status dea_timed_write(
    struct dea_context *ctx, struct dea_timed_output *o, const double *volts, size_t count,
    dea_status (*serve)(struct dea_context *ctx, void *supply, double until_s), void *supply)
{
  for (size_t i = 0; i < count; i++) {
    while (o->count == o->capacity) {
      if (isnan(o->clock_s)) {
        return dea_fail(ctx, DEA_E_ARGUMENT, "more than %zu samples before the start", o->capacity);
      }
      DEA_TRY(ctx, serve(ctx, supply, due(o)));
    }
    o->queue[(o->first + o->count++) % o->capacity] = volts[i];
  }
  return DEA_OK;
}

static dea_status check_stall(struct dea_context *ctx, struct dea_timed_output *o, double now_s)
{
  double due_s = o->count > 0 ? due(o) : now_s;
  double away_s = fmax(now_s - due_s, now_s - o->turned_s);
  bool idle = o->count == 0 && o->sent_V == 0 && o->wanted_V == 0;
  o->turned_s = now_s;
  return idle || away_s <= o->queue_s + 1 / o->rate_Hz
             ? DEA_OK
             : dea_fail(ctx, DEA_E_INTERLOCK,
                        "the computer was away for %.3g s, longer than the queue of %g s: it was "
                        "stopped, or is too busy",
                        away_s, o->queue_s);
}

dea_status dea_timed_read(struct dea_context *ctx, struct dea_timed_output *o, double now_s)
{
  DEA_TRY(ctx, check_stall(ctx, o, now_s));
  while (o->count > 0 && due(o) <= now_s) {
    o->wanted_V = o->queue[o->first];
    o->first = (o->first + 1) % o->capacity;
    o->count--;
    o->played++;
  }
  if (o->wanted_V == o->sent_V) {
    o->waiting_s = NAN;
  } else if (isnan(o->waiting_s)) {
    o->waiting_s = now_s;
  }
  return DEA_OK;
}

/* When the voltage is asked for next: about every `measure_interval_s`, not in step with what is
 * played. Sooner where the meter has yet to be seen to follow, and the output should be away from
 * 0 V; at the latest before it leaves that. */
static double measure_at(const struct dea_timed_output *o, double now_s)
{
  const struct dea_evidence *e = &o->evidence;
  double away_V = fmax(2 * e->zero_V, 0.5 * e->largest_V);
  double again_s = o->measured_s + fmin(urgent_s, o->measure_interval_s);
  bool due_now = !isnan(o->waiting_s) && now_s >= o->sent_s + o->output_interval_s;
  double turn = 0.5 + fmod(golden * (double)e->readings, 1);
  bool away = fabs(o->sent_V) >= away_V && o->sent_V != 0 && o->sent_s > o->measured_s;
  bool leaves = away && due_now && fabs(o->wanted_V) < away_V;
  double turn_s = o->measured_s + turn * o->measure_interval_s;
  if (isinf(o->measure_interval_s) || !away || !dea_evidence_wants(e)) {
    // every other one is at the end of a level, where there is one
    bool end =
        leaves && e->readings % 2 == 1 && now_s > o->measured_s + 0.5 * o->measure_interval_s;
    return end ? now_s : turn_s;
  }
  return leaves ? now_s : again_s;
}

enum dea_timed_action dea_timed_next(struct dea_timed_output *o, double now_s, double late_s,
                                     double *next_s)
{
  double measure_s = measure_at(o, now_s);
  *next_s = o->count > 0 ? due(o) : INFINITY;
  if (now_s > late_s) {
    return DEA_TIMED_LATE;
  }
  if (!isnan(o->waiting_s) && now_s > o->waiting_s + o->behind_s + o->output_interval_s) {
    return DEA_TIMED_BEHIND;
  }
  if (!isnan(late_s)) {
    *next_s = fmin(*next_s, late_s);
    return DEA_TIMED_NOTHING;
  }
  if (now_s >= measure_s) {
    o->measured_s = now_s;
    return DEA_TIMED_MEASURE;
  }
  *next_s = fmin(*next_s, measure_s);
  if (!isnan(o->waiting_s)) {
    if (now_s >= o->sent_s + o->output_interval_s) {
      return DEA_TIMED_SEND;
    }
    *next_s = fmin(*next_s, o->sent_s + o->output_interval_s);
  }
  return DEA_TIMED_NOTHING;
}

void dea_timed_sent(struct dea_timed_output *o, double volts, double now_s)
{
  dea_evidence_sent(&o->evidence, volts, now_s);
  o->sent_V = volts;
  o->sent_s = now_s;
  o->waiting_s = NAN;
}

double dea_timed_hold(struct dea_timed_output *o, double now_s)
{
  o->first = o->count = 0;
  o->wanted_V = o->sent_V;
  o->waiting_s = NAN;
  o->turned_s = now_s;
  o->clock_s = o->turned_s - (double)o->played / o->rate_Hz;
  return o->sent_V;
}

dea_status dea_timed_measured(struct dea_context *ctx, struct dea_timed_output *o,
                              const struct dea_protocol *protocol, const char *name, double volts)
{
  double gain = protocol->amplifier.gain.si, share = protocol->safety.readback_error.si;
  char text[DEA_EVIDENCE_TEXT_SIZE];
  enum dea_evidence_verdict verdict =
      dea_evidence_measured(&o->evidence, volts, o->measured_s, fmax(o->measured_s, o->turned_s));
  dea_evidence_text(&o->evidence, gain, text);
  switch (verdict) {
  case DEA_EVIDENCE_FOLLOWS:
    return DEA_OK;
  case DEA_EVIDENCE_OFF: // the output goes to 0 V along the ramp
    return dea_fail(ctx, DEA_E_INTERLOCK,
                    "%s %s, off by more than safety.readback_error of %.3g %% for 5 s", name, text,
                    100 * share);
  default:
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s %s, more than safety.voltage_error of %.4g V away",
                    name, text, protocol->safety.voltage_error_V.si);
  }
}
