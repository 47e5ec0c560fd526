/* A run as the report reads it: results, design, notes. */
#include "base/file.h"
#include "output/file.h"
#include "output/report/section.h"

#include <jansson.h>
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

/* Design and device of the text that the run keeps. */
static dea_status build(struct dea_context *ctx, struct dea_report_run *out)
{
  const struct dea_provenance *p = &out->run->result->provenance;
  struct dea_override overrides[OVERRIDES_MAX];
  const char *given = p->overrides != NULL ? p->overrides : "";
  char *text = dea_copy_text(ctx, given, strlen(given));
  const char *input = p->input != NULL ? p->input : "";
  if (text == NULL) {
    return DEA_E_MEMORY;
  }
  const char *name = dea_intern(ctx, out->run->design_file);
  dea_status status = name == NULL
                          ? DEA_E_MEMORY
                          : dea_design_read_memory(ctx, name, input, strlen(input), overrides,
                                                   split_overrides(text, overrides), &out->design);
  if (status == DEA_OK) {
    status = dea_device_build(ctx, out->design, &out->device);
  }
  dea_free(ctx, text);
  return status;
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
  dea_status status = build(ctx, out);
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
