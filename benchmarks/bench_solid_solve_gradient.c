/* What gradients of model 3d cost beside a load step of 1 kV (docs/theory/gradients.md): what all
 * of them share, each quantity, and each number of the design; the same of the lowest frequency,
 * with the search for its mode, and of the capacitance. The paper's actuator with four fibres, a
 * sector, whose lowest mode is single, with the field V/h and with a coupled one. Times are the
 * processor's: other work on the machine counts less. */
#include "model/model.h"
#include "result/columns.h"
#include "study/design_file.h"
#include "study/design_gradient.h"
#include "timing.h"

#include <math.h>

enum { QUANTITIES = 6, KV = 4 };

static int repeats = 5;

extern const struct dea_model_type dea_solid_module;

static const char *const keys[QUANTITIES] = {"centre_z_m",          "fibre_tip_z_m",
                                             "electrode_edge_u_m",  "true_field_V_per_m",
                                             "min_tension_N_per_m", "energy_J"};

/* Processor time of a gradient of the first quantities by the first numbers; the shortest. */
static double time_of(struct dea_context *ctx, struct dea_design_gradient *ask, size_t numbers,
                      size_t quantities)
{
  static double slopes[DEA_NUMBERS_MAX * QUANTITIES];
  double best = INFINITY;
  ask->number_count = numbers;
  ask->of.column_count = quantities;
  for (int i = 0; i < repeats; i++) {
    double start = bench_processor_s();
    bench_need(dea_design_gradient_find(ctx, ask, slopes), ctx);
    best = fmin(best, bench_processor_s() - start);
  }
  return best;
}

/* Processor time of the last load step of a sweep; the shortest. *model: at its end. */
static double step_of(struct dea_context *ctx, const struct dea_device *device,
                      const struct dea_model_settings *settings, struct dea_model **model)
{
  double best = INFINITY;
  *model = NULL;
  for (int i = 0; i < repeats; i++) {
    struct dea_load_point point;
    double start = 0;
    dea_solid_module.destroy(ctx, *model);
    bench_need(dea_solid_module.create(ctx, device, settings, model), ctx);
    for (int kV = 1; kV <= KV; kV++) {
      start = bench_processor_s();
      bench_need(dea_solid_module.solve(ctx, *model, 1e3 * kV, &point), ctx);
    }
    best = fmin(best, bench_processor_s() - start);
  }
  return best;
}

/* That of one quantity by the first numbers: of the frequency with its mode and factor. */
static double time_of_one(struct dea_context *ctx, struct dea_design_gradient *ask, const char *key,
                          size_t numbers)
{
  const int column = dea_point_column_find(key), *columns = ask->of.columns;
  ask->of.columns = &column;
  const double out = time_of(ctx, ask, numbers, 1);
  ask->of.columns = columns;
  return out;
}

/* of: what the figures are named after. */
static void measure(struct dea_context *ctx, const struct dea_design *design,
                    const struct dea_device *device, const char *of,
                    const struct dea_model_settings *settings)
{
  struct dea_design_number numbers[DEA_NUMBERS_MAX];
  size_t count;
  int columns[QUANTITIES];
  struct dea_model *model;
  double step = step_of(ctx, device, settings, &model);
  bench_need(dea_design_numbers(ctx, design, device, 1e3 * KV, false, numbers, &count), ctx);
  for (int i = 0; i < QUANTITIES; i++) {
    columns[i] = dea_point_column_find(keys[i]);
  }
  struct dea_design_gradient ask = {.type = &dea_solid_module,
                                    .model = model,
                                    .design = design,
                                    .device = device,
                                    .voltage_V = 1e3 * KV,
                                    .numbers = numbers,
                                    .of.columns = columns};
  double shared = time_of(ctx, &ask, 0, 0), all = time_of(ctx, &ask, 0, QUANTITIES),
         whole = time_of(ctx, &ask, count, QUANTITIES),
         mode = time_of_one(ctx, &ask, "frequency_Hz", 0),
         by_all = time_of_one(ctx, &ask, "frequency_Hz", count),
         charge = time_of_one(ctx, &ask, "capacitance_F", 0),
         charge_by_all = time_of_one(ctx, &ask, "capacitance_F", count);
  const struct {
    const char *what;
    double value;
    const char *unit;
  } figures[] = {
      {"load_step", step, "s"},
      {"shared_over_step", shared / step, "1"},
      {"quantity_over_step", (all - shared) / QUANTITIES / step, "1"},
      {"number_over_step", (whole - all) / (double)count / step, "1"},
      {"numbers", (double)count, "1"},
      {"all_over_step", whole / step, "1"},
      {"frequency_over_step", mode / step, "1"},
      {"frequency_number_over_step", (by_all - mode) / (double)count / step, "1"},
      {"capacitance_over_step", (charge - shared) / step, "1"},
      {"capacitance_number_over_step", (charge_by_all - charge) / (double)count / step, "1"}};
  for (size_t i = 0; i < sizeof figures / sizeof figures[0]; i++) {
    char name[80];
    snprintf(name, sizeof name, "solid_solve_gradient.%s.%s", of, figures[i].what);
    bench_print(name, figures[i].value, figures[i].unit);
  }
  dea_solid_module.destroy(ctx, model);
}

int main(void)
{
  struct dea_context *ctx = NULL;
  struct dea_design *design;
  struct dea_device *device;
  const struct dea_override overlap = {"fibres.overlap", "0.5 mm stretched"};
  if (dea_context_create(NULL, &ctx) != DEA_OK) {
    return 1;
  }
  bench_need(dea_design_read(ctx, DEA_SOURCE_DIR "/examples/frdea-4.yaml", &overlap, 1, &design),
             ctx);
  bench_need(dea_device_build(ctx, design, &device), ctx);
  struct dea_model_settings settings = dea_model_settings_of(design);
  for (int refinement = 1; refinement <= 2; refinement++) {
    settings.refinement = refinement;
    measure(ctx, design, device, refinement == 1 ? "refinement_1" : "refinement_2", &settings);
  }
  settings.refinement = 1;
  settings.field = DEA_FIELD_COUPLED;
  settings.elements_z = 2;
  measure(ctx, design, device, "coupled_2", &settings);
  settings.elements_z = 6; // half a minute to 4 kV
  repeats = 1;
  measure(ctx, design, device, "coupled_6", &settings);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  dea_context_destroy(ctx);
  return 0;
}
