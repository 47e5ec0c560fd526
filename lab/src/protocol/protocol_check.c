/* What must not be played, and what a user should know before. */
#include "protocol/protocol_check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double few_samples = 20, too_few_samples = 4; // a cycle
/* Of the amplifier's current, for charging the film along what is played without jumps. */
static const double current_much = 0.6, current_too_much = 0.9;

// Places -----------------------------------------------------------------------------------------

static struct dea_location step_location(const struct dea_protocol *protocol, size_t step)
{
  return protocol->steps[step].section->location;
}

/* "the amplifier", with its name where it has one. */
static void amplifier_name(const struct dea_protocol *protocol, char out[DEA_STEP_NAME_SIZE])
{
  const char *name = protocol->amplifier.name.text;
  snprintf(out, DEA_STEP_NAME_SIZE, "the amplifier%s%s", name[0] != '\0' ? " " : "", name);
}

// Amplifier --------------------------------------------------------------------------------------

/* The farthest voltages, each with the first step that has it. */
static void find_peaks(const struct dea_protocol *protocol, struct dea_protocol_peak *low,
                       struct dea_protocol_peak *high)
{
  *low = *high = (struct dea_protocol_peak){0};
  for (size_t i = 0; i < protocol->step_count; i++) {
    const struct dea_protocol_step *step = &protocol->steps[i];
    if (step->lowest_V < low->voltage_V) {
      *low = (struct dea_protocol_peak){step->lowest_V, i};
    }
    if (step->highest_V > high->voltage_V) {
      *high = (struct dea_protocol_peak){step->highest_V, i};
    }
  }
}

static dea_status check_voltage(struct dea_context *ctx, const struct dea_protocol *protocol,
                                const struct dea_protocol_peak *peak)
{
  static const double rounding = 1e-9;
  bool low = peak->voltage_V < 0;
  double limit_V = low ? protocol->amplifier.lowest_V.si : protocol->amplifier.highest_V.si;
  double control_V = fabs(peak->voltage_V) / protocol->amplifier.gain.si;
  // a sine of a mean of 2.01 kV and an amplitude of 2010 V comes to 0 V but for rounding
  double most_V = fmax(protocol->amplifier.highest_V.si, -protocol->amplifier.lowest_V.si);
  char step[DEA_STEP_NAME_SIZE], amplifier[DEA_STEP_NAME_SIZE];
  struct dea_location location =
      dea_protocol_voltage_location(protocol, peak->step, peak->voltage_V);
  dea_protocol_step_name(protocol, peak->step, step);
  amplifier_name(protocol, amplifier);
  if (fabs(peak->voltage_V) > fabs(limit_V) + rounding * most_V) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location,
                                 "refused: the sequence asks for %g kV at %s, %s gives "
                                 "%g kV at %s",
                                 1e-3 * peak->voltage_V, step, amplifier, 1e-3 * limit_V,
                                 low ? "least" : "most"));
  }
  if (control_V > protocol->amplifier.control_V.si * (1 + rounding)) {
    return dea_finding_add(ctx, DEA_ERROR, location,
                           "refused: %g kV at %s need a control voltage of %g V (gain %g), "
                           "%s takes %g V",
                           1e-3 * peak->voltage_V, step, control_V, protocol->amplifier.gain.si,
                           amplifier, protocol->amplifier.control_V.si);
  }
  return DEA_OK;
}

/* Its own file says what a specimen stands; the amplifier may give more. */
static dea_status check_specimen(struct dea_context *ctx, const struct dea_protocol *protocol,
                                 const struct dea_protocol_peak *peak)
{
  const struct dea_specimen *specimen = &protocol->specimen;
  char step[DEA_STEP_NAME_SIZE];
  if (specimen->highest_V.origin == DEA_ABSENT ||
      fabs(peak->voltage_V) <= specimen->highest_V.si * (1 + 1e-9)) {
    return DEA_OK;
  }
  dea_protocol_step_name(protocol, peak->step, step);
  return dea_finding_add(
      ctx, DEA_ERROR, dea_protocol_voltage_location(protocol, peak->step, peak->voltage_V),
      "refused: the sequence asks for %g kV at %s, the specimen '%.60s' stands "
      "%g kV by line %zu of %.200s, which no option changes",
      1e-3 * peak->voltage_V, step, specimen->name.text, 1e-3 * specimen->highest_V.si,
      specimen->highest_V.location.line, specimen->highest_V.location.file);
}

