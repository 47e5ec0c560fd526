#include "base/yaml.h"

#include "base/arena.h"
#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

enum { REPEATED_MAX = 100 };

struct dea_yaml {
  struct dea_arena memory; // of all nodes and texts
  struct dea_node *root;
  const char *name;
};

/* Text to be read. */
struct text {
  const char *name;  // for places
  const char *bytes; // [length]
  size_t length;
  const struct dea_location *fixed; // place of everything in it, or NULL
};

// What is wrong with a text ----------------------------------------------------------------------

/* A finding at a place of the text, and DEA_E_DESIGN. */
static dea_status refuse_at(struct dea_context *ctx, const struct text *text, yaml_mark_t mark,
                            const char *message)
{
  const struct dea_location place = {text->name, mark.line + 1, mark.column + 1};
  return dea_refuse(ctx, text->fixed != NULL ? *text->fixed : place, message);
}

/* Line and column of a byte, which libyaml does not know for text that it cannot decode. */
static yaml_mark_t mark_of_byte(const struct text *text, size_t offset)
{
  yaml_mark_t mark = {0, 0, 0};
  for (size_t i = 0; i < offset && i < text->length; i++) {
    if (text->bytes[i] == '\n') {
      mark.line++;
      mark.column = 0;
    } else {
      mark.column++;
    }
  }
  return mark;
}

/* The byte at a mark, which counts lines and characters from 0; the text's length beyond it. */
static size_t byte_at(const struct text *text, yaml_mark_t mark)
{
  size_t at = 0;
  for (size_t line = 0; line < mark.line && at < text->length; at++) {
    line += text->bytes[at] == '\n';
  }
  for (size_t column = 0; column < mark.column && at < text->length; column++) {
    do {
      at++;
    } while (at < text->length && (text->bytes[at] & 0xC0) == 0x80); // rest of a character of UTF-8
  }
  return at;
}

/* Whether the line of a byte has ': ' before it. */
static bool follows_colon(const struct text *text, size_t at)
{
  for (; at > 0 && text->bytes[at - 1] != '\n'; at--) {
    if (at > 1 && text->bytes[at - 1] == ' ' && text->bytes[at - 2] == ':') {
      return true;
    }
  }
  return false;
}

/* What libyaml's problem is in words of who wrote the file, and where to look; NULL: in its own. */
static const char *in_words(const struct text *text, const yaml_parser_t *parser,
                            const char *problem, yaml_mark_t *place)
{
  size_t at = byte_at(text, *place);
  bool within = at < text->length;
  if (within && text->bytes[at] == '\t') {
    return "a tab stands here; YAML indents with spaces";
  }
  if (strstr(problem, "mapping values are not allowed") != NULL && within &&
      follows_colon(text, at)) {
    return "this is not YAML: a text with ': ' in it stands in quotes";
  }
  if (strstr(problem, "mapping values are not allowed") != NULL ||
      strcmp(problem, "did not find expected key") == 0) {
    return "this is not YAML: no key can stand here; is the line indented like its neighbours?";
  }
  if (strcmp(problem, "did not find expected <document start>") == 0) {
    return "this is not YAML: what stands here does not belong to the lines above; is it indented "
           "like the first of them?";
  }
  if (strcmp(problem, "found character that cannot start any token") == 0) {
    return "this is not YAML: no value begins with this character; a text that does stands in "
           "quotes";
  }
  if (strcmp(problem, "found unexpected ':'") == 0) {
    return "this is not YAML: a space is due after the colon of 'KEY: VALUE'";
  }
  if (strcmp(problem, "could not find expected ':'") == 0) {
    *place = parser->context_mark;
    return "this is not YAML: 'KEY: VALUE' is due here, with a space after the colon";
  }
  if (parser->context != NULL && strstr(parser->context, "quoted scalar") != NULL &&
      strstr(problem, "unexpected end of stream") != NULL) {
    *place = parser->context_mark;
    return "this is not YAML: the quote that begins here does not end";
  }
  return NULL;
}

