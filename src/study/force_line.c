/* A load line by few voltages while the film has tension, by all of them from there on
 * (docs/theory/loads.md, "Voltages between computed ones"). */
#include "study/force_line.h"

#include "study/observe.h"
#include "study/sampled_line.h"
#include "study/study.h"

#include <stdio.h>

enum { FIRST_GAPS = 8 }; // of a line, about: its first steps

struct run {
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

static dea_status solve(struct run *run, size_t k)
{
  const struct dea_force_line *asked = run->asked;
  if (dea_interrupted_anywhere(run->ctx)) {
    return dea_fail(run->ctx, DEA_E_INTERRUPTED, "interrupted before %.6g kV",
                    1e-3 * asked->voltages_V[k]);
  }
  struct dea_load_point *point = &run->line.points[k];
  struct dea_monitor_values *own = point->monitors;
  const dea_status status = asked->type->solve(run->ctx, asked->model, asked->voltages_V[k], point);
  point->monitors = own;
  DEA_TRY(run->ctx, status);
  DEA_TRY(run->ctx,
          dea_monitor_set_read(run->ctx, &run->seen, asked->type, asked->model, false, point));
  point->monitors = own;
  for (size_t i = 0; own != NULL && i < own->count; i++) {
    own->at[i] = run->seen.values->at[i];
  }
  run->line.computed[k] = true;
  return DEA_OK;
}

/* The last computed point is one with tension everywhere. */
static dea_status keep_taut(struct run *run, size_t k)
{
  struct dea_state now;
  run->top = k;
  dea_state_free_values(run->ctx, &run->taut);
  DEA_TRY(run->ctx, dea_model_save(run->ctx, run->asked->type, run->asked->model, &now));
  return dea_state_copy_values(run->ctx, &now, &run->taut);
}

/* Whether tension would end before a voltage by its last two points, the first `before`, as it goes
 * with the square of the voltage. */
static bool ends_before(const struct run *run, size_t before, size_t to)
{
  const struct dea_load_point *p = &run->line.points[before], *last = &run->line.points[run->top];
  double fall = p->min_tension_N_per_m - last->min_tension_N_per_m, V = run->line.voltages_V[to];
  double at = last->voltage_V * last->voltage_V, way_back = at - p->voltage_V * p->voltage_V;
  return fall > 0 && (V * V - at) * fall > way_back * last->min_tension_N_per_m;
}

/* Steps of several voltages while the film has tension; what ends beyond, or would by the tension
 * so far, is halved from before.
 * *next: the first voltage that is not computed yet. */
static dea_status solve_upwards(struct run *run, size_t *next)
{
  const struct dea_force_line *asked = run->asked;
  size_t step = 1, beyond = run->line.count, before = 0;
  while (2 * step * FIRST_GAPS < run->line.count) {
    step *= 2;
  }
  *next = 0;
  DEA_TRY(run->ctx, solve(run, 0));
  *next = 1;
  if (!is_taut(&run->line.points[0])) {
    return DEA_OK;
  }
  DEA_TRY(run->ctx, keep_taut(run, 0));
  while (step > 0 && run->top + 1 < run->line.count) {
    size_t to = run->top + step < run->line.count ? run->top + step : run->line.count - 1;
    *next = run->top + 1;
    if (to >= beyond || (to > *next && ends_before(run, before, to))) {
      step /= 2;
      continue;
    }
    dea_status status = solve(run, to);
    if (status == DEA_OK && is_taut(&run->line.points[to])) {
      before = run->top;
      DEA_TRY(run->ctx, keep_taut(run, to));
      *next = to + 1;
    } else if (to == *next || (status != DEA_OK && dea_verdict_of(status)[0] == '\0')) {
      *next += status == DEA_OK ? 1 : 0; // by the step of a sweep: as it came
      return status;
    } else {
      dea_context_clear(run->ctx);
      run->line.computed[to] = false;
      beyond = to;
      DEA_TRY(run->ctx, dea_model_load(run->ctx, asked->type, asked->model, &run->taut));
    }
  }
  return DEA_OK;
}

/* All voltages from `from` on, one after the other. */
static dea_status solve_rest(struct run *run, size_t from)
{
  for (run->done = from; run->done < run->asked->count; run->done++) {
    DEA_TRY(run->ctx, solve(run, run->done));
  }
  return DEA_OK;
}

/* The voltages that are wanted, rising from the pressed tip. *good: false where a state between two
 * with tension has none, or is not found. */
static dea_status solve_between(struct run *run, bool *good)
{
  const struct dea_force_line *asked = run->asked;
  DEA_TRY(run->ctx, dea_model_load(run->ctx, asked->type, asked->model, asked->pressed));
  for (size_t k = 0; k < run->top && *good; k++) {
    if (run->wanted[k]) {
      dea_status status = solve(run, k);
      if (status != DEA_OK && dea_verdict_of(status)[0] == '\0') {
        return status;
      }
      dea_context_clear(run->ctx);
      *good = status == DEA_OK && is_taut(&run->line.points[k]);
    }
  }
  return DEA_OK;
}

/* Halves gaps until all that are left may be interpolated, and does that; where a state between is
 * none of the line, all voltages are computed one after the other. */
static dea_status fill(struct run *run)
{
  struct dea_sampled_line line = run->line;
  bool good = true;
  line.count = line.count < run->done ? line.count : run->done;
  while (line.count > 0 && dea_load_point_is_one_of_several(&line.points[line.count - 1])) {
    line.count--;
  }
  while (good && dea_sampled_line_halve(&line, run->asked->tolerance, run->wanted) > 0) {
    DEA_TRY(run->ctx, solve_between(run, &good));
  }
  run->filled = true;
  if (good) {
    dea_sampled_line_fill(&line);
    return DEA_OK;
  }
  DEA_TRY(run->ctx,
          dea_model_load(run->ctx, run->asked->type, run->asked->model, run->asked->pressed));
  return solve_rest(run, 0);
}

/* Goes all the way. A line that stops is filled up to there. */
static dea_status solve_all(struct run *run)
{
  char why[256];
  dea_status status = solve_upwards(run, &run->done);
  status = status == DEA_OK ? solve_rest(run, run->done) : status;
  if (status != DEA_OK && dea_verdict_of(status)[0] == '\0') {
    return status;
  }
  snprintf(why, sizeof why, "%s", status != DEA_OK ? dea_context_message(run->ctx) : "");
  dea_context_clear(run->ctx);
  DEA_TRY(run->ctx, fill(run));
  return status == DEA_OK || run->done == run->asked->count ? DEA_OK
                                                            : dea_fail(run->ctx, status, "%s", why);
}

static dea_status reserve(struct run *run)
{
  struct dea_context *ctx = run->ctx;
  size_t n = run->asked->count;
  DEA_TRY(ctx, dea_monitor_set_init(ctx, run->asked->type, run->asked->device, &run->seen));
  run->line.points = dea_arena_alloc(&run->seen.memory, n, sizeof *run->line.points);
  run->line.computed = dea_arena_alloc(&run->seen.memory, n, sizeof *run->line.computed);
  run->wanted = dea_arena_alloc(&run->seen.memory, n, sizeof *run->wanted);
  DEA_TRY(ctx, dea_arena_status(&run->seen.memory));
  for (size_t k = 0; k < n && run->seen.count > 0; k++) {
    run->line.points[k].monitors = dea_monitor_values_copy(&run->seen.memory, run->seen.values);
  }
  return dea_arena_status(&run->seen.memory);
}

static dea_status add_points(const struct run *run, struct dea_curve *curve)
{
  for (size_t k = 0; k < run->done; k++) {
    if (run->filled || run->line.computed[k]) {
      DEA_TRY(run->ctx, dea_curve_add_point(run->ctx, curve, &run->line.points[k]));
    }
  }
  return DEA_OK;
}

dea_status dea_force_line_compute(struct dea_context *ctx, const struct dea_force_line *asked,
                                  struct dea_curve *curve)
{
  struct run run = {.ctx = ctx, .asked = asked, .seen = {.memory = {.ctx = ctx}}};
  run.line.voltages_V = asked->voltages_V;
  run.line.count = rising(asked->voltages_V, asked->count);
  if (asked->tolerance <= 0 || asked->pressed == NULL || run.line.count <= 2 * FIRST_GAPS) {
    return dea_study_add_points(ctx, asked->type, asked->model, asked->device, asked->voltages_V,
                                asked->count, curve);
  }
  dea_status status = reserve(&run);
  if (status == DEA_OK) {
    status = solve_all(&run);
    dea_status added = add_points(&run, curve);
    status = status == DEA_OK ? added : status;
  }
  dea_state_free_values(ctx, &run.taut);
  dea_monitor_set_free(&run.seen);
  return status;
}