/* A gain that is written too small drives the output too high. */
static dea_status check_gain(struct dea_context *ctx, const struct dea_protocol *protocol)
{
  double reach_V = protocol->amplifier.gain.si * protocol->amplifier.control_V.si;
  double most_V = fmax(protocol->amplifier.highest_V.si, -protocol->amplifier.lowest_V.si);
  if (reach_V >= most_V * (1 - 1e-9)) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_WARNING, protocol->amplifier.gain.location,
                         "a gain of %g and %g V of control voltage make %g kV, not the %g kV of "
                         "the amplifier; if the gain is larger, the film gets more than is asked",
                         protocol->amplifier.gain.si, protocol->amplifier.control_V.si,
                         1e-3 * reach_V, 1e-3 * most_V);
}

/* "11.4 us" and the like. */
static void format_time(double time_s, char out[32])
{
  static const struct {
    double above_s, factor;
    const char *unit;
  } units[] = {{1, 1, "s"}, {1e-3, 1e3, "ms"}, {0, 1e6, "us"}};
  size_t i = 0;
  while (time_s < units[i].above_s) {
    i++;
  }
  snprintf(out, 32, "%.3g %s", time_s * units[i].factor, units[i].unit);
}

/* How long the largest jump really takes, and which limit says so. */
static dea_status check_rise(struct dea_context *ctx, const struct dea_protocol *protocol,
                             const struct dea_protocol_slopes *slopes,
                             struct dea_protocol_plan *plan)
{
  const struct dea_quantity *slew = &protocol->amplifier.slew_V_per_s;
  const struct dea_quantity *limit = &protocol->amplifier.current_A;
  double jump_V = fabs(slopes->jump_V);
  double by_slew = slew->origin != DEA_ABSENT ? jump_V / slew->si : 0;
  double by_current = limit->origin != DEA_ABSENT && isfinite(plan->capacitance_F)
                          ? plan->capacitance_F * jump_V / limit->si
                          : 0;
  char time[32];
  plan->rise_s = fmax(by_slew, by_current);
  if (plan->rise_s == 0) {
    plan->rise_s = jump_V > 0 ? NAN : 0;
    return DEA_OK;
  }
  format_time(plan->rise_s, time);
  struct dea_location location =
      dea_protocol_voltage_location(protocol, slopes->jump_step, slopes->jump_V);
  DEA_TRY(ctx,
          by_current > by_slew
              ? dea_finding_add(ctx, DEA_NOTE, location,
                                "the largest jump, %g kV, takes %s: the amplifier charges the "
                                "film's %.3g pF with %g mA",
                                1e-3 * jump_V, time, 1e12 * plan->capacitance_F, 1e3 * limit->si)
              : dea_finding_add(ctx, DEA_NOTE, location,
                                "the largest jump, %g kV, takes %s by the amplifier's slew "
                                "limit",
                                1e-3 * jump_V, time));
  if (by_current > protocol->safety.trip_time_s.si &&
      limit->si > protocol->safety.trip_current_A.si) {
    return dea_finding_add(ctx, DEA_WARNING, protocol->safety.trip_time_s.location,
                           "trip_time is shorter than the %s that charging the film takes: the "
                           "measurement would end there",
                           time);
  }
  return DEA_OK;
}

static dea_status check_slopes(struct dea_context *ctx, const struct dea_protocol *protocol,
                               const struct dea_protocol_slopes *slopes,
                               const struct dea_protocol_plan *plan)
{
  const struct dea_quantity *slew = &protocol->amplifier.slew_V_per_s;
  const struct dea_quantity *limit = &protocol->amplifier.current_A;
  char step[DEA_STEP_NAME_SIZE];
  double current_A = plan->capacitance_F * slopes->slope_V_per_s; // or NAN
  dea_protocol_step_name(protocol, slopes->slope_step, step);
  struct dea_location location = step_location(protocol, slopes->slope_step);
  if (slew->origin != DEA_ABSENT && slopes->slope_V_per_s > slew->si) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, location,
                                 "%s changes with %.3g V/us, the amplifier follows with %.3g V/us "
                                 "only",
                                 step, 1e-6 * slopes->slope_V_per_s, 1e-6 * slew->si));
  }
  if (limit->origin != DEA_ABSENT && current_A > current_much * limit->si) {
    bool refused = current_A > current_too_much * limit->si;
    return dea_finding_add(ctx, refused ? DEA_ERROR : DEA_WARNING, location,
                           "%s%s needs %.3g mA to charge the film's %.3g pF as fast as asked, "
                           "%.0f %% of the %g mA that the amplifier gives; at most %.0f %% are "
                           "played, and up to %.0f %% leave something for leakage and cables",
                           refused ? "refused: " : "", step, 1e3 * current_A,
                           1e12 * plan->capacitance_F, 100 * current_A / limit->si, 1e3 * limit->si,
                           100 * current_too_much, 100 * current_much);
  }
  return DEA_OK;
}

