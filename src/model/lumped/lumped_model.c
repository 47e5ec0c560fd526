/* Model "lumped" behind the common interface. */
#include "model/equilibrium_path.h"
#include "model/lumped/lumped.h"
#include "model/lumped/motion.h"
#include "model/make.h"

#include <math.h>

struct dea_model {
  struct dea_path *path;    // first
  struct dea_device device; // the disc, also of a layout that is one
  struct dea_lumped lumped;
  struct dea_lift lift;
  double modulus_Pa, rest_energy_Pa;
  struct dea_lumped_motion motion;
};

static double disc_volume_m3(const struct dea_model *model)
{
  double r_a = model->device.electrode_radius_m;
  return DEA_PI * r_a * r_a * model->device.film_thickness_m;
}

/* Pi/(mu times the electrode disc's volume): g = 2 l_pre (s_A - s_P)/mu. */
static dea_status evaluate(void *self, const double *u, double voltage_V, double *g, double *K,
                           double *gV)
{
  const struct dea_model *model = self;
  struct dea_lumped_balance balance;
  double H0 = model->lumped.film.thickness_m;
  DEA_TRY_STATUS(dea_lumped_balance_eval(&model->lumped, u[0], voltage_V / H0, &balance));
  double factor = 2 * model->lumped.pre_stretch / model->modulus_Pa;
  g[0] = factor * balance.imbalance_Pa;
  K[0] = factor * balance.slope_Pa;
  gV[0] = factor * balance.slope_field_Pa_m_per_V / H0;
  return DEA_OK;
}

static double smallest_tension(const struct dea_film *film, const struct dea_plane *plane, double l)
{
  double t1, t2;
  dea_film_tension(film, plane, l, l, &t1, &t2);
  return fmin(t1, t2);
}

static dea_status add_lift(const struct dea_model *model, const struct dea_lumped *lumped,
                           double field, struct dea_load_point *out)
{
  double z = dea_lift_height(&model->lift, out->electrode_stretch), where;
  out->own_flags |= 1u << DEA_FLAG_BOUND | 1u << DEA_FLAG_PLAIN;
  out->fibre_tip_z_m = out->centre_z_m = z;
  if (z > 0) {
    return dea_lift_force_max(lumped, &model->lift, field, z, &out->force_N, &where);
  }
  out->force_N = isnan(z) ? NAN : 0;
  return DEA_OK;
}

/* lumped: the model's, or with the branches of a moment. */
static dea_status fill_point(const struct dea_model *model, const struct dea_lumped *lumped,
                             double l_a, double voltage_V, struct dea_load_point *out)
{
  const struct dea_film *film = &lumped->film;
  double field = voltage_V / film->thickness_m, l_pre = lumped->pre_stretch;
  struct dea_lumped_balance balance;
  DEA_TRY_STATUS(dea_lumped_balance_eval(lumped, l_a, field, &balance));
  double l_A = l_a * l_pre, l_P = balance.passive_stretch * l_pre;
  *out = dea_load_point_empty();
  out->voltage_V = voltage_V;
  out->electrode_stretch = l_a;
  out->passive_stretch = balance.passive_stretch;
  out->electrode_edge_u_m = (l_a - 1) * model->device.electrode_radius_m; // paper eq 18
  out->nominal_field_V_per_m = field;
  out->true_field_V_per_m = field * l_A * l_A; // paper eq 4
  out->breakdown_margin = dea_film_breakdown_margin(film, field, l_A, l_A);
  out->breakdown_probability =
      dea_breakdown_probability(&film->material->breakdown, out->breakdown_margin);
  out->min_tension_N_per_m = fmin(smallest_tension(film, &balance.active, l_A),
                                  smallest_tension(film, &balance.passive, l_P));
  struct dea_reach reach = dea_material_reach(film->material, l_A, l_A);
  dea_reach_merge(&reach, dea_material_reach(film->material, l_P, l_P));
  out->locking_share = reach.locking_share;
  out->range_share = reach.range_share;
  out->energy_J = (balance.energy_Pa - model->rest_energy_Pa) * disc_volume_m3(model);
  out->capacitance_F = dea_film_capacitance(film, disc_volume_m3(model), l_A, l_A);
  return model->device.fibre_count > 0 ? add_lift(model, lumped, field, out) : DEA_OK;
}

static dea_status point(void *self, const double *u, double voltage_V, struct dea_load_point *out)
{
  const struct dea_model *model = self;
  return fill_point(model, &model->lumped, u[0], voltage_V, out);
}

static dea_status prepare(struct dea_context *ctx, const struct dea_device *of,
                          const struct dea_model_settings *settings, struct dea_model *model)
{
  const struct dea_device *device = &model->device;
  (void)settings; // of a mesh, which this model has not
  DEA_TRY(ctx, dea_device_require_disc(ctx, of));
  model->device = *of;
  DEA_TRY(ctx, dea_film_create(ctx, device, &model->lumped.film));
  model->lumped.pre_stretch = device->pre_stretch;
  model->lumped.coverage = device->coverage;
  model->lumped.electrode_radius_m = device->electrode_radius_m;
  model->lift = dea_lift_create(device);
  if (device->fibre_count > 0) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                 "z and force of model lumped are those of rigid, hinged rods "
                                 "without the film between them (paper eqs 18-20): upper bounds, "
                                 "far above a pre-stretched film's, and without a sign"));
  }
  DEA_TRY(ctx, dea_film_report_weight(ctx, device, "lumped"));
  model->modulus_Pa = dea_film_modulus(&model->lumped.film);
  struct dea_lumped_balance rest;
  dea_status status = dea_lumped_balance_eval(&model->lumped, 1, 0, &rest);
  if (status != DEA_OK) {
    return dea_fail(ctx, status, "the film's law ends before the pre-stretch of %g",
                    device->pre_stretch);
  }
  model->rest_energy_Pa = rest.energy_Pa;
  const struct dea_path_system system = {
      .unknowns = 1,
      .self = model,
      .evaluate = evaluate,
      .point = point,
      .voltage_scale_V = dea_film_voltage_scale(&model->lumped.film),
      .ramped = model->lumped.film.electrode != NULL ? &model->lumped.film.electrode_ratio : NULL,
      .pre_stretch = device->pre_stretch,
      .end_stretch = fmin(10, 1 / device->coverage),
      .model = "lumped",
  };
  static const double start = 1;
  return DEA_CHAIN(ctx, dea_path_create(ctx, &system, &start, &model->path));
}

