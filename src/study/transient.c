/* Study "transient": a waveform is played to the model (docs/theory/time.md). Steps as long as the
 * tolerance allows, none across a corner of the waveform; a jump is a step of no length. */
#include "base/schema.h"
#include "study/force.h"
#include "study/observe.h"
#include "study/study.h"
#include "study/time_stepper.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static const char study_name[] = "transient";

// Keys -------------------------------------------------------------------------------------------

#define AT(member) offsetof(struct settings, member)

/* Settings of compute.transient. */
struct settings {
  struct dea_quantity until_s;        // absent: the waveform's end
  struct dea_quantity tolerance;      // error of a step over the largest motion so far
  struct dea_quantity longest_step_s; // absent: a twentieth of a cycle
  struct dea_quantity interval_s;     // of points that are kept; absent: every step
  struct dea_choice indent;           // 0: no, 1: the indenter of `force` first
  struct dea_choice inertia;          // 0: no, 1: yes
  struct dea_quantity rho_inf;        // spectral radius of generalised alpha
};

static const struct dea_field fields[] = {
    DEA_NUMBER_ROW("until", AT(until_s), "s", "30 s",
                   "time at which the study ends; after its end a waveform stays where it is",
                   .above_min = true, .max = 1e9, .absent_text = "the waveform's end"),
    DEA_NUMBER_ROW("tolerance", AT(tolerance), "1", "0.0001",
                   "error of one step over the largest motion so far", .min = 1e-10, .max = 0.1,
                   .default_text = "0.0001"),
    DEA_NUMBER_ROW("longest_step", AT(longest_step_s), "s", "50 ms", "longest step in time",
                   .above_min = true, .max = 1e9, .absent_text = "a twentieth of a cycle"),
    DEA_NUMBER_ROW("interval", AT(interval_s), "s", "10 ms",
                   "time between points that are kept; those at corners of the waveform always are",
                   .max = 1e9, .absent_text = "as a figure needs them"),
    DEA_CHOICE_ROW("indent", AT(indent), dea_no_yes, "yes",
                   "whether the tip of compute.force is pressed in first, to its first depth or "
                   "preload, and held there",
                   .alias = "press", .default_text = "no"),
    DEA_CHOICE_ROW("inertia", AT(inertia), dea_no_yes, "yes",
                   "whether mass matters; without, each moment is an equilibrium",
                   .default_text = "no"),
    DEA_NUMBER_ROW(
        "rho_inf", AT(rho_inf), "1", "0.5",
        "spectral radius of generalised alpha at high frequencies: 1 damps nothing, 0 most",
        .min = 0, .max = 1, .default_text = "0.8"),
};

static bool asked(const struct dea_design *design)
{
  return design->drive.waveform != NULL || dea_parts_in_time(design->parts);
}

/* The first channel with a voltage or a waveform of its own; NULL: none. */
static const struct dea_parts_channel *own_channel(const struct dea_design *design)
{
  const struct dea_parts *parts = design->parts;
  for (size_t i = 0; parts != NULL && i < parts->channel_count; i++) {
    const struct dea_parts_channel *channel = &parts->channels[i];
    if (channel->waveform != NULL ||
        (channel->voltage_V.si != 0 && !isnan(channel->voltage_V.si))) {
      return channel;
    }
  }
  return NULL;
}

/* What lies between supply and film is known of one voltage only. */
static dea_status check_sources(struct dea_context *ctx, const struct dea_design *design)
{
  const struct dea_parts_channel *own = asked(design) ? own_channel(design) : NULL;
  const struct dea_quantity *R = &design->drive.series_resistance_ohm;
  const struct dea_quantity *limit = &design->drive.current_limit_A;
  const struct dea_quantity *open = &design->drive.disconnect_s;
  const struct dea_quantity *which = R->si > 0 ? R : limit->origin != DEA_ABSENT ? limit : open;
  if (own == NULL || (!(R->si > 0) && which->origin == DEA_ABSENT)) {
    return DEA_OK;
  }
  return dea_finding_add(
      ctx, DEA_ERROR, which->location,
      "%s: in time the channel '%.60s' has a %s of its own, and sources of "
      "several channels are ideal: without resistance and limit of the current, and "
      "always connected",
      which == R       ? "series_resistance"
      : which == limit ? "current_limit"
                       : "disconnect",
      own->name.text, own->waveform != NULL ? "waveform" : "voltage");
}

static dea_status check(struct dea_context *ctx, const struct dea_design *design,
                        const struct dea_settings *given)
{
  const struct settings *settings = given->values;
  DEA_TRY(ctx, check_sources(ctx, design));
  if (design->drive.section == NULL && !dea_parts_in_time(design->parts) && given->written) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, settings->until_s.location,
                                 "transient: without drive.waveform nothing happens in time"));
  }
  if (settings->indent.value == 1 && dea_force_stops(design) == 0) {
    return dea_finding_add(ctx, DEA_ERROR, settings->indent.location,
                           "indent: how far? compute.force.depth or compute.force.preload says it");
  }
  return DEA_OK;
}

static const struct dea_design_section section = {
    .record = {"transient", "study of what happens in time, made when there is a waveform (drive)",
               fields, DEA_COUNT(fields)},
    .size = sizeof(struct settings),
    .check = check};

static const struct settings *settings_of(const struct dea_design *design)
{
  return dea_design_settings(design, &section)->values;
}

// Study ------------------------------------------------------------------------------------------

