/* Contours of parts at a distance. */
#include "design_text.h"
#include "fabricate/part.h"

static void add_circle(struct dea_part *part, enum dea_layer layer, double x, double radius)
{
  static const struct dea_location here = {"t.yaml", 3, 4};
  const struct dea_vertex v[2] = {{x + radius, 0, 1, here}, {x - radius, 0, 1, here}};
  const struct dea_contour circle = {v, 2, true};
  dea_part_add(part, layer, &circle);
}

/* A disc of 10 mm radius with two holes. */
static void expect_holes(double x0, double r0, double x1, double r1, const char *message)
{
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  struct dea_arena memory = {.ctx = ctx};
  struct dea_part part = {.memory = &memory, .name = "plate"};
  add_circle(&part, DEA_LAYER_CUT_OUTER, 0, 10e-3);
  add_circle(&part, DEA_LAYER_CUT_INNER, x0, r0);
  add_circle(&part, DEA_LAYER_CUT_INNER, x1, r1);
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
  dea_arena_free(&memory);
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
