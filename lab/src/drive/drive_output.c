#include "drive/drive_output.h"

#include <math.h>

void dea_drive_output_start(struct dea_drive_output *output, const struct dea_protocol *protocol)
{
  *output = (struct dea_drive_output){.protocol = protocol};
  dea_protocol_samples_start(&output->samples, protocol);
  output->step_V = protocol->safety.ramp_V_per_s.si / protocol->rate_Hz.si;
}

static double next_of_sequence(struct dea_drive_output *output)
{
  double asked_V = dea_protocol_samples_next(&output->samples);
  output->played++;
  output->over = output->samples.next == output->samples.total;
  return asked_V;
}

static double next_of_ramp(struct dea_drive_output *output)
{
  double left_V = fabs(output->last_V) - output->step_V;
  output->over = !(left_V > 0);
  return output->over ? 0 : copysign(left_V, output->last_V);
}

size_t dea_drive_output_next(struct dea_drive_output *output, size_t capacity, double *asked_V)
{
  size_t n = 0;
  while (n < capacity && !output->over) {
    output->last_V = output->ramping ? next_of_ramp(output) : next_of_sequence(output);
    asked_V[n++] = output->last_V;
  }
  return n;
}

void dea_drive_output_ramp(struct dea_drive_output *output)
{
  const struct dea_protocol *protocol = output->protocol;
  double samples = protocol->safety.longest_ramp_s.si * protocol->rate_Hz.si;
  output->ramping = true; // one that is over has ended with 0 V
  output->step_V = fmax(output->step_V, fabs(output->last_V) / samples);
}

void dea_drive_output_ramp_from(struct dea_drive_output *output, double volts)
{
  output->over = false;
  output->last_V = volts;
  dea_drive_output_ramp(output);
}
