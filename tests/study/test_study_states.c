/* Study "states" with a model of two wells, whose states are roots of a cubic. */
#include "design_text.h"
#include "figures/run_figures.h"
#include "result/result.h"
#include "study/study.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <math.h>
#include <string.h>

/* One place with energy E0 (x^4/4 - a x^2/2 - b x), a = V/kV - 1, and x its displacement over a
 * length: one state below V = 1.5 kV, two from there on, with a third, unstable one between. */
static const double length_m = 1e-4, energy_J = 1e-6;
static double b = 0.05;
static bool without_centre; // as a device of the general form

struct dea_model {
  double voltage_V, x, kept[2];
};

static double a_of(double voltage_V)
{
  return 1e-3 * voltage_V - 1;
}

static double energy_of(double voltage_V, double x)
{
  return energy_J * (pow(x, 4) / 4 - a_of(voltage_V) * x * x / 2 - b * x);
}

/* Down from x in small steps. */
static double descend(const struct dea_model *m, double x)
{
  for (int i = 0; i < 200000; i++) {
    x -= 1e-3 * (x * x * x - a_of(m->voltage_V) * x - b);
  }
  return x;
}

/* The root of the cubic by its closed form, from the largest (0) to the smallest (2). */
static double root(double voltage_V, int which)
{
  const double pi = 3.14159265358979323846;
  double a = a_of(voltage_V), angle = acos(1.5 * b / a * sqrt(3 / a)) / 3;
  return 2 * sqrt(a / 3) * cos(angle - 2 * pi * (which) / 3);
}

static dea_status create(struct dea_context *context, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  *out = dea_alloc(context, 1, sizeof **out);
  return *out != NULL ? DEA_OK : DEA_E_MEMORY;
}

static void destroy(struct dea_context *context, struct dea_model *m)
{
  dea_free(context, m);
}

static void report(const struct dea_model *m, struct dea_load_point *out)
{
  *out = dea_load_point_empty();
  out->voltage_V = m->voltage_V;
  out->centre_z_m = out->highest_z_m = out->lowest_z_m = length_m * m->x;
  out->energy_J = energy_of(m->voltage_V, m->x);
  if (without_centre) {
    out->centre_z_m = NAN;
    out->highest_z_m = fmax(0, out->highest_z_m);
    out->lowest_z_m = fmin(0, out->lowest_z_m);
  }
}

static dea_status solve(struct dea_context *context, struct dea_model *m, double voltage_V,
                        struct dea_load_point *out)
{
  m->voltage_V = voltage_V;
  m->x = descend(m, m->x);
  report(m, out);
  return DEA_OK;
}

static dea_status soften(struct dea_context *context, struct dea_model *m, size_t count,
                         double *stiffness_N_per_m4)
{
  for (size_t i = 0; i < count; i++) {
    stiffness_N_per_m4[i] = 3 * m->x * m->x - a_of(m->voltage_V) + (double)i;
  }
  return DEA_OK;
}

static dea_status push(struct dea_context *context, struct dea_model *m, const struct dea_push *way,
                       struct dea_load_point *out, bool *found)
{
  *found = way->kind == DEA_PUSH_MODE && way->mode == 0;
  if (*found) {
    m->x = descend(m, m->x + way->side * way->amplitude_m / length_m);
    report(m, out);
  }
  return DEA_OK;
}

static dea_status fields(struct dea_context *context, struct dea_model *m,
                         enum dea_fields_part part, struct dea_field_mesh **out)
{
  const struct dea_mesh_field field = {.name = "displacement_m", .unit = "m", .components = 3};
  double *values = NULL;
  assert_int_equal(part, DEA_FIELDS_SURFACE);
  DEA_TRY(context, dea_field_mesh_create(context, 1, out));
  dea_status status = dea_field_mesh_add(context, *out, &field, &values);
  if (status == DEA_OK) {
    values[2] = length_m * m->x;
  }
  return dea_field_mesh_finish(context, status, out);
}

