/* Study "loading": a body of a device is moved along a way, pushed by a dead
 * force, or the pressures on the device change, at some voltages, or the supply gives a charge:
 * curves of force against displacement, and the blocked force. Each voltage starts from rest with a
 * model of its own; a line that stops leaves its points, and the next one has its turn. */
#include "study/loading.h"
#include "base/schema.h"
#include "study/observe.h"
#include "study/time_stepper.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static const char study_name[] = "loading";

// Keys -------------------------------------------------------------------------------------------

/* What goes along its values. */
enum range { SHIFT, TURN, FORCE, PRESSURE, CHARGE, RANGES };

/* Settings of compute.loading; without a range nothing is computed. */
struct settings {
  struct dea_label body, channel;
  struct dea_choice direction; // component of the body
  struct dea_quantity from[RANGES], to[RANGES], steps;
  struct dea_quantity duration_s; // NaN: slowly
  struct dea_choice back;
  struct dea_quantity voltages_V[DEA_DESIGN_STOPS_MAX]; // none: 0 and quarters of the highest
  size_t voltage_count;
};

#define AT(member) offsetof(struct settings, member)

static const char *const directions[] = {"x", "y", "z", "turn_x", "turn_y", "turn_z", NULL};

#define ENDS(which, begin, end, in, what, first, last)                                             \
  DEA_NUMBER_ROW(begin, AT(from[which]), in, first, what ", where the line begins",                \
                 .absent_text = "none"),                                                           \
      DEA_NUMBER_ROW(end, AT(to[which]), in, last, "where it ends", .absent_text = "none")

static const struct dea_field fields[] = {
    DEA_LABEL_ROW("body", AT(body), "hub",
                  "name of the body that is moved or pushed; with pressures: that is looked at",
                  .absent_text = "none"),
    DEA_CHOICE_ROW("direction", AT(direction), directions, "z",
                   "along which axis, or about which, the body is moved or pushed",
                   .default_text = "z"),
    ENDS(SHIFT, "from", "to", "m", "shift at which the body is held", "0 mm", "5 mm"),
    ENDS(TURN, "turn_from", "turn_to", "radian", "the same of a turn", "0 degree", "10 degree"),
    ENDS(FORCE, "force_from", "force_to", "N",
         "dead force on the body, which stays free, in place of its own", "0 mN", "200 mN"),
    ENDS(PRESSURE, "pressure_from", "pressure_to", "Pa",
         "largest pressure on the device; all others go in proportion", "0 kPa", "2 kPa"),
    ENDS(CHARGE, "charge_from", "charge_to", "C",
         "charge of the supply on the channels, each times its ratio, in place of a voltage",
         "0 nC", "500 nC"),
    DEA_LABEL_ROW("channel", AT(channel), "sense",
                  "channel that takes the charge in place of its voltage while the others are at "
                  "the voltages; 0 nC: it is open",
                  .absent_text = "the supply"),
    DEA_INTEGER_ROW("steps", AT(steps), "20", "equal steps from the first value to the last",
                    .min = 1, .max = 1000, .default_text = "10"),
    DEA_NUMBER_ROW("duration", AT(duration_s), "s", "10 s",
                   "time from the first value to the last, of a shift or a turn at a constant "
                   "rate: viscous branches take part",
                   .min = 0, .above_min = true, .max = 1e9, .absent_text = "slowly"),
    DEA_CHOICE_ROW("back", AT(back), dea_no_yes, "yes",
                   "whether each line goes back the same way: snapping shows as hysteresis",
                   .default_text = "no"),
    DEA_STUDY_STOPS_FIELD("0 V and the quarters of the highest", "voltages of the lines",
                          "[0 kV, 3 kV, 5 kV]"),
};

/* The range that is asked for; RANGES: none. */
static enum range range_of(const struct settings *settings)
{
  int k = 0;
  while (k < RANGES && isnan(settings->from[k].si) && isnan(settings->to[k].si)) {
    k++;
  }
  return (enum range)k;
}

static dea_status wrong(struct dea_context *ctx, const struct settings *settings, const char *text)
{
  return dea_finding_add(ctx, DEA_ERROR, settings->steps.location, "loading: %s", text);
}

