#include "drive/drive_watch.h"

#include "instrument/output_zero.h"

#include <math.h>
#include <stdio.h>

static const double blind_s = 0.5;
static const double golden = 0.6180339887498949;
static const double cap_margin = 0.1; // above the largest voltage, for errors of the monitor

static size_t samples_of(double time_s, double rate_Hz)
{
  double samples = ceil(time_s * rate_Hz);
  return samples > 1 ? (size_t)samples : 1;
}

/* Of the sequence, 0 V included. */
static double find_span(const struct dea_protocol *protocol)
{
  double lowest_V = 0, highest_V = 0;
  for (size_t i = 0; i < protocol->step_count; i++) {
    lowest_V = fmin(lowest_V, protocol->steps[i].lowest_V);
    highest_V = fmax(highest_V, protocol->steps[i].highest_V);
  }
  return highest_V - lowest_V;
}

/* The limits of docs/theory/interlocks.md for one channel of the current. */
static struct dea_arc_limits find_arc_limits(const struct dea_protocol *protocol,
                                             const struct dea_protocol_input *input,
                                             double settle_s, double capacitance_F)
{
  static const double growth = 2, cable_F = 100e-12;
  const struct dea_quantity *limit = &protocol->amplifier.current_A;
  double span_V = find_span(protocol), trip_s = protocol->safety.trip_time_s.si;
  struct dea_arc_limits out = {
      .rate_Hz = protocol->rate_Hz.si,
      .current_A = protocol->safety.trip_current_A.si,
      .most_A = fabs(input->range_V.si * input->per_volt) + fabs(input->at_zero),
      .count = (size_t)protocol->safety.trip_count.si,
      .settle_s = settle_s,
  };
  out.most_A = limit->origin != DEA_ABSENT ? fmin(out.most_A, limit->si) : out.most_A;
  trip_s = fmax(trip_s, 1 / out.rate_Hz); // one sample is never an arc
  out.charge_C = out.most_A * trip_s;
  if (capacitance_F > 0) {
    out.capacitance_F = growth * capacitance_F + cable_F;
  } else if (span_V > 0) {
    out.capacitance_F = out.charge_C / span_V;
  }
  return out;
}

static void start_evidence(struct dea_evidence *e, const struct dea_protocol *protocol,
                           double settle_s)
{
  *e = (struct dea_evidence){.lag_s = settle_s + 1 / protocol->rate_Hz.si,
                             .error_V = protocol->safety.voltage_error_V.si,
                             .share = protocol->safety.readback_error.si,
                             .zero_V = protocol->safety.at_zero_V.si};
}

void dea_drive_watch_start(struct dea_drive_watch *watch, const struct dea_protocol *protocol,
                           double settle_s, double capacitance_F)
{
  double rate_Hz = protocol->rate_Hz.si;
  *watch = (struct dea_drive_watch){.protocol = protocol, .largest_current_A = NAN};
  watch->lasting = samples_of(protocol->safety.trip_time_s.si, rate_Hz);
  watch->blind = samples_of(blind_s, rate_Hz);
  watch->window = samples_of(settle_s, rate_Hz) + 1; // a sample may show what was asked before it
  dea_protocol_cap(protocol, &watch->cap_V[0], &watch->cap_V[1]);
  for (size_t i = 0; i < protocol->input_count; i++) {
    const struct dea_arc_limits limits =
        find_arc_limits(protocol, &protocol->inputs[i], settle_s, capacitance_F);
    dea_arc_watch_start(&watch->arcs[i], &limits);
    dea_leak_watch_start(&watch->leaks[i], protocol);
    start_evidence(&watch->evidence[i], protocol, settle_s);
  }
}

static void follow(struct dea_drive_watch *watch, double asked_V)
{
  if (++watch->in_window > watch->window) {
    watch->lowest_V[1] = watch->lowest_V[0];
    watch->highest_V[1] = watch->highest_V[0];
    watch->lowest_V[0] = watch->highest_V[0] = asked_V;
    watch->in_window = 1;
  }
  watch->lowest_V[0] = fmin(watch->lowest_V[0], asked_V);
  watch->highest_V[0] = fmax(watch->highest_V[0], asked_V);
}

static bool check_arcs(struct dea_drive_watch *watch, size_t i, double change_V, double current_A,
                       char why[DEA_WHY_ENDED_SIZE])
{
  const struct dea_arc_limits *limits = &watch->arcs[i].limits;
  switch (dea_arc_watch_sample(&watch->arcs[i], change_V, current_A)) {
  case DEA_ARC_TOO_OFTEN:
    snprintf(why, DEA_WHY_ENDED_SIZE,
             "arcs: the current was above safety.trip_current of %.4g mA for the %zuth time within "
             "10 s without a change of the voltage that explains it (safety.trip_count)",
             1e3 * limits->current_A, limits->count);
    return false;
  case DEA_ARC_TOO_MUCH:
    snprintf(why, DEA_WHY_ENDED_SIZE,
             "arcs: more than %.4g uC have flowed above safety.trip_current of %.4g mA within "
             "about 1 s, beyond what charging the film explains",
             1e6 * limits->charge_C, 1e3 * limits->current_A);
    return false;
  case DEA_ARC_NONE:
    break;
  }
  return true;
}

