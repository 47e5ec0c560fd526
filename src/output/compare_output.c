#include "output/compare_output.h"

#include "base/write_file.h"
#include "output/figure.h"
#include "output/gnuplot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

json_t *dea_misfit_json(const struct dea_misfit *m, const char *at_unit, double tolerance)
{
  const struct dea_column *column = &dea_point_columns[m->column];
  char at[32];
  json_t *object = json_object();
  snprintf(at, sizeof at, "largest_at_%s", at_unit);
  dea_json_put_text(object, "quantity", column->key);
  dea_json_put_text(object, "unit", column->si_unit);
  json_object_set_new(object, "points", json_integer((json_int_t)m->count));
  dea_json_put(object, "rms", m->rms);
  dea_json_put(object, "largest", m->largest);
  dea_json_put(object, at, m->largest_at);
  dea_json_put(object, "bias", m->bias);
  dea_json_put(object, "range", m->range);
  dea_json_put(object, "relative_rms", m->relative_rms);
  dea_json_put(object, "relative_largest", m->relative_largest);
  if (m->std_count > 0) {
    json_object_set_new(object, "std_points", json_integer((json_int_t)m->std_count));
    dea_json_put(object, "chi_square_per_point", m->chi_square);
    dea_json_put(object, "within_1_std", m->within_1_std);
    dea_json_put(object, "within_2_std", m->within_2_std);
  }
  if (!isnan(tolerance)) {
    json_object_set_new(object, "within", json_boolean(m->relative_largest <= tolerance));
  }
  return object;
}

json_t *dea_compared_json(const struct dea_compared *compared, double tolerance)
{
  json_t *object = json_object();
  dea_json_put_text(object, "a", compared->a);
  dea_json_put_text(object, "b", compared->b);
  json_t *quantities = json_array();
  for (size_t i = 0; i < compared->comparison->misfit_count; i++) {
    json_array_append_new(quantities,
                          dea_misfit_json(&compared->comparison->misfits[i], "V", tolerance));
  }
  json_object_set_new(object, "quantities", quantities);
  return object;
}

/* Adds values (minus less, if given) against the voltage in kV. */
static dea_status add(struct dea_context *ctx, struct dea_panel *panel, const struct dea_misfit *m,
                      const double *values, const double *less, const double *std,
                      struct dea_series **out)
{
  DEA_TRY(ctx, dea_panel_add(ctx, panel, m->count, out));
  double factor = dea_point_columns[m->column].factor;
  for (size_t i = 0; i < m->count; i++) {
    (*out)->values[i] = 1e-3 * m->at[i];
    (*out)->values[m->count + i] = factor * (values[i] - (less != NULL ? less[i] : 0.0));
    (*out)->values[2 * m->count + i] = std != NULL ? factor * std[i] : NAN;
  }
  return DEA_OK;
}

static bool has_std(const struct dea_misfit *m)
{
  for (size_t i = 0; i < m->count; i++) {
    if (!isnan(m->b_std[i])) {
      return true;
    }
  }
  return false;
}

static dea_status fill_plot(struct dea_context *ctx, const struct dea_compared *compared,
                            const struct dea_misfit *m, struct dea_plot *plot)
{
  struct dea_panel *top = &plot->panels[0], *low = &plot->panels[1];
  struct dea_series *series;
  bool bars = has_std(m);
  plot->panel_count = 2;
  plot->second_height = 0.45;
  DEA_TRY(ctx, add(ctx, top, m, m->a, NULL, NULL, &series));
  series->style = DEA_LINE;
  series->colour = DEA_BLUE;
  dea_label_escape(compared->a, series->title, sizeof series->title);
  DEA_TRY(ctx, add(ctx, top, m, m->b, NULL, m->b_std, &series));
  series->style = bars ? DEA_ERROR_BARS : m->count > 25 ? DEA_LINE_MARKED : DEA_MARKERS;
  series->colour = DEA_VERMILLION;
  dea_label_escape(compared->b, series->title, sizeof series->title);
  DEA_TRY(ctx, add(ctx, low, m, m->a, m->b, m->b_std, &series));
  series->style = bars ? DEA_ERROR_BARS : DEA_LINE_MARKED;
  series->colour = DEA_BLACK;
  dea_panel_mark(low, false, 0.0, "");
  dea_figure_label(&dea_point_columns[m->column], top->y_label, sizeof top->y_label);
  snprintf(low->y_label, sizeof low->y_label, "Difference");
  dea_figure_voltage_axis(top);
  dea_figure_voltage_axis(low);
  dea_figure_even_tics(top, 7);
  dea_figure_even_tics(low, 3);
  return DEA_OK;
}

/* Writes script and data of one quantity as `name`. */
static dea_status write_one(struct dea_context *ctx, const struct dea_compared *compared,
                            const struct dea_misfit *m, const char *name,
                            const struct dea_plot_format *format, const char *directory)
{
  char caption[2 * DEA_LABEL_SIZE + 64];
  struct dea_plot *plot;
  snprintf(caption, sizeof caption, "%s of %s and %s, and the first minus the second",
           dea_point_columns[m->column].header, compared->a, compared->b);
  DEA_TRY(ctx, dea_plot_create(ctx, name, caption, &plot));
  dea_status status = fill_plot(ctx, compared, m, plot);
  if (status == DEA_OK) {
    status = dea_plot_write(ctx, plot, format, directory);
  }
  dea_plot_destroy(ctx, plot);
  return status;
}

dea_status dea_compared_draw(struct dea_context *ctx, const struct dea_compared *compared,
                             const char *suffix, const struct dea_plot_format *format,
                             const char *directory)
{
  enum { SIZE = 64 };
  char names[DEA_LOAD_POINT_COLUMNS][SIZE];
  const char *list[DEA_LOAD_POINT_COLUMNS];
  size_t count = compared->comparison->misfit_count;
  DEA_TRY(ctx, dea_folder_make(ctx, directory));
  for (size_t i = 0; i < count; i++) {
    const struct dea_misfit *m = &compared->comparison->misfits[i];
    snprintf(names[i], SIZE, "compare_%s%s%.30s", dea_point_columns[m->column].key,
             suffix[0] != '\0' ? "_" : "", suffix);
    list[i] = names[i];
    DEA_TRY(ctx, write_one(ctx, compared, m, names[i], format, directory));
  }
  if (format->svg || format->pdf || format->png) {
    DEA_TRY(ctx, dea_gnuplot_draw(ctx, directory, list, count));
  }
  return DEA_OK;
}
