#define _POSIX_C_SOURCE 200809L // close
/* Instrument "scpi": what speaks SCPI on a TCP port, such as an electrometer, a force display or
 * a laboratory supply. Its readings are queries, asked one after the other at their interval; its
 * output is a command with a number in it, sent by the computer's clock. */
#include "base/clock.h"
#include "base/schema_value.h"
#include "base/units.h"
#include "instrument/instrument_make.h"
#include "instrument/line_link.h"
#include "instrument/poll_schedule.h"
#include "instrument/scpi_parse.h"
#include "instrument/timed_output.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { COMMANDS_MAX = 16, COMMAND_SIZE = DEA_TITLE_SIZE + 40 };

struct raw_reading {
  struct dea_label name, query, unit;
  struct dea_choice quantity;
  struct dea_quantity factor, offset, field;
};

struct raw {
  struct dea_label kind, address, identity;
  struct dea_quantity port, timeout_s, interval_s;
  struct dea_label setup[COMMANDS_MAX], at_stop[COMMANDS_MAX];
  size_t setup_count, at_stop_count;
  struct raw_reading readings[DEA_INSTRUMENT_READINGS_MAX];
  size_t reading_count;
  // of the output
  struct dea_label output, output_off, is_off, confirm, measure;
  struct dea_quantity output_factor, output_interval_s, queue_s, behind_s, measure_field;
  struct {
    struct dea_label arm, feed, disarm;
    struct dea_quantity period_s;
  } watchdog;
};

enum question { NOTHING, READING, CONFIRM, MEASURE };

struct scpi {
  struct dea_instrument base;
  struct raw raw;
  const struct dea_protocol *protocol; // lent
  struct dea_line_link link;
  char name[DEA_SOCKET_NAME_SIZE + 8];
  struct dea_poll_schedule schedule; // of the readings
  /* What stood behind the first number of each; valid when `known`. */
  char suffix[DEA_INSTRUMENT_READINGS_MAX][DEA_SCPI_SUFFIX_SIZE];
  bool known[DEA_INSTRUMENT_READINGS_MAX], noted_suffix;
  enum question asked; // what is waited for
  double asked_s;
  bool broken; // a response made no sense: which question the next one belongs to is not known
  struct dea_timed_output output;
  double fed_s; // when the watchdog was fed last
  int claim;    // of what it plays through; -1: none
};

static const struct dea_field reading_fields[] = {
    DEA_INSTRUMENT_LABEL(struct raw_reading, name, "name", "name of its channel", "leakage",
                         .required = true),
    DEA_INSTRUMENT_LABEL(struct raw_reading, query, "query",
                         "question that it answers with a number", "MEAS:CURR?", .required = true),
    DEA_INSTRUMENT_QUANTITY(struct raw_reading, quantity),
    DEA_INSTRUMENT_NUMBER(struct raw_reading, field, "field",
                          "which number of an answer that has several, from 1 on", 1, 99, "2",
                          .absent_text = "it answers with one"),
    DEA_NUMBER_ROW("factor", offsetof(struct raw_reading, factor), "1", "1e-3",
                   "SI value of 1 of what it answers; 1e-3 where it answers in mN without saying "
                   "so. A unit that it does say is converted without this key",
                   .absent_text = "1, or the unit of the answer"),
    DEA_NUMBER_ROW("offset", offsetof(struct raw_reading, offset), "1", "0",
                   "added to it afterwards, in SI", .default_text = "0"),
    DEA_INSTRUMENT_LABEL(struct raw_reading, unit, "unit", "SI unit of an 'other' quantity", "K",
                         .absent_text = "none"),
};
static const struct dea_record reading_record = {
    "reading", "a value that is asked for", reading_fields, DEA_INSTRUMENT_COUNT(reading_fields)};

static const struct dea_field watchdog_fields[] = {
    DEA_INSTRUMENT_LABEL(struct raw, watchdog.arm, "arm", "command that arms it, sent at the start",
                         "OUTP:WDOG 2", .absent_text = "none"),
    DEA_INSTRUMENT_LABEL(struct raw, watchdog.feed, "feed", "command that feeds it",
                         "OUTP:WDOG:FEED", .absent_text = "none"),
    DEA_INSTRUMENT_LABEL(struct raw, watchdog.disarm, "disarm",
                         "command that disarms it, sent once the output is at 0 V", "OUTP:WDOG:OFF",
                         .absent_text = "none"),
    DEA_INSTRUMENT_TIME(struct raw, watchdog.period_s, "period", "between two feeds", "0.5 s", 60),
};
static const struct dea_record watchdog_record = {"watchdog", "commands of a supply's own watchdog",
                                                  watchdog_fields,
                                                  DEA_INSTRUMENT_COUNT(watchdog_fields)};

