/* Drawings from files: contours by layer, which become regions. DXF and SVG. */
#ifndef DEA_GEOMETRY_DRAWING_H
#define DEA_GEOMETRY_DRAWING_H

#include "geometry/region.h"

/* 0 in a member: its default. */
struct dea_drawing_settings {
  double join_m;       // ends of lines nearer than this are joined; default 1 um
  double flatten_m;    // largest distance of curves from the lines that they become; default 0.1 um
  size_t vertices_max; // of a drawing; default DEA_DRAWING_VERTICES_MAX
};

enum {
  DEA_DRAWING_VERTICES_MAX = 4000000,
  DEA_DRAWING_BYTES_MAX = 500000000,
  DEA_DRAWING_LAYERS_MAX = 1000,
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
  bool unit_is_known; // false: the file does not say it, and unit_m was assumed
};

/* Reads a file by its ending, .dxf or .svg; settings: NULL for the defaults. What is wrong with it
 * is a finding at its line and DEA_E_DESIGN; DEA_E_IO when it cannot be read. Lengths in a file
 * without a unit are mm (DXF) or 1/96 inch (SVG), which is a note. out: owned by the caller. */
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
/* Number of a layer, which is added when it is new. */
dea_status dea_drawing_layer(struct dea_drawing *drawing, const char *name, size_t *layer);
/* A vertex [m] of the path that is to be ended next. */
dea_status dea_drawing_add_vertex(struct dea_drawing *drawing, double x_m, double y_m, double bulge,
                                  size_t line);
/* The vertices since the last path are one on that layer; fewer than two are forgotten. */
dea_status dea_drawing_end_path(struct dea_drawing *drawing, size_t layer, bool closed);
/* Vertices since the last path. */
size_t dea_drawing_open_vertices(const struct dea_drawing *drawing);
dea_status dea_drawing_skip(struct dea_drawing *drawing, size_t layer, const char *kind,
                            size_t line);
/* A finding at a line and DEA_E_DESIGN. */
dea_status dea_drawing_fault(const struct dea_drawing *drawing, size_t line, const char *format,
                             ...) DEA_PRINTF(3, 4);

#endif
