/* Studies of a device made of plies by its monitors: against the same computed by hand. */
// ctest: solid
#include "cone_design.h"
#include "design_text.h"
#include "result/richardson.h"
#include "study/observe.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above
#include "study_run.h"

#include <math.h>
#include <string.h>

static const char cone[] =
    CONE_DESIGN("film", ", force_z: 100 mN") "monitors:\n"
                                             "  - {name: hub, body: hub}\n"
                                             "  - {name: gauge, from: [8 mm, 0 mm], to: [16 mm, 0 "
                                             "mm], ply: film}\n" FILM_MATERIAL "compute:\n"
                                             "  models: [3d]\n"
                                             "  voltage: {values: [1 kV, 3 kV]}\n"
                                             "  solid: {film: membrane, order: 1}\n";

/* A run of studies of the cone, with keys of other values. */
static struct run run_studies(const struct dea_override *overrides, size_t count,
                              const char *const names[], size_t name_count)
{
  struct run run = run_begin(cone, overrides, count);
  const struct dea_study_services services = {.run = dea_study_run};
  assert_int_equal(
      dea_study_run_with(ctx, dea_model_find("3d"), names, name_count, &services, run.result),
      DEA_OK);
  return run;
}

static double get(const struct dea_load_point *point, const char *key)
{
  const int column = dea_column_find(ctx, key);
  assert_true(column >= 0);
  return dea_point_get(point, column);
}

/* A number of the last point of a sweep of its own. */
static double by_hand(const struct dea_override *overrides, size_t count, const char *key)
{
  static const char *const sweep[] = {"sweep"};
  struct run run = run_studies(overrides, count, sweep, 1);
  const struct dea_curve *curve = dea_result_find(run.result, "3d", "sweep");
  const double value = get(&curve->points[curve->count - 1], key);
  run_end(&run);
  return value;
}

/* Points of a tip have what monitors show. */
TEST(test_force)
{
  static const char *const names[] = {"force"};
  const struct dea_override of[] = {{"compute.force", "{depth: [0.2 mm], radius: 1.5 mm}"},
                                    {"compute.voltage", "{from: 0 kV, to: 2 kV, step: 1 kV}"}};
  struct run run = run_studies(of, 2, names, 1);
  const struct dea_curve *curve = dea_result_find(run.result, "3d", "force");
  assert_int_equal(curve->count, 3);
  assert_true(get(&curve->points[2], "drive_charge_C") - get(&curve->points[0], "drive_charge_C") >
              1e-9);
  run_end(&run);
}

/* Every mesh is that of a sweep with its refinement, and meshes are judged by monitors. */
TEST(test_convergence)
{
  static const char *const names[] = {"convergence"};
  const struct dea_override of[] = {{"compute.convergence.refinement", "[1, 1.5, 2]"},
                                    {"compute.convergence.voltage", "[1 kV, 3 kV]"}};
  struct run run = run_studies(of, 2, names, 1);
  struct dea_convergence *c;
  bool hub = false, gauge = false;
  assert_int_equal(dea_convergence_create(ctx, run.result, "3d", &c), DEA_OK);
  assert_int_equal(c->mesh_count, 3);
  for (size_t i = 0; i < c->row_count; i++) {
    const struct dea_convergence_row *row = &c->rows[i];
    const bool last = row->voltage_V == 3e3;
    assert_true(strcmp(row->shown->key, "hub_x_m") != 0); // by symmetry there is none
    if (last && strcmp(row->shown->key, "hub_z_m") == 0) {
      hub = row->judged;
      assert_close(row->values[0], by_hand(NULL, 0, "hub_z_m"), 1e-9, 0);
      const struct dea_override fine = {"compute.solid.refinement", "2"};
      assert_close(row->values[2], by_hand(&fine, 1, "hub_z_m"), 1e-9, 0);
    }
    if (last && strcmp(row->shown->key, "gauge_stretch") == 0) {
      gauge = row->judged; // errors are over the strain
      assert_close(row->errors[2],
                   fabs(row->values[2] - row->extrapolated) / (row->extrapolated - 1), 1e-9, 1e-12);
    }
  }
  assert_true(hub && gauge);
  dea_convergence_destroy(ctx, c);
  run_end(&run);
}