/* The same with what the parser has failed at, in words of who wrote the file. */
static dea_status refuse_problem(struct dea_context *ctx, const struct text *text,
                                 const yaml_parser_t *parser)
{
  char message[300];
  const char *problem = parser->problem != NULL ? parser->problem : "unknown";
  if (parser->error == YAML_MEMORY_ERROR) {
    return dea_fail(ctx, DEA_E_MEMORY, "out of memory in libyaml");
  }
  if (parser->error == YAML_READER_ERROR) {
    snprintf(message, sizeof message, "this is not a text file in UTF-8: %s", problem);
    return refuse_at(ctx, text, mark_of_byte(text, parser->problem_offset), message);
  }
  yaml_mark_t place = parser->problem_mark;
  const char *words = in_words(text, parser, problem, &place);
  if (words != NULL) {
    return refuse_at(ctx, text, place, words);
  }
  const bool context = parser->context != NULL;
  int length = snprintf(message, sizeof message, "this is not YAML: %s%s%s", problem,
                        context ? " " : "", context ? parser->context : "");
  if (context && parser->context_mark.line != place.line) {
    snprintf(message + length, sizeof message - (size_t)length, " that begins in line %zu",
             parser->context_mark.line + 1);
  }
  return refuse_at(ctx, text, place, message);
}

// Nodes ------------------------------------------------------------------------------------------

/* One text's way into nodes, event by event. */
struct reading {
  struct dea_context *ctx;
  struct dea_yaml *yaml;
  const struct text *text;
  yaml_parser_t parser;
  yaml_event_t event;
  size_t depth, nodes, repeated; // repeated: keys that stand twice
};

static char *keep_text(struct dea_yaml *yaml, const char *text, size_t length)
{
  char *copy = dea_arena_alloc(&yaml->memory, length + 1, 1);
  if (copy != NULL) {
    memcpy(copy, text, length);
  }
  return copy;
}

static dea_status next_event(struct reading *r)
{
  yaml_event_delete(&r->event);
  return yaml_parser_parse(&r->parser, &r->event) != 0
             ? DEA_OK
             : refuse_problem(r->ctx, r->text, &r->parser);
}

static dea_status refuse(const struct reading *r, const char *message)
{
  return refuse_at(r->ctx, r->text, r->event.start_mark, message);
}

static struct dea_location place_of(const struct reading *r)
{
  return r->text->fixed != NULL ? *r->text->fixed
                                : (struct dea_location){r->yaml->name, r->event.start_mark.line + 1,
                                                        r->event.start_mark.column + 1};
}

static dea_status read_node(struct reading *r, struct dea_node **out);

static dea_status read_value(struct reading *r, struct dea_node *node)
{
  const char *text = (const char *)r->event.data.scalar.value;
  const size_t size = r->event.data.scalar.length;
  if (strlen(text) != size) {
    return dea_refuse(r->ctx, node->location, "the value holds a zero byte");
  }
  unsigned code;
  size_t length;
  for (const char *c = text; *c != '\0'; c += length > 0 ? length : 1) {
    length = dea_letter_read(c, &code);
    if (dea_letter_is_control(code) && code != '\n' && code != '\t') {
      return dea_refuse(r->ctx, node->location, "the value holds a control character");
    }
  }
  node->empty = r->event.data.scalar.style == YAML_PLAIN_SCALAR_STYLE &&
                (text[0] == '\0' || strcmp(text, "~") == 0 || strcmp(text, "null") == 0);
  node->text = keep_text(r->yaml, text, size);
  return node->text != NULL ? DEA_OK : DEA_E_MEMORY;
}

static dea_status read_list(struct reading *r, struct dea_node *node)
{
  struct dea_node **last = &node->child;
  DEA_TRY(r->ctx, next_event(r));
  while (r->event.type != YAML_SEQUENCE_END_EVENT) {
    DEA_TRY(r->ctx, read_node(r, last));
    DEA_TRY(r->ctx, next_event(r));
    last = &(*last)->next;
    node->child_count++;
  }
  return DEA_OK;
}

static int compare_keys(const void *a, const void *b)
{
  const struct dea_node *x = *(struct dea_node *const *)a, *y = *(struct dea_node *const *)b;
  int order = strcmp(x->key, y->key);
  if (order != 0) {
    return order;
  }
  size_t i = x->key_place.line, j = y->key_place.line;
  size_t k = x->key_place.column, l = y->key_place.column;
  return i != j ? (i > j) - (i < j) : (k > l) - (k < l);
}

