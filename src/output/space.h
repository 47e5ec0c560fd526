/* The deformed film in space or seen from above, for one voltage or several. */
#ifndef DEA_OUTPUT_SPACE_H
#define DEA_OUTPUT_SPACE_H

#include "output/picture.h"

/* What is drawn: the same surface at some voltages, in one box. z is drawn `times` larger. */
struct dea_space {
  const struct dea_picture *pictures; // lent
  size_t count;
  bool moved;   // places with the displacement in the plane, of the first picture
  bool flat;    // seen from above, without heights
  double times; // dea_space_measure sets the rest
  double radius_m, low_m, high_m;
  size_t frame_lines, lines; // lines of frame and electrode, all lines
};
/* pictures: of one mesh, at least one; lent. */
void dea_space_measure(const struct dea_picture *pictures, size_t count, struct dea_space *out);
/* Height of a drawing in space over its width. */
double dea_space_shape(const struct dea_space *space);
/* Its settings: projection and ranges, with the variables tilt and turn of the view, and times. */
void dea_space_add_settings(struct dea_text *gp, const struct dea_space *space);
/* Margins of a drawing in space: `words` of the height above and below it, and beside it the box of
 * colours with room for four digits. */
void dea_space_add_margins(struct dea_text *gp, double words);
/* "splot ..." of the picture in the gnuplot variable k, counted from 0. Of a flat one the lines
 * come last, in space depth decides. */
void dea_space_add_command(struct dea_text *gp, const struct dea_space *space);
/* Data: one index a line, as a ribbon that faces the viewer, then one a patch. Columns: x y (mm),
 * what z is drawn above the surface (mm of the drawing), then z (um) of each picture. */
void dea_space_add_data(struct dea_text *dat, const struct dea_space *space);

/* A figure in space: its name and what adds its script. */
struct dea_space_figure {
  const char *name;
  bool moved, flat; // as of struct dea_space
  size_t pieces;    // as of dea_drawing_create
  void (*add_script)(struct dea_text *gp, const struct dea_space *space,
                     const struct dea_plot_format *format);
};
/* Writes script and data of pictures of one mesh. */
dea_status dea_space_write(struct dea_context *ctx, const struct dea_space_figure *figure,
                           const struct dea_picture *pictures, size_t count,
                           const struct dea_plot_format *format, const char *directory);
/* The same for the surface at the voltage of the options; *drawn: whether there was one. */
dea_status dea_space_write_one(struct dea_context *ctx, const struct dea_space_figure *figure,
                               const struct dea_result *result,
                               const struct dea_figure_options *options, const char *directory,
                               bool *drawn);

#endif
