/* A high-voltage supply on a serial line that answers each command with one line: its output, timed
 * by the computer's clock. What its commands are says a kind's table of them; the rest is here.
 *
 * Such a supply has a small buffer, so that no command is sent before the one before was answered.
 * It gives one sign only, and whole volts. Where "at 0 V" depends on it, a voltage that was read
 * back is believed only behind the answer to another question (`sync`) that no voltage can be
 * mistaken for: an answer that came late could be that to an older question. */
#pragma once

#include "instrument/instrument_make.h"
#include "instrument/line_link.h"
#include "instrument/timed_output.h"

enum { DEA_LINE_SUPPLY_COMMAND_SIZE = 64, DEA_LINE_SUPPLY_PENDING = 64 };

/* Keys that all of them have; the first member of what a kind is read into. */
struct dea_line_supply_raw {
  struct dea_label kind, device, channel;
  struct dea_quantity baud, timeout_s, interval_s, output_interval_s, queue_s, behind_s;
};
/* The rows of these keys; usual_baud: text of a number. */
#define DEA_LINE_SUPPLY_ROWS(raw, name, usual_baud)                                                \
  DEA_INSTRUMENT_LABEL(raw, line.kind, "kind", "kind of instrument", name, .required = true),      \
      DEA_INSTRUMENT_LABEL(raw, line.device, "device", "its serial line", "/dev/ttyACM0",          \
                           .required = true),                                                      \
      DEA_INSTRUMENT_NUMBER(raw, line.baud, "baud", "bits a second", 1200, 921600, usual_baud,     \
                            .default_text = usual_baud),                                           \
      DEA_INSTRUMENT_TIME(raw, line.timeout_s, "timeout",                                          \
                          "longest wait until it answers when it is opened; it may begin anew "    \
                          "then",                                                                  \
                          "5 s", 60),                                                              \
      DEA_INSTRUMENT_TIME(raw, line.interval_s, "interval", "between two measured voltages",       \
                          "0.1 s", 60),                                                            \
      DEA_INSTRUMENT_LABEL(raw, line.channel, "channel",                                           \
                           "channel of the recording for its measured voltage", "supply",          \
                           .absent_text = "none"),                                                 \
      DEA_INSTRUMENT_TIME(raw, line.output_interval_s, "output_interval",                          \
                          "shortest time between two voltages that are set", "20 ms", 60),         \
      DEA_INSTRUMENT_TIME(raw, line.queue_s, "queue",                                              \
                          "of the output that is held ready; a computer that is away for longer "  \
                          "ends the measurement",                                                  \
                          "0.25 s", 5),                                                            \
      DEA_INSTRUMENT_TIME(raw, line.behind_s, "behind",                                            \
                          "longest time that an answer may take; longer ends the measurement",     \
                          "0.5 s", 5)

struct dea_line_supply;

/* Commands of a kind, without the line's end. */
struct dea_line_supply_language {
  const char *what;                               // "the SHVPS", for messages
  const char *set;                                // before the whole volts: "SVset"
  bool (*is_set)(const char *answer, long volts); // whether it took that
  const char *sync;                               // asked before each voltage that matters
  bool (*is_synced)(const char *answer);          // an answer to that, and to nothing else
  /* Whether that answer is of the supply that the section names; raw: of the kind. NULL: it says
   * nothing of that. */
  bool (*is_named)(const void *raw, const char *answer);
  const char *measure;                                // "QVnow"
  bool (*voltage)(const char *answer, double *volts); // of an answer to that, [V] at its output
  const char *const *off;                             // what switches its output off, NULL at end
  bool (*is_error)(const char *answer);
  /* After its output was set to 0 V: finds its range (range_V), sets it up and switches it on. */
  dea_status (*prepare)(struct dea_context *ctx, struct dea_line_supply *s);
  /* Question whose answer must stay what `prepare` left in base.mark. NULL: none, and the line
   * itself, as the system knows it while it is plugged in, is its mark. */
  const char *mark;
};

enum dea_line_supply_question {
  DEA_LINE_SUPPLY_NOTHING,
  DEA_LINE_SUPPLY_SET,
  DEA_LINE_SUPPLY_MEASURE,
  DEA_LINE_SUPPLY_MARK
};

struct dea_line_supply {
  struct dea_instrument base;
  const struct dea_line_supply_language *language;
  const void *raw_all; // of the kind; lent while it is opened, NULL afterwards
  struct dea_line_supply_raw raw;
  const struct dea_protocol *protocol; // lent
  struct dea_line_link link;
  struct dea_timed_output output;
  double range_V;                            // at its output
  enum dea_line_supply_question asked, last; // what is waited for, and what was asked before
  double asked_s;
  long set_V; // that was sent last
  struct {
    double time_s, volts;
  } pending[DEA_LINE_SUPPLY_PENDING]; // measured, to be handed over
  size_t pending_count;
};

/* Sends a command and waits for its answer; an error or none is DEA_E_INSTRUMENT. *answer: lent
 * until the next; NULL: it does not matter. */
dea_status dea_line_supply_query(struct dea_context *ctx, struct dea_line_supply *s,
                                 const char *command, const char **answer);

// Of a kind's type; raw begins with struct dea_line_supply_raw.
dea_status dea_line_supply_check(const struct dea_reader *reader, const void *raw,
                                 const struct dea_protocol *protocol);
dea_status dea_line_supply_open(struct dea_context *ctx, struct dea_instrument *instrument,
                                const struct dea_line_supply_language *language, const void *raw,
                                const struct dea_protocol *protocol);
dea_status dea_line_supply_start(struct dea_context *ctx, struct dea_instrument *instrument);
dea_status dea_line_supply_set(struct dea_context *ctx, struct dea_instrument *instrument,
                               const double *volts, size_t count);
dea_status dea_line_supply_get(struct dea_context *ctx, struct dea_instrument *instrument,
                               double timeout_s, const struct dea_sink *sink);
dea_status dea_line_supply_hold(struct dea_context *ctx, struct dea_instrument *instrument,
                                double *volts);
struct dea_zero dea_line_supply_stop(struct dea_context *ctx, struct dea_instrument *instrument);
void dea_line_supply_address(const void *raw, char *out, size_t size);
struct dea_zero dea_line_supply_zero(struct dea_context *ctx,
                                     const struct dea_line_supply_language *language,
                                     const void *raw, const struct dea_protocol *protocol,
                                     const struct dea_instrument_past *past);
void dea_line_supply_close(struct dea_context *ctx, struct dea_instrument *instrument);

/* The members of a kind's type that all of them share. */
#define DEA_LINE_SUPPLY_MEMBERS                                                                    \
  .size = sizeof(struct dea_line_supply), .roles = DEA_PLAYS_OUTPUT | DEA_GIVES_READINGS,          \
  .start = dea_line_supply_start, .put = dea_line_supply_set, .get = dea_line_supply_get,          \
  .hold = dea_line_supply_hold, .stop = dea_line_supply_stop, .address = dea_line_supply_address,  \
  .close = dea_line_supply_close
