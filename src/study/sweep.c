/* Study "sweep": stable equilibria at the asked voltages, in their order, each from the one before;
 * a curve that has points already goes on after them.
 */
#include "device/identity.h"
#include "result/checkpoint_sink.h"
#include "result/trust.h"
#include "study/observe.h"
#include "study/study.h"

#include <stdio.h>

/* Profile and surface of the last point of the curve, of a model that has them. */
static dea_status add_shapes(struct dea_context *ctx, const struct dea_study_job *job,
                             const struct dea_curve *curve)
{
  const struct dea_model_type *type = job->type;
  const size_t last = curve->count - 1;
  const double voltage_V = curve->points[last].voltage_V;
  struct dea_profile profile;
  struct dea_field_mesh *mesh;
  if (type->profile != NULL) {
    DEA_TRY(ctx, type->profile(ctx, job->model, &profile));
    DEA_TRY(ctx, dea_result_add_profile(ctx, job->result, type->name, voltage_V, &profile));
  }
  if (type->fields != NULL) {
    DEA_TRY(ctx, type->fields(ctx, job->model, DEA_FIELDS_SURFACE, &mesh));
    DEA_TRY(ctx, dea_result_add_surface(ctx, job->result, type->name, last, voltage_V, mesh));
  }
  return DEA_OK;
}

// Checkpoints ------------------------------------------------------------------------------------

static bool fields_wanted(const struct dea_design *design, double voltage_V)
{
  for (size_t i = 0; i < design->report.fields_at_count; i++) {
    double at = design->report.fields_at_V[i];
    if (fabs(at - voltage_V) <= 1e-9 * (1 + fabs(at))) {
      return true;
    }
  }
  return design->report.fields.value == DEA_FIELDS_ALL ||
         design->report.fields.value == DEA_FIELDS_LAST;
}

/* Adds to a state which design it is of, but for its voltages: more may follow. identity: lent to
 * the state. */
static dea_status mark_design(struct dea_context *ctx, const struct dea_result *result,
                              struct dea_text *identity, struct dea_state *state)
{
  if (result->design == NULL || result->device == NULL) {
    return DEA_OK;
  }
  dea_device_identity(result->design, result->device, "compute.voltage", identity);
  return identity->failed
             ? DEA_E_MEMORY
             : dea_state_add_mark(ctx, state, "design", dea_text_get(identity), identity->length);
}

/* Gives fields and state of the last point to who keeps them. */
static dea_status keep_point(struct dea_context *ctx, const struct dea_study_job *job,
                             const struct dea_curve *curve)
{
  const struct dea_model_type *type = job->type;
  const struct dea_checkpoint_sink *sink = job->services.checkpoint;
  const struct dea_result *result = job->result;
  struct dea_field_mesh *fields = NULL;
  struct dea_state state = {0};
  struct dea_text identity = {.ctx = ctx};
  dea_status status = DEA_OK;
  if (type->fields != NULL && result->design != NULL &&
      fields_wanted(result->design, curve->points[curve->count - 1].voltage_V)) {
    DEA_TRY(ctx, type->fields(ctx, job->model, DEA_FIELDS_VOLUME, &fields));
  }
  if (type->save != NULL) {
    status = type->save(ctx, job->model, &state);
    status = status == DEA_OK ? mark_design(ctx, result, &identity, &state) : status;
  }
  if (status == DEA_OK) {
    status =
        sink->point(ctx, sink->user, result, curve, fields, type->save != NULL ? &state : NULL);
  }
  dea_text_free(&identity);
  dea_field_mesh_destroy(ctx, fields);
  return status;
}

/* Brings a model to the state that was kept at the last point of a curve. */
static dea_status restore(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct dea_model_type *type = job->type;
  const struct dea_checkpoint_sink *sink = job->services.checkpoint;
  struct dea_state wanted = {0}, state = {0};
  struct dea_text identity = {.ctx = ctx};
  dea_status status = type->save(ctx, job->model, &wanted);
  status = status == DEA_OK ? mark_design(ctx, job->result, &identity, &wanted) : status;
  status = status == DEA_OK ? sink->restore(ctx, sink->user, type->name, &wanted, &state) : status;
  status = status == DEA_OK ? type->load(ctx, job->model, &state) : status;
  dea_state_free_values(ctx, &state);
  dea_text_free(&identity);
  *sink->refused |= status != DEA_OK;
  return status;
}

// Sweep ------------------------------------------------------------------------------------------

/* A limit point that the model has gone past on its way here, or where it has stopped; where it
 * knows that. */
