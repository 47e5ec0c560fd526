#include "model/solid/equilibrium/adjoint.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/constraints.h"
#include "model/solid/assembly/incompressible.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/assembly/potential.h"
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
 * over kappa: few steps, each a solution with the factor.
 *
 * Constraints of loads that hold, those of points in contact, are rows of b beside those of the
 * elements: b = C_u / sqrt(w), L = sqrt(w), and the stiffness of their penalty for kappa. */

static const double settled = 1e-7; // change of nu that is left, of the largest nu
enum { STEPS = 200 };

/* The row of a load's multiplier. */
struct row {
  int count, nodes[DEA_PIECE_NODES_MAX];
  double b[DEA_PIECE_DOFS_MAX], root; // root: L, 0 where the constraint is not held
  double stiffness;
};

static double row_times(const struct row *row, const double *v)
{
  double sum = 0;
  for (int i = 0; i < 3 * row->count; i++) {
    sum += row->b[i] * v[3 * row->nodes[i / 3] + i % 3];
  }
  return sum;
}

/* Multipliers of elements and of loads are in other units, and each settles by itself. */
enum { OF_ELEMENTS, OF_LOADS, KINDS };

struct dea_adjoint {
  struct dea_solid *s;
  size_t dofs, pressures, count;      // of u, of multipliers of elements, of answers
  size_t all;                         // multipliers, those of loads behind the others
  bool touches;                       // one of these is held
  struct row *row;                    // [all - pressures]
  struct dea_constraints constraints; // of elements
  double *right;                      // [count][dofs] Q_u; while it is solved for any
  double *pull;                       // [count][all] Q_p
  double *lambda;                     // [count][dofs]
  double *nu;                         // [count][all]
  /* Of the answer that is solved for: what b lambda leaves, the direction of a step, work; K^-1 b^T
   * times the direction. */
  double *left, *towards, *gain; // [all]
  double *conjugate;             // [dofs]
  double *theta;                 // [all] L^T theta of the last assembly, of loads C / L
  double stiff;                  // kappa of the factor over that of the solid
};

/* Rows of the constraints of loads. */
static void find_rows(struct dea_adjoint *a)
{
  const struct dea_solid_problem *p = &a->s->problem;
  struct row *row = a->row;
  for (size_t k = 0; k < p->load_count; k++) {
    const struct dea_solid_load *load = &p->loads[k];
    for (size_t i = 0; i < load->multiplier_count; i++, row++) {
      struct dea_load_constraint c = {.held = false};
      if (load->constraint != NULL) {
        load->constraint(load->self, i, a->s->state.u, &c);
      }
      *row = (struct row){.stiffness = c.stiffness};
      row->root = c.held ? sqrt(c.weight) : 0;
      row->count = c.held ? c.node_count : 0;
      memcpy(row->nodes, c.nodes, (size_t)row->count * sizeof *row->nodes);
      for (int j = 0; j < 3 * row->count; j++) {
        row->b[j] = c.slope[j] / row->root;
      }
      a->touches = a->touches || row->root > 0;
    }
  }
}

static dea_status prepare(struct dea_context *ctx, struct dea_arena *memory, struct dea_adjoint *a)
{
  struct dea_solid *s = a->s;
  struct dea_solid_report report = {0};
  a->dofs = s->problem.dofs;
  a->pressures = dea_solid_pressure_count(s);
  a->all = dea_solid_multiplier_count(s);
  a->row = dea_arena_alloc(memory, a->all - a->pressures, sizeof *a->row);
  dea_solid_alloc_doubles(memory, a->count * a->dofs, (double **[]){&a->right, &a->lambda, NULL});
  dea_solid_alloc_doubles(memory, a->count * a->all, (double **[]){&a->pull, &a->nu, NULL});
  dea_solid_alloc_doubles(memory, a->all,
                          (double **[]){&a->left, &a->towards, &a->gain, &a->theta, NULL});
  dea_solid_alloc_doubles(memory, a->dofs, (double **[]){&a->conjugate, NULL});
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(memory)));
  find_rows(a);
  // of the state before the last step, which was a 1e-8 of the way, or of this one; other points
  // may have been in touch then
  if (a->touches ||
      !(s->found.factor_fits ||
        s->found.stiff_factor_fits)) { // K at a finite kappa may have a negative pivot
    DEA_TRY(ctx, dea_solid_count_unstable(ctx, s, false, &report));
  }
  a->stiff = s->found.factor_fits ? 1 : DEA_SOLID_STIFF;
  return DEA_CHAIN(ctx, dea_constraints_find(ctx, memory, s, &a->constraints));
}

dea_status dea_adjoint_create(struct dea_context *ctx, struct dea_solid *solid, size_t count,
                              struct dea_arena *memory, struct dea_adjoint **out)
{
  *out = dea_arena_alloc(memory, 1, sizeof **out);
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(memory)));
  **out = (struct dea_adjoint){.s = solid, .count = count};
  return DEA_CHAIN(ctx, prepare(ctx, memory, *out));
}

