/* dea fit of a device, as a user runs it: the example, its files, what may be wrong. */
// ctest: slow, heavy
#include "command.h"

static const char curve[] = "V (kV),u electrode edge (um),capacitance (pF)\n"
                            "1,14,24.9\n2,56,26.1\n3,130,28.4\n4,240,32.1\n";

/* A fit file with these parameters and curves. */
static void write_fit(const char *model, const char *parameters, const char *curves)
{
  static char text[4096];
  snprintf(text, sizeof text,
           "dea_fit: 1\nname: mine\ndesign: " DEA_SOURCE_DIR "/examples/frdea-4.yaml\nmodel: %s\n"
           "parameters: [%s]\ncurves:\n  - {%s}\n",
           model, parameters, curves);
  command_write("mine.yaml", text);
}

/* Runs it; the exit code and one message are wanted. */
static void expect(const char *model, const char *parameters, const char *curves, int code,
                   const char *message)
{
  write_fit(model, parameters, curves);
  command_expect("fit mine.yaml --force", code, message);
}

static const char one[] = "name: s, file: sweep.csv, quantities: [electrode_edge_u_m]";

TEST(test_parameters)
{
  command_write("sweep.csv", curve);
  expect("lumped", "{name: film.thicknes}", one, 3,
         "mine.yaml:5:21: error: 'film.thicknes' is no key of the design; did you mean "
         "'film.thickness'?");
  expect("lumped", "{name: fibres.count}", one, 3, "'fibres.count' is a whole number");
  expect("lumped", "{name: fibres.outer_end}", one, 3, "is no number that could be fitted");
  expect("lumped", "{name: report.width}", one, 3, "does not change what the device does");
  expect("lumped", "{name: film.law.c9}", one, 3, "is no parameter of the law");
  expect("lumped", "{name: film.permittivity.at}", one, 3, "is none of film.permittivity.at_rest");
  expect("lumped", "{name: film.thickness, low: 110 um}", one, 3,
         "film.thickness starts at 0.0001 m, outside of its bounds 0.00011 and 0.01 m");
  expect("lumped", "{name: film.thickness, prior: 100, prior_std: 2 um}", one, 3,
         "mine.yaml:5:44: error: '100': ");
  expect("lumped", "{name: fibres.overlap}", one, 3, "give low and high");
  expect("lumped", "{name: fibres.overlap, low: -1 mm unstretched, high: 1 mm}", one, 3,
         "fibres.overlap is a length stretched in the design");
  expect("lumped", "{name: compute.force.depth}", one, 3, "has no single value");
  expect("lumped", "{name: film.permittivity.at_rest, prior: elastosil-2030}", one, 3,
         "gives no uncertainty of film.permittivity.at_rest");
  expect("lumped", "{name: film.thickness, prior: pet, prior_std: 1 um}", one, 3,
         "the material 'pet' says nothing of film.thickness");
  expect("lumped", "{name: film.thickness, fixed: yes}", one, 3, "nothing is left to be fitted");
  expect("lumped", "{name: pre_stretch}, {name: pre_stretch}", one, 3,
         "the name 'pre_stretch' is taken by the parameter in line 5");
}

TEST(test_curves)
{
  static const char free_one[] = "{name: film.thickness}";
  command_write("sweep.csv", curve);
  expect("lumpet", free_one, one, 3, "reduced; did you mean 'lumped'?");
  expect("lumped", free_one, "name: s, file: none.csv", 5, "none.csv");
  expect("lumped", free_one, "name: s, file: sweep.csv", 3,
         "several quantities can only be weighed");
  expect("lumped", free_one, "name: s, file: sweep.csv, quantities: [capacitance]", 3,
         "'capacitance' is not a quantity; did you mean 'capacitance_F'?");
  expect("lumped", free_one, "name: s, file: sweep.csv, quantities: [force_N]", 3,
         "sweep.csv' has no force_N");
  expect("lumped", free_one, "name: s, file: sweep.csv, uncertainty_absolute: 2 um", 3,
         "an absolute uncertainty is that of one");
  expect("lumped", free_one,
         "name: s, file: sweep.csv, quantities: [electrode_edge_u_m], uncertainty_absolute: 2", 3,
         "electrode_edge_u_m: ");
  expect("lumped", free_one,
         "name: s, file: sweep.csv, quantities: [electrode_edge_u_m], kind: force", 3,
         "mine.yaml:7:72: error: the model lumped does not support a tip");
  command_write("z.csv", "V (kV),z centre (um)\n1,1\n2,2\n");
  expect("axisymmetric", free_one, "name: s, file: z.csv", 3,
         "the model axisymmetric does not know centre_z_m");
  command_write("z.csv", "V (kV),capacitance\n1,1\n2,2\n");
  expect("lumped", free_one, "name: s, file: z.csv", 5, "z.csv:1:8: error:");
  command_write("z.csv", "V (kV),capacitance (pF)\n1,25\n");
  expect("lumped", "{name: film.thickness}, {name: pre_stretch}", "name: s, file: z.csv", 3,
         "1 measured value, priors included, where 2 parameters are sought");
  command_write("z.csv", "V (kV),capacitance (pF),capacitance std (pF)\n1,25,0\n2,26,1\n");
  expect("lumped", free_one, "name: s, file: z.csv", 3, "z.csv:2:1: error: the uncertainty of");
  command_write("z.csv", "V (kV),capacitance (pF),capacitance std (pF)\n1,24.2,1\n2,24.3,1\n");
  expect("lumped", free_one, "name: s, file: z.csv, uncertainty: 1 %", 0,
         "mine.yaml:7:41: warning: capacitance_F of");
  assert_contains(command_err, "has a column of uncertainties: where it says one, that counts");
  // of both polarities: from -3 to 3 kV in one step
  command_write("z.csv", "V (kV),capacitance (pF)\n3,24.8\n-3,24.8\n");
  expect("lumped", free_one, "name: s, file: z.csv, uncertainty: 1 %", 0, "");
  assert_contains(command_out, "fitted    2 rows, off by");
  command_write("z.csv", "V (kV)\n1\n2\n");
  expect("lumped", free_one, "name: s, file: z.csv", 3, "has no quantity beside the voltage");
}

