/* A recording as CSV files, for programs that do not read HDF5. */
#pragma once

#include "recording/recording.h"

/* Writes into a folder, which is made where it is not there: channels.csv with time and all
 * channels of the first clock (channels_2.csv with those of the next, ...), readings_1.csv, ...
 * with each channel of single readings, profiles.csv with a line a frame, cycles.csv. Numbers in
 * display units, which the headers name: "time (s),voltage (kV)"; a missing value is an empty
 * field. Tables of these names that are there are removed where `force` is set, also those that
 * this recording has none of, else DEA_E_IO. DEA_E_INTERRUPTED leaves no half file. */
dea_status dea_recording_write_tables(struct dea_context *ctx,
                                      const struct dea_recording *recording, const char *folder,
                                      bool force);
/* Unit that the values times the factor of their kind are in; lent. */
const char *dea_channel_display_unit(const struct dea_channel *channel);