/* out [dofs] = b^T nu. */
static void push(const struct dea_adjoint *a, const double *nu, double *out)
{
  dea_constraints_push(&a->constraints, nu, out);
  for (size_t i = a->pressures; i < a->all; i++) {
    const struct row *row = &a->row[i - a->pressures];
    for (int j = 0; j < 3 * row->count; j++) {
      out[3 * row->nodes[j / 3] + j % 3] += nu[i] * row->b[j];
    }
  }
}

/* out [all] = b v. */
static void squeeze(const struct dea_adjoint *a, const double *v, double *out)
{
  dea_constraints_grow(&a->constraints, v, out);
  dea_solid_sum(out, a->pressures);
  for (size_t i = a->pressures; i < a->all; i++) {
    out[i] = row_times(&a->row[i - a->pressures], v);
  }
}

static double kappa_of(const struct dea_adjoint *a, size_t i)
{
  return i < a->pressures ? a->stiff * dea_solid_bulk_modulus(a->s, i / a->constraints.most)
                          : a->row[i - a->pressures].stiffness;
}

static int kind_of(const struct dea_adjoint *a, size_t i)
{
  return i < a->pressures ? OF_ELEMENTS : OF_LOADS;
}

/* out [dofs] = K^-1 right, without what is held. */
static dea_status solve(struct dea_context *ctx, struct dea_adjoint *a, double *right, double *out)
{
  dea_solid_release_held(a->s, right);
  return DEA_CHAIN(ctx, dea_solid_solve_linear(ctx, a->s, right, out));
}

/* left -= L^-1 Q_p. */
static void get_pressures(struct dea_adjoint *a, size_t number)
{
  const double *pull = a->pull + number * a->all;
  double *sum = a->gain;
  memset(sum, 0, a->pressures * sizeof *sum);
  for (size_t k = 0; k < a->s->problem.own_count; k++) {
    const struct dea_element_constraint at = dea_constraints_at(&a->constraints, k);
    memcpy(sum + at.first, pull + at.first, at.count * sizeof *sum);
  }
  dea_constraints_solve(&a->constraints, false, sum);
  dea_solid_sum(sum, a->pressures);
  dea_add(a->pressures, -1, sum, a->left);
  for (size_t i = a->pressures; i < a->all; i++) {
    const double root = a->row[i - a->pressures].root;
    a->left[i] -= root > 0 ? pull[i] / root : 0;
  }
}

/* left . kappa left, what is left of the second equation; change: the largest kappa left. */
static double size_of(const struct dea_adjoint *a, double change[KINDS])
{
  double sum = 0;
  change[OF_ELEMENTS] = change[OF_LOADS] = 0;
  for (size_t i = 0; i < a->all; i++) {
    double z = kappa_of(a, i) * a->left[i], *most = &change[kind_of(a, i)];
    sum += a->left[i] * z;
    *most = fmax(*most, fabs(z));
  }
  return sum;
}

/* One step of conjugate gradients along the direction, where left has that size. largest: of nu. */
static void step(struct dea_adjoint *a, double size, double *lambda, double *nu,
                 double largest[KINDS])
{
  double product = 0;
  squeeze(a, a->conjugate, a->gain);
  for (size_t i = 0; i < a->all; i++) {
    product += a->towards[i] * a->gain[i];
  }
  const double length = product != 0 ? size / product : 0;
  for (size_t i = 0; i < a->all; i++) {
    double *most = &largest[kind_of(a, i)];
    nu[i] += length * a->towards[i];
    a->left[i] -= length * a->gain[i];
    *most = fmax(*most, fabs(nu[i]));
  }
  dea_add(a->dofs, -length, a->conjugate, lambda);
}

/* A takes its share of nu from K. */
static void end(struct dea_adjoint *a, const double *lambda, double *nu)
{
  squeeze(a, lambda, a->gain);
  for (size_t i = 0; i < a->all; i++) {
    nu[i] += kappa_of(a, i) * a->gain[i];
  }
}

