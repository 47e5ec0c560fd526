#include "reduce/reduce_parts.h"

#include <string.h>

/* What the steps hand on. */
struct job {
  struct dea_context *ctx;
  const struct dea_recording *recording;
  const struct dea_channel *asked, *measured; // NULL: not there
  struct dea_voltage_scale scale;
  struct dea_cycle_list list;
  double *offsets; // of the frames, owned
  struct dea_reduction *out;
};

#define NOTE(ctx, ...)                                                                             \
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){"", 0, 0}, __VA_ARGS__))

static dea_status copy_channel(struct dea_context *ctx, const struct dea_channel *channel,
                               struct dea_channel *out)
{
  *out = *channel;
  out->values = dea_alloc(ctx, channel->count, sizeof *out->values);
  out->time_s = NULL;
  if (out->values == NULL) {
    out->count = 0;
    return DEA_E_MEMORY;
  }
  if (channel->time_s != NULL) {
    out->time_s = dea_alloc(ctx, channel->count, sizeof *out->time_s);
    if (out->time_s == NULL) {
      return DEA_E_MEMORY; // what is there is freed with the reduction
    }
    memcpy(out->time_s, channel->time_s, channel->count * sizeof *out->time_s);
  }
  memcpy(out->values, channel->values, channel->count * sizeof *out->values);
  return DEA_OK;
}

// Cycles -----------------------------------------------------------------------------------------

/* Voltage of the cycles: measured where it was. */
static dea_status set_voltages(struct job *job)
{
  struct dea_reduction *r = job->out;
  struct dea_channel smooth = {0};
  const struct dea_channel *u = job->measured;
  double *scratch = NULL;
  dea_status status = DEA_OK;
  if (u != NULL) {
    scratch = dea_alloc(job->ctx, u->count, 2 * sizeof *scratch);
    status = scratch != NULL ? copy_channel(job->ctx, u, &smooth) : DEA_E_MEMORY;
  }
  if (u != NULL && status == DEA_OK) {
    dea_filter_apply(&smooth, smooth.filter_Hz, smooth.values);
  }
  for (size_t i = 0; i < job->list.count && status == DEA_OK; i++) {
    const struct dea_cycle_parts *part = &job->list.parts[i];
    struct dea_reduced_cycle *cycle = &r->cycles[i];
    struct dea_span span = dea_span_settled(part->active, r->settle, part->held);
    double measured = u != NULL ? dea_window_mean(&smooth, span, INFINITY, scratch).mean : NAN;
    cycle->cycle = part->cycle;
    cycle->voltage_V = isnan(measured) ? part->cycle.level_V : measured;
    cycle->shape = cycle->capacitance_F = cycle->leakage_A = cycle->charge_C = NAN;
    for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
      struct dea_cycle_value *v = &cycle->values[kind];
      v->rest = v->active = v->amplitude = v->uncertainty = NAN;
      v->rise_s = v->fall_s = v->creep = v->rest_before = NAN;
    }
  }
  dea_free(job->ctx, scratch);
  dea_free(job->ctx, smooth.values);
  dea_free(job->ctx, smooth.time_s);
  return status;
}

/* Cycles whose voltage is no number cannot be put into any order. */
static void drop_unknown(struct dea_cycle_list *list)
{
  size_t n = 0;
  for (size_t i = 0; i < list->count; i++) {
    if (isfinite(list->parts[i].cycle.level_V)) {
      list->parts[n++] = list->parts[i];
    }
  }
  list->without += list->count - n;
  list->count = n;
}

/* The scale of the asked voltage, or of the measured one. An asked one that is not that of the film
 * (the amplifier's input, or one that was not used) says nothing, and is forgotten: the film had
 * more than twice of it, or the other sign. One that the film does not reach is a breakdown. */
