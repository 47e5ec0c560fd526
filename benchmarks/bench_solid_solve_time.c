/* The paper's actuator with four fibres, as built, to 6 kV in steps of 0.5 kV: what a step in time
 * costs beside an equilibrium, elastic, with branches, with inertia. Times are the processor's. */
#include "model/model.h"
#include "study/design_file.h"
#include "timing.h"

#include <math.h>

enum { EQUILIBRIUM, ELASTIC, BRANCHES, INERTIA, KINDS, REPEATS = 2, STEPS = 12 };

extern const struct dea_model_type dea_solid_module;

/* Seconds of the sweep itself. */
static double sweep(struct dea_context *ctx, struct dea_device *device, int kind, size_t branches)
{
  const struct dea_model_type *type = &dea_solid_module;
  const struct dea_time_options options = {
      .circuit = {.current_limit_A = INFINITY}, .inertia = kind == INERTIA, .rho_inf = 0.8};
  struct dea_model *model;
  struct dea_load_point point;
  device->film.branch_count = kind == BRANCHES ? branches : 0;
  bench_need(type->create(ctx, device, NULL, &model), ctx);
  double start = bench_processor_s(), error;
  if (kind != EQUILIBRIUM) {
    bench_need(type->begin(ctx, model, &options, &point), ctx);
  }
  for (int i = 1; i <= STEPS; i++) {
    const struct dea_time_step step = {.length_s = 0.01, .source_voltage_V = 6e3 * i / STEPS};
    if (kind == EQUILIBRIUM) {
      bench_need(type->solve(ctx, model, step.source_voltage_V, &point), ctx);
    } else {
      bench_need(type->advance(ctx, model, &step, &point, &error), ctx);
      type->accept(model);
    }
  }
  double seconds = bench_processor_s() - start;
  type->destroy(ctx, model);
  return seconds;
}

int main(void)
{
  static const char *const names[KINDS] = {"equilibrium", "elastic", "branches", "inertia"};
  struct dea_context *ctx = NULL;
  struct dea_design *design;
  struct dea_device *device;
  double times[KINDS];
  if (dea_context_create(NULL, &ctx) != DEA_OK) {
    return 1;
  }
  bench_need(dea_design_read(ctx, DEA_SOURCE_DIR "/examples/frdea-4.yaml", NULL, 0, &design), ctx);
  bench_need(dea_device_build(ctx, design, &device), ctx);
  size_t branches = device->film.branch_count;
  for (int kind = 0; kind < KINDS; kind++) {
    times[kind] = INFINITY;
  }
  for (int i = 0; i < KINDS * REPEATS; i++) { // in turns, so that other work disturbs all
    times[i % KINDS] = fmin(times[i % KINDS], sweep(ctx, device, i % KINDS, branches));
  }
  for (int kind = 0; kind < KINDS; kind++) {
    char name[80];
    snprintf(name, sizeof name, "solid_solve_time.step.%s", names[kind]);
    bench_print(name, times[kind] / STEPS, "s");
    snprintf(name, sizeof name, "solid_solve_time.%s_over_equilibrium", names[kind]);
    if (kind != EQUILIBRIUM) {
      bench_print(name, times[kind] / times[EQUILIBRIUM], "1");
    }
  }
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  dea_context_destroy(ctx);
  return 0;
}
