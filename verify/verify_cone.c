/* A cone: annular film with a rigid hub that is pushed out, hung with a mass, and pushed by a
 * bistable spring; against numbers of membrane theory, and a path of one variable. */
#include "device/device.h"
#include "verify.h"

#include "model/solid/assembly/channels.h"
#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/load/loads.h"

enum { VOLTAGES = 3, PLACES = 7, HUNG = 5, CUTS_MAX = 65, HUB_HELD = 1 | 2 | 8 | 16 | 32 };

static struct dea_context *ctx;

static const double hub_m = 5e-3, frame_m = 20e-3, pi = 3.14159265358979323846;
static const double pre_stretch = 1.2, unstretched_m = 100e-6;
static const double gravity_m_per_s2 = DEA_STANDARD_GRAVITY_M_PER_S2;

static const double voltage_kV[VOLTAGES] = {0, 3, 5};
static const double place_mm[PLACES] = {0.5, 1, 2, 4, 6, 8, 10};
/* Membrane theory with rotational symmetry, integrated apart from this library. */
static const double force_mN[VOLTAGES][PLACES] = {
    {53.043, 106.540, 216.559, 456.943, 731.204, 1040.752, 1389.273},
    {45.764, 91.994, 187.545, 399.248, 644.913, 926.008, 1246.665},
    {32.823, 66.131, 135.930, 296.161, 489.486, 717.192, 984.208}};
static const double hung_kV[HUNG] = {0, 2, 3, 4, 5}, hung_g = 20;
static const double hung_mm[HUNG] = {1.8179, 1.9290, 2.0871, 2.3529, 2.7982};

/* ---- the film ---- */

/* A quarter between the planes x = 0 and y = 0. */
struct cone {
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_body hub;
  struct dea_solid_report report;
};

struct mesh {
  bool membrane;
  int order;
  size_t along, around; // elements from hub to frame, and in the quarter
  double grade;         // width of elements in the middle over those at both ends
  double thin;          // thickness over that of the film
};

static void map_annulus(const void *self, double s, double t, double x[2])
{
  double r = hub_m + (frame_m - hub_m) * s, angle = 0.5 * pi * t;
  (void)self;
  x[0] = t < 1 ? r * cos(angle) : 0;
  x[1] = r * sin(angle);
}

/* Held all through the thickness at the frame. */
static int held(const void *self, const double X[3])
{
  (void)self;
  return hypot(X[0], X[1]) > frame_m * (1 - 1e-9) ? 1 | 2 | 4
                                                  : (X[0] < 1e-9 ? 1 : 0) | (X[1] < 1e-9 ? 2 : 0);
}

static bool everywhere(const void *self, int region, int ply)
{
  (void)self;
  (void)region;
  (void)ply;
  return true;
}

/* Widths that rise to the middle by the same factor from one to the next. */
static void graded_cuts(size_t count, double grade, double *cuts)
{
  double sum = 0, width[CUTS_MAX];
  for (size_t i = 0; i < count; i++) {
    double from_end = fmin((double)i, (double)(count - 1 - i));
    width[i] = pow(grade, 2 * from_end / (double)(count > 1 ? count - 1 : 1));
    sum += width[i];
  }
  cuts[0] = 0;
  for (size_t i = 0; i < count; i++) {
    cuts[i + 1] = cuts[i] + width[i] / sum;
  }
  cuts[count] = 1;
}

