/* Study "transient" of designs, and what is read from its curve. */
#include "design_text.h"
#include "failing_allocator.h"
#include "result/result.h"
#include "study/study.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <signal.h>

#define VISCOUS "    viscosity: [{id: m, branches: [{ratio: 0.3, time: 0.2 s}], source: test}]\n"

/* A film of neo-Hookean rubber that creeps, no fibres; drive and more are appended. */
#define DESIGN                                                                                     \
  "dea: 1\n"                                                                                       \
  "film: {material: rubber, thickness: 100 um}\n"                                                  \
  "pre_stretch: 1.2\n"                                                                             \
  "frame: {inner_diameter: 30 mm}\n"                                                               \
  "electrodes: {radius: 4 mm stretched}\n"                                                         \
  "materials:\n"                                                                                   \
  "  - name: rubber\n"                                                                             \
  "    kind: elastomer\n"                                                                          \
  "    density: {value: 1000 kg/m^3, source: test}\n"                                              \
  "    laws: [{id: a, law: neo-hookean, parameters: {mu: 100 kPa}, source: test}]\n"               \
  "    permittivity: [{id: a, at_rest: 3, source: test}]\n" VISCOUS

struct run {
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *result;
  const struct dea_curve *curve;
  dea_status status;
};

static struct run run_text(struct dea_context *context, const char *text)
{
  static const char *const names[] = {"transient"};
  struct run run = {NULL, NULL, NULL, NULL, DEA_OK};
  run.status = read_and_build(context, text, NULL, 0, &run.design, &run.device);
  run.status = run.status == DEA_OK
                   ? dea_result_create(context, run.design, run.device, &run.result)
                   : run.status;
  if (run.status == DEA_OK) {
    run.status = dea_study_run(context, dea_model_find("lumped"), names, 1, run.result);
    run.curve = dea_result_find(run.result, "lumped", "transient");
  }
  return run;
}

static void end(struct dea_context *context, struct run *run)
{
  dea_result_destroy(context, run->result);
  dea_device_destroy(context, run->device);
  dea_design_destroy(context, run->design);
}

extern const struct dea_study dea_study_transient;

/* A table of the study. */
static const struct dea_result_table *table_of(const struct run *run, const char *name)
{
  const struct dea_result_table *table =
      dea_result_find_table(run->result, "lumped", "transient", name);
  assert_non_null(table);
  return table;
}

static double number(const struct dea_result_table *table, size_t row, const char *key)
{
  return dea_result_table_number(table, row, key, 0);
}

#define PULSES "drive: {waveform: {kind: square, high: 3 kV, frequency: 2 Hz, cycles: 4}}\n"

TEST(test_pulses)
{
  struct run run = run_text(ctx, DESIGN PULSES);
  assert_int_equal(run.status, DEA_OK);
  const struct dea_load_point *p = run.curve->points;
  size_t jumps = 0;
  assert_true(run.curve->complete && p[run.curve->count - 1].time_s == 2);
  for (size_t i = 1; i < run.curve->count; i++) {
    assert_true(p[i].time_s >= p[i - 1].time_s);
    assert_true(p[i].voltage_V == 0 || p[i].voltage_V == 3000);
    if (p[i].voltage_V != p[i - 1].voltage_V) { // exactly at its time, and at once
      assert_true(p[i].time_s == p[i - 1].time_s && p[i].time_s == 0.25 * (double)jumps);
      jumps++;
    } else { // between jumps it creeps on
      assert_true((p[i].voltage_V > 0) == (p[i].electrode_stretch > p[i - 1].electrode_stretch));
    }
  }
  assert_int_equal(jumps, 8);
  const struct dea_result_table *energy = table_of(&run, "energy");
  assert_true(number(energy, 0, "not_accounted") < 1e-3 && number(energy, 0, "dissipated_J") > 0);
  assert_string_equal(dea_result_table_text(table_of(&run, ""), 0, "quantity"),
                      "electrode_edge_u_m");
  const struct dea_result_table *cycles = table_of(&run, "cycles");
  assert_int_equal(cycles->row_count, 4);
  for (size_t i = 0; i < 4; i++) {
    assert_true(number(cycles, i, "level_V") == 3000 &&
                number(cycles, i, "start_s") == 0.5 * (double)i);
    assert_true(number(cycles, i, "rise_time_10_90_s") >= 0 &&
                number(cycles, i, "rise_time_10_90_s") < 0.25);
    assert_true(i == 0 || number(cycles, i, "farthest") > number(cycles, i - 1, "farthest"));
  }
  const struct dea_result_table *creep = table_of(&run, "creep");
  assert_int_equal(creep->row_count, 1);
  assert_true(number(creep, 0, "cycles") == 4 &&
              number(creep, 0, "creep") ==
                  number(cycles, 3, "farthest") - number(cycles, 0, "farthest"));
  for (int moves = 0; moves < 2; moves++) { // the centre of a flat film does so by rounding only
    run.curve->points[1].centre_z_m = moves ? 1e-5 : 1e-20;
    assert_ok(dea_study_transient.tables(ctx, "lumped", run.result));
    assert_string_equal(dea_result_table_text(table_of(&run, ""), 0, "quantity"),
                        moves ? "centre_z_m" : "electrode_edge_u_m");
  }
  end(ctx, &run);
}

