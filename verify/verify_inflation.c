/* Inflated neo-Hookean membranes as thin solids (benchmark 7): a flat clamped disc, a balloon. */
#include "verify.h"

#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/load/loads.h"

#include "../tests/quarter_grid.h"

static struct dea_context *ctx;

/* A thin solid under follower pressure on its bottom side; modulus mu 1, radius R 1. */
struct shell {
  double H; // thickness
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_arena memory; // of the load
  struct dea_pressure *pressure;
};

/* Solid, surface and load for the grid of the shell. */
static void shell_fill(struct shell *shell, int (*held)(const void *self, const double X[3]))
{
  static const double origin[3] = {0, 0, 0};
  struct dea_part_material rubber = {.law = dea_law_find("neo-hookean"),
                                     .param = {1},
                                     .pre_stretch = {1, 1, 1},
                                     .kappa_Pa = 100,
                                     .thickness_m = shell->H};
  verify_ok(ctx, dea_part_material_relax(&rubber));
  const struct dea_solid_options options = {
      .order_z = 2, .part_material_count = 1, .part_materials = &rubber, .held = held};
  verify_ok(ctx, dea_solid_create(ctx, shell->grid, &options, &shell->solid));
  struct dea_surface *inside;
  shell->memory.ctx = ctx;
  verify_ok(ctx, dea_surface_create(ctx, shell->grid, DEA_FACE_BOTTOM, NULL, NULL, &shell->memory,
                                    &inside));
  verify_ok(ctx, dea_pressure_create(ctx, inside, origin, false, &shell->memory, &shell->pressure));
  const struct dea_solid_load load = dea_pressure_load(shell->pressure);
  verify_ok(ctx, dea_solid_add_load(ctx, shell->solid, &load));
}

static void shell_destroy(struct shell *shell)
{
  dea_solid_destroy(ctx, shell->solid);
  dea_arena_free(&shell->memory);
  dea_grid_destroy(ctx, shell->grid);
}

/* Goes to p R/(mu H). */
static dea_status inflate(struct shell *shell, double p, int *modes)
{
  struct dea_solid_report report;
  dea_pressure_set(shell->pressure, p * shell->H);
  dea_status status = dea_load_steps_solve(ctx, shell->solid, 0, &report);
  *modes = report.unstable_modes;
  return status;
}

/* ---- disc ---- */

/* The rim is held at its middle line: a membrane does not resist turning there, and elements much
 * wider than the film is thick cannot follow the bend of a clamped face. */
static int rim_held(const void *self, const double X[3])
{
  (void)self;
  bool rim = hypot(X[0], X[1]) > 1 - 1e-9 && fabs(X[2]) < 1e-9;
  return rim ? 7 : (X[0] < 1e-9 ? 1 : 0) | (X[1] < 1e-9 ? 2 : 0);
}

/* Rise of the pole and its stretch in the middle surface: u_x = c1 x + c3 x^3 there. */
static double pole(const struct shell *disc, double *w)
{
  const double *u = dea_solid_displacement(disc->solid);
  double x[2] = {INFINITY, INFINITY}, c[2] = {0, 0};
  for (size_t n = 0; n < disc->grid->node_count; n++) {
    const double *X = disc->grid->X + 3 * n;
    if (fabs(X[1]) > 1e-9 || fabs(X[2]) > 1e-9) {
      continue;
    }
    if (X[0] < 1e-9) {
      *w = u[3 * n + 2];
    } else if (X[0] < x[0]) {
      x[1] = x[0];
      c[1] = c[0];
      x[0] = X[0];
      c[0] = u[3 * n] / X[0];
    } else if (X[0] < x[1]) {
      x[1] = X[0];
      c[1] = u[3 * n] / X[0];
    }
  }
  double s0 = x[0] * x[0], s1 = x[1] * x[1];
  return 1 + (c[0] * s1 - c[1] * s0) / (s1 - s0);
}

/* Pressure at which the pole has a stretch, by secants; the disc is left there. */
static double pressure_at(struct shell *disc, double stretch, double p[2], double w[1], int *modes)
{
  double before = 0, now;
  for (int i = 0; i < 20; i++) {
    verify_ok(ctx, inflate(disc, p[1], modes));
    now = pole(disc, w) - stretch;
    if (fabs(now) < 1e-6) {
      return p[1];
    }
    double next = i == 0 ? p[1] - 0.02 * now : p[1] - now * (p[1] - p[0]) / (now - before);
    before = now;
    p[0] = p[1];
    p[1] = fmin(next, p[0] + 0.2); // not over the limit point
  }
  verify_failures++;
  return NAN;
}

