/* lab/recording: what goes into a file comes out of it. */
#include "recording_files.h"

#include <string.h>

TEST(test_recording_comes_back_as_it_was)
{
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

TEST(test_index_of_a_time)
{
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

TEST(test_early_end_is_told)
{
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
TEST(test_copy_is_of_the_old_format)
{
  unsigned char head[9] = {0};
  make("plain.h5", true, 1, NULL);
  FILE *file = fopen(in_folder("plain.h5"), "rb");
  assert_non_null(file);
  assert_int_equal(fread(head, 1, sizeof head, file), sizeof head);
  fclose(file);
  assert_int_equal(head[8], 0);
}

/* What a reader in another program sees while the file is being written. */
TEST(test_reading_while_recording)
{
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

TEST(test_wrong_calls_are_refused_and_harm_nothing)
{
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

TEST(test_names_and_options)
{
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

// Of other programs -------------------------------------------------------------------------------

/* A text as h5py writes it: of any length, UTF-8; or of a fixed one in ASCII. */
static void put_text(hid_t object, const char *name, const char *text, bool any, bool attribute)
{
  hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  H5Tset_size(type, any ? H5T_VARIABLE : strlen(text));
  H5Tset_strpad(type, any ? H5T_STR_NULLTERM : H5T_STR_NULLPAD);
  H5Tset_cset(type, any ? H5T_CSET_UTF8 : H5T_CSET_ASCII);
  hid_t id = attribute
                 ? H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT)
                 : H5Dcreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const void *from = any ? (const void *)&text : text;
  assert_true((attribute ? H5Awrite(id, type, from)
                         : H5Dwrite(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, from)) >= 0);
  H5Idec_ref(id);
  H5Sclose(space);
  H5Tclose(type);
}

static void put_number(hid_t object, const char *name, hid_t type, const void *value)
{
  hid_t space = H5Screate(H5S_SCALAR);
  hid_t id = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Awrite(id, type, value) >= 0);
  H5Aclose(id);
  H5Sclose(space);
}

enum { FOREIGN = 8000 };
struct foreign {
  bool any, attributes, deflated; // texts of any length; title and state as attributes
  hid_t number;                   // of the values in the file
  const char *unit, *left_out;    // attribute of the channels
};

/* The recording of the table in lab/docs/bench.md, without what it may lack. */
static void make_foreign(const char *name, const struct foreign *f)
{
  static double values[FOREIGN];
  static const char *const names[][2] = {{"HV", "voltage"}, {"laser", "displacement"}};
  hid_t file = H5Fcreate(in_folder(name), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  hsize_t size = FOREIGN, chunk = 1000;
  hid_t space = H5Screate_simple(1, &size, NULL), properties = H5Pcreate(H5P_DATASET_CREATE);
  if (f->deflated) {
    H5Pset_chunk(properties, 1, &chunk);
    H5Pset_deflate(properties, 4);
  }
  const long long one = 1;
  put_text(file, "format", "dea recording", f->any, true);
  put_number(file, "version", H5T_NATIVE_LLONG, &one);
  put_text(file, "title", "by h5py", f->any, f->attributes);
  put_text(file, "state", "complete", f->any, f->attributes);
  hid_t channels = H5Gcreate2(file, "channels", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  for (long long c = 0; c < 2; c++) {
    hid_t group = H5Gcreate2(channels, names[c][0], H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const double start_s = 0.5, interval_s = 1e-3, filter_Hz = NAN;
    put_text(group, "name", names[c][0], f->any, true);
    put_text(group, "quantity", names[c][1], f->any, true);
    put_text(group, "unit", c == 0 ? f->unit : "m", f->any, true);
    put_number(group, "index", H5T_NATIVE_LLONG, &c);
    put_number(group, "start_s", H5T_NATIVE_DOUBLE, &start_s);
    put_number(group, "interval_s", H5T_NATIVE_DOUBLE, &interval_s);
    put_number(group, "filter_Hz", H5T_NATIVE_DOUBLE, &filter_Hz);
    H5Adelete(group, f->left_out);
    for (size_t i = 0; i < FOREIGN; i++) {
      values[i] = (double)i * (c == 0 ? 0.25 : 0.125);
    }
    hid_t set = H5Dcreate2(group, "values", f->number, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Dclose(set);
    H5Gclose(group);
  }
  H5Gclose(channels);
  H5Pclose(properties);
  H5Sclose(space);
  H5Fclose(file);
}

TEST(test_of_other_programs)
{
  const struct foreign read[] = {{true, true, false, H5T_IEEE_F64LE, "V", ""},
                                 {true, false, true, H5T_IEEE_F64LE, "V", ""},
                                 {false, false, false, H5T_IEEE_F32BE, "V", ""},
                                 {false, true, true, H5T_IEEE_F32LE, "V", ""}};
  dea_context_clear(ctx);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL); // of what is left out, nothing
  for (size_t k = 0; k < sizeof read / sizeof read[0]; k++) {
    make_foreign("mine.h5", &read[k]);
    struct dea_recording *recording = must_read("mine.h5");
    assert_true(recording->complete);
    assert_string_equal(recording->title, "by h5py");
    assert_int_equal(recording->channel_count, 2);
    assert_int_equal(recording->cycle_count, 0);
    for (size_t c = 0; c < 2; c++) {
      const struct dea_channel *channel = &recording->channels[c];
      assert_string_equal(channel->name, c == 0 ? "HV" : "laser");
      assert_int_equal(channel->kind, c == 0 ? DEA_CHANNEL_VOLTAGE : DEA_CHANNEL_DISPLACEMENT);
      assert_true(channel->count == FOREIGN && channel->start_s == 0.5 &&
                  channel->interval_s == 1e-3 && isnan(channel->filter_Hz));
      for (size_t i = 0; i < FOREIGN; i++) {
        assert_true(channel->values[i] == (double)i * (c == 0 ? 0.25 : 0.125));
      }
    }
    dea_recording_destroy(ctx, recording);
  }
  const struct {
    struct foreign file;
    const char *message;
  } refused[] = {
      {{true, true, false, H5T_IEEE_F64LE, "kV", ""},
       "'HV' is in 'kV', and a recording has it in V"},
      {{true, true, false, H5T_IEEE_F64LE, "V", "index"}, "the attribute 'index' is missing"},
      {{true, true, false, H5T_IEEE_F64LE, "V", "quantity"},
       "the attribute 'quantity' is missing"}};
  for (size_t k = 0; k < sizeof refused / sizeof refused[0]; k++) {
    struct dea_recording *recording;
    make_foreign("mine.h5", &refused[k].file);
    assert_int_equal(dea_recording_read(ctx, in_folder("mine.h5"), &recording), DEA_E_IO);
    if (strstr(dea_context_message(ctx), refused[k].message) == NULL) {
      fail_msg("'%s' lacks '%s'", dea_context_message(ctx), refused[k].message);
    }
  }
}

TESTS_EACH(set_up, tear_down, NULL, nothing_open)
