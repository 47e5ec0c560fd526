/* Solids in time: creep, delayed pull-in, order of the steps, vibration, balance of energy. */
#include "film_blocks.h"

#include "model/model.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/model3d/solid_state.h"
#include "model/solid/motion/response.h"

static bool small;

/* ---- creep after a small step ---- */

static void creep_page(void)
{
  const double field = 0.02, ratio = 2, tau = 0.5, slow = field * field / 6;
  const int steps = 60, every = 20;
  struct body body = {.size = {1e-3, 1e-3, 100e-6},
                      .count = 1,
                      .pre_stretch = 1,
                      .radius = 1,
                      .held = on_planes,
                      .branches = {1, {{ratio * mu[0], tau}}}};
  const double voltage_V = field * body.size[2] * sqrt(mu[0] / eps),
               end = 9 * tau * (1 + ratio) / 4;
  printf("\n## Creep after a small step of the voltage\n\n"
         "A free film, neo-Hookean, with one branch of G = %g mu; V/H sqrt(eps/mu) = %g at once. "
         "Closed form for small strains (benchmark 6a), within 1 %%; steps of %.3g tau.\n\n"
         "| t/tau | strain of the solid, 1e-6 | closed form | off |\n|---|---|---|---|\n",
         ratio, field, end / steps / tau);
  body_create(&body);
  jump_to(&body, voltage_V);
  for (int i = 0; i <= steps; i++) {
    double t = end * i / steps;
    if (i > 0) {
      verify_ok(ctx, step_to(&body, voltage_V, end / steps));
    }
    double exact = slow * (1 - ratio / (1 + ratio) * exp(-t / ((1 + ratio) * tau)));
    double off = verify_relative("creep", strain_of(&body), exact, 1e-2);
    if (i % every == 0) {
      printf("| %.3f | %.4f | %.4f | %+.1e |\n", t / tau, 1e6 * strain_of(&body), 1e6 * exact, off);
    }
  }
  body_destroy(&body);
}

/* ---- creep to pull-in ---- */

/* Stretch of the homogeneous film under dead loads for the state (a, c) of its branch; NAN where
 * there is no equilibrium. field: V/H sqrt(eps/mu). */
static double stretch_at(double pre, double G, const double state[2], double field, double from)
{
  double l = from;
  for (int i = 0; i < 60; i++) {
    double r = l / pre, force = l - pow(l, -5) - pre + pow(pre, -5) - field * field * l * l * l +
                                G / pre * (state[0] * r - state[1] * pow(r, -5));
    double slope = 1 + 5 * pow(l, -6) - 3 * field * field * l * l +
                   G / (pre * pre) * (state[0] + 5 * state[1] * pow(r, -6));
    if (!(slope > 0)) {
      return NAN;
    }
    l -= force / slope;
    if (fabs(force / slope) < 1e-13) {
      return l;
    }
  }
  return NAN;
}

/* The same in time (units of tau) by the classical Runge-Kutta method; *end: when it finds no
 * equilibrium any more. */
static double integrate(double pre, double G, double field, double time, double *end)
{
  static const double reach[4] = {0, 0.5, 0.5, 1}, weight[4] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
  const double step = 1e-3;
  double state[2] = {1, 1}, l = pre;
  for (int n = 0; n < (int)round(time / step); n++) {
    double k[4][2], sum[2] = {0, 0}, first = NAN;
    for (int i = 0; i < 4; i++) {
      double at[2] = {state[0], state[1]};
      for (int j = 0; j < 2 && i > 0; j++) {
        at[j] += reach[i] * step * k[i - 1][j];
      }
      double now = stretch_at(pre, G, at, field, l), r = now / pre;
      k[i][0] = 1 / (r * r) - at[0];
      k[i][1] = pow(r, 4) - at[1];
      first = i == 0 ? now : first;
      sum[0] += weight[i] * k[i][0];
      sum[1] += weight[i] * k[i][1];
      if (isnan(now)) {
        *end = (n + reach[i]) * step;
        return NAN;
      }
    }
    l = first;
    state[0] += step * sum[0];
    state[1] += step * sum[1];
  }
  return stretch_at(pre, G, state, field, l);
}

