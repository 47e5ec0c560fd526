#define _GNU_SOURCE // qsort_r
#include "explore/explore_sweep.h"

#include "explore/pool.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The order of evaluation -------------------------------------------------------------------------

enum { GROUP = 40 };                // one of them is solved from rest, and what is near is quick
static const double whole_wide = 4; // a whole number's range counts so many times: another mesh

struct splitting {
  const double *p;
  size_t params;
  double scale[DEA_CASE_PARAMS_MAX]; // 1 over the range of all
  size_t widest;                     // parameter of the part that is split
  struct dea_order *out;
};

/* Cases by their widest parameter. */
static int compare(const void *a, const void *b, void *user)
{
  const struct splitting *w = user;
  const size_t i = *(const size_t *)a, k = *(const size_t *)b;
  const double x = w->p[i * w->params + w->widest], y = w->p[k * w->params + w->widest];
  return x < y ? -1 : x > y ? 1 : (i > k) - (i < k);
}

/* Range of a parameter over cases of the order. */
static double range(const struct splitting *w, size_t j, size_t from, size_t count, double *low)
{
  double high = -INFINITY;
  *low = INFINITY;
  for (size_t i = from; i < from + count; i++) {
    const double value = w->p[w->out->cases[i] * w->params + j];
    *low = fmin(*low, value);
    high = fmax(high, value);
  }
  return high - *low;
}

/* A group: the case nearest to its middle comes first, and the others begin from it. */
static void close_group(struct splitting *w, size_t from, size_t count)
{
  double middle[DEA_CASE_PARAMS_MAX], least = INFINITY;
  size_t nearest = from;
  for (size_t j = 0; j < w->params; j++) {
    double low;
    const double wide = range(w, j, from, count, &low);
    middle[j] = low + 0.5 * wide;
  }
  for (size_t i = from; i < from + count; i++) {
    double far = 0;
    for (size_t j = 0; j < w->params; j++) {
      const double off = w->scale[j] * (w->p[w->out->cases[i] * w->params + j] - middle[j]);
      far += off * off;
    }
    if (far < least) {
      least = far;
      nearest = i;
    }
  }
  const size_t first = w->out->cases[nearest];
  w->out->cases[nearest] = w->out->cases[from];
  w->out->cases[from] = first;
  for (size_t i = from; i < from + count; i++) {
    w->out->first[i] = first;
  }
}

/* Halves a part of the order across its widest parameter, down to groups. */
static void split(struct splitting *w, size_t from, size_t count)
{
  double most = -1;
  if (count <= w->out->group) {
    close_group(w, from, count);
    return;
  }
  for (size_t j = 0; j < w->params; j++) {
    double low;
    const double wide = w->scale[j] * range(w, j, from, count, &low);
    if (wide > most) {
      most = wide;
      w->widest = j;
    }
  }
  qsort_r(w->out->cases + from, count, sizeof *w->out->cases, compare, w);
  split(w, from, count / 2);
  split(w, from + count / 2, count - count / 2);
}

dea_status dea_order_of(struct dea_arena *memory, const double *p, size_t count, size_t params,
                        const bool *whole, size_t group, struct dea_order *out)
{
  *out = (struct dea_order){.group = group};
  out->cases = dea_arena_alloc(memory, count, sizeof *out->cases);
  out->first = dea_arena_alloc(memory, count, sizeof *out->first);
  DEA_TRY_MEMORY(!memory->failed);
  for (size_t i = 0; i < count; i++) {
    out->cases[i] = out->first[i] = i;
  }
  if (group > 1) {
    struct splitting w = {.p = p, .params = params, .out = out};
    for (size_t j = 0; j < params; j++) {
      double low;
      const double wide = range(&w, j, 0, count, &low);
      w.scale[j] = wide > 0 ? (whole[j] ? whole_wide : 1) / wide : 0;
    }
    split(&w, 0, count);
  }
  return DEA_OK;
}

// The evaluation ----------------------------------------------------------------------------------

enum { SHARES = 8 }; // blocks of a shard, at least, where there are so many cases

/* Places [next, end) of the order that a process works at. */
struct stretch {
  size_t next, end;
};

