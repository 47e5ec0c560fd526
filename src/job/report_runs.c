#include "job/report_runs.h"

#include "base/file.h"
#include "base/json.h"
#include "base/write_file.h"
#include "io/sparse_grid.h"
#include "job/design_of_run.h"
#include "model/reduced/reduced.h"
#include "result/observation.h"
#include "study/study.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SUMMARY_MAX = 1 << 28, REDUCED_MAX = 1 << 26 };

// A run as the report reads it: results, design, notes --------------------------------------------

/* First error found, or the message of the failure; owned by the caller. */
static char *reason(struct dea_context *ctx)
{
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  const char *text = dea_context_message(ctx);
  for (size_t i = 0; i < count; i++) {
    if (findings[i].severity == DEA_ERROR) {
      text = findings[i].text;
      break;
    }
  }
  return dea_copy_text(ctx, text, strlen(text));
}

static dea_status add_note(struct dea_context *ctx, struct dea_report_run *run, const char *text)
{
  char **moved = dea_resize(ctx, run->notes, run->note_count + 1, sizeof *moved);
  DEA_TRY_MEMORY(moved != NULL);
  run->notes = moved;
  moved[run->note_count] = dea_copy_text(ctx, text, strlen(text));
  DEA_TRY_MEMORY(moved[run->note_count] != NULL);
  run->note_count++;
  return DEA_OK;
}

/* The notes of summary.json, when the run is a folder that has one: all that the run said. */
static dea_status read_summary(struct dea_context *ctx, struct dea_report_run *out, bool *found)
{
  *found = false;
  char path[DEA_PATH_SIZE], *bytes = NULL;
  size_t length;
  DEA_TRY(ctx, dea_path_build(ctx, out->path, "summary.json", path));
  dea_status status = DEA_OK;
  if (dea_path_exists(path) && dea_file_read(ctx, path, SUMMARY_MAX, &bytes, &length) == DEA_OK) {
    json_t *root = json_loadb(bytes, length, 0, NULL);
    const json_t *notes = json_object_get(root, "notes");
    *found = json_is_array(notes);
    for (size_t i = 0; i < json_array_size(notes) && status == DEA_OK; i++) {
      const char *note = json_string_value(json_array_get(notes, i));
      status = note != NULL ? add_note(ctx, out, note) : DEA_OK;
    }
    json_decref(root);
  }
  dea_context_clear(ctx);
  dea_free(ctx, bytes);
  return status;
}

/* Without a summary: what reading the design says again. */
static dea_status read_findings(struct dea_context *ctx, struct dea_report_run *out)
{
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(ctx, findings[i].severity != DEA_ERROR ? add_note(ctx, out, findings[i].text) : DEA_OK);
  }
  return DEA_OK;
}

