/* Study "force" with a model of one spring: F = k d + c d^3 - b V^2 on a tip at depth d. */
#include "design_text.h"
#include "study/design_file.h"
#include "study/study.h"

#include "context_fixture.h"

struct dea_model {
  double depth_m, voltage_V;
  int presses;
};

static int created; // models

static const double k = 50, c = 5e6, b = 2e-9;

static double force(const struct dea_model *model)
{
  double d = model->depth_m;
  return d > 0 ? k * d + c * d * d * d - b * model->voltage_V * model->voltage_V : 0;
}

static dea_status create(struct dea_context *context, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  (void)settings;
  (void)device;
  *out = dea_alloc(context, 1, sizeof **out);
  created++;
  return *out != NULL ? DEA_OK : DEA_E_MEMORY;
}

static void destroy(struct dea_context *context, struct dea_model *model)
{
  dea_free(context, model);
}

static dea_status report(const struct dea_model *model, struct dea_load_point *out)
{
  *out = dea_load_point_empty();
  out->voltage_V = model->voltage_V;
  out->tip_depth_m = model->depth_m;
  out->force_N = force(model);
  return DEA_OK;
}

static dea_status solve(struct dea_context *context, struct dea_model *model, double voltage_V,
                        struct dea_load_point *out)
{
  (void)context;
  model->voltage_V = voltage_V;
  return report(model, out);
}

static dea_status indent(struct dea_context *context, struct dea_model *model,
                         const struct dea_probe *tip, double depth_m, struct dea_load_point *out)
{
  (void)context;
  assert_close(tip->radius_m, 2e-3, 1e-12, 0);
  assert_true(tip->shape == DEA_PROBE_FLAT && !tip->from_fibre_side);
  assert_close(model->voltage_V, 0, 0, 0); // pressed first, voltage after
  model->depth_m = depth_m;
  model->presses++;
  return report(model, out);
}

static dea_status save(struct dea_context *context, struct dea_model *model, struct dea_state *out)
{
  *out = (struct dea_state){0};
  return dea_state_add_numbers(context, out, "voltage", &model->voltage_V, 1);
}

static dea_status load(struct dea_context *context, struct dea_model *model,
                       const struct dea_state *state)
{
  (void)context;
  const double *voltage_V = dea_state_find(state, "voltage", 1);
  assert_true(voltage_V != NULL && *voltage_V == 0 && model->depth_m > 0);
  model->voltage_V = *voltage_V;
  return DEA_OK;
}

static const struct dea_model_type spring = {.name = "spring",
                                             .long_name = "one spring",
                                             .create = create,
                                             .destroy = destroy,
                                             .solve = solve,
                                             .indent = indent};

extern const struct dea_study dea_study_force;

static void test_depths_and_preloads(void **state)
{
  (void)state;
  static const struct dea_override sets[] = {
      {"compute.voltage", "{from: 0 kV, to: 2 kV, step: 1 kV}"},
      {"compute.force",
       "{tip: flat, radius: 2 mm, side: back, depth: [1 mm, -1 mm], preload: [180 mN]}"}};
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *result;
  assert_int_equal(
      dea_design_read_memory(ctx, "test.yaml", GOOD_DESIGN, strlen(GOOD_DESIGN), sets, 2, &design),
      DEA_OK);
  assert_int_equal(dea_device_build(ctx, design, &device), DEA_OK);
  assert_int_equal(dea_result_create(ctx, design, device, &result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, &spring, NULL, 0, result), DEA_OK);
  const struct dea_curve *curve = dea_result_find(result, "spring", "force");
  assert_non_null(curve);
  assert_true(curve->complete);
  assert_int_equal(curve->count, 9); // three stops of three voltages
  static const double depths_m[] = {1e-3, -1e-3};
  for (size_t i = 0; i < 6; i++) {
    struct dea_model wanted = {.depth_m = depths_m[i / 3], .voltage_V = 1e3 * (double)(i % 3)};
    assert_close(curve->points[i].tip_depth_m, wanted.depth_m, 1e-12, 0);
    assert_close(curve->points[i].force_N, force(&wanted), 1e-12, 1e-15);
  }
  assert_close(curve->points[6].force_N, 0.18, 1e-3, 0);
  assert_close(curve->points[6].force_N - curve->points[8].force_N, b * 4e6, 1e-9, 0);
  // its load lines: against the depth, the least deep one first, at each voltage
  struct dea_plot *plot;
  assert_int_equal(dea_plot_create(ctx, "load_line", "", &plot), DEA_OK);
  assert_string_equal(dea_study_force.figures[1].name, "load_line");
  assert_int_equal(dea_study_force.figures[1].build(ctx, result, plot), DEA_OK);
  static const size_t by_depth[] = {1, 0, 2};
  assert_int_equal(plot->panels[0].series_count, 3);
  for (size_t v = 0; v < 3; v++) {
    const struct dea_series *line = &plot->panels[0].series[v];
    assert_int_equal(line->count, 3);
    for (size_t i = 0; i < 3; i++) {
      const struct dea_load_point *p = &curve->points[3 * by_depth[i] + v];
      assert_close(line->values[i], 1e3 * p->tip_depth_m, 1e-14, 0);
      assert_close(line->values[3 + i], 1e3 * p->force_N, 1e-14, 0);
    }
  }
  dea_plot_destroy(ctx, plot);
  dea_result_destroy(ctx, result);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
}

