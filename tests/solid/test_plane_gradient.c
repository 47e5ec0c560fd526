/* Gradients of the models without a mesh: Taylor's remainder of each falls as the square of the
 * change over four decades, for every number of a design. */
#include "device/geometry.h"
#include "devices.h"
#include "result/columns.h"
#include "study/design_file.h"
#include "study/design_gradient.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <math.h>
#include <string.h>

static const char *const keys[] = {"centre_z_m",
                                   "fibre_tip_z_m",
                                   "electrode_edge_u_m",
                                   "electrode_stretch",
                                   "true_field_V_per_m",
                                   "breakdown_margin",
                                   "min_tension_N_per_m",
                                   "capacitance_F",
                                   "energy_J",
                                   "nominal_field_V_per_m",
                                   "voltage_V"};
static const double shares[] = {3e-2, 3e-3, 3e-4, 3e-5, 3e-6};
enum { KEYS = sizeof keys / sizeof keys[0], SHARES = sizeof shares / sizeof shares[0], FROM = 1 };

/* Of a law that does not stiffen, with which a path turns back. */
static struct dea_material soft_film(void)
{
  return test_material("neo-hookean", 60e3, 0, 0);
}

/* At a voltage, or where the path comes to a stretch of the electrode, 0: not so. */
static void solve(const struct dea_model_type *type, const struct dea_device *device,
                  double voltage_V, double stretch, struct dea_load_point *out,
                  struct dea_model **keep)
{
  struct dea_model *model;
  assert_int_equal(type->create(ctx, device, NULL, &model), DEA_OK);
  const dea_status status = stretch > 0 ? dea_model_stretch(ctx, type, model, device, stretch, out)
                                        : type->solve(ctx, model, voltage_V, out);
  assert_ok(status);
  if (keep != NULL) {
    *keep = model;
  } else {
    type->destroy(ctx, model);
  }
}

/* The device with another value of a number, built from the design where it is a key of it. */
static struct dea_device changed(const struct dea_design *design, const struct dea_device *device,
                                 const struct dea_design_number *number, double value)
{
  struct dea_device out = *device;
  const double kept = number->scale * value;
  if (number->of == DEA_NUMBER_OF_DESIGN) {
    struct dea_design other = *design;
    memcpy((char *)&other + number->offset, &kept, sizeof kept);
    dea_geometry_fill(&other, &out);
  } else {
    memcpy((char *)dea_material_at(&out, number->item) + number->offset, &kept, sizeof kept);
  }
  return out;
}

static void check_number(const struct dea_model_type *type, const struct dea_design_gradient *ask,
                         const struct dea_design_number *number, const struct dea_load_point *base,
                         const double *slope, double floor)
{
  double left[SHARES];
  struct dea_load_point moved[SHARES];
  const bool voltage = strcmp(number->key, "voltage") == 0;
  for (int n = 0; n < SHARES; n++) {
    const double value = number->value * (1 + shares[n]);
    const struct dea_device device =
        voltage ? *ask->device : changed(ask->design, ask->device, number, value);
    solve(type, &device, voltage ? value : ask->voltage_V, ask->of.stretch, &moved[n], NULL);
  }
  for (int k = 0; k < KEYS; k++) {
    const int column = dea_point_column_find(keys[k]);
    const double from = dea_point_get(base, column);
    if (isnan(from) || from == 0) { // the model has no such quantity
      continue;
    }
    for (int n = 0; n < SHARES; n++) {
      left[n] =
          (dea_point_get(&moved[n], column) - from - slope[k] * number->value * shares[n]) / from;
    }
    for (int n = 0; n < SHARES; n++) {
      const double wanted = left[FROM] * pow(shares[n] / shares[FROM], 2);
      const double part = n < FROM ? 1 : 0.2; // of a large change the third power is seen
      if (!(fabs(left[n] - wanted) <= part * fabs(wanted) + floor)) {
        fail_msg("%s: %s by %s at %.0e: %.3e, not %.3e", type->name, keys[k], number->key,
                 shares[n], left[n], wanted);
      }
    }
  }
}

/* stretch: along the path of a soft film, 0: at a voltage of the example. floor: what the solver
 * leaves of a quantity, and the model's differences of its slope. */
