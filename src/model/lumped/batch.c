/* Eqs 16-17 for many designs: Newton from the pre-stretched state. The imbalance f rises and is
 * concave up to its first root as long as the film softens, so that Newton from the left never
 * passes it; where that fails (stiffening, pull-in) a scan brackets the first stable root. */
#include "model/lumped/lumped.h"

#include <math.h>

enum { NEWTON_MAX = 30, ROOT_MAX = 100 };

static const double newton_last = 1e-8; // an error e leaves one of order e^2
static const double newton_longest = 0.1;
static const double root_close = 1e-13;
static const double scan_growth =
    1.02; // of the stretch; a stable window narrower than that is missed

/* Root of f in (low, high), f < 0 at low and f > 0 or outside the law's domain at high: Newton
 * where it stays inside, bisection elsewhere. NAN when only the end of the domain is found. */
static double root_between(const struct dea_lumped *lumped, double field, double low, double high)
{
  struct dea_lumped_balance balance;
  double l_a = 0.5 * (low + high);
  for (int i = 0; i < ROOT_MAX; i++) {
    dea_status status = dea_lumped_balance_eval(lumped, l_a, field, &balance);
    bool inside = status == DEA_OK && isfinite(balance.imbalance_Pa);
    *(inside && balance.imbalance_Pa < 0 ? &low : &high) = l_a;
    double next = inside ? l_a - balance.imbalance_Pa / balance.slope_Pa : NAN;
    if (!(next > low && next < high)) {
      next = 0.5 * (low + high);
    }
    if (inside && fabs(next - l_a) < root_close) {
      return next;
    }
    if (high - low < root_close) {
      break;
    }
    l_a = next;
  }
  return NAN;
}

/* First crossing of f from below to above 0 beyond l_a = 1. */
static double scan(const struct dea_lumped *lumped, double field, double max_electrode_stretch)
{
  struct dea_lumped_balance balance;
  double before = 1;
  bool below = false;
  for (double l_a = 1; before < max_electrode_stretch; l_a *= scan_growth) {
    double at = fmin(l_a, max_electrode_stretch);
    bool inside = dea_lumped_balance_eval(lumped, at, field, &balance) == DEA_OK;
    if (below && (!inside || balance.imbalance_Pa >= 0)) {
      return root_between(lumped, field, before, at);
    }
    if (!inside) {
      return NAN;
    }
    below = balance.imbalance_Pa < 0;
    before = at;
  }
  return NAN;
}

static double solve_one(const struct dea_lumped *lumped, double field, double max_electrode_stretch)
{
  struct dea_lumped_balance balance;
  double l_a = 1;
  for (int i = 0; i < NEWTON_MAX; i++) {
    if (dea_lumped_balance_eval(lumped, l_a, field, &balance) != DEA_OK ||
        !(balance.slope_Pa > 0)) {
      break;
    }
    double change = -balance.imbalance_Pa / balance.slope_Pa;
    if (change < 0 && l_a + change < 1) {
      break;
    }
    l_a += change < newton_longest ? change : newton_longest;
    if (fabs(change) < newton_last) {
      return l_a <= max_electrode_stretch ? l_a : NAN;
    }
  }
  return field == 0 ? 1 : scan(lumped, field, max_electrode_stretch);
}

dea_status dea_lumped_batch_solve(const struct dea_material *material,
                                  const struct dea_lumped_batch *batch)
{
  if (material->law == NULL || !(material->permittivity.at_rest > 0)) {
    return DEA_E_ARGUMENT;
  }
  for (size_t i = 0; i < batch->count; i++) {
    struct dea_lumped lumped = {
        .film = {.material = material, .thickness_m = batch->thickness_m[i]},
        .pre_stretch = batch->pre_stretch[i],
        .coverage = batch->coverage[i],
        .electrode_radius_m = 1};
    double end = fmin(batch->max_stretch / lumped.pre_stretch, (1 - 1e-9) / lumped.coverage);
    batch->electrode_stretch[i] =
        solve_one(&lumped, batch->voltage_V[i] / batch->thickness_m[i], end);
  }
  return DEA_OK;
}
