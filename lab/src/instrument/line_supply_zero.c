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
#include "base/clock.h"
#include "instrument/line_supply.h"
#include "instrument/serial.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double poll_s = 0.05, again_s = 0.1;
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
  return dea_line_supply_send(ctx, z->link, fmax(until_s - dea_clock_s(), 0), text) == DEA_OK &&
         dea_line_supply_wait(ctx, z->link, until_s, &answer) == DEA_OK;
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
static bool read_voltage(struct dea_context *ctx, struct zeroing *z, double *volts)
{
  const char *answer;
  double until_s = read_until(z);
  if (dea_line_supply_send(ctx, z->link, poll_s, z->language->sync) != DEA_OK) {
    return false;
  }
  do { // older answers come first
    if (dea_line_supply_wait(ctx, z->link, until_s, &answer) != DEA_OK || answer == NULL) {
      return false;
    }
  } while (!z->language->is_synced(answer));
  if (z->named != NULL && z->language->is_named != NULL &&
      !z->language->is_named(z->named, answer)) {
    report(ctx, z, answer);
    return false;
  }
  return dea_line_supply_send(ctx, z->link, poll_s, z->language->measure) == DEA_OK &&
         dea_line_supply_wait(ctx, z->link, read_until(z), &answer) == DEA_OK && answer != NULL &&
         !z->language->is_error(answer) && z->language->voltage(answer, volts);
}

/* Reads the voltage back until it stays at 0 V or the time is over, then with why that is not
 * known. False: it does not answer. */
static bool read_back(struct dea_context *ctx, struct zeroing *z, struct dea_zero *zero)
{
  double since_s = NAN;
  while (dea_clock_s() < z->until_s) {
    double asked_s = dea_clock_s(), volts;
    if (!read_voltage(ctx, z, &volts)) {
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
  } else if (dea_line_supply_send(ctx, z->link, poll_s, z->language->mark) != DEA_OK ||
             dea_line_supply_wait(ctx, z->link, wait_until(z), &answer) != DEA_OK ||
             answer == NULL) {
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
      dea_clock_wait(fmin(again_s, fmax(z->until_s - dea_clock_s(), 0)));
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
      dea_line_supply_wait(ctx, z.link, wait_until(&z), &answer);
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
