/* Loads on surfaces: derivatives against differences, forces and distances of tips. */
#include "model/solid/element/hex.h"
#include "model/solid/load/loads.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <stdlib.h>
#include <string.h>

static struct dea_hex_shape shape;
static struct dea_grid *grid;
static double *u;
static struct dea_arena memory; // of surfaces and loads

/* A block of 3 x 2 x 1.5 that is bent and moved by u, about a tenth of its size. */
static const double size[3] = {3, 2, 1.5};

static void map_block(const void *self, double s, double t, double x[2])
{
  x[0] = size[0] * s + 0.2 * t * t;
  x[1] = size[1] * t - 0.1 * s * t;
}

static void block_create(int order, int order_z, double amount)
{
  static const double cuts[] = {0, 0.4, 1};
  const struct dea_block block = {map_block, NULL, cuts, cuts, 2, 2, 7};
  const struct dea_ply ply = {size[2], 2, order_z};
  memory.ctx = ctx;
  assert_int_equal(dea_hex_shape_create(order, order_z, &shape), DEA_OK);
  assert_int_equal(dea_grid_create(ctx, order, &block, 1, &ply, 1, NULL, 0.3, 3, &grid), DEA_OK);
  u = calloc(3 * grid->node_count, sizeof *u);
  assert_non_null(u);
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *X = grid->X + 3 * n;
    u[3 * n] = amount * (sin(X[1]) + 0.3 * X[2]);
    u[3 * n + 1] = amount * (0.5 * X[0] * X[2] - 0.2 * X[1]);
    u[3 * n + 2] = amount * (cos(X[0]) + 0.4 * X[1] * X[2]);
  }
}

static void block_destroy(void)
{
  free(u);
  dea_arena_free(&memory);
  dea_grid_destroy(ctx, grid);
}

static bool all(const void *self, int region, int ply, const double middle[3])
{
  assert_int_equal(region, 7);
  return ply == 0;
}

static struct dea_surface *side_create(enum dea_face side)
{
  struct dea_surface *surface;
  assert_int_equal(dea_surface_create(ctx, grid, side, all, NULL, &memory, &surface), DEA_OK);
  return surface;
}

/* Exact derivatives of each piece, K symmetric. */
static void check_derivatives(const struct dea_solid_load *load)
{
  static struct dea_load_piece at, up, down;
  double d = 1e-6, largest_g = 0, largest_K = 0;
  bool any = false;
  for (size_t p = 0; p < load->piece_count; p++) {
    assert_int_equal(load->evaluate(load->self, p, u, DEA_TANGENT, &at), DEA_OK);
    int dofs = 3 * at.node_count;
    for (int i = 0; i < dofs * dofs; i++) {
      largest_g = fmax(largest_g, fabs(at.g[i / dofs]));
      largest_K = fmax(largest_K, fabs(at.K[i]));
      assert_close(at.K[i], at.K[i % dofs * dofs + i / dofs], 0, 1e-12 * largest_K);
    }
    for (int j = 0; j < dofs; j++) {
      double *v = u + 3 * at.nodes[j / 3] + j % 3, keep = *v;
      *v = keep + d;
      assert_int_equal(load->evaluate(load->self, p, u, DEA_FORCE, &up), DEA_OK);
      *v = keep - d;
      assert_int_equal(load->evaluate(load->self, p, u, DEA_FORCE, &down), DEA_OK);
      *v = keep;
      assert_close(at.g[j], (up.energy_J - down.energy_J) / (2 * d), 0, 1e-7 * largest_g);
      for (int i = 0; i < dofs; i++) {
        assert_close(at.K[i * dofs + j], (up.g[i] - down.g[i]) / (2 * d), 0, 1e-7 * largest_K);
      }
      any = true;
    }
    assert_int_equal(load->evaluate(load->self, p, u, DEA_ENERGY, &up), DEA_OK);
    assert_close(up.energy_J, at.energy_J, 1e-14, 0);
  }
  assert_true(any && largest_g > 0 && largest_K > 0);
}

static void set_parameters(const struct dea_solid_load *load)
{
  memcpy(load->now, load->goal, load->parameter_count * sizeof *load->now);
}

/* Energy of all pieces at u, and their forces [3 nodes]; with a vector the product of the whole
 * tangent with it. */
