/* Files for the workshop, read back: areas, lengths and places against those of the design, by
 * closed forms, for designs drawn at random. */
// ctest: quick, heavy
#include "fabricate/dxf_write.h"
#include "fabricate/svg.h"
#include "workshop_fixture.h"
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Reads back what `dea fab` writes: entities of a DXF file and elements of an SVG file, in mm, by
 * means that share nothing with the writers. */

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

static struct cut_shape *cut_add(const char *layer, bool circle)
{
  assert_true(cut_count < CUT_SHAPES_MAX);
  struct cut_shape *shape = &cut_shape[cut_count++];
  *shape = (struct cut_shape){.circle = circle, .closed = true, .first = cut_used};
  snprintf(shape->layer, sizeof shape->layer, "%.15s", layer);
  return shape;
}

static void cut_add_vertex(struct cut_shape *shape, double x, double y)
{
  assert_true(cut_used < CUT_VERTICES_MAX);
  cut_vertex[cut_used][0] = x;
  cut_vertex[cut_used][1] = y;
  cut_vertex[cut_used][2] = 0;
  cut_used++;
  shape->count++;
}

/* A line of text without its end; *at moves behind it. */
static const char *cut_line(const char **at)
{
  static char line[2][256];
  static int turn;
  size_t n = strcspn(*at, "\n");
  turn = !turn;
  snprintf(line[turn], sizeof line[turn], "%.*s", (int)(n < 255 ? n : 255), *at);
  *at += n + ((*at)[n] == '\n');
  return line[turn];
}

static void cut_read_dxf(const char *text)
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
static void cut_read_path(struct cut_shape *shape, const char *d, double height)
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

static void cut_read_svg(const char *text)
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
static double cut_area(const struct cut_shape *shape)
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

static double cut_length(const struct cut_shape *shape)
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

static const double pi = 3.14159265358979323846;

/* ---- designs drawn at random, all lengths in mm ---- */

struct drawn {
  double l, R, r, lead, pad, ring, margin, mark, kerf, window; // stretched, radii
  int fibres, copies;
  double width, tip_width, tip, gap, anchor, tab, tab_length;
  bool free_end;
  char text[4096];
};

static unsigned long long seed;

static double draw(double low, double high)
{
  seed = seed * 6364136223846793005ull + 1442695040888963407ull;
  return low + (high - low) * (double)(seed >> 40) / (double)(1 << 24);
}

