/* Two and three ranks under mpirun find what one finds. The program runs itself again under mpirun
 * with the argument "ranks" and reads what rank 0 prints. */
// ctest: solid
#include "command.h"
#include "devices.h"
#include "model/solid/assembly/film_state.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "quarter_grid.h"
#include "solid_block.h"
#include "study/study.h"

#include <jansson.h>
#include <signal.h>

/* Tests may run as root, and on fewer cores than ranks, beside others. */
#define MPIRUN                                                                                     \
  "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 timeout 120 "                         \
  "mpirun --oversubscribe --bind-to none --mca mpi_yield_when_idle 1 "

static struct dea_context *ctx;
static const char *program;

static const double a_m = 3.75e-3, b_m = 15e-3;

/* Of a coupled field: ground below, voltage on top. self: thickness of the film. */
static bool faces(const void *self, const double X[3], double *share)
{
  const double *h = self;
  *share = X[2] > 0 ? 1 : 0;
  return hypot(X[0], X[1]) < a_m * (1 + 1e-9) && fabs(fabs(X[2]) - 0.5 * *h) < 1e-6 * *h;
}

/* What is compared: sums over all displacements, the largest of them, energy, unstable modes, and
 * the softest of all modes where it is asked for. */
enum { SAMPLES = 11 };
static const char *const sample_name[SAMPLES] = {
    "sum ux", "sum uy",        "sum uz",         "largest ux",   "largest uy", "smallest uz",
    "energy", "minus tension", "V over h, true", "softest mode", "second mode"};

struct answer {
  int status, modes;
  double samples[SAMPLES];
};

static void take_samples(struct dea_solid *solid, const struct dea_grid *grid, double energy_J,
                         struct answer *out)
{
  const double *u = dea_solid_displacement(solid);
  const struct dea_material material = {0};
  struct dea_solid_extremes extremes;
  for (size_t n = 0; n < grid->node_count; n++) {
    for (int i = 0; i < 3; i++) {
      double sign = i == 2 ? -1 : 1;
      out->samples[i] += u[3 * n + (size_t)i];
      out->samples[3 + i] = fmax(out->samples[3 + i], sign * u[3 * n + (size_t)i]);
    }
  }
  out->samples[6] = energy_J;
  const struct dea_solid_film_data films[2] = {{&material, 1.5}, {&material, 1.5}};
  if (dea_solid_extremes(solid, films, &extremes) == DEA_OK) {
    out->samples[7] = extremes.min_tension_N_per_m;
    out->samples[8] = extremes.true_field_V_per_m;
  }
}

struct test_case {
  int fibres;
  double pre_stretch;
  int highest_kV; // in steps of 1 kV
  enum dea_solid_field_kind field;
  bool inverted; // one element turned inside out
  bool stay;     // at an unstable equilibrium
  bool softest;  // its softest modes are wanted
};

static struct answer solve(const struct test_case *k)
{
  static const double plastic[] = {2950e6, 0.38};
  const double l = k->pre_stretch, h = 100e-6 / (l * l);
  struct dea_part_material layers[] = {{.law = dea_law_find("yeoh"),
                                        .param = {178.4e3, -6e3, 4.2e3},
                                        .pre_stretch = {l, l, 1 / (l * l)},
                                        .kappa_Pa = 4e7,
                                        .permittivity_F_per_m = 2.8 * DEA_EPSILON_0,
                                        .thickness_m = h},
                                       dea_part_material_bonded(plastic)};
  const struct dea_quarter quarter = {2,    2,      a_m,       b_m,         h,           k->fibres,
                                      2e-3, 100e-6, .fine = 1, .across = 1, .edge = 8e-4};
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = 2,
                                            .part_materials = layers,
                                            .part_material_of = layer_of_ply,
                                            .active = quarter_active,
                                            .held = quarter_held,
                                            .field = k->field,
                                            .electrode = faces,
                                            .self = &h};
  struct dea_grid *grid = NULL;
  struct dea_solid *solid = NULL;
  struct dea_solid_report report = {0};
  struct answer answer = {0};
  dea_status status = dea_part_material_relax(&layers[0]);
  status = status == DEA_OK ? dea_grid_quarter(ctx, &quarter, &grid) : status;
  status = status == DEA_OK ? dea_solid_create(ctx, grid, &options, &solid) : status;
  if (status == DEA_OK && k->inverted) {
    dea_solid_displacement(solid)[3 * (grid->node_count - 1)] = 0.1;
  }
  if (status == DEA_OK) {
    dea_solid_settings_of(solid)->accept_unstable = k->stay;
  }
  for (int kV = 0; kV <= k->highest_kV && status == DEA_OK; kV++) {
    status = dea_load_steps_solve(ctx, solid, 1e3 * kV, &report);
  }
  answer.status = (int)status;
  answer.modes = report.unstable_modes;
  if (solid != NULL) {
    take_samples(solid, grid, report.energy_J, &answer);
  }
  if (status == DEA_OK && k->softest) {
    answer.status = (int)dea_solid_modes_lowest(ctx, solid, DEA_MODES_BY_VOLUME, 2,
                                                answer.samples + SAMPLES - 2, NULL);
  }
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
  return answer;
}

