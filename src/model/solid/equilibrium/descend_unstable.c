/* From an unstable equilibrium down to a stable one, and from a stable one to another
 * (docs/theory/branches.md). */
#include "model/solid/assembly/internal.h"
#include "model/solid/equilibrium/branch.h"

#include <math.h>
#include <string.h>

enum { STEPS_MAX = 4 };

static const double push_first = 0.05; // of the solid's length
static const double equal = 1e-6;      // two energies, relative to how far they fell

void dea_solid_accept_unstable(struct dea_solid *solid, bool stay)
{
  solid->stay = stay;
}

/* s->trial = u + size v, and the energy there; INFINITY where there is none. */
static double energy_beside(struct dea_context *ctx, struct dea_solid *s, const double *u,
                            const double *mode, double size)
{
  double energy;
  memcpy(s->trial, u, s->dofs * sizeof *s->trial);
  for (size_t i = 0; i < 3 * s->grid->node_count; i++) {
    s->trial[i] += size * mode[i];
  }
  return dea_solid_solve_potential(ctx, s, s->voltage_V, s->trial) == DEA_OK &&
                 dea_solid_energy(s, s->trial, s->voltage_V, &energy) == DEA_OK
             ? energy
             : INFINITY;
}

/* A push along the mode, with its sign, whose largest displacement is `metres` or less where that
 * is needed to go down, and more as long as that goes down further; 0 when no side goes down. */
static double choose_push(struct dea_context *ctx, struct dea_solid *s, const double *u,
                          const double *mode, double metres, int side, double energy)
{
  double most = 0, push = 0, lowest = energy;
  for (size_t i = 0; i < 3 * s->grid->node_count; i++) {
    most = fmax(most, fabs(mode[i]));
  }
  for (double size = metres / most; push == 0 && size > 1e-4 * metres / most; size /= 2) {
    double up = side >= 0 ? energy_beside(ctx, s, u, mode, size) : INFINITY;
    double down = side <= 0 ? energy_beside(ctx, s, u, mode, -size) : INFINITY;
    lowest = fmin(up, down);
    if (lowest < energy) {
      push = up <= down + equal * fabs(energy - down) ? size : -size;
    }
  }
  double next = push != 0 ? energy_beside(ctx, s, u, mode, 2 * push) : INFINITY;
  while (next < lowest) {
    lowest = next;
    push *= 2;
    next = energy_beside(ctx, s, u, mode, 2 * push);
  }
  return push;
}

/* One step down along the lowest mode: a push, or on the path of a force. */
static dea_status go_down(struct dea_context *ctx, struct dea_solid *s, int side, bool pull,
                          double *mode, struct dea_solid_report *report)
{
  double value;
  DEA_TRY(ctx, dea_solid_unstable_mode(ctx, s, &value, mode));
  double push = choose_push(ctx, s, s->u, mode, push_first * s->length_m, side, report->energy_J);
  if (push == 0) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "an unstable mode without a way down");
  }
  s->factor_fits = false;
  if (pull) {
    DEA_TRY(ctx, dea_solid_mode_continuation(ctx, s, push > 0 ? 1 : -1, value, mode, report));
    return DEA_OK;
  }
  energy_beside(ctx, s, s->u, mode, push);
  memcpy(s->u, s->trial, s->dofs * sizeof *s->u);
  DEA_TRY(ctx, dea_solid_equilibrate(ctx, s, report));
  return DEA_OK;
}

/* Until no mode is unstable and the energy is lower. */
static dea_status descend(struct dea_context *ctx, struct dea_solid *s, int side, bool pull,
                          double *mode, struct dea_solid_report *report)
{
  double energy = report->energy_J;
  for (int k = 0; k < STEPS_MAX && report->unstable_modes > 0; k++) {
    DEA_TRY(ctx, go_down(ctx, s, k == 0 ? side : 0, pull, mode, report));
  }
  return report->unstable_modes == 0 && report->energy_J <= energy
             ? DEA_OK
             : dea_fail(ctx, DEA_E_NOT_CONVERGED, "no way down from an unstable equilibrium");
}

