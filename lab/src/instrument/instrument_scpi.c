#define _POSIX_C_SOURCE 200809L // close
/* Instrument "scpi": what speaks SCPI on a TCP port, such as an electrometer, a force display or
 * a laboratory supply. Its readings are queries, asked one after the other at their interval; its
 * output is a command with a number in it, sent by the computer's clock. */
#include "base/clock.h"
#include "base/schema_value.h"
#include "base/units.h"
#include "instrument/scpi.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const struct dea_field reading_fields[] = {
    DEA_INSTRUMENT_LABEL(struct dea_scpi_raw_reading, name, "name", "name of its channel",
                         "leakage", .required = true),
    DEA_INSTRUMENT_LABEL(struct dea_scpi_raw_reading, query, "query",
                         "question that it answers with a number", "MEAS:CURR?", .required = true),
    DEA_INSTRUMENT_QUANTITY(struct dea_scpi_raw_reading, quantity),
    DEA_INSTRUMENT_NUMBER(struct dea_scpi_raw_reading, field, "field",
                          "which number of an answer that has several, from 1 on", 1, 99, "2",
                          .absent_text = "it answers with one"),
    DEA_NUMBER_ROW("factor", offsetof(struct dea_scpi_raw_reading, factor), "1", "1e-3",
                   "SI value of 1 of what it answers; 1e-3 where it answers in mN without saying "
                   "so. A unit that it does say is converted without this key",
                   .absent_text = "1, or the unit of the answer"),
    DEA_NUMBER_ROW("offset", offsetof(struct dea_scpi_raw_reading, offset), "1", "0",
                   "added to it afterwards, in SI", .default_text = "0"),
    DEA_INSTRUMENT_LABEL(struct dea_scpi_raw_reading, unit, "unit",
                         "SI unit of an 'other' quantity", "K", .absent_text = "none"),
};
static const struct dea_record reading_record = {
    "reading", "a value that is asked for", reading_fields, DEA_INSTRUMENT_COUNT(reading_fields)};

static const struct dea_field watchdog_fields[] = {
    DEA_INSTRUMENT_LABEL(struct dea_scpi_raw, watchdog.arm, "arm",
                         "command that arms it, sent at the start", "OUTP:WDOG 2",
                         .absent_text = "none"),
    DEA_INSTRUMENT_LABEL(struct dea_scpi_raw, watchdog.feed, "feed", "command that feeds it",
                         "OUTP:WDOG:FEED", .absent_text = "none"),
    DEA_INSTRUMENT_LABEL(struct dea_scpi_raw, watchdog.disarm, "disarm",
                         "command that disarms it, sent once the output is at 0 V", "OUTP:WDOG:OFF",
                         .absent_text = "none"),
    DEA_INSTRUMENT_TIME(struct dea_scpi_raw, watchdog.period_s, "period", "between two feeds",
                        "0.5 s", 60),
};
static const struct dea_record watchdog_record = {"watchdog", "commands of a supply's own watchdog",
                                                  watchdog_fields,
                                                  DEA_INSTRUMENT_COUNT(watchdog_fields)};

