#include "cli/figure_options.h"

#include <string.h>

bool cli_read_formats(const char *text, struct dea_plot_format *format)
{
  format->svg = format->pdf = format->png = false;
  for (const char *word = text;;) {
    size_t n = strcspn(word, ",");
    bool *which = n != 3                         ? NULL
                  : strncmp(word, "svg", n) == 0 ? &format->svg
                  : strncmp(word, "pdf", n) == 0 ? &format->pdf
                  : strncmp(word, "png", n) == 0 ? &format->png
                                                 : NULL;
    if (which == NULL) {
      return false;
    }
    *which = true;
    if (word[n] == '\0') {
      return true;
    }
    word += n + 1;
  }
}

bool cli_read_width(const char *text, struct dea_plot_format *format)
{
  const char *end;
  double width_mm = dea_text_to_double(text, &end);
  if (end == text || (*end != '\0' && strcmp(end, "mm") != 0 && strcmp(end, " mm") != 0) ||
      !(width_mm >= 40.0) || !(width_mm <= 400.0)) {
    return false;
  }
  format->width_m = 1e-3 * width_mm;
  return true;
}
