#include "study/critical.h"

#include "base/arena.h"
#include "result/columns.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const struct dea_critical_kind dea_critical_kinds[DEA_CRITICAL_KINDS] = {
    {DEA_EVENT_SLACK, "slack_voltage_V", "loss of tension",
     "voltage at which the film loses its tension"},
    {DEA_EVENT_BREAKDOWN, "breakdown_voltage_V", "breakdown",
     "voltage at which the true field reaches the film's breakdown field"},
    {DEA_EVENT_PULL_IN, "pull_in_voltage_V", "pull-in", "voltage at which the film pulls in"},
    {DEA_EVENT_BUCKLING, "buckling_voltage_V", "buckling",
     "voltage at which the lowest frequency is 0: another branch crosses"},
};

static const double enough = 1e-10;  // of the largest value: where the last line is straight
static const double nothing = 1e-12; // of it: rounding of a value that is 0
static const double near = 1e-6;     // of a voltage: how far lines lead well
static const double narrow = 1e-9;   // of a voltage: a bracket that says all
enum { STEPS = 80, BUCKLING_STEPS = 40 };

/* A value at a voltage. */
struct seen {
  double V, value;
};

/* On the way up. The value is what is 0 at the voltage that is looked for, and above before. */
struct search {
  struct dea_context *ctx;
  const struct dea_critical_request *ask;
  struct dea_critical *out;
  struct seen low,
      high;            // the highest that holds, the lowest that does not; value NAN: there is none
  struct seen last[2]; // values, the last one behind
  double largest;      // of all values
  double stands_V;     // where the model is
};

static double value_of(const struct search *s, const struct dea_load_point *point)
{
  return s->ask->kind == DEA_EVENT_SLACK ? point->min_tension_N_per_m : point->breakdown_margin;
}

/* Tension goes with the square of the voltage, the field with the voltage. */
static double scale_of(const struct search *s, double voltage_V)
{
  return s->ask->kind == DEA_EVENT_SLACK ? voltage_V * voltage_V : voltage_V;
}

static double unscale(const struct search *s, double x)
{
  return s->ask->kind == DEA_EVENT_SLACK ? sqrt(fmax(x, 0)) : x;
}

/* Statuses that say something of the film; others end the search. */
static bool is_of_film(dea_status status)
{
  return status == DEA_E_NO_EQUILIBRIUM || status == DEA_E_SLACK || status == DEA_E_DOMAIN ||
         status == DEA_E_INVERTED || status == DEA_E_NOT_CONVERGED;
}

static dea_status build_model(struct search *s)
{
  const struct dea_critical_request *ask = s->ask;
  DEA_TRY(s->ctx, ask->type->create(s->ctx, ask->device, ask->settings, &s->out->model));
  s->stands_V = NAN;
  return DEA_OK;
}

/* A new model in place of one that has left the branch. */
static dea_status begin_again(struct search *s)
{
  s->ask->type->destroy(s->ctx, s->out->model);
  s->out->model = NULL;
  return build_model(s);
}

/* Solves; *limit: the limit point that was met or passed on the way, NULL without one. *there:
 * false where the branch has no equilibrium. */
static dea_status solve(struct search *s, double voltage_V, struct dea_load_point *point,
                        const struct dea_event **limit, bool *there)
{
  const struct dea_model_type *type = s->ask->type;
  struct dea_model *model = s->out->model;
  const size_t errors = dea_finding_trial_begin(s->ctx);
  const dea_status status = type->solve(s->ctx, model, voltage_V, point);
  dea_finding_trial_end(s->ctx, errors);
  *limit = NULL;
  *there = status == DEA_OK;
  if (status == DEA_OK) {
    s->stands_V = voltage_V;
    *limit = type->passed != NULL ? type->passed(model) : NULL;
    *there = *limit == NULL && point->stable;
    return DEA_OK;
  }
  if (!is_of_film(status)) {
    return dea_fail_chain(s->ctx, status, __func__, __FILE__, __LINE__);
  }
  snprintf(s->out->why, sizeof s->out->why, "%.199s", dea_context_message(s->ctx));
  dea_context_clear(s->ctx);
  *limit = type->passed != NULL ? type->passed(model) : NULL;
  if (*limit == NULL && type->limit != NULL) {
    *limit = type->limit(model);
  }
  return DEA_OK;
}

