/* What a sequence does to the film: its field, and whether there is an equilibrium at all. */
#include "lab/protocol/check.h"
#include "model/model.h"

#include <math.h>
#include <stdio.h>

enum { PATH_POINTS_MAX = 4000 };

/* The film as the model sees it. */
struct film {
  struct dea_context *ctx;
  const struct dea_protocol *protocol;
  struct dea_device *device;
  const struct dea_model_type *type;
  struct dea_model *model;
};

static dea_status first_pull_in(void *user, const struct dea_event *event)
{
  double *pull_in_V = user;
  if (event->kind == DEA_EVENT_PULL_IN && isnan(*pull_in_V)) {
    *pull_in_V = event->point.voltage_V;
  }
  return DEA_OK;
}

static dea_status no_point(void *user, const struct dea_load_point *point)
{
  (void)user;
  (void)point;
  return DEA_OK;
}

static dea_status find_pull_in(const struct film *film, double *pull_in_V)
{
  const struct dea_path_options options = {
      .max_stretch = film->protocol->design->compute.path_max_stretch.si,
      .max_voltage_V = INFINITY,
      .max_points = PATH_POINTS_MAX,
  };
  *pull_in_V = NAN;
  return dea_model_path(film->ctx, film->type, film->model, &options, no_point, first_pull_in,
                        pull_in_V);
}

/* What the material stands at a point; NAN: not known. */
static double breakdown_field(const struct film *film, const struct dea_load_point *point)
{
  const struct dea_breakdown *breakdown = &film->device->film.breakdown;
  double stretch = point->electrode_stretch * film->device->pre_stretch;
  return breakdown->known ? breakdown->at_rest_V_per_m * pow(stretch, breakdown->exponent) : NAN;
}

/* Field that is allowed at a point; NAN when nobody says. */
static double allowed_field(const struct film *film, const struct dea_load_point *point)
{
  const struct dea_quantity *largest = &film->protocol->safety.largest_field_V_per_m;
  return largest->origin != DEA_ABSENT
             ? largest->si
             : breakdown_field(film, point) / film->protocol->safety.field_margin.si;
}

/* The voltage below which all is allowed, for the message. */
static dea_status allowed_voltage(const struct film *film, double high_V, double *out)
{
  double low_V = 0;
  while (high_V - low_V > 5) {
    double middle_V = 0.5 * (low_V + high_V);
    struct dea_load_point point;
    struct dea_model *model = NULL;
    DEA_TRY(film->ctx, film->type->create(film->ctx, film->device, NULL, &model));
    dea_status status = film->type->solve(film->ctx, model, middle_V, &point);
    film->type->destroy(film->ctx, model);
    if (status == DEA_E_MEMORY || status == DEA_E_INTERRUPTED) {
      return status;
    }
    bool good = status == DEA_OK && point.true_field_V_per_m <= allowed_field(film, &point);
    *(good ? &low_V : &high_V) = middle_V;
  }
  *out = low_V;
  return DEA_OK;
}

static dea_status refuse_field(const struct film *film, const struct dea_protocol_peak *peak,
                               const struct dea_protocol_plan *plan)
{
  const struct dea_protocol *protocol = film->protocol;
  char step[DEA_STEP_NAME_SIZE];
  double voltage_V = 0;
  DEA_TRY(film->ctx, allowed_voltage(film, fabs(peak->voltage_V), &voltage_V));
  dea_context_clear(film->ctx);
  dea_protocol_step_name(protocol, peak->step, step);
  struct dea_location location = dea_protocol_voltage_place(protocol, peak->step, peak->voltage_V);
  if (protocol->safety.largest_field_V_per_m.origin != DEA_ABSENT) {
    return dea_finding_add(film->ctx, DEA_ERROR, location,
                           "refused: %g kV at %s makes a true field of %.4g V/um in the film, but "
                           "safety.largest_field allows %.4g V/um, which is %.2f kV",
                           1e-3 * peak->voltage_V, step, 1e-6 * plan->largest_field_V_per_m,
                           1e-6 * plan->allowed_field_V_per_m, 1e-3 * voltage_V);
  }
  return dea_finding_add(
      film->ctx, DEA_ERROR, location,
      "refused: %g kV at %s makes a true field of %.4g V/um in the film, but %.4g V/um are "
      "allowed, "
      "the breakdown field of %s over a margin of %g, which is %.2f kV; who knows the film better "
      "sets safety.largest_field and safety.field_reason",
      1e-3 * peak->voltage_V, step, 1e-6 * plan->largest_field_V_per_m,
      1e-6 * plan->allowed_field_V_per_m, film->device->film.name, protocol->safety.field_margin.si,
      1e-3 * voltage_V);
}

