/* dea sweep through model 3d: designs that begin from a neighbour's solution. */
// ctest: solid
#include "command.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DESIGNS = 8, TAUT_AND_SLACK = 4, NUMBERS = 4 };

static void write_files(void)
{
  command_write("membrane.yaml",
                "dea: 1\nfilm: {material: elastosil-2030, thickness: 100 um}\npre_stretch: 1.5\n"
                "frame: {inner_diameter: 30 mm}\nelectrodes: {radius: 3.75 mm stretched}\n"
                "fibres: {count: 4, width: 2 mm, thickness: 100 um, material: pet}\n"
                "compute: {models: [3d], voltage: {values: [6 kV]}, solid: {film: membrane}}\n");
  // slack at 90 um, taut from there on; no film outside of the larger electrode
  for (int k = 0; k < 2; k++) {
    char text[1000];
    snprintf(text, sizeof text,
             "dea_explore: 1\nname: %s\ndesign: membrane.yaml\nmodel: 3d\nvoltages: [6 kV]\n"
             "quantities: [electrode_edge_u_m, min_tension_N_per_m]\nbegin: %s\nvariables:\n"
             "  - {name: electrodes.radius, values: [3.75 mm stretched, 16 mm stretched]}\n"
             "  - {name: film.thickness, low: 90 um, high: 114 um, steps: 4}\n",
             k == 0 ? "near" : "rest", k == 0 ? "nearest" : "rest");
    command_write(k == 0 ? "near.yaml" : "rest.yaml", text);
  }
}

/* Fields of a table of cases from the variables to the time. */
static void read_cases(const char *name, char fields[DESIGNS][200], double q[DESIGNS][NUMBERS])
{
  static char bytes[COMMAND_TEXT_MAX];
  command_read(name, bytes);
  char *line = strchr(bytes, '\n');
  for (int i = 0; i < DESIGNS; i++) {
    assert_non_null(line);
    const char *from = line + 1;
    line = strchr(line + 1, '\n');
    const char *at = from;
    for (int j = -2; j < NUMBERS; j++) {
      if (j >= 0) {
        q[i][j] = *at == ',' ? NAN : strtod(at, NULL);
      }
      at = strchr(at, ',') + 1;
    }
    snprintf(fields[i], sizeof fields[i], "%.*s", (int)(at - from), from);
  }
}

/* A command that needs model 3d; a build without it skips the test. */
static void run_solid(const char *arguments)
{
  const int code = command_run(arguments);
  if (code == 2) {
    skip();
  }
  assert_int_equal(code, 0);
}

/* The same as from rest, and to the bit the same whoever computes it after whom. */
TEST(test_neighbours)
{
  only_nightly();
  static char near[DESIGNS][200], rest[DESIGNS][200], parts[DESIGNS][200];
  static double a[DESIGNS][NUMBERS], b[DESIGNS][NUMBERS];
  write_files();
  run_solid("sweep near.yaml -j 1");
  assert_contains(command_out, "without all values: 4");
  assert_int_equal(command_run("sweep rest.yaml -j 1"), 0);
  read_cases("near.sweep/cases.csv", near, a);
  read_cases("rest.sweep/cases.csv", rest, b);
  int differ = 0, slack = 0;
  for (int i = 0; i < DESIGNS; i++) {
    assert_int_equal(isnan(a[i][2]), i >= TAUT_AND_SLACK);
    assert_true(i >= TAUT_AND_SLACK || fabs(a[i][2] / b[i][2] - 1) < 1e-8);
    assert_true(i >= TAUT_AND_SLACK || fabs(a[i][3] - b[i][3]) < 1e-6); // N/m
    slack += i < TAUT_AND_SLACK && a[i][3] <= 0;
    differ += strcmp(near[i], rest[i]) != 0;
  }
  assert_int_equal(slack, 1);
  assert_true(differ > 0); // in the last digits: another way led there
  assert_int_equal(command_run("sweep near.yaml -j 2 --shard 2/2 -o parts"), 0);
  assert_int_equal(command_run("sweep near.yaml -j 1 --shard 1/2 -o parts"), 0);
  assert_int_equal(command_run("sweep near.yaml --merge -o parts"), 0);
  read_cases("parts/cases.csv", parts, b);
  for (int i = 0; i < DESIGNS; i++) {
    assert_string_equal(near[i], parts[i]);
  }
}

/* The force on a tip as a limit of a search by the model's gradients, by a number of the film and
 * one of the tip, which ends where the limit is; and what matters to that force. */