/* First by pushes; where those come back or do not end, by forces. state: where it starts. */
static dea_status try_both(struct dea_context *ctx, struct dea_solid *s, int side, double *mode,
                           const double *state, struct dea_solid_report *report)
{
  const struct dea_solid_report before = *report;
  dea_status status = descend(ctx, s, side, false, mode, report);
  if ((status == DEA_E_NOT_CONVERGED || status == DEA_E_DOMAIN) && s->field == NULL) {
    dea_context_clear(ctx);
    dea_solid_state_set(s, state);
    s->factor_fits = s->predicted_fits = false;
    *report = before;
    status = descend(ctx, s, side, true, mode, report);
  }
  return status;
}

dea_status dea_solid_descend_unstable(struct dea_context *ctx, struct dea_solid *s, int side,
                                      struct dea_solid_report *report)
{
  *report = (struct dea_solid_report){.way = 1};
  DEA_TRY(ctx, dea_solid_agree(ctx, s, dea_load_steps_prepare(ctx, s)));
  DEA_TRY(ctx, dea_solid_equilibrate(ctx, s, report));
  if (report->unstable_modes > 0) {
    DEA_TRY(ctx, dea_solid_descend_from(ctx, s, side, report));
  }
  return DEA_OK;
}

dea_status dea_solid_descend_from(struct dea_context *ctx, struct dea_solid *s, int side,
                                  struct dea_solid_report *report)
{
  double *mode = dea_alloc(ctx, 3 * s->grid->node_count, sizeof *mode);
  double *state = dea_alloc(ctx, s->path.state_count, sizeof *state);
  dea_status status =
      dea_solid_agree(ctx, s, mode != NULL && state != NULL ? DEA_OK : DEA_E_MEMORY);
  if (status == DEA_OK) {
    struct dea_solid_report before = *report;
    dea_solid_state_get(s, state);
    status = try_both(ctx, s, side, mode, state, report);
    if (status == DEA_OK) {
      report->snapped = true;
    } else {
      dea_solid_state_set(s, state);
      *report = before;
      s->factor_fits = s->predicted_fits = false;
    }
  }
  dea_free(ctx, mode);
  dea_free(ctx, state);
  return status;
}

/* dea_solid_push from state, which is that of the solid. */
static dea_status push_down(struct dea_context *ctx, struct dea_solid *s, const double *push_m,
                            struct dea_solid_report *report)
{
  memset(s->step, 0, s->dofs * sizeof *s->step);
  memcpy(s->step, push_m, 3 * s->grid->node_count * sizeof *s->step);
  dea_solid_release_held(s, s->step);
  for (size_t i = 0; i < s->dofs; i++) {
    s->u[i] += s->step[i];
  }
  s->factor_fits = false;
  *report = (struct dea_solid_report){.way = 1};
  DEA_TRY(ctx, dea_solid_equilibrate(ctx, s, report));
  return DEA_OK;
}

dea_status dea_solid_push(struct dea_context *ctx, struct dea_solid *s, const double *push_m,
                          bool (*accept)(const void *self, const double *displacement_m),
                          const void *self, struct dea_solid_report *report, bool *found)
{
  struct dea_solid_report before = *report;
  *found = false;
  DEA_TRY(ctx, dea_solid_agree(ctx, s, dea_load_steps_prepare(ctx, s)));
  double *state = dea_alloc(ctx, s->path.state_count, sizeof *state);
  DEA_TRY(ctx, dea_solid_agree(ctx, s, state != NULL ? DEA_OK : DEA_E_MEMORY));
  dea_solid_state_get(s, state);
  dea_status status = push_down(ctx, s, push_m, report);
  *found = status == DEA_OK && report->unstable_modes == 0 && accept(self, s->u);
  if (!*found) {
    dea_solid_state_set(s, state);
    *report = before;
    s->factor_fits = s->predicted_fits = false;
  }
  if (status == DEA_E_NOT_CONVERGED || status == DEA_E_DOMAIN) {
    dea_context_clear(ctx);
    status = DEA_OK;
  }
  dea_free(ctx, state);
  return status;
}