static dea_status check(struct dea_context *ctx, const struct dea_design *design,
                        const struct dea_settings *given)
{
  const struct settings *s = given->values;
  enum range range = range_of(s);
  bool turns = s->direction.value >= 3;
  (void)design;
  if (!given->written) {
    return DEA_OK;
  }
  if (range == RANGES) {
    return wrong(ctx, s,
                 "from and to are missing (or turn_, force_, pressure_, charge_from and _to)");
  }
  if (isnan(s->from[range].si) || isnan(s->to[range].si)) {
    DEA_TRY(ctx, wrong(ctx, s, "a line needs both where it begins and where it ends"));
  }
  for (int k = (int)range + 1; k < RANGES; k++) {
    if (!isnan(s->from[k].si) || !isnan(s->to[k].si)) {
      DEA_TRY(ctx, wrong(ctx, s, "shift, turn, force, pressure and charge exclude each other"));
    }
  }
  if (s->from[range].si == s->to[range].si) {
    DEA_TRY(ctx, wrong(ctx, s, "the line ends where it begins"));
  }
  if (!isnan(s->duration_s.si) && range > TURN) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, s->duration_s.location,
                                 "loading: a duration goes with a shift or a turn"));
  }
  if (range == CHARGE && s->voltage_count > 0 && s->channel.text[0] == '\0') {
    DEA_TRY(ctx, wrong(ctx, s, "a charge is given in place of voltages (of one channel: channel)"));
  }
  if (range != CHARGE && s->channel.text[0] != '\0') {
    DEA_TRY(ctx, wrong(ctx, s, "a channel goes with charge_from and charge_to"));
  }
  if (range < PRESSURE && s->body.text[0] == '\0') {
    DEA_TRY(ctx, wrong(ctx, s, "which body? (body: NAME)"));
  }
  if (range < PRESSURE && turns != (range == TURN)) {
    return dea_finding_add(ctx, DEA_ERROR, s->direction.location, "loading: %s",
                           turns ? "a turn goes from turn_from to turn_to"
                                 : "turn_from and turn_to need direction: turn_x, turn_y, turn_z");
  }
  return DEA_OK;
}

/* Pressure of the layout that is largest in size; 0: none. */
static double largest_Pa(const struct dea_layout *layout)
{
  double most = 0;
  for (size_t i = 0; i < layout->pressure_count; i++) {
    double p = layout->pressures[i].pressure_Pa;
    most = fabs(p) > fabs(most) ? p : most;
  }
  return most;
}

static dea_status unknown(struct dea_context *ctx, const struct dea_label *label,
                          const struct dea_layout *layout, bool channel)
{
  const char *known[DEA_DESIGN_STOPS_MAX] = {NULL};
  const size_t all = channel ? layout->channel_count - 1 : layout->body_count; // but for ground
  const size_t count = all < DEA_COUNT(known) ? all : DEA_COUNT(known);
  for (size_t i = 0; i < count; i++) {
    known[i] = channel ? layout->channels[i + 1].name : layout->bodies[i].name;
  }
  char hint[DEA_HINT_SIZE];
  return dea_finding_add(ctx, DEA_ERROR, label->location, "loading: the device has no %s '%s'%s",
                         channel ? "channel" : "body", label->text,
                         dea_name_hint(label->text, known, count, hint));
}

/* Number of the channel with a charge; 0: none, ground, or no such one. */
static size_t channel_of(const struct settings *s, const struct dea_layout *layout)
{
  const size_t k = dea_layout_find_channel(layout, s->channel.text);
  return k != DEA_LAYOUT_NONE ? k : 0;
}

static dea_status fit(struct dea_context *ctx, const struct dea_settings *given,
                      const struct dea_device *device)
{
  const struct settings *s = given->values;
  enum range range = range_of(s);
  if (range == RANGES) {
    return DEA_OK;
  }
  if (device->layout == NULL) { // of the short form
    return wrong(ctx, s,
                 "only designs with plies have bodies and pressures (key plies); "
                 "compute.force presses a tip against the disc");
  }
  if (s->body.text[0] != '\0' &&
      dea_layout_find_body(device->layout, s->body.text) == DEA_LAYOUT_NONE) {
    DEA_TRY(ctx, unknown(ctx, &s->body, device->layout, false));
  }
  if (s->channel.text[0] != '\0' && channel_of(s, device->layout) == 0) {
    DEA_TRY(ctx, unknown(ctx, &s->channel, device->layout, true));
  }
  if (range == PRESSURE && largest_Pa(device->layout) == 0) {
    return wrong(ctx, s, "the device has no pressure (pressures: ...) that could change");
  }
  return DEA_OK;
}

static const struct dea_design_section section = {
    .record = {study_name,
               "study of force against displacement of a body, or of pressures, at voltages, or of "
               "a charge (3d, devices of the general form)",
               fields, DEA_COUNT(fields)},
    .size = sizeof(struct settings),
    .check = check,
    .fit = fit};

