/* `dea recording`: what it says, the copy it makes of a killed one, its tables. */
#include "command.h"
#include "recording_samples.h"

#include <jansson.h>

enum { CYCLES = 3 };

/* A recording of some cycles; killed: as a program leaves it that never came to its end. */
static void record(const char *name, bool killed)
{
  char file[600];
  snprintf(file, sizeof file, "%s/%s", command_folder, name);
  fflush(NULL);
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    struct dea_context *own;
    struct dea_recorder *recorder;
    bool good = dea_context_create(NULL, &own) == DEA_OK &&
                sample_create(own, file, false, 0, &recorder) == DEA_OK;
    for (size_t i = 0; i < CYCLES && good; i++) {
      struct dea_recorded_cycle cycle = sample_cycle(i);
      good = sample_add(recorder, i * SAMPLE_CYCLE, SAMPLE_CYCLE) == DEA_OK &&
             sample_add_reading(recorder, i) == DEA_OK && sample_add_frame(recorder, i) == DEA_OK &&
             dea_recorder_add_cycle(recorder, &cycle) == DEA_OK;
    }
    if (!killed) {
      good = good && dea_recorder_finish(recorder, NULL) == DEA_OK;
    }
    _exit(good ? 0 : 1);
  }
  int status;
  assert_int_equal(waitpid(child, &status, 0), child);
  assert_int_equal(status, 0);
}

TEST(test_what_is_in_it)
{
  record("whole.h5", false);
  command_prints("recording whole.h5", 0, "complete       yes");
  assert_contains(command_out, "10000 Hz", "2100 values", "3 completed in 1 step");
  assert_int_equal(command_run("recording --json whole.h5"), 0);
  json_t *json = json_loads(command_out, 0, NULL);
  assert_non_null(json);
  json_t *channel = json_array_get(json_object_get(json, "channels"), 0);
  double lowest = INFINITY, highest = -INFINITY;
  for (size_t i = 0; i < (size_t)CYCLES * SAMPLE_CYCLE; i++) {
    lowest = fmin(lowest, sample_value(0, i));
    highest = fmax(highest, sample_value(0, i));
  }
  assert_close(json_number_value(json_object_get(channel, "lowest")), lowest, 1e-11, 0);
  assert_close(json_number_value(json_object_get(channel, "highest")), highest, 1e-11, 0);
  assert_int_equal(json_integer_value(json_object_get(channel, "missing")), 3);
  json_t *cycle = json_array_get(json_object_get(json, "cycles"), 2);
  assert_close(json_number_value(json_object_get(cycle, "end_s")), 0.46, 1e-12, 0);
  json_decref(json);
}

/* What a recording is called cannot look like a line of what is known of it, nor reach the
 * terminal, whoever wrote it. */
TEST(test_names_are_no_lines)
{
  static const struct dea_recorder_channel channel = {
      .name = "v\x1b[31m\nw", .kind = DEA_CHANNEL_VOLTAGE, .interval_s = 1e-3, .filter_Hz = NAN};
  const struct dea_recorder_options options = {
      .title = "x\noutput         at 0 V (2 V read back)\x1b[31m \xc2\x9b\xc2\xb5m",
      .channels = &channel,
      .channel_count = 1};
  char file[600];
  struct dea_context *own;
  struct dea_recorder *recorder;
  snprintf(file, sizeof file, "%s/odd.h5", command_folder);
  assert_int_equal(dea_context_create(NULL, &own), DEA_OK);
  assert_int_equal(dea_recorder_create(own, file, &options, &recorder), DEA_OK);
  assert_int_equal(dea_recorder_finish(recorder, NULL), DEA_OK);
  dea_context_destroy(own);
  command_prints("recording odd.h5", 0,
                 "title          x output         at 0 V (2 V read back) [31m   \xc2\xb5m\n");
  assert_contains(command_out, "\n  v [31m w ");
  assert_null(strchr(command_out, '\x1b'));
}

/* A protocol's title may have several lines, and becomes one. */
TEST(test_title_of_lines)
{
  command_write("lines.yaml", "dea-protocol: 1\n"
                              "title: \"x\\noutput         at 0 V (2 V read back)\"\n"
                              "design: " DEA_SOURCE_DIR "/examples/frdea-4.yaml\n"
                              "waveform: {kind: square, high: 2 kV, frequency: 10 Hz, cycles: 1}\n"
                              "amplifier: {gain: 1000, max_voltage: 10 kV}\n"
                              "sim: {profile_points: 0}\n"
                              "channels: [{name: v, quantity: voltage, input: ai0, "
                              "per_volt: 1 kV}]\n");
  assert_int_equal(command_run("drive lines.yaml --sim -o lines.h5"), 0);
  assert_null(strstr(command_out, "\noutput         at 0 V (2 V read back)\n"));
  command_prints("recording lines.h5", 0,
                 "title          x output         at 0 V (2 V read back)\n");
}

