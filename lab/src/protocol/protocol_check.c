/* What must not be played, and what a user should know before. */
#include "protocol/protocol.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double few_samples = 20, too_few_samples = 4; // a cycle
/* Of the amplifier's current, for charging the film along what is played without jumps. */
static const double current_much = 0.6, current_too_much = 0.9;

/* The asked voltage farthest from 0 in one direction. */
struct peak {
  double voltage_V;
  size_t step; // in which it is
};

struct slopes {
  double jump_V;        // largest change at once, signed
  double slope_V_per_s; // fastest change between jumps, >= 0
  size_t jump_step, slope_step;
  double cycle_s; // shortest cycle of a waveform
  size_t cycle_step;
};

enum { STEP_NAME_SIZE = 320 };

/* "step 2 (sweep)". */
static void step_name(const struct dea_protocol *protocol, size_t step, char out[STEP_NAME_SIZE])
{
  const char *label = protocol->steps[step].label.text;
  snprintf(out, STEP_NAME_SIZE, "step %zu%s%s%s", step + 1, label[0] != '\0' ? " (" : "", label,
           label[0] != '\0' ? ")" : "");
}

/* Where the file says that voltage of a step: the value itself, else what comes nearest to it. */
static struct dea_location voltage_location(const struct dea_protocol *protocol, size_t step,
                                            double voltage_V)
{
  char path[64];
  const struct dea_node *section = protocol->steps[step].section;
  bool alone = strcmp(section->key, "waveform") == 0 &&
               dea_node_find(dea_yaml_root(protocol->document), "sequence") == NULL;
  snprintf(path, sizeof path, alone ? "waveform." : "sequence[%zu].waveform.", step);
  struct dea_location location = section->location;
  double nearest = INFINITY;
  for (size_t i = 0; i < protocol->values.count; i++) {
    const struct dea_listed *value = &protocol->values.items[i];
    bool here = strncmp(value->path, path, strlen(path)) == 0 && value->origin != DEA_DEFAULT;
    if (here && value->unit != NULL && strcmp(value->unit, "V") == 0 &&
        fabs(value->si - voltage_V) < nearest) {
      nearest = fabs(value->si - voltage_V);
      location = value->location;
    }
  }
  return location;
}

// How fast it changes -----------------------------------------------------------------------------

static void add_jump(struct slopes *out, size_t step, double jump_V)
{
  if (fabs(jump_V) > fabs(out->jump_V)) {
    out->jump_V = jump_V;
    out->jump_step = step;
  }
}

static void add_slope(struct slopes *out, size_t step, const struct dea_waveform *w)
{
  struct dea_wave_extent extent;
  dea_waveform_extent(w, &extent);
  if (extent.slope_V_per_s > out->slope_V_per_s) {
    out->slope_V_per_s = extent.slope_V_per_s;
    out->slope_step = step;
  }
}

static void add_cycle(struct slopes *out, size_t step, double cycle_s)
{
  if (cycle_s < out->cycle_s) {
    out->cycle_s = cycle_s;
    out->cycle_step = step;
  }
}

/* Of straight pieces: every cycle of a block is like the first one. */
static void check_pieces(struct slopes *out, size_t step, const struct dea_waveform *w)
{
  const struct dea_wave_knot *before = NULL;
  for (size_t i = 0; i < w->block_count; i++) {
    const struct dea_wave_block *b = &w->blocks[i];
    const struct dea_wave_knot *first = &w->knots[b->first], *last = first + b->count - 1;
    if (before != NULL) {
      add_jump(out, step, first->value_V - before->value_V);
    }
    if (b->cycles > 1) {
      // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a block has knots
      add_jump(out, step, first->value_V - last->value_V);
    }
    for (const struct dea_wave_knot *k = first; k < last; k++) {
      // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a block has knots
      double time_s = (k[1].phase - k->phase) / b->frequency_Hz + k[1].offset_s - k->offset_s;
      if (!(time_s > 0)) {
        add_jump(out, step, k[1].value_V - k->value_V);
      }
    }
    add_cycle(out, step, 1 / b->frequency_Hz);
    before = last;
  }
}

