/* Instrument "scpi": what answers SCPI on a TCP port, such as an electrometer, a force display or a
 * laboratory supply. Its readings are queries, asked one after the other at their interval; its
 * output is a command with a number in it, sent by the computer's clock. */
#include "base/schema_value.h"
#include "lab/instrument/clock.h"
#include "lab/instrument/instrument_make.h"
#include "lab/instrument/line_reader.h"
#include "lab/instrument/scpi_parse.h"
#include "lab/instrument/socket.h"

#include <stdio.h>
#include <string.h>

enum { COMMANDS_MAX = 16, COMMAND_SIZE = DEA_TITLE_SIZE + 40 };

struct raw_reading {
  struct dea_label name, query, unit;
  struct dea_choice quantity;
  struct dea_quantity factor, offset;
};

struct raw {
  struct dea_label kind, address, identity, output;
  struct dea_quantity port, timeout_s, interval_s, output_factor, output_interval_s, queue_s;
  struct dea_label setup[COMMANDS_MAX], at_stop[COMMANDS_MAX];
  size_t setup_count, at_stop_count;
  struct raw_reading readings[DEA_INSTRUMENT_READINGS_MAX];
  size_t reading_count;
};

static const struct dea_field reading_fields[] = {
    DEA_INSTRUMENT_LABEL(struct raw_reading, name, "name", "name of its channel", "leakage",
                         .required = true),
    DEA_INSTRUMENT_LABEL(struct raw_reading, query, "query",
                         "question that it answers with a number", "MEAS:CURR?", .required = true),
    DEA_INSTRUMENT_QUANTITY(struct raw_reading, quantity),
    {.key = "factor",
     .kind = DEA_FIELD_NUMBER,
     .offset = offsetof(struct raw_reading, factor),
     .unit = "1",
     .default_text = "1",
     .doc = "SI value of 1 of what it answers; 1e-3 where it answers in mN",
     .example = "1e-3"},
    {.key = "offset",
     .kind = DEA_FIELD_NUMBER,
     .offset = offsetof(struct raw_reading, offset),
     .unit = "1",
     .default_text = "0",
     .doc = "added to it afterwards, in SI",
     .example = "0"},
    DEA_INSTRUMENT_LABEL(struct raw_reading, unit, "unit", "SI unit of an 'other' quantity", "K",
                         .absent_text = "none"),
};
static const struct dea_record reading_record = {
    "reading", "a value that is asked for", reading_fields, DEA_INSTRUMENT_COUNT(reading_fields)};

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
    {.key = "output_factor",
     .kind = DEA_FIELD_NUMBER,
     .offset = offsetof(struct raw, output_factor),
     .unit = "1",
     .default_text = "1",
     .doc =
         "what is sent for 1 V of control voltage; of a high-voltage supply that is set in V, the "
         "amplifier's gain",
     .example = "1000"},
    DEA_INSTRUMENT_TIME(struct raw, output_interval_s, "output_interval",
                        "shortest time between two commands of the output", "20 ms", 60),
    DEA_INSTRUMENT_TIME(struct raw, queue_s, "queue", "of the output that is held ready", "0.25 s",
                        60),
};
const struct dea_record dea_instrument_scpi_record = {
    "scpi", "answers or plays by SCPI on a TCP port", fields, DEA_INSTRUMENT_COUNT(fields)};

struct scpi {
  struct dea_instrument base;
  struct raw raw;
  struct dea_socket socket;
  struct dea_line_reader lines;
  char name[DEA_SOCKET_NAME_SIZE + 8];
  double start_s;                            // computer's clock at start; NAN before
  double due_s[DEA_INSTRUMENT_READINGS_MAX]; // of the readings, on the computer's clock
  /* What stood behind the first number of each: its unit, which must stay; valid when `known`. */
  char suffix[DEA_INSTRUMENT_READINGS_MAX][DEA_SCPI_SUFFIX_SIZE];
  bool known[DEA_INSTRUMENT_READINGS_MAX], noted_suffix;
  size_t asked; // reading that is waited for; reading_count: none
  double asked_s;
  double rate_Hz; // of the output
  double *queue;  // [room], a ring; owned
  size_t room, first, count;
  size_t played;          // samples taken out of the queue since the start
  double wanted_V, set_V; // what the output should be, and is
  double set_s;           // when it was set
};

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
  if (raw->output.origin == DEA_ABSENT) {
    return raw->reading_count > 0
               ? DEA_OK
               : dea_schema_error(reader, raw->kind.location,
                                  "it neither reads nor plays: write 'readings' or 'output'");
  }
  const char *hole = strchr(raw->output.text, '%');
  if (hole == NULL || hole[1] != 'g' || strchr(hole + 1, '%') != NULL) {
    return dea_schema_error(reader, raw->output.location,
                            "the output's command must have one %%g where the voltage in V goes, "
                            "and no other %%; write for example 'SOUR:VOLT %%g'");
  }
  return DEA_OK;
}

