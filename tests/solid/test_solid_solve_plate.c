/* The actuator on its sector, on two sectors and as a whole disc: one answer. */
// ctest: solid
#include "disc_grid.h"
#include "model/solid/assembly/solid.h"
#include "model/solid/equilibrium/load_steps.h"
#include "solid_node.h"
#include "testing.h"
#include "yeoh_part.h"

#include "solid_fixture.h" // after: its context shadows no name of the headers above

#include <math.h>

static const double a_m = 3.75e-3, b_m = 15e-3, h_m = 100e-6 / 2.25;

static int layer_of(const void *self, int region, int ply)
{
  return ply == DISC_FILM ? 0 : 1;
}

static bool active(const void *self, int region, int ply)
{
  return (region & DEA_FIBRE_DISC_ELECTRODE) != 0 && ply == DISC_FILM;
}

static const double same = 1e-9; // of the frame's radius

/* A plane x = 0 or y = 0 needs no axes of its own. */
static bool is_global(double beta)
{
  double quarters = beta / (0.5 * acos(-1));
  return fabs(quarters - floor(quarters + 0.5)) < same;
}

/* Components that frame and mirror planes hold. */
static int held(const void *self, const double X[3])
{
  const struct dea_fibre_disc *p = self;
  bool frame = hypot(X[0], X[1]) > p->frame_radius * (1 - same);
  double top = 0.5 * p->film_thickness * (1 + 1e-6); // of the film, which the frame holds always
  if (frame && (p->end == DEA_FIBRE_DISC_CLAMPED || X[2] < top)) {
    return 1 | 2 | 4;
  }
  double beta = dea_fibre_disc_angle(p);
  bool even = fmod(floor(beta / (0.5 * acos(-1)) + 0.5), 2) == 0; // the last plane is y = 0 as well
  int edges = dea_fibre_disc_edges(p, X), last = !is_global(beta) ? 1 : even ? 2 : 1;
  if (edges == 3) { // the centre
    return is_global(beta) && even ? 2 : 1 | 2;
  }
  return (edges & 1 ? 2 : 0) | (edges & 2 ? last : 0);
}

/* Local axes as rows: normal of its mirror plane, along it, z. */
static bool frame(const void *self, const double X[3], double Q[9])
{
  const struct dea_fibre_disc *p = self;
  double beta = dea_fibre_disc_angle(p), c = cos(beta), s = sin(beta);
  if (dea_fibre_disc_edges(p, X) != 2 || is_global(beta)) {
    return false;
  }
  const double axes[9] = {-s, c, 0, -c, -s, 0, 0, 0, 1};
  for (int i = 0; i < 9; i++) {
    Q[i] = axes[i];
  }
  return true;
}

struct answer {
  double tip, centre, between, energy; // z, z, outwards; of the whole actuator
  size_t nodes;
};

/* As built at 3 kV with N fibres on a coarse mesh. */
static struct answer run(int fibres, int sectors)
{
  static const double plastic[] = {2950e6, 0.38};
  const double pi = acos(-1);
  struct dea_part_material layers[] = {yeoh_part(1.5, 2.8 * DEA_EPSILON_0, h_m),
                                       dea_part_material_bonded(plastic)};
  const struct dea_fibre_disc plate = {.order = 2,
                                       .order_z = 2,
                                       .fibres = fibres,
                                       .sectors = sectors,
                                       .electrode_radius = a_m,
                                       .frame_radius = b_m,
                                       .tip_radius = a_m,
                                       .outer_radius = b_m,
                                       .tip_width = 2e-3,
                                       .outer_width = 2e-3,
                                       .film_thickness = h_m,
                                       .fibre_thickness = 100e-6,
                                       .size = 0.5 * a_m,
                                       .edge = 0.2 * a_m};
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = 2,
                                            .part_materials = layers,
                                            .part_material_of = layer_of,
                                            .active = active,
                                            .held = held,
                                            .frame = frame,
                                            .self = &plate};
  struct dea_layout_mesh mesh;
  struct dea_solid *solid;
  struct dea_solid_report rest, report;
  assert_int_equal(disc_mesh(ctx, &plate, NULL, &mesh), DEA_OK);
  const struct dea_grid *grid = mesh.grid;
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 0, &rest), DEA_OK);
  assert_int_equal(dea_load_steps_solve(ctx, solid, 3e3, &report), DEA_OK);
  assert_int_equal(report.unstable_modes, 0);
  const double *u = dea_solid_displacement(solid);
  double half = pi / fibres;
  size_t between = 3 * node_near(grid, a_m * cos(half), a_m * sin(half), 0);
  struct answer answer = {
      u[3 * node_near(grid, a_m, 0, 0.5 * h_m) + 2], u[3 * node_near(grid, 0, 0, 0) + 2],
      u[between] * cos(half) + u[between + 1] * sin(half),
      (report.energy_J - rest.energy_J) * 2 * fibres / sectors, grid->node_count};
  assert_close(u[between + 1] * cos(half) - u[between] * sin(half), 0, 0, 1e-12);
  dea_solid_destroy(ctx, solid);
  dea_layout_mesh_free(ctx, &mesh);
  return answer;
}

/* Four fibres: 45 degrees with a plane of its own axes, the quarter, and all of it; three fibres:
 * 60 and 120 degrees. */
TEST(test_domains_agree)
{
  static const int domains[][2] = {{4, 1}, {4, 2}, {4, 8}, {3, 1}, {3, 2}};
  struct answer first = {0};
  for (size_t i = 0; i < sizeof domains / sizeof domains[0]; i++) {
    struct answer answer = run(domains[i][0], domains[i][1]);
    if (domains[i][1] == 1) {
      first = answer;
      assert_true(first.tip < -1e-6 && first.centre < -1e-6 && first.between > 5e-5);
      continue;
    }
    assert_true((double)answer.nodes > 1.7 * (double)first.nodes);
    assert_close(answer.tip, first.tip, 1e-7, 0);
    assert_close(answer.centre, first.centre, 1e-7, 0);
    assert_close(answer.between, first.between, 1e-7, 0);
    assert_close(answer.energy, first.energy, 1e-7, 0);
  }
}

TESTS(solid_set_up, solid_tear_down)
