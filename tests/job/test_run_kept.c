/* What is kept while a run goes, and a run that goes on later; with a model of a few lines in the
 * place of the engine. */
#include "failing_allocator.h"
#include "fake_result.h"
#include "fake_surface.h"
#include "io/checkpoint.h"
#include "io/results_h5.h"
#include "io/state_file.h"
#include "job/run_folder.h"
#include "study/study.h"

#include "own_folder.h" // after: its context shadows no name of the headers above

static struct dea_design design;

/* A model whose answer depends on all voltages before: z is the sum of V^2. */
struct dea_model {
  double voltage_V, sum;
  double profile[4][7]; // of 4 points
  struct dea_event event;
};

static double fake_material = 1;       // what the state belongs to
static double fake_limit_V = INFINITY; // it fails above

static dea_status fake_create(struct dea_context *c, const struct dea_device *device,
                              const struct dea_model_settings *settings, struct dea_model **out)
{
  *out = dea_alloc(c, 1, sizeof **out);
  return *out != NULL ? DEA_OK : DEA_E_MEMORY;
}

static void fake_destroy(struct dea_context *c, struct dea_model *model)
{
  dea_free(c, model);
}

static dea_status fake_solve(struct dea_context *c, struct dea_model *model, double voltage_V,
                             struct dea_load_point *out)
{
  if (voltage_V > fake_limit_V) {
    return dea_fail(c, DEA_E_NOT_CONVERGED, "no further");
  }
  model->voltage_V = voltage_V;
  model->sum += voltage_V * voltage_V;
  *out = dea_load_point_empty();
  out->voltage_V = voltage_V;
  out->centre_z_m = model->sum;
  return DEA_OK;
}

static dea_status fake_fields(struct dea_context *c, struct dea_model *model,
                              enum dea_fields_part part, struct dea_field_mesh **out)
{
  *out = fake_surface(c, model->voltage_V);
  return *out != NULL ? DEA_OK : DEA_E_MEMORY;
}

static dea_status fake_save(struct dea_context *c, struct dea_model *model, struct dea_state *out)
{
  DEA_TRY(c, dea_state_add_mark(c, out, "material", &fake_material, sizeof fake_material));
  DEA_TRY(c, dea_state_add(c, out, "sum", &model->sum, 1));
  DEA_TRY(c, dea_state_add_numbers(c, out, "voltage", &model->voltage_V, 1));
  return DEA_OK;
}

static dea_status fake_load(struct dea_context *c, struct dea_model *model,
                            const struct dea_state *state)
{
  const double *sum = dea_state_find(state, "sum", 1);
  const double *voltage_V = dea_state_find(state, "voltage", 1);
  if (sum == NULL || voltage_V == NULL) {
    return dea_fail(c, DEA_E_ARGUMENT, "not a state");
  }
  model->sum = *sum;
  model->voltage_V = *voltage_V;
  return DEA_OK;
}

/* Numbers of the voltage. */
static dea_status fake_profile(struct dea_context *c, struct dea_model *model,
                               struct dea_profile *out)
{
  double *at = &model->profile[0][0];
  for (size_t i = 0; i < 28; i++) {
    at[i] = model->voltage_V + (double)i;
  }
  *out = (struct dea_profile){4, at, at + 4, at + 8, at + 12, at + 16, at + 20, at + 24};
  return DEA_OK;
}

/* A limit point before the second voltage. */
static const struct dea_event *fake_passed(const struct dea_model *model)
{
  struct dea_event *event = (struct dea_event *)&model->event;
  *event = (struct dea_event){DEA_EVENT_PULL_IN, dea_load_point_empty()};
  event->point.voltage_V = model->voltage_V - 50;
  return model->voltage_V == 200 ? event : NULL;
}

/* Where it stops. */
static const struct dea_event *fake_limit(const struct dea_model *model)
{
  struct dea_event *event = (struct dea_event *)&model->event;
  *event = (struct dea_event){DEA_EVENT_PULL_IN, dea_load_point_empty()};
  event->point.voltage_V = fake_limit_V;
  return event;
}

