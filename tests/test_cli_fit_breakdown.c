#define _GNU_SOURCE
/* dea fit of breakdown tests, as a user runs it: the example, its files, what may be wrong. */
#include "command.h"

/* A table and keys of the fit file; the exit code and one message are wanted. */
static void expect(const char *keys, const char *table, int code, const char *message)
{
  char text[600];
  snprintf(text, sizeof text,
           "dea_fit: 1\nname: mine\nmaterial: elastosil-2030\nbreakdown: films.csv\n%s", keys);
  command_write("mine.yaml", text);
  command_write("films.csv", table);
  const int found = command_run("fit mine.yaml --force");
  if (found != code || strstr(command_err, message) == NULL) {
    fail_msg("exit code %d, wanted %d with '%s':\n%s", found, code, message, command_err);
  }
}

static const char alike[] = "thickness: 100 um\nstretch: 1.5\narea: 20 mm^2\n";

static void test_errors(void **state)
{
  (void)state;
  expect(alike, "voltage (kV),survived\n4,1\n5,1\n", 2, "nothing broke down");
  expect(alike, "voltage (kV),survived\n4,0\n5,1\n", 2, "1 film broke down: too few");
  expect(alike, "voltage (kV),survived\n4,0\n5,2\n", 5,
         "films.csv:3:1: error: survived: 2, but it has to be 1, or 0 of a film that broke");
  expect(alike, "voltage (kV),survived\n-4,0\n5,1\n", 5, "voltage: -4000, but it has to be more");
  expect(alike, "voltage,survived\n4,0\n5,1\n", 5, "unit");
  expect(alike, "survived\n0\n1\n", 5, "needs one of the columns 'voltage (kV)' and 'field");
  expect(alike, "voltage (kV),area (mm^2),survived\n4,20,0\n", 5, "which one counts?");
  expect("thickness: 1 um\nstretch: 1\n", "voltage (kV),survived\n4,0\n", 5,
         "has no column 'area (mm^2)'");
  expect("thicknes: 1 um\n", "voltage (kV),survived\n4,0\n", 3, "did you mean 'thickness'?");
  expect(alike, "voltage (kV),survived\n4.0,0\n5.0,0\n4.4,0\n5,1\n", 0, "");
  assert_contains(command_out, "exponent                unknown");
}

/* The example as the page has it; its material gives a breakdown probability. */
static void test_example(void **state)
{
  (void)state;
  static char page[COMMAND_TEXT_MAX];
  FILE *file = fopen(DEA_SOURCE_DIR "/docs/fit.md", "rb");
  assert_non_null(file);
  page[fread(page, 1, sizeof page - 1, file)] = '\0';
  fclose(file);
  assert_int_equal(command_run("schema --fit-breakdown --markdown"), 0);
  assert_contains(page, command_out);
  assert_int_equal(command_run("fit @/examples/fit/breakdown.yaml -o films"), 0);
  static const char line[] =
      "at_rest                  97.336 +- 3.32      V/um   (68 %: 94.319 to 101.1)";
  assert_contains(command_out, line);
  assert_contains(page, line);
  assert_int_equal(command_run("fit @/examples/fit/breakdown.yaml -o films"), 5);
  assert_contains(command_err, "--force");
  command_read("films/fit.csv", page);
  assert_contains(page, "chance by the law");
  command_read("films/fit.svg", page);
  assert_contains(page, "<svg");
  command_before = "DEA_MATERIALS=films";
  assert_int_equal(command_run("run @/examples/frdea-4.yaml --model axisymmetric --no-figures -o "
                               "run --set film.material=my-film"),
                   0);
  assert_contains(command_out, "breaks down by here with at most 63 %, by source 31 to 86 %");
  command_before = "";
  assert_int_equal(command_run("fit @/examples/fit/breakdown.yaml -o films --force --json"), 0);
  assert_contains(command_out, "\"broken\": 21");
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_errors), cmocka_unit_test(test_example)};
  return cmocka_run_group_tests(tests, command_set_up, command_tear_down);
}
