/* DXF files (ASCII, R12 and later) as drawings: lines, arcs, polylines, ellipses and splines of the
 * model space that lie in planes of constant z, also in blocks that are inserted. A file is pairs
 * of lines: a code, and what it stands for. */
#define _POSIX_C_SOURCE 200809L // strcasecmp
#include "base/text.h"
#include "geometry/drawing.h"
#include "geometry/dxf_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const double flat = 1e-9; // of a normal's direction

enum { DEPTH_MAX = 40 };

enum section { NO_SECTION, HEADER, BLOCKS, ENTITIES, OTHER_SECTION };

/* Where a file is read. */
struct place {
  const char *next, *stop;
  size_t line;
  char text[DEA_DXF_TEXT_SIZE]; // of the pair that was read
};

/* A number of an entity. */
struct value {
  long code;
  double number;
};

/* A vertex of a polyline. */
struct point {
  double at[2], z, bulge;
};

struct block {
  const char *name; // interned
  double base[2];
  struct place from; // before its first entity; stop: behind its last one
};

/* A growing list; owned. */
struct list {
  void *data;
  size_t count, capacity;
};

/* What of an entity is kept until it ends; its numbers are in the reader's list. */
struct entity {
  char type[32];
  const struct kind *kind; // NULL: it is not known
  size_t layer, line;      // line: where it starts
  bool hidden;             // in paper space, or invisible
  const char *name;        // code 2, interned; NULL: none
};

struct reader {
  struct dea_context *ctx;
  struct dea_drawing *drawing;
  struct place place;
  const char *pair; // where the last pair starts
  struct dea_dxf_text letters;
  enum section section;
  bool named;        // the section's name is read
  char variable[24]; // of the header
  struct entity entity, polyline;
  long polyline_flags;
  struct dea_affine polyline_matrix;
  bool in_polyline;         // between POLYLINE and SEQEND
  bool in_block;            // between BLOCK and ENDBLK
  struct list values;       // struct value, of the entity
  struct list points;       // struct point, of a polyline
  struct list numbers;      // double, of a spline
  struct list blocks;       // struct block
  size_t zero;              // layer "0"
  size_t layer;             // that "0" is in the block that is inserted
  struct dea_affine matrix; // of that block
  int depth;                // of blocks in each other
  size_t again;             // lines that were read in inserted blocks
};

struct kind {
  const char *name;
  dea_status (*add)(struct reader *r); // NULL: it belongs to others, or cannot be cut: no words
  bool world; // its coordinates are the world's, not those of the plane that its normal makes
};

/* Metres of the values of $INSUNITS, 0 for those that are no length here. */
static double unit_of(long code)
{
  static const double unit[] = {0,       25.4e-3, 0.3048, 0,     1e-3, 1e-2, 1,  0,
                                25.4e-9, 25.4e-6, 0.9144, 1e-10, 1e-9, 1e-6, 0.1};
  return code > 0 && code < (long)(sizeof unit / sizeof *unit) ? unit[code] : 0;
}

/* One line without white space around it; false at the end of the file. */
static bool read_line(struct place *p, const char **from, size_t *length)
{
  if (p->next >= p->stop) {
    return false;
  }
  const char *first = p->next, *end = first;
  while (end < p->stop && *end != '\n' && *end != '\r') {
    end++;
  }
  p->next = end < p->stop ? end + 1 : p->stop;
  p->next += p->next < p->stop && *end == '\r' && *p->next == '\n';
  const char *last = end;
  while (first < last && (*first == ' ' || *first == '\t')) {
    first++;
  }
  while (last > first && (last[-1] == ' ' || last[-1] == '\t')) {
    last--;
  }
  *from = first;
  *length = (size_t)(last - first);
  p->line++;
  return true;
}

