/* How sections and tables begin and end. */
#include "output/report/section.h"

void dea_section_begin(struct dea_report *report, const char *name, int number, const char *title)
{
  int level = number > 0 ? report->level : 2;
  dea_text_add(&report->text,
               "<section id=\"%s-%d\" aria-labelledby=\"%s-%d-h\"><h%d id=\"%s-%d-h\">", name,
               number, name, number, level, name, number);
  dea_html_text(&report->text, title);
  dea_text_add(&report->text, "</h%d>", level);
}

void dea_section_end(struct dea_report *report)
{
  dea_text_add(&report->text, "</section>\n");
}

void dea_section_heading(struct dea_report *report, const char *text)
{
  dea_html_element(&report->text, report->level == 2 ? "h3 class=\"part\"" : "h4 class=\"part\"",
                   text);
}

void dea_table_begin(struct dea_report *report, const char *caption, const char *header)
{
  struct dea_text *out = &report->text;
  dea_text_add(out, "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"");
  dea_html_text(out, caption);
  dea_text_add(out, "\"><table><caption>");
  dea_html_text(out, caption);
  dea_text_add(out, "</caption><thead><tr>%s</tr></thead><tbody>", header);
}

void dea_table_end(struct dea_report *report)
{
  dea_text_add(&report->text, "</tbody></table></div>");
}
