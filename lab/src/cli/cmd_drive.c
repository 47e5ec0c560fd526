#define _POSIX_C_SOURCE 200809L // fstat
#include "cli/cli.h"

#include "base/file.h"
#include "base/json.h"
#include "base/write_file.h"
#include "drive/drive.h"
#include "film/film_of_design.h"
#include "instrument/instrument.h"
#include "protocol/protocol_export.h"
#include "recording/recorder.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

struct request {
  const char *protocol, *output, *folder; // NULL: not given
  bool arm, simulate, zero, checked, json, force;
  struct cli_overrides overrides;
};

// What would be played ---------------------------------------------------------------------------

/* What an instrument does, as a clause. */
static void roles_text(unsigned roles, char out[96])
{
  static const struct {
    unsigned role;
    const char *text;
  } all[] = {{DEA_PLAYS_OUTPUT, "plays the output"},
             {DEA_READS_INPUTS, "reads the channels"},
             {DEA_SENDS_PROFILES, "sends profiles"},
             {DEA_GIVES_READINGS, "gives readings"}};
  size_t length = 0; // of all of them: 66
  out[0] = '\0';
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
    if ((roles & all[i].role) != 0) {
      length +=
          (size_t)snprintf(out + length, 96 - length, "%s%s", length > 0 ? ", " : "", all[i].text);
    }
  }
}

static void print_sequence(const struct dea_protocol *protocol)
{
  puts("Sequence");
  for (size_t i = 0; i < protocol->step_count; i++) {
    const struct dea_protocol_step *step = &protocol->steps[i];
    double length_s = step->repeat.si * step->waveform->end_s;
    printf("  %zu  %-16s  %-10s  %g kV to %g kV, %zu cycle%s in %g s", i + 1, step->label.text,
           step->waveform->kind, 1e-3 * step->lowest_V, 1e-3 * step->highest_V,
           (size_t)step->repeat.si * step->cycles,
           (size_t)step->repeat.si * step->cycles == 1 ? "" : "s", length_s);
    if (step->pause_s.si > 0) {
      printf(", then %g s at 0 V", step->pause_s.si);
    }
    putchar('\n');
  }
}

/* Whoever overrides the interlock sees by how much. */
static void print_breakdown(const struct dea_protocol_plan *plan)
{
  double times = plan->largest_field_V_per_m / plan->breakdown_field_V_per_m;
  if (isnan(times)) {
    return;
  }
  printf("  %-16s  %.4g V/um by the film's material, ", "breakdown field",
         1e-6 * plan->breakdown_field_V_per_m);
  printf(times > 1 ? "%.3g times exceeded; probability " : "%.0f %% of it used; probability ",
         times > 1 ? times : 100 * times);
  if (isnan(plan->breakdown_probability)) {
    puts("unknown");
  } else {
    printf("%.2g %%", 100 * plan->breakdown_probability);
    if (!isnan(plan->breakdown_probability_band[0])) {
      printf(" (%.2g to %.2g %% by its sources)", 100 * plan->breakdown_probability_band[0],
             100 * plan->breakdown_probability_band[1]);
    }
    putchar('\n');
  }
}

static void print_film(const struct dea_protocol_plan *plan)
{
  if (!isnan(plan->largest_field_V_per_m)) {
    printf("  %-16s  %.4g V/um", "true field", 1e-6 * plan->largest_field_V_per_m);
    if (!isnan(plan->allowed_field_V_per_m)) {
      printf(" of %.4g V/um that are allowed", 1e-6 * plan->allowed_field_V_per_m);
    }
    putchar('\n');
    print_breakdown(plan);
  }
  if (!isnan(plan->pull_in_V)) {
    printf("  %-16s  %.4g kV\n", "pull-in", 1e-3 * plan->pull_in_V);
  }
  if (!isnan(plan->capacitance_F)) {
    printf("  %-16s  %.4g pF, %.3g mJ stored\n", "film", 1e12 * plan->capacitance_F,
           1e3 * plan->stored_energy_J);
  }
  if (plan->rise_s > 0) {
    printf("  %-16s  %.3g us\n", "largest jump in", 1e6 * plan->rise_s);
  }
}

