#include "base/html.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bytes of the first letter; 0 for what is none of text: not UTF-8, or a control sign. */
static size_t sign_length(const char *c)
{
  unsigned code;
  size_t length = dea_letter_read(c, &code);
  return dea_letter_is_control(code) && code != '\t' && code != '\n' ? 0 : length;
}

/* What JSON within HTML has to write in another way; buffer[8] for the answer. */
static const char *json_name(char c, char *buffer)
{
  if (c == '<' || c == '>' || c == '&' || c == '"' || c == '\\' || c == '\'' ||
      (unsigned char)c < ' ') {
    snprintf(buffer, 8, "\\u%04x", (unsigned)(unsigned char)c);
    return buffer;
  }
  return NULL;
}

static void add_safe(struct dea_text *out, const char *text, bool json)
{
  char buffer[8];
  const char *from = text, *c = text;
  while (c != NULL && *c != '\0') {
    size_t length = sign_length(c);
    const char *name = length == 0 ? "\357\277\275"
                       : json      ? json_name(*c, buffer)
                                   : dea_entity_name((unsigned char)*c);
    if (name != NULL) {
      dea_text_add(out, "%.*s%s", (int)(c - from), from, name);
      from = c + (length > 0 ? length : 1);
    }
    c += length > 0 ? length : 1;
  }
  if (c != from) {
    dea_text_add(out, "%.*s", (int)(c - from), from);
  }
}

void dea_html_text(struct dea_text *out, const char *text)
{
  add_safe(out, text, false);
}

void dea_html_element(struct dea_text *out, const char *tag, const char *text)
{
  dea_text_add(out, "<%s>", tag);
  dea_html_text(out, text);
  dea_text_add(out, "</%.*s>", (int)strcspn(tag, " "), tag);
}

void dea_html_number(struct dea_text *out, double value, int digits)
{
  char number[40];
  if (!isfinite(value)) {
    dea_text_add(out, "\342\200\223"); // en dash
    return;
  }
  snprintf(number, sizeof number, "%.*g", digits, fabs(value));
  if (strchr(number, 'e') != NULL && fabs(value) >= 1 && fabs(value) < 1e6) {
    snprintf(number, sizeof number, "%.0f", fabs(value)); // 5017 rather than 5.02 10^3
  }
  char *power = strchr(number, 'e');
  bool zero = strtod(number, NULL) == 0;
  dea_text_add(out, "%s", value < 0 && !zero ? "\342\210\222" : ""); // minus sign
  if (power != NULL) {
    *power = '\0';
    dea_text_add(out, "%s\302\26710<sup>%s%d</sup>", number, power[1] == '-' ? "\342\210\222" : "",
                 abs((int)strtol(power + 1, NULL, 10)));
  } else {
    dea_text_add(out, "%s", number);
  }
}

/* Adds what a conversion of printf, with its letter at its end, makes of the next argument. */
static void add_converted(struct dea_text *out, const char *conversion, char letter, va_list *args)
{
  switch (letter) {
  case 's':
    dea_html_text(out, va_arg(*args, const char *));
    break;
  case 'd':
    dea_text_add(out, conversion, va_arg(*args, int));
    break;
  case 'u':
    dea_text_add(out, conversion, va_arg(*args, size_t));
    break;
  case 'x':
    dea_text_add(out, conversion, va_arg(*args, unsigned));
    break;
  case 'f':
  case 'g':
    dea_text_add(out, conversion, va_arg(*args, double));
    break;
  case 'G':
    dea_html_number(out, va_arg(*args, double), conversion[2] - '0');
    break;
  default:
    dea_text_add(out, "%c", letter);
  }
}

void dea_html_add(struct dea_text *out, const char *format, ...)
{
  va_list args;
  va_start(args, format);
  for (const char *c = format; *c != '\0';) {
    size_t length = strcspn(c, "%");
    dea_text_add(out, "%.*s", (int)length, c);
    c += length;
    if (*c != '\0') {
      char conversion[8] = {0};
      length = 2 + strcspn(c + 1, "%sduxfgG");
      memcpy(conversion, c, length < sizeof conversion ? length : sizeof conversion - 1);
      add_converted(out, conversion, c[length - 1], &args);
      c += length;
    }
  }
  va_end(args);
}

void dea_html_cell(struct dea_text *out, double value, int digits)
{
  dea_text_add(out, "<td class=\"n\">");
  dea_html_number(out, value, digits);
  dea_text_add(out, "</td>");
}

