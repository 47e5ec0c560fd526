#include "base/schema.h"

#include "base/schema_value.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const dea_no_yes[] = {"no", "yes", NULL};

enum { MESSAGE_SIZE = 800, KEYS_MAX = 48, EXAMPLE_SIZE = 300 };

/* A section being read: node is NULL when it is absent and only defaults apply. */
struct section {
  const struct dea_record *record;
  const struct dea_node *node;
  const char *path; // "" for the file
  char *base;
  struct dea_location location;
};

static dea_status read_section(const struct dea_reader *reader, const struct section *section);

bool dea_field_has_record(const struct dea_field *field)
{
  return field->kind == DEA_FIELD_RECORD || field->kind == DEA_FIELD_SETTINGS;
}

const struct dea_field *dea_record_find(const struct dea_record *record, const char *key,
                                        size_t *offset)
{
  const size_t length = strcspn(key, ".");
  for (size_t i = 0; i < record->field_count; i++) {
    const struct dea_field *field = &record->fields[i], *found = field;
    size_t inner = 0;
    if (strlen(field->key) != length || memcmp(field->key, key, length) != 0) {
      continue;
    }
    if (key[length] == '.') {
      const bool section = dea_field_has_record(field) && field->list_max == 0;
      found = section ? dea_record_find(field->record, key + length + 1, &inner) : NULL;
    }
    if (offset != NULL) {
      *offset = field->offset + inner;
    }
    return found;
  }
  return NULL;
}

bool dea_field_varies(const struct dea_field *field)
{
  return field->kind == DEA_FIELD_NUMBER || field->kind == DEA_FIELD_INPLANE ||
         field->kind == DEA_FIELD_STRETCHED;
}

/* Sets every member of a section that is not there. */
static void absent_section(const struct dea_record *record, char *base,
                           struct dea_location location)
{
  for (size_t i = 0; i < record->field_count; i++) {
    const struct dea_field *field = &record->fields[i];
    if (field->list_max > 0 || field->elsewhere != NULL) {
      continue;
    }
    if (field->kind == DEA_FIELD_RECORD) {
      absent_section(field->record, base + field->offset, location);
    } else if (field->kind != DEA_FIELD_SETTINGS) {
      dea_schema_value_absent(field, base + field->offset, location);
    }
  }
}

/* "from, to, step, ...": the first keys of a record, `most` of them. */
static void write_keys(const struct dea_record *record, size_t most, char *out, size_t size)
{
  size_t used = 0, shown = 0;
  out[0] = '\0';
  for (size_t i = 0; i < record->field_count && shown <= most && used < size; i++) {
    if (record->fields[i].elsewhere == NULL) {
      used += (size_t)snprintf(out + used, size - used, "%s%s", shown > 0 ? ", " : "",
                               shown < most ? record->fields[i].key : "...");
      shown++;
    }
  }
}

/* "; write for example 'EXAMPLE'", "" of a field without one. Returns out. */
static const char *for_example(const struct dea_field *field, char out[EXAMPLE_SIZE])
{
  const bool any = field->example != NULL;
  snprintf(out, EXAMPLE_SIZE, "%s%s%s", any ? "; write for example '" : "",
           any ? field->example : "", any ? "'" : "");
  return out;
}

/* false after an error: the node is not of the form that the field wants. */
static dea_status check_form(const struct dea_reader *reader, const struct dea_field *field,
                             const struct dea_node *node, bool element, bool *good)
{
  bool one = element || (field->lone && node->kind != DEA_NODE_LIST);
  bool list = (field->list_max > 0 && !one) || field->kind == DEA_FIELD_ROWS;
  bool section = dea_field_has_record(field) || field->kind == DEA_FIELD_SECTION;
  enum dea_node_kind due = list ? DEA_NODE_LIST : section ? DEA_NODE_SECTION : DEA_NODE_VALUE;
  *good = node->kind == due && !(due == DEA_NODE_VALUE && node->empty);
  if (*good) {
    return DEA_OK;
  }
  char example[EXAMPLE_SIZE];
  for_example(field, example);
  if (node->kind == DEA_NODE_VALUE && node->empty) {
    return dea_schema_error(reader, node->location, "%s has no value%s", field->key, example);
  }
  static const char *const forms[] = {"a single value", "a list", "a section with keys of its own"};
  enum { SHOWN = 5 };
  char keys[MESSAGE_SIZE / 4] = "";
  if (section && due == DEA_NODE_SECTION && field->record != NULL) {
    write_keys(field->record, SHOWN, keys, sizeof keys);
  }
  return dea_schema_error(reader, node->location, "%s must be %s%s%s%s, not %s%s", field->key,
                          forms[due], keys[0] != '\0' ? " (" : "", keys, keys[0] != '\0' ? ")" : "",
                          forms[node->kind], example);
}

