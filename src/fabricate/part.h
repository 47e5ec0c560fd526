/* A part as it is cut from a sheet: contours, lines that are only drawn, and words on it. Lengths
 * in metres, of the finished part: the kerf comes in where tool paths are written. */
#pragma once

#include "base/arena.h"
#include "design/design.h"
#include "geometry/contour.h"

// X(name, what it is, colour of the DXF, colour of the screen), in the order of the work
#define DEA_LAYER_LIST(X)                                                                          \
  X(MARK, "mark: drawn or engraved, not cut", 3, 0x008000)                                         \
  X(CUT_INNER, "cut: holes, before the outer edge", 5, 0x0000ff)                                   \
  X(CUT_OUTER, "cut: outer edge, last", 1, 0xff0000)                                               \
  X(NOTE, "note: words and the edge of the sheet, for people", 8, 0x808080)

enum dea_layer {
#define DEA_LAYER_ENUM(name, meaning, dxf, screen) DEA_LAYER_##name,
  DEA_LAYER_LIST(DEA_LAYER_ENUM)
#undef DEA_LAYER_ENUM
      DEA_LAYER_COUNT
};

struct dea_part_contour {
  enum dea_layer layer;
  bool circle;             // of two half circles
  struct dea_contour path; // lent
};

enum { DEA_PART_NAME_SIZE = 64, DEA_PART_TITLE_SIZE = 128, DEA_PART_MEASURES_MAX = 16 };

enum dea_part_kind {
  DEA_PART_BLANK,  // of a ply that a frame holds
  DEA_PART_BOTTOM, // stencil of that face of a ply
  DEA_PART_TOP,
  DEA_PART_OUTLINE, // of a ply, or its pieces in their holder
  DEA_PART_BODY,
  DEA_PART_FRAME,
  DEA_PART_TEMPLATE,
};

/* A dimension for drawings. */
enum dea_measure_kind { DEA_MEASURE_DIAMETER, DEA_MEASURE_LENGTH };
struct dea_part_measure {
  enum dea_measure_kind kind;
  double from_m[2], to_m[2]; // ends; of a diameter: at opposite places of the circle
  const char *what;          // "electrode"
};

struct dea_part {
  struct dea_arena *memory; // of the contours, lent; its `failed` says that memory was short
  enum dea_part_kind kind;
  size_t of;                       // number of the ply or body
  char name[DEA_PART_NAME_SIZE];   // of the files: "frame"
  char title[DEA_PART_TITLE_SIZE]; // "Pre-stretch frame"
  enum dea_film_state state;
  bool flat;            // no film of the device is stretched: both states are the same
  double stretch[2][2]; // of its film, from unstretched to stretched; 0: it has none, or several
  size_t quantity;      // of it for one actuator
  bool paper;           // printed at 1:1, one for all copies, not cut
  bool mirrored;        // seen from below
  struct dea_part_contour *contour;
  size_t contour_count, contour_room;
  const char *word; // on layer MARK, in the middle at x = 0; NULL: none
  double word_y_m, word_height_m;
  struct dea_part_measure measure[DEA_PART_MEASURES_MAX];
  size_t measure_count;
};

/* ---- making one ---- */

/* Copies a contour. */
void dea_part_add(struct dea_part *part, enum dea_layer layer, const struct dea_contour *contour);
void dea_part_measure(struct dea_part *part, enum dea_measure_kind kind, double x0_m, double y0_m,
                      double x1_m, double y1_m, const char *what);

/* ---- looking at one ---- */

/* "stretched", "unstretched", or "flat": the film that its lengths are of. */
const char *dea_part_film_name(const struct dea_part *part);
/* "seen from below" or "seen from above". */
const char *dea_part_seen(const struct dea_part *part);

/* {x min, y min, x max, y max} of all contours. */
void dea_part_box(const struct dea_part *part, double box_m[4]);
/* Material of the finished part: outer edges less holes. */
double dea_part_area_m2(const struct dea_part *part);
/* Length of all contours of a layer. */
double dea_part_length_m(const struct dea_part *part, enum dea_layer layer);

/* Adds a finding for each thing that cannot be cut: webs, slots and holes narrower than `feature`,
 * contours that cross or lie outside of the part, pieces that a cutter of that kerf cannot follow.
 * Fails only for memory. */
dea_status dea_part_check(const struct dea_part *part, double feature_m, double kerf_m);
