#include "cli/cli.h"
#include "cli/print_device_fit.h"
#include "job/device_fit.h"
#include "output/device_fit_files.h"
#include "output/fit_files.h"

#include <math.h>
#include <string.h>

struct request {
  const char *file, *output;
  bool json, force;
  struct dea_fit_options options;
  struct dea_plot_format format;
};

/* Unit for people and the factor to it. */
static const char *shown_unit(const char *unit, double *factor)
{
  *factor = strcmp(unit, "Pa") == 0 ? 1e-3 : 1;
  return strcmp(unit, "Pa") == 0 ? "kPa" : strcmp(unit, "1") == 0 ? "" : unit;
}

static void print_laws(const struct dea_fit *fit)
{
  if (fit->candidate_count < 2) {
    return;
  }
  printf("%-18s %10s %8s %22s\n", "law", "parameters", "branches", "held-out tests off by");
  for (size_t i = 0; i < fit->candidate_count; i++) {
    const struct dea_fit_candidate *c = &fit->candidates[i];
    if (c->failed) {
      printf("%-18s cannot be fitted: %s\n", c->name, c->why);
    } else {
      char share[32] = "more than 1000";
      if (c->held_out_share < 10) {
        snprintf(share, sizeof share, "%.2f", 100 * c->held_out_share);
      }
      printf("%-18s %10zu %8zu %20s %%%s\n", c->name, c->free_count, c->branch_count, share,
             i == fit->chosen ? "  <- taken" : "");
    }
  }
  putchar('\n');
}

/* An end of an interval; of a time that may be as short as can be the lower one is 0. */
static void print_end(const char *word, double value, bool open)
{
  if (open || isinf(value)) {
    printf("%s open", word);
  } else {
    printf("%s %.5g", word, value);
  }
}

static void print_values(const struct dea_fit *fit)
{
  printf("%s\n", fit->model.law->long_name);
  for (size_t j = 0; j < fit->model.count; j++) {
    const struct dea_fit_value *v = &fit->values[j];
    double factor;
    const char *unit = shown_unit(fit->model.params[j].unit, &factor);
    printf("  %-12s %12.6g", fit->model.params[j].name, factor * v->value);
    if (v->fixed) {
      printf("    fixed");
    } else if (v->at_bound) {
      printf("    at its bound");
    } else if (isinf(v->std)) {
      printf("    not determined");
    } else {
      printf(" +- %-9.3g", factor * v->std);
    }
    printf(" %s", unit);
    if (!isnan(v->low)) {
      printf("   (68 %%:");
      print_end("", factor * v->low, v->low == 0);
      print_end(" to", factor * v->high, false);
      printf(")");
    }
    putchar('\n');
  }
}

static void print_tests(const struct dea_fit *fit)
{
  static const char *const uses[] = {"fitted", "checked", "foretold"};
  putchar('\n');
  for (size_t s = 0; s < fit->series_count; s++) {
    const struct dea_fit_curve *c = &fit->curves[s];
    printf("%-24s %-9s %5zu rows", c->series->test->name.text, uses[c->series->test->use.value],
           c->series->rows);
    if (!isnan(c->rms_Pa)) {
      printf(", off by %.3g kPa (root mean square), %.1f %% at most", 1e-3 * c->rms_Pa,
             100 * c->largest);
    }
    if (c->lag > 0) {
      printf("; neighbours correlate (%.2f): %.1f rows count", c->lag, c->effective);
    }
    putchar('\n');
  }
}

static void print_advice(const struct dea_fit *fit)
{
  putchar('\n');
  if (fit->statistics.widened) {
    printf("the misfit is %.2g times what the uncertainties explain: the law or they are wrong; "
           "error bars are widened by that\n",
           sqrt(fit->statistics.reduced_chi2));
  }
  for (size_t k = 0; k < fit->weak_count; k++) {
    printf("%s\n", fit->weak[k]);
  }
  for (int mode = 0; mode < DEA_COUPON_MODES; mode++) {
    const struct dea_fit_stability *s = &fit->stability[mode];
    if (!isnan(s->unstable_from)) {
      printf("not stable (Drucker) in %s tension from the stretch %.3g on%s\n",
             dea_coupon_mode_names[mode], s->unstable_from, s->measured ? "" : ", not measured");
    }
  }
  if (fit->next_count > 0) {
    printf("the test that would tell most: %s (error bars x %.2f)\n", fit->next[0].what,
           fit->next[0].shrink);
  }
}