/* A finding for each key that stands twice; reading goes on. Sorted, so that a hostile file costs n
 * log n. */
static dea_status check_keys(struct reading *r, const struct dea_node *section)
{
  struct dea_node **sorted = dea_alloc(r->ctx, section->child_count, sizeof *sorted);
  DEA_TRY_MEMORY(sorted != NULL);
  size_t count = 0;
  for (struct dea_node *child = section->child; child != NULL; child = child->next) {
    sorted[count++] = child;
  }
  qsort(sorted, count, sizeof *sorted, compare_keys);
  dea_status status = DEA_OK;
  for (size_t i = 1; i < count && status == DEA_OK; i++) {
    if (strcmp(sorted[i]->key, sorted[i - 1]->key) == 0) {
      status = dea_finding_add(r->ctx, DEA_ERROR, sorted[i]->key_place,
                               "the key '%.60s' stands twice in this section, first in line %zu",
                               sorted[i]->key, sorted[i - 1]->key_place.line);
      if (status == DEA_OK && ++r->repeated == REPEATED_MAX) {
        status = dea_fail(r->ctx, DEA_E_DESIGN, "too many keys stand twice");
      }
    }
  }
  dea_free(r->ctx, sorted);
  return status;
}

static dea_status read_section(struct reading *r, struct dea_node *node)
{
  struct dea_node **last = &node->child;
  DEA_TRY(r->ctx, next_event(r));
  while (r->event.type != YAML_MAPPING_END_EVENT) {
    if (r->event.type != YAML_SCALAR_EVENT && r->event.type != YAML_ALIAS_EVENT) {
      return dea_refuse(r->ctx, place_of(r), "a key must be a word");
    }
    struct dea_node *key = NULL;
    DEA_TRY(r->ctx, read_node(r, &key));
    DEA_TRY(r->ctx, next_event(r));
    DEA_TRY(r->ctx, read_node(r, last));
    DEA_TRY(r->ctx, next_event(r));
    (*last)->key = key->text;
    (*last)->key_place = key->location;
    last = &(*last)->next;
    node->child_count++;
  }
  return check_keys(r, node);
}

/* The node that begins with the event, up to the event that it ends with. */
static dea_status read_node(struct reading *r, struct dea_node **out)
{
  const yaml_event_t *e = &r->event;
  const bool value = e->type == YAML_SCALAR_EVENT, list = e->type == YAML_SEQUENCE_START_EVENT;
  if (e->type == YAML_ALIAS_EVENT || (value  ? e->data.scalar.anchor
                                      : list ? e->data.sequence_start.anchor
                                             : e->data.mapping_start.anchor) != NULL) {
    return refuse(r, "anchors (&name) and aliases (*name) are not supported; write the value out");
  }
  if ((value  ? e->data.scalar.tag
       : list ? e->data.sequence_start.tag
              : e->data.mapping_start.tag) != NULL) {
    return refuse(r, "tags (!name) are not supported; write the plain value");
  }
  if (++r->nodes > DEA_YAML_NODES_MAX) {
    return refuse(r, "there are too many values for a design");
  }
  if (r->depth >= DEA_YAML_DEPTH_MAX) {
    return refuse(r, "sections and lists are nested too deeply");
  }
  struct dea_node *node = dea_arena_alloc(&r->yaml->memory, 1, sizeof *node);
  DEA_TRY_MEMORY(node != NULL);
  *node = (struct dea_node){.kind = value  ? DEA_NODE_VALUE
                                    : list ? DEA_NODE_LIST
                                           : DEA_NODE_SECTION,
                            .text = "",
                            .location = place_of(r),
                            .overridden = r->text->fixed != NULL};
  *out = node;
  r->depth++;
  DEA_TRY(r->ctx, value ? read_value(r, node) : list ? read_list(r, node) : read_section(r, node));
  r->depth--;
  return DEA_OK;
}

