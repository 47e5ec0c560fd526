/* The steps of the reduction: functions of arrays. Definitions: docs/theory/reduction.md. */
#pragma once

#include "reduce/reduce.h"

// order_statistics.c ----------------------------------------------------------------------------

/* Value that a share (0 to 1) of the values lies below; they are reordered and none is NAN. NAN
 * without any. */
double dea_quantile(double *values, size_t count, double share);
/* Median of those that are numbers; values are reordered, numbers first. NAN without any. */
double dea_median(double *values, size_t count);
/* Standard deviation of normal noise with the same median of |value - centre|; values are
 * destroyed. NAN without any. */
double dea_spread(double *values, size_t count, double centre);
/* Median of the numbers among the 2 half + 1 values around each, fewer at the ends; half <=
 * DEA_RUNNING_HALF_MAX. out: [count], NAN where there is none. */
enum { DEA_RUNNING_HALF_MAX = 64 };
void dea_running_median(const double *values, size_t count, size_t half, double *out);

// filter.c ---------------------------------------------------------------------------------------

/* First-order low-pass forward and backward: no delay, and an amplitude of 1/sqrt(2) at cutoff_Hz.
 * NAN stays NAN. values: [channel->count], may be those of the channel. */
void dea_filter_apply(const struct dea_channel *channel, double cutoff_Hz, double *values);

/* How long before an edge it is seen [s]: no way back in time is without that. 0 for NAN. */
double dea_filter_reach(double cutoff_Hz);

/* Rise from 10 to 90 % of a step that was filtered [s]; 0 for NAN. */
double dea_filter_rise(double cutoff_Hz);

// plateau.c: what the voltage does ---------------------------------------------------------------

struct dea_voltage_scale {
  double largest_V, rest_V, noise_V;
  double low_V, high_V; // of all but the outermost thousandth of the samples
  double active_V;      // farther than this from rest_V is active
  double tolerance_V;   // of a plateau
};
/* Samples begin <= i < end that stay at one voltage. */
struct dea_plateau {
  size_t begin, end;
  double mean_V;
};

dea_status dea_voltage_scale_find(struct dea_context *ctx, const struct dea_channel *voltage,
                                  struct dea_voltage_scale *out);
/* Plateaus among samples begin <= i < end, in order. out: owned by the caller, NULL without. */
dea_status dea_plateaus_find(struct dea_context *ctx, const struct dea_channel *voltage,
                             size_t begin, size_t end, double tolerance_V, struct dea_plateau **out,
                             size_t *count);

// cycles.c ---------------------------------------------------------------------------------------

/* A time from begin_s to before end_s; NAN: there is none. */
struct dea_span {
  double begin_s, end_s;
};
struct dea_cycle_parts {
  struct dea_recorded_cycle cycle;
  struct dea_span rest, active, after;
  bool held;         // the voltage stays; else `active` is the time around its peak
  bool rises, falls; // from rest before `active`, to rest behind it
};

/* What became of a list of cycles. */
struct dea_cycle_list {
  struct dea_cycle_parts *parts; // [count] in time, owned; NULL without
  size_t count, capacity;
  size_t without; // cycles of the recording in which no active part was found
  size_t outside; // active parts that are in no cycle of the recording
};

/* Cycles of a recording, by its own list or by the voltage. The caller frees out->parts. */
dea_status dea_cycles_find(struct dea_context *ctx, const struct dea_recording *recording,
                           const struct dea_channel *voltage, const struct dea_voltage_scale *scale,
                           struct dea_cycle_list *out);
/* Sets under_voltage_s of cycles: the time before each one's end in which |voltage| is above
 * least_V. A sample counts until the next; one that is NAN as the one before. */
void dea_cycles_dose(const struct dea_channel *voltage, double least_V,
                     struct dea_reduced_cycle *cycles, size_t count);
/* The last share of a part that is held, all of one that is not. */
struct dea_span dea_span_settled(struct dea_span part, double settle, bool held);

// noise.c: means of correlated samples -----------------------------------------------------------

