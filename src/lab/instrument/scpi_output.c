/* The output of a supply that speaks SCPI, timed by the computer's clock. */
#include "lab/instrument/scpi.h"

#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Measured voltages in a row that may differ from what was set: one may be taken while it moves. */
enum { DEVIATIONS_MAX = 2 };

void dea_scpi_output_command(const struct dea_scpi_raw *raw, double volts,
                             char out[DEA_SCPI_COMMAND_SIZE])
{
  char number[32];
  const char *hole = strchr(raw->output.text, '%');
  snprintf(number, sizeof number, "%.9g", volts * raw->output_factor.si);
  char *comma = strchr(number, ',');
  if (comma != NULL) {
    *comma = '.';
  }
  snprintf(out, DEA_SCPI_COMMAND_SIZE, "%.*s%s%s", (int)(hole - raw->output.text), raw->output.text,
           number, hole + 2);
}

bool dea_scpi_confirms(const struct dea_scpi_raw *raw, const char *response)
{
  double value;
  bool number = dea_scpi_number(response, &value);
  return strcmp(raw->confirm.text, "*OPC?") == 0 ? number && value == 1 : response[0] != '\0';
}

// What is set ------------------------------------------------------------------------------------

static void note_sent(struct dea_scpi *s, double volts, double now_s)
{
  struct dea_scpi_output *o = &s->output;
  if (!(now_s - o->window_s < s->raw.behind_s.si)) {
    o->lowest_V[1] = o->lowest_V[0];
    o->highest_V[1] = o->highest_V[0];
    o->lowest_V[0] = o->highest_V[0] = o->sent_V;
    o->window_s = now_s;
  }
  o->lowest_V[0] = fmin(o->lowest_V[0], volts);
  o->highest_V[0] = fmax(o->highest_V[0], volts);
  o->sent_V = volts;
  o->sent_s = now_s;
  o->waiting_s = NAN;
}

static dea_status ask(struct dea_context *ctx, struct dea_scpi *s, enum dea_scpi_question what,
                      const char *question)
{
  s->asked = what;
  s->asked_s = dea_clock_s();
  dea_status status = dea_scpi_send(ctx, &s->link, s->raw.behind_s.si, question);
  s->output.turned_s = dea_clock_s(); // a supply that takes nothing is no stall of the computer
  return status;
}

static dea_status send_voltage(struct dea_context *ctx, struct dea_scpi *s, double volts)
{
  char command[DEA_SCPI_COMMAND_SIZE];
  DEA_TRY(ctx, dea_protocol_guard(ctx, s->protocol, &volts, 1));
  dea_scpi_output_command(&s->raw, volts, command);
  note_sent(s, volts, dea_clock_s());
  DEA_TRY(ctx, dea_scpi_send(ctx, &s->link, s->raw.behind_s.si, command));
  return ask(ctx, s, DEA_SCPI_CONFIRM, s->raw.confirm.text);
}

dea_status dea_scpi_output_begin(struct dea_context *ctx, struct dea_scpi *s)
{
  struct dea_scpi_output *o = &s->output;
  o->rate_Hz = s->protocol->rate_Hz.si;
  o->clock_s = o->waiting_s = NAN;
  o->room = (size_t)(s->raw.queue_s.si * o->rate_Hz) + 1;
  o->queue = dea_alloc(ctx, o->room, sizeof *o->queue);
  return o->queue != NULL ? DEA_OK : DEA_E_MEMORY;
}

dea_status dea_scpi_output_open(struct dea_context *ctx, struct dea_scpi *s)
{
  const char *response;
  double timeout_s = s->raw.timeout_s.si, value, gain = s->protocol->amplifier.gain.si;
  char command[DEA_SCPI_COMMAND_SIZE];
  dea_scpi_output_command(&s->raw, 0, command);
  DEA_TRY(ctx, dea_scpi_send(ctx, &s->link, timeout_s, command));
  DEA_TRY(ctx, dea_scpi_ask(ctx, &s->link, timeout_s, s->raw.confirm.text, &response));
  if (response == NULL || !dea_scpi_confirms(&s->raw, response)) {
    return dea_scpi_no_response(ctx, s, s->raw.confirm.text, timeout_s);
  }
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                               "%s plays by the computer's clock, at most %.3g voltages a second",
                               s->name, 1 / s->raw.output_interval_s.si));
  if (s->raw.measure.origin == DEA_ABSENT) {
    return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                           "the output of %s is not read back, as it has no 'measure': that it is "
                           "at 0 V will not be known",
                           s->name);
  }
  DEA_TRY(ctx, dea_scpi_ask(ctx, &s->link, timeout_s, s->raw.measure.text, &response));
  if (response == NULL || !dea_scpi_number(response, &value) || isnan(value)) {
    return dea_scpi_no_response(ctx, s, s->raw.measure.text, timeout_s);
  }
  value *= gain / s->raw.output_factor.si;
  return fabs(value) <= s->protocol->safety.at_zero_V.si
             ? DEA_OK
             : dea_fail(ctx, DEA_E_INTERLOCK,
                        "%s measures %.4g V at its output before anything is played; look at what "
                        "is connected to it",
                        s->name, value);
}

