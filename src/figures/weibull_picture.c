#include "figures/weibull_picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct row {
  double value;
  bool survived;
};

static int by_value(const void *a, const void *b)
{
  const struct row *x = a, *y = b;
  return x->value < y->value ? -1 : x->value > y->value ? 1 : (int)x->survived - (int)y->survived;
}

static dea_status add_points(struct dea_context *ctx, const struct dea_weibull_picture *picture,
                             const struct row *rows, struct dea_panel *panel)
{
  const size_t n = picture->rows, broken = picture->fit->broken;
  struct dea_series *series, *kept;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, broken, DEA_MARKERS, DEA_BLACK, picture->points, &series));
  double left = 1;
  size_t at = 0;
  for (size_t i = 0; i < n; i++) {
    if (!rows[i].survived) {
      const double after = left * (1 - 1 / (double)(n - i));
      series->values[at] = picture->factor * rows[i].value;
      series->values[series->count + at++] = 100 * (1 - 0.5 * (left + after));
      left = after;
    }
  }
  if (broken == n) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_panel_add(ctx, panel, n - broken, DEA_MARKERS, DEA_GREEN, "survived until there",
                             &kept));
  at = 0;
  for (size_t i = 0; i < n; i++) {
    if (rows[i].survived) {
      kept->values[at] = picture->factor * rows[i].value;
      kept->values[kept->count + at++] = 0;
    }
  }
  kept->marker = 1;
  return DEA_OK;
}

static dea_status add_law(struct dea_context *ctx, const struct dea_weibull_picture *picture,
                          struct dea_panel *panel)
{
  enum { POINTS = 200 };
  struct dea_series *band, *law;
  double std;
  const double from = dea_weibull_quantile(picture->fit, 0.001, &std);
  const double to = dea_weibull_quantile(picture->fit, 0.999, &std);
  DEA_TRY(ctx, dea_panel_add(ctx, panel, POINTS, DEA_BAND, DEA_GREY, "\302\261 2 std of the law",
                             &band));
  DEA_TRY(ctx, dea_panel_add(ctx, panel, POINTS, DEA_LINE, DEA_BLUE, "Weibull's law", &law));
  band = &panel->series[panel->series_count - 2];
  for (size_t i = 0; i < POINTS; i++) {
    const double share = (double)i / (POINTS - 1);
    const double value =
        picture->logarithmic ? from * pow(to / from, share) : from + (to - from) * share;
    const double z = dea_weibull_z(picture->fit, value, &std);
    band->values[i] = law->values[i] = picture->factor * value;
    law->values[POINTS + i] = -100 * expm1(-exp(z));
    band->values[POINTS + i] = -100 * expm1(-exp(z - 2 * std));
    band->values[2 * POINTS + i] = -100 * expm1(-exp(z + 2 * std));
  }
  return DEA_OK;
}

static dea_status add_rows(struct dea_context *ctx, const struct dea_weibull_picture *picture,
                           struct dea_panel *panel)
{
  struct row *rows = dea_alloc(ctx, picture->rows, sizeof *rows);
  DEA_TRY_MEMORY(rows != NULL);
  for (size_t i = 0; i < picture->rows; i++) {
    rows[i] = (struct row){picture->values[i], picture->survived[i]};
  }
  qsort(rows, picture->rows, sizeof *rows, by_value);
  dea_status status = add_points(ctx, picture, rows, panel);
  dea_free(ctx, rows);
  return status;
}

/* From before the first value to the law's end: the law's own begin lies decades before. */
static void logarithmic_axis(const struct dea_weibull_picture *picture, struct dea_panel *panel)
{
  double std, low = dea_weibull_quantile(picture->fit, 0.02, &std);
  double high = dea_weibull_quantile(picture->fit, 0.999, &std);
  for (size_t i = 0; i < picture->rows; i++) {
    low = fmin(low, picture->values[i]);
    high = fmax(high, picture->values[i]);
  }
  panel->logarithmic_x = true;
  panel->x_min = 0.7 * picture->factor * low;
  panel->x_max = 1.1 * picture->factor * high;
}

dea_status dea_weibull_draw(struct dea_context *ctx, const struct dea_weibull_picture *picture,
                            const struct dea_plot_format *format, const char *directory)
{
  struct dea_plot_folder folder = {.ctx = ctx, .format = format, .path = directory};
  struct dea_plot *plot;
  DEA_TRY(ctx, dea_plot_create(ctx, "fit", picture->caption, &plot));
  struct dea_panel *panel = &plot->panels[0];
  dea_status status = add_law(ctx, picture, panel);
  status = status == DEA_OK ? add_rows(ctx, picture, panel) : status;
  snprintf(panel->x_label, sizeof panel->x_label, "%s", picture->x_label);
  snprintf(panel->y_label, sizeof panel->y_label, "%s", picture->y_label);
  if (picture->logarithmic) {
    logarithmic_axis(picture, panel);
  }
  dea_panel_even_tics(panel, 7);
  return dea_plot_folder_draw(&folder, dea_plot_folder_add(&folder, plot, status));
}
