/* Model "3d" behind the common interface: a quarter of the actuator as a solid. It is the whole of
 * the loadable module that model/solid_module.c opens. */
#include "model/film.h"
#include "model/make.h"
#include "model/solid/solve/fields.h"
#include "model/solid/solve/state.h"

#include <math.h>
#include <stdio.h>

/* Preview mesh: elements an eighth of the electrode's edge, across half a fibre, and the width of
 * those at the edge over its radius (docs/theory/solid.md has what a finer one gives). */
enum { FINE = 3, ACROSS = 2 };
static const double edge_share = 0.05;

static const double field_step_V_per_m = 10e6; // a longer way is gone in such steps of V/H0
static const double kappa_share = 100;         // kappa over the shear modulus

struct dea_model {
  const struct dea_device *device;
  struct dea_layer layers[2];
  struct dea_grid *grid;
  struct dea_solid *solid;
  size_t tip, centre, between; // nodes that are reported
  double voltage_V, rest_energy_J;
  struct dea_solid_report report;
};

static int layer_of(const void *self, int region, int sheet)
{
  (void)self;
  (void)region;
  return sheet;
}

static bool active(const void *self, int region, int sheet)
{
  (void)self;
  return region == DEA_REGION_ELECTRODE && sheet == DEA_SHEET_FILM;
}

/* The frame holds everything at its edge; x = 0 and y = 0 are planes of symmetry. */
static int held(const void *self, const double X[3])
{
  const struct dea_device *device = self;
  double close = 1e-9 * device->frame_radius_m;
  if (hypot(X[0], X[1]) > device->frame_radius_m - close) {
    return 1 | 2 | 4;
  }
  return (X[0] < close ? 1 : 0) | (X[1] < close ? 2 : 0);
}

/* What this version can do, said before anything is computed. */
static dea_status check(struct dea_context *ctx, const struct dea_device *d)
{
  const char *lacking = NULL;
  if (d->fibre_count != 0 && d->fibre_count != 4 && d->fibre_count != 8) {
    lacking = "four or eight fibres or none (fibres.count)";
  } else if (d->fibre_count > 0 && fabs(d->fibre_overlap_m) > 1e-6 * d->electrode_radius_m) {
    lacking = "fibre tips at the electrode edge (fibres.overlap: 0 mm stretched)";
  } else if (d->fibre_count > 0 && d->outer_end != DEA_END_CLAMPED) {
    lacking = "clamped fibres (fibres.outer_end: clamped)";
  } else if (d->bond_thickness_m > 0) {
    lacking = "fibres without a layer of glue (fibres.bond.thickness: 0 um)";
  } else if (d->electrode_thickness_m > 0) {
    lacking = "electrodes without stiffness (electrodes.thickness: 0 um)";
  } else if (d->film.law->anisotropic) {
    lacking = "isotropic films";
  } else if (d->film.permittivity.slope != 0) {
    lacking = "a constant permittivity (film.permittivity)";
  }
  return lacking == NULL ? DEA_OK
                         : dea_fail(ctx, DEA_E_UNSUPPORTED,
                                    "model 3d is a preview that knows only %s so far", lacking);
}

static dea_status fill_layers(struct dea_context *ctx, struct dea_model *model)
{
  const struct dea_device *d = model->device;
  double l = d->pre_stretch, E = d->fibre.young_modulus_Pa, nu = d->fibre.poisson_ratio;
  struct dea_film film;
  DEA_TRY(ctx, dea_film_create(ctx, d, &film));
  model->layers[0] = (struct dea_layer){
      .law = d->film.law,
      .param = d->film.param,
      .pre_stretch = {l, l, 1 / (l * l)},
      .kappa_Pa = kappa_share * dea_film_modulus(&film),
      .permittivity_F_per_m = DEA_EPSILON_0 * d->film.permittivity.at_rest,
      .thickness_m = d->film_thickness_m,
  };
  model->layers[1] = (struct dea_layer){.lame_mu_Pa = E / (2 * (1 + nu)),
                                        .lame_lambda_Pa = E * nu / ((1 + nu) * (1 - 2 * nu))};
  dea_status status = dea_layer_relax(&model->layers[0]);
  return status == DEA_OK ? DEA_OK
                          : dea_fail(ctx, status, "the film's law ends before the pre-stretch");
}

