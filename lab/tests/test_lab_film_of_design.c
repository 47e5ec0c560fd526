/* The simulated film of a device that is no disc: its monitor beside a sweep; and a disc with
 * fibres that moves as 3d does. */
// ctest: solid
#include "design_text.h"
#include "film/film_of_design.h"
#include "study/observe.h"
#include "study/study.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <math.h>
#include <string.h>

static const char cone[] =
    "dea: 1\n"
    "shapes:\n"
    "  - {name: film, kind: circle, radius: 20 mm}\n"
    "  - {name: hub, kind: circle, radius: 5 mm}\n"
    "  - {name: active, kind: difference, of: [film, hub]}\n"
    "plies:\n"
    "  - {name: film, shape: film, material: film, thickness: 100 um, pre_stretch: 1.2}\n"
    "electrodes:\n"
    "  - {ply: film, side: bottom, shape: active, channel: ground}\n"
    "  - {ply: film, side: top, shape: active, channel: drive}\n"
    "supports:\n"
    "  - {edge: film}\n"
    "bodies:\n"
    "  - {name: hub, shape: hub, free: [z], force_z: 100 mN}\n"
    "monitors:\n"
    "  - {name: hub, body: hub}\n"
    "  - {name: gauge, from: [8 mm, 0 mm], to: [16 mm, 0 mm], ply: film}\n" FILM_MATERIAL
    "compute:\n"
    "  models: [3d]\n"
    "  voltage: {values: [0 kV, 1.1 kV, 3.3 kV, 4 kV]}\n"
    "  reduced: {voltages: 5}\n"
    "  solid: {film: membrane, order: 1}\n";

static struct dea_bench_film *film;

static int set_up(void **state)
{
  if (context_set_up(state) != 0) {
    return -1;
  }
  return dea_film_of_design.read(ctx, "cone.yaml", cone, strlen(cone), &film) == DEA_OK ? 0 : -1;
}

static int tear_down(void **state)
{
  dea_film_of_design.destroy(ctx, film);
  return context_tear_down(state);
}

static struct dea_bench_point go(struct dea_bench_model *model, double length_s, double source_V,
                                 double *error)
{
  struct dea_bench_point at;
  assert_int_equal(dea_film_of_design.advance(ctx, model, length_s, source_V, &at, error), DEA_OK);
  dea_film_of_design.accept(model);
  return at;
}

static const char fibre_disc[] =
    "dea: 1\n"
    "film: {material: elastosil-2030, law: yeoh-178, thickness: 100 um}\n"
    "pre_stretch: 1.5\nframe: {inner_diameter: 30 mm}\n"
    "electrodes: {diameter: 5 mm unstretched}\nfibres: {count: 4, material: pet}\n"
    "compute:\n"
    "  models: [3d]\n"
    "  voltage: {values: [0 kV, 1.7 kV, 2.9 kV, 4 kV]}\n"
    "  reduced: {voltages: 5}\n"
    "  solid: {order: 1}\n";

/* By model reduced centre and tips are where the sweep of 3d has them, which lumped has 300 times
 * as far; then they creep. */
TEST(test_fibre_disc_of_3d)
{
  static const char *const sweep[] = {"sweep"}, *const load_line[] = {"load-line"};
  const struct dea_bench_circuit circuit = {0, INFINITY};
  struct dea_bench_film *disc;
  struct dea_bench_model *model;
  struct dea_bench_point rest, at;
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *result;
  double error;
  const struct dea_bench_film_type *t = &dea_film_of_design;
  assert_int_equal(read_and_build(ctx, fibre_disc, NULL, 0, &design, &device), DEA_OK);
  assert_int_equal(dea_result_create(ctx, design, device, &result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, dea_model_find("3d"), sweep, 1, result), DEA_OK);
  const struct dea_curve *curve = dea_result_find(result, "3d", "sweep");
  const struct dea_load_point *last = &curve->points[curve->count - 1];
  const double stroke = last->fibre_tip_z_m - curve->points[0].fibre_tip_z_m;
  assert_int_equal(t->read(ctx, "disc.yaml", fibre_disc, strlen(fibre_disc), &disc), DEA_OK);
  assert_int_equal(t->open(ctx, disc, "reduced", NULL, &model), DEA_OK);
  assert_int_equal(t->begin(ctx, model, &circuit, &rest), DEA_OK);
  for (size_t i = 0; i < curve->count; i++) {
    const struct dea_load_point *p = &curve->points[i];
    go(model, 0, p->voltage_V, &error);
    for (int k = 0; k < 40; k++) {
      at = go(model, 1, p->voltage_V, &error);
    }
    assert_close(at.point.fibre_tip_z_m, p->fibre_tip_z_m, 0, 0.01 * fabs(stroke));
    assert_close(at.point.centre_z_m, p->centre_z_m, 0, 0.01 * fabs(stroke));
    assert_close(at.point.capacitance_F, p->capacitance_F, 1e-4, 0);
  }
  assert_true(fabs(stroke) > 1e-6);
  /* Its load line at the highest voltage: the tips push down, the less the lower they are. */
  assert_int_equal(dea_study_run(ctx, dea_model_find("reduced"), load_line, 1, result), DEA_OK);
  const struct dea_result_table *forces =
      dea_result_find_table(result, "reduced", "load-line", "forces");
  const size_t end = forces->row_count - 1;
  double below = -1e-12;
  for (size_t i = 0; i < 200; i++) {
    const double F = dea_result_table_number(forces, end - i, "force_N", 0);
    assert_true(i == 0 ? fabs(F) < 1e-9 : F < below);
    below = F;
  }
  assert_close(dea_result_table_number(forces, end, "height_m", 0), last->fibre_tip_z_m, 0,
               0.01 * fabs(stroke));
  t->close(ctx, model);
  t->destroy(ctx, disc);
  dea_result_destroy(ctx, result);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
}

