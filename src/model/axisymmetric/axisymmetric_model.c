/* Model "axisymmetric" behind the common interface. */
#include "model/axisymmetric/disc.h"
#include "model/equilibrium_path.h"
#include "model/make.h"

#include <math.h>
#include <stdio.h>

enum {
  ORDER_OUTER = 14,
  PROFILE_ACTIVE = 31,  // samples over the electrode, both ends
  PROFILE_PASSIVE = 90, // from the electrode edge (again) to the frame
  PROFILE_COUNT = PROFILE_ACTIVE + PROFILE_PASSIVE,
  PROFILE_COLUMNS = 7,
};

struct dea_model {
  struct dea_path *path;    // first
  struct dea_device device; // the disc, also of a layout that is one
  struct dea_disc disc;
  double rest_energy; // in the disc's unit
  double profile[PROFILE_COLUMNS][PROFILE_COUNT];
};

static dea_status evaluate(void *self, const double *u, double voltage_V, double *g, double *K,
                           double *gV)
{
  const struct dea_model *model = self;
  return dea_disc_evaluate(&model->disc, u, voltage_V, g, K, gV);
}

/* Stretches and tensions at one place. */
struct sample {
  double stretch_r, stretch_t, displacement_m, tension_r_N_per_m, tension_t_N_per_m;
};

static dea_status sample(const struct dea_disc *disc, const double *u, double voltage_V, size_t e,
                         double R, struct sample *out)
{
  struct dea_plane plane;
  double field = voltage_V / disc->film.thickness_m;
  dea_disc_stretch(disc, u, e, R, &out->stretch_r, &out->stretch_t, &out->displacement_m);
  DEA_TRY_STATUS(dea_film_eval(&disc->film, disc->element[e].active, field, out->stretch_r,
                               out->stretch_t, &plane));
  dea_film_tension(&disc->film, &plane, out->stretch_r, out->stretch_t, &out->tension_r_N_per_m,
                   &out->tension_t_N_per_m);
  return DEA_OK;
}

/* Extremes over the nodes, which include the centre, both sides of the electrode edge and the
 * frame. */
static dea_status find_extremes(const struct dea_disc *disc, const double *u, double voltage_V,
                                struct dea_load_point *out)
{
  double field = voltage_V / disc->film.thickness_m;
  struct dea_reach reach = {NAN, NAN};
  out->min_tension_N_per_m = INFINITY;
  out->breakdown_margin = INFINITY;
  out->true_field_V_per_m = 0;
  for (size_t e = 0; e < disc->element_count; e++) {
    for (size_t j = 0; j <= disc->element[e].order; j++) {
      struct sample at;
      DEA_TRY_STATUS(sample(disc, u, voltage_V, e, disc->element[e].node_R[j], &at));
      out->min_tension_N_per_m =
          fmin(out->min_tension_N_per_m, fmin(at.tension_r_N_per_m, at.tension_t_N_per_m));
      dea_reach_merge(&reach, dea_material_reach(disc->film.material, at.stretch_r, at.stretch_t));
      if (disc->element[e].active) {
        double area = at.stretch_r * at.stretch_t;
        out->true_field_V_per_m = fmax(out->true_field_V_per_m, field * area);
        out->breakdown_margin =
            fmin(out->breakdown_margin,
                 dea_film_breakdown_margin(&disc->film, field, at.stretch_r, at.stretch_t));
      }
    }
  }
  out->locking_share = reach.locking_share;
  out->range_share = reach.range_share;
  if (isinf(out->breakdown_margin)) { // fmin passes over what is unknown
    out->breakdown_margin = NAN;
  }
  out->breakdown_probability =
      dea_breakdown_probability(&disc->film.material->breakdown, out->breakdown_margin);
  return DEA_OK;
}

/* Energy unit of the disc: 2 pi h a^2 mu [J]. */
static double energy_unit_J(const struct dea_disc *disc, double thickness_m)
{
  double a = disc->electrode_radius_m;
  return 2 * DEA_PI * thickness_m * a * a * dea_film_modulus(&disc->film);
}

static dea_status point(void *self, const double *u, double voltage_V, struct dea_load_point *out)
{
  const struct dea_model *model = self;
  const struct dea_disc *disc = &model->disc;
  double a = disc->electrode_radius_m, b = disc->frame_radius_m, energy;
  double edge_u_m = a * u[dea_disc_edge(disc)];
  *out = dea_load_point_empty();
  DEA_TRY_STATUS(find_extremes(disc, u, voltage_V, out));
  DEA_TRY_STATUS(dea_disc_totals(disc, u, voltage_V, &energy, &out->capacitance_F));
  out->own_flags = (unsigned)(model->device.fibre_count > 0) << DEA_FLAG_PLAIN;
  out->voltage_V = voltage_V;
  out->electrode_stretch = 1 + edge_u_m / a;
  out->passive_stretch = 1 - edge_u_m / (b - a); // mean of the radial one
  out->electrode_edge_u_m = edge_u_m;
  out->nominal_field_V_per_m = voltage_V / disc->film.thickness_m;
  out->energy_J =
      (energy - model->rest_energy) * energy_unit_J(disc, model->device.film_thickness_m);
  return DEA_OK;
}