static double whole_load(const struct dea_solid_load *load, const double *v, double *g, double *Kv)
{
  static struct dea_load_piece at;
  const size_t count = 3 * grid->node_count;
  double energy = 0;
  memset(g, 0, count * sizeof *g);
  load->prepare(load->self, u);
  for (size_t p = 0; p < load->piece_count; p++) {
    assert_ok(load->evaluate(load->self, p, u, v != NULL ? DEA_TANGENT : DEA_FORCE, &at));
    energy += at.energy_J;
    for (int i = 0; i < 3 * at.node_count; i++) {
      g[3 * at.nodes[i / 3] + i % 3] += at.g[i];
      for (int j = 0; v != NULL && j < 3 * at.node_count; j++) {
        Kv[3 * at.nodes[i / 3] + i % 3] +=
            at.K[i * 3 * at.node_count + j] * v[3 * at.nodes[j / 3] + j % 3];
      }
    }
  }
  if (v != NULL) {
    double *slope = calloc(count, sizeof *slope);
    assert_non_null(slope);
    const double stiffness = load->whole(load->self, u, slope);
    const double along = load->along(load->self, u, v);
    for (size_t i = 0; i < count; i++) {
      Kv[i] += stiffness * along * slope[i];
    }
    free(slope);
  }
  return energy;
}

/* The same of a volume, whose pressure all pieces share. */
TEST(test_derivatives_of_enclosed_volumes)
{
  static const struct dea_enclosed enclosed[] = {
      {.volume_m3 = 20, .ambient_Pa = 2},
      {.liquid = true, .volume_m3 = 1e-3, .stiffness_Pa_per_m3 = 5}};
  static const double level[3] = {0, 0, 0.2};
  const double d = 1e-6;
  block_create(2, 2, 0.1);
  const size_t count = 3 * grid->node_count;
  double *capacity = calloc(5 * count, sizeof *capacity);
  assert_non_null(capacity);
  double *v = capacity, *g = v + count, *Kv = g + count, *up = Kv + count, *down = up + count;
  for (size_t i = 0; i < count; i++) {
    v[i] = sin(1.0 + 3.0 * (double)i);
  }
  for (int k = 0; k < 4; k++) {
    struct dea_surface *surface = side_create(k < 2 ? DEA_FACE_TOP : DEA_FACE_BOTTOM);
    struct dea_pressure *pressure;
    double slope = 0, largest = 0;
    assert_int_equal(dea_pressure_create(ctx, surface, level, true, &memory, &pressure), DEA_OK);
    dea_pressure_enclose(pressure, &enclosed[k % 2]);
    dea_pressure_set(pressure, 0.3);
    struct dea_solid_load load = dea_pressure_load(pressure);
    set_parameters(&load);
    memset(Kv, 0, count * sizeof *Kv);
    whole_load(&load, v, g, Kv);
    double energy[2];
    for (int side = 0; side < 2; side++) {
      for (size_t i = 0; i < count; i++) {
        u[i] += (side == 0 ? d : -2 * d) * v[i];
      }
      energy[side] = whole_load(&load, NULL, side == 0 ? up : down, NULL);
    }
    for (size_t i = 0; i < count; i++) {
      u[i] += d * v[i];
      slope += g[i] * v[i];
      largest = fmax(largest, fabs(Kv[i]));
    }
    assert_true(largest > 0);
    assert_close(slope, (energy[0] - energy[1]) / (2 * d), 1e-8, 0);
    for (size_t i = 0; i < count; i++) {
      assert_close(Kv[i], (up[i] - down[i]) / (2 * d), 0, 1e-7 * largest);
    }
  }
  free(capacity);
  block_destroy();
}

TEST(test_derivatives)
{
  static const double origin[3] = {0.1, -0.2, 0.3}, level[3] = {0, 0, 0.2};
  for (int order = 1; order <= 3; order++) {
    block_create(order, order < 3 ? 2 : 1, 0.1);
    for (int side = DEA_FACE_FIRST_LOW; side <= DEA_FACE_TOP; side++) {
      struct dea_surface *surface = side_create((enum dea_face)side);
      struct dea_pressure *pressure;
      assert_int_equal(dea_pressure_create(ctx, surface, origin, false, &memory, &pressure),
                       DEA_OK);
      dea_pressure_set(pressure, 3);
      struct dea_solid_load load = dea_pressure_load(pressure);
      set_parameters(&load);
      check_derivatives(&load);
      assert_int_equal(dea_pressure_create(ctx, surface, level, true, &memory, &pressure), DEA_OK);
      dea_pressure_set(pressure, 3);
      load = dea_pressure_load(pressure);
      set_parameters(&load);
      check_derivatives(&load);
    }
    block_destroy();
  }
}

/* A bistable table and a line: derivatives between the points and beyond them; the energy is the
 * integral of the force, and the force goes through the points without new extremes. */