/* The film as the active part of model lumped, so small beside the passive one that this holds it
 * as dead loads do. */
struct lumped {
  struct dea_device device;
  const struct dea_model_type *type;
  struct dea_model *model;
  double stretch; // total
};

static void lumped_create(struct lumped *l, double pre, double H, double G, double tau)
{
  struct dea_device *d = &l->device;
  *d = (struct dea_device){.disc = true,
                           .film_thickness_unstretched_m = H,
                           .film_thickness_m = H / (pre * pre),
                           .pre_stretch = pre,
                           .electrode_radius_m = 1e-5,
                           .frame_radius_m = 10e-3,
                           .coverage = 1e-6};
  d->film = (struct dea_material){.name = "film", .law = dea_law_find("neo-hookean")};
  d->film.param[0] = mu[0];
  d->film.permittivity.at_rest = eps / DEA_EPSILON_0;
  d->film.branches[0] = (struct dea_branch){G * mu[0], tau};
  d->film.branch_count = 1;
  l->type = dea_model_find("lumped");
  l->stretch = pre;
  verify_ok(ctx, l->type->create(ctx, d, NULL, &l->model));
  struct dea_load_point point;
  const struct dea_time_options options = {.circuit = {.current_limit_A = INFINITY}, .rho_inf = 1};
  verify_ok(ctx, l->type->solve(ctx, l->model, 0, &point));
  verify_ok(ctx, l->type->begin(ctx, l->model, &options, &point));
}

static dea_status lumped_step(struct lumped *l, double voltage_V, double step_s)
{
  struct dea_load_point point;
  double error;
  const struct dea_time_step step = {.length_s = step_s, .source_voltage_V = voltage_V};
  dea_status status = l->type->advance(ctx, l->model, &step, &point, &error);
  if (status == DEA_OK) {
    l->type->accept(l->model);
    l->stretch = l->device.pre_stretch * point.electrode_stretch;
  }
  return status;
}

/* Time in units of tau at which a step finds no equilibrium however short it is. */
static double find_end(struct body *body, struct lumped *l, double voltage_V, double tau, double t)
{
  for (double step = 0.1; step > 1e-3;) {
    dea_status status =
        body != NULL ? step_to(body, voltage_V, step * tau) : lumped_step(l, voltage_V, step * tau);
    t += status == DEA_OK ? step : 0;
    step /= status == DEA_OK ? 1 : 2;
  }
  return t;
}

static void pull_in_page(void)
{
  const double field = 0.45, G = 1.5, pre = 1.2, tau = 0.2, H = 100e-6;
  struct body body = {.size = {1e-3, 1e-3, H / (pre * pre)},
                      .count = 1,
                      .pre_stretch = pre,
                      .radius = 1,
                      .held = on_planes,
                      .branches = {1, {{G * mu[0], tau}}}};
  const double voltage_V = field * H * sqrt(mu[0] / eps);
  struct lumped lumped;
  double end, step = 0.1, t = 0;
  body_create(&body);
  lumped_create(&lumped, pre, H, G, tau);
  jump_to(&body, voltage_V);
  verify_ok(ctx, lumped_step(&lumped, voltage_V, 0));
  printf("\n## Creep to pull-in\n\nThe film under dead loads that hold a stretch of %g, one branch "
         "of G = %g mu, V/H sqrt(eps/mu) = %g at once: 8 %% above the limit point of the slow film "
         "and far below that of the fast one. Total stretch by the solid, by model lumped (its "
         "electrode a millionth of the film) and by an ODE of the branch's two internal variables "
         "(Runge-Kutta, steps of tau/1000), within 1 %% (benchmark 6b).\n\n"
         "| t/tau | solid | lumped | ODE | solid off | lumped off |\n|---|---|---|---|---|---|\n",
         pre, G, field);
  for (int i = 0; i <= 135; i++, t += step) {
    double wanted = integrate(pre, G, field, t, &end), is = pre * (1 + strain_of(&body));
    double off = verify_relative("stretch of the solid", is, wanted, 1e-2);
    double lumped_off = verify_relative("stretch of model lumped", lumped.stretch, wanted, 1e-2);
    if (i % 45 == 0) {
      printf("| %.1f | %.5f | %.5f | %.5f | %+.1e | %+.1e |\n", t, is, lumped.stretch, wanted, off,
             lumped_off);
    }
    if (i < 135) {
      verify_ok(ctx, step_to(&body, voltage_V, step * tau));
      verify_ok(ctx, lumped_step(&lumped, voltage_V, step * tau));
    }
  }
  t -= step;
  integrate(pre, G, field, 100, &end);
  double solid = find_end(&body, NULL, voltage_V, tau, t);
  double lumped_end = find_end(NULL, &lumped, voltage_V, tau, t);
  printf("| **pull-in at** | %.3f | %.3f | %.3f | %+.1e | %+.1e |\n", solid, lumped_end, end,
         verify_relative("pull-in of the solid", solid, end, 1e-2),
         verify_relative("pull-in of model lumped", lumped_end, end, 1e-2));
  dea_context_clear(ctx);
  lumped.type->destroy(ctx, lumped.model);
  body_destroy(&body);
}

