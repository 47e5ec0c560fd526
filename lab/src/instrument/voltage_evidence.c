#include "instrument/voltage_evidence.h"

#include "instrument/output_zero.h"

#include <math.h>
#include <stdio.h>

enum { WRONG_MOST = 2, COMPARED_LEAST = 3, BINS_A_LAG = 64 };
static const double off_most_s = 5, off_from = 0.2; // for how long, and of the largest voltage
static const double looked_most_s = 2;              // that a reading may stand for
static const double least_bin_s = 1e-6;
static const double about = 2; // steps between two lags that a lag may change by

// What was sent ----------------------------------------------------------------------------------

static double bin_s(const struct dea_evidence *e)
{
  return fmax(e->lag_s / BINS_A_LAG, least_bin_s);
}

static size_t place(double bin)
{
  return (size_t)fmod(bin, DEA_EVIDENCE_BINS);
}

static void widen(struct dea_evidence *e, double volts)
{
  size_t i = place(e->bin);
  e->low_V[i] = fmin(e->low_V[i], volts);
  e->high_V[i] = fmax(e->high_V[i], volts);
}

static void move(struct dea_evidence *e, double bins)
{
  double left_V = e->sent_V - e->output_V, most_V = e->slew_V_per_s * bins * bin_s(e);
  bool there = e->slew_V_per_s == 0 || fabs(left_V) <= most_V;
  e->output_V = there ? e->sent_V : e->output_V + copysign(most_V, left_V);
}

static void turn(struct dea_evidence *e, double now_s)
{
  double bin = floor(now_s / bin_s(e)), skipped = bin - e->bin - DEA_EVIDENCE_BINS;
  if (skipped > 0) {
    move(e, skipped);
    e->bin += skipped;
  }
  while (e->bin < bin) {
    e->bin++;
    e->low_V[place(e->bin)] = e->high_V[place(e->bin)] = e->output_V;
    move(e, 1);
    widen(e, e->output_V);
  }
}

void dea_evidence_sent(struct dea_evidence *e, double volts, double now_s)
{
  turn(e, now_s);
  e->sent_V = volts;
  e->largest_V = fmax(e->largest_V, fabs(volts));
  move(e, 0);
  widen(e, e->output_V);
}

/* Between which voltages the output was meanwhile. */
static void find_between(const struct dea_evidence *e, double from_s, double to_s, double *low_V,
                         double *high_V)
{
  double oldest = e->bin - DEA_EVIDENCE_BINS + 1;
  double first = fmin(fmax(floor(from_s / bin_s(e)), oldest), e->bin);
  double last = fmin(fmax(floor(to_s / bin_s(e)), first), e->bin);
  *low_V = INFINITY;
  *high_V = -INFINITY;
  for (double bin = first; bin <= last; bin++) {
    size_t i = place(fmax(bin, 0)); // before the start: as at the start
    *low_V = fmin(*low_V, e->low_V[i]);
    *high_V = fmax(*high_V, e->high_V[i]);
  }
}

// Statistics -------------------------------------------------------------------------------------

static void add(struct dea_evidence_statistics *s, size_t count, double volts, double square)
{
  if (count == 0) {
    *s = (struct dea_evidence_statistics){0, 0, {-INFINITY, -INFINITY}, {INFINITY, INFINITY}};
  }
  s->sum += volts;
  s->square += square;
  s->most[1] = fmax(s->most[1], fmin(s->most[0], volts));
  s->most[0] = fmax(s->most[0], volts);
  s->least[1] = fmin(s->least[1], fmax(s->least[0], volts));
  s->least[0] = fmin(s->least[0], volts);
}

static void add_reading(const struct dea_evidence *e, struct dea_evidence_window *w, double volts,
                        double from_s, double to_s)
{
  double step_s = e->lag_s / (DEA_EVIDENCE_LAGS - 1), low_V, high_V;
  add(&w->measured, w->count, volts, volts * volts);
  for (int k = 0; k < DEA_EVIDENCE_LAGS; k++) {
    find_between(e, from_s - (k + about) * step_s, to_s - (k - about) * step_s, &low_V, &high_V);
    double least = low_V * high_V > 0 ? fmin(fabs(low_V), fabs(high_V)) : 0;
    double most = fmax(fabs(low_V), fabs(high_V));
    add(&w->low[k], w->count, low_V, least * least);
    add(&w->high[k], w->count, high_V, most * most);
  }
  w->count++;
}

/* Of one statistic: how far it is beyond what was sent. */
struct misfit {
  const char *what;
  double measured_V, set_V, beyond_V;
};

static void compare(struct misfit *worst, const char *what, double measured_V, double low_V,
                    double high_V)
{
  double set_V = fmin(fmax(measured_V, low_V), high_V), beyond_V = fabs(measured_V - set_V);
  if (beyond_V > worst->beyond_V) {
    *worst = (struct misfit){what, measured_V, set_V, beyond_V};
  }
}

static struct misfit find_worst(const struct dea_evidence_window *w, int k)
{
  const struct dea_evidence_statistics *m = &w->measured, *low = &w->low[k], *high = &w->high[k];
  struct misfit worst = {"", 0, 0, 0};
  double n = (double)w->count;
  compare(&worst, "peak", m->most[1], low->most[1], high->most[1]);
  compare(&worst, "least", m->least[1], low->least[1], high->least[1]);
  double stray_V = (high->most[0] - low->least[0]) / n; // what one of them may change
  compare(&worst, "mean", m->sum / n, low->sum / n - stray_V, high->sum / n + stray_V);
  compare(&worst, "effective value", sqrt(m->square / n), sqrt(low->square / n) - stray_V,
          sqrt(high->square / n) + stray_V);
  return worst;
}