/* A film without pre-stretch is slack under voltage: flat, it has many unstable modes; to count
 * them the solve stays there. */
enum { DISC, FOUR_FIBRES, SLACK, COUPLED, INVERTED, CASES };
static struct answer solve_case(int k)
{
  static const struct test_case cases[CASES] = {
      [DISC] = {0, 1.5, 2, DEA_SOLID_FIELD_THIN, false, false, true},
      [FOUR_FIBRES] = {4, 1.5, 2, DEA_SOLID_FIELD_THIN, false, false, false},
      [SLACK] = {0, 1, 1, DEA_SOLID_FIELD_THIN, false, true, false},
      [COUPLED] = {4, 1.5, 1, DEA_SOLID_FIELD_COUPLED, false, false, false},
      [INVERTED] = {0, 1.5, 0, DEA_SOLID_FIELD_THIN, true, false, false},
  };
  return solve(&cases[k]);
}

static volatile sig_atomic_t interrupted;

/* Stands for a model whose ranks need each other; the last rank is interrupted at the second point,
 * after the engine has asked for the last time. */
static dea_status solve_together(struct dea_context *context, struct dea_model *model,
                                 double voltage_V, struct dea_load_point *out)
{
  *out = (struct dea_load_point){.voltage_V = voltage_V};
  dea_solid_allreduce_any(false);
  interrupted = voltage_V > 0 && dea_solid_rank() > 0;
  return DEA_OK;
}

/* A sweep of three points, one rank of which is interrupted: rank 0 prints how it ends. */
static void sweep_interrupted(void)
{
  static const double voltages_V[] = {0, 1, 2};
  const struct dea_model_type type = {.name = "together", .solve = solve_together};
  struct dea_curve curve = {0};
  dea_context_set_interrupt(ctx, &interrupted);
  const struct dea_study_job job = {.type = &type};
  dea_status status = dea_study_add_points(ctx, &job, NULL, voltages_V, 3, &curve);
  if (dea_solid_rank() == 0) {
    printf("%d %zu %d\n", (int)status, curve.count, dea_interrupted(ctx));
  }
  dea_free(ctx, curve.points);
}

/* As a rank: all solve the first cases, the first rank prints. No cases: a sweep is interrupted. */
static int run_as_rank(int cases)
{
  if (dea_context_create(NULL, &ctx) != DEA_OK || dea_solid_start(ctx) != DEA_OK) {
    return 1;
  }
  if (cases == 0) {
    sweep_interrupted();
  }
  for (int k = 0; k < cases; k++) {
    struct answer answer = solve_case(k);
    if (dea_solid_rank() == 0) {
      printf("%d %d", answer.status, answer.modes);
      for (int i = 0; i < SAMPLES; i++) {
        printf(" %.17g", answer.samples[i]);
      }
      puts("");
    }
  }
  dea_solid_stop();
  dea_context_destroy(ctx);
  return 0;
}

static bool have_mpirun(void)
{
  return system("mpirun --version >/dev/null 2>&1") == 0;
}

/* before: what stands before the program on its command line. */
static void read_answers(const char *before, int cases, struct answer *answers)
{
  char line[1200];
  snprintf(line, sizeof line, "%s '%s' ranks %d", before, program, cases);
  FILE *pipe = popen(line, "r");
  assert_non_null(pipe);
  for (int k = 0; k < cases; k++) {
    assert_int_equal(fscanf(pipe, "%d %d", &answers[k].status, &answers[k].modes), 2);
    for (int i = 0; i < SAMPLES; i++) {
      assert_int_equal(fscanf(pipe, "%lf", &answers[k].samples[i]), 1);
    }
  }
  assert_int_equal(fgetc(pipe), '\n');
  assert_int_equal(fgetc(pipe), EOF); // no other rank prints
  assert_int_equal(pclose(pipe), 0);
}