enum { DEA_NOISE_LAGS = 12, DEA_NOISE_BLOCKS = 48 };

/* Covariance of the means of `block` samples, at lags of 0, 1, ... blocks. */
struct dea_noise {
  size_t block;
  size_t lags; // that are not 0, beside lag 0
  double covariance[DEA_NOISE_LAGS + 1];
  double sample; // standard deviation of a sample; NAN: not known, as all the rest then
  double limit;  // beyond it from their median one of few samples is an outlier
};
/* Mean of the samples of a span without its outliers: beyond 6 spreads of the median, or beyond
 * `limit` (INFINITY: none) where there are fewer than 8. */
struct dea_window {
  double mean, time_s; // mean time of the valid samples; NAN when fewer than half are
  size_t count, all;   // valid samples, all samples
};

/* scratch: room for 2 x the samples of the span. */
struct dea_window dea_window_mean(const struct dea_channel *series, struct dea_span span,
                                  double limit, double *scratch);
/* Samples of the longest of the spans. */
size_t dea_window_longest(const struct dea_channel *series, const struct dea_span *spans,
                          size_t count);
/* Noise about a straight line in each of the spans. */
dea_status dea_noise_estimate(struct dea_context *ctx, const struct dea_channel *series,
                              const struct dea_span *spans, size_t count, struct dea_noise *out);
/* Variance of the mean of `count` samples in a row; NAN when the noise is not known. */
double dea_noise_of_mean(const struct dea_noise *noise, size_t count);

// times.c ----------------------------------------------------------------------------------------

/* Time from 10 to 90 % of the way between two levels within a span; NAN when it is not resolved:
 * fewer than two samples lie within, or the way is less than 10 times the noise. *end_s: when the
 * 90 % are reached (also of a rise that is not resolved), or NAN. */
double dea_rise_time(const struct dea_channel *series, struct dea_span span, double from, double to,
                     double noise, double *end_s);

// lag.c ------------------------------------------------------------------------------------------

/* How much later than the square of the voltage a series is most like it, and the size of the
 * correlation there and as the two are; NAN where there are too few samples. */
struct dea_lag {
  double lag_s, best, now;
};
/* To a 2048th of the span, or to two samples. */
dea_status dea_lag_find(struct dea_context *ctx, const struct dea_channel *voltage,
                        const struct dea_channel *series, struct dea_span span,
                        struct dea_lag *out);

// window_statistics.c ---------------------------------------------------------------------------

/* Values of all cycles for one series; noise: of rest and of active parts. values: [count] with a
 * step of `stride` bytes. */
dea_status dea_cycle_values(struct dea_context *ctx, const struct dea_channel *series,
                            const struct dea_cycle_parts *parts, size_t count, double settle,
                            struct dea_reduced_cycle *cycles, enum dea_reduced_kind kind,
                            double *noise);
/* Straight line through values at x: slope and its uncertainty (NAN with fewer than 2, 3). */
void dea_line_fit(const double *x, const double *y, size_t count, double *slope,
                  double *uncertainty);
/* Groups cycles of one step whose voltages differ by less than tolerance_V, and fills what can be
 * told of each level; tells the cycles theirs. out: owned by the caller. */
dea_status dea_levels_form(struct dea_context *ctx, struct dea_reduced_cycle *cycles, size_t count,
                           double tolerance_V, struct dea_voltage_level **out, size_t *level_count);

// saturation.c -----------------------------------------------------------------------------------

/* Takes the values back of cycles in one of whose parts the channel is at the end of its range for
 * more than 1 % of the samples; how many cycles. */
size_t dea_saturation_drop(const struct dea_channel *channel, const struct dea_cycle_parts *parts,
                           size_t count, enum dea_reduced_kind kind,
                           struct dea_reduced_cycle *cycles);

// edges.c, level.c: the frame in the picture -----------------------------------------------------

/* Finds the frame's inner edges in a profile: a step up on both sides. radius_m: of the frame, NAN
 * when it is not known. false: not in the picture. work: [3 points]. */
