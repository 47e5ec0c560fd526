/* Study "uncertainty": bands against closed forms, against the same film at another voltage, and in
 * the files of a run. */
// ctest: quick, heavy
#include "design_text.h"
#include "failing_allocator.h"
#include "io/csv.h"
#include "io/results_h5.h"
#include "io/summary.h"
#include "result/compare.h"
#include "study/study.h"

#include "own_folder.h"
#include "study_result.h"

#include <math.h>

#define VOLTAGES "compute:\n  voltage: {values: [0 kV, 3 kV, 5 kV]}\n"
#define GIVEN                                                                                      \
  VOLTAGES "  uncertainty:\n"                                                                      \
           "    parameters: [{name: film.thickness, std: 2 um}, {name: pre_stretch, std: 0.01}]\n" \
           "    correlations: [0.5]\n"

static const char *const both[] = {"sweep", "uncertainty"};
static const struct dea_study_services services = {.run = dea_study_run};
static const struct dea_curve *run_sweep(const char *model)
{
  assert_int_equal(dea_study_run_with(ctx, dea_model_find(model), both, 2, &services, result),
                   DEA_OK);
  const struct dea_curve *sweep = dea_result_find(result, model, "sweep");
  assert_non_null(sweep);
  return sweep;
}

/* At rest C goes with l^4 / H, the electrode being given unstretched: 2 % and 4 x 0.01/1.5, of
 * opposite sign. */
TEST(test_capacitance_at_rest)
{
  set_up_result(GOOD_DESIGN GIVEN, NULL, 0);
  const struct dea_curve *sweep = run_sweep("lumped");
  assert_non_null(sweep->std);
  const double of_h = -0.02, of_l = 4 * 0.01 / 1.5;
  const double std = sqrt(of_h * of_h + of_l * of_l + 2 * 0.5 * of_h * of_l);
  assert_close(sweep->std[0].capacitance_F / sweep->points[0].capacitance_F, std, 1e-3, 0);
  assert_true(isnan(sweep->std[1].voltage_V)); // a place, no answer
  assert_close(sweep->std[0].electrode_stretch, 0, 0, 1e-12);
  assert_true(sweep->std[2].electrode_stretch > sweep->std[1].electrode_stretch);
  tear_down_result();
}

/* A film whose law is uncertain by the same share in all parameters, which go together. */
static char *law_design(const char *correlations)
{
  static char text[4000];
  const char *from = "stretch_range: [1, 2], source: test}\n";
  const char *at = strstr(GOOD_DESIGN, from);
  assert_non_null(at);
  snprintf(text, sizeof text,
           "%.*sstandard_uncertainties: {c1: 3.568 kPa, c2: 0.12 kPa, c3: 0.084 kPa}, "
           "correlations: %s,\n         %s" VOLTAGES,
           (int)(at - GOOD_DESIGN), GOOD_DESIGN, correlations, at);
  return text;
}

/* All moduli larger by a share r are a voltage that is smaller by r/2. */
TEST(test_law_goes_as_voltage)
{
  static const char *const models[] = {"lumped", "axisymmetric"};
  for (int m = 0; m < 2; m++) {
    set_up_result(law_design("[-1, 1, -1]"), NULL, 0); // c2 is negative
    const double r = 0.02;
    const struct dea_curve *sweep = run_sweep(models[m]);
    assert_non_null(sweep->std);
    struct dea_model *model;
    assert_int_equal(dea_model_create(ctx, dea_model_find(models[m]), design, device, &model),
                     DEA_OK);
    for (size_t i = 1; i < 3; i++) {
      const double V = sweep->points[i].voltage_V, h = 1e-3;
      struct dea_load_point up, down;
      const struct dea_model_type *type = dea_model_find(models[m]);
      assert_int_equal(type->solve(ctx, model, V * (1 - h), &down), DEA_OK);
      assert_int_equal(type->solve(ctx, model, V * (1 + h), &up), DEA_OK);
      const double slope = (up.electrode_stretch - down.electrode_stretch) / (2 * h * V);
      assert_close(sweep->std[i].electrode_stretch, r / 2 * V * slope, 3e-3, 0);
    }
    dea_model_find(models[m])->destroy(ctx, model);
    tear_down_result();
  }
}

