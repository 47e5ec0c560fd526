/* Solids that cannot be solved: each says why and where. */
// ctest: solid
#include "model/solid/assembly/solid.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "solid_block.h"
#include "testing.h"
#include "yeoh_part.h"

#include "solid_fixture.h"

#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static void map_square(const void *self, double s, double t, double x[2])
{
  x[0] = 1e-2 * s;
  x[1] = 1e-2 * t;
}

/* self: bits held at the edges x = 0 and x = 1 cm, of all nodes there. */
static int held_at_ends(const void *self, const double X[3])
{
  const int *bits = self;
  return X[0] < 1e-9 ? bits[0] : X[0] > 1e-2 - 1e-9 ? bits[1] : 0;
}

static struct dea_grid *grid;
static struct dea_solid *solid;
static const struct dea_solid_settings *settings; // NULL: the default ones

static dea_status solve(const struct dea_part_material *layer, const int *bits, double voltage_V)
{
  static const double cuts[] = {0, 0.5, 1};
  const struct dea_block block = {map_square, NULL, cuts, cuts, 2, 2, 0};
  const struct dea_ply ply = {1e-3, 1, 2};
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = 1,
                                            .part_materials = layer,
                                            .active = everywhere,
                                            .held = held_at_ends,
                                            .self = bits,
                                            .settings = settings};
  struct dea_solid_report report;
  if (grid == NULL) {
    assert_int_equal(dea_grid_create(ctx, 2, &block, 1, &ply, 1, NULL, 0, 1e-2, &grid), DEA_OK);
  }
  DEA_TRY(ctx, dea_solid_create(ctx, grid, &options, &solid));
  return dea_load_steps_solve(ctx, solid, voltage_V, &report);
}

static void clear(void)
{
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
  grid = NULL;
  solid = NULL;
}

static struct dea_part_material film(void)
{
  return yeoh_part(1, 2.5e-11, 1e-3);
}

static void expect(const char *part)
{
  if (strstr(dea_context_message(ctx), part) == NULL) {
    fail_msg("'%s' is not in '%s'", part, dea_context_message(ctx));
  }
}

TEST(test_unconstrained_bodies)
{
  const struct dea_part_material layer = film();
  static const int free_ends[] = {0, 0}, slides[] = {1, 1 | 4}, turns[] = {4, 4}, held[] = {7, 0};
  const int *const loose[] = {free_ends, slides, turns};
  for (size_t i = 0; i < 3; i++) {
    assert_int_equal(solve(&layer, loose[i], 0), DEA_E_ARGUMENT);
    expect("is not held");
    clear();
  }
  assert_int_equal(solve(&layer, held, 0), DEA_OK);
  clear();
}

TEST(test_inverted_element)
{
  const struct dea_part_material layer = film();
  static const int held[] = {7, 7};
  assert_int_equal(solve(&layer, held, 0), DEA_OK);
  struct dea_grid *folded = grid;
  dea_solid_destroy(ctx, solid);
  for (size_t n = 0; n < folded->node_count; n++) { // the middle of the plate far out
    double *X = folded->X + 3 * n;
    if (fabs(X[0] - 5e-3) < 1e-9 && fabs(X[1] - 5e-3) < 1e-9) {
      X[0] = 9e-3;
    }
  }
  assert_int_equal(solve(&layer, held, 0), DEA_E_ARGUMENT);
  expect("is inverted in the mesh");
  clear();
}

TEST(test_law_that_ends)
{
  struct dea_part_material layer = film();
  static const int held[] = {7, 7};
  dea_part_material_set_law(&layer, dea_law_find("gent"), (const double[]){100e3, 3}); // I1 - 3 < 3
  layer.pre_stretch[0] = layer.pre_stretch[1] = 2;
  layer.pre_stretch[2] = 0.25;
  assert_int_equal(solve(&layer, held, 0), DEA_E_DOMAIN);
  expect("'gent' ends before the pre-stretch 2");
  clear();
}

/* Held at one end only, the film pulls in; a law that does not stiffen has no state beyond. The
 * state before stays. */