static void disc_rows(double H, int order, size_t fine, size_t stretches)
{
  static const double stretch[] = {1.1, 1.5, 2}, start[] = {0.45, 1.55, 1.84};
  static const double p_exact[] = {0.52778, 1.64358, 1.86955};
  static const double w_exact[] = {0.38347, 0.79879, 1.08307};
  struct shell disc = {.H = H};
  double p_last = 0;
  const struct dea_quarter quarter = {order, 2, 0.5, 1, H, .fine = fine};
  verify_ok(ctx, dea_grid_quarter(ctx, &quarter, &disc.grid));
  shell_fill(&disc, rim_held);
  for (size_t i = 0; i < stretches; i++) {
    double w = 0, p[2];
    int modes;
    for (; p_last < start[i] - 1e-9; p_last += 0.1) {
      verify_ok(ctx, inflate(&disc, fmin(p_last + 0.1, start[i]), &modes));
    }
    p[0] = p_last = start[i];
    p[1] = start[i] + 0.01;
    double found = pressure_at(&disc, stretch[i], p, &w, &modes);
    p_last = found;
    printf("| %g | %zu | %.1f | %.5f | %+.2f %% | %.5f | %+.2f %% | %d |\n", H,
           disc.grid->node_count, stretch[i], found,
           100 * verify_relative("p", found, p_exact[i], 1e-2), w,
           100 * verify_relative("w", w, w_exact[i], 1e-2), modes);
    fflush(stdout);
  }
  shell_destroy(&disc);
}

/* ---- balloon: an octant, bent from a triangle of three blocks ---- */

/* Corner block of the triangle (0, 0), (1, 0), (0, 1) in its first two barycentric coordinates:
 * corner, middle of an edge, centre, middle of the other edge. */
struct corner {
  double at[4][2];
};

static void map_corner(const void *self, double s, double t, double x[2])
{
  const struct corner *c = self;
  for (int i = 0; i < 2; i++) {
    x[i] = (1 - s) * (1 - t) * c->at[0][i] + s * (1 - t) * c->at[1][i] + s * t * c->at[2][i] +
           (1 - s) * t * c->at[3][i];
  }
}

static int octant_held(const void *self, const double X[3])
{
  (void)self;
  return (X[0] < 1e-9 ? 1 : 0) | (X[1] < 1e-9 ? 2 : 0) | (X[2] < 1e-9 ? 4 : 0);
}

static struct shell balloon_create(double H, size_t count)
{
  static const double third = 1.0 / 3;
  static const struct corner corners[3] = {
      {{{0, 0}, {0.5, 0}, {third, third}, {0, 0.5}}},
      {{{1, 0}, {0.5, 0.5}, {third, third}, {0.5, 0}}},
      {{{0, 1}, {0, 0.5}, {third, third}, {0.5, 0.5}}},
  };
  double cuts[17];
  struct dea_block blocks[3];
  struct shell balloon = {.H = H};
  for (size_t i = 0; i <= count; i++) {
    cuts[i] = (double)i / (double)count;
  }
  for (int i = 0; i < 3; i++) {
    blocks[i] = (struct dea_block){map_corner, &corners[i], cuts, cuts, count, count, 0};
  }
  const struct dea_ply ply = {H, 1, 2};
  verify_ok(ctx, dea_grid_create(ctx, 2, blocks, 3, &ply, 1, NULL, -0.5 * H, 1, &balloon.grid));
  for (size_t n = 0; n < balloon.grid->node_count; n++) {
    double *X = balloon.grid->X + 3 * n, r = 1 + X[2];
    const double b[3] = {X[0], X[1], fmax(0, 1 - X[0] - X[1])};
    double length = sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    for (int i = 0; i < 3; i++) {
      X[i] = r * (b[i] < 1e-12 ? 0 : b[i]) / length;
    }
  }
  shell_fill(&balloon, octant_held);
  return balloon;
}

/* Mean stretch of the middle surface. */
static double balloon_stretch(const struct shell *balloon)
{
  const double *u = dea_solid_displacement(balloon->solid);
  double sum = 0;
  size_t count = 0;
  for (size_t n = 0; n < balloon->grid->node_count; n++) {
    const double *X = balloon->grid->X + 3 * n, *v = u + 3 * n;
    double R = sqrt(X[0] * X[0] + X[1] * X[1] + X[2] * X[2]);
    if (fabs(R - 1) < 1e-9) {
      double x[3] = {X[0] + v[0], X[1] + v[1], X[2] + v[2]};
      sum += sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
      count++;
    }
  }
  return sum / (double)count;
}

/* p R/(mu H) of a balloon without thickness. */
static double balloon_pressure(double stretch)
{
  return 2 * (1 / stretch - pow(stretch, -7));
}

static const size_t shown_nodes = 200; // of a coarser mesh the largest difference alone

