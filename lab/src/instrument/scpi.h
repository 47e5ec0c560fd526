/* Inside of the instrument "scpi": its keys, its connection, and its output.
 *
 * A voltage of the output counts as set once the question `confirm`, which is sent behind it, was
 * answered. */
#pragma once

#include "instrument/instrument_make.h"
#include "instrument/line_link.h"
#include "instrument/poll_schedule.h"
#include "instrument/scpi_parse.h"
#include "instrument/timed_output.h"

enum { DEA_SCPI_COMMANDS_MAX = 16, DEA_SCPI_COMMAND_SIZE = DEA_TITLE_SIZE + 40 };

struct dea_scpi_raw_reading {
  struct dea_label name, query, unit;
  struct dea_choice quantity;
  struct dea_quantity factor, offset, field;
};

struct dea_scpi_raw {
  struct dea_label kind, address, identity;
  struct dea_quantity port, timeout_s, interval_s;
  struct dea_label setup[DEA_SCPI_COMMANDS_MAX], at_stop[DEA_SCPI_COMMANDS_MAX];
  size_t setup_count, at_stop_count;
  struct dea_scpi_raw_reading readings[DEA_INSTRUMENT_READINGS_MAX];
  size_t reading_count;
  // of the output
  struct dea_label output, output_off, is_off, confirm, measure;
  struct dea_quantity output_factor, output_interval_s, queue_s, behind_s, measure_field;
  struct {
    struct dea_label arm, feed, disarm;
    struct dea_quantity period_s;
  } watchdog;
};

enum dea_scpi_question { DEA_SCPI_NOTHING, DEA_SCPI_READING, DEA_SCPI_CONFIRM, DEA_SCPI_MEASURE };

struct dea_scpi {
  struct dea_instrument base;
  struct dea_scpi_raw raw;
  const struct dea_protocol *protocol; // lent
  struct dea_line_link link;
  char name[DEA_SOCKET_NAME_SIZE + 8];
  double start_s;                    // computer's clock at start; NAN before
  struct dea_poll_schedule schedule; // of the readings
  /* What stood behind the first number of each; valid when `known`. */
  char suffix[DEA_INSTRUMENT_READINGS_MAX][DEA_SCPI_SUFFIX_SIZE];
  bool known[DEA_INSTRUMENT_READINGS_MAX], noted_suffix;
  enum dea_scpi_question asked; // what is waited for
  double asked_s;
  bool broken; // a response made no sense: which question the next one belongs to is not known
  struct dea_timed_output output;
  double fed_s; // when the watchdog was fed last
  int claim;    // of what it plays through; -1: none
};

/* host: its number; "": by its name. */
dea_status dea_scpi_connect(struct dea_context *ctx, const struct dea_scpi_raw *raw,
                            const char *host, double timeout_s, struct dea_line_link *link);
dea_status dea_scpi_send(struct dea_context *ctx, const struct dea_line_link *link,
                         double timeout_s, const char *command);
/* Sends what goes without waiting. */
void dea_scpi_send_if_possible(const struct dea_line_link *link, const char *command);
/* Whether a response to *IDN? is of the instrument that is meant: has `identity` in it, and is
 * mark, where that is not "". */
bool dea_scpi_is_same(const struct dea_scpi_raw *raw, const char *mark, const char *response);
/* Sends a question. DEA_E_INSTRUMENT where something came that nobody had asked for: which question
 * the next response belongs to would not be known. */
dea_status dea_scpi_question(struct dea_context *ctx, struct dea_line_link *link, double timeout_s,
                             const char *question);
/* Sends a question and waits for its response. */
dea_status dea_scpi_query(struct dea_context *ctx, struct dea_line_link *link, double timeout_s,
                          const char *question, const char **out);
dea_status dea_scpi_no_response(struct dea_context *ctx, const struct dea_scpi *s,
                                const char *question, double timeout_s);

/* The output's command with a control voltage in it; numbers have a point in any locale. */
void dea_scpi_output_command(const struct dea_scpi_raw *raw, double volts,
                             char out[DEA_SCPI_COMMAND_SIZE]);
/* Whether a response confirms that what was sent before is done. */
bool dea_scpi_confirms(const struct dea_scpi_raw *raw, const char *response);
/* The control voltage [V] of a response to `measure`; false when it is none. Its unit, where it has
 * one, must be that in which the output is set. */
bool dea_scpi_measured(const struct dea_scpi_raw *raw, const struct dea_protocol *protocol,
                       const char *response, double *volts);
dea_status dea_scpi_output_begin(struct dea_context *ctx, struct dea_scpi *s);
/* Sets 0 V before anything is played and looks whether it is there. */
dea_status dea_scpi_output_open(struct dea_context *ctx, struct dea_scpi *s);
dea_status dea_scpi_output_start(struct dea_context *ctx, struct dea_scpi *s);
dea_status dea_scpi_output_set(struct dea_context *ctx, struct dea_scpi *s, const double *volts,
                               size_t count);
/* Does what is due: takes samples out of the queue, sends the last of them, measures, feeds the
 * watchdog. *next_s: clock at which there is something to do. DEA_E_INTERLOCK after a stall. */
dea_status dea_scpi_output_play(struct dea_context *ctx, struct dea_scpi *s, double *next_s);
dea_status dea_scpi_output_hold(struct dea_context *ctx, struct dea_instrument *instrument,
                                double *volts);
/* A response to the open question of the output. */
dea_status dea_scpi_output_response(struct dea_context *ctx, struct dea_scpi *s,
                                    const char *response);

/* Of the instrument's type. */
struct dea_zero dea_scpi_stop(struct dea_context *ctx, struct dea_instrument *instrument);
struct dea_zero dea_scpi_zero(struct dea_context *ctx, const void *raw,
                              const struct dea_protocol *protocol,
                              const struct dea_instrument_past *past);