/* A variant is the sweep of that design. */
TEST(test_compare_design)
{
  static const char *const names[] = {"sweep", "compare-design"};
  const struct dea_override of = {"compute.compare",
                                  "[{name: thin, set: {plies.film.thickness: 80 um}}]"};
  const struct dea_override thin = {"plies.film.thickness", "80 um"};
  struct run run = run_studies(&of, 1, names, 2);
  assert_int_equal(run.result->variant_count, 2);
  const struct dea_curve *own = &run.result->variants[0].curve;
  const struct dea_curve *other = &run.result->variants[1].curve;
  assert_int_equal(other->count, 2);
  assert_close(get(&own->points[1], "hub_z_m"), by_hand(NULL, 0, "hub_z_m"), 1e-12, 0);
  assert_close(get(&other->points[1], "hub_z_m"), by_hand(&thin, 1, "hub_z_m"), 1e-12, 0);
  const struct dea_result_table *table =
      dea_result_find_table(run.result, "3d", "compare-design", "monitors");
  assert_non_null(table);
  assert_int_equal(table->row_count, 4);
  assert_string_equal(dea_result_table_quantity(table, 2)->key, "hub_z_m");
  assert_close(dea_result_table_number(table, 2, "value", 0), get(&other->points[1], "hub_z_m"), 0,
               0);
  run_end(&run);
}

/* Uncertainties of the law of two plies of one material: they deviate alike. */
TEST(test_uncertain_laws)
{
  static const char *const names[] = {"sweep", "uncertainty"};
  char text[6000];
  const char *at = strstr(cone, "stretch_range"), *plies = strstr(cone, "electrodes:");
  assert_true(at != NULL && plies != NULL && plies < at);
  snprintf(
      text, sizeof text,
      "%.*s  - {name: second, shape: film, material: film, thickness: 50 um, pre_stretch: 1.2}\n"
      "%.*sstandard_uncertainties: {c1: 3 kPa}, %s",
      (int)(plies - cone), cone, (int)(at - plies), plies, at);
  const struct dea_override written = {"compute.uncertainty", "{}"};
  struct run run = run_begin(text, &written, 1);
  const struct dea_study_services services = {.run = dea_study_run};
  assert_int_equal(dea_study_run_with(ctx, dea_model_find("3d"), names, 2, &services, run.result),
                   DEA_OK);
  const struct dea_result_table *table =
      dea_result_find_table(run.result, "3d", "uncertainty", "effects");
  assert_non_null(table);
  assert_string_equal(dea_result_table_cell(table, 0, 2)->text, "plies.film.law.c1");
  assert_string_equal(dea_result_table_cell(table, 1, 2)->text, "all"); // one number for both
  const double one = get(&dea_result_find(run.result, "3d", "sweep")->std[1], "hub_z_m");
  double z[2];
  for (int side = 0; side < 2; side++) { // of both at once
    const char *c1 = strstr(text, "c1: 178.4");
    memcpy((char *)(uintptr_t)c1, side == 0 ? "c1: 175.4" : "c1: 181.4", 9);
    static const char *const sweep[] = {"sweep"};
    struct run other = run_begin(text, NULL, 0);
    assert_int_equal(dea_study_run(ctx, dea_model_find("3d"), sweep, 1, other.result), DEA_OK);
    z[side] = get(&dea_result_find(other.result, "3d", "sweep")->points[1], "hub_z_m");
    memcpy((char *)(uintptr_t)c1, "c1: 178.4", 9);
    run_end(&other);
  }
  assert_close(one, fabs(z[1] - z[0]) / 2, 1e-6, 0);
  run_end(&run);
}

