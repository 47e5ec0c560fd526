/* result: growth, names, provenance, failing allocations, and the comparison of curves. */
#include "base/version.h"
#include "failing_allocator.h"
#include "fake_result.h"
#include "result/compare.h"
#include "result/trust.h"
#include "testing.h"

#include <string.h>

#include "context_fixture.h" // after: its context shadows no name of the headers above

static struct dea_result *result; // of each test, which may add to it

static int before(void **state)
{
  return dea_result_create(ctx, NULL, NULL, &result) == DEA_OK ? 0 : -1;
}

static int after(void **state)
{
  dea_result_destroy(ctx, result);
  return 0;
}

/* A number that is off by a hair on either side of where its flag begins. */
TEST(test_flags_begin_where_they_say)
{
  static const struct {
    const char *key;
    double without, with;
    enum dea_flag flag;
    bool trusted, safe;
  } cases[] = {
      {"min_tension_N_per_m", 0, -0.01, DEA_FLAG_SLACK, false, true},
      {"compression_ratio", 0.99, 1.01, DEA_FLAG_SLACK, false, true},
      {"locking_share", 0.79, 0.81, DEA_FLAG_LOCKING, false, true},
      {"range_share", 1, 1.01, DEA_FLAG_RANGE, false, true},
      {"breakdown_margin", 0, -0.01, DEA_FLAG_BREAKDOWN, true, false},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    struct dea_load_point p = dea_load_point_empty();
    dea_point_set(&p, dea_point_column_find(cases[i].key), cases[i].without);
    assert_int_equal(dea_load_point_flags(&p), 0);
    dea_point_set(&p, dea_point_column_find(cases[i].key), cases[i].with);
    assert_int_equal(dea_load_point_flags(&p), 1u << cases[i].flag);
    assert_int_equal(dea_load_point_trusted(&p), cases[i].trusted);
    assert_int_equal(dea_load_point_safe(&p), cases[i].safe);
  }
  struct dea_load_point corner = dea_load_point_empty(); // slack, but too small to wrinkle
  corner.min_tension_N_per_m = -3;
  corner.compression_ratio = 0.5;
  assert_true(dea_load_point_trusted(&corner));
}

TEST(test_flags_are_read_as_they_are_written)
{
  char words[DEA_FLAGS_SIZE];
  for (unsigned flags = 0; flags < 1u << DEA_FLAG_COUNT; flags++) {
    assert_int_equal(dea_flags_of_text(dea_flags_text(flags, words)), flags);
  }
  assert_string_equal(dea_flags_text(1u << DEA_FLAG_SLACK | 1u << DEA_FLAG_BREAKDOWN, words),
                      "slack breakdown");
  assert_int_equal(dea_flags_of_text("slackness"), 0);
}

/* Up and down again: what is doubtful on the way down ends the prediction too. */
TEST(test_trust_ends_at_the_lowest_doubt)
{
  struct dea_load_point points[7];
  for (int i = 0; i < 7; i++) {
    points[i] = dea_load_point_empty();
    points[i].voltage_V = i < 4 ? 1e3 * (i + 1) : 1e3 * (7 - i);           // 1 2 3 4 3 2 1 kV
    points[i].breakdown_margin = 0.55 - 0.15 * 1e-3 * points[i].voltage_V; // -0.05 at 4 kV
  }
  points[4].own_flags = 1u << DEA_FLAG_STATES; // 3 kV, on the way down
  const struct dea_curve curve = {.points = points, .count = 7};
  struct dea_trust trust = dea_curve_trust(&curve);
  assert_true(trust.trusted_V == 2e3 && trust.safe_V == 3e3 && trust.good_V == 2e3);
  assert_true(trust.doubt_V == 3e3 && trust.danger_V == 4e3);
  struct dea_text text = {.ctx = ctx};
  dea_trust_text(&trust, &text);
  assert_non_null(
      strstr(dea_text_get(&text), "valid and below breakdown up to 2 kV; at 3 kV one of"));
  assert_null(strstr(dea_text_get(&text), "tension"));
  dea_text_free(&text);
  points[1].min_tension_N_per_m = -1; // 2 kV: a corner; 3 kV: with the doubt, which says enough
  points[1].compression_ratio = 0.1;
  points[2].min_tension_N_per_m = -3;
  points[2].compression_ratio = 2;
  trust = dea_curve_trust(&curve);
  assert_true(trust.slack_V == 2e3 && trust.trusted_V == 2e3);
  dea_trust_text(&trust, &text);
  assert_non_null(strstr(dea_text_get(&text), "; from 2 kV on a part of the film has no tension"));
  dea_text_free(&text);
}

