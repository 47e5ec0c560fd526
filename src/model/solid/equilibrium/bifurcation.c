/* Limit points and bifurcations of a path, and the other branch (docs/theory/branches.md). */
#include "model/solid/equilibrium/continuation.h"

#include <math.h>
#include <string.h>

enum { ROUNDS_MAX = 20, ASIDE_MAX = 4, SIZES_MAX = 6 };

static const double limit_near = 1e-6, bifurcation_near = 1e-4; // of the way between two points
static const double flat_enough = 1e-8; // of what is 0 at the critical point, over what it was
static const double aside = 0.03;       // of the bracket, at first

/* Between two places: where, what is to be 0 there, and the direction from one to the other. */
struct bracket {
  const struct dea_continuation_path_point *from;
  double *way; // [state_count]
  double way_load, length, at[2], value[2];
  size_t mode; // of a bifurcation: the place of the critical one among all
};

/* What is 0 at the critical point, where the solid is; t->mode then is the critical mode. */
static dea_status measure(struct dea_context *ctx, struct dea_solid_continuation *t,
                          const struct bracket *b, double *value)
{
  struct dea_solid *s = t->s;
  DEA_TRY(ctx, dea_continuation_arrive(ctx, t, b->way, b->way_load, false, &t->critical));
  *value = t->critical.slope;
  if (t->event == DEA_CONTINUATION_LIMIT) {
    return DEA_OK;
  }
  size_t count = b->mode + 1, dofs = 3 * s->grid->node_count;
  double values[DEA_MODES_MAX];
  double *vectors = dea_alloc(ctx, count * dofs, sizeof *vectors);
  DEA_TRY(ctx, dea_solid_agree(ctx, s, vectors != NULL ? DEA_OK : DEA_E_MEMORY));
  dea_status status = dea_solid_modes(ctx, s, count, values, vectors);
  *value = values[b->mode];
  memcpy(t->mode, vectors + b->mode * dofs, dofs * sizeof *t->mode);
  dea_free(ctx, vectors);
  return status;
}

/* The equilibrium at a share of the way. */
static dea_status go(struct dea_context *ctx, struct dea_solid_continuation *t,
                     const struct bracket *b, double share)
{
  int iterations;
  memcpy(t->critical.state, b->from->state, t->s->path.state_count * sizeof(double));
  for (size_t i = 0; i < t->s->path.state_count; i++) {
    t->critical.state[i] += share * b->way[i];
  }
  t->critical.load = b->from->load + share * b->way_load;
  DEA_TRY(ctx, dea_continuation_return(ctx, t, &t->critical));
  dea_continuation_orient_plane(t, b->way, b->way_load);
  t->plane.u0 = b->from->state;
  t->plane.tau0 = b->from->load;
  t->plane.length = share * b->length;
  DEA_TRY(ctx, dea_continuation_correct(ctx, t, &iterations));
  t->critical.arc = b->from->arc + share * b->length;
  return DEA_OK;
}

/* The same beside the share where there is none at it: where a mode other than the path's loses its
 * stiffness K is singular on the plane too, and what rounding leaves along the mode grows. */
static dea_status go_near(struct dea_context *ctx, struct dea_solid_continuation *t,
                          const struct bracket *b, double *share)
{
  dea_status status = go(ctx, t, b, *share);
  bool first_half = *share - b->at[0] < b->at[1] - *share;
  double by = (first_half ? aside : -aside) * (b->at[1] - b->at[0]), from = *share;
  for (int i = 0; i < ASIDE_MAX && (status == DEA_E_NOT_CONVERGED || status == DEA_E_DOMAIN);
       i++, by *= 2) {
    dea_context_clear(ctx);
    *share = from + by;
    status = go(ctx, t, b, *share);
  }
  return status;
}

/* Regula falsi, with the older end's value halved while it stays (Illinois). A value between the
 * two ends that is larger than at both is that of a K which is singular to rounding: there it is.
 */
