#include "reduce/reduce_parts.h"

/* Samples of a channel, first <= i < first + count; count 0: none. */
struct window {
  size_t first, count;
};

struct edges {
  struct window up, down; // equally long
  double voltage_V;       // mean size of both steps
};

/* Mean voltage from begin_s on for some time, at least of one sample; NAN outside. */
static double voltage_from(const struct dea_channel *voltage, double begin_s, double length_s)
{
  size_t i = dea_channel_index(voltage, begin_s),
         end = dea_channel_index(voltage, begin_s + length_s);
  double sum = 0, count = 0;
  for (end = end > i ? end : i + 1; i < end && i < voltage->count; i++) {
    sum += isnan(voltage->values[i]) ? 0 : voltage->values[i];
    count += isnan(voltage->values[i]) ? 0 : 1;
  }
  return sum / count; // NAN without any
}

static bool is_span(struct dea_span span)
{
  return span.end_s >= span.begin_s; // not of NAN
}

/* Where a rest ends at the voltage at which the one behind begins: a half of that of its end. */
static double foot_of_edge(const struct dea_channel *voltage, struct dea_span rest,
                           const struct dea_charge_limits *limits)
{
  size_t i = dea_channel_index(voltage, rest.end_s), found = i;
  for (; i > 0 && dea_channel_time(voltage, i - 1) > rest.begin_s; i--) {
    if (fabs(voltage->values[i - 1] - limits->rest_V) < 0.5 * limits->least_V) {
      break;
    }
    found = isnan(voltage->values[i - 1]) ? found : i - 1;
  }
  return found < voltage->count ? fmin(dea_channel_time(voltage, found), rest.end_s) : rest.end_s;
}

/* Windows about the edges that mirror each other in time, so that the voltage is on for as long in
 * one as in the other: behind the first edge as long as before the second. false: there are no two
 * edges, or they are not equally long. */
static bool find_edges(const struct dea_channel *current, const struct dea_channel *voltage,
                       const struct dea_cycle_parts *part, const struct dea_charge_limits *limits,
                       struct edges *out)
{
  static const double alike = 0.05;
  if (!is_span(part->rest) || !is_span(part->active) || !is_span(part->after) ||
      current->count < 2) {
    return false;
  }
  double foot_end_s = foot_of_edge(voltage, part->rest, limits);
  double rise_s = part->active.begin_s - foot_end_s;
  double fall_s = part->after.begin_s - part->active.end_s;
  double sample_s = fmax(dea_channel_time(current, 1) - dea_channel_time(current, 0),
                         dea_channel_time(voltage, 1) - dea_channel_time(voltage, 0));
  if (!(fabs(rise_s - fall_s) <= 2 * sample_s + alike * fmax(rise_s, fall_s))) {
    return false;
  }
  double settled_s = fmax(limits->settled_s, 4 * sample_s);
  double active_s = 0.5 * (part->active.end_s - part->active.begin_s);
  active_s = part->held ? fmin(active_s, settled_s) : active_s;
  double rests_s = fmin(foot_end_s - part->rest.begin_s, part->after.end_s - part->after.begin_s);
  double rest_s = part->held ? fmin(0.5 * rests_s, active_s) : 0;
  double up_s = foot_end_s - rest_s, down_s = part->active.end_s - active_s;
  double length_s = fmax(rise_s, fall_s) + rest_s + active_s;
  out->up.first = dea_channel_index(current, up_s);
  out->down.first = dea_channel_index(current, down_s);
  out->up.count = out->down.count = dea_channel_index(current, up_s + length_s) - out->up.first;
  double top_s = part->held ? 0.5 * active_s : 0, foot_s = part->held ? 0.5 * rest_s : 0;
  // about the ends of the windows, which may lie in the foot of a ramp
  double top_V = 0.5 * (voltage_from(voltage, up_s + length_s - 0.5 * top_s, top_s) +
                        voltage_from(voltage, down_s - 0.5 * top_s, top_s));
  double before_V = voltage_from(voltage, up_s - 0.5 * foot_s, foot_s);
  double behind_V = voltage_from(voltage, down_s + length_s - 0.5 * foot_s, foot_s);
  out->voltage_V = top_V - 0.5 * (before_V + behind_V);
  return out->up.count > 1 && out->down.first + out->down.count <= current->count &&
         fabs(out->voltage_V) > limits->least_V;
}

/* Integral of the current over a window, by what each sample stands for. */
static double charge_of(const struct dea_channel *current, struct window window)
{
  double sum_C = 0;
  for (size_t i = window.first; i < window.first + window.count; i++) {
    size_t a = i > 0 ? i - 1 : 0, b = i + 1 < current->count ? i + 1 : i;
    double width_s =
        (dea_channel_time(current, b) - dea_channel_time(current, a)) / (double)(b - a);
    sum_C += current->values[i] * width_s;
  }
  return sum_C;
}

