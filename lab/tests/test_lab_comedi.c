// DAQs by comedi, with a fake library and board in place of it.
#include "daq_bench.h"
#include "failing_allocator.h"

#include "message_fixture.h"

#include <errno.h>
#include <signal.h>

static const char library[] = DEA_FAKE_FOLDER "/fake_comedi.so";
static const double step_V = 20.0 / 65535; // of 16 bits

static dea_status begin(struct daq_bench *b)
{
  dea_finding_clear(ctx);
  snprintf(b->text, sizeof b->text, "kind: comedi\ndevice: /dev/fake7\nlibrary: %s\n", library);
  return emulator_open(ctx, &b->protocol, b->text, &b->instrument);
}

TEST(test_plays_and_measures)
{
  static struct daq_bench b;
  daq_bench_begin(&b, library);
  assert_int_equal(begin(&b), DEA_OK);
  assert_int_equal(b.instrument->roles, DEA_PLAYS_OUTPUT | DEA_READS_INPUTS);
  assert_close(b.fake->level_V, 0, 0, step_V); // once it is open
  const char *armed = "command(output start 128 stop 1 period 1000000 ns channels 1: 1)\n";
  assert_non_null(strstr(b.fake->log, "data_write(1 1 32768)\n"));
  assert_non_null(strstr(b.fake->log, armed));
  b.fake->log[0] = '\0';
  daq_bench_play(ctx, &b, 1000, 0.51 * step_V);
  const char *inputs =
      strstr(b.fake->log, "command(inputs start 128 stop 1 period 1000000 ns channels 2: 2000000)\n"
                          "trigger(inputs)\ntrigger(output)\n");
  assert_non_null(inputs);
  assert_int_equal(dea_finding_count(ctx, DEA_NOTE), 1); // how much later the output started
  assert_true(b.fake->level_V > 0.4);
  b.fake->log[0] = '\0';
  b.instrument->type->stop(ctx, b.instrument);
  assert_close(b.fake->level_V, 0, 0, step_V);
  assert_string_equal(b.fake->log, "cancel(output)\ndata_write(1 1 32768)\ncancel(inputs)\n");
  b.instrument->type->close(ctx, b.instrument);
  b.instrument = NULL;
  daq_bench_end(ctx, &b);
}

TEST(test_starts_with_first_sample)
{
  static struct daq_bench b;
  static const double volts[300] = {1, -10, 10};
  daq_bench_begin(&b, library);
  assert_int_equal(begin(&b), DEA_OK);
  assert_int_equal(b.instrument->type->start(ctx, b.instrument), DEA_OK);
  assert_int_equal(b.fake->running, 0);
  assert_int_equal(b.instrument->type->put(ctx, b.instrument, volts, 300), DEA_OK);
  assert_int_equal(b.fake->running, 1);
  assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 0, 0, 300), DEA_OK);
  assert_close(b.fake->played[1], -10, 0, step_V);
  assert_close(b.fake->played[2], 10, 0, step_V);
  daq_bench_check_cap(ctx, &b);
  daq_bench_end(ctx, &b);
}

/* By its calibration a board has no number for the ends of its range: what is nearest is played. */
TEST(test_calibration_beyond_the_numbers)
{
  static const double volts[300] = {1, -10, 10};
  for (double offset = -3; offset <= 3; offset += 6) {
    static struct daq_bench b;
    daq_bench_begin(&b, library);
    b.fake->offset = offset;
    assert_int_equal(begin(&b), DEA_OK);
    assert_int_equal(b.instrument->type->start(ctx, b.instrument), DEA_OK);
    assert_int_equal(b.instrument->type->put(ctx, b.instrument, volts, 300), DEA_OK);
    assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 0, 0, 300), DEA_OK);
    assert_close(b.fake->played[0], 1, 0, 4 * step_V);
    assert_close(b.fake->played[1], -10, 0, 4 * step_V);
    assert_close(b.fake->played[2], 10, 0, 4 * step_V);
    daq_bench_end(ctx, &b);
  }
}

