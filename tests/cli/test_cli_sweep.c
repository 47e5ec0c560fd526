/* dea sweep as a user runs it: tables, parts, going on after being killed, what may be wrong. */
// ctest: slow, heavy
#include "command.h"

#include <jansson.h>

/* A file with these variables and more keys. */
static void write_file(const char *variables, const char *more)
{
  static char text[4096];
  snprintf(text, sizeof text,
           "dea_explore: 1\nname: mine\ndesign: " DEA_SOURCE_DIR "/examples/frdea-4.yaml\n"
           "model: lumped\nquantities: [electrode_edge_u_m, breakdown_margin]\n"
           "voltages: [2 kV, 5 kV]\nvariables: [%s]\n%s\n",
           variables, more);
  command_write("mine.yaml", text);
}

static void expect(const char *variables, const char *more, const char *message)
{
  write_file(variables, more);
  command_expect("sweep mine.yaml --force", 3, message);
}

TEST(test_errors)
{
  static const char good[] = "{name: pre_stretch, values: [1.5]}";
  expect("{name: film.thicknes, values: [80 um]}", "",
         "mine.yaml:7:20: error: 'film.thicknes' is no key of the design; did you mean "
         "'film.thickness'?");
  expect("{name: fibres.outer_end, values: [1]}", "", "'fibres.outer_end' is no number");
  expect("{name: film.thickness, values: [80]}", "", "mine.yaml:7:45: error: ");
  expect("{name: film.thickness}", "", "give low and high, or values");
  expect("{name: film.thickness, low: 80 um, high: 120 um}", "", "a grid needs values, or steps");
  expect("{name: film.thickness, low: 120 um, high: 80 um}", "plan: sobol",
         "no value lies between");
  expect("{name: film.thickness, distribution: normal, mean: 1 um}", "plan: sobol",
         "this distribution needs mean and std");
  expect("{name: film.thickness, mean: 1 um, std: 1 um, low: 1 um, high: 2 um}", "plan: sobol",
         "are of a normal or lognormal");
  expect(good, "plan: sparse-grid", "pre_stretch: a sparse grid needs low and high");
  expect("{name: fibres.count, low: 3, high: 8}", "plan: sparse-grid", "of no whole number");
  expect(good, "limits: [{quantity: force_N, above: 1 N}]", "is none of the quantities");
  expect(good, "limits: [{quantity: breakdown_margin, above: 1 m}]", "breakdown_margin: '1 m':");
  expect(good, "limits: [{quantity: breakdown_margin}]", "a limit needs above or below");
  expect("{name: pre_stretch, values: [1.5]}, {name: pre_stretch, values: [1.5]}", "",
         "the name 'pre_stretch' is taken by the variable in line 7");
  expect(good, "plan: sobo", "sobo");
  static const char three[] = "{name: pre_stretch, low: 1.4, high: 1.5}, {name: film.thickness, "
                              "low: 90 um, high: 110 um}, {name: film.law.c1, low: 170 kPa, "
                              "high: 180 kPa}";
  expect(three, "plan: sobol\ncorrelations: [0.9, 0.9, -0.9]",
         "mine.yaml:9:16: error: no numbers have these correlations");
  expect(three, "plan: sobol\ncorrelations: [0.9]", "1 correlations where 3 variables have 3");
  expect(three, "plan: indices\ncorrelations: [0, 0, 0.9]", "correlations are of samples");
  write_file(good, "");
  static const char *const shards[] = {"3/2", "0/2", "1/-8", "' 1/8'",          "1/8x",
                                       "1",   "1/",  "+1/8", "1234567/12345678"};
  for (size_t i = 0; i < sizeof shards / sizeof shards[0]; i++) {
    char line[64];
    snprintf(line, sizeof line, "sweep mine.yaml --shard %s", shards[i]);
    command_expect(line, 2, "is no part of parts such as 2/8");
  }
  assert_int_equal(command_run("sweep mine.yaml -j 0"), 2);
  // would throw away what the others compute, or what is to be merged
  static const char *const parts[] = {"--merge", "--shard 1/2", "--slurm 2"};
  for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
    char line[64];
    snprintf(line, sizeof line, "sweep mine.yaml --force %s", parts[i]);
    command_expect(line, 2, "--force throws away the cases of all parts");
  }
}

