/* Study "convergence": the estimate against values whose order and limit are known, and the study
 * with a model that has such values. */
#include "design_text.h"
#include "failing_allocator.h"
#include "io/results_h5.h"
#include "io/summary.h"
#include "job/run_folder.h"
#include "result/richardson.h"
#include "study/study.h"

#include "own_folder.h"
#include "study/design_file.h"

#include <math.h>

/* ---- the estimate ---- */

/* f = 3 + 0.2 h^p on element sizes h = 2^-n. */
static double value(double refinement, double order)
{
  return 3 + 0.2 * exp2(-order * refinement);
}

TEST(test_known_order)
{
  static const double n[][3] = {{1, 2, 3}, {1, 1.5, 2}, {1, 1.5, 3}, {1, 3, 3.2}};
  static const double orders[] = {0.6, 1, 1.5, 2};
  for (size_t i = 0; i < sizeof n / sizeof n[0]; i++) {
    for (size_t k = 0; k < sizeof orders / sizeof orders[0]; k++) {
      double f[3], order, limit, errors[3];
      for (int m = 0; m < 3; m++) {
        f[m] = value(n[i][m], orders[k]);
      }
      assert_int_equal(dea_richardson(n[i], f, 3, &order, &limit, errors), DEA_ORDER_OBSERVED);
      assert_close(order, orders[k], 1e-7, 0);
      assert_close(limit, 3, 1e-8, 0);
      for (int m = 0; m < 3; m++) {
        assert_close(errors[m], (f[m] - 3) / 3, 1e-6, 0);
      }
    }
  }
}

TEST(test_no_order)
{
  static const double n[] = {1, 2, 3, 4};
  double order, limit, errors[4];
  const double zigzag[] = {1.3, 1.1, 1.0, 1.02};
  assert_int_equal(dea_richardson(n, zigzag, 4, &order, &limit, errors), DEA_ORDER_NOT_MONOTONE);
  assert_true(isnan(order) && isnan(limit));
  assert_close(errors[0], 3 * 0.3 / 1.02, 1e-12, 0); // three times the largest difference
  assert_close(errors[2], 3 * 0.02 / 1.02, 1e-12, 0);
  assert_close(errors[3], 3 * 0.02 / 1.02, 1e-12, 0);
  const double runaway[] = {1, 1.1, 1.2, 1.35};
  assert_int_equal(dea_richardson(n, runaway, 4, &order, &limit, errors), DEA_ORDER_NOT_FALLING);
  assert_true(isnan(order) && isnan(limit));
  const double same[] = {2, 1.5, 1.5 + 1e-9, 1.5};
  assert_int_equal(dea_richardson(n, same, 4, &order, &limit, errors), DEA_ORDER_NO_CHANGE);
  assert_true(errors[3] < 1e-8 && errors[0] > 0.9);
  assert_int_equal(dea_richardson(n, same, 2, &order, &limit, errors), DEA_ORDER_TOO_FEW);
  assert_close(errors[0], 3 * 0.5 / 1.5, 1e-12, 0);
  assert_int_equal(dea_richardson(n, same, 1, &order, &limit, errors), DEA_ORDER_TOO_FEW);
  assert_true(isnan(errors[0]));
}

/* ---- the study ---- */

struct dea_model {
  double refinement, voltage_V;
};

static const double fails_above_V = 7e3; // on the finest mesh