static const struct dea_field fields[] = {
    DEA_INSTRUMENT_KIND(struct raw, "scpi"),
    DEA_INSTRUMENT_LABEL(struct raw, address, "address", "its name or address in the network",
                         "192.168.1.20", .required = true),
    DEA_INSTRUMENT_PORT(struct raw, port, "port", "its TCP port", .default_text = "5025"),
    DEA_INSTRUMENT_LABEL(struct raw, identity, "identity",
                         "what its answer to *IDN? must contain, against mix-ups", "6517B",
                         .absent_text = "not compared"),
    DEA_INSTRUMENT_TIME(struct raw, timeout_s, "timeout", "longest wait for an answer", "2 s", 60),
    DEA_INSTRUMENT_TIME(struct raw, interval_s, "interval", "between two rounds of readings",
                        "0.5 s", 3600),
    {.key = "setup",
     .kind = DEA_FIELD_LABEL,
     DEA_INSTRUMENT_LIST_OF(struct raw, setup, setup_count, COMMANDS_MAX),
     .doc = "commands sent at first; then its error queue is looked at",
     .example = "[\"*RST\", \"FUNC 'CURR'\"]"},
    {.key = "at_stop",
     .kind = DEA_FIELD_LABEL,
     DEA_INSTRUMENT_LIST_OF(struct raw, at_stop, at_stop_count, COMMANDS_MAX),
     .doc = "commands sent at the end, also after a failure",
     .example = "[\"OUTP OFF\"]"},
    {.key = "readings",
     .kind = DEA_FIELD_RECORD,
     .record = &reading_record,
     DEA_INSTRUMENT_LIST_OF(struct raw, readings, reading_count, DEA_INSTRUMENT_READINGS_MAX),
     .doc = "what it is asked for",
     .example = "[{name: leakage, query: \"MEAS:CURR?\", quantity: current}]"},
    DEA_INSTRUMENT_LABEL(struct raw, output, "output",
                         "command that sets the control voltage, with %g for the number; timed by "
                         "software",
                         "SOUR:VOLT %g", .absent_text = "it plays nothing"),
    DEA_NUMBER_ROW(
        "output_factor", offsetof(struct raw, output_factor), "1", "1000",
        "what is sent for 1 V of control voltage; of a high-voltage supply that is set in V, the "
        "amplifier's gain",
        .default_text = "1"),
    DEA_INSTRUMENT_TIME(struct raw, output_interval_s, "output_interval",
                        "shortest time between two commands of the output", "20 ms", 60),
    DEA_INSTRUMENT_TIME(struct raw, queue_s, "queue",
                        "of the output that is held ready; a computer that is away for longer ends "
                        "the measurement",
                        "0.25 s", 5),
    DEA_INSTRUMENT_LABEL(struct raw, output_off, "output_off",
                         "command that switches its output off, before it is set to 0 V at the end",
                         "OUTP OFF", .absent_text = "it is only set to 0 V"),
    DEA_INSTRUMENT_LABEL(
        struct raw, is_off, "is_off",
        "question that it answers with 0 or OFF once its output is off; without it "
        "a supply that confirms what it has yet to do may be believed",
        "OUTP?", .absent_text = "it is not asked"),
    DEA_INSTRUMENT_LABEL(struct raw, confirm, "confirm",
                         "question sent behind each voltage; no other is sent before its answer",
                         "*OPC?", .default_text = "*OPC?"),
    DEA_INSTRUMENT_LABEL(
        struct raw, measure, "measure",
        "question that it answers with the voltage measured at its output, in what "
        "it is set in",
        "MEAS:VOLT?", .absent_text = "its output is not read back"),
    DEA_INSTRUMENT_NUMBER(struct raw, measure_field, "measure_field",
                          "which number of that answer is the voltage, from 1 on", 1, 99, "1",
                          .absent_text = "it answers with one"),
    DEA_INSTRUMENT_TIME(struct raw, behind_s, "behind",
                        "longest time that a voltage may take to be confirmed; longer ends the "
                        "measurement",
                        "0.5 s", 5),
    DEA_FIELD_ROW(RECORD, "watchdog", 0, .record = &watchdog_record,
                  .doc = "its own watchdog, which switches it off when the computer is silent"),
};
const struct dea_record dea_instrument_scpi_record = {
    "scpi", "answers or plays by SCPI on a TCP port", fields, DEA_INSTRUMENT_COUNT(fields)};

/* A voltage that a command sets by itself has passed no check. Of one that plays nothing it is that
 * of a source, which may be the supply by another name. */
static dea_status check_command(const struct dea_reader *reader, const struct raw *raw,
                                const struct dea_label *command)
{
  bool plays = raw->output.origin != DEA_ABSENT;
  if (!dea_scpi_is_one_line(command->text)) {
    return dea_schema_error(reader, command->location,
                            "refused: one command is one line, and this one has a line's end or "
                            "another control character in it");
  }
  if (!dea_scpi_sets_output(command->text, plays ? raw->output.text : "SOUR:VOLT %g") ||
      (!plays && dea_scpi_configures(command->text))) {
    return DEA_OK;
  }
  return dea_schema_error(reader, command->location,
                          plays ? "refused: '%.60s' sets the output, which only the sequence may do"
                                : "refused: '%.60s' sets a voltage, and this instrument has no "
                                  "'output': only a sequence may",
                          command->text);
}

static dea_status check_commands(const struct dea_reader *reader, const struct raw *raw)
{
  const struct dea_label *single[] = {&raw->output_off,    &raw->confirm,
                                      &raw->measure,       &raw->watchdog.arm,
                                      &raw->watchdog.feed, &raw->watchdog.disarm};
  for (size_t i = 0; i < sizeof single / sizeof single[0]; i++) {
    DEA_TRY(reader->ctx, check_command(reader, raw, single[i]));
  }
  for (size_t i = 0; i < raw->setup_count; i++) {
    DEA_TRY(reader->ctx, check_command(reader, raw, &raw->setup[i]));
  }
  for (size_t i = 0; i < raw->at_stop_count; i++) {
    DEA_TRY(reader->ctx, check_command(reader, raw, &raw->at_stop[i]));
  }
  for (size_t i = 0; i < raw->reading_count; i++) {
    DEA_TRY(reader->ctx, check_command(reader, raw, &raw->readings[i].query));
  }
  return DEA_OK;
}

