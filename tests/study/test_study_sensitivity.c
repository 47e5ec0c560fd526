/* Slopes of answers by the numbers of a design: what must hold of them whatever the device. */
#include "design_text.h"
#include "result/columns.h"
#include "study/design_gradient.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <math.h>

enum { STRAIN, FIELD, TENSION, CAPACITANCE, ENERGY, COLUMNS };
static int columns[COLUMNS];

static void find_columns(void)
{
  static const char *const keys[COLUMNS] = {"electrode_edge_u_m", "true_field_V_per_m",
                                            "min_tension_N_per_m", "capacitance_F", "energy_J"};
  for (int i = 0; i < COLUMNS; i++) {
    columns[i] = dea_point_column_find(keys[i]);
  }
}

/* Values and slopes of a model of the good design, perhaps with an override, at 3 kV. */
static dea_status ask(const char *model, const struct dea_override *override,
                      const char *const *names, size_t count, const int *of, size_t of_count,
                      double *values, double *slopes)
{
  const struct dea_model_type *type = dea_model_find(model);
  struct dea_design *design;
  struct dea_device *device;
  struct dea_design_number all[DEA_NUMBERS_MAX], chosen[DEA_NUMBERS_MAX];
  struct dea_load_point point;
  size_t all_count;
  dea_status status =
      read_and_build(ctx, GOOD_DESIGN, override, override != NULL ? 1 : 0, &design, &device);
  assert_int_equal(status, DEA_OK);
  struct dea_design_gradient gradient = {.type = type,
                                         .design = design,
                                         .device = device,
                                         .voltage_V = 3e3,
                                         .numbers = chosen,
                                         .number_count = count,
                                         .columns = of,
                                         .column_count = of_count};
  assert_int_equal(dea_design_numbers(ctx, design, device, 3e3, false, all, &all_count), DEA_OK);
  for (size_t k = 0; k < count; k++) {
    for (size_t i = 0; i < all_count; i++) {
      chosen[k] = strcmp(all[i].key, names[k]) == 0 ? all[i] : chosen[k];
    }
  }
  assert_int_equal(dea_model_create(ctx, type, design, device, &gradient.model), DEA_OK);
  assert_int_equal(type->solve(ctx, gradient.model, 3e3, &point), DEA_OK);
  for (size_t i = 0; i < of_count; i++) {
    values[i] = dea_point_get(&point, of[i]);
  }
  status = dea_design_gradient_find(ctx, &gradient, slopes);
  type->destroy(ctx, gradient.model);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  return status;
}

enum { VOLTAGE, C1, C2, C3, PERMITTIVITY, THICKNESS, FRAME, ELECTRODE, KEYS };
static const char *const keys[KEYS] = {"voltage",
                                       "film.law.c1",
                                       "film.law.c2",
                                       "film.law.c3",
                                       "film.permittivity.at_rest",
                                       "film.thickness",
                                       "frame.inner_diameter",
                                       "electrodes.diameter"};
static const double numbers[KEYS] = {3e3, 178.4e3, -6e3, 4.2e3, 2.8, 100e-6, 30e-3, 5e-3};

static const char *const models[] = {"lumped", "axisymmetric"};

/* d ln(quantity) / d ln(number), out [KEYS][COLUMNS]. */
static void find(const char *model, double (*out)[COLUMNS])
{
  double values[COLUMNS];
  find_columns();
  if (ask(model, NULL, keys, KEYS, columns, COLUMNS, values, out[0]) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  for (int i = 0; i < KEYS; i++) {
    for (int k = 0; k < COLUMNS; k++) {
      out[i][k] *= numbers[i] / values[k];
    }
  }
}

/* Units. With s times all moduli and the permittivity nothing moves, and tension and energy are s
 * times as large; with s times all lengths and the voltage the device is the same, larger. */
TEST(test_units)
{
  for (int m = 0; m < 2; m++) {
    double e[KEYS][COLUMNS];
    find(models[m], e);
    const double stiff[COLUMNS] = {0, 0, 1, 1, 1}, large[COLUMNS] = {1, 0, 1, 1, 3};
    for (int k = 0; k < COLUMNS; k++) {
      assert_close(e[C1][k] + e[C2][k] + e[C3][k] + e[PERMITTIVITY][k], stiff[k], 0, 1e-6);
      assert_close(e[VOLTAGE][k] + e[THICKNESS][k] + e[FRAME][k] + e[ELECTRODE][k], large[k], 0,
                   1e-6);
    }
  }
}

/* The voltage comes in by eps V^2 only; by that the energy's slope is minus half of C V^2. */
TEST(test_voltage)
{
  for (int m = 0; m < 2; m++) {
    double slopes[1][COLUMNS], values[COLUMNS], e[KEYS][COLUMNS];
    find(models[m], e);
    assert_close(e[VOLTAGE][STRAIN], 2 * e[PERMITTIVITY][STRAIN], 1e-6, 0);
    assert_close(e[VOLTAGE][FIELD], 1 + 2 * e[PERMITTIVITY][FIELD], 1e-6, 0);
    assert_int_equal(ask(models[m], NULL, keys, 1, columns, COLUMNS, values, slopes[0]), DEA_OK);
    assert_close(slopes[0][ENERGY], -values[CAPACITANCE] * 3e3, 1e-7, 0);
  }
}

/* Taylor's remainder of an answer by a number that the design file has in its own unit. */
TEST(test_taylor)
{
  for (int m = 0; m < 2; m++) {
    double slope, base, left[4];
    const char *const key = "pre_stretch";
    find_columns();
    assert_int_equal(ask(models[m], NULL, &key, 1, &columns[STRAIN], 1, &base, &slope), DEA_OK);
    for (int n = 0; n < 4; n++) {
      double step = 0.02 * pow(10, -n), value, none;
      char number[40];
      snprintf(number, sizeof number, "%.17g", 1.5 + step);
      const struct dea_override override = {key, number};
      assert_int_equal(ask(models[m], &override, &key, 1, &columns[STRAIN], 1, &value, &none),
                       DEA_OK);
      left[n] = (value - base - slope * step) / base;
      if (n > 1) {
        assert_close(left[n], 1e-2 * left[n - 1], 0.02, 1e-10);
      }
    }
  }
}

TESTS(context_set_up, context_tear_down)
