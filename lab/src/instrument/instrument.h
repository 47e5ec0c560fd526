/* Instruments behind one interface: what plays the voltage, what measures.
 *
 * A kind is one file instrument_<name>.c and one line in instrument_list.h; what needs a vendor's
 * library loads it when it is opened. An instrument plays the output (a DAQ, the simulated bench),
 * reads the analogue inputs on the same clock, sends profiles, or answers single readings; any of
 * these together. Voltages here are those on the wire, before the amplifier's gain and the
 * channels' factors. */
#pragma once

#include "instrument/output_zero.h"
#include "protocol/protocol.h"

enum dea_instrument_role {
  DEA_PLAYS_OUTPUT = 1, // takes the control voltage of the amplifier
  DEA_READS_INPUTS = 2, // gives all inputs of the protocol, a sample of each at a time
  DEA_SENDS_PROFILES = 4,
  DEA_GIVES_READINGS = 8 // single values with their time, for channels of its own
};

/* A channel of single readings that an instrument brings along. */
struct dea_instrument_reading {
  char name[DEA_CHANNEL_NAME_SIZE];
  enum dea_channel_kind kind;
  char unit[DEA_CHANNEL_NAME_SIZE]; // "": the kind's
};

/* Where what arrives goes to; what a function returns other than DEA_OK is passed on. Times are on
 * the recording's clock: 0 at start. */
struct dea_sink {
  void *user;
  /* volts: [count][inputs of the protocol]; NAN: lost. */
  dea_status (*samples)(void *user, const double *volts, size_t count);
  /* z_m: [points], NAN where invalid, on the positions that `positions` gave. */
  dea_status (*profile)(void *user, double time_s, const double *z_m);
  dea_status (*reading)(void *user, size_t reading, double time_s, double value_SI);
};

enum { DEA_INSTRUMENT_MARK_SIZE = 128, DEA_INSTRUMENT_HOST_SIZE = 64 };

/* An opened one; a kind's own struct begins with it. */
struct dea_instrument {
  const struct dea_instrument_type *type;
  unsigned roles;
  struct dea_instrument_reading readings[8];
  size_t reading_count;
  size_t profile_points; // known once opened
  const double *x_m;     // [profile_points], lent by the instrument
  bool patient;          // its clock stands still while nobody asks
  /* The recording's clock is 0 then, by the computer's: at its start, and what does not play is set
   * anew once that has begun, which may have taken a while. Of a DAQ it is that of its samples. */
  double start_s;
  size_t lost; // samples, frames or replies that did not arrive or made no sense
  /* One line that tells the supply from another one that gets its address; "": nothing does. */
  char mark[DEA_INSTRUMENT_MARK_SIZE];
  /* Number of the host that it is connected to: 0 V must not wait for a name. "": there is none. */
  char host[DEA_INSTRUMENT_HOST_SIZE];
  /* Why 0 V is not believed should it measure that now, static; NULL: it is. */
  const char *doubt;
  bool reached; // it may have been told something: stopped where it cannot be opened
};

/* What is known of an instrument that is not open, of the time when it was. */
struct dea_instrument_past {
  const char *mark;  // as above; "": whatever has its address and, where there is one, its name
  long program;      // process that may still have its line, but plays nothing any more; 0: none
  double wait_s;     // how long its line is waited for where another program has it
  const char *host;  // as above; "": only its name is known
  const char *doubt; // as above
};

