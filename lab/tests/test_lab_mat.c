/* .mat files of version 5 and 7.3 (lab/tests/cases/mat): numbers to the last bit, also of what is
 * cut off, damaged, or made to look like more. */
#include "base/h5.h"
#include "import/import.h"
#include "own_folder.h"
#include "testing.h"

#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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

/* The first `most` bytes of a case, and one more where `more` says so, under another name. */
static void copy_as(const char *from, const char *to, size_t most, const char *more)
{
  char bytes[8192], source[512];
  snprintf(source, sizeof source, "%s/lab/tests/cases/mat/%s", DEA_SOURCE_DIR, from);
  FILE *file = fopen(source, "rb");
  assert_non_null(file);
  size_t n = fread(bytes, 1, most, file);
  fclose(file);
  file = fopen(in_folder(to), "wb");
  assert_true(fwrite(bytes, 1, n, file) == n && fputs(more, file) >= 0);
  fclose(file);
}

/* The numbers of both files: 20 times and values, of which one is none. */
static void check_numbers(const char *name)
{
  struct dea_table *table;
  assert_int_equal(dea_table_read(ctx, in_folder(name), NULL, &table), DEA_OK);
  assert_int_equal(table->column_count, 2);
  assert_string_equal(table->note, "words: some words");
  for (size_t i = 0; i < 20; i++) {
    const double t = 1e-3 * (double)i, v = 1000.0 * (double)(i * i) / 7;
    assert_true(table->columns[0].values[i] == t);
    assert_true(i == 3 ? isnan(table->columns[1].values[i]) : table->columns[1].values[i] == v);
  }
  dea_table_destroy(ctx, table);
}

/* Known by their first bytes, whatever their name. */
TEST(test_recognised)
{
  size_t columns;
  static const char *const cases[] = {"five.mat", "seven.mat"};
  for (size_t i = 0; i < 2; i++) {
    copy_as(cases[i], "a.dat", 8192, "");
    check_numbers("a.dat");
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
  FILE *old = fopen(in_folder("old.mat"), "wb"); // as version 4 begins
  assert_true(fputs("of none", old) >= 0);
  fclose(old);
  assert_int_equal(read_back("old.mat", &columns), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "is no .mat file of version 5 or 7.3"));
}

/* A timetable, as MATLAB marks it. */
TEST(test_timetable)
{
  size_t count;
  const uint32_t numbers[6] = {3707764736u, 2, 1, 1, 1, 1};
  const hsize_t dims[2] = {6, 1};
  struct h5 h;
  copy_as("seven.mat", "new.mat", 8192, "");
  dea_h5_begin(&h, ctx, in_folder("new.mat"));
  hid_t file = H5Fopen(in_folder("new.mat"), H5F_ACC_RDWR, H5P_DEFAULT);
  assert_true(file >= 0);
  hid_t space = H5Screate_simple(2, dims, NULL);
  hid_t set = H5Dcreate2(file, "log", H5T_STD_U32LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Dwrite(set, H5T_NATIVE_UINT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >= 0);
  hid_t type = H5Tcopy(H5T_C_S1), scalar = H5Screate(H5S_SCALAR);
  H5Tset_size(type, 9);
  hid_t attribute = H5Acreate2(set, "MATLAB_class", type, scalar, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Awrite(attribute, type, "timetable") >= 0);
  H5Aclose(attribute);
  H5Sclose(scalar);
  H5Tclose(type);
  H5Dclose(set);
  H5Sclose(space);
  H5Fclose(file);
  dea_h5_end(&h);
  dea_finding_clear(ctx);
  check_numbers("new.mat");
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  assert_true(count > 0 && strstr(findings[0].text, "'log' is an object") != NULL);
}

/* libmatio takes what is cut off for the end of the file. */
TEST(test_cut_off)
{
  size_t columns;
  struct stat s;
  assert_int_equal(stat(DEA_SOURCE_DIR "/lab/tests/cases/mat/five.mat", &s), 0);
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
  static const char *const names[] = {"order", "opaque", "sparse", "sparse-alone"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    char file[512];
    size_t columns;
    snprintf(file, sizeof file, "%s/tests/fuzz/seeds/import_mat/claims-%s.mat", DEA_SOURCE_DIR,
             names[i]);
    assert_int_equal(access(file, R_OK), 0);
    assert_int_equal(read_file(file, &columns), DEA_E_IO);
    assert_non_null(strstr(dea_context_message(ctx), i == 0 ? "is no .mat file" : "damaged"));
  }
}

/* What a file of version 7.3 names in another one, here a pipe that nobody writes to, is not
 * followed: libmatio would wait for it. */
TEST(test_other_files)
{
  size_t columns;
  copy_as("seven.mat", "l.mat", 8192, "");
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
