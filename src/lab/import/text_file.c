#define _POSIX_C_SOURCE 200809L // iconv
#include "lab/import/text_file.h"

#include <iconv.h>
#include <string.h>

enum { HEAD_BYTES = 1 << 20 }; // in which its letters are looked at

/* 0: no mark of UTF-16, 1: little-endian, 2: big-endian. */
static int utf16_mark(const unsigned char *bytes, size_t length)
{
  if (length < 2) {
    return 0;
  }
  return bytes[0] == 0xff && bytes[1] == 0xfe ? 1 : bytes[0] == 0xfe && bytes[1] == 0xff ? 2 : 0;
}

static size_t put_letter(unsigned code, char *out)
{
  if (code < 0x80) {
    out[0] = (char)code;
    return 1;
  }
  if (code < 0x800) {
    out[0] = (char)(0xc0 | code >> 6);
    out[1] = (char)(0x80 | (code & 0x3f));
    return 2;
  }
  if (code < 0x10000) {
    out[0] = (char)(0xe0 | code >> 12);
    out[1] = (char)(0x80 | (code >> 6 & 0x3f));
    out[2] = (char)(0x80 | (code & 0x3f));
    return 3;
  }
  out[0] = (char)(0xf0 | code >> 18);
  out[1] = (char)(0x80 | (code >> 12 & 0x3f));
  out[2] = (char)(0x80 | (code >> 6 & 0x3f));
  out[3] = (char)(0x80 | (code & 0x3f));
  return 4;
}

/* out: room for three bytes a unit. */
static size_t to_utf8(const unsigned char *bytes, size_t units, bool big, char *out)
{
  size_t n = 0;
  for (size_t i = 0; i < units; i++) {
    unsigned code = (unsigned)bytes[2 * i + (big ? 0 : 1)] << 8 | bytes[2 * i + (big ? 1 : 0)];
    if (code >= 0xd800 && code < 0xdc00 && i + 1 < units) {
      const unsigned char *next = bytes + 2 * i + 2;
      unsigned low = (unsigned)next[big ? 0 : 1] << 8 | next[big ? 1 : 0];
      if (low >= 0xdc00 && low < 0xe000) {
        code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
        i++;
      }
    }
    code = code == 0 || (code >= 0xd800 && code < 0xe000) ? 0xfffd : code;
    n += put_letter(code, out + n);
  }
  return n;
}

bool dea_text_file_is(const unsigned char *head, size_t length)
{
  return utf16_mark(head, length) != 0 || memchr(head, 0, length) == NULL;
}

/* Whether what is not ASCII comes in pairs as Chinese letters are written (GB 2312, the letters of
 * GB 18030 that are used): two of them at least, and no single byte as those of Latin-1. UTF-8 is
 * none: its letters have three bytes, or a second one below 0xa1 sooner or later. */
static bool is_chinese(const unsigned char *bytes, size_t length)
{
  enum { ENOUGH = 2 };
  size_t pairs = 0;
  for (size_t i = 0; i < length; i++) {
    if (bytes[i] >= 0x80) {
      bool pair = i + 1 < length && bytes[i] >= 0xa1 && bytes[i] <= 0xf7 && bytes[i + 1] >= 0xa1 &&
                  bytes[i + 1] <= 0xfe;
      if (!pair) {
        return false;
      }
      pairs++;
      i++;
    }
  }
  return pairs >= ENOUGH;
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

/* Text of GB 18030 as UTF-8; *copy stays NULL where the system cannot. */
static dea_status from_chinese(struct dea_context *ctx, struct dea_slice text, char **copy,
                               struct dea_slice *out)
{
  iconv_t converter = iconv_open("UTF-8", "GB18030");
  if (converter == (iconv_t)-1) {
    return DEA_OK;
  }
  size_t left = text.length, most = 2 * text.length + 4, room = most; // 3 bytes for 2
  *copy = dea_alloc(ctx, most, 1);
  char *from = (char *)text.text, *to = *copy;
  bool good = to != NULL && iconv(converter, &from, &left, &to, &room) != (size_t)-1;
  iconv_close(converter);
  if (*copy == NULL) {
    return DEA_E_MEMORY;
  }
  if (good) {
    *out = (struct dea_slice){*copy, most - room};
  } else {
    dea_free(ctx, *copy);
    *copy = NULL;
  }
  return DEA_OK;
}

/* *copy: the text where it had to be converted, the caller's; else NULL and the bytes are lent. */
static dea_status open_text(struct dea_context *ctx, const char *file, const unsigned char *bytes,
                            size_t length, char **copy, struct dea_slice *text)
{
  int mark = utf16_mark(bytes, length);
  *copy = NULL;
  *text = (struct dea_slice){(const char *)bytes, length};
  if (mark != 0) {
    size_t units = (length - 2) / 2;
    *copy = dea_alloc(ctx, units + 1, 3);
    if (*copy == NULL) {
      return DEA_E_MEMORY;
    }
    *text = (struct dea_slice){*copy, to_utf8(bytes + 2, units, mark == 2, *copy)};
    return DEA_OK;
  }
  if (length >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0) {
    *text = (struct dea_slice){(const char *)bytes + 3, length - 3};
  }
  const unsigned char *zero = memchr(bytes, 0, length);
  if (zero != NULL) {
    return dea_fail(ctx, DEA_E_IO,
                    "'%s' is no text: byte %zu is 0 (UTF-16 needs its byte order mark)", file,
                    (size_t)(zero - bytes));
  }
  size_t head = length < HEAD_BYTES ? length : HEAD_BYTES;
  return is_chinese(bytes, head) && !is_utf8(bytes, head) ? from_chinese(ctx, *text, copy, text)
                                                          : DEA_OK;
}

/* Lines that end with a carriage return alone get line feeds. *copy: as of open_text. */
static dea_status end_lines(struct dea_context *ctx, char **copy, struct dea_slice *text)
{
  if (text->length == 0 || memchr(text->text, '\n', text->length) != NULL ||
      memchr(text->text, '\r', text->length) == NULL) {
    return DEA_OK;
  }
  char *lines = dea_alloc(ctx, text->length, 1);
  if (lines == NULL) {
    return DEA_E_MEMORY;
  }
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
  if (status == DEA_OK) {
    status = end_lines(ctx, &copy, &text);
  }
  if (status == DEA_OK) {
    status = read(ctx, text, out);
  }
  dea_free(ctx, copy);
  return status;
}
