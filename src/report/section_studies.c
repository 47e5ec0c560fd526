/* What studies have made tables of, a section each: its figures and its tables, without knowing the
 * study. */
#include "figures/run_figures.h"
#include "report/section.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { DIGITS = 5, ERROR_DIGITS = 2 };

static bool is_shown(const struct dea_result_table *table)
{
  return table->row_count > 0 && (table->type.where & DEA_IN_SCREEN) != 0;
}

/* First table of a study that a section shows; NULL: none. */
static const struct dea_result_table *first_table(const struct dea_result *result,
                                                  const char *study)
{
  for (size_t i = 0; i < result->table_count; i++) {
    if (is_shown(&result->tables[i]) && strcmp(result->tables[i].type.study, study) == 0) {
      return &result->tables[i];
    }
  }
  return NULL;
}

// Figures ----------------------------------------------------------------------------------------

/* Adds a figure; the notes of a plot that was not asked for are nobody's. */
static dea_status add_figure(struct dea_report *report, const struct dea_figure *figure,
                             const struct dea_result *result)
{
  struct dea_plot *plot;
  DEA_TRY(report->ctx, dea_plot_create(report->ctx, figure->name, figure->caption, &plot));
  return dea_section_plot(report, plot, figure->build(report->ctx, result, plot));
}

static bool has_tables(const struct dea_result *result, const char *study)
{
  bool found = false;
  for (size_t i = 0; i < result->table_count && !found; i++) {
    found = result->tables[i].row_count > 0 && strcmp(result->tables[i].type.study, study) == 0;
  }
  return found;
}

/* Whether it is one of the study; for NULL whether no study has a section that it stands in. */
static bool belongs(const struct dea_figure *figure, const struct dea_result *result,
                    const char *study)
{
  if (study == NULL) {
    return figure->study == NULL || !has_tables(result, figure->study);
  }
  return figure->study != NULL && strcmp(figure->study, study) == 0;
}

dea_status dea_section_figures(struct dea_report *report, const struct dea_report_run *run,
                               const char *study)
{
  const struct dea_figure *figure;
  dea_text_add(&report->text, "<div class=\"plots\">");
  for (size_t i = 0; (figure = dea_figure_get(i)) != NULL; i++) {
    if (figure->build != NULL && belongs(figure, run->run->result, study)) {
      DEA_TRY(report->ctx, add_figure(report, figure, run->run->result));
    }
  }
  dea_text_add(&report->text, "</div>");
  return DEA_OK;
}

// Tables -----------------------------------------------------------------------------------------

static bool is_text(const struct dea_result_column *column)
{
  return column->kind == DEA_CELL_TEXT || column->kind == DEA_CELL_QUANTITY;
}

static void add_header(struct dea_text *out, const struct dea_result_table *table)
{
  for (size_t c = 0; c < table->type.column_count; c++) {
    const struct dea_result_column *column = &table->type.columns[c];
    struct dea_text title = {.ctx = out->ctx};
    if (dea_result_table_shown(table, c, DEA_IN_SCREEN) > 0) {
      dea_result_table_column_title(column, &title);
      dea_text_add(out, "<th scope=\"col\"%s", is_text(column) ? "" : " class=\"n\"");
      dea_html_add(out, " colspan=\"%zu\" title=\"%s\">%s</th>", dea_result_table_values(table, c),
                   column->meaning, dea_text_get(&title));
    }
    dea_text_free_in(&title, out);
  }
}

/* With the unit of its quantity where the title cannot say it. */
static void add_cell(struct dea_text *out, const struct dea_result_table *table, size_t row,
                     size_t c, size_t value)
{
  const struct dea_result_column *column = &table->type.columns[c];
  const struct dea_column *quantity = dea_result_table_quantity(table, row);
  struct dea_text cell = {.ctx = out->ctx};
  bool error = column->list && column->display_unit != NULL; // in per cent
  dea_result_table_cell_text(table, row, c, value, error ? ERROR_DIGITS : DIGITS, &cell);
  if (cell.length > 0 && column->kind == DEA_CELL_VALUE && quantity != NULL &&
      strcmp(quantity->display_unit, "1") != 0) {
    dea_text_add(&cell, " %s", quantity->display_unit);
  }
  dea_html_element(out, is_text(column) ? "td" : "td class=\"n\"", dea_text_get(&cell));
  dea_text_free_in(&cell, out);
}