/* Independent parameters: less than those that go together, and c1 the largest of them. */
TEST(test_correlations_count)
{
  set_up_result(law_design("[-1, 1, -1]"), NULL, 0);
  const double together = run_sweep("lumped")->std[2].electrode_stretch;
  const struct dea_result_table *table =
      dea_result_find_table(result, "lumped", "uncertainty", "effects");
  assert_non_null(table);
  assert_true(table->row_count >= 4 && table->row_count % 4 == 0); // four of each quantity
  assert_string_equal(dea_result_table_quantity(table, 3)->key, "electrode_stretch");
  double sum = 0;
  for (size_t j = 0; j < 3; j++) {
    sum += dea_result_table_number(table, j, "change", 0) * (j == 1 ? -1 : 1);
  }
  assert_close(fabs(sum), together, 1e-9, 0);
  assert_close(dea_result_table_number(table, 3, "change", 0), together, 1e-12, 0);
  double squares = 0;
  for (size_t j = 0; j < 3; j++) {
    squares += pow(dea_result_table_number(table, j, "change", 0), 2);
  }
  tear_down_result();
  set_up_result(law_design("[0, 0, 0]"), NULL, 0);
  assert_close(run_sweep("lumped")->std[2].electrode_stretch, sqrt(squares), 1e-9, 0);
  tear_down_result();
}

/* Where a film that is a standard uncertainty thinner has gone slack the band is that of the
 * thicker one alone, and that is said. */
TEST(test_other_side_alone)
{
  static const char steps[] = "compute:\n  voltage: {from: 0 kV, to: 16 kV, step: 0.1 kV}\n";
  static const char given[] = "  uncertainty: {parameters: [{name: film.thickness, std: 3 um}]}\n";
  char text[4000], thick[4000];
  const struct dea_model_type *type = dea_model_find("axisymmetric");
  snprintf(text, sizeof text, "%s%s%s", GOOD_DESIGN, steps, given);
  snprintf(thick, sizeof thick, "%s%s", GOOD_DESIGN, steps);
  memcpy(strstr(thick, "thickness: 100 um"), "thickness: 103 um", 17);
  set_up_result(thick, NULL, 0);
  assert_int_equal(dea_study_run(ctx, type, both, 1, result), DEA_OK);
  struct dea_result *other = result;
  struct dea_design *its = design;
  struct dea_device *their = device;
  set_up_result(text, NULL, 0);
  const struct dea_curve *sweep = run_sweep("axisymmetric");
  const struct dea_curve *thicker = dea_result_find(other, "axisymmetric", "sweep");
  const unsigned slack = 1u << DEA_FLAG_SLACK;
  size_t last = 0;
  while ((dea_load_point_flags(&sweep->points[last + 1]) & slack) == 0) {
    last++;
  }
  assert_in_range(last, 20, 150);
  const double to_thick =
      thicker->points[last].electrode_stretch - sweep->points[last].electrode_stretch;
  assert_close(sweep->std[last].electrode_stretch, fabs(to_thick), 1e-9, 0);
  assert_true(isnan(sweep->std[last + 1].electrode_stretch));
  const struct dea_finding *told = find_finding(ctx, DEA_WARNING, "film.thickness 97 um has no");
  assert_non_null(told);
  double from_kV = 0;
  assert_int_equal(sscanf(told->text, "model axisymmetric: from %lf", &from_kV), 1);
  assert_in_range((size_t)(from_kV / 0.1 + 0.5), last - 6, last); // 3 % of the voltage
  assert_null(find_finding(ctx, DEA_WARNING, "film.thickness 103 um has no"));
  dea_finding_clear(ctx);
  tear_down_result();
  dea_result_destroy(ctx, other);
  dea_device_destroy(ctx, their);
  dea_design_destroy(ctx, its);
}