/* Limits against a number of a part: those of a sweep of that design, levels between its points. */
TEST(test_operating_map)
{
  static const char *const names[] = {"operating-map"};
  const struct dea_override of[] = {
      {"compute.operating_map",
       "{parameters: [{name: plies.film.thickness, from: 80 um, to: 100 um}], "
       "quantity: hub_z_m, rows: 2}"},
      {"compute.voltage", "{values: [0 kV, 2 kV, 4 kV, 6 kV]}"}};
  const struct dea_override thin[] = {{"plies.film.thickness", "80 um"}, of[1]};
  static const char *const sweep[] = {"sweep"};
  struct run run = run_studies(of, 2, names, 1), other = run_studies(thin, 2, sweep, 1);
  const struct dea_curve *curve = dea_result_find(other.result, "3d", "sweep");
  const struct dea_result_table *scale =
      dea_result_find_table(run.result, "3d", "operating-map", "");
  const struct dea_result_table *table =
      dea_result_find_table(run.result, "3d", "operating-map", "plies_film_thickness");
  assert_true(scale != NULL && table != NULL);
  assert_int_equal(table->row_count, 2);
  assert_close(dea_result_table_number(table, 0, "plies_film_thickness_m", 0), 80e-6, 1e-12, 0);
  assert_close(dea_result_table_number(scale, 0, "own_plies_film_thickness_m", 0), 100e-6, 1e-12,
               0);
  assert_string_equal(dea_result_table_quantity(scale, 0)->key, "hub_z_m");
  const double base = dea_result_table_number(scale, 0, "level_base", 0);
  const double step = dea_result_table_number(scale, 0, "level_step", 0);
  size_t levels = 0;
  for (size_t k = 0; k < table->width; k++) {
    const double level = base + step * (double)(k + 1);
    for (size_t i = 1; i < curve->count; i++) {
      const double a = get(&curve->points[i - 1], "hub_z_m"), b = get(&curve->points[i], "hub_z_m");
      if (a < level && b >= level) {
        const double V = curve->points[i - 1].voltage_V + 2e3 * (level - a) / (b - a);
        assert_close(dea_result_table_number(table, 0, "level_V", k), V, 1e-6, 0);
        levels++;
      }
    }
  }
  assert_true(levels > 1);
  double breakdown_V = NAN;
  for (size_t i = 1; i < curve->count; i++) {
    const double a = curve->points[i - 1].breakdown_margin, b = curve->points[i].breakdown_margin;
    breakdown_V =
        a >= 0 && b < 0 ? curve->points[i - 1].voltage_V + 2e3 * a / (a - b) : breakdown_V;
  }
  assert_close(dea_result_table_number(table, 0, "breakdown_V", 0), breakdown_V, 1e-6, 0);
  run_end(&other);
  run_end(&run);
}

static const char flat[] = "dea: 1\n"
                           "title: a film that is held at its edge\n"
                           "shapes:\n"
                           "  - {name: film, kind: circle, radius: 10 mm}\n"
                           "  - {name: active, kind: circle, radius: 4 mm}\n"
                           "plies:\n"
                           "  - {name: film, shape: film, material: film, thickness: 500 um}\n"
                           "electrodes:\n"
                           "  - {ply: film, side: bottom, shape: active, channel: ground}\n"
                           "  - {ply: film, side: top, shape: active, channel: drive}\n"
                           "channels: [{name: drive, ratio: 0.5}]\n"
                           "supports:\n"
                           "  - {edge: film}\n"
                           "monitors:\n"
                           "  - {name: middle, at: [0 mm, 0 mm]}\n" FILM_MATERIAL "compute:\n"
                           "  models: [3d]\n"
                           "  voltage: {values: [1 kV]}\n";

/* One voltage of that film. */
static struct dea_load_point at_one(const struct dea_override *overrides, size_t count, double *z_m,
                                    double *charge_C)
{
  struct run run;
  struct dea_model *model;
  struct dea_load_point point;
  struct dea_monitor_set set;
  const struct dea_model_type *type = dea_model_find("3d");
  assert_int_equal(read_and_build(ctx, flat, overrides, count, &run.design, &run.device), DEA_OK);
  assert_int_equal(dea_model_create(ctx, type, run.design, run.device, &model), DEA_OK);
  assert_int_equal(type->solve(ctx, model, run.design->compute.voltages_V[0], &point), DEA_OK);
  assert_int_equal(dea_monitor_set_init(ctx, type, run.device, &set), DEA_OK);
  assert_int_equal(dea_monitor_set_read(ctx, &set, type, model, false, &point), DEA_OK);
  *z_m = get(&point, "middle_z_m");
  *charge_C = get(&point, "drive_charge_C");
  point.monitors = NULL;
  dea_monitor_set_free(&set);
  type->destroy(ctx, model);
  dea_device_destroy(ctx, run.device);
  dea_design_destroy(ctx, run.design);
  return point;
}

/* The side that is asked for; the other one is its mirror image. */
TEST(test_side)
{
  double z_m[2], charge_C;
  for (int back = 0; back < 2; back++) {
    const struct dea_override of[] = {{"compute.solid.buckling_branch", back ? "back" : "fibres"},
                                      {"plies.film.thickness", "200 um"},
                                      {"shapes.active.radius", "10 mm"},
                                      {"channels.drive.ratio", "1"},
                                      {"compute.voltage", "{values: [3 kV]}"}};
    at_one(of, 5, &z_m[back], &charge_C);
  }
  assert_true(z_m[0] > 100e-6);
  assert_close(z_m[1], -z_m[0], 1e-4, 0);
}

TESTS(context_set_up, context_tear_down)
