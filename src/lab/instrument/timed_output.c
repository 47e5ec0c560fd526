#include "lab/instrument/timed_output.h"

#include <math.h>

enum { DEVIATIONS_MAX = 2 };
static const double off_most_s = 5, off_forgets = 0.1; // as of lab/drive/drive_watch.c
static const double off_from = 0.2;
static const double zero_least = 4; // times `behind`: two tries, and a late answer in each
// an output that can be read back is, however seldom that is recorded
static const double measure_at_least_s = 1;

dea_status dea_timed_check(struct dea_context *ctx, const struct dea_quantity *behind,
                           const struct dea_quantity *zero_time)
{
  double least_s = zero_least * behind->si;
  return zero_time->si >= least_s * (1 - 1e-9)
             ? DEA_OK
             : dea_finding_add(
                   ctx, DEA_WARNING, behind->location,
                   "at the end the output must be read back at 0 V for as long as that, "
                   "%g s, within %g s, so that %s; write zero_time: %g s in `safety`",
                   behind->si, zero_time->si,
                   zero_time->si > behind->si ? "a late answer leaves it not known to be at 0 V"
                                              : "it will never be known to be at 0 V",
                   least_s);
}

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
  o->turned_s = o->clock_s = o->window_s = o->measured_s = o->times_s = o->looked_s = now_s;
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

/* What stands there, and what is sent, counts for the newest of the shorter times. */
static void follow(struct dea_timed_output *o, double volts, double now_s)
{
  for (int i = 0; i < DEA_TIMED_TIMES && now_s - o->times_s >= 0.125 * o->behind_s; i++) {
    for (int k = DEA_TIMED_TIMES - 1; k > 0; k--) {
      o->lows_V[k] = o->lows_V[k - 1];
      o->highs_V[k] = o->highs_V[k - 1];
    }
    o->lows_V[0] = o->highs_V[0] = o->sent_V;
    o->times_s = i + 1 < DEA_TIMED_TIMES ? o->times_s + 0.125 * o->behind_s : now_s;
  }
  o->lows_V[0] = fmin(o->lows_V[0], volts);
  o->highs_V[0] = fmax(o->highs_V[0], volts);
}

/* A window ends after `behind`, also while nothing is sent: then it has what stands there. */
static void turn_windows(struct dea_timed_output *o, double now_s)
{
  double gone_s = now_s - o->window_s;
  if (gone_s < o->behind_s) {
    return;
  }
  bool long_ago = gone_s >= 2 * o->behind_s;
  o->lowest_V[1] = long_ago ? o->sent_V : o->lowest_V[0];
  o->highest_V[1] = long_ago ? o->sent_V : o->highest_V[0];
  o->lowest_V[0] = o->highest_V[0] = o->sent_V;
  o->window_s = now_s;
}

void dea_timed_sent(struct dea_timed_output *o, double volts, double now_s)
{
  turn_windows(o, now_s);
  follow(o, volts, now_s);
  o->largest_V = fmax(o->largest_V, fabs(volts));
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

/* Near 0 V, and on the way from one sign to the other, nothing is looked at. */
static bool is_off(struct dea_timed_output *o, double volts, double share, double least_V)
{
  double since_s = fmin(o->measured_s - o->looked_s, 2 * measure_at_least_s);
  double lowest_V = INFINITY, highest_V = -INFINITY;
  follow(o, o->sent_V, o->measured_s);
  o->looked_s = o->measured_s;
  for (int i = 0; i < DEA_TIMED_TIMES; i++) {
    lowest_V = fmin(lowest_V, o->lows_V[i]);
    highest_V = fmax(highest_V, o->highs_V[i]);
  }
  double nearest_V = lowest_V * highest_V > 0 ? fmin(fabs(lowest_V), fabs(highest_V)) : 0;
  if (nearest_V == 0 || nearest_V < off_from * o->largest_V) {
    return false;
  }
  double most_V = fmax(share * fmax(fabs(lowest_V), fabs(highest_V)), least_V);
  bool off = volts < lowest_V - most_V || volts > highest_V + most_V;
  o->off_s = fmax(0, o->off_s + (off ? since_s : -off_forgets * since_s));
  return o->off_s >= off_most_s;
}

enum dea_timed_verdict dea_timed_measured(struct dea_timed_output *o, double volts, double error_V,
                                          double share, double least_V)
{
  turn_windows(o, o->measured_s); // when it was asked for
  double lowest_V = fmin(o->lowest_V[0], o->lowest_V[1]);
  double highest_V = fmax(o->highest_V[0], o->highest_V[1]);
  bool wrong = volts < lowest_V - error_V || volts > highest_V + error_V;
  o->deviations = wrong ? o->deviations + 1 : 0;
  if (o->deviations >= DEVIATIONS_MAX) {
    return DEA_TIMED_WRONG;
  }
  bool told = o->off_told;
  o->off_told = is_off(o, volts, share, least_V) || told;
  return o->off_told && !told ? DEA_TIMED_OFF : DEA_TIMED_FOLLOWS;
}

bool dea_timed_contradicted(const struct dea_timed_output *o)
{
  return o->deviations > 0;
}

dea_status dea_timed_off(struct dea_context *ctx, const char *name, double measured_V, double set_V,
                         double share)
{
  return dea_fail(ctx, DEA_E_INTERLOCK,
                  "%s measures %.4g kV where %.4g kV was set, off by more than "
                  "safety.readback_error of %.3g %% for %g s",
                  name, 1e-3 * measured_V, 1e-3 * set_V, 100 * share, off_most_s);
}
