/* SVG files as drawings: path, circle, ellipse, rect, polygon, polyline and line, with the
 * transforms of their groups. A group with a label (Inkscape's layers have one) or an id is a
 * layer. What an SVG file calls y goes down; here it goes up. */
#include "base/text.h"
#include "geometry/drawing.h"

#include <expat.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum { DEPTH_MAX = 200, CHUNK = 1 << 20, SEGMENTS_MAX = 20000 };

/* x -> a x + c y + e, y -> b x + d y + f. */
struct matrix {
  double a, b, c, d, e, f;
};

struct frame {
  struct matrix matrix; // to metres
  size_t layer;
};

struct reader {
  struct dea_context *ctx;
  struct dea_drawing *drawing;
  XML_Parser parser;
  dea_status status;
  struct frame frame[DEPTH_MAX];
  size_t depth;
  size_t hidden; // depth of elements within one that is not drawn, 0: none
  size_t curves; // that became lines
};

static struct frame *top(struct reader *r)
{
  return &r->frame[r->depth - 1];
}

static size_t line_of(const struct reader *r)
{
  return XML_GetCurrentLineNumber(r->parser);
}

/* ---- numbers ---- */

static bool is_digit(char c)
{
  return c >= '0' && c <= '9';
}

static void skip_space(const char **text)
{
  while (**text == ' ' || **text == '\t' || **text == '\n' || **text == '\r' || **text == ',') {
    ++*text;
  }
}

/* A number as XML writes it, after space and commas. */
static bool read_number(const char **text, double *out)
{
  char digits[64];
  size_t n = 0, whole = 0;
  skip_space(text);
  const char *c = *text;
  const char *start = c;
  c += *c == '-' || *c == '+';
  for (; is_digit(*c); c++, whole++) {
  }
  if (*c == '.') {
    for (c++; is_digit(*c); c++, whole++) {
    }
  }
  if (whole == 0) {
    return false;
  }
  if (*c == 'e' || *c == 'E') {
    const char *exponent = c + 1 + (c[1] == '-' || c[1] == '+');
    for (; is_digit(*exponent); exponent++) {
      c = exponent + 1;
    }
  }
  n = (size_t)(c - start);
  if (n >= sizeof digits) {
    n = sizeof digits - 1; // digits beyond any that count
  }
  memcpy(digits, start, n);
  digits[n] = '\0';
  const char *end;
  *out = dea_text_to_double(digits, &end);
  *text = c;
  return true;
}

/* A length with its unit in metres; NAN when it has none of its own (%, em, nothing, px). *value:
 * the number. */
static double read_length(const char *text, double *value)
{
  static const struct {
    const char *name;
    double metres;
  } units[] = {
      {"mm", 1e-3}, {"cm", 1e-2}, {"in", 25.4e-3}, {"pt", 25.4e-3 / 72}, {"pc", 25.4e-3 / 6}};
  *value = NAN;
  if (text == NULL || !read_number(&text, value)) {
    return NAN;
  }
  for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
    if (strncmp(text, units[i].name, 2) == 0) {
      return *value * units[i].metres;
    }
  }
  *value = *text == '\0' || strncmp(text, "px", 2) == 0 ? *value : NAN;
  return NAN;
}

static const char *attribute(const char **attributes, const char *name)
{
  for (; attributes[0] != NULL; attributes += 2) {
    if (strcmp(attributes[0], name) == 0) {
      return attributes[1];
    }
  }
  return NULL;
}

/* A number of an element, 0 when it is not there. */
static double value_of(const char **attributes, const char *name)
{
  const char *text = attribute(attributes, name);
  double value = 0;
  return text != NULL && read_number(&text, &value) ? value : 0;
}

/* ---- transforms ---- */

static struct matrix times(const struct matrix *m, const struct matrix *n)
{
  return (struct matrix){m->a * n->a + m->c * n->b,        m->b * n->a + m->d * n->b,
                         m->a * n->c + m->c * n->d,        m->b * n->c + m->d * n->d,
                         m->a * n->e + m->c * n->f + m->e, m->b * n->e + m->d * n->f + m->f};
}

static double determinant(const struct matrix *m)
{
  return m->a * m->d - m->b * m->c;
}