// Tension and breakdown ---------------------------------------------------------------------------

/* Where the line through two values is 0; INFINITY where it does not fall. */
static double line(const struct search *s, const struct seen *a, const struct seen *b)
{
  const double x = scale_of(s, a->V), y = scale_of(s, b->V), fall = (a->value - b->value) / (y - x);
  return fall > 0 ? unscale(s, y + b->value / fall) : (double)INFINITY;
}

/* The next voltage to look at: by the last two values, or else by those of the bracket. A membrane
 * that is slack has the value 0 all the way: there is none beyond then, and the way is short. */
static double next_V(const struct search *s)
{
  double next = line(s, &s->last[0], &s->last[1]);
  if (isfinite(s->high.V)) {
    const double width = s->high.V - s->low.V;
    if (next > s->low.V && next < s->high.V) { // not of NAN
      return next;
    }
    next = isnan(s->high.value) ? s->low.V + 0.9 * width : line(s, &s->low, &s->high);
    return next > s->low.V && next < s->high.V ? next : s->low.V + 0.5 * width;
  }
  next = isnan(next) ? (double)INFINITY : next;
  return fmin(fmin(next, fmax(2 * s->low.V, s->ask->first_V)), s->ask->highest_V);
}

/* Takes what was found at a voltage. *there: it is the one that is looked for, but for what the
 * last line is off. A value that is nothing is so where the film is slack, or right there. */
static void add_value(struct search *s, double voltage_V, double value, bool *there)
{
  const struct seen now = {voltage_V, value};
  s->largest = fmax(s->largest, fabs(value));
  const bool is_nothing = fabs(value) <= nothing * s->largest;
  if (is_nothing) {
    *there = voltage_V - s->low.V <= near * voltage_V;
    s->high = (struct seen){voltage_V, NAN};
    return;
  }
  if (value > 0) {
    s->low = now;
  } else {
    s->high = now;
  }
  s->last[0] = s->last[1];
  s->last[1] = now;
  *there = fabs(value) <= enough * s->largest ||
           (s->high.V - s->low.V <= narrow * s->high.V && !isnan(s->high.value));
}

/* Nothing was found at a voltage. *ends: nothing that holds less will be. */
static dea_status store_failure(struct search *s, double voltage_V, const struct dea_event *limit,
                                bool *ends)
{
  const bool known = limit != NULL && limit->kind != DEA_EVENT_SLACK;
  s->high = (struct seen){known ? fmin(voltage_V, limit->point.voltage_V) : voltage_V, NAN};
  *ends = false;
  if (known && value_of(s, &limit->point) > 0) {
    snprintf(s->out->why, sizeof s->out->why, "pull-in at %.6g kV comes first",
             1e-3 * limit->point.voltage_V);
    *ends = true;
    return DEA_OK;
  }
  return s->stands_V == voltage_V ? begin_again(s) : DEA_OK; // it has left the branch
}

/* At the flat film: whether there is anything to lose. */
static dea_status rest(struct search *s, bool *holds)
{
  const struct dea_event *limit;
  bool there;
  DEA_TRY(s->ctx, solve(s, 0, &s->out->point, &limit, &there));
  s->low = s->last[1] = (struct seen){0, value_of(s, &s->out->point)};
  s->last[0] = (struct seen){0, NAN};
  s->largest = s->low.value;
  *holds = there && s->low.value > 0;
  if (there && isnan(s->low.value)) {
    snprintf(s->out->why, sizeof s->out->why, "the model does not support %s of this device",
             s->ask->kind == DEA_EVENT_SLACK ? "tension" : "breakdown field");
  } else if (there && !*holds) {
    snprintf(s->out->why, sizeof s->out->why, "the film has no tension at rest");
  }
  return DEA_OK;
}

/* Whether nothing is left of the way. */
static bool is_over(struct search *s)
{
  if (isfinite(s->high.V)) { // the branch ends with a value that holds
    return s->high.V - s->low.V <= narrow * s->high.V;
  }
  if (s->low.V >= s->ask->highest_V) {
    snprintf(s->out->why, sizeof s->out->why, "not up to %.6g kV", 1e-3 * s->ask->highest_V);
    return true;
  }
  return false;
}

