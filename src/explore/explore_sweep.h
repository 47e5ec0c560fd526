/* Many designs: all cases of a plan, evaluated, kept, and written as tables. */
#pragma once

#include "explore/plan.h"
#include "explore/store.h"
#include "plot/plot.h"
#include "result/load_point.h"

struct dea_sweep_options {
  const char *folder;
  size_t processes;
  struct dea_shard shard; // which cases; {1, 1}: all
  bool force;             // throw away what is there
  bool merge;             // only write the tables of what is there
  struct dea_plot_format format;
  /* Values of variables at which the sparse grid is evaluated; without any it is not. */
  const struct dea_override *at; // [at_count]
  size_t at_count;
};

/* What a sweep comes to. */
struct dea_sweep_report {
  size_t planned, of_shard, before, now; // cases; done before and now
  size_t there, failed;                  // of the plan: done, and of these with a reason
  size_t torn;                           // lines that were not whole
  bool written;                          // the tables
  char why[DEA_CASE_WHY_SIZE];           // a reason, that of more than half if there is one; or ""
  /* Cases with each flag at some voltage, and the lowest such voltage. */
  size_t flagged[DEA_FLAG_COUNT];
  double flagged_from_V[DEA_FLAG_COUNT];
  char *at; // CSV of options.at; owned by the caller, NULL: none
};

/* Evaluates what of the plan is not in the folder yet and writes the tables of all that is there:
 * cases.csv, cases.h5, and of samples statistics.csv and indices.csv. After an interruption too. */
dea_status dea_sweep_run(const struct dea_design_space *space,
                         const struct dea_sweep_options *options, struct dea_sweep_report *report);

/* Of a sparse grid that is done: emulator.json into a folder, and the CSV of options.at. */
dea_status dea_sweep_emulate(const struct dea_design_space *space, const struct dea_plan *plan,
                             const struct dea_sweep_options *options, char **at);
/* The tables of a plan's cases as far as they are done, and figures of the format, into a folder.
 */
dea_status dea_sweep_write(const struct dea_design_space *space, const struct dea_plan *plan,
                           const struct dea_plot_format *format, const char *folder);

/* In which order cases are evaluated: neighbours after each other, in groups that begin from the
 * solution of one of them. */
struct dea_order {
  size_t *cases; // [count] numbers of cases in the order of evaluation
  size_t *first; // [count] for each place in that order the first case of its group, from which the
                 // others begin
  size_t group;  // most cases of a group; 1: each is one by itself, in the order of the plan
};

/* Order of points p [count][params] in groups of at most `group`; whole[j]: numbers of parameter j
 * are whole ones, which neighbours have in common. Memory of the arena. */
dea_status dea_order_of(struct dea_arena *memory, const double *p, size_t count, size_t params,
                        const bool *whole, size_t group, struct dea_order *out);

// What samples say: moments, quantiles, Sobol indices

enum { DEA_SHARES = 5 };
/* Quantiles that are given: 2.5, 16, 50, 84 and 97.5 %. */
extern const double dea_shares[DEA_SHARES];

struct dea_spread {
  size_t count; // of samples with a value
  double mean, std, quantile[DEA_SHARES];
};

/* Of values [count]; NAN are left out. DEA_E_MEMORY. */
dea_status dea_spread_find(struct dea_context *ctx, const double *values, size_t count,
                           struct dea_spread *out);

/* First and total index of a variable after Jansen (Comput. Phys. Commun. 117, 35, 1999), from
 * values [samples] at A, at B, and at A with this variable of B. Samples with a NAN are left out.
 */
void dea_sobol_index(const double *a, const double *b, const double *ab, size_t samples,
                     double *first, double *total);
