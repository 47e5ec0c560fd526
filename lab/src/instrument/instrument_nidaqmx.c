/* Instrument "nidaqmx": a DAQ of National Instruments by the library NI-DAQmx, which is loaded when
 * it is opened. The output is played from a queue without repetition; the inputs start with it, by
 * its start trigger, and both have the device's clock. The few prototypes and numbers below are
 * those of the "NI-DAQmx C Reference". Not tried with a device. */
#include "base/clock.h"
#include "instrument/instrument_make.h"

#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { // DAQmx_Val_...
  DEFAULT = -1,
  REFERENCED = 10083,
  NON_REFERENCED = 10078,
  DIFFERENTIAL = 10106,
  PSEUDODIFFERENTIAL = 12529,
  VOLTS = 10348,
  RISING = 10280,
  CONTINUOUS = 10123,
  NO_REGENERATION = 10158,
  BY_CHANNEL = 0,
  BY_SCAN = 1,
};
enum { // DAQmxError...
  NOT_YET_AVAILABLE = -200284,
  NO_REPETITION_OF_OLD = -200290,
  NO_REPETITION_OF_OLD_2 = -200291,
  MEMORY_UNDERFLOW = -200621,
};

#define FUNCTIONS(X)                                                                               \
  X(CreateTask, (const char *name, void **task))                                                   \
  X(CreateAOVoltageChan, (void *task, const char *channel, const char *name, double min,           \
                          double max, int32_t units, const char *scale))                           \
  X(CreateAIVoltageChan, (void *task, const char *channel, const char *name, int32_t wiring,       \
                          double min, double max, int32_t units, const char *scale))               \
  X(CfgSampClkTiming,                                                                              \
    (void *task, const char *source, double rate, int32_t edge, int32_t mode, uint64_t samples))   \
  X(GetSampClkRate, (void *task, double *rate))                                                    \
  X(CfgDigEdgeStartTrig, (void *task, const char *source, int32_t edge))                           \
  X(CfgOutputBuffer, (void *task, uint32_t samples))                                               \
  X(SetWriteRegenMode, (void *task, int32_t mode))                                                 \
  X(StartTask, (void *task))                                                                       \
  X(StopTask, (void *task))                                                                        \
  X(ClearTask, (void *task))                                                                       \
  X(IsTaskDone, (void *task, uint32_t *done))                                                      \
  X(WriteAnalogF64, (void *task, int32_t samples, uint32_t start, double timeout_s,                \
                     uint32_t layout, const double *volts, int32_t *written, uint32_t *reserved))  \
  X(GetReadAvailSampPerChan, (void *task, uint32_t *samples))                                      \
  X(ReadAnalogF64, (void *task, int32_t samples, double timeout_s, uint32_t layout, double *volts, \
                    uint32_t capacity, int32_t *read, uint32_t *reserved))                         \
  X(GetExtendedErrorInfo, (char *text, uint32_t size))

struct driver {
#define MEMBER(name, arguments) int32_t(*name) arguments;
  FUNCTIONS(MEMBER)
#undef MEMBER
};
static const struct {
  const char *name;
  size_t offset;
} symbols[] = {
#define SYMBOL(name, arguments) {"DAQmx" #name, offsetof(struct driver, name)},
    FUNCTIONS(SYMBOL)
#undef SYMBOL
};

static const char *const wirings[] = {"default",      "referenced",         "non_referenced",
                                      "differential", "pseudodifferential", NULL};
static const int32_t wiring_values[] = {DEFAULT, REFERENCED, NON_REFERENCED, DIFFERENTIAL,
                                        PSEUDODIFFERENTIAL};

/* Longest time that the driver may take for what should be done at once. */
static const double patience_s = 2;
/* Samples of the inputs that it keeps while nobody takes them, and that are taken at a time. */
static const double input_room_s = 10, scans_room_s = 0.5;
/* Clocks are whole divisions of a quartz: what differs less was rounded in between. */
static const double same_rate = 1e-7;
enum { ROOM_LEAST = 64 };

struct raw {
  struct dea_label kind, device;
  struct dea_choice wiring;
  struct dea_quantity queue_s;
};
static const struct dea_field fields[] = {
    DEA_INSTRUMENT_KIND(struct raw, "nidaqmx"),
    DEA_INSTRUMENT_LABEL(struct raw, device, "device", "its name in NI MAX or `nilsdev`", "Dev1",
                         .default_text = "Dev1"),
    DEA_INSTRUMENT_CHOICE(struct raw, wiring, "wiring", "of all inputs", wirings, "default"),
    DEA_INSTRUMENT_TIME(
        struct raw, queue_s, "queue",
        "of the output that is held ready; as long it takes until a stop is heard of", "0.25 s",
        60),
};
const struct dea_record dea_instrument_nidaqmx_record = {
    "nidaqmx", "plays and measures with a DAQ of National Instruments", fields,
    DEA_INSTRUMENT_COUNT(fields)};

