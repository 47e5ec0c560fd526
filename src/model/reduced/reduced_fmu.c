/* A reduced-order model as a functional mock-up unit: FMI 3.0, co-simulation, as source and for
 * Linux on the processor that it is made on. */
#include "base/assets.h"
#include "base/file.h"
#include "base/html.h"
#include "base/program.h"
#include "base/text.h"
#include "base/version.h"
#include "base/write_file.h"
#include "model/reduced/reduced.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FILE_MAX = 1 << 26, STEPS = 40 };
#define SOURCE "sources/dea_film.c"
#define BUILD "sources/buildDescription.xml"
#if defined __aarch64__
#define PLATFORM "binaries/aarch64-linux"
#else
#define PLATFORM "binaries/x86_64-linux"
#endif
#define BINARY PLATFORM "/dea_film.so"

static const char build[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n"
    "  <BuildConfiguration modelIdentifier=\"dea_film\">\n    <SourceFileSet language=\"C99\">"
    "<SourceFile name=\"dea_film.c\"/></SourceFileSet>\n    <Library name=\"m\"/>\n"
    "  </BuildConfiguration>\n</fmiBuildDescription>\n";

/* In the order of fmi3.c; unit of a turn: NULL: the same. */
static const struct variable {
  const char *causality, *name, *unit, *turn, *what;
} variables[] = {
    {"independent", "time", "s", NULL, "time"},
    {"input", "voltage", "V", NULL, "voltage of the source"},
    {"input", "force", "N", "N.m", "force from outside"},
    {"parameter", "series_resistance", "Ohm", NULL, "between source and film"},
    {"parameter", "longest_step", "s", NULL, "longest step of the integration"},
    {"parameter", "damping", "N.s/m", "N.m.s", "dashpot at the coordinate"},
    {"parameter", "inertia", "1", NULL, "0: without masses"},
    {"output", "displacement", "m", "rad", "coordinate"},
    {"output", "rate", "m/s", "rad/s", "its rate"},
    {"output", "charge", "C", NULL, "charge of the film"},
    {"output", "film_voltage", "V", NULL, "voltage on the film"},
    {"output", "current", "A", NULL, "current of the source"},
};
enum { LONGEST_STEP = 4, INERTIA = 6, OUTPUTS = 7, VARIABLES = 12 };

static const struct {
  const char *name, *base;
} units[] = {
    {"1", ""},
    {"s", "s=\"1\""},
    {"V", "kg=\"1\" m=\"2\" s=\"-3\" A=\"-1\""},
    {"Ohm", "kg=\"1\" m=\"2\" s=\"-3\" A=\"-2\""},
    {"C", "s=\"1\" A=\"1\""},
    {"A", "A=\"1\""},
    {"N", "kg=\"1\" m=\"1\" s=\"-2\""},
    {"N.m", "kg=\"1\" m=\"2\" s=\"-2\""},
    {"m", "m=\"1\""},
    {"rad", "rad=\"1\""},
    {"m/s", "m=\"1\" s=\"-1\""},
    {"rad/s", "rad=\"1\" s=\"-1\""},
    {"N.s/m", "kg=\"1\" s=\"-1\""},
    {"N.m.s", "kg=\"1\" m=\"2\" s=\"-1\""},
};

/* A part of the shortest period and of the shortest time of a branch. */
static double longest_step(const struct dea_reduced *core)
{
  struct dea_reduced_point at;
  double shortest = core->mode_count == 0 && core->branch_count == 0 ? 1 : INFINITY;
  dea_reduced_at(core, 0, 0, &at);
  for (int i = 0; i < core->mode_count; i++) {
    shortest = fmin(shortest, 2 * DEA_PI * sqrt(core->modes[i].mass[0] * at.by_force));
  }
  for (int i = 0; i < core->branch_count; i++) {
    shortest = fmin(shortest, core->branch_s[i]);
  }
  return shortest / STEPS;
}

static void describe(struct dea_text *out, const struct dea_reduced_order *o, const char *name)
{
  const bool turns = dea_reduced_order_turns(o);
  dea_text_add(
      out,
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"3.0\" "
      "modelName=\"dea_film\" instantiationToken=\"%s\" generationTool=\"dea %s\" "
      "description=\"reduced from 3D, %.6g to %.6g V: ",
      o->device, DEA_VERSION, o->voltage_V[0], o->voltage_V[1]);
  dea_html_text(out, name);
  dea_text_add(out, "\">\n"
                    "  <CoSimulation modelIdentifier=\"dea_film\" canGetAndSetFMUState=\"true\" "
                    "canHandleVariableCommunicationStepSize=\"true\"/>\n  <UnitDefinitions>\n");
  for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
    dea_text_add(out, "    <Unit name=\"%s\"><BaseUnit %s/></Unit>\n", units[i].name,
                 units[i].base);
  }
  dea_text_add(out, "  </UnitDefinitions>\n  <ModelVariables>\n");
  for (int i = 0; i < VARIABLES; i++) {
    const struct variable *v = &variables[i];
    const bool set = v->causality[0] == 'p';
    dea_text_add(out, "    <Float64 name=\"%s\" valueReference=\"%d\" causality=\"%s\" unit=\"%s\"",
                 v->name, i, v->causality, turns && v->turn != NULL ? v->turn : v->unit);
    if (i > 0 && i < OUTPUTS) {
      dea_text_add(out, "%s start=\"%.17g\"", set ? " variability=\"fixed\"" : "",
                   i == LONGEST_STEP ? longest_step(&o->core)
                   : i == INERTIA    ? o->core.mode_count > 0
                                     : 0);
    }
    dea_text_add(out, " description=\"%s\"/>\n", v->what);
  }
  dea_text_add(out, "  </ModelVariables>\n  <ModelStructure>\n");
  for (int pass = 0; pass < 2; pass++) {
    for (int i = OUTPUTS; i < VARIABLES; i++) {
      dea_text_add(out, "    <%s valueReference=\"%d\"/>\n",
                   pass == 0 ? "Output" : "InitialUnknown", i);
    }
  }
  dea_text_add(out, "  </ModelStructure>\n</fmiModelDescription>\n");
}

