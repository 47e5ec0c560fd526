/* Parts of dea_protocol_check; not for others. */
#pragma once

#include "protocol/protocol.h"

/* The asked voltage farthest from 0 in one direction. */
struct dea_protocol_peak {
  double voltage_V;
  size_t step; // in which it is
};

struct dea_protocol_slopes {
  double jump_V;        // largest change at once, signed
  double slope_V_per_s; // fastest change between jumps, >= 0
  size_t jump_step, slope_step;
  double cycle_s; // shortest cycle of a waveform
  size_t cycle_step;
};

/* How fast the sequence changes. */
void dea_protocol_slopes_find(const struct dea_protocol *protocol, struct dea_protocol_slopes *out);

/* "step 2 (sweep)". */
enum { DEA_STEP_NAME_SIZE = 320 };
void dea_protocol_step_name(const struct dea_protocol *protocol, size_t step,
                            char out[DEA_STEP_NAME_SIZE]);
/* Where the file says that voltage of a step: the value itself, else what comes nearest to it. */
struct dea_location dea_protocol_voltage_location(const struct dea_protocol *protocol, size_t step,
                                                  double voltage_V);

/* Adds what would switch an interlock off: `safety`, and what it depends on. */
dea_status dea_protocol_check_interlocks(struct dea_context *ctx,
                                         const struct dea_protocol *protocol,
                                         const struct dea_protocol_plan *plan);

/* Field, pull-in, capacitance and energy of the film at the peak. */
dea_status dea_protocol_check_film(struct dea_context *ctx, const struct dea_protocol *protocol,
                                   const struct dea_protocol_peak *peak,
                                   struct dea_protocol_plan *plan);
