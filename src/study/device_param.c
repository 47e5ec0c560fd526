#include "study/device_param.h"

#include "base/units.h"
#include "base/write_file.h"
#include "design/design_schema.h"
#include "design/design_sections.h"
#include "study/numbers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { KEYS_MAX = DEA_DEVICE_PARAMS_MAX * (1 + DEA_DEVICE_TIES_MAX) };

/* The sections of studies that a design was read with. items: room for DEA_DESIGN_SECTIONS_MAX. */
static struct dea_design_sections sections_of(const struct dea_design *design,
                                              const struct dea_design_section **items)
{
  const size_t count = design->compute.settings_count;
  for (size_t i = 0; i < count; i++) {
    items[i] = design->compute.settings[i].section;
  }
  return (struct dea_design_sections){.items = items, .count = count};
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

/* Adds the finding that a name is no parameter; why: NULL where there is no such key. */
static dea_status report_unknown(struct dea_context *ctx,
                                 const struct dea_device_param_source *source,
                                 const struct dea_label *name, const char *why)
{
  const bool plies = source->design->parts != NULL;
  struct dea_design_number *numbers = dea_alloc(ctx, DEA_NUMBERS_MAX, sizeof *numbers);
  const char *known[DEA_NUMBERS_MAX];
  size_t count = 0;
  DEA_TRY_MEMORY(numbers != NULL);
  dea_status status =
      dea_design_numbers(ctx, source->design, source->device, 0, false, numbers, &count);
  for (size_t i = 0; i < count; i++) {
    known[i] = numbers[i].key;
  }
  char hint[DEA_HINT_SIZE];
  if (status == DEA_OK) {
    status =
        dea_finding_add(ctx, DEA_ERROR, name->location, "'%.60s' %s%s", name->text,
                        why != NULL ? why
                        : plies     ? "is no number of a part of the design (plies.NAME.thickness, "
                                      "shapes.NAME.radius)"
                                    : "is no key of the design",
                        dea_name_hint(name->text, known, why == NULL ? count : 0, hint));
  }
  dea_free(ctx, numbers);
  return status;
}

const char *dea_device_param_split_state(char *text)
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
static dea_status parse_value(struct dea_context *ctx, const struct dea_design *design,
                              const struct dea_label *name, const struct dea_field *field,
                              struct dea_device_param *out)
{
  const struct dea_listed *item = find_value(design, name->text);
  if (item == NULL || item->origin == DEA_ABSENT || item->text == NULL) {
    return DEA_OK;
  }
  char text[DEA_TITLE_SIZE], why[DEA_WHY_SIZE] = "";
  snprintf(text, sizeof text, "%.200s", item->text);
  out->state = dea_device_param_split_state(text);
  if (!dea_units_read(ctx, text, (struct dea_measure){field->unit, field->example}, &out->designed,
                      why)) {
    out->designed = NAN; // a list of several, which the caller refuses
    return why[0] == '\0' ? dea_context_status(ctx) : DEA_OK;
  }
  return DEA_OK;
}

static dea_status from_key(struct dea_context *ctx, const struct dea_device_param_source *source,
                           const struct dea_label *name, struct dea_device_param *out, bool *good)
{
  const struct dea_design_section *items[DEA_DESIGN_SECTIONS_MAX];
  const struct dea_design_sections sections = sections_of(source->design, items);
  struct dea_design_schema schema;
  dea_design_schema_fill(&sections, &schema);
  const struct dea_field *field = dea_record_find(&schema.disc.record, name->text, NULL);
  *good = false;
  if (field == NULL) {
    return report_unknown(ctx, source, name, NULL);
  }
  out->whole = field->kind == DEA_FIELD_INTEGER;
  if (!dea_field_varies(field) && !(source->whole && out->whole)) {
    return report_unknown(ctx, source, name,
                          source->whole ? "is no number"
                          : out->whole  ? "is a whole number: only what can change "
                                          "little by little can be fitted"
                                        : "is no number that could be fitted");
  }
  if (strncmp(name->text, "report.", 7) == 0 || strncmp(name->text, "fabrication.", 12) == 0 ||
      strncmp(name->text, "compute.voltage", 15) == 0) {
    return report_unknown(ctx, source, name, "does not change what the device does");
  }
  out->kind = DEA_DEVICE_KEY;
  out->list = field->list_max > 0;
  out->param.unit = field->unit;
  const bool limited = field->min != 0 || field->max != 0;
  out->param.low = limited ? field->min : field->above_min ? 0 : -INFINITY;
  out->param.high = limited && field->max > field->min ? field->max : INFINITY;
  DEA_TRY(ctx, parse_value(ctx, source->design, name, field, out));
  *good = true;
  return DEA_OK;
}

/* A number of a part or of a material. */
static dea_status from_number(struct dea_context *ctx, const struct dea_device_param_source *source,
                              const struct dea_label *name, struct dea_device_param *out,
                              bool *good)
{
  struct dea_design_number *numbers = dea_alloc(ctx, DEA_NUMBERS_MAX, sizeof *numbers);
  size_t count = 0;
  DEA_TRY_MEMORY(numbers != NULL);
  const dea_status status =
      dea_design_numbers(ctx, source->design, source->device, NAN, true, numbers, &count);
  for (size_t i = 0; i < count && status == DEA_OK && !*good; i++) {
    const struct dea_design_number *number = &numbers[i];
    if (number->of != DEA_NUMBER_OF_DESIGN && strcmp(number->key, name->text) == 0) {
      out->kind = number->of == DEA_NUMBER_OF_MATERIAL ? DEA_DEVICE_MATERIAL : DEA_DEVICE_KEY;
      out->material = number->item;
      out->offset = number->offset;
      out->param.unit = number->unit;
      out->param.low = number->low;
      out->param.high = number->high;
      out->designed = number->value;
      *good = true;
    }
  }
  dea_free(ctx, numbers);
  return status;
}

/* Why a name that would be one of the film's material is none; NULL: it would not. */
static const char *none_of_film(const char *name)
{
  static const struct {
    const char *prefix, *why;
  } all[] = {
      {"film.law.", "is no parameter of the law that the film has"},
      {"film.permittivity.", "is none of film.permittivity.at_rest and film.permittivity.slope"},
      {"film.density", "is unknown: the film's material has none"},
      {"film.branch.",
       "is no branch that the film has: film.branch.1.modulus, film.branch.1.time, ..."},
  };
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
    if (strncmp(name, all[i].prefix, strlen(all[i].prefix)) == 0) {
      return all[i].why;
    }
  }
  return NULL;
}