/* Whether one of the lags explains it; what does not fit by the nearest of them. share: of the
 * largest voltage of the window, that it may be off by too. */
static bool fits(struct dea_evidence *e, const struct dea_evidence_window *w, double error_V,
                 double share)
{
  struct misfit nearest = {"", 0, 0, INFINITY};
  if (w->count < COMPARED_LEAST) {
    return true;
  }
  for (int k = 0; k < DEA_EVIDENCE_LAGS; k++) {
    double largest_V = fmax(fabs(w->high[k].most[0]), fabs(w->low[k].least[0]));
    struct misfit worst = find_worst(w, k);
    if (worst.beyond_V <= fmax(error_V, share * largest_V)) {
      return true;
    }
    nearest = worst.beyond_V < nearest.beyond_V ? worst : nearest;
  }
  e->what = nearest.what;
  e->of = w->count;
  e->measured_V = nearest.measured_V;
  e->set_V = nearest.set_V;
  return false;
}

// What was measured ------------------------------------------------------------------------------

/* Alone: whether it may be that, and whether it says that the meter follows. */
static bool check_step(struct dea_evidence *e, double volts, double from_s, double to_s)
{
  double low_V, high_V, now_low_V, now_high_V, away_V = 2 * e->zero_V;
  find_between(e, from_s - e->lag_s, to_s, &low_V, &high_V);
  find_between(e, from_s, to_s, &now_low_V, &now_high_V);
  bool good = volts >= low_V - e->error_V && volts <= high_V + e->error_V;
  e->wrong = good ? 0 : e->wrong + 1;
  if (good && ((volts > away_V && high_V > away_V) || (volts < -away_V && low_V < -away_V))) {
    e->follows = true;
    e->unseen = 0;
  } else if (!good || fmax(now_low_V, -now_high_V) > away_V) {
    e->unseen++;
    e->follows = e->follows && good && e->unseen < DEA_EVIDENCE_READINGS;
  }
  return e->wrong < WRONG_MOST;
}

/* The windows of a few readings, the second half a window behind the first. */
static bool compare_few(struct dea_evidence *e, double volts, double from_s, double to_s)
{
  bool good = true;
  for (size_t i = 0; i < 2; i++) {
    struct dea_evidence_window *w = &e->few[i];
    if ((e->readings + i * DEA_EVIDENCE_READINGS / 2) % DEA_EVIDENCE_READINGS == 0) {
      w->count = 0;
    }
    add_reading(e, w, volts, from_s, to_s);
    good = good && fits(e, w, e->error_V, 0);
  }
  return good;
}

/* All of a longer time, which tells one lag from another, and what is off by less. */
static enum dea_evidence_verdict compare_many(struct dea_evidence *e, double volts, double from_s,
                                              double to_s)
{
  struct dea_evidence_window *w = &e->many;
  double low_V, high_V, since_s = fmin(from_s - e->looked_s, looked_most_s);
  find_between(e, fmax(e->looked_s, from_s - since_s), to_s, &low_V, &high_V);
  bool away = fmax(low_V, -high_V) > off_from * e->largest_V; // all the time since
  add_reading(e, w, volts, from_s, to_s);
  w->away_s += away && e->readings > 0 ? since_s : 0;
  if (!fits(e, w, e->error_V, 0)) {
    return DEA_EVIDENCE_WRONG;
  }
  if (w->away_s < off_most_s) {
    return DEA_EVIDENCE_FOLLOWS;
  }
  bool off = !e->off && !fits(e, w, e->zero_V, e->share);
  e->off = e->off || off; // the ramp, which it ends with, is not begun anew
  w->count = 0;
  w->away_s = 0;
  return off ? DEA_EVIDENCE_OFF : DEA_EVIDENCE_FOLLOWS;
}

enum dea_evidence_verdict dea_evidence_measured(struct dea_evidence *e, double volts, double from_s,
                                                double to_s)
{
  enum dea_evidence_verdict verdict = DEA_EVIDENCE_FOLLOWS;
  turn(e, to_s);
  if (!check_step(e, volts, from_s, to_s)) {
    verdict = DEA_EVIDENCE_WRONG;
    e->of = 1;
    e->measured_V = volts;
    e->set_V = e->sent_V;
  } else if (!compare_few(e, volts, from_s, to_s)) {
    verdict = DEA_EVIDENCE_WRONG;
  } else {
    verdict = compare_many(e, volts, from_s, to_s);
  }
  e->contradicted = e->contradicted || verdict == DEA_EVIDENCE_WRONG;
  e->looked_s = from_s;
  e->readings++;
  return verdict;
}

bool dea_evidence_wants(const struct dea_evidence *e)
{
  return !e->follows || e->unseen > 0;
}

const char *dea_evidence_doubt(const struct dea_evidence *e)
{
  if (e->contradicted || e->wrong > 0) {
    return dea_zero_contradicted;
  }
  bool seen = e->follows && e->unseen == 0; // the last time that it should have been away, too
  return seen || e->largest_V <= 2 * e->zero_V ? NULL : dea_zero_unseen;
}

void dea_evidence_text(const struct dea_evidence *e, double gain, char out[DEA_EVIDENCE_TEXT_SIZE])
{
  char of[48] = "";
  if (e->of > 1) {
    snprintf(of, sizeof of, " as the %.16s of %u readings", e->what, (unsigned)e->of);
  }
  snprintf(out, DEA_EVIDENCE_TEXT_SIZE, "measures %.4g kV%s where %.4g kV was set",
           1e-3 * gain * e->measured_V, of, 1e-3 * gain * e->set_V);
}