/* Whether circles stay circles. */
static bool is_similar(const struct matrix *m)
{
  double one = m->a * m->a + m->b * m->b, two = m->c * m->c + m->d * m->d;
  return fabs(one - two) <= 1e-9 * one && fabs(m->a * m->c + m->b * m->d) <= 1e-9 * one;
}

/* At most so much longer do lengths become. */
static double stretch(const struct matrix *m)
{
  return sqrt(m->a * m->a + m->b * m->b + m->c * m->c + m->d * m->d);
}

static bool transform_of(const char *name, const double *v, int count, struct matrix *out)
{
  double angle = count > 0 ? v[0] * pi / 180 : 0, c = cos(angle), s = sin(angle);
  if (strcmp(name, "matrix") == 0 && count == 6) {
    *out = (struct matrix){v[0], v[1], v[2], v[3], v[4], v[5]};
  } else if (strcmp(name, "translate") == 0 && (count == 1 || count == 2)) {
    *out = (struct matrix){1, 0, 0, 1, v[0], count == 2 ? v[1] : 0};
  } else if (strcmp(name, "scale") == 0 && (count == 1 || count == 2)) {
    *out = (struct matrix){v[0], 0, 0, count == 2 ? v[1] : v[0], 0, 0};
  } else if (strcmp(name, "rotate") == 0 && (count == 1 || count == 3)) {
    double x = count == 3 ? v[1] : 0, y = count == 3 ? v[2] : 0;
    *out = (struct matrix){c, s, -s, c, x - c * x + s * y, y - s * x - c * y};
  } else if (strcmp(name, "skewX") == 0 && count == 1) {
    *out = (struct matrix){1, 0, tan(angle), 1, 0, 0};
  } else if (strcmp(name, "skewY") == 0 && count == 1) {
    *out = (struct matrix){1, tan(angle), 0, 1, 0, 0};
  } else {
    return false;
  }
  return true;
}

static dea_status apply_transforms(struct reader *r, const char *text)
{
  while (text != NULL) {
    char name[16];
    double v[6] = {0};
    int count = 0;
    size_t n;
    skip_space(&text);
    if (*text == '\0') {
      break;
    }
    n = strcspn(text, " \t\r\n(");
    snprintf(name, sizeof name, "%.*s", (int)(n < sizeof name ? n : sizeof name - 1), text);
    text += n;
    skip_space(&text);
    bool good = *text == '(';
    text += good;
    while (good && count < 6 && read_number(&text, &v[count])) {
      count++;
    }
    skip_space(&text);
    struct matrix next;
    if (!good || *text != ')' || !transform_of(name, v, count, &next)) {
      return dea_drawing_fault(r->drawing, line_of(r), "the transform '%s' is not understood",
                               name);
    }
    text++;
    top(r)->matrix = times(&top(r)->matrix, &next);
  }
  return DEA_OK;
}

/* ---- lines, arcs and curves ---- */

static dea_status add_vertex(struct reader *r, double x, double y, double bulge)
{
  const struct matrix *m = &top(r)->matrix;
  return dea_drawing_add_vertex(r->drawing, m->a * x + m->c * y + m->e, m->b * x + m->d * y + m->f,
                                determinant(m) < 0 ? -bulge : bulge, line_of(r));
}

static dea_status end_path(struct reader *r, bool closed)
{
  return dea_drawing_end_path(r->drawing, top(r)->layer, closed);
}

/* Bulge of the vertex that was added last. */
static void set_bulge(struct reader *r, double bulge)
{
  struct dea_vertex *last = &r->drawing->vertex[r->drawing->vertex_count - 1];
  last->bulge = determinant(&top(r)->matrix) < 0 ? -bulge : bulge;
}

/* From the last vertex along an ellipse of axes `radius`, turned by an angle, from one parameter
 * over `sweep`; exact where it becomes a circle. end: its last point. */