static dea_status add_limit(struct dea_context *ctx,
                            const struct dea_event *(*of)(const struct dea_model *model),
                            const struct dea_model *model, struct dea_curve *curve)
{
  const struct dea_event *event = of != NULL ? of(model) : NULL;
  return event != NULL ? dea_curve_add_event(ctx, curve, event) : DEA_OK;
}

/* Solves one voltage and adds its point, profile and surface. */
static dea_status sweep_point(struct dea_context *ctx, const struct dea_study_job *job,
                              double voltage_V, struct dea_curve *curve)
{
  const struct dea_model_type *type = job->type;
  const struct dea_result *result = job->result;
  struct dea_load_point point;
  if (dea_interrupted_anywhere(ctx)) {
    return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted before %.6g kV; %zu points are kept",
                    1e-3 * voltage_V, curve->count);
  }
  DEA_TRY(ctx, type->solve(ctx, job->model, voltage_V, &point));
  DEA_TRY(ctx, add_limit(ctx, type->passed, job->model, curve));
  point.pull_in_distance_V =
      dea_study_distance_to_pull_in(dea_result_find(result, type->name, "path"), &point);
  DEA_TRY(ctx, dea_study_add_point(ctx, job, result->device, &point, curve));
  DEA_TRY(ctx, add_shapes(ctx, job, curve));
  return job->services.checkpoint != NULL ? keep_point(ctx, job, curve) : DEA_OK;
}

/* What a curve says of itself until its sweep has come to an end: it is kept on the way. */
static void open_curve(struct dea_curve *curve)
{
  curve->complete = false;
  curve->status = DEA_E_INTERRUPTED;
  snprintf(curve->stopped, sizeof curve->stopped, "the run was ended before the sweep");
}

/* Says of a pull-in that it is one of a film without tension, which would not stay flat. */
static dea_status report_slack_pull_in(struct dea_context *ctx, const struct dea_curve *curve,
                                       dea_status status)
{
  char why[sizeof curve->stopped];
  if (status != DEA_E_NO_EQUILIBRIUM || !dea_curve_is_slack(curve)) {
    return status;
  }
  snprintf(why, sizeof why, "%s", dea_context_message(ctx));
  return dea_fail(ctx, status, "pull-in of a slack film: not predictive (%s)", why);
}

/* Where the prediction ends, as a warning: also for a reader of the notes alone. */
static dea_status report_trust(struct dea_context *ctx, const struct dea_model_type *type,
                               const struct dea_curve *curve)
{
  struct dea_text text = {.ctx = ctx};
  struct dea_trust trust = dea_curve_trust(curve);
  dea_status status = DEA_OK;
  if ((trust.doubts | trust.dangers | trust.limits) != 0) {
    dea_trust_text(&trust, &text);
    if ((trust.doubts >> DEA_FLAG_SLACK & 1u) != 0 && type->push != NULL) {
      dea_text_add(&text, " (--study states looks for them)");
    }
    status = text.failed ? DEA_E_MEMORY
                         : dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                                           "model %s: %s", curve->model, dea_text_get(&text));
  }
  dea_text_free(&text);
  return status;
}

static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct dea_model_type *type = job->type;
  const struct dea_design *design = job->result->design;
  size_t total = design->compute.voltage_count;
  struct dea_curve *curve;
  DEA_TRY(ctx, dea_result_get_curve(ctx, job->result, type->name, "sweep", &curve));
  open_curve(curve);
  DEA_TRY(ctx, dea_study_observe_passes(ctx, job));
  dea_status status = DEA_OK;
  if (job->services.checkpoint != NULL && type->load != NULL && curve->count > 0) {
    status = restore(ctx, job);
  }
  for (size_t i = curve->count; i < total && status == DEA_OK; i++) {
    status = sweep_point(ctx, job, design->compute.voltages_V[i], curve);
    if (status == DEA_OK) {
      dea_study_progress(ctx, job, "sweep", i + 1, total);
    }
  }
  DEA_TRY(ctx, report_trust(ctx, type, curve));
  dea_curve_end(ctx, curve, status);
  if (dea_verdict_of(status)[0] != '\0') {
    DEA_TRY(ctx, add_limit(ctx, type->limit, job->model, curve));
    status = dea_curve_end(ctx, curve, report_slack_pull_in(ctx, curve, status));
  }
  return status;
}

const struct dea_study dea_study_sweep = {.name = "sweep",
                                          .run = run,
                                          .figures = dea_observe_figures,
                                          .figure_count = DEA_OBSERVE_FIGURES};