/* Voltage after voltage at a frequency whose cycles end at times that numbers round: what jumps at
 * the end of a cycle is none of it. */
TEST(test_stairs)
{
  struct run run = run_text(
      ctx, DESIGN "drive: {waveform: {kind: staircase, values: [0.2 kV, 0.4 kV, 0.6 kV, 0.8 kV,\n"
                  "  1 kV, 1.2 kV, 1.4 kV, 1.6 kV], frequency: 3 Hz, cycles: 1}}\n");
  assert_int_equal(run.status, DEA_OK);
  const struct dea_result_table *cycles = table_of(&run, "cycles");
  assert_int_equal(cycles->row_count, 8);
  assert_int_equal(table_of(&run, "creep")->row_count, 8);
  for (size_t i = 1; i < 8; i++) { // about as the square of the voltage
    double rise = number(cycles, i, "farthest") / number(cycles, i - 1, "farthest");
    double level = number(cycles, i, "level_V") / number(cycles, i - 1, "level_V");
    assert_close(rise, level * level, 0.05, 0);
  }
  end(ctx, &run);
}

TEST(test_interval_end_and_supply)
{
  struct run run = run_text(
      ctx, DESIGN "drive: {waveform: {kind: step, to: 2 kV, duration: 1 s}, slew_limit: 1 kV/s,\n"
                  "        series_resistance: 100 Mohm, current_limit: 20 nA}\n"
                  "compute: {transient: {until: 4 s, interval: 0.5 s, longest_step: 10 ms}}\n");
  assert_int_equal(run.status, DEA_OK);
  const struct dea_load_point *p = run.curve->points;
  assert_in_range(run.curve->count, 9, 12); // every half second and the corner at 2 s
  for (size_t i = 0; i < run.curve->count; i++) {
    assert_close(p[i].source_voltage_V, fmin(1000 * p[i].time_s, 2000), 0, 1e-6);
    assert_true(fabs(p[i].current_A) <= 20e-9 * (1 + 1e-12));
    assert_true(p[i].voltage_V <= p[i].source_voltage_V + 1e-9);
  }
  assert_close(p[run.curve->count - 1].time_s, 4, 0, 0);
  assert_close(p[run.curve->count - 1].voltage_V, 2000, 1e-3, 0);
  end(ctx, &run);
}

/* More voltage than the film stands in the long run: what came before stays, and it is said when it
 * ended; with inertia it goes on. */
TEST(test_pull_in)
{
#define HOLD "drive: {waveform: {kind: constant, voltage: 2.65 kV, duration: 20 s}}\n"
  struct run run = run_text(ctx, DESIGN HOLD "compute: {coverage: 0.01}\n");
  assert_int_equal(run.status, DEA_E_NO_EQUILIBRIUM);
  assert_false(run.curve->complete);
  assert_true(run.curve->count > 10 && run.curve->event_count == 1);
  assert_non_null(strstr(run.curve->stopped, "pull-in at "));
  assert_true(run.curve->events[0].kind == DEA_EVENT_PULL_IN);
  assert_true(run.curve->events[0].point.time_s > 0 && run.curve->events[0].point.time_s < 20);
  end(ctx, &run);
}

TEST(test_interrupt)
{
  volatile sig_atomic_t flag = 1;
  dea_context_set_interrupt(ctx, &flag);
  struct run run = run_text(ctx, DESIGN PULSES);
  dea_context_set_interrupt(ctx, NULL);
  assert_int_equal(run.status, DEA_E_INTERRUPTED);
  assert_true(run.curve->count >= 1 && !run.curve->complete);
  end(ctx, &run);
}

/* Without a waveform the study cannot be asked for; a model without time says so. */
TEST(test_not_for_all)
{
  static const char *const names[] = {"transient"};
  struct run run = run_text(ctx, DESIGN);
  assert_int_equal(run.status, DEA_E_DESIGN);
  assert_non_null(strstr(dea_context_message(ctx), "needs drive.waveform"));
  end(ctx, &run);
  run = run_text(ctx, DESIGN PULSES);
  dea_finding_clear(ctx);
  assert_int_equal(dea_study_run(ctx, dea_model_find("axisymmetric"), names, 1, run.result),
                   DEA_OK);
  assert_int_equal(dea_finding_count(ctx, DEA_NOTE), 1);
  end(ctx, &run);
  run = run_text(ctx, DESIGN PULSES "compute: {transient: {press: yes}}\n"); // how far?
  assert_int_equal(run.status, DEA_E_DESIGN);
  end(ctx, &run);
  dea_finding_clear(ctx);
}

static dea_status run_short(struct dea_context *context)
{
  struct run run =
      run_text(context, DESIGN
               "drive: {waveform: {kind: step, to: 2 kV, duration: 1 s}, slew_limit: 1 MV/s}\n"
               "compute: {transient: {interval: 0.5 s}}\n");
  end(context, &run);
  return run.status;
}

TEST(test_each_allocation)
{
  assert_true(failing_ends(run_short, DEA_OK) > 10);
}

TESTS(context_set_up, context_tear_down)