static dea_status find_scale(struct job *job)
{
  static const double offset_V = 50.0; // that a monitor may have
  struct dea_voltage_scale asked, measured;
  if (job->asked == NULL || job->measured == NULL) {
    return dea_voltage_scale_find(job->ctx, job->asked != NULL ? job->asked : job->measured,
                                  &job->scale);
  }
  DEA_TRY(job->ctx, dea_voltage_scale_find(job->ctx, job->asked, &asked));
  DEA_TRY(job->ctx, dea_voltage_scale_find(job->ctx, job->measured, &measured));
  job->scale = asked;
  // what swings beyond 0 in a breakdown is less than that
  const double swing_V = 0.25 * fmax(asked.largest_V, measured.largest_V);
  const double margin_V = fmax(offset_V, fmax(swing_V, 6.0 * measured.noise_V));
  if (measured.high_V <= 2.0 * fmax(asked.high_V, 0.0) + margin_V &&
      measured.low_V >= 2.0 * fmin(asked.low_V, 0.0) - margin_V) {
    return DEA_OK;
  }
  NOTE(job->ctx,
       "the asked voltage '%s' goes from %.4g to %.4g kV, the measured one '%s' from %.4g to %.4g "
       "kV: the measured one is taken for both (when the asked one is the amplifier's input, its "
       "per_unit was to be said in a mapping)",
       job->asked->name, 1e-3 * asked.low_V, 1e-3 * asked.high_V, job->measured->name,
       1e-3 * measured.low_V, 1e-3 * measured.high_V);
  job->asked = NULL;
  job->scale = measured;
  return DEA_OK;
}

static dea_status find_cycles(struct job *job)
{
  DEA_TRY(job->ctx, find_scale(job));
  const struct dea_channel *voltage = job->asked != NULL ? job->asked : job->measured;
  DEA_TRY(job->ctx, dea_cycles_find(job->ctx, job->recording, voltage, &job->scale, &job->list));
  drop_unknown(&job->list);
  struct dea_reduction *r = job->out;
  r->cycles = dea_alloc(job->ctx, job->list.count, sizeof *r->cycles);
  DEA_TRY_MEMORY(r->cycles != NULL);
  r->cycle_count = job->list.count;
  DEA_TRY(job->ctx, set_voltages(job));
  dea_cycles_dose(job->measured != NULL ? job->measured : voltage, job->scale.active_V, r->cycles,
                  r->cycle_count);
  return DEA_OK;
}

static dea_status note_cycles(const struct job *job)
{
  struct dea_context *ctx = job->ctx;
  const struct dea_recording *recording = job->recording;
  size_t peaks = 0;
  for (size_t i = 0; i < job->list.count; i++) {
    peaks += !job->list.parts[i].held;
  }
  if (job->list.count == 0) {
    NOTE(ctx, "the voltage stays at %.4g kV: there are no cycles, so no amplitudes are formed",
         1e-3 * job->scale.rest_V);
  }
  if (job->measured == NULL) {
    NOTE(ctx, "the voltage was not measured: the asked one is taken in its place");
  }
  if (peaks > 0) {
    NOTE(ctx,
         "%zu of %zu cycles hold no voltage: the time around the peak is taken for their "
         "active part, without rise, fall and creep",
         peaks, job->list.count);
  }
  if (job->list.without > 0) {
    NOTE(ctx, "%zu of %zu cycles of the recording are left out: no active part was found in them",
         job->list.without, recording->cycle_count);
  }
  if (job->list.outside > 0) {
    NOTE(ctx, "%zu active part%s left out: in no completed cycle of the recording",
         job->list.outside, job->list.outside == 1 ? " is" : "s are");
  }
  if (!recording->complete && recording->ended[0] != '\0') {
    NOTE(ctx, "the recording is not complete: %s", recording->ended);
  }
  return DEA_OK;
}

// Profiles ---------------------------------------------------------------------------------------

static bool profiles_usable(const struct dea_profiles *p)
{
  if (p->points < 16 || p->count == 0) {
    return false;
  }
  for (size_t i = 0; i < p->points; i++) {
    if (!isfinite(p->x_m[i]) || (i > 0 && !(p->x_m[i] > p->x_m[i - 1]))) {
      return false;
    }
  }
  return true;
}