TEST(test_force)
{
  static char bytes[COMMAND_TEXT_MAX];
  double force_mN;
  command_write(
      "tip.yaml",
      "dea: 1\nfilm: {material: elastosil-2030, thickness: 100 um}\npre_stretch: 1.5\n"
      "frame: {inner_diameter: 30 mm}\nelectrodes: {radius: 3.75 mm stretched}\n"
      "fibres: {count: 4, width: 2 mm, thickness: 100 um, material: pet}\n"
      "compute: {models: [3d], voltage: {values: [3 kV]}, solid: {film: membrane, order: 1},\n"
      "  force: {depth: [0.5 mm], indenter: sphere}}\n");
  command_write("pressed.yaml",
                "dea_explore: 1\nname: pressed\ndesign: tip.yaml\nmodel: 3d\nvoltages: [3 kV]\n"
                "quantities: [electrode_edge_u_m, force_N]\nmethod: slsqp\nstarts: 1\n"
                "evaluations: 12\ntolerance: 1e-4\nobjectives: [{quantity: electrode_edge_u_m}]\n"
                "limits: [{quantity: force_N, above: 25 mN}]\nvariables:\n"
                "  - {name: film.thickness, low: 80 um, high: 120 um, start: 100 um}\n"
                "  - {name: compute.force.radius, low: 1.2 mm, high: 1.6 mm, start: 1.3 mm}\n");
  run_solid("optimise pressed.yaml -j 1 -q");
  assert_contains(command_out, "gradients: of the model\n");
  command_read("pressed.optimise/best.yaml", bytes);
  command_write("stiff.yaml", bytes);
  assert_int_equal(command_run("run stiff.yaml --study force -q -o stiff.run"), 0);
  command_read("stiff.run/3d_force.csv", bytes);
  assert_int_equal(sscanf(strchr(bytes, '\n'), "\n3,%*f,%*f,%*f,%*f,%*f,%*f,%*f,%lf", &force_mN),
                   1);
  assert_close(force_mN, 25, 1e-3, 0);
  assert_int_equal(command_run("run tip.yaml --study modal --study sensitivity -q -o tip.run"), 0);
  command_read("tip.run/3d_sensitivity_slopes.csv", bytes);
  assert_contains(bytes, "\n3,compute.force.depth,0.0005,m,force,",
                  "\n3,film.thickness,0.0001,m,force,",
                  "\n3,compute.force.depth,0.0005,m,frequency,");
}

static const char cone[] =
    "dea: 1\ntitle: cone\nshapes:\n  - {name: film, kind: circle, radius: 20 mm}\n"
    "  - {name: hub, kind: circle, radius: 5 mm}\n"
    "  - {name: active, kind: difference, of: [film, hub]}\n"
    "  - {name: ring, kind: ring, inner_radius: 6 mm, outer_radius: 12 mm}\n"
    "plies: [{name: film, shape: film, material: elastosil-2030, thickness: 100 um, pre_stretch: "
    "1.2}]\n"
    "electrodes:\n  - {ply: film, side: bottom, shape: active, channel: ground}\n"
    "  - {ply: film, side: top, shape: active, channel: drive}\n"
    "supports: [{edge: film}]\nbodies: [{name: hub, shape: hub, free: [z], force_z: 50 mN}]\n"
    "monitors: [{name: hub, body: hub}, {name: ring, shape: ring}]\n"
    "compute: {models: [3d], voltage: {values: [2 kV, 3 kV]}, solid: {film: membrane, order: 1}}\n";

/* A quantity of the last point of a run of dea run. */
static double last_of(const char *summary, const char *key)
{
  static char bytes[COMMAND_TEXT_MAX];
  char text[80];
  double value = NAN;
  command_read(summary, bytes);
  snprintf(text, sizeof text, "\"%s\": ", key);
  for (const char *at = strstr(bytes, text); at != NULL; at = strstr(at + 1, text)) {
    value = atof(at + strlen(text));
  }
  return value;
}

/* What monitors show as quantities, beside the points of dea run; as objective and limit of a
 * search by the model's gradients, which ends where the limit is. */
