/* Study "force" with a model of one spring: F = k d + c d^3 - b V^2 on a tip at depth d. */
#include "design_text.h"
#include "study/study.h"

#include "context_fixture.h"

struct dea_model {
  double depth_m, voltage_V;
  int presses;
};

static int created; // models

static const double k = 50, c = 5e6, b = 2e-9;
static double passed_m = 1; // from that depth on the tip has passed the spring

static double force(const struct dea_model *model)
{
  double d = model->depth_m;
  return d > 0 && d < passed_m ? k * d + c * d * d * d - b * model->voltage_V * model->voltage_V
                               : 0;
}

static dea_status create(struct dea_context *context, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  *out = dea_alloc(context, 1, sizeof **out);
  created++;
  return *out != NULL ? DEA_OK : DEA_E_MEMORY;
}

static void destroy(struct dea_context *context, struct dea_model *model)
{
  dea_free(context, model);
}

static dea_status report(const struct dea_model *model, struct dea_load_point *out)
{
  *out = dea_load_point_empty();
  out->voltage_V = model->voltage_V;
  out->tip_depth_m = model->depth_m;
  out->force_N = force(model);
  return DEA_OK;
}

static dea_status solve(struct dea_context *context, struct dea_model *model, double voltage_V,
                        struct dea_load_point *out)
{
  model->voltage_V = voltage_V;
  return report(model, out);
}

static dea_status indent(struct dea_context *context, struct dea_model *model,
                         const struct dea_probe *tip, double depth_m, struct dea_load_point *out)
{
  assert_close(tip->radius_m, 2e-3, 1e-12, 0);
  assert_true(tip->shape == DEA_PROBE_FLAT && !tip->from_fibre_side);
  assert_close(model->voltage_V, 0, 0, 0); // pressed first, voltage after
  model->depth_m = depth_m;
  model->presses++;
  return report(model, out);
}

static dea_status save(struct dea_context *context, struct dea_model *model, struct dea_state *out)
{
  *out = (struct dea_state){0};
  return dea_state_add_numbers(context, out, "voltage", &model->voltage_V, 1);
}

static dea_status load(struct dea_context *context, struct dea_model *model,
                       const struct dea_state *state)
{
  const double *voltage_V = dea_state_find(state, "voltage", 1);
  assert_true(voltage_V != NULL && *voltage_V == 0 && model->depth_m > 0);
  model->voltage_V = *voltage_V;
  return DEA_OK;
}

static const struct dea_model_type spring = {.name = "spring",
                                             .long_name = "one spring",
                                             .create = create,
                                             .destroy = destroy,
                                             .solve = solve,
                                             .indent = indent};

extern const struct dea_study dea_study_force;

#include "study_result.h" // after the model: its names shadow none of the arguments above

TEST(test_depths_and_preloads)
{
  static const struct dea_override sets[] = {
      {"compute.voltage", "{from: 0 kV, to: 2 kV, step: 1 kV}"},
      {"compute.force",
       "{tip: flat, radius: 2 mm, side: back, depth: [1 mm, -1 mm], preload: [180 mN]}"}};
  set_up_result(GOOD_DESIGN, sets, 2);
  assert_int_equal(dea_study_run(ctx, &spring, NULL, 0, result), DEA_OK);
  const struct dea_curve *curve = dea_result_find(result, "spring", "force");
  assert_non_null(curve);
  assert_true(curve->complete);
  assert_int_equal(curve->count, 9); // three stops of three voltages
  static const double depths_m[] = {1e-3, -1e-3};
  for (size_t i = 0; i < 6; i++) {
    struct dea_model wanted = {.depth_m = depths_m[i / 3], .voltage_V = 1e3 * (double)(i % 3)};
    assert_close(curve->points[i].tip_depth_m, wanted.depth_m, 1e-12, 0);
    assert_close(curve->points[i].force_N, force(&wanted), 1e-12, 1e-15);
  }
  assert_close(curve->points[6].force_N, 0.18, 1e-3, 0);
  assert_close(curve->points[6].force_N - curve->points[8].force_N, b * 4e6, 1e-9, 0);
  // its load lines: against the depth, the least deep one first, at each voltage
  struct dea_plot *plot;
  assert_int_equal(dea_plot_create(ctx, "load_line", "", &plot), DEA_OK);
  assert_string_equal(dea_study_force.figures[1].name, "load_line");
  assert_int_equal(dea_study_force.figures[1].build(ctx, result, plot), DEA_OK);
  static const size_t by_depth[] = {1, 0, 2};
  assert_int_equal(plot->panels[0].series_count, 3);
  for (size_t v = 0; v < 3; v++) {
    const struct dea_series *line = &plot->panels[0].series[v];
    assert_int_equal(line->count, 3);
    for (size_t i = 0; i < 3; i++) {
      const struct dea_load_point *p = &curve->points[3 * by_depth[i] + v];
      assert_close(line->values[i], 1e3 * p->tip_depth_m, 1e-14, 0);
      assert_close(line->values[3 + i], 1e3 * p->force_N, 1e-14, 0);
    }
  }
  dea_plot_destroy(ctx, plot);
  tear_down_result();
}