/* Nothing uncertain, no band; and none from what the section does not know. */
TEST(test_nothing_and_errors)
{
  static const struct {
    const char *section, *part;
  } bad[] = {
      {"{parameters: [{name: film.thicknes, std: 2 um}]}", "did you mean 'film.thickness'"},
      {"{parameters: [{name: fibres.count, std: 1}]}", "is a whole number"},
      {"{parameters: [{name: film.thickness, std: 2 kV}]}", "std:"},
      {"{parameters: [{name: film.thickness, std: 0 um}]}", "more than 0"},
      {"{parameters: [{name: film.law.mu, std: 1 kPa}]}", "no parameter of the law"},
  };
  set_up_result(GOOD_DESIGN VOLTAGES, NULL, 0);
  assert_null(run_sweep("lumped")->std);
  tear_down_result();
  for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
    char text[4000];
    snprintf(text, sizeof text, "%s  uncertainty: %s\n", GOOD_DESIGN VOLTAGES, bad[k].section);
    set_up_result(text, NULL, 0);
    assert_int_equal(dea_study_run_with(ctx, dea_model_find("lumped"), both, 2, &services, result),
                     DEA_E_DESIGN);
    assert_non_null(find_error(ctx, bad[k].part));
    dea_context_clear(ctx);
    dea_finding_clear(ctx);
    tear_down_result();
  }
  design = NULL;
  assert_int_equal(read_and_build(ctx,
                                  GOOD_DESIGN VOLTAGES
                                  "  uncertainty: {parameters: [{name: pre_stretch, std: 0.1}],"
                                  " correlations: [0.1]}\n",
                                  NULL, 0, &design, &device),
                   DEA_E_DESIGN);
  assert_non_null(find_error(ctx, "1 correlations where 1 parameters have 0"));
  dea_context_clear(ctx);
  dea_finding_clear(ctx);
  assert_int_equal(read_and_build(ctx,
                                  GOOD_DESIGN VOLTAGES
                                  "  uncertainty: {parameters: [{name: pre_stretch, std: 0.1},"
                                  " {name: pre_stretch, std: 0.1}]}\n",
                                  NULL, 0, &design, &device),
                   DEA_E_DESIGN);
  assert_non_null(find_error(ctx, "the name 'pre_stretch' is taken by the parameter in line"));
  dea_context_clear(ctx);
  dea_finding_clear(ctx);
}

/* The band is in results.h5, in the CSV, which reads as a measurement, and in the summary. */
TEST(test_is_kept)
{
  struct dea_run *run;
  struct dea_measurement *measured;
  char *text;
  set_up_result(GOOD_DESIGN GIVEN, NULL, 0);
  const struct dea_curve *sweep = run_sweep("lumped");
  assert_int_equal(dea_results_h5_write(ctx, result, in_folder("r.h5")), DEA_OK);
  assert_int_equal(dea_run_read(ctx, in_folder("r.h5"), &run), DEA_OK);
  const struct dea_curve *again = dea_result_find(run->result, "lumped", "sweep");
  assert_non_null(again);
  assert_non_null(again->std);
  assert_close(again->std[2].true_field_V_per_m, sweep->std[2].true_field_V_per_m, 0, 0);
  assert_int_equal(dea_csv_write_curve(ctx, sweep, folder), DEA_OK);
  assert_int_equal(dea_measurement_read(ctx, in_folder("lumped_sweep.csv"), &measured), DEA_OK);
  assert_close(measured->std[2].capacitance_F, sweep->std[2].capacitance_F, 1e-11, 0);
  assert_int_equal(dea_summary_text(ctx, result, &text), DEA_OK);
  assert_non_null(strstr(text, "\"std\""));
  dea_free(ctx, text);
  struct dea_comparison beside; // with itself: the misfit knows both
  struct dea_arena memory = {.ctx = ctx};
  const int column = dea_point_column_find("capacitance_F");
  assert_int_equal(
      dea_compare_curves(&memory, again, &measured->curve, measured->std, &column, 1, &beside),
      DEA_OK);
  assert_close(beside.misfits[0].a_std[1], sweep->std[1].capacitance_F, 1e-11, 0);
  assert_close(beside.misfits[0].b_std[1], sweep->std[1].capacitance_F, 1e-11, 0);
  dea_arena_free(&memory);
  dea_measurement_destroy(ctx, measured);
  dea_run_destroy(ctx, run);
  tear_down_result();
}

/* Few numbers, as it runs once for each allocation. */
static void run_once(struct dea_context *failing)
{
  struct dea_design *mine = NULL;
  struct dea_device *its = NULL;
  struct dea_result *found = NULL;
  dea_status status = read_and_build(
      failing,
      GOOD_DESIGN VOLTAGES "  uncertainty: {parameters: [{name: film.thickness, std: 2 um}]}\n",
      NULL, 0, &mine, &its);
  if (status == DEA_OK) {
    status = dea_result_create(failing, mine, its, &found);
  }
  if (status == DEA_OK) {
    status = dea_study_run_with(failing, dea_model_find("lumped"), both, 2, &services, found);
  }
  if (status == DEA_OK) {
    assert_non_null(dea_result_find(found, "lumped", "sweep")->std);
  }
  failing_check(failing, status);
  dea_result_destroy(failing, found);
  dea_device_destroy(failing, its);
  dea_design_destroy(failing, mine);
}

TEST(test_failing_memory)
{
  assert_true(failing_each(run_once) > 50);
}

TESTS(set_up, tear_down)
