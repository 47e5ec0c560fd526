#include "model/solid/motion/response.h"

#include "model/solid/assembly/channels.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/equilibrium/modes.h"

#include <complex.h>
#include <math.h>
#include <string.h>

/* Superposition of modes, and a series for those that are higher (docs/theory/vibration.md). */

/* Modes that there are at least, where there are so many: what is far below the first one still has
 * its damping from them. */
enum { MODES_LEAST = 8, DOUBLINGS = 12 };
enum { TERMS = 5 };             // of the series
static const double beyond = 2; // modes up to so many times the highest frequency

struct dea_solid_response {
  size_t count, dofs;     // modes; 3 node_count
  double *square, *shape; // [count], [count][dofs]
  double *push;           // [count] work of the electric force per volt on each mode
  double *rest;           // [TERMS][dofs] what the modes leave, a series
};

/* Takes the modes out of v: v -= phi (phi . Mv); work: [dofs]. */
static dea_status purge(struct dea_context *ctx, const struct dea_solid *s,
                        const struct dea_solid_response *r, double *v, double *work)
{
  DEA_TRY(ctx, dea_solid_mass_apply(ctx, s, v, work));
  for (size_t k = 0; k < r->count; k++) {
    const double *phi = r->shape + k * r->dofs;
    double amount = 0;
    for (size_t i = 0; i < r->dofs; i++) {
      amount += phi[i] * work[i];
    }
    dea_add(r->dofs, -amount, phi, v);
  }
  return DEA_OK;
}

/* The rest by powers: r_0 = K^-1 f and r_k = K^-1 M r_k-1, each without the modes. */
static dea_status find_rest(struct dea_context *ctx, struct dea_solid *s,
                            struct dea_solid_response *r, double *force)
{
  int negative;
  DEA_TRY(ctx, dea_solid_factorise(ctx, s, DEA_FACTOR_EXACT, &negative));
  for (size_t k = 0; k < TERMS; k++) {
    double *term = r->rest + k * r->dofs;
    DEA_TRY(ctx, dea_solid_solve_linear(ctx, s, force, s->work.trial));
    memcpy(term, s->work.trial, r->dofs * sizeof *term);
    DEA_TRY(ctx, purge(ctx, s, r, term, s->work.step));
    DEA_TRY(ctx, dea_solid_mass_apply(ctx, s, term, force));
    dea_solid_release_held(s, force);
  }
  return DEA_OK;
}

static dea_status reserve(struct dea_context *ctx, const struct dea_solid *s, size_t count,
                          struct dea_arena *memory, struct dea_solid_response *r)
{
  r->count = count;
  r->dofs = 3 * s->problem.grid->node_count;
  dea_solid_alloc_doubles(memory, count + 1, (double **[]){&r->square, &r->push, NULL});
  r->shape = dea_arena_alloc(memory, count * r->dofs + 1, sizeof *r->shape);
  r->rest = dea_arena_alloc(memory, TERMS * r->dofs, sizeof *r->rest);
  return dea_solid_allreduce(ctx, dea_arena_status(memory));
}

/* How many modes are needed; none of them may be unstable. */
static dea_status count_modes(struct dea_context *ctx, struct dea_solid *s, double highest,
                              size_t *count)
{
  size_t unstable;
  DEA_TRY(ctx, dea_solid_modes_below(ctx, s, DEA_MODES_BY_MASS, 0, &unstable));
  if (unstable > 0) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED,
                    "the equilibrium that the voltage oscillates about is unstable (%zu modes)",
                    unstable);
  }
  double range = beyond * highest;
  DEA_TRY(ctx, dea_solid_modes_below(ctx, s, DEA_MODES_BY_MASS, range * range, count));
  if (*count > DEA_MODES_MAX) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "%zu modes lie below %g times the highest frequency, more than %d", *count,
                    beyond, DEA_MODES_MAX);
  }
  for (int i = 0; i < DOUBLINGS && *count < MODES_LEAST; i++) {
    range *= 2;
    DEA_TRY(ctx, dea_solid_modes_below(ctx, s, DEA_MODES_BY_MASS, range * range, count));
    *count = *count < MODES_LEAST ? *count : MODES_LEAST;
  }
  return DEA_OK;
}

