/* From an unstable equilibrium down to a stable one, and from a stable one to another
 * (docs/theory/branches.md). */
#include "model/solid/solve/branch.h"
#include "model/solid/solve/internal.h"

#include <math.h>
#include <string.h>

enum { STEPS_MAX = 4, SIZES_MAX = 4 };

static const double push_first = 0.05; // of the solid's length
static const double push_up = 4;
static const double equal = 1e-6; // two energies, relative to how far they fell

void dea_solid_stay(struct dea_solid *solid, bool stay)
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
  return dea_solid_settle(ctx, s, s->voltage_V, s->trial) == DEA_OK &&
                 dea_solid_energy(s, s->trial, s->voltage_V, &energy) == DEA_OK
             ? energy
             : INFINITY;
}

/* The push in metres of the largest displacement, with its sign; 0 when no side goes down. */
static double choose_push(struct dea_context *ctx, struct dea_solid *s, const double *u,
                          const double *mode, double metres, int side, double energy)
{
  double most = 0;
  for (size_t i = 0; i < 3 * s->grid->node_count; i++) {
    most = fmax(most, fabs(mode[i]));
  }
  for (double size = metres / most; size > 1e-4 * metres / most; size /= 2) {
    double up = side >= 0 ? energy_beside(ctx, s, u, mode, size) : INFINITY;
    double down = side <= 0 ? energy_beside(ctx, s, u, mode, -size) : INFINITY;
    if (fmin(up, down) < energy) {
      bool along = up <= down + equal * fabs(energy - down);
      return along ? size : -size;
    }
  }
  return 0;
}

/* One mode after the other until none is unstable. state: that of the first equilibrium. */
static dea_status descend(struct dea_context *ctx, struct dea_solid *s, int side, double *mode,
                          const double *state, struct dea_solid_report *report)
{
  double metres = push_first * s->length_m, energy = report->energy_J;
  for (int i = 0; i < SIZES_MAX; i++, metres *= push_up) {
    int modes = report->unstable_modes;
    for (int k = 0; k < STEPS_MAX && modes > 0; k++) {
      DEA_TRY(ctx, dea_solid_unstable_mode(ctx, s, mode));
      double push = choose_push(ctx, s, s->u, mode, metres, k == 0 ? side : 0, report->energy_J);
      if (push == 0) {
        break;
      }
      energy_beside(ctx, s, s->u, mode, push);
      memcpy(s->u, s->trial, s->dofs * sizeof *s->u);
      s->factor_fits = false;
      DEA_TRY(ctx, dea_solid_settle_down(ctx, s, report));
      modes = report->unstable_modes;
    }
    if (modes == 0 && report->energy_J <= energy) {
      return DEA_OK;
    }
    dea_solid_state_set(s, state); // it came back: a larger push
    DEA_TRY(ctx, dea_solid_settle_down(ctx, s, report));
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no way down from an unstable equilibrium was found");
}

dea_status dea_solid_leave(struct dea_context *ctx, struct dea_solid *s, int side,
                           struct dea_solid_report *report)
{
  *report = (struct dea_solid_report){.way = 1};
  DEA_TRY(ctx, dea_solid_agree(ctx, s, dea_solid_path_prepare(ctx, s)));
  DEA_TRY(ctx, dea_solid_settle_down(ctx, s, report));
  if (report->unstable_modes > 0) {
    DEA_TRY(ctx, dea_solid_leave_from(ctx, s, side, report));
  }
  return DEA_OK;
}

dea_status dea_solid_leave_from(struct dea_context *ctx, struct dea_solid *s, int side,
                                struct dea_solid_report *report)
{
  double *mode = dea_alloc(ctx, 3 * s->grid->node_count, sizeof *mode);
  double *state = dea_alloc(ctx, s->path.state_count, sizeof *state);
  dea_status status =
      dea_solid_agree(ctx, s, mode != NULL && state != NULL ? DEA_OK : DEA_E_MEMORY);
  if (status == DEA_OK) {
    struct dea_solid_report before = *report;
    dea_solid_state_get(s, state);
    status = descend(ctx, s, side, mode, state, report);
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
  DEA_TRY(ctx, dea_solid_settle_down(ctx, s, report));
  return DEA_OK;
}

dea_status dea_solid_push(struct dea_context *ctx, struct dea_solid *s, const double *push_m,
                          bool (*accept)(const void *self, const double *displacement_m),
                          const void *self, struct dea_solid_report *report, bool *found)
{
  struct dea_solid_report before = *report;
  *found = false;
  DEA_TRY(ctx, dea_solid_agree(ctx, s, dea_solid_path_prepare(ctx, s)));
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