/* The one document of a text. */
static dea_status read_document(struct reading *r, struct dea_node **out)
{
  DEA_TRY(r->ctx, next_event(r)); // the stream begins
  DEA_TRY(r->ctx, next_event(r));
  if (r->event.type == YAML_STREAM_END_EVENT) {
    return refuse_at(r->ctx, r->text, (yaml_mark_t){0, 0, 0},
                     r->text->fixed != NULL ? "no value is given" : "the file is empty");
  }
  DEA_TRY(r->ctx, next_event(r));
  DEA_TRY(r->ctx, read_node(r, out));
  DEA_TRY(r->ctx, next_event(r)); // the document ends
  DEA_TRY(r->ctx, next_event(r));
  return r->event.type == YAML_STREAM_END_EVENT
             ? DEA_OK
             : refuse(r, "a second document starts here; a file holds one");
}

/* Reads text into nodes of yaml. fixed: place of all nodes, or NULL. */
static dea_status parse_into(struct dea_context *ctx, struct dea_yaml *yaml, const char *bytes,
                             size_t length, const struct dea_location *fixed, struct dea_node **out)
{
  const size_t mark = length >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0; // of editors
  const struct text text = {yaml->name, bytes + mark, length - mark, fixed};
  struct reading r = {.ctx = ctx, .yaml = yaml, .text = &text};
  if (yaml_parser_initialize(&r.parser) == 0) {
    return dea_fail(ctx, DEA_E_MEMORY, "out of memory in libyaml");
  }
  yaml_parser_set_encoding(&r.parser, YAML_UTF8_ENCODING);
  yaml_parser_set_input_string(&r.parser, (const unsigned char *)text.bytes, text.length);
  const dea_status status = read_document(&r, out);
  yaml_event_delete(&r.event);
  yaml_parser_delete(&r.parser);
  return status;
}

dea_status dea_yaml_parse(struct dea_context *ctx, const char *name, const char *bytes,
                          size_t length, struct dea_yaml **out)
{
  *out = NULL;
  struct dea_yaml *yaml = dea_alloc(ctx, 1, sizeof *yaml);
  DEA_TRY_MEMORY(yaml != NULL);
  yaml->memory.ctx = ctx;
  yaml->name = dea_intern(ctx, name);
  dea_status status = DEA_E_MEMORY;
  if (yaml->name != NULL) {
    status = parse_into(ctx, yaml, bytes, length, NULL, &yaml->root);
  }
  DEA_TRY_ELSE(ctx, status, dea_yaml_destroy(ctx, yaml));
  *out = yaml;
  return DEA_OK;
}

void dea_yaml_destroy(struct dea_context *ctx, struct dea_yaml *yaml)
{
  if (yaml == NULL) {
    return;
  }
  dea_arena_free(&yaml->memory);
  dea_free(ctx, yaml);
}

const struct dea_node *dea_yaml_root(const struct dea_yaml *yaml)
{
  return yaml->root;
}

const struct dea_node *dea_node_find(const struct dea_node *section, const char *key)
{
  for (const struct dea_node *child = section->child; child != NULL; child = child->next) {
    if (child->key != NULL && strcmp(child->key, key) == 0) {
      return child;
    }
  }
  return NULL;
}

dea_status dea_yaml_fragment(struct dea_context *ctx, struct dea_yaml *yaml,
                             struct dea_location location, const char *text,
                             const struct dea_node **out)
{
  struct dea_node *node = NULL;
  DEA_TRY(ctx, parse_into(ctx, yaml, text, strlen(text), &location, &node));
  *out = node;
  return DEA_OK;
}

/* Where the link to the member `key` of a section is, or the link at its end. */
static struct dea_node **link_of(struct dea_node *section, const char *key, size_t length)
{
  struct dea_node **link = &section->child;
  // a member of a section, or of a node before it
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference)
  while (*link != NULL &&
         !(strlen((*link)->key) == length && memcmp((*link)->key, key, length) == 0)) {
    link = &(*link)->next;
  }
  return link;
}

/* The section of a list whose `name` is that, or NULL. */
static struct dea_node *item_of(const struct dea_node *list, const char *name, size_t length)
{
  for (struct dea_node *item = list->child; item != NULL; item = item->next) {
    const struct dea_node *own =
        item->kind == DEA_NODE_SECTION ? dea_node_find(item, "name") : NULL;
    if (own != NULL && strlen(own->text) == length && memcmp(own->text, name, length) == 0) {
      return item;
    }
  }
  return NULL;
}

