/* A load line by few voltages while the film has tension, by all of them from there on
 * (docs/theory/loads.md, "Voltages between computed ones"). */
#include "study/force_line.h"

#include "study/observe.h"
#include "study/sampled_line.h"
#include "study/study.h"

#include <stdio.h>

enum { FIRST_GAPS = 8 }; // of a line, about: its first steps

struct way {
  struct dea_context *ctx;
  const struct dea_force_line *asked;
  struct dea_monitor_set seen;  // its memory is that of the points too
  struct dea_sampled_line line; // its first `count` points rise; it has room for all
  bool *wanted;                 // [asked->count]
  struct dea_state taut;        // at the last point where the film had tension everywhere
  size_t top;                   // that point
  size_t done;                  // points before this one are computed or lie between such
  bool filled;                  // and those between are interpolated
};

static bool is_taut(const struct dea_load_point *point)
{
  return !dea_load_point_is_one_of_several(point) && !(point->min_tension_N_per_m < 0);
}

/* Voltages from the first one on that rise. */
static size_t rising(const double *voltages_V, size_t count)
{
  size_t n = count > 0 ? 1 : 0;
  while (n < count && voltages_V[n] > voltages_V[n - 1]) {
    n++;
  }
  return n;
}

static dea_status solve(struct way *way, size_t k)
{
  const struct dea_force_line *asked = way->asked;
  if (dea_interrupted_anywhere(way->ctx)) {
    return dea_fail(way->ctx, DEA_E_INTERRUPTED, "interrupted before %.6g kV",
                    1e-3 * asked->voltages_V[k]);
  }
  struct dea_load_point *point = &way->line.points[k];
  struct dea_monitor_values *own = point->monitors;
  const dea_status status = asked->type->solve(way->ctx, asked->model, asked->voltages_V[k], point);
  point->monitors = own;
  DEA_TRY(way->ctx, status);
  DEA_TRY(way->ctx,
          dea_monitor_set_read(way->ctx, &way->seen, asked->type, asked->model, false, point));
  point->monitors = own;
  for (size_t i = 0; own != NULL && i < own->count; i++) {
    own->at[i] = way->seen.values->at[i];
  }
  way->line.computed[k] = true;
  return DEA_OK;
}

/* The last computed point is one with tension everywhere. */
static dea_status keep_taut(struct way *way, size_t k)
{
  struct dea_state now;
  way->top = k;
  dea_state_free_values(way->ctx, &way->taut);
  DEA_TRY(way->ctx, dea_model_save(way->ctx, way->asked->type, way->asked->model, &now));
  return dea_state_copy_values(way->ctx, &now, &way->taut);
}

/* Whether tension would end before a voltage by its last two points, the first `before`, as it goes
 * with the square of the voltage. */
static bool ends_before(const struct way *way, size_t before, size_t to)
{
  const struct dea_load_point *p = &way->line.points[before], *last = &way->line.points[way->top];
  double fall = p->min_tension_N_per_m - last->min_tension_N_per_m, V = way->line.voltages_V[to];
  double at = last->voltage_V * last->voltage_V, way_back = at - p->voltage_V * p->voltage_V;
  return fall > 0 && (V * V - at) * fall > way_back * last->min_tension_N_per_m;
}

/* Steps of several voltages while the film has tension; what ends beyond, or would by the tension
 * so far, is halved from before.
 * *next: the first voltage that is not computed yet. */
static dea_status go_up(struct way *way, size_t *next)
{
  const struct dea_force_line *asked = way->asked;
  size_t step = 1, beyond = way->line.count, before = 0;
  while (2 * step * FIRST_GAPS < way->line.count) {
    step *= 2;
  }
  *next = 0;
  DEA_TRY(way->ctx, solve(way, 0));
  *next = 1;
  if (!is_taut(&way->line.points[0])) {
    return DEA_OK;
  }
  DEA_TRY(way->ctx, keep_taut(way, 0));
  while (step > 0 && way->top + 1 < way->line.count) {
    size_t to = way->top + step < way->line.count ? way->top + step : way->line.count - 1;
    *next = way->top + 1;
    if (to >= beyond || (to > *next && ends_before(way, before, to))) {
      step /= 2;
      continue;
    }
    dea_status status = solve(way, to);
    if (status == DEA_OK && is_taut(&way->line.points[to])) {
      before = way->top;
      DEA_TRY(way->ctx, keep_taut(way, to));
      *next = to + 1;
    } else if (to == *next || (status != DEA_OK && dea_verdict_of(status)[0] == '\0')) {
      *next += status == DEA_OK ? 1 : 0; // by the step of a sweep: as it came
      return status;
    } else {
      dea_context_clear(way->ctx);
      way->line.computed[to] = false;
      beyond = to;
      DEA_TRY(way->ctx, dea_model_load(way->ctx, asked->type, asked->model, &way->taut));
    }
  }
  return DEA_OK;
}

