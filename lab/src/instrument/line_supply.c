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

/* Waits for a line, byte by byte, so that none behind it is lost; NULL: none in time. */
static dea_status wait_line(struct dea_context *ctx, struct dea_line_link *link, double until_s,
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

static dea_status send_line(struct dea_context *ctx, const struct dea_line_link *link,
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
  DEA_TRY(ctx, send_line(ctx, &s->link, s->raw.behind_s.si, command));
  DEA_TRY(ctx, wait_line(ctx, &s->link, dea_clock_s() + s->raw.behind_s.si, &line));
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
    DEA_TRY(ctx, send_line(ctx, &s->link, s->raw.behind_s.si, sync));
    double ask_s = fmin(now_s + fmax(again_s, s->raw.behind_s.si), until_s);
    do {
      DEA_TRY(ctx, wait_line(ctx, &s->link, ask_s, &line));
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

dea_status dea_line_supply_open(struct dea_context *ctx, struct dea_instrument *instrument,
                                const struct dea_line_supply_language *language, const void *raw,
                                const struct dea_protocol *protocol)
{
  static const struct dea_choice voltage = {.value = DEA_CHANNEL_VOLTAGE};
  static const struct dea_label no_unit;
  struct dea_line_supply *s = (struct dea_line_supply *)instrument;
  s->raw = *(const struct dea_line_supply_raw *)raw;
  s->raw_all = raw;
  s->language = language;
  s->protocol = protocol;
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
  DEA_TRY(ctx, dea_timed_begin(ctx, &s->output));
  DEA_TRY(ctx, dea_serial_open(ctx, language->what, s->raw.device.text, (int)s->raw.baud.si, 0,
                               &s->link.socket));
  s->base.reached = true;
  DEA_TRY(ctx, set_up(ctx, s));
  s->raw_all = NULL;
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
  s->base.start_s = dea_clock_s();
  dea_timed_start(&s->output, s->base.start_s);
  return DEA_OK;
}

// Playing ----------------------------------------------------------------------------------------

static dea_status query(struct dea_context *ctx, struct dea_line_supply *s,
                        enum dea_line_supply_question what, const char *command)
{
  s->asked = what;
  s->asked_s = dea_clock_s();
  dea_status status = send_line(ctx, &s->link, s->raw.behind_s.si, command);
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
    s->pending[s->pending_count].time_s = 0.5 * (s->asked_s + dea_clock_s()) - s->base.start_s;
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
  DEA_TRY(ctx, wait_line(ctx, &s->link, fmin(next_s, until_s), &answer));
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

// To 0 V ------------------------------------------------------------------------------------------

/* How a supply on a serial line is brought to 0 V, and what is known of it then.
 *
 * 0 V is set and the output switched off, each command behind the answer to the one before, or
 * without one where none comes; then its voltage is read back until it has been at 0 V for
 * `behind`. Nothing that it says is believed but behind a new answer to `sync`. Where that does not
 * come all begins anew on another connection, until the time is over. Where the line itself has
 * gone, or somebody else had opened it, what answers at its name may be another supply: it is told
 * 0 V too, which hurts nobody, but only one with the mark of this one is believed. Where another
 * program has the line it is waited for; one that keeps it may set another voltage a moment later,
 * and may have taken any answer: then 0 V is commanded, and nothing is believed. */

static const double poll_s = 0.05, anew_s = 0.1;
/* Of the time left: how long an answer is waited for, so that there is time for another try. */
static const double share = 0.2;

struct zeroing {
  struct dea_line_link *link;
  const struct dea_line_supply_language *language;
  const struct dea_line_supply_raw *raw;
  const void *named; // of the kind, with the name that it must have; NULL: not looked at
  const struct dea_protocol *protocol;
  double until_s;
  bool doubted;                    // another supply may have the line's name
  bool told;                       // that another one may be there
  struct dea_instrument_past past; // of the supply that was used
};

static double wait_until(const struct zeroing *z)
{
  double now_s = dea_clock_s();
  return now_s + fmin(z->raw->behind_s.si, share * fmax(z->until_s - now_s, 0));
}

/* The same while it is read back: where there is no time for another try, all that is left. */
static double read_until(const struct zeroing *z)
{
  return z->until_s - dea_clock_s() > z->raw->behind_s.si ? wait_until(z) : z->until_s;
}

/* Whatever it answers, or not. False: nothing can be sent. */
static bool command(struct dea_context *ctx, const struct zeroing *z, const char *text)
{
  const char *answer;
  double until_s = wait_until(z);
  return send_line(ctx, z->link, fmax(until_s - dea_clock_s(), 0), text) == DEA_OK &&
         wait_line(ctx, z->link, until_s, &answer) == DEA_OK;
}

static bool command_zero(struct dea_context *ctx, const struct zeroing *z)
{
  char text[DEA_LINE_SUPPLY_COMMAND_SIZE];
  snprintf(text, sizeof text, "%s0", z->language->set);
  bool sent = command(ctx, z, ""); // ends what may stand in its buffer
  sent = command(ctx, z, text) && sent;
  for (size_t i = 0; z->language->off[i] != NULL; i++) {
    sent = command(ctx, z, z->language->off[i]) && sent;
  }
  return sent;
}

/* Says once that another supply may be there. */
static void report(struct dea_context *ctx, struct zeroing *z, const char *answer)
{
  if (!z->told) {
    (void)dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                          "%s answers '%.60s', which the supply that is meant would not: it may be "
                          "another one; it was told 0 V too, and is not believed",
                          z->link->socket.name, answer);
  }
  z->told = true;
}

/* Its voltage now. False: it does not answer, or nothing that can be believed. */
static bool ask_voltage(struct dea_context *ctx, struct zeroing *z, double *volts)
{
  const char *answer;
  double until_s = read_until(z);
  if (send_line(ctx, z->link, poll_s, z->language->sync) != DEA_OK) {
    return false;
  }
  do { // older answers come first
    if (wait_line(ctx, z->link, until_s, &answer) != DEA_OK || answer == NULL) {
      return false;
    }
  } while (!z->language->is_synced(answer));
  if (z->named != NULL && z->language->is_named != NULL &&
      !z->language->is_named(z->named, answer)) {
    report(ctx, z, answer);
    return false;
  }
  return send_line(ctx, z->link, poll_s, z->language->measure) == DEA_OK &&
         wait_line(ctx, z->link, read_until(z), &answer) == DEA_OK && answer != NULL &&
         !z->language->is_error(answer) && z->language->voltage(answer, volts);
}

/* Reads the voltage back until it stays at 0 V or the time is over, then with why that is not
 * known. False: it does not answer. */
static bool read_back(struct dea_context *ctx, struct zeroing *z, struct dea_zero *zero)
{
  double since_s = NAN;
  while (dea_clock_s() < z->until_s) {
    double asked_s = dea_clock_s(), volts;
    if (!ask_voltage(ctx, z, &volts)) {
      return false;
    }
    zero->volts = volts / z->protocol->amplifier.gain.si;
    if (!(fabs(volts) <= z->protocol->safety.at_zero_V.si)) {
      since_s = NAN;
    } else if (isnan(since_s)) {
      since_s = asked_s;
    } else if (asked_s - since_s >= z->raw->behind_s.si) {
      zero->state = DEA_ZERO_READ_BACK;
      return true;
    }
    dea_clock_wait(poll_s);
  }
  zero->why = isnan(since_s) ? NULL : dea_zero_not_for_long;
  return true;
}

/* Whether it is the supply that was used. Of one whose line has never gone that is so. */
static bool is_same(struct dea_context *ctx, struct zeroing *z)
{
  char line[DEA_INSTRUMENT_MARK_SIZE];
  const char *answer = line;
  if (!z->doubted || z->past.mark[0] == '\0') {
    return !z->doubted;
  }
  if (z->language->mark == NULL) {
    dea_serial_mark(&z->link->socket, line, sizeof line);
  } else if (send_line(ctx, z->link, poll_s, z->language->mark) != DEA_OK ||
             wait_line(ctx, z->link, wait_until(z), &answer) != DEA_OK || answer == NULL) {
    return false;
  }
  bool same = strcmp(answer, z->past.mark) == 0;
  if (!same) {
    report(ctx, z, answer);
  }
  return same;
}

/* Says that another program has the line, too: once, as nothing else can be done then. */
static void report_other_device(struct dea_context *ctx, const struct dea_socket *line, long holder)
{
  char text[DEA_SERIAL_HOLDER_SIZE];
  dea_serial_holder_text(holder, text);
  (void)dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                        "%s is in use by %s, which may set another voltage: it was told 0 V, and "
                        "nothing that it says is believed; end that one",
                        line->name, text);
}

/* On connections of its own, until one has said something or the time is over. */
static struct dea_zero zero_anew(struct dea_context *ctx, struct zeroing *z)
{
  struct dea_zero zero = {DEA_ZERO_UNKNOWN, NAN, dea_zero_no_answer};
  struct dea_serial_turn turn = {.wait_s = z->past.wait_s, .program = z->past.program};
  bool told = false;
  while (!told && dea_clock_s() < z->until_s) {
    struct dea_line_link link = {.socket.descriptor = -1};
    double began_s = dea_clock_s();
    z->link = &link;
    if (dea_serial_open_in_turn(ctx, z->language->what, z->raw->device.text, (int)z->raw->baud.si,
                                0, &turn, &link.socket) == DEA_OK) {
      double waited_s = dea_clock_s() - began_s;
      z->until_s += waited_s; // its time begins with its turn
      turn.wait_s -= waited_s;
      told = command_zero(ctx, z) && (turn.beside || (is_same(ctx, z) && read_back(ctx, z, &zero)));
      if (turn.beside) {
        report_other_device(ctx, &link.socket, turn.holder);
        zero.why = dea_zero_other;
      }
      dea_socket_close(&link.socket);
    }
    z->link = NULL;
    if (!told) {
      dea_clock_wait(fmin(anew_s, fmax(z->until_s - dea_clock_s(), 0)));
    }
  }
  return zero;
}

struct dea_zero dea_line_supply_stop(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct dea_line_supply *s = (struct dea_line_supply *)instrument;
  struct dea_zero zero = {DEA_ZERO_UNKNOWN, NAN, NULL};
  struct zeroing z = {.link = &s->link,
                      .language = s->language,
                      .raw = &s->raw,
                      .protocol = s->protocol,
                      .until_s = dea_clock_s() + s->protocol->safety.zero_time_s.si,
                      .past = {s->base.mark, 0, s->protocol->safety.zero_time_s.si, "", NULL}};
  bool told = false;
  if (s->link.socket.descriptor >= 0) {
    const char *answer;
    if (s->asked != DEA_LINE_SUPPLY_NOTHING) { // the answer to what was asked before
      wait_line(ctx, z.link, wait_until(&z), &answer);
    }
    told = command_zero(ctx, &z) && read_back(ctx, &z, &zero);
    z.doubted = dea_socket_is_lost(&s->link.socket);
    dea_socket_close(&s->link.socket);
  }
  zero = told ? zero : zero_anew(ctx, &z);
  return dea_zero_believe(zero, dea_evidence_doubt(&s->output.evidence));
}

struct dea_zero dea_line_supply_zero(struct dea_context *ctx,
                                     const struct dea_line_supply_language *language,
                                     const void *data, const struct dea_protocol *protocol,
                                     const struct dea_instrument_past *past)
{
  struct zeroing z = {.language = language,
                      .raw = data,
                      .named = data,
                      .protocol = protocol,
                      .until_s = dea_clock_s() + protocol->safety.zero_time_s.si,
                      .doubted = past->mark[0] != '\0',
                      .past = *past};
  return zero_anew(ctx, &z);
}
