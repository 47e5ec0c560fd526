/* Rigid bodies: energy, forces and tangent against each other at large turns, closed forms, a part
 * that is a million times stiffer. */
// ctest: solid
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/load/loads.h"
#include "model/solid/motion/time.h"
#include "solid_block.h"

#include "solid_fixture.h"

#include <stdlib.h>
#include <string.h>

static const struct block bar = {{2, 1, 1}, {3, 1, 1}, 2, 2};
static const double elastic[] = {2e5, 0.3}, stiff[] = {2e11, 0.3}, no_width_change[] = {2e5, 0};
enum { SHIFTS = 1 | 2 | 4, TURNS = 8 | 16 | 32, ALL = SHIFTS | TURNS, BODIES_MAX = 2 };

/* A bar whose nodes follow bodies as `of` says (1, 2; 0: none). */
struct bodies {
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_body body[BODIES_MAX];
  struct dea_solid_report report;
};

static struct bodies bodies_create(const struct block *block,
                                   const struct dea_part_material *layers, size_t layer_count,
                                   size_t count, const double X0[BODIES_MAX][3], int held,
                                   int (*of)(const double X[3]),
                                   int (*support)(const void *self, const double X[3]),
                                   int (*layer_of)(const void *self, int region, int ply))
{
  struct bodies it = {.grid = block_grid(ctx, block)};
  for (size_t k = 0; k < count; k++) {
    const double twice[6] = {X0[k][0], X0[k][1], X0[k][2], X0[k][0], X0[k][1], X0[k][2]};
    it.body[k].held = held;
    assert_int_equal(dea_grid_add_nodes(ctx, it.grid, 2, twice, &it.body[k].node), DEA_OK);
  }
  int *follows = dea_alloc(ctx, it.grid->node_count, sizeof *follows);
  assert_non_null(follows);
  for (size_t n = 0; n < it.grid->node_count - 2 * count; n++) {
    follows[n] = of(it.grid->X + 3 * n);
  }
  for (size_t e = 0; e < it.grid->element_count && layer_of != NULL; e++) { // the last third
    it.grid->region[e] = it.grid->X[3 * it.grid->nodes[e * DEA_HEX_NODES_MAX]] > 1;
  }
  const struct dea_solid_options options = {.order_z = block->order_z,
                                            .part_material_count = layer_count,
                                            .part_materials = layers,
                                            .part_material_of = layer_of,
                                            .held = support,
                                            .body_count = count,
                                            .bodies = it.body,
                                            .body_of = follows};
  assert_int_equal(dea_solid_create(ctx, it.grid, &options, &it.solid), DEA_OK);
  dea_free(ctx, follows);
  return it;
}

static void bodies_destroy(struct bodies *it)
{
  dea_solid_destroy(ctx, it->solid);
  dea_grid_destroy(ctx, it->grid);
}

static void solve(struct bodies *it)
{
  assert_int_equal(dea_load_steps_solve(ctx, it->solid, 0, &it->report), DEA_OK);
  assert_close(it->report.load_factor, 1, 0, 0);
}

static int free_nodes(const void *self, const double X[3])
{
  return 0;
}

/* The last third of the bar, and a part of the section at the end of the first: elements between
 * them touch both. */
static int third_and_part(const double X[3])
{
  bool section = fabs(X[0] - 2. / 3) < 1e-9 && X[1] < 0.6 && X[2] < 0.6;
  return X[0] > 4. / 3 - 1e-9 ? 1 : section ? 2 : 0;
}

static const double two_centres[BODIES_MAX][3] = {{1.7, 0.4, 0.5}, {0.6, 0.3, 0.1}};
static const double shifts[BODIES_MAX][3] = {{0.2, 0.1, -0.15}, {0.02, -0.01, 0.03}};
static const double turns[BODIES_MAX][3] = {{0.9, -0.5, 0.4}, {-0.1, 0.15, 0.2}};

static struct bodies two_bodies(void)
{
  struct dea_part_material layer = dea_part_material_bonded(elastic);
  layer.density_kg_per_m3 = 1000;
  return bodies_create(&bar, &layer, 1, 2, two_centres, 0, third_and_part, clamped, NULL);
}

