/* Drawings from files: contours by layer, which become regions. DXF and SVG. */
#pragma once

#include "geometry/region.h"

/* 0 in a member: its default. */
struct dea_drawing_settings {
  double unit_m;       // of a file that does not say it
  size_t vertices_max; // of a drawing; default DEA_DRAWING_VERTICES_MAX
};

enum {
  DEA_DRAWING_VERTICES_MAX = 4000000,
  DEA_DRAWING_BYTES_MAX = 500000000,
  DEA_DRAWING_LAYERS_MAX = 1000,
};

#define DEA_DRAWING_JOIN_M 1e-6 // ends of lines nearer than this are joined

/* x -> a x + c y + e, y -> b x + d y + f. */
struct dea_affine {
  double a, b, c, d, e, f;
};

/* Lines and arcs that follow each other; its vertices start where the path before it ends. */
struct dea_drawing_path {
  size_t layer, end; // end: number of the vertex after its last
  bool closed;
};

/* Entities of one kind on a layer that are not read. */
struct dea_drawing_skipped {
  char kind[32];
  size_t layer, count;
  struct dea_location location; // of the first one
};

struct dea_drawing {
  struct dea_context *ctx;
  struct dea_drawing_settings settings;
  const char *file;   // interned
  const char **layer; // [layer_count] names, interned; owned list
  struct dea_drawing_path *path;
  struct dea_drawing_skipped *skipped;
  struct dea_vertex *vertex;
  size_t layer_count, layer_room, path_count, path_room, skipped_count, skipped_room;
  size_t vertex_count, vertex_room;
  double unit_m;      // of the file's lengths
  bool unit_is_known; // false: the file does not say it, and unit_m was given or assumed
  bool any_case;      // names of layers do not differ by the case of their letters alone

  // for readers
  struct dea_affine matrix; // of what is drawn, to metres
  size_t line;              // of the file, where what is drawn stands
  size_t curves;            // that became arcs
  double deviation_m;       // largest distance of curves from these arcs
};

/* Reads a file by its ending, .dxf or .svg; settings: NULL for the defaults. What is wrong with it
 * is a finding at its line and DEA_E_DESIGN; DEA_E_IO when it cannot be read. Lengths in a file
 * without a unit are in that of the settings, or else mm (DXF) or 1/96 inch (SVG), which is a note.
 * Curves become arcs, which is a note, too. out: owned by the caller. */
dea_status dea_drawing_read(struct dea_context *ctx, const char *file,
                            const struct dea_drawing_settings *settings, struct dea_drawing **out);
/* The same of bytes[length] and a NUL after them; file: its name for messages. */
dea_status dea_drawing_read_dxf(struct dea_context *ctx, const char *file, const char *bytes,
                                size_t length, const struct dea_drawing_settings *settings,
                                struct dea_drawing **out);
dea_status dea_drawing_read_svg(struct dea_context *ctx, const char *file, const char *bytes,
                                size_t length, const struct dea_drawing_settings *settings,
                                struct dea_drawing **out);
/* NULL is fine. */
void dea_drawing_destroy(struct dea_drawing *drawing);

/* The closed contours of a layer, added to an empty region: ends that lie near are joined, contours
 * in others become holes. Entities of the layer that are not read are a warning. A layer that is
 * not there, an open contour, and what dea_region_check finds: one finding and DEA_E_DESIGN. asked:
 * where the input names the layer. */
dea_status dea_drawing_region(const struct dea_drawing *drawing, const char *layer,
                              struct dea_location asked, struct dea_region *out);

/* ---- for readers ---- */

dea_status dea_drawing_create(struct dea_context *ctx, const char *file,
                              const struct dea_drawing_settings *settings,
                              struct dea_drawing **out);
/* Number of a layer; layer_count where there is none of that name. */
size_t dea_drawing_find_layer(const struct dea_drawing *drawing, const char *name);
/* The same; it is added when it is new. */
dea_status dea_drawing_layer(struct dea_drawing *drawing, const char *name, size_t *layer);
/* m after n. */
struct dea_affine dea_affine_times(const struct dea_affine *m, const struct dea_affine *n);
/* What follows draws the path that is to be ended next, in the coordinates of the file: it adds the
 * first point where nothing is drawn yet, and goes on to the last one. */
dea_status dea_drawing_line_to(struct dea_drawing *drawing, const double to[2]);
/* By an arc of a bulge as that of struct dea_vertex. */
dea_status dea_drawing_bulge_to(struct dea_drawing *drawing, const double from[2], double bulge,
                                const double to[2]);
/* Along the points centre + first cos + second sin of an ellipse, from an angle over `sweep`. to:
 * the last one; NULL: as computed. */
struct dea_ellipse {
  double centre[2], first[2], second[2], from, sweep;
};
dea_status dea_drawing_ellipse_to(struct dea_drawing *drawing, const struct dea_ellipse *ellipse,
                                  const double to[2]);
/* Along a rational B-spline, from its knot of number `degree` to that of number `count`. */
enum { DEA_SPLINE_DEGREE_MAX = 25 };
struct dea_spline {
  size_t degree, count;
  const double (*point)[3]; // [count] weight times x and y, and the weight, > 0
  const double *knot;       // [count + degree + 1], ascending
};
dea_status dea_drawing_spline_to(struct dea_drawing *drawing, const struct dea_spline *spline);
/* The vertices since the last path are one on that layer; fewer than two are forgotten, as is a
 * last one of a closed path that is the first again. */
dea_status dea_drawing_end_path(struct dea_drawing *drawing, size_t layer, bool closed);
/* Vertices since the last path. */
size_t dea_drawing_open_vertices(const struct dea_drawing *drawing);
dea_status dea_drawing_skip(struct dea_drawing *drawing, size_t layer, const char *kind,
                            size_t line);
/* Notes on what the reader assumed: `assumed` of a unit that the file does not say, and curves. */
dea_status dea_drawing_add_notes(const struct dea_drawing *drawing, const char *assumed);
/* A finding at a line and DEA_E_DESIGN. */
dea_status dea_drawing_fault(const struct dea_drawing *drawing, size_t line, const char *format,
                             ...) DEA_PRINTF(3, 4);
