#include "model/equilibrium_path.h"

#include "base/dense.h"
#include "model/make.h"

#include <math.h>
#include <string.h>

enum {
  ROWS_MAX = DEA_PATH_UNKNOWNS_MAX + 1,
  NEWTON_MAX = 12,
  LOCATE_MAX = 60,
  STEPS_MAX = 100000,
  EVENTS_MAX = 4
};

static const double step_first = 0.01, step_largest = 0.05, step_smallest = 1e-9;
static const double traced_largest = 0.02; // a drawn path looks smooth
static const double newton_small = 1e-11;  // of a correction whose unknowns are of order one
static const double turn_cosine = 0.98;    // between tangents of neighbouring points

struct dea_path {
  struct dea_context *ctx;
  struct dea_path_system system;
  struct dea_path_state state, rest;
  struct dea_event limit, slack; // first limit point, first loss of tension of the last seek
  bool limited, slackened;       // whether it has passed them, on the way to nothing
  bool passed, beyond;           // the limit, on the way to a state; that is not back yet
  bool thins;                    // the limit is where a taut film turns unstable, voltage rising
  bool crossed;                  // the wanted voltage at a state that compression has made unstable
  dea_status ended;              // why the last step that was tried failed
  double g[ROWS_MAX], gV[ROWS_MAX], K[ROWS_MAX * ROWS_MAX], bordered[ROWS_MAX * ROWS_MAX];
};

static double dot(const struct dea_path *path, const double *a, const double *b)
{
  double sum = 0;
  for (size_t i = 0; i < path->system.unknowns; i++) {
    // vectors of the path are set
    // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult)
    sum += a[i] * b[i];
  }
  return sum / (double)path->system.unknowns;
}

/* Solves [K gV; a b] [x; y] = right (n + 1 rows, in place); y is in units of V_s. */
static dea_status solve_bordered(struct dea_path *path, const double *a, double b, double *right)
{
  size_t n = path->system.unknowns, m = n + 1;
  for (size_t j = 0; j < n; j++) {
    memcpy(path->bordered + j * m, path->K + j * n, n * sizeof(double));
    path->bordered[j * m + n] = a[j] / (double)n;
    path->bordered[n * m + j] = path->gV[j] * path->system.voltage_scale_V;
  }
  path->bordered[n * m + n] = b;
  return dea_dense_solve(m, path->bordered, right);
}

static dea_status evaluate(struct dea_path *path, const double *u, double voltage_V)
{
  return path->system.evaluate(path->system.self, u, voltage_V, path->g, path->K, path->gV);
}

/* Newton on g = 0 and a . (u - origin)/n + b (V - origin_V)/V_s = ds from the guess in *at. */
static dea_status correct(struct dea_path *path, const struct dea_path_state *origin,
                          const double *a, double b, double ds, struct dea_path_state *at,
                          int *iterations)
{
  size_t n = path->system.unknowns;
  double scale = path->system.voltage_scale_V, right[ROWS_MAX], away[DEA_PATH_UNKNOWNS_MAX];
  for (*iterations = 1; *iterations <= NEWTON_MAX; ++*iterations) {
    DEA_TRY_STATUS(evaluate(path, at->u, at->voltage_V));
    for (size_t i = 0; i < n; i++) {
      right[i] = -path->g[i];
      away[i] = at->u[i] - origin->u[i];
    }
    right[n] = ds - dot(path, a, away) - b * (at->voltage_V - origin->voltage_V) / scale;
    DEA_TRY_STATUS(solve_bordered(path, a, b, right));
    for (size_t i = 0; i < n; i++) {
      at->u[i] += right[i];
    }
    at->voltage_V += right[n] * scale;
    double size = sqrt(dot(path, right, right) + right[n] * right[n]);
    if (!(size < 1e3)) { // also when it is not a number
      return DEA_E_NOT_CONVERGED;
    }
    if (size < newton_small) {
      return DEA_OK;
    }
  }
  return DEA_E_NOT_CONVERGED;
}

/* Tangent and inertia at a converged state; the tangent goes on in the direction of (u, V) given.
 */