static void check(const char *model, double stretch, double floor)
{
  const struct dea_model_type *type = dea_model_find(model);
  struct dea_design *design;
  struct dea_device *device;
  struct dea_design_number numbers[DEA_NUMBERS_MAX];
  static double slopes[DEA_NUMBERS_MAX * KEYS];
  struct dea_load_point base;
  size_t count;
  int columns[KEYS];
  for (int k = 0; k < KEYS; k++) {
    columns[k] = dea_point_column_find(keys[k]);
  }
  const struct dea_override stretched = {"pre_stretch", "1.8"};
  assert_ok(dea_design_read(ctx, DEA_SOURCE_DIR "/examples/frdea-4.yaml", &stretched,
                            stretch > 0 ? 1 : 0, &design));
  assert_int_equal(dea_device_build(ctx, design, &device), DEA_OK);
  struct dea_design_gradient ask = {.type = type,
                                    .design = design,
                                    .device = device,
                                    .voltage_V = 3e3,
                                    .numbers = numbers,
                                    .of = {.columns = columns,
                                           .column_count = KEYS,
                                           .holds_stretch = stretch > 0,
                                           .stretch = stretch}};
  if (stretch > 0) { // more than the whole turns unstable only far beyond the limit point
    device->film = test_material("arruda-boyce", 15.36e3, 5.99, 0);
  }
  assert_int_equal(dea_design_numbers(ctx, design, device, ask.voltage_V, false, numbers, &count),
                   DEA_OK);
  assert_true(count >= 10);
  ask.number_count = count;
  solve(type, device, ask.voltage_V, stretch, &base, &ask.model);
  assert_true(stretch == 0 || base.unstable_modes == 1); // it has gone past its limit point
  assert_int_equal(dea_design_gradient_find(ctx, &ask, slopes), DEA_OK);
  type->destroy(ctx, ask.model);
  for (size_t i = stretch > 0 ? 1 : 0; i < count; i++) { // the voltage is the first
    check_number(type, &ask, &numbers[i], &base, slopes + i * KEYS, floor);
  }
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
}

TEST(test_lumped)
{
  check("lumped", 0, 2e-13);
}

TEST(test_axisymmetric)
{
  check("axisymmetric", 0, 5e-12);
}

TEST(test_along_the_path)
{
  check("lumped", 1.75, 5e-12);
  check("axisymmetric", 1.7, 5e-12);
}

// Critical voltages -------------------------------------------------------------------------------

static struct dea_critical find_critical(const struct dea_model_type *type,
                                         const struct dea_device *device, enum dea_event_kind kind)
{
  struct dea_critical out;
  const struct dea_critical_request ask = {type, device, NULL, kind, 1e3, 5e4};
  if (dea_critical_find(ctx, &ask, &out) != DEA_OK || isnan(out.voltage_V)) {
    fail_msg("%s: no %s: %s %s", type->name, dea_event_name(kind), out.why,
             dea_context_message(ctx));
  }
  return out;
}

/* Of what is left of a change of the voltage by all numbers but the voltage. */
static void check_critical_of(const struct dea_design_gradient *ask, enum dea_event_kind kind,
                              double floor)
{
  double slopes[DEA_NUMBERS_MAX], left[SHARES];
  struct dea_critical base = find_critical(ask->type, ask->device, kind);
  assert_int_equal(dea_design_gradient_critical(ctx, ask, &base, slopes), DEA_OK);
  for (size_t i = 1; i < ask->number_count; i++) {
    const struct dea_design_number *number = &ask->numbers[i];
    for (int n = 0; n < SHARES; n++) {
      const struct dea_device device =
          changed(ask->design, ask->device, number, number->value * (1 + shares[n]));
      struct dea_critical moved = find_critical(ask->type, &device, kind);
      left[n] = (moved.voltage_V - base.voltage_V - slopes[i] * number->value * shares[n]) /
                base.voltage_V;
      dea_critical_end(ctx, &moved);
    }
    for (int n = 0; n < SHARES; n++) {
      const double wanted = left[FROM] * pow(shares[n] / shares[FROM], 2);
      const double part = n < FROM ? 1 : 0.2;
      if (!(fabs(left[n] - wanted) <= part * fabs(wanted) + floor)) {
        fail_msg("%s: %s by %s at %.0e: %.3e, not %.3e", ask->type->name, dea_event_name(kind),
                 number->key, shares[n], left[n], wanted);
      }
    }
  }
  assert_string_equal(ask->numbers[0].key, "voltage");
  assert_true(isnan(slopes[0]));
  dea_critical_end(ctx, &base);
}

static void check_critical(const char *model, bool soft, const enum dea_event_kind *kinds,
                           int kind_count, double floor)
{
  struct dea_design *design;
  struct dea_device *device;
  struct dea_design_number numbers[DEA_NUMBERS_MAX];
  assert_ok(dea_design_read(ctx, DEA_SOURCE_DIR "/examples/frdea-4.yaml", NULL, 0, &design));
  assert_int_equal(dea_device_build(ctx, design, &device), DEA_OK);
  if (soft) {
    device->film = soft_film();
  }
  struct dea_design_gradient ask = {
      .type = dea_model_find(model), .design = design, .device = device, .numbers = numbers};
  assert_int_equal(dea_design_numbers(ctx, design, device, 1, false, numbers, &ask.number_count),
                   DEA_OK);
  for (int k = 0; k < kind_count; k++) {
    check_critical_of(&ask, kinds[k], floor);
  }
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
}

TEST(test_critical_voltages)
{
  static const enum dea_event_kind crossings[] = {DEA_EVENT_SLACK, DEA_EVENT_BREAKDOWN},
                                   turns[] = {DEA_EVENT_PULL_IN};
  check_critical("lumped", false, crossings, 2, 1e-10);
  check_critical("axisymmetric", false, crossings, 2, 1e-9);
  check_critical("lumped", true, turns, 1, 1e-12);
  check_critical("axisymmetric", true, turns, 1, 5e-12);
}

TESTS(context_set_up, context_tear_down)
