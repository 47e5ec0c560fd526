/* Instrument "comedi": a DAQ by Linux' own drivers, through comedilib, which is loaded when it is
 * opened. Output and inputs are commands with timers of the same board; both are armed and then
 * triggered one right after the other, inputs first. Not tried with a board. */
#define _POSIX_C_SOURCE 200809L // read, write, poll
#include "base/clock.h"
#include "base/schema_value.h"
#include "instrument/comedi_library.h"
#include "instrument/daq.h"
#include "instrument/instrument_make.h"
#include "instrument/library.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { RECEIVE_SIZE = 16384, TESTS = 4, CHANNELS_MAX = DEA_PROTOCOL_INPUTS_MAX };

static const double rate_least_Hz = 0.25; // a period is 32 bits of ns

#define USUAL_LIBRARY "libcomedi.so.0"
static const char *const wirings[] = {"referenced", "non_referenced", "differential", NULL};

static const struct dea_field fields[] = {
    DEA_DAQ_FIELDS("comedi", "its file", "/dev/comedi0", wirings, "differential", USUAL_LIBRARY),
};
const struct dea_record dea_instrument_comedi_record = {
    "comedi", "plays and measures with a DAQ that Linux has a driver for", fields,
    DEA_INSTRUMENT_COUNT(fields)};

/* A channel with its range. */
struct channel {
  unsigned number, range, most;
  struct dea_comedi_span span;
  struct dea_comedi_polynomial converter;
};

/* Output or inputs. */
struct part {
  unsigned subdevice;
  size_t sample_size; // bytes
  struct channel channels[CHANNELS_MAX];
  size_t count;
  unsigned list[CHANNELS_MAX]; // of the command
  struct dea_comedi_command command;
};

struct comedi {
  struct dea_instrument base;
  struct dea_comedi_library library;
  struct dea_daq daq;
  char name[DEA_TITLE_SIZE];
  const struct dea_protocol *protocol;
  void *device; // NULL: not open
  int descriptor;
  unsigned wiring;
  bool opened; // the output may have been changed
  struct part output, input;
  unsigned char received[RECEIVE_SIZE]; // scans, the last one not whole
  size_t received_length;
};

/* Channel number of "ao0"; -1 when the terminal is not written like that. */
static long channel_number(const char *terminal, const char *prefix)
{
  const char *digits = terminal + strlen(prefix);
  if (strncmp(terminal, prefix, strlen(prefix)) != 0 || strlen(digits) > 4 || digits[0] == '\0' ||
      strspn(digits, "0123456789") != strlen(digits)) {
    return -1;
  }
  return strtol(digits, NULL, 10);
}

static dea_status check(const struct dea_reader *reader, const void *data,
                        const struct dea_protocol *protocol)
{
  const struct dea_label *output = &protocol->amplifier.terminal;
  const struct dea_daq_raw *raw = data;
  DEA_TRY(reader->ctx, dea_library_check(reader, &raw->library, USUAL_LIBRARY));
  if (protocol->rate_Hz.si < rate_least_Hz) {
    DEA_TRY(reader->ctx, dea_schema_error(reader, protocol->rate_Hz.location,
                                          "comedi's clocks have at least %g Hz", rate_least_Hz));
  }
  if (channel_number(output->text, "ao") < 0) {
    DEA_TRY(reader->ctx, dea_schema_error(reader, output->location,
                                          "comedi's outputs are called ao0, ao1, ..., not '%.60s'",
                                          output->text));
  }
  for (size_t i = 0; i < protocol->input_count; i++) {
    const struct dea_label *input = &protocol->inputs[i].terminal;
    if (channel_number(input->text, "ai") < 0) {
      DEA_TRY(reader->ctx, dea_schema_error(reader, input->location,
                                            "comedi's inputs are called ai0, ai1, ..., not '%.60s'",
                                            input->text));
    }
  }
  return DEA_OK;
}

