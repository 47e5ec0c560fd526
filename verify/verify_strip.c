/* A pre-stretched film on a stiff beam and beyond its end: the film as a membrane beside a solid
 * film whose mesh has converged, in plane strain. */
#include "verify.h"

#include "model/solid/assembly/solid.h"
#include "model/solid/element/membrane.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/mesh/cuts.h"

enum { CUTS_MAX = 200, HALVINGS_MAX = 8, PARTS = 3 };
enum { LAYER_FILM, LAYER_BOND, LAYER_BEAM, LAYERS };
enum { REGION_BEAM, REGION_ELECTRODE, REGION_BARE };

static struct dea_context *ctx;
static const double beam_m = 3e-3, electrode_m = 1.5e-3, bare_m = 1.5e-3, width_m = 0.2e-3;
static const double beam_thickness_m = 100e-6;
static const double usual_m = 100e-6 / 2.25, usual_V = 5e3; // film and voltage that others follow
static const double largest_m = 0.15e-3;                    // elements along the strip

/* A film of a thickness whose tension, stiffness and Maxwell force per width are the usual ones. */
struct strip {
  double h_m, voltage_V;
  bool membrane;
  int halvings; // of the film's thickness, down to the elements at the beam
  double cuts[PARTS][CUTS_MAX + 1];
  struct dea_part_material layers[LAYERS];
  struct dea_grid *grid;
  struct dea_solid *solid;
};

/* ---- mesh ---- */

struct part {
  double start, length;
};

static void map_part(const void *self, double s, double t, double x[2])
{
  const struct part *part = self;
  x[0] = part->start + s * part->length;
  x[1] = t * width_m;
}

/* The film is all plies but the last (solid) or the first one (membrane). */
static bool present_in_solid(const void *self, int region, int ply)
{
  (void)self;
  return ply != HALVINGS_MAX + 1 || region == REGION_BEAM;
}

static bool present_in_membrane(const void *self, int region, int ply)
{
  (void)self;
  return ply == 0 || region == REGION_BEAM;
}

/* Solid: from below h/2, h/4, ..., and the last of them twice; what is left over is not there. */
static size_t fill_sheets(const struct strip *s, struct dea_ply *plies)
{
  if (s->membrane) {
    plies[0] = (struct dea_ply){0, 1, 2};
    plies[1] = (struct dea_ply){0.5 * s->h_m, 1, 2};
    plies[2] = (struct dea_ply){beam_thickness_m, 1, 2};
    return 3;
  }
  for (int k = 0; k <= HALVINGS_MAX; k++) {
    double share = exp2(k < s->halvings ? -k - 1 : -s->halvings);
    plies[k] = (struct dea_ply){k <= s->halvings ? s->h_m * share : 0, k <= s->halvings, 2};
  }
  plies[HALVINGS_MAX + 1] = (struct dea_ply){beam_thickness_m, 1, 2};
  return HALVINGS_MAX + 2;
}

static void make_grid(struct strip *s)
{
  static const double across[2] = {0, 1};
  const double tip = s->h_m * exp2(-s->halvings), other = 0.5 * s->h_m;
  const struct part parts[PARTS] = {
      {0, beam_m}, {beam_m, electrode_m}, {beam_m + electrode_m, bare_m}};
  const double ends[PARTS][2] = {{other, tip}, {tip, other}, {other, other}};
  struct dea_ply plies[HALVINGS_MAX + 2];
  struct dea_block blocks[PARTS];
  for (int k = 0; k < PARTS; k++) {
    size_t count = dea_cuts_graded(parts[k].length, ends[k][0], ends[k][1], 2, largest_m, CUTS_MAX,
                                   s->cuts[k]);
    blocks[k] = (struct dea_block){map_part, &parts[k], s->cuts[k], across, count, 1, k};
  }
  size_t ply_count = fill_sheets(s, plies);
  verify_ok(ctx, dea_grid_create(ctx, 2, blocks, PARTS, plies, ply_count,
                                 s->membrane ? present_in_membrane : present_in_solid,
                                 s->membrane ? 0 : -0.5 * s->h_m, beam_m, &s->grid));
}

