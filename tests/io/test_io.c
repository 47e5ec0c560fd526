/* output: what is written is read back; files are whole or absent; errors say what is wrong. */
// ctest: quick, heavy
#include "base/file.h"
#include "base/write_file.h"
#include "failing_allocator.h"
#include "fake_result.h"
#include "figures/run_figures.h"
#include "io/results_h5.h"
#include "io/summary.h"
#include "job/run_folder.h"
#include "plot/finish.h"
#include "result/result.h"
#include "testing.h"

#include <dirent.h>
#include <ftw.h>
#include <jansson.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[256]; // of this test program, made by setup
static struct dea_context *ctx;
static struct dea_design design;
static struct dea_result *result;

static int remove_entry(const char *path, const struct stat *info, int type, struct FTW *ftw)
{
  return remove(path);
}

static int setup(void **state)
{
  const char *base = getenv("TMPDIR");
  snprintf(folder, sizeof folder, "%s/dea-test-XXXXXX", base != NULL ? base : P_tmpdir);
  assert_non_null(mkdtemp(folder));
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  design = fake_design();
  assert_int_equal(fake_result(ctx, &design, 1.0, &result), DEA_OK);
  return 0;
}

static int teardown(void **state)
{
  dea_result_destroy(ctx, result);
  result = NULL;
  dea_context_destroy(ctx);
  nftw(folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
  return 0;
}

/* Path in the test's folder; static storage, so one at a time. */
static const char *in_folder(const char *name)
{
  static char path[512];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return path;
}

static void write_file(const char *name, const char *text)
{
  assert_int_equal(dea_file_write(ctx, in_folder(name), text, strlen(text)), DEA_OK);
}

static size_t count_hidden(const char *directory)
{
  size_t count = 0;
  DIR *entries = opendir(directory);
  assert_non_null(entries);
  for (struct dirent *e; (e = readdir(entries)) != NULL;) {
    count += e->d_name[0] == '.' && strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0;
  }
  closedir(entries);
  return count;
}

static bool same_bits(double a, double b)
{
  return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

static void assert_same_points(const struct dea_load_point *a, const struct dea_load_point *b)
{
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    if (!same_bits(dea_point_get(a, c), dea_point_get(b, c))) {
      fail_msg("%s: %.17g is not %.17g", dea_point_columns[c].key, dea_point_get(a, c),
               dea_point_get(b, c));
    }
  }
  assert_int_equal(a->stable, b->stable);
  assert_int_equal(a->unstable_modes, b->unstable_modes);
  assert_int_equal(dea_load_point_flags(a), dea_load_point_flags(b));
}

// results.h5 -------------------------------------------------------------------------------------

TEST(test_store_reads_back_to_the_bit)
{
  struct dea_run *run;
  result->curves[0].complete = false;
  result->curves[0].status = DEA_E_INVERTED;
  strcpy(result->curves[0].stopped, "no equilibrium above 4.6 kV");
  result->curves[0].points[3].force_N = NAN; // a hole in a column
  result->provenance.wall_s = 0.1;
  result->provenance.solver = (struct dea_solver_counters){1, 2, 3, 4, 5};
  assert_int_equal(dea_results_h5_write(ctx, result, in_folder("results.h5")), DEA_OK);
  assert_int_equal(result->curves[0].status, DEA_E_INVERTED); // writing changes nothing
  assert_int_equal(dea_run_read(ctx, folder, &run), DEA_OK);
  const struct dea_result *back = run->result;
  assert_int_equal(back->curve_count, result->curve_count);
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *a = &result->curves[i], *b = &back->curves[i];
    assert_string_equal(a->model, b->model);
    assert_string_equal(a->kind, b->kind);
    assert_string_equal(a->stopped, b->stopped);
    assert_int_equal(a->complete, b->complete);
    assert_int_equal(a->status, b->status);
    assert_int_equal(a->count, b->count);
    for (size_t k = 0; k < a->count; k++) {
      assert_same_points(&a->points[k], &b->points[k]);
    }
    assert_int_equal(a->event_count, b->event_count);
    for (size_t k = 0; k < a->event_count; k++) {
      assert_int_equal(a->events[k].kind, b->events[k].kind);
      assert_same_points(&a->events[k].point, &b->events[k].point);
    }
  }
  assert_int_equal(back->profile_count, result->profile_count);
  for (size_t i = 0; i < result->profile_count; i++) {
    const struct dea_profile_record *a = &result->profiles[i], *b = &back->profiles[i];
    assert_string_equal(a->model, b->model);
    assert_int_equal(a->count, b->count);
    assert_true(same_bits(a->voltage_V, b->voltage_V));
    assert_memory_equal(a->columns, b->columns, DEA_PROFILE_COLUMNS * a->count * sizeof(double));
  }
  assert_string_equal(run->title, design.title.text);
  assert_string_equal(run->design_file, "fake.yaml");
  assert_close(run->width_m, 0.085, 0, 0);
  assert_true(run->svg);
  assert_false(run->pdf);
  assert_string_equal(back->provenance.input, result->provenance.input);
  assert_string_equal(back->provenance.input_sha256, result->provenance.input_sha256);
  assert_string_equal(back->provenance.libraries, result->provenance.libraries);
  assert_string_equal(back->provenance.overrides, result->provenance.overrides);
  assert_string_equal(back->provenance.command, result->provenance.command);
  assert_close(back->provenance.wall_s, 0.1, 0, 0);
  assert_memory_equal(&back->provenance.solver, &result->provenance.solver,
                      sizeof result->provenance.solver);
  dea_run_destroy(ctx, run);
}

