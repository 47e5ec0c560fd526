/* Figures of the film's middle surface: seen from above (map, mode_shapes), in space (surface), and
 * in space over the sweep (animation). */
#include "base/write_file.h"
#include "figures/run_figures.h"
#include "figures/surface_lattice.h"
#include "plot/script.h"
#include "result/trust.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* Direction of view in degrees: turned about z, then tilted away from it. The projection is done in
 * the script, which leaves gnuplot a map whose third coordinate is the depth: so the film fills the
 * picture, and x, y and z have the scales that the caption says. */
enum { TILT = 52, TURN = 30, SIZE_WORDS = 64 };

static const double least_of_radius = 1e-6; // a displacement below it is none: rounding
static const double ribbon_share = 0.003;   // half the width of a line, of the radius
static const double lift_share = 0.06;      // how far it is moved towards the viewer

/* A surface ready to be drawn. */
struct picture {
  double voltage_V;
  char words[DEA_VOLTAGE_WORDS]; // what it shows
  struct dea_surface_lattice drawing;
  struct dea_outline *outlines;
  size_t outline_count;
};

/* What is drawn: the same surface at some voltages, in one box. z is drawn `times` larger. */
struct space {
  const struct picture *pictures; // [count], lent
  size_t count;
  bool moved;                     // places with the displacement in the plane, of the first picture
  bool flat;                      // seen from above, without heights
  bool in_plane;                  // colours are displacements in the plane, since none is out of it
  double times;                   // `measure` sets the rest
  double radius_m, low_m, high_m; // radius: from the centre; low, high: of the colours
  double centre_m[2];
  size_t frame_lines, lines; // lines of frame and electrode, all lines
};

enum { PICTURES_MAX = 33 };

/* What each figure has of its own, for `write`. */
struct view {
  bool moved, flat; // as of struct space
  size_t pieces;    // as of dea_surface_lattice_create
  /* The pictures that it shows; *count of them are to be freed, also after a failure. */
  dea_status (*gather)(struct dea_context *ctx, const struct dea_figure *figure,
                       const struct dea_result *result, double voltage_V,
                       struct picture pictures[PICTURES_MAX], size_t *count);
  void (*add_script)(struct dea_text *gp, const struct space *space,
                     const struct dea_plot_format *format);
};

// Surfaces of a result ----------------------------------------------------------------------------

/* The last surface that is to be trusted and moves; NULL for none. */
static const struct dea_surface_record *last_trusted(const struct dea_result *result)
{
  const struct dea_surface_record *best = NULL;
  for (size_t i = 0; i < result->surface_count; i++) {
    const struct dea_surface_record *record = &result->surfaces[i];
    if (dea_surface_is_first(result, i) && record->voltage_V > 0 &&
        dea_result_doubts(result, record->model, record->voltage_V) == 0) {
      best = record;
    }
  }
  return best;
}

/* The surface nearest to a voltage, the last for NAN: of the result's first model with surfaces, or
 * of those with shapes of modes. NULL when there is none. */
static const struct dea_surface_record *nearest(const struct dea_result *result, double voltage_V,
                                                bool with_shapes)
{
  const struct dea_surface_record *best = NULL;
  for (size_t i = 0; i < result->surface_count; i++) {
    const struct dea_surface_record *record = &result->surfaces[i];
    if ((with_shapes ? dea_surface_has_shapes(record) : dea_surface_is_first(result, i)) &&
        (best == NULL || isnan(voltage_V) ||
         fabs(record->voltage_V - voltage_V) < fabs(best->voltage_V - voltage_V))) {
      best = record;
    }
  }
  return best;
}

/* A note where that is another voltage than the one that was asked for. */
static dea_status report_surface(struct dea_context *ctx, const char *figure,
                                 const struct dea_surface_record *record, double voltage_V)
{
  const double rounding = 1e-9; // relative, of voltages in steps
  if (!(fabs(record->voltage_V - voltage_V) > rounding * fabs(voltage_V))) { // or NAN
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){"", 0, 0},
                         "figure '%s' shows %.6g kV: of those that the run has kept the nearest to "
                         "%.6g kV",
                         figure, 1e-3 * record->voltage_V, 1e-3 * voltage_V);
}