enum { POINTS_MAX = 40000 }; // of a curve; beyond, every second point goes

/* A source, and what it plays. */
struct source {
  const struct dea_waveform *waveform; // NULL: none
  struct dea_waveform *limited;        // the same as a slow source plays it; owned, NULL: as it is
  double constant_V;                   // added to it
  double now_V, corner_s;              // at this time; that of the next corner
};

struct playback {
  struct dea_study_job job; // with a model of its own
  /* Of the supply, [0], and of the channels of the layout, [source_count]; as what follows in the
   * memory of what is seen: whether a channel has one, and voltages at the end of a step. */
  struct source *sources;
  size_t source_count;
  bool *own, any_own;
  double *next_V;
  struct dea_curve *curve;
  enum dea_fields_at fields; // of electrodes with a sheet resistance, at points that are kept
  double until_s, tolerance, longest_s, interval_s;
  double time_s;
  double next_s;                 // length of the next step
  double last_V;                 // on the film
  struct dea_load_point pending; // the last one, if it is not kept yet
  bool has_pending;
  double largest[4]; // voltage, motion, current, z so far
  /* Monitors and channels (study/observe.h) of the last step, room for those of the pending point,
   * and the largest so far. */
  struct dea_monitor_set seen;
  struct dea_monitor_values *spare;
  double *seen_largest; // [seen.count]
  double disconnect_s;  // INFINITY: never
  bool inertia;
  size_t reported; // thousandths of the time that progress was told of
};

/* Every second point and the last one, and from now on half as many. */
static void thin(struct playback *p)
{
  struct dea_curve *curve = p->curve;
  size_t count = curve->count;
  for (size_t i = 1; 2 * i < count; i++) {
    curve->points[i] = curve->points[2 * i];
  }
  curve->points[count / 2] = curve->points[count - 1];
  curve->count = count / 2 + 1;
  p->interval_s = fmax(2 * p->interval_s, 2 * p->time_s / POINTS_MAX);
}

static dea_status add(struct dea_context *ctx, struct playback *p,
                      const struct dea_load_point *point)
{
  p->has_pending = false;
  DEA_TRY(ctx, dea_curve_add_point(ctx, p->curve, point));
  if (p->curve->count >= POINTS_MAX) {
    thin(p);
  }
  return DEA_OK;
}

/* How far b is from the line from a to c at its time, over a scale that grows with what is seen. */
static double off_line(double share, double a, double b, double c, double *largest)
{
  *largest = fmax(*largest, fabs(c));
  return *largest > 0 ? fabs(a + share * (c - a) - b) / *largest : 0;
}

/* Whether a figure without the pending point would show another line from the last one that is kept
 * to this one. */
static bool would_be_missed(struct playback *p, const struct dea_load_point *point)
{
  static const double visible = 0.01;
  const struct dea_load_point *a = &p->curve->points[p->curve->count - 1], *b = &p->pending;
  double span_s = point->time_s - a->time_s;
  double share = span_s > 0 ? (b->time_s - a->time_s) / span_s : 0;
  double off[4] = {
      off_line(share, a->voltage_V, b->voltage_V, point->voltage_V, &p->largest[0]),
      off_line(share, a->electrode_stretch - 1, b->electrode_stretch - 1,
               point->electrode_stretch - 1, &p->largest[1]),
      off_line(share, a->current_A, b->current_A, point->current_A, &p->largest[2]),
      off_line(share, a->centre_z_m, b->centre_z_m, point->centre_z_m, &p->largest[3]), // or NAN
  };
  double most = fmax(fmax(off[0], off[1]), fmax(off[2], off[3]));
  for (size_t i = 0; i < p->seen.count && p->has_pending; i++) {
    double first = p->curve->points[0].monitors->at[i].value;
    most = fmax(most,
                off_line(share, a->monitors->at[i].value - first, b->monitors->at[i].value - first,
                         point->monitors->at[i].value - first, &p->seen_largest[i]));
  }
  return p->has_pending && most > visible;
}

/* Where the film has which voltage at the last point of the curve, which the model is at. */
static dea_status add_fields(struct dea_context *ctx, struct playback *p)
{
  const size_t last = p->curve->count - 1;
  char name[DEA_NAME_SIZE];
  struct dea_field_mesh *mesh;
  snprintf(name, sizeof name, "%.50s_%s", p->job.type->name, study_name);
  DEA_TRY(ctx, dea_model_fields(ctx, p->job.type, p->job.model, DEA_FIELDS_SURFACE, &mesh));
  return dea_result_add_surface(ctx, p->job.result, name, last, p->curve->points[last].voltage_V,
                                mesh);
}

/* Takes a point to the curve if it is needed there; corner: in any case. */
static dea_status keep(struct dea_context *ctx, struct playback *p, struct dea_load_point *point,
                       bool corner)
{
  struct dea_curve *curve = p->curve;
  point->time_s = p->time_s; // without the rounding of many small steps
  p->last_V = point->voltage_V;
  DEA_TRY(ctx, dea_monitor_set_read(ctx, &p->seen, p->job.type, p->job.model, false, point));
  if (curve->count == 0) {
    return add(ctx, p, point);
  }
  DEA_TRY(ctx, p->interval_s == 0 && would_be_missed(p, point) ? add(ctx, p, &p->pending) : DEA_OK);
  double waited_s = p->time_s - curve->points[curve->count - 1].time_s;
  if (corner || waited_s >= (p->interval_s > 0 ? p->interval_s : p->longest_s) * (1 - 1e-9)) {
    const bool ends = p->time_s >= p->until_s;
    DEA_TRY(ctx, add(ctx, p, point));
    return p->fields == DEA_FIELDS_ALL || (ends && p->fields == DEA_FIELDS_LAST)
               ? add_fields(ctx, p)
               : DEA_OK;
  }
  struct dea_monitor_values *seen = p->seen.values; // stays with the point
  p->seen.values = p->spare;
  p->spare = seen;
  p->pending = *point;
  p->has_pending = true;
  return DEA_OK;
}

