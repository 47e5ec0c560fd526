/* The schema of a protocol file: the table, and the struct that it fills. */
#pragma once

#include "protocol/protocol.h"

/* A protocol as the table reads it, before what is derived from several values. */
struct dea_protocol_raw {
  struct dea_protocol protocol;
  struct dea_quantity version;
  const struct dea_node *waveform; // instead of a sequence
  struct dea_protocol_step steps[DEA_PROTOCOL_STEPS_MAX];
  struct dea_protocol_input inputs[DEA_PROTOCOL_INPUTS_MAX];
};

extern const struct dea_record dea_protocol_record; // its base: a struct dea_protocol_raw
