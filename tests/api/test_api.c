/* The public interface, as a program uses it that knows <dea.h> alone. */
#include <dea.h>

#include "testing.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char disc[] = "dea: 1\n"
                           "title: \"A disc: it's \\\"short\\\"\"\n"
                           "film: {material: elastosil-2030, thickness: 100 um}\n"
                           "pre_stretch: 1.5 # a comment\n"
                           "frame: {inner_radius: 15 mm}\n"
                           "electrodes: {radius: 3.75 mm stretched}\n"
                           "compute:\n"
                           "  models: [lumped, axisymmetric]\n"
                           "  voltage: {from: 0 kV, to: 2 kV, step: 1 kV}\n";

static dea_context *ctx;
static char folder[] = "/tmp/test_door_XXXXXX", path[256];

static const char *in_folder(const char *name)
{
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return path;
}

static dea_design *parse(const char *text)
{
  dea_design *design;
  dea_status status = dea_design_parse(ctx, text, "disc.yaml", &design);
  if (status != DEA_OK) {
    fail_msg("%s", dea_error_message(ctx));
  }
  return design;
}

static dea_result *run(const dea_design *design, const char *model)
{
  dea_run_options options = DEA_RUN_OPTIONS_INIT;
  dea_result *result;
  options.models = &model;
  options.model_count = 1;
  if (dea_run(ctx, design, &options, &result) != DEA_OK) {
    fail_msg("%s", dea_error_message(ctx));
  }
  return result;
}

static const dea_array *array(const dea_result *result, const char *name)
{
  const dea_array *found;
  if (dea_result_array(ctx, result, name, &found) != DEA_OK) {
    fail_msg("%s", dea_error_message(ctx));
  }
  return found;
}

/* The numbers of the enumerations are the library's own. */
TEST(test_status_names)
{
#define NAMED(code) assert_string_equal(dea_error_name(code), #code)
  NAMED(DEA_OK);
  NAMED(DEA_E_DIFFERS);
  NAMED(DEA_E_USAGE);
  NAMED(DEA_E_ARGUMENT);
  NAMED(DEA_E_UNSUPPORTED);
  NAMED(DEA_E_DESIGN);
  NAMED(DEA_E_IO);
  NAMED(DEA_E_TOOL);
  NAMED(DEA_E_INSTRUMENT);
  NAMED(DEA_E_INTERLOCK);
  NAMED(DEA_E_MEMORY);
  NAMED(DEA_E_DOMAIN);
  NAMED(DEA_STATUS_SUSPECT);
  NAMED(DEA_E_NOT_CONVERGED);
  NAMED(DEA_E_NO_EQUILIBRIUM);
  NAMED(DEA_E_INTERRUPTED);
  NAMED(DEA_E_SLACK);
  NAMED(DEA_E_INVERTED);
  assert_true(strlen(dea_error_meaning(DEA_E_IO)) > 10);
  int a, b, c;
  assert_int_equal(sscanf(dea_version(), "%d.%d.%d", &a, &b, &c), 3);
}

TEST(test_values)
{
  dea_design *design = parse(disc);
  const dea_value *value;
  assert_int_equal(dea_design_get(ctx, design, "film.thickness", &value), DEA_OK);
  assert_string_equal(value->text, "100 um");
  assert_close(value->si, 1e-4, 1e-15, 0);
  assert_string_equal(value->unit, "m");
  assert_int_equal(value->origin, DEA_GIVEN);
  assert_int_equal(value->line, 3);

  assert_int_equal(dea_design_set(ctx, design, "film.thickness", "80 um"), DEA_OK);
  assert_int_equal(dea_design_get(ctx, design, "film.thickness", &value), DEA_OK);
  assert_close(value->si, 8e-5, 1e-15, 0);
  assert_int_equal(value->origin, DEA_OVERRIDE);
  assert_int_equal(dea_design_get(ctx, design, "compute.force.radius", &value), DEA_OK);
  assert_int_equal(value->origin, DEA_DEFAULT);
  assert_int_equal(dea_design_get(ctx, design, "fabrication.leads.angle", &value), DEA_OK);
  assert_int_equal(value->origin, DEA_ABSENT);
  assert_true(isnan(value->si) && value->text[0] == '\0');

  size_t count = 0;
  while (dea_design_value_at(design, count) != NULL) {
    count++;
  }
  assert_true(count > 40);
  assert_int_equal(dea_design_get(ctx, design, "film.thicknes", &value), DEA_E_ARGUMENT);
  assert_null(value);
  assert_non_null(strstr(dea_error_message(ctx), "did you mean 'film.thickness'"));
  dea_design_free(design);
}

