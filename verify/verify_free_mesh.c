/* Free meshes, made by gmsh: patch tests and orders of convergence as on blocks, and the plain disc
 * on both kinds of mesh. */
#include "../tests/quarter_grid.h" // before: a context of its own

#include "manufactured_states.h"

#include "model/model.h"
#include "model/solid/assembly/film_state.h"
#include "model/solid/mesh/gmsh.h"

/* ---- meshes ---- */

/* The unit square; a circle or a triangle in it is the boundary of another region. */
static struct dea_plane_mesh *square(int order, double size, bool curved)
{
  static const struct dea_vertex outline[] = {
      {0, 0, 0, {0}}, {1, 0, 0, {0}}, {1, 1, 0, {0}}, {0, 1, 0, {0}}};
  static const struct dea_vertex circle[] = {{0.15, 0.45, 1, {0}}, {0.75, 0.45, 1, {0}}};
  static const struct dea_vertex triangle[] = {
      {0.25, 0.2, 0, {0}}, {0.8, 0.45, 0, {0}}, {0.3, 0.75, 0, {0}}};
  const struct dea_contour outer = {outline, 4, true};
  const struct dea_contour inner = {curved ? circle : triangle, curved ? 2 : 3, true};
  const struct dea_gmsh_shape shapes[] = {{.name = "square", .contours = &outer, .count = 1},
                                          {.name = "inner", .contours = &inner, .count = 1}};
  const struct dea_gmsh_plan plan = {
      .shapes = shapes, .shape_count = 2, .order = order, .size_m = size};
  struct dea_plane_mesh *mesh;
  verify_ok(states_ctx, dea_gmsh_mesh(states_ctx, &plan, &mesh));
  return mesh;
}

/* Place of a point (s, t) of [0, 1]^2 in a quadrilateral. */
static void place_in(const struct dea_plane_mesh *mesh, size_t e, double s, double t, double x[2])
{
  double nodes[DEA_HEX_ORDER_MAX + 1], value[2][DEA_HEX_ORDER_MAX + 1];
  double slope[DEA_HEX_ORDER_MAX + 1];
  size_t per = (size_t)mesh->order + 1;
  dea_lobatto_nodes(per - 1, nodes);
  dea_lagrange(per, nodes, 2 * s - 1, value[0], slope);
  dea_lagrange(per, nodes, 2 * t - 1, value[1], slope);
  x[0] = x[1] = 0;
  for (size_t n = 0; n < per * per; n++) {
    const double *at = mesh->x + 2 * mesh->quads[e * per * per + n];
    x[0] += value[0][n % per] * value[1][n / per] * at[0];
    x[1] += value[0][n % per] * value[1][n / per] * at[1];
  }
}

/* Every element as a block of count x count. */
struct parent {
  const struct dea_plane_mesh *mesh;
  size_t element;
};

static void map_parent(const void *self, double s, double t, double x[2])
{
  const struct parent *parent = self;
  place_in(parent->mesh, parent->element, s, t, x);
}

static struct dea_plane_mesh *refined(const struct dea_plane_mesh *mesh, size_t count)
{
  static const double cuts[3][5] = {{0, 1}, {0, 0.5, 1}, {0, 0.25, 0.5, 0.75, 1}};
  const double *even = cuts[count / 2]; // 1, 2, 4
  struct parent *parents = calloc(mesh->quad_count, sizeof *parents);
  struct dea_block *blocks = calloc(mesh->quad_count, sizeof *blocks);
  struct dea_plane_mesh *out;
  if (parents == NULL || blocks == NULL) {
    exit(1);
  }
  for (size_t e = 0; e < mesh->quad_count; e++) {
    parents[e] = (struct parent){mesh, e};
    blocks[e] = (struct dea_block){map_parent, &parents[e], even, even, count, count, 0};
  }
  verify_ok(states_ctx,
            dea_blocks_mesh(states_ctx, mesh->order, blocks, mesh->quad_count, 1, &out));
  free(blocks);
  free(parents);
  return out;
}