/* The last point stays however it ends. */
static dea_status flush(struct dea_context *ctx, struct playback *p)
{
  return p->has_pending ? add(ctx, p, &p->pending) : DEA_OK;
}

/* Why there is no going on, with the event where it ended. */
static dea_status stop(struct dea_context *ctx, struct playback *p, dea_status status)
{
  char reason[512];
  snprintf(reason, sizeof reason, "%s", dea_context_message(ctx));
  if (status != DEA_E_NO_EQUILIBRIUM) {
    return dea_fail(ctx, status, "at %.6g s, %.4g kV: %s", p->time_s, 1e-3 * p->last_V, reason);
  }
  const struct dea_curve *curve = p->curve;
  DEA_TRY(ctx, flush(ctx, p));
  if (curve->count > 0) {
    const struct dea_event event = {DEA_EVENT_PULL_IN, curve->points[curve->count - 1]};
    DEA_TRY(ctx, dea_curve_add_event(ctx, p->curve, &event));
  }
  return dea_fail(ctx, status,
                  "pull-in at %.6g s, %.4g kV on the film: no equilibrium follows the last one%s",
                  p->time_s, 1e-3 * p->last_V,
                  p->inertia ? "" : "; compute.transient.inertia: yes lets it move on");
}

// Sources ----------------------------------------------------------------------------------------

static const double rounding = 1e-14; // of the time: corners that are as close are one

static const struct dea_waveform *played(const struct source *source)
{
  return source->limited != NULL ? source->limited : source->waveform;
}

/* Voltages at a time into next_V; end: of a step there, before what jumps at it. */
static void find_voltages(struct playback *p, double time_s, bool end)
{
  for (size_t k = 0; k < p->source_count; k++) {
    const struct source *source = &p->sources[k];
    const struct dea_waveform *waveform = played(source);
    bool before = end && source->corner_s <= time_s * (1 + rounding);
    p->next_V[k] = source->constant_V + (waveform == NULL ? 0
                                         : before         ? dea_waveform_before(waveform, time_s)
                                                          : dea_waveform_value(waveform, time_s));
  }
}

/* Voltages at next_V, which a step has gone to. */
static void set_voltages(struct playback *p)
{
  for (size_t k = 0; k < p->source_count; k++) {
    p->sources[k].now_V = p->next_V[k];
  }
}

static bool voltages_jump(const struct playback *p)
{
  bool any = false;
  for (size_t k = 0; k < p->source_count; k++) {
    any = any || p->next_V[k] != p->sources[k].now_V;
  }
  return any;
}

/* The next corner of any source. */
static double find_corner(struct playback *p)
{
  double first_s = p->time_s < p->disconnect_s ? p->disconnect_s : INFINITY;
  for (size_t k = 0; k < p->source_count; k++) {
    struct source *source = &p->sources[k];
    const struct dea_waveform *waveform = played(source);
    source->corner_s = waveform != NULL ? dea_waveform_corner(waveform, p->time_s) : INFINITY;
    first_s = fmin(first_s, source->corner_s);
  }
  return first_s;
}

static void set_step(const struct playback *p, struct dea_time_step *step)
{
  step->source_voltage_V = p->next_V[0];
  step->disconnected = p->time_s >= p->disconnect_s;
  step->own_V = p->any_own ? p->next_V : NULL;
}

/* `set` of a stepper. */
static void set_step_to(void *user, double to_s, bool last, struct dea_time_step *step)
{
  find_voltages(user, to_s, last);
  set_step(user, step);
}

// Steps ------------------------------------------------------------------------------------------

/* Sources jump to next_V here. */
static dea_status jump(struct dea_context *ctx, struct playback *p)
{
  struct dea_time_step step = {.length_s = 0};
  struct dea_load_point point;
  double error;
  set_step(p, &step);
  dea_status status = p->job.type->advance(ctx, p->job.model, &step, &point, &error);
  if (status != DEA_OK) {
    return status == DEA_E_MEMORY ? status : stop(ctx, p, status);
  }
  p->job.type->accept(p->job.model);
  set_voltages(p);
  return keep(ctx, p, &point, true);
}

/* One step that the tolerance allows, at most to `end`. */
static dea_status one_step(struct dea_context *ctx, struct playback *p, double end)
{
  // Circuits may be that fast; where an equilibrium is lost need not be known as closely.
  const double longest = fmin(p->longest_s, p->until_s);
  struct dea_stepper stepper = {
      p->next_s, p->longest_s, 1e-13 * longest, 1e-6 * longest, p->tolerance, set_step_to, p};
  struct dea_load_point point;
  bool last;
  dea_status status =
      dea_stepper_step(ctx, &stepper, p->job.type, p->job.model, end, &p->time_s, &last, &point);
  p->next_s = stepper.next_s;
  if (status != DEA_OK) {
    return dea_status_ends(status) ? status : stop(ctx, p, status);
  }
  set_voltages(p);
  return keep(ctx, p, &point, last);
}