static dea_status check(const struct dea_reader *reader, const void *data,
                        const struct dea_protocol *protocol)
{
  const struct raw *raw = data;
  struct dea_instrument sketch = {0};
  for (size_t i = 0; i < raw->reading_count; i++) {
    const struct raw_reading *r = &raw->readings[i];
    DEA_TRY(reader->ctx, dea_instrument_check_reading(reader, protocol, &r->name, &sketch));
    dea_instrument_add_reading(&sketch, &r->name, &r->quantity, &r->unit);
  }
  bool plays = raw->output.origin != DEA_ABSENT;
  if (plays && !dea_scpi_output_is_plain(raw->output.text)) {
    return dea_schema_error(reader, raw->output.location,
                            "the output's command must have one %%g where the number goes, alone "
                            "between blanks or commas, and no second command; write for example "
                            "'SOUR:VOLT %%g'");
  }
  DEA_TRY(reader->ctx, check_commands(reader, raw));
  if (!plays && raw->reading_count == 0) {
    return dea_schema_error(reader, raw->kind.location,
                            "it neither reads nor plays: write 'readings' or 'output'");
  }
  if (plays && !dea_protocol_factor_is_known(protocol, raw->output_factor.si)) {
    return dea_schema_error(reader, raw->output_factor.location,
                            "refused: output_factor is 1 where the control voltage is sent in V, "
                            "and %g or %g (by the amplifier's gain) where its output is sent in V "
                            "or in kV, not %g",
                            protocol->amplifier.gain.si, 1e-3 * protocol->amplifier.gain.si,
                            raw->output_factor.si);
  }
  return plays && raw->measure.origin != DEA_ABSENT
             ? dea_timed_check(reader->ctx, &raw->behind_s, protocol)
             : DEA_OK;
}

// Lines to and from it ---------------------------------------------------------------------------

/* host: its number; "": by its name. */
static dea_status connect_to(struct dea_context *ctx, const struct raw *raw, const char *host,
                             double timeout_s, struct dea_line_link *link)
{
  *link = (struct dea_line_link){.socket.descriptor = -1};
  return dea_socket_connect(ctx, "the instrument", host[0] != '\0' ? host : raw->address.text,
                            (int)raw->port.si, timeout_s, &link->socket);
}

static dea_status send_line(struct dea_context *ctx, const struct dea_line_link *link,
                            double timeout_s, const char *command)
{
  char line[COMMAND_SIZE];
  int length = snprintf(line, sizeof line, "%s\n", command);
  return dea_socket_write(ctx, &link->socket, timeout_s, line, (size_t)length);
}

/* Sends what goes without waiting. */
static void send_if_possible(const struct dea_line_link *link, const char *command)
{
  char line[COMMAND_SIZE];
  int length = snprintf(line, sizeof line, "%s\n", command);
  dea_socket_write_if_possible(&link->socket, line, (size_t)length);
}

/* Sends a question. DEA_E_INSTRUMENT where something came that nobody had asked for: which question
 * the next response belongs to would not be known. */
static dea_status send_question(struct dea_context *ctx, struct dea_line_link *link,
                                double timeout_s, const char *question)
{
  DEA_TRY(ctx, dea_line_unasked(ctx, link));
  return send_line(ctx, link, timeout_s, question);
}

/* Sends a question and waits for its response. */
static dea_status query(struct dea_context *ctx, struct dea_line_link *link, double timeout_s,
                        const char *question, const char **out)
{
  *out = NULL;
  DEA_TRY(ctx, send_question(ctx, link, timeout_s, question));
  return dea_line_wait(ctx, link, timeout_s, out);
}

/* Whether a response to *IDN? is of the instrument that is meant: has `identity` in it, and is
 * mark, where that is not "". */
static bool is_meant(const struct raw *raw, const char *mark, const char *response)
{
  return strstr(response, raw->identity.text) != NULL &&
         (mark[0] == '\0' || strncmp(response, mark, DEA_INSTRUMENT_MARK_SIZE - 1) == 0);
}

static dea_status no_response(struct dea_context *ctx, const struct scpi *s, const char *question,
                              double timeout_s)
{
  return dea_fail(ctx, DEA_E_INSTRUMENT,
                  "%s did not answer '%.100s' within %g s; look at whether it knows that question",
                  s->name, question, timeout_s);
}

/* The output's command with a control voltage in it; numbers have a point in any locale. */
static void output_command(const struct raw *raw, double volts, char out[COMMAND_SIZE])
{
  char number[32];
  const char *hole = strchr(raw->output.text, '%');
  snprintf(number, sizeof number, "%.9g", volts * raw->output_factor.si);
  char *comma = strchr(number, ',');
  if (comma != NULL) {
    *comma = '.';
  }
  snprintf(out, COMMAND_SIZE, "%.*s%s%s", (int)(hole - raw->output.text), raw->output.text, number,
           hole + 2);
}

/* Whether a response confirms that what was sent before is done. */
static bool is_confirmed(const struct raw *raw, const char *response)
{
  double value;
  bool number = dea_scpi_number(response, 0, &value);
  return strcmp(raw->confirm.text, "*OPC?") == 0 ? number && value == 1 : response[0] != '\0';
}

/* The control voltage [V] of a response to `measure`; false when it is none. Its unit, where it has
 * one, must be that in which the output is set. */
