/* design and device: each allocation failed in turn, without crash or leak. */
#include "design_text.h"

/* Fails the allocation of number fail_at and counts the blocks that are alive. */
struct failing {
  size_t calls, fail_at;
  long live;
};

static void *failing_resize(void *user, void *pointer, size_t size)
{
  struct failing *failing = user;
  failing->calls++;
  if (failing->calls == failing->fail_at) {
    return NULL;
  }
  void *moved = realloc(pointer, size);
  failing->live += pointer == NULL && moved != NULL;
  return moved;
}

static void failing_release(void *user, void *pointer)
{
  struct failing *failing = user;
  failing->live--;
  free(pointer);
}

typedef dea_status (*attempt_fn)(struct dea_context *ctx);

/* Runs attempt with allocation fail_at failed; true when there were fewer allocations. */
static bool run_failing(attempt_fn attempt, size_t fail_at, dea_status wanted)
{
  struct failing failing = {.fail_at = fail_at};
  const struct dea_allocator allocator = {failing_resize, failing_release, &failing};
  struct dea_context *ctx;
  bool enough = false;
  if (dea_context_create(&allocator, &ctx) == DEA_OK) {
    dea_status status = attempt(ctx);
    enough = failing.calls < fail_at;
    assert_int_equal(status, enough ? wanted : DEA_E_MEMORY);
    dea_context_destroy(ctx);
  }
  assert_int_equal(failing.live, 0);
  return enough;
}

static void fail_each(attempt_fn attempt, dea_status wanted)
{
  size_t n = 1;
  while (!run_failing(attempt, n, wanted)) {
    n++;
    assert_true(n < 100000);
  }
  assert_true(n > 10); // there was something to fail
}

static dea_status read_good(struct dea_context *ctx)
{
  const struct dea_override sets[] = {{"film.thickness", "200 um"},
                                      {"compute.voltage.values", "[1 kV, 2 kV]"}};
  struct dea_design *design;
  struct dea_device *device;
  dea_status status = read_and_build(ctx, GOOD_DESIGN, sets, 2, &design, &device);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  return status;
}

static dea_status read_bad(struct dea_context *ctx)
{
  const struct dea_override set = {"film.thicknes", "200 um"};
  struct dea_design *design;
  struct dea_device *device;
  dea_status status =
      read_and_build(ctx, "dea: 1\ndea: 2\nfilm: {law: 3}\n", &set, 1, &design, &device);
  dea_design_destroy(ctx, design);
  return status;
}

static dea_status read_example(struct dea_context *ctx)
{
  struct dea_design *design;
  struct dea_device *device = NULL;
  dea_status status =
      dea_design_read(ctx, DEA_SOURCE_DIR "/examples/frdea-4.yaml", NULL, 0, &design);
  if (status == DEA_OK) {
    status = dea_device_build(ctx, design, &device);
  }
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  return status;
}

static dea_status build_unknown(struct dea_context *ctx)
{
  const struct dea_override sets[] = {{"film.material", "nothing"}, {"fibres.count", "99"}};
  struct dea_design *design;
  struct dea_device *device;
  dea_status status = read_and_build(ctx, GOOD_DESIGN, sets, 2, &design, &device);
  dea_design_destroy(ctx, design);
  return status;
}

static void test_good_design(void **state)
{
  (void)state;
  fail_each(read_good, DEA_OK);
}

static void test_bad_design(void **state)
{
  (void)state;
  fail_each(read_bad, DEA_E_DESIGN);
}

static void test_example_with_the_catalogue(void **state)
{
  (void)state;
  fail_each(read_example, DEA_OK);
}

static void test_unknown_material(void **state)
{
  (void)state;
  fail_each(build_unknown, DEA_E_DESIGN);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_good_design),
      cmocka_unit_test(test_bad_design),
      cmocka_unit_test(test_example_with_the_catalogue),
      cmocka_unit_test(test_unknown_material),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
