/* Study "compare-design": designs made by changes of a file and by other files, set beside it. */
// ctest: quick, heavy
#include "design_text.h"
#include "failing_allocator.h"
#include "io/results_h5.h"
#include "io/summary.h"
#include "job/run_folder.h"
#include "study/study.h"

#include "own_folder.h"
#include "study/design_file.h"
#include "study_result.h"

#include <math.h>

#define VOLTAGES "compute:\n  voltage: {values: [0 kV, 2 kV, 4 kV]}\n"
#define COMPARE                                                                                    \
  VOLTAGES "  compare:\n"                                                                          \
           "    - {name: eight, set: {fibres.count: 8}}\n"                                         \
           "    - name: thick, twice\n"                                                            \
           "      set:\n"                                                                          \
           "        film: {thickness: 200 um}\n"                                                   \
           "        compute.voltage.values: [0 kV, 4 kV, 8 kV]\n"                                  \
           "    - name: none\n"                                                                    \
           "      set: {fibres: null, film: {law: b}}\n"
#define COMPARE_ONE VOLTAGES "  compare: [{name: eight, set: {fibres.count: 8}}]\n"

TEST(test_changes_reach_the_designs)
{
  set_up_result(GOOD_DESIGN COMPARE, NULL, 0);
  const struct dea_design_variant *v = design->compute.compare;
  assert_int_equal(design->compute.compare_count, 3);
  assert_close(design->fibres.count.si, 4, 0, 0);
  assert_close(v[0].design->fibres.count.si, 8, 0, 0);
  assert_close(v[0].design->film.thickness_m.si, 100e-6, 1e-12, 0);
  assert_close(v[1].design->film.thickness_m.si, 200e-6, 1e-12, 0);
  assert_string_equal(v[1].design->film.material.text, "film"); // beside the thickness
  assert_close(v[1].design->compute.voltages_V[2], 8e3, 1e-12, 0);
  assert_false(v[2].design->has_fibres);
  assert_string_equal(v[2].design->film.law.text, "b");
  assert_int_equal(v[0].design->compute.compare_count, 0);
  tear_down_result();
}

static const char *const only[] = {"compare-design"};

/* A film of twice the thickness does at twice the voltage what this one does. */
TEST(test_designs_stand_beside_each_other)
{
  const struct dea_model_type *type = dea_model_find("axisymmetric");
  for (int alone = 0; alone < 2;
       alone++) { // with the sweep, which is not computed twice, or without
    set_up_result(GOOD_DESIGN COMPARE, NULL, 0);
    assert_int_equal(dea_study_run(ctx, type, alone ? only : NULL, alone ? 1 : 0, result), DEA_OK);
    assert_true(alone == (dea_result_find(result, "axisymmetric", "sweep") == NULL));
    assert_int_equal(result->variant_count, 4);
    const struct dea_variant *v = result->variants;
    assert_string_equal(v[0].name, "t"); // of the file t.yaml
    assert_string_equal(v[2].name, "thick, twice");
    assert_true(isnan(v[0].wall_s) == !alone);
    for (size_t i = 0; i < 4; i++) {
      assert_int_equal(v[i].curve.count, 3);
      assert_true(v[i].curve.complete && dea_variant_is(&v[i], "axisymmetric", "compare-design"));
      assert_close(v[i].profile.voltage_V, i == 2 ? 8e3 : 4e3, 1e-12, 0);
      assert_true(v[i].profile.count > 10);
    }
    const struct dea_load_point *a = v[0].curve.points, *b = v[2].curve.points;
    assert_close(b[2].electrode_stretch, a[2].electrode_stretch, 1e-9, 0);
    assert_true(fabs(v[3].curve.points[2].electrode_stretch - a[2].electrode_stretch) > 1e-3);
    tear_down_result();
  }
}

/* The entry that changes nothing names the design itself; a file is found beside the first one. */
TEST(test_other_files)
{
  char text[4000];
  FILE *file = fopen(in_folder("eight.yaml"), "w");
  assert_non_null(file);
  fputs(GOOD_DESIGN VOLTAGES "  compare: [{name: x, set: {pre_stretch: 2}}]\n", file);
  fclose(file);
  snprintf(text, sizeof text, "%s",
           GOOD_DESIGN VOLTAGES "  compare:\n"
                                "    - {name: more, file: eight.yaml, set: {fibres.count: 8}}\n"
                                "    - name: itself\n");
  assert_int_equal(
      dea_design_read_memory(ctx, in_folder("first.yaml"), text, strlen(text), NULL, 0, &design),
      DEA_OK);
  assert_close(design->compute.compare[0].design->fibres.count.si, 8, 0, 0);
  assert_int_equal(design->compute.compare[0].design->compute.compare_count, 0);
  assert_null(design->compute.compare[1].design);
  assert_int_equal(dea_device_build(ctx, design, &device), DEA_OK);
  assert_int_equal(dea_result_create(ctx, design, device, &result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, dea_model_find("lumped"), only, 1, result), DEA_OK);
  assert_int_equal(result->variant_count, 2);
  assert_string_equal(result->variants[0].name, "itself");
  assert_string_equal(result->variants[1].name, "more");
  tear_down_result();
}