/* The next pair; false at the end. */
static dea_status read_pair(struct reader *r, long *code, bool *more)
{
  const char *from;
  size_t length;
  struct place *p = &r->place;
  r->pair = p->next;
  if (r->depth > 0 && ++r->again > 100 * r->drawing->settings.vertices_max) {
    return dea_drawing_fault(r->drawing, r->entity.line, "too much is inserted by blocks");
  }
  if ((r->again & 65535) == 65535 && dea_interrupted(r->ctx)) {
    return dea_fail(r->ctx, DEA_E_INTERRUPTED, "interrupted while a drawing was read");
  }
  *more = read_line(p, &from, &length);
  if (!*more) {
    return DEA_OK;
  }
  if (length == 0 && p->next >= p->stop) {
    *more = false;
    return DEA_OK;
  }
  char *end;
  char digits[16] = "";
  memcpy(digits, from, length < sizeof digits ? length : 0);
  *code = strtol(digits, &end, 10);
  if (end == digits || *end != '\0' || !read_line(p, &from, &length)) {
    return dea_drawing_fault(r->drawing, p->line,
                             "a whole number is due here: this is no DXF file, or a damaged one");
  }
  length = length < sizeof p->text ? length : sizeof p->text - 1;
  memcpy(p->text, from, length);
  p->text[length] = '\0';
  return DEA_OK;
}

static dea_status number(struct reader *r, double *out)
{
  const char *end;
  char *text = r->place.text;
  *out = dea_text_to_double(text, &end);
  if (end == text || *end != '\0' || !isfinite(*out)) {
    dea_dxf_text_decode(&r->letters, text);
    return dea_drawing_fault(r->drawing, r->place.line, "'%.*s' is no number",
                             (int)dea_text_cut(text, 40), text);
  }
  return DEA_OK;
}

/* ---- values of an entity ---- */

static dea_status add_to(struct reader *r, struct list *list, const void *item, size_t size)
{
  DEA_TRY_STATUS(dea_array_grow(r->ctx, &list->data, list->count, &list->capacity, size));
  memcpy((char *)list->data + list->count++ * size, item, size);
  return DEA_OK;
}

/* The number of a code, the last one if there are several. */
static double value_or(const struct reader *r, long code, double absent)
{
  const struct value *all = r->values.data;
  for (size_t i = r->values.count; i-- > 0;) {
    if (all[i].code == code) {
      return all[i].number;
    }
  }
  return absent;
}

static double value(const struct reader *r, long code)
{
  return value_or(r, code, 0);
}

static long whole(const struct reader *r, long code, long absent)
{
  double number = value_or(r, code, (double)absent);
  return fabs(number) < 1e6 ? (long)number : 0;
}

static bool is_level(const struct reader *r, double low, double high)
{
  return fabs(high - low) * r->drawing->unit_m <= DEA_DRAWING_JOIN_M;
}

static dea_status skip(struct reader *r, const char *why)
{
  char text[64];
  snprintf(text, sizeof text, "%.20s%s", r->entity.type, why);
  return dea_drawing_skip(r->drawing, r->entity.layer, text, r->entity.line);
}

static const char not_flat[] = " out of plane";

/* ---- kinds of entities ---- */

static dea_status end_path(struct reader *r, bool closed)
{
  return dea_drawing_end_path(r->drawing, r->entity.layer, closed);
}

static dea_status add_line(struct reader *r)
{
  if (!is_level(r, value(r, 30), value(r, 31))) {
    return skip(r, not_flat);
  }
  DEA_TRY(r->ctx, dea_drawing_line_to(r->drawing, (double[2]){value(r, 10), value(r, 20)}));
  DEA_TRY(r->ctx, dea_drawing_line_to(r->drawing, (double[2]){value(r, 11), value(r, 21)}));
  return end_path(r, false);
}

/* A CIRCLE, or an ARC between angles in degree. */
static dea_status add_arc(struct reader *r)
{
  double radius = value(r, 40), from = value(r, 50), sweep = fmod(value(r, 51) - from, 360);
  bool arc = strcmp(r->entity.type, "ARC") == 0;
  const struct dea_ellipse circle = {{value(r, 10), value(r, 20)},
                                     {radius, 0},
                                     {0, radius},
                                     arc ? from * DEA_PI / 180 : 0,
                                     (!arc || sweep == 0 ? 360 : sweep + (sweep < 0 ? 360 : 0)) *
                                         DEA_PI / 180};
  if (radius <= 0) {
    return dea_drawing_fault(r->drawing, r->entity.line, "the radius of this %s is not above 0",
                             r->entity.type);
  }
  DEA_TRY(r->ctx, dea_drawing_ellipse_to(
                      r->drawing, &circle,
                      arc ? NULL : (double[2]){circle.centre[0] + radius, circle.centre[1]}));
  return end_path(r, !arc);
}

