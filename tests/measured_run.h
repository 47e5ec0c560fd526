/* A run whose answers are known, and a folder as of dea reduce beside it. */
#pragma once

#include "command.h"
#include "fake_result.h"
#include "job/run_folder.h"

static const double film_m = 15e-3;

// A run whose answers are known -------------------------------------------------------------------

/* lumped: z = 100 um a kV, force 2 mN a kV; 3d: z = 10 um a kV^2; axisymmetric: no z. */
static inline dea_status add_sweeps(struct dea_context *ctx, struct dea_result *result)
{
  static const char *const models[] = {"lumped", "3d", "axisymmetric"};
  for (int m = 0; m < 3; m++) {
    struct dea_curve *curve;
    DEA_TRY(ctx, dea_result_add_curve(ctx, result, models[m], "sweep", &curve));
    for (int k = 0; k <= 6; k++) {
      struct dea_load_point p = dea_load_point_empty();
      p.voltage_V = 1e3 * k;
      p.electrode_stretch = 1.0 + 0.01 * k;
      if (m < 2) {
        p.centre_z_m = m == 0 ? 100e-6 * k : 10e-6 * k * k;
      }
      if (m == 0) {
        p.force_N = 2e-3 * k;
      }
      DEA_TRY(ctx, dea_curve_add_point(ctx, curve, &p));
    }
  }
  return DEA_OK;
}

/* Height of the model 3d at a place: along a fibre a straight cone of 10 um a kV, between two of
 * them its square. */
static inline double cone_m(double voltage_V, double radius_m)
{
  double share = 1.0 - fabs(radius_m) / film_m;
  return 10e-9 * voltage_V * (radius_m < 0 ? share * share : share);
}

/* Profiles of model 3d at 0, 2, 4, 6 kV, every millimetre. */
static inline dea_status add_profiles(struct dea_context *ctx, struct dea_result *result)
{
  enum { COUNT = 31 };
  double columns[7][COUNT] = {{0}};
  for (int k = 0; k <= 6; k += 2) {
    for (int i = 0; i < COUNT; i++) {
      columns[0][i] = 1e-3 * (i - 15);
      columns[6][i] = cone_m(1e3 * k, columns[0][i]);
    }
    struct dea_profile profile = {COUNT,      columns[0], columns[1], columns[2],
                                  columns[3], columns[4], columns[5], columns[6]};
    DEA_TRY(ctx, dea_result_add_profile(ctx, result, "3d", 1e3 * k, &profile));
  }
  return DEA_OK;
}

/* Two pulses of 6 kV, 1 s each, in the first second of 2 s; z = 600 um a pulse, with ramps of 0.1 s
 * that begin with the pulse and its end. */
static inline double pulse(double time_s, double high, double ramp_s)
{
  double t = fmod(time_s, 2.0);
  return high * fmax(0.0, t < 1.0 ? fmin(1.0, t / ramp_s) : 1.0 - (t - 1.0) / ramp_s);
}

/* A hub beside it has half of that height. */
static inline dea_status add_history(struct dea_context *ctx, struct dea_result *result)
{
  static const struct dea_column hub_z = {"hub_z_m", "m", "um", 1e6, "hub z", "of the hub"};
  struct dea_curve *curve;
  struct dea_arena memory = {.ctx = ctx};
  int column;
  DEA_TRY(ctx, dea_column_add(ctx, &hub_z, &column));
  DEA_TRY(ctx, dea_result_add_curve(ctx, result, "lumped", "transient", &curve));
  struct dea_monitor_values *hub = dea_monitor_values_create(&memory, &column, 1);
  DEA_TRY(ctx, dea_arena_status(&memory));
  for (int i = 0; i < 400; i++) {
    struct dea_load_point p = dea_load_point_empty();
    p.time_s = 0.01 * i;
    p.voltage_V = p.source_voltage_V = pulse(p.time_s, 6000.0, 0.02);
    p.centre_z_m = pulse(p.time_s, 600e-6, 0.1);
    p.monitors = hub;
    dea_point_set(&p, column, 0.5 * p.centre_z_m);
    const dea_status status = dea_curve_add_point(ctx, curve, &p);
    if (status != DEA_OK) {
      dea_arena_free(&memory);
      return status;
    }
  }
  dea_arena_free(&memory);
  return DEA_OK;
}

