/* Rigid tips on a soft block and on a film under tension, against closed forms; two blocks. */
// ctest: solid
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/load/loads.h"
#include "quarter_grid.h"
#include "solid_block.h"

#include "solid_fixture.h"

static const double pi = 3.14159265358979323846;

/* ---- Hertz ---- */

static const double side = 20, radius = 100;

static void map_square(const void *self, double s, double t, double x[2])
{
  x[0] = side * s;
  x[1] = side * t;
}

/* Bonded at the bottom; mirror planes x = 0 and y = 0. */
static int bonded(const void *self, const double X[3])
{
  return X[2] < 1e-9 ? 7 : (X[0] < 1e-9 ? 1 : 0) | (X[1] < 1e-9 ? 2 : 0);
}

static bool upmost(const void *self, int region, int ply, const double middle[3])
{
  return middle[2] > side - 1e-9;
}

/* Elements of 1/4 under the contact, which is about 1 wide. */
static struct dea_grid *hertz_grid(void)
{
  static const double at[] = {0, 0.25, 0.5, 0.75, 1, 1.25, 2.5, 6, 20};
  static const double thick[] = {12, 5, 2, 0.7, 0.3};
  enum { CUTS = sizeof at / sizeof at[0], SHEETS = sizeof thick / sizeof thick[0] };
  double cuts[CUTS];
  struct dea_ply plies[SHEETS];
  struct dea_grid *grid;
  for (int i = 0; i < CUTS; i++) {
    cuts[i] = at[i] / side;
  }
  for (int i = 0; i < SHEETS; i++) {
    plies[i] = (struct dea_ply){thick[i], 1, 2};
  }
  const struct dea_block quad = {map_square, NULL, cuts, cuts, CUTS - 1, CUTS - 1, 0};
  assert_int_equal(dea_grid_create(ctx, 2, &quad, 1, plies, SHEETS, NULL, 0, side, &grid), DEA_OK);
  return grid;
}

/* Force on a sphere pressed d into a bonded layer of thickness h over that into a half space
 * (Dimitriadis et al. 2002). */
static double layer_factor(double d, double h, double nu)
{
  double chi = sqrt(radius * d) / h;
  double alpha = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu);
  double beta = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1 - nu);
  double a3 = alpha * alpha * alpha, pi2 = pi * pi;
  return 1 - 2 * alpha / pi * chi + 4 * alpha * alpha / pi2 * chi * chi -
         8 / (pi * pi2) * (a3 + 4 * pi2 / 15 * beta) * pow(chi, 3) +
         16 * alpha / (pi2 * pi2) * (a3 + 3 * pi2 / 5 * beta) * pow(chi, 4);
}

/* Gaps are closed where there is pressure and open elsewhere; returns the pressure nearest to the
 * axis. */
static double check_gaps(const struct dea_surface *top, struct dea_contact *contact,
                         const struct dea_indenter *tip, const double *u, double close)
{
  const struct dea_solid_load load = dea_contact_load(contact);
  double middle = 0;
  for (size_t f = 0; f < top->face_count; f++) {
    for (int q = 0; q < top->face_nodes; q++) {
      size_t n = (size_t)top->nodes[f * DEA_FACE_NODES_MAX + (size_t)q];
      const double *X = top->grid->X + 3 * n;
      double p = load.multiplier[f * (size_t)top->face_nodes + (size_t)q], normal[3];
      double x[3] = {X[0] + u[3 * n], X[1] + u[3 * n + 1], X[2] + u[3 * n + 2]};
      double gap = dea_indenter_distance(tip, load.now, x, normal, NULL);
      assert_true(p >= 0 && gap > -close && (p == 0 || gap < close));
      middle = hypot(X[0], X[1]) < 1e-9 ? p : middle;
    }
  }
  return middle;
}

/* The block is 20 contact radii wide and deep; a half space would give 4 % less force, which the
 * layer's factor knows. */