/* A program in the folder; *there: it exists. */
static dea_status run_program(struct dea_context *ctx, char *const argv[], const char *folder,
                              bool *there)
{
  enum { LIMIT_S = 120 };
  struct dea_program program;
  char said[DEA_PROGRAM_SAID];
  int number;
  const int reason = dea_program_start(argv, folder, true, &program);
  *there = reason != ENOENT;
  if (reason != 0) {
    return dea_fail(ctx, DEA_E_TOOL, "%s cannot be started: %s", argv[0], strerror(reason));
  }
  const enum dea_program_end end = dea_program_wait(ctx, &program, LIMIT_S, said, &number);
  return end == DEA_PROGRAM_DONE ? DEA_OK
         : end == DEA_PROGRAM_INTERRUPTED
             ? dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted while %s ran", argv[0])
             : dea_fail(ctx, DEA_E_TOOL, "%s failed: %s", argv[0], dea_last_lines(said, 2));
}

/* The files in the folder, with the library where there is a compiler, as one. */
static dea_status pack(struct dea_context *ctx, const char *folder, const char *xml,
                       const char *source, const char *path)
{
  char *const cc[] = {"cc", "-std=c99", "-O2",  "-w",  "-fPIC", "-shared", "-Wl,-Bsymbolic",
                      "-o", BINARY,     SOURCE, "-lm", NULL};
  char *const zip[] = {"zip", "-q", "-X", "-r", "model.zip", ".", NULL};
  const char *const files[][2] = {{"modelDescription.xml", xml}, {BUILD, build}, {SOURCE, source}};
  char name[DEA_TEMPORARY_SIZE + 60], *bytes = NULL;
  size_t length;
  bool there;
  snprintf(name, sizeof name, "%s/sources", folder);
  DEA_TRY(ctx, dea_folder_create(ctx, name));
  snprintf(name, sizeof name, "%s/" PLATFORM, folder);
  DEA_TRY(ctx, dea_folder_create(ctx, name));
  for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
    DEA_TRY(ctx, dea_file_write_into(ctx, folder, files[i][0], files[i][1], strlen(files[i][1])));
  }
  const dea_status compiled = run_program(ctx, cc, folder, &there);
  if (!there) {
    dea_context_clear(ctx);
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                 "%s has its source alone: there is no compiler cc", path));
  } else {
    DEA_TRY(ctx, compiled);
  }
  DEA_TRY(ctx, run_program(ctx, zip, folder, &there));
  snprintf(name, sizeof name, "%s/model.zip", folder);
  DEA_TRY(ctx, dea_file_read(ctx, name, FILE_MAX, &bytes, &length));
  const dea_status status = dea_file_write(ctx, path, bytes, length);
  dea_free(ctx, bytes);
  return status;
}

dea_status dea_reduced_write_fmu(struct dea_context *ctx, const struct dea_reduced_export *e,
                                 const char *path)
{
  struct dea_text xml = {.ctx = ctx}, source = {.ctx = ctx};
  char folder[DEA_TEMPORARY_SIZE];
  void *locale = dea_c_locale_enter();
  dea_reduced_add_c(e, &source);
  describe(&xml, e->order, e->name);
  dea_text_add(&source,
               "\nstatic const char fmi3_token[] = \"%s\";\n"
               "static const double fmi3_longest_step = %.17g;\n%s",
               e->order->device, longest_step(&e->order->core), dea_asset_fmi3);
  dea_c_locale_leave(locale);
  dea_status status =
      source.failed || xml.failed ? DEA_E_MEMORY : dea_folder_create_temporary(ctx, "fmu", folder);
  if (status == DEA_OK) {
    status = pack(ctx, folder, dea_text_get(&xml), dea_text_get(&source), path);
    dea_folder_remove_temporary(folder);
  }
  dea_text_free(&xml);
  dea_text_free(&source);
  return status;
}