static void hold_both(struct bodies *it)
{
  for (size_t k = 0; k < 2; k++) {
    assert_int_equal(dea_solid_body_prescribe(ctx, it->solid, k, ALL, shifts[k], turns[k]), DEA_OK);
  }
  solve(it);
}

/* Forces of the supports of both bodies are the slopes of the least energy. */
TEST(test_forces_are_slopes_of_the_energy)
{
  static const double by = 1e-4;
  struct bodies it = two_bodies();
  hold_both(&it);
  double reaction[12], scale = 0;
  for (size_t i = 0; i < 12; i++) {
    reaction[i] = dea_solid_reaction(it.solid)[3 * it.body[0].node + i];
    scale = fmax(scale, fabs(reaction[i]));
  }
  for (size_t i = 0; i < 12; i++) {
    double energy[2];
    size_t node = it.body[0].node + i / 3;
    for (int side = 0; side < 2; side++) {
      double at[3], length[2] = {0};
      for (size_t k = 0; k < 2; k++) { // L from what stands in the turning node
        length[k] = dea_solid_displacement(it.solid)[3 * it.body[k].node + 3] / turns[k][0];
      }
      for (size_t c = 0; c < 3; c++) {
        size_t k = i / 6;
        at[c] = i % 6 < 3 ? shifts[k][c] : length[k] * turns[k][c];
        at[c] += c == i % 3 ? (side == 0 ? -by : by) : 0;
      }
      assert_int_equal(dea_solid_prescribe(ctx, it.solid, node, 7, at), DEA_OK);
      solve(&it);
      energy[side] = it.report.energy_J;
      hold_both(&it);
    }
    assert_close((energy[1] - energy[0]) / (2 * by), reaction[i], 0, 2e-7 * scale);
  }
  bodies_destroy(&it);
}

/* Forces and moments of all supports about the origin are in equilibrium: the moments are those of
 * a body, not what is conjugate to the rotation vector. */
TEST(test_forces_and_moments_balance)
{
  struct bodies it = two_bodies();
  hold_both(&it);
  double force[3] = {0}, moment[3] = {0}, scale = 0;
  for (size_t n = 0; n < it.body[0].node; n++) {
    const double *X = it.grid->X + 3 * n, *f = dea_solid_reaction(it.solid) + 3 * n;
    for (int i = 0; i < 3; i++) { // clamped nodes: they are where they were
      int j = (i + 1) % 3, k = (i + 2) % 3;
      force[i] += f[i];
      moment[i] += X[j] * f[k] - X[k] * f[j];
      scale += fabs(f[i]);
    }
  }
  for (size_t b = 0; b < 2; b++) {
    double f[3], m[3], x[3], t[3], w[3];
    dea_solid_body_reaction(it.solid, b, f, m);
    dea_solid_body_place(it.solid, b, t, w);
    for (int i = 0; i < 3; i++) {
      assert_close(t[i], shifts[b][i], 0, 1e-14);
      assert_close(w[i], turns[b][i], 0, 1e-14);
      x[i] = two_centres[b][i] + t[i];
    }
    for (int i = 0; i < 3; i++) {
      int j = (i + 1) % 3, k = (i + 2) % 3;
      force[i] += f[i];
      moment[i] += m[i] + x[j] * f[k] - x[k] * f[j];
    }
  }
  for (int i = 0; i < 3; i++) {
    assert_close(force[i], 0, 0, 1e-8 * scale);
    assert_close(moment[i], 0, 0, 1e-8 * scale);
  }
  bodies_destroy(&it);
}

/* Prescribes all that is not clamped, at u + amount v; g: forces that this takes. */
static void force_beside(struct bodies *it, const double *u, const double *v, double amount,
                         double *g)
{
  for (size_t n = 0; n < it->grid->node_count; n++) {
    const double *X = it->grid->X + 3 * n;
    double at[3];
    for (size_t i = 0; i < 3; i++) {
      at[i] = u[3 * n + i] + amount * v[3 * n + i];
    }
    if (n >= it->body[0].node || (third_and_part(X) == 0 && clamped(NULL, X) == 0)) {
      assert_int_equal(dea_solid_prescribe(ctx, it->solid, n, 7, at), DEA_OK);
    }
  }
  solve(it);
  memcpy(g, dea_solid_reaction(it->solid), 3 * it->grid->node_count * sizeof *g);
}