static dea_status solve_one(struct dea_context *ctx, struct dea_adjoint *a, size_t number)
{
  double *right = dea_adjoint_slope(a, number), *lambda = a->lambda + number * a->dofs;
  double *nu = a->nu + number * a->all, before = 0, largest[KINDS] = {0};
  DEA_TRY(ctx, solve(ctx, a, right, lambda));
  memset(nu, 0, a->all * sizeof *nu);
  squeeze(a, lambda, a->left);
  get_pressures(a, number);
  for (int k = 0; k < STEPS; k++) {
    double change[KINDS];
    const double size = size_of(a, change);
    if (!(change[OF_ELEMENTS] > settled * largest[OF_ELEMENTS]) &&
        !(change[OF_LOADS] > settled * largest[OF_LOADS])) {
      end(a, lambda, nu);
      return DEA_OK;
    }
    for (size_t i = 0; i < a->all; i++) {
      a->towards[i] =
          kappa_of(a, i) * a->left[i] + (before != 0 ? size / before : 0) * a->towards[i];
    }
    before = size;
    push(a, a->towards, right);
    DEA_TRY(ctx, solve(ctx, a, right, a->conjugate));
    step(a, size, lambda, nu, largest);
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the pressures of a gradient do not settle");
}

double *dea_adjoint_slope(struct dea_adjoint *a, size_t number)
{
  return a->right + number * a->dofs;
}

double *dea_adjoint_pressure_slope(struct dea_adjoint *a, size_t number)
{
  return a->pull + number * a->all;
}

const double *dea_adjoint_answer(const struct dea_adjoint *a, size_t number)
{
  return a->lambda + number * a->dofs;
}

dea_status dea_adjoint_solve(struct dea_context *ctx, struct dea_adjoint *a, const bool *wanted)
{
  for (size_t n = 0; n < a->count; n++) {
    DEA_TRY(ctx, wanted[n] ? solve_one(ctx, a, n) : DEA_OK);
  }
  return DEA_OK;
}

double dea_adjoint_pair(struct dea_adjoint *a, size_t answer, size_t number)
{
  const double *nu = a->nu + answer * a->all;
  double sum = dea_solid_dot(a->s, dea_adjoint_answer(a, answer), dea_adjoint_slope(a, number));
  memset(a->left, 0, a->all * sizeof *a->left); // less L^-1 Q_p
  get_pressures(a, number);
  for (size_t i = 0; i < a->all; i++) {
    sum -= nu[i] * a->left[i];
  }
  return sum;
}

void dea_adjoint_add(struct dea_adjoint *a, size_t number, double times, size_t answer)
{
  for (size_t i = 0; i < a->dofs; i++) {
    a->lambda[number * a->dofs + i] += times * a->lambda[answer * a->dofs + i];
  }
  for (size_t i = 0; i < a->all; i++) {
    a->nu[number * a->all + i] += times * a->nu[answer * a->all + i];
  }
}

/* Constraints of the loads that are now under the solid. */
static void evaluate_rows(struct dea_adjoint *a)
{
  const struct dea_solid_problem *p = &a->s->problem;
  const struct row *row = a->row;
  double *theta = a->theta + a->pressures;
  for (size_t k = 0; k < p->load_count; k++) {
    const struct dea_solid_load *load = &p->loads[k];
    for (size_t i = 0; i < load->multiplier_count; i++, row++, theta++) {
      struct dea_load_constraint c;
      if (row->root > 0) {
        load->constraint(load->self, i, a->s->state.u, &c);
        *theta = c.value / row->root;
      }
    }
  }
}

dea_status dea_adjoint_assemble(struct dea_context *ctx, struct dea_adjoint *a, double voltage_V,
                                double *energy_J)
{
  struct dea_solid *s = a->s;
  dea_solid_hold_potential(s, voltage_V, s->state.u);
  DEA_TRY(ctx, dea_solid_assemble_forces(ctx, s, voltage_V, energy_J));
  memset(a->theta, 0, a->all * sizeof *a->theta);
  for (size_t k = 0; k < s->problem.own_count; k++) {
    const struct dea_element_constraint at = dea_constraints_at(&a->constraints, k);
    for (size_t m = 0; m < at.count; m++) {
      for (size_t c = m; c < at.count; c++) { // L^T theta
        a->theta[at.first + m] += at.L[c * at.count + m] * s->state.theta[at.first + c];
      }
    }
  }
  dea_solid_sum(a->theta, a->pressures);
  evaluate_rows(a);
  return DEA_OK;
}

double dea_adjoint_product(const struct dea_adjoint *a, size_t number)
{
  const double *lambda = a->lambda + number * a->dofs, *nu = a->nu + number * a->all;
  double sum = dea_solid_dot(a->s, lambda, a->s->work.g);
  for (size_t i = 0; i < a->all; i++) {
    sum += nu[i] * a->theta[i];
  }
  return sum;
}

// Modes ------------------------------------------------------------------------------------------

void dea_adjoint_add_constraints(const struct dea_adjoint *a, double times, double *out)
{
  for (size_t k = 0; k < a->s->problem.own_count; k++) {
    const struct dea_element_constraint at = dea_constraints_at(&a->constraints, k);
    for (size_t m = 0; m < at.count; m++) {
      for (size_t c = 0; c <= m; c++) {
        out[at.first + m] += times * at.L[m * at.count + c] * a->theta[at.first + c];
      }
    }
  }
  for (size_t i = a->pressures; i < a->all; i++) {
    out[i] += times * a->row[i - a->pressures].root * a->theta[i];
  }
}

void dea_adjoint_mode_pressures(const struct dea_adjoint *a, const double *v, double *out)
{
  dea_constraints_pressures(&a->constraints, v, out);
  for (size_t i = a->pressures; i < a->all; i++) {
    const struct row *row = &a->row[i - a->pressures];
    out[i] = row->root > 0 ? row->stiffness / row->root * row_times(row, v) : 0;
  }
}