dea_status dea_scpi_output_start(struct dea_context *ctx, struct dea_scpi *s)
{
  struct dea_scpi_output *o = &s->output;
  o->turned_s = o->clock_s = o->window_s = o->measured_s = o->fed_s = s->start_s;
  return s->raw.watchdog.arm.origin != DEA_ABSENT
             ? dea_scpi_send(ctx, &s->link, s->raw.behind_s.si, s->raw.watchdog.arm.text)
             : DEA_OK;
}

// The queue --------------------------------------------------------------------------------------

/* Whether the computer was away while there was something to play: neither a loop that is late, nor
 * a jump to where the waveform has got to meanwhile. */
static dea_status check_stall(struct dea_context *ctx, struct dea_scpi *s, double now_s)
{
  struct dea_scpi_output *o = &s->output;
  double due_s = o->count > 0 ? o->clock_s + (double)o->played / o->rate_Hz : now_s;
  double away_s = fmax(now_s - due_s, now_s - o->turned_s);
  bool idle = o->count == 0 && o->sent_V == 0 && o->wanted_V == 0;
  o->turned_s = now_s;
  return idle || away_s <= s->raw.queue_s.si + 1 / o->rate_Hz
             ? DEA_OK
             : dea_fail(ctx, DEA_E_INTERLOCK,
                        "the computer was away for %.3g s, longer than the queue of %g s: it was "
                        "stopped, or is too busy",
                        away_s, s->raw.queue_s.si);
}

/* Takes the samples whose time has come out of the queue. */
static void take_due(struct dea_scpi *s, double now_s)
{
  struct dea_scpi_output *o = &s->output;
  while (o->count > 0 && o->clock_s + (double)o->played / o->rate_Hz <= now_s) {
    o->wanted_V = o->queue[o->first];
    o->first = (o->first + 1) % o->room;
    o->count--;
    o->played++;
  }
  if (o->wanted_V == o->sent_V) {
    o->waiting_s = NAN;
  } else if (isnan(o->waiting_s)) {
    o->waiting_s = now_s;
  }
}

dea_status dea_scpi_output_play(struct dea_context *ctx, struct dea_scpi *s, double *next_s)
{
  const struct dea_scpi_raw *raw = &s->raw;
  struct dea_scpi_output *o = &s->output;
  double now_s = dea_clock_s(), measure_s = o->measured_s + raw->interval_s.si;
  *next_s = INFINITY;
  if (o->queue == NULL || isnan(o->clock_s)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, check_stall(ctx, s, now_s));
  take_due(s, now_s);
  if (raw->watchdog.feed.origin != DEA_ABSENT) {
    if (now_s >= o->fed_s + raw->watchdog.period_s.si) {
      o->fed_s = now_s;
      DEA_TRY(ctx, dea_scpi_send(ctx, &s->link, raw->behind_s.si, raw->watchdog.feed.text));
    }
    *next_s = o->fed_s + raw->watchdog.period_s.si;
  }
  double behind_s = raw->behind_s.si;
  if (s->asked == DEA_SCPI_CONFIRM && now_s > s->asked_s + behind_s) {
    return dea_scpi_no_response(ctx, s, raw->confirm.text, behind_s);
  }
  if (s->asked == DEA_SCPI_MEASURE && now_s > s->asked_s + behind_s) {
    return dea_scpi_no_response(ctx, s, raw->measure.text, behind_s);
  }
  if (!isnan(o->waiting_s) && now_s > o->waiting_s + behind_s + raw->output_interval_s.si) {
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s is more than %g s behind with its voltage", s->name,
                    behind_s);
  }
  *next_s = fmin(*next_s, o->count > 0 ? o->clock_s + (double)o->played / o->rate_Hz : INFINITY);
  if (s->asked != DEA_SCPI_NOTHING) {
    *next_s = fmin(*next_s, s->asked_s + behind_s);
    return DEA_OK;
  }
  if (raw->measure.origin != DEA_ABSENT && now_s >= measure_s) {
    o->measured_s = now_s;
    return ask(ctx, s, DEA_SCPI_MEASURE, raw->measure.text);
  }
  *next_s = fmin(*next_s, raw->measure.origin != DEA_ABSENT ? measure_s : INFINITY);
  if (!isnan(o->waiting_s)) {
    if (now_s >= o->sent_s + raw->output_interval_s.si) {
      return send_voltage(ctx, s, o->wanted_V);
    }
    *next_s = fmin(*next_s, o->sent_s + raw->output_interval_s.si);
  }
  return DEA_OK;
}

