#include "instrument/line_supply.h"

#include "base/clock.h"
#include "base/schema_value.h"
#include "instrument/serial.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double again_s = 0.3; // between two questions to one that may be beginning anew
static const double rounding_V = 1e-6;

// Lines ------------------------------------------------------------------------------------------

dea_status dea_line_supply_wait(struct dea_context *ctx, struct dea_line_link *link, double until_s,
                                const char **line)
{
  *line = NULL;
  for (double left_s = until_s - dea_clock_s(); left_s > 0 && *line == NULL;
       left_s = until_s - dea_clock_s()) {
    char byte;
    const char *at = &byte;
    size_t length;
    DEA_TRY(ctx, dea_socket_read(ctx, &link->socket, left_s, &byte, 1, &length));
    *line = dea_line_next(&link->lines, &at, &length);
    if (dea_interrupted(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted");
    }
  }
  return DEA_OK;
}

dea_status dea_line_supply_send(struct dea_context *ctx, const struct dea_line_link *link,
                                double timeout_s, const char *command)
{
  char line[DEA_LINE_SUPPLY_COMMAND_SIZE + 1];
  int length = snprintf(line, sizeof line, "%.*s\r", DEA_LINE_SUPPLY_COMMAND_SIZE - 1, command);
  return dea_socket_write(ctx, &link->socket, timeout_s, line, (size_t)length);
}

static dea_status no_answer(struct dea_context *ctx, struct dea_line_supply *s, const char *command)
{
  return dea_fail(ctx, DEA_E_INSTRUMENT, "%s did not answer '%s' within %g s", s->link.socket.name,
                  command, s->raw.behind_s.si);
}

static dea_status no_sense(struct dea_context *ctx, struct dea_line_supply *s, const char *command,
                           const char *answer)
{
  return dea_fail(ctx, DEA_E_INSTRUMENT, "%s answered '%.40s' to '%s', which %s",
                  s->link.socket.name, answer, command,
                  s->language->is_error(answer) ? "is an error" : "makes no sense");
}

dea_status dea_line_supply_query(struct dea_context *ctx, struct dea_line_supply *s,
                                 const char *command, const char **answer)
{
  const char *line;
  DEA_TRY(ctx, dea_line_supply_send(ctx, &s->link, s->raw.behind_s.si, command));
  DEA_TRY(ctx, dea_line_supply_wait(ctx, &s->link, dea_clock_s() + s->raw.behind_s.si, &line));
  if (line == NULL) {
    return no_answer(ctx, s, command);
  }
  if (s->language->is_error(line)) {
    return no_sense(ctx, s, command, line);
  }
  if (answer != NULL) {
    *answer = line;
  }
  return DEA_OK;
}

static void set_command(const struct dea_line_supply *s, long volts,
                        char out[DEA_LINE_SUPPLY_COMMAND_SIZE])
{
  snprintf(out, DEA_LINE_SUPPLY_COMMAND_SIZE, "%s%ld", s->language->set, volts);
}

// Opening ----------------------------------------------------------------------------------------

dea_status dea_line_supply_check(const struct dea_reader *reader, const void *data,
                                 const struct dea_protocol *protocol)
{
  const struct dea_line_supply_raw *raw = data;
  const struct dea_instrument sketch = {0};
  if (protocol->amplifier.lowest_V.si < 0) {
    DEA_TRY(reader->ctx,
            dea_schema_error(reader, raw->kind.location,
                             "this supply gives one sign only: write 'min_voltage: 0 V' in the "
                             "protocol's amplifier"));
  }
  DEA_TRY(reader->ctx, dea_timed_check(reader->ctx, &raw->behind_s, protocol));
  return raw->channel.origin != DEA_ABSENT
             ? dea_instrument_check_reading(reader, protocol, &raw->channel, &sketch)
             : DEA_OK;
}

/* Asks until it answers: one that is opened may begin anew, and says other things then. */
static dea_status wake(struct dea_context *ctx, struct dea_line_supply *s)
{
  const char *sync = s->language->sync, *line;
  double until_s = dea_clock_s() + s->raw.timeout_s.si;
  for (double now_s = dea_clock_s(); now_s < until_s; now_s = dea_clock_s()) {
    DEA_TRY(ctx, dea_line_supply_send(ctx, &s->link, s->raw.behind_s.si, sync));
    double ask_s = fmin(now_s + fmax(again_s, s->raw.behind_s.si), until_s);
    do {
      DEA_TRY(ctx, dea_line_supply_wait(ctx, &s->link, ask_s, &line));
      if (line != NULL && s->language->is_synced(line)) {
        return DEA_OK;
      }
    } while (line != NULL);
  }
  return dea_fail(ctx, DEA_E_INSTRUMENT,
                  "%s does not answer '%s'; look at its power, its cable, and whether it is that "
                  "kind of supply",
                  s->link.socket.name, sync);
}

/* Whether the sequence stays within what it gives, and what is called 0 V is little of that: the
 * protocol may name an amplifier that gives more. */
static dea_status check_range(struct dea_context *ctx, const struct dea_line_supply *s)
{
  double highest_V = 0, zero_V = s->protocol->safety.at_zero_V.si;
  if (zero_V > dea_zero_most_V(s->range_V)) {
    return dea_fail(ctx, DEA_E_INSTRUMENT,
                    "safety.at_zero calls %g V 0 V, and of the %g kV that %s says it gives at most "
                    "%g V may be",
                    zero_V, 1e-3 * s->range_V, s->link.socket.name, dea_zero_most_V(s->range_V));
  }
  for (size_t i = 0; i < s->protocol->step_count; i++) {
    highest_V = fmax(highest_V, s->protocol->steps[i].highest_V);
  }
  return highest_V <= s->range_V
             ? DEA_OK
             : dea_fail(ctx, DEA_E_INSTRUMENT,
                        "the sequence goes to %g kV, and %s says that it gives %g kV at most",
                        1e-3 * highest_V, s->link.socket.name, 1e-3 * s->range_V);
}

static dea_status set_up(struct dea_context *ctx, struct dea_line_supply *s)
{
  char command[DEA_LINE_SUPPLY_COMMAND_SIZE];
  const char *answer = "";
  double volts;
  DEA_TRY(ctx, wake(ctx, s));
  set_command(s, 0, command);
  DEA_TRY(ctx, dea_line_supply_query(ctx, s, command, &answer));
  if (!s->language->is_set(answer, 0)) {
    return no_sense(ctx, s, command, answer);
  }
  DEA_TRY(ctx, dea_line_supply_query(ctx, s, s->language->measure, &answer));
  if (!s->language->voltage(answer, &volts)) {
    return no_sense(ctx, s, s->language->measure, answer);
  }
  if (!(fabs(volts) <= s->protocol->safety.at_zero_V.si)) {
    return dea_fail(ctx, DEA_E_INTERLOCK,
                    "%s measures %.4g V at its output before anything is played; look at what is "
                    "connected to it",
                    s->link.socket.name, volts);
  }
  DEA_TRY(ctx, s->language->prepare(ctx, s));
  if (s->language->mark == NULL) {
    dea_serial_mark(&s->link.socket, s->base.mark, sizeof s->base.mark);
  }
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                               "%s gives up to %g V and plays by the computer's clock, at most "
                               "%.3g voltages a second",
                               s->link.socket.name, s->range_V, 1 / s->raw.output_interval_s.si));
  return check_range(ctx, s);
}

