#define _POSIX_C_SOURCE 200809L // pthread_sigmask
#include "drive/writer.h"

#include "base/clock.h"

#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

static const double sync_s = 0.2; // between two waits for the disk, while there is more to write

enum { ITEMS = 16384, MESSAGE_SIZE = 512, HELD_MAX = 256 };
enum kind { SAMPLES, READING, FRAME, CYCLE, EVENT };

/* Numbers of the queue, one after the other. */
struct item {
  enum kind kind;
  size_t channel, at, count;
};

struct dea_writer {
  struct dea_recorder *recorder;
  struct dea_context *own; // of the recorder
  pthread_t thread;
  bool waits;
  // of the thread: cycles whose samples are not yet on the disk
  struct dea_recorded_cycle held[HELD_MAX];
  size_t held_count;
  double synced_s; // when the disk was last waited for
  // under the lock
  pthread_mutex_t lock;
  pthread_cond_t came, went;
  struct item items[ITEMS];
  size_t first, waiting; // of items
  double *numbers;       // [room], a ring; no item goes round its end
  size_t capacity, head, tail;
  bool ended;
  dea_status status; // first failure
  char message[MESSAGE_SIZE];
};

// The thread -------------------------------------------------------------------------------------

static dea_status write_item(struct dea_writer *w, const struct item *item, const double *numbers)
{
  switch (item->kind) {
  case SAMPLES:
    return dea_recorder_add(w->recorder, item->channel, numbers, item->count);
  case READING:
    return dea_recorder_add_timed(w->recorder, item->channel, &numbers[0], &numbers[1], 1);
  case FRAME:
    return dea_recorder_add_profile(w->recorder, numbers[0], numbers + 1);
  case EVENT:
    return dea_recorder_add_event(
        w->recorder, &(struct dea_recorded_event){numbers[0], (enum dea_noticed_kind)numbers[1],
                                                  item->channel, numbers[2], numbers[3]});
  default:
    w->held[w->held_count++] = (struct dea_recorded_cycle){.step = (size_t)numbers[0],
                                                           .number = (size_t)numbers[1],
                                                           .start_s = numbers[2],
                                                           .end_s = numbers[3],
                                                           .level_V = numbers[4]};
    return DEA_OK;
  }
}

/* Samples to the disk, then the cycles that say that these are there: a failing computer must not
 * leave the second without the first. */
static dea_status write_held(struct dea_writer *w)
{
  dea_status status = dea_recorder_sync(w->recorder);
  for (size_t i = 0; i < w->held_count && status == DEA_OK; i++) {
    status = dea_recorder_add_cycle(w->recorder, &w->held[i]);
  }
  status = status == DEA_OK ? dea_recorder_sync(w->recorder) : status;
  w->held_count = 0;
  w->synced_s = dea_clock_s();
  return status;
}

/* The first failure is kept; called with the lock held. */
static void set_status(struct dea_writer *w, dea_status status)
{
  if (status != DEA_OK && w->status == DEA_OK) {
    w->status = status;
    snprintf(w->message, sizeof w->message, "%s", dea_context_message(w->own));
  }
}

static void *write_all(void *user)
{
  struct dea_writer *w = user;
  w->synced_s = dea_clock_s();
  pthread_mutex_lock(&w->lock);
  for (;;) {
    while (w->waiting == 0 && !w->ended) {
      pthread_cond_wait(&w->came, &w->lock);
    }
    if (w->waiting == 0 && w->held_count == 0) {
      break;
    }
    if (w->waiting == 0) {
      pthread_mutex_unlock(&w->lock);
      dea_status last = write_held(w);
      pthread_mutex_lock(&w->lock);
      set_status(w, last);
      continue;
    }
    struct item item = w->items[w->first];
    bool more = w->waiting > 1;
    pthread_mutex_unlock(&w->lock);
    dea_status status = write_item(w, &item, w->numbers + item.at);
    more = more || w->waits; // what is simulated comes faster than a disk turns
    if (status == DEA_OK && w->held_count > 0 &&
        (!more || w->held_count == HELD_MAX || dea_clock_s() - w->synced_s > sync_s)) {
      status = write_held(w);
    }
    pthread_mutex_lock(&w->lock);
    set_status(w, status);
    w->first = (w->first + 1) % ITEMS;
    w->waiting--;
    w->tail = w->waiting > 0 ? w->items[w->first].at : 0;
    w->head = w->waiting > 0 ? w->head : 0;
    pthread_cond_signal(&w->went);
  }
  pthread_mutex_unlock(&w->lock);
  return NULL;
}

// The queue --------------------------------------------------------------------------------------

/* Room for `count` numbers in a row; false: there is none. */
static bool find_room(const struct dea_writer *w, size_t count, size_t *at)
{
  if (w->waiting == ITEMS) {
    return false;
  }
  bool round = w->waiting > 0 && w->head <= w->tail; // the free part is in between
  *at = w->head;
  if (round) {
    return w->tail - w->head >= count;
  }
  if (w->capacity - w->head >= count) {
    return true;
  }
  *at = 0;
  return w->tail >= count;
}