/* A section with memory of its own; node NULL: its defaults. */
static dea_status read_settings(const struct dea_reader *reader, const struct dea_field *field,
                                const struct dea_node *node, const char *path,
                                struct dea_location location, char *target)
{
  void *values = dea_alloc(reader->ctx, 1, field->element_size);
  DEA_TRY_MEMORY(values != NULL);
  memcpy(target, &values, sizeof values);
  const struct section inner = {field->record, node, path, values, location};
  return read_section(reader, &inner);
}

/* "[[0 mm, 0 mm], [5 mm, 0 mm]]" */
static void show_rows(const struct dea_node *node, struct dea_text *out)
{
  dea_text_add(out, "%s", node->kind == DEA_NODE_VALUE ? node->text : "[");
  for (const struct dea_node *child = node->child; child != NULL; child = child->next) {
    show_rows(child, out);
    dea_text_add(out, "%s", child->next != NULL ? ", " : "");
  }
  dea_text_add(out, "%s", node->kind == DEA_NODE_VALUE ? "" : "]");
}

/* Keeps rows for who reads them, and lists them as one value. */
static dea_status read_rows(const struct dea_reader *reader, const struct dea_node *node,
                            const char *path, enum dea_origin origin, const struct dea_node **out)
{
  struct dea_text text = {.ctx = reader->ctx};
  *out = node;
  show_rows(node, &text);
  const char *kept = text.failed ? NULL : dea_intern(reader->ctx, dea_text_get(&text));
  dea_text_free(&text);
  return kept != NULL ? dea_schema_list(reader, path, kept, NULL, NAN, origin, node->location)
                      : DEA_E_MEMORY;
}

/* One given value, or one element of a given list. */
static dea_status read_node(const struct dea_reader *reader, const struct dea_field *field,
                            const struct dea_node *node, const char *path, enum dea_origin origin,
                            char *target)
{
  if (field->kind == DEA_FIELD_RECORD) {
    struct section inner = {field->record, node, path, target, node->key_place};
    inner.location = node->key != NULL ? node->key_place : node->location;
    return read_section(reader, &inner);
  }
  if (field->kind == DEA_FIELD_SETTINGS) {
    return read_settings(reader, field, node, path, node->key_place, target);
  }
  if (field->kind == DEA_FIELD_ROWS) {
    return read_rows(reader, node, path, origin, (const struct dea_node **)target);
  }
  if (field->kind == DEA_FIELD_SECTION) {
    *(const struct dea_node **)target = node;
    return DEA_OK;
  }
  struct dea_schema_value value = {field, node->text, node->location, origin, path};
  return dea_schema_value_read(reader, &value, target);
}

