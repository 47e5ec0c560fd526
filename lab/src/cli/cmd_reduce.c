#include "cli/cli.h"

#include "reduce/output.h"
#include "study/design_file.h"

#include <math.h>
#include <string.h>

struct request {
  const char *file, *design, *output;
  bool json, force;
  struct dea_plot_format format;
  struct dea_reduce_options options;
};

/* "0.2" or "20%". */
static dea_status parse_settle(struct dea_cli *cli, const struct cli_option *option,
                               const char *text, void *target)
{
  double *settle = target;
  bool good = cli_read_share(text, settle) && *settle > 0.0 && *settle <= 1.0;
  return good ? DEA_OK
              : cli_usage_error(cli, "--%s '%s': must be a share such as 0.2 or 20%%", option->name,
                                text);
}

/* The design of --design, or the one that the recording brings along; NULL without. */
static dea_status find_design(struct dea_context *ctx, const struct request *request,
                              const struct dea_recording *recording, struct dea_design **out)
{
  if (request->design != NULL) {
    return dea_design_read(ctx, request->design, NULL, 0, out);
  }
  if (recording->design == NULL) {
    return DEA_OK;
  }
  const char *name = recording->design_name != NULL ? recording->design_name : "design";
  return dea_design_read_memory(ctx, name, recording->design, strlen(recording->design), NULL, 0,
                                out);
}

/* Radii that no option says are the design's. */
static dea_status complete_options(struct dea_context *ctx, const struct request *request,
                                   const struct dea_recording *recording,
                                   struct dea_reduce_options *options)
{
  struct dea_design *design = NULL;
  struct dea_device *device = NULL;
  DEA_TRY(ctx, find_design(ctx, request, recording, &design));
  dea_status status = design != NULL ? dea_device_build(ctx, design, &device) : DEA_OK;
  if (device != NULL && device->disc) { // of another device options say all radii
    double tip_m = device->fibre_count > 0 ? device->fibre_tip_radius_m : NAN;
    options->fibre_tip_radius_m =
        isnan(options->fibre_tip_radius_m) ? tip_m : options->fibre_tip_radius_m;
    options->film_radius_m =
        isnan(options->film_radius_m) ? device->frame_radius_m : options->film_radius_m;
    options->electrode_radius_m = isnan(options->electrode_radius_m) ? device->electrode_radius_m
                                                                     : options->electrode_radius_m;
  }
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  return status;
}

static void print_levelling(const struct dea_levelling *l)
{
  if (l->frames == 0) {
    return;
  }
  if (l->by_frame) {
    printf("%-12s edges %.2f mm apart, centre at %.2f mm, tilt %.3f degrees, %.2f mm high\n",
           "frame", 1e3 * (l->edges_m[1] - l->edges_m[0]), 1e3 * l->centre_m,
           l->tilt_rad * 180.0 / DEA_PI, 1e3 * l->frame_height_m);
  } else {
    printf("%-12s not in the picture; centre at %.2f mm, tilt %.3f degrees\n", "frame",
           1e3 * l->centre_m, l->tilt_rad * 180.0 / DEA_PI);
  }
  printf("%-12s %zu, %.2g %% of the points invalid, %.2g %% outliers; averaged over %.2f mm",
         "profiles", l->frames, 100.0 * (double)l->invalid / fmax(1.0, (double)l->total),
         100.0 * (double)l->outliers / fmax(1.0, (double)l->total), 1e3 * l->width_m);
  if (!isnan(l->fibre_tip_radius_m)) {
    printf("; fibre tips at %.2f mm", 1e3 * l->fibre_tip_radius_m);
  }
  putchar('\n');
}

static void print_number(const char *format, int width, double value)
{
  char text[48] = "-";
  if (!isnan(value)) {
    snprintf(text, sizeof text, format, value);
  }
  printf(" %*s", width, text);
}

/* "12.34 +- 0.05", with two digits of the uncertainty. */
static void print_value(double value, double uncertainty)
{
  char text[64] = "-";
  int digits = 2;
  if (uncertainty > 0.0) {
    double places = 1.0 - floor(log10(uncertainty));
    digits = places < 0.0 ? 0 : places > 6.0 ? 6 : (int)places;
  }
  if (!isnan(value) && uncertainty > 0.0) {
    snprintf(text, sizeof text, "%.*f +- %.*f", digits, value, digits, uncertainty);
  } else if (!isnan(value)) {
    snprintf(text, sizeof text, "%.*f", digits, value);
  }
  printf("  %20s", text);
}