static bool read_measured(const struct raw *raw, const struct dea_protocol *protocol,
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

// The output: what is set -------------------------------------------------------------------------

static dea_status request(struct dea_context *ctx, struct scpi *s, enum question what,
                          const char *question)
{
  s->asked = what;
  s->asked_s = dea_clock_s();
  dea_status status = send_question(ctx, &s->link, s->raw.behind_s.si, question);
  s->output.turned_s = dea_clock_s(); // a supply that takes nothing is no stall of the computer
  return status;
}

static dea_status send_voltage(struct dea_context *ctx, struct scpi *s, double volts)
{
  char command[COMMAND_SIZE];
  DEA_TRY(ctx, dea_protocol_guard(ctx, s->protocol, &volts, 1));
  output_command(&s->raw, volts, command);
  dea_timed_sent(&s->output, volts, dea_clock_s());
  s->base.doubt = dea_evidence_doubt(&s->output.evidence);
  DEA_TRY(ctx, send_line(ctx, &s->link, s->raw.behind_s.si, command));
  return request(ctx, s, CONFIRM, s->raw.confirm.text);
}

static dea_status no_sense(struct dea_context *ctx, const struct scpi *s, const char *question,
                           const char *response)
{
  double value;
  bool several = dea_scpi_number(response, 1, &value) && dea_scpi_fields(response) > 1;
  return dea_fail(ctx, DEA_E_INSTRUMENT, "%s answered '%.60s' to '%.60s', which %s", s->name,
                  response, question,
                  several ? "are several numbers: say which of them by measure_field"
                          : "makes no sense");
}

static dea_status begin_output(struct dea_context *ctx, struct scpi *s)
{
  const struct raw *raw = &s->raw;
  s->output.rate_Hz = s->protocol->rate_Hz.si;
  s->output.queue_s = raw->queue_s.si;
  s->output.behind_s = raw->behind_s.si;
  s->output.output_interval_s = raw->output_interval_s.si;
  s->output.measure_interval_s =
      raw->measure.origin != DEA_ABSENT ? raw->interval_s.si : (double)INFINITY;
  dea_timed_limits(&s->output, s->protocol);
  return dea_timed_begin(ctx, &s->output);
}

/* Sets 0 V before anything is played and looks whether it is there. */
static dea_status open_output(struct dea_context *ctx, struct scpi *s)
{
  const char *response;
  double timeout_s = s->raw.timeout_s.si, volts;
  char command[COMMAND_SIZE];
  output_command(&s->raw, 0, command);
  DEA_TRY(ctx, send_line(ctx, &s->link, timeout_s, command));
  DEA_TRY(ctx, query(ctx, &s->link, timeout_s, s->raw.confirm.text, &response));
  if (response == NULL || !is_confirmed(&s->raw, response)) {
    return no_response(ctx, s, s->raw.confirm.text, timeout_s);
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
  DEA_TRY(ctx, query(ctx, &s->link, timeout_s, s->raw.measure.text, &response));
  if (response == NULL) {
    return no_response(ctx, s, s->raw.measure.text, timeout_s);
  }
  if (!read_measured(&s->raw, s->protocol, response, &volts)) {
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

// The queue --------------------------------------------------------------------------------------

/* Feeds the watchdog when that is due; *next_s: when it will be. */
static dea_status feed(struct dea_context *ctx, struct scpi *s, double now_s, double *next_s)
{
  const struct raw *raw = &s->raw;
  *next_s = INFINITY;
  if (raw->watchdog.feed.origin == DEA_ABSENT) {
    return DEA_OK;
  }
  if (now_s >= s->fed_s + raw->watchdog.period_s.si) {
    s->fed_s = now_s;
    DEA_TRY(ctx, send_line(ctx, &s->link, raw->behind_s.si, raw->watchdog.feed.text));
  }
  *next_s = s->fed_s + raw->watchdog.period_s.si;
  return DEA_OK;
}

/* From when on the open question is late; readings have a time of their own. */
static double late_at(const struct scpi *s)
{
  double wait_s = s->asked == READING ? (double)INFINITY : s->raw.behind_s.si;
  return s->asked == NOTHING ? (double)NAN : s->asked_s + wait_s;
}

/* Does what is due: takes samples out of the queue, sends the last of them, measures, feeds the
 * watchdog. *next_s: clock at which there is something to do. DEA_E_INTERLOCK after a stall. */
static dea_status play(struct dea_context *ctx, struct scpi *s, double *next_s)
{
  const struct raw *raw = &s->raw;
  struct dea_timed_output *o = &s->output;
  double now_s = dea_clock_s(), feed_s;
  bool confirms = s->asked == CONFIRM;
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
    return no_response(ctx, s, confirms ? raw->confirm.text : raw->measure.text, raw->behind_s.si);
  case DEA_TIMED_BEHIND:
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s is more than %g s behind with its voltage", s->name,
                    raw->behind_s.si);
  case DEA_TIMED_MEASURE:
    return request(ctx, s, MEASURE, raw->measure.text);
  case DEA_TIMED_SEND:
    return send_voltage(ctx, s, o->wanted_V);
  case DEA_TIMED_NOTHING:
    break;
  }
  return DEA_OK;
}

/* A response to the open question of the output. */
static dea_status read_output(struct dea_context *ctx, struct scpi *s, const char *response)
{
  double volts;
  bool confirms = s->asked == CONFIRM;
  s->asked = NOTHING;
  if (confirms && is_confirmed(&s->raw, response)) {
    return DEA_OK;
  }
  if (!confirms && read_measured(&s->raw, s->protocol, response, &volts)) {
    dea_status status = dea_timed_measured(ctx, &s->output, s->protocol, s->name, volts);
    s->base.doubt = dea_evidence_doubt(&s->output.evidence);
    return status;
  }
  s->broken = true;
  return no_sense(ctx, s, confirms ? s->raw.confirm.text : s->raw.measure.text, response);
}

/* Plays, and takes the responses that belong to it, until there is something else to do. */
static dea_status serve(struct dea_context *ctx, void *supply, double until_s)
{
  struct scpi *s = supply;
  const char *response;
  double next_s;
  DEA_TRY(ctx, play(ctx, s, &next_s));
  double wait_s = fmin(next_s, until_s) - dea_clock_s();
  if (s->asked != CONFIRM && s->asked != MEASURE) {
    dea_clock_wait(wait_s);
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_line_wait(ctx, &s->link, wait_s, &response));
  return response != NULL ? read_output(ctx, s, response) : DEA_OK;
}

static dea_status set_outputs(struct dea_context *ctx, struct dea_instrument *instrument,
                              const double *volts, size_t count)
{
  struct scpi *s = (struct scpi *)instrument;
  double next_s;
  DEA_TRY(ctx, dea_protocol_guard(ctx, s->protocol, volts, count));
  DEA_TRY(ctx, dea_timed_write(ctx, &s->output, volts, count, serve, s));
  return play(ctx, s, &next_s);
}

static dea_status hold(struct dea_context *ctx, struct dea_instrument *instrument, double *volts)
{
  struct scpi *s = (struct scpi *)instrument;
  (void)ctx;
  s->asked_s = dea_clock_s(); // a response may wait since then
  *volts = dea_timed_hold(&s->output, s->asked_s);
  return DEA_OK;
}

// To 0 V ------------------------------------------------------------------------------------------

/* How a supply that speaks SCPI is brought to 0 V, and what is known of it then.
 *
 * Its output is switched off, then set to 0 V, then synchronised, and its voltage is read back
 * until it has been at 0 V for `behind`: what a supply may still have had to do is done then. An
 * answer that does not come or makes no sense leaves it open to which question the next one
 * belongs: nothing more is believed of that connection, and all begins anew on another one. There
 * another instrument may have the address: it is told 0 V too, which hurts nobody, but only what
 * says of itself (*IDN?) what the one said that was used is believed. Nor is anything of one that
 * another program drives, which knows it by another name: it may set a voltage a moment later. */

/* What is meant. */
struct meant {
  const struct raw *raw;
  const struct dea_protocol *protocol;
  const char *mark; // what it said of itself; "": it was not asked
  bool told;        // that another one may be there
  bool alone;       // no other program may have it: it has it itself, or is the guard of one
  const char *host; // its number; "": its name must be looked up
};

static const double poll_s = 0.05, again_s = 0.1;
/* Of the time left: how long an answer is waited for, so that there is time for another try. */
static const double share = 0.4;

/* Sends what brings the output to 0 V, without waiting. */
static void command_zero(const struct dea_line_link *link, const struct raw *raw)
{
  char command[COMMAND_SIZE];
  if (raw->output_off.origin != DEA_ABSENT) {
    send_if_possible(link, raw->output_off.text);
  }
  output_command(raw, 0, command);
  send_if_possible(link, command);
}

static void command_end(const struct dea_line_link *link, const struct raw *raw, bool zero)
{
  if (zero && raw->watchdog.disarm.origin != DEA_ABSENT) { // else it is to do its work
    send_if_possible(link, raw->watchdog.disarm.text);
  }
  for (size_t i = 0; i < raw->at_stop_count; i++) {
    send_if_possible(link, raw->at_stop[i].text);
  }
}

/* Whether it says that its output is off, or need not. False: it does not answer. */
static bool query_off(struct dea_context *ctx, struct dea_line_link *link, const struct raw *raw,
                      double timeout_s, bool *off)
{
  const char *answer;
  double value;
  *off = raw->is_off.origin == DEA_ABSENT;
  if (*off) {
    return true;
  }
  if (query(ctx, link, timeout_s, raw->is_off.text, &answer) != DEA_OK || answer == NULL) {
    return false;
  }
  *off = strcmp(answer, "OFF") == 0 || (dea_scpi_number(answer, 0, &value) && value == 0);
  return true;
}

/* Reads the voltage back until it stays at 0 V or the time is over, then with why that is not
 * known. False: it does not answer. */
static bool read_back(struct dea_context *ctx, struct dea_line_link *link, const struct raw *raw,
                      const struct dea_protocol *protocol, double until_s, struct dea_zero *zero)
{
  double since_s = NAN;
  for (;;) {
    const char *answer;
    double asked_s = dea_clock_s(), volts, left_s = until_s - asked_s;
    // all that is left, where there is no time for another try
    double wait_s = left_s > raw->behind_s.si ? share * left_s : fmax(left_s, poll_s);
    bool off = false;
    if (asked_s >= until_s) {
      zero->why = isnan(since_s) ? NULL : dea_zero_not_for_long;
      return true;
    }
    if (query(ctx, link, wait_s, raw->measure.text, &answer) != DEA_OK || answer == NULL ||
        !read_measured(raw, protocol, answer, &volts) || !query_off(ctx, link, raw, wait_s, &off)) {
      return false;
    }
    zero->volts = volts;
    if (!off || fabs(zero->volts * protocol->amplifier.gain.si) > protocol->safety.at_zero_V.si) {
      since_s = NAN;
    } else if (isnan(since_s)) {
      since_s = asked_s;
    } else if (asked_s - since_s >= raw->behind_s.si) {
      zero->state = DEA_ZERO_READ_BACK;
      return true;
    }
    dea_clock_wait(poll_s);
  }
}

/* Whether it is the instrument that was used, or the section's. False also without an answer. */
static bool is_same(struct dea_context *ctx, struct dea_line_link *link, struct meant *m,
                    double timeout_s)
{
  const char *answer;
  if (query(ctx, link, timeout_s, "*IDN?", &answer) != DEA_OK || answer == NULL) {
    return false;
  }
  bool same = is_meant(m->raw, m->mark, answer);
  if (!same && !m->told) {
    m->told = true;
    (void)dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                          "%s says that it is '%.100s', which the one that is meant would not: it "
                          "may be another one; it was told 0 V too, and is not believed",
                          link->socket.name, answer);
  }
  return same;
}

/* After command_zero: what is known. anew: another instrument may be there. False: this connection
 * is good for nothing. */
static bool find_out(struct dea_context *ctx, struct dea_line_link *link, struct meant *m,
                     bool anew, double until_s, struct dea_zero *zero)
{
  const struct raw *raw = m->raw;
  const char *answer;
  double wait_s = share * (until_s - dea_clock_s());
  if (!(wait_s > 0) || query(ctx, link, wait_s, raw->confirm.text, &answer) != DEA_OK ||
      answer == NULL || !is_confirmed(raw, answer) ||
      (anew && !is_same(ctx, link, m, share * (until_s - dea_clock_s())))) {
    return false;
  }
  if (raw->measure.origin == DEA_ABSENT) {
    zero->state = DEA_ZERO_COMMANDED;
    return true;
  }
  return read_back(ctx, link, raw, m->protocol, until_s, zero);
}

/* Whether another program drives what is at the other end, which is said. */
static bool is_driven(struct dea_context *ctx, const struct dea_socket *connection)
{
  int claim;
  if (dea_socket_claim(connection, &claim)) {
    close(claim);
    return false;
  }
  (void)dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                        "%s is driven by another program on this computer, by another name: it was "
                        "told 0 V, and nothing that it says is believed; end that one",
                        connection->name);
  return true;
}