TEST(test_monitors)
{
  static char bytes[COMMAND_TEXT_MAX];
  static const char head[] = "dea_explore: 1\nname: seen\ndesign: cone.yaml\nmodel: 3d\n"
                             "quantities: [hub.z_m, ring.z_m, ring_area_stretch]\n";
  char text[1200];
  double hub[2], ring[2], area[2], best;
  command_write("cone.yaml", cone);
  snprintf(
      text, sizeof text,
      "%svoltages: [2 kV, 3 kV]\nvariables: [{name: plies.film.thickness, values: [100 um]}]\n",
      head);
  command_write("seen.yaml", text);
  run_solid("sweep seen.yaml -j 1 -q");
  command_read("seen.sweep/cases.csv", bytes);
  assert_contains(bytes,
                  ",hub.z_m@2000 (m),ring.z_m@2000 (m),ring_area_stretch@2000 (1),hub.z_m@3");
  assert_int_equal(sscanf(strchr(bytes, '\n'), "\n%*d,%*[^,],%*f,%lf,%lf,%lf,%lf,%lf,%lf", &hub[0],
                          &ring[0], &area[0], &hub[1], &ring[1], &area[1]),
                   6);
  assert_int_equal(command_run("run cone.yaml --study sweep -q -o seen.run"), 0);
  assert_close(hub[1], last_of("seen.run/summary.json", "hub_z_m"), 1e-6, 0);
  assert_close(ring[1], last_of("seen.run/summary.json", "ring_z_m"), 1e-6, 0);
  assert_close(area[1], last_of("seen.run/summary.json", "ring_area_stretch"), 1e-8, 0);
  assert_true(hub[0] < hub[1] && ring[0] < ring[1] && area[0] < area[1]);
  snprintf(text, sizeof text,
           "%svoltages: [3 kV]\nobjectives: [{quantity: hub.z_m}]\nstarts: 1\n"
           "limits: [{quantity: ring.z_m, below: 0.35 mm}]\n"
           "variables: [{name: plies.film.thickness, low: 80 um, high: 130 um}]\n",
           head);
  command_write("seen.yaml", text);
  command_prints("optimise seen.yaml -j 1 -q", 0, "gradients: of the model\n");
  command_read("seen.optimise/best.yaml", bytes);
  assert_int_equal(sscanf(strstr(bytes, "hub.z_m = "), "hub.z_m = %lf", &best), 1);
  assert_true(best > hub[1]);
  command_write("best.yaml", bytes);
  assert_int_equal(command_run("run best.yaml --study sweep -q -o best.run"), 0);
  assert_close(last_of("best.run/summary.json", "ring_z_m"), 350e-6, 1e-3, 0);
}

/* What a monitor shows is a column like any other: in the sweep's table, beside a measurement, in a
 * fit, which finds the thickness that the measured device was computed with, and on the report. */
TEST(test_columns_of_monitors)
{
  static char bytes[COMMAND_TEXT_MAX];
  char text[400];
  command_write("cone.yaml", cone);
  run_solid("run cone.yaml --study sweep -q -o true.run --set 'plies[0].thickness=93 um'");
  const double z_m = last_of("true.run/summary.json", "hub_z_m");
  command_read("true.run/3d_sweep.csv", bytes);
  assert_contains(bytes, ",hub z (um),", ",ring area stretch,", ",drive charge (nC),");
  snprintf(text, sizeof text, "V (kV),hub z (mm),hub z std (um)\n3,%.9g,2\n", 1e3 * z_m);
  command_write("hub.csv", text);
  assert_int_equal(command_run("compare true.run hub.csv --quantity hub_z --tolerance 0.001%"), 0);
  assert_int_equal(command_run("compare true.run hub.csv --quantity hub.z_m"), 0);
  command_write("typo.csv", "V (kV),hab z (mm)\n3,1\n");
  command_expect("compare true.run typo.csv", 5, "did you mean 'hub z (um)'?");
  command_write("fit.yaml", "dea_fit: 1\nname: cone\ndesign: cone.yaml\nmodel: 3d\n"
                            "parameters: [{name: plies.film.thickness, low: 85 um, high: 115 um}]\n"
                            "curves: [{name: hub, file: hub.csv}]\n");
  assert_int_equal(command_run("fit fit.yaml -q -o fitted"), 0);
  command_read("fitted/fit.json", bytes);
  const char *value = strstr(bytes, "\"value\": ");
  assert_non_null(value);
  assert_close(atof(value + strlen("\"value\": ")), 93e-6, 1e-5, 0);
  assert_int_equal(command_run("report true.run -q -o true.html"), 0);
  command_read("true.html", bytes);
  assert_contains(bytes, "<dt>hub z</dt>");
}

/* A number of a ply beside what its tolerance does to a monitor; angles and places have none. */
TEST(test_tolerances_of_plies)
{
  static char bytes[COMMAND_TEXT_MAX];
  static const struct {
    const char *row;
    double tolerance;
  } rows[] = {{"\n3,plies.film.thickness,0.0001,m,hub z,", 5e-6},
              {"\n3,plies.film.pre_stretch,1.2,1,hub z,", 0.02}};
  double slope, tolerance, change;
  command_write("cone.yaml", cone);
  run_solid("run cone.yaml --study sensitivity -q -o cone.run");
  command_read("cone.run/3d_sensitivity_slopes.csv", bytes);
  for (int i = 0; i < 2; i++) {
    const char *row = strstr(bytes, rows[i].row);
    assert_non_null(row);
    assert_int_equal(
        sscanf(row + strlen(rows[i].row), "%*f,%lf,%*f,%lf,%lf", &slope, &tolerance, &change), 3);
    assert_close(tolerance, rows[i].tolerance, 1e-9, 0);
    assert_close(change, 1e6 * slope * tolerance, 1e-9, 0); // um
  }
  assert_int_equal(sscanf(strstr(bytes, "\n3,shapes.hub.radius,0.005,m,hub z,"),
                          "\n3,shapes.hub.radius,0.005,m,hub z,%*f,%*f,%*f,%lf", &tolerance),
                   0);
}

