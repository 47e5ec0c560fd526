/* Parameters that dea fit has found as variables of an exploration (key `from_fit`). */
#include "explore/design_space.h"

#include "base/file.h"
#include "base/text.h"
#include "base/write_file.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

enum { FILE_MAX = 100000000 };

struct work {
  struct dea_context *ctx;
  struct dea_device_param_source source;
  struct dea_explore_file *file;
  const struct dea_label *at; // from_fit
  const json_t *root;
  size_t row[DEA_DEVICE_PARAMS_MAX]; // of the fit, of each variable
  bool known[DEA_DEVICE_PARAMS_MAX]; // whether it scatters as the fit says
  size_t branches;                   // of the fit so far that the material written has
  bool wanted;                       // whether the last of them is one: its modulus is above 0
};

// One parameter -----------------------------------------------------------------------------------

static const char *text_of(const json_t *object, const char *key)
{
  const char *text = json_string_value(json_object_get(object, key));
  return text != NULL ? text : "";
}

/* Value and unit as files have them; state: " stretched", or "". */
static void write_number(const json_t *object, const char *key, const char *state,
                         const struct dea_label *at, struct dea_label *out)
{
  const char *unit = text_of(object, "unit");
  const bool bare = unit[0] == '\0' || strcmp(unit, "1") == 0;
  out->origin = DEA_GIVEN;
  out->location = at->location;
  snprintf(out->text, sizeof out->text, "%.17g%s%.40s%.16s",
           json_number_value(json_object_get(object, key)), bare ? "" : " ", bare ? "" : unit,
           state);
}

/* Whether the file says of a variable how it is spread, which the fit says too. */
static bool says_spread(const struct dea_explore_variable *variable)
{
  return variable->value_count > 0 || variable->steps.origin == DEA_GIVEN ||
         variable->distribution.origin == DEA_GIVEN || variable->text.prior.text[0] != '\0' ||
         variable->text.prior_std.text[0] != '\0' || variable->scatter.text[0] != '\0';
}

/* The variable of the file with this name, else a new one. NULL: there is no room. */
static struct dea_explore_variable *find_variable(struct work *w, const char *name)
{
  struct dea_explore_file *file = w->file;
  for (size_t j = 0; j < file->variable_count; j++) {
    if (strcmp(file->variables[j].text.name.text, name) == 0) {
      return &file->variables[j];
    }
  }
  if (file->variable_count == DEA_DEVICE_PARAMS_MAX) {
    return NULL;
  }
  struct dea_explore_variable *variable = &file->variables[file->variable_count++];
  variable->text.name = *w->at;
  snprintf(variable->text.name.text, sizeof variable->text.name.text, "%.80s", name);
  return variable;
}

/* Gives a variable the fit's value and standard uncertainty: of a sweep a normal distribution, of a
 * search a scatter. */
static void spread(const struct work *w, const json_t *row, const char *state,
                   struct dea_explore_variable *variable)
{
  static const char std[] = "standard_uncertainty";
  const bool range = variable->text.low.text[0] != '\0' || variable->text.high.text[0] != '\0';
  variable->distribution.value = DEA_NORMAL;
  if (w->file->objective_count > 0) {
    write_number(row, std, "", w->at, &variable->scatter);
    if (!range) {
      write_number(row, "value", state, w->at, &variable->values[variable->value_count++]);
    }
  } else {
    write_number(row, "value", state, w->at, &variable->text.prior);
    write_number(row, std, "", w->at, &variable->text.prior_std);
  }
  if (variable->text.start.text[0] == '\0' && !(w->file->objective_count > 0 && range)) {
    write_number(row, "value", state, w->at, &variable->text.start);
  }
}