/* ---- order ---- */

struct pulse {
  double strain, pressure_Pa;
  struct dea_solid_energies energies;
};

/* A smooth pulse of the voltage, up to 0.7 of it, in so many steps. */
static struct pulse pulse(struct body body, double length_s, int steps)
{
  const double top = 0.5 * body.size[2] * sqrt(mu[0] / eps);
  struct pulse out;
  struct dea_state state = {0};
  body_create(&body);
  for (int i = 1; i <= steps; i++) {
    double root = sin(pi * 0.7 * i / steps);
    verify_ok(ctx, step_to(&body, top * root * root, 0.7 * length_s / steps));
  }
  size_t displacements = 3 * body.grid->node_count, pressures = 4; // of its one element
  verify_ok(ctx, dea_solid_save(ctx, body.solid, &state));
  out.strain = strain_of(&body);
  out.pressure_Pa = dea_state_find(&state, "state", displacements + pressures)[displacements];
  out.energies = dea_solid_time_energies(body.time, false);
  body_destroy(&body);
  return out;
}

static double balance_of(const struct dea_solid_energies *e)
{
  return (e->stored + e->branches + e->kinetic + e->dissipated + e->damped) / e->supply - 1;
}

static void order_page(void)
{
  enum { RUNS = 4, KINDS = 4 };
  static const char *const names[KINDS] = {"branches", "inertia, rho_inf 0.8", "both, rho_inf 0.8",
                                           "both, rho_inf 0.5"};
  const double length_s = 3e-4;
  const struct dea_branches branches = {2, {{2e5, 1e-4}, {1e5, 1e-3}}};
  struct pulse at[KINDS][RUNS];
  const int runs = RUNS;
  printf("\n## Order of the steps\n\nA free square of 1 mm, mu = 100 kPa, 1000 kg/m^3, under a "
         "smooth pulse of 0.3 ms that makes it swing; "
         "branches of 2 mu with 0.1 ms and 1 mu with 1 ms. Differences of strain and pressure "
         "between so many steps and twice as many; of two orders of a step: the ratio of one "
         "difference to the next is 4. Tolerance of the last ratio: 10 %%. Pressures stop "
         "converging at about 300 steps ([time.md](../theory/time.md)).\n\n"
         "| | steps | strain | difference | ratio | pressure, Pa | difference | ratio |\n"
         "|---|---|---|---|---|---|---|---|\n");
  for (int k = 0; k < KINDS; k++) {
    struct body body = {.size = {1e-3, 1e-3, 100e-6},
                        .count = 1,
                        .pre_stretch = 1,
                        .held = on_planes,
                        .density_kg_per_m3 = k > 0 ? 1000 : 0,
                        .radius = k == 3 ? 0.5 : 0.8};
    body.branches = k == 1 ? body.branches : branches;
    double d[2][RUNS] = {{0}};
    for (int i = 0; i < runs; i++) {
      at[k][i] = pulse(body, length_s, 20 << i);
      printf("| %s | %d | %.8f |", i == 0 ? names[k] : "", 20 << i, at[k][i].strain);
      if (i > 0) {
        d[0][i] = at[k][i].strain - at[k][i - 1].strain;
        d[1][i] = at[k][i].pressure_Pa - at[k][i - 1].pressure_Pa;
      }
      for (int m = 0; m < 2; m++) {
        if (m == 1) {
          printf(" %.3f |", at[k][i].pressure_Pa);
        }
        i > 0 ? printf(" %.2e |", d[m][i]) : printf(" |");
        i > 1 ? printf(" %.2f |", d[m][i - 1] / d[m][i]) : printf(" |");
      }
      printf("\n");
    }
    for (int m = 0; m < 2; m++) {
      verify_relative("ratio of differences", d[m][runs - 2] / d[m][runs - 1], 4, 0.1);
    }
  }
  printf("\n## Balance of energy\n\nOf the same runs with %d steps, in nJ: what the source gave is "
         "what is stored, moves, was dissipated in branches (from their state) and damped by the "
         "steps (from the forces' work), within 0.1 %%.\n\n"
         "| | source | film and field | in branches | kinetic | dissipated | damped | off |\n"
         "|---|---|---|---|---|---|---|---|\n",
         20 << (runs - 1));
  for (int k = 0; k < KINDS; k++) {
    const struct dea_solid_energies e = at[k][runs - 1].energies;
    double off = verify_absolute("balance", balance_of(&e), 0, 1e-3);
    printf("| %s | %.5f | %.5f | %.5f | %.5f | %.5f | %.6f | %+.1e |\n", names[k], 1e9 * e.supply,
           1e9 * e.stored, 1e9 * e.branches, 1e9 * e.kinetic, 1e9 * e.dissipated, 1e9 * e.damped,
           off);
  }
}