/* ---- solid ---- */

static int layer_of(const void *self, int region, int ply)
{
  const struct strip *s = self;
  (void)region;
  if (s->membrane) {
    return ply == 0 ? LAYER_FILM : ply == 1 ? LAYER_BOND : LAYER_BEAM;
  }
  return ply == HALVINGS_MAX + 1 ? LAYER_BEAM : LAYER_FILM;
}

static bool active(const void *self, int region, int ply)
{
  return region == REGION_ELECTRODE && layer_of(self, region, ply) == LAYER_FILM;
}

/* Plane strain; both ends are clamped. */
static int held(const void *self, const double X[3])
{
  double close = 1e-9 * beam_m, end = beam_m + electrode_m + bare_m;
  (void)self;
  return X[0] < close || X[0] > end - close ? 1 | 2 | 4 : 2;
}

static void make_layers(struct strip *s)
{
  static const double yeoh[3] = {178.4e3, -6e3, 4.2e3}; // paper Table 1
  const double scale = usual_m / s->h_m;
  s->layers[LAYER_FILM] = (struct dea_part_material){.law = dea_law_find("yeoh"),
                                                     .pre_stretch = {1.5, 1.5, 1 / 2.25},
                                                     .kappa_Pa = 4e7 * scale,
                                                     .permittivity_F_per_m = 2.8 * DEA_EPSILON_0,
                                                     .thickness_m = s->h_m};
  for (int i = 0; i < 3; i++) {
    s->layers[LAYER_FILM].param[i] = scale * yeoh[i];
  }
  s->layers[LAYER_BEAM] = dea_part_material_bonded((const double[]){2950e6, 0.38});
  verify_ok(ctx, dea_part_material_relax(&s->layers[LAYER_FILM]));
  verify_ok(ctx, dea_membrane_bond(&s->layers[LAYER_FILM], &s->layers[LAYER_BOND]));
}

/* ---- answers ---- */

struct answer {
  double tip_m, end_m; // z of the beam's lower face at its end; x of the electrode's far end
  size_t nodes;
};

static const double *displacement_at(const struct strip *s, double x, double z)
{
  const double *u = dea_solid_displacement(s->solid);
  for (size_t n = 0; n < s->grid->node_count; n++) {
    const double *X = s->grid->X + 3 * n;
    if (fabs(X[0] - x) < 1e-9 * beam_m && X[1] == 0 && fabs(X[2] - z) < 1e-9 * beam_m) {
      return u + 3 * n;
    }
  }
  fprintf(stderr, "no node at x %g z %g\n", x, z);
  exit(1);
}

static struct answer solve(double h_m, bool membrane, int halvings)
{
  enum { STEPS = 5 };
  struct strip strip = {.h_m = h_m,
                        .voltage_V = usual_V * sqrt(h_m / usual_m),
                        .membrane = membrane,
                        .halvings = halvings};
  struct dea_solid_report report;
  make_layers(&strip);
  make_grid(&strip);
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = LAYERS,
                                            .part_materials = strip.layers,
                                            .part_material_of = layer_of,
                                            .active = active,
                                            .held = held,
                                            .self = &strip};
  verify_ok(ctx, dea_solid_create(ctx, strip.grid, &options, &strip.solid));
  for (int i = 0; i <= STEPS; i++) {
    verify_ok(ctx, dea_load_steps_solve(ctx, strip.solid, strip.voltage_V * i / STEPS, &report));
    verify_absolute("unstable modes", report.unstable_modes, 0, 0);
  }
  struct answer answer = {displacement_at(&strip, beam_m, 0.5 * h_m)[2],
                          displacement_at(&strip, beam_m + electrode_m, 0)[0],
                          strip.grid->node_count};
  dea_solid_destroy(ctx, strip.solid);
  dea_grid_destroy(ctx, strip.grid);
  return answer;
}

/* ---- the page ---- */

static void print_pair(const struct answer *solid, const struct answer *membrane)
{
  printf(" %zu | %.4f | %.3f | %zu | %.4f | %.3f |", solid->nodes, 1e6 * solid->tip_m,
         1e6 * solid->end_m, membrane->nodes, 1e6 * membrane->tip_m, 1e6 * membrane->end_m);
}

