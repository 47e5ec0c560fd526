/* What a step in time says of itself: energies, works, error. */
#include "model/solid/assembly/internal.h"
#include "model/solid/assembly/mass.h"
#include "model/solid/motion/time_state.h"

#include <math.h>

dea_status dea_time_find_stored(struct dea_context *ctx, struct dea_solid_time *t, double *stored,
                                double *capacitance_F)
{
  struct dea_solid *s = t->solid;
  double potential = 0, capacitance = 0;
  s->history = NULL;
  dea_status status = dea_solid_energy(s, s->u, s->voltage_V, &potential);
  if (status == DEA_OK) {
    status = dea_solid_capacitance(ctx, s, &capacitance);
  }
  s->history = t->history;
  if (status != DEA_OK) {
    return dea_fail(ctx, status, "the energy of the film cannot be evaluated");
  }
  *capacitance_F = isnan(capacitance) ? 0 : capacitance; // NAN: no electrodes
  *stored = potential + *capacitance_F * s->voltage_V * s->voltage_V;
  return DEA_OK;
}

/* The integral of Q dV is half that of C by V^2, along which C is nearly straight. */
double dea_solid_source_work(const double voltage_V[2], const double capacitance_F[2])
{
  const double square[2] = {voltage_V[0] * voltage_V[0], voltage_V[1] * voltage_V[1]};
  return capacitance_F[1] * square[1] - capacitance_F[0] * square[0] -
         0.25 * (capacitance_F[0] + capacitance_F[1]) * (square[1] - square[0]);
}

static double half_square(const double *v, const double *momentum, size_t count)
{
  double sum = 0;
  for (size_t i = 0; i < count; i++) {
    sum += 0.5 * v[i] * momentum[i];
  }
  return sum;
}

dea_status dea_time_find_energies(struct dea_context *ctx, struct dea_solid_time *t)
{
  struct dea_solid *s = t->solid;
  struct dea_solid_branch_energies branches = {0};
  struct dea_solid_energies *sums = &t->sums_next;
  double stored = 0, work = 0;
  *sums = t->sums;
  if (t->history != NULL) {
    DEA_TRY(ctx, dea_internal_variables_close(ctx, t->history, s, &branches));
  }
  DEA_TRY(ctx, dea_time_find_stored(ctx, t, &stored, &t->capacitance_next_F));
  const double voltage_V[2] = {t->controls[0], s->voltage_V};
  const double capacitance_F[2] = {t->capacitance_F, t->capacitance_next_F};
  sums->supply += dea_solid_source_work(voltage_V, capacitance_F);
  sums->stored = stored - t->first_J;
  sums->branches = branches.stored;
  sums->dissipated += branches.dissipated;
  if (t->inertial) {
    for (size_t i = 0; i < t->count; i++) { // of the forces, by the trapezoidal rule
      work -= 0.5 * (t->F[i] + t->F_next[i]) * (s->u[i] - t->keep[i]);
    }
    DEA_TRY(ctx, dea_solid_mass_apply(ctx, s, t->v_next, t->work));
    sums->kinetic = half_square(t->v_next, t->work, t->count);
    sums->damped += t->step_s > 0 ? work - (sums->kinetic - t->sums.kinetic) : 0;
  }
  return DEA_OK;
}

/* Share of the stiffness that relaxes within a step, of the layer with most of it. */
static double relaxing(const struct dea_solid_time *t)
{
  double most = 0;
  for (size_t l = 0; l < t->solid->layer_count && t->history != NULL; l++) {
    const struct dea_branches *branches = &t->history->branches[l];
    double sum = 0, all = dea_constituent_modulus(&t->solid->layers[l]);
    for (size_t i = 0; i < branches->count; i++) {
      sum -= branches->branch[i].modulus_Pa * expm1(-t->step_s / branches->branch[i].time_s);
      all += branches->branch[i].modulus_Pa;
    }
    most = fmax(most, sum / all);
  }
  return most;
}

/* Estimate of the error of the step that was tried. With inertia that of the acceleration taken as
 * straight (Zienkiewicz, Xie 1991). Without it only the branches have a memory, and what counts is
 * that C^-1 is taken as straight over the step: of what relaxes in it, the difference to the step
 * before drawn on; after a corner, where there is none, to the way gone. */
double dea_time_step_error(const struct dea_solid_time *t)
{
  const double *u = t->solid->u, *from = t->keep;
  double h = t->step_s, before = t->step_before_s, most = 0, share = relaxing(t);
  double weight = before > 0 ? 0.25 * h / (h + before) : 0.125;
  for (size_t i = 0; i < t->count; i++) {
    double way = before > 0 ? h / before * (from[i] - t->u_before[i]) : 0;
    double off = t->inertial ? h * h * (t->a_next[i] - t->a[i]) / 12
                             : share * weight * (u[i] - from[i] - way);
    most = fmax(most, fabs(off));
  }
  return most;
}

double dea_solid_time_motion(const struct dea_solid_time *t)
{
  double most = 0;
  for (size_t i = 0; i < t->count; i++) {
    most = fmax(most, fabs(t->solid->u[i] - t->first[i]));
  }
  return most;
}
