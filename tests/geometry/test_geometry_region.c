/* Regions of lines and arcs: measures, shapes, copies and what is wrong with contours. */
#include "failing_allocator.h"
#include "geometry/contour_pieces.h"
#include "geometry/shape.h"
#include "message_fixture.h"

static const double pi = 3.14159265358979323846;
static const struct dea_location here = {"t.yaml", 3, 4};

static struct dea_region empty(void)
{
  return (struct dea_region){.ctx = ctx};
}

static void add(struct dea_region *region, const struct dea_shape_type *type, const double *value)
{
  assert_int_equal(dea_region_add_shape(region, type, value, NULL, 0, here), DEA_OK);
}

/* Area, boundary, centroid and validity of one shape. */
static void expect(const struct dea_shape_type *type, const double *value, const double (*point)[2],
                   size_t points, double area, double boundary, double x, double y)
{
  struct dea_region region = empty();
  double centre[2];
  assert_int_equal(dea_region_add_shape(&region, type, value, point, points, here), DEA_OK);
  assert_close(dea_region_area_m2(&region), area, 1e-13, 0);
  assert_close(dea_region_boundary_m(&region), boundary, 1e-13, 0);
  dea_region_centroid_m(&region, centre);
  assert_close(centre[0], x, 1e-12, 1e-13);
  assert_close(centre[1], y, 1e-12, 1e-13);
  assert_int_equal(dea_region_check(ctx, &region, true), DEA_OK);
  // the same after a copy that is mirrored, rotated and moved far away
  const struct dea_motion motions[] = {dea_motion_mirror((double[2]){3, 1}, 0.7),
                                       dea_motion_rotation((double[2]){-2, 5}, 2.2),
                                       dea_motion_translation(40, -30)};
  const struct dea_motion none_moved = dea_motion_translation(0, 0);
  struct dea_region moved[4] = {empty(), empty(), empty(), empty()};
  dea_region_add_moved(&moved[0], &region, &none_moved);
  for (int k = 0; k < 3; k++) {
    dea_region_add_moved(&moved[k + 1], &moved[k], &motions[k]);
    double wanted[2];
    dea_motion_apply(&motions[k], centre, wanted);
    dea_region_centroid_m(&moved[k + 1], centre);
    assert_close(dea_region_area_m2(&moved[k + 1]), area, 1e-11, 0);
    assert_close(centre[0], wanted[0], 1e-11, 1e-12);
    assert_close(centre[1], wanted[1], 1e-11, 1e-12);
  }
  for (int k = 0; k < 4; k++) {
    dea_region_free(&moved[k]);
  }
  dea_region_free(&region);
}

TEST(test_shapes)
{
  const double none = NAN;
  expect(&dea_shape_circle, (double[]){1, 2, 3}, NULL, 0, 9 * pi, 6 * pi, 1, 2);
  expect(&dea_shape_circle, (double[]){none, none, 1}, NULL, 0, pi, 2 * pi, 0, 0);
  expect(&dea_shape_ring, (double[]){1, 2, 2, 3}, NULL, 0, 5 * pi, 10 * pi, 1, 2);
  // centroid of a sector of half angle a: 2 r sin a / (3 a)
  expect(&dea_shape_sector, (double[]){0, 0, none, 2, -0.6, 0.6}, NULL, 0, 2.4, 4 + 2.4,
         4 * sin(0.6) / 1.8, 0);
  expect(&dea_shape_sector, (double[]){0, 0, 1, 2, 0, 1.5 * pi}, NULL, 0, 2.25 * pi, 4.5 * pi + 2,
         -7.0 / (3 * 2.25 * pi), 7.0 / (3 * 2.25 * pi));
  expect(&dea_shape_rectangle, (double[]){1, 2, 3, 4}, NULL, 0, 12, 14, 1, 2);
  expect(&dea_shape_rounded_rectangle, (double[]){1, 2, 3, 4, 0.5}, NULL, 0, 12 - 0.25 * (4 - pi),
         10 + pi, 1, 2);
  expect(&dea_shape_rounded_rectangle, (double[]){1, 2, 4, 4, 2}, NULL, 0, 4 * pi, 4 * pi, 1, 2);
  expect(&dea_shape_stadium, (double[]){1, 2, 5, 2, 0.3}, NULL, 0, 6 + pi, 6 + 2 * pi, 1, 2);
  expect(&dea_shape_arc_strip, (double[]){0, 0, 3, 1, 0, pi}, NULL, 0, 3 * pi, 6 * pi + 2, 0,
         2 * (pow(3.5, 3) - pow(2.5, 3)) / (9 * pi));
  const double triangle[3][2] = {{0, 0}, {0, 3}, {6, 0}}; // clockwise
  expect(&dea_shape_polygon, NULL, triangle, 3, 9, 9 + sqrt(45), 2, 1);
  // a right angle: two legs of 3 and 2 that overlap in half a square, and a quarter disc
  const double angle[3][2] = {{-3, 0}, {0, 0}, {0, 2}};
  const double legs = 3 + 2 - 0.25 + pi / 16;
  struct dea_region strip = empty();
  assert_int_equal(dea_region_add_shape(&strip, &dea_shape_strip, (double[]){1}, angle, 3, here),
                   DEA_OK);
  assert_close(dea_region_area_m2(&strip), legs, 1e-13, 0);
  dea_region_free(&strip);
  // closed: Steiner outside, a smaller square inside
  const double square[5][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {0, 0}};
  expect(&dea_shape_strip, (double[]){1}, square, 5, 4 + 4 + 0.25 * pi - 1, 8 + pi + 4, 1, 1);
}

