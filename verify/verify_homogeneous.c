/* Films under voltage in equal stretch of both directions as solids, by arc-length through their
 * limit points (benchmark 2), and a film between clamps that buckles. */
#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "verify.h"

static struct dea_context *ctx;

/* A block that is meshed; all of it between electrodes. */
struct body {
  double size[3]; // stretched flat
  size_t count;   // elements along x
  size_t across;  // along y
  int order;
  double kappa_s; // over the one that the layer takes; 0: 1
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_continuation *trace;
};

static void map_body(const void *self, double s, double t, double x[2])
{
  const struct body *body = self;
  x[0] = body->size[0] * s;
  x[1] = body->size[1] * t;
}

static bool all_active(const void *self, int region, int ply)
{
  (void)self;
  (void)region;
  (void)ply;
  return true;
}

static void cut(size_t count, double *cuts)
{
  for (size_t i = 0; i <= count; i++) {
    cuts[i] = (double)i / (double)count;
  }
}

static void body_create(struct body *body, struct dea_part_material layer,
                        int (*held)(const void *self, const double X[3]))
{
  double cuts[2][65];
  layer.thickness_m = body->size[2];
  layer.kappa_Pa = 100 * layer.law->shear_modulus(layer.param);
  verify_ok(ctx, dea_part_material_relax(&layer));
  layer.kappa_s_Pa *= body->kappa_s > 0 ? body->kappa_s : 1;
  cut(body->count, cuts[0]);
  cut(body->across, cuts[1]);
  const struct dea_block block = {map_body, body, cuts[0], cuts[1], body->count, body->across, 0};
  const struct dea_ply ply = {body->size[2], 1, 2};
  verify_ok(ctx, dea_grid_create(ctx, body->order, &block, 1, &ply, 1, NULL, 0, body->size[0],
                                 &body->grid));
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = 1,
                                            .part_materials = &layer,
                                            .active = all_active,
                                            .held = held,
                                            .self = body};
  verify_ok(ctx, dea_solid_create(ctx, body->grid, &options, &body->solid));
}

static void body_destroy(struct body *body)
{
  dea_solid_continuation_destroy(ctx, body->trace);
  dea_solid_destroy(ctx, body->solid);
  dea_grid_destroy(ctx, body->grid);
}

static void trace(struct body *body, double voltage_V, double step, double step_most, double unit_m)
{
  const struct dea_continuation_options options = {step, step_most, unit_m, false};
  verify_ok(ctx,
            dea_solid_continuation_create(ctx, body->solid, voltage_V, &options, &body->trace));
}

/* ---- equal stretch ---- */

#define UNITS .permittivity = 1, .H = 0.1

struct film {
  const char *name, *law;
  double param[DEA_LAW_PARAM_MAX];
  double pre;             // stretch that dead loads hold without voltage
  double end;             // stretch to which the path is followed
  double permittivity, H; // F/m, m unstretched
  double published[4];    // stretch and field of the peak, then of the valley; NAN: has none
  double tolerance;       // of the published numbers: one of their last digit
  double pull_in_V;       // published; 0: none
};

static double force_of(const struct film *film, double stretch) // per area, of the law alone
{
  struct dea_law_energy e;
  double I1 = 2 * stretch * stretch + pow(stretch, -4);
  verify_ok(ctx, dea_law_find(film->law)->invariants(film->param, I1, I1, 0, &e));
  return 2 * (stretch - pow(stretch, -5)) * e.W1;
}

static double modulus_of(const struct film *film)
{
  return dea_law_find(film->law)->shear_modulus(film->param);
}

/* (V/H)^2 eps/mu at a total stretch: what the law's force is beyond the dead one, over stretch^3.
 */
static double exact_square(const struct film *film, double stretch)
{
  return (force_of(film, stretch) - force_of(film, film->pre)) / pow(stretch, 3) / modulus_of(film);
}

static double slope_at(const struct film *film, double stretch)
{
  const double d = 1e-5 * stretch;
  return exact_square(film, stretch + d) - exact_square(film, stretch - d);
}

/* The next stretch above `from` with a limit point, NAN when there is none up to the end. */
static double exact_limit(const struct film *film, double from)
{
  const double by = 0.01;
  double low = from + 1e-3;
  while (low + by < film->end && slope_at(film, low) * slope_at(film, low + by) > 0) {
    low += by;
  }
  double high = low + by;
  if (!(high < film->end)) {
    return NAN;
  }
  for (int i = 0; i < 40; i++) {
    double middle = 0.5 * (low + high);
    *(slope_at(film, low) * slope_at(film, middle) > 0 ? &low : &high) = middle;
  }
  return 0.5 * (low + high);
}