/* Reads a run, its design, its notes. */
static dea_status open_run(struct dea_context *ctx, const char *path, int number,
                           struct dea_report_run *out)
{
  *out = (struct dea_report_run){.path = path, .number = number};
  dea_finding_clear(ctx);
  DEA_TRY(ctx, dea_run_read(ctx, path, &out->run));
  snprintf(out->title, sizeof out->title, "%.*s", (int)sizeof out->title - 1,
           out->run->title[0] != '\0' ? out->run->title : dea_path_name(out->run->design_file));
  dea_status status = dea_design_of_run(ctx, out->run, &out->design, &out->device);
  if (status == DEA_E_MEMORY) {
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  if (status != DEA_OK) {
    out->missing = reason(ctx);
    dea_context_clear(ctx);
    DEA_TRY_MEMORY(out->missing != NULL);
  } else {
    out->run->result->design = out->design;
    out->run->result->device = out->device;
  }
  bool found = false;
  DEA_TRY(ctx, dea_path_is_folder(path) ? read_summary(ctx, out, &found) : DEA_OK);
  DEA_TRY(ctx, !found ? read_findings(ctx, out) : DEA_OK);
  dea_finding_clear(ctx); // they stand in the page
  return DEA_OK;
}

// Model reduced -----------------------------------------------------------------------------------

/* Title of a column of load points (column), or of a monitor's motion (column 0). */
static json_t *title_json(struct dea_context *ctx, const struct dea_device *device, int column,
                          size_t monitor, int motion)
{
  char name[DEA_KEY_PART_SIZE], key[DEA_KEY_PART_SIZE + 32];
  if (column == 0) {
    dea_key_part(device->layout->monitors[monitor].name, name);
    snprintf(key, sizeof key, "%s_%s", name, dea_observed_columns[motion].key);
    column = dea_column_find(ctx, key);
  }
  const struct dea_column *of = column >= 0 ? dea_column_at(ctx, column) : &dea_point_columns[0];
  return json_pack("{s:s, s:s, s:s, s:f}", "key", of->key, "title", of->header, "unit",
                   of->display_unit, "factor", of->factor);
}

/* The file with the titles of its numbers, its coordinate's first. */
static dea_status add_titles(struct dea_context *ctx, const struct dea_reduced_order *o,
                             const char *bytes, size_t length, struct dea_report_run *io)
{
  json_t *root = json_loadb(bytes, length, 0, NULL), *titles = json_array();
  const struct dea_control *c = &o->coordinate;
  json_array_append_new(titles, title_json(ctx, io->device, c->column, c->body, c->component));
  for (size_t i = 0; i < o->output_count; i++) {
    const struct dea_reduced_output *of = &o->outputs[i];
    json_array_append_new(titles,
                          title_json(ctx, io->device, of->column, of->monitor, (int)of->motion));
  }
  json_object_set_new(root, "quantities", titles);
  return dea_json_text(ctx, root, &io->reduced);
}

/* Of a displacement: the largest force that holds it where it is at 0 V, at voltages of the sweep
 * to be trusted and below breakdown. */
static void find_blocked(const struct dea_reduced_order *o, const struct dea_curve *sweep,
                         struct dea_report_run *io)
{
  struct dea_reduced_point rest = {0};
  bool turns = dea_reduced_order_turns(o);
  io->blocked_N = io->blocked_V = NAN;
  if (turns || dea_reduced_at(&o->core, 0, 0, &rest) != DEA_REDUCED_OK) {
    return;
  }
  for (size_t i = 0; i < sweep->count; i++) {
    const struct dea_load_point *p = &sweep->points[i];
    struct dea_reduced_point held = {0};
    if (dea_load_point_trusted(p) && dea_load_point_safe(p) &&
        dea_reduced_held(&o->core, rest.q, p->voltage_V, &held) == DEA_REDUCED_OK &&
        !(fabs(held.force) <= io->blocked_N)) {
      io->blocked_N = fabs(held.force);
      io->blocked_V = p->voltage_V;
    }
  }
}

/* Sets `reduced` (owned by the run), blocked_N and blocked_V of a run by that model whose design
 * names a file of dea reduce-order that is there; of others `reduced` stays NULL. */
static dea_status read_reduced(struct dea_context *ctx, struct dea_report_run *io)
{
  const struct dea_curve *sweep = dea_result_find(io->run->result, "reduced", "sweep");
  if (io->device == NULL || sweep == NULL) {
    return DEA_OK;
  }
  const struct dea_model_settings settings = dea_model_settings_of(io->design);
  const char *file = settings.reduced.file;
  struct dea_reduced_order *order;
  char *bytes = NULL;
  size_t length;
  if (file == NULL || !dea_path_exists(file)) {
    return DEA_OK;
  }
  dea_status status = dea_reduced_order_read(ctx, file, io->device, &settings, &order);
  if (status != DEA_OK && status != DEA_E_MEMORY) { // made anew for another design since
    dea_context_clear(ctx);
    return DEA_OK;
  }
  status = status != DEA_OK ? status : dea_file_read(ctx, file, REDUCED_MAX, &bytes, &length);
  if (status == DEA_OK) {
    find_blocked(order, sweep, io);
    status = add_titles(ctx, order, bytes, length, io);
  }
  dea_free(ctx, bytes);
  dea_reduced_order_destroy(ctx, order);
  return status;
}

// The runs ----------------------------------------------------------------------------------------

dea_status dea_report_runs_open(struct dea_context *ctx, const char *const paths[], size_t count,
                                struct dea_report_run runs[])
{
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(ctx, open_run(ctx, paths[i], (int)i + 1, &runs[i]));
    DEA_TRY(ctx, read_reduced(ctx, &runs[i]));
  }
  return DEA_OK;
}

