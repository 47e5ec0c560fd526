/* What weight does to the paper's actuator, and what turning it over does: the paper saw no
 * influence and could not resolve it. */
#include "runs.h"

enum { WAYS = 3 };
static const struct variant eight = {{{"fibres.count", "8"}}};
static const struct variant four = {{{NULL, NULL}}};
static const struct variant way[WAYS] = {
    {{{"gravity", "off"}}}, {{{"gravity", "fibres_up"}}}, {{{"gravity", "fibres_down"}}}};

/* Points of the three ways in the same steps. */
static void all_ways(const struct variant *variant, double step_V, double top_V,
                     struct swept run[WAYS])
{
  for (int i = 0; i < WAYS; i++) {
    run[i] = sweep("3d", variant, &way[i], step_V, top_V);
  }
}

static double share(double with, double without)
{
  return 100 * (with - without) / without;
}

/* Without the sign of a zero. */
static double shown(double um)
{
  return fabs(um) < 0.005 ? 0 : um;
}

static void actuator(const char *name, const struct swept run[WAYS])
{
  printf("## %s, as built\n\n"
         "z of the centre in um, positive towards the fibres; moved: since 0 V; up: where the "
         "centre has gone in the room since 0 V.\n\n"
         "| V (kV) | no weight | fibres on top: z | moved | up | fibres below: z | moved | up | "
         "weight's share of z | of what moved |\n|---|---|---|---|---|---|---|---|---|---|\n",
         name);
  for (size_t i = 0; i < run[0].count; i++) {
    double V = run[0].at[i].voltage_V, z[WAYS], moved[WAYS];
    for (int k = 0; k < WAYS; k++) {
      z[k] = centre_um(&run[k], V);
      moved[k] = z[k] - centre_um(&run[k], 0);
    }
    printf("| %.0f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | ", 1e-3 * V, shown(z[0]),
           z[1], moved[1], moved[1], z[2], moved[2], shown(-moved[2]));
    if (i == 0) {
      puts("| |");
    } else {
      printf("%+.1f %%, %+.1f %% | %+.1f %%, %+.1f %% |\n", share(z[1], z[0]), share(z[2], z[0]),
             share(moved[1], z[0]), share(moved[2], z[0]));
      // weight is small: what it does is odd in its direction
      verify_absolute("weight up and down", (z[1] + z[2]) / (2 * z[0]), 1, 2e-3);
    }
  }
  puts("");
}

/* A plain disc: rho g R^2 / (4 sigma). */
static void disc(void)
{
  static const struct variant plain = {{{"fibres", "null"}}};
  struct swept run = sweep("3d", &plain, &way[1], 1e3, 0);
  double exact = 970 * DEA_STANDARD_GRAVITY_M_PER_S2 * 15e-3 * 15e-3 / (4 * 797.745e3);
  printf("A plain film sags %.3f um at rest; rho g R^2 / (4 sigma) = %.3f um with the pre-stress "
         "of 797.7 kPa.\n\n",
         -centre_um(&run, 0), 1e6 * exact);
  verify_relative("sag of a plain film", -1e-6 * centre_um(&run, 0), exact, 5e-3);
}

int main(int argc, char **argv)
{
  bool small = verify_is_small(argc, argv);
  struct swept run[WAYS];
  if (dea_context_create(NULL, &runs_ctx) != DEA_OK) {
    return 1;
  }
  puts("# Weight, and turning the actuator over\n\n"
       "Made by `scripts/verify gravity`; not to be edited. Model `3d`, default mesh, a sector; "
       "film "
       "970, fibres 1375 kg/m^3 (Table 1), g = 9.80665 m/s^2;\n`gravity: fibres_up` and "
       "`fibres_down` of a design. The paper (5.1) saw no influence of gravity.\n");
  disc();
  all_ways(&eight, small ? 3e3 : 1e3, small ? 3e3 : 7e3, run);
  actuator("Eight fibres, 100 um", run);
  if (!small) {
    double z = centre_um(&run[0], 7e3);
    printf("**At 7 kV the weight makes %.1f um of %.1f um: %.1f %%.** ",
           fabs(centre_um(&run[1], 7e3) - z), fabs(z), fabs(share(centre_um(&run[1], 7e3), z)));
    printf("The film goes away from the fibres whichever way the actuator lies: down with the "
           "fibres\non top, up with the fibres below. Turned over, the displacement in the room "
           "changes its sign and its size since 0 V by %.1f %%.\n\n",
           fabs(100 *
                (centre_um(&run[2], 7e3) - centre_um(&run[2], 0) - centre_um(&run[1], 7e3) +
                 centre_um(&run[1], 0)) /
                z));
    all_ways(&four, 1e3, 7e3, run);
    actuator("Four fibres, 100 um", run);
  }
  dea_context_destroy(runs_ctx);
  return verify_end();
}
