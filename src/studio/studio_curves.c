#include "studio/studio_curves.h"

#include "base/assets.h"
#include "base/file.h"
#include "base/write_file.h"
#include "compare/measured.h"
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

/* The film of one run in space, as a page of its own with the report's script. */
static dea_status add_film(struct dea_report *report)
{
  dea_text_add(&report->text,
               "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
               "<title>Film</title><style>%s</style></head><body><nav hidden><ul></ul></nav><main>",
               dea_asset_style);
  const size_t before = report->text.length;
  DEA_TRY(report->ctx, dea_section_membrane(report, &report->runs[0]));
  if (report->text.length == before) {
    dea_text_add(&report->text, "<p>This run has no film in space.</p>");
  }
  dea_text_add(&report->text, "</main><script>%s</script></body></html>\n", dea_asset_script);
  return report->text.failed ? DEA_E_MEMORY : DEA_OK;
}

/* Runs that are read: reads what is beside them, and draws. */
static dea_status draw(struct dea_context *ctx, const struct dea_report_run *runs, size_t count,
                       const char *measured, bool film, struct dea_text *out)
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
    status = film ? add_film(&report) : add_sections(&report);
    dea_c_locale_leave(before);
  }
  *out = report.text;
  dea_measured_destroy(ctx, beside);
  return status;
}

dea_status dea_studio_curves(struct dea_context *ctx, const char *const paths[], size_t count,
                             const char *measured, bool film, struct dea_text *out)
{
  struct dea_report_run runs[DEA_STUDIO_RUNS_MAX] = {0};
  dea_status status = DEA_OK;
  size_t read = 0;
  count = count < DEA_STUDIO_RUNS_MAX ? count : DEA_STUDIO_RUNS_MAX;
  while (read < count && status == DEA_OK) {
    struct dea_report_run *run = &runs[read];
    *run = (struct dea_report_run){.path = paths[read], .number = (int)read + 1};
    status = dea_run_read(ctx, paths[read], &run->run);
    if (status == DEA_OK) {
      snprintf(run->title, sizeof run->title, "%s", dea_path_name(paths[read]));
      read++;
    }
  }
  if (status == DEA_OK) {
    status = draw(ctx, runs, count, measured, film, out);
  }
  for (size_t i = 0; i < read; i++) {
    dea_run_destroy(ctx, runs[i].run);
  }
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}
