/* Study "force" of model 3d: interpolated points beside the same voltages computed; lines in
 * processes of their own. */
// ctest: solid
#include "design_text.h"
#include "model/model.h"
#include "result/columns.h"
#include "study/study.h"

#include "context_fixture.h"

/* 34 voltages, at the last of which the film has no tension somewhere. */
static const struct dea_curve *take(const char *force, struct dea_design **design,
                                    struct dea_device **device, struct dea_result **result)
{
  const struct dea_override sets[] = {{"compute.voltage", "{from: 0 kV, to: 6.6 kV, step: 0.2 kV}"},
                                      {"compute.force", force}};
  static const char *const name = "force";
  assert_ok(
      dea_design_read_memory(ctx, "test.yaml", GOOD_DESIGN, strlen(GOOD_DESIGN), sets, 2, design));
  assert_int_equal(dea_device_build(ctx, *design, device), DEA_OK);
  assert_int_equal(dea_result_create(ctx, *design, *device, result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, dea_model_find("3d"), &name, 1, *result), DEA_OK);
  return dea_result_find(*result, "3d", name);
}

/* All forces are within what is estimated, and that within the tolerance; the numbers
 * of computed points are those of a run that computes all. */
TEST(test_interpolated)
{
  struct dea_design *designs[2];
  struct dea_device *devices[2];
  struct dea_result *results[2];
  const struct dea_curve *some = take("{depth: [1 mm]}", &designs[0], &devices[0], &results[0]);
  const struct dea_curve *all =
      take("{depth: [1 mm], tolerance: 0}", &designs[1], &devices[1], &results[1]);
  const int force = dea_point_column_find("force_N");
  size_t computed = 0, beyond = 0;
  assert_true(some->count == 34 && all->count == 34);
  for (size_t i = 0; i < 34; i++) {
    const struct dea_load_point *p = &some->points[i], *q = &all->points[i];
    const struct dea_load_point *rest = &all->points[0];
    assert_false(dea_load_point_interpolated(q));
    assert_true(p->voltage_V == q->voltage_V && p->tip_depth_m == q->tip_depth_m);
    assert_true((dea_load_point_flags(p) & ~(1u << DEA_FLAG_INTERPOLATED)) ==
                dea_load_point_flags(q));
    if (dea_load_point_interpolated(p)) {
      assert_true(q->min_tension_N_per_m > 0);
      assert_true(fabs(p->force_N - q->force_N) <= p->force_interpolation_error_N);
      assert_true(p->force_interpolation_error_N <= 0.002 * rest->force_N);
      assert_close(p->true_field_V_per_m, q->true_field_V_per_m, 0.02, 0);
      assert_close(p->electrode_edge_u_m, q->electrode_edge_u_m, 0.02, 1e-8);
      assert_true(p->interpolation_error <= 0.02);
    } else {
      computed++;
      beyond += q->min_tension_N_per_m < 0 ? 1 : 0;
      assert_close(p->force_N, q->force_N, 1e-5, 0);
    }
  }
  print_message("%zu of 34 computed, %zu without tension somewhere, %s to %.4g mN\n", computed,
                beyond, dea_point_columns[force].header, 1e3 * all->points[0].force_N);
  assert_true(computed < 25 && beyond > 0);
  for (int i = 0; i < 2; i++) {
    dea_result_destroy(ctx, results[i]);
    dea_device_destroy(ctx, devices[i]);
    dea_design_destroy(ctx, designs[i]);
  }
}

/* To the last digit, though the first line has gone to other voltages before the second begins. */
TEST(test_beside)
{
  static const struct dea_override sets[] = {
      {"compute.voltage", "{values: [0 kV, 2 kV, 4 kV]}"},
      {"compute.force", "{depth: [0.2 mm, 0.4 mm], tolerance: 0}"}};
  static const char *const name = "force";
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *results[2];
  const struct dea_curve *curves[2];
  assert_ok(
      dea_design_read_memory(ctx, "test.yaml", GOOD_DESIGN, strlen(GOOD_DESIGN), sets, 2, &design));
  assert_int_equal(dea_device_build(ctx, design, &device), DEA_OK);
  for (size_t i = 0; i < 2; i++) {
    assert_int_equal(dea_result_create(ctx, design, device, &results[i]), DEA_OK);
    const struct dea_study_services services = {.processes = i + 1};
    assert_ok(dea_study_run_with(ctx, dea_model_find("3d"), &name, 1, &services, results[i]));
    curves[i] = dea_result_find(results[i], "3d", name);
    assert_int_equal(curves[i]->count, 6);
  }
  for (size_t p = 0; p < 6; p++) {
    assert_memory_equal(&curves[0]->points[p], &curves[1]->points[p], sizeof *curves[0]->points);
  }
  dea_result_destroy(ctx, results[0]);
  dea_result_destroy(ctx, results[1]);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
}

TESTS(context_set_up, context_tear_down)