static dea_status failed(struct dea_context *ctx, const struct comedi *c, const char *what)
{
  const char *why = c->library.strerror(c->library.error_number());
  return dea_fail(ctx, DEA_E_INSTRUMENT, "%s cannot %s: %.200s", c->name, what,
                  why != NULL ? why : "no explanation");
}

static dea_status find_part(struct dea_context *ctx, struct comedi *c, int type, struct part *part)
{
  int found = c->library.find_subdevice_by_type(c->device, type, 0);
  if (found < 0) {
    return failed(ctx, c,
                  type == DEA_COMEDI_OUTPUT ? "play: it has no outputs"
                                            : "measure: it has no inputs");
  }
  part->subdevice = (unsigned)found;
  int flags = c->library.get_subdevice_flags(c->device, part->subdevice);
  if (flags < 0) {
    return failed(ctx, c, "tell what it can do");
  }
  part->sample_size = (flags & DEA_COMEDI_LONG_SAMPLES) != 0 ? 4 : 2;
  return DEA_OK;
}

/* The number of a voltage without calibration. */
static double plain_number(const struct channel *channel, double volts)
{
  return (volts - channel->span.min) / (channel->span.max - channel->span.min) * channel->most;
}

static double number_by(const struct dea_comedi_polynomial *p, double volts)
{
  double number = 0;
  for (unsigned i = p->order < 3 ? p->order + 1 : 4; i-- > 0;) {
    number = number * (volts - p->origin) + p->coefficients[i];
  }
  return number;
}

/* Whether the numbers that are played are those of the range to a tenth of it. */
static bool is_plausible(const struct channel *channel)
{
  const double volts[] = {channel->span.min, 0, channel->span.max};
  bool good = true;
  for (int i = 0; i < 3; i++) {
    double off = number_by(&channel->converter, volts[i]) - plain_number(channel, volts[i]);
    good = good && fabs(off) <= 0.1 * channel->most; // not where it is no number
  }
  return good;
}

/* The polynomial between numbers and volts: from the calibration of boards that need one. */
static dea_status find_converter(struct dea_context *ctx, struct comedi *c, const struct part *part,
                                 int direction, struct channel *channel)
{
  int flags = c->library.get_subdevice_flags(c->device, part->subdevice), found = -1;
  if ((flags & DEA_COMEDI_SOFT_CALIBRATED) != 0) {
    char *path = c->library.get_default_calibration_path(c->device);
    void *calibration = path != NULL ? c->library.parse_calibration_file(path) : NULL;
    if (calibration != NULL) {
      found = c->library.get_softcal_converter(part->subdevice, channel->number, channel->range,
                                               direction, calibration, &channel->converter);
      c->library.cleanup_calibration(calibration);
    }
    free(path); // of the library
    if (found < 0) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                                   "%s has no calibration, so that its voltages may be wrong by a "
                                   "percent; run comedi_soft_calibrate",
                                   c->name));
    }
  }
  if (found < 0) {
    found = c->library.get_hardcal_converter(c->device, part->subdevice, channel->number,
                                             channel->range, direction, &channel->converter);
  }
  if (found >= 0 && direction == DEA_COMEDI_FROM_PHYSICAL && !is_plausible(channel)) {
    return dea_fail(ctx, DEA_E_INSTRUMENT,
                    "the calibration of %s is off by more than a tenth of the range; calibrate it "
                    "anew (comedi_soft_calibrate)",
                    c->name);
  }
  return found >= 0 ? DEA_OK : failed(ctx, c, "tell its calibration");
}