static void draw_design(struct drawn *d)
{
  *d = (struct drawn){.l = draw(1, 2.5),
                      .R = draw(8, 30),
                      .ring = draw(9, 14),
                      .margin = draw(0, 15),
                      .window = draw(0.5, 1.5),
                      .kerf = draw(0, 1) < 0.4 ? 0 : draw(0.02, 0.2),
                      .copies = 1 + (int)draw(0, 3.99),
                      .fibres = (int)draw(0, 9.99),
                      .free_end = draw(0, 1) < 0.3};
  d->r = draw(0.2, 0.5) * d->R;
  d->lead = draw(0.35, 0.7) * d->l;
  d->pad = draw(2, 3);
  d->mark = draw(0.3, 0.5) * d->l;
  d->width = draw(0.8, 2.5);
  d->tip_width = draw(0.4, 1) * d->width;
  d->tip = d->r * draw(0.8, 1.2);
  d->gap = d->free_end ? draw(0.6, 1.5) : 0;
  d->anchor = draw(1, 3);
  d->tab = draw(0, 1) < 0.3 ? d->width : draw(0.6, 0.7) * d->width; // steps wider than the kerf
  d->tab_length = draw(0.8, 1.5);
  int used = snprintf(
      d->text, sizeof d->text,
      "dea: 1\nfilm: {material: film, thickness: 100 um}\npre_stretch: %.9f\n"
      "frame: {inner_radius: %.9f mm}\nelectrodes: {radius: %.9f mm unstretched}\n"
      "fabrication:\n  kerf: %.9f mm\n  minimum_feature: 0.3 mm\n  copies: %d\n"
      "  sheet: {width: 900 mm, height: 500 mm}\n  blank: {margin: %.9f mm stretched}\n"
      "  leads: {width: %.9f mm stretched, pad_diameter: %.9f mm unstretched}\n"
      "  ring: {width: %.9f mm, contact_window: %.9f mm}\n"
      "  holder: {anchor: %.9f mm, tab_width: %.9f mm, tab_length: %.9f mm}\n"
      "  marks: {diameter: %.9f mm unstretched}\n",
      d->l, d->R, d->r / d->l, d->kerf, d->copies, d->margin, 2 * d->lead, 2 * d->pad / d->l,
      d->ring, 2 * d->window, d->anchor, d->tab, d->tab_length, 2 * d->mark / d->l);
  if (d->fibres > 0) {
    used += snprintf(d->text + used, sizeof d->text - (size_t)used,
                     "fibres: {count: %d, width: %.9f mm, tip_width: %.9f mm, material: stiff,\n"
                     "  tip_radius: %.9f mm unstretched, outer_end: %s%s%.9f%s}\n",
                     d->fibres, d->width, d->tip_width, d->tip / d->l,
                     d->free_end ? "free" : "clamped", d->free_end ? ", outer_gap: " : "",
                     d->free_end ? d->gap : 0, d->free_end ? " mm stretched" : "");
    if (!d->free_end) { // no gap to be written
      char *zero = strstr(d->text, "clamped0.000000000");
      memmove(zero + 7, zero + 18, strlen(zero + 18) + 1);
      used -= 11;
    }
  }
  snprintf(d->text + used, sizeof d->text - (size_t)used, "%s", FILM_MATERIAL);
}

/* ---- closed forms ---- */

/* Between a chord of length c of a circle and its arc. */
static double segment(double r, double c)
{
  return r * r * asin(0.5 * c / r) - 0.5 * c * sqrt(r * r - 0.25 * c * c);
}

/* Distance of the chord from the centre. */
static double chord_at(double r, double c)
{
  return sqrt(r * r - 0.25 * c * c);
}

/* Disc, lead and pad, all smaller by the pre-stretch. */
static double opening_area(const struct drawn *d)
{
  double r = d->r / d->l, p = d->pad / d->l, w = 2 * d->lead / d->l;
  double apart = (d->R + 0.5 * d->ring) / d->l;
  return pi * r * r - segment(r, w) + w * (apart - chord_at(r, w) - chord_at(p, w)) + pi * p * p -
         segment(p, w);
}

static double opening_length(const struct drawn *d)
{
  double r = d->r / d->l, p = d->pad / d->l, w = 2 * d->lead / d->l;
  double apart = (d->R + 0.5 * d->ring) / d->l;
  return 2 * r * (pi - asin(0.5 * w / r)) + 2 * p * (pi - asin(0.5 * w / p)) +
         2 * (apart - chord_at(r, w) - chord_at(p, w));
}

/* The opening around the fibres: a disc without fibres, anchors and tabs. */
static double fibre_opening_area(const struct drawn *d)
{
  double outer = d->R - d->gap, end = d->free_end ? outer : d->R + d->anchor;
  double holder = fmax(end, d->R) + d->tab_length, w = d->width, t = d->tip_width, b = d->tab;
  double fibre = 0.5 * (w + t) * (chord_at(outer, w) - d->tip) + // its tip is straight
                 w * (chord_at(end, w) - chord_at(outer, w)) + segment(end, w);
  double tab = b * (chord_at(holder, b) - chord_at(end, b)) + segment(holder, b) - segment(end, b);
  return pi * holder * holder - d->fibres * (fibre + tab);
}

/* ---- reading back ---- */