bool dea_drive_watch_is_over(const struct dea_protocol *protocol, size_t input, double current_A)
{
  return protocol->inputs[input].kind.value == DEA_CHANNEL_CURRENT &&
         fabs(current_A) > protocol->safety.trip_current_A.si;
}

static bool check_current(struct dea_drive_watch *watch, size_t i, double current_A,
                          char why[DEA_WHY_ENDED_SIZE])
{
  double limit_A = watch->protocol->safety.trip_current_A.si;
  watch->largest_current_A = fmax(watch->largest_current_A, fabs(current_A));
  bool over = dea_drive_watch_is_over(watch->protocol, i, current_A);
  watch->exceeded[i] = over ? watch->exceeded[i] + 1 : 0;
  if (watch->exceeded[i] < watch->lasting) {
    return true;
  }
  snprintf(why, DEA_WHY_ENDED_SIZE,
           "the current is %.4g mA, above safety.trip_current of %.4g mA for %.3g ms",
           1e3 * current_A, 1e3 * limit_A, 1e3 * watch->protocol->safety.trip_time_s.si);
  return false;
}

/* What may be shown now. */
static void find_asked(const struct dea_drive_watch *watch, double *lowest_V, double *highest_V)
{
  *lowest_V = fmin(watch->lowest_V[0], watch->lowest_V[1]);
  *highest_V = fmax(watch->highest_V[0], watch->highest_V[1]);
}

/* A channel that followed shows less than is asked while a current flows that ends the measurement:
 * the film pulls the amplifier down. One that did not follow before may be what is wrong. */
static bool is_pulled_down(const struct dea_drive_watch *watch, size_t i, double voltage_V)
{
  double lowest_V, highest_V;
  find_asked(watch, &lowest_V, &highest_V);
  double error_V = watch->protocol->safety.voltage_error_V.si;
  return watch->over && watch->evidence[i].follows &&
         voltage_V >= (lowest_V < 0 ? lowest_V : -error_V) &&
         voltage_V <= (highest_V > 0 ? highest_V : error_V);
}

static bool check_voltage(struct dea_drive_watch *watch, size_t i, double asked_V, double voltage_V,
                          char why[DEA_WHY_ENDED_SIZE])
{
  double error_V = watch->protocol->safety.voltage_error_V.si;
  double lowest_V, highest_V;
  find_asked(watch, &lowest_V, &highest_V);
  double margin_V = cap_margin * fmax(watch->cap_V[1], -watch->cap_V[0]);
  bool wrong = voltage_V < fmax(lowest_V - error_V, watch->cap_V[0] - margin_V) ||
               voltage_V > fmin(highest_V + error_V, watch->cap_V[1] + margin_V);
  if (wrong && is_pulled_down(watch, i, voltage_V)) {
    watch->pulled_down = true;
    return true; // the current says it
  }
  watch->exceeded[i] = wrong ? watch->exceeded[i] + 1 : 0;
  if (watch->exceeded[i] < watch->lasting) {
    return true;
  }
  watch->evidence[i].follows = false;
  watch->evidence[i].contradicted = true;
  snprintf(why, DEA_WHY_ENDED_SIZE,
           "the voltage is %.4g kV where %.4g kV is asked: more than safety.voltage_error of %.4g "
           "V away; is the amplifier on, and are gain and channel right?",
           1e-3 * voltage_V, 1e-3 * asked_V, error_V);
  return false;
}

static void add_event(struct dea_drive_watch *watch, enum dea_noticed_kind kind, size_t input,
                      double value, double limit)
{
  if (watch->event_count < DEA_WATCH_EVENTS_MAX) {
    watch->events[watch->event_count++] = (struct dea_recorded_event){
        watch->sample / watch->protocol->rate_Hz.si, kind, input, value, limit};
  }
}

/* What no single sample says: a few of them, about as far apart as a limit has to last, against
 * what was asked. */
static bool check_readback(struct dea_drive_watch *watch, size_t i, double asked_V,
                           double voltage_V, char why[DEA_WHY_ENDED_SIZE])
{
  struct dea_evidence *e = &watch->evidence[i];
  double time_s = watch->sample / watch->protocol->rate_Hz.si;
  double turn = 1 + fmod(golden * (double)e->readings, 1);
  char text[DEA_EVIDENCE_TEXT_SIZE];
  if (is_pulled_down(watch, i, voltage_V) ||
      (e->readings > 0 && time_s < e->looked_s + turn * watch->protocol->safety.trip_time_s.si)) {
    return true;
  }
  enum dea_evidence_verdict verdict = dea_evidence_measured(e, voltage_V, time_s, time_s);
  if (verdict == DEA_EVIDENCE_FOLLOWS) {
    return true;
  }
  dea_evidence_text(e, 1, text);
  bool off = verdict == DEA_EVIDENCE_OFF;
  if (off) {
    add_event(watch, DEA_NOTICED_READ_BACK, i, voltage_V, asked_V);
  }
  snprintf(why, DEA_WHY_ENDED_SIZE, "channel '%.40s' %.110s, %s of %.4g %s",
           watch->protocol->inputs[i].name.text, text,
           off ? "off by more than safety.readback_error"
               : "away by more than safety.voltage_error",
           off ? 100 * e->share : e->error_V, off ? "% for 5 s" : "V");
  return false;
}