struct work {
  const struct dea_design_space *space;
  const struct dea_sweep_options *options;
  struct dea_sweep_report *report;
  struct dea_plan plan;
  struct dea_arena memory;
  struct dea_order order;
  struct dea_store *store;
  struct stretch *stretches; // [processes]
  struct stretch rest;       // that nobody has got
  size_t block;              // places of a shard between those of others
};

static const double *numbers(const struct work *w, size_t i)
{
  return w->plan.p + i * w->space->variable_count;
}

/* Whether a place of the order is of this shard: blocks of it go round. */
static bool is_mine(const struct work *w, size_t place)
{
  const struct dea_shard *shard = &w->options->shard;
  return place / w->block % shard->parts == shard->part - 1;
}

static bool is_open(const struct work *w, size_t place)
{
  return is_mine(w, place) && dea_store_find(w->store, numbers(w, w->order.cases[place])) == NULL;
}

/* The longest stretch gives its second half away. */
static void share(struct work *w, struct stretch *own)
{
  struct stretch *longest = own;
  for (size_t k = 0; k < w->options->processes; k++) {
    struct stretch *other = &w->stretches[k];
    longest = other->end - other->next > longest->end - longest->next ? other : longest;
  }
  *own = (struct stretch){longest->end - (longest->end - longest->next + 1) / 2, longest->end};
  longest->end = own->next;
}

/* Whether a stretch has a place that is open; goes on to that. */
static bool find_open(const struct work *w, struct stretch *on)
{
  while (on->next < on->end && !is_open(w, on->next)) {
    on->next++;
  }
  return on->next < on->end;
}

/* Moves a process to its next place that is open: on its stretch, else on a group that nobody has
 * got, else on a share of another's. false: there is none. */
static bool move_on(struct work *w, struct stretch *own)
{
  while (!find_open(w, own)) {
    if (find_open(w, &w->rest)) {
      const size_t *first = w->order.first, begin = w->rest.next;
      while (w->rest.next < w->rest.end && first[w->rest.next] == first[begin]) {
        w->rest.next++;
      }
      *own = (struct stretch){begin, w->rest.next};
    } else {
      share(w, own);
      if (own->next == own->end) {
        return false;
      }
    }
  }
  return true;
}

/* The next case of this shard that is not done: neighbours to the same process. */
static bool next_case(void *user, struct dea_case *out)
{
  struct work *w = user;
  struct stretch *own = &w->stretches[out->process];
  if (!move_on(w, own)) {
    return false;
  }
  const size_t i = w->order.cases[own->next], size = w->space->variable_count * sizeof *out->p;
  const double *near = numbers(w, w->order.first[own->next]);
  const struct dea_case *done = dea_store_find(w->store, near);
  out->number = i;
  memcpy(out->p, numbers(w, i), size);
  memcpy(out->near, near, size);
  // nobody begins where one has failed, perhaps with its process
  out->has_near = w->order.group > 1 && (done == NULL || done->why[0] == '\0');
  own->next++;
  return true;
}

static dea_status keep(void *user, const struct dea_case *done)
{
  struct work *w = user;
  DEA_TRY(w->space->ctx, dea_store_add(w->store, done));
  w->report->now++;
  dea_progress(w->space->ctx, "designs", w->report->before + w->report->now, w->report->of_shard);
  return DEA_OK;
}

static dea_status evaluate_all(struct work *w)
{
  struct dea_pool *pool;
  for (size_t i = 0; i < w->plan.count; i++) {
    if (is_mine(w, i)) {
      w->report->of_shard++;
      w->report->before += is_open(w, i) ? 0U : 1U;
    }
  }
  DEA_TRY(w->space->ctx,
          dea_pool_create(w->space->ctx, &w->space->evaluator, w->options->processes, &pool));
  dea_status status = dea_pool_run(pool, next_case, keep, w);
  dea_pool_destroy(pool);
  return status;
}