TEST(test_store_that_is_cut_off_or_is_none)
{
  struct dea_run *run;
  char *bytes;
  size_t length;
  assert_int_equal(dea_results_h5_write(ctx, result, in_folder("results.h5")), DEA_OK);
  assert_int_equal(dea_file_read(ctx, in_folder("results.h5"), 100000000, &bytes, &length), DEA_OK);
  for (size_t part = 0; part < 8; part++) {
    assert_int_equal(dea_file_write(ctx, in_folder("cut.h5"), bytes, length * part / 8), DEA_OK);
    assert_int_equal(dea_run_read(ctx, in_folder("cut.h5"), &run), DEA_E_IO);
    assert_null(run);
    assert_non_null(strstr(dea_context_message(ctx), "cut.h5"));
  }
  dea_free(ctx, bytes);
  assert_int_equal(dea_run_read(ctx, in_folder("absent"), &run), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "does not exist"));
  assert_int_equal(mkdir(in_folder("bare"), 0777), 0);
  assert_int_equal(dea_run_read(ctx, in_folder("bare"), &run), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "not a run folder"));
}

TEST(test_file_is_whole_or_absent)
{
  write_file("kept.txt", "old");
  assert_int_equal(mkdir(in_folder("target"), 0777), 0);
  assert_int_equal(dea_file_write(ctx, in_folder("target"), "new", 3), DEA_E_IO); // a folder
  assert_int_equal(count_hidden(folder), 0);
  assert_int_equal(dea_file_write(ctx, in_folder("none/x.txt"), "new", 3), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "No such file"));
  assert_int_equal(dea_file_write(ctx, "/dev/full/x", "new", 3), DEA_E_IO);
  char *text;
  size_t length;
  assert_int_equal(dea_file_read(ctx, in_folder("kept.txt"), 100, &text, &length), DEA_OK);
  assert_string_equal(text, "old");
  dea_free(ctx, text);
}

// summary.json -----------------------------------------------------------------------------------

