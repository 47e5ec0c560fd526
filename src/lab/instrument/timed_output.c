#include "lab/instrument/timed_output.h"

#include <math.h>

enum { DEVIATIONS_MAX = 2 };
static const double measure_at_least_s =
    1; // an output that can be read back is, however seldom it is recorded

dea_status dea_timed_begin(struct dea_context *ctx, struct dea_timed_output *o)
{
  o->clock_s = o->waiting_s = NAN;
  if (isfinite(o->measure_interval_s)) {
    o->measure_interval_s = fmin(o->measure_interval_s, measure_at_least_s);
  }
  o->room = (size_t)(o->queue_s * o->rate_Hz) + 1;
  o->queue = dea_alloc(ctx, o->room, sizeof *o->queue);
  return o->queue != NULL ? DEA_OK : DEA_E_MEMORY;
}

void dea_timed_end(struct dea_context *ctx, struct dea_timed_output *o)
{
  dea_free(ctx, o->queue);
  o->queue = NULL;
}

void dea_timed_start(struct dea_timed_output *o, double now_s)
{
  o->turned_s = o->clock_s = o->window_s = o->measured_s = now_s;
}

bool dea_timed_plays(const struct dea_timed_output *o)
{
  return o->queue != NULL && !isnan(o->clock_s);
}

/* When the next sample of the queue is due. */
static double due(const struct dea_timed_output *o)
{
  return o->clock_s + (double)o->played / o->rate_Hz;
}

dea_status dea_timed_put(struct dea_context *ctx, struct dea_timed_output *o, const double *volts,
                         size_t count,
                         dea_status (*serve)(struct dea_context *ctx, void *supply, double until_s),
                         void *supply)
{
  for (size_t i = 0; i < count; i++) {
    while (o->count == o->room) {
      if (isnan(o->clock_s)) {
        return dea_fail(ctx, DEA_E_ARGUMENT, "more than %zu samples before the start", o->room);
      }
      DEA_TRY(ctx, serve(ctx, supply, due(o)));
    }
    o->queue[(o->first + o->count++) % o->room] = volts[i];
  }
  return DEA_OK;
}

static dea_status check_stall(struct dea_context *ctx, struct dea_timed_output *o, double now_s)
{
  double due_s = o->count > 0 ? due(o) : now_s;
  double away_s = fmax(now_s - due_s, now_s - o->turned_s);
  bool idle = o->count == 0 && o->sent_V == 0 && o->wanted_V == 0;
  o->turned_s = now_s;
  return idle || away_s <= o->queue_s + 1 / o->rate_Hz
             ? DEA_OK
             : dea_fail(ctx, DEA_E_INTERLOCK,
                        "the computer was away for %.3g s, longer than the queue of %g s: it was "
                        "stopped, or is too busy",
                        away_s, o->queue_s);
}

dea_status dea_timed_take(struct dea_context *ctx, struct dea_timed_output *o, double now_s)
{
  DEA_TRY(ctx, check_stall(ctx, o, now_s));
  while (o->count > 0 && due(o) <= now_s) {
    o->wanted_V = o->queue[o->first];
    o->first = (o->first + 1) % o->room;
    o->count--;
    o->played++;
  }
  if (o->wanted_V == o->sent_V) {
    o->waiting_s = NAN;
  } else if (isnan(o->waiting_s)) {
    o->waiting_s = now_s;
  }
  return DEA_OK;
}

enum dea_timed_action dea_timed_next(struct dea_timed_output *o, double now_s, double late_s,
                                     double *next_s)
{
  double measure_s = o->measured_s + o->measure_interval_s;
  *next_s = o->count > 0 ? due(o) : INFINITY;
  if (now_s > late_s) {
    return DEA_TIMED_LATE;
  }
  if (!isnan(o->waiting_s) && now_s > o->waiting_s + o->behind_s + o->output_interval_s) {
    return DEA_TIMED_BEHIND;
  }
  if (!isnan(late_s)) {
    *next_s = fmin(*next_s, late_s);
    return DEA_TIMED_NOTHING;
  }
  if (now_s >= measure_s) {
    o->measured_s = now_s;
    return DEA_TIMED_MEASURE;
  }
  *next_s = fmin(*next_s, measure_s);
  if (!isnan(o->waiting_s)) {
    if (now_s >= o->sent_s + o->output_interval_s) {
      return DEA_TIMED_SEND;
    }
    *next_s = fmin(*next_s, o->sent_s + o->output_interval_s);
  }
  return DEA_TIMED_NOTHING;
}

void dea_timed_sent(struct dea_timed_output *o, double volts, double now_s)
{
  if (!(now_s - o->window_s < o->behind_s)) {
    o->lowest_V[1] = o->lowest_V[0];
    o->highest_V[1] = o->highest_V[0];
    o->lowest_V[0] = o->highest_V[0] = o->sent_V;
    o->window_s = now_s;
  }
  o->lowest_V[0] = fmin(o->lowest_V[0], volts);
  o->highest_V[0] = fmax(o->highest_V[0], volts);
  o->sent_V = volts;
  o->sent_s = now_s;
  o->waiting_s = NAN;
}

double dea_timed_hold(struct dea_timed_output *o, double now_s)
{
  o->first = o->count = 0;
  o->wanted_V = o->sent_V;
  o->waiting_s = NAN;
  o->turned_s = now_s;
  o->clock_s = o->turned_s - (double)o->played / o->rate_Hz;
  return o->sent_V;
}

bool dea_timed_measured(struct dea_timed_output *o, double volts, double error_V)
{
  double lowest_V = fmin(o->lowest_V[0], o->lowest_V[1]);
  double highest_V = fmax(o->highest_V[0], o->highest_V[1]);
  bool wrong = volts < lowest_V - error_V || volts > highest_V + error_V;
  o->deviations = wrong ? o->deviations + 1 : 0;
  return o->deviations < DEVIATIONS_MAX;
}

bool dea_timed_contradicted(const struct dea_timed_output *o)
{
  return o->deviations > 0;
}
