/* Response of a solid to an AC excitation of the voltage: a body of one degree of freedom in closed
 * form, and modes of a bender against the system solved at the frequency. */
// ctest: solid
#include "devices.h"
#include "material/plane.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/motion/response.h"
#include "solid_block.h"

#include "solid_fixture.h"

/* ---- a strip of film that pulls a heavy bar ---- */

static const double length = 0.02, width = 0.05, bar = 0.004, h = 50e-6, eps = 1e-11;
static const double l1 = 1.5, l2 = 2, mass = 3e-3;

static void map_strip(const void *self, double s, double t, double x[2])
{
  x[0] = length * s;
  x[1] = width * t;
}

static void map_bar(const void *self, double s, double t, double x[2])
{
  x[0] = length + bar * s;
  x[1] = width * t;
}

/* Everything goes along x only, the film's far end not at all. */
static int along_x(const void *self, const double X[3])
{
  return X[0] < 1e-9 ? 7 : 6;
}

/* Force along x of the film and stiffness, at a displacement and voltage. */
static void film_force(const struct dea_material *material, double u, double voltage_V,
                       double *force, double *stiffness)
{
  struct dea_plane f;
  double l = l1 * (1 + u / length), H = h * l1 * l2, section = width / l2 * H;
  assert_int_equal(dea_plane_elastic(material, l, l2, &f), DEA_OK);
  // W_E = -eps/2 (V/H)^2 (l l2)^2 by l
  double pull = eps * voltage_V * voltage_V / (H * H) * l2 * l2;
  *force = section * (f.s1 - pull * l);
  *stiffness = section * (f.k11 - pull) * l1 / length;
}

static struct dea_grid *grid;
static struct dea_solid *solid;
static size_t end; // a node at the end of the bar

/* Answers of one node. */
struct wanted {
  size_t node;
  double (*out)[2][3];
};

static dea_status take_node(struct dea_context *own, void *user, size_t i, const double *real,
                            const double *imaginary)
{
  const struct wanted *wanted = user;
  memcpy(wanted->out[i][0], real + 3 * wanted->node, sizeof wanted->out[i][0]);
  memcpy(wanted->out[i][1], imaginary + 3 * wanted->node, sizeof wanted->out[i][1]);
  return DEA_OK;
}

static void respond_viscous(const struct dea_branches *branches, const struct dea_damping *damping,
                            const double *w, size_t count, size_t node, double (*out)[2][3])
{
  struct wanted wanted = {node, out};
  assert_ok(dea_solid_respond_viscous(ctx, solid, branches, damping, w, count, take_node, &wanted));
}
static double displacement, weight;

/* A strip at a voltage, under a weight at the bar that holds the tension of the film at rest. */
static void strip_create(const struct dea_material *film, double voltage_V)
{
  static const double cuts[] = {0, 1};
  struct dea_part_material layers[] = {
      {.pre_stretch = {l1, l2, 1 / (l1 * l2)}, .permittivity_F_per_m = eps, .thickness_m = h},
      {.law = dea_law_find("neo-hookean"),
       .param = {3e8},
       .pre_stretch = {1, 1, 1},
       .thickness_m = h,
       .density_kg_per_m3 = mass / (bar * width * h)},
  };
  dea_part_material_set_law(&layers[0], film->law, film->param);
  const struct dea_block blocks[] = {{map_strip, NULL, cuts, cuts, 1, 1, 0},
                                     {map_bar, NULL, cuts, cuts, 1, 1, 1}};
  const struct dea_ply ply = {0, 1, 1};
  const struct dea_solid_options options = {.order_z = 1,
                                            .part_material_count = 2,
                                            .part_materials = layers,
                                            .part_material_of = layer_of_region,
                                            .active = first_region,
                                            .held = along_x};
  struct dea_solid_report report;
  double rest;
  assert_int_equal(dea_grid_create(ctx, 1, blocks, 2, &ply, 1, NULL, 0, width, &grid), DEA_OK);
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
  film_force(film, 0, 0, &weight, &rest);
  for (size_t n = 0; n < grid->node_count; n++) {
    bool at_end = grid->X[3 * n] > length + bar - 1e-9;
    dea_solid_force(solid)[3 * n] = at_end ? 0.5 * weight : 0;
    end = at_end ? n : end;
  }
  assert_int_equal(dea_load_steps_solve(ctx, solid, voltage_V, &report), DEA_OK);
  displacement = dea_solid_displacement(solid)[3 * end];
}

