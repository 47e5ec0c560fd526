// DAQs of National Instruments, with a fake library in place of NI-DAQmx.
#include "emulator.h"
#include "failing_allocator.h"
#include "fake_daq.h"
#include "message_fixture.h"

#include <dlfcn.h>
#include <stdlib.h>

static struct bench {
  struct fake_daq *fake;
  struct dea_protocol protocol;
  struct dea_protocol_input inputs[2];
  struct dea_instrument *instrument;
  struct emulator_sink sink;
} b;

/* The fake's state from its beginning, and a protocol of 1 kHz with two inputs. */
static void bench_begin(void)
{
  memset(&b, 0, sizeof b);
  void *handle =
      dlopen("libnidaqmx.so.1", RTLD_NOW | RTLD_LOCAL); // the one that the instrument gets
  assert_non_null(handle);
  fake_daq_get get;
  void *symbol = dlsym(handle, "fake_daq");
  assert_non_null(symbol);
  memcpy(&get, &symbol, sizeof get);
  b.fake = get();
  memset(b.fake, 0, sizeof *b.fake);
  b.fake->level_V = 3; // of whoever was here before
  b.sink.channels = 2;
  b.protocol.rate_Hz.si = 1000;
  b.protocol.amplifier.control_V.si = 10;
  strcpy(b.protocol.amplifier.terminal.text, "ao1");
  b.protocol.inputs = b.inputs;
  b.protocol.input_count = 2;
  strcpy(b.inputs[0].terminal.text, "ai0");
  strcpy(b.inputs[1].terminal.text, "ai5");
  b.inputs[0].range_V.si = 10;
  b.inputs[1].range_V.si = 5;
}

/* Plays a ramp of `count` samples in parts and compares what the inputs saw of it. */
static void play(size_t count)
{
  const struct dea_instrument_type *type = b.instrument->type;
  double volts[50];
  for (size_t i = 0; i < count; i += 50) {
    for (size_t k = 0; k < 50; k++) {
      volts[k] = 1e-3 * (double)(i + k) - 0.5;
    }
    assert_int_equal(type->put(ctx, b.instrument, volts, 50), DEA_OK);
    if (i == 100) {
      assert_int_equal(type->start(ctx, b.instrument), DEA_OK);
    }
    assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 0, 0, i >= 100 ? i : 0), DEA_OK);
  }
  assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 0, 0, count), DEA_OK);
  assert_int_equal(b.sink.samples, count);
  for (size_t i = 0; i < count; i++) {
    double wanted = 1e-3 * (double)i - 0.5;
    assert_close(b.fake->played[i], wanted, 0, 1e-15);
    assert_close(b.sink.volts[2 * i], wanted, 0, 2e-15);
    assert_close(b.sink.volts[2 * i + 1], 2 * wanted, 0, 3e-15);
  }
}

/* Beyond what amplifier and specimen may see nothing goes out, whatever is asked. */
static void check_cap(void)
{
  static const double beyond[][3] = {
      {0, 10.01, 0}, {0, 0, -10.01}, {NAN, 0, 0}, {0, INFINITY, 0}, {0, 6.01, 0}};
  size_t written = b.fake->written;
  for (size_t i = 0; i < sizeof beyond / sizeof beyond[0]; i++) {
    if (i == 4) {
      b.protocol.specimen.highest_V = (struct dea_quantity){6e3, DEA_GIVEN, {"", 0, 0}};
    }
    assert_int_equal(b.instrument->type->put(ctx, b.instrument, beyond[i], 3), DEA_E_INTERLOCK);
    assert_non_null(strstr(dea_context_message(ctx), "was about to go out"));
  }
  assert_int_equal(b.fake->written, written);
}

static void bench_end(void)
{
  if (b.instrument != NULL) {
    emulator_close(ctx, b.instrument);
  }
  free(b.sink.volts);
  assert_int_equal(b.fake->tasks, 0); // everything was given back
}

static dea_status begin(void)
{
  dea_finding_clear(ctx);
  return emulator_open(ctx, &b.protocol, "kind: nidaqmx\ndevice: Dev2\nwiring: differential\n",
                       &b.instrument);
}

TEST(test_plays_and_measures)
{
  bench_begin();
  assert_int_equal(begin(), DEA_OK);
  assert_int_equal(b.instrument->roles, DEA_PLAYS_OUTPUT | DEA_READS_INPUTS);
  assert_close(b.fake->level_V, 0, 0, 0); // once it is open
  // Output: at once 0 V, then on the clock and without repetition; inputs on its trigger.
  assert_string_equal(b.fake->log, "CreateTask()\nAO(Dev2/ao1 -10 10 10348)\nWriteNow(1 0 1)\n"
                                   "StopTask(output)\nClearTask()\n"
                                   "CreateTask()\nAO(Dev2/ao1 -10 10 10348)\n"
                                   "CfgSampClkTiming(1000 10280 10123)\nSetWriteRegenMode(10158)\n"
                                   "CfgOutputBuffer(250)\n"
                                   "CreateTask()\nAI(Dev2/ai0 10106 -10 10 10348)\n"
                                   "AI(Dev2/ai5 10106 -5 5 10348)\n"
                                   "CfgSampClkTiming(1000 10280 10123)\n"
                                   "CfgDigEdgeStartTrig(/Dev2/ao/StartTrigger 10280)\n");
  b.fake->log[0] = '\0';
  play(1000);
  const char *inputs = strstr(b.fake->log, "StartTask(inputs)");
  assert_non_null(inputs); // armed before the output starts
  assert_non_null(strstr(inputs, "StartTask(output)"));
  assert_true(b.fake->level_V > 0.4);
  b.instrument->type->stop(ctx, b.instrument);
  assert_close(b.fake->level_V, 0, 0, 0);
  assert_int_equal(b.fake->tasks, 0);
  b.instrument->type->close(ctx, b.instrument);
  b.instrument = NULL;
  bench_end();
}