TEST(test_spring)
{
  enum { POINTS = 6 };
  static const double at[POINTS] = {-1, -0.3, 0.2, 0.9, 1.5, 3};
  static const double force[POINTS] = {-2, 0.5, 0.6, -1.5, -0.2, 4};
  const struct dea_spring_options options[2] = {
      {.node = 3, .component = 1, .place = 0.05, .count = POINTS, .at = at, .force = force},
      {.node = 3, .component = 1, .place = 0.05, .unit_m = 0.5, .stiffness = 7}};
  block_create(1, 1, 0);
  for (int k = 0; k < 2; k++) {
    struct dea_spring *spring;
    double unit = k == 0 ? 1 : 0.5, sum = 0, before = 0;
    static struct dea_load_piece piece, start;
    assert_int_equal(dea_spring_create(ctx, &options[k], &memory, &spring), DEA_OK);
    const struct dea_solid_load load = dea_spring_load(spring);
    for (double y = -1.7; y < 3.9; y += 0.23) {
      u[3 * 3 + 1] = unit * (y + 0.05);
      check_derivatives(&load);
      assert_int_equal(load.evaluate(load.self, 0, u, DEA_FORCE, &piece), DEA_OK);
      assert_close(dea_spring_force(spring, y + 0.05), unit * piece.g[1], 1e-12, 1e-12);
    }
    u[3 * 3 + 1] = unit * (at[0] + 0.05);
    assert_int_equal(load.evaluate(load.self, 0, u, DEA_ENERGY, &start), DEA_OK);
    for (int i = 1; i < POINTS; i++) { // two points of Gauss: exact for cubics
      double middle = 0.5 * (at[i] + at[i - 1]), half = 0.5 * (at[i] - at[i - 1]);
      sum += half * (dea_spring_force(spring, middle - half / sqrt(3) + 0.05) +
                     dea_spring_force(spring, middle + half / sqrt(3) + 0.05));
      u[3 * 3 + 1] = unit * (at[i] + 0.05);
      assert_int_equal(load.evaluate(load.self, 0, u, DEA_ENERGY, &piece), DEA_OK);
      assert_close(piece.energy_J - start.energy_J, sum, 0, 1e-13);
      double wanted = k == 0 ? force[i] : 7 * at[i];
      assert_close(dea_spring_force(spring, at[i] + 0.05), wanted, 1e-13, 1e-13);
      before = dea_spring_force(spring, at[i - 1] + 0.05);
      for (double share = 0.1; share < 1; share += 0.1) {
        double value = dea_spring_force(spring, at[i - 1] + 2 * half * share + 0.05);
        assert_true(value > fmin(before, wanted) - 1e-12 && value < fmax(before, wanted) + 1e-12);
      }
    }
    dea_spring_move(spring, 2);
    set_parameters(&load);
    assert_close(dea_spring_force(spring, 2 + at[1]), k == 0 ? force[1] : 7 * at[1], 1e-12, 0);
  }
  struct dea_spring *spring;
  struct dea_spring_options wrong = options[0];
  wrong.at = force;
  assert_int_equal(dea_spring_create(ctx, &wrong, &memory, &spring), DEA_E_ARGUMENT);
  wrong = options[1];
  wrong.component = 3;
  assert_int_equal(dea_spring_create(ctx, &wrong, &memory, &spring), DEA_E_ARGUMENT);
  wrong = options[1];
  wrong.stiffness = -1;
  assert_int_equal(dea_spring_create(ctx, &wrong, &memory, &spring), DEA_E_ARGUMENT);
  block_destroy();
}

static const struct dea_indenter tips[] = {
    {.shape = DEA_INDENTER_SPHERE, .radius_m = 1},
    {.shape = DEA_INDENTER_FLAT, .radius_m = 0.9, .axis = {0.1, 0.2, 1}, .edge_radius_m = 0.4},
    {.shape = DEA_INDENTER_CYLINDER, .radius_m = 0.7, .axis = {2, 1, 0.2}, .half_length_m = 0.6},
    {.shape = DEA_INDENTER_CYLINDER,
     .radius_m = 0.7,
     .axis = {2, 1, 0.2},
     .half_length_m = INFINITY},
};

/* The tangent at pressures alone, after they have taken over the penalty, is that of before; and
 * those that a small step predicts are those after it, but for its square. */
