/* Electrode stretch against the voltage along the whole equilibrium path, with its events. */
#include "output/figure.h"

#include <math.h>
#include <stdio.h>

/* Adds the events of one kind as markers. */
static dea_status add_events(struct dea_context *ctx, struct dea_panel *panel,
                             const struct dea_result *result, enum dea_event_kind kind,
                             const char *title, int marker)
{
  size_t count = 0;
  for (size_t i = 0; i < result->curve_count; i++) {
    count += result->curves[i].event_count;
  }
  struct dea_series *series;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, count, &series));
  series->style = DEA_MARKERS;
  series->colour = DEA_BLACK;
  series->marker = marker;
  snprintf(series->title, sizeof series->title, "%s", title);
  size_t n = 0;
  for (size_t i = 0; i < result->curve_count; i++) {
    for (size_t e = 0; e < result->curves[i].event_count; e++, n++) {
      const struct dea_event *event = &result->curves[i].events[e];
      series->values[n] = 1e-3 * event->point.voltage_V;
      series->values[count + n] = event->kind == kind ? event->point.electrode_stretch : NAN;
    }
  }
  return DEA_OK;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_figure_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    struct dea_series look = dea_figure_look(models[m], m);
    DEA_TRY(ctx, dea_figure_add(ctx, panel, dea_figure_curve(result, models[m], true),
                                dea_point_column_find("electrode_stretch"), 1.0, 0.0, &look));
  }
  if (panel->series_count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, add_events(ctx, panel, result, DEA_EVENT_PULL_IN, "pull-in", 5));
  DEA_TRY(ctx, add_events(ctx, panel, result, DEA_EVENT_SNAP_BACK, "snap-back", 6));
  DEA_TRY(ctx, add_events(ctx, panel, result, DEA_EVENT_SLACK, "loss of tension", 7));
  DEA_TRY(ctx, add_events(ctx, panel, result, DEA_EVENT_BREAKDOWN, "breakdown", 9));
  snprintf(panel->y_label, sizeof panel->y_label, "Electrode stretch {/:Italic \316\273}_a");
  dea_figure_voltage_axis(panel);
  return DEA_OK;
}

const struct dea_figure dea_figure_stretch = {
    .name = "stretch",
    .caption = "electrode stretch (relative to the pre-stretched state) along the equilibrium path",
    .build = build,
};
