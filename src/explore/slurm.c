#include "explore/slurm.h"

#include "base/program.h"
#include "base/write_file.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

static const double limit_s = 60; // of a submission

/* A word of a shell's line. */
static void add_word(struct dea_text *out, const char *word)
{
  dea_text_add(out, " '");
  for (const char *c = word; *c != '\0'; c++) {
    dea_text_add(out, *c == '\'' ? "'\\''" : "%c", *c);
  }
  dea_text_add(out, "'");
}

/* A script that calls the program for the sweep. head: options of sbatch; tail: of the program. */
static dea_status write_script(struct dea_context *ctx, const struct dea_slurm_options *options,
                               const char *name, const char *head, const char *tail)
{
  struct dea_text out = {.ctx = ctx};
  dea_text_add(&out, "#!/bin/sh\n%sexec", head);
  add_word(&out, options->program);
  dea_text_add(&out, " sweep");
  add_word(&out, options->file);
  dea_text_add(&out, " --quiet -o");
  add_word(&out, options->folder);
  dea_text_add(&out, " %s\n", tail);
  return dea_text_write(ctx, &out, options->folder, name);
}

/* Submits a script; its job's number into job. */
static dea_status submit(struct dea_context *ctx, const char *folder, const char *name,
                         const char *dependency, char job[32])
{
  struct dea_program program;
  char said[DEA_PROGRAM_SAID], option[64];
  int number;
  char script[DEA_PATH_SIZE];
  DEA_TRY(ctx, dea_path_build(ctx, folder, name, script));
  snprintf(option, sizeof option, "--dependency=afterany:%s", dependency);
  char *const with[] = {(char *)"sbatch", (char *)"--parsable", option, script, NULL};
  char *const without[] = {(char *)"sbatch", (char *)"--parsable", script, NULL};
  const int reason = dea_program_start(dependency[0] != '\0' ? with : without, ".", true, &program);
  if (reason != 0) {
    return dea_fail(ctx, DEA_E_TOOL, "sbatch, the program of Slurm, is not here: %s",
                    strerror(reason));
  }
  if (dea_program_wait(ctx, &program, limit_s, said, &number) != DEA_PROGRAM_DONE) {
    return dea_fail(ctx, DEA_E_TOOL, "sbatch failed: %.300s", dea_last_lines(said, 3));
  }
  const char *line = dea_last_lines(said, 1); // "123" or "123;cluster"
  size_t length = 0;
  while (isdigit((unsigned char)line[length]) && length < 31) {
    length++;
  }
  snprintf(job, 32, "%.*s", (int)length, line);
  return length > 0 ? DEA_OK : dea_fail(ctx, DEA_E_TOOL, "sbatch gave no job: %.300s", said);
}

dea_status dea_slurm_submit(struct dea_context *ctx, const struct dea_slurm_options *options,
                            char array[32], char merge[32])
{
  char head[256], tail[112];
  DEA_TRY(ctx, dea_folder_create(ctx, options->folder));
  snprintf(head, sizeof head,
           "#SBATCH --job-name=dea-sweep\n#SBATCH --array=1-%zu\n#SBATCH --cpus-per-task=%zu\n"
           "#SBATCH --requeue\n#SBATCH --output=/dev/null\n",
           options->parts, options->processes);
  snprintf(tail, sizeof tail, "-j %zu --shard \"$SLURM_ARRAY_TASK_ID/%zu\"", options->processes,
           options->parts);
  DEA_TRY(ctx, write_script(ctx, options, "array.sh", head, tail));
  DEA_TRY(ctx, write_script(ctx, options, "merge.sh",
                            "#SBATCH --job-name=dea-merge\n#SBATCH --requeue\n"
                            "#SBATCH --output=/dev/null\n",
                            "--merge"));
  DEA_TRY(ctx, submit(ctx, options->folder, "array.sh", "", array));
  return submit(ctx, options->folder, "merge.sh", array, merge);
}
