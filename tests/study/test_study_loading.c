/* Study "loading" with a model of one spring: F = k x - b V^2 holds a body at x, stiffer beyond
 * x_stop, where it does not converge; what its keys must be. */
#include "design_text.h"
#include "study/study.h"

#include "layout_device.h"

static const double k = 50, b = 2e-9, x_stop = 2e-3;

struct dea_model {
  double voltage_V, x, push, factor; // place, dead force, factor of pressures
  bool held;
  double body[1][DEA_OBSERVED_COUNT];
};

static dea_status create(struct dea_context *context, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  *out = dea_alloc(context, 1, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  (*out)->factor = 1;
  return DEA_OK;
}

static void destroy(struct dea_context *context, struct dea_model *model)
{
  dea_free(context, model);
}

/* Pressures of 200 Pa push as 20 mN. */
static double pull(const struct dea_model *m)
{
  return b * m->voltage_V * m->voltage_V + 0.02 * m->factor;
}

static dea_status report(struct dea_model *m, struct dea_load_point *out)
{
  m->x = m->held ? m->x : (m->push + pull(m)) / k;
  *out = dea_load_point_empty();
  out->voltage_V = m->voltage_V;
  out->energy_J = 0.5 * k * m->x * m->x;
  return DEA_OK;
}

static dea_status solve(struct dea_context *context, struct dea_model *model, double voltage_V,
                        struct dea_load_point *out)
{
  model->voltage_V = voltage_V;
  return report(model, out);
}

static dea_status move(struct dea_context *context, struct dea_model *m,
                       const struct dea_control *control, double value, struct dea_load_point *out)
{
  if (control->kind == DEA_CONTROL_PRESSURE) {
    m->factor = value;
    return report(m, out);
  }
  assert_int_equal(control->body, 0);
  assert_int_equal(control->component, 2);
  if (control->kind == DEA_CONTROL_FORCE) {
    m->push = value;
    return report(m, out);
  }
  if (value > x_stop && m->voltage_V > 0) {
    return dea_fail(context, DEA_E_NOT_CONVERGED, "the stop is hit");
  }
  m->held = true;
  m->x = value;
  return report(m, out);
}

static dea_status observe(struct dea_context *context, struct dea_model *m,
                          struct dea_observation *out)
{
  for (int i = 0; i < DEA_OBSERVED_COUNT; i++) {
    m->body[0][i] = 0;
  }
  m->body[0][DEA_OBSERVED_Z] = m->x;
  m->body[0][DEA_OBSERVED_FORCE_Z] = m->held ? k * m->x - pull(m) : 0;
  static const struct dea_channel_values channels[2] = {{0}};
  *out = (struct dea_observation){.monitor_count = 1,
                                  .body_count = 1,
                                  .channel_count = 2,
                                  .channel = channels,
                                  .monitor = (const double(*)[DEA_OBSERVED_COUNT])m->body,
                                  .body = (const double(*)[DEA_OBSERVED_COUNT])m->body};
  return DEA_OK;
}

static const struct dea_model_type spring = {.name = "spring",
                                             .long_name = "one spring",
                                             .any_layout = true,
                                             .create = create,
                                             .destroy = destroy,
                                             .solve = solve,
                                             .move = move,
                                             .observe = observe};

extern const struct dea_study dea_study_loading;

struct ran {
  struct dea_design *design;
  struct dea_result *result;
  const struct dea_result_table *points, *lines;
};

static struct dea_device *spring_device(void)
{
  struct dea_device *device = cone_new();
  struct dea_layout *l = device->layout;
  l->pressures[l->pressure_count++] = (struct dea_layout_pressure){.pressure_Pa = 100};
  l->pressures[l->pressure_count++] = (struct dea_layout_pressure){.pressure_Pa = 200};
  return device;
}

static struct ran run(const struct dea_device *device, const char *loading, dea_status wanted)
{
  static const char *const names[] = {"loading"};
  const struct dea_override set = {"compute.loading", loading};
  struct ran r;
  assert_int_equal(dea_design_read_memory(ctx, "test.yaml", GOOD_DESIGN, strlen(GOOD_DESIGN), &set,
                                          1, &r.design),
                   DEA_OK);
  assert_int_equal(dea_result_create(ctx, r.design, device, &r.result), DEA_OK);
  assert_int_equal(dea_study_run(ctx, &spring, names, 1, r.result), wanted);
  r.points = dea_result_find_table(r.result, "spring", "loading", "points");
  r.lines = dea_result_find_table(r.result, "spring", "loading", "lines");
  assert_non_null(r.points);
  assert_non_null(r.lines);
  return r;
}

static void end(struct ran *r)
{
  dea_result_destroy(ctx, r->result);
  dea_design_destroy(ctx, r->design);
}

static double point(const struct ran *r, size_t row, const char *key)
{
  return dea_result_table_number(r->points, row, key, 0);
}

/* The line at 0 V is whole; that at 3 kV stops, says why, and that at 1 kV has its turn. */
TEST(test_lines)
{
  struct dea_device *device = spring_device();
  struct ran r = run(device,
                     "{body: hub, from: 1 mm, to: 3 mm, steps: 4, back: yes,"
                     " voltage: [0 kV, 3 kV, 0 kV]}",
                     DEA_E_NOT_CONVERGED);
  assert_non_null(strstr(dea_context_message(ctx), "3 kV has 3 points"));
  assert_int_equal(r.points->row_count, 9 + 3 + 9);
  for (size_t i = 0; i < 21; i++) {
    size_t on = i < 9 ? i : i < 12 ? i - 9 : i - 12;
    double x = 1e-3 + 0.5e-3 * (double)(on < 5 ? on : 8 - on);
    double V = i < 9 || i > 11 ? 0 : 3e3;
    assert_close(point(&r, i, "shift_m"), x, 1e-12, 0);
    assert_close(point(&r, i, "force_N"), k * x - b * V * V - 0.02, 1e-12, 1e-15);
    assert_close(point(&r, i, "back"), on >= 5, 0, 0);
    assert_true(isnan(point(&r, i, "pressure_Pa")));
  }
  assert_int_equal(r.lines->row_count, 3);
  assert_close(dea_result_table_number(r.lines, 1, "blocked_force_N", 0), -b * 9e6, 1e-12, 0);
  assert_close(dea_result_table_number(r.lines, 1, "complete", 0), 0, 0, 0);
  assert_close(dea_result_table_number(r.lines, 2, "complete", 0), 1, 0, 0);
  const struct dea_curve *curve = dea_result_find(r.result, "spring", "loading");
  assert_false(curve->complete);
  assert_non_null(strstr(curve->stopped, "the stop is hit"));
  assert_int_equal(curve->count, 21);
  assert_close(dea_point_get(&curve->points[20], dea_column_find(ctx, "hub_z_m")), 1e-3, 1e-12, 0);
  struct dea_plot *plot;
  assert_int_equal(dea_plot_create(ctx, "loading", "", &plot), DEA_OK);
  assert_int_equal(dea_study_loading.figures[0].build(ctx, r.result, plot), DEA_OK);
  assert_int_equal(plot->panels[0].series_count, 5); // two whole ones with their ways back
  assert_string_equal(plot->panels[0].series[2].title, "3 kV");
  assert_close(plot->panels[0].series[2].values[3], 1e3 * (k * 1e-3 - b * 9e6 - 0.02), 1e-12, 0);
  dea_plot_destroy(ctx, plot);
  end(&r);
  dea_device_destroy(ctx, device);
}

TEST(test_force_and_pressure)
{
  struct dea_device *device = spring_device();
  struct ran r =
      run(device, "{body: hub, force_from: 0 N, force_to: 1 N, steps: 2, voltage: [1 kV]}", DEA_OK);
  assert_int_equal(r.points->row_count, 3);
  assert_close(point(&r, 1, "force_N"), 0.5, 1e-12, 0);
  assert_close(point(&r, 1, "shift_m"), (0.5 + b * 1e6 + 0.02) / k, 1e-12, 0);
  assert_true(isnan(dea_result_table_number(r.lines, 0, "blocked_force_N", 0)));
  end(&r);
  r = run(device, "{body: hub, pressure_from: 0 Pa, pressure_to: 400 Pa, steps: 2}", DEA_OK);
  assert_close(point(&r, 2, "pressure_Pa"), 400, 1e-12, 0);
  assert_close(point(&r, 2, "shift_m"), 0.04 / k, 1e-12, 0); // twice the layout's largest
  end(&r);
  dea_device_destroy(ctx, device);
}

TEST(test_bad_keys)
{
  static const struct {
    const char *loading, *message;
  } bad[] = {
      {"{body: hub}", "from and to are missing"},
      {"{body: hub, from: 1 mm}", "both where it begins"},
      {"{body: hub, from: 1 mm, to: 1 mm}", "ends where it begins"},
      {"{from: 0 mm, to: 1 mm}", "which body?"},
      {"{body: hub, from: 0 mm, to: 1 mm, force_from: 0 N, force_to: 1 N}", "exclude each other"},
      {"{body: hub, direction: turn_x, from: 0 mm, to: 1 mm}", "turn_from to turn_to"},
      {"{body: hub, turn_from: 0 degree, turn_to: 1 degree}", "need direction"},
      {"{body: hub, from: 0 mm, to: 1 mm}", "only designs with plies"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    const struct dea_override set = {"compute.loading", bad[i].loading};
    struct dea_design *design = NULL;
    struct dea_device *device = NULL;
    dea_context_clear(ctx);
    assert_int_equal(read_and_build(ctx, GOOD_DESIGN, &set, 1, &design, &device), DEA_E_DESIGN);
    if (find_error(ctx, bad[i].message) == NULL) {
      print_findings(ctx);
      fail_msg("no finding says '%s'", bad[i].message);
    }
    dea_device_destroy(ctx, device);
    dea_design_destroy(ctx, design);
  }
}

TESTS(context_set_up, context_tear_down)
