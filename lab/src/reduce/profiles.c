#include "reduce/reduce_parts.h"

#include <string.h>

enum { MEDIAN_FRAMES = 200, AT_REST = 1, ACTIVE = 2 };

/* Times of the frames, for dea_channel_index. */
static struct dea_channel clock_of(const struct dea_profiles *profiles)
{
  return (struct dea_channel){.time_s = profiles->time_s, .count = profiles->count};
}

static void mark_span(const struct dea_channel *clock, struct dea_span span, unsigned char mark,
                      unsigned char *marks)
{
  if (span.end_s > span.begin_s) {
    size_t end = dea_channel_index(clock, span.end_s);
    for (size_t f = dea_channel_index(clock, span.begin_s); f < end; f++) {
      marks[f] = mark;
    }
  }
}

/* Marks frames of the later halves of rests, and of the settled active parts at high voltage; all
 * as at rest when there is no rest. How many are at rest. */
static size_t mark_frames(const struct dea_profiles *profiles, const struct dea_cycle_parts *parts,
                          size_t count, double settle, unsigned char *marks)
{
  struct dea_channel clock = clock_of(profiles);
  double largest_V = 0.0;
  size_t n = 0;
  for (size_t i = 0; i < count; i++) {
    largest_V = fmax(largest_V, fabs(parts[i].cycle.level_V));
  }
  for (size_t i = 0; i < count; i++) {
    mark_span(&clock, dea_span_settled(parts[i].rest, 0.5, true), AT_REST, marks);
    mark_span(&clock, dea_span_settled(parts[i].after, 0.5, true), AT_REST, marks);
    if (fabs(parts[i].cycle.level_V) >= 0.7 * largest_V) {
      mark_span(&clock, dea_span_settled(parts[i].active, settle, parts[i].held), ACTIVE, marks);
    }
  }
  for (size_t f = 0; f < profiles->count; f++) {
    n += marks[f] == AT_REST;
  }
  if (n == 0) {
    memset(marks, AT_REST, profiles->count);
    return profiles->count;
  }
  return n;
}

/* Median of at most MEDIAN_FRAMES frames with a mark, point by point; false without any. */
static bool median_profile(const struct dea_profiles *profiles, const unsigned char *marks,
                           unsigned char mark, double *out)
{
  size_t chosen[MEDIAN_FRAMES], n = 0, all = 0, seen = 0;
  double values[MEDIAN_FRAMES];
  for (size_t f = 0; f < profiles->count; f++) {
    all += marks[f] == mark;
  }
  for (size_t f = 0; f < profiles->count && n < MEDIAN_FRAMES; f++) {
    if (marks[f] == mark) {
      if (all <= MEDIAN_FRAMES || seen * MEDIAN_FRAMES / all >= n) {
        chosen[n++] = f;
      }
      seen++;
    }
  }
  for (size_t p = 0; p < profiles->points && n > 0; p++) {
    for (size_t k = 0; k < n; k++) {
      values[k] = profiles->z_m[chosen[k] * profiles->points + p];
    }
    out[p] = dea_median(values, n);
  }
  return n > 0;
}

/* Where the picture of the film lies; work: [2 points]. */
static dea_status find_levelling(struct dea_context *ctx, const struct dea_profiles *profiles,
                                 const unsigned char *marks, double *work,
                                 struct dea_levelling *levelling)
{
  double *rest = work, *moved = work + profiles->points;
  median_profile(profiles, marks, AT_REST, rest);
  bool moves = median_profile(profiles, marks, ACTIVE, moved);
  for (size_t p = 0; p < profiles->points && moves; p++) {
    moved[p] -= rest[p];
  }
  DEA_TRY(ctx, dea_levelling_find(ctx, profiles->x_m, rest, moves ? moved : NULL, profiles->points,
                                  levelling));
  double half = 0.5 * (levelling->edges_m[1] - levelling->edges_m[0]);
  double pitch =
      (profiles->x_m[profiles->points - 1] - profiles->x_m[0]) / (double)(profiles->points - 1);
  levelling->width_m = fmax(0.03 * half, 8.0 * pitch); // four points a side: one may be missing
  return DEA_OK;
}

/* Offset of every frame: its own by the frame, or that of all. */
static void find_offsets(const struct dea_profiles *profiles, double *work,
                         struct dea_levelling *levelling, double *offsets)
{
  double last = levelling->offset_m, sum = 0.0, squares = 0.0, n = 0.0;
  for (size_t f = 0; f < profiles->count; f++) {
    double own = levelling->by_frame ? dea_levelling_offset(levelling, profiles->x_m,
                                                            profiles->z_m + f * profiles->points,
                                                            profiles->points, work)
                                     : NAN;
    if (!isnan(own)) {
      last = own;
      n += 1.0;
      double off = own - levelling->offset_m;
      sum += off;
      squares += off * off;
    }
    offsets[f] = last;
  }
  levelling->offset_std_m = n > 1.0 ? sqrt(fmax(0.0, squares - sum * sum / n) / (n - 1.0)) : NAN;
  levelling->offset_m += n > 0.0 ? sum / n : 0.0;
}