/* On connections of its own, until one has said something or the time is over. A name is looked up
 * only where no number is known, or from the second time on where that may be an old one: who looks
 * it up may have to wait for longer than there is time. */
static struct dea_zero zero_anew(struct dea_context *ctx, struct meant *m, double until_s)
{
  const struct raw *raw = m->raw;
  struct dea_zero zero = {DEA_ZERO_UNKNOWN, NAN, dea_zero_no_answer};
  bool told = false, driven = false, number = true;
  for (double left_s = until_s - dea_clock_s(); left_s > 0 && !told;) {
    struct dea_line_link link;
    double wait_s = number && !m->alone && m->host[0] != '\0' ? share * left_s : left_s;
    if (connect_to(ctx, raw, number ? m->host : "", wait_s, &link) == DEA_OK) {
      driven = driven || (!m->alone && is_driven(ctx, &link.socket));
      command_zero(&link, raw);
      told = find_out(ctx, &link, m, true, until_s, &zero);
      command_end(&link, raw, zero.state != DEA_ZERO_UNKNOWN);
      dea_socket_close(&link.socket);
    }
    number = m->alone || !number;
    left_s = until_s - dea_clock_s();
    if (!told) {
      dea_clock_wait(fmin(again_s, left_s));
    }
  }
  if (driven) {
    dea_zero_doubt(&zero, dea_zero_other);
  }
  return zero;
}

