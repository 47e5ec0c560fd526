/* Curves: the figures of a run, and those of several runs beside each other. */
#include "figures/run_figures.h"
#include "report/section.h"
#include "result/observation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

dea_status dea_section_curves(struct dea_report *report, const struct dea_report_run *run)
{
  if (run->run->result->curve_count == 0) {
    return DEA_OK;
  }
  dea_section_begin(report, "curves", run->number, "Curves");
  DEA_TRY(report->ctx, dea_section_figures(report, run, NULL));
  dea_section_end(report);
  return DEA_OK;
}

// Several runs ------------------------------------------------------------------------------------

/* What is set beside each other, each in a figure of its own: factor * (member + shift). */
static const struct compared {
  const char *key, *label, *caption;
  double factor, shift;
} compared[] = {
    {"electrode_stretch", "Radial strain of the electrode (%)", "radial strain of the electrode",
     100, -1},
    {"centre_z_m", "{/:Italic z} of the centre (\302\265m)", "displacement of the centre", 1e6, 0},
    {"fibre_tip_z_m", "{/:Italic z} of the fibre tip (\302\265m)", "displacement of the fibre tip",
     1e6, 0},
    {"force_N", "Force (mN)", "out-of-plane force", 1e3, 0},
    {"true_field_V_per_m", "True field {/:Italic E} (V/\302\265m)", "largest true field", 1e-6, 0},
};
enum { COMPARED = sizeof compared / sizeof compared[0], HEADLINES_MAX = 8 };

/* Measured points with their standard uncertainty. */
static dea_status add_measured(struct dea_report *report, const struct compared *what,
                               struct dea_panel *panel)
{
  const struct dea_measurement *m = report->measurement;
  int column = dea_column_find(report->ctx, what->key);
  if (m == NULL || !dea_points_have(m->curve.points, m->curve.count, column)) {
    return DEA_OK;
  }
  struct dea_series *series;
  size_t n = m->curve.count;
  DEA_TRY(report->ctx,
          dea_panel_add(report->ctx, panel, n, DEA_ERROR_BARS, DEA_BLACK, "measured", &series));
  series->marker = 5;
  for (size_t i = 0; i < n; i++) {
    series->values[i] = 1e-3 * m->curve.points[i].voltage_V;
    series->values[n + i] =
        what->factor * (dea_point_get(&m->curve.points[i], column) + what->shift);
    series->values[2 * n + i] = what->factor * dea_point_get(&m->std[i], column);
  }
  return DEA_OK;
}

/* Whether a bound is to be left out beside what any run predicts. */
static bool leaves_out(const struct dea_report *report, const struct dea_curve *curve, int column)
{
  bool out = false;
  for (size_t r = 0; r < report->count; r++) {
    out = out || dea_figure_leaves_out(report->runs[r].run->result, curve, column);
  }
  return out;
}

static dea_status fill(struct dea_report *report, const struct compared *what,
                       struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  size_t looks = 0;
  for (size_t r = 0; r < report->count; r++) {
    const struct dea_result *result = report->runs[r].run->result;
    const char *models[DEA_DESIGN_MODELS_MAX];
    size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
    for (size_t m = 0; m < count && looks < DEA_PANEL_SERIES_MAX / 2; m++) {
      char title[DEA_NAME_SIZE + 16];
      snprintf(title, sizeof title, "%d %s", report->runs[r].number, models[m]);
      struct dea_series look = dea_figure_style(title, looks);
      look.colour = (enum dea_colour)(looks % 7);
      size_t before = panel->series_count;
      const struct dea_curve *curve = dea_figure_curve(result, models[m], false);
      const int column = dea_column_find(report->ctx, what->key);
      if (!leaves_out(report, curve, column)) {
        DEA_TRY(report->ctx, dea_figure_add(report->ctx, panel, curve, column, what->factor,
                                            what->shift, &look));
      }
      looks += panel->series_count > before;
    }
  }
  snprintf(panel->y_label, sizeof panel->y_label, "%s", what->label);
  DEA_TRY(report->ctx, add_measured(report, what, panel));
  dea_panel_voltage_axis(panel);
  return DEA_OK;
}