static size_t nearest_node(const struct dea_grid *grid, double x, double y, double z)
{
  size_t nearest = 0;
  double best = INFINITY;
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *X = grid->X + 3 * n;
    double distance = fabs(X[0] - x) + fabs(X[1] - y) + fabs(X[2] - z);
    if (distance < best) {
      best = distance;
      nearest = n;
    }
  }
  return nearest;
}

static dea_status prepare(struct dea_context *ctx, const struct dea_device *device,
                          struct dea_model *model)
{
  model->device = device;
  const struct dea_device *d = device;
  double a = d->electrode_radius_m;
  double between =
      acos(-1) / (d->fibre_count > 0 ? d->fibre_count : 4); // half the angle of two fibres
  DEA_TRY(ctx, check(ctx, d));
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_place){0},
                               "model 3d is a preview: a quarter of the actuator on one coarse "
                               "mesh (about 2 %% in z below the loss of tension), blind to modes "
                               "that break its symmetry"));
  DEA_TRY(ctx, fill_layers(ctx, model));
  const struct dea_quarter quarter = {
      .order = 2,
      .order_z = 2,
      .a = a,
      .b = d->frame_radius_m,
      .film_thickness = d->film_thickness_m,
      .fibres = d->fibre_count,
      .fibre_width = d->fibre_width_m,
      .fibre_thickness = d->fibre_thickness_m,
      .fine = FINE,
      .across = ACROSS,
      .edge = edge_share * a,
  };
  DEA_TRY(ctx, dea_grid_quarter(ctx, &quarter, &model->grid));
  const struct dea_solid_options options = {.order_z = 2,
                                            .layer_count = 2,
                                            .layers = model->layers,
                                            .layer_of = layer_of,
                                            .active = active,
                                            .held = held,
                                            .self = d};
  DEA_TRY(ctx, dea_solid_start(ctx));
  DEA_TRY(ctx, dea_solid_create(ctx, model->grid, &options, &model->solid));
  model->centre = nearest_node(model->grid, 0, 0, 0);
  model->between = nearest_node(model->grid, a * cos(between), a * sin(between), 0);
  model->tip = nearest_node(model->grid, a, 0, 0.5 * d->film_thickness_m); // where they meet
  DEA_TRY(ctx, dea_solid_solve(ctx, model->solid, 0, &model->report));
  model->rest_energy_J = model->report.energy_J;
  return DEA_OK;
}

static void destroy(struct dea_context *ctx, struct dea_model *model)
{
  if (model != NULL) {
    dea_solid_destroy(ctx, model->solid);
    dea_grid_destroy(ctx, model->grid);
    dea_free(ctx, model);
  }
}

static dea_status create(struct dea_context *ctx, const struct dea_device *device,
                         struct dea_model **out)
{
  DEA_TRY(ctx, dea_model_make(ctx, sizeof **out, device, prepare, destroy, out));
  return DEA_OK;
}

static dea_status report(struct dea_context *ctx, struct dea_model *model,
                         struct dea_load_point *out)
{
  const struct dea_device *d = model->device;
  const double *u = dea_solid_displacement(model->solid);
  struct dea_solid_extremes extremes;
  dea_status status = dea_solid_extremes(model->solid, &d->film, d->pre_stretch, &extremes);
  if (status != DEA_OK) {
    return dea_fail(ctx, status, "the film cannot be evaluated at %g V", model->voltage_V);
  }
  const double *X = model->grid->X + 3 * model->between;
  double outwards =
      (u[3 * model->between] * X[0] + u[3 * model->between + 1] * X[1]) / hypot(X[0], X[1]);
  *out = dea_load_point_empty();
  out->voltage_V = model->voltage_V;
  out->electrode_stretch = 1 + outwards / d->electrode_radius_m;
  out->electrode_edge_u_m = outwards;
  out->centre_z_m = u[3 * model->centre + 2];
  out->fibre_tip_z_m = d->fibre_count > 0 ? u[3 * model->tip + 2] : NAN;
  out->nominal_field_V_per_m = model->voltage_V / d->film_thickness_unstretched_m;
  out->true_field_V_per_m = extremes.true_field_V_per_m;
  out->breakdown_margin = extremes.breakdown_margin;
  out->min_tension_N_per_m = extremes.min_tension_N_per_m;
  out->energy_J = 4 * (model->report.energy_J - model->rest_energy_J);
  out->unstable_modes = model->report.unstable_modes;
  out->stable = out->unstable_modes == 0;
  return DEA_OK;
}

