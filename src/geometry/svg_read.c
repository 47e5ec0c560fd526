/* SVG files as drawings: path, circle, ellipse, rect, polygon, polyline and line, with the
 * transforms of their groups. A group with a label (Inkscape's layers have one) or an id is a
 * layer. What an SVG file calls y goes down; here it goes up. */
#include "base/text.h"
#include "geometry/drawing.h"

#include <expat.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double px_m = 25.4e-3 / 96; // of CSS

enum { DEPTH_MAX = 200, CHUNK = 1 << 20 };

struct frame {
  struct dea_affine matrix; // to metres
  size_t layer;
};

struct reader {
  struct dea_context *ctx;
  struct dea_drawing *drawing;
  XML_Parser parser;
  dea_status status;
  struct frame frame[DEPTH_MAX];
  size_t depth;
  size_t hidden;  // depth of elements within one that is not drawn, 0: none
  double px;      // of CSS, in user units
  double view[2]; // width and height that % count from; NAN: not known
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
  skip_space(text);
  const char *digits = *text + (**text == '-' || **text == '+');
  if (!is_digit(digits[*digits == '.'])) {
    return false;
  }
  if (digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X')) { // hexadecimal to C alone
    *out = 0;
    *text = digits + 1;
    return true;
  }
  *out = dea_text_to_double(*text, text);
  return true;
}

/* A length in user units; px: one of CSS, whole: of "100 %", NAN: not known. NAN when it is none.
 */
static double length_of(const char *text, double px, double whole)
{
  const struct {
    const char *name;
    double length;
  } units[] = {{"", 1},
               {"px", 1},
               {"mm", 1e-3 / px_m * px},
               {"cm", 1e-2 / px_m * px},
               {"in", 96 * px},
               {"pt", 96.0 / 72 * px},
               {"pc", 16 * px},
               {"%", whole / 100}};
  double value;
  if (text == NULL || !read_number(&text, &value)) {
    return NAN;
  }
  size_t n = strcspn(text, " \t\r\n");
  for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
    if (strlen(units[i].name) == n && strncmp(text, units[i].name, n) == 0) {
      return value * units[i].length;
    }
  }
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

/* Lengths of an element in its units, 0 for those that are not there; % are of the width for names
 * with an x or of a width, of the height for those with a y, and else of the mean of squares. */
static dea_status read_lengths(struct reader *r, const char **attributes, const char *const *names,
                               size_t count, double *out)
{
  double mean = hypot(r->view[0], r->view[1]) / sqrt(2);
  for (size_t i = 0; i < count; i++) {
    const char *name = names[i], *text = attribute(attributes, name);
    bool across = strchr(name, 'x') != NULL || name[0] == 'w';
    bool down = strchr(name, 'y') != NULL || name[0] == 'h';
    out[i] = text == NULL || strcmp(text, "auto") == 0 ? 0
                                                       : length_of(text, r->px,
                                                                   across ? r->view[0]
                                                                   : down ? r->view[1]
                                                                          : mean);
    if (!isfinite(out[i])) {
      return dea_drawing_fault(r->drawing, line_of(r),
                               "%s '%.20s' is no length that is understood; write it in mm or "
                               "without a unit",
                               name, text);
    }
  }
  return DEA_OK;
}

/* ---- transforms ---- */

static bool transform_of(const char *name, const double *v, int count, struct dea_affine *out)
{
  double angle = count > 0 ? v[0] * DEA_PI / 180 : 0, c = cos(angle), s = sin(angle);
  if (strcmp(name, "matrix") == 0 && count == 6) {
    *out = (struct dea_affine){v[0], v[1], v[2], v[3], v[4], v[5]};
  } else if (strcmp(name, "translate") == 0 && (count == 1 || count == 2)) {
    *out = (struct dea_affine){1, 0, 0, 1, v[0], count == 2 ? v[1] : 0};
  } else if (strcmp(name, "scale") == 0 && (count == 1 || count == 2)) {
    *out = (struct dea_affine){v[0], 0, 0, count == 2 ? v[1] : v[0], 0, 0};
  } else if (strcmp(name, "rotate") == 0 && (count == 1 || count == 3)) {
    double x = count == 3 ? v[1] : 0, y = count == 3 ? v[2] : 0;
    *out = (struct dea_affine){c, s, -s, c, x - c * x + s * y, y - s * x - c * y};
  } else if (strcmp(name, "skewX") == 0 && count == 1) {
    *out = (struct dea_affine){1, 0, tan(angle), 1, 0, 0};
  } else if (strcmp(name, "skewY") == 0 && count == 1) {
    *out = (struct dea_affine){1, tan(angle), 0, 1, 0, 0};
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
    struct dea_affine next;
    if (!good || *text != ')' || !transform_of(name, v, count, &next)) {
      return dea_drawing_fault(r->drawing, line_of(r), "the transform '%s' is not understood",
                               name);
    }
    text++;
    top(r)->matrix = dea_affine_times(&top(r)->matrix, &next);
  }
  return DEA_OK;
}

