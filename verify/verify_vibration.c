/* Vibrations and the response to an AC excitation against closed forms and a published measurement,
 * and what the paper's actuators do. */
#include "runs.h"

#include "material/plane.h"
#include "model/solid/assembly/solid.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/motion/response.h"

static const double pi = 3.14159265358979323846;
static bool small;

/* ---- rectangles of film in a frame ---- */

struct film {
  double size[2], thickness_m, stretch, density_kg_per_m3;
  struct dea_material material;
};

static void map_film(const void *self, double s, double t, double x[2])
{
  const struct film *film = self;
  x[0] = film->size[0] * s;
  x[1] = film->size[1] * t;
}

static int in_frame(const void *self, const double X[3])
{
  const struct film *film = self;
  for (int i = 0; i < 2; i++) {
    if (X[i] < 1e-9 || X[i] > film->size[i] - 1e-9) {
      return 7;
    }
  }
  return 0;
}

static bool everywhere(const void *self, int region, int ply)
{
  (void)self;
  (void)region;
  (void)ply;
  return true;
}

static double stress(const struct film *film)
{
  struct dea_plane plane;
  verify_ok(runs_ctx, dea_plane_elastic(&film->material, film->stretch, film->stretch, &plane));
  return film->stretch * plane.s1;
}

/* First frequency of a tense rectangle in vacuo. */
static double closed_form_Hz(const struct film *film, double tension_Pa)
{
  return 0.5 * sqrt(tension_Pa / film->density_kg_per_m3) *
         hypot(1 / film->size[0], 1 / film->size[1]);
}

/* The same by elements: a solid or a membrane. kappa: over the shear modulus. */
static double computed_Hz(const struct film *film, bool membrane, double kappa, double voltage_V)
{
  const double mu = film->material.law->shear_modulus(film->material.param), l = film->stretch;
  struct dea_part_material layer = {.pre_stretch = {l, l, 1 / (l * l)},
                                    .kappa_Pa = kappa * mu,
                                    .permittivity_F_per_m = 1e-11,
                                    .thickness_m = film->thickness_m,
                                    .density_kg_per_m3 = film->density_kg_per_m3};
  dea_part_material_set_law(&layer, film->material.law, film->material.param);
  enum { PIECES = 8 };
  double cuts[2][PIECES + 1], square;
  for (int i = 0; i < 2; i++) { // the film bends over about its thickness at the frame
    double d = 1.5 * film->thickness_m / film->size[i];
    const double half[] = {0, d, 6 * d, 0.2, 0.5};
    for (int k = 0; k <= PIECES / 2; k++) {
      cuts[i][k] = half[k];
      cuts[i][PIECES - k] = 1 - half[k];
    }
  }
  const struct dea_block block = {map_film, film, cuts[0], cuts[1], PIECES, PIECES, 0};
  const struct dea_ply ply = {membrane ? 0 : film->thickness_m, 1, membrane ? 1 : 2};
  const struct dea_solid_options options = {.order_z = membrane ? 1 : 2,
                                            .part_material_count = 1,
                                            .part_materials = &layer,
                                            .active = everywhere,
                                            .held = in_frame,
                                            .self = film};
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_report report;
  verify_ok(runs_ctx, dea_part_material_relax(&layer));
  verify_ok(runs_ctx,
            dea_grid_create(runs_ctx, 3, &block, 1, &ply, 1, NULL, 0, film->size[0], &grid));
  verify_ok(runs_ctx, dea_solid_create(runs_ctx, grid, &options, &solid));
  verify_ok(runs_ctx, dea_load_steps_solve(runs_ctx, solid, voltage_V, &report));
  verify_ok(runs_ctx, dea_solid_modes_lowest(runs_ctx, solid, DEA_MODES_BY_MASS, 1, &square, NULL));
  dea_solid_destroy(runs_ctx, solid);
  dea_grid_destroy(runs_ctx, grid);
  return sqrt(square) / (2 * pi);
}

static struct film gent_film(double stretch)
{
  struct film film = {.size = {0.1, 0.05},
                      .thickness_m = 50e-6,
                      .stretch = stretch,
                      .density_kg_per_m3 = 1000,
                      .material.law = dea_law_find("gent")};
  film.material.param[0] = 43e3;
  film.material.param[1] = 115;
  return film;
}