static dea_status add_arc(struct reader *r, const double centre[2], const double radius[2],
                          double turn, double from, double sweep, const double end[2])
{
  const struct matrix *m = &top(r)->matrix;
  bool exact = radius[0] == radius[1] && is_similar(m);
  double reach = fmax(radius[0], radius[1]) * stretch(m);
  double step = 2 * acos(fmax(0.5, 1 - r->drawing->settings.flatten_m / reach));
  int parts =
      exact ? (fabs(sweep) > pi ? 2 : 1) : (int)fmin(SEGMENTS_MAX, 1 + ceil(fabs(sweep) / step));
  r->curves += !exact;
  for (int k = 1; k <= parts; k++) {
    double angle = from + k * sweep / parts;
    double x = radius[0] * cos(angle), y = radius[1] * sin(angle);
    set_bulge(r, exact ? tan(0.25 * sweep / parts) : 0);
    bool last = k == parts;
    DEA_TRY(r->ctx, add_vertex(r, last ? end[0] : centre[0] + cos(turn) * x - sin(turn) * y,
                               last ? end[1] : centre[1] + sin(turn) * x + cos(turn) * y, 0));
  }
  return DEA_OK;
}

/* The arc of a path from p to q, by the formulas of SVG 1.1, appendix F.6. */
static dea_status add_path_arc(struct reader *r, const double p[2], const double v[5],
                               const double q[2])
{
  double radius[2] = {fabs(v[0]), fabs(v[1])}, turn = v[2] * pi / 180;
  if (radius[0] == 0 || radius[1] == 0 || (p[0] == q[0] && p[1] == q[1])) {
    return add_vertex(r, q[0], q[1], 0);
  }
  double c = cos(turn), s = sin(turn);
  double dx = 0.5 * (p[0] - q[0]), dy = 0.5 * (p[1] - q[1]);
  double x = c * dx + s * dy, y = -s * dx + c * dy;
  double size = x * x / (radius[0] * radius[0]) + y * y / (radius[1] * radius[1]);
  for (int k = 0; k < 2 && size > 1; k++) {
    radius[k] *= sqrt(size); // too small to reach: scaled up
  }
  double factor = size < 1 ? sqrt((1 - size) / size) : 0;
  factor *= (v[3] != 0) != (v[4] != 0) ? 1 : -1;
  double u = factor * radius[0] * y / radius[1], w = -factor * radius[1] * x / radius[0];
  const double centre[2] = {c * u - s * w + 0.5 * (p[0] + q[0]),
                            s * u + c * w + 0.5 * (p[1] + q[1])};
  double from = atan2((y - w) / radius[1], (x - u) / radius[0]);
  double sweep = atan2((-y - w) / radius[1], (-x - u) / radius[0]) - from;
  if (v[4] != 0 && sweep < 0) {
    sweep += 2 * pi;
  } else if (v[4] == 0 && sweep > 0) {
    sweep -= 2 * pi;
  }
  return add_arc(r, centre, radius, turn, from, sweep, q);
}

/* A cubic Bezier curve: chords of equal steps; their distance is a 1/8 of the second derivative. */
static dea_status add_cubic(struct reader *r, double p[4][2])
{
  double bend = 0;
  for (int k = 0; k < 2; k++) {
    bend = fmax(bend, hypot(p[k][0] - 2 * p[k + 1][0] + p[k + 2][0],
                            p[k][1] - 2 * p[k + 1][1] + p[k + 2][1]));
  }
  double n = ceil(sqrt(6 * bend * stretch(&top(r)->matrix) / (8 * r->drawing->settings.flatten_m)));
  n = fmax(1, fmin(n, SEGMENTS_MAX));
  r->curves++;
  for (double k = 1; k <= n; k++) {
    double t = k / n, s = 1 - t;
    double w[4] = {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t}, x[2] = {0, 0};
    for (int i = 0; i < 4; i++) {
      x[0] += w[i] * p[i][0];
      x[1] += w[i] * p[i][1];
    }
    DEA_TRY(r->ctx, add_vertex(r, x[0], x[1], 0));
  }
  return DEA_OK;
}

/* ---- paths ---- */

struct pen {
  struct reader *r;
  double at[2], start[2], control[2]; // control: of the last curve, for a smooth one
  char command, last;
  bool open;
};

static dea_status bad_path(const struct pen *pen, const char *text)
{
  return dea_drawing_fault(pen->r->drawing, line_of(pen->r),
                           "the path is not understood at '%.20s'", text);
}

