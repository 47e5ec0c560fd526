/* DXF files (ASCII, R12 and later) as drawings: LINE, ARC, CIRCLE, LWPOLYLINE and POLYLINE in the
 * plane of the model space. A file is pairs of lines: a code, and what it stands for. */
#include "base/text.h"
#include "geometry/drawing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum { TEXT_SIZE = 256 };

enum section { NO_SECTION, HEADER, ENTITIES, OTHER_SECTION };

/* What of an entity is kept until it ends. */
struct entity {
  char type[32];
  size_t layer, line; // line: where it starts
  double x[2], y[2];  // codes 10, 20 and 11, 21
  double radius, start, end;
  double normal_z, z;
  long flags;
  bool paper;
  double vertex_x, vertex_y, bulge; // of an LWPOLYLINE's vertex that is being read
  bool has_vertex;
};

struct reader {
  struct dea_context *ctx;
  struct dea_drawing *drawing;
  const char *next, *stop;
  size_t line;
  char text[TEXT_SIZE]; // of the pair that was read
  enum section section;
  bool named;       // the section's name is read
  bool of_unit;     // the header's variable is $INSUNITS
  bool in_polyline; // between POLYLINE and SEQEND
  struct entity entity, polyline;
  size_t zero; // layer "0"
};

/* Metres of the values of $INSUNITS, 0 for those that are no length here. */
static double unit_of(long code)
{
  static const double unit[] = {0,       25.4e-3, 0.3048, 0,     1e-3, 1e-2, 1,  0,
                                25.4e-9, 25.4e-6, 0.9144, 1e-10, 1e-9, 1e-6, 0.1};
  return code > 0 && code < (long)(sizeof unit / sizeof *unit) ? unit[code] : 0;
}

/* One line without white space around it; false at the end of the file. */
static bool read_line(struct reader *r, const char **from, size_t *length)
{
  if (r->next >= r->stop) {
    return false;
  }
  const char *end = memchr(r->next, '\n', (size_t)(r->stop - r->next));
  end = end != NULL ? end : r->stop;
  const char *first = r->next, *last = end;
  while (first < last && (*first == ' ' || *first == '\t')) {
    first++;
  }
  while (last > first && (last[-1] == ' ' || last[-1] == '\t' || last[-1] == '\r')) {
    last--;
  }
  *from = first;
  *length = (size_t)(last - first);
  r->next = end < r->stop ? end + 1 : r->stop;
  r->line++;
  return true;
}

/* The next pair; false at the end. */
static dea_status read_pair(struct reader *r, long *code, bool *more)
{
  const char *from;
  size_t length;
  *more = read_line(r, &from, &length);
  if (!*more) {
    return DEA_OK;
  }
  if (length == 0 && r->next >= r->stop) {
    *more = false;
    return DEA_OK;
  }
  char *end;
  char digits[16] = "";
  memcpy(digits, from, length < sizeof digits ? length : 0);
  *code = strtol(digits, &end, 10);
  if (end == digits || *end != '\0' || !read_line(r, &from, &length)) {
    return dea_drawing_fault(r->drawing, r->line,
                             "a whole number is due here: this is no DXF file, or a damaged one");
  }
  length = length < TEXT_SIZE ? length : TEXT_SIZE - 1;
  memcpy(r->text, from, length);
  r->text[length] = '\0';
  return DEA_OK;
}

static dea_status number(struct reader *r, double *out)
{
  const char *end;
  *out = dea_text_to_double(r->text, &end);
  if (end == r->text || *end != '\0' || !isfinite(*out)) {
    return dea_drawing_fault(r->drawing, r->line, "'%.40s' is no number", r->text);
  }
  return DEA_OK;
}

/* x of an entity's plane; seen from below it is mirrored. */
static double side(const struct entity *e)
{
  return e->normal_z < 0 ? -1 : 1;
}

static dea_status add_vertex(struct reader *r, const struct entity *e, double x, double y,
                             double bulge)
{
  double unit = r->drawing->unit_m;
  return dea_drawing_add_vertex(r->drawing, side(e) * x * unit, y * unit, side(e) * bulge, e->line);
}

/* An arc [degree], in parts of half a turn at most. */
static dea_status add_arc(struct reader *r, const struct entity *e)
{
  double sweep = fmod(e->end - e->start, 360);
  sweep = sweep <= 0 ? sweep + 360 : sweep;
  int parts = sweep > 180 ? 2 : 1;
  for (int k = 0; k <= parts; k++) {
    double angle = (e->start + k * sweep / parts) * pi / 180;
    double bulge = k < parts ? tan(0.25 * sweep / parts * pi / 180) : 0;
    DEA_TRY(r->ctx, add_vertex(r, e, e->x[0] + e->radius * cos(angle),
                               e->y[0] + e->radius * sin(angle), bulge));
  }
  return dea_drawing_end_path(r->drawing, e->layer, false);
}

