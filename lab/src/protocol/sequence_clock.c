/* The sequence on one clock, and what repeats in it. A time falls into a step, a repetition of its
 * waveform, and a time of that waveform, which begins anew for every repetition. */
#include "protocol/protocol.h"

#include <math.h>

// of a sample's distance to the next: times that differ by less are the same, rounded
static const double rounding = 1e-6;
enum { CYCLES_LOOKED_AT = 1000 };
static const double alike = 1e-9, section_s = 10; // of a waveform; of a voltage that stays

/* Where a time falls. */
struct spot {
  const struct dea_protocol_step *step;
  double repetition;       // its number; that of all of them in the pause and after it
  double start_s, local_s; // of the repetition, and in it
};

static double step_end(const struct dea_protocol_step *step)
{
  return step->start_s + step->repeat.si * step->waveform->end_s;
}

static double start_of(const struct dea_protocol_step *step, double repetition)
{
  return step->start_s + repetition * step->waveform->end_s;
}

double dea_protocol_duration_s(const struct dea_protocol *protocol)
{
  const struct dea_protocol_step *last = &protocol->steps[protocol->step_count - 1];
  return step_end(last) + last->pause_s.si;
}

static struct spot find_spot(const struct dea_protocol *protocol, double time_s)
{
  size_t low = 0, high = protocol->step_count;
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    *(protocol->steps[middle].start_s <= time_s ? &low : &high) = middle;
  }
  struct spot spot = {.step = &protocol->steps[low]};
  double repeat = spot.step->repeat.si, length = spot.step->waveform->end_s;
  double number = fmin(fmax(floor((time_s - spot.step->start_s) / length), 0), repeat);
  while (number > 0 && start_of(spot.step, number) > time_s) {
    number--; // the quotient was rounded up
  }
  while (number < repeat && start_of(spot.step, number + 1) <= time_s) {
    number++;
  }
  spot.repetition = number;
  spot.start_s = start_of(spot.step, number);
  spot.local_s = fmax(time_s - spot.start_s, 0);
  // The difference may be rounded to just before a corner that this time is at.
  double next = dea_waveform_corner(spot.step->waveform, spot.local_s);
  if (spot.start_s + next <= time_s) {
    spot.local_s = next;
  }
  return spot;
}

double dea_protocol_value(const struct dea_protocol *protocol, double time_s)
{
  struct spot spot = find_spot(protocol, time_s);
  return spot.repetition < spot.step->repeat.si && spot.local_s < spot.step->waveform->end_s
             ? dea_waveform_value(spot.step->waveform, spot.local_s)
             : 0;
}

double dea_protocol_corner(const struct dea_protocol *protocol, double time_s)
{
  if (time_s >= dea_protocol_duration_s(protocol)) {
    return INFINITY;
  }
  struct spot spot = find_spot(protocol, time_s);
  if (spot.repetition < spot.step->repeat.si) {
    double end_s = start_of(spot.step, spot.repetition + 1);
    double next = dea_waveform_corner(spot.step->waveform, spot.local_s);
    // The end is that of the repetition, however the sum is rounded.
    return next < spot.step->waveform->end_s ? fmin(spot.start_s + next, end_s) : end_s;
  }
  const struct dea_protocol_step *last = protocol->steps + protocol->step_count - 1;
  return spot.step == last ? dea_protocol_duration_s(protocol) : spot.step[1].start_s;
}

double dea_protocol_sample_count(const struct dea_protocol *protocol)
{
  return ceil(dea_protocol_duration_s(protocol) * protocol->rate_Hz.si - rounding);
}

void dea_protocol_samples_start(struct dea_protocol_samples *samples,
                                const struct dea_protocol *protocol)
{
  *samples = (struct dea_protocol_samples){
      .protocol = protocol,
      .total = (size_t)dea_protocol_sample_count(protocol) + 1,
      .corner_s = dea_protocol_corner(protocol, 0),
  };
}