/* Evaluates what is open, groups after each other. */
static dea_status evaluate(struct work *w)
{
  const struct dea_design_space *space = w->space;
  bool whole[DEA_CASE_PARAMS_MAX];
  for (size_t j = 0; j < space->variable_count; j++) {
    whole[j] = space->params[j].whole;
  }
  const bool warms = // they may begin from each other
      space->model.type->load != NULL && space->file->begin.value == DEA_BEGIN_NEAREST;
  // of the plan alone: the same whatever is done, and however many processes do it
  DEA_TRY(space->ctx, dea_order_of(&w->memory, w->plan.p, w->plan.count, space->variable_count,
                                   whole, warms ? GROUP : 1, &w->order));
  w->block = w->plan.count / (SHARES * w->options->shard.parts);
  w->block = w->block < 1 ? 1 : w->block > w->order.group ? w->order.group : w->block;
  w->rest.end = w->plan.count;
  w->stretches = dea_arena_alloc(&w->memory, w->options->processes, sizeof *w->stretches);
  return w->stretches != NULL ? evaluate_all(w) : DEA_E_MEMORY;
}

/* Adds what a case's numbers are flagged with. */
static void count_flags(const struct dea_design_space *space, const struct dea_case *done,
                        struct dea_sweep_report *report)
{
  for (size_t f = 0; f < DEA_FLAG_COUNT; f++) {
    size_t k = 0;
    while (k < space->voltage_count && (done->marks[k] >> f & 1U) == 0) {
      k++;
    }
    if (k < space->voltage_count) {
      const double from_V = space->voltages_V[k];
      report->flagged_from_V[f] =
          report->flagged[f] == 0 ? from_V : fmin(report->flagged_from_V[f], from_V);
      report->flagged[f]++;
    }
  }
}

/* Finds what of the plan is there, and why some of it failed. */
static void collect(struct work *w)
{
  struct dea_sweep_report *report = w->report;
  const struct dea_case *reason = NULL;
  size_t votes = 0; // Boyer and Moore's: a reason of more than half is left
  for (size_t i = 0; i < w->plan.count; i++) {
    const struct dea_case *done = w->plan.cases[i] = dea_store_find(w->store, numbers(w, i));
    if (done == NULL) {
      continue;
    }
    report->there++;
    count_flags(w->space, done, report);
    if (done->why[0] == '\0') {
      continue;
    }
    report->failed++;
    reason = votes == 0 ? done : reason;
    votes = strncmp(done->why, reason->why, 40) == 0 ? votes + 1 : votes - 1;
  }
  snprintf(report->why, sizeof report->why, "%s", reason != NULL ? reason->why : "");
  report->planned = w->plan.count;
  report->torn = dea_store_torn(w->store);
}

static dea_status run(struct work *w)
{
  struct dea_context *ctx = w->space->ctx;
  const struct dea_sweep_options *options = w->options;
  DEA_TRY(ctx, options->force ? dea_store_remove(ctx, options->folder) : DEA_OK);
  DEA_TRY(ctx, dea_store_open(ctx, options->folder, w->space->hash, &w->space->evaluator,
                              options->merge ? NULL : &options->shard, &w->store));
  dea_status status = options->merge ? DEA_OK : evaluate(w);
  char message[512];
  snprintf(message, sizeof message, "%.511s", dea_context_message(ctx));
  collect(w);
  if (status != DEA_E_MEMORY && (options->merge || options->shard.parts == 1)) {
    DEA_TRY(ctx, dea_sweep_write(w->space, &w->plan, &options->format, options->folder));
    w->report->written = true;
    if (w->plan.nodes == NULL && options->at_count > 0) {
      return dea_fail(ctx, DEA_E_DESIGN, "--at is of the plan sparse-grid");
    }
    if (w->plan.nodes != NULL && w->report->there == w->plan.count) {
      DEA_TRY(ctx, dea_sweep_emulate(w->space, &w->plan, options, &w->report->at));
    }
  }
  return status == DEA_OK ? DEA_OK : dea_fail(ctx, status, "%s", message);
}

dea_status dea_sweep_run(const struct dea_design_space *space,
                         const struct dea_sweep_options *options, struct dea_sweep_report *report)
{
  struct work w = {
      .space = space, .options = options, .report = report, .memory = {.ctx = space->ctx}};
  *report = (struct dea_sweep_report){0};
  dea_status status = dea_plan_build(&w.memory, space, &w.plan);
  status = status == DEA_OK ? run(&w) : status;
  dea_store_close(w.store);
  dea_arena_free(&w.memory);
  return status;
}
