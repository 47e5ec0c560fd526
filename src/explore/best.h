/* dea optimise: the best of a design space, or front, with its files. */
#pragma once

#include "explore/design_space.h"
#include "explore/optimise.h"
#include "plot/plot.h"

struct dea_optimise_options {
  const char *folder;
  size_t processes;
  bool force; // throw away what is there
  struct dea_plot_format format;
};

struct dea_optimise_report {
  struct dea_optimum optima[DEA_EXPLORE_FRONT_MAX]; // one, or the front
  size_t count;
  size_t before, evaluations, failed;   // kept before, and now in all; without all values
  size_t scattered;                     // designs that stand for one; 1: without scatter
  bool gradients;                       // the model's own, and at so many designs differences
  size_t replaced[DEA_CASE_PARAMS_MAX]; // in their place, by each variable
};

/* Whether a variable of an optimum is at a bound of its range: "lower", "upper", or NULL. Not of
 * one that takes values alone. */
const char *dea_optimum_bound(const struct dea_design_space *space, const struct dea_optimum *best,
                              size_t variable);

/* Searches and writes cases.csv and cases.h5 of all evaluations, the figure progress, best.yaml (of
 * a front best-1.yaml, ...), and of a front front.csv and its figure. Tables and figures are there
 * after an interruption too. Findings and DEA_E_DESIGN where the file asks for nothing. */
dea_status dea_optimise_run(const struct dea_design_space *space,
                            const struct dea_optimise_options *options,
                            struct dea_optimise_report *report);
