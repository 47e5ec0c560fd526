/* .mat files: what dea_mat_write makes, as Octave reads it. */
#include "import/mat.h"
#include "octave.h"
#include "testing.h"

#include <hdf5.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { COUNT = 1000 };

static double values[COUNT];

static void fill(void)
{
  for (size_t i = 0; i < COUNT; i++) {
    values[i] = sin((double)i) * pow(10, (double)(i % 40) - 20);
  }
  values[7] = NAN;
  values[8] = -INFINITY;
}

TEST(test_octave_reads_version_5)
{
  fill();
  double rate = 1e4;
  const struct dea_mat_variable variables[] = {
      {.name = "voltage", .values = values, .count = COUNT},
      {.name = "rate", .values = &rate, .count = 1},
      {.name = "title", .text = "DEA 4, 3 kV"},
      {.name = "nothing", .values = values, .count = 0},
      {.name = "empty", .text = ""},
  };
  assert_int_equal(dea_mat_write(ctx, in_folder("out.mat"), variables, 5, DEA_MAT_5), DEA_OK);
  FILE *raw = fopen(in_folder("raw"), "wb"); // the same numbers another way
  assert_int_equal(fwrite(values, sizeof *values, COUNT, raw), COUNT);
  fclose(raw);
  octave("load out.mat; w = fread(fopen('raw'), Inf, 'double');"
         "assert(size(voltage), [1000 1]); assert(class(voltage), 'double');"
         "n = isnan(w); assert(isnan(voltage), n); assert(voltage(~n) == w(~n));"
         "assert(rate, 10000); assert(size(rate), [1 1]);"
         "assert(title, 'DEA 4, 3 kV'); assert(isempty(nothing));"
         "assert(isempty(empty) && ischar(empty))");
}

TEST(test_same_bytes)
{
  char a[8192], b[8192];
  const struct dea_mat_variable variable = {.name = "t", .values = values, .count = 100};
  for (int i = 0; i < 2; i++) {
    assert_int_equal(dea_mat_write(ctx, in_folder("same.mat"), &variable, 1, DEA_MAT_5), DEA_OK);
    FILE *file = fopen(in_folder("same.mat"), "rb");
    size_t n = fread(i == 0 ? a : b, 1, sizeof a, file);
    fclose(file);
    assert_in_range(n, 900, 1200);
  }
  assert_memory_equal(a, b, 900);
}

TEST(test_names)
{
  // the last one has 64 letters
  static const char *const bad[] = {
      "",    "1st", "_a",
      "a b", "a.b", "a234567890a234567890a234567890a234567890a234567890a234567890a234"};
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    const struct dea_mat_variable variable = {.name = bad[i], .values = values, .count = 1};
    assert_int_equal(dea_mat_write(ctx, in_folder("bad.mat"), &variable, 1, DEA_MAT_5),
                     DEA_E_ARGUMENT);
    assert_false(there("bad.mat"));
  }
}

TEST(test_too_large)
{
  const struct dea_mat_variable variable = {.name = "v", .values = values, .count = 268435456};
  assert_int_equal(dea_mat_write(ctx, in_folder("v.mat"), &variable, 1, DEA_MAT_5), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_context_message(ctx), "7.3"));
}

TEST(test_no_place)
{
  const struct dea_mat_variable variable = {.name = "v", .values = values, .count = COUNT};
  for (enum dea_mat_version v = DEA_MAT_5; v <= DEA_MAT_73; v++) {
    assert_int_equal(dea_mat_write(ctx, in_folder("no/v.mat"), &variable, 1, v), DEA_E_IO);
    assert_non_null(strstr(dea_context_message(ctx), "no/"));
  }
}

static dea_status read_file(const char *file, size_t *columns)
{
  struct dea_table *table;
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  dea_status status = dea_table_read(ctx, file, NULL, &table);
  *columns = status == DEA_OK ? table->column_count : 0;
  if (status == DEA_OK) {
    dea_table_destroy(ctx, table);
  }
  return status;
}

static dea_status read_back(const char *name, size_t *columns)
{
  return read_file(in_folder(name), columns);
}

/* The first `most` bytes of a file, and one more where `more` says so, under another name. */
static void copy_as(const char *from, const char *to, size_t most, const char *more)
{
  char bytes[8192];
  FILE *file = fopen(in_folder(from), "rb");
  assert_non_null(file);
  size_t n = fread(bytes, 1, most, file);
  fclose(file);
  file = fopen(in_folder(to), "wb");
  assert_true(fwrite(bytes, 1, n, file) == n && fputs(more, file) >= 0);
  fclose(file);
}

