/* lab/drive/drive: what is played and recorded is the protocol; whatever fails, the output
 * comes down to 0 V within the ramp, every instrument is stopped once, and the recording is
 * readable. */
// ctest: slow, heavy
#include "drive_trial.h"

#include <stdatomic.h>
#include <sys/resource.h>
#include <sys/syscall.h>

/* A clock on which more time passes with every look at it. */
static atomic_long hurries_ns, hurried_ns;

int clock_gettime(clockid_t clock, struct timespec *out)
{
  long result = syscall(SYS_clock_gettime, clock, out);
  long long ns = out->tv_nsec + (atomic_fetch_add(&hurried_ns, atomic_load(&hurries_ns)));
  out->tv_sec += (time_t)(ns / 1000000000);
  out->tv_nsec = (long)(ns % 1000000000);
  return (int)result;
}

// What is played ---------------------------------------------------------------------------------

TEST(test_plays_and_records_the_protocol)
{
  struct trial t;
  trial_open(&t, SQUARE CHANNELS, &fake_good);
  trial_play(&t, true);
  assert_int_equal(t.status, DEA_OK);
  assert_int_equal(t.daq->put, LENGTH + 1 + TAIL);
  assert_int_equal(check_ramp(t.daq), LENGTH + 1);
  assert_true(t.report.zero.state == DEA_ZERO_READ_BACK && t.report.lost == 0 &&
              t.report.cycles == CYCLES);
  assert_close(t.report.played_s, 1.2, 0, 1e-12);
  assert_close(t.report.largest_current_A, 2e-5, 1e-12, 0);
  trial_read(&t);
  check_channels(&t);
  const struct dea_recording *r = t.recording;
  assert_int_equal(r->channel_count, 5);
  for (size_t c = 0; c < 4; c++) {
    assert_int_equal(r->channels[c].count, LENGTH + 1);
  }
  assert_string_equal(r->channels[0].name, "command");
  assert_int_equal(r->channels[3].kind, DEA_CHANNEL_DISPLACEMENT);
  assert_string_equal(r->channels[4].unit, "K");
  assert_int_equal(r->profiles.count, 61);
  assert_int_equal(r->channels[4].count, 61);
  assert_true(r->profiles.z_m[3 * 50] == 50 * fake_frame_s && isnan(r->profiles.z_m[3 * 50 + 1]));
  assert_non_null(strstr(r->protocol, "frequency: 10 Hz"));
  assert_non_null(strstr(r->provenance, "fake sensor"));
  check_cycles(&t, LENGTH);
  trial_close(&t);
}

TEST(test_instruments_of_any_pace)
{
  static const size_t paces[] = {1, 7, 64, 5000};
  for (size_t k = 0; k < 4; k++) {
    struct trial t;
    struct fake_script script = fake_good;
    script.at_a_time = paces[k];
    script.idle = k == 1 ? 5 : 1;
    trial_open(&t, SQUARE CHANNELS, &script);
    trial_play(&t, k % 2 == 0);
    assert_int_equal(t.status, DEA_OK);
    assert_int_equal(check_ramp(t.daq), LENGTH + 1);
    assert_int_equal(t.report.cycles, CYCLES);
    trial_close(&t);
  }
}

TEST(test_without_channels_the_clock_paces)
{
  struct trial t;
  struct fake_script script = fake_good;
  script.inputs = false;
  trial_open(&t, SQUARE, &script);
  trial_play(&t, false);
  assert_int_equal(t.status, DEA_OK);
  assert_int_equal(check_ramp(t.daq), LENGTH + 1);
  trial_read(&t);
  assert_int_equal(t.recording->channels[0].count, LENGTH + 1);
  assert_int_equal(t.recording->cycle_count, CYCLES);
  trial_close(&t);
}

/* A DAQ without channels that takes its time to start plays to its end before it is stopped. */
TEST(test_slow_start_without_channels)
{
  struct trial t;
  struct fake_script script = fake_good;
  script.inputs = false;
  script.start_s = 0.5;
  trial_open(&t, SQUARE, &script);
  trial_play(&t, false);
  assert_int_equal(t.status, DEA_OK);
  assert_true(t.daq->stopped_s - t.daq->begun_s >= (double)LENGTH / RATE);
  trial_close(&t);
}