static void check_prediction(const struct dea_solid_load *load)
{
  static struct dea_load_piece piece;
  enum { ROOM = 400 };
  static double K[ROOM][DEA_PIECE_DOFS_MAX * DEA_PIECE_DOFS_MAX], before[ROOM], after[ROOM],
      predicted[ROOM];
  size_t count = load->multiplier_count, dofs = 3 * grid->node_count, touching = 0;
  double *step = calloc(dofs, sizeof *step);
  assert_true(step != NULL && count < ROOM);
  for (size_t p = 0; p < load->piece_count; p++) {
    assert_int_equal(load->evaluate(load->self, p, u, DEA_TANGENT, &piece), DEA_OK);
    memcpy(K[p], piece.K, sizeof K[p]);
  }
  load->update(load->self, u);
  for (size_t p = 0; p < load->piece_count; p++) {
    assert_int_equal(load->evaluate(load->self, p, u, DEA_TANGENT_PREDICTED, &piece), DEA_OK);
    for (int i = 0; i < 9 * piece.node_count * piece.node_count; i++) {
      assert_close(piece.K[i], K[p][i], 0, 1e-12);
    }
  }
  for (size_t i = 0; i < dofs; i++) {
    step[i] = 1e-6 * sin((double)i);
  }
  memcpy(before, load->multiplier, count * sizeof *before);
  load->predict(load->self, u, step, 1);
  memcpy(predicted, load->multiplier, count * sizeof *predicted);
  memcpy(load->multiplier, before, count * sizeof *before);
  load->predict(load->self, u, step, 0.5);
  for (size_t i = 0; i < count; i++) {
    assert_close(load->multiplier[i], 0.5 * (before[i] + predicted[i]), 0, 1e-12);
    load->multiplier[i] = before[i];
  }
  for (size_t i = 0; i < dofs; i++) {
    u[i] += step[i];
  }
  load->update(load->self, u);
  memcpy(after, load->multiplier, count * sizeof *after);
  for (size_t i = 0; i < count; i++) {
    assert_close(predicted[i], after[i], 0, 1e-7);
    touching += fabs(after[i] - before[i]) > 1e-6;
  }
  assert_true(touching > 0);
  free(step);
}

/* Pressed about 0.2 into the top, with pressures there already. */
TEST(test_derivatives_of_contact)
{
  block_create(2, 2, 0.1);
  struct dea_surface *surface = side_create(DEA_FACE_TOP);
  for (size_t i = 0; i < sizeof tips / sizeof tips[0]; i++) {
    const struct dea_contact_options options = {
        .tip = tips[i],
        .place_m = {1.4, 1, 1.7 + (tips[i].shape == DEA_INDENTER_FLAT ? 0 : tips[i].radius_m)},
        .stiffness_Pa_per_m = 40};
    struct dea_contact *contact;
    assert_int_equal(dea_contact_create(ctx, surface, &options, &memory, &contact), DEA_OK);
    struct dea_solid_load load = dea_contact_load(contact);
    check_derivatives(&load);
    assert_true(load.update(load.self, u) > 1);
    check_derivatives(&load);
    check_prediction(&load);
  }
  block_destroy();
}

static bool middle_is_open(const void *self, int region, int ply)
{
  return ply != 1;
}

static bool is_lower(const void *self, int region, int ply, const double middle[3])
{
  return ply == 0;
}

static bool is_upper(const void *self, int region, int ply, const double middle[3])
{
  return ply == 2;
}

/* Two bent plies over a gap that is closed in places, the upper one moved along: a third of an
 * element, so that points lie beyond the edges of their faces. */
TEST(test_derivatives_of_two_surfaces)
{
  static const double cuts[] = {0, 0.4, 1};
  const struct dea_block block = {map_block, NULL, cuts, cuts, 2, 2, 7};
  const struct dea_ply plies[] = {{0.6, 1, 2}, {0.05, 1, 2}, {0.6, 1, 2}};
  for (int order = 1; order <= 3; order++) {
    struct dea_surface *lower, *upper;
    struct dea_contact *contact;
    assert_ok(dea_grid_create(ctx, order, &block, 1, plies, 3, middle_is_open, 0.3, 3, &grid));
    u = calloc(3 * grid->node_count, sizeof *u);
    for (size_t n = 0; n < grid->node_count; n++) {
      const double *X = grid->X + 3 * n, up = X[2] > 0.93 ? 1 : 0;
      u[3 * n] = 0.1 * (sin(X[1]) + 0.3 * X[2]) + 0.3 * up;
      u[3 * n + 1] = 0.1 * (0.5 * X[0] * X[2] - 0.2 * X[1]) - 0.2 * up;
      u[3 * n + 2] = 0.2 * (cos(X[0]) + 0.4 * X[1] * X[2]) - up * (0.1 + 0.1 * sin(3 * X[0]));
    }
    assert_ok(dea_surface_create(ctx, grid, DEA_FACE_TOP, is_lower, NULL, &memory, &lower));
    assert_ok(dea_surface_create(ctx, grid, DEA_FACE_BOTTOM, is_upper, NULL, &memory, &upper));
    const struct dea_contact_options options = {
        .tip = {.radius_m = 1}, .other = lower, .stiffness_Pa_per_m = 40};
    assert_ok(dea_contact_create(ctx, upper, &options, &memory, &contact));
    struct dea_solid_load load = dea_contact_load(contact);
    check_derivatives(&load);
    assert_true(load.update(load.self, u) > 1);
    check_derivatives(&load);
    check_prediction(&load);
    assert_close(dea_contact_slide(contact, u), 0.2, 0, 0.1);
    block_destroy();
  }
}