/* Numbers of a command; of an arc's, two are flags of one digit. */
static bool read_values(const char **text, int count, bool arc, double *v)
{
  for (int k = 0; k < count; k++) {
    if (arc && (k == 3 || k == 4)) {
      skip_space(text);
      if (**text != '0' && **text != '1') {
        return false;
      }
      v[k] = *(*text)++ - '0';
    } else if (!read_number(text, &v[k])) {
      return false;
    }
  }
  return true;
}

static dea_status start_if_needed(struct pen *pen)
{
  if (pen->open) {
    return DEA_OK;
  }
  pen->open = true;
  return add_vertex(pen->r, pen->at[0], pen->at[1], 0);
}

/* C, S, Q and T as a cubic curve; v: its points in the order of the command, absolute. */
static dea_status draw_curve(struct pen *pen, char kind, const double *v)
{
  bool cubic = kind == 'C' || kind == 'S', smooth = kind == 'S' || kind == 'T';
  bool follows =
      cubic ? pen->last == 'C' || pen->last == 'S' : pen->last == 'Q' || pen->last == 'T';
  double p[4][2], first[2];
  const double *end = v + (kind == 'C' ? 4 : kind == 'T' ? 0 : 2);
  for (int k = 0; k < 2; k++) {
    first[k] = !smooth ? v[k] : follows ? 2 * pen->at[k] - pen->control[k] : pen->at[k];
    p[0][k] = pen->at[k];
    p[3][k] = end[k];
    p[1][k] = cubic ? first[k] : p[0][k] + 2 * (first[k] - p[0][k]) / 3;
    p[2][k] = cubic ? (kind == 'C' ? v[2 + k] : v[k]) : p[3][k] + 2 * (first[k] - p[3][k]) / 3;
    pen->control[k] = cubic ? p[2][k] : first[k];
  }
  DEA_TRY(pen->r->ctx, add_cubic(pen->r, p));
  pen->at[0] = end[0];
  pen->at[1] = end[1];
  return DEA_OK;
}

static dea_status draw(struct pen *pen, char kind, bool relative, double *v, int count)
{
  double origin[2] = {relative ? pen->at[0] : 0, relative ? pen->at[1] : 0};
  if (kind == 'H' || kind == 'V') {
    double x = kind == 'H' ? v[0] + origin[0] : pen->at[0];
    v[1] = kind == 'V' ? v[0] + origin[1] : pen->at[1];
    v[0] = x;
  } else {
    for (int k = kind == 'A' ? 5 : 0; k < count; k++) {
      // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): as many numbers were read
      v[k] += origin[(kind == 'A' ? k - 5 : k) % 2];
    }
  }
  if (kind == 'M') {
    DEA_TRY(pen->r->ctx, end_path(pen->r, false));
    pen->open = false;
    memcpy(pen->at, v, sizeof pen->at);
    memcpy(pen->start, v, sizeof pen->start);
    return DEA_OK;
  }
  DEA_TRY(pen->r->ctx, start_if_needed(pen));
  if (strchr("CSQT", kind) != NULL) {
    return draw_curve(pen, kind, v);
  }
  const double *end = kind == 'A' ? v + 5 : v;
  DEA_TRY(pen->r->ctx, kind == 'A' ? add_path_arc(pen->r, pen->at, v, end)
                                   : add_vertex(pen->r, end[0], end[1], 0));
  memcpy(pen->at, end, sizeof pen->at);
  return DEA_OK;
}