/* The clock of a sensor begins with that of a DAQ, however long that takes to start. */
TEST(test_slow_start_and_a_sensor)
{
  struct trial t;
  struct fake_script script = fake_good;
  script.start_s = 0.2;
  trial_open(&t, SQUARE CHANNELS, &script);
  trial_play(&t, true);
  assert_int_equal(t.status, DEA_OK);
  assert_true(t.sensor.common.start_s >= t.daq->begun_s);
  trial_close(&t);
}

// What fails -------------------------------------------------------------------------------------

/* Plays with a fault and checks what must hold in all of them but those of the DAQ itself. */
static void expect_ramp(const struct fake_script *script, bool sensor, long fail_frame,
                        dea_status wanted, const char *reason)
{
  struct trial t;
  trial_open(&t, SQUARE CHANNELS, script);
  t.sensor.fail_frame = fail_frame;
  t.stall_s = 0.3;
  trial_play(&t, sensor);
  if (t.status != wanted || strstr(t.report.ended, reason) == NULL) {
    fail_msg("%s: %s", dea_status_name(t.status), t.report.ended);
  }
  // what the voltage channel does not show is not known
  bool shown = script->voltage_from < 0 && script->missing_to < LENGTH;
  assert_int_equal(t.report.zero.state, shown ? DEA_ZERO_READ_BACK : DEA_ZERO_UNKNOWN);
  size_t played = check_ramp(t.daq);
  assert_true(played < LENGTH);
  trial_read(&t);
  check_channels(&t);
  assert_int_equal(t.recording->channels[0].count, t.daq->put - TAIL);
  size_t seen = fail_frame >= 0 ? (size_t)fail_frame * RATE / 50 : t.daq->got; // frames of 20 ms
  check_cycles(&t, played < seen ? played : seen);
  trial_close(&t);
}

TEST(test_signals)
{
  for (long put = 0; put < 22; put++) {
    struct fake_script script = fake_good;
    script.interrupt_put = put;
    script.at_a_time = 20 + (size_t)put;
    expect_ramp(&script, put % 2 == 0, -1, DEA_E_INTERRUPTED, "interrupted");
  }
}

/* Nothing is given to an output that has come to the end of the sequence and may have run dry. */
TEST(test_faults_at_the_end)
{
  for (int trips = 0; trips < 2; trips++) {
    struct trial t;
    struct fake_script script = fake_good;
    script.interrupt_put = trips ? -1 : (LENGTH + 1) / 50; // the last one
    script.current_from = trips ? LENGTH - 10 : -1;
    trial_open(&t, SQUARE CHANNELS, &script);
    trial_play(&t, false);
    assert_int_equal(t.status, trips ? DEA_E_INTERLOCK : DEA_OK);
    assert_int_equal(t.daq->put, LENGTH + 1 + TAIL);
    assert_true(t.report.zero.state == DEA_ZERO_READ_BACK && t.report.cycles == CYCLES);
    trial_read(&t);
    trial_close(&t);
  }
}

TEST(test_current_trips)
{
  for (long from = 0; from < 700; from += 61) {
    struct fake_script script = fake_good;
    script.current_from = from;
    expect_ramp(&script, from % 2 == 0, -1, DEA_E_INTERLOCK, "trip_current");
  }
}

/* What pulls the voltage down ends with it: a current that goes on at 0 V explains nothing. */
TEST(test_film_that_breaks_down)
{
  for (int goes_on = 0; goes_on < 2; goes_on++) {
    struct trial t;
    struct fake_script script = fake_good;
    script.broken_from = 548; // at 2 kV for 48 ms
    script.current_from = goes_on ? script.broken_from : -1;
    trial_open(&t, SQUARE CHANNELS, &script);
    t.protocol->safety.zero_time_s.si = 0.3;
    trial_play(&t, false);
    assert_int_equal(t.status, DEA_E_INTERLOCK);
    assert_non_null(strstr(t.report.ended, "trip_current"));
    assert_int_equal(t.report.zero.state, goes_on ? DEA_ZERO_UNKNOWN : DEA_ZERO_READ_BACK);
    if (goes_on) {
      assert_string_equal(t.report.zero.why, "more than safety.trip_current still flows");
    }
    trial_close(&t);
  }
}

TEST(test_wrong_voltage_trips)
{
  for (long from = 0; from < 700; from += 53) {
    struct fake_script script = fake_good;
    script.voltage_from = from;
    expect_ramp(&script, false, -1, DEA_E_INTERLOCK, "voltage_error");
  }
}

