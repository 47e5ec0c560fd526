/* dea import: what it prints, what it writes, and its exit codes. */
#include "command.h"
#include "recording/recording.h"

#include <jansson.h>

TEST(test_list)
{
  command_write("a.csv", "Time (s),HV (kV),x\n0,0,1\n0.5,1,1\n1,2,1\n");
  command_prints("import --list a.csv", 0, "csv, 3 columns");
  assert_contains(command_out, "voltage (by its name and unit)");
  assert_int_equal(command_run("import --list --json a.csv"), 0);
  json_t *json = json_loads(command_out, 0, NULL);
  assert_non_null(json);
  const json_t *column = json_array_get(json_object_get(json, "columns"), 1);
  assert_string_equal(json_string_value(json_object_get(column, "name")), "HV");
  assert_string_equal(json_string_value(json_object_get(column, "as")), "voltage");
  assert_true(json_real_value(json_object_get(column, "largest")) == 2);
  assert_int_equal(json_integer_value(json_object_get(column, "missing")), 0);
  json_decref(json);
  assert_int_equal(command_run("recording a.h5"), 5); // nothing was written
  command_write("holes.csv", "Time (s),HV (kV)\n0,0\n0.5,\n1,nan\n1.5,2\n");
  command_prints("import --list holes.csv", 0, "voltage (by its name and unit); 2 missing");
}

TEST(test_recording)
{
  char file[600];
  struct dea_context *ctx;
  struct dea_recording *recording;
  command_write("a.csv", "Time (s),HV (kV)\n0,0\n0.5,1\n1,2\n");
  command_write("b.csv", "Time (s),Laser (mm)\n0,0\n0.5,0.25\n1,0.5\n");
  command_write("map.yaml", "dea-import: 1\ntitle: Both\ncolumns:\n  - {column: HV, as: voltage}\n"
                            "  - {column: Laser, as: displacement, name: centre}\n");
  assert_int_equal(
      command_run("import a.csv b.csv --map map.yaml --design @/examples/plain-disc.yaml "
                  "-o both.h5 --json"),
      0);
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  snprintf(file, sizeof file, "%s/both.h5", command_folder);
  assert_int_equal(dea_recording_read(ctx, file, &recording), DEA_OK);
  assert_true(recording->complete);
  assert_string_equal(recording->title, "Both");
  assert_string_equal(recording->design_name, "plain-disc.yaml");
  assert_contains(recording->design, "pre_stretch");
  assert_contains(recording->provenance, "b.csv");
  const struct dea_channel *centre = dea_recording_channel(recording, "centre");
  assert_non_null(centre);
  assert_close(centre->interval_s, 0.5, 1e-12, 0);
  assert_close(centre->values[1], 0.25e-3, 1e-14, 0);
  assert_close(dea_recording_kind(recording, DEA_CHANNEL_VOLTAGE)->values[2], 2000, 1e-14, 0);
  dea_recording_destroy(ctx, recording);
  dea_context_destroy(ctx);
  command_expect("import a.csv -o both.h5", 5, "--force replaces it");
  command_expect("import a.csv -o both.h5 --force", 0, "'HV' in kV is taken as voltage");
  command_prints("import b.csv", 0, "b.h5");
}

TEST(test_errors)
{
  static const struct {
    const char *arguments;
    int code;
    const char *part;
  } cases[] = {
      {"import", 2, "a file is missing"},
      {"import none.csv", 5, "none.csv"},
      {"import a.csv --format xls", 2, "not a format"},
      {"import a.csv --format comsol", 5, "looks like format 'csv'"},
      {"import a.csv --list -o x.h5", 2, "--list writes nothing"},
      {"import a.csv --map bad.yaml", 3, "bad.yaml:2"},
      {"import a.csv c.csv -o c.h5", 5, "different clocks"},
      {"import book.xlsx", 5, "save the sheet as CSV"},
      {"import a.csv --design none.yaml -o d.h5", 5, "none.yaml"},
  };
  command_write("a.csv", "Time (s),HV (kV)\n0,0\n0.5,1\n1,2\n");
  command_write("c.csv", "Time (s),F (N)\n0,0\n0.5,1\n1.5,2\n");
  command_write("bad.yaml", "dea-import: 1\nrates: 1 kHz\n");
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    if (strstr(cases[i].arguments, "xlsx") != NULL) {
      char text[700];
      snprintf(text, sizeof text, "printf 'PK\\003\\004\\000' > '%s/book.xlsx'", command_folder);
      assert_int_equal(system(text), 0);
    }
    assert_int_equal(command_run(cases[i].arguments), cases[i].code);
    assert_contains(command_err, cases[i].part);
  }
  command_prints("schema --mapping", 0, "per_unit");
}

/* What is written replaces neither what is read nor a pipe, with --force too, under a given name or
 * the usual one. */
TEST(test_what_is_not_replaced)
{
  static const struct {
    const char *arguments, *part;
  } cases[] = {
      {"import in.csv -f -o in.csv", "in.csv is read, and would be written over"},
      {"import in.csv -f -oin.csv", "is read, and would be written over"},
      {"import in.csv -f --output=./in.csv", "is read, and would be written over"},
      {"import in.csv -f -o same.csv", "is read, and would be written over"},
      {"import in.csv -f -o map.yaml --map=map.yaml", "map.yaml is read, and would be"},
      {"import -o in.csv other.csv in.csv -f", "is read, and would be written over"},
      {"import in.csv -f -o pipe", "pipe is a pipe and is not replaced"},
      {"import in.csv -f", "in.h5 is a pipe and is not replaced"},
      {"import in.csv -f -o /dev/stdout", "/dev/stdout is a device and is not replaced"},
      {"check design.yaml --svg design.yaml", "design.yaml is read, and would be written over"},
      {"check design.yaml --svg pipe", "pipe is a pipe and is not replaced"},
      {"mesh design.yaml -o design.yaml --force", "design.yaml is read, and would be"},
      {"drive protocol.yaml --sim --force -o pipe", "pipe is a pipe and is not replaced"},
      {"drive protocol.yaml --sim --force -o protocol.yaml", "protocol.yaml is read, and would"},
  };
  char text[2000], before[400];
  command_write("in.csv", "Time (s),HV (kV)\n0,0\n0.5,1\n1,2\n");
  command_write("other.csv", "Time (s),F (N)\n0,0\n0.5,1\n1,2\n");
  command_write("map.yaml", "dea-import: 1\nrate: 1 kHz\n");
  command_write("protocol.yaml", "dea-protocol: 1\n");
  snprintf(text, sizeof text,
           "cd '%s' && ln -s in.csv same.csv && mkfifo pipe in.h5 && cp '%s/examples/frdea-4.yaml' "
           "design.yaml && cat in.csv map.yaml protocol.yaml design.yaml | cksum >before",
           command_folder, DEA_SOURCE_DIR);
  assert_int_equal(system(text), 0);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    command_expect(cases[i].arguments, 5, cases[i].part);
  }
  snprintf(before, sizeof before, "cat in.csv map.yaml protocol.yaml design.yaml | cksum");
  snprintf(text, sizeof text,
           "cd '%s' && %s | cmp - before && test -p pipe && test -p in.h5 && test -h same.csv",
           command_folder, before);
  assert_int_equal(system(text), 0);
  assert_int_equal(command_run("check design.yaml --svg drawing.svg"), 0);
  assert_int_equal(command_run("check design.yaml --svg drawing.svg"), 0); // of its own making
}

TESTS(command_set_up, command_tear_down)
