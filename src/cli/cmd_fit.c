#include "cli/cli.h"
#include "cli/print_fit.h"
#include "io/fit_files.h"
#include "job/device_fit_run.h"

struct request {
  const char *file, *output;
  bool json, force;
  struct dea_fit_options options;
  struct dea_plot_format format;
};

/* fit_KIND: reads a file of a kind, fits (`run`: *file into fit), writes the folder and prints what
 * there is. */
#define FIT_KIND(kind, its_file, its_fit, run)                                                     \
  static dea_status fit_##kind##_file(struct dea_cli *cli, const struct request *request,          \
                                      struct dea_##its_file **file, struct dea_##its_fit **fit)    \
  {                                                                                                \
    struct dea_context *ctx = cli->ctx;                                                            \
    const struct dea_fit_folder to = {request->output, request->force, cli->command_line,          \
                                      &request->format};                                           \
    DEA_TRY(ctx, dea_##its_file##_read(ctx, request->file, file));                                 \
    DEA_TRY(ctx, run);                                                                             \
    return dea_##its_fit##_write(ctx, *fit, &to);                                                  \
  }                                                                                                \
  static int fit_##kind(struct dea_cli *cli, const struct request *request)                        \
  {                                                                                                \
    struct dea_##its_file *file = NULL;                                                            \
    struct dea_##its_fit *fit = NULL;                                                              \
    const dea_status status = fit_##kind##_file(cli, request, &file, &fit);                        \
    cli_progress_clear(cli);                                                                       \
    if (fit != NULL && request->json) {                                                            \
      cli_print_json(dea_##its_fit##_json(fit, cli->command_line));                                \
    } else if (fit != NULL) {                                                                      \
      cli_print_##its_fit(fit);                                                                    \
      if (status == DEA_OK) {                                                                      \
        printf("\nwritten to %s\n", request->output);                                              \
      }                                                                                            \
    }                                                                                              \
    fflush(stdout);                                                                                \
    const int code = cli_report(cli, status);                                                      \
    dea_##its_fit##_destroy(cli->ctx, fit);                                                        \
    dea_##its_file##_destroy(cli->ctx, file);                                                      \
    return code;                                                                                   \
  }
FIT_KIND(material, fit_file, fit, dea_fit_file_run(ctx, *file, &request->options, fit))
FIT_KIND(device, device_file, device_fit, dea_device_fit_run(ctx, *file, &request->options, fit))
FIT_KIND(breakdown, breakdown_file, breakdown_fit, dea_breakdown_fit_run(ctx, *file, fit))
FIT_KIND(life, life_file, life_fit, dea_life_fit_run(ctx, *file, fit))

/* Kinds of fit files other than that of a material, by the key that tells them. */
static const struct {
  const char *key;
  int (*fit)(struct dea_cli *cli, const struct request *request);
} kinds[] = {{"design", fit_device}, {"breakdown", fit_breakdown}, {"life", fit_life}};

static int run(struct dea_cli *cli, void *user)
{
  struct request *request = user;
  struct dea_text folder = {.ctx = cli->ctx};
  request->output = cli_output_name(request->output, request->file, "fit", &folder);
  dea_status status = request->output == NULL ? DEA_E_MEMORY : DEA_OK;
  int (*fit)(struct dea_cli *, const struct request *) = NULL;
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0] && fit == NULL && status == DEA_OK; k++) {
    bool has = false;
    status = dea_fit_file_has(cli->ctx, request->file, kinds[k].key, &has);
    fit = has ? kinds[k].fit : NULL;
  }
  int code = status != DEA_OK ? cli_report(cli, status)
             : fit != NULL    ? fit(cli, request)
                              : fit_material(cli, request);
  dea_text_free(&folder);
  return code;
}

static const struct request defaults = {.format = {.svg = true, .width_m = 85e-3}};

static const struct cli_option options[] = {
    CLI_ONE(CLI_DESIGN, "FIT", "fit file", file, "a fit file is needed", "one fit file at a time"),
    {"profile", 0, CLI_FLAG, NULL,
     "profile likelihood of every parameter, not only where the normal form is poor",
     CLI_AT(options.profile)},
    CLI_OUTPUT_ROW(CLI_FOLDER, "DIR", "write into DIR (default: the file's name + .fit)"),
    CLI_FORCE_ROW('f', "replace an earlier fit in that folder"),
    CLI_FORMAT_ROW("formats of the figures with commas between, svg if not given"),
    CLI_WIDTH_ROW("width of the figures (default 85)"),
    CLI_JSON_ROW("print fit.json in place of the tables"),
    {0}};

const struct dea_command cmd_fit = {
    .name = "fit",
    .summary = "Fit a material or a device to measurements, with error bars and what they cannot "
               "tell",
    .about = "Writes the material, or the design of the device as it was built, as NAME.yaml, "
             "fit.csv (measurements, model, band), fit.json and figures. What a fit file holds "
             "says 'dea schema --fit', that of a device (with the key design) 'dea schema "
             "--fit-device', of breakdown tests (with the key breakdown) 'dea schema "
             "--fit-breakdown', of life tests (with the key life) 'dea schema --fit-life'.",
    .defaults = &defaults,
    CLI_RUN};
