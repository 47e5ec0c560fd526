/* How a coordinate of a solid and its charge change with a force along the coordinate and with the
 * voltage (docs/theory/reduced-model.md). */
#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/potential.h"
#include "model/solid/equilibrium/adjoint.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/model3d/air_mass.h"
#include "model/solid/model3d/solid_fields.h"
#include "model/solid/model3d/solid_model.h"

#include <assert.h>
#include <lapacke.h>
#include <math.h>
#include <string.h>

enum { COORDINATE, VOLTAGE, ANSWERS };

struct work {
  struct dea_arena memory;
  struct dea_model *model;
  struct dea_solid *solid;
  const double *slope; // [dofs] of the coordinate by the unknowns
  double *rate;        // [dofs] dR/dV
  double voltage_V, copies;
};

dea_status dea_solid_model_rate(struct dea_context *ctx, struct dea_solid *s,
                                struct dea_adjoint *adjoint, double voltage_V, double step_V,
                                double *rate, double by_energy[2])
{
  double energy_J[3] = {0};
  dea_status status = DEA_OK;
  for (int side = -1; side <= 1 && status == DEA_OK; side += by_energy != NULL ? 1 : 2) {
    s->state.voltage_V = voltage_V + side * step_V;
    status = dea_adjoint_assemble(ctx, adjoint, s->state.voltage_V, &energy_J[side + 1]);
    for (size_t i = 0; i < s->problem.dofs; i++) {
      rate[i] += side * s->work.g[i] / (2 * step_V);
    }
  }
  s->state.voltage_V = voltage_V;
  if (by_energy != NULL) {
    by_energy[0] = (energy_J[2] - energy_J[0]) / (2 * step_V);
    by_energy[1] = (energy_J[2] - 2 * energy_J[1] + energy_J[0]) / (step_V * step_V);
  }
  return status;
}

enum { MODES = DEA_COMPLIANCE_MODES };

/* The lowest modes phi: 1/omega^2, (phi . slope)/omega and -(phi . R_V)/omega. */
struct modes {
  double inverse[MODES], along[MODES], by_rate[MODES];
};

/* Added masses of the modes [MODES][dofs]. */
static dea_status find_air(struct dea_context *ctx, struct work *w, const double *vector,
                           size_t dofs, double out[MODES * MODES])
{
  enum { CELLS = 3000 };
  static_assert((int)MODES <= (int)DEA_AIR_SHAPES_MAX, "room");
  const struct dea_model *model = w->model;
  struct dea_field_mesh *surface, *moved;
  DEA_TRY(ctx, dea_solid_fields(ctx, model->solid, (int)model->plies.film, &surface));
  const size_t size = 3 * surface->point_count;
  double *shapes = dea_arena_alloc(&w->memory, MODES * size, sizeof *shapes);
  dea_status status = dea_solid_allreduce(ctx, dea_arena_status(&w->memory));
  for (size_t k = 0; k < MODES && status == DEA_OK; k++) {
    status = dea_solid_model_surface(ctx, model, vector + k * dofs, &moved);
    if (status == DEA_OK) {
      memcpy(shapes + k * size, dea_field_mesh_find(moved, "displacement_m")->values,
             size * sizeof *shapes);
      dea_field_mesh_destroy(ctx, moved);
    }
  }
  status = status == DEA_OK
               ? dea_air_mass(ctx, surface, &model->mesh.sector, CELLS, shapes, MODES, out)
               : status;
  dea_field_mesh_destroy(ctx, surface);
  return DEA_CHAIN(ctx, status);
}

/* The modes with gas, in the space of those without: with the added masses A the inverse squares
 * are the eigenvalues of (1_kl + A_kl)/(omega_k omega_l), by whose vectors the others turn. */