/* Of a device made of plies: numbers of its parts and shapes. */
TEST(test_parts)
{
  static const struct {
    const char *name, *message;
  } cases[] = {
      {"film.law.c1", "'film.law.c1' is no number of a part of the design"},
      {"plies.film.thicknes", "did you mean 'plies.film.thickness'?"},
      {"pressures[7].pressure", "'pressures[7].pressure' is no number of a part"},
      {"shapes.active.width", "'shapes.active.width' is no number of a part"},
      {"plies.film.thickness", "needs a disc"}, // a good one: lumped is no model of this device
      {"shapes.active.radius", "needs a disc"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    char text[1000];
    snprintf(text, sizeof text,
             "dea_explore: 1\nname: parts\ndesign: " DEA_SOURCE_DIR
             "/examples/devices/diaphragm.yaml\nmodel: lumped\nquantities: [capacitance_F]\n"
             "variables: [{name: \"%s\", values: [1 mm]}]\n",
             cases[i].name);
    command_write("parts.yaml", text);
    command_expect("sweep parts.yaml --force", 3, cases[i].message);
  }
}

/* Monitors by their names, and what each has. */
TEST(test_monitors)
{
  static const struct {
    const char *design, *quantity, *message;
  } cases[] = {
      {"devices/diaphragm", "middle.turn_x_rad",
       "mine.yaml:5:14: error: 'middle.turn_x_rad' is no quantity: of 'middle' there are x_m, y_m, "
       "z_m"},
      {"devices/diaphragm", "midle.z_m", "'midle.z_m' is no quantity; did you mean 'middle_z_m'?"},
      {"devices/diaphragm", "energy_J, energy_J", "mine.yaml:5:24: error: energy_J is there twice"},
      {"devices/diaphragm", "middle.z_m",
       "mine.yaml:5:14: error: model lumped does not support monitors"},
      {"devices/diaphragm", "capacitanc_F", "did you mean 'capacitance_F'?"},
      {"frdea-4", "middle.z_m", "'middle.z_m' is no quantity"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    char text[1000];
    snprintf(text, sizeof text,
             "dea_explore: 1\nname: seen\ndesign: " DEA_SOURCE_DIR
             "/examples/%s.yaml\nmodel: lumped\nquantities: [%s]\n"
             "variables: [{name: pre_stretch, values: [1.2]}]\n",
             cases[i].design, cases[i].quantity);
    command_write("mine.yaml", text);
    command_expect("sweep mine.yaml --force", 3, cases[i].message);
  }
}

/* A design of a material of its own; the film's own area is that of its breakdown field. */
static void write_own(const char *range, const char *shape)
{
  char text[1024];
  snprintf(text, sizeof text,
           "dea: 1\nfilm: {material: mine, thickness: 100 um}\npre_stretch: 1.2\n"
           "frame: {inner_diameter: 40 mm}\nelectrodes: {diameter: 10 mm stretched}\n"
           "compute: {voltage: {values: [3 kV]}}\nmaterials:\n  - name: mine\n"
           "    title: mine\n    kind: elastomer\n    laws:\n"
           "      - {id: a, law: neo-hookean, parameters: {mu: 200 kPa}, source: me,\n"
           "         stretch_range: %s}\n"
           "    permittivity:\n      - {id: a, at_rest: 2.8, source: me}\n"
           "    breakdown:\n      - {id: a, at_rest: 80 V/um, weibull_shape: %s,\n"
           "         reference_area: 0.545415391 cm^2, source: me}\n",
           range, shape);
  command_write("own.yaml", text);
}

static void write_question(const char *name, const char *more)
{
  char text[600];
  snprintf(text, sizeof text, "dea_explore: 1\nname: own\ndesign: own.yaml\nmodel: lumped\n%s",
           more);
  command_write(name, text);
}

/* What a material of the design says, its range and its scatter too, is part of the question. */
TEST(test_another_material)
{
  static const char *const ranges[] = {"[1, 3]", "[1, 4]", "[1, 4]"}, *const shapes[] = {"8", "8",
                                                                                         "9"};
  write_question("other.yaml", "quantities: [range_share, breakdown_probability]\n"
                               "variables: [{name: pre_stretch, values: [1.2]}]\n");
  for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
    write_own(ranges[i], shapes[i]);
    if (i == 0) {
      assert_int_equal(command_run("sweep other.yaml"), 0);
    } else {
      command_expect("sweep other.yaml", 5, "another question");
      assert_int_equal(command_run("sweep other.yaml --force"), 0);
    }
  }
}

/* A search gives its variables ranges, of which a sweep knows no grid. */
TEST(test_sweep_of_a_search)
{
  expect("{name: film.thickness, low: 80 um, high: 120 um}",
         "objectives: [{quantity: electrode_edge_u_m}]", "a grid needs values, or steps");
  write_file("{name: film.thickness, low: 80 um, high: 120 um}",
             "objectives: [{quantity: electrode_edge_u_m}]\nplan: sobol\nsamples: 3");
  assert_int_equal(command_run("sweep mine.yaml -q -o search.sweep"), 0);
}

/* Number of lines of a file that hold a text. */
static int lines_with(const char *name, const char *text)
{
  static char bytes[COMMAND_TEXT_MAX];
  int count = 0;
  command_read(name, bytes);
  for (const char *at = strstr(bytes, text); at != NULL; at = strstr(at + 1, text)) {
    count++;
  }
  return count;
}

/* Numbers that are not to be trusted, of a film that went slack on the way, are said to be that: of
 * a sweep, in tables, bands and what is printed, kept or computed, and of the best of a search. */
TEST(test_flags)
{
  static char text[COMMAND_TEXT_MAX];
  static const char slack[] = "not trusted, slack: so much of the film";
  write_own("[1, 6]", "8");
  write_question("two.yaml", "voltages: [1 kV, 2.2 kV]\nquantities: [electrode_edge_u_m]\n"
                             "variables: [{name: pre_stretch, values: [1.8]},\n"
                             "            {name: film.thickness, values: [60 um, 120 um]}]\n");
  for (int again = 0; again < 2; again++) { // then from what is kept
    command_prints("sweep two.yaml -o two", 0,
                   again == 0 ? "2 of them computed now" : "0 of them computed now");
    assert_contains(command_out, "\n1 of them from 2.2 kV on: not trusted, slack: so much of",
                    "\n1 of them from 2.2 kV on: breakdown: the true field");
    command_read("two/cases.csv", text);
    assert_contains(text, ",time (s),flags@1000,flags@2200,reason\n",
                    ",,slack states breakdown,\n");
    assert_int_equal(lines_with("two/cases.csv", ",,,\n"), 1); // the thick one
  }
  write_question("many.yaml", "voltages: [1 kV, 2.2 kV]\nquantities: [electrode_edge_u_m]\n"
                              "plan: sobol\nsamples: 8\n"
                              "variables: [{name: pre_stretch, low: 1.7, high: 1.8},\n"
                              "            {name: film.thickness, low: 60 um, high: 120 um}]\n");
  command_prints("sweep many.yaml -o many", 0, slack);
  command_read("many/statistics.csv", text);
  assert_contains(text, ",97.5 %,doubted\n");
  const char *row = strstr(text, "electrode_edge_u_m,m,2.2,8,");
  assert_non_null(row);
  *strchr(strchr(text, '\n') + 1, '\n') = '\0';
  assert_string_equal(strrchr(text, ','), ",0");
  int doubted = -1;
  assert_int_equal(sscanf(row, "%*[^,],%*[^,],%*[^,],8,%*f,%*f,%*f,%*f,%*f,%*f,%*f,%d", &doubted),
                   1);
  assert_in_range(doubted, 1, 7);
  char title[80];
  snprintf(title, sizeof title, "title \"up to %d of 8 not to be trusted\"", doubted);
  assert_int_equal(lines_with("many/band_electrode_edge_u_m.gp", title), 1);
  write_question("most.yaml", "voltages: [2.2 kV]\nquantities: [electrode_edge_u_m]\n"
                              "objectives: [{quantity: electrode_edge_u_m, goal: most}]\n"
                              "starts: 1\n"
                              "variables: [{name: pre_stretch, values: [1.8]},\n"
                              "            {name: film.thickness, low: 60 um, high: 120 um}]\n");
  command_prints("optimise most.yaml -o most", 0, slack);
  command_read("most/best.yaml", text);
  assert_contains(text, slack);
}

TEST(test_grid)
{
  static char first[COMMAND_TEXT_MAX], again[COMMAND_TEXT_MAX];
  write_file("{name: film.thickness, low: 80 um, high: 120 um, steps: 3}, "
             "{name: fibres.count, low: 3, high: 4}, "
             "{name: electrodes.diameter, values: [5 mm unstretched, 40 mm unstretched]}",
             "");
  command_prints("sweep mine.yaml -j 2", 0, "designs: 12 of 12 are there, 12 of them computed now");
  assert_contains(command_out, "without all values: 6 (for example: the electrode");
  assert_int_equal(lines_with("mine.sweep/cases.csv", "\n"), 13);
  // the value of a run of its own
  assert_int_equal(command_run("run @/examples/frdea-4.yaml -m lumped --set film.thickness=100um "
                               "--set 'compute.voltage={values: [5 kV]}' --json --study sweep"),
                   0);
  const char *at = strstr(command_out, "\"electrode_edge_u_m\": ");
  assert_non_null(at);
  char wanted[32];
  snprintf(wanted, sizeof wanted, ",%.8g", strtod(at + 22, NULL));
  assert_int_equal(lines_with("mine.sweep/cases.csv", wanted), 2); // three and four fibres
  // a part after the other, and the tables of both, twice, are those of the whole
  command_prints("sweep mine.yaml --shard 1/2 -o parts", 0, "designs: 6 of 12 are there");
  assert_int_equal(command_run("sweep mine.yaml --shard 2/2 -o parts"), 0);
  for (int k = 0; k < 2; k++) {
    command_prints("sweep mine.yaml --merge -o parts", 0, "designs: 12 of 12 are there\n");
  }
  command_read("parts/cases.csv", first);
  command_prints("sweep mine.yaml -o parts", 0, "0 of them computed now");
  command_read("parts/cases.csv", again);
  assert_string_equal(first, again); // to the byte, of the same parts
  command_read("mine.sweep/cases.csv", first);
  const char *a = first, *b = again; // but for the times
  for (int row = 0; row < 13; row++) {
    assert_int_equal(strncmp(a, b, 20), 0);
    a = strchr(a, '\n') + 1;
    b = strchr(b, '\n') + 1;
  }
  write_file("{name: film.thickness, values: [80 um]}", "");
  command_expect("sweep mine.yaml", 5, "another question");
}

/* A sparse grid between whose designs numbers are within the error that they state; one of a higher
 * level takes over what is there. */
TEST(test_sparse_grid)
{
  double z = NAN, error = NAN, margin;
  write_file("{name: pre_stretch, low: 1.3, high: 1.7}, "
             "{name: film.thickness, low: 80 um, high: 120 um}",
             "plan: sparse-grid");
  assert_int_equal(command_run("sweep mine.yaml -o sparse"), 0);
  assert_contains(command_out, "designs: 13 of 13 are there, 13 of them");
  assert_int_equal(command_run("sweep mine.yaml -o sparse --at film.thickness='93 um' "
                               "--at pre_stretch=1.43"),
                   0);
  const char *row = strstr(command_out, "\n5000,");
  assert_true(row != NULL && sscanf(row, "\n5000,%lf,%lf,%lf", &z, &error, &margin) == 3);
  assert_int_equal(command_run("run @/examples/frdea-4.yaml --json --model lumped --study sweep "
                               "--set film.thickness=93um --set pre_stretch=1.43 --set "
                               "'compute.voltage={from: 0 kV, to: 5 kV, step: 5 kV}'"),
                   0);
  json_t *run = json_loads(command_out, 0, NULL);
  const json_t *point = json_array_get(json_object_get(run, "points"), 1);
  const double wanted = json_number_value(json_object_get(point, "electrode_edge_u_m"));
  assert_true(fabs(z - wanted) <= error && error < 0.1 * wanted);
  json_decref(run);
  static const char *const wrong[][2] = {
      {"pre_stretch=1.8", "pre_stretch: 1.8 is outside the range that was computed, 1.3 to 1.7"},
      {"pre_strech=1.4", "'pre_strech' is no variable; did you mean 'pre_stretch'?"},
      {"pre_stretch='1 m'", "--at: error: pre_stretch: '1 m':"}};
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    char line[100];
    snprintf(line, sizeof line, "sweep mine.yaml -o sparse --at %s", wrong[i][0]);
    command_expect(line, 3, wrong[i][1]);
  }
  write_file("{name: pre_stretch, low: 1.3, high: 1.7}, "
             "{name: film.thickness, low: 80 um, high: 120 um}",
             "plan: sparse-grid\nlevel: 3");
  assert_int_equal(command_run("sweep mine.yaml -o sparse"), 0);
  assert_contains(command_out, "designs: 29 of 29 are there, 16 of them");
}