/* A tip that has passed what it was pressed against, and a model that knows none. */
TEST(test_nothing_touched)
{
  static const struct dea_override sets[] = {
      {"compute.voltage", "{to: 2 kV, step: 1 kV}"},
      {"compute.force", "{tip: flat, radius: 2 mm, side: back, depth: [-1 mm, 1 mm, 3 mm]}"}};
  static const char *const name = "force";
  static const struct dea_model_type bare = {
      .name = "bare", .create = create, .destroy = destroy, .solve = solve};
  set_up_result(GOOD_DESIGN, sets, 2);
  passed_m = 2e-3;
  assert_int_equal(dea_study_run(ctx, &spring, &name, 1, result), DEA_OK);
  passed_m = 1;
  assert_int_equal(dea_finding_count(ctx, DEA_WARNING), 1);
  assert_non_null(find_finding(ctx, DEA_WARNING, "at a depth of 3 mm the tip touches no film"));
  assert_int_equal(dea_study_run(ctx, &bare, &name, 1, result), DEA_OK);
  assert_non_null(find_finding(
      ctx, DEA_NOTE, "model bare does not support indentation by a tip: no study 'force'"));
  assert_null(dea_result_find(result, "bare", "force"));
  tear_down_result();
}

/* A tip goes on from the depth before where the next one is deeper; the numbers are those of a
 * model of each depth's own. */
TEST(test_deeper)
{
  static const struct dea_override sets[] = {
      {"compute.voltage", "{from: 0 kV, to: 2 kV, step: 1 kV}"},
      {"compute.force", "{tip: flat, radius: 2 mm, side: back, depth: [1 mm, 2 mm, 3 mm, 2 mm], "
                        "preload: [180 mN]}"}};
  static const char *const name = "force";
  struct dea_model_type types[2] = {spring, spring};
  struct dea_result *each_own;
  types[1].save = save;
  types[1].load = load;
  set_up_result(GOOD_DESIGN, sets, 2);
  assert_int_equal(dea_result_create(ctx, design, device, &each_own), DEA_OK);
  for (int i = 0; i < 2; i++) {
    created = 0;
    assert_int_equal(dea_study_run(ctx, &types[i], &name, 1, i == 0 ? each_own : result), DEA_OK);
    assert_int_equal(created, i == 0 ? 5 : 3); // from rest: 1 mm, 2 mm after 3, the preload
  }
  const struct dea_curve *each = dea_result_find(each_own, "spring", "force");
  const struct dea_curve *on = dea_result_find(result, "spring", "force");
  assert_true(each->count == 15 && on->count == 15);
  for (size_t i = 0; i < on->count; i++) {
    assert_close(on->points[i].force_N, each->points[i].force_N, 1e-12, 1e-15);
    assert_close(on->points[i].tip_depth_m, each->points[i].tip_depth_m, 1e-12, 0);
  }
  dea_result_destroy(ctx, each_own);
  tear_down_result();
}

// Lines -----------------------------------------------------------------------------------------

/* A film whose force is F = F_0 - b V^2 - c V^4, which jumps at 6.35 kV to a state
 * that goes back with the voltage only below 5.2 kV. */
struct dea_film {
  double end_V; // no equilibrium beyond
  int solves;
};
static struct dea_film film;
static const double jump_V = 6350;
static bool jumped;

static double taut_force(double voltage_V)
{
  double V = voltage_V / 1e3;
  return 0.1 - 4e-4 * V * V - 1e-5 * V * V * V * V;
}

static dea_status film_solve(struct dea_context *context, struct dea_model *model, double voltage_V,
                             struct dea_load_point *out)
{
  film.solves++;
  if (voltage_V > film.end_V) {
    return dea_fail(context, DEA_E_NO_EQUILIBRIUM, "none at %g V", voltage_V);
  }
  model->voltage_V = voltage_V;
  jumped = voltage_V > jump_V || (jumped && voltage_V > 5200);
  report(model, out);
  out->force_N = taut_force(voltage_V) - (jumped ? 0.02 : 0);
  out->own_flags = jumped ? 1u << DEA_FLAG_STATES : 0;
  return DEA_OK;
}

