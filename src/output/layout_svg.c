#include "output/layout_svg.h"

#include "base/write_file.h"
#include "output/report/html.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
  PLAN = 460,    // largest side of the plan
  MARGIN = 26,   // around it
  KEY = 320,     // width of the legend
  LINE = 19,     // of the legend
  BELOW = 50,    // of the plan, for the scale bar
  CLAMP_BAR = 5, // width of the line along a held edge
};

// of materials with a hyperelastic law, and of others, in their order
static const char *const ply_fill[2][4] = {{"#dbe7f2", "#cfe3c4", "#e6d3ea", "#d3ecea"},
                                           {"#e0a04a", "#f1dc9a", "#d8a58a", "#c9ced6"}};
static const char *const ply_line[2][4] = {{"#8ea9c2", "#8fb07d", "#b590bd", "#7fb5b0"},
                                           {"#b07a2c", "#c4ab52", "#a8745a", "#8c93a0"}};
// of channels; the first one is ground
static const char *const channel_line[] = {"#707070", "#0072b2", "#d55e00", "#009e73",
                                           "#b85c94", "#c98a00", "#3d9fd6"};
enum {
  PLY_COLOURS = sizeof ply_fill[0] / sizeof ply_fill[0][0],
  CHANNEL_COLOURS = sizeof channel_line / sizeof channel_line[0],
};

struct drawing {
  const struct dea_layout *layout;
  struct dea_text *out;
  int number;
  double box[4];        // of what is drawn [m]
  double scale;         // units of the drawing per m
  double width, height; // of the plan
  double key_y;         // of the next line of the legend
};

static double x_of(const struct drawing *d, double x_m)
{
  return MARGIN + d->scale * (x_m - d->box[0]);
}

static double y_of(const struct drawing *d, double y_m)
{
  return MARGIN + d->scale * (d->box[3] - y_m);
}

static const char *channel_colour(size_t channel)
{
  return channel_line[channel == 0 ? 0 : 1 + (channel - 1) % (CHANNEL_COLOURS - 1)];
}

static bool is_stiff(const struct dea_material *material)
{
  return material->law == NULL;
}

/* Number of the material of a ply among those of its sort that differ by name. */
static size_t material_of(const struct dea_layout *l, size_t ply)
{
  const struct dea_material *own = &l->plies[ply].material;
  size_t count = 0;
  for (size_t i = 0; strcmp(l->plies[i].material.name, own->name) != 0; i++) {
    size_t first = 0;
    while (strcmp(l->plies[first].material.name, l->plies[i].material.name) != 0) {
      first++;
    }
    count += first == i && is_stiff(&l->plies[i].material) == is_stiff(own) ? 1 : 0;
  }
  return count;
}

/* The contours of a region as the data of a path. */
static void add_contours(struct drawing *d, size_t region)
{
  const struct dea_region *r = &d->layout->regions[region].region;
  for (size_t c = 0; c < r->contour_count; c++) {
    const struct dea_contour contour = dea_region_contour(r, c);
    for (size_t i = 0; i < dea_contour_pieces(&contour); i++) {
      const struct dea_piece p = dea_contour_piece(&contour, i);
      if (i == 0) {
        dea_text_add(d->out, "M%.2f %.2f", x_of(d, p.from[0]), y_of(d, p.from[1]));
      }
      if (p.arc) {
        double radius = d->scale * p.radius_m;
        dea_text_add(d->out, "A%.2f %.2f 0 %d %d ", radius, radius,
                     fabs(p.sweep) > 3.1415927 ? 1 : 0, p.sweep > 0 ? 0 : 1);
      } else {
        dea_text_add(d->out, "L");
      }
      dea_text_add(d->out, "%.2f %.2f", x_of(d, p.to[0]), y_of(d, p.to[1]));
    }
    dea_text_add(d->out, "Z");
  }
}

/* A region with attributes of our own. */
static void add_region(struct drawing *d, size_t region, const char *attributes)
{
  dea_text_add(d->out, "<path fill-rule=\"evenodd\" %s d=\"", attributes);
  add_contours(d, region);
  dea_text_add(d->out, "\"/>\n");
}

/* ---- the legend ---- */

/* Starts a line of the legend with a sample and a name; the words after it and "</text>" are the
 * caller's. */
static void start_key(struct drawing *d, const char *sample, const char *name)
{
  double x = d->width + 2 * MARGIN;
  dea_text_add(d->out, "<path d=\"M%.1f %.1fh20v11h-20z\" %s/>", x, d->key_y - 10, sample);
  dea_text_add(d->out, "<text x=\"%.1f\" y=\"%.1f\">", x + 28, d->key_y);
  dea_html_text(d->out, name);
  d->key_y += LINE;
}