static struct cone cone_create(const struct mesh *mesh)
{
  static const double nowhere[6] = {0};
  double along[CUTS_MAX + 1], around[CUTS_MAX + 1], area = pre_stretch * pre_stretch;
  struct dea_part_material film = {.law = dea_law_find("yeoh"),
                                   .param = {178.4e3, -6e3, 4.2e3},
                                   .pre_stretch = {pre_stretch, pre_stretch, 1 / area},
                                   .kappa_Pa = 4e7,
                                   .permittivity_F_per_m = 2.8 * DEA_EPSILON_0,
                                   .thickness_m = mesh->thin * unstretched_m / area};
  struct cone it = {.hub = {.held = HUB_HELD}};
  graded_cuts(mesh->along, mesh->grade, along);
  graded_cuts(mesh->around, 1, around);
  const struct dea_block block = {map_annulus, NULL, along, around, mesh->along, mesh->around, 0};
  const struct dea_ply ply = {mesh->membrane ? 0 : film.thickness_m, 1, 2};
  verify_ok(ctx, dea_part_material_relax(&film));
  verify_ok(ctx, dea_grid_create(ctx, mesh->order, &block, 1, &ply, 1, NULL,
                                 mesh->membrane ? 0 : -0.5 * film.thickness_m, frame_m, &it.grid));
  size_t nodes = it.grid->node_count;
  verify_ok(ctx, dea_grid_add_nodes(ctx, it.grid, 2, nowhere, &it.hub.node));
  int *follows = dea_alloc(ctx, it.grid->node_count, sizeof *follows);
  if (follows == NULL) {
    exit(1);
  }
  for (size_t n = 0; n < nodes; n++) {
    follows[n] = hypot(it.grid->X[3 * n], it.grid->X[3 * n + 1]) < hub_m * (1 + 1e-9);
  }
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = 1,
                                            .part_materials = &film,
                                            .active = everywhere,
                                            .held = held,
                                            .body_count = 1,
                                            .bodies = &it.hub,
                                            .body_of = follows};
  verify_ok(ctx, dea_solid_create(ctx, it.grid, &options, &it.solid));
  dea_free(ctx, follows);
  return it;
}

static void cone_destroy(struct cone *it)
{
  dea_solid_destroy(ctx, it->solid);
  dea_grid_destroy(ctx, it->grid);
}

static void solve(struct cone *it, double kV)
{
  verify_ok(ctx, dea_load_steps_solve(ctx, it->solid, 1e3 * kV, &it->report));
}

/* Force that holds the hub at a place. */
static double force_at(struct cone *it, double kV, double mm)
{
  static const double none[3] = {0};
  double force[3], moment[3];
  const double shift[3] = {0, 0, 1e-3 * mm};
  verify_ok(ctx, dea_solid_body_prescribe(ctx, it->solid, 0, 4, shift, none));
  solve(it, kV);
  dea_solid_body_reaction(it->solid, 0, force, moment);
  return 4e3 * force[2];
}

static double place(const struct cone *it)
{
  double shift[3], turn[3];
  dea_solid_body_place(it->solid, 0, shift, turn);
  return 1e3 * shift[2];
}

/* Place of the hub under a dead force on the whole. */
static double place_under(struct cone *it, double kV, double mN)
{
  static const double none[3] = {0};
  const double force[3] = {0, 0, 0.25e-3 * mN};
  verify_ok(ctx, dea_solid_body_release(ctx, it->solid, 0, 4));
  dea_solid_body_push(it->solid, 0, force, none);
  solve(it, kV);
  dea_solid_body_push(it->solid, 0, none, none);
  return place(it);
}

/* ---- tables ---- */

/* Deviations from the table and, for the hung hub, from its list; prints both with `print`. Returns
 * the largest one. */