static void find_slopes(const struct dea_protocol *protocol, struct slopes *out)
{
  double before_V = 0;
  *out = (struct slopes){.cycle_s = INFINITY};
  for (size_t i = 0; i < protocol->step_count; i++) {
    const struct dea_protocol_step *step = &protocol->steps[i];
    const struct dea_waveform *w = step->waveform;
    double start_V = dea_waveform_value(w, 0), end_V = dea_waveform_before(w, w->end_s);
    add_jump(out, i, start_V - before_V);
    if (step->repeat.si > 1) {
      add_jump(out, i, start_V - end_V);
    }
    add_slope(out, i, w);
    if (w->sine.cycles > 0) {
      add_cycle(out, i, 20 * w->longest_step_s);
    } else {
      check_pieces(out, i, w);
    }
    before_V = end_V;
    if (step->pause_s.si > 0 || i + 1 == protocol->step_count) {
      add_jump(out, i, -end_V);
      before_V = 0;
    }
  }
}

// The film: its field, and whether there is an equilibrium at all ---------------------------------

/* The film as the model sees it. */
struct film {
  struct dea_context *ctx;
  const struct dea_protocol *protocol;
  struct dea_bench_model *model;
};

/* Field that is allowed at a point; NAN when nobody says. */
static double allowed_field(const struct film *film, const struct dea_bench_point *at)
{
  const struct dea_quantity *largest = &film->protocol->safety.largest_field_V_per_m;
  return largest->origin != DEA_ABSENT
             ? largest->si
             : at->breakdown_V_per_m / film->protocol->safety.field_margin.si;
}

/* The voltage below which all is allowed, for the message. */
static dea_status allowed_voltage(const struct film *film, double high_V, double *out)
{
  double low_V = 0;
  while (high_V - low_V > 5) {
    double middle_V = 0.5 * (low_V + high_V);
    struct dea_bench_point at;
    dea_status status = film->model->type->solve(film->ctx, film->model, middle_V, &at);
    if (dea_status_ends(status)) {
      return status;
    }
    bool good = status == DEA_OK && at.point.true_field_V_per_m <= allowed_field(film, &at);
    *(good ? &low_V : &high_V) = middle_V;
  }
  *out = low_V;
  return DEA_OK;
}

static dea_status refuse_field(const struct film *film, const struct peak *peak,
                               const struct dea_protocol_plan *plan)
{
  const struct dea_protocol *protocol = film->protocol;
  char step[STEP_NAME_SIZE];
  double voltage_V = 0;
  DEA_TRY(film->ctx, allowed_voltage(film, fabs(peak->voltage_V), &voltage_V));
  dea_context_clear(film->ctx);
  step_name(protocol, peak->step, step);
  struct dea_location location = voltage_location(protocol, peak->step, peak->voltage_V);
  if (protocol->safety.largest_field_V_per_m.origin != DEA_ABSENT) {
    return dea_finding_add(film->ctx, DEA_ERROR, location,
                           "refused: %g kV at %s makes a true field of %.4g V/um in the film, but "
                           "safety.largest_field allows %.4g V/um, which is %.2f kV",
                           1e-3 * peak->voltage_V, step, 1e-6 * plan->largest_field_V_per_m,
                           1e-6 * plan->allowed_field_V_per_m, 1e-3 * voltage_V);
  }
  return dea_finding_add(
      film->ctx, DEA_ERROR, location,
      "refused: %g kV at %s makes a true field of %.4g V/um in the film, but %.4g V/um are "
      "allowed, "
      "the breakdown field of %s over a margin of %g, which is %.2f kV; who knows the film better "
      "sets safety.largest_field and safety.field_reason",
      1e-3 * peak->voltage_V, step, 1e-6 * plan->largest_field_V_per_m,
      1e-6 * plan->allowed_field_V_per_m, film->model->material, protocol->safety.field_margin.si,
      1e-3 * voltage_V);
}

