/* Patch tests and manufactured solutions with observed orders: solids, electrostatics, both. */
#include "manufactured.h"

#include "model/model.h"
#include "model/solid/adapter/state.h"
#include "model/solid/element/hex.h"
#include "model/solid/equilibrium/load_steps.h"

static struct dea_context *ctx;
static const double pi = 3.14159265358979323846;
static const double yeoh[DEA_LAW_PARAM_MAX] = {0.5, -0.02, 0.01};

/* ---- exact states ---- */

/* Bent, pulled and twisted; changes its volume. */
static void place_smooth(const number X[3], number x[3])
{
  x[0] = X[0] + 0.10 * csin(1.3 * X[0] + 0.4) * ccos(0.9 * X[1] + 0.5 * X[2]);
  x[1] = X[1] + 0.08 * ccos(1.1 * X[0] - 0.7 * X[1]) * X[2];
  x[2] = X[2] + 0.09 * csin(0.8 * X[0] + 1.2 * X[1] + 0.6 * X[2]);
}

/* Three shears one after the other, each without change of volume. */
static void place_isochoric(const number X[3], number x[3])
{
  x[0] = X[0] + 0.12 * csin(1.2 * X[1] + 0.7 * X[2]);
  x[1] = X[1] + 0.10 * ccos(1.1 * x[0] + 0.8 * X[2]);
  x[2] = X[2] + 0.11 * csin(0.9 * x[0] - 1.3 * x[1]);
}

/* Not larger: what it does to volume changes that the projection does not see falls with a higher
 * order and hides the one of the displacements on coarse meshes. */
static double pressure_smooth(const double X[3])
{
  return 0.1 * sin(1.5 * X[0] + 0.5) * cos(1.1 * X[1] - 0.6 * X[2]);
}

static number potential_smooth(const number X[3])
{
  return 0.4 * X[2] + 0.08 * csin(1.7 * X[0] + 0.3) * ccos(1.2 * X[1]) * csin(0.5 + 1.4 * X[2]);
}

/* For the patch tests. */
static void place_linear(const number X[3], number x[3])
{
  x[0] = 1.10 * X[0] + 0.05 * X[1];
  x[1] = -0.02 * X[0] + 0.95 * X[1] + 0.03 * X[2];
  x[2] = 0.04 * X[0] + 0.96 * X[2];
}

static void place_linear_isochoric(const number X[3], number x[3])
{
  x[0] = 1.25 * (X[0] + 0.1 * X[1]);
  x[1] = 0.8 * (X[1] + 0.2 * X[2]);
  x[2] = X[2] + 0.1 * X[0];
  x[2] += -0.1 * X[0] + 0.08 * x[1];
}

static double pressure_constant(const double X[3])
{
  (void)X;
  return 0.2;
}

static number potential_linear(const number X[3])
{
  return 0.4 * X[2] + 0.1 * X[0] - 0.05 * X[1];
}

/* Layers with a shear modulus of 1 and, with a field, a permittivity of 1. */
static struct dea_constituent layer_of(bool compressible, bool field)
{
  static const double mu_1[] = {2.6, 0.3}; // Lame constants 1 and 1.5
  struct dea_constituent layer = dea_constituent_bonded(mu_1);
  layer.thickness_m = 1;
  if (!compressible) {
    layer = (struct dea_constituent){.law = dea_law_find("yeoh"),
                                     .param = yeoh,
                                     .pre_stretch = {1, 1, 1},
                                     .kappa_Pa = 100,
                                     .thickness_m = 1};
  }
  layer.permittivity_F_per_m = field ? 1 : 0;
  verify_ok(ctx, dea_constituent_relax(&layer));
  return layer;
}

/* ---- one solve ---- */

/* The square [0, 1]^2 with smoothly distorted elements; its edges stay straight. */
static void map_square(const void *self, double s, double t, double x[2])
{
  (void)self;
  x[0] = s + 0.05 * sin(pi * s) * cos(pi * t + 0.4);
  x[1] = t + 0.04 * sin(pi * t) * cos(pi * s - 0.3);
}

