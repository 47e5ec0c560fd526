/* dea drive --export: the waveform, and the scripts, run with stand-ins for NI-DAQmx and for
 * MATLAB's toolbox: what they write, that they end at 0 V, and that dea reads what they record. */
// ctest: slow, heavy
#include "command.h"

#include <stdbool.h>

enum { LOG_MAX = 1 << 16 };
static char log_text[LOG_MAX];

/* 4 kV twice for 0.3 s, and the ramp down by 20 kV/s. */
#define SETS                                                                                       \
  " --set 'sequence=[{waveform: {kind: square, high: 4 kV, frequency: 2 Hz, duty: 60 %, "          \
  "cycles: 2}}]'"                                                                                  \
  " --set safety.ramp=20kV/s --set safety.trip_time=20ms "
#define EXPORT "drive @/lab/examples/cyclic.yaml --force --export ex" SETS

static void make_files(void)
{
  command_prints(EXPORT, 0, "Next:  read ex/README.txt");
}

/* Runs a program within the folder; its log of the stand-in is in log_text. */
static int run_script(const char *environment, const char *program)
{
  char text[2048];
  snprintf(text, sizeof text,
           "cd '%s/ex' && rm -f log recording.csv recording.mat && touch log && STUB_LOG=log "
           "STUB_FAIL=999999 STUB_TRIP=999999 %s timeout 60 %s >../out.txt 2>../err.txt </dev/null",
           command_folder, environment, program);
  int status = system(text);
  command_read("out.txt", command_out);
  command_read("err.txt", command_err);
  snprintf(text, sizeof text, "%s/ex/log", command_folder);
  FILE *file = fopen(text, "rb");
  assert_non_null(file);
  log_text[fread(log_text, 1, sizeof log_text - 1, file)] = '\0';
  fclose(file);
  assert_true(WIFEXITED(status));
  return WEXITSTATUS(status);
}

#define PYTHON                                                                                     \
  "env PYTHONDONTWRITEBYTECODE=1 PYTHONPATH='" DEA_SOURCE_DIR                                      \
  "/tests/stub' /usr/bin/python3 play_nidaqmx.py Dev7"
#define OCTAVE                                                                                     \
  "octave-cli --no-gui --norc --path '" DEA_SOURCE_DIR                                             \
  "/tests/stub/matlab' --eval \"play_matlab('Dev7')\""

/* Control voltages after the first that the log tells of single ones: they go down to 0 V. */
static void check_ramp(double from)
{
  double last = from, value = NAN;
  size_t count = 0;
  for (const char *at = strstr(log_text, "\nwrite "); at != NULL; at = strstr(at + 1, "\nwrite ")) {
    value = strtod(at + 7, NULL);
    assert_true(value <= last);
    last = value;
    count++;
  }
  assert_true(value == 0);
  assert_true(from == 0 ? count >= 1 : count > 2);
}

/* Lines of a recording, without the titles. */
static size_t recorded(void)
{
  size_t lines = 0;
  command_read("ex/recording.csv", command_out);
  assert_contains(command_out, "time (s),command (kV),amplifier voltage (kV),"
                               "amplifier current (uA),centre laser (um)");
  for (const char *c = command_out; *c != '\0'; c++) {
    lines += *c == '\n' ? 1U : 0U;
  }
  return lines - 1;
}

TEST(test_waveform)
{
  make_files();
  command_read("ex/waveform.csv", command_out);
  const char *at = command_out;
  assert_contains(at, "time (s),V (kV),control (V)\n0,4,4\n0.001,4,4\n");
  for (size_t i = 0; i <= 1000; i++) {
    at = strchr(at, '\n') + 1;
    double time_s, voltage_kV, control_V, due = i % 500 < 300 && i < 1000 ? 4 : 0;
    assert_int_equal(sscanf(at, "%lf,%lf,%lf", &time_s, &voltage_kV, &control_V), 3);
    assert_close(time_s, 1e-3 * (double)i, 0, 1e-12);
    assert_true(voltage_kV == due && control_V == due);
  }
  assert_string_equal(strchr(at, '\n'), "\n");
  command_expect("import ex/waveform.mat -o w.h5", 0, "1001 samples from 0 s, 1000 Hz");
  command_prints("recording w.h5", 0, "0 to 4 kV");
  command_expect("drive @/lab/examples/cyclic.yaml --export ex" SETS, 5, "--force replaces it");
  command_expect("drive @/lab/examples/cyclic.yaml --export no --set channels=null", 2,
                 "nothing to be recorded");
}

