/* A schema's table as JSON Schema, for editors: what it refuses `dea check` refuses too, and as
 * much of what that refuses as the words of a schema can say. */
#include "base/schema.h"

#include "base/units.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT_SIZE = 256, NAME_SIZE = 48 };

/* One schema being made. */
struct maker {
  struct dea_context *ctx;
  json_t *units; // "$defs": what a number in each unit that is due may look like
  dea_status status;
};

static json_t *record_json(struct maker *maker, const struct dea_record *record);

// Numbers ----------------------------------------------------------------------------------------

/* Units that people write, of all dimensions. Where one does not convert to the unit due, it is
 * refused; others, since udunits2 knows thousands, are left to the reader. */
static const char *const written[] = {
    "m",      "cm",     "mm",     "um",   "\302\265m",  "nm",   "km",    "inch",  "m^2",  "cm^2",
    "mm^2",   "m^3",    "V",      "mV",   "kV",         "MV",   "V/m",   "kV/mm", "V/um", "MV/m",
    "V/s",    "kV/s",   "V/us",   "Pa",   "kPa",        "MPa",  "GPa",   "mbar",  "bar",  "kg/m^3",
    "g/cm^3", "radian", "degree", "deg",  "s",          "ms",   "us",    "min",   "h",    "Hz",
    "kHz",    "MHz",    "N",      "uN",   "mN",         "kN",   "N/m",   "mN/m",  "N/mm", "N/s",
    "mN/s",   "N.m",    "N m",    "mN.m", "uN.m",       "kg",   "g",     "mg",    "A",    "mA",
    "uA",     "nA",     "K",      "degC", "J",          "mJ",   "uJ",    "F",     "pF",   "nF",
    "C",      "nC",     "pC",     "ohm",  "kohm",       "Mohm", "ohm m", "ohm.m", "m/s",  "mm/s",
    "um/s",   "1/s",    "s^-1",   "W",    "N.m/radian", "%",    "V/V"};
enum { WRITTEN = sizeof written / sizeof written[0] };

static const char number_pattern[] = "(?:[0-9]+\\.?[0-9]*|\\.[0-9]+)(?:[eE][-+]?[0-9]+)?";

/* Adds a unit as a regular expression that means it. */
static void add_literal(struct dea_text *out, const char *text)
{
  for (; *text != '\0'; text++) {
    dea_text_add(out, strchr("^.$*+?()[]{}|\\", *text) != NULL ? "\\%c" : "%c", *text);
  }
}

/* "V/m" as the name of a definition. */
static void name_unit(const char *unit, char out[NAME_SIZE])
{
  size_t n = 0;
  for (; *unit != '\0' && n + 8 < NAME_SIZE; unit++) {
    n += (size_t)snprintf(out + n, NAME_SIZE - n, *unit == '/' ? "_per_" : "%c",
                          strchr("^-. ", *unit) != NULL ? '_' : *unit);
  }
  out[n] = '\0';
}

/* A number and a unit that is none of those of other dimensions. */
static dea_status define_unit(struct maker *maker, const char *unit, const char *name)
{
  struct dea_text pattern = {.ctx = maker->ctx};
  dea_text_add(&pattern, "^[-+]?%s[ \\t]*(?!(?:", number_pattern);
  bool any = false;
  for (size_t i = 0; i < WRITTEN; i++) {
    char text[NAME_SIZE], why[DEA_WHY_SIZE];
    double si;
    snprintf(text, sizeof text, "1 %s", written[i]);
    if (!dea_units_read(maker->ctx, text, (struct dea_measure){unit, "1"}, &si, why)) {
      if (why[0] == '\0') {
        dea_text_free(&pattern);
        return dea_context_status(maker->ctx);
      }
      dea_text_add(&pattern, "%s", any ? "|" : "");
      add_literal(&pattern, written[i]);
      any = true;
    }
  }
  dea_text_add(&pattern, ")(?:[ \\t]+(?:un)?stretched)?[ \\t]*$)[^ \\t0-9].*$");
  if (!pattern.failed) {
    json_object_set_new(maker->units, name,
                        json_pack("{s:s, s:s}", "type", "string", "pattern", pattern.data));
  }
  return dea_text_free(&pattern);
}