/* What an instrument of the protocol does: some kinds play only where their section says so. */
static unsigned roles_of(struct dea_cli *cli, const struct dea_protocol *protocol, size_t index,
                         const struct dea_instrument_type *type)
{
  char address[DEA_INSTRUMENT_ADDRESS_SIZE] = "";
  const struct dea_protocol_instrument *section = &protocol->instruments[index];
  if (type == NULL || dea_instrument_address(cli->ctx, section, protocol, address) != DEA_OK) {
    return 0;
  }
  return address[0] != '\0' ? type->roles : type->roles & ~(unsigned)DEA_PLAYS_OUTPUT;
}

static void print_plan(struct dea_cli *cli, const struct dea_protocol *protocol,
                       const struct dea_protocol_plan *plan)
{
  double gain = protocol->amplifier.gain.si;
  printf("%s%s%s\n\n", protocol->file, protocol->title.text[0] != '\0' ? ": " : "",
         protocol->title.text);
  print_sequence(protocol);
  printf("\nPlan\n  %-16s  %g s, %zu cycle%s\n", "duration", plan->duration_s, plan->cycles,
         plan->cycles == 1 ? "" : "s");
  printf("  %-16s  %zu of %zu channel%s at %g a second\n", "samples", plan->samples,
         protocol->input_count, protocol->input_count == 1 ? "" : "s", protocol->rate_Hz.si);
  printf("  %-16s  %g kV to %g kV, by a control voltage of %g V to %g V\n", "voltage",
         1e-3 * plan->lowest_V, 1e-3 * plan->highest_V, plan->lowest_V / gain,
         plan->highest_V / gain);
  print_film(plan);
  puts("\nInstruments");
  for (size_t i = 0; i < protocol->instrument_count; i++) {
    const struct dea_node *kind = dea_node_find(protocol->instruments[i].section, "kind");
    const struct dea_instrument_type *type = dea_instrument_find(kind != NULL ? kind->text : "");
    char roles[96] = "";
    roles_text(roles_of(cli, protocol, i, type), roles);
    printf("  %zu  %-16s  %s\n", i + 1, type != NULL ? type->name : "?", roles);
  }
  if (protocol->instrument_count == 0) {
    puts("  none: there are only --sim and --export");
  }
}

static json_t *plan_json(const struct dea_protocol *protocol, const struct dea_protocol_plan *plan)
{
  json_t *json = json_object();
  dea_json_add_count(json, "cycles", plan->cycles);
  dea_json_add_count(json, "samples", plan->samples);
  dea_json_add_count(json, "channels", protocol->input_count);
  dea_json_add(json, "duration_s", plan->duration_s);
  dea_json_add(json, "rate_Hz", protocol->rate_Hz.si);
  dea_json_add(json, "lowest_V", plan->lowest_V);
  dea_json_add(json, "highest_V", plan->highest_V);
  dea_json_add(json, "largest_field_V_per_m", plan->largest_field_V_per_m);
  dea_json_add(json, "allowed_field_V_per_m", plan->allowed_field_V_per_m);
  dea_json_add(json, "breakdown_field_V_per_m", plan->breakdown_field_V_per_m);
  dea_json_add(json, "breakdown_probability", plan->breakdown_probability);
  dea_json_add(json, "breakdown_probability_low", plan->breakdown_probability_band[0]);
  dea_json_add(json, "breakdown_probability_high", plan->breakdown_probability_band[1]);
  dea_json_add(json, "pull_in_V", plan->pull_in_V);
  dea_json_add(json, "capacitance_F", plan->capacitance_F);
  dea_json_add(json, "stored_energy_J", plan->stored_energy_J);
  dea_json_add(json, "rise_s", plan->rise_s);
  return json;
}

// Playing ----------------------------------------------------------------------------------------

/* A recording, or what is left of one that was just begun; not the protocol or somebody's text. */
static bool may_be_replaced(const char *file)
{
  char head[8];
  size_t length;
  return !dea_path_is_folder(file) && dea_file_head(file, head, sizeof head, &length) &&
         (length == 0 || dea_head_is_h5(head, length));
}