dea_status dea_line_supply_open(struct dea_context *ctx, const struct dea_instrument_type *type,
                                const struct dea_line_supply_language *language, const void *raw,
                                const struct dea_protocol *protocol, struct dea_instrument **out)
{
  static const struct dea_choice voltage = {.value = DEA_CHANNEL_VOLTAGE};
  static const struct dea_label no_unit;
  struct dea_line_supply *s = dea_alloc(ctx, 1, sizeof *s);
  DEA_TRY_MEMORY(s != NULL);
  s->raw = *(const struct dea_line_supply_raw *)raw;
  s->raw_all = raw;
  s->language = language;
  s->protocol = protocol;
  s->base.type = type;
  s->base.roles = DEA_PLAYS_OUTPUT;
  if (s->raw.channel.origin != DEA_ABSENT) {
    s->base.roles |= DEA_GIVES_READINGS;
    dea_instrument_add_reading(&s->base, &s->raw.channel, &voltage, &no_unit);
  }
  s->output = (struct dea_timed_output){.rate_Hz = protocol->rate_Hz.si,
                                        .queue_s = s->raw.queue_s.si,
                                        .behind_s = s->raw.behind_s.si,
                                        .output_interval_s = s->raw.output_interval_s.si,
                                        .measure_interval_s = s->raw.interval_s.si};
  dea_timed_limits(&s->output, protocol);
  s->link.socket.descriptor = -1;
  dea_status status = dea_timed_begin(ctx, &s->output);
  if (status == DEA_OK) {
    status = dea_serial_open(ctx, language->what, s->raw.device.text, (int)s->raw.baud.si, 0,
                             &s->link.socket);
  }
  status = status == DEA_OK ? set_up(ctx, s) : status;
  if (status != DEA_OK) {
    status =
        s->link.socket.descriptor >= 0 ? dea_instrument_abandon(ctx, &s->base, status) : status;
    dea_line_supply_close(ctx, &s->base);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  s->raw_all = NULL;
  *out = &s->base;
  return DEA_OK;
}

void dea_line_supply_close(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct dea_line_supply *s = (struct dea_line_supply *)instrument;
  dea_socket_close(&s->link.socket);
  dea_timed_end(ctx, &s->output);
  dea_free(ctx, s);
}

void dea_line_supply_address(const void *data, char *out, size_t size)
{
  const struct dea_line_supply_raw *raw = data;
  snprintf(out, size, "%s", raw->device.text);
}

dea_status dea_line_supply_start(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct dea_line_supply *s = (struct dea_line_supply *)instrument;
  (void)ctx;
  s->start_s = dea_clock_s();
  dea_timed_start(&s->output, s->start_s);
  return DEA_OK;
}

// Playing ----------------------------------------------------------------------------------------

static dea_status query(struct dea_context *ctx, struct dea_line_supply *s,
                        enum dea_line_supply_question what, const char *command)
{
  s->asked = what;
  s->asked_s = dea_clock_s();
  dea_status status = dea_line_supply_send(ctx, &s->link, s->raw.behind_s.si, command);
  s->output.turned_s = dea_clock_s(); // a supply that takes nothing is no stall of the computer
  return status;
}

/* Towards 0 V to whole volts, so that no limit is passed by rounding. */
static dea_status send_voltage(struct dea_context *ctx, struct dea_line_supply *s, double volts)
{
  char command[DEA_LINE_SUPPLY_COMMAND_SIZE];
  double output_V = volts * s->protocol->amplifier.gain.si;
  DEA_TRY(ctx, dea_protocol_guard(ctx, s->protocol, &volts, 1));
  if (!(output_V >= -rounding_V && output_V <= s->range_V + rounding_V)) {
    return dea_fail(ctx, DEA_E_INTERLOCK,
                    "%g V were about to go out, where %s gives 0 V to %g V: it was held back",
                    output_V, s->link.socket.name, s->range_V);
  }
  s->set_V = (long)(output_V + rounding_V);
  dea_timed_sent(&s->output, volts, dea_clock_s());
  s->base.doubt = dea_evidence_doubt(&s->output.evidence);
  set_command(s, s->set_V, command);
  return query(ctx, s, DEA_LINE_SUPPLY_SET, command);
}

static const char *asked_command(const struct dea_line_supply *s,
                                 char out[DEA_LINE_SUPPLY_COMMAND_SIZE])
{
  if (s->asked == DEA_LINE_SUPPLY_SET) {
    set_command(s, s->set_V, out);
    return out;
  }
  return s->asked == DEA_LINE_SUPPLY_MARK ? s->language->mark : s->language->measure;
}

/* The voltage and the mark take turns, but for a voltage that has yet to be seen away from 0 V. */
static dea_status query_back(struct dea_context *ctx, struct dea_line_supply *s)
{
  bool wanted = s->output.sent_V != 0 && dea_evidence_wants(&s->output.evidence);
  bool mark = s->language->mark != NULL && s->last == DEA_LINE_SUPPLY_MEASURE && !wanted;
  s->last = mark ? DEA_LINE_SUPPLY_MARK : DEA_LINE_SUPPLY_MEASURE;
  return query(ctx, s, s->last, mark ? s->language->mark : s->language->measure);
}

static dea_status play(struct dea_context *ctx, struct dea_line_supply *s, double *next_s)
{
  struct dea_timed_output *o = &s->output;
  char command[DEA_LINE_SUPPLY_COMMAND_SIZE];
  double now_s = dea_clock_s();
  bool open = s->asked != DEA_LINE_SUPPLY_NOTHING;
  *next_s = INFINITY;
  if (!dea_timed_plays(o)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_timed_read(ctx, o, now_s));
  switch (dea_timed_next(o, now_s, open ? s->asked_s + s->raw.behind_s.si : (double)NAN, next_s)) {
  case DEA_TIMED_LATE:
    return no_answer(ctx, s, asked_command(s, command));
  case DEA_TIMED_BEHIND:
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s is more than %g s behind with its voltage",
                    s->link.socket.name, s->raw.behind_s.si);
  case DEA_TIMED_MEASURE:
    return query_back(ctx, s);
  case DEA_TIMED_SEND:
    return send_voltage(ctx, s, o->wanted_V);
  case DEA_TIMED_NOTHING:
    break;
  }
  return DEA_OK;
}