static void expect_fault(const struct dea_shape_type *type, const double *value,
                         const double (*point)[2], size_t points, const char *message)
{
  struct dea_region region = empty();
  dea_finding_clear(ctx);
  assert_message(dea_region_add_shape(&region, type, value, point, points, here), DEA_E_DESIGN,
                 message);
  size_t count;
  const struct dea_finding *finding = dea_finding_get(ctx, &count);
  assert_int_equal(count, 1);
  assert_int_equal(finding->location.line, 3);
  assert_int_equal(region.contour_count, 0);
  dea_region_free(&region);
}

TEST(test_shape_faults)
{
  expect_fault(&dea_shape_circle, (double[]){0, 0, -1}, NULL, 0,
               "radius of the circle must be a length above 0, not -1");
  expect_fault(&dea_shape_ring, (double[]){1e-3, 0, 2e-3, 2e-3}, NULL, 0,
               "the ring's inner radius is not below the outer one");
  expect_fault(&dea_shape_sector, (double[]){0, 0, 0, 1, 1, 0.5}, NULL, 0, "within a turn");
  expect_fault(&dea_shape_rounded_rectangle, (double[]){0, 0, 2, 4, 1.1}, NULL, 0,
               "corners' radius");
  const double bow[4][2] = {{0, 0}, {2e-3, 2e-3}, {2e-3, 0}, {0, 3e-3}};
  expect_fault(&dea_shape_polygon, NULL, bow, 4,
               "the contour crosses or touches itself at (1.2, 1.2) mm");
  const double flat[3][2] = {{0, 0}, {1e-3, 0}, {2e-3, 0}};
  expect_fault(&dea_shape_polygon, NULL, flat, 3, "a contour encloses no area");
  const double tie[4][2] = {{-2e-3, -1e-3}, {2e-3, 1e-3}, {2e-3, -1e-3}, {-2e-3, 1e-3}};
  expect_fault(&dea_shape_polygon, NULL, tie, 4,
               "the contour crosses or touches itself at (0, 0) mm");
  expect_fault(&dea_shape_polygon, NULL, flat, 2, "needs 3 points or more, not 2");
  const double spike[5][2] = {{0, 0}, {2e-3, 0}, {2e-3, 1e-3}, {2e-3, 0.5e-3}, {0, 1e-3}};
  expect_fault(&dea_shape_polygon, NULL, spike, 5, "touches itself at (2, 0.5) mm");
  const double back[3][2] = {{0, 0}, {1, 0}, {0.9, 0.1}};
  expect_fault(&dea_shape_strip, (double[]){0.5}, back, 3,
               "too wide for its corner at (1000, 0) mm");
  const double loop[5][2] = {{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, -2}};
  expect_fault(&dea_shape_strip, (double[]){0.1}, loop, 5, "crosses or touches itself");
}

TEST(test_arrays_and_inside)
{
  struct dea_region cell = empty(), array = empty(), wheel = empty();
  add(&cell, &dea_shape_ring, (double[]){0, 0, 1, 2});
  const size_t count[2] = {3, 2};
  const double step[2][2] = {{5, 0}, {1, 6}};
  dea_region_add_grid(&array, &cell, count, step);
  assert_int_equal(array.contour_count, 12);
  assert_close(dea_region_area_m2(&array), 6 * 3 * pi, 1e-13, 0);
  assert_int_equal(dea_region_check(ctx, &array, true), DEA_OK);
  assert_true(dea_region_inside(&array, 11 + 1.5, 6) && !dea_region_inside(&array, 11, 6));
  double box[4];
  dea_region_box_m(&array, box);
  assert_close(box[0], -2, 1e-15, 0);
  assert_close(box[3], 8, 1e-15, 0);
  assert_close(dea_region_size_m(&array), hypot(15, 10), 1e-15, 0);
  struct dea_region spoke = empty();
  add(&spoke, &dea_shape_rectangle, (double[]){5, 0, 4, 1});
  const double origin[2] = {0, 0};
  dea_region_add_polar(&wheel, &spoke, 8, origin, 0.25 * pi);
  assert_close(dea_region_area_m2(&wheel), 32, 1e-13, 0);
  for (int k = 0; k < 16; k++) {
    double angle = k * pi / 8;
    assert_true(dea_region_inside(&wheel, 5 * cos(angle), 5 * sin(angle)) == (k % 2 == 0));
  }
  struct dea_region *const all[] = {&cell, &array, &wheel, &spoke};
  for (int k = 0; k < 4; k++) {
    dea_region_free(all[k]);
  }
}