static dea_status add_ellipse(struct reader *r)
{
  double x = value(r, 11), y = value(r, 21), ratio = value_or(r, 40, 1);
  double from = value(r, 41), sweep = fmod(value_or(r, 42, 2 * DEA_PI) - from, 2 * DEA_PI);
  double side = value_or(r, 230, 1) < 0 ? -1 : 1;
  if (fabs(fabs(value_or(r, 230, 1)) - 1) > flat || fabs(value(r, 31)) > flat * hypot(x, y)) {
    return skip(r, not_flat);
  }
  if (hypot(x, y) == 0 || ratio <= 0) {
    return dea_drawing_fault(r->drawing, r->entity.line, "an axis of this ELLIPSE has no length");
  }
  bool full = fabs(sweep) < 1e-9 || fabs(fabs(sweep) - 2 * DEA_PI) < 1e-9;
  const struct dea_ellipse ellipse = {{value(r, 10), value(r, 20)},
                                      {x, y},
                                      {-side * ratio * y, side * ratio * x},
                                      full ? 0 : from,
                                      full        ? 2 * DEA_PI
                                      : sweep < 0 ? sweep + 2 * DEA_PI
                                                  : sweep};
  const double first[2] = {ellipse.centre[0] + x, ellipse.centre[1] + y};
  DEA_TRY(r->ctx, dea_drawing_ellipse_to(r->drawing, &ellipse, full ? first : NULL));
  return end_path(r, full);
}

/* The numbers of a code, in their order. */
static dea_status gather(struct reader *r, long code, size_t *count)
{
  const struct value *all = r->values.data;
  *count = 0;
  for (size_t i = 0; i < r->values.count; i++) {
    if (all[i].code == code) {
      DEA_TRY(r->ctx, add_to(r, &r->numbers, &all[i].number, sizeof(double)));
      ++*count;
    }
  }
  return DEA_OK;
}

static dea_status add_spline(struct reader *r)
{
  size_t knots, count, rows, weights, line = r->entity.line;
  long degree = whole(r, 71, 3);
  r->numbers.count = 0;
  DEA_TRY(r->ctx, gather(r, 40, &knots));
  DEA_TRY(r->ctx, gather(r, 10, &count));
  DEA_TRY(r->ctx, gather(r, 20, &rows));
  DEA_TRY(r->ctx, gather(r, 41, &weights));
  if (count == 0) {
    return skip(r, isnan(value_or(r, 11, NAN)) ? "" : " of fit points only"); // not known how
  }
  const struct value *all = r->values.data;
  for (size_t i = 0; i < r->values.count; i++) {
    if (all[i].code == 30 && !is_level(r, all[i].number, value(r, 30))) {
      return skip(r, not_flat);
    }
  }
  if (degree < 1 || degree > DEA_SPLINE_DEGREE_MAX || rows != count || count <= (size_t)degree ||
      knots != count + (size_t)degree + 1 || (weights > 0 && weights != count)) {
    return dea_drawing_fault(r->drawing, line,
                             "a SPLINE of degree %ld with %zu control points, %zu weights and %zu "
                             "knots cannot be: %ld more knots than points are due",
                             degree, count, weights, knots, degree + 1);
  }
  const double *knot = r->numbers.data, *x = knot + knots, *y = x + count, *weight = y + count;
  double(*point)[3] = dea_alloc(r->ctx, count, sizeof *point);
  DEA_TRY_MEMORY(point != NULL);
  bool good = true;
  for (size_t i = 0; i < count; i++) {
    point[i][2] = weights > 0 ? weight[i] : 1;
    point[i][0] = point[i][2] * x[i];
    point[i][1] = point[i][2] * y[i];
    good = good && point[i][2] > 0;
  }
  for (size_t i = 1; i < knots; i++) {
    good = good && knot[i] >= knot[i - 1];
  }
  const struct dea_spline spline = {(size_t)degree, count, (const double(*)[3])point, knot};
  dea_status status =
      good ? dea_drawing_spline_to(r->drawing, &spline)
           : dea_drawing_fault(r->drawing, line,
                               "a SPLINE needs knots that ascend, and weights above 0");
  dea_free(r->ctx, point);
  return status == DEA_OK ? end_path(r, false) : status;
}

