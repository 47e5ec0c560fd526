#include "plot/plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

dea_status dea_plot_create(struct dea_context *ctx, const char *name, const char *caption,
                           struct dea_plot **out)
{
  *out = dea_alloc(ctx, 1, sizeof **out);
  DEA_TRY_MEMORY(*out != NULL);
  snprintf((*out)->name, sizeof(*out)->name, "%s", name);
  snprintf((*out)->caption, sizeof(*out)->caption, "%s", caption);
  (*out)->panel_count = 1;
  (*out)->second_height = 1.0;
  for (int i = 0; i < DEA_PLOT_PANELS_MAX; i++) {
    struct dea_panel *panel = &(*out)->panels[i];
    panel->x_min = panel->x_max = panel->y_min = panel->y_max = NAN;
    panel->key = "top left";
  }
  return DEA_OK;
}

void dea_plot_destroy(struct dea_context *ctx, struct dea_plot *plot)
{
  if (plot == NULL) {
    return;
  }
  for (int i = 0; i < DEA_PLOT_PANELS_MAX; i++) {
    dea_panel_clear(ctx, &plot->panels[i]);
  }
  dea_free(ctx, plot);
}

void dea_panel_clear(struct dea_context *ctx, struct dea_panel *panel)
{
  for (size_t s = 0; s < panel->series_count; s++) {
    dea_free(ctx, panel->series[s].values);
  }
  panel->series_count = 0;
  panel->dashed = NULL;
  panel->sides[0] = panel->sides[1] = NULL;
}

dea_status dea_panel_add(struct dea_context *ctx, struct dea_panel *panel, size_t count,
                         enum dea_series_style style, enum dea_colour colour, const char *title,
                         struct dea_series **out)
{
  *out = NULL;
  if (panel->series_count == DEA_PANEL_SERIES_MAX) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "a figure holds at most %d series",
                    DEA_PANEL_SERIES_MAX);
  }
  double *values = dea_alloc(ctx, 3 * count, sizeof *values);
  DEA_TRY_MEMORY(values != NULL);
  for (size_t i = 0; i < 3 * count; i++) {
    values[i] = NAN;
  }
  *out = &panel->series[panel->series_count++];
  **out = (struct dea_series){.style = style, .colour = colour, .count = count, .values = values};
  snprintf((*out)->title, sizeof(*out)->title, "%s", title);
  return DEA_OK;
}

dea_status dea_panel_add_as(struct dea_context *ctx, struct dea_panel *panel, size_t count,
                            const struct dea_series *look, struct dea_series **out)
{
  DEA_TRY(ctx, dea_panel_add(ctx, panel, count, look->style, look->colour, "", out));
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): dea_panel_add sets it or fails
  double *values = (*out)->values;
  **out = *look;
  (*out)->count = count;
  (*out)->values = values;
  return DEA_OK;
}

void dea_panel_mark(struct dea_panel *panel, double at, const char *text)
{
  if (panel->mark_count < DEA_PANEL_MARKS_MAX && isfinite(at)) {
    struct dea_mark *mark = &panel->marks[panel->mark_count++];
    mark->at = at;
    dea_label_escape(text, mark->text, sizeof mark->text);
  }
}

bool dea_series_shows(const struct dea_series *series)
{
  for (size_t i = 0; i < series->count; i++) {
    if (isfinite(series->values[i]) && isfinite(series->values[series->count + i])) {
      return true;
    }
  }
  return false;
}

bool dea_plot_shows(const struct dea_plot *plot)
{
  for (size_t p = 0; p < plot->panel_count; p++) {
    for (size_t s = 0; s < plot->panels[p].series_count; s++) {
      if (dea_series_shows(&plot->panels[p].series[s])) {
        return true;
      }
    }
  }
  return false;
}

void dea_label_escape(const char *text, char *out, size_t size)
{
  size_t n = 0;
  for (; *text != '\0' && n + 4 < size; text++) {
    unsigned char c = (unsigned char)*text;
    if (c < ' ') {
      c = ' ';
    }
    if (strchr("_^{}@&~", c) != NULL) {
      out[n++] = '\\'; // twice: once for the string in double quotes, once for enhanced text
      out[n++] = '\\';
    } else if (c == '"' || c == '\\' || c == '`' || c == '$') {
      c = '\'';
    }
    out[n++] = (char)c;
  }
  out[n] = '\0';
  dea_text_flatten(out);
}