static dea_status read_path(struct reader *r, const char *text)
{
  static const char kinds[] = "MLHVCSQTA";
  static const int counts[] = {2, 2, 1, 1, 6, 4, 4, 2, 7};
  struct pen pen = {.r = r};
  for (skip_space(&text); text != NULL && *text != '\0'; skip_space(&text)) {
    bool letter = (*text >= 'a' && *text <= 'z') || (*text >= 'A' && *text <= 'Z');
    const char *here = text;
    if (letter) {
      pen.command = *text++;
    } else if (pen.command == 'M' || pen.command == 'm') {
      pen.command = pen.command == 'M' ? 'L' : 'l'; // more points after a move are lines
    }
    bool relative = pen.command >= 'a';
    char kind = (char)(relative ? pen.command - 'a' + 'A' : pen.command);
    if (pen.last == '\0' && kind != 'M') {
      return bad_path(&pen, here);
    }
    if (kind == 'Z' && letter) {
      DEA_TRY(r->ctx, end_path(r, true));
      memcpy(pen.at, pen.start, sizeof pen.at);
      pen.open = false;
      pen.last = kind;
      continue;
    }
    double v[7];
    const char *known = kind != '\0' ? strchr(kinds, kind) : NULL;
    if (known == NULL || !read_values(&text, counts[known - kinds], kind == 'A', v)) {
      return bad_path(&pen, here);
    }
    DEA_TRY(r->ctx, draw(&pen, kind, relative, v, counts[known - kinds]));
    pen.last = kind;
  }
  return end_path(r, false);
}

/* ---- elements ---- */

static dea_status read_ellipse(struct reader *r, const char **attributes, bool circle)
{
  const double centre[2] = {value_of(attributes, "cx"), value_of(attributes, "cy")};
  double rx = value_of(attributes, circle ? "r" : "rx");
  const double radius[2] = {rx, circle ? rx : value_of(attributes, "ry")};
  if (radius[0] <= 0 || radius[1] <= 0) {
    return DEA_OK; // not drawn, says SVG
  }
  const double ends[2][2] = {{centre[0] - radius[0], centre[1]},
                             {centre[0] + radius[0], centre[1]}};
  DEA_TRY(r->ctx, add_vertex(r, ends[1][0], ends[1][1], 0));
  DEA_TRY(r->ctx, add_arc(r, centre, radius, 0, 0, pi, ends[0]));
  DEA_TRY(r->ctx, add_arc(r, centre, radius, 0, pi, pi, ends[1]));
  r->drawing->vertex_count--; // the first one again
  return end_path(r, true);
}

static dea_status read_rect(struct reader *r, const char **attributes)
{
  double x = value_of(attributes, "x"), y = value_of(attributes, "y");
  double width = value_of(attributes, "width"), height = value_of(attributes, "height");
  bool has_x = attribute(attributes, "rx") != NULL, has_y = attribute(attributes, "ry") != NULL;
  double rx = value_of(attributes, has_x ? "rx" : "ry"),
         ry = value_of(attributes, has_y ? "ry" : "rx");
  if (width <= 0 || height <= 0) {
    return DEA_OK;
  }
  const double radius[2] = {fmax(0, fmin(rx, 0.5 * width)), fmax(0, fmin(ry, 0.5 * height))};
  bool round = radius[0] > 0 && radius[1] > 0;
  static const int right[4] = {1, 1, 0, 0}, down[4] = {0, 1, 1, 0};
  for (int k = 0; k < 4; k++) { // the corner, from the upper right one on; y goes down
    double cx = x + right[k] * width, cy = y + down[k] * height;
    if (!round) {
      DEA_TRY(r->ctx, add_vertex(r, cx, cy, 0));
      continue;
    }
    const double centre[2] = {cx + (right[k] ? -1 : 1) * radius[0],
                              cy + (down[k] ? -1 : 1) * radius[1]};
    double from = (k - 1) * 0.5 * pi;
    static const int cosine[5] = {0, 1, 0, -1, 0}, sine[5] = {-1, 0, 1, 0, -1};
    DEA_TRY(r->ctx,
            add_vertex(r, centre[0] + radius[0] * cosine[k], centre[1] + radius[1] * sine[k], 0));
    DEA_TRY(r->ctx, add_arc(r, centre, radius, 0, from, 0.5 * pi,
                            (double[2]){centre[0] + radius[0] * cosine[k + 1],
                                        centre[1] + radius[1] * sine[k + 1]}));
  }
  return end_path(r, true);
}

static dea_status read_points(struct reader *r, const char *text, bool closed)
{
  double x, y;
  while (text != NULL && read_number(&text, &x)) {
    if (!read_number(&text, &y)) {
      return dea_drawing_fault(r->drawing, line_of(r), "a point has an x and no y");
    }
    DEA_TRY(r->ctx, add_vertex(r, x, y, 0));
  }
  return end_path(r, closed);
}