/* A largest_field of the protocol that is above what the material stands needs a reason. */
static dea_status check_reason(const struct film *film, const struct dea_load_point *point)
{
  const struct dea_protocol *protocol = film->protocol;
  double breakdown = breakdown_field(film, point); // NAN: not known
  if (protocol->safety.largest_field_V_per_m.origin == DEA_ABSENT ||
      protocol->safety.field_reason.text[0] != '\0' || !(point->true_field_V_per_m > breakdown)) {
    return DEA_OK;
  }
  return dea_finding_add(film->ctx, DEA_ERROR, protocol->safety.largest_field_V_per_m.location,
                         "refused: safety.largest_field of %.4g V/um allows %.4g V/um, which is "
                         "above the breakdown field of %s, %.4g V/um; who knows the film better "
                         "says why: safety.field_reason",
                         1e-6 * protocol->safety.largest_field_V_per_m.si,
                         1e-6 * point->true_field_V_per_m, film->device->film.name,
                         1e-6 * breakdown);
}

/* A film that pulls in mostly breaks down there; who gives a reason knows better. */
static dea_status report_pull_in(const struct film *film, const struct dea_protocol_peak *peak,
                                 double pull_in_V, bool lost)
{
  char step[DEA_STEP_NAME_SIZE], where[64] = "";
  bool refused = lost || film->protocol->safety.field_reason.text[0] == '\0';
  dea_protocol_step_name(film->protocol, peak->step, step);
  if (isfinite(pull_in_V)) {
    snprintf(where, sizeof where, " at %.4g kV", 1e-3 * pull_in_V);
  }
  return dea_finding_add(film->ctx, refused ? DEA_ERROR : DEA_WARNING,
                         dea_protocol_voltage_place(film->protocol, peak->step, peak->voltage_V),
                         "%sthe film pulls in%s on its way to %g kV at %s, by the model %s%s",
                         refused ? "refused: " : "", where, 1e-3 * peak->voltage_V, step,
                         film->type->name,
                         lost ? ", and has no equilibrium there" : " without wrinkles");
}

static dea_status look(const struct film *film, const struct dea_protocol_peak *peak,
                       struct dea_protocol_plan *plan)
{
  struct dea_context *ctx = film->ctx;
  struct dea_load_point point;
  double voltage_V = fabs(peak->voltage_V);
  DEA_TRY(ctx, find_pull_in(film, &plan->pull_in_V));
  dea_status status = film->type->solve(ctx, film->model, voltage_V, &point);
  if (status == DEA_E_NO_EQUILIBRIUM) {
    dea_context_clear(ctx);
    return report_pull_in(film, peak, plan->pull_in_V, true);
  }
  DEA_TRY(ctx, status);
  plan->largest_field_V_per_m = point.true_field_V_per_m;
  plan->allowed_field_V_per_m = allowed_field(film, &point);
  plan->capacitance_F = point.capacitance_F;
  plan->stored_energy_J = 0.5 * point.capacitance_F * voltage_V * voltage_V;
  if (plan->pull_in_V <= voltage_V) {
    DEA_TRY(ctx, report_pull_in(film, peak, plan->pull_in_V, false));
  }
  DEA_TRY(ctx, check_reason(film, &point));
  if (isnan(plan->allowed_field_V_per_m)) {
    return dea_finding_add(ctx, DEA_WARNING, film->protocol->design_file.location,
                           "no breakdown field of %s is known, so the field of %.4g V/um is not "
                           "checked; safety.largest_field says what is allowed",
                           film->device->film.name, 1e-6 * plan->largest_field_V_per_m);
  }
  return plan->largest_field_V_per_m > plan->allowed_field_V_per_m * (1 + 1e-9)
             ? refuse_field(film, peak, plan)
             : DEA_OK;
}

dea_status dea_protocol_check_film(struct dea_context *ctx, const struct dea_protocol *protocol,
                                   const struct dea_protocol_peak *peak,
                                   struct dea_protocol_plan *plan)
{
  struct film film = {.ctx = ctx, .protocol = protocol, .type = dea_model_find("lumped")};
  if (protocol->design == NULL) {
    return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){protocol->file, 1, 1},
                           "no `design` is named: field, pull-in and current of the film are not "
                           "checked");
  }
  dea_status status = dea_device_build(ctx, protocol->design, &film.device);
  if (status == DEA_OK) { // in this model the film knows neither, and need not say so here
    film.device->fibre_count = 0;
    film.device->gravity = DEA_GRAVITY_OFF;
  }
  status = status == DEA_OK ? film.type->create(ctx, film.device, NULL, &film.model) : status;
  status = status == DEA_OK ? look(&film, peak, plan) : status;
  if (film.model != NULL) {
    film.type->destroy(ctx, film.model);
  }
  dea_device_destroy(ctx, film.device);
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}
