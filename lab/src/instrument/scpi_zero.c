#define _POSIX_C_SOURCE 200809L // close
/* How a supply that speaks SCPI is brought to 0 V, and what is known of it then.
 *
 * Its output is switched off, then set to 0 V, then synchronised, and its voltage is read back
 * until it has been at 0 V for `behind`: what a supply may still have had to do is done then. An
 * answer that does not come or makes no sense leaves it open to which question the next one
 * belongs: nothing more is believed of that connection, and all begins anew on another one. There
 * another instrument may have the address: it is told 0 V too, which hurts nobody, but only what
 * says of itself (*IDN?) what the one said that was used is believed. Nor is anything of one that
 * another program drives, which knows it by another name: it may set a voltage a moment later. */
#include "instrument/scpi.h"

#include "base/clock.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

/* What is meant. */
struct meant {
  const struct dea_scpi_raw *raw;
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
static void command_zero(const struct dea_line_link *link, const struct dea_scpi_raw *raw)
{
  char command[DEA_SCPI_COMMAND_SIZE];
  if (raw->output_off.origin != DEA_ABSENT) {
    dea_scpi_send_if_possible(link, raw->output_off.text);
  }
  dea_scpi_output_command(raw, 0, command);
  dea_scpi_send_if_possible(link, command);
}

static void command_end(const struct dea_line_link *link, const struct dea_scpi_raw *raw, bool zero)
{
  if (zero && raw->watchdog.disarm.origin != DEA_ABSENT) { // else it is to do its work
    dea_scpi_send_if_possible(link, raw->watchdog.disarm.text);
  }
  for (size_t i = 0; i < raw->at_stop_count; i++) {
    dea_scpi_send_if_possible(link, raw->at_stop[i].text);
  }
}

/* Whether it says that its output is off, or need not. False: it does not answer. */
static bool query_off(struct dea_context *ctx, struct dea_line_link *link,
                      const struct dea_scpi_raw *raw, double timeout_s, bool *off)
{
  const char *answer;
  double value;
  *off = raw->is_off.origin == DEA_ABSENT;
  if (*off) {
    return true;
  }
  if (dea_scpi_query(ctx, link, timeout_s, raw->is_off.text, &answer) != DEA_OK || answer == NULL) {
    return false;
  }
  *off = strcmp(answer, "OFF") == 0 || (dea_scpi_number(answer, 0, &value) && value == 0);
  return true;
}

/* Reads the voltage back until it stays at 0 V or the time is over, then with why that is not
 * known. False: it does not answer. */
static bool read_back(struct dea_context *ctx, struct dea_line_link *link,
                      const struct dea_scpi_raw *raw, const struct dea_protocol *protocol,
                      double until_s, struct dea_zero *zero)
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
    if (dea_scpi_query(ctx, link, wait_s, raw->measure.text, &answer) != DEA_OK || answer == NULL ||
        !dea_scpi_measured(raw, protocol, answer, &volts) ||
        !query_off(ctx, link, raw, wait_s, &off)) {
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
  if (dea_scpi_query(ctx, link, timeout_s, "*IDN?", &answer) != DEA_OK || answer == NULL) {
    return false;
  }
  bool same = dea_scpi_is_same(m->raw, m->mark, answer);
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
  const struct dea_scpi_raw *raw = m->raw;
  const char *answer;
  double wait_s = share * (until_s - dea_clock_s());
  if (!(wait_s > 0) || dea_scpi_query(ctx, link, wait_s, raw->confirm.text, &answer) != DEA_OK ||
      answer == NULL || !dea_scpi_confirms(raw, answer) ||
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
  const struct dea_scpi_raw *raw = m->raw;
  struct dea_zero zero = {DEA_ZERO_UNKNOWN, NAN, dea_zero_no_answer};
  bool told = false, driven = false, number = true;
  for (double left_s = until_s - dea_clock_s(); left_s > 0 && !told;) {
    struct dea_line_link link;
    double wait_s = number && !m->alone && m->host[0] != '\0' ? share * left_s : left_s;
    if (dea_scpi_connect(ctx, raw, number ? m->host : "", wait_s, &link) == DEA_OK) {
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

struct dea_zero dea_scpi_stop(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct dea_scpi *s = (struct dea_scpi *)instrument;
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
    if (!failed &&
        s->asked != DEA_SCPI_NOTHING) { // what comes next belongs to the question from before
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

struct dea_zero dea_scpi_zero(struct dea_context *ctx, const void *data,
                              const struct dea_protocol *protocol,
                              const struct dea_instrument_past *past)
{
  const struct dea_scpi_raw *raw = data;
  struct meant m = {raw, protocol, past->mark, false, past->program != 0, past->host};
  return raw->output.origin == DEA_ABSENT
             ? (struct dea_zero){DEA_ZERO_NONE, NAN, NULL}
             : zero_anew(ctx, &m, dea_clock_s() + protocol->safety.zero_time_s.si);
}
