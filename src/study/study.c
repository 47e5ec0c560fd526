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
enum { STUDIES = sizeof studies / sizeof studies[0] };

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

bool dea_study_asked(const struct dea_design *design, const char *name)
{
  for (size_t k = 0; k < STUDIES; k++) {
    if (strcmp(studies[k]->name, name) == 0) {
      return is_asked(studies[k], design);
    }
  }
  return false;
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

/* A note, but not of a study that all designs ask for. */
static dea_status report_unknown(struct dea_context *ctx, const struct dea_study *study,
                                 const char *model, bool named)
{
  if (!named && study->asked == NULL && study->keys == NULL) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                         "model %s does not support %s: no study '%s'", model, study->ability,
                         study->name);
}

/* What there is to say of a study that none of these models knows, added to *text. */
static void add_known_to_none(const struct dea_study *study,
                              const struct dea_model_type *const types[], size_t type_count,
                              const struct dea_result *result, struct dea_text *out)
{
  size_t count;
  const struct dea_model_type *const *all = dea_model_all(&count);
  dea_text_add(out, "no study '%s' of model ", study->name);
  for (size_t i = 0; i < type_count; i++) {
    dea_text_add(out, "%s%s", i > 0 ? " or " : "", types[i]->name);
  }
  dea_text_add(out, ", which %s not support %s", type_count > 1 ? "do" : "does", study->ability);
  for (size_t i = 0, able = 0; i < count; i++) {
    if (dea_study_known_to(study, all[i], result)) {
      dea_text_add(out, "%s%s", able++ > 0 ? ", " : "; there is one of ", all[i]->name);
    }
  }
}

/* Whether some of the models knows what the study needs of it. */
static bool is_known_to_some(const struct dea_study *study,
                             const struct dea_model_type *const types[], size_t type_count,
                             const struct dea_result *result)
{
  for (size_t i = 0; i < type_count; i++) {
    if (dea_study_known_to(study, types[i], result)) {
      return true;
    }
  }
  return false;
}

/* What of a design the studies that are wanted do not go with. */
static dea_status refuse(struct dea_context *ctx, const struct dea_model_type *const types[],
                         size_t type_count, const char *const names[], size_t name_count,
                         const struct dea_result *result)
{
  for (size_t k = 0; k < STUDIES; k++) {
    if (studies[k]->refuse != NULL && is_wanted(studies[k], names, name_count, result->design) &&
        is_known_to_some(studies[k], types, type_count, result)) {
      DEA_TRY(ctx, studies[k]->refuse(ctx, result->design, result->device));
    }
  }
  return DEA_OK;
}

dea_status dea_study_check_models(struct dea_context *ctx,
                                  const struct dea_model_type *const types[], size_t type_count,
                                  const char *const names[], size_t name_count,
                                  const struct dea_result *result)
{
  for (size_t k = 0; names != NULL && k < STUDIES; k++) {
    if (is_wanted(studies[k], names, name_count, result->design) &&
        !is_known_to_some(studies[k], types, type_count, result)) {
      struct dea_text text = {.ctx = ctx};
      add_known_to_none(studies[k], types, type_count, result, &text);
      dea_status status = dea_fail(ctx, DEA_E_ARGUMENT, "%s", dea_text_get(&text));
      dea_text_free(&text);
      return status;
    }
  }
  return refuse(ctx, types, type_count, names, name_count, result);
}

/* What of a design asks for a study: its section, or what else does without one. */
static struct dea_location place_of(const struct dea_study *study, const struct dea_design *design)
{
  const struct dea_node *compute = dea_node_find(dea_yaml_root(design->document), "compute");
  const struct dea_node *section =
      study->keys != NULL ? dea_node_find(compute, study->keys->key) : NULL;
  return section != NULL ? section->key_place : design->compute.models[0].location;
}