static struct dea_zero stop(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct scpi *s = (struct scpi *)instrument;
  struct dea_zero zero = {DEA_ZERO_UNKNOWN, NAN, NULL};
  double now_s = dea_clock_s(), until_s = now_s + s->protocol->safety.zero_time_s.si;
  struct meant m = {&s->raw, s->protocol, s->base.mark, false, true, s->base.host};
  bool told = false;
  if ((s->base.roles & DEA_PLAYS_OUTPUT) == 0) {
    command_end(&s->link, &s->raw, true);
    return (struct dea_zero){DEA_ZERO_NONE, NAN, NULL};
  }
  if (s->link.socket.descriptor >= 0) {
    const char *answer = NULL;
    command_zero(&s->link, &s->raw);
    bool failed = s->broken;
    if (!failed && s->asked != NOTHING) { // what comes next belongs to the question from before
      failed = dea_line_wait(ctx, &s->link, share * (until_s - now_s), &answer) != DEA_OK ||
               answer == NULL;
    }
    told = !failed && find_out(ctx, &s->link, &m, false, until_s, &zero);
    command_end(&s->link, &s->raw, zero.state != DEA_ZERO_UNKNOWN);
  }
  if (!told) {
    dea_socket_close(&s->link.socket); // some supplies have one connection only
    zero = zero_anew(ctx, &m, until_s);
  }
  return dea_zero_believe(zero, dea_evidence_doubt(&s->output.evidence));
}

static struct dea_zero bring_to_zero(struct dea_context *ctx, const void *data,
                                     const struct dea_protocol *protocol,
                                     const struct dea_instrument_past *past)
{
  const struct raw *raw = data;
  struct meant m = {raw, protocol, past->mark, false, past->program != 0, past->host};
  return raw->output.origin == DEA_ABSENT
             ? (struct dea_zero){DEA_ZERO_NONE, NAN, NULL}
             : zero_anew(ctx, &m, dea_clock_s() + protocol->safety.zero_time_s.si);
}

// Opening ----------------------------------------------------------------------------------------

/* Whether it took its setup: looks at its error queue, which was empty before. */
static dea_status check_error(struct dea_context *ctx, struct scpi *s)
{
  const char *response, *text;
  int code;
  DEA_TRY(ctx, query(ctx, &s->link, s->raw.timeout_s.si, "SYST:ERR?", &response));
  if (response == NULL || !dea_scpi_error(response, &code, &text)) {
    return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                           "%s does not answer SYST:ERR?, so that its setup is not checked",
                           s->name);
  }
  if (code != 0) {
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s does not accept its setup: error %d, %.100s",
                    s->name, code, text);
  }
  return DEA_OK;
}

static dea_status identify(struct dea_context *ctx, struct scpi *s)
{
  const char *response, *wanted = s->raw.identity.text;
  DEA_TRY(ctx, query(ctx, &s->link, s->raw.timeout_s.si, "*IDN?", &response));
  if (response == NULL) {
    return no_response(ctx, s, "*IDN?", s->raw.timeout_s.si);
  }
  if (!is_meant(&s->raw, "", response)) {
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s is a '%.120s', not a '%.60s'; look at its address",
                    s->name, response, wanted);
  }
  snprintf(s->base.mark, sizeof s->base.mark, "%.*s", (int)sizeof s->base.mark - 1, response);
  return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0}, "%s is a '%.120s'", s->name,
                         response);
}