static dea_status finish(struct dea_path *path, const double *along_u, double along_V,
                         struct dea_path_state *at)
{
  size_t n = path->system.unknowns;
  double scale = path->system.voltage_scale_V, right[ROWS_MAX] = {0};
  right[n] = 1;
  DEA_TRY_STATUS(evaluate(path, at->u, at->voltage_V));
  DEA_TRY_STATUS(solve_bordered(path, along_u, along_V / scale, right));
  double length = sqrt(dot(path, right, right) + right[n] * right[n]);
  for (size_t i = 0; i < n; i++) {
    at->tangent_u[i] = right[i] / length;
  }
  at->tangent_V = right[n] * scale / length;
  return dea_dense_negative(n, path->K, &at->negative); // destroys K, which is evaluated anew
}

/* One step of arc length ds from `from` to `to`. */
static dea_status step(struct dea_path *path, const struct dea_path_state *from, double ds,
                       struct dea_path_state *to, int *iterations)
{
  double scale = path->system.voltage_scale_V;
  *to = *from;
  for (size_t i = 0; i < path->system.unknowns; i++) {
    to->u[i] += ds * from->tangent_u[i];
  }
  to->voltage_V += ds * from->tangent_V;
  DEA_TRY_STATUS(correct(path, from, from->tangent_u, from->tangent_V / scale, ds, to, iterations));
  return finish(path, from->tangent_u, from->tangent_V, to);
}

/* Steps from *from with *ds made smaller until the step converges and turns gently; proposes the
 * next *ds. DEA_E_NOT_CONVERGED when the path cannot be continued. */
static dea_status step_adaptively(struct dea_path *path, const struct dea_path_state *from,
                                  double *ds, struct dea_path_state *to, double *taken)
{
  double scale2 = path->system.voltage_scale_V * path->system.voltage_scale_V;
  while (*ds > step_smallest) {
    int iterations = 0;
    path->ended = step(path, from, *ds, to, &iterations);
    if (path->ended == DEA_OK) {
      double cosine =
          dot(path, from->tangent_u, to->tangent_u) + from->tangent_V * to->tangent_V / scale2;
      if (cosine > turn_cosine) {
        *taken = *ds;
        *ds = iterations <= 5 ? fmin(1.5 * *ds, step_largest) : *ds;
        return DEA_OK;
      }
    }
    *ds /= 2;
  }
  return DEA_E_NOT_CONVERGED;
}

static dea_status state_point(struct dea_path *path, const struct dea_path_state *state,
                              struct dea_load_point *out)
{
  dea_status status = path->system.point(path->system.self, state->u, state->voltage_V, out);
  out->stable = state->negative == 0;
  out->unstable_modes = state->negative;
  return status;
}

/* What is watched along a path; each changes sign at its event. */
enum watched { WATCH_LIMIT, WATCH_TENSION, WATCH_BREAKDOWN, WATCH_STRETCH, WATCH_VOLTAGE };

struct watch {
  double stretch_end, voltage_end_V;
};

static double watch_value(enum watched what, const struct watch *watch,
                          const struct dea_path_state *state, const struct dea_load_point *point)
{
  switch (what) {
  case WATCH_LIMIT:
    return state->tangent_V;
  case WATCH_TENSION:
    return point->min_tension_N_per_m;
  case WATCH_BREAKDOWN:
    return point->breakdown_margin;
  case WATCH_STRETCH:
    return watch->stretch_end - point->electrode_stretch;
  case WATCH_VOLTAGE:
    return watch->voltage_end_V - point->voltage_V;
  default:
    return NAN;
  }
}

/* Arc length *arc in (0, ds) where the watched value changes its sign (Illinois rule, which
 * brackets); the state and point there. Values at the ends: at_0, at_1. */