/* ---- vibration ---- */

struct swing {
  double period_s, kept; // share of its energy after `periods`
};

static struct swing swing(struct body body, double omega, int per_period, int periods)
{
  struct swing out = {NAN, NAN};
  const double speed = 1e-3, step = 2 * pi / omega / per_period;
  double before = 0, first;
  size_t end = 0;
  int crossings = 0;
  body_create(&body);
  for (size_t n = 0; n < body.grid->node_count; n++) {
    double x = body.grid->X[3 * n] / body.size[0];
    dea_solid_velocity(body.time)[3 * n + 2] = speed * cos(pi * x);
    end = x < 1e-9 ? n : end;
  }
  jump_to(&body, 0);
  first = dea_solid_time_energies(body.time, false).kinetic;
  for (int i = 1; i <= per_period * periods + per_period / 4; i++) {
    verify_ok(ctx, step_to(&body, 0, step));
    double z = dea_solid_displacement(body.solid)[3 * end + 2];
    if (before < 0 && z >= 0) {
      out.period_s = (i - z / (z - before)) * step / ++crossings;
    }
    before = z;
    const struct dea_solid_energies e = dea_solid_time_energies(body.time, false);
    out.kept = (e.kinetic + e.stored) / first;
  }
  body_destroy(&body);
  return out;
}

