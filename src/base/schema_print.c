/* A schema's tables printed: for people, as Markdown and as JSON Schema. */
#include "base/schema.h"

#include "base/units.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_SIZE = 256 };

static bool is_number(const struct dea_field *field)
{
  return field->kind == DEA_FIELD_NUMBER || field->kind == DEA_FIELD_INTEGER ||
         field->kind == DEA_FIELD_INPLANE || field->kind == DEA_FIELD_STRETCHED;
}

static const char *word_of(enum dea_field_kind kind)
{
  switch (kind) {
  case DEA_FIELD_LABEL:
  case DEA_FIELD_TEXT:
    return "text";
  case DEA_FIELD_NUMBER:
    return "number";
  case DEA_FIELD_INTEGER:
    return "whole number";
  case DEA_FIELD_INPLANE:
  case DEA_FIELD_STRETCHED:
    return "length";
  case DEA_FIELD_CHOICE:
    return "one of:";
  case DEA_FIELD_ROWS:
    return "list of lists of numbers";
  case DEA_FIELD_RECORD:
  case DEA_FIELD_SECTION:
  case DEA_FIELD_SETTINGS:
    return "section";
  }
  return "";
}

/* "length, stretched or unstretched, > 0" and the like: what may be written. */
static void add_form(struct dea_text *out, const struct dea_field *field)
{
  dea_text_add(out, "%s%s%s", field->lone ? "one or " : "", field->list_max > 0 ? "list of " : "",
               word_of(field->kind));
  for (size_t i = 0; field->kind == DEA_FIELD_CHOICE && field->choices[i] != NULL; i++) {
    dea_text_add(out, "%s%s", i > 0 ? ", " : " ", field->choices[i]);
  }
  if (field->kind == DEA_FIELD_NUMBER && strcmp(field->unit, "1") != 0) {
    dea_text_add(out, " in %s", field->unit);
  }
  if (field->kind == DEA_FIELD_INPLANE) {
    dea_text_add(out, ", stretched or unstretched");
  }
  bool limited = is_number(field) && (field->min != 0 || field->max != 0 || field->above_min);
  if (limited) {
    dea_text_add(out, ", %s %g", field->above_min ? ">" : ">=", field->min);
  }
  bool upper = field->max > field->min || (field->max == field->min && field->max != 0);
  if (limited && upper) {
    dea_text_add(out, ", %s %g", field->below_max ? "<" : "<=", field->max);
  }
}

static const char *describe_need(const struct dea_record *record, const struct dea_field *field)
{
  bool required = field->required;
  for (size_t i = 0; i < record->field_count && field->group > 0; i++) {
    required |= record->fields[i].group == field->group && record->fields[i].required;
  }
  if (required) {
    return field->group > 0 ? "required, one way" : "required";
  }
  if (field->default_text != NULL) {
    return field->default_text;
  }
  return field->absent_text != NULL ? field->absent_text : "";
}

typedef void (*print_fn)(const struct dea_record *record, const struct dea_field *field,
                         const char *path, struct dea_text *out);

static void walk(const struct dea_record *record, const char *path, print_fn print,
                 struct dea_text *out)
{
  for (size_t i = 0; i < record->field_count; i++) {
    const struct dea_field *field = &record->fields[i];
    if (field->elsewhere != NULL) {
      continue;
    }
    struct dea_text inner = {.ctx = out->ctx};
    dea_text_add(&inner, "%s%s%s%s", path, path[0] != '\0' ? "." : "", field->key,
                 field->list_max > 0 && dea_field_has_record(field) ? "[]" : "");
    out->failed = out->failed || inner.failed;
    print(record, field, dea_text_get(&inner), out);
    if (dea_field_has_record(field)) {
      walk(field->record, dea_text_get(&inner), print, out);
    }
    for (size_t k = 0; field->kinds != NULL && field->kinds[k] != NULL; k++) {
      struct dea_text kind = {.ctx = out->ctx};
      dea_text_add(&kind, "%s(%s)", dea_text_get(&inner), field->kinds[k]->name);
      out->failed = out->failed || kind.failed;
      walk(field->kinds[k], dea_text_get(&kind), print, out);
      dea_text_free(&kind);
    }
    dea_text_free(&inner);
  }
}