static dea_status note_profiles(struct dea_context *ctx, const struct dea_levelling *l)
{
  if (!l->by_frame) {
    NOTE(ctx, "no frame on both sides of the profiles: tilt by the film's outer part at rest, "
              "centre where most moves; a drift of the sensor's height is not taken off");
  }
  if (l->beside_m > 0.15 * l->film_radius_m) {
    NOTE(ctx,
         "the frame is %.3g mm apart in the profiles, the film's diameter is %.3g mm: the "
         "line passes about %.2g mm beside the centre",
         1e3 * (l->edges_m[1] - l->edges_m[0]), 2e3 * l->film_radius_m, 1e3 * l->beside_m);
  }
  if (isnan(l->fibre_tip_radius_m)) {
    NOTE(ctx, "no displacement at the fibre tips: their radius is not known (give --tip-radius, "
              "or a design with fibres)");
  }
  if (isnan(l->electrode_radius_m)) {
    NOTE(ctx, "no shape: the electrode's radius is not known (give --electrode-radius, or a "
              "design)");
  }
  if (20 * (l->invalid + l->outliers) > l->total) {
    NOTE(ctx, "%.2g %% of the points on the film are invalid and %.2g %% outliers",
         100.0 * (double)l->invalid / (double)l->total,
         100.0 * (double)l->outliers / (double)l->total);
  }
  return DEA_OK;
}

static dea_status reduce_profiles(struct job *job)
{
  const struct dea_profiles *profiles = &job->recording->profiles;
  if (!profiles_usable(profiles)) {
    if (profiles->count > 0) {
      NOTE(job->ctx, "the profiles are left out: they need 16 points or more with rising x");
    }
    return DEA_OK;
  }
  DEA_TRY(job->ctx, dea_profiles_reduce(job->ctx, profiles, job->list.parts, job->list.count,
                                        job->out, &job->offsets));
  return note_profiles(job->ctx, &job->out->levelling);
}

// Channels ---------------------------------------------------------------------------------------

/* Takes the first mean at rest off a series, so that it tells displacements. */
static void against_rest(struct dea_channel *series, const struct dea_cycle_parts *first,
                         double settle, double *scratch)
{
  double rest = NAN;
  if (first != NULL) {
    rest = dea_window_mean(series, dea_span_settled(first->rest, settle, true), INFINITY, scratch)
               .mean;
  }
  for (size_t i = 0; i < series->count && isnan(rest); i++) {
    rest = series->values[i];
  }
  for (size_t i = 0; i < series->count; i++) {
    series->values[i] -= rest;
  }
}

static dea_status reduce_force(struct job *job, double offset_N, double *scratch)
{
  struct dea_reduction *r = job->out;
  struct dea_channel *force = &r->series[DEA_REDUCED_FORCE];
  const struct dea_cycle_parts *first = job->list.count > 0 ? &job->list.parts[0] : NULL;
  bool given = !isnan(offset_N);
  double before_s = first != NULL ? first->rest.end_s : NAN;
  r->force_offset_N = given ? offset_N : dea_force_offset(force, before_s, scratch);
  if (isnan(r->force_offset_N)) {
    return DEA_OK;
  }
  for (size_t i = 0; i < force->count; i++) {
    force->values[i] -= r->force_offset_N;
  }
  if (first != NULL) {
    struct dea_span rest = dea_span_settled(first->rest, r->settle, true);
    r->preload_N = dea_window_mean(force, rest, INFINITY, scratch).mean;
  }
  if (!given) {
    NOTE(job->ctx,
         "the force cell's offset is the mean of its first readings, %.4g mN: a preload "
         "that was there from the start cannot be told (give --force-offset)",
         1e3 * r->force_offset_N);
  }
  return DEA_OK;
}

/* True when noise that the converter resolves stops at an end: there are runs of one value there.
 * scratch: [count]. */