static dea_status end_lw_vertex(struct reader *r)
{
  struct entity *e = &r->entity;
  if (e->has_vertex) {
    DEA_TRY(r->ctx, add_vertex(r, e, e->vertex_x, e->vertex_y, e->bulge));
  }
  e->bulge = 0;
  e->has_vertex = true;
  return DEA_OK;
}

static bool is(const struct entity *e, const char *type)
{
  return strcmp(e->type, type) == 0;
}

/* What belongs to others, or cannot be cut: no words about it. */
static bool is_silent(const struct entity *e)
{
  return e->type[0] == '\0' || is(e, "ENDSEC") || is(e, "SECTION") || is(e, "EOF") ||
         is(e, "VIEWPORT") || is(e, "SEQEND") || is(e, "VERTEX") || is(e, "ATTRIB");
}

static dea_status end_polyline(struct reader *r, const struct entity *e)
{
  return dea_drawing_end_path(r->drawing, e->layer, (e->flags & 1) != 0);
}

/* The entity that was read is complete. */
static dea_status end_entity(struct reader *r)
{
  struct entity *e = &r->entity;
  if (r->section != ENTITIES || e->paper) {
    r->drawing->vertex_count -= dea_drawing_open_vertices(r->drawing);
    return DEA_OK;
  }
  bool flat = fabs(fabs(e->normal_z) - 1) < 1e-9;
  if (is(e, "VERTEX") && r->in_polyline) {
    return (e->flags & 16) == 0 // a frame point of a spline is none of the line
               ? add_vertex(r, &r->polyline, e->x[0], e->y[0], e->bulge)
               : DEA_OK;
  }
  if (is(e, "SEQEND") && r->in_polyline) {
    r->in_polyline = false;
    return end_polyline(r, &r->polyline);
  }
  if (is(e, "POLYLINE") && flat && (e->flags & (8 | 16 | 64)) == 0) {
    r->polyline = *e;
    r->in_polyline = true;
    return DEA_OK;
  }
  if (is(e, "LINE")) { // its ends are in the world's axes, whatever its normal
    const struct entity line = {.normal_z = 1, .line = e->line};
    DEA_TRY(r->ctx, add_vertex(r, &line, e->x[0], e->y[0], 0));
    DEA_TRY(r->ctx, add_vertex(r, &line, e->x[1], e->y[1], 0));
    return dea_drawing_end_path(r->drawing, e->layer, false);
  }
  if (is(e, "LWPOLYLINE") && flat) {
    DEA_TRY(r->ctx, end_lw_vertex(r));
    return end_polyline(r, e);
  }
  bool round = (is(e, "CIRCLE") || is(e, "ARC")) && flat;
  if (round && e->radius <= 0) {
    return dea_drawing_fault(r->drawing, e->line, "the radius of this %s is not above 0", e->type);
  }
  if (round && is(e, "ARC")) {
    return add_arc(r, e);
  }
  if (round) {
    DEA_TRY(r->ctx, add_vertex(r, e, e->x[0] + e->radius, e->y[0], 1));
    DEA_TRY(r->ctx, add_vertex(r, e, e->x[0] - e->radius, e->y[0], 1));
    return dea_drawing_end_path(r->drawing, e->layer, true);
  }
  r->drawing->vertex_count -= dea_drawing_open_vertices(r->drawing);
  return is_silent(e) ? DEA_OK : dea_drawing_skip(r->drawing, e->layer, e->type, e->line);
}

static dea_status begin_entity(struct reader *r)
{
  if (r->in_polyline && strcmp(r->text, "VERTEX") != 0 && strcmp(r->text, "SEQEND") != 0) {
    r->in_polyline = false; // a file that forgot its SEQEND
    DEA_TRY(r->ctx, end_polyline(r, &r->polyline));
  }
  r->entity = (struct entity){.layer = r->zero, .line = r->line, .normal_z = 1};
  snprintf(r->entity.type, sizeof r->entity.type, "%.31s", r->text);
  return DEA_OK;
}