/* Killed again and again: in the end every case is there, and once. */
TEST(test_killed)
{
  char text[700];
  write_file("{name: film.thickness, distribution: normal, mean: 100 um, std: 4 um}, "
             "{name: film.law.c1, distribution: lognormal, mean: 178 kPa, std: 9 kPa}",
             "plan: sobol\nsamples: 400\nlimits: [{quantity: breakdown_margin, above: -0.8}]");
  snprintf(text, sizeof text, "cd '%s' && timeout -s KILL 0.15 '%s' sweep mine.yaml -j 2 -q -o cut",
           command_folder, DEA_COMMAND);
  for (int k = 0; k < 8; k++) {
    assert_int_not_equal(system(text), -1);
  }
  command_prints("sweep mine.yaml -j 2 -o cut", 0, "designs: 400 of 400 are there");
  assert_int_equal(lines_with("cut/part-1-of-1.csv", "\n"),
                   401 + lines_with("cut/part-1-of-1.csv", "\n\n"));
  assert_int_equal(lines_with("cut/cases.csv", "\n"), 401);
  assert_int_equal(lines_with("cut/statistics.csv", "electrode_edge_u_m,m,5,400,"), 1);
  assert_int_equal(lines_with("cut/band_breakdown_margin.svg", "<svg"), 1);
  assert_int_equal(lines_with("cut/limits.csv", "breakdown_margin,-0.8,,400,"), 1);
}

