/* protocol: reading with all errors at their places; the sequence on its clock. */
// ctest: quick, heavy
#include "failing_allocator.h"
#include "protocol_text.h"

#include <math.h>

static void read_example(const char *name)
{
  char file[700];
  snprintf(file, sizeof file, "%s/lab/examples/%s", DEA_SOURCE_DIR, name);
  dea_finding_clear(ctx);
  if (protocol_read(file, NULL, 0) != DEA_OK) {
    print_findings(ctx);
    fail_msg("%s: %s", file, dea_context_message(ctx));
  }
}

/* The paper's measurement (section 3.2): 9 voltages, 15 cycles each, 0.5 Hz, half of it on. */
TEST(test_cyclic_example)
{
  read_example("cyclic.yaml");
  assert_close(dea_protocol_duration_s(p), 270, 0, 0);
  assert_int_equal(dea_protocol_cycles(p), 135);
  struct dea_recorded_cycle cycle;
  for (size_t n = 0; n < 135; n++) {
    assert_true(dea_protocol_cycle(p, n, &cycle));
    assert_true(cycle.step == 0 && cycle.number == n);
    assert_true(cycle.start_s == 2.0 * (double)n && cycle.end_s == 2.0 * (double)(n + 1));
    assert_true(cycle.level_V == 1000.0 * (double)(n / 15));
    assert_true(dea_protocol_value(p, cycle.start_s + 0.5) == cycle.level_V);
    assert_true(dea_protocol_value(p, cycle.start_s + 1.5) == 0);
  }
  assert_false(dea_protocol_cycle(p, 135, &cycle));
  assert_true(p->amplifier.lowest_V.si == -10e3 && p->amplifier.gain.si == 1000);
  assert_true(p->amplifier.slew_V_per_s.si == 7e8);
  assert_int_equal(p->input_count, 3);
  assert_int_equal(p->inputs[0].kind.value, DEA_CHANNEL_VOLTAGE);
  assert_close(p->inputs[2].per_volt, 1e-3, 1e-14, 0);
  assert_non_null(p->film);
  assert_non_null(strstr(p->text, "dea-protocol"));
  assert_non_null(strstr(p->design_text, "pre_stretch"));
  read_example("force.yaml");
  assert_int_equal(dea_protocol_cycles(p), 1 + 18);
  assert_close(dea_protocol_duration_s(p), 5 + 180 + 5, 0, 0);
}

#define TWO_STEPS                                                                                  \
  PROTOCOL_HEAD                                                                                    \
  "sequence:\n"                                                                                    \
  "  - {label: a, waveform: {kind: square, low: 1 kV, high: 3 kV, frequency: 0.7 Hz, cycles: 3},"  \
  " repeat: 4, pause: 2 s}\n"                                                                      \
  "  - {waveform: {kind: ramp, to: 2 kV, duration: 3 s}, repeat: 2}\n"                             \
  "  - {waveform: {kind: chirp, mean: 1 kV, amplitude: 500 V, from: 1 Hz, to: 9 Hz, duration: 2 "  \
  "s}}\n"

TEST(test_steps_follow_each_other)
{
  good_protocol(TWO_STEPS);
  double each = 3 / 0.7, second = 4 * each + 2;
  struct dea_recorded_cycle cycle;
  assert_close(dea_protocol_duration_s(p), second + 6 + 2, 1e-15, 0);
  assert_int_equal(dea_protocol_cycles(p), 12 + 2 + 1);
  for (size_t n = 0; n < 12; n++) {
    assert_true(dea_protocol_cycle(p, n, &cycle));
    assert_close(cycle.start_s, (double)n / 0.7, 1e-14, 0);
    assert_true(cycle.level_V == 3000 && cycle.step == 0 && cycle.number == n);
    assert_true(dea_protocol_value(p, cycle.start_s + 0.1) == 3000);
    assert_true(dea_protocol_value(p, cycle.end_s - 0.1) == 1000);
  }
  assert_true(dea_protocol_value(p, 4 * each + 1e-9) == 0); // the pause
  assert_close(dea_protocol_value(p, second + 3 + 1.5), 1000, 1e-12, 0);
  assert_true(dea_protocol_cycle(p, 13, &cycle));
  assert_true(cycle.step == 1 && cycle.number == 1 && cycle.level_V == 2000);
  assert_close(cycle.start_s, second + 3, 1e-15, 0);
  assert_true(dea_protocol_cycle(p, 14, &cycle));
  assert_close(cycle.level_V, 1500, 1e-9, 0);
  assert_close(p->steps[2].lowest_V, 500, 1e-9, 0);
  assert_true(dea_protocol_value(p, second + 8.1) == 0);
  assert_true(isinf(dea_protocol_corner(p, second + 8)));
}

