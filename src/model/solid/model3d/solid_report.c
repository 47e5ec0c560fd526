/* Points of the model "3d", and what it notes and does where it has arrived at one. */
#include "model/solid/assembly/charge_control.h"
#include "model/solid/assembly/film_state.h"
#include "model/solid/model3d/solid_model.h"
#include "result/columns.h"

#include <math.h>

/* The next one from *n on: of a disc's film each node; else the middle between the lowest and the
 * highest face of a place, as the faces of a flat film move as it thins, which is no bending. Nodes
 * above each other have consecutive numbers. false: there is no more. */
static bool next_place(const struct dea_model *model, size_t *n, struct dea_model_place *out)
{
  const double *u = dea_solid_displacement(model->solid), *X = model->mesh.grid->X;
  const int *column = model->mesh.grid->column;
  while (model->disc && *n < model->mesh_node_count &&
         !dea_film_band_has(&model->band, X[3 * *n + 2])) {
    ++*n;
  }
  if (*n >= model->mesh_node_count) {
    return false;
  }
  size_t low = *n, high = *n, of = *n;
  for (++*n; !model->disc && *n < model->mesh_node_count && column[*n] == column[of]; ++*n) {
    low = X[3 * *n + 2] < X[3 * low + 2] ? *n : low;
    high = X[3 * *n + 2] > X[3 * high + 2] ? *n : high;
  }
  *out = (struct dea_model_place){{low, high}, 0.5 * (u[3 * low + 2] + u[3 * high + 2])};
  return true;
}

/* The highest one with sign 1, the lowest with -1. */
struct dea_model_place dea_solid_model_height(const struct dea_model *model, double sign)
{
  struct dea_model_place here, out = {{0, 0}, -sign * INFINITY};
  for (size_t n = 0; next_place(model, &n, &here);) {
    out = sign * here.z_m > sign * out.z_m ? here : out;
  }
  return out;
}

/* Of a disc; NAN of what is none. */
double dea_solid_model_centre_z(const struct dea_model *model, const double *u)
{
  return dea_observer_column(model->observer, dea_point_column_find("centre_z_m"), u);
}

/* What of a point the displacements say by themselves. */
void dea_solid_model_describe(const struct dea_model *model, double voltage_V,
                              struct dea_load_point *out)
{
  *out = dea_load_point_empty();
  out->voltage_V = voltage_V;
  out->highest_z_m = dea_solid_model_height(model, 1).z_m;
  out->lowest_z_m = dea_solid_model_height(model, -1).z_m;
  out->nominal_field_V_per_m = voltage_V / model->plies.thinnest_m;
  out->energy_J = model->copies * (model->at.report.energy_J - model->at.rest_energy_J);
  dea_observer_describe(model->observer, dea_solid_displacement(model->solid), out);
  if (model->indent != NULL) {
    out->tip_depth_m = model->indent->depth_m;
    out->force_N = dea_indent_force(model->indent, dea_solid_displacement(model->solid));
  }
}

dea_status dea_solid_model_report(struct dea_context *ctx, struct dea_model *model,
                                  double voltage_V, struct dea_load_point *out)
{
  struct dea_solid_extremes extremes;
  double capacitance_F;
  const bool charged =
      dea_charge_is_held(model->solid) && dea_charge_now(model->solid).channel == 0;
  dea_status status = dea_solid_extremes(model->solid, model->plies.films, &extremes);
  status =
      status == DEA_OK ? dea_solid_capacitance(ctx, model->solid, false, &capacitance_F) : status;
  if (status != DEA_OK) {
    return dea_fail(ctx, status, "the film cannot be evaluated at %g V", voltage_V);
  }
  if (charged) {
    voltage_V += dea_charge_now(model->solid).lift_V;
    capacitance_F = dea_charge_now(model->solid).capacitance_F;
  }
  dea_solid_model_describe(model, voltage_V, out);
  out->true_field_V_per_m = extremes.true_field_V_per_m;
  out->breakdown_margin = extremes.breakdown_margin;
  out->breakdown_probability = extremes.breakdown_probability;
  out->min_tension_N_per_m =
      isinf(extremes.min_tension_N_per_m) ? NAN : extremes.min_tension_N_per_m; // without a film
  out->locking_share = extremes.reach.locking_share;
  out->range_share = extremes.reach.range_share;
  out->compression_ratio = model->copies * extremes.compression_ratio;
  out->own_flags |= (unsigned)model->at.left_a_state << DEA_FLAG_STATES;
  out->own_flags |= (unsigned)model->mesh.membrane << DEA_FLAG_PREVIEW;
  out->capacitance_F = model->copies * capacitance_F;
  out->unstable_modes = model->at.report.unstable_modes;
  out->stable = out->unstable_modes == 0;
  return DEA_CHAIN(ctx, dea_observer_errors(ctx, model->observer, model->solid, out));
}

/* Whether it is back where it was released, to a thousandth of the film's thickness. */
static bool is_at_rest(const struct dea_model *model)
{
  const double *u = dea_solid_displacement(model->solid);
  double most = 0;
  for (size_t i = 0; i < 3 * model->mesh.grid->node_count; i++) {
    most = fmax(most, fabs(u[i] - model->rest[i]));
  }
  return model->at.voltage_V == 0 &&
         most <= 1e-3 * model->layout->plies[model->plies.film].thickness_m;
}

/* Another state was left on the way; what is back at rest has nothing of that. */
void dea_solid_model_note_states(struct dea_model *model, bool left)
{
  model->at.left_a_state =
      is_at_rest(model) ? model->rest_is_one_of : model->at.left_a_state || left;
}

/* Height that tells the side that the film is on. */
static double middle_z(const struct dea_model *model)
{
  const double centre_m = dea_solid_model_centre_z(model, dea_solid_displacement(model->solid));
  const double high_m = dea_solid_model_height(model, 1).z_m,
               low_m = dea_solid_model_height(model, -1).z_m;
  return !isnan(centre_m) ? centre_m : (fabs(high_m) > fabs(low_m) ? high_m : low_m);
}

/* To the side that the design asks for, where there is a state. */
static dea_status set_side(struct dea_context *ctx, struct dea_model *model)
{
  bool moved;
  double before_m = middle_z(model);
  if (model->indent != NULL || model->at.voltage_V == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx,
          dea_buckling_branch_select(ctx, model->solid, model->mesh.grid, &model->band,
                                     model->settings.buckling_branch, &model->at.report, &moved));
  if (moved) {
    model->at.left_a_state = true;
    DEA_TRY(ctx,
            dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                            "model 3d: at %.4g kV the centre goes over from %.4g to %.4g um "
                            "(compute.solid.buckling_branch)",
                            1e-3 * model->at.voltage_V, 1e6 * before_m, 1e6 * middle_z(model)));
  }
  return DEA_OK;
}

dea_status dea_solid_model_arrived(struct dea_context *ctx, struct dea_model *model,
                                   double voltage_V)
{
  model->at.voltage_V = voltage_V;
  dea_solid_model_note_states(model, model->at.report.snapped);
  DEA_TRY(ctx, dea_solid_contacts_check(ctx, model));
  return DEA_CHAIN(ctx, set_side(ctx, model));
}
