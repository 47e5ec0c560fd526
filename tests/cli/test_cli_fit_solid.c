/* dea fit of a device through model 3d. */
// ctest: solid
#include "command.h"

#include <stdio.h>
#include <string.h>

/* The membrane film of model 3d: thickness and pre-stretch back from a sweep of its own. */
TEST(test_membrane)
{
  static const char film[] =
      "dea: 1\nfilm: {material: elastosil-2030, thickness: %g um, viscosity: none}\n"
      "pre_stretch: %g\nframe: {inner_diameter: 30 mm}\nelectrodes: {radius: 3.75 mm stretched}\n"
      "fibres: {count: 4, width: 2 mm, thickness: 100 um, material: pet}\n"
      "compute: {models: [3d], voltage: {values: [0 kV, 2 kV, 4 kV]}, solid: {film: membrane}}\n";
  char text[1000];
  snprintf(text, sizeof text, film, 96.0, 1.45);
  command_write("true.yaml", text);
  snprintf(text, sizeof text, film, 100.0, 1.5);
  command_write("meant.yaml", text);
  const int code = command_run("run true.yaml --study sweep --no-figures -o true --force");
  if (code == 2) { // a build without model 3d
    skip();
  }
  assert_int_equal(code, 0);
  command_write("back.yaml",
                "dea_fit: 1\nname: back\ndesign: meant.yaml\nmodel: 3d\n"
                "parameters: [{name: film.thickness}, {name: pre_stretch}]\ncurves:\n"
                "  - {name: u, file: true/3d_sweep.csv, quantities: [electrode_edge_u_m], "
                "uncertainty_absolute: 0.5 um}\n"
                "  - {name: c, file: true/3d_sweep.csv, quantities: [capacitance_F], "
                "uncertainty_absolute: 0.05 pF}\n");
  assert_int_equal(command_run("fit back.yaml --force"), 0);
  double value, std;
  const char *row = strstr(command_out, "film.thickness");
  assert_non_null(row);
  assert_int_equal(sscanf(row, "film.thickness 100 -> %lf +- %lf", &value, &std), 2);
  assert_close(value, 96, 1e-4, 0);
  row = strstr(command_out, "pre_stretch");
  assert_int_equal(sscanf(row, "pre_stretch 1.5 -> %lf +- %lf", &value, &std), 2);
  assert_close(value, 1.45, 1e-4, 0);
  assert_true(std > 0);
}

TESTS(command_set_up, command_tear_down)