static dea_status read_list(const struct dea_reader *reader, const struct dea_field *field,
                            const struct dea_node *node, const char *path, enum dea_origin origin,
                            char *base)
{
  size_t *count = (size_t *)(void *)(base + field->count_offset);
  if (node->child_count < field->list_min || node->child_count > field->list_max) {
    char due[40] = "";
    if (field->list_min < field->list_max) {
      snprintf(due, sizeof due, "%zu to ", field->list_min);
    }
    return dea_schema_error(reader, node->location, "%s must have %s%zu items, not %zu", field->key,
                            due, field->list_max, node->child_count);
  }
  char *elements = base + field->offset;
  if (field->own_list) {
    char *own = dea_alloc(reader->ctx, node->child_count, field->element_size);
    DEA_TRY_MEMORY(own != NULL);
    memcpy(elements, &own, sizeof own);
    elements = own;
  }
  *count = 0;
  for (const struct dea_node *item = node->child; item != NULL; item = item->next) {
    char item_path[DEA_KEY_PATH_SIZE];
    bool good;
    snprintf(item_path, sizeof item_path, "%s[%zu]", path, *count);
    DEA_TRY(reader->ctx, check_form(reader, field, item, true, &good));
    char *target = elements + *count * field->element_size;
    if (good) {
      DEA_TRY(reader->ctx, read_node(reader, field, item, item_path, origin, target));
    } else {
      dea_schema_value_absent(field, target, item->location);
    }
    ++*count;
  }
  return DEA_OK;
}

static dea_status read_given(const struct dea_reader *reader, const struct section *section,
                             const struct dea_field *field, const struct dea_node *node,
                             const char *path)
{
  bool good;
  DEA_TRY(reader->ctx, check_form(reader, field, node, false, &good));
  if (!good) {
    return DEA_OK;
  }
  enum dea_origin origin = node->overridden ? DEA_OVERRIDE : DEA_GIVEN;
  if (field->present_offset > 0) {
    *(bool *)(section->base + field->present_offset) = true;
  }
  if (field->list_max > 0 && node->kind == DEA_NODE_LIST) {
    return read_list(reader, field, node, path, origin, section->base);
  }
  if (field->list_max > 0) {
    *(size_t *)(void *)(section->base + field->count_offset) = 1;
  }
  return read_node(reader, field, node, path, origin, section->base + field->offset);
}

static dea_status read_default(const struct dea_reader *reader, const struct section *section,
                               const struct dea_field *field, const char *path)
{
  if (field->list_max > 0) {
    const struct dea_node *node;
    DEA_TRY(reader->ctx, dea_yaml_fragment(reader->ctx, reader->yaml, section->location,
                                           field->default_text, &node));
    return read_list(reader, field, node, path, DEA_DEFAULT, section->base);
  }
  struct dea_schema_value value = {field, field->default_text, section->location, DEA_DEFAULT,
                                   path};
  return dea_schema_value_read(reader, &value, section->base + field->offset);
}

/* Key of the first section right below that knows a key, or NULL. */
static const char *section_with(const struct dea_record *record, const char *key)
{
  for (size_t i = 0; i < record->field_count; i++) {
    const struct dea_record *below = record->fields[i].record;
    for (size_t k = 0; below != NULL && k < below->field_count; k++) {
      if (strcmp(below->fields[k].key, key) == 0) {
        return record->fields[i].key;
      }
    }
  }
  return NULL;
}

static bool is_key(const struct dea_field *field, const char *key)
{
  return strcmp(field->key, key) == 0 || (field->alias != NULL && strcmp(field->alias, key) == 0);
}

static size_t list_keys(const struct dea_record *record, const char *keys[KEYS_MAX])
{
  size_t count = record->field_count < KEYS_MAX ? record->field_count : KEYS_MAX;
  for (size_t i = 0; i < count; i++) {
    keys[i] = record->fields[i].key;
  }
  return count;
}

/* Field of a key among the first `count`; count: none. */
static size_t find_key(const struct dea_record *record, size_t count, const char *key)
{
  size_t i = 0;
  while (i < count && !is_key(&record->fields[i], key)) {
    i++;
  }
  return i;
}

/* Whether an unknown key of the section is one that was meant to be this: its message says so. */
static bool is_misspelt(const struct section *section, const char *key)
{
  const char *keys[KEYS_MAX];
  const struct dea_record *record = section->record;
  size_t count = list_keys(record, keys);
  const struct dea_node *node = section->node != NULL ? section->node->child : NULL;
  for (; node != NULL; node = node->next) {
    const bool unknown = find_key(record, count, node->key) == count;
    const char *nearest = unknown ? dea_nearest_name(node->key, keys, count) : NULL;
    if (nearest != NULL && strcmp(nearest, key) == 0 && section_with(record, node->key) == NULL) {
      return true;
    }
  }
  return false;
}