static void report_progress(struct dea_context *ctx, struct playback *p)
{
  static const size_t whole = 100;
  size_t done = p->time_s < p->until_s ? (size_t)((double)whole * p->time_s / p->until_s) : whole;
  if (done > p->reported) {
    dea_study_progress(ctx, &p->job, "transient (%)", done, whole);
    p->reported = done;
  }
}

static dea_status play(struct dea_context *ctx, struct playback *p)
{
  while (p->time_s < p->until_s) {
    find_voltages(p, p->time_s, false);
    DEA_TRY(ctx, voltages_jump(p) ? jump(ctx, p) : DEA_OK);
    double end = fmin(find_corner(p), p->until_s);
    p->next_s = fmin(p->longest_s, 0.1 * (end - p->time_s));
    p->time_s = end - p->time_s <= rounding * end ? end : p->time_s;
    while (p->time_s < end) {
      if (dea_interrupted_anywhere(ctx)) {
        DEA_TRY(ctx, flush(ctx, p));
        return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted at %.6g s; %zu points are kept",
                        p->time_s, p->curve->count);
      }
      DEA_TRY(ctx, one_step(ctx, p, end));
      report_progress(ctx, p);
    }
  }
  report_progress(ctx, p);
  return DEA_OK;
}

/* Room for the sources of a device. */
static dea_status build_sources(struct dea_context *ctx, const struct dea_result *result,
                                struct playback *p)
{
  const struct dea_parts *parts = result->design->parts;
  size_t count = parts != NULL ? result->device->layout->channel_count : 1;
  struct dea_arena *memory = &p->seen.memory;
  p->sources = dea_arena_alloc(memory, count, sizeof *p->sources);
  p->own = dea_arena_alloc(memory, count, sizeof *p->own);
  p->next_V = dea_arena_alloc(memory, count, sizeof *p->next_V);
  DEA_TRY(ctx, dea_arena_status(memory));
  p->source_count = count;
  p->sources[0].waveform = result->design->drive.waveform;
  for (size_t i = 0; parts != NULL && i < parts->channel_count; i++) {
    const struct dea_parts_channel *from = &parts->channels[i];
    size_t k = dea_layout_find_channel(result->device->layout, from->name.text);
    if (from->waveform != NULL && k < count) {
      const double V = from->voltage_V.si; // also before the start
      p->sources[k] = (struct source){.waveform = from->waveform, .constant_V = V, .now_V = V};
      p->own[k] = p->any_own = true;
    }
  }
  return DEA_OK;
}

/* Waveforms of the sources, end and steps. */
static dea_status prepare(struct dea_context *ctx, const struct dea_design *design,
                          struct playback *p)
{
  const struct dea_quantity *slew = &design->drive.slew_limit_V_per_s;
  const struct dea_quantity *longest = &settings_of(design)->longest_step_s;
  const struct dea_quantity *until = &settings_of(design)->until_s;
  struct dea_wave_cycle cycle;
  double end_s = 0, usual_s = INFINITY;
  for (size_t k = 0; k < p->source_count; k++) {
    const struct dea_waveform *waveform = p->sources[k].waveform;
    if (waveform != NULL) {
      end_s = fmax(end_s, waveform->end_s);
      usual_s = fmin(usual_s, waveform->longest_step_s);
      if (dea_waveform_cycle(waveform, 0, &cycle)) {
        usual_s = fmin(usual_s, 0.05 * (cycle.end_s - cycle.start_s));
      }
    }
  }
  p->until_s = until->origin != DEA_ABSENT ? until->si : end_s;
  for (size_t k = 0; k < p->source_count && slew->origin != DEA_ABSENT; k++) {
    if (p->sources[k].waveform != NULL) {
      DEA_TRY(ctx, dea_waveform_limit(ctx, p->sources[k].waveform, slew->si, p->until_s,
                                      &p->sources[k].limited));
    }
  }
  usual_s = fmin(usual_s, 0.02 * p->until_s);
  p->longest_s = longest->origin != DEA_ABSENT ? longest->si : usual_s;
  p->tolerance = settings_of(design)->tolerance.si;
  const struct dea_quantity *disconnect = &design->drive.disconnect_s;
  p->disconnect_s = disconnect->origin != DEA_ABSENT ? disconnect->si : INFINITY;
  const struct dea_quantity *interval = &settings_of(design)->interval_s;
  p->interval_s = interval->origin != DEA_ABSENT ? interval->si : 0;
  return DEA_OK;
}

/* Presses the tip in, where that is asked for. */
static dea_status indent(struct dea_context *ctx, const struct dea_design *design,
                         struct playback *p)
{
  if (settings_of(design)->indent.value == 0) {
    return DEA_OK;
  }
  if (p->job.type->indent == NULL) {
    return dea_finding_add(
        ctx, DEA_NOTE, (struct dea_location){0},
        "model %s does not support tips: compute.transient.indent is without effect there",
        p->job.type->name);
  }
  return dea_force_indent(ctx, p->job.type, p->job.model, design, 0);
}

