/* Study of convergence: estimated error of the displacements against the unknowns. Above, those at
 * the highest voltage where each has an order; below, the largest of them at each voltage. */
#include "output/figure.h"

#include "result/convergence.h"

#include <math.h>
#include <stdio.h>

enum { COLOURS = 5 };
static const enum dea_colour colours[COLOURS] = {DEA_VERMILLION, DEA_BLUE, DEA_GREEN, DEA_PURPLE,
                                                 DEA_ORANGE};

/* Adds errors of the meshes [%] against unknowns in thousands. An error of 0 has no place on the
 * axis. */
static dea_status add_errors(struct dea_context *ctx, struct dea_panel *panel,
                             const struct dea_convergence *c, const double *errors,
                             const char *title)
{
  struct dea_series *series;
  size_t n = c->mesh_count;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, n, &series));
  series->style = DEA_LINE_MARKED;
  series->colour = colours[(panel->series_count - 1) % COLOURS];
  series->marker = (int)panel->series_count - 1;
  snprintf(series->title, sizeof series->title, "%s", title);
  for (size_t m = 0; m < n; m++) {
    series->values[m] = 1e-3 * (double)c->meshes[m]->size.unknowns;
    series->values[n + m] = errors[m] > 0 ? 100 * errors[m] : NAN;
  }
  return DEA_OK;
}

static bool is_probe_at(const struct dea_convergence *c, size_t i, double voltage_V)
{
  return c->rows[i].voltage_V == voltage_V && dea_convergence_is_probe(&c->rows[i]);
}

/* Voltage of the upper panel: the last at which every displacement has an order, else the last. */
static double choose_voltage(const struct dea_convergence *c)
{
  double chosen = NAN, last = NAN;
  for (size_t i = 0; i < c->row_count; i++) {
    double voltage_V = c->rows[i].voltage_V;
    bool good = true, any = false;
    for (size_t k = 0; k < c->row_count; k++) {
      if (is_probe_at(c, k, voltage_V)) {
        any = true;
        good = good && c->rows[k].kind == DEA_ORDER_OBSERVED;
      }
    }
    chosen = good && any ? voltage_V : chosen;
    last = any ? voltage_V : last;
  }
  return isnan(chosen) ? last : chosen;
}

static dea_status fill_upper(struct dea_context *ctx, const struct dea_convergence *c,
                             struct dea_panel *panel)
{
  double voltage_V = choose_voltage(c);
  for (size_t i = 0; i < c->row_count; i++) {
    const struct dea_convergence_row *row = &c->rows[i];
    if (is_probe_at(c, i, voltage_V)) {
      char title[DEA_LABEL_SIZE];
      const char *header = dea_point_columns[row->column].header;
      if (row->kind == DEA_ORDER_OBSERVED) {
        snprintf(title, sizeof title, "%s, order %.1f", header, row->order);
      } else {
        snprintf(title, sizeof title, "%s, no order", header);
      }
      DEA_TRY(ctx, add_errors(ctx, panel, c, row->errors, title));
    }
  }
  snprintf(panel->y_label, sizeof panel->y_label, "Error at %.4g kV (%%)", 1e-3 * voltage_V);
  return DEA_OK;
}

/* A line a voltage: the largest error of a displacement. */
static dea_status fill_lower(struct dea_context *ctx, const struct dea_convergence *c,
                             struct dea_panel *panel)
{
  double last = NAN;
  for (size_t i = 0; i < c->row_count; i++) {
    double voltage_V = c->rows[i].voltage_V, worst[DEA_CONVERGENCE_MESHES_MAX] = {0};
    if (voltage_V == last || !dea_convergence_is_probe(&c->rows[i])) {
      continue;
    }
    for (size_t k = i; k < c->row_count; k++) {
      for (size_t m = 0; m < c->mesh_count && is_probe_at(c, k, voltage_V); m++) {
        worst[m] = fmax(worst[m], c->rows[k].errors[m]);
      }
    }
    char title[DEA_LABEL_SIZE];
    snprintf(title, sizeof title, "%.4g kV", 1e-3 * voltage_V);
    DEA_TRY(ctx, add_errors(ctx, panel, c, worst, title));
    last = voltage_V;
  }
  snprintf(panel->y_label, sizeof panel->y_label, "Largest error (%%)");
  return DEA_OK;
}

/* Limits around the points, the tolerance among them, with room for the key above. */
static void set_limits(struct dea_panel *panel, double tolerance_percent)
{
  double x[2] = {INFINITY, 0}, y[2] = {tolerance_percent, tolerance_percent};
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    for (size_t i = 0; i < series->count; i++) {
      x[0] = fmin(x[0], series->values[i]);
      x[1] = fmax(x[1], series->values[i]);
      y[0] = fmin(y[0], series->values[series->count + i]); // NAN counts as nothing
      y[1] = fmax(y[1], series->values[series->count + i]);
    }
  }
  double key = 1 + 0.14 * (double)panel->series_count; // of the range without it
  panel->x_min = x[0] / 1.3;
  panel->x_max = x[1] * 1.3;
  panel->y_min = y[0] / 1.4;
  panel->y_max = panel->y_min * pow(1.4 * y[1] / panel->y_min, key);
}

static dea_status fill_plot(struct dea_context *ctx, const struct dea_convergence *c,
                            struct dea_plot *plot)
{
  plot->panel_count = 2;
  DEA_TRY(ctx, fill_upper(ctx, c, &plot->panels[0]));
  DEA_TRY(ctx, fill_lower(ctx, c, &plot->panels[1]));
  for (int p = 0; p < 2; p++) {
    struct dea_panel *panel = &plot->panels[p];
    char text[32];
    snprintf(text, sizeof text, "%.3g %%", 100 * c->tolerance);
    dea_panel_mark(panel, false, 100 * c->tolerance, text);
    snprintf(panel->x_label, sizeof panel->x_label, "Unknowns (thousands)");
    panel->logarithmic = true;
    set_limits(panel, 100 * c->tolerance);
    panel->key = "top right";
  }
  return DEA_OK;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    struct dea_convergence *convergence;
    DEA_TRY(ctx, dea_convergence_create(ctx, result, models[m], &convergence));
    if (convergence != NULL) { // one model has a mesh at present
      dea_status status = fill_plot(ctx, convergence, plot);
      dea_convergence_destroy(ctx, convergence);
      return status;
    }
  }
  return DEA_OK;
}

const struct dea_figure dea_figure_convergence = {
    .name = "convergence",
    .caption = "estimated error of displacements on ever finer meshes",
    .build = build,
};