static void rectangles(void)
{
  puts("## A stretched rectangle in vacuo\n\n100 x 50 mm as stretched, 50 um, Gent 43 kPa, J 115, "
       "1000 kg/m^3; first frequency, f = 1/2 sqrt(sigma/rho (1/a^2 + 1/b^2)). 5 x 5 elements of "
       "order "
       "3, fine at the frame.\n\n| stretch | closed form (Hz) | solid film | off by | membrane | "
       "off by |\n"
       "|---|---|---|---|---|---|");
  for (int i = 1; i <= (small ? 1 : 2); i++) {
    struct film film = gent_film(2 * i);
    double exact = closed_form_Hz(&film, stress(&film));
    double solid = computed_Hz(&film, false, 100, 0), flat = computed_Hz(&film, true, 100, 0);
    printf("| %g | %.2f | %.2f | %+.3f %% | %.2f | %+.3f %% |\n", film.stretch, exact, solid,
           100 * verify_relative("rectangle, solid", solid, exact, 3e-3), flat,
           100 * verify_relative("rectangle, membrane", flat, exact, 1e-3));
  }
  puts("");
  if (small) {
    return;
  }
  struct film film = gent_film(2);
  double soft = computed_Hz(&film, false, 100, 0), hard = computed_Hz(&film, false, 1600, 0);
  verify_relative("no trace of kappa", hard, soft, 1e-4);
}

/* Voltage over all of it: sigma - eps E^2 in the place of sigma. */
static void softening(void)
{
  struct film film = gent_film(2);
  double sigma = stress(&film), slack_V = film.thickness_m * sqrt(sigma / 1e-11);
  printf(
      "## Towards loss of tension\n\nThe same rectangle at stretch 2 with electrodes all over it, "
      "eps "
      "1e-11 F/m: f falls as the root of sigma - eps E^2, to nothing at %.0f V.\n\n| V over that | "
      "closed form (Hz) | solid film | off by |\n|---|---|---|---|\n",
      slack_V);
  static const double share[] = {0, 0.5, 0.8, 0.95};
  for (size_t i = small ? 2 : 0; i < (small ? 3 : sizeof share / sizeof share[0]); i++) {
    double exact = closed_form_Hz(&film, sigma * (1 - share[i] * share[i]));
    double solid = computed_Hz(&film, false, 100, share[i] * slack_V);
    printf("| %g | %.2f | %.2f | %+.2f %% |\n", share[i], exact, solid,
           100 * verify_relative("softening", solid, exact, 1e-2));
  }
  puts(
      "\nBending, which is left when the tension goes, makes the last ones stiffer than the closed "
      "form.\n");
}

/* ---- squares of Elastosil ---- */

/* Air on both sides moves with a standing wave of wave number k as a layer 1/k thick. */
static double in_air(const struct film *film, double vacuum_Hz)
{
  static const double air_kg_per_m3 = 1.2;
  double k = pi * hypot(1 / film->size[0], 1 / film->size[1]);
  double own = film->density_kg_per_m3 * film->thickness_m;
  return vacuum_Hz / sqrt(1 + 2 * air_kg_per_m3 / (k * own));
}

static void squares(void)
{
  static const double published_Hz[] = {417.7, 580.9}, measured_Hz[] = {390, 530};
  static const double stretches[] = {1.15, 1.38}, yeoh[] = {180.7e3, -16.7e3, 6.6e3};
  double solid[2], air[2];
  puts("## Squares of Elastosil 2030\n\n100 um before it was stretched, side 25.4 mm as stretched; "
       "Yeoh "
       "180.7, -16.7, 6.6 kPa, 970 kg/m^3. Published are a model, whose law we do not know, and\n"
       "measurements. In air: with the mass of a layer of air 1/k thick on each side, 1.2 "
       "kg/m^3.\n\n"
       "| stretch | closed form, vacuum (Hz) | solid film, vacuum | off by | in air | published "
       "model | "
       "off by | measured |\n|---|---|---|---|---|---|---|---|");
  for (size_t i = 0; i < (small ? 1 : 2); i++) {
    double l = stretches[i];
    struct film film = {.size = {25.4e-3, 25.4e-3},
                        .thickness_m = 100e-6 / (l * l),
                        .stretch = l,
                        .density_kg_per_m3 = 970,
                        .material.law = dea_law_find("yeoh")};
    memcpy(film.material.param, yeoh, sizeof yeoh);
    double exact = closed_form_Hz(&film, stress(&film));
    solid[i] = computed_Hz(&film, false, 100, 0);
    air[i] = in_air(&film, solid[i]);
    printf("| %g | %.1f | %.1f | %+.2f %% | %.1f | %.1f | %+.2f %% | %.0f |\n", l, exact, solid[i],
           100 * verify_relative("square", solid[i], exact, 5e-3), air[i], published_Hz[i],
           100 * verify_relative("square in air", air[i], published_Hz[i], 1.5e-2), measured_Hz[i]);
  }
  puts("");
  if (small) {
    return;
  }
  printf("That the published model has air in it shows in its ratio of the two, %.3f: a vacuum has "
         "%.3f, air %.3f. Tolerances: 0.5 %% (bending at the frame) and 1.5 %%.\n\n",
         published_Hz[1] / published_Hz[0], solid[1] / solid[0], air[1] / air[0]);
}

