/* identify: coupons against closed forms, and fits of materials whose answer is known. */
#include "context_fixture.h"
#include "identify/fit.h"
#include "material/branch.h"
#include "material/catalogue.h"
#include "testing.h"

#include <stdio.h>
#include <string.h>

static struct dea_material material_of(const char *law, double a, double b)
{
  return (struct dea_material){.law = dea_law_find(law), .param = {a, b}};
}

/* Nominal stresses of the neo-Hookean law: mu (l - l^-2), mu (l - l^-3), mu (l - l^-5). */
TEST(test_modes_of_a_coupon)
{
  const struct dea_material material = material_of("neo-hookean", 2e5, 0);
  const double powers[DEA_COUPON_MODES] = {-2, -3, -5}, stretch[3] = {0.7, 1.5, 3};
  for (int mode = 0; mode < DEA_COUPON_MODES; mode++) {
    struct dea_coupon coupon = {.mode = (enum dea_coupon_mode)mode, .rows = 3, .stretch = stretch};
    double stress[3];
    assert_int_equal(dea_coupon_stress(&material, &coupon, NULL, stress), DEA_OK);
    for (size_t i = 0; i < 3; i++) {
      assert_close(stress[i], 2e5 * (stretch[i] - pow(stretch[i], powers[mode])), 1e-12, 1e-6);
    }
  }
  struct dea_coupon one = {.rows = 1, .stretch = stretch};
  double stress[1];
  const struct dea_material hgo = material_of("holzapfel-gasser-ogden", 1e5, 1e5);
  assert_int_equal(dea_coupon_stress(&hgo, &one, NULL, stress), DEA_E_ARGUMENT);
}

/* A branch that is stretched at once and held: A relaxes from 1 to C^-1, so that its stress is
 * G e^(-t/tau) (l - l^-2), the neo-Hookean one of its spring. */
TEST(test_relaxation_after_a_jump)
{
  struct dea_material material = material_of("neo-hookean", 1e4, 0);
  material.branch_count = 1;
  material.branches[0] = (struct dea_branch){3e4, 20};
  const double time_s[4] = {1, 10, 40, 100}, stretch[4] = {2, 2, 2, 2};
  struct dea_arena arena = {.ctx = ctx};
  struct dea_coupon coupon = {.mode = DEA_UNIAXIAL, .rows = 4, .stretch = stretch};
  struct dea_coupon_shares shares;
  double stress[4];
  assert_int_equal(dea_coupon_shares_build(&arena, &coupon, 1, &shares), DEA_OK);
  assert_int_equal(dea_coupon_follow(&arena, time_s, 1e-9, &coupon), DEA_OK);
  assert_int_equal(dea_coupon_stress(&material, &coupon, &shares, stress), DEA_OK);
  for (size_t i = 0; i < 4; i++) {
    assert_close(stress[i], (1e4 + 3e4 * exp(-time_s[i] / 20)) * (2 - 0.25), 1e-8, 0);
  }
  dea_arena_free(&arena);
}

/* The same film under equal stretches as the models have it (material/branch.c). */
TEST(test_branches_against_the_film)
{
  struct dea_material material = material_of("neo-hookean", 1, 0);
  material.branch_count = 1;
  material.branches[0] = (struct dea_branch){3e4, 2};
  const double time_s[1] = {3}, stretch[1] = {2.5};
  struct dea_arena arena = {.ctx = ctx};
  struct dea_coupon coupon = {.mode = DEA_EQUIBIAXIAL, .rows = 1, .stretch = stretch};
  struct dea_equal_tensor A = {1, 1};
  struct dea_coupon_shares shares;
  double stress[1], t = 0, l = 1;
  assert_int_equal(dea_coupon_shares_build(&arena, &coupon, 1, &shares), DEA_OK);
  assert_int_equal(dea_coupon_follow(&arena, time_s, 0, &coupon), DEA_OK);
  assert_int_equal(dea_coupon_stress(&material, &coupon, &shares, stress), DEA_OK);
  for (size_t n = 1; n < coupon.node_count; n++) {
    dea_equal_update(&material, &A, coupon.node_s[n] - t, l, coupon.node_stretch[n], &A);
    t = coupon.node_s[n];
    l = coupon.node_stretch[n];
  }
  const struct dea_equal_tensor B = {3e4 * A.p, 3e4 * A.z};
  double W, s, k;
  dea_equal_stress(&B, l, &W, &s, &k);
  assert_close(t, 3, 1e-12, 0);
  assert_close(stress[0], s + (l - pow(l, -5)), 1e-9, 0);
  dea_arena_free(&arena);
}

