/* What the bench makes of a film whose answers are known: a capacitor with a leak that pulls in at
 * 2 kV. Neither design nor model is in it: the interface of the bench is all that it gets. */
#include "instrument/sim_bench.h"
#include "own_folder.h"
#include "protocol/protocol.h"
#include "testing.h"

#include <string.h>

static const double capacitance_F = 1e-10, leakage_s = 0.5, pull_in_V = 2000;
static const double field_per_V = 1e5, breakdown_V_per_m = 1.8e8; // at 1800 V
static const double frame_m = 0.015, tip_m = 0.005;

/* Film and model are one struct each without anything else in it. */
static size_t films, models;

static void destroy(struct dea_context *c, struct dea_bench_film *film)
{
  films--;
  dea_free(c, film);
}

static dea_status read_film(struct dea_context *c, const char *file, const char *text,
                            size_t length, struct dea_bench_film **out);
static dea_status open_model(struct dea_context *c, const struct dea_bench_film *film,
                             const char *name, const char *monitor, struct dea_bench_model **out);

static void close_model(struct dea_context *c, struct dea_bench_model *model)
{
  models -= model != NULL;
  dea_free(c, model);
}

static const char *model_name(size_t index, bool *moves)
{
  *moves = index == 1;
  return index == 0 ? "still" : index == 1 ? "capacitor" : NULL;
}

static dea_status find_pull_in(struct dea_context *c, struct dea_bench_model *model, double *out)
{
  *out = pull_in_V;
  return DEA_OK;
}

static dea_status at_voltage(struct dea_context *c, struct dea_bench_model *model, double voltage_V,
                             struct dea_bench_point *out)
{
  if (fabs(voltage_V) > pull_in_V) {
    return dea_fail(c, DEA_E_NO_EQUILIBRIUM, "pulled in");
  }
  *out = (struct dea_bench_point){.breakdown_V_per_m = breakdown_V_per_m, .leakage_s = leakage_s};
  out->point = dea_load_point_empty();
  out->point.voltage_V = voltage_V;
  out->point.charge_C = capacitance_F * voltage_V;
  out->point.capacitance_F = capacitance_F;
  out->point.true_field_V_per_m = field_per_V * fabs(voltage_V);
  out->point.centre_z_m = 1e-6 * fabs(voltage_V);
  out->point.fibre_tip_z_m = 0.5e-6 * fabs(voltage_V);
  return DEA_OK;
}

static dea_status begin(struct dea_context *c, struct dea_bench_model *model,
                        const struct dea_bench_circuit *circuit, struct dea_bench_point *out)
{
  assert_true(circuit->series_resistance_ohm == 0 && circuit->current_limit_A == 0.01);
  return at_voltage(c, model, 0, out);
}

static dea_status advance(struct dea_context *c, struct dea_bench_model *model, double length_s,
                          double source_V, struct dea_bench_point *out, double *error)
{
  assert_true(length_s > 0);
  *error = 0;
  return at_voltage(c, model, source_V, out);
}

static void accept_state(struct dea_bench_model *model)
{
}

static dea_status no_profile(struct dea_context *c, struct dea_bench_model *model,
                             struct dea_profile *out)
{
  *out = (struct dea_profile){.count = 0};
  return DEA_OK;
}

static const struct dea_bench_film_type capacitor = {
    read_film,  destroy, model_name, open_model,   close_model, find_pull_in,
    at_voltage, begin,   advance,    accept_state, no_profile,
};

static dea_status read_film(struct dea_context *c, const char *file, const char *text,
                            size_t length, struct dea_bench_film **out)
{
  assert_non_null(strstr(file, "film.txt"));
  assert_int_equal(length, strlen("a capacitor"));
  assert_memory_equal(text, "a capacitor", length);
  *out = dea_alloc(c, 1, sizeof **out);
  assert_non_null(*out);
  **out = (struct dea_bench_film){&capacitor};
  films++;
  return DEA_OK;
}

static dea_status open_model(struct dea_context *c, const struct dea_bench_film *film,
                             const char *name, const char *monitor, struct dea_bench_model **out)
{
  assert_ptr_equal(film->type, &capacitor);
  *out = dea_alloc(c, 1, sizeof **out);
  assert_non_null(*out);
  **out =
      (struct dea_bench_model){&capacitor, name != NULL ? name : "still", "air", frame_m, tip_m};
  models++;
  return DEA_OK;
}

static struct dea_protocol *protocol_of(double high_V)
{
  char text[1000];
  struct dea_protocol *protocol = NULL;
  FILE *film = fopen(in_folder("film.txt"), "wb");
  assert_non_null(film);
  assert_true(fputs("a capacitor", film) >= 0);
  fclose(film);
  snprintf(text, sizeof text,
           "dea-protocol: 1\ndesign: film.txt\n"
           "amplifier: {gain: 1000, max_voltage: 10 kV, slew_limit: 5 kV/s, current_limit: 10 mA}\n"
           "rate: 1 kHz\n"
           "waveform: {kind: square, high: %g V, frequency: 1 Hz, cycles: 1}\n",
           high_V);
  dea_finding_clear(ctx);
  assert_int_equal(dea_protocol_read_memory(ctx, &capacitor, in_folder("p.yaml"), text,
                                            strlen(text), NULL, 0, &protocol),
                   DEA_OK);
  return protocol;
}

