/* The deformed film in space or seen from above, for one voltage or several. */
#pragma once

#include "figures/colour_map.h"

/* What is drawn: the same surface at some voltages, in one box. z is drawn `times` larger. */
struct dea_view3d {
  const struct dea_colour_map *pictures; // lent
  size_t count;
  bool moved;                     // places with the displacement in the plane, of the first picture
  bool flat;                      // seen from above, without heights
  bool in_plane;                  // colours are displacements in the plane, since none is out of it
  double times;                   // dea_view3d_measure sets the rest
  double radius_m, low_m, high_m; // radius: from the centre; low, high: of the colours
  double centre_m[2];
  size_t frame_lines, lines; // lines of frame and electrode, all lines
};
/* pictures: of one mesh, at least one; lent. */
void dea_view3d_measure(const struct dea_colour_map *pictures, size_t count,
                        struct dea_view3d *out);
/* "frame (diameter sign) 30 mm" of what is round, "30 mm x 40 mm" of what is not: the box about the
 * middle. Returns out. */
enum { DEA_VIEW3D_WORDS = 64 };
const char *dea_view3d_size_words(const struct dea_view3d *space, char out[DEA_VIEW3D_WORDS]);
/* Ranges of x and y [mm] that hold what is drawn with a margin: {x low, x high, y low, y high}.
 * least, most: of height over width, which is filled up. Returns height over width. */
double dea_view3d_ranges(const struct dea_view3d *space, double least, double most, double out[4]);
/* What the colours show: symbol and unit, "{/:Italic z} (um)" with the sign for micro. */
const char *dea_view3d_colour_words(const struct dea_view3d *space);
/* Height of a drawing in space over its width. */
double dea_view3d_shape(const struct dea_view3d *space);
/* Its settings: projection and ranges, with the variables tilt and turn of the view, and times. */
void dea_view3d_add_settings(struct dea_text *gp, const struct dea_view3d *space);
/* Margins of a drawing in space: `words` of the height above and below it, and beside it the box of
 * colours with room for four digits. */
void dea_view3d_add_margins(struct dea_text *gp, double words);
/* "splot ..." of the picture in the gnuplot variable k, counted from 0. Of a flat one the lines
 * come last, in space depth decides. */
void dea_view3d_add_command(struct dea_text *gp, const struct dea_view3d *space);
/* Data: one index a line, as a ribbon that faces the viewer, then one a patch. Columns: x y (mm),
 * what z is drawn above the surface (mm of the drawing), then the colour (um) of each picture. */
void dea_view3d_add_data(struct dea_text *dat, const struct dea_view3d *space);

/* A figure in space: its name and what adds its script. */
struct dea_view3d_figure {
  const char *name;
  bool moved, flat; // as of struct dea_view3d
  size_t pieces;    // as of dea_surface_lattice_create
  void (*add_script)(struct dea_text *gp, const struct dea_view3d *space,
                     const struct dea_plot_format *format);
};
/* Writes script and data of pictures of one mesh. */
dea_status dea_view3d_write(struct dea_context *ctx, const struct dea_view3d_figure *figure,
                            const struct dea_colour_map *pictures, size_t count,
                            const struct dea_plot_format *format, const char *directory);
/* The same for the surface at the voltage of the options; *drawn: whether there was one. */
dea_status dea_view3d_write_one(struct dea_context *ctx, const struct dea_view3d_figure *figure,
                                const struct dea_result *result,
                                const struct dea_figure_options *options, const char *directory,
                                bool *drawn);
