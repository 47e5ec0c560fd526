/* dea report: runs as one HTML file. */
#define _GNU_SOURCE // getopt_long
#include "cli/cli.h"

#include "base/units.h"
#include "base/write_file.h"
#include "output/report/report.h"

#include <getopt.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* A page may be written again; anything else of that name is not ours to replace. */
static dea_status check_place(struct dea_context *ctx, const char *path)
{
  static const char wanted[] = "<!DOCTYPE html>";
  char start[sizeof wanted] = {0};
  struct stat status;
  bool is_file = stat(path, &status) == 0 && S_ISREG(status.st_mode);
  FILE *file = is_file ? fopen(path, "rb") : NULL;
  if (file == NULL) {
    return DEA_OK; // nothing there, or writing will say what is wrong
  }
  size_t length = fread(start, 1, sizeof start - 1, file);
  fclose(file);
  return length == 0 || strcmp(start, wanted) == 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_IO,
                        "%s is there already and is not a page; choose another name with -o", path);
}

static int run(struct dea_cli *cli, int argc, char **argv)
{
  static const struct option options[] = {{"output", required_argument, NULL, 'o'},
                                          {"finger", required_argument, NULL, 'f'},
                                          {"measurement", required_argument, NULL, 'm'},
                                          {0}};
  const char *output = NULL, *measurement = NULL;
  double finger = 500; // N/m: an assumption, which the page states
  int letter;
  opterr = 0;
  while ((letter = getopt_long(argc, argv, ":o:", options, NULL)) != -1) {
    if (letter == 'f') {
      char why[DEA_WHY_SIZE];
      const struct dea_measure stiffness = {"N/m", "0.5 N/mm"};
      if (!dea_units_read(cli->ctx, optarg, stiffness, &finger, why)) {
        return cli_usage_error(cli, &cmd_report, "--finger: %s", why);
      }
      if (finger < 0) {
        return cli_usage_error(cli, &cmd_report, "--finger: a stiffness is not negative: '%s'",
                               optarg);
      }
    } else if (letter == 'm') {
      measurement = optarg;
    } else if (letter == 'o') {
      output = optarg;
    } else {
      return cli_option_error(cli, &cmd_report, letter, argv);
    }
  }
  size_t count = (size_t)(argc - optind);
  if (count == 0 || count > DEA_REPORT_RUNS_MAX) {
    return cli_usage_error(cli, &cmd_report,
                           count == 0 ? "which run? Give its folder" : "too many runs");
  }
  const char *first = argv[optind];
  char *path = output != NULL              ? dea_copy_text(cli->ctx, output, SIZE_MAX)
               : dea_path_is_folder(first) ? dea_path_join(cli->ctx, first, "report.html")
                                           : dea_copy_text(cli->ctx, "report.html", SIZE_MAX);
  const struct dea_report_options chosen = {
      .command = cli->command_line, .finger_N_per_m = finger, .measurement = measurement};
  dea_status status = path == NULL ? DEA_E_MEMORY : check_place(cli->ctx, path);
  if (status == DEA_OK) {
    status = dea_report_write(cli->ctx, (const char *const *)argv + optind, count, &chosen, path);
  }
  if (status == DEA_OK && !cli->quiet) {
    fprintf(stderr, "the report is %s\n", path);
  }
  dea_free(cli->ctx, path);
  return cli_report(cli, status);
}

const struct dea_command cmd_report = {
    .name = "report",
    .summary = "Write runs as one HTML page that needs no network",
    .usage =
        "dea report RUN... [--measurement FILE] [--finger STIFFNESS] [-o FILE]\n"
        "\n"
        "One file with everything: drawing, curves, limits, convergence, materials with their\n"
        "sources, provenance. Several runs are set beside each other.\n"
        "\n"
        "  RUN                folder of a run, or its results.h5\n"
        "  -o, --output FILE  the page; report.html in the first run's folder if not given.\n"
        "                     Replaces an older page, but no other file\n"
        "  --measurement FILE measured points beside the runs: CSV as for dea compare, or\n"
        "                     a folder written by dea reduce\n"
        "  --finger STIFFNESS stiffness of a fingertip that is pushed, '0.5 N/mm' if not given;\n"
        "                     '0 N/mm' for none\n",
    .run = run,
};