static dea_status add_channel(struct dea_context *ctx, struct comedi *c, struct part *part,
                              int direction, long number, double most_V)
{
  struct channel *channel = &part->channels[part->count];
  *channel = (struct channel){.number = (unsigned)number};
  if (number >= c->library.get_n_channels(c->device, part->subdevice)) {
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s has no %s%ld", c->name,
                    direction == DEA_COMEDI_FROM_PHYSICAL ? "ao" : "ai", number);
  }
  int range = c->library.find_range(c->device, part->subdevice, channel->number, DEA_COMEDI_VOLT,
                                    -most_V, most_V);
  if (range < 0) {
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s has no range of +-%g V for %s%ld", c->name, most_V,
                    direction == DEA_COMEDI_FROM_PHYSICAL ? "ao" : "ai", number);
  }
  channel->range = (unsigned)range;
  channel->most = c->library.get_maxdata(c->device, part->subdevice, channel->number);
  const struct dea_comedi_span *span =
      c->library.get_range(c->device, part->subdevice, channel->number, channel->range);
  if (span == NULL || channel->most == 0) {
    return failed(ctx, c, "tell its range");
  }
  channel->span = *span;
  part->list[part->count++] = channel->number | channel->range << 16 |
                              (direction == DEA_COMEDI_FROM_PHYSICAL ? 0 : c->wiring) << 24;
  return find_converter(ctx, c, part, direction, channel);
}

/* The command of a part: on a timer, begun by a trigger, without an end. */
static dea_status build_command(struct dea_context *ctx, struct comedi *c, struct part *part,
                                bool writes)
{
  double rate_Hz = c->protocol->rate_Hz.si;
  struct dea_comedi_command *command = &part->command;
  int result = c->library.get_cmd_generic_timed(c->device, part->subdevice, command,
                                                (unsigned)part->count, (unsigned)(1e9 / rate_Hz));
  if (result < 0) {
    return failed(ctx, c, writes ? "play on a clock" : "measure on a clock");
  }
  command->start_source = DEA_COMEDI_TRIGGER_INTERNAL;
  command->start_argument = 0;
  command->stop_source = DEA_COMEDI_TRIGGER_NONE;
  command->stop_argument = 0;
  command->scan_argument = (unsigned)(1e9 / rate_Hz + 0.5);
  command->flags |= writes ? DEA_COMEDI_WRITES : 0;
  command->channels = part->list;
  command->channel_count = (unsigned)part->count;
  for (int i = 0; i < TESTS; i++) { // each test may put right what the board cannot
    result = c->library.command_test(c->device, command);
    if (result == 0) {
      return dea_daq_check_rate(ctx, c->name, rate_Hz, 1e9 / command->scan_argument);
    }
  }
  return dea_fail(ctx, DEA_E_INSTRUMENT, "%s cannot %s at %g Hz (comedi_command_test: %d)", c->name,
                  writes ? "play" : "measure", rate_Hz, result);
}

/* The number of a voltage, within its range whatever is asked. Not by comedi_from_physical: by a
 * calibration the lowest voltage may have a number below 0, and that makes the largest of it. */
static unsigned number_of(const struct channel *channel, double volts)
{
  double inside = fmin(fmax(volts, channel->span.min), channel->span.max); // NAN: the lowest
  inside = isnan(volts) ? 0 : inside;
  double number = number_by(&channel->converter, inside);
  return (unsigned)fmin(fmax(nearbyint(number), 0), channel->most);
}

static bool set_zero(struct comedi *c)
{
  const struct channel *channel = &c->output.channels[0];
  return c->library.data_write(c->device, c->output.subdevice, channel->number, channel->range, 0,
                               number_of(channel, 0)) >= 0;
}

/* Opens the device and puts 0 V out. */
static dea_status open_output(struct dea_context *ctx, struct comedi *c)
{
  const struct dea_protocol *p = c->protocol;
  c->device = c->library.open(c->name);
  if (c->device == NULL) {
    return failed(ctx, c, "be opened; look at its driver, at 'dmesg' and at your rights to it");
  }
  DEA_TRY(ctx, find_part(ctx, c, DEA_COMEDI_OUTPUT, &c->output));
  DEA_TRY(ctx,
          add_channel(ctx, c, &c->output, DEA_COMEDI_FROM_PHYSICAL,
                      channel_number(p->amplifier.terminal.text, "ao"), p->amplifier.control_V.si));
  c->opened = true;
  return set_zero(c) ? DEA_OK : failed(ctx, c, "put 0 V out");
}

