#define _GNU_SOURCE // newlocale, uselocale, strtod_l
#include "base/text.h"

#include <ctype.h>
#include <locale.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool text_reserve(struct dea_text *text, size_t more)
{
  if (text->length + more + 1 <= text->capacity) {
    return true;
  }
  size_t wanted = 2 * text->capacity + more + 64;
  char *moved = dea_resize(text->ctx, text->data, wanted, 1);
  if (moved == NULL) {
    text->failed = true;
    return false;
  }
  text->data = moved;
  text->capacity = wanted;
  return true;
}

void dea_text_add(struct dea_text *text, const char *format, ...)
{
  va_list args, again;
  size_t capacity = text->capacity - text->length;
  const locale_t c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0); // there already
  const locale_t before = uselocale(c_locale);
  va_start(args, format);
  va_copy(again, args);
  int needed = vsnprintf(capacity > 0 ? text->data + text->length : NULL, capacity, format, args);
  va_end(args);
  if (needed < 0) {
    text->failed = true;
  } else if ((size_t)needed < capacity) {
    text->length += (size_t)needed;
  } else if (text_reserve(text, (size_t)needed)) {
    vsnprintf(text->data + text->length, (size_t)needed + 1, format, again);
    text->length += (size_t)needed;
  } else if (capacity > 0) { // what did not fit whole is not there
    text->data[text->length] = '\0';
  }
  va_end(again);
  uselocale(before);
  freelocale(c_locale);
}

void dea_text_add_bytes(struct dea_text *text, const void *bytes, size_t length)
{
  if (text_reserve(text, length)) {
    if (length > 0) {
      memcpy(text->data + text->length, bytes, length);
    }
    text->length += length;
    text->data[text->length] = '\0';
  }
}

const char *dea_text_get(const struct dea_text *text)
{
  return text->data != NULL ? text->data : "";
}

dea_status dea_text_free(struct dea_text *text)
{
  dea_free(text->ctx, text->data);
  text->data = NULL;
  text->length = text->capacity = 0;
  return text->failed ? DEA_E_MEMORY : DEA_OK;
}

void dea_text_free_in(struct dea_text *text, struct dea_text *outer)
{
  outer->failed |= dea_text_free(text) != DEA_OK;
}

size_t dea_letter_read(const char *text, unsigned *code)
{
  static const unsigned mask[4] = {0x7f, 0x1f, 0x0f, 0x07}, least[4] = {0, 0x80, 0x800, 0x10000};
  const unsigned char *c = (const unsigned char *)text;
  size_t more = c[0] >= 0xf0 ? 3 : c[0] >= 0xe0 ? 2 : c[0] >= 0xc0 ? 1 : 0;
  bool good = c[0] < 0x80 || (c[0] >= 0xc0 && c[0] < 0xf8);
  unsigned letter = c[0] & mask[more];
  for (size_t i = 1; good && i <= more; i++) {
    good = (c[i] & 0xc0) == 0x80;
    letter = letter << 6 | (c[i] & 0x3fu);
  }
  good =
      good && letter >= least[more] && letter <= 0x10ffff && (letter < 0xd800 || letter > 0xdfff);
  *code = good ? letter : 0xfffd;
  return good ? more + 1 : 0;
}

