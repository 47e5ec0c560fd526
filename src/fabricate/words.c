#include "fabricate/words.h"

#include <math.h>
#include <string.h>

const char *dea_file_name(const char *path)
{
  const char *slash = strrchr(path, '/');
  return slash != NULL ? slash + 1 : path;
}

void dea_sheet_words(const struct dea_workshop *workshop, size_t index, struct dea_text *out)
{
  const struct dea_part *part = &workshop->part[index];
  int copies = workshop->layout[index].count;
  dea_text_add(out, "%.80s: %s; %s; lengths of the %s film in mm; ",
               dea_file_name(workshop->plan.design->file), part->title, part->seen,
               part->state == DEA_STRETCHED ? "stretched" : "unstretched");
  if (part->paper) {
    dea_text_add(out, "not to be cut");
  } else {
    dea_text_add(out, "%d cop%s, kerf of %.4g mm taken into account", copies,
                 copies > 1 ? "ies" : "y", 1e3 * workshop->plan.kerf_m);
  }
}

double dea_sheet_words_height(const struct dea_layout *layout)
{
  return fmin(2.5e-3, layout->width_m / 130);
}

unsigned dea_letter_next(const char **text)
{
  const unsigned char *c = (const unsigned char *)*text;
  unsigned code = *c;
  if (code == 0) {
    return 0;
  }
  int more = code >= 0xf8 ? -1 : code >= 0xf0 ? 3 : code >= 0xe0 ? 2 : code >= 0xc0 ? 1 : 0;
  static const unsigned mask[4] = {0x7f, 0x1f, 0x0f, 0x07}, least[4] = {0, 0x80, 0x800, 0x10000};
  bool good = more >= 0 && (code < 0x80 || code >= 0xc0);
  code &= good ? mask[more] : 0xff;
  int used = 1;
  for (; good && used <= more; used++) {
    good = (c[used] & 0xc0) == 0x80;
    code = code << 6 | (c[used] & 0x3fu);
  }
  good = good && code >= least[more] && code <= 0x10ffff && (code < 0xd800 || code > 0xdfff) &&
         code != 0xfffe && code != 0xffff; // which XML forbids
  *text += good ? used : 1;
  if (!good) {
    return 0xfffd;
  }
  return code < 0x20 || (code >= 0x7f && code < 0xa0) ? ' ' : code;
}

void dea_xml_add(struct dea_text *out, const char *text)
{
  for (;;) {
    const char *start = text;
    unsigned code = dea_letter_next(&text);
    switch (code) {
    case 0:
      return;
    case '<':
      dea_text_add(out, "&lt;");
      break;
    case '>':
      dea_text_add(out, "&gt;");
      break;
    case '&':
      dea_text_add(out, "&amp;");
      break;
    case '"':
      dea_text_add(out, "&quot;");
      break;
    case '\'':
      dea_text_add(out, "&#39;");
      break;
    case ' ':
      dea_text_add(out, " ");
      break;
    case 0xfffd:
      dea_text_add(out, "\xef\xbf\xbd");
      break;
    default:
      dea_text_add(out, "%.*s", (int)(text - start), start);
    }
  }
}
