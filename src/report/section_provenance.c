/* Where a run comes from: enough to make it again. */
#include "report/section.h"

#include <string.h>

static void add_fact(struct dea_text *out, const char *what, const char *text)
{
  if (text != NULL && text[0] != '\0') {
    dea_text_add(out, "<dt>%s</dt>", what);
    dea_html_element(out, "dd", text);
  }
}

dea_status dea_section_provenance(struct dea_report *report, const struct dea_report_run *run)
{
  const struct dea_provenance *p = &run->run->result->provenance;
  struct dea_text *out = &report->text;
  dea_section_begin(report, "provenance", run->number, "Provenance");
  dea_text_add(out, "<dl class=\"facts\">");
  add_fact(out, "Program", p->program);
  add_fact(out, "Compiler", p->compiler);
  add_fact(out, "Build", p->build);
  add_fact(out, "Libraries", p->libraries);
  add_fact(out, "Started", p->started);
  dea_text_add(out, "<dt>Time</dt><dd>");
  dea_html_number(out, p->wall_s, 3);
  dea_text_add(out, " s</dd>");
  add_fact(out, "Command", p->command);
  add_fact(out, "Run folder", run->path);
  add_fact(out, "Design file", run->run->design_file);
  add_fact(out, "SHA-256 of the design", p->input_sha256);
  add_fact(out, "Overrides", p->overrides);
  dea_text_add(out, "</dl><details><summary>Design file</summary><div class=\"scroll\" "
                    "tabindex=\"0\" role=\"region\" aria-label=\"Design file\">");
  dea_html_element(out, "pre", p->input);
  dea_text_add(out, "</div></details>");
  dea_section_end(report);
  return DEA_OK;
}