static void check_reading_back(void)
{
  assert_int_equal(command_run("import ex/recording.csv --force -o r.h5"), 0);
  command_prints("recording r.h5", 0, "channels       4");
  assert_contains(command_out, "command                command ",
                  "amplifier voltage      voltage       1000 Hz", "0 to 4 kV", "10 to 10 uA",
                  "centre laser           displacement ");
  assert_contains(command_out, "0 to 800 um"); // 0.05 x 4 V^2 x 1 mm/V
}

TEST(test_python)
{
  make_files();
  assert_int_equal(run_script("", PYTHON), 0);
  assert_contains(log_text, "output Dev7/ao0 -10 10\ninput Dev7/ai0 -10 10\ninput Dev7/ai1",
                  "clock 1000 own 1001\nclock 1000 /Dev7/ai/SampleClock 1001\n");
  assert_contains(log_text, "queued 1001 2400 0\n"); // 600 samples of 4 V
  check_ramp(0);
  assert_int_equal(recorded(), 1001);
  check_reading_back();
}

/* A waveform that somebody changed is played only within what was checked. */
static void check_edited(const char *program)
{
  static const struct {
    const char *edit, *part;
  } edits[] = {
      {"s/^0.003,4,4$/0.003,4.001,4.001/", "beyond the 0 V to 4 V"},
      {"s/^0.003,4,4$/0.003,-0.01,-0.01/", "beyond the 0 V to 4 V"},
      {"s/^0.003,4,4$/0.003,nan,nan/", "beyond the 0 V to 4 V"},
      {"s/^0.003,4,4$/0.003,2,4/", "not its control voltages times the gain"},
      {"s/^1,0,0$/1,1,1/", "does not end at 0 V"},
  };
  for (size_t i = 0; i < sizeof edits / sizeof edits[0]; i++) {
    char line[1024];
    make_files();
    snprintf(line, sizeof line, "sed -i '%s' waveform.csv && STUB_LOG=log %s", edits[i].edit,
             program);
    assert_int_not_equal(run_script("", line), 0);
    assert_contains(command_err, edits[i].part);
    assert_null(strstr(log_text, "queued"));
  }
}

/* As those of dea drive: a current ends it once it was above its limit for trip_time, in whole
 * samples, and a ramp of 4 s is one of longest_ramp. */
static void check_interlocks(const char *program)
{
  make_files(); // 20 ms, 1 kHz
  assert_int_equal(run_script("STUB_TRIP=982", program), 0);
  assert_int_equal(run_script("STUB_TRIP=981", program), 1); // the last 20 samples of 1001
  assert_contains(command_err, "was above its limit");
  assert_int_equal(command_run(EXPORT " --set safety.ramp=1kV/s --set safety.longest_ramp=0.2s"),
                   0);
  assert_int_equal(run_script("STUB_FAIL=650", program), 1);
  check_ramp(4);
  size_t count = 0; // every 2 ms at most
  for (const char *at = log_text; (at = strstr(at, "\nwrite ")) != NULL; at++) {
    count++;
  }
  assert_true(count <= 102);
  make_files();
  assert_int_equal(run_script("STUB_RATE=1000.5", program), 1); // a board's clock is divided
  assert_contains(command_err, "no rate of 1000 Hz; write 'rate: 1000.5 Hz'");
  assert_null(strstr(log_text, "queued"));
}

