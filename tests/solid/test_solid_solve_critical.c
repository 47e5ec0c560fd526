/* Critical voltages of model 3d and their slopes: Taylor's remainder, laws, and the exact disc. */
// ctest: solid
#include "device_numbers.h"
#include "model/solid/assembly/solid.h"
#include "result/columns.h"
#include "study/critical.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <math.h>

/* That of a device on the mesh of another one. */
static struct dea_critical find_critical(const struct state *at,
                                         const struct dea_model_settings *settings,
                                         enum dea_event_kind kind)
{
  struct dea_critical out;
  const struct dea_critical_request ask = {solid, &at->device, settings, kind, at->voltage_V, 2e4};
  if (dea_critical_find(ctx, &ask, &out) != DEA_OK || isnan(out.voltage_V)) {
    fail_msg("%s", dea_context_message(ctx));
  }
  return out;
}

/* Slopes of its logarithm by those of all numbers but the voltage, out [OF_DEVICE]. */
static double find_critical_slopes(const struct state *at,
                                   const struct dea_model_settings *settings,
                                   enum dea_event_kind kind, double *out)
{
  struct state sides[2 * OF_DEVICE];
  struct dea_design_change changes[OF_DEVICE];
  struct dea_critical critical = find_critical(at, settings, kind);
  make_changes(at, NULL, OF_DEVICE, sides, changes);
  assert_ok(dea_critical_slopes(ctx, &critical, changes, OF_DEVICE, out));
  dea_critical_end(ctx, &critical);
  for (int i = 0; i < OF_DEVICE; i++) {
    out[i] /= critical.voltage_V;
  }
  return critical.voltage_V;
}

/* What the solver leaves of a voltage: of that where the tension is 0 more, it has the pressures.
 */
static double voltage_floor(enum dea_event_kind kind)
{
  return kind == DEA_EVENT_PULL_IN ? 1e-11 : 1e-8;
}

/* The remainder falls as the square of the change of these numbers [count]. */
static void check_critical(const struct state *at, const struct dea_model_settings *settings,
                           enum dea_event_kind kind, const int *numbers, int count)
{
  enum { SHARES = 2 };
  static const double shares[SHARES] = {1e-2, 1e-6};
  double slopes[OF_DEVICE], left[SHARES];
  struct dea_model_settings own = *settings;
  const double base_V = find_critical_slopes(at, settings, kind, slopes);
  struct dea_model *model;
  assert_int_equal(solid->create(ctx, &at->device, settings, &model), DEA_OK);
  own.mesh_from = model;
  for (int i = 0; i < count; i++) {
    for (size_t n = 0; n < SHARES; n++) {
      struct state there = changed(at, numbers[i], shares[n]);
      there.voltage_V = 0.95 * base_V;
      struct dea_critical moved = find_critical(&there, &own, kind);
      left[n] = moved.voltage_V / base_V - 1 - slopes[numbers[i]] * shares[n];
      dea_critical_end(ctx, &moved);
    }
    for (size_t n = 0; n < SHARES; n++) {
      const double wanted = left[0] * pow(shares[n] / shares[0], 2);
      if (!(fabs(left[n] - wanted) <=
            0.2 * fabs(wanted) + slope_accuracy * shares[n] + voltage_floor(kind))) {
        fail_msg("%s by %s at %.0e: %.3e, not %.3e", dea_event_name(kind), names[numbers[i]],
                 shares[n], left[n], wanted);
      }
    }
  }
  solid->destroy(ctx, model);
}

/* Of a membrane, which has a kink where it loses its tension, and of a solid film, by every number
 * one of the two, over four decades. */
TEST(test_critical_voltages)
{
  only_nightly();
  static const int slack[] = {THICKNESS, STIFFENING,      PRE_STRETCH, FRAME,
                              WIDTH,     FIBRE_THICKNESS, GLUE},
                   breakdown[] = {MODULUS,   PERMITTIVITY,  ELECTRODE,   TIP,
                                  TIP_WIDTH, FIBRE_MODULUS, GLUE_MODULUS};
  static const struct dea_model_settings membrane = {.film = DEA_FILM_MEMBRANE},
                                         film = {.order = 1, .order_z = 1};
  struct state at = star();
  check_critical(&at, &membrane, DEA_EVENT_SLACK, (const int[]){PRE_STRETCH}, 1);
  check_critical(&at, &membrane, DEA_EVENT_BREAKDOWN, (const int[]){TIP}, 1);
  check_critical(&at, &film, DEA_EVENT_SLACK, slack, 7);
  check_critical(&at, &film, DEA_EVENT_BREAKDOWN, breakdown, 7);
}

/* Laws: with all lengths s times as large so is a critical voltage; with all moduli and the
 * permittivity s times as large it stays; and as the voltage comes in by eps V^2 only, that of the
 * loss of tension goes with 1 / sqrt(eps). */
