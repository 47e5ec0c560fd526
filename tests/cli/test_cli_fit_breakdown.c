/* dea fit of breakdown tests and of life tests, as a user runs it: the examples, their files, what
 * may be wrong. */
// ctest: quick, heavy
#include "command.h"

/* A table and keys of the fit file; the exit code and one message are wanted. */
static void expect(const char *keys, const char *table, int code, const char *message)
{
  char text[600];
  snprintf(text, sizeof text,
           "dea_fit: 1\nname: mine\nmaterial: elastosil-2030\nbreakdown: films.csv\n%s", keys);
  command_write("mine.yaml", text);
  command_write("films.csv", table);
  command_expect("fit mine.yaml --force", code, message);
}

static const char alike[] = "thickness: 100 um\nstretch: 1.5\narea: 20 mm^2\n";

TEST(test_errors)
{
  expect(alike, "voltage (kV),survived\n4,1\n5,1\n", 3,
         "mine.yaml:4:12: error: nothing broke down");
  expect(alike, "voltage (kV),survived\n4,0\n5,1\n", 3, "1 film broke down: too few");
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
  // no power of the stretch: the field is that of the stretch they had, and says so
  assert_contains(command_out, "of films of 44.44 um and 20 mm^2, at the stretch 1.5");
  static char text[COMMAND_TEXT_MAX];
  command_read("mine.fit/mine.yaml", text);
  assert_contains(text, "at_rest is that of films at the stretch 1.5, all that were tested");
  expect("thickness: 100 um\nstretch: 1.5\narea: 20 mm^2\nexponent: 0\n",
         "voltage (kV),survived\n4.0,0\n5.0,0\n4.4,0\n5,1\n", 0, "");
  assert_contains(command_out, "and 20 mm^2, unstretched",
                  "exponent                      0    fixed");
}

/* Thicknesses that scatter by 4 % hold no power; that of films twice as thick would follow from it.
 */
TEST(test_power_of_scatter)
{
  static const char films[] = "field (V/um),thickness (um),survived\n80,49,0\n85,51,0\n92,50.2,0\n"
                              "77,50.9,0\n88,49.3,0\n95,49.9,0\n83,50.7,0\n";
  expect(
      "stretch: 1\narea: 20 mm^2\n", films, 0,
      "mine.yaml:4:12: warning: the films' thicknesses tell little of their power (-1.8 +- 2.4)");
  expect(
      "thickness: 50 um\narea: 20 mm^2\n", // all that were stretched held: any larger power will do
      "field (V/um),stretch,survived\n80,1,0\n83,1,0\n90,1.5,1\n92,1.5,1\n70,1,1\n78,1,0\n", 3,
      "the films do not limit the power of their stretches: give exponent in the fit file");
  // four films on nearly one line: intervals end where another start finds the maximum
  expect("area: 20 mm^2\n",
         "field (V/um),stretch,thickness (um),survived\n80,1,50,0\n83,1.2,60,0\n90,1.5,50,0\n"
         "92,1.7,60,0\n",
         0, "");
  assert_null(strstr(command_out, "nan"));
  expect("stretch: 1\narea: 20 mm^2\nthickness_exponent: 0\n", films, 0, "");
  assert_null(strstr(command_err, "warning"));
}

/* The example as the page has it; its material gives a breakdown probability. */
TEST(test_example)
{
  static char page[COMMAND_TEXT_MAX];
  command_read_in(DEA_SOURCE_DIR "/docs", "fit.md", page);
  assert_int_equal(command_run("fit @/examples/fit/breakdown.yaml -o films"), 0);
  static const char line[] =
      "at_rest                  97.336 +- 3.32      V/um   (68 %: 94.319 to 101.1)";
  assert_contains(command_out, line);
  assert_contains(page, line);
  command_expect("fit @/examples/fit/breakdown.yaml -o films", 5, "--force");
  command_read("films/fit.csv", page);
  assert_contains(page, "chance by the law");
  command_read("films/fit.svg", page);
  assert_contains(page, "<svg");
  command_before = "DEA_MATERIALS=films";
  command_prints("run @/examples/frdea-4.yaml --model axisymmetric --no-figures -o "
                 "run --set film.material=my-film",
                 0, "breaks down by here with at most 63 %, by source 31 to 86 %");
  command_before = "";
  command_prints("fit @/examples/fit/breakdown.yaml -o films --force --json", 0, "\"broken\": 21");
}

// Lives -------------------------------------------------------------------------------------------

/* A week of 1000 cycles at 3 kV, each 604.8 s long and half of that under voltage, with a look at
 * 1 kV every 100; the stroke falls by `loss` a cycle from `stroke` on. */
static void write_week(const char *folder, double stroke, double loss, int broken, int ended)
{
  static char text[1 << 17];
  char name[64];
  size_t n =
      (size_t)snprintf(text, sizeof text,
                       "# Reduced from a test\nend (s),under voltage (s),asked V (kV),"
                       "displacement (um),charge (uC),leakage (nA),breakdowns,ended early\n");
  for (int k = 1; k <= 1000; k++) {
    n += (size_t)snprintf(text + n, sizeof text - n, "%.10g,%.10g,%d,%.8g,%.8g,%g,%d,%d\n",
                          604.8 * k, 302.4 * k, k % 100 == 0 ? 1 : 3,
                          k % 100 == 0 ? 0.1 * stroke : stroke - loss * k, 0.2 * k,
                          k > 700 && k < 703 ? 900.0 : 5.0, k == broken, ended && k == 1000);
  }
  command_folder_make(folder);
  snprintf(name, sizeof name, "%s/life.csv", folder);
  command_write(name, text);
}

