#include "base/yaml_check.h"

#include <stdio.h>
#include <string.h>

dea_status dea_yaml_refuse(struct dea_context *ctx, const struct dea_yaml_text *text,
                           yaml_mark_t mark, const char *message)
{
  const struct dea_location place = {text->name, mark.line + 1, mark.column + 1};
  return dea_refuse(ctx, text->fixed != NULL ? *text->fixed : place, message);
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

dea_status dea_yaml_problem(struct dea_context *ctx, const struct dea_yaml_text *text,
                            const yaml_parser_t *parser)
{
  char message[300];
  const char *problem = parser->problem != NULL ? parser->problem : "unknown";
  if (parser->error == YAML_MEMORY_ERROR) {
    return dea_fail(ctx, DEA_E_MEMORY, "out of memory in libyaml");
  }
  if (parser->error == YAML_READER_ERROR) {
    snprintf(message, sizeof message, "this is not a text file in UTF-8: %s", problem);
    return dea_yaml_refuse(ctx, text, mark_of_byte(text, parser->problem_offset), message);
  }
  yaml_mark_t place = parser->problem_mark;
  const char *words = in_words(text, parser, problem, &place);
  if (words != NULL) {
    return dea_yaml_refuse(ctx, text, place, words);
  }
  const bool context = parser->context != NULL;
  int length = snprintf(message, sizeof message, "this is not YAML: %s%s%s", problem,
                        context ? " " : "", context ? parser->context : "");
  if (context && parser->context_mark.line != place.line) {
    snprintf(message + length, sizeof message - (size_t)length, " that begins in line %zu",
             parser->context_mark.line + 1);
  }
  return dea_yaml_refuse(ctx, text, place, message);
}
