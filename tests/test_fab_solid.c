/* Effects of tolerances by model 3d against solutions of designs that are changed by hand. */
// ctest: solid
#include "fab_sensitivity.h"

static void make(const struct dea_override *sets, size_t count)
{
  assert_int_equal(workshop_make(GOOD_DESIGN, sets, count), DEA_OK);
}

static void test_disc(void **state)
{
  (void)state;
  struct dea_sensitivity found;
  const struct dea_override four = {"compute.voltage", "{values: [4 kV]}"};
  make(&four, 1);
  assert_int_equal(dea_sensitivity_find(ctx, design, device, &found), DEA_OK);
  assert_string_equal(found.model, "3d");
  assert_close(found.voltage_V, 4e3, 1e-12, 0);
  check_sensitivity(&found, four, 0.02);
}

/* Tips beside the electrode's edge, which the gradient knows: whichever key places them. */
static void test_tips(void **state)
{
  (void)state;
  static const char *const fibres[] = {
      "{count: 4, material: stiff, overlap: 0.5 mm stretched}",
      "{count: 4, material: stiff, tip_radius: 3.25 mm stretched}",
      "{count: 4, material: stiff, length: 11.75 mm stretched}",
  };
  struct dea_sensitivity found;
  double effect[3];
  for (size_t i = 0; i < 3; i++) {
    const struct dea_override sets[] = {{"fibres", fibres[i]},
                                        {"compute.voltage", "{values: [2 kV]}"}};
    make(sets, 2);
    assert_int_equal(dea_sensitivity_find(ctx, design, device, &found), DEA_OK);
    effect[i] = found.effect_m[DEA_DEVIATION_FIBRE];
  }
  assert_true(effect[0] > 0);
  assert_close(effect[1], effect[0], 1e-3, 0);
  assert_close(effect[2], effect[0], 1e-3, 0);
}

static struct dea_load_point solve(double voltage_V)
{
  const struct dea_model_type *type = dea_model_find("3d");
  struct dea_model *model;
  struct dea_load_point point;
  assert_int_equal(dea_model_create(ctx, type, design, device, &model), DEA_OK);
  assert_int_equal(type->solve(ctx, model, voltage_V, &point), DEA_OK);
  type->destroy(ctx, model);
  return point;
}

/* Up to the last quarter to be trusted with a film that is taut; a bound where there is none. */
static void test_lower(void **state)
{
  (void)state;
  struct dea_sensitivity found;
  const struct dea_override eight = {"compute.voltage", "{values: [8 kV]}"};
  make(&eight, 1); // stretched beyond the range of its law from 4 kV on
  assert_int_equal(dea_sensitivity_find(ctx, design, device, &found), DEA_OK);
  assert_string_equal(found.model, "3d");
  assert_close(found.voltage_V, 4e3, 1e-12, 0);
  const struct dea_load_point lower = solve(4e3), higher = solve(6e3);
  assert_true(dea_load_point_trusted(&lower) && !dea_load_point_trusted(&higher));
  assert_close(found.displacement_m, lower.fibre_tip_z_m, 1e-6, 0);

  static char text[8000];
  FILE *file = fopen(DEA_SOURCE_DIR "/examples/frdea-4.yaml", "rb");
  assert_non_null(file);
  text[fread(text, 1, sizeof text - 1, file)] = '\0';
  fclose(file);
  assert_int_equal(workshop_make(text, NULL, 0), DEA_OK); // slack from 6.1 kV on
  assert_int_equal(dea_sensitivity_find(ctx, design, device, &found), DEA_OK);
  assert_close(found.voltage_V, 6e3, 1e-12, 0);
  assert_true(solve(6e3).min_tension_N_per_m > 0);

  const struct dea_override high = {"compute.voltage", "{values: [30 kV]}"};
  make(&high, 1);
  assert_int_equal(dea_sensitivity_find(ctx, design, device, &found), DEA_OK);
  assert_string_equal(found.model, "lumped");
  assert_close(found.voltage_V, 7.5e3, 1e-12, 0);
  assert_true(found.effect_m[DEA_DEVIATION_FIBRE] != 0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_disc),
      cmocka_unit_test(test_tips),
      cmocka_unit_test(test_lower),
  };
  return cmocka_run_group_tests(tests, workshop_set_up, workshop_tear_down);
}
