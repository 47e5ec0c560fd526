/* What a model cannot do is an error with a message, not a call to nowhere. */
#include "design_text.h"
#include "study/force.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

/* The axisymmetric model has no indenter: pressing one in called a null pointer. */
TEST(test_force_without_indenter)
{
  const struct dea_model_type *type = dea_model_find("axisymmetric");
  const struct dea_override depth = {"compute.force", "{radius: 1 mm, depth: [0.1 mm]}"};
  struct dea_design *design;
  struct dea_device *device;
  struct dea_model *model;
  assert_int_equal(read_and_build(ctx, GOOD_DESIGN, &depth, 1, &design, &device), DEA_OK);
  assert_int_equal(type->create(ctx, device, NULL, &model), DEA_OK);
  assert_int_equal(dea_force_indent(ctx, type, model, design, 0), DEA_E_UNSUPPORTED);
  assert_string_equal(dea_context_message(ctx),
                      "the model 'axisymmetric' does not support indenter");
  type->destroy(ctx, model);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
}

/* A model that has nothing beside solving, and every call that it lacks. */
TEST(test_bare_model)
{
  const struct dea_model_type bare = {.name = "bare"};
  const struct dea_path_options path = {.max_points = 1};
  struct dea_profile profile;
  struct dea_load_point point;
  struct dea_field_mesh *mesh;
  struct dea_state saved;
  double error;
  const dea_status answers[] = {
      dea_model_path(ctx, &bare, NULL, &path, NULL, NULL, NULL),
      dea_model_profile(ctx, &bare, NULL, &profile),
      dea_model_indent(ctx, &bare, NULL, NULL, 0, &point),
      dea_model_modes(ctx, &bare, NULL, NULL, 1, &point, &mesh),
      dea_model_fields(ctx, &bare, NULL, DEA_FIELDS_VOLUME, &mesh),
      dea_model_save(ctx, &bare, NULL, &saved),
      dea_model_load(ctx, &bare, NULL, &saved),
      dea_model_begin(ctx, &bare, NULL, NULL, &point),
      dea_model_advance(ctx, &bare, NULL, NULL, &point, &error),
  };
  for (size_t i = 0; i < sizeof answers / sizeof answers[0]; i++) {
    assert_int_equal(answers[i], DEA_E_UNSUPPORTED);
  }
  assert_string_equal(dea_context_message(ctx), "the model 'bare' does not support time");
}

TESTS(context_set_up, context_tear_down)