static size_t part_index(const char *name)
{
  for (size_t i = 0; i < workshop->count; i++) {
    if (strcmp(workshop->part[i].name, name) == 0) {
      return i;
    }
  }
  fail_msg("no part '%s'", name);
  return 0;
}

static void read_part(const char *name, bool svg)
{
  struct dea_text text = {.ctx = ctx};
  size_t i = part_index(name);
  assert_int_equal((svg ? dea_svg_write : dea_dxf_write)(workshop, i, &text), DEA_OK);
  (svg ? cut_read_svg : cut_read_dxf)(dea_text_get(&text));
  dea_text_free(&text);
}

/* Shapes of a layer: circles of a radius, or polylines. */
static int count_circles(const char *layer, double r)
{
  int count = 0;
  for (int i = 0; i < cut_count; i++) {
    const struct cut_shape *s = &cut_shape[i];
    count += s->circle && strcmp(s->layer, layer) == 0 && fabs(s->r - r) < 1e-6;
  }
  return count;
}

static const struct cut_shape *polyline(const char *layer, int number)
{
  for (int i = 0; i < cut_count; i++) {
    const struct cut_shape *s = &cut_shape[i];
    if (!s->circle && strcmp(s->layer, layer) == 0 && number-- == 0) {
      return s;
    }
  }
  fail_msg("no polyline on layer %s", layer);
  return NULL;
}

/* Smallest distance of a point from a shape. */
static double distance_to(const struct cut_shape *shape, double x, double y)
{
  double nearest = INFINITY;
  for (int i = 0; i < shape->count; i++) {
    const double *p = cut_vertex[shape->first + i];
    const double *q = cut_vertex[shape->first + (i + 1) % shape->count];
    double dx = q[0] - p[0], dy = q[1] - p[1], n = dx * dx + dy * dy, b = p[2];
    double s = fmax(0, fmin(1, ((x - p[0]) * dx + (y - p[1]) * dy) / n));
    if (b == 0) {
      nearest = fmin(nearest, hypot(x - p[0] - s * dx, y - p[1] - s * dy));
      continue;
    }
    // by turning back to the chord's frame: the arc lies between the rays to its ends
    double side = (1 - b * b) / (4 * b), cx = 0.5 * (p[0] + q[0]) - side * dy;
    double cy = 0.5 * (p[1] + q[1]) + side * dx, r = hypot(p[0] - cx, p[1] - cy);
    double turn = atan2((p[0] - cx) * (y - cy) - (p[1] - cy) * (x - cx),
                        (p[0] - cx) * (x - cx) + (p[1] - cy) * (y - cy));
    double sweep = 4 * atan(b);
    turn += turn * sweep < 0 ? copysign(2 * pi, sweep) : 0;
    nearest = fmin(nearest, fmin(hypot(x - p[0], y - p[1]), hypot(x - q[0], y - q[1])));
    nearest = fabs(turn) <= fabs(sweep) ? fmin(nearest, fabs(hypot(x - cx, y - cy) - r)) : nearest;
  }
  return nearest;
}

/* A path of the cutter is half the kerf away from the contour that comes out, everywhere, and on
 * its side. kept: shapes of kerf 0. */
static void check_kerf(const char *name, double half)
{
  static struct cut_shape path;
  static double at[CUT_VERTICES_MAX][2];
  read_part(name, false);
  path = *polyline("CUT_INNER", 0);
  double area = cut_area(&path), length = cut_length(&path);
  for (int i = 0; i < path.count; i++) {
    memcpy(at[i], cut_vertex[path.first + i], sizeof at[i]);
  }
  double kerf = workshop->plan.kerf_m;
  workshop->plan.kerf_m = 0; // the same places: only the paths change
  read_part(name, false);
  workshop->plan.kerf_m = kerf;
  const struct cut_shape *edge = polyline("CUT_INNER", 0);
  for (int i = 0; i < path.count; i++) {
    assert_close(distance_to(edge, at[i][0], at[i][1]), half, 0, 1e-6);
  }
  // a hole's path lies inside; between the two the areas grow with the length on the way
  double between = cut_area(edge) - area, mean = 0.5 * (length + cut_length(edge));
  assert_true(half == 0 || (between > 0.8 * half * mean && between < 1.2 * half * mean));
}