/* A number to a power of ten, with its zeros. */
static void add_rounded(struct dea_text *out, double value, int power)
{
  double step = pow(10, power), rounded = step * round(value / step);
  dea_text_add(out, "%s%.*f", rounded < 0 ? "\342\210\222" : "", power < 0 ? -power : 0,
               fabs(rounded));
}

void dea_html_estimate(struct dea_text *out, double value, double error, int digits)
{
  const double least = 1e-3;
  if (isfinite(value) && error > least) {
    int power = (int)floor(log10(error));
    add_rounded(out, value, power);
    dea_text_add(out, " \302\261 ");
    add_rounded(out, error, power);
  } else if (isfinite(value) && fabs(value) > least) {
    add_rounded(out, value, (int)floor(log10(fabs(value))) + 1 - digits);
  } else {
    dea_html_number(out, fabs(value) < 1e-9 ? 0 : value, digits);
  }
}

void dea_html_json_number(struct dea_text *out, double value, int digits)
{
  if (isfinite(value)) {
    dea_text_add(out, "%.*g", digits, value);
  } else {
    dea_text_add(out, "null");
  }
}

/* One sign of a label, escaped; returns what follows. A backslash before it is dropped. */
static const char *add_sign(struct dea_text *out, const char *c, enum dea_label_form form)
{
  while (*c == '\\') {
    c++;
  }
  size_t length = *c == '\0' ? 0 : sign_length(c);
  char sign[5] = {0};
  memcpy(sign, c, length);
  add_safe(out, sign, form == DEA_LABEL_JSON);
  return c + (length > 0 ? length : *c != '\0');
}

/* The inside of braces or one sign, raised or lowered. */
static const char *add_shifted(struct dea_text *out, const char *c, bool up,
                               enum dea_label_form form)
{
  bool plain = form != DEA_LABEL_SVG;
  dea_text_add(out, "%s",
               plain ? (up ? "^" : "")
               : up  ? "<tspan class=\"small\" dy=\"-0.4em\">"
                     : "<tspan class=\"small\" dy=\"0.25em\">");
  if (*c == '{') {
    for (c++; *c != '\0' && *c != '}';) {
      c = add_sign(out, c, form);
    }
    c += *c == '}';
  } else {
    c = add_sign(out, c, form);
  }
  // the next sign goes back to the line; one of no width, as nothing may follow
  dea_text_add(out, "%s",
               plain ? ""
               : up  ? "</tspan><tspan dy=\"0.3em\">\342\200\213</tspan>"
                     : "</tspan><tspan dy=\"-0.19em\">\342\200\213</tspan>");
  return c;
}

void dea_html_label(struct dea_text *out, const char *label, enum dea_label_form form)
{
  static const char italic[] = "{/:Italic ";
  bool slanted = false, plain = form != DEA_LABEL_SVG;
  for (const char *c = label; *c != '\0';) {
    if (strncmp(c, italic, sizeof italic - 1) == 0) {
      c += sizeof italic - 1;
      slanted = true;
      dea_text_add(out, "%s", plain ? "" : "<tspan class=\"it\">");
    } else if (*c == '}') {
      dea_text_add(out, "%s", slanted && !plain ? "</tspan>" : "");
      slanted = false;
      c++;
    } else if (*c == '{') {
      c++;
    } else if (*c == '_' || *c == '^') {
      c = add_shifted(out, c + 1, *c == '^', form);
    } else {
      c = add_sign(out, c, form);
    }
  }
  dea_text_add(out, "%s", slanted && !plain ? "</tspan>" : "");
}

void dea_html_base64(struct dea_text *out, const void *bytes, size_t length)
{
  static const char signs[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  enum { LINE = 768 }; // a multiple of 3
  const unsigned char *in = bytes;
  for (size_t from = 0; from < length; from += LINE) {
    char line[LINE / 3 * 4 + 1];
    size_t end = from + LINE < length ? from + LINE : length, n = 0;
    for (size_t i = from; i < end; i += 3) {
      size_t have = end - i < 3 ? end - i : 3;
      unsigned three = (unsigned)in[i] << 16 | (have > 1 ? (unsigned)in[i + 1] << 8 : 0) |
                       (have > 2 ? (unsigned)in[i + 2] : 0);
      for (unsigned k = 0; k < 4; k++) {
        line[n++] = k <= have ? signs[three >> (18 - 6 * k) & 63] : '=';
      }
    }
    line[n] = '\0';
    dea_text_add(out, "%s", line);
  }
}
