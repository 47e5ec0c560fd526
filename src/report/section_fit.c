/* A fit that belongs to the runs: what `dea fit` wrote into its folder (docs/fit.md). */
#include "base/file.h"
#include "base/json.h"
#include "base/write_file.h"
#include "report/section.h"

#include <math.h>
#include <stdio.h>

enum { FILE_MAX = 64 << 20 };

static double number_of(const json_t *object, const char *key)
{
  const json_t *value = json_object_get(object, key);
  return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

/* NULL: there is no such text. */
static const char *text_of(const json_t *object, const char *key)
{
  return json_string_value(json_object_get(object, key));
}

static void add_fact(struct dea_text *out, const char *what, const json_t *root, const char *key)
{
  dea_section_fact(out, what, text_of(root, key));
}

static void add_facts(struct dea_text *out, const json_t *root)
{
  static const char *const files[] = {"tests", "curves"};
  dea_text_add(out, "<dl class=\"facts\">");
  add_fact(out, "Material", root, "material");
  add_fact(out, "Law", root, "law");
  add_fact(out, "Device", root, "name");
  add_fact(out, "Model", root, "model");
  add_fact(out, "Fit file", root, "file");
  add_fact(out, "SHA-256 of the fit file", root, "sha256");
  add_fact(out, "Design that was meant", root, "design");
  add_fact(out, "Films", root, "tests");
  add_fact(out, "SHA-256 of the films", root, "tests_sha256");
  for (size_t k = 0; k < sizeof files / sizeof files[0]; k++) {
    const json_t *list = json_object_get(root, files[k]);
    for (size_t i = 0; i < json_array_size(list); i++) {
      add_fact(out, "Measurement", json_array_get(list, i), "file");
      add_fact(out, "its SHA-256", json_array_get(list, i), "sha256");
    }
  }
  add_fact(out, "Program", root, "program");
  add_fact(out, "Command", root, "command");
  dea_text_add(out, "</dl>");
}

/* How well a value is known where its number does not say it. */
static const char *known_as(const json_t *value)
{
  return json_is_true(json_object_get(value, "fixed"))         ? "fixed"
         : json_is_true(json_object_get(value, "at_bound"))    ? "at its bound"
         : json_is_false(json_object_get(value, "determined")) ? "not determined"
                                                               : NULL;
}

static void add_parameters(struct dea_report *report, const json_t *list)
{
  struct dea_text *out = &report->text;
  dea_table_begin(report, "What was fitted, with one standard uncertainty");
  dea_table_head(report, "parameter|unit|as designed|value|&plusmn;|68 %: from|to");
  for (size_t i = 0; i < json_array_size(list); i++) {
    const json_t *value = json_array_get(list, i);
    const char *known = known_as(value);
    dea_html_add(out,
                 "<tr><th scope=\"row\">%s</th><td>%s</td><td class=\"n\">%.6G</td>"
                 "<td class=\"n\">%.6G</td>",
                 text_of(value, "name"), text_of(value, "unit"), number_of(value, "designed"),
                 number_of(value, "value"));
    if (known != NULL) {
      dea_html_element(out, "td", known);
    } else {
      dea_html_cell(out, number_of(value, "standard_uncertainty"), 3);
    }
    dea_html_add(out, "<td class=\"n\">%.6G</td><td class=\"n\">%.6G</td></tr>",
                 number_of(value, "interval_low"), number_of(value, "interval_high"));
  }
  dea_table_end(report);
}

static void add_correlations(struct dea_report *report, const json_t *root)
{
  struct dea_text *out = &report->text;
  const json_t *names = json_object_get(root, "parameters");
  const json_t *rows = json_object_get(root, "correlations");
  if (json_array_size(rows) < 2) {
    return;
  }
  dea_table_begin(report, "Correlations");
  dea_text_add(out, "<th scope=\"col\"></th>");
  for (size_t i = 0; i < json_array_size(names); i++) {
    dea_html_element(out, "th scope=\"col\"", text_of(json_array_get(names, i), "name"));
  }
  dea_table_head(report, "");
  for (size_t i = 0; i < json_array_size(rows); i++) {
    const json_t *row = json_array_get(rows, i);
    dea_html_add(out, "<tr><th scope=\"row\">%s</th>", text_of(json_array_get(names, i), "name"));
    for (size_t k = 0; k < json_array_size(row); k++) {
      dea_html_cell(out, json_number_value(json_array_get(row, k)), 3);
    }
    dea_text_add(out, "</tr>");
  }
  dea_table_end(report);
}

/* What the measurements cannot tell, and what would. */
static void add_advice(struct dea_text *out, const json_t *root)
{
  static const char *const next[][2] = {{"next_tests", "test"},
                                        {"next_measurements", "measurement"}};
  const json_t *advice = json_object_get(root, "advice");
  const json_t *weak = json_object_get(advice, "weak");
  const json_t *pairs = json_object_get(advice, "not_told_apart");
  dea_text_add(out, "<ul>");
  if (json_is_false(json_object_get(root, "slack_settled"))) {
    dea_text_add(out, "<li>Which rows are slack did not settle: the values found would have others "
                      "left out than were</li>");
  }
  for (size_t i = 0; i < json_array_size(weak); i++) {
    dea_html_element(out, "li", json_string_value(json_array_get(weak, i)));
  }
  for (size_t i = 0; i < json_array_size(pairs); i++) {
    const json_t *pair = json_array_get(pairs, i);
    const char *tells = text_of(pair, "would_tell");
    dea_html_add(out, "<li>%s and %s are not told apart%s%s</li>", text_of(pair, "first"),
                 text_of(pair, "second"),
                 tells != NULL && tells[0] != '\0' ? "; this would tell: " : "", tells);
  }
  for (size_t k = 0; k < 2; k++) {
    const json_t *first = json_array_get(json_object_get(advice, next[k][0]), 0);
    if (first != NULL) {
      dea_html_add(out, "<li>the %s that would tell most: %s (error bars times %.2G)</li>",
                   next[k][1], text_of(first, next[k][1]), number_of(first, "error_bars_times"));
    }
  }
  dea_text_add(out, "</ul>");
}

/* A figure of the folder; nothing where there is none of that name. */
static dea_status add_figure(struct dea_report *report, const char *folder, const char *name,
                             const char *what)
{
  struct dea_text *out = &report->text;
  char file[96], path[DEA_PATH_SIZE], *bytes;
  size_t length;
  snprintf(file, sizeof file, "%.80s.svg", name);
  DEA_TRY(report->ctx, dea_path_build(report->ctx, folder, file, path));
  if (!dea_path_exists(path)) {
    return DEA_OK;
  }
  DEA_TRY(report->ctx, dea_file_read(report->ctx, path, FILE_MAX, &bytes, &length));
  dea_html_add(out, "<figure><img alt=\"%s\" src=\"data:image/svg+xml;base64,", what);
  dea_html_base64(out, bytes, length);
  dea_html_add(out, "\"/><figcaption>%s</figcaption></figure>", what);
  dea_free(report->ctx, bytes);
  return DEA_OK;
}

static dea_status add_figures(struct dea_report *report, const char *folder)
{
  dea_text_add(&report->text, "<div class=\"plots\">");
  DEA_TRY(report->ctx, add_figure(report, folder, "fit", "measurements and fit"));
  DEA_TRY(report->ctx, add_figure(report, folder, "fit_time", "measurements and fit over time"));
  for (int c = 0; c < dea_column_count(report->ctx); c++) {
    char name[80], what[128];
    snprintf(name, sizeof name, "fit_%.60s", dea_column_at(report->ctx, c)->key);
    snprintf(what, sizeof what, "%.60s: measured, as fitted, as designed",
             dea_column_at(report->ctx, c)->header);
    DEA_TRY(report->ctx, add_figure(report, folder, name, what));
    snprintf(name, sizeof name, "fit_time_%.60s", dea_column_at(report->ctx, c)->key);
    DEA_TRY(report->ctx, add_figure(report, folder, name, what));
  }
  dea_text_add(&report->text, "</div>");
  return DEA_OK;
}

dea_status dea_section_fit(struct dea_report *report)
{
  const char *folder = report->options->fit;
  char path[DEA_PATH_SIZE], *bytes;
  size_t length;
  if (folder == NULL) {
    return DEA_OK;
  }
  DEA_TRY(report->ctx, dea_path_build(report->ctx, folder, "fit.json", path));
  DEA_TRY(report->ctx, dea_file_read(report->ctx, path, FILE_MAX, &bytes, &length));
  json_t *root = json_loadb(bytes, length, 0, NULL);
  dea_free(report->ctx, bytes);
  if (!json_is_object(root) || !json_is_array(json_object_get(root, "parameters"))) {
    json_decref(root);
    return dea_fail(report->ctx, DEA_E_IO, "%s holds no fit: its fit.json is not one of dea fit",
                    folder);
  }
  dea_section_begin(report, "fit", 0, "Fit to measurements");
  add_parameters(report, json_object_get(root, "parameters"));
  add_advice(&report->text, root);
  const dea_status status = add_figures(report, folder);
  add_correlations(report, root);
  add_facts(&report->text, root);
  dea_section_end(report);
  json_decref(root);
  return status;
}
