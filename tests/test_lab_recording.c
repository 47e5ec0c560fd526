/* lab/recording: what goes into a file comes out of it. */
#define _GNU_SOURCE
#include "recording_files.h"

#include <string.h>

static void test_recording_comes_back_as_it_was(void **state)
{
  (void)state;
  for (int plain = 0; plain < 2; plain++) {
    make("whole.h5", plain, 200, NULL);
    struct dea_recording *recording = must_read("whole.h5");
    assert_true(recording->complete);
    assert_string_equal(recording->ended, "");
    sample_check(recording, (size_t)200 * SAMPLE_CYCLE, 200, 200, 200);
    assert_int_equal(recording->cycle_count, 200);
    assert_int_equal(recording->profiles.count, 200);
    assert_ptr_equal(dea_recording_kind(recording, DEA_CHANNEL_DISPLACEMENT),
                     &recording->channels[1]);
    assert_null(dea_recording_kind(recording, DEA_CHANNEL_FORCE));
    assert_ptr_equal(dea_recording_channel(recording, "temperature"), &recording->channels[2]);
    assert_null(dea_recording_channel(recording, "temperatur"));
    dea_recording_destroy(ctx, recording);
  }
}

static void test_index_of_a_time(void **state)
{
  (void)state;
  double times[] = {1, 2, 2.5, 7};
  struct dea_channel channel = {.start_s = 10, .interval_s = 0.5, .count = 4};
  assert_int_equal(dea_channel_index(&channel, 9), 0);
  assert_int_equal(dea_channel_index(&channel, 10.5), 1);
  assert_int_equal(dea_channel_index(&channel, 10.6), 2);
  assert_int_equal(dea_channel_index(&channel, 99), 4);
  channel.interval_s = 0;
  channel.time_s = times;
  assert_int_equal(dea_channel_index(&channel, 2.5), 2);
  assert_int_equal(dea_channel_index(&channel, 2.6), 3);
}

static void test_early_end_is_told(void **state)
{
  (void)state;
  make("early.h5", false, 3, "the current was above 200 uA");
  struct dea_recording *recording = must_read("early.h5");
  assert_false(recording->complete);
  assert_string_equal(recording->ended, "the current was above 200 uA");
  sample_check(recording, (size_t)3 * SAMPLE_CYCLE, 3, 3, 3);
  // and so it is of a copy, which is the same in all else
  assert_int_equal(dea_recording_write(ctx, recording, in_folder("copy.h5")), DEA_OK);
  struct dea_recording *copy = must_read("copy.h5");
  assert_false(copy->complete);
  assert_string_equal(copy->ended, recording->ended);
  sample_check(copy, recording->channels[0].count, 3, 3, 3);
  assert_int_equal(copy->channels[1].count, recording->channels[1].count);
  dea_recording_destroy(ctx, copy);
  // nothing is written over
  assert_int_equal(dea_recording_write(ctx, recording, in_folder("copy.h5")), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "exists"));
  assert_true(there("copy.h5"));
  dea_recording_destroy(ctx, recording);
}

/* Programs with HDF5 1.8 read what has the first superblock. */
static void test_copy_is_of_the_old_format(void **state)
{
  (void)state;
  unsigned char head[9] = {0};
  make("plain.h5", true, 1, NULL);
  FILE *file = fopen(in_folder("plain.h5"), "rb");
  assert_non_null(file);
  assert_int_equal(fread(head, 1, sizeof head, file), sizeof head);
  fclose(file);
  assert_int_equal(head[8], 0);
}

/* What a reader in another program sees while the file is being written. */
static void test_reading_while_recording(void **state)
{
  (void)state;
  struct dea_recorder *recorder;
  char command[1500];
  assert_int_equal(sample_create(ctx, in_folder("live.h5"), false, 100, &recorder), DEA_OK);
  record(recorder, 5);
  assert_int_equal(sample_add(recorder, 1, 1), DEA_OK); // not flushed
  snprintf(command, sizeof command, "cp '%s' ", in_folder("live.h5"));
  strcat(command, in_folder("seen.h5"));
  assert_int_equal(system(command), 0);
  struct dea_recording *seen = must_read("seen.h5");
  assert_false(seen->complete);
  sample_check(seen, (size_t)5 * SAMPLE_CYCLE, 5, 5, 5);
  dea_recording_destroy(ctx, seen);
  assert_int_equal(dea_recorder_finish(recorder, NULL), DEA_OK);
}

