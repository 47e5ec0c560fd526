#include "model/solid/adapter/standing.h"

#include "model/solid/adapter/state.h"

enum { VOLTAGE, LEFT_A_STATE, NUMBERS };
static const char own_name[] = "model";

dea_status dea_standing_solve(struct dea_context *ctx, struct dea_standing *standing,
                              double voltage_V, struct dea_load_point *out)
{
  const struct dea_ending_owner *owner = &standing->ending.owner;
  DEA_TRY(ctx,
          dea_ending_go(ctx, &standing->ending, standing->voltage_V, voltage_V, &standing->report));
  DEA_TRY(ctx, owner->point(ctx, owner->model, standing->voltage_V, out));
  return DEA_OK;
}

const struct dea_event *dea_standing_limit(const struct dea_standing *standing)
{
  return dea_ending_limit(&standing->ending);
}

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
