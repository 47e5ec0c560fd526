/* Recording at 1 MS/s in all for 60 s, in blocks of 10 ms as an instrument hands them over: one
 * channel, and four of 250 kS/s. As fast as possible on one processor: seconds of recording in a
 * second of work. Then the file is read back and every sample compared.
 *
 *   bench_recording [--paced] [FOLDER]
 *
 * --paced: an instrument of its own thread hands the blocks over in real time through a ring of one
 * second; what does not fit in would be lost. Prints the largest backlog. */
#define _XOPEN_SOURCE 700 // mkdtemp
#include "timing.h"

#include "recording/recorder.h"

#include <pthread.h>
#include <string.h>
#include <unistd.h>

enum { SECONDS = 60, BLOCKS_PER_S = 100, BLOCKS = SECONDS * BLOCKS_PER_S, RATE = 1000000 };
enum { BLOCK = RATE / BLOCKS_PER_S }; // samples of all channels

static double value(size_t channel, size_t i)
{
  return (double)((i * 2654435761U + channel * 97) & 0xffff) * (20.0 / 65536) - 10; // of 16 bits
}

static struct dea_recorder *create(struct dea_context *ctx, const char *file, size_t channels)
{
  static const char *const names[] = {"a", "b", "c", "d"};
  struct dea_recorder_channel channel[4];
  for (size_t c = 0; c < channels; c++) {
    channel[c] = (struct dea_recorder_channel){.name = names[c],
                                               .kind = DEA_CHANNEL_VOLTAGE,
                                               .interval_s = (double)channels / RATE,
                                               .filter_Hz = NAN};
  }
  struct dea_recorder_options options = {.channels = channel, .channel_count = channels};
  struct dea_recorder *recorder;
  bench_need(dea_recorder_create(ctx, file, &options, &recorder), ctx);
  return recorder;
}

/* Block number `block` of every channel, which `values` holds one after the other; a cycle a
 * second. */
static void add_block(struct dea_context *ctx, struct dea_recorder *recorder, size_t channels,
                      const double *values, size_t block)
{
  for (size_t c = 0; c < channels; c++) {
    size_t count = BLOCK / channels;
    bench_need(dea_recorder_add(recorder, c, values + c * count, count), ctx);
  }
  if (block % BLOCKS_PER_S == BLOCKS_PER_S - 1) {
    double end_s = (double)(block + 1) / BLOCKS_PER_S;
    struct dea_recorded_cycle cycle = {0, block / BLOCKS_PER_S, end_s - 1, end_s, 1};
    bench_need(dea_recorder_add_cycle(recorder, &cycle), ctx);
  }
}

static void fill_block(size_t channels, size_t block, double *values)
{
  for (size_t c = 0; c < channels; c++) {
    size_t count = BLOCK / channels;
    for (size_t i = 0; i < count; i++) {
      values[c * count + i] = value(c, block * count + i);
    }
  }
}

/* Every sample is there, and is the right one. */
static void verify(struct dea_context *ctx, const char *file, size_t channels)
{
  struct dea_recording *recording;
  double start = bench_now_s();
  bench_need(dea_recording_read(ctx, file, &recording), ctx);
  double time = bench_now_s() - start;
  size_t right = 0;
  for (size_t c = 0; c < recording->channel_count; c++) {
    for (size_t i = 0; i < recording->channels[c].count; i++) {
      right += recording->channels[c].values[i] == value(c, i);
    }
  }
  if (right != (size_t)RATE * SECONDS || recording->channel_count != channels ||
      recording->cycle_count != SECONDS || !recording->complete) {
    fprintf(stderr, "%zu of %zu samples and %zu cycles are right\n", right, (size_t)RATE * SECONDS,
            recording->cycle_count);
    exit(1);
  }
  dea_recording_destroy(ctx, recording);
  char name[64];
  snprintf(name, sizeof name, "recording.%zu_channels.samples", channels);
  bench_print(name, (double)right, "1");
  snprintf(name, sizeof name, "recording.%zu_channels.read", channels);
  bench_print(name, time, "s");
}

static void as_fast_as_possible(struct dea_context *ctx, const char *file, size_t channels)
{
  static double values[BLOCK];
  char name[64];
  double longest = 0;
  double start = bench_now_s(), processor = bench_processor_s(), filling = 0;
  struct dea_recorder *recorder = create(ctx, file, channels);
  for (size_t block = 0; block < BLOCKS; block++) {
    double begin = bench_now_s();
    fill_block(channels, block, values);
    double filled = bench_now_s();
    add_block(ctx, recorder, channels, values, block);
    double time = bench_now_s() - filled;
    filling += filled - begin;
    longest = time > longest ? time : longest;
  }
  bench_need(dea_recorder_finish(recorder, NULL), ctx);
  double time = bench_now_s() - start - filling;
  processor = bench_processor_s() - processor - filling;
  snprintf(name, sizeof name, "recording.%zu_channels.write", channels);
  bench_print(name, time, "s");
  snprintf(name, sizeof name, "recording.%zu_channels.processor", channels);
  bench_print(name, processor, "s");
  snprintf(name, sizeof name, "recording.%zu_channels.real_time_over_write", channels);
  bench_print(name, SECONDS / time, "1");
  snprintf(name, sizeof name, "recording.%zu_channels.longest_block", channels);
  bench_print(name, longest, "s");
  verify(ctx, file, channels);
}