static dea_status read_voltage(struct dea_context *ctx, struct dea_line_supply *s, double volts)
{
  if (s->pending_count < DEA_LINE_SUPPLY_PENDING && s->base.reading_count > 0) {
    s->pending[s->pending_count].time_s = 0.5 * (s->asked_s + dea_clock_s()) - s->start_s;
    s->pending[s->pending_count++].volts = volts;
  }
  dea_status status = dea_timed_measured(ctx, &s->output, s->protocol, s->link.socket.name,
                                         volts / s->protocol->amplifier.gain.si);
  s->base.doubt = dea_evidence_doubt(&s->output.evidence);
  return status;
}

static dea_status parse_answer(struct dea_context *ctx, struct dea_line_supply *s,
                               const char *answer)
{
  char command[DEA_LINE_SUPPLY_COMMAND_SIZE];
  double volts;
  enum dea_line_supply_question asked = s->asked;
  if (asked == DEA_LINE_SUPPLY_NOTHING) {
    return dea_fail(ctx, DEA_E_INSTRUMENT,
                    "%s said '%.40s' without being asked: has it begun anew?", s->link.socket.name,
                    answer);
  }
  bool good = !s->language->is_error(answer);
  bool measured = good && asked == DEA_LINE_SUPPLY_MEASURE && s->language->voltage(answer, &volts);
  if ((asked == DEA_LINE_SUPPLY_SET && !s->language->is_set(answer, s->set_V)) || !good ||
      (asked == DEA_LINE_SUPPLY_MEASURE && !measured)) {
    return no_sense(ctx, s, asked_command(s, command), answer);
  }
  s->asked = DEA_LINE_SUPPLY_NOTHING;
  if (asked == DEA_LINE_SUPPLY_MARK && strcmp(answer, s->base.mark) != 0) {
    return dea_fail(ctx, DEA_E_INSTRUMENT,
                    "%s answered '%.40s' to '%s' where it was set to '%s': it has begun anew",
                    s->link.socket.name, answer, s->language->mark, s->base.mark);
  }
  return measured ? read_voltage(ctx, s, volts) : DEA_OK;
}