/* The force on the tip is that which moves it: the derivative of the energy by its place. */
TEST(test_force_by_place_of_tip)
{
  static struct dea_load_piece piece;
  block_create(2, 2, 0.1);
  struct dea_surface *surface = side_create(DEA_FACE_TOP);
  const struct dea_contact_options options = {
      .tip = tips[1], .place_m = {1.4, 1, 1.7}, .stiffness_Pa_per_m = 40};
  struct dea_contact *contact;
  assert_int_equal(dea_contact_create(ctx, surface, &options, &memory, &contact), DEA_OK);
  struct dea_solid_load load = dea_contact_load(contact);
  for (int i = 0; i < 3; i++) {
    double energy[2] = {0, 0}, d = 1e-6, force[3];
    for (int side = 0; side < 2; side++) {
      memcpy(load.now, options.place_m, sizeof options.place_m);
      load.now[i] += side ? d : -d;
      for (size_t p = 0; p < load.piece_count; p++) {
        load.evaluate(load.self, p, u, DEA_ENERGY, &piece);
        energy[side] += piece.energy_J;
      }
    }
    memcpy(load.now, options.place_m, sizeof options.place_m);
    memset(load.multiplier, 0, load.multiplier_count * sizeof *load.multiplier);
    load.update(load.self, u); // from none: pressure k times depth
    dea_contact_force(contact, u, force);
    memset(load.multiplier, 0, load.multiplier_count * sizeof *load.multiplier);
    assert_close(force[i], -(energy[1] - energy[0]) / (2 * d), 1e-7, 1e-9);
    assert_true(fabs(force[i]) > 1e-3);
  }
  block_destroy();
}

/* ---- tips ---- */

/* Everywhere about the tips: the normal is the gradient, of length one, the Hessian its slope
 * (except across a seam), and the distance is really one: the foot x - g n is on the surface. */
TEST(test_slopes_of_distances)
{
  static const double place[3] = {0.1, -0.2, 0.3};
  for (size_t i = 0; i < sizeof tips / sizeof tips[0]; i++) {
    struct dea_indenter tip = tips[i];
    int seams = 0, points = 0;
    assert_int_equal(dea_indenter_check(ctx, &tip), DEA_OK);
    for (int k = 0; k < 2000; k++) {
      double x[3], n[3], H[9], up[3], down[3], foot[3], none[3], length = 0, d = 1e-6;
      for (int a = 0; a < 3; a++) {
        x[a] = place[a] + 2.5 * sin(1.7 * k + 2.1 * a + 0.37 * k * a); // all about
      }
      double g = dea_indenter_distance(&tip, place, x, n, H);
      if (g < -0.3) { // deeper the flat end has a ridge
        continue;
      }
      points++;
      for (int a = 0; a < 3; a++) {
        double keep = x[a];
        foot[a] = x[a] - g * n[a];
        length += n[a] * n[a];
        x[a] = keep + d;
        double gu = dea_indenter_distance(&tip, place, x, up, NULL);
        x[a] = keep - d;
        double gd = dea_indenter_distance(&tip, place, x, down, NULL);
        x[a] = keep;
        assert_close(n[a], (gu - gd) / (2 * d), 0, 1e-6);
        for (int b = 0; b < 3; b++) {
          seams += fabs(H[3 * b + a] - (up[b] - down[b]) / (2 * d)) > 1e-6;
        }
      }
      assert_close(length, 1, 1e-12, 0);
      assert_close(dea_indenter_distance(&tip, place, foot, none, NULL), 0, 0, 1e-12);
    }
    assert_true(seams <= 9 && points > 500);
  }
}

TESTS(context_set_up, context_tear_down)