// In real time -----------------------------------------------------------------------------------

/* One second of blocks between the instrument's thread and the recorder. */
struct ring {
  pthread_mutex_t lock;
  pthread_cond_t filled;
  double (*blocks)[BLOCK]; // [BLOCKS_PER_S]
  size_t channels, put, taken, lost, backlog;
};

static void *instrument(void *user)
{
  struct ring *ring = user;
  double start = bench_now_s();
  for (size_t block = 0; block < BLOCKS; block++) {
    double wait = start + (double)(block + 1) / BLOCKS_PER_S - bench_now_s();
    if (wait > 0) {
      nanosleep(&(struct timespec){.tv_nsec = (long)(1e9 * wait)}, NULL);
    }
    pthread_mutex_lock(&ring->lock);
    size_t waiting = ring->put - ring->taken;
    if (waiting == BLOCKS_PER_S) {
      ring->lost++;
    } else {
      pthread_mutex_unlock(&ring->lock);
      fill_block(ring->channels, block, ring->blocks[block % BLOCKS_PER_S]);
      pthread_mutex_lock(&ring->lock);
      ring->put++;
      ring->backlog = waiting + 1 > ring->backlog ? waiting + 1 : ring->backlog;
      pthread_cond_signal(&ring->filled);
    }
    pthread_mutex_unlock(&ring->lock);
  }
  return NULL;
}

static void in_real_time(struct dea_context *ctx, const char *file, size_t channels)
{
  struct ring ring = {.lock = PTHREAD_MUTEX_INITIALIZER, .filled = PTHREAD_COND_INITIALIZER};
  pthread_t thread;
  char name[64];
  ring.channels = channels;
  ring.blocks = malloc(BLOCKS_PER_S * sizeof *ring.blocks);
  double processor = bench_processor_s();
  struct dea_recorder *recorder = create(ctx, file, channels);
  if (ring.blocks == NULL || pthread_create(&thread, NULL, instrument, &ring) != 0) {
    fprintf(stderr, "no memory or no thread\n");
    exit(1);
  }
  for (size_t block = 0; block < BLOCKS; block++) {
    pthread_mutex_lock(&ring.lock);
    while (ring.put == ring.taken && ring.lost == 0) {
      pthread_cond_wait(&ring.filled, &ring.lock);
    }
    pthread_mutex_unlock(&ring.lock);
    if (ring.lost > 0) {
      fprintf(stderr, "block %zu was lost\n", block);
      exit(1);
    }
    add_block(ctx, recorder, channels, ring.blocks[block % BLOCKS_PER_S], block);
    pthread_mutex_lock(&ring.lock);
    ring.taken++;
    pthread_mutex_unlock(&ring.lock);
  }
  bench_need(dea_recorder_finish(recorder, NULL), ctx);
  pthread_join(thread, NULL);
  free(ring.blocks);
  snprintf(name, sizeof name, "recording.%zu_channels.paced.backlog", channels);
  bench_print(name, (double)ring.backlog / BLOCKS_PER_S, "s");
  snprintf(name, sizeof name, "recording.%zu_channels.paced.processor", channels);
  bench_print(name, bench_processor_s() - processor, "s");
  verify(ctx, file, channels);
}

int main(int argc, char **argv)
{
  static char own[] = "/tmp/dea-bench-XXXXXX";
  bool paced = argc > 1 && strcmp(argv[1], "--paced") == 0;
  const char *folder = argc > 1 + paced ? argv[1 + paced] : mkdtemp(own);
  struct dea_context *ctx;
  char file[600];
  if (folder == NULL || dea_context_create(NULL, &ctx) != DEA_OK) {
    fprintf(stderr, "no folder or no memory\n");
    return EXIT_FAILURE;
  }
  snprintf(file, sizeof file, "%.580s/recording.h5", folder);
  for (size_t channels = 1; channels <= 4; channels *= 4) {
    (paced ? in_real_time : as_fast_as_possible)(ctx, file, channels);
    remove(file);
  }
  dea_context_destroy(ctx);
  rmdir(own);
  return 0;
}