/* An error, unless the key is there misspelt. */
static dea_status missing_field(const struct dea_reader *reader, const struct section *section,
                                const struct dea_field *field)
{
  char where[80];
  if (is_misspelt(section, field->key)) {
    return DEA_OK;
  }
  snprintf(where, sizeof where, section->path[0] != '\0' ? "section '%.60s'" : "the file",
           section->path);
  char example[EXAMPLE_SIZE] = "";
  if (field->example != NULL) {
    snprintf(example, sizeof example, ", for example '%s: %s'", field->key, field->example);
  }
  return dea_schema_error(reader, section->location, "%s lacks %s'%s' (%s)%s", where,
                          field->group > 0 ? "its " : "", field->key, field->doc, example);
}

/* A field that is not given: its default, nothing, or an error. */
static dea_status read_absent(const struct dea_reader *reader, const struct section *section,
                              const struct dea_field *field, const char *path)
{
  char *target = section->base + field->offset;
  if (field->kind == DEA_FIELD_SETTINGS) {
    return read_settings(reader, field, NULL, path, section->location, target);
  }
  if (field->kind == DEA_FIELD_RECORD && field->list_max == 0) {
    if (!field->required && field->present_offset == 0) {
      struct section inner = {field->record, NULL, path, target, section->location};
      return read_section(reader, &inner);
    }
    absent_section(field->record, target, section->location);
  } else if (field->default_text != NULL) {
    return read_default(reader, section, field, path);
  } else if (field->list_max == 0) {
    dea_schema_value_absent(field, target, section->location);
  }
  if (field->required) {
    return missing_field(reader, section, field);
  }
  if (field->absent_text != NULL) {
    return dea_schema_list(reader, path, field->absent_text, NULL, NAN, DEA_ABSENT,
                           section->location);
  }
  return DEA_OK;
}

/* The node of a field under its key or its older word; where both are there, what --set says. */
static const struct dea_node *child_of(const struct section *section, const struct dea_field *field)
{
  if (section->node == NULL) {
    return NULL;
  }
  const struct dea_node *node = dea_node_find(section->node, field->key);
  const struct dea_node *old =
      field->alias != NULL ? dea_node_find(section->node, field->alias) : NULL;
  return node == NULL || (old != NULL && old->overridden && !node->overridden) ? old : node;
}

/* Option of a group that counts; 0: none is given and none has a default. Errors (two options
 * given) are added when the group's first field asks. */
static dea_status choose_option(const struct dea_reader *reader, const struct section *section,
                                const struct dea_field *asking, int *option)
{
  const struct dea_record *record = section->record;
  const struct dea_node *first = NULL;
  bool is_first = true;
  int by_default = 0;
  *option = 0;
  for (size_t i = 0; i < record->field_count; i++) {
    const struct dea_field *field = &record->fields[i];
    if (field->group != asking->group) {
      continue;
    }
    is_first = is_first && field >= asking;
    by_default = by_default == 0 && field->default_text != NULL ? field->option : by_default;
    const struct dea_node *node = child_of(section, field);
    if (node == NULL || field->option == *option) {
      continue;
    }
    if (first == NULL || (node->overridden && !first->overridden)) {
      first = node;
      *option = field->option;
    } else if (is_first && field >= asking && node->overridden == first->overridden) {
      DEA_TRY(reader->ctx, dea_schema_error(reader, node->key_place,
                                            "'%s' and '%s' exclude each other; write one of them",
                                            first->key, field->key));
    }
  }
  *option = *option == 0 ? by_default : *option;
  return DEA_OK;
}

/* All ways to write what a group wants, for the message that none is there, also misspelt. */
static dea_status missing_group(const struct dea_reader *reader, const struct section *section,
                                const struct dea_field *asking)
{
  char ways[MESSAGE_SIZE / 2] = "";
  size_t used = 0;
  for (size_t i = 0; i < section->record->field_count; i++) {
    const struct dea_field *field = &section->record->fields[i];
    if (field->group == asking->group && is_misspelt(section, field->key)) {
      return DEA_OK;
    }
    if (field->group == asking->group && used < sizeof ways) {
      used += (size_t)snprintf(ways + used, sizeof ways - used, "%s'%s: %s'",
                               used > 0 ? " or " : "", field->key, field->example);
    }
  }
  return dea_schema_error(reader, section->location,
                          "section '%.60s' lacks the %s; write for example %s", section->path,
                          asking->doc, ways);
}