static bool is_clipped(const struct dea_channel *series, double end, double range, double *scratch)
{
  const double *z = series->values;
  double step = INFINITY;
  size_t at = 0, n = 0;
  for (size_t i = 1; i + 1 < series->count; i++) {
    double off = fabs(z[i] - z[i - 1]), bend = z[i - 1] - 2.0 * z[i] + z[i + 1];
    at += z[i - 1] == end && z[i] == end ? 1U : 0U;
    step = off > 0.0 && off < step ? off : step;
    if (!isnan(bend) && z[i - 1] != end && z[i] != end && z[i + 1] != end) {
      scratch[n++] = bend;
    }
  }
  double noise = dea_spread(scratch, n, 0.0) / sqrt(6.0);
  return 100 * at > series->count && noise > fmax(3.0 * step, 1e-6 * range);
}

/* Samples of a series (a copy) at the end of their sensor's range become NAN: what is beyond was
 * not measured. Only where the range is not known (saturation.c). scratch: [count]. */
static dea_status remove_clipped(struct dea_context *ctx, struct dea_channel *series,
                                 double *scratch)
{
  double ends[2] = {INFINITY, -INFINITY};
  if (series->lowest < series->highest) {
    return DEA_OK;
  }
  for (size_t i = 0; i < series->count; i++) {
    ends[0] = fmin(ends[0], series->values[i]); // not NAN
    ends[1] = fmax(ends[1], series->values[i]);
  }
  for (int e = 0; e < 2; e++) {
    if (!is_clipped(series, ends[e], ends[1] - ends[0], scratch)) {
      continue;
    }
    size_t out = 0;
    for (size_t i = 0; i < series->count; i++) {
      if (series->values[i] == ends[e]) {
        series->values[i] = NAN;
        out++;
      }
    }
    const struct dea_channel_meaning *m = &dea_channel_meanings[series->kind];
    NOTE(ctx,
         "'%s' is at %.6g %s, the end of its range, in %.2g %% of its samples: these are left "
         "out, what is beyond was not measured",
         series->name, m->factor * ends[e], m->display_unit,
         100.0 * (double)out / (double)series->count);
  }
  return DEA_OK;
}

static dea_status reduce_channels(struct job *job, const struct dea_reduce_options *options)
{
  static const struct {
    enum dea_channel_kind channel;
    enum dea_reduced_kind kind;
  } taken[] = {{DEA_CHANNEL_DISPLACEMENT, DEA_REDUCED_DISPLACEMENT},
               {DEA_CHANNEL_FORCE, DEA_REDUCED_FORCE}};
  struct dea_reduction *r = job->out;
  for (size_t k = 0; k < sizeof taken / sizeof taken[0]; k++) {
    const struct dea_channel *channel = dea_recording_kind(job->recording, taken[k].channel);
    struct dea_channel *series = &r->series[taken[k].kind];
    if (channel == NULL || channel->count == 0) {
      continue;
    }
    DEA_TRY(job->ctx, copy_channel(job->ctx, channel, series));
    double *scratch = dea_alloc(job->ctx, channel->count, 2 * sizeof *scratch);
    DEA_TRY_MEMORY(scratch != NULL);
    dea_status status = remove_clipped(job->ctx, series, scratch);
    dea_filter_apply(series, series->filter_Hz, series->values);
    if (status == DEA_OK && taken[k].kind == DEA_REDUCED_FORCE) {
      status = reduce_force(job, options->force_offset_N, scratch);
    } else if (status == DEA_OK) {
      against_rest(series, job->list.count > 0 ? &job->list.parts[0] : NULL, r->settle, scratch);
    }
    dea_free(job->ctx, scratch);
    DEA_TRY(job->ctx, status);
  }
  return DEA_OK;
}

/* Without the cycles in which a channel was at its end. */
static dea_status drop_saturated(struct job *job, enum dea_reduced_kind kind)
{
  bool force = kind == DEA_REDUCED_FORCE;
  const struct dea_channel *channel =
      dea_recording_kind(job->recording, force ? DEA_CHANNEL_FORCE : DEA_CHANNEL_DISPLACEMENT);
  if ((!force && kind != DEA_REDUCED_DISPLACEMENT) || channel == NULL) {
    return DEA_OK;
  }
  size_t dropped =
      dea_saturation_drop(channel, job->list.parts, job->out->cycle_count, kind, job->out->cycles);
  if (dropped > 0) {
    NOTE(job->ctx,
         "channel '%s' is at the end of its range in %zu of %zu cycles, which are left out of it",
         channel->name, dropped, job->out->cycle_count);
  }
  return DEA_OK;
}

