/* The explorer's numbers (web/explorer.js): of designs between those of a sparse grid, of model
 * reduced, and between the points of the run's sweeps. */
#include "io/sparse_grid.h"
#include "report/section.h"
#include "result/figure.h"
#include "result/observation.h"

#include <stdlib.h>
#include <string.h>

enum { POINTS_MAX = 65, QUANTITIES_MAX = 12, HEADLINES_MAX = 4 };

// A sweep of the run ------------------------------------------------------------------------------

/* Columns of a curve that are shown, and their number. */
static size_t find_columns(struct dea_report *report, const struct dea_result *result,
                           const struct dea_curve *sweep, int columns[QUANTITIES_MAX])
{
  static const char *const keys[] = {
      "centre_z_m",       "fibre_tip_z_m", "electrode_edge_u_m",  "true_field_V_per_m",
      "breakdown_margin", "force_N",       "min_tension_N_per_m", "capacitance_F"};
  size_t count = dea_curve_headlines(report->ctx, sweep, columns, HEADLINES_MAX);
  for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
    const int column = dea_point_column_find(keys[i]);
    if (!dea_figure_leaves_out(result, sweep, column) &&
        dea_points_have(sweep->points, sweep->count, column)) {
      columns[count++] = column;
    }
  }
  return count;
}

/* Stable points of rising voltage, of many every few. */
static size_t find_points(const struct dea_curve *sweep, const struct dea_load_point **out)
{
  const size_t stride = 1 + (sweep->count - 1) / POINTS_MAX;
  size_t count = 0;
  for (size_t i = 0; i < sweep->count; i += stride) {
    const struct dea_load_point *p = &sweep->points[i];
    if (p->stable && (count == 0 || p->voltage_V > out[count - 1]->voltage_V)) {
      out[count++] = p;
    }
  }
  return count;
}

static dea_status add_sweep(struct dea_report *report, const struct dea_result *result,
                            const struct dea_curve *sweep, json_t *sources)
{
  const struct dea_load_point *points[POINTS_MAX];
  const struct dea_column *quantities[QUANTITIES_MAX];
  double voltages_V[POINTS_MAX], values[POINTS_MAX * QUANTITIES_MAX];
  unsigned flags[POINTS_MAX];
  int columns[QUANTITIES_MAX];
  struct dea_emulator e = {.model = sweep->model,
                           .case_count = 1,
                           .voltage_count = find_points(sweep, points),
                           .quantity_count = find_columns(report, result, sweep, columns),
                           .level = 1,
                           .voltages_V = voltages_V,
                           .quantities = quantities,
                           .values = values,
                           .flags = flags};
  if (e.voltage_count < 3 || e.quantity_count == 0) {
    return DEA_OK;
  }
  for (size_t q = 0; q < e.quantity_count; q++) {
    quantities[q] = dea_column_at(report->ctx, columns[q]);
  }
  for (size_t k = 0; k < e.voltage_count; k++) {
    voltages_V[k] = points[k]->voltage_V;
    flags[k] = dea_load_point_flags(points[k]);
    for (size_t q = 0; q < e.quantity_count; q++) {
      values[k * e.quantity_count + q] = dea_point_get(points[k], columns[q]);
    }
  }
  DEA_TRY(report->ctx, dea_emulator_build(report->ctx, &e));
  json_array_append_new(sources, dea_emulator_json(&e));
  dea_emulator_free(report->ctx, &e);
  return DEA_OK;
}

// The section -------------------------------------------------------------------------------------

static dea_status find_sources(struct dea_report *report, const struct dea_report_run *run,
                               json_t *sources)
{
  const struct dea_result *result = run->run->result;
  if (run->emulator != NULL) {
    json_array_append_new(sources, json_loads(run->emulator, 0, NULL));
  }
  if (run->reduced != NULL) {
    json_array_append_new(sources, json_loads(run->reduced, 0, NULL));
  }
  for (size_t i = result->curve_count; i-- > 0;) { // 3d is the last that is computed
    if (strcmp(result->curves[i].kind, "sweep") == 0 && result->curves[i].count > 0) {
      DEA_TRY(report->ctx, add_sweep(report, result, &result->curves[i], sources));
    }
  }
  return DEA_OK;
}

/* JSON within a script element. */
static void add_json(struct dea_text *out, const json_t *json)
{
  char *text = json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(17));
  out->failed = out->failed || text == NULL;
  for (const char *at = text; at != NULL && *at != '\0';) {
    const size_t length = strcspn(at, "<");
    dea_text_add(out, "%.*s%s", (int)length, at, at[length] != '\0' ? "\\u003c" : "");
    at += length + (at[length] != '\0');
  }
  free(text);
}

dea_status dea_section_explorer(struct dea_report *report, const struct dea_report_run *run)
{
  struct dea_text *out = &report->text;
  json_t *sources = json_array(), *source;
  dea_status status = find_sources(report, run, sources);
  const struct dea_design *design = run->design;
  size_t i;
  json_array_foreach(sources, i, source)
  {
    dea_json_add(source, "finger_N_per_m", report->options->finger_N_per_m);
    dea_json_add(source, "voltage_V", design != NULL ? dea_design_highest_V(design) : 0);
  }
  if (status == DEA_OK && json_array_size(sources) > 0) {
    dea_section_begin(report, "explorer", run->number, "Explorer");
    if (run->emulator == NULL) {
      dea_text_add(out, "<p>Sliders for numbers of the design come from <span class=\"code\">dea "
                        "sweep</span> with <span class=\"code\">plan: sparse-grid</span>: <span "
                        "class=\"code\">dea report RUN --explorer FOLDER</span>.</p>");
    }
    dea_text_add(out, "<p class=\"still\">With scripts, numbers between those that were computed "
                      "are shown here.</p><div class=\"explorer interactive\" hidden></div>"
                      "<script type=\"application/json\" class=\"sources\">");
    add_json(out, sources);
    dea_text_add(out, "</script>");
    dea_section_end(report);
  }
  json_decref(sources);
  return status;
}
