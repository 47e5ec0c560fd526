/* dea fab as a user runs it. */
// ctest: slow, heavy
#include "command.h"
#include <stdbool.h>

#include <jansson.h>

// the same without voltages: no model is asked what tolerances do
#define WITHOUT_VOLTAGE " --set compute.voltage='{values: [0 V]}' "
#define STILL "@/examples/frdea-4.yaml" WITHOUT_VOLTAGE

static void read_into(const char *name, char **out)
{
  static char text[COMMAND_TEXT_MAX];
  command_read(name, text);
  *out = text;
}

TEST(test_files)
{
  command_expect("fab @/examples/frdea-4.yaml", 0, "files for the workshop are in frdea-4.fab");
  assert_true(strstr(command_err, "elements") == NULL); // of models that were only asked
  assert_string_equal(command_out, "");
  char *text;
  read_into("frdea-4.fab/frame.dxf", &text);
  assert_contains(text, "AC1015", "$INSUNITS\n 70\n4\n");
  read_into("frdea-4.fab/fibres.svg", &text);
  assert_contains(text, "width=\"210.000000mm\" height=\"297.000000mm\"");
  // what is there stays, unless it is to be replaced
  command_expect("fab @/examples/frdea-4.yaml", 5, "--force");
  assert_int_equal(command_run("--quiet fab " STILL "--force"), 0);
  assert_true(strstr(command_err, "are in") == NULL);
}

TEST(test_summary)
{
  assert_int_equal(command_run("fab " STILL "-o four --json "
                               "--set fabrication.copies=2"),
                   0);
  json_t *root = json_loads(command_out, 0, NULL);
  assert_non_null(root);
  assert_int_equal(json_integer_value(json_object_get(root, "copies")), 2);
  assert_string_equal(json_string_value(json_object_get(root, "folder")), "four");
  json_t *frame = NULL, *row;
  size_t i;
  json_array_foreach(json_object_get(root, "parts"), i, row)
  {
    if (strcmp(json_string_value(json_object_get(row, "name")), "frame") == 0) {
      frame = row;
    }
  }
  // a ring of 15 to 25 mm with three marks of 1.5 mm and a window of 3 mm
  const double pi = acos(-1);
  assert_close(json_number_value(json_object_get(frame, "area_m2")),
               pi * 1e-6 * (625 - 225 - 3 * 0.75 * 0.75 - 1.5 * 1.5), 1e-10, 0);
  json_t *one = json_object_get(root, "amounts_of_one");
  assert_close(json_number_value(json_object_get(one, "film_area_m2")), pi * 1225e-6 / 2.25, 1e-10,
               0);
  assert_null(json_object_get(one, "ink_volume_m3")); // the design gives no thickness
  char path[700];
  json_array_foreach(json_object_get(root, "files"), i, row)
  {
    snprintf(path, sizeof path, "%s/four/%s", command_folder, json_string_value(row));
    assert_int_equal(access(path, R_OK), 0);
  }
  assert_int_equal(i, 18);
  json_decref(root);
}

TEST(test_without_fibres)
{
  char path[700];
  assert_int_equal(command_run("fab @/examples/plain-disc.yaml -o disc"), 0);
  snprintf(path, sizeof path, "%s/disc/fibres.dxf", command_folder);
  assert_int_not_equal(access(path, R_OK), 0);
}

/* Files are the same however often they are written, and whatever the locale. */
TEST(test_same_bytes)
{
  assert_int_equal(command_run("fab @/examples/frdea-8.yaml" WITHOUT_VOLTAGE "-o one"), 0);
  assert_int_equal(command_run("fab @/examples/frdea-8.yaml" WITHOUT_VOLTAGE "-o two"), 0);
  char text[1400];
  snprintf(text, sizeof text, "diff -r '%s/one' '%s/two'", command_folder, command_folder);
  assert_int_equal(system(text), 0);
}

TEST(test_hostile_names)
{
  command_write("a<script>&.yaml", "dea: 1\n"
                                   "title: '</title><script>alert(1)</script>&\"'\n"
                                   "film: {material: elastosil-2030, thickness: 100 um}\n"
                                   "pre_stretch: 1.5\nframe: {inner_diameter: 30 mm}\n"
                                   "electrodes: {diameter: 5 mm unstretched}\n");
  assert_int_equal(command_run("fab 'a<script>&.yaml' -o hostile"), 0);
  // a name that is not UTF-8, in the files and in the summary
  assert_int_equal(command_run("fab 'a<script>&.yaml' -o \"$(printf 'b\\377')\" --json"), 0);
  json_t *root = json_loads(command_out, 0, NULL);
  assert_string_equal(json_string_value(json_object_get(root, "folder")), "(not UTF-8)");
  json_decref(root);
  static const char *const names[] = {"hostile/frame.svg", "hostile/process.html"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    char *text;
    read_into(names[i], &text);
    assert_true(strstr(text, "<script>") == NULL);
    assert_contains(text, "&lt;script&gt;");
  }
}

TEST(test_drawing_only)
{
  assert_int_equal(command_run("fab " STILL "--drawing -o only"), 0);
  static const char *const names[] = {"only/drawing.svg", "only/drawing.pdf", "only/drawing.png"};
  for (size_t i = 0; i < 3; i++) {
    char *text;
    read_into(names[i], &text);
    assert_true(text[0] != '\0');
  }
  char path[700];
  snprintf(path, sizeof path, "%s/only/frame.dxf", command_folder);
  assert_int_not_equal(access(path, F_OK), 0);
}

TEST(test_what_goes_wrong)
{
  assert_int_equal(command_run("fab"), 2);
  assert_int_equal(command_run("fab a b"), 2);
  assert_int_equal(command_run("fab " STILL "--laser"), 2);
  assert_int_equal(command_run("fab no-such-file.yaml"), 5);
  command_expect("fab " STILL "-o bad --set fabrication.kerf=1mm", 3,
                 "--set fabrication.kerf: error: kerf: a cut of 1 mm width");
  command_expect("fab " STILL "-o bad --set fabrication.sheet.width=30mm", 3,
                 "too small for the part");
  command_expect("fab " STILL "-o bad --set fabrication.holder.anchor=12mm", 3,
                 "a fibre is longer than the frame");
  char path[700];
  snprintf(path, sizeof path, "%s/bad", command_folder);
  assert_int_not_equal(access(path, F_OK), 0); // nothing was begun
  command_write("file", "x");
  assert_int_equal(command_run("fab " STILL "-o file"), 5);
}

TESTS(command_set_up, command_tear_down)