/* Ctrl-C: what is done is in the tables, and the rest is not. */
TEST(test_interrupted)
{
  write_file("{name: film.thickness, distribution: normal, mean: 100 um, std: 4 um}",
             "plan: random\nsamples: 200000");
  command_before = "timeout --foreground --preserve-status -s INT 1"; // else it comes twice
  assert_int_equal(command_run("sweep mine.yaml -j 2 -o early"), 130);
  command_before = "";
  assert_contains(command_err, "interrupted; what was done is kept");
  const int kept = lines_with("early/part-1-of-1.csv", "\n");
  assert_true(kept < 200001);
  assert_int_equal(lines_with("early/cases.csv", "\n"), kept); // each has one line for its head
}

/* A search as a user runs it; docs/explore.md shows it. */
TEST(test_optimise)
{
  static const char best[] = "  pre_stretch                  1.26633";
  write_file("{name: pre_stretch, low: 1.6, high: 1.8}",
             "objectives: [{quantity: breakdown_margin}]");
  command_expect("optimise mine.yaml", 3,
                 "mine.yaml:7:20: error: pre_stretch starts at 1.5, outside of");
  write_file("{name: pre_stretch, low: 1.2, high: 1.8}", "objectives: [{quantity: force_N}]");
  command_expect("optimise mine.yaml", 3, "'force_N' is none of the quantities");
  write_file("{name: pre_stretch, low: 1.2, high: 1.8}",
             "limits: [{quantity: breakdown_margin, above: 0.3, below: 0.2}]");
  command_expect("optimise mine.yaml", 3, "breakdown_margin cannot be above 0.3 and below 0.2");
  write_file(
      "{name: pre_stretch, low: 1.2, high: 1.8}",
      "objectives: [{quantity: electrode_edge_u_m}]\n"
      "limits: [{quantity: breakdown_margin, below: 0.25},"
      " {quantity: electrode_edge_u_m, above: 1 um}, {quantity: breakdown_margin, above: 0.3}]");
  command_expect("optimise mine.yaml", 3, "breakdown_margin cannot be above 0.3 and below 0.25");
  write_file("{name: pre_stretch, low: 1.2, high: 1.8}", "");
  command_expect("optimise mine.yaml", 3, "objectives: say what is wanted");
  write_file("{name: pre_stretch, low: 1.2, high: 1.8}",
             "objectives: [{quantity: breakdown_margin}]\n"
             "limits: [{quantity: breakdown_margin, above: 0.99}]\nevaluations: 20\nstarts: 1");
  command_expect("optimise mine.yaml", 4, "is within all limits");
  command_prints("optimise @/examples/explore/best.yaml -o best", 0, best);
  command_prints("check best/best.yaml", 0, "pre_stretch");
  command_write("best/best-3.yaml", "# Written by dea 0.5.0 optimise, a front that was longer\n");
  command_write("best/best-4.yaml", "# written by hand\n");
  command_prints("optimise @/examples/explore/best.yaml -o best", 0, best);
  const char *at = strstr(command_out, "designs: ");
  assert_non_null(at);
  int all = 0, before = -1;
  assert_int_equal(sscanf(at, "designs: %d, %d of them", &all, &before), 2);
  assert_int_equal(all, before);
  assert_int_equal(lines_with("best/progress.svg", "<svg"), 1);
  assert_int_equal(command_run("check best/best-3.yaml"), 5); // it is gone
  assert_contains(command_err, "best-3.yaml");
  command_expect("check best/best-4.yaml", 3, "best-4.yaml");
  command_write("best/front.csv", "design,pre_stretch (1)\n"); // of a search with two objectives
  command_write("best/front.svg", "<svg/>");
  assert_int_equal(command_run("optimise @/examples/explore/best.yaml -o best"), 0);
  command_expect("check best/front.csv", 5, "cannot open"); // it is gone
  command_expect("check best/front.svg", 5, "cannot open");
}

