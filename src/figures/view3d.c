#include "figures/view3d.h"

#include "base/write_file.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>

/* Direction of view in degrees: turned about z, then tilted away from it. The projection is done in
 * the script, which leaves gnuplot a map whose third coordinate is the depth: so the film fills the
 * picture, and x, y and z have the scales that the caption says. */
enum { TILT = 52, TURN = 30 };

static const double least_of_radius = 1e-6; // a displacement below it is none: rounding
static const double ribbon_share = 0.003;   // half the width of a line, of the radius
static const double lift_share = 0.06;      // how far it is moved towards the viewer

static double in_plane_m(const double at[DEA_LATTICE_COLUMNS])
{
  return hypot(at[DEA_LATTICE_UX], at[DEA_LATTICE_UY]);
}

/* A film that stays flat shows how far its points move in its plane. */
static void measure_in_plane(struct dea_view3d *out)
{
  double most_m = 0;
  for (size_t i = 0; i < out->count; i++) {
    const struct dea_surface_lattice *drawing = &out->pictures[i].drawing;
    for (size_t p = 0; p < drawing->patch_count; p++) {
      const struct dea_patch *patch = &drawing->patches[p];
      for (int k = 0; k < (patch->n + 1) * (patch->m + 1); k++) {
        most_m = fmax(most_m, in_plane_m(patch->at[k]));
      }
    }
  }
  out->in_plane = most_m > least_of_radius * out->radius_m;
  if (out->in_plane) {
    out->low_m = 0;
    out->high_m = most_m;
  }
}

void dea_view3d_measure(const struct dea_colour_map *pictures, size_t count, struct dea_view3d *out)
{
  *out = (struct dea_view3d){.pictures = pictures, .count = count};
  out->low_m = INFINITY;
  out->high_m = -INFINITY;
  for (size_t i = 0; i < count; i++) {
    const struct dea_surface_lattice *drawing = &pictures[i].drawing;
    out->radius_m = fmax(out->radius_m, drawing->radius_m);
    out->centre_m[0] = drawing->centre_m[0];
    out->centre_m[1] = drawing->centre_m[1];
    out->low_m = fmin(out->low_m, drawing->z_min_m);
    out->high_m = fmax(out->high_m, drawing->z_max_m);
  }
  double span_m = out->high_m - out->low_m;
  bool flat = !(span_m > least_of_radius * out->radius_m);
  out->times = flat ? 1 : fmax(1, dea_nice_below(0.3 * out->radius_m / span_m));
  if (flat) {
    measure_in_plane(out);
  }
  out->lines = pictures[0].outline_count;
  for (size_t i = 0; i < out->lines; i++) {
    out->frame_lines += pictures[0].outlines[i].kind != DEA_OUTLINE_FIBRE;
  }
}

const char *dea_view3d_colour_words(const struct dea_view3d *space)
{
  return space->in_plane ? "Displacement in the plane (\302\265m)"
                         : "Displacement {/:Italic z} (\302\265m)";
}

const char *dea_view3d_size_words(const struct dea_view3d *space, char out[DEA_VIEW3D_WORDS])
{
  const struct dea_surface_lattice *drawing = &space->pictures[0].drawing;
  const double wide_m = drawing->high_m[0] - drawing->low_m[0];
  const double high_m = drawing->high_m[1] - drawing->low_m[1];
  if (fmin(wide_m, high_m) > 1.98 * space->radius_m) {
    snprintf(out, DEA_VIEW3D_WORDS, "frame \342\214\200 %.4g mm", 2e3 * space->radius_m);
  } else {
    snprintf(out, DEA_VIEW3D_WORDS, "%.4g mm \303\227 %.4g mm", 1e3 * wide_m, 1e3 * high_m);
  }
  return out;
}

double dea_view3d_ranges(const struct dea_view3d *space, double least, double most, double out[4])
{
  const struct dea_surface_lattice *drawing = &space->pictures[0].drawing;
  double half[2];
  for (int i = 0; i < 2; i++) {
    half[i] = 1.03e3 *
              fmax(drawing->high_m[i] - space->centre_m[i], space->centre_m[i] - drawing->low_m[i]);
  }
  half[0] = fmax(half[0], half[1] / most);
  half[1] = fmax(half[1], half[0] * least);
  for (int i = 0; i < 4; i++) {
    out[i] = 1e3 * space->centre_m[i / 2] + (i % 2 == 0 ? -1 : 1) * half[i / 2];
  }
  return half[1] / half[0];
}

/* Lowest and highest place in the picture [mm] and half its width. */
static void picture_range(const struct dea_view3d *space, double *low, double *high, double *half)
{
  double tilt = TILT * acos(-1) / 180, scale = 1e3 * space->times * sin(tilt);
  *half = 1.02e3 * space->radius_m;
  scale = space->in_plane ? 0 : scale;
  *low = -*half * cos(tilt) + scale * fmin(space->low_m, 0);
  *high = *half * cos(tilt) + scale * fmax(space->high_m, 0);
}