/* A largest_field of the protocol that is above what the material stands needs a reason. */
static dea_status check_reason(const struct film *film, const struct dea_bench_point *at)
{
  const struct dea_protocol *protocol = film->protocol;
  double field = at->point.true_field_V_per_m, breakdown = at->breakdown_V_per_m;
  if (protocol->safety.largest_field_V_per_m.origin == DEA_ABSENT ||
      protocol->safety.field_reason.text[0] != '\0' || !(field > breakdown)) {
    return DEA_OK;
  }
  return dea_finding_add(film->ctx, DEA_ERROR, protocol->safety.largest_field_V_per_m.location,
                         "refused: safety.largest_field of %.4g V/um allows %.4g V/um, which is "
                         "above the breakdown field of %s, %.4g V/um; who knows the film better "
                         "says why: safety.field_reason",
                         1e-6 * protocol->safety.largest_field_V_per_m.si, 1e-6 * field,
                         film->model->material, 1e-6 * breakdown);
}

/* A film that pulls in mostly breaks down there; who gives a reason knows better. */
static dea_status report_pull_in(const struct film *film, const struct peak *peak, double pull_in_V,
                                 bool lost)
{
  char step[STEP_NAME_SIZE], where[64] = "";
  bool refused = lost || film->protocol->safety.field_reason.text[0] == '\0';
  step_name(film->protocol, peak->step, step);
  if (isfinite(pull_in_V)) {
    snprintf(where, sizeof where, " at %.4g kV", 1e-3 * pull_in_V);
  }
  return dea_finding_add(film->ctx, refused ? DEA_ERROR : DEA_WARNING,
                         voltage_location(film->protocol, peak->step, peak->voltage_V),
                         "%sthe film pulls in%s on its way to %g kV at %s, by the model %s%s",
                         refused ? "refused: " : "", where, 1e-3 * peak->voltage_V, step,
                         film->model->name,
                         lost ? ", and has no equilibrium there" : " without wrinkles");
}

static dea_status check_peak(const struct film *film, const struct peak *peak,
                             struct dea_protocol_plan *plan)
{
  struct dea_context *ctx = film->ctx;
  const struct dea_bench_film_type *type = film->model->type;
  struct dea_bench_point at;
  double voltage_V = fabs(peak->voltage_V);
  DEA_TRY(ctx, type->pull_in(ctx, film->model, &plan->pull_in_V));
  dea_status status = type->solve(ctx, film->model, voltage_V, &at);
  if (status == DEA_E_NO_EQUILIBRIUM) {
    dea_context_clear(ctx);
    return report_pull_in(film, peak, plan->pull_in_V, true);
  }
  DEA_TRY(ctx, status);
  plan->largest_field_V_per_m = at.point.true_field_V_per_m;
  plan->allowed_field_V_per_m = allowed_field(film, &at);
  plan->breakdown_field_V_per_m = at.breakdown_V_per_m;
  plan->breakdown_probability = at.point.breakdown_probability;
  plan->breakdown_probability_band[0] = at.breakdown_probability_band[0];
  plan->breakdown_probability_band[1] = at.breakdown_probability_band[1];
  plan->capacitance_F = at.point.capacitance_F;
  plan->stored_energy_J = 0.5 * at.point.capacitance_F * voltage_V * voltage_V;
  if (plan->pull_in_V <= voltage_V) {
    DEA_TRY(ctx, report_pull_in(film, peak, plan->pull_in_V, false));
  }
  DEA_TRY(ctx, check_reason(film, &at));
  if (isnan(plan->allowed_field_V_per_m)) {
    return dea_finding_add(ctx, DEA_WARNING, film->protocol->design_file.location,
                           "no breakdown field of %s is known, so the field of %.4g V/um is not "
                           "checked; safety.largest_field says what is allowed",
                           film->model->material, 1e-6 * plan->largest_field_V_per_m);
  }
  return plan->largest_field_V_per_m > plan->allowed_field_V_per_m * (1 + 1e-9)
             ? refuse_field(film, peak, plan)
             : DEA_OK;
}

