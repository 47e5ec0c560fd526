/* How a step of the sequence is called in messages, where the file says it, and what repeats in it.
 */
#include "protocol/protocol_check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { CYCLES_LOOKED_AT = 1000 };
static const double section_s = 10; // of a voltage that stays
static const double rounding = 1e-9;

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

/* Of the cycles of a waveform that are of one length and lie end to end: how many in a row, at
 * most, have the same level. 0: they are not. */
static size_t longest_run(const struct dea_protocol_step *step, double *length_s)
{
  const struct dea_waveform *w = step->waveform;
  struct dea_wave_cycle first, next;
  double end_s = 0, error_s = rounding * w->end_s, level_V = NAN;
  size_t run = 0, longest = 0;
  if (!dea_waveform_cycle(w, 0, &first) || first.start_s != 0) {
    return 0;
  }
  for (size_t i = 0; i < step->cycles && i < CYCLES_LOOKED_AT; i++) {
    if (!dea_waveform_cycle(w, i, &next) || fabs(next.start_s - end_s) > error_s ||
        fabs(next.end_s - next.start_s - first.end_s) > error_s) {
      return 0;
    }
    run = next.level_V == level_V ? run + 1 : 1;
    longest = run > longest ? run : longest;
    level_V = next.level_V;
    end_s = next.end_s;
  }
  *length_s = first.end_s;
  return longest == CYCLES_LOOKED_AT ? step->cycles : longest;
}

double dea_protocol_period_s(const struct dea_protocol_step *step)
{
  double length_s;
  if (step->lowest_V == step->highest_V) {
    return section_s;
  }
  size_t run = longest_run(step, &length_s);
  if (run > DEA_LEAK_VISITS || (run == step->cycles && run > 1)) {
    return length_s;
  }
  return step->repeat.si > 1 ? step->waveform->end_s : (double)NAN;
}

double dea_protocol_learning_s(const struct dea_protocol_step *step)
{
  double period_s = dea_protocol_period_s(step), length_s, end_s = step->waveform->end_s;
  double there_s = step->repeat.si * end_s;
  if (period_s < end_s && step->lowest_V != step->highest_V) {
    size_t run = longest_run(step, &length_s);
    there_s = run < step->cycles ? (double)run * period_s : there_s;
  }
  // a visit ends with the first cycle that ends a second after it began
  double learned_s = (DEA_LEAK_VISITS + 1) * period_s * fmax(1, ceil(DEA_LEAK_VISIT_S / period_s));
  return learned_s < there_s ? learned_s : (double)INFINITY; // INFINITY for NAN
}