static dea_status film_load(struct dea_context *context, struct dea_model *model,
                            const struct dea_state *state)
{
  model->voltage_V = *dea_state_find(state, "voltage", 1);
  jumped = false; // states are kept of 0 V only
  return DEA_OK;
}

/* Study force of that film. Returns how it ended. */
static dea_status run_film(const char *voltages, const char *force)
{
  const struct dea_override sets[] = {{"compute.voltage", voltages}, {"compute.force", force}};
  static const char *const name = "force";
  struct dea_model_type type = spring;
  type.save = save;
  type.load = film_load;
  type.solve = film_solve;
  film.solves = 0;
  jumped = false;
  set_up_result(GOOD_DESIGN, sets, 2);
  return dea_study_run(ctx, &type, &name, 1, result);
}

#define TO_8_KV "{from: 0 kV, to: 8 kV, step: 0.1 kV}"
#define ONE_MM "{tip: flat, radius: 2 mm, side: back, depth: [1 mm]}"

/* All voltages as they come, up and back, and the table of the line. */
TEST(test_line)
{
  film = (struct dea_film){.end_V = INFINITY};
  assert_int_equal(run_film("{from: 0 kV, to: 8 kV, step: 0.1 kV, back: yes}", ONE_MM), DEA_OK);
  const struct dea_curve *curve = dea_result_find(result, "spring", "force");
  assert_int_equal(curve->count, 161);
  assert_int_equal(film.solves, 161);
  for (size_t i = 0; i < 161; i++) {
    const struct dea_load_point *p = &curve->points[i];
    double V = 100.0 * (double)(i < 81 ? i : 160 - i);
    bool jumps = V > (i < 81 ? jump_V : 5200);
    assert_close(p->voltage_V, V, 1e-12, 0);
    assert_close(p->force_N, taut_force(V) - (jumps ? 0.02 : 0), 1e-14, 0);
    assert_true(((p->own_flags >> DEA_FLAG_STATES & 1) != 0) == jumps);
  }
  const struct dea_result_table *table = dea_result_find_table(result, "spring", "force", "lines");
  assert_non_null(table);
  assert_close(dea_result_table_number(table, 0, "voltages", 0), 161, 0, 0);
  assert_close(dea_result_table_number(table, 0, "first_force_N", 0), taut_force(0), 1e-14, 0);
  assert_close(dea_result_table_number(table, 0, "last_force_N", 0), taut_force(0), 1e-14, 0);
  tear_down_result();
}

/* A line that stops has its points up to there, and says why. */
TEST(test_stops)
{
  static const double ends_V[] = {7250, 4150, -1};
  static const size_t counts[] = {73, 42, 0};
  for (int i = 0; i < 3; i++) {
    film = (struct dea_film){.end_V = ends_V[i]};
    assert_int_equal(run_film(TO_8_KV, ONE_MM), DEA_E_NO_EQUILIBRIUM);
    const struct dea_curve *curve = dea_result_find(result, "spring", "force");
    assert_int_equal(curve->count, counts[i]);
    assert_int_equal(curve->status, DEA_E_NO_EQUILIBRIUM);
    char why[40];
    snprintf(why, sizeof why, "none at %g V", 100.0 * (double)counts[i]);
    assert_non_null(strstr(curve->stopped, why));
    const struct dea_result_table *table =
        dea_result_find_table(result, "spring", "force", "lines");
    if (counts[i] > 0) { // to where it jumps
      assert_close(dea_result_table_number(table, 0, "trusted_voltage_V", 0),
                   fmin(6300, 100.0 * (double)(counts[i] - 1)), 1e-9, 0);
    }
    tear_down_result();
    dea_context_clear(ctx);
  }
}

static bool interrupted(void *user)
{
  return film.solves == 14;
}

/* An interrupted line has what was computed. */
TEST(test_interrupted)
{
  film = (struct dea_film){.end_V = INFINITY};
  dea_context_set_interrupt_fn(ctx, interrupted, NULL);
  assert_int_equal(run_film(TO_8_KV, ONE_MM), DEA_E_INTERRUPTED);
  dea_context_set_interrupt_fn(ctx, NULL, NULL);
  assert_int_equal(dea_result_find(result, "spring", "force")->count, 14);
  tear_down_result();
  dea_context_clear(ctx);
}

TESTS(context_set_up, context_tear_down)