/* Makes room for the recording. */
static dea_status clear_output(struct dea_cli *cli, const struct request *request, const char *file)
{
  if (!dea_path_exists(file)) {
    return DEA_OK;
  }
  if (!request->force) {
    return dea_fail(cli->ctx, DEA_E_IO,
                    "'%s' already exists; -o names another file, --force replaces this one", file);
  }
  if (!may_be_replaced(file)) {
    return dea_fail(cli->ctx, DEA_E_IO, "'%s' is no recording and is not replaced", file);
  }
  if (dea_recording_is_written(file)) {
    return dea_fail(cli->ctx, DEA_E_IO, "'%s' is being written by another program", file);
  }
  if (remove(file) != 0) {
    return dea_fail(cli->ctx, DEA_E_IO, "'%s' cannot be replaced", file);
  }
  return DEA_OK;
}

/* Folder of what is kept of supplies; owned by the caller. */
static dea_status state_folder(struct dea_cli *cli, char **out)
{
  const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
  struct dea_text text = {.ctx = cli->ctx};
  *out = NULL;
  if (state != NULL && state[0] == '/') {
    dea_text_add(&text, "%s/dea/supplies", state);
  } else if (home != NULL && home[0] == '/') {
    dea_text_add(&text, "%s/.local/state/dea/supplies", home);
  } else {
    return dea_fail(cli->ctx, DEA_E_IO,
                    "there is no place to keep whether the supply was left at 0 V: set "
                    "XDG_STATE_HOME to a folder of yours");
  }
  *out = text.failed ? NULL : dea_copy_text(cli->ctx, dea_text_get(&text), SIZE_MAX);
  dea_text_free(&text);
  return *out != NULL ? DEA_OK : DEA_E_MEMORY;
}

/* Why an output is not known to be at 0 V. */
static void add_reason(json_t *json, struct dea_zero zero)
{
  if (zero.state == DEA_ZERO_UNKNOWN && zero.why != NULL) {
    dea_json_add_text(json, "output_why", zero.why);
  }
}

/* Brings the output to 0 V, whatever the protocol would play. */
static dea_status zero(struct dea_cli *cli, const struct request *request,
                       struct dea_protocol *protocol)
{
  char *folder = NULL, known[DEA_ZERO_TEXT_SIZE];
  struct dea_zero output = {DEA_ZERO_NONE, NAN, NULL};
  dea_finding_clear(cli->ctx); // of what would be played
  dea_status status = state_folder(cli, &folder);
  if (status == DEA_OK) {
    status = dea_drive_zero(cli->ctx, protocol, folder, request->checked, &output);
  }
  dea_zero_text(output, known);
  if (request->json) {
    json_t *json = json_object();
    dea_json_add_text(json, "output", dea_zero_name(output.state));
    dea_json_add(json, "output_V", output.volts);
    add_reason(json, output);
    cli_print_json(json);
  } else {
    printf("  %-16s  %s\n", "output", known);
  }
  dea_free(cli->ctx, folder);
  dea_protocol_destroy(cli->ctx, protocol);
  return status;
}

/* Where a guard may say something after the program's end: a terminal or a file, of which nobody
 * waits for the end; -1: nowhere. */
static int report_at_exit(void)
{
  struct stat info;
  bool file = fstat(STDERR_FILENO, &info) == 0 && S_ISREG(info.st_mode);
  return file || isatty(STDERR_FILENO) ? STDERR_FILENO : -1;
}

static dea_status play(struct dea_cli *cli, const struct request *request,
                       const struct dea_protocol *protocol, const char *file,
                       struct dea_drive_report *report)
{
  struct dea_drive_options options = {.simulate = request->simulate,
                                      .file = file,
                                      .checked = request->checked,
                                      .guard = true,
                                      .tell = report_at_exit()};
  char *folder = NULL;
  if (request->arm && protocol->instrument_count == 0) {
    return dea_fail(cli->ctx, DEA_E_INSTRUMENT,
                    "%s names no `instruments` to play it; --sim plays it on a simulated bench",
                    protocol->file);
  }
  DEA_TRY(cli->ctx, clear_output(cli, request, file));
  DEA_TRY(cli->ctx, request->arm ? state_folder(cli, &folder) : DEA_OK);
  options.state_folder = folder;
  cli_voltage_is_on();
  dea_status status = dea_drive_run(cli->ctx, protocol, &options, report);
  dea_free(cli->ctx, folder);
  return status;
}