/* All voltages from `from` on, one after the other. */
static dea_status go_on(struct way *way, size_t from)
{
  for (way->done = from; way->done < way->asked->count; way->done++) {
    DEA_TRY(way->ctx, solve(way, way->done));
  }
  return DEA_OK;
}

/* The voltages that are wanted, rising from the pressed tip. *good: false where a state between two
 * with tension has none, or is not found. */
static dea_status go_between(struct way *way, bool *good)
{
  const struct dea_force_line *asked = way->asked;
  DEA_TRY(way->ctx, dea_model_load(way->ctx, asked->type, asked->model, asked->pressed));
  for (size_t k = 0; k < way->top && *good; k++) {
    if (way->wanted[k]) {
      dea_status status = solve(way, k);
      if (status != DEA_OK && dea_verdict_of(status)[0] == '\0') {
        return status;
      }
      dea_context_clear(way->ctx);
      *good = status == DEA_OK && is_taut(&way->line.points[k]);
    }
  }
  return DEA_OK;
}

/* Halves gaps until all that are left may be interpolated, and does that; where a state between is
 * none of the line, all voltages are computed one after the other. */
static dea_status fill(struct way *way)
{
  struct dea_sampled_line line = way->line;
  bool good = true;
  line.count = line.count < way->done ? line.count : way->done;
  while (line.count > 0 && dea_load_point_is_one_of_several(&line.points[line.count - 1])) {
    line.count--;
  }
  while (good && dea_sampled_line_halve(&line, way->asked->tolerance, way->wanted) > 0) {
    DEA_TRY(way->ctx, go_between(way, &good));
  }
  way->filled = true;
  if (good) {
    dea_sampled_line_fill(&line);
    return DEA_OK;
  }
  DEA_TRY(way->ctx,
          dea_model_load(way->ctx, way->asked->type, way->asked->model, way->asked->pressed));
  return go_on(way, 0);
}

/* Goes all the way. A line that stops is filled up to there. */
static dea_status go(struct way *way)
{
  char why[256];
  dea_status status = go_up(way, &way->done);
  status = status == DEA_OK ? go_on(way, way->done) : status;
  if (status != DEA_OK && dea_verdict_of(status)[0] == '\0') {
    return status;
  }
  snprintf(why, sizeof why, "%s", status != DEA_OK ? dea_context_message(way->ctx) : "");
  dea_context_clear(way->ctx);
  DEA_TRY(way->ctx, fill(way));
  return status == DEA_OK || way->done == way->asked->count ? DEA_OK
                                                            : dea_fail(way->ctx, status, "%s", why);
}

static dea_status reserve(struct way *way)
{
  struct dea_context *ctx = way->ctx;
  size_t n = way->asked->count;
  DEA_TRY(ctx, dea_monitor_set_init(ctx, way->asked->type, way->asked->device, &way->seen));
  way->line.points = dea_arena_alloc(&way->seen.memory, n, sizeof *way->line.points);
  way->line.computed = dea_arena_alloc(&way->seen.memory, n, sizeof *way->line.computed);
  way->wanted = dea_arena_alloc(&way->seen.memory, n, sizeof *way->wanted);
  DEA_TRY(ctx, dea_arena_status(&way->seen.memory));
  for (size_t k = 0; k < n && way->seen.count > 0; k++) {
    way->line.points[k].monitors = dea_monitor_values_copy(&way->seen.memory, way->seen.values);
  }
  return dea_arena_status(&way->seen.memory);
}

static dea_status add_points(const struct way *way, struct dea_curve *curve)
{
  for (size_t k = 0; k < way->done; k++) {
    if (way->filled || way->line.computed[k]) {
      DEA_TRY(way->ctx, dea_curve_add_point(way->ctx, curve, &way->line.points[k]));
    }
  }
  return DEA_OK;
}

dea_status dea_force_line_compute(struct dea_context *ctx, const struct dea_force_line *asked,
                                  struct dea_curve *curve)
{
  struct way way = {.ctx = ctx, .asked = asked, .seen = {.memory = {.ctx = ctx}}};
  way.line.voltages_V = asked->voltages_V;
  way.line.count = rising(asked->voltages_V, asked->count);
  if (asked->tolerance <= 0 || asked->pressed == NULL || way.line.count <= 2 * FIRST_GAPS) {
    return dea_study_add_points(ctx, asked->type, asked->model, asked->device, asked->voltages_V,
                                asked->count, curve);
  }
  dea_status status = reserve(&way);
  if (status == DEA_OK) {
    status = go(&way);
    dea_status added = add_points(&way, curve);
    status = status == DEA_OK ? added : status;
  }
  dea_state_free_values(ctx, &way.taut);
  dea_monitor_set_free(&way.seen);
  return status;
}