TEST(test_hertz)
{
  const double E = 1e6, nu = 0.3, d = 0.01;
  const struct dea_part_material soft = dea_part_material_bonded((const double[]){E, nu});
  struct dea_grid *grid = hertz_grid();
  struct dea_solid *solid = block_solid(ctx, grid, 2, &soft, bonded);
  struct dea_arena memory = {.ctx = ctx};
  struct dea_surface *top;
  struct dea_contact *contact;
  struct dea_solid_report report;
  assert_int_equal(dea_surface_create(ctx, grid, DEA_FACE_TOP, upmost, NULL, &memory, &top),
                   DEA_OK);
  const struct dea_contact_options options = {
      .tip = {.shape = DEA_INDENTER_SPHERE, .radius_m = radius},
      .place_m = {0, 0, side + radius},
      .stiffness_Pa_per_m = 10 * E / 0.25};
  assert_int_equal(dea_contact_create(ctx, top, &options, &memory, &contact), DEA_OK);
  const struct dea_solid_load load = dea_contact_load(contact);
  assert_int_equal(dea_solid_add_load(ctx, solid, &load), DEA_OK);
  dea_contact_move(contact, (const double[3]){0, 0, side + radius - d});
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &report), DEA_OK);
  double force[3], hertz = 4.0 / 3 * E / (1 - nu * nu) * sqrt(radius) * pow(d, 1.5);
  dea_contact_force(contact, dea_solid_displacement(solid), force);
  assert_close(4 * force[2], hertz * layer_factor(d, side, nu), 1e-2, 0);
  assert_close(4 * force[2], hertz, 6e-2, 0);
  double middle = check_gaps(top, contact, &options.tip, dea_solid_displacement(solid), 1e-3 * d);
  assert_close(middle, 1.5 * 4 * force[2] / (pi * radius * d), 3e-2, 0);
  dea_solid_destroy(ctx, solid);
  dea_arena_free(&memory);
  dea_grid_destroy(ctx, grid);
}

/* ---- flat punch on a film under tension ---- */

static const double film_h = 100e-6 / 2.25, punch_m = 1.5e-3, frame_m = 15e-3;

/* A quarter of a pre-stretched film that a tip touches from above. */
struct pressed {
  struct dea_part_material film;
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_arena memory; // of the contact
  struct dea_contact *contact;
};

/* fine: elements along an eighth of the circle under the tip. */
static void press_on_film(size_t fine, const struct dea_contact_options *options,
                          struct pressed *out)
{
  *out = (struct pressed){.film = {.law = dea_law_find("yeoh"),
                                   .param = {178.4e3, -6e3, 4.2e3},
                                   .pre_stretch = {1.5, 1.5, 1 / 2.25},
                                   .kappa_Pa = 4e7,
                                   .thickness_m = film_h},
                          .memory = {.ctx = ctx}};
  struct dea_surface *top;
  assert_int_equal(dea_part_material_relax(&out->film), DEA_OK);
  const struct dea_quarter quarter = {2, 2, punch_m, frame_m, film_h, .fine = fine, .edge = 2e-4};
  assert_int_equal(dea_grid_quarter(ctx, &quarter, &out->grid), DEA_OK);
  out->solid = block_solid(ctx, out->grid, 2, &out->film, quarter_held);
  assert_int_equal(dea_surface_create(ctx, out->grid, DEA_FACE_TOP, NULL, NULL, &out->memory, &top),
                   DEA_OK);
  assert_int_equal(dea_contact_create(ctx, top, options, &out->memory, &out->contact), DEA_OK);
  const struct dea_solid_load load = dea_contact_load(out->contact);
  assert_int_equal(dea_solid_add_load(ctx, out->solid, &load), DEA_OK);
}

static void release(struct pressed *p)
{
  dea_solid_destroy(ctx, p->solid);
  dea_arena_free(&p->memory);
  dea_grid_destroy(ctx, p->grid);
}

/* A membrane under tension T on a rigid disc of radius a, clamped at b: F = 2 pi T d / ln(b/a)
 * while d is small. The force is the slope of the energy, and a tip that has gone leaves none. */
TEST(test_flat_punch_on_film)
{
  struct pressed film;
  struct dea_solid_report report;
  const double edge = 1e-4, tension = 797.745e3 * film_h;
  const struct dea_contact_options options = {.tip = {.shape = DEA_INDENTER_FLAT,
                                                      .radius_m = punch_m + edge,
                                                      .edge_radius_m = edge,
                                                      .axis = {0, 0, 1}},
                                              .place_m = {0, 0, 0.5 * film_h},
                                              .stiffness_Pa_per_m = 1e11};
  press_on_film(2, &options, &film);
  double energy[4], force[4][3];
  for (int i = 0; i < 4; i++) {
    double d = 25e-6 * i;
    dea_contact_move(film.contact, (const double[3]){0, 0, 0.5 * film_h - d});
    assert_int_equal(dea_load_steps_solve(ctx, film.solid, 0, &report), DEA_OK);
    dea_contact_force(film.contact, dea_solid_displacement(film.solid), force[i]);
    energy[i] = report.energy_J;
    assert_close(4 * force[i][2], 2 * pi * tension * d / log(frame_m / punch_m), 5e-3, 1e-12);
  }
  assert_close(force[2][2], (energy[3] - energy[1]) / 50e-6, 1e-3, 0);
  dea_contact_move(film.contact, (const double[3]){0, 0, film_h});
  assert_int_equal(dea_load_steps_solve(ctx, film.solid, 0, &report), DEA_OK);
  dea_contact_force(film.contact, dea_solid_displacement(film.solid), force[0]);
  assert_close(force[0][2], 0, 0, 0);
  release(&film);
}

/* ---- two blocks ---- */

static const double gap = 0.05, height = 1;

