#define _GNU_SOURCE // popen, access
#include "base/text.h"
#include "base/version.h"
#include "cli/cli.h"
#include "cli/data_files.h"

#include <errno.h>
#include <hdf5.h>
#include <jansson.h>
#include <lapacke.h>
#include <string.h>
#include <udunits2.h>
#include <unistd.h>
#include <yaml.h>

enum { OUTPUT_SIZE = 8192 };

/* What was found out so far. */
struct report {
  bool usable; // false: a command that computes would fail
};

enum importance { NEEDED, WISHED };

/* One line; advice: what to do when it is not ok, may be NULL. */
static void say(struct report *report, enum importance importance, bool ok, const char *what,
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
  int major = 0, minor = 0, patch = 0;
  yaml_get_version(&major, &minor, &patch);
  unsigned h5_major = 0, h5_minor = 0, h5_release = 0;
  H5get_libversion(&h5_major, &h5_minor, &h5_release);
  lapack_int la_major = 0, la_minor = 0, la_patch = 0;
  LAPACK_ilaver(&la_major, &la_minor, &la_patch);
  snprintf(text, sizeof text, "libyaml %d.%d.%d, jansson %s, HDF5 %u.%u.%u, LAPACK %d.%d.%d", major,
           minor, patch, jansson_version_str(), h5_major, h5_minor, h5_release, (int)la_major,
           (int)la_minor, (int)la_patch);
  say(report, NEEDED, true, "libraries", text, NULL);
}

static void check_units(struct report *report)
{
  ut_set_error_message_handler(ut_ignore);
  ut_system *units = ut_read_xml(NULL);
  ut_unit *unit = units != NULL ? ut_parse(units, "kPa", UT_ASCII) : NULL;
  bool ok = unit != NULL;
  say(report, NEEDED, ok, "units", ok ? "udunits database" : "the udunits database cannot be read",
      "install libudunits2-data, or set UDUNITS2_XML_PATH to udunits2.xml");
  ut_free(unit);
  ut_free_system(units);
}

static void check_data(struct dea_context *ctx, struct report *report, enum dea_data_kind kind,
                       const char *what)
{
  struct cli_data_list list;
  struct dea_text text = {.ctx = ctx};
  bool ok = cli_data_find(ctx, kind, ".yaml", &list) == DEA_OK && list.count > 0;
  dea_text_add(&text, "%zu in %s", list.count, list.folder != NULL ? list.folder : "?");
  say(report, kind == DEA_DATA_MATERIALS ? NEEDED : WISHED, ok, what, dea_text_get(&text),
      "install the program again: its data files are not where they should be");
  dea_text_free(&text);
  cli_data_free(ctx, &list);
}

/* Runs a command line and keeps what it prints; false when it fails. */
static bool capture(const char *command, char output[OUTPUT_SIZE])
{
  output[0] = '\0';
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
  say(report, WISHED, ok, what, ok ? "drawn" : output,
      "install gnuplot-nox and a font "
      "(fonts-dejavu-core)");
}

static void check_gnuplot(struct report *report)
{
  char output[OUTPUT_SIZE];
  bool ok = capture("gnuplot --version 2>/dev/null", output);
  output[strcspn(output, "\n")] = '\0';
  say(report, WISHED, ok, "gnuplot", ok ? output : "not found on the PATH",
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
  say(report, WISHED, ok, "folder to write in", text, "go to another folder, or use -o DIR");
}

static int run(struct dea_cli *cli, int argc, char **argv)
{
  if (argc > 1) {
    return cli_usage_error(cli, &cmd_doctor, "'%s' is not expected here", argv[1]);
  }
  struct report report = {.usable = true};
  say(&report, NEEDED, true, "dea", DEA_VERSION ", built by " DEA_COMPILER " as " DEA_BUILD_TYPE,
      NULL);
  check_libraries(&report);
  check_units(&report);
  check_data(cli->ctx, &report, DEA_DATA_MATERIALS, "materials");
  check_data(cli->ctx, &report, DEA_DATA_EXAMPLES, "examples");
  check_gnuplot(&report);
  check_folder(&report);
  if (!report.usable) {
    return cli_report(cli, dea_fail(cli->ctx, DEA_E_TOOL, "something that is needed is missing"));
  }
  return cli_report(cli, DEA_OK);
}

const struct dea_command cmd_doctor = {
    .name = "doctor",
    .summary = "say what this installation has and what it lacks",
    .usage = "dea doctor\n"
             "\n"
             "One line a thing that a run needs: ok or missing, and what to do about it.\n"
             "The exit code is 0 when designs can be computed, even if figures cannot be drawn.\n",
    .run = run,
};
