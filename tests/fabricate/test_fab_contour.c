/* The geometry of parts: measures, contours at a distance, and what cannot be cut. */
#include "design_text.h"
#include "fabricate/part.h"

static const double pi = 3.14159265358979323846;

TEST(test_contours)
{
  // a half disc of radius 1, and a square with a rounded corner the other way
  const struct dea_vertex half[] = {{.x_m = 1, .bulge = 1}, {.x_m = -1}};
  const struct dea_contour disc = {half, 2, true};
  assert_close(dea_contour_area_m2(&disc), 0.5 * pi, 1e-14, 0);
  assert_close(dea_contour_length_m(&disc), pi + 2, 1e-14, 0);
  assert_true(dea_contour_inside(&disc, 0.5, 0.5) && !dea_contour_inside(&disc, 0.5, -0.01));
  assert_true(!dea_contour_inside(&disc, 0.8, 0.8));
  const double q = tan(pi / 8);
  const struct dea_vertex notch[] = {
      {.x_m = 1}, {.x_m = 2}, {.x_m = 2, .y_m = 2}, {.y_m = 2}, {.y_m = 1, .bulge = -q}};
  const struct dea_contour square = {notch, 5, true};
  assert_close(dea_contour_area_m2(&square), 4 - 0.25 * pi, 1e-14, 0);
  assert_true(!dea_contour_inside(&square, 0.5, 0.5) && dea_contour_inside(&square, 0.8, 0.8));
  struct dea_vertex out[10];
  size_t count, at;
  // outwards: Steiner's formula but for the corners at the notch, which close in part
  assert_true(dea_contour_offset(&square, 0.1, out, &count, &at));
  const struct dea_contour larger = {out, count, true};
  assert_true(dea_contour_area_m2(&larger) > dea_contour_area_m2(&square));
  // an arc of radius 1 cannot move 1.5 towards its centre
  assert_false(dea_contour_offset(&square, 1.5, out, &count, &at));
  struct dea_gap gap = dea_contour_gap(&square, NULL, 1.5);
  assert_true(gap.width_m <= 1 + 1e-12); // between the notch and the far sides
}

/* A disc of 10 mm radius with two holes. */
static void expect_holes(double x0, double r0, double x1, double r1, const char *message)
{
  static const struct dea_location here = {"t.yaml", 3, 4};
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  struct dea_part part = {.ctx = ctx, .name = "plate"};
  dea_part_circle(&part, DEA_LAYER_CUT_OUTER, 0, 0, 10e-3, here);
  dea_part_circle(&part, DEA_LAYER_CUT_INNER, x0, 0, r0, here);
  dea_part_circle(&part, DEA_LAYER_CUT_INNER, x1, 0, r1, here);
  assert_int_equal(dea_part_check(&part, 0.5e-3, 0.2e-3), DEA_OK);
  if (message != NULL) {
    const struct dea_finding *finding = find_error(ctx, message);
    if (finding == NULL) {
      print_findings(ctx);
      fail_msg("'%s' is not said", message);
    }
    assert_int_equal(finding->location.line, 3);
  } else {
    assert_int_equal(dea_finding_count(ctx, DEA_ERROR), 0);
  }
  dea_part_free(&part);
  dea_context_destroy(ctx);
}

TEST(test_holes)
{
  expect_holes(-5e-3, 2e-3, 5e-3, 2e-3, NULL);
  expect_holes(-1e-3, 2e-3, 1e-3, 2e-3, "parts overlap at (");
  expect_holes(0, 5e-3, 0, 2e-3, "a hole lies in another one");
  expect_holes(0, 2e-3, 13e-3, 2e-3, "a hole lies outside of the part");
  expect_holes(0, 2e-3, 9e-3, 2e-3, "parts overlap at (");
  expect_holes(0, 2e-3, 4.2e-3, 2e-3, "only 0.2 mm lie between");
  expect_holes(0, 2e-3, 7.7e-3, 2e-3, "only 0.3 mm lie between");
  expect_holes(0, 2e-3, 5e-3, 0.2e-3, "smaller than the minimum feature");
}

TESTS(NULL, NULL)
