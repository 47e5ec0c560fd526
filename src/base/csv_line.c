#include "base/csv_line.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

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

void dea_csv_add_name(struct dea_text *text, const char *name)
{
  bool quoted = strpbrk(name, ",\"\n") != NULL;
  dea_text_add(text, "%s", quoted ? "\"" : "");
  for (const char *c = name; *c != '\0'; c++) {
    dea_text_add(text, "%s%c", *c == '"' ? "\"" : "", *c);
  }
  dea_text_add(text, "%s", quoted ? "\"" : "");
}

void dea_csv_add_numbers(struct dea_text *text, int digits, const double *values, size_t count)
{
  for (size_t i = 0; i < count; i++) {
    if (isfinite(values[i])) {
      dea_text_add(text, ",%.*g", digits, values[i]);
    } else {
      dea_text_add(text, ",");
    }
  }
}