/* A sensor of which nothing came of any cycle would be missing in silence. */
static dea_status note_without_amplitude(const struct job *job, enum dea_reduced_kind kind)
{
  const struct dea_reduction *r = job->out;
  for (size_t i = 0; i < r->cycle_count; i++) {
    if (!isnan(r->cycles[i].values[kind].amplitude)) {
      return DEA_OK;
    }
  }
  NOTE(
      job->ctx,
      "no amplitude of '%s' is formed: the last %.3g %% of the parts of a cycle hold no sample, or "
      "too few valid ones (a larger --settle takes more)",
      r->series[kind].name, 100.0 * r->settle);
  return DEA_OK;
}

enum { LAG_CYCLES = 40 };

/* From the begin of so many cycles about the one of the largest voltage to their end. */
static struct dea_span cycles_of_lag(const struct job *job)
{
  const struct dea_reduction *r = job->out;
  size_t largest = 0;
  for (size_t i = 1; i < r->cycle_count; i++) {
    largest = fabs(r->cycles[i].voltage_V) > fabs(r->cycles[largest].voltage_V) ? i : largest;
  }
  size_t begin = largest > LAG_CYCLES / 2 ? largest - LAG_CYCLES / 2 : 0;
  size_t end = begin + LAG_CYCLES < r->cycle_count ? begin + LAG_CYCLES : r->cycle_count;
  const struct dea_cycle_parts *first = &job->list.parts[begin], *last = &job->list.parts[end - 1];
  return (struct dea_span){isnan(first->rest.begin_s) ? first->active.begin_s : first->rest.begin_s,
                           isnan(last->after.end_s) ? last->active.end_s : last->after.end_s};
}

/* Two programs' clocks may have been put together wrongly, which amplitudes do not tell. */
static dea_status check_clock(const struct job *job, enum dea_reduced_kind kind)
{
  const struct dea_channel *voltage = job->measured != NULL ? job->measured : job->asked;
  const struct dea_channel *series = &job->out->series[kind];
  const struct dea_location nowhere = {.file = ""};
  struct dea_lag lag;
  if (kind == DEA_REDUCED_FIBRE_TIP) { // of the sensor that sees the centre
    return DEA_OK;
  }
  DEA_TRY(job->ctx, dea_lag_find(job->ctx, voltage, series, cycles_of_lag(job), &lag));
  const bool before = lag.lag_s < 0;
  if (!(lag.best > 0.8) || !(lag.best - lag.now > 0.1)) {
    return DEA_OK;
  }
  return dea_finding_add(job->ctx, DEA_WARNING, nowhere,
                         "'%s' is most like the square of the voltage %.3g s %s (correlation %.2f; "
                         "%.2f as it is): %s",
                         series->name, fabs(lag.lag_s), before ? "earlier" : "later", lag.best,
                         lag.now,
                         before ? "no film moves before its voltage, so their clocks do not agree"
                                : "the film lags so far, or their clocks do not agree");
}

/* Says where rise and fall are those of the channel's own filter. */
static dea_status note_filter(const struct job *job, enum dea_reduced_kind kind)
{
  const struct dea_reduction *r = job->out;
  const struct dea_channel *series = &r->series[kind];
  double own_s = dea_filter_rise(series->filter_Hz), shortest_s = INFINITY;
  for (size_t l = 0; l < r->level_count; l++) {
    shortest_s = fmin(shortest_s, fmin(r->levels[l].rise_s[kind], r->levels[l].fall_s[kind]));
  }
  if (shortest_s <= 1.1 * own_s) {
    NOTE(job->ctx,
         "'%s' rises or falls within %.3g ms, which is its filter of %.4g Hz (%.3g ms of a step): "
         "the film is faster than that; give it a higher one, or none, for these times",
         series->name, 1e3 * shortest_s, series->filter_Hz, 1e3 * own_s);
  }
  return DEA_OK;
}