dea_status dea_device_param_find(struct dea_context *ctx,
                                 const struct dea_device_param_source *source,
                                 const struct dea_label *name, struct dea_device_param *out,
                                 bool *good)
{
  out->state = "";
  out->designed = NAN;
  *good = false;
  if (strlen(name->text) >= DEA_FIT_PARAM_NAME) {
    return report_unknown(ctx, source, name, NULL);
  }
  snprintf(out->param.name, sizeof out->param.name, "%.127s", name->text);
  DEA_TRY(ctx, from_number(ctx, source, name, out, good));
  const char *why = *good || source->design->parts != NULL ? NULL : none_of_film(name->text);
  return *good                                          ? DEA_OK
         : why != NULL || source->design->parts != NULL ? report_unknown(ctx, source, name, why)
                                                        : from_key(ctx, source, name, out, good);
}

dea_status dea_device_param_std(struct dea_context *ctx, const struct dea_device_param *param,
                                const struct dea_label *text, double *std, bool *good)
{
  char own[DEA_TITLE_SIZE], example[32], why[DEA_WHY_SIZE] = "";
  const struct dea_measure due = {param->param.unit, example};
  *good = false;
  snprintf(own, sizeof own, "%s", text->text);
  snprintf(example, sizeof example, "2 %.16s", param->param.unit);
  const char *state = dea_device_param_split_state(own);
  if (state[0] != '\0' && strcmp(state, param->state) != 0) {
    return dea_finding_add(ctx, DEA_ERROR, text->location,
                           "%.60s is a length%s in the design: its std has to be one too",
                           param->param.name, param->state);
  }
  if (!dea_units_read(ctx, own, due, std, why)) {
    DEA_TRY(ctx, why[0] == '\0' ? dea_context_status(ctx) : DEA_OK);
    return dea_finding_add(ctx, DEA_ERROR, text->location, "std: %s", why);
  }
  if (!(*std > 0)) {
    return dea_finding_add(ctx, DEA_ERROR, text->location, "a standard uncertainty is more than 0");
  }
  *good = true;
  return DEA_OK;
}

