#include "fabricate/labels.h"

#include "base/file.h"

#include <math.h>

void dea_sheet_labels(const struct dea_workshop *workshop, size_t index, struct dea_text *out)
{
  const struct dea_part *part = &workshop->part[index];
  int copies = workshop->layout[index].count;
  dea_text_add(out, "%.80s: %s; %s; lengths of the %s film in mm; ",
               dea_path_name(workshop->plan.design->file), part->title, part->seen,
               dea_part_film_name(part));
  if (part->paper) {
    dea_text_add(out, "not to be cut");
  } else {
    if (part->quantity > 1) {
      dea_text_add(out, "to be cut %zu times; ", part->quantity);
    }
    dea_text_add(out, "%d cop%s, kerf of %.4g mm taken into account", copies,
                 copies > 1 ? "ies" : "y", 1e3 * workshop->plan.kerf_m);
  }
}

double dea_sheet_labels_height(const struct dea_sheet_layout *layout)
{
  return fmin(2.5e-3, layout->width_m / 130);
}

unsigned dea_letter_next(const char **text)
{
  unsigned code;
  size_t length = dea_letter_read(*text, &code);
  if (code == 0) {
    return 0;
  }
  bool good = length > 0 && code != 0xfffe && code != 0xffff; // which XML forbids
  *text += good ? length : 1;
  if (!good) {
    return 0xfffd;
  }
  return dea_letter_is_control(code) ? ' ' : code;
}

void dea_xml_add(struct dea_text *out, const char *text)
{
  const char *start = text;
  for (unsigned code; (code = dea_letter_next(&text)) != 0; start = text) {
    const char *name = code == ' ' ? " " : code == 0xfffd ? "\xef\xbf\xbd" : dea_entity_name(code);
    if (name != NULL) {
      dea_text_add(out, "%s", name);
    } else {
      dea_text_add(out, "%.*s", (int)(text - start), start);
    }
  }
}
