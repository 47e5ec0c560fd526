/* Parameters of a fit of a device: keys of its design that are numbers, with their unit, limits and
 * the design's value, and those of the film's material. */
#include "job/device_fit_model.h"

#include "base/units.h"
#include "material/catalogue.h"
#include "study/design_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char law_prefix[] = "film.law.", permittivity_prefix[] = "film.permittivity.";
static const char *const permittivity_keys[] = {"at_rest", "slope"};

struct work {
  struct dea_context *ctx;
  const struct dea_design *design;
  const struct dea_device *device;
  struct dea_design_schema schema;
};

static bool is_number(const struct dea_field *field)
{
  return field->kind == DEA_FIELD_NUMBER || field->kind == DEA_FIELD_INPLANE ||
         field->kind == DEA_FIELD_STRETCHED;
}

/* The field of a dotted key; NULL: none. */
static const struct dea_field *find_field(const struct dea_record *record, const char *key)
{
  const struct dea_field *found = NULL;
  while (record != NULL) {
    const size_t length = strcspn(key, ".");
    found = NULL;
    for (size_t i = 0; i < record->field_count && found == NULL; i++) {
      const struct dea_field *field = &record->fields[i];
      found = strlen(field->key) == length && memcmp(field->key, key, length) == 0 ? field : NULL;
    }
    if (found == NULL || key[length] == '\0') {
      return found;
    }
    record = dea_field_has_record(found) && found->list_max == 0 ? found->record : NULL;
    key += length + 1;
  }
  return NULL;
}

static const struct dea_listed *find_value(const struct dea_design *design, const char *key)
{
  const size_t length = strlen(key);
  for (size_t i = 0; i < design->values.count; i++) {
    const struct dea_listed *item = &design->values.items[i];
    const bool same = strncmp(item->path, key, length) == 0;
    if (same && (item->path[length] == '\0' || strcmp(item->path + length, "[0]") == 0)) {
      return item;
    }
  }
  return NULL;
}

/* A name that is no parameter. */
static dea_status unknown(struct work *w, const struct dea_label *name, const char *why)
{
  const char *known[256];
  size_t count = 0;
  for (size_t i = 0; i < w->design->values.count && count < 256; i++) {
    const struct dea_field *field =
        find_field(&w->schema.disc.record, w->design->values.items[i].path);
    if (field != NULL && is_number(field)) {
      known[count++] = w->design->values.items[i].path;
    }
  }
  const char *nearest = why == NULL ? dea_nearest_name(name->text, known, count) : NULL;
  return dea_finding_add(w->ctx, DEA_ERROR, name->location, "'%.60s' %s%s%s%s", name->text,
                         why != NULL ? why : "is no key of the design",
                         nearest != NULL ? "; did you mean '" : "", nearest != NULL ? nearest : "",
                         nearest != NULL ? "'?" : "");
}

/* Takes " stretched" or " unstretched" off the end of a text. */
static const char *take_state(char *text)
{
  static const char *const states[] = {" stretched", " unstretched"};
  for (size_t k = 0; k < 2; k++) {
    const size_t length = strlen(text), end = strlen(states[k]);
    if (length > end && strcmp(text + length - end, states[k]) == 0) {
      text[length - end] = '\0';
      return states[k];
    }
  }
  return "";
}

/* The design's value, as it stands there. */
static dea_status take_value(struct work *w, const struct dea_label *name,
                             const struct dea_field *field, struct dea_device_param *out)
{
  const struct dea_listed *item = find_value(w->design, name->text);
  if (item == NULL || item->origin == DEA_ABSENT || item->text == NULL) {
    return DEA_OK;
  }
  char text[DEA_TITLE_SIZE], why[DEA_WHY_SIZE] = "";
  snprintf(text, sizeof text, "%.200s", item->text);
  out->state = take_state(text);
  if (!dea_units_read(w->ctx, text, (struct dea_measure){field->unit, field->example},
                      &out->designed, why)) {
    out->designed = NAN; // a list of several, which the caller refuses
    return why[0] == '\0' ? dea_context_status(w->ctx) : DEA_OK;
  }
  return DEA_OK;
}

