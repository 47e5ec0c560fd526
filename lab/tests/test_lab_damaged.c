/* lab/recording: damaged and hostile files are refused or told as what they are; no memory, no
 * disk. */
// ctest: quick, heavy
#include "failing_allocator.h"

#include "message_fixture.h"
#include "recording_files.h"

#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

static unsigned char *load(const char *name, size_t *length)
{
  *length = size_of(name);
  unsigned char *bytes = malloc(*length);
  FILE *file = fopen(in_folder(name), "rb");
  assert_true(bytes != NULL && file != NULL);
  assert_int_equal(fread(bytes, 1, *length, file), *length);
  fclose(file);
  return bytes;
}

static void save(const char *name, const unsigned char *bytes, size_t length)
{
  FILE *file = fopen(in_folder(name), "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, length, file), length);
  fclose(file);
}

/* A damaged file is refused with a sentence, or what is left of it is told as incomplete or right
 * in its lengths. */
static bool read_damaged(const char *name)
{
  struct dea_recording *recording;
  dea_status status = dea_recording_read(ctx, in_folder(name), &recording);
  if (status != DEA_OK) {
    assert_true(status == DEA_E_IO || status == DEA_E_UNSUPPORTED);
    assert_non_null(strstr(dea_context_message(ctx), name));
    assert_null(recording);
    return false;
  }
  size_t length = size_of(name);
  for (size_t c = 0; c < recording->channel_count; c++) {
    assert_true(recording->channels[c].count * sizeof(double) <= length);
  }
  dea_recording_destroy(ctx, recording);
  return true;
}

TEST(test_cut_files)
{
  size_t length;
  make("uncut.h5", false, 40, NULL);
  unsigned char *bytes = load("uncut.h5", &length);
  for (size_t cut = 0; cut < length; cut += cut < 5000 ? 97 : length / 61 + 13) {
    save("cut.h5", bytes, cut);
    assert_false(read_damaged("cut.h5")); // a finished file knows its length
  }
  free(bytes);
}

/* A file of a killed program that was cut too: values of before the cut, or nothing. */
TEST(test_cut_files_of_killed_programs)
{
  size_t length, read = 0;
  struct dea_recorder *recorder;
  assert_int_equal(sample_create(ctx, in_folder("open.h5"), false, 0, &recorder), DEA_OK);
  record(recorder, 40);
  unsigned char *bytes = load("open.h5", &length);
  assert_int_equal(dea_recorder_finish(recorder, NULL), DEA_OK);
  for (size_t cut = length; cut > 0; cut -= cut < length / 50 + 7 ? cut : length / 50 + 7) {
    struct dea_recording *recording;
    save("cut.h5", bytes, cut);
    if (dea_recording_read(ctx, in_folder("cut.h5"), &recording) == DEA_OK) {
      assert_false(recording->complete);
      sample_check(recording, 0, 0, 0, cut == length ? 40 : 0);
      dea_recording_destroy(ctx, recording);
      read++;
    }
  }
  free(bytes);
  print_message("%zu cut files were read\n", read);
  assert_true(read > 2);
}

TEST(test_flipped_bytes)
{
  size_t length, refused = 0;
  make("right.h5", false, 2, NULL);
  unsigned char *bytes = load("right.h5", &length);
  unsigned seed = 4711;
  for (int k = 0; k < 600; k++) {
    size_t at = (size_t)rand_r(&seed) % (k < 300 ? 16384 : length);
    unsigned char was = bytes[at];
    bytes[at] ^= (unsigned char)(1 << (rand_r(&seed) % 8));
    save("flipped.h5", bytes, length);
    refused += !read_damaged("flipped.h5");
    bytes[at] = was;
  }
  free(bytes);
  print_message("%zu of 600 were refused\n", refused);
  assert_true(refused > 20);
}

TEST(test_other_files_are_refused)
{
  save("text.h5", (const unsigned char *)"not at all", 10);
  assert_false(read_damaged("text.h5"));
  assert_false(read_damaged("nowhere.h5"));
  hid_t file = H5Fcreate(in_folder("empty.h5"), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(file);
  assert_false(read_damaged("empty.h5"));
  assert_false(read_damaged(".")); // a folder
}

typedef void (*change_fn)(hid_t file);

static void remove_link(hid_t file, const char *name)
{
  assert_true(H5Ldelete(file, name, H5P_DEFAULT) >= 0);
}

static void put_set(hid_t file, const char *name, hid_t type, int rank, hsize_t rows, hsize_t width)
{
  hsize_t size[2] = {rows, width}, most[2] = {H5S_UNLIMITED, width}, chunk[2] = {64, width};
  hid_t space = H5Screate_simple(rank, size, most), properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(properties, rank, chunk);
  if (H5Lexists(file, name, H5P_DEFAULT) > 0) {
    remove_link(file, name);
  }
  hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
  assert_true(set >= 0);
  H5Dclose(set);
  H5Pclose(properties);
  H5Sclose(space);
}

static void no_state(hid_t file)
{
  remove_link(file, "state");
}
static void no_time(hid_t file)
{
  remove_link(file, "channels/temperature/time");
}
static void state_of_numbers(hid_t file)
{
  put_set(file, "state", H5T_STD_I32LE, 1, 3, 1);
}
static void values_of_text(hid_t file)
{
  hid_t type = H5Tcopy(H5T_C_S1);
  put_set(file, "channels/voltage/values", type, 1, 5, 1);
  H5Tclose(type);
}
static void values_of_tables(hid_t file)
{
  put_set(file, "channels/voltage/values", H5T_IEEE_F64LE, 2, 5, 2);
}
static void absurdly_many_values(hid_t file)
{
  put_set(file, "channels/voltage/values", H5T_IEEE_F64LE, 1, (hsize_t)1 << 50, 1);
}
static void absurdly_wide_frames(hid_t file)
{
  put_set(file, "profiles/z_m", H5T_STD_I8LE, 2, 0, (hsize_t)1 << 25);
}
static void channel_is_a_set(hid_t file)
{
  remove_link(file, "channels/voltage");
  put_set(file, "channels/voltage", H5T_IEEE_F64LE, 1, 5, 1);
}
static void two_of_one_index(hid_t file)
{
  long long zero = 0;
  hid_t group = H5Gopen2(file, "channels/temperature", H5P_DEFAULT);
  hid_t index = H5Aopen(group, "index", H5P_DEFAULT);
  assert_true(index >= 0 && H5Awrite(index, H5T_NATIVE_LLONG, &zero) >= 0);
  H5Aclose(index);
  H5Gclose(group);
}
static void other_version(hid_t file)
{
  long long two = 2;
  hid_t version = H5Aopen(file, "version", H5P_DEFAULT);
  assert_true(version >= 0 && H5Awrite(version, H5T_NATIVE_LLONG, &two) >= 0);
  H5Aclose(version);
}
static void wild_cycle(hid_t file)
{
  const double rows[10] = {-1, 0, 0, 1, 0, 1e300, 0, 0, NAN, 0};
  hid_t cycles = H5Dopen2(file, "cycles", H5P_DEFAULT);
  assert_true(H5Dwrite(cycles, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows) >= 0);
  H5Dclose(cycles);
}

TEST(test_hostile_contents_are_refused)
{
  static const change_fn changes[] = {no_state,
                                      no_time,
                                      state_of_numbers,
                                      values_of_text,
                                      values_of_tables,
                                      other_version,
                                      absurdly_many_values,
                                      absurdly_wide_frames,
                                      channel_is_a_set,
                                      two_of_one_index,
                                      wild_cycle};
  for (size_t k = 0; k < sizeof changes / sizeof changes[0]; k++) {
    make("changed.h5", true, 2, NULL);
    hid_t file = H5Fopen(in_folder("changed.h5"), H5F_ACC_RDWR, H5P_DEFAULT);
    assert_true(file >= 0);
    changes[k](file);
    H5Fclose(file);
    if (read_damaged("changed.h5")) {
      fail_msg("change %zu was not found", k);
    }
    print_message("%s\n", dea_context_message(ctx));
  }
}

/* Chunks that the index does not have: the samples before them stay. */
TEST(test_missing_chunks_end_a_channel)
{
  make("sparse.h5", true, 2, NULL);
  hid_t file = H5Fopen(in_folder("sparse.h5"), H5F_ACC_RDWR, H5P_DEFAULT);
  const hsize_t more = 16384 + 10;
  hid_t set = H5Dopen2(file, "channels/voltage/values", H5P_DEFAULT);
  assert_true(H5Dset_extent(set, &more) >= 0);
  H5Dclose(set);
  H5Fclose(file);
  struct dea_recording *recording = must_read("sparse.h5");
  assert_false(recording->complete);
  assert_non_null(strstr(recording->ended, "samples are missing"));
  assert_true(recording->channels[0].count <= 16384);
  dea_recording_destroy(ctx, recording);
}

// Memory and disk --------------------------------------------------------------------------------

static dea_status read_whole(struct dea_context *context)
{
  struct dea_recording *recording;
  dea_status status = dea_recording_read(context, in_folder("whole.h5"), &recording);
  dea_recording_destroy(context, recording);
  return status;
}

static dea_status write_short(struct dea_context *context)
{
  struct dea_recorder *recorder;
  unlink(in_folder("memory.h5"));
  dea_status status = sample_create(context, in_folder("memory.h5"), false, 0, &recorder);
  if (status != DEA_OK) {
    assert_null(recorder);
    assert_false(there("memory.h5"));
    return status;
  }
  status = sample_add(recorder, 0, 10);
  dea_status finished = dea_recorder_finish(recorder, NULL);
  return status != DEA_OK ? status : finished;
}

TEST(test_out_of_memory)
{
  make("whole.h5", false, 2, NULL);
  assert_true(failing_ends(read_whole, DEA_OK) > 10);
  assert_true(failing_ends(write_short, DEA_OK) > 5);
}

/* A disk that is full: every call says so, nothing hangs, and what was flushed is readable. */
TEST(test_full_disk)
{
  struct rlimit before, small;
  struct dea_recorder *recorder;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  small = before;
  for (rlim_t limit = 6000; limit < 700000; limit += limit / 5) {
    small.rlim_cur = limit;
    unlink(in_folder("full.h5"));
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    dea_status status = sample_create(ctx, in_folder("full.h5"), false, 0, &recorder);
    size_t cycles = 0;
    for (size_t i = 0; i < 200 && status == DEA_OK; i++) {
      struct dea_recorded_cycle cycle = sample_cycle(i);
      sample_add(recorder, i * SAMPLE_CYCLE, SAMPLE_CYCLE);
      sample_add_reading(recorder, i);
      sample_add_frame(recorder, i);
      status = dea_recorder_add_cycle(recorder, &cycle);
      cycles += status == DEA_OK;
    }
    assert_int_equal(status, DEA_E_IO);
    assert_non_null(strstr(dea_context_message(ctx), "full.h5"));
    if (recorder != NULL) {
      assert_int_equal(dea_recorder_sync(recorder), DEA_E_IO);
      assert_int_equal(dea_recorder_finish(recorder, "full"), DEA_E_IO);
    }
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    if (recorder != NULL) {
      struct dea_recording *recording = must_read("full.h5");
      assert_false(recording->complete);
      sample_check(recording, cycles * SAMPLE_CYCLE, cycles, cycles, cycles);
      dea_recording_destroy(ctx, recording);
    }
  }
  signal(SIGXFSZ, handler);
}

/* Another program cuts off the file that is being written: that is an error, not a wait, and HDF5
 * is left as it should be. */
TEST(test_cut_while_it_is_written)
{
  static const long sizes[] = {0, 3000, 5000, 20000, 60000};
  for (size_t k = 0; k < 2 * sizeof sizes / sizeof sizes[0]; k++) {
    struct dea_recorder *recorder;
    dea_status status = DEA_OK;
    unlink(in_folder("cut.h5"));
    assert_int_equal(sample_create(ctx, in_folder("cut.h5"), false, 0, &recorder), DEA_OK);
    record(recorder, k % 2 == 0 ? 40 : 0);
    assert_int_equal(dea_recorder_sync(recorder), DEA_OK);
    assert_int_equal(truncate(in_folder("cut.h5"), k % 2 == 0 ? sizes[k / 2] : 100), 0);
    for (size_t i = 0; i < 100 && status == DEA_OK; i++) {
      struct dea_recorded_cycle cycle = sample_cycle(100 + i);
      status = dea_recorder_add_cycle(recorder, &cycle);
    }
    assert_message(status, DEA_E_IO, "cut.h5: another program has cut it off");
    assert_int_equal(dea_recorder_sync(recorder), DEA_E_IO);
    assert_int_equal(dea_recorder_finish(recorder, NULL), DEA_E_IO);
  }
}

static void link_outside(hid_t file)
{
  remove_link(file, "cycles");
  assert_true(H5Lcreate_external(in_folder("pipe"), "/cycles", file, "cycles", H5P_DEFAULT,
                                 H5P_DEFAULT) >= 0);
}

static void link_outside_of_any_name(hid_t file)
{
  hid_t group = H5Gopen2(file, "channels/voltage", H5P_DEFAULT);
  assert_true(H5Lcreate_external(in_folder("pipe"), "/", group, "x", H5P_DEFAULT, H5P_DEFAULT) >=
              0);
  H5Gclose(group);
}

static void data_outside(hid_t file)
{
  hsize_t size = 10;
  hid_t space = H5Screate_simple(1, &size, NULL), properties = H5Pcreate(H5P_DATASET_CREATE);
  assert_true(H5Pset_external(properties, in_folder("pipe"), 0, 80) >= 0);
  hid_t set = H5Dcreate2(file, "x", H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT);
  assert_true(set >= 0);
  H5Dclose(set);
  H5Pclose(properties);
  H5Sclose(space);
}

static void virtual_data(hid_t file)
{
  hsize_t size = 10;
  hid_t space = H5Screate_simple(1, &size, NULL), properties = H5Pcreate(H5P_DATASET_CREATE);
  assert_true(H5Pset_virtual(properties, space, in_folder("pipe"), "/x", space) >= 0);
  hid_t set = H5Dcreate2(file, "x", H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT);
  assert_true(set >= 0);
  H5Dclose(set);
  H5Pclose(properties);
  H5Sclose(space);
}

/* What lies in another file, here a pipe that nobody writes to, is not followed. */
TEST(test_other_files_are_not_followed)
{
  static const change_fn changes[] = {link_outside, link_outside_of_any_name, data_outside,
                                      virtual_data};
  assert_int_equal(mkfifo(in_folder("pipe"), 0600), 0);
  for (size_t k = 0; k < sizeof changes / sizeof changes[0]; k++) {
    struct dea_recording *recording;
    make("outer.h5", true, 2, NULL);
    hid_t file = H5Fopen(in_folder("outer.h5"), H5F_ACC_RDWR, H5P_DEFAULT);
    changes[k](file);
    H5Fclose(file);
    assert_message(dea_recording_read(ctx, in_folder("outer.h5"), &recording), DEA_E_IO,
                   "refers to another file in '");
  }
}

TESTS_EACH(set_up, tear_down, NULL, nothing_open)