// The device with other values --------------------------------------------------------------------

void dea_device_param_text(const struct dea_device_param *param, double value, int digits,
                           char out[80])
{
  const bool unit = strcmp(param->param.unit, "1") != 0;
  void *before = dea_c_locale_enter();
  snprintf(out, 80, "%s%.*g%s%s%s%s", param->list ? "[" : "", digits, value, unit ? " " : "",
           unit ? param->param.unit : "", param->state, param->list ? "]" : "");
  dea_c_locale_leave(before);
}

void dea_device_param_show(const struct dea_device_param *param, double value, char out[80])
{
  static const struct {
    const char *unit, *shown;
    double least, factor; // of what is shown so
  } units[] = {{"m", "mm", 1e-3, 1e3},
               {"m", "um", 0, 1e6},
               {"Pa", "MPa", 1e6, 1e-6},
               {"Pa", "kPa", 1e3, 1e-3},
               {"V", "kV", 1e3, 1e-3}};
  for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
    if (strcmp(units[i].unit, param->param.unit) == 0 && fabs(value) >= units[i].least) {
      struct dea_device_param other = *param;
      other.param.unit = units[i].shown;
      dea_device_param_text(&other, units[i].factor * value, 6, out);
      return;
    }
  }
  dea_device_param_text(param, value, 6, out);
}

void dea_device_param_set(const struct dea_device_param *param, double value,
                          struct dea_material *material)
{
  if (param->kind == DEA_DEVICE_MATERIAL) {
    memcpy((char *)material + param->offset, &value, sizeof value);
  }
}

const struct dea_device_param *dea_device_param_tie(const struct dea_device_param *param, size_t k)
{
  return k == 0 ? param : k <= param->tie_count ? &param->ties[k - 1] : NULL;
}

dea_status dea_device_params_build(struct dea_context *ctx, const struct dea_design_bytes *file,
                                   const struct dea_device_param *params, size_t count,
                                   const double *p, struct dea_design **design,
                                   struct dea_device **device)
{
  const struct dea_design_section *items[DEA_DESIGN_SECTIONS_MAX];
  const struct dea_design_sections sections = sections_of(file->design, items);
  struct dea_override overrides[KEYS_MAX];
  char texts[KEYS_MAX][80];
  const struct dea_device_param *one;
  size_t keys = 0;
  *design = NULL;
  *device = NULL;
  for (size_t j = 0; j < count; j++) {
    for (size_t k = 0; (one = dea_device_param_tie(&params[j], k)) != NULL && keys < KEYS_MAX;
         k++) {
      if (one->kind == DEA_DEVICE_KEY) {
        dea_device_param_text(one, p[j], 17, texts[keys]);
        overrides[keys] = (struct dea_override){one->param.name, texts[keys]};
        keys++;
      }
    }
  }
  DEA_TRY(ctx, dea_design_read_memory_with(ctx, &sections, file->design->file, file->bytes,
                                           file->length, overrides, keys, design));
  DEA_TRY(ctx, dea_device_build(ctx, *design, device));
  for (size_t j = 0; j < count; j++) {
    for (size_t k = 0; (one = dea_device_param_tie(&params[j], k)) != NULL; k++) {
      dea_device_param_set(one, p[j], dea_material_at(*device, one->material));
    }
  }
  return DEA_CHAIN(ctx, (*design)->parts != NULL ? dea_device_find_disc(ctx, *device) : DEA_OK);
}
