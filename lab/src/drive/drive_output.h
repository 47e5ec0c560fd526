/* What is asked of the amplifier, sample after sample: the protocol's sequence, and from any of
 * them on a ramp to 0 V. */
#pragma once

#include "protocol/protocol.h"

struct dea_drive_output {
  const struct dea_protocol *protocol; // lent
  struct dea_protocol_samples samples; // of the sequence
  size_t played;                       // of them, so far
  double last_V;                       // that was asked; 0 before the first
  double step_V;                       // largest change from sample to sample of the ramp
  bool ramping, over;
};

void dea_drive_output_start(struct dea_drive_output *output, const struct dea_protocol *protocol);
/* The next asked voltages [V], at most `room`; the number of them, 0 when it is over. */
size_t dea_drive_output_next(struct dea_drive_output *output, size_t capacity, double *asked_V);
/* From here on a ramp from the last voltage to 0 V, by the protocol's ramp or within its longest
 * time, whichever is faster; nothing more for one that is over. */
void dea_drive_output_ramp(struct dea_drive_output *output);
/* The same from another voltage, also of one that is over. */
void dea_drive_output_ramp_from(struct dea_drive_output *output, double volts);