void dea_report_runs_close(struct dea_context *ctx, struct dea_report_run runs[], size_t count)
{
  for (struct dea_report_run *run = runs; run < runs + count; run++) {
    for (size_t i = 0; i < run->note_count; i++) {
      dea_free(ctx, run->notes[i]);
    }
    dea_free(ctx, run->notes);
    dea_free(ctx, run->reduced);
    dea_free(ctx, run->missing);
    dea_run_destroy(ctx, run->run);
    dea_device_destroy(ctx, run->device);
    dea_design_destroy(ctx, run->design);
  }
}

// What the page shows beyond what the run has -----------------------------------------------------

/* Study operating-map of model lumped, which the page shows of a disc that it is true for: not of
 * fibres beside a model that predicts how far they move. */
static dea_status complete(struct dea_context *ctx, struct dea_result *result)
{
  static const char model[] = "lumped", *const names[] = {"operating-map"};
  bool predicted = false;
  for (size_t i = 0; i < result->curve_count; i++) {
    predicted = predicted || strcmp(result->curves[i].model, "3d") == 0 ||
                strcmp(result->curves[i].model, "reduced") == 0;
  }
  if (result->device == NULL || !result->device->disc ||
      (predicted && result->device->fibre_count > 0) ||
      dea_result_find_table(result, model, names[0], "") != NULL) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_study_run(ctx, dea_model_find(model), names, 1, result));
  dea_finding_clear(ctx); // what the model says of itself, the page says too
  return DEA_OK;
}

dea_status dea_report_runs_explore(struct dea_context *ctx, const char *folder,
                                   struct dea_report_run runs[], size_t count, char **bytes)
{
  char path[DEA_PATH_SIZE], hash[65];
  size_t length, found = 0;
  DEA_TRY(ctx, dea_path_build(ctx, folder, "emulator.json", path));
  dea_status status = dea_file_read(ctx, path, SUMMARY_MAX, bytes, &length);
  if (status != DEA_OK) {
    return status == DEA_E_MEMORY
               ? status
               : dea_fail(ctx, DEA_E_IO,
                          "%s has no emulator.json: --explorer takes the folder of a dea sweep "
                          "with plan: sparse-grid that is done",
                          folder);
  }
  json_t *root = json_loadb(*bytes, length, 0, NULL);
  const char *of = json_string_value(json_object_get(root, "device"));
  for (size_t i = 0; i < count && status == DEA_OK && of != NULL; i++) {
    if (runs[i].device != NULL) {
      status = dea_emulator_device(ctx, runs[i].design, runs[i].device, hash);
      runs[i].emulator = status == DEA_OK && strcmp(hash, of) == 0 ? *bytes : NULL;
      found += runs[i].emulator != NULL ? 1U : 0U;
    }
  }
  json_decref(root);
  if (status == DEA_OK && found == 0) {
    status = dea_fail(ctx, DEA_E_DESIGN, "%s is a sweep of another design than that of the run%s",
                      folder, count > 1 ? "s" : "");
  }
  return status;
}

dea_status dea_job_report(struct dea_context *ctx, const char *const runs[], size_t count,
                          const struct dea_report_options *options, const char *path)
{
  struct dea_report_run opened[DEA_REPORT_RUNS_MAX] = {{0}};
  if (count == 0 || count > DEA_REPORT_RUNS_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a report takes 1 to %d runs, not %zu",
                    DEA_REPORT_RUNS_MAX, count);
  }
  void *before = dea_c_locale_enter();
  dea_status status = dea_report_runs_open(ctx, runs, count, opened);
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    status = complete(ctx, opened[i].run->result);
  }
  dea_c_locale_leave(before);
  char *emulator = NULL;
  if (status == DEA_OK && options->explorer != NULL) {
    status = dea_report_runs_explore(ctx, options->explorer, opened, count, &emulator);
  }
  status = status == DEA_OK ? dea_report_write(ctx, opened, count, options, path) : status;
  dea_free(ctx, emulator);
  dea_report_runs_close(ctx, opened, count);
  return DEA_CHAIN(ctx, status);
}
