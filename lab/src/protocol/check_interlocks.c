/* Keys that would switch an interlock off without a word: limits that nothing can exceed, that take
 * too long, or that an input cannot see. The numbers are derived in docs/theory/interlocks.md. */
#include "protocol/protocol_check.h"

#include <math.h>

static const double trip_longest_s = 0.1;  // that a fault may last
static const double fault_most_J = 10;     // that it may deliver in that time
static const double below_limit = 0.95;    // of the amplifier's current: its monitor shows no more
static const double least_of_range = 1e-3; // of an input's range, above its noise
static const double blind_longest_s = 1;   // that the voltage may settle unwatched
static const double error_much = 0.5;      // of the largest voltage
static const double zero_most_V = 60;      // that may be touched, as direct voltage (IEC 61140)
static const double leak_share = 0.2;      // of trip_current
static const double zero_share = 0.01;     // of the amplifier's range: errors of its monitor

static size_t count_inputs(const struct dea_protocol *protocol, enum dea_channel_kind kind)
{
  size_t count = 0;
  for (size_t i = 0; i < protocol->input_count; i++) {
    count += protocol->inputs[i].kind.value == (int)kind;
  }
  return count;
}

/* How long a fault lasts until it is one, and what it delivers by then. */
static dea_status check_trip_time(struct dea_context *ctx, const struct dea_protocol *protocol,
                                  double largest_V)
{
  const struct dea_quantity *time = &protocol->safety.trip_time_s;
  const struct dea_quantity *limit = &protocol->amplifier.current_A;
  double rate_Hz = protocol->rate_Hz.si;
  double lasting_s = fmax(1, ceil(time->si * rate_Hz * (1 - 1e-12))) / rate_Hz;
  double power_W = limit->origin != DEA_ABSENT ? limit->si * largest_V : 0;
  double most_s = fmin(trip_longest_s, power_W > 0 ? fault_most_J / power_W : INFINITY);
  bool by_rate = time->si <= most_s; // one sample is longer than that
  if (lasting_s <= most_s * (1 + 1e-9)) {
    return DEA_OK;
  }
  if (by_rate) {
    return dea_finding_add(ctx, DEA_ERROR, protocol->rate_Hz.location,
                           "refused: at %g samples a second a fault is seen after %.3g s, by when "
                           "the amplifier has put %.3g J into it; at least %.3g samples a second "
                           "are needed",
                           rate_Hz, lasting_s, power_W * lasting_s, ceil(1 / most_s));
  }
  return dea_finding_add(ctx, DEA_ERROR, time->location,
                         "refused: a fault would last %.3g s until safety.trip_time ends it, by "
                         "when the amplifier has put %.3g J into it; at most %.3g s are allowed",
                         lasting_s, power_W * lasting_s, most_s);
}

/* Whether an input can show that current at all, and tell it from its noise. */
static dea_status check_current_input(struct dea_context *ctx, const struct dea_protocol *protocol,
                                      const struct dea_protocol_input *input)
{
  double trip_A = protocol->safety.trip_current_A.si;
  double range_A = fabs(input->range_V.si * input->per_volt);
  double seen_A = fmax((1 - DEA_CHANNEL_END) * range_A - fabs(input->at_zero), 0); // both signs
  if (seen_A <= trip_A) {
    return dea_finding_add(ctx, DEA_ERROR, input->range_V.location,
                           "refused: the input of '%s' shows %.4g mA at most, so that "
                           "safety.trip_current of %.4g mA is never exceeded",
                           input->name.text, 1e3 * seen_A, 1e3 * trip_A);
  }
  if (trip_A >= least_of_range * range_A) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_ERROR, input->per_volt_text.location,
                         "refused: the input of '%s' reaches to %.4g mA, in whose noise "
                         "safety.trip_current of %.4g mA is lost; at least %.4g mA can be told",
                         input->name.text, 1e3 * range_A, 1e3 * trip_A,
                         1e3 * least_of_range * range_A);
}