/* Fills centre and tips of all frames. work: [3 points]. */
static dea_status fill_series(struct dea_context *ctx, const struct dea_profiles *profiles,
                              const double *offsets, double *work, struct dea_levelling *l,
                              double *centre, double *tip)
{
  size_t points = profiles->points, both = 0;
  double *z = work + 2 * points, tip_m = l->fibre_tip_radius_m;
  for (int pass = 0; pass < 2; pass++) { // the second with one side, when there never are both
    bool one = pass == 1;
    for (size_t f = 0; f < profiles->count; f++) {
      if (f % 256 == 0) {
        dea_progress(ctx, "frames", f, profiles->count);
        if (dea_interrupted(ctx)) {
          return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted");
        }
      }
      struct dea_levelling again = *l; // points are counted once
      dea_points_clean(one ? &again : l, profiles->x_m, profiles->z_m + f * points, points,
                       offsets[f], work, z);
      centre[f] = dea_points_value(profiles->x_m, z, points, l->centre_m, l->width_m);
      double left = dea_points_value(profiles->x_m, z, points, l->centre_m - tip_m, l->width_m);
      double right = dea_points_value(profiles->x_m, z, points, l->centre_m + tip_m, l->width_m);
      tip[f] = one && isnan(left) ? right : one && isnan(right) ? left : 0.5 * (left + right);
      both += isnan(tip[f]) ? 0U : 1U;
    }
    if (both > 0 || !(tip_m > 0.0)) {
      return DEA_OK;
    }
  }
  return both == 0 ? DEA_OK
                   : dea_finding_add(ctx, DEA_NOTE, (struct dea_location){"", 0, 0},
                                     "one side of the profiles has no points at the fibre tips: "
                                     "the displacement there is that of the other side");
}

/* Median of the values in the first rest that has enough frames, as long as a film that creeps is
 * still where it began. work: [profiles->count]. */
static double first_rest(const struct dea_profiles *profiles, const unsigned char *marks,
                         const double *values, double *work)
{
  enum { ENOUGH = 3 };
  size_t n = 0;
  for (size_t f = 0; f < profiles->count; f++) {
    if (marks[f] == AT_REST && !isnan(values[f])) {
      work[n++] = values[f];
    } else if (marks[f] != AT_REST && n >= ENOUGH) {
      break;
    }
  }
  return dea_median(work, n);
}

/* Makes the values a series of the reduction (takes them), against the first rest. */
static dea_status keep_series(struct dea_context *ctx, const struct dea_profiles *profiles,
                              const unsigned char *marks, const char *name, double *values,
                              double *work, struct dea_channel *out)
{
  double rest = first_rest(profiles, marks, values, work);
  bool any = !isnan(rest);
  for (size_t f = 0; f < profiles->count; f++) {
    any = any || !isnan(values[f]);
    values[f] -= isnan(rest) ? 0.0 : rest;
  }
  double *times = any ? dea_alloc(ctx, profiles->count, sizeof *times) : NULL;
  if (times == NULL) {
    dea_free(ctx, values);
    return any ? DEA_E_MEMORY : DEA_OK;
  }
  memcpy(times, profiles->time_s, profiles->count * sizeof *times);
  *out = (struct dea_channel){.kind = DEA_CHANNEL_DISPLACEMENT,
                              .unit = "m",
                              .filter_Hz = NAN,
                              .time_s = times,
                              .values = values,
                              .count = profiles->count};
  strncpy(out->name, name, sizeof out->name - 1);
  return DEA_OK;
}

dea_status dea_profiles_reduce(struct dea_context *ctx, const struct dea_profiles *profiles,
                               const struct dea_cycle_parts *parts, size_t count,
                               struct dea_reduction *reduction, double **offsets)
{
  size_t frames = profiles->count, points = profiles->points;
  struct dea_levelling *l = &reduction->levelling;
  unsigned char *marks = dea_alloc(ctx, frames, 1);
  double *work = dea_alloc(ctx, points > frames ? points : frames, 3 * sizeof *work);
  double *centre = dea_alloc(ctx, frames, sizeof *centre);
  double *tip = dea_alloc(ctx, frames, sizeof *tip);
  double *own = dea_alloc(ctx, frames, sizeof *own);
  bool capacity = marks != NULL && work != NULL && centre != NULL && tip != NULL && own != NULL;
  dea_status status = capacity ? DEA_OK : DEA_E_MEMORY;
  *offsets = NULL;
  if (status == DEA_OK) {
    l->frames = frames;
    l->frames_at_rest = mark_frames(profiles, parts, count, reduction->settle, marks);
    status = find_levelling(ctx, profiles, marks, work, l);
  }
  if (status == DEA_OK) {
    find_offsets(profiles, work, l, own);
    status = fill_series(ctx, profiles, own, work, l, centre, tip);
  }
  if (status == DEA_OK) {
    status = keep_series(ctx, profiles, marks, "centre", centre, work,
                         &reduction->series[DEA_REDUCED_CENTRE]);
    centre = NULL;
  }
  if (status == DEA_OK) {
    status = keep_series(ctx, profiles, marks, "fibre tips", tip, work,
                         &reduction->series[DEA_REDUCED_FIBRE_TIP]);
    tip = NULL;
  }
  if (status == DEA_OK) {
    *offsets = own;
    own = NULL;
  }
  dea_free(ctx, own);
  dea_free(ctx, tip);
  dea_free(ctx, centre);
  dea_free(ctx, work);
  dea_free(ctx, marks);
  return status;
}
