/* Recordings of one measurement that two programs made: joined, on one clock. */
#include "failing_allocator.h"
#include "recording_files.h"

#include <jansson.h>
#include <string.h>

enum { CYCLES = 3 };
static const double after_s = -0.69;

/* A recording with a clocked channel, and readings of a name that the samples of
 * recording_samples.h have too. */
static dea_status laser_make(struct dea_context *own, struct dea_recording **out)
{
  DEA_TRY(own, dea_recording_create(own, out));
  struct dea_recording *laser = *out;
  laser->channels[0] = (struct dea_channel){.name = "voltage",
                                            .kind = DEA_CHANNEL_VOLTAGE,
                                            .unit = "V",
                                            .start_s = 1,
                                            .interval_s = 0.1,
                                            .filter_Hz = NAN};
  laser->channels[1] = (struct dea_channel){
      .name = "temperature", .kind = DEA_CHANNEL_OTHER, .unit = "K", .filter_Hz = NAN};
  laser->channel_count = 2;
  laser->file = "laser.h5";
  laser->complete = true;
  laser->channels[0].values = dea_alloc(own, 5, sizeof(double));
  laser->channels[1].values = dea_alloc(own, 2, sizeof(double));
  laser->channels[1].time_s = dea_alloc(own, 2, sizeof(double));
  laser->events = dea_alloc(own, 1, sizeof *laser->events);
  if (laser->channels[0].values == NULL || laser->channels[1].values == NULL ||
      laser->channels[1].time_s == NULL || laser->events == NULL) {
    return DEA_E_MEMORY;
  }
  laser->channels[0].count = 5;
  laser->channels[1].count = 2;
  for (size_t i = 0; i < 5; i++) {
    laser->channels[0].values[i] = 10 * (double)i;
  }
  laser->channels[1].time_s[1] = 2;
  laser->events[0] = (struct dea_recorded_event){
      .time_s = 1.5, .kind = DEA_NOTICED_SILENT, .channel = 1, .value = 3, .limit = 5};
  laser->event_count = 1;
  return DEA_OK;
}

static struct dea_recording *laser_new(void)
{
  struct dea_recording *laser;
  assert_int_equal(laser_make(ctx, &laser), DEA_OK);
  return laser;
}

/* All that was in the second is on the first one's clock, also after it was written and read. */
TEST(test_on_one_clock)
{
  make("drive.h5", false, CYCLES, NULL);
  struct dea_recording *drive = must_read("drive.h5"), *laser = laser_new();
  assert_int_equal(dea_recording_join(ctx, drive, laser, after_s), DEA_OK);
  unlink(in_folder("both.h5"));
  assert_int_equal(dea_recording_write(ctx, drive, in_folder("both.h5")), DEA_OK);
  dea_recording_destroy(ctx, laser);
  dea_recording_destroy(ctx, drive);
  struct dea_recording *both = must_read("both.h5");
  assert_int_equal(both->channel_count, 5);
  assert_true(both->channels[1].count >= (size_t)CYCLES * SAMPLE_CYCLE);
  assert_close(both->channels[1].values[9], sample_value(1, 9), 0, 0);
  assert_close(both->channels[2].time_s[2], sample_reading_time(2), 0, 0);
  assert_int_equal(both->cycle_count, 2); // the first begins before the laser
  assert_int_equal(both->cycles[0].number, 1);
  assert_int_equal(both->profiles.count, CYCLES);
  assert_string_equal(both->channels[3].name, "voltage 2");
  assert_string_equal(both->channels[4].name, "temperature 2");
  assert_close(both->channels[3].start_s, 1 + after_s, 1e-15, 0);
  assert_close(both->channels[3].interval_s, 0.1, 1e-15, 0);
  assert_close(both->channels[3].values[4], 40, 0, 0);
  assert_close(both->channels[4].time_s[1], 2 + after_s, 1e-15, 0);
  assert_int_equal(both->event_count, 1);
  assert_int_equal(both->events[0].channel, 4);
  assert_close(both->events[0].time_s, 1.5 + after_s, 1e-15, 0);
  json_t *said = json_loads(both->provenance, 0, NULL);
  json_t *part = json_array_get(json_object_get(said, "joined"), 0);
  assert_string_equal(json_string_value(json_object_get(said, "program")), "test");
  assert_string_equal(json_string_value(json_object_get(part, "file")), "laser.h5");
  assert_close(json_number_value(json_object_get(part, "after_s")), after_s, 0, 0);
  json_decref(said);
  dea_recording_destroy(ctx, both);
}

/* What the first one lacks comes from the second: profiles, cycles, texts; a killed part makes the
 * whole one that was. */
