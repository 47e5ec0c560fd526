/* A DAQ with a fake library: the same protocol for all of them. */
#pragma once

#include "emulator.h"
#include "failing_allocator.h"
#include "fake_daq.h"

#include <dlfcn.h>
#include <stdlib.h>

struct daq_bench {
  struct fake_daq *fake;
  struct dea_protocol protocol;
  struct dea_protocol_input inputs[2];
  struct dea_instrument *instrument;
  struct emulator_sink sink;
  char text[1024];
};

/* The user's own list has the fake libraries. */
static inline void daq_bench_allow(void)
{
  assert_int_equal(setenv("XDG_CONFIG_HOME", DEA_FAKE_FOLDER "/config", 1), 0);
}

/* The fake's state from its beginning, and a protocol of 1 kHz with two inputs. */
static inline void daq_bench_begin(struct daq_bench *b, const char *library)
{
  memset(b, 0, sizeof *b);
  daq_bench_allow();
  void *handle = dlopen(library, RTLD_NOW | RTLD_LOCAL); // the one that the instrument gets
  assert_non_null(handle);
  fake_daq_get get;
  void *symbol = dlsym(handle, "fake_daq");
  assert_non_null(symbol);
  memcpy(&get, &symbol, sizeof get);
  b->fake = get();
  memset(b->fake, 0, sizeof *b->fake);
  b->fake->level_V = 3; // of whoever was here before
  b->sink.channels = 2;
  b->protocol.rate_Hz.si = 1000;
  b->protocol.amplifier.control_V.si = 10;
  strcpy(b->protocol.amplifier.terminal.text, "ao1");
  b->protocol.inputs = b->inputs;
  b->protocol.input_count = 2;
  strcpy(b->inputs[0].terminal.text, "ai0");
  strcpy(b->inputs[1].terminal.text, "ai5");
  b->inputs[0].range_V.si = 10;
  b->inputs[1].range_V.si = 5;
}

/* Plays a ramp of `count` samples in parts and compares what the inputs saw of it. */
static inline void daq_bench_play(struct dea_context *context, struct daq_bench *b, size_t count,
                                  double tolerance_V)
{
  const struct dea_instrument_type *type = b->instrument->type;
  double volts[50];
  for (size_t i = 0; i < count; i += 50) {
    for (size_t k = 0; k < 50; k++) {
      volts[k] = 1e-3 * (double)(i + k) - 0.5;
    }
    assert_int_equal(type->put(context, b->instrument, volts, 50), DEA_OK);
    if (i == 100) {
      assert_int_equal(type->start(context, b->instrument), DEA_OK);
    }
    assert_int_equal(emulator_get(context, b->instrument, &b->sink, 0, 0, i >= 100 ? i : 0),
                     DEA_OK);
  }
  assert_int_equal(emulator_get(context, b->instrument, &b->sink, 0, 0, count), DEA_OK);
  assert_int_equal(b->sink.samples, count);
  for (size_t i = 0; i < count; i++) {
    double wanted = 1e-3 * (double)i - 0.5;
    assert_close(b->fake->played[i], wanted, 0, tolerance_V);
    assert_close(b->sink.volts[2 * i], wanted, 0, 2 * tolerance_V);
    assert_close(b->sink.volts[2 * i + 1], 2 * wanted, 0, 3 * tolerance_V);
  }
}

/* Beyond what amplifier and specimen may see nothing goes out, whatever is asked. */
static inline void daq_bench_check_cap(struct dea_context *context, struct daq_bench *b)
{
  static const double beyond[][3] = {
      {0, 10.01, 0}, {0, 0, -10.01}, {NAN, 0, 0}, {0, INFINITY, 0}, {0, 6.01, 0}};
  size_t written = b->fake->written;
  for (size_t i = 0; i < sizeof beyond / sizeof beyond[0]; i++) {
    if (i == 4) {
      b->protocol.specimen.highest_V = (struct dea_quantity){6e3, DEA_GIVEN, {"", 0, 0}};
    }
    assert_int_equal(b->instrument->type->put(context, b->instrument, beyond[i], 3),
                     DEA_E_INTERLOCK);
    assert_non_null(strstr(dea_context_message(context), "was about to go out"));
  }
  assert_int_equal(b->fake->written, written);
}

static inline void daq_bench_end(struct dea_context *context, struct daq_bench *b)
{
  if (b->instrument != NULL) {
    emulator_close(context, b->instrument);
  }
  free(b->sink.volts);
  assert_int_equal(b->fake->tasks, 0); // everything was given back
}

static struct daq_bench daq_memory_bench;

static inline void daq_bench_open_and_close(struct dea_context *context)
{
  struct daq_bench *b = &daq_memory_bench;
  dea_status status = emulator_open(context, &b->protocol, b->text, &b->instrument);
  failing_check(context, status);
  if (status == DEA_OK) {
    emulator_close(context, b->instrument);
  }
  assert_int_equal(b->fake->tasks, 0);
}

/* Opens an instrument of that kind with each allocation failed in turn. */
static inline void daq_bench_check_memory(const char *kind, const char *library)
{
  struct daq_bench *b = &daq_memory_bench;
  daq_bench_begin(b, library);
  snprintf(b->text, sizeof b->text, "kind: %s\nlibrary: %s\n", kind, library);
  assert_true(failing_each(daq_bench_open_and_close) > 3);
}