/* A search that finds nothing leaves no best design of an earlier one in its folder, and no file
 * that is not a search's goes. */
TEST(test_nothing_found_after_a_best)
{
  static const char file[] = "objectives: [{quantity: breakdown_margin, goal: most}]\n"
                             "limits: [{quantity: breakdown_margin, above: %g}]\n"
                             "evaluations: 20\nstarts: 1";
  static char kept[COMMAND_TEXT_MAX];
  char text[300];
  snprintf(text, sizeof text, file, -10.0);
  write_file("{name: pre_stretch, low: 1.2, high: 1.8}", text);
  assert_int_equal(command_run("optimise mine.yaml -o once"), 0);
  assert_int_equal(command_run("check once/best.yaml"), 0);
  snprintf(text, sizeof text, file, 0.99);
  write_file("{name: pre_stretch, low: 1.2, high: 1.8}", text);
  command_expect("optimise mine.yaml -o once", 4, "is within all limits");
  command_expect("check once/best.yaml", 5, "cannot open");
  command_write("once/best.yaml", "# mine\n");
  command_expect("optimise mine.yaml -o once", 4, "is within all limits");
  command_read("once/best.yaml", kept);
  assert_string_equal(kept, "# mine\n");
}

/* No design has a value: that is said with the reasons, and all evaluations stay. */
TEST(test_none_with_values)
{
  command_write("lost.yaml", "dea_explore: 1\nname: lost\ndesign: " DEA_SOURCE_DIR
                             "/examples/frdea-4.yaml\nmodel: lumped\nvoltages: [1 kV]\n"
                             "quantities: [pull_in_voltage_V]\n"
                             "variables: [{name: pre_stretch, values: [1.5, 1.55, 1.6]}]\n"
                             "objectives: [{quantity: pull_in_voltage_V, goal: most}]\n");
  command_expect("optimise lost.yaml", 4,
                 "none of the 3 designs that were tried could be computed");
  assert_contains(command_err, "3 of 3 designs: pull_in_voltage_V: the path has none up to ");
  assert_int_equal(lines_with("lost.optimise/cases.csv", "the path has none"), 3);
  command_expect("optimise lost.yaml", 4, "could be computed");
  assert_contains(command_out, "designs: 3, 3 of them computed before, 3 without all values");
}

