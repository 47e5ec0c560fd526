/* dea sweep: many designs that differ in some values. */
#define _DEFAULT_SOURCE // readlink
#include "cli/cli.h"

#include "explore/explore_sweep.h"
#include "explore/slurm.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

struct request {
  const char *file;
  double processes; // 0: not given
  double slurm;     // parts of an array of jobs; 0: none
  struct dea_sweep_options options;
  struct cli_overrides at;
  struct dea_plot_format format; // of the figures
};

static dea_status parse_shard(struct dea_cli *cli, const struct cli_option *option,
                              const char *text, void *target)
{
  struct dea_shard *shard = target;
  char after;
  const bool good = text[strspn(text, "0123456789/")] == '\0' &&
                    sscanf(text, "%6zu/%6zu%c", &shard->part, &shard->parts, &after) == 2;
  return good && shard->part >= 1 && shard->part <= shard->parts
             ? DEA_OK
             : cli_usage_error(cli, "--%s: '%.20s' is no part of parts such as 2/8", option->name,
                               text);
}

static void print_report(const struct dea_sweep_report *report, const struct request *request)
{
  if (report->at != NULL) { // a table by itself
    fputs(report->at, stdout);
    return;
  }
  printf("designs: %zu of %zu are there", report->there, report->planned);
  if (!request->options.merge) {
    printf(", %zu of them computed now", report->now);
  }
  printf("\n");
  if (report->torn > 0) {
    printf("lines that were cut off and are computed again: %zu\n", report->torn);
  }
  if (report->failed > 0) {
    printf("without all values: %zu (for example: %s)\n", report->failed, report->why);
  }
  for (unsigned f = 0; f < DEA_FLAG_COUNT; f++) {
    char line[DEA_FLAG_LINE_SIZE];
    if (report->flagged[f] > 0) {
      printf("%zu of them from %.6g kV on: %s\n", report->flagged[f],
             1e-3 * report->flagged_from_V[f], dea_flag_line((enum dea_flag)f, line));
    }
  }
  const bool part = request->options.shard.parts > 1 && !request->options.merge;
  if (part || report->written) {
    printf("written to %s%s\n", request->options.folder,
           part ? ": one part; --merge writes the tables" : " (cases.csv, cases.h5)");
  }
}

/* Hands the sweep to Slurm. */
static dea_status submit(struct dea_cli *cli, const struct request *request,
                         const struct dea_design_space *space)
{
  char array[32], merge[32], program[4096]; // the path that other computers have too
  const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
  program[length > 0 ? length : 0] = '\0';
  const struct dea_slurm_options options = {
      .program = length > 0 ? program : "dea",
      .file = request->file,
      .folder = request->options.folder,
      .parts = (size_t)request->slurm,
      .processes = request->processes > 0 ? (size_t)request->processes : 1,
  };
  DEA_TRY(cli->ctx, dea_plan_check(space));
  DEA_TRY(cli->ctx, dea_slurm_submit(cli->ctx, &options, array, merge));
  printf("job %s: an array of %zu parts; job %s: the tables, after all of them, in %s\n", array,
         options.parts, merge, options.folder);
  return DEA_OK;
}

static dea_status sweep(struct dea_cli *cli, const struct request *request)
{
  struct dea_design_space *space;
  struct dea_sweep_report report = {0};
  DEA_TRY(cli->ctx, dea_design_space_read(cli->ctx, request->file, &space));
  dea_status status = request->slurm > 0 ? submit(cli, request, space)
                                         : dea_sweep_run(space, &request->options, &report);
  if (report.planned > 0) {
    print_report(&report, request);
  }
  dea_free(cli->ctx, report.at);
  dea_design_space_destroy(space);
  return status;
}

static dea_status run(struct dea_cli *cli, void *user)
{
  struct request *request = user;
  if (request->options.force &&
      (request->options.merge || request->slurm > 0 || request->options.shard.parts > 1)) {
    return cli_usage_error(cli,
                           "--force throws away the cases of all parts: it does not go with %s; "
                           "remove part-*.csv of the folder before the first part begins",
                           request->options.merge ? "--merge"
                           : request->slurm > 0   ? "--slurm"
                                                  : "--shard");
  }
  request->options.format = request->format;
  request->options.at = request->at.at;
  request->options.at_count = request->at.count;
  request->options.processes = cli_processes(request->processes);
  DEA_TRY(cli->ctx, cli_output_name(cli, request->file, "sweep", &request->options.folder));
  return sweep(cli, request);
}

static const struct request defaults = {.options = {.shard = {1, 1}},
                                        .format = {.svg = true, .width_m = 85e-3}};

static const struct cli_option options[] = {
    CLI_ONE(CLI_DESIGN, "FILE", "file of a sweep", file, "a file is needed", "one file at a time"),
    {"output", 'o', CLI_FOLDER, "DIR", "write into DIR (default: the file's name + .sweep)",
     CLI_AT(options.folder)},
    {"jobs", 'j', CLI_TEXT, "N", "designs at once (default: one a core)", CLI_AT(processes),
     cli_parse_processes},
    {"shard", 0, CLI_TEXT, "I/N", "only part I of N; each part may run on another computer",
     CLI_AT(options.shard), parse_shard},
    {"slurm", 0, CLI_TEXT, "N",
     "hand N parts to Slurm as an array of jobs, with -j processes each (1 if not given), and a "
     "job "
     "that writes the tables after them; what else sbatch should know says SBATCH_PARTITION and "
     "the like",
     CLI_AT(slurm), cli_parse_processes},
    {"at", 0, CLI_KEY, "KEY=VALUE",
     "of the plan sparse-grid: print quantities and their errors at this value of a variable, the "
     "design's value of the others, as CSV",
     CLI_AT(at), cli_parse_override, .most = CLI_OVERRIDES_MAX},
    {"merge", 0, CLI_FLAG, NULL, "only write the tables of all parts that are there",
     CLI_AT(options.merge)},
    {"force", 'f', CLI_FLAG, NULL, "throw away the cases that are there", CLI_AT(options.force)},
    CLI_FORMAT_ROW("formats of the figures of samples with commas between, svg if not given"),
    CLI_WIDTH_ROW("width of the figures (default 85)"),
    {0}};

const struct dea_command cmd_sweep = {
    .name = "sweep",
    .summary = "Compute many designs that differ in some values: grids, samples, uncertainty",
    .about = "Goes on where it was stopped. What the file holds says 'dea schema --explore'.",
    .defaults = &defaults,
    CLI_RUN};