TEST(test_lost_samples_do_not_end_it_but_silence_does)
{
  struct trial t;
  struct fake_script script = fake_good;
  script.missing_from = 130;
  script.missing_to = 500;
  trial_open(&t, SQUARE CHANNELS, &script);
  trial_play(&t, true);
  assert_int_equal(t.status, DEA_OK);
  trial_read(&t);
  check_channels(&t); // NAN where they were lost
  trial_close(&t);
  script.missing_to = 5000;
  expect_ramp(&script, true, -1, DEA_E_INTERLOCK, "has given no value");
}

TEST(test_lost_sensor)
{
  for (long frame = 0; frame < 36; frame += 7) {
    expect_ramp(&fake_good, true, frame, DEA_E_INSTRUMENT, "the fake sensor has failed");
  }
}

TEST(test_inputs_ahead_of_the_output)
{
  struct fake_script script = fake_good;
  struct trial t;
  script.ahead_put = 9;
  script.at_a_time = 60;
  trial_open(&t, SQUARE CHANNELS, &script);
  trial_play(&t, false);
  assert_int_equal(t.status, DEA_E_INSTRUMENT);
  assert_non_null(strstr(t.report.ended, "ran dry"));
  check_ramp(t.daq);
  trial_close(&t);
}

/* The playing instrument itself fails: nothing can be put any more, it is stopped at once. */
TEST(test_failed_daq_is_stopped)
{
  for (long k = 0; k < 15; k++) {
    for (int put = 0; put < 2; put++) {
      struct trial t;
      struct fake_script script = fake_good;
      *(put ? &script.fail_put : &script.fail_get) = k;
      trial_open(&t, SQUARE CHANNELS, &script);
      trial_play(&t, true);
      assert_int_equal(t.status, DEA_E_INSTRUMENT);
      assert_non_null(strstr(t.report.ended, put ? "put has failed" : "get has failed"));
      assert_true(t.report.zero.state != DEA_ZERO_READ_BACK);
      trial_read(&t);
      check_channels(&t);
      trial_close(&t);
    }
  }
  struct trial t;
  struct fake_script script = fake_good;
  script.silent_from = 333;
  trial_open(&t, SQUARE CHANNELS, &script);
  t.stall_s = 0.2;
  trial_play(&t, false);
  assert_int_equal(t.status, DEA_E_INSTRUMENT);
  assert_non_null(strstr(t.report.ended, "no sample has come for 0.2 s"));
  trial_read(&t);
  assert_int_equal(t.recording->cycle_count, 3);
  trial_close(&t);
}

TEST(test_failed_start)
{
  for (int of_sensor = 0; of_sensor < 2; of_sensor++) {
    struct trial t;
    struct fake_script script = fake_good;
    script.fail_start = of_sensor ? -1 : 0;
    trial_open(&t, SQUARE CHANNELS, &script);
    t.sensor.fail_start = of_sensor ? 0 : -1;
    trial_play(&t, true);
    assert_int_equal(t.status, DEA_E_INSTRUMENT);
    assert_int_equal(t.daq->put, 0);
    assert_true(t.report.zero.state == DEA_ZERO_COMMANDED);
    trial_read(&t);
    trial_close(&t);
  }
}

/* Inputs of one instrument, output of another: without the inputs the ramp goes on. */
TEST(test_reader_apart_from_the_player)
{
  for (long fail = -1; fail < 30; fail += 10) {
    struct trial t;
    struct fake_script script = fake_good;
    struct fake_daq *player = malloc(sizeof *player);
    assert_non_null(player);
    trial_open(&t, SQUARE CHANNELS, &script);
    script.inputs = false;
    fake_daq_open(t.protocol, &script, &t.flag, player);
    t.daq->common.roles = DEA_READS_INPUTS;
    t.daq->script.fail_get = fail;
    t.daq->script.at_a_time = 40;
    t.daq->script.ahead_put = 0;
    t.daq->puts = 1; // of nothing: it reads on its own clock
    t.daq->player = player;
    struct dea_instrument *all[2] = {&player->common, &t.daq->common};
    struct dea_drive_bench bench = {all, 2, 0.005, 3, NULL, NULL, 0};
    unlink(in_folder("drive.h5"));
    t.protocol->safety.voltage_error_V.si = 1e5;
    t.status = dea_drive_play(ctx, t.protocol, &bench, in_folder("drive.h5"), &t.report);
    // its clock is ahead when the output is given 50 samples for its 40: not before the end
    assert_int_equal(t.status, fail < 0 ? DEA_OK : DEA_E_INSTRUMENT);
    assert_int_equal(t.report.zero.state, fail < 0 ? DEA_ZERO_READ_BACK : DEA_ZERO_UNKNOWN);
    check_ramp(player);
    assert_int_equal(player->stops, 1);
    assert_int_equal(t.daq->stops, 1);
    trial_read(&t);
    trial_close(&t);
    free(player);
  }
}

