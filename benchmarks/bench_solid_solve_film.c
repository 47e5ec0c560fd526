/* The paper's actuator with four fibres, as built, in steps of 1 kV: what a membrane film saves
 * against a solid one on the same, the default mesh of the plane. Model made and sweep to 6 kV, and
 * on to 8 kV, where the film wrinkles. Times are the processor's: other work on the machine counts
 * less. */
#include "model/model.h"
#include "study/design_file.h"
#include "timing.h"

#include <math.h>

enum { TO_6_KV, TO_8_KV, SPANS, REPEATS = 3 };

extern const struct dea_model_type dea_solid_module;

/* Times of one sweep, kept where they are shorter. */
static void sweep(struct dea_context *ctx, const struct dea_device *device,
                  const struct dea_model_settings *settings, double times[SPANS])
{
  struct dea_model *model;
  struct dea_load_point point;
  double start = bench_processor_s();
  bench_need(dea_solid_module.create(ctx, device, settings, &model), ctx);
  for (int kV = 1; kV <= 8; kV++) {
    bench_need(dea_solid_module.solve(ctx, model, 1e3 * kV, &point), ctx);
    if (kV == 6 || kV == 8) {
      int span = kV == 6 ? TO_6_KV : TO_8_KV;
      times[span] = fmin(times[span], bench_processor_s() - start);
    }
  }
  dea_solid_module.destroy(ctx, model);
}

int main(void)
{
  struct dea_context *ctx = NULL;
  struct dea_design *design;
  struct dea_device *device;
  if (dea_context_create(NULL, &ctx) != DEA_OK) {
    return 1;
  }
  bench_need(dea_design_read(ctx, DEA_SOURCE_DIR "/examples/frdea-4.yaml", NULL, 0, &design), ctx);
  bench_need(dea_device_build(ctx, design, &device), ctx);
  double times[2][SPANS] = {{INFINITY, INFINITY}, {INFINITY, INFINITY}};
  for (int i = 0; i < 2 * REPEATS; i++) { // in turns, so that other work disturbs both
    struct dea_model_settings settings = dea_model_settings_of(design);
    settings.film = i % 2 == 0 ? DEA_FILM_SOLID : DEA_FILM_MEMBRANE;
    sweep(ctx, device, &settings, times[i % 2]);
  }
  for (int span = 0; span < SPANS; span++) {
    static const char *const films[] = {"solid", "membrane"};
    char name[80];
    for (int film = 0; film < 2; film++) {
      snprintf(name, sizeof name, "solid_solve_film.to_%d_kV.%s", span == TO_6_KV ? 6 : 8,
               films[film]);
      bench_print(name, times[film][span], "s");
    }
    snprintf(name, sizeof name, "solid_solve_film.to_%d_kV.membrane_over_solid",
             span == TO_6_KV ? 6 : 8);
    bench_print(name, times[1][span] / times[0][span], "1");
  }
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  dea_context_destroy(ctx);
  return 0;
}
