/* Reduction: from a recording to the quantities that a paper shows.
 *
 * One file a step: levelling of profiles, displacement of centre and fibre tip, shape, cycles,
 * statistics, times, force, discharges. Each is a pure function of arrays, so that it can be
 * checked alone; reduce.c puts them together. What is subtracted, fitted or left out is in the
 * result, so that it can be printed. */
#pragma once

#include "recording/recording.h"

/* How a quantity of a cycle is formed; see docs/theory/reduction.md. NAN: not formed. */
struct dea_cycle_value {
  double rest, active;   // at the active part's time, by the rests on both sides; its last part
  double amplitude;      // active - rest
  double uncertainty;    // 1 sigma of the amplitude, from the noise of all parts
  double rise_s, fall_s; // 10 to 90 % of the amplitude; NAN: not resolved
  double creep;          // change within the active part, after its rise
  double rest_before;    // mean of the last part of the rest before
  double shared;         // covariance with the amplitude of the next cycle, whose rest it shares
};

/* What can be formed of a cycle. */
enum dea_reduced_kind {
  DEA_REDUCED_CENTRE,       // centre of the profile [m]
  DEA_REDUCED_FIBRE_TIP,    // mean of both sides at the fibre tips [m]
  DEA_REDUCED_DISPLACEMENT, // point laser [m]
  DEA_REDUCED_FORCE,        // [N]
  DEA_REDUCED_KINDS
};

struct dea_reduced_cycle {
  struct dea_recorded_cycle cycle;
  double voltage_V;       // measured in the active part, or asked when it was not measured
  double under_voltage_s; // that the film was under voltage from the recording's begin to its end
  struct dea_cycle_value values[DEA_REDUCED_KINDS]; // NAN: not measured
  double shape; // of the profile: 0 flat over the electrode, 1 a cone; NAN
  // of the current; NAN where that cannot be told
  double capacitance_F; // by the charge of its two edges
  double leakage_A;     // that flows while the voltage is held, against rest
  double charge_C;      // brought to the film by edges, from the recording's begin to its end
  size_t discharges, breakdowns; // that began in it
  size_t level;                  // of the reduction's, that it belongs to
};

/* All cycles of one voltage and step, and their statistics: mean, standard deviation from cycle to
 * cycle, and standard uncertainty of the mean. */
struct dea_voltage_level {
  double voltage_V;
  size_t step, cycles;
  double mean[DEA_REDUCED_KINDS], std[DEA_REDUCED_KINDS], uncertainty[DEA_REDUCED_KINDS];
  double noise[DEA_REDUCED_KINDS]; // uncertainty of one cycle's amplitude, root mean square
  double rise_s[DEA_REDUCED_KINDS], fall_s[DEA_REDUCED_KINDS]; // medians
  double creep[DEA_REDUCED_KINDS];                             // mean change within the active part
  double drift[DEA_REDUCED_KINDS]; // of the rest, a cycle, by a straight line
  double drift_uncertainty[DEA_REDUCED_KINDS];
  double shape, shape_uncertainty;
  double capacitance_F, capacitance_std_F; // mean and scatter from cycle to cycle; NAN
  double sensed_stretch; // of the electrode by it, against the voltage nearest to 0; NAN
  double *z_m, *z_std_m; // [points] mean profile against rest, and scatter; owned; NULL without
};

enum dea_discharge_kind { DEA_DISCHARGE, DEA_BREAKDOWN };
/* A spike of the current that no change of voltage explains, or its end: a current that stays. */
struct dea_discharge {
  enum dea_discharge_kind kind;
  double time_s, voltage_V, peak_A, charge_C;
};

/* What is subtracted from the frames, and what the line laser sees of the frame. A height z at x
 * becomes z - offset of its frame - tan(tilt) (x - centre). NAN: not known. */
struct dea_levelling {
  double centre_m;           // of the film, on the sensor's x
  double tilt_rad, offset_m; // of the line through both sides of the frame, mean of all frames
  double offset_std_m;       // of the frames' own offsets
  double frame_height_m;     // of the frame above the film; NAN: not in the picture
  double edges_m[2];         // inner edges of the frame, on the sensor's x
  double beside_m;           // how far the line passes beside the film's centre, from its chord
  bool by_frame;             // false: by the film's outer part
  double fibre_tip_radius_m, film_radius_m, electrode_radius_m; // that were used
  double width_m;                  // that centre and tips are averaged over
  size_t frames, frames_at_rest;   // those that the levelling is fitted to
  size_t invalid, outliers, total; // points on the film
};

/* Of the current: what a discharge has to exceed, and how long it is not looked for after a corner
 * of the voltage. */
struct dea_current_limits {
  double noise_A, factor; // a discharge is beyond factor * noise_A
  double blind_s;
  size_t samples; // looked at
};

struct dea_reduction {
  struct dea_levelling levelling;
  double *radius_m; // [points] of the profiles of the levels, signed; owned; NULL without
  size_t points;
  struct dea_reduced_cycle *cycles; // owned
  size_t cycle_count;
  struct dea_voltage_level *levels; // owned, ascending voltage
  size_t level_count;
  struct dea_discharge *discharges; // owned
  size_t discharge_count;
  double force_offset_N, preload_N; // unloaded cell, force at rest above it; NAN
  double noise[DEA_REDUCED_KINDS];  // 1 sigma of a sample at rest; NAN: not measured
  struct dea_current_limits current;
  struct dea_channel series[DEA_REDUCED_KINDS]; // in time, filtered, against the first rest; owned
  double settle;                                // that was used
};

struct dea_reduce_options {
  double fibre_tip_radius_m, film_radius_m, electrode_radius_m; // NAN: not known
  double settle;         // last share of each part of a cycle that is averaged; 0: 0.2
  double force_offset_N; // reading of the unloaded cell; NAN: the first samples' mean
};

/* options: NULL for the defaults. out: owned by the caller, NULL on failure. What could not be
 * formed and why becomes notes. DEA_E_IO for a recording without a voltage. */
dea_status dea_reduce(struct dea_context *ctx, const struct dea_recording *recording,
                      const struct dea_reduce_options *options, struct dea_reduction **out);
void dea_reduction_destroy(struct dea_context *ctx, struct dea_reduction *reduction);
