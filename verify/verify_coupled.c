/* The coupled field where it is resolved: the cut along a fibre in plane strain, a film with
 * elements through it that are graded to both faces and to the electrode's edge, with a fibre that
 * begins there. Against verify/coupled_plane.py, a program of its own for the same cut, and the
 * exact fringe of two plates that end inside a film. */
#include "verify.h"

#include "model/solid/assembly/film_state.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/mesh/cuts.h"

#include <math.h>

static struct dea_context *ctx;

/* ---- the cut ---- */

enum { THROUGH_MAX = 32, ALONG_MAX = 100, FIBRE = 1 };
static const double a_m = 3.75e-3, b_m = 15e-3, h_m = 0.1e-3 / 2.25, fibre_m = 100e-6;
static const double epsilon = 2.8 * DEA_EPSILON_0, stretch = 1.5;

static size_t through; // elements through the film

struct part {
  double from_m, to_m;
};

static void map_part(const void *self, double s, double t, double x[2])
{
  const struct part *part = self;
  x[0] = part->from_m + s * (part->to_m - part->from_m);
  x[1] = h_m * t;
}

static int held(const void *self, const double X[3])
{
  (void)self;
  bool end = X[0] > b_m * (1 - 1e-9);
  return 2 | (end || X[0] < 1e-9 * b_m ? 1 : 0) | (end ? 4 : 0);
}

static bool electrode(const void *self, const double X[3], double *share)
{
  (void)self;
  *share = X[2] > 0 ? 1 : 0;
  return X[0] < a_m * (1 + 1e-9) && fabs(fabs(X[2]) - 0.5 * h_m) < 1e-6 * h_m;
}

static bool present(const void *self, int region, int ply)
{
  (void)self;
  return region == FIBRE || ply < (int)through;
}

static bool active(const void *self, int region, int ply)
{
  (void)self;
  return region != FIBRE && ply < (int)through;
}

static int part_material_of(const void *self, int region, int ply)
{
  (void)self;
  (void)region;
  return ply < (int)through ? 0 : FIBRE;
}

/* The film's elements as plies of their own: each twice as thick as the one before it, from both
 * faces to the middle. */
static void set_plies(struct dea_ply *plies)
{
  double sum = 0;
  for (size_t k = 0; k < through; k++) {
    size_t from_face = k < through - 1 - k ? k : through - 1 - k;
    plies[k] = (struct dea_ply){ldexp(1, (int)from_face), 1, 2};
    sum += plies[k].thickness_m;
  }
  for (size_t k = 0; k < through; k++) {
    plies[k].thickness_m *= h_m / sum;
  }
  plies[through] = (struct dea_ply){fibre_m, 2, 2};
}

static void create(enum dea_solid_field_kind field, struct dea_grid **grid,
                   struct dea_solid **solid)
{
  static const double one[] = {0, 1};
  static const struct part parts[] = {{0, 3.75e-3}, {3.75e-3, 15e-3}};
  struct dea_ply plies[THROUGH_MAX + 1];
  struct dea_block blocks[2];
  double cuts[2][ALONG_MAX + 1];
  struct dea_part_material layers[] = {{.law = dea_law_find("yeoh"),
                                        .param = {178.4e3, -6e3, 4.2e3},
                                        .pre_stretch = {stretch, stretch, 1 / (stretch * stretch)},
                                        .kappa_Pa = 4e7,
                                        .permittivity_F_per_m = epsilon,
                                        .thickness_m = h_m},
                                       dea_part_material_bonded((const double[]){2950e6, 0.38})};
  verify_ok(ctx, dea_part_material_relax(&layers[0]));
  set_plies(plies);
  for (int i = 0; i < 2; i++) {
    double length = parts[i].to_m - parts[i].from_m, fine = plies[0].thickness_m;
    double wide = i == 0 ? 2 * h_m : 4 * h_m;
    size_t count = dea_cuts_graded(length, i == 0 ? wide : fine, i == 0 ? fine : wide, 2,
                                   length / 20, ALONG_MAX, cuts[i]);
    blocks[i] = (struct dea_block){map_part, &parts[i], cuts[i], one, count, 1, i};
  }
  const struct dea_solid_options options = {.order_z = 2,
                                            .field = field,
                                            .part_material_count = 2,
                                            .part_materials = layers,
                                            .part_material_of = part_material_of,
                                            .active = active,
                                            .held = held,
                                            .electrode = electrode};
  verify_ok(ctx,
            dea_grid_create(ctx, 2, blocks, 2, plies, through + 1, present, -0.5 * h_m, b_m, grid));
  verify_ok(ctx, dea_solid_create(ctx, *grid, &options, solid));
}