static void print_plain(const struct dea_record *record, const struct dea_field *field,
                        const char *path, struct dea_text *out)
{
  const char *need = describe_need(record, field);
  if (dea_field_has_record(field)) {
    dea_text_add(out, "\n%s: %s%s%s%s\n", path, field->doc, need[0] != '\0' ? " [" : "", need,
                 need[0] != '\0' ? "]" : "");
    return;
  }
  dea_text_add(out, "  %s\n      %s\n      ", path, field->doc);
  add_form(out, field);
  dea_text_add(out, "%s%s%s", need[0] != '\0' ? "; " : "",
               field->required || need[0] == '\0' || strcmp(need, "required, one way") == 0
                   ? ""
                   : "by default ",
               need);
  dea_text_add(out, "; for example  %s: %s\n", field->key, field->example);
}

void dea_schema_print_text(const struct dea_record *record, struct dea_text *out)
{
  walk(record, "", print_plain, out);
}

static void print_key(const struct dea_record *record, const struct dea_field *field,
                      const char *path, struct dea_text *out)
{
  (void)record;
  if (field->kind < DEA_FIELD_RECORD && strpbrk(path, "[(") == NULL) {
    dea_text_add(out, "%s\n", path);
  }
}

void dea_schema_print_keys(const struct dea_record *record, struct dea_text *out)
{
  walk(record, "", print_key, out);
}

/* Text in a cell of a Markdown table: a bar would end the cell. */
static void add_cell(struct dea_text *out, const char *text)
{
  for (; *text != '\0'; text++) {
    dea_text_add(out, *text == '|' ? "\\%c" : "%c", *text);
  }
}

static void print_row(const struct dea_record *record, const struct dea_field *field,
                      const char *path, struct dea_text *out)
{
  dea_text_add(out, "| `%s` | ", path);
  add_form(out, field);
  dea_text_add(out, " | ");
  add_cell(out, describe_need(record, field));
  dea_text_add(out, " | ");
  add_cell(out, field->doc);
  dea_text_add(out, field->example != NULL ? " | `%s` |\n" : " |%s |\n",
               field->example != NULL ? field->example : "");
}

void dea_schema_print_markdown(const struct dea_record *record, struct dea_text *out)
{
  dea_text_add(out, "| key | form (limits in SI) | without it | meaning | example |\n"
                    "|---|---|---|---|---|\n");
  walk(record, "", print_row, out);
}

static json_t *record_json(const struct dea_record *record);

/* A number: bare where the unit is 1, otherwise text; what exactly is right only the reader knows.
 */
static json_t *number_json(const struct dea_field *field)
{
  bool bare = strcmp(field->unit, "1") == 0;
  if (!bare) {
    return json_pack("{s:s, s:s}", "type", "string", "pattern",
                     field->kind == DEA_FIELD_INPLANE
                         ? "^[-+]?[0-9.][0-9.eE+-]* *\\S.* (stretched|unstretched)$"
                         : "^[-+]?[0-9.][0-9.eE+-]* *\\S.*$");
  }
  json_t *json =
      json_pack("{s:s}", "type", field->kind == DEA_FIELD_INTEGER ? "integer" : "number");
  bool upper = field->max > field->min || (field->max == field->min && field->max != 0);
  if (json != NULL && (field->min != 0 || upper || field->above_min) && isfinite(field->min)) {
    json_object_set_new(json, field->above_min ? "exclusiveMinimum" : "minimum",
                        json_real(field->min));
  }
  if (json != NULL && upper && isfinite(field->max)) {
    json_object_set_new(json, field->below_max ? "exclusiveMaximum" : "maximum",
                        json_real(field->max));
  }
  return json;
}

static json_t *choice_json(const struct dea_field *field)
{
  json_t *values = json_array();
  for (size_t i = 0; field->choices[i] != NULL; i++) {
    json_array_append_new(values, json_string(field->choices[i]));
  }
  return json_pack("{s:o}", "enum", values);
}

/* One of several tables, told apart by the key "kind". */
static json_t *kinds_json(const struct dea_field *field)
{
  json_t *any = json_array();
  for (size_t k = 0; field->kinds[k] != NULL; k++) {
    json_t *record = record_json(field->kinds[k]);
    json_t *properties = json_object_get(record, "properties");
    json_object_set_new(properties, "kind", json_pack("{s:s}", "const", field->kinds[k]->name));
    json_array_append_new(any, record);
  }
  return json_pack("{s:s, s:o}", "type", "object", "oneOf", any);
}