/* What a user can make of a solve that failed on the way to a voltage. */
static dea_status stopped(struct dea_context *ctx, const struct dea_model *model, double voltage_V,
                          dea_status status)
{
  char why[200];
  snprintf(why, sizeof why, "%s", dea_context_message(ctx));
  return dea_fail(ctx, status,
                  "stopped between %.4g and %.4g kV (%s); the points before are kept. %s",
                  1e-3 * model->voltage_V, 1e-3 * voltage_V, why,
                  model->device->pre_stretch < 1.1
                      ? "A film with hardly any pre-stretch buckles at once, which this preview "
                        "cannot follow yet"
                      : "Try smaller steps of compute.voltage");
}

static dea_status solve(struct dea_context *ctx, struct dea_model *model, double voltage_V,
                        struct dea_load_point *out)
{
  double step = field_step_V_per_m * model->device->film_thickness_unstretched_m;
  double from = model->voltage_V, way = voltage_V - from;
  int steps = (int)ceil(fabs(way) / step - 1e-9);
  steps = steps < 1 ? 1 : steps;
  for (int i = 1; i <= steps; i++) {
    if (dea_solid_any(dea_interrupted(ctx))) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted on the way to %.6g kV",
                      1e-3 * voltage_V);
    }
    double next = i == steps ? voltage_V : from + way * i / steps;
    dea_status status = dea_solid_solve(ctx, model->solid, next, &model->report);
    if (status != DEA_OK) {
      return stopped(ctx, model, next, status);
    }
    model->voltage_V = next;
  }
  DEA_TRY(ctx, report(ctx, model, out));
  return DEA_OK;
}

static dea_status fields(struct dea_context *ctx, struct dea_model *model,
                         enum dea_fields_part part, struct dea_field_mesh **out)
{
  DEA_TRY(ctx, part == DEA_FIELDS_VOLUME
                   ? dea_solid_volume(ctx, model->solid, out)
                   : dea_solid_surface(ctx, model->solid, DEA_SHEET_FILM, out));
  (*out)->fold = 2; // a quarter
  (*out)->fibres = model->device->fibre_count;
  return DEA_OK;
}

static dea_status save(struct dea_context *ctx, struct dea_model *model, struct dea_state *out)
{
  const double own[] = {model->voltage_V};
  *out = (struct dea_state){0};
  DEA_TRY(ctx, dea_solid_save(ctx, model->solid, out));
  DEA_TRY(ctx, dea_state_add_numbers(ctx, out, "model", own, 1));
  return DEA_OK;
}

static dea_status load(struct dea_context *ctx, struct dea_model *model,
                       const struct dea_state *state)
{
  const double *own = dea_state_find(state, "model", 1);
  if (own == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the state is not one of model 3d");
  }
  DEA_TRY(ctx, dea_solid_load(ctx, model->solid, state));
  model->voltage_V = own[0];
  return DEA_OK;
}

extern const struct dea_model_type dea_solid_module;

const struct dea_model_type dea_solid_module = {
    .name = "3d",
    .long_name = "3D solid (preview: a quarter, coarse)",
    .create = create,
    .destroy = destroy,
    .solve = solve,
    .fields = fields,
    .save = save,
    .load = load,
};