/* What is at the end of an input's range is cut off there, and looks like what was asked. */
static dea_status check_reach(struct dea_context *ctx, const struct dea_protocol *protocol,
                              const struct dea_protocol_input *input,
                              const struct dea_protocol_plan *plan)
{
  double error_V = protocol->safety.voltage_error_V.si;
  double reach_V = (1 - DEA_CHANNEL_END) * fabs(input->range_V.si * input->per_volt);
  double highest_V = input->at_zero + reach_V, lowest_V = input->at_zero - reach_V;
  bool high = plan->highest_V > 0 && highest_V <= plan->highest_V + error_V;
  bool low = plan->lowest_V < 0 && lowest_V >= plan->lowest_V - error_V;
  return high || low
             ? dea_finding_add(
                   ctx, DEA_WARNING, input->range_V.location,
                   "the input of '%s' shows %.4g kV at %s, so that an amplifier that gives "
                   "more than the %g kV that are asked is not noticed by "
                   "safety.voltage_error of %g V; give it a larger range",
                   input->name.text, 1e-3 * (high ? highest_V : lowest_V), high ? "most" : "least",
                   1e-3 * (high ? plan->highest_V : plan->lowest_V), error_V)
             : DEA_OK;
}

static dea_status check_voltage_input(struct dea_context *ctx, const struct dea_protocol *protocol,
                                      const struct dea_protocol_input *input,
                                      const struct dea_protocol_plan *plan)
{
  double error_V = protocol->safety.voltage_error_V.si;
  double range_V = fabs(input->range_V.si * input->per_volt);
  if (error_V >= least_of_range * range_V) {
    return check_reach(ctx, protocol, input, plan);
  }
  return dea_finding_add(ctx, DEA_ERROR, input->per_volt_text.location,
                         "refused: the input of '%s' reaches to %.4g kV, in whose noise "
                         "safety.voltage_error of %g V is lost; at least %.4g V can be told",
                         input->name.text, 1e-3 * range_V, error_V, least_of_range * range_V);
}

/* A current that the amplifier never gives never ends the measurement. */
static dea_status check_trip_current(struct dea_context *ctx, const struct dea_protocol *protocol)
{
  const struct dea_quantity *trip = &protocol->safety.trip_current_A;
  const struct dea_quantity *limit = &protocol->amplifier.current_A;
  bool watched = count_inputs(protocol, DEA_CHANNEL_CURRENT) > 0;
  if (limit->origin == DEA_ABSENT) {
    return watched ? dea_finding_add(ctx, DEA_WARNING, trip->location,
                                     "amplifier.current_limit is not given, so that nobody knows "
                                     "whether safety.trip_current of %g mA is ever exceeded",
                                     1e3 * trip->si)
                   : DEA_OK;
  }
  if (trip->si <= below_limit * limit->si) {
    return DEA_OK;
  }
  bool given = trip->origin >= DEA_GIVEN;
  return dea_finding_add(
      ctx, watched ? DEA_ERROR : DEA_WARNING, given ? trip->location : limit->location,
      "%ssafety.trip_current of %g mA is never exceeded, as the amplifier gives "
      "%g mA at most: set it to %.3g mA or less",
      watched ? "refused: " : "", 1e3 * trip->si, 1e3 * limit->si, 1e3 * below_limit * limit->si);
}

static dea_status check_voltage_error(struct dea_context *ctx, const struct dea_protocol *protocol,
                                      double largest_V)
{
  const struct dea_quantity *error = &protocol->safety.voltage_error_V;
  bool all = error->si >= largest_V;
  bool refused = all && count_inputs(protocol, DEA_CHANNEL_VOLTAGE) > 0;
  if (error->si <= error_much * largest_V || largest_V == 0) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, refused ? DEA_ERROR : DEA_WARNING, error->location,
                         "%ssafety.voltage_error of %g V is %s the largest voltage, %g V: an "
                         "amplifier that gives %s is not noticed",
                         refused ? "refused: " : "", error->si,
                         all ? "not below" : "more than half of", largest_V,
                         all ? "nothing" : "half of it");
}

/* Says of which steps the leakage current has none. */
static dea_status note_base_lines(struct dea_context *ctx, const struct dea_protocol *protocol)
{
  size_t without = 0, first = 0;
  char step[DEA_STEP_NAME_SIZE];
  for (size_t i = protocol->step_count; i-- > 0;) {
    bool none = isinf(dea_protocol_learning_s(&protocol->steps[i]));
    without += none;
    first = none ? i : first;
  }
  if (without == 0) {
    return DEA_OK;
  }
  dea_protocol_step_name(protocol, first, step);
  return dea_finding_add(ctx, DEA_NOTE, protocol->safety.trip_current_A.location,
                         "the leakage current has no base line in %zu of %zu steps (%s): it is "
                         "learned from %d equal cycles of %d s or more; there trip_current alone "
                         "guards the film",
                         without, protocol->step_count, step, DEA_LEAK_VISITS, DEA_LEAK_VISIT_S);
}

