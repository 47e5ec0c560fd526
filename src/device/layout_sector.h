/* The sector of a layout between two of its lines of symmetry, of which the whole is mirrored
 * copies (docs/theory/devices.md, "Symmetry"). */
#pragma once

#include "device/layout.h"

enum { DEA_LAYOUT_FOLD_MAX = 4 }; // a narrower sector has worse elements at its tip

struct dea_layout_sector {
  int fold; // lines of symmetry that are used, through the centre; 0: the sector is the whole
  double centre_m[2];
  double angle_rad; // of the first of its two sides; the other one is pi/fold further
};

/* That of the most lines that everything has that acts on the layout or holds it: also supports,
 * forces, springs, and what bodies are made to do. What a body may do beyond that symmetry it does
 * not do in the sector. */
struct dea_layout_sector dea_layout_sector_of(const struct dea_layout *layout);
/* How often it lies in the whole. */
size_t dea_layout_sector_copies(const struct dea_layout_sector *sector);
/* The motion of a copy, 0 <= number < copies; 0: the sector itself. */
struct dea_motion dea_layout_sector_copy(const struct dea_layout_sector *sector, size_t number);
/* A vector v in a copy; z stays. out may be v. */
void dea_layout_sector_turn(const struct dea_motion *copy, const double v[2], double out[2]);
/* Adds the sector itself to an empty region, so far from the centre. */
void dea_layout_sector_region(const struct dea_layout_sector *sector, double reach_m,
                              struct dea_region *out);
/* Components of a body (bits as in struct dea_layout_body) that keep the symmetry. */
int dea_layout_sector_keeps(const struct dea_layout_sector *sector);
/* What the sides hold of a place that lies on them within near_m: components (bits 1, 2) along the
 * axes Q (rows), 0 elsewhere. */
int dea_layout_sector_holds(const struct dea_layout_sector *sector, const double x_m[2],
                            double near_m, double Q[9]);