/* The free mesh, its elements divided, as a cube with `through` times as many elements through it.
 */
static struct dea_grid *cube(int order, double size, bool curved, size_t count, size_t through)
{
  struct dea_plane_mesh *free_mesh = square(order, size, curved), *mesh = refined(free_mesh, count);
  struct dea_grid *grid;
  const struct dea_ply ply = {1, through * count, order};
  const struct dea_stack stack = {.plies = &ply, .count = 1};
  verify_ok(states_ctx, dea_grid_extrude(states_ctx, mesh, &stack, &grid));
  dea_plane_mesh_destroy(states_ctx, mesh);
  dea_plane_mesh_destroy(states_ctx, free_mesh);
  return grid;
}

/* ---- patch tests, orders ---- */

static void patch(const struct exact *exact)
{
  printf("| %s |", exact->name);
  for (int order = 1; order <= 2; order++) {
    double error[NORMS], largest = 0;
    solve(exact, cube(order, 0.5, true, 1, 2), error);
    for (enum norm norm = 0; norm < NORMS; norm++) {
      largest = has(exact, norm) ? fmax(largest, error[norm]) : largest;
    }
    verify_absolute(exact->name, largest, 0, 1e-7);
    printf(" %.1e |", largest);
  }
  puts("");
}

/* Errors on the free mesh and its refinements; the order between the last two must not be lower
 * than that of theory by more than `tolerance`. */
static void orders(const struct exact *exact, int order, size_t mesh_count, double tolerance,
                   struct converged out[NORMS])
{
  double error[3][NORMS];
  for (size_t m = 0; m < mesh_count; m++) {
    struct dea_grid *grid = cube(order, 0.6, false, (size_t)1 << m, order == 1 ? 3 : 2);
    fprintf(stderr, "%s, order %d: %zu elements, smallest Jacobian %.2f\n", exact->name, order,
            grid->element_count, dea_grid_smallest_jacobian(grid));
    solve(exact, grid, error[m]);
  }
  for (enum norm norm = 0; norm < NORMS; norm++) {
    if (has(exact, norm)) {
      int theory = theory_of(norm, order);
      out[norm].error = error[mesh_count - 1][norm];
      out[norm].order = log2(error[mesh_count - 2][norm] / out[norm].error);
      verify_absolute(norm_name[norm], fmin(out[norm].order, theory), theory, tolerance);
    }
  }
}

/* ---- the plain disc ---- */

static const double frame_m = 15e-3, a_m = 3.75e-3, H0_m = 100e-6;

struct answer {
  double strain, capacitance_F, energy_J;
  size_t nodes;
};

static bool on_electrode(const void *self, int region, int ply)
{
  (void)ply;
  return region == *(const int *)self;
}

static int disc_held(const void *self, const double X[3])
{
  (void)self;
  if (hypot(X[0], X[1]) > frame_m * (1 - 1e-9)) {
    return 1 | 2 | 4;
  }
  return (X[0] < 1e-10 ? 1 : 0) | (X[1] < 1e-10 ? 2 : 0);
}

/* At 5 kV, in steps of 1 kV. electrode: the region between electrodes. */
static struct answer disc_answer(struct dea_grid *grid, int electrode_region)
{
  const double h = H0_m / 2.25;
  struct dea_part_material film = {.law = dea_law_find("yeoh"),
                                   .param = {178.4e3, -6e3, 4.2e3}, // paper Table 1
                                   .pre_stretch = {1.5, 1.5, 1 / 2.25},
                                   .kappa_Pa = 4e7,
                                   .permittivity_F_per_m = 2.8 * DEA_EPSILON_0,
                                   .thickness_m = h};
  verify_ok(states_ctx, dea_part_material_relax(&film));
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = 1,
                                            .part_materials = &film,
                                            .active = on_electrode,
                                            .held = disc_held,
                                            .self = &electrode_region};
  struct dea_solid *solid;
  struct dea_solid_report report;
  struct answer answer = {.nodes = grid->node_count};
  verify_ok(states_ctx, dea_solid_create(states_ctx, grid, &options, &solid));
  for (int kV = 0; kV <= 5; kV++) {
    verify_ok(states_ctx, dea_load_steps_solve(states_ctx, solid, 1e3 * kV, &report));
  }
  verify_absolute("unstable modes", report.unstable_modes, 0, 0);
  size_t node = dea_grid_nearest(grid, (const double[3]){a_m, 0, 0});
  verify_absolute("the electrode's edge", grid->X[3 * node], a_m, 1e-9);
  answer.strain = dea_solid_displacement(solid)[3 * node] / a_m;
  answer.energy_J = report.energy_J;
  verify_ok(states_ctx, dea_solid_capacitance(states_ctx, solid, false, &answer.capacitance_F));
  dea_solid_destroy(states_ctx, solid);
  dea_grid_destroy(states_ctx, grid);
  return answer;
}

