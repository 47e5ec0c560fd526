/* A file of `dea sweep` and `dea optimise`: a design, the values of it that change, and what is
 * asked of each of the designs (docs/explore.md). */
#pragma once

#include "identify/device_file.h"

enum {
  DEA_EXPLORE_VERSION = 1,
  DEA_EXPLORE_VALUES_MAX = 64, // of a variable
  DEA_EXPLORE_VOLTAGES_MAX = 32,
  DEA_EXPLORE_QUANTITIES_MAX = 8,
  DEA_EXPLORE_LIMITS_MAX = 8,
  DEA_EXPLORE_OBJECTIVES_MAX = 2,
  DEA_EXPLORE_SCATTERED_MAX = 256,
  DEA_EXPLORE_FRONT_MAX = 100, // points of a front
  DEA_EXPLORE_PAIRS_MAX = DEA_DEVICE_PARAMS_MAX * (DEA_DEVICE_PARAMS_MAX - 1) / 2,
  DEA_EXPLORE_CASES_MAX = 10000000,
};

enum dea_distribution { DEA_UNIFORM, DEA_NORMAL, DEA_LOGNORMAL };
enum dea_plan_kind {
  DEA_PLAN_GRID,
  DEA_PLAN_SPARSE,
  DEA_PLAN_SOBOL,
  DEA_PLAN_RANDOM,
  DEA_PLAN_INDICES,
};

enum dea_begin { DEA_BEGIN_NEAREST, DEA_BEGIN_REST };
enum dea_goal { DEA_MOST, DEA_LEAST };
enum dea_slopes { DEA_SLOPES_MODEL, DEA_SLOPES_DIFFERENCES };
enum dea_method { DEA_SLSQP, DEA_MMA, DEA_COBYLA, DEA_RANDOM };

/* A variable as written. The prior of `text` is the mean of its distribution. */
struct dea_explore_variable {
  struct dea_fit_parameter_text text; // first: its name
  struct dea_label values[DEA_EXPLORE_VALUES_MAX];
  size_t value_count;
  struct dea_quantity steps;
  struct dea_label also[DEA_DEVICE_TIES_MAX]; // other numbers that take the same value
  size_t also_count;
  struct dea_choice distribution; // enum dea_distribution
  struct dea_label scatter;       // of a search: what the workshop misses it by
};

/* What a quantity may not cross. */
struct dea_explore_limit {
  struct dea_label quantity, above, below;
};

struct dea_explore_objective {
  struct dea_label quantity;
  struct dea_choice goal; // enum dea_goal
};

/* How a search looks at designs that scatter. */
struct dea_explore_robust {
  struct dea_quantity samples, spread, quantile; // spread or quantile
};

struct dea_explore_file {
  struct dea_fit_head head;
  struct dea_label design, model;
  struct dea_quantity voltages_V[DEA_EXPLORE_VOLTAGES_MAX];
  size_t voltage_count;
  struct dea_label quantities[DEA_EXPLORE_QUANTITIES_MAX];
  size_t quantity_count;
  struct dea_explore_variable variables[DEA_DEVICE_PARAMS_MAX];
  size_t variable_count;
  struct dea_label from_fit; // folder of a fit, whose parameters are variables too
  struct dea_quantity correlations[DEA_EXPLORE_PAIRS_MAX]; // 2 with 1, 3 with 1, 3 with 2, ...
  size_t correlation_count;                                // 0: none correlate
  struct dea_choice plan;                                  // enum dea_plan_kind
  struct dea_quantity samples, seed, level;
  struct dea_choice begin; // enum dea_begin
  struct dea_explore_limit limits[DEA_EXPLORE_LIMITS_MAX];
  size_t limit_count;
  struct dea_explore_objective objectives[DEA_EXPLORE_OBJECTIVES_MAX];
  size_t objective_count;
  struct dea_choice method;    // enum dea_method
  struct dea_choice gradients; // enum dea_slopes
  struct dea_quantity starts, evaluations, tolerance, front;
  struct dea_explore_robust robust;
};

extern const struct dea_fit_form dea_explore_form;

/* Findings where numbers cannot have the file's correlations. */
dea_status dea_explore_correlations_check(struct dea_context *ctx,
                                          const struct dea_explore_file *file);