static dea_status reduce_cycles(struct job *job)
{
  struct dea_reduction *r = job->out;
  bool unknown = false;
  for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
    if (r->series[kind].count > 0 && r->cycle_count > 0) {
      DEA_TRY(job->ctx,
              dea_cycle_values(job->ctx, &r->series[kind], job->list.parts, r->cycle_count,
                               r->settle, r->cycles, (enum dea_reduced_kind)kind, &r->noise[kind]));
      DEA_TRY(job->ctx, note_without_amplitude(job, (enum dea_reduced_kind)kind));
      DEA_TRY(job->ctx, check_clock(job, (enum dea_reduced_kind)kind));
      unknown = unknown || isnan(r->noise[kind]);
      DEA_TRY(job->ctx, drop_saturated(job, (enum dea_reduced_kind)kind));
    }
  }
  if (unknown) {
    NOTE(job->ctx, "the parts of a cycle hold too few samples to tell their noise: uncertainties "
                   "of single cycles are not known");
  }
  DEA_TRY(job->ctx, dea_levels_form(job->ctx, r->cycles, r->cycle_count, 0.5 * job->scale.active_V,
                                    &r->levels, &r->level_count));
  for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
    DEA_TRY(job->ctx, note_filter(job, (enum dea_reduced_kind)kind));
  }
  return job->offsets == NULL || r->level_count == 0
             ? DEA_OK
             : dea_profiles_levels(job->ctx, &job->recording->profiles, job->list.parts,
                                   job->offsets, r);
}

/* Into the cycles that they began in; both are in time. */
static void count_discharges(struct dea_reduction *r)
{
  for (size_t d = 0, k = 0; d < r->discharge_count; d++) {
    const struct dea_discharge *own = &r->discharges[d];
    while (k < r->cycle_count && r->cycles[k].cycle.end_s <= own->time_s) {
      k++;
    }
    if (k < r->cycle_count && r->cycles[k].cycle.start_s <= own->time_s) {
      r->cycles[k].discharges += own->kind == DEA_DISCHARGE;
      r->cycles[k].breakdowns += own->kind == DEA_BREAKDOWN;
    }
  }
}

static dea_status reduce_current(struct job *job)
{
  const struct dea_channel *current = dea_recording_kind(job->recording, DEA_CHANNEL_CURRENT);
  struct dea_reduction *r = job->out;
  if (current == NULL || current->count < 8) {
    return DEA_OK;
  }
  DEA_TRY(job->ctx,
          dea_discharges_find(job->ctx, current, job->asked != NULL ? job->asked : job->measured,
                              job->asked != NULL ? job->measured : NULL, &job->scale,
                              &r->discharges, &r->discharge_count, &r->current));
  count_discharges(r);
  const struct dea_charge_limits limits = {job->scale.active_V, 2 * r->current.blind_s,
                                           job->scale.rest_V};
  DEA_TRY(job->ctx,
          dea_charge_find(job->ctx, current, job->measured != NULL ? job->measured : job->asked,
                          job->list.parts, r->cycle_count, r->settle, &limits, r->cycles));
  dea_charge_levels(r);
  return DEA_OK;
}

// The whole --------------------------------------------------------------------------------------

static void read_options(const struct dea_reduce_options *options, struct dea_reduction *out)
{
  out->levelling = (struct dea_levelling){.centre_m = NAN,
                                          .tilt_rad = NAN,
                                          .offset_m = NAN,
                                          .offset_std_m = NAN,
                                          .frame_height_m = NAN,
                                          .edges_m = {NAN, NAN},
                                          .beside_m = NAN,
                                          .width_m = NAN,
                                          .fibre_tip_radius_m = options->fibre_tip_radius_m,
                                          .film_radius_m = options->film_radius_m,
                                          .electrode_radius_m = options->electrode_radius_m};
  out->settle = options->settle > 0.0 && options->settle <= 1.0 ? options->settle : 0.2;
  out->force_offset_N = out->preload_N = NAN;
  out->current = (struct dea_current_limits){.noise_A = NAN, .factor = NAN, .blind_s = NAN};
  for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
    out->noise[kind] = NAN;
  }
}

