/* What a sweep says when it cannot go on: the kind of the stop, the voltage, and the rest of films
 * that have to be eased into (docs/theory/stops.md). */
// ctest: slow, heavy
#include "design_text.h"
#include "devices.h"
#include "io/summary.h"
#include "result/result.h"
#include "study/study.h"

#include <jansson.h>

#include "context_fixture.h" // after: its context shadows no name of the headers above
static struct dea_result *result;
static struct dea_design *design;

/* A sweep and a path of one model for a device. */
static dea_status run(const struct dea_device *device, const char *model, double highest_V)
{
  static const char *const names[] = {"path", "sweep"};
  char set[100];
  const struct dea_override overrides[] = {{"compute.voltage", set},
                                           {"compute.path.max_stretch", "12"}};
  snprintf(set, sizeof set, "{to: %g V, step: %g V}", highest_V, highest_V / 6);
  assert_int_equal(
      dea_design_read_memory(ctx, "test", GOOD_DESIGN, strlen(GOOD_DESIGN), overrides, 2, &design),
      DEA_OK);
  assert_int_equal(dea_result_create(ctx, design, device, &result), DEA_OK);
  return dea_study_run(ctx, dea_model_find(model), names, 2, result);
}

static void end(void)
{
  dea_result_destroy(ctx, result);
  dea_design_destroy(ctx, design);
}

/* The number or the text of a key of the summary. */
static json_t *summary(void)
{
  char *text;
  assert_int_equal(dea_summary_text(ctx, result, &text), DEA_OK);
  json_t *root = json_loads(text, 0, NULL);
  dea_free(ctx, text);
  return root;
}

/* Pull-in of a soft film by the axisymmetric model, located to the digits that the traced path has,
 * from the far steps of a sweep; in the summary too. */
TEST(test_pull_in_is_located)
{
  struct dea_device device = test_disc(test_material("ogden", 2e5, 1.7, 0), 1.6, 3.75e-3, 0.25, 0);
  assert_int_equal(run(&device, "axisymmetric", 12e3), DEA_E_NO_EQUILIBRIUM);
  const struct dea_curve *sweep = dea_result_find(result, "axisymmetric", "sweep");
  const struct dea_curve *path = dea_result_find(result, "axisymmetric", "path");
  const struct dea_event *traced = dea_curve_first_event(path, DEA_EVENT_PULL_IN);
  const struct dea_event *found = dea_curve_first_event(sweep, DEA_EVENT_PULL_IN);
  assert_non_null(traced);
  assert_non_null(found);
  assert_close(found->point.voltage_V, traced->point.voltage_V, 1e-9, 0);
  assert_true(found->point.voltage_V > sweep->points[sweep->count - 1].voltage_V);
  assert_non_null(strstr(sweep->stopped, "pull-in at"));
  json_t *root = summary();
  assert_string_equal(json_string_value(json_object_get(root, "verdict")), "pull_in");
  json_t *limits = json_object_get(root, "limits");
  assert_close(json_number_value(json_object_get(limits, "pull_in_voltage_V")),
               traced->point.voltage_V, 1e-9, 0);
  json_decref(root);
  end();
}

/* The annulus of a film that is hardly stretched loses its tension, and then its stability in the
 * plane: no end of a law. */
TEST(test_slack_is_said)
{
  struct dea_device device = test_disc(test_yeoh(), 1.05, 7e-3, 0.47, 0);
  assert_int_equal(run(&device, "axisymmetric", 30e3), DEA_E_SLACK);
  const struct dea_curve *sweep = dea_result_find(result, "axisymmetric", "sweep");
  const struct dea_curve *path = dea_result_find(result, "axisymmetric", "path");
  const struct dea_event *traced = dea_curve_first_event(path, DEA_EVENT_SLACK);
  assert_non_null(traced);
  if (sweep->count > 0 && sweep->points[sweep->count - 1].min_tension_N_per_m > 0) {
    const struct dea_event *found = dea_curve_first_event(sweep, DEA_EVENT_SLACK);
    assert_non_null(found);
    assert_close(found->point.voltage_V, traced->point.voltage_V, 1e-9, 0);
  }
  assert_string_equal(dea_verdict_of(sweep->status), "slack");
  end();
}

/* Each kind of stop has its word, and what is no stop has none. */
TEST(test_words)
{
  assert_string_equal(dea_verdict_of(DEA_E_NO_EQUILIBRIUM), "pull_in");
  assert_string_equal(dea_verdict_of(DEA_E_SLACK), "slack");
  assert_string_equal(dea_verdict_of(DEA_E_DOMAIN), "law_end");
  assert_string_equal(dea_verdict_of(DEA_E_INVERTED), "inverted_element");
  assert_string_equal(dea_verdict_of(DEA_E_NOT_CONVERGED), "not_converged");
  static const dea_status none[] = {DEA_OK, DEA_E_INTERRUPTED, DEA_E_MEMORY, DEA_E_DESIGN};
  for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
    assert_string_equal(dea_verdict_of(none[i]), "");
  }
}