static double compare(const char *name, const struct mesh *mesh, double tolerance, bool print)
{
  struct cone it = cone_create(mesh);
  double most = 0;
  if (print) {
    puts("\n| h [mm] | 0 kV [mN] | 3 kV [mN] | 5 kV [mN] | deviations |\n|---|---|---|---|---|");
  }
  double force[VOLTAGES][PLACES];
  for (int v = 0; v < VOLTAGES; v++) {
    for (int p = 0; p < PLACES; p++) {
      char what[80];
      snprintf(what, sizeof what, "%s: force at %g kV and %g mm", name, voltage_kV[v], place_mm[p]);
      force[v][p] = force_at(&it, voltage_kV[v], place_mm[p]);
      most = fmax(most, fabs(verify_relative(what, force[v][p], force_mN[v][p], tolerance)));
    }
    force_at(&it, voltage_kV[v], 0);
  }
  for (int p = 0; p < PLACES && print; p++) {
    printf("| %g | %.3f | %.3f | %.3f | ", place_mm[p], force[0][p], force[1][p], force[2][p]);
    for (int v = 0; v < VOLTAGES; v++) {
      printf("%+.4f%s", 100 * (force[v][p] / force_mN[v][p] - 1), v < 2 ? ", " : " % |\n");
    }
  }
  if (print) {
    puts("\n| 20 g at | h [mm] | wanted [mm] | deviation |\n|---|---|---|---|");
  }
  for (int v = 0; v < HUNG; v++) {
    double mm = place_under(&it, hung_kV[v], hung_g * gravity_m_per_s2);
    double off = verify_relative("place of the hung hub", mm, hung_mm[v], tolerance);
    most = fmax(most, fabs(off));
    if (print) {
      printf("| %g kV | %.4f | %.4f | %+.4f %% |\n", hung_kV[v], mm, hung_mm[v], 100 * off);
    }
  }
  cone_destroy(&it);
  return most;
}

/* Forces at 5 kV, 0.5 and 10 mm, on one mesh after the other. */
static void converge(const struct mesh *meshes, size_t count)
{
  double before[2] = {0, 0};
  puts("\nAt 5 kV on finer and finer meshes of order 2; in brackets the relative change to the one "
       "before:\n\n| elements hub to frame | around a quarter | 0.5 mm [mN] | 10 mm [mN] |\n"
       "|---|---|---|---|");
  for (size_t i = 0; i < count; i++) {
    struct cone it = cone_create(&meshes[i]);
    const double mm[2] = {0.5, 10};
    printf("| %zu | %zu |", meshes[i].along, meshes[i].around);
    force_at(&it, 5, 0);
    for (int k = 0; k < 2; k++) {
      double force = force_at(&it, 5, mm[k]);
      printf(" %.4f", force);
      if (i > 0) {
        printf(" (%+.1e)", force / before[k] - 1);
      }
      printf(" |");
      before[k] = force;
    }
    puts("");
    cone_destroy(&it);
  }
}

/* What clamping adds to the force falls with the thickness. */
static void make_thinner(void)
{
  puts("\nWhat the clamped edges add falls with the thickness. Force at 0 kV over that of the "
       "membrane, less 1:\n\n| thickness | 0.5 mm | 10 mm |\n|---|---|---|");
  for (int i = 0; i < 3; i++) {
    const double thin = pow(0.5, i), mm[2] = {0.5, 10},
                 wanted[2] = {force_mN[0][0], force_mN[0][PLACES - 1]};
    const struct mesh mesh = {false, 2, 48, 8, 20 / thin, thin};
    struct cone it = cone_create(&mesh);
    printf("| %g of the film's |", thin);
    for (int k = 0; k < 2; k++) {
      printf(" %.3f %% |", 100 * (force_at(&it, 0, mm[k]) / (thin * wanted[k]) - 1));
    }
    puts("");
    cone_destroy(&it);
  }
}

/* ---- charge ---- */

static double charge_C(struct cone *it)
{
  double charge[2];
  verify_ok(ctx, dea_solid_flows(ctx, it->solid, NULL, charge, NULL));
  return 4 * charge[1];
}