static int held(const void *self, const double X[3])
{
  const struct exact *exact = self;
  return exact->held_all || X[0] < 1e-9 || X[2] < 1e-9 ? 1 | 2 | 4 : 0;
}

/* phi is held at its exact value, with a voltage of 1. */
static bool electrode(const void *self, const double X[3], double *share)
{
  double gradient[3];
  *share = exact_potential(self, X, gradient);
  return X[2] < 1e-9 || X[2] > 1 - 1e-9;
}

static struct dea_grid *cube(int order, size_t count)
{
  double cuts[DEA_QUADRATURE_MAX];
  struct dea_grid *grid;
  for (size_t i = 0; i <= count; i++) {
    cuts[i] = (double)i / (double)count;
  }
  const struct dea_block block = {map_square, NULL, cuts, cuts, count, count, 0};
  const struct dea_ply ply = {1, count, order};
  verify_ok(ctx, dea_grid_create(ctx, order, &block, 1, &ply, 1, NULL, 0, 1, &grid));
  return grid;
}

/* A quadrilateral with straight edges; corners in the order of s, then t. */
static void map_straight(const void *self, double s, double t, double x[2])
{
  const double *corner = self; // [4][2]
  for (int i = 0; i < 2; i++) {
    x[i] = (1 - t) * ((1 - s) * corner[i] + s * corner[2 + i]) +
           t * ((1 - s) * corner[4 + i] + s * corner[6 + i]);
  }
}

/* Eight elements of different shape around one inner corner. */
static struct dea_grid *patch_of(int order)
{
  static const double corners[4][4][2] = {{{0, 0}, {0.4, 0}, {0, 0.55}, {0.6, 0.45}},
                                          {{0.4, 0}, {1, 0}, {0.6, 0.45}, {1, 0.6}},
                                          {{0, 0.55}, {0.6, 0.45}, {0, 1}, {0.5, 1}},
                                          {{0.6, 0.45}, {1, 0.6}, {0.5, 1}, {1, 1}}};
  static const double cuts[] = {0, 1};
  struct dea_block blocks[4];
  struct dea_grid *grid;
  for (size_t i = 0; i < 4; i++) {
    blocks[i] = (struct dea_block){map_straight, corners[i][0], cuts, cuts, 1, 1, 0};
  }
  const struct dea_ply plies[] = {{0.3, 1, order}, {0.7, 1, order}};
  verify_ok(ctx, dea_grid_create(ctx, order, blocks, 4, plies, 2, NULL, 0, 1, &grid));
  return grid;
}

/* Sources, and a start a little off the exact displacements where they are not held. */
static void prepare(const struct exact *exact, const struct dea_grid *grid, struct dea_solid *solid)
{
  double *u = dea_solid_displacement(solid);
  const struct sources to = {dea_solid_force(solid), calloc(grid->node_count, sizeof(double))};
  if (to.q == NULL) {
    exit(1);
  }
  add_sources(exact, grid, &to);
  dea_solid_set_charge(solid, to.q);
  free(to.q);
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *X = grid->X + 3 * n;
    double x[3], F[9];
    exact_place(exact, X, x, F);
    for (size_t i = 0; i < 3; i++) {
      double off = held(exact, X) != 0 ? 0 : 1e-3 * sin(5 * X[0] + 7 * X[1] + 3 * X[2] + (double)i);
      u[3 * n + i] = x[i] - X[i] + off;
    }
  }
}

