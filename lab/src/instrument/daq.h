/* What DAQs have in common: a queue for the output whose playing starts with its first sample, and
 * room for what the inputs give. */
#pragma once

#include "instrument/instrument_make.h"

/* What a section of a DAQ is read into, and its table: kind, doc and default of the device,
 * wirings and the usual one, file of the library. */
struct dea_daq_raw {
  struct dea_label kind, device, library;
  struct dea_choice wiring;
  struct dea_quantity queue_s;
};
#define DEA_DAQ_FIELDS(name, device_text, device_usual, wiring_names, wiring_usual, library_usual) \
  DEA_INSTRUMENT_KIND(struct dea_daq_raw, name),                                                   \
      DEA_INSTRUMENT_LABEL(struct dea_daq_raw, device, "device", device_text, device_usual,        \
                           .default_text = device_usual),                                          \
      DEA_INSTRUMENT_CHOICE(struct dea_daq_raw, wiring, "wiring", "of all inputs", wiring_names,   \
                            wiring_usual),                                                         \
      DEA_INSTRUMENT_TIME(                                                                         \
          struct dea_daq_raw, queue_s, "queue",                                                    \
          "of the output that is held ready; as long it takes until a stop is heard of", "0.25 s", \
          60),                                                                                     \
      DEA_INSTRUMENT_LABEL(                                                                        \
          struct dea_daq_raw, library, "library",                                                  \
          "file of the library; another than the usual one must be on the user's "                 \
          "own list",                                                                              \
          library_usual, .default_text = library_usual)

/* Longest time that a driver may take for what should be done at once. */
#define DEA_DAQ_PATIENCE_S 2.0

struct dea_daq {
  size_t capacity;   // of the queue, samples
  size_t input_room; // that the driver holds for each input
  size_t scans_room; // of scans, samples of each input
  double *scans;     // [scans_room][inputs]; owned
  size_t queued;     // samples given to the driver
  bool asked_to_start, running;
  bool ran_dry; // the output had nothing left to play
};

/* DEA_E_MEMORY. */
dea_status dea_daq_begin(struct dea_context *ctx, const struct dea_protocol *protocol,
                         double queue_s, struct dea_daq *out);
/* Of an instrument's type. */
void dea_daq_address(const void *raw, char *out, size_t size);
void dea_daq_free(struct dea_context *ctx, struct dea_daq *daq);
/* How many of `count` samples may be given to the driver at once. Before the start no more than the
 * queue holds: DEA_E_ARGUMENT. DEA_E_INSTRUMENT when the output ran dry before. */
dea_status dea_daq_part(struct dea_context *ctx, const struct dea_daq *daq, const char *device,
                        size_t count, size_t *part);
/* DEA_E_INSTRUMENT with the next rate that goes when a device's clock differs from what was asked.
 */
dea_status dea_daq_check_rate(struct dea_context *ctx, const char *device, double asked_Hz,
                              double actual_Hz);