/* The example of docs/fit.md, its files, a folder of dea reduce, and the keys of that page. */
/* Number in that column of a CSV line, from 0. */
static double field_of(const char *line, int column)
{
  for (int k = 0; k < column; k++) {
    line = strchr(line, ',');
    assert_non_null(line);
    line++;
  }
  return strtod(line, NULL);
}

/* The design that was written has bands of its own: at 7 kV the capacitance's is the fit's. */
static void check_band(void)
{
  static char text[COMMAND_TEXT_MAX];
  command_prints("run device/sample-3.yaml --model axisymmetric --no-figures -o run "
                 "--force --set 'compute.voltage={values: [0 kV, 4 kV, 7 kV]}'",
                 0, "what one standard uncertainty changes");
  command_read("device/fit.csv", text);
  const char *row = strstr(text, "sweep,capacitance_F,fit,15,yes,7,");
  assert_non_null(row);
  const double fitted = field_of(row, 10);
  command_read("run/axisymmetric_sweep.csv", text);
  const char *end = strchr(text, '\n');
  assert_non_null(end);
  assert_memory_equal(end - strlen(",capacitance std (pF)"), ",capacitance std (pF)", 21);
  row = strstr(text, "\n7,");
  assert_non_null(row);
  int last = 0;
  for (const char *c = row + 1; *c != '\n'; c++) {
    last += *c == ',';
  }
  assert_close(field_of(row + 1, last), fitted, 0.02, 0);
  command_read("device/sample-3.yaml", text);
  assert_contains(text, "uncertainty:");
}

TEST(test_example)
{
  skip_sanitized();
  static char page[COMMAND_TEXT_MAX];
  command_read_in(DEA_SOURCE_DIR "/docs", "fit.md", page);
  assert_int_equal(command_run("fit @/examples/fit/device.yaml -o device"), 0);
  static const char line[] = "pre_stretch                           1.5 ->     1.4209 +- 0.0032";
  assert_contains(command_out, line);
  assert_contains(page, line);
  assert_contains(command_out,
                  "film.thickness and film.permittivity.at_rest are hardly told apart");
  command_expect("fit @/examples/fit/device.yaml -o device", 5, "--force");
  command_read("device/fit.csv", page);
  assert_contains(page, "sweep,electrode_edge_u_m,fit,2,yes,0,,-3.7,3,");
  command_read("device/fit_capacitance_F.svg", page);
  assert_contains(page, "<svg");
  assert_int_equal(command_run("run device/sample-3.yaml --model lumped --no-figures -o run"), 0);
  check_band();
  command_run("fit @/examples/fit/device.yaml -o device --force --json --profile");
  assert_contains(command_out, "\"interval_low\"", "\"not_told_apart\"");
}

TEST(test_folder)
{
  command_write("sweep.csv", curve);
  char text[700];
  snprintf(text, sizeof text, "%s/reduced", command_folder);
  assert_int_equal(mkdir(text, 0777), 0);
  command_write("reduced/measurement.csv",
                "V (kV),capacitance (pF),capacitance std (pF)\n1,14.9,.1\n2,16.1,.1\n3,18.1,.1\n"
                "6,40,.1\n");
  expect("axisymmetric", "{name: film.thickness}, {name: pre_stretch, start: 1.1, fixed: yes}",
         "name: s, file: reduced", 0, "");
  assert_contains(command_out, "1 of them, from 6 kV on, are left out: the model's film is slack");
}

/* A known film on the simulated bench, its recording reduced and fitted from another design: back
 * within three standard uncertainties. verify/fit-round-trip.sh counts over many recordings. */