/* Where bodies are held at large turns the tangent of what is free without that is the slope of all
 * forces: modes v of K v = lambda B v, v . B v = 1, have w . (dg/du v) = lambda w . B v. */
TEST(test_tangent_is_slope_of_forces)
{
  enum { MODES = 10 };
  static const double by = 1e-5;
  struct bodies it = two_bodies();
  size_t dofs = 3 * it.grid->node_count;
  double value[MODES], largest = 0;
  double *vector = dea_alloc(ctx, MODES * dofs, sizeof *vector);
  double *u = dea_alloc(ctx, 3 * dofs, sizeof *u), *high = u + dofs, *low = high + dofs;
  hold_both(&it);
  memcpy(u, dea_solid_displacement(it.solid), dofs * sizeof *u);
  for (size_t k = 0; k < 2; k++) {
    assert_int_equal(dea_solid_body_release(ctx, it.solid, k, ALL), DEA_OK);
  }
  assert_ok(dea_solid_modes_lowest(ctx, it.solid, DEA_MODES_BY_VOLUME, MODES, value, vector));
  for (int m = 0; m < MODES; m++) {
    largest = fmax(largest, fabs(value[m]));
  }
  for (size_t m = 0; m < MODES; m++) {
    double *v = vector + m * dofs;
    force_beside(&it, u, v, by, high);
    force_beside(&it, u, v, -by, low);
    for (size_t o = 0; o < MODES; o++) {
      double product = 0;
      for (size_t i = 0; i < dofs; i++) {
        product += vector[o * dofs + i] * (high[i] - low[i]) / (2 * by);
      }
      assert_close(product, m == o ? value[m] : 0, 0, 1e-7 * largest);
    }
  }
  dea_free(ctx, vector);
  dea_free(ctx, u);
  bodies_destroy(&it);
}

/* Of the same, with the forces that hold the bodies still at work: squares of frequencies, which
 * elements, loads and bodies are asked for, are where the negative pivots of K - x M change. */
TEST(test_frequencies_are_where_pivots_change)
{
  enum { MODES = 8 };
  static const double beside = 1e-8;
  struct bodies it = two_bodies();
  double square[MODES];
  hold_both(&it);
  for (size_t k = 0; k < 2; k++) {
    assert_int_equal(dea_solid_body_release(ctx, it.solid, k, ALL), DEA_OK);
  }
  assert_ok(dea_solid_modes_lowest(ctx, it.solid, DEA_MODES_BY_MASS, MODES, square, NULL));
  for (size_t m = 0; m < MODES; m++) {
    for (size_t above = 0; above < 2; above++) {
      const double x = square[m] + (above == 1 ? beside : -beside) * fabs(square[m]);
      size_t count;
      assert_int_equal(dea_solid_modes_below(ctx, it.solid, DEA_MODES_BY_MASS, x, &count), DEA_OK);
      assert_int_equal(count, m + above);
    }
  }
  bodies_destroy(&it);
}

/* ---- invariance ---- */

/* R of a rotation vector, and back. */
static void rotation_of(const double w[3], double R[9])
{
  double angle = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  const double n[3] = {w[0] / angle, w[1] / angle, w[2] / angle};
  const double cross[9] = {0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0};
  for (int i = 0; i < 9; i++) {
    R[i] = (i % 4 == 0 ? cos(angle) : 0) + sin(angle) * cross[i] +
           (1 - cos(angle)) * n[i / 3] * n[i % 3];
  }
}

/* ---- closed forms ---- */

static int end_of_bar(const double X[3])
{
  return X[0] > 2 - 1e-9;
}

/* A bar that keeps its width, its end on a body that only shifts: pulled to a place, then by the
 * force that this took. W = mu/2 (I1 - 3 - 2 ln J). */