static void add_rows(struct dea_report *report, const struct dea_result_table *table,
                     const char *caption)
{
  struct dea_text *out = &report->text;
  dea_table_begin(report, caption);
  add_header(out, table);
  dea_table_head(report, "");
  for (size_t row = 0; row < table->row_count; row++) {
    dea_text_add(out, "<tr>");
    for (size_t c = 0; c < table->type.column_count; c++) {
      for (size_t k = 0; k < dea_result_table_shown(table, c, DEA_IN_SCREEN); k++) {
        add_cell(out, table, row, c, k);
      }
    }
    dea_text_add(out, "</tr>");
  }
  dea_table_end(report);
}

/* A table of one row: cards, and below them what fills lines. */
static void add_facts(struct dea_report *report, const struct dea_result_table *table)
{
  struct dea_text *out = &report->text;
  for (int words = 0; words < 2; words++) {
    dea_text_add(out, words == 0 ? "<dl class=\"cards\">" : "</dl>");
    for (size_t c = 0; c < table->type.column_count; c++) {
      const struct dea_result_column *column = &table->type.columns[c];
      const char *unit = column->display_unit != NULL ? column->display_unit : "1";
      struct dea_text cell = {.ctx = report->ctx};
      dea_result_table_cell_text(table, 0, c, 0, DIGITS, &cell);
      bool lines = strchr(dea_text_get(&cell), '\n') != NULL;
      bool wanted = dea_result_table_shown(table, c, DEA_IN_SCREEN) > 0 && cell.length > 0 &&
                    lines == (words == 1);
      if (wanted && words == 1) {
        dea_html_element(out, "p class=\"verdict\"", dea_text_get(&cell));
      } else if (wanted) {
        dea_html_add(
            out, "<div class=\"card\"><dt>%s</dt><dd>%s <span class=\"unit\">%s</span></dd></div>",
            column->title, dea_text_get(&cell), strcmp(unit, "1") != 0 ? unit : "");
      }
      dea_text_free_in(&cell, out);
    }
  }
}

static dea_status add_study(struct dea_report *report, const struct dea_report_run *run,
                            const char *study)
{
  const struct dea_result *result = run->run->result;
  char title[DEA_NAME_SIZE], caption[2 * DEA_NAME_SIZE + 64];
  snprintf(title, sizeof title, "%s", study);
  title[0] = (char)toupper((unsigned char)title[0]);
  dea_section_begin(report, study, run->number, title);
  DEA_TRY(report->ctx, dea_section_figures(report, run, study));
  for (size_t i = 0; i < result->table_count; i++) {
    const struct dea_result_table *table = &result->tables[i];
    if (!is_shown(table) || strcmp(table->type.study, study) != 0) {
      continue;
    }
    snprintf(caption, sizeof caption, "%s: %s", table->model, table->type.title);
    if (table->type.one_row) {
      dea_section_heading(report, caption);
      add_facts(report, table);
    } else {
      add_rows(report, table, caption);
    }
  }
  dea_section_end(report);
  return DEA_OK;
}

dea_status dea_section_studies(struct dea_report *report, const struct dea_report_run *run)
{
  const struct dea_result *result = run->run->result;
  for (size_t i = 0; i < result->table_count; i++) {
    const struct dea_result_table *table = &result->tables[i];
    if (table == first_table(result, table->type.study)) {
      DEA_TRY(report->ctx, add_study(report, run, table->type.study));
    }
  }
  return DEA_OK;
}

/* At which voltages the actuator works, against a parameter of the design. */
dea_status dea_section_map(struct dea_report *report, const struct dea_report_run *run)
{
  const struct dea_result *result = run->run->result;
  const struct dea_result_table *scale = NULL;
  for (size_t i = 0; i < result->table_count && scale == NULL; i++) {
    scale = strcmp(result->tables[i].type.study, "operating-map") == 0 ? &result->tables[i] : NULL;
  }
  if (run->device == NULL || scale == NULL) {
    return DEA_OK;
  }
  dea_section_begin(report, "map", run->number, "Operating map");
  dea_text_add(&report->text, "<p>Other values of the design are as they are. %s%s</p>",
               run->device->fibre_count > 0
                   ? "Displacements of model lumped are those of rigid rods, so upper bounds. "
                   : "",
               run->device->film.breakdown.known ? ""
                                                 : "The breakdown field of this film is unknown.");
  DEA_TRY(report->ctx, dea_section_figures(report, run, "operating-map"));
  dea_section_end(report);
  return DEA_OK;
}
