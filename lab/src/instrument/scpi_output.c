/* The output of a supply that speaks SCPI, timed by the computer's clock. */
#include "instrument/scpi.h"

#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

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
  bool number = dea_scpi_number(response, 0, &value);
  return strcmp(raw->confirm.text, "*OPC?") == 0 ? number && value == 1 : response[0] != '\0';
}

bool dea_scpi_measured(const struct dea_scpi_raw *raw, const struct dea_protocol *protocol,
                       const char *response, double *volts)
{
  double V_of_one = protocol->amplifier.gain.si / raw->output_factor.si, value;
  bool in_V = raw->output_factor.si == 1 || fabs(V_of_one - 1) < 1e-6;
  size_t field = raw->measure_field.origin != DEA_ABSENT ? (size_t)raw->measure_field.si : 0;
  if (!dea_scpi_voltage(response, field, in_V, fabs(V_of_one - 1000) < 1e-3, &value)) {
    return false;
  }
  *volts = value / raw->output_factor.si;
  return true;
}

// What is set ------------------------------------------------------------------------------------

static dea_status request(struct dea_context *ctx, struct dea_scpi *s, enum dea_scpi_question what,
                          const char *question)
{
  s->asked = what;
  s->asked_s = dea_clock_s();
  dea_status status = dea_scpi_question(ctx, &s->link, s->raw.behind_s.si, question);
  s->output.turned_s = dea_clock_s(); // a supply that takes nothing is no stall of the computer
  return status;
}

static dea_status send_voltage(struct dea_context *ctx, struct dea_scpi *s, double volts)
{
  char command[DEA_SCPI_COMMAND_SIZE];
  DEA_TRY(ctx, dea_protocol_guard(ctx, s->protocol, &volts, 1));
  dea_scpi_output_command(&s->raw, volts, command);
  dea_timed_sent(&s->output, volts, dea_clock_s());
  s->base.doubt = dea_evidence_doubt(&s->output.evidence);
  DEA_TRY(ctx, dea_scpi_send(ctx, &s->link, s->raw.behind_s.si, command));
  return request(ctx, s, DEA_SCPI_CONFIRM, s->raw.confirm.text);
}

static dea_status no_sense(struct dea_context *ctx, const struct dea_scpi *s, const char *question,
                           const char *response)
{
  double value;
  bool several = dea_scpi_number(response, 1, &value) && dea_scpi_fields(response) > 1;
  return dea_fail(ctx, DEA_E_INSTRUMENT, "%s answered '%.60s' to '%.60s', which %s", s->name,
                  response, question,
                  several ? "are several numbers: say which of them by measure_field"
                          : "makes no sense");
}

dea_status dea_scpi_output_begin(struct dea_context *ctx, struct dea_scpi *s)
{
  const struct dea_scpi_raw *raw = &s->raw;
  s->output.rate_Hz = s->protocol->rate_Hz.si;
  s->output.queue_s = raw->queue_s.si;
  s->output.behind_s = raw->behind_s.si;
  s->output.output_interval_s = raw->output_interval_s.si;
  s->output.measure_interval_s =
      raw->measure.origin != DEA_ABSENT ? raw->interval_s.si : (double)INFINITY;
  dea_timed_limits(&s->output, s->protocol);
  return dea_timed_begin(ctx, &s->output);
}

dea_status dea_scpi_output_open(struct dea_context *ctx, struct dea_scpi *s)
{
  const char *response;
  double timeout_s = s->raw.timeout_s.si, volts;
  char command[DEA_SCPI_COMMAND_SIZE];
  dea_scpi_output_command(&s->raw, 0, command);
  DEA_TRY(ctx, dea_scpi_send(ctx, &s->link, timeout_s, command));
  DEA_TRY(ctx, dea_scpi_query(ctx, &s->link, timeout_s, s->raw.confirm.text, &response));
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
  DEA_TRY(ctx, dea_scpi_query(ctx, &s->link, timeout_s, s->raw.measure.text, &response));
  if (response == NULL) {
    return dea_scpi_no_response(ctx, s, s->raw.measure.text, timeout_s);
  }
  if (!dea_scpi_measured(&s->raw, s->protocol, response, &volts)) {
    return no_sense(ctx, s, s->raw.measure.text, response);
  }
  volts *= s->protocol->amplifier.gain.si;
  return fabs(volts) <= s->protocol->safety.at_zero_V.si
             ? DEA_OK
             : dea_fail(ctx, DEA_E_INTERLOCK,
                        "%s measures %.4g V at its output before anything is played; look at what "
                        "is connected to it",
                        s->name, volts);
}

