/* The user's main job: the as-built actuator with four fibres in model 3d, 0 to 8 kV in steps of
 * 0.5 kV on the symmetric sector; the default mesh, a preview with a membrane film, and meshes that
 * are finer, with what each is off from the finest below 7 kV. Before each, 0 to 6 kV in steps of
 * 1 kV.
 *
 *   bench_solid_solve_actuator [REFINEMENT...]     default: 1 1.5 2; the others are held to the
 * last
 */
#include "design/design.h"
#include "model/model.h"
#include "study/design_file.h"
#include "timing.h"

#include <math.h>

enum { POINTS = 17, MESHES_MAX = 8, COMPARED = 13 }; // compared: up to 6.5 kV

struct sweep {
  double time_s, factorisations, tip_m[POINTS], edge_m[POINTS];
};

static double factorisations(struct dea_context *ctx)
{
  return (double)dea_context_counters(ctx)->factorisations;
}

static struct sweep run(struct dea_context *ctx, const char *refinement, const char *film,
                        double step_V, int points)
{
  const struct dea_override sets[] = {{"compute.solid.refinement", refinement},
                                      {"compute.solid.film", film}};
  struct dea_design *design;
  struct dea_device *device;
  struct dea_model *model;
  struct dea_load_point point;
  struct sweep sweep;
  const struct dea_model_type *type = dea_model_find("3d");
  bench_need(dea_design_read(ctx, DEA_SOURCE_DIR "/examples/frdea-4.yaml", sets, 2, &design), ctx);
  bench_need(dea_device_build(ctx, design, &device), ctx);
  double start = bench_processor_s(), before = factorisations(ctx);
  bench_need(dea_model_create(ctx, type, design, device, &model), ctx);
  for (int i = 0; i < points; i++) {
    bench_need(type->solve(ctx, model, step_V * i, &point), ctx);
    sweep.tip_m[i] = point.fibre_tip_z_m;
    sweep.edge_m[i] = point.electrode_edge_u_m;
  }
  sweep.time_s = bench_processor_s() - start;
  sweep.factorisations = factorisations(ctx) - before;
  type->destroy(ctx, model);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  return sweep;
}

static double off(const double *value, const double *finest)
{
  double most = 0;
  for (int i = 1; i <= COMPARED; i++) {
    most = fmax(most, fabs(value[i] / finest[i] - 1));
  }
  return most;
}

static void print(const char *name, const char *what, double value, const char *unit)
{
  char text[80];
  snprintf(text, sizeof text, "actuator.%s.%s", name, what);
  bench_print(text, value, unit);
}

int main(int argc, char **argv)
{
  char *defaults[] = {argv[0], "1", "1.5", "2"};
  char **refinements = argc > 1 ? argv + 1 : defaults + 1;
  int count = argc > 1 ? argc - 1 : (int)(sizeof defaults / sizeof *defaults) - 1;
  struct dea_context *ctx = NULL;
  struct sweep sweeps[MESHES_MAX], taut[MESHES_MAX], membrane;
  if (count > MESHES_MAX || dea_context_create(NULL, &ctx) != DEA_OK) {
    return 1;
  }
  run(ctx, "1", "solid", 1000, 2); // what is made once
  membrane = run(ctx, "1", "membrane", 500, POINTS);
  for (int i = 0; i < count; i++) {
    taut[i] = run(ctx, refinements[i], "solid", 1000, 7);
    sweeps[i] = run(ctx, refinements[i], "solid", 500, POINTS);
  }
  const struct sweep *finest = &sweeps[count - 1];
  for (int i = -1; i < count; i++) {
    const struct sweep *sweep = i < 0 ? &membrane : &sweeps[i];
    char name[40];
    snprintf(name, sizeof name, i < 0 ? "membrane" : "refinement_%s", i < 0 ? "" : refinements[i]);
    print(name, "sweep", sweep->time_s, "s");
    print(name, "factorisations", sweep->factorisations, "1");
    if (i >= 0) {
      print(name, "to_6_kV", taut[i].time_s, "s");
      print(name, "to_6_kV_factorisations", taut[i].factorisations, "1");
    }
    print(name, "sweep_over_default", sweep->time_s / sweeps[0].time_s, "1");
    if (i < count - 1) {
      print(name, "fibre_tip_off", 100 * off(sweep->tip_m, finest->tip_m), "%");
      print(name, "electrode_edge_off", 100 * off(sweep->edge_m, finest->edge_m), "%");
    }
  }
  dea_context_destroy(ctx);
  return 0;
}