static dea_status draw_polyline(struct reader *r, bool closed)
{
  const struct point *p = r->points.data;
  size_t count = r->points.count, pieces = closed ? count : count - 1;
  for (size_t i = 0; count > 1 && i < pieces; i++) {
    DEA_TRY(r->ctx, dea_drawing_bulge_to(r->drawing, p[i].at, p[i].bulge, p[(i + 1) % count].at));
  }
  return end_path(r, closed);
}

static dea_status add_lwpolyline(struct reader *r)
{
  const struct value *all = r->values.data;
  struct point *last = NULL;
  r->points.count = 0;
  for (size_t i = 0; i < r->values.count; i++) {
    if (all[i].code == 10) {
      const struct point next = {.at = {all[i].number, 0}};
      DEA_TRY(r->ctx, add_to(r, &r->points, &next, sizeof next));
      last = (struct point *)r->points.data + r->points.count - 1;
    } else if (last != NULL && (all[i].code == 20 || all[i].code == 42)) {
      *(all[i].code == 20 ? &last->at[1] : &last->bulge) = all[i].number;
    }
  }
  return draw_polyline(r, whole(r, 70, 0) & 1);
}

/* ---- polylines with entities of their own for vertices ---- */

enum { CLOSED = 1, SPATIAL = 8, FRAME = 16, MESH = 16, FACES = 64 };

static dea_status begin_polyline(struct reader *r)
{
  if ((whole(r, 70, 0) & (MESH | FACES)) != 0) {
    return skip(r, "");
  }
  r->polyline = r->entity;
  r->polyline_flags = whole(r, 70, 0);
  r->polyline_matrix = (r->polyline_flags & SPATIAL) != 0 ? r->matrix : r->drawing->matrix;
  r->points.count = 0;
  r->in_polyline = true;
  return DEA_OK;
}

static dea_status add_vertex(struct reader *r)
{
  const struct point next = {{value(r, 10), value(r, 20)}, value(r, 30), value(r, 42)};
  bool frame = (whole(r, 70, 0) & FRAME) != 0; // of a spline, not on the line
  return r->in_polyline && !frame ? add_to(r, &r->points, &next, sizeof next) : DEA_OK;
}

static dea_status end_polyline(struct reader *r)
{
  if (!r->in_polyline) {
    return DEA_OK;
  }
  const struct point *p = r->points.data;
  bool level = true;
  for (size_t i = 1; i < r->points.count && (r->polyline_flags & SPATIAL) != 0; i++) {
    level = level && is_level(r, p[0].z, p[i].z);
  }
  r->in_polyline = false;
  r->entity = r->polyline;
  r->drawing->matrix = r->polyline_matrix;
  r->drawing->line = r->entity.line;
  return level ? draw_polyline(r, r->polyline_flags & CLOSED) : skip(r, not_flat);
}

/* ---- blocks ---- */

static dea_status parse_pair(struct reader *r, long code);
static dea_status end_entity(struct reader *r);

static dea_status read_block(struct reader *r, const struct block *block)
{
  const struct place back = r->place;
  long code = 0;
  bool more = true;
  dea_status status = DEA_OK;
  r->place = block->from;
  r->entity = (struct entity){.layer = r->layer};
  while (status == DEA_OK && more) {
    status = read_pair(r, &code, &more);
    status = status == DEA_OK && more ? parse_pair(r, code) : status;
  }
  status = status == DEA_OK ? end_entity(r) : status;
  status = status == DEA_OK ? end_polyline(r) : status;
  r->entity = (struct entity){.layer = r->layer};
  r->place = back;
  return status;
}

static const struct block *find_block(const struct reader *r)
{
  const struct block *all = r->blocks.data;
  for (size_t i = 0; i < r->blocks.count && r->entity.name != NULL; i++) {
    if (strcasecmp(all[i].name, r->entity.name) == 0) {
      return &all[i];
    }
  }
  return NULL;
}