static dea_status locate(struct dea_path *path, const struct dea_path_state *from, double ds,
                         enum watched what, const struct watch *watch, double at_0, double at_1,
                         double *arc, struct dea_path_state *state, struct dea_load_point *point)
{
  double s0 = 0, s1 = ds, f0 = at_0, f1 = at_1;
  for (int i = 0; i < LOCATE_MAX; i++) {
    double s = i % 4 == 3 ? 0.5 * (s0 + s1) : s0 - f0 * (s1 - s0) / (f1 - f0);
    int iterations;
    DEA_TRY_STATUS(step(path, from, s, state, &iterations));
    DEA_TRY_STATUS(state_point(path, state, point));
    *arc = s;
    double f = watch_value(what, watch, state, point);
    if (f == 0 || s1 - s0 < 1e-13 || fabs(f) < 1e-13 * fabs(at_1 - at_0)) {
      break;
    }
    if ((f < 0) == (f1 < 0)) { // the root is left of s; the end that stays counts half
      s1 = s;
      f1 = f;
      f0 /= 2;
    } else {
      s0 = s;
      f0 = f;
      f1 /= 2;
    }
  }
  return DEA_OK;
}

/* Whether a taut film turns unstable within this segment while the voltage rises: it thins in one
 * place, short of a limit point of the whole (docs/theory/stops.md). Then the last stable point
 * before that and its arc length. It is bisected: modes of many wave lengths turn at once, and so
 * close to there that the bordered matrix is singular no step converges. */
static bool thins_within(struct dea_path *path, const struct dea_path_state *from,
                         const struct dea_load_point *from_point, double ds,
                         const struct dea_path_state *to, const struct dea_load_point *to_point,
                         double *arc, struct dea_load_point *point)
{
  static const double narrow = 1e-9;
  double high = ds;
  if (from->negative > 0 || to->negative == 0 || !(from->tangent_V > 0 && to->tangent_V > 0) ||
      !(from_point->min_tension_N_per_m > 0 && to_point->min_tension_N_per_m > 0)) {
    return false;
  }
  *arc = 0;
  *point = *from_point;
  while (high - *arc > narrow * ds) {
    struct dea_path_state at;
    struct dea_load_point seen;
    int iterations;
    double next = 0.5 * (*arc + high);
    if (step(path, from, next, &at, &iterations) == DEA_OK && at.negative == 0 &&
        state_point(path, &at, &seen) == DEA_OK) {
      *arc = next;
      *point = seen;
    } else {
      high = next;
    }
  }
  return true;
}

/* The equilibrium at 0 V from path->rest, which stays as it was where there is none near by. */
static dea_status find_rest(struct dea_path *path)
{
  static const double nowhere[DEA_PATH_UNKNOWNS_MAX] = {0};
  struct dea_path_state origin = path->rest, at = path->rest;
  int iterations;
  DEA_TRY_STATUS(correct(path, &origin, nowhere, 1, 0, &at, &iterations));
  DEA_TRY_STATUS(finish(path, nowhere, path->system.voltage_scale_V, &at));
  path->rest = at;
  return DEA_OK;
}

/* The same as what is ramped grows from nothing to all of it, in shares that are halved where
 * Newton's method fails and doubled where it does not. */
static dea_status ramp_to_rest(struct dea_path *path)
{
  static const double least = 1e-6;
  const double whole = *path->system.ramped;
  double fraction = 0, more = 0.5;
  *path->system.ramped = 0;
  dea_status status = find_rest(path);
  while (status == DEA_OK && fraction < 1) {
    double next = fmin(fraction + more, 1);
    *path->system.ramped = next * whole;
    dea_status tried = find_rest(path);
    if (tried == DEA_OK) {
      fraction = next;
      more *= 2;
    } else {
      more /= 2;
      status = more < least ? tried : DEA_OK;
    }
  }
  *path->system.ramped = whole;
  return status;
}

