/* The coupled field where it is resolved: the cut along a fibre in plane strain, a film with
 * elements through it that are graded to both faces and to the electrode's edge, with a fibre that
 * begins there. Against verify/coupled_plane.py, a program of its own for the same cut, and the
 * exact fringe of two plates that end inside a film. */
#include "verify.h"

#include "model/solid/assembly/film.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/mesh/cuts.h"

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

static int constituent_of(const void *self, int region, int ply)
{
  (void)self;
  (void)region;
  return ply < (int)through ? 0 : FIBRE;
}

/* The film's elements as plies of their own, as model 3d cuts its film. */
static void set_plies(struct dea_ply *plies)
{
  double cuts[THROUGH_MAX + 1];
  dea_cuts_through(through, cuts);
  for (size_t k = 0; k < through; k++) {
    plies[k] = (struct dea_ply){h_m * (cuts[k + 1] - cuts[k]), 1, 2};
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
  struct dea_constituent layers[] = {{.law = dea_law_find("yeoh"),
                                      .param = {178.4e3, -6e3, 4.2e3},
                                      .pre_stretch = {stretch, stretch, 1 / (stretch * stretch)},
                                      .kappa_Pa = 4e7,
                                      .permittivity_F_per_m = epsilon,
                                      .thickness_m = h_m},
                                     dea_constituent_bonded((const double[]){2950e6, 0.38})};
  verify_ok(ctx, dea_constituent_relax(&layers[0]));
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
                                            .constituent_count = 2,
                                            .constituents = layers,
                                            .constituent_of = constituent_of,
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
  size_t unknowns;
};

static void compute(enum dea_solid_field_kind field, struct cut *out)
{
  const double at[] = {a_m, 0, 0.5 * h_m};
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_report report;
  create(field, &grid, &solid);
  size_t tip = dea_grid_nearest(grid, at);
  verify_ok(ctx, dea_load_steps_solve(ctx, solid, 0, &report));
  verify_ok(ctx, dea_solid_capacitance(ctx, solid, &out->capacitance));
  out->capacitance /= epsilon * a_m; // the cut is h wide
  out->unknowns = 3 * grid->node_count;
  for (int i = 0; i < VOLTAGES; i++) {
    verify_ok(ctx, dea_load_steps_solve(ctx, solid, voltages_V[i], &report));
    verify_absolute("unstable modes", report.unstable_modes, 0, 0);
    out->tip_m[i] = dea_solid_displacement(solid)[3 * tip + 2];
  }
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
}

/* What verify/coupled_plane.py has at as many elements through the film. */
struct other {
  size_t through;
  double tip_m[VOLTAGES];
};
static const struct other others[] = {
    {4, {-8.81e-9, -0.89034e-6, -3.68825e-6}},
    {8, {-8.72e-9, -0.87968e-6, -3.57738e-6}},
};

static void compare(const struct cut *cut)
{
  const double pi = 3.14159265358979323846, exact = h_m * log(4) / (2 * pi) / a_m;
  if (through >= 4) {
    verify_absolute("excess of the capacitance", cut->capacitance - 1, exact, 2e-4);
  }
  for (size_t k = 0; k < sizeof others / sizeof others[0]; k++) {
    for (int i = 0; i < VOLTAGES && others[k].through == through; i++) {
      verify_relative("tip against the other program", cut->tip_m[i], others[k].tip_m[i], 1e-2);
    }
  }
}

static void write_others(void)
{
  puts("\nWith one and two elements the difference has the wrong sign at small voltage, and it "
       "still "
       "grows with the mesh.\n\n"
       "## Another program\n\n"
       "`verify/coupled_plane.py`: displacements and potential biquadratic, pressure linear and "
       "discontinuous, stresses by hand and tangents\nby complex steps, with scipy; it shares no "
       "line with this engine. Coupled field, um; tolerance 1 %.\n\n"
       "| elements | 100 V | 1 kV | 2 kV |\n|---|---|---|---|");
  for (size_t k = 0; k < sizeof others / sizeof others[0]; k++) {
    const double *z = others[k].tip_m;
    printf("| %zu | %.5f | %.5f | %.5f |\n", others[k].through, 1e6 * z[0], 1e6 * z[1], 1e6 * z[2]);
  }
}

/* V/h and the coupled field on one mesh. */
static void row(void)
{
  struct cut thin, coupled;
  compute(DEA_SOLID_FIELD_THIN, &thin);
  compute(DEA_SOLID_FIELD_COUPLED, &coupled);
  printf("| %zu | %zu | %.4f |", through, coupled.unknowns, 100 * (coupled.capacitance - 1));
  for (int i = 0; i < VOLTAGES; i++) {
    printf(" %.5f | %.5f | %+.2f |", 1e6 * thin.tip_m[i], 1e6 * coupled.tip_m[i],
           100 * (coupled.tip_m[i] / thin.tip_m[i] - 1));
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
      "Elements "
      "of order 2, through the film graded to both faces, in the plane as small at the electrode's "
      "edge\n([coupled.md](../theory/coupled.md)). Capacitance at rest: by how much it is above "
      "eps "
      "a/h, in %; exact is 0.2615 (two plates that\nend inside a film are longer by h ln 4/(2 "
      "pi)); "
      "tolerance 0.02 from four elements on. Tip: its lift with the field V/h and with\nthe "
      "coupled "
      "one, in um, and the difference in %.\n\n"
      "| elements | unknowns | capacitance | V/h, 100 V | coupled | | 1 kV | coupled | | 2 kV | "
      "coupled | |\n|---|---|---|---|---|---|---|---|---|---|---|---|");
  for (through = 1; through <= 4; through *= small ? 4 : 2) {
    row();
  }
  if (!small) {
    write_others();
  }
  dea_solid_stop();
  dea_context_destroy(ctx);
  return verify_end();
}