static const struct settings *settings_of(const struct dea_design *design)
{
  const struct dea_settings *given = dea_design_settings(design, &section);
  return given != NULL ? given->values : NULL;
}

bool dea_loading_asked(const struct dea_design *design)
{
  const struct settings *settings = settings_of(design);
  return settings != NULL && range_of(settings) != RANGES;
}

// Tables -----------------------------------------------------------------------------------------

#define VOLTAGE DEA_KV("voltage_V", "V", "voltage of the line")
static const char degree[] = "deg";
static const double degrees = 57.29577951308232;

/* What a point says beside its voltage; columns in this order. */
enum value { AT_SHIFT, AT_TURN, OF_FORCE, OF_MOMENT, AT_PRESSURE, AT_CHARGE, VALUES };

static const struct dea_result_column point_columns[] = {
    VOLTAGE,
    DEA_RESULT_COLUMN(COUNT, "point", "point", .meaning = "number of the point, from 1"),
    DEA_RESULT_COLUMN(FLAG, "back", "back", .meaning = "on the way back"),
    DEA_MM("shift_m", "shift", "of the body along the direction"),
    DEA_NUMBER_COLUMN("turn_rad", "rad", degree, degrees, "turn", "of the body"),
    DEA_MN("force_N", "force", "of what holds or pushes the body"),
    DEA_NUMBER_COLUMN("moment_N_m", "N m", "uN m", 1e6, "moment", "of what holds the body"),
    DEA_NUMBER_COLUMN("pressure_Pa", "Pa", "kPa", 1e-3, "pressure", "the largest on the device"),
    DEA_NUMBER_COLUMN("charge_C", "C", "nC", 1e9, "charge", "given of the supply or a channel"),
    DEA_KV("supply_voltage_V", "supply", "voltage that this has then"),
    DEA_MM("highest_z_m", "highest z", "largest displacement out of the plane"),
    DEA_MM("lowest_z_m", "lowest z", "smallest displacement out of the plane"),
    DEA_UJ("energy_J", "energy", "potential energy at this voltage, 0 at rest"),
    DEA_NUMBER_COLUMN("min_tension_N_per_m", "N/m", "N/m", 1, "smallest tension",
                      "below 0 the film is slack"),
    DEA_RESULT_COLUMN(COUNT, "unstable_modes", "unstable modes",
                      .meaning = "of the device as it is held"),
    DEA_RESULT_COLUMN(FLAG, "trusted", "trusted",
                      .meaning = "whether the numbers are to be trusted"),
    DEA_TEXT_COLUMN("flags", "flags", "what has to be known of them (docs/theory/trust.md)"),
};

static const struct dea_result_column line_columns[] = {
    VOLTAGE,
    DEA_MN("blocked_force_N", "blocked force", "that holds the body at shift 0, minus that at 0 V"),
    DEA_NUMBER_COLUMN("blocked_moment_N_m", "N m", "uN m", 1e6, "blocked moment",
                      "that holds the body at turn 0, minus that at 0 V"),
    DEA_MN("peak_force_N", "peak force",
           "first maximum of the force on the way: a weight above it snaps through"),
    DEA_MM("peak_shift_m", "at shift", "shift of that maximum"),
    DEA_MN("least_force_N", "least force",
           "first minimum of the force beyond it: a weight below it snaps back"),
    DEA_MM("least_shift_m", "at shift", "shift of that minimum"),
    DEA_RESULT_COLUMN(COUNT, "points", "points", .meaning = "of the line"),
    DEA_RESULT_COLUMN(FLAG, "complete", "complete", .meaning = "whether the line came to its end"),
    DEA_TEXT_COLUMN("stopped", "stopped", "why it did not"),
};

static const struct dea_result_table_type tables[] = {
    DEA_RESULT_TABLE(study_name, "points", point_columns, .title = "Loading",
                     .where = DEA_IN_JSON | DEA_IN_CSV),
    DEA_RESULT_TABLE(study_name, "lines", line_columns,
                     .title = "Lines of force against displacement",
                     .where = DEA_IN_JSON | DEA_IN_CSV | DEA_IN_SCREEN),
};
enum { POINTS, LINES, TABLES };

// Study ------------------------------------------------------------------------------------------