/* Whether a row of the fit has what a parameter has, and the design a number of that name. */
static dea_status check_row(const struct work *w, const json_t *row, const char *name, bool *good)
{
  struct dea_label label = *w->at;
  struct dea_device_param param = {.state = ""};
  *good = false;
  if (name[0] == '\0' || !json_is_number(json_object_get(row, "value"))) {
    return dea_finding_add(w->ctx, DEA_ERROR, w->at->location,
                           "'%.120s' is no result of dea fit: a parameter has no name or value",
                           w->at->text);
  }
  snprintf(label.text, sizeof label.text, "%.80s", name);
  const size_t before = dea_finding_trial_begin(w->ctx);
  const dea_status status = dea_device_param_find(w->ctx, &w->source, &label, &param, good);
  dea_finding_trial_end(w->ctx, before);
  DEA_TRY(w->ctx, status);
  return *good ? DEA_OK
               : dea_finding_add(w->ctx, DEA_ERROR, w->at->location,
                                 "'%.80s', which '%.80s' has fitted, is no number of the design",
                                 name, w->at->text);
}

/* Name of a parameter in the design; prefix: of those of a law, "" of a device's. Empty: of a
 * branch that the data did not want, or of any where the film has none. */
static void find_name(struct work *w, const json_t *row, const char *prefix, char name[128])
{
  const char *own = text_of(row, "name");
  const bool modulus = strncmp(own, "modulus ", 8) == 0, time = strncmp(own, "time ", 5) == 0;
  snprintf(name, 128, "%s%.80s", prefix, own);
  if (prefix[0] == '\0' || !(modulus || time)) {
    return;
  }
  if (modulus) {
    w->wanted = json_number_value(json_object_get(row, "value")) > 0;
    w->branches += w->wanted ? 1U : 0U;
  }
  if (w->wanted && w->source.device->film.branch_count > 0) {
    snprintf(name, 128, "film.branch.%zu.%s", w->branches, modulus ? "modulus" : "time");
  } else {
    name[0] = '\0';
  }
}

static dea_status read_row(struct work *w, size_t i, const json_t *row, const char *prefix)
{
  char name[128], state[24];
  bool good;
  find_name(w, row, prefix, name);
  if (name[0] == '\0' && prefix[0] != '\0') {
    return DEA_OK;
  }
  DEA_TRY(w->ctx, check_row(w, row, name, &good));
  if (!good) {
    return DEA_OK;
  }
  const char *film = text_of(row, "film");
  snprintf(state, sizeof state, "%s%.14s", film[0] != '\0' ? " " : "", film);
  const size_t before = w->file->variable_count;
  struct dea_explore_variable *variable = find_variable(w, name);
  if (variable == NULL) {
    return dea_finding_add(w->ctx, DEA_ERROR, w->at->location,
                           "more than %d variables with those of '%.80s'", DEA_DEVICE_PARAMS_MAX,
                           w->at->text);
  }
  const size_t j = (size_t)(variable - w->file->variables);
  const bool fixed = json_is_true(json_object_get(row, "fixed"));
  w->known[j] = !fixed && !json_is_true(json_object_get(row, "at_bound")) &&
                json_number_value(json_object_get(row, "standard_uncertainty")) > 0;
  w->row[j] = i;
  if (w->known[j] && says_spread(variable)) {
    return dea_finding_add(w->ctx, DEA_ERROR, variable->text.name.location,
                           "%s: how it is spread says '%.80s'; give no more than low and high",
                           name, w->at->text);
  }
  if (w->known[j]) {
    spread(w, row, state, variable);
  } else if (w->file->variable_count > before) {
    write_number(row, "value", state, w->at, &variable->values[variable->value_count++]);
    variable->text.start = variable->values[0];
    if (!fixed) {
      return dea_finding_add(w->ctx, DEA_WARNING, w->at->location,
                             "'%.80s' does not know how well %s is known: it keeps its value",
                             w->at->text, name);
    }
  }
  return DEA_OK;
}

// All of them -------------------------------------------------------------------------------------

