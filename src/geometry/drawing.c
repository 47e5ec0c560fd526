#define _POSIX_C_SOURCE 200809L // strcasecmp
#include "geometry/drawing.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

dea_status dea_drawing_create(struct dea_context *ctx, const char *file,
                              const struct dea_drawing_settings *settings, struct dea_drawing **out)
{
  struct dea_drawing *d = dea_alloc(ctx, 1, sizeof *d);
  *out = d;
  DEA_TRY_MEMORY(d != NULL);
  d->ctx = ctx;
  d->settings = settings != NULL ? *settings : (struct dea_drawing_settings){0};
  if (d->settings.vertices_max == 0) {
    d->settings.vertices_max = DEA_DRAWING_VERTICES_MAX;
  }
  d->file = dea_intern(ctx, file);
  if (d->file == NULL) {
    dea_drawing_destroy(d);
    *out = NULL;
    return DEA_E_MEMORY;
  }
  return DEA_OK;
}

void dea_drawing_destroy(struct dea_drawing *drawing)
{
  if (drawing != NULL) {
    dea_free(drawing->ctx, drawing->layer);
    dea_free(drawing->ctx, drawing->path);
    dea_free(drawing->ctx, drawing->skipped);
    dea_free(drawing->ctx, drawing->vertex);
    dea_free(drawing->ctx, drawing);
  }
}

dea_status dea_drawing_fault(const struct dea_drawing *drawing, size_t line, const char *format,
                             ...)
{
  char text[400];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  const struct dea_location location = {drawing->file, line, line > 0};
  DEA_TRY(drawing->ctx, dea_finding_add(drawing->ctx, DEA_ERROR, location, "%s", text));
  return dea_fail(drawing->ctx, DEA_E_DESIGN, "%s:%zu: %s", drawing->file, line, text);
}

size_t dea_drawing_find_layer(const struct dea_drawing *drawing, const char *name)
{
  int (*compare)(const char *, const char *) = drawing->any_case ? strcasecmp : strcmp;
  size_t layer = 0;
  while (layer < drawing->layer_count && compare(drawing->layer[layer], name) != 0) {
    layer++;
  }
  return layer;
}

dea_status dea_drawing_layer(struct dea_drawing *drawing, const char *name, size_t *layer)
{
  struct dea_drawing *d = drawing;
  *layer = dea_drawing_find_layer(d, name);
  if (*layer < d->layer_count) {
    return DEA_OK;
  }
  if (d->layer_count == DEA_DRAWING_LAYERS_MAX) {
    return dea_drawing_fault(d, 0, "the drawing has more than %d layers", DEA_DRAWING_LAYERS_MAX);
  }
  DEA_TRY_STATUS(
      dea_array_grow(d->ctx, &d->layer, d->layer_count, &d->layer_room, sizeof *d->layer));
  const char *kept = dea_intern(d->ctx, name);
  DEA_TRY_MEMORY(kept != NULL);
  d->layer[d->layer_count++] = kept;
  return DEA_OK;
}

size_t dea_drawing_open_vertices(const struct dea_drawing *drawing)
{
  size_t paths = drawing->path_count;
  return drawing->vertex_count - (paths > 0 ? drawing->path[paths - 1].end : 0);
}

dea_status dea_drawing_end_path(struct dea_drawing *drawing, size_t layer, bool closed)
{
  struct dea_drawing *d = drawing;
  size_t count = dea_drawing_open_vertices(d);
  if (count < 2) {
    d->vertex_count -= count;
    return DEA_OK;
  }
  const struct dea_vertex *first = d->vertex + d->vertex_count - count, *last = first + count - 1;
  if (closed && count > 2 && first->x_m == last->x_m && first->y_m == last->y_m) {
    d->vertex_count--;
  }
  DEA_TRY_STATUS(dea_array_grow(d->ctx, &d->path, d->path_count, &d->path_room, sizeof *d->path));
  d->path[d->path_count++] = (struct dea_drawing_path){layer, d->vertex_count, closed};
  return DEA_OK;
}

dea_status dea_drawing_skip(struct dea_drawing *drawing, size_t layer, const char *kind,
                            size_t line)
{
  struct dea_drawing *d = drawing;
  struct dea_drawing_skipped entry = {"", layer, 1, {d->file, line, line > 0}};
  snprintf(entry.kind, sizeof entry.kind, "%s", kind);
  for (size_t i = 0; i < d->skipped_count; i++) {
    bool full = d->skipped_count == DEA_DRAWING_LAYERS_MAX && i + 1 == d->skipped_count;
    if (full || (d->skipped[i].layer == layer && strcmp(d->skipped[i].kind, entry.kind) == 0)) {
      d->skipped[i].count++;
      return DEA_OK;
    }
  }
  DEA_TRY_STATUS(
      dea_array_grow(d->ctx, &d->skipped, d->skipped_count, &d->skipped_room, sizeof *d->skipped));
  d->skipped[d->skipped_count++] = entry;
  return DEA_OK;
}

dea_status dea_drawing_add_notes(const struct dea_drawing *drawing, const char *assumed)
{
  const struct dea_drawing *d = drawing;
  const struct dea_location location = {d->file, 0, 0};
  if (!d->unit_is_known && !(d->settings.unit_m > 0)) {
    DEA_TRY(d->ctx, dea_finding_add(d->ctx, DEA_NOTE, location, "%s", assumed));
  }
  return d->curves == 0
             ? DEA_OK
             : dea_finding_add(d->ctx, DEA_NOTE, location,
                               "%zu curve%s became circular arcs, to within %.2g mm", d->curves,
                               d->curves > 1 ? "s" : "", 1e3 * d->deviation_m);
}