TEST(test_laws_of_critical_voltages)
{
  static const int lengths[] = {THICKNESS, ELECTRODE, FRAME,           TIP,
                                WIDTH,     TIP_WIDTH, FIBRE_THICKNESS, GLUE};
  static const struct {
    enum dea_event_kind kind;
    struct dea_model_settings settings;
  } cases[] = {
      {DEA_EVENT_SLACK, {.film = DEA_FILM_SOLID}},
      {DEA_EVENT_BREAKDOWN, {.film = DEA_FILM_MEMBRANE}},
      {DEA_EVENT_SLACK, {.field = DEA_FIELD_COUPLED, .order = 1, .order_z = 1}},
  };
  struct state at = star();
  at.device.film.param[1] = 0; // of the law's moduli those that are numbers here are all
  for (size_t n = 0; n < sizeof cases / sizeof cases[0]; n++) {
    double slopes[OF_DEVICE], sum = 0;
    find_critical_slopes(&at, &cases[n].settings, cases[n].kind, slopes);
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
      sum += slopes[lengths[i]];
    }
    assert_close(sum, 1, 2e-5, 0);
    assert_close(slopes[MODULUS] + slopes[STIFFENING] + slopes[FIBRE_MODULUS] +
                     slopes[GLUE_MODULUS] + slopes[PERMITTIVITY],
                 0, 0, 2e-5);
    if (cases[n].kind == DEA_EVENT_SLACK) {
      assert_close(slopes[PERMITTIVITY], -0.5, 1e-5, 0);
    }
  }
}

/* Slopes of pull-in of the exact disc, by its logarithm, over that of a number. */
static double exact_slope(const struct state *at, int number)
{
  static const double share = 1e-4;
  double at_V[2];
  for (int k = 0; k < 2; k++) {
    struct state there = changed(at, number, k == 0 ? -share : share);
    const struct dea_critical_request ask = {
        dea_model_find("axisymmetric"), &there.device, NULL, DEA_EVENT_PULL_IN, 100, 2e4};
    struct dea_critical disc;
    assert_int_equal(dea_critical_find(ctx, &ask, &disc), DEA_OK);
    at_V[k] = disc.voltage_V;
    dea_critical_end(ctx, &disc);
  }
  return (at_V[1] - at_V[0]) / (at_V[0] + at_V[1]) / share;
}

static void check_laws_of_pull_in(const double *slopes)
{
  assert_close(slopes[MODULUS], 0.5, 1e-6, 0);
  assert_close(slopes[PERMITTIVITY], -0.5, 1e-6, 0);
  assert_close(slopes[THICKNESS] + slopes[ELECTRODE] + slopes[FRAME], 1, 1e-5, 0);
}

/* Slopes of pull-in by the null vector of the tangent: the laws of above, and those of the exact
 * disc by differences, to what the mesh leaves: of a solid where the film's thickness changes at
 * the electrode's edge, of a membrane, which is in plane stress as the exact disc is, little. */
TEST(test_pull_in)
{
  static const int compared[] = {THICKNESS, MODULUS, PRE_STRETCH, ELECTRODE, FRAME};
  static const double of_solid[] = {1e-4, 1e-6, 3e-3, 3e-3, 3e-3},
                      of_membrane[] = {1e-8, 1e-7, 5e-6, 5e-4, 5e-4};
  static const enum dea_solid_film films[] = {DEA_FILM_SOLID, DEA_FILM_MEMBRANE};
  static const struct dea_model_settings coupled = {
      .field = DEA_FIELD_COUPLED, .order = 1, .order_z = 1};
  struct state at = soft_disc();
  double slopes[OF_DEVICE];
  at.voltage_V = 300;
  find_critical_slopes(&at, &coupled, DEA_EVENT_PULL_IN, slopes);
  check_laws_of_pull_in(slopes);
  for (int f = 0; f < 2; f++) {
    const struct dea_model_settings settings = {.film = films[f]};
    find_critical_slopes(&at, &settings, DEA_EVENT_PULL_IN, slopes);
    check_laws_of_pull_in(slopes);
    for (size_t i = 0; i < sizeof compared / sizeof compared[0]; i++) {
      assert_close(slopes[compared[i]], exact_slope(&at, compared[i]),
                   f == 0 ? of_solid[i] : of_membrane[i], 0);
    }
  }
}

/* A limit point is that of the device, whichever way it is come to: on the way from 320 V attempts
 * fail that leave large forces, which no later residual must be taken relative to. And Taylor's
 * remainder, over four decades. */
TEST(test_pull_in_exactly)
{
  static const double from_V[] = {250, 320};
  static const struct dea_model_settings film = {0}, membrane = {.film = DEA_FILM_MEMBRANE},
                                         coupled = {
                                             .field = DEA_FIELD_COUPLED, .order = 1, .order_z = 1};
  struct state at = soft_disc();
  double found_V[2];
  for (int k = 0; k < 2; k++) {
    at.voltage_V = from_V[k];
    struct dea_critical there = find_critical(&at, &membrane, DEA_EVENT_PULL_IN);
    found_V[k] = there.voltage_V;
    dea_critical_end(ctx, &there);
  }
  assert_close(found_V[1], found_V[0], 1e-10, 0);
  check_critical(&at, &membrane, DEA_EVENT_PULL_IN, (const int[]){PRE_STRETCH, FRAME}, 2);
  check_critical(&at, &film, DEA_EVENT_PULL_IN, (const int[]){PRE_STRETCH}, 1);
  check_critical(&at, &coupled, DEA_EVENT_PULL_IN, (const int[]){PRE_STRETCH, ELECTRODE}, 2);
}

TESTS(context_set_up, context_tear_down)