static void test_wrong_calls_are_refused_and_harm_nothing(void **state)
{
  (void)state;
  struct dea_recorder *recorder, *second;
  const double zero = 0;
  assert_int_equal(sample_create(ctx, in_folder("calls.h5"), false, 0, &recorder), DEA_OK);
  assert_int_equal(sample_create(ctx, in_folder("calls.h5"), false, 0, &second), DEA_E_IO);
  assert_int_equal(dea_recorder_add(recorder, 3, &zero, 1), DEA_E_ARGUMENT);
  assert_int_equal(dea_recorder_add(recorder, 2, &zero, 1), DEA_E_ARGUMENT);
  assert_int_equal(dea_recorder_add_timed(recorder, 0, &zero, &zero, 1), DEA_E_ARGUMENT);
  record(recorder, 2);
  assert_int_equal(dea_recorder_add_timed(recorder, 2, &zero, &zero, 1), DEA_E_ARGUMENT);
  assert_int_equal(dea_recorder_add_profile(recorder, 0, &zero), DEA_E_ARGUMENT);
  assert_int_equal(dea_recorder_add_profile(recorder, NAN, &zero), DEA_E_ARGUMENT);
  assert_int_equal(dea_recorder_finish(recorder, NULL), DEA_OK);
  assert_int_equal(dea_recorder_finish(NULL, NULL), DEA_OK);
  struct dea_recording *recording = must_read("calls.h5");
  assert_true(recording->complete);
  sample_check(recording, (size_t)2 * SAMPLE_CYCLE, 2, 2, 2);
  dea_recording_destroy(ctx, recording);
}

static void test_names_and_options(void **state)
{
  (void)state;
  struct dea_recorder_channel channels[] = {{"a/b", DEA_CHANNEL_OTHER, "", 0, 1, NAN, 0, 0},
                                            {"a_b", DEA_CHANNEL_OTHER, "1/s", 0, 1, NAN, 0, 0},
                                            {".", DEA_CHANNEL_OTHER, NULL, 0, 1, NAN, 0, 0},
                                            {"..", DEA_CHANNEL_FORCE, NULL, 0, 1, NAN, 0, 0},
                                            {"Kraft Ä µ", DEA_CHANNEL_FORCE, NULL, 0, 1, NAN, 0, 0},
                                            {"/", DEA_CHANNEL_FORCE, NULL, 0, 1, NAN, 0, 0},
                                            {"a_b (2)", DEA_CHANNEL_FORCE, NULL, 0, 1, NAN, 0, 0}};
  enum { COUNT = sizeof channels / sizeof channels[0] };
  struct dea_recorder_options options = {.channels = channels, .channel_count = COUNT};
  struct dea_recorder *recorder;
  assert_int_equal(dea_recorder_create(ctx, in_folder("names.h5"), &options, &recorder), DEA_OK);
  for (size_t c = 0; c < COUNT; c++) {
    const double value = (double)c;
    assert_int_equal(dea_recorder_add(recorder, c, &value, 1), DEA_OK);
  }
  assert_int_equal(dea_recorder_finish(recorder, ""), DEA_OK);
  struct dea_recording *recording = must_read("names.h5");
  assert_true(recording->complete && recording->channel_count == COUNT);
  assert_true(recording->title[0] == '\0' && recording->protocol == NULL);
  for (size_t c = 0; c < COUNT; c++) {
    assert_string_equal(recording->channels[c].name, channels[c].name);
    assert_true(recording->channels[c].count == 1 && recording->channels[c].values[0] == (double)c);
  }
  dea_recording_destroy(ctx, recording);
  const char *wrong[] = {"", "a/b",
                         "a name that goes on and on, and that is much longer than names can be"};
  for (size_t k = 0; k < 3; k++) {
    channels[1].name = wrong[k];
    assert_int_equal(dea_recorder_create(ctx, in_folder("no.h5"), &options, &recorder),
                     DEA_E_ARGUMENT);
    assert_null(recorder);
  }
  const double falling[] = {1, 0};
  options = (struct dea_recorder_options){.profile_points = 2, .x_m = falling};
  assert_int_equal(dea_recorder_create(ctx, in_folder("no.h5"), &options, &recorder),
                   DEA_E_ARGUMENT);
  options.profile_points = 0;
  assert_int_equal(dea_recorder_create(ctx, in_folder("no/no.h5"), &options, &recorder), DEA_E_IO);
  assert_false(there("no.h5"));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_recording_comes_back_as_it_was, nothing_open),
      cmocka_unit_test_teardown(test_index_of_a_time, nothing_open),
      cmocka_unit_test_teardown(test_early_end_is_told, nothing_open),
      cmocka_unit_test_teardown(test_copy_is_of_the_old_format, nothing_open),
      cmocka_unit_test_teardown(test_reading_while_recording, nothing_open),
      cmocka_unit_test_teardown(test_wrong_calls_are_refused_and_harm_nothing, nothing_open),
      cmocka_unit_test_teardown(test_names_and_options, nothing_open),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