/* ---- the paper's actuators ---- */

enum { KINDS = 3 };
static const struct variant kind[KINDS] = {
    {{{"fibres", "null"}}}, {{{NULL, NULL}}}, {{{"fibres.count", "8"}}}};
static const char *const kind_name[KINDS] = {"no fibres", "four fibres", "eight fibres"};

/* Lowest frequencies at voltages of a step, [count] of them. */
static void first_Hz(const struct variant *variant, const struct variant *more, double step_V,
                     size_t count, double *out)
{
  struct opened open = open_model("3d", variant, more);
  for (size_t i = 0; i < count; i++) {
    struct dea_load_point at, mode;
    struct dea_field_mesh *shapes;
    verify_ok(runs_ctx, open.type->solve(runs_ctx, open.model, step_V * (double)i, &at));
    verify_ok(runs_ctx, open.type->modes(runs_ctx, open.model, &at, 1, &mode, &shapes));
    dea_field_mesh_destroy(runs_ctx, shapes);
    out[i] = mode.frequency_Hz;
  }
  close_model(&open);
}

static void actuators(void)
{
  enum { STEPS = 9 };
  size_t count = small ? 2 : STEPS;
  double step_V = small ? 3e3 : 1e3, f[KINDS + 1][STEPS];
  static const struct variant fine = {{{"compute.solid.refinement", "1.5"}}};
  for (int k = 0; k < KINDS; k++) {
    first_Hz(&kind[k], NULL, step_V, count, f[k]);
  }
  first_Hz(&kind[1], small ? NULL : &fine, step_V, count, f[KINDS]);
  double bessel = 2.404825557695773 / (2 * pi * 15e-3) * sqrt(797.745e3 / 970);
  printf(
      "## The paper's actuators, as built\n\nFirst frequency (Hz) in vacuo, 100 um film, 970 "
      "kg/m^3, "
      "fibres of 1375 kg/m^3, a sector, default mesh. A film without fibres and voltage in closed "
      "form:\n2.405/(2 pi R) sqrt(sigma/rho) = %.1f Hz.\n\n| V (kV) | %s | %s | %s | %s, "
      "refinement 1.5 |\n|---|---|---|---|---|\n",
      bessel, kind_name[0], kind_name[1], kind_name[2], kind_name[1]);
  for (size_t i = 0; i < count; i++) {
    printf("| %g |", 1e-3 * step_V * (double)i);
    for (int k = 0; k <= KINDS; k++) {
      printf(f[k][i] < 0 ? " unstable |" : " %.1f |", f[k][i]);
    }
    puts("");
  }
  puts("");
  double low = f[1][count - 1], high = f[1][0], k = 2.404825557695773 / 15e-3;
  double air = 1 / sqrt(1 + 2 * 1.2 / (k * 970 * 100e-6 / 2.25));
  printf("With four fibres that is %.0f to %.0f times the 5 to 10 Hz at which fingertips feel "
         "(section "
         "5.2 of the paper): there the film follows the voltage as if it stood still. The air on "
         "both\n"
         "sides (a layer 1/k thick on each, k = 2.405/R) would take a film without fibres to %.2f "
         "of its "
         "frequency.\n\n",
         low / 10, high / 5, air);
  verify_relative("first frequency of a disc", f[0][0], bessel, 1e-2);
  verify_relative("first frequency on a finer mesh", f[KINDS][0], f[1][0], 1e-2);
}

