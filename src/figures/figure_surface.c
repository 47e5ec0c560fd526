/* The deformed film in space, coloured by its displacement. */
#include "figures/view3d.h"
#include "plot/script.h"

#include <stdio.h>

enum { PIECES = 3000, LABEL_MM = 6 }; // room for words above and below

static const char name[] = "surface";

static void add_script(struct dea_text *gp, const struct dea_view3d *space,
                       const struct dea_plot_format *format)
{
  double width_mm = 1e3 * format->width_m;
  char caption[2 * DEA_VOLTAGE_WORDS], size[DEA_VIEW3D_WORDS];
  snprintf(caption, sizeof caption,
           "the film's middle surface at %s, z drawn %g times larger than x and y",
           space->pictures[0].words, space->times);
  double height_mm = 0.78 * width_mm * dea_view3d_shape(space) + 2 * LABEL_MM;
  dea_script_head(gp, name, caption, format, width_mm, height_mm);
  dea_colour_map_add_palette(gp, space->low_m, space->high_m);
  dea_view3d_add_settings(gp, space);
  dea_view3d_add_margins(gp, LABEL_MM / height_mm);
  dea_text_add(gp, "\n");
  dea_script_terminals(gp);
  dea_text_add(gp,
               "  set cblabel \"%s\" offset 1.5,0\n"
               "  set label 1 \"%s, {/:Italic z} \303\227 %g\" at screen 0.03, screen 0.94 "
               "front\n"
               "  set label 2 \"%s\" at screen 0.03, screen 0.06 front\n"
               "  eval \"set pm3d \".facets\n"
               "  set pm3d interpolate (format eq \"png\" ? 2 : 1), (format eq \"png\" ? 2 : 1)\n"
               "  k = 0\n",
               dea_view3d_colour_words(space), space->pictures[0].words, space->times,
               dea_view3d_size_words(space, size));
  dea_view3d_add_command(gp, space);
  dea_text_add(gp, "  unset output\n}\n");
}

static dea_status write(struct dea_context *ctx, const struct dea_result *result,
                        const struct dea_figure_options *options, const char *directory,
                        bool *drawn)
{
  static const struct dea_view3d_figure figure = {
      .name = name, .moved = true, .pieces = PIECES, .add_script = add_script};
  return dea_view3d_write_one(ctx, &figure, result, options, directory, drawn);
}

const struct dea_figure dea_figure_surface = {
    .name = name,
    .caption = "the deformed film in space, coloured by its displacement",
    .write = write,
};
