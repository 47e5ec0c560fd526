/* Symmetry of regions: found whatever their vertices are, shared by labels, and broken by little.
 */
#include "failing_allocator.h"
#include "geometry/boolean.h"
#include "geometry/shape.h"
#include "geometry/symmetry.h"
#include "message_fixture.h"

static const double pi = 3.14159265358979323846;
static const struct dea_location here = {"t.yaml", 3, 4};

enum { REGIONS_MAX = 9 };

static struct dea_region region[REGIONS_MAX];
static int label[REGIONS_MAX];
static size_t regions;

static struct dea_region *add(const struct dea_shape_type *type, const double *value, int its_label)
{
  struct dea_region *out = &region[regions];
  *out = (struct dea_region){.ctx = ctx};
  label[regions++] = its_label;
  assert_int_equal(dea_region_add_shape(out, type, value, NULL, 0, here), DEA_OK);
  return out;
}

static void add_polygon(const double (*point)[2], size_t count)
{
  region[regions] = (struct dea_region){.ctx = ctx};
  label[regions] = 1;
  assert_int_equal(
      dea_region_add_shape(&region[regions++], &dea_shape_polygon, NULL, point, count, here),
      DEA_OK);
}

static void clear(void)
{
  while (regions > 0) {
    dea_region_free(&region[--regions]);
  }
}

static struct dea_symmetry find(double tolerance)
{
  const struct dea_region *list[REGIONS_MAX];
  struct dea_symmetry found;
  for (size_t i = 0; i < regions; i++) {
    list[i] = &region[i];
  }
  assert_int_equal(dea_symmetry_find(ctx, list, label, regions, tolerance, &found), DEA_OK);
  return found;
}

/* As it is, and turned by an angle and moved; mirror: direction of a line in degrees, for one of
 * them. Forgets the regions. */
static void expect(size_t order, size_t mirrors, double mirror_degree)
{
  for (int moved = 0; moved < 2; moved++) {
    double turn = moved * 0.3;
    for (size_t i = 0; i < regions && moved == 1; i++) {
      struct dea_region turned = {.ctx = ctx}, out = {.ctx = ctx};
      const struct dea_motion rotation = dea_motion_rotation((double[2]){3, -2}, turn);
      const struct dea_motion translation = dea_motion_translation(7, 11);
      dea_region_add_moved(&turned, &region[i], &rotation);
      dea_region_add_moved(&out, &turned, &translation);
      dea_region_free(&turned);
      dea_region_free(&region[i]);
      region[i] = out;
    }
    const struct dea_symmetry found = find(0);
    assert_int_equal(found.order, order);
    assert_int_equal(found.mirrors, mirrors);
    if (mirrors > 0) {
      double off = (found.mirror_rad - turn - mirror_degree * pi / 180) / found.step_rad;
      assert_close(off, floor(off + 0.5), 0, 1e-9);
      assert_true(found.mirror_rad >= 0 && found.mirror_rad < found.step_rad);
      assert_close(found.step_rad, pi / (double)order, 1e-15, 0);
    }
  }
  clear();
}

TEST(test_one)
{
  add(&dea_shape_rectangle, (double[]){1, 2, 2, 2}, 1);
  expect(4, 4, 0);
  add(&dea_shape_rectangle, (double[]){1, 2, 3, 2}, 1);
  expect(2, 2, 0);
  add(&dea_shape_rounded_rectangle, (double[]){1, 2, 3, 3, 0.5}, 1);
  expect(4, 4, 45);
  add(&dea_shape_circle, (double[]){1, 2, 3}, 1);
  expect(0, 0, 0);
  add(&dea_shape_ring, (double[]){1, 2, 2, 3}, 1);
  expect(0, 0, 0);
  add(&dea_shape_stadium, (double[]){0, 0, 5, 2, 0.5}, 1);
  expect(2, 2, 90 / pi);
  add(&dea_shape_sector, (double[]){0, 0, 1, 2, 0.2, 1}, 1);
  expect(1, 1, 108 / pi);
  const double isosceles[3][2] = {{0, 0}, {4, 0}, {2, 5}};
  add_polygon(isosceles, 3);
  expect(1, 1, 90);
  const double any[3][2] = {{0, 0}, {4, 0}, {1, 5}};
  add_polygon(any, 3);
  expect(1, 0, 0);
  const double slanted[4][2] = {{0, 0}, {4, 0}, {5, 2}, {1, 2}};
  add_polygon(slanted, 4);
  expect(2, 0, 0);
}