TEST(test_python_ends_at_zero)
{
  static const struct {
    const char *environment, *part;
  } ways[] = {
      {"STUB_FAIL=60", "the device was taken away"},
      {"STUB_FAIL=650", "the device was taken away"},
      {"STUB_SIGNAL=610", "signal 2; the output was set to 0 V, not read back"},
      {"STUB_NAME=SIGHUP STUB_SIGNAL=610", "signal 1; the output was set to 0 V, not read back"},
      {"STUB_NAME=SIGTERM STUB_SIGNAL=610", "signal 15; the output was set to 0 V, not read back"},
      {"STUB_TRIP=605", "the current 'amplifier current (uA)' was above its limit"}};
  make_files();
  for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
    assert_int_equal(run_script(ways[i].environment, PYTHON), 1);
    assert_contains(command_err, ways[i].part);
    check_ramp(i == 0 ? 0 : 4);
    assert_true(recorded() < 1001);
  }
  check_interlocks(PYTHON);
  assert_int_equal(run_script("", "touch recording.csv; " PYTHON), 1);
  assert_contains(command_err, "rename it first");
  check_edited(PYTHON);
}

static bool no_octave(void)
{
  return system("octave-cli --version >/dev/null 2>&1") != 0;
}

TEST(test_matlab)
{
  if (no_octave()) {
    skip();
  }
  make_files();
  if (run_script("", OCTAVE) != 0) {
    fail_msg("%s", command_err);
  }
  assert_contains(log_text, "daq ni\noutput Dev7/ao0 Voltage\ninput Dev7/ai0 Voltage",
                  "queued 1001 2400 0\nstart 1000\n",
                  "stop\ndelete\ndaq ni\noutput Dev7/ao0 Voltage\nwrite 0\n");
  assert_int_equal(recorded(), 1001);
  check_reading_back();
  int code = command_run("import ex/recording.mat --force -o r.h5");
  if (code == 2) { // a build without it
    assert_contains(command_err, "libmatio");
    return;
  }
  assert_int_equal(code, 0);
  command_prints("recording r.h5", 0, "amplifier_voltage_V    voltage       1000 Hz");
  assert_contains(command_out, "0 to 4 kV", "10 to 10 uA", "0 to 800 um");
}

TEST(test_matlab_ends_at_zero)
{
  static const struct {
    const char *environment, *part;
  } ways[] = {
      {"STUB_FAIL=660", "the device was taken away"},
      {"STUB_STOP=1 STUB_FAIL=660", "the device was taken away"}, // and does not stop either
      {"STUB_TRIP=605", "the current 'amplifier current (uA)' was above its limit"}};
  if (no_octave()) {
    skip();
  }
  make_files();
  for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
    assert_int_equal(run_script(ways[i].environment, OCTAVE), 1);
    assert_contains(command_err, ways[i].part);
    check_ramp(4);
  }
  check_interlocks(OCTAVE);
  check_edited(OCTAVE);
}

/* What a protocol calls things stays a text within quotes, in both languages. */
TEST(test_quotes_in_names)
{
  command_write("quotes.yaml",
                "dea-protocol: 1\n"
                "waveform: {kind: triangle, low: 0 kV, high: 2 kV, cycles: 1, frequency: 1 Hz}\n"
                "amplifier: {gain: 1000, max_voltage: 5 kV, output: \"a'b\\\\c d\"}\n"
                "rate: 1 kHz\n"
                "channels:\n"
                "  - {name: \"x'y\\\\\", quantity: voltage, input: \"ai0'\", range: 10 V, "
                "per_volt: 1 kV}\n");
  assert_int_equal(command_run("drive quotes.yaml --force --export ex"), 0);
  command_read("ex/play_nidaqmx.py", command_out);
  assert_contains(command_out, "OUTPUT = 'a b c d'\n", "\"title\": 'x y  voltage (kV)',",
                  "\"terminal\": 'ai0 ',");
  command_read("ex/play_matlab.m", command_out);
  assert_contains(command_out, "'a b c d'");
  assert_null(strstr(command_out, "a'b"));
  // and what was checked is what it says: this protocol names no design
  static const char *const files[] = {"ex/play_matlab.m", "ex/play_nidaqmx.py", "ex/README.txt"};
  for (size_t i = 0; i < 3; i++) {
    command_read(files[i], command_out);
    assert_contains(command_out, "against the amplifier, and not against a film");
  }
  make_files();
  for (size_t i = 0; i < 3; i++) {
    command_read(files[i], command_out);
    assert_contains(command_out, "against the amplifier and the film");
  }
}