/* A value that is refused leaves the design as it was, and says why and where. */
TEST(test_refused)
{
  dea_design *design = parse(disc);
  const dea_value *value;
  assert_int_equal(dea_design_set(ctx, design, "film.thickness", "80"), DEA_E_DESIGN);
  const dea_finding *finding = dea_finding_at(ctx, 0);
  assert_non_null(finding);
  assert_int_equal(finding->severity, DEA_ERROR);
  assert_non_null(strstr(finding->text, "no unit"));
  assert_string_equal(finding->file, "--set film.thickness");
  assert_null(dea_finding_at(ctx, 1));
  assert_int_equal(dea_design_get(ctx, design, "film.thickness", &value), DEA_OK);
  assert_close(value->si, 1e-4, 1e-15, 0);

  dea_design *bad;
  assert_int_equal(dea_design_parse(ctx, "dea: 1\nfilm: {thicknes: 1 um}\n", "bad.yaml", &bad),
                   DEA_E_DESIGN);
  assert_null(bad);
  finding = dea_finding_at(ctx, 0);
  assert_string_equal(finding->file, "bad.yaml");
  assert_int_equal(finding->line, 2);
  assert_int_equal(dea_design_open(ctx, "/nowhere/x.yaml", &bad), DEA_E_IO);
  assert_true(dea_error_trace(ctx)[0] != '\0');

  assert_int_equal(dea_design_set(ctx, design, "electrodes.radius", "16 mm stretched"), DEA_OK);
  assert_int_equal(dea_design_check(ctx, design), DEA_E_DESIGN); // beyond the frame
  assert_non_null(dea_finding_at(ctx, 0));
  dea_design_free(design);
}

/* Values that fit only together. */
TEST(test_together)
{
  static const char *const keys[] = {"pre_stretch", "compute.path.max_stretch"};
  static const char *const values[] = {"1.8", "2.5"};
  dea_design *design = parse(disc);
  const dea_value *value;
  assert_int_equal(dea_design_set(ctx, design, keys[1], "1.7"), DEA_OK);
  assert_int_equal(dea_design_set(ctx, design, keys[0], values[0]), DEA_E_DESIGN);
  assert_int_equal(dea_design_set_all(ctx, design, keys, values, 2), DEA_OK);
  assert_int_equal(dea_design_get(ctx, design, keys[1], &value), DEA_OK);
  assert_string_equal(value->text, "2.5");
  assert_int_equal(dea_design_check(ctx, design), DEA_OK);
  dea_design_free(design);
}

/* The text of a changed design is read as that design again. */
TEST(test_text)
{
  dea_design *design = parse(disc), *copy, *again;
  const char *text;
  assert_int_equal(dea_design_text(ctx, design, &text), DEA_OK);
  assert_string_equal(text, disc); // comments and all
  assert_int_equal(dea_design_set(ctx, design, "title", "\"two\\nlines: # [x]\""), DEA_OK);
  assert_int_equal(dea_design_set(ctx, design, "compute.models", "[3d]"), DEA_OK);
  assert_int_equal(dea_design_set(ctx, design, "compute.force.depth", "[1 mm, -0.5 mm]"), DEA_OK);
  assert_int_equal(dea_design_copy(ctx, design, &copy), DEA_OK);
  assert_int_equal(dea_design_write(ctx, design, in_folder("written.yaml")), DEA_OK);
  assert_int_equal(dea_design_open(ctx, path, &again), DEA_OK);
  for (size_t i = 0;; i++) {
    const dea_value *a = dea_design_value_at(design, i), *b = dea_design_value_at(again, i);
    const dea_value *c = dea_design_value_at(copy, i);
    if (a == NULL) {
      assert_null(b);
      assert_null(c);
      break;
    }
    assert_string_equal(a->key, b->key);
    assert_string_equal(a->text, b->text);
    assert_string_equal(a->text, c->text);
    assert_true(a->si == b->si || (isnan(a->si) && isnan(b->si)));
  }
  unlink(path);
  dea_design_free(again);
  dea_design_free(copy);
  dea_design_free(design);
}