/* The next item's numbers, and the lock; NULL after a failure, without it. */
static double *reserve(struct dea_context *ctx, struct dea_writer *w, enum kind kind,
                       size_t channel, size_t count)
{
  size_t at = 0;
  pthread_mutex_lock(&w->lock);
  while (w->status == DEA_OK && w->waits && w->waiting > 0 && !find_room(w, count, &at)) {
    pthread_cond_wait(&w->went, &w->lock);
  }
  if (w->status == DEA_OK && !find_room(w, count, &at)) {
    w->status = DEA_E_IO;
    snprintf(w->message, sizeof w->message,
             "the recording is too far behind what is measured: the disk is too slow, or blocks");
  }
  if (w->status != DEA_OK) {
    dea_fail(ctx, w->status, "%s", w->message);
    pthread_mutex_unlock(&w->lock);
    return NULL;
  }
  w->items[(w->first + w->waiting++) % ITEMS] = (struct item){kind, channel, at, count};
  w->head = at + count;
  return w->numbers + at;
}

/* Some numbers, and more behind them. */
static dea_status add(struct dea_context *ctx, struct dea_writer *w, enum kind kind, size_t channel,
                      const double *numbers, size_t count, const double *more, size_t more_count)
{
  double *to = reserve(ctx, w, kind, channel, count + more_count);
  if (to == NULL) {
    return dea_context_status(ctx);
  }
  memcpy(to, numbers, count * sizeof *to);
  if (more_count > 0) {
    memcpy(to + count, more, more_count * sizeof *to);
  }
  pthread_cond_signal(&w->came);
  pthread_mutex_unlock(&w->lock);
  return DEA_OK;
}

dea_status dea_writer_add(struct dea_context *ctx, struct dea_writer *writer, size_t channel,
                          const double *values, size_t count)
{
  return add(ctx, writer, SAMPLES, channel, values, count, NULL, 0);
}

dea_status dea_writer_add_timed(struct dea_context *ctx, struct dea_writer *writer, size_t channel,
                                double time_s, double value)
{
  return add(ctx, writer, READING, channel, &time_s, 1, &value, 1);
}

dea_status dea_writer_add_profile(struct dea_context *ctx, struct dea_writer *writer, double time_s,
                                  const double *z_m, size_t points)
{
  return add(ctx, writer, FRAME, 0, &time_s, 1, z_m, points);
}

dea_status dea_writer_add_cycle(struct dea_context *ctx, struct dea_writer *writer,
                                const struct dea_recorded_cycle *cycle)
{
  const double row[] = {(double)cycle->step, (double)cycle->number, cycle->start_s, cycle->end_s,
                        cycle->level_V};
  return add(ctx, writer, CYCLE, 0, row, 5, NULL, 0);
}

dea_status dea_writer_add_event(struct dea_context *ctx, struct dea_writer *writer,
                                const struct dea_recorded_event *event)
{
  const double row[] = {event->time_s, (double)event->kind, event->value, event->limit};
  return add(ctx, writer, EVENT, event->channel, row, 4, NULL, 0);
}

// Begin and end ----------------------------------------------------------------------------------

/* No signal ends up in the thread: they are to interrupt what waits for instruments. */
static int start_thread(struct dea_writer *w)
{
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  int error = pthread_create(&w->thread, NULL, write_all, w);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  return error;
}

dea_status dea_writer_begin(struct dea_context *ctx, struct dea_recorder *recorder, size_t capacity,
                            bool waits, struct dea_writer **out)
{
  struct dea_writer *w = *out = dea_alloc(ctx, 1, sizeof *w);
  double *numbers = w != NULL ? dea_alloc(ctx, capacity, sizeof *numbers) : NULL;
  int error = 0;
  if (numbers != NULL) {
    w->recorder = recorder;
    w->own = dea_recorder_context(recorder);
    w->waits = waits;
    w->numbers = numbers;
    w->capacity = capacity;
    pthread_mutex_init(&w->lock, NULL);
    pthread_cond_init(&w->came, NULL);
    pthread_cond_init(&w->went, NULL);
    error = start_thread(w);
  }
  if (numbers != NULL && error == 0) {
    return DEA_OK;
  }
  (void)dea_recorder_finish(recorder, "it did not begin");
  dea_free(ctx, numbers);
  dea_free(ctx, w);
  *out = NULL;
  return numbers == NULL
             ? DEA_E_MEMORY
             : dea_fail(ctx, DEA_E_IO, "there is no thread for the recording: %s", strerror(error));
}

dea_status dea_writer_finish(struct dea_context *ctx, struct dea_writer *writer, const char *output,
                             const char *ended)
{
  if (writer == NULL) {
    return DEA_OK;
  }
  pthread_mutex_lock(&writer->lock);
  writer->ended = true;
  pthread_cond_signal(&writer->came);
  pthread_mutex_unlock(&writer->lock);
  pthread_join(writer->thread, NULL);
  dea_recorder_set_output(writer->recorder, output);
  dea_status status = dea_recorder_finish(writer->recorder, ended);
  if (status != DEA_OK && writer->status == DEA_OK) {
    writer->status = status;
    snprintf(writer->message, sizeof writer->message, "%s", dea_context_message(writer->own));
  }
  status = writer->status;
  if (status != DEA_OK) {
    dea_fail(ctx, status, "%s", writer->message);
  }
  pthread_cond_destroy(&writer->went);
  pthread_cond_destroy(&writer->came);
  pthread_mutex_destroy(&writer->lock);
  dea_free(ctx, writer->numbers);
  dea_free(ctx, writer);
  return status;
}