/* Two circles in one region. */
static dea_status check_circles(double x, double radius, bool apart)
{
  struct dea_region region = empty();
  dea_region_add_circle(&region, 0, 0, 2e-3, false, here);
  dea_region_add_circle(&region, x, 0, radius, false, here);
  dea_status status = dea_region_check(ctx, &region, apart);
  dea_region_free(&region);
  return status;
}

TEST(test_check)
{
  assert_int_equal(check_circles(4e-3, 2e-3, true), DEA_OK); // touch from outside
  assert_int_equal(check_circles(1e-3, 1e-3, true), DEA_OK); // and from inside
  assert_int_equal(check_circles(3e-3, 2e-3, false), DEA_OK);
  assert_message(check_circles(3e-3, 2e-3, true), DEA_E_DESIGN, "two contours cross at (1.5, ");
  assert_message(check_circles(0, 2e-3, true), DEA_E_DESIGN, "two contours have an edge in common");
  struct dea_region region = empty();
  // a square through the corners of another one, and then only at one corner
  add(&region, &dea_shape_rectangle, (double[]){0, 0, 2, 2});
  const double through[4][2] = {{-2, -2}, {1, 1}, {-2, 2}, {-3, 0}};
  assert_int_equal(dea_region_add_shape(&region, &dea_shape_polygon, NULL, through, 4, here),
                   DEA_OK);
  assert_message(dea_region_check(ctx, &region, true), DEA_E_DESIGN, "two contours cross at (");
  dea_region_free(&region);
  add(&region, &dea_shape_rectangle, (double[]){0, 0, 2, 2});
  add(&region, &dea_shape_rectangle, (double[]){2, 2, 2, 2});
  assert_int_equal(dea_region_check(ctx, &region, true), DEA_OK);
  add(&region, &dea_shape_rectangle, (double[]){2, 0.5, 2, 1});
  assert_message(dea_region_check(ctx, &region, true), DEA_E_DESIGN, "an edge in common");
  dea_region_free(&region);
  // around one circle, from either side: they touch where its halves do
  const struct dea_vertex left[4] = {
      {.y_m = -1, .bulge = -1}, {.y_m = 1}, {.x_m = -3, .y_m = 2}, {.x_m = -3, .y_m = -2}};
  const struct dea_vertex right[4] = {
      {.y_m = 1, .bulge = -1}, {.y_m = -1}, {.x_m = 3, .y_m = -2}, {.x_m = 3, .y_m = 2}};
  dea_region_add(&region, left, 4);
  dea_region_add(&region, right, 4);
  assert_int_equal(dea_region_check(ctx, &region, true), DEA_OK);
  dea_region_free(&region);
  const struct dea_vertex nothing[2] = {{.x_m = 1}, {.x_m = NAN}};
  dea_region_add(&region, nothing, 2);
  assert_message(dea_region_check(ctx, &region, true), DEA_E_DESIGN, "is no number");
  dea_region_free(&region);
  dea_finding_clear(ctx);
}

TEST(test_arrange)
{
  struct dea_region region = empty();
  // seven circles in each other, and two beside them, in any sense
  static const int order[7] = {3, 6, 1, 5, 2, 7, 4};
  double wanted = 0;
  for (int k = 0; k < 7; k++) {
    dea_region_add_circle(&region, 0.1 * order[k], 0, order[k], k % 2 == 0, here);
    wanted += (order[k] % 2 == 1 ? 1 : -1) * pi * order[k] * order[k];
  }
  add(&region, &dea_shape_rectangle, (double[]){20, 0, 4, 4});
  dea_region_add_circle(&region, 20, 0, 2, true, here); // touches all four sides
  assert_int_equal(dea_region_arrange(ctx, &region), DEA_OK);
  assert_close(dea_region_area_m2(&region), wanted + 16 - 4 * pi, 1e-13, 0);
  assert_int_equal(region.contour_count, 9);
  for (size_t i = 0; i < 9; i++) { // each hole follows its outline
    const struct dea_contour contour = dea_region_contour(&region, i);
    static const bool hole[9] = {0, 1, 0, 0, 1, 0, 1, 0, 1};
    assert_true((dea_contour_area_m2(&contour) < 0) == hole[i]);
  }
  assert_true(dea_region_inside(&region, 18.1, 1.9) && !dea_region_inside(&region, 20, 0));
  dea_region_free(&region);
}

static dea_status build_some(struct dea_context *own)
{
  struct dea_region region = {.ctx = own}, copies = {.ctx = own};
  const double square[5][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {0, 0}};
  const size_t count[2] = {2, 2};
  const double step[2][2] = {{5, 0}, {0, 5}};
  dea_status status =
      dea_region_add_shape(&region, &dea_shape_strip, (double[]){1}, square, 5, here);
  if (status == DEA_OK) {
    dea_region_add_grid(&copies, &region, count, step);
    status = dea_region_status(&copies);
  }
  status = status == DEA_OK ? dea_region_arrange(own, &copies) : status;
  dea_region_free(&region);
  dea_region_free(&copies);
  return status;
}

TEST(test_memory)
{
  assert_true(failing_ends(build_some, DEA_OK) > 10);
}

TESTS(context_set_up, context_tear_down)
