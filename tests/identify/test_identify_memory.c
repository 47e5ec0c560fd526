/* identify: every allocation of a fit fails once, and nothing is left. */
// ctest: quick, heavy
#include "failing_allocator.h"
#include "identify/fit.h"
#include "testing.h"

#include <stdio.h>

enum { ROWS = 8 };

/* Two laws to compare, one with a parameter that is searched for on a grid, relaxation and
 * branches.
 */
static void fit_small(struct dea_context *ctx, void *user)
{
  static struct dea_fit_file file;
  static double stretch[2][ROWS], stress[2][ROWS], std[2][ROWS], time_s[ROWS];
  struct dea_fit_series series[2];
  struct dea_arena memory = {.ctx = ctx};
  struct dea_fit fit = {0};
  const bool profile = *(const bool *)user;
  file.law_count = profile ? 1 : 2;
  snprintf(file.laws[0].text, sizeof file.laws[0].text, "neo-hookean");
  snprintf(file.laws[1].text, sizeof file.laws[1].text, "mooney-rivlin");
  snprintf(file.branches.text, sizeof file.branches.text, "%s", profile ? "1" : "none");
  file.tests[1].kind.value = profile ? DEA_FIT_RELAXATION : DEA_FIT_PLANAR;
  for (size_t t = 0; t < 2; t++) {
    for (size_t i = 0; i < ROWS; i++) {
      time_s[i] = 1 + 3.0 * (double)(i * i);
      stretch[t][i] = t == 1 && profile ? 2 : 1.1 + 0.1 * (double)i;
      stress[t][i] = 1e5 * (stretch[t][i] - 1 / stretch[t][i]) * (1 + 1 / time_s[i] * (double)t);
      std[t][i] = 1e3;
    }
    series[t] = (struct dea_fit_series){.test = &file.tests[t],
                                        .file = "none",
                                        .rows = ROWS,
                                        .stretch = stretch[t],
                                        .stress_Pa = stress[t],
                                        .std_Pa = std[t]};
    series[t].coupon = (struct dea_coupon){.mode = t == 1 && !profile ? DEA_PLANAR : DEA_UNIAXIAL,
                                           .rows = ROWS,
                                           .stretch = stretch[t]};
  }
  dea_status status = DEA_OK;
  if (profile) {
    series[1].time_s = time_s;
    status = dea_coupon_follow(&memory, time_s, 1, &series[1].coupon);
  }
  if (status == DEA_OK) {
    status = dea_fit_run(ctx, &file, series, 2, profile, &fit);
  }
  failing_check(ctx, status);
  dea_fit_free(&fit);
  dea_arena_free(&memory);
}

TEST(test_every_allocation)
{
  for (int k = 0; k < 2; k++) {
    bool profile = k == 1;
    struct failing_count count;
    long n = 0;
    while (failing_run(fit_small, &profile, n, &count)) {
      n++;
    }
    assert_true(n > 100);
  }
}

TESTS(NULL, NULL)
