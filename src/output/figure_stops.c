#include "output/figure_stops.h"

#include <string.h>

/* Depths are few: insertion. */
static void sort(struct dea_stops *stops)
{
  for (size_t i = 0; i < stops->count; i++) {
    size_t k = i;
    double depth = stops->curve->points[stops->first[i]].tip_depth_m;
    for (; k > 0 && stops->curve->points[stops->first[stops->by_depth[k - 1]]].tip_depth_m > depth;
         k--) {
      stops->by_depth[k] = stops->by_depth[k - 1];
    }
    stops->by_depth[k] = i;
  }
}

void dea_stops_find(const struct dea_result *result, struct dea_stops *out)
{
  *out = (struct dea_stops){0};
  for (size_t i = 0; i < result->curve_count && out->curve == NULL; i++) {
    const struct dea_curve *curve = &result->curves[i];
    out->curve = strcmp(curve->kind, "force") == 0 && curve->count > 0 ? curve : NULL;
  }
  if (out->curve == NULL) {
    return;
  }
  const struct dea_load_point *p = out->curve->points;
  for (size_t i = 0; i < out->curve->count && out->count < DEA_DESIGN_STOPS_MAX; i++) {
    if (i == 0 || p[i].tip_depth_m != p[i - 1].tip_depth_m) { // held exactly while V rises
      out->first[out->count++] = i;
    }
    out->first[out->count] = i + 1;
  }
  sort(out);
}

struct dea_series dea_stops_style(size_t i)
{
  static const enum dea_colour order[] = {DEA_BLUE,   DEA_VERMILLION, DEA_GREEN,
                                          DEA_PURPLE, DEA_ORANGE,     DEA_BLACK};
  return (struct dea_series){
      .style = DEA_LINE_MARKED, .colour = order[i % 6], .marker = (int)(i % 6)};
}
