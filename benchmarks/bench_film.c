/* An 80-point sweep and the whole path of the disc of benchmark 4 by the models of a film. */
#include "../tests/devices.h"
#include "model/model.h"
#include "timing.h"

#include <math.h>
#include <stdlib.h>

static struct dea_context *ctx;
static const struct dea_model_type *type;

static dea_status ignore(void *user, const struct dea_load_point *point)
{
  (void)user;
  (void)point;
  return DEA_OK;
}

static struct dea_model *make(const struct dea_device *device)
{
  struct dea_model *model;
  if (type->create(ctx, device, NULL, &model) != DEA_OK) {
    abort();
  }
  return model;
}

static void sweep(void *user)
{
  struct dea_model *model = make(user);
  for (int i = 0; i < 80; i++) {
    struct dea_load_point p;
    if (type->solve(ctx, model, 100.0 * i, &p) != DEA_OK) {
      abort();
    }
  }
  type->destroy(ctx, model);
}

static void path(void *user)
{
  struct dea_model *model = make(user);
  const struct dea_path_options options = {
      .max_stretch = 3, .max_voltage_V = INFINITY, .max_points = 1000};
  if (type->path(ctx, model, &options, ignore, NULL, NULL) != DEA_OK) {
    abort();
  }
  type->destroy(ctx, model);
}

int main(void)
{
  if (dea_context_create(NULL, &ctx) != DEA_OK) {
    return 1;
  }
  struct dea_device device = test_disc(test_yeoh(), 1.5, 3.75e-3, 0.25, 0);
  static const char *const names[] = {"lumped", "axisymmetric"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    char figure[64];
    type = dea_model_find(names[i]);
    snprintf(figure, sizeof figure, "%s.sweep_80", names[i]);
    bench_print(figure, 1e3 * bench_best_s(sweep, &device, 20), "ms");
    snprintf(figure, sizeof figure, "%s.path", names[i]);
    bench_print(figure, 1e3 * bench_best_s(path, &device, 20), "ms");
  }
  dea_context_destroy(ctx);
  return 0;
}
