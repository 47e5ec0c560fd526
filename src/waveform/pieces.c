/* Waveforms of straight pieces and of sines, and what is asked of every waveform. Knot k of cycle n
 * of a block is at start + (n + phase)/f + offset: one formula everywhere, so that a corner found
 * is the very time at which the value bends. */
#include "waveform/wave_make.h"

#include <math.h>

/* A knot: block, cycle, number within the cycle. */
struct spot {
  const struct dea_wave_block *block;
  size_t cycle, knot;
};

static double time_at(const struct dea_waveform *w, const struct dea_wave_block *block,
                      size_t cycle, size_t knot)
{
  const struct dea_wave_knot *k = &w->knots[block->first + knot];
  return block->start_s + ((double)cycle + k->phase) / block->frequency_Hz + k->offset_s;
}

/* Whether what is at `at` counts at `time`: from it on, or (before) strictly before it. */
static bool reached(double at, double time, bool before)
{
  return before ? at < time : at <= time;
}

/* The last knot at or before a time (before: strictly before it), at least the first one. */
static struct spot find_spot(const struct dea_waveform *w, double time, bool before)
{
  size_t low = 0, high = w->block_count;
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    *(reached(time_at(w, &w->blocks[middle], 0, 0), time, before) ? &low : &high) = middle;
  }
  struct spot spot = {.block = &w->blocks[low]};
  const struct dea_wave_block *b = spot.block;
  double cycles = floor((time - b->start_s) * b->frequency_Hz);
  spot.cycle = cycles <= 0 ? 0 : cycles >= (double)(b->cycles - 1) ? b->cycles - 1 : (size_t)cycles;
  while (spot.cycle > 0 && !reached(time_at(w, b, spot.cycle, 0), time, before)) {
    spot.cycle--; // the product was rounded up
  }
  while (spot.cycle + 1 < b->cycles && reached(time_at(w, b, spot.cycle + 1, 0), time, before)) {
    spot.cycle++;
  }
  low = 0;
  high = b->count;
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    *(reached(time_at(w, b, spot.cycle, middle), time, before) ? &low : &high) = middle;
  }
  spot.knot = low;
  return spot;
}

static double piece_value(const struct dea_waveform *w, double time, bool before)
{
  struct spot spot = find_spot(w, time, before);
  const struct dea_wave_knot *knot = &w->knots[spot.block->first + spot.knot];
  if (spot.knot + 1 == spot.block->count) {
    return knot->value_V;
  }
  double from = time_at(w, spot.block, spot.cycle, spot.knot);
  double to = time_at(w, spot.block, spot.cycle, spot.knot + 1);
  double share = to > from ? (time - from) / (to - from) : 1;
  return share >= 1   ? knot[1].value_V
         : share <= 0 ? knot->value_V
                      : knot->value_V + share * (knot[1].value_V - knot->value_V);
}

static double next_knot(const struct dea_waveform *w, double time)
{
  struct spot spot = find_spot(w, time, false);
  const struct dea_wave_block *b = spot.block, *last = w->blocks + w->block_count;
  for (size_t k = spot.knot + 1; k < b->count; k++) {
    double at = time_at(w, b, spot.cycle, k);
    if (at > time) {
      return at;
    }
  }
  for (size_t n = spot.cycle + 1; n < b->cycles; n++) {
    double at = time_at(w, b, n, 0);
    if (at > time) {
      return at;
    }
  }
  return b + 1 < last ? time_at(w, b + 1, 0, 0) : INFINITY;
}

// Sines ------------------------------------------------------------------------------------------

static const double two_pi = 6.28318530717958647692;

/* sin of 2 pi times a number of cycles, which may be large. */
static double sine_of(double cycles)
{
  return sin(two_pi * (cycles - floor(cycles))); // exact where the cycles are whole
}

double dea_wave_cycles(const struct dea_wave_sine *p, double t)
{
  double T = p->sweep_s;
  if (!p->logarithmic) {
    return p->from_Hz * t + (p->to_Hz - p->from_Hz) * t * t / (2 * T);
  }
  double rate = log(p->to_Hz / p->from_Hz);
  return p->from_Hz * T / rate * expm1(rate * t / T);
}

static double sine_value(const struct dea_wave_sine *p, double t)
{
  double burst = p->bursts > 0 ? fmin(floor(t / p->period_s), p->bursts - 1) : 0;
  double cycles = dea_wave_cycles(p, t - burst * p->period_s);
  return p->bursts > 0 && cycles >= p->cycles
             ? p->mean_V
             : p->mean_V + p->amplitude_V * sine_of(cycles + p->phase);
}

/* Whether a number of cycles with this fraction lies within so many. */
static bool passes(double fraction, double cycles)
{
  return floor(cycles - fraction) >= ceil(-fraction);
}

