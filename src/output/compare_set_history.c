/* Histories beside measured ones: figures (see compare_set.h). */
#include "output/compare_set_parts.h"
#include "output/figure.h"

#include <math.h>
#include <stdio.h>

enum { FEW = 20, DRAWN_MAX = 4000 }; // pulses of which lines are thick, points of a line

/* Adds values against time within [from, to]; of many the smallest and largest of each stretch, so
 * that no peak is lost and no file becomes large. */
static dea_status add_track(struct dea_context *ctx, struct dea_panel *panel, const double *time,
                            const double *values, size_t count, const double span[2],
                            const struct dea_series *look)
{
  struct dea_series *series;
  size_t first = 0, last = count;
  while (first < count && !(time[first] >= span[0])) {
    first++;
  }
  while (last > first && !(time[last - 1] <= span[1])) {
    last--;
  }
  size_t stretch = (last - first) / (DRAWN_MAX / 2) + 1;
  size_t room = stretch == 1 ? last - first : 2 * ((last - first) / stretch + 1), n = 0;
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, room, look, &series));
  for (size_t i = first; i < last; i += stretch) {
    size_t end = i + stretch < last ? i + stretch : last, low = i, high = i;
    for (size_t k = i; k < end; k++) {
      low = values[k] < values[low] || isnan(values[low]) ? k : low;
      high = values[k] > values[high] || isnan(values[high]) ? k : high;
    }
    size_t shown[2] = {low < high ? low : high, low < high ? high : low};
    for (size_t k = 0; k < (stretch == 1 ? 1U : 2U); k++) {
      series->values[n] = time[shown[k]];
      series->values[room + n++] = values[shown[k]];
    }
  }
  return DEA_OK;
}

/* A column of a history computed, on the measured clock. */
static dea_status add_computed(struct dea_set_figures *f, struct dea_panel *panel,
                               const struct dea_set_history *h, int column, const double span[2])
{
  struct dea_context *ctx = f->ctx;
  size_t n = h->transient->count;
  double *time = dea_alloc(ctx, n, sizeof *time), *values = dea_alloc(ctx, n, sizeof *values);
  struct dea_series look = dea_figure_style(f->set->curves[h->curve].name, h->curve);
  dea_status status = time != NULL && values != NULL ? DEA_OK : DEA_E_MEMORY;
  for (size_t i = 0; status == DEA_OK && i < n; i++) {
    time[i] = h->transient->points[i].time_s + h->clock.shift_s;
    values[i] = dea_point_columns[column].factor * dea_point_get(&h->transient->points[i], column);
  }
  look.style = h->curve % 2 > 0 ? DEA_DASHED : h->clock.edges > FEW ? DEA_THIN : DEA_LINE;
  if (status == DEA_OK) {
    status = add_track(ctx, panel, time, values, n, span, &look);
  }
  dea_free(ctx, time);
  dea_free(ctx, values);
  return status;
}

static dea_status add_recorded(struct dea_set_figures *f, struct dea_panel *panel,
                               enum dea_measured_column column, const double span[2])
{
  const struct dea_csv_columns *history = &f->set->measured->history;
  struct dea_series look = {.style = DEA_LINE, .colour = DEA_BLACK, .title = "measured"};
  for (size_t i = 0; i < f->set->history_count; i++) {
    look.style = f->set->histories[i].clock.edges > FEW ? DEA_THIN : look.style;
  }
  double *values = dea_alloc(f->ctx, history->rows, sizeof *values);
  if (values == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t i = 0; i < history->rows; i++) {
    values[i] =
        dea_point_columns[dea_measured_point_column(column)].factor * history->values[column][i];
  }
  dea_status status = add_track(f->ctx, panel, history->values[DEA_MEASURED_TIME], values,
                                history->rows, span, &look);
  dea_free(f->ctx, values);
  return status;
}

/* Times that both have, and a little more. */
static void find_span(const struct dea_compare_set *set, enum dea_measured_column column,
                      double span[2])
{
  span[0] = INFINITY;
  span[1] = -INFINITY;
  for (size_t i = 0; i < set->history_count; i++) {
    const struct dea_misfit *m = &set->histories[i].misfit;
    if (set->histories[i].column == column) {
      span[0] = fmin(span[0], m->at[0]);
      span[1] = fmax(span[1], m->at[m->count - 1]);
    }
  }
  double more = 0.02 * (span[1] - span[0]);
  span[0] -= more;
  span[1] += more;
}

static dea_status fill_history(struct dea_set_figures *f, enum dea_measured_column column,
                               const double span[2], struct dea_plot *plot)
{
  const struct dea_compare_set *set = f->set;
  bool has_voltage = set->measured->history.values[DEA_MEASURED_VOLTAGE] != NULL;
  plot->panel_count = has_voltage ? 2 : 1;
  plot->second_height = 1.0;
  for (size_t p = 0; p < plot->panel_count; p++) {
    struct dea_panel *panel = &plot->panels[p];
    enum dea_measured_column shown = p + 1 < plot->panel_count ? DEA_MEASURED_VOLTAGE : column;
    int of_point = dea_measured_point_column(shown);
    DEA_TRY(f->ctx, add_recorded(f, panel, shown, span));
    for (size_t i = 0; i < set->history_count; i++) {
      if (set->histories[i].column == column) {
        DEA_TRY(f->ctx, add_computed(f, panel, &set->histories[i], of_point, span));
      }
    }
    for (size_t s = 0; s < panel->series_count && p > 0; s++) {
      panel->series[s].title[0] = '\0'; // the key above holds for both
    }
    panel->x_min = span[0];
    panel->x_max = span[1];
    snprintf(panel->x_label, sizeof panel->x_label, "Time {/:Italic t} (s)");
    dea_figure_label(&dea_point_columns[of_point], panel->y_label, sizeof panel->y_label);
    dea_figure_even_tics(panel, 5);
    dea_set_range(panel);
    dea_set_key_above(f, panel);
  }
  return DEA_OK;
}

dea_status dea_set_draw_histories(struct dea_set_figures *f)
{
  for (int k = DEA_MEASURED_CENTRE; k < DEA_MEASURED_COLUMNS; k++) {
    double span[2];
    struct dea_plot *plot;
    char name[DEA_SET_FIGURE_SIZE];
    find_span(f->set, (enum dea_measured_column)k, span);
    if (span[1] > span[0]) {
      const struct dea_column *c =
          &dea_point_columns[dea_measured_point_column((enum dea_measured_column)k)];
      snprintf(name, sizeof name, "compare_history_%s", c->key);
      DEA_TRY(f->ctx, dea_set_figure_begin(f, name, "history", &plot));
      DEA_TRY(f->ctx, dea_set_figure_finish(
                          f, plot, fill_history(f, (enum dea_measured_column)k, span, plot)));
    }
  }
  return DEA_OK;
}
