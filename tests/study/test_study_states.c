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
static double b = 0.05, membrane_ends_V = INFINITY;
static bool without_centre;  // as a device of the general form
static bool refined_at_tips; // of the last model

struct dea_model {
  double voltage_V, x, kept[2];
  double shift_V; // a finer mesh is as the coarsest one at that much less
  bool membrane;  // its centre moves by a third of the root
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
    x -= 1e-3 * (x * x * x - a_of(m->voltage_V - m->shift_V) * x - b);
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
  if (*out != NULL) {
    double finest = fmax(settings->refinement, settings->tip_refinement);
    (*out)->shift_V = finest > 1 ? 500 * (finest - 1) : 0;
    refined_at_tips = settings->tip_refinement > settings->refinement;
    (*out)->membrane = settings->film == DEA_FILM_MEMBRANE;
  }
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
  out->energy_J = energy_of(m->voltage_V - m->shift_V, m->x);
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
  if (m->membrane && voltage_V > membrane_ends_V) {
    return dea_fail(context, DEA_E_DOMAIN, "it thins without limit");
  }
  m->x = descend(m, m->x);
  report(m, out);
  out->centre_z_m *= m->membrane ? 1.0 / 3 : 1;
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

static dea_status transfer(struct dea_context *context, struct dea_model *m,
                           const struct dea_model *from, struct dea_load_point *out, bool *found)
{
  m->voltage_V = from->voltage_V;
  m->x = descend(m, from->x);
  report(m, out);
  *found = true;
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
                                            .transfer = transfer,
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

static const char *text(const struct dea_result_table *table, size_t row, const char *key)
{
  for (size_t i = 0; i < table->type.column_count; i++) {
    if (strcmp(table->type.columns[i].key, key) == 0) {
      return dea_result_table_cell(table, row, i)->text;
    }
  }
  fail();
  return NULL;
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
    assert_string_equal(text(r.found, i, "state"), wanted[i].state);
    assert_string_equal(text(r.found, i, "leads_up"), wanted[i].up);
    assert_string_equal(text(r.found, i, "leads_down"), wanted[i].down);
    if (wanted[i].root >= 0) {
      assert_close(x, root(wanted[i].voltage_V, wanted[i].root), 0, 1e-9);
    }
    assert_close(number(r.found, i, "energy_J"), energy_of(wanted[i].voltage_V, x), 0, 1e-20);
  }
  double deep = energy_of(3000, root(3000, 0)), high = energy_of(3000, root(3000, 2));
  assert_close(number(r.found, 4, "above_J"), high - deep, 0, 1e-18);
  assert_string_equal(text(r.found, 2, "reached"), "mode 1- 300 um");
  assert_string_equal(text(r.found, 4, "reached"), "mode 1- 300 um");
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
  assert_string_equal(text(r.bands, 1, "lowest"), "A");
  assert_string_equal(text(r.bands, 1, "up"), "A");
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

/* On finer meshes states follow the roots of those meshes, until there the upper one is lost to the
 * other. */
TEST(test_finer_meshes)
{
  struct ran r = run("{voltage: [3 kV], perturbation: [300 um], refinement: [2, 3, 4.9]}");
  const struct dea_result_table *t = dea_result_find_table(r.result, "wells", "states", "meshes");
  assert_non_null(t);
  assert_int_equal(t->row_count, 8);
  for (size_t i = 0; i < 8; i++) {
    double at_V = 3000 - 500 * (number(t, i, "refinement") - 1);
    bool upper = i >= 4, lost = i == 7;
    double x = number(t, i, "centre_z_m") / length_m;
    assert_string_equal(text(t, i, "state"), upper ? "B" : "A");
    assert_string_equal(text(t, i, "is"), upper && !lost ? "B" : "A");
    if (i % 4 < 3) {
      assert_close(x, root(at_V, upper ? 2 : 0), 0, 1e-9);
    }
    assert_close(number(t, i, "energy_J"), energy_of(at_V, x), 0, 1e-18);
  }
  assert_close(number(t, 7, "above_J"), 0, 0, 1e-20);
  assert_close(number(t, 6, "above_J"),
               energy_of(2000, root(2000, 2)) - energy_of(2000, root(2000, 0)), 0, 1e-18);
  end(&r);
}

/* Finer at the fibre tips only: the same meshes by another number, which the design may begin with.
 */
TEST(test_finer_tips)
{
  struct ran r = run("{voltage: [3 kV], perturbation: [300 um], refinement: [2], refined: tips}");
  const struct dea_result_table *t = dea_result_find_table(r.result, "wells", "states", "meshes");
  assert_int_equal(t->row_count, 4);
  assert_true(refined_at_tips);
  for (size_t i = 1; i < 4; i += 2) {
    assert_close(number(t, i, "refinement"), 2, 0, 0);
    assert_close(number(t, i, "centre_z_m") / length_m, root(2500, i == 1 ? 0 : 2), 0, 1e-9);
  }
  end(&r);
  const struct dea_override sets[] = {{"compute.solid.tip_refinement", "2.5"},
                                      {"compute.states", "{refinement: [2.5], refined: tips}"}};
  struct dea_design *design;
  struct dea_device *device;
  size_t count;
  assert_int_equal(read_and_build(ctx, GOOD_DESIGN, sets, 2, &design, &device), DEA_E_DESIGN);
  const struct dea_finding *found = dea_finding_get(ctx, &count);
  assert_true(count > 0);
  assert_non_null(strstr(found[count - 1].text, "2.5 after 2.5, but each mesh"));
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
}

/* The film as a membrane at the voltages of the search, on each mesh as far as it goes; it is no
 * state. Not where the design does not want it. */
TEST(test_relaxed)
{
  struct ran r = run("{voltage: [2 kV, 3 kV], perturbation: [300 um], refinement: [2]}");
  const struct dea_result_table *t = dea_result_find_table(r.result, "wells", "states", "relaxed");
  assert_non_null(t);
  assert_int_equal(t->row_count, 4);
  for (size_t i = 0; i < 4; i++) {
    double V = i % 2 == 0 ? 2000 : 3000;
    assert_close(number(t, i, "voltage_V"), V, 0, 0);
    assert_close(number(t, i, "refinement"), i < 2 ? 1 : 2, 0, 0);
    assert_close(number(t, i, "centre_z_m"), length_m / 3 * root(V - (i < 2 ? 0 : 500), 0), 0,
                 1e-12);
  }
  assert_close(number(r.bands, 0, "states"), 2, 0, 0);
  end(&r);
  membrane_ends_V = 2500;
  r = run("{voltage: [2 kV, 3 kV], modes: 0}");
  membrane_ends_V = INFINITY;
  t = dea_result_find_table(r.result, "wells", "states", "relaxed");
  assert_int_equal(t->row_count, 1);
  assert_int_equal(r.found->row_count, 2);
  size_t count;
  const struct dea_finding *said = dea_finding_get(ctx, &count);
  assert_true(count > 0 && strstr(said[count - 1].text, "it thins without limit") != NULL);
  end(&r);
  r = run("{voltage: [2 kV, 3 kV], modes: 0, relaxed: no}");
  assert_null(dea_result_find_table(r.result, "wells", "states", "relaxed"));
  end(&r);
}

/* A device without a centre is drawn by its farthest place. */
TEST(test_figure_without_centre)
{
  without_centre = true;
  struct ran r = run("{voltage: [3 kV], push: [300 um], modes: 1, relaxed: no}");
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

/* Without the ability the states of the design's mesh are all; meshes have to rise. */
TEST(test_no_finer_meshes)
{
  const struct dea_override set = {"compute.states", "{refinement: [1, 3, 2]}"};
  struct dea_design *design;
  struct dea_device *device;
  size_t count;
  dea_finding_clear(ctx);
  assert_int_equal(read_and_build(ctx, GOOD_DESIGN, &set, 1, &design, &device), DEA_E_DESIGN);
  const struct dea_finding *found = dea_finding_get(ctx, &count);
  assert_int_equal(count, 2);
  assert_non_null(strstr(found[0].text, "1 after 1, but each mesh"));
  assert_non_null(strstr(found[1].text, "2 after 3, but each mesh"));
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
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
    assert_string_equal(text(r.found, i, "state"), name);
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