static dea_status set_up(struct dea_context *ctx, struct comedi *c)
{
  const struct dea_protocol *p = c->protocol;
  DEA_TRY(ctx, open_output(ctx, c));
  DEA_TRY(ctx, p->input_count > 0 ? find_part(ctx, c, DEA_COMEDI_INPUT, &c->input) : DEA_OK);
  for (size_t i = 0; i < p->input_count; i++) {
    DEA_TRY(ctx,
            add_channel(ctx, c, &c->input, DEA_COMEDI_TO_PHYSICAL,
                        channel_number(p->inputs[i].terminal.text, "ai"), p->inputs[i].range_V.si));
  }
  DEA_TRY(ctx, build_command(ctx, c, &c->output, true));
  DEA_TRY(ctx, p->input_count > 0 ? build_command(ctx, c, &c->input, false) : DEA_OK);
  c->descriptor = c->library.fileno(c->device);
  int flags = fcntl(c->descriptor, F_GETFL);
  if (flags < 0 || fcntl(c->descriptor, F_SETFL, flags | O_NONBLOCK) < 0) {
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s cannot be used: %s", c->name, strerror(errno));
  }
  // Armed now; samples may be written to it.
  return c->library.command(c->device, &c->output.command) >= 0 ? DEA_OK
                                                                : failed(ctx, c, "play on a clock");
}

static struct dea_zero stop(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct comedi *c = (struct comedi *)instrument;
  bool zero = true; // what was not opened was left as it is
  (void)ctx;
  if (c->opened) {
    c->library.cancel(c->device, c->output.subdevice);
    zero = set_zero(c);
  }
  if (c->daq.running && c->input.count > 0) {
    c->library.cancel(c->device, c->input.subdevice);
  }
  return (struct dea_zero){zero ? DEA_ZERO_COMMANDED : DEA_ZERO_UNKNOWN, NAN, NULL};
}

static void close_it(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct comedi *c = (struct comedi *)instrument;
  if (c->device != NULL) {
    c->library.close(c->device);
  }
  dea_daq_free(ctx, &c->daq);
  dea_free(ctx, c);
}

static dea_status open_it(struct dea_context *ctx, const void *data,
                          const struct dea_protocol *protocol, struct dea_instrument **out)
{
  const struct dea_daq_raw *raw = data;
  struct comedi *c = dea_alloc(ctx, 1, sizeof *c);
  DEA_TRY_MEMORY(c != NULL);
  c->base.type = &dea_instrument_comedi;
  c->base.roles = DEA_PLAYS_OUTPUT | (protocol->input_count > 0 ? DEA_READS_INPUTS : 0U);
  c->protocol = protocol;
  c->wiring = (unsigned)raw->wiring.value;
  snprintf(c->name, sizeof c->name, "%s", raw->device.text);
  dea_status status = dea_daq_begin(ctx, protocol, raw->queue_s.si, &c->daq);
  status = status == DEA_OK ? dea_comedi_open(ctx, raw->library.text, &c->library) : status;
  status = status == DEA_OK ? set_up(ctx, c) : status;
  if (status != DEA_OK) {
    status = dea_instrument_abandon(ctx, &c->base, status);
    close_it(ctx, &c->base);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = &c->base;
  return DEA_OK;
}

static struct dea_zero zero(struct dea_context *ctx, const void *data,
                            const struct dea_protocol *protocol,
                            const struct dea_instrument_past *past)
{
  (void)past; // its name is of the device, and stays with it
  const struct dea_daq_raw *raw = data;
  struct dea_zero result = {DEA_ZERO_UNKNOWN, NAN, NULL};
  struct comedi *c = dea_alloc(ctx, 1, sizeof *c);
  if (c == NULL) {
    return result;
  }
  c->protocol = protocol;
  snprintf(c->name, sizeof c->name, "%s", raw->device.text);
  if (dea_comedi_open(ctx, raw->library.text, &c->library) == DEA_OK &&
      open_output(ctx, c) == DEA_OK) {
    result.state = DEA_ZERO_COMMANDED;
  }
  close_it(ctx, &c->base);
  return result;
}

/* Inputs first, so that none of the output is missed. */
static dea_status start_commands(struct dea_context *ctx, struct comedi *c)
{
  bool measures = c->input.count > 0;
  c->daq.running = true;
  if (measures && c->library.command(c->device, &c->input.command) < 0) {
    return failed(ctx, c, "measure on a clock");
  }
  double before_s = dea_clock_s();
  if (measures && c->library.internal_trigger(c->device, c->input.subdevice, 0) < 0) {
    return failed(ctx, c, "start its inputs");
  }
  if (c->library.internal_trigger(c->device, c->output.subdevice, 0) < 0) {
    return failed(ctx, c, "start its output");
  }
  double late_s = dea_clock_s() - before_s;
  return measures ? dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                    "the output of %s started up to %.2g ms after its inputs",
                                    c->name, 1e3 * late_s)
                  : DEA_OK;
}

