/* The output of a supply that the computer's clock plays: what waits to be sent, what is due, and
 * what a measured voltage may be. It sends nothing itself. Voltages are control voltages.
 *
 * At most one question is open at a time, so that an answer can belong to nothing else, and a
 * voltage counts as set once it was confirmed: a supply never has more to do than one voltage, and
 * one that takes longer than `behind` for it has failed. */
#pragma once

#include "base/context.h"
#include "base/value.h"
#include "instrument/voltage_evidence.h"
#include "protocol/protocol.h"

/* What is to be done now. */
enum dea_timed_action {
  DEA_TIMED_NOTHING, // until *next_s
  DEA_TIMED_LATE,    // the open question was not answered in time
  DEA_TIMED_BEHIND,  // a voltage could not be sent in time
  DEA_TIMED_MEASURE, // ask for the voltage; measured_s is now
  DEA_TIMED_SEND     // send wanted_V, then note it
};

/* Zero-initialised: it plays nothing. */
struct dea_timed_output {
  double *queue; // [room], a ring; owned. NULL: it plays nothing
  size_t capacity, first, count;
  size_t played;                // samples taken out of the queue since clock_s
  double queue_s, behind_s;     // that the queue holds; that a voltage may take
  double output_interval_s;     // shortest time between two voltages
  double measure_interval_s;    // between two measured ones; INFINITY: none
  double rate_Hz, clock_s;      // sample 0 is at clock_s, by the computer's clock; NAN: not
                                // started
  double wanted_V, sent_V;      // what the output should be, and the last that was sent
  double sent_s, waiting_s;     // when that was; since when `wanted_V` waits, NAN: it does not
  double measured_s;            // when the voltage was asked for last
  struct dea_evidence evidence; // of the measured voltage
  double turned_s;              // when it was played last
};

/* Warns where the time in which 0 V has to be read back is too short for that to last `behind`: one
 * late answer would leave the output not known to be at 0 V; and where the sequence is too fast for
 * a meter that may be so late. */
dea_status dea_timed_check(struct dea_context *ctx, const struct dea_quantity *behind,
                           const struct dea_protocol *protocol);
/* The limits of what is measured. */
void dea_timed_limits(struct dea_timed_output *output, const struct dea_protocol *protocol);
/* Makes the queue; the times are set before. */
dea_status dea_timed_begin(struct dea_context *ctx, struct dea_timed_output *output);
void dea_timed_end(struct dea_context *ctx, struct dea_timed_output *output);
void dea_timed_start(struct dea_timed_output *output, double now_s);
/* Whether there is something to play. */
bool dea_timed_plays(const struct dea_timed_output *output);
/* Adds samples to the queue; while it is full, serve(ctx, supply, until_s) plays until the next of
 * them is due, or less long. More than it holds before the start is DEA_E_ARGUMENT. */
dea_status dea_timed_write(
    struct dea_context *ctx, struct dea_timed_output *output, const double *volts, size_t count,
    dea_status (*serve)(struct dea_context *ctx, void *supply, double until_s), void *supply);
/* Takes what is due out of the queue. DEA_E_INTERLOCK when the computer was away for longer than
 * the queue: neither a loop that is late, nor a jump to where the waveform has got to meanwhile. */
dea_status dea_timed_read(struct dea_context *ctx, struct dea_timed_output *output, double now_s);
/* What to do after that. late_s: from when on the open question is late; NAN: none is open.
 * *next_s: when there will be something to do. */
enum dea_timed_action dea_timed_next(struct dea_timed_output *output, double now_s, double late_s,
                                     double *next_s);
void dea_timed_sent(struct dea_timed_output *output, double volts, double now_s);
/* After a stall: drops the queue; the voltage where the output stands. */
double dea_timed_hold(struct dea_timed_output *output, double now_s);
/* A measured voltage. name: of the supply. What is off is DEA_E_INTERLOCK, after which the output
 * goes to 0 V along the ramp; what contradicts what was sent DEA_E_INSTRUMENT. */
dea_status dea_timed_measured(struct dea_context *ctx, struct dea_timed_output *output,
                              const struct dea_protocol *protocol, const char *name, double volts);