/* dF/dV = -dQ/dh of the held hub, and dQ/dV of the hung one by the tangent. */
static void check_charge(const struct mesh *mesh, bool print)
{
  static const double kV = 3, mm = 4, by = 1e-2;
  struct cone it = cone_create(mesh);
  double force[2], held[2], hung[2], capacitance[4];
  force_at(&it, kV, mm);
  for (int side = 0; side < 2; side++) {
    double off = side == 0 ? -by : by;
    force[side] = force_at(&it, kV + off, mm);
    force_at(&it, kV, mm + off);
    held[side] = charge_C(&it);
  }
  for (int side = 0; side < 2; side++) {
    place_under(&it, kV + (side == 0 ? -by : by), hung_g * gravity_m_per_s2);
    hung[side] = charge_C(&it);
  }
  place_under(&it, kV, hung_g * gravity_m_per_s2);
  verify_ok(ctx, dea_solid_capacitances(ctx, it.solid, false, capacitance));
  double slope[2] = {1e-6 * (force[1] - force[0]) / (2 * by),
                     -1e3 * (held[1] - held[0]) / (2 * by)};
  double free_F = 1e-3 * (hung[1] - hung[0]) / (2 * by), tangent_F = 4 * capacitance[3];
  double off[2] = {verify_relative("slope of the force by the voltage", slope[0], slope[1], 1e-6),
                   verify_relative("capacitance of the hung cone", tangent_F, free_F, 1e-6)};
  if (print) {
    printf("\n| | | | difference |\n|---|---|---|---|\n| dF/dV, -dQ/dh at h = %g mm [N/V] | %.6e | "
           "%.6e | %+.1e |\n| dQ/dV with %g g, by the tangent, by differences [F] | %.6e | %.6e | "
           "%+.1e |\n",
           mm, slope[0], slope[1], off[0], hung_g, tangent_F, free_F, off[1]);
  }
  cone_destroy(&it);
}

/* ---- bistable spring ---- */

enum { SPRING_POINTS = 8 };

/* Push of the spring on the hub [mN] by the hub's place [mm]. */
static const double spring_mm[SPRING_POINTS] = {0, 0.5, 1, 2, 3, 4, 6, 8};
static const double spring_mN[SPRING_POINTS] = {100, 97, 96, 160, 330, 400, 430, 430};

static struct dea_spring *spring_create(const struct cone *it, struct dea_arena *memory)
{
  double at[SPRING_POINTS], force[SPRING_POINTS];
  struct dea_spring *spring;
  for (int i = 0; i < SPRING_POINTS; i++) {
    at[i] = 1e-3 * spring_mm[i];
    force[i] = -0.25e-3 * spring_mN[i]; // it pushes; a quarter of it
  }
  const struct dea_spring_options options = {
      .node = it->hub.node, .component = 2, .count = SPRING_POINTS, .at = at, .force = force};
  verify_ok(ctx, dea_spring_create(ctx, &options, memory, &spring));
  return spring;
}

/* Voltage at which the film pulls at a place as the spring pushes: the film's force falls with the
 * square of the voltage nearly straight. */
static double voltage_of(struct cone *film, const struct dea_spring *spring, double mm)
{
  double push = -4e3 * dea_spring_force(spring, 1e-3 * mm), square[2] = {4, 16}, off[2];
  for (int i = 0; i < 2; i++) {
    off[i] = force_at(film, sqrt(square[i]), mm) - push;
  }
  for (int i = 0; i < 12 && fabs(off[1]) > 1e-9 * push; i++) {
    double next = square[1] - off[1] * (square[1] - square[0]) / (off[1] - off[0]);
    square[0] = square[1];
    off[0] = off[1];
    square[1] = fmax(next, 0);
    off[1] = force_at(film, sqrt(square[1]), mm) - push;
  }
  return sqrt(square[1]);
}