TEST(test_stability)
{
  const struct dea_material stable = material_of("mooney-rivlin", 1e5, 1e4);
  const struct dea_material falls = material_of("mooney-rivlin", 2e5, -1e5);
  for (double l = 1; l < 4; l += 0.1) {
    assert_true(dea_coupon_is_stable(&stable, l, l));
  }
  // equibiaxial tension of a negative c01: W2 takes over where l^2 > c10/|c01|
  assert_true(dea_coupon_is_stable(&falls, 1, 1));
  assert_false(dea_coupon_is_stable(&falls, 2, 2));
}

/* ---- whole fits ---- */

struct trial {
  struct dea_fit_file file;
  struct dea_fit_series series[8];
  struct dea_arena memory;
};

static struct trial trial;

static int trial_set_up(void **state)
{
  memset(&trial, 0, sizeof trial);
  trial.memory.ctx = ctx;
  snprintf(trial.file.branches.text, sizeof trial.file.branches.text, "none");
  return 0;
}

static int trial_tear_down(void **state)
{
  dea_arena_free(&trial.memory);
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  return 0;
}

static void add_law(const char *name)
{
  struct dea_label *label = &trial.file.laws[trial.file.law_count++];
  snprintf(label->text, sizeof label->text, "%s", name);
}

/* A test with room for rows, which the caller fills. */
static struct dea_fit_series *add_series(enum dea_fit_kind kind, size_t rows, double std_Pa)
{
  struct dea_fit_test *test = &trial.file.tests[trial.file.test_count];
  struct dea_fit_series *series = &trial.series[trial.file.test_count++];
  double *values = dea_arena_alloc(&trial.memory, 3 * rows, sizeof *values);
  test->kind.value = (int)kind;
  snprintf(test->name.text, sizeof test->name.text, "test %zu", trial.file.test_count);
  *series = (struct dea_fit_series){.test = test, .rows = rows, .file = "none"};
  series->stretch = values;
  series->stress_Pa = values + rows;
  series->std_Pa = values + 2 * rows;
  series->coupon.mode = kind < DEA_FIT_RELAXATION ? (enum dea_coupon_mode)kind : DEA_UNIAXIAL;
  series->coupon.rows = rows;
  series->coupon.stretch = series->stretch;
  for (size_t i = 0; i < rows; i++) {
    series->std_Pa[i] = std_Pa;
  }
  return series;
}

/* A strip held at a stretch; the caller fills times and stresses. */
static struct dea_fit_series *add_relaxation(size_t rows, double stretch, double std_Pa)
{
  struct dea_fit_series *series = add_series(DEA_FIT_RELAXATION, rows, std_Pa);
  series->time_s = dea_arena_alloc(&trial.memory, rows, sizeof(double));
  for (size_t i = 0; i < rows; i++) {
    series->stretch[i] = stretch;
  }
  return series;
}