/* Pattern of what a limit at 0 says of a number's first signs, "" for nothing: 0 degC is above. */
static const char *sign_pattern(const struct dea_field *field)
{
  bool lower, upper;
  dea_field_limits(field, &lower, &upper);
  if (!lower || field->min < 0 || (field->unit != NULL && strcmp(field->unit, "K") == 0)) {
    return "";
  }
  return field->min > 0 || field->above_min ? "^\\+?(?=[0-9.]*[1-9])[0-9.]" : "^\\+?[0-9.]";
}

/* A number with a unit: text. */
static json_t *measured_json(struct maker *maker, const struct dea_field *field)
{
  char name[NAME_SIZE], reference[NAME_SIZE + 16];
  name_unit(field->unit, name);
  if (json_object_get(maker->units, name) == NULL && maker->status == DEA_OK) {
    maker->status = define_unit(maker, field->unit, name);
  }
  snprintf(reference, sizeof reference, "#/$defs/%s", name);
  const char *sign = sign_pattern(field);
  const char *end = field->kind == DEA_FIELD_INPLANE ? "[ \t](?:un)?stretched$"
                    : field->kind == DEA_FIELD_STRETCHED
                        ? "^(?!.*unstretched)" // the word is not needed
                        : "^(?!.*stretched)";
  json_t *all = json_pack("[{s:s}, {s:s}]", "$ref", reference, "pattern", end);
  if (*sign != '\0') {
    json_array_append_new(all, json_pack("{s:s}", "pattern", sign));
  }
  return json_pack("{s:o}", "allOf", all);
}

static json_t *bare_json(const struct dea_field *field)
{
  json_t *json =
      json_pack("{s:s}", "type", field->kind == DEA_FIELD_INTEGER ? "integer" : "number");
  bool lower, upper;
  dea_field_limits(field, &lower, &upper);
  if (json != NULL && lower && isfinite(field->min)) {
    json_object_set_new(json, field->above_min ? "exclusiveMinimum" : "minimum",
                        json_real(field->min));
  }
  if (json != NULL && upper && isfinite(field->max)) {
    json_object_set_new(json, field->below_max ? "exclusiveMaximum" : "maximum",
                        json_real(field->max));
  }
  return json;
}

/* A number; where its unit is 1 a bare one, or one with the unit of the example. */
static json_t *number_json(struct maker *maker, const struct dea_field *field)
{
  if (strcmp(field->unit, "1") != 0) {
    return measured_json(maker, field);
  }
  size_t length = 0;
  const char *example = field->example != NULL ? dea_units_shown(field->example, &length) : "";
  char unit[NAME_SIZE];
  snprintf(unit, sizeof unit, "%.*s", (int)length, example);
  if (*unit == '\0') {
    return bare_json(field);
  }
  struct dea_text pattern = {.ctx = maker->ctx};
  dea_text_add(&pattern, "^[-+]?%s[ \\t]*", number_pattern);
  add_literal(&pattern, unit);
  dea_text_add(&pattern, "$");
  json_t *json = pattern.failed ? NULL
                                : json_pack("{s:[o, {s:s, s:s, s:[{s:s}]}]}", "anyOf",
                                            bare_json(field), "type", "string", "pattern",
                                            pattern.data, "allOf", "pattern", sign_pattern(field));
  dea_text_free(&pattern);
  return json;
}

// Fields -----------------------------------------------------------------------------------------

static json_t *choice_json(const struct dea_field *field)
{
  json_t *values = json_array();
  for (size_t i = 0; field->choices[i] != NULL; i++) {
    json_array_append_new(values, json_string(field->choices[i]));
  }
  return json_pack("{s:o}", "enum", values);
}