static const struct dea_field fields[] = {
    DEA_INSTRUMENT_KIND(struct dea_scpi_raw, "scpi"),
    DEA_INSTRUMENT_LABEL(struct dea_scpi_raw, address, "address",
                         "its name or address in the network", "192.168.1.20", .required = true),
    DEA_INSTRUMENT_PORT(struct dea_scpi_raw, port, "port", "its TCP port", .default_text = "5025"),
    DEA_INSTRUMENT_LABEL(struct dea_scpi_raw, identity, "identity",
                         "what its answer to *IDN? must contain, against mix-ups", "6517B",
                         .absent_text = "not compared"),
    DEA_INSTRUMENT_TIME(struct dea_scpi_raw, timeout_s, "timeout", "longest wait for an answer",
                        "2 s", 60),
    DEA_INSTRUMENT_TIME(struct dea_scpi_raw, interval_s, "interval",
                        "between two rounds of readings", "0.5 s", 3600),
    {.key = "setup",
     .kind = DEA_FIELD_LABEL,
     DEA_INSTRUMENT_LIST_OF(struct dea_scpi_raw, setup, setup_count, DEA_SCPI_COMMANDS_MAX),
     .doc = "commands sent at first; then its error queue is looked at",
     .example = "[\"*RST\", \"FUNC 'CURR'\"]"},
    {.key = "at_stop",
     .kind = DEA_FIELD_LABEL,
     DEA_INSTRUMENT_LIST_OF(struct dea_scpi_raw, at_stop, at_stop_count, DEA_SCPI_COMMANDS_MAX),
     .doc = "commands sent at the end, also after a failure",
     .example = "[\"OUTP OFF\"]"},
    {.key = "readings",
     .kind = DEA_FIELD_RECORD,
     .record = &reading_record,
     DEA_INSTRUMENT_LIST_OF(struct dea_scpi_raw, readings, reading_count,
                            DEA_INSTRUMENT_READINGS_MAX),
     .doc = "what it is asked for",
     .example = "[{name: leakage, query: \"MEAS:CURR?\", quantity: current}]"},
    DEA_INSTRUMENT_LABEL(struct dea_scpi_raw, output, "output",
                         "command that sets the control voltage, with %g for the number; timed by "
                         "software",
                         "SOUR:VOLT %g", .absent_text = "it plays nothing"),
    DEA_NUMBER_ROW(
        "output_factor", offsetof(struct dea_scpi_raw, output_factor), "1", "1000",
        "what is sent for 1 V of control voltage; of a high-voltage supply that is set in V, the "
        "amplifier's gain",
        .default_text = "1"),
    DEA_INSTRUMENT_TIME(struct dea_scpi_raw, output_interval_s, "output_interval",
                        "shortest time between two commands of the output", "20 ms", 60),
    DEA_INSTRUMENT_TIME(struct dea_scpi_raw, queue_s, "queue",
                        "of the output that is held ready; a computer that is away for longer ends "
                        "the measurement",
                        "0.25 s", 5),
    DEA_INSTRUMENT_LABEL(struct dea_scpi_raw, output_off, "output_off",
                         "command that switches its output off, before it is set to 0 V at the end",
                         "OUTP OFF", .absent_text = "it is only set to 0 V"),
    DEA_INSTRUMENT_LABEL(
        struct dea_scpi_raw, is_off, "is_off",
        "question that it answers with 0 or OFF once its output is off; without it "
        "a supply that confirms what it has yet to do may be believed",
        "OUTP?", .absent_text = "it is not asked"),
    DEA_INSTRUMENT_LABEL(struct dea_scpi_raw, confirm, "confirm",
                         "question sent behind each voltage; no other is sent before its answer",
                         "*OPC?", .default_text = "*OPC?"),
    DEA_INSTRUMENT_LABEL(
        struct dea_scpi_raw, measure, "measure",
        "question that it answers with the voltage measured at its output, in what "
        "it is set in",
        "MEAS:VOLT?", .absent_text = "its output is not read back"),
    DEA_INSTRUMENT_NUMBER(struct dea_scpi_raw, measure_field, "measure_field",
                          "which number of that answer is the voltage, from 1 on", 1, 99, "1",
                          .absent_text = "it answers with one"),
    DEA_INSTRUMENT_TIME(struct dea_scpi_raw, behind_s, "behind",
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
static dea_status check_command(const struct dea_reader *reader, const struct dea_scpi_raw *raw,
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

static dea_status check_commands(const struct dea_reader *reader, const struct dea_scpi_raw *raw)
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
  const struct dea_scpi_raw *raw = data;
  struct dea_instrument sketch = {0};
  for (size_t i = 0; i < raw->reading_count; i++) {
    const struct dea_scpi_raw_reading *r = &raw->readings[i];
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

/* Whether it took its setup: looks at its error queue, which was empty before. */
static dea_status check_error(struct dea_context *ctx, struct dea_scpi *s)
{
  const char *response, *text;
  int code;
  DEA_TRY(ctx, dea_scpi_query(ctx, &s->link, s->raw.timeout_s.si, "SYST:ERR?", &response));
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

static dea_status identify(struct dea_context *ctx, struct dea_scpi *s)
{
  const char *response, *wanted = s->raw.identity.text;
  DEA_TRY(ctx, dea_scpi_query(ctx, &s->link, s->raw.timeout_s.si, "*IDN?", &response));
  if (response == NULL) {
    return dea_scpi_no_response(ctx, s, "*IDN?", s->raw.timeout_s.si);
  }
  if (!dea_scpi_is_same(&s->raw, "", response)) {
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s is a '%.120s', not a '%.60s'; look at its address",
                    s->name, response, wanted);
  }
  snprintf(s->base.mark, sizeof s->base.mark, "%.*s", (int)sizeof s->base.mark - 1, response);
  return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0}, "%s is a '%.120s'", s->name,
                         response);
}

static dea_status set_up(struct dea_context *ctx, struct dea_scpi *s)
{
  bool plays = (s->base.roles & DEA_PLAYS_OUTPUT) != 0;
  double timeout_s = s->raw.timeout_s.si;
  DEA_TRY(ctx, identify(ctx, s));
  if (plays) { // the setup may switch on what was set before
    char zero[DEA_SCPI_COMMAND_SIZE];
    dea_scpi_output_command(&s->raw, 0, zero);
    DEA_TRY(ctx, dea_scpi_send(ctx, &s->link, timeout_s, zero));
  }
  DEA_TRY(ctx, dea_scpi_send(ctx, &s->link, timeout_s, "*CLS"));
  for (size_t i = 0; i < s->raw.setup_count; i++) {
    DEA_TRY(ctx, dea_scpi_send(ctx, &s->link, timeout_s, s->raw.setup[i].text));
  }
  DEA_TRY(ctx, plays ? dea_scpi_output_open(ctx, s) : DEA_OK);
  return plays || s->raw.setup_count > 0 ? check_error(ctx, s) : DEA_OK;
}

static void close_it(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct dea_scpi *s = (struct dea_scpi *)instrument;
  dea_socket_close(&s->link.socket);
  if (s->claim >= 0) {
    close(s->claim);
  }
  dea_timed_end(ctx, &s->output);
  dea_free(ctx, s);
}

/* A supply may have several names, and take several connections. */
static dea_status claim(struct dea_context *ctx, struct dea_scpi *s)
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

static dea_status open_it(struct dea_context *ctx, const void *data,
                          const struct dea_protocol *protocol, struct dea_instrument **out)
{
  struct dea_scpi *s = dea_alloc(ctx, 1, sizeof *s);
  DEA_TRY_MEMORY(s != NULL);
  s->raw = *(const struct dea_scpi_raw *)data;
  s->base.type = &dea_instrument_scpi;
  s->base.roles = (s->raw.reading_count > 0 ? DEA_GIVES_READINGS : 0U) |
                  (s->raw.output.origin != DEA_ABSENT ? DEA_PLAYS_OUTPUT : 0U);
  for (size_t i = 0; i < s->raw.reading_count; i++) {
    const struct dea_scpi_raw_reading *r = &s->raw.readings[i];
    dea_instrument_add_reading(&s->base, &r->name, &r->quantity, &r->unit);
  }
  s->protocol = protocol;
  s->start_s = NAN;
  s->link.socket.descriptor = s->claim = -1;
  dea_status status = DEA_OK;
  if ((s->base.roles & DEA_PLAYS_OUTPUT) != 0) {
    status = dea_scpi_output_begin(ctx, s);
  }
  if (status == DEA_OK) {
    status = dea_scpi_connect(ctx, &s->raw, "", s->raw.timeout_s.si, &s->link);
  }
  if (status == DEA_OK) {
    snprintf(s->name, sizeof s->name, "%s", s->link.socket.name);
    memcpy(s->base.host, s->link.socket.host, sizeof s->base.host);
    status = claim(ctx, s);
    status = status == DEA_OK ? set_up(ctx, s) : status;
  }
  if (status != DEA_OK) {
    status =
        s->link.socket.descriptor >= 0 ? dea_instrument_abandon(ctx, &s->base, status) : status;
    close_it(ctx, &s->base);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = &s->base;
  return DEA_OK;
}

static void address(const void *data, char *out, size_t size)
{
  const struct dea_scpi_raw *raw = data;
  if (raw->output.origin != DEA_ABSENT) {
    snprintf(out, size, "%s %d", raw->address.text, (int)raw->port.si);
  }
}

static dea_status start_scpi(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct dea_scpi *s = (struct dea_scpi *)instrument;
  s->start_s = dea_clock_s();
  s->schedule.count = s->raw.reading_count;
  s->schedule.interval_s = s->raw.interval_s.si;
  s->schedule.timeout_s = s->raw.timeout_s.si;
  dea_poll_schedule_start(&s->schedule, s->start_s);
  return s->output.queue != NULL ? dea_scpi_output_start(ctx, s) : DEA_OK;
}

static void set_clock(struct dea_instrument *instrument)
{
  ((struct dea_scpi *)instrument)->start_s = dea_clock_s();
}

static dea_status set_outputs(struct dea_context *ctx, struct dea_instrument *instrument,
                              const double *volts, size_t count)
{
  return dea_scpi_output_set(ctx, (struct dea_scpi *)instrument, volts, count);
}

/* The SI value of a response with a unit; *fits: that is one of the reading's quantity. */
static dea_status convert(struct dea_context *ctx, const struct dea_scpi *s, size_t reading,
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
static dea_status scale(struct dea_context *ctx, struct dea_scpi *s, size_t reading,
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
static dea_status refuse(struct dea_context *ctx, struct dea_scpi *s, size_t reading,
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
static dea_status read_response(struct dea_context *ctx, struct dea_scpi *s, const char *response,
                                const struct dea_sink *sink)
{
  size_t reading = s->schedule.reading;
  double value, now_s = dea_clock_s();
  if (s->asked == DEA_SCPI_NOTHING) {
    return dea_line_alone(ctx, &s->link, NULL, response, strlen(response));
  }
  if (s->asked != DEA_SCPI_READING) {
    return dea_scpi_output_response(ctx, s, response);
  }
  const struct dea_scpi_raw_reading *r = &s->raw.readings[reading];
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
  s->asked = DEA_SCPI_NOTHING;
  // It was measured between question and response.
  return sink->reading(sink->user, reading, 0.5 * (s->asked_s + now_s) - s->start_s,
                       value + r->offset.si);
}

/* Asks for the reading that is due, if any and nothing is waited for; *next_s: when one will be. */
static dea_status query_next(struct dea_context *ctx, struct dea_scpi *s, double *next_s)
{
  double now_s = dea_clock_s();
  *next_s = INFINITY;
  if (s->asked == DEA_SCPI_READING) {
    const char *query = s->raw.readings[s->schedule.reading].query.text;
    *next_s = s->asked_s + s->raw.timeout_s.si;
    return now_s < *next_s ? DEA_OK : dea_scpi_no_response(ctx, s, query, s->raw.timeout_s.si);
  }
  if (s->asked != DEA_SCPI_NOTHING || !dea_poll_schedule_next(&s->schedule, now_s, next_s)) {
    return DEA_OK;
  }
  s->asked = DEA_SCPI_READING;
  s->asked_s = now_s;
  return dea_scpi_question(ctx, &s->link, s->raw.timeout_s.si,
                           s->raw.readings[s->schedule.reading].query.text);
}

static dea_status get(struct dea_context *ctx, struct dea_instrument *instrument, double timeout_s,
                      const struct dea_sink *sink)
{
  struct dea_scpi *s = (struct dea_scpi *)instrument;
  double until_s = dea_clock_s() + timeout_s, left_s;
  bool came = false;
  do {
    char bytes[1024];
    size_t length, dropped = s->link.lines.dropped;
    double play_s, ask_s;
    const char *at = bytes, *response;
    DEA_TRY(ctx, dea_scpi_output_play(ctx, s, &play_s));
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
    .raw_size = sizeof(struct dea_scpi_raw),
    .roles = DEA_PLAYS_OUTPUT | DEA_GIVES_READINGS,
    .check = check,
    .open = open_it,
    .start = start_scpi,
    .set_clock = set_clock,
    .put = set_outputs,
    .get = get,
    .hold = dea_scpi_output_hold,
    .stop = dea_scpi_stop,
    .address = address,
    .zero = dea_scpi_zero,
    .close = close_it,
};
