/* What waveforms of straight pieces are made with. */
#pragma once

#include "waveform/waveform.h"

/* Room for knots and blocks in a waveform that has none. DEA_E_MEMORY. */
dea_status dea_wave_room(struct dea_context *ctx, struct dea_waveform *waveform, size_t knots,
                         size_t blocks);
/* Adds a knot to the last block, and a block to start at a time with no knots yet. */
void dea_wave_add(struct dea_waveform *waveform, double phase, double offset_s, double value_V);
void dea_wave_open(struct dea_waveform *waveform, double start_s, double frequency_Hz,
                   size_t cycles);