/* Of several channels of one kind the first is taken. */
static dea_status note_others(const struct job *job)
{
  const struct dea_recording *r = job->recording;
  for (int kind = 0; kind < DEA_CHANNEL_OTHER; kind++) {
    const struct dea_channel *first = dea_recording_kind(r, (enum dea_channel_kind)kind);
    for (size_t c = 0; c < r->channel_count; c++) {
      if ((int)r->channels[c].kind == kind && &r->channels[c] != first) {
        NOTE(job->ctx, "channel '%s' is left out: '%s' is the %s (the first one of a recording is)",
             r->channels[c].name, first->name, dea_channel_names[kind]);
      }
    }
  }
  return DEA_OK;
}

static dea_status note_no_sensor(const struct job *job)
{
  bool any = job->recording->profiles.count > 0;
  for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
    any = any || job->out->series[kind].count > 0;
  }
  if (!any) {
    NOTE(job->ctx, "the recording has neither displacements nor forces: of its cycles only what "
                   "voltage and current tell is formed");
  }
  return DEA_OK;
}

static dea_status reduce(struct job *job, const struct dea_reduce_options *options)
{
  DEA_TRY(job->ctx, note_others(job));
  DEA_TRY(job->ctx, find_cycles(job));
  DEA_TRY(job->ctx, note_cycles(job));
  DEA_TRY(job->ctx, reduce_profiles(job));
  DEA_TRY(job->ctx, reduce_channels(job, options));
  DEA_TRY(job->ctx, note_no_sensor(job));
  DEA_TRY(job->ctx, reduce_cycles(job));
  return reduce_current(job);
}

/* A channel of a kind that has samples. */
static const struct dea_channel *filled(const struct dea_recording *recording,
                                        enum dea_channel_kind kind)
{
  const struct dea_channel *channel = dea_recording_kind(recording, kind);
  return channel != NULL && channel->count > 0 ? channel : NULL;
}

dea_status dea_reduce(struct dea_context *ctx, const struct dea_recording *recording,
                      const struct dea_reduce_options *options, struct dea_reduction **out)
{
  static const struct dea_reduce_options none = {NAN, NAN, NAN, 0.0, NAN};
  struct job job = {.ctx = ctx,
                    .recording = recording,
                    .asked = filled(recording, DEA_CHANNEL_COMMAND),
                    .measured = filled(recording, DEA_CHANNEL_VOLTAGE)};
  *out = NULL;
  options = options != NULL ? options : &none;
  if (job.asked == NULL && job.measured == NULL) {
    return dea_fail(ctx, DEA_E_IO,
                    "%s%shas no voltage, asked or measured, so that nothing can be told of it",
                    recording->file != NULL ? recording->file : "",
                    recording->file != NULL && recording->file[0] != '\0' ? " " : "the recording ");
  }
  job.out = dea_alloc(ctx, 1, sizeof *job.out);
  DEA_TRY_MEMORY(job.out != NULL);
  read_options(options, job.out);
  dea_status status = reduce(&job, options);
  dea_free(ctx, job.list.parts);
  dea_free(ctx, job.offsets);
  DEA_TRY_ELSE(ctx, status, dea_reduction_destroy(ctx, job.out));
  *out = job.out;
  return DEA_OK;
}

void dea_reduction_destroy(struct dea_context *ctx, struct dea_reduction *reduction)
{
  if (reduction == NULL) {
    return;
  }
  for (size_t l = 0; l < reduction->level_count; l++) {
    dea_free(ctx, reduction->levels[l].z_m);
    dea_free(ctx, reduction->levels[l].z_std_m);
  }
  for (int kind = 0; kind < DEA_REDUCED_KINDS; kind++) {
    dea_free(ctx, reduction->series[kind].time_s);
    dea_free(ctx, reduction->series[kind].values);
  }
  dea_free(ctx, reduction->radius_m);
  dea_free(ctx, reduction->cycles);
  dea_free(ctx, reduction->levels);
  dea_free(ctx, reduction->discharges);
  dea_free(ctx, reduction);
}