static dea_status fill(struct dea_context *ctx, struct dea_solid *s, double highest,
                       struct dea_arena *memory, struct dea_solid_response *r)
{
  double *force = dea_arena_alloc(memory, s->problem.dofs, sizeof *force);
  size_t count = 0;
  DEA_TRY(ctx, count_modes(ctx, s, highest, &count));
  DEA_TRY(ctx, reserve(ctx, s, count, memory, r));
  DEA_TRY(ctx, dea_solid_voltage_force(ctx, s, 0, force));
  if (count > 0) { // K stays there for the rest
    DEA_TRY(ctx, dea_solid_modes_lowest(ctx, s, DEA_MODES_BY_MASS, count, r->square, r->shape));
  }
  for (size_t k = 0; k < count; k++) {
    for (size_t i = 0; i < r->dofs; i++) {
      r->push[k] += r->shape[k * r->dofs + i] * force[i];
    }
  }
  return DEA_CHAIN(ctx, find_rest(ctx, s, r, force));
}

dea_status dea_solid_response_check(struct dea_context *ctx, const struct dea_solid *s)
{
  return s->problem.field == NULL ? DEA_OK
                                  : dea_fail(ctx, DEA_E_UNSUPPORTED,
                                             "the response to an AC excitation of the voltage "
                                             "needs the field V/h, not a coupled one");
}

dea_status dea_solid_response_create(struct dea_context *ctx, struct dea_solid *s,
                                     double highest_rad_per_s, struct dea_arena *memory,
                                     struct dea_solid_response **out)
{
  DEA_TRY(ctx, dea_solid_response_check(ctx, s));
  *out = dea_arena_alloc(memory, 1, sizeof **out);
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(memory)));
  const dea_status status = fill(ctx, s, highest_rad_per_s, memory, *out);
  s->found.factor_fits = s->found.predicted_fits = false;
  return DEA_CHAIN(ctx, status);
}

/* The rest at s: 1/c sum s^k r_k solves c K q - w^2 M q + i w (mass) M q = f beside the modes, with
 * c = 1 + i w (stiffness) and s = (w^2 - i w (mass))/c. */
static void add_rest(const struct dea_solid_response *r, size_t node, double w,
                     const struct dea_damping *damping, double complex q[3])
{
  double complex c = 1 + _Complex_I * (w * damping->stiffness_s);
  double complex step = (w * w - _Complex_I * (w * damping->mass_per_s)) / c, power = 1 / c;
  for (size_t k = 0; k < TERMS; k++, power *= step) {
    for (size_t i = 0; i < 3; i++) {
      q[i] += power * r->rest[k * r->dofs + 3 * node + i];
    }
  }
}

void dea_solid_response_at(const struct dea_solid_response *r, size_t node, double rad_per_s,
                           const struct dea_damping *damping, double real[3], double imaginary[3])
{
  double w = rad_per_s;
  double complex q[3] = {0, 0, 0};
  add_rest(r, node, w, damping, q);
  for (size_t k = 0; k < r->count; k++) {
    double loss = 2 * damping->ratio * sqrt(r->square[k]) + damping->mass_per_s +
                  damping->stiffness_s * r->square[k];
    double complex amplitude = r->push[k] / (r->square[k] - w * w + _Complex_I * (w * loss));
    for (size_t i = 0; i < 3; i++) {
      q[i] += amplitude * r->shape[k * r->dofs + 3 * node + i];
    }
  }
  for (size_t i = 0; i < 3; i++) {
    real[i] = creal(q[i]);
    imaginary[i] = cimag(q[i]);
  }
}
