/* How sections and tables begin and end. */
#include "report/section.h"

#include "plot/plot_svg.h"

#include <string.h>

enum { TABLE_COLUMNS_MAX = 64 };

void dea_section_begin(struct dea_report *report, const char *name, int number, const char *title)
{
  int level = number > 0 ? report->level : 2;
  dea_html_add(&report->text,
               "<section id=\"%s-%d\" aria-labelledby=\"%s-%d-h\"><h%d id=\"%s-%d-h\">%s</h%d>",
               name, number, name, number, level, name, number, title, level);
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

dea_status dea_section_plot(struct dea_report *report, struct dea_plot *plot, dea_status status)
{
  if (status == DEA_OK && dea_plot_shows(plot)) {
    dea_plot_add_svg(&report->text, plot, ++report->figures);
  }
  dea_plot_destroy(report->ctx, plot);
  return status;
}

void dea_section_fact(struct dea_text *out, const char *what, const char *text)
{
  if (text != NULL && text[0] != '\0') {
    dea_html_add(out, "<dt>%s</dt><dd>%s</dd>", what, text);
  }
}

void dea_table_begin(struct dea_report *report, const char *caption)
{
  report->table = report->text.length;
  dea_html_add(&report->text,
               "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"%s\"><table>"
               "<caption>%s</caption><thead><tr>",
               caption, caption);
}

void dea_table_head(struct dea_report *report, const char *titles)
{
  while (*titles != '\0') {
    const bool number = *titles == '#';
    titles += number;
    const size_t length = strcspn(titles, "|");
    dea_text_add(&report->text, "<th scope=\"col\"%s>%.*s</th>", number ? " class=\"n\"" : "",
                 (int)length, titles);
    titles += length + (titles[length] != '\0');
  }
  dea_text_add(&report->text, "</tr></thead><tbody>");
}

/* End of the cell that begins there; NULL: none does. blank: it has nothing to read, or a dash. */
static char *cell_end(char *cell, bool *blank)
{
  if (strncmp(cell, "<td", 3) != 0 && strncmp(cell, "<th", 3) != 0) {
    return NULL;
  }
  char *inside = strchr(cell, '>'), *end = strstr(cell, cell[2] == 'd' ? "</td>" : "</th>");
  if (inside == NULL || end == NULL) {
    return NULL;
  }
  inside++;
  *blank = inside == end || (end - inside == 3 && memcmp(inside, "\342\200\223", 3) == 0);
  return end + strlen("</td>");
}

/* First cell of the next row; NULL: there is no row more. */
static char *next_row(char *from)
{
  char *row = strstr(from, "<tr");
  row = row != NULL ? strchr(row, '>') : NULL;
  return row != NULL ? row + 1 : NULL;
}

void dea_table_end(struct dea_report *report)
{
  struct dea_text *out = &report->text;
  bool used[TABLE_COLUMNS_MAX] = {false}, blank = false;
  dea_text_add(out, "</tbody></table></div>");
  char *table = out->failed ? NULL : strstr(out->data + report->table, "<thead>");
  if (table == NULL || strstr(table, "span=") != NULL) {
    return;
  }
  char *body = strstr(table, "<tbody>");
  for (char *cell = next_row(body); cell != NULL; cell = next_row(cell)) {
    size_t column = 0;
    for (char *end; (end = cell_end(cell, &blank)) != NULL; cell = end, column++) {
      if (column == TABLE_COLUMNS_MAX) {
        return;
      }
      used[column] = used[column] || !blank;
    }
  }
  char *to = table, *from = table; // what is kept moves to the front
  for (char *cell = next_row(table); cell != NULL; cell = next_row(cell)) {
    size_t column = 0;
    for (char *end; (end = cell_end(cell, &blank)) != NULL; cell = end, column++) {
      size_t before = (size_t)(cell - from), own = used[column] ? (size_t)(end - cell) : 0;
      memmove(to, from, before + own);
      to += before + own;
      from = end;
    }
  }
  memmove(to, from, strlen(from) + 1);
  out->length = (size_t)(to - out->data) + strlen(to);
}