static bool is_block(const void *self, int region, int ply)
{
  return ply != 1;
}

static int block_of_ply(const void *self, int region, int ply)
{
  return ply / 2;
}

static bool is_below(const void *self, int region, int ply, const double middle[3])
{
  return ply == 0;
}

static bool is_above(const void *self, int region, int ply, const double middle[3])
{
  return ply == 2;
}

/* Mirror planes x = 0 and y = 0, the lowest and the highest face held along z. */
static int ends_held(const void *self, const double X[3])
{
  const bool end = X[2] < 1e-9 || X[2] > 2 * height + gap - 1e-9;
  return (X[0] < 1e-9 ? 1 : 0) | (X[1] < 1e-9 ? 2 : 0) | (end ? 4 : 0);
}

/* Stretches of two neo-Hookean blocks that are shortened by d in all, with the same force. */
static double force_of_blocks(const double mu[2], double d)
{
  double low = 1 - d / height, high = 1, l = 0, other = 0;
  for (int i = 0; i < 100; i++) {
    l = 0.5 * (low + high);
    other = 2 - d / height - l;
    const bool stiffer = mu[0] * (l - 1 / (l * l)) < mu[1] * (other - 1 / (other * other));
    *(stiffer ? &low : &high) = l;
  }
  return -mu[0] * (l - 1 / (l * l)) * 4; // of 2 by 2
}

/* Alike they shorten alike. A soft one spreads over a stiffer one: beyond its edge there is no
 * face, and that one's goes on. */
static void press_blocks(const double mu[2], int steps, double slide)
{
  static const double cuts[] = {0, 0.5, 1};
  struct dea_part_material materials[2];
  const struct block square = {.size = {2, 2, 0}};
  const struct dea_block quad = {block_map, &square, cuts, cuts, 2, 2, 0};
  const struct dea_ply plies[] = {{height, 1, 2}, {gap, 1, 2}, {height, 1, 2}};
  struct dea_grid *grid;
  struct dea_arena memory = {.ctx = ctx};
  struct dea_surface *below, *above;
  struct dea_contact *contact;
  struct dea_solid *solid;
  struct dea_solid_report report;
  for (int k = 0; k < 2; k++) {
    materials[k] = (struct dea_part_material){.law = dea_law_find("neo-hookean"),
                                              .param = {mu[k]},
                                              .pre_stretch = {1, 1, 1},
                                              .kappa_Pa = 1e4 * mu[k]};
    assert_ok(dea_part_material_relax(&materials[k]));
  }
  assert_ok(dea_grid_create(ctx, 2, &quad, 1, plies, 3, is_block, 0, 2, &grid));
  assert_ok(dea_surface_create(ctx, grid, DEA_FACE_TOP, is_below, NULL, &memory, &below));
  assert_ok(dea_surface_create(ctx, grid, DEA_FACE_BOTTOM, is_above, NULL, &memory, &above));
  const struct dea_contact_options options = {
      .tip = {.radius_m = height}, .other = below, .stiffness_Pa_per_m = 30, .tolerance = 1e-6};
  assert_ok(dea_contact_create(ctx, above, &options, &memory, &contact));
  const struct dea_solid_load load = dea_contact_load(contact);
  const struct dea_solid_options made = {.order_z = 2,
                                         .part_material_count = 2,
                                         .part_materials = materials,
                                         .part_material_of = block_of_ply,
                                         .held = ends_held,
                                         .loads = &load,
                                         .load_count = 1};
  assert_ok(dea_solid_create(ctx, grid, &made, &solid));
  for (int step = 0; step <= steps; step++) {
    const double down = 0.1 * step;
    double force[3];
    for (size_t n = 0; n < grid->node_count; n++) {
      if (grid->X[3 * n + 2] > 2 * height + gap - 1e-9) {
        assert_ok(dea_solid_prescribe(ctx, solid, n, 4, (const double[3]){0, 0, -down}));
      }
    }
    assert_ok(dea_load_steps_solve(ctx, solid, 0, &report));
    dea_contact_force(contact, dea_solid_displacement(solid), force);
    assert_close(-force[2], down > gap ? force_of_blocks(mu, down - gap) : 0,
                 slide > 0 ? 2e-3 : 5e-5, 1e-12);
    assert_close(dea_contact_area(contact), down > gap ? 4 : 0, 1e-2, 0);
  }
  assert_close(dea_contact_slide(contact, dea_solid_displacement(solid)), slide, 0, 5e-3);
  dea_solid_destroy(ctx, solid);
  dea_arena_free(&memory);
  dea_grid_destroy(ctx, grid);
}

TEST(test_two_blocks)
{
  press_blocks((const double[2]){2, 2}, 4, 0);
  press_blocks((const double[2]){10, 1}, 1, 0.04);
}

TESTS(solid_set_up, solid_tear_down)