bool dea_frame_edges(const double *x_m, const double *z_m, size_t points, double radius_m,
                     double *work, double edges_m[2], double *height_m);

/* Fills what the frames say of their place. rest: [points] median of the frames at rest; moved:
 * that of the active ones less `rest`, NULL without. levelling->film_radius_m: NAN or from the
 * design. */
dea_status dea_levelling_find(struct dea_context *ctx, const double *x_m, const double *rest,
                              const double *moved, size_t points, struct dea_levelling *levelling);
/* Height of a frame's points on the frame above the levelling's line, median; NAN without. work:
 * [points]. */
double dea_levelling_offset(const struct dea_levelling *levelling, const double *x_m,
                            const double *z_m, size_t points, double *work);

// points.c ---------------------------------------------------------------------------------------

/* Takes line and offset off a frame; the support, invalid points and outliers become NAN. work:
 * [2 points]. Adds to the counts of the levelling. */
void dea_points_clean(struct dea_levelling *levelling, const double *x_m, const double *z_m,
                      size_t points, double offset_m, double *work, double *out);
/* Height at x: mean of what two straight lines say there, through the points within half a width on
 * each side, so that a kink at x is where it is. With fewer than 3 valid points on one side, one
 * line through all of them, or their mean. NAN when fewer than half of those are valid. */
double dea_points_value(const double *x_m, const double *z_m, size_t points, double x,
                        double width_m);

// shape.c ----------------------------------------------------------------------------------------

/* Slope inside the electrode over that outside of it: 0 flat, 1 a cone up to the centre. work:
 * [2 points]. NAN when there are not 5 points in each of the four parts. */
double dea_shape_index(const double *r_m, const double *z_m, size_t points,
                       double electrode_radius_m, double film_radius_m, double *work,
                       double *uncertainty);

// force_offset.c --------------------------------------------------------------------------------

/* Mean of the first samples before a time (at most the first half of that); NAN without. */
double dea_force_offset(const struct dea_channel *force, double before_s, double *scratch);

// discharges.c -----------------------------------------------------------------------------------

/* Number of standard deviations beyond which less than 0.1 of `samples` normal ones lie. */
double dea_discharge_threshold(size_t samples);
/* asked: what the edges are taken from; measured: NULL when it was not. */
dea_status dea_discharges_find(struct dea_context *ctx, const struct dea_channel *current,
                               const struct dea_channel *asked, const struct dea_channel *measured,
                               const struct dea_voltage_scale *scale, struct dea_discharge **out,
                               size_t *count, struct dea_current_limits *limits);

// charge.c ---------------------------------------------------------------------------------------

struct dea_charge_limits {
  double least_V;   // a step of the voltage that is more than its noise
  double settled_s; // behind a step the current that charges has gone
  double rest_V;
};

/* What the current says of each cycle: capacitance, leakage, charge (NAN while no capacitance is
 * known); parts, cycles: [count], with voltages.
 * voltage: measured, or asked where it was not. */
dea_status dea_charge_find(struct dea_context *ctx, const struct dea_channel *current,
                           const struct dea_channel *voltage, const struct dea_cycle_parts *parts,
                           size_t count, double settle, const struct dea_charge_limits *limits,
                           struct dea_reduced_cycle *cycles);
/* Mean capacitances of the levels, and the stretch that they tell of. */
void dea_charge_levels(struct dea_reduction *reduction);

// profiles.c -------------------------------------------------------------------------------------

/* Series of centre and tips from the frames and their levelling, into the reduction. offsets: of
 * each frame, owned by the caller; NULL without a profile or on failure. */
dea_status dea_profiles_reduce(struct dea_context *ctx, const struct dea_profiles *profiles,
                               const struct dea_cycle_parts *parts, size_t count,
                               struct dea_reduction *reduction, double **offsets);
/* Mean profiles of the levels against rest, and the shape of cycles and levels. */
dea_status dea_profiles_levels(struct dea_context *ctx, const struct dea_profiles *profiles,
                               const struct dea_cycle_parts *parts, const double *offsets,
                               struct dea_reduction *reduction);