static dea_status add_air(struct dea_context *ctx, const double *A, double density,
                          struct modes *modes)
{
  const struct modes was = *modes;
  double B[MODES * MODES], values[MODES];
  for (int i = 0; i < MODES * MODES; i++) {
    const int k = i / MODES, l = i % MODES;
    B[i] = sqrt(was.inverse[k] * was.inverse[l]) * ((k == l ? 1 : 0) + density * A[i]);
    if (!isfinite(B[i])) { // an unstable mode
      return dea_fail(ctx, DEA_E_NO_EQUILIBRIUM, "the state is unstable");
    }
  }
  if (LAPACKE_dsyev(LAPACK_COL_MAJOR, 'V', 'U', MODES, B, MODES, values) != 0) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "modes with the gas around the film");
  }
  for (int k = 0; k < MODES; k++) {
    const double *y = B + MODES * (MODES - 1 - k); // descending
    modes->inverse[k] = values[MODES - 1 - k];
    modes->along[k] = modes->by_rate[k] = 0;
    for (int l = 0; l < MODES; l++) {
      modes->along[k] += y[l] * was.along[l];
      modes->by_rate[k] += y[l] * was.by_rate[l];
    }
  }
  return DEA_OK;
}

/* With their parts of dq/dF and dq/dV; of a viscous film of those that move at once. */
static dea_status find_modes(struct dea_context *ctx, struct work *w, struct dea_compliance *out)
{
  const double density = w->model->settings.reduced.air_kg_per_m3;
  const size_t dofs = w->solid->problem.dofs;
  double square[MODES], mass[MODES * MODES],
      *vector = dea_arena_alloc(&w->memory, MODES * dofs, sizeof *vector);
  struct modes modes;
  const bool fast = isfinite(out->fast_by_force);
  const double by_force = fast ? out->fast_by_force : out->by_force,
               by_voltage = fast ? out->fast_by_voltage : out->by_voltage;
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(&w->memory)));
  DEA_TRY(ctx, dea_solid_modes_whole(ctx, w->solid, DEA_MODES_BY_MASS, MODES, square, vector));
  for (size_t k = 0; k < MODES; k++) {
    const double *mode = vector + k * dofs, omega = sqrt(square[k]);
    modes.inverse[k] = 1 / square[k];
    modes.along[k] = dea_solid_dot(w->solid, mode, w->slope) / omega;
    modes.by_rate[k] = -dea_solid_dot(w->solid, mode, w->rate) / omega;
  }
  if (density > 0) {
    DEA_TRY(ctx, find_air(ctx, w, vector, dofs, mass));
    DEA_TRY(ctx, add_air(ctx, mass, density, &modes));
  }
  for (size_t k = 0; k < MODES; k++) {
    out->modes[k] =
        (struct dea_compliance_mode){1 / (2 * DEA_PI * sqrt(modes.inverse[k])),
                                     modes.along[k] * modes.along[k] / (w->copies * by_force),
                                     modes.along[k] * modes.by_rate[k] / by_voltage};
  }
  return DEA_OK;
}

/* du/dF = K^-1 q_u / copies, du/dV = -K^-1 R_V with the tangent as it is: of what moves at once, or
 * of all, with R_V and the charge. */
static dea_status find_slopes(struct dea_context *ctx, struct work *w, bool fast,
                              struct dea_compliance *out)
{
  struct dea_solid *s = w->solid;
  struct dea_adjoint *adjoint;
  const bool wanted[ANSWERS] = {true, !fast};
  double by_energy[2] = {0};
  DEA_TRY(ctx, dea_adjoint_create(ctx, s, ANSWERS, &w->memory, &adjoint));
  DEA_TRY(ctx, fast ? DEA_OK
                    : dea_solid_model_rate(ctx, s, adjoint, w->voltage_V,
                                           fmax(fabs(w->voltage_V), 1e3), w->rate, by_energy));
  memcpy(dea_adjoint_slope(adjoint, COORDINATE), w->slope, s->problem.dofs * sizeof *w->slope);
  memcpy(dea_adjoint_slope(adjoint, VOLTAGE), w->rate, s->problem.dofs * sizeof *w->rate);
  DEA_TRY(ctx, dea_adjoint_solve(ctx, adjoint, wanted));
  const double *by_force = dea_adjoint_answer(adjoint, COORDINATE),
               *by_rate = dea_adjoint_answer(adjoint, VOLTAGE);
  *(fast ? &out->fast_by_force : &out->by_force) = dea_solid_dot(s, by_force, w->slope) / w->copies;
  *(fast ? &out->fast_by_voltage : &out->by_voltage) = -dea_solid_dot(s, by_force, w->rate);
  if (!fast) {
    out->charge_by_force = -dea_solid_dot(s, by_rate, w->slope);
    out->charge_C = -w->copies * by_energy[0];
    out->charge_by_voltage = w->copies * (dea_solid_dot(s, by_rate, w->rate) - by_energy[1]);
  }
  return DEA_OK;
}