/* Known by their first bytes, whatever their name; version 4 by its name. */
TEST(test_recognised)
{
  size_t columns;
  const struct dea_mat_variable variables[] = {{.name = "t", .values = values, .count = 20},
                                               {.name = "v", .values = values, .count = 20}};
  fill();
  for (enum dea_mat_version v = DEA_MAT_5; v <= DEA_MAT_73; v++) {
    assert_int_equal(dea_mat_write(ctx, in_folder("a.mat"), variables, 2, v), DEA_OK);
    copy_as("a.mat", "a.dat", 8192, "");
    assert_int_equal(read_back("a.dat", &columns), DEA_OK);
    assert_int_equal(columns, 2);
  }
  // a text with the mark's place, or the first word, is none
  FILE *text = fopen(in_folder("marked.csv"), "w");
  fprintf(text, "%-125s,IMAGE\n", "MATRIX of voltages"); // "IM" at byte 126
  fprintf(text, "1,2\n3,4\n");
  fclose(text);
  assert_int_equal(read_back("marked.csv", &columns), DEA_OK);
  assert_int_equal(columns, 2);
  text = fopen(in_folder("word.csv"), "w");
  fprintf(text, "MATLAB v,%-150s\n1,2\n3,4\n", "b");
  fclose(text);
  assert_int_equal(read_back("word.csv", &columns), DEA_OK);
  assert_int_equal(columns, 2);
  static const unsigned char four[] = {0, 0, 0,   0,  2, 0, 0, 0,   1, 0, 0, 0, 0,
                                       0, 0, 0,   2,  0, 0, 0, 'a', 0, 0, 0, 0, 0,
                                       0, 0, 240, 63, 0, 0, 0, 0,   0, 0, 0, 64};
  FILE *old = fopen(in_folder("old.mat"), "wb"); // a = [1; 2] of version 4
  assert_int_equal(fwrite(four, 1, sizeof four, old), sizeof four);
  fclose(old);
  assert_int_equal(read_back("old.mat", &columns), DEA_OK);
  assert_int_equal(columns, 1);
  copy_as("old.mat", "cut.mat", sizeof four - 1, "");
  assert_int_equal(read_back("cut.mat", &columns), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "is longer than the file"));
}

/* libmatio takes what is cut off for the end of the file. */
TEST(test_cut_off)
{
  size_t columns;
  const struct dea_mat_variable variables[] = {{.name = "t", .values = values, .count = 20},
                                               {.name = "v", .values = values, .count = 20}};
  assert_int_equal(dea_mat_write(ctx, in_folder("five.mat"), variables, 2, DEA_MAT_5), DEA_OK);
  struct stat s;
  assert_int_equal(stat(in_folder("five.mat"), &s), 0);
  copy_as("five.mat", "cut.mat", (size_t)s.st_size - 1, "");
  assert_int_equal(read_back("cut.mat", &columns), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "is longer than the file"));
  copy_as("five.mat", "more.mat", (size_t)s.st_size, "12345678");
  assert_int_equal(read_back("more.mat", &columns), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "is cut off or damaged"));
  copy_as("five.mat", "first.mat", 128, ""); // nothing but the head
  assert_int_not_equal(read_back("first.mat", &columns), DEA_OK);
}

/* Files that made libmatio take gigabytes of memory: each is refused before. */
TEST(test_claims)
{
  static const char *const names[] = {"version", "order", "opaque", "sparse", "sparse-alone"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    char file[512];
    size_t columns;
    snprintf(file, sizeof file, "%s/tests/fuzz/seeds/import_mat/claims-%s.mat", DEA_SOURCE_DIR,
             names[i]);
    assert_int_equal(access(file, R_OK), 0);
    assert_int_equal(read_file(file, &columns), DEA_E_IO);
    assert_non_null(strstr(dea_context_message(ctx), "damaged"));
  }
}

/* What a file of version 7.3 names in another one, here a pipe that nobody writes to, is not
 * followed: libmatio would wait for it. */
TEST(test_other_files)
{
  size_t columns;
  const struct dea_mat_variable variable = {.name = "v", .values = values, .count = 20};
  fill();
  assert_int_equal(dea_mat_write(ctx, in_folder("l.mat"), &variable, 1, DEA_MAT_73), DEA_OK);
  assert_int_equal(read_back("l.mat", &columns), DEA_OK);
  assert_int_equal(mkfifo(in_folder("pipe"), 0600), 0);
  hid_t file = H5Fopen(in_folder("l.mat"), H5F_ACC_RDWR, H5P_DEFAULT);
  assert_true(file >= 0 &&
              H5Lcreate_external("pipe", "/w", file, "w", H5P_DEFAULT, H5P_DEFAULT) >= 0);
  H5Fclose(file);
  assert_int_equal(read_back("l.mat", &columns), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "refers to another file in 'w'"));
}

/* A file of PicoScope: Tstart is the time of its first sample, before the trigger; beside a mapping
 * that gives the rate too. */
TEST(test_start_before_the_trigger)
{
  static const char *const maps[] = {
      "dea-import: 1\ncolumns:\n  - {column: A, as: voltage, per_unit: 1 kV}\n",
      "dea-import: 1\nrate: 500 Hz\ncolumns:\n  - {column: A, as: voltage, per_unit: 1 kV}\n"};
  for (size_t k = 0; k < 2; k++) {
    struct dea_table *table;
    struct dea_mapping *mapping;
    struct dea_recording *recording;
    assert_int_equal(dea_mapping_read_memory(ctx, "map.yaml", maps[k], strlen(maps[k]), &mapping),
                     DEA_OK);
    assert_int_equal(
        dea_table_read(ctx, DEA_SOURCE_DIR "/lab/tests/cases/mat/pretrigger.mat", NULL, &table),
        DEA_OK);
    assert_int_equal(dea_table_record(ctx, table, mapping, &recording), DEA_OK);
    assert_int_equal(recording->channels[0].count, 6);
    assert_close(recording->channels[0].start_s, -0.003, 1e-12, 0);
    assert_close(recording->channels[0].interval_s, k == 0 ? 0.001 : 0.002, 1e-12, 0);
    assert_close(recording->channels[0].values[3], 1000, 1e-12, 0);
    dea_recording_destroy(ctx, recording);
    dea_mapping_destroy(ctx, mapping);
    dea_table_destroy(ctx, table);
  }
}

TESTS(set_up, tear_down)