/* A thin film that is much stretched under thick, stiff electrodes: they draw it together to a
 * third, further than Newton's method goes at once. The tension along the radius is continuous over
 * the electrode's edge, whose circumference is the same on both sides. */
TEST(test_stiff_electrodes_have_a_rest)
{
  static const double thickness_m[] = {30e-6, 50e-6, 300e-6};
  for (size_t i = 0; i < 3; i++) {
    struct dea_device device =
        test_disc(test_material("neo-hookean", 1.5e4, 0, 0), 3.3, 5e-3, 0.33, 0);
    device.film_thickness_unstretched_m = 20e-6;
    device.film_thickness_m = 20e-6 / (3.3 * 3.3);
    device.electrode = test_material("neo-hookean", 2e6, 0, 0);
    device.electrode_thickness_m = thickness_m[i];
    for (int m = 0; m < 2; m++) {
      const struct dea_model_type *type = dea_model_find(m == 0 ? "lumped" : "axisymmetric");
      struct dea_model *model;
      struct dea_load_point at;
      struct dea_profile profile;
      assert_int_equal(type->create(ctx, &device, NULL, &model), DEA_OK);
      assert_int_equal(type->solve(ctx, model, 0, &at), DEA_OK);
      assert_true(at.stable && at.electrode_stretch < 0.31 && at.electrode_stretch > 1 / 3.3);
      if (m == 1) {
        assert_int_equal(type->profile(ctx, model, &profile), DEA_OK);
        size_t edge = 31; // first sample outside the electrode
        assert_close(profile.radius_m[edge], profile.radius_m[edge - 1], 1e-12, 0);
        assert_close(profile.tension_r_N_per_m[edge], profile.tension_r_N_per_m[edge - 1], 1e-5, 0);
      }
      type->destroy(ctx, model);
    }
  }
}

/* A film that has no rest, here since its law ends before its pre-stretch, has a sweep without
 * points and a verdict like any other. */
TEST(test_no_rest_has_a_verdict)
{
  static const char *const models[] = {"lumped", "axisymmetric"};
  struct dea_device device = test_disc(test_material("gent", 1e5, 3, 0), 2.5, 7e-3, 0.47, 0);
  for (size_t m = 0; m < 2; m++) {
    assert_int_equal(run(&device, models[m], 1e3), DEA_E_DOMAIN);
    const struct dea_curve *sweep = dea_result_find(result, models[m], "sweep");
    assert_non_null(sweep);
    assert_int_equal(sweep->count, 0);
    json_t *root = summary();
    assert_string_equal(json_string_value(json_object_get(root, "model")), models[m]);
    assert_string_equal(json_string_value(json_object_get(root, "verdict")), "law_end");
    assert_true(strlen(json_string_value(json_object_get(root, "stopped"))) > 0);
    json_decref(root);
    end();
  }
}

/* Warnings of a snap-through. */
static size_t snaps_said(void)
{
  size_t count, said = 0;
  const struct dea_finding *finding = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    said += strstr(finding[i].text, "snaps past") != NULL;
  }
  return said;
}

/* A film that snaps past pull-in to where its law stiffens says so once, in the sweep: what else a
 * run solves on the way, to see how far the path is to go or in which steps a map is drawn, is
 * silent. */
TEST(test_a_snap_is_said_once)
{
  static const char *const names[] = {"path", "operating-map", "sweep"};
  static const char *const models[] = {"lumped", "axisymmetric"};
  const struct dea_override voltage = {"compute.voltage", "{to: 4.5 kV, step: 0.75 kV}"};
  struct dea_device device = test_disc(test_material("gent", 1e5, 90, 0), 2, 3e-3, 0.2, 0);
  for (size_t m = 0; m < 2; m++) {
    dea_finding_clear(ctx);
    assert_int_equal(
        dea_design_read_memory(ctx, "test", GOOD_DESIGN, strlen(GOOD_DESIGN), &voltage, 1, &design),
        DEA_OK);
    assert_int_equal(dea_result_create(ctx, design, &device, &result), DEA_OK);
    assert_int_equal(dea_study_run(ctx, dea_model_find(models[m]), names, 3, result), DEA_OK);
    assert_non_null(
        dea_curve_first_event(dea_result_find(result, models[m], "sweep"), DEA_EVENT_PULL_IN));
    assert_int_equal(snaps_said(), 1);
    end();
  }
}

TESTS(context_set_up, context_tear_down)
