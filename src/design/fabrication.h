/* What the workshop needs beside the actuator itself: section `fabrication` of a design file.
 * Reasons for the defaults: docs/fabrication.md. A design of the general form has all but the angle
 * of leads, which each electrode says, the holder, and tolerances beyond those of thickness and
 * pre-stretch: these are 0. */
#pragma once

#include "base/value.h"

enum { DEA_DESIGN_COPIES_MAX = 1000 };

struct dea_fabrication {
  struct dea_quantity kerf_m;            // width of the cut
  struct dea_quantity minimum_feature_m; // of webs, slots and holes, where they are cut
  struct dea_quantity copies;
  struct {
    struct dea_quantity width_m, height_m;
    struct dea_quantity margin_m; // without parts, at its edges
    struct dea_quantity gap_m;    // between parts
  } sheet;
  struct {
    struct dea_inplane_length margin; // beyond the frame's outer edge, for the stretcher's grips
  } blank;                            // film as it is cut
  struct {
    struct dea_inplane_length width, pad_diameter;
    struct dea_quantity angle_rad; // of the top electrode's; absent: halfway between two fibres
  } leads;
  struct {
    struct dea_quantity width_m;          // of the ring
    struct dea_quantity contact_window_m; // diameter of the hole over the lower pad; 0: none
  } ring;
  struct dea_quantity frame_gap_m; // between parts and a frame that holds the film until it is cut
  struct {
    struct dea_quantity anchor_m; // how far a held fibre lies on the frame
    struct dea_quantity tab_width_m, tab_length_m;
  } holder; // of the fibres
  struct dea_inplane_length mark_diameter, grid_spacing;
  struct dea_quantity cure_temperature_K, cure_time_s;
  struct {
    struct dea_quantity thickness;              // of the film, relative
    struct dea_quantity pre_stretch;            // absolute
    struct dea_inplane_length electrode, fibre; // diameter; place of the tip
    struct dea_quantity frame_m;                // inner diameter
  } tolerance;
};
