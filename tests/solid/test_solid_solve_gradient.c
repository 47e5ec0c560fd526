/* Gradients of model 3d: Taylor's remainder of each by the changed device, solved by itself. */
// ctest: solid
#include "device_numbers.h"
#include "model/solid/assembly/solid.h"
#include "result/columns.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above
#include "lowest_frequency.h"

#include <math.h>
#include <string.h>

enum { SHARES_MAX = 2, ROUNDS = 1 };

/* ---- quantities ---- */

static const char *const keys[] = {"centre_z_m",         "fibre_tip_z_m",    "electrode_edge_u_m",
                                   "true_field_V_per_m", "breakdown_margin", "min_tension_N_per_m",
                                   "capacitance_F",      "energy_J"};
enum {
  COMMON = sizeof keys / sizeof keys[0],
  FREQUENCY = COMMON,
  FORCE = COMMON,
  KEYS,
  KEYS_MAX, // of a device that has both
};

static bool is_pressed(const struct state *at)
{
  return at->pressed.tip.radius_m > 0;
}

/* A device has a frequency where its densities are known. */
static bool vibrates(const struct state *at)
{
  return at->device.film.density_kg_per_m3 > 0;
}

static int key_count(const struct state *at)
{
  return COMMON + is_pressed(at) + vibrates(at);
}

static const char *key_of(const struct state *at, int k)
{
  return k < COMMON ? keys[k] : k == FORCE && is_pressed(at) ? "force_N" : "frequency_Hz";
}

static int number_count(const struct state *at)
{
  return is_pressed(at) ? NUMBERS : OF_DEVICE;
}

/* To where the solves of changed devices begin, which then need no steps from rest on: away by a
 * share of the voltage, so that none begins within the solver's tolerance. */
static void step_aside(const struct state *at, struct dea_model *model)
{
  struct dea_load_point point;
  assert_ok(solid->solve(ctx, model, 0.98 * at->voltage_V, &point));
}

/* The state of a model into that of a changed device on the same mesh. Not where there is a weight:
 * a state has its loads with it. */