static dea_status from_key(struct work *w, const struct dea_label *name,
                           struct dea_device_param *out, bool *good)
{
  const struct dea_field *field = find_field(&w->schema.disc.record, name->text);
  *good = false;
  if (field == NULL) {
    return unknown(w, name, NULL);
  }
  if (!is_number(field)) {
    return unknown(w, name,
                   field->kind == DEA_FIELD_INTEGER ? "is a whole number: only what can change "
                                                      "little by little can be fitted"
                                                    : "is no number that could be fitted");
  }
  if (strncmp(name->text, "report.", 7) == 0 || strncmp(name->text, "fabrication.", 12) == 0 ||
      strncmp(name->text, "compute.voltage", 15) == 0) {
    return unknown(w, name, "does not change what the device does");
  }
  out->kind = DEA_DEVICE_KEY;
  out->list = field->list_max > 0;
  out->param.unit = field->unit;
  const bool limited = field->min != 0 || field->max != 0;
  out->param.low = limited ? field->min : field->above_min ? 0 : -INFINITY;
  out->param.high = limited && field->max > field->min ? field->max : INFINITY;
  DEA_TRY(w->ctx, take_value(w, name, field, out));
  *good = true;
  return DEA_OK;
}

static dea_status from_material(struct work *w, const struct dea_label *name,
                                struct dea_device_param *out, bool *good)
{
  const struct dea_material *film = &w->device->film;
  *good = true;
  if (strncmp(name->text, law_prefix, strlen(law_prefix)) == 0) {
    const char *key = name->text + strlen(law_prefix);
    for (size_t i = 0; i < film->law->param_count; i++) {
      const struct dea_law_param *param = &film->law->params[i];
      if (strcmp(param->key, key) == 0) {
        out->kind = DEA_DEVICE_LAW;
        out->index = i;
        out->param.unit = param->unit;
        out->param.low = param->min;
        out->param.high = param->max;
        out->designed = film->param[i];
        return DEA_OK;
      }
    }
    *good = false;
    return unknown(w, name, "is no parameter of the law that the film has");
  }
  const char *key = name->text + strlen(permittivity_prefix);
  for (size_t i = 0; i < 2; i++) {
    if (strcmp(key, permittivity_keys[i]) == 0) {
      out->kind = DEA_DEVICE_PERMITTIVITY;
      out->index = i;
      out->param.unit = "1";
      out->param.low = i == 0 ? 1 : -INFINITY;
      out->param.high = INFINITY;
      out->designed = i == 0 ? film->permittivity.at_rest : film->permittivity.slope;
      return DEA_OK;
    }
  }
  *good = false;
  return unknown(w, name, "is none of film.permittivity.at_rest and film.permittivity.slope");
}

// Priors ------------------------------------------------------------------------------------------

/* What a material of the catalogue says of a parameter; NAN where it says nothing. */
static void look_up(const struct dea_material_data *data, const struct dea_device_param *param,
                    const struct dea_law *law, double *value, double *std)
{
  *value = *std = NAN;
  if (param->kind == DEA_DEVICE_LAW) {
    for (size_t i = 0; i < data->law_count; i++) {
      if (data->laws[i].law == law) {
        *value = data->laws[i].param[param->index].si;
        *std = data->laws[i].param_std[param->index].si;
        return;
      }
    }
  } else if (param->kind == DEA_DEVICE_PERMITTIVITY && data->permittivity_count > 0) {
    const struct dea_permittivity_set *set = &data->permittivity[0];
    *value = param->index == 0 ? set->at_rest.si : set->slope.si;
  }
}

/* Puts numbers in the place of the name of a material. */
static dea_status prior_of_material(struct work *w, struct dea_fit_parameter_text *text,
                                    struct dea_device_param *out)
{
  struct dea_catalogue_entry *entry;
  double value, std;
  DEA_TRY(w->ctx, dea_catalogue_read(w->ctx, text->prior.text, text->prior.location, &entry));
  look_up(&entry->data, out, w->device->film.law, &value, &std);
  dea_catalogue_destroy(w->ctx, entry);
  snprintf(out->prior_of, sizeof out->prior_of, "%.63s", text->prior.text);
  const bool unit = strcmp(out->param.unit, "1") != 0;
  if (isnan(value)) {
    DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_ERROR, text->prior.location,
                                    "the material '%.40s' says nothing of %s", text->prior.text,
                                    out->param.name));
  } else if (text->prior_std.text[0] == '\0' && isnan(std)) {
    DEA_TRY(w->ctx,
            dea_finding_add(w->ctx, DEA_ERROR, text->prior.location,
                            "the material '%.40s' gives no uncertainty of %s: say one (prior_std)",
                            text->prior.text, out->param.name));
  }
  snprintf(text->prior.text, sizeof text->prior.text, "%.17g%s%s", value, unit ? " " : "",
           unit ? out->param.unit : "");
  if (text->prior_std.text[0] == '\0' && !isnan(std)) {
    snprintf(text->prior_std.text, sizeof text->prior_std.text, "%.17g%s%s", std, unit ? " " : "",
             unit ? out->param.unit : "");
  }
  return DEA_OK;
}