static dea_status find_crossing(struct search *s)
{
  bool holds = false, ends = false, found = false;
  DEA_TRY(s->ctx, rest(s, &holds));
  for (int i = 0; holds && !ends && !found && i < STEPS && !is_over(s); i++) {
    const double next = next_V(s);
    const struct dea_event *limit;
    bool there;
    DEA_TRY(s->ctx, solve(s, next, &s->out->point, &limit, &there));
    if (there) {
      add_value(s, next, value_of(s, &s->out->point), &found);
    } else {
      DEA_TRY(s->ctx, store_failure(s, next, limit, &ends));
    }
  }
  if (holds && !ends && !found && isfinite(s->high.V) && s->low.value < near * s->largest) {
    const struct dea_event *limit; // it goes to 0 where the branch ends
    DEA_TRY(s->ctx, solve(s, s->low.V, &s->out->point, &limit, &found));
  }
  if (found) {
    s->out->voltage_V = line(s, &s->last[0], &s->last[1]);
    s->out->why[0] = '\0';
  }
  return DEA_OK;
}

// Pull-in -----------------------------------------------------------------------------------------

/* The first pull-in on a path. */
static dea_status store_event(void *user, const struct dea_event *event)
{
  struct dea_critical *out = user;
  if (event->kind == DEA_EVENT_PULL_IN && isnan(out->voltage_V)) {
    out->voltage_V = event->point.voltage_V;
    out->point = event->point;
  }
  return DEA_OK;
}

/* Ends the path behind it. */
static dea_status pass_point(void *user, const struct dea_load_point *point)
{
  const struct dea_critical *out = user;
  (void)point;
  return isnan(out->voltage_V) ? DEA_OK : DEA_E_NO_EQUILIBRIUM;
}

/* By the whole path, of a model that has it. */
static dea_status find_on_path(struct search *s)
{
  const struct dea_path_options options = {.max_stretch =
                                               10 * dea_device_pre_stretch(s->ask->device),
                                           .max_voltage_V = s->ask->highest_V,
                                           .max_points = DEA_PATH_POINTS_MAX};
  const dea_status status =
      s->ask->type->path(s->ctx, s->out->model, &options, pass_point, store_event, s->out);
  if (status != DEA_OK && isnan(s->out->voltage_V)) {
    return dea_fail_chain(s->ctx, status, __func__, __FILE__, __LINE__);
  }
  if (isnan(s->out->voltage_V)) {
    snprintf(s->out->why, sizeof s->out->why, "the path has none up to %.6g kV",
             1e-3 * s->ask->highest_V);
  }
  dea_context_clear(s->ctx);
  return DEA_OK;
}

/* By load steps until there is no equilibrium. */
static dea_status find_end(struct search *s)
{
  const double highest_V = s->ask->highest_V;
  double at_V = 0;
  for (int i = 0; i < STEPS && at_V < highest_V; i++) {
    const struct dea_event *limit;
    bool there;
    at_V = fmin(fmax(1.25 * at_V, s->ask->first_V), highest_V);
    DEA_TRY(s->ctx, solve(s, at_V, &s->out->point, &limit, &there));
    if (!there) {
      if (limit != NULL && limit->kind == DEA_EVENT_PULL_IN) {
        s->out->voltage_V = limit->point.voltage_V;
        s->out->point = limit->point;
        s->out->why[0] = '\0';
      }
      return DEA_OK;
    }
  }
  snprintf(s->out->why, sizeof s->out->why, "not up to %.6g kV", 1e-3 * at_V);
  return DEA_OK;
}

// Buckling ----------------------------------------------------------------------------------------

/* The square of the lowest frequency against that of the voltage, the last ones on the way. */
struct fall {
  double x[3], value[3];
  int count; // of them, the last one behind
};

/* Square of the lowest frequency at a voltage, NAN where the search is to end. *there: false where
 * the film is not on the branch from rest: beyond the voltage that is looked for it goes on to a
 * buckled state, which is stable. */
