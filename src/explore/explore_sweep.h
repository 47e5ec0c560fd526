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
dea_status dea_sweep_run(const struct dea_case_key *case_key,
                         const struct dea_sweep_options *options, struct dea_sweep_report *report);

/* Figures band_KEY of spreads [voltages][quantities] of so many samples, into a folder. doubted:
 * [voltages], samples whose numbers are not to be trusted there. */
struct dea_spread;
dea_status dea_sweep_draw(const struct dea_case_key *case_key, const struct dea_spread *spreads,
                          size_t samples, const size_t *doubted,
                          const struct dea_plot_format *format, const char *folder);
/* Of a sparse grid that is done: emulator.json into a folder, and the CSV of options.at. */
dea_status dea_sweep_emulate(const struct dea_case_key *case_key, const struct dea_plan *plan,
                             const struct dea_store *store, const struct dea_sweep_options *options,
                             char **at);
/* The tables of a plan's cases as far as they are done, and figures of the format, into a folder.
 */
dea_status dea_sweep_write(const struct dea_case_key *case_key, const struct dea_plan *plan,
                           const struct dea_store *store, const struct dea_plot_format *format,
                           const char *folder);