static void compare(const struct answer *many, const struct answer *one, int cases)
{
  for (int k = 0; k < cases; k++) {
    assert_int_equal(many[k].status, one[k].status);
    assert_int_equal(many[k].modes, one[k].modes);
    for (int i = 0; i < SAMPLES && one[k].status == DEA_OK; i++) {
      // a solve ends with steps below 1e-10 of the film's thickness: 4e-15 m at each of 2000 nodes
      double left = strncmp(sample_name[i], "sum ", 4) == 0 ? 1e-11 : 1e-13;
      if (fabs(many[k].samples[i] - one[k].samples[i]) > 1e-7 * fabs(one[k].samples[i]) + left) {
        fail_msg("case %d, %s: %.10g, not %.10g", k, sample_name[i], many[k].samples[i],
                 one[k].samples[i]);
      }
    }
  }
}

/* Same displacements, energy, extremes and inertia to what the solver leaves, and where one rank
 * fails all do. */
TEST(test_ranks_agree)
{
  struct answer one[CASES], two[CASES], three[1];
  if (!have_mpirun()) {
    skip();
  }
  read_answers("", CASES, one);
  read_answers(MPIRUN "-n 2", CASES, two);
  read_answers(MPIRUN "-n 3", 1, three);
  compare(two, one, CASES);
  compare(three, one, 1);
  assert_int_equal(one[DISC].status, DEA_OK);
  assert_true(one[DISC].samples[SAMPLES - 2] > 0);
  assert_true(one[FOUR_FIBRES].samples[5] > 1e-6); // it has gone down
  assert_true(one[SLACK].modes > 1);
  assert_int_equal(one[COUPLED].status, DEA_OK);
  assert_int_equal(one[COUPLED].modes, 0);
  assert_int_equal(one[INVERTED].status, DEA_E_INVERTED);
}

/* An interruption of one rank, between two points, ends the sweep of all at the same point: else
 * the others wait for it in the next one (and `timeout` ends this test). */
TEST(test_one_rank_interrupted)
{
  char line[1200];
  int status, told;
  size_t points;
  if (!have_mpirun()) {
    skip();
  }
  snprintf(line, sizeof line, MPIRUN "-n 2 '%s' ranks 0", program);
  FILE *pipe = popen(line, "r");
  assert_non_null(pipe);
  assert_int_equal(fscanf(pipe, "%d %zu %d", &status, &points, &told), 3);
  pclose(pipe);
  assert_int_equal(status, DEA_E_INTERRUPTED);
  assert_int_equal(points, 2);
  assert_int_equal(told, 1);
}

/* A factor that finds no room is a failure, not a solution of something else. */
TEST(test_no_room_for_the_factor)
{
  struct answer one[1];
  read_answers("PETSC_OPTIONS='-mat_mumps_icntl_14 -60'", 1, one);
  assert_int_equal(one[0].status, DEA_E_MEMORY);
}

/* ---- the command ---- */

/* Electrode stretch at the last point of a summary; asserts that it is one JSON text and complete.
 */
static double last_stretch(const char *text)
{
  json_t *root = json_loads(text, 0, NULL);
  const json_t *points = json_object_get(root, "points");
  assert_non_null(root);
  assert_true(json_is_true(json_object_get(root, "complete")));
  const json_t *last = json_array_get(points, json_array_size(points) - 1);
  double stretch = json_number_value(json_object_get(last, "electrode_stretch"));
  json_decref(root);
  return stretch;
}

/* dea run under mpirun: said and written once. */
TEST(test_command_on_ranks)
{
  static const char *const run = "run @/examples/plain-disc.yaml --model 3d --no-figures -o both "
                                 "--json --set 'compute.voltage={values: [0 kV, 2 kV]}'";
  char again[400];
  if (!have_mpirun()) {
    skip();
  }
  assert_int_equal(command_run(run), 0);
  double one = last_stretch(command_out);
  assert_true(one > 1.01);
  command_before = MPIRUN "-n 2";
  snprintf(again, sizeof again, "%s --set title=Other", run);
  assert_int_not_equal(command_run(again), 0); // another's folder: said once, and no rank waits
  assert_contains(command_err, "--force");
  assert_null(strstr(strstr(command_err, "--force") + 1, "--force"));
  snprintf(again, sizeof again, "%s --force", run);
  assert_int_equal(command_run(again), 0);
  assert_close(last_stretch(command_out), one, 1e-9, 0);
  command_before = "";
  static char written[COMMAND_TEXT_MAX];
  command_read("both/summary.json", written);
  assert_string_equal(written, command_out);
}

int main(int argc, char **argv)
{
  program = argv[0];
  if (argc > 2 && strcmp(argv[1], "ranks") == 0) {
    return run_as_rank(atoi(argv[2]));
  }
  return run_all(command_set_up, command_tear_down);
}