/* From the film at rest at 0 V. */
static dea_status begin(struct dea_context *ctx, const struct dea_design *design,
                        struct playback *p)
{
  const struct dea_quantity *limit = &design->drive.current_limit_A;
  const struct dea_time_options options = {
      .circuit = {.series_resistance_ohm = design->drive.series_resistance_ohm.si,
                  .current_limit_A = limit->origin != DEA_ABSENT ? limit->si : INFINITY},
      .own_sources = p->any_own ? p->own : NULL,
      .inertia = p->inertia,
      .rho_inf = settings_of(design)->rho_inf.si,
  };
  struct dea_load_point point;
  DEA_TRY(ctx, p->job.type->solve(ctx, p->job.model, 0, &point));
  DEA_TRY(ctx, indent(ctx, design, p));
  DEA_TRY(ctx, p->job.type->begin(ctx, p->job.model, &options, &point));
  return keep(ctx, p, &point, true);
}

static dea_status reserve(struct dea_context *ctx, const struct dea_result *result,
                          struct playback *p)
{
  DEA_TRY(ctx, dea_monitor_set_init(ctx, p->job.type, result->device, &p->seen));
  p->spare = dea_monitor_values_copy(&p->seen.memory, p->seen.values);
  p->seen_largest = dea_arena_alloc(&p->seen.memory, p->seen.count, sizeof *p->seen_largest);
  return dea_arena_status(&p->seen.memory);
}

/* What report.fields asks for of electrodes with a sheet resistance. */
static enum dea_fields_at fields_of(const struct dea_model_type *type,
                                    const struct dea_result *result)
{
  const struct dea_layout *layout = type->fields != NULL ? result->device->layout : NULL;
  return layout != NULL && dea_layout_has_sheet_resistance(layout)
             ? (enum dea_fields_at)result->design->report.fields.value
             : DEA_FIELDS_NONE;
}

static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct dea_model_type *type = job->type;
  struct dea_result *result = job->result;
  struct playback p = {.job = *job,
                       .fields = fields_of(type, result),
                       .inertia = settings_of(result->design)->inertia.value == 1};
  DEA_TRY(ctx, dea_result_add_curve(ctx, result, type->name, study_name, &p.curve));
  dea_status status = reserve(ctx, result, &p);
  status = status == DEA_OK ? build_sources(ctx, result, &p) : status;
  status = status == DEA_OK
               ? dea_model_create(ctx, type, result->design, result->device, &p.job.model)
               : status;
  status = status == DEA_OK ? prepare(ctx, result->design, &p) : status;
  status = status == DEA_OK ? begin(ctx, result->design, &p) : status;
  status = status == DEA_OK ? play(ctx, &p) : status;
  dea_status flushed = flush(ctx, &p);
  status = status == DEA_OK ? flushed : status;
  flushed = dea_study_sources(ctx, &p.seen, p.curve, result);
  status = status == DEA_OK ? flushed : status;
  for (size_t k = 0; k < p.source_count; k++) {
    dea_waveform_destroy(p.sources[k].limited);
  }
  dea_monitor_set_free(&p.seen);
  if (p.job.model != NULL) {
    type->destroy(ctx, p.job.model);
  }
  return dea_curve_end(ctx, p.curve, status);
}

// Tables -----------------------------------------------------------------------------------------

enum { ALL = DEA_IN_JSON | DEA_IN_SCREEN };

static const struct dea_result_column fact_columns[] = {
    DEA_RESULT_COLUMN(COUNT, "points", "points", .meaning = "points in time"),
    DEA_NUMBER_COLUMN("end_s", "s", "s", 1, "end", "last time"),
    DEA_TEXT_COLUMN("quantity", "cycles of",
                    "quantity of load points that the cycles are read from"),
};
static const struct dea_result_column energy_columns[] = {
    DEA_UJ("supply_work_J", "the supply gave",
           "work of the supply, from the first to the worst point"),
    DEA_UJ("stored_J", "stored", "in the film, its field and its branches"),
    DEA_UJ("kinetic_J", "moving", "kinetic energy"),
    DEA_UJ("dissipated_J", "lost", "in branches, resistance and leakage"),
    DEA_NUMBER_COLUMN("not_accounted", NULL, "%", 100, "not accounted for",
                      "difference, relative to the largest of these energies"),
};
static const struct dea_result_column cycle_columns[] = {
    DEA_NUMBER_COLUMN("start_s", "s", NULL, 1, "start", "time"),
    DEA_NUMBER_COLUMN("end_s", "s", NULL, 1, "end", "time"),
    DEA_NUMBER_COLUMN("level_V", "V", NULL, 1, "V", "of the waveform"),
    DEA_RESULT_COLUMN(VALUE, "amplitude", "amplitude", .meaning = "highest - lowest"),
    DEA_RESULT_COLUMN(VALUE, "farthest", "farthest",
                      .meaning = "of the highest and lowest, the one farther from the start"),
    DEA_RESULT_COLUMN(VALUE, "highest", "highest", .meaning = "value"),
    DEA_RESULT_COLUMN(VALUE, "lowest", "lowest", .meaning = "value"),
    DEA_NUMBER_COLUMN("rise_time_10_90_s", "s", NULL, 1, "rise 10-90",
                      "time from 10 to 90 % of the way to the farthest"),
};
static const struct dea_result_column creep_columns[] = {
    DEA_KV("level_V", "V", "of the waveform"),
    DEA_RESULT_COLUMN(COUNT, "cycles", "cycles", .meaning = "at this voltage"),
    DEA_RESULT_COLUMN(VALUE, "first", "first", .meaning = "farthest of the first"),
    DEA_RESULT_COLUMN(VALUE, "last", "last", .meaning = "farthest of the last"),
    DEA_RESULT_COLUMN(VALUE, "creep", "creep", .meaning = "last - first"),
    DEA_RESULT_COLUMN(NUMBER, "rise_s", "rise 10-90", .hidden = DEA_IN_JSON, .si_unit = "s",
                      .display_unit = "s", .meaning = "rise time of the first"),
};