struct nidaqmx {
  struct dea_instrument base;
  struct driver driver;
  char device[DEA_TITLE_SIZE];
  const struct dea_protocol *protocol;
  void *output, *input; // tasks; NULL: none
  size_t capacity;      // of the output's queue, samples
  size_t queued;        // samples given to the driver
  size_t scans_room;    // of scans, samples of each input
  double *scans;        // [scans_room][inputs]; owned
  bool asked_to_start, running;
  bool ran_dry; // the output had nothing left to play
};

/* Passes a negative code on with the library's own sentence; positive ones are warnings. */
static dea_status judge(struct dea_context *ctx, const struct nidaqmx *n, int32_t code,
                        const char *what)
{
  if (code >= 0) {
    return DEA_OK;
  }
  char text[2048] = "";
  n->driver.GetExtendedErrorInfo(text, sizeof text);
  text[sizeof text - 1] = '\0';
  for (char *c = text; *c != '\0'; c++) {
    *c = *c == '\n' || *c == '\r' ? ' ' : *c;
  }
  return dea_fail(ctx, DEA_E_INSTRUMENT, "%s cannot %s (NI-DAQmx %d): %.600s", n->device, what,
                  (int)code, text[0] != '\0' ? text : "no explanation");
}

#define TRY(n, what, function, ...)                                                                \
  DEA_TRY(ctx, judge(ctx, n, (n)->driver.function(__VA_ARGS__), what))

/* "Dev1/ao0" of "ao0"; a terminal that names its device stays. */
static void channel_of(const struct nidaqmx *n, const char *terminal, char out[2 * DEA_TITLE_SIZE])
{
  snprintf(out, 2 * DEA_TITLE_SIZE, "%s%s%s", strchr(terminal, '/') != NULL ? "" : n->device,
           strchr(terminal, '/') != NULL ? "" : "/", terminal);
}

/* A task of the output alone, which is not on a clock yet. */
static dea_status build_output(struct dea_context *ctx, struct nidaqmx *n)
{
  char channel[2 * DEA_TITLE_SIZE];
  double most_V = n->protocol->amplifier.control_V.si;
  channel_of(n, n->protocol->amplifier.terminal.text, channel);
  TRY(n, "make its output", CreateTask, "", &n->output);
  TRY(n, "play on that output", CreateAOVoltageChan, n->output, channel, "", -most_V, most_V, VOLTS,
      NULL);
  return DEA_OK;
}

static void clear(const struct nidaqmx *n, void **task)
{
  if (*task != NULL) {
    n->driver.StopTask(*task);
    n->driver.ClearTask(*task);
    *task = NULL;
  }
}

/* Puts 0 V out at once, by a task of its own. */
static dea_status set_zero(struct dea_context *ctx, struct nidaqmx *n)
{
  const double zero = 0;
  clear(n, &n->output);
  dea_status status = build_output(ctx, n);
  if (status == DEA_OK) {
    n->base.reached = true; // its output is there, at whatever voltage
    int32_t code =
        n->driver.WriteAnalogF64(n->output, 1, 1, patience_s, BY_CHANNEL, &zero, NULL, NULL);
    status = judge(ctx, n, code, "put 0 V out");
  }
  clear(n, &n->output);
  return status;
}

static size_t samples_of(const struct nidaqmx *n, double seconds)
{
  double samples = seconds * n->protocol->rate_Hz.si;
  return samples > ROOM_LEAST ? (size_t)samples : ROOM_LEAST;
}

/* A device whose clock differs from what was asked is refused, with the next rate that goes. */
static dea_status set_clock(struct dea_context *ctx, struct nidaqmx *n, void *task, size_t samples)
{
  double actual_Hz = 0, rate_Hz = n->protocol->rate_Hz.si;
  TRY(n, "take that rate", CfgSampClkTiming, task, "", rate_Hz, RISING, CONTINUOUS, samples);
  TRY(n, "tell its rate", GetSampClkRate, task, &actual_Hz);
  return fabs(actual_Hz - rate_Hz) <= same_rate * rate_Hz
             ? DEA_OK
             : dea_fail(ctx, DEA_E_INSTRUMENT, "%s has no rate of %.12g Hz; write 'rate: %.12g Hz'",
                        n->device, rate_Hz, actual_Hz);
}

