/* What a run with fields leaves: surfaces in results.h5, drawings of them, and what is kept while
 * it goes; with a model of a few lines in the place of the engine. */
#define _GNU_SOURCE // mkdtemp
#include "failing_allocator.h"
#include "fake_result.h"
#include "fake_surface.h"
#include "output/drawing.h"
#include "output/figure.h"
#include "output/keep.h"
#include "output/run_folder.h"
#include "output/state_file.h"
#include "output/store.h"
#include "study/study.h"

#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

static struct dea_context *ctx;
static char folder[512], path[700];

static int set_up(void **state)
{
  (void)state;
  char here[400];
  if (getcwd(here, sizeof here) == NULL || dea_context_create(NULL, &ctx) != DEA_OK) {
    return -1;
  }
  snprintf(folder, sizeof folder, "%s/dea-fields-XXXXXX", here);
  return mkdtemp(folder) != NULL ? 0 : -1;
}

static int tear_down(void **state)
{
  (void)state;
  char command[700];
  dea_context_destroy(ctx);
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  return system(command);
}

static const char *in_folder(const char *name)
{
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return path;
}

static bool there(const char *name)
{
  struct stat info;
  return stat(in_folder(name), &info) == 0;
}

static size_t size_of(const char *name)
{
  struct stat info;
  return stat(in_folder(name), &info) == 0 ? (size_t)info.st_size : 0;
}

/* ---- drawings ---- */

/* Lengths of all outlines of a kind. */
static double length_of(const struct dea_outline *lines, size_t count, enum dea_outline_kind kind)
{
  double length = 0;
  for (size_t i = 0; i < count; i++) {
    for (int k = 1; k < lines[i].count && lines[i].kind == kind; k++) {
      length += hypot(lines[i].at[k][DEA_DRAWING_X] - lines[i].at[k - 1][DEA_DRAWING_X],
                      lines[i].at[k][DEA_DRAWING_Y] - lines[i].at[k - 1][DEA_DRAWING_Y]);
    }
  }
  return length;
}

static void test_outlines(void **state)
{
  (void)state;
  const double pi = 3.14159265358979324;
  struct dea_field_mesh *mesh = fake_surface(ctx, 1e3);
  struct dea_outline *lines;
  size_t count;
  assert_int_equal(dea_drawing_outlines(ctx, mesh, &lines, &count), DEA_OK);
  assert_close(length_of(lines, count, DEA_OUTLINE_FRAME), 2 * pi * fake_radius_m, 1e-3, 0);
  assert_close(length_of(lines, count, DEA_OUTLINE_ELECTRODE), 2 * pi * fake_electrode_m, 1e-3, 0);
  // the fibre's two sides each, from the electrode to the frame; not its middle, a plane of
  // symmetry
  assert_close(length_of(lines, count, DEA_OUTLINE_FIBRE),
               2 * FAKE_FOLD * (fake_radius_m - fake_electrode_m), 1e-9, 0);
  dea_free(ctx, lines);
  dea_field_mesh_destroy(ctx, mesh);
}

/* All of the disc once, at the height that the surface has there. */
static void test_patches(void **state)
{
  (void)state;
  const double pi = 3.14159265358979324;
  struct dea_field_mesh *mesh = fake_surface(ctx, 1e3);
  struct dea_drawing drawing;
  assert_int_equal(dea_drawing_create(ctx, mesh, 4000, &drawing), DEA_OK);
  assert_int_equal(drawing.patch_count, 2 * FAKE_FOLD * FAKE_RINGS * FAKE_TURNS);
  assert_true(drawing.piece_count > 3000 && drawing.piece_count < 12000);
  assert_close(drawing.radius_m, fake_radius_m, 1e-9, 0);
  assert_close(drawing.z_max_m, 1e-6, 1e-9, 0);
  double area = 0;
  for (size_t i = 0; i < drawing.patch_count; i++) {
    const struct dea_patch *patch = &drawing.patches[i];
    int row = patch->n + 1;
    for (int k = 0; k < row * (patch->m + 1); k++) {
      const double *p = patch->at[k];
      double height = fake_height_m(p[DEA_DRAWING_X], p[DEA_DRAWING_Y], 1e3);
      assert_close(p[DEA_DRAWING_UZ], height, 0, 0.01e-6); // quadratic elements
      assert_close(p[DEA_DRAWING_UX], 1e-3 * p[DEA_DRAWING_X], 0, 1e-15);
      if (k % row < patch->n && k / row < patch->m) {
        const double *q = patch->at[k + row + 1], *a = patch->at[k + 1], *b = patch->at[k + row];
        area += 0.5 * fabs((q[0] - p[0]) * (b[1] - a[1]) - (q[1] - p[1]) * (b[0] - a[0]));
      }
    }
  }
  assert_close(area, pi * fake_radius_m * fake_radius_m, 2e-3, 0);
  dea_drawing_free(ctx, &drawing);
  dea_field_mesh_destroy(ctx, mesh);
}