struct loading {
  struct dea_study_job job; // with the model of the line
  const struct settings *settings;
  enum range range;
  struct dea_control control;
  size_t body;          // that is looked at; DEA_LAYOUT_NONE
  double scale;         // of a value for the model
  size_t table[TABLES]; // of the result
  size_t curve, point;  // of the result, and the number of the last one
  size_t done, total;   // points
  /* Of the line */
  double voltage_V, blocked[2]; // force or moment at rest and at the voltage
  double x[3], f[3];            // the last places and forces, the newest first
  size_t count;
  double peak_at, peak;   // NAN: none so far
  double least_at, least; // the same of the minimum beyond it
  /* Of the line with a duration, once its history has begun */
  bool is_timed;
  double value, step_s; // of the control now; of the next step in time
};

static double value_at(const struct loading *l, size_t i)
{
  double from = l->settings->from[l->range].si, to = l->settings->to[l->range].si;
  double steps = l->settings->steps.si;
  return from + (to - from) * (double)i / steps;
}

/* Place of the body and what holds or pushes it; NAN without one. */
static void check_body(const struct loading *l, const struct dea_observation *seen, double value,
                       double out[VALUES])
{
  int component = l->control.component;
  for (int k = 0; k < VALUES; k++) {
    out[k] = NAN;
  }
  if (l->body != DEA_LAYOUT_NONE) {
    const double *body = seen->body[l->body];
    out[component < 3 ? AT_SHIFT : AT_TURN] = body[DEA_OBSERVED_X + component];
    out[component < 3 ? OF_FORCE : OF_MOMENT] = body[DEA_OBSERVED_FORCE_X + component];
  }
  if (l->range == FORCE) {
    out[OF_FORCE] = value;
  }
  if (l->range >= PRESSURE) {
    out[l->range == PRESSURE ? AT_PRESSURE : AT_CHARGE] = value;
  }
}

/* A maximum of the force on the way out and the minimum beyond it, by parabolas, and a snap-through
 * of a body that is pushed. */
static dea_status watch(struct dea_context *ctx, struct loading *l, bool back, double x, double f)
{
  memmove(l->x + 1, l->x, 2 * sizeof *l->x);
  memmove(l->f + 1, l->f, 2 * sizeof *l->f);
  l->x[0] = x;
  l->f[0] = f;
  if (++l->count < 3) {
    return DEA_OK;
  }
  double step[2] = {l->x[1] - l->x[2], l->x[0] - l->x[1]};
  double slope[2] = {(l->f[1] - l->f[2]) / step[0], (l->f[0] - l->f[1]) / step[1]};
  bool highest = isnan(l->peak) && slope[0] > 0 && slope[1] < 0;
  bool lowest = !isnan(l->peak) && isnan(l->least) && slope[0] < 0 && slope[1] > 0;
  if (l->range == SHIFT && !back && (highest || lowest)) {
    double bend = (slope[1] - slope[0]) / (step[0] + step[1]);
    double rise = slope[0] + bend * step[0]; // at the middle one
    *(highest ? &l->peak_at : &l->least_at) = l->x[1] - 0.5 * rise / bend;
    *(highest ? &l->peak : &l->least) = l->f[1] - 0.25 * rise * rise / bend;
  }
  if (l->range == FORCE && fabs(step[1]) > 5 * fabs(step[0]) && step[0] != 0) {
    return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                           "loading: at %.4g kV the body snaps from %.4g to %.4g mm between %.4g "
                           "and %.4g mN: it snaps through, or the steps are too long",
                           1e-3 * l->voltage_V, 1e3 * l->x[1], 1e3 * l->x[0], 1e3 * l->f[1],
                           1e3 * l->f[0]);
  }
  return DEA_OK;
}

/* A move in the history that has begun, and how long it takes. */
struct move {
  struct loading *loading;
  double from, to, time_s;
};

/* `set` of a stepper. */
static void set_control(void *user, double to_s, bool last, struct dea_time_step *step)
{
  const struct move *move = user;
  step->source_voltage_V = move->loading->voltage_V;
  step->control = &move->loading->control;
  step->value = last ? move->to : move->from + to_s / move->time_s * (move->to - move->from);
}

/* Moves in it from a value to the next at the rate of the study. */
static dea_status move_in_time(struct dea_context *ctx, struct loading *l, double from, double to,
                               struct dea_load_point *at)
{
  struct move move = {l, from, to, l->settings->duration_s.si / l->settings->steps.si};
  const double shortest_s = 1e-7 * move.time_s;
  struct dea_stepper stepper = {l->step_s, INFINITY,    shortest_s, shortest_s,
                                1e-3,      set_control, &move};
  double now_s = 0;
  bool last = false;
  while (!last) {
    DEA_TRY(ctx, dea_stepper_step(ctx, &stepper, l->job.type, l->job.model, move.time_s, &now_s,
                                  &last, at));
    l->step_s = stepper.next_s;
  }
  return DEA_OK;
}

