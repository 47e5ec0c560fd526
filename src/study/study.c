#include "study/study.h"

#include "base/text.h"
#include "study/figures.h"
#include "study/study_list.h"

#include <stdio.h>
#include <string.h>

#define STUDY_DECLARE(name) extern const struct dea_study name;
DEA_STUDY_LIST(STUDY_DECLARE)
#undef STUDY_DECLARE

static const struct dea_study *const studies[] = {
#define STUDY_ROW(name) &name,
    DEA_STUDY_LIST(STUDY_ROW)
#undef STUDY_ROW
};
enum { STUDIES = DEA_COUNT(studies) };

const struct dea_study *const *dea_study_all(size_t *count)
{
  *count = STUDIES;
  return studies;
}

const struct dea_figure *dea_study_figure(size_t i)
{
  for (size_t s = 0; s < STUDIES; s++) {
    if (i < studies[s]->figure_count) {
      return &studies[s]->figures[i];
    }
    i -= studies[s]->figure_count;
  }
  return NULL;
}

static bool is_asked(const struct dea_study *study, const struct dea_design *design)
{
  if (study->asked != NULL || study->keys == NULL) {
    return study->asked == NULL || study->asked(design);
  }
  const struct dea_settings *settings = dea_design_settings(design, study->keys);
  return settings != NULL && settings->written;
}

/* NULL: there is none. */
static const struct dea_study *find_study(const char *name)
{
  size_t k = 0;
  while (k < STUDIES && strcmp(studies[k]->name, name) != 0) {
    k++;
  }
  return k < STUDIES ? studies[k] : NULL;
}

bool dea_study_asked(const struct dea_design *design, const char *name)
{
  const struct dea_study *study = find_study(name);
  return study != NULL && is_asked(study, design);
}

static bool is_wanted(const struct dea_study *study, const char *const names[], size_t name_count,
                      const struct dea_design *design)
{
  for (size_t i = 0; names != NULL && i < name_count; i++) {
    if (strcmp(names[i], study->name) == 0) {
      return true;
    }
  }
  return names == NULL && !study->by_name_only && is_asked(study, design);
}

static dea_status unknown_name(struct dea_context *ctx, const char *name)
{
  const char *known[STUDIES];
  char hint[DEA_HINT_SIZE];
  for (size_t k = 0; k < STUDIES; k++) {
    known[k] = studies[k]->name;
  }
  dea_name_hint_list(name, known, STUDIES, NULL, "; there are: ", hint);
  return dea_fail(ctx, DEA_E_ARGUMENT, "there is no study '%.60s'%s", name, hint);
}

bool dea_study_known_to(const struct dea_study *study, const struct dea_model_type *type,
                        const struct dea_result *result)
{
  void (*function)(void) = NULL;
  memcpy(&function, (const char *)type + study->able_by, sizeof function);
  return (study->able_by == 0 || function != NULL) &&
         (study->able == NULL || study->able(type, result));
}

/* Whether all designs ask for it. */
static bool is_of_all(const struct dea_study *study)
{
  return study->asked == NULL && study->keys == NULL;
}

/* Models and studies of a design. */
struct asked {
  const struct dea_model_type *const *types; // [type_count]
  size_t type_count;
  const char *const *names; // [name_count] of studies; NULL: what the design asks for
  size_t name_count;
  const struct dea_result *result;
};

/* What there is to say of a study that none of the models knows, added to *text. */
static void add_known_to_none(const struct dea_study *study, const struct asked *a,
                              struct dea_text *out)
{
  size_t count;
  const struct dea_model_type *const *all = dea_model_all(&count);
  dea_text_add(out, "no study '%s' of model ", study->name);
  for (size_t i = 0; i < a->type_count; i++) {
    dea_text_add(out, "%s%s", i > 0 ? " or " : "", a->types[i]->name);
  }
  dea_text_add(out, ", which %s not support %s", a->type_count > 1 ? "do" : "does", study->ability);
  for (size_t i = 0, able = 0; i < count; i++) {
    if (dea_study_known_to(study, all[i], a->result)) {
      dea_text_add(out, "%s%s", able++ > 0 ? ", " : "; there is one of ", all[i]->name);
    }
  }
}

/* What of a design asks for a study: its section, or what else does without one. */
static struct dea_location place_of(const struct dea_study *study, const struct dea_design *design)
{
  const struct dea_node *compute = dea_node_find(dea_yaml_root(design->document), "compute");
  const struct dea_node *section =
      study->keys != NULL ? dea_node_find(compute, study->keys->record.name) : NULL;
  return section != NULL ? section->key_place : design->compute.models[0].location;
}

/* Of a study that some of the models know: whether it goes with the design. Of one that none knows:
 * a failure where it is named. warns: only of such studies that the design asks for, a warning. */
static dea_status check(struct dea_context *ctx, const struct dea_study *study,
                        const struct asked *a, bool warns)
{
  const struct dea_design *design = a->result->design;
  for (size_t i = 0; i < a->type_count; i++) {
    if (dea_study_known_to(study, a->types[i], a->result)) {
      return warns || study->refuse == NULL ? DEA_OK
                                            : study->refuse(ctx, design, a->result->device);
    }
  }
  if (a->names == NULL && (!warns || is_of_all(study))) {
    return DEA_OK;
  }
  struct dea_text text = {.ctx = ctx};
  add_known_to_none(study, a, &text);
  dea_status status = text.failed ? DEA_E_MEMORY
                      : warns     ? dea_finding_add(ctx, DEA_WARNING, place_of(study, design),
                                                    "%s (compute.models)", dea_text_get(&text))
                                  : dea_fail(ctx, DEA_E_ARGUMENT, "%s", dea_text_get(&text));
  dea_text_free(&text);
  return status;
}