/* Where the link to item N of a list is, of a key "LIST[N]" of a section; NULL: it is none such. */
static struct dea_node **link_of_item(struct dea_node *section, const char *key, size_t length)
{
  const char *open = memchr(key, '[', length);
  char *end;
  if (open == NULL || open == key || !(open[1] >= '0' && open[1] <= '9')) {
    return NULL;
  }
  unsigned long left = strtoul(open + 1, &end, 10);
  struct dea_node *list = *link_of(section, key, (size_t)(open - key));
  if (end != key + length - 1 || *end != ']' || list == NULL || list->kind != DEA_NODE_LIST) {
    return NULL;
  }
  struct dea_node **link = &list->child;
  for (; *link != NULL && left > 0; left--) {
    link = &(*link)->next;
  }
  list->overridden = list->overridden || *link != NULL;
  return *link != NULL ? link : NULL;
}

/* Walks to the section that holds the last key of the path, making sections on the way; items of a
 * list go by their names. */
static dea_status walk(struct dea_context *ctx, struct dea_yaml *yaml, struct dea_location location,
                       const char **path, struct dea_node **section)
{
  struct dea_node *at = yaml->root;
  for (const char *dot; (dot = strchr(*path, '.')) != NULL;) {
    size_t length = (size_t)(dot - *path);
    struct dea_node **link = link_of_item(at, *path, length);
    link = link != NULL ? link : link_of(at, *path, length);
    if (*link == NULL) {
      struct dea_node *made = dea_arena_alloc(&yaml->memory, 1, sizeof *made);
      char *key = keep_text(yaml, *path, length);
      DEA_TRY_MEMORY(made != NULL && key != NULL);
      *made = (struct dea_node){DEA_NODE_SECTION, "",       false, true, key,
                                location,         location, NULL,  NULL, 0};
      *link = made;
      at->child_count++;
    }
    at = *link;
    *path = dot + 1;
    const char *end = at->kind == DEA_NODE_LIST ? strchr(*path, '.') : NULL;
    struct dea_node *item = end != NULL ? item_of(at, *path, (size_t)(end - *path)) : NULL;
    if (item != NULL) {
      at->overridden = true;
      at = item;
      *path = end + 1;
    }
    if (at->kind != DEA_NODE_SECTION) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location, "'%.60s' is %s, not a section%s",
                                   at->key != NULL ? at->key : "it",
                                   at->kind == DEA_NODE_LIST ? "a list" : "a value",
                                   end != NULL ? ", and has no item of that name" : ""));
      return dea_fail(ctx, DEA_E_DESIGN, "'%.60s' is not a section",
                      at->key != NULL ? at->key : "it");
    }
    at->overridden = true;
  }
  *section = at;
  return DEA_OK;
}

/* Puts a node into a section in the place of the member `key`; one without a value takes it away.
 */
static dea_status add(struct dea_yaml *yaml, struct dea_node *section, const char *key,
                      struct dea_location location, struct dea_node *node)
{
  struct dea_node **item = link_of_item(section, key, strlen(key));
  if (item != NULL) {
    node->next = (*item)->next;
    *item = node;
    return DEA_OK;
  }
  struct dea_node **link = link_of(section, key, strlen(key)), *old = *link;
  if (node->kind == DEA_NODE_VALUE && node->empty) {
    *link = old != NULL ? old->next : NULL;
    // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): walk sets it
    section->child_count -= old != NULL;
    return DEA_OK;
  }
  node->key = keep_text(yaml, key, strlen(key));
  DEA_TRY_MEMORY(node->key != NULL);
  node->key_place = location;
  node->next = old != NULL ? old->next : NULL;
  section->child_count += old == NULL; // NOLINT(clang-analyzer-core.NullDereference): walk sets it
  *link = node;
  return DEA_OK;
}

dea_status dea_yaml_override(struct dea_context *ctx, struct dea_yaml *yaml, const char *path,
                             const char *value)
{
  struct dea_text name = {.ctx = ctx};
  dea_text_add(&name, "--set %s", path);
  struct dea_location location = {.file =
                                      name.failed ? NULL : dea_intern(ctx, dea_text_get(&name))};
  dea_text_free(&name);
  DEA_TRY_MEMORY(location.file != NULL);
  if (yaml->root->kind != DEA_NODE_SECTION) {
    return DEA_OK; // the reader of the schema says so
  }
  struct dea_node *section = NULL, *node = NULL;
  DEA_TRY(ctx, walk(ctx, yaml, location, &path, &section));
  DEA_TRY(ctx, parse_into(ctx, yaml, value, strlen(value), &location, &node));
  return DEA_CHAIN(ctx, add(yaml, section, path, location, node));
}

