/* Mean profiles of the levels against rest (dea_profiles_levels). */
#include "reduce/reduce_parts.h"

#include <string.h>

/* Sum over the frames of a window, point by point. */
struct stack {
  double *sum, *squares, *count; // [points], lent
  double time_s, frames;
};

enum { REST, IN, AFTER, STACKS };

struct worker {
  const struct dea_profiles *profiles;
  const double *offsets;
  struct dea_levelling levelling; // a copy: what it counts was counted before
  double settle;
  struct stack stacks[STACKS];
  double *clean, *work, *change, *variance; // [points], [2 points], [points], [points]
};

static void stack_fill(struct worker *w, struct dea_span span, struct stack *stack)
{
  const struct dea_profiles *p = w->profiles;
  struct dea_channel clock = {.time_s = p->time_s, .count = p->count};
  memset(stack->sum, 0, p->points * sizeof *stack->sum);
  memset(stack->squares, 0, p->points * sizeof *stack->squares);
  memset(stack->count, 0, p->points * sizeof *stack->count);
  stack->time_s = stack->frames = 0.0;
  if (!(span.end_s > span.begin_s)) {
    return;
  }
  size_t end = dea_channel_index(&clock, span.end_s);
  for (size_t f = dea_channel_index(&clock, span.begin_s); f < end; f++) {
    dea_points_clean(&w->levelling, p->x_m, p->z_m + f * p->points, p->points, w->offsets[f],
                     w->work, w->clean);
    stack->time_s += p->time_s[f];
    stack->frames += 1.0;
    for (size_t i = 0; i < p->points; i++) {
      if (!isnan(w->clean[i])) {
        stack->sum[i] += w->clean[i];
        stack->squares[i] += w->clean[i] * w->clean[i];
        stack->count[i] += 1.0;
      }
    }
  }
  stack->time_s /= stack->frames;
}

/* Mean of a point, and the variance of that mean when the frames are independent. */
static double stack_mean(const struct stack *stack, size_t i, double *variance)
{
  double n = stack->count[i], mean = stack->sum[i] / n;
  *variance = n > 1.0 ? fmax(0.0, stack->squares[i] / n - mean * mean) / (n - 1.0) : NAN;
  return n > 0.0 ? mean : NAN;
}

/* Profile of a cycle against the rests before and behind, as amplitudes are formed. */
static void cycle_change(struct worker *w, const struct dea_cycle_parts *parts)
{
  struct stack *s = w->stacks;
  stack_fill(w, dea_span_settled(parts->rest, w->settle, parts->held), &s[REST]);
  stack_fill(w, dea_span_settled(parts->active, w->settle, parts->held), &s[IN]);
  stack_fill(w, dea_span_settled(parts->after, w->settle, parts->held), &s[AFTER]);
  double weight = s[AFTER].frames == 0.0 ? 0.0
                  : s[REST].frames == 0.0
                      ? 1.0
                      : (s[IN].time_s - s[REST].time_s) / (s[AFTER].time_s - s[REST].time_s);
  for (size_t i = 0; i < w->profiles->points; i++) {
    double before_variance, after_variance, variance;
    double active = stack_mean(&s[IN], i, &variance);
    double before = stack_mean(&s[REST], i, &before_variance);
    double after = stack_mean(&s[AFTER], i, &after_variance);
    if (weight < 1.0) {
      active -= (1.0 - weight) * before;
      variance += (1.0 - weight) * (1.0 - weight) * before_variance;
    }
    if (weight > 0.0) {
      active -= weight * after;
      variance += weight * weight * after_variance;
    }
    w->change[i] = active;
    w->variance[i] = variance;
  }
}