static void add_heading(struct drawing *d, const char *text)
{
  dea_text_add(d->out, "<text x=\"%.1f\" y=\"%.1f\" font-weight=\"bold\">%s</text>\n",
               d->width + 2 * MARGIN, d->key_y + 4, text);
  d->key_y += LINE + 6;
}

/* ---- parts ---- */

static void ply_style(const struct dea_layout *l, size_t ply, char style[160])
{
  size_t colour = material_of(l, ply) % PLY_COLOURS;
  int sort = is_stiff(&l->plies[ply].material) ? 1 : 0;
  snprintf(style, 160, "fill=\"%s\" fill-opacity=\"%s\" stroke=\"%s\" stroke-width=\"1\"",
           ply_fill[sort][colour], sort == 0 ? "0.6" : "0.85", ply_line[sort][colour]);
}

static void draw_plies(struct drawing *d)
{
  const struct dea_layout *l = d->layout;
  char style[160];
  add_heading(d, "Plies, from top to bottom");
  for (size_t i = 0; i < l->ply_count; i++) {
    ply_style(l, i, style);
    add_region(d, l->plies[i].region, style);
  }
  for (size_t i = l->ply_count; i-- > 0;) {
    const struct dea_layout_ply *ply = &l->plies[i];
    ply_style(l, i, style);
    start_key(d, style, ply->name);
    dea_text_add(d->out, ", %.4g \302\265m, ", 1e6 * ply->thickness_m);
    dea_html_text(d->out, ply->material.name);
    dea_text_add(d->out, "</text>\n");
  }
}

static void electrode_style(size_t channel, char style[160])
{
  snprintf(style, 160,
           "fill=\"%s\" fill-opacity=\"%s\" stroke=\"%s\" stroke-width=\"1.4\" "
           "stroke-dasharray=\"%s\"",
           channel_colour(channel), channel == 0 ? "0.06" : "0.25", channel_colour(channel),
           channel == 0 ? "3 3" : "none");
}

static void draw_electrodes(struct drawing *d)
{
  const struct dea_layout *l = d->layout;
  char style[160];
  if (l->electrode_count > 0) {
    add_heading(d, "Electrodes, by channel");
  }
  for (size_t i = 0; i < l->electrode_count; i++) {
    electrode_style(l->electrodes[i].channel, style);
    add_region(d, l->electrodes[i].region, style);
  }
  for (size_t c = 0; c < l->channel_count; c++) {
    size_t used = 0;
    for (size_t i = 0; i < l->electrode_count; i++) {
      used += l->electrodes[i].channel == c ? 1 : 0;
    }
    if (used == 0) {
      continue;
    }
    electrode_style(c, style);
    start_key(d, style, l->channels[c].name);
    if (c > 0 && (l->channels[c].ratio != 1 || l->channels[c].own_V != 0)) {
      dea_text_add(d->out, ", %.4g \303\227 voltage", l->channels[c].ratio);
      dea_text_add(d->out, l->channels[c].own_V != 0 ? " %+.4g V</text>\n" : "</text>\n",
                   l->channels[c].own_V);
    } else {
      dea_text_add(d->out, "</text>\n");
    }
  }
}

/* "clamped", "hinged", or "held along x, z". */
static void add_hold(struct drawing *d, const struct dea_layout_support *s)
{
  if (s->components == 7) {
    dea_text_add(d->out, s->hinged ? ", hinged" : ", clamped");
    return;
  }
  for (int k = 0, first = 1; k < 3; k++) {
    if ((s->components & 1 << k) != 0) {
      dea_text_add(d->out, "%s%c", first ? ", held along " : ", ", "xyz"[k]);
      first = 0;
    }
  }
}

static void draw_supports(struct drawing *d)
{
  const struct dea_layout *l = d->layout;
  char style[200];
  if (l->support_count > 0) {
    add_heading(d, "Supports");
  }
  for (size_t i = 0; i < l->support_count; i++) {
    const struct dea_layout_support *s = &l->supports[i];
    const char *dashes = s->components == 7 && !s->hinged ? "none" : "7 4";
    if (s->within != DEA_LAYOUT_NONE) {
      dea_text_add(d->out, "<clipPath id=\"within-%d-%zu\"><path d=\"", d->number, i);
      add_contours(d, s->within);
      dea_text_add(d->out, "\"/></clipPath><g clip-path=\"url(#within-%d-%zu)\">", d->number, i);
    }
    if (s->edge) {
      snprintf(style, sizeof style,
               "fill=\"none\" stroke=\"#1c2430\" stroke-width=\"%d\" stroke-dasharray=\"%s\"",
               CLAMP_BAR, dashes);
    } else {
      snprintf(style, sizeof style,
               "fill=\"url(#hatch-%d)\" stroke=\"#1c2430\" stroke-dasharray=\"%s\"", d->number,
               dashes);
    }
    add_region(d, s->region, style);
    dea_text_add(d->out, s->within != DEA_LAYOUT_NONE ? "</g>\n" : "");
    start_key(d, style, l->regions[s->region].name);
    dea_text_add(d->out, s->edge ? ", edge" : "");
    add_hold(d, s);
    dea_text_add(d->out, "</text>\n");
  }
}