static void fit_lives(const char *keys, int code)
{
  char text[1200];
  snprintf(text, sizeof text, "dea_fit: 1\nname: mine\n%s", keys);
  command_write("lives.yaml", text);
  const int found = command_run("fit lives.yaml --force");
  if (found != code) {
    fail_msg("exit code %d, wanted %d\n%s%s", found, code, command_out, command_err);
  }
}

/* Three specimens of several weeks: by stroke, by breakdown in the second week, and a survivor. */
TEST(test_lives_of_recordings)
{
  write_week("a1", 400, 0.02, 0, 0); // 400 to 380 um
  write_week("a2", 380, 0.1, 0, 0);  // below 320 of 399.89 from the 602nd cycle on
  write_week("b1", 300, 0, 0, 0);
  write_week("b2", 300, 0, 123, 0);
  write_week("c1", 500, 0, 0, 1);
  static const char lives[] = "life:\n  - {name: A, reduced: [a1, a2]}\n"
                              "  - {name: B, reduced: [b1, b2]}\n  - {name: C, reduced: c1}\n";
  char keys[600];
  snprintf(keys, sizeof keys, "%sstroke_loss: 20 %%\n", lives);
  fit_lives(keys, 0);
  assert_contains(command_out, "3 specimens, of which 2 failed");
  assert_contains(command_err, "the last recording of 'C' ended early");
  static char csv[COMMAND_TEXT_MAX];
  command_read("lives.fit/fit.csv", csv);
  // 0.8 times the mean of the first ten cycles: 319.912 um, after 1601 cycles and 269 h of these
  assert_contains(csv, "A,1,stroke,1601,268.968,134.484,0.3202,0.79996999",
                  "B,1,breakdown,1123,188.664,94.332,0.2246,1,", "C,0,survived,1000,168,84,0.2,1,");
  snprintf(keys, sizeof keys,
           "%slargest_leakage: 0.5 uA\nat_breakdown: no\nlasting: 2\nclock: "
           "under_voltage\n",
           lives);
  fit_lives(keys, 0);
  command_read("lives.fit/fit.csv", csv);
  assert_contains(csv, "B,1,leakage,701,117.768,58.884,");
  assert_contains(command_out, "no law: two failures at different lives are needed");
  snprintf(keys, sizeof keys, "%sat_breakdown: no\n", lives);
  fit_lives(keys, 0);
  assert_contains(command_out, "less than 63.2 % fail by 1000 cycles"); // 1 - 0.05^(1/3)
  // a name with a comma is one field; too few cycles to say what was lost
  snprintf(keys, sizeof keys,
           "stroke_loss: 20 %%\nreference_cycles: 2000\n"
           "life:\n  - {name: \"A, left\", reduced: a1}\n");
  fit_lives(keys, 0);
  command_read("lives.fit/fit.csv", csv);
  assert_contains(csv, "\n\"A, left\",0,survived,1000,");
  assert_contains(command_err, "lives.yaml:6:12: warning: 'A, left' has fewer than 2000 cycles");
  // a recording counts once, and a stroke is that of the first recording
  fit_lives("life:\n  - {name: A, reduced: [a1, b1]}\n  - {name: B, reduced: b1}\n", 3);
  assert_contains(command_err,
                  "lives.yaml:5:24: error: 'b1' is a recording of 'A' already, in line 4");
  command_folder_make("f1");
  command_write("f1/life.csv", "end (s),under voltage (s),asked V (kV),force (mN)\n1,1,3,5\n");
  fit_lives("stroke_loss: 20 %\nlife:\n  - {name: A, reduced: [a1, f1]}\n", 5);
  assert_contains(command_err,
                  "lives.yaml:5:29: error: 'f1' has no displacement, which is the stroke");
  fit_lives("life: [{name: A}]\n", 3);
  assert_contains(command_err, "'A' needs something: its recordings, or its life");
  fit_lives("life: [{name: A, reduced: none}]\n", 5);
  assert_contains(command_err, "life.csv");
}

/* The example as the page has it: the numbers are those of the equations of the maximum, solved by
 * bisection elsewhere. */
TEST(test_life_example)
{
  static char page[COMMAND_TEXT_MAX];
  command_read_in(DEA_SOURCE_DIR "/docs", "fit.md", page);
  assert_int_equal(command_run("fit @/examples/fit/life.yaml -o batch"), 0);
  static const char line[] = "scale                    260091 +- 3.78e+04  cycles";
  assert_contains(command_out, line);
  assert_contains(page, line);
  assert_contains(command_out, "shape                   1.67923 +- 0.36");
  command_read("batch/fit.svg", page);
  assert_contains(page, "survived until there");
  command_prints("fit @/examples/fit/life.yaml -o batch --force --json", 0, "\"failed\": 17");
}

TESTS(command_set_up, command_tear_down)