/* Modes that a sector does not have. */
static void whole_disc(void)
{
  enum { MODES = 6 };
  static const struct variant disc = {{{"compute.solid.domain", "disc"}}};
  puts(
      "The whole disc with four fibres has these lowest modes (a sector has those that are marked; "
      "others come in pairs or break the symmetry):\n\n| V (kV) | frequencies (Hz) |\n|---|---|");
  for (int i = 0; i < 2; i++) {
    struct opened open[2] = {open_model("3d", &kind[1], &disc), open_model("3d", &kind[1], NULL)};
    struct dea_load_point at, mode[2][MODES];
    for (int m = 0; m < 2; m++) {
      struct dea_field_mesh *shapes;
      verify_ok(runs_ctx, open[m].type->solve(runs_ctx, open[m].model, 6e3 * i, &at));
      verify_ok(runs_ctx,
                open[m].type->modes(runs_ctx, open[m].model, &at, MODES, mode[m], &shapes));
      dea_field_mesh_destroy(runs_ctx, shapes);
      close_model(&open[m]);
    }
    printf("| %d |", 6 * i);
    for (int k = 0; k < MODES; k++) {
      double f = mode[0][k].frequency_Hz;
      bool shared = false;
      for (int j = 0; j < MODES; j++) {
        shared = shared || fabs(mode[1][j].frequency_Hz / f - 1) < 1e-3;
      }
      printf(" %.1f%s%s", f, shared ? " (sector)" : "", k + 1 < MODES ? "," : " |\n");
    }
    verify_relative("first mode of disc and sector", mode[0][0].frequency_Hz,
                    mode[1][0].frequency_Hz, 1e-3);
  }
  puts("");
}

/* ---- response to an AC excitation ---- */

/* Slow excitation against the slope of the static answer, and what 5, 10 and 100 Hz make of it. */
static void excitation(void)
{
  static const double Hz[] = {0.01, 5, 10, 100, 250}, step_V = 10;
  static const struct variant elastic = {{{"film.viscosity", "none"}}};
  const struct dea_ac_excitation one = {.amplitude_V = 1, .damping_ratio = 0.02};
  puts("## AC excitation of the voltage\n\nz of the centre per volt of an AC excitation about a "
       "bias, damping "
       "0.02 of the "
       "critical one for each mode. Slope: of static solves 10 V to both sides. Last columns: "
       "amplitude\nat "
       "that frequency over the slow one, and the phase that it lags behind.\n\n| actuator | bias "
       "(kV) | "
       "slope (nm/V) | at 0.01 Hz | off by | 5 Hz | 10 Hz | 100 Hz | 250 Hz |\n"
       "|---|---|---|---|---|---|---|---|---|");
  for (int k = 1; k < (small ? 2 : KINDS); k++) {
    struct opened open = open_model("3d", &kind[k], &elastic);
    for (double V = small ? 4e3 : 2e3; V < (small ? 5e3 : 7e3); V += 2e3) {
      struct dea_load_point at, side[2], p[5];
      verify_ok(runs_ctx, open.type->solve(runs_ctx, open.model, V - step_V, &side[0]));
      verify_ok(runs_ctx, open.type->solve(runs_ctx, open.model, V + step_V, &side[1]));
      verify_ok(runs_ctx, open.type->solve(runs_ctx, open.model, V, &at));
      verify_ok(runs_ctx, open.type->respond(runs_ctx, open.model, &at, &one, Hz, 5, p));
      double slope = (side[1].centre_z_m - side[0].centre_z_m) / (2 * step_V);
      double slow = p[0].centre_amplitude_m * cos(p[0].centre_phase_rad);
      printf("| %s | %g | %.3f | %.3f | %+.3f %% |", kind_name[k], 1e-3 * V, 1e9 * slope,
             1e9 * slow, 100 * verify_relative("slope of the static answer", slow, slope, 2e-3));
      for (int i = 1; i < 5; i++) {
        double lag = 180 / pi * (p[0].centre_phase_rad - p[i].centre_phase_rad);
        printf(" %.4f, %.2f deg |", p[i].centre_amplitude_m / p[0].centre_amplitude_m,
               remainder(lag, 360));
      }
      puts("");
    }
    close_model(&open);
  }
  puts("");
}

int main(int argc, char **argv)
{
  small = verify_is_small(argc, argv);
  if (dea_context_create(NULL, &runs_ctx) != DEA_OK || dea_solid_start(runs_ctx) != DEA_OK) {
    return 1;
  }
  puts("# Small vibrations, and the response to an AC excitation of the voltage\n\nMade by "
       "`scripts/verify "
       "vibration`; not to be edited. Theory: [vibration.md](../theory/vibration.md).\n");
  rectangles();
  softening();
  squares();
  actuators();
  if (!small) {
    whole_disc();
  }
  excitation();
  dea_context_destroy(runs_ctx);
  return verify_end();
}
