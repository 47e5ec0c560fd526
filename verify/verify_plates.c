/* Thin plates in large bending (benchmark 8): a cantilever and an annulus that is slit open. */
#include "verify.h"

#include "model/solid/element/hex.h"
#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/load/loads.h"

enum { CUTS_MAX = 65 };

static struct dea_context *ctx;

/* A plate, from the unit square: across it and along it from the clamped to the loaded end. */
struct problem {
  double thickness, modulus, traction; // traction: of the loaded end, at full load
  void (*bend)(double across, double along, double x[2]);
};

struct plate {
  struct dea_grid *grid;
  struct dea_solid *solid;
  double *force;    // at full load [node_count][3]
  size_t corner[2]; // of the loaded end, in the middle surface: across 0 and 1
};

static void bend_cantilever(double across, double along, double x[2])
{
  x[0] = 10 * along;
  x[1] = 1 - across;
}

static void bend_annulus(double across, double along, double x[2])
{
  double r = 6 + 4 * across, angle = 2 * acos(-1) * along;
  x[0] = r * cos(angle);
  x[1] = r * sin(angle);
}

static const struct problem cantilever = {0.1, 1.2e6, 4 / 0.1, bend_cantilever};
static const struct problem annulus = {0.03, 21e6, 0.8 / 0.03, bend_annulus};

static void map_square(const void *self, double s, double t, double x[2])
{
  (void)self;
  x[0] = s;
  x[1] = t;
}

static int not_held(const void *self, const double X[3])
{
  (void)self;
  (void)X;
  return 0;
}

static bool at_loaded_end(const void *self, int region, int ply, const double middle[3])
{
  (void)self;
  (void)region;
  (void)ply;
  return middle[1] > 1 - 1e-9;
}

static struct dea_grid *unit_square(int order, const size_t count[2], double thickness)
{
  double cuts[2][CUTS_MAX + 1];
  struct dea_grid *grid;
  for (int a = 0; a < 2; a++) {
    for (size_t i = 0; i <= count[a]; i++) {
      cuts[a][i] = (double)i / (double)count[a];
    }
  }
  const struct dea_block block = {map_square, NULL, cuts[0], cuts[1], count[0], count[1], 0};
  const struct dea_ply ply = {thickness, 1, 2};
  verify_ok(ctx, dea_grid_create(ctx, order, &block, 1, &ply, 1, NULL, -0.5 * thickness, 1, &grid));
  return grid;
}

/* Both sides of the slit are at one place: what is held and what is loaded is told on the square.
 */
static struct plate plate_create(const struct problem *problem, int order, const size_t count[2])
{
  static const double nowhere[3] = {0, 0, 0};
  static double elastic[2]; // lent to the solid; one plate at a time
  elastic[0] = problem->modulus;
  const struct dea_part_material layer = dea_part_material_bonded(elastic);
  const struct dea_solid_options options = {
      .order_z = 2, .part_material_count = 1, .part_materials = &layer, .held = not_held};
  const double traction[3] = {0, 0, problem->traction};
  struct plate plate = {.grid = unit_square(order, count, problem->thickness)};
  struct dea_arena memory = {.ctx = ctx};
  struct dea_surface *end;
  size_t nodes = plate.grid->node_count;
  bool *clamped = dea_alloc(ctx, nodes, sizeof *clamped);
  plate.force = dea_alloc(ctx, nodes, 3 * sizeof *plate.force);
  if (clamped == NULL || plate.force == NULL) {
    exit(1);
  }
  memset(plate.force, 0, nodes * 3 * sizeof *plate.force);
  verify_ok(ctx, dea_surface_create(ctx, plate.grid, DEA_FACE_SECOND_HIGH, at_loaded_end, NULL,
                                    &memory, &end));
  for (size_t n = 0; n < nodes; n++) {
    double *X = plate.grid->X + 3 * n, x[2];
    clamped[n] = X[1] < 1e-9;
    for (int i = 0; i < 2; i++) {
      if (X[1] > 1 - 1e-9 && fabs(X[0] - i) < 1e-9 && fabs(X[2]) < 1e-9) {
        plate.corner[i] = n;
      }
    }
    problem->bend(X[0], X[1], x);
    memcpy(X, x, sizeof x);
  }
  dea_load_traction(end, traction, plate.force);
  dea_arena_free(&memory);
  verify_ok(ctx, dea_solid_create(ctx, plate.grid, &options, &plate.solid));
  for (size_t n = 0; n < nodes; n++) {
    if (clamped[n]) {
      verify_ok(ctx, dea_solid_prescribe(ctx, plate.solid, n, 1 | 2 | 4, nowhere));
    }
  }
  dea_free(ctx, clamped);
  return plate;
}

static void plate_destroy(struct plate *plate)
{
  dea_solid_destroy(ctx, plate->solid);
  dea_grid_destroy(ctx, plate->grid);
  dea_free(ctx, plate->force);
}

/* Steps of the load and tangents on the way to where a plate is. */
struct effort {
  int steps, iterations, shifted;
  int limits, modes; // limit points; most unstable modes
};

