/* What the sections of a report share. A section appends to the text of the report; one that has
 * nothing to show adds nothing. Numbers are formatted in the C locale. */
#pragma once

#include "base/html.h"
#include "io/csv.h"
#include "plot/plot.h"
#include "report/report.h"

struct dea_report {
  struct dea_context *ctx;
  const struct dea_report_options *options;
  const struct dea_report_run *runs; // [count]
  size_t count;
  const struct dea_measurement *measurement; // lent; NULL: none
  struct dea_text text;
  size_t table; // where the last table begins in the text
  int level;    // of the headings of a run's sections
  int figures;  // so far
};

/* "<section ...><h2>title</h2>": of a run, or of the page (number 0), with an id made of both. */
void dea_section_begin(struct dea_report *report, const char *name, int number, const char *title);
void dea_section_end(struct dea_report *report);
/* A heading within a section of a run. */
void dea_section_heading(struct dea_report *report, const char *text);
/* A row of a list of facts, where there is a text. */
void dea_section_fact(struct dea_text *out, const char *what, const char *text);
/* A table that scrolls sideways: caption, then the cells of its head (<th>) up to dea_table_head.
 */
void dea_table_begin(struct dea_report *report, const char *caption);
/* Adds cells to the head, "TITLE|#TITLE" (ours) with # before titles of numbers, and ends it. */
void dea_table_head(struct dea_report *report, const char *titles);
/* Ends it, and takes out columns in which no row has anything, but for tables with merged cells. */
void dea_table_end(struct dea_report *report);

/* Adds a plot that shows something, where status is good; destroys it. Returns that status. */
dea_status dea_section_plot(struct dea_report *report, struct dea_plot *plot, dea_status status);
/* Figures of a run that belong to a study; NULL: those that stand in no study's section. */
dea_status dea_section_figures(struct dea_report *report, const struct dea_report_run *run,
                               const char *study);

typedef dea_status (*dea_run_section)(struct dea_report *report, const struct dea_report_run *run);
dea_status dea_section_glance(struct dea_report *report, const struct dea_report_run *run);
dea_status dea_section_design(struct dea_report *report, const struct dea_report_run *run);
dea_status dea_section_materials(struct dea_report *report, const struct dea_report_run *run);
dea_status dea_section_curves(struct dea_report *report, const struct dea_report_run *run);
dea_status dea_section_membrane(struct dea_report *report, const struct dea_report_run *run);
dea_status dea_section_map(struct dea_report *report, const struct dea_report_run *run);
dea_status dea_section_touch(struct dea_report *report, const struct dea_report_run *run);
dea_status dea_section_explorer(struct dea_report *report, const struct dea_report_run *run);
dea_status dea_section_limits(struct dea_report *report, const struct dea_report_run *run);
dea_status dea_section_studies(struct dea_report *report, const struct dea_report_run *run);
dea_status dea_section_points(struct dea_report *report, const struct dea_report_run *run);
/* Of the folder of a fit, where the options name one. */
dea_status dea_section_fit(struct dea_report *report);
/* Of all runs: curves in one figure, last points in one table. */
dea_status dea_section_compare(struct dea_report *report);