/* Without the section nothing is computed. */
static void test_nothing_asked(void **state)
{
  (void)state;
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *result;
  assert_int_equal(
      dea_design_read_memory(ctx, "test.yaml", GOOD_DESIGN, strlen(GOOD_DESIGN), NULL, 0, &design),
      DEA_OK);
  assert_int_equal(dea_device_build(ctx, design, &device), DEA_OK);
  assert_int_equal(dea_result_create(ctx, design, device, &result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, &spring, NULL, 0, result), DEA_OK);
  assert_null(dea_result_find(result, "spring", "force"));
  dea_result_destroy(ctx, result);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
}

/* A tip goes on from the depth before where the next one is deeper; the numbers are those of a
 * model of each depth's own. */
static void test_deeper(void **state)
{
  (void)state;
  static const struct dea_override sets[] = {
      {"compute.voltage", "{from: 0 kV, to: 2 kV, step: 1 kV}"},
      {"compute.force", "{tip: flat, radius: 2 mm, side: back, depth: [1 mm, 2 mm, 3 mm, 2 mm], "
                        "preload: [180 mN]}"}};
  static const char *const name = "force";
  struct dea_model_type types[2] = {spring, spring};
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *results[2];
  types[1].save = save;
  types[1].load = load;
  assert_int_equal(
      dea_design_read_memory(ctx, "test.yaml", GOOD_DESIGN, strlen(GOOD_DESIGN), sets, 2, &design),
      DEA_OK);
  assert_int_equal(dea_device_build(ctx, design, &device), DEA_OK);
  for (int i = 0; i < 2; i++) {
    created = 0;
    assert_int_equal(dea_result_create(ctx, design, device, &results[i]), DEA_OK);
    assert_int_equal(dea_study_run(ctx, &types[i], &name, 1, results[i]), DEA_OK);
    assert_int_equal(created, i == 0 ? 5 : 3); // from rest: 1 mm, 2 mm after 3, the preload
  }
  const struct dea_curve *each = dea_result_find(results[0], "spring", "force");
  const struct dea_curve *on = dea_result_find(results[1], "spring", "force");
  assert_true(each->count == 15 && on->count == 15);
  for (size_t i = 0; i < on->count; i++) {
    assert_close(on->points[i].force_N, each->points[i].force_N, 1e-12, 1e-15);
    assert_close(on->points[i].tip_depth_m, each->points[i].tip_depth_m, 1e-12, 0);
  }
  dea_result_destroy(ctx, results[0]);
  dea_result_destroy(ctx, results[1]);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_depths_and_preloads),
      cmocka_unit_test(test_deeper),
      cmocka_unit_test(test_nothing_asked),
  };
  return cmocka_run_group_tests(tests, context_set_up, context_tear_down);
}