/* Copies about a centre, of a shape with and without a mirror line of its own. */
TEST(test_polar)
{
  for (size_t n = 2; n < 30; n++) {
    for (int chiral = 0; chiral < 2; chiral++) {
      struct dea_region one = {.ctx = ctx};
      const double point[5][2] = {
          {1, -0.05}, {3, -0.05}, {3, 0.05 + 0.1 * chiral}, {2, 0.05}, {1, 0.05}};
      assert_int_equal(dea_region_add_shape(&one, &dea_shape_polygon, NULL, point, 5, here),
                       DEA_OK);
      struct dea_region *ring = add(&dea_shape_ring, (double[]){0, 0, 4, 5}, 1);
      dea_region_add_polar(ring, &one, n, (double[2]){0, 0}, 2 * pi / (double)n);
      dea_region_free(&one);
      expect(n, chiral ? 0 : n, 0);
    }
  }
}

TEST(test_labels)
{
  for (int kind = 0; kind < 3; kind++) { // four quadrants: one channel, two, four
    static const int channel[3][4] = {{1, 1, 1, 1}, {1, 2, 1, 2}, {1, 2, 3, 4}};
    static const size_t order[3] = {4, 2, 1}, mirrors[3] = {4, 2, 0};
    for (int q = 0; q < 4; q++) {
      double from = 0.5 * pi * q + 0.05;
      add(&dea_shape_sector, (double[]){0, 0, NAN, 2, from, from + 0.5 * pi - 0.1},
          channel[kind][q]);
    }
    expect(order[kind], mirrors[kind], 45);
  }
  for (int driven = 0; driven < 9; driven++) { // 3 x 3 cells, one of them driven
    for (int cell = 0; cell < 9; cell++) {
      add(&dea_shape_circle, (double[]){cell % 3, cell / 3, 0.4}, cell == driven);
    }
    double mirror = driven == 0 || driven == 8 ? 45 : driven == 2 || driven == 6 ? 135 : 0;
    mirror = driven == 1 || driven == 7 ? 90 : mirror;
    expect(driven == 4 ? 4 : 1, driven == 4 ? 4 : 1, mirror);
  }
}

TEST(test_tolerance)
{
  add(&dea_shape_circle, (double[]){0, 0, 1}, 1);
  add(&dea_shape_circle, (double[]){4, 0, 1 + 1e-4}, 1);
  assert_int_equal(find(0).order, 1);
  assert_int_equal(find(0).mirrors, 1);
  assert_int_equal(find(1e-3).order, 2);
  assert_int_equal(find(1e-3).mirrors, 2);
  clear();
  // a hole is not an outline, and an arc that bulges not one that is hollow
  add(&dea_shape_ring, (double[]){-2, 0, 1, 1.5}, 1);
  add(&dea_shape_circle, (double[]){2, 0, 1}, 1);
  add(&dea_shape_ring, (double[]){2, 0, 1.25, 1.5}, 1);
  assert_int_equal(find(0).order, 1);
  clear();
}

/* The result of a boolean has vertices elsewhere than what it is equal to. */
TEST(test_boolean)
{
  char path[4096];
  if (!dea_boolean_find(path, sizeof path)) {
    skip();
  }
  struct dea_region *disc = add(&dea_shape_circle, (double[]){0, 0, 5}, 1);
  struct dea_region bar = {.ctx = ctx}, bars = {.ctx = ctx}, out = {.ctx = ctx};
  assert_int_equal(
      dea_region_add_shape(&bar, &dea_shape_stadium, (double[]){4, 0, 3, 0.5, 0.4}, NULL, 0, here),
      DEA_OK);
  dea_region_add_polar(&bars, &bar, 7, (double[2]){0, 0}, 2 * pi / 7);
  assert_int_equal(dea_region_combine(ctx, DEA_DIFFERENCE, disc, &bars, &out), DEA_OK);
  dea_region_free(disc);
  dea_region_free(&bar);
  dea_region_free(&bars);
  region[0] = out;
  expect(7, 0, 0);
}

static dea_status find_some(struct dea_context *own)
{
  struct dea_region one = {.ctx = own};
  const struct dea_region *const list[1] = {&one};
  const int labels[1] = {0};
  struct dea_symmetry found;
  dea_region_add_circle(&one, 0, 0, 1, false, here);
  dea_region_add_circle(&one, 3, 0, 1, false, here);
  dea_status status = dea_region_status(&one);
  status = status == DEA_OK ? dea_symmetry_find(own, list, labels, 1, 0, &found) : status;
  dea_region_free(&one);
  return status;
}

TEST(test_memory)
{
  assert_true(failing_ends(find_some, DEA_OK) > 3);
}

TESTS(context_set_up, context_tear_down)