static const struct dea_result_table_type fact_table = DEA_RESULT_TABLE(
    study_name, "", fact_columns, .title = "in time", .where = ALL, .one_row = true);
static const struct dea_result_table_type energy_table = DEA_RESULT_TABLE(
    study_name, "energy", energy_columns, .title = "energy", .where = ALL, .one_row = true);
static const struct dea_result_table_type cycle_table =
    DEA_RESULT_TABLE(study_name, "cycles", cycle_columns, .title = "cycles", .where = DEA_IN_JSON);
static const struct dea_result_table_type creep_table = DEA_RESULT_TABLE(
    study_name, "creep", creep_columns, .title = "farthest value of each cycle", .where = ALL);

static double largest_of(const struct dea_curve *curve, int column)
{
  double largest = 0;
  for (size_t i = 0; i < curve->count; i++) {
    double value = fabs(dea_point_get(&curve->points[i], column));
    largest = isfinite(value) ? fmax(largest, value) : largest;
  }
  return largest;
}

/* Column that shows how the actuator moves: the centre's displacement where it moves, else the
 * electrode's edge; -1 without any. */
static int motion_column(const struct dea_curve *curve)
{
  static const double noise = 1e-6; // a flat film's centre stays but for the solver's
  int centre = dea_point_column_find("centre_z_m"),
      edge = dea_point_column_find("electrode_edge_u_m");
  double z_m = largest_of(curve, centre), u_m = largest_of(curve, edge);
  return z_m > noise * u_m ? centre : u_m > 0 ? edge : -1;
}

/* Work of the supply against what it became, from the first point to the last; the error is that at
 * the worst point, over the largest of these energies at any. Nothing when the curve has none. */
static dea_status add_balance(struct dea_context *ctx, const struct dea_curve *curve,
                              const char *model, struct dea_result *result)
{
  struct dea_result_table *table;
  double supply = 0, stored = 0, kinetic = 0, lost = 0, largest = 0, worst = 0;
  for (size_t i = 0; i < curve->count; i++) {
    const struct dea_load_point *p = &curve->points[i];
    if (isnan(p->supply_work_J) || isnan(p->stored_energy_J) || isnan(p->dissipated_J)) {
      return DEA_OK;
    }
    supply = p->supply_work_J;
    stored = p->stored_energy_J - curve->points[0].stored_energy_J;
    kinetic = isnan(p->kinetic_energy_J) ? 0 : p->kinetic_energy_J;
    lost = p->dissipated_J + (isnan(p->damped_J) ? 0 : p->damped_J);
    largest = fmax(largest, fmax(fmax(fabs(supply), fabs(stored)), fmax(kinetic, lost)));
    worst = fmax(worst, fabs(supply - stored - kinetic - lost));
  }
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &energy_table, model, 0, &table));
  return DEA_TABLE_ADD(ctx, table, DEA_CELL(supply), DEA_CELL(stored), DEA_CELL(kinetic),
                       DEA_CELL(lost), DEA_CELL(largest > 0 ? worst / largest : 0));
}

/* One cycle of the waveform, as a column of the curve shows it [SI]. */
struct cycle {
  double start_s, end_s;
  double level_V; // of the waveform
  double highest, lowest;
  double farthest;    // of the two, the one farther from the value at the start
  double rise_time_s; // from 10 to 90 % of the way to the farthest; NAN without a way
};

/* First time at which the column is at `level` on its way between points from and to; NAN: never.
 */
static double time_at(const struct dea_curve *curve, int column, size_t from, size_t to,
                      double level, double side)
{
  for (size_t i = from + 1; i < to; i++) {
    double a = dea_point_get(&curve->points[i - 1], column) - level;
    double b = dea_point_get(&curve->points[i], column) - level;
    if (a * side < 0 && b * side >= 0) {
      double t = curve->points[i - 1].time_s;
      return t + (curve->points[i].time_s - t) * a / (a - b);
    }
  }
  return NAN;
}

/* Before a time, and not by rounding only. */
static bool is_before(double time_s, double end_s)
{
  return time_s < end_s * (1 - 1e-12);
}

/* Features of the points [from, to), of which there is one at least. */
static struct cycle measure(const struct dea_curve *curve, int column,
                            const struct dea_wave_cycle *wave, size_t from, size_t to)
{
  double start = dea_point_get(&curve->points[from], column);
  struct cycle out = {.start_s = wave->start_s,
                      .end_s = wave->end_s,
                      .level_V = wave->level_V,
                      .highest = start,
                      .lowest = start,
                      .rise_time_s = NAN};
  for (size_t i = from; i < to; i++) {
    double value = dea_point_get(&curve->points[i], column);
    out.highest = fmax(out.highest, value);
    out.lowest = fmin(out.lowest, value);
  }
  out.farthest = out.highest - start >= start - out.lowest ? out.highest : out.lowest;
  double change = out.farthest - start, side = copysign(1, change);
  if (change != 0) {
    out.rise_time_s = time_at(curve, column, from, to, start + 0.9 * change, side) -
                      time_at(curve, column, from, to, start + 0.1 * change, side);
  }
  return out;
}