/* The output's command with a voltage in it; numbers are written with a point in any locale. */
static void output_command(const struct raw *raw, double volts, char out[COMMAND_SIZE])
{
  char number[32];
  const char *hole = strchr(raw->output.text, '%');
  snprintf(number, sizeof number, "%.9g", volts * raw->output_factor.si);
  char *comma = strchr(number, ',');
  if (comma != NULL) {
    *comma = '.';
  }
  snprintf(out, COMMAND_SIZE, "%.*s%s%s\n", (int)(hole - raw->output.text), raw->output.text,
           number, hole + 2);
}

static dea_status command(struct dea_context *ctx, struct scpi *s, const char *text)
{
  char line[COMMAND_SIZE];
  int length = snprintf(line, sizeof line, "%s\n", text);
  return dea_socket_write(ctx, &s->socket, s->raw.timeout_s.si, line, (size_t)length);
}

/* Sends a question and waits for its answer, *out, lent until the next; NULL: none in time. */
static dea_status ask(struct dea_context *ctx, struct scpi *s, const char *question,
                      const char **out)
{
  char bytes[1024];
  double until_s = dea_clock_s() + s->raw.timeout_s.si;
  *out = NULL;
  DEA_TRY(ctx, command(ctx, s, question));
  for (double left_s = s->raw.timeout_s.si; left_s > 0 && *out == NULL;) {
    size_t length;
    const char *at = bytes;
    DEA_TRY(ctx, dea_socket_read(ctx, &s->socket, left_s, bytes, sizeof bytes, &length));
    *out = dea_line_next(&s->lines, &at, &length); // nobody speaks unasked
    left_s = until_s - dea_clock_s();
    if (dea_interrupted(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted");
    }
  }
  return DEA_OK;
}

static dea_status no_answer(struct dea_context *ctx, const struct scpi *s, const char *question)
{
  return dea_fail(ctx, DEA_E_INSTRUMENT,
                  "%s did not answer '%.100s' within %g s; look at whether it knows that question",
                  s->name, question, s->raw.timeout_s.si);
}

/* Whether it took its setup: looks at its error queue, which was empty before. */
static dea_status look_for_error(struct dea_context *ctx, struct scpi *s)
{
  const char *answer, *text;
  int code;
  DEA_TRY(ctx, ask(ctx, s, "SYST:ERR?", &answer));
  if (answer == NULL || !dea_scpi_error(answer, &code, &text)) {
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
  const char *answer, *wanted = s->raw.identity.text;
  DEA_TRY(ctx, ask(ctx, s, "*IDN?", &answer));
  if (answer == NULL) {
    return no_answer(ctx, s, "*IDN?");
  }
  if (strstr(answer, wanted) == NULL) {
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s is a '%.120s', not a '%.60s'; look at its address",
                    s->name, answer, wanted);
  }
  return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0}, "%s is a '%.120s'", s->name,
                         answer);
}

static dea_status set_output(struct dea_context *ctx, struct scpi *s, double volts)
{
  char line[COMMAND_SIZE];
  output_command(&s->raw, volts, line);
  DEA_TRY(ctx, dea_socket_write(ctx, &s->socket, s->raw.timeout_s.si, line, strlen(line)));
  s->set_V = volts;
  s->set_s = dea_clock_s();
  return DEA_OK;
}

static dea_status set_up(struct dea_context *ctx, struct scpi *s)
{
  bool plays = (s->base.roles & DEA_PLAYS_OUTPUT) != 0;
  DEA_TRY(ctx, identify(ctx, s));
  DEA_TRY(ctx, command(ctx, s, "*CLS"));
  for (size_t i = 0; i < s->raw.setup_count; i++) {
    DEA_TRY(ctx, command(ctx, s, s->raw.setup[i].text));
  }
  if (plays) {
    DEA_TRY(ctx, set_output(ctx, s, 0));
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                 "%s plays by the computer's clock, at most %.3g voltages a second",
                                 s->name, 1 / s->raw.output_interval_s.si));
  }
  return plays || s->raw.setup_count > 0 ? look_for_error(ctx, s) : DEA_OK;
}