static dea_status lowest_square(struct search *s, double voltage_V, double *square, bool *there)
{
  const struct dea_model_type *type = s->ask->type;
  const struct dea_event *limit;
  struct dea_load_point mode;
  struct dea_field_mesh *shape;
  DEA_TRY(s->ctx, solve(s, voltage_V, &s->out->point, &limit, there));
  if (*there) { // again, for what the first one leaves is seen where the frequency is nearly 0
    DEA_TRY(s->ctx, solve(s, voltage_V, &s->out->point, &limit, there));
  }
  *there = *there && (s->out->point.own_flags & 1u << DEA_FLAG_STATES) == 0;
  if (limit != NULL && limit->kind == DEA_EVENT_PULL_IN) { // where the frequency is 0 too
    snprintf(s->out->why, sizeof s->out->why, "pull-in at %.6g kV comes first",
             1e-3 * limit->point.voltage_V);
    *square = NAN;
    return DEA_OK;
  }
  if (!*there) {
    *square = 0;
    return begin_again(s);
  }
  const dea_status status = type->modes(s->ctx, s->out->model, &s->out->point, 1, &mode, &shape);
  if (status == DEA_E_ARGUMENT) { // no density is known
    snprintf(s->out->why, sizeof s->out->why, "%.199s", dea_context_message(s->ctx));
    dea_context_clear(s->ctx);
    *square = NAN;
    return DEA_OK;
  }
  DEA_TRY(s->ctx, status);
  dea_field_mesh_destroy(s->ctx, shape);
  *square = mode.frequency_Hz * fabs(mode.frequency_Hz);
  *there = *square > 0;
  return DEA_OK;
}

static void store_square(struct fall *f, double voltage_V, double square)
{
  if (f->count == 3) {
    memmove(f->x, f->x + 1, 2 * sizeof *f->x);
    memmove(f->value, f->value + 1, 2 * sizeof *f->value);
    f->count = 2;
  }
  f->x[f->count] = voltage_V * voltage_V;
  f->value[f->count++] = square;
}

/* Where the line through the last two is 0; INFINITY where it does not fall, or there is but one.
 */
static double end_of_line(const struct fall *f)
{
  const int last = f->count - 1, before = last > 0 ? last - 1 : 0;
  const double loss = f->value[before] - f->value[last];
  return loss > 0 ? f->x[last] + f->value[last] * (f->x[last] - f->x[before]) / loss
                  : (double)INFINITY;
}

/* Where the parabola x(value) through the last three is 0. */
static double end_of_parabola(const struct fall *f)
{
  double sum = 0;
  for (int i = 0; i < 3; i++) {
    const double *v = f->value;
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    sum += f->x[i] * v[j] * v[k] / ((v[i] - v[j]) * (v[i] - v[k]));
  }
  return sum;
}

/* From below only, each step most of the way to where the last line ends. The film goes off the
 * branch beyond, and so it does where an imperfection leaves no point at which the frequency is 0.
 */
static dea_status find_buckling(struct search *s)
{
  static const double most = 0.8, close = 4e-5; // of the way left; of the square of the voltage
  const double highest = s->ask->highest_V * s->ask->highest_V;
  struct fall f = {.count = 0};
  double square = NAN, high = INFINITY;
  bool there = false;
  if (s->ask->type->modes == NULL) {
    snprintf(s->out->why, sizeof s->out->why, "the model does not support frequencies");
    return DEA_OK;
  }
  DEA_TRY(s->ctx, lowest_square(s, 0, &square, &there));
  if (!there || isnan(square)) {
    return DEA_OK;
  }
  store_square(&f, 0, square);
  for (int i = 0; i < BUCKLING_STEPS; i++) {
    const double low = f.x[f.count - 1], end = end_of_line(&f);
    if (f.count == 3 && end - low <= close * end) {
      s->out->voltage_V = sqrt(end_of_parabola(&f));
      s->out->why[0] = '\0';
      return DEA_OK;
    }
    double next =
        isfinite(end) ? low + most * (end - low) : fmax(4 * low, s->ask->first_V * s->ask->first_V);
    next = fmin(next < high ? next : 0.5 * (low + high), highest);
    if (low >= highest || (isfinite(high) && high - low <= close * high)) {
      break;
    }
    DEA_TRY(s->ctx, lowest_square(s, sqrt(next), &square, &there));
    if (isnan(square)) {
      return DEA_OK;
    }
    if (there) {
      store_square(&f, sqrt(next), square);
    } else {
      high = next;
    }
  }
  snprintf(s->out->why, sizeof s->out->why, "the lowest frequency is %.3g Hz at %.6g kV, and not 0",
           sqrt(f.value[f.count - 1]), 1e-3 * sqrt(f.x[f.count - 1]));
  return DEA_OK;
}