/* Row of the cycles from a to b, which are of one voltage. */
static dea_status add_creep(struct dea_context *ctx, const struct cycle *a, const struct cycle *b,
                            size_t count, struct dea_result_table *table)
{
  return DEA_TABLE_ADD(ctx, table, DEA_CELL(a->level_V), DEA_CELL((double)count),
                       DEA_CELL(a->farthest), DEA_CELL(b->farthest),
                       DEA_CELL(b->farthest - a->farthest), DEA_CELL(a->rise_time_s));
}

/* Cycles of the waveform that the curve holds to their end. */
static dea_status add_cycles(struct dea_context *ctx, const struct dea_curve *curve,
                             const struct dea_waveform *waveform, int column, const char *model,
                             struct dea_result *result)
{
  const double end_s = curve->points[curve->count - 1].time_s * (1 + 1e-12);
  struct dea_result_table *cycles, *creep;
  struct dea_wave_cycle wave;
  struct cycle first = {0}, last = {0};
  size_t from = 0, alike = 0; // cycles from the first one on
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &cycle_table, model, 0, &cycles));
  cycles->quantity = column;
  const size_t at = (size_t)(cycles - result->tables);
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &creep_table, model, 0, &creep));
  creep->quantity = column;
  cycles = &result->tables[at];
  for (size_t n = 0; dea_waveform_cycle(waveform, n, &wave) && wave.end_s <= end_s; n++) {
    while (from + 1 < curve->count && is_before(curve->points[from].time_s, wave.start_s)) {
      from++;
    }
    size_t to = from + 1; // without the jump at the end, which belongs to the next cycle
    while (to < curve->count && is_before(curve->points[to].time_s, wave.end_s)) {
      to++;
    }
    const struct cycle c = measure(curve, column, &wave, from, to);
    from = to - 1;
    if (alike > 0 && c.level_V != first.level_V) {
      DEA_TRY(ctx, add_creep(ctx, &first, &last, alike, creep));
      alike = 0;
    }
    first = alike++ == 0 ? c : first;
    last = c;
    DEA_TRY(ctx,
            DEA_TABLE_ADD(ctx, cycles, DEA_CELL(c.start_s), DEA_CELL(c.end_s), DEA_CELL(c.level_V),
                          DEA_CELL(c.highest - c.lowest), DEA_CELL(c.farthest), DEA_CELL(c.highest),
                          DEA_CELL(c.lowest), DEA_CELL(c.rise_time_s)));
  }
  return alike > 0 ? add_creep(ctx, &first, &last, alike, creep) : DEA_OK;
}

static dea_status tables(struct dea_context *ctx, const char *model, struct dea_result *result)
{
  const struct dea_curve *curve = dea_result_find(result, model, study_name);
  const struct dea_waveform *waveform = result->design->drive.waveform;
  struct dea_result_table *table;
  if (curve == NULL || curve->count == 0) {
    return DEA_OK;
  }
  int column = motion_column(curve);
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &fact_table, model, 0, &table));
  DEA_TRY(ctx, DEA_TABLE_ADD(ctx, table, DEA_CELL((double)curve->count),
                             DEA_CELL(curve->points[curve->count - 1].time_s),
                             DEA_TEXT_CELL(column < 0 ? "" : dea_point_columns[column].key)));
  DEA_TRY(ctx, add_balance(ctx, curve, model, result));
  return column < 0 || waveform == NULL ? DEA_OK
                                        : add_cycles(ctx, curve, waveform, column, model, result);
}

// Figures ----------------------------------------------------------------------------------------

/* Adds a column of a curve against time. Nothing when the curve has no such number. */
static dea_status add_in_time(struct dea_context *ctx, struct dea_panel *panel,
                              const struct dea_curve *curve, const char *key, double factor,
                              const struct dea_series *look)
{
  struct dea_series *series;
  int column = dea_point_column_find(key);
  if (!dea_points_have(curve->points, curve->count, column)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, curve->count, look, &series));
  for (size_t i = 0; i < curve->count; i++) {
    series->values[i] = curve->points[i].time_s;
    series->values[curve->count + i] = factor * dea_point_get(&curve->points[i], column);
  }
  return DEA_OK;
}

/* Many cycles lie close to each other. */
static enum dea_series_style line_of(const struct dea_curve *curve)
{
  enum { FEW = 800 };
  return curve->count > FEW ? DEA_THIN : DEA_LINE;
}

/* One panel with a column of all models. */
static dea_status add_models(struct dea_context *ctx, const struct dea_result *result,
                             struct dea_panel *panel, const char *key, double factor)
{
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    const struct dea_curve *curve = dea_result_find(result, models[m], "transient");
    if (curve != NULL && curve->count > 1) {
      struct dea_series look = dea_figure_model_style(models[m], m);
      look.style = line_of(curve);
      DEA_TRY(ctx, add_in_time(ctx, panel, curve, key, factor, &look));
    }
  }
  return DEA_OK;
}

/* True where the film's voltage is another than that of the supply for long enough to be seen. */
static bool lags(const struct dea_curve *curve)
{
  double area = 0, largest_V = 0;
  for (size_t i = 1; i < curve->count; i++) {
    const struct dea_load_point *p = &curve->points[i];
    area += fabs(p->voltage_V - p->source_voltage_V) * (p->time_s - curve->points[i - 1].time_s);
    largest_V = fmax(largest_V, fabs(p->source_voltage_V));
  }
  return area > 1e-3 * largest_V * curve->points[curve->count - 1].time_s;
}