/* The control goes to a value, at a rate from the one before or slowly. */
static dea_status move_to(struct dea_context *ctx, struct loading *l, double value,
                          struct dea_load_point *at)
{
  static const struct dea_time_options options = {.circuit = {.current_limit_A = INFINITY}};
  const double to = l->scale * value, from = l->value;
  l->value = to;
  if (l->is_timed) {
    return move_in_time(ctx, l, from, to, at);
  }
  DEA_TRY(ctx, l->job.type->move(ctx, l->job.model, &l->control, to, at));
  if (!isnan(l->settings->duration_s.si)) {
    struct dea_load_point start;
    l->is_timed = true;
    l->step_s = 1e-3 * l->settings->duration_s.si;
    DEA_TRY(ctx, l->job.type->begin(ctx, l->job.model, &options, &start));
  }
  return DEA_OK;
}

/* The control goes to a value; a row of it. */
static dea_status solve_point(struct dea_context *ctx, struct loading *l, double value, bool back)
{
  struct dea_load_point at;
  struct dea_observation seen;
  double v[VALUES];
  char flags[DEA_FLAGS_SIZE];
  if (dea_interrupted_anywhere(ctx)) {
    return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted; %zu points are kept", l->point);
  }
  DEA_TRY(ctx, move_to(ctx, l, value, &at));
  DEA_TRY(ctx, l->job.type->observe(ctx, l->job.model, &seen));
  check_body(l, &seen, value, v);
  const struct dea_event *passed =
      l->job.type->passed != NULL ? l->job.type->passed(l->job.model) : NULL;
  double *limit = back ? &l->least : &l->peak;
  if (passed != NULL && l->range == FORCE && isnan(*limit)) {
    *limit = passed->point.force_N;
  }
  l->point++;
  DEA_TRY(ctx,
          DEA_TABLE_ADD(ctx, &l->job.result->tables[l->table[POINTS]], DEA_CELL(l->voltage_V),
                        DEA_CELL((double)l->point), DEA_CELL(back), DEA_CELL(v[AT_SHIFT]),
                        DEA_CELL(v[AT_TURN]), DEA_CELL(v[OF_FORCE]), DEA_CELL(v[OF_MOMENT]),
                        DEA_CELL(v[AT_PRESSURE]), DEA_CELL(v[AT_CHARGE]),
                        DEA_CELL(l->range != CHARGE    ? NAN
                                 : l->control.body > 0 ? seen.channel[l->control.body].voltage_V
                                                       : at.voltage_V),
                        DEA_CELL(at.highest_z_m), DEA_CELL(at.lowest_z_m), DEA_CELL(at.energy_J),
                        DEA_CELL(at.min_tension_N_per_m), DEA_CELL(at.unstable_modes),
                        DEA_CELL(dea_load_point_trusted(&at)),
                        DEA_TEXT_CELL(dea_flags_text(dea_load_point_flags(&at), flags))));
  DEA_TRY(ctx, dea_study_add_point(ctx, &l->job, l->job.result->device, &at,
                                   &l->job.result->curves[l->curve]));
  DEA_TRY(ctx, watch(ctx, l, back, v[AT_SHIFT], v[OF_FORCE]));
  dea_study_progress(ctx, &l->job, study_name, ++l->done, l->total);
  return DEA_OK;
}

/* Holds the body at 0 at rest and at the voltage, each with what that takes. */
static dea_status block(struct dea_context *ctx, struct loading *l)
{
  struct dea_load_point at;
  struct dea_observation seen;
  for (int i = 0; i < 2; i++) {
    double v[VALUES];
    if (i == 0) {
      DEA_TRY(ctx, l->job.type->move(ctx, l->job.model, &l->control, 0, &at));
    } else {
      DEA_TRY(ctx, l->job.type->solve(ctx, l->job.model, l->voltage_V, &at));
    }
    DEA_TRY(ctx, l->job.type->observe(ctx, l->job.model, &seen));
    check_body(l, &seen, 0, v);
    l->blocked[i] = v[l->range == SHIFT ? OF_FORCE : OF_MOMENT];
  }
  return DEA_OK;
}

