/* design and device: each allocation failed in turn, without crash or leak. */
// ctest: quick, heavy
#include "design_text.h"
#include "failing_allocator.h"
#include "study/design_file.h"

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
  status = status == DEA_OK ? dea_device_build(ctx, design, &device) : status;
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

TEST(test_good_design)
{
  assert_true(failing_ends(read_good, DEA_OK) > 10); // there was something to fail
}

TEST(test_bad_design)
{
  assert_true(failing_ends(read_bad, DEA_E_DESIGN) > 10); // there was something to fail
}

TEST(test_example_with_the_catalogue)
{
  assert_true(failing_ends(read_example, DEA_OK) > 10); // there was something to fail
}

TEST(test_unknown_material)
{
  assert_true(failing_ends(build_unknown, DEA_E_DESIGN) > 10); // there was something to fail
}

TESTS(NULL, NULL)