/* A rise that is none may not reach the fixed limit. */
static dea_status check_leak(struct dea_context *ctx, const struct dea_protocol *protocol)
{
  const struct dea_quantity *least = &protocol->safety.leak_least_A;
  double most_A = leak_share * protocol->safety.trip_current_A.si;
  if (count_inputs(protocol, DEA_CHANNEL_CURRENT) > 0) {
    DEA_TRY(ctx, note_base_lines(ctx, protocol));
  }
  return least->origin == DEA_ABSENT || least->si <= most_A
             ? DEA_OK
             : dea_finding_add(ctx, DEA_ERROR, least->location,
                               "refused: a leakage current that rises by %.4g uA would be no rise; "
                               "at most %.4g uA may be none, %g %% of safety.trip_current",
                               1e6 * least->si, 1e6 * most_A, 100 * leak_share);
}

double dea_zero_most_V(double range_V)
{
  return fmax(zero_most_V, zero_share * range_V);
}

double dea_protocol_zero_most_V(const struct dea_protocol *protocol)
{
  double reach_V = protocol->amplifier.gain.si * protocol->amplifier.control_V.si;
  double range_V = fmax(protocol->amplifier.highest_V.si, -protocol->amplifier.lowest_V.si);
  return dea_zero_most_V(fmin(range_V, reach_V));
}

/* What is read back and still called 0 V. */
static dea_status check_at_zero(struct dea_context *ctx, const struct dea_protocol *protocol)
{
  const struct dea_quantity *zero = &protocol->safety.at_zero_V;
  double most_V = dea_protocol_zero_most_V(protocol);
  return zero->si <= most_V
             ? DEA_OK
             : dea_finding_add(ctx, DEA_ERROR, zero->location,
                               "refused: %g V would be called 0 V; at most %g V are, %g V or %g %% "
                               "of what the amplifier gives",
                               zero->si, most_V, zero_most_V, 100 * zero_share);
}

/* While the amplifier may still be on its way its voltage is not compared. */
static dea_status check_settling(struct dea_context *ctx, const struct dea_protocol *protocol,
                                 const struct dea_protocol_plan *plan)
{
  const struct dea_quantity *slew = &protocol->amplifier.slew_V_per_s;
  const struct dea_quantity *limit = &protocol->amplifier.current_A;
  if (count_inputs(protocol, DEA_CHANNEL_VOLTAGE) == 0 || !(2 * plan->rise_s > blind_longest_s)) {
    return DEA_OK;
  }
  bool by_slew = slew->origin != DEA_ABSENT;
  return dea_finding_add(ctx, DEA_ERROR, by_slew ? slew->location : limit->location,
                         "refused: the largest jump takes %.3g s by the amplifier's limits, and "
                         "twice as long the voltage would not be watched; play ramps that it can "
                         "follow, or correct slew_limit and current_limit",
                         plan->rise_s);
}

dea_status dea_protocol_check_interlocks(struct dea_context *ctx,
                                         const struct dea_protocol *protocol,
                                         const struct dea_protocol_plan *plan)
{
  double largest_V = fmax(-plan->lowest_V, plan->highest_V);
  for (size_t i = 0; i < protocol->input_count; i++) {
    const struct dea_protocol_input *input = &protocol->inputs[i];
    if (input->kind.value == DEA_CHANNEL_CURRENT) {
      DEA_TRY(ctx, check_current_input(ctx, protocol, input));
    } else if (input->kind.value == DEA_CHANNEL_VOLTAGE) {
      DEA_TRY(ctx, check_voltage_input(ctx, protocol, input, plan));
    }
  }
  DEA_TRY(ctx, check_trip_time(ctx, protocol, largest_V));
  DEA_TRY(ctx, check_trip_current(ctx, protocol));
  DEA_TRY(ctx, check_voltage_error(ctx, protocol, largest_V));
  DEA_TRY(ctx, check_at_zero(ctx, protocol));
  DEA_TRY(ctx, check_leak(ctx, protocol));
  return check_settling(ctx, protocol, plan);
}