static dea_status save(struct dea_context *context, struct dea_model *m, struct dea_state *out)
{
  m->kept[0] = m->x;
  m->kept[1] = m->voltage_V;
  return dea_state_add(context, out, "x", m->kept, 2);
}

static dea_status load(struct dea_context *context, struct dea_model *m,
                       const struct dea_state *state)
{
  const double *kept = dea_state_find(state, "x", 2);
  m->x = kept[0];
  m->voltage_V = kept[1];
  return DEA_OK;
}

static const struct dea_model_type wells = {.name = "wells",
                                            .long_name = "two wells",
                                            .create = create,
                                            .destroy = destroy,
                                            .solve = solve,
                                            .soften = soften,
                                            .push = push,
                                            .fields = fields,
                                            .save = save,
                                            .load = load};

struct ran {
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *result;
  const struct dea_result_table *found, *bands;
};

static struct ran run(const char *states)
{
  static const char *const names[] = {"states"};
  const struct dea_override set = {"compute.states", states};
  struct ran r;
  assert_int_equal(read_and_build(ctx, GOOD_DESIGN, &set, 1, &r.design, &r.device), DEA_OK);
  assert_int_equal(dea_result_create(ctx, r.design, r.device, &r.result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, &wells, names, 1, r.result), DEA_OK);
  r.found = dea_result_find_table(r.result, "wells", "states", "found");
  r.bands = dea_result_find_table(r.result, "wells", "states", "bands");
  assert_non_null(r.found);
  assert_non_null(r.bands);
  return r;
}

static void end(struct ran *r)
{
  dea_result_destroy(ctx, r->result);
  dea_device_destroy(ctx, r->device);
  dea_design_destroy(ctx, r->design);
}

static double number(const struct dea_result_table *table, size_t row, const char *key)
{
  return dea_result_table_number(table, row, key, 0);
}

/* Each voltage has its stable roots, the lower one in energy first, in two branches: one that comes
 * from 0 V, one that a push finds and that ends on the way down. */
TEST(test_two_wells)
{
  struct ran r = run("{voltage: [3 kV, 0.5 kV, 2 kV], push: [10 um, 300 um], modes: 2}");
  static const struct {
    double voltage_V;
    int root;
    const char *state, *up, *down;
  } wanted[] = {{500, -1, "A", "A", ""},
                {2000, 0, "A", "A", "A"},
                {2000, 2, "B", "B", "A"},
                {3000, 0, "A", "", "A"},
                {3000, 2, "B", "", "B"}};
  assert_int_equal(r.found->row_count, 5);
  for (size_t i = 0; i < 5; i++) {
    double x = number(r.found, i, "centre_z_m") / length_m;
    assert_close(number(r.found, i, "voltage_V"), wanted[i].voltage_V, 0, 0);
    assert_string_equal(dea_result_table_text(r.found, i, "state"), wanted[i].state);
    assert_string_equal(dea_result_table_text(r.found, i, "leads_up"), wanted[i].up);
    assert_string_equal(dea_result_table_text(r.found, i, "leads_down"), wanted[i].down);
    if (wanted[i].root >= 0) {
      assert_close(x, root(wanted[i].voltage_V, wanted[i].root), 0, 1e-9);
    }
    assert_close(number(r.found, i, "energy_J"), energy_of(wanted[i].voltage_V, x), 0, 1e-20);
  }
  double deep = energy_of(3000, root(3000, 0)), high = energy_of(3000, root(3000, 2));
  assert_close(number(r.found, 4, "above_J"), high - deep, 0, 1e-18);
  assert_string_equal(dea_result_table_text(r.found, 2, "reached"), "mode 1- 300 um");
  assert_string_equal(dea_result_table_text(r.found, 4, "reached"), "mode 1- 300 um");
  end(&r);
}