/* An extreme of that voltage between two places; sign 1: a largest one. *mm: its place. */
static double extreme_of(struct cone *film, const struct dea_spring *spring, double low,
                         double high, double sign, double *mm)
{
  const double share = 0.5 * (sqrt(5) - 1);
  double at[2] = {high - share * (high - low), low + share * (high - low)};
  double kV[2] = {voltage_of(film, spring, at[0]), voltage_of(film, spring, at[1])};
  while (high - low > 2e-3) {
    if (sign * kV[0] > sign * kV[1]) {
      high = at[1];
      at[1] = at[0];
      kV[1] = kV[0];
      at[0] = high - share * (high - low);
      kV[0] = voltage_of(film, spring, at[0]);
    } else {
      low = at[0];
      at[0] = at[1];
      kV[0] = kV[1];
      at[1] = low + share * (high - low);
      kV[1] = voltage_of(film, spring, at[1]);
    }
  }
  *mm = 0.5 * (low + high);
  return voltage_of(film, spring, *mm);
}

/* Both limit points on the path of the voltage. */
static void follow(struct cone *it, double kV[2], double mm[2])
{
  const struct dea_continuation_options options = {0.05, 0.1, 2e-3, false};
  struct dea_solid_continuation *path;
  struct dea_continuation_point point, limit;
  int found = 0;
  verify_ok(ctx, dea_solid_continuation_create(ctx, it->solid, 5e3, &options, &path));
  for (int i = 0; i < 200 && found < 2; i++) {
    verify_ok(ctx, dea_solid_continuation_step(ctx, path, &point));
    if (point.passed == DEA_CONTINUATION_LIMIT) {
      verify_ok(ctx, dea_solid_continuation_locate(ctx, path, &limit));
      kV[found] = 1e-3 * limit.voltage_V;
      mm[found++] = place(it);
    }
  }
  verify_absolute("limit points", found, 2, 0);
  dea_solid_continuation_destroy(ctx, path);
}

/* In steps of the voltage, as a sweep goes: up and down around both voltages. */
static void sweep(struct cone *it, const double kV[2], const double limit_mm[2], bool print)
{
  const double step[4] = {0.999 * kV[0], 1.001 * kV[0], 1.001 * kV[1], 0.999 * kV[1]};
  double mm[4];
  solve(it, 0);
  for (int i = 0; i < 4; i++) {
    solve(it, step[i]);
    verify_absolute("unstable modes", it->report.unstable_modes, 0, 0);
    mm[i] = place(it);
  }
  bool jumps =
      mm[0] < limit_mm[0] && mm[1] > limit_mm[1] && mm[2] > limit_mm[1] && mm[3] < limit_mm[0];
  verify_absolute("a sweep jumps at both voltages", jumps, 1, 0);
  if (print) {
    puts("\nA sweep jumps at both.");
  }
}

static void check_bistable(const struct mesh *mesh, bool print)
{
  struct cone film = cone_create(mesh), sprung = cone_create(mesh);
  struct dea_arena memory = {.ctx = ctx};
  struct dea_spring *spring = spring_create(&sprung, &memory);
  const struct dea_solid_load load = dea_spring_load(spring);
  double wanted[2], at[2], kV[2] = {NAN, NAN}, mm[2] = {NAN, NAN};
  wanted[0] = extreme_of(&film, spring, 1, 2, 1, &at[0]);
  wanted[1] = extreme_of(&film, spring, 2.5, 4.5, -1, &at[1]);
  verify_ok(ctx, dea_solid_add_load(ctx, sprung.solid, &load));
  solve(&sprung, 0);
  follow(&sprung, kV, mm);
  if (print) {
    printf("\n| limit point | scalar path [kV] | arc-length [kV] | deviation | h [mm] | h [mm] |\n"
           "|---|---|---|---|---|---|\n");
  }
  for (int i = 0; i < 2; i++) {
    double off = verify_relative("voltage of a limit point", kV[i], wanted[i], 1e-5);
    verify_relative("place of a limit point", mm[i], at[i], 5e-3);
    if (print) {
      printf("| %s | %.5f | %.5f | %+.1e | %.3f | %.3f |\n", i == 0 ? "out" : "back", wanted[i],
             kV[i], off, at[i], mm[i]);
    }
  }
  cone_destroy(&sprung);
  sprung = cone_create(mesh);
  verify_ok(ctx, dea_solid_add_load(ctx, sprung.solid, &load));
  sweep(&sprung, wanted, at, print);
  cone_destroy(&film);
  cone_destroy(&sprung);
  dea_arena_free(&memory);
}

