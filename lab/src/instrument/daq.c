#include "instrument/daq.h"

#include <stdio.h>

/* Samples of the inputs that a driver keeps while nobody takes them. */
static const double input_room_s = 10;
/* Clocks are whole divisions of a quartz: what differs less was rounded in between. */
static const double same_rate = 1e-7;
static const double scans_room_s = 0.5;

enum { ROOM_LEAST = 64 };

static size_t samples_of(double seconds, double rate_Hz)
{
  double samples = seconds * rate_Hz;
  return samples > ROOM_LEAST ? (size_t)samples : ROOM_LEAST;
}

dea_status dea_daq_begin(struct dea_context *ctx, const struct dea_protocol *protocol,
                         double queue_s, struct dea_daq *out)
{
  double rate_Hz = protocol->rate_Hz.si;
  *out = (struct dea_daq){.capacity = samples_of(queue_s, rate_Hz),
                          .input_room = samples_of(input_room_s, rate_Hz),
                          .scans_room = samples_of(scans_room_s, rate_Hz)};
  out->scans = dea_alloc(ctx, out->scans_room, sizeof *out->scans * (protocol->input_count + 1));
  return out->scans != NULL ? DEA_OK : DEA_E_MEMORY;
}

void dea_daq_address(const void *raw, char *out, size_t size)
{
  snprintf(out, size, "%s", ((const struct dea_daq_raw *)raw)->device.text);
}

void dea_daq_free(struct dea_context *ctx, struct dea_daq *daq)
{
  dea_free(ctx, daq->scans);
}

dea_status dea_daq_part(struct dea_context *ctx, const struct dea_daq *daq, const char *device,
                        size_t count, size_t *part)
{
  if (daq->ran_dry) {
    return dea_fail(ctx, DEA_E_INSTRUMENT,
                    "%s had nothing left to play: the computer was too slow; give it a longer "
                    "'queue' or a lower rate",
                    device);
  }
  if (daq->running) {
    *part = count < daq->capacity / 2 ? count : daq->capacity / 2; // the driver waits for room
    return DEA_OK;
  }
  size_t left = daq->capacity - daq->queued;
  if (left == 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "more than %zu samples before the start", daq->capacity);
  }
  *part = count < left ? count : left;
  return DEA_OK;
}

dea_status dea_daq_check_rate(struct dea_context *ctx, const char *device, double asked_Hz,
                              double actual_Hz)
{
  if (fabs(actual_Hz - asked_Hz) <= same_rate * asked_Hz) {
    return DEA_OK;
  }
  return dea_fail(ctx, DEA_E_INSTRUMENT, "%s has no rate of %.12g Hz; write 'rate: %.12g Hz'",
                  device, asked_Hz, actual_Hz);
}