struct dea_instrument_type {
  const char *name;                // "sim"
  const struct dea_record *record; // its keys, "kind" among them
  size_t raw_size;                 // of what they are read into
  size_t size;                     // of its own struct
  unsigned roles;
  /* Adds findings on what the table cannot know; called without errors so far. NULL: all is fine.
   */
  dea_status (*check)(const struct dea_reader *reader, const void *raw,
                      const struct dea_protocol *protocol);
  /* instrument: zero, with type and roles; closed by the caller, also after a failure. raw: as
   * read, lent for the call; protocol: lent, outlives the instrument. Connects, sets up, and waits
   * for what it has to know (a sensor's first profile). The output stays at 0 V. DEA_E_INSTRUMENT
   * with what is wrong and what to look at; DEA_E_UNSUPPORTED when a vendor's library is not there.
   */
  dea_status (*open)(struct dea_context *ctx, struct dea_instrument *instrument, const void *raw,
                     const struct dea_protocol *protocol);
  /* Starts the clock. */
  dea_status (*start)(struct dea_context *ctx, struct dea_instrument *instrument);
  /* Queues control voltages [V] for the output, in the order played, one a sample of the protocol's
   * rate; waits while the queue is full. Before the start it may fill the queue (a fraction of a
   * second); a DAQ whose queue is empty at the start begins with the first sample put afterwards.
   * When all is played the last value stays. NULL when it plays nothing. */
  dea_status (*put)(struct dea_context *ctx, struct dea_instrument *instrument, const double *volts,
                    size_t count);
  /* Hands over what has arrived; waits up to timeout_s for something. A lost connection is
   * DEA_E_INSTRUMENT. NULL when it only plays. */
  dea_status (*get)(struct dea_context *ctx, struct dea_instrument *instrument, double timeout_s,
                    const struct dea_sink *sink);
  /* After `put` or `get` has answered DEA_E_INTERLOCK, because the computer was away for longer
   * than the queue: drops the queue, so that what is put next is played from now on. *volts: where
   * the output is. NULL for one that never answers that. */
  dea_status (*hold)(struct dea_context *ctx, struct dea_instrument *instrument, double *volts);
  /* Ends at once with the output at 0 V, and says what is known of that, within the protocol's
   * safety.zero_time (volts: control voltage); called also after failures, and never twice: by
   * dea_instrument_stop. NULL for one that has nothing to stop. */
  struct dea_zero (*stop)(struct dea_context *ctx, struct dea_instrument *instrument);
  /* What it plays through, without the kind; NULL with `zero`. */
  void (*address)(const void *raw, char *out, size_t size);
  /* The same as stop for one that is not open, by a connection of its own over which nothing else
   * is sent. What has another mark is told 0 V too, and not believed; nor is one whose line another
   * program has, as that may go on. NULL when it never plays. */
  struct dea_zero (*zero)(struct dea_context *ctx, const void *raw,
                          const struct dea_protocol *protocol,
                          const struct dea_instrument_past *past);
  void (*close)(struct dea_context *ctx, struct dea_instrument *instrument);
};

/* NULL when there is none of that name. */
const struct dea_instrument_type *dea_instrument_find(const char *name);
/* The table of a protocol's keys with those of all kinds of instruments. */
void dea_instrument_protocol_schema(struct dea_protocol_schema *out);

/* Reads an instrument's section (not NULL) and opens it. A wrong key is a finding and DEA_E_DESIGN.
 * DEA_E_INTERLOCK when its output is not known to be at 0 V. out: owned by the caller
 * (type->close), NULL on failure. */
dea_status dea_instrument_open(struct dea_context *ctx,
                               const struct dea_protocol_instrument *section,
                               const struct dea_protocol *protocol, struct dea_instrument **out);
/* Stops it. What the context holds of a failure stays, and no interruption shortens it. */
struct dea_zero dea_instrument_stop(struct dea_context *ctx, struct dea_instrument *instrument);
/* Brings the output of a section's instrument to 0 V, without opening the instrument otherwise.
 * A warning says where another one answers at its address, or another program has its line.
 * DEA_ZERO_NONE for one that plays nothing. */
dea_status dea_instrument_zero(struct dea_context *ctx,
                               const struct dea_protocol_instrument *section,
                               const struct dea_protocol *protocol,
                               const struct dea_instrument_past *past, struct dea_zero *out);
/* Name of the supply or device that a section plays through, "scpi 192.168.1.20 5025"; "" for one
 * that plays nothing. */
enum { DEA_INSTRUMENT_ADDRESS_SIZE = 200 };
dea_status dea_instrument_address(struct dea_context *ctx,
                                  const struct dea_protocol_instrument *section,
                                  const struct dea_protocol *protocol,
                                  char out[DEA_INSTRUMENT_ADDRESS_SIZE]);
/* Reads the sections of all instruments without opening any: wrong keys become findings. */
dea_status dea_instrument_check(struct dea_context *ctx, const struct dea_protocol *protocol);