TEST(test_summary_is_what_scripts_expect)
{
  char *text;
  assert_int_equal(dea_summary_text(ctx, result, &text), DEA_OK);
  json_t *root = json_loads(text, JSON_REJECT_DUPLICATES, NULL);
  assert_non_null(root);
  assert_int_equal(json_integer_value(json_object_get(root, "schema")), 1);
  assert_string_equal(json_string_value(json_object_get(root, "model")), "lumped");
  json_t *points = json_object_get(root, "points");
  assert_int_equal(json_array_size(points), result->curves[0].count);
  json_t *last = json_array_get(points, json_array_size(points) - 1);
  const struct dea_load_point *p = &result->curves[0].points[result->curves[0].count - 1];
  assert_true(json_real_value(json_object_get(last, "voltage_V")) == p->voltage_V);
  assert_true(json_real_value(json_object_get(last, "electrode_stretch")) == p->electrode_stretch);
  assert_true(json_real_value(json_object_get(last, "force_N")) == p->force_N);
  assert_true(json_is_true(json_object_get(last, "stable")));
  assert_int_equal(json_integer_value(json_object_get(last, "unstable_modes")), 0);
  assert_null(json_object_get(last, "capacitance_F")); // this model has none
  json_t *limits = json_object_get(root, "limits");
  assert_true(json_real_value(json_object_get(limits, "pull_in_voltage_V")) ==
              result->curves[1].events[1].point.voltage_V);
  assert_non_null(json_object_get(limits, "slack_voltage_V"));
  assert_non_null(json_object_get(limits, "breakdown_voltage_V"));
  assert_null(json_object_get(limits, "snap_back_voltage_V"));
  assert_true(json_is_true(json_object_get(root, "complete")));
  json_t *more = json_object_get(root, "more_models");
  assert_int_equal(json_array_size(more), 1);
  json_t *second = json_array_get(more, 0);
  assert_string_equal(json_string_value(json_object_get(second, "model")), "axisymmetric");
  assert_null(json_object_get(json_array_get(json_object_get(second, "points"), 1), "force_N"));
  json_t *design_object = json_object_get(root, "design");
  assert_string_equal(json_string_value(json_object_get(design_object, "title")),
                      design.title.text);
  json_decref(root);
  dea_free(ctx, text);
}

TEST(test_summary_of_a_stopped_sweep)
{
  char *text;
  result->curves[0].complete = false;
  result->curves[0].status = DEA_E_INTERRUPTED;
  strcpy(result->curves[0].stopped, "interrupted at 3 kV");
  assert_int_equal(dea_summary_text(ctx, result, &text), DEA_OK);
  json_t *root = json_loads(text, 0, NULL);
  assert_true(json_is_false(json_object_get(root, "complete")));
  assert_string_equal(json_string_value(json_object_get(root, "stopped")), "interrupted at 3 kV");
  assert_string_equal(json_string_value(json_object_get(root, "status")), "DEA_E_INTERRUPTED");
  assert_string_equal(json_string_value(json_object_get(root, "verdict")), "");
  json_decref(root);
  dea_free(ctx, text);
}

// Figures and run folder -------------------------------------------------------------------------

static const struct dea_figure_options svg_only = {.format = {.svg = true, .width_m = 0.085}};

static char *read_all(const char *path)
{
  char *text;
  size_t length;
  assert_int_equal(dea_file_read(ctx, path, 100000000, &text, &length), DEA_OK);
  return text;
}

TEST(test_figures_are_the_same_every_time)
{
  assert_int_equal(dea_figures_write(ctx, result, in_folder("one"), &svg_only, NULL), DEA_OK);
  assert_int_equal(dea_figures_write(ctx, result, in_folder("two"), &svg_only, NULL), DEA_OK);
  static const char *const names[] = {"displacement", "stretch", "field",
                                      "tension",      "force",   "profile"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    char name[64];
    snprintf(name, sizeof name, "one/%s.svg", names[i]);
    char *one = read_all(in_folder(name));
    memcpy(name, "two", 3);
    char *two = read_all(in_folder(name));
    assert_non_null(strstr(one, "<svg"));
    assert_string_equal(one, two);
    dea_free(ctx, one);
    dea_free(ctx, two);
  }
  assert_int_equal(count_hidden(in_folder("one")), 0);
}

