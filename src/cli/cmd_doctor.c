#define _POSIX_C_SOURCE 200809L // access, getcwd
#include "base/module.h"
#include "base/program.h"
#include "base/version.h"
#include "cli/bench.h"
#include "cli/cli.h"
#include "material/catalogue.h"
#include "model/model.h"
#include "result/provenance.h"

#include <errno.h>
#include <limits.h>
#include <string.h>
#include <udunits2.h>
#include <unistd.h>

/* One line; advice: what to do when it is not ok. Whether it is. */
static bool print_row(bool ok, const char *what, const char *found, const char *advice)
{
  printf("%-8s %-22s %s\n", ok ? "ok" : "missing", what, found);
  if (!ok) {
    printf("%-8s %-22s -> %s\n", "", "", advice);
  }
  return ok;
}

static bool check_units(void)
{
  ut_set_error_message_handler(ut_ignore);
  ut_system *units = ut_read_xml(NULL);
  ut_unit *unit = units != NULL ? ut_parse(units, "kPa", UT_ASCII) : NULL;
  bool ok = unit != NULL;
  ut_free(unit);
  ut_free_system(units);
  return print_row(ok, "units", ok ? "udunits database" : "the udunits database cannot be read",
                   "install libudunits2-data, or set UDUNITS2_XML_PATH to udunits2.xml");
}

/* Line "N in FOLDER", and what to do if there are none. */
static bool print_data(const char *what, size_t count, int length, const char *folder)
{
  char text[4096 + 128];
  snprintf(text, sizeof text, "%zu in %.*s", count, length, folder);
  return print_row(count > 0, what, count > 0 ? text : "none were found",
                   "install the program again: its data files are not where they should be");
}

/* All materials must be readable; the folder is that of the first. */
static dea_status check_materials(struct dea_context *ctx, bool *usable)
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
    *usable = print_data("materials", count, slash != NULL ? (int)(slash - folder) : 0, folder);
  }
  return status;
}

static dea_status check_examples(struct dea_context *ctx)
{
  struct cli_data_list list;
  dea_status status = cli_examples_find(ctx, ".yaml", &list);
  if (status == DEA_OK) {
    print_data("examples", list.count, INT_MAX, list.folder);
  }
  cli_data_free(ctx, &list);
  return status;
}

/* Runs gnuplot and keeps what it prints; false when it fails. */
static bool run_gnuplot(const struct dea_context *ctx, char *option, char *value,
                        char said[DEA_PROGRAM_SAID])
{
  static const double limit_s = 60;
  struct dea_program program;
  int number;
  char *const argv[] = {(char *)"gnuplot", option, value, NULL};
  said[0] = '\0';
  return dea_program_start(argv, ".", true, &program) == 0 &&
         dea_program_wait(ctx, &program, limit_s, said, &number) == DEA_PROGRAM_DONE;
}

/* Draws a line with a terminal: that it is listed does not mean that its fonts are there. */
static void check_terminal(const struct dea_context *ctx, const char *terminal)
{
  char command[256], output[DEA_PROGRAM_SAID], what[64];
  snprintf(command, sizeof command,
           "set terminal %s; set output '/dev/null'; set title 'E'; plot x", terminal);
  bool ok = run_gnuplot(ctx, (char *)"-e", command, output) && output[0] == '\0';
  output[strcspn(output, "\n")] = '\0';
  snprintf(what, sizeof what, "figures as %s", terminal);
  print_row(ok, what, ok ? "drawn" : output,
            "install gnuplot-nox and a font "
            "(fonts-dejavu-core)");
}

/* Modules, with what they need and what there is not without them. */
static const struct module {
  const char *what, *name, *packages, *without;
} modules[] = {
    {"3D engine", "dea_solid_module", "libpetsc-real-dev and libslepc-real-dev",
     "there is no model 3d"},
    {"drawings of dea fab", "dea_cairo_module", "libcairo2-dev", "dea fab writes DXF and SVG only"},
    {"booleans of regions", "dea_geos_module", "libgeos-dev", "regions are not united or cut"},
    {".mat files", "dea_matio_module", "libmatio-dev", "files are exchanged as CSV"},
};

/* A module is of this build where its packages were there when that was configured. */
static void check_module(const struct module *module)
{
  char advice[400], file[40], path[4096];
  const bool of_build = strstr(DEA_MODULES_OF_BUILD, module->name) != NULL;
  snprintf(file, sizeof file, "%s.so", module->name);
  const bool ok = dea_module_find(file, path, sizeof path);
  if (of_build) {
    snprintf(advice, sizeof advice,
             "%s belongs to this build, but is in none of its folders: build all of it, or "
             "install it again; without it %s",
             file, module->without);
  } else {
    snprintf(advice, sizeof advice, "install %s, and build again; without it %s", module->packages,
             module->without);
  }
  print_row(ok, module->what, ok ? path : of_build ? "not found" : "not built", advice);
}

static void check_gnuplot(const struct dea_context *ctx)
{
  char output[DEA_PROGRAM_SAID];
  const bool ok = run_gnuplot(ctx, (char *)"--version", NULL, output);
  output[strcspn(output, "\n")] = '\0';
  print_row(ok, "gnuplot", ok ? output : "not found on the PATH",
            "install gnuplot-nox; without it a run writes data and no figures");
  if (ok) {
    check_terminal(ctx, "svg");
    check_terminal(ctx, "pdfcairo");
    check_terminal(ctx, "pngcairo");
  }
}

static void check_folder(void)
{
  char text[4096 + 128], folder[4096];
  if (getcwd(folder, sizeof folder) == NULL) {
    snprintf(folder, sizeof folder, "the current folder");
  }
  bool ok = access(".", W_OK) == 0;
  snprintf(text, sizeof text, "%s%s%s", folder, ok ? "" : ": ", ok ? "" : strerror(errno));
  print_row(ok, "folder to write in", text, "go to another folder, or use -o DIR");
}

static dea_status run(struct dea_cli *cli, void *request)
{
  (void)request;
  char libraries[256];
  bool materials = true;
  dea_libraries_text(libraries, sizeof libraries);
  print_row(true, "dea", DEA_VERSION ", built by " DEA_COMPILER " as " DEA_BUILD_TYPE, "");
  print_row(true, "libraries", libraries, "");
  const bool units = check_units();
  dea_status status = check_materials(cli->ctx, &materials);
  status = status == DEA_OK ? check_examples(cli->ctx) : status;
  check_gnuplot(cli->ctx);
  for (size_t i = 0; i < sizeof modules / sizeof modules[0]; i++) {
    check_module(&modules[i]);
  }
  check_folder();
  return status == DEA_OK && !(units && materials)
             ? dea_fail(cli->ctx, DEA_E_TOOL, "something that is needed is missing")
             : status;
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