TEST(test_voltage_beyond_any_equilibrium)
{
  struct dea_part_material layer = film();
  dea_part_material_set_law(&layer, dea_law_find("neo-hookean"), (const double[]){356.8e3});
  assert_int_equal(dea_part_material_relax(&layer), DEA_OK);
  static const int held[] = {7, 0};
  struct dea_solid_report report;
  assert_int_equal(solve(&layer, held, 20e3), DEA_OK);
  double *u = dea_solid_displacement(solid);
  double before = u[3 * (grid->node_count - 1)];
  assert_true(before > 0);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 400e3, &report), DEA_E_NOT_CONVERGED);
  assert_true(u[3 * (grid->node_count - 1)] >= before); // as far as it got
  clear();
}

/* Address space of this process [bytes]. */
static rlim_t address_space(void)
{
  unsigned long pages = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  if (file == NULL || fscanf(file, "%lu", &pages) != 1) {
    pages = 0;
  }
  if (file != NULL) {
    fclose(file);
  }
  return pages * (rlim_t)sysconf(_SC_PAGESIZE);
}

/* Memory that runs out, in PETSc or MUMPS, is called that, whatever there is of it. */
TEST(test_memory_that_runs_out)
{
  if (SANITIZED) {
    skip(); // the address space is taken
  }
  enum { CUTS = 25 };
  const struct dea_part_material layer = film();
  static const int held[] = {7, 7};
  double cuts[CUTS];
  for (int i = 0; i < CUTS; i++) {
    cuts[i] = i / (CUTS - 1.0);
  }
  const struct dea_block block = {map_square, NULL, cuts, cuts, CUTS - 1, CUTS - 1, 0};
  const struct dea_ply sheet = {1e-3, 1, 2};
  struct rlimit before, small;
  assert_int_equal(dea_grid_create(ctx, 2, &block, 1, &sheet, 1, NULL, 0, 1e-2, &grid), DEA_OK);
  assert_int_equal(getrlimit(RLIMIT_AS, &before), 0);
  small = before;
  rlim_t now = address_space();
  assert_true(now > 0);
  int failed = 0, by_petsc = 0;
  dea_status status = DEA_E_MEMORY;
  for (rlim_t capacity = 8 << 20; status != DEA_OK && capacity < (rlim_t)4 << 30; capacity *= 2) {
    small.rlim_cur = now + capacity;
    assert_int_equal(setrlimit(RLIMIT_AS, &small), 0);
    status = solve(&layer, held, 0);
    assert_int_equal(setrlimit(RLIMIT_AS, &before), 0);
    if (status != DEA_OK) {
      assert_int_equal(status, DEA_E_MEMORY);
      failed++;
      by_petsc += strstr(dea_context_message(ctx), "PETSc") != NULL;
    }
    dea_solid_destroy(ctx, solid);
    solid = NULL;
  }
  assert_int_equal(status, DEA_OK);
  assert_true(failed > 2 && by_petsc > 0);
  clear();
}

static bool after_two(void *user)
{
  int *asked = user;
  return ++*asked > 2;
}

/* An interruption is heard in the middle of a solve, which leaves the solid at its equilibrium. */
TEST(test_interrupted)
{
  const struct dea_part_material layer = film();
  static const int held[] = {7, 7};
  struct dea_solid_report report;
  int asked = 0;
  assert_int_equal(solve(&layer, held, 0), DEA_OK);
  dea_context_set_interrupt_fn(ctx, after_two, &asked);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 5e3, &report), DEA_E_INTERRUPTED);
  expect("interrupted on the way to an equilibrium");
  assert_int_equal(asked, 3); // and not asked on
  assert_true(dea_solid_voltage(solid) == 0);
  const double *u = dea_solid_displacement(solid);
  for (size_t i = 0; i < 3 * grid->node_count; i++) {
    assert_close(u[i], 0, 0, 1e-12);
  }
  dea_context_set_interrupt_fn(ctx, NULL, NULL);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 5e3, &report), DEA_OK);
  assert_true(dea_solid_voltage(solid) == 5e3);
  // before each factor too: one iteration may need many, and one of a large mesh takes seconds
  double softest;
  dea_context_set_interrupt_fn(ctx, after_two, &asked);
  assert_int_equal(dea_solid_modes_lowest(ctx, solid, DEA_MODES_BY_VOLUME, 1, &softest, NULL),
                   DEA_E_INTERRUPTED);
  dea_context_set_interrupt_fn(ctx, NULL, NULL);
  clear();
}

TESTS(solid_set_up, solid_tear_down)
