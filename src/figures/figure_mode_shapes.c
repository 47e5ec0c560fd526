/* Shapes of the lowest modes: motion out of the plane over the whole disc, one map each. */
#include "base/write_file.h"
#include "figures/view3d.h"
#include "plot/script.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PIECES = 1500, MAPS_MAX = 6, ACROSS = 3 };

static const char name[] = "mode_shapes";
static const char caption[] = "shapes of the lowest modes, motion out of the plane";

/* The surface with shapes nearest to a voltage; the last one for NAN. */
static const struct dea_surface_record *choose(const struct dea_result *result, double voltage_V)
{
  const struct dea_surface_record *best = NULL;
  for (size_t i = 0; i < result->surface_count; i++) {
    const struct dea_surface_record *record = &result->surfaces[i];
    if (dea_surface_has_shapes(record) &&
        (best == NULL || isnan(voltage_V) ||
         fabs(record->voltage_V - voltage_V) < fabs(best->voltage_V - voltage_V))) {
      best = record;
    }
  }
  return best;
}

/* A shape as the displacement of a picture; one unit is drawn as a micrometre. */
static dea_status build_picture(struct dea_context *ctx, const struct dea_surface_record *record,
                                const struct dea_mesh_field *shape, struct dea_colour_map *out)
{
  struct dea_field_mesh mesh = *record->mesh; // lends all but one array
  const struct dea_surface_record moved = {.voltage_V = record->voltage_V, .mesh = &mesh};
  double *values = dea_alloc(ctx, 3 * mesh.point_count, sizeof *values);
  DEA_TRY_MEMORY(values != NULL);
  for (size_t i = 0; i < 3 * mesh.point_count; i++) {
    values[i] = 1e-6 * shape->values[i];
  }
  for (size_t f = 0; f < mesh.field_count; f++) {
    if (strcmp(mesh.fields[f].name, "displacement_m") == 0) {
      mesh.fields[f].values = values;
    }
  }
  dea_status status = dea_colour_map_create(ctx, NULL, &moved, PIECES, out);
  dea_free(ctx, values);
  return status;
}

/* What is drawn: pictures, and the frequency of each [Hz] and how much of it is out of the plane.
 */
struct maps {
  struct dea_colour_map pictures[MAPS_MAX];
  double frequency_Hz[MAPS_MAX], out_of_plane[MAPS_MAX], voltage_V;
  size_t count;
};

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

static dea_status build_maps(struct dea_context *ctx, const struct dea_result *result,
                             const struct dea_surface_record *record, struct maps *maps)
{
  maps->voltage_V = record->voltage_V;
  for (size_t k = 1; k <= MAPS_MAX; k++) {
    char field[32];
    snprintf(field, sizeof field, DEA_SHAPE_FIELD, (int)k);
    const struct dea_mesh_field *shape = dea_field_mesh_find(record->mesh, field);
    if (shape == NULL) {
      break;
    }
    struct dea_load_point point = point_of(result, record->voltage_V, k);
    maps->frequency_Hz[maps->count] = point.frequency_Hz;
    maps->out_of_plane[maps->count] = point.mode_out_of_plane;
    DEA_TRY(ctx, build_picture(ctx, record, shape, &maps->pictures[maps->count++]));
  }
  return DEA_OK;
}

/* One map: its place on the page, its words, the picture. */
static void add_map(struct dea_text *gp, const struct dea_view3d *space, const struct maps *maps,
                    size_t k, size_t rows)
{
  enum { HEAD = 14 }; // per cent of a cell's height for words
  double wide = 1.0 / ACROSS, high = 1.0 / (double)rows;
  const size_t row = k / ACROSS;
  double left = wide * (double)(k % ACROSS), top = 1 - high * (double)row;
  dea_text_add(gp,
               "  set lmargin at screen %.4f\n  set rmargin at screen %.4f\n"
               "  set tmargin at screen %.4f\n  set bmargin at screen %.4f\n"
               "  set label 1 \"%zu: %.4g Hz%s\" at screen %.4f, screen %.4f center front\n"
               "  k = %zu\n",
               left + 0.01, left + wide - 0.01, top - HEAD * 0.01 * high, top - high + 0.01, k + 1,
               fabs(maps->frequency_Hz[k]),
               maps->frequency_Hz[k] < 0     ? ", unstable"
               : maps->out_of_plane[k] < 0.5 ? ", in plane"
                                             : "",
               left + 0.5 * wide, top - 0.5 * HEAD * 0.01 * high, k);
  dea_view3d_add_command(gp, space);
}

static void add_script(struct dea_text *gp, const struct dea_view3d *space, const struct maps *maps,
                       const struct dea_plot_format *format)
{
  size_t rows = (maps->count + ACROSS - 1) / ACROSS;
  double width_mm = 1e3 * format->width_m, cell_mm = width_mm / ACROSS;
  double range[4];
  dea_view3d_ranges(space, 1, 1, range);
  char words[160];
  snprintf(words, sizeof words, "%s, about %.4g kV; yellow, light: up; blue, dark: down", caption,
           1e-3 * maps->voltage_V);
  dea_script_head(gp, name, words, format, width_mm, 1.16 * cell_mm * (double)rows);
  dea_colour_map_add_palette(gp, -1e-6, 1e-6);
  dea_text_add(gp,
               "set view map\nset pm3d corners2color mean\nset surface explicit\n"
               "set xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\n"
               "unset border\nunset xtics\nunset ytics\nunset colorbox\n\n",
               range[0], range[1], range[2], range[3]);
  dea_script_terminals(gp);
  dea_text_add(gp, "  eval \"set pm3d \".facets\n  set multiplot\n");
  for (size_t k = 0; k < maps->count; k++) {
    add_map(gp, space, maps, k, rows);
  }
  dea_text_add(gp, "  unset multiplot\n  unset output\n}\n");
}

static dea_status write_maps(struct dea_context *ctx, const struct maps *maps,
                             const struct dea_plot_format *format, const char *directory)
{
  struct dea_text gp = {.ctx = ctx}, dat = {.ctx = ctx};
  struct dea_view3d space;
  dea_view3d_measure(maps->pictures, maps->count, &space);
  space.flat = true;
  void *before = dea_c_locale_enter();
  add_script(&gp, &space, maps, format);
  dea_view3d_add_data(&dat, &space);
  dea_c_locale_leave(before);
  dea_status status = dea_colour_map_write(ctx, &gp, &dat, name, directory);
  dea_text_free(&gp);
  dea_text_free(&dat);
  return status;
}

static dea_status write(struct dea_context *ctx, const struct dea_result *result,
                        const struct dea_figure_options *options, const char *directory,
                        bool *drawn)
{
  const struct dea_surface_record *record = choose(result, options->voltage_V);
  struct maps maps = {.count = 0};
  *drawn = record != NULL && record->mesh->cell_count > 0;
  if (!*drawn) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_surface_report(ctx, name, record, options->voltage_V));
  dea_status status = build_maps(ctx, result, record, &maps);
  status = status == DEA_OK ? write_maps(ctx, &maps, &options->format, directory) : status;
  for (size_t k = 0; k < maps.count; k++) {
    dea_colour_map_free(ctx, &maps.pictures[k]);
  }
  return status;
}

const struct dea_figure dea_figure_mode_shapes = {.name = name, .caption = caption, .write = write};
