/* The actuator drawn to scale from above, and cut along a fibre with the thickness drawn larger. */
#include "output/layout_svg.h"
#include "output/report/section.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

enum { SIZE = 360, MIDDLE = SIZE / 2, FILM = 150, FRAME = 168 }; // radii of film and frame

/* A point at an angle from the +x axis (towards the right, upwards positive) in the drawing. */
static void add_point(struct dea_text *out, char pen, double r, double across, double angle)
{
  double x = r * cos(angle) - across * sin(angle), y = r * sin(angle) + across * cos(angle);
  dea_text_add(out, "%c%.2f %.2f", pen, MIDDLE + x, MIDDLE - y);
}

static void add_fibres(struct dea_text *out, const struct dea_device *device, double scale)
{
  double r_tip = scale * device->fibre_tip_radius_m, half = scale * device->fibre_width_m / 2;
  double r_out = device->outer_end == DEA_END_FREE ? FILM - scale * device->fibre_outer_gap_m
                                                   : 0.5 * (FILM + FRAME);
  double half_tip = scale * device->fibre_tip_width_m / 2;
  dea_text_add(out, "<path class=\"fibre\" d=\"");
  for (int i = 0; i < device->fibre_count; i++) {
    double angle = 2 * pi * i / device->fibre_count;
    add_point(out, 'M', r_tip, half_tip, angle);
    add_point(out, 'L', r_out, half, angle);
    add_point(out, 'L', r_out, -half, angle);
    add_point(out, 'L', r_tip, -half_tip, angle);
    dea_text_add(out, "Z");
  }
  dea_text_add(out, "\"/>");
}

/* A measure below the drawing: from the centre to x, with its words. */
static void add_measure(struct dea_text *out, double length, double y, const char *what,
                        double metre)
{
  dea_text_add(out,
               "<path class=\"measure\" d=\"M%d %.1fv8M%d %.1fH%.2fM%.2f %.1fv8\"/>"
               "<text x=\"%.2f\" y=\"%.1f\">%s %.4g mm</text>",
               MIDDLE, y - 4, MIDDLE, y, MIDDLE + length, MIDDLE + length, y - 4,
               MIDDLE + length + 6, y + 4, what, 1e3 * metre);
}

static void add_top(struct dea_text *out, const struct dea_device *device, int number)
{
  double scale = FILM / device->frame_radius_m;
  dea_text_add(out,
               "<figure class=\"drawing\"><svg viewBox=\"0 0 %d %d\" role=\"img\" "
               "aria-labelledby=\"top-%d\"><circle class=\"ring\" cx=\"%d\" cy=\"%d\" r=\"%d\"/>"
               "<circle class=\"film\" cx=\"%d\" cy=\"%d\" r=\"%d\"/>"
               "<circle class=\"electrode\" cx=\"%d\" cy=\"%d\" r=\"%.2f\"/>",
               SIZE + 90, SIZE + 54, number, MIDDLE, MIDDLE, FRAME, MIDDLE, MIDDLE, FILM, MIDDLE,
               MIDDLE, scale * device->electrode_radius_m);
  if (device->fibre_count > 0) {
    add_fibres(out, device, scale);
  }
  add_measure(out, scale * device->electrode_radius_m, SIZE + 10, "electrode",
              device->electrode_radius_m);
  if (device->fibre_count > 0) {
    add_measure(out, scale * device->fibre_tip_radius_m, SIZE + 26, "fibre tip",
                device->fibre_tip_radius_m);
  }
  add_measure(out, FILM, SIZE + 42, "frame", device->frame_radius_m);
  dea_text_add(out,
               "</svg><figcaption id=\"top-%d\">From above, to scale; radii in the stretched film"
               "%s</figcaption></figure>",
               number, device->fibre_count > 0 ? ", fibres on the upper side" : "");
}

/* Layers of the right half: heights in the drawing grow with the logarithm of the thickness, so
 * that 10 um and 1 mm both show. */
static double layer_height(double thickness_m)
{
  return thickness_m > 0 ? 6 + 12 * fmax(0, log10(thickness_m / 1e-6)) : 0;
}

static void add_layer(struct dea_text *out, const char *class, double from, double to, double top,
                      double height)
{
  dea_text_add(out, "<rect class=\"%s\" x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\"/>",
               class, from, top, to - from, height);
}

static void add_section(struct dea_text *out, const struct dea_device *device, int number)
{
  enum { LEFT = 12, RIGHT = 372, BASE = 120 };
  double scale = (RIGHT - LEFT) / device->frame_radius_m;
  double film = layer_height(device->film_thickness_m), top = BASE - film;
  double electrode = LEFT + scale * device->electrode_radius_m;
  dea_text_add(out,
               "<figure class=\"drawing\"><svg viewBox=\"0 0 450 220\" role=\"img\" "
               "aria-labelledby=\"cut-%d\"><path class=\"axis\" d=\"M%d 14V200\"/>",
               number, LEFT);
  add_layer(out, "ring", RIGHT, RIGHT + 34, top - 34, film + 68);
  add_layer(out, "film", LEFT, RIGHT, top, film);
  add_layer(out, "electrode", LEFT, electrode, top - 4, 4);
  add_layer(out, "electrode", LEFT, electrode, BASE, 4);
  if (device->fibre_count > 0) {
    double tip = LEFT + scale * device->fibre_tip_radius_m, glue = 0;
    double height = layer_height(device->fibre_thickness_m), under = top;
    double end =
        device->outer_end == DEA_END_FREE ? RIGHT - scale * device->fibre_outer_gap_m : RIGHT + 20;
    under -= tip < electrode ? 4 : 0;
    glue = device->bond_thickness_m > 0 ? layer_height(device->bond_thickness_m) / 2 : 0;
    add_layer(out, "glue", tip, fmin(end, RIGHT), under - glue, glue);
    add_layer(out, "fibre", tip, end, under - glue - height, height);
    dea_text_add(out, "<text x=\"%.1f\" y=\"%.1f\">fibre %.4g \302\265m, %.4g mm wide</text>",
                 fmin(tip + 4, 210), under - glue - height - 8, 1e6 * device->fibre_thickness_m,
                 1e3 * device->fibre_width_m);
  }
  dea_text_add(out,
               "<text x=\"%d\" y=\"%.1f\">film %.4g \302\265m (unstretched %.4g \302\265m, "
               "pre-stretch %.4g)</text>",
               LEFT + 6, BASE + 26.0, 1e6 * device->film_thickness_m,
               1e6 * device->film_thickness_unstretched_m, device->pre_stretch);
  dea_text_add(out, "<text x=\"%d\" y=\"%.1f\">electrodes on both faces%s</text>", LEFT + 6,
               BASE + 44.0, device->electrode_thickness_m > 0 ? "" : ", without stiffness");
  dea_text_add(out,
               "</svg><figcaption id=\"cut-%d\">Cut from the centre to the frame%s; thicknesses "
               "not to scale</figcaption></figure>",
               number, device->fibre_count > 0 ? " along a fibre" : "");
}

void dea_device_add_svg(struct dea_text *out, const struct dea_device *device, int number)
{
  dea_text_add(out, "<div class=\"drawings\">");
  if (device->general) {
    dea_text_add(out, "<figure class=\"layout\">");
    dea_layout_svg(device->layout, number, out);
    dea_text_add(out, "<figcaption>From above, to scale, as it is stretched when parts are bonded "
                      "to it</figcaption></figure></div>");
    return;
  }
  add_top(out, device, number);
  add_section(out, device, number);
  dea_text_add(out, "</div>");
}