enum { PATH_SIZE = 256 };

/* Merges a section's values below the path of that section, "" for the outermost. Recursion ends
 * with the depth of the document. */
static dea_status merge_below(struct dea_context *ctx, struct dea_yaml *yaml, const char *prefix,
                              const struct dea_node *changes)
{
  for (const struct dea_node *child = changes->child; child != NULL; child = child->next) {
    char whole[PATH_SIZE];
    int length =
        snprintf(whole, sizeof whole, "%s%s%s", prefix, prefix[0] != '\0' ? "." : "", child->key);
    if (length >= PATH_SIZE) {
      return dea_refuse(ctx, child->key_place, "the path of this key is too long");
    }
    if (child->kind == DEA_NODE_SECTION) {
      DEA_TRY(ctx, merge_below(ctx, yaml, whole, child));
      continue;
    }
    const char *path = whole;
    struct dea_node *section = NULL, *copy = dea_arena_alloc(&yaml->memory, 1, sizeof *copy);
    DEA_TRY_MEMORY(copy != NULL);
    *copy = *child;
    copy->overridden = true;
    DEA_TRY(ctx, walk(ctx, yaml, child->key_place, &path, &section));
    DEA_TRY(ctx, add(yaml, section, path, child->key_place, copy));
  }
  return DEA_OK;
}

dea_status dea_yaml_merge(struct dea_context *ctx, struct dea_yaml *yaml,
                          const struct dea_node *changes)
{
  if (yaml->root->kind != DEA_NODE_SECTION) {
    return DEA_OK; // the reader of the schema says so
  }
  return DEA_CHAIN(ctx, merge_below(ctx, yaml, "", changes));
}

/* Puts the next of the values in the place of each "$". */
static void fill_in(struct dea_node *node, bool overridden, const struct dea_node *const **values)
{
  node->overridden = overridden;
  for (struct dea_node *child = node->child; child != NULL; child = child->next) {
    if (child->kind == DEA_NODE_VALUE && strcmp(child->text, "$") == 0) {
      const struct dea_node before = *child;
      *child = **(*values)++;
      child->key = before.key;
      child->key_place = before.key_place;
      child->next = before.next;
    } else {
      fill_in(child, overridden, values);
    }
  }
}

dea_status dea_yaml_define(struct dea_context *ctx, struct dea_yaml *yaml,
                           const struct dea_node *used, const char *list, const char *name,
                           const char *text, const struct dea_node *const values[])
{
  struct dea_node *item = NULL, **link = link_of(yaml->root, list, strlen(list));
  struct dea_node *user = (struct dea_node *)used; // the document's own, and that is not const
  const struct dea_location place = used->location;
  if (text != NULL) {
    DEA_TRY(ctx, parse_into(ctx, yaml, text, strlen(text), &place, &item));
    fill_in(item, used->overridden, &values);
  }
  if (item != NULL && *link == NULL) {
    struct dea_node *made = dea_arena_alloc(&yaml->memory, 1, sizeof *made);
    char *key = keep_text(yaml, list, strlen(list));
    DEA_TRY_MEMORY(made != NULL && key != NULL);
    *made = (struct dea_node){.kind = DEA_NODE_LIST, .text = "", .key = key};
    made->location = made->key_place = place;
    *link = made;
    yaml->root->child_count++;
  }
  if (item != NULL && (*link)->kind == DEA_NODE_LIST) { // else the reader of the schema says so
    struct dea_node **end = &(*link)->child;
    while (*end != NULL) {
      end = &(*end)->next;
    }
    *end = item;
    (*link)->child_count++;
  }
  user->kind = DEA_NODE_VALUE;
  user->text = keep_text(yaml, name, strlen(name));
  user->child = NULL;
  user->child_count = 0;
  return user->text != NULL ? DEA_OK : DEA_E_MEMORY;
}
