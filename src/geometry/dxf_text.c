#define _POSIX_C_SOURCE 200809L // iconv
#include "geometry/dxf_text.h"

#include "base/text.h"

#include <ctype.h>
#include <iconv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* "ANSI_1251" and "dos850" are CP1251 and CP850; others go by their names. */
void dea_dxf_text_set_page(struct dea_dxf_text *as, const char *name)
{
  size_t word = strncasecmp(name, "ansi_", 5) == 0 ? 5 : strncasecmp(name, "dos", 3) == 0 ? 3 : 0;
  bool number = isdigit((unsigned char)name[word]);
  snprintf(as->page, sizeof as->page, "%s%.20s", number ? "CP" : "", number ? name + word : name);
}

void dea_dxf_text_free(struct dea_dxf_text *as)
{
  if (as->converter != NULL && as->converter != (iconv_t)-1) {
    iconv_close(as->converter);
  }
  as->converter = NULL;
}

static size_t add_letter(char *to, unsigned code)
{
  size_t extra = code < 0x80 ? 0 : code < 0x800 ? 1 : 2;
  static const unsigned lead[3] = {0, 0xc0, 0xe0};
  for (size_t i = extra; i > 0; i--, code >>= 6) {
    to[i] = (char)(0x80 | (code & 0x3f));
  }
  to[0] = (char)(lead[extra] | code);
  return extra + 1;
}

/* Bytes of a codepage into a text with its end; those that it does not have are letters of Latin-1,
 * as is all without a converter. */
static void convert(iconv_t converter, char *from, size_t count, char to[DEA_DXF_TEXT_SIZE])
{
  size_t capacity = DEA_DXF_TEXT_SIZE - 1;
  while (count > 0 && capacity > 2) {
    if (converter != (iconv_t)-1 && iconv(converter, &from, &count, &to, &capacity) != (size_t)-1) {
      break;
    }
    if (count > 0 && capacity > 2) {
      size_t n = add_letter(to, (unsigned char)*from);
      to += n;
      capacity -= n;
      from++;
      count--;
    }
  }
  *to = '\0';
}

/* Letter of an escape: the bytes that it takes, 0: none is there. */
static size_t read_escape(const char *from, char letter[DEA_DXF_TEXT_SIZE])
{
  static const char *const pages[] = {"CP932", "CP950", "CP949", "JOHAB", "CP936"};
  bool unicode = strncmp(from, "\\U+", 3) == 0, page = strncmp(from, "\\M+", 3) == 0;
  size_t before = page ? 4 : 3, digits = 0;
  char code[5] = "";
  if ((!unicode && !page) || (page && (from[3] < '1' || from[3] > '5'))) {
    return 0;
  }
  for (; digits < 4 && isxdigit((unsigned char)from[before + digits]); digits++) {
    code[digits] = from[before + digits];
  }
  if (digits < 4) {
    return 0;
  }
  unsigned long value = strtoul(code, NULL, 16);
  if (unicode) {
    bool good = value > 0 && (value < 0xd800 || value > 0xdfff);
    letter[add_letter(letter, good ? (unsigned)value : 0xfffd)] = '\0';
  } else {
    char bytes[2] = {(char)(value >> 8), (char)(value & 0xff)};
    iconv_t converter = iconv_open("UTF-8", pages[from[3] - '1']);
    convert(converter, bytes, 2, letter);
    if (converter != (iconv_t)-1) {
      iconv_close(converter);
    }
  }
  return before + 4;
}

static bool is_utf8(const char *text)
{
  unsigned code;
  size_t n;
  while ((n = dea_letter_read(text, &code)) > 0 && code != 0) {
    text += n;
  }
  return n > 0;
}

static bool is_ascii(const char *text)
{
  while (*text != '\0' && (unsigned char)*text < 0x80) {
    text++;
  }
  return *text == '\0';
}

void dea_dxf_text_decode(struct dea_dxf_text *as, char text[DEA_DXF_TEXT_SIZE])
{
  char letters[DEA_DXF_TEXT_SIZE];
  if (!is_ascii(text) && !((as->utf8 || as->page[0] == '\0') && is_utf8(text))) {
    as->page_guessed |= as->page[0] == '\0';
    if (as->converter == NULL) {
      as->converter = iconv_open("UTF-8", as->page[0] != '\0' ? as->page : "CP1252");
    }
    convert(as->converter, text, strlen(text), letters);
    strcpy(text, letters); // NOLINT(clang-analyzer-security.insecureAPI.strcpy): of one size
  }
  if (strchr(text, '\\') == NULL) {
    return;
  }
  size_t count = 0;
  for (const char *from = text; *from != '\0';) {
    char letter[DEA_DXF_TEXT_SIZE] = {*from};
    size_t taken = read_escape(from, letter);
    size_t n = strlen(letter);
    if (count + n >= DEA_DXF_TEXT_SIZE) {
      break;
    }
    memcpy(letters + count, letter, n);
    count += n;
    from += taken > 0 ? taken : 1;
  }
  letters[count] = '\0';
  memcpy(text, letters, count + 1);
}