static dea_status set_up(struct dea_context *ctx, struct scpi *s)
{
  bool plays = (s->base.roles & DEA_PLAYS_OUTPUT) != 0;
  double timeout_s = s->raw.timeout_s.si;
  DEA_TRY(ctx, identify(ctx, s));
  if (plays) { // the setup may switch on what was set before
    char zero[COMMAND_SIZE];
    output_command(&s->raw, 0, zero);
    DEA_TRY(ctx, send_line(ctx, &s->link, timeout_s, zero));
  }
  DEA_TRY(ctx, send_line(ctx, &s->link, timeout_s, "*CLS"));
  for (size_t i = 0; i < s->raw.setup_count; i++) {
    DEA_TRY(ctx, send_line(ctx, &s->link, timeout_s, s->raw.setup[i].text));
  }
  DEA_TRY(ctx, plays ? open_output(ctx, s) : DEA_OK);
  return plays || s->raw.setup_count > 0 ? check_error(ctx, s) : DEA_OK;
}

static void close_it(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct scpi *s = (struct scpi *)instrument;
  dea_socket_close(&s->link.socket);
  if (s->claim >= 0) {
    close(s->claim);
  }
  dea_timed_end(ctx, &s->output);
  dea_free(ctx, s);
}

/* A supply may have several names, and take several connections. */
static dea_status claim_supply(struct dea_context *ctx, struct scpi *s)
{
  if ((s->base.roles & DEA_PLAYS_OUTPUT) == 0 || dea_socket_claim(&s->link.socket, &s->claim)) {
    return DEA_OK;
  }
  dea_socket_close(&s->link.socket); // what is set there is not ours
  return dea_fail(ctx, DEA_E_INSTRUMENT,
                  "%s is driven by another program on this computer, by this or another name: end "
                  "that first",
                  s->name);
}

static dea_status open_it(struct dea_context *ctx, struct dea_instrument *instrument,
                          const void *raw, const struct dea_protocol *protocol)
{
  struct scpi *s = (struct scpi *)instrument;
  s->raw = *(const struct raw *)raw;
  s->base.roles = (s->raw.reading_count > 0 ? DEA_GIVES_READINGS : 0U) |
                  (s->raw.output.origin != DEA_ABSENT ? DEA_PLAYS_OUTPUT : 0U);
  for (size_t i = 0; i < s->raw.reading_count; i++) {
    const struct raw_reading *r = &s->raw.readings[i];
    dea_instrument_add_reading(&s->base, &r->name, &r->quantity, &r->unit);
  }
  s->protocol = protocol;
  s->link.socket.descriptor = s->claim = -1;
  if ((s->base.roles & DEA_PLAYS_OUTPUT) != 0) {
    DEA_TRY(ctx, begin_output(ctx, s));
  }
  DEA_TRY(ctx, connect_to(ctx, &s->raw, "", s->raw.timeout_s.si, &s->link));
  snprintf(s->name, sizeof s->name, "%s", s->link.socket.name);
  memcpy(s->base.host, s->link.socket.host, sizeof s->base.host);
  DEA_TRY(ctx, claim_supply(ctx, s));
  s->base.reached = true; // not before: what is set there may be another program's
  return set_up(ctx, s);
}

static void address(const void *data, char *out, size_t size)
{
  const struct raw *raw = data;
  if (raw->output.origin != DEA_ABSENT) {
    snprintf(out, size, "%s %d", raw->address.text, (int)raw->port.si);
  }
}

static dea_status start_scpi(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct scpi *s = (struct scpi *)instrument;
  s->base.start_s = dea_clock_s();
  s->schedule.count = s->raw.reading_count;
  s->schedule.interval_s = s->raw.interval_s.si;
  s->schedule.timeout_s = s->raw.timeout_s.si;
  dea_poll_schedule_start(&s->schedule, s->base.start_s);
  if (s->output.queue == NULL) {
    return DEA_OK;
  }
  dea_timed_start(&s->output, s->base.start_s);
  s->fed_s = s->base.start_s;
  return s->raw.watchdog.arm.origin != DEA_ABSENT
             ? send_line(ctx, &s->link, s->raw.behind_s.si, s->raw.watchdog.arm.text)
             : DEA_OK;
}

/* The SI value of a response with a unit; *fits: that is one of the reading's quantity. */
static dea_status convert(struct dea_context *ctx, const struct scpi *s, size_t reading,
                          const char *response, size_t field, double *si, bool *fits)
{
  char text[DEA_SCPI_VALUE_SIZE], example[DEA_CHANNEL_NAME_SIZE + 2], why[DEA_WHY_SIZE] = "?";
  const struct dea_instrument_reading *r = &s->base.readings[reading];
  const char *unit = r->kind == DEA_CHANNEL_OTHER ? r->unit : dea_channel_meanings[r->kind].si_unit;
  snprintf(example, sizeof example, "1 %s", unit);
  *fits = unit[0] != '\0' && dea_scpi_with_unit(response, field, text) &&
          dea_units_read(ctx, text, (struct dea_measure){unit, example}, si, why);
  return *fits || why[0] != '\0' ? DEA_OK : dea_context_status(ctx);
}

/* The value of a response in SI, before `offset`. *fits: its unit is one of the quantity, what
 * `factor` says, and the one of the first answer where that alone is known of it. */
static dea_status scale(struct dea_context *ctx, struct scpi *s, size_t reading,
                        const char *response, size_t field, double *value, bool *fits)
{
  const struct dea_quantity *factor = &s->raw.readings[reading].factor;
  char suffix[DEA_SCPI_SUFFIX_SIZE];
  double si = NAN;
  bool given = factor->origin != DEA_ABSENT, known;
  dea_scpi_suffix(response, field, suffix);
  bool same = !s->known[reading] || strcmp(suffix, s->suffix[reading]) == 0;
  *value *= given ? factor->si : 1;
  *fits = same && (given || suffix[0] == '\0');
  if (suffix[0] != '\0') {
    DEA_TRY(ctx, convert(ctx, s, reading, response, field, &si, &known));
    if (known) {
      *fits = !given || fabs(fabs(*value) - fabs(si)) <= 1e-9 * fabs(si);
      *value = given ? *value : si;
    }
  }
  if (*fits && !s->known[reading]) {
    memcpy(s->suffix[reading], suffix, sizeof suffix);
    s->known[reading] = true;
  }
  return DEA_OK;
}