/* A model at the voltage, before the way of the control. */
static dea_status begin(struct dea_context *ctx, struct loading *l)
{
  struct dea_load_point at;
  bool upright = l->control.kind >= DEA_CONTROL_PRESSURE || l->control.component == 2;
  DEA_TRY(ctx, (upright ? dea_model_create : dea_model_create_whole)(
                   ctx, l->job.type, l->job.result->design, l->job.result->device, &l->job.model));
  if (l->control.kind == DEA_CONTROL_PLACE) {
    DEA_TRY(ctx, block(ctx, l));
  } else {
    if (l->range == CHARGE && l->control.body > 0) { // open, before the others have a voltage
      DEA_TRY(ctx, l->job.type->move(ctx, l->job.model, &l->control, 0, &at));
    }
    DEA_TRY(ctx, l->job.type->solve(ctx, l->job.model, l->voltage_V, &at));
  }
  return DEA_OK;
}

static dea_status go(struct dea_context *ctx, struct loading *l)
{
  size_t steps = (size_t)l->settings->steps.si;
  DEA_TRY(ctx, begin(ctx, l));
  for (size_t i = 0; i <= steps; i++) {
    DEA_TRY(ctx, solve_point(ctx, l, value_at(l, i), false));
  }
  for (size_t i = l->settings->back.value == 1 ? steps : 0; i-- > 0;) {
    DEA_TRY(ctx, solve_point(ctx, l, value_at(l, i), true));
  }
  return DEA_OK;
}

/* A line with its row; its status is why it stopped. */
static dea_status follow(struct dea_context *ctx, struct loading *l, double voltage_V)
{
  size_t before = l->point;
  char why[256] = "";
  l->job.model = NULL;
  l->voltage_V = voltage_V;
  l->blocked[0] = l->blocked[1] = NAN;
  l->peak = l->peak_at = l->least = l->least_at = NAN;
  l->count = 0;
  l->is_timed = false;
  dea_status stopped = go(ctx, l);
  if (l->job.model != NULL) {
    l->job.type->destroy(ctx, l->job.model);
  }
  if (stopped != DEA_OK) {
    snprintf(why, sizeof why, "%s", dea_context_message(ctx));
  }
  double blocked = l->blocked[1] - l->blocked[0];
  DEA_TRY(ctx, DEA_TABLE_ADD(ctx, &l->job.result->tables[l->table[LINES]], DEA_CELL(voltage_V),
                             DEA_CELL(l->range == SHIFT ? blocked : NAN),
                             DEA_CELL(l->range == TURN ? blocked : NAN), DEA_CELL(l->peak),
                             DEA_CELL(l->peak_at), DEA_CELL(l->least), DEA_CELL(l->least_at),
                             DEA_CELL((double)(l->point - before)), DEA_CELL(stopped == DEA_OK),
                             DEA_TEXT_CELL(why)));
  return stopped == DEA_OK ? DEA_OK
                           : dea_fail(ctx, stopped, "the line at %.4g kV has %zu points: %s",
                                      1e-3 * voltage_V, l->point - before, why);
}

static dea_status follow_all(struct dea_context *ctx, struct loading *l, const double *voltages_V,
                             size_t count)
{
  dea_status first = DEA_OK;
  char why[256] = "";
  for (size_t i = 0; i < count; i++) {
    dea_status status = follow(ctx, l, voltages_V[i]);
    if (dea_status_ends(status)) {
      return status;
    }
    if (status != DEA_OK && first == DEA_OK) {
      first = status;
      snprintf(why, sizeof why, "%s", dea_context_message(ctx));
    }
    dea_context_clear(ctx);
  }
  return first == DEA_OK ? DEA_OK : dea_fail(ctx, first, "%s", why);
}

static void choose_control(struct loading *l)
{
  static const enum dea_control_kind kinds[RANGES] = {DEA_CONTROL_PLACE, DEA_CONTROL_PLACE,
                                                      DEA_CONTROL_FORCE, DEA_CONTROL_PRESSURE,
                                                      DEA_CONTROL_CHARGE};
  const struct dea_layout *layout = l->job.result->device->layout;
  l->body = l->settings->body.text[0] != '\0' ? dea_layout_find_body(layout, l->settings->body.text)
                                              : DEA_LAYOUT_NONE;
  l->scale = l->range == PRESSURE ? 1 / largest_Pa(layout) : 1;
  l->control =
      (struct dea_control){.kind = kinds[l->range],
                           .body = l->range == CHARGE ? channel_of(l->settings, layout) : l->body,
                           .component = l->settings->direction.value};
}

static struct loading loading_of(const struct dea_study_job *job)
{
  const struct settings *settings = settings_of(job->result->design);
  struct loading l = {.job = *job, .settings = settings, .range = range_of(settings)};
  choose_control(&l);
  return l;
}

