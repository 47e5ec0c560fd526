#include "model/solid/equilibrium/adjoint.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/elements.h"
#include "model/solid/assembly/incompressible.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/equilibrium/newton.h"

#include <math.h>
#include <string.h>

/* The factor is of K = A + kappa B M^-1 B^T, M the product of pressures. With nu = L^T mu, M = L
 * L^T, and b = L^-1 B^T of each element (element.h) the system is
 *
 *   K lambda + b^T nu = Q_u,   b lambda = L^-1 Q_p,
 *
 * in which nu is less by kappa b lambda than with A in place of K,
 * and nu is found by conjugate gradients on b K^-1 b^T, which kappa makes nearly the unit matrix
 * over kappa: few steps, each a solution with the factor. */

static const double settled = 1e-9; // change of nu that is left, of the largest nu
enum { STEPS = 40 };

struct dea_adjoint {
  struct dea_arena memory; // of the arrays
  struct dea_solid *s;
  size_t dofs, pressures, count; // of u, of all multipliers, of answers
  double *b, *L;                 // of each own element, see dea_element_type.constraint
  double *lambda;                // [count][dofs]
  double *nu;                    // [count][pressures]
  double *right, *way;           // [dofs] of an answer, way: K^-1 b^T towards
  double *left, *towards, *gain; // [pressures] of b lambda, direction of a step, b way
  double *theta;                 // [pressures] L^T theta of the last assembly
  double stiff;                  // kappa of the factor over that of the solid
  int solutions;
};

static size_t most_of(const struct dea_adjoint *a)
{
  return (size_t)a->s->problem.elements.pressures;
}

static dea_status find_constraints(struct dea_context *ctx, struct dea_adjoint *a)
{
  const struct dea_solid_problem *p = &a->s->problem;
  size_t most = most_of(a);
  dea_status status = DEA_OK;
  for (size_t k = 0; k < p->own_count && status == DEA_OK; k++) {
    size_t e = p->own[k];
    const struct dea_element *element = dea_solid_element(a->s, e);
    struct dea_solid_element_place place;
    struct dea_element_input in;
    if (element->type->constraint != NULL) {
      dea_solid_element_input(a->s, e, a->s->state.u, a->s->state.voltage_V, &place, &in);
      status = element->type->constraint(element, &in, a->b + k * most * DEA_HEX_DOFS_MAX,
                                         a->L + k * most * most);
    }
  }
  return dea_solid_agree(ctx, status);
}

static dea_status prepare(struct dea_context *ctx, struct dea_adjoint *a)
{
  struct dea_solid *s = a->s;
  struct dea_solid_report report = {0};
  size_t own = s->problem.own_count, most = most_of(a);
  a->dofs = s->problem.dofs;
  a->pressures = dea_solid_pressure_count(s);
  a->b = dea_arena_alloc(&a->memory, own * most * DEA_HEX_DOFS_MAX, sizeof(double));
  a->L = dea_arena_alloc(&a->memory, own * most * most, sizeof(double));
  a->lambda = dea_arena_alloc(&a->memory, a->count * a->dofs, sizeof(double));
  a->nu = dea_arena_alloc(&a->memory, a->count * a->pressures, sizeof(double));
  a->right = dea_arena_alloc(&a->memory, a->dofs, sizeof(double));
  a->way = dea_arena_alloc(&a->memory, a->dofs, sizeof(double));
  double **const pressures[] = {&a->left, &a->towards, &a->gain, &a->theta};
  for (size_t i = 0; i < sizeof pressures / sizeof pressures[0]; i++) {
    *pressures[i] = dea_arena_alloc(&a->memory, a->pressures, sizeof(double));
  }
  DEA_TRY(ctx, dea_solid_agree(ctx, dea_arena_status(&a->memory)));
  // the factor at hand may be of the state before; K at a finite kappa may have a negative pivot
  DEA_TRY(ctx, dea_solid_count_unstable(ctx, s, false, &report));
  a->stiff = s->found.factor_fits ? 1 : s->settings.bulk_stiff;
  DEA_TRY(ctx, find_constraints(ctx, a));
  return DEA_OK;
}

