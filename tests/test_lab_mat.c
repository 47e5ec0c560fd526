/* .mat files: what dea_mat_write makes, as Octave reads it. */
#define _GNU_SOURCE
#include "lab/import/mat.h"
#include "octave.h"
#include "testing.h"

#include <string.h>

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

static void test_octave_reads_version_5(void **state)
{
  (void)state;
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

static void test_same_bytes(void **state)
{
  (void)state;
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

static void test_names(void **state)
{
  (void)state;
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

static void test_too_large(void **state)
{
  (void)state;
  const struct dea_mat_variable variable = {.name = "v", .values = values, .count = 268435456};
  assert_int_equal(dea_mat_write(ctx, in_folder("v.mat"), &variable, 1, DEA_MAT_5), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_context_message(ctx), "7.3"));
}

static void test_no_place(void **state)
{
  (void)state;
  const struct dea_mat_variable variable = {.name = "v", .values = values, .count = COUNT};
  for (enum dea_mat_version v = DEA_MAT_5; v <= DEA_MAT_73; v++) {
    assert_int_equal(dea_mat_write(ctx, in_folder("no/v.mat"), &variable, 1, v), DEA_E_IO);
    assert_non_null(strstr(dea_context_message(ctx), "no/"));
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_octave_reads_version_5),
      cmocka_unit_test(test_same_bytes),
      cmocka_unit_test(test_names),
      cmocka_unit_test(test_too_large),
      cmocka_unit_test(test_no_place),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