static int on_planes(const void *self, const double X[3])
{
  const struct body *body = self;
  double zero = 1e-9 * body->size[0];
  return (X[0] < zero ? 1 : 0) | (X[1] < zero ? 2 : 0) | (X[2] < zero ? 4 : 0);
}

/* Holds the sides, and lets dead loads take over from the supports. */
static void hang_weights(struct body *body)
{
  const double nowhere[3] = {0, 0, 0};
  struct dea_solid_report report;
  for (int round = 0; round < 2; round++) {
    for (size_t n = 0; n < body->grid->node_count; n++) {
      for (size_t i = 0; i < 2; i++) {
        if (body->grid->X[3 * n + i] > body->size[i] * (1 - 1e-9)) {
          verify_ok(ctx, round == 0 ? dea_solid_prescribe(ctx, body->solid, n, 1 << i, nowhere)
                                    : dea_solid_release(ctx, body->solid, n, 1 << i));
          dea_solid_force(body->solid)[3 * n + i] =
              round == 0 ? 0 : dea_solid_reaction(body->solid)[3 * n + i];
        }
      }
    }
    verify_ok(ctx, dea_load_steps_solve(ctx, body->solid, 0, &report));
  }
}

static struct body film_create(const struct film *film, int order, double kappa_s)
{
  double pre = film->pre, size = 10 * film->H;
  struct body body = {.size = {size, size, film->H / (pre * pre)},
                      .count = 1,
                      .across = 1,
                      .order = order,
                      .kappa_s = kappa_s};
  struct dea_part_material layer = {.pre_stretch = {pre, pre, 1 / (pre * pre)},
                                    .permittivity_F_per_m = film->permittivity};
  dea_part_material_set_law(&layer, dea_law_find(film->law), film->param);
  body_create(&body, layer, on_planes);
  if (pre > 1) {
    hang_weights(&body);
  }
  return body;
}

/* Total stretch and V/H sqrt(eps/mu) where the solid is. */
static double stretch_of(const struct film *film, const struct body *body)
{
  size_t n = dea_grid_nearest(body->grid, (const double[3]){body->size[0], 0, 0});
  return film->pre * (1 + dea_solid_displacement(body->solid)[3 * n] / body->size[0]);
}

static double field_of(const struct film *film, double voltage_V)
{
  return voltage_V / film->H * sqrt(film->permittivity / modulus_of(film));
}

/* A limit point of the solid beside the exact one and, where there is one, the published one. */
static void limit_row(const struct film *film, struct body *body, int number, double *from)
{
  struct dea_continuation_point point;
  static const char *const names[] = {"peak", "valley"};
  verify_ok(ctx, dea_solid_continuation_locate(ctx, body->trace, &point));
  double stretch = stretch_of(film, body), field = field_of(film, point.voltage_V);
  double exact = *from = exact_limit(film, *from);
  double off = verify_relative("stretch of a limit", stretch, exact, 1e-4);
  double field_off =
      verify_relative("field of a limit", field, sqrt(exact_square(film, exact)), 1e-5);
  const double *published = film->published + 2 * (number % 2);
  if (!isnan(published[0])) {
    verify_absolute("published stretch", stretch, published[0],
                    fmax(film->tolerance, 1e-5 * stretch));
  }
  if (!isnan(published[1])) {
    verify_absolute("published field", field, published[1], film->tolerance);
  }
  if (film->pull_in_V > 0 && number == 0) {
    verify_absolute("pull-in", point.voltage_V, film->pull_in_V, 0.5);
  }
  printf("| %s | %s | %.5f | %.6f | %+.0e | %+.0e | |\n", film->name, names[number % 2], stretch,
         field, off, field_off);
}

