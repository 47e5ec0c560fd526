/* Effects of tolerances by model 3d against solutions of designs that are changed by hand. */
// ctest: solid
#include "fab_sensitivity.h"
#include "fabricate/process.h"

static void make(const struct dea_override *sets, size_t count)
{
  assert_int_equal(workshop_make(GOOD_DESIGN, sets, count), DEA_OK);
}

TEST(test_disc)
{
  const struct dea_override four = {"compute.voltage", "{values: [4 kV]}"};
  make(&four, 1);
  find_effects();
  assert_string_equal(found.model, "3d");
  assert_close(found.voltage_V, 4e3, 1e-12, 0);
  check_sensitivity(four, 0.02);
}

/* Tips beside the electrode's edge, which the gradient knows: whichever key places them. */
TEST(test_tips)
{
  static const char *const fibres[] = {
      "{count: 4, material: stiff, overlap: 0.5 mm stretched}",
      "{count: 4, material: stiff, tip_radius: 3.25 mm stretched}",
      "{count: 4, material: stiff, length: 11.75 mm stretched}",
  };
  double effect[3];
  for (size_t i = 0; i < 3; i++) {
    const struct dea_override sets[] = {{"fibres", fibres[i]},
                                        {"compute.voltage", "{values: [2 kV]}"}};
    make(sets, 2);
    find_effects();
    effect[i] = effect_of("fibres.");
  }
  assert_true(effect[0] > 0);
  assert_close(effect[1], effect[0], 1e-3, 0);
  assert_close(effect[2], effect[0], 1e-3, 0);
}

static const char *example(const char *name)
{
  static char text[8000];
  char path[500];
  snprintf(path, sizeof path, "%s/examples/%s.yaml", DEA_SOURCE_DIR, name);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  text[fread(text, 1, sizeof text - 1, file)] = '\0';
  fclose(file);
  return text;
}

/* Height of the first monitor of an example with a value changed, at its highest voltage. */
static double height(const char *name, const char *key, const char *value)
{
  const struct dea_override set = {key, value};
  struct dea_design *changed_design;
  struct dea_device *changed;
  struct dea_model *model;
  struct dea_load_point point;
  struct dea_observation seen;
  assert_int_equal(read_and_build(ctx, example(name), &set, 1, &changed_design, &changed), DEA_OK);
  const struct dea_model_type *type = dea_model_find("3d");
  assert_int_equal(dea_model_create(ctx, type, changed_design, changed, &model), DEA_OK);
  assert_int_equal(type->solve(ctx, model, dea_design_highest_V(changed_design), &point), DEA_OK);
  assert_int_equal(dea_model_observe(ctx, type, model, &seen), DEA_OK);
  const double z_m = seen.monitor[0][DEA_OBSERVED_Z];
  type->destroy(ctx, model);
  dea_device_destroy(ctx, changed);
  dea_design_destroy(ctx, changed_design);
  return z_m;
}

/* A device of plies: the height of its middle by the film's thickness and pre-stretch. */
TEST(test_plies)
{
  static const char name[] = "devices/diaphragm";
  assert_int_equal(workshop_make(example(name), NULL, 0), DEA_OK);
  find_effects();
  assert_close(found.voltage_V, dea_design_highest_V(design), 1e-12, 0);
  assert_int_equal(found.seen_count, 1);
  assert_string_equal(found.seen[0].motion, "z");
  const double low_t = height(name, "plies.film.thickness", "95 um"),
               high_t = height(name, "plies.film.thickness", "105 um"),
               low_l = height(name, "plies.film.pre_stretch", "1.08"),
               high_l = height(name, "plies.film.pre_stretch", "1.12");
  assert_close(effect_of("plies.film.thickness"), 0.5 * (high_t - low_t), 0.02, 0);
  assert_close(effect_of("plies.film.pre_stretch"), 0.5 * (high_l - low_l), 0.02, 0);
  assert_true(isnan(effect_of("plies.film.pre_stretch[1]"))); // there is one number
  assert_close(found.seen[0].value, height(name, "plies.film.thickness", "100 um"), 1e-6, 0);
  // as the sheet shows it
  char cell[60];
  struct dea_document document = {.html = {.ctx = ctx}};
  snprintf(cell, sizeof cell, "%+.3g \xc2\xb5m (%+.2g %%)", 1e6 * effect_of("plies.film.thickness"),
           100 * effect_of("plies.film.thickness") / found.seen[0].value);
  assert_int_equal(dea_process_write(ctx, workshop, true, &document), DEA_OK);
  assert_non_null(strstr(dea_text_get(&document.html), cell));
  assert_non_null(strstr(dea_text_get(&document.html), "by model 3d at 4 kV"));
  dea_text_free(&document.html);
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
TEST(test_lower)
{
  const struct dea_override eight = {"compute.voltage", "{values: [8 kV]}"};
  make(&eight, 1); // stretched beyond the range of its law from 4 kV on
  find_effects();
  assert_string_equal(found.model, "3d");
  assert_close(found.voltage_V, 4e3, 1e-12, 0);
  const struct dea_load_point lower = solve(4e3), higher = solve(6e3);
  assert_true(dea_load_point_trusted(&lower) && !dea_load_point_trusted(&higher));
  assert_close(found.seen[0].value, lower.fibre_tip_z_m, 1e-6, 0);

  assert_int_equal(workshop_make(example("frdea-4"), NULL, 0), DEA_OK); // slack from 6.1 kV on
  find_effects();
  assert_close(found.voltage_V, 6e3, 1e-12, 0);
  assert_true(solve(6e3).min_tension_N_per_m > 0);

  const struct dea_override high = {"compute.voltage", "{values: [30 kV]}"};
  make(&high, 1);
  find_effects();
  assert_string_equal(found.model, "lumped");
  assert_close(found.voltage_V, 7.5e3, 1e-12, 0);
  assert_true(effect_of("fibres.") != 0);
}

TESTS(workshop_set_up, workshop_tear_down)