/* Without a resistance the hub is where a sweep has it, also between the voltages of model reduced,
 * and whatever the sign. */
TEST(test_hub_of_a_sweep)
{
  static const char *const sweep[] = {"sweep"};
  const struct dea_bench_circuit circuit = {0, INFINITY};
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *result;
  struct dea_bench_model *model;
  struct dea_bench_point at;
  double error;
  assert_int_equal(read_and_build(ctx, cone, NULL, 0, &design, &device), DEA_OK);
  assert_int_equal(dea_result_create(ctx, design, device, &result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, dea_model_find("3d"), sweep, 1, result), DEA_OK);
  const struct dea_curve *curve = dea_result_find(result, "3d", "sweep");
  const int column = dea_column_find(ctx, "hub_z");
  const double rest = dea_point_get(&curve->points[0], column);
  assert_int_equal(dea_film_of_design.open(ctx, film, "reduced", "hub_z", &model), DEA_OK);
  assert_int_equal(dea_film_of_design.begin(ctx, model, &circuit, &at), DEA_OK);
  for (size_t i = 0; i < curve->count; i++) {
    const struct dea_load_point *p = &curve->points[i];
    const double z = dea_point_get(p, column) - rest;
    at = go(model, 0, -p->voltage_V, &error);
    assert_close(at.point.centre_z_m - rest, z, 2e-3, 1e-12 + 1e-7 * fabs(rest));
    assert_close(at.point.capacitance_F, p->capacitance_F, 1e-4, 0);
  }
  dea_film_of_design.close(ctx, model);
  dea_result_destroy(ctx, result);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
}

TEST(test_no_such_monitor)
{
  struct dea_bench_model *model;
  assert_int_equal(dea_film_of_design.open(ctx, film, "reduced", "hub_zm", &model), DEA_E_DESIGN);
  assert_non_null(strstr(dea_context_message(ctx), "did you mean 'hub_z_m'?"));
  assert_int_equal(dea_film_of_design.open(ctx, film, "reduced", "gauge_stretch", &model),
                   DEA_E_DESIGN);
  assert_int_equal(dea_film_of_design.open(ctx, film, "lumped", "hub_z", &model),
                   DEA_E_UNSUPPORTED);
  assert_non_null(strstr(dea_context_message(ctx), "write 'sim: {model: reduced}'"));
  dea_context_clear(ctx);
}

/* What the checks ask: the field that is allowed, and that the film has an equilibrium. */
TEST(test_checks)
{
  struct dea_bench_model *model;
  struct dea_bench_point at;
  double pull_in_V;
  assert_int_equal(dea_film_of_design.open(ctx, film, NULL, NULL, &model), DEA_OK);
  assert_int_equal(dea_film_of_design.pull_in(ctx, model, &pull_in_V), DEA_OK);
  assert_true(isnan(pull_in_V));
  assert_int_equal(dea_film_of_design.solve(ctx, model, 3e3, &at), DEA_OK);
  /* 80 V/um times the stretch to the power 1.5; the film is stretched by 1.2 and some more */
  assert_true(at.breakdown_V_per_m > 80e6 * pow(1.2, 1.5) &&
              at.breakdown_V_per_m < 80e6 * pow(1.25, 1.5));
  assert_close(at.point.true_field_V_per_m / at.breakdown_V_per_m, 1 - at.point.breakdown_margin,
               1e-12, 0);
  assert_int_equal(dea_film_of_design.solve(ctx, model, 20e3, &at), DEA_E_NO_EQUILIBRIUM);
  dea_context_clear(ctx);
  dea_film_of_design.close(ctx, model);
}

TESTS(set_up, tear_down)