dea_status dea_path_create(struct dea_context *ctx, const struct dea_path_system *system,
                           const double *start, struct dea_path **out)
{
  *out = NULL;
  if (system->unknowns < 1 || system->unknowns > DEA_PATH_UNKNOWNS_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a path takes 1 to %d unknowns, not %zu",
                    DEA_PATH_UNKNOWNS_MAX, system->unknowns);
  }
  struct dea_path *path = dea_alloc(ctx, 1, sizeof *path);
  DEA_TRY_MEMORY(path != NULL);
  path->ctx = ctx;
  path->system = *system;
  memcpy(path->rest.u, start, system->unknowns * sizeof *start);
  dea_status status = find_rest(path);
  if (status != DEA_OK && system->ramped != NULL) {
    status = ramp_to_rest(path);
  }
  if (status != DEA_OK) {
    dea_free(ctx, path);
    return dea_fail(ctx, status, "the film at rest has no equilibrium: %s",
                    dea_status_message(status));
  }
  path->state = path->rest;
  *out = path;
  return DEA_OK;
}

void dea_path_destroy(struct dea_context *ctx, struct dea_path *path)
{
  dea_free(ctx, path);
}

const struct dea_path_state *dea_path_state_get(const struct dea_path *path)
{
  return &path->state;
}

/* Newton at fixed voltage from a guess along the tangent of a state. True when it stayed on a
 * stable branch near by; otherwise the slower way along the path decides. */
static bool seek_directly(struct dea_path *path, const struct dea_path_state *from,
                          double voltage_V, struct dea_path_state *to)
{
  static const double nowhere[DEA_PATH_UNKNOWNS_MAX] = {0};
  struct dea_path_state origin = *from;
  double rise = voltage_V - from->voltage_V, change = 0;
  if (!(fabs(from->tangent_V) > 0.05 * path->system.voltage_scale_V)) {
    return false;
  }
  *to = *from;
  for (size_t i = 0; i < path->system.unknowns; i++) {
    double du = from->tangent_u[i] * rise / from->tangent_V;
    to->u[i] += du;
    change = fmax(change, fabs(du));
  }
  to->voltage_V = origin.voltage_V = voltage_V;
  int iterations;
  if (change > 0.1 || correct(path, &origin, nowhere, 1, 0, to, &iterations) != DEA_OK) {
    return false;
  }
  double sign = from->tangent_V > 0 ? 1 : -1;
  if (finish(path, nowhere, sign * path->system.voltage_scale_V, to) != DEA_OK) {
    return false;
  }
  for (size_t i = 0; i < path->system.unknowns; i++) {
    change = fmax(change, fabs(to->u[i] - from->u[i]));
  }
  to->voltage_V = voltage_V; // to the bit
  return change < 0.1 && to->negative == 0;
}

/* Settles a crossing of the wanted voltage in the segment from `from` of length ds: the state
 * exactly there, when it is stable. */
static bool settle(struct dea_path *path, const struct dea_path_state *from, double ds,
                   const struct watch *watch, double at_0, double at_1, struct dea_path_state *out)
{
  struct dea_load_point point;
  struct dea_path_state exact;
  double arc;
  if (locate(path, from, ds, WATCH_VOLTAGE, watch, at_0, at_1, &arc, out, &point) != DEA_OK ||
      out->negative != 0) {
    return false;
  }
  if (seek_directly(path, out, watch->voltage_end_V, &exact)) {
    *out = exact;
  }
  return true;
}

/* Takes the first limit point, or the first place where a taut film turns unstable before one, and
 * the first loss of tension of a search, if they are within this segment, whose ends are states and
 * points. */
static void note_events(struct dea_path *path, const struct dea_path_state *from,
                        const struct dea_load_point *from_point, double ds,
                        const struct dea_path_state *to, const struct dea_load_point *to_point,
                        const struct watch *watch)
{
  double tension[2] = {from_point->min_tension_N_per_m, to_point->min_tension_N_per_m}, arc;
  struct dea_path_state at;
  if (!path->limited && from->tangent_V * to->tangent_V < 0 &&
      locate(path, from, ds, WATCH_LIMIT, watch, from->tangent_V, to->tangent_V, &arc, &at,
             &path->limit.point) == DEA_OK) {
    const bool away = from->tangent_V * path->limit.point.voltage_V > 0; // from 0 V
    path->limit.kind = away ? DEA_EVENT_PULL_IN : DEA_EVENT_SNAP_BACK;
    path->limited = true;
  }
  if (!path->limited &&
      thins_within(path, from, from_point, ds, to, to_point, &arc, &path->limit.point)) {
    path->limit.kind = DEA_EVENT_PULL_IN;
    path->limited = path->thins = true;
  }
  if (!path->slackened && !path->limited && tension[0] >= 0 && tension[1] < 0 &&
      locate(path, from, ds, WATCH_TENSION, watch, tension[0], tension[1], &arc, &at,
             &path->slack.point) == DEA_OK) {
    path->slack.kind = DEA_EVENT_SLACK;
    path->slackened = true;
  }
}