static void strip_destroy(void)
{
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* Push per volt: -dF/dV at fixed u. */
static double strip_push(const struct dea_material *film, double voltage_V)
{
  double more, less, slope;
  film_force(film, displacement, voltage_V + 1, &more, &slope);
  film_force(film, displacement, voltage_V - 1, &less, &slope);
  return 0.5 * (less - more);
}

static const double V = 1500;

TEST(test_one_degree_of_freedom)
{
  static const double ratio = 0.03;
  const struct dea_material film = test_material("gent", 43e3, 115, 0);
  struct dea_arena memory = {.ctx = ctx};
  struct dea_solid_response *response;
  double force, stiffness, square;
  strip_create(&film, V);
  film_force(&film, displacement, V, &force, &stiffness);
  assert_close(force, weight, 1e-4, 0); // the bar gives way, and K has 1e-10 of its stiffness
  assert_int_equal(dea_solid_modes_lowest(ctx, solid, DEA_MODES_BY_MASS, 1, &square, NULL), DEA_OK);
  assert_close(square, stiffness / mass, 1e-4, 0);
  double push = strip_push(&film, V), omega_0 = sqrt(stiffness / mass);
  assert_int_equal(dea_solid_response_create(ctx, solid, 2 * omega_0, &memory, &response), DEA_OK);
  const struct dea_damping damping = {ratio, 0, 0};
  for (int i = 0; i <= 8; i++) {
    double w = 0.25 * i * omega_0, real[3], imaginary[3];
    double gap = stiffness - mass * w * w, loss = 2 * ratio * sqrt(stiffness * mass) * w;
    double size = push / hypot(gap, loss);
    dea_solid_response_at(response, end, w, &damping, real, imaginary);
    assert_close(real[0], size * gap / hypot(gap, loss), 0, 1e-3 * size);
    assert_close(imaginary[0], -size * loss / hypot(gap, loss), 0, 1e-3 * size);
  }
  dea_arena_free(&memory);
  strip_destroy();
}

/* The same strip with two branches: held for long, they know C and push back by 4 G/l^2 per strain
 * and volume, less what they have relaxed; l is the stretch since the flat film. */
TEST(test_branches)
{
  enum { FREQUENCIES = 7 };
  const struct dea_material film = test_material("gent", 43e3, 115, 0);
  const struct dea_branches branches[2] = {{2, {{30e3, 0.01}, {20e3, 1}}}, {0}};
  const struct dea_damping damping = {.mass_per_s = 5};
  static const double share[FREQUENCIES] = {0, 1e-3, 0.03, 0.3, 1, 1.3, 4};
  double w[FREQUENCIES], force, stiffness, out[FREQUENCIES][2][3];
  strip_create(&film, V);
  film_force(&film, displacement, V, &force, &stiffness);
  double push = strip_push(&film, V), l = 1 + displacement / length;
  double per_Pa = 4 / (l * l) * h * width / length;
  for (int i = 0; i < FREQUENCIES; i++) {
    w[i] = share[i] * sqrt(stiffness / mass);
  }
  respond_viscous(branches, &damping, w, FREQUENCIES, end, out);
  for (int i = 0; i < FREQUENCIES; i++) {
    double gap = stiffness - mass * w[i] * w[i], loss = 5 * mass * w[i];
    for (size_t k = 0; k < branches[0].count; k++) { // G (x^2 + i x)/(1 + x^2), x = w tau
      double x = w[i] * branches[0].branch[k].time_s, G = branches[0].branch[k].modulus_Pa;
      gap += per_Pa * G * x * x / (1 + x * x);
      loss += per_Pa * G * x / (1 + x * x);
    }
    double size = push / hypot(gap, loss);
    assert_close(out[i][0][0], size * gap / hypot(gap, loss), 0, 1e-3 * size);
    assert_close(out[i][1][0], -size * loss / hypot(gap, loss), 0, 1e-3 * size);
  }
  strip_destroy();
}

/* ---- a bender: two plies, the upper one between electrodes, clamped at one end ---- */

static const struct block bender = {{10e-3, 4e-3, 0}, {3, 1, 1}, 2, 2};

static bool upper(const void *self, int region, int ply)
{
  return ply == 1;
}

/* Superposition of modes against the system solved at the frequency, with both kinds of damping. */
static void check_direct(const struct dea_solid_response *response, double w,
                         const struct dea_damping *damping)
{
  const struct dea_branches none[1] = {{0}};
  double out[1][2][3], real[3], imaginary[3];
  size_t far = dea_grid_nearest(grid, (const double[3]){bender.size[0], 0, 0});
  respond_viscous(none, damping, &w, 1, far, out);
  dea_solid_response_at(response, far, w, damping, real, imaginary);
  double size = hypot(hypot(out[0][0][0], out[0][0][2]), hypot(out[0][1][0], out[0][1][2]));
  for (int i = 0; i < 3; i++) {
    assert_close(real[i], out[0][0][i], 0, 1e-3 * size);
    assert_close(imaginary[i], out[0][1][i], 0, 1e-3 * size);
  }
}

static const double bender_ply_m = 200e-6;

static struct dea_part_material bender_layer(void)
{
  struct dea_part_material layer = {.law = dea_law_find("gent"),
                                    .param = {43e3, 115},
                                    .pre_stretch = {1, 1, 1},
                                    .kappa_Pa = 43e5,
                                    .permittivity_F_per_m = eps,
                                    .thickness_m = bender_ply_m,
                                    .density_kg_per_m3 = 1000};
  assert_int_equal(dea_part_material_relax(&layer), DEA_OK);
  return layer;
}

TEST(test_modes_of_a_bender_against_the_system)
{
  struct dea_part_material layer = bender_layer();
  static const double cuts[] = {0, 0.3, 0.6, 1};
  static const double whole[] = {0, 1};
  const struct dea_block strip = {block_map, &bender, cuts, whole, 3, 1, 0};
  const struct dea_ply plies[] = {{bender_ply_m, 1, 2}, {bender_ply_m, 1, 2}};
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = 1,
                                            .part_materials = &layer,
                                            .active = upper,
                                            .held = clamped};
  struct dea_solid_report report;
  struct dea_arena memory = {.ctx = ctx};
  struct dea_solid_response *response;
  double square[3];
  assert_int_equal(dea_grid_create(ctx, 2, &strip, 1, plies, 2, NULL, 0, 10e-3, &grid), DEA_OK);
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
  assert_int_equal(dea_load_steps_solve(ctx, solid, V, &report), DEA_OK);
  assert_int_equal(dea_solid_modes_lowest(ctx, solid, DEA_MODES_BY_MASS, 3, square, NULL), DEA_OK);
  double first = sqrt(square[0]);
  assert_int_equal(dea_solid_response_create(ctx, solid, 3 * first, &memory, &response), DEA_OK);
  const double at[] = {0, 0.7, 1, 3};
  for (int i = 0; i < 4; i++) {
    const struct dea_damping damping = {0, 0.1 * first, 0.2 / first};
    check_direct(response, at[i] * first, &damping);
  }
  dea_arena_free(&memory);
  strip_destroy();
}

TESTS(solid_set_up, solid_tear_down)