static struct dea_fit *run_trial(void)
{
  static struct dea_fit fit;
  if (dea_fit_run(ctx, &trial.file, trial.series, trial.file.test_count, false, &fit) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  return &fit;
}

static void fill(struct dea_fit_series *series, const struct dea_material *material, double to)
{
  for (size_t i = 0; i < series->rows; i++) {
    series->stretch[i] = 1 + (to - 1) * (double)(i + 1) / (double)series->rows;
  }
  assert_int_equal(dea_coupon_stress(material, &series->coupon, NULL, series->stress_Pa), DEA_OK);
}

/* A public library's own test: F = (l - l^-2 + (l - 1)^5/10) A as uniaxial tension, every other
 * point as planar tension of a section A/(8/7), at half the displacement as biaxial one of A/(4/5);
 * third-order deformation, equal weights. Its answer, in MPa, to the four digits that the page of
 * the project asks for. */
TEST(test_three_tests)
{
  static const double known[5] = {.50430357, -.01413309, .0141219, -.01641752, .00492179};
  static const double sections[3] = {1, 8.0 / 7, 4.0 / 5};
  add_law("third-order");
  for (int t = 0; t < 3; t++) {
    const size_t every = t == 0 ? 1 : 2;
    struct dea_fit_series *series = add_series((enum dea_fit_kind)t, 100 / every - 1, NAN);
    for (size_t i = 0; i < series->rows; i++) {
      const double u = 200.0 * (double)(every * (i + 1)) / 99, l = 1 + u / 100;
      series->stretch[i] = t == 2 ? 1 + 0.5 * u / 100 : l;
      series->stress_Pa[i] = 1e6 * sections[t] * (l - 1 / (l * l) + pow(l - 1, 5) / 10);
    }
  }
  struct dea_fit *fit = run_trial();
  for (size_t j = 0; j < 5; j++) {
    assert_close(fit->core.values[j].value * 1e-6, known[j], 1e-4, 0);
  }
  dea_fit_free(fit);
}

/* Every law from its own curves, without a hint where to begin. */
TEST(test_laws_find_themselves)
{
  static const struct {
    const char *name, *law;
    double p[DEA_LAW_PARAM_MAX];
  } laws[] = {
      {"neo-hookean", "neo-hookean", {4e5}},       {"mooney-rivlin", "mooney-rivlin", {1.6e5, 2e4}},
      {"yeoh", "yeoh", {178.4e3, -6e3, 4.2e3}},    {"gent", "gent", {4e4, 40}},
      {"arruda-boyce", "arruda-boyce", {3e5, 3}},  {"ogden-1", "ogden", {4e4, 2.6}},
      {"ogden-2", "ogden", {4e5, 1.3, -1e4, -2.5}}};
  for (size_t k = 0; k < sizeof laws / sizeof laws[0]; k++) {
    struct dea_material material = {.law = dea_law_find(laws[k].law)};
    memcpy(material.param, laws[k].p, sizeof material.param);
    trial_set_up(NULL);
    add_law(laws[k].name);
    fill(add_series(DEA_FIT_UNIAXIAL, 30, 100), &material, 3);
    fill(add_series(DEA_FIT_EQUIBIAXIAL, 30, 100), &material, 2);
    struct dea_fit *fit = run_trial();
    double p[DEA_LAW_PARAM_MAX];
    memcpy(p, material.param, sizeof p);
    if (strcmp(laws[k].name, "ogden-2") == 0) { // its terms in the order that the grid has
      p[0] = laws[k].p[2];
      p[1] = laws[k].p[3];
      p[2] = laws[k].p[0];
      p[3] = laws[k].p[1];
    }
    for (size_t j = 0; j < fit->model.law_count; j++) {
      if (!(fabs(fit->core.values[j].value - p[j]) <= 1e-5 * fabs(p[j]))) {
        fail_msg("%s, %s: %.10g, wanted %.10g", laws[k].name, fit->model.params[j].name,
                 fit->core.values[j].value, p[j]);
      }
    }
    assert_true(fit->curves[0].rms_Pa < 1);
    dea_fit_free(fit);
    trial_tear_down(NULL);
  }
  trial_set_up(NULL);
}

/* Two branches from relaxations at two stretches; their number is found. */
TEST(test_branches_find_themselves)
{
  struct dea_material material = material_of("neo-hookean", 2e4, 0);
  uint64_t seed = 3;
  material.branch_count = 2;
  material.branches[0] = (struct dea_branch){3e4, 3};
  material.branches[1] = (struct dea_branch){1e4, 80};
  add_law("neo-hookean");
  snprintf(trial.file.branches.text, sizeof trial.file.branches.text, "auto");
  for (int t = 0; t < 2; t++) {
    struct dea_fit_series *series = add_relaxation(40, 2 + t, NAN);
    for (size_t i = 0; i < series->rows; i++) {
      series->time_s[i] = 4 + pow(10, -0.5 + 3.5 * (double)i / 39);
    }
    assert_int_equal(dea_coupon_follow(&trial.memory, series->time_s, 4, &series->coupon), DEA_OK);
    struct dea_coupon_shares shares;
    assert_int_equal(dea_coupon_shares_build(&trial.memory, &series->coupon, 2, &shares), DEA_OK);
    assert_int_equal(dea_coupon_stress(&material, &series->coupon, &shares, series->stress_Pa),
                     DEA_OK);
    for (size_t i = 0; i < series->rows; i++) { // noise of 0.1 %
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      series->std_Pa[i] = 1e-3 * series->stress_Pa[i];
      series->stress_Pa[i] +=
          3.46 * series->std_Pa[i] * ((double)(seed >> 11) / 9007199254740992.0 - 0.5);
    }
  }
  struct dea_fit *fit = run_trial();
  assert_int_equal(fit->model.branch_count, 2);
  const double known[5] = {2e4, 3e4, 3, 1e4, 80};
  for (size_t j = 0; j < 5; j++) {
    assert_true(fit->core.values[j].std > 0 && fit->core.values[j].std < 0.05 * known[j]);
    assert_close(fit->core.values[j].value, known[j], 0, 4 * fit->core.values[j].std);
  }
  dea_fit_free(fit);
}

/* Relaxations at three temperatures of a branch whose time goes with 10^(-c1 dT/(c2 + dT)): that
 * law is found with its constants, from the same start with a colder test that is only compared. */
TEST(test_shift_with_temperature)
{
  const double known[5] = {2e4, 3e4, 3, 2.5, 60}, off_K[4] = {-20, 0, 40, -30};
  double start = NAN;
  add_law("neo-hookean");
  snprintf(trial.file.branches.text, sizeof trial.file.branches.text, "1");
  trial.file.reference_K = (struct dea_quantity){.si = 293.15, .origin = DEA_GIVEN};
  for (int t = 0; t < 4; t++) {
    const double time = known[2] * pow(10, -known[3] * off_K[t] / (known[4] + off_K[t]));
    struct dea_fit_series *series = add_relaxation(40, 2, 30);
    trial.file.tests[t].temperature_K =
        (struct dea_quantity){.si = 293.15 + off_K[t], .origin = DEA_GIVEN};
    trial.file.tests[t].use.value = t == 3 ? DEA_FIT_CHECKED : DEA_FIT_USED;
    for (size_t i = 0; i < series->rows; i++) { // a jump: the spring's stress decays
      series->time_s[i] = pow(10, -1 + 4 * (double)i / 39);
      series->stress_Pa[i] = (known[0] + known[1] * exp(-series->time_s[i] / time)) * (2 - 0.25);
    }
    assert_int_equal(dea_coupon_follow(&trial.memory, series->time_s, 1e-9, &series->coupon),
                     DEA_OK);
    if (t < 2) {
      continue;
    }
    struct dea_fit *fit = run_trial();
    assert_int_equal(fit->model.count, 5);
    assert_string_equal(fit->model.params[4].name, "wlf c2");
    for (size_t j = 0; j < 5; j++) {
      assert_close(fit->core.values[j].value, known[j], 1e-5, 0);
      assert_true(fit->core.values[j].std > 0 && fit->core.values[j].std < 0.05 * known[j]);
    }
    assert_true(t == 2 || fit->model.params[2].start == start);
    start = fit->model.params[2].start;
    dea_fit_free(fit);
  }
}

/* One uniaxial test of small stretches holds c10 and c01 by their sum only, a biaxial one parts
 * them. */
TEST(test_what_cannot_be_told_apart)
{
  const struct dea_material material = material_of("mooney-rivlin", 1e5, 2e4);
  add_law("mooney-rivlin");
  fill(add_series(DEA_FIT_UNIAXIAL, 20, 500), &material, 1.003);
  struct dea_fit *fit = run_trial();
  assert_int_equal(fit->core.weak_count, 1);
  if (strstr(fit->core.weak[0], "c10 + 0.99") == NULL &&
      strstr(fit->core.weak[0], "c10 + 1 c01") == NULL) {
    fail_msg("said: %s", fit->core.weak[0]);
  }
  dea_fit_free(fit);
  trial_tear_down(NULL);
  trial_set_up(NULL);
  add_law("mooney-rivlin");
  fill(add_series(DEA_FIT_UNIAXIAL, 20, 500), &material, 1.3);
  fit = run_trial();
  assert_non_null(strstr(fit->core.next[0].what, "equibiaxial"));
  assert_true(fit->core.next[0].shrink < fit->core.next[fit->core.next_count - 1].shrink);
  dea_fit_free(fit);
}

/* Of several laws the one that the data come from foretells held-out tests best, and of a nested
 * pair the smaller is taken. */
TEST(test_laws_are_compared)
{
  const struct dea_material material = material_of("gent", 4e4, 20);
  add_law("neo-hookean");
  add_law("yeoh");
  add_law("gent");
  fill(add_series(DEA_FIT_UNIAXIAL, 20, 100), &material, 3);
  fill(add_series(DEA_FIT_PLANAR, 20, 100), &material, 2.5);
  fill(add_series(DEA_FIT_EQUIBIAXIAL, 20, 100), &material, 2.2);
  struct dea_fit *fit = run_trial();
  assert_string_equal(fit->model.law->name, "gent");
  assert_true(fit->candidates[2].held_out < 1e-3 && fit->candidates[0].held_out > 10);
  dea_fit_free(fit);
}

/* Uniaxial curves of what the catalogue has, with noise: a law ends with its modulus at rest above
 * 0 or says that it has none, Ogden's with two terms follows each to 0.7 % of the largest stress,
 * Gent's to 5 %. */
TEST(test_silicones)
{
  static const char *const laws[] = {"mooney-rivlin", "gent", "ogden-2"};
  const char **names;
  size_t count, curves = 0;
  uint64_t seed = 5;
  assert_int_equal(dea_catalogue_names(ctx, &names, &count), DEA_OK);
  const size_t every = nightly() ? 1 : 3, least = nightly() ? 30 : 8;
  for (size_t i = 0; i < count; i += every) {
    struct dea_catalogue_entry *entry;
    struct dea_material material, found;
    const struct dea_material_choice first = {0};
    assert_int_equal(dea_catalogue_read(ctx, names[i], (struct dea_location){0}, &entry), DEA_OK);
    assert_int_equal(dea_material_select(ctx, &entry->data, &first, &material), DEA_OK);
    dea_catalogue_destroy(ctx, entry); // the material is a copy
    for (size_t k = 0; k < 3 && material.law != NULL && !material.law->anisotropic; k++) {
      trial_set_up(NULL);
      add_law(laws[k]);
      struct dea_fit_series *series = add_series(DEA_FIT_UNIAXIAL, 30, NAN);
      fill(series, &material, material.stretch_max > 1 ? fmin(material.stretch_max, 4) : 3);
      for (size_t r = 0; r < series->rows; r++) { // of 0.2 % of the largest
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        series->stress_Pa[r] += 3.46 * 2e-3 * series->stress_Pa[series->rows - 1] *
                                ((double)(seed >> 11) / 9007199254740992.0 - 0.5);
      }
      struct dea_fit fit;
      const dea_status status = dea_fit_run(ctx, &trial.file, trial.series, 1, false, &fit);
      if (status != DEA_OK &&
          (k > 0 || strstr(dea_context_message(ctx), "the shear modulus at rest would") == NULL)) {
        fail_msg("%s by %s: %s", names[i], laws[k], dea_context_message(ctx));
      }
      if (status == DEA_OK) {
        dea_fit_model_material(&fit.model, fit.core.least_squares.p, NULL, &found);
        assert_true(found.law->shear_modulus(found.param) > 0);
        const double share = fit.curves[0].rms_Pa / series->stress_Pa[series->rows - 1];
        if (k > 0 && !(share < (k == 2 ? 7e-3 : 0.05))) {
          fail_msg("%s by %s: off by %.3g of the largest stress", names[i], laws[k], share);
        }
        curves++;
      }
      dea_fit_free(&fit);
      trial_tear_down(NULL);
    }
  }
  assert_true(curves > least);
  dea_free(ctx, names);
  trial_set_up(NULL);
}

TESTS_EACH(context_set_up, context_tear_down, trial_set_up, trial_tear_down)