static struct answer by_blocks(size_t fine, double edge)
{
  const struct dea_quarter quarter = {2, 2, a_m, frame_m, H0_m / 2.25, .fine = fine, .edge = edge};
  struct dea_grid *grid;
  verify_ok(states_ctx, dea_grid_quarter(states_ctx, &quarter, &grid));
  return disc_answer(grid, DEA_REGION_ELECTRODE);
}

/* A quarter of the disc. */
static struct answer by_free_mesh(double size, double edge)
{
  static const double quarter = 0.41421356237309505; // tan(pi/8)
  const struct dea_vertex film[] = {
      {0, 0, 0, {0}}, {frame_m, 0, quarter, {0}}, {0, frame_m, 0, {0}}};
  const struct dea_vertex disc[] = {{0, 0, 0, {0}}, {a_m, 0, quarter, {0}}, {0, a_m, 0, {0}}};
  const struct dea_contour contours[] = {
      {film, 3, true}, {disc, 3, true}, {disc + 1, 2, false}}; // the last one: the arc alone
  const struct dea_gmsh_shape shapes[] = {
      {.name = "film", .contours = &contours[0], .count = 1},
      {.name = "electrode", .contours = &contours[1], .count = 1}};
  const struct dea_gmsh_shape edge_curve = {
      .name = "edge", .contours = &contours[2], .count = 1, .edge_size_m = edge};
  const struct dea_gmsh_plan plan = {.shapes = shapes,
                                     .shape_count = 2,
                                     .curves = &edge_curve,
                                     .curve_count = 1,
                                     .order = 2,
                                     .size_m = size};
  const struct dea_ply ply = {H0_m / 2.25, 1, 2};
  const struct dea_stack stack = {.plies = &ply, .count = 1, .bottom_m = -0.5 * H0_m / 2.25};
  struct dea_plane_mesh *mesh;
  struct dea_grid *grid;
  int region;
  verify_ok(states_ctx, dea_gmsh_mesh(states_ctx, &plan, &mesh));
  verify_ok(states_ctx,
            dea_plane_mesh_region(states_ctx, mesh, (const unsigned char[2]){1, 1}, &region));
  verify_ok(states_ctx, dea_grid_extrude(states_ctx, mesh, &stack, &grid));
  dea_plane_mesh_destroy(states_ctx, mesh);
  return disc_answer(grid, region);
}

enum { LEVELS = 3 };

/* One quantity on both rows of meshes: the finest ones have to agree within the sum of their
 * estimated errors, which are the changes since the mesh before. */
static void compare(const char *name, double scale, const double blocks[LEVELS],
                    const double free_[LEVELS])
{
  double own = fabs(blocks[2] - blocks[1]), its = fabs(free_[2] - free_[1]);
  printf("| %s |", name);
  for (int i = 0; i < LEVELS; i++) {
    printf(" %.5f |", scale * blocks[i]);
  }
  printf(" %.5f |", scale * own);
  for (int i = 0; i < LEVELS; i++) {
    printf(" %.5f |", scale * free_[i]);
  }
  printf(" %.5f | %+.5f |\n", scale * its, scale * (free_[2] - blocks[2]));
  verify_absolute(name, free_[2], blocks[2], own + its);
}