dea_status dea_scpi_output_start(struct dea_context *ctx, struct dea_scpi *s)
{
  dea_timed_start(&s->output, s->start_s);
  s->fed_s = s->start_s;
  return s->raw.watchdog.arm.origin != DEA_ABSENT
             ? dea_scpi_send(ctx, &s->link, s->raw.behind_s.si, s->raw.watchdog.arm.text)
             : DEA_OK;
}

// The queue --------------------------------------------------------------------------------------

/* Feeds the watchdog when that is due; *next_s: when it will be. */
static dea_status feed(struct dea_context *ctx, struct dea_scpi *s, double now_s, double *next_s)
{
  const struct dea_scpi_raw *raw = &s->raw;
  *next_s = INFINITY;
  if (raw->watchdog.feed.origin == DEA_ABSENT) {
    return DEA_OK;
  }
  if (now_s >= s->fed_s + raw->watchdog.period_s.si) {
    s->fed_s = now_s;
    DEA_TRY(ctx, dea_scpi_send(ctx, &s->link, raw->behind_s.si, raw->watchdog.feed.text));
  }
  *next_s = s->fed_s + raw->watchdog.period_s.si;
  return DEA_OK;
}

/* From when on the open question is late; readings have a time of their own. */
static double late_at(const struct dea_scpi *s)
{
  double wait_s = s->asked == DEA_SCPI_READING ? (double)INFINITY : s->raw.behind_s.si;
  return s->asked == DEA_SCPI_NOTHING ? (double)NAN : s->asked_s + wait_s;
}

dea_status dea_scpi_output_play(struct dea_context *ctx, struct dea_scpi *s, double *next_s)
{
  const struct dea_scpi_raw *raw = &s->raw;
  struct dea_timed_output *o = &s->output;
  double now_s = dea_clock_s(), feed_s;
  bool confirms = s->asked == DEA_SCPI_CONFIRM;
  *next_s = INFINITY;
  if (!dea_timed_plays(o)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_timed_read(ctx, o, now_s));
  DEA_TRY(ctx, feed(ctx, s, now_s, &feed_s));
  enum dea_timed_action action = dea_timed_next(o, now_s, late_at(s), next_s);
  *next_s = fmin(*next_s, feed_s);
  switch (action) {
  case DEA_TIMED_LATE:
    return dea_scpi_no_response(ctx, s, confirms ? raw->confirm.text : raw->measure.text,
                                raw->behind_s.si);
  case DEA_TIMED_BEHIND:
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s is more than %g s behind with its voltage", s->name,
                    raw->behind_s.si);
  case DEA_TIMED_MEASURE:
    return request(ctx, s, DEA_SCPI_MEASURE, raw->measure.text);
  case DEA_TIMED_SEND:
    return send_voltage(ctx, s, o->wanted_V);
  case DEA_TIMED_NOTHING:
    break;
  }
  return DEA_OK;
}

/* Plays, and takes the responses that belong to it, until there is something else to do. */
static dea_status serve(struct dea_context *ctx, void *supply, double until_s)
{
  struct dea_scpi *s = supply;
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

dea_status dea_scpi_output_set(struct dea_context *ctx, struct dea_scpi *s, const double *volts,
                               size_t count)
{
  double next_s;
  DEA_TRY(ctx, dea_protocol_guard(ctx, s->protocol, volts, count));
  DEA_TRY(ctx, dea_timed_write(ctx, &s->output, volts, count, serve, s));
  return dea_scpi_output_play(ctx, s, &next_s);
}

dea_status dea_scpi_output_hold(struct dea_context *ctx, struct dea_instrument *instrument,
                                double *volts)
{
  struct dea_scpi *s = (struct dea_scpi *)instrument;
  (void)ctx;
  s->asked_s = dea_clock_s(); // a response may wait since then
  *volts = dea_timed_hold(&s->output, s->asked_s);
  return DEA_OK;
}

// Answers ----------------------------------------------------------------------------------------

dea_status dea_scpi_output_response(struct dea_context *ctx, struct dea_scpi *s,
                                    const char *response)
{
  double volts;
  bool confirms = s->asked == DEA_SCPI_CONFIRM;
  s->asked = DEA_SCPI_NOTHING;
  if (confirms && dea_scpi_confirms(&s->raw, response)) {
    return DEA_OK;
  }
  if (!confirms && dea_scpi_measured(&s->raw, s->protocol, response, &volts)) {
    dea_status status = dea_timed_measured(ctx, &s->output, s->protocol, s->name, volts);
    s->base.doubt = dea_evidence_doubt(&s->output.evidence);
    return status;
  }
  s->broken = true;
  return no_sense(ctx, s, confirms ? s->raw.confirm.text : s->raw.measure.text, response);
}
