/* Displacement out of the plane along two diameters: along the first fibre, and between it and the
 * next. */
#include "figures/surface_lattice.h"
#include "result/figure.h"
#include "result/trust.h"

#include <math.h>
#include <stdio.h>

enum { SHOWN_MAX = 3, PIECES = 80000 };
static const double rounding_um = 1e-6; // a film that stays flat is drawn so

static dea_status add_diameter(struct dea_context *ctx, struct dea_panel *panel,
                               const struct dea_surface_lattice *drawing, double angle,
                               const struct dea_series *look)
{
  double *found;
  size_t count;
  struct dea_series *series;
  DEA_TRY(ctx, dea_surface_lattice_section(ctx, drawing, angle, &found, &count));
  dea_status status =
      dea_panel_add(ctx, panel, count, look->style, look->colour, look->title, &series);
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    series->values[i] = 1e3 * found[i];
    panel->x_max = fmax(panel->x_max, fabs(series->values[i]));
    double z_um = 1e6 * found[count + i];
    series->values[count + i] = fabs(z_um) > rounding_um ? z_um : 0;
  }
  dea_free(ctx, found);
  DEA_TRY(ctx, status);
  series->secondary = look->secondary;
  return DEA_OK;
}

static dea_status add_record(struct dea_context *ctx, struct dea_panel *panel,
                             const struct dea_result *result,
                             const struct dea_surface_record *record, size_t shown,
                             bool all_doubtful)
{
  static const enum dea_colour order[SHOWN_MAX] = {DEA_SKY, DEA_VERMILLION, DEA_BLACK};
  struct dea_series look = {.style = DEA_LINE, .colour = order[shown]};
  struct dea_surface_lattice drawing;
  char words[DEA_FLAGS_SIZE];
  unsigned doubts = dea_result_doubts(result, record->model, record->voltage_V);
  look.colour = doubts != 0 && !all_doubtful ? DEA_GREY : look.colour;
  look.secondary = doubts != 0;
  snprintf(look.title, sizeof look.title, "%.4g kV%s%s", 1e-3 * record->voltage_V,
           doubts != 0 ? ": " : "", dea_flags_text(doubts, words));
  const double angle = record->mesh->fibres > 0 ? record->mesh->symmetry_angle : 0;
  dea_status status = dea_surface_lattice_create(ctx, record->mesh, PIECES, &drawing);
  status = status == DEA_OK ? add_diameter(ctx, panel, &drawing, angle, &look) : status;
  if (status == DEA_OK && record->mesh->fibres > 0) {
    look.style = DEA_DASHED;
    look.title[0] = '\0';
    status = add_diameter(ctx, panel, &drawing, angle + DEA_PI / record->mesh->fibres, &look);
  }
  panel->x_min = -panel->x_max;
  dea_surface_lattice_free(ctx, &drawing);
  return status;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  const struct dea_surface_record *records[SHOWN_MAX + 1];
  size_t count = dea_surface_spread(result, SHOWN_MAX + 1, records);
  size_t first =
      count > SHOWN_MAX ? 1 : 0; // at the first voltage, mostly 0, there is nothing to see
  size_t doubtful = 0;
  for (size_t i = first; i < count; i++) {
    doubtful += dea_result_doubts(result, records[i]->model, records[i]->voltage_V) != 0;
  }
  bool all_doubtful = doubtful == count - first; // then grey would tell them apart from nothing
  bool some_grey = doubtful > 0 && !all_doubtful;
  for (size_t i = first; i < count; i++) {
    DEA_TRY(ctx, add_record(ctx, panel, result, records[i], SHOWN_MAX - count + i, all_doubtful));
  }
  if (count == 0) {
    return DEA_OK;
  }
  if (records[0]->mesh->fibres > 0) {
    size_t entries = panel->series_count;
    DEA_TRY(ctx, dea_figure_add_entry(ctx, panel, DEA_LINE, "along fibres", panel->x_min, 0));
    DEA_TRY(ctx, dea_figure_add_entry(ctx, panel, DEA_DASHED, "between", panel->x_min, 0));
    for (size_t i = entries; i < panel->series_count && some_grey; i++) {
      panel->series[i].colour = DEA_BLACK; // grey is a curve's
    }
  }
  snprintf(panel->x_label, sizeof panel->x_label, "Place across the film (mm)");
  snprintf(panel->y_label, sizeof panel->y_label, "Displacement {/:Italic z} (\302\265m)");
  dea_panel_limit(panel); // a slack shape of 200 um would hide a taut one of 10
  dea_panel_even_tics(panel, 7);
  panel->key = "above horizontal maxrows 3 samplen 1.5 width key_width";
  return DEA_OK;
}

const struct dea_figure dea_figure_section = {
    .name = "section",
    .caption =
        "displacement out of the plane along diameters (full: along fibres, dashed: between; "
        "grey, or with words: not to be trusted)",
    .build = build,
};
