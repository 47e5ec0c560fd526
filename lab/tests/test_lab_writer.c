/* lab/drive/writer: what is recorded waits in a queue while the disk blocks; nothing waits for it,
 * and one that is full is a failure after which the recording holds what was taken. */
#include "drive/writer.h"
#include "own_disk.h"
#include "own_folder.h"
#include "testing.h"

#include <string.h>

enum { ROOM = 4000, BLOCK = 100 };
static struct dea_context *own; // of the recorder

static struct dea_writer *begin(const char *file, bool waits)
{
  static const struct dea_recorder_channel channel = {
      .name = "command", .kind = DEA_CHANNEL_COMMAND, .interval_s = 1e-3, .filter_Hz = (double)NAN};
  const struct dea_recorder_options options = {.channels = &channel, .channel_count = 1};
  struct dea_recorder *recorder;
  struct dea_writer *writer;
  assert_int_equal(dea_context_create(NULL, &own), DEA_OK);
  assert_int_equal(dea_recorder_create(own, file, &options, &recorder), DEA_OK);
  assert_int_equal(dea_writer_begin(ctx, recorder, ROOM, waits, &writer), DEA_OK);
  return writer;
}

/* Adds blocks of numbers that count up, a cycle behind each; how many went. */
static size_t add_blocks(struct dea_writer *writer, size_t most, dea_status *status)
{
  double values[BLOCK];
  for (size_t i = 0; i < most; i++) {
    struct dea_recorded_cycle cycle = {0, i, 0.1 * (double)i, 0.1 * (double)(i + 1), 1};
    for (size_t k = 0; k < BLOCK; k++) {
      values[k] = (double)(i * BLOCK + k);
    }
    if ((*status = dea_writer_add(ctx, writer, 0, values, BLOCK)) != DEA_OK ||
        (*status = dea_writer_add_cycle(ctx, writer, &cycle)) != DEA_OK) {
      return i;
    }
  }
  return most;
}

static void check(const char *file, size_t blocks, bool complete)
{
  struct dea_recording *recording;
  assert_int_equal(dea_recording_read(ctx, file, &recording), DEA_OK);
  assert_true(recording->complete == complete);
  assert_true(recording->channels[0].count >= blocks * BLOCK);
  for (size_t i = 0; i < recording->channels[0].count; i++) {
    assert_true(recording->channels[0].values[i] == (double)i);
  }
  assert_int_equal(recording->cycle_count, blocks);
  dea_recording_destroy(ctx, recording);
}

TEST(test_disk_that_blocks)
{
  dea_status status;
  char file[700];
  snprintf(file, sizeof file, "%s", in_folder("blocks.h5"));
  struct dea_writer *writer = begin(file, false);
  atomic_store(&disk_held, true);
  size_t blocks = add_blocks(writer, 1000, &status); // comes back: nothing here waits for the disk
  assert_int_equal(status, DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "the disk is too slow, or blocks"));
  assert_true(blocks >= ROOM / (BLOCK + 5) - 1 && blocks <= ROOM / (BLOCK + 5) + 1);
  assert_int_equal(dea_writer_add(ctx, writer, 0, &(double){0}, 1), DEA_E_IO); // no gap
  atomic_store(&disk_held, false);
  assert_int_equal(dea_writer_finish(ctx, writer, "", "it was too slow"), DEA_E_IO);
  dea_context_destroy(own);
  check(file, blocks, false);
}

/* What simulates waits. */
TEST(test_waits_for_room)
{
  dea_status status;
  char file[700];
  snprintf(file, sizeof file, "%s", in_folder("waits.h5"));
  struct dea_writer *writer = begin(file, true);
  assert_int_equal(add_blocks(writer, 300, &status), 300);
  assert_int_equal(dea_writer_finish(ctx, writer, "", NULL), DEA_OK);
  dea_context_destroy(own);
  check(file, 300, true);
}

TESTS(set_up, tear_down)