TEST(test_round_trip)
{
  static const char film[] =
      "dea: 1\nfilm: {material: elastosil-2030, thickness: 100 um, viscosity: none}\n"
      "pre_stretch: %g\nframe: {inner_diameter: 30 mm}\nelectrodes: {radius: 3.75 mm stretched}\n"
      "fibres: {count: 4, width: 2 mm, thickness: 100 um, material: pet}\n"
      "compute: {models: [lumped], voltage: {to: 4 kV, step: 500 V}}\n";
  char text[1000];
  assert_int_equal(command_run("drive --help"), 0);
  if (strstr(command_out, "Not in this build") != NULL) {
    skip();
  }
  snprintf(text, sizeof text, film, 1.42);
  command_write("true.yaml", text);
  snprintf(text, sizeof text, film, 1.5);
  command_write("meant.yaml", text);
  command_write("protocol.yaml",
                "dea-protocol: 1\ntitle: back\ndesign: true.yaml\nsequence:\n"
                "  - label: a\n    waveform: {kind: staircase, from: 0 kV, to: 4 kV, step: 1 kV, "
                "cycles: 4, frequency: 2 Hz, duty: 50 %}\n"
                "amplifier: {name: a, output: ao0, gain: 1000 V/V, control: 10 V, "
                "max_voltage: 10 kV, slew_limit: 700 V/us, current_limit: 10 mA}\nrate: 1 kHz\n"
                "channels:\n  - {name: v, quantity: voltage, input: ai0, range: 10 V, per_volt: 1 "
                "kV}\n  - {name: i, quantity: current, input: ai1, range: 10 V, per_volt: 1 mA}\n"
                "  - {name: z, quantity: displacement, input: ai2, range: 10 V, per_volt: 1 mm}\n"
                "safety: {largest_field: 320 V/um, field_reason: simulated, trip_current: 1 mA, "
                "trip_time: 10 ms, voltage_error: 200 V, ramp: 5 kV/s}\n");
  command_write("back.yaml", "dea_fit: 1\nname: back\ndesign: meant.yaml\nmodel: lumped\n"
                             "parameters: [{name: pre_stretch, low: 1.2, high: 1.8}]\n"
                             "curves: [{name: s, file: bench.reduced}]\n");
  assert_int_equal(command_run("drive protocol.yaml --sim -o bench.h5 --force"), 0);
  assert_int_equal(command_run("reduce bench.h5 -o bench.reduced --force"), 0);
  assert_int_equal(command_run("fit back.yaml --force"), 0);
  double value, std;
  const char *row = strstr(command_out, "1.5 ->");
  assert_non_null(row);
  assert_int_equal(sscanf(row, "1.5 -> %lf +- %lf", &value, &std), 2);
  assert_true(std < 0.002);
  assert_close(value, 1.42, 0, 3 * std);
}

/* The step response of a known film: back from another start, the resistance of the supply and a
 * viscous branch. The model's own steps are finer in the fit, so what is left is their error. */
TEST(test_transient)
{
  static const char film[] =
      "dea: 1\nfilm: {material: elastosil-2030, thickness: 100 um}\npre_stretch: 1.3\n"
      "frame: {inner_diameter: 30 mm}\nelectrodes: {radius: 3.75 mm stretched}\n"
      "fibres: {count: 4, width: 2 mm, thickness: 100 um, material: pet}\n"
      "drive:\n  series_resistance: 300 Mohm\n  waveform: {kind: step, to: 3 kV, duration: 12 s}\n"
      "compute: {models: [lumped], transient: {interval: 1e-12 s, tolerance: 1e-6}}\n";
  command_write("step.yaml", film);
  assert_int_equal(command_run("run step.yaml --study transient --no-figures -o step --force"), 0);
  command_write("back.yaml",
                "dea_fit: 1\nname: back\ndesign: step.yaml\nmodel: lumped\nparameters:\n"
                "  - {name: drive.series_resistance, start: 200 Mohm}\n"
                "  - {name: film.branch.2.modulus, start: 3 kPa}\n"
                "  - {name: film.branch.2.time, start: 2 s}\n"
                "curves: [{name: s, file: step/lumped_transient.csv, kind: transient, quantities: "
                "[electrode_edge_u_m], uncertainty_absolute: 0.3 um}]\n");
  assert_int_equal(command_run("fit back.yaml --force"), 0);
  static const double truth[] = {3e8, 10.704, 3};
  const char *at = command_out;
  for (int k = 0; k < 3; k++) {
    double value, std;
    at = strstr(at, "-> ");
    assert_non_null(at);
    assert_int_equal(sscanf(at, "-> %lf +- %lf", &value, &std), 2);
    assert_close(value, truth[k], 1e-3, 0);
    assert_true(std < 0.1 * value);
    at += 3;
  }
  static const char in_time[] = "name: s, file: sweep.csv, kind: transient";
  command_write("sweep.csv", curve);
  expect("lumped", "{name: film.thickness}", in_time, 3, "sweep.csv:2:1: error: no time");
  command_write("sweep.csv", "time (s),V (kV),u electrode edge (um)\n0,1,14\n1,1,15\n2,1,15\n");
  expect("lumped", "{name: film.thickness}", in_time, 3,
         "the design plays nothing: it needs drive.waveform");
  expect("lumped", "{name: film.branch.3.time}", one, 3, "is no branch that the film has");
}

TESTS(command_set_up, command_tear_down)