static void draw_bodies(struct drawing *d)
{
  const struct dea_layout *l = d->layout;
  static const char style[] = "fill=\"#3b4452\" fill-opacity=\"0.35\" stroke=\"#1c2430\" "
                              "stroke-width=\"1.6\"";
  if (l->body_count > 0) {
    add_heading(d, "Rigid bodies");
  }
  for (size_t i = 0; i < l->body_count; i++) {
    const struct dea_layout_body *b = &l->bodies[i];
    add_region(d, b->region, style);
    start_key(d, style, b->name);
    if (b->mass_kg > 0) {
      dea_text_add(d->out, ", %.4g g", 1e3 * b->mass_kg);
    }
    dea_text_add(d->out, "</text>\n");
  }
}

static void draw_pressures(struct drawing *d)
{
  const struct dea_layout *l = d->layout;
  if (l->pressure_count > 0) {
    add_heading(d, "Pressures");
  }
  for (size_t i = 0; i < l->pressure_count; i++) {
    const struct dea_layout_pressure *p = &l->pressures[i];
    static const char style[] = "fill=\"none\" stroke=\"#a03030\" stroke-dasharray=\"1.5 3\"";
    add_region(d, p->region, style);
    start_key(d, style, l->regions[p->region].name);
    dea_text_add(d->out, ", %.4g Pa on the %s of ", p->pressure_Pa, p->top ? "top" : "bottom");
    dea_html_text(d->out, l->plies[p->ply].name);
    dea_text_add(d->out, "</text>\n");
  }
}

/* A cross at a point of a monitor, with its number. */
static void add_mark(struct drawing *d, const double at_m[2], bool below, size_t number)
{
  double x = x_of(d, at_m[0]), y = y_of(d, at_m[1]);
  dea_text_add(d->out,
               "<path d=\"M%.1f %.1fh10m-5 -5v10\" stroke=\"#c0186b\" stroke-width=\"1.6\"/>"
               "<text x=\"%.1f\" y=\"%.1f\" fill=\"#c0186b\">%zu</text>\n",
               x - 5, y, x + 5, below ? y + 14 : y - 5, number);
}

static void draw_monitors(struct drawing *d)
{
  const struct dea_layout *l = d->layout;
  if (l->monitor_count > 0) {
    add_heading(d, "Monitors");
  }
  for (size_t i = 0; i < l->monitor_count; i++) {
    const struct dea_layout_monitor *m = &l->monitors[i];
    double at[2] = {m->at_m[0][0], m->at_m[0][1]};
    if (m->kind == DEA_MONITOR_LINE) {
      dea_text_add(d->out, "<path d=\"M%.2f %.2fL%.2f %.2f\" stroke=\"#c0186b\"/>", x_of(d, at[0]),
                   y_of(d, at[1]), x_of(d, m->at_m[1][0]), y_of(d, m->at_m[1][1]));
    } else if (m->kind != DEA_MONITOR_POINT) {
      size_t region = m->kind == DEA_MONITOR_BODY ? l->bodies[m->body].region : m->region;
      dea_region_centroid_m(&l->regions[region].region, at);
    }
    add_mark(d, at, m->kind == DEA_MONITOR_REGION, i + 1);
    dea_text_add(d->out, "<text x=\"%.1f\" y=\"%.1f\" fill=\"#c0186b\">%zu</text>",
                 d->width + 2 * MARGIN + 6, d->key_y, i + 1);
    start_key(d, "fill=\"none\"", m->name);
    dea_text_add(d->out, "</text>\n");
  }
}