static dea_status check_all(struct dea_context *ctx, const struct asked *a, bool warns)
{
  for (size_t k = 0; k < STUDIES; k++) {
    if (is_wanted(studies[k], a->names, a->name_count, a->result->design)) {
      DEA_TRY(ctx, check(ctx, studies[k], a, warns));
    }
  }
  return DEA_OK;
}

dea_status dea_study_check_models(struct dea_context *ctx,
                                  const struct dea_model_type *const types[], size_t type_count,
                                  const char *const names[], size_t name_count,
                                  const struct dea_result *result)
{
  const struct asked asked = {types, type_count, names, name_count, result};
  return DEA_CHAIN(ctx, check_all(ctx, &asked, false));
}

dea_status dea_study_warn(struct dea_context *ctx, const struct dea_design *design,
                          const struct dea_device *device)
{
  const struct dea_model_type *types[DEA_DESIGN_MODELS_MAX];
  const struct dea_result result = {.design = design, .device = device};
  const struct asked asked = {types, design->compute.model_count, NULL, 0, &result};
  for (size_t i = 0; i < asked.type_count; i++) {
    types[i] = dea_model_find(design->compute.models[i].text);
    if (types[i] == NULL) {
      return DEA_OK; // an error already
    }
  }
  return DEA_CHAIN(ctx, check_all(ctx, &asked, true));
}

dea_status dea_study_check(struct dea_context *ctx, const char *const names[], size_t name_count,
                           const struct dea_design *design)
{
  for (size_t i = 0; names != NULL && i < name_count; i++) {
    const struct dea_study *study = find_study(names[i]);
    if (study == NULL) {
      return unknown_name(ctx, names[i]);
    }
    if (study->needs != NULL && !is_asked(study, design)) {
      return dea_fail(ctx, DEA_E_DESIGN, "the study '%s' needs %s in the design", names[i],
                      study->needs);
    }
  }
  return DEA_OK;
}

/* What a run of several studies ends with: the first that failed, and what it said. */
struct outcome {
  dea_status status;
  char message[1024];
};

static void add_outcome(const struct dea_context *ctx, dea_status status, struct outcome *outcome)
{
  if (status != DEA_OK && outcome->status == DEA_OK) {
    outcome->status = status;
    snprintf(outcome->message, sizeof outcome->message, "%s", dea_context_message(ctx));
  }
}

/* The model for the first study that wants one. A film whose rest is not found is a sweep that ends
 * before its first point, where one is wanted: it too has a verdict. */
static dea_status build_model(struct dea_context *ctx, bool sweeps, struct dea_study_job *job)
{
  struct dea_curve *curve;
  struct dea_result *result = job->result;
  dea_status status = dea_model_create(ctx, job->type, result->design, result->device, &job->model);
  if (sweeps && dea_verdict_of(status)[0] != '\0') {
    DEA_TRY(ctx, dea_result_get_curve(ctx, result, job->type->name, "sweep", &curve));
    dea_curve_end(ctx, curve, status);
  }
  return DEA_CHAIN(ctx, status);
}

dea_status dea_study_run(struct dea_context *ctx, const struct dea_model_type *type,
                         const char *const names[], size_t name_count, struct dea_result *result)
{
  return dea_study_run_with(ctx, type, names, name_count, NULL, result);
}

dea_status dea_study_run_with(struct dea_context *ctx, const struct dea_model_type *type,
                              const char *const names[], size_t name_count,
                              const struct dea_study_services *services, struct dea_result *result)
{
  struct dea_study_job shared = {.type = type, .result = result};
  if (services != NULL) {
    shared.services = *services;
  }
  const struct dea_study_job own = shared;
  DEA_TRY(ctx, dea_study_check(ctx, names, name_count, result->design));
  struct outcome first = {.status = DEA_OK};
  for (size_t i = 0; i < STUDIES; i++) {
    const struct dea_study *study = studies[i];
    if (!is_wanted(study, names, name_count, result->design)) {
      continue;
    }
    if (!dea_study_known_to(study, type, result)) {
      dea_status status = names == NULL && is_of_all(study)
                              ? DEA_OK
                              : dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                                "model %s does not support %s: no study '%s'",
                                                type->name, study->ability, study->name);
      add_outcome(ctx, status, &first);
      continue;
    }
    if (!study->own_models && shared.model == NULL) {
      const bool sweeps = is_wanted(&dea_study_sweep, names, name_count, result->design);
      DEA_TRY(ctx, build_model(ctx, sweeps, &shared));
    }
    dea_status status = study->run(ctx, study->own_models ? &own : &shared);
    add_outcome(ctx, status, &first);
    if (status == DEA_E_MEMORY) {
      break;
    }
    if (study->tables != NULL) { // also of one that failed: partial results are results
      status = study->tables(ctx, type->name, result);
      add_outcome(ctx, status, &first);
    }
    if (first.status == DEA_E_INTERRUPTED || status == DEA_E_MEMORY) {
      break;
    }
  }
  if (shared.model != NULL) {
    type->destroy(ctx, shared.model);
  }
  bool said = first.status == DEA_OK || strcmp(dea_context_message(ctx), first.message) == 0;
  return said ? first.status : dea_fail(ctx, first.status, "%s", first.message);
}