/* What is counted off begins at one of its values, not at the design's four fibres. */
TEST(test_values_without_the_start)
{
  static const char more[] = "objectives: [{quantity: electrode_edge_u_m}]";
  write_file("{name: fibres.count, values: [10, 6, 8], start: 4}", more);
  command_expect("optimise mine.yaml", 3,
                 "error: fibres.count starts at 4, which is none of its values");
  write_file("{name: fibres.count, values: [10, 6, 8], start: 8}, {name: pre_stretch, "
             "values: [1.3, 1.4], start: 1.4}",
             more);
  command_prints("optimise mine.yaml -o given", 0, "designs: 6, 0 of them");
  write_file("{name: fibres.count, values: [10, 6, 8]}", more);
  command_prints("optimise mine.yaml -o near", 0, "designs: 3, 0 of them");
}

/* The most capacitance of a film that lives to 4 kV: that voltage goes with the thickness, and the
 * path of the best design, which locates it by itself, has it. What there is not has a reason. */
TEST(test_critical_voltages)
{
  static char text[COMMAND_TEXT_MAX];
  double at_kV;
  command_write("lives.yaml",
                "dea_explore: 1\nname: lives\ndesign: " DEA_SOURCE_DIR
                "/examples/frdea-4.yaml\nmodel: axisymmetric\nvoltages: [1 kV]\nstarts: 1\n"
                "quantities: [capacitance_F, breakdown_voltage_V, slack_voltage_V]\n"
                "variables: [{name: film.thickness, low: 80 um, high: 200 um}]\n"
                "objectives: [{quantity: capacitance_F, goal: most}]\n"
                "limits: [{quantity: breakdown_voltage_V, above: 4 kV}]\n");
  assert_int_equal(command_run("optimise lives.yaml -q"), 0);
  command_read("lives.optimise/best.yaml", text);
  command_write("best.yaml", text);
  assert_int_equal(command_run("run best.yaml --model axisymmetric --study path -q -o lives.run"),
                   0);
  command_read("lives.run/axisymmetric_path_events.csv", text);
  assert_int_equal(sscanf(strstr(text, "breakdown,"), "breakdown,%lf", &at_kV), 1);
  assert_close(at_kV, 4, 1e-6, 0);
  command_write("none.yaml", "dea_explore: 1\nname: none\ndesign: " DEA_SOURCE_DIR
                             "/examples/frdea-4.yaml\nmodel: lumped\nvoltages: [1 kV]\n"
                             "quantities: [pull_in_voltage_V]\n"
                             "variables: [{name: pre_stretch, values: [1.5]}]\n");
  assert_int_equal(command_run("sweep none.yaml -q"), 0);
  command_read("none.sweep/cases.csv", text);
  assert_contains(text, "pull_in_voltage_V: the path has none up to 32 kV");
}

