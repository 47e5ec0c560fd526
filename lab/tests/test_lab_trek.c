/* A SCPI generator before a high-voltage amplifier (a Trek) whose voltage monitor, a divider, a DAQ
 * reads: all imitated. What is said of the output when the amplifier fails, or the monitor lies. */
// ctest: supply
#include "drive/drive_loop.h"
#include "fake_supply.h"
#include "protocol_text.h"

enum lie {
  HONEST,
  DEAD,           // its cable has come off: 0 V from the start
  STUCK,          // above 1 kV it stays where it is
  HALVED,         // a wrong divider
  FALLEN,         // above 1 kV it shows 0 V from then on
  AMPLIFIER_STAYS // above 1 kV the amplifier does; the monitor shows that
};

static const double rate_Hz = 100, gain = 1000;

/* The amplifier with its monitor, 1 V for 1 kV, and who reads that. */
struct trek {
  struct dea_instrument common;
  struct supply *generator;
  enum lie lie;
  double start_s, output_V, shown_V, highest_V;
  bool failed;
  size_t given;
};

static dea_status trek_start(struct dea_context *context, struct dea_instrument *instrument)
{
  struct trek *t = (struct trek *)instrument;
  t->start_s = dea_clock_s();
  return DEA_OK;
}

static void trek_follow(struct trek *t)
{
  double volts = gain * supply_volts(t->generator);
  t->failed = t->failed || volts > 1000;
  t->output_V = t->lie == AMPLIFIER_STAYS && t->failed ? t->output_V : volts;
  t->highest_V = fmax(t->highest_V, t->output_V);
  if (t->lie != STUCK || !t->failed) {
    t->shown_V = t->output_V;
  }
}

static double trek_shows(const struct trek *t)
{
  switch (t->lie) {
  case DEAD:
    return 0;
  case FALLEN:
    return t->failed ? 0 : t->shown_V;
  case HALVED:
    return 0.5 * t->shown_V;
  default:
    return t->shown_V;
  }
}

/* A few samples at a time, by the computer's clock. */
static dea_status trek_get(struct dea_context *context, struct dea_instrument *instrument,
                           double timeout_s, const struct dea_sink *sink)
{
  struct trek *t = (struct trek *)instrument;
  dea_clock_wait(fmin(timeout_s, 0.01));
  for (int i = 0; i < 5 && (double)t->given < (dea_clock_s() - t->start_s) * rate_Hz; i++) {
    trek_follow(t);
    const double volts = trek_shows(t) / 1000;
    t->given++;
    dea_status status = sink->samples(sink->user, &volts, 1);
    if (status != DEA_OK) {
      return status;
    }
  }
  return DEA_OK;
}

static void trek_close(struct dea_context *context, struct dea_instrument *instrument)
{
}

static const struct dea_instrument_type trek_type = {
    .name = "trek", .start = trek_start, .get = trek_get, .close = trek_close};

static void play(enum lie lie, struct trek *t, struct dea_drive_report *report, dea_status *status)
{
  static struct supply generator;
  char text[2048];
  generator = (struct supply){.slew_V_per_s = 100};
  supply_start(&generator);
  snprintf(text, sizeof text,
           "dea-protocol: 1\n"
           "waveform: {kind: triangle, low: 0 kV, high: 2 kV, cycles: 1, frequency: 0.5 Hz}\n"
           "amplifier: {gain: 1000, max_voltage: 5 kV}\nrate: 100 Hz\n"
           "channels:\n  - {name: monitor, quantity: voltage, input: ai0, per_volt: 1 kV}\n"
           "safety: {ramp: 4 kV/s, voltage_error: 300 V, at_zero: 20 V, zero_time: 3 s}\n"
           "instruments:\n"
           "  - {kind: scpi, address: 127.0.0.1, port: %d, timeout: 2 s, output: \"C1:BSWV "
           "OFST,%%g\",\n     setup: [\"C1:BSWV WVTP,DC,OFST,0\", \"C1:OUTP ON\"], output_off: "
           "\"C1:OUTP OFF\", queue: 5 s, behind: 5 s}\n",
           generator.port);
  good_protocol(text);
  struct dea_instrument *player;
  assert_int_equal(dea_instrument_open(ctx, &p->instruments[0], p, &player), DEA_OK);
  *t = (struct trek){.common = {.type = &trek_type, .roles = DEA_READS_INPUTS},
                     .generator = &generator,
                     .lie = lie};
  struct dea_instrument *all[2] = {player, &t->common};
  struct dea_drive_bench bench = {all, 2, 0.3, 3, NULL, NULL, 0};
  unlink(in_folder("trek.h5"));
  *status = dea_drive_play(ctx, p, &bench, in_folder("trek.h5"), report);
  trek_follow(t);
  print_message("%d: %s, %g V of the amplifier; %s\n", (int)lie, dea_zero_name(report->zero.state),
                t->output_V, report->ended);
  player->type->close(ctx, player);
  supply_stop(&generator);
}

/* Read back by the monitor: the generator itself has nothing to say of that. */
TEST(test_plays)
{
  struct trek t;
  struct dea_drive_report report;
  dea_status status;
  play(HONEST, &t, &report, &status);
  assert_int_equal(status, DEA_OK);
  assert_int_equal(report.zero.state, DEA_ZERO_READ_BACK);
  assert_true(t.highest_V > 1800 && t.highest_V <= 2000 && t.output_V < 1);
}

/* A monitor that contradicted what was asked is not believed when it shows 0 V at last: it may have
 * come off, and then it shows that whatever the amplifier does. */
TEST(test_monitor_that_lies)
{
  static const enum lie lies[] = {DEAD, STUCK, HALVED, FALLEN, AMPLIFIER_STAYS};
  for (size_t i = 0; i < sizeof lies / sizeof lies[0]; i++) {
    struct trek t;
    struct dea_drive_report report;
    dea_status status;
    play(lies[i], &t, &report, &status);
    assert_int_equal(status, DEA_E_INTERLOCK);
    assert_non_null(strstr(report.ended, "safety.voltage_error"));
    assert_int_equal(report.zero.state, DEA_ZERO_UNKNOWN);
    assert_true(lies[i] == AMPLIFIER_STAYS ? t.output_V > 900 : t.output_V < 1);
    dea_context_clear(ctx);
  }
}

TESTS(set_up, protocol_tear_down)
