/* A supply of limited speed: it follows where it can, else it goes as fast as it can until it has
 * caught up. */
#include "waveform/wave_make.h"

#include <math.h>

/* Where the supply is, and what it made so far. */
struct limiter {
  struct dea_waveform *out;
  double time_s, value_V;
  bool follows, was_late;
};

static void go_to(struct limiter *p, double time_s, double value_V)
{
  p->time_s = time_s;
  p->value_V = value_V;
  dea_wave_add(p->out, 0, time_s, value_V);
}

/* From here to `next`, between which the waveform goes straight from a to b; it may be that the
 * supply only comes to where it catches up. */
static void follow(struct limiter *p, double slew, double next, double a, double b)
{
  double h = next - p->time_s, s = (b - a) / h;
  p->follows = p->follows && a == p->value_V && fabs(s) <= slew * (1 + 1e-12);
  if (p->follows) {
    go_to(p, next, b);
    return;
  }
  p->was_late = true;
  double speed = copysign(slew, a != p->value_V ? a - p->value_V : s);
  double catches = (a - p->value_V) / (speed - s); // when value + speed t = a + s t
  if (a == p->value_V || !(catches >= 0 && catches < h)) {
    go_to(p, next, p->value_V + speed * h);
    return;
  }
  double time_s = p->time_s + catches, value_V = a + s * catches;
  const bool within = time_s > p->time_s && time_s < next; // else: as near as numbers can tell
  p->follows = true;
  go_to(p, within ? time_s : next, within || time_s >= next ? value_V : b);
}

static void play(struct limiter *p, const struct dea_waveform *source, double slew, double until)
{
  while (p->time_s < until && !p->out->failed) {
    double next = fmin(fmin(dea_waveform_corner(source, p->time_s), until),
                       p->time_s + 0.25 * source->longest_step_s);
    double a = dea_waveform_value(source, p->time_s);
    // where it caught up in the middle of a piece the two are equal but for rounding
    a = p->follows && fabs(a - p->value_V) <= 1e-9 * (1 + fabs(a)) ? p->value_V : a;
    follow(p, slew, next, a, dea_waveform_before(source, next));
  }
}

dea_status dea_waveform_limit(struct dea_context *ctx, const struct dea_waveform *waveform,
                              double slew_V_per_s, double until_s, struct dea_waveform **out)
{
  struct limiter p = {.follows = true};
  *out = NULL;
  p.out = dea_alloc(ctx, 1, sizeof *p.out);
  DEA_TRY_MEMORY(p.out != NULL);
  *p.out = (struct dea_waveform){
      .kind = "limited", .ctx = ctx, .end_s = until_s, .longest_step_s = INFINITY};
  dea_wave_open(p.out, 0, 1 / until_s, 1);
  go_to(&p, 0, 0);
  play(&p, waveform, slew_V_per_s, until_s);
  const bool failed = p.out->failed;
  if (failed || !p.was_late) {
    dea_waveform_destroy(p.out);
    p.out = NULL;
  }
  *out = p.out;
  DEA_TRY_MEMORY(!failed);
  return DEA_OK;
}