/* A variable sets two numbers, and an optimum at the end of its range says so. */
TEST(test_tied_variable_ends_at_a_bound)
{
  static char text[COMMAND_TEXT_MAX];
  static const char head[] = "dea_explore: 1\nname: tied\ndesign: " DEA_SOURCE_DIR
                             "/examples/frdea-4.yaml\nmodel: axisymmetric\nvoltages: [3 kV]\n"
                             "quantities: [electrode_edge_u_m]\nstarts: 1\nvariables:\n"
                             "  - {name: film.thickness, low: 80 um, high: 120 um, also: [%s]}\n"
                             "objectives: [{quantity: electrode_edge_u_m, goal: most}]\n";
  char file[1000];
  snprintf(file, sizeof file, head, "fibres.thickness, fibres.bond.thickness");
  command_write("tied.yaml", file);
  command_prints("optimise tied.yaml -o tied", 0,
                 "film.thickness               80 um, at its lower bound\n");
  assert_contains(command_out, "fibres.thickness             80 um\n");
  command_read("tied/best.yaml", text);
  assert_contains(text, "#   film.thickness is at its lower bound\n");
  size_t found = 0;
  for (const char *at = text; (at = strstr(at, "thickness: 8e-05 m")) != NULL; at++) {
    found++;
  }
  assert_int_equal(found, 3);
  static const char *const bad[][2] = {
      {"pre_stretch", "pre_stretch (1) cannot take the values of film.thickness (m)"},
      {"electrodes.diameter", "cannot take the values of film.thickness (m)"},
      {"film.thickness", "film.thickness: this is the variable itself"},
      {"fibres.thicknes", "fibres.thickness"}};
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    snprintf(file, sizeof file, head, bad[i][0]);
    command_write("tied.yaml", file);
    command_expect("optimise tied.yaml -o wrong", 3, bad[i][1]);
  }
}

TESTS(command_set_up, command_tear_down)
