/* A protocol as files for a computer that has no `dea`: a waveform, and scripts that play it and
 * record all channels as CSV that `dea import` reads. */
#pragma once

#include "protocol/protocol.h"

enum { DEA_EXPORT_SAMPLES_MAX = 20 * 1000 * 1000 };

/* Writes waveform.csv, play_matlab.m, play_nidaqmx.py and README.txt into a folder, which is made;
 * files of these names are replaced. The protocol has passed dea_protocol_check. DEA_E_ARGUMENT for
 * a protocol without channels or with more samples than such scripts can hold. */
dea_status dea_protocol_export(struct dea_context *ctx, const struct dea_protocol *protocol,
                               const char *directory);