dea_status dea_loading_end(struct dea_context *ctx, struct dea_study_job *job, double voltage_V,
                           struct dea_load_point *at, struct dea_loaded *loaded)
{
  struct loading l = loading_of(job);
  const size_t steps = (size_t)l.settings->steps.si;
  l.voltage_V = voltage_V;
  dea_status status = begin(ctx, &l);
  for (size_t i = 0; i <= steps && status == DEA_OK; i++) {
    status = move_to(ctx, &l, value_at(&l, i), at);
  }
  if (status != DEA_OK && l.job.model != NULL) {
    l.job.type->destroy(ctx, l.job.model);
    l.job.model = NULL;
  }
  *loaded = (struct dea_loaded){l.control, value_at(&l, steps)};
  job->model = l.job.model;
  return status;
}

static dea_status add_tables(struct dea_context *ctx, struct loading *l)
{
  struct dea_curve *curve;
  for (int k = 0; k < TABLES; k++) {
    struct dea_result_table *table;
    DEA_TRY(ctx,
            dea_result_add_table(ctx, l->job.result, &tables[k], l->job.type->name, 0, &table));
    l->table[k] = (size_t)(table - l->job.result->tables);
  }
  DEA_TRY(ctx, dea_result_add_curve(ctx, l->job.result, l->job.type->name, study_name, &curve));
  l->curve = (size_t)(curve - l->job.result->curves);
  return DEA_OK;
}

static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  struct loading l = loading_of(job);
  const struct settings *settings = l.settings;
  double voltages_V[DEA_DESIGN_STOPS_MAX] = {0};
  size_t count = l.range == CHARGE && settings->channel.text[0] == '\0'
                     ? 1
                     : dea_study_stops(job->result->design, settings->voltages_V,
                                       settings->voltage_count, true, voltages_V);
  l.total = count * ((size_t)settings->steps.si * (settings->back.value == 1 ? 2 : 1) + 1);
  DEA_TRY(ctx, add_tables(ctx, &l));
  dea_status status = follow_all(ctx, &l, voltages_V, count);
  return dea_curve_end(ctx, &job->result->curves[l.curve], status);
}

// Figure -----------------------------------------------------------------------------------------

enum { LINES_SHOWN = 8, COLOURS = 6 };

/* The two columns of the figure, and their words. */
struct axes {
  const char *x, *y, *x_label, *y_label;
  double x_factor, y_factor;
};

static bool has(const struct dea_result_table *table, const char *key)
{
  for (size_t i = 0; i < table->row_count; i++) {
    if (!isnan(dea_result_table_number(table, i, key, 0))) {
      return true;
    }
  }
  return false;
}

/* Of the two heights the larger one in size. */
static const char *height_of(const struct dea_result_table *table)
{
  double high = 0, low = 0;
  for (size_t i = 0; i < table->row_count; i++) {
    high = fmax(high, dea_result_table_number(table, i, "highest_z_m", 0));
    low = fmin(low, dea_result_table_number(table, i, "lowest_z_m", 0));
  }
  return high >= -low ? "highest_z_m" : "lowest_z_m";
}

/* The first axes that there is something of. */
static struct axes axes_of(const struct dea_result_table *table)
{
  static const char shift[] = "Displacement of the body (mm)", turn[] = "Turn of the body (deg)",
                    pressure[] = "Pressure (kPa)";
  const struct axes all[] = {
      {"pressure_Pa", "turn_rad", pressure, turn, 1e-3, degrees},
      {"pressure_Pa", "shift_m", pressure, shift, 1e-3, 1e3},
      {"pressure_Pa", height_of(table), pressure, "Height of the film (mm)", 1e-3, 1e3},
      {"charge_C", "supply_voltage_V", "Charge (nC)", "Voltage (kV)", 1e9, 1e-3},
      {"turn_rad", "moment_N_m", turn, "Moment ({/Symbol m}N m)", degrees, 1e6},
      {"shift_m", "force_N", shift, "Force {/:Italic F} (mN)", 1e3, 1e3},
  };
  size_t k = 0;
  while (k + 1 < DEA_COUNT(all) && !(has(table, all[k].x) && has(table, all[k].y))) {
    k++;
  }
  return all[k];
}

/* End of the rows that are of one line and one way. */
static size_t part_end(const struct dea_result_table *table, size_t first)
{
  static const char *const same[] = {"voltage_V", "back"};
  size_t end = first;
  bool goes_on = true;
  while (end < table->row_count && goes_on) {
    for (size_t k = 0; k < DEA_COUNT(same); k++) {
      goes_on = goes_on && dea_result_table_number(table, end, same[k], 0) ==
                               dea_result_table_number(table, first, same[k], 0);
    }
    end += goes_on;
  }
  return end;
}