static void print_table(const struct dea_reduction *r)
{
  enum dea_reduced_kind of = dea_reduced_timed(r);
  if (of == DEA_REDUCED_KINDS) {
    return;
  }
  char creep[24];
  snprintf(creep, sizeof creep, "creep (%s)", dea_reduced_meanings[of].unit);
  printf("\n%8s %6s", "V (kV)", "cycles");
  for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
    if (dea_reduced_has(r, (enum dea_reduced_kind)kind)) {
      char title[32];
      snprintf(title, sizeof title, "%s (%s)", dea_reduced_meanings[kind].name,
               dea_reduced_meanings[kind].unit);
      printf("  %20s", title);
    }
  }
  printf(" %10s %10s %11s %15s\n", "rise (ms)", "fall (ms)", creep, "shape");
  for (size_t l = 0; l < r->level_count; l++) {
    const struct dea_voltage_level *level = &r->levels[l];
    printf("%8.3f %6zu", fabs(level->voltage_V) < 0.5 ? 0.0 : 1e-3 * level->voltage_V,
           level->cycles);
    for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
      if (dea_reduced_has(r, (enum dea_reduced_kind)kind)) {
        double f = dea_reduced_meanings[kind].factor;
        print_value(f * level->mean[kind], f * level->uncertainty[kind]);
      }
    }
    print_number("%.3g", 10, 1e3 * level->rise_s[of]);
    print_number("%.3g", 10, 1e3 * level->fall_s[of]);
    print_number("%.3g", 11, dea_reduced_meanings[of].factor * level->creep[of]);
    char shape[48] = "-";
    if (!isnan(level->shape)) {
      double rounded = fabs(level->shape) < 0.005 ? 0.0 : level->shape; // no "-0.00"
      snprintf(shape, sizeof shape, "%.2f +- %.2f", rounded, level->shape_uncertainty);
    }
    printf(" %15s\n", shape);
  }
  printf(
      "+-: standard uncertainty of the mean; rise, fall and creep: of %s; shape: 0 flat, 1 cone\n",
      dea_reduced_meanings[of].name);
}

static void print_discharges(const struct dea_reduction *r)
{
  size_t breakdowns = 0;
  if (r->current.samples == 0) {
    return;
  }
  for (size_t i = 0; i < r->discharge_count; i++) {
    breakdowns += r->discharges[i].kind == DEA_BREAKDOWN ? 1U : 0U;
  }
  printf("\n%zu discharge%s: spikes above %.2f times the current's noise of %.3g uA",
         r->discharge_count - breakdowns, r->discharge_count - breakdowns == 1 ? "" : "s",
         r->current.factor, 1e6 * r->current.noise_A);
  if (breakdowns > 0) {
    const struct dea_discharge *first = r->discharges;
    while (first->kind != DEA_BREAKDOWN) {
      first++;
    }
    printf("; BREAKDOWN at %.3f s, %.3f kV", first->time_s, 1e-3 * first->voltage_V);
  }
  putchar('\n');
}

/* What the charge of a voltage's edges tells of. */
static void print_capacitance(const struct dea_reduction *r)
{
  bool known = false;
  for (size_t l = 0; l < r->level_count; l++) {
    const struct dea_voltage_level *level = &r->levels[l];
    if (isnan(level->capacitance_F)) {
      continue;
    }
    if (!known) {
      printf("\n%8s  %20s %15s\n", "V (kV)", "capacitance (pF)", "sensed stretch");
      known = true;
    }
    printf("%8.3f", 1e-3 * level->voltage_V);
    print_value(1e12 * level->capacitance_F, 1e12 * level->capacitance_std_F);
    print_number("%.4f", 15, level->sensed_stretch);
    putchar('\n');
  }
  if (known) {
    printf("+-: standard deviation from cycle to cycle; stretch of the electrode that the "
           "capacitance tells of\n");
  }
}

