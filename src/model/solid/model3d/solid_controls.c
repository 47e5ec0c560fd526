/* Controls beside the voltage of the model "3d": bodies and pressures that are moved. */
#include "model/solid/assembly/charge_control.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/model3d/solid_model.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static dea_status check_control(struct dea_context *ctx, const struct dea_model *model,
                                const struct dea_control *control, double value)
{
  static const char *const names[] = {[DEA_CONTROL_PLACE] = "control",
                                      [DEA_CONTROL_FORCE] = "control",
                                      [DEA_CONTROL_PRESSURE] = "control",
                                      [DEA_CONTROL_CONJUGATE] = "force",
                                      [DEA_CONTROL_CHARGE] = "charge"};
  const struct dea_layout *l = model->layout;
  const bool body = control->kind == DEA_CONTROL_PLACE || control->kind == DEA_CONTROL_FORCE,
             pressure = control->kind == DEA_CONTROL_PRESSURE;
  if ((pressure && l->pressure_count == 0) ||
      (body &&
       (control->body >= l->body_count || control->component < 0 || control->component > 5))) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the device has no such %s to be moved",
                    pressure ? "pressure" : "body");
  }
  if (body && ((dea_layout_sector_keeps(&model->mesh.sector) >> control->component) & 1) == 0) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "a sector of the device cannot show this motion, which breaks its symmetry "
                    "(compute.solid.domain: whole)");
  }
  return isfinite(value)
             ? DEA_OK
             : dea_fail(ctx, DEA_E_ARGUMENT, "a %s has to be a number", names[control->kind]);
}

static double where_control_is(const struct dea_model *model, const struct dea_control *control)
{
  double place[6];
  if (control->kind == DEA_CONTROL_PRESSURE) {
    return model->pressure_factor;
  }
  if (control->kind == DEA_CONTROL_CHARGE) { // at first of a film at 0 V
    return dea_charge_is_held(model->solid) ? model->copies * dea_charge_now(model->solid).charge_C
                                            : 0;
  }
  if (control->kind == DEA_CONTROL_CONJUGATE) {
    return model->pull.force;
  }
  dea_solid_body_place(model->solid, control->body, place, place + 3);
  return control->kind == DEA_CONTROL_PLACE ? place[control->component]
                                            : model->push[control->body][control->component];
}

dea_status dea_solid_model_find_coordinate(struct dea_context *ctx, struct dea_model *model,
                                           const struct dea_control *control)
{
  struct dea_model_pull *pull = &model->pull;
  const struct dea_control *old = &pull->coordinate;
  const size_t dofs = model->solid->problem.dofs;
  if (pull->slope != NULL && old->column == control->column && old->body == control->body &&
      old->component == control->component) {
    return DEA_OK;
  }
  if (pull->slope == NULL) {
    pull->slope = dea_arena_alloc(&model->memory, dofs, sizeof *pull->slope);
    DEA_TRY(ctx, dea_arena_status(&model->memory));
  }
  memset(pull->slope, 0, dofs * sizeof *pull->slope);
  pull->coordinate = *control;
  const bool known =
      control->column != 0
          ? dea_observer_column_gradient(model->observer, model->solid, control->column,
                                         pull->slope)
          : control->body < model->layout->monitor_count &&
                control->component <= DEA_OBSERVED_OUTWARDS &&
                dea_observer_gradient(model->observer, model->solid, control->body,
                                      (enum dea_observed)control->component, pull->slope);
  if (!known) {
    pull->coordinate.component = -1; // asked for again it is no better
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "a coordinate has to be a displacement of a point, a body or a shape, or a "
                    "turn of a body");
  }
  return DEA_OK;
}

/* A force along one coordinate goes where another one is asked for. */
static dea_status set_conjugate(struct dea_context *ctx, struct dea_model *model,
                                const struct dea_control *control, double value)
{
  double *force = dea_solid_force(model->solid), *slope = model->pull.slope;
  for (size_t i = 0; slope != NULL && i < model->solid->problem.dofs; i++) {
    force[i] -= model->pull.force / model->copies * slope[i];
  }
  model->pull.force = 0;
  DEA_TRY(ctx, dea_solid_model_find_coordinate(ctx, model, control));
  slope = model->pull.slope;
  for (size_t i = 0; i < model->solid->problem.dofs; i++) {
    force[i] += value / model->copies * slope[i];
  }
  model->pull.force = value;
  return DEA_OK;
}

