#include "cli/cli.h"

#include "base/file.h"
#include "base/write_file.h"
#include "figures/run_figures.h"
#include "io/results_h5.h"
#include "job/run_folder.h"

#include <math.h>

/* What the command line asks for; a format or width that is not given is the run's. */
struct request {
  const char *run, *output;
  struct cli_words names;
  double voltage_V;
  struct dea_plot_format format; // width 0: not given
};

/* The folder of figures of a run, given its folder or its results.h5; owned by the caller. */
static char *figure_folder(struct dea_context *ctx, const char *run)
{
  if (dea_path_is_folder(run)) {
    return dea_path_join(ctx, run, DEA_FIGURE_FOLDER);
  }
  return dea_path_beside(ctx, run, DEA_FIGURE_FOLDER);
}

static void complete_format(struct dea_plot_format *format, const struct dea_run *run)
{
  if (!format->svg && !format->pdf && !format->png) {
    format->svg = run->svg || (!run->pdf && !run->png);
    format->pdf = run->pdf;
    format->png = run->png;
  }
  if (!(format->width_m > 0.0)) {
    format->width_m = run->width_m > 0.0 ? run->width_m : 0.085;
  }
}

static dea_status run(struct dea_cli *cli, void *user)
{
  struct request *request = user;
  struct dea_run *data = NULL;
  size_t drawn = 0;
  char *folder = request->output != NULL ? NULL : figure_folder(cli->ctx, request->run);
  const char *target = request->output != NULL ? request->output : folder;
  dea_status status = target == NULL ? DEA_E_MEMORY : dea_run_read(cli->ctx, request->run, &data);
  if (status == DEA_OK) {
    complete_format(&request->format, data);
    struct dea_figure_options options = {.names =
                                             request->names.count > 0 ? request->names.at : NULL,
                                         .name_count = request->names.count,
                                         .format = request->format,
                                         .voltage_V = request->voltage_V};
    status = dea_figures_write(cli->ctx, data->result, target, &options, &drawn);
  }
  if (status == DEA_OK && drawn == 0) {
    status =
        dea_fail(cli->ctx, DEA_E_ARGUMENT, "nothing is drawn: the run has nothing to show in %s",
                 request->names.count > 0 ? "what was asked for" : "any figure");
  }
  if (status == DEA_OK && !cli->quiet) {
    fprintf(stderr, "figures are in %s\n", target);
  }
  dea_run_destroy(cli->ctx, data);
  dea_free(cli->ctx, folder);
  return status;
}

static const struct request defaults = {.voltage_V = NAN};

static const struct cli_option options[] = {
    CLI_ONE(CLI_FOLDER, "RUN", "folder of a run", run, "which run? Give its folder",
            "one run at a time"),
    {"figure", 0, CLI_FIGURE, "NAME", "only this figure; can be repeated", CLI_AT(names),
     .most = CLI_WORDS_MAX, .too_many = "too many figures"},
    CLI_FORMAT_ROW("formats with commas between, as in the design if not given"),
    {"voltage", 0, CLI_TEXT, "V",
     "voltage of the map and the surface, as '6 kV'; the last if not given", CLI_AT(voltage_V),
     cli_parse_quantity, .measure = {"V", "6 kV"}},
    CLI_WIDTH_ROW("width, 85 for one column or 170 for two"),
    CLI_OUTPUT_ROW(CLI_FOLDER, "DIR", "folder for the figures; RUN/figures if not given"),
    {0}};

const struct dea_command cmd_plot = {
    .name = "plot",
    .summary = "Draw the figures of a run again",
    .about =
        "Figures: displacement, stretch, field, tension, force, profile; of model 3d map, surface, "
        "section and, if asked for, animation too; of studies tip_force, load_line, loading, "
        "modes, mode_shapes, "
        "bode, history, history_force, history_current, convergence, map_pre_stretch, "
        "map_film_thickness, designs, design_tips, "
        "design_profiles.\n\n"
        "Beside each picture lie its gnuplot script and data, for other styles: gnuplot NAME.gp",
    .defaults = &defaults,
    CLI_RUN};
