/* Waveforms from text in tests. */
#pragma once

#include "waveform/waveform.h"

#include <string.h>

/* The waveform of the keys in text ("kind: square\nhigh: 7 kV\n..."); NULL after findings. beside:
 * stands for the design file. */
static inline struct dea_waveform *waveform_of(struct dea_context *context, const char *beside,
                                               const char *text)
{
  struct dea_yaml *yaml;
  struct dea_waveform *waveform = NULL;
  if (dea_yaml_parse(context, "w.yaml", text, strlen(text), &yaml) == DEA_OK) {
    const struct dea_reader reader = {context, yaml, NULL};
    dea_waveform_read(&reader, dea_yaml_root(yaml), "", beside, &waveform);
    dea_yaml_destroy(context, yaml);
  }
  return waveform;
}
