/* dea report: runs as one HTML file. */
#define _POSIX_C_SOURCE 200809L // stat
#include "cli/cli.h"

#include "base/file.h"
#include "base/write_file.h"
#include "job/report_runs.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

struct request {
  struct cli_words runs;
  const char *output, *measurement, *fit, *explorer; // NULL: not given
  double finger;                                     // N/m
};

/* A page may be written again; anything else of that name is not ours to replace. */
static dea_status check_place(struct dea_context *ctx, const char *path)
{
  static const char wanted[] = "<!DOCTYPE html>";
  char start[sizeof wanted] = {0};
  struct stat status;
  bool is_file = stat(path, &status) == 0 && S_ISREG(status.st_mode);
  size_t length;
  if (!is_file || !dea_file_head(path, start, sizeof start - 1, &length)) {
    return DEA_OK; // nothing there, or writing will say what is wrong
  }
  return length == 0 || strcmp(start, wanted) == 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_IO,
                        "%s already exists and is not a page; choose another name with -o", path);
}

static dea_status run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  const char *first = request->runs.at[0];
  if (request->finger < 0) {
    return cli_usage_error(cli, "--finger: a stiffness is not negative: %g N/m", request->finger);
  }
  char inside[DEA_PATH_SIZE];
  DEA_TRY(cli->ctx,
          dea_path_build(cli->ctx, dea_path_is_folder(first) ? first : "", "report.html", inside));
  const char *path = request->output != NULL ? request->output : inside;
  const struct dea_report_options chosen = {.command = cli->command_line,
                                            .finger_N_per_m = request->finger,
                                            .measurement = request->measurement,
                                            .fit = request->fit,
                                            .explorer = request->explorer};
  DEA_TRY(cli->ctx, check_place(cli->ctx, path));
  DEA_TRY(cli->ctx, dea_job_report(cli->ctx, request->runs.at, request->runs.count, &chosen, path));
  if (!cli->quiet) {
    fprintf(stderr, "the report is %s\n", path);
  }
  return DEA_OK;
}

static const struct request defaults = {.finger = 500}; // N/m: an assumption that the page states

static const struct cli_option options[] = {
    CLI_MANY(CLI_FOLDER, "RUN...", "folder of a run, or its results.h5", runs, DEA_REPORT_RUNS_MAX,
             "which run? Give its folder", "too many runs"),
    {"measurement", 0, CLI_FILE, "FILE",
     "measured points beside the runs: CSV as for dea compare, or a folder written by dea reduce",
     CLI_AT(measurement)},
    {"fit", 0, CLI_FOLDER, "DIR",
     "folder that dea fit wrote: a section with parameters, figures, advice", CLI_AT(fit)},
    {"explorer", 0, CLI_FOLDER, "DIR",
     "folder of a dea sweep of the run's design with plan: sparse-grid: sliders for its variables",
     CLI_AT(explorer)},
    {"finger", 0, CLI_TEXT, "STIFFNESS",
     "stiffness of a fingertip that is pushed, '0.5 N/mm' if not given; '0 N/mm' for none",
     CLI_AT(finger), cli_parse_quantity, .measure = {"N/m", "0.5 N/mm"}},
    CLI_OUTPUT_ROW(CLI_NEW_FILE, "FILE",
                   "the page; report.html in the first run's folder if not given. Replaces an "
                   "older page, but no other file"),
    {0}};

const struct dea_command cmd_report = {
    .name = "report",
    .summary = "Write runs as one HTML page that needs no network",
    .about = "One file with everything: drawing, curves, limits, convergence, materials with their "
             "sources, provenance. Several runs are set beside each other.",
    .defaults = &defaults,
    CLI_RUN};
