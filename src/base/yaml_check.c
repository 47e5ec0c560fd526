#include "base/yaml_check.h"

#include "base/yaml.h"

#include <stdio.h>
#include <string.h>
#include <yaml.h>

/* State of the pass. */
struct check {
  struct dea_context *ctx;
  const struct dea_yaml_text *text;
  size_t depth, nodes, documents;
  bool done;
};

static dea_status refuse(const struct check *check, yaml_mark_t mark, const char *message)
{
  struct dea_location location = {check->text->name, mark.line + 1, mark.column + 1};
  DEA_TRY(check->ctx, dea_finding_add(check->ctx, DEA_ERROR,
                                      check->text->fixed != NULL ? *check->text->fixed : location,
                                      "%s", message));
  return dea_fail(check->ctx, DEA_E_DESIGN, "%s", message);
}

/* Line and column of a byte, which libyaml does not know for text that it cannot decode. */
static yaml_mark_t mark_of_byte(const struct dea_yaml_text *text, size_t offset)
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
static size_t byte_at(const struct dea_yaml_text *text, yaml_mark_t mark)
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
static bool follows_colon(const struct dea_yaml_text *text, size_t at)
{
  for (; at > 0 && text->bytes[at - 1] != '\n'; at--) {
    if (at > 1 && text->bytes[at - 1] == ' ' && text->bytes[at - 2] == ':') {
      return true;
    }
  }
  return false;
}

/* What libyaml's problem is in words of who wrote the file, and where to look; NULL: in its own. */
static const char *in_words(const struct dea_yaml_text *text, const yaml_parser_t *parser,
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

static dea_status parser_failed(const struct check *check, const yaml_parser_t *parser)
{
  char message[300];
  const char *problem = parser->problem != NULL ? parser->problem : "unknown";
  if (parser->error == YAML_MEMORY_ERROR) {
    return dea_fail(check->ctx, DEA_E_MEMORY, "out of memory in libyaml");
  }
  if (parser->error == YAML_READER_ERROR) {
    snprintf(message, sizeof message, "this is not a text file in UTF-8: %s", problem);
    return refuse(check, mark_of_byte(check->text, parser->problem_offset), message);
  }
  yaml_mark_t place = parser->problem_mark;
  const char *words = in_words(check->text, parser, problem, &place);
  if (words != NULL) {
    return refuse(check, place, words);
  }
  const bool context = parser->context != NULL;
  int length = snprintf(message, sizeof message, "this is not YAML: %s%s%s", problem,
                        context ? " " : "", context ? parser->context : "");
  if (context && parser->context_mark.line != place.line) {
    snprintf(message + length, sizeof message - (size_t)length, " that begins in line %zu",
             parser->context_mark.line + 1);
  }
  return refuse(check, place, message);
}

/* A value, list or section starts. */
static dea_status check_node(struct check *check, const yaml_event_t *event,
                             const yaml_char_t *anchor, const yaml_char_t *tag)
{
  if (anchor != NULL) {
    return refuse(check, event->start_mark,
                  "anchors (&name) and aliases (*name) are not supported; write the value out");
  }
  if (tag != NULL) {
    return refuse(check, event->start_mark,
                  "tags (!name) are not supported; write the plain value");
  }
  if (++check->nodes > DEA_YAML_NODES_MAX) {
    return refuse(check, event->start_mark, "there are too many values for a design");
  }
  if (check->depth >= DEA_YAML_DEPTH_MAX) {
    return refuse(check, event->start_mark, "sections and lists are nested too deeply");
  }
  return DEA_OK;
}

static dea_status check_event(struct check *check, const yaml_event_t *event)
{
  dea_status status = DEA_OK;
  switch (event->type) {
  case YAML_SCALAR_EVENT:
    return check_node(check, event, event->data.scalar.anchor, event->data.scalar.tag);
  case YAML_SEQUENCE_START_EVENT:
    status =
        check_node(check, event, event->data.sequence_start.anchor, event->data.sequence_start.tag);
    check->depth++;
    return status;
  case YAML_MAPPING_START_EVENT:
    status =
        check_node(check, event, event->data.mapping_start.anchor, event->data.mapping_start.tag);
    check->depth++;
    return status;
  case YAML_SEQUENCE_END_EVENT:
  case YAML_MAPPING_END_EVENT:
    check->depth--;
    return DEA_OK;
  case YAML_ALIAS_EVENT:
    return check_node(check, event, event->data.alias.anchor, NULL);
  case YAML_DOCUMENT_START_EVENT:
    return ++check->documents == 1 ? DEA_OK
                                   : refuse(check, event->start_mark,
                                            "a second document starts here; a file holds one");
  case YAML_STREAM_END_EVENT:
    check->done = true;
    return check->documents > 0
               ? DEA_OK
               : refuse(check, (yaml_mark_t){0, 0, 0},
                        check->text->fixed != NULL ? "no value is given" : "the file is empty");
  case YAML_NO_EVENT:
  case YAML_STREAM_START_EVENT:
  case YAML_DOCUMENT_END_EVENT:
    return DEA_OK;
  }
  return DEA_OK;
}

dea_status dea_yaml_check(struct dea_context *ctx, const struct dea_yaml_text *text)
{
  struct check check = {.ctx = ctx, .text = text};
  dea_status status = DEA_OK;
  yaml_parser_t parser;
  if (yaml_parser_initialize(&parser) == 0) {
    return dea_fail(ctx, DEA_E_MEMORY, "out of memory in libyaml");
  }
  yaml_parser_set_encoding(&parser, YAML_UTF8_ENCODING);
  yaml_parser_set_input_string(&parser, (const unsigned char *)text->bytes, text->length);
  while (status == DEA_OK && !check.done) {
    yaml_event_t event;
    if (yaml_parser_parse(&parser, &event) == 0) {
      status = parser_failed(&check, &parser);
    } else {
      status = check_event(&check, &event);
      yaml_event_delete(&event);
    }
  }
  yaml_parser_delete(&parser);
  return status;
}