static void stop(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct scpi *s = (struct scpi *)instrument;
  char line[COMMAND_SIZE];
  (void)ctx;
  if ((s->base.roles & DEA_PLAYS_OUTPUT) != 0) {
    output_command(&s->raw, 0, line);
    dea_socket_write_if_possible(&s->socket, line, strlen(line));
  }
  for (size_t i = 0; i < s->raw.at_stop_count; i++) {
    int length = snprintf(line, sizeof line, "%s\n", s->raw.at_stop[i].text);
    dea_socket_write_if_possible(&s->socket, line, (size_t)length);
  }
}

static void close_it(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct scpi *s = (struct scpi *)instrument;
  dea_socket_close(&s->socket);
  dea_free(ctx, s->queue);
  dea_free(ctx, s);
}

static dea_status open_it(struct dea_context *ctx, const void *data,
                          const struct dea_protocol *protocol, struct dea_instrument **out)
{
  struct scpi *s = dea_alloc(ctx, 1, sizeof *s);
  if (s == NULL) {
    return DEA_E_MEMORY;
  }
  s->raw = *(const struct raw *)data;
  s->base.type = &dea_instrument_scpi;
  s->base.roles = (s->raw.reading_count > 0 ? DEA_GIVES_READINGS : 0U) |
                  (s->raw.output.origin != DEA_ABSENT ? DEA_PLAYS_OUTPUT : 0U);
  for (size_t i = 0; i < s->raw.reading_count; i++) {
    const struct raw_reading *r = &s->raw.readings[i];
    dea_instrument_add_reading(&s->base, &r->name, &r->quantity, &r->unit);
  }
  s->asked = s->raw.reading_count;
  s->start_s = NAN;
  s->socket.descriptor = -1;
  dea_status status = DEA_OK;
  if ((s->base.roles & DEA_PLAYS_OUTPUT) != 0) {
    s->rate_Hz = protocol->rate_Hz.si;
    s->room = (size_t)(s->raw.queue_s.si * s->rate_Hz) + 1;
    s->queue = dea_alloc(ctx, s->room, sizeof *s->queue);
    status = s->queue != NULL ? DEA_OK : DEA_E_MEMORY;
  }
  if (status == DEA_OK) {
    status = dea_socket_connect(ctx, "the instrument", s->raw.address.text, (int)s->raw.port.si,
                                s->raw.timeout_s.si, &s->socket);
  }
  if (status == DEA_OK) {
    snprintf(s->name, sizeof s->name, "%s", s->socket.name);
    status = set_up(ctx, s);
  }
  if (status != DEA_OK) {
    stop(ctx, &s->base);
    close_it(ctx, &s->base);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = &s->base;
  return DEA_OK;
}

static dea_status start(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct scpi *s = (struct scpi *)instrument;
  (void)ctx;
  s->start_s = dea_clock_s();
  for (size_t i = 0; i < s->raw.reading_count; i++) {
    s->due_s[i] = s->start_s;
  }
  return DEA_OK;
}

/* Takes the samples whose time has come out of the queue, and sends the last of them unless that
 * would be too early after the one before. *next_s: clock at which there is something to do. */
static dea_status play(struct dea_context *ctx, struct scpi *s, double *next_s)
{
  double now_s = dea_clock_s();
  *next_s = INFINITY;
  if (s->queue == NULL || isnan(s->start_s)) {
    return DEA_OK;
  }
  while (s->count > 0 && s->start_s + (double)s->played / s->rate_Hz <= now_s) {
    s->wanted_V = s->queue[s->first];
    s->first = (s->first + 1) % s->room;
    s->count--;
    s->played++;
  }
  if (s->wanted_V != s->set_V) {
    if (now_s >= s->set_s + s->raw.output_interval_s.si) {
      return set_output(ctx, s, s->wanted_V);
    }
    *next_s = s->set_s + s->raw.output_interval_s.si;
  } else if (s->count > 0) {
    *next_s = s->start_s + (double)s->played / s->rate_Hz;
  }
  return DEA_OK;
}

static dea_status put(struct dea_context *ctx, struct dea_instrument *instrument,
                      const double *volts, size_t count)
{
  struct scpi *s = (struct scpi *)instrument;
  for (size_t i = 0; i < count; i++) {
    while (s->count == s->room) {
      double next_s;
      if (isnan(s->start_s)) {
        return dea_fail(ctx, DEA_E_ARGUMENT, "more than %zu samples before the start", s->room);
      }
      DEA_TRY(ctx, play(ctx, s, &next_s));
      if (s->count == s->room) {
        dea_clock_wait(s->start_s + (double)s->played / s->rate_Hz - dea_clock_s());
      }
    }
    s->queue[(s->first + s->count++) % s->room] = volts[i];
  }
  double next_s;
  return play(ctx, s, &next_s);
}

/* Whether an answer's unit, or state, is that of the first one. One that changes its range from mN
 * to N would be wrong by a thousand, one that says overflow by anything. */
static dea_status check_suffix(struct dea_context *ctx, struct scpi *s, size_t reading,
                               const char *answer, bool *same)
{
  char suffix[DEA_SCPI_SUFFIX_SIZE];
  dea_scpi_suffix(answer, suffix);
  if (!s->known[reading]) {
    memcpy(s->suffix[reading], suffix, sizeof suffix);
    s->known[reading] = true;
  }
  *same = strcmp(suffix, s->suffix[reading]) == 0;
  if (*same || s->noted_suffix) {
    return DEA_OK;
  }
  s->noted_suffix = true;
  return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                         "%s answered '%.60s' to '%.60s', where '%s' stood behind the number "
                         "before: such answers are left out; fix its range",
                         s->name, answer, s->raw.readings[reading].query.text, s->suffix[reading]);
}

