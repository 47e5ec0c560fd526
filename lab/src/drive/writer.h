/* Writes a recording in a thread of its own, so that a disk that blocks holds up nothing that is
 * played. What is given waits in a queue of a fixed size; one that is full is a failure, unless the
 * instruments wait too (a simulated bench). Completed cycles are brought to the disk itself. */
#pragma once

#include "recording/recorder.h"

struct dea_writer;

/* recorder: taken, also on failure; its context is the thread's until the end, and nobody else's.
 * room: numbers that the queue holds. waits: for room. out: owned by the caller
 * (dea_writer_finish), NULL on failure. */
dea_status dea_writer_begin(struct dea_context *ctx, struct dea_recorder *recorder, size_t capacity,
                            bool waits, struct dea_writer **out);
/* As those of a recorder. DEA_E_IO when the queue is full; the first failure of the thread, and
 * this one, are answered again by all calls that follow, which do nothing. */
dea_status dea_writer_add(struct dea_context *ctx, struct dea_writer *writer, size_t channel,
                          const double *values, size_t count);
dea_status dea_writer_add_timed(struct dea_context *ctx, struct dea_writer *writer, size_t channel,
                                double time_s, double value);
dea_status dea_writer_add_profile(struct dea_context *ctx, struct dea_writer *writer, double time_s,
                                  const double *z_m, size_t points);
dea_status dea_writer_add_event(struct dea_context *ctx, struct dea_writer *writer,
                                const struct dea_recorded_event *event);
dea_status dea_writer_add_cycle(struct dea_context *ctx, struct dea_writer *writer,
                                const struct dea_recorded_cycle *cycle);
/* Waits until all is written, and ends the recording; NULL is fine. output, ended: as of a
 * recorder.
 */
dea_status dea_writer_finish(struct dea_context *ctx, struct dea_writer *writer, const char *output,
                             const char *ended);
