#define _POSIX_C_SOURCE 200809L // iconv
#include "table/text_file.h"

#include "table/fields.h"

#include <iconv.h>
#include <string.h>

enum { HEAD_BYTES = 1 << 20 }; // in which its letters are looked at

/* NULL: there is no mark of UTF-16. */
static const char *utf16_of(const unsigned char *bytes, size_t length)
{
  const unsigned mark = length < 2 ? 0U : (unsigned)bytes[0] << 8 | bytes[1];
  return mark == 0xfffe ? "UTF-16LE" : mark == 0xfeff ? "UTF-16BE" : NULL;
}

bool dea_text_file_is(const unsigned char *head, size_t length)
{
  return utf16_of(head, length) != NULL || memchr(head, 0, length) == NULL;
}

static bool is_utf8(const unsigned char *bytes, size_t length)
{
  for (size_t i = 0; i < length;) {
    size_t more = bytes[i] < 0x80 ? 0 : bytes[i] >= 0xf0 ? 3 : bytes[i] >= 0xe0 ? 2 : 1;
    if ((bytes[i] >= 0x80 && bytes[i] < 0xc2) || bytes[i] > 0xf4 || i + more >= length) {
      return false;
    }
    for (size_t k = 1; k <= more; k++) {
      if ((bytes[i + k] & 0xc0) != 0x80) {
        return false;
      }
    }
    i += more + 1;
  }
  return true;
}

/* What the bytes beyond ASCII look like, of a text that is no UTF-8. */
struct letters {
  size_t runs;       // of three and more, which words of Latin-1 do not have
  bool odd;          // one of these has an odd number: single bytes
  size_t japanese;   // pairs of Shift-JIS that begin with 0x81 to 0x9f
  bool pairs;        // all are pairs from 0xa1 on
  size_t count, far; // of these; those beyond the Korean ones (0xb0 to 0xc8) and signs
  bool cyrillic;     // all are letters of Windows-1251
};

static struct letters find_encoding(const unsigned char *bytes, size_t length)
{
  struct letters l = {.pairs = true, .cyrillic = true};
  size_t run = 0;
  for (size_t i = 0; i <= length; i++) {
    if (i < length && bytes[i] >= 0x80) {
      run++;
      l.cyrillic = l.cyrillic && (bytes[i] >= 0xc0 || bytes[i] == 0xa8 || bytes[i] == 0xb8);
      continue;
    }
    l.runs += run >= 3;
    l.odd = l.odd || (run >= 3 && run % 2 == 1);
    run = 0;
  }
  for (size_t i = 0; i < length && l.pairs; i++) {
    const bool high = bytes[i] >= 0x80;
    l.pairs = !high || (i + 1 < length && bytes[i] >= 0xa1 && bytes[i] <= 0xf7 &&
                        bytes[i + 1] >= 0xa1 && bytes[i + 1] <= 0xfe);
    l.count += high;
    l.far += high && bytes[i] > 0xc8;
    i += high;
  }
  for (size_t i = 0; i + 1 < length; i++) {
    const bool lead = (bytes[i] >= 0x81 && bytes[i] <= 0x9f) || bytes[i] >= 0xe0;
    l.japanese += bytes[i] >= 0x81 && bytes[i] <= 0x9f;
    i += lead;
  }
  return l;
}

/* The encoding of bytes that are no Unicode, by a rule each: Shift-JIS has pairs whose first byte
 * no other one uses for letters; of Chinese and Korean ones only the Chinese go beyond 0xc8;
 * Cyrillic words have odd numbers of letters; Latin-1 has signs and single letters. "": Latin-1,
 * which stays as it is. NULL: none fits, or more than one. */
static const char *encoding_of(const unsigned char *bytes, size_t length)
{
  enum { ENOUGH = 2 };
  const struct letters l = find_encoding(bytes, length);
  if (l.pairs && l.count >= ENOUGH) {
    return l.far > 0 && !(l.cyrillic && !l.odd && l.runs > 0) ? "GB18030" : NULL;
  }
  if (l.cyrillic && l.odd) {
    return "CP1251";
  }
  return l.japanese >= ENOUGH ? "CP932" : l.runs == 0 ? "" : NULL;
}

/* The text as UTF-8. false: it is none of that encoding, or out of memory, and *copy is NULL. */
static bool convert(struct dea_context *ctx, const char *encoding, struct dea_slice text,
                    char **copy, struct dea_slice *out)
{
  iconv_t converter = iconv_open("UTF-8", encoding);
  if (converter == (iconv_t)-1) {
    return false;
  }
  size_t left = text.length, most = 3 * text.length + 4, capacity = most;
  *copy = dea_alloc(ctx, most, 1);
  char *from = (char *)text.text, *to = *copy;
  const bool good = to != NULL && iconv(converter, &from, &left, &to, &capacity) != (size_t)-1;
  iconv_close(converter);
  if (good) {
    *out = (struct dea_slice){*copy, most - capacity};
  } else {
    dea_free(ctx, *copy);
    *copy = NULL;
  }
  return good;
}

