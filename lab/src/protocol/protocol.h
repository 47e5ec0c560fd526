/* The protocol: what is played to an amplifier, what is measured, and what must never happen.
 *
 * A YAML file with the reader of design files: every value in its unit, every error at its place.
 */
#pragma once

#include "protocol/bench_film.h"
#include "recording/recording.h"
#include "waveform/waveform.h"

enum {
  DEA_PROTOCOL_VERSION = 1,
  DEA_PROTOCOL_STEPS_MAX = 256,
  DEA_PROTOCOL_INPUTS_MAX = 16,
  DEA_PROTOCOL_INSTRUMENTS_MAX = 8,
};

/* One step of the sequence: a waveform from its start to its end, as often as asked, then 0 V. */
struct dea_protocol_step {
  struct dea_label label;
  const struct dea_node *section; // of the waveform; lent by the document
  struct dea_waveform *waveform;  // owned
  struct dea_quantity repeat, pause_s;
  double start_s;             // on the sequence's clock
  size_t first_cycle, cycles; // number of its first one over the whole sequence; of one repetition
  double lowest_V, highest_V; // of the waveform
};

/* An analogue input: value [SI] = volts * per_volt + at_zero. */
struct dea_protocol_input {
  struct dea_label name, terminal; // "centre laser", "ai1"
  struct dea_choice kind;          // enum dea_channel_kind
  struct dea_quantity range_V;     // of the input, +-
  struct dea_label per_volt_text, at_zero_text, unit;
  double per_volt, at_zero;
  struct dea_quantity filter_Hz;
};

/* An instrument's section: its kind and keys, read with the table of that kind. */
struct dea_protocol_instrument {
  const struct dea_node *section; // lent by the document
  const char *path;               // "instruments[0]"; interned
};

/* What one film stands, by a file of its own. */
struct dea_specimen {
  struct dea_label name;
  struct dea_quantity highest_V; // of either sign; absent: no specimen is named
};

struct dea_protocol {
  const char *file; // interned
  struct dea_label title;
  struct dea_label design_file;
  struct dea_bench_film *film; // of that design; owned; NULL: none named
  struct dea_label specimen_file;
  struct dea_specimen specimen;
  char *text, *design_text; // whole files; owned; the second NULL without a design
  char *overrides;          // of values in the file, "key=value; key=value"; owned; NULL: none

  struct dea_protocol_step *steps; // [step_count], owned
  size_t step_count;

  struct {
    struct dea_label name, terminal;         // "Trek 10/10B-HS", "ao0"
    struct dea_quantity gain;                // output over control voltage, V/V
    struct dea_quantity control_V;           // largest control voltage, +-
    struct dea_quantity lowest_V, highest_V; // of the output
    struct dea_quantity slew_V_per_s, current_A;
  } amplifier;

  struct dea_quantity rate_Hz;       // of all inputs and the output
  struct dea_protocol_input *inputs; // [input_count], owned
  size_t input_count;

  struct {
    struct dea_quantity field_margin;          // breakdown field over largest true field, at least
    struct dea_quantity largest_field_V_per_m; // instead of it
    struct dea_label field_reason;             // why a field above breakdown is allowed
    struct dea_quantity trip_current_A, trip_time_s; // a current above it for that long ends it
    struct dea_quantity trip_count;             // of excursions above it in 10 s that end it too
    struct dea_quantity voltage_error_V;        // largest |measured - asked| once settled
    struct dea_quantity readback_error;         // the same as a share of it, for 5 s
    struct dea_quantity leak_rise, leak_time_s; // above the base line: a share of it, for how long
    struct dea_quantity leak_least_A;           // below it a rise is none
    struct dea_quantity ramp_V_per_s;           // to 0 V, when it ends early
    struct dea_quantity at_zero_V, zero_time_s; // what is 0 V, read back, and by when
    struct dea_quantity guard_time_s;           // without a sign of life, for the guard
    struct dea_quantity longest_ramp_s;         // of that ramp
  } safety;

  struct dea_protocol_instrument instruments[DEA_PROTOCOL_INSTRUMENTS_MAX];
  size_t instrument_count;
  struct dea_protocol_instrument sim; // of the simulated bench; always there, with its kind

  struct dea_yaml *document; // owned
  struct dea_listing values;
};

/* Reads a protocol and the files that it names. films: NULL where only its output is to be brought
 * to 0 V, which waits for no other file: then it has neither design, specimen nor steps. Errors are
 * findings; DEA_E_DESIGN after the whole file was looked at. out: owned by the caller, NULL on
 * failure. */
dea_status dea_protocol_read(struct dea_context *ctx, const struct dea_bench_film_type *films,
                             const char *file, const struct dea_override *overrides,
                             size_t override_count, struct dea_protocol **out);
/* The same of a text; file: its name, for places and for what it names beside it. */
dea_status dea_protocol_read_memory(struct dea_context *ctx,
                                    const struct dea_bench_film_type *films, const char *file,
                                    const char *text, size_t length,
                                    const struct dea_override *overrides, size_t override_count,
                                    struct dea_protocol **out);