static void check_stencils(const struct drawn *d, bool svg)
{
  static const char *const names[] = {"stencil-top", "stencil-bottom"};
  double k = 0.5 * d->kerf, side = 2 * (d->R + d->ring + d->margin) / d->l;
  for (int i = 0; i < 2; i++) {
    read_part(names[i], svg);
    assert_int_equal(count_circles("CUT_INNER", d->mark / d->l - k), 3 * d->copies);
    if (d->kerf == 0) {
      for (int copy = 0; copy < d->copies; copy++) {
        assert_close(cut_area(polyline("CUT_INNER", copy)), opening_area(d), 0, 1e-3);
        assert_close(cut_length(polyline("CUT_INNER", copy)), opening_length(d), 0, 1e-3);
        assert_close(cut_area(polyline("CUT_OUTER", copy)), side * side, 0, 1e-3 * side);
      }
    } else { // a square grows by a strip and four quarters of a circle
      assert_close(cut_area(polyline("CUT_OUTER", 0)), side * side + 4 * side * k + pi * k * k, 0,
                   1e-3 * side);
      assert_close(cut_length(polyline("CUT_OUTER", 0)), 4 * side + 2 * pi * k, 0, 1e-3);
    }
  }
}

static void check_fibres(const struct drawn *d, bool svg)
{
  double k = 0.5 * d->kerf, nearest = INFINITY;
  read_part("fibres", svg);
  const struct cut_shape *opening = polyline("CUT_INNER", 0);
  assert_int_equal(count_circles("CUT_OUTER", d->R + d->ring + k), d->copies);
  assert_int_equal(count_circles("CUT_INNER", d->mark - k), 3 * d->copies);
  if (d->kerf == 0) {
    assert_close(cut_area(opening), fibre_opening_area(d), 0, 1e-3);
    double centre[2];
    dea_sheet_place(&workshop->layout[part_index("fibres")], 0, centre);
    for (int i = 0; i < opening->count; i++) {
      const double *v = cut_vertex[opening->first + i];
      nearest = fmin(nearest, hypot(v[0] - 1e3 * centre[0], v[1] - 1e3 * centre[1]));
    }
    assert_close(nearest, hypot(d->tip, 0.5 * d->tip_width), 0, 1e-5);
  }
}

static void check_rounds(const struct drawn *d, bool svg)
{
  double k = 0.5 * d->kerf;
  read_part("film", svg);
  assert_int_equal(count_circles("CUT_OUTER", (d->R + d->ring + d->margin) / d->l + k), d->copies);
  assert_int_equal(count_circles("MARK", d->mark / d->l), 3 * d->copies); // drawn, not cut
  read_part("frame", svg);
  assert_int_equal(count_circles("CUT_INNER", d->R - k), d->copies);
  assert_int_equal(count_circles("CUT_INNER", d->window - k), d->copies);
  assert_int_equal(count_circles("CUT_OUTER", d->R + d->ring + k), d->copies);
}

TEST(test_designs_drawn_at_random)
{
  int good = 0, with_fibres = 0, free_ends = 0;
  seed = 20240607;
  for (int i = 0; i < 200; i++) {
    struct drawn d;
    draw_design(&d);
    dea_status status = workshop_make(d.text, NULL, 0);
    if (status != DEA_OK) { // fibres too close, for example
      assert_int_equal(status, DEA_E_DESIGN);
      assert_true(dea_finding_count(ctx, DEA_ERROR) > 0);
      assert_null(find_error(ctx, "too short")); // nothing is that short here
      continue;
    }
    for (int svg = 0; svg < 2; svg++) {
      check_stencils(&d, svg);
      check_rounds(&d, svg);
      if (d.fibres > 0) {
        check_fibres(&d, svg);
      }
    }
    if (d.kerf > 0) {
      check_kerf("stencil-top", 0.5 * d.kerf);
      if (d.fibres > 0) {
        check_kerf("fibres", 0.5 * d.kerf);
      }
    }
    good++;
    with_fibres += d.fibres > 0;
    free_ends += d.fibres > 0 && d.free_end;
  }
  print_message("%d designs, %d with fibres, %d with free ends\n", good, with_fibres, free_ends);
  assert_true(good > 100 && with_fibres > 80 && free_ends > 20);
}