/* Field, pull-in, capacitance and energy of the film at the peak. */
static dea_status check_film(struct dea_context *ctx, const struct dea_protocol *protocol,
                             const struct peak *peak, struct dea_protocol_plan *plan)
{
  struct film film = {.ctx = ctx, .protocol = protocol};
  if (protocol->film == NULL) {
    return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){protocol->file, 1, 1},
                           "no `design` is named: field, pull-in and current of the film are not "
                           "checked");
  }
  const struct dea_bench_film_type *type = protocol->film->type;
  DEA_TRY(ctx, type->open(ctx, protocol->film, NULL, NULL, &film.model));
  dea_status status = check_peak(&film, peak, plan);
  type->close(ctx, film.model);
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

// Keys that would switch an interlock off ---------------------------------------------------------

/* Limits that nothing can exceed, that take too long, or that an input cannot see. The numbers are
 * derived in docs/theory/interlocks.md. */

static const double trip_longest_s = 0.1;  // that a fault may last
static const double fault_most_J = 10;     // that it may deliver in that time
static const double below_limit = 0.95;    // of the amplifier's current: its monitor shows no more
static const double least_of_range = 1e-3; // of an input's range, above its noise
static const double blind_longest_s = 1;   // that the voltage may settle unwatched
static const double error_much = 0.5;      // of the largest voltage
static const double leak_share = 0.2;      // of trip_current

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
  char step[STEP_NAME_SIZE];
  for (size_t i = protocol->step_count; i-- > 0;) {
    bool none = isinf(dea_protocol_learning_s(&protocol->steps[i]));
    without += none;
    first = none ? i : first;
  }
  if (without == 0) {
    return DEA_OK;
  }
  step_name(protocol, first, step);
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