bool dea_letter_is_control(unsigned code)
{
  bool directs = code == 0x61c || code == 0x200e || code == 0x200f ||
                 (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
  return code < 0x20 || (code >= 0x7f && code < 0xa0) || directs;
}

size_t dea_text_cut(const char *text, size_t most)
{
  size_t n = strlen(text);
  n = n < most ? n : most;
  while (n > 0 && ((unsigned char)text[n] & 0xc0) == 0x80) {
    n--;
  }
  return n;
}

void dea_text_flatten(char *text)
{
  unsigned code;
  while (*text != '\0') {
    const size_t length = dea_letter_read(text, &code), bytes = length > 0 ? length : 1;
    if (dea_letter_is_control(code)) {
      memset(text, ' ', bytes);
    }
    text += bytes;
  }
}

const char *dea_entity_name(unsigned code)
{
  static const char *const names[] = {
      ['<'] = "&lt;", ['>'] = "&gt;", ['&'] = "&amp;", ['"'] = "&quot;", ['\''] = "&#39;"};
  return code < DEA_COUNT(names) ? names[code] : NULL;
}

enum { NAME_MAX_LENGTH = 63 };

/* Damerau-Levenshtein distance in its restricted form; words longer than the limit never match. */
static size_t edit_distance(const char *a, const char *b)
{
  size_t n = strlen(a), m = strlen(b);
  size_t row[3][NAME_MAX_LENGTH + 2];
  if (n > NAME_MAX_LENGTH || m > NAME_MAX_LENGTH) {
    return NAME_MAX_LENGTH;
  }
  for (size_t j = 0; j <= m; j++) {
    row[0][j] = j;
  }
  for (size_t i = 1; i <= n; i++) {
    size_t *now = row[i % 3];
    const size_t *last = row[(i + 2) % 3], *before = row[(i + 1) % 3];
    now[0] = i;
    for (size_t j = 1; j <= m; j++) {
      int x = tolower((unsigned char)a[i - 1]), y = tolower((unsigned char)b[j - 1]);
      size_t best = last[j - 1] + (x != y);
      best = last[j] + 1 < best ? last[j] + 1 : best;
      best = now[j - 1] + 1 < best ? now[j - 1] + 1 : best;
      if (i > 1 && j > 1 && x == tolower((unsigned char)b[j - 2]) &&
          y == tolower((unsigned char)a[i - 2]) && before[j - 2] + 1 < best) {
        best = before[j - 2] + 1;
      }
      now[j] = best;
    }
  }
  return row[n % 3][m];
}

/* Whether one is the beginning of the other, which says something from three characters on. */
static bool begins_alike(const char *a, const char *b)
{
  size_t n = strlen(a) < strlen(b) ? strlen(a) : strlen(b);
  return n >= 3 && strncasecmp(a, b, n) == 0;
}

const char *dea_nearest_name(const char *word, const char *const candidates[], size_t count)
{
  size_t limit = strlen(word) / 3 > 1 ? strlen(word) / 3 : 1, best = limit + 1;
  const char *nearest = NULL;
  for (size_t i = 0; i < count; i++) {
    size_t d = edit_distance(word, candidates[i]);
    if (d < best) {
      best = d;
      nearest = candidates[i];
    }
  }
  size_t alike = 0;
  for (size_t i = 0; i < count && best > limit; i++) {
    bool begins = begins_alike(word, candidates[i]);
    nearest = begins ? candidates[i] : nearest;
    alike += begins ? 1 : 0;
  }
  return best > limit && alike != 1 ? NULL : nearest;
}

const char *dea_names_list(const char *const names[], size_t count, char out[DEA_HINT_SIZE])
{
  size_t used = 0;
  out[0] = '\0';
  for (size_t i = 0; i < count && used < DEA_HINT_SIZE; i++) {
    used += (size_t)snprintf(out + used, DEA_HINT_SIZE - used, "%s%s", i > 0 ? ", " : "", names[i]);
  }
  return out;
}

const char *dea_name_hint(const char *word, const char *const names[], size_t count,
                          char out[DEA_HINT_SIZE])
{
  const char *nearest = dea_nearest_name(word, names, count);
  snprintf(out, DEA_HINT_SIZE, "%s%s%s", nearest != NULL ? "; did you mean '" : "",
           nearest != NULL ? nearest : "", nearest != NULL ? "'?" : "");
  return out;
}

const char *dea_name_hint_list(const char *word, const char *const names[], size_t count,
                               const char *near, const char *far, char out[DEA_HINT_SIZE])
{
  char list[DEA_HINT_SIZE];
  const size_t used = strlen(dea_name_hint(word, names, count, out));
  const char *before = used > 0 ? near : far;
  if (before != NULL) {
    snprintf(out + used, DEA_HINT_SIZE - used, "%s%s", before,
             count > 0 ? dea_names_list(names, count, list) : "none");
  }
  return out;
}

dea_status dea_unknown_name(struct dea_context *ctx, const char *what, const char *name,
                            const char *const known[], size_t count)
{
  char hint[DEA_HINT_SIZE];
  return dea_fail(ctx, DEA_E_ARGUMENT, "there is no %s '%.100s'%s", what, name,
                  dea_name_hint(name, known, count, hint));
}

double dea_text_to_double(const char *text, const char **end)
{
  char *stop = NULL;
  const locale_t c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
  const double value = strtod_l(text, &stop, c_locale);
  freelocale(c_locale);
  *end = stop;
  return value;
}

bool dea_text_ends_with(const char *text, const char *end)
{
  const size_t length = strlen(text), tail = strlen(end);
  return length >= tail && strcmp(text + length - tail, end) == 0;
}
