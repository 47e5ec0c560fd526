/* How a step of the sequence is called in messages, and where the file says it. */
#include "lab/protocol/check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void dea_protocol_step_name(const struct dea_protocol *protocol, size_t step,
                            char out[DEA_STEP_NAME_SIZE])
{
  const char *label = protocol->steps[step].label.text;
  snprintf(out, DEA_STEP_NAME_SIZE, "step %zu%s%s%s", step + 1, label[0] != '\0' ? " (" : "", label,
           label[0] != '\0' ? ")" : "");
}

struct dea_location dea_protocol_voltage_location(const struct dea_protocol *protocol, size_t step,
                                                  double voltage_V)
{
  char path[64];
  const struct dea_node *section = protocol->steps[step].section;
  bool alone = strcmp(section->key, "waveform") == 0 &&
               dea_node_find(dea_yaml_root(protocol->document), "sequence") == NULL;
  snprintf(path, sizeof path, alone ? "waveform." : "sequence[%zu].waveform.", step);
  struct dea_location location = section->location;
  double nearest = INFINITY;
  for (size_t i = 0; i < protocol->values.count; i++) {
    const struct dea_listed *value = &protocol->values.items[i];
    bool here = strncmp(value->path, path, strlen(path)) == 0 && value->origin != DEA_DEFAULT;
    if (here && value->unit != NULL && strcmp(value->unit, "V") == 0 &&
        fabs(value->si - voltage_V) < nearest) {
      nearest = fabs(value->si - voltage_V);
      location = value->location;
    }
  }
  return location;
}