static dea_status start_comedi(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct comedi *c = (struct comedi *)instrument;
  c->daq.asked_to_start = true;
  return c->daq.queued > 0 ? start_commands(ctx, c) : DEA_OK; // else with the first sample
}

/* Waits until the queue has room. DEA_E_INSTRUMENT when that takes too long. */
static dea_status wait_for_room(struct dea_context *ctx, struct comedi *c, size_t *capacity)
{
  double until_s =
      dea_clock_s() + DEA_DAQ_PATIENCE_S + (double)c->daq.capacity / c->protocol->rate_Hz.si;
  for (;;) {
    int bytes = c->library.get_buffer_contents(c->device, c->output.subdevice);
    size_t held = bytes > 0 ? (size_t)bytes / c->output.sample_size : 0;
    if (bytes < 0) {
      return failed(ctx, c, "tell what it has left to play");
    }
    if (held < c->daq.capacity) {
      *capacity = c->daq.capacity - held;
      return DEA_OK;
    }
    if (dea_clock_s() > until_s) {
      return dea_fail(ctx, DEA_E_INSTRUMENT, "%s takes no more samples", c->name);
    }
    dea_clock_wait(0.05 * (double)c->daq.capacity / c->protocol->rate_Hz.si);
  }
}

/* Writes samples; *count: how many went. */
static dea_status write_samples(struct dea_context *ctx, struct comedi *c, const double *volts,
                                size_t *count)
{
  unsigned char bytes[1024];
  size_t size = c->output.sample_size, most = sizeof bytes / size;
  size_t part = *count < most ? *count : most;
  for (size_t i = 0; i < part; i++) {
    uint32_t number = number_of(&c->output.channels[0], volts[i]);
    uint16_t half = (uint16_t)number;
    memcpy(bytes + i * size, size == 4 ? (void *)&number : (void *)&half, size);
  }
  ssize_t written = write(c->descriptor, bytes, part * size);
  *count = written > 0 ? (size_t)written / size : 0;
  if (written > 0 && (size_t)written % size == 0) {
    return DEA_OK;
  }
  if (written < 0 && (errno == EAGAIN || errno == EINTR)) {
    struct pollfd entry = {.fd = c->descriptor, .events = POLLOUT};
    int ready = poll(&entry, 1, (int)(1e3 * DEA_DAQ_PATIENCE_S));
    return ready != 0 ? DEA_OK
                      : dea_fail(ctx, DEA_E_INSTRUMENT, "%s takes no more samples", c->name);
  }
  if (written == 0 || (written < 0 && errno == EPIPE)) {
    c->daq.ran_dry = true; // the command has ended
    return DEA_OK;
  }
  return dea_fail(ctx, DEA_E_INSTRUMENT, "%s cannot play on: %s", c->name,
                  written < 0 ? strerror(errno) : "half a sample was written");
}