/* ---- lines, arcs and curves ---- */

static dea_status add_vertex(struct reader *r, double x, double y)
{
  return dea_drawing_line_to(r->drawing, (double[2]){x, y});
}

static dea_status end_path(struct reader *r, bool closed)
{
  return dea_drawing_end_path(r->drawing, top(r)->layer, closed);
}

/* Along an ellipse of axes `radius`, turned by an angle, from one parameter over `sweep`. end: its
 * last point. */
static dea_status add_arc(struct reader *r, const double centre[2], const double radius[2],
                          double turn, double from, double sweep, const double end[2])
{
  double c = cos(turn), s = sin(turn);
  const struct dea_ellipse ellipse = {{centre[0], centre[1]},
                                      {radius[0] * c, radius[0] * s},
                                      {-radius[1] * s, radius[1] * c},
                                      from,
                                      sweep};
  return dea_drawing_ellipse_to(r->drawing, &ellipse, end);
}

/* The arc of a path from p to q, by the formulas of SVG 1.1, appendix F.6. */
static dea_status add_path_arc(struct reader *r, const double p[2], const double v[5],
                               const double q[2])
{
  double radius[2] = {fabs(v[0]), fabs(v[1])}, turn = v[2] * DEA_PI / 180;
  if (radius[0] == 0 || radius[1] == 0 || (p[0] == q[0] && p[1] == q[1])) {
    return add_vertex(r, q[0], q[1]);
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
    sweep += 2 * DEA_PI;
  } else if (v[4] == 0 && sweep > 0) {
    sweep -= 2 * DEA_PI;
  }
  return add_arc(r, centre, radius, turn, from, sweep, q);
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
  return add_vertex(pen->r, pen->at[0], pen->at[1]);
}

/* C, S, Q and T as a spline of one span; v: its points in the order of the command, absolute. */
static dea_status draw_curve(struct pen *pen, char kind, const double *v)
{
  static const double knots[8] = {0, 0, 0, 0, 1, 1, 1, 1};
  bool cubic = kind == 'C' || kind == 'S', smooth = kind == 'S' || kind == 'T';
  bool follows =
      cubic ? pen->last == 'C' || pen->last == 'S' : pen->last == 'Q' || pen->last == 'T';
  size_t degree = cubic ? 3 : 2, given = degree - (smooth ? 1 : 0);
  double p[4][3] = {{pen->at[0], pen->at[1], 1}};
  for (int k = 0; k < 2; k++) {
    p[1][k] = follows ? 2 * pen->at[k] - pen->control[k] : pen->at[k];
    for (size_t i = 0; i < given; i++) {
      p[degree - given + 1 + i][k] = v[2 * i + (size_t)k];
    }
    pen->control[k] = p[degree - 1][k];
    pen->at[k] = p[degree][k];
  }
  p[1][2] = p[2][2] = p[3][2] = 1;
  const struct dea_spline spline = {degree, degree + 1, (const double(*)[3])p, knots + 3 - degree};
  return dea_drawing_spline_to(pen->r->drawing, &spline);
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
  DEA_TRY(pen->r->ctx,
          kind == 'A' ? add_path_arc(pen->r, pen->at, v, end) : add_vertex(pen->r, end[0], end[1]));
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
  static const char *const names[2][4] = {{"cx", "cy", "rx", "ry"}, {"cx", "cy", "r", "r"}};
  double v[4] = {0};
  DEA_TRY(r->ctx, read_lengths(r, attributes, names[circle], 4, v));
  if (v[2] <= 0 || v[3] <= 0) {
    return DEA_OK; // not drawn, says SVG
  }
  DEA_TRY(r->ctx, add_arc(r, v, v + 2, 0, 0, 2 * DEA_PI, (double[2]){v[0] + v[2], v[1]}));
  return end_path(r, true);
}