/* What a sensor reads over the states, and their points with the flag that there are several. */
TEST(test_bands)
{
  struct ran r = run("{voltage: [0.5 kV, 2 kV], push: [300 um]}");
  assert_int_equal(r.bands->row_count, 2);
  assert_close(number(r.bands, 0, "states"), 1, 0, 0);
  assert_close(number(r.bands, 1, "states"), 2, 0, 0);
  assert_close(number(r.bands, 1, "centre_z_min_m"), length_m * root(2000, 2), 0, 1e-12);
  assert_close(number(r.bands, 1, "centre_z_max_m"), length_m * root(2000, 0), 0, 1e-12);
  assert_string_equal(dea_result_table_text(r.bands, 1, "lowest"), "A");
  assert_string_equal(dea_result_table_text(r.bands, 1, "up"), "A");
  assert_int_equal(r.result->variant_count, 2);
  const struct dea_curve *first = &r.result->variants[0].curve;
  const struct dea_curve *other = &r.result->variants[1].curve;
  assert_int_equal(first->count, 2);
  assert_int_equal(other->count, 1);
  assert_int_equal(first->points[0].own_flags, 0);
  assert_int_equal(first->points[1].own_flags, 1u << DEA_FLAG_STATES);
  assert_int_equal(other->points[0].own_flags, 1u << DEA_FLAG_STATES);
  end(&r);
}

/* Pushes that are too small come back; without any only the sweep's states are there. */
TEST(test_nothing_found)
{
  struct ran r = run("{voltage: [2 kV, 3 kV], push: [10 um]}");
  assert_int_equal(r.found->row_count, 2);
  end(&r);
  r = run("{voltage: [2 kV, 3 kV], push: [300 um], modes: 0}");
  assert_int_equal(r.found->row_count, 2);
  assert_close(number(r.bands, 1, "searched"), 0, 0, 0);
  end(&r);
}

/* A device without a centre is drawn by its farthest place. */
TEST(test_figure_without_centre)
{
  without_centre = true;
  struct ran r = run("{voltage: [3 kV], push: [300 um], modes: 1}");
  without_centre = false;
  struct dea_plot *plot;
  assert_int_equal(dea_plot_create(ctx, "states", "", &plot), DEA_OK);
  const struct dea_figure *figure;
  size_t at = 0;
  while ((figure = dea_figure_get(at)) != NULL && strcmp(figure->name, "states") != 0) {
    at++;
  }
  assert_non_null(figure);
  assert_int_equal(figure->build(ctx, r.result, plot), DEA_OK);
  const struct dea_panel *panel = &plot->panels[0];
  assert_int_equal(panel->series_count, 2);
  for (int i = 0; i < 2; i++) { // x, y of the one point
    assert_close(panel->series[i].values[1], 1e6 * length_m * root(3000, 2 * i), 0, 1e-6);
  }
  assert_non_null(strstr(panel->y_label, "Farthest place"));
  dea_plot_destroy(ctx, plot);
  end(&r);
}

/* Wells that mirror each other, of one energy to the bit, beside the unstable state between them.
 */
TEST(test_mirrored)
{
  static const double x[] = {1, -1, 0};
  b = 0;
  struct ran r = run("{voltage: [2 kV], push: [300 um], modes: 1}");
  b = 0.05;
  assert_int_equal(r.found->row_count, 3);
  assert_close(number(r.bands, 0, "states"), 3, 0, 0);
  for (size_t i = 0; i < 3; i++) {
    const char name[] = {(char)('A' + (int)i), '\0'};
    assert_string_equal(dea_result_table_text(r.found, i, "state"), name);
    assert_close(number(r.found, i, "centre_z_m"), x[i] * length_m, 0, 1e-12);
  }
  end(&r);
}

/* A model that knows one state says so. */
TEST(test_not_able)
{
  static const char *const names[] = {"states"};
  struct ran r;
  assert_int_equal(read_and_build(ctx, GOOD_DESIGN, NULL, 0, &r.design, &r.device), DEA_OK);
  assert_int_equal(dea_result_create(ctx, r.design, r.device, &r.result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, dea_model_find("lumped"), names, 1, r.result), DEA_OK);
  assert_int_equal(r.result->variant_count, 0);
  assert_int_equal(r.result->table_count, 0);
  end(&r);
}

TESTS(context_set_up, context_tear_down)
