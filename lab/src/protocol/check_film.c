/* What a sequence does to the film: its field, and whether there is an equilibrium at all. */
#include "protocol/protocol_check.h"

#include <math.h>
#include <stdio.h>

/* The film as the model sees it. */
struct film {
  struct dea_context *ctx;
  const struct dea_protocol *protocol;
  struct dea_bench_model *model;
};

/* Field that is allowed at a point; NAN when nobody says. */
static double allowed_field(const struct film *film, const struct dea_bench_point *at)
{
  const struct dea_quantity *largest = &film->protocol->safety.largest_field_V_per_m;
  return largest->origin != DEA_ABSENT
             ? largest->si
             : at->breakdown_V_per_m / film->protocol->safety.field_margin.si;
}

/* The voltage below which all is allowed, for the message. */
static dea_status allowed_voltage(const struct film *film, double high_V, double *out)
{
  double low_V = 0;
  while (high_V - low_V > 5) {
    double middle_V = 0.5 * (low_V + high_V);
    struct dea_bench_point at;
    dea_status status = film->model->type->solve(film->ctx, film->model, middle_V, &at);
    if (status == DEA_E_MEMORY || status == DEA_E_INTERRUPTED) {
      return status;
    }
    bool good = status == DEA_OK && at.point.true_field_V_per_m <= allowed_field(film, &at);
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
  struct dea_location location =
      dea_protocol_voltage_location(protocol, peak->step, peak->voltage_V);
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
      1e-6 * plan->allowed_field_V_per_m, film->model->material, protocol->safety.field_margin.si,
      1e-3 * voltage_V);
}

/* A largest_field of the protocol that is above what the material stands needs a reason. */
static dea_status check_reason(const struct film *film, const struct dea_bench_point *at)
{
  const struct dea_protocol *protocol = film->protocol;
  double field = at->point.true_field_V_per_m, breakdown = at->breakdown_V_per_m;
  if (protocol->safety.largest_field_V_per_m.origin == DEA_ABSENT ||
      protocol->safety.field_reason.text[0] != '\0' || !(field > breakdown)) {
    return DEA_OK;
  }
  return dea_finding_add(film->ctx, DEA_ERROR, protocol->safety.largest_field_V_per_m.location,
                         "refused: safety.largest_field of %.4g V/um allows %.4g V/um, which is "
                         "above the breakdown field of %s, %.4g V/um; who knows the film better "
                         "says why: safety.field_reason",
                         1e-6 * protocol->safety.largest_field_V_per_m.si, 1e-6 * field,
                         film->model->material, 1e-6 * breakdown);
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
                         dea_protocol_voltage_location(film->protocol, peak->step, peak->voltage_V),
                         "%sthe film pulls in%s on its way to %g kV at %s, by the model %s%s",
                         refused ? "refused: " : "", where, 1e-3 * peak->voltage_V, step,
                         film->model->name,
                         lost ? ", and has no equilibrium there" : " without wrinkles");
}

static dea_status check_peak(const struct film *film, const struct dea_protocol_peak *peak,
                             struct dea_protocol_plan *plan)
{
  struct dea_context *ctx = film->ctx;
  const struct dea_bench_film_type *type = film->model->type;
  struct dea_bench_point at;
  double voltage_V = fabs(peak->voltage_V);
  DEA_TRY(ctx, type->pull_in(ctx, film->model, &plan->pull_in_V));
  dea_status status = type->solve(ctx, film->model, voltage_V, &at);
  if (status == DEA_E_NO_EQUILIBRIUM) {
    dea_context_clear(ctx);
    return report_pull_in(film, peak, plan->pull_in_V, true);
  }
  DEA_TRY(ctx, status);
  plan->largest_field_V_per_m = at.point.true_field_V_per_m;
  plan->allowed_field_V_per_m = allowed_field(film, &at);
  plan->breakdown_field_V_per_m = at.breakdown_V_per_m;
  plan->breakdown_probability = at.point.breakdown_probability;
  plan->breakdown_probability_band[0] = at.breakdown_probability_band[0];
  plan->breakdown_probability_band[1] = at.breakdown_probability_band[1];
  plan->capacitance_F = at.point.capacitance_F;
  plan->stored_energy_J = 0.5 * at.point.capacitance_F * voltage_V * voltage_V;
  if (plan->pull_in_V <= voltage_V) {
    DEA_TRY(ctx, report_pull_in(film, peak, plan->pull_in_V, false));
  }
  DEA_TRY(ctx, check_reason(film, &at));
  if (isnan(plan->allowed_field_V_per_m)) {
    return dea_finding_add(ctx, DEA_WARNING, film->protocol->design_file.location,
                           "no breakdown field of %s is known, so the field of %.4g V/um is not "
                           "checked; safety.largest_field says what is allowed",
                           film->model->material, 1e-6 * plan->largest_field_V_per_m);
  }
  return plan->largest_field_V_per_m > plan->allowed_field_V_per_m * (1 + 1e-9)
             ? refuse_field(film, peak, plan)
             : DEA_OK;
}

dea_status dea_protocol_check_film(struct dea_context *ctx, const struct dea_protocol *protocol,
                                   const struct dea_protocol_peak *peak,
                                   struct dea_protocol_plan *plan)
{
  struct film film = {.ctx = ctx, .protocol = protocol};
  if (protocol->film == NULL) {
    return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){protocol->file, 1, 1},
                           "no `design` is named: field, pull-in and current of the film are not "
                           "checked");
  }
  const struct dea_bench_film_type *type = protocol->film->type;
  DEA_TRY(ctx, type->open(ctx, protocol->film, NULL, NULL, &film.model));
  dea_status status = check_peak(&film, peak, plan);
  type->close(ctx, film.model);
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}