static void vibration_page(void)
{
  const double L = 40e-3, l = 1.5, density = 1000;
  struct body strip = {.size = {L, 4e-3, 100e-6 / (l * l)},
                       .count = small ? 4 : 8,
                       .pre_stretch = l,
                       .density_kg_per_m3 = density,
                       .radius = 1,
                       .held = gliding_ends};
  double tension = mu[0] * (l * l - pow(l, -4)), square;
  double omega = pi / L * sqrt(tension / density);
  struct body still = strip;
  body_create(&still);
  dea_solid_time_destroy(ctx, still.time);
  still.time = NULL;
  verify_ok(ctx, dea_solid_modes_lowest(ctx, still.solid, DEA_MODES_BY_MASS, 1, &square, NULL));
  body_destroy(&still);
  printf(
      "\n## Free vibration of a stretched membrane\n\nA strip of %.0f mm between ends that glide "
      "across it, stretched by %g in its plane: string, (1/2L) sqrt(sigma/rho) = %.4f Hz. Steps "
      "with rho_inf = 1 lengthen a period by (omega h)^2/12, which is taken off; within 0.1 %%.\n\n"
      "| | frequency, Hz | off |\n|---|---|---|\n| modal analysis, same mesh | %.4f | %+.1e |\n",
      1e3 * L, l, omega / (2 * pi), sqrt(square) / (2 * pi),
      verify_relative("modal frequency", sqrt(square), omega, 1e-3));
  for (int steps = 32; steps <= (small ? 32 : 128); steps *= 2) {
    const struct swing s = swing(strip, omega, steps, 2);
    double h = 2 * pi / steps, frequency = (1 + h * h / 12) / s.period_s;
    printf("| %d steps a period | %.4f | %+.1e |\n", steps, frequency,
           verify_relative("frequency", 2 * pi * frequency, omega, 1e-3));
  }
  printf("\nEnergy that is left after 4 periods of 16 steps; 1 within 1e-6 for rho_inf = 1.\n\n"
         "| rho_inf | energy left |\n|---|---|\n");
  double last = 2;
  for (int i = 0; i < 4; i++) {
    static const double radius[] = {1, 0.8, 0.5, 0};
    strip.radius = radius[i];
    const struct swing s = swing(strip, omega, 16, 4);
    printf("| %g | %.6f |\n", radius[i], s.kept);
    verify_absolute("energy falls with rho_inf", s.kept < last, 1, 0);
    if (i == 0) {
      verify_absolute("energy kept", s.kept, 1, 1e-6);
    }
    last = s.kept;
  }
}

/* ---- a film that is held ---- */

static void held_page(void)
{
  static const double stretch[] = {1, 1.25, 1.5, 2}, ratio[] = {0.5, 20, 1000};
  size_t tried = 0;
  int unstable = 0;
  double moved = 0;
  for (int k = 0; k < 4; k++) {
    for (int i = 0; i < (small ? 1 : 3); i++) {
      struct body body = {.size = {1e-3, 1e-3, 50e-6},
                          .count = small ? 2 : 6,
                          .pre_stretch = stretch[k],
                          .radius = 1,
                          .held = clamped,
                          .branches = {1, {{ratio[i] * mu[0], 1}}}};
      struct dea_solid_report report;
      body_create(&body);
      for (double step = 1e-4; step < 20; step *= 20, tried++) {
        verify_ok(ctx, dea_solid_time_step(ctx, body.time, 0, step, &report));
        unstable += report.unstable_modes;
        verify_ok(ctx, dea_solid_time_close(ctx, body.time, NULL));
        dea_solid_time_accept(body.time);
        moved = fmax(moved, dea_solid_time_motion(body.time));
      }
      body_destroy(&body);
    }
  }
  verify_absolute("false unstable modes", unstable, 0, 0);
  verify_absolute("motion at rest", moved, 0, 1e-12);
  printf("\n## A clamped film at rest\n\nPre-stretch 1 to 2, branches of 0.5 to 1000 mu, steps of "
         "1e-4 to 16 tau: in %zu steps %d unstable modes, largest displacement %.0e m.\n",
         tried, unstable, moved);
}

int main(int argc, char **argv)
{
  small = verify_is_small(argc, argv);
  if (dea_context_create(NULL, &ctx) != DEA_OK) {
    return 1;
  }
  verify_ok(ctx, dea_solid_start(ctx));
  printf(
      "# Time: viscous and inertial steps of solids\n\nWritten by `scripts/verify time`. Theory: "
      "[time.md](../theory/time.md).\n");
  creep_page();
  pull_in_page();
  order_page();
  vibration_page();
  held_page();
  dea_solid_stop();
  dea_context_destroy(ctx);
  return verify_end();
}