dea_status dea_study_warn(struct dea_context *ctx, const struct dea_design *design,
                          const struct dea_device *device)
{
  const struct dea_model_type *types[DEA_DESIGN_MODELS_MAX];
  const struct dea_result result = {.design = design, .device = device};
  const size_t count = design->compute.model_count;
  for (size_t i = 0; i < count; i++) {
    types[i] = dea_model_find(design->compute.models[i].text);
    if (types[i] == NULL) {
      return DEA_OK; // an error already
    }
  }
  for (size_t k = 0; k < STUDIES; k++) {
    const bool of_all = studies[k]->asked == NULL && studies[k]->keys == NULL;
    if (!of_all && is_wanted(studies[k], NULL, 0, design) &&
        !is_known_to_some(studies[k], types, count, &result)) {
      struct dea_text text = {.ctx = ctx};
      add_known_to_none(studies[k], types, count, &result, &text);
      dea_status status = dea_finding_add(ctx, DEA_WARNING, place_of(studies[k], design),
                                          "%s (compute.models)", dea_text_get(&text));
      dea_text_free(&text);
      DEA_TRY(ctx, status);
    }
  }
  return DEA_OK;
}

dea_status dea_study_check(struct dea_context *ctx, const char *const names[], size_t name_count,
                           const struct dea_design *design)
{
  for (size_t i = 0; names != NULL && i < name_count; i++) {
    size_t k = 0;
    while (k < STUDIES && strcmp(studies[k]->name, names[i]) != 0) {
      k++;
    }
    if (k == STUDIES) {
      return unknown_name(ctx, names[i]);
    }
    if (studies[k]->needs != NULL && !is_asked(studies[k], design)) {
      return dea_fail(ctx, DEA_E_DESIGN, "the study '%s' needs %s in the design", names[i],
                      studies[k]->needs);
    }
  }
  return DEA_OK;
}

/* Tables of a study, also of one that failed: partial results are results. */
static dea_status build_tables(struct dea_context *ctx, const struct dea_study *study,
                               const char *model, struct dea_result *result)
{
  return study->tables != NULL ? study->tables(ctx, model, result) : DEA_OK;
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
static dea_status build_model(struct dea_context *ctx, const struct dea_model_type *type,
                              bool sweeps, struct dea_result *result, struct dea_model **out)
{
  struct dea_curve *curve;
  dea_status status = dea_model_create(ctx, type, result->design, result->device, out);
  if (sweeps && dea_verdict_of(status)[0] != '\0') {
    DEA_TRY(ctx, dea_result_get_curve(ctx, result, type->name, "sweep", &curve));
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
  static const struct dea_study_services none = {0};
  struct dea_model *model = NULL; // made for the first study that wants it
  DEA_TRY(ctx, dea_study_check(ctx, names, name_count, result->design));
  struct outcome first = {.status = DEA_OK};
  for (size_t i = 0; i < STUDIES; i++) {
    if (!is_wanted(studies[i], names, name_count, result->design)) {
      continue;
    }
    if (!dea_study_known_to(studies[i], type, result)) {
      add_outcome(ctx, report_unknown(ctx, studies[i], type->name, names != NULL), &first);
      continue;
    }
    if (!studies[i]->own_models && model == NULL) {
      const bool sweeps = is_wanted(&dea_study_sweep, names, name_count, result->design);
      DEA_TRY(ctx, build_model(ctx, type, sweeps, result, &model));
    }
    struct dea_model *lent = studies[i]->own_models ? NULL : model;
    dea_status status =
        studies[i]->run != NULL
            ? studies[i]->run(ctx, type, lent, result)
            : studies[i]->run_with(ctx, type, lent, services != NULL ? services : &none, result);
    add_outcome(ctx, status, &first);
    if (status == DEA_E_MEMORY) {
      break;
    }
    status = build_tables(ctx, studies[i], type->name, result);
    add_outcome(ctx, status, &first);
    if (first.status == DEA_E_INTERRUPTED || status == DEA_E_MEMORY) {
      break;
    }
  }
  if (model != NULL) {
    type->destroy(ctx, model);
  }
  bool said = first.status == DEA_OK || strcmp(dea_context_message(ctx), first.message) == 0;
  return said ? first.status : dea_fail(ctx, first.status, "%s", first.message);
}
