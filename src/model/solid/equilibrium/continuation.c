/* Paths of equilibria by arc-length: steps along the tangent (docs/theory/branches.md). */
#include "model/solid/equilibrium/continuation.h"

#include <math.h>
#include <string.h>

enum { ATTEMPTS_MAX = 16, ITERATIONS_MANY = 8 };

static const double off_most = 0.3;    // distance of a point from its prediction, over the step
static const double bend_least = 0.02; // of a unit tangent: below which it is an arc
static const double off_good = 0.08;   // the one that steps aim at
static const double least = 1e-6;      // step over the first one

double dea_continuation_size(const struct dea_solid_continuation *t, const double *du)
{
  double sum = 0;
  for (size_t i = 0; i < t->s->dofs; i++) {
    sum += t->metric[i] * du[i] * du[i];
  }
  return sqrt(sum);
}

void dea_continuation_orient_plane(struct dea_solid_continuation *t, const double *direction,
                                   double load)
{
  double size = hypot(dea_continuation_size(t, direction), load);
  size = size > 0 ? size : 1;
  for (size_t i = 0; i < t->s->dofs; i++) {
    t->plane.weight[i] = t->metric[i] * direction[i] / size;
  }
  t->plane.load = load / size;
}

void dea_continuation_report(const struct dea_solid_continuation *t,
                             const struct dea_continuation_path_point *place,
                             enum dea_continuation_event event, struct dea_continuation_point *out)
{
  *out = (struct dea_continuation_point){.load = place->load,
                                         .voltage_V = t->s->voltage_V,
                                         .slope = place->slope,
                                         .arc = place->arc,
                                         .energy_J = place->energy_J,
                                         .unstable_modes = place->modes,
                                         .passed = event};
}

dea_status dea_continuation_return(struct dea_context *ctx, struct dea_solid_continuation *t,
                                   const struct dea_continuation_path_point *place)
{
  dea_solid_state_set(t->s, place->state);
  t->s->predicted_fits = t->s->factor_fits = false;
  DEA_TRY(ctx, dea_continuation_load(ctx, t, place->load));
  return DEA_OK;
}

dea_status dea_continuation_advance(struct dea_context *ctx, struct dea_solid_continuation *t,
                                    const double *du, double dtau)
{
  struct dea_solid *s = t->s;
  double energy;
  s->predicted_fits = false;
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, s->voltage_V, DEA_FORCE, &energy)); // for theta
  dea_solid_raise_bulk_modulus(s);
  dea_status status = dea_solid_predict(ctx, s, s->voltage_V, du, 1, true, true);
  dea_solid_restore_bulk_modulus_at_pressure(s); // the multipliers are those of the end of the step
  DEA_TRY(ctx, status);
  for (size_t i = 0; i < s->dofs; i++) {
    s->u[i] += du[i];
  }
  DEA_TRY(ctx, dea_continuation_load(ctx, t, t->load + dtau));
  return DEA_OK;
}

dea_status dea_continuation_arrive(struct dea_context *ctx, struct dea_solid_continuation *t,
                                   const double *along, double along_load, bool tangent,
                                   struct dea_continuation_path_point *place)
{
  struct dea_solid *s = t->s;
  double product = along_load;
  DEA_TRY(ctx, dea_continuation_evaluate(ctx, t, &place->modes));
  for (size_t i = 0; i < s->dofs; i++) {
    product += t->metric[i] * along[i] * t->rate[i];
  }
  place->slope = copysign(1 / hypot(dea_continuation_size(t, t->rate), 1), product);
  place->load = t->load;
  place->energy_J = t->energy_J;
  dea_solid_state_get(s, place->state);
  for (size_t i = 0; i < s->dofs && tangent; i++) {
    t->tangent[i] = place->slope * t->rate[i];
  }
  t->tangent_load = tangent ? place->slope : t->tangent_load;
  return DEA_OK;
}

/* Distance of where the solid is to the prediction that t->start and tau are, both from last. */
static double distance(struct dea_solid_continuation *t, const double *predicted, double tau)
{
  double sum = (t->load - tau) * (t->load - tau);
  for (size_t i = 0; i < t->s->dofs; i++) {
    double way = t->s->u[i] - predicted[i];
    sum += t->metric[i] * way * way;
  }
  return sqrt(sum);
}

static enum dea_continuation_event event_between(const struct dea_continuation_path_point *a,
                                                 const struct dea_continuation_path_point *b)
{
  if (a->slope * b->slope < 0) {
    return DEA_CONTINUATION_LIMIT;
  }
  return a->modes != b->modes ? DEA_CONTINUATION_BIFURCATION : DEA_CONTINUATION_NOTHING;
}

