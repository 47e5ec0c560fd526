/* Several designs at the last voltage of each: displacement out of the plane above, radial
 * displacement below, along the radius. */
#include "output/figure_variants.h"

#include <math.h>
#include <stdio.h>

enum { SHOWN_MAX = 16 };

static dea_status add(struct dea_context *ctx, struct dea_panel *panel,
                      const struct dea_figure_variant *one, const double *values)
{
  const struct dea_profile_record *record = &one->variant->profile;
  struct dea_series *series;
  size_t n = record->count;
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, n, &one->look, &series));
  for (size_t i = 0; i < n; i++) {
    series->values[i] = 1e3 * record->columns[i];
    series->values[n + i] = 1e6 * values[i];
  }
  return DEA_OK;
}

/* True where some profile leaves the plane beyond noise. */
static bool leaves_plane(const struct dea_figure_variant list[], size_t count)
{
  for (size_t i = 0; i < count; i++) {
    const struct dea_profile profile = dea_profile_of_record(&list[i].variant->profile);
    for (size_t k = 0; k < profile.count; k++) {
      if (fabs(profile.z_m[k]) > 1e-9) {
        return true;
      }
    }
  }
  return false;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_figure_variant list[SHOWN_MAX];
  size_t count = dea_figure_variants(result, "compare-design", true, list, SHOWN_MAX);
  bool z = leaves_plane(list, count);
  plot->panel_count = z ? 2 : 1;
  struct dea_panel *last = &plot->panels[plot->panel_count - 1];
  for (size_t i = 0; i < count; i++) {
    const struct dea_profile profile = dea_profile_of_record(&list[i].variant->profile);
    if (z) {
      DEA_TRY(ctx, add(ctx, &plot->panels[0], &list[i], profile.z_m));
    }
    DEA_TRY(ctx, add(ctx, last, &list[i], profile.displacement_m));
  }
  snprintf(plot->panels[0].y_label, DEA_LABEL_SIZE, "Displacement {/:Italic z} (\302\265m)");
  snprintf(last->y_label, DEA_LABEL_SIZE, "Radial displacement {/:Italic u} (\302\265m)");
  for (size_t p = 0; p < plot->panel_count; p++) {
    snprintf(plot->panels[p].x_label, DEA_LABEL_SIZE,
             "Radius in the stretched flat film {/:Italic R} (mm)");
    dea_figure_even_tics(&plot->panels[p], 7);
  }
  if (count > 0) {
    DEA_TRY(ctx, dea_figure_add_variant_key(ctx, &plot->panels[0], list, count, true));
  }
  return DEA_OK;
}

const struct dea_figure dea_figure_design_profiles = {
    .name = "design_profiles",
    .caption =
        "displacements of several designs along the radius (of model 3d: to the right along a "
        "fibre, to the left between fibres)",
    .build = build,
};
