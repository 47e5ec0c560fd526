#define _GNU_SOURCE // getopt_long
#include "cli/cli.h"

#include "base/file.h"
#include "base/units.h"
#include "base/write_file.h"
#include "cli/figure_options.h"
#include "output/figure.h"
#include "output/results_h5.h"
#include "output/run_folder.h"

#include <getopt.h>
#include <math.h>

enum { NAMES_MAX = 32 };

/* What the command line asks for; a format or width that is not given is the run's. */
struct request {
  const char *run, *folder;
  const char *names[NAMES_MAX];
  size_t name_count;
  bool has_format, has_width;
  double voltage_V;
  struct dea_plot_format format;
};

static int read_options(struct dea_cli *cli, int argc, char **argv, struct request *request)
{
  static const struct option options[] = {
      {"figure", required_argument, NULL, 'F'}, {"format", required_argument, NULL, 'f'},
      {"width", required_argument, NULL, 'w'},  {"voltage", required_argument, NULL, 'V'},
      {"output", required_argument, NULL, 'o'}, {0}};
  int letter;
  opterr = 0;
  while ((letter = getopt_long(argc, argv, ":o:", options, NULL)) != -1) {
    if (letter == ':' || letter == '?') {
      return cli_option_error(cli, &cmd_plot, letter, argv);
    }
    if (letter == 'o') {
      request->folder = optarg;
    } else if (letter == 'F' && request->name_count < NAMES_MAX) {
      request->names[request->name_count++] = optarg;
    } else if (letter == 'f') {
      request->has_format = true;
      if (!cli_read_formats(optarg, &request->format)) {
        return cli_usage_error(cli, &cmd_plot, "'%s' is not a list of svg, pdf, png", optarg);
      }
    } else if (letter == 'V') {
      char why[DEA_WHY_SIZE];
      const struct dea_measure volts = {"V", "6 kV"};
      if (!dea_units_read(cli->ctx, optarg, volts, &request->voltage_V, why)) {
        return cli_usage_error(cli, &cmd_plot, "--voltage: %s", why);
      }
    } else if (letter == 'w') {
      request->has_width = true;
      if (!cli_read_width(optarg, &request->format)) {
        return cli_usage_error(cli, &cmd_plot, "'%s' is not a width of 40 to 400 mm", optarg);
      }
    }
  }
  if (argc - optind != 1) {
    return cli_usage_error(cli, &cmd_plot,
                           argc == optind ? "which run? Give its folder" : "one run at a time");
  }
  request->run = argv[optind];
  return 0;
}

/* The folder of figures of a run, given its folder or its results.h5; owned by the caller. */
static char *figure_folder(struct dea_context *ctx, const char *run)
{
  if (dea_path_is_folder(run)) {
    return dea_path_join(ctx, run, DEA_FIGURE_FOLDER);
  }
  return dea_path_beside(ctx, run, DEA_FIGURE_FOLDER);
}

static void complete_format(struct request *request, const struct dea_run *run)
{
  if (!request->has_format) {
    bool none = !run->svg && !run->pdf && !run->png;
    request->format.svg = run->svg || none;
    request->format.pdf = run->pdf;
    request->format.png = run->png;
  }
  if (!request->has_width) {
    request->format.width_m = run->width_m > 0.0 ? run->width_m : 0.085;
  }
}

static int run(struct dea_cli *cli, int argc, char **argv)
{
  struct request request = {.run = NULL, .voltage_V = NAN};
  struct dea_run *data = NULL;
  int code = read_options(cli, argc, argv, &request);
  if (code != 0) {
    return code;
  }
  char *folder = request.folder != NULL ? NULL : figure_folder(cli->ctx, request.run);
  const char *target = request.folder != NULL ? request.folder : folder;
  dea_status status = target == NULL ? DEA_E_MEMORY : dea_run_read(cli->ctx, request.run, &data);
  if (status == DEA_OK) {
    complete_format(&request, data);
    struct dea_figure_options options = {.names = request.name_count > 0 ? request.names : NULL,
                                         .name_count = request.name_count,
                                         .format = request.format,
                                         .voltage_V = request.voltage_V};
    status = dea_figures_write(cli->ctx, data->result, target, &options);
  }
  if (status == DEA_OK && !cli->quiet) {
    fprintf(stderr, "figures are in %s\n", target);
  }
  code = cli_report(cli, status);
  dea_run_destroy(cli->ctx, data);
  dea_free(cli->ctx, folder);
  return code;
}

const struct dea_command cmd_plot = {
    .name = "plot",
    .summary = "Draw the figures of a run again",
    .usage =
        "dea plot RUN [--figure NAME]... [--format LIST] [--width MM] [-o DIR]\n"
        "\n"
        "Figures: displacement, stretch, field, tension, force, profile; of model 3d map, "
        "surface,\n"
        "section and animation too; of studies tip_force, load_line, modes, mode_shapes,\n"
        "bode, history, history_force, history_current, convergence, designs, design_tips,\n"
        "design_profiles.\n"
        "Beside each picture lie its gnuplot script and data, for other styles: gnuplot NAME.gp\n"
        "\n"
        "  RUN               folder of a run\n"
        "  --figure NAME     only this figure; can be repeated\n"
        "  --format LIST     formats such as svg,pdf,png; as in the design if not given\n"
        "  --voltage V       voltage of the map and the surface, as '6 kV'; the last if not given\n"
        "  --width MM        width, 85 for one column or 170 for two\n"
        "  -o, --output DIR  folder for the figures; RUN/figures if not given\n",
    .run = run,
};