double dea_protocol_samples_next(struct dea_protocol_samples *samples)
{
  // i / rate, not i times an interval, which is rounded
  double rate_Hz = samples->protocol->rate_Hz.si, time_s = (double)samples->next / rate_Hz;
  while (samples->corner_s <= time_s + rounding / rate_Hz) {
    time_s = fmax(time_s, samples->corner_s);
    samples->corner_s = dea_protocol_corner(samples->protocol, samples->corner_s);
  }
  samples->next++;
  return samples->next == samples->total ? 0 : dea_protocol_value(samples->protocol, time_s);
}

size_t dea_protocol_cycles(const struct dea_protocol *protocol)
{
  const struct dea_protocol_step *last = &protocol->steps[protocol->step_count - 1];
  return last->first_cycle + (size_t)last->repeat.si * last->cycles;
}

bool dea_protocol_cycle(const struct dea_protocol *protocol, size_t number,
                        struct dea_recorded_cycle *out)
{
  size_t low = 0, high = protocol->step_count;
  if (number >= dea_protocol_cycles(protocol)) {
    return false;
  }
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    *(protocol->steps[middle].first_cycle <= number ? &low : &high) = middle;
  }
  const struct dea_protocol_step *step = &protocol->steps[low];
  struct dea_wave_cycle cycle;
  size_t within = number - step->first_cycle, repetition = within / step->cycles;
  double start_s = start_of(step, (double)repetition);
  if (!dea_waveform_cycle(step->waveform, within % step->cycles, &cycle)) {
    bool down = -step->lowest_V > step->highest_V;
    cycle =
        (struct dea_wave_cycle){0, step->waveform->end_s, down ? step->lowest_V : step->highest_V};
  }
  *out = (struct dea_recorded_cycle){low, within, start_s + cycle.start_s, start_s + cycle.end_s,
                                     cycle.level_V};
  return true;
}

// What repeats -----------------------------------------------------------------------------------

/* Of the cycles of a waveform that are of one length and lie end to end: how many in a row, at
 * most, have the same level. 0: they are not. */
static size_t longest_run(const struct dea_protocol_step *step, double *length_s)
{
  const struct dea_waveform *w = step->waveform;
  struct dea_wave_cycle first, next;
  double end_s = 0, error_s = alike * w->end_s, level_V = NAN;
  size_t run = 0, longest = 0;
  if (!dea_waveform_cycle(w, 0, &first) || first.start_s != 0) {
    return 0;
  }
  for (size_t i = 0; i < step->cycles && i < CYCLES_LOOKED_AT; i++) {
    if (!dea_waveform_cycle(w, i, &next) || fabs(next.start_s - end_s) > error_s ||
        fabs(next.end_s - next.start_s - first.end_s) > error_s) {
      return 0;
    }
    run = next.level_V == level_V ? run + 1 : 1;
    longest = run > longest ? run : longest;
    level_V = next.level_V;
    end_s = next.end_s;
  }
  *length_s = first.end_s;
  return longest == CYCLES_LOOKED_AT ? step->cycles : longest;
}

double dea_protocol_period_s(const struct dea_protocol_step *step)
{
  double length_s;
  if (step->lowest_V == step->highest_V) {
    return section_s;
  }
  size_t run = longest_run(step, &length_s);
  if (run > DEA_LEAK_VISITS || (run == step->cycles && run > 1)) {
    return length_s;
  }
  return step->repeat.si > 1 ? step->waveform->end_s : (double)NAN;
}

double dea_protocol_learning_s(const struct dea_protocol_step *step)
{
  double period_s = dea_protocol_period_s(step), length_s, end_s = step->waveform->end_s;
  double there_s = step->repeat.si * end_s;
  if (period_s < end_s && step->lowest_V != step->highest_V) {
    size_t run = longest_run(step, &length_s);
    there_s = run < step->cycles ? (double)run * period_s : there_s;
  }
  // a visit ends with the first cycle that ends a second after it began
  double learned_s = (DEA_LEAK_VISITS + 1) * period_s * fmax(1, ceil(DEA_LEAK_VISIT_S / period_s));
  return learned_s < there_s ? learned_s : (double)INFINITY; // INFINITY for NAN
}