/* Goes to a share of the load by a solve. */
static void plate_solve(struct plate *plate, double share, struct effort *effort)
{
  struct dea_solid_report report;
  for (size_t i = 0; i < 3 * plate->grid->node_count; i++) {
    dea_solid_force(plate->solid)[i] = share * plate->force[i];
  }
  verify_ok(ctx, dea_load_steps_solve(ctx, plate->solid, 0, &report));
  effort->modes = report.unstable_modes > effort->modes ? report.unstable_modes : effort->modes;
  effort->steps++;
  effort->iterations += report.iterations;
  effort->shifted += report.shifted;
}

/* Goes to the whole load along the path, by steps that are as long as they can be, and from beyond
 * it back by a solve. */
static void plate_follow(struct plate *plate, struct effort *effort)
{
  const struct dea_continuation_options options = {0.1, 0, 2, false};
  struct dea_solid_continuation *trace;
  struct dea_continuation_point point = {0};
  memcpy(dea_solid_force(plate->solid), plate->force,
         3 * plate->grid->node_count * sizeof *plate->force);
  verify_ok(ctx, dea_solid_continuation_create(ctx, plate->solid, 0, &options, &trace));
  while (point.load < 1) {
    verify_ok(ctx, dea_solid_continuation_step(ctx, trace, &point));
    effort->modes = point.unstable_modes > effort->modes ? point.unstable_modes : effort->modes;
    effort->limits += point.passed == DEA_CONTINUATION_LIMIT;
    effort->steps++;
    effort->iterations += point.iterations;
  }
  dea_solid_continuation_destroy(ctx, trace);
  plate_solve(plate, 1, effort);
}

static double rise_at(const struct plate *plate, int corner)
{
  return dea_solid_displacement(plate->solid)[3 * plate->corner[corner] + 2];
}

/* Largest component of the Green strain (C - 1)/2 of an element at its Gauss points. */
static double strain_of(const struct dea_hex_shape *shape, const double *X, const double *u,
                        const int *nodes)
{
  double most = 0;
  for (int q = 0; q < shape->gauss; q++) {
    double map[9] = {0}, now[9] = {0}, cof[9], F[9] = {0};
    for (int k = 0; k < 9 * shape->nodes; k++) {
      int i = k % 9 / 3, a = k % 3, n = k / 9;
      size_t dof = 3 * (size_t)nodes[n] + (size_t)i;
      map[3 * i + a] += X[dof] * shape->slope[q][a][n];
      now[3 * i + a] += (X[dof] + u[dof]) * shape->slope[q][a][n];
    }
    double volume = dea_cofactors(map, cof);
    for (int k = 0; k < 27; k++) { // F = now map^-1, map^-1 = cof^T/volume
      int i = k / 9, J = k / 3 % 3, a = k % 3;
      F[3 * i + J] += now[3 * i + a] * cof[3 * J + a] / volume;
    }
    for (int J = 0; J < 3; J++) {
      for (int L = 0; L < 3; L++) {
        double C = F[J] * F[L] + F[3 + J] * F[3 + L] + F[6 + J] * F[6 + L];
        most = fmax(most, 0.5 * fabs(C - (J == L ? 1 : 0)));
      }
    }
  }
  return most;
}

static double largest_strain(const struct plate *plate)
{
  struct dea_hex_shape shape;
  double most = 0;
  verify_ok(ctx, dea_hex_shape_create(plate->grid->order, 2, &shape));
  for (size_t e = 0; e < plate->grid->element_count; e++) {
    most = fmax(most, strain_of(&shape, plate->grid->X, dea_solid_displacement(plate->solid),
                                plate->grid->nodes + e * DEA_HEX_NODES_MAX));
  }
  return most;
}

/* ---- the page ---- */

struct mesh {
  int order;
  size_t count[2];
  bool fine; // within 1 %
};

static const double tolerance = 1e-2, coarse = 0.25;

/* A difference in %, bold where the mesh is fine. */
static void print_rise(double got, double wanted, bool fine)
{
  double off = verify_relative("rise", got, wanted, fine ? tolerance : coarse);
  printf(fine ? " %.3f | **%+.2f %%** |" : " %.3f | %+.2f %% |", got, 100 * off);
}

static void print_mesh(const struct mesh *mesh, const struct plate *plate)
{
  printf("| %d | %zu x %zu | %zu |", mesh->order, mesh->count[0], mesh->count[1],
         plate->grid->node_count);
}

static void print_effort(const struct mesh *mesh, const struct plate *plate,
                         const struct effort *effort)
{
  if (mesh->fine) {
    verify_absolute("unstable modes", effort->modes, 0, 0);
    verify_absolute("limit points", effort->limits, 0, 0);
  }
  printf(" %.2f %% | %d | %d | %d | %d |\n", 100 * largest_strain(plate), effort->steps,
         effort->iterations, effort->modes, effort->limits);
  fflush(stdout);
}