/* How far the tangent at t->next is from that of the circle through both points with the tangent at
 * t->last: 0 for an arc, twice the distance from the prediction for a parallel path. t->rate
 * belongs to t->next. */
static double bend(const struct dea_solid_continuation *t)
{
  double chord_load = t->next.load - t->last.load, size = chord_load * chord_load;
  double tangents = t->tangent_load, first = chord_load * t->tangent_load, second = chord_load;
  for (size_t i = 0; i < t->s->dofs; i++) {
    double chord = t->next.state[i] - t->last.state[i];
    size += t->metric[i] * chord * chord;
    first += t->metric[i] * chord * t->tangent[i];
    second += t->metric[i] * chord * t->rate[i];
    tangents += t->metric[i] * t->tangent[i] * t->rate[i];
  }
  double square = 2 + 2 * t->next.slope * tangents - 4 * first * t->next.slope * second / size;
  return sqrt(fmax(square, 0));
}

/* A point at t->step into t->next; *off: how far from the prediction, over the step. */
static dea_status attempt(struct dea_context *ctx, struct dea_solid_continuation *t, double *off,
                          int *iterations)
{
  struct dea_solid *s = t->s;
  DEA_TRY(ctx, dea_continuation_return(ctx, t, &t->last));
  for (size_t i = 0; i < s->dofs; i++) {
    t->start[i] = t->step * t->tangent[i];
  }
  DEA_TRY(ctx, dea_continuation_advance(ctx, t, t->start, t->step * t->tangent_load));
  memcpy(t->start, s->u, s->dofs * sizeof *t->start);
  double tau = t->load;
  dea_continuation_orient_plane(t, t->tangent, t->tangent_load);
  t->plane.u0 = t->last.state;
  t->plane.tau0 = t->last.load;
  t->plane.length = t->step;
  DEA_TRY(ctx, dea_continuation_correct(ctx, t, iterations));
  *off = distance(t, t->start, tau) / t->step;
  if (*off < off_most) {
    t->next.arc = t->last.arc + t->step;
    DEA_TRY(ctx, dea_continuation_arrive(ctx, t, t->tangent, t->tangent_load, false, &t->next));
    if (bend(t) < fmax(*off, bend_least)) {
      return DEA_OK;
    }
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the path is left for another one");
}

/* The new point becomes the last one. */
static void accept(struct dea_solid_continuation *t)
{
  struct dea_continuation_path_point old = t->before;
  t->before = t->last;
  t->last = t->next;
  t->next = old;
  for (size_t i = 0; i < t->s->dofs; i++) {
    t->tangent[i] = t->last.slope * t->rate[i];
  }
  t->tangent_load = t->last.slope;
  t->event = event_between(&t->before, &t->last);
  t->located = DEA_CONTINUATION_NOTHING;
}

dea_status dea_solid_continuation_step(struct dea_context *ctx, struct dea_solid_continuation *t,
                                       struct dea_continuation_point *point)
{
  double off = 0;
  int iterations = 0, all = 0;
  dea_status status = DEA_OK;
  for (int i = 0; i < ATTEMPTS_MAX; i++) {
    dea_context_clear(ctx);
    iterations = 0;
    status = attempt(ctx, t, &off, &iterations);
    all += iterations;
    if (status == DEA_OK || status == DEA_E_MEMORY || t->step < 2 * t->step_least) {
      break;
    }
    t->step /= 2;
  }
  if (status != DEA_OK) {
    char why[200];
    strncpy(why, dea_context_message(ctx), sizeof why - 1);
    why[sizeof why - 1] = '\0';
    dea_context_clear(ctx);
    DEA_TRY(ctx, dea_continuation_return(ctx, t, &t->last));
    return dea_fail(ctx, status, "the path cannot be followed beyond a load of %.6g (%s)",
                    t->last.load, why);
  }
  accept(t);
  dea_continuation_report(t, &t->last, t->event, point);
  point->iterations = all;
  double longer = off > 0 ? fmin(sqrt(off_good / off), 2) : 2;
  longer = iterations > ITERATIONS_MANY ? fmin(longer, 0.7) : longer;
  t->step = fmin(t->step * fmax(longer, 0.5), t->step_most);
  return DEA_OK;
}

/* Memory and metric. */
static dea_status make(struct dea_context *ctx, struct dea_solid *s,
                       const struct dea_continuation_options *options,
                       struct dea_solid_continuation *t)
{
  size_t controls = s->path.control_count, states = s->path.state_count;
  double **const of_dofs[] = {&t->metric, &t->held_rate, &t->tangent, &t->plane.weight,
                              &t->rate,   &t->right,     &t->start,   &t->mode};
  double **const of_controls[] = {&t->from, &t->goal, &t->now};
  double **const of_states[] = {&t->before.state, &t->last.state, &t->critical.state,
                                &t->next.state};
  bool all = true;
  for (size_t i = 0; i < sizeof of_dofs / sizeof of_dofs[0]; i++) {
    *of_dofs[i] = dea_alloc(ctx, s->dofs, sizeof(double));
    all = all && *of_dofs[i] != NULL;
  }
  for (size_t i = 0; i < sizeof of_controls / sizeof of_controls[0]; i++) {
    *of_controls[i] = dea_alloc(ctx, controls, sizeof(double));
    all = all && *of_controls[i] != NULL;
  }
  for (size_t i = 0; i < sizeof of_states / sizeof of_states[0]; i++) {
    *of_states[i] = dea_alloc(ctx, states, sizeof(double));
    all = all && *of_states[i] != NULL;
  }
  if (dea_solid_any(!all)) {
    return DEA_E_MEMORY;
  }
  double volume = 0;
  dea_solid_masses(s, t->metric);
  for (size_t i = 0; i < s->dofs; i++) {
    volume += t->metric[i] / 3;
  }
  for (size_t i = 0; i < s->dofs; i++) {
    t->metric[i] /= volume * options->unit_m * options->unit_m;
  }
  t->step = fabs(options->step);
  t->step_least = least * t->step;
  t->step_most = options->step_most > 0 ? options->step_most : INFINITY;
  return DEA_OK;
}

/* The controls and the place to start from. */
static dea_status begin(struct dea_context *ctx, struct dea_solid_continuation *t,
                        const double *goal, double sense)
{
  struct dea_solid *s = t->s;
  struct dea_solid_report report = {0};
  DEA_TRY(ctx, dea_solid_check(ctx, s));
  DEA_TRY(ctx, dea_solid_equilibrate(ctx, s, &report));
  dea_solid_controls_get(s, t->from);
  memcpy(t->goal, goal, s->path.control_count * sizeof(double));
  dea_solid_controls_increment(s, t->from);
  memcpy(t->held_rate, s->drive, s->dofs * sizeof(double));
  dea_solid_controls_increment(s, t->goal);
  for (size_t i = 0; i < s->dofs; i++) {
    t->held_rate[i] = s->drive[i] - t->held_rate[i];
  }
  DEA_TRY(ctx, dea_continuation_arrive(ctx, t, t->tangent, sense, true, &t->last));
  return DEA_OK;
}

dea_status dea_continuation_create_to(struct dea_context *ctx, struct dea_solid *s,
                                      const double *goal,
                                      const struct dea_continuation_options *options,
                                      struct dea_solid_continuation **out)
{
  *out = NULL;
  struct dea_solid_continuation *t = dea_alloc(ctx, 1, sizeof *t);
  if (dea_solid_any(t == NULL)) {
    dea_free(ctx, t);
    return DEA_E_MEMORY;
  }
  t->s = s;
  dea_status status = make(ctx, s, options, t);
  if (status == DEA_OK) {
    status = begin(ctx, t, goal, options->step);
  }
  if (status != DEA_OK) {
    dea_solid_continuation_destroy(ctx, t);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = t;
  return DEA_OK;
}

dea_status dea_solid_continuation_create(struct dea_context *ctx, struct dea_solid *s,
                                         double voltage_V,
                                         const struct dea_continuation_options *options,
                                         struct dea_solid_continuation **out)
{
  *out = NULL;
  if (!(options->unit_m > 0) || !(fabs(options->step) > 0)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a path takes a step and a unit of displacement");
  }
  if (s->field != NULL) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "a path is followed with the field V/h only");
  }
  DEA_TRY(ctx, dea_solid_agree(ctx, s, dea_load_steps_prepare(ctx, s)));
  double *goal = dea_alloc(ctx, s->path.control_count, sizeof *goal);
  DEA_TRY(ctx, dea_solid_agree(ctx, s, goal != NULL ? DEA_OK : DEA_E_MEMORY));
  dea_solid_controls_goal(s, voltage_V, goal);
  dea_status status = dea_continuation_create_to(ctx, s, goal, options, out);
  dea_free(ctx, goal);
  return status;
}

void dea_solid_continuation_destroy(struct dea_context *ctx, struct dea_solid_continuation *t)
{
  if (t == NULL) {
    return;
  }
  void *const memory[] = {t->metric,     t->held_rate,      t->tangent,   t->plane.weight,
                          t->rate,       t->right,          t->start,     t->mode,
                          t->from,       t->goal,           t->now,       t->before.state,
                          t->last.state, t->critical.state, t->next.state};
  for (size_t i = 0; i < sizeof memory / sizeof memory[0]; i++) {
    dea_free(ctx, memory[i]);
  }
  dea_free(ctx, t);
}
