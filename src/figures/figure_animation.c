/* The deformed film over the voltages of the sweep, as an animated GIF. */
#include "figures/view3d.h"
#include "plot/script.h"

#include <stdio.h>
#include <string.h>

enum { PIECES = 1200, FRAMES_MAX = 33, WIDTH_PX = 720, LABEL_PX = 40 };

static const char name[] = "animation";

static void add_script(struct dea_text *gp, const struct dea_view3d *space,
                       const struct dea_plot_format *format)
{
  char caption[160], size[DEA_VIEW3D_WORDS];
  snprintf(caption, sizeof caption,
           "the film's middle surface over the sweep, z drawn %g times larger than x and y",
           space->times);
  dea_script_head(gp, name, caption, format, 1e3 * format->width_m, 1e3 * format->width_m);
  dea_colour_map_add_palette(gp, space->low_m, space->high_m);
  dea_view3d_add_settings(gp, space);
  double height_px = 0.78 * WIDTH_PX * dea_view3d_shape(space) + 2 * LABEL_PX;
  dea_view3d_add_margins(gp, LABEL_PX / height_px);
  dea_text_add(gp,
               "set cblabel \"%s\" offset 1.5,0\n"
               "set label 2 \"%s, z \303\227 %g\" at screen 0.03, "
               "screen 0.06 front\n",
               dea_view3d_colour_words(space), dea_view3d_size_words(space, size), space->times);
  dea_text_add(gp, "array words = [");
  for (size_t i = 0; i < space->count; i++) {
    dea_text_add(gp, "%s\"%s\"", i > 0 ? ", " : "", space->pictures[i].words);
  }
  dea_text_add(gp,
               "]\n\nset terminal gif animate delay 15 loop 0 optimize size %d, %.0f font "
               "\"DejaVuSans,13\"\nset output out.name.\".gif\"\n"
               "set pm3d border retrace interpolate 2, 2\n"
               "do for [k = 0:%zu] {\n"
               "  set label 1 words[k + 1] at screen 0.03, screen 0.94 front\n",
               WIDTH_PX, height_px, space->count - 1);
  dea_view3d_add_command(gp, space);
  dea_text_add(gp, "}\nunset output\n");
}

/* Pictures of all records on one mesh; *count: how many were made, also after a failure. */
static dea_status build_pictures(struct dea_context *ctx, const struct dea_result *result,
                                 const struct dea_surface_record *records[], size_t record_count,
                                 struct dea_colour_map *pictures, size_t *count)
{
  const struct dea_field_mesh *first = records[0]->mesh;
  *count = 0;
  for (size_t i = 0; i < record_count; i++) {
    const struct dea_field_mesh *mesh = records[i]->mesh;
    if (mesh->point_count == first->point_count && mesh->cell_count == first->cell_count &&
        memcmp(mesh->X, first->X, 3 * mesh->point_count * sizeof *mesh->X) == 0) {
      DEA_TRY(ctx, dea_colour_map_create(ctx, result, records[i], PIECES, &pictures[(*count)++]));
    }
  }
  return DEA_OK;
}

static dea_status write(struct dea_context *ctx, const struct dea_result *result,
                        const struct dea_figure_options *options, const char *directory,
                        bool *drawn)
{
  static const struct dea_view3d_figure figure = {.name = name, .add_script = add_script};
  const struct dea_surface_record *records[FRAMES_MAX];
  struct dea_colour_map pictures[FRAMES_MAX];
  size_t count = dea_surface_spread(result, FRAMES_MAX, records);
  *drawn = count > 1 && records[0]->mesh->cell_count > 0; // one is no animation
  if (!*drawn) {
    return DEA_OK;
  }
  dea_status status = build_pictures(ctx, result, records, count, pictures, &count);
  if (status == DEA_OK) {
    status = dea_view3d_write(ctx, &figure, pictures, count, &options->format, directory);
  }
  for (size_t i = 0; i < count; i++) {
    dea_colour_map_free(ctx, &pictures[i]);
  }
  return status;
}

const struct dea_figure dea_figure_animation = {
    .name = name,
    .caption = "the deformed film over the sweep",
    .on_request = true,
    .write = write,
};