/* Corners rise, are all there, and the value at each is that after it. */
TEST(test_corners)
{
  good_protocol(PROTOCOL_HEAD "sequence: [{waveform: {kind: square, high: 3 kV, frequency: 0.3 Hz, "
                              "duty: 37 %, cycles: 7}, repeat: 1000, pause: 1 s}]\n");
  double t = 0;
  size_t corners = 0;
  for (double next; isfinite(next = dea_protocol_corner(p, t)); t = next) {
    assert_true(next > t);
    corners++;
    bool up = corners % 2 == 0 && corners < 14000;
    assert_true(dea_protocol_value(p, next) == (up ? 3000 : 0));
    assert_true(dea_protocol_value(p, 0.5 * (t + next)) ==
                (corners % 2 == 1 && corners < 14000 ? 3000.0 : 0));
  }
  assert_int_equal(corners, 2 * 7000 + 1); // down, up or end of a repetition; end of the pause
  assert_true(t == dea_protocol_duration_s(p));
}

TEST(test_waveform_alone_and_overrides)
{
  good_protocol(PROTOCOL_HEAD "waveform: {kind: sine, amplitude: 2 kV, frequency: 5 Hz}\n");
  assert_int_equal(p->step_count, 1);
  assert_int_equal(dea_protocol_cycles(p), 10);
  assert_close(p->steps[0].lowest_V, -2000, 1e-9, 0);
  const struct dea_override set = {"waveform.amplitude", "4 kV"};
  assert_int_equal(protocol_read(in_folder("protocol.yaml"), &set, 1), DEA_OK);
  assert_close(dea_protocol_value(p, 0.05), 4000, 1e-12, 0);
  assert_int_equal(p->steps[0].waveform == NULL, 0);
}

#define SQUARE "waveform: {kind: square, high: 3 kV, frequency: 1 Hz}\n"

/* What is wrong in a file, a part of what is said, and where. */
TEST(test_errors_have_places)
{
  static const struct {
    const char *text, *part;
    size_t line, column;
  } wrong[] = {
      {PROTOCOL_HEAD, "lacks what is to be played", 1, 1},
      {"title: x\ndea: 1\nfilm: {thickness: 1 mm}\n", "this is a design, not a protocol", 2, 1},
      {PROTOCOL_HEAD "sequence: [{pause: 1 s}]\n", "section 'sequence[0]' lacks 'waveform'", 5, 12},
      {PROTOCOL_HEAD "sequence: [x]\n", "sequence must be a section with keys of its own", 5, 12},
      {PROTOCOL_HEAD "sequence: [{waveform: {kind: constant, voltage: 1 V}, repeat: x}]\n",
       "repeat: 'x' is not a number", 5, 63},
      {PROTOCOL_HEAD "waveform: {kind: ramp, to: 8000, duration: 1 s}\n",
       "'8000' has no unit: a voltage is due; write for example '8000 V'", 5, 28},
      {PROTOCOL_HEAD SQUARE "rat: 2 kHz\n", "did you mean 'rate'?", 6, 1},
      {PROTOCOL_HEAD SQUARE "gain: 1000\n", "belongs into a section such as 'amplifier'", 6, 1},
      {PROTOCOL_HEAD SQUARE "rate: 1000\n", "has no unit", 6, 7},
      {PROTOCOL_HEAD SQUARE "sequence: [{waveform: {kind: sine}}]\n", "exclude each other", 5, 1},
      {PROTOCOL_HEAD "waveform: {kind: sqare, high: 3 kV}\n", "did you mean 'square'", 5, 18},
      {PROTOCOL_HEAD "sequence:\n  - {waveform: {kind: constant, voltage: 1 kV}, repeat: 0}\n",
       "repeat must be at least 1", 6, 57},
      {PROTOCOL_HEAD "sequence:\n  - {waveform: {kind: constant, voltage: 1 kV}, repeat: 1000000}\n"
                     "  - {waveform: {kind: square, high: 1 V, frequency: 1 Hz, cycles: 1000000}, "
                     "repeat: 1000000}\n",
       "more than 1e+09 cycles", 7, 85},
      {"dea-protocol: 1\nwaveform: {kind: constant, voltage: 1 V}\namplifier: {max_voltage: 1 "
       "kV}\n",
       "'gain' (voltage of its output over its control voltage), for example 'gain: 1000 V/V'", 3,
       1},
      {"dea-protocol: 1\nwaveform: {kind: constant, voltage: 1 V}\n"
       "amplifier: {max_voltage: 1 kV, gain: 1 kV/V}\n",
       "gain: '1 kV/V'", 3, 38},
      {"dea-protocol: 1\ndesign: none.yaml\nwaveform: {kind: constant, voltage: 1 V}\n",
       "design: ", 2, 9},
      {PROTOCOL_HEAD SQUARE
       "channels:\n  - {name: a, quantity: voltag, input: ai0, per_volt: 1 V}\n",
       "did you mean 'voltage'?", 7, 25},
      {PROTOCOL_HEAD SQUARE
       "channels:\n  - {name: a, quantity: voltage, input: ai0, per_volt: 1 mm}\n",
       "per_volt: '1 mm' is a length, but a voltage is due, such as '1 kV'", 7, 56},
      {PROTOCOL_HEAD SQUARE
       "channels:\n  - {name: a, quantity: displacement, input: ai0, per_volt: 0 mm}\n",
       "per_volt must not be 0", 7, 61},
      {PROTOCOL_HEAD SQUARE
       "channels:\n  - {name: a, quantity: force, input: ai0, per_volt: 1 N, unit: g}\n",
       "only of a quantity `other`; the recording keeps force in N", 7, 65},
      {PROTOCOL_HEAD SQUARE "channels:\n  - {name: a, quantity: force, input: ai0, per_volt: 1 N}\n"
                            "  - {name: a, quantity: force, input: ai1, per_volt: 1 N}\n",
       "the channel in line 7 has the name 'a' too", 8, 12},
      {PROTOCOL_HEAD SQUARE "channels:\n  - {name: a, quantity: force, input: ai0, per_volt: 1 N}\n"
                            "  - {name: b, quantity: force, input: ai0, per_volt: 1 N}\n",
       "the channel 'a' is connected to the input 'ai0' too", 8, 39},
      {PROTOCOL_HEAD SQUARE "safety: {field_margin: 2}\n", "stands twice", 6, 1},
  };
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    dea_finding_clear(ctx);
    assert_int_equal(protocol_of(wrong[i].text), DEA_E_DESIGN);
    assert_null(p);
    const struct dea_finding *f = find_error(ctx, wrong[i].part);
    if (f == NULL || f->location.line != wrong[i].line || f->location.column != wrong[i].column) {
      print_findings(ctx);
      fail_msg("no '%s' at %zu:%zu of:\n%s", wrong[i].part, wrong[i].line, wrong[i].column,
               wrong[i].text);
    }
  }
}