/* Plays until then, or until an answer has come. */
static dea_status serve(struct dea_context *ctx, void *supply, double until_s)
{
  struct dea_line_supply *s = supply;
  const char *answer;
  size_t dropped = s->link.lines.dropped;
  double next_s;
  DEA_TRY(ctx, play(ctx, s, &next_s));
  DEA_TRY(ctx, dea_line_supply_wait(ctx, &s->link, fmin(next_s, until_s), &answer));
  if (s->link.lines.dropped > dropped) {
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s says what makes no sense", s->link.socket.name);
  }
  return answer != NULL ? parse_answer(ctx, s, answer) : DEA_OK;
}

dea_status dea_line_supply_set(struct dea_context *ctx, struct dea_instrument *instrument,
                               const double *volts, size_t count)
{
  struct dea_line_supply *s = (struct dea_line_supply *)instrument;
  double next_s;
  DEA_TRY(ctx, dea_protocol_guard(ctx, s->protocol, volts, count));
  DEA_TRY(ctx, dea_timed_write(ctx, &s->output, volts, count, serve, s));
  return play(ctx, s, &next_s);
}

dea_status dea_line_supply_get(struct dea_context *ctx, struct dea_instrument *instrument,
                               double timeout_s, const struct dea_sink *sink)
{
  struct dea_line_supply *s = (struct dea_line_supply *)instrument;
  double until_s = dea_clock_s() + timeout_s;
  do {
    DEA_TRY(ctx, serve(ctx, s, until_s));
  } while (s->pending_count == 0 && dea_clock_s() < until_s);
  for (size_t i = 0; i < s->pending_count; i++) {
    DEA_TRY(ctx, sink->reading(sink->user, 0, s->pending[i].time_s, s->pending[i].volts));
  }
  s->pending_count = 0;
  return DEA_OK;
}

dea_status dea_line_supply_hold(struct dea_context *ctx, struct dea_instrument *instrument,
                                double *volts)
{
  struct dea_line_supply *s = (struct dea_line_supply *)instrument;
  (void)ctx;
  s->asked_s = dea_clock_s(); // an answer may wait since then
  *volts = dea_timed_hold(&s->output, s->asked_s);
  return DEA_OK;
}
