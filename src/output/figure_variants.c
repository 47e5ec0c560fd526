#include "output/figure_variants.h"

#include <stdio.h>
#include <string.h>

enum { TITLE_SHORT = 24 }; // signs, of which two fit side by side

size_t dea_figure_variants(const struct dea_result *result, const char *study, bool profiles,
                           struct dea_figure_variant out[], size_t max)
{
  static const enum dea_colour order[] = {DEA_BLUE,   DEA_VERMILLION, DEA_GREEN, DEA_PURPLE,
                                          DEA_ORANGE, DEA_SKY,        DEA_BLACK, DEA_GREY};
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t model_count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX), count = 0;
  for (size_t m = 0, shown = 0; m < model_count; m++) {
    size_t number = 0, before = count;
    for (size_t i = 0; i < result->variant_count; i++) {
      const struct dea_variant *variant = &result->variants[i];
      if (!dea_variant_is(variant, models[m], study)) {
        continue;
      }
      if (count < max && (!profiles || variant->profile.count > 0)) {
        out[count].variant = variant;
        out[count].look = dea_figure_style("", shown);
        out[count++].look.colour = order[number % (sizeof order / sizeof order[0])];
      }
      number++;
    }
    shown += count > before;
  }
  return count;
}

/* An entry of the key; of its series only a point shows, on a curve that is there. */
static dea_status add_entry(struct dea_context *ctx, struct dea_panel *panel,
                            const struct dea_series *look, const char *title)
{
  struct dea_series *entry;
  const struct dea_series *first = &panel->series[0];
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, 1, look, &entry));
  snprintf(entry->title, sizeof entry->title, "%s", title);
  entry->values[0] = first->values[0];
  entry->values[1] = first->values[first->count];
  return DEA_OK;
}

static bool is_first(const struct dea_figure_variant list[], size_t i, bool by_name)
{
  for (size_t k = 0; k < i; k++) {
    const struct dea_variant *a = list[k].variant, *b = list[i].variant;
    if (by_name ? strcmp(a->name, b->name) == 0 : strcmp(a->curve.model, b->curve.model) == 0) {
      return false;
    }
  }
  return true;
}

dea_status dea_figure_add_variants(struct dea_context *ctx, struct dea_panel *panel,
                                   const struct dea_figure_variant list[], size_t count, int column,
                                   double factor, double shift)
{
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(ctx, dea_figure_add(ctx, panel, &list[i].variant->curve, column, factor, shift,
                                &list[i].look));
  }
  return DEA_OK;
}

/* Keys of so many entries, in two columns from the fourth on where their titles are short. */
static const char *key_of(size_t entries, size_t longest)
{
  static const char *const keys[] = {
      "above horizontal maxrows 1 samplen 1.5", "above vertical maxrows 2 samplen 1.5",
      "above vertical maxrows 3 samplen 1.5",   "above vertical maxrows 4 samplen 1.5",
      "above vertical maxrows 5 samplen 1.5",   "above vertical maxrows 6 samplen 1.5",
  };
  size_t rows = entries > 3 && longest <= TITLE_SHORT ? (entries + 1) / 2 : entries;
  return keys[rows > 6 ? 5 : rows > 0 ? rows - 1 : 0];
}

dea_status dea_figure_add_variant_key(struct dea_context *ctx, struct dea_panel *panel,
                                      const struct dea_figure_variant list[], size_t count,
                                      bool voltages)
{
  size_t entries = 0;
  char title[DEA_LABEL_SIZE];
  for (size_t i = 0; i < count; i++) {
    struct dea_series look = list[i].look;
    look.style = DEA_LINE;
    if (is_first(list, i, true)) {
      dea_label_escape(list[i].variant->name, title, sizeof title);
      size_t n = strlen(title);
      if (voltages) {
        snprintf(title + n, sizeof title - n, ", %.3g kV",
                 1e-3 * list[i].variant->profile.voltage_V);
      }
      DEA_TRY(ctx, add_entry(ctx, panel, &look, title));
      entries++;
    }
  }
  bool several =
      count > 0 && strcmp(list[0].variant->curve.model, list[count - 1].variant->curve.model) != 0;
  for (size_t i = 0; i < count && several; i++) {
    struct dea_series look = list[i].look;
    look.colour = DEA_GREY;
    if (is_first(list, i, false)) {
      dea_label_escape(list[i].variant->curve.model, title, sizeof title);
      DEA_TRY(ctx, add_entry(ctx, panel, &look, title));
      entries++;
    }
  }
  size_t longest = 0;
  for (size_t i = 0; i < panel->series_count; i++) {
    size_t length = strlen(panel->series[i].title);
    longest = length > longest ? length : longest;
  }
  panel->key = key_of(entries, longest);
  return DEA_OK;
}