static const struct dea_model_type fake_type = {.name = "fake",
                                                .long_name = "Fake",
                                                .create = fake_create,
                                                .destroy = fake_destroy,
                                                .solve = fake_solve,
                                                .fields = fake_fields,
                                                .profile = fake_profile,
                                                .passed = fake_passed,
                                                .limit = fake_limit,
                                                .save = fake_save,
                                                .load = fake_load};

static double voltages_V[8];

/* A run of `count` voltages into a folder, from the start or on from its state. *z: centre at the
 * last point. */
static dea_status run(struct dea_context *c, const char *name, size_t count, bool resume, double *z)
{
  char directory[700];
  struct dea_result *result = NULL;
  struct dea_keep keep;
  snprintf(directory, sizeof directory, "%s/%s", folder, name);
  design.compute.voltages_V = voltages_V;
  design.compute.voltage_count = count;
  for (size_t i = 0; i < 8; i++) {
    voltages_V[i] = 100.0 * (double)(i + 1);
  }
  dea_status status = dea_result_create(c, &design, NULL, &result);
  if (status == DEA_OK && resume) {
    status = dea_checkpoint_restore(c, directory, result);
  }
  if (status == DEA_OK) {
    status = dea_run_folder_prepare(c, directory, true);
  }
  if (status == DEA_OK && !resume) {
    dea_run_folder_clear(c, directory);
  }
  if (status == DEA_OK) {
    dea_checkpoint_begin(&keep, directory);
    const struct dea_study_services services = {.checkpoint = &keep.sink};
    status = dea_study_run_with(c, &fake_type, NULL, 0, &services, result);
    const struct dea_curve *sweep = dea_result_find(result, "fake", "sweep");
    *z = sweep != NULL && sweep->count > 0 ? sweep->points[sweep->count - 1].centre_z_m : NAN;
    if (status == DEA_OK) {
      assert_int_equal(sweep->count, count);
      assert_int_equal(result->surface_count, count);
      assert_int_equal(result->profile_count, count);
      for (size_t i = 0; i < count; i++) {
        assert_close(result->profiles[i].voltage_V, voltages_V[i], 0, 0);
        assert_close(result->profiles[i].columns[0], voltages_V[i], 0, 0);
      }
      assert_int_equal(sweep->event_count, 1); // of before it was stopped too
      assert_close(sweep->events[0].point.voltage_V, 150, 0, 0);
      assert_true(sweep->complete);
    }
  }
  dea_result_destroy(c, result);
  return status;
}

static void plain_design(enum dea_fields_at fields)
{
  design = fake_design();
  design.report.fields.value = (int)fields;
  design.report.fields_of.value = DEA_FIELDS_SECTOR;
  fake_material = 1;
  fake_limit_V = INFINITY;
}

TEST(test_resume_equals_one_run)
{
  double whole, part;
  plain_design(DEA_FIELDS_LAST);
  assert_int_equal(run(ctx, "whole", 6, false, &whole), DEA_OK);
  fake_limit_V = 300;
  assert_int_equal(run(ctx, "part", 6, false, &part), DEA_E_NOT_CONVERGED);
  assert_close(part, 1e4 * (1 + 4 + 9), 0, 0);
  assert_true(there("part/fields/fake_0002.vtu")); // the last one that there was
  assert_true(there("part/results.h5") && there("part/fake_state.h5"));
  fake_limit_V = INFINITY;
  assert_int_equal(run(ctx, "part", 6, true, &part), DEA_OK);
  assert_close(part, whole, 0, 0);
  assert_true(there("part/fields/fake_0005.vtu"));
  assert_false(there("part/fields/fake_0002.vtu"));
  assert_int_equal(run(ctx, "part", 8, true, &part), DEA_OK); // further voltages
  assert_close(part, 1e4 * (1 + 4 + 9 + 16 + 25 + 36 + 49 + 64), 0, 0);
  assert_int_equal(run(ctx, "part", 8, true, &part), DEA_OK); // nothing left to do
  struct dea_run *read;
  assert_int_equal(dea_run_read(ctx, in_folder("part"), &read), DEA_OK);
  const struct dea_curve *sweep = dea_result_find(read->result, "fake", "sweep");
  assert_int_equal(sweep->count, 8);
  assert_int_equal(read->result->surface_count, 8);
  assert_int_equal(read->result->profile_count, 8);
  assert_false(sweep->complete); // as it was kept on the way
  dea_run_destroy(ctx, read);
}

