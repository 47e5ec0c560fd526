// DAQs of National Instruments, with a fake library in place of NI-DAQmx.
#include "daq_bench.h"
#include "failing_allocator.h"

#include "message_fixture.h"

static const char library[] = DEA_FAKE_FOLDER "/fake_nidaqmx.so";

static dea_status begin(struct daq_bench *b)
{
  dea_finding_clear(ctx);
  snprintf(b->text, sizeof b->text,
           "kind: nidaqmx\ndevice: Dev2\nwiring: differential\nlibrary: %s\n", library);
  return emulator_open(ctx, &b->protocol, b->text, &b->instrument);
}

TEST(test_plays_and_measures)
{
  static struct daq_bench b;
  daq_bench_begin(&b, library);
  assert_int_equal(begin(&b), DEA_OK);
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
  daq_bench_play(ctx, &b, 1000, 1e-15);
  const char *inputs = strstr(b.fake->log, "StartTask(inputs)");
  assert_non_null(inputs); // armed before the output starts
  assert_non_null(strstr(inputs, "StartTask(output)"));
  assert_true(b.fake->level_V > 0.4);
  b.instrument->type->stop(ctx, b.instrument);
  assert_close(b.fake->level_V, 0, 0, 0);
  assert_int_equal(b.fake->tasks, 0);
  b.instrument->type->close(ctx, b.instrument);
  b.instrument = NULL;
  daq_bench_end(ctx, &b);
}

TEST(test_starts_with_first_sample)
{
  static struct daq_bench b;
  static const double volts[300] = {1};
  daq_bench_begin(&b, library);
  assert_int_equal(begin(&b), DEA_OK);
  assert_int_equal(b.instrument->type->start(ctx, b.instrument), DEA_OK);
  assert_int_equal(b.fake->running, 0);
  assert_int_equal(b.instrument->type->put(ctx, b.instrument, volts, 300), DEA_OK);
  assert_int_equal(b.fake->running, 1);
  assert_int_equal(b.fake->written, 300);
  daq_bench_check_cap(ctx, &b);
  daq_bench_end(ctx, &b);
  daq_bench_begin(&b, library); // and without start the queue is not endless
  assert_int_equal(begin(&b), DEA_OK);
  assert_message(b.instrument->type->put(ctx, b.instrument, volts, 300), DEA_E_ARGUMENT,
                 "more than 250 samples before the start");
  daq_bench_end(ctx, &b);
}

TEST(test_runs_dry)
{
  static struct daq_bench b;
  double volts[100] = {0};
  daq_bench_begin(&b, library);
  assert_int_equal(begin(&b), DEA_OK);
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
  daq_bench_end(ctx, &b);
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
  static struct daq_bench b;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    daq_bench_begin(&b, library);
    strcpy(b.fake->fails, cases[i].function);
    b.fake->code = cases[i].code;
    bool unknown = strcmp(cases[i].function, "WriteNow") == 0;
    assert_message(begin(&b), unknown ? DEA_E_INTERLOCK : DEA_E_INSTRUMENT, cases[i].message);
    assert_true(!unknown ||
                strstr(dea_context_message(ctx), "not known to be at 0 V: switch it off") != NULL);
    daq_bench_end(ctx, &b);
  }
  static const char *const later[] = {"StartTask", "Write", "Avail", "Read"};
  for (size_t i = 0; i < 4; i++) {
    static const double volts[50] = {1};
    const struct dea_sink to = {&b.sink, emulator_samples, NULL, NULL};
    daq_bench_begin(&b, library);
    assert_int_equal(begin(&b), DEA_OK);
    strcpy(b.fake->fails, later[i]);
    b.fake->code = -201003; // the device is gone
    dea_status status = b.instrument->type->put(ctx, b.instrument, volts, 50);
    status = status == DEA_OK ? b.instrument->type->start(ctx, b.instrument) : status;
    status = status == DEA_OK ? b.instrument->type->get(ctx, b.instrument, 0.01, &to) : status;
    assert_message(status, DEA_E_INSTRUMENT, "NI-DAQmx -201003");
    daq_bench_end(ctx, &b);
    assert_close(b.fake->level_V, 0, 0, 0); // stopped at 0 V all the same
  }
}

TEST(test_rate)
{
  static struct daq_bench b;
  daq_bench_begin(&b, library);
  b.fake->rate_factor = 1.0001;
  assert_message(begin(&b), DEA_E_INSTRUMENT,
                 "Dev2 has no rate of 1000 Hz; write 'rate: 1000.1 Hz'");
  daq_bench_end(ctx, &b);
}

TEST(test_no_library)
{
  struct dea_protocol protocol = {.rate_Hz.si = 1000};
  struct dea_instrument *instrument;
  daq_bench_allow();
  assert_message(
      emulator_open(ctx, &protocol, "kind: nidaqmx\nlibrary: no_such_library.so\n", &instrument),
      DEA_E_UNSUPPORTED, "NI-DAQmx is not on this computer");
  assert_non_null(strstr(dea_context_message(ctx), "dea drive --export"));
  char text[1024]; // a library that is another one
  snprintf(text, sizeof text, "kind: nidaqmx\nlibrary: %s/fake_comedi.so\n", DEA_FAKE_FOLDER);
  assert_message(emulator_open(ctx, &protocol, text, &instrument), DEA_E_UNSUPPORTED,
                 "NI-DAQmx has no function DAQmxCreateTask");
}

TEST(test_memory)
{
  daq_bench_check_memory("nidaqmx", library);
}

TESTS(context_set_up, context_tear_down)
