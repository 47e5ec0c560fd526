/* A schema's tables printed: for people, and as Markdown. */
#include "base/schema.h"

#include <string.h>

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
  bool lower, upper;
  dea_field_limits(field, &lower, &upper);
  if (is_number(field) && lower) {
    dea_text_add(out, ", %s %g", field->above_min ? ">" : ">=", field->min);
  }
  if (is_number(field) && upper) {
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
    print(record, field, dea_text_get(&inner), out);
    if (dea_field_has_record(field)) {
      walk(field->record, dea_text_get(&inner), print, out);
    }
    bool listed = field->kinds != NULL && !field->kinds_elsewhere;
    for (size_t k = 0; listed && field->kinds[k] != NULL; k++) {
      struct dea_text kind = {.ctx = out->ctx};
      dea_text_add(&kind, "%s(%s)", dea_text_get(&inner), field->kinds[k]->name);
      walk(field->kinds[k], dea_text_get(&kind), print, out);
      dea_text_free_in(&kind, out);
    }
    dea_text_free_in(&inner, out);
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
  if (strstr(path, ").kind") != NULL) {
    return; // the path has it
  }
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
