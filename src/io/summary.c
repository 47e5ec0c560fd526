#include "io/summary.h"

#include "base/json.h"
#include "base/write_file.h"
#include "io/summary_studies.h"
#include "result/trust.h"

#include <math.h>
#include <string.h>

/* First event of each kind along the path. */
static json_t *limits_json(const struct dea_curve *path)
{
  static const enum dea_event_kind kinds[] = {DEA_EVENT_PULL_IN, DEA_EVENT_SNAP_BACK,
                                              DEA_EVENT_SLACK, DEA_EVENT_BREAKDOWN};
  json_t *object = json_object();
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
    const struct dea_event *event = dea_curve_first_event(path, kinds[k]);
    if (event != NULL) {
      char key[64];
      snprintf(key, sizeof key, "%s_voltage_V", dea_event_name(kinds[k]));
      dea_json_add(object, key, event->point.voltage_V);
      snprintf(key, sizeof key, "%s_stretch", dea_event_name(kinds[k]));
      dea_json_add(object, key, event->point.electrode_stretch);
    }
  }
  if (dea_curve_first_event(path, DEA_EVENT_PULL_IN) != NULL) {
    json_object_set_new(object, "pull_in_of_slack_film", json_boolean(dea_curve_is_slack(path)));
  }
  return object;
}

/* First curve of a model, of its variants too, that was stopped; NULL when none was. */
static const struct dea_curve *first_stopped(const struct dea_result *result, const char *model)
{
  size_t curves = result->curve_count;
  for (size_t i = 0; i < curves + result->variant_count; i++) {
    const struct dea_curve *curve =
        i < curves ? &result->curves[i] : &result->variants[i - curves].curve;
    if (strcmp(curve->model, model) == 0 && !curve->complete) {
      return curve;
    }
  }
  return NULL;
}

/* How far the sweep is to be trusted. */
static json_t *trust_json(const struct dea_curve *sweep)
{
  json_t *object = json_object();
  if (sweep != NULL && sweep->count > 0) {
    struct dea_trust trust = dea_curve_trust(sweep);
    dea_json_add(object, "trusted_and_safe_V", trust.good_V);
    dea_json_add(object, "trusted_V", trust.trusted_V);
    dea_json_add(object, "safe_V", trust.safe_V);
  }
  return object;
}

/* Puts what is known of one model into an object. */
static void write_model(const struct dea_context *ctx, const struct dea_result *result,
                        const char *model, json_t *object)
{
  const struct dea_curve *sweep = dea_result_find(result, model, "sweep");
  json_object_set_new(object, "model", json_string(model));
  json_object_set_new(object, "points", dea_points_json(ctx, sweep));
  json_object_set_new(object, "trust", trust_json(sweep));
  const struct dea_curve *stopped = first_stopped(result, model);
  json_object_set_new(object, "complete", json_boolean(stopped == NULL));
  dea_json_add_text(object, "stopped", stopped != NULL ? stopped->stopped : "");
  json_object_set_new(object, "status",
                      json_string(dea_status_name(stopped != NULL ? stopped->status : DEA_OK)));
  json_object_set_new(object, "verdict",
                      json_string(stopped != NULL ? dea_verdict_of(stopped->status) : ""));
  const struct dea_curve *path = dea_result_find(result, model, "path");
  json_object_set_new(object, "limits", limits_json(path != NULL ? path : sweep));
  dea_summary_add_studies(ctx, result, model, object);
}

static json_t *design_json(const struct dea_result *result)
{
  json_t *object = json_object();
  const struct dea_design *design = result->design;
  dea_json_add_text(object, "title", design != NULL ? design->title.text : "");
  dea_json_add_text(object, "file", design != NULL ? design->file : "");
  dea_json_add_text(object, "sha256", result->provenance.input_sha256);
  return object;
}

static json_t *provenance_json(const struct dea_provenance *p)
{
  json_t *object = json_object();
  dea_json_add_text(object, "program", p->program);
  dea_json_add_text(object, "compiler", p->compiler);
  dea_json_add_text(object, "build", p->build);
  dea_json_add_text(object, "libraries", p->libraries);
  dea_json_add_text(object, "started", p->started);
  dea_json_add(object, "wall_s", p->wall_s);
  json_t *solver = json_object();
#define PUT(member, label)                                                                         \
  json_object_set_new(solver, #member, json_integer((json_int_t)p->solver.member));
  DEA_SOLVER_COUNTERS(PUT)
#undef PUT
  json_object_set_new(object, "solver", solver);
  dea_json_add_text(object, "input_sha256", p->input_sha256);
  dea_json_add_text(object, "overrides", p->overrides);
  dea_json_add_text(object, "command", p->command);
  return object;
}

/* What was said of the design and its models so far, errors aside. */
static json_t *notes_json(const struct dea_context *ctx)
{
  json_t *notes = json_array();
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    if (findings[i].severity != DEA_ERROR) { // text that is not UTF-8 is left out
      json_array_append_new(notes, json_string(findings[i].text));
    }
  }
  return notes;
}

dea_status dea_summary_text(struct dea_context *ctx, const struct dea_result *result, char **out)
{
  json_t *root = json_object();
  json_object_set_new(root, "schema", json_integer(DEA_SUMMARY_SCHEMA));
  dea_json_add_text(root, "program", result->provenance.program);
  json_object_set_new(root, "design", design_json(result));
  json_t *more = json_array();
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    json_t *object = m == 0 ? root : json_object();
    write_model(ctx, result, models[m], object);
    if (m > 0) {
      json_array_append_new(more, object);
    }
  }
  if (count == 0) {
    json_object_set_new(root, "points", json_array());
  }
  json_object_set_new(root, "more_models", more);
  json_object_set_new(root, "notes", notes_json(ctx));
  json_object_set_new(root, "provenance", provenance_json(&result->provenance));
  return dea_json_text(ctx, root, out);
}