static dea_status add_voltages(struct dea_context *ctx, const struct dea_curve *curve,
                               struct dea_panel *panel)
{
  struct dea_series look = {.style = line_of(curve), .colour = DEA_BLACK};
  if (lags(curve)) {
    struct dea_series source = {.style = DEA_DASHED, .colour = DEA_GREY};
    snprintf(source.title, sizeof source.title, "supply");
    snprintf(look.title, sizeof look.title, "film");
    DEA_TRY(ctx, add_in_time(ctx, panel, curve, "source_voltage_V", 1e-3, &source));
  }
  return add_in_time(ctx, panel, curve, "voltage_V", 1e-3, &look);
}

/* Whether the supply plays anything: of channels with sources of their own alone it is at 0 V, and
 * the figures of channels show what there is. */
static bool supplied(const struct dea_curve *curve)
{
  bool any = false;
  for (size_t i = 0; curve != NULL && i < curve->count; i++) {
    any = any || curve->points[i].source_voltage_V != 0; // NAN: not known to be at 0 V
  }
  return any;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  const struct dea_curve *curve = dea_study_first_curve(result, study_name, 2);
  if (!supplied(curve)) {
    return DEA_OK;
  }
  const int column = motion_column(curve);
  const bool small = column < 0 || !(largest_of(curve, column) > 0.5e-3);
  struct dea_panel *upper = &plot->panels[0], *lower = &plot->panels[1];
  plot->panel_count = column >= 0 ? 2 : 1;
  plot->second_height = 1.0;
  DEA_TRY(ctx, add_voltages(ctx, curve, upper));
  snprintf(upper->y_label, sizeof upper->y_label, "Voltage {/:Italic V} (kV)");
  dea_observe_time_axis(upper);
  if (column < 0) {
    return DEA_OK;
  }
  const struct dea_column *c = &dea_point_columns[column];
  DEA_TRY(ctx, add_models(ctx, result, lower, c->key, small ? 1e6 : 1e3));
  snprintf(lower->y_label, sizeof lower->y_label, "%s (%s)",
           strcmp(c->key, "centre_z_m") == 0 ? "Displacement of the centre {/:Italic z}"
                                             : "Displacement of the edge {/:Italic u}",
           small ? "\302\265m" : "mm");
  dea_observe_time_axis(lower);
  return DEA_OK;
}

/* history_force, history_current */
static dea_status build_one(struct dea_context *ctx, const struct dea_result *result,
                            struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  const bool force = strcmp(plot->name, "history_force") == 0;
  const int column = dea_point_column_find(force ? "force_N" : "current_A");
  if (!force && !supplied(dea_study_first_curve(result, study_name, 2))) {
    return DEA_OK;
  }
  const struct dea_column *shown = &dea_point_columns[column];
  DEA_TRY(ctx, add_models(ctx, result, panel, shown->key, shown->factor));
  snprintf(panel->y_label, sizeof panel->y_label, "%s",
           force ? "Out-of-plane force {/:Italic F} (mN)" : "Current {/:Italic I} (\302\265A)");
  if (panel->series_count > 0) {
    dea_observe_time_axis(panel);
  }
  return DEA_OK;
}

static const struct dea_figure figures[] = {
    DEA_STUDY_FIGURE("history", study_name, build, "voltage and displacement against time"),
    DEA_STUDY_FIGURE("history_force", study_name, build_one, "out-of-plane force against time"),
    DEA_STUDY_FIGURE("history_current", study_name, build_one,
                     "current of the supply against time"),
    DEA_STUDY_FIGURE(
        "history_monitors", study_name, dea_observe_build,
        "displacement of the monitors against time, along the axis that they move along most"),
    DEA_STUDY_FIGURE("history_monitors_stretch", study_name, dea_observe_build,
                     "stretch of lines and regions against time"),
    DEA_STUDY_FIGURE("history_monitors_turn", study_name, dea_observe_build,
                     "turns of rigid bodies against time"),
    DEA_STUDY_FIGURE("history_voltages", study_name, dea_observe_build,
                     "voltages of the channels against time"),
    DEA_STUDY_FIGURE("history_currents", study_name, dea_observe_build,
                     "currents of the channels' sources against time, means of the steps"),
    DEA_STUDY_FIGURE("history_channels", study_name, dea_observe_build,
                     "charge on the channels against time"),
};

// The study --------------------------------------------------------------------------------------

/* Densities of the film of a disc alone, as a model may take a fibre for rigid. */
static dea_status refuse(struct dea_context *ctx, const struct dea_design *design,
                         const struct dea_device *device)
{
  const struct dea_choice *inertia = &settings_of(design)->inertia;
  if (inertia->value == 1 && device->layout->contact_count > 0) {
    return dea_refuse(ctx, inertia->location,
                      "what may touch (contacts) has no impact with inertia: take "
                      "compute.transient.inertia: no");
  }
  return inertia->value == 1 && (!device->disc || !(device->film.density_kg_per_m3 > 0))
             ? dea_device_refuse_densities(ctx, inertia->location, device)
             : DEA_OK;
}

const struct dea_study dea_study_transient = {
    .name = study_name,
    .keys = &section,
    .asked = asked,
    .needs = "drive.waveform or channels[].waveform",
    .own_models = true,
    .ability = "transients",
    .able_by = offsetof(struct dea_model_type, advance),
    .refuse = refuse,
    .run = run,
    .tables = tables,
    .figures = figures,
    .figure_count = DEA_COUNT(figures),
};