/* An answer: the value of the reading that was asked for. */
static dea_status take_answer(struct dea_context *ctx, struct scpi *s, const char *answer,
                              const struct dea_intake *intake)
{
  size_t reading = s->asked;
  double value, now_s = dea_clock_s();
  if (reading == s->raw.reading_count) {
    s->base.lost++; // nothing was asked
    return DEA_OK;
  }
  bool good = dea_scpi_number(answer, &value);
  if (good && !isnan(value)) {
    DEA_TRY(ctx, check_suffix(ctx, s, reading, answer, &good));
  }
  if (!good) {
    value = NAN;
    s->base.lost++;
  }
  const struct raw_reading *r = &s->raw.readings[reading];
  s->asked = s->raw.reading_count;
  // It was measured between question and answer.
  return intake->reading(intake->user, reading, 0.5 * (s->asked_s + now_s) - s->start_s,
                         value * r->factor.si + r->offset.si);
}

/* Asks for the reading that is due, if any and nothing is waited for; *next_s: when one will be. */
static dea_status ask_next(struct dea_context *ctx, struct scpi *s, double *next_s)
{
  size_t first = 0;
  double now_s = dea_clock_s();
  if (s->asked < s->raw.reading_count) {
    *next_s = s->asked_s + s->raw.timeout_s.si;
    return now_s < *next_s ? DEA_OK : no_answer(ctx, s, s->raw.readings[s->asked].query.text);
  }
  *next_s = INFINITY;
  if (s->raw.reading_count == 0) {
    return DEA_OK;
  }
  for (size_t i = 1; i < s->raw.reading_count; i++) {
    first = s->due_s[i] < s->due_s[first] ? i : first;
  }
  if (s->due_s[first] > now_s) {
    *next_s = s->due_s[first];
    return DEA_OK;
  }
  s->asked = first;
  s->asked_s = now_s;
  // One that takes longer than the interval is asked again at once, not for what was missed.
  double due_s = s->due_s[first] + s->raw.interval_s.si;
  s->due_s[first] = due_s > now_s ? due_s : now_s;
  *next_s = now_s + s->raw.timeout_s.si;
  return command(ctx, s, s->raw.readings[first].query.text);
}

static dea_status get(struct dea_context *ctx, struct dea_instrument *instrument, double timeout_s,
                      const struct dea_intake *intake)
{
  struct scpi *s = (struct scpi *)instrument;
  double until_s = dea_clock_s() + timeout_s, left_s;
  bool came = false;
  do {
    char bytes[1024];
    size_t length, dropped = s->lines.dropped;
    double play_s, ask_s;
    const char *at = bytes, *answer;
    DEA_TRY(ctx, play(ctx, s, &play_s));
    DEA_TRY(ctx, ask_next(ctx, s, &ask_s));
    double next_s = fmin(until_s, fmin(play_s, ask_s));
    DEA_TRY(ctx,
            dea_socket_read(ctx, &s->socket, next_s - dea_clock_s(), bytes, sizeof bytes, &length));
    while ((answer = dea_line_next(&s->lines, &at, &length)) != NULL) {
      came = true;
      DEA_TRY(ctx, take_answer(ctx, s, answer, intake));
    }
    if (s->lines.dropped > dropped) {
      DEA_TRY(ctx, take_answer(ctx, s, "", intake)); // what came makes no sense
    }
    left_s = until_s - dea_clock_s();
  } while (!came && left_s > 0);
  return DEA_OK;
}

const struct dea_instrument_type dea_instrument_scpi = {
    .name = "scpi",
    .record = &dea_instrument_scpi_record,
    .raw_size = sizeof(struct raw),
    .roles = DEA_PLAYS_OUTPUT | DEA_GIVES_READINGS,
    .check = check,
    .open = open_it,
    .start = start,
    .put = put,
    .get = get,
    .stop = stop,
    .close = close_it,
};