/* A block in rows and columns: scaled about its base point, turned, moved; steps between them are
 * turned only. */
static dea_status add_insert(struct reader *r)
{
  const struct block *block = find_block(r);
  if (block == NULL) {
    return skip(r, " of no block");
  }
  if (r->depth == DEPTH_MAX) {
    return dea_drawing_fault(r->drawing, r->entity.line,
                             "blocks are inserted in each other more than %d deep", DEPTH_MAX);
  }
  const struct dea_affine outside = r->matrix, plane = r->drawing->matrix;
  double angle = value(r, 50) * DEA_PI / 180, c = cos(angle), s = sin(angle);
  double step[2] = {value(r, 44), value(r, 45)};
  const struct dea_affine turn = {c, s, -s, c, value(r, 10), value(r, 20)};
  struct dea_affine scale = {value_or(r, 41, 1), 0, 0, value_or(r, 42, 1), 0, 0};
  const double corner[2] = {-scale.a * block->base[0], -scale.d * block->base[1]};
  const struct dea_affine placed = dea_affine_times(&plane, &turn);
  long count[2] = {whole(r, 70, 1), whole(r, 71, 1)};
  size_t layer = r->layer;
  dea_status status = DEA_OK;
  r->layer = r->entity.layer;
  r->depth++;
  for (long j = 0; (j == 0 || j < count[1]) && status == DEA_OK; j++) {
    for (long i = 0; (i == 0 || i < count[0]) && status == DEA_OK; i++) {
      scale.e = corner[0] + (double)i * step[0];
      scale.f = corner[1] + (double)j * step[1];
      r->matrix = dea_affine_times(&placed, &scale);
      r->again++;
      status = read_block(r, block);
    }
  }
  r->depth--;
  r->layer = layer;
  r->matrix = outside;
  return status;
}

/* In the section of blocks: where they begin and end. */
static dea_status note_block(struct reader *r)
{
  const struct entity *e = &r->entity;
  if (strcmp(e->type, "BLOCK") == 0 && e->name != NULL) {
    const struct block block = {
        e->name, {value(r, 10), value(r, 20)}, {r->pair, r->pair, r->place.line - 2, ""}};
    r->in_block = true;
    DEA_TRY(r->ctx, add_to(r, &r->blocks, &block, sizeof block));
  }
  if (r->in_block && strcmp(r->place.text, "ENDBLK") == 0) {
    struct block *all = r->blocks.data;
    all[r->blocks.count - 1].from.stop = r->pair;
    r->in_block = false;
  }
  return DEA_OK;
}

/* ---- the file ---- */

static const struct kind kinds[] = {
    {"LINE", add_line, true},
    {"ARC", add_arc, false},
    {"CIRCLE", add_arc, false},
    {"ELLIPSE", add_ellipse, true},
    {"SPLINE", add_spline, true},
    {"LWPOLYLINE", add_lwpolyline, false},
    {"POLYLINE", begin_polyline, false},
    {"VERTEX", add_vertex, false},
    {"SEQEND", end_polyline, false},
    {"INSERT", add_insert, false},
    {"BLOCK", NULL, false},
    {"SECTION", NULL, false},
    {"ENDSEC", NULL, false},
    {"EOF", NULL, false},
    {"VIEWPORT", NULL, false},
    {"ATTRIB", NULL, false},
};

/* The entity that was read is complete. */
static dea_status end_entity(struct reader *r)
{
  const struct entity *e = &r->entity;
  static const struct dea_affine mirror = {-1, 0, 0, 1, 0, 0};
  double normal = value_or(r, 230, 1);
  if (r->section == BLOCKS) {
    return note_block(r);
  }
  if (r->section != ENTITIES || e->hidden || e->type[0] == '\0' ||
      (e->kind != NULL && e->kind->add == NULL)) {
    return DEA_OK;
  }
  if (e->kind == NULL || (!e->kind->world && fabs(fabs(normal) - 1) > flat)) {
    return skip(r, e->kind == NULL ? "" : not_flat);
  }
  r->drawing->matrix =
      e->kind->world || normal > 0 ? r->matrix : dea_affine_times(&r->matrix, &mirror);
  r->drawing->line = e->line;
  return e->kind->add(r);
}