TEST(test_starts_with_first_sample)
{
  static const double volts[300] = {1};
  bench_begin();
  assert_int_equal(begin(), DEA_OK);
  assert_int_equal(b.instrument->type->start(ctx, b.instrument), DEA_OK);
  assert_int_equal(b.fake->running, 0);
  assert_int_equal(b.instrument->type->put(ctx, b.instrument, volts, 300), DEA_OK);
  assert_int_equal(b.fake->running, 1);
  assert_int_equal(b.fake->written, 300);
  check_cap();
  bench_end();
  bench_begin(); // and without start the queue is not endless
  assert_int_equal(begin(), DEA_OK);
  assert_message(b.instrument->type->put(ctx, b.instrument, volts, 300), DEA_E_ARGUMENT,
                 "more than 250 samples before the start");
  bench_end();
}

TEST(test_runs_dry)
{
  double volts[100] = {0};
  bench_begin();
  assert_int_equal(begin(), DEA_OK);
  b.fake->dry_after = 100;
  assert_int_equal(b.instrument->type->start(ctx, b.instrument), DEA_OK);
  assert_int_equal(b.instrument->type->put(ctx, b.instrument, volts, 100), DEA_OK);
  // The end of a sequence: all inputs still come.
  assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 0, 0, 100), DEA_OK);
  assert_int_equal(b.sink.samples, 100);
  const struct dea_sink to = {&b.sink, emulator_samples, NULL, NULL};
  assert_int_equal(b.instrument->type->get(ctx, b.instrument, 0, &to), DEA_OK);
  // But one that was to go on has a gap.
  assert_message(b.instrument->type->put(ctx, b.instrument, volts, 1), DEA_E_INSTRUMENT,
                 "the computer was too slow");
  bench_end();
  assert_close(b.fake->level_V, 0, 0, 0);
}

TEST(test_errors)
{
  static const struct {
    const char *function, *message;
    int code;
  } cases[] = {
      {"CreateTask", "cannot make its output (NI-DAQmx -200088)", -200088},
      {"AO", "Dev2 cannot play on that output (NI-DAQmx -200220): The fake says no. Task: AO",
       -200220},
      {"AI", "cannot measure on that input", -200220},
      {"WriteNow", "cannot put 0 V out", -200559},
      {"CfgSampClkTiming", "cannot take that rate", -200077},
      {"SetWriteRegenMode", "cannot play without repetition", -1},
      {"CfgOutputBuffer", "cannot take a queue of that length", -1},
      {"CfgDigEdgeStartTrig", "cannot start its inputs with its output", -1},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    bench_begin();
    strcpy(b.fake->fails, cases[i].function);
    b.fake->code = cases[i].code;
    bool unknown = strcmp(cases[i].function, "WriteNow") == 0;
    assert_message(begin(), unknown ? DEA_E_INTERLOCK : DEA_E_INSTRUMENT, cases[i].message);
    assert_true(!unknown ||
                strstr(dea_context_message(ctx), "not known to be at 0 V: switch it off") != NULL);
    bench_end();
  }
  static const char *const later[] = {"StartTask", "Write", "Avail", "Read"};
  for (size_t i = 0; i < 4; i++) {
    static const double volts[50] = {1};
    const struct dea_sink to = {&b.sink, emulator_samples, NULL, NULL};
    bench_begin();
    assert_int_equal(begin(), DEA_OK);
    strcpy(b.fake->fails, later[i]);
    b.fake->code = -201003; // the device is gone
    dea_status status = b.instrument->type->put(ctx, b.instrument, volts, 50);
    status = status == DEA_OK ? b.instrument->type->start(ctx, b.instrument) : status;
    status = status == DEA_OK ? b.instrument->type->get(ctx, b.instrument, 0.01, &to) : status;
    assert_message(status, DEA_E_INSTRUMENT, "NI-DAQmx -201003");
    bench_end();
    assert_close(b.fake->level_V, 0, 0, 0); // stopped at 0 V all the same
  }
}

TEST(test_rate)
{
  bench_begin();
  b.fake->rate_factor = 1.0001;
  assert_message(begin(), DEA_E_INSTRUMENT, "Dev2 has no rate of 1000 Hz; write 'rate: 1000.1 Hz'");
  bench_end();
}

static void open_and_close(struct dea_context *context)
{
  dea_status status = emulator_open(context, &b.protocol, "kind: nidaqmx\n", &b.instrument);
  failing_check(context, status);
  if (status == DEA_OK) {
    emulator_close(context, b.instrument);
  }
  assert_int_equal(b.fake->tasks, 0);
}

TEST(test_memory)
{
  bench_begin();
  assert_true(failing_each(open_and_close) > 3);
}

TESTS(context_set_up, context_tear_down)