/* One of several tables, told apart by the key "kind". */
static json_t *kinds_json(struct maker *maker, const struct dea_field *field)
{
  json_t *any = json_array();
  for (size_t k = 0; field->kinds[k] != NULL; k++) {
    json_t *record = record_json(maker, field->kinds[k]);
    json_t *properties = json_object_get(record, "properties");
    json_object_set_new(properties, "kind", json_pack("{s:s}", "const", field->kinds[k]->name));
    json_array_append_new(any, record);
  }
  return json_pack("{s:s, s:o}", "type", "object", "oneOf", any);
}

static json_t *value_json(struct maker *maker, const struct dea_field *field)
{
  switch (field->kind) {
  case DEA_FIELD_RECORD:
  case DEA_FIELD_SETTINGS:
    return record_json(maker, field->record);
  case DEA_FIELD_SECTION:
    return field->kinds != NULL ? kinds_json(maker, field) : json_pack("{s:s}", "type", "object");
  case DEA_FIELD_CHOICE:
    return choice_json(field);
  case DEA_FIELD_ROWS:
    return json_pack("{s:s, s:{s:s}}", "type", "array", "items", "type", "array");
  case DEA_FIELD_LABEL: // a number is read as text
    return field->or_section ? json_pack("{s:[ssss], s:i}", "type", "string", "number", "boolean",
                                         "object", "maxLength", DEA_TITLE_SIZE - 1)
                             : json_pack("{s:[sss], s:i}", "type", "string", "number", "boolean",
                                         "maxLength", DEA_TITLE_SIZE - 1);
  case DEA_FIELD_TEXT:
    return json_pack("{s:[sss]}", "type", "string", "number", "boolean");
  case DEA_FIELD_NUMBER:
  case DEA_FIELD_INTEGER:
  case DEA_FIELD_INPLANE:
  case DEA_FIELD_STRETCHED:
    return number_json(maker, field);
  }
  return NULL;
}

static json_t *field_json(struct maker *maker, const struct dea_field *field)
{
  json_t *json = value_json(maker, field);
  if (field->list_max > 0) {
    json_t *one = field->lone ? json_incref(json) : NULL;
    json = json_pack("{s:s, s:o, s:I, s:I}", "type", "array", "items", json, "minItems",
                     (json_int_t)field->list_min, "maxItems", (json_int_t)field->list_max);
    if (one != NULL) {
      json = json_pack("{s:[oo]}", "anyOf", one, json);
    }
  }
  json_object_set_new(json, "description", json_string(field->doc));
  if (field->default_text != NULL) {
    char text[TEXT_SIZE];
    snprintf(text, sizeof text, "%s; default: %s", field->doc, field->default_text);
    json_object_set_new(json, "description", json_string(text));
  }
  return json;
}

/* {"not": {"required": [a, b]}} for two keys that exclude each other. */
static void exclude(json_t *all, const char *a, const char *b)
{
  json_array_append_new(all, json_pack("{s:{s:[ss]}}", "not", "required", a, b));
}

/* Both words of a key, the older one NULL where it has none. */
static void words_of(const struct dea_field *field, const char *out[2])
{
  out[0] = field->key;
  out[1] = field->alias;
}

/* What is said of keys together: pairs that exclude each other, and the groups of which one key
 * must be there, as {"anyOf": [{"required": [a]}, ...]}. */