static dea_status begin_entity(struct reader *r)
{
  const char *type = r->place.text;
  if (r->in_polyline && strcmp(type, "VERTEX") != 0 && strcmp(type, "SEQEND") != 0) {
    DEA_TRY(r->ctx, end_polyline(r)); // a file that forgot its SEQEND
  }
  r->values.count = 0;
  r->entity = (struct entity){.layer = r->layer, .line = r->place.line};
  snprintf(r->entity.type, sizeof r->entity.type, "%.31s", type);
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds && r->entity.kind == NULL; i++) {
    r->entity.kind = strcmp(kinds[i].name, type) == 0 ? &kinds[i] : NULL;
  }
  return DEA_OK;
}

/* One more value of the entity. */
static dea_status read_value(struct reader *r, long code)
{
  static const short codes[] = {10, 20, 30, 11, 21, 31, 40, 41, 42, 44, 45, 50, 51, 70, 71, 230};
  struct entity *e = &r->entity;
  char *text = r->place.text;
  struct value next = {.code = code};
  bool known = false;
  if (code == 8 && r->section == ENTITIES) {
    dea_dxf_text_decode(&r->letters, text);
    DEA_TRY(r->ctx, dea_drawing_layer(r->drawing, text, &e->layer));
    e->layer = e->layer == r->zero ? r->layer : e->layer;
    return DEA_OK;
  }
  if (code == 2 && e->kind != NULL) {
    dea_dxf_text_decode(&r->letters, text);
    e->name = dea_intern(r->ctx, text);
    return e->name != NULL ? DEA_OK : DEA_E_MEMORY;
  }
  if (code == 60 || code == 67) {
    e->hidden |= strcmp(text, "0") != 0;
    return DEA_OK;
  }
  for (size_t i = 0; i < sizeof codes / sizeof *codes; i++) {
    known = known || codes[i] == code;
  }
  if (!known || e->kind == NULL || (r->section == BLOCKS && strcmp(e->type, "BLOCK") != 0)) {
    return DEA_OK;
  }
  if (r->values.count > 8 * r->drawing->settings.vertices_max) {
    return dea_drawing_fault(r->drawing, r->place.line,
                             "the drawing has more than %zu vertices, which is too many",
                             r->drawing->settings.vertices_max);
  }
  DEA_TRY(r->ctx, number(r, &next.number));
  return add_to(r, &r->values, &next, sizeof next);
}

static dea_status read_header(struct reader *r, long code)
{
  const char *text = r->place.text;
  if (code == 9) {
    snprintf(r->variable, sizeof r->variable, "%.23s", text);
  } else if (code == 70 && strcmp(r->variable, "$INSUNITS") == 0) {
    double value = 0;
    DEA_TRY(r->ctx, number(r, &value));
    double unit = fabs(value) < 100 ? unit_of((long)value) : 0;
    if (value != 0 && unit == 0) {
      return dea_drawing_fault(r->drawing, r->place.line, "$INSUNITS %g is no unit for a drawing",
                               value);
    }
    if (unit > 0) {
      r->drawing->unit_m = unit;
      r->drawing->unit_is_known = true;
    }
  } else if (code == 3 && strcmp(r->variable, "$DWGCODEPAGE") == 0) {
    dea_dxf_text_set_page(&r->letters, text);
  } else if (code == 1 && strcmp(r->variable, "$ACADVER") == 0) {
    r->letters.utf8 = strcmp(text, "AC1021") >= 0;
  }
  return DEA_OK;
}

static enum section section_of(const char *name)
{
  return strcmp(name, "HEADER") == 0     ? HEADER
         : strcmp(name, "BLOCKS") == 0   ? BLOCKS
         : strcmp(name, "ENTITIES") == 0 ? ENTITIES
                                         : OTHER_SECTION;
}