/* The sweep of the interface against one actuator taken through the same voltages by hand. */
TEST(test_sweep)
{
  dea_design *design = parse(disc);
  dea_result *result = run(design, "lumped");
  const dea_array *V = array(result, "lumped/sweep/voltage_V");
  const dea_array *stretch = array(result, "lumped/sweep/electrode_stretch");
  assert_int_equal(V->rank, 1);
  assert_int_equal(V->shape[0], 3);
  assert_string_equal(V->unit, "V");
  dea_actuator *actuator;
  assert_int_equal(dea_actuator_open(ctx, design, "lumped", &actuator), DEA_OK);
  for (size_t i = 0; i < 3; i++) {
    double value;
    assert_close(V->data[i], 1e3 * (double)i, 0, 0);
    assert_int_equal(dea_actuator_solve(ctx, actuator, V->data[i]), DEA_OK);
    assert_int_equal(dea_actuator_get(ctx, actuator, "electrode_stretch", &value), DEA_OK);
    assert_close(stretch->data[i], value, 1e-12, 0);
  }
  assert_true(stretch->data[2] > stretch->data[1]);
  dea_actuator_free(actuator);

  const dea_array *margin = array(result, "lumped/path/breakdown/breakdown_margin"), *missing;
  assert_int_equal(margin->shape[0], 1);
  assert_close(margin->data[0], 0, 0, 1e-9);
  assert_int_equal(dea_result_array(ctx, result, "lumped/sweep/voltage", &missing), DEA_E_ARGUMENT);
  assert_null(missing);
  assert_non_null(strstr(dea_error_message(ctx), "lumped/sweep/voltage_V"));
  const char *text;
  assert_int_equal(dea_result_text(ctx, result, "lumped/sweep/status", &text), DEA_OK);
  assert_string_equal(text, "DEA_OK");
  assert_int_equal(dea_result_text(ctx, result, "design", &text), DEA_OK);
  assert_string_equal(text, disc);
  dea_result_free(result);
  dea_design_free(design);
}

/* What a model cannot do is an error with a message; each says beforehand what it can. */
TEST(test_abilities)
{
  dea_design *design = parse(disc);
  const dea_model_info *model;
  size_t count = 0;
  for (; (model = dea_model_at(ctx, count)) != NULL; count++) {
    char name[32];
    unsigned abilities = model->abilities;
    snprintf(name, sizeof name, "%s", model->name);
    if (strcmp(name, "3d") == 0) {
      assert_true((abilities & DEA_CAN_INDENT) != 0);
      assert_true((abilities & DEA_CAN_PATH) == 0);
      assert_true((model->layout_abilities & DEA_CAN_TIME) != 0);
      assert_true((model->layout_abilities & DEA_CAN_PROFILE) == 0);
      continue;
    }
    if (strcmp(name, "reduced") == 0) { // made by 3d: tests/solid/test_solid_solve_reduced.c
      assert_true((model->layout_abilities & DEA_CAN_TIME) != 0);
      assert_true((abilities & (DEA_CAN_INDENT | DEA_CAN_FIELDS | DEA_CAN_PATH)) == 0);
      continue;
    }
    assert_int_equal(model->layout_abilities, 0);
    dea_actuator *actuator;
    const dea_mesh *mesh;
    assert_int_equal(dea_actuator_open(ctx, design, name, &actuator), DEA_OK);
    assert_int_equal(dea_actuator_solve(ctx, actuator, 1e3), DEA_OK);
    assert_true((abilities & (DEA_CAN_INDENT | DEA_CAN_FIELDS)) == 0);
    assert_int_equal(dea_actuator_indent(ctx, actuator, DEA_SPHERE, 1e-3, 1e-4), DEA_E_UNSUPPORTED);
    assert_non_null(strstr(dea_error_message(ctx), name));
    assert_int_equal(dea_actuator_mesh(ctx, actuator, &mesh), DEA_E_UNSUPPORTED);
    assert_null(mesh);
    dea_actuator_free(actuator);
  }
  assert_int_equal(count, 4);
  bool force = false;
  const dea_study_info *study;
  for (size_t i = 0; (study = dea_study_at(ctx, i)) != NULL; i++) {
    force = force || (strcmp(study->name, "force") == 0 && study->needs[0] != '\0');
  }
  assert_true(force);
  dea_actuator *none;
  assert_int_equal(dea_actuator_open(ctx, design, "lumpd", &none), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_error_message(ctx), "'lumped'"));
  dea_design_free(design);
}

