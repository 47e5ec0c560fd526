/* The calls of `dea run` (models, paths, studies): each allocation failed in turn. */
#include "devices.h"
#include "failing_allocator.h"
#include "model/equilibrium_path.h"
#include "study/study.h"

static struct dea_device device;
static struct dea_design design;
static const struct dea_model_type *type;

static dea_status count_point(void *user, const struct dea_load_point *point)
{
  size_t *count = user;
  *count += isfinite(point->voltage_V) ? 1 : 0;
  return DEA_OK;
}

static void use_model(struct dea_context *ctx)
{
  const struct dea_path_options options = {
      .max_stretch = 3, .max_voltage_V = 5e3, .max_points = 50};
  struct dea_model *model = NULL;
  struct dea_load_point point;
  struct dea_profile profile;
  size_t points = 0;
  dea_status status = type->create(ctx, &device, NULL, &model);
  assert_true((status == DEA_OK) == (model != NULL));
  if (status == DEA_OK) {
    status = type->solve(ctx, model, 2e3, &point);
  }
  if (status == DEA_OK && type->profile != NULL) {
    status = type->profile(ctx, model, &profile);
  }
  if (status == DEA_OK) {
    status = type->path(ctx, model, &options, count_point, NULL, &points);
    assert_true(points > 5);
  }
  failing_check(ctx, status);
  type->destroy(ctx, model);
}

static void run_studies(struct dea_context *ctx)
{
  struct dea_result *result = NULL;
  dea_status status = dea_result_create(ctx, &design, &device, &result);
  if (status == DEA_OK) {
    status = dea_study_run(ctx, type, NULL, 0, result);
  }
  failing_check(ctx, status);
  if (status == DEA_OK) {
    assert_int_equal(dea_result_find(result, type->name, "sweep")->count, 20);
    assert_true(dea_result_find(result, type->name, "path")->event_count > 0);
  }
  dea_result_destroy(ctx, result);
}

/* A film whose electrodes have a thickness but no law, and one that locks up before its
 * pre-stretch: models that cannot be made leave nothing behind. */
static void make_impossible_models(struct dea_context *ctx)
{
  struct dea_device bad[2] = {device, device};
  bad[0].electrode_thickness_m = 1e-6;
  bad[1].film = test_material("gent", 1e5, 0.5, 0);
  for (size_t i = 0; i < 2; i++) {
    struct dea_model *model = NULL;
    dea_status status = type->create(ctx, &bad[i], NULL, &model);
    assert_true(status != DEA_OK);
    assert_null(model);
    assert_true(dea_context_message(ctx)[0] != '\0');
  }
}

TEST(test_each_allocation_of_each_model)
{
  double voltages_V[20];
  for (size_t i = 0; i < 20; i++) {
    voltages_V[i] = 100.0 * (double)i;
  }
  device = test_disc(test_yeoh(), 1.5, 3.75e-3, 0.25, 4);
  design = (struct dea_design){
      .compute = {.voltages_V = voltages_V, .voltage_count = 20, .path_max_stretch = {.si = 3.5}}};
  size_t count;
  const struct dea_model_type *const *all = dea_model_all(&count);
  for (size_t i = 0; i < count && all[i]->path != NULL; i++) { // 3d: its memory is PETSc's
    type = all[i];
    assert_true(failing_each(use_model) >= 2); // the model and its path
    assert_true(failing_each(run_studies) > 6);
    failing_each(make_impossible_models);
  }
}

TESTS(NULL, NULL)
