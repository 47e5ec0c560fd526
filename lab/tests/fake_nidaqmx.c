/* A library that looks like NI-DAQmx: libnidaqmx.so.1. */
#pragma GCC diagnostic ignored "-Wmissing-prototypes"
#include "fake_daq.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static struct fake_daq fake;
static int good_calls;
static char error[256];

__attribute__((visibility("default"))) struct fake_daq *fake_daq(void)
{
  return &fake;
}

struct task {
  int used, input, channels, started, clocked;
};
static struct task all[8];

/* Logs a call; the code that it is to give. */
static int32_t call(const char *name, const char *format, ...)
{
  size_t length = strlen(fake.log);
  char text[400];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  snprintf(fake.log + length, sizeof fake.log - length, "%s(%s)\n", name, text);
  if (strcmp(fake.fails, name) != 0 || good_calls++ < fake.fails_after) {
    return 0;
  }
  good_calls = 0;
  snprintf(error, sizeof error, "The fake says no.\nTask: %s", name);
  return fake.code;
}

#define API __attribute__((visibility("default"))) int32_t
#define CALL(name, ...)                                                                            \
  do {                                                                                             \
    int32_t code_ = call(name, __VA_ARGS__);                                                       \
    if (code_ < 0) {                                                                               \
      return code_;                                                                                \
    }                                                                                              \
  } while (0)

API DAQmxCreateTask(const char *name, void **task)
{
  (void)name;
  CALL("CreateTask", "%s", "");
  for (size_t i = 0; i < 8; i++) {
    if (!all[i].used) {
      all[i] = (struct task){.used = 1};
      *task = &all[i];
      fake.tasks++;
      return 0;
    }
  }
  return -1;
}

API DAQmxCreateAOVoltageChan(void *task, const char *channel, const char *name, double min,
                             double max, int32_t units, const char *scale)
{
  (void)task, (void)name, (void)scale;
  CALL("AO", "%s %g %g %d", channel, min, max, units);
  return 0;
}

API DAQmxCreateAIVoltageChan(void *task, const char *channel, const char *name, int32_t wiring,
                             double min, double max, int32_t units, const char *scale)
{
  struct task *t = task;
  (void)name, (void)scale;
  CALL("AI", "%s %d %g %g %d", channel, wiring, min, max, units);
  t->input = 1;
  t->channels++;
  return 0;
}

API DAQmxCfgSampClkTiming(void *task, const char *source, double rate, int32_t edge, int32_t mode,
                          uint64_t samples)
{
  (void)source, (void)samples;
  CALL("CfgSampClkTiming", "%g %d %d", rate, edge, mode);
  ((struct task *)task)->clocked = 1;
  return 0;
}

API DAQmxGetSampClkRate(void *task, double *rate)
{
  (void)task;
  *rate = 1000 * (fake.rate_factor > 0 ? fake.rate_factor : 1);
  return 0;
}

API DAQmxCfgDigEdgeStartTrig(void *task, const char *source, int32_t edge)
{
  CALL("CfgDigEdgeStartTrig", "%s %d", source, edge);
  (void)task;
  return 0;
}

API DAQmxCfgOutputBuffer(void *task, uint32_t samples)
{
  (void)task;
  fake.queue = samples;
  return call("CfgOutputBuffer", "%u", samples);
}

API DAQmxSetWriteRegenMode(void *task, int32_t mode)
{
  (void)task;
  return call("SetWriteRegenMode", "%d", mode);
}

API DAQmxStartTask(void *task)
{
  struct task *t = task;
  CALL("StartTask", "%s", t->input ? "inputs" : "output");
  t->started = 1;
  fake.running += !t->input;
  return 0;
}

API DAQmxStopTask(void *task)
{
  struct task *t = task;
  fake.running -= t->started && !t->input;
  t->started = 0;
  return call("StopTask", "%s", t->input ? "inputs" : "output");
}

API DAQmxClearTask(void *task)
{
  ((struct task *)task)->used = 0;
  fake.tasks--;
  return call("ClearTask", "%s", "");
}

API DAQmxIsTaskDone(void *task, uint32_t *done)
{
  (void)task;
  *done = 0;
  return fake.dry_after > 0 && fake.read >= (size_t)fake.dry_after ? -200290 : 0;
}

API DAQmxWriteAnalogF64(void *task, int32_t samples, uint32_t start, double timeout_s,
                        uint32_t layout, const double *volts, int32_t *written, uint32_t *reserved)
{
  struct task *t = task;
  (void)timeout_s, (void)layout, (void)reserved;
  if (!t->clocked) { // at once
    CALL("WriteNow", "%d %g %u", samples, volts[0], start);
    fake.level_V = volts[0];
    return 0;
  }
  CALL("Write", "%d", samples);
  if (!t->started && fake.written + (size_t)samples > fake.queue) {
    return -200292;
  }
  for (int32_t i = 0; i < samples && fake.written < FAKE_DAQ_SAMPLES; i++) {
    fake.played[fake.written++] = volts[i];
    fake.level_V = volts[i];
  }
  *written = samples;
  return 0;
}

API DAQmxGetReadAvailSampPerChan(void *task, uint32_t *samples)
{
  struct task *t = task;
  size_t left = fake.running && t->started ? fake.written - fake.read : 0;
  *samples = left < 7 ? (uint32_t)left : 7;
  return call("Avail", "%u", *samples);
}

API DAQmxReadAnalogF64(void *task, int32_t samples, double timeout_s, uint32_t layout,
                       double *volts, uint32_t capacity, int32_t *read, uint32_t *reserved)
{
  struct task *t = task;
  (void)timeout_s, (void)reserved;
  *read = 0;
  CALL("Read", "%d %u", samples, layout);
  if (capacity < (uint32_t)(samples * t->channels)) {
    return -200229;
  }
  for (; *read < samples && fake.read < fake.written; ++*read) {
    for (int k = 0; k < t->channels; k++) {
      volts[*read * t->channels + k] = (k + 1) * fake.played[fake.read];
    }
    fake.read++;
  }
  return *read < samples ? -200284 : 0;
}

API DAQmxGetExtendedErrorInfo(char *text, uint32_t size)
{
  snprintf(text, size, "%s", error);
  return 0;
}
