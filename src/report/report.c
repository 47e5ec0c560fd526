/* The page around the sections: head with the policy, header, contents, footer. */
#include "report/report.h"

#include "base/assets.h"
#include "base/version.h"
#include "base/write_file.h"
#include "compare/measured.h"
#include "report/section.h"

#include <sha256.h>
#include <stdio.h>

/* 'sha256-...' of what stands in a style or script element. */
static void add_hash(struct dea_text *out, const char *bytes, size_t length)
{
  uint8_t digest[SHA256_DIGEST_LENGTH];
  SHA256_CTX hash;
  SHA256_Init(&hash);
  SHA256_Update(&hash, (const uint8_t *)bytes, length);
  SHA256_Final(digest, &hash);
  dea_text_add(out, "'sha256-");
  dea_html_base64(out, digest, sizeof digest);
  dea_text_add(out, "'");
}

static void add_head(struct dea_report *report)
{
  struct dea_text *out = &report->text;
  dea_text_add(out, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
                    "base-uri 'none'; form-action 'none'; img-src data:; style-src ");
  add_hash(out, dea_asset_style, dea_asset_style_length);
  dea_text_add(out, "; script-src ");
  add_hash(out, dea_asset_script, dea_asset_script_length);
  dea_text_add(out, "\">\n<meta name=\"viewport\" content=\"width=device-width, "
                    "initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n"
                    "<meta name=\"generator\" content=\"dea " DEA_VERSION "\">\n");
  dea_html_element(out, "title", report->runs[0].title);
  dea_text_add(out, "\n<style>%s</style>\n</head>\n", dea_asset_style);
}

static void add_header(struct dea_report *report)
{
  struct dea_text *out = &report->text;
  const struct dea_provenance *p = &report->runs[0].run->result->provenance;
  char start[13];
  snprintf(start, sizeof start, "%.12s", p->input_sha256);
  dea_html_add(out,
               "<body>\n<a class=\"skip\" href=\"#main\">To the content</a>\n<header>"
               "<p class=\"kind\">Dielectric elastomer actuator</p><h1>%s</h1>",
               report->runs[0].title);
  if (report->count > 1) {
    dea_html_add(out, "<p>and %zu more run%s, beside each other</p>", report->count - 1,
                 report->count > 2 ? "s" : "");
  }
  dea_html_add(out,
               "<p class=\"made\">%s \302\267 %s \302\267 design <span class=\"code\">%s</span></p>"
               "</header>\n<nav aria-label=\"Contents\"><ul></ul></nav>\n<main id=\"main\">\n",
               p->program, p->started, start);
}

/* Where a run comes from: enough to make it again. */
static dea_status add_provenance(struct dea_report *report, const struct dea_report_run *run)
{
  const struct dea_provenance *p = &run->run->result->provenance;
  struct dea_text *out = &report->text;
  dea_section_begin(report, "provenance", run->number, "Provenance");
  dea_text_add(out, "<dl class=\"facts\">");
  dea_section_fact(out, "Program", p->program);
  dea_section_fact(out, "Compiler", p->compiler);
  dea_section_fact(out, "Build", p->build);
  dea_section_fact(out, "Libraries", p->libraries);
  dea_section_fact(out, "Started", p->started);
  dea_html_add(out, "<dt>Time</dt><dd>%.3G s</dd>", p->wall_s);
  dea_section_fact(out, "Command", p->command);
  dea_section_fact(out, "Run folder", run->path);
  dea_section_fact(out, "Design file", run->run->design_file);
  dea_section_fact(out, "SHA-256 of the design", p->input_sha256);
  dea_section_fact(out, "Overrides", p->overrides);
  dea_html_add(out,
               "</dl><details><summary>Design file</summary><div class=\"scroll\" tabindex=\"0\" "
               "role=\"region\" aria-label=\"Design file\"><pre>%s</pre></div></details>",
               p->input);
  dea_section_end(report);
  return DEA_OK;
}

static dea_status add_run(struct dea_report *report, const struct dea_report_run *run)
{
  static const dea_run_section sections[] = {
      dea_section_glance,  dea_section_design, dea_section_membrane,  dea_section_curves,
      dea_section_limits,  dea_section_map,    dea_section_touch,     dea_section_explorer,
      dea_section_studies, dea_section_points, dea_section_materials, add_provenance};
  bool alone = report->count == 1; // then the page's heading is the run's
  dea_text_add(&report->text, "<article id=\"run-%d\" aria-label=\"Run %d\">", run->number,
               run->number);
  if (!alone) {
    dea_html_add(&report->text, "<h2>%d %s</h2>\n", run->number, run->title);
  }
  for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
    DEA_TRY(report->ctx, sections[i](report, run));
  }
  dea_text_add(&report->text, "</article>\n");
  return DEA_OK;
}

static void add_end(struct dea_report *report)
{
  struct dea_text *out = &report->text;
  dea_section_begin(report, "cite", 0, "How to cite");
  dea_text_add(out,
               "<p>libdea " DEA_VERSION ", design and simulation of dielectric elastomer actuators "
               "(BSD-3-Clause). The actuator with fibres and its analytic model are those of "
               "<cite>Fiber-Reinforced Equibiaxial Dielectric Elastomer Actuator for Out-of-Plane "
               "Displacement</cite>.</p>");
  dea_section_end(report);
  dea_text_add(out, "</main>\n<footer><p>Written by dea " DEA_VERSION);
  if (report->options->command != NULL) {
    dea_html_add(out, ": <span class=\"code\">%s</span>", report->options->command);
  }
  dea_text_add(out, "</p></footer>\n");
  dea_text_add(out, "<script>%s</script>\n</body>\n</html>\n", dea_asset_script);
}

static dea_status add_page(struct dea_report *report)
{
  add_head(report);
  add_header(report);
  DEA_TRY(report->ctx, dea_section_compare(report));
  for (size_t i = 0; i < report->count; i++) {
    DEA_TRY(report->ctx, add_run(report, &report->runs[i]));
  }
  DEA_TRY(report->ctx, dea_section_fit(report));
  add_end(report);
  return DEA_OK;
}

dea_status dea_report_write(struct dea_context *ctx, const struct dea_report_run *runs,
                            size_t count, const struct dea_report_options *options,
                            const char *path)
{
  struct dea_report report = {.ctx = ctx,
                              .options = options,
                              .runs = runs,
                              .count = count,
                              .level = count > 1 ? 3 : 2,
                              .text = {.ctx = ctx}};
  struct dea_measured *measured = NULL;
  void *before = dea_c_locale_enter();
  dea_status status = DEA_OK;
  if (options->measurement != NULL) {
    status = dea_measured_read(ctx, options->measurement, &measured);
    status = status == DEA_OK ? dea_measured_fold(ctx, measured) : status;
    report.measurement = measured != NULL ? measured->points : NULL;
  }
  status = status == DEA_OK ? add_page(&report) : status;
  dea_c_locale_leave(before);
  status = status == DEA_OK ? dea_text_write_path(ctx, &report.text, path) : status;
  dea_text_free(&report.text);
  dea_measured_destroy(ctx, measured);
  return DEA_CHAIN(ctx, status);
}