/* One more value of the entity. */
static dea_status read_value(struct reader *r, long code)
{
  struct entity *e = &r->entity;
  bool lw = is(e, "LWPOLYLINE");
  double value = 0;
  switch (code) {
  case 8:
    return dea_drawing_layer(r->drawing, r->text, &e->layer);
  case 10:
    if (lw) {
      DEA_TRY(r->ctx, end_lw_vertex(r));
    }
    return number(r, lw ? &e->vertex_x : &e->x[0]);
  case 20:
    return number(r, lw ? &e->vertex_y : &e->y[0]);
  case 11:
    return number(r, &e->x[1]);
  case 21:
    return number(r, &e->y[1]);
  case 40:
    return number(r, &e->radius);
  case 42:
    return number(r, &e->bulge);
  case 50:
    return number(r, &e->start);
  case 51:
    return number(r, &e->end);
  case 67:
    e->paper = strcmp(r->text, "0") != 0;
    return DEA_OK;
  case 70:
    DEA_TRY(r->ctx, number(r, &value));
    e->flags = fabs(value) < 65536 ? (long)value : 0;
    return DEA_OK;
  case 230:
    return number(r, &e->normal_z);
  default:
    return DEA_OK;
  }
}

static dea_status read_header(struct reader *r, long code)
{
  if (code == 9) {
    r->of_unit = strcmp(r->text, "$INSUNITS") == 0;
  } else if (code == 70 && r->of_unit) {
    double value = 0;
    DEA_TRY(r->ctx, number(r, &value));
    double unit = fabs(value) < 100 ? unit_of((long)value) : 0;
    if (value != 0 && unit == 0) {
      return dea_drawing_fault(r->drawing, r->line, "$INSUNITS %g is no unit for a drawing", value);
    }
    if (unit > 0) {
      r->drawing->unit_m = unit;
      r->drawing->unit_is_known = true;
    }
  }
  return DEA_OK;
}

static dea_status take_pair(struct reader *r, long code)
{
  if (code == 0) {
    DEA_TRY(r->ctx, end_entity(r));
    DEA_TRY(r->ctx, begin_entity(r));
    if (is(&r->entity, "SECTION")) {
      r->named = false;
    } else if (is(&r->entity, "ENDSEC")) {
      r->section = NO_SECTION;
    }
    return DEA_OK;
  }
  if (code == 2 && is(&r->entity, "SECTION") && !r->named) {
    r->named = true;
    r->section = strcmp(r->text, "HEADER") == 0     ? HEADER
                 : strcmp(r->text, "ENTITIES") == 0 ? ENTITIES
                                                    : OTHER_SECTION;
    return DEA_OK;
  }
  return r->section == HEADER     ? read_header(r, code)
         : r->section == ENTITIES ? read_value(r, code)
                                  : DEA_OK;
}

static dea_status read_all(struct reader *r)
{
  long code;
  bool more = true, any = false;
  for (size_t n = 0; more; n++) {
    DEA_TRY(r->ctx, read_pair(r, &code, &more));
    if (more) {
      DEA_TRY(r->ctx, take_pair(r, code));
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
    return dea_drawing_fault(r->drawing, r->line, "the DXF file ends early: it has no EOF");
  }
  if (!any) {
    return dea_drawing_fault(r->drawing, r->line, "the DXF file has no section of entities");
  }
  return DEA_OK;
}

dea_status dea_drawing_read_dxf(struct dea_context *ctx, const char *file, const char *bytes,
                                size_t length, const struct dea_drawing_settings *settings,
                                struct dea_drawing **out)
{
  static const char binary[] = "AutoCAD Binary DXF";
  struct reader r = {.ctx = ctx, .next = bytes, .stop = bytes + length};
  DEA_TRY(ctx, dea_drawing_create(ctx, file, settings, out));
  struct dea_drawing *d = *out;
  r.drawing = d;
  d->unit_m = 1e-3;
  dea_status status = dea_drawing_layer(d, "0", &r.zero);
  if (status == DEA_OK && length >= sizeof binary - 1 &&
      memcmp(bytes, binary, sizeof binary - 1) == 0) {
    status = dea_drawing_fault(d, 0, "binary DXF files are not read; save it as ASCII");
  }
  status = status == DEA_OK ? read_all(&r) : status;
  if (status == DEA_OK && !d->unit_is_known) {
    status = dea_finding_add(ctx, DEA_NOTE, (struct dea_location){d->file, 0, 0},
                             "the file does not say its unit ($INSUNITS); mm is assumed");
  }
  if (status != DEA_OK) {
    dea_drawing_destroy(d);
    *out = NULL;
  }
  return status;
}
