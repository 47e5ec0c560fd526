/* How long a fit of five parameters to 3000 points takes, with its error bars. */
#include "identify/fit.h"
#include "timing.h"

#include <stdint.h>
#include <string.h>

enum { ROWS = 1000, TESTS = 3 };

static struct dea_fit_file file;
static struct dea_fit_series series[TESTS];
static double stretch[TESTS][ROWS], stress[TESTS][ROWS], std[TESTS][ROWS];
static struct dea_context *ctx;

static void run_fit(void *user)
{
  struct dea_fit fit;
  (void)user;
  bench_need(dea_fit_run(ctx, &file, series, TESTS, false, &fit), ctx);
  dea_fit_free(&fit);
}

/* A number between -1 and 1. */
static double noise(uint64_t *seed)
{
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) / 4503599627370496.0 - 1;
}

static void make_tests(const struct dea_material *material)
{
  uint64_t seed = 1;
  for (int t = 0; t < TESTS; t++) {
    file.tests[t].kind.value = t;
    for (size_t i = 0; i < ROWS; i++) {
      stretch[t][i] = 1 + (t == 2 ? 1.0 : 2.0) * (double)(i + 1) / ROWS;
      std[t][i] = 5e3;
    }
    series[t] = (struct dea_fit_series){.test = &file.tests[t],
                                        .file = "none",
                                        .rows = ROWS,
                                        .stretch = stretch[t],
                                        .stress_Pa = stress[t],
                                        .std_Pa = std[t]};
    series[t].coupon =
        (struct dea_coupon){.mode = (enum dea_coupon_mode)t, .rows = ROWS, .stretch = stretch[t]};
    bench_need(dea_coupon_stress(material, &series[t].coupon, NULL, stress[t]), ctx);
    for (size_t i = 0; i < ROWS; i++) {
      stress[t][i] += 1.73 * std[t][i] * noise(&seed);
    }
  }
  file.test_count = TESTS;
}

int main(void)
{
  static const struct {
    const char *label, *law, *name;
    double p[DEA_LAW_PARAM_MAX];
  } laws[] = {{"third-order", "third-order", "fit.third_order", {5e5, -1.4e4, 1.4e4, -1.6e4, 5e3}},
              {"ogden-2", "ogden", "fit.ogden_2", {4e5, 1.3, -1e4, -2.5}}};
  bench_need(dea_context_create(NULL, &ctx), ctx);
  for (size_t k = 0; k < sizeof laws / sizeof laws[0]; k++) {
    struct dea_material material = {.law = dea_law_find(laws[k].law)};
    memcpy(material.param, laws[k].p, sizeof material.param);
    memset(&file, 0, sizeof file);
    snprintf(file.branches.text, sizeof file.branches.text, "none");
    snprintf(file.laws[0].text, sizeof file.laws[0].text, "%s", laws[k].label);
    file.law_count = 1;
    make_tests(&material);
    bench_print(laws[k].name, bench_best_s(run_fit, NULL, 3), "s for 3000 points");
  }
  dea_context_destroy(ctx);
  return 0;
}