/* result: of the record, for its words; NULL: of none. out: free_picture, also after a failure. */
static dea_status create_picture(struct dea_context *ctx, const struct dea_result *result,
                                 const struct dea_surface_record *record, size_t pieces,
                                 struct picture *out)
{
  *out = (struct picture){.voltage_V = record->voltage_V};
  dea_voltage_words(result, record->model, record->voltage_V, out->words);
  DEA_TRY(ctx, dea_surface_lattice_create(ctx, record->mesh, pieces, &out->drawing));
  return DEA_CHAIN(
      ctx, dea_surface_lattice_outlines(ctx, record->mesh, &out->outlines, &out->outline_count));
}

static void free_picture(struct dea_context *ctx, struct picture *picture)
{
  dea_surface_lattice_free(ctx, &picture->drawing);
  dea_free(ctx, picture->outlines);
  picture->outlines = NULL;
}

// Scripts -----------------------------------------------------------------------------------------

/* 1, 2 or 5 times a power of ten, at most `largest` > 0. */
static double nice_below(double largest)
{
  double power = pow(10, floor(log10(largest) + 1e-9)), share = largest / power * (1 + 1e-9);
  return power * (share >= 5 ? 5 : share >= 2 ? 2 : 1);
}

void dea_figure_add_palette(struct dea_text *gp, double low_m, double high_m)
{
  double low_um = 1e6 * low_m, high_um = 1e6 * high_m;
  double largest = fmax(fabs(low_um), fabs(high_um));
  if (!(largest > 1e-6)) { // flat: no colours out of rounding
    low_um = -1;
    high_um = largest = 1;
  }
  if (low_um < 0 && high_um > 0 && fmin(-low_um, high_um) > 0.2 * largest) {
    dea_text_add(gp,
                 "set cbrange [%.6g:%.6g]\nset palette defined (0 \"#06193A\", 1 \"#0A4178\", "
                 "2 \"#3B74AC\", 3 \"#95989A\", 4 \"#DBAA5E\", 5 \"#F6CE58\", 6 \"#FFF7B8\")\n",
                 -largest, largest);
  } else {
    dea_text_add(gp,
                 "set cbrange [%.6g:%.6g]\nset palette defined (0 \"#0B1D42\", 1 \"#0B4A80\", "
                 "2 \"#0072B2\", 3 \"#4FA9C9\", 4 \"#A6D3A0\", 5 \"#F0E442\")\n",
                 low_um, high_um);
  }
  dea_text_add(gp, "set cbtics scale 0.4\n");
}

static double in_plane_m(const double at[DEA_LATTICE_COLUMNS])
{
  return hypot(at[DEA_LATTICE_UX], at[DEA_LATTICE_UY]);
}

/* A film that stays flat shows how far its points move in its plane. */
static void measure_in_plane(struct space *out)
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

/* pictures: of one mesh, at least one. */
static void measure(const struct picture *pictures, size_t count, struct space *out)
{
  *out = (struct space){.pictures = pictures, .count = count};
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
  out->times = flat ? 1 : fmax(1, nice_below(0.3 * out->radius_m / span_m));
  if (flat) {
    measure_in_plane(out);
  }
  out->lines = pictures[0].outline_count;
  for (size_t i = 0; i < out->lines; i++) {
    out->frame_lines += pictures[0].outlines[i].kind != DEA_OUTLINE_FIBRE;
  }
}

/* What the colours show: symbol and unit. */
static const char *colour_words(const struct space *space)
{
  return space->in_plane ? "Displacement in the plane (\302\265m)"
                         : "Displacement {/:Italic z} (\302\265m)";
}

/* "frame (diameter sign) 30 mm" of what is round, "30 mm x 40 mm" of what is not: the box about the
 * middle. Returns out. */
static const char *size_words(const struct space *space, char out[SIZE_WORDS])
{
  const struct dea_surface_lattice *drawing = &space->pictures[0].drawing;
  const double wide_m = drawing->high_m[0] - drawing->low_m[0];
  const double high_m = drawing->high_m[1] - drawing->low_m[1];
  if (fmin(wide_m, high_m) > 1.98 * space->radius_m) {
    snprintf(out, SIZE_WORDS, "frame \342\214\200 %.4g mm", 2e3 * space->radius_m);
  } else {
    snprintf(out, SIZE_WORDS, "%.4g mm \303\227 %.4g mm", 1e3 * wide_m, 1e3 * high_m);
  }
  return out;
}