/* What the next solve goes to, of a control that was checked. */
static dea_status set_control(struct dea_context *ctx, struct dea_model *model,
                              const struct dea_control *control, double value)
{
  size_t body = control->body;
  double place[6] = {0};
  switch (control->kind) {
  case DEA_CONTROL_PLACE:
    place[control->component] = value;
    model->controls[body].place |= 1 << control->component;
    DEA_TRY(ctx, dea_solid_body_prescribe(ctx, model->solid, body, 1 << control->component, place,
                                          place + 3));
    break;
  case DEA_CONTROL_FORCE:
    model->push[body][control->component] = value;
    model->controls[body].force |= 1 << control->component;
    dea_solid_body_load(model, body, model->push[body]);
    break;
  case DEA_CONTROL_PRESSURE:
    model->pressure_factor = value;
    dea_solid_pressures_set(model, value);
    break;
  case DEA_CONTROL_CHARGE:
    DEA_TRY(ctx, dea_charge_hold(ctx, model->solid, control->body, value / model->copies));
    break;
  case DEA_CONTROL_CONJUGATE:
    DEA_TRY(ctx, set_conjugate(ctx, model, control, value));
    break;
  }
  return DEA_OK;
}

dea_status dea_solid_model_set_control(struct dea_context *ctx, struct dea_model *model,
                                       const struct dea_control *control, double value)
{
  DEA_TRY(ctx, check_control(ctx, model, control, value));
  return DEA_CHAIN(ctx, set_control(ctx, model, control, value));
}

/* How a limit point of a control is named and given, by its kind and whether it turns. */
static const struct {
  const char *name, *unit;
  double scale;
} limits[][2] = {
    [DEA_CONTROL_PLACE] = {{"limit point", "mm", 1e3}, {"limit point", "rad", 1}},
    [DEA_CONTROL_FORCE] = {{"force limit", "mN", 1e3}, {"moment limit", "mN m", 1e3}},
    [DEA_CONTROL_PRESSURE] = {{"pressure limit", "kPa", 1e-3}, {"pressure limit", "kPa", 1e-3}},
    [DEA_CONTROL_CONJUGATE] = {{"force limit", "mN", 1e3}, {"moment limit", "mN m", 1e3}},
    [DEA_CONTROL_CHARGE] = {{"charge limit", "uC", 1e6}, {"charge limit", "uC", 1e6}},
};

/* That it has gone past a limit point of the control, where it has moved to what that was set to.
 */
static dea_status report_passed(struct dea_context *ctx, struct dea_model *model,
                                const struct dea_control *control, double limit)
{
  const bool force = control->kind == DEA_CONTROL_FORCE || control->kind == DEA_CONTROL_CONJUGATE,
             turns = control->component >= 3;
  model->at.outcome.passed.point.force_N = force && !turns ? limit : NAN;
  return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                         "model 3d: at %.4g kV it snaps past a limit point at %.6g %s to another "
                         "state",
                         1e-3 * model->at.voltage_V,
                         force ? limits[control->kind][turns].scale * limit : limit,
                         force ? limits[control->kind][turns].unit : "of the control");
}

/* A limit point of the control at a value. */
static dea_status fail_at_limit(struct dea_context *ctx, const struct dea_model *model,
                                const struct dea_control *control, double value)
{
  const bool turns = control->component >= 3;
  double scale = limits[control->kind][turns].scale, largest_Pa = 0;
  for (size_t i = 0; i < model->layout->pressure_count; i++) {
    largest_Pa = fmax(largest_Pa, fabs(model->layout->pressures[i].pressure_Pa));
  }
  scale *= control->kind == DEA_CONTROL_PRESSURE ? largest_Pa : 1;
  return dea_fail(ctx, DEA_E_NO_EQUILIBRIUM,
                  "%s at %.5g %s and %.4g kV: beyond it there is no stable equilibrium",
                  limits[control->kind][turns].name, scale * value,
                  limits[control->kind][turns].unit, 1e-3 * model->at.voltage_V);
}

dea_status dea_solid_model_move(struct dea_context *ctx, struct dea_model *model,
                                const struct dea_control *control, double value,
                                struct dea_load_point *out)
{
  char why[200];
  double fraction;
  DEA_TRY(ctx, check_control(ctx, model, control, value));
  dea_solid_model_end_history(ctx, model);
  double from = where_control_is(model, control);
  DEA_TRY(ctx, set_control(ctx, model, control, value));
  dea_status status = dea_step_outcome_move(ctx, &model->at.outcome, &model->at.report, &fraction);
  const double limit = from + fraction * (value - from);
  if (status != DEA_OK) {
    double reached = from + model->at.report.load_factor * (value - from);
    snprintf(why, sizeof why, "%s", dea_context_message(ctx));
    DEA_TRY(ctx, set_control(ctx, model, control, reached));
    if (status == DEA_E_NO_EQUILIBRIUM) {
      return fail_at_limit(ctx, model, control, limit);
    }
    return dea_fail(ctx, status, "stopped %.3g of the way to the next value (%s)",
                    model->at.report.load_factor, why);
  }
  dea_solid_model_note_states(model, model->at.report.snapped);
  if (!isnan(fraction)) {
    DEA_TRY(ctx, report_passed(ctx, model, control, limit));
  } else if (model->at.report.snapped) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                 "model 3d: a state at %.4g kV is unstable (buckling or snapping) "
                                 "under this load; it goes on from the stable one below it",
                                 1e-3 * model->at.voltage_V));
  }
  return DEA_CHAIN(ctx, dea_solid_model_report(ctx, model, model->at.voltage_V, out));
}