/* What a search that found nothing says: *last is where it ended. */
static dea_status fail_seek(struct dea_context *ctx, const struct dea_path *path, double voltage_V,
                            const struct dea_load_point *last)
{
  if (path->limited) {
    const struct dea_load_point *at = &path->limit.point;
    return dea_fail(ctx, DEA_E_NO_EQUILIBRIUM,
                    "%s at %.6g kV and an electrode stretch of %.5g: %s there is no stable "
                    "equilibrium at %.6g kV",
                    path->limit.kind == DEA_EVENT_PULL_IN ? "pull-in" : "snap-back",
                    1e-3 * at->voltage_V, at->electrode_stretch,
                    path->thins ? "the film thins in one place, and" : "beyond it",
                    1e-3 * voltage_V);
  }
  if (path->crossed && path->slackened) {
    const struct dea_load_point *at = &path->slack.point;
    return dea_fail(ctx, DEA_E_SLACK,
                    "the film loses its tension at %.6g kV and an electrode stretch of %.5g, and "
                    "before %.6g kV its compression is unstable: it wrinkles, which this model "
                    "does not show (model 3d does)",
                    1e-3 * at->voltage_V, at->electrode_stretch, 1e-3 * voltage_V);
  }
  if (path->crossed) {
    return dea_fail(
        ctx, DEA_E_SLACK,
        "the film has lost its tension, and before %.6g kV its compression is unstable: "
        "it wrinkles, which this model does not show (model 3d does)",
        1e-3 * voltage_V);
  }
  if (path->ended == DEA_OK || path->ended == DEA_E_DOMAIN) {
    return dea_fail(ctx, DEA_E_DOMAIN,
                    "the path to %.6g kV ends at %.6g kV and an electrode stretch of %.5g: %s",
                    1e-3 * voltage_V, 1e-3 * last->voltage_V, last->electrode_stretch,
                    path->ended == DEA_OK ? "there the film's range is at its end"
                                          : "beyond it the material's law is not defined");
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED,
                  "the path to %.6g kV cannot be followed beyond %.6g kV and an electrode stretch "
                  "of %.5g (the solver did not converge; please report)",
                  1e-3 * voltage_V, 1e-3 * last->voltage_V, last->electrode_stretch);
}

dea_status dea_path_seek(struct dea_context *ctx, struct dea_path *path, double voltage_V,
                         double max_stretch)
{
  struct dea_path_state found;
  path->limited = path->slackened = path->crossed = path->thins = path->passed = false;
  if (seek_directly(path, &path->state, voltage_V, &found)) {
    path->state = found;
    return DEA_OK;
  }
  struct watch watch = {.stretch_end = max_stretch, .voltage_end_V = voltage_V};
  struct dea_path_state from = path->state, to;
  struct dea_load_point point, next;
  // beyond these it came back to rest
  const double lowest_V = fmin(from.voltage_V, voltage_V) >= 0 ? -1 : -(double)INFINITY;
  const double highest_V = fmax(from.voltage_V, voltage_V) <= 0 ? 1 : (double)INFINITY;
  DEA_TRY(ctx, state_point(path, &from, &point));
  if ((voltage_V - from.voltage_V) * from.tangent_V < 0) { // turn round
    for (size_t i = 0; i < path->system.unknowns; i++) {
      from.tangent_u[i] = -from.tangent_u[i];
    }
    from.tangent_V = -from.tangent_V;
  }
  double ds = step_first, taken;
  for (int i = 0; i < STEPS_MAX; i++) {
    if (step_adaptively(path, &from, &ds, &to, &taken) != DEA_OK) {
      break;
    }
    double at_0 = voltage_V - from.voltage_V, at_1 = voltage_V - to.voltage_V;
    if (at_0 * at_1 <= 0 && settle(path, &from, taken, &watch, at_0, at_1, &found)) {
      path->state = found;
      path->passed = path->limited;
      path->beyond = path->passed ? path->limit.kind == DEA_EVENT_PULL_IN : path->beyond;
      path->limited = path->slackened = false;
      return DEA_OK;
    }
    dea_status status = state_point(path, &to, &next);
    if (status != DEA_OK) {
      break;
    }
    path->crossed =
        path->crossed || (at_0 * at_1 <= 0 && to.negative > 0 && next.min_tension_N_per_m < 0);
    note_events(path, &from, &point, taken, &to, &next, &watch);
    point = next;
    if (point.electrode_stretch > max_stretch || to.voltage_V < lowest_V ||
        to.voltage_V > highest_V) {
      break;
    }
    from = to;
  }
  return fail_seek(ctx, path, voltage_V, &point);
}

