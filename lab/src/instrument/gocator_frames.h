/* Frames of a Gocator on one grid of positions and on the recording's clock. */
#pragma once

#include "base/context.h"
#include "instrument/gocator_parse.h"

/* Zero-initialise with offset_s = INFINITY. */
struct dea_gocator_frames {
  size_t points;
  double *x_m; // [points], rising evenly; owned
  double *z_m; // [points], of the last frame; owned
  unsigned source;
  bool other_grid; // a frame had other positions and was interpolated
  /* Computer's clock less the sensor's: the smallest seen until the first value that counts, since
   * what is sent may come late but never early. */
  double offset_s;
  bool anchored; // that value was there
  bool running;  // the first frame that counts was there
  double last_s; // time of the last frame
  uint64_t last_frame;
};

/* Takes the grid from a profile: its own positions, or for points the same number evenly between
 * the outermost. false, and DEA_OK, when it has no two valid points. DEA_E_MEMORY. */
dea_status dea_gocator_frames_begin(struct dea_context *ctx, struct dea_gocator_frames *frames,
                                    const struct dea_gdp_profiles *profiles, bool *begun);
/* Heights of profile k on the grid, into z_m: linear between two neighbouring valid points, NAN
 * elsewhere. */
void dea_gocator_frames_place(struct dea_gocator_frames *frames,
                              const struct dea_gdp_profiles *profiles, size_t k);
/* Sees a stamp that arrived at a time of the computer's clock, before it counts. */
void dea_gocator_frames_add(struct dea_gocator_frames *frames, const struct dea_gdp_stamp *stamp,
                            double arrived_s);
/* Time of a frame after start_s (of the computer's clock). stamp: NULL for one without, whose
 * arrival must do. false: it is from before that, or not after the last one. Adds the frames that
 * are missing before it to *lost. */
bool dea_gocator_frames_time(struct dea_gocator_frames *frames, const struct dea_gdp_stamp *stamp,
                             double arrived_s, double start_s, double *time_s, size_t *lost);
void dea_gocator_frames_free(struct dea_context *ctx, struct dea_gocator_frames *frames);