static void test_section(void **state)
{
  (void)state;
  struct dea_field_mesh *mesh = fake_surface(ctx, 1e3);
  struct dea_drawing drawing;
  assert_int_equal(dea_drawing_create(ctx, mesh, 20000, &drawing), DEA_OK);
  for (int way = 0; way < 3; way++) { // a plane of symmetry, another, none
    double angle = way == 0 ? 0 : way == 1 ? 1.04719755119659775 : 0.37, *found;
    size_t count;
    assert_int_equal(dea_drawing_section(ctx, &drawing, angle, &found, &count), DEA_OK);
    assert_true(count > 50);
    assert_close(found[0], -fake_radius_m, 2e-3, 0);
    assert_close(found[count - 1], fake_radius_m, 2e-3, 0);
    for (size_t i = 0; i < count; i++) {
      double height = fake_height_m(found[i] * cos(angle), found[i] * sin(angle), 1e3);
      assert_true(i == 0 || found[i] > found[i - 1]);
      assert_close(found[count + i], height, 0, 0.02e-6);
    }
    dea_free(ctx, found);
  }
  dea_drawing_free(ctx, &drawing);
  dea_field_mesh_destroy(ctx, mesh);
}

static void test_what_cannot_be_drawn(void **state)
{
  (void)state;
  struct dea_field_mesh *mesh;
  struct dea_drawing drawing;
  struct dea_outline *lines;
  size_t count;
  int *nodes;
  assert_int_equal(dea_field_mesh_create(ctx, 8, &mesh), DEA_OK);
  assert_int_equal(dea_field_mesh_add_block(ctx, mesh, 1, 1, 1, &nodes), DEA_OK);
  assert_int_equal(dea_drawing_create(ctx, mesh, 10, &drawing), DEA_E_ARGUMENT);
  assert_int_equal(dea_drawing_outlines(ctx, mesh, &lines, &count), DEA_E_ARGUMENT);
  dea_field_mesh_destroy(ctx, mesh);
}

/* ---- results.h5 and figures ---- */

static struct dea_design design;

static dea_status make_result(struct dea_context *c, struct dea_result **out)
{
  design = fake_design();
  DEA_TRY(c, dea_result_create(c, &design, NULL, out));
  for (int k = 0; k < 3; k++) {
    struct dea_field_mesh *mesh = fake_surface(c, 1e3 * k);
    if (mesh == NULL) {
      return DEA_E_MEMORY;
    }
    mesh->X[0] += k == 2 ? 1e-9 : 0; // another mesh
    DEA_TRY(c, dea_result_add_surface(c, *out, "fake", 1e3 * k, mesh));
  }
  return DEA_OK;
}

static void check_same(const struct dea_field_mesh *a, const struct dea_field_mesh *b)
{
  assert_int_equal(a->point_count, b->point_count);
  assert_int_equal(a->cell_count, b->cell_count);
  assert_int_equal(a->block_count, b->block_count);
  assert_int_equal(a->field_count, b->field_count);
  assert_int_equal(a->fold, b->fold);
  assert_int_equal(a->fibres, b->fibres);
  assert_memory_equal(a->X, b->X, 3 * a->point_count * sizeof *a->X);
  assert_memory_equal(a->blocks[0].nodes, b->blocks[0].nodes, 9 * a->cell_count * sizeof(int));
  for (size_t i = 0; i < a->field_count; i++) {
    const struct dea_mesh_field *f = &a->fields[i], *g = dea_field_mesh_find(b, f->name);
    assert_non_null(g);
    assert_string_equal(f->unit, g->unit);
    assert_string_equal(f->meaning, g->meaning);
    assert_int_equal(f->kind, g->kind);
    assert_int_equal(f->of_cells, g->of_cells);
    assert_int_equal(f->components, g->components);
    assert_memory_equal(f->values, g->values,
                        dea_mesh_field_count(a, f) * (size_t)f->components * sizeof(double));
  }
}