static void disc(bool small)
{
  static const size_t fine[2][LEVELS] = {{3, 4, 6}, {2, 3, 4}};
  static const double edge[2][LEVELS] = {{4e-4, 2e-4, 1e-4}, {8e-4, 4e-4, 2e-4}};
  static const double size[2][LEVELS] = {{2e-3, 1.4e-3, 1e-3}, {3e-3, 2e-3, 1.4e-3}};
  double value[2][3][LEVELS];
  size_t nodes[2][LEVELS];
  for (int i = 0; i < LEVELS; i++) {
    const struct answer both[2] = {by_blocks(fine[small][i], edge[small][i]),
                                   by_free_mesh(size[small][i], edge[small][i])};
    for (int k = 0; k < 2; k++) {
      value[k][0][i] = both[k].strain;
      value[k][1][i] = both[k].capacitance_F;
      value[k][2][i] = both[k].energy_J;
      nodes[k][i] = both[k].nodes;
    }
  }
  printf("\n| | blocks: %zu | %zu | %zu nodes | change | free: %zu | %zu | %zu nodes | change | "
         "difference |\n|---|---|---|---|---|---|---|---|---|---|\n",
         nodes[0][0], nodes[0][1], nodes[0][2], nodes[1][0], nodes[1][1], nodes[1][2]);
  compare("strain of the edge [%]", 100, value[0][0], value[1][0]);
  compare("capacitance of the quarter [pF]", 1e12, value[0][1], value[1][1]);
  compare("energy of the quarter [uJ]", 1e6, value[0][2], value[1][2]);
}

int main(int argc, char **argv)
{
  bool small = verify_is_small(argc, argv);
  struct exact patches[STATES], states[STATES];
  if (system("gmsh --version >/dev/null 2>&1") != 0) {
    fprintf(stderr, "gmsh is not installed\n");
    return 77;
  }
  verify_ok(NULL, dea_context_create(NULL, &states_ctx));
  verify_ok(states_ctx, dea_solid_start(states_ctx));
  make_states(patches, states);
  puts("# Free meshes\n\n"
       "Made by `scripts/verify free_mesh`; not to be edited. Plane meshes of quadrilaterals by "
       "gmsh, extruded through one ply; the\nsame states, supports and norms as in "
       "[orders.md](orders.md), on the unit cube with a circle in its plane as the boundary of "
       "another\nregion, so that elements have curved edges inside (of order 2).\n\n"
       "## Patch tests\n\nThe largest relative error of all norms. Tolerance 1e-7.\n\n"
       "| state | order 1 | order 2 |\n|---|---|---|");
  for (size_t i = 0; i < STATES; i++) {
    patch(&patches[i]);
  }
  printf("\n## Manufactured solutions\n\nA free mesh (with a triangle in the plane as the inner "
         "boundary, 2 elements through the thickness, 3 of order 1), then each\nof its elements "
         "divided along all axes once and, of order 1, twice. Relative errors on the last, in "
         "brackets the observed order\nsince the mesh before, which must not be lower than that "
         "of theory by more than %.1f.\n\n",
         small ? 0.5 : 0.3);
  static struct converged found[STATES][3][NORMS];
  const size_t count = small ? 2 : STATES;
  for (size_t i = 0; i < count; i++) {
    orders(&states[i], 1, small ? 2 : 3, small ? 0.5 : 0.3, found[i][0]);
    orders(&states[i], 2, 2, small ? 0.5 : 0.3, found[i][1]);
  }
  print_orders(states, count, 2, found);
  puts("\n## The plain disc by blocks and by a free mesh\n\n"
       "A quarter of the disc of [disc.md](disc.md), film of 100 um, electrode 3.75 mm, at 5 kV. "
       "Elements of order 2, on three meshes\nof each kind, finer at the electrode's edge and "
       "elsewhere. The estimated error of the finest mesh is its change since the\none before; "
       "both kinds have to agree within the sum of the two.");
  disc(small);
  dea_solid_stop();
  dea_context_destroy(states_ctx);
  return verify_end();
}
