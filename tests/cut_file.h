/* Reads back what `dea fab` writes: entities of a DXF file and elements of an SVG file, in mm, by
 * means that share nothing with the writers. */
#pragma once

#include "testing.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CUT_SHAPES_MAX = 4000, CUT_VERTICES_MAX = 40000 };

struct cut_shape {
  char layer[16];
  bool circle, closed;
  double x, y, r;   // of a circle
  int first, count; // of cut_vertex
};

static struct cut_shape cut_shape[CUT_SHAPES_MAX];
static double cut_vertex[CUT_VERTICES_MAX][3]; // x, y, bulge to the next
static int cut_count, cut_used;

static inline struct cut_shape *cut_add(const char *layer, bool circle)
{
  assert_true(cut_count < CUT_SHAPES_MAX);
  struct cut_shape *shape = &cut_shape[cut_count++];
  *shape = (struct cut_shape){.circle = circle, .closed = true, .first = cut_used};
  snprintf(shape->layer, sizeof shape->layer, "%.15s", layer);
  return shape;
}

static inline void cut_add_vertex(struct cut_shape *shape, double x, double y)
{
  assert_true(cut_used < CUT_VERTICES_MAX);
  cut_vertex[cut_used][0] = x;
  cut_vertex[cut_used][1] = y;
  cut_vertex[cut_used][2] = 0;
  cut_used++;
  shape->count++;
}

/* A line of text without its end; *at moves behind it. */
static inline const char *cut_line(const char **at)
{
  static char line[2][256];
  static int turn;
  size_t n = strcspn(*at, "\n");
  turn = !turn;
  snprintf(line[turn], sizeof line[turn], "%.*s", (int)(n < 255 ? n : 255), *at);
  *at += n + ((*at)[n] == '\n');
  return line[turn];
}

static inline void cut_read_dxf(const char *text)
{
  const char *at = strstr(text, "ENTITIES\n");
  struct cut_shape *shape = NULL;
  bool polyline = false;
  cut_count = cut_used = 0;
  assert_non_null(at);
  at += 9;
  while (*at != '\0') {
    int code = atoi(cut_line(&at));
    const char *value = cut_line(&at);
    double number = strtod(value, NULL);
    if (code == 0) {
      if (strcmp(value, "ENDSEC") == 0) {
        return;
      }
      polyline = strcmp(value, "LWPOLYLINE") == 0;
      shape = polyline || strcmp(value, "CIRCLE") == 0 ? cut_add("", !polyline) : NULL;
    } else if (shape != NULL && code == 8) {
      snprintf(shape->layer, sizeof shape->layer, "%.15s", value);
    } else if (shape != NULL && code == 70) {
      shape->closed = number != 0;
    } else if (shape != NULL && code == 10 && polyline) {
      cut_add_vertex(shape, number, 0);
    } else if (shape != NULL && code == 20 && polyline) {
      cut_vertex[cut_used - 1][1] = number;
    } else if (shape != NULL && code == 42 && polyline) {
      cut_vertex[cut_used - 1][2] = number;
    } else if (shape != NULL && !polyline) {
      double *to = code == 10 ? &shape->x : code == 20 ? &shape->y : code == 40 ? &shape->r : NULL;
      if (to != NULL) {
        *to = number;
      }
    }
  }
  fail_msg("the section of entities has no end");
}

/* y upwards again, as in the DXF file. */
static inline void cut_read_path(struct cut_shape *shape, const char *d, double height)
{
  double x, y, r, unused;
  int used = 0, large, sweep;
  assert_int_equal(sscanf(d, "M%lf %lf%n", &x, &y, &used), 2);
  cut_add_vertex(shape, x, height - y);
  for (d += used; *d != '"';) {
    while (*d == ' ') {
      d++;
    }
    if (*d == 'Z') {
      // the last vertex is the first again
      assert_close(cut_vertex[cut_used - 1][0], cut_vertex[shape->first][0], 0, 2e-6);
      assert_close(cut_vertex[cut_used - 1][1], cut_vertex[shape->first][1], 0, 2e-6);
      cut_used--;
      shape->count--;
      return;
    }
    if (sscanf(d, "L%lf %lf%n", &x, &y, &used) == 2) {
      cut_add_vertex(shape, x, height - y);
    } else {
      assert_int_equal(
          sscanf(d, "A%lf %lf 0 %d %d %lf %lf%n", &r, &unused, &large, &sweep, &x, &y, &used), 6);
      double *from = cut_vertex[cut_used - 1];
      double chord = hypot(x - from[0], height - y - from[1]);
      double half = asin(fmin(1, 0.5 * chord / r)); // of the arc's angle
      half = large ? acos(-1) - half : half;
      from[2] = (sweep ? -1 : 1) * tan(0.5 * half);
      cut_add_vertex(shape, x, height - y);
    }
    d += used;
  }
  shape->closed = false;
}

static inline void cut_read_svg(const char *text)
{
  double width, height;
  char layer[16] = "";
  const char *at = strstr(text, "viewBox=\"");
  cut_count = cut_used = 0;
  assert_non_null(at);
  assert_int_equal(sscanf(at, "viewBox=\"0 0 %lf %lf\"", &width, &height), 2);
  for (; (at = strchr(at, '<')) != NULL; at++) {
    if (strncmp(at, "<g id=", 6) == 0) {
      assert_int_equal(sscanf(at, "<g id=\"%15[A-Z_]\"", layer), 1);
    } else if (strncmp(at, "<circle", 7) == 0) {
      struct cut_shape *shape = cut_add(layer, true);
      assert_int_equal(
          sscanf(at, "<circle cx=\"%lf\" cy=\"%lf\" r=\"%lf\"", &shape->x, &shape->y, &shape->r),
          3);
      shape->y = height - shape->y;
    } else if (strncmp(at, "<path d=\"", 9) == 0) {
      cut_read_path(cut_add(layer, false), at + 9, height);
    }
  }
}

/* Area and length of a shape, arcs by their chord and angle. */
static inline double cut_area(const struct cut_shape *shape)
{
  double area = shape->circle ? acos(-1) * shape->r * shape->r : 0;
  for (int i = 0; i < shape->count; i++) {
    const double *p = cut_vertex[shape->first + i];
    const double *q = cut_vertex[shape->first + (i + 1) % shape->count];
    double angle = 4 * atan(p[2]), chord = hypot(q[0] - p[0], q[1] - p[1]);
    area += 0.5 * (p[0] * q[1] - q[0] * p[1]);
    if (angle != 0) {
      double r = 0.5 * chord / sin(0.5 * fabs(angle));
      area += 0.5 * r * r * (angle - sin(angle));
    }
  }
  return area;
}

static inline double cut_length(const struct cut_shape *shape)
{
  double length = shape->circle ? 2 * acos(-1) * shape->r : 0;
  for (int i = 0; i < shape->count - !shape->closed; i++) {
    const double *p = cut_vertex[shape->first + i];
    const double *q = cut_vertex[shape->first + (i + 1) % shape->count];
    double half = 2 * fabs(atan(p[2])), chord = hypot(q[0] - p[0], q[1] - p[1]);
    length += half > 0 ? chord * half / sin(half) : chord;
  }
  return length;
}