/* ---- the page ---- */

static void print_head(void)
{
  puts(
      "# Cone: an annular film with a rigid hub\n\n"
      "Made by `scripts/verify cone`; not to be edited. A film (Yeoh 178.4, -6.0, 4.2 kPa; 100 um "
      "without stress, eps_r 2.8),\nstretched by 1.2 in all directions, is clamped at a radius of "
      "20 mm; a rigid hub of 5 mm (radii in the stretched film)\nin its middle is pushed out by h. "
      "Electrodes cover the film. The hub is a rigid body\n(`docs/theory/bodies.md`) whose turns "
      "are held; a quarter is computed. The force is the reaction that holds the hub,\nor h is "
      "what a dead force of 20 g (9.80665 m/s2) leads to.\n\n"
      "Reference: membrane theory with rotational symmetry, in six digits, integrated apart from "
      "this library. Deviations are\nfrom it, for 0, 3 and 5 kV. Tolerance 0.1 % with the film as "
      "a membrane, 1.5 % as a solid.");
}

static void full(void)
{
  static const struct mesh membranes[] = {{true, 2, 4, 4, 1, 1},
                                          {true, 2, 8, 8, 1, 1},
                                          {true, 2, 16, 16, 1, 1},
                                          {true, 2, 32, 32, 1, 1}};
  static const struct mesh solids[] = {{false, 2, 8, 4, 20, 1},
                                       {false, 2, 16, 8, 20, 1},
                                       {false, 2, 32, 8, 20, 1},
                                       {false, 2, 64, 8, 20, 1}};
  print_head();
  puts("\n## Membrane\n\n16 x 16 elements of order 2 in the quarter.");
  compare("membrane", &membranes[2], 1e-3, true);
  converge(membranes, 4);
  puts("\nThe error of the force falls with the fourth power of the size of elements.\n\n"
       "## Solid\n\n32 x 8 hexahedra of order 2, one through the thickness, narrower by 20 at both "
       "edges than in the middle.");
  compare("solid", &solids[2], 1.5e-2, true);
  converge(solids, 4);
  make_thinner();
  puts("\n## Charge\n\nForce F and charge Q come of one energy: at 3 kV the slope of the force by "
       "the voltage is that of the charge by the place. Central\ndifferences of 10 V and 10 um, "
       "8 x 8 membranes. Tolerance 1e-6.");
  check_charge(&membranes[1], true);
  puts(
      "\n## Bistable spring\n\nA spring pushes the hub by 100, 97, 96, 160, 330, 400, 430, 430 mN "
      "at "
      "h = 0, 0.5, 1, 2, 3, 4, 6, 8 mm (monotone cubics\nbetween), 8 x 8 membranes. The scalar "
      "path: for each h the voltage at which the force that holds the hub (without\nthe spring) is "
      "that of the spring; its extremes are where a film with the spring jumps. Beside it the "
      "limit points of\nthe path of the voltage by arc-length, with the spring. Tolerance 1e-5.");
  check_bistable(&membranes[1], true);
}

int main(int argc, char **argv)
{
  static const struct mesh membrane = {true, 3, 4, 2, 1, 1}, solid = {false, 2, 10, 2, 10, 1};
  verify_ok(NULL, dea_context_create(NULL, &ctx));
  verify_ok(ctx, dea_solid_start(ctx));
  if (verify_is_small(argc, argv)) {
    compare("membrane", &membrane, 1e-3, false);
    compare("solid", &solid, 1.5e-2, false);
    check_charge(&membrane, false);
    check_bistable(&membrane, false);
  } else {
    full();
  }
  dea_solid_stop();
  dea_context_destroy(ctx);
  return verify_end();
}
