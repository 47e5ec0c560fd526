#include "explore/order.h"

#include <math.h>
#include <stdlib.h>

enum { GROUP = 40 };                // one of them is solved from rest, and what is near is quick
static const double whole_wide = 4; // a whole number's range counts so many times: another mesh

struct item {
  double value;
  size_t number;
};

struct work {
  const double *p;
  size_t params, group;
  double scale[DEA_CASE_PARAMS_MAX]; // 1 over the range of all
  struct item *items;                // [count] of the part that is split
  struct dea_order *out;
};

static int compare(const void *a, const void *b)
{
  const struct item *x = a, *y = b;
  return x->value < y->value   ? -1
         : x->value > y->value ? 1
                               : (x->number > y->number) - (x->number < y->number);
}

/* Range of a parameter over cases of the order. */
static double range(const struct work *w, size_t j, size_t from, size_t count, double *low)
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
static void close_group(struct work *w, size_t from, size_t count)
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
static void split(struct work *w, size_t from, size_t count)
{
  size_t widest = 0;
  double most = -1;
  if (count <= w->group) {
    close_group(w, from, count);
    return;
  }
  for (size_t j = 0; j < w->params; j++) {
    double low;
    const double wide = w->scale[j] * range(w, j, from, count, &low);
    if (wide > most) {
      most = wide;
      widest = j;
    }
  }
  for (size_t i = 0; i < count; i++) {
    const size_t number = w->out->cases[from + i];
    w->items[i] = (struct item){w->p[number * w->params + widest], number};
  }
  qsort(w->items, count, sizeof *w->items, compare);
  for (size_t i = 0; i < count; i++) {
    w->out->cases[from + i] = w->items[i].number;
  }
  split(w, from, count / 2);
  split(w, from + count / 2, count - count / 2);
}

dea_status dea_order_of(struct dea_context *ctx, const double *p, size_t count, size_t params,
                        const bool *whole, size_t group, struct dea_order *out)
{
  *out = (struct dea_order){.group = group};
  out->cases = dea_alloc(ctx, count, sizeof *out->cases);
  out->first = dea_alloc(ctx, count, sizeof *out->first);
  struct item *items = dea_alloc(ctx, count, sizeof *items);
  if (out->cases == NULL || out->first == NULL || items == NULL) {
    dea_free(ctx, items);
    dea_order_free(ctx, out);
    return DEA_E_MEMORY;
  }
  for (size_t i = 0; i < count; i++) {
    out->cases[i] = out->first[i] = i;
  }
  if (group > 1) {
    struct work w = {.p = p, .params = params, .group = group, .items = items, .out = out};
    for (size_t j = 0; j < params; j++) {
      double low;
      const double wide = range(&w, j, 0, count, &low);
      w.scale[j] = wide > 0 ? (whole[j] ? whole_wide : 1) / wide : 0;
    }
    split(&w, 0, count);
  }
  dea_free(ctx, items);
  return DEA_OK;
}

dea_status dea_order_build(const struct dea_case_key *case_key, const struct dea_plan *plan,
                           struct dea_order *out)
{
  bool whole[DEA_CASE_PARAMS_MAX];
  for (size_t j = 0; j < case_key->variable_count; j++) {
    whole[j] = case_key->params[j].whole;
  }
  const bool warms = // they may begin from each other
      case_key->model.type->load != NULL && case_key->file->begin.value == DEA_BEGIN_NEAREST;
  return dea_order_of(case_key->ctx, plan->p, plan->count, case_key->variable_count, whole,
                      warms ? GROUP : 1, out);
}

void dea_order_free(struct dea_context *ctx, struct dea_order *order)
{
  dea_free(ctx, order->cases);
  dea_free(ctx, order->first);
  *order = (struct dea_order){0};
}