/* The same disc made of plies, beside itself. */
TEST(test_other_form)
{
  char text[4000];
  FILE *file = fopen(in_folder("layers.yaml"), "w");
  assert_non_null(file);
  fputs("dea: 1\nshapes: [{name: film, kind: circle, radius: 15 mm},"
        " {name: active, kind: circle, radius: 3.75 mm}]\n"
        "plies: [{name: film, shape: film, material: film, thickness: 100 um, pre_stretch: 1.5}]\n"
        "electrodes: [{ply: film, side: bottom, shape: active, channel: ground},"
        " {ply: film, side: top, shape: active, channel: drive}]\n"
        "supports: [{edge: film}]\n" FILM_MATERIAL VOLTAGES,
        file);
  fclose(file);
  snprintf(text, sizeof text, "%s",
           GOOD_DESIGN VOLTAGES "  compare: [{name: itself, set: {fibres: null}},"
                                " {name: layers, file: layers.yaml}]\n");
  assert_int_equal(
      dea_design_read_memory(ctx, in_folder("first.yaml"), text, strlen(text), NULL, 0, &design),
      DEA_OK);
  assert_int_equal(dea_device_build(ctx, design, &device), DEA_OK);
  assert_int_equal(dea_result_create(ctx, design, device, &result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, dea_model_find("axisymmetric"), only, 1, result), DEA_OK);
  assert_int_equal(result->variant_count, 3);
  const struct dea_curve *itself = &result->variants[1].curve, *layers = &result->variants[2].curve;
  assert_true(itself->count > 1 && layers->count == itself->count);
  for (size_t i = 0; i < itself->count; i++) {
    assert_close(layers->points[i].electrode_stretch, itself->points[i].electrode_stretch, 1e-12,
                 0);
  }
  tear_down_result();
}

TEST(test_errors_have_their_places)
{
  static const struct {
    const char *list, *part;
    size_t line; // after the design's
  } bad[] = {
      {"    - {name: a, set: {fibres.cuont: 8}}\n", "did you mean 'count'?", 4},
      {"    - {name: a}\n    - {name: b, set: {film: {thickness: 200}}}\n", "has no unit", 5},
      {"    - {name: a}\n    - {name: a, set: {fibres.count: 8}}\n", "stands twice", 5},
      {"    - {name: a, set: {film.thickness.x: 8}}\n", "is a value, not a section", 4},
      {"    - {name: a, file: not-there.yaml}\n", "not-there.yaml", 4},
      {"    - {name: a/b}\n", "no '/'", 4},
      {"    - {set: {fibres.count: 8}}\n", "lacks 'name'", 4},
  };
  size_t lines = 0;
  for (const char *c = GOOD_DESIGN; *c != '\0'; c++) {
    lines += *c == '\n';
  }
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    char text[4000];
    snprintf(text, sizeof text, "%s%s%s", GOOD_DESIGN, VOLTAGES "  compare:\n", bad[i].list);
    dea_finding_clear(ctx);
    assert_int_equal(read_and_build(ctx, text, NULL, 0, &design, &device), DEA_E_DESIGN);
    const struct dea_finding *error = find_error(ctx, bad[i].part);
    if (error == NULL) {
      print_findings(ctx);
      fail_msg("no error has '%s'", bad[i].part);
    }
    assert_int_equal(error->location.line, lines + bad[i].line);
  }
  dea_finding_clear(ctx);
}

TEST(test_is_kept)
{
  struct dea_run *run;
  char *text;
  static const struct dea_override svg = {"report.figures", "[svg]"};
  assert_int_equal(read_and_build(ctx, GOOD_DESIGN COMPARE, &svg, 1, &design, &device), DEA_OK);
  assert_int_equal(dea_result_create(ctx, design, device, &result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, dea_model_find("lumped"), NULL, 0, result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, dea_model_find("axisymmetric"), NULL, 0, result), DEA_OK);
  assert_int_equal(dea_run_folder_write(ctx, result, in_folder("run"), NULL), DEA_OK);
  assert_true(there("run/lumped_compare-design.csv"));
  assert_false(there("run/lumped_compare-design_profiles.csv")); // it has none
  assert_true(there("run/axisymmetric_compare-design_profiles.csv"));
  assert_true(there("run/figures/designs.svg") && there("run/figures/design_profiles.svg"));
  assert_int_equal(dea_run_read(ctx, in_folder("run"), &run), DEA_OK);
  assert_int_equal(run->result->variant_count, 8);
  for (size_t i = 0; i < 8; i++) {
    const struct dea_variant *a = &result->variants[i], *b = &run->result->variants[i];
    assert_string_equal(a->name, b->name);
    assert_string_equal(a->curve.model, b->curve.model);
    assert_close(b->curve.points[2].electrode_stretch, a->curve.points[2].electrode_stretch, 0, 0);
    assert_int_equal(b->profile.count, a->profile.count);
  }
  dea_run_destroy(ctx, run);
  assert_int_equal(dea_summary_text(ctx, result, &text), DEA_OK);
  const char *designs = strstr(text, "\"designs\"");
  assert_non_null(designs);
  assert_non_null(strstr(designs, "\"name\": \"thick, twice\""));
  dea_free(ctx, text);
  dea_run_folder_clear(ctx, in_folder("run"));
  assert_false(there("run/axisymmetric_compare-design_profiles.csv"));
  tear_down_result();
}

static void compare_once(struct dea_context *failing)
{
  struct dea_design *mine = NULL;
  struct dea_device *its = NULL;
  struct dea_result *found = NULL;
  dea_status status = read_and_build(failing, GOOD_DESIGN COMPARE_ONE, NULL, 0, &mine, &its);
  if (status == DEA_OK) {
    status = dea_result_create(failing, mine, its, &found);
  }
  if (status == DEA_OK) {
    status = dea_study_run(failing, dea_model_find("lumped"), only, 1, found);
  }
  if (status == DEA_OK) {
    assert_int_equal(found->variant_count, 2);
  }
  failing_check(failing, status);
  dea_result_destroy(failing, found);
  dea_device_destroy(failing, its);
  dea_design_destroy(failing, mine);
}

TEST(test_failing_memory)
{
  assert_true(failing_each(compare_once) > 50);
}

TESTS(set_up, tear_down)
