/* Waveforms: a voltage for every time from 0 on, with the times at which it bends or jumps.
 *
 * A waveform knows nothing of what it drives: a study plays it to a model, a laboratory to an
 * amplifier. A kind is a table of keys with a function, and one line in waveform.c. Times are found
 * from whole numbers of cycles, never by adding up, so that nothing drifts over thousands of
 * cycles.
 */
#pragma once

#include "base/schema.h"

struct dea_waveform;

/* One cycle of a waveform, from 0: at what time, and at what voltage it is driven. */
struct dea_wave_cycle {
  double start_s, end_s;
  double level_V; // voltage farthest from 0 within it
};

/* A corner of a waveform of straight pieces: at (cycle + phase)/frequency + offset_s after the
 * start of its block. Two at one time are a jump. */
struct dea_wave_knot {
  double phase, offset_s, value_V;
};
/* The same knots cycle after cycle; between the last one and what follows the value stays. */
struct dea_wave_block {
  double start_s, frequency_Hz;
  size_t cycles, first, count; // knots [first, first + count) of the waveform
};

/* How far a waveform goes, and how fast. */
struct dea_wave_extent {
  double lowest_V, highest_V;
  double slope_V_per_s; // fastest change between jumps, >= 0; of a part of a cycle at most that
};

/* A sine about a mean: from its start on, or in bursts that begin every period_s, between which the
 * mean stays. Its frequency may go from one value to another. */
struct dea_wave_sine {
  double mean_V, amplitude_V, phase; // phase at the start, in cycles
  double cycles;                     // of all of it or of a burst; 0: it is no sine
  double from_Hz, to_Hz, sweep_s;    // alike but for a sweep, which takes sweep_s > 0
  bool sweeps, logarithmic;
  double bursts, period_s; // bursts 0: none
};

struct dea_waveform {
  const char *kind;        // "square"
  struct dea_context *ctx; // that it was made with; for dea_waveform_destroy
  double end_s;            // from here on the last value stays
  double longest_step_s;   // that still follows a sine; INFINITY between straight corners
  struct dea_wave_knot *knots;
  struct dea_wave_block *blocks;
  size_t knot_count, block_count, knot_capacity, block_capacity;
  bool failed; // while it is made: memory was short
  struct dea_wave_sine sine;
};

/* Reads the section `node` with the table of its kind. Errors are findings, *out is then NULL and
 * the status DEA_OK, as in dea_schema_read. out: owned by the caller. */
dea_status dea_waveform_read(const struct dea_reader *reader, const struct dea_node *node,
                             const char *path, const char *beside, struct dea_waveform **out);
/* NULL is fine. */
void dea_waveform_destroy(struct dea_waveform *waveform);

/* Voltage [V] from time_s >= 0 on (where it jumps: after the jump), and just before time_s > 0. */
double dea_waveform_value(const struct dea_waveform *waveform, double time_s);
double dea_waveform_before(const struct dea_waveform *waveform, double time_s);
/* The next time after time_s at which the waveform bends, jumps or ends; INFINITY after its end. */
double dea_waveform_corner(const struct dea_waveform *waveform, double time_s);
/* How far and how fast it goes from its start to its end, by its numbers: however long it is,
 * nothing lies between two looks. */
void dea_waveform_extent(const struct dea_waveform *waveform, struct dea_wave_extent *out);
/* Cycle of that number, counted over the whole waveform; false when it has no more of them. */
bool dea_waveform_cycle(const struct dea_waveform *waveform, size_t number,
                        struct dea_wave_cycle *out);

/* What a supply makes of a waveform when its output, 0 V before the start, can change by
 * slew_V_per_s > 0 at most: straight pieces up to until_s, with the corners at which the supply
 * falls behind and catches up. Of a curved waveform it sees eighty chords a cycle. out: owned by
 * the caller; NULL where the waveform is never too fast and plays as it is. */
dea_status dea_waveform_limit(struct dea_context *ctx, const struct dea_waveform *waveform,
                              double slew_V_per_s, double until_s, struct dea_waveform **out);

/* Tables of all kinds for printing, ended by NULL. */
extern const struct dea_record *const dea_wave_records[];