TEST(test_killed_one_is_rescued)
{
  record("killed.h5", true);
  command_prints("recording killed.h5 -o copy.h5 --csv tables", 0, "no: its program was killed");
  command_prints("recording copy.h5", 0, "no: its program was killed");
  assert_contains(command_out, "3 completed");
  command_expect("recording killed.h5 -o copy.h5", 5, "exists");
}

TEST(test_tables)
{
  double time_s, voltage_kV;
  int used;
  record("table.h5", false);
  command_folder_make("csv"); // what others wrote there is not lost unasked
  command_write("csv/cycles.csv", "those of dea reduce\n");
  command_write("csv/readings_2.csv", "of an earlier recording\n");
  command_expect("recording table.h5 --csv csv", 5, "--force");
  assert_int_equal(command_run("recording table.h5 --csv csv --force"), 0);
  char stale[600];
  snprintf(stale, sizeof stale, "%s/csv/readings_2.csv", command_folder);
  assert_int_not_equal(access(stale, F_OK), 0);
  command_read("csv/channels.csv", command_out);
  const char *at = command_out;
  const char *header = "time (s),voltage (kV),centre/laser (um)\n";
  assert_memory_equal(at, header, strlen(header));
  at += strlen(header);
  for (size_t i = 0; i < (size_t)CYCLES * SAMPLE_CYCLE; i++) {
    int found = sscanf(at, "%lf,%lf%n", &time_s, &voltage_kV, &used);
    assert_close(time_s, 0.25 + 1e-4 * (double)i, 1e-11, 0);
    if (isnan(sample_value(0, i))) {
      assert_int_equal(found, 1); // an empty field
    } else {
      assert_int_equal(found, 2);
      assert_close(voltage_kV, 1e-3 * sample_value(0, i), 1e-11, 0);
    }
    at = strchr(at, '\n');
    assert_non_null(at);
    at++;
  }
  assert_int_equal(*at, '\0');
  command_read("csv/readings_1.csv", command_out);
  assert_contains(command_out, "time (s),temperature (K)\n");
  command_read("csv/profiles.csv", command_out);
  assert_contains(command_out, "time (s),z at x = -30 mm (um),", "\n0.02,31,32,33,34,35,36,37\n");
  command_read("csv/cycles.csv", command_out);
  assert_contains(command_out, "\n0,1,0.32,0.39,0\n");
}

/* Another program's displacements beside the voltage, on the voltage's clock. */
TEST(test_two_become_one)
{
  command_write("v.csv", "time (s),V (kV)\n0,0\n0.1,1\n0.2,2\n");
  command_write("z.csv", "time (s),z (mm)\n5,0\n5.25,0.1\n");
  assert_int_equal(command_run("import v.csv"), 0);
  assert_int_equal(command_run("import z.csv"), 0);
  command_expect("import v.csv z.csv -f", 5, "dea recording A.h5 --with B.h5 --after TIME");
  command_expect("recording v.h5 --with z.h5", 2, "--with needs --after");
  command_expect("recording v.h5 --after 1s", 2, "--after is said of another recording");
  command_expect("recording v.h5 --with z.h5 --after 1V", 2, "--after: '1V'");
  command_expect("recording v.h5 --with nowhere.h5 --after 1s", 5, "nowhere.h5");
  command_expect("recording v.h5 --with z.h5 --after 0s", 5, "they have no moment together");
  command_expect("recording v.h5 --with z.h5 --with z.h5 --after 0s", 2, "--with once");
  command_expect("recording v.h5 --with v.h5 --after 0s", 5,
                 "what 'v.h5' has is in 'v.h5' already");
  command_expect("recording v.h5 --with z.h5 --after -5s", 0, "-o FILE writes it");
  assert_int_equal(command_run("recording v.h5 --with z.h5 --after -5s -o both.h5"), 0);
  command_prints("recording both.h5", 0, "channels       2");
  assert_contains(command_out, "joined         z.h5, whose 0 is at -5 s", "0 to 100 um");
  assert_int_equal(command_run("recording both.h5 --json"), 0);
  json_t *json = json_loads(command_out, 0, NULL);
  json_t *z = json_array_get(json_object_get(json, "channels"), 1);
  assert_close(json_number_value(json_object_get(z, "start_s")), 0, 0, 1e-12);
  json_decref(json);
}

TEST(test_what_is_no_recording)
{
  command_write("text.h5", "no recording at all");
  command_expect("recording text.h5", 5,
                 "text.h5 is no recording; dea import makes one of CSV, .mat, .lvm and .tdms, and "
                 "examples/python/area_strain.py a table of pictures");
  command_expect("recording nowhere.h5", 5, "does not exist");
  assert_int_equal(command_run("recording /dev/null"), 5);
  assert_int_equal(command_run("recording"), 2);
  assert_int_equal(command_run("recording a b"), 2);
}

TESTS(command_set_up, command_tear_down)
