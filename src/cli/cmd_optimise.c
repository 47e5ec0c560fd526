/* dea optimise: the best of many designs. */
#include "cli/cli.h"

#include "explore/best.h"
#include "result/columns.h"

#include <stdio.h>

struct request {
  const char *file;
  double processes; // 0: not given
  struct dea_optimise_options options;
  struct dea_plot_format format;
};

static void print_optimum(const struct dea_design_space *space, const struct dea_optimum *best)
{
  for (size_t j = 0; j < space->variable_count; j++) {
    char text[80];
    const char *bound = dea_optimum_bound(space, best, j);
    dea_device_param_show(&space->params[j], best->p[j], text);
    printf("  %-28s %s%s%s%s\n", space->params[j].param.name, text,
           bound != NULL ? ", at its " : "", bound != NULL ? bound : "",
           bound != NULL ? " bound" : "");
    for (size_t k = 0; k < space->params[j].tie_count; k++) {
      printf("  %-28s %s\n", space->params[j].ties[k].param.name, text);
    }
  }
  for (size_t k = 0; k < space->file->objective_count; k++) {
    const struct dea_column *column = &space->quantities[space->objectives[k]].shown;
    const bool most = space->file->objectives[k].goal.value == DEA_MOST; // f is the least
    printf("  %-28s %.6g %s\n", column->key, column->factor * (most ? -1 : 1) * best->f[k],
           column->display_unit);
  }
  if (best->marks != 0) {
    char words[DEA_FLAGS_SIZE];
    printf("  %-28s %s\n", "flags", dea_flags_text(best->marks, words));
  }
}

/* What the flags of all optima mean. */
static void print_flags(const struct dea_optimise_report *report)
{
  unsigned marks = 0;
  for (size_t i = 0; i < report->count; i++) {
    marks |= report->optima[i].marks;
  }
  for (unsigned f = 0; f < DEA_FLAG_COUNT; f++) {
    char line[DEA_FLAG_LINE_SIZE];
    if ((marks >> f & 1U) != 0) {
      printf("%s\n", dea_flag_line((enum dea_flag)f, line));
    }
  }
}

/* Where gradients came from, of a search that goes by them. */
static void print_gradients(const struct dea_design_space *space,
                            const struct dea_optimise_report *report)
{
  const int method = space->file->method.value;
  if (method != DEA_SLSQP && method != DEA_MMA) {
    return;
  }
  printf("gradients: %s", report->gradients ? "of the model" : "by differences");
  for (size_t j = 0, told = 0; j < space->variable_count && report->gradients; j++) {
    if (report->replaced[j] > 0) {
      printf("%s %s (%zu designs)", told++ > 0 ? "," : ", by differences of",
             space->params[j].param.name, report->replaced[j]);
    }
  }
  printf("\n");
}

static void print_report(const struct dea_design_space *space,
                         const struct dea_optimise_report *report, const char *folder)
{
  for (size_t i = 0; i < report->count; i++) {
    if (report->count > 1) {
      printf("best-%zu\n", i + 1);
    }
    print_optimum(space, &report->optima[i]);
  }
  print_flags(report);
  if (report->scattered > 1) {
    printf("each stands for %zu that scatter\n", report->scattered);
  }
  print_gradients(space, report);
  printf("designs: %zu, %zu of them computed before", report->evaluations, report->before);
  if (report->failed > 0) {
    printf(", %zu without all values", report->failed);
  }
  printf("\nwritten to %s\n", folder);
}

static dea_status optimise(struct dea_cli *cli, const struct request *request)
{
  struct dea_design_space *space;
  DEA_TRY(cli->ctx, dea_design_space_read(cli->ctx, request->file, &space));
  struct dea_optimise_report *report = dea_alloc(cli->ctx, 1, sizeof *report);
  dea_status status =
      report != NULL ? dea_optimise_run(space, &request->options, report) : DEA_E_MEMORY;
  cli_progress_clear(cli);
  if (report != NULL && report->evaluations > 0) {
    print_report(space, report, request->options.folder);
  }
  dea_free(cli->ctx, report);
  dea_design_space_destroy(space);
  return status;
}

static dea_status run(struct dea_cli *cli, void *user)
{
  struct request *request = user;
  request->options.format = request->format;
  request->options.processes = cli_processes(request->processes);
  DEA_TRY(cli->ctx, cli_output_name(cli, request->file, "optimise", &request->options.folder));
  return optimise(cli, request);
}

static const struct request defaults = {.format = {.svg = true, .width_m = 85e-3}};

static const struct cli_option options[] = {
    CLI_ONE(CLI_DESIGN, "FILE", "file of a search", file, "a file is needed", "one file at a time"),
    {"output", 'o', CLI_FOLDER, "DIR", "write into DIR (default: the file's name + .optimise)",
     CLI_AT(options.folder)},
    {"jobs", 'j', CLI_TEXT, "N", "designs at once (default: one a core)", CLI_AT(processes),
     cli_parse_processes},
    {"force", 'f', CLI_FLAG, NULL, "throw away the designs that are there", CLI_AT(options.force)},
    CLI_FORMAT_ROW("formats of the figures with commas between, svg if not given"),
    CLI_WIDTH_ROW("width of the figures (default 85)"),
    {0}};

const struct dea_command cmd_optimise = {
    .name = "optimise",
    .summary = "Find the best design within bounds and limits, or the front of two objectives",
    .about = "Writes the best design as best.yaml, which every command takes. Goes on where it was "
             "stopped. What the file holds says 'dea schema --explore'.",
    .defaults = &defaults,
    CLI_RUN};