static dea_status set_outputs(struct dea_context *ctx, struct dea_instrument *instrument,
                              const double *volts, size_t count)
{
  struct comedi *c = (struct comedi *)instrument;
  DEA_TRY(ctx, dea_protocol_guard(ctx, c->protocol, volts, count));
  while (count > 0) {
    size_t part, capacity = c->daq.capacity;
    DEA_TRY(ctx, dea_daq_part(ctx, &c->daq, c->name, count, &part));
    DEA_TRY(ctx, c->daq.running ? wait_for_room(ctx, c, &capacity) : DEA_OK);
    part = part < capacity ? part : capacity;
    DEA_TRY(ctx, write_samples(ctx, c, volts, &part));
    c->daq.queued += part;
    volts += part;
    count -= part;
    if (c->daq.asked_to_start && !c->daq.running && c->daq.queued > 0) {
      DEA_TRY(ctx, start_commands(ctx, c));
    }
  }
  return DEA_OK;
}

/* Hands over the whole scans among what was received. */
static dea_status hand_over(struct dea_context *ctx, struct comedi *c, const struct dea_sink *sink)
{
  size_t n = c->input.count, size = c->input.sample_size, used = 0, scans;
  while ((scans = (c->received_length - used) / (n * size)) > 0) {
    scans = scans < c->daq.scans_room ? scans : c->daq.scans_room;
    for (size_t i = 0; i < scans * n; i++, used += size) {
      uint32_t number = 0;
      uint16_t half = 0;
      memcpy(size == 4 ? (void *)&number : (void *)&half, c->received + used, size);
      c->daq.scans[i] =
          c->library.to_physical(size == 4 ? number : half, &c->input.channels[i % n].converter);
    }
    DEA_TRY(ctx, sink->samples(sink->user, c->daq.scans, scans));
  }
  c->received_length -= used;
  memmove(c->received, c->received + used, c->received_length);
  return DEA_OK;
}

static dea_status get(struct dea_context *ctx, struct dea_instrument *instrument, double timeout_s,
                      const struct dea_sink *sink)
{
  struct comedi *c = (struct comedi *)instrument;
  if (!c->daq.running || c->input.count == 0) {
    dea_clock_wait(timeout_s);
    return DEA_OK;
  }
  struct pollfd entry = {.fd = c->descriptor, .events = POLLIN};
  (void)c->library.poll(c->device, c->input.subdevice); // brings what the board holds
  (void)poll(&entry, 1, timeout_s > 0 ? (int)(1e3 * fmin(timeout_s, 60) + 0.999) : 0);
  ssize_t got = read(c->descriptor, c->received + c->received_length,
                     sizeof c->received - c->received_length);
  if (got > 0) {
    c->received_length += (size_t)got;
    return hand_over(ctx, c, sink);
  }
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
    return DEA_OK;
  }
  return dea_fail(ctx, DEA_E_INSTRUMENT,
                  "%s stopped measuring (%s): it was removed, or samples were not taken in time",
                  c->name, got < 0 ? strerror(errno) : "its command ended");
}

const struct dea_instrument_type dea_instrument_comedi = {
    .name = "comedi",
    .record = &dea_instrument_comedi_record,
    .raw_size = sizeof(struct dea_daq_raw),
    .roles = DEA_PLAYS_OUTPUT | DEA_READS_INPUTS,
    .check = check,
    .open = open_it,
    .start = start_comedi,
    .put = set_outputs,
    .get = get,
    .stop = stop,
    .address = dea_daq_address,
    .zero = zero,
    .close = close_it,
};
