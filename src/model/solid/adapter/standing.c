#include "model/solid/adapter/standing.h"

#include "model/solid/adapter/state.h"

enum { VOLTAGE, LEFT_A_STATE, NUMBERS };
static const char own_name[] = "model";

void dea_standing_free(struct dea_context *ctx, struct dea_standing *standing)
{
  dea_circuit_step_destroy(ctx, standing->driven);
  standing->driven = NULL;
}

// Equilibria -------------------------------------------------------------------------------------

dea_status dea_standing_solve(struct dea_context *ctx, struct dea_standing *standing,
                              double voltage_V, struct dea_load_point *out)
{
  const struct dea_ending_owner *owner = &standing->ending.owner;
  dea_standing_end_history(ctx, standing);
  DEA_TRY(ctx,
          dea_ending_go(ctx, &standing->ending, standing->voltage_V, voltage_V, &standing->report));
  DEA_TRY(ctx, owner->point(ctx, owner->model, standing->voltage_V, out));
  return DEA_OK;
}

const struct dea_event *dea_standing_limit(const struct dea_standing *standing)
{
  return dea_ending_limit(&standing->ending);
}

const struct dea_event *dea_standing_passed(const struct dea_standing *standing)
{
  return dea_ending_passed(&standing->ending);
}

// In time ----------------------------------------------------------------------------------------

void dea_standing_end_history(struct dea_context *ctx, struct dea_standing *standing)
{
  if (standing->driven != NULL) {
    dea_standing_free(ctx, standing);
    standing->voltage_V = dea_solid_voltage(standing->ending.owner.solid);
  }
}

static dea_status report_time(struct dea_context *ctx, struct dea_standing *standing,
                              struct dea_load_point *out)
{
  const struct dea_ending_owner *owner = &standing->ending.owner;
  standing->voltage_V = dea_solid_voltage(owner->solid);
  DEA_TRY(ctx, owner->point(ctx, owner->model, standing->voltage_V, out));
  dea_circuit_step_point(standing->driven, out);
  out->stored_energy_J += standing->stored_J;
  out->energy_J = out->stored_energy_J - out->charge_C * out->voltage_V;
  return DEA_OK;
}

dea_status dea_standing_begin(struct dea_context *ctx, struct dea_standing *standing,
                              const struct dea_driven_solid *driven,
                              const struct dea_time_options *time, struct dea_load_point *out)
{
  const struct dea_ending_owner *owner = &standing->ending.owner;
  dea_standing_end_history(ctx, standing);
  DEA_TRY(ctx, owner->point(ctx, owner->model, standing->voltage_V, out));
  standing->stored_J = out->energy_J + out->capacitance_F * out->voltage_V * out->voltage_V;
  DEA_TRY(ctx, dea_circuit_step_create(ctx, driven, time, &standing->driven));
  DEA_TRY(ctx, report_time(ctx, standing, out));
  return DEA_OK;
}

dea_status dea_standing_advance(struct dea_context *ctx, struct dea_standing *standing,
                                const struct dea_time_step *step, struct dea_load_point *out,
                                double *error)
{
  if (standing->driven == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a history in time has to begin first");
  }
  if (dea_solid_any(dea_interrupted(ctx))) {
    return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted in a step in time");
  }
  DEA_TRY(ctx, dea_circuit_step_advance(ctx, standing->driven, step, &standing->report, error));
  DEA_TRY(ctx, report_time(ctx, standing, out));
  return DEA_OK;
}

void dea_standing_accept(struct dea_standing *standing)
{
  dea_circuit_step_accept(standing->driven);
}

// Saved states -----------------------------------------------------------------------------------

dea_status dea_standing_save(struct dea_context *ctx, const struct dea_standing *standing,
                             struct dea_state *out)
{
  const double own[NUMBERS] = {
      [VOLTAGE] = standing->voltage_V, [LEFT_A_STATE] = standing->left_a_state ? 1 : 0};
  *out = (struct dea_state){0};
  DEA_TRY(ctx, dea_solid_save(ctx, standing->ending.owner.solid, out));
  DEA_TRY(ctx, dea_state_add_numbers(ctx, out, own_name, own, NUMBERS));
  return DEA_OK;
}

dea_status dea_standing_load(struct dea_context *ctx, struct dea_standing *standing,
                             const struct dea_state *state)
{
  const double *own = dea_state_find(state, own_name, NUMBERS);
  if (own == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the state is not one of model 3d");
  }
  DEA_TRY(ctx, dea_solid_load(ctx, standing->ending.owner.solid, state));
  standing->voltage_V = own[VOLTAGE];
  standing->left_a_state = own[LEFT_A_STATE] != 0;
  return DEA_OK;
}