/* Whether there is nothing against a row but that its film is a membrane, which all rows share. */
static bool is_sound(const struct dea_result_table *table, size_t row)
{
  return (dea_flags_of_text(dea_result_table_text(table, row, "flags")) &
          ~(1u << DEA_FLAG_PREVIEW)) == 0;
}

/* Rows from `first` on into a series: those that are sound, or the others and the next ones to
 * them, so that no gap is left. Returns whether all are sound. */
static bool fill_line(const struct dea_result_table *table, const struct axes *axes, size_t first,
                      bool sound, struct dea_series *series)
{
  const size_t count = series->count;
  bool all = true;
  for (size_t i = 0; i < count; i++) {
    const size_t row = first + i;
    const bool here = is_sound(table, row);
    const bool shown = sound ? here
                             : !here || (i > 0 && !is_sound(table, row - 1)) ||
                                   (i + 1 < count && !is_sound(table, row + 1));
    series->values[i] = axes->x_factor * dea_result_table_number(table, row, axes->x, 0);
    series->values[count + i] =
        shown ? axes->y_factor * dea_result_table_number(table, row, axes->y, 0) : NAN;
    all = all && here;
  }
  return all;
}

/* Rows [first, end) as the number-th line; one back joins the turning point to its rows. Stretches
 * that are not sound are grey beside the line. */
static dea_status add_line(struct dea_context *ctx, struct dea_panel *panel,
                           const struct dea_result_table *table, const struct axes *axes,
                           size_t number, size_t first, size_t end)
{
  static const enum dea_colour order[COLOURS] = {DEA_BLUE,   DEA_VERMILLION, DEA_GREEN,
                                                 DEA_PURPLE, DEA_ORANGE,     DEA_BLACK};
  bool back = dea_result_table_number(table, first, "back", 0) == 1;
  struct dea_series *series;
  first -= back && first > 0;
  size_t count = end - first;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, count, back ? DEA_DASHED : DEA_LINE_MARKED,
                             order[number % COLOURS], "", &series));
  series->marker = (int)(number % COLOURS);
  if (!back) {
    snprintf(series->title, sizeof series->title, "%.4g kV",
             1e-3 * dea_result_table_number(table, first, "voltage_V", 0));
  }
  if (!fill_line(table, axes, first, true, series)) {
    DEA_TRY(ctx, dea_panel_add(ctx, panel, count, DEA_DASHED, DEA_GREY, "", &series));
    fill_line(table, axes, first, false, series);
  }
  return DEA_OK;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  const struct dea_result_table *table = NULL;
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX), number = 0;
  for (size_t m = 0; m < count && table == NULL; m++) {
    table = dea_result_find_table(result, models[m], study_name, tables[POINTS].name);
  }
  if (table == NULL || table->row_count == 0) {
    return DEA_OK;
  }
  const struct axes axes = axes_of(table);
  for (size_t first = 0; first < table->row_count && number <= LINES_SHOWN;) {
    size_t end = part_end(table, first);
    bool back = dea_result_table_number(table, first, "back", 0) == 1;
    number += !back;
    if (number <= LINES_SHOWN) {
      DEA_TRY(ctx, add_line(ctx, panel, table, &axes, number - 1, first, end));
    }
    first = end;
  }
  snprintf(panel->x_label, sizeof panel->x_label, "%s", axes.x_label);
  snprintf(panel->y_label, sizeof panel->y_label, "%s", axes.y_label);
  dea_panel_place_key(panel);
  return DEA_OK;
}

static const struct dea_figure figures[] = {
    DEA_STUDY_FIGURE(
        "loading", study_name, build,
        "force that holds or pushes a body against its displacement, or displacement "
        "against the pressure, for each voltage, or voltage against charge; dashed: the way "
        "back; grey: not to be trusted"),
};

// The study --------------------------------------------------------------------------------------

const struct dea_study dea_study_loading = {
    .name = study_name,
    .keys = &section,
    .asked = dea_loading_asked,
    .needs = "compute.loading.from and to, or turn_, force_, pressure_, charge_from and to",
    .own_models = true,
    .ability = "bodies and pressures",
    .able_by = offsetof(struct dea_model_type, move),
    .run = run,
    .figures = figures,
    .figure_count = DEA_COUNT(figures),
};