// All of it ---------------------------------------------------------------------------------------

dea_status dea_critical_find(struct dea_context *ctx, const struct dea_critical_request *ask,
                             struct dea_critical *out)
{
  struct search s = {
      .ctx = ctx, .ask = &out->ask, .out = out, .high = {INFINITY, NAN}, .stands_V = NAN};
  *out = (struct dea_critical){
      .ask = *ask, .voltage_V = NAN, .point = dea_load_point_empty(), .model = NULL};
  DEA_TRY(ctx, build_model(&s));
  return ask->kind == DEA_EVENT_BUCKLING  ? find_buckling(&s)
         : ask->kind != DEA_EVENT_PULL_IN ? find_crossing(&s)
         : ask->type->path != NULL        ? find_on_path(&s)
                                          : find_end(&s);
}

void dea_critical_end(struct dea_context *ctx, struct dea_critical *critical)
{
  if (critical->model != NULL) {
    critical->ask.type->destroy(ctx, critical->model);
  }
  critical->model = NULL;
}

// Slopes ------------------------------------------------------------------------------------------

/* The changes at one voltage, own [count]. */
static void store_at(double V, const struct dea_design_change *changes, size_t count,
                     struct dea_design_change *own)
{
  for (size_t i = 0; i < count; i++) {
    own[i] = changes[i];
    own[i].voltage_V[0] = own[i].voltage_V[1] = V;
  }
}

/* Where the model stands at V: the slopes at a fixed value g, dV/dP = -(dg/dP) / (dg/dV). own, out:
 * [count + 1]. */
static dea_status slopes_of_value(struct dea_context *ctx, const struct dea_critical *c, double V,
                                  const struct dea_design_change *changes, size_t count,
                                  struct dea_design_change *own, double *out)
{
  static const double fraction = 1e-5; // of the voltage, to either side
  const int column =
      dea_point_column_find(c->ask.kind == DEA_EVENT_SLACK      ? "min_tension_N_per_m"
                            : c->ask.kind == DEA_EVENT_BUCKLING ? "frequency_Hz"
                                                                : "breakdown_margin");
  const struct dea_gradient_request ask = {
      .changes = own, .change_count = count + 1, .columns = &column, .column_count = 1};
  store_at(V, changes, count, own);
  own[count] = (struct dea_design_change){.device = {c->ask.device, c->ask.device},
                                          .voltage_V = {V * (1 - fraction), V * (1 + fraction)},
                                          .width = 2 * fraction * V};
  DEA_TRY(ctx, dea_model_gradient(ctx, c->ask.type, c->model, c->ask.settings, &ask, out));
  for (size_t i = 0; i < count; i++) {
    out[i] /= -out[count];
  }
  return DEA_OK;
}

/* A membrane has a kink where it loses its tension: a changed device would be slack there. And
 * where a film buckles its tangent has no inverse, and the slope of a frequency by its square is
 * infinite, but not the ratio of two. Slopes are those at two voltages below, taken to there along
 * a line. */
static dea_status slopes_below(struct dea_context *ctx, const struct dea_critical *c,
                               const struct dea_design_change *changes, size_t count,
                               struct dea_design_change *own, double *out, double *capacity)
{
  static const double fraction = 1e-4; // of the voltage; more than changes make of it
  double *const at[2] = {capacity, out};
  for (int k = 0; k < 2; k++) {
    const double V = c->voltage_V * (1 - (2 - k) * fraction);
    struct dea_load_point point;
    DEA_TRY(ctx, c->ask.type->solve(ctx, c->model, V, &point));
    DEA_TRY(ctx, slopes_of_value(ctx, c, V, changes, count, own, at[k]));
  }
  for (size_t i = 0; i < count; i++) {
    out[i] += out[i] - capacity[i];
  }
  return DEA_OK;
}

