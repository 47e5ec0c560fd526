/* A sweep on a cluster that runs Slurm: an array of jobs, one a part, and one that collects. */
#pragma once

#include "base/context.h"

struct dea_slurm_options {
  const char *program; // path of the command dea, the same on every node
  const char *file;    // of the sweep
  const char *folder;  // which every node sees
  size_t parts;        // jobs of the array
  size_t processes;    // designs at once in each job
};

/* Writes FOLDER/array.sh and FOLDER/merge.sh and submits both, the second to begin after all jobs
 * of the first, however they ended. A job whose node fails is queued again and goes on. Numbers of
 * the jobs into array and merge. DEA_E_TOOL where there is no sbatch or it refuses. */
dea_status dea_slurm_submit(struct dea_context *ctx, const struct dea_slurm_options *options,
                            char array[32], char merge[32]);