/* ---- what is compared ---- */

enum { VOLTAGES = 3 };
static const double voltages_V[VOLTAGES] = {100, 1000, 2000};

struct cut {
  double tip_m[VOLTAGES];
  double capacitance; // at rest, over eps a/h
  double first;       // thickness of the first element over the film's
  size_t unknowns;
};

/* Up to which voltage: beyond it the finest elements are smaller than what the edge's own strains
 * reach over, and equilibria take minutes (docs/theory/coupled.md). */
static int voltages_of(size_t elements)
{
  return elements <= 6 ? 3 : elements <= 10 ? 2 : 1;
}

static void compute(enum dea_solid_field_kind field, struct cut *out)
{
  const double at[] = {a_m, 0, 0.5 * h_m};
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_report report;
  struct dea_ply plies[THROUGH_MAX + 1];
  create(field, &grid, &solid);
  set_plies(plies);
  out->first = plies[0].thickness_m / h_m;
  size_t tip = dea_grid_nearest(grid, at);
  verify_ok(ctx, dea_load_steps_solve(ctx, solid, 0, &report));
  verify_ok(ctx, dea_solid_capacitance(ctx, solid, false, &out->capacitance));
  out->capacitance /= epsilon * a_m; // the cut is h wide
  out->unknowns = 3 * grid->node_count;
  for (int i = 0; i < voltages_of(through); i++) {
    verify_ok(ctx, dea_load_steps_solve(ctx, solid, voltages_V[i], &report));
    verify_absolute("unstable modes", report.unstable_modes, 0, 0);
    out->tip_m[i] = dea_solid_displacement(solid)[3 * tip + 2];
  }
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* What verify/coupled_plane.py has at as many elements through the film: V/h and coupled field at
 * 100 V, and the coupled field at the other voltages (0: not computed). */
struct other {
  size_t through;
  double thin_m, tip_m[VOLTAGES];
};
static const struct other others[] = {
    {4, -8.8496e-9, {-8.8109e-9, -0.890337e-6, -3.688249e-6}},
    {6, -8.8223e-9, {-8.7571e-9, -0.883945e-6, -3.646980e-6}},
    {8, -8.8065e-9, {-8.7244e-9, -0.879685e-6, 0}},
    {10, -8.7997e-9, {-8.7058e-9, -0.876695e-6, 0}},
    {12, -8.7943e-9, {-8.6921e-9, 0, 0}},
    {14, -8.7931e-9, {-8.6847e-9, 0, 0}},
    {16, -8.7908e-9, {-8.6779e-9, 0, 0}},
};
enum { OTHERS = sizeof others / sizeof others[0] };

/* The limit of a difference of tips that goes with the root of the element's size. */
static double limit_of(double coarse, double fine, double coarse_first, double fine_first)
{
  double ratio = sqrt(coarse_first / fine_first);
  return fine + (fine - coarse) / (ratio - 1);
}

static void compare(const struct cut *cut)
{
  const double pi = 3.14159265358979323846, exact = h_m * log(4) / (2 * pi) / a_m;
  if (through >= 4) {
    verify_absolute("excess of the capacitance", cut->capacitance - 1, exact, 2e-4);
  }
  for (size_t k = 0; k < OTHERS; k++) {
    for (int i = 0; i < voltages_of(through) && others[k].through == through; i++) {
      verify_relative("tip against the other program", cut->tip_m[i], others[k].tip_m[i], 1e-2);
    }
  }
}

/* The other program's table, its limit and ours, of the differences to V/h at 100 V on the two
 * finest meshes. */
static void write_others(const double difference[2], const double first[2])
{
  puts("\n## Another program\n\n"
       "`verify/coupled_plane.py`: displacements and potential biquadratic, pressure linear and "
       "discontinuous, stresses by hand and tangents\nby complex steps, with scipy; it shares no "
       "line with this engine. Coupled field, um; tolerance 1 %.\n\n"
       "| elements | V/h, 100 V | coupled | | 1 kV | 2 kV |\n|---|---|---|---|---|---|");
  double theirs[2] = {0};
  for (size_t k = 0; k < OTHERS; k++) {
    const double *z = others[k].tip_m;
    theirs[0] = theirs[1];
    theirs[1] = z[0] / others[k].thin_m - 1;
    printf("| %zu | %.6f | %.6f | %+.3f |", others[k].through, 1e6 * others[k].thin_m, 1e6 * z[0],
           100 * theirs[1]);
    for (int i = 1; i < VOLTAGES; i++) {
      z[i] != 0 ? printf(" %.5f |", 1e6 * z[i]) : printf(" |");
    }
    puts("");
  }
  double mine = limit_of(difference[0], difference[1], first[0], first[1]);
  double limit = limit_of(theirs[0], theirs[1], 1 / 254.0, 1 / 510.0);
  printf("\nWith the root of the size, which is the order that theory has, the difference at small "
         "voltage goes to %+.2f %% by the last two of these\nmeshes, and to %+.2f %% by our last "
         "two; tolerance 0.05 %%.\n",
         100 * limit, 100 * mine);
  verify_absolute("limit of the difference to V/h", mine, limit, 5e-4);
}

/* V/h and the coupled field on one mesh. */
static void row(double *difference, double *first)
{
  struct cut thin, coupled;
  compute(DEA_SOLID_FIELD_THIN, &thin);
  compute(DEA_SOLID_FIELD_COUPLED, &coupled);
  *difference = coupled.tip_m[0] / thin.tip_m[0] - 1;
  *first = coupled.first;
  printf("| %zu | h/%.0f | %zu | %.4f |", through, 1 / coupled.first, coupled.unknowns,
         100 * (coupled.capacitance - 1));
  for (int i = 0; i < voltages_of(through); i++) {
    printf(" %.5f | %.5f | %+.2f |", 1e6 * thin.tip_m[i], 1e6 * coupled.tip_m[i],
           100 * (coupled.tip_m[i] / thin.tip_m[i] - 1));
  }
  for (int i = voltages_of(through); i < VOLTAGES; i++) {
    printf(" | | |");
  }
  puts("");
  fflush(stdout);
  compare(&coupled);
}

int main(int argc, char **argv)
{
  bool small = verify_is_small(argc, argv);
  verify_ok(NULL, dea_context_create(NULL, &ctx));
  verify_ok(ctx, dea_solid_start(ctx));
  puts(
      "# The coupled field at an electrode's edge\n\n"
      "Made by `scripts/verify coupled`; not to be edited. The cut along a fibre in plane strain: "
      "a "
      "film of 44.4 um (Yeoh 178.4, -6.0,\n4.2 kPa; eps_r 2.8; pre-stretch 1.5), x = 0 a plane of "
      "symmetry, held at 15 mm, electrodes to 3.75 mm, PET of 100 um on it from\nthere on. "
      "Elements of order 2, through the film each twice as thick as the one before it from both "
      "faces to the middle, in the plane as small at the electrode's\nedge "
      "([coupled.md](../theory/coupled.md)). First: the thickness of the first of them. "
      "Capacitance at rest: by how much it is above\neps a/h, in %; exact is 0.2615 (two plates "
      "that end inside a film are longer by h ln 4/(2 pi)); tolerance 0.02 from four elements "
      "on.\nTip: its lift with the field V/h and with the coupled one, in um, and the difference "
      "in %.\n\n"
      "| elements | first | unknowns | capacitance | V/h, 100 V | coupled | | 1 kV | coupled | | 2 "
      "kV | coupled | |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|");
  static const size_t counts[] = {1, 2, 4, 6, 8, 10, 12};
  double difference[2] = {0}, first[2] = {0};
  for (size_t k = 0; k < (small ? 3 : sizeof counts / sizeof counts[0]); k += small ? 2 : 1) {
    through = counts[k];
    difference[0] = difference[1];
    first[0] = first[1];
    row(&difference[1], &first[1]);
  }
  if (!small) {
    write_others(difference, first);
  }
  dea_solid_stop();
  dea_context_destroy(ctx);
  return verify_end();
}
