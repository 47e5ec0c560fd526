/* Studies "operating-map" and "load-line": what the report draws of model lumped. */
// ctest: slow, heavy
#include "design_text.h"
#include "study/study.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above
#include "study_run.h"

extern const struct dea_study dea_study_operating_map;

#define VOLTAGES "compute:\n  voltage: {values: [0 kV, 3 kV, 6 kV]}\n"

/* Studies of these names (NULL: those that the design asks for) of a design with overrides. */
static struct run run(const char *model, const char *const names[], size_t count,
                      const struct dea_override *overrides, size_t override_count)
{
  struct run r = run_begin(GOOD_DESIGN VOLTAGES, overrides, override_count);
  assert_int_equal(dea_study_run(ctx, dea_model_find(model), names, count, r.result), DEA_OK);
  return r;
}

static const char *const map_only[] = {"operating-map"}, *const path_only[] = {"path"};

static void assert_limit(double found, const struct dea_curve *path, enum dea_event_kind kind,
                         double end_V)
{
  const struct dea_event *event = dea_curve_first_event(path, kind);
  if (event == NULL || event->point.voltage_V > end_V) {
    assert_true(isnan(found));
  } else {
    assert_close(found, event->point.voltage_V, 1e-6, 0);
  }
}

/* A row against the path of a design that is read anew with that row's value. */
static void assert_row(const char *model, const struct dea_result_table *table, const char *key,
                       const char *column, size_t row, double end_V)
{
  char text[40];
  const struct dea_override override[2] = {{key, text}, {"compute.path.max_stretch", "6"}};
  snprintf(text, sizeof text, "%.12g%s", dea_result_table_number(table, row, column, 0),
           strcmp(column, "film_thickness_m") == 0 ? " m" : "");
  struct run r = run(model, path_only, 1, override, 2);
  const struct dea_curve *path = dea_result_find(r.result, model, "path");
  assert_limit(dea_result_table_number(table, row, "breakdown_V", 0), path, DEA_EVENT_BREAKDOWN,
               end_V);
  assert_limit(dea_result_table_number(table, row, "pull_in_V", 0), path, DEA_EVENT_PULL_IN, end_V);
  if (strcmp(key, "pre_stretch") != 0 || row > 0) { // 1: slack from the start, and no event
    assert_limit(dea_result_table_number(table, row, "slack_V", 0), path, DEA_EVENT_SLACK, end_V);
  }
  run_end(&r);
}

TEST(test_limits_are_those_of_the_paths)
{
  skip_sanitized();
  static const char *const models[] = {"lumped", "axisymmetric"};
  for (size_t m = 0; m < 2; m++) {
    struct run r = run(models[m], map_only, 1, NULL, 0);
    const struct dea_result_table *scale =
        dea_result_find_table(r.result, models[m], "operating-map", "");
    const struct dea_result_table *stretch =
        dea_result_find_table(r.result, models[m], "operating-map", "pre_stretch");
    const struct dea_result_table *thickness =
        dea_result_find_table(r.result, models[m], "operating-map", "film_thickness");
    double end_V = dea_result_table_number(scale, 0, "end_voltage_V", 0);
    assert_close(dea_result_table_number(scale, 0, "highest_voltage_V", 0), 6e3, 0, 0);
    assert_close(end_V, 9e3, 1e-15, 0);
    assert_int_equal(stretch->row_count, 33);
    assert_close(dea_result_table_number(stretch, 0, "pre_stretch", 0), 1, 0, 0);
    assert_close(dea_result_table_number(stretch, 32, "pre_stretch", 0), 2.55, 1e-12, 0);
    for (size_t row = 0; row < 33; row += 16) {
      assert_row(models[m], stretch, "pre_stretch", "pre_stretch", row, end_V);
      assert_row(models[m], thickness, "film.thickness", "film_thickness_m", row, end_V);
    }
    assert_close(r.design->pre_stretch.si, 1.5, 0, 0); // as it was
    assert_close(r.design->film.thickness_m.si, 100e-6, 1e-12, 0);
    run_end(&r);
  }
}