static dea_status read_line(struct reader *r, const char **attributes)
{
  DEA_TRY(r->ctx, add_vertex(r, value_of(attributes, "x1"), value_of(attributes, "y1"), 0));
  DEA_TRY(r->ctx, add_vertex(r, value_of(attributes, "x2"), value_of(attributes, "y2"), 0));
  return end_path(r, false);
}

/* The size of a user unit, and y upwards. */
static void read_root(struct reader *r, const char **attributes)
{
  const char *box = attribute(attributes, "viewBox");
  double view[4] = {0, 0, NAN, NAN}, number[2], scale = NAN;
  for (int k = 0; k < 4 && box != NULL; k++) {
    if (!read_number(&box, &view[k])) {
      view[2] = NAN;
      break;
    }
  }
  static const double px = 25.4e-3 / 96;
  static const char *const sides[2] = {"width", "height"};
  for (int k = 0; k < 2; k++) {
    double metres = read_length(attribute(attributes, sides[k]), &number[k]);
    bool known = isfinite(metres);
    double size = known ? metres : number[k] * px;
    double one = view[2 + k] > 0 ? size / view[2 + k] : known ? px : NAN;
    if (isfinite(one) && one > 0 && !(scale <= one)) {
      scale = one; // the smaller one: the whole box is seen
      r->drawing->unit_is_known |= known && view[2 + k] > 0;
    }
  }
  r->drawing->unit_m = isfinite(scale) ? scale : px;
  double unit = r->drawing->unit_m, bottom = isfinite(view[3]) ? view[1] + view[3] : 0;
  top(r)->matrix =
      (struct matrix){unit, 0, 0, -unit, isfinite(view[2]) ? -unit * view[0] : 0, unit * bottom};
}

static bool is_one_of(const char *name, const char *const *names)
{
  while (*names != NULL && strcmp(name, *names) != 0) {
    names++;
  }
  return *names != NULL;
}

static dea_status open_element(struct reader *r, const char *name, const char **attributes)
{
  static const char *const holders[] = {"g", "svg", "a", "switch", NULL};
  static const char *const unseen[] = {
      "defs",   "clipPath", "mask",           "symbol",         "pattern",
      "marker", "metadata", "title",          "desc",           "style",
      "script", "filter",   "linearGradient", "radialGradient", "sodipodi:namedview",
      NULL};
  const char *style = attribute(attributes, "style"), *display = attribute(attributes, "display");
  bool none = (display != NULL && strcmp(display, "none") == 0) ||
              (style != NULL &&
               (strstr(style, "display:none") != NULL || strstr(style, "display: none") != NULL));
  if (none || is_one_of(name, unseen)) {
    r->hidden = 1;
    return DEA_OK;
  }
  if (r->depth == 1 && strcmp(name, "svg") == 0) {
    read_root(r, attributes);
    return DEA_OK;
  }
  if (r->depth == 1) {
    return dea_drawing_fault(r->drawing, line_of(r), "the file is no SVG but '%.40s'", name);
  }
  DEA_TRY(r->ctx, apply_transforms(r, attribute(attributes, "transform")));
  if (strcmp(name, "g") == 0) {
    const char *label = attribute(attributes, "inkscape:label");
    label = label != NULL ? label : attribute(attributes, "id");
    return label != NULL ? dea_drawing_layer(r->drawing, label, &top(r)->layer) : DEA_OK;
  }
  if (strcmp(name, "path") == 0) {
    const char *path = attribute(attributes, "d");
    return path != NULL ? read_path(r, path) : DEA_OK;
  }
  if (strcmp(name, "circle") == 0 || strcmp(name, "ellipse") == 0) {
    return read_ellipse(r, attributes, strcmp(name, "circle") == 0);
  }
  if (strcmp(name, "rect") == 0) {
    return read_rect(r, attributes);
  }
  if (strcmp(name, "polygon") == 0 || strcmp(name, "polyline") == 0) {
    return read_points(r, attribute(attributes, "points"), strcmp(name, "polygon") == 0);
  }
  if (strcmp(name, "line") == 0) {
    return read_line(r, attributes);
  }
  return is_one_of(name, holders) ? DEA_OK
                                  : dea_drawing_skip(r->drawing, top(r)->layer, name, line_of(r));
}

