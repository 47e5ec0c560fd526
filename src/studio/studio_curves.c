#include "studio/studio_curves.h"

#include "base/assets.h"
#include "base/file.h"
#include "base/write_file.h"
#include "compare/measured.h"
#include "job/report_runs.h"
#include "report/section.h"

#include <stdio.h>

static dea_status add_sections(struct dea_report *report)
{
  DEA_TRY(report->ctx, dea_section_compare(report));
  if (report->count == 1) {
    static const dea_run_section sections[] = {dea_section_curves, dea_section_studies,
                                               dea_section_limits};
    for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
      DEA_TRY(report->ctx, sections[i](report, &report->runs[0]));
    }
  }
  return report->text.failed ? DEA_E_MEMORY : DEA_OK;
}

/* A section of one run as a page of its own with the report's script. */
static dea_status add_page(struct dea_report *report, dea_run_section section)
{
  dea_text_add(&report->text,
               "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
               "<title>Run</title><style>%s</style></head><body><nav hidden><ul></ul></nav><main>",
               dea_asset_style);
  const size_t before = report->text.length;
  DEA_TRY(report->ctx, section(report, &report->runs[0]));
  if (report->text.length == before) {
    dea_text_add(&report->text, "<p>This run has %s.</p>",
                 section == dea_section_membrane ? "no film in space" : "nothing between points");
  }
  dea_text_add(&report->text, "</main><script>%s</script></body></html>\n", dea_asset_script);
  return report->text.failed ? DEA_E_MEMORY : DEA_OK;
}

/* Runs that are read: reads what is beside them, and draws. */
static dea_status draw(struct dea_context *ctx, const struct dea_report_run *runs, size_t count,
                       const char *measured, enum dea_studio_view view, struct dea_text *out)
{
  const struct dea_report_options options = {.measurement = measured};
  struct dea_report report = {
      .ctx = ctx, .options = &options, .runs = runs, .count = count, .level = 3, .text = *out};
  struct dea_measured *beside = NULL;
  dea_status status = DEA_OK;
  if (measured != NULL) {
    status = dea_measured_read(ctx, measured, &beside);
    status = status == DEA_OK ? dea_measured_fold(ctx, beside) : status;
    report.measurement = beside != NULL ? beside->points : NULL;
  }
  if (status == DEA_OK) {
    void *before = dea_c_locale_enter();
    status = view == DEA_STUDIO_CURVES ? add_sections(&report)
             : view == DEA_STUDIO_FILM ? add_page(&report, dea_section_membrane)
                                       : add_page(&report, dea_section_explorer);
    dea_c_locale_leave(before);
  }
  *out = report.text;
  dea_measured_destroy(ctx, beside);
  return status;
}

/* Of the sweeps that are there the first of the run's design. */
static dea_status find_sweep(struct dea_context *ctx, const char *folder, const json_t *sweeps,
                             struct dea_report_run *run, char **bytes)
{
  for (size_t i = 0; i < json_array_size(sweeps) && run->emulator == NULL; i++) {
    const json_t *name = json_object_get(json_array_get(sweeps, i), "name");
    char *path = dea_path_join(ctx, folder, json_string_value(name));
    dea_free(ctx, *bytes);
    *bytes = NULL;
    const dea_status status =
        path != NULL ? dea_report_runs_explore(ctx, path, run, 1, bytes) : DEA_E_MEMORY;
    dea_free(ctx, path);
    if (status == DEA_E_MEMORY) {
      return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
    }
    dea_context_clear(ctx); // it is of another design, or just being written
  }
  return DEA_OK;
}

dea_status dea_studio_show(struct dea_context *ctx, const char *folder, const json_t *names,
                           const char *measured, const json_t *sweeps, enum dea_studio_view view,
                           struct dea_text *out)
{
  struct dea_report_run runs[DEA_STUDIO_RUNS_MAX] = {{0}};
  char *paths[DEA_STUDIO_RUNS_MAX + 1] = {NULL}, *emulator = NULL;
  const size_t count = json_array_size(names);
  dea_status status = count <= DEA_STUDIO_RUNS_MAX ? DEA_OK : DEA_E_ARGUMENT;
  for (size_t i = 0; i <= count && status == DEA_OK; i++) {
    const char *name = i < count ? json_string_value(json_array_get(names, i)) : measured;
    paths[i] = name != NULL ? dea_path_join(ctx, folder, name) : NULL;
    status = paths[i] != NULL || name == NULL ? DEA_OK : DEA_E_MEMORY;
  }
  if (status == DEA_OK) {
    status = dea_report_runs_open(ctx, (const char *const *)paths, count, runs);
  }
  if (status == DEA_OK && view == DEA_STUDIO_SLIDERS) {
    status = find_sweep(ctx, folder, sweeps, &runs[0], &emulator);
  }
  for (size_t i = 0; i < count && status == DEA_OK; i++) { // they are known by their folders here
    snprintf(runs[i].title, sizeof runs[i].title, "%s", dea_path_name(paths[i]));
  }
  status = status == DEA_OK ? draw(ctx, runs, count, paths[count], view, out) : status;
  dea_free(ctx, emulator);
  dea_report_runs_close(ctx, runs, count <= DEA_STUDIO_RUNS_MAX ? count : 0);
  for (size_t i = 0; i <= DEA_STUDIO_RUNS_MAX; i++) {
    dea_free(ctx, paths[i]);
  }
  return DEA_CHAIN(ctx, status);
}