TEST(test_figures)
{
  struct run r = run("lumped", map_only, 1, NULL, 0);
  for (size_t f = 0; f < 2; f++) { // the last is of other numbers
    const struct dea_figure *figure = &dea_study_operating_map.figures[f];
    struct dea_plot *plot;
    bool level = false;
    assert_int_equal(dea_plot_create(ctx, figure->name, figure->caption, &plot), DEA_OK);
    assert_int_equal(figure->build(ctx, r.result, plot), DEA_OK);
    const struct dea_panel *panel = &plot->panels[0];
    assert_int_equal(plot->panel_count, 1);
    assert_close(panel->y_max, 9, 1e-12, 0);
    for (size_t s = 0; s < panel->series_count; s++) { // of rigid rods: no predictions
      level = level || strstr(panel->series[s].title, "z} \342\211\244 ") != NULL;
    }
    assert_true(level);
    const struct dea_series *own = &panel->series[panel->series_count - 1];
    assert_close(own->values[0], f == 0 ? 1.5 : 100, 1e-12, 0);
    assert_close(own->values[1], 6, 1e-12, 0);
    dea_plot_destroy(ctx, plot);
  }
  run_end(&r);
}

/* The load lines hold the tips of the free actuator with no force; their work is the difference of
 * the potential energies of both ends, and none is above the largest force of the sweep. */
TEST(test_work_of_the_load_lines)
{
  static const char *const names[] = {"sweep", "load-line"};
  static const struct dea_override quarters = {"compute.voltage",
                                               "{values: [0 kV, 1.5 kV, 3 kV, 4.5 kV, 6 kV]}"};
  struct run r = run("lumped", names, 2, &quarters, 1);
  const struct dea_curve *sweep = dea_result_find(r.result, "lumped", "sweep");
  const struct dea_result_table *table =
      dea_result_find_table(r.result, "lumped", "load-line", "forces");
  size_t row = 0;
  for (size_t line = 1; line < 5; line++) {
    const struct dea_load_point *free = &sweep->points[line];
    double V = free->voltage_V, work = 0, largest = 0, z = 0, F = 0;
    assert_close(dea_result_table_number(table, row, "height_m", 0), 0, 0, 0);
    assert_close(dea_result_table_number(table, row, "force_N", 0), 0, 0, 0);
    for (row++; dea_result_table_number(table, row, "height_m", 0) > 0; row++) {
      double next = dea_result_table_number(table, row, "height_m", 0);
      double force = dea_result_table_number(table, row, "force_N", 0);
      assert_close(dea_result_table_number(table, row, "voltage_V", 0), V, 1e-15, 0);
      work += 0.5 * (F + force) * (next - z); // trapezoids
      largest = fmax(largest, force);
      z = next;
      F = force;
    }
    double flat_J = -0.5 * sweep->points[0].capacitance_F * V * V;
    assert_close(z, free->fibre_tip_z_m, 1e-6, 0);
    assert_close(F, 0, 0, 1e-6 * largest);
    assert_close(largest, free->force_N, 1e-3, 0);
    assert_close(work, flat_J - free->energy_J, 1e-3, 0);
  }
  assert_int_equal(row, table->row_count);
  run_end(&r);
}

/* No design asks for them; a model without load line says so. */
TEST(test_by_name_only)
{
  static const char *const line_only[] = {"load-line"};
  struct run r = run("lumped", NULL, 0, NULL, 0);
  assert_int_equal(r.result->table_count, 0);
  run_end(&r);
  r = run("axisymmetric", line_only, 1, NULL, 0);
  assert_int_equal(r.result->table_count, 0);
  assert_non_null(find_finding(ctx, DEA_NOTE, "model axisymmetric does not support a load line"));
  run_end(&r);
}

TESTS(context_set_up, context_tear_down)
