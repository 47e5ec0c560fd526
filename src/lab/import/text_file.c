#include "lab/import/text_file.h"

#include <string.h>

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
    status = read(ctx, text, out);
  }
  dea_free(ctx, copy);
  return status;
}