TEST(test_full_disk_ramps_down)
{
  struct rlimit before, small;
  struct trial t;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  trial_open(&t, SQUARE CHANNELS, &fake_good);
  small = before;
  small.rlim_cur = 50000;
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
  trial_play(&t, true);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
  assert_int_equal(t.status, DEA_E_IO);
  assert_true(t.report.zero.state == DEA_ZERO_READ_BACK && t.daq->put > 0);
  check_ramp(t.daq);
  trial_close(&t);
  signal(SIGXFSZ, handler);
}

static void fill_the_disk(void)
{
  struct rlimit small;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &small), 0);
  small.rlim_cur = 1;
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
}

/* The disk is full when the ramp begins: it goes on to 0 V, and what came first is told first. */
TEST(test_disk_that_fills_in_the_ramp)
{
  struct rlimit before;
  struct fake_script script = fake_good;
  struct trial t;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  script.interrupt_put = 8;
  script.after_interrupt = fill_the_disk;
  trial_open(&t, SQUARE CHANNELS, &script);
  trial_play(&t, true);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
  assert_int_equal(t.status, DEA_E_INTERRUPTED);
  assert_true(t.report.zero.state == DEA_ZERO_READ_BACK);
  assert_string_equal(t.report.ended, "interrupted");
  assert_non_null(find_finding(ctx, DEA_WARNING, "cannot write"));
  assert_true(check_ramp(t.daq) < LENGTH);
  trial_close(&t);
  signal(SIGXFSZ, handler);
}

static struct trial *memory_trial;

static void play_without_memory(struct dea_context *context)
{
  struct trial *t = memory_trial;
  struct dea_instrument *all[2] = {&t->daq->common, &t->sensor.common};
  struct dea_drive_bench bench = {all, 2, 0.005, 3, NULL, NULL, 0};
  fake_daq_open(t->protocol, &fake_good, &t->flag, t->daq);
  fake_sensor_open(t->daq, &t->sensor);
  unlink(in_folder("memory.h5"));
  t->status = dea_drive_play(context, t->protocol, &bench, in_folder("memory.h5"), &t->report);
  failing_check(context, t->status);
  assert_true(t->daq->stops == 1 && t->sensor.stops == 1);
  check_ramp(t->daq);
}

TEST(test_out_of_memory)
{
  struct trial t;
  trial_open(&t, SQUARE CHANNELS, &fake_good);
  memory_trial = &t;
  assert_true(failing_each(play_without_memory) > 3); // the recorder has a context of its own
  trial_close(&t);
}

TEST(test_frames_without_time_are_counted)
{
  struct trial t;
  trial_open(&t, SQUARE CHANNELS, &fake_good);
  t.sensor.wrong_frame = 8;
  trial_play(&t, true);
  assert_int_equal(t.status, DEA_OK);
  assert_int_equal(t.report.lost, 1);
  trial_close(&t);
}

/* What is noticed while it plays stands in the recording, and in its copy; a leakage current that
 * rises ends it, ten times below trip_current. */