/* Errors beyond those that are kept still end the reading: nothing is made of what is left out. */
TEST(test_many_errors)
{
  struct dea_text text = {.ctx = ctx};
  dea_finding_clear(ctx);
  dea_text_add(&text, PROTOCOL_HEAD "sequence:\n");
  for (int i = 0; i < 150; i++) {
    dea_text_add(&text, "  - {waveform: {kind: square, high: x, frequency: 1 Hz}}\n");
  }
  assert_int_equal(protocol_of(dea_text_get(&text)), DEA_E_DESIGN);
  assert_int_equal(dea_finding_count(ctx, DEA_ERROR), 150);
  assert_null(find_error(ctx, "takes no time"));
  // and the same file anew, whose errors are known already
  assert_int_equal(protocol_of(PROTOCOL_HEAD "sequence: [{pause: 1 s}]\n"), DEA_E_DESIGN);
  assert_int_equal(protocol_of(PROTOCOL_HEAD "sequence: [{pause: 1 s}]\n"), DEA_E_DESIGN);
  dea_text_free(&text);
}

/* Errors of the design stand in the design, and the protocol is not read. */
TEST(test_wrong_design)
{
  dea_finding_clear(ctx);
  write_in_folder("design.yaml", "dea: 1\nfilm: {material: x}\n");
  write_in_folder("protocol.yaml", PROTOCOL_HEAD SQUARE);
  assert_int_equal(protocol_read(in_folder("protocol.yaml"), NULL, 0), DEA_E_DESIGN);
  const struct dea_finding *f = find_error(ctx, "lacks 'pre_stretch'");
  assert_non_null(f);
  assert_non_null(strstr(f->location.file, "design.yaml"));
  assert_int_equal(protocol_read(in_folder("no.yaml"), NULL, 0), DEA_E_IO);
}

TEST(test_channels)
{
  good_protocol(
      PROTOCOL_HEAD SQUARE
      "channels:\n"
      "  - {name: laser, quantity: displacement, input: ai0, per_volt: -0.2 mm/V, at_zero: 1 mm}\n"
      "  - {name: room, quantity: other, unit: degC, input: ai1, per_volt: 10 degC/V, at_zero: "
      "-5}\n"
      "instruments:\n  - {kind: x, key: 3}\n  - {kind: y}\n"
      "sim: {seed: 3}\n");
  assert_close(p->inputs[0].per_volt, -2e-4, 1e-14, 0);
  assert_close(p->inputs[0].at_zero, 1e-3, 1e-14, 0);
  assert_true(p->inputs[1].kind.value == DEA_CHANNEL_OTHER && p->inputs[1].per_volt == 10);
  assert_true(p->inputs[1].at_zero == -5 && p->inputs[1].range_V.si == 10);
  assert_true(isnan(p->inputs[0].filter_Hz.si));
  assert_int_equal(p->instrument_count, 2);
  assert_string_equal(p->instruments[1].path, "instruments[1]");
  assert_string_equal(dea_node_find(p->instruments[1].section, "kind")->text, "y");
  assert_string_equal(dea_node_find(p->sim.section, "seed")->text, "3");
}

static dea_status read_two_steps(struct dea_context *context)
{
  struct dea_protocol *own;
  dea_status status =
      dea_protocol_read(context, &dea_film_of_design, in_folder("protocol.yaml"), NULL, 0, &own);
  dea_protocol_destroy(context, own);
  return status;
}

TEST(test_memory)
{
  good_protocol(TWO_STEPS);
  assert_true(failing_ends(read_two_steps, DEA_OK) > 10); // there was something to fail
}

TESTS(set_up, protocol_tear_down)