/* Ranges of x and y [mm] that hold what is drawn with a margin: {x low, x high, y low, y high}.
 * least, most: of height over width, which is filled up. Returns height over width. */
static double ranges(const struct space *space, double least, double most, double out[4])
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
static void picture_range(const struct space *space, double *low, double *high, double *half)
{
  double tilt = TILT * DEA_PI / 180, scale = 1e3 * space->times * sin(tilt);
  *half = 1.02e3 * space->radius_m;
  scale = space->in_plane ? 0 : scale;
  *low = -*half * cos(tilt) + scale * fmin(space->low_m, 0);
  *high = *half * cos(tilt) + scale * fmax(space->high_m, 0);
}

/* Height of a drawing in space over its width. */
static double shape_of(const struct space *space)
{
  double low, high, half;
  picture_range(space, &low, &high, &half);
  return (high - low) / (2 * half);
}

/* Of a drawing in space: projection and ranges, with the variables tilt and turn of the view, and
 * times. */
static void add_settings(struct dea_text *gp, const struct space *space)
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
static void add_part(struct dea_text *gp, const struct space *space, bool first, size_t from,
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

/* Of a drawing in space: `words` of the height above and below it, and beside it the box of colours
 * with room for four digits. */
static void add_margins(struct dea_text *gp, double words)
{
  dea_text_add(gp,
               "set lmargin at screen 0.01\nset rmargin at screen 0.765\n"
               "set bmargin at screen %.4f\nset tmargin at screen %.4f\n"
               "set colorbox user origin screen 0.785, screen 0.15 size screen 0.03, screen 0.7\n",
               words, 1 - words);
}

/* "splot ..." of the picture in the gnuplot variable k, counted from 0. Of a flat one the lines
 * come last, in space depth decides. */
static void add_command(struct dea_text *gp, const struct space *space)
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

/* The end of the script of one picture. */
static void add_only_command(struct dea_text *gp, const struct space *space)
{
  dea_text_add(gp,
               "  eval \"set pm3d \".facets\n"
               "  set pm3d interpolate (format eq \"png\" ? 2 : 1), (format eq \"png\" ? 2 : 1)\n"
               "  k = 0\n");
  add_command(gp, space);
  dea_text_add(gp, "  unset output\n}\n");
}

/* Towards the viewer. */
static void view_direction(bool flat, double out[3])
{
  double tilt = flat ? 0 : TILT * DEA_PI / 180, turn = TURN * DEA_PI / 180;
  out[0] = sin(tilt) * sin(turn);
  out[1] = -sin(tilt) * cos(turn);
  out[2] = cos(tilt);
}

static void place_mm(const struct space *space, const double at[DEA_LATTICE_COLUMNS], double out[3])
{
  const double share = space->moved ? 1e3 : 0, from = space->flat ? 0 : 1e3; // from the middle
  out[0] = 1e3 * at[DEA_LATTICE_X] + share * at[DEA_LATTICE_UX] - from * space->centre_m[0];
  out[1] = 1e3 * at[DEA_LATTICE_Y] + share * at[DEA_LATTICE_UY] - from * space->centre_m[1];
  out[2] = space->flat ? 0 : 1e3 * space->times * at[DEA_LATTICE_UZ];
}

/* Half the ribbon across a line at its k-th point: perpendicular to line and view. */
static void ribbon_side(const struct space *space, const struct dea_outline *line, int k,
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

static double colour_um(const struct space *space, const double at[DEA_LATTICE_COLUMNS])
{
  return 1e6 * (space->in_plane ? in_plane_m(at) : at[DEA_LATTICE_UZ]);
}

static void add_row(struct dea_text *dat, const double xy_mm[2], double above_mm)
{
  dea_text_add(dat, "%.6g %.6g %.4g", xy_mm[0], xy_mm[1], above_mm);
}

static void add_ribbon(struct dea_text *dat, const struct space *space, size_t number,
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

static void add_patch(struct dea_text *dat, const struct space *space, size_t number)
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

/* One index a line, as a ribbon that faces the viewer, then one a patch. Columns: x y (mm), what z
 * is drawn above the surface (mm of the drawing), then the colour (um) of each picture. */
static void add_data(struct dea_text *dat, const struct space *space)
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

/* Of any figure here. */
static dea_status write(struct dea_context *ctx, const struct dea_figure *figure,
                        const struct dea_result *result, const struct dea_figure_options *options,
                        const char *directory, bool *drawn)
{
  const struct view *view = figure->view;
  struct picture pictures[PICTURES_MAX];
  struct dea_text gp = {.ctx = ctx}, dat = {.ctx = ctx};
  size_t count = 0;
  dea_status status = view->gather(ctx, figure, result, options->voltage_V, pictures, &count);
  *drawn = status == DEA_OK && count > 0;
  if (*drawn) {
    struct space space;
    measure(pictures, count, &space);
    space.moved = view->moved;
    space.flat = view->flat;
    void *before = dea_c_locale_enter();
    view->add_script(&gp, &space, &options->format);
    add_data(&dat, &space);
    dea_c_locale_leave(before);
    status = dea_script_write(directory, figure->name, &gp, &dat);
  }
  for (size_t i = 0; i < count; i++) {
    free_picture(ctx, &pictures[i]);
  }
  return status;
}

/* Gathers the surface at a voltage; for NAN the last that is to be trusted. */
static dea_status gather_one(struct dea_context *ctx, const struct dea_figure *figure,
                             const struct dea_result *result, double voltage_V,
                             struct picture pictures[PICTURES_MAX], size_t *count)
{
  const struct view *view = figure->view;
  const struct dea_surface_record *trusted = isnan(voltage_V) ? last_trusted(result) : NULL;
  const struct dea_surface_record *record =
      trusted != NULL ? trusted : nearest(result, voltage_V, false);
  if (record == NULL || record->mesh->cell_count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, report_surface(ctx, figure->name, record, voltage_V));
  *count = 1;
  return create_picture(ctx, result, record, view->pieces, &pictures[0]);
}

// From above --------------------------------------------------------------------------------------

static const char map_caption[] =
    "displacement out of the plane (in it where the film stays flat), over "
    "the place in the stretched film";

static void add_map_script(struct dea_text *gp, const struct space *space,
                           const struct dea_plot_format *format)
{
  static const double least_shape = 0.4; // room for the words of the colours
  double width_mm = 1e3 * format->width_m, left = 12, right = 21.5, bottom = 11.5, top = 6;
  double range[4], shape = ranges(space, least_shape, 1.25, range);
  double side = width_mm - left - right, high = shape * side, height_mm = high + bottom + top;
  double step = nice_below(0.25 * (range[1] - range[0]));
  dea_script_head(gp, "map", map_caption, format, width_mm, height_mm);
  dea_figure_add_palette(gp, space->low_m, space->high_m);
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
               "  set label 1 \"%s\" at graph 0, graph %.4f front\n",
               colour_words(space), space->pictures[0].words, 1 + 0.045 / shape);
  add_only_command(gp, space);
}

static const struct view map = {
    .flat = true, .pieces = 3000, .gather = gather_one, .add_script = add_map_script};

const struct dea_figure dea_figure_map = {
    .name = "map", .caption = map_caption, .write = write, .view = &map};

// In space ----------------------------------------------------------------------------------------

static void add_surface_script(struct dea_text *gp, const struct space *space,
                               const struct dea_plot_format *format)
{
  enum { LABEL_MM = 6 }; // room for words above and below
  double width_mm = 1e3 * format->width_m;
  char caption[2 * DEA_VOLTAGE_WORDS], size[SIZE_WORDS];
  snprintf(caption, sizeof caption,
           "the film's middle surface at %s, z drawn %g times larger than x and y",
           space->pictures[0].words, space->times);
  double height_mm = 0.78 * width_mm * shape_of(space) + 2 * LABEL_MM;
  dea_script_head(gp, "surface", caption, format, width_mm, height_mm);
  dea_figure_add_palette(gp, space->low_m, space->high_m);
  add_settings(gp, space);
  add_margins(gp, LABEL_MM / height_mm);
  dea_text_add(gp, "\n");
  dea_script_terminals(gp);
  dea_text_add(gp,
               "  set cblabel \"%s\" offset 1.5,0\n"
               "  set label 1 \"%s, {/:Italic z} \303\227 %g\" at screen 0.03, screen 0.94 "
               "front\n"
               "  set label 2 \"%s\" at screen 0.03, screen 0.06 front\n",
               colour_words(space), space->pictures[0].words, space->times,
               size_words(space, size));
  add_only_command(gp, space);
}

static const struct view surface = {
    .moved = true, .pieces = 3000, .gather = gather_one, .add_script = add_surface_script};

const struct dea_figure dea_figure_surface = {
    .name = "surface",
    .caption = "the deformed film in space, coloured by its displacement",
    .write = write,
    .view = &surface,
};

// Over the sweep ----------------------------------------------------------------------------------

enum { WIDTH_PX = 720, LABEL_PX = 40 };

static void add_animation_script(struct dea_text *gp, const struct space *space,
                                 const struct dea_plot_format *format)
{
  char caption[160], size[SIZE_WORDS];
  snprintf(caption, sizeof caption,
           "the film's middle surface over the sweep, z drawn %g times larger than x and y",
           space->times);
  dea_script_head(gp, "animation", caption, format, 1e3 * format->width_m, 1e3 * format->width_m);
  dea_figure_add_palette(gp, space->low_m, space->high_m);
  add_settings(gp, space);
  double height_px = 0.78 * WIDTH_PX * shape_of(space) + 2 * LABEL_PX;
  add_margins(gp, LABEL_PX / height_px);
  dea_text_add(gp,
               "set cblabel \"%s\" offset 1.5,0\n"
               "set label 2 \"%s, z \303\227 %g\" at screen 0.03, "
               "screen 0.06 front\n",
               colour_words(space), size_words(space, size), space->times);
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
  add_command(gp, space);
  dea_text_add(gp, "}\nunset output\n");
}

static dea_status gather_sweep(struct dea_context *ctx, const struct dea_figure *figure,
                               const struct dea_result *result, double voltage_V,
                               struct picture pictures[PICTURES_MAX], size_t *count)
{
  const struct view *view = figure->view;
  const struct dea_surface_record *records[PICTURES_MAX];
  const size_t frames = dea_surface_spread_same(result, PICTURES_MAX, records);
  (void)voltage_V;
  if (frames < 2 || records[0]->mesh->cell_count == 0) { // one is no animation
    return DEA_OK;
  }
  while (*count < frames) {
    struct picture *picture = &pictures[(*count)++];
    DEA_TRY(ctx, create_picture(ctx, result, records[*count - 1], view->pieces, picture));
  }
  return DEA_OK;
}

static const struct view animation = {
    .pieces = 1200, .gather = gather_sweep, .add_script = add_animation_script};

const struct dea_figure dea_figure_animation = {
    .name = "animation",
    .caption = "the deformed film over the sweep",
    .on_request = true,
    .write = write,
    .view = &animation,
};

// Modes -------------------------------------------------------------------------------------------

enum { SHAPES_MAX = 6, ACROSS = 3 };
static const char shapes_caption[] = "shapes of the lowest modes, motion out of the plane";

/* A shape as the displacement of a picture; one unit is drawn as a micrometre. */
static dea_status build_shape(struct dea_context *ctx, const struct dea_surface_record *record,
                              const struct dea_mesh_field *shape, size_t pieces,
                              struct picture *out)
{
  struct dea_field_mesh mesh = *record->mesh; // lends all but one array
  const struct dea_surface_record moved = {.voltage_V = record->voltage_V, .mesh = &mesh};
  double *values = dea_alloc(ctx, 3 * mesh.point_count, sizeof *values);
  *out = (struct picture){.voltage_V = record->voltage_V};
  DEA_TRY_MEMORY(values != NULL);
  for (size_t i = 0; i < 3 * mesh.point_count; i++) {
    values[i] = 1e-6 * shape->values[i];
  }
  for (size_t f = 0; f < mesh.field_count; f++) {
    if (strcmp(mesh.fields[f].name, "displacement_m") == 0) {
      mesh.fields[f].values = values;
    }
  }
  dea_status status = create_picture(ctx, NULL, &moved, pieces, out);
  dea_free(ctx, values);
  return status;
}

/* The point of a mode at a voltage, an empty one where no curve has it. */
static struct dea_load_point point_of(const struct dea_result *result, double voltage_V,
                                      size_t mode)
{
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *curve = &result->curves[i];
    for (size_t k = 0; strcmp(curve->kind, "modal") == 0 && k < curve->count; k++) {
      const struct dea_load_point *p = &curve->points[k];
      if (p->voltage_V == voltage_V && p->mode == (double)mode) {
        return *p;
      }
    }
  }
  return dea_load_point_empty();
}

static dea_status gather_shapes(struct dea_context *ctx, const struct dea_figure *figure,
                                const struct dea_result *result, double voltage_V,
                                struct picture pictures[PICTURES_MAX], size_t *count)
{
  const struct view *view = figure->view;
  const struct dea_surface_record *record = nearest(result, voltage_V, true);
  if (record == NULL || record->mesh->cell_count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, report_surface(ctx, figure->name, record, voltage_V));
  for (size_t k = 1; k <= SHAPES_MAX; k++) {
    char field[32];
    snprintf(field, sizeof field, DEA_SHAPE_FIELD, (int)k);
    const struct dea_mesh_field *shape = dea_field_mesh_find(record->mesh, field);
    if (shape == NULL) {
      break;
    }
    const struct dea_load_point point = point_of(result, record->voltage_V, k);
    struct picture *picture = &pictures[(*count)++];
    DEA_TRY(ctx, build_shape(ctx, record, shape, view->pieces, picture));
    snprintf(picture->words, sizeof picture->words, "%zu: %.4g Hz%s", k, fabs(point.frequency_Hz),
             point.frequency_Hz < 0          ? ", unstable"
             : point.mode_out_of_plane < 0.5 ? ", in plane"
                                             : "");
  }
  return DEA_OK;
}

/* One map: its place on the page, its words, the picture. */
static void add_shape(struct dea_text *gp, const struct space *space, size_t k, size_t rows)
{
  enum { HEAD = 14 }; // per cent of a cell's height for words
  double wide = 1.0 / ACROSS, high = 1.0 / (double)rows;
  const size_t row = k / ACROSS;
  double left = wide * (double)(k % ACROSS), top = 1 - high * (double)row;
  dea_text_add(gp,
               "  set lmargin at screen %.4f\n  set rmargin at screen %.4f\n"
               "  set tmargin at screen %.4f\n  set bmargin at screen %.4f\n"
               "  set label 1 \"%s\" at screen %.4f, screen %.4f center front\n"
               "  k = %zu\n",
               left + 0.01, left + wide - 0.01, top - HEAD * 0.01 * high, top - high + 0.01,
               space->pictures[k].words, left + 0.5 * wide, top - 0.5 * HEAD * 0.01 * high, k);
  add_command(gp, space);
}

static void add_shapes_script(struct dea_text *gp, const struct space *space,
                              const struct dea_plot_format *format)
{
  size_t rows = (space->count + ACROSS - 1) / ACROSS;
  double width_mm = 1e3 * format->width_m, cell_mm = width_mm / ACROSS;
  double range[4];
  ranges(space, 1, 1, range);
  char words[160];
  snprintf(words, sizeof words, "%s, about %.4g kV; yellow, light: up; blue, dark: down",
           shapes_caption, 1e-3 * space->pictures[0].voltage_V);
  dea_script_head(gp, "mode_shapes", words, format, width_mm, 1.16 * cell_mm * (double)rows);
  dea_figure_add_palette(gp, -1e-6, 1e-6);
  dea_text_add(gp,
               "set view map\nset pm3d corners2color mean\nset surface explicit\n"
               "set xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\n"
               "unset border\nunset xtics\nunset ytics\nunset colorbox\n\n",
               range[0], range[1], range[2], range[3]);
  dea_script_terminals(gp);
  dea_text_add(gp, "  eval \"set pm3d \".facets\n  set multiplot\n");
  for (size_t k = 0; k < space->count; k++) {
    add_shape(gp, space, k, rows);
  }
  dea_text_add(gp, "  unset multiplot\n  unset output\n}\n");
}

static const struct view mode_shapes = {
    .flat = true, .pieces = 1500, .gather = gather_shapes, .add_script = add_shapes_script};

const struct dea_figure dea_figure_mode_shapes = {
    .name = "mode_shapes", .caption = shapes_caption, .write = write, .view = &mode_shapes};
