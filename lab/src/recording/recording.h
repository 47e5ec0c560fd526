/* A measurement: channels of samples, profiles of a line laser, the cycles that were completed.
 *
 * `dea drive` writes one while it runs (recorder.h), importers make one of other programs' files,
 * reductions read one. All values are SI; a missing or invalid value is NAN. */
#pragma once

#include "base/context.h"

#include <math.h>

// X(enumerator, name in files, SI unit, display unit, factor SI -> display, meaning)
#define DEA_CHANNEL_LIST(X)                                                                        \
  X(COMMAND, "command", "V", "kV", 1e-3, "voltage asked of the amplifier")                         \
  X(VOLTAGE, "voltage", "V", "kV", 1e-3, "voltage at the amplifier's output")                      \
  X(CURRENT, "current", "A", "uA", 1e6, "current of the amplifier")                                \
  X(DISPLACEMENT, "displacement", "m", "um", 1e6, "of a point laser, positive to the fibres")      \
  X(FORCE, "force", "N", "mN", 1e3, "on the force cell's tip, positive when pushed away")          \
  X(OTHER, "other", "", "", 1.0, "anything else, in the unit that its channel names")

enum dea_channel_kind {
#define DEA_CHANNEL_ENUM(enumerator, name, si, display, factor, meaning) DEA_CHANNEL_##enumerator,
  DEA_CHANNEL_LIST(DEA_CHANNEL_ENUM)
#undef DEA_CHANNEL_ENUM
      DEA_CHANNEL_KINDS
};

struct dea_channel_meaning {
  const char *name, *si_unit, *display_unit;
  double factor; // SI -> display
  const char *meaning;
};
extern const struct dea_channel_meaning dea_channel_meanings[DEA_CHANNEL_KINDS];
/* NULL-terminated names, for choices of a schema. */
extern const char *const dea_channel_names[DEA_CHANNEL_KINDS + 1];

enum { DEA_CHANNEL_NAME_SIZE = 64, DEA_CHANNELS_MAX = 32, DEA_OUTPUT_SIZE = 128 };

/* Samples at start_s + i interval_s, or, when interval_s is 0, at time_s[i], which rise. */
struct dea_channel {
  char name[DEA_CHANNEL_NAME_SIZE]; // unique in its recording
  enum dea_channel_kind kind;
  char unit[DEA_CHANNEL_NAME_SIZE]; // SI unit of the kind; of DEA_CHANNEL_OTHER as the file says
  double start_s, interval_s;
  double filter_Hz;       // low-pass that reductions apply; NAN: none
  double lowest, highest; // values that it can show: what is there may be beyond; equal: not known
  double *time_s;         // [count], owned; NULL with an interval
  double *values;         // [count], owned
  size_t count;
};

/* Frames of a profile sensor: heights along one line across the film. */
struct dea_profiles {
  size_t points, count;
  double *x_m;    // [points], rising
  double *time_s; // [count]
  double *z_m;    // [count][points], upwards; NAN: no valid point
};

/* What the watches of a drive noticed. Numbers of files: none of them changes its meaning. */
enum dea_noticed_kind {
  DEA_NOTICED_LEARNED = 1, // base lines of the leakage current: the largest, and the largest limit
  DEA_NOTICED_SCATTER = 2, // there is none to be learned: what it is, and what it would allow
  DEA_NOTICED_DRIFTED = 3, // its base line has come to its end: what it is, and its limit
  DEA_NOTICED_LEAK_ROSE = 4, // what was measured, and its limit; it ended the measurement
  DEA_NOTICED_READ_BACK = 5, // voltage measured, and asked for; it ended the measurement
  DEA_NOTICED_SILENT = 6     // a reading without a value: seconds, and how many end the measurement
};
enum { DEA_NOTICED_KINDS = 7 };
struct dea_recorded_event {
  double time_s;
  enum dea_noticed_kind kind;
  size_t channel; // number of it in the recording
  double value, limit;
};
enum { DEA_NOTICED_TEXT_SIZE = 320 };
/* As a sentence. channel: its name. */
void dea_noticed_text(const struct dea_recorded_event *event, const char *channel,
                      char out[DEA_NOTICED_TEXT_SIZE]);

/* A cycle that was played to its end. */
struct dea_recorded_cycle {
  size_t step, number;   // of the protocol's sequence, and within that step, both from 0
  double start_s, end_s; // of the recording's clock
  double level_V;        // asked voltage farthest from 0
};

struct dea_recording {
  const char *file;                      // interned; ""
  char *title;                           // "" when there is none
  char *protocol, *design, *design_name; // whole texts of the files, name of the second; NULL
  char *provenance;                      // JSON; NULL
  bool complete;                         // ended by its program, not by a crash
  char ended[256];                       // why it ended early; ""
  char output[DEA_OUTPUT_SIZE];          // what is known of the output at the end; "" nothing
  struct dea_channel channels[DEA_CHANNELS_MAX];
  size_t channel_count;
  struct dea_profiles profiles; // count 0 without
  struct dea_recorded_cycle *cycles;
  size_t cycle_count;
  struct dea_recorded_event *events;
  size_t event_count;
};

/* An empty one; owned by the caller, NULL on failure. */
dea_status dea_recording_create(struct dea_context *ctx, struct dea_recording **out);
/* NULL is fine. */
void dea_recording_destroy(struct dea_context *ctx, struct dea_recording *recording);

/* Reads a file of a recorder, also one whose program was killed: what was flushed is there then,
 * complete is false and `ended` says so. DEA_E_IO with the reason otherwise. */
dea_status dea_recording_read(struct dea_context *ctx, const char *file,
                              struct dea_recording **out);
/* Writes the whole recording as a new file that any HDF5 program opens (a file of a killed program
 * needs h5clear for that). */
dea_status dea_recording_write(struct dea_context *ctx, const struct dea_recording *recording,
                               const char *file);

/* Moves the channels, profiles, cycles and events of another recording of the same measurement into
 * this one, whose clock shows after_s where the other's shows 0; texts where this one has none.
 * Channels of the same name get a number. Cycles of one that the other does not cover are left out
 * with a warning. DEA_E_IO, with both as they were, where that are all, where the two have no
 * moment together, the other has nothing new, both have profiles or cycles, or there are too many
 * channels. */
dea_status dea_recording_join(struct dea_context *ctx, struct dea_recording *recording,
                              struct dea_recording *other, double after_s);

/* A value closer to the end of its channel's range than this share of half of it is taken to be
 * beyond. */
#define DEA_CHANNEL_END 1e-4

/* First channel of a kind, or the one of that name; NULL when there is none. Lent. */
const struct dea_channel *dea_recording_kind(const struct dea_recording *recording,
                                             enum dea_channel_kind kind);
const struct dea_channel *dea_recording_channel(const struct dea_recording *recording,
                                                const char *name);
/* Gives a channel that is to be added a number where its name is one of the recording's. */
void dea_recording_name_apart(const struct dea_recording *recording, struct dea_channel *channel);
/* Whether two lists of samples are the same, missing ones too. */
bool dea_samples_same(const double *a, const double *b, size_t count);
/* Time of a sample [s], i < count. */
static inline double dea_channel_time(const struct dea_channel *channel, size_t i)
{
  return channel->interval_s > 0 ? channel->start_s + (double)i * channel->interval_s
                                 : channel->time_s[i];
}
/* Number of samples before time_s: the first index at or after it, count when there is none. */
size_t dea_channel_index(const struct dea_channel *channel, double time_s);