static void test_store(void **state)
{
  (void)state;
  struct dea_result *result;
  struct dea_run *run;
  assert_int_equal(make_result(ctx, &result), DEA_OK);
  assert_int_equal(dea_store_write(ctx, result, in_folder("a.h5")), DEA_OK);
  assert_int_equal(dea_run_read(ctx, in_folder("a.h5"), &run), DEA_OK);
  assert_int_equal(run->result->surface_count, 3);
  for (size_t k = 0; k < 3; k++) {
    assert_string_equal(run->result->surfaces[k].model, "fake");
    assert_close(run->result->surfaces[k].voltage_V, 1e3 * (double)k, 0, 0);
    check_same(result->surfaces[k].mesh, run->result->surfaces[k].mesh);
  }
  dea_run_destroy(ctx, run);
  dea_result_destroy(ctx, result);
}

static void test_figures(void **state)
{
  (void)state;
  struct dea_result *result;
  assert_int_equal(make_result(ctx, &result), DEA_OK);
  result->surfaces[2].mesh->X[0] -= 1e-9;
  const struct dea_figure_options options = {
      .format = {.svg = true, .pdf = true, .png = true, .width_m = 0.085}, .voltage_V = 1.1e3};
  assert_int_equal(dea_figures_write(ctx, result, in_folder("figures"), &options), DEA_OK);
  static const char *const names[] = {"map", "surface", "section", "animation"};
  static const char *const endings[] = {"gp", "dat", "svg", "pdf", "png", "gif"};
  for (size_t i = 0; i < 4; i++) {
    for (size_t k = 0; k < 6; k++) {
      char name[64];
      snprintf(name, sizeof name, "figures/%s.%s", names[i], endings[k]);
      bool wanted = k < 2 || (i == 3) == (k == 5);
      if (there(name) != wanted || (wanted && size_of(name) < 500)) {
        fail_msg("%s %s", name, wanted ? "is missing or empty" : "should not be there");
      }
    }
  }
  char text[200] = "";
  FILE *script = fopen(in_folder("figures/surface.gp"), "rb");
  assert_non_null(script);
  assert_non_null(fgets(text, sizeof text, script)); // the nearest voltage, and how much z is drawn
  assert_non_null(strstr(text, "at 1 kV, z drawn 2000 times larger"));
  fclose(script);
  dea_result_destroy(ctx, result);
}

/* A flat film, one surface, or none. */
static void test_figures_of_little(void **state)
{
  (void)state;
  const struct dea_figure_options options = {.format = {.svg = true, .width_m = 0.17},
                                             .voltage_V = NAN};
  struct dea_result *result;
  design = fake_design();
  assert_int_equal(dea_result_create(ctx, &design, NULL, &result), DEA_OK);
  assert_int_equal(dea_figures_write(ctx, result, in_folder("none"), &options), DEA_OK);
  assert_false(there("none/map.gp"));
  assert_int_equal(dea_result_add_surface(ctx, result, "fake", 0, fake_surface(ctx, 0)), DEA_OK);
  assert_int_equal(dea_figures_write(ctx, result, in_folder("one"), &options), DEA_OK);
  assert_true(there("one/map.svg") && there("one/surface.svg") && there("one/section.svg"));
  assert_false(there("one/animation.gp"));
  dea_result_destroy(ctx, result);
}

static void store_and_read(struct dea_context *failing)
{
  struct dea_result *result = NULL;
  struct dea_run *run = NULL;
  dea_status status = make_result(failing, &result);
  if (status == DEA_OK) {
    status = dea_store_write(failing, result, in_folder("m.h5"));
  }
  if (status == DEA_OK) {
    status = dea_run_read(failing, in_folder("m.h5"), &run);
  }
  failing_check(failing, status);
  dea_run_destroy(failing, run);
  dea_result_destroy(failing, result);
}

static void draw(struct dea_context *failing)
{
  static const char *const names[] = {"map", "surface", "section", "animation"};
  const struct dea_figure_options options = {
      .names = names, .name_count = 4, .format = {.width_m = 0.085}, .voltage_V = NAN};
  struct dea_result *result = NULL;
  dea_status status = make_result(failing, &result);
  if (status == DEA_OK) {
    status = dea_figures_write(failing, result, in_folder("memory"), &options);
  }
  failing_check(failing, status);
  dea_result_destroy(failing, result);
}