TEST(test_leak_that_rises)
{
  static const char text[] =
      "dea-protocol: 1\n" PROTOCOL_AMPLIFIER
      "safety: {ramp: 20 kV/s, trip_current: 2 mA, voltage_error: 300 V, leak_time: 0.5 s}\n"
      "rate: 1 kHz\n"
      "waveform: {kind: square, high: 2 kV, frequency: 10 Hz, cycles: 150}\n" CHANNELS;
  struct fake_script script = fake_good;
  struct trial t;
  script.leak_from = 11000;
  trial_open(&t, text, &script);
  trial_play(&t, true);
  assert_int_equal(t.status, DEA_E_INTERLOCK);
  assert_non_null(strstr(t.report.ended, "the leakage current has risen to 200 uA, above 40 uA"));
  if (!(t.report.played_s > 11.5 && t.report.played_s < 13)) {
    fail_msg("%g s: %s", t.report.played_s, t.report.ended);
  }
  assert_non_null(find_finding(ctx, DEA_NOTE, "'current' has a base line: up to 20 uA"));
  assert_non_null(find_finding(ctx, DEA_WARNING, "'current' has risen to 200 uA, above 40 uA"));
  trial_read(&t);
  for (int k = 0; k < 2; k++) { // and its copy
    const struct dea_recording *r = t.recording;
    assert_int_equal(r->event_count, 2);
    assert_true(r->events[0].kind == DEA_NOTICED_LEARNED && r->events[0].time_s < 11);
    assert_true(r->events[1].kind == DEA_NOTICED_LEAK_ROSE && r->events[1].time_s > 11);
    assert_close(r->events[1].value, 2e-4, 1e-12, 0);
    assert_close(r->events[1].limit, 4e-5, 1e-12, 0);
    assert_string_equal(r->channels[r->events[1].channel].name, "current");
    struct dea_recording *copy;
    unlink(in_folder("copy.h5"));
    assert_int_equal(dea_recording_write(ctx, r, in_folder("copy.h5")), DEA_OK);
    assert_int_equal(dea_recording_read(ctx, in_folder("copy.h5"), &copy), DEA_OK);
    dea_recording_destroy(ctx, t.recording);
    t.recording = copy;
  }
  trial_close(&t);
}

/* A current that an instrument reads has no value any more: said after 10 s, the ramp after 60 s.
 */
TEST(test_reading_without_values)
{
  static const double values[] = {NAN, 1e-6};
  for (int k = 0; k < 2; k++) {
    struct trial t;
    trial_open(&t, SQUARE CHANNELS, &fake_good);
    t.sensor.common.readings[0].kind = DEA_CHANNEL_CURRENT;
    t.sensor.common.readings[0].unit[0] = '\0';
    t.sensor.value = values[k];
    t.stall_s = 1e9;
    atomic_store(&hurries_ns, 100000000);
    trial_play(&t, true);
    atomic_store(&hurries_ns, 0);
    trial_read(&t);
    if (k == 0) {
      assert_int_equal(t.status, DEA_E_INTERLOCK);
      assert_non_null(strstr(t.report.ended, "reading 'temperature' has given no value for 60 s"));
      assert_true(t.recording->event_count == 1);
      assert_true(t.recording->events[0].kind == DEA_NOTICED_SILENT);
      assert_true(t.recording->events[0].value >= 10 && t.recording->events[0].value < 20);
      check_ramp(t.daq);
    } else {
      assert_true(t.status == DEA_OK && t.recording->event_count == 0);
    }
    trial_close(&t);
  }
}

TEST(test_benches_that_cannot_play)
{
  struct trial t;
  struct fake_daq *second = malloc(sizeof *second);
  assert_non_null(second);
  trial_open(&t, SQUARE CHANNELS, &fake_good);
  fake_daq_open(t.protocol, &fake_good, &t.flag, second);
  struct dea_instrument *all[2] = {&t.daq->common, &second->common};
  struct dea_drive_bench bench = {all, 2, 0.005, 3, NULL, NULL, 0};
  static const struct {
    unsigned first, second;
    const char *why;
  } cases[] = {{DEA_PLAYS_OUTPUT, DEA_PLAYS_OUTPUT, "two of them play"},
               {DEA_READS_INPUTS, DEA_SENDS_PROFILES, "none of them plays"},
               {DEA_PLAYS_OUTPUT, DEA_SENDS_PROFILES, "none of them reads"},
               {DEA_PLAYS_OUTPUT | DEA_READS_INPUTS, DEA_READS_INPUTS, "two of them read"},
               {DEA_PLAYS_OUTPUT | DEA_SENDS_PROFILES, DEA_SENDS_PROFILES, "two of them send"}};
  for (size_t k = 0; k < 5; k++) {
    t.daq->common.roles = cases[k].first;
    second->common.roles = cases[k].second;
    t.daq->stops = second->stops = 0;
    t.status = dea_drive_play(ctx, t.protocol, &bench, in_folder("none.h5"), &t.report);
    assert_int_equal(t.status, DEA_E_INSTRUMENT);
    assert_non_null(strstr(dea_context_message(ctx), cases[k].why));
    assert_true(t.daq->stops == 1 && second->stops == 1 && t.daq->starts == 0);
    assert_false(there("none.h5"));
  }
  trial_close(&t);
  free(second);
}

TESTS(set_up, protocol_tear_down)