/* Channels that the files could not tell apart are numbered: by signs that are left out, by letters
 * that are none of a variable's, by their unit alone, by what the files have beside them. */
TEST(test_names_stay_apart)
{
  static const char head[] =
      "dea-protocol: 1\n"
      "waveform: {kind: triangle, low: 0 kV, high: 2 kV, cycles: 1, frequency: 1 Hz}\n"
      "amplifier: {gain: 1000, max_voltage: 5 kV}\nrate: 1 kHz\nchannels:\n";
  static const struct {
    const char *channel, *title, *variable;
  } channels[] = {
      {"name: amplifier voltage, quantity: voltage, per_volt: 1 kV", "amplifier voltage (kV)",
       "amplifier_voltage_V"},
      {"name: laser 1, quantity: displacement, per_volt: 1 mm", "laser 1 (um)", "laser_1_m"},
      {"name: laser-1, quantity: displacement, per_volt: 1 mm", "laser-1 2 (um)", "laser_1_2_m"},
      {"name: 'laser,1', quantity: displacement, per_volt: 1 mm", "laser 1 3 (um)", "laser_1_3_m"},
      {"name: 'laser;1', quantity: other, unit: um, per_volt: 1", "laser 1 2 (um)", "laser_1_2_um"},
      {"name: time, quantity: other, unit: s, per_volt: 1", "time 2 (s)", "time_2_s"},
      {"name: command, quantity: other, unit: V, per_volt: 1", "command 2 (V)", "command_2_V"},
      {"name: \xe5\x8a\x9b, quantity: other, per_volt: 1", "\xe5\x8a\x9b", "x"},
      {"name: \xe6\xb8\xa9, quantity: other, per_volt: 1", "\xe6\xb8\xa9 2", "x_2"},
      {"name: very long name of a laser that looks at the centre of the film, quantity: "
       "displacement, per_volt: 1 mm",
       "very long name of a laser that looks at the centre of the film (um)",
       "very_long_name_of_a_laser_that_looks_at_the_centre_of_the_f_m"},
      {"name: very long name of a laser that looks at the centre of the fil, quantity: "
       "displacement, per_volt: 1 mm",
       "very long name of a laser that looks at the centre of the fil 2 (um)",
       "very_long_name_of_a_laser_that_looks_at_the_centre_of_the_2_m"},
  };
  char text[4096], line[512];
  size_t used = (size_t)snprintf(text, sizeof text, "%s", head);
  for (size_t i = 0; i < sizeof channels / sizeof channels[0]; i++) {
    used += (size_t)snprintf(text + used, sizeof text - used, "  - {input: ai%zu, %s}\n", i,
                             channels[i].channel);
  }
  command_write("names.yaml", text);
  assert_int_equal(command_run("drive names.yaml --force --export ex"), 0);
  command_read("ex/play_matlab.m", command_out);
  for (size_t i = 0; i < sizeof channels / sizeof channels[0]; i++) {
    snprintf(line, sizeof line, "struct('title', '%s', 'variable', '%s', ", channels[i].title,
             channels[i].variable);
    assert_contains(command_out, line);
  }
  command_read("ex/play_nidaqmx.py", command_out);
  for (size_t i = 0; i < sizeof channels / sizeof channels[0]; i++) {
    snprintf(line, sizeof line, "\"title\": '%s',", channels[i].title);
    assert_contains(command_out, line);
  }
}

TESTS(command_set_up, command_tear_down)