static void test_each_allocation(void **state)
{
  (void)state;
  assert_true(failing_each(store_and_read) > 40);
  assert_true(failing_each(draw) > 60);
}

/* ---- a run that is kept ---- */

/* A model whose answer depends on all voltages before: z is the sum of V^2. */
struct dea_model {
  double voltage_V, sum;
};

static double fake_material = 1;       // what the state belongs to
static double fake_limit_V = INFINITY; // it fails above

static dea_status fake_create(struct dea_context *c, const struct dea_device *device,
                              struct dea_model **out)
{
  (void)device;
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
  (void)part;
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

static const struct dea_model_type fake_type = {.name = "fake",
                                                .long_name = "Fake",
                                                .create = fake_create,
                                                .destroy = fake_destroy,
                                                .solve = fake_solve,
                                                .fields = fake_fields,
                                                .save = fake_save,
                                                .load = fake_load};

static double voltages_V[8];

/* A run of `count` voltages into a folder, from the start or on from its state. *z: centre at the
 * last point. */
static dea_status run(struct dea_context *c, const char *name, size_t count, bool resume, double *z)
{
  char directory[700];
  struct dea_result *result = NULL;
  struct dea_keep *keep = NULL;
  snprintf(directory, sizeof directory, "%s/%s", folder, name);
  design.compute.voltages_V = voltages_V;
  design.compute.voltage_count = count;
  for (size_t i = 0; i < 8; i++) {
    voltages_V[i] = 100.0 * (double)(i + 1);
  }
  dea_status status = dea_result_create(c, &design, NULL, &result);
  if (status == DEA_OK && resume) {
    status = dea_keep_restore(c, directory, result);
  }
  if (status == DEA_OK) {
    status = dea_run_folder_prepare(c, directory, true);
  }
  if (status == DEA_OK && !resume) {
    dea_run_folder_clear(c, directory);
  }
  if (status == DEA_OK) {
    status = dea_keep_create(c, directory, &keep);
  }
  if (status == DEA_OK) {
    result->keeper = dea_keep_keeper(keep);
    status = dea_study_run(c, &fake_type, result);
    const struct dea_curve *sweep = dea_result_find(result, "fake", "sweep");
    *z = sweep != NULL && sweep->count > 0 ? sweep->points[sweep->count - 1].centre_z_m : NAN;
    if (status == DEA_OK) {
      assert_int_equal(sweep->count, count);
      assert_int_equal(result->surface_count, count);
      assert_true(sweep->complete);
    }
  }
  dea_keep_destroy(c, keep);
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

static void test_resume_equals_one_run(void **state)
{
  (void)state;
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
  assert_false(sweep->complete); // as it was kept on the way
  dea_run_destroy(ctx, read);
}

/* Killed between results.h5 and the state: the state says how far the run came. */
static void test_state_that_lags_behind(void **state)
{
  (void)state;
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

static void test_resume_is_refused(void **state)
{
  (void)state;
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
static void test_fields_as_asked(void **state)
{
  (void)state;
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

/* A folder that cannot be written to stops the sweep with a message, not with a crash. */
static void test_bad_folder(void **state)
{
  (void)state;
  double z;
  char name[700];
  plain_design(DEA_FIELDS_ALL);
  snprintf(name, sizeof name, "%s/bad", folder);
  assert_int_equal(mkdir(name, 0777), 0);
  FILE *file = fopen(in_folder("bad/fields"), "wb"); // in the way of the folder
  assert_non_null(file);
  fclose(file);
  assert_int_equal(run(ctx, "bad", 3, false, &z), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "bad/fields"));
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

static void test_each_allocation_of_a_run(void **state)
{
  (void)state;
  plain_design(DEA_FIELDS_LAST);
  assert_true(failing_each(run_twice) > 100);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_outlines),
      cmocka_unit_test(test_patches),
      cmocka_unit_test(test_section),
      cmocka_unit_test(test_what_cannot_be_drawn),
      cmocka_unit_test(test_store),
      cmocka_unit_test(test_figures),
      cmocka_unit_test(test_figures_of_little),
      cmocka_unit_test(test_each_allocation),
      cmocka_unit_test(test_resume_equals_one_run),
      cmocka_unit_test(test_state_that_lags_behind),
      cmocka_unit_test(test_resume_is_refused),
      cmocka_unit_test(test_fields_as_asked),
      cmocka_unit_test(test_bad_folder),
      cmocka_unit_test(test_each_allocation_of_a_run),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