static void XMLCALL start_element(void *user, const char *name, const char **attributes)
{
  struct reader *r = user;
  if (r->status != DEA_OK) {
    return;
  }
  if (r->hidden > 0) {
    r->hidden++;
    return;
  }
  if (r->depth == DEPTH_MAX) {
    r->status = dea_drawing_fault(r->drawing, line_of(r),
                                  "elements lie more than %d deep in others", DEPTH_MAX);
  } else {
    r->frame[r->depth] = r->depth > 0 ? r->frame[r->depth - 1] : (struct frame){.layer = 0};
    r->depth++;
    r->status = open_element(r, name, attributes);
  }
  if (r->status != DEA_OK) {
    XML_StopParser(r->parser, XML_FALSE);
  }
}

static void XMLCALL end_element(void *user, const char *name)
{
  struct reader *r = user;
  (void)name;
  if (r->hidden > 1) {
    r->hidden--;
  } else if (r->status == DEA_OK) {
    r->hidden = 0;
    r->depth--;
  }
}

static dea_status parse(struct reader *r, const char *bytes, size_t length)
{
  size_t done = 0;
  do {
    size_t part = length - done < CHUNK ? length - done : CHUNK;
    bool last = done + part == length;
    enum XML_Status status = XML_Parse(r->parser, bytes + done, (int)part, last);
    DEA_TRY(r->ctx, r->status);
    if (status != XML_STATUS_OK) {
      enum XML_Error error = XML_GetErrorCode(r->parser);
      return error == XML_ERROR_NO_MEMORY
                 ? dea_fail(r->ctx, DEA_E_MEMORY, "out of memory in the XML reader")
                 : dea_drawing_fault(r->drawing, line_of(r), "the file is no sound XML: %s",
                                     XML_ErrorString(error));
    }
    if (dea_interrupted(r->ctx)) {
      return dea_fail(r->ctx, DEA_E_INTERRUPTED, "interrupted while a drawing was read");
    }
    done += part;
  } while (done < length);
  return DEA_OK;
}

static dea_status add_notes(const struct reader *r)
{
  const struct dea_drawing *d = r->drawing;
  const struct dea_location location = {d->file, 0, 0};
  if (!d->unit_is_known) {
    DEA_TRY(r->ctx, dea_finding_add(r->ctx, DEA_NOTE, location,
                                    "the file does not say its size in mm; 96 units to the inch "
                                    "are assumed"));
  }
  if (r->curves > 0) {
    DEA_TRY(r->ctx, dea_finding_add(r->ctx, DEA_NOTE, location,
                                    "%zu curves that are no circular arcs became lines, to within "
                                    "%.3g mm",
                                    r->curves, 1e3 * d->settings.flatten_m));
  }
  return DEA_OK;
}

dea_status dea_drawing_read_svg(struct dea_context *ctx, const char *file, const char *bytes,
                                size_t length, const struct dea_drawing_settings *settings,
                                struct dea_drawing **out)
{
  DEA_TRY(ctx, dea_drawing_create(ctx, file, settings, out));
  struct reader *r = dea_alloc(ctx, 1, sizeof *r);
  size_t zero;
  dea_status status = r != NULL ? dea_drawing_layer(*out, "0", &zero) : DEA_E_MEMORY;
  if (status == DEA_OK) {
    r->ctx = ctx;
    r->drawing = *out;
    r->parser = XML_ParserCreate(NULL);
    status =
        r->parser != NULL ? DEA_OK : dea_fail(ctx, DEA_E_MEMORY, "out of memory in the XML reader");
  }
  if (status == DEA_OK) {
    XML_SetUserData(r->parser, r);
    XML_SetElementHandler(r->parser, start_element, end_element);
    status = parse(r, bytes, length);
    status = status == DEA_OK ? add_notes(r) : status;
    XML_ParserFree(r->parser);
  }
  dea_free(ctx, r);
  if (status != DEA_OK) {
    dea_drawing_destroy(*out);
    *out = NULL;
  }
  return status;
}
