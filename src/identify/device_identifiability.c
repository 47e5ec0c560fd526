/* What a fit of a device says beyond its numbers: parameters that its curves do not tell apart, and
 * the measurement that would. */
#include "identify/device_fit.h"
#include "identify/information.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double close_correlation = 0.95; // of two parameters that are told

void dea_device_fit_destroy(struct dea_context *ctx, struct dea_device_fit *fit)
{
  if (fit != NULL) {
    dea_lsq_statistics_free(&fit->statistics);
    dea_lsq_free(&fit->least_squares);
    dea_text_free(&fit->design);
    dea_arena_free(&fit->memory);
    dea_free(ctx, fit);
  }
}

/* ---- the next measurement ---- */

static size_t place_of(const struct dea_information *of, size_t param)
{
  size_t a = 0;
  while (a < of->count && of->active[a] != param) {
    a++;
  }
  return a;
}

/* What a candidate does for each pair. */
static void help_pairs(struct dea_device_fit *fit, const struct dea_information *base,
                       const double *before, const double *after, const char *what)
{
  for (size_t k = 0; k < fit->pair_count; k++) {
    struct dea_device_pair *pair = &fit->pairs[k];
    const size_t a = place_of(base, pair->first), b = place_of(base, pair->second);
    if (a == base->count || b == base->count) {
      continue;
    }
    const double shrink = sqrt(fmax(after[a] / before[a], after[b] / before[b]));
    if (shrink < 0.7 && (pair->next[0] == '\0' || shrink < pair->shrink)) {
      snprintf(pair->next, sizeof pair->next, "%s", what);
      pair->shrink = shrink;
    }
  }
}

/* ---- pairs ---- */

static void add_pair(struct dea_device_fit *fit, size_t a, size_t b, double correlation)
{
  if (fit->pair_count < DEA_DEVICE_PAIRS_MAX) {
    fit->pairs[fit->pair_count++] =
        (struct dea_device_pair){.first = a, .second = b, .correlation = correlation};
  }
}

/* Pairs that correlate, and parameters that one open direction moves together. */
static void find_pairs(struct dea_device_fit *fit)
{
  const struct dea_lsq_statistics *s = &fit->statistics;
  for (size_t a = 0; a < s->params; a++) {
    for (size_t b = 0; b < a; b++) {
      const double correlation = s->correlation[a * s->params + b];
      if (isfinite(s->std[a]) && isfinite(s->std[b]) && fabs(correlation) > close_correlation) {
        add_pair(fit, b, a, correlation);
      }
    }
  }
  for (size_t k = s->active; k-- > 0;) {
    const double *direction = s->direction + k * s->params;
    double largest[2] = {0, 0};
    size_t index[2] = {0, 0};
    if (s->singular[k] > 1e-9 * s->singular[0]) {
      break;
    }
    for (size_t j = 0; j < s->params; j++) {
      const double share = fabs(direction[j] / fit->params[j].param.scale);
      if (share > largest[0]) {
        largest[1] = largest[0];
        index[1] = index[0];
        largest[0] = share;
        index[0] = j;
      } else if (share > largest[1]) {
        largest[1] = share;
        index[1] = j;
      }
    }
    if (largest[1] > 1e-3 * largest[0]) {
      const bool in_order = index[0] < index[1];
      add_pair(fit, index[in_order ? 0 : 1], index[in_order ? 1 : 0], NAN);
    }
  }
}

dea_status dea_device_identify(struct dea_context *ctx, struct dea_device_fit *fit,
                               const struct dea_device_candidate *candidates, size_t count)
{
  struct dea_information base, now;
  double scale[DEA_DEVICE_PARAMS_MAX];
  double before[DEA_DEVICE_PARAMS_MAX], after[DEA_DEVICE_PARAMS_MAX];
  struct dea_fit_param params[DEA_DEVICE_PARAMS_MAX];
  (void)ctx;
  for (size_t j = 0; j < fit->param_count; j++) {
    params[j] = fit->params[j].param;
    scale[j] = params[j].scale;
  }
  fit->weak_count = dea_fit_identify_weak(params, &fit->statistics, "curves", fit->weak);
  find_pairs(fit);
  if (fit->statistics.active == 0 || !isfinite(fit->statistics.variance)) {
    return DEA_OK;
  }
  dea_information_start(&fit->least_squares, fit->statistics.variance, scale, &base);
  const double without = dea_information_factor(&base, before);
  for (size_t c = 0; c < count; c++) {
    now = base;
    dea_information_add(&now, candidates[c].J, candidates[c].rows, 1);
    const double gain = dea_information_factor(&now, after) - without;
    dea_fit_next_add(fit->next, &fit->next_count, candidates[c].what,
                     exp(-0.5 * gain / (double)base.count));
    help_pairs(fit, &base, before, after, candidates[c].what);
  }
  return DEA_OK;
}