double dea_view3d_shape(const struct dea_view3d *space)
{
  double low, high, half;
  picture_range(space, &low, &high, &half);
  return (high - low) / (2 * half);
}

void dea_view3d_add_settings(struct dea_text *gp, const struct dea_view3d *space)
{
  double low, high, half;
  picture_range(space, &low, &high, &half);
  dea_text_add(gp,
               "times = %g # z is drawn so much larger\n"
               "tilt = %d * pi / 180; turn = %d * pi / 180 # of the view; lines face this one\n"
               "a(x,y) = x * cos(turn) + y * sin(turn)\n"
               "b(x,y,z) = (y * cos(turn) - x * sin(turn)) * cos(tilt) + z * sin(tilt)\n"
               "depth(x,y,z) = (y * cos(turn) - x * sin(turn)) * sin(tilt) - z * cos(tilt)\n"
               "z(above,um) = above + 1e-3 * times * um\n"
               "set view map\nset xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\n"
               "unset border\nunset xtics\nunset ytics\nunset ztics\n"
               "set pm3d depthorder corners2color mean\n",
               space->in_plane ? 0 : space->times, TILT, TURN, -half, half, low, high);
}

/* One part of the command: the data sets from..to (to < from: up to the last), and how they look.
 * gnuplot reads columns in half the time of expressions. */
static void add_part(struct dea_text *gp, const struct dea_view3d *space, bool first, size_t from,
                     size_t to, const char *colour, const char *look)
{
  const char *place =
      space->flat ? "1:2:3"
                  : "(a($1,$2)):(b($1,$2,z($3,column(4+k)))):(depth($1,$2,z($3,column(4+k))))";
  dea_text_add(gp, "%s data index ", first ? "  splot" : ", \\\n   ");
  if (to == SIZE_MAX) {
    dea_text_add(gp, "%zu::1", from);
  } else {
    dea_text_add(gp, "%zu:%zu", from, to);
  }
  dea_text_add(gp, " using %s%s with pm3d%s notitle", place, colour, look);
}

void dea_view3d_add_margins(struct dea_text *gp, double words)
{
  dea_text_add(gp,
               "set lmargin at screen 0.01\nset rmargin at screen 0.765\n"
               "set bmargin at screen %.4f\nset tmargin at screen %.4f\n"
               "set colorbox user origin screen 0.785, screen 0.15 size screen 0.03, screen 0.7\n",
               words, 1 - words);
}

void dea_view3d_add_command(struct dea_text *gp, const struct dea_view3d *space)
{
  size_t frame = space->frame_lines, lines = space->lines;
  add_part(gp, space, true, lines, SIZE_MAX, ":4+k", "");
  if (frame > 0) {
    add_part(gp, space, false, 0, frame - 1, "", " fc rgb \"black\"");
  }
  if (lines > frame) {
    add_part(gp, space, false, frame, lines - 1, "", " fc rgb \"#404040\"");
  }
  dea_text_add(gp, "\n");
}

/* Towards the viewer. */
static void view_direction(bool flat, double out[3])
{
  double tilt = flat ? 0 : TILT * acos(-1) / 180, turn = TURN * acos(-1) / 180;
  out[0] = sin(tilt) * sin(turn);
  out[1] = -sin(tilt) * cos(turn);
  out[2] = cos(tilt);
}

static void place_mm(const struct dea_view3d *space, const double at[DEA_LATTICE_COLUMNS],
                     double out[3])
{
  const double share = space->moved ? 1e3 : 0, from = space->flat ? 0 : 1e3; // from the middle
  out[0] = 1e3 * at[DEA_LATTICE_X] + share * at[DEA_LATTICE_UX] - from * space->centre_m[0];
  out[1] = 1e3 * at[DEA_LATTICE_Y] + share * at[DEA_LATTICE_UY] - from * space->centre_m[1];
  out[2] = space->flat ? 0 : 1e3 * space->times * at[DEA_LATTICE_UZ];
}

/* Half the ribbon across a line at its k-th point: perpendicular to line and view. */
static void ribbon_side(const struct dea_view3d *space, const struct dea_outline *line, int k,
                        const double view[3], double out[3])
{
  double p[3], q[3], along[3], length = 0, half = 1e3 * ribbon_share * space->radius_m;
  place_mm(space, line->at[k > 0 ? k - 1 : 0], p);
  place_mm(space, line->at[k + 1 < line->count ? k + 1 : k], q);
  for (int i = 0; i < 3; i++) {
    along[i] = q[i] - p[i];
  }
  for (int i = 0; i < 3; i++) {
    out[i] = along[(i + 1) % 3] * view[(i + 2) % 3] - along[(i + 2) % 3] * view[(i + 1) % 3];
    length += out[i] * out[i];
  }
  for (int i = 0; i < 3; i++) {
    out[i] *= length > 0 ? half / sqrt(length) : 0;
  }
}

