#define _GNU_SOURCE // popen, access
#include "base/text.h"
#include "base/version.h"
#include "cli/bench.h"
#include "cli/cli.h"
#include "fabricate/cairo_canvas.h"
#include "geometry/boolean.h"
#include "material/catalogue.h"
#include "model/model.h"
#include "result/provenance.h"

#include <errno.h>
#include <string.h>
#include <udunits2.h>
#include <unistd.h>

enum { OUTPUT_SIZE = 8192 };

/* What was found out so far. */
struct report {
  bool usable; // false: a command that computes would fail
};

enum importance { NEEDED, WISHED };

/* One line; advice: what to do when it is not ok, may be NULL. */
static void print_row(struct report *report, enum importance importance, bool ok, const char *what,
                      const char *found, const char *advice)
{
  printf("%-8s %-22s %s\n", ok ? "ok" : "missing", what, found);
  if (!ok && advice != NULL) {
    printf("%-8s %-22s -> %s\n", "", "", advice);
  }
  if (!ok && importance == NEEDED) {
    report->usable = false;
  }
}

static void check_libraries(struct report *report)
{
  char text[256];
  dea_libraries_text(text, sizeof text);
  print_row(report, NEEDED, true, "libraries", text, NULL);
}

static void check_units(struct report *report)
{
  ut_set_error_message_handler(ut_ignore);
  ut_system *units = ut_read_xml(NULL);
  ut_unit *unit = units != NULL ? ut_parse(units, "kPa", UT_ASCII) : NULL;
  bool ok = unit != NULL;
  print_row(report, NEEDED, ok, "units",
            ok ? "udunits database" : "the udunits database cannot be read",
            "install libudunits2-data, or set UDUNITS2_XML_PATH to udunits2.xml");
  ut_free(unit);
  ut_free_system(units);
}

/* Line "N in FOLDER", and what to do if there are none. */
static void print_data(struct dea_context *ctx, struct report *report, enum importance importance,
                       const char *what, size_t count, const char *folder)
{
  struct dea_text text = {.ctx = ctx};
  dea_text_add(&text, "%zu in %s", count, folder);
  print_row(report, importance, count > 0, what,
            count > 0 ? dea_text_get(&text) : "none were found",
            "install the program again: its data files are not where they should be");
  dea_text_free(&text);
}

/* All materials must be readable; the folder is that of the first. */
static dea_status check_materials(struct dea_context *ctx, struct report *report)
{
  const struct dea_location nowhere = {.file = ""};
  const char **names;
  const char *folder = "";
  size_t count;
  DEA_TRY(ctx, dea_catalogue_names(ctx, &names, &count));
  dea_status status = DEA_OK;
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    struct dea_catalogue_entry *entry;
    status = dea_catalogue_read(ctx, names[i], nowhere, &entry);
    if (status == DEA_OK && i == 0) {
      folder = entry->file;
    }
    dea_catalogue_destroy(ctx, entry);
  }
  dea_free(ctx, names);
  if (status == DEA_OK) {
    const char *slash = strrchr(folder, '/');
    char *directory = dea_copy_text(ctx, folder, slash != NULL ? (size_t)(slash - folder) : 0);
    print_data(ctx, report, NEEDED, "materials", count, directory != NULL ? directory : folder);
    dea_free(ctx, directory);
  }
  return status;
}

static dea_status check_examples(struct dea_context *ctx, struct report *report)
{
  struct cli_data_list list;
  dea_status status = cli_examples_find(ctx, ".yaml", &list);
  if (status == DEA_OK) {
    print_data(ctx, report, WISHED, "examples", list.count, list.folder);
  }
  cli_data_free(ctx, &list);
  return status;
}

/* Runs a command line and keeps what it prints; false when it fails. */
static bool capture(const char *command, char output[OUTPUT_SIZE])
{
  output[0] = '\0';
  // NOLINTNEXTLINE(cert-env33-c): commands of this file, nothing of the user
  FILE *pipe = popen(command, "r");
  if (pipe == NULL) {
    return false;
  }
  size_t n = fread(output, 1, OUTPUT_SIZE - 1, pipe);
  output[n] = '\0';
  char rest[512];
  while (fread(rest, 1, sizeof rest, pipe) > 0) {
    // read to the end, or the command would die of a closed pipe
  }
  return pclose(pipe) == 0;
}