static dea_status close_in(struct dea_context *ctx, struct dea_solid_continuation *t,
                           struct bracket *b)
{
  double seen[2] = {fabs(b->value[0]), fabs(b->value[1])}, first = fmax(seen[0], seen[1]);
  double value, before = -1;
  double enough = t->event == DEA_CONTINUATION_LIMIT ? limit_near : bifurcation_near;
  int stays = -1;
  for (int i = 0; i < ROUNDS_MAX; i++) {
    double share = b->at[0] + (b->at[1] - b->at[0]) * b->value[0] / (b->value[0] - b->value[1]);
    DEA_TRY(ctx, go_near(ctx, t, b, &share));
    DEA_TRY(ctx, measure(ctx, t, b, &value));
    if (fabs(share - before) < enough || fabs(value) < flat_enough * first ||
        fabs(value) > fmax(seen[0], seen[1])) {
      return DEA_OK;
    }
    before = share;
    int end = (value < 0) == (b->value[0] < 0) ? 0 : 1;
    b->at[end] = share;
    b->value[end] = value;
    seen[end] = fabs(value);
    if (stays == 1 - end) {
      b->value[1 - end] /= 2;
    }
    stays = 1 - end;
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the critical point could not be closed in on");
}

static dea_status locate(struct dea_context *ctx, struct dea_solid_continuation *t,
                         struct bracket *b)
{
  const struct dea_continuation_path_point *ends[2] = {&t->before, &t->last};
  b->from = ends[0];
  for (size_t i = 0; i < t->s->path.state_count; i++) {
    b->way[i] = ends[1]->state[i] - ends[0]->state[i];
  }
  b->way_load = ends[1]->load - ends[0]->load;
  b->length = hypot(dea_continuation_size(t, b->way), b->way_load);
  b->at[1] = 1;
  b->mode = (size_t)(ends[0]->modes < ends[1]->modes ? ends[0]->modes : ends[1]->modes);
  if (t->event == DEA_CONTINUATION_BIFURCATION && b->mode >= DEA_MODES_MAX) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "%zu modes are unstable already", b->mode);
  }
  for (int k = 0; k < 2; k++) {
    DEA_TRY(ctx, dea_continuation_return(ctx, t, ends[k]));
    DEA_TRY(ctx, measure(ctx, t, b, &b->value[k]));
  }
  if (b->value[0] * b->value[1] > 0) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no change of sign between the two points");
  }
  DEA_TRY(ctx, close_in(ctx, t, b));
  return DEA_OK;
}

dea_status dea_solid_continuation_locate(struct dea_context *ctx, struct dea_solid_continuation *t,
                                         struct dea_continuation_point *point)
{
  struct bracket b = {0};
  if (t->event == DEA_CONTINUATION_NOTHING) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the last step has passed no critical point");
  }
  b.way = dea_alloc(ctx, t->s->path.state_count, sizeof *b.way);
  dea_status status = dea_solid_agree(ctx, t->s, b.way != NULL ? DEA_OK : DEA_E_MEMORY);
  if (status == DEA_OK) {
    status = locate(ctx, t, &b);
  }
  dea_free(ctx, b.way);
  if (status != DEA_OK) {
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  t->located = t->event;
  dea_continuation_report(t, &t->critical, t->event, point);
  return DEA_OK;
}

/* Onto the branch at a distance along the critical mode. */
static dea_status leave_along(struct dea_context *ctx, struct dea_solid_continuation *t,
                              double distance)
{
  int iterations;
  DEA_TRY(ctx, dea_continuation_return(ctx, t, &t->critical));
  double size = dea_continuation_size(t, t->mode);
  for (size_t i = 0; i < t->s->dofs; i++) {
    t->start[i] = distance / size * t->mode[i];
  }
  DEA_TRY(ctx, dea_continuation_advance(ctx, t, t->start, 0));
  dea_continuation_orient_plane(t, t->mode, 0);
  t->plane.u0 = t->critical.state;
  t->plane.tau0 = t->critical.load;
  t->plane.length = distance;
  DEA_TRY(ctx, dea_continuation_correct(ctx, t, &iterations));
  for (size_t i = 0; i < t->s->dofs; i++) {
    t->start[i] = t->s->u[i] - t->critical.state[i];
  }
  return DEA_OK;
}

dea_status dea_solid_continuation_switch(struct dea_context *ctx, struct dea_solid_continuation *t,
                                         int side, double distance,
                                         struct dea_continuation_point *point)
{
  if (t->located != DEA_CONTINUATION_BIFURCATION || !(distance > 0)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "another branch starts at a bifurcation that was located");
  }
  dea_status status = DEA_OK;
  for (int i = 0; i < SIZES_MAX; i++, distance /= 2) {
    dea_context_clear(ctx);
    status = leave_along(ctx, t, side < 0 ? -distance : distance);
    if (status != DEA_E_NOT_CONVERGED && status != DEA_E_DOMAIN) {
      break;
    }
  }
  DEA_TRY(ctx, status);
  struct dea_continuation_path_point old = t->before;
  t->before = t->last;
  t->last = old;
  t->last.arc = t->critical.arc + distance;
  DEA_TRY(ctx,
          dea_continuation_arrive(ctx, t, t->start, t->load - t->critical.load, true, &t->last));
  t->event = DEA_CONTINUATION_NOTHING;
  t->step = distance;
  dea_continuation_report(t, &t->last, t->event, point);
  return DEA_OK;
}