static bool is_said(const char *text)
{
  size_t count;
  bool said = false;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    said = said || strstr(findings[i].text, text) != NULL;
  }
  return said;
}

/* 1.8e8 V/m over a margin of 1.2 are 1500 V. */
TEST(test_check)
{
  static const struct {
    double high_V;
    dea_status status;
    const char *said;
  } cases[] = {
      {1499, DEA_OK, "the largest jump"},
      {1510, DEA_E_INTERLOCK, "which is 1.50 kV"},
      {2100, DEA_E_INTERLOCK, "the film pulls in at 2 kV"},
  };
  for (size_t i = 0; i < 3; i++) {
    struct dea_protocol_plan plan;
    struct dea_protocol *p = protocol_of(cases[i].high_V);
    assert_int_equal(dea_protocol_check(ctx, p, &plan), cases[i].status);
    assert_true(is_said(cases[i].said));
    assert_close(plan.pull_in_V, pull_in_V, 0, 0);
    if (cases[i].high_V < pull_in_V) {
      assert_close(plan.largest_field_V_per_m, field_per_V * cases[i].high_V, 1e-12, 0);
      assert_close(plan.allowed_field_V_per_m, breakdown_V_per_m / 1.2, 1e-12, 0);
      assert_close(plan.stored_energy_J, 0.5 * capacitance_F * pow(cases[i].high_V, 2), 1e-12, 0);
    }
    dea_protocol_destroy(ctx, p);
    dea_context_clear(ctx);
    assert_int_equal(films, 0);
    assert_int_equal(models, 0);
  }
}

/* The amplifier climbs by 5 V a sample: C dV/dt and what leaks meanwhile, Q/tau. */
TEST(test_bench)
{
  const struct dea_sim_settings settings = {.model = "capacitor",
                                            .breakdown_V = (double)NAN,
                                            .breakdown_s = (double)NAN,
                                            .fatigue_s = (double)NAN};
  struct dea_sim_bench *bench;
  struct dea_sim_state s;
  struct dea_protocol *p = protocol_of(1000);
  assert_int_equal(dea_sim_bench_create(ctx, p, &settings, &bench), DEA_OK);
  for (size_t i = 0; i < 300; i++) {
    assert_int_equal(dea_sim_bench_sample(bench, 1, &s), DEA_OK); // 1 V of control voltage
    double volts = fmin(5 * (double)i, 1000);
    double climb_V = i > 0 && i <= 200 ? 5 : 0, mean_V = i > 0 ? volts - climb_V / 2 : 0;
    double current_A = capacitance_F * (climb_V / 1e-3 + mean_V / leakage_s);
    assert_close(s.film_V, volts, 1e-9, 1e-9);
    assert_close(s.current_A, current_A, 1e-9, 1e-18);
    assert_false(s.broken);
  }
  // no profile: a cone of 0 mm at the frame, 0.5 mm at the tips, 1 mm in the centre
  static const double radius_mm[] = {0, 2.5, 5, 10, 15, 20},
                      height_mm[] = {1, 0.75, 0.5, 0.25, 0, 0};
  for (size_t i = 0; i < 6; i++) {
    assert_close(dea_sim_bench_height(bench, 1e-3 * radius_mm[i]), 1e-3 * height_mm[i], 0, 1e-12);
  }
  dea_sim_bench_destroy(ctx, bench);
  dea_protocol_destroy(ctx, p);
  assert_int_equal(films + models, 0);
}

/* Beyond pull-in it breaks down, and is a short circuit from then on. */
TEST(test_breakdown)
{
  const struct dea_sim_settings settings = {.model = "capacitor",
                                            .breakdown_V = (double)NAN,
                                            .breakdown_s = (double)NAN,
                                            .fatigue_s = (double)NAN};
  struct dea_sim_bench *bench;
  struct dea_sim_state s;
  struct dea_protocol *p = protocol_of(3000);
  assert_int_equal(dea_sim_bench_create(ctx, p, &settings, &bench), DEA_OK);
  for (size_t i = 0; i < 600; i++) {
    assert_int_equal(dea_sim_bench_sample(bench, 3, &s), DEA_OK);
    assert_true(s.broken == (5 * (double)i > pull_in_V));
  }
  assert_close(s.current_A, 0.01, 1e-12, 0); // its limit: 0.3 A would flow through 10 kohm
  dea_sim_bench_destroy(ctx, bench);
  dea_protocol_destroy(ctx, p);
}

TESTS(set_up, tear_down)