/* Of a value that is 0 there. */
static dea_status slopes_of_crossing(struct dea_context *ctx, const struct dea_critical *c,
                                     const struct dea_design_change *changes, size_t count,
                                     double *slopes)
{
  struct dea_arena memory = {.ctx = ctx};
  const bool kink = c->ask.kind == DEA_EVENT_BUCKLING ||
                    (c->ask.kind == DEA_EVENT_SLACK && c->ask.settings->film == DEA_FILM_MEMBRANE);
  struct dea_design_change *own = dea_arena_alloc(&memory, count + 1, sizeof *own);
  double *out = dea_arena_alloc(&memory, 2 * (count + 1), sizeof *out);
  dea_status status = dea_arena_status(&memory);
  if (status == DEA_OK) {
    status = kink ? slopes_below(ctx, c, changes, count, own, out, out + count + 1)
                  : slopes_of_value(ctx, c, c->voltage_V, changes, count, own, out);
  }
  if (status == DEA_OK) {
    memcpy(slopes, out, count * sizeof *slopes);
  }
  dea_arena_free(&memory);
  return DEA_CHAIN(ctx, status);
}

static void fill_unknown(double *slopes, size_t count)
{
  for (size_t i = 0; i < count; i++) {
    slopes[i] = NAN;
  }
}

/* Of a limit point, which is the model's own; none where it is another instability. */
static dea_status slopes_of_limit(struct dea_context *ctx, const struct dea_critical *c,
                                  const struct dea_design_change *changes, size_t count,
                                  double *slopes)
{
  struct dea_arena memory = {.ctx = ctx};
  struct dea_design_change *own = dea_arena_alloc(&memory, count, sizeof *own);
  const struct dea_gradient_request ask = {.changes = own, .change_count = count, .of_limit = true};
  dea_status status = dea_arena_status(&memory);
  if (status == DEA_OK) {
    store_at(c->voltage_V, changes, count, own);
    status = c->ask.type->gradient(ctx, c->model, &ask, slopes);
  }
  if (status == DEA_E_UNSUPPORTED) {
    status = dea_forgive(ctx, status);
    fill_unknown(slopes, count);
  }
  dea_arena_free(&memory);
  return status;
}

/* Differences of the voltages of changed devices, each found anew: of a model without gradients,
 * which costs little. */
static dea_status slopes_anew(struct dea_context *ctx, const struct dea_critical *c,
                              const struct dea_design_change *changes, size_t count, double *slopes)
{
  for (size_t i = 0; i < count; i++) {
    double at_V[2] = {NAN, NAN};
    for (size_t k = 0; k < 2 && changes[i].device[k] != NULL; k++) {
      struct dea_critical side;
      struct dea_critical_request ask = c->ask;
      ask.device = changes[i].device[k];
      ask.highest_V = 2 * c->voltage_V;
      const dea_status status = dea_critical_find(ctx, &ask, &side);
      at_V[k] = side.voltage_V;
      dea_critical_end(ctx, &side);
      DEA_TRY(ctx, status);
    }
    slopes[i] = (at_V[1] - at_V[0]) / changes[i].width;
  }
  return DEA_OK;
}

dea_status dea_critical_slopes(struct dea_context *ctx, const struct dea_critical *critical,
                               const struct dea_design_change *changes, size_t change_count,
                               double *slopes)
{
  if (isnan(critical->voltage_V)) {
    fill_unknown(slopes, change_count);
    return DEA_OK;
  }
  if (critical->ask.kind == DEA_EVENT_PULL_IN && critical->ask.type->gradient != NULL) {
    return slopes_of_limit(ctx, critical, changes, change_count, slopes);
  }
  return critical->ask.type->gradient == NULL
             ? slopes_anew(ctx, critical, changes, change_count, slopes)
             : slopes_of_crossing(ctx, critical, changes, change_count, slopes);
}
