/* A run as the report reads it: results, design, notes. */
#include "base/file.h"
#include "base/write_file.h"
#include "output/report/section.h"
#include "study/design_file.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { OVERRIDES_MAX = 256, SUMMARY_MAX = 1 << 28 };

/* "key=value" a line -> overrides that lend from text, which is cut. */
static size_t split_overrides(char *text, struct dea_override *out)
{
  size_t count = 0;
  for (char *line = text; line != NULL && *line != '\0' && count < OVERRIDES_MAX;) {
    char *end = strchr(line, '\n'), *equals = strchr(line, '=');
    if (end != NULL) {
      *end = '\0';
    }
    if (equals != NULL && (end == NULL || equals < end)) {
      *equals = '\0';
      out[count++] = (struct dea_override){line, equals + 1};
    }
    line = end != NULL ? end + 1 : NULL;
  }
  return count;
}

dea_status dea_report_run_build(struct dea_context *ctx, const struct dea_report_run *run,
                                const struct dea_override *more, struct dea_design **design,
                                struct dea_device **device)
{
  const struct dea_provenance *p = &run->run->result->provenance;
  struct dea_override overrides[OVERRIDES_MAX + 1];
  const char *given = p->overrides != NULL ? p->overrides : "";
  const char *input = p->input != NULL ? p->input : "";
  *design = NULL;
  *device = NULL;
  char *text = dea_copy_text(ctx, given, strlen(given));
  const char *name = dea_intern(ctx, run->run->design_file);
  dea_status status = text == NULL || name == NULL ? DEA_E_MEMORY : DEA_OK;
  size_t count = text != NULL ? split_overrides(text, overrides) : 0;
  if (more != NULL) { // the last one of a key holds
    overrides[count++] = *more;
  }
  if (status == DEA_OK) {
    status = dea_design_read_memory(ctx, name, input, strlen(input), overrides, count, design);
  }
  if (status == DEA_OK) {
    status = dea_device_build(ctx, *design, device);
  }
  dea_free(ctx, text);
  return status;
}

double dea_report_run_voltage(const struct dea_report_run *run)
{
  const struct dea_result *result = run->run->result;
  double highest = 0;
  for (size_t i = 0; i < result->curve_count; i++) {
    for (size_t k = 0; k < result->curves[i].count; k++) {
      if (strcmp(result->curves[i].kind, "path") != 0) {
        highest = fmax(highest, result->curves[i].points[k].voltage_V);
      }
    }
  }
  return highest;
}

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
  if (moved == NULL) {
    return DEA_E_MEMORY;
  }
  run->notes = moved;
  moved[run->note_count] = dea_copy_text(ctx, text, strlen(text));
  if (moved[run->note_count] == NULL) {
    return DEA_E_MEMORY;
  }
  run->note_count++;
  return DEA_OK;
}

/* The notes of summary.json, when the run is a folder that has one: all that the run said. */
static dea_status read_summary(struct dea_context *ctx, struct dea_report_run *out, bool *found)
{
  *found = false;
  char *path = dea_path_join(ctx, out->path, "summary.json"), *bytes = NULL;
  size_t length;
  if (path == NULL) {
    return DEA_E_MEMORY;
  }
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
  dea_free(ctx, path);
  return status;
}

/* Without a summary: what reading the design says again. */
static dea_status take_findings(struct dea_context *ctx, struct dea_report_run *out)
{
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    if (findings[i].severity != DEA_ERROR) {
      DEA_TRY(ctx, add_note(ctx, out, findings[i].text));
    }
  }
  return DEA_OK;
}

static void name_run(struct dea_report_run *out)
{
  const char *file = out->run->design_file, *slash = strrchr(file, '/');
  file = out->run->title[0] != '\0' ? out->run->title : slash != NULL ? slash + 1 : file;
  snprintf(out->title, sizeof out->title, "%.*s", (int)sizeof out->title - 1, file);
}

dea_status dea_report_run_open(struct dea_context *ctx, const char *path, int number,
                               struct dea_report_run *out)
{
  *out = (struct dea_report_run){.path = path, .number = number};
  dea_finding_clear(ctx);
  DEA_TRY(ctx, dea_run_read(ctx, path, &out->run));
  name_run(out);
  dea_status status = dea_report_run_build(ctx, out, NULL, &out->design, &out->device);
  if (status == DEA_E_MEMORY) {
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  if (status != DEA_OK) {
    dea_device_destroy(ctx, out->device);
    out->device = NULL;
    out->missing = reason(ctx);
    dea_context_clear(ctx);
    if (out->missing == NULL) {
      return DEA_E_MEMORY;
    }
  } else {
    out->run->result->design = out->design;
    out->run->result->device = out->device;
  }
  bool found = false;
  if (dea_path_is_folder(path)) {
    DEA_TRY(ctx, read_summary(ctx, out, &found));
  }
  if (!found) {
    DEA_TRY(ctx, take_findings(ctx, out));
  }
  dea_finding_clear(ctx); // they stand in the page
  return DEA_OK;
}

void dea_report_run_close(struct dea_context *ctx, struct dea_report_run *run)
{
  for (size_t i = 0; i < run->note_count; i++) {
    dea_free(ctx, run->notes[i]);
  }
  dea_free(ctx, run->notes);
  dea_free(ctx, run->missing);
  dea_run_destroy(ctx, run->run);
  dea_device_destroy(ctx, run->device);
  dea_design_destroy(ctx, run->design);
}
