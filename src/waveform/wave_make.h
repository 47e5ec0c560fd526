/* What waveforms of straight pieces are made with. */
#pragma once

#include "waveform/waveform.h"

/* Adds a knot to the last block, and a block to start at a time with no knots yet. Sets `failed`
 * when memory is short, and adds nothing then. */
void dea_wave_add(struct dea_waveform *waveform, double phase, double offset_s, double value_V);
void dea_wave_open(struct dea_waveform *waveform, double start_s, double frequency_Hz,
                   size_t cycles);

/* Cycles until t. With f_0, f_1 the frequencies at the start and at the end of a sweep of length T:
 *
 *   linear       f_0 t + (f_1 - f_0) t^2/(2 T)
 *   logarithmic  f_0 T/ln(f_1/f_0) ((f_1/f_0)^(t/T) - 1) */
double dea_wave_cycles(const struct dea_wave_sine *sine, double t);