/* Mirror lines through the plan. */
static void draw_symmetry(struct drawing *d)
{
  const struct dea_symmetry *s = &d->layout->symmetry;
  size_t lines = s->order == 0 ? 2 : s->mirrors < 24 ? s->mirrors : 24;
  double step = s->order == 0 ? 2 * atan(1) : s->step_rad;
  double length = hypot(d->box[2] - d->box[0], d->box[3] - d->box[1]);
  dea_text_add(d->out,
               "<clipPath id=\"plan-%d\"><path d=\"M%d %dh%.1fv%.1fh%.1fz\"/></clipPath>"
               "<g clip-path=\"url(#plan-%d)\" stroke=\"#566173\" stroke-width=\"0.9\" "
               "stroke-dasharray=\"10 3 2 3\">",
               d->number, MARGIN / 2, MARGIN / 2, d->width + MARGIN, d->height + MARGIN,
               -d->width - MARGIN, d->number);
  for (size_t k = 0; k < lines; k++) {
    double angle = (s->order == 0 ? 0 : s->mirror_rad) + (double)k * step;
    double c = length * cos(angle), y = length * sin(angle);
    dea_text_add(d->out, "<path d=\"M%.2f %.2fL%.2f %.2f\"/>", x_of(d, s->centre_m[0] - c),
                 y_of(d, s->centre_m[1] - y), x_of(d, s->centre_m[0] + c),
                 y_of(d, s->centre_m[1] + y));
  }
  dea_text_add(d->out, "</g>\n");
  if (lines > 0) {
    d->key_y += 6;
    dea_text_add(d->out,
                 "<path d=\"M%.1f %.1fh20\" stroke=\"#566173\" stroke-dasharray=\"10 3 2 3\"/>"
                 "<text x=\"%.1f\" y=\"%.1f\">",
                 d->width + 2 * MARGIN, d->key_y - 4, d->width + 2 * MARGIN + 28, d->key_y);
    if (s->order == 0) {
      dea_text_add(d->out, "symmetric to every line there</text>\n");
    } else {
      dea_text_add(d->out, "%zu line%s of symmetry</text>\n", s->mirrors,
                   s->mirrors == 1 ? "" : "s");
    }
    d->key_y += LINE;
  }
}

/* A bar of a round length, about a quarter of the plan. */
static void add_scale_bar(struct drawing *d)
{
  double wanted = 0.25 * (d->box[2] - d->box[0]), unit = pow(10, floor(log10(wanted)));
  double length = wanted >= 5 * unit ? 5 * unit : wanted >= 2 * unit ? 2 * unit : unit;
  double y = d->height + 2 * MARGIN + 4;
  dea_text_add(d->out,
               "<path d=\"M%d %.1fv8m0 -4h%.2fm0 -4v8\" stroke=\"#1c2430\" stroke-width=\"1.4\"/>"
               "<text x=\"%.1f\" y=\"%.1f\">%.4g mm</text>\n",
               MARGIN, y, d->scale * length, MARGIN + d->scale * length + 8, y + 8, 1e3 * length);
}

static void draw_all(struct drawing *d)
{
  dea_text_add(d->out,
               "<defs><pattern id=\"hatch-%d\" width=\"6\" height=\"6\" "
               "patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\">"
               "<path d=\"M0 0v6\" stroke=\"#1c2430\" stroke-width=\"1.6\"/></pattern></defs>\n",
               d->number);
  draw_plies(d);
  draw_electrodes(d);
  draw_bodies(d);
  draw_supports(d);
  draw_pressures(d);
  draw_symmetry(d);
  draw_monitors(d);
  add_scale_bar(d);
}

void dea_layout_svg(const struct dea_layout *layout, int number, struct dea_text *out)
{
  struct dea_text inside = {.ctx = out->ctx};
  void *locale = dea_c_locale_enter();
  struct drawing d = {.layout = layout, .out = &inside, .number = number, .key_y = MARGIN + 4};
  dea_layout_box_m(layout, d.box);
  double width = d.box[2] - d.box[0], height = d.box[3] - d.box[1];
  d.scale = PLAN / fmax(width, height);
  d.width = d.scale * width;
  d.height = d.scale * height;
  draw_all(&d);
  double whole = d.width + 3 * MARGIN + KEY, tall = fmax(d.height + 2 * MARGIN + BELOW, d.key_y);
  dea_text_add(out,
               "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" "
               "font-family=\"'DejaVu Sans',Helvetica,Arial,sans-serif\" font-size=\"13\" "
               "fill=\"none\"><path d=\"M0 0h%.0fv%.0fH0z\" fill=\"#fff\"/>"
               "<g fill=\"#1c2430\" stroke-width=\"1\">\n%s</g></svg>\n",
               whole, tall, whole, tall, dea_text_get(&inside));
  dea_c_locale_leave(locale);
  out->failed = out->failed || inside.failed;
  dea_text_free(&inside);
}
