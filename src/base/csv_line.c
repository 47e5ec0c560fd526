#include "base/csv_line.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

char dea_csv_separator(const char *line)
{
  return strchr(line, ';') != NULL ? ';' : strchr(line, '\t') != NULL ? '\t' : ',';
}

bool dea_csv_field(const char *line, const char **cursor, char separator, char *out, size_t *column)
{
  const char *c = *cursor;
  if (c == NULL) {
    return false;
  }
  while ((*c == ' ' || *c == '\t') && *c != separator) {
    c++;
  }
  *column = (size_t)(c - line) + 1;
  bool quoted = *c == '"';
  c += quoted;
  size_t n = 0;
  for (; *c != '\0' && (quoted || *c != separator); c++) {
    if (quoted && *c == '"') {
      if (c[1] != '"') {
        quoted = false;
        continue;
      }
      c++;
    }
    if (n < DEA_CSV_FIELD_MAX - 1) {
      out[n++] = *c;
    }
  }
  while (n > 0 && isspace((unsigned char)out[n - 1])) {
    n--;
  }
  out[n] = '\0';
  *cursor = *c == '\0' ? NULL : c + 1;
  return true;
}

void dea_csv_fold(const char *text, char *out)
{
  size_t n = 0;
  for (; *text != '\0' && n < DEA_CSV_FIELD_MAX - 1; text++) {
    unsigned char c = (unsigned char)*text;
    c = c == '_' || c == '-' || isspace(c) ? ' ' : (unsigned char)tolower(c);
    if (c != ' ' || (n > 0 && out[n - 1] != ' ')) {
      out[n++] = (char)c;
    }
  }
  while (n > 0 && out[n - 1] == ' ') {
    n--;
  }
  out[n] = '\0';
}

void dea_csv_split_title(const char *title, char *name, char *unit)
{
  char bare[DEA_CSV_FIELD_MAX];
  size_t open = strcspn(title, "([");
  size_t close = open + strcspn(title + open, ")]");
  unit[0] = '\0';
  if (title[open] != '\0' && title[close] != '\0') {
    snprintf(unit, DEA_CSV_FIELD_MAX, "%.*s", (int)(close - open - 1), title + open + 1);
    snprintf(bare, sizeof bare, "%.*s %s", (int)open, title, title + close + 1);
  } else {
    snprintf(bare, sizeof bare, "%s", title);
  }
  dea_csv_fold(bare, name);
}

bool dea_csv_number(char separator, char *text, double *value)
{
  *value = NAN;
  if (text[0] == '\0') {
    return true;
  }
  char *comma = strchr(text, ',');
  if (comma != NULL && separator != ',' && strchr(text, '.') == NULL) {
    *comma = '.';
  }
  const char *end;
  *value = dea_text_to_double(text, &end);
  return end != text && *end == '\0' && !isinf(*value);
}

char *dea_csv_line(char **text, size_t *line)
{
  char *next = *text;
  if (*line == 0 && next != NULL && strncmp(next, "\xef\xbb\xbf", 3) == 0) {
    next += 3; // byte order mark
  }
  while (next != NULL && *next != '\0') {
    char *found = next;
    next = strchr(found, '\n');
    if (next != NULL) {
      *next++ = '\0';
    }
    found[strcspn(found, "\r")] = '\0';
    ++*line;
    size_t blank = strspn(found, " \t,;\"");
    if (found[blank] != '\0' && found[strspn(found, " \t")] != '#') {
      *text = next;
      return found;
    }
  }
  *text = NULL;
  return NULL;
}

void dea_csv_add_name(struct dea_text *text, const char *name)
{
  bool quoted = strpbrk(name, ",\"\n") != NULL;
  dea_text_add(text, "%s", quoted ? "\"" : "");
  for (const char *c = name; *c != '\0'; c++) {
    dea_text_add(text, "%s%c", *c == '"' ? "\"" : "", *c);
  }
  dea_text_add(text, "%s", quoted ? "\"" : "");
}