static struct dea_path *path_of(const struct dea_model *model)
{
  return *(struct dea_path *const *)model;
}

void dea_path_model_destroy(struct dea_context *ctx, struct dea_model *model)
{
  if (model != NULL) {
    dea_path_destroy(ctx, path_of(model));
    dea_free(ctx, model);
  }
}

const struct dea_event *dea_path_limit(const struct dea_model *model)
{
  const struct dea_path *path = path_of(model);
  return path->limited ? &path->limit : path->crossed && path->slackened ? &path->slack : NULL;
}

const struct dea_event *dea_path_passed(const struct dea_model *model)
{
  const struct dea_path *path = path_of(model);
  return path->passed ? &path->limit : NULL;
}

dea_status dea_path_solve(struct dea_context *ctx, struct dea_model *model, double voltage_V,
                          struct dea_load_point *out)
{
  struct dea_path *path = path_of(model);
  const struct dea_path_system *system = &path->system;
  double from_V = path->state.voltage_V;
  DEA_TRY(ctx, dea_path_seek(ctx, path, voltage_V, system->end_stretch));
  DEA_TRY(ctx, dea_path_point(ctx, path, out));
  if (path->passed) {
    DEA_TRY(ctx, dea_model_report_passed(ctx, system->model, from_V, voltage_V, &path->limit));
  }
  out->own_flags |= (unsigned)path->beyond << DEA_FLAG_STATES;
  return DEA_OK;
}

/* A path being traced, with what it reports to. */
struct trace {
  struct dea_path *path;
  struct watch watch;
  dea_event_sink events;
  void *user;
  struct dea_load_point before, now; // points at the ends of the last segment
};

static enum dea_event_kind event_kind(enum watched what, double before)
{
  switch (what) {
  case WATCH_TENSION:
    return DEA_EVENT_SLACK;
  case WATCH_BREAKDOWN:
    return DEA_EVENT_BREAKDOWN;
  default:
    return before > 0 ? DEA_EVENT_PULL_IN : DEA_EVENT_SNAP_BACK;
  }
}

/* Events of one segment, in their order along it. */
struct found_events {
  struct dea_event event[EVENTS_MAX];
  double arc[EVENTS_MAX];
  size_t count;
};

static void add_event(struct found_events *found, enum dea_event_kind kind,
                      const struct dea_load_point *point, double arc)
{
  size_t i = found->count++;
  for (; i > 0 && found->arc[i - 1] > arc; i--) {
    found->event[i] = found->event[i - 1];
    found->arc[i] = found->arc[i - 1];
  }
  found->event[i] = (struct dea_event){.kind = kind, .point = *point};
  found->arc[i] = arc;
}