void dea_protocol_destroy(struct dea_context *ctx, struct dea_protocol *protocol);

/* The table of a protocol's keys. Its record points to its fields: not to be copied. */
enum { DEA_PROTOCOL_KEYS = 12 };
struct dea_protocol_schema {
  struct dea_record record;
  struct dea_field fields[DEA_PROTOCOL_KEYS];
};
/* instruments, sim: tables of the kinds that these sections may be of, ended by NULL; lent. */
void dea_protocol_schema_fill(const struct dea_record *const *instruments,
                              const struct dea_record *const *sim, struct dea_protocol_schema *out);

/* The largest voltages [V] that may ever go out: of the amplifier, of its control voltage, and of
 * the specimen. */
void dea_protocol_cap(const struct dea_protocol *protocol, double *lowest_V, double *highest_V);
/* The last look before the wire, whatever was checked before: DEA_E_INTERLOCK when one of the
 * control voltages is beyond the cap or no number. Nothing of them may go out then. */
dea_status dea_protocol_guard(struct dea_context *ctx, const struct dea_protocol *protocol,
                              const double *volts, size_t count);
/* The largest voltage [V] that may be called 0 V of an output that gives so much, and of the
 * protocol's amplifier, whatever safety.at_zero says. */
double dea_zero_most_V(double range_V);
double dea_protocol_zero_most_V(const struct dea_protocol *protocol);
/* Whether a number that is sent for 1 V of control voltage can be right: an instrument takes the
 * control voltage in V, or the amplifier's output in V or kV. */
bool dea_protocol_factor_is_known(const struct dea_protocol *protocol, double factor);

/* The sequence on one clock from 0 on. */
double dea_protocol_duration_s(const struct dea_protocol *protocol);
/* Asked voltage [V] at a time; 0 in pauses and after the end. Where it jumps: after the jump. */
double dea_protocol_value(const struct dea_protocol *protocol, double time_s);
/* Next time after time_s at which it bends, jumps or ends; INFINITY after the end. */
double dea_protocol_corner(const struct dea_protocol *protocol, double time_s);
/* The samples in which it is played, by a bench and by scripts alike: sample i is at i / rate, a
 * corner that falls on a sample but for rounding is at it, and the last one is 0 V. */
struct dea_protocol_samples {
  const struct dea_protocol *protocol; // lent
  size_t next, total;                  // number of the next one; of all of them
  double corner_s;                     // the next one
};
/* How many there are before the last one; a number, as it may be more than can be counted. */
double dea_protocol_sample_count(const struct dea_protocol *protocol);
void dea_protocol_samples_start(struct dea_protocol_samples *samples,
                                const struct dea_protocol *protocol);
/* The next one's voltage [V], while next < total. */
double dea_protocol_samples_next(struct dea_protocol_samples *samples);
/* Number of cycles of the whole sequence. */
size_t dea_protocol_cycles(const struct dea_protocol *protocol);
/* Cycle of that number, counted over the whole sequence; false when it has no more. A waveform
 * without cycles (a chirp) is one cycle. */
bool dea_protocol_cycle(const struct dea_protocol *protocol, size_t number,
                        struct dea_recorded_cycle *out);

/* How long the equal cycles of a step are: of its waveform, or its repetitions; of a voltage that
 * stays 10 s. NAN: nothing in it repeats. */
double dea_protocol_period_s(const struct dea_protocol_step *step);
/* A base line of the leakage current is learned from the first so many passes of a cycle, or of
 * several cycles where they are shorter than that. */
enum { DEA_LEAK_VISITS = 8, DEA_LEAK_VISIT_S = 1 };
/* How long that takes about; INFINITY: the step ends before. */
double dea_protocol_learning_s(const struct dea_protocol_step *step);

/* What the checks found out, for `dea drive` to print. NAN: not known. */
struct dea_protocol_plan {
  double duration_s;
  size_t cycles, samples;
  double lowest_V, highest_V;   // of the asked voltage
  double largest_field_V_per_m; // true field of the film at that
  double allowed_field_V_per_m;
  double breakdown_field_V_per_m;       // of the film there, by the smallest value of its sources
  double breakdown_probability;         // of one way up; NAN where nobody measured the distribution
  double breakdown_probability_band[2]; // by the largest and smallest value of its sources; or NAN
  double pull_in_V;             // lowest voltage without equilibrium; NAN: none below limits
  double capacitance_F, rise_s; // of the film; for the largest jump, by slew and current
  double stored_energy_J;       // in the film at the largest voltage
};
/* Compares the protocol with its amplifier, its channels and its design. What must not be played is
 * an error finding, what a user should know a warning or a note. DEA_E_INTERLOCK with errors. */
dea_status dea_protocol_check(struct dea_context *ctx, const struct dea_protocol *protocol,
                              struct dea_protocol_plan *plan);