dea_status dea_adjoint_create(struct dea_context *ctx, struct dea_solid *solid, size_t count,
                              struct dea_adjoint **out)
{
  struct dea_adjoint *a = dea_alloc(ctx, 1, sizeof *a);
  *out = NULL;
  if (dea_solid_any(a == NULL)) {
    dea_free(ctx, a);
    return DEA_E_MEMORY;
  }
  *a = (struct dea_adjoint){.memory = {.ctx = ctx}, .s = solid, .count = count};
  dea_status status = prepare(ctx, a);
  if (status != DEA_OK) {
    dea_adjoint_destroy(ctx, a);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = a;
  return DEA_OK;
}

void dea_adjoint_destroy(struct dea_context *ctx, struct dea_adjoint *a)
{
  if (a != NULL) {
    dea_arena_free(&a->memory);
    dea_free(ctx, a);
  }
}

/* out [dofs] = b^T nu. */
static void push(struct dea_adjoint *a, const double *nu, double *out)
{
  struct dea_solid *s = a->s;
  const struct dea_solid_problem *p = &s->problem;
  size_t most = most_of(a);
  memset(out, 0, a->dofs * sizeof *out);
  for (size_t k = 0; k < p->own_count && most > 0; k++) {
    size_t e = p->own[k], count = (size_t)dea_solid_element(s, e)->pressures;
    const double *b = a->b + k * most * DEA_HEX_DOFS_MAX;
    const int *nodes;
    size_t dofs = 3 * (size_t)dea_solid_nodes(s, e, &nodes);
    for (size_t m = 0; m < count; m++, b += dofs) {
      for (size_t i = 0; i < dofs; i++) {
        out[3 * (size_t)nodes[i / 3] + i % 3] += nu[e * most + m] * b[i];
      }
    }
  }
  dea_solid_sum(out, a->dofs);
}

/* out [pressures] = b v. */
static void squeeze(const struct dea_adjoint *a, const double *v, double *out)
{
  struct dea_solid *s = a->s;
  const struct dea_solid_problem *p = &s->problem;
  size_t most = most_of(a);
  double own[DEA_HEX_DOFS_MAX];
  memset(out, 0, a->pressures * sizeof *out);
  for (size_t k = 0; k < p->own_count && most > 0; k++) {
    size_t e = p->own[k], count = (size_t)dea_solid_element(s, e)->pressures;
    const double *b = a->b + k * most * DEA_HEX_DOFS_MAX;
    size_t dofs = 3 * (size_t)dea_solid_gather(s, e, v, own);
    for (size_t m = 0; m < count; m++) {
      for (size_t i = 0; i < dofs; i++) {
        out[e * most + m] += b[m * dofs + i] * own[i];
      }
    }
  }
  dea_solid_sum(out, a->pressures);
}

/* K^-1 right, without what is held. */
static dea_status solve(struct dea_context *ctx, struct dea_adjoint *a, double *right, double *out)
{
  dea_solid_release_held(a->s, right);
  DEA_TRY(ctx, dea_solid_solve_linear(ctx, a->s, right, out));
  a->solutions++;
  return DEA_OK;
}

static double kappa_of(const struct dea_adjoint *a, size_t pressure)
{
  return a->stiff * dea_solid_bulk_modulus(a->s, pressure / most_of(a));
}

/* left . kappa left, what is left of the second equation; *change: the largest kappa left. */
static double size_of(const struct dea_adjoint *a, double *change)
{
  double sum = 0;
  *change = 0;
  for (size_t i = 0; i < a->pressures; i++) {
    double z = kappa_of(a, i) * a->left[i];
    sum += a->left[i] * z;
    *change = fmax(*change, fabs(z));
  }
  return sum;
}

/* One step of conjugate gradients along `towards`; size: of left before. */
static dea_status step(struct dea_context *ctx, struct dea_adjoint *a, double size, double *lambda,
                       double *nu)
{
  double product = 0;
  push(a, a->towards, a->right);
  DEA_TRY(ctx, solve(ctx, a, a->right, a->way));
  squeeze(a, a->way, a->gain);
  for (size_t i = 0; i < a->pressures; i++) {
    product += a->towards[i] * a->gain[i];
  }
  double length = product != 0 ? size / product : 0;
  for (size_t i = 0; i < a->pressures; i++) {
    nu[i] += length * a->towards[i];
    a->left[i] -= length * a->gain[i];
  }
  for (size_t i = 0; i < a->dofs; i++) {
    lambda[i] -= length * a->way[i];
  }
  return DEA_OK;
}

/* left -= L^-1 Q_p. */
static void take_pressures(struct dea_adjoint *a, const double *pressure_slope)
{
  const struct dea_solid_problem *p = &a->s->problem;
  size_t most = most_of(a);
  double *sum = a->gain;
  memset(sum, 0, a->pressures * sizeof *sum);
  for (size_t k = 0; k < p->own_count && most > 0; k++) {
    size_t e = p->own[k], count = (size_t)dea_solid_element(a->s, e)->pressures;
    const double *L = a->L + k * most * most;
    for (size_t m = 0; m < count && L[0] > 0; m++) {
      sum[e * most + m] = pressure_slope[e * most + m];
      for (size_t c = 0; c < m; c++) {
        sum[e * most + m] -= L[m * count + c] * sum[e * most + c];
      }
      sum[e * most + m] /= L[m * count + m];
    }
  }
  dea_solid_sum(sum, a->pressures);
  for (size_t i = 0; i < a->pressures; i++) {
    a->left[i] -= sum[i];
  }
}

dea_status dea_adjoint_solve(struct dea_context *ctx, struct dea_adjoint *a, size_t number,
                             const double *slope, const double *pressure_slope)
{
  double *lambda = a->lambda + number * a->dofs, *nu = a->nu + number * a->pressures;
  double before = 0, change, largest = 0;
  memset(nu, 0, a->pressures * sizeof *nu);
  memset(a->towards, 0, a->pressures * sizeof *a->towards);
  memcpy(a->right, slope, a->dofs * sizeof *slope);
  DEA_TRY(ctx, solve(ctx, a, a->right, lambda));
  squeeze(a, lambda, a->left);
  take_pressures(a, pressure_slope);
  for (int i = 0; i < STEPS; i++) {
    double size = size_of(a, &change);
    if (!(change > settled * largest)) {
      squeeze(a, lambda, a->gain); // A takes its share of nu from K
      for (size_t k = 0; k < a->pressures; k++) {
        nu[k] += kappa_of(a, k) * a->gain[k];
      }
      return DEA_OK;
    }
    for (size_t k = 0; k < a->pressures; k++) {
      a->towards[k] =
          kappa_of(a, k) * a->left[k] + (before != 0 ? size / before : 0) * a->towards[k];
    }
    DEA_TRY(ctx, step(ctx, a, size, lambda, nu));
    before = size;
    for (size_t k = 0; k < a->pressures; k++) {
      largest = fmax(largest, fabs(nu[k]));
    }
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the pressures of a gradient do not settle");
}

dea_status dea_adjoint_assemble(struct dea_context *ctx, struct dea_adjoint *a, double voltage_V,
                                double *energy_J)
{
  static const double none = 0x1p-100; // of kappa: kappa theta is no pressure of the state
  struct dea_solid *s = a->s;
  const struct dea_solid_problem *p = &s->problem;
  size_t most = most_of(a);
  dea_solid_scale_bulk_modulus(s, none);
  dea_status status = dea_solid_assemble(ctx, s, voltage_V, DEA_FORCE, energy_J);
  dea_solid_scale_bulk_modulus(s, 1 / none);
  DEA_TRY(ctx, status);
  memset(a->theta, 0, a->pressures * sizeof *a->theta);
  for (size_t k = 0; k < p->own_count && most > 0; k++) {
    size_t e = p->own[k], count = (size_t)dea_solid_element(s, e)->pressures;
    const double *L = a->L + k * most * most;
    for (size_t m = 0; m < count; m++) {
      for (size_t c = m; c < count; c++) { // L^T theta
        a->theta[e * most + m] += L[c * count + m] * s->state.theta[e * most + c];
      }
    }
  }
  dea_solid_sum(a->theta, a->pressures);
  return DEA_OK;
}

double dea_adjoint_product(const struct dea_adjoint *a, size_t number)
{
  const double *lambda = a->lambda + number * a->dofs, *nu = a->nu + number * a->pressures;
  double sum = dea_solid_dot(a->s, lambda, a->s->work.g);
  for (size_t i = 0; i < a->pressures; i++) {
    sum += nu[i] * a->theta[i];
  }
  return sum;
}

int dea_adjoint_solutions(const struct dea_adjoint *a)
{
  return a->solutions;
}