/* Says why a number is not taken: at first that is an error of the protocol. alone: it is one
 * number, whose unit does not fit. */
static dea_status refuse(struct dea_context *ctx, struct scpi *s, size_t reading,
                         const char *response, bool alone)
{
  const char *query = s->raw.readings[reading].query.text, *name = s->base.readings[reading].name;
  if (!s->known[reading]) {
    return alone ? dea_fail(ctx, DEA_E_INSTRUMENT,
                            "%s answered '%.80s' to '%.60s', whose unit does not fit '%s': look at "
                            "its quantity, its 'unit' and its 'factor' (what 1 of the answer is)",
                            s->name, response, query, name)
                 : dea_fail(ctx, DEA_E_INSTRUMENT,
                            "%s answered '%.80s' to '%.60s', which has %zu field(s): say which "
                            "of them is '%s' (field: 1 for the first)",
                            s->name, response, query, dea_scpi_fields(response), name);
  }
  if (s->noted_suffix) {
    return DEA_OK;
  }
  s->noted_suffix = true;
  return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                         "%s answered '%.60s' to '%.60s', where '%s' stood behind the number "
                         "before: such answers are left out; fix its range",
                         s->name, response, query, s->suffix[reading]);
}

/* A response to what was asked: to the output, or the value of a reading. */
static dea_status read_response(struct dea_context *ctx, struct scpi *s, const char *response,
                                const struct dea_sink *sink)
{
  size_t reading = s->schedule.reading;
  double value, now_s = dea_clock_s();
  if (s->asked == NOTHING) {
    return dea_line_alone(ctx, &s->link, NULL, response, strlen(response));
  }
  if (s->asked != READING) {
    return read_output(ctx, s, response);
  }
  const struct raw_reading *r = &s->raw.readings[reading];
  size_t field = r->field.origin != DEA_ABSENT ? (size_t)r->field.si : 0;
  bool good = dea_scpi_number(response, field, &value);
  bool alone = good, number = good || dea_scpi_number(response, 1, &value);
  if (good && !isnan(value)) {
    DEA_TRY(ctx, scale(ctx, s, reading, response, field, &value, &good));
  }
  DEA_TRY(ctx, number && !good ? refuse(ctx, s, reading, response, alone) : DEA_OK);
  if (!good) {
    value = NAN;
    s->base.lost++;
    s->broken = true;
  }
  s->asked = NOTHING;
  // It was measured between question and response.
  return sink->reading(sink->user, reading, 0.5 * (s->asked_s + now_s) - s->base.start_s,
                       value + r->offset.si);
}

/* Asks for the reading that is due, if any and nothing is waited for; *next_s: when one will be. */
static dea_status query_next(struct dea_context *ctx, struct scpi *s, double *next_s)
{
  double now_s = dea_clock_s();
  *next_s = INFINITY;
  if (s->asked == READING) {
    const char *query = s->raw.readings[s->schedule.reading].query.text;
    *next_s = s->asked_s + s->raw.timeout_s.si;
    return now_s < *next_s ? DEA_OK : no_response(ctx, s, query, s->raw.timeout_s.si);
  }
  if (s->asked != NOTHING || !dea_poll_schedule_next(&s->schedule, now_s, next_s)) {
    return DEA_OK;
  }
  s->asked = READING;
  s->asked_s = now_s;
  return send_question(ctx, &s->link, s->raw.timeout_s.si,
                       s->raw.readings[s->schedule.reading].query.text);
}

static dea_status get(struct dea_context *ctx, struct dea_instrument *instrument, double timeout_s,
                      const struct dea_sink *sink)
{
  struct scpi *s = (struct scpi *)instrument;
  double until_s = dea_clock_s() + timeout_s, left_s;
  bool came = false;
  do {
    char bytes[1024];
    size_t length, dropped = s->link.lines.dropped;
    double play_s, ask_s;
    const char *at = bytes, *response;
    DEA_TRY(ctx, play(ctx, s, &play_s));
    DEA_TRY(ctx, query_next(ctx, s, &ask_s));
    double next_s = fmin(until_s, fmin(play_s, ask_s));
    DEA_TRY(ctx, dea_socket_read(ctx, &s->link.socket, next_s - dea_clock_s(), bytes, sizeof bytes,
                                 &length));
    while ((response = dea_line_next(&s->link.lines, &at, &length)) != NULL) {
      came = true;
      DEA_TRY(ctx, dea_line_alone(ctx, &s->link, response, at, length));
      DEA_TRY(ctx, read_response(ctx, s, response, sink));
    }
    if (s->link.lines.dropped > dropped) {
      DEA_TRY(ctx, read_response(ctx, s, "", sink)); // what came makes no sense
    }
    left_s = until_s - dea_clock_s();
  } while (!came && left_s > 0);
  return DEA_OK;
}

const struct dea_instrument_type dea_instrument_scpi = {
    .name = "scpi",
    .record = &dea_instrument_scpi_record,
    .raw_size = sizeof(struct raw),
    .size = sizeof(struct scpi),
    .roles = DEA_PLAYS_OUTPUT | DEA_GIVES_READINGS,
    .check = check,
    .open = open_it,
    .start = start_scpi,
    .put = set_outputs,
    .get = get,
    .hold = hold,
    .stop = stop,
    .address = address,
    .zero = bring_to_zero,
    .close = close_it,
};