/* Relative errors of the solution on a mesh, which is destroyed. */
static void solve(const struct exact *exact, struct dea_grid *grid, double error[NORMS])
{
  int order = grid->order;
  struct dea_solid *solid;
  struct dea_solid_report report;
  const struct dea_solid_options options = {
      .order_z = order,
      .field = exact->potential != NULL ? DEA_SOLID_FIELD_COUPLED : DEA_SOLID_FIELD_THIN,
      .layer_count = 1,
      .layers = &exact->layer,
      .held = held,
      .electrode = electrode,
      .self = exact};
  verify_ok(ctx, dea_solid_create(ctx, grid, &options, &solid));
  prepare(exact, grid, solid);
  for (int i = 0; i < (exact->pressure != NULL ? 3 : 1); i++) { // multipliers beyond the tolerance
    verify_ok(ctx, dea_solid_solve(ctx, solid, 1, &report));
  }
  verify_absolute("unstable modes", report.unstable_modes, 0, 0);
  double *phi = calloc(grid->node_count, sizeof *phi);
  struct dea_state state = {0};
  struct dea_hex_shape shape;
  verify_ok(ctx, dea_solid_save(ctx, solid, &state));
  verify_ok(ctx, dea_hex_shape_create(order, order, &shape));
  if (phi == NULL) {
    exit(1);
  }
  dea_solid_potential(solid, phi);
  size_t pressures = (size_t)shape.pressures, all = grid->element_count * pressures;
  size_t dofs = (exact->potential != NULL ? 4 : 3) * grid->node_count;
  const double *values = dea_state_find(&state, "state", dofs + all);
  const struct found found = {dea_solid_displacement(solid), exact->potential != NULL ? phi : NULL,
                              values + dofs, pressures};
  errors_of(exact, grid, &found, error);
  free(phi);
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* ---- pages ---- */

static const char *const norm_name[NORMS] = {"u, L2", "Grad u, L2", "phi, L2", "Grad phi, L2",
                                             "pressure, L2"};

static bool has(const struct exact *exact, enum norm norm)
{
  switch (norm) {
  case NORM_U:
  case NORM_GRAD_U:
    return !exact->held_all;
  case NORM_PHI:
  case NORM_GRAD_PHI:
    return exact->potential != NULL;
  default:
    return exact->pressure != NULL;
  }
}

static void patch(const struct exact *exact)
{
  printf("| %s |", exact->name);
  for (int order = 1; order <= 3; order++) {
    double error[NORMS], largest = 0;
    solve(exact, patch_of(order), error);
    for (enum norm norm = 0; norm < NORMS; norm++) {
      largest = has(exact, norm) ? fmax(largest, error[norm]) : largest;
    }
    verify_absolute(exact->name, largest, 0, 1e-7);
    printf(" %.1e |", largest);
  }
  puts("");
}

/* Errors on a row of meshes; the order between the last two has to be that of theory within
 * `tolerance`. */
static void orders(const struct exact *exact, int order, const size_t *counts, size_t mesh_count,
                   double tolerance)
{
  double error[4][NORMS];
  for (size_t m = 0; m < mesh_count; m++) {
    solve(exact, cube(order, counts[m]), error[m]);
  }
  for (enum norm norm = 0; norm < NORMS; norm++) {
    if (!has(exact, norm)) {
      continue;
    }
    bool value = norm == NORM_U || norm == NORM_PHI;
    int theory = value ? order + 1 : order;
    printf("| %d | %s |", order, norm_name[norm]);
    for (size_t m = 0; m < mesh_count; m++) {
      printf(" %.2e", error[m][norm]);
      if (m > 0) {
        double seen = log(error[m - 1][norm] / error[m][norm]) /
                      log((double)counts[m] / (double)counts[m - 1]);
        printf(" (%.2f)", seen);
        if (m + 1 == mesh_count) {
          verify_absolute(norm_name[norm], seen, theory, tolerance);
        }
      }
      printf(" |");
    }
    printf(" %d |\n", theory);
  }
  fflush(stdout);
}

static void section(const struct exact *exact, bool small)
{
  static const size_t full[3][3] = {{4, 8, 16}, {2, 4, 8}, {2, 3, 4}};
  static const size_t coarse[2][2] = {{3, 6}, {2, 4}};
  printf("\n### %s\n\n| order | error |", exact->name);
  puts(small ? " coarse | fine | theory |\n|---|---|---|---|---|"
             : " coarse | middle | fine | theory |\n|---|---|---|---|---|---|");
  for (int order = 1; order <= (small ? 2 : 3); order++) {
    fprintf(stderr, "%s, order %d\n", exact->name, order);
    orders(exact, order, small ? coarse[order - 1] : full[order - 1], small ? 2 : 3,
           small ? 0.5 : 0.2);
  }
}

static void introduction(void)
{
  puts("# Patch tests and orders of convergence\n\n"
       "Made by `scripts/verify orders`; not to be edited. Layered hexahedra of order 1 to 3 (the "
       "same through the thickness) on the unit\ncube, shear modulus and permittivity 1, large "
       "displacements. Supports: u held at its exact value on x = 0 and z = 0, phi on\nz = 0 and "
       "z = 1; on all other faces the exact tractions P N and charges -D N. The incompressible "
       "solid is a Yeoh law with the\nmultipliers of [solid.md](../theory/solid.md), the coupled "
       "one that of [coupled.md](../theory/coupled.md) with u, phi and pressure all unknown.\n"
       "Every solve starts a little off the exact state.\n\n"
       "Only x(X), pressure and phi are written down (`verify/verify_orders.c`); the isochoric "
       "x(X) is three "
       "shears one after the other.\nF and Grad phi are complex steps; P is the layer's stress "
       "plus the "
       "complex step of -(eps/2) |cof(F) E|^2 by F, D its step by E;\nbody force -Div P and "
       "charge Div D are central differences of order 8 (step 0.02) of P and D along X. They "
       "come in as consistent\nnodal forces with order + 2 Gauss points a direction, as do the "
       "norms.\n\n"
       "## Patch tests\n\n"
       "Homogeneous deformation, constant pressure, linear potential on eight hexahedra of "
       "different "
       "shape with straight edges: the\nlargest relative error of all norms below. Tolerance "
       "1e-7, which is what the solver's own (residual 1e-9 of the element\nforces) leaves. "
       "(With curved elements order 3 is left with 1e-6: order + 1 Gauss points a direction "
       "integrate cof(dX/dxi) times a\nslope, of degree 3 order - 1, exactly up to order 2.)\n");
}

int main(int argc, char **argv)
{
  bool small = verify_is_small(argc, argv);
  verify_ok(NULL, dea_context_create(NULL, &ctx));
  verify_ok(ctx, dea_solid_start(ctx));
  const struct exact patches[] = {
      {"compressible solid", place_linear, NULL, NULL, false, layer_of(true, false)},
      {"incompressible solid", place_linear_isochoric, pressure_constant, NULL, false,
       layer_of(false, false)},
      {"electrostatics in a deformed solid", place_linear, NULL, potential_linear, true,
       layer_of(true, true)},
      {"coupled, incompressible", place_linear_isochoric, pressure_constant, potential_linear,
       false, layer_of(false, true)}};
  const struct exact states[] = {
      {"Compressible solid", place_smooth, NULL, NULL, false, layer_of(true, false)},
      {"Incompressible solid", place_isochoric, pressure_smooth, NULL, false,
       layer_of(false, false)},
      {"Electrostatics in a deformed solid", place_isochoric, NULL, potential_smooth, true,
       layer_of(true, true)},
      {"Coupled, incompressible", place_isochoric, pressure_smooth, potential_smooth, false,
       layer_of(false, true)}};
  introduction();
  puts("| state | order 1 | order 2 | order 3 |\n|---|---|---|---|");
  for (size_t i = 0; i < sizeof patches / sizeof patches[0]; i++) {
    patch(&patches[i]);
  }
  printf(
      "\n## Manufactured solutions\n\n"
      "Elements with smoothly curved edges, count^3 of them: %s\nRelative errors, in brackets "
      "the observed order since the mesh before; the last one has to be within %.1f of theory.\n",
      small ? "3 and 6 (order 1), 2 and 4 (order 2)."
            : "4, 8, 16 (order 1), 2, 4, 8 (order 2), 2, 3, 4 (order 3).",
      small ? 0.5 : 0.2);
  for (size_t i = 0; i < sizeof states / sizeof states[0]; i++) {
    section(&states[i], small);
  }
  puts("\nThe pressure is kept to a tenth of the shear modulus. A larger one brings the orders of "
       "u above "
       "theory on coarse meshes: the part of it\nthat the element's polynomials miss moves volume "
       "changes that the projection does not see, and that error falls faster (it shrinks\nwhen "
       "kappa_s is raised, and goes with the pressure).");
  dea_solid_stop();
  dea_context_destroy(ctx);
  return verify_end();
}