/* Killed between results.h5 and the state: the state says how far the run came. */
TEST(test_state_that_lags_behind)
{
  double z;
  char command[1500];
  plain_design(DEA_FIELDS_NONE);
  assert_int_equal(run(ctx, "lag", 3, false, &z), DEA_OK);
  snprintf(command, sizeof command, "cp '%s/lag/fake_state.h5' '%s/old.h5'", folder, folder);
  assert_int_equal(system(command), 0);
  assert_int_equal(run(ctx, "lag", 5, true, &z), DEA_OK);
  snprintf(command, sizeof command, "cp '%s/old.h5' '%s/lag/fake_state.h5'", folder, folder);
  assert_int_equal(system(command), 0);
  assert_int_equal(run(ctx, "lag", 6, true, &z), DEA_OK);
  assert_close(z, 1e4 * (1 + 4 + 9 + 16 + 25 + 36), 0, 0);
}

TEST(test_resume_is_refused)
{
  double z;
  plain_design(DEA_FIELDS_NONE);
  assert_int_equal(run(ctx, "nowhere", 3, true, &z), DEA_E_IO);
  assert_int_equal(run(ctx, "refused", 3, false, &z), DEA_OK);
  fake_material = 2;
  size_t before = size_of("refused/results.h5");
  assert_int_equal(run(ctx, "refused", 4, true, &z), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_context_message(ctx), "material is another one now"));
  assert_int_equal(size_of("refused/results.h5"), before);
  fake_material = 1;
  assert_int_equal(run(ctx, "refused", 2, true, &z), DEA_E_DESIGN); // there are three points
  assert_non_null(strstr(dea_context_message(ctx), "cannot resume"));
  assert_int_equal(unlink(in_folder("refused/fake_state.h5")), 0);
  assert_int_equal(run(ctx, "refused", 3, true, &z), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "no model left a state"));
  FILE *file = fopen(in_folder("refused/fake_state.h5"), "wb");
  assert_non_null(file);
  fputs("not HDF5", file);
  fclose(file);
  assert_int_equal(run(ctx, "refused", 3, true, &z), DEA_E_IO);
}

/* Fields at all points, at some, at none; a new run clears what the old one kept. */
TEST(test_fields_as_asked)
{
  double z;
  plain_design(DEA_FIELDS_ALL);
  assert_int_equal(run(ctx, "asked", 3, false, &z), DEA_OK);
  assert_true(there("asked/fields/fake_0000.vtu") && there("asked/fields/fake_0002.vtu"));
  assert_true(there("asked/fake_sweep.pvd"));
  size_t sector = size_of("asked/fields/fake_0000.vtu");
  plain_design(DEA_FIELDS_ALL);
  design.report.fields = (struct dea_choice){.value = -1};
  design.report.fields_at_V[0] = 200;
  design.report.fields_at_count = 1;
  design.report.fields_of.value = DEA_FIELDS_WHOLE;
  assert_int_equal(run(ctx, "asked", 3, false, &z), DEA_OK);
  assert_false(there("asked/fields/fake_0000.vtu") || there("asked/fields/fake_0002.vtu"));
  assert_true(there("asked/fields/fake_0001.vtu"));
  assert_true(size_of("asked/fields/fake_0001.vtu") > 4 * sector);
  plain_design(DEA_FIELDS_NONE);
  assert_int_equal(run(ctx, "asked", 3, false, &z), DEA_OK);
  assert_false(there("asked/fields") || there("asked/fake_sweep.pvd"));
}

static void run_twice(struct dea_context *failing)
{
  double z;
  failing_check(failing, run(failing, "twice", 2, false, &z));
  dea_status status = run(failing, "twice", 3, true, &z);
  if (status != DEA_E_IO && status != DEA_E_DESIGN) { // of a first run that was ended
    failing_check(failing, status);
  }
}

TEST(test_each_allocation_of_a_run)
{
  plain_design(DEA_FIELDS_LAST);
  assert_true(failing_each(run_twice) > 100);
}

TESTS(set_up, tear_down)