// Channels and samples ---------------------------------------------------------------------------

static dea_status check_range(struct dea_context *ctx, const struct dea_protocol_plan *plan,
                              const struct dea_protocol_input *input)
{
  const double both[2] = {plan->lowest_V, plan->highest_V};
  double worst = 0, of = 0;
  for (int k = 0; k < 2; k++) {
    double volts = fabs((both[k] - input->at_zero) / input->per_volt);
    of = volts > worst ? both[k] : of;
    worst = fmax(worst, volts);
  }
  if (worst <= input->range_V.si) {
    return DEA_OK;
  }
  return dea_finding_add(
      ctx, DEA_ERROR, input->range_V.location,
      "refused: %g kV give %.4g V at the input of '%s', which reads %g V at most", 1e-3 * of, worst,
      input->name.text, input->range_V.si);
}

static dea_status check_inputs(struct dea_context *ctx, const struct dea_protocol *protocol,
                               const struct dea_protocol_plan *plan)
{
  size_t counts[DEA_CHANNEL_KINDS] = {0};
  for (size_t i = 0; i < protocol->input_count; i++) {
    const struct dea_protocol_input *input = &protocol->inputs[i];
    counts[input->kind.value]++;
    DEA_TRY(ctx, input->kind.value == DEA_CHANNEL_VOLTAGE ? check_range(ctx, plan, input) : DEA_OK);
    if (input->filter_Hz.si >= 0.5 * protocol->rate_Hz.si) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, input->filter_Hz.location,
                                   "a filter of %g Hz does nothing at %g samples a second",
                                   input->filter_Hz.si, protocol->rate_Hz.si));
    }
  }
  struct dea_location location = {protocol->file, 1, 1};
  if (counts[DEA_CHANNEL_VOLTAGE] == 0) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, location,
                                 "no channel measures the voltage: nobody notices when the "
                                 "amplifier does not follow"));
  }
  if (counts[DEA_CHANNEL_CURRENT] == 0) {
    return dea_finding_add(ctx, DEA_WARNING, location,
                           "no channel measures the current: a breakdown does not end the "
                           "measurement");
  }
  return DEA_OK;
}

static dea_status check_rate(struct dea_context *ctx, const struct dea_protocol *protocol,
                             const struct dea_protocol_slopes *slopes)
{
  static const double rate_least_Hz = 10;
  double samples = protocol->rate_Hz.si * slopes->cycle_s;
  char step[DEA_STEP_NAME_SIZE];
  if (protocol->rate_Hz.si < rate_least_Hz) {
    return dea_finding_add(ctx, DEA_ERROR, protocol->rate_Hz.location,
                           "refused: at %g samples a second the way to 0 V would begin only %.2g s "
                           "after its reason; at least %g samples a second are played",
                           protocol->rate_Hz.si, 2 / protocol->rate_Hz.si, rate_least_Hz);
  }
  if (samples >= few_samples * (1 - 1e-9)) {
    return DEA_OK;
  }
  bool refused = samples < too_few_samples * (1 - 1e-9);
  dea_protocol_step_name(protocol, slopes->cycle_step, step);
  return dea_finding_add(ctx, refused ? DEA_ERROR : DEA_WARNING, protocol->rate_Hz.location,
                         "%sa cycle of %s has %.3g samples only at %g samples a second; %g samples "
                         "a second give it %g",
                         refused ? "refused: " : "", step, samples, protocol->rate_Hz.si,
                         few_samples / slopes->cycle_s, few_samples);
}

