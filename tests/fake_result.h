/* A result with plausible numbers that no model computed: for tests of the writers. */
#pragma once

#include "result/provenance.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>

static inline struct dea_design fake_design(void)
{
  struct dea_design design = {.file = "fake.yaml"};
  snprintf(design.title.text, sizeof design.title.text,
           "A made-up actuator, \302\265 and \"quotes\"");
  design.report.svg = true;
  design.report.width_m = (struct dea_quantity){.si = 0.085};
  return design;
}

/* s: electrode stretch. Voltage of a film that pulls in; scale makes models differ. */
static inline struct dea_load_point fake_point(double s, double scale, bool lumped)
{
  struct dea_load_point p = dea_load_point_empty();
  p.electrode_stretch = s;
  p.voltage_V = scale * 14500.0 * sqrt(fmax(0.0, s - 1.0)) / pow(s, 2.0);
  p.true_field_V_per_m = p.voltage_V / 44e-6 * s * s;
  p.nominal_field_V_per_m = p.voltage_V / 100e-6;
  p.breakdown_margin = 1.0 - p.true_field_V_per_m / (190e6 * pow(s, 1.1));
  p.min_tension_N_per_m = 35.0 - 35.0 * pow(p.voltage_V / 6500.0, 2.0);
  p.pull_in_distance_V = 7000.0 - p.voltage_V;
  p.energy_J = -1e-6 * (s - 1.0);
  if (lumped) {
    p.passive_stretch = 1.0 - 0.1 * (s - 1.0);
    p.centre_z_m = 12e-3 * sqrt(fmax(0.0, s - 1.0));
    p.fibre_tip_z_m = 11e-3 * sqrt(fmax(0.0, s - 1.0));
    p.force_N = 0.02 * (s - 1.0);
    p.own_flags = 1u << DEA_FLAG_BOUND;
  }
  p.stable = s < 4.0 / 3.0;
  p.unstable_modes = p.stable ? 0 : 1;
  return p;
}

static inline dea_status fake_add_profiles(struct dea_context *ctx, struct dea_result *result,
                                           const char *model)
{
  enum { COUNT = 31 };
  double column[7][COUNT];
  for (int k = 0; k < 6; k++) {
    double v = 1000.0 * k;
    for (int i = 0; i < COUNT; i++) {
      double r = 15e-3 * i / (COUNT - 1), edge = r < 5e-3 ? 1.0 : 5e-3 / fmax(r, 1e-9);
      column[0][i] = r;
      column[1][i] = 1e-9 * v * v * r * edge;
      column[2][i] = 1.5 * (1.0 + (r < 5e-3 ? 4e-9 : -2e-9) * v * v * edge);
      column[3][i] = 1.5 * (1.0 + 4e-9 * v * v * edge);
      column[4][i] = 35.0 - (r < 5e-3 ? 0.6e-6 : 0.2e-6) * v * v;
      column[5][i] = 35.0 - 0.5e-6 * v * v * edge;
      column[6][i] = 0;
    }
    struct dea_profile profile = {COUNT,     column[0], column[1], column[2],
                                  column[3], column[4], column[5], column[6]};
    DEA_TRY(ctx, dea_result_add_profile(ctx, result, model, v, &profile));
  }
  return DEA_OK;
}

static inline dea_status fake_add_model(struct dea_context *ctx, struct dea_result *result,
                                        const char *model, double scale, bool lumped)
{
  struct dea_curve *curve;
  DEA_TRY(ctx, dea_result_add_curve(ctx, result, model, "sweep", &curve));
  for (int i = 0; i <= 40; i++) {
    struct dea_load_point point = fake_point(1.0 + 0.0064 * i * i / 40.0, scale, lumped);
    DEA_TRY(ctx, dea_curve_add_point(ctx, curve, &point));
  }
  DEA_TRY(ctx, dea_result_add_curve(ctx, result, model, "path", &curve));
  for (int i = 0; i <= 100; i++) {
    struct dea_load_point point = fake_point(1.0 + 0.00007 * i * i, scale, lumped);
    DEA_TRY(ctx, dea_curve_add_point(ctx, curve, &point));
  }
  struct dea_event slack = {DEA_EVENT_SLACK, fake_point(1.22, scale, lumped)};
  struct dea_event pull_in = {DEA_EVENT_PULL_IN, fake_point(4.0 / 3.0, scale, lumped)};
  struct dea_event breakdown = {DEA_EVENT_BREAKDOWN, fake_point(1.45, scale, lumped)};
  DEA_TRY(ctx, dea_curve_add_event(ctx, curve, &slack));
  DEA_TRY(ctx, dea_curve_add_event(ctx, curve, &pull_in));
  return dea_curve_add_event(ctx, curve, &breakdown);
}

/* design is lent. scale: of the voltages. On failure *out may be half made and is to be destroyed.
 */
static inline dea_status fake_result(struct dea_context *ctx, const struct dea_design *design,
                                     double scale, struct dea_result **out)
{
  static const char input[] = "title: fake\nfilm: {thickness: 100 um}\n";
  const struct dea_override override = {"film.thickness", "50 um"};
  DEA_TRY(ctx, dea_result_create(ctx, design, NULL, out));
  DEA_TRY(ctx, dea_provenance_fill(ctx, input, sizeof input - 1, &override, 1, "dea run fake.yaml",
                                   &(*out)->provenance));
  DEA_TRY(ctx, fake_add_model(ctx, *out, "lumped", scale, true));
  DEA_TRY(ctx, fake_add_model(ctx, *out, "axisymmetric", 1.09 * scale, false));
  return fake_add_profiles(ctx, *out, "axisymmetric");
}