/* Its limit points, and the largest difference and the counts of unstable modes on its path. */
static void film_rows(const struct film *film)
{
  struct body body = film_create(film, 2, 1);
  double stretch = film->pre, most = 0, from = film->pre;
  int limits = 0, wanted = 0, modes = -1;
  char counts[60] = "";
  trace(&body, 0.7 * film->H * sqrt(modulus_of(film) / film->permittivity), 0.05, 0.3,
        body.size[0]);
  for (int i = 0; i < 400 && stretch < film->end; i++) {
    struct dea_continuation_point point;
    verify_ok(ctx, dea_solid_continuation_step(ctx, body.trace, &point));
    stretch = stretch_of(film, &body);
    double field = field_of(film, point.voltage_V);
    most =
        fmax(most, fabs(verify_relative("field", field, sqrt(exact_square(film, stretch)), 1e-5)));
    if (point.passed == DEA_CONTINUATION_LIMIT) {
      limit_row(film, &body, limits++, &from);
    }
    if (point.unstable_modes != modes) {
      modes = point.unstable_modes;
      size_t used = strlen(counts);
      snprintf(counts + used, sizeof counts - used, "%s%d", used > 0 ? ", " : "", modes);
    }
  }
  printf("| %s | path | to %.2f | | | %.0e | %s |\n", film->name, stretch, most, counts);
  for (double at = film->pre; !isnan(at = exact_limit(film, at));) {
    wanted++;
  }
  verify_absolute("number of limit points", limits, wanted, 0);
  verify_absolute("end of the path", stretch >= film->end, 1, 0);
  body_destroy(&body);
}

static void equal_stretch(bool small)
{
  static const struct film films[] = {
      {.name = "Neo-Hookean, free",
       .law = "neo-hookean",
       .param = {1},
       .pre = 1,
       .end = 2.5,
       UNITS,
       .published = {1.259921, 0.687365, NAN, NAN},
       .tolerance = 1e-6},
      {.name = "the same, dead loads of a stretch of 1.2",
       .law = "neo-hookean",
       .param = {1},
       .pre = 1.2,
       .end = 3,
       UNITS,
       .published = {1.59036, 0.41535, NAN, NAN},
       .tolerance = 1e-5},
      {.name = "the same, dead loads of a stretch of 2",
       .law = "neo-hookean",
       .param = {1},
       .pre = 2,
       .end = 4.5,
       UNITS,
       .published = {2.97042, 0.19507, NAN, NAN},
       .tolerance = 1e-5},
      {.name = "Gent, J = 90",
       .law = "gent",
       .param = {1, 90},
       .pre = 1,
       .end = 5.5,
       UNITS,
       .published = {1.2643, 0.68959, 4.8216, 0.28852},
       .tolerance = 1e-4},
      {.name = "Gent, J = 7, locks up",
       .law = "gent",
       .param = {1, 7},
       .pre = 1,
       .end = 2.1,
       UNITS,
       .published = {NAN, NAN, NAN, NAN}},
      {.name = "Yeoh, the paper's Table 1, 100 um, eps_r 2.8: 8183 V at the peak",
       .law = "yeoh",
       .param = {178.4e3, -6e3, 4.2e3},
       .pre = 1,
       .end = 1.6,
       .permittivity = 2.8 * DEA_EPSILON_0,
       .H = 100e-6,
       .published = {1.2668, NAN, NAN, NAN},
       .tolerance = 1e-4,
       .pull_in_V = 8183}};
  puts("## Equal stretch of both directions\n\n"
       "A square film, dead loads on its sides, one element. Exact: (V/H)^2 eps = (s(l) - "
       "s(l0))/l^3 with the law's force\nper area s at a total stretch l and dead loads that hold "
       "l0. Path: largest difference of the field at its points, and\nthe numbers of unstable "
       "modes along it. Tolerances: 1e-5 of the field at a stretch, 1e-4 of a limit's stretch, the "
       "last\ndigit of published numbers or 1e-5 of a stretch.\n\n"
       "| film | | stretch | V/H sqrt(eps/mu) | stretch off | field off | unstable modes |\n"
       "|---|---|---|---|---|---|---|");
  for (size_t i = 0; i < (small ? 2 : sizeof films / sizeof films[0]); i++) {
    film_rows(&films[i]);
  }
}

/* ---- where modes are counted too early ---- */

/* Voltage at which a mode is counted as unstable for the first time, over that of the limit. */
static double first_mode(int order, double kappa_s)
{
  static const struct film film = {.law = "neo-hookean", .param = {1}, .pre = 1, .end = 2, UNITS};
  struct body body = film_create(&film, order, kappa_s);
  struct dea_continuation_point point = {0};
  double limit = sqrt(exact_square(&film, exact_limit(&film, 1)));
  trace(&body, 0.7 * film.H, 0.1, 0.1, body.size[0]);
  while (point.passed == DEA_CONTINUATION_NOTHING && stretch_of(&film, &body) < film.end) {
    verify_ok(ctx, dea_solid_continuation_step(ctx, body.trace, &point));
  }
  verify_ok(ctx, dea_solid_continuation_locate(ctx, body.trace, &point));
  body_destroy(&body);
  return field_of(&film, point.voltage_V) / limit;
}

