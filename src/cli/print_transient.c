#include "cli/print_studies.h"

#include "output/csv.h"
#include "result/time_series.h"

#include <math.h>
#include <stdio.h>

enum { LEVELS_SHOWN = 20 };

static void print_level(const struct dea_cycle *first, const struct dea_cycle *last, size_t count,
                        double factor)
{
  double change = last->farthest - first->farthest;
  printf("%9.4g%8zu%13.4f%13.4f%13.4f", 1e-3 * first->level_V, count, factor * first->farthest,
         factor * last->farthest, factor * change);
  if (isfinite(first->rise_time_s)) {
    printf("%13.4g\n", first->rise_time_s);
  } else {
    printf("%13s\n", "-");
  }
}

static void print_cycles(const struct dea_cycle *cycles, size_t count, int column)
{
  const struct dea_column *c = &dea_point_columns[column];
  size_t shown = 0, left = 0;
  printf("%9s%8s%13s%13s%13s%13s\n%9s%8s%13s%13s%13s%13s\n", "V", "cycles", "first", "last",
         "creep", "rise 10-90", "kV", "", c->display_unit, c->display_unit, c->display_unit, "s");
  for (size_t first = 0, last; first < count; first = last + 1) {
    last = dea_time_series_level_end(cycles, count, first);
    if (shown < LEVELS_SHOWN) {
      print_level(&cycles[first], &cycles[last], last - first + 1, c->factor);
      shown++;
    } else {
      left++;
    }
  }
  if (left > 0) {
    printf("and %zu more (summary.json)\n", left);
  }
}

dea_status cli_print_transient(struct dea_context *ctx, const struct dea_result *result,
                               const char *model)
{
  const struct dea_curve *curve = dea_result_find(result, model, "transient");
  if (curve == NULL || curve->count == 0) {
    return DEA_OK;
  }
  struct dea_energy_balance energy;
  struct dea_cycle *cycles = NULL;
  size_t count = 0;
  int column = dea_time_series_column(curve);
  printf("\n%s: in time, %zu points to %.6g s\n", model, curve->count,
         curve->points[curve->count - 1].time_s);
  if (column >= 0) {
    DEA_TRY(ctx, dea_time_series_cycles(ctx, curve, result->design->drive.waveform, column, &cycles,
                                        &count));
  }
  if (count > 0) {
    char title[96];
    dea_column_title(&dea_point_columns[column], title, sizeof title);
    printf("farthest value of each cycle, %s\n", title);
    print_cycles(cycles, count, column);
  }
  dea_free(ctx, cycles);
  if (dea_time_series_balance(curve, &energy)) {
    printf("energy: the supply gave %.5g uJ; %.5g uJ are stored, %.5g uJ moving, %.5g uJ lost; "
           "not accounted for %.2g %%\n",
           1e6 * energy.supply_work_J, 1e6 * energy.stored_J, 1e6 * energy.kinetic_J,
           1e6 * energy.dissipated_J, 100 * energy.error);
  }
  return DEA_OK;
}