static double colour_um(const struct dea_view3d *space, const double at[DEA_LATTICE_COLUMNS])
{
  return 1e6 * (space->in_plane ? in_plane_m(at) : at[DEA_LATTICE_UZ]);
}

static void add_row(struct dea_text *dat, const double xy_mm[2], double above_mm)
{
  dea_text_add(dat, "%.6g %.6g %.4g", xy_mm[0], xy_mm[1], above_mm);
}

static void add_ribbon(struct dea_text *dat, const struct dea_view3d *space, size_t number,
                       const double view[3])
{
  const struct dea_outline *line = &space->pictures[0].outlines[number];
  double lift = 1e3 * lift_share * space->radius_m;
  for (int edge = -1; edge <= 1; edge += 2) {
    for (int k = 0; k < line->count; k++) {
      double at[3], side[3];
      place_mm(space, line->at[k], at);
      ribbon_side(space, line, k, view, side);
      for (int i = 0; i < 3; i++) {
        at[i] += edge * side[i] + lift * view[i];
      }
      add_row(dat, at, edge * side[2] + lift * view[2]);
      for (size_t f = 0; f < space->count; f++) {
        dea_text_add(dat, " %.6g", colour_um(space, space->pictures[f].outlines[number].at[k]));
      }
      dea_text_add(dat, "\n");
    }
    dea_text_add(dat, edge < 0 ? "\n" : "");
  }
}

static void add_patch(struct dea_text *dat, const struct dea_view3d *space, size_t number)
{
  const struct dea_patch *patch = &space->pictures[0].drawing.patches[number];
  int row = patch->n + 1;
  for (int k = 0; k < row * (patch->m + 1); k++) {
    double at[3];
    place_mm(space, patch->at[k], at);
    dea_text_add(dat, "%s", k > 0 && k % row == 0 ? "\n" : "");
    add_row(dat, at, 0);
    for (size_t f = 0; f < space->count; f++) {
      dea_text_add(dat, " %.6g",
                   colour_um(space, space->pictures[f].drawing.patches[number].at[k]));
    }
    dea_text_add(dat, "\n");
  }
}

void dea_view3d_add_data(struct dea_text *dat, const struct dea_view3d *space)
{
  double view[3];
  view_direction(space->flat, view);
  dea_text_add(dat,
               "# x (mm) | y (mm) | above the film (mm of the drawing) | displacement %s (um) of "
               "each voltage\n# one index a line, then one a patch of the film\n",
               space->in_plane ? "in the plane" : "z");
  for (int fibres = 0; fibres <= 1; fibres++) {
    for (size_t i = 0; i < space->lines; i++) {
      if ((space->pictures[0].outlines[i].kind == DEA_OUTLINE_FIBRE) == (fibres == 1)) {
        add_ribbon(dat, space, i, view);
        dea_text_add(dat, "\n\n");
      }
    }
  }
  for (size_t p = 0; p < space->pictures[0].drawing.patch_count; p++) {
    dea_text_add(dat, "%s", p > 0 ? "\n\n" : "");
    add_patch(dat, space, p);
  }
}

dea_status dea_view3d_write(struct dea_context *ctx, const struct dea_view3d_figure *figure,
                            const struct dea_colour_map *pictures, size_t count,
                            const struct dea_plot_format *format, const char *directory)
{
  struct dea_text gp = {.ctx = ctx}, dat = {.ctx = ctx};
  struct dea_view3d space;
  dea_view3d_measure(pictures, count, &space);
  space.moved = figure->moved;
  space.flat = figure->flat;
  void *before = dea_c_locale_enter();
  figure->add_script(&gp, &space, format);
  dea_view3d_add_data(&dat, &space);
  dea_c_locale_leave(before);
  dea_status status = dea_colour_map_write(ctx, &gp, &dat, figure->name, directory);
  dea_text_free(&gp);
  dea_text_free(&dat);
  return status;
}

dea_status dea_view3d_write_one(struct dea_context *ctx, const struct dea_view3d_figure *figure,
                                const struct dea_result *result,
                                const struct dea_figure_options *options, const char *directory,
                                bool *drawn)
{
  const struct dea_surface_record *record = dea_surface_choose(result, options->voltage_V);
  struct dea_colour_map picture;
  *drawn = record != NULL && record->mesh->cell_count > 0;
  if (!*drawn) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_surface_report(ctx, figure->name, record, options->voltage_V));
  dea_status status = dea_colour_map_create(ctx, result, record, figure->pieces, &picture);
  if (status == DEA_OK) {
    status = dea_view3d_write(ctx, figure, &picture, 1, &options->format, directory);
  }
  dea_colour_map_free(ctx, &picture);
  return status;
}