/* Plays, and takes the responses that belong to it, until there is something else to do. */
static dea_status serve(struct dea_context *ctx, struct dea_scpi *s, double until_s)
{
  const char *response;
  double next_s;
  DEA_TRY(ctx, dea_scpi_output_play(ctx, s, &next_s));
  double wait_s = fmin(next_s, until_s) - dea_clock_s();
  if (s->asked != DEA_SCPI_CONFIRM && s->asked != DEA_SCPI_MEASURE) {
    dea_clock_wait(wait_s);
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_line_wait(ctx, &s->link, wait_s, &response));
  return response != NULL ? dea_scpi_output_response(ctx, s, response) : DEA_OK;
}

dea_status dea_scpi_output_put(struct dea_context *ctx, struct dea_scpi *s, const double *volts,
                               size_t count)
{
  struct dea_scpi_output *o = &s->output;
  double next_s;
  DEA_TRY(ctx, dea_protocol_guard(ctx, s->protocol, volts, count));
  for (size_t i = 0; i < count; i++) {
    while (o->count == o->room) {
      if (isnan(o->clock_s)) {
        return dea_fail(ctx, DEA_E_ARGUMENT, "more than %zu samples before the start", o->room);
      }
      DEA_TRY(ctx, serve(ctx, s, o->clock_s + (double)o->played / o->rate_Hz));
    }
    o->queue[(o->first + o->count++) % o->room] = volts[i];
  }
  return dea_scpi_output_play(ctx, s, &next_s);
}

dea_status dea_scpi_output_hold(struct dea_context *ctx, struct dea_instrument *instrument,
                                double *volts)
{
  struct dea_scpi *s = (struct dea_scpi *)instrument;
  struct dea_scpi_output *o = &s->output;
  (void)ctx;
  o->first = o->count = 0;
  o->wanted_V = o->sent_V;
  o->waiting_s = NAN;
  o->turned_s = s->asked_s = dea_clock_s(); // a response may wait since then
  o->clock_s = o->turned_s - (double)o->played / o->rate_Hz;
  *volts = o->sent_V;
  return DEA_OK;
}

// Answers ----------------------------------------------------------------------------------------

/* A supply that is where it was asked to be within `behind` measures what was sent since. */
static dea_status check_measured(struct dea_context *ctx, struct dea_scpi *s, double volts)
{
  struct dea_scpi_output *o = &s->output;
  double gain = s->protocol->amplifier.gain.si;
  double error_V = s->protocol->safety.voltage_error_V.si / gain;
  double lowest_V = fmin(o->lowest_V[0], o->lowest_V[1]);
  double highest_V = fmax(o->highest_V[0], o->highest_V[1]);
  bool wrong = volts < lowest_V - error_V || volts > highest_V + error_V;
  o->deviations = wrong ? o->deviations + 1 : 0;
  return o->deviations < DEVIATIONS_MAX
             ? DEA_OK
             : dea_fail(ctx, DEA_E_INSTRUMENT,
                        "%s measures %.4g kV where %.4g kV was set, more than "
                        "safety.voltage_error of %.4g V away",
                        s->name, 1e-3 * gain * volts, 1e-3 * gain * o->sent_V, gain * error_V);
}

dea_status dea_scpi_output_response(struct dea_context *ctx, struct dea_scpi *s,
                                    const char *response)
{
  double value;
  bool confirms = s->asked == DEA_SCPI_CONFIRM;
  s->asked = DEA_SCPI_NOTHING;
  if (confirms && dea_scpi_confirms(&s->raw, response)) {
    return DEA_OK;
  }
  if (!confirms && dea_scpi_number(response, &value) && !isnan(value)) {
    return check_measured(ctx, s, value / s->raw.output_factor.si);
  }
  s->broken = true;
  return dea_fail(ctx, DEA_E_INSTRUMENT, "%s answered '%.60s' to '%.60s', which makes no sense",
                  s->name, response, confirms ? s->raw.confirm.text : s->raw.measure.text);
}
