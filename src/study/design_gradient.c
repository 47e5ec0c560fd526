#include "study/design_gradient.h"

#include <math.h>
#include <string.h>

static const double step_at_state = 1e-5, step_anew = 1e-4; // of a number, to either side

// Changed devices --------------------------------------------------------------------------------

/* Room for changed devices. */
struct changed {
  struct dea_arena memory;
  struct dea_changed_device *devices; // [2 number_count]
  struct dea_pressed *pressed;        // [2 number_count]
  struct dea_design_change *changes;  // [number_count]
};

/* One side of a change of a number; false in *there where no device is like that. */
static dea_status build_side(struct dea_context *ctx, const struct dea_design_gradient *ask,
                             size_t i, size_t side, double value, struct changed *all, bool *there)
{
  const struct dea_design_number *number = &ask->numbers[i];
  struct dea_design_change *out = &all->changes[i];
  out->device[side] = ask->device;
  out->voltage_V[side] = ask->voltage_V;
  *there = true;
  if (number->of == DEA_NUMBER_OF_TIP) {
    struct dea_pressed *pressed = &all->pressed[2 * i + side];
    *pressed = *ask->pressed;
    memcpy((char *)pressed + number->offset, &value, sizeof value);
    out->pressed[side] = pressed;
  } else if (number->of == DEA_NUMBER_OF_SUPPLY) {
    out->voltage_V[side] = value;
  } else {
    struct dea_changed_device *changed = &all->devices[2 * i + side];
    const size_t errors = dea_finding_trial_begin(ctx); // what there is to say has been said
    const dea_status status =
        dea_device_change(ctx, ask->design, ask->device, number, value, changed);
    dea_finding_trial_end(ctx, errors);
    *there = status == DEA_OK;
    DEA_TRY(ctx, status == DEA_E_DESIGN ? DEA_OK : status);
    out->device[side] = *there ? &changed->device : ask->device;
  }
  return DEA_OK;
}

/* Makes the changed devices, in room that is freed by free_changes also after a failure: to both
 * sides, or to the one where there is a device. A monitor may stand at the edge of its ply, which
 * cannot be shorter. */
static dea_status begin_changes(struct dea_context *ctx, const struct dea_design_gradient *ask,
                                struct changed *all)
{
  const double share = ask->type->gradient != NULL ? step_at_state : step_anew;
  *all = (struct changed){.memory = {.ctx = ctx}};
  all->devices = dea_arena_alloc(&all->memory, 2 * ask->number_count, sizeof *all->devices);
  all->pressed = dea_arena_alloc(&all->memory, 2 * ask->number_count, sizeof *all->pressed);
  all->changes = dea_arena_alloc(&all->memory, ask->number_count, sizeof *all->changes);
  DEA_TRY(ctx, dea_arena_status(&all->memory));
  for (size_t i = 0; i < ask->number_count; i++) {
    const struct dea_design_number *number = &ask->numbers[i];
    const double step = share * (number->reach > 0 ? number->reach : number->value);
    size_t sides = 0;
    for (size_t k = 0; k < 2; k++) {
      bool there;
      DEA_TRY(ctx,
              build_side(ctx, ask, i, k, number->value + (k == 0 ? -step : step), all, &there));
      sides += there ? 1 : 0;
    }
    all->changes[i].width = (double)sides * step;
    if (sides == 0) {
      all->changes[i].device[0] = NULL;
    }
  }
  return DEA_OK;
}

static void free_changes(const struct dea_design_gradient *ask, struct changed *all)
{
  for (size_t i = 0; all->devices != NULL && i < 2 * ask->number_count; i++) {
    dea_changed_device_free(&all->devices[i]);
  }
  dea_arena_free(&all->memory);
}

dea_status dea_design_gradient_find(struct dea_context *ctx, const struct dea_design_gradient *ask,
                                    double *slopes)
{
  struct changed all;
  const struct dea_model_settings settings = dea_model_settings_of(ask->design);
  dea_status status = begin_changes(ctx, ask, &all);
  if (status == DEA_OK) {
    struct dea_gradient_request of = ask->of;
    of.changes = all.changes;
    of.change_count = ask->number_count;
    status = dea_model_gradient(ctx, ask->type, ask->model, &settings, &of, slopes);
  }
  free_changes(ask, &all);
  return DEA_CHAIN(ctx, status);
}

dea_status dea_design_gradient_critical(struct dea_context *ctx,
                                        const struct dea_design_gradient *ask,
                                        const struct dea_critical *critical, double *slopes)
{
  struct changed all;
  dea_status status = begin_changes(ctx, ask, &all);
  if (status == DEA_OK) {
    status = dea_critical_slopes(ctx, critical, all.changes, ask->number_count, slopes);
  }
  for (size_t i = 0; i < ask->number_count && status == DEA_OK; i++) {
    slopes[i] = ask->numbers[i].of == DEA_NUMBER_OF_SUPPLY ? NAN : slopes[i];
  }
  free_changes(ask, &all);
  return DEA_CHAIN(ctx, status);
}