static dea_status parse_pair(struct reader *r, long code)
{
  if (code == 0) {
    DEA_TRY(r->ctx, end_entity(r));
    DEA_TRY(r->ctx, begin_entity(r));
    if (r->depth == 0 && strcmp(r->entity.type, "SECTION") == 0) {
      r->named = false;
    } else if (r->depth == 0 && strcmp(r->entity.type, "ENDSEC") == 0) {
      r->section = NO_SECTION;
      r->in_block = false;
    }
    return DEA_OK;
  }
  if (code == 2 && r->depth == 0 && strcmp(r->entity.type, "SECTION") == 0 && !r->named) {
    double unit = r->drawing->unit_m;
    r->named = true;
    r->section = section_of(r->place.text);
    r->matrix = (struct dea_affine){unit, 0, 0, unit, 0, 0};
    return DEA_OK;
  }
  return r->section == HEADER                             ? read_header(r, code)
         : r->section == ENTITIES || r->section == BLOCKS ? read_value(r, code)
                                                          : DEA_OK;
}

static dea_status read_all(struct reader *r)
{
  long code = 0;
  bool more = true, any = false;
  for (size_t n = 0; more; n++) {
    DEA_TRY(r->ctx, read_pair(r, &code, &more));
    if (more) {
      DEA_TRY(r->ctx, parse_pair(r, code));
      any |= r->section == ENTITIES;
    }
    if ((n & 65535) == 65535 && dea_interrupted(r->ctx)) {
      return dea_fail(r->ctx, DEA_E_INTERRUPTED, "interrupted while a drawing was read");
    }
    if (strcmp(r->entity.type, "EOF") == 0) {
      break;
    }
  }
  if (strcmp(r->entity.type, "EOF") != 0) {
    return dea_drawing_fault(r->drawing, r->place.line, "the DXF file ends early: it has no EOF");
  }
  if (!any) {
    return dea_drawing_fault(r->drawing, r->place.line, "the DXF file has no section of entities");
  }
  return DEA_OK;
}

static dea_status add_notes(const struct reader *r)
{
  if (r->letters.page_guessed) {
    DEA_TRY(r->ctx,
            dea_finding_add(r->ctx, DEA_NOTE, (struct dea_location){r->drawing->file, 0, 0},
                            "names of layers are no UTF-8, and the file does not say their "
                            "codepage ($DWGCODEPAGE): they are read as ANSI_1252 (DXF of 2007 and "
                            "later is UTF-8)"));
  }
  return dea_drawing_add_notes(r->drawing, "the file does not say its unit ($INSUNITS); mm is "
                                           "assumed (the key unit of a shape says it)");
}

dea_status dea_drawing_read_dxf(struct dea_context *ctx, const char *file, const char *bytes,
                                size_t length, const struct dea_drawing_settings *settings,
                                struct dea_drawing **out)
{
  static const char binary[] = "AutoCAD Binary DXF", mark[] = "\xef\xbb\xbf";
  struct reader r = {.ctx = ctx, .place = {.next = bytes, .stop = bytes + length}};
  DEA_TRY(ctx, dea_drawing_create(ctx, file, settings, out));
  struct dea_drawing *d = *out;
  r.drawing = d;
  d->unit_m = d->settings.unit_m > 0 ? d->settings.unit_m : 1e-3;
  d->any_case = true;
  if (length >= 3 && memcmp(bytes, mark, 3) == 0) {
    r.place.next += 3;
    r.letters.utf8 = true;
  }
  dea_status status = dea_drawing_layer(d, "0", &r.zero);
  r.layer = r.zero;
  if (status == DEA_OK && length >= sizeof binary - 1 &&
      memcmp(bytes, binary, sizeof binary - 1) == 0) {
    status = dea_drawing_fault(d, 0, "binary DXF files are not read; save it as ASCII");
  }
  status = status == DEA_OK ? read_all(&r) : status;
  status = status == DEA_OK ? add_notes(&r) : status;
  dea_dxf_text_free(&r.letters);
  dea_free(ctx, r.values.data);
  dea_free(ctx, r.points.data);
  dea_free(ctx, r.numbers.data);
  dea_free(ctx, r.blocks.data);
  if (status != DEA_OK) {
    dea_drawing_destroy(d);
    *out = NULL;
  }
  return status;
}
