/* A fit of life tests: the specimens as they are read, and Weibull's law of their lives. */
#pragma once

#include "base/arena.h"
#include "identify/life_file.h"
#include "identify/weibull.h"

struct dea_life_fit {
  struct dea_arena memory;          // the first member
  const struct dea_life_file *file; // lent
  size_t rows, failed;
  struct dea_life *lives; // [rows]; clocks that are not known are NAN
  double *value;          // [rows] of the chosen clock, SI
  bool *survived;         // [rows]
  bool has_law;           // false: fewer than two failures
  struct dea_weibull_fit fit;
};

/* Words for why a life ended: "survived", "stroke", ... */
extern const char *const dea_life_end_names[];

/* Reads the tables life.csv of the specimens' folders, judges and fits. What is wrong becomes
 * findings with file and line; DEA_E_IO then. out: owned by the caller, NULL on failure. */
dea_status dea_life_fit_run(struct dea_context *ctx, const struct dea_life_file *file,
                            struct dea_life_fit **out);
void dea_life_fit_destroy(struct dea_context *ctx, struct dea_life_fit *fit);

/* Least share of specimens of which it is 95 % certain that fewer have failed by the shortest
 * survived life, where none has failed: 1 - 0.05^(1/n). */
double dea_life_fit_bound(const struct dea_life_fit *fit, double *life);