/* A calibration that cannot be right is refused before anything is played by it. */
TEST(test_calibration_that_cannot_be)
{
  static const double offsets[] = {NAN, INFINITY, -20000, 20000};
  for (size_t i = 0; i < sizeof offsets / sizeof offsets[0]; i++) {
    static struct daq_bench b;
    daq_bench_begin(&b, library);
    b.fake->offset = offsets[i];
    assert_message(begin(&b), DEA_E_INSTRUMENT, "is off by more than a tenth of the range");
    assert_close(b.fake->level_V, 3, 0, 0); // as it was: nothing was played by it
    daq_bench_end(ctx, &b);
  }
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
  assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 0, 0, 100), DEA_OK);
  assert_int_equal(b.sink.samples, 100);
  signal(SIGPIPE, SIG_IGN); // the fake's file is a socket; a board's gives no signal
  assert_message(b.instrument->type->put(ctx, b.instrument, volts, 50), DEA_E_INSTRUMENT,
                 "the computer was too slow");
  daq_bench_end(ctx, &b);
  assert_close(b.fake->level_V, 0, 0, step_V);
}

TEST(test_errors)
{
  static const struct {
    const char *function, *message;
  } cases[] = {
      {"open", "/dev/fake7 cannot be opened; look at its driver"},
      {"find_subdevice", "it has no outputs"},
      {"data_write", "cannot put 0 V out: No such device"},
      {"get_cmd", "cannot play on a clock"},
      {"command_test", "cannot play at 1000 Hz (comedi_command_test: 3)"},
      {"command", "cannot play on a clock"},
  };
  static struct daq_bench b;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    daq_bench_begin(&b, library);
    strcpy(b.fake->fails, cases[i].function);
    b.fake->code = ENODEV;
    bool unknown = strcmp(cases[i].function, "data_write") == 0;
    assert_message(begin(&b), unknown ? DEA_E_INTERLOCK : DEA_E_INSTRUMENT, cases[i].message);
    assert_true(!unknown ||
                strstr(dea_context_message(ctx), "not known to be at 0 V: switch it off") != NULL);
    daq_bench_end(ctx, &b);
  }
  static const char *const later[] = {"trigger", "command", "unplug"};
  for (size_t i = 0; i < 3; i++) {
    static const double volts[50] = {1};
    const struct dea_sink to = {&b.sink, emulator_samples, NULL, NULL};
    daq_bench_begin(&b, library);
    assert_int_equal(begin(&b), DEA_OK);
    strcpy(b.fake->fails, later[i]);
    b.fake->code = ENODEV;
    dea_status status = b.instrument->type->put(ctx, b.instrument, volts, 50);
    status = status == DEA_OK ? b.instrument->type->start(ctx, b.instrument) : status;
    status = status == DEA_OK ? b.instrument->type->get(ctx, b.instrument, 0.01, &to) : status;
    assert_message(status, DEA_E_INSTRUMENT, "/dev/fake7");
    daq_bench_end(ctx, &b);
    assert_close(b.fake->level_V, 0, 0, step_V); // stopped at 0 V all the same
  }
}

TEST(test_what_it_has_not)
{
  static struct daq_bench b;
  daq_bench_begin(&b, library);
  b.fake->rate_factor = 1.0001;
  assert_message(begin(&b), DEA_E_INSTRUMENT, "has no rate of 1000 Hz; write 'rate: 1000.1");
  daq_bench_end(ctx, &b);
  daq_bench_begin(&b, library);
  strcpy(b.protocol.amplifier.terminal.text, "ao2");
  assert_message(begin(&b), DEA_E_INSTRUMENT, "/dev/fake7 has no ao2");
  daq_bench_end(ctx, &b);
  daq_bench_begin(&b, library);
  b.inputs[1].range_V.si = 20;
  assert_message(begin(&b), DEA_E_INSTRUMENT, "has no range of +-20 V for ai5");
  daq_bench_end(ctx, &b);
  daq_bench_begin(&b, library);
  strcpy(b.inputs[0].terminal.text, "Dev1/ai0");
  assert_int_equal(begin(&b), DEA_E_DESIGN);
  size_t count;
  assert_string_equal(dea_finding_get(ctx, &count)[0].text,
                      "comedi's inputs are called ai0, ai1, ..., not 'Dev1/ai0'");
  daq_bench_end(ctx, &b);
  daq_bench_begin(&b, library);
  b.fake->queue = 1; // wants a calibration, and there is none
  assert_int_equal(begin(&b), DEA_OK);
  assert_int_equal(dea_finding_count(ctx, DEA_WARNING), 1);
  daq_bench_end(ctx, &b);
  daq_bench_begin(&b, library);
  assert_message(
      emulator_open(ctx, &b.protocol, "kind: comedi\nlibrary: no_such_library.so\n", &b.instrument),
      DEA_E_UNSUPPORTED, "install the package libcomedi0");
  daq_bench_end(ctx, &b);
}

TEST(test_memory)
{
  daq_bench_check_memory("comedi", library);
}

TESTS(context_set_up, context_tear_down)