TEST(test_names_are_checked)
{
  struct dea_curve *curve;
  char name[DEA_NAME_SIZE + 1];
  memset(name, 'x', DEA_NAME_SIZE);
  name[DEA_NAME_SIZE] = '\0';
  assert_int_equal(dea_result_add_curve(ctx, result, name, "sweep", &curve), DEA_E_ARGUMENT);
  assert_int_equal(dea_result_add_curve(ctx, result, "a/b", "sweep", &curve), DEA_E_ARGUMENT);
  assert_int_equal(dea_result_add_curve(ctx, result, "", "sweep", &curve), DEA_E_ARGUMENT);
  assert_int_equal(dea_result_add_curve(ctx, result, "lumped", "sweep", &curve), DEA_OK);
  assert_int_equal(dea_result_add_curve(ctx, result, "lumped", "sweep", &curve), DEA_E_ARGUMENT);
  assert_null(curve);
  assert_int_equal(result->curve_count, 1);
}

TEST(test_sha256_of_a_known_text)
{
  char hex[65];
  dea_sha256_hex("abc", 3, hex); // FIPS 180-4, first example
  assert_string_equal(hex, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(test_provenance_says_what_ran)
{
  struct dea_provenance p = {.wall_s = 0.0};
  const struct dea_override o[] = {{"a.b", "1 mm"}, {"c", "2"}};
  assert_int_equal(dea_provenance_fill(ctx, "abc", 3, o, 2, "dea run x", &p), DEA_OK);
  assert_string_equal(p.program, "dea " DEA_VERSION);
  assert_string_equal(p.input, "abc");
  assert_string_equal(p.overrides, "a.b=1 mm\nc=2\n");
  assert_string_equal(p.command, "dea run x");
  assert_int_equal(strlen(p.started), strlen("2026-01-01T00:00:00Z"));
  assert_int_equal(p.started[10], 'T');
  assert_non_null(strstr(p.libraries, "libyaml 0."));
  assert_non_null(strstr(p.libraries, "HDF5 1."));
  assert_int_equal(strncmp(p.input_sha256, "ba7816bf", 8), 0);
  // A second time: what was there is freed (the sanitizer sees a leak).
  assert_int_equal(dea_provenance_fill(ctx, "", 0, NULL, 0, NULL, &p), DEA_OK);
  assert_null(p.overrides);
  dea_free(ctx, p.input);
}

static void make_result(struct dea_context *context)
{
  struct dea_design design = fake_design();
  struct dea_result *made = NULL;
  dea_status status = fake_result(context, &design, 1.0, &made);
  failing_check(context, status);
  dea_result_destroy(context, made);
}

TEST(test_every_allocation_may_fail)
{
  assert_true(failing_each(make_result) > 20);
}

// Comparison -------------------------------------------------------------------------------------

/* Curve of a result with stretch = 1 + (v/v0)^2 and z = 1e-6 v at `count` voltages up to v_max. */
static void parabola(const char *model, size_t count, double v_max, double shift)
{
  struct dea_curve *curve;
  assert_int_equal(dea_result_add_curve(ctx, result, model, "sweep", &curve), DEA_OK);
  for (size_t i = 0; i < count; i++) {
    struct dea_load_point p = dea_load_point_empty();
    p.voltage_V = v_max * (double)i / (double)(count - 1);
    p.electrode_stretch = 1.0 + pow(p.voltage_V / 1e4, 2.0) + shift;
    p.centre_z_m = 1e-6 * p.voltage_V;
    assert_int_equal(dea_curve_add_point(ctx, curve, &p), DEA_OK);
  }
}

TEST(test_compare_finds_a_known_offset)
{
  struct dea_comparison c;
  struct dea_arena memory = {.ctx = ctx};
  parabola("a", 11, 5000.0, 0.01);
  parabola("b", 11, 5000.0, 0.0);
  const struct dea_curve *a = &result->curves[0], *b = &result->curves[1];
  assert_int_equal(dea_compare_curves(&memory, a, b, NULL, NULL, 0, &c), DEA_OK);
  assert_int_equal(c.misfit_count, 2);
  const struct dea_misfit *m = &c.misfits[0];
  assert_int_equal(m->column, dea_point_column_find("electrode_stretch"));
  assert_int_equal(m->count, 11);
  assert_close(m->bias, 0.01, 1e-12, 0);
  assert_close(m->rms, 0.01, 1e-12, 0);
  assert_close(m->largest, 0.01, 1e-12, 0);
  assert_close(m->range, 0.25, 1e-12, 0);
  assert_close(m->relative_largest, 0.04, 1e-12, 0);
  assert_close(c.misfits[1].largest, 0.0, 0, 0); // z is the same
  dea_arena_free(&memory);
}

TEST(test_compare_interpolates_between_voltages)
{
  struct dea_comparison c;
  struct dea_arena memory = {.ctx = ctx};
  parabola("a", 101, 5000.0, 0.0);
  parabola("b", 8, 7000.0, 0.0); // 0, 1, ..., 7 kV: six in common
  const struct dea_curve *a = &result->curves[0], *b = &result->curves[1];
  assert_int_equal(dea_compare_curves(&memory, a, b, NULL, NULL, 0, &c), DEA_OK);
  assert_int_equal(c.misfits[0].count, 6);
  assert_close(c.misfits[0].relative_largest, 0.0, 0, 1e-12);
  dea_arena_free(&memory);
  // The other way round the same six voltages are used, with the sign turned.
  assert_int_equal(dea_compare_curves(&memory, b, a, NULL, NULL, 0, &c), DEA_OK);
  assert_int_equal(c.misfits[0].count, 6);
  dea_arena_free(&memory);
}

TEST(test_compare_up_and_down)
{
  struct dea_comparison c;
  struct dea_arena memory = {.ctx = ctx};
  parabola("a", 11, 5000.0, 0.0);
  parabola("b", 6, 5000.0, 0.0);
  struct dea_curve *a = &result->curves[0];
  for (size_t i = 0; i < 10; i++) { // back down, with another stretch there
    struct dea_load_point p = a->points[9 - i];
    p.electrode_stretch += 0.1;
    assert_int_equal(dea_curve_add_point(ctx, a, &p), DEA_OK);
  }
  assert_int_equal(dea_compare_curves(&memory, a, &result->curves[1], NULL, NULL, 0, &c), DEA_OK);
  assert_true(c.part_only);
  assert_close(c.misfits[0].largest, 0.0, 0, 1e-12);
  dea_arena_free(&memory);
  assert_int_equal(dea_compare_curves(&memory, a, a, NULL, NULL, 0, &c), DEA_OK); // point by point
  assert_false(c.part_only);
  assert_int_equal(c.misfits[0].count, 21);
  dea_arena_free(&memory);
}

TEST(test_interpolation_adds_no_extremes)
{
  const double x[] = {0.0, 1.0, 2.0, 3.0, 4.0}, y[] = {0.0, 0.0, 0.1, 5.0, 5.0};
  double before = 0.0;
  for (int i = 0; i <= 400; i++) {
    double value = dea_interpolate(x, y, 5, 0.01 * i);
    assert_true(value >= before - 1e-14 && value <= 5.0 + 1e-14);
    before = value;
  }
  assert_close(dea_interpolate(x, y, 5, 2.0), 0.1, 0, 0);
  assert_true(isnan(dea_interpolate(x, y, 5, 4.01)));
  assert_true(isnan(dea_interpolate(x, y, 5, -0.01)));
  assert_close(dea_interpolate(x, y, 1, 0.0), 0.0, 0, 0);
  const double line[] = {1.0, 3.0, 5.0, 7.0, 9.0};
  assert_close(dea_interpolate(x, line, 5, 0.3), 1.6, 1e-14, 0);
  assert_close(dea_interpolate(x, line, 2, 0.3), 1.6, 1e-14, 0);
}

static void compare_once(struct dea_context *context)
{
  static const double v[] = {0.0, 1000.0, 2000.0};
  struct dea_load_point points[3];
  for (int i = 0; i < 3; i++) {
    points[i] = dea_load_point_empty();
    points[i].voltage_V = v[i];
    points[i].force_N = 0.1 * i;
  }
  struct dea_curve a = {.model = "a", .points = points, .count = 3}, b = a;
  b.count = 2;
  struct dea_comparison c;
  struct dea_arena memory = {.ctx = context};
  failing_check(context, dea_compare_curves(&memory, &a, &b, NULL, NULL, 0, &c));
  dea_arena_free(&memory);
}

TEST(test_compare_with_failing_allocations)
{
  assert_true(failing_each(compare_once) > 6);
}

TESTS_EACH(context_set_up, context_tear_down, before, after)