TEST(test_body_that_only_shifts)
{
  static const double end[BODIES_MAX][3] = {{2, 0, 0}}, stretch = 1.7, mu = 1e5;
  const struct dea_part_material layer = dea_part_material_bonded(no_width_change);
  struct bodies it =
      bodies_create(&bar, &layer, 1, 1, end, 2 | 4 | TURNS, end_of_bar, on_planes, NULL);
  double force[3], moment[3], t[3], w[3];
  const double way[3] = {2 * (stretch - 1), 0, 0}, none[3] = {0};
  assert_int_equal(dea_solid_body_prescribe(ctx, it.solid, 0, 1, way, none), DEA_OK);
  solve(&it);
  dea_solid_body_reaction(it.solid, 0, force, moment);
  assert_close(force[0], mu * (stretch - 1 / stretch), 1e-9, 0);
  assert_int_equal(dea_solid_body_release(ctx, it.solid, 0, 1), DEA_OK);
  dea_solid_body_push(it.solid, 0, none, none);
  solve(&it);
  dea_solid_body_push(it.solid, 0, force, none);
  solve(&it);
  assert_true(it.report.unstable_modes == 0 && it.report.residual < 1e-8);
  dea_solid_body_place(it.solid, 0, t, w);
  assert_close(t[0], way[0], 1e-9, 0);
  assert_close(fabs(t[1]) + fabs(t[2]) + fabs(w[0]) + fabs(w[1]) + fabs(w[2]), 0, 0, 0);
  bodies_destroy(&it);
}

static int whole_block(const double X[3])
{
  return 1;
}