/* Files for another computer. */
static dea_status export(struct dea_cli *cli, const struct request *request,
                         const struct dea_protocol *protocol)
{
  if (dea_folder_has(request->folder, "waveform.csv") && !request->force) {
    return dea_fail(cli->ctx, DEA_E_IO, "'%s' has a waveform.csv already; --force replaces it",
                    request->folder);
  }
  return dea_protocol_export(cli->ctx, protocol, request->folder);
}

static json_t *report_json(const struct dea_drive_report *report, const char *file)
{
  json_t *json = json_object();
  dea_json_add_text(json, "file", file);
  dea_json_add(json, "played_s", report->played_s);
  dea_json_add_count(json, "cycles", report->cycles);
  dea_json_add_count(json, "lost", report->lost);
  dea_json_add_text(json, "output", dea_zero_name(report->zero.state));
  dea_json_add(json, "output_V", report->zero.volts);
  add_reason(json, report->zero);
  json_object_set_new(json, "reached_zero", json_boolean(report->zero.state == DEA_ZERO_READ_BACK));
  dea_json_add(json, "largest_current_A", report->largest_current_A);
  dea_json_add_text(json, "ended", report->ended);
  return json;
}

static void print_report(const struct dea_drive_report *report, const char *file)
{
  printf("\nRecording\n  %-16s  %s\n", "file", file);
  printf("  %-16s  %.6g s, %zu cycle%s to the end\n", "played", report->played_s, report->cycles,
         report->cycles == 1 ? "" : "s");
  printf("  %-16s  %zu sample%s or frames\n", "lost", report->lost, report->lost == 1 ? "" : "s");
  if (!isnan(report->largest_current_A)) {
    printf("  %-16s  %.6g uA\n", "largest current", 1e6 * report->largest_current_A);
  }
  char zero[DEA_ZERO_TEXT_SIZE];
  dea_zero_text(report->zero, zero);
  bool unknown = report->zero.state == DEA_ZERO_UNKNOWN;
  printf("  %-16s  %s%s\n", "output", unknown ? "SWITCH THE SUPPLY OFF: it is " : "", zero);
  if (report->ended[0] != '\0') {
    printf("  %-16s  %s\n", "ended early", report->ended);
  }
  printf("\nNext:  dea reduce %s\n", file);
}

// The command ------------------------------------------------------------------------------------

/* Reads and checks; *protocol is owned by the caller, also after a failure. For 0 V neither film
 * nor sequence matters. */
static dea_status read_and_check(struct dea_cli *cli, const struct request *request,
                                 struct dea_protocol **protocol, struct dea_protocol_plan *plan,
                                 bool *planned)
{
  struct dea_context *ctx = cli->ctx;
  const struct dea_bench_film_type *films = request->zero ? NULL : &dea_film_of_design;
  DEA_TRY(ctx, dea_protocol_read(ctx, films, request->protocol, request->overrides.at,
                                 request->overrides.count, protocol));
  DEA_TRY(ctx, dea_instrument_check(ctx, *protocol));
  if (dea_finding_count(ctx, DEA_ERROR) > 0) {
    return dea_fail(ctx, DEA_E_DESIGN, "the instruments of '%s' have errors", (*protocol)->file);
  }
  if (request->zero) {
    return DEA_OK;
  }
  dea_status status = dea_protocol_check(ctx, *protocol, plan);
  *planned = status == DEA_OK || status == DEA_E_INTERLOCK;
  return status;
}