/* Meshes of both at the usual thickness, each halved at the tip. */
static void show_meshes(int from, int to)
{
  struct answer before[2];
  puts("\n## Meshes, film of 44.4 um\n\nThe last two solids agree within 0.1 %, the last two "
       "membranes too.\n\n| elements at the tip | nodes, solid | tip (um) | electrode's end (um) | "
       "nodes, membrane | tip | electrode's end |\n|---|---|---|---|---|---|---|");
  for (int halvings = from; halvings <= to; halvings++) {
    struct answer now[2] = {solve(usual_m, false, halvings), solve(usual_m, true, halvings)};
    printf("| h/%.0f |", exp2(halvings));
    print_pair(&now[0], &now[1]);
    puts("");
    fflush(stdout);
    for (int k = 0; k < 2 && halvings == to; k++) {
      verify_relative(k == 0 ? "last two solids" : "last two membranes", now[k].tip_m,
                      before[k].tip_m, 1e-3);
    }
    memcpy(before, now, sizeof before);
  }
}

static void show_thicknesses(int count, int halvings)
{
  double before = 0;
  printf(
      "\n## Thickness of the film\n\nElements of h/%.0f at the tip. The difference is below 10 %% "
      "at 44.4 um, and each time the\nthickness is halved it becomes 0.45 to 0.6 of what it "
      "was: it goes with the thickness.\n\n| h (um) | voltage (V) | nodes, solid | tip (um) | "
      "electrode's end (um) | nodes, membrane | tip | electrode's end | difference at the tip | "
      "of the one before |\n|---|---|---|---|---|---|---|---|---|---|\n",
      exp2(halvings));
  for (int i = 0; i < count; i++) {
    double h_m = usual_m * exp2(-i);
    struct answer solid = solve(h_m, false, halvings), membrane = solve(h_m, true, halvings);
    double difference = membrane.tip_m / solid.tip_m - 1;
    printf("| %.2f | %.0f |", 1e6 * h_m, usual_V * sqrt(h_m / usual_m));
    print_pair(&solid, &membrane);
    printf(" %+.2f %% |", 100 * difference);
    if (i == 0) {
      verify_absolute("difference at 44.4 um", difference, 0.05, 0.05);
      puts(" |");
    } else {
      verify_absolute("difference over the one before", difference / before, 0.525, 0.075);
      printf(" %.3f |\n", difference / before);
    }
    fflush(stdout);
    before = difference;
  }
}

int main(int argc, char **argv)
{
  bool small = verify_is_small(argc, argv);
  verify_ok(NULL, dea_context_create(NULL, &ctx));
  verify_ok(ctx, dea_solid_start(ctx));
  puts("# Bonded strip: membrane beside solid film\n\n"
       "Made by `scripts/verify strip`; not to be edited. Plane strain: a PET beam (2950 MPa, "
       "0.38) of 3 mm x 100 um, clamped at\none end, on a film with pre-stretch 1.5 (Elastosil "
       "2030, the paper's Table 1) that is clamped there too and goes on\nalone for 3 mm beyond "
       "the beam's tip, to a fixed end. Electrodes on the first half of what goes on alone. "
       "5 kV at\n44.4 um (100 um unstretched). For thinner films moduli go as 1/h and V^2 as h, so "
       "that tension, stiffness and\nMaxwell force per width stay what they are.\n\n"
       "*Solid*: hexahedra of order 2; through the film they halve towards the beam, down to what "
       "they are along the strip at\nthe tip. *Membrane*: the film as a surface, joined to the "
       "beam through the half of it below (docs/theory/membrane.md),\non the same cuts along the "
       "strip. Tip: deflection of the beam's lower face at its end. Electrode's end: displacement "
       "of\nits far end along the strip. No state has an unstable mode.");
  if (!small) {
    show_meshes(2, 7);
  }
  show_thicknesses(small ? 2 : 4, small ? 2 : 6);
  dea_context_destroy(ctx);
  return verify_end();
}