static dea_status create(struct dea_context *ctx, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  return DEA_CHAIN(ctx, dea_model_build(ctx, sizeof **out, device, settings, prepare,
                                        dea_path_model_destroy, out));
}

static dea_status hold(struct dea_context *ctx, const struct dea_model *model, double voltage_V,
                       double height_m, double *force_N)
{
  if (model->device.fibre_count == 0) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "there are no fibres to hold");
  }
  double field = voltage_V / model->lumped.film.thickness_m;
  dea_status status = dea_lift_force(&model->lumped, &model->lift, field, height_m, force_N);
  return status == DEA_OK ? status
                          : dea_fail(ctx, status, "a height of %.4g mm is beyond the film's law",
                                     1e3 * height_m);
}

/* The point of a moment: that of its stretch and voltage, and what only time has. */
static dea_status moment_point(const struct dea_model *model, const struct dea_lumped_state *moment,
                               struct dea_load_point *out)
{
  const struct dea_circuit_state *circuit = &moment->circuit;
  double rate = moment->rate_per_s;
  const struct dea_lumped frozen = dea_lumped_frozen(&model->motion, moment);
  dea_status status =
      fill_point(model, &frozen, moment->electrode_stretch, circuit->voltage_V, out);
  out->time_s = moment->time_s;
  out->source_voltage_V = circuit->source_voltage_V;
  out->charge_C = circuit->charge_C;
  out->current_A = circuit->current_A;
  // that of the branches as it is, not as the step had it
  out->stored_energy_J = moment->stored_energy_J - model->rest_energy_Pa * disc_volume_m3(model);
  out->energy_J = out->stored_energy_J - circuit->charge_C * circuit->voltage_V;
  if (model->motion.options.inertia) {
    out->kinetic_energy_J = 0.5 * model->motion.mass_kg_m2 * rate * rate;
  }
  out->dissipated_J = moment->branch_loss_J + circuit->resistance_loss_J + circuit->leakage_loss_J;
  out->supply_work_J = circuit->supply_work_J;
  return status;
}

static dea_status begin(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_time_options *options, struct dea_load_point *out)
{
  struct dea_load_point last;
  struct dea_lumped_motion *motion = &model->motion;
  DEA_TRY(ctx, dea_path_point(ctx, model->path, &last));
  *motion = (struct dea_lumped_motion){
      .lumped = model->lumped,
      .options = *options,
      .volume_m3 = disc_volume_m3(model),
      .mass_kg_m2 = dea_lumped_mass(&model->device),
  };
  if (options->inertia && !(model->device.film.density_kg_per_m3 > 0)) {
    return dea_fail(ctx, DEA_E_DESIGN, "inertia needs the density of '%s', which is unknown",
                    model->device.film.name);
  }
  if (fmax(model->device.sheet_resistance_ohm[0], model->device.sheet_resistance_ohm[1]) > 0) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                                 "model lumped has ideal electrodes: only model 3d knows their "
                                 "sheet_resistance"));
  }
  dea_status status = dea_lumped_begin(motion, last.electrode_stretch, last.voltage_V);
  status = status == DEA_OK ? moment_point(model, &motion->now, out) : status;
  return status == DEA_OK ? status
                          : dea_fail(ctx, status, "the last state lies beyond the film's law");
}

static dea_status advance(struct dea_context *ctx, struct dea_model *model,
                          const struct dea_time_step *step, struct dea_load_point *out,
                          double *error)
{
  struct dea_lumped_motion *motion = &model->motion;
  dea_status status = dea_lumped_advance(motion, step, error);
  status = status == DEA_OK ? moment_point(model, &motion->trial, out) : status;
  if (status == DEA_OK) {
    return DEA_OK;
  }
  double end_s = motion->now.time_s + step->length_s;
  return status == DEA_E_NO_EQUILIBRIUM
             ? dea_fail(ctx, status, "no equilibrium near the last one at %.6g s", end_s)
             : dea_fail(ctx, status, "no solution at %.6g s", end_s);
}

static void accept(struct dea_model *model)
{
  dea_lumped_accept(&model->motion);
}

const struct dea_model_type dea_model_lumped = {
    .name = "lumped",
    .long_name = "lumped (paper eqs 15-20)",
    .create = create,
    .destroy = dea_path_model_destroy,
    .solve = dea_path_solve,
    .limit = dea_path_limit,
    .passed = dea_path_passed,
    .path = dea_path_trace,
    .hold = hold,
    .begin = begin,
    .advance = advance,
    .accept = accept,
};