/* One level: mean and scatter of its cycles' profiles, shape. n: [points]. */
static void level_profile(struct worker *w, const struct dea_cycle_parts *parts, size_t index,
                          struct dea_reduction *reduction, double *n)
{
  struct dea_voltage_level *level = &reduction->levels[index];
  const struct dea_levelling *l = &w->levelling;
  size_t points = reduction->points, shapes = 0;
  double shape = 0.0, squares = 0.0, one_uncertainty = NAN, unused;
  double film_m =
      isnan(l->film_radius_m) ? 0.5 * (l->edges_m[1] - l->edges_m[0]) : l->film_radius_m;
  memset(n, 0, points * sizeof *n);
  for (size_t k = 0; k < reduction->cycle_count; k++) {
    if (reduction->cycles[k].level != index) {
      continue;
    }
    cycle_change(w, &parts[k]);
    for (size_t i = 0; i < points; i++) {
      if (!isnan(w->change[i])) { // Welford
        n[i] += 1.0;
        double step = w->change[i] - level->z_m[i];
        level->z_m[i] += step / n[i];
        level->z_std_m[i] += step * (w->change[i] - level->z_m[i]);
      }
    }
    double own = dea_shape_index(reduction->radius_m, w->change, points, l->electrode_radius_m,
                                 film_m, w->work, &unused);
    reduction->cycles[k].shape = own;
    if (!isnan(own)) {
      double step = own - shape;
      shape += step / (double)++shapes;
      squares += step * (own - shape);
    }
  }
  for (size_t i = 0; i < points; i++) {
    level->z_m[i] = n[i] > 0.0 ? level->z_m[i] : NAN;
    level->z_std_m[i] = n[i] > 1.0   ? sqrt(level->z_std_m[i] / (n[i] - 1.0))
                        : n[i] > 0.0 ? sqrt(w->variance[i])
                                     : NAN;
  }
  level->shape = dea_shape_index(reduction->radius_m, level->z_m, points, l->electrode_radius_m,
                                 film_m, w->work, &one_uncertainty);
  level->shape_uncertainty =
      shapes > 1 ? fmax(one_uncertainty, sqrt(squares / (double)(shapes - 1) / (double)shapes))
                 : one_uncertainty;
}

dea_status dea_profiles_levels(struct dea_context *ctx, const struct dea_profiles *profiles,
                               const struct dea_cycle_parts *parts, const double *offsets,
                               struct dea_reduction *reduction)
{
  enum { ARRAYS = 3 * STACKS + 6 };
  size_t points = profiles->points;
  double *capacity = dea_alloc(ctx, points, ARRAYS * sizeof *capacity), *next = capacity;
  reduction->radius_m = dea_alloc(ctx, points, sizeof *reduction->radius_m);
  bool good = capacity != NULL && reduction->radius_m != NULL;
  for (size_t l = 0; l < reduction->level_count && good; l++) {
    struct dea_voltage_level *level = &reduction->levels[l];
    level->z_m = dea_alloc(ctx, points, sizeof *level->z_m);
    level->z_std_m = dea_alloc(ctx, points, sizeof *level->z_std_m);
    good = level->z_m != NULL && level->z_std_m != NULL;
  }
  if (!good) {
    dea_free(ctx, capacity);
    return DEA_E_MEMORY;
  }
  struct worker w = {.profiles = profiles,
                     .offsets = offsets,
                     .levelling = reduction->levelling,
                     .settle = reduction->settle};
  for (int s = 0; s < STACKS; s++, next += 3 * points) {
    w.stacks[s] = (struct stack){.sum = next, .squares = next + points, .count = next + 2 * points};
  }
  w.clean = next;
  w.work = next + points; // [2 points]
  w.change = next + 3 * points;
  w.variance = next + 4 * points;
  reduction->points = points;
  for (size_t i = 0; i < points; i++) {
    reduction->radius_m[i] = profiles->x_m[i] - reduction->levelling.centre_m;
  }
  for (size_t l = 0; l < reduction->level_count; l++) {
    level_profile(&w, parts, l, reduction, next + 5 * points);
  }
  dea_free(ctx, capacity);
  return DEA_OK;
}
