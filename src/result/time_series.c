#include "result/time_series.h"

#include "result/result.h"

#include <math.h>

static double largest_of(const struct dea_curve *curve, int column)
{
  double largest = 0;
  for (size_t i = 0; i < curve->count; i++) {
    double value = fabs(dea_point_get(&curve->points[i], column));
    largest = isfinite(value) ? fmax(largest, value) : largest;
  }
  return largest;
}

int dea_time_series_column(const struct dea_curve *curve)
{
  static const double rounding = 1e-6; // a flat film's centre stays but for the solver's
  int centre = dea_point_column_find("centre_z_m"),
      edge = dea_point_column_find("electrode_edge_u_m");
  double z_m = largest_of(curve, centre), u_m = largest_of(curve, edge);
  return z_m > rounding * u_m ? centre : u_m > 0 ? edge : -1;
}

/* First time at which the column is at `level` on its way between points from and to; NAN: never.
 */
static double time_at(const struct dea_curve *curve, int column, size_t from, size_t to,
                      double level, double side)
{
  for (size_t i = from + 1; i < to; i++) {
    double a = dea_point_get(&curve->points[i - 1], column) - level;
    double b = dea_point_get(&curve->points[i], column) - level;
    if (a * side < 0 && b * side >= 0) {
      double t = curve->points[i - 1].time_s;
      return t + (curve->points[i].time_s - t) * a / (a - b);
    }
  }
  return NAN;
}

/* Before a time, and not by rounding only. */
static bool is_before(double time_s, double end_s)
{
  return time_s < end_s * (1 - 1e-12);
}

/* Features of the points [from, to), of which there is one at least. */
static void measure(const struct dea_curve *curve, int column, size_t from, size_t to,
                    struct dea_cycle *out)
{
  double start = dea_point_get(&curve->points[from], column);
  out->highest = out->lowest = start;
  for (size_t i = from; i < to; i++) {
    double value = dea_point_get(&curve->points[i], column);
    out->highest = fmax(out->highest, value);
    out->lowest = fmin(out->lowest, value);
  }
  out->amplitude = out->highest - out->lowest;
  out->farthest = out->highest - start >= start - out->lowest ? out->highest : out->lowest;
  double change = out->farthest - start, side = copysign(1, change);
  out->rise_time_s = NAN;
  if (change != 0) {
    out->rise_time_s = time_at(curve, column, from, to, start + 0.9 * change, side) -
                       time_at(curve, column, from, to, start + 0.1 * change, side);
  }
}

dea_status dea_time_series_cycles(struct dea_context *ctx, const struct dea_curve *curve,
                                  const struct dea_waveform *waveform, int column,
                                  struct dea_cycle **cycles, size_t *count)
{
  struct dea_wave_cycle wave;
  double end_s = curve->count > 0 ? curve->points[curve->count - 1].time_s * (1 + 1e-12) : -1;
  size_t total = 0, from = 0;
  *cycles = NULL;
  *count = 0;
  while (column >= 0 && dea_waveform_cycle(waveform, total, &wave) && wave.end_s <= end_s) {
    total++;
  }
  if (total == 0) {
    return DEA_OK;
  }
  *cycles = dea_alloc(ctx, total, sizeof **cycles);
  DEA_TRY_MEMORY(*cycles != NULL);
  for (; *count < total; ++*count) {
    dea_waveform_cycle(waveform, *count, &wave);
    while (from + 1 < curve->count && is_before(curve->points[from].time_s, wave.start_s)) {
      from++;
    }
    size_t to = from + 1; // without the jump at the end, which belongs to the next cycle
    while (to < curve->count && is_before(curve->points[to].time_s, wave.end_s)) {
      to++;
    }
    struct dea_cycle *cycle = &(*cycles)[*count];
    *cycle =
        (struct dea_cycle){.start_s = wave.start_s, .end_s = wave.end_s, .level_V = wave.level_V};
    measure(curve, column, from, to, cycle);
    from = to - 1;
  }
  return DEA_OK;
}

size_t dea_time_series_level_end(const struct dea_cycle *cycles, size_t count, size_t first)
{
  size_t last = first;
  while (last + 1 < count && cycles[last + 1].level_V == cycles[first].level_V) {
    last++;
  }
  return last;
}

bool dea_time_series_balance(const struct dea_curve *curve, struct dea_energy_balance *out)
{
  *out = (struct dea_energy_balance){0};
  double worst = 0, first_J = curve->count > 0 ? curve->points[0].stored_energy_J : 0;
  for (size_t i = 0; i < curve->count; i++) {
    const struct dea_load_point *p = &curve->points[i];
    double kinetic = isnan(p->kinetic_energy_J) ? 0 : p->kinetic_energy_J;
    double damped = isnan(p->damped_J) ? 0 : p->damped_J;
    if (isnan(p->supply_work_J) || isnan(p->stored_energy_J) || isnan(p->dissipated_J)) {
      return false;
    }
    out->supply_work_J = p->supply_work_J;
    out->stored_J = p->stored_energy_J - first_J;
    out->kinetic_J = kinetic;
    out->dissipated_J = p->dissipated_J + damped;
    double largest =
        fmax(fmax(fabs(p->supply_work_J), fabs(out->stored_J)), fmax(kinetic, out->dissipated_J));
    out->largest_J = fmax(out->largest_J, largest);
    worst = fmax(worst, fabs(p->supply_work_J - out->stored_J - kinetic - out->dissipated_J));
  }
  out->error = out->largest_J > 0 ? worst / out->largest_J : 0;
  return curve->count > 0;
}