static void balloon_row(const struct shell *balloon, int modes, double *most)
{
  double stretch = balloon_stretch(balloon), wanted = balloon_pressure(stretch);
  double p = dea_pressure_at_Pa(balloon->pressure, NULL) / balloon->H;
  double off = verify_relative("balloon", p, wanted, 1e-2);
  *most = fmax(*most, fabs(off));
  if (balloon->grid->node_count > shown_nodes) {
    printf("| %g | %zu | %.4f | %.5f | %.5f | %+.2f %% | %d |\n", balloon->H,
           balloon->grid->node_count, stretch, p, wanted, 100 * off, modes);
  }
}

/* Up to p R/(mu H) = 1.2 by solves, then along the path, where the balloon grows as the pressure
 * falls. */
static void balloon_rows(double H, size_t count, double end)
{
  const struct dea_continuation_options options = {0.05, 0.2, 1, false};
  struct shell balloon = balloon_create(H, count);
  struct dea_solid_continuation *trace;
  struct dea_continuation_point point;
  double most = 0;
  for (int step = 1; step <= 6; step++) {
    int modes;
    verify_ok(ctx, inflate(&balloon, 0.2 * step, &modes));
    balloon_row(&balloon, modes, &most);
  }
  double shown = balloon_stretch(&balloon);
  dea_pressure_set(balloon.pressure, 1.3 * H);
  verify_ok(ctx, dea_solid_continuation_create(ctx, balloon.solid, 0, &options, &trace));
  for (int limits = 0, i = 0; balloon_stretch(&balloon) < end && i < 60; i++) {
    verify_ok(ctx, dea_solid_continuation_step(ctx, trace, &point));
    if (point.passed == DEA_CONTINUATION_LIMIT) {
      struct dea_continuation_point limit;
      verify_absolute("number of limit points", ++limits, 1, 0);
      verify_ok(ctx, dea_solid_continuation_locate(ctx, trace, &limit));
      double p = dea_pressure_at_Pa(balloon.pressure, NULL) / H,
             stretch = balloon_stretch(&balloon);
      printf("| %g | %zu | **%.4f** (1.3831) | **%.5f** | 1.23946 | %+.2f %% | |\n", H,
             balloon.grid->node_count, stretch, p,
             100 * verify_relative("largest pressure", p, 1.239463, 1e-2));
      verify_relative("stretch of it", stretch, 1.383088, 1e-2);
    } else if (balloon_stretch(&balloon) > 1.15 * shown) {
      shown = balloon_stretch(&balloon);
      balloon_row(&balloon, point.unstable_modes, &most);
    }
  }
  verify_absolute("end of the path", balloon_stretch(&balloon) >= end, 1, 0);
  printf("| %g | %zu | to %.2f | | | %.2f %% at most | |\n", H, balloon.grid->node_count,
         balloon_stretch(&balloon), 100 * most);
  fflush(stdout);
  dea_solid_continuation_destroy(ctx, trace);
  shell_destroy(&balloon);
}

int main(int argc, char **argv)
{
  bool small = verify_is_small(argc, argv);
  verify_ok(NULL, dea_context_create(NULL, &ctx));
  verify_ok(ctx, dea_solid_start(ctx));
  puts("# Inflated membranes\n\n"
       "Made by `scripts/verify inflation`; not to be edited. Neo-Hookean rubber (mu) as a thin "
       "solid of layered\nhexahedra, one through the thickness H, with follower pressure p on its "
       "inner side (benchmark 7).\nTolerance 1 %.\n\n"
       "## Flat disc of radius R, held at the middle line of its rim\n\n"
       "Pressure and rise w of the pole at which the pole has a stretch, against the membrane's "
       "ordinary differential\nequation.\n\n"
       "| H/R | nodes | pole stretch | p R/(mu H) | difference | w/R | difference | unstable modes "
       "|\n|---|---|---|---|---|---|---|---|");
  disc_rows(0.01, 2, 2, small ? 2 : 3);
  if (!small) {
    disc_rows(0.002, 2, 2, 3);
    disc_rows(0.002, 2, 4, 3);
  }
  puts("\n"
       "The rim has to be free to turn: a film whose face is clamped there bends within a few H, "
       "which elements of 0.1 R cannot follow.\n"
       "\n"
       "## Balloon of radius R\n"
       "\n"
       "An octant with three mirror planes, by solves up to 1.2, then along its path through the "
       "largest pressure (bold, located).\n"
       "Exact: p R/(mu H) = 2 (1/l - 1/l^7) at a stretch l, largest 1.239463 at 1.383088.\n"
       "\n"
       "| H/R | nodes | stretch | p R/(mu H) | exact | difference | unstable modes |\n"
       "|---|---|---|---|---|---|---|");
  balloon_rows(0.01, 2, small ? 1.5 : 2.5);
  if (!small) {
    balloon_rows(0.01, 4, 2.5);
  }
  dea_solid_stop();
  dea_context_destroy(ctx);
  return verify_end();
}