/* Finds and reports the events inside one segment of arc length ds. */
static dea_status report_events(struct trace *trace, const struct dea_path_state *from, double ds,
                                const struct dea_path_state *to)
{
  static const enum watched kinds[] = {WATCH_LIMIT, WATCH_TENSION, WATCH_BREAKDOWN};
  struct dea_context *ctx = trace->path->ctx;
  struct found_events found = {.count = 0};
  struct dea_load_point point;
  double at;
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0] && trace->events != NULL; k++) {
    double at_0 = watch_value(kinds[k], &trace->watch, from, &trace->before);
    double at_1 = watch_value(kinds[k], &trace->watch, to, &trace->now);
    // false when the value is unknown; a zero belongs to the segment that ends there
    bool down = at_0 > 0 && at_1 <= 0, up = kinds[k] == WATCH_LIMIT && at_0 < 0 && at_1 >= 0;
    struct dea_path_state state;
    if (!down && !up) {
      continue;
    }
    DEA_TRY(ctx, locate(trace->path, from, ds, kinds[k], &trace->watch, at_0, at_1, &at, &state,
                        &point));
    add_event(&found, event_kind(kinds[k], at_0), &point, at);
  }
  if (trace->events != NULL &&
      thins_within(trace->path, from, &trace->before, ds, to, &trace->now, &at, &point)) {
    add_event(&found, DEA_EVENT_PULL_IN, &point, at);
  }
  for (size_t i = 0; i < found.count; i++) {
    DEA_TRY(ctx, trace->events(trace->user, &found.event[i]));
  }
  return DEA_OK;
}

/* Cuts the segment at an end of the path that lies inside it; true when it did. */
static bool cut_at_end(struct trace *trace, const struct dea_path_state *from, double *ds,
                       struct dea_path_state *to)
{
  static const enum watched ends[] = {WATCH_STRETCH, WATCH_VOLTAGE};
  bool cut = false;
  for (size_t k = 0; k < sizeof ends / sizeof ends[0]; k++) {
    double at_0 = watch_value(ends[k], &trace->watch, from, &trace->before);
    double at_1 = watch_value(ends[k], &trace->watch, to, &trace->now);
    struct dea_path_state state;
    struct dea_load_point point;
    double arc;
    if (isfinite(at_1) && at_0 > 0 && at_1 <= 0 &&
        locate(trace->path, from, *ds, ends[k], &trace->watch, at_0, at_1, &arc, &state, &point) ==
            DEA_OK) {
      *to = state;
      *ds = arc;
      trace->now = point;
      cut = true;
    }
  }
  return cut;
}

dea_status dea_path_trace(struct dea_context *ctx, struct dea_model *model,
                          const struct dea_path_options *options, dea_point_sink points,
                          dea_event_sink events, void *user)
{
  struct dea_path *path = path_of(model);
  struct trace trace = {.path = path,
                        .events = events,
                        .user = user,
                        .watch = {.stretch_end = options->max_stretch / path->system.pre_stretch,
                                  .voltage_end_V = options->max_voltage_V}};
  struct dea_path_state from = path->rest, to;
  double ds = step_first, taken;
  DEA_TRY(ctx, state_point(path, &from, &trace.before));
  DEA_TRY(ctx, points(user, &trace.before));
  for (size_t i = 1; i < options->max_points; i++) {
    if (dea_interrupted(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted after %zu points of the path", i);
    }
    ds = fmin(ds, traced_largest);
    if (step_adaptively(path, &from, &ds, &to, &taken) != DEA_OK ||
        state_point(path, &to, &trace.now) != DEA_OK || to.voltage_V <= 0) {
      break; // the law's domain or the path's own end
    }
    const bool last = cut_at_end(&trace, &from, &taken, &to);
    DEA_TRY(ctx, report_events(&trace, &from, taken, &to)); // none beyond the end
    DEA_TRY(ctx, points(user, &trace.now));
    trace.before = trace.now;
    from = to;
    if (last) {
      break;
    }
  }
  path->state = options->stays ? from : path->state;
  return DEA_OK;
}

dea_status dea_path_point(struct dea_context *ctx, struct dea_path *path,
                          struct dea_load_point *out)
{
  return DEA_CHAIN(ctx, state_point(path, &path->state, out));
}
