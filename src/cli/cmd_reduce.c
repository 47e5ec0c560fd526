#define _GNU_SOURCE // getopt_long
#include "cli/cli.h"

#include "base/units.h"
#include "cli/figure_options.h"
#include "lab/reduce/output.h"

#include <getopt.h>
#include <math.h>
#include <string.h>

struct request {
  const char *file, *design, *folder;
  bool json, force;
  struct dea_plot_format format;
  struct dea_reduce_options options;
};

// Command line -----------------------------------------------------------------------------------

/* Value of an option in its unit; 0, or the exit code after its message. */
static int read_quantity(struct dea_cli *cli, const char *option, const char *unit,
                         const char *example, double lowest, double *out)
{
  char why[DEA_WHY_SIZE];
  if (!dea_units_read(cli->ctx, optarg, (struct dea_measure){unit, example}, out, why)) {
    return why[0] == '\0' ? cli_report(cli, dea_context_status(cli->ctx))
                          : cli_usage_error(cli, &cmd_reduce, "--%s '%s': %s", option, optarg, why);
  }
  if (!(*out > lowest)) {
    return cli_usage_error(cli, &cmd_reduce, "--%s '%s': must be more than 0, such as %s", option,
                           optarg, example);
  }
  return 0;
}

/* "0.2" or "20%". */
static int read_settle(struct dea_cli *cli, double *settle)
{
  const char *end;
  *settle = dea_text_to_double(optarg, &end);
  bool number = end != optarg;
  if (number && (strcmp(end, "%") == 0 || strcmp(end, " %") == 0)) {
    *settle /= 100.0;
    end = "";
  }
  if (!number || *end != '\0' || !(*settle > 0.0) || !(*settle <= 1.0)) {
    return cli_usage_error(cli, &cmd_reduce, "--settle '%s': must be a share such as 0.2 or 20%%",
                           optarg);
  }
  return 0;
}

static int take_option(struct dea_cli *cli, int letter, struct request *request)
{
  struct dea_reduce_options *options = &request->options;
  switch (letter) {
  case 'd':
    request->design = optarg;
    return 0;
  case 'o':
    request->folder = optarg;
    return 0;
  case 'F':
    request->force = true;
    return 0;
  case 'j':
    request->json = true;
    return 0;
  case 't':
    return read_quantity(cli, "tip-radius", "m", "3 mm", 0.0, &options->tip_radius_m);
  case 'r':
    return read_quantity(cli, "film-radius", "m", "15 mm", 0.0, &options->film_radius_m);
  case 'e':
    return read_quantity(cli, "electrode-radius", "m", "3.75 mm", 0.0,
                         &options->electrode_radius_m);
  case 'c':
    return read_quantity(cli, "force-offset", "N", "1.5 mN", -INFINITY, &options->force_offset_N);
  case 's':
    return read_settle(cli, &options->settle);
  case 'f':
    return cli_read_formats(optarg, &request->format)
               ? 0
               : cli_usage_error(cli, &cmd_reduce, "'%s' is not a list of svg, pdf, png", optarg);
  default:
    return cli_read_width(optarg, &request->format)
               ? 0
               : cli_usage_error(cli, &cmd_reduce, "'%s' is not a width of 40 to 400 mm", optarg);
  }
}

static int read_options(struct dea_cli *cli, int argc, char **argv, struct request *request)
{
  static const struct option longs[] = {{"design", required_argument, NULL, 'd'},
                                        {"output", required_argument, NULL, 'o'},
                                        {"force", no_argument, NULL, 'F'},
                                        {"json", no_argument, NULL, 'j'},
                                        {"tip-radius", required_argument, NULL, 't'},
                                        {"film-radius", required_argument, NULL, 'r'},
                                        {"electrode-radius", required_argument, NULL, 'e'},
                                        {"force-offset", required_argument, NULL, 'c'},
                                        {"settle", required_argument, NULL, 's'},
                                        {"format", required_argument, NULL, 'f'},
                                        {"width", required_argument, NULL, 'w'},
                                        {0}};
  int letter, code = 0;
  opterr = 0;
  while (code == 0 && (letter = getopt_long(argc, argv, ":o:", longs, NULL)) != -1) {
    if (letter == ':' || letter == '?') {
      return cli_option_error(cli, &cmd_reduce, letter, argv);
    }
    code = take_option(cli, letter, request);
  }
  if (code == 0 && argc - optind != 1) {
    return cli_usage_error(cli, &cmd_reduce, "give one recording");
  }
  request->file = code == 0 ? argv[optind] : NULL;
  return code;
}

// Work -------------------------------------------------------------------------------------------

/* The device of --design, or of the design that the recording brings along; NULL without. */
static dea_status find_device(struct dea_context *ctx, const struct request *request,
                              const struct dea_recording *recording, struct dea_design **design,
                              struct dea_device **device)
{
  if (request->design != NULL) {
    DEA_TRY(ctx, dea_design_read(ctx, request->design, NULL, 0, design));
  } else if (recording->design != NULL) {
    const char *name = recording->design_name != NULL ? recording->design_name : "design";
    DEA_TRY(ctx, dea_design_read_memory(ctx, name, recording->design, strlen(recording->design),
                                        NULL, 0, design));
  } else {
    return DEA_OK;
  }
  return dea_device_build(ctx, *design, device);
}