static inline dea_status known_result(struct dea_context *ctx, const struct dea_design *design,
                                      struct dea_result **out)
{
  static const char input[] = "title: fake\n";
  DEA_TRY(ctx, dea_result_create(ctx, design, NULL, out));
  DEA_TRY(ctx, dea_provenance_fill(ctx, input, sizeof input - 1, NULL, 0, "dea run fake.yaml",
                                   &(*out)->provenance));
  DEA_TRY(ctx, add_sweeps(ctx, *out));
  DEA_TRY(ctx, add_profiles(ctx, *out));
  return add_history(ctx, *out);
}

static inline void make_run(const char *name)
{
  struct dea_context *ctx;
  struct dea_design design = fake_design();
  struct dea_result *result = NULL;
  const struct dea_run_folder_options options = {.no_figures = true};
  char path[600];
  snprintf(path, sizeof path, "%s/%s", command_folder, name);
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  assert_int_equal(known_result(ctx, &design, &result), DEA_OK);
  assert_int_equal(dea_run_folder_write(ctx, result, path, &options), DEA_OK);
  dea_result_destroy(ctx, result);
  dea_context_destroy(ctx);
}

// What was measured -------------------------------------------------------------------------------

/* lumped minus this: 10, -20, 30 um of 11 um each; 3d minus this: -150, -260, -210 um. */
static const char points[] = "# made up\nV (kV),z centre (um),z centre std (um),force (mN)\n"
                             "2,190,11,4\n4,420,11,8\n6,570,11,12\n";

static inline FILE *open_table(const char *name)
{
  char path[600];
  snprintf(path, sizeof path, "%s/%s", command_folder, name);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  return file;
}

/* At 5 kV, which was not computed: what 3d has along a fibre, less 2 um, of 4 um; beyond the film
 * the frame, which is left out, as is a place without a valid point. */
static inline void write_profiles(const char *name)
{
  FILE *file = open_table(name);
  fputs("V (kV),x (mm),z (um),z std (um)\n", file);
  for (int x = -17; x <= 17; x++) {
    if (x == 3) {
      fprintf(file, "5,%d,,\n", x);
    } else {
      fprintf(file, "5,%d,%.9g,4\n", x,
              abs(x) > 15 ? 900.0 : 1e6 * cone_m(5000.0, abs(x) * 1e-3) - 2.0);
    }
  }
  fclose(file);
}

/* What the run's history is, 3.25 s later, higher by 6 um. */
static inline void write_history(const char *name, bool has_voltage)
{
  FILE *file = open_table(name);
  fprintf(file, "time (s)%s,z centre (um)\n", has_voltage ? ",V (kV)" : "");
  for (int i = 0; i < 800; i++) {
    double t = 0.01 * i, own = t - 3.25, z = 6.0;
    bool inside = own > 0 && own < 3.99;
    fprintf(file, "%.4f", t);
    if (has_voltage) {
      fprintf(file, ",%.9g", inside ? 1e-3 * pulse(own, 6000.0, 0.02) : 0.0);
    }
    fprintf(file, ",%.9g\n", z + (inside ? 1e6 * pulse(own, 600e-6, 0.1) : 0.0));
  }
  fclose(file);
}

static inline int compare_set_up(void **state)
{
  if (command_set_up(state) != 0) {
    return -1;
  }
  make_run("run");
  make_run("run2");
  command_folder_make("red");
  command_write("red/measurement.csv", points);
  write_profiles("red/profiles.csv");
  write_history("red/history.csv", true);
  return 0;
}