static int by_size(const void *a, const void *b)
{
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* A rigid block without mass on six springs, one for each component, which carries four masses that
 * follow it without an element: its vibrations, and how far a force and a moment move it. */
TEST(test_springs_and_point_masses)
{
  static const double k[6] = {3e3, 5e3, 7e3, 200, 300, 500}, mass = 0.4, a = 0.6, b = 0.5,
                      none[3] = {0};
  static const double force[3] = {300, 0, 0}, moment[3] = {0, 0, 100};
  const double points[18] = {1, 1, 1, 1, 1, 1, 1 + a, 1, 1, 1 - a, 1, 1, 1, 1 + b, 1, 1, 1 - b, 1};
  const struct dea_part_material layer = dea_part_material_bonded(elastic);
  struct dea_grid *grid = block_grid(ctx, &bar);
  struct dea_solid_body body = {.length_m = 2};
  struct dea_arena memory = {.ctx = ctx};
  struct dea_spring *springs[6];
  struct dea_solid *solid;
  struct dea_solid_report report;
  double found[6], t[3], w[3];
  assert_int_equal(dea_grid_add_nodes(ctx, grid, 6, points, &body.node), DEA_OK);
  int *follows = dea_alloc(ctx, grid->node_count, sizeof *follows);
  double *masses = dea_alloc(ctx, grid->node_count, sizeof *masses);
  for (size_t n = 0; n < grid->node_count; n++) {
    follows[n] = n != body.node && n != body.node + 1;
    masses[n] = n >= body.node + 2 ? mass / 4 : 0;
  }
  const struct dea_solid_options options = {.order_z = bar.order_z,
                                            .part_material_count = 1,
                                            .part_materials = &layer,
                                            .held = free_nodes,
                                            .body_count = 1,
                                            .bodies = &body,
                                            .body_of = follows,
                                            .point_mass_kg = masses};
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
  for (int i = 0; i < 6; i++) {
    const struct dea_spring_options one = {.node = body.node + (size_t)i / 3,
                                           .component = i % 3,
                                           .unit_m = i < 3 ? 1 : body.length_m,
                                           .stiffness = k[i]};
    assert_int_equal(dea_spring_create(ctx, &one, &memory, &springs[i]), DEA_OK);
    const struct dea_solid_load load = dea_spring_load(springs[i]);
    assert_int_equal(dea_solid_add_load(ctx, solid, &load), DEA_OK);
  }
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
  double wanted[6] = {k[0] / mass,
                      k[1] / mass,
                      k[2] / mass,
                      k[3] / (mass * b * b / 2),
                      k[4] / (mass * a * a / 2),
                      k[5] / (mass * (a * a + b * b) / 2)};
  qsort(wanted, 6, sizeof *wanted, by_size);
  assert_int_equal(dea_solid_modes_lowest(ctx, solid, DEA_MODES_BY_MASS, 6, found, NULL), DEA_OK);
  for (int i = 0; i < 6; i++) {
    assert_close(found[i], wanted[i], 1e-9, 0);
  }
  dea_solid_body_push(solid, 0, force, moment);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
  dea_solid_body_place(solid, 0, t, w);
  assert_close(t[0], force[0] / k[0], 1e-9, 0);
  assert_close(w[2], moment[2] / k[5], 1e-9, 0);
  dea_solid_body_push(solid, 0, none, none);
  dea_spring_move(springs[0], 0.25);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
  dea_solid_body_place(solid, 0, t, w);
  assert_close(t[0], 0.25, 1e-9, 0);
  assert_close(w[2], 0, 0, 1e-9);
  dea_solid_destroy(ctx, solid);
  dea_arena_free(&memory);
  dea_free(ctx, follows);
  dea_free(ctx, masses);
  dea_grid_destroy(ctx, grid);
}

/* ---- large turns in time ---- */

/* Turn R and angular velocity along the axes of the block after a time, by Euler's equations. */
static void euler(const double J[3], double time_s, double R[9], double O[3])
{
  enum { STEPS = 4000 };
  double h = time_s / STEPS;
  for (int n = 0; n < STEPS; n++) {
    double sum[12] = {0}, at[12], k[12] = {0};
    for (int stage = 0; stage < 4; stage++) {
      double way = stage == 0 ? 0 : stage == 3 ? h : h / 2, share = stage % 3 == 0 ? 1 : 2;
      for (int i = 0; i < 12; i++) {
        at[i] = (i < 9 ? R[i] : O[i - 9]) + way * k[i];
      }
      const double *w = at + 9;
      const double cross[9] = {0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0};
      for (int i = 0; i < 9; i++) { // R' = R [O x]
        k[i] = 0;
        for (int a = 0; a < 3; a++) {
          k[i] += at[3 * (i / 3) + a] * cross[3 * a + i % 3];
        }
      }
      for (int i = 0; i < 3; i++) {
        int a = (i + 1) % 3, b = (i + 2) % 3;
        k[9 + i] = (J[a] - J[b]) / J[i] * w[a] * w[b];
      }
      for (int i = 0; i < 12; i++) {
        sum[i] += share * h / 6 * k[i];
      }
    }
    for (int i = 0; i < 9; i++) {
      R[i] += sum[i];
    }
    for (int i = 0; i < 3; i++) {
      O[i] += sum[9 + i];
    }
  }
}

/* Largest entry that the turn of a block that tumbles freely is off by, after so many steps. */
static double tumble(int steps, double radius, double *energy_error)
{
  static const double middle[BODIES_MAX][3] = {{1, 0.5, 0.5}}, spin[3] = {0.9, -1.1, 0.8};
  static const double rho = 700, a = 2, b = 1, h = 1, time_s = 1.5;
  const double m = rho * a * b * h;
  const double J[3] = {m * (b * b + h * h) / 12, m * (a * a + h * h) / 12,
                       m * (a * a + b * b) / 12};
  struct dea_part_material layer = dea_part_material_bonded(elastic);
  layer.density_kg_per_m3 = rho;
  struct bodies it = bodies_create(&bar, &layer, 1, 1, middle, 0, whole_block, free_nodes, NULL);
  const struct dea_spring_options none = {.node = it.body[0].node};
  const struct dea_solid_time_options options = {.inertia = true, .spectral_radius = radius};
  struct dea_arena memory = {.ctx = ctx};
  struct dea_spring *spring;
  struct dea_solid_time *time;
  assert_int_equal(dea_spring_create(ctx, &none, &memory, &spring), DEA_OK);
  const struct dea_solid_load load = dea_spring_load(spring);
  assert_int_equal(dea_solid_add_load(ctx, it.solid, &load), DEA_OK);
  assert_int_equal(dea_solid_time_create(ctx, it.solid, &options, &time), DEA_OK);
  double *v = dea_solid_velocity(time), L = sqrt(1 + 0.25 + 0.25);
  for (size_t n = 0; n < it.body[0].node; n++) {
    for (size_t i = 0; i < 3; i++) {
      size_t j = (i + 1) % 3, k = (i + 2) % 3;
      const double *X = it.grid->X + 3 * n;
      v[3 * n + i] = spin[j] * (X[k] - middle[0][k]) - spin[k] * (X[j] - middle[0][j]);
    }
  }
  for (size_t i = 0; i < 3; i++) {
    v[3 * it.body[0].node + 3 + i] = L * spin[i];
  }
  double first =
      0.5 * (J[0] * spin[0] * spin[0] + J[1] * spin[1] * spin[1] + J[2] * spin[2] * spin[2]);
  assert_int_equal(dea_solid_time_jump(ctx, time, 0, &it.report), DEA_OK);
  assert_int_equal(dea_solid_time_close(ctx, time, NULL), DEA_OK);
  dea_solid_time_accept(time);
  for (int i = 0; i < steps; i++) {
    assert_int_equal(dea_solid_time_step(ctx, time, 0, time_s / steps, &it.report), DEA_OK);
    assert_int_equal(dea_solid_time_close(ctx, time, NULL), DEA_OK);
    dea_solid_time_accept(time);
  }
  double R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, O[3] = {spin[0], spin[1], spin[2]}, S[9], t[3], w[3];
  euler(J, time_s, R, O);
  dea_solid_body_place(it.solid, 0, t, w);
  rotation_of(w, S);
  double most = 0;
  for (int i = 0; i < 9; i++) {
    most = fmax(most, fabs(R[i] - S[i]));
  }
  *energy_error = dea_solid_time_energies(time, false).kinetic / first - 1;
  dea_solid_time_destroy(ctx, time);
  bodies_destroy(&it);
  dea_arena_free(&memory);
  return most;
}

/* Twice the steps, a fourth of the error, with and without damping by the steps. */
TEST(test_tumbling_block)
{
  static const double radius[2] = {1, 0.6};
  for (int i = 0; i < 2; i++) {
    double energy[2];
    double off[2] = {tumble(20, radius[i], &energy[0]), tumble(40, radius[i], &energy[1])};
    assert_true(off[1] < 3e-3 && fabs(energy[1]) < 5e-3);
    assert_close(off[0] / off[1], 4, 0.1, 0);
  }
}

/* ---- a part that is a million times stiffer ---- */

static int last_third(const double X[3])
{
  return X[0] > 4. / 3 - 1e-9;
}

static int none_follows(const double X[3])
{
  return 0;
}

/* Bent and twisted by a dead force on a corner, the end of a bar moves alike whether it is rigid or
 * elastic and that much stiffer; turns of 20 degrees. */
TEST(test_stiff_part)
{
  static const double centre[BODIES_MAX][3] = {{1.5, 0.5, 0.5}}, corner[3] = {2, 1, 1};
  static const double force[3] = {1e3, 5e3, -8e3};
  const struct dea_part_material layers[2] = {dea_part_material_bonded(elastic),
                                              dea_part_material_bonded(stiff)};
  struct bodies rigid =
      bodies_create(&bar, layers, 2, 1, centre, 0, last_third, clamped, layer_of_region);
  struct bodies soft =
      bodies_create(&bar, layers, 2, 0, centre, 0, none_follows, clamped, layer_of_region);
  size_t node = dea_grid_nearest(soft.grid, corner);
  memcpy(dea_solid_force(rigid.solid) + 3 * node, force, sizeof force);
  memcpy(dea_solid_force(soft.solid) + 3 * node, force, sizeof force);
  solve(&rigid);
  solve(&soft);
  const double *u = dea_solid_displacement(rigid.solid), *v = dea_solid_displacement(soft.solid);
  double most = 0, apart = 0, t[3], w[3];
  for (size_t i = 0; i < 3 * soft.grid->node_count; i++) {
    most = fmax(most, fabs(v[i]));
    apart = fmax(apart, fabs(u[i] - v[i]));
  }
  dea_solid_body_place(rigid.solid, 0, t, w);
  assert_true(sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) > 0.2);
  assert_close(apart / most, 0, 0, 1e-5);
  bodies_destroy(&rigid);
  bodies_destroy(&soft);
}

/* ---- what cannot be ---- */

TESTS(solid_set_up, solid_tear_down)