/* What is read back and still called 0 V. */
static dea_status check_at_zero(struct dea_context *ctx, const struct dea_protocol *protocol)
{
  const struct dea_quantity *zero = &protocol->safety.at_zero_V;
  double most_V = dea_protocol_zero_most_V(protocol);
  return zero->si <= most_V
             ? DEA_OK
             : dea_finding_add(
                   ctx, DEA_ERROR, zero->location,
                   "refused: %g V would be called 0 V; at most %g V are, 60 V or 1 %% of "
                   "what the amplifier gives",
                   zero->si, most_V);
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

static dea_status check_interlocks(struct dea_context *ctx, const struct dea_protocol *protocol,
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

/* "the amplifier", with its name where it has one. */
static void amplifier_name(const struct dea_protocol *protocol, char out[STEP_NAME_SIZE])
{
  const char *name = protocol->amplifier.name.text;
  snprintf(out, STEP_NAME_SIZE, "the amplifier%s%s", name[0] != '\0' ? " " : "", name);
}

// Amplifier --------------------------------------------------------------------------------------

/* The farthest voltages, each with the first step that has it. */
static void find_peaks(const struct dea_protocol *protocol, struct peak *low, struct peak *high)
{
  *low = *high = (struct peak){0};
  for (size_t i = 0; i < protocol->step_count; i++) {
    const struct dea_protocol_step *step = &protocol->steps[i];
    if (step->lowest_V < low->voltage_V) {
      *low = (struct peak){step->lowest_V, i};
    }
    if (step->highest_V > high->voltage_V) {
      *high = (struct peak){step->highest_V, i};
    }
  }
}

static dea_status check_voltage(struct dea_context *ctx, const struct dea_protocol *protocol,
                                const struct peak *peak)
{
  static const double rounding = 1e-9;
  bool low = peak->voltage_V < 0;
  double limit_V = low ? protocol->amplifier.lowest_V.si : protocol->amplifier.highest_V.si;
  double control_V = fabs(peak->voltage_V) / protocol->amplifier.gain.si;
  // a sine of a mean of 2.01 kV and an amplitude of 2010 V comes to 0 V but for rounding
  double most_V = fmax(protocol->amplifier.highest_V.si, -protocol->amplifier.lowest_V.si);
  char step[STEP_NAME_SIZE], amplifier[STEP_NAME_SIZE];
  struct dea_location location = voltage_location(protocol, peak->step, peak->voltage_V);
  step_name(protocol, peak->step, step);
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
                                 const struct peak *peak)
{
  const struct dea_specimen *specimen = &protocol->specimen;
  char step[STEP_NAME_SIZE];
  if (specimen->highest_V.origin == DEA_ABSENT ||
      fabs(peak->voltage_V) <= specimen->highest_V.si * (1 + 1e-9)) {
    return DEA_OK;
  }
  step_name(protocol, peak->step, step);
  return dea_finding_add(ctx, DEA_ERROR, voltage_location(protocol, peak->step, peak->voltage_V),
                         "refused: the sequence asks for %g kV at %s, the specimen '%.60s' stands "
                         "%g kV by line %zu of %.200s, which no option changes",
                         1e-3 * peak->voltage_V, step, specimen->name.text,
                         1e-3 * specimen->highest_V.si, specimen->highest_V.location.line,
                         specimen->highest_V.location.file);
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
                             const struct slopes *slopes, struct dea_protocol_plan *plan)
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
  struct dea_location location = voltage_location(protocol, slopes->jump_step, slopes->jump_V);
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
                               const struct slopes *slopes, const struct dea_protocol_plan *plan)
{
  const struct dea_quantity *slew = &protocol->amplifier.slew_V_per_s;
  const struct dea_quantity *limit = &protocol->amplifier.current_A;
  char step[STEP_NAME_SIZE];
  double current_A = plan->capacitance_F * slopes->slope_V_per_s; // or NAN
  step_name(protocol, slopes->slope_step, step);
  struct dea_location location = protocol->steps[slopes->slope_step].section->location;
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
                             const struct slopes *slopes)
{
  static const double rate_least_Hz = 10;
  double samples = protocol->rate_Hz.si * slopes->cycle_s;
  char step[STEP_NAME_SIZE];
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
  step_name(protocol, slopes->cycle_step, step);
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

// All of it ---------------------------------------------------------------------------------------

dea_status dea_protocol_check(struct dea_context *ctx, const struct dea_protocol *protocol,
                              struct dea_protocol_plan *plan)
{
  struct peak low, high;
  struct slopes slopes;
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  find_peaks(protocol, &low, &high);
  find_slopes(protocol, &slopes);
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
  DEA_TRY(ctx, check_film(ctx, protocol, -low.voltage_V > high.voltage_V ? &low : &high, plan));
  DEA_TRY(ctx, check_rise(ctx, protocol, &slopes, plan));
  DEA_TRY(ctx, check_slopes(ctx, protocol, &slopes, plan));
  DEA_TRY(ctx, check_inputs(ctx, protocol, plan));
  DEA_TRY(ctx, check_ramp(ctx, protocol, plan));
  DEA_TRY(ctx, check_rate(ctx, protocol, &slopes));
  DEA_TRY(ctx, check_interlocks(ctx, protocol, plan));
  DEA_TRY(ctx, check_labels(ctx, protocol));
  DEA_TRY(ctx, check_size(ctx, protocol, plan));
  size_t found = dea_finding_count(ctx, DEA_ERROR) - errors;
  return found > 0 ? dea_fail(ctx, DEA_E_INTERLOCK, "'%s' must not be played: %zu limit%s exceeded",
                              protocol->file, found, found > 1 ? "s are" : " is")
                   : DEA_OK;
}
