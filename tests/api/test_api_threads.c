/* Two threads with a context each, whose first 3D runs coincide. */
// ctest: solid
#include <dea.h>

#include "testing.h"

#include <pthread.h>
#include <stdbool.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { THREADS = 2, PROCESSES = 4, POINTS = 3 };

static const char design_text[] =
    "dea: 1\nfilm: {material: elastosil-2030, thickness: 100 um}\npre_stretch: 1.3\n"
    "frame: {inner_diameter: 40 mm}\nelectrodes: {diameter: 20 mm stretched}\n"
    "fibres: {count: 4, width: 0.4 mm, thickness: 100 um, length: 10 mm stretched, material: pet}\n"
    "compute: {models: [3d], voltage: {values: [0 kV, 1 kV, 2 kV]}, solid: {film: membrane}}\n";

struct work {
  pthread_barrier_t *barrier; // NULL: alone
  double traction_Pa;         // on a block beside the run
  double z_m[POINTS], force_N;
  bool good;
};

/* A block of its own that is pulled, through the other door. */
static bool pull(dea_context *ctx, struct work *work)
{
  static const double low[3] = {0, 0, 0}, high[3] = {1e-3, 1e-3, 1e-3}, none[3] = {0, 0, 0};
  const double foot[3] = {1e-3, 1e-3, 0}, top[3] = {0, 0, 1e-3};
  const double traction[3] = {0, 0, work->traction_Pa};
  dea_part part = DEA_PART_INIT;
  part.young_modulus_Pa = 1e6;
  part.poisson_ratio = 0.3;
  const dea_part *parts = &part;
  dea_solid_options options = DEA_SOLID_OPTIONS_INIT;
  memcpy(options.box_m, high, sizeof high);
  options.elements[0] = options.elements[1] = options.elements[2] = 1;
  options.parts = &parts;
  options.part_count = 1;
  dea_solid *solid = NULL;
  const dea_array *force = NULL;
  bool good = dea_solid_new(ctx, &options, &solid) == DEA_OK &&
              dea_solid_hold(ctx, solid, low, foot, 7, none) == DEA_OK &&
              dea_solid_pull(ctx, solid, top, high, traction) == DEA_OK &&
              dea_solid_solve(ctx, solid, 0) == DEA_OK &&
              dea_solid_array(ctx, solid, "reaction_N", &force) == DEA_OK;
  work->force_N = 0;
  for (size_t i = 0; good && i < force->shape[0]; i++) {
    work->force_N += force->data[3 * i + 2];
  }
  dea_solid_free(solid);
  return good;
}

static bool compute(dea_context *ctx, struct work *work)
{
  static const char *const studies[] = {"sweep"};
  dea_run_options options = DEA_RUN_OPTIONS_INIT;
  options.studies = studies;
  options.study_count = 1;
  dea_design *design = NULL;
  dea_result *result = NULL;
  const dea_array *z = NULL;
  bool good = dea_design_parse(ctx, design_text, "d.yaml", &design) == DEA_OK;
  if (work->barrier != NULL) {
    pthread_barrier_wait(work->barrier);
  }
  good = good && dea_run(ctx, design, &options, &result) == DEA_OK &&
         dea_result_array(ctx, result, "3d/sweep/lowest_z_m", &z) == DEA_OK &&
         z->shape[0] == POINTS && pull(ctx, work);
  if (good) {
    memcpy(work->z_m, z->data, sizeof work->z_m);
  }
  dea_result_free(result);
  dea_design_free(design);
  return good;
}

static void *run(void *user)
{
  struct work *work = user;
  dea_context *ctx;
  work->good = dea_context_new(NULL, &ctx) == DEA_OK;
  if (work->good) {
    work->good = compute(ctx, work);
    if (!work->good) {
      print_error("%s\n", dea_error_message(ctx));
    }
    dea_context_free(ctx);
  }
  return NULL;
}

/* In a process of its own: 0 where the threads have the numbers of a thread alone, to the bit. */
static int compare(void)
{
  pthread_barrier_t barrier;
  pthread_t threads[THREADS];
  struct work works[THREADS];
  pthread_barrier_init(&barrier, NULL, THREADS);
  for (int i = 0; i < THREADS; i++) {
    works[i] = (struct work){.barrier = &barrier, .traction_Pa = 1e3 * (i + 1)};
    if (pthread_create(&threads[i], NULL, run, &works[i]) != 0) {
      return 3;
    }
  }
  for (int i = 0; i < THREADS; i++) {
    pthread_join(threads[i], NULL);
  }
  int code = 0;
  for (int i = 0; i < THREADS; i++) {
    struct work alone = {.traction_Pa = works[i].traction_Pa};
    run(&alone);
    const bool same = works[i].good && alone.good && alone.z_m[POINTS - 1] != alone.z_m[0] &&
                      memcmp(works[i].z_m, alone.z_m, sizeof alone.z_m) == 0 &&
                      works[i].force_N == alone.force_N;
    code = same ? code : 1;
  }
  return code;
}

TEST(test_first_runs_at_once)
{
  for (int i = 0; i < PROCESSES; i++) {
    int code = 0;
    const pid_t child = fork();
    if (child == 0) {
      _exit(compare());
    }
    assert_true(child > 0 && waitpid(child, &code, 0) == child);
    assert_true(WIFEXITED(code));
    assert_int_equal(WEXITSTATUS(code), 0);
  }
}

TESTS(NULL, NULL)
