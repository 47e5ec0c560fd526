/* Writes a recording while it runs: one HDF5 file that can be read whatever happens to the program.
 *
 * The file is open for one writer and many readers (HDF5's SWMR): data reach the operating system
 * in an order in which the file is valid at any moment, so a program that is killed loses at most
 * what came after the last flush. */
#pragma once

#include "recording/recording.h"

struct dea_recorder;

struct dea_recorder_channel {
  const char *name;
  enum dea_channel_kind kind;
  const char *unit;           // NULL: the kind's
  double start_s, interval_s; // interval 0: every sample comes with its time
  double filter_Hz;           // NAN: none
  double lowest, highest;     // as of a channel
};

struct dea_recorder_options {
  const char *title, *protocol, *design, *design_name, *provenance; // copied; NULL: none
  const struct dea_recorder_channel *channels;
  size_t channel_count;
  size_t profile_points; // 0: no profile sensor
  const double *x_m;     // [profile_points]
  double flush_s;        // longest time between flushes of what was given; 0: 0.2 s
  bool plain;            // of data that are there already: no readers until it is finished, and a
                         // format that programs with older versions of HDF5 read
};

/* Makes the file, which must not exist. out: owned by the caller (dea_recorder_finish), NULL on
 * failure. */
dea_status dea_recorder_create(struct dea_context *ctx, const char *file,
                               const struct dea_recorder_options *options,
                               struct dea_recorder **out);
/* The context that it was made with. */
struct dea_context *dea_recorder_context(const struct dea_recorder *recorder);
/* Appends samples of a channel with an interval (a gap: NAN), or with their times, which must rise
 * (DEA_E_ARGUMENT, and nothing is appended). After any other failure all calls but finish do
 * nothing and answer it again. */
dea_status dea_recorder_add(struct dea_recorder *recorder, size_t channel, const double *values,
                            size_t count);
dea_status dea_recorder_add_timed(struct dea_recorder *recorder, size_t channel,
                                  const double *time_s, const double *values, size_t count);
/* Appends a frame; z_m: [profile_points]. */
dea_status dea_recorder_add_profile(struct dea_recorder *recorder, double time_s,
                                    const double *z_m);
/* Appends a completed cycle and flushes everything: from here on it survives. */
dea_status dea_recorder_add_cycle(struct dea_recorder *recorder,
                                  const struct dea_recorded_cycle *cycle);
/* Appends what a watch noticed, and flushes that. */
dea_status dea_recorder_add_event(struct dea_recorder *recorder,
                                  const struct dea_recorded_event *event);
/* Flushes the samples and waits until all that was flushed is on the disk, so that it survives the
 * computer too. A cycle is to be added after its samples were waited for: of what nobody has waited
 * for, a failing computer may keep any part. */
dea_status dea_recorder_sync(struct dea_recorder *recorder);
/* What is known of the output at the end ("at 0 V (2 V read back)"); for dea_recorder_finish. */
void dea_recorder_set_output(struct dea_recorder *recorder, const char *text);
/* Whether a program records into that file at this moment. */
bool dea_recording_is_written(const char *file);
/* Ends the file and frees the recorder, also after a failure; NULL is fine. ended: why it ended
 * early, NULL or "" when it came to its end. DEA_E_IO too when the file has been removed or
 * replaced meanwhile. */
dea_status dea_recorder_finish(struct dea_recorder *recorder, const char *ended);