/* Draws a line with a terminal: that it is listed does not mean that its fonts are there. */
static void check_terminal(struct report *report, const char *terminal)
{
  char command[256], output[OUTPUT_SIZE];
  snprintf(command, sizeof command,
           "gnuplot -e \"set terminal %s; set output '/dev/null'; set title 'E'; plot x\" 2>&1",
           terminal);
  bool ok = capture(command, output) && output[0] == '\0';
  output[strcspn(output, "\n")] = '\0';
  char what[64];
  snprintf(what, sizeof what, "figures as %s", terminal);
  print_row(report, WISHED, ok, what, ok ? "drawn" : output,
            "install gnuplot-nox and a font "
            "(fonts-dejavu-core)");
}

/* Modules, with what they need and what there is not without them. */
static const struct module {
  const char *what;
  bool (*find)(char *path, size_t size);
  const char *file, *packages, *without;
} modules[] = {
    {"3D engine", dea_solid_module_find, "dea_solid_module",
     "libpetsc-real-dev and libslepc-real-dev", "there is no model 3d"},
    {"drawings of dea fab", dea_canvas_find, "dea_cairo_module", "libcairo2-dev",
     "dea fab writes DXF and SVG only"},
    {"booleans of regions", dea_boolean_find, "dea_geos_module", "libgeos-dev",
     "regions are not united or cut"},
    {".mat files", cli_bench_find_matio, "dea_matio_module", "libmatio-dev",
     "files are exchanged as CSV"},
};

/* A module is of this build where its packages were there when that was configured. */
static void check_module(struct report *report, const struct module *module)
{
  char advice[400], path[4096];
  const bool of_build = strstr(DEA_MODULES_OF_BUILD, module->file) != NULL;
  const bool ok = module->find(path, sizeof path);
  if (of_build) {
    snprintf(advice, sizeof advice,
             "%s.so belongs to this build, but is in none of its folders: build all of it, or "
             "install it again; without it %s",
             module->file, module->without);
  } else {
    snprintf(advice, sizeof advice, "install %s, and build again; without it %s", module->packages,
             module->without);
  }
  print_row(report, WISHED, ok, module->what,
            ok         ? path
            : of_build ? "not found"
                       : "not built",
            advice);
}

static void check_gnuplot(struct report *report)
{
  char output[OUTPUT_SIZE];
  bool ok = capture("gnuplot --version 2>/dev/null", output);
  output[strcspn(output, "\n")] = '\0';
  print_row(report, WISHED, ok, "gnuplot", ok ? output : "not found on the PATH",
            "install gnuplot-nox; without it a run writes data and no figures");
  if (ok) {
    check_terminal(report, "svg");
    check_terminal(report, "pdfcairo");
    check_terminal(report, "pngcairo");
  }
}

static void check_folder(struct report *report)
{
  char text[4096 + 128], folder[4096];
  if (getcwd(folder, sizeof folder) == NULL) {
    snprintf(folder, sizeof folder, "the current folder");
  }
  bool ok = access(".", W_OK) == 0;
  snprintf(text, sizeof text, "%s%s%s", folder, ok ? "" : ": ", ok ? "" : strerror(errno));
  print_row(report, WISHED, ok, "folder to write in", text, "go to another folder, or use -o DIR");
}

static int run(struct dea_cli *cli, void *request)
{
  (void)request;
  struct report report = {.usable = true};
  print_row(&report, NEEDED, true, "dea",
            DEA_VERSION ", built by " DEA_COMPILER " as " DEA_BUILD_TYPE, NULL);
  check_libraries(&report);
  check_units(&report);
  dea_status status = check_materials(cli->ctx, &report);
  status = status == DEA_OK ? check_examples(cli->ctx, &report) : status;
  check_gnuplot(&report);
  for (size_t i = 0; i < sizeof modules / sizeof modules[0]; i++) {
    check_module(&report, &modules[i]);
  }
  check_folder(&report);
  if (status == DEA_OK && !report.usable) {
    status = dea_fail(cli->ctx, DEA_E_TOOL, "something that is needed is missing");
  }
  return cli_report(cli, status);
}

static const struct cli_option options[] = {{0}};

const struct dea_command cmd_doctor = {
    .name = "doctor",
    .summary = "Say what this installation has and what it lacks",
    .about =
        "One line a thing that a run needs: ok or missing, and what to do about it. The exit code "
        "is 0 when designs can be computed, even if figures cannot be drawn.",
    .options = options,
    .run = run,
};