static json_t *groups_json(const struct dea_record *record)
{
  json_t *all = json_array();
  for (size_t i = 0; i < record->field_count; i++) {
    const struct dea_field *a = &record->fields[i];
    const char *own[2], *other[2];
    words_of(a, own);
    json_t *any = a->required && (a->group > 0 || a->alias != NULL) ? json_array() : NULL;
    for (size_t j = 0; j < record->field_count; j++) {
      const struct dea_field *b = &record->fields[j];
      bool grouped = b == a || (a->group > 0 && b->group == a->group);
      words_of(b, other);
      for (int k = 0; k < 4 && grouped && j >= i; k++) {
        bool both = own[k / 2] != NULL && other[k % 2] != NULL;
        if (both && (b == a ? k == 1 : b->option != a->option)) {
          exclude(all, own[k / 2], other[k % 2]);
        }
      }
      for (int k = 0; k < 2 && grouped && any != NULL && other[k] != NULL; k++) {
        json_array_append_new(any, json_pack("{s:[s]}", "required", other[k]));
      }
    }
    if (any != NULL) {
      json_array_append_new(all, json_pack("{s:o}", "anyOf", any));
    }
  }
  return all;
}

static json_t *record_json(struct maker *maker, const struct dea_record *record)
{
  json_t *properties = json_object(), *required = json_array(), *groups = groups_json(record);
  for (size_t i = 0; i < record->field_count; i++) {
    const struct dea_field *field = &record->fields[i];
    if (field->elsewhere != NULL) {
      continue;
    }
    json_object_set_new(properties, field->key, field_json(maker, field));
    if (field->alias != NULL) {
      json_t *old = field_json(maker, field);
      json_object_set_new(old, "deprecated", json_true());
      json_object_set_new(properties, field->alias, old);
    }
    if (field->required && field->group == 0 && field->alias == NULL) {
      json_array_append_new(required, json_string(field->key));
    }
  }
  json_t *json = json_pack("{s:s, s:o, s:o, s:b}", "type", "object", "properties", properties,
                           "required", required, "additionalProperties", 0);
  if (json_array_size(groups) > 0) {
    json_object_set(json, "allOf", groups);
  }
  json_decref(groups);
  return json;
}

/* An object with its members by their names; NULL without memory. That in which units are met
 * depends on the order in which a compiler evaluates arguments. */
static json_t *sorted(const json_t *object)
{
  char *text = json_dumps(object, JSON_SORT_KEYS);
  json_t *out = text != NULL ? json_loads(text, 0, NULL) : NULL;
  free(text);
  return out;
}

/* Takes the body and what the maker holds. */
static dea_status print_json(struct maker *maker, json_t *body, const char *title,
                             struct dea_text *out)
{
  json_t *json = json_pack("{s:s, s:s}", "$schema", "https://json-schema.org/draft/2020-12/schema",
                           "title", title);
  char *text = NULL;
  if (json != NULL && json_object_update(json, body) == 0 &&
      json_object_set_new(json, "$defs", sorted(maker->units)) == 0) {
    text = json_dumps(json, JSON_INDENT(1));
  }
  json_decref(maker->units);
  json_decref(body);
  json_decref(json);
  if (maker->status != DEA_OK) {
    free(text);
    return maker->status;
  }
  if (text == NULL) {
    return dea_fail(maker->ctx, DEA_E_MEMORY, "out of memory in jansson");
  }
  dea_text_add(out, "%s\n", text);
  free(text);
  return out->failed ? DEA_E_MEMORY : DEA_OK;
}

dea_status dea_schema_print_json(struct dea_context *ctx, const struct dea_record *record,
                                 const char *title, struct dea_text *out)
{
  struct maker maker = {ctx, json_object(), DEA_OK};
  return print_json(&maker, record_json(&maker, record), title, out);
}

dea_status dea_schema_print_forms_json(struct dea_context *ctx,
                                       const struct dea_schema_forms *forms, const char *title,
                                       struct dea_text *out)
{
  struct maker maker = {ctx, json_object(), DEA_OK};
  json_t *body = json_pack("{s:s, s:{s:[s]}, s:o, s:o}", "type", "object", "if", "required",
                           forms->key, "then", record_json(&maker, forms->with), "else",
                           record_json(&maker, forms->without));
  return print_json(&maker, body, title, out);
}