static json_t *whole_json(struct dea_cli *cli, const struct request *request, dea_status status,
                          const struct dea_protocol *protocol, const struct dea_protocol_plan *plan)
{
  json_t *json = json_object();
  dea_json_add_text(json, "protocol", request->protocol);
  json_object_set_new(json, "good", json_boolean(status == DEA_OK));
  json_object_set_new(json, "findings", cli_findings_json(cli->ctx));
  if (plan != NULL) {
    json_object_set_new(json, "plan", plan_json(protocol, plan));
  }
  return json;
}

static dea_status run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  struct dea_protocol *protocol = NULL;
  struct dea_protocol_plan plan;
  struct dea_drive_report report = {.largest_current_A = NAN};
  const char *file = request->output;
  bool planned = false, played = false;
  dea_status status = read_and_check(cli, request, &protocol, &plan, &planned);
  if (request->zero && status == DEA_OK) {
    return zero(cli, request, protocol);
  }
  if (planned && !request->json) {
    print_plan(cli, protocol, &plan);
    fflush(stdout);
  }
  status = status == DEA_OK ? cli_output_name(cli, request->protocol, "h5", &file) : status;
  if (status == DEA_OK && (request->arm || request->simulate)) {
    status = play(cli, request, protocol, file, &report);
    played = dea_path_exists(file) && (status == DEA_OK || report.played_s > 0);
  }
  status = status == DEA_OK && request->folder != NULL ? export(cli, request, protocol) : status;
  if (request->json) {
    json_t *json = whole_json(cli, request, status, protocol, planned ? &plan : NULL);
    if (played) {
      json_object_set_new(json, "recording", report_json(&report, file));
    }
    cli_print_json(json);
  } else if (played) {
    print_report(&report, file);
  } else if (status == DEA_OK && request->folder != NULL) {
    printf("\nFiles\n  %s\n\nNext:  read %s/README.txt\n", request->folder, request->folder);
  } else if (status == DEA_OK) {
    printf("\nNothing was played. Next:  dea drive %s --sim\n", request->protocol);
  }
  dea_protocol_destroy(cli->ctx, protocol);
  return status;
}

static const struct cli_option options[] = {
    CLI_ONE(CLI_DESIGN, "PROTOCOL", "protocol of the experiment", protocol, "a protocol is needed",
            "one protocol at a time"),
    {"arm", 0, CLI_FLAG, NULL, "play on the instruments of the protocol: HIGH VOLTAGE",
     CLI_AT(arm)},
    {"sim", 0, CLI_FLAG, NULL, "play on a simulated bench, a model of the design with noise",
     CLI_AT(simulate), .or_before = true},
    {"zero", 0, CLI_FLAG, NULL,
     "end what drives the protocol's supply, bring its output to 0 V, and read it back",
     CLI_AT(zero), .or_before = true},
    {"export", 0, CLI_FOLDER, "DIR",
     "write the waveform, and scripts for MATLAB and Python that play it and record on a computer "
     "with NI-DAQmx, into DIR",
     CLI_AT(folder), .or_before = true},
    {"checked", 0, CLI_FLAG, NULL,
     "somebody has looked at supply and specimen after an unclean end", CLI_AT(checked)},
    CLI_OUTPUT_ROW(
        CLI_NEW_FILE, "FILE",
        "name of the recording; by default that of the protocol with .h5, in the current folder"),
    CLI_FORCE_ROW('f', "replace a recording or files of that name"),
    CLI_SET_ROW(0, CLI_PROTOCOL_KEY, "rate=2kHz"),
    CLI_JSON_ROW("plan, findings and what was recorded as JSON"),
    {0}};

const struct dea_command cmd_drive = {
    .name = "drive",
    .summary = "Play a protocol to a high-voltage amplifier and record what the film does",
    .about =
        "Experimental: tried on simulated instruments only, not yet on hardware.\n\n"
        "Without --arm or --sim nothing is played: the plan is printed, and what is wrong with "
        "it.\n\n"
        "Ctrl-C brings the voltage to 0 V along the protocol's ramp. Exit code 6: a limit of the "
        "bench would be or was exceeded, an instrument failed, or the output is not known to be at "
        "0 V. 'dea schema --protocol' lists "
        "the keys of a protocol.",
    CLI_RUN};
