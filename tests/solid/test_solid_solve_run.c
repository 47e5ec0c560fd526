/* dea run --model 3d. */
// ctest: solid
#include "command.h"
#include "prototypes.h"

#include <jansson.h>

static double number(const json_t *point, const char *key)
{
  const json_t *value = json_object_get(point, key);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

/* The paper's actuator as built, against the programs of prototypes.h at 5 and 6 kV: everything
 * moves away from the fibres. */
TEST(test_four_fibres)
{
  assert_int_equal(command_run("run @/examples/frdea-4.yaml --model 3d --json "
                               "--set 'compute.voltage={values: [0 kV, 3 kV, 5 kV, 6 kV]}'"),
                   0);
  json_t *root = json_loads(command_out, 0, NULL);
  const json_t *points = json_object_get(root, "points");
  assert_int_equal(json_array_size(points), 4);
  const json_t *rest = json_array_get(points, 0), *last = json_array_get(points, 2);
  assert_close(number(rest, "electrode_stretch"), 1, 1e-9, 0);
  assert_close(number(rest, "min_tension_N_per_m"), 797.745e3 * 100e-6 / 2.25, 1e-4, 0);
  const json_t *at_6kV = json_array_get(points, 3);
  assert_between(number(last, "electrode_edge_u_m"), prototype_edge_5kV_m, 5e-3);
  assert_between(number(at_6kV, "centre_z_m"), prototype_solid_centre_6kV_m, 3e-2);
  assert_between(number(at_6kV, "fibre_tip_z_m"), prototype_solid_tip_6kV_m, 3e-2);
  assert_true(number(last, "min_tension_N_per_m") > 0);
  assert_true(number(last, "min_tension_N_per_m") < number(rest, "min_tension_N_per_m"));
  double h = 100e-6 / 2.25, stretch = number(last, "electrode_stretch");
  assert_true(number(last, "true_field_V_per_m") > 5e3 / h); // the film thins
  assert_close(number(last, "true_field_V_per_m"), 5e3 / h * stretch * stretch, 0.1, 0);
  assert_true(json_is_true(json_object_get(last, "stable")));
  assert_int_equal(json_integer_value(json_object_get(last, "unstable_modes")), 0);
  json_decref(root);
}

/* A result names the libraries that have computed it, of this model PETSc with what it brings:
 * once, and not where another model alone has computed; and what its solver has done. */
TEST(test_libraries)
{
  static const char *const designs[] = {
      "plain-disc.yaml -m lumped", "plain-disc.yaml -m lumped -m 3d", "devices/cone-mass.yaml"};
  for (size_t i = 0; i < 3; i++) {
    char text[200];
    snprintf(text, sizeof text, "run @/examples/%s --json --set 'compute.voltage={values: [0 kV]}'",
             designs[i]);
    assert_int_equal(command_run(text), 0);
    const char *at = strstr(command_out, "\"libraries\": \"libyaml 0.");
    assert_non_null(at);
    const char *petsc = strstr(at, ", PETSc 3."), *slepc = strstr(at, ", SLEPc 3.");
    const char *mumps = strstr(at, ", MUMPS 5.");
    assert_true((petsc != NULL && slepc != NULL && mumps != NULL) == (i > 0));
    assert_true((strstr(at, "\"factorisations\": 0") == NULL) == (i > 0)); // the solver's counts
    assert_true(petsc == NULL ||
                (petsc < strchr(at, '\n') && strstr(petsc + 2, ", PETSc") == NULL));
  }
}

/* Last point of a run in 3D, owned by *root. */
static const json_t *last_point(const char *arguments, json_t **root)
{
  char text[400];
  snprintf(text, sizeof text, "run @/examples/%s --model 3d --json", arguments);
  assert_int_equal(command_run(text), 0);
  *root = json_loads(command_out, 0, NULL);
  const json_t *points = json_object_get(*root, "points");
  return json_array_get(points, json_array_size(points) - 1);
}

/* Fibres that are turned with their mesh do the same; the axes of their nodes are their own. */
TEST(test_turned_fibres)
{
  static const char *const keys[] = {"fibre_tip_z_m", "electrode_edge_u_m", "centre_z_m",
                                     "min_tension_N_per_m", "capacitance_F"};
  static const char *const angles[] = {"0", "17", "-80"}; // 10 from the next one
  json_t *roots[3];
  const json_t *last[3];
  char text[200];
  for (int i = 0; i < 3; i++) {
    snprintf(text, sizeof text,
             "frdea-4.yaml --set compute.solid.order=1 --set 'fibres.angle=%s degree' "
             "--set 'compute.voltage={values: [3 kV]}'",
             angles[i]);
    last[i] = last_point(text, &roots[i]);
  }
  for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++) {
    assert_close(number(last[1], keys[k]), number(last[0], keys[k]), 1e-9, 0);
    assert_close(number(last[2], keys[k]), number(last[0], keys[k]), 1e-9, 0);
  }
  for (int i = 0; i < 3; i++) {
    json_decref(roots[i]);
  }
}