/* Saved, read back, written as a folder: the same numbers, and the design that was computed. */
TEST(test_files)
{
  dea_design *design = parse(disc), *again;
  assert_int_equal(dea_design_set(ctx, design, "pre_stretch", "1.4"), DEA_OK);
  dea_result *result = run(design, "axisymmetric"), *read;
  assert_int_equal(dea_result_save(ctx, result, in_folder("a.h5")), DEA_OK);
  assert_int_equal(dea_result_open(ctx, path, &read), DEA_OK);
  size_t i = 0;
  for (; dea_result_array_at(result, i) != NULL; i++) {
    const dea_array *a = dea_result_array_at(result, i), *b = array(read, a->name);
    assert_int_equal(a->shape[0], b->shape[0]);
    assert_string_equal(a->unit, b->unit);
    assert_memory_equal(a->data, b->data, a->shape[0] * sizeof *a->data);
  }
  assert_true(i > 20);
  assert_null(dea_result_array_at(read, i));
  const dea_value *value;
  assert_int_equal(dea_result_design(ctx, read, &again), DEA_OK);
  assert_int_equal(dea_design_get(ctx, again, "pre_stretch", &value), DEA_OK);
  assert_close(value->si, 1.4, 0, 0);
  dea_run_options options = DEA_RUN_OPTIONS_INIT;
  options.no_figures = 1;
  char run_folder[300], file[400];
  snprintf(run_folder, sizeof run_folder, "%s/run", folder);
  assert_int_equal(dea_result_write(ctx, read, run_folder, &options), DEA_OK);
  assert_int_equal(dea_result_write(ctx, read, run_folder, &options), DEA_E_IO); // not over it
  snprintf(file, sizeof file, "%s/axisymmetric_sweep.csv", run_folder);
  assert_int_equal(access(file, R_OK), 0);
  snprintf(file, sizeof file, "rm -r %s", run_folder);
  assert_int_equal(system(file), 0);
  unlink(path);
  dea_design_free(again);
  dea_result_free(read);
  dea_result_free(result);
  dea_design_free(design);
}

TEST(test_pictures)
{
  dea_design *design = parse(disc);
  dea_result *result = run(design, "lumped");
  const char *svg;
  assert_int_equal(dea_design_svg(ctx, design, &svg), DEA_OK);
  assert_int_equal(strncmp(svg, "<svg xmlns=", 11), 0);
  assert_non_null(strstr(svg, "\303\230 30 mm"));
  assert_int_equal(dea_result_svg(ctx, result, "stretch", &svg), DEA_OK);
  assert_non_null(strstr(svg, "class=\"line"));
  assert_int_equal(dea_result_svg(ctx, result, "", &svg), DEA_OK);
  assert_int_equal(dea_result_svg(ctx, result, "strech", &svg), DEA_E_ARGUMENT);
  assert_non_null(strstr(dea_error_message(ctx), "'stretch'"));
  assert_null(svg);
  dea_result_free(result);
  dea_design_free(design);
}

struct calls {
  size_t progress, notes, asked, stop_after;
};

static void on_progress(void *user, const char *what, size_t done, size_t total)
{
  struct calls *calls = user;
  assert_true(what[0] != '\0' && (total == 0 || done <= total));
  calls->progress++;
}

static int on_interrupt(void *user)
{
  struct calls *calls = user;
  return ++calls->asked > calls->stop_after;
}

static void on_note(void *user, enum dea_severity severity, const char *text)
{
  struct calls *calls = user;
  assert_true(severity < DEA_ERROR && text[0] != '\0');
  calls->notes++;
}

