/* Displacement of the whole film, as colours. */
#include "figures/view3d.h"
#include "plot/script.h"

enum { PIECES = 3000 };
static const double least_shape = 0.4; // room for the words of the colours

static const char name[] = "map";
static const char caption[] =
    "displacement out of the plane (in it where the film stays flat), over "
    "the place in the stretched film";

static void add_script(struct dea_text *gp, const struct dea_view3d *space,
                       const struct dea_plot_format *format)
{
  double width_mm = 1e3 * format->width_m, left = 12, right = 21.5, bottom = 11.5, top = 6;
  double range[4], shape = dea_view3d_ranges(space, least_shape, 1.25, range);
  double side = width_mm - left - right, high = shape * side, height_mm = high + bottom + top;
  double step = dea_nice_below(0.25 * (range[1] - range[0]));
  dea_script_head(gp, name, caption, format, width_mm, height_mm);
  dea_colour_map_add_palette(gp, space->low_m, space->high_m);
  dea_text_add(
      gp,
      "set lmargin at screen %.4f\nset rmargin at screen %.4f\n"
      "set bmargin at screen %.4f\nset tmargin at screen %.4f\n"
      "set view map\nset pm3d corners2color mean\n"
      "set surface explicit # lines, not a grid of them\n"
      "set xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\n"
      "set xtics %.6g\nset ytics %.6g\n"
      "set colorbox user origin screen %.4f, screen %.4f size screen %.4f, screen %.4f\n\n",
      left / width_mm, 1 - right / width_mm, bottom / height_mm, 1 - top / height_mm, range[0],
      range[1], range[2], range[3], step, step, 1 - (right - 1.5) / width_mm, bottom / height_mm,
      3 / width_mm, high / height_mm);
  dea_script_terminals(gp);
  dea_text_add(gp,
               "  set xlabel \"{/:Italic x} (mm)\" offset 0,x_shift\n"
               "  set ylabel \"{/:Italic y} (mm)\" offset y_shift,0\n"
               "  set cblabel \"%s\" offset 1.5,0\n"
               "  set label 1 \"%s\" at graph 0, graph %.4f front\n"
               "  eval \"set pm3d \".facets\n"
               "  set pm3d interpolate (format eq \"png\" ? 2 : 1), (format eq \"png\" ? 2 : 1)\n"
               "  k = 0\n",
               dea_view3d_colour_words(space), space->pictures[0].words, 1 + 0.045 / shape);
  dea_view3d_add_command(gp, space);
  dea_text_add(gp, "  unset output\n}\n");
}

static dea_status write(struct dea_context *ctx, const struct dea_result *result,
                        const struct dea_figure_options *options, const char *directory,
                        bool *drawn)
{
  static const struct dea_view3d_figure figure = {
      .name = name, .flat = true, .pieces = PIECES, .add_script = add_script};
  return dea_view3d_write_one(ctx, &figure, result, options, directory, drawn);
}

const struct dea_figure dea_figure_map = {.name = name, .caption = caption, .write = write};