/* ---- film before and after the stretch ---- */

/* A contour of a part, by its layer and number; its places from the centre, in metres. */
static struct dea_contour contour_of(const char *part, enum dea_layer layer, size_t number)
{
  const struct dea_part *p = &workshop->part[part_index(part)];
  for (size_t i = 0; i < p->contour_count; i++) {
    if (p->contour[i].layer == layer && p->contour[i].path.count > 2 && number-- == 0) {
      return p->contour[i].path;
    }
  }
  fail_msg("no such contour in '%s'", part);
  return (struct dea_contour){0};
}

TEST(test_the_stretched_electrode_is_the_simulated_one)
{
  seed = 7;
  for (int i = 0; i < 40; i++) {
    struct drawn d;
    draw_design(&d);
    if (workshop_make(d.text, NULL, 0) != DEA_OK) {
      continue;
    }
    const struct dea_contour top = contour_of("stencil-top", DEA_LAYER_CUT_INNER, 0);
    const struct dea_contour drawn = contour_of("template", DEA_LAYER_MARK, 0);
    assert_int_equal(top.count, drawn.count);
    double on_disc = 0;
    for (size_t k = 0; k < top.count; k++) {
      // every place of the film goes to l times its distance from the centre, arcs stay arcs
      assert_close(top.vertex[k].x_m * device->pre_stretch, drawn.vertex[k].x_m, 1e-12, 1e-15);
      assert_close(top.vertex[k].y_m * device->pre_stretch, drawn.vertex[k].y_m, 1e-12, 1e-15);
      assert_close(top.vertex[k].bulge, drawn.vertex[k].bulge, 1e-12, 1e-15);
      const struct dea_piece piece = dea_contour_piece(&top, k);
      if (piece.arc && hypot(piece.centre[0], piece.centre[1]) < 1e-9) {
        assert_close(piece.radius_m * device->pre_stretch, device->electrode_radius_m, 1e-9, 0);
        on_disc += piece.sweep;
      }
    }
    // all of the disc but where the lead begins
    assert_close(on_disc, 2 * pi - 2 * asin(d.lead / d.r), 1e-6, 0);
  }
}

/* Centres of the alignment marks of a part's sheet, from the centre of its first copy, in mm. */
static void read_marks(const char *part, const char *layer, double out[3][2])
{
  double centre[2];
  int found = 0;
  read_part(part, false);
  dea_sheet_place(&workshop->layout[part_index(part)], 0, centre);
  double mark = 1e3 * workshop->plan.mark_m, scale = 1 / device->pre_stretch;
  for (int i = 0; i < cut_count && found < 3; i++) {
    const struct cut_shape *s = &cut_shape[i];
    bool round = s->circle && strcmp(s->layer, layer) == 0;
    if (round && (fabs(s->r - mark) < 1e-6 || fabs(s->r - mark * scale) < 1e-6)) {
      out[found][0] = s->x - 1e3 * centre[0];
      out[found++][1] = s->y - 1e3 * centre[1];
    }
  }
  assert_int_equal(found, 3);
}

