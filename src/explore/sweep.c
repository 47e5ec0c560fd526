#include "explore/sweep.h"

#include "explore/pool.h"

#include <stdio.h>
#include <string.h>

struct work {
  const struct dea_question *question;
  const struct dea_sweep_options *options;
  struct dea_sweep_report *report;
  const struct dea_plan *plan;
  struct dea_store *store;
  size_t next; // case
};

static const double *numbers(const struct work *w, size_t i)
{
  return w->plan->p + i * w->question->variable_count;
}

static bool is_mine(const struct work *w, size_t i)
{
  const struct dea_shard *shard = &w->options->shard;
  return i % shard->parts == shard->part - 1;
}

/* The next case of this shard that is not done. */
static bool next_case(void *user, struct dea_case *out)
{
  struct work *w = user;
  while (w->next < w->plan->count &&
         (!is_mine(w, w->next) || dea_store_find(w->store, numbers(w, w->next)) != NULL)) {
    w->next++;
  }
  if (w->next == w->plan->count) {
    return false;
  }
  out->number = w->next;
  memcpy(out->p, numbers(w, w->next), w->question->variable_count * sizeof *out->p);
  w->next++;
  return true;
}

static dea_status keep(void *user, const struct dea_case *done)
{
  struct work *w = user;
  DEA_TRY(w->question->ctx, dea_store_add(w->store, done));
  w->report->now++;
  dea_progress(w->question->ctx, "designs", w->report->before + w->report->now,
               w->report->of_shard);
  return DEA_OK;
}

static dea_status evaluate(struct work *w)
{
  struct dea_pool *pool;
  for (size_t i = 0; i < w->plan->count; i++) {
    w->report->of_shard += is_mine(w, i) ? 1U : 0U;
    w->report->before += is_mine(w, i) && dea_store_find(w->store, numbers(w, i)) != NULL ? 1U : 0U;
  }
  DEA_TRY(w->question->ctx,
          dea_pool_create(w->question->ctx, &w->question->evaluator, w->options->processes, &pool));
  dea_status status = dea_pool_run(pool, next_case, keep, w);
  dea_pool_destroy(pool);
  return status;
}

/* How much of the plan is there, and what of it failed most often. */
static void count(struct work *w)
{
  struct dea_sweep_report *report = w->report;
  const struct dea_case *last = NULL;
  for (size_t i = 0; i < w->plan->count; i++) {
    const struct dea_case *done = dea_store_find(w->store, numbers(w, i));
    report->there += done != NULL ? 1U : 0U;
    if (done == NULL || done->why[0] == '\0') {
      continue;
    }
    report->failed++;
    if (report->why_count == 0) { // a majority vote: exact where one reason has more than half
      last = done;
    }
    report->why_count += strncmp(done->why, last->why, 40) == 0 ? 1U : 0U;
  }
  snprintf(report->why, sizeof report->why, "%s", last != NULL ? last->why : "");
  report->planned = w->plan->count;
  report->torn = dea_store_torn(w->store);
}

static dea_status run(struct work *w)
{
  struct dea_context *ctx = w->question->ctx;
  const struct dea_sweep_options *options = w->options;
  if (options->force) {
    DEA_TRY(ctx, dea_store_remove(ctx, options->folder));
  }
  DEA_TRY(ctx, dea_store_open(ctx, options->folder, w->question->hash, &w->question->evaluator,
                              options->merge ? NULL : &options->shard, &w->store));
  dea_status status = options->merge ? DEA_OK : evaluate(w);
  char message[512];
  snprintf(message, sizeof message, "%.511s", dea_context_message(ctx));
  count(w);
  if (status != DEA_E_MEMORY && (options->merge || options->shard.parts == 1)) {
    DEA_TRY(ctx, dea_sweep_write(w->question, w->plan, w->store, options->folder));
  }
  return status == DEA_OK ? DEA_OK : dea_fail(ctx, status, "%s", message);
}

dea_status dea_sweep_run(const struct dea_question *question,
                         const struct dea_sweep_options *options, struct dea_sweep_report *report)
{
  struct dea_plan plan;
  *report = (struct dea_sweep_report){0};
  DEA_TRY(question->ctx, dea_plan_make(question, &plan));
  struct work w = {question, options, report, &plan, NULL, 0};
  dea_status status = run(&w);
  dea_store_close(w.store);
  dea_free(question->ctx, plan.p);
  return status;
}
