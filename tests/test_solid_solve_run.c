/* dea run --model 3d. */
// ctest: solid
#define _GNU_SOURCE // mkdtemp
#include "command.h"

#include <jansson.h>

static double number(const json_t *point, const char *key)
{
  const json_t *value = json_object_get(point, key);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

/* The paper's actuator as built; two other programs have 0.237 to 0.239 mm between the fibres at 5
 * kV, and everything moves away from the fibres. */
static void test_four_fibres(void **state)
{
  (void)state;
  assert_int_equal(command_run("run @/examples/frdea-4.yaml --model 3d --json "
                               "--set 'compute.voltage={values: [0 kV, 3 kV, 5 kV]}'"),
                   0);
  json_t *root = json_loads(command_out, 0, NULL);
  const json_t *points = json_object_get(root, "points");
  assert_int_equal(json_array_size(points), 3);
  const json_t *rest = json_array_get(points, 0), *last = json_array_get(points, 2);
  assert_close(number(rest, "electrode_stretch"), 1, 1e-9, 0);
  assert_close(number(rest, "min_tension_N_per_m"), 797.745e3 * 100e-6 / 2.25, 1e-4, 0);
  assert_close(number(last, "electrode_edge_u_m"), 0.238e-3, 1e-2, 0);
  assert_true(number(last, "centre_z_m") < -15e-6 && number(last, "centre_z_m") > -25e-6);
  assert_true(number(last, "fibre_tip_z_m") < -15e-6 && number(last, "fibre_tip_z_m") > -25e-6);
  assert_true(number(last, "min_tension_N_per_m") > 0);
  assert_true(number(last, "min_tension_N_per_m") < number(rest, "min_tension_N_per_m"));
  double h = 100e-6 / 2.25, stretch = number(last, "electrode_stretch");
  assert_true(number(last, "true_field_V_per_m") > 5e3 / h); // the film thins
  assert_close(number(last, "true_field_V_per_m"), 5e3 / h * stretch * stretch, 0.1, 0);
  assert_true(json_is_true(json_object_get(last, "stable")));
  assert_int_equal(json_integer_value(json_object_get(last, "unstable_modes")), 0);
  json_decref(root);
}

/* Without fibres: the exact disc. Force and energy: charge is minus its derivative, so it falls
 * with V. */
static void test_plain_disc(void **state)
{
  (void)state;
  static const char *const orders[] = {"{order: 2}", "{order: 3, order_z: 1}"};
  for (int i = 0; i < 2; i++) {
    char text[200];
    snprintf(text, sizeof text,
             "run @/examples/plain-disc.yaml --model 3d --json "
             "--set 'compute.voltage={values: [0 kV, 3 kV]}' --set 'compute.solid=%s'",
             orders[i]);
    assert_int_equal(command_run(text), 0);
    json_t *root = json_loads(command_out, 0, NULL);
    const json_t *p = json_array_get(json_object_get(root, "points"), 1);
    assert_close(number(p, "electrode_stretch") - 1, 0.03434, 6e-3, 0);
    assert_true(isnan(number(p, "fibre_tip_z_m")));
    assert_close(number(p, "centre_z_m"), 0, 0, 1e-9);
    assert_true(number(p, "energy_J") < 0);
    json_decref(root);
  }
}

/* Eight fibres hold the electrode more than four do, and it goes down too. */
static void test_eight_fibres(void **state)
{
  (void)state;
  assert_int_equal(command_run("run @/examples/frdea-8.yaml --model 3d --json "
                               "--set 'compute.voltage={values: [0 kV, 3 kV]}'"),
                   0);
  json_t *root = json_loads(command_out, 0, NULL);
  const json_t *p = json_array_get(json_object_get(root, "points"), 1);
  assert_true(number(p, "electrode_edge_u_m") > 5e-6);
  assert_true(number(p, "electrode_edge_u_m") < 75e-6); // four: 81 um
  assert_true(number(p, "centre_z_m") < -2e-6);
  assert_true(json_is_true(json_object_get(p, "stable")));
  json_decref(root);
}

/* Keys of the mesh arrive: more unknowns. */
static void test_mesh_of_the_design(void **state)
{
  (void)state;
  assert_int_equal(command_run("run @/examples/frdea-4.yaml --model 3d --json "
                               "--set fibres.count=5 --set fibres.outer_end=free "
                               "--set compute.solid.refinement=1.3 "
                               "--set 'compute.voltage={values: [1 kV]}'"),
                   0);
  assert_contains(command_err, "one sector of the actuator");
}

/* The preview says what it is, and keeps flat cells beside those of the fibres; a run that was cut
 * short goes on. */
static void test_preview(void **state)
{
  (void)state;
  assert_int_equal(command_run("run @/examples/frdea-4.yaml --model 3d --json -o preview "
                               "--set compute.solid.film=membrane --set 'report.figures=[svg]' "
                               "--set 'compute.voltage={values: [0 kV, 5 kV]}'"),
                   0);
  assert_contains(command_err, "10 to 20 % off the solid film at the fibre tip");
  json_t *root = json_loads(command_out, 0, NULL);
  const json_t *last = json_array_get(json_object_get(root, "points"), 1);
  assert_close(number(last, "electrode_edge_u_m"), 0.245e-3, 1e-2, 0);
  assert_close(number(last, "fibre_tip_z_m"), -22.5e-6, 3e-2, 0);
  int said = 0;
  const json_t *notes = json_object_get(root, "notes");
  for (size_t i = 0; i < json_array_size(notes); i++) {
    said += strstr(json_string_value(json_array_get(notes, i)), "is a preview") != NULL;
  }
  assert_int_equal(said, 1);
  json_decref(root);
  command_read("preview/fields/3d_0001.vtu", command_out);
  assert_contains(command_out, "tension_N_per_m");
  command_read("preview/3d_profiles.csv", command_out);
  assert_contains(command_out, "tension");
}

/* Three meshes: more unknowns on each, answers that lie together. */
static void test_study_of_convergence(void **state)
{
  (void)state;
  assert_int_equal(command_run("run @/examples/frdea-4.yaml --model 3d --json "
                               "--study convergence --set 'compute.convergence="
                               "{refinement: [1, 1.2, 1.4], voltage: [1 kV]}'"),
                   0);
  json_t *root = json_loads(command_out, 0, NULL);
  const json_t *study = json_object_get(root, "convergence");
  const json_t *meshes = json_object_get(study, "meshes");
  assert_int_equal(json_array_size(meshes), 3);
  double before = 0;
  for (size_t i = 0; i < 3; i++) {
    double unknowns = number(json_array_get(meshes, i), "unknowns");
    assert_true(unknowns > before);
    before = unknowns;
  }
  const json_t *centre = json_array_get(json_object_get(study, "quantities"), 0);
  const json_t *values = json_object_get(centre, "values");
  assert_string_equal(json_string_value(json_object_get(centre, "quantity")), "centre_z_m");
  assert_close(json_number_value(json_array_get(values, 2)),
               json_number_value(json_array_get(values, 0)), 0.02, 0);
  assert_int_equal(json_array_size(json_object_get(study, "enough")), 1);
  json_decref(root);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_four_fibres),  cmocka_unit_test(test_plain_disc),
      cmocka_unit_test(test_eight_fibres), cmocka_unit_test(test_mesh_of_the_design),
      cmocka_unit_test(test_preview),      cmocka_unit_test(test_study_of_convergence),
  };
  return cmocka_run_group_tests(tests, command_set_up, command_tear_down);
}