/* Mean current of the settled active part less that of the settled rests. */
static double leakage_of(const struct dea_channel *current, const struct dea_cycle_parts *part,
                         double settle, double *scratch)
{
  const struct dea_span spans[3] = {part->active, part->rest, part->after};
  double mean_A[3];
  for (size_t k = 0; k < 3; k++) {
    mean_A[k] =
        is_span(spans[k])
            ? dea_window_mean(current, dea_span_settled(spans[k], settle, true), INFINITY, scratch)
                  .mean
            : NAN;
  }
  double rest_A = isnan(mean_A[1])   ? mean_A[2]
                  : isnan(mean_A[2]) ? mean_A[1]
                                     : 0.5 * (mean_A[1] + mean_A[2]);
  return part->held ? mean_A[0] - rest_A : NAN;
}

/* Charge of all cycles so far, of whose own charges (in charge_C, NAN: not known) the sum is made.
 * One that is not known is what the capacitance before it, or the first one, takes at its voltage.
 */
static void add_charges(struct dea_reduced_cycle *cycles, size_t count,
                        const struct dea_charge_limits *limits)
{
  double known_F = NAN, sum_C = 0;
  for (size_t k = count; k-- > 0;) {
    known_F = isnan(cycles[k].capacitance_F) ? known_F : cycles[k].capacitance_F;
  }
  for (size_t k = 0; k < count; k++) {
    struct dea_reduced_cycle *cycle = &cycles[k];
    known_F = isnan(cycle->capacitance_F) ? known_F : cycle->capacitance_F;
    double step_V = fabs(cycle->voltage_V - limits->rest_V);
    double own_C = isnan(cycle->charge_C) ? known_F * step_V : cycle->charge_C;
    sum_C += isnan(cycle->charge_C) && step_V <= limits->least_V ? 0 : fabs(own_C);
    cycle->charge_C = sum_C;
  }
}

dea_status dea_charge_find(struct dea_context *ctx, const struct dea_channel *current,
                           const struct dea_channel *voltage, const struct dea_cycle_parts *parts,
                           size_t count, double settle, const struct dea_charge_limits *limits,
                           struct dea_reduced_cycle *cycles)
{
  double *scratch = dea_alloc(ctx, current->count, 2 * sizeof *scratch);
  DEA_TRY_MEMORY(scratch != NULL);
  for (size_t k = 0; k < count; k++) {
    struct edges edges;
    struct dea_reduced_cycle *cycle = &cycles[k];
    cycle->charge_C = NAN;
    if (find_edges(current, voltage, &parts[k], limits, &edges)) {
      cycle->charge_C = 0.5 * (charge_of(current, edges.up) - charge_of(current, edges.down));
      cycle->capacitance_F = cycle->charge_C / edges.voltage_V;
    }
    cycle->leakage_A = leakage_of(current, &parts[k], settle, scratch);
  }
  add_charges(cycles, count, limits);
  dea_free(ctx, scratch);
  return DEA_OK;
}

/* C = eps A / h, and A h is constant: C grows with the fourth power of an even stretch. */
void dea_charge_levels(struct dea_reduction *reduction)
{
  double lowest_F = NAN, lowest_V = INFINITY;
  for (size_t l = 0; l < reduction->level_count; l++) {
    struct dea_voltage_level *level = &reduction->levels[l];
    double sum = 0, squares = 0, n = 0;
    for (int turn = 0; turn < 2; turn++) {
      for (size_t k = 0; k < reduction->cycle_count; k++) {
        double own = reduction->cycles[k].capacitance_F;
        if (reduction->cycles[k].level == l && !isnan(own)) {
          sum += turn == 0 ? own : 0;
          n += turn == 0 ? 1 : 0;
          squares += turn == 1 ? (own - sum / n) * (own - sum / n) : 0;
        }
      }
    }
    level->capacitance_F = sum / n; // NAN without any
    level->capacitance_std_F = n > 1 ? sqrt(squares / (n - 1)) : NAN;
    if (n > 0 && fabs(level->voltage_V) < lowest_V) {
      lowest_F = level->capacitance_F;
      lowest_V = fabs(level->voltage_V);
    }
  }
  for (size_t l = 0; l < reduction->level_count; l++) {
    double ratio = reduction->levels[l].capacitance_F / lowest_F;
    reduction->levels[l].sensed_stretch = ratio > 0 ? pow(ratio, 0.25) : NAN;
  }
}
