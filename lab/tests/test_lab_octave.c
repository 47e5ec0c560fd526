/* Files that Octave wrote, read to the last bit. */
#include "import_text.h"
#include "octave.h"

enum { COUNT = 501 };

static double time_s[COUNT], voltage[COUNT], laser[COUNT];

/* The numbers that all files of these tests hold. */
#define NUMBERS                                                                                    \
  "t = (0:500)' / 1000; v = 1e3 * sin(7 * t) .^ 3 / 3; z = cos(t) * 1e-5 / 7; v(8) = NaN;"         \
  "f = fopen('raw', 'w'); fwrite(f, [t; v; z], 'double'); fclose(f);"

static void numbers_back(void)
{
  static double all[3 * COUNT];
  assert_int_equal(read_raw("raw", all, 3 * COUNT), 3 * COUNT);
  memcpy(time_s, all, sizeof time_s);
  memcpy(voltage, all + COUNT, sizeof voltage);
  memcpy(laser, all + 2 * COUNT, sizeof laser);
}

static void read_file(const char *name)
{
  if (read_table(in_folder(name)) != DEA_OK) {
    fail_msg("%s: %s", name, dea_context_message(ctx));
  }
}

static void check(const char *name, const char *v, const char *z)
{
  read_file(name);
  assert_column("t", "", time_s, COUNT);
  assert_column(v, "", voltage, COUNT);
  assert_column(z, "", laser, COUNT);
}

TEST(test_mat)
{
  octave(NUMBERS "data.v = v'; data.deep.z = z; save('-v6', 'six.mat', 't', 'data');"
                 "save('-v7', 'seven.mat', 't', 'data')");
  numbers_back();
  check("six.mat", "data.v", "data.deep.z");
  check("seven.mat", "data.v", "data.deep.z");
}

/* MATLAB's variables carry units in their names only. */
TEST(test_mat_units)
{
  octave(NUMBERS
         "data.voltage_kV = v; z_um = [z z]; save('-v6', 'units.mat', 't', 'data', 'z_um')");
  numbers_back();
  read_file("units.mat");
  assert_column("t", "", time_s, COUNT);
  assert_column("data.voltage_kV", "kV", voltage, COUNT);
  assert_column("z_um(2)", "um", laser, COUNT);
}

TEST(test_mat_classes)
{
  static const double i8[] = {-128, 127}, u16[] = {0, 65535}, b[] = {1, 0}, m1[] = {1, 3, 5},
                      m2[] = {2, 4, 6}, s[] = {0.5, -0.25}, i64[] = {-4503599627370497.0, 5};
  octave("a = int8([-128 127]); b = uint16([0; 65535]); c = [true false]; d = single([0.5 -0.25]);"
         "e = int64([-4503599627370497 5]); m = [1 2; 3 4; 5 6]; x = 1 + 2i; n = []; k = {1, 2};"
         "w = ones(2, 2, 2); fs = 1000; s = 'some words'; r(2).q = 3;"
         "save('-v7', 'classes.mat', 'a', 'b', 'c', 'd', 'e', 'm', 'x', 'n', 'k', 'w', 'fs', 's', "
         "'r')");
  read_file("classes.mat");
  assert_column("a", "", i8, 2);
  assert_column("b", "", u16, 2);
  assert_column("c", "", b, 2);
  assert_column("d", "", s, 2);
  assert_column("e", "", i64, 2);
  assert_column("m(1)", "", m1, 3);
  assert_column("m(2)", "", m2, 3);
  assert_int_equal(table->column_count, 8);
  assert_string_equal(table->note, "s: some words");
  assert_true(is_said(DEA_NOTE, "'x' is complex"));
  assert_true(is_said(DEA_NOTE, "'k' is a cell array"));
  assert_true(is_said(DEA_NOTE, "'w' has more than two dimensions"));
  assert_true(is_said(DEA_NOTE, "'r' is an array of structs"));
}

TEST(test_damaged_mat)
{
  static unsigned char bytes[1 << 16];
  octave(NUMBERS "save('-v6', 'whole.mat', 't', 'v')");
  FILE *file = fopen(in_folder("whole.mat"), "rb");
  size_t n = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  write_bytes("short.mat", bytes, n / 2);
  assert_int_equal(read_table(in_folder("short.mat")), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "longer than the file"));
  assert_refused("no.mat", "not a .mat file at all", 22, 0, "is no .mat file of version 5 or 7.3");
  // a length that the file cannot have: the number of rows of the first variable
  bytes[128 + 32 + 3] = 0x7f;
  write_bytes("claims.mat", bytes, n);
  assert_int_equal(read_table(in_folder("claims.mat")), DEA_E_IO);
}

/* All digits of a double: 17 of them come back as they were. */
TEST(test_csv)
{
  octave(NUMBERS "dlmwrite('semicolon.csv', [t v z], 'delimiter', ';', 'precision', '%.17g');"
                 "dlmwrite('tab.txt', [t v z], 'delimiter', '\\t', 'precision', '%.17g');"
                 "csvwrite('comma.csv', [t v z], 'precision', '%.17g');"
                 "f = fopen('head.csv', 'w'); fprintf(f, '# measured\\nt,v,z\\n');"
                 "fprintf(f, '%.17g,%.17g,%.17g\\n', [t v z]'); fclose(f);"
                 "save('-text', 'octave.txt', 't')");
  numbers_back();
  check("head.csv", "v", "z");
  static const char *const bare[] = {"semicolon.csv", "tab.txt", "comma.csv"};
  for (size_t i = 0; i < 3; i++) {
    read_file(bare[i]);
    assert_column("column 1", "", time_s, COUNT);
    assert_column("column 2", "", voltage, COUNT);
    assert_column("column 3", "", laser, COUNT);
  }
  read_file("octave.txt"); // "# name: t" and the like are comments
  assert_int_equal(table->columns[0].count, COUNT);
}

TESTS(set_up, import_tear_down)