/* Keys of the mesh arrive: what is solved has the elements and nodes of the mesh that `dea mesh`
 * writes, and a whole disc those of its ten sectors. */
TEST(test_mesh_of_the_design)
{
  static const char keys[] = "@/examples/frdea-4.yaml --json --set fibres.count=5 "
                             "--set fibres.outer_end=free --set compute.solid.order=1 "
                             "--set compute.solid.order_z=1";
  static const char *const more[] = {"", "--set compute.solid.refinement=1.3",
                                     "--set compute.solid.domain=disc"};
  double elements[3], nodes[3];
  char text[600];
  for (int i = 0; i < 3; i++) {
    snprintf(text, sizeof text, "mesh %s %s", keys, more[i]);
    assert_int_equal(command_run(text), 0);
    json_t *root = json_loads(command_out, 0, NULL);
    elements[i] = number(root, "elements");
    nodes[i] = number(root, "nodes");
    json_decref(root);
  }
  assert_true(elements[1] > elements[0]);
  assert_close(elements[2], 10 * elements[0], 0, 0);
  snprintf(text, sizeof text,
           "run %s --model 3d --study convergence "
           "--set 'compute.convergence={refinement: [1, 1.3], voltage: [0.5 kV]}'",
           keys);
  assert_int_equal(command_run(text), 0);
  assert_contains(command_err, "one sector of the actuator");
  json_t *root = json_loads(command_out, 0, NULL);
  const json_t *meshes = json_object_get(json_object_get(root, "convergence"), "meshes");
  assert_int_equal(json_array_size(meshes), 2);
  for (size_t i = 0; i < 2; i++) {
    assert_close(number(json_array_get(meshes, i), "elements"), elements[i], 0, 0);
    assert_close(number(json_array_get(meshes, i), "nodes"), nodes[i], 0, 0);
  }
  json_decref(root);
}

/* The preview says what it is, and keeps flat cells beside those of the fibres. Against the
 * membrane of prototypes.h, on the coarsest mesh. */
TEST(test_preview)
{
  assert_int_equal(command_run("run @/examples/frdea-4.yaml --model 3d --json -o preview "
                               "--set compute.solid.film=membrane --set 'report.figures=[svg]' "
                               "--set 'compute.voltage={values: [0 kV, 5 kV, 6 kV]}'"),
                   0);
  assert_contains(command_err, "10 to 20 % off the solid film at the fibre tip");
  json_t *root = json_loads(command_out, 0, NULL);
  const json_t *points = json_object_get(root, "points"), *last = json_array_get(points, 2);
  assert_close(number(json_array_get(points, 1), "electrode_edge_u_m"), prototype_edge_5kV_m.high,
               3.5e-2, 0);
  assert_close(number(last, "fibre_tip_z_m"), prototype_membrane_tip_6kV_m, 5e-2, 0);
  assert_close(number(last, "centre_z_m"), prototype_membrane_centre_6kV_m, 5e-2, 0);
  int said = 0;
  const json_t *notes = json_object_get(root, "notes");
  for (size_t i = 0; i < json_array_size(notes); i++) {
    said += strstr(json_string_value(json_array_get(notes, i)), "is a preview") != NULL;
  }
  assert_int_equal(said, 1);
  json_decref(root);
  command_read("preview/fields/3d_0002.vtu", command_out);
  assert_contains(command_out, "tension_N_per_m");
  command_read("preview/3d_profiles.csv", command_out);
  assert_contains(command_out, "tension");
}

TESTS(command_set_up, command_tear_down)