static dea_status build_input(struct dea_context *ctx, struct nidaqmx *n, int32_t wiring)
{
  char channel[2 * DEA_TITLE_SIZE], trigger[DEA_TITLE_SIZE + 32];
  if (n->protocol->input_count == 0) {
    return DEA_OK;
  }
  TRY(n, "make its inputs", CreateTask, "", &n->input);
  for (size_t i = 0; i < n->protocol->input_count; i++) {
    const struct dea_protocol_input *input = &n->protocol->inputs[i];
    channel_of(n, input->terminal.text, channel);
    TRY(n, "measure on that input", CreateAIVoltageChan, n->input, channel, "", wiring,
        -input->range_V.si, input->range_V.si, VOLTS, NULL);
  }
  DEA_TRY(ctx, set_clock(ctx, n, n->input, samples_of(n, input_room_s)));
  snprintf(trigger, sizeof trigger, "/%s/ao/StartTrigger", n->device);
  TRY(n, "start its inputs with its output", CfgDigEdgeStartTrig, n->input, trigger, RISING);
  return DEA_OK;
}

static dea_status set_up(struct dea_context *ctx, struct nidaqmx *n, int32_t wiring)
{
  DEA_TRY(ctx, set_zero(ctx, n));
  DEA_TRY(ctx, build_output(ctx, n));
  DEA_TRY(ctx, set_clock(ctx, n, n->output, n->capacity));
  TRY(n, "play without repetition", SetWriteRegenMode, n->output, NO_REGENERATION);
  TRY(n, "take a queue of that length", CfgOutputBuffer, n->output, (uint32_t)n->capacity);
  return build_input(ctx, n, wiring);
}

static struct dea_zero stop(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct nidaqmx *n = (struct nidaqmx *)instrument;
  clear(n, &n->output);
  clear(n, &n->input);
  bool zero = set_zero(ctx, n) == DEA_OK;
  return (struct dea_zero){zero ? DEA_ZERO_COMMANDED : DEA_ZERO_UNKNOWN, NAN, NULL};
}

static void close_it(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct nidaqmx *n = (struct nidaqmx *)instrument;
  clear(n, &n->output);
  clear(n, &n->input);
  dea_free(ctx, n->scans);
  dea_free(ctx, n);
}

/* Loads the library for good: it may not stand being unloaded. */
static dea_status load(struct dea_context *ctx, const struct raw *raw, struct nidaqmx *n)
{
  static const char advice[] =
      "it is installed from ni.com for PCIe and PXI devices; Linux has no driver for USB devices, "
      "so play on Windows with the scripts of 'dea drive --export'";
  snprintf(n->device, sizeof n->device, "%s", raw->device.text);
  void *library = dlopen("libnidaqmx.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == NULL) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "NI-DAQmx is not on this computer (%.200s): %s",
                    dlerror(), advice);
  }
  for (size_t i = 0; i < DEA_INSTRUMENT_COUNT(symbols); i++) {
    void *symbol = dlsym(library, symbols[i].name);
    if (symbol == NULL) {
      return dea_fail(ctx, DEA_E_UNSUPPORTED, "NI-DAQmx has no function %s: %s", symbols[i].name,
                      advice);
    }
    // As bytes: C knows no conversion of a data pointer to one of a function.
    memcpy((char *)&n->driver + symbols[i].offset, &symbol, sizeof symbol);
  }
  return DEA_OK;
}

static void address(const void *raw, char *out, size_t size)
{
  snprintf(out, size, "%s", ((const struct raw *)raw)->device.text);
}

static struct dea_zero zero(struct dea_context *ctx, const void *data,
                            const struct dea_protocol *protocol,
                            const struct dea_instrument_past *past)
{
  (void)past; // its name is of the device, and stays with it
  struct nidaqmx n = {.protocol = protocol};
  bool good = load(ctx, data, &n) == DEA_OK && set_zero(ctx, &n) == DEA_OK;
  return (struct dea_zero){good ? DEA_ZERO_COMMANDED : DEA_ZERO_UNKNOWN, NAN, NULL};
}

static dea_status open_it(struct dea_context *ctx, struct dea_instrument *instrument,
                          const void *data, const struct dea_protocol *protocol)
{
  const struct raw *raw = data;
  struct nidaqmx *n = (struct nidaqmx *)instrument;
  n->base.roles = DEA_PLAYS_OUTPUT | (protocol->input_count > 0 ? DEA_READS_INPUTS : 0U);
  n->protocol = protocol;
  n->capacity = samples_of(n, raw->queue_s.si);
  n->scans_room = samples_of(n, scans_room_s);
  n->scans = dea_alloc(ctx, n->scans_room, sizeof *n->scans * (protocol->input_count + 1));
  DEA_TRY_MEMORY(n->scans != NULL);
  DEA_TRY(ctx, load(ctx, raw, n));
  return set_up(ctx, n, wiring_values[raw->wiring.value]);
}

