/* Patch tests and manufactured solutions with observed orders: solids, electrostatics, both. */
#include "manufactured_states.h"

#include "model/model.h"

static const double pi = 3.14159265358979323846;

/* ---- one solve ---- */

/* The square [0, 1]^2 with smoothly distorted elements; its edges stay straight. */
static void map_square(const void *self, double s, double t, double x[2])
{
  (void)self;
  x[0] = s + 0.05 * sin(pi * s) * cos(pi * t + 0.4);
  x[1] = t + 0.04 * sin(pi * t) * cos(pi * s - 0.3);
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
  verify_ok(states_ctx, dea_grid_create(states_ctx, order, &block, 1, &ply, 1, NULL, 0, 1, &grid));
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
  verify_ok(states_ctx, dea_grid_create(states_ctx, order, blocks, 4, plies, 2, NULL, 0, 1, &grid));
  return grid;
}

/* ---- pages ---- */

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
                   double tolerance, struct converged out[NORMS])
{
  double error[4][NORMS];
  for (size_t m = 0; m < mesh_count; m++) {
    solve(exact, cube(order, counts[m]), error[m]);
  }
  const size_t last = mesh_count - 1;
  for (enum norm norm = 0; norm < NORMS; norm++) {
    if (has(exact, norm)) {
      out[norm].error = error[last][norm];
      out[norm].order = log(error[last - 1][norm] / error[last][norm]) /
                        log((double)counts[last] / (double)counts[last - 1]);
      verify_absolute(norm_name[norm], out[norm].order, theory_of(norm, order), tolerance);
    }
  }
}

static void orders_of(const struct exact *exact, bool small, struct converged out[3][NORMS])
{
  static const size_t full[3][3] = {{4, 8, 16}, {2, 4, 8}, {2, 3, 4}};
  static const size_t coarse[2][2] = {{3, 6}, {2, 4}};
  for (int order = 1; order <= (small ? 2 : 3); order++) {
    fprintf(stderr, "%s, order %d\n", exact->name, order);
    orders(exact, order, small ? coarse[order - 1] : full[order - 1], small ? 2 : 3,
           small ? 0.5 : 0.2, out[order - 1]);
  }
}

static void introduction(void)
{
  puts("# Patch tests and orders of convergence\n"
       "\n"
       "Made by `scripts/verify orders`; not to be edited. Layered hexahedra of order 1 to 3 (the "
       "same through the thickness) on the unit\n"
       "cube, shear modulus and permittivity 1, large displacements. Supports: u held at its exact "
       "value on x = 0 and z = 0, phi on\n"
       "z = 0 and z = 1; on all other faces the exact tractions P N and charges -D N. The "
       "incompressible solid is a Yeoh law with the\n"
       "multipliers of [solid.md](../theory/solid.md), the coupled one that of "
       "[coupled.md](../theory/coupled.md) with u, phi and pressure all unknown.\n"
       "Every solve starts a little off the exact state.\n"
       "\n"
       "Only x(X), pressure and phi are written down (`verify/manufactured_states.h`); all else "
       "are complex steps and differences of them.\n"
       "\n"
       "## Patch tests\n"
       "\n"
       "Homogeneous deformation, constant pressure, linear potential on eight hexahedra of "
       "different shape with straight edges: the\n"
       "largest relative error of all norms below. Tolerance 1e-7, which is what the solver's own "
       "(residual 1e-9 of the element\n"
       "forces) leaves.\n");
}

int main(int argc, char **argv)
{
  bool small = verify_is_small(argc, argv);
  verify_ok(NULL, dea_context_create(NULL, &states_ctx));
  verify_ok(states_ctx, dea_solid_start(states_ctx));
  struct exact patches[STATES], states[STATES];
  make_states(patches, states);
  introduction();
  puts("| state | order 1 | order 2 | order 3 |\n|---|---|---|---|");
  for (size_t i = 0; i < STATES; i++) {
    patch(&patches[i]);
  }
  printf(
      "\n## Manufactured solutions\n\n"
      "Elements with smoothly curved edges, count^3 of them: %s\nRelative errors on the finest, in "
      "brackets the observed order since the mesh before, which has to be within %.1f of "
      "theory.\n\n",
      small ? "3 and 6 (order 1), 2 and 4 (order 2)."
            : "4, 8, 16 (order 1), 2, 4, 8 (order 2), 2, 3, 4 (order 3).",
      small ? 0.5 : 0.2);
  static struct converged found[STATES][3][NORMS];
  for (size_t i = 0; i < STATES; i++) {
    orders_of(&states[i], small, found[i]);
  }
  print_orders(states, STATES, small ? 2 : 3, found);
  puts("\n"
       "The pressure is kept to a tenth of the shear modulus.");
  dea_solid_stop();
  dea_context_destroy(states_ctx);
  return verify_end();
}