/* Of its cycles from phase 0: those with another phase are whole. */
static void sine_extent(const struct dea_wave_sine *p, struct dea_wave_extent *out)
{
  double to = sine_of(p->cycles), amplitude_V = p->amplitude_V;
  double top = passes(0.25, p->cycles) ? 1 : fmax(0, to);
  double bottom = passes(0.75, p->cycles) ? -1 : fmin(0, to);
  *out = (struct dea_wave_extent){p->mean_V + fmin(amplitude_V * top, amplitude_V * bottom),
                                  p->mean_V + fmax(amplitude_V * top, amplitude_V * bottom),
                                  two_pi * fabs(amplitude_V) * fmax(p->from_Hz, p->to_Hz)};
}

// All --------------------------------------------------------------------------------------------

static double value_of(const struct dea_waveform *w, double time, bool before)
{
  double at = fmin(fmax(time, 0), w->end_s);
  return w->sine.cycles > 0 ? sine_value(&w->sine, at) : piece_value(w, at, before && at >= time);
}

double dea_waveform_value(const struct dea_waveform *waveform, double time_s)
{
  return value_of(waveform, time_s, false);
}

double dea_waveform_before(const struct dea_waveform *waveform, double time_s)
{
  return value_of(waveform, time_s, true);
}

double dea_waveform_corner(const struct dea_waveform *waveform, double time_s)
{
  double next = waveform->block_count > 0 ? next_knot(waveform, time_s) : INFINITY;
  return waveform->end_s > time_s ? fmin(next, waveform->end_s) : INFINITY;
}

static void piece_extent(const struct dea_waveform *w, struct dea_wave_extent *out)
{
  *out = (struct dea_wave_extent){INFINITY, -INFINITY, 0};
  for (size_t i = 0; i < w->block_count; i++) { // every cycle of a block is like the first one
    const struct dea_wave_block *b = &w->blocks[i];
    for (size_t k = 0; k < b->count; k++) {
      const struct dea_wave_knot *knot = &w->knots[b->first + k], *next = knot + 1;
      out->lowest_V = fmin(out->lowest_V, knot->value_V);
      out->highest_V = fmax(out->highest_V, knot->value_V);
      double time_s = k + 1 < b->count ? (next->phase - knot->phase) / b->frequency_Hz +
                                             next->offset_s - knot->offset_s
                                       : 0;
      if (time_s > 0) {
        out->slope_V_per_s = fmax(out->slope_V_per_s, fabs(next->value_V - knot->value_V) / time_s);
      }
    }
  }
}

void dea_waveform_extent(const struct dea_waveform *waveform, struct dea_wave_extent *out)
{
  if (waveform->sine.cycles > 0) {
    sine_extent(&waveform->sine, out);
  } else {
    piece_extent(waveform, out);
  }
}

bool dea_waveform_cycle(const struct dea_waveform *waveform, size_t number,
                        struct dea_wave_cycle *out)
{
  const struct dea_wave_sine *p = &waveform->sine;
  if (waveform->block_count == 0) { // of a sweep none is like another
    out->start_s = (double)number / p->from_Hz;
    out->end_s = (double)(number + 1) / p->from_Hz;
    out->level_V = p->mean_V + copysign(p->amplitude_V, p->mean_V);
    return !p->sweeps && (double)number < p->cycles;
  }
  for (size_t i = 0; i < waveform->block_count; i++) {
    const struct dea_wave_block *b = &waveform->blocks[i];
    if (number < b->cycles) {
      out->start_s = b->start_s + (double)number / b->frequency_Hz;
      out->end_s = b->start_s + (double)(number + 1) / b->frequency_Hz;
      out->level_V = 0;
      for (size_t k = 0; k < b->count; k++) {
        double value = waveform->knots[b->first + k].value_V;
        out->level_V = fabs(value) > fabs(out->level_V) ? value : out->level_V;
      }
      return true;
    }
    number -= b->cycles;
  }
  return false;
}

// Making -----------------------------------------------------------------------------------------

void dea_wave_add(struct dea_waveform *w, double phase, double offset_s, double value_V)
{
  w->failed = w->failed || dea_array_grow(w->ctx, &w->knots, w->knot_count, &w->knot_capacity,
                                          sizeof *w->knots) != DEA_OK;
  if (!w->failed) {
    w->knots[w->knot_count++] = (struct dea_wave_knot){phase, offset_s, value_V};
    w->blocks[w->block_count - 1].count++;
  }
}

void dea_wave_open(struct dea_waveform *w, double start_s, double frequency_Hz, size_t cycles)
{
  w->failed = w->failed || dea_array_grow(w->ctx, &w->blocks, w->block_count, &w->block_capacity,
                                          sizeof *w->blocks) != DEA_OK;
  if (!w->failed) {
    w->blocks[w->block_count++] =
        (struct dea_wave_block){start_s, frequency_Hz, cycles, w->knot_count, 0};
  }
}