/* Inputs first: they wait for the output's trigger. */
static dea_status start_tasks(struct dea_context *ctx, struct nidaqmx *n)
{
  n->running = true;
  if (n->input != NULL) {
    TRY(n, "start its inputs", StartTask, n->input);
  }
  TRY(n, "start its output", StartTask, n->output);
  return DEA_OK;
}

static dea_status start_nidaqmx(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct nidaqmx *n = (struct nidaqmx *)instrument;
  n->asked_to_start = true;
  return n->queued > 0 ? start_tasks(ctx, n) : DEA_OK; // else with the first sample
}

/* How many of `count` samples may be given to the driver at once. */
static dea_status part_of(struct dea_context *ctx, const struct nidaqmx *n, size_t count,
                          size_t *part)
{
  if (n->ran_dry) {
    return dea_fail(ctx, DEA_E_INSTRUMENT,
                    "%s had nothing left to play: the computer was too slow; give it a longer "
                    "'queue' or a lower rate",
                    n->device);
  }
  // before the start no more than the queue holds; afterwards the driver waits for room
  size_t most = n->running ? n->capacity / 2 : n->capacity - n->queued;
  *part = count < most ? count : most;
  return most > 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_ARGUMENT, "more than %zu samples before the start", n->capacity);
}

static dea_status set_outputs(struct dea_context *ctx, struct dea_instrument *instrument,
                              const double *volts, size_t count)
{
  struct nidaqmx *n = (struct nidaqmx *)instrument;
  DEA_TRY(ctx, dea_protocol_guard(ctx, n->protocol, volts, count));
  while (count > 0) {
    int32_t written = 0;
    size_t part;
    DEA_TRY(ctx, part_of(ctx, n, count, &part));
    double timeout_s = patience_s + (double)n->capacity / n->protocol->rate_Hz.si;
    TRY(n, "play on", WriteAnalogF64, n->output, (int32_t)part, 0, timeout_s, BY_CHANNEL, volts,
        &written, NULL);
    if (written <= 0 || (size_t)written > part) {
      return dea_fail(ctx, DEA_E_INSTRUMENT, "%s takes no more samples", n->device);
    }
    n->queued += (size_t)written;
    volts += written;
    count -= (size_t)written;
    DEA_TRY(ctx, n->asked_to_start && !n->running ? start_tasks(ctx, n) : DEA_OK);
  }
  return DEA_OK;
}

/* Whether the output still plays. One that has nothing left to play is no failure until it is given
 * more: so ends every sequence. */
static dea_status check_output(struct dea_context *ctx, struct nidaqmx *n)
{
  uint32_t done = 0;
  int32_t code = n->driver.IsTaskDone(n->output, &done);
  if (code == NO_REPETITION_OF_OLD || code == NO_REPETITION_OF_OLD_2 || code == MEMORY_UNDERFLOW) {
    n->ran_dry = true;
    return DEA_OK;
  }
  return judge(ctx, n, code, "play on");
}

static dea_status get(struct dea_context *ctx, struct dea_instrument *instrument, double timeout_s,
                      const struct dea_sink *sink)
{
  struct nidaqmx *n = (struct nidaqmx *)instrument;
  uint32_t ready = 0;
  int32_t got = 0;
  if (!n->running || n->input == NULL) {
    dea_clock_wait(timeout_s);
    return n->running ? check_output(ctx, n) : DEA_OK;
  }
  DEA_TRY(ctx, check_output(ctx, n));
  TRY(n, "measure on", GetReadAvailSampPerChan, n->input, &ready);
  size_t most = n->scans_room, wanted = ready < 1 ? 1 : ready < most ? ready : most;
  if (ready == 0 && timeout_s <= 0) {
    return DEA_OK;
  }
  int32_t code = n->driver.ReadAnalogF64(n->input, (int32_t)wanted, timeout_s, BY_SCAN, n->scans,
                                         (uint32_t)(most * n->protocol->input_count), &got, NULL);
  DEA_TRY(ctx, code != NOT_YET_AVAILABLE ? judge(ctx, n, code, "measure on") : DEA_OK);
  return got > 0 && (size_t)got <= wanted ? sink->samples(sink->user, n->scans, (size_t)got)
                                          : DEA_OK;
}

const struct dea_instrument_type dea_instrument_nidaqmx = {
    .name = "nidaqmx",
    .record = &dea_instrument_nidaqmx_record,
    .raw_size = sizeof(struct raw),
    .size = sizeof(struct nidaqmx),
    .roles = DEA_PLAYS_OUTPUT | DEA_READS_INPUTS,
    .open = open_it,
    .start = start_nidaqmx,
    .put = set_outputs,
    .get = get,
    .stop = stop,
    .address = address,
    .zero = zero,
    .close = close_it,
};