static dea_status create(struct dea_context *context, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  *out = dea_alloc(context, 1, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  (*out)->refinement = settings->refinement;
  return DEA_OK;
}

static void destroy(struct dea_context *context, struct dea_model *model)
{
  dea_free(context, model);
}

/* The tip converges with order 1 to -V^2, the edge with order 2; the centre does not below 5 kV. */
static dea_status solve(struct dea_context *context, struct dea_model *model, double voltage_V,
                        struct dea_load_point *out)
{
  double n = model->refinement, V = 1e-3 * voltage_V;
  if (voltage_V > fails_above_V && n > 2.9) {
    return dea_fail(context, DEA_E_NOT_CONVERGED, "no further");
  }
  *out = dea_load_point_empty();
  out->voltage_V = model->voltage_V = voltage_V;
  out->fibre_tip_z_m = -1e-6 * V * V * (1 + 0.15 * exp2(-n));
  out->electrode_edge_u_m = 1e-5 * V * V * (1 - 0.1 * exp2(-2 * n));
  out->centre_z_m = -1e-6 * V * V * (V < 5 ? 1 + (n == 2 ? 0.1 : 0) : 1 + 0.01 * exp2(-n));
  return DEA_OK;
}

static dea_status profile(struct dea_context *context, struct dea_model *model,
                          struct dea_profile *out)
{
  static const double radius[2] = {0, 1e-3}, none[2] = {0, 0};
  (void)context, (void)model;
  *out = (struct dea_profile){2, radius, none, none, none, none, none, radius};
  return DEA_OK;
}

static void size(const struct dea_model *model, struct dea_model_size *out)
{
  size_t n = (size_t)(100 * exp2(2 * model->refinement) + 0.5);
  *out = (struct dea_model_size){n, 8 * n, 24 * n};
}

static const struct dea_model_type fake = {.name = "fake",
                                           .long_name = "fake",
                                           .create = create,
                                           .destroy = destroy,
                                           .solve = solve,
                                           .profile = profile,
                                           .size = size};

#include "study_result.h" // after the models: its names shadow none of theirs

static void set_up_meshes(const char *section)
{
  const struct dea_override sets[] = {{"compute.convergence", section},
                                      {"report", "{figures: [svg]}"}};
  set_up_result(GOOD_DESIGN, sets, 2);
}

static const char *const only[] = {"convergence"};

static const struct dea_convergence_row *row_of(const struct dea_convergence *c, const char *key,
                                                double voltage_V)
{
  for (size_t i = 0; i < c->row_count; i++) {
    if (c->rows[i].column == dea_point_column_find(key) && c->rows[i].voltage_V == voltage_V) {
      return &c->rows[i];
    }
  }
  return NULL;
}

TEST(test_meshes_are_judged)
{
  struct dea_convergence *c;
  struct dea_text verdict = {.ctx = ctx};
  set_up_meshes("{refinement: [1, 2, 3, 4], voltage: [4 kV, 6 kV, 8 kV]}");
  assert_int_equal(dea_study_run(ctx, &fake, only, 1, result), DEA_E_NOT_CONVERGED);
  assert_int_equal(result->curve_count, 0); // only that study
  assert_int_equal(result->variant_count, 4);
  assert_false(result->variants[2].curve.complete); // the third mesh fails, the fourth is tried
  assert_int_equal(result->variants[3].curve.count, 2);
  assert_int_equal(dea_convergence_create(ctx, result, "fake", &c), DEA_OK);
  const struct dea_convergence_row *tip = row_of(c, "fibre_tip_z_m", 6e3);
  assert_close(tip->order, 1, 1e-6, 0);
  assert_close(tip->extrapolated, -36e-6, 1e-8, 0);
  assert_close(tip->errors[1], 0.0375, 1e-6, 0);
  assert_int_equal(dea_convergence_enough(c, 6e3), 2); // 0.019 at the third
  assert_int_equal(row_of(c, "centre_z_m", 4e3)->kind, DEA_ORDER_NOT_MONOTONE);
  assert_int_equal(row_of(c, "fibre_tip_z_m", 8e3)->kind, DEA_ORDER_TOO_FEW);
  assert_int_equal(dea_convergence_enough(c, 8e3), 4);
  assert_null(row_of(c, "force_N", 6e3));
  dea_convergence_verdict(c, &verdict);
  assert_non_null(strstr(dea_text_get(&verdict), "6 kV: refinement 3 is enough for 2 %"));
  assert_non_null(strstr(dea_text_get(&verdict), "8 kV: no mesh is shown"));
  assert_non_null(strstr(dea_text_get(&verdict), "fewer than three meshes"));
  dea_text_free(&verdict);
  dea_convergence_destroy(ctx, c);
  tear_down_result();
}

/* What is written comes back to the bit, and says the same. */
TEST(test_is_kept)
{
  struct dea_run *run;
  char *text, *again;
  set_up_meshes("{voltage: [6 kV], tolerance: 0.03}"); // three meshes by default
  assert_int_equal(dea_study_run(ctx, &fake, only, 1, result), DEA_OK);
  assert_int_equal(dea_run_folder_write(ctx, result, in_folder("run"), NULL), DEA_OK);
  assert_true(there("run/fake_convergence.csv") && there("run/fake_convergence_errors.csv"));
  assert_true(size_of("run/figures/convergence.svg") > 1000);
  assert_int_equal(dea_run_read(ctx, in_folder("run"), &run), DEA_OK);
  assert_int_equal(run->result->variant_count, 3);
  for (size_t i = 0; i < 3; i++) {
    const struct dea_variant *a = &result->variants[i], *b = &run->result->variants[i];
    assert_string_equal(a->name, b->name);
    assert_true(dea_variant_is(b, "fake", "convergence"));
    assert_close(a->refinement, 1 + 0.5 * (double)i, 1e-12, 0);
    assert_close(b->refinement, a->refinement, 0, 0);
    assert_memory_equal(&a->size, &b->size, sizeof a->size);
    for (int k = 0; k < DEA_LOAD_POINT_COLUMNS; k++) {
      double wanted = dea_point_get(a->curve.points, k);
      assert_true(isnan(wanted) ? isnan(dea_point_get(b->curve.points, k))
                                : dea_point_get(b->curve.points, k) == wanted);
    }
    assert_int_equal(b->profile.count, 2);
    assert_memory_equal(a->profile.columns, b->profile.columns, 14 * sizeof(double));
    assert_close(b->profile.voltage_V, 6e3, 0, 0);
  }
  assert_int_equal(dea_summary_text(ctx, result, &text), DEA_OK);
  assert_non_null(strstr(text,
                         "\"verdict\": \"6 kV: no mesh is shown to be within 3 %, refinement 2 "
                         "has an estimated error of 3.7 %"));
  assert_non_null(strstr(text, "\"quantity\": \"fibre_tip_z_m\""));
  assert_non_null(strstr(text, "\"unknowns\": 9600"));
  assert_int_equal(dea_summary_text(ctx, run->result, &again), DEA_OK);
  const char *a = strstr(text, "\"convergence\""), *b = strstr(again, "\"convergence\"");
  assert_memory_equal(a, b, (size_t)(strstr(a, "more_models") - a));
  dea_free(ctx, text);
  dea_free(ctx, again);
  dea_run_destroy(ctx, run);
  dea_run_folder_clear(ctx, in_folder("run"));
  assert_false(there("run/fake_convergence.csv") || there("run/fake_convergence_errors.csv"));
  assert_false(there("run/figures/convergence.svg"));
  tear_down_result();
}

TEST(test_only_where_asked)
{
  static const char *const wrong[] = {"convergense"}, *const force[] = {"force"};
  set_up_meshes("null");
  assert_int_equal(dea_study_run(ctx, &fake, NULL, 0, result), DEA_OK);
  assert_int_equal(result->variant_count, 0);
  assert_int_equal(dea_study_check(ctx, wrong, 1, design), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_context_message(ctx), "did you mean 'convergence'?"));
  assert_int_equal(dea_study_check(ctx, force, 1, design), DEA_E_DESIGN);
  assert_non_null(strstr(dea_context_message(ctx), "compute.force.depth"));
  tear_down_result();
  set_up_meshes("{}"); // the section alone asks for it, at quarters of 8 kV
  assert_int_equal(dea_study_run(ctx, &fake, NULL, 0, result), DEA_OK);
  assert_int_equal(result->variant_count, 3);
  assert_close(result->variants[0].curve.points[1].voltage_V, 4e3, 1e-12, 0);
  tear_down_result();
  const struct dea_override falling = {"compute.convergence.refinement", "[2, 1]"};
  assert_int_equal(
      dea_design_read_memory(ctx, "t.yaml", GOOD_DESIGN, strlen(GOOD_DESIGN), &falling, 1, &design),
      DEA_E_DESIGN);
  assert_non_null(find_error(ctx, "finer than the one before"));
  dea_finding_clear(ctx);
}

/* ---- failing memory ---- */

static void judge_once(struct dea_context *failing)
{
  struct dea_result *mine = NULL;
  struct dea_convergence *c = NULL;
  char *text = NULL;
  dea_status status = dea_result_create(failing, design, device, &mine);
  if (status == DEA_OK) {
    status = dea_study_run(failing, &fake, only, 1, mine);
  }
  if (status == DEA_OK) {
    status = dea_convergence_create(failing, mine, "fake", &c);
  }
  if (status == DEA_OK) {
    assert_true(c->row_count > 0);
    status = dea_summary_text(failing, mine, &text);
  }
  failing_check(failing, status);
  dea_free(failing, text);
  dea_convergence_destroy(failing, c);
  dea_result_destroy(failing, mine);
}

TEST(test_failing_memory)
{
  set_up_meshes("{refinement: [1, 2], voltage: [6 kV]}");
  assert_true(failing_each(judge_once) > 10);
  tear_down_result();
}

TESTS(set_up, tear_down)
