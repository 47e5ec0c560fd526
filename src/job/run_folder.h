/* The run folder: results.h5, summary.json, CSV tables, design.yaml, figures/, fields/. */
#pragma once

#include "result/result.h"

struct dea_run_folder_options {
  bool force;      // replace results that are there
  bool no_figures; // neither scripts nor pictures
  bool started;    // the folder was prepared and cleared for this run; what it has kept stays
};

/* To be asked before a long run: DEA_E_IO when the folder holds results, or other files of
 * their names, and force is not set, or when it cannot be made. Makes the folder. */
dea_status dea_run_folder_prepare(struct dea_context *ctx, const char *directory, bool force);

/* Removes the files of the run that results.h5 in the folder describes, so that none of them is
 * taken for one of a new run. What cannot be read is left: the writer replaces the names it uses.
 */
void dea_run_folder_clear(struct dea_context *ctx, const char *directory);

/* Whether the folder holds a run of the same design file, of the same title. */
bool dea_run_folder_is_of(struct dea_context *ctx, const char *directory,
                          const struct dea_design *design);

/* Clears a folder, as above, and moves all that is in the folder `by` into it; `by` goes. Both lie
 * in one file system. DEA_E_IO. */
dea_status dea_run_folder_replace(struct dea_context *ctx, const char *directory, const char *by);

/* Writes everything of a result, each file as a whole; with force the files of the run that was
 * there go first (other files stay). options: NULL for none. The tables are written before the
 * figures, so that a missing gnuplot (DEA_E_TOOL) costs the pictures only. Pictures are drawn in
 * the formats and the width of the design's report section. */
dea_status dea_run_folder_write(struct dea_context *ctx, const struct dea_result *result,
                                const char *directory,
                                const struct dea_run_folder_options *options);

/* The name of the folder of figures within a run folder. */
#define DEA_FIGURE_FOLDER "figures"
