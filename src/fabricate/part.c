#include "fabricate/part.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

static void begin(struct dea_part *part, enum dea_layer layer, bool closed)
{
  part->failed =
      part->failed || dea_array_grow(part->ctx, &part->contour, part->contour_count,
                                     &part->contour_room, sizeof *part->contour) != DEA_OK;
  if (!part->failed) {
    part->contour[part->contour_count++] =
        (struct dea_part_contour){layer, closed, false, part->vertex_count, 0};
  }
}

static void add_vertex(struct dea_part *part, double x, double y, double bulge,
                       struct dea_location location)
{
  part->failed = part->failed || dea_array_grow(part->ctx, &part->vertex, part->vertex_count,
                                                &part->vertex_room, sizeof *part->vertex) != DEA_OK;
  if (!part->failed) {
    part->vertex[part->vertex_count++] = (struct dea_vertex){x, y, bulge, location};
    part->contour[part->contour_count - 1].count++;
  }
}

void dea_part_add(struct dea_part *part, enum dea_layer layer, const struct dea_vertex *vertices,
                  size_t count, bool circle)
{
  begin(part, layer, true);
  for (size_t i = 0; i < count; i++) {
    add_vertex(part, vertices[i].x_m, vertices[i].y_m, vertices[i].bulge, vertices[i].location);
  }
  if (!part->failed) {
    part->contour[part->contour_count - 1].circle = circle;
  }
}

void dea_part_circle(struct dea_part *part, enum dea_layer layer, double x_m, double y_m,
                     double radius_m, struct dea_location location)
{
  const struct dea_vertex v[2] = {{x_m + radius_m, y_m, 1, location},
                                  {x_m - radius_m, y_m, 1, location}};
  dea_part_add(part, layer, v, 2, true);
}

void dea_part_line(struct dea_part *part, enum dea_layer layer, double x0_m, double y0_m,
                   double x1_m, double y1_m, struct dea_location location)
{
  begin(part, layer, false);
  add_vertex(part, x0_m, y0_m, 0, location);
  add_vertex(part, x1_m, y1_m, 0, location);
}

void dea_part_write(struct dea_part *part, double x_m, double y_m, double height_m,
                    const char *format, ...)
{
  if (part->text_count < DEA_PART_TEXTS_MAX) {
    struct dea_part_text *text = &part->text[part->text_count++];
    *text = (struct dea_part_text){.x_m = x_m, .y_m = y_m, .height_m = height_m};
    va_list args;
    va_start(args, format);
    vsnprintf(text->text, sizeof text->text, format, args);
    va_end(args);
  }
}

void dea_part_measure(struct dea_part *part, enum dea_measure_kind kind, double x0_m, double y0_m,
                      double x1_m, double y1_m, const char *what, struct dea_location location)
{
  if (part->measure_count < DEA_PART_MEASURES_MAX) {
    part->measure[part->measure_count++] =
        (struct dea_part_measure){kind, {x0_m, y0_m}, {x1_m, y1_m}, what, location};
  }
}

const char *dea_part_film_name(const struct dea_part *part)
{
  return part->flat ? "flat" : dea_film_state_name(part->state);
}

struct dea_contour dea_part_contour_get(const struct dea_part *part, size_t i)
{
  const struct dea_part_contour *c = &part->contour[i];
  return (struct dea_contour){part->vertex + c->first, c->count, c->closed};
}

void dea_part_box(const struct dea_part *part, double box_m[4])
{
  box_m[0] = box_m[1] = INFINITY;
  box_m[2] = box_m[3] = -INFINITY;
  for (size_t i = 0; i < part->contour_count; i++) {
    const struct dea_contour contour = dea_part_contour_get(part, i);
    dea_contour_grow_box(&contour, box_m);
  }
}

double dea_part_area_m2(const struct dea_part *part)
{
  double area = 0;
  for (size_t i = 0; i < part->contour_count; i++) {
    const struct dea_contour contour = dea_part_contour_get(part, i);
    enum dea_layer layer = part->contour[i].layer;
    area += layer == DEA_LAYER_CUT_OUTER   ? dea_contour_area_m2(&contour)
            : layer == DEA_LAYER_CUT_INNER ? -dea_contour_area_m2(&contour)
                                           : 0;
  }
  return area;
}

double dea_part_length_m(const struct dea_part *part, enum dea_layer layer)
{
  double length = 0;
  for (size_t i = 0; i < part->contour_count; i++) {
    const struct dea_contour contour = dea_part_contour_get(part, i);
    length += part->contour[i].layer == layer ? dea_contour_length_m(&contour) : 0;
  }
  return length;
}

void dea_part_free(struct dea_part *part)
{
  if (part->ctx != NULL) {
    dea_free(part->ctx, part->vertex);
    dea_free(part->ctx, part->contour);
    part->vertex = NULL;
    part->contour = NULL;
    part->vertex_count = part->vertex_room = part->contour_count = part->contour_room = 0;
  }
}
