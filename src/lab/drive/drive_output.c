#include "lab/drive/drive_output.h"

#include <math.h>

// of a sample's distance to the next: times that differ by less are the same, rounded
static const double rounding = 1e-6;

void dea_drive_output_start(struct dea_drive_output *output, const struct dea_protocol *protocol)
{
  double rate_Hz = protocol->rate_Hz.si;
  *output = (struct dea_drive_output){.protocol = protocol};
  output->total = (size_t)ceil(dea_protocol_duration_s(protocol) * rate_Hz - rounding) + 1;
  output->step_V = protocol->safety.ramp_V_per_s.si / rate_Hz;
  output->corner_s = dea_protocol_corner(protocol, 0);
}

static double next_of_sequence(struct dea_drive_output *output)
{
  double rate_Hz = output->protocol->rate_Hz.si;
  double time_s = (double)output->played / rate_Hz;
  while (output->corner_s <= time_s + rounding / rate_Hz) {
    time_s = fmax(time_s, output->corner_s);
    output->corner_s = dea_protocol_corner(output->protocol, output->corner_s);
  }
  output->played++;
  output->over = output->played == output->total;
  return output->over ? 0 : dea_protocol_value(output->protocol, time_s);
}

static double next_of_ramp(struct dea_drive_output *output)
{
  double left_V = fabs(output->last_V) - output->step_V;
  output->over = !(left_V > 0);
  return output->over ? 0 : copysign(left_V, output->last_V);
}

size_t dea_drive_output_next(struct dea_drive_output *output, size_t room, double *asked_V)
{
  size_t n = 0;
  while (n < room && !output->over) {
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
