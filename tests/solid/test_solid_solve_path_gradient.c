/* Slopes of model 3d along a path, beyond its limit point, at a stretch of the electrode that is
 * held while the voltage follows: Taylor's remainder, and those of pull-in where it turns. */
// ctest: solid
#include "device_numbers.h"
#include "result/columns.h"
#include "study/critical.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <math.h>

static const char *const keys[] = {"voltage_V", "true_field_V_per_m", "min_tension_N_per_m",
                                   "capacitance_F", "energy_J"};
enum { KEYS = sizeof keys / sizeof keys[0], SHARES = 4, FROM = 1 };
static const double shares[SHARES] = {1e-2, 1e-3, 1e-4, 1e-5}, left_by_solver = 1e-10;

/* The point of the path with a stretch, of a device on the mesh of another one. */
static struct dea_load_point go(const struct state *at, const struct dea_model_settings *settings,
                                double stretch, struct dea_model **keep)
{
  struct dea_load_point out = {0};
  struct dea_model *model;
  assert_ok(solid->create(ctx, &at->device, settings, &model));
  assert_ok(dea_model_stretch(ctx, solid, model, &at->device, stretch, &out));
  if (keep != NULL) {
    *keep = model;
  } else {
    solid->destroy(ctx, model);
  }
  return out;
}

/* Slopes by the share of each number, out [count][KEYS]; the point. */
static struct dea_load_point find_slopes(const struct state *at,
                                         const struct dea_model_settings *settings, double stretch,
                                         const int *numbers, size_t count, double *out)
{
  struct state sides[2 * OF_DEVICE];
  struct dea_design_change changes[OF_DEVICE];
  struct dea_model *model;
  int columns[KEYS];
  for (int k = 0; k < KEYS; k++) {
    columns[k] = dea_point_column_find(keys[k]);
  }
  make_changes(at, numbers, count, sides, changes);
  const struct dea_gradient_request ask = {.changes = changes,
                                           .change_count = count,
                                           .columns = columns,
                                           .column_count = KEYS,
                                           .holds_stretch = true,
                                           .stretch = stretch};
  struct dea_load_point there = go(at, settings, stretch, &model);
  assert_ok(solid->gradient(ctx, model, &ask, out));
  solid->destroy(ctx, model);
  return there;
}

static void check_number(const struct state *at, const struct dea_model_settings *settings,
                         const struct dea_load_point *base, int number, const double *slope)
{
  struct dea_load_point moved[SHARES];
  for (int n = 0; n < SHARES; n++) {
    const struct state there = changed(at, number, shares[n]);
    moved[n] = go(&there, settings, base->electrode_stretch, NULL);
  }
  for (int k = 0; k < KEYS; k++) {
    const int column = dea_point_column_find(keys[k]);
    const double from = dea_point_get(base, column);
    double left[SHARES];
    if (isnan(from) || fabs(from) < 1e-15) { // a flat film has no height
      continue;
    }
    for (int n = 0; n < SHARES; n++) {
      left[n] = (dea_point_get(&moved[n], column) - from - slope[k] * shares[n]) / from;
    }
    for (int n = 0; n < SHARES; n++) {
      const double wanted = left[FROM] * pow(shares[n] / shares[FROM], 2);
      if (!(fabs(left[n] - wanted) <=
            0.2 * fabs(wanted) + slope_accuracy * shares[n] + left_by_solver)) {
        fail_msg("%s by %s at %.0e: %.3e, not %.3e", keys[k], names[number], shares[n], left[n],
                 wanted);
      }
    }
  }
}

static void check(const struct state *at, const struct dea_model_settings *settings, double stretch,
                  const int *numbers, size_t count)
{
  double slopes[OF_DEVICE * KEYS];
  struct dea_model_settings own = *settings;
  struct dea_load_point base = find_slopes(at, settings, stretch, numbers, count, slopes);
  struct dea_model *model;
  assert_int_equal(solid->create(ctx, &at->device, settings, &model), DEA_OK);
  own.mesh_from = model;
  assert_close(base.electrode_stretch, stretch, 1e-12, 0);
  assert_int_equal(base.unstable_modes, 1); // beyond the limit point
  for (size_t i = 0; i < count; i++) {
    check_number(at, &own, &base, numbers[i], slopes + i * KEYS);
  }
  solid->destroy(ctx, model);
}

/* Of which more than the whole turns unstable only far beyond its limit point. */
static struct state stretched_disc(void)
{
  struct state at = soft_disc();
  at.device.pre_stretch = 1.8;
  return changed(&at, VOLTAGE, 0);
}

/* A solid has pressures. With fibres it was run once (docs/theory/gradients.md). */
TEST(test_beyond_pull_in)
{
  only_nightly();
  static const int numbers[] = {FRAME, PRE_STRETCH};
  const struct state at = stretched_disc();
  check(&at, &(struct dea_model_settings){.film = DEA_FILM_MEMBRANE}, 1.62, numbers, 1);
  check(&at, &(struct dea_model_settings){.film = DEA_FILM_SOLID}, 1.56, numbers + 1, 1);
}

/* Where the path turns the voltage's slopes are those of pull-in, by the tangent's null vector,
 * whatever is held; they are those of laws beyond it too. */
TEST(test_where_it_turns)
{
  static const int numbers[] = {THICKNESS, MODULUS, PERMITTIVITY, PRE_STRETCH, ELECTRODE, FRAME};
  enum { COUNT = sizeof numbers / sizeof numbers[0], STRETCHES = 3 };
  const struct dea_model_settings film = {.film = DEA_FILM_MEMBRANE};
  const struct state at = stretched_disc();
  const struct dea_critical_request ask = {solid, &at.device, &film, DEA_EVENT_PULL_IN, 100, 2e4};
  struct dea_critical pull_in;
  struct state sides[2 * COUNT];
  struct dea_design_change changes[COUNT];
  double slopes[COUNT * KEYS], of_pull_in[COUNT];
  assert_int_equal(dea_critical_find(ctx, &ask, &pull_in), DEA_OK);
  make_changes(&at, numbers, COUNT, sides, changes);
  assert_int_equal(dea_critical_slopes(ctx, &pull_in, changes, COUNT, of_pull_in), DEA_OK);
  const double stretches[STRETCHES] = {pull_in.point.electrode_stretch, 1.2, 1.6};
  for (int n = 0; n < STRETCHES; n++) {
    const struct dea_load_point there =
        find_slopes(&at, &film, stretches[n], numbers, COUNT, slopes);
    for (size_t i = 0; i < COUNT && n == 0; i++) {
      assert_close(slopes[i * KEYS], of_pull_in[i], 0, 1e-6 * there.voltage_V);
    }
    assert_close(slopes[0], there.voltage_V, 1e-6, 0); // by the thickness
    assert_close(slopes[KEYS], 0.5 * there.voltage_V, 1e-6, 0);
    assert_close(slopes[2 * KEYS], -0.5 * there.voltage_V, 1e-6, 0);
    assert_close(slopes[4 * KEYS] + slopes[5 * KEYS], 0, 0, 1e-6 * there.voltage_V);
  }
  dea_critical_end(ctx, &pull_in);
}

TESTS(context_set_up, context_tear_down)