static dea_status prepare(struct dea_context *ctx, const struct dea_device *of,
                          const struct dea_model_settings *settings, struct dea_model *model)
{
  const struct dea_device *device = &model->device;
  (void)settings; // of a mesh, which this model has not
  DEA_TRY(ctx, dea_device_require_disc(ctx, of));
  model->device = *of;
  static const double rest[DEA_PATH_UNKNOWNS_MAX] = {0};
  DEA_TRY(ctx, dea_disc_create(ctx, device, ORDER_OUTER, &model->disc));
  DEA_TRY(ctx, dea_film_report_weight(ctx, device, "axisymmetric"));
  const struct dea_path_system system = {
      .unknowns = dea_disc_unknowns(&model->disc),
      .self = model,
      .evaluate = evaluate,
      .point = point,
      .voltage_scale_V = dea_film_voltage_scale(&model->disc.film),
      .ramped = model->disc.film.electrode != NULL ? &model->disc.film.electrode_ratio : NULL,
      .pre_stretch = device->pre_stretch,
      .end_stretch = 10,
      .model = "axisymmetric",
  };
  DEA_TRY(ctx, dea_path_create(ctx, &system, rest, &model->path));
  struct dea_load_point at_rest;
  DEA_TRY(ctx, dea_path_point(ctx, model->path, &at_rest));
  model->rest_energy = at_rest.energy_J / energy_unit_J(&model->disc, device->film_thickness_m);
  return DEA_OK;
}

/* A film with a direction, at its place in the design. */
static dea_status check(struct dea_context *ctx, const struct dea_design *design,
                        const struct dea_device *device)
{
  bool named = design->film.law.origin != DEA_ABSENT && design->film.law.origin != DEA_DEFAULT;
  char why[300];
  if (device->film.law == NULL || !device->film.law->anisotropic ||
      dea_disc_check(ctx, device) == DEA_OK) {
    return DEA_OK;
  }
  snprintf(why, sizeof why, "%s", dea_context_message(ctx));
  dea_context_clear(ctx);
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR,
                               named ? design->film.law.location : design->film.material.location,
                               "model axisymmetric: %s", why));
  return dea_fail(ctx, DEA_E_DESIGN, "%s", why);
}

static dea_status create(struct dea_context *ctx, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  return DEA_CHAIN(ctx, dea_model_build(ctx, sizeof **out, device, settings, prepare,
                                        dea_path_model_destroy, out));
}

/* Element that holds R; at the electrode edge the one outside. */
static size_t element_at(const struct dea_disc *disc, double R)
{
  size_t e = disc->element_count - 1;
  while (e > 1 && R < disc->element[e].node_R[0]) {
    e--;
  }
  return e;
}

static dea_status profile(struct dea_context *ctx, struct dea_model *model, struct dea_profile *out)
{
  const struct dea_disc *disc = &model->disc;
  const struct dea_path_state *state = dea_path_state_get(model->path);
  double a = disc->electrode_radius_m, b = disc->frame_radius_m;
  for (size_t i = 0; i < PROFILE_COUNT; i++) {
    size_t j = i < PROFILE_ACTIVE ? i : i - PROFILE_ACTIVE;
    double R = i < PROFILE_ACTIVE ? a * (double)j / (PROFILE_ACTIVE - 1)
                                  : a + (b - a) * (double)j / (PROFILE_PASSIVE - 1);
    struct sample at;
    dea_status status = sample(disc, state->u, state->voltage_V,
                               i < PROFILE_ACTIVE ? 0 : element_at(disc, R), R, &at);
    if (status != DEA_OK) {
      return dea_fail(ctx, status, "profile at radius %g mm: %s", 1e3 * R,
                      dea_status_message(status));
    }
    model->profile[0][i] = R;
    model->profile[1][i] = at.displacement_m;
    model->profile[2][i] = at.stretch_r;
    model->profile[3][i] = at.stretch_t;
    model->profile[4][i] = at.tension_r_N_per_m;
    model->profile[5][i] = at.tension_t_N_per_m;
    model->profile[6][i] = 0; // it stays flat
  }
  *out = (struct dea_profile){PROFILE_COUNT,     model->profile[0], model->profile[1],
                              model->profile[2], model->profile[3], model->profile[4],
                              model->profile[5], model->profile[6]};
  return DEA_OK;
}

const struct dea_model_type dea_model_axisymmetric = {
    .name = "axisymmetric",
    .long_name = "axisymmetric disc in a ring (exact)",
    .create = create,
    .destroy = dea_path_model_destroy,
    .check = check,
    .solve = dea_path_solve,
    .limit = dea_path_limit,
    .passed = dea_path_passed,
    .path = dea_path_trace,
    .profile = profile,
};