/* Where study loading ends, the force that holds the hub there: with all moduli and the
 * permittivity s times as large it is s times as large, and the voltage comes in by eps V^2 only.
 */
TEST(test_end_of_a_line)
{
  static char bytes[COMMAND_TEXT_MAX];
  enum { LAW = 3, PERMITTIVITY = LAW, VOLTAGE, NUMBERS_OF_LINE };
  static const char *const keys[NUMBERS_OF_LINE] = {"plies.film.law.c1", "plies.film.law.c2",
                                                    "plies.film.law.c3",
                                                    "plies.film.permittivity.at_rest", "voltage"};
  double by[NUMBERS_OF_LINE], sum = 0, to;
  command_write("cone.yaml", cone);
  run_solid("run cone.yaml --set 'compute.loading={body: hub, from: 0 mm, to: 3 mm, steps: 2}' "
            "--set 'bodies=[{name: hub, shape: hub, free: [z]}]' "
            "--set 'compute.voltage={values: [3 kV]}' --study sensitivity -q -o line.run");
  command_read("line.run/3d_sensitivity_slopes.csv", bytes);
  for (int i = 0; i < NUMBERS_OF_LINE; i++) {
    char start[80];
    snprintf(start, sizeof start, "\n3,%s,", keys[i]);
    const char *row = bytes;
    do { // the first are of the film that moves freely
      row = strstr(row + 1, start);
      assert_non_null(row);
    } while (strstr(row, ",hub force z,") == NULL ||
             strstr(row, ",hub force z,") > strchr(row + 1, '\n'));
    row = strstr(row, ",hub force z,");
    assert_int_equal(sscanf(row, ",hub force z,%*f,%*f,%lf,,,,,,%lf", &by[i], &to), 2);
    assert_close(to, 3e-3, 1e-12, 0);
    sum += i <= PERMITTIVITY ? by[i] : 0;
  }
  assert_close(sum, 1, 1e-5, 0);
  assert_close(by[VOLTAGE], 2 * by[PERMITTIVITY], 1e-5, 0);
}

/* The heaviest film that does not vibrate below a limit: f^2 times its density stays, as nothing
 * else has a mass. */
TEST(test_frequency_as_a_limit)
{
  static char bytes[COMMAND_TEXT_MAX];
  double first_Hz, first, best;
  command_write("disc.yaml",
                "dea: 1\nfilm: {material: elastosil-2030, thickness: 100 um}\npre_stretch: 1.5\n"
                "frame: {inner_diameter: 30 mm}\nelectrodes: {radius: 3.75 mm stretched}\n"
                "compute: {models: [3d], voltage: {values: [3 kV]}, modal: {},\n"
                "  solid: {film: membrane, order: 1}}\n");
  command_write(
      "heavy.yaml",
      "dea_explore: 1\nname: heavy\ndesign: disc.yaml\nmodel: 3d\nvoltages: [3 kV]\n"
      "quantities: [frequency_Hz]\nmethod: slsqp\nstarts: 1\nevaluations: 30\n"
      "objectives: [{quantity: frequency_Hz, goal: least}]\n"
      "limits: [{quantity: frequency_Hz, above: 600 Hz}]\nvariables:\n"
      "  - {name: film.density, low: 500 kg/m^3, high: 2000 kg/m^3, start: 700 kg/m^3}\n");
  run_solid("optimise heavy.yaml -j 1 -q");
  assert_contains(command_out, "gradients: of the model\n");
  command_read("heavy.optimise/cases.csv", bytes);
  assert_int_equal(sscanf(strchr(bytes, '\n'), "\n0,%*[^,],%lf,%lf", &first, &first_Hz), 2);
  command_read("heavy.optimise/best.yaml", bytes);
  assert_int_equal(sscanf(strstr(bytes, "density:\n"), "density:\n value: %lf", &best), 1);
  assert_close(best, first * pow(first_Hz / 600, 2), 1e-5, 0);
}

TESTS(command_set_up, command_tear_down)