static void print_text(const struct dea_recording *recording, const struct dea_reduction *r,
                       const char *folder)
{
  char title[CLI_PLAIN_SIZE];
  printf("%-12s %s%s%s\n", "recording", recording->file, recording->title[0] != '\0' ? ": " : "",
         cli_plain(recording->title, title));
  print_levelling(&r->levelling);
  if (!isnan(r->force_offset_N)) {
    printf("%-12s offset %.3f mN", "force", 1e3 * r->force_offset_N);
    if (!isnan(r->preload_N)) {
      printf(", preload %.3f mN", 1e3 * r->preload_N);
    }
    putchar('\n');
  }
  print_table(r);
  print_discharges(r);
  print_capacitance(r);
  printf("\nwritten to %s\n", folder);
}

static dea_status reduce(struct dea_cli *cli, const struct request *request,
                         struct dea_recording **recording, struct dea_reduction **reduction)
{
  struct dea_context *ctx = cli->ctx;
  struct dea_reduce_options options = request->options;
  DEA_TRY(ctx, dea_recording_read(ctx, request->file, recording));
  DEA_TRY(ctx, complete_options(ctx, request, *recording, &options));
  DEA_TRY(ctx, dea_reduce(ctx, *recording, &options, reduction));
  DEA_TRY(ctx, dea_reduction_folder(ctx, request->output, request->force));
  return dea_reduction_write(ctx, *recording, *reduction, cli->command_line, &request->format,
                             request->output);
}

static dea_status run(struct dea_cli *cli, void *user)
{
  struct request *request = user;
  struct dea_recording *recording = NULL;
  struct dea_reduction *reduction = NULL;
  DEA_TRY(cli->ctx, cli_output_name(cli, request->file, "reduced", &request->output));
  const dea_status status = reduce(cli, request, &recording, &reduction);
  if (reduction != NULL && request->json) {
    cli_print_json(dea_reduction_json(cli->ctx, recording, reduction, cli->command_line));
  } else if (reduction != NULL) {
    print_text(recording, reduction, request->output);
  }
  dea_reduction_destroy(cli->ctx, reduction);
  dea_recording_destroy(cli->ctx, recording);
  return status;
}

static const struct request defaults = {.options = {NAN, NAN, NAN, 0.0, NAN},
                                        .format = {.svg = true, .width_m = 85e-3}};

/* A length or force of the bench, with an example. */
#define QUANTITY_ROW(name, word, text, member, unit, example, above_0)                             \
  {                                                                                                \
    name, 0, CLI_TEXT, word, text, CLI_AT(options.member), cli_parse_quantity,                     \
        .measure = {unit, example}, .positive = above_0                                            \
  }

static const struct cli_option options[] = {
    CLI_RECORDING_ROW,
    {"design", 0, CLI_DESIGN, "DESIGN",
     "radii of film, electrode and fibre tips from DESIGN; else from the design in the recording",
     CLI_AT(design)},
    QUANTITY_ROW("film-radius", "R", "inner radius of the frame, such as '15 mm'", film_radius_m,
                 "m", "15 mm", true),
    QUANTITY_ROW("electrode-radius", "R", "radius of the electrode", electrode_radius_m, "m",
                 "3.75 mm", true),
    QUANTITY_ROW("tip-radius", "R", "distance of the fibre tips from the centre",
                 fibre_tip_radius_m, "m", "3 mm", true),
    QUANTITY_ROW(
        "force-offset", "F",
        "reading of the unloaded force cell, such as '1.5 mN'; else the mean of its first readings",
        force_offset_N, "N", "1.5 mN", false),
    {"settle", 0, CLI_TEXT, "SHARE", "last share of each part of a cycle that is averaged (0.2)",
     CLI_AT(options.settle), parse_settle},
    CLI_OUTPUT_ROW(CLI_FOLDER, "DIR", "write into DIR (default: the file's name + .reduced)"),
    CLI_FORCE_ROW('f', "replace an earlier reduction in that folder"),
    CLI_FORMAT_ROW("formats of the figures with commas between, svg if not given"),
    CLI_WIDTH_ROW("width of the figures (default 85)"),
    CLI_JSON_ROW("print reduction.json in place of the table"),
    {0}};

const struct dea_command cmd_reduce = {
    .name = "reduce",
    .summary = "Make displacements, forces, times and discharges of a recording",
    .about = "Writes measurement.csv (for 'dea compare'), levels.csv, cycles.csv, profiles.csv, "
             "history.csv, discharges.csv, reduction.json and figures.",
    .defaults = &defaults,
    CLI_RUN};