TEST(test_what_the_first_lacks)
{
  make("early.h5", false, CYCLES, "the current was above 200 uA");
  struct dea_recording *laser = laser_new(), *drive = must_read("early.h5");
  const double start_s = drive->cycles[0].start_s, frame_s = drive->profiles.time_s[1];
  assert_int_equal(dea_recording_join(ctx, laser, drive, 0.8), DEA_OK);
  assert_int_equal(drive->channel_count, 0);
  dea_recording_destroy(ctx, drive);
  assert_int_equal(laser->channel_count, 5);
  assert_int_equal(laser->cycle_count, CYCLES);
  assert_close(laser->cycles[0].start_s, start_s + 0.8, 1e-15, 0);
  assert_close(laser->profiles.time_s[1], frame_s + 0.8, 1e-15, 0);
  assert_string_equal(laser->title, "Sample");
  assert_string_equal(laser->design_name, "sample.yaml");
  assert_false(laser->complete);
  assert_string_equal(laser->ended, "the current was above 200 uA");
  dea_recording_destroy(ctx, laser);
}

/* Channels that happen to have the same clock keep their lengths, also of a drive that ended early.
 */
TEST(test_other_lengths)
{
  enum { MANY = 5000 };
  make("early.h5", false, CYCLES, "the current was above 200 uA");
  struct dea_recording *drive = must_read("early.h5"), *laser = laser_new();
  struct dea_channel *z = &laser->channels[0];
  const size_t count = drive->channels[0].count;
  assert_true(count < MANY);
  dea_free(ctx, z->values);
  z->values = dea_alloc(ctx, MANY, sizeof(double));
  assert_non_null(z->values);
  z->count = MANY;
  z->start_s = drive->channels[0].start_s;
  z->interval_s = drive->channels[0].interval_s;
  assert_int_equal(dea_recording_join(ctx, drive, laser, 0), DEA_OK);
  unlink(in_folder("both.h5"));
  assert_int_equal(dea_recording_write(ctx, drive, in_folder("both.h5")), DEA_OK);
  dea_recording_destroy(ctx, laser);
  dea_recording_destroy(ctx, drive);
  drive = must_read("both.h5");
  assert_int_equal(drive->channels[0].count, count);
  assert_int_equal(drive->channels[3].count, MANY);
  assert_false(drive->complete);
  dea_recording_destroy(ctx, drive);
}

static void assert_refused(struct dea_recording *recording, struct dea_recording *other,
                           const char *said)
{
  const size_t before = recording->channel_count;
  assert_int_equal(dea_recording_join(ctx, recording, other, 0), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), said));
  assert_int_equal(recording->channel_count, before);
  assert_int_not_equal(other->channel_count, 0);
}

TEST(test_what_cannot_be_joined)
{
  make("a.h5", false, CYCLES, NULL);
  struct dea_recording *a = must_read("a.h5"), *b = must_read("a.h5"), *laser = laser_new();
  assert_refused(a, b, "both have profiles");
  b->profiles.count = 0;
  assert_refused(a, b, "already, value by value");
  for (size_t c = 0; c < b->channel_count; c++) {
    b->channels[c].values[0] += 1;
  }
  assert_refused(a, b, "both have cycles");
  const size_t own = a->channel_count;
  a->channel_count = DEA_CHANNELS_MAX - 1;
  assert_refused(a, laser, "more than 32 channels");
  a->channel_count = own;
  laser->channels[1].time_s[1] = 0.1; // readings that end before the first cycle does
  assert_refused(a, laser, "covers none of the 3 cycles");
  laser->channels[1].time_s[1] = 2;
  // an hour later it was another measurement
  assert_int_equal(dea_recording_join(ctx, a, laser, 3600), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "they have no moment together"));
  dea_recording_destroy(ctx, laser);
  dea_recording_destroy(ctx, b);
  dea_recording_destroy(ctx, a);
}

static dea_status join_two(struct dea_context *own)
{
  struct dea_recording *a = NULL, *b = NULL;
  dea_status status = laser_make(own, &a);
  status = status == DEA_OK ? laser_make(own, &b) : status;
  for (size_t c = 0; status == DEA_OK && c < b->channel_count; c++) {
    b->channels[c].values[0] = -1; // another measurement
  }
  status = status == DEA_OK ? dea_recording_join(own, a, b, after_s) : status;
  dea_recording_destroy(own, b);
  dea_recording_destroy(own, a);
  return status;
}

TEST(test_without_memory)
{
  assert_true(failing_ends(join_two, DEA_OK) > 10);
}

TESTS_EACH(set_up, tear_down, NULL, nothing_open)