/* What stands before the names of a fit's parameters: those of a material are of its law. */
static dea_status find_prefix(const struct work *w, const char **prefix)
{
  const char *law = text_of(w->root, "law");
  const struct dea_law *own = w->source.device->film.law;
  *prefix = law[0] != '\0' ? "film.law." : "";
  return law[0] == '\0' || (own != NULL && strcmp(own->name, law) == 0)
             ? DEA_OK
             : dea_finding_add(w->ctx, DEA_ERROR, w->at->location,
                               "'%.80s' is a fit of the law %.40s; the film has %.40s", w->at->text,
                               law, own != NULL ? own->name : "none");
}

/* Correlations of the variables: those of the fit among its own, none of others. */
static dea_status read_correlations(struct work *w)
{
  const json_t *rows = json_object_get(w->root, "correlations");
  struct dea_explore_file *file = w->file;
  size_t next = 0, known = 0;
  for (size_t j = 0; j < file->variable_count; j++) {
    known += w->known[j] ? 1U : 0U;
    for (size_t k = 0; k < j; k++) {
      const json_t *one = json_array_get(json_array_get(rows, w->row[j]), w->row[k]);
      const bool both = w->known[j] && w->known[k];
      if (both && !json_is_number(one)) {
        return dea_finding_add(w->ctx, DEA_ERROR, w->at->location,
                               "'%.120s' is no result of dea fit: correlations are missing",
                               w->at->text);
      }
      file->correlations[next++] =
          (struct dea_quantity){both ? json_number_value(one) : 0, DEA_GIVEN, w->at->location};
    }
  }
  file->correlation_count = known > 1 ? next : 0;
  return dea_explore_correlations_check(w->ctx, file);
}

static dea_status read_all(struct work *w)
{
  const json_t *rows = json_object_get(w->root, "parameters");
  const size_t errors = dea_finding_count(w->ctx, DEA_ERROR);
  const char *prefix;
  DEA_TRY(w->ctx, find_prefix(w, &prefix));
  for (size_t i = 0; i < json_array_size(rows); i++) {
    if (dea_finding_count(w->ctx, DEA_ERROR) == errors || prefix[0] == '\0') {
      DEA_TRY(w->ctx, read_row(w, i, json_array_get(rows, i), prefix));
    }
  }
  return dea_finding_count(w->ctx, DEA_ERROR) == errors ? read_correlations(w) : DEA_OK;
}

static dea_status read_fit(struct work *w, json_t **out)
{
  char *bytes = NULL, *beside = dea_path_beside(w->ctx, w->file->head.file, w->at->text);
  char path[DEA_PATH_SIZE];
  size_t count = 0;
  DEA_TRY_MEMORY(beside != NULL);
  const bool is_file = dea_text_ends_with(w->at->text, ".json");
  dea_status status = dea_path_build(w->ctx, beside, "fit.json", path);
  status = status == DEA_OK
               ? dea_file_read(w->ctx, is_file ? beside : path, FILE_MAX, &bytes, &count)
               : status;
  dea_free(w->ctx, beside);
  if (status == DEA_E_IO) {
    DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_ERROR, w->at->location, "from_fit: %s",
                                    dea_context_message(w->ctx)));
    dea_context_clear(w->ctx);
    return DEA_OK;
  }
  DEA_TRY(w->ctx, status);
  *out = json_loadb(bytes, count, 0, NULL);
  dea_free(w->ctx, bytes);
  if (json_is_array(json_object_get(*out, "parameters"))) {
    return DEA_OK;
  }
  json_decref(*out);
  *out = NULL;
  return dea_finding_add(w->ctx, DEA_ERROR, w->at->location, "'%.120s' is no result of dea fit",
                         w->at->text);
}

dea_status dea_from_fit_read(struct dea_context *ctx, const struct dea_design *design,
                             const struct dea_device *device, struct dea_explore_file *io)
{
  struct work w = {.ctx = ctx, .source = {design, device, .whole = true}, .file = io};
  json_t *root = NULL;
  w.at = &io->from_fit;
  if (w.at->text[0] == '\0') {
    return DEA_OK;
  }
  DEA_TRY(ctx, read_fit(&w, &root));
  w.root = root;
  const dea_status status = root != NULL ? read_all(&w) : DEA_OK;
  json_decref(root);
  return status;
}