static json_t *value_json(const struct dea_field *field)
{
  switch (field->kind) {
  case DEA_FIELD_RECORD:
  case DEA_FIELD_SETTINGS:
    return record_json(field->record);
  case DEA_FIELD_SECTION:
    return field->kinds != NULL ? kinds_json(field) : json_pack("{s:s}", "type", "object");
  case DEA_FIELD_CHOICE:
    return choice_json(field);
  case DEA_FIELD_ROWS:
    return json_pack("{s:s, s:{s:s}}", "type", "array", "items", "type", "array");
  case DEA_FIELD_LABEL:
    return json_pack("{s:s, s:i}", "type", "string", "maxLength", DEA_TITLE_SIZE - 1);
  case DEA_FIELD_TEXT:
    return json_pack("{s:s}", "type", "string");
  case DEA_FIELD_NUMBER:
  case DEA_FIELD_INTEGER:
  case DEA_FIELD_INPLANE:
  case DEA_FIELD_STRETCHED:
    return number_json(field);
  }
  return NULL;
}

static json_t *field_json(const struct dea_field *field)
{
  json_t *json = value_json(field);
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
    char text[PATH_SIZE];
    snprintf(text, sizeof text, "%s; default: %s", field->doc, field->default_text);
    json_object_set_new(json, "description", json_string(text));
  }
  return json;
}

/* Pairs of keys that exclude each other, as {"not": {"required": [a, b]}}, and the groups of which
 * one key must be there, as {"anyOf": [{"required": [a]}, ...]}. */
static json_t *groups_json(const struct dea_record *record)
{
  json_t *all = json_array();
  for (size_t i = 0; i < record->field_count; i++) {
    const struct dea_field *a = &record->fields[i];
    json_t *any = a->group > 0 && a->required ? json_array() : NULL;
    for (size_t j = 0; j < record->field_count && a->group > 0; j++) {
      const struct dea_field *b = &record->fields[j];
      if (b->group == a->group && any != NULL) {
        json_array_append_new(any, json_pack("{s:[s]}", "required", b->key));
      }
      if (b->group == a->group && b->option != a->option && j > i) {
        json_array_append_new(all, json_pack("{s:{s:[ss]}}", "not", "required", a->key, b->key));
      }
    }
    if (any != NULL) {
      json_array_append_new(all, json_pack("{s:o}", "anyOf", any));
    }
  }
  return all;
}

static json_t *record_json(const struct dea_record *record)
{
  json_t *properties = json_object(), *required = json_array(), *groups = groups_json(record);
  for (size_t i = 0; i < record->field_count; i++) {
    const struct dea_field *field = &record->fields[i];
    if (field->elsewhere != NULL) {
      continue;
    }
    json_object_set_new(properties, field->key, field_json(field));
    if (field->alias != NULL) {
      json_t *old = field_json(field);
      json_object_set_new(old, "deprecated", json_true());
      json_object_set_new(properties, field->alias, old);
    }
    if (field->required && field->group == 0) {
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

/* Takes the body. */
static dea_status print_json(struct dea_context *ctx, json_t *body, const char *title,
                             struct dea_text *out)
{
  json_t *json = json_pack("{s:s, s:s}", "$schema", "https://json-schema.org/draft/2020-12/schema",
                           "title", title);
  char *text = NULL;
  if (json != NULL && json_object_update(json, body) == 0) {
    text = json_dumps(json, JSON_INDENT(2));
  }
  json_decref(body);
  json_decref(json);
  if (text == NULL) {
    return dea_fail(ctx, DEA_E_MEMORY, "out of memory in jansson");
  }
  dea_text_add(out, "%s\n", text);
  free(text);
  return out->failed ? DEA_E_MEMORY : DEA_OK;
}

dea_status dea_schema_print_json(struct dea_context *ctx, const struct dea_record *record,
                                 const char *title, struct dea_text *out)
{
  return print_json(ctx, record_json(record), title, out);
}

dea_status dea_schema_print_forms_json(struct dea_context *ctx,
                                       const struct dea_schema_forms *forms, const char *title,
                                       struct dea_text *out)
{
  json_t *body =
      json_pack("{s:s, s:{s:[s]}, s:o, s:o}", "type", "object", "if", "required", forms->key,
                "then", record_json(forms->with), "else", record_json(forms->without));
  return print_json(ctx, body, title, out);
}