static dea_status fit_file(struct dea_cli *cli, const struct request *request,
                           struct dea_fit_file **file, struct dea_fit_tests *tests,
                           struct dea_fit **fit)
{
  struct dea_context *ctx = cli->ctx;
  DEA_TRY(ctx, dea_fit_file_read(ctx, request->file, file));
  DEA_TRY(ctx, dea_fit_tests_read(ctx, *file, tests));
  DEA_TRY(ctx, dea_fit_run(ctx, *file, tests->series, tests->count, &request->options, fit));
  DEA_TRY(ctx, dea_fit_folder(ctx, *file, request->output, request->force));
  return dea_fit_write(ctx, *fit, cli->command_line, &request->format, request->output);
}

static int fit_material(struct dea_cli *cli, const struct request *request)
{
  struct dea_fit_file *file = NULL;
  struct dea_fit_tests tests = {.count = 0};
  struct dea_fit *fit = NULL;
  dea_status status = fit_file(cli, request, &file, &tests, &fit);
  if (fit != NULL && request->json) {
    cli_print_json(dea_fit_json(cli->ctx, fit, cli->command_line));
  } else if (fit != NULL) {
    print_laws(fit);
    print_values(fit);
    print_tests(fit);
    print_advice(fit);
    if (status == DEA_OK) {
      printf("\nwritten to %s\n", request->output);
    }
    fflush(stdout);
  }
  int code = cli_report(cli, status);
  dea_fit_destroy(cli->ctx, fit);
  dea_fit_tests_free(&tests);
  dea_fit_file_destroy(cli->ctx, file);
  return code;
}

static dea_status fit_device_file(struct dea_cli *cli, const struct request *request,
                                  struct dea_device_file **file, struct dea_device_fit **fit)
{
  struct dea_context *ctx = cli->ctx;
  DEA_TRY(ctx, dea_device_file_read(ctx, request->file, file));
  DEA_TRY(ctx, dea_device_fit_run(ctx, *file, &request->options, fit));
  DEA_TRY(ctx, dea_device_fit_folder(ctx, *file, request->output, request->force));
  return dea_device_fit_write(ctx, *fit, cli->command_line, &request->format, request->output);
}

static int fit_device(struct dea_cli *cli, const struct request *request)
{
  struct dea_device_file *file = NULL;
  struct dea_device_fit *fit = NULL;
  dea_status status = fit_device_file(cli, request, &file, &fit);
  if (fit != NULL && request->json) {
    cli_print_json(dea_device_fit_json(fit, cli->command_line));
  } else if (fit != NULL) {
    cli_print_device_fit(fit);
    if (status == DEA_OK) {
      printf("\nwritten to %s\n", request->output);
    }
    fflush(stdout);
  }
  int code = cli_report(cli, status);
  dea_device_fit_destroy(cli->ctx, fit);
  dea_device_file_destroy(cli->ctx, file);
  return code;
}

static int run(struct dea_cli *cli, void *user)
{
  struct request *request = user;
  struct dea_text folder = {.ctx = cli->ctx};
  bool of_device = false;
  if (request->output == NULL) {
    cli_folder_name(request->file, "fit", &folder);
    request->output = dea_text_get(&folder);
  }
  dea_status status =
      folder.failed ? DEA_E_MEMORY : dea_device_file_is(cli->ctx, request->file, &of_device);
  int code = status != DEA_OK ? cli_report(cli, status)
             : of_device      ? fit_device(cli, request)
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
    CLI_FORCE_ROW(0, "replace an earlier fit in that folder"),
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
             "--fit-device'.",
    .options = options,
    .request_size = sizeof(struct request),
    .defaults = &defaults,
    .run = run,
};