/* A ramp that takes longer than the protocol allows is a faster one. */
static dea_status check_ramp(struct dea_context *ctx, const struct dea_protocol *protocol,
                             const struct dea_protocol_plan *plan)
{
  static const double too_long_s = 60;
  const struct dea_quantity *ramp = &protocol->safety.ramp_V_per_s;
  double highest_V = fmax(-plan->lowest_V, plan->highest_V), time_s = highest_V / ramp->si;
  double long_s = protocol->safety.longest_ramp_s.si;
  if (!(time_s > long_s)) {
    return DEA_OK;
  }
  bool refused = time_s > too_long_s;
  return dea_finding_add(ctx, refused ? DEA_ERROR : DEA_WARNING, ramp->location,
                         "%sthe ramp from %g kV to 0 V takes %.3g s by %g V/s, also after a "
                         "breakdown; safety.longest_ramp makes it one of %g s",
                         refused ? "refused: " : "", 1e-3 * highest_V, time_s, ramp->si, long_s);
}

/* Two steps of one name cannot be told apart later. */
static dea_status check_labels(struct dea_context *ctx, const struct dea_protocol *protocol)
{
  for (size_t i = 1; i < protocol->step_count; i++) {
    const struct dea_label *label = &protocol->steps[i].label;
    for (size_t k = 0; k < i && label->text[0] != '\0'; k++) {
      if (strcmp(label->text, protocol->steps[k].label.text) == 0) {
        DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, label->location,
                                     "step %zu has the label '%.60s' too", k + 1, label->text));
        break;
      }
    }
  }
  return DEA_OK;
}

static dea_status check_size(struct dea_context *ctx, const struct dea_protocol *protocol,
                             struct dea_protocol_plan *plan)
{
  static const double much_B = 4e9, too_much = 1e12;
  double samples = dea_protocol_sample_count(protocol);
  double bytes = samples * (double)(protocol->input_count + 1) * (double)sizeof(double);
  if (samples > too_much) {
    return dea_finding_add(ctx, DEA_ERROR, protocol->rate_Hz.location,
                           "refused: %.3g s are %.3g samples of every channel", plan->duration_s,
                           samples);
  }
  plan->samples = (size_t)samples;
  if (bytes > much_B) {
    return dea_finding_add(ctx, DEA_WARNING, protocol->rate_Hz.location,
                           "the recording will have %.3g GB", 1e-9 * bytes);
  }
  return DEA_OK;
}

dea_status dea_protocol_check(struct dea_context *ctx, const struct dea_protocol *protocol,
                              struct dea_protocol_plan *plan)
{
  struct dea_protocol_peak low, high;
  struct dea_protocol_slopes slopes;
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  find_peaks(protocol, &low, &high);
  dea_protocol_slopes_find(protocol, &slopes);
  *plan = (struct dea_protocol_plan){
      .duration_s = dea_protocol_duration_s(protocol),
      .cycles = dea_protocol_cycles(protocol),
      .lowest_V = low.voltage_V,
      .highest_V = high.voltage_V,
      .largest_field_V_per_m = NAN,
      .allowed_field_V_per_m = NAN,
      .breakdown_field_V_per_m = NAN,
      .breakdown_probability = NAN,
      .breakdown_probability_band = {NAN, NAN},
      .pull_in_V = NAN,
      .capacitance_F = NAN,
      .stored_energy_J = NAN,
  };
  DEA_TRY(ctx, check_voltage(ctx, protocol, &low));
  DEA_TRY(ctx, check_voltage(ctx, protocol, &high));
  DEA_TRY(ctx, check_specimen(ctx, protocol, &low));
  DEA_TRY(ctx, check_specimen(ctx, protocol, &high));
  DEA_TRY(ctx, check_gain(ctx, protocol));
  DEA_TRY(ctx, dea_protocol_check_film(ctx, protocol,
                                       -low.voltage_V > high.voltage_V ? &low : &high, plan));
  DEA_TRY(ctx, check_rise(ctx, protocol, &slopes, plan));
  DEA_TRY(ctx, check_slopes(ctx, protocol, &slopes, plan));
  DEA_TRY(ctx, check_inputs(ctx, protocol, plan));
  DEA_TRY(ctx, check_ramp(ctx, protocol, plan));
  DEA_TRY(ctx, check_rate(ctx, protocol, &slopes));
  DEA_TRY(ctx, dea_protocol_check_interlocks(ctx, protocol, plan));
  DEA_TRY(ctx, check_labels(ctx, protocol));
  DEA_TRY(ctx, check_size(ctx, protocol, plan));
  size_t found = dea_finding_count(ctx, DEA_ERROR) - errors;
  return found > 0 ? dea_fail(ctx, DEA_E_INTERLOCK, "'%s' must not be played: %zu limit%s exceeded",
                              protocol->file, found, found > 1 ? "s are" : " is")
                   : DEA_OK;
}