/* Slopes of what moves at once and, where they are asked for, its modes: with the tangent of a step
 * that takes no time. */
static dea_status find_fast(struct dea_context *ctx, struct work *w, bool modes,
                            struct dea_compliance *out)
{
  struct dea_solid *s = w->solid;
  struct dea_internal_variables *held;
  DEA_TRY(ctx, dea_internal_variables_create(ctx, s, w->model->plies.branches, &w->memory, &held));
  dea_internal_variables_begin(held, s, 0);
  s->state.internal_variables = held;
  dea_solid_forget(s);
  dea_status status = find_slopes(ctx, w, true, out);
  status = status == DEA_OK && modes ? find_modes(ctx, w, out) : status;
  s->state.internal_variables = NULL;
  dea_solid_forget(s);
  return DEA_CHAIN(ctx, status);
}

static dea_status find_compliance(struct dea_context *ctx, struct work *w, int with,
                                  struct dea_compliance *out)
{
  const bool modes = with & DEA_COMPLIANCE_WITH_MODES;
  DEA_TRY(ctx, find_slopes(ctx, w, false, out));
  if (with & DEA_COMPLIANCE_WITH_FAST) {
    return DEA_CHAIN(ctx, find_fast(ctx, w, modes, out));
  }
  return DEA_CHAIN(ctx, modes ? find_modes(ctx, w, out) : DEA_OK);
}

dea_status dea_solid_model_compliance(struct dea_context *ctx, struct dea_model *model,
                                      const struct dea_control *coordinate, int with,
                                      struct dea_compliance *out)
{
  struct dea_solid *s = model->solid;
  double energy_J;
  DEA_TRY(ctx, dea_solid_model_find_coordinate(ctx, model, coordinate));
  DEA_TRY(ctx, with & DEA_COMPLIANCE_WITH_MODES ? dea_solid_check_densities(ctx, model) : DEA_OK);
  *out = (struct dea_compliance){.value = dea_solid_dot(s, model->pull.slope, s->state.u),
                                 .force = model->pull.force,
                                 .fast_by_force = NAN,
                                 .fast_by_voltage = NAN};
  for (size_t k = 0; k < DEA_COMPLIANCE_MODES; k++) {
    out->modes[k] = (struct dea_compliance_mode){NAN, NAN, NAN};
  }
  struct work w = {.memory = {.ctx = ctx},
                   .model = model,
                   .solid = s,
                   .slope = model->pull.slope,
                   .voltage_V = model->at.voltage_V,
                   .copies = model->copies};
  w.rate = dea_arena_alloc(&w.memory, s->problem.dofs, sizeof *w.rate);
  dea_status status = dea_solid_allreduce(ctx, dea_arena_status(&w.memory));
  status = status == DEA_OK ? find_compliance(ctx, &w, with, out) : status;
  dea_solid_hold_potential(s, w.voltage_V, s->state.u);
  if (status == DEA_OK) { // reactions are those of the equilibrium again
    status = dea_solid_assemble(ctx, s, w.voltage_V, DEA_FORCE, &energy_J);
  }
  dea_arena_free(&w.memory);
  return DEA_CHAIN(ctx, status);
}