/* A run that is interrupted keeps what it has; the same run goes through otherwise. */
TEST(test_callbacks)
{
  dea_context *own;
  struct calls calls = {.stop_after = 1000000};
  dea_context_options options = DEA_CONTEXT_OPTIONS_INIT;
  options.user = &calls;
  options.progress = on_progress;
  options.interrupt = on_interrupt;
  options.note = on_note;
  dea_design *design;
  dea_result *result;
  assert_int_equal(dea_context_new(&options, &own), DEA_OK);
  assert_int_equal(dea_design_parse(own, disc, "disc.yaml", &design), DEA_OK);
  assert_int_equal(calls.notes, 0);
  assert_int_equal(dea_run(own, design, NULL, &result), DEA_OK);
  assert_true(calls.progress > 0 && calls.asked > 3 && calls.notes > 0);
  dea_result_free(result);
  calls = (struct calls){.stop_after = calls.asked - 2};
  assert_int_equal(dea_run(own, design, NULL, &result), DEA_E_INTERRUPTED);
  assert_non_null(result);
  const dea_array *V;
  assert_int_equal(dea_result_array(own, result, "lumped/sweep/voltage_V", &V), DEA_OK);
  dea_result_free(result);
  // objects belong to the context that made them; a run only reads the design
  assert_int_equal(dea_design_set(ctx, design, "pre_stretch", "1.3"), DEA_E_ARGUMENT);
  assert_int_equal(dea_run(ctx, design, NULL, &result), DEA_OK);
  dea_result_free(result);
  dea_design_free(design);
  dea_context_free(own);
}

/* Options of a caller that knows fewer members, or none. */
TEST(test_growth)
{
  dea_design *design = parse(disc);
  dea_result *result;
  const char *const models[] = {"lumped"};
  dea_run_options options = DEA_RUN_OPTIONS_INIT;
  options.models = models;
  options.model_count = 1;
  options.folder = "/dev/null/folder";
  options.size = offsetof(dea_run_options, folder); // so the folder is not looked at
  assert_int_equal(dea_run(ctx, design, &options, &result), DEA_OK);
  dea_result_free(result);
  options.size = sizeof options;
  assert_int_equal(dea_run(ctx, design, &options, &result), DEA_E_IO);
  assert_null(result);
  static const char *const none[] = {"sweeep"};
  options = (dea_run_options)DEA_RUN_OPTIONS_INIT;
  options.studies = none;
  options.study_count = 1;
  assert_int_equal(dea_run(ctx, design, &options, &result), DEA_E_ARGUMENT);
  assert_null(result);
  dea_design_free(design);
}

struct memory {
  long left, alive;
};

static void *resize(void *user, void *pointer, size_t size)
{
  struct memory *memory = user;
  if (memory->left == 0) {
    return NULL;
  }
  memory->left -= memory->left > 0;
  void *moved = realloc(pointer, size);
  memory->alive += moved != NULL && pointer == NULL;
  return moved;
}

static void release(void *user, void *pointer)
{
  ((struct memory *)user)->alive -= pointer != NULL;
  free(pointer);
}

static dea_status work(dea_context *own)
{
  dea_design *design = NULL, *copy = NULL;
  dea_result *result = NULL;
  const char *text;
  const char *const models[] = {"lumped"}, *const studies[] = {"sweep"};
  dea_run_options options = DEA_RUN_OPTIONS_INIT;
  options.models = models;
  options.studies = studies;
  options.model_count = options.study_count = 1;
  dea_status status = dea_design_parse(own, disc, "disc.yaml", &design);
  status = status == DEA_OK ? dea_design_set(own, design, "pre_stretch", "1.3") : status;
  status = status == DEA_OK ? dea_design_copy(own, design, &copy) : status;
  status = status == DEA_OK ? dea_design_text(own, copy, &text) : status;
  status = status == DEA_OK ? dea_run(own, copy, &options, &result) : status;
  status = status == DEA_OK ? dea_result_svg(own, result, "", &text) : status;
  dea_result_free(result);
  dea_design_free(copy);
  dea_design_free(design);
  return status;
}

/* Whichever allocation fails: out of memory, and nothing is left over. */
TEST(test_memory)
{
  dea_status status = DEA_E_MEMORY;
  long n = 0;
  for (; status == DEA_E_MEMORY; n += 1 + n / 40) {
    struct memory memory = {.left = -1};
    dea_context_options options = DEA_CONTEXT_OPTIONS_INIT;
    options.user = &memory;
    options.resize = resize;
    options.release = release;
    dea_context *own;
    memory.left = n;
    status = dea_context_new(&options, &own);
    if (status == DEA_OK) {
      status = work(own);
      memory.left = -1;
      dea_context_free(own);
    }
    assert_int_equal(memory.alive, 0);
    assert_true(n < 100000);
  }
  assert_int_equal(status, DEA_OK);
  assert_true(n > 500);
}

int main(void)
{
  if (mkdtemp(folder) == NULL || dea_context_new(NULL, &ctx) != DEA_OK) {
    return 1;
  }
  int failed = run_all(NULL, NULL);
  dea_context_free(ctx);
  rmdir(folder);
  return failed;
}
