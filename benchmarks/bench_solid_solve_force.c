/* Study "force" of the actuator with four fibres in model 3d, voltages in steps of 0.1 kV.
 * Factorisations are the solver's own count.
 *
 *   bench_solid_solve_force [DEPTHS [HIGHEST]]
 *
 * Default: "[0 mm, 0.5 mm, 1 mm, 2 mm]" "8 kV". */
#include "design/design.h"
#include "model/model.h"
#include "study/design_file.h"
#include "study/study.h"
#include "timing.h"

int main(int argc, char **argv)
{
  const struct dea_override sets[] = {
      {"compute.force.depth", argc > 1 ? argv[1] : "[0 mm, 0.5 mm, 1 mm, 2 mm]"},
      {"compute.voltage.to", argc > 2 ? argv[2] : "8 kV"}};
  static const char *const name = "force";
  struct dea_context *ctx = NULL;
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *result;
  const struct dea_model_type *type = dea_model_find("3d");
  if (dea_context_create(NULL, &ctx) != DEA_OK) {
    return 1;
  }
  bench_need(dea_design_read(ctx, DEA_SOURCE_DIR "/examples/frdea-4.yaml", sets, 2, &design), ctx);
  bench_need(dea_device_build(ctx, design, &device), ctx);
  bench_need(dea_result_create(ctx, design, device, &result), ctx);
  double start = bench_processor_s(), by_clock = bench_now_s();
  bench_need(dea_study_run(ctx, type, &name, 1, result), ctx);
  double time = bench_processor_s() - start,
         count = (double)dea_context_counters(ctx)->factorisations;
  by_clock = bench_now_s() - by_clock;
  const struct dea_curve *curve = dea_result_find(result, "3d", name);
  bench_print("force.time", time, "s");
  bench_print("force.clock", by_clock, "s");
  bench_print("force.points", (double)curve->count, "1");
  bench_print("force.factorisations", count, "1");
  bench_print("force.factorisations_each", count / (double)curve->count, "1");
  dea_result_destroy(ctx, result);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  dea_context_destroy(ctx);
  return 0;
}
