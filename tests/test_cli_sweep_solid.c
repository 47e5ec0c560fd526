#define _GNU_SOURCE
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

/* The same as from rest, and to the bit the same whoever computes it after whom. */
static void test_neighbours(void **state)
{
  (void)state;
  static char near[DESIGNS][200], rest[DESIGNS][200], parts[DESIGNS][200];
  static double a[DESIGNS][NUMBERS], b[DESIGNS][NUMBERS];
  write_files();
  const int code = command_run("sweep near.yaml -j 1");
  if (code == 2) { // a build without model 3d
    skip();
  }
  assert_int_equal(code, 0);
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

/* A device made of plies: by a ply's thickness with the model's gradients, by a shape without. */
static void test_parts(void **state)
{
  (void)state;
  command_write("parts.yaml",
                "dea_explore: 1\nname: parts\ndesign: " DEA_SOURCE_DIR
                "/examples/devices/diaphragm.yaml\nmodel: 3d\nvoltages: [3 kV]\n"
                "quantities: [highest_z_m, breakdown_margin]\nmethod: slsqp\nstarts: 1\n"
                "evaluations: 12\ntolerance: 1e-3\nobjectives: [{quantity: highest_z_m}]\n"
                "limits: [{quantity: breakdown_margin, above: 0.5}]\nvariables:\n"
                "  - {name: plies.film.thickness, low: 80 um, high: 130 um, start: 120 um}\n"
                "  - {name: shapes.active.radius, low: 8.5 mm, high: 9.5 mm}\n");
  const int code = command_run("optimise parts.yaml -j 1 -q");
  if (code == 2) { // a build without model 3d
    skip();
  }
  assert_int_equal(code, 0);
  assert_contains(command_out, "plies.film.thickness");
  assert_contains(command_out, "by differences of shapes.active.radius");
  const char *margin = strstr(command_out, "breakdown_margin");
  assert_true(margin == NULL || strtod(margin + 16, NULL) > 0.499);
  assert_int_equal(command_run("check parts.optimise/best.yaml"), 0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_neighbours),
      cmocka_unit_test(test_parts),
  };
  return cmocka_run_group_tests(tests, command_set_up, command_tear_down);
}