/* Where the first byte beyond ASCII stands. */
static struct dea_location find_letter(const char *file, struct dea_slice text)
{
  struct dea_location at = {file, 1, 1};
  for (size_t i = 0; i < text.length && (unsigned char)text.text[i] < 0x80; i++) {
    at.column = text.text[i] == '\n' ? 1 : at.column + 1;
    at.line += text.text[i] == '\n';
  }
  return at;
}

/* Full-width signs of Japanese and Chinese keyboards ("\xef\xbc\x88kV\xef\xbc\x89") become those
 * of ASCII. */
static dea_status narrow(struct dea_context *ctx, char **copy, struct dea_slice *text)
{
  if (dea_slice_find(*text, "\xef\xbc") == text->length &&
      dea_slice_find(*text, "\xef\xbd") == text->length) {
    return DEA_OK;
  }
  char *out = dea_alloc(ctx, text->length, 1);
  DEA_TRY_MEMORY(out != NULL);
  size_t n = 0;
  for (size_t i = 0; i < text->length; i++) {
    const unsigned char *c = (const unsigned char *)text->text + i;
    const bool wide = i + 2 < text->length && c[0] == 0xef &&
                      ((c[1] == 0xbc && c[2] >= 0x81) || (c[1] == 0xbd && c[2] <= 0x9e));
    out[n++] = (char)(wide ? c[2] + (c[1] == 0xbd ? 0x60 : 0x20) - 0x80 : c[0]);
    i += wide ? 2 : 0;
  }
  dea_free(ctx, *copy);
  *copy = out;
  *text = (struct dea_slice){out, n};
  return DEA_OK;
}

/* Text that is no UTF-8 as such; Latin-1 stays. *copy: the text where it had to be converted, the
 * caller's; else NULL and the bytes are lent. */
static dea_status open_text(struct dea_context *ctx, const char *file, const unsigned char *bytes,
                            size_t length, char **copy, struct dea_slice *text)
{
  const char *encoding = utf16_of(bytes, length);
  const size_t head = length < HEAD_BYTES ? length : HEAD_BYTES;
  const size_t mark = encoding != NULL                                       ? 2
                      : length >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3
                                                                             : 0;
  const unsigned char *zero = encoding == NULL ? memchr(bytes, 0, length) : NULL;
  *copy = NULL;
  *text = (struct dea_slice){(const char *)bytes + mark, length - mark};
  if (zero != NULL) {
    return dea_fail(ctx, DEA_E_IO,
                    "'%s' is no text: byte %zu is 0 (UTF-16 needs its byte order mark)", file,
                    (size_t)(zero - bytes));
  }
  if (encoding != NULL) {
    text->length -= length % 2; // half a letter
  } else if (is_utf8(bytes, head)) {
    return DEA_OK;
  } else {
    encoding = encoding_of(bytes, head);
  }
  if (encoding != NULL && (encoding[0] == '\0' || convert(ctx, encoding, *text, copy, text))) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_context_status(ctx) == DEA_E_MEMORY ? DEA_E_MEMORY : DEA_OK);
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, find_letter(file, *text),
                               "letters in an encoding that is not known: save as UTF-8"));
  return dea_fail(ctx, DEA_E_IO, "'%s' cannot be read", file);
}

/* Lines that end with a carriage return alone get line feeds. *copy: as of open_text. */
static dea_status end_lines(struct dea_context *ctx, char **copy, struct dea_slice *text)
{
  if (text->length == 0 || memchr(text->text, '\n', text->length) != NULL ||
      memchr(text->text, '\r', text->length) == NULL) {
    return DEA_OK;
  }
  char *lines = dea_alloc(ctx, text->length, 1);
  DEA_TRY_MEMORY(lines != NULL);
  for (size_t i = 0; i < text->length; i++) {
    lines[i] = (char)(text->text[i] == '\r' ? '\n' : text->text[i]);
  }
  dea_free(ctx, *copy);
  *copy = lines;
  text->text = lines;
  return DEA_OK;
}

dea_status dea_text_file_read(struct dea_context *ctx, const unsigned char *bytes, size_t length,
                              dea_status (*read)(struct dea_context *ctx, struct dea_slice text,
                                                 struct dea_table *out),
                              struct dea_table *out)
{
  char *copy;
  struct dea_slice text;
  dea_status status = open_text(ctx, out->file, bytes, length, &copy, &text);
  status = status == DEA_OK ? narrow(ctx, &copy, &text) : status;
  status = status == DEA_OK ? end_lines(ctx, &copy, &text) : status;
  status = status == DEA_OK ? read(ctx, text, out) : status;
  if (out->fields != NULL) { // slices of it
    out->fields->copy = copy;
    copy = NULL;
  }
  dea_free(ctx, copy);
  return status;
}