/* A prior that begins with a letter names a material. */
static bool names_material(const struct dea_label *prior)
{
  const char c = prior->text[0];
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

// All of it ---------------------------------------------------------------------------------------

/* Start and scale, once bounds and priors are known. */
static dea_status settle(struct work *w, const struct dea_fit_parameter_text *text,
                         bool start_given, struct dea_device_param *out)
{
  struct dea_fit_param *param = &out->param;
  char shown[80];
  if (!(param->start >= param->low && param->start <= param->high)) {
    dea_device_param_text(out, param->start, 6, shown);
    return dea_finding_add(w->ctx, DEA_ERROR,
                           start_given ? text->start.location : text->name.location,
                           "%s starts at %.40s, outside of its bounds %.6g and %.6g %s",
                           param->name, shown, param->low, param->high, param->unit);
  }
  const bool bounded = text->low.text[0] != '\0' && text->high.text[0] != '\0';
  param->scale = fabs(param->start);
  if (bounded && param->scale < 0.25 * (param->high - param->low)) {
    param->scale = 0.25 * (param->high - param->low);
  }
  if (param->scale == 0) {
    return dea_finding_add(w->ctx, DEA_ERROR, text->name.location,
                           "%s starts at 0, which does not say what a large change is: give low "
                           "and high",
                           param->name);
  }
  return DEA_OK;
}

static dea_status make_one(struct work *w, const struct dea_fit_parameter_text *asked,
                           struct dea_device_param *out)
{
  struct dea_fit_parameter_text text = *asked;
  const char *name = text.name.text;
  bool good;
  *out = (struct dea_device_param){.state = "", .designed = NAN};
  out->param = (struct dea_fit_param){.start = NAN, .prior = NAN, .prior_std = NAN};
  if (strlen(name) >= DEA_FIT_PARAM_NAME) {
    return unknown(w, &text.name, NULL);
  }
  snprintf(out->param.name, sizeof out->param.name, "%.39s", name);
  const bool of_material = strncmp(name, law_prefix, strlen(law_prefix)) == 0 ||
                           strncmp(name, permittivity_prefix, strlen(permittivity_prefix)) == 0;
  DEA_TRY(w->ctx, of_material ? from_material(w, &text.name, out, &good)
                              : from_key(w, &text.name, out, &good));
  if (!good) {
    return DEA_OK;
  }
  struct dea_label *labels[] = {&text.start, &text.low, &text.high, &text.prior};
  for (size_t k = 0; k < 4; k++) { // all of them in the state of the design's value
    const char *state = take_state(labels[k]->text);
    out->state = out->state[0] == '\0' ? state : out->state;
    if (state[0] != '\0' && strcmp(state, out->state) != 0) {
      return dea_finding_add(w->ctx, DEA_ERROR, labels[k]->location,
                             "%s is a length%s in the design: write it so here too", name,
                             out->state);
    }
  }
  if (names_material(&text.prior)) {
    DEA_TRY(w->ctx, prior_of_material(w, &text, out));
  }
  const bool start_given = text.start.text[0] != '\0';
  if (!start_given && isnan(out->designed)) {
    return dea_finding_add(w->ctx, DEA_ERROR, text.name.location,
                           "the design has no single value of %s: give a start", name);
  }
  if (!start_given) {
    const bool unit = strcmp(out->param.unit, "1") != 0;
    snprintf(text.start.text, sizeof text.start.text, "%.17g%s%s", out->designed, unit ? " " : "",
             unit ? out->param.unit : "");
  }
  const size_t errors = dea_finding_count(w->ctx, DEA_ERROR);
  DEA_TRY(w->ctx, dea_fit_param_take(w->ctx, &text, &out->param));
  return dea_finding_count(w->ctx, DEA_ERROR) == errors ? settle(w, &text, start_given, out)
                                                        : DEA_OK;
}

dea_status dea_device_params_make(struct dea_context *ctx, const struct dea_device_file *file,
                                  const struct dea_design *design, const struct dea_device *device,
                                  struct dea_device_param *out)
{
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  struct work w = {.ctx = ctx, .design = design, .device = device};
  dea_design_file_schema(&w.schema);
  for (size_t k = 0; k < file->parameter_count; k++) {
    DEA_TRY(ctx, make_one(&w, &file->parameters[k], &out[k]));
  }
  return dea_finding_count(ctx, DEA_ERROR) == errors
             ? DEA_OK
             : dea_fail(ctx, DEA_E_DESIGN, "the parameters of '%s' have errors", file->head.file);
}
