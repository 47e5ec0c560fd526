/* The open high-voltage supply with eight channels, imitated on a pseudo-terminal: what dea drive
 * plays on it, and what it says of the output when the supply fails. */
// ctest: supply
#include "supply_drive.h"

static void answer(struct supply *s, const char *command, char out[SUPPLY_ANSWER])
{
  double value;
  int number;
  if (sscanf(command, "SHV %lf", &value) == 1) {
    s->set_V = value;
    snprintf(out, SUPPLY_ANSWER, "[HV] %.1f", value);
  } else if (strcmp(command, "QMes") == 0) {
    snprintf(out, SUPPLY_ANSWER, "[QMes] HV = %.1f V // LV = 5.1 V", s->shown_V);
  } else if (strcmp(command, "EStop") == 0) {
    s->mode = 0;
    s->set_V = 0;
    snprintf(out, SUPPLY_ANSWER, "[EStop]");
  } else if (sscanf(command, "SM%d 1 255", &number) == 1) {
    s->mode = number;
    snprintf(out, SUPPLY_ANSWER, "[SM%d]", number);
  }
}

static void begin(const char *connect)
{
  char text[2048];
  hv = (struct supply){.answer = answer, .error = "unknown command", .buffer = 60};
  supply_start(&hv);
  snprintf(text, sizeof text,
           "dea-protocol: 1\n"
           "waveform: {kind: square, high: 2 kV, rise_time: 1 s, cycles: 2, frequency: 0.25 Hz}\n"
           "amplifier: {gain: 1000, max_voltage: 5 kV, min_voltage: 0 V}\n"
           "rate: 100 Hz\n"
           "safety: {ramp: 4 kV/s, voltage_error: 300 V, at_zero: %g V, zero_time: 6 s}\n"
           "instruments:\n"
           "  - {kind: ochvps, device: %s, connect: [\"%s\"], channel: supply, queue: 1 s,\n"
           "     behind: 1.5 s, timeout: 3 s}\n",
           supply_zero_V, hv.device, connect);
  command_write("p.yaml", text);
}

TEST(test_plays)
{
  begin("SM1 1 255 1 100 0 0 0");
  pid_t child = supply_arm_checked("o.h5");
  bool reached = supply_reaches(&hv, 1900, 10);
  int mode = hv.mode, code = supply_wait(child, 30);
  if (code != 0 || !reached) {
    fail_msg("%d\n%s%s", code, command_out, command_err);
  }
  assert_int_equal(mode, 1);
  assert_true(supply_said_zero() && hv.mode == 0 && hv.overflows == 0 && hv.hurried == 0);
  double highest_V = supply_highest(&hv);
  assert_true(highest_V > 1900 && highest_V <= 2000);
  supply_stop(&hv);
}

TEST(test_faults)
{
  static const struct {
    enum supply_fault fault;
    const char *message;
  } cases[] = {{SUPPLY_HANGS, "did not answer"},
               {SUPPLY_GARBLES, "which"},
               {SUPPLY_ERRS, "answered 'unknown command'"},
               {SUPPLY_HANGS_UP, "the connection to the OCHVPS"}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    begin("SM1 1 255 1 100 0 0 0");
    pid_t child = supply_arm_checked("o.h5");
    assert_true(supply_reaches(&hv, 1000, 60));
    atomic_store(&hv.fault, cases[i].fault);
    assert_int_equal(supply_wait(child, 20), 6);
    assert_false(supply_said_zero());
    assert_contains(command_err, cases[i].message);
    supply_stop(&hv);
  }
}

TEST(test_refused)
{
  static const char *const wrong[] = {"SHV 3000", "SM1 1 255\\rSHV 3000", "EStop"};
  for (size_t i = 0; i < 3; i++) {
    begin(wrong[i]);
    assert_int_equal(supply_run_dea("drive p.yaml", 20), 3);
    assert_contains(command_err, i == 1 ? "control character" : "that connect channels");
    assert_true(supply_highest(&hv) == 0);
    supply_stop(&hv);
  }
  begin("SMA"); // a command that it does not know
  assert_int_equal(supply_wait(supply_arm_checked("o.h5"), 20), 6);
  assert_contains(command_err, "answered 'unknown command' to 'SMA', which is an error");
  assert_true(supply_highest(&hv) == 0);
  supply_stop(&hv);
}

TESTS(command_set_up, supply_tear_down)