static dea_status read_rect(struct reader *r, const char **attributes)
{
  static const char *const names[6] = {"x", "y", "width", "height", "rx", "ry"};
  double v[6] = {0};
  DEA_TRY(r->ctx, read_lengths(r, attributes, names, 6, v));
  double x = v[0], y = v[1], width = v[2], height = v[3];
  bool has_x = attribute(attributes, "rx") != NULL, has_y = attribute(attributes, "ry") != NULL;
  double rx = v[has_x ? 4 : 5], ry = v[has_y ? 5 : 4];
  if (width <= 0 || height <= 0) {
    return DEA_OK;
  }
  const double radius[2] = {fmax(0, fmin(rx, 0.5 * width)), fmax(0, fmin(ry, 0.5 * height))};
  bool round = radius[0] > 0 && radius[1] > 0;
  static const int right[4] = {1, 1, 0, 0}, down[4] = {0, 1, 1, 0};
  for (int k = 0; k < 4; k++) { // the corner, from the upper right one on; y goes down
    double cx = x + right[k] * width, cy = y + down[k] * height;
    if (!round) {
      DEA_TRY(r->ctx, add_vertex(r, cx, cy));
      continue;
    }
    const double centre[2] = {cx + (right[k] ? -1 : 1) * radius[0],
                              cy + (down[k] ? -1 : 1) * radius[1]};
    double from = (k - 1) * 0.5 * DEA_PI;
    static const int cosine[5] = {0, 1, 0, -1, 0}, sine[5] = {-1, 0, 1, 0, -1};
    DEA_TRY(r->ctx,
            add_vertex(r, centre[0] + radius[0] * cosine[k], centre[1] + radius[1] * sine[k]));
    DEA_TRY(r->ctx, add_arc(r, centre, radius, 0, from, 0.5 * DEA_PI,
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
    DEA_TRY(r->ctx, add_vertex(r, x, y));
  }
  return end_path(r, closed);
}

static dea_status read_line(struct reader *r, const char **attributes)
{
  static const char *const names[4] = {"x1", "y1", "x2", "y2"};
  double v[4] = {0};
  DEA_TRY(r->ctx, read_lengths(r, attributes, names, 4, v));
  DEA_TRY(r->ctx, add_vertex(r, v[0], v[1]));
  DEA_TRY(r->ctx, add_vertex(r, v[2], v[3]));
  return end_path(r, false);
}

/* The size of a user unit, and y upwards. The unit is known where a side has a length and the view
 * box says how many units it is. */
static void read_root(struct reader *r, const char **attributes)
{
  const char *box = attribute(attributes, "viewBox");
  const char *aspect = attribute(attributes, "preserveAspectRatio");
  static const char *const sides[2] = {"width", "height"};
  double view[4] = {0, 0, NAN, NAN}, one[2];
  for (int k = 0; k < 4 && box != NULL; k++) {
    if (!read_number(&box, &view[k])) {
      view[2] = view[3] = NAN;
      break;
    }
  }
  for (int k = 0; k < 2; k++) {
    const char *text = attribute(attributes, sides[k]);
    double size = length_of(text, 1, NAN);
    bool has_unit = isfinite(size) && text[strspn(text, " \t\r\n+-.0123456789eE")] != '\0' &&
                    strstr(text, "px") == NULL;
    bool boxed = view[2 + k] > 0;
    one[k] = boxed && size > 0 ? size * px_m / view[2 + k] : NAN;
    r->view[k] = boxed ? view[2 + k] : size;
    r->drawing->unit_is_known |= boxed && size > 0 && has_unit;
  }
  // the smaller one: the whole box is seen
  bool none = aspect != NULL && strncmp(aspect, "none", 4) == 0;
  bool slice = aspect != NULL && strstr(aspect, "slice") != NULL;
  double both = slice ? fmax(one[0], one[1]) : fmin(one[0], one[1]);
  if (!r->drawing->unit_is_known && r->drawing->settings.unit_m > 0) {
    both = r->drawing->settings.unit_m;
    r->px = px_m / both; // what has a unit keeps it
    none = false;
  }
  both = isfinite(both) ? both : px_m;
  for (int k = 0; k < 2; k++) {
    one[k] = none && isfinite(one[k]) ? one[k] : both;
  }
  r->drawing->unit_m = one[0];
  double bottom = isfinite(view[3]) ? view[1] + view[3] : 0;
  top(r)->matrix = (struct dea_affine){
      one[0], 0, 0, -one[1], isfinite(view[2]) ? -one[0] * view[0] : 0, one[1] * bottom};
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
  static const char *const holders[] = {"g", "a", "switch", NULL};
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
  r->drawing->matrix = top(r)->matrix;
  r->drawing->line = line_of(r);
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
  r->hidden = strcmp(name, "svg") == 0; // with what is in it
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
    r->px = 1;
    r->view[0] = r->view[1] = NAN;
    r->parser = XML_ParserCreate(NULL);
    status =
        r->parser != NULL ? DEA_OK : dea_fail(ctx, DEA_E_MEMORY, "out of memory in the XML reader");
  }
  if (status == DEA_OK) {
    XML_SetUserData(r->parser, r);
    XML_SetElementHandler(r->parser, start_element, end_element);
    status = parse(r, bytes, length);
    status = status == DEA_OK
                 ? dea_drawing_add_notes(*out, "the file does not say its size in mm; 96 units to "
                                               "the inch are assumed (the key unit of a shape says "
                                               "it)")
                 : status;
    XML_ParserFree(r->parser);
  }
  dea_free(ctx, r);
  if (status != DEA_OK) {
    dea_drawing_destroy(*out);
    *out = NULL;
  }
  return status;
}