static const char *figure_caption(const char *name)
{
  const struct dea_figure *figure = NULL;
  for (size_t i = 0; (figure = dea_figure_get(i)) != NULL && strcmp(figure->name, name) != 0; i++) {
  }
  assert_non_null(figure);
  return figure->caption;
}

TEST(test_script_runs_by_itself_in_its_folder)
{
  static const char *const names[] = {"stretch"};
  struct dea_figure_options options = svg_only;
  options.names = names;
  options.name_count = 1;
  assert_int_equal(dea_figures_write(ctx, result, in_folder("one"), &options, NULL), DEA_OK);
  char *drawn = read_all(in_folder("one/stretch.svg"));
  assert_int_equal(unlink(in_folder("one/stretch.svg")), 0);
  char command[600]; // in a locale of plain ASCII gnuplot warns that it has no degree sign
  snprintf(command, sizeof command, "cd '%s' && LC_ALL=C.UTF-8 gnuplot -d stretch.gp 2>&1",
           in_folder("one"));
  FILE *pipe = popen(command, "r");
  char said[200] = "";
  size_t n = fread(said, 1, sizeof said - 1, pipe);
  said[n] = '\0';
  assert_int_equal(pclose(pipe), 0);
  assert_string_equal(said, "");
  char *again = read_all(in_folder("one/stretch.svg")), *finished;
  assert_int_equal(dea_svg_finish(ctx, again, figure_caption("stretch"), &finished), DEA_OK);
  assert_string_equal(drawn, finished);
  dea_free(ctx, finished);
  dea_free(ctx, drawn);
  dea_free(ctx, again);
}

TEST(test_without_gnuplot_the_scripts_stay)
{
  char path[4096];
  snprintf(path, sizeof path, "%s", getenv("PATH"));
  setenv("PATH", folder, 1);
  dea_status status = dea_run_folder_write(ctx, result, in_folder("run"), NULL);
  setenv("PATH", path, 1);
  assert_int_equal(status, DEA_E_TOOL);
  assert_non_null(strstr(dea_context_message(ctx), "gnuplot-nox"));
  assert_true(dea_path_exists(in_folder("run/results.h5")));
  assert_true(dea_path_exists(in_folder("run/summary.json")));
  assert_true(dea_path_exists(in_folder("run/figures/stretch.gp")));
  assert_true(dea_path_exists(in_folder("run/figures/stretch.dat")));
  assert_false(dea_path_exists(in_folder("run/figures/stretch.svg")));
  assert_int_equal(count_hidden(in_folder("run/figures")), 0);
}

TEST(test_gnuplot_that_fails_is_reported)
{
  char path[4096], with[5000];
  write_file("gnuplot", "#!/bin/sh\necho first >&2\necho 'line 3: no such thing' >&2\nexit 1\n");
  assert_int_equal(chmod(in_folder("gnuplot"), 0755), 0);
  snprintf(path, sizeof path, "%s", getenv("PATH"));
  snprintf(with, sizeof with, "%s:%s", folder, path);
  setenv("PATH", with, 1);
  dea_status status = dea_figures_write(ctx, result, in_folder("f"), &svg_only, NULL);
  setenv("PATH", path, 1);
  assert_int_equal(status, DEA_E_TOOL);
  assert_non_null(strstr(dea_context_message(ctx), "line 3: no such thing"));
  assert_int_equal(count_hidden(in_folder("f")), 0);
}

/* One that ends well and leaves no picture, or an empty one. */
TEST(test_gnuplot_that_draws_nothing_is_reported)
{
  static const char *const programs[] = {
      "#!/bin/sh\nexit 0\n",
      "#!/bin/sh\nfor f in *.gp; do : >\"$(echo .drawing.*)/${f%.gp}.svg\"; done\n"};
  char path[4096], with[5000];
  snprintf(path, sizeof path, "%s", getenv("PATH"));
  snprintf(with, sizeof with, "%s:%s", folder, path);
  for (size_t i = 0; i < 2; i++) {
    write_file("gnuplot", programs[i]);
    assert_int_equal(chmod(in_folder("gnuplot"), 0755), 0);
    setenv("PATH", with, 1);
    dea_status status = dea_figures_write(ctx, result, in_folder("f"), &svg_only, NULL);
    setenv("PATH", path, 1);
    assert_int_equal(status, DEA_E_TOOL);
    assert_non_null(strstr(dea_context_message(ctx), "gnuplot has drawn nothing into "));
    assert_int_equal(count_hidden(in_folder("f")), 0);
  }
}