static void begin_at(const struct state *at, struct dea_model *model, struct dea_model *near)
{
  struct dea_state *there = dea_alloc(ctx, 1, sizeof *there);
  struct dea_load_point point;
  assert_non_null(there);
  if ((is_pressed(at) && solid->indent(ctx, model, &at->pressed.tip,
                                       -1e-3 * at->pressed.tip.radius_m, &point) != DEA_OK) ||
      solid->save(ctx, near, there) != DEA_OK || solid->load(ctx, model, there) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  dea_free(ctx, there);
}

/* near: whose mesh and state it begins with; NULL: none. */
static struct dea_load_point solve(const struct state *at,
                                   const struct dea_model_settings *settings,
                                   struct dea_model *near, struct dea_model **keep)
{
  struct dea_model_settings own = *settings;
  struct dea_model *model = NULL;
  struct dea_load_point point = dea_load_point_empty();
  own.mesh_from = near;
  assert_ok(solid->create(ctx, &at->device, &own, &model));
  if (near != NULL && at->device.gravity == DEA_GRAVITY_OFF) {
    begin_at(at, model, near);
  }
  if ((is_pressed(at) &&
       solid->indent(ctx, model, &at->pressed.tip, at->pressed.depth_m, &point) != DEA_OK) ||
      solid->solve(ctx, model, at->voltage_V, &point) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  const bool exact = settings->field == DEA_FIELD_COUPLED || settings->order == 1;
  const int rounds = is_pressed(at) ? 1 : exact ? ROUNDS : 0;
  for (int i = 0; i < rounds; i++) { // beyond what the tolerances of contact and solver ask
    assert_ok((is_pressed(at)
                   ? solid->indent(ctx, model, &at->pressed.tip, at->pressed.depth_m, &point)
                   : solid->solve(ctx, model, at->voltage_V, &point)));
  }
  if (vibrates(at)) {
    point.frequency_Hz = frequency_of(solid, model, &point);
  }
  if (keep != NULL) {
    *keep = model;
  } else {
    solid->destroy(ctx, model);
  }
  return point;
}

/* Slopes by the logarithms of numbers [count], out [count][key_count], and where they are of. */
static struct dea_load_point find_slopes(const struct state *at,
                                         const struct dea_model_settings *settings,
                                         const int *numbers, int count, double *out,
                                         struct dea_model **keep)
{
  const double share = 1e-5;
  struct dea_model *model = NULL;
  struct state sides[2 * NUMBERS];
  struct dea_design_change changes[NUMBERS];
  int columns[KEYS_MAX];
  struct dea_load_point base = solve(at, settings, NULL, &model);
  for (int k = 0; k < key_count(at); k++) {
    columns[k] = dea_point_column_find(key_of(at, k));
  }
  for (int i = 0; i < count; i++) {
    for (int k = 0; k < 2; k++) {
      sides[2 * i + k] = changed(at, numbers[i], k == 0 ? -share : share);
      changes[i].device[k] = &sides[2 * i + k].device;
      changes[i].voltage_V[k] = sides[2 * i + k].voltage_V;
      changes[i].pressed[k] = is_pressed(at) ? &sides[2 * i + k].pressed : NULL;
    }
    changes[i].width = 2 * share;
  }
  const struct dea_gradient_request ask = {.changes = changes,
                                           .change_count = (size_t)count,
                                           .columns = columns,
                                           .column_count = (size_t)key_count(at)};
  assert_ok(solid->gradient(ctx, model, &ask, out));
  if (keep != NULL) {
    *keep = model;
  } else {
    solid->destroy(ctx, model);
  }
  return base;
}

/* What is left of the change of a quantity after its slope, over the quantity. */
static double remainder_of(const struct dea_load_point *base, const struct dea_load_point *moved,
                           const char *key, double slope, double share)
{
  int column = dea_point_column_find(key);
  double from = dea_point_get(base, column);
  return (dea_point_get(moved, column) - from - slope * share) / from;
}

/* What the solver leaves of a quantity: of the tension more, it has the pressures. */
static double floor_of(int k)
{
  return k < COMMON && strcmp(keys[k], "min_tension_N_per_m") == 0 ? 1e-8 : 2e-10;
}

/* All numbers that a device has, and a tip. */
static const int all[NUMBERS] = {
    VOLTAGE,       THICKNESS, MODULUS,      STIFFENING, PERMITTIVITY, PRE_STRETCH,
    ELECTRODE,     FRAME,     TIP,          WIDTH,      TIP_WIDTH,    FIBRE_THICKNESS,
    FIBRE_MODULUS, GLUE,      GLUE_MODULUS, DEPTH,      TIP_SIZE};

/* The remainder falls as the square of the change of these numbers [number_count]: shares [count]
 * from the largest on, each compared with what the one at `from` leads to expect. */
static void check_some(const struct state *at, const struct dea_model_settings *settings,
                       const int *numbers, int number_count, const double *shares, size_t count,
                       size_t from)
{
  double slopes[NUMBERS * KEYS_MAX], left[SHARES_MAX];
  const int width = key_count(at);
  struct dea_model *model;
  struct dea_load_point base = find_slopes(at, settings, numbers, number_count, slopes, &model);
  struct dea_load_point moved[SHARES_MAX];
  step_aside(at, model);
  if (is_pressed(at)) { // by the way of the others, for what the contact leaves
    base = solve(at, settings, model, NULL);
  }
  for (int a = 0; a < number_count; a++) {
    const int i = numbers[a];
    for (size_t n = 0; n < count; n++) {
      struct state there = changed(at, i, shares[n]);
      moved[n] = solve(&there, settings, model, NULL);
    }
    for (int k = 0; k < width; k++) {
      const char *key = key_of(at, k);
      for (size_t n = 0; n < count; n++) {
        left[n] = remainder_of(&base, &moved[n], key, slopes[a * width + k], shares[n]);
      }
      for (size_t n = 0; n < count; n++) {
        const double wanted = left[from] * pow(shares[n] / shares[from], 2);
        const double part = n < from ? 1 : 0.2; // of a large change the third power is seen
        if (!(fabs(left[n] - wanted) <=
              part * fabs(wanted) + slope_accuracy * shares[n] + floor_of(k))) {
          fail_msg("%s by %s at %.0e: %.3e, not %.3e", key, names[i], shares[n], left[n], wanted);
        }
      }
    }
  }
  solid->destroy(ctx, model);
}

static void check(const struct state *at, const struct dea_model_settings *settings,
                  const double *shares, size_t count, size_t from)
{
  check_some(at, settings, all, number_count(at), shares, count, from);
}

/* Elements of a film that take little time. */
static const struct dea_model_settings linear = {.order = 1, .order_z = 1},
                                       linear_membrane = {.film = DEA_FILM_MEMBRANE, .order = 1};

/* It has a mass. */
static struct state heavy_star(void)
{
  struct state at = star();
  at.device.film.density_kg_per_m3 = 1080;
  at.device.fibre.density_kg_per_m3 = 1390;
  return at;
}

/* Three decades of the change, six of the remainder: of linear elements by all numbers, of those
 * that are usual by some; of the membrane that of the lowest frequency too. */
TEST(test_three_decades)
{
  static const double shares[] = {1e-2, 1e-5};
  static const int numbers[] = {VOLTAGE, THICKNESS, ELECTRODE};
  static const struct dea_model_settings usual = {0};
  struct state at = star();
  check(&at, &linear, shares, 2, 0);
  check_some(&at, &usual, numbers, 3, shares, 2, 0);
}

TEST(test_three_decades_of_a_membrane)
{
  only_nightly();
  static const double shares[] = {1e-2, 1e-5};
  static const int numbers[] = {VOLTAGE, THICKNESS, ELECTRODE};
  static const struct dea_model_settings usual = {.film = DEA_FILM_MEMBRANE};
  const struct state at = heavy_star();
  check(&at, &linear_membrane, shares, 2, 0);
  check_some(&at, &usual, numbers, 3, shares, 2, 0);
}

/* Electrodes of a thickness, whose tension counts with the film's. */
TEST(test_electrodes_of_a_thickness)
{
  static const double shares[] = {1e-2, 1e-5};
  static const int numbers[] = {VOLTAGE, THICKNESS, PRE_STRETCH};
  struct state at = star();
  at.device.electrode = test_material("neo-hookean", 400e3, 0, 0);
  at.device.electrode_thickness_m = 3e-6;
  check_some(&at, &linear_membrane, numbers, 3, shares, 2, 0);
  check_some(&at, &linear, numbers, 3, shares, 2, 0);
}

/* What a device may have beside: a permittivity that goes with the stretch, fibres that end before
 * the frame, electrodes of a thickness; and what vibrates. */
TEST(test_more_numbers)
{
  only_nightly();
  static const double shares[] = {1e-2, 1e-5};
  static const int numbers[] = {PERMITTIVITY_SLOPE,  POISSON_RATIO,     OUTER_GAP,
                                ELECTRODE_THICKNESS, ELECTRODE_MODULUS, FILM_DENSITY,
                                FIBRE_DENSITY};
  struct state at = heavy_star();
  at.device.film.permittivity.slope = -0.2;
  at.device.outer_end = DEA_END_FREE;
  at.device.fibre_outer_gap_m = 2e-3;
  at.device.electrode = test_material("neo-hookean", 400e3, 0, 0);
  at.device.electrode_thickness_m = 3e-6;
  check_some(&at, &linear, numbers, 7, shares, 2, 0);
  check_some(&at, &linear_membrane, numbers, 7, shares, 2, 0);
}

/* Its weight is a dead load that changes with the device, and so does its lowest frequency. */
TEST(test_membrane_with_weight)
{
  static const double shares[] = {1e-2, 1e-5};
  static const int numbers[] = {THICKNESS, PRE_STRETCH, FRAME, TIP, FIBRE_THICKNESS};
  struct state at = heavy_star();
  at.device.gravity = DEA_GRAVITY_FIBRES_UP;
  check_some(&at, &linear_membrane, numbers, 5, shares, 2, 0);
}

enum { MODES = 3 };

/* Frequencies of the lowest modes of a membrane, by itself or on the mesh of another one. */
static void find_frequencies(const struct state *at, struct dea_model *near,
                             struct dea_model **keep, double out[MODES])
{
  struct dea_load_point modes[MODES];
  struct dea_field_mesh *shapes;
  struct dea_model *model;
  const struct dea_load_point point = solve(at, &linear_membrane, near, &model);
  assert_int_equal(solid->modes(ctx, model, &point, MODES, modes, &shapes), DEA_OK);
  dea_field_mesh_destroy(ctx, shapes);
  for (int i = 0; i < MODES; i++) {
    out[i] = modes[i].frequency_Hz;
  }
  if (keep != NULL) {
    *keep = model;
  } else {
    solid->destroy(ctx, model);
  }
}

/* Higher modes, the second beside the third and the lowest in one question. */
TEST(test_higher_modes)
{
  enum { COUNT = 3 };
  static const double shares[] = {1e-2, 1e-5};
  static const int numbers[COUNT] = {VOLTAGE, THICKNESS, FIBRE_DENSITY};
  static const size_t modes[MODES] = {1, 2, 0};
  const int column = dea_point_column_find("frequency_Hz");
  const int columns[MODES] = {column, column, column};
  const struct state at = heavy_star();
  struct state sides[2 * COUNT];
  struct dea_design_change changes[COUNT];
  struct dea_model *model;
  double base[MODES], moved[2][MODES], slopes[COUNT * MODES], left[2];
  make_changes(&at, numbers, COUNT, sides, changes);
  for (int i = 0; i < 2 * COUNT; i++) {
    changes[i / 2].voltage_V[i % 2] = sides[i].voltage_V;
  }
  find_frequencies(&at, NULL, &model, base);
  const struct dea_gradient_request ask = {.changes = changes,
                                           .change_count = COUNT,
                                           .columns = columns,
                                           .modes = modes,
                                           .column_count = MODES};
  assert_int_equal(solid->gradient(ctx, model, &ask, slopes), DEA_OK);
  step_aside(&at, model);
  for (int a = 0; a < COUNT; a++) {
    for (int n = 0; n < 2; n++) {
      const struct state there = changed(&at, numbers[a], shares[n]);
      find_frequencies(&there, model, NULL, moved[n]);
    }
    for (int k = 0; k < MODES; k++) {
      const double from = base[modes[k]];
      for (int n = 0; n < 2; n++) {
        left[n] = (moved[n][modes[k]] - from - slopes[a * MODES + k] * shares[n]) / from;
        const double wanted = left[0] * pow(shares[n] / shares[0], 2);
        if (!(fabs(left[n] - wanted) <= 0.2 * fabs(wanted) + slope_accuracy * shares[n] + 2e-10)) {
          fail_msg("mode %zu by %s at %.0e: %.3e, not %.3e", modes[k] + 1, names[numbers[a]],
                   shares[n], left[n], wanted);
        }
      }
    }
  }
  solid->destroy(ctx, model);
}

/* Two modes of the whole disc have the same frequency, by its symmetry: no slope of these. */
TEST(test_pair_of_modes)
{
  static const int number = THICKNESS;
  static const size_t modes[2] = {0, 1};
  static const struct dea_model_settings whole = {
      .film = DEA_FILM_MEMBRANE, .order = 1, .domain = DEA_DOMAIN_DISC};
  const int column = dea_point_column_find("frequency_Hz"), columns[2] = {column, column};
  const struct state at = heavy_star();
  struct state sides[2];
  struct dea_design_change change;
  struct dea_model *model;
  double slopes[2];
  make_changes(&at, &number, 1, sides, &change);
  change.voltage_V[0] = change.voltage_V[1] = at.voltage_V;
  solve(&at, &whole, NULL, &model);
  const struct dea_gradient_request ask = {
      .changes = &change, .change_count = 1, .columns = columns, .modes = modes, .column_count = 2};
  assert_int_equal(solid->gradient(ctx, model, &ask, slopes), DEA_OK);
  assert_true(!isnan(slopes[0]) && isnan(slopes[1]));
  solid->destroy(ctx, model);
}

// A coupled field ---------------------------------------------------------------------------------

static const struct dea_model_settings coupled[] = { // one element through the film, and two
    {.field = DEA_FIELD_COUPLED, .order = 1, .order_z = 1},
    {.field = DEA_FIELD_COUPLED, .order = 1, .order_z = 1, .elements_z = 2}};

TEST(test_coupled_field)
{
  only_nightly();
  static const double shares[] = {1e-2, 1e-5};
  const struct state at = heavy_star();
  check(&at, &coupled[0], shares, 2, 0);
}

/* Sum of the slopes of a quantity by some numbers, over the quantity. */
static double sum_of(const double *slopes, const int *numbers, size_t count, int quantity,
                     double value)
{
  double sum = 0;
  for (size_t i = 0; i < count; i++) {
    sum += slopes[numbers[i] * KEYS + quantity] / value;
  }
  return sum;
}

/* Laws of all numbers: with all lengths and the voltage s times as large the device is the same,
 * larger, and vibrates at 1/s of its frequency; with all moduli and the permittivity s times as
 * large nothing moves; the voltage comes in by eps V^2 only, and the energy's slope by it is minus
 * the charge. */
TEST(test_laws_of_a_coupled_field)
{
  enum { FIELD = 3, MARGIN, TENSION, CAPACITANCE, ENERGY };
  static const int lengths[] = {VOLTAGE, THICKNESS, ELECTRODE,       FRAME, TIP,
                                WIDTH,   TIP_WIDTH, FIBRE_THICKNESS, GLUE},
                   moduli[] = {MODULUS, STIFFENING, FIBRE_MODULUS, GLUE_MODULUS, PERMITTIVITY};
  static const double larger[KEYS] = {1, 1, 1, 0, 0, 1, 1, 3, -1},
                      stiffer[KEYS] = {0, 0, 0, 0, 0, 1, 1, 1, 0.5};
  struct state at = heavy_star();
  double slopes[NUMBERS * KEYS];
  at.device.film.param[1] = 0; // of the law's moduli those that are numbers here are all
  const struct dea_load_point base = find_slopes(&at, &coupled[1], all, OF_DEVICE, slopes, NULL);
  for (int k = 0; k < KEYS; k++) {
    const double value = dea_point_get(&base, dea_point_column_find(key_of(&at, k)));
    const double by_permittivity = slopes[PERMITTIVITY * KEYS + k] / value;
    assert_close(sum_of(slopes, lengths, 9, k, value), larger[k], 0, 1e-5);
    assert_close(sum_of(slopes, moduli, 5, k, value), stiffer[k], 0, 1e-5);
    if (k != FIELD && k != MARGIN) { // which have V itself in them
      assert_close(slopes[VOLTAGE * KEYS + k] / value, 2 * (by_permittivity - (k == CAPACITANCE)),
                   0, 1e-5);
    }
  }
  assert_close(slopes[VOLTAGE * KEYS + ENERGY], -base.capacitance_F * at.voltage_V * at.voltage_V,
               1e-7, 0);
}

/* ---- a tip ---- */

/* Its middle stands where the tip holds it. The points in touch are the same at all changes. */
static struct state pressed_star(enum dea_probe_shape shape)
{
  struct state at = star();
  at.voltage_V = 2.5e3; // the model goes there in as many steps for all changes
  at.pressed = (struct dea_pressed){{shape, 1.5e-3, 0.2e-3, true}, 0.5e-3};
  return at;
}

/* Numbers of every kind, two decades of the change. */
TEST(test_force_of_a_tip)
{
  static const double shares[] = {1e-3, 1e-5};
  static const int numbers[] = {VOLTAGE, THICKNESS, PRE_STRETCH, FIBRE_THICKNESS, DEPTH};
  const struct state at = pressed_star(DEA_PROBE_SPHERE);
  check_some(&at, &linear_membrane, numbers, sizeof numbers / sizeof numbers[0], shares, 2, 0);
}

/* All numbers; the size of the tip and the place of the fibre tips over changes that leave the
 * points in touch the same. */
TEST(test_force_of_a_flat_tip)
{
  only_nightly();
  static const double shares[] = {1e-2, 1e-5}, smaller[] = {1e-3, 1e-6};
  static const int numbers[] = {VOLTAGE,         THICKNESS,     MODULUS, STIFFENING,   PERMITTIVITY,
                                PRE_STRETCH,     ELECTRODE,     FRAME,   WIDTH,        TIP_WIDTH,
                                FIBRE_THICKNESS, FIBRE_MODULUS, GLUE,    GLUE_MODULUS, DEPTH},
                   of_touch[] = {TIP, TIP_SIZE};
  struct state at = pressed_star(DEA_PROBE_FLAT);
  at.pressed.depth_m = 0.2e-3;
  check_some(&at, &linear_membrane, numbers, sizeof numbers / sizeof numbers[0], shares, 2, 0);
  check_some(&at, &linear_membrane, of_touch, 2, smaller, 2, 0);
}

/* The frequency of what vibrates on the tip, which it stays on. */
TEST(test_frequency_on_a_tip)
{
  only_nightly();
  static const double shares[] = {1e-2, 1e-5};
  static const int numbers[] = {DEPTH, TIP_SIZE, VOLTAGE, THICKNESS};
  struct state at = heavy_star();
  at.voltage_V = 2.5e3;
  at.pressed = (struct dea_pressed){{DEA_PROBE_SPHERE, 1.5e-3, 0.2e-3, true}, 0.5e-3};
  check_some(&at, &linear_membrane, numbers, 4, shares, 2, 0);
  check_some(&at, &linear, numbers, 2, shares, 2, 0);
}

/* Of a solid film, laws that slopes obey: with all lengths and the voltage s times as large the
 * force is s^2 times as large; the energy at a voltage rises with the depth by the force; and, the
 * charge being the energy's slope by the voltage, the force falls with the voltage as the charge
 * rises with the depth. */
static void check_laws_of_the_force(const struct state *at,
                                    const struct dea_model_settings *settings)
{
  enum { CAPACITANCE = 6, ENERGY = 7 };
  static const int lengths[] = {VOLTAGE,   THICKNESS, ELECTRODE,       FRAME, TIP,     WIDTH,
                                TIP_WIDTH, GLUE,      FIBRE_THICKNESS, DEPTH, TIP_SIZE};
  double slopes[NUMBERS * KEYS];
  const struct dea_load_point base = find_slopes(at, settings, all, NUMBERS, slopes, NULL);
  assert_close(sum_of(slopes, lengths, 11, FORCE, base.force_N), 2, 1e-5, 0);
  assert_close(slopes[DEPTH * KEYS + ENERGY], base.force_N * at->pressed.depth_m, 1e-5, 0);
  assert_close(slopes[VOLTAGE * KEYS + FORCE] * at->pressed.depth_m,
               -slopes[DEPTH * KEYS + CAPACITANCE] * at->voltage_V * at->voltage_V, 1e-4, 0);
}

TEST(test_laws_of_the_force)
{
  only_nightly();
  static const double shares[] = {1e-2, 1e-5};
  static const int numbers[] = {ELECTRODE, DEPTH, TIP_SIZE};
  const struct state at = pressed_star(DEA_PROBE_SPHERE);
  const struct dea_model_settings settings = {0};
  check_laws_of_the_force(&at, &settings);
  check_laws_of_the_force(&at, &coupled[0]);
  check_some(&at, &linear, numbers, 3, shares, 2, 0);
}

TESTS(context_set_up, context_tear_down)
