#include "instrument/gocator_frames.h"

#include <math.h>

/* Of more missing frames than that the sensor was started anew, and the number means nothing. */
static const uint64_t missing_most = 1000000;
/* Positions that differ by less than this share of their spacing are the same. */
static const double same_position = 1e-6;

/* Outermost positions; false unless there are two. */
static bool ends_of(const struct dea_gdp_profiles *profiles, double *first_m, double *last_m)
{
  *first_m = INFINITY;
  *last_m = -INFINITY;
  for (size_t i = 0; i < profiles->width; i++) {
    double x_m, z_m;
    bool valid = dea_gdp_point(profiles, 0, i, &x_m, &z_m);
    if (valid || profiles->uniform) {
      *first_m = fmin(*first_m, x_m);
      *last_m = fmax(*last_m, x_m);
    }
  }
  return *last_m > *first_m;
}

dea_status dea_gocator_frames_begin(struct dea_context *ctx, struct dea_gocator_frames *frames,
                                    const struct dea_gdp_profiles *profiles, bool *begun)
{
  double first_m, last_m;
  *begun = ends_of(profiles, &first_m, &last_m);
  if (!*begun) {
    return DEA_OK;
  }
  size_t points = profiles->width;
  frames->x_m = dea_alloc(ctx, points, sizeof *frames->x_m);
  frames->z_m = dea_alloc(ctx, points, sizeof *frames->z_m);
  DEA_TRY_MEMORY(frames->x_m != NULL && frames->z_m != NULL);
  for (size_t i = 0; i < points; i++) {
    frames->x_m[i] = first_m + (last_m - first_m) * (double)i / (double)(points - 1);
  }
  frames->points = points;
  frames->source = profiles->source;
  return DEA_OK;
}

/* Whether a uniform profile has just the positions of the grid. */
static bool same_grid(const struct dea_gocator_frames *frames,
                      const struct dea_gdp_profiles *profiles)
{
  size_t n = frames->points;
  if (!profiles->uniform || profiles->width != n) {
    return false;
  }
  double limit_m = same_position * profiles->x_scale_m;
  double last_m = profiles->x_offset_m + (double)(n - 1) * profiles->x_scale_m;
  return fabs(profiles->x_offset_m - frames->x_m[0]) < limit_m &&
         fabs(last_m - frames->x_m[n - 1]) < limit_m * (double)n;
}

void dea_gocator_frames_place(struct dea_gocator_frames *frames,
                              const struct dea_gdp_profiles *profiles, size_t k)
{
  size_t at = 0, n = frames->points;
  double x0_m = -INFINITY, z0_m = NAN; // the point before; z NAN when it is not valid
  bool same = same_grid(frames, profiles);
  frames->other_grid = frames->other_grid || (!same && profiles->uniform);
  for (size_t i = 0; i < profiles->width && at < n; i++) {
    double x_m, z_m;
    bool valid = dea_gdp_point(profiles, k, i, &x_m, &z_m);
    z_m = valid ? z_m : NAN;
    if (same) {
      frames->z_m[at++] = z_m;
      continue;
    }
    if (x_m <= x0_m || (!valid && !profiles->uniform)) {
      z0_m = valid ? z0_m : NAN; // one that goes back is left out, a missing one parts the line
      continue;
    }
    double near_m = same_position * (x_m - x0_m < INFINITY ? x_m - x0_m : profiles->x_scale_m);
    for (; at < n && frames->x_m[at] < x_m - near_m; at++) {
      frames->z_m[at] = z0_m + (z_m - z0_m) * (frames->x_m[at] - x0_m) / (x_m - x0_m);
    }
    for (; at < n && frames->x_m[at] <= x_m + near_m; at++) {
      frames->z_m[at] = z_m;
    }
    x0_m = x_m;
    z0_m = z_m;
  }
  for (; at < n; at++) {
    frames->z_m[at] = NAN;
  }
}

void dea_gocator_frames_add(struct dea_gocator_frames *frames, const struct dea_gdp_stamp *stamp,
                            double arrived_s)
{
  if (!frames->anchored) {
    frames->offset_s = fmin(frames->offset_s, arrived_s - 1e-6 * (double)stamp->time_us);
  }
}

bool dea_gocator_frames_time(struct dea_gocator_frames *frames, const struct dea_gdp_stamp *stamp,
                             double arrived_s, double start_s, double *time_s, size_t *lost)
{
  uint64_t frame = stamp != NULL ? stamp->frame : frames->last_frame + 1;
  double clock_s = stamp != NULL ? 1e-6 * (double)stamp->time_us + frames->offset_s : arrived_s;
  *time_s = clock_s - start_s;
  if (!frames->running) {
    if (*time_s < 0) {
      return false;
    }
    frames->running = true;
  } else if (!(*time_s > frames->last_s)) {
    ++*lost;
    return false;
  } else if (frame > frames->last_frame + 1 && frame - frames->last_frame < missing_most) {
    *lost += (size_t)(frame - frames->last_frame - 1);
  }
  frames->anchored = frames->anchored || stamp != NULL;
  frames->last_s = *time_s;
  frames->last_frame = frame;
  return true;
}

void dea_gocator_frames_free(struct dea_context *ctx, struct dea_gocator_frames *frames)
{
  dea_free(ctx, frames->x_m);
  dea_free(ctx, frames->z_m);
}