static dea_status read_field(const struct dea_reader *reader, const struct section *section,
                             const struct dea_field *field)
{
  char path[DEA_KEY_PATH_SIZE];
  snprintf(path, sizeof path, "%s%s%s", section->path, section->path[0] != '\0' ? "." : "",
           field->key);
  const struct dea_node *node = child_of(section, field);
  if (field->group > 0) {
    int option;
    DEA_TRY(reader->ctx, choose_option(reader, section, field, &option));
    if (option == 0 && field->required) {
      dea_schema_value_absent(field, section->base + field->offset, section->location);
      return missing_group(reader, section, field);
    }
    if (option != field->option) {
      return DEA_OK; // members of other options were set absent at the start
    }
  }
  return node != NULL ? read_given(reader, section, field, node, path)
                      : read_absent(reader, section, field, path);
}

/* An older word beside the key itself. */
static dea_status check_twice(const struct dea_reader *reader, const struct section *section,
                              const struct dea_field *field, const struct dea_node *node)
{
  const struct dea_node *chosen = child_of(section, field);
  if (strcmp(chosen->key, node->key) == 0 || node->overridden != chosen->overridden) {
    return DEA_OK;
  }
  return dea_schema_error(reader, node->key_place,
                          "'%s' and '%s' are the same key; write one of them", field->key,
                          field->alias);
}

static dea_status check_unknown_keys(const struct dea_reader *reader, const struct section *section)
{
  const struct dea_record *record = section->record;
  const char *keys[KEYS_MAX];
  size_t count = list_keys(record, keys);
  for (const struct dea_node *node = section->node->child; node != NULL; node = node->next) {
    size_t i = find_key(record, count, node->key);
    if (i < count) {
      const char *instead = record->fields[i].elsewhere;
      DEA_TRY(reader->ctx, instead != NULL
                               ? dea_schema_error(reader, node->key_place, "%s", instead)
                               : check_twice(reader, section, &record->fields[i], node));
      continue;
    }
    char hint[DEA_HINT_SIZE], list[MESSAGE_SIZE / 2];
    dea_name_hint(node->key, keys, count, hint);
    write_keys(record, count, list, sizeof list);
    const char *below = section_with(record, node->key);
    DEA_TRY(reader->ctx,
            below != NULL
                ? dea_schema_error(reader, node->key_place,
                                   "unknown key '%.60s' here; it belongs into a section such as "
                                   "'%s', indented",
                                   node->key, below)
                : dea_schema_error(
                      reader, node->key_place, "unknown key '%.60s'%s%s", node->key,
                      hint[0] != '\0' ? hint : "; known here are: ", hint[0] != '\0' ? "" : list));
  }
  return DEA_OK;
}

static dea_status read_section(const struct dea_reader *reader, const struct section *section)
{
  absent_section(section->record, section->base, section->location);
  DEA_TRY(reader->ctx, section->node != NULL ? check_unknown_keys(reader, section) : DEA_OK);
  for (size_t i = 0; i < section->record->field_count; i++) {
    if (section->record->fields[i].elsewhere == NULL) {
      DEA_TRY(reader->ctx, read_field(reader, section, &section->record->fields[i]));
    }
  }
  return DEA_OK;
}

dea_status dea_schema_read(const struct dea_reader *reader, const struct dea_record *record,
                           const struct dea_node *node, const char *path, void *base)
{
  struct section section = {record, node, path, base,
                            node->key != NULL ? node->key_place : node->location};
  if (node->kind != DEA_NODE_SECTION) {
    return dea_schema_error(reader, node->location,
                            "this is not a %s: it must be 'key: value' lines", record->name);
  }
  return read_section(reader, &section);
}