static bool check_leak(struct dea_drive_watch *watch, size_t i, double asked_V, double current_A,
                       char why[DEA_WHY_ENDED_SIZE])
{
  static const enum dea_noticed_kind kinds[] = {[DEA_LEAK_LEARNED] = DEA_NOTICED_LEARNED,
                                                [DEA_LEAK_SCATTER] = DEA_NOTICED_SCATTER,
                                                [DEA_LEAK_DRIFTED] = DEA_NOTICED_DRIFTED,
                                                [DEA_LEAK_ROSE] = DEA_NOTICED_LEAK_ROSE};
  struct dea_leak_watch *leak = &watch->leaks[i];
  double time_s = watch->sample / watch->protocol->rate_Hz.si;
  enum dea_leak_event event = dea_leak_watch_sample(leak, time_s, asked_V, current_A);
  if (event == DEA_LEAK_NOTHING) {
    return true;
  }
  add_event(watch, kinds[event], i, leak->value_A, leak->limit_A);
  snprintf(
      why, DEA_WHY_ENDED_SIZE,
      "the leakage current has risen to %.4g uA, above %.4g uA, which its base line of earlier "
      "equal cycles and safety.leak_rise allow, for %.3g s (safety.leak_time)",
      1e6 * leak->value_A, 1e6 * leak->limit_A, watch->protocol->safety.leak_time_s.si);
  return event != DEA_LEAK_ROSE;
}

static bool check_missing(struct dea_drive_watch *watch, size_t i, char why[DEA_WHY_ENDED_SIZE])
{
  if (++watch->missing[i] < watch->blind) {
    return true;
  }
  snprintf(why, DEA_WHY_ENDED_SIZE, "channel '%.64s' has given no value for %.2g s",
           watch->protocol->inputs[i].name.text, blind_s);
  return false;
}

/* All of a channel of the current that is no lost sample; why: of the first that ends it. */
static bool check_currents(struct dea_drive_watch *watch, size_t i, double asked_V, double change_V,
                           double current_A, char why[DEA_WHY_ENDED_SIZE])
{
  char later[DEA_WHY_ENDED_SIZE];
  bool no_arcs = check_arcs(watch, i, change_V, current_A, why);
  bool below = check_current(watch, i, current_A, no_arcs ? why : later);
  return no_arcs && below && check_leak(watch, i, asked_V, current_A, why);
}

/* One channel of the current or the voltage. */
static bool check_channel(struct dea_drive_watch *watch, size_t i, double asked_V, double change_V,
                          double value, char why[DEA_WHY_ENDED_SIZE])
{
  bool current = watch->protocol->inputs[i].kind.value == DEA_CHANNEL_CURRENT;
  if (isnan(value)) { // neither good nor bad
    return (!current || check_arcs(watch, i, change_V, value, why)) && check_missing(watch, i, why);
  }
  watch->missing[i] = 0;
  return current ? check_currents(watch, i, asked_V, change_V, value, why)
                 : check_voltage(watch, i, asked_V, value, why) &&
                       check_readback(watch, i, asked_V, value, why);
}

const char *dea_drive_watch_doubt(const struct dea_drive_watch *watch)
{
  const char *doubt = NULL;
  for (size_t i = 0; i < watch->protocol->input_count && doubt != dea_zero_contradicted; i++) {
    const char *own = watch->protocol->inputs[i].kind.value == DEA_CHANNEL_VOLTAGE
                          ? dea_evidence_doubt(&watch->evidence[i])
                          : NULL;
    doubt = own != NULL ? own : doubt;
  }
  return doubt;
}

bool dea_drive_watch_sample(struct dea_drive_watch *watch, double asked_V, const double *values,
                            char why[DEA_WHY_ENDED_SIZE])
{
  bool good = true;
  char later[DEA_WHY_ENDED_SIZE];
  double change_V = asked_V - watch->asked_V;
  watch->asked_V = asked_V;
  watch->event_count = 0;
  follow(watch, asked_V);
  watch->over = false;
  for (size_t i = 0; i < watch->protocol->input_count; i++) {
    watch->over = watch->over || dea_drive_watch_is_over(watch->protocol, i, values[i]);
  }
  // all of them, also once one has ended it: what the others show counts until the output is at 0 V
  for (size_t i = 0; i < watch->protocol->input_count; i++) {
    int kind = watch->protocol->inputs[i].kind.value;
    if (kind == DEA_CHANNEL_VOLTAGE) {
      dea_evidence_sent(&watch->evidence[i], asked_V, watch->sample / watch->protocol->rate_Hz.si);
    }
    if (kind == DEA_CHANNEL_CURRENT || kind == DEA_CHANNEL_VOLTAGE) {
      good = check_channel(watch, i, asked_V, change_V, values[i], good ? why : later) && good;
    }
  }
  watch->sample++;
  return good;
}