static void add_last_points(struct dea_report *report)
{
  struct dea_text *out = &report->text;
  dea_table_begin(report, "Last point of every sweep");
  dea_table_head(report, "Run|Model|#V (kV)|#strain (%)|#z centre (\302\265m)|#z fibre tip "
                         "(\302\265m)|#breakdown margin (%)|flags");
  for (size_t r = 0; r < report->count; r++) {
    const struct dea_result *result = report->runs[r].run->result;
    for (size_t c = 0; c < result->curve_count; c++) {
      const struct dea_curve *curve = &result->curves[c];
      if (strcmp(curve->kind, "sweep") != 0 || curve->count == 0) {
        continue;
      }
      const struct dea_load_point *p = &curve->points[curve->count - 1];
      const bool z = !leaves_out(report, curve, dea_point_column_find("fibre_tip_z_m"));
      char words[DEA_FLAGS_SIZE];
      dea_html_add(out,
                   "<tr><th scope=\"row\">%d %s</th><td>%s</td><td class=\"n\">%.4G</td>"
                   "<td class=\"n\">%.4G</td><td class=\"n\">%.5G</td><td class=\"n\">%.5G</td>"
                   "<td class=\"n\">%.3G</td><td>%s</td></tr>",
                   report->runs[r].number, report->runs[r].title, curve->model, 1e-3 * p->voltage_V,
                   100 * (p->electrode_stretch - 1), z ? 1e6 * p->centre_z_m : NAN,
                   z ? 1e6 * p->fibre_tip_z_m : NAN, 100 * p->breakdown_margin,
                   dea_flags_text(dea_load_point_flags(p), words));
    }
  }
  dea_table_end(report);
}

static dea_status add_compared(struct dea_report *report, const struct compared *what)
{
  struct dea_plot *plot;
  DEA_TRY(report->ctx, dea_plot_create(report->ctx, what->key, what->caption, &plot));
  return dea_section_plot(report, plot, fill(report, what, plot));
}

/* What the monitors of the first sweep that has some show. */
static dea_status add_monitors(struct dea_report *report)
{
  int columns[HEADLINES_MAX];
  size_t count = 0;
  for (size_t r = 0; r < report->count && count == 0; r++) {
    const struct dea_result *result = report->runs[r].run->result;
    for (size_t c = 0; c < result->curve_count && count == 0; c++) {
      if (strcmp(result->curves[c].kind, "sweep") == 0) {
        count = dea_curve_headlines(report->ctx, &result->curves[c], columns, HEADLINES_MAX);
      }
    }
  }
  for (size_t i = 0; i < count; i++) {
    const struct dea_column *column = dea_column_at(report->ctx, columns[i]);
    char label[DEA_LABEL_SIZE];
    dea_figure_label(column, label, sizeof label);
    const struct compared what = {column->key, label, column->header, column->factor, 0};
    DEA_TRY(report->ctx, add_compared(report, &what));
  }
  return DEA_OK;
}

dea_status dea_section_compare(struct dea_report *report)
{
  if (report->count < 2 && report->measurement == NULL) {
    return DEA_OK;
  }
  dea_section_begin(report, "compare", 0,
                    report->measurement == NULL ? "The runs beside each other"
                    : report->count < 2         ? "Computed and measured"
                                                : "The runs and a measurement beside each other");
  dea_text_add(&report->text, "<div class=\"plots\">");
  for (size_t i = 0; i < COMPARED; i++) {
    DEA_TRY(report->ctx, add_compared(report, &compared[i]));
  }
  DEA_TRY(report->ctx, add_monitors(report));
  dea_text_add(&report->text, "</div>");
  add_last_points(report);
  dea_section_end(report);
  return DEA_OK;
}