TEST(test_marks_meet_in_all_sheets)
{
  static const struct {
    const char *part, *layer;
    bool stretched, mirrored;
  } sheets[] = {{"film", "MARK", false, false},
                {"stencil-top", "CUT_INNER", false, false},
                {"stencil-bottom", "CUT_INNER", false, true},
                {"template", "MARK", true, false},
                {"fibres", "CUT_INNER", true, false}};
  for (int fibres = 1; fibres < 10; fibres++) {
    char count[12];
    snprintf(count, sizeof count, "%d", fibres);
    const struct dea_override sets[] = {{"fibres.count", count},
                                        {"fibres.width", "1 mm"},
                                        {"fabrication.kerf", "0 mm"},
                                        {"fabrication.leads.width", "0.6 mm unstretched"}};
    assert_int_equal(workshop_make(GOOD_DESIGN, sets, 4), DEA_OK);
    double frame[3][2], mark[3][2];
    read_marks("frame", "CUT_INNER", frame);
    for (size_t i = 0; i < sizeof sheets / sizeof sheets[0]; i++) {
      double l = sheets[i].stretched ? 1 : 1.5, side = sheets[i].mirrored ? -1 : 1;
      read_marks(sheets[i].part, sheets[i].layer, mark);
      for (int m = 0; m < 3; m++) {
        assert_close(l * side * mark[m][0], frame[m][0], 0, 1e-6);
        assert_close(l * mark[m][1], frame[m][1], 0, 1e-6);
      }
    }
    // a sheet that is turned over does not fit, whichever way it is turned
    double angle[3];
    for (int m = 0; m < 3; m++) {
      angle[m] = atan2(frame[m][1], frame[m][0]);
    }
    double steps[3];
    for (int m = 0; m < 3; m++) {
      steps[m] = fabs(remainder(angle[(m + 1) % 3] - angle[m], 2 * pi));
    }
    for (int m = 0; m < 3; m++) { // a triangle with two equal sides is its own mirror image
      assert_true(fabs(steps[m] - steps[(m + 1) % 3]) > 0.1);
    }
  }
}

TEST(test_copies_keep_apart)
{
  const struct dea_override sets[] = {{"fabrication.copies", "7"},
                                      {"fabrication.sheet.width", "200 mm"},
                                      {"fabrication.sheet.gap", "4 mm"}};
  assert_int_equal(workshop_make(GOOD_DESIGN, sets, 3), DEA_OK);
  for (size_t i = 0; i < workshop->count; i++) {
    const struct dea_sheet_layout *layout = &workshop->layout[i];
    double box[4];
    dea_part_box(&workshop->part[i], box);
    double half = box[2] + (workshop->part[i].paper ? 0 : 0.1e-3), a[2], b[2];
    assert_int_equal(layout->count, workshop->part[i].paper ? 1 : 7);
    for (int p = 0; p < layout->count; p++) {
      dea_sheet_place(layout, p, a);
      dea_sheet_place(&workshop->layout[part_index("film")], p, b);
      if (strcmp(workshop->part[i].name, "stencil-bottom") == 0) { // it meets the film from below
        assert_close(a[0], layout->width_m - b[0], 0, 1e-12);
        assert_close(a[1], b[1], 0, 1e-12);
      } else if (strcmp(workshop->part[i].name, "stencil-top") == 0) {
        assert_close(a[0], b[0], 0, 1e-12);
        assert_close(a[1], b[1], 0, 1e-12);
      }
      assert_true(a[0] - half >= 5e-3 - 1e-9 && a[0] + half <= layout->width_m - 5e-3 + 1e-9);
      assert_true(a[1] - half >= 5e-3 - 1e-9 && a[1] + half <= layout->height_m - 5e-3 + 1e-9);
      for (int q = 0; q < p; q++) {
        dea_sheet_place(layout, q, b);
        double apart = fmax(fabs(a[0] - b[0]), fabs(a[1] - b[1])) - 2 * half;
        assert_true(apart >= 4e-3 - 1e-9);
      }
    }
  }
}

TESTS(workshop_set_up, workshop_tear_down)