static void cantilever_row(const struct mesh *mesh)
{
  static const double share[] = {0.2, 0.5, 1}, wanted[] = {2.493, 4.933, 6.698};
  struct plate plate = plate_create(&cantilever, mesh->order, mesh->count);
  struct effort effort = {0};
  print_mesh(mesh, &plate);
  for (int i = 0; i < 3; i++) {
    plate_solve(&plate, share[i], &effort);
    print_rise(rise_at(&plate, 0), wanted[i], mesh->fine);
  }
  print_effort(mesh, &plate, &effort);
  plate_destroy(&plate);
}

static void annulus_row(const struct mesh *mesh)
{
  static const double wanted[] = {13.891, 17.528}; // inner and outer corner
  struct plate plate = plate_create(&annulus, mesh->order, mesh->count);
  struct effort effort = {0};
  plate_follow(&plate, &effort);
  print_mesh(mesh, &plate);
  for (int i = 0; i < 2; i++) {
    print_rise(rise_at(&plate, i), wanted[i], mesh->fine);
  }
  print_effort(mesh, &plate, &effort);
  plate_destroy(&plate);
}

/* What a first solve without the path costs. */
static void print_first_solve(void)
{
  static const size_t count[2] = {1, 8};
  static const double share = 0.01;
  struct plate plate = plate_create(&annulus, 3, count);
  struct effort effort = {0};
  plate_solve(&plate, share, &effort);
  printf("\nA solve at a given load takes more: from rest to %g of the load, on 1 x 8 elements of "
         "order 3, %d iterations, %d\nfactorisations of them with a shift, which is above the "
         "stiffness of bending. A path needs no shift.\n",
         share, effort.iterations, effort.shifted);
  plate_destroy(&plate);
}

static void print_head(void)
{
  puts("# Thin solids in large bending\n\n"
       "Made by `scripts/verify plates`; not to be edited. Two of the popular benchmarks of Sze, "
       "Liu and Lo (2004), made for\nshells, with layered hexahedra: one element through the "
       "thickness (order 2 there), order 2 or 3 in the plane, nothing\nadded against locking. "
       "Tolerance 1 % for the differences in bold; the others, within 25 %, show how coarse meshes "
       "lock. nu = 0.\n\n"
       "The material is the compressible neo-Hookean one of fibres, mu = E/2 and lambda = 0, with "
       "S = mu (1 - 1/C). That of the\nbenchmark (St Venant-Kirchhoff) has S = 2 mu e, the same to "
       "first order in the Green strain e = (C - 1)/2; the next\nterm, -4 mu e^2, is even through "
       "the thickness and has no moment in bending. The tables give the largest component of e\nat "
       "any Gauss point.\n\n"
       "*Steps*: of the load. *Iterations*: tangents that were assembled on the way, those of "
       "failed attempts too. *Modes*: most\nunstable ones on the way. *Limits*: limit points "
       "passed. "
       "A fine mesh has none of either.");
}

int main(int argc, char **argv)
{
  static const struct mesh strips[] = {{3, {1, 5}, true},
                                       {2, {1, 10}, false},
                                       {2, {1, 20}, true},
                                       {2, {1, 40}, true},
                                       {3, {1, 10}, true}};
  static const struct mesh rings[] = {{3, {1, 8}, false},  {3, {2, 16}, false}, {3, {2, 24}, false},
                                      {3, {3, 24}, true},  {3, {4, 36}, true},  {2, {2, 16}, false},
                                      {2, {4, 32}, false}, {2, {6, 48}, false}};
  bool small = verify_is_small(argc, argv);
  verify_ok(NULL, dea_context_create(NULL, &ctx));
  verify_ok(ctx, dea_solid_start(ctx));
  print_head();
  puts("\n## Cantilever\n\n10 x 1 x 0.1, E 1.2e6, shear force P up to 4 over the face of the free "
       "end; its rise W at 0.2, 0.5 and 1.0 of P, by a\nsolve for each. Reference: 2.493, 4.933, "
       "6.698.\n\n| order | elements | nodes | W(0.2) | difference | W(0.5) | difference | W(1) | "
       "difference | strain | steps | iterations | modes | limits "
       "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
  for (size_t i = 0; i < (small ? 1 : sizeof strips / sizeof strips[0]); i++) {
    cantilever_row(&strips[i]);
  }
  puts("\n## Slit annular plate\n\nRadii 6 and 10, thickness 0.03, E 21e6. One side of the slit is "
       "clamped, the other lifted by q = 0.8 per length (over its\nface). W at its inner (A) and "
       "outer (B) corner; reference: 13.891 and 17.528. Elements: across x along the ring. "
       "By\narc-length (`dea_solid_continuation`) until the load is passed, and back to it by a "
       "solve.\n\n| order | elements | nodes | W(A) | difference | W(B) | difference | strain | "
       "steps | iterations | modes | limits |\n|---|---|---|---|---|---|---|---|---|---|---|---|");
  for (size_t i = 0; i < (small ? 1 : sizeof rings / sizeof rings[0]); i++) {
    annulus_row(&rings[i]);
  }
  if (!small) {
    puts("\nOrder 2 locks: at equal nodes its error is more than twice that of order 3. Its "
         "coarsest mesh even snaps.");
  }
  print_first_solve();
  dea_solid_stop();
  dea_context_destroy(ctx);
  return verify_end();
}