TEST(test_run_folder_where_a_file_is)
{
  write_file("taken", "x");
  assert_int_equal(dea_run_folder_write(ctx, result, in_folder("taken"), NULL), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "a file has that name"));
  assert_int_equal(dea_run_folder_write(ctx, result, in_folder("taken/below"), NULL), DEA_E_IO);
  assert_int_equal(dea_run_folder_write(ctx, result, "", NULL), DEA_E_ARGUMENT);
  if (geteuid() != 0) { // root may write anywhere
    assert_int_equal(mkdir(in_folder("locked"), 0555), 0);
    assert_int_equal(dea_run_folder_write(ctx, result, in_folder("locked"), NULL), DEA_E_IO);
  }
}

static char failing_folder[300];

static void write_everything(struct dea_context *own)
{
  struct dea_design d = fake_design();
  const struct dea_run_folder_options options = {.force = true};
  struct dea_result *r = NULL;
  d.report.svg = false; // scripts and data, without the process
  dea_status status = dea_result_create(own, &d, NULL, &r);
  status = status == DEA_OK ? fake_add_model(own, r, "lumped", 1.0, true) : status;
  status = status == DEA_OK ? fake_add_profiles(own, r, "lumped") : status;
  status = status == DEA_OK ? dea_run_folder_write(own, r, failing_folder, &options) : status;
  failing_check(own, status);
  dea_result_destroy(own, r);
}

static void read_back(struct dea_context *own)
{
  struct dea_run *run;
  dea_status status = dea_run_read(own, failing_folder, &run);
  failing_check(own, status);
  assert_true((status == DEA_OK) == (run != NULL));
  dea_run_destroy(own, run);
}

TEST(test_every_allocation_may_fail)
{
  snprintf(failing_folder, sizeof failing_folder, "%s/f", folder);
  assert_true(failing_each(write_everything) > 100);
  assert_true(failing_each(read_back) > 20);
  assert_int_equal(count_hidden(failing_folder), 0);
}

/* Lightness (CIE L*, by its luminance) of "#RRGGBB". */
static double lightness(const char *colour)
{
  unsigned red, green, blue;
  assert_int_equal(sscanf(colour, "#%2x%2x%2x", &red, &green, &blue), 3);
  const unsigned parts[] = {red, green, blue};
  const double share[] = {0.2126, 0.7152, 0.0722};
  double luminance = 0;
  for (int i = 0; i < 3; i++) {
    double value = parts[i] / 255.0;
    luminance += share[i] * (value > 0.04045 ? pow((value + 0.055) / 1.055, 2.4) : value / 12.92);
  }
  return luminance > 0.008856 ? 116 * cbrt(luminance) - 16 : 903.3 * luminance;
}

/* A map printed without colours says up from down: its lightness rises all the way. */
TEST(test_colours_keep_the_sign_in_grey)
{
  const double low_m[] = {-1e-5, -1e-5, 0};
  for (int k = 0; k < 3; k++) {
    struct dea_text gp = {.ctx = ctx};
    dea_figure_add_palette(&gp, low_m[k], k == 1 ? 0 : 1e-5);
    double before = -1;
    int count = 0;
    for (const char *at = dea_text_get(&gp); (at = strchr(at, '#')) != NULL; at++, count++) {
      assert_true(lightness(at) > before + 8);
      before = lightness(at);
    }
    assert_true(count >= 6);
    dea_text_free(&gp);
  }
}

TESTS_EACH(NULL, NULL, setup, teardown)