static void print_levelling(const struct dea_levelling *l)
{
  if (l->frames == 0) {
    return;
  }
  if (l->by_frame) {
    printf("%-12s edges %.2f mm apart, centre at %.2f mm, tilt %.3f degrees, %.2f mm high\n",
           "frame", 1e3 * (l->edges_m[1] - l->edges_m[0]), 1e3 * l->centre_m,
           l->tilt_rad * 180.0 / acos(-1.0), 1e3 * l->frame_height_m);
  } else {
    printf("%-12s not in the picture; centre at %.2f mm, tilt %.3f degrees\n", "frame",
           1e3 * l->centre_m, l->tilt_rad * 180.0 / acos(-1.0));
  }
  printf("%-12s %zu, %.2g %% of the points invalid, %.2g %% outliers; averaged over %.2f mm",
         "profiles", l->frames, 100.0 * (double)l->invalid / fmax(1.0, (double)l->total),
         100.0 * (double)l->outliers / fmax(1.0, (double)l->total), 1e3 * l->width_m);
  if (!isnan(l->tip_radius_m)) {
    printf("; fibre tips at %.2f mm", 1e3 * l->tip_radius_m);
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
    const struct dea_reduced_level *level = &r->levels[l];
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

static void print_text(const struct dea_recording *recording, const struct dea_reduction *r,
                       const char *folder)
{
  printf("%-12s %s%s%s\n", "recording", recording->file, recording->title[0] != '\0' ? ": " : "",
         recording->title);
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
  printf("\nwritten to %s\n", folder);
}

static dea_status reduce(struct dea_cli *cli, struct request *request,
                         struct dea_recording **recording, struct dea_reduction **reduction)
{
  struct dea_context *ctx = cli->ctx;
  struct dea_design *design = NULL;
  struct dea_device *device = NULL;
  DEA_TRY(ctx, dea_recording_read(ctx, request->file, recording));
  dea_status status = find_device(ctx, request, *recording, &design, &device);
  if (status == DEA_OK) {
    status = dea_reduce(ctx, *recording, device, &request->options, reduction);
  }
  if (status == DEA_OK) {
    status = dea_reduction_folder(ctx, request->folder, request->force);
  }
  if (status == DEA_OK) {
    status = dea_reduction_write(ctx, *recording, *reduction, cli->command_line, &request->format,
                                 request->folder);
  }
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  return status;
}

static int run(struct dea_cli *cli, int argc, char **argv)
{
  struct request request = {.options = {NAN, NAN, NAN, 0.0, NAN},
                            .format = {.svg = true, .width_m = 85e-3}};
  struct dea_recording *recording = NULL;
  struct dea_reduction *reduction = NULL;
  struct dea_text folder = {.ctx = cli->ctx};
  int wrong = read_options(cli, argc, argv, &request);
  if (wrong != 0) {
    return wrong;
  }
  if (request.folder == NULL) {
    cli_folder_name(request.file, "reduced", &folder);
    request.folder = dea_text_get(&folder);
  }
  dea_status status = folder.failed ? DEA_E_MEMORY : reduce(cli, &request, &recording, &reduction);
  if (reduction != NULL && request.json) {
    cli_print_json(dea_reduction_json(cli->ctx, recording, reduction, cli->command_line));
  } else if (reduction != NULL) {
    print_text(recording, reduction, request.folder);
    fflush(stdout);
  }
  int code = cli_report(cli, status);
  dea_reduction_destroy(cli->ctx, reduction);
  dea_recording_destroy(cli->ctx, recording);
  dea_text_free(&folder);
  return code;
}

const struct dea_command cmd_reduce = {
    .name = "reduce",
    .summary = "Make displacements, forces, times and discharges of a recording",
    .usage =
        "dea reduce FILE [--design DESIGN] [-o DIR] [--force] [--json]\n\n"
        "Writes measurement.csv (for 'dea compare'), levels.csv, cycles.csv, profiles.csv,\n"
        "history.csv, discharges.csv, reduction.json and figures.\n\n"
        "  --design DESIGN       radii of film, electrode and fibre tips from DESIGN; else from\n"
        "                        the design in the recording\n"
        "  --film-radius R       inner radius of the frame, such as '15 mm'\n"
        "  --electrode-radius R  radius of the electrode\n"
        "  --tip-radius R        distance of the fibre tips from the centre\n"
        "  --force-offset F      reading of the unloaded force cell, such as '1.5 mN'; else the\n"
        "                        mean of its first readings\n"
        "  --settle SHARE        last share of each part of a cycle that is averaged (0.2)\n"
        "  -o, --output DIR      write into DIR (default: the file's name + .reduced)\n"
        "  --force               replace an earlier reduction in that folder\n"
        "  --format LIST         figures as svg, pdf, png (default svg)\n"
        "  --width WIDTH         of the figures, in mm (default 85)\n"
        "  --json                print reduction.json in place of the table\n",
    .run = run,
};
