/* Booleans of regions: areas against closed forms, far below the height of the chords that GEOS
 * sees. */
#include "failing_allocator.h"
#include "geometry/boolean.h"
#include "geometry/shape.h"
#include "message_fixture.h"

static const double pi = 3.14159265358979323846;
static const struct dea_location here = {"t.yaml", 3, 4};

static struct dea_region shape(const struct dea_shape_type *type, const double *value)
{
  struct dea_region region = {.ctx = ctx};
  assert_int_equal(dea_region_add_shape(&region, type, value, NULL, 0, here), DEA_OK);
  return region;
}

static struct dea_region circle(double x, double y, double radius)
{
  return shape(&dea_shape_circle, (double[]){x, y, radius});
}

static struct dea_region rectangle(double x, double y, double width, double height)
{
  return shape(&dea_shape_rectangle, (double[]){x, y, width, height});
}

/* The result, which passes the check; a and b are freed. */
static struct dea_region combine(enum dea_boolean what, struct dea_region a, struct dea_region b)
{
  struct dea_region out = {.ctx = ctx};
  dea_status status = dea_region_combine(ctx, what, &a, &b, &out);
  if (status != DEA_OK || dea_region_check(ctx, &out, true) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  dea_region_free(&a);
  dea_region_free(&b);
  return out;
}

/* Area, and numbers of contours and vertices. */
static void expect(struct dea_region region, double area, size_t contours, size_t vertices)
{
  assert_close(dea_region_area_m2(&region), area, 1e-12, 0);
  assert_int_equal(region.contour_count, contours);
  assert_int_equal(region.vertex_count, vertices);
  for (size_t i = 0; i < region.vertex_count; i++) {
    assert_string_equal(region.vertex[i].location.file, "t.yaml");
  }
  dea_region_free(&region);
}

TEST(test_lens)
{
  for (int k = 1; k < 20; k++) {
    double d = 0.1 * k, lens = 2 * acos(0.5 * d) - 0.5 * d * sqrt(4 - d * d);
    double x = d * cos(k), y = d * sin(k);
    struct dea_region both = combine(DEA_INTERSECTION, circle(0, 0, 1), circle(x, y, 1));
    assert_close(dea_region_area_m2(&both), lens, 1e-12, 1e-14);
    assert_close(dea_region_boundary_m(&both), 4 * acos(0.5 * d), 1e-12, 0);
    dea_region_free(&both);
    struct dea_region all = combine(DEA_UNION, circle(0, 0, 1), circle(x, y, 1));
    assert_close(dea_region_area_m2(&all), 2 * pi - lens, 1e-12, 0);
    dea_region_free(&all);
    struct dea_region moon = combine(DEA_DIFFERENCE, circle(0, 0, 1), circle(x, y, 1));
    assert_close(dea_region_area_m2(&moon), pi - lens, 1e-12, 0);
    dea_region_free(&moon);
  }
  expect(combine(DEA_INTERSECTION, circle(0, 0, 1), circle(0, 1, 1)), 2 * pi / 3 - 0.5 * sqrt(3), 1,
         2);
}

/* Area of a disc within |y| < h on one side of x = 0. */
static double half_band(double radius, double h)
{
  return h * sqrt(radius * radius - h * h) + radius * radius * asin(h / radius);
}

TEST(test_ring_and_strips)
{
  double outer = 20e-3, inner = 15e-3, hub = 4e-3, h = 0.35e-3;
  struct dea_region ring = shape(&dea_shape_ring, (double[]){0, 0, inner, outer});
  expect(combine(DEA_DIFFERENCE, ring, rectangle(0, 0, 1, 2 * h)),
         pi * (outer * outer - inner * inner) - 2 * (half_band(outer, h) - half_band(inner, h)), 2,
         8);
  // a wheel: ring, hub and 12 spokes that end within both
  struct dea_region spoke = rectangle(9e-3, 0, 16e-3, 2 * h), spokes = {.ctx = ctx};
  const double origin[2] = {0, 0};
  dea_region_add_polar(&spokes, &spoke, 12, origin, pi / 6);
  ring = shape(&dea_shape_ring, (double[]){0, 0, inner, outer});
  struct dea_region rim = combine(DEA_UNION, ring, circle(0, 0, hub));
  double wheel = pi * (outer * outer - inner * inner + hub * hub) +
                 12 * (half_band(inner, h) - half_band(hub, h));
  expect(combine(DEA_UNION, spokes, rim), wheel, 13, 2 + 12 * 4);
  dea_region_free(&spoke);
}

TEST(test_tangent)
{
  expect(combine(DEA_UNION, circle(0, 0, 1), circle(3, 0, 2)), 5 * pi, 2, 4);
  expect(combine(DEA_INTERSECTION, circle(0, 0, 1), circle(3, 0, 2)), 0, 0, 0);
  struct dea_region moon = combine(DEA_DIFFERENCE, circle(0, 0, 2), circle(0.6, 0.8, 1));
  assert_close(dea_region_area_m2(&moon), 3 * pi, 1e-12, 0);
  dea_region_free(&moon);
  struct dea_region square = combine(DEA_DIFFERENCE, rectangle(0, 0, 2, 2), circle(0, 0, 1));
  assert_close(dea_region_area_m2(&square), 4 - pi, 1e-12, 0);
  dea_region_free(&square);
  // 1e-10 of the size beside a tangent is one, 1e-7 is none
  struct dea_region near = combine(DEA_INTERSECTION, circle(0, 0, 1), circle(2 - 1e-10, 0, 1));
  assert_int_equal(near.contour_count, 0);
  dea_region_free(&near);
  near = combine(DEA_INTERSECTION, circle(0, 0, 1), circle(2 - 1e-7, 0, 1));
  assert_int_equal(near.contour_count, 1);
  dea_region_free(&near);
}

TEST(test_coincident)
{
  expect(combine(DEA_UNION, rectangle(0, 0, 1, 1), rectangle(1, 0, 1, 1)), 2, 1, 4);
  expect(combine(DEA_DIFFERENCE, rectangle(0, 0, 2, 2), rectangle(0.5, 0, 1, 2)), 2, 1, 4);
  expect(combine(DEA_INTERSECTION, rectangle(0, 0, 1, 1), rectangle(1, 0, 1, 1)), 0, 0, 0);
  expect(combine(DEA_DIFFERENCE, circle(0, 0, 1), circle(0, 0, 1)), 0, 0, 0);
  expect(combine(DEA_UNION, circle(1, 2, 1), circle(1, 2, 1)), pi, 1, 2);
  // sectors of one disc that overlap, or follow each other, or are cut out of it
  const double first[] = {1, 2, NAN, 3, 0.3, 2}, second[] = {1, 2, NAN, 3, 1.1, 4},
               third[] = {1, 2, NAN, 3, 2, 5};
  expect(combine(DEA_UNION, shape(&dea_shape_sector, first), shape(&dea_shape_sector, second)),
         4.5 * 3.7, 1, 3);
  expect(
      combine(DEA_INTERSECTION, shape(&dea_shape_sector, first), shape(&dea_shape_sector, second)),
      4.5 * 0.9, 1, 3);
  expect(combine(DEA_UNION, shape(&dea_shape_sector, first), shape(&dea_shape_sector, third)),
         4.5 * 4.7, 1, 3);
  expect(combine(DEA_DIFFERENCE, circle(1, 2, 3), shape(&dea_shape_sector, first)),
         4.5 * (2 * pi - 1.7), 1, 3);
  // copies that overlap become one region
  struct dea_region one = circle(0, 0, 1), row = {.ctx = ctx}, out = {.ctx = ctx};
  const size_t count[2] = {5, 1};
  const double step[2][2] = {{1, 0}, {0, 0}};
  dea_region_add_grid(&row, &one, count, step);
  assert_int_equal(dea_region_combine(ctx, DEA_UNION, &row, NULL, &out), DEA_OK);
  expect(out, 5 * pi - 4 * (2 * pi / 3 - 0.5 * sqrt(3)), 1, 8);
  dea_region_free(&one);
  dea_region_free(&row);
}

/* Thinner than the chords' height at the first attempt: seen, and tried again with finer ones. */
TEST(test_thin)
{
  double t = 1e-7;
  struct dea_region thin = shape(&dea_shape_ring, (double[]){0, 0, 1 - t, 1});
  double area = pi * (2 - t) * t, half_width = 0.1;
  struct dea_region cut = combine(DEA_INTERSECTION, thin, rectangle(0, 1, 2 * half_width, 1));
  double wanted = half_band(1, half_width) - half_band(1 - t, half_width);
  assert_close(dea_region_area_m2(&cut), wanted, 0, 1e-15 + 1e-12 * area);
  dea_region_free(&cut);
}

/* Some shape or array of it that overlaps itself. */
static struct dea_region any(unsigned long *seed)
{
  double u[5];
  for (int k = 0; k < 5; k++) {
    *seed = (1103515245UL * *seed + 12345UL) & 0x7fffffffUL;
    u[k] = (double)(*seed >> 16) / 32768.0;
  }
  const double round[] = {u[0], u[1], 0.3 + u[2]};
  const double ring[] = {u[0], u[1], 0.2 + 0.3 * u[2], 0.6 + u[3]};
  const double box[] = {u[0], u[1], 0.5 + u[2], 0.5 + u[3], 0.2};
  const double bar[] = {u[0], u[1], 1 + u[2], 0.1 + 0.5 * u[3], 6 * u[4]};
  switch (*seed >> 10 & 3) {
  case 0:
    return shape(&dea_shape_circle, round);
  case 1:
    return shape(&dea_shape_ring, ring);
  case 2:
    return shape(&dea_shape_rounded_rectangle, box);
  default:
    break;
  }
  struct dea_region one = shape(&dea_shape_stadium, bar), star = {.ctx = ctx}, out = {.ctx = ctx};
  dea_region_add_polar(&star, &one, 5, (double[2]){0.4, 0.3}, 0.4 * pi);
  assert_int_equal(dea_region_combine(ctx, DEA_UNION, &star, NULL, &out), DEA_OK);
  dea_region_free(&one);
  dea_region_free(&star);
  return out;
}

static struct dea_region copy(const struct dea_region *region)
{
  struct dea_region out = {.ctx = ctx};
  const struct dea_motion none = dea_motion_translation(0, 0);
  dea_region_add_moved(&out, region, &none);
  return out;
}

TEST(test_any)
{
  unsigned long seed = 7;
  for (int k = 0; k < 60; k++) {
    struct dea_region a = any(&seed), b = any(&seed);
    struct dea_region both = combine(DEA_INTERSECTION, copy(&a), copy(&b));
    struct dea_region all = combine(DEA_UNION, copy(&a), copy(&b));
    struct dea_region rest = combine(DEA_DIFFERENCE, copy(&a), copy(&b));
    double of_a = dea_region_area_m2(&a), common = dea_region_area_m2(&both);
    assert_close(dea_region_area_m2(&all), of_a + dea_region_area_m2(&b) - common, 3e-13, 0);
    assert_close(dea_region_area_m2(&rest), of_a - common, 0, 3e-13);
    // what was cut off, put together again: edges that lie on each other
    struct dea_region again = combine(DEA_UNION, rest, both);
    assert_close(dea_region_area_m2(&again), of_a, 3e-13, 0);
    assert_int_equal(again.contour_count, a.contour_count);
    struct dea_region *const regions[] = {&a, &b, &all, &again};
    for (int i = 0; i < 4; i++) {
      dea_region_free(regions[i]);
    }
  }
}

TEST(test_faults)
{
  const struct dea_vertex bow[4] = {
      {0, 0, 0, here}, {2e-3, 2e-3, 0, here}, {2e-3, 0, 0, here}, {0, 2e-3, 0, here}};
  struct dea_region bad = {.ctx = ctx}, good = circle(0, 0, 1e-3), out = {.ctx = ctx};
  dea_region_add(&bad, bow, 4);
  assert_message(dea_region_combine(ctx, DEA_UNION, &good, &bad, &out), DEA_E_DESIGN,
                 "crosses or touches itself at (1, 1) mm");
  bad.vertex[3].y_m = 1e-3;
  assert_message(dea_region_combine(ctx, DEA_UNION, &good, &bad, &out), DEA_E_DESIGN,
                 "crosses or touches itself at (0.666667, 0.666667) mm");
  dea_region_free(&bad);
  dea_region_add_circle(&bad, 0, 0, 1e-3, true, here);
  assert_message(dea_region_combine(ctx, DEA_UNION, &bad, &good, &out), DEA_E_DESIGN,
                 "a hole without an outline at (1, 0) mm");
  assert_int_equal(out.contour_count, 0);
  dea_region_free(&bad);
  dea_region_free(&good);
  dea_finding_clear(ctx);
}

static dea_status cut_some(struct dea_context *own)
{
  struct dea_region a = {.ctx = own}, b = {.ctx = own}, out = {.ctx = own};
  dea_region_add_circle(&a, 0, 0, 1, false, here);
  dea_region_add_circle(&a, 0, 0, 0.5, true, here);
  dea_region_add_circle(&b, 1, 0, 1, false, here);
  dea_region_add_circle(&b, 0, 1, 1, false, here);
  dea_status status = dea_region_combine(own, DEA_DIFFERENCE, &a, &b, &out);
  assert_true(status == DEA_OK || out.contour_count == 0);
  dea_region_free(&a);
  dea_region_free(&b);
  dea_region_free(&out);
  return status;
}

TEST(test_memory)
{
  assert_true(failing_ends(cut_some, DEA_OK) > 20);
}

TESTS(context_set_up, context_tear_down)