static void early_modes(bool small)
{
  static const int orders[] = {2, 3};
  puts("\n"
       "### Where modes are counted too early\n"
       "\n"
       "Areas that change by polynomials of higher degree than the pressures' are held by kappa_s "
       "only ([solid.md](../theory/solid.md)); close to the limit point\n"
       "of a film without pre-stretch such a mode is counted as unstable before the film is. "
       "Neo-Hookean, free; voltage of the first mode that is counted over\n"
       "that of the limit:\n"
       "\n"
       "| order of the element | kappa_s | 10 kappa_s | 100 kappa_s |\n"
       "|---|---|---|---|");
  for (size_t i = 0; i < (small ? 1 : sizeof orders / sizeof orders[0]); i++) {
    printf("| %d |", orders[i]);
    for (double more = 1; more < 200; more *= 10) {
      double share = first_mode(orders[i], more);
      verify_absolute("first mode", share, 1, more > 1 ? 0.01 : 0.04);
      printf(" %.4f |", share);
    }
    puts("");
  }
}

/* ---- a film between clamps ---- */

static int clamped_in_plane_strain(const void *self, const double X[3])
{
  const struct body *body = self;
  return 2 | (X[0] < 1e-9 || X[0] > body->size[0] - 1e-9 ? 7 : 0);
}

static void buckle(size_t count, int order, double h, double tolerance)
{
  const double pi = acos(-1), critical = 4 * pi * pi / 3 * h * h;
  const struct dea_part_material layer = {.law = dea_law_find("neo-hookean"),
                                          .param = {1},
                                          .pre_stretch = {1, 1, 1},
                                          .permittivity_F_per_m = 1};
  struct body body = {.size = {1, 0.1, h}, .count = count, .across = 1, .order = order};
  struct dea_continuation_point point = {0}, fork;
  body_create(&body, layer, clamped_in_plane_strain);
  trace(&body, sqrt(2 * critical) * h, 0.1, 0.2, h);
  while (point.passed == DEA_CONTINUATION_NOTHING && point.load < 1) {
    verify_ok(ctx, dea_solid_continuation_step(ctx, body.trace, &point));
  }
  verify_ok(ctx, dea_solid_continuation_locate(ctx, body.trace, &fork));
  double field = fork.voltage_V / h;
  double off = verify_relative("critical field", field * field, critical, tolerance);
  printf("| %g | %zu, %d | %.6e | %+.2f %% |\n", h, count, order, field * field, 100 * off);
  body_destroy(&body);
}

static void clamps(bool small)
{
  puts("\n## A film that buckles between clamps\n\n"
       "Free of stress, neo-Hookean, plane strain, length L = 1 between the clamps, thickness h. "
       "Flat, it is pushed with\neps (V/h)^2 h per width. A thin plate of it (bending stiffness "
       "mu h^3/3) buckles at 4 pi^2 (mu h^3/3)/L^2. The\nbifurcation is located. Tolerance 1 %, "
       "2 % on 8 elements.\n\n"
       "| h/L | elements, order | eps (V/h)^2/mu | off |\n"
       "|---|---|---|---|");
  buckle(8, 3, 0.01, 0.02);
  if (!small) {
    buckle(16, 3, 0.01, 0.01);
    buckle(32, 3, 0.01, 0.01);
    buckle(32, 3, 0.005, 0.01);
    buckle(48, 2, 0.01, 0.01);
  }
}

int main(int argc, char **argv)
{
  bool small = verify_is_small(argc, argv);
  if (dea_context_create(NULL, &ctx) != DEA_OK) {
    return 1;
  }
  verify_ok(ctx, dea_solid_start(ctx));
  puts("# Films under voltage: limit points and buckling by arc-length\n\n"
       "Made by `scripts/verify homogeneous`; not to be edited. Solids that are followed by "
       "arc-length ([continuation.md](../theory/continuation.md)):\nbenchmark 2, and a plate that "
       "buckles.\n");
  equal_stretch(small);
  early_modes(small);
  clamps(small);
  dea_solid_stop();
  dea_context_destroy(ctx);
  return verify_end();
}
